"""`kvtheory transient`: the motion from rest, over time."""

from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import (
    SHOWN_UNITS,
    print_json,
    print_table,
    scene_command,
    shown,
    split,
    text,
)
from kvtheory.cli.group import main


@scene_command(
    main,
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png',
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option("--at", default=None, metavar='"0 ms,1 ms,..."', help="Times to report.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=None,
    help="Write FILE.csv or FILE.nc.",
)
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    default=None,
    help="Draw the series to FILE.png, .svg or .pdf.",
)
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
    from kvtheory.results import TRANSIENT_UNITS
    from kvtheory.scene import load_scene

    result = follow(load_scene(scene, overrides), at=None if at is None else split(at), rtol=rtol)
    if output:
        from kvtheory.export import save_transient

        save_transient(result, output)
    if plot:
        from kvtheory.plots import save_transient_plot

        save_transient_plot(result, plot)
    if as_json:
        print_json(result.as_dict())
        return
    rows = _chosen_rows(result.time.size) if at is None else range(result.time.size)
    names = [name for name in TRANSIENT_UNITS if name != "depth_rate"]
    heads = [f"{name} [{SHOWN_UNITS[TRANSIENT_UNITS[name]][0]}]" for name in names]
    print_table(
        heads,
        [
            [shown(getattr(result, name)[i], TRANSIENT_UNITS[name])[0] for name in names]
            for i in rows
        ],
    )
    click.echo("\nevents:")
    for event in result.events:
        click.echo(f"  {text(event.time, 's')}: {event.kind}")
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.steps} steps; error estimated at {worst:.1e}: {result.certificate.statement}."
    )


def _chosen_rows(count: int, shown_rows: int = 21) -> Sequence[int]:
    """Return the indices of at most about twenty rows, first and last among them."""
    return sorted({round(i * (count - 1) / (shown_rows - 1)) for i in range(shown_rows)})
