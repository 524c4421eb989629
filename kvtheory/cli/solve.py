"""`kvtheory solve`, `transient`, `elements` and `compare`: by the cheapest model, and over time."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli import console
from kvtheory.cli.outputs import OutputFile

if TYPE_CHECKING:
    from kvtheory.scene import Scene


@console.scene_command(
    "kvtheory solve --quantity friction_coefficient --rtol 1e-2 --explain && "
    'kvtheory solve --at "1 ms,200 ms"'
)
@click.option(
    "--rtol", type=float, default=1e-3, show_default=True,
    help="Largest relative error; of a series, relative to the static state.",
)  # fmt: skip
@console.names_option(
    "--quantity",
    help="Quantities to solve for; default: all. On a spring also of the cycle in which the run ends, "
    "such as stick_slip_amplitude,stick_slip_period.",
)  # fmt: skip
@click.option("--explain", is_flag=True, help="Print which models were tried, and why.")
@console.series_options
def solve(
    scene: "Scene",
    progress: Any,
    rtol: float,
    quantity: list[str] | None,
    explain: bool,
    at: list[str] | None,
) -> Iterator[Any]:
    """Solve SCENE by the cheapest model within the tolerance.

    Without --at, -o and --plot the result is steady sliding, or a cycle, with them the motion from rest over
    time.
    """
    from kvtheory.api import solve as find

    files = click.get_current_context().params
    over_time = bool(files["output"] or files["plot"])
    found = find(scene, quantity=quantity, at=at, rtol=rtol, over_time=over_time, progress=progress)
    yield found
    if explain:
        rows = [
            (
                step.rung, step.assumed, console.error_text(step.error), console.error_text(step.margin),
                f"{(step.choosing + step.solving) * 1e3:.3f}", step.outcome,
            )
            for step in found.climb
        ]  # fmt: skip
        console.print_table(("model", "assumes", "error", "margin", "time [ms]", "outcome"), rows)
        share = found.choosing_share
        click.echo(f"\ntolerance {found.rtol:g}; {share:.1%} of the time to choose\n")
    if at is not None or over_time:
        console.print_series(found, whole=at is not None, remedy="Take a smaller --rtol.")
    else:
        console.print_quantities(found, {name: found.units[name] for name in found.values})
    console.print_error(f"model: {found.model}", found)


@console.scene_command(
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png'
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option(
    "--max-steps", type=click.IntRange(1),
    help="Steps after which to give up; default: 300,000 plus 100 for each piece of the drive, 30,000 on a "
    "Prony series.",
)  # fmt: skip
@console.series_options
def transient(scene: "Scene", progress: Any, **how: Any) -> Iterator[Any]:
    """Compute the motion from rest: depth, forces, edges, events."""
    from kvtheory.api import transient as follow

    result = follow(scene, **how, progress=progress)
    yield result
    console.print_series(result, whole=how["at"] is not None, remedy="Take a smaller --rtol.")
    click.echo("\nevents:" if result.events else "\nno events")
    for event in result.events:
        click.echo(f"  {console.text(event.time, 's')}: {event.kind}")
    console.print_error(f"{result.steps} steps", result)


@console.scene_command(
    'kvtheory elements --at "0 ms,1 ms,10 ms" --scheme paper && kvtheory elements -o run.csv'
)
@click.option(
    "--per-length", metavar='"200 /mm"', help="Elements per length, 1/dx; default: 200 /mm."
)
@click.option(
    "--scheme", default="edge-corrected", show_default=True,
    help="paper, explicit-euler, semi-implicit, exponential or edge-corrected.",
)  # fmt: skip
@click.option("--time-step", metavar='"10 us"', help="Default: 2 dx/V or less.")
@console.series_options
def elements(scene: "Scene", progress: Any, **how: Any) -> Iterator[Any]:
    """Simulate the motion from rest by point elements: any shape."""
    from kvtheory.api import elements as simulate

    def warn(message: str) -> None:
        click.echo(f"kvtheory: warning: {message}", err=True)

    result = simulate(scene, **how, progress=progress, warn=warn)
    yield result
    remedy = "Take more elements (--per-length), which also shortens the steps."
    console.print_series(result, whole=how["at"] is not None, remedy=remedy)
    steps = f"{result.steps} steps of at most {result.time_step * 1e3:.4g} ms"
    density = f"{result.per_length / 1e3:g} elements per mm"
    console.print_error(f"{result.scheme}, {density}, {steps}", result)


def _save_report(found: Any, scene: "Scene", path: Path) -> None:
    from kvtheory.plots.comparison import save_comparison_report

    save_comparison_report(found, scene, path)


@console.scene_command(
    "kvtheory compare --data mine.csv --per-length '200 /mm' --report mine.html", _save_report
)
@click.option(
    "--data", type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="CSV of a simulation: t [ms],z_A [mm],F_z [N/mm],F_x [N/mm],... Default: our own.",
)  # fmt: skip
@click.option("--per-length", metavar='"200 /mm"', help="Elements per length of the simulation.")
@click.option("--scheme", help="Scheme of the simulation, such as paper.")
@click.option(
    "--tolerance", type=float, default=1.0, show_default=True,
    help="Factor on the differences that theory allows.",
)  # fmt: skip
@console.plot_option
@click.option(
    "--report", "output", type=OutputFile(".html"),
    help="Write the comparison as one self-contained FILE.html.",
)  # fmt: skip
@console.overwrite_option
def compare(scene: "Scene", progress: Any, **how: Any) -> Iterator[Any]:
    """Compare a simulation with theory, and diagnose a disagreement.

    Exit status: 0 if it agrees or the data cannot tell, 1 if it disagrees, 2 for bad input.
    """
    from kvtheory.api._compare import compare as compare_with_theory
    from kvtheory.results.comparison import HEADS

    found = compare_with_theory(scene, **how, progress=progress)
    yield found
    theory = "" if found.verdict == "cannot tell" else " with theory"
    click.echo(f"{found.source}: {found.verdict}{theory}\n")
    console.print_table(HEADS, found.rows)
    click.echo(f"\n{found.diagnosis}")
