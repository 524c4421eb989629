"""`kvtheory sweep`: many scenes into one file."""

import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli.console import print_json, scene_command, split
from kvtheory.cli.group import main

if TYPE_CHECKING:
    from kvtheory.scene import Scene
    from kvtheory.sweeps.progress import Progress
    from kvtheory.sweeps.result import Sweep

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it."""
SHOWN_FAILURES = 5


@scene_command(
    main,
    'kvtheory sweep --over "drive.velocity=1 mm/s:10 m/s:200:log" '
    '--over "foundation.retardation_time=10 ms,100 ms,1 s" -o map.csv',
)
@click.option(
    "--over", "overs", multiple=True, required=True, metavar="KEY=VALUES",
    help="Sweep a key over START:STOP:COUNT[:log] or V1,V2,...; repeatable, for all combinations. "
    "KEY=VALUES & KEY=VALUES in one option vary together.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), required=True,
    help="FILE.csv or FILE.nc; FILE.part keeps what is done, until all is. The same command resumes.",
)  # fmt: skip
@click.option(
    "--quantity", "quantities", multiple=True, metavar="NAME,...",
    help="What to write; default: all steady quantities. Of a transient: friction_force.max (.min, "
    ".end, .time_of_max), peak_to_steady_friction, settling_time, hops, events.",
)  # fmt: skip
@click.option(
    "--at", default=None, metavar='"0 ms,1 ms,..."', help="Times of series of a transient."
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option("--method", default=None, metavar="exact|quadrature|asymptote", help="As in steady.")
@click.option("--jobs", type=click.IntRange(1), default=None, help="Workers; default: 1.")
@click.option(
    "--executor", "factory", default=None, metavar="MODULE:FACTORY",
    help="Gives a concurrent.futures.Executor; called with the number of jobs, if that is given.",
)  # fmt: skip
@click.option("--block", type=click.IntRange(1), default=None, help="Scenes in a block.")
@click.option(
    "--plot", type=click.Path(path_type=Path), default=None,
    help="Draw the first quantity to FILE.png, .svg or .pdf.",
)  # fmt: skip
def sweep(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    overs: Sequence[str],
    output: Path,
    quantities: Sequence[str],
    at: str | None,
    rtol: float,
    method: str | None,
    jobs: int | None,
    factory: str | None,
    block: int | None,
    plot: Path | None,
) -> None:
    """Solve SCENE for many values of its quantities, into a file that survives and resumes."""
    from kvtheory.scene import load_scene
    from kvtheory.sweeps.axes import read_over
    from kvtheory.sweeps.progress import Progress

    checked, over = load_scene(scene, overrides), read_over(overs)
    if plot:
        from kvtheory.plots.sweep import check_picture, save_sweep_plot

        check_picture(plot)
    progress, began = Progress(), time.perf_counter()
    with ExitStack() as stack:
        result = _run(
            checked, over=over, quantities=[n for text in quantities for n in split(text)] or None,
            at=None if at is None else split(at), method=method, rtol=rtol, jobs=jobs or 1, block=block,
            executor=stack.enter_context(_executor(factory, jobs)) if factory else None,
            output=output, progress=progress,
        )  # fmt: skip
    seconds = time.perf_counter() - began
    computed = progress.finish()
    if plot:
        save_sweep_plot(result, plot)
    _tell(result, computed, seconds, as_json)


def _run(scene: "Scene", *, output: Path, progress: "Progress", **asked: Any) -> "Sweep":
    """Run the sweep; an interrupt ends the command, and says that the file can be gone on with."""
    from kvtheory.api import sweep as run

    try:
        return run(scene, output=output, progress=progress, **asked)
    except KeyboardInterrupt:
        progress.finish()
        told = f'interrupted; "{output}" has what was done, and the same command goes on'
        click.echo(f"kvtheory: {told}", err=True)
        sys.exit(INTERRUPTED)


def _executor(factory: str, jobs: int | None) -> Any:
    from kvtheory.sweeps.workers import from_factory

    sys.path.insert(0, "")  # a module in the working directory, as `python -m` finds it
    return from_factory(factory, jobs)


def _tell(result: "Sweep", computed: int, seconds: float, as_json: bool) -> None:
    """Print the summary."""
    from kvtheory.results import record

    if as_json:
        print_json(
            {
                "file": str(result.path),
                "points": result.points,
                "computed": computed,
                "failed": result.failed,
                "failures": record(result.failures),
                "seconds": seconds,
            }
        )
        return
    click.echo(
        f"{result.path}: {result.points:,} points, {computed:,} of them computed now in "
        f"{seconds:.3g} s, {result.failed:,} failed."
    )
    for failure in result.failures[:SHOWN_FAILURES]:
        point = ", ".join(f"{key} = {value:.6g}" for key, value in failure.point.items())
        click.echo(f"  {point}: {failure.reason}")
    if result.failed > SHOWN_FAILURES:
        click.echo(f"  ... the others are in {result.path}")
