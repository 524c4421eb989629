"""`kvtheory solve`: the cheapest model that is enough."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kvtheory.cli.console import print_json, print_series, print_table, scene_command, shown, split
from kvtheory.cli.group import main
from kvtheory.cli.outputs import PICTURES, check_output, series_options

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
@click.option(
    "--quantity", default=None, metavar="NAME,...", help="What is wanted; default: everything."
)
@click.option("--explain", is_flag=True, help="Print which models were tried, and why.")
@series_options
def solve(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    rtol: float,
    quantity: str | None,
    explain: bool,
    at: str | None,
    output: Path | None,
    plot: Path | None,
) -> None:
    """Solve SCENE by the cheapest model that is known to be within the tolerance.

    Steady sliding, or with --at, -o or --plot the motion from rest over time.
    """
    from kvtheory.api import solve as find
    from kvtheory.export import SERIES_SUFFIXES, save_result
    from kvtheory.scene import load_scene

    check_output("-o", output, SERIES_SUFFIXES)
    check_output("--plot", plot, PICTURES)
    found = find(
        load_scene(scene, overrides),
        quantity=None if quantity is None else split(quantity),
        at=at,
        rtol=rtol,
        over_time=bool(output or plot),
    )
    if output:
        save_result(found, output)
    if plot:
        from kvtheory.plots.result import save_plot

        save_plot(found, plot)
    if as_json:
        print_json(found.as_dict())
        return
    if explain:
        _explain(found)
    if at is not None or output or plot:
        print_series(found, whole=at is not None)
    else:
        _print_steady(found)
    worst = max(found.certificate.relative_error.values())
    click.echo(
        f"\nmodel: {found.model}; error {found.certificate.kind} at {worst:.1e} or less: "
        f"{found.certificate.statement}."
    )


def _print_steady(found: "Solution") -> None:
    from kvtheory.results import STEADY_UNITS

    errors = found.certificate.relative_error
    print_table(
        ("quantity", "value", "unit", "relative error"),
        [
            (name, *shown(value, STEADY_UNITS[name]), f"{errors[name]:.1e}")
            for name, value in found.values.items()
        ],
    )


def _explain(found: "Solution") -> None:
    """Print the climb: what was assumed, the margin, the error, the time."""
    print_table(
        ("model", "assumes", "error", "margin", "time [ms]", "outcome"),
        [
            (
                step.rung, step.assumed, _number(step.error), _number(step.margin),
                f"{(step.choosing + step.solving) * 1e3:.3f}", step.outcome,
            )
            for step in found.climb
        ],
    )  # fmt: skip
    click.echo(f"\ntolerance {found.rtol:g}; {found.choosing_share:.1%} of the time to choose\n")


def _number(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "-"
