"""The common parts of commands: the options of a scene, a progress bar, tables and JSON."""

import json
import math
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import click

LARGE_ERROR = 0.05
"""Of the static state: a larger one is seen in any plot, and is beyond the scatter of a good measurement."""
ROWS = 20
"""Rows of a long table, about."""
BEGUN = "kvtheory.begun"
"""When a command began to work, in the meta of its context."""


def scene_command(
    group: click.Group, example: str
) -> Callable[[Callable[..., None]], click.Command]:
    """Declare a command on an optional scene file, with `--set` and `--json`."""

    def decorate(function: Callable[..., None]) -> click.Command:
        return group.command(example=example)(scene_options(json_option(function)))

    return decorate


def scene_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command an optional scene file, and `--set`."""
    command = click.option(
        "--set", "overrides", multiple=True, metavar="KEY=VALUE",
        help='Override a key of the scene, such as drive.velocity="50 mm/s"; repeatable.',
    )(command)  # fmt: skip
    path = click.Path(exists=True, dir_okay=False)
    return click.argument("scene", required=False, type=path)(command)


json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object, in SI units."
)


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[..., None]]:
    """Provide a function that shows the share done, and a text, when work takes long.

    A terminal shows every second or so that the work goes on, also where it reports nothing.
    """
    from kvtheory.progress import BEAT, PATIENCE, ProgressLine

    context = click.get_current_context(silent=True)
    begun = context.meta.setdefault(BEGUN, time.monotonic()) if context else time.monotonic()
    patience = max(PATIENCE - (time.monotonic() - begun), 0.0)  # of all parts of a command together
    line, over = ProgressLine(label, patience=patience), threading.Event()

    def beat() -> None:
        while not over.wait(BEAT / 2.0):
            line.beat()

    beating = threading.Thread(target=beat, daemon=True)
    beating.start()
    try:
        yield line
    finally:
        over.set()
        beating.join()
        line.finish()


def split(text: str) -> list[str]:
    """Split a comma-separated option."""
    return [item.strip() for item in text.split(",") if item.strip()]


def text(value: Any, unit: str) -> str:
    """Return an SI value with the unit of the tables; a value that does not exist is a dash."""
    from kvtheory.results.presented import with_unit

    return with_unit(value, unit)


def error_text(error: float) -> str:
    """Return a relative error; one that is not known is a dash."""
    return "-" if math.isnan(error) else f"{error:.1e}"


def print_json(result: Any) -> None:
    """Print the one JSON object of a command."""
    plain = "utf" not in (getattr(sys.stdout, "encoding", None) or "").lower()
    click.echo(json.dumps(result, indent=2, ensure_ascii=plain, allow_nan=False))


def print_series(result: Any, *, whole: bool, remedy: str) -> None:
    """Print a time series as a table: every row, or about twenty of them with both ends.

    A large error is printed above it, with its remedy.
    """
    errors = result.certificate.relative_error
    if large := {name: error for name, error in errors.items() if not error <= LARGE_ERROR}:
        named = ", ".join(f"{name} {error:.2g}" for name, error in large.items())
        scale = result.certificate.relative_to
        click.secho(f"! Large error, relative to {scale}: {named}. {remedy}", bold=True)
    names = [name for name in result.units if name != "depth_rate"]
    columns = {name: (getattr(result, name), result.units[name]) for name in names}
    count = result.time.size
    _print_columns(columns, range(count) if whole else _spread_over(count))


def print_scenes(scene: Any, result: Any, units: Mapping[str, str]) -> None:
    """Print some quantities of many scenes: a row for each, or about twenty with both ends."""
    import numpy as np  # as a help text needs none

    keys = {
        f"{key} [{scene.replaceable[key].unit}]".removesuffix(" [1]"): (values, "1")
        for key, values in scene.arrays().items()
    }
    columns = keys | {name: (getattr(result, name), unit) for name, unit in units.items()}
    count, flat = math.prod(scene.shape), {}
    for name, (values, unit) in columns.items():
        flat[name] = np.broadcast_to(values, scene.shape).ravel(), unit
    rows = _spread_over(count)
    _print_columns(flat, rows)
    if len(rows) < count:
        click.echo(f"{len(rows)} of {count:,} scenes; --json prints all")


def _spread_over(count: int) -> Sequence[int]:
    """Return all rows of a table, or about twenty, with both ends."""
    return sorted({round(i * (count - 1) / ROWS) for i in range(ROWS + 1)}) if count else []


def _print_columns(columns: Mapping[str, tuple[Any, str]], rows: Iterable[int]) -> None:
    """Print some rows of columns, in the units of the tables."""
    from kvtheory.results import SHOWN_UNITS
    from kvtheory.results.presented import in_shown_unit

    heads = [f"{name} [{SHOWN_UNITS[unit][0]}]" for name, (_, unit) in columns.items()]
    print_table(
        [head.removesuffix(" []") for head in heads],
        [[in_shown_unit(values[i], unit)[0] for values, unit in columns.values()] for i in rows],
    )


def print_quantities(
    result: Any, units: Mapping[str, str], names: Mapping[str, str] | None = None
) -> None:
    """Print some quantities of one scene with their errors, under other names where these are given."""
    from kvtheory.results.presented import in_shown_unit

    errors = result.certificate.relative_error
    print_table(
        ("quantity", "value", "unit", "relative error"),
        [
            (
                (names or {}).get(name, name), *in_shown_unit(getattr(result, name), unit),
                error_text(errors.get(name, math.nan)),
            )
            for name, unit in units.items()
        ],
    )  # fmt: skip


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    from kvtheory.results.presented import aligned

    for line in aligned(heads, rows):
        click.echo(line)
