"""The common parts of commands: error messages, options of a scene, tables and JSON."""

import json
import math
import re
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import wraps
from typing import Any

import click

from kvtheory.cli.group import INTERRUPTED, leave_quietly

LARGE_ERROR = 0.05
"""Of the static state: a larger one is seen in any plot, and is beyond the scatter of a good measurement."""
BEGUN = "kvtheory.begun"
"""When a command began to work, in the meta of its context."""
BAD_INPUT, FAULTY = 2, 70
"""Exit status for bad input, and for an internal error."""


class Examples(click.Command):
    """A command whose help ends with an example, printed as it stands."""

    def __init__(self, *args: Any, example: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.example = example

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the options."""
        with formatter.section("Example"):
            formatter.write(f"{'':{formatter.current_indent}}{self.example}\n")  # never wrapped


def report_errors(command: Callable[..., None]) -> Callable[..., None]:
    """Turn errors about the input into one message and exit status 2, which is never 1."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except BrokenPipeError:
            leave_quietly()
        except KeyboardInterrupt as error:
            exit_with(str(error) or "interrupted", INTERRUPTED)
        except MemoryError as error:
            exit_with(f"error: out of memory: {str(error) or 'ask for less at a time'}", BAD_INPUT)
        except OSError as error:
            if error.filename is None and error.errno is not None:
                leave_quietly(f"the output cannot be written: {error.strerror}")
            named = f'"{error.filename}": {error.strerror}' if error.filename else str(error)
            exit_with(f"error: {in_options(named)}", BAD_INPUT)
        except (ValueError, ArithmeticError, RuntimeError) as error:
            lines = in_options(str(error)).splitlines() or [type(error).__name__]
            count = len(getattr(error, "problems", lines))
            head = "error:" if count == 1 else f"{count:,} mistakes:\n "
            exit_with(f"{head} " + "\n  ".join(lines), BAD_INPUT)
        except Exception:
            exit_with(f"internal error, please report it:\n{traceback.format_exc()}", FAULTY)

    return run


def exit_with(message: str, status: int) -> None:
    """Write a message to standard error, if that can be written, and exit."""
    from kvtheory.scene.quantities import printable

    with suppress(OSError):
        click.echo("\n".join(map(printable, f"kvtheory: {message}".splitlines())), err=True)
    sys.exit(status)


def in_options(message: str) -> str:
    """Replace the names of arguments in a message of the library by the options of this command.

    >>> with click.Context(click.Command("a", params=[click.Option(["--per-length"])])):
    ...     in_options("`per_length` = 3: expected a quantity in 1/m; see `h`")
    '--per-length = 3: expected a quantity in 1/m; see `h`'
    """
    context = click.get_current_context(silent=True)
    named = {p.name: p.opts[0] for p in context.command.params} if context else {}
    return re.sub(r"`(\w+)`", lambda found: named.get(found[1], found[0]), message)


def scene_command(
    group: click.Group, example: str
) -> Callable[[Callable[..., None]], click.Command]:
    """Declare a command on an optional scene file, with `--set` and `--json`."""

    def decorate(function: Callable[..., None]) -> click.Command:
        command = scene_options(json_option(report_errors(function)))
        return group.command(cls=Examples, example=example)(command)

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


def shown(value: float, unit: str) -> tuple[str, str]:
    """Return an SI value as text in the unit of the tables, and that unit."""
    from kvtheory.results import SHOWN_UNITS

    name, factor = SHOWN_UNITS[unit]
    return ("-" if math.isnan(value) else f"{value * factor:.6g}"), name


def text(value: float, unit: str) -> str:
    """Return an SI value with the unit of the tables; a value that does not exist is a dash."""
    return "-" if math.isnan(value) else " ".join(shown(value, unit)).rstrip()


def print_json(result: Any) -> None:
    """Print the one JSON object of a command."""
    plain = "utf" not in (getattr(sys.stdout, "encoding", None) or "").lower()
    click.echo(json.dumps(result, indent=2, ensure_ascii=plain, allow_nan=False))


def print_series(result: Any, *, whole: bool, remedy: str) -> None:
    """Print a time series as a table: every row, or about twenty of them with both ends.

    Above it stands a large error, with its remedy.
    """
    from kvtheory.results import SHOWN_UNITS

    errors = result.certificate.relative_error
    if large := {name: error for name, error in errors.items() if not error <= LARGE_ERROR}:
        named = ", ".join(f"{name} {error:.2g}" for name, error in large.items())
        told = f"! Large error, relative to {result.certificate.relative_to}: {named}. {remedy}"
        click.secho(told, bold=True)
    last = result.time.size - 1
    rows = range(last + 1) if whole else sorted({round(i * last / 20) for i in range(21)})
    units = {name: unit for name, unit in result.units.items() if name != "depth_rate"}
    print_table(
        [f"{name} [{SHOWN_UNITS[unit][0]}]" for name, unit in units.items()],
        [[shown(getattr(result, name)[i], unit)[0] for name, unit in units.items()] for i in rows],
    )


def print_scenes(scene: Any, result: Any, units: Mapping[str, str]) -> None:
    """Print some quantities of many scenes: a row for each, or about twenty with both ends."""
    import numpy as np  # as a help text needs none

    specs = scene.replaceable
    columns: dict[str, tuple[Any, str]] = {}
    for key, values in scene.arrays().items():
        columns[f"{key} [{specs[key].unit}]".removesuffix(" [1]")] = values, "1"
    for name, unit in units.items():
        columns[f"{name} [{shown(0.0, unit)[1]}]".removesuffix(" []")] = getattr(result, name), unit
    flat = {name: np.broadcast_to(x, scene.shape).ravel() for name, (x, _) in columns.items()}
    last = math.prod(scene.shape) - 1
    rows = sorted({round(i * last / 20) for i in range(21)}) if last >= 0 else []
    print_table(
        list(columns),
        [
            [shown(float(flat[name][i]), unit)[0] for name, (_, unit) in columns.items()]
            for i in rows
        ],
    )
    if len(rows) <= last:
        click.echo(f"{len(rows)} of {last + 1:,} scenes; --json prints all")


def print_steady(result: Any, names: Iterable[str]) -> None:
    """Print some quantities of steady sliding with their errors."""
    errors = result.certificate.relative_error
    print_table(
        ("quantity", "value", "unit", "relative error"),
        [
            (name, *shown(getattr(result, name), result.units[name]), f"{errors[name]:.1e}")
            for name in names
        ],
    )


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    from kvtheory.results.presented import aligned

    for line in aligned(heads, rows):
        click.echo(line)
