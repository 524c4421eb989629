"""What the commands share: errors that teach, options of a scene, tables and JSON."""

import json
import math
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import wraps
from typing import Any

import click

PATIENCE = 1.0
"""Seconds before a progress bar is shown."""
BAR_LENGTH = 1000
"""Parts in which progress is shown."""


class Examples(click.Command):
    """A command whose help ends with an example, printed as it stands."""

    def __init__(self, *args: Any, example: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.example = example

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the options."""
        with formatter.section("Example"):
            formatter.write(f"{'':{formatter.current_indent}}{self.example}\n")  # never wrapped


def teaching(command: Callable[..., None]) -> Callable[..., None]:
    """Turn errors about the input into one message and exit status 2."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except BrokenPipeError:
            raise  # the reader of the output has gone; click ends quietly
        except (ValueError, ArithmeticError, OSError, RuntimeError) as error:
            lines = str(error).splitlines()
            head = "error:" if len(lines) == 1 else f"{len(lines)} mistakes:\n "
            click.echo(f"kvtheory: {head} " + "\n  ".join(lines), err=True)
            sys.exit(2)

    return run


def scene_command(
    group: click.Group, example: str
) -> Callable[[Callable[..., None]], click.Command]:
    """Declare a command on an optional scene file, with `--set` and `--json`."""

    def decorate(function: Callable[..., None]) -> click.Command:
        command = teaching(function)
        command = click.option(
            "--json", "as_json", is_flag=True, help="Print one JSON object, in SI units."
        )(command)
        command = click.option(
            "--set", "overrides", multiple=True, metavar="KEY=VALUE",
            help='Override a key of the scene, such as drive.velocity="50 mm/s"; repeatable.',
        )(command)  # fmt: skip
        command = click.argument(
            "scene", required=False, type=click.Path(exists=True, dir_okay=False)
        )(command)
        return group.command(cls=Examples, example=example)(command)

    return decorate


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None] | None]:
    """Give a function that shows the share done, if a terminal looks on and the work takes a while."""
    if not sys.stderr.isatty():
        yield None
        return
    begun, bars = time.monotonic(), ExitStack()
    shown: list[Any] = []

    def report(share: float) -> None:
        if not shown and time.monotonic() - begun > PATIENCE:
            bar = click.progressbar(length=BAR_LENGTH, label=label, file=sys.stderr)
            shown.append(bars.enter_context(bar))
        for bar in shown:
            bar.update(int(share * BAR_LENGTH) - bar.pos)

    with bars:
        yield report


def split(text: str) -> list[str]:
    """Split a comma-separated option."""
    return [item.strip() for item in text.split(",") if item.strip()]


def shown(value: float, unit: str) -> tuple[str, str]:
    """Return an SI value as text in the unit of the tables, and that unit."""
    from kvtheory.results import SHOWN_UNITS

    name, factor = SHOWN_UNITS[unit]
    return ("-" if math.isnan(value) else f"{value * factor:.6g}"), name


def text(value: float, unit: str) -> str:
    """Return an SI value with the unit of the tables; what does not exist is a dash."""
    return "-" if math.isnan(value) else " ".join(shown(value, unit)).rstrip()


def velocity_range(low: float, high: float) -> str:
    """Say between which velocities something holds."""
    if low == 0.0 and high == float("inf"):
        return "every V"
    return f"|V| <= {text(high, 'm/s')}" if low == 0.0 else f"|V| >= {text(low, 'm/s')}"


def print_json(result: Any) -> None:
    """Print the one JSON object of a command."""
    click.echo(json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False))


def print_series(result: Any, *, whole: bool) -> None:
    """Print a time series for people: every row, or about twenty of them with both ends."""
    from kvtheory.results import SHOWN_UNITS, TRANSIENT_UNITS

    count, most = result.time.size, 21
    rows = (
        range(count)
        if whole
        else sorted({round(i * (count - 1) / (most - 1)) for i in range(most)})
    )
    names = [name for name in TRANSIENT_UNITS if name != "depth_rate"]
    print_table(
        [f"{name} [{SHOWN_UNITS[TRANSIENT_UNITS[name]][0]}]" for name in names],
        [
            [shown(getattr(result, name)[i], TRANSIENT_UNITS[name])[0] for name in names]
            for i in rows
        ],
    )


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    table = [heads, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    for row in table:
        click.echo(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        )
