"""What the commands share: errors that teach, options of a scene, tables and JSON."""

import json
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import click

SHOWN_UNITS = {
    "s": ("ms", 1e3),
    "m": ("mm", 1e3),
    "N/m": ("N/mm", 1e-3),
    "Pa": ("MPa", 1e-6),
    "m/s": ("mm/s", 1e3),
    "1": ("", 1.0),
}
"""Units of the tables for people, as in the paper; JSON and CSV are in SI."""


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


def split(text: str) -> list[str]:
    """Split a comma-separated option."""
    return [item.strip() for item in text.split(",") if item.strip()]


def shown(value: float, unit: str) -> tuple[str, str]:
    """Return an SI value as text in the unit of the tables, and that unit."""
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


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    table = [heads, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    for row in table:
        click.echo(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        )
