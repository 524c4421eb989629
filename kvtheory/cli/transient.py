"""`kvtheory transient`: the motion from rest, over time."""

from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import print_json, print_series, progress_bar, scene_command, text
from kvtheory.cli.group import main
from kvtheory.cli.outputs import PICTURES, check_output, series_options


@scene_command(
    main,
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png',
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@series_options
def transient(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    rtol: float,
    at: str | None,
    output: Path | None,
    plot: Path | None,
) -> None:
    """Follow the transient of SCENE: depth, forces, edges and events over time."""
    from kvtheory.api import transient as follow
    from kvtheory.export import SERIES_SUFFIXES, save_result
    from kvtheory.scene import load_scene

    check_output("-o", output, SERIES_SUFFIXES)  # before a run that may be long
    check_output("--plot", plot, PICTURES)
    with progress_bar("transient") as progress:
        result = follow(load_scene(scene, overrides), at=at, rtol=rtol, progress=progress)
    if output:
        save_result(result, output)
    if plot:
        from kvtheory.plots.result import save_plot

        save_plot(result, plot)
    if as_json:
        print_json(result.as_dict())
        return
    print_series(result, whole=at is not None)
    click.echo("\nevents:")
    for event in result.events:
        click.echo(f"  {text(event.time, 's')}: {event.kind}")
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.steps} steps; error estimated at {worst:.1e}: {result.certificate.statement}."
    )
