"""`kvtheory compare`: a simulation against theory."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli.console import print_table, progress_bar, scene_command
from kvtheory.cli.group import DISAGREES, main
from kvtheory.cli.outputs import PICTURES, check_output, deliver, overwrite_option, path_option

if TYPE_CHECKING:
    from kvtheory.results.comparison import Check


@scene_command(main, "kvtheory compare --data mine.csv --per-length '200 /mm' --report mine.html")
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
@path_option("--plot", help="Draw data, theory and checks to FILE.png, .svg or .pdf.")
@path_option("--report", help="Write the comparison as one self-contained FILE.html.")
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

    check_output("--report", report, [".html"])
    check_output("--plot", plot, PICTURES)
    checked = load_scene(scene, overrides)
    with progress_bar("compare") as progress:
        found = compare_with_theory(checked, data, **how, progress=progress)
    pages = {}
    if report:
        from kvtheory.plots.comparison import save_comparison_report

        pages[report] = partial(save_comparison_report, found, checked)
    if not deliver(found, None, plot, as_json=as_json, more=pages):
        verdict = (
            "cannot tell" if found.verdict == "cannot tell" else f"{found.verdict} with theory"
        )
        click.echo(f"{found.source}: {verdict}\n")
        heads = ("check", "measured", "allowed", "", "equation", "what is measured")
        print_table(heads, [_row(check) for check in found.checks])
        click.echo(f"\n{found.diagnosis}")
    if found.verdict == "disagrees":
        click.get_current_context().exit(DISAGREES)


def _row(check: "Check") -> tuple[str, ...]:
    if check.ok is None:
        return check.name, "-", "-", "-", check.equation, check.note
    note = f"{check.unit}; {check.note}" if check.note else check.unit
    ok = "ok" if check.ok else "NO"
    return check.name, f"{check.measured:.3g}", f"{check.allowed:.3g}", ok, check.equation, note
