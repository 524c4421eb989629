"""`kvtheory sweep`: many scenes into one file."""

import pkgutil
import sys
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main
from kvtheory.cli.outputs import OVERWRITE, OutputFile

SHOWN_FAILURES = 5
EXAMPLE = '"drive.velocity=1 mm/s:10 m/s:200:log" or "foundation.retardation_time=10 ms,1 s"'


@main.command(
    example=(
        'kvtheory sweep --over "drive.velocity=1 mm/s:10 m/s:200:log" '
        '--over "foundation.retardation_time=10 ms,100 ms,1 s" -o map.csv'
    )
)
@console.scene_options
@console.json_option
@click.option(
    "--over", multiple=True, metavar="KEY=VALUES",
    help="Sweep a key over START:STOP:COUNT[:log] or V1,V2,...; repeatable, for all combinations. "
    "KEY=VALUES & KEY=VALUES in one option vary together. Lists in SCENE are the first axis.",
)  # fmt: skip
@click.option(
    "-o", "--output", required=True, type=OutputFile(),
    help="FILE.csv or FILE.nc; until all is done, FILE.part keeps finished blocks. The same command resumes.",
)  # fmt: skip
@console.names_option(
    "--quantity", "quantities",
    help="What to write; default: all steady quantities, and with a spring whether steady sliding is "
    "stable. Of a transient: friction_force.max (.min, .end, .time_of_max), peak_to_steady_friction, "
    "settling_time, hops, events; with a spring stick_slip_settles, stick_slip_amplitude, "
    "stick_slip_period, sliding_velocity.cycle_max.",
)  # fmt: skip
@console.at_option
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option("--method", metavar="exact|quadrature|asymptote|layer", help="As in steady.")
@click.option("--jobs", type=click.IntRange(1), help="Workers; default: 1.")
@click.option(
    "--executor", metavar="MODULE:FACTORY",
    help="Factory of a concurrent.futures.Executor; called with the number of jobs, if given.",
)  # fmt: skip
@click.option("--block", type=click.IntRange(1), help="Scenes in a block.")
@console.overwrite_option
@console.plot_option
def sweep(
    scene: str | None, overrides: Sequence[str], as_json: bool, over: Sequence[str],
    output: Path, quantities: list[str] | None, jobs: int | None, executor: str | None,
    block: int | None, plot: Path | None, **how: Any,
) -> None:  # fmt: skip
    """Solve SCENE for many values of its quantities.

    The same command resumes an interrupted sweep from its file.
    """
    from kvtheory.api import sweep as run
    from kvtheory.api._sweep import plan_of
    from kvtheory.results import record
    from kvtheory.scene import load_scene
    from kvtheory.sweeps.plan import REMARKS

    what: dict[str, Any] = {
        "scene": load_scene(scene, overrides), "over": read_over(over), **how,
        "quantities": quantities,
    }  # fmt: skip
    plan = plan_of(**what)
    if plot:
        from kvtheory.plots import save_plot
        from kvtheory.plots.sweep import check_drawable

        check_drawable(plan)
    began = time.perf_counter()
    with ExitStack() as stack:
        progress = stack.enter_context(console.progress_bar("sweep"))
        pool = stack.enter_context(from_factory(executor, jobs)) if executor else None
        try:
            result = run(
                **what, executor=pool, jobs=jobs or 1, block=block, output=output,
                overwrite=click.get_current_context().meta[OVERWRITE], progress=progress,
            )  # fmt: skip
        except KeyboardInterrupt:
            left = f'"{output}" holds the finished points, and the same command resumes'
            raise KeyboardInterrupt(f"interrupted; {left}") from None
    seconds = time.perf_counter() - began
    if plot:
        save_plot(result, plot)
    if as_json:
        counts = {name: getattr(result, name) for name in ("points", "computed", "failed")}
        outcome = {"failures": record(result.failures), "seconds": seconds, "notes": result.notes}
        console.print_json({"file": str(result.path), **counts, **outcome})
        return
    click.echo(
        f"{output}: {result.points:,} points, {result.computed:,} of them computed now in "
        f"{seconds:.3g} s, {result.failed:,} failed."
    )
    if output.suffix.lower() == ".csv":
        click.echo(
            'The lines above the table describe it: read it by pandas.read_csv(FILE, comment="#").'
        )
    for remark in REMARKS:
        if remark in result.certificate.statement:
            click.echo(f"{remark[0].upper()}{remark[1:]}.")
    for note in result.notes:
        click.echo(note)
    for failure in result.failures[:SHOWN_FAILURES]:
        point = ", ".join(f"{key} = {value:.6g}" for key, value in failure.point.items())
        click.echo(f"  {point}: {failure.reason}")
    if result.failed > SHOWN_FAILURES:
        click.echo(f"  ... the others are in {output}")


def read_over(texts: Iterable[str]) -> dict[Any, Any]:
    """Turn ``KEY=VALUES`` texts into `over`; with ``KEY=VALUES & KEY=VALUES`` both vary together."""
    from kvtheory.scene.mistakes import Problems

    over: dict[Any, Any] = {}
    problems = Problems()
    for text in texts:
        pairs = [part.partition("=") for part in text.split("&")]
        if not all(key.strip() and sign and value.strip() for key, sign, value in pairs):
            problems.append(f'--over "{text}": expected KEY=VALUES, such as {EXAMPLE}')
            continue
        keys = tuple(key.strip() for key, _, _ in pairs)
        values = tuple(value.strip() for _, _, value in pairs)
        if keys in over or keys[0] in over:
            problems.append(f'--over "{text}": {keys[0]} is swept already')
            continue
        over |= {keys: values} if len(keys) > 1 else {keys[0]: values[0]}
    problems.report()
    return over


def from_factory(text: str, jobs: int | None) -> Executor:
    """Call the factory ``module:name`` of executors, with the number of jobs if one is given."""
    from kvtheory.scene.mistakes import nearest

    sys.path.insert(0, "")  # a module in the working directory, as `python -m` finds it
    try:
        if ":" not in text:
            raise ValueError(
                "expected module:factory, such as concurrent.futures:ThreadPoolExecutor"
            )
        executor = pkgutil.resolve_name(text)(*[] if jobs is None else [jobs])
        if not isinstance(executor, Executor) or type(executor) is Executor:
            raise ValueError(f"expected a concurrent.futures.Executor, got {executor!r}")
    except (Exception, SystemExit) as error:  # whatever a user's module raises
        known = [name for name in dir(getattr(error, "obj", None)) if name[0] != "_"]
        hint = f"; {nearest(text.partition(':')[2], known)}" if known else ""
        message = (
            f"{error}"
            if isinstance(error, ValueError)
            else f"{type(error).__name__}: {error}{hint}"
        )
        raise ValueError(f'--executor "{text}" cannot be imported and called: {message}') from None
    return executor
