"""`kvtheory transient`: the motion from rest, over time."""

from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import print_series, progress_bar, scene_command, text
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_results, deliver, series_options


@scene_command(
    main,
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png',
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option(
    "--max-steps", type=click.IntRange(1),
    help="Steps after which to give up; default: 300,000 plus 100 for each piece of the drive.",
)  # fmt: skip
@series_options
def transient(
    scene: str | None, overrides: Sequence[str], as_json: bool, rtol: float,
    max_steps: int | None, at: str | None, output: Path | None, plot: Path | None,
) -> None:  # fmt: skip
    """Compute the transient of SCENE: depth, forces, edges and events over time."""
    from kvtheory.api import transient as follow
    from kvtheory.scene import load_scene

    check_results(output, plot)
    with progress_bar("transient") as progress:
        checked = load_scene(scene, overrides)
        result = follow(checked, at=at, rtol=rtol, max_steps=max_steps, progress=progress)
    if deliver(result, output, plot, as_json=as_json):
        return
    print_series(result, whole=at is not None, remedy="Take a smaller --rtol.")
    click.echo("\nevents:")
    for event in result.events:
        click.echo(f"  {text(event.time, 's')}: {event.kind}")
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.steps} steps; error estimated at {worst:.1e}: {result.certificate.statement}."
    )
