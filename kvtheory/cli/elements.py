"""`kvtheory elements`: the motion from rest by point elements, over time."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from kvtheory.cli.console import print_series, progress_bar, scene_command
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_results, deliver, series_options


@scene_command(
    main,
    'kvtheory elements --at "0 ms,1 ms,10 ms" --scheme paper && kvtheory elements -o run.csv',
)
@click.option(
    "--per-length", metavar='"200 /mm"', help="Elements per length, 1/dx; default: 200 /mm."
)
@click.option(
    "--scheme", default="edge-corrected", show_default=True,
    help="paper, explicit-euler, semi-implicit, exponential or edge-corrected.",
)  # fmt: skip
@click.option("--time-step", metavar='"10 us"', help="Default: 2 dx/V or less.")
@series_options
def elements(
    scene: str | None, overrides: Sequence[str], as_json: bool,
    output: Path | None, plot: Path | None, **how: Any,
) -> None:  # fmt: skip
    """Simulate the motion from rest by point elements: any shape."""
    from kvtheory.api import elements as simulate
    from kvtheory.scene import load_scene

    check_results(output, plot)
    with progress_bar("elements") as progress:
        result = simulate(
            load_scene(scene, overrides),
            **how,
            progress=progress,
            warn=lambda text: click.echo(f"kvtheory: warning: {text}", err=True),
        )
    if deliver(result, output, plot, as_json=as_json):
        return
    remedy = "Take more elements (--per-length), which also shortens the steps."
    print_series(result, whole=how["at"] is not None, remedy=remedy)
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.scheme}, {result.per_length / 1e3:g} elements per mm, {result.steps} steps of at most "
        f"{result.time_step * 1e3:.4g} ms; error estimated at {worst:.1e}: "
        f"{result.certificate.statement}."
    )
