"""`kvtheory elements`: the motion from rest by point elements, over time."""

from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import print_json, print_series, progress_bar, scene_command
from kvtheory.cli.group import main
from kvtheory.cli.outputs import PICTURES, check_output, series_options


@scene_command(
    main,
    'kvtheory elements --at "0 ms,1 ms,10 ms" --scheme paper && kvtheory elements -o run.csv',
)
@click.option(
    "--per-length",
    default=None,
    metavar='"200 /mm"',
    help="Elements per length, 1/dx; default: 200 /mm.",
)
@click.option(
    "--scheme",
    default="edge-corrected",
    show_default=True,
    help="paper, explicit-euler, semi-implicit, exponential or edge-corrected.",
)
@click.option("--time-step", default=None, metavar='"10 us"', help="Default: 2 dx/V or less.")
@series_options
def elements(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    per_length: str | None,
    scheme: str,
    time_step: str | None,
    at: str | None,
    output: Path | None,
    plot: Path | None,
) -> None:
    """Simulate SCENE by point elements that move with the base: any shape, support and drive."""
    from kvtheory.api import elements as simulate
    from kvtheory.export import SERIES_SUFFIXES, save_result
    from kvtheory.scene import load_scene

    check_output("-o", output, SERIES_SUFFIXES)  # before a run that may be long
    check_output("--plot", plot, PICTURES)
    with progress_bar("elements") as progress:
        result = simulate(
            load_scene(scene, overrides),
            per_length=per_length,
            scheme=scheme,
            time_step=time_step,
            at=at,
            progress=progress,
            warn=lambda text: click.echo(f"kvtheory: warning: {text}", err=True),
        )
    if output:
        save_result(result, output)
    if plot:
        from kvtheory.plots.result import save_plot

        save_plot(result, plot)
    if as_json:
        print_json(result.as_dict())
        return
    print_series(result, whole=at is not None)
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.scheme}, {result.per_length / 1e3:g} elements per mm, {result.steps} steps of at most "
        f"{result.time_step * 1e3:.4g} ms; error estimated at {worst:.1e}: "
        f"{result.certificate.statement}."
    )
