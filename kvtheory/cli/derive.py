"""`kvtheory derive`: the derivations, checked and printed."""

import gc
import math
import os
import re
import shlex
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from kvtheory.cli import console
from kvtheory.cli.group import DISAGREES, main
from kvtheory.cli.outputs import check_output

if TYPE_CHECKING:
    from kvtheory.derivations.engine.record import Derivation
    from kvtheory.derivations.render import Edition

MOST_NAMED = 20
"""Largest number of labels in one message."""
DERIVING = 0.7
"""Share of the progress bar for deriving; the rest is for writing."""
SHAPE_SYMBOLS = {"radius": "R", "length": "L", "exponent": "n", "inclination": "c_1"}
SUPPORT_SYMBOLS = {"mass": "M", "gravity": "g", "stiffness": "k_s"}
"""Names of symbols by the keys of a scene."""
UNUSUAL_CHARACTER = re.compile(r"[^\w .,()+-]")
"""Replaced in the name of a scene, because a document could take it as mathematics or markup."""


@main.command(example="kvtheory derive -o my-thesis --format tex --only eq27,F3 --closure")
@console.scene_options
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    default=Path("paper/derivations"), show_default=True, help="Directory to write to.",
)  # fmt: skip
@console.names_option(
    "--format", "formats", metavar="tex,html,pdf,json,md,ipynb,bib",
    help="Default: all; pdf where a LaTeX engine is found.",
)  # fmt: skip
@console.names_option(
    "--only", metavar="eq27,F3,...",
    help="Labels of the derivations to print, such as eq27, 27, F3 or eq26-eq48.",
)  # fmt: skip
@click.option("--closure", is_flag=True, help="Add all derivations that these depend on, in order.")
@click.option(
    "--numbers", is_flag=True, help="Insert the quantities of SCENE into the closed forms."
)
@click.option(
    "--shape", default=None, metavar='"c*x**4"',
    help="Derive steady sliding for this surface of the indenter instead.",
)  # fmt: skip
@click.option(
    "--notation", type=click.Path(exists=True, dir_okay=False, path_type=Path), default=None,
    metavar="FILE.toml", help='Your symbols, as in l_r = "\\\\ell_r"; --symbols lists the names.',
)  # fmt: skip
@click.option(
    "--label-prefix", default="kv:", show_default=True, metavar="TEXT",
    help="Beginning of each \\label of a fragment.",
)  # fmt: skip
@click.option(
    "--columns", type=click.IntRange(1, 2), default=1, show_default=True,
    help="Columns of the page for which fragments are broken into lines.",
)  # fmt: skip
@click.option("--list", "listing", is_flag=True, help="List the labels, one line each, and stop.")
@click.option(
    "--symbols", is_flag=True, help="List the names of the symbols for --notation, and stop."
)
@click.option(
    "--recheck", is_flag=True,
    help="Check the claims again by python-flint, without SymPy; write nothing.",
)  # fmt: skip
@click.option(
    "--json", "as_json", is_flag=True,
    help="Print one JSON object about what was written or rechecked.",
)  # fmt: skip
@console.overwrite_option
def derive(
    scene: str | None, output: Path, formats: list[str] | None, only: list[str] | None, closure: bool,
    numbers: bool, shape: str | None, notation: Path | None, label_prefix: str, columns: int,
    overrides: Sequence[str], listing: bool, symbols: bool, recheck: bool, as_json: bool,
) -> None:  # fmt: skip
    """Derive the equations, check every step, and print them.

    LaTeX, HTML, PDF, Markdown, a notebook, JSON and BibTeX. Each derivation uses earlier ones, so all up to
    the last of --only are derived. Without --only all are, which takes half a minute the first time.

    With --recheck a second program, which shares nothing with the first, checks the claims of
    derivations.json again, and a table tells how. Exit status 1 if a claim is refuted.
    """
    from kvtheory.derivations.catalogue import CONTENTS
    from kvtheory.derivations.labels import find
    from kvtheory.derivations.render import check_directory, write_edition
    from kvtheory.derivations.render.edition import check_prefix
    from kvtheory.derivations.render.notation import NAMES, check_letters, plain, read_notation

    if symbols:
        from kvtheory.derivations.catalogue import SYMBOLS

        rows = [(plain(each.latex), each.latex, each.meaning, each.unit) for each in SYMBOLS]
        _print_rows(("name", "latex", "meaning", "unit"), rows, as_json)
        return
    if listing:
        _print_rows(("label", "title"), list(CONTENTS.items()), as_json)
        return
    if (scene or overrides) and not numbers:
        raise ValueError("SCENE and --set go with --numbers, which inserts their quantities")
    if shape is not None and (only or numbers or closure):
        message = "it does not go with --only, --closure or --numbers"
        raise ValueError(f"--shape derives a separate chapter; {message}")
    if recheck:
        placed = click.get_current_context().get_parameter_source("output")
        if formats or shape or numbers or notation or closure or placed != ParameterSource.DEFAULT:
            raise ValueError("--recheck writes nothing; it goes with --only and --json alone")
        _recheck(find(only or [], CONTENTS), as_json)
        return
    check_prefix(label_prefix)
    wanted, labels = _formats(formats), find(only or [], CONTENTS)
    letters = read_notation(notation) if notation else {}
    if not (labels or shape):  # all symbols are shown
        check_letters(letters, NAMES.values())
    given = _quantities(scene, overrides) if numbers else None
    check_directory(output)
    for name in wanted if output.is_dir() else ():
        check_output("-o", output / f"derivations.{name}", [f".{name}"])
    with console.progress_bar("derive") as report:
        deriving = lambda share, words: report(DERIVING * share, words)  # noqa: E731
        writing = lambda share, name: report(DERIVING + (1.0 - DERIVING) * share, name)  # noqa: E731
        edition = _edition(labels, closure, shape, letters, label_prefix, columns, given, deriving)
        gc.freeze()  # what was proved stays to the end
        paths = write_edition(edition, output, wanted, writing)
    _report(edition.derivations, output, paths, as_json=as_json, numbers=numbers)


def _recheck(labels: list[str], as_json: bool) -> None:
    """Derive, check the claims again, and print what was found."""
    import json

    from kvtheory.derivations.catalogue import catalogue
    from kvtheory.derivations.render import edition
    from kvtheory.derivations.render.json import document

    try:
        from kvtheory.derivations.recheck import report as second
    except ModuleNotFoundError:
        how = 'pip install ".[recheck]" in the checkout'
        raise ValueError(f"--recheck needs python-flint: {how}") from None
    with console.progress_bar("derive") as report:
        derived = catalogue(labels, report)
    verdicts = second.recheck(json.loads(document(edition(derived))), labels)
    counts = second.counts(verdicts)
    if as_json:
        records = {
            label: {name: asdict(each) for name, each in found.items()}
            for label, found in verdicts.items()
        }
        console.print_json({**counts, "records": records})
    else:
        console.print_table(second.HEADS, second.rows(verdicts))
        click.echo("Checked again: " + ", ".join(f"{status} {n}" for status, n in counts.items()))
        for name, verdict in second.having(verdicts, "refuted", "unconfirmed").items():
            click.echo(f"  {name} {verdict.status}: {verdict.how}")
    if counts["refuted"]:
        click.get_current_context().exit(DISAGREES)


def _formats(formats: list[str] | None) -> list[str]:
    """Return the requested formats, or by default all that can be written."""
    from kvtheory.derivations.render import FORMATS, check_formats, latex_engine

    if formats is not None:
        check_formats(formats)
        return formats
    if latex_engine():
        return list(FORMATS)
    click.echo("kvtheory: no PDF, as there is no LaTeX engine (pdflatex)", err=True)
    return [name for name in FORMATS if name != "pdf"]


Given = tuple[dict[str, float], str, tuple[tuple[float, float], ...], str]
"""Quantities, the shape, the arms of a Prony series, and a description of the scene."""


def _quantities(path: str | None, overrides: Sequence[str]) -> Given:
    """Return the quantities of a scene and of its steady state by the names of `calculation.GIVEN`.

    Also the shape of the indenter, the arms of the foundation, and a description of the scene. Forces, masses
    and springs of a ball are left out, because the symbols of the derivations stand for those per unit width.
    """
    from kvtheory.api import steady
    from kvtheory.scene import load_scene
    from kvtheory.scene.capabilities import lacks_numbers, lacks_quadratic
    from kvtheory.scene.indenters import Sphere
    from kvtheory.scene.static_state import StaticState

    scene = load_scene(path, overrides)
    if lacking := lacks_numbers(scene):
        raise ValueError(f"--numbers {lacking}")
    velocity = abs(scene.drive.final_velocity)
    if velocity == 0.0:
        raise ValueError(
            "--numbers: drive.velocity is 0; the closed forms are for a sliding indenter"
        )
    state, values, line = steady(scene), scene.values(), scene.indenter.per_width
    quantities = {
        "K": scene.foundation.stiffness, "V": velocity,
        "delta": float(state.depth), "mu": abs(float(state.friction_coefficient)),
    }  # fmt: skip
    if not scene.foundation.arms:
        quantities["tau"] = scene.foundation.retardation_time
        quantities["C"] = scene.foundation.damping
    if line:
        quantities |= {"W": float(state.load), "F": abs(float(state.friction_force))}
    if small := [name for name, value in quantities.items() if not 0.0 < value < math.inf]:
        raise ValueError(f"--numbers: {', '.join(small)} of this scene: out of range of a float")
    names = {f"indenter.{key}": name for key, name in SHAPE_SYMBOLS.items()}
    if line:
        names |= {f"support.{key}": name for key, name in SUPPORT_SYMBOLS.items()}
    quantities |= {name: values[key] for key, name in names.items() if key in values}
    if not lacks_quadratic(scene):
        at_rest = StaticState.of(scene)
        quantities |= {"delta_0": at_rest.depth, "a_0": at_rest.half_length}
        quantities["lambda"] = abs(at_rest.drive_number)
        if line:
            quantities["W_0"] = at_rest.load
        if not at_rest.fixed:
            quantities |= {"epsilon": at_rest.inertia_number, "kappa": at_rest.support_number}
    where = UNUSUAL_CHARACTER.sub("_", Path(path).name) if path else "Table 1"
    parts = ", ".join([f"{scene.support.kind} support", *([] if line else ["ball"])])
    arms = tuple((arm.stiffness, arm.relaxation_time) for arm in scene.foundation.arms)
    if arms and isinstance(scene.indenter, Sphere):
        quantities["R_y"] = scene.indenter.radius * scene.indenter.stretch**2
    return quantities, scene.indenter.shape, arms, f"{where} ({parts})"


def _edition(
    labels: list[str], closure: bool, shape: str | None, notation: dict[str, str], label_prefix: str,
    columns: int, given: Given | None, report: Callable[[float, str], None],
) -> "Edition":  # fmt: skip
    """Derive what was requested, after a line with the number of records."""
    from kvtheory import __version__
    from kvtheory.derivations.calculation import FOLLOWING, shown_quantities, with_numbers
    from kvtheory.derivations.catalogue import catalogue, wanted_up_to
    from kvtheory.derivations.render import edition
    from kvtheory.derivations.shape import derive_shape, symbols, title

    about: dict[str, Any] = {"command": _command(), "version": __version__, "notation": notation}
    about |= {"label_prefix": label_prefix, "columns": columns}
    if shape is not None:
        return edition(derive_shape(shape), **about, title=title(shape), symbols=symbols(shape))
    following = {label for label, _ in FOLLOWING} if given else set()
    needed = {*labels, *following} if labels else set()
    total, count = wanted_up_to(needed), len(labels)
    message = f"all {total} records; --only chooses some"
    if count:
        message = f"{total} records for the {count} asked for, since each uses earlier ones"
    click.echo(f"kvtheory: deriving {message}", err=True)
    derived: Iterable[Derivation] = catalogue(needed, report)
    if given:
        quantities, indenter, arms, where = given
        derived = with_numbers(derived, quantities, indenter, arms)
        about |= {"values": shown_quantities(quantities, indenter, arms), "scene": where}
    return edition(tuple(derived), labels, with_premises=closure, **about)


def _command() -> str:
    """Return the command that reproduces the content, wherever it is written."""
    context, words = click.get_current_context(), []
    options = {option.name: option.opts[-1] for option in context.command.params}
    for name, value in context.params.items():
        chosen = context.get_parameter_source(name) != ParameterSource.DEFAULT
        if not chosen or value is False or name in {"output", "formats", "as_json"}:
            continue
        for each in value if isinstance(value, tuple) else [value]:
            words += [] if name == "scene" else [options[name]]
            text = ",".join(each) if isinstance(each, list) else str(each)
            words += [] if each is True else [text]
    return f"{context.command_path} {shlex.join(words)}".strip()


def _print_rows(heads: Sequence[str], rows: Sequence[Sequence[str]], as_json: bool) -> None:
    if as_json:
        console.print_json([dict(zip(heads, row, strict=True)) for row in rows])
    else:
        console.print_table(heads, rows)


def _report(
    derived: Sequence["Derivation"], output: Path, paths: Sequence[Path], *,
    as_json: bool, numbers: bool,
) -> None:  # fmt: skip
    """Print what was derived and which files were written."""
    if without := [each.label for each in derived if numbers and not each.numbers]:
        named = ", ".join(without[:MOST_NAMED]) + (", ..." if len(without) > MOST_NAMED else "")
        click.echo(f"kvtheory: no numbers of this scene in {len(without)}: {named}", err=True)
    counts = dict(Counter(each.status for each in derived))
    if as_json:
        files = [str(path) for path in paths]
        console.print_json({"directory": str(output), "files": files, "derivations": counts})
        return
    click.echo("Derived and checked: " + ", ".join(f"{status} {n}" for status, n in counts.items()))
    for path in paths:
        if path.parent == output:
            click.echo(f"  {path}")
    if fragments := [path for path in paths if path.parent != output]:
        count = f"{len(derived)} equations for \\input, alone and with steps"
        click.echo(f"  {fragments[0].parent}{os.sep} ({count})")
