"""`kvtheory solve` and `transient`: the cheapest sufficient model, and the motion over time."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kvtheory.cli.console import (
    error_text,
    print_quantities,
    print_series,
    print_table,
    progress_bar,
    scene_command,
    split,
    text,
)
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_results, deliver, series_options

if TYPE_CHECKING:
    from kvtheory.results.solution import Solution


@scene_command(
    main,
    "kvtheory solve --quantity friction_coefficient --rtol 1e-2 --explain && "
    'kvtheory solve --at "1 ms,200 ms"',
)
@click.option(
    "--rtol", type=float, default=1e-3, show_default=True,
    help="Largest relative error; of a series, relative to the static state.",
)  # fmt: skip
@click.option("--quantity", metavar="NAME,...", help="Quantities to solve for; default: all.")
@click.option("--explain", is_flag=True, help="Print which models were tried, and why.")
@series_options
def solve(
    scene: str | None, overrides: Sequence[str], as_json: bool, rtol: float,
    quantity: str | None, explain: bool, at: str | None, output: Path | None, plot: Path | None,
) -> None:  # fmt: skip
    """Solve SCENE by the cheapest model within the tolerance.

    Without --at, -o and --plot the result is steady sliding, with them the motion from rest over time.
    """
    from kvtheory.api import solve as find
    from kvtheory.scene import load_scene

    check_results(output, plot)
    names = None if quantity is None else split(quantity)
    checked, over_time = load_scene(scene, overrides), bool(output or plot)
    with progress_bar("solve") as progress:
        found = find(
            checked, quantity=names, at=at, rtol=rtol, over_time=over_time, progress=progress
        )
    if deliver(found, output, plot, as_json=as_json):
        return
    if explain:
        _explain(found)
    if at is not None or over_time:
        print_series(found, whole=at is not None, remedy="Take a smaller --rtol.")
    else:
        print_quantities(found, {name: found.units[name] for name in found.values})
    worst = max(found.certificate.relative_error.values())
    click.echo(
        f"\nmodel: {found.model}; error {found.certificate.kind} at {worst:.1e} or less: "
        f"{found.certificate.statement}."
    )


def _explain(found: "Solution") -> None:
    """Print the models tried: assumptions, error, margin and time of each."""
    print_table(
        ("model", "assumes", "error", "margin", "time [ms]", "outcome"),
        [
            (
                step.rung, step.assumed, error_text(step.error), error_text(step.margin),
                f"{(step.choosing + step.solving) * 1e3:.3f}", step.outcome,
            )
            for step in found.climb
        ],
    )  # fmt: skip
    click.echo(f"\ntolerance {found.rtol:g}; {found.choosing_share:.1%} of the time to choose\n")


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
    """Compute the motion from rest: depth, forces, edges, events."""
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
