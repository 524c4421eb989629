"""`kvtheory chart` and `explore`: charts of methods, and an interactive page of a scene."""

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main
from kvtheory.cli.outputs import PICTURES, OutputFile

THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
"""Set to one before anything numerical is imported, so that times can be compared."""


@main.group()
def chart() -> None:
    """Chart speed, accuracy, stability and failures of methods."""


@chart.command(example="kvtheory chart failures -o failures.html")
@console.names_option("--only", metavar="KEY,...", help="Entries to compute; default: all of them.")
@click.option(
    "-o", "--output", type=OutputFile(".html"),
    help="Write the atlas as one self-contained FILE.html.",
)  # fmt: skip
@console.json_option
@console.overwrite_option
def failures(only: list[str] | None, output: Path | None, as_json: bool) -> None:
    """Show how methods fail, with wrong and right numbers."""
    found = []
    with console.progress_bar("entries") as report:  # the imports take time, too
        from kvtheory.charts.failures import ATLAS, ROLES, findings
        from kvtheory.plots.failures import save_failures, shown

        keys = only or list(ATLAS)
        for finding in findings(keys):
            found.append(finding)
            report(len(found) / len(keys), f"{len(found)} of {len(keys)}")
        if output:
            save_failures(found, output)
    if as_json:
        console.print_json({"failures": [finding.as_dict() for finding in found]})
        return
    rows = [(f.entry.key, f.entry.quantity, *(shown(f, role) for role in ROLES)) for f in found]
    console.print_table(("entry", "quantity", "wrong", "right", "this package"), rows)
    for finding in found if only else []:
        entry = finding.entry
        click.echo(f"\n{entry.title}. {entry.scene}.\n{entry.why}")
        click.echo(f"How to notice: {entry.notice}\nThis package: {entry.package}")
        click.echo(finding.outcome.said, nl=bool(finding.outcome.said))
    if output:
        click.echo(f"\n{output}")


def picture_option(default: str) -> Any:
    """Return the option `-o` of a chart, whose data are written too."""
    return click.option(
        "-o", "--output", type=OutputFile(*PICTURES, beside=".json", inside=default), default=default,
        show_default=True,
        help="Picture, or a directory for it; its data go to FILE.json beside it.",
    )  # fmt: skip


@chart.command(example="kvtheory chart stability -o stability.png")
@picture_option("stability.png")
@click.option("--quick", is_flag=True, help="Coarser maps.")
@console.overwrite_option
def stability(output: Path, quick: bool) -> None:
    """Map where each scheme is stable, predicted and measured."""
    with console.progress_bar("maps") as report:
        from kvtheory.charts.stability import stability_maps
        from kvtheory.plots.failures import save_stability

        save_stability(stability_maps(quick=quick, progress=report), output)
    click.echo(f"{output}\n{output.with_suffix('.json')}")


@chart.command(
    "work-precision", example="kvtheory chart work-precision my-scene.toml --quick -o speed.png"
)
@console.scene_options
@console.names_option(
    "--standard",
    help="Instead of a scene: table-1, low-velocity, high-velocity, small-inertia, stop-and-go, "
    "reversal, hop, or all.",
)  # fmt: skip
@click.option("--quick", is_flag=True, help="Fewer settings and repeats.")
@click.option(
    "--add", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="MINE.csv",
    help="Draw runs of another simulator too: columns method, seconds, error.",
)  # fmt: skip
@picture_option("work_precision.png")
@console.overwrite_option
def work_precision(
    scene: str | None, overrides: Sequence[str], standard: list[str] | None, quick: bool,
    add: Path | None, output: Path,
) -> None:  # fmt: skip
    """Chart the speed of all methods against their accuracy.

    How long it takes is printed at once, and again when the cheapest settings have been run. The error of
    a run that is added is the largest error of the depth over the run, over the static depth; of a fixed
    indenter, that of the friction force over its largest.
    """
    os.environ.update(dict.fromkeys(THREADS, "1"))
    if standard and (scene or overrides):
        raise ValueError("--standard names its own scenes; it does not go with SCENE or --set")
    with console.progress_bar("methods") as report:
        from kvtheory.charts.added import read_runs, with_runs
        from kvtheory.charts.collection import ALL, chosen, measure
        from kvtheory.plots.files import drawable
        from kvtheory.plots.work_precision import (
            LOOKS,
            MARKS,
            default_errors,
            save_work_precision,
        )
        from kvtheory.scene import load_scene

        standards = standard or []
        if add and (len(standards) > 1 or ALL in standards):
            raise ValueError("--add is for one scene: give SCENE, or --standard with one name")
        runs = read_runs(add, LOOKS, len(MARKS), drawable) if add else {}
        jobs = chosen(load_scene(scene, overrides), standards, quick=quick)
        charts = measure(jobs, quick=quick, progress=report, announce=_say_time)
        if runs:
            charts[-1] = with_runs(charts[-1], runs, default_errors(charts[-1:])[0])
        save_work_precision(charts, output)
    click.echo(f"{output}\n{output.with_suffix('.json')}")
    for one in charts:
        (error,) = default_errors([one])
        references, what = " and ".join(one.reference), error.split(",")[0]
        click.echo(f"{one.name}: {references} agree on {what} to {one.floor[error]:.1e}")


def _say_time(words: str, seconds: float) -> None:
    """Print how long a chart will take, on a terminal in place of the progress bar, which goes on below."""
    terminal = sys.stderr and sys.stderr.isatty()  # standard error may be closed
    clear = "\r\033[K" if terminal else ""
    click.echo(f"{clear}{words} {seconds:.2g} s", err=True)


PAPER = {
    "fig3": "Draw Fig. 3: the onset of sliding, for both models.",
    "fig4": "Draw Fig. 4: the pressure over position and time.",
    "fig5": "Draw Fig. 5: steady sliding over velocity, for three tau.",
    "fig6": "Draw Fig. 6: the master curves of friction.",
    "table2": "Draw Table 2: critical velocity and friction.",
}
"""The figures of the paper that are drawn for any scene."""


def paper_command(name: str) -> None:
    """Add the command that draws a figure of the paper."""
    whose = (
        "The two models of the paper are SCENE with a fixed indenter at its static depth, and under its "
        "static load; without SCENE, Table 1."
    )

    @chart.command(
        name, help=f"{PAPER[name]}\n\n{whose}", short_help=PAPER[name],
        example=f"kvtheory chart {name} my-scene.toml --style mine.mplstyle -o {name}.pdf",
    )  # fmt: skip
    @console.scene_options
    @click.option(
        "--style", type=click.Path(exists=True, dir_okay=False, path_type=Path),
        metavar="FILE.mplstyle", help="Style sheet of matplotlib: fonts, colours C0 to C4, sizes.",
    )  # fmt: skip
    @click.option(
        "-o", "--output", type=OutputFile(*PICTURES, beside=".csv", inside=f"{name}.png"),
        default=f"{name}.png", show_default=True,
        help="Picture, or a directory for it; its data go to FILE.csv beside it.",
    )  # fmt: skip
    @console.overwrite_option
    def draw(scene: str | None, overrides: Sequence[str], style: Path | None, output: Path) -> None:
        with console.progress_bar(name):
            from kvtheory.plots.files import data_csv, read_style, save_picture
            from kvtheory.scene import load_scene

            own = read_style(style) if style else None
            figure = import_module(f"kvtheory.plots.paper.{name}")
            data = figure.compute(load_scene(scene, overrides) if scene or overrides else None)
            beside = data_csv(output, data.columns)
            save_picture(lambda: figure.draw(data), output, beside=beside, style=own)
        click.echo("\n".join(map(str, (output, *beside))))


for _name in PAPER:
    paper_command(_name)


@main.command(example="kvtheory explore my-scene.toml -o explorer.html")
@console.scene_options
@click.option(
    "-o", "--output", type=OutputFile(".html"), default="explorer.html", show_default=True,
    help="File to write; it needs no server and no network.",
)  # fmt: skip
@console.overwrite_option
def explore(scene: str | None, overrides: Sequence[str], output: Path) -> None:
    """Write an interactive HTML page of steady sliding.

    It has a slider for every quantity of SCENE.
    """
    with console.progress_bar("explore"):
        from kvtheory.explorer import save_explorer
        from kvtheory.scene import load_scene

        save_explorer(load_scene(scene, overrides), output)
    click.echo(f"{output}: open it in any browser")
