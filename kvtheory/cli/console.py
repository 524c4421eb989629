"""The common parts of commands: options, a progress bar, what is printed and written."""

import json
import math
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial, wraps
from pathlib import Path
from typing import Any

import click

from kvtheory.cli.group import DISAGREES, main
from kvtheory.cli.outputs import PICTURES, SERIES_SUFFIXES, OutputFile
from kvtheory.lists import split

LARGE_ERROR = 0.05
"""Relative to the static state: visible in any plot, and beyond the scatter of a good measurement."""
WHOLE, ROWS = 40, 20
"""Most rows of a table that is printed whole; approximate number of rows printed of a longer one."""
START_TIME = "kvtheory.begun"
"""Start time of a command, in the meta of its context."""

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object, in SI units."
)
overwrite_option = click.option(
    "--overwrite", is_flag=True, help="Overwrite files of another kind than this command writes."
)
plot_option = click.option(
    "--plot", type=OutputFile(*PICTURES), help="Draw the result to FILE.png, .svg or .pdf."
)
at_option = click.option(
    "--at", metavar='"0 ms,1 ms,..."', multiple=True, callback=lambda *given: list(given[2]) or None,
    help="Times to report, or START:STOP:COUNT; repeatable.",
)  # fmt: skip


def names_option(*names: str, metavar: str = "NAME,...", **how: Any) -> Callable[[Any], Any]:
    """Declare an option of comma-separated names, repeatable: a list, or None where it is not given."""

    def listed(context: click.Context, option: click.Parameter, given: tuple[str, ...]) -> Any:
        try:
            return [name for each in given for name in split(each)] or None
        except ValueError as error:
            raise click.BadParameter(str(error), context, option) from None

    return click.option(*names, metavar=metavar, multiple=True, callback=listed, **how)


def result_options(command: Callable[..., Any]) -> Any:
    """Give a command `-o` for the file of its result, and `--plot`."""
    return click.option(
        "-o", "--output", type=OutputFile(*SERIES_SUFFIXES),
        help="Write the result to FILE.csv or FILE.nc.",
    )(plot_option(overwrite_option(command)))  # fmt: skip


def series_options(command: Callable[..., Any]) -> Any:
    """Give a command `--at` for the times of a series, `-o` for its file and `--plot`."""
    return at_option(result_options(command))


def scene_options(command: Callable[..., Any]) -> Any:
    """Give a command an optional scene file, and `--set`."""
    command = click.option(
        "--set", "overrides", multiple=True, metavar="KEY=VALUE",
        help='Override a key of the scene, such as drive.velocity="50 mm/s"; repeatable.',
    )(command)  # fmt: skip
    path = click.Path(exists=True, dir_okay=False)
    return click.argument("scene", required=False, type=path)(command)


Save = Callable[[Any, Any, Path], Any]
"""Writes a result, and its scene, to the file that `-o` or `--report` names."""


def scene_command(
    example: str, save: Save = lambda result, _, path: result.save(path)
) -> Callable[[Callable[..., Iterator[Any]]], click.Command]:
    """Declare a command on an optional scene file, with `--set` and `--json`.

    Its body gets the scene and a function that reports progress, and yields its result. This is written to
    files, all or none, or printed as JSON; else the body goes on, and prints it.
    """

    def declare(body: Callable[..., Iterator[Any]]) -> click.Command:
        @wraps(body)
        def command(
            scene: str | None, overrides: Sequence[str], as_json: bool, output: Path | None = None,
            plot: Path | None = None, **how: Any,
        ) -> None:  # fmt: skip
            with progress_bar(body.__name__) as progress:
                from kvtheory.scene import load_scene

                given = load_scene(scene, overrides)
                steps = body(given, progress, **how)
                result = next(steps)
            finish(result, steps, plot, {output: partial(save, result, given)}, as_json=as_json)
            if getattr(result, "verdict", "") == "disagrees":
                click.get_current_context().exit(DISAGREES)

        return main.command(example=example)(scene_options(json_option(command)))

    return declare


def finish(
    result: Any, steps: Iterator[Any], plot: Path | None,
    writers: Mapping[Path | None, Callable[[Path], Any]], *, as_json: bool,
) -> None:  # fmt: skip
    """Write the files of a result and its picture, all or none; then print it, or its JSON."""
    write_files({path: write for path, write in writers.items() if path}, result, plot)
    if as_json:
        print_json(result.as_dict())
    else:
        next(steps, None)


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[..., Any]]:
    """Provide a function that shows the fraction done, and a text, if the command takes long."""
    from kvtheory import progress

    context = click.get_current_context(silent=True)
    begun = context.meta.setdefault(START_TIME, time.monotonic()) if context else None
    with progress.progress_bar(label, begun) as report:
        yield report


def text(value: Any, unit: str) -> str:
    """Return an SI value with the unit of the tables; a value that does not exist is a dash."""
    from kvtheory.results.presented import with_unit

    return with_unit(value, unit)


def error_text(error: float) -> str:
    """Return a relative error; one that is not known is a dash."""
    return "-" if math.isnan(error) else f"{error:.1e}"


def write_files(
    writers: Mapping[Path, Callable[[Path], Any]], result: Any, plot: Path | None
) -> None:
    """Write files, and the picture of a result; all are made before any is put in place."""
    from kvtheory.export import replace_files

    with progress_bar("writing"):
        if plot:
            from kvtheory.plots import save_plot

            writers = {**writers, plot: partial(save_plot, result)}
        replace_files(writers)


def print_json(result: Any) -> None:
    """Print the one JSON object of a command."""
    plain = "utf" not in (getattr(sys.stdout, "encoding", None) or "").lower()
    click.echo(json.dumps(result, indent=2, ensure_ascii=plain, allow_nan=False))


def print_series(result: Any, *, whole: bool, remedy: str) -> None:
    """Print a time series: every row, or of many about twenty; above it a large error, with its remedy.

    Quantities that `solve` was not asked for are left out.
    """
    import numpy as np  # not needed for help texts

    errors = result.certificate.relative_error
    if large := {name: error for name, error in errors.items() if not error <= LARGE_ERROR}:
        named = ", ".join(f"{name} {error:.2g}" for name, error in large.items())
        scale = result.certificate.relative_to
        click.secho(f"! Large error, relative to {scale}: {named}. {remedy}", bold=True)
    columns = {
        name: (getattr(result, name), unit)
        for name, unit in result.units.items()
        if name != "depth_rate" and (name in errors or not np.isnan(getattr(result, name)).all())
    }
    _print_columns(columns, result.time.size, whole=whole)


def print_error(about: str, result: Any) -> None:
    """Print the last line of a result: about the model, then its largest error and what that covers."""
    worst, given = max(result.certificate.relative_error.values()), result.certificate
    click.echo(f"\n{about}; error {given.kind} at {worst:.1e} or less: {given.statement}.")
    for note in getattr(result, "notes", ()):
        click.echo(note)


def print_scenes(scene: Any, result: Any, units: Mapping[str, str]) -> None:
    """Print some quantities of many scenes: a row for each, or of many about twenty with both ends."""
    import numpy as np  # not needed for help texts

    held = {name: (getattr(result, name), unit) for name, unit in units.items()}
    for key, values in reversed(scene.arrays().items()):
        held = {
            f"{key} [{scene.replaceable[key].unit}]".removesuffix(" [1]"): (values, "1"),
            **held,
        }
    columns = {}
    for name, (values, unit) in held.items():
        columns[name] = np.broadcast_to(values, scene.shape).ravel(), unit
    count = math.prod(scene.shape)
    if (rows := _print_columns(columns, count)) < count:
        click.echo(f"{rows} of {count:,} scenes; --json prints all")


def _print_columns(
    columns: Mapping[str, tuple[Any, str]], count: int, *, whole: bool = False
) -> int:
    """Print the rows of columns, or of many about twenty with both ends; return how many."""
    from kvtheory.results import SHOWN_UNITS
    from kvtheory.results.presented import in_shown_unit

    rows = range(count)
    if count > WHOLE and not whole:
        rows = sorted({round(i * (count - 1) / ROWS) for i in range(ROWS + 1)})  # type: ignore[assignment]
    heads = [f"{name} [{SHOWN_UNITS[unit][0]}]" for name, (_, unit) in columns.items()]
    print_table(
        [head.removesuffix(" []") for head in heads],
        [[in_shown_unit(values[i], unit)[0] for values, unit in columns.values()] for i in rows],
    )
    return len(rows)


def print_quantities(
    result: Any, units: Mapping[str, str], names: Mapping[str, str] | None = None
) -> None:
    """Print quantities of a result as a table, with their relative errors."""
    from kvtheory.results.presented import in_shown_unit

    errors = result.certificate.relative_error
    rows = []
    for name, unit in units.items():
        error = error_text(errors.get(name, math.nan))
        shown = in_shown_unit(getattr(result, name), unit)
        rows.append(((names or {}).get(name, name), *shown, error))
    print_table(("quantity", "value", "unit", "relative error"), rows)


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    from kvtheory.results.presented import aligned

    for line in aligned(heads, rows):
        click.echo(line)
