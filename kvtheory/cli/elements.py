"""`kvtheory elements`: the motion from rest by point elements, over time."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import click

from kvtheory.cli.console import print_json, print_series, scene_command, split
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_output

LONG_RUN = 10_000
"""Steps; shorter runs end before a bar could be read."""


@scene_command(
    main,
    'kvtheory elements --at "0 ms,1 ms,10 ms" --scheme paper && kvtheory elements -o run.csv',
)
@click.option(
    "--per-length", default="200 /mm", show_default=True, help="Elements per length, 1/dx."
)
@click.option(
    "--scheme",
    default="edge-corrected",
    show_default=True,
    help="paper, explicit-euler, semi-implicit, exponential or edge-corrected.",
)
@click.option("--time-step", default=None, metavar='"10 us"', help="Default: 2 dx/V or less.")
@click.option("--at", default=None, metavar='"0 ms,1 ms,..."', help="Times to report.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=None,
    help="Write FILE.csv or FILE.nc.",
)
def elements(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    per_length: str,
    scheme: str,
    time_step: str | None,
    at: str | None,
    output: Path | None,
) -> None:
    """Simulate SCENE by point elements that move with the base: any shape, support and drive."""
    from kvtheory.api import elements as simulate
    from kvtheory.export import SERIES_SUFFIXES, save_transient
    from kvtheory.scene import load_scene

    check_output("-o", output, SERIES_SUFFIXES)  # before a run that may be long
    with _bar() as progress:
        result = simulate(
            load_scene(scene, overrides),
            per_length=per_length,
            scheme=scheme,
            time_step=time_step,
            at=None if at is None else split(at),
            progress=progress,
            warn=lambda text: click.echo(f"kvtheory: warning: {text}", err=True),
        )
    if output:
        save_transient(result, output)
    if as_json:
        print_json(result.as_dict())
        return
    print_series(result, whole=at is not None)
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.scheme}, {result.per_length / 1e3:g} elements per mm, {result.steps} steps of at most "
        f"{result.time_step * 1e3:.4g} ms; error estimated at {worst:.1e}: "
        f"{result.certificate.statement}."
    )


@contextmanager
def _bar() -> Iterator[Callable[[int, int], None] | None]:
    """Show the steps done of a long run on a terminal; elsewhere, show nothing."""
    if not sys.stderr.isatty():
        yield None
        return
    with ExitStack() as stack:
        bars: list[Any] = []

        def progress(done: int, total: int) -> None:
            if not bars:
                if total < LONG_RUN:
                    return
                bar = click.progressbar(length=total, label="steps", file=sys.stderr, show_pos=True)
                bars.append(stack.enter_context(bar))
            bars[0].update(done - bars[0].pos)

        yield progress
