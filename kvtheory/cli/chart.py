"""`kvtheory chart`: speed against accuracy, stability of schemes, and failures of methods."""

import os
from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import (
    Examples,
    json_option,
    print_json,
    print_table,
    progress_bar,
    report_errors,
    scene_options,
    split,
)
from kvtheory.cli.group import main
from kvtheory.cli.outputs import PICTURES, check_output, overwrite_option, path_option

THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
"""Set to one before anything numerical is imported, so that times can be compared."""


def check_chart(output: Path) -> None:
    """Raise unless a picture and the data beside it can be written."""
    check_output("-o", output, PICTURES)
    check_output("-o", output.with_suffix(".json"), [".json"])


@main.group()
def chart() -> None:
    """Chart speed against accuracy, stability, and the ways in which methods fail."""


@chart.command(cls=Examples, example="kvtheory chart failures -o failures.html")
@click.option("--only", metavar="KEY,...", help="Entries to compute; default: all of them.")
@path_option("-o", "--output", help="Write the atlas as one self-contained FILE.html.")
@json_option
@overwrite_option
@report_errors
def failures(only: str | None, output: Path | None, as_json: bool) -> None:
    """Show how methods fail: wrong numbers, computed beside the right ones."""
    check_output("-o", output, [".html"])
    found = []
    with progress_bar("entries") as report:  # what is imported takes a while, too
        from kvtheory.charts.failures import ATLAS, findings
        from kvtheory.plots.failures import save_failures, shown

        keys = split(only) if only else list(ATLAS)
        for finding in findings(keys):
            found.append(finding)
            report(len(found) / len(keys), f"{len(found)} of {len(keys)}")
        if output:
            save_failures(found, output)
    if as_json:
        print_json({"failures": [finding.as_dict() for finding in found]})
        return
    roles = ("wrong", "right", "package")
    print_table(
        ("entry", "quantity", "wrong", "right", "this package"),
        [(f.entry.key, f.entry.quantity, *(shown(f, role) for role in roles)) for f in found],
    )
    for finding in found if only else []:
        entry = finding.entry
        click.echo(f"\n{entry.title}. {entry.scene}.\n{entry.why}")
        click.echo(f"How to notice: {entry.notice}\nThis package: {entry.package}")
        click.echo(finding.outcome.said, nl=bool(finding.outcome.said))
    if output:
        click.echo(f"\n{output}")


@chart.command(cls=Examples, example="kvtheory chart stability -o stability.png")
@path_option(
    "-o", "--output", default=Path("stability.png"), show_default=True,
    help="Picture; its data go to FILE.json beside it.",
)  # fmt: skip
@click.option("--quick", is_flag=True, help="Coarser maps.")
@overwrite_option
@report_errors
def stability(output: Path, quick: bool) -> None:
    """Map where each scheme of the elements is stable: predicted over measured."""
    check_chart(output)
    with progress_bar("maps") as report:
        from kvtheory.charts.stability import stability_maps
        from kvtheory.plots.stability import save_stability

        save_stability(stability_maps(quick=quick, progress=report), output)
    click.echo(f"{output}\n{output.with_suffix('.json')}")


@chart.command(
    "work-precision",
    cls=Examples,
    example="kvtheory chart work-precision my-scene.toml --quick -o speed.png",
)
@scene_options
@click.option(
    "--standard", metavar="NAME,...",
    help="Instead of a scene: table-1, low-velocity, high-velocity, small-inertia, stop-and-go, "
    "reversal, hop, or all.",
)  # fmt: skip
@click.option("--quick", is_flag=True, help="Fewer settings and repeats: some 15 s for a scene.")
@path_option(
    "-o", "--output", default=Path("work_precision.png"), show_default=True,
    help="Picture, or a directory for it; its data go to FILE.json beside it.",
)  # fmt: skip
@overwrite_option
@report_errors
def work_precision(
    scene: str | None, overrides: Sequence[str], standard: str | None, quick: bool, output: Path
) -> None:
    """Chart the speed of all methods against their accuracy, on SCENE."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
    if output.is_dir():
        output /= "work_precision.png"
    check_chart(output)
    if standard and (scene or overrides):
        raise ValueError("--standard names its own scenes; it does not go with SCENE or --set")
    with progress_bar("methods") as report:
        from kvtheory.charts.collection import chosen, measure
        from kvtheory.plots.work_precision import default_errors, save_work_precision
        from kvtheory.scene import load_scene

        standards = split(standard) if standard else []
        jobs = chosen(load_scene(scene, overrides), standards, quick=quick)
        charts = measure(jobs, quick=quick, progress=report)
        save_work_precision(charts, output)
    click.echo(f"{output}\n{output.with_suffix('.json')}")
    for one in charts:
        (error,) = default_errors([one])
        references, what = " and ".join(one.reference), error.split(",")[0]
        click.echo(f"{one.name}: {references} agree on {what} to {one.floor[error]:.1e}")
