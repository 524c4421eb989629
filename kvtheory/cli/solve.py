"""`kvtheory solve`, `transient`, `elements` and `compare`: by the cheapest model, and over time."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from kvtheory.cli.console import (
    error_text,
    overwrite_option,
    print_quantities,
    print_series,
    print_table,
    progress_bar,
    scene_command,
    series_options,
    split,
    text,
    write_result,
)
from kvtheory.cli.group import DISAGREES
from kvtheory.cli.outputs import PICTURES, OutputFile


@scene_command(
    "kvtheory solve --quantity friction_coefficient --rtol 1e-2 --explain && "
    'kvtheory solve --at "1 ms,200 ms"'
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

    names = None if quantity is None else split(quantity)
    checked, over_time = load_scene(scene, overrides), bool(output or plot)
    with progress_bar("solve") as progress:
        found = find(
            checked, quantity=names, at=at, rtol=rtol, over_time=over_time, progress=progress
        )
    if write_result(found, output, plot, as_json=as_json):
        return
    if explain:
        rows = [
            (
                step.rung, step.assumed, error_text(step.error), error_text(step.margin),
                f"{(step.choosing + step.solving) * 1e3:.3f}", step.outcome,
            )
            for step in found.climb
        ]  # fmt: skip
        print_table(("model", "assumes", "error", "margin", "time [ms]", "outcome"), rows)
        share = found.choosing_share
        click.echo(f"\ntolerance {found.rtol:g}; {share:.1%} of the time to choose\n")
    if at is not None or over_time:
        print_series(found, whole=at is not None, remedy="Take a smaller --rtol.")
    else:
        print_quantities(found, {name: found.units[name] for name in found.values})
    worst = max(found.certificate.relative_error.values())
    click.echo(
        f"\nmodel: {found.model}; error {found.certificate.kind} at {worst:.1e} or less: "
        f"{found.certificate.statement}."
    )


@scene_command(
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png'
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
    scene: str | None, overrides: Sequence[str], as_json: bool,
    output: Path | None, plot: Path | None, **how: Any,
) -> None:  # fmt: skip
    """Compute the motion from rest: depth, forces, edges, events."""
    from kvtheory.api import transient as follow
    from kvtheory.scene import load_scene

    with progress_bar("transient") as progress:
        result = follow(load_scene(scene, overrides), **how, progress=progress)
    if write_result(result, output, plot, as_json=as_json):
        return
    print_series(result, whole=how["at"] is not None, remedy="Take a smaller --rtol.")
    click.echo("\nevents:")
    for event in result.events:
        click.echo(f"  {text(event.time, 's')}: {event.kind}")
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.steps} steps; error estimated at {worst:.1e}: {result.certificate.statement}."
    )


@scene_command(
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
@series_options
def elements(
    scene: str | None, overrides: Sequence[str], as_json: bool,
    output: Path | None, plot: Path | None, **how: Any,
) -> None:  # fmt: skip
    """Simulate the motion from rest by point elements: any shape."""
    from kvtheory.api import elements as simulate
    from kvtheory.scene import load_scene

    def warn(message: str) -> None:
        click.echo(f"kvtheory: warning: {message}", err=True)

    with progress_bar("elements") as progress:
        result = simulate(load_scene(scene, overrides), **how, progress=progress, warn=warn)
    if write_result(result, output, plot, as_json=as_json):
        return
    remedy = "Take more elements (--per-length), which also shortens the steps."
    print_series(result, whole=how["at"] is not None, remedy=remedy)
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.scheme}, {result.per_length / 1e3:g} elements per mm, {result.steps} steps of at most "
        f"{result.time_step * 1e3:.4g} ms; error estimated at {worst:.1e}: "
        f"{result.certificate.statement}."
    )


@scene_command("kvtheory compare --data mine.csv --per-length '200 /mm' --report mine.html")
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
@click.option(
    "--plot", type=OutputFile(*PICTURES),
    help="Draw data, theory and checks to FILE.png, .svg or .pdf.",
)  # fmt: skip
@click.option(
    "--report", type=OutputFile(".html"),
    help="Write the comparison as one self-contained FILE.html.",
)  # fmt: skip
@overwrite_option
def compare(
    scene: str | None, overrides: Sequence[str], as_json: bool, data: Path | None, plot: Path | None,
    report: Path | None, **how: Any,
) -> None:  # fmt: skip
    """Compare a simulation with theory, and diagnose a disagreement.

    Exit status: 0 if it agrees or the data cannot tell, 1 if it disagrees, 2 for bad input.
    """
    from kvtheory.api._compare import compare as compare_with_theory
    from kvtheory.scene import load_scene

    checked = load_scene(scene, overrides)
    with progress_bar("compare") as progress:
        found = compare_with_theory(checked, data, **how, progress=progress)
    pages = {}
    if report:
        from kvtheory.plots.comparison import save_comparison_report

        pages[report] = partial(save_comparison_report, found, checked)
    if not write_result(found, None, plot, as_json=as_json, more=pages):
        theory = "" if found.verdict == "cannot tell" else " with theory"
        click.echo(f"{found.source}: {found.verdict}{theory}\n")
        rows = []
        for check in found.checks:
            numbers, note = ("-", "-", "-"), check.note
            if check.ok is not None:
                ok = "ok" if check.ok else "NO"
                numbers = f"{check.measured:.3g}", f"{check.allowed:.3g}", ok
                note = f"{check.unit}; {check.note}" if check.note else check.unit
            rows.append((check.name, *numbers, check.equation, note))
        heads = ("check", "measured", "allowed", "", "equation", "what is measured")
        print_table(heads, rows)
        click.echo(f"\n{found.diagnosis}")
    if found.verdict == "disagrees":
        click.get_current_context().exit(DISAGREES)
