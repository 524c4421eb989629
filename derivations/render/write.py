"""Write derivations to files, all or none."""

import difflib
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path

from derivations.record import Derivation
from derivations.render import html, json, latex, pdf

Files = dict[str, bytes]
"""What a format makes: contents by file name, relative to the directory."""


def _tex(derivations: Sequence[Derivation], command: str) -> Files:
    fragments = {
        f"fragments/{each.label}.tex": latex.fragment(each).encode() for each in derivations
    }
    return {"derivations.tex": latex.article(derivations, command).encode(), **fragments}


def _html(derivations: Sequence[Derivation], command: str) -> Files:
    return {"derivations.html": html.document(derivations, command).encode()}


def _pdf(derivations: Sequence[Derivation], command: str) -> Files:
    return {"derivations.pdf": pdf.typeset(latex.article(derivations, command))[0]}


def _json(derivations: Sequence[Derivation], command: str) -> Files:
    return {"derivations.json": json.document(derivations).encode()}


FORMATS: Mapping[str, Callable[[Sequence[Derivation], str], Files]] = {
    "tex": _tex,
    "html": _html,
    "pdf": _pdf,
    "json": _json,
}


def write(
    derivations: Sequence[Derivation],
    directory: Path,
    formats: Sequence[str] = tuple(FORMATS),
    only: Sequence[str] = (),
    command: str = "",
) -> list[Path]:
    """Write the derivations in each of the formats and return the files written.

    Everything is made before anything is written, and each file appears complete or not at all.

    Parameters
    ----------
    derivations
        The records to print, in this order.
    directory
        Where to write; made where it is missing.
    formats
        Names of `FORMATS`.
    only
        Labels of the derivations to print, or of families: F4 is F4-low and F4-high. All where it
        is empty.
    command
        The command that asks for the files, to be named in the documents.

    Raises
    ------
    ValueError
        For an unknown format or label.
    RenderError
        Where a format cannot be made.
    """
    for name in formats:
        _known(name, FORMATS, "format")
    families = {each.label: {each.label, each.label.split("-")[0]} for each in derivations}
    for label in only:
        _known(label, [*families, *sorted(set().union(*families.values()))], "label")
    chosen = [each for each in derivations if not only or not families[each.label].isdisjoint(only)]
    files: Files = {}
    for name in formats:
        files |= FORMATS[name](chosen, command)
    return _place({Path(directory) / name: content for name, content in files.items()})


def _known(name: str, valid: Collection[str], kind: str) -> None:
    if name not in valid:
        nearest = difflib.get_close_matches(name, valid, n=1, cutoff=0)
        hint = f"; the nearest is {nearest[0]!r}" if nearest else ""
        raise ValueError(f"unknown {kind} {name!r}{hint}")


def _place(files: Mapping[Path, bytes]) -> list[Path]:
    """Write beside each file and rename, so that no reader and no failure meets half a file."""
    drafts = {path: path.with_name(f".{path.name}.{os.getpid()}.part") for path in files}
    try:
        for path, draft in drafts.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            draft.write_bytes(files[path])
        for path, draft in drafts.items():
            os.replace(draft, path)
    finally:
        for draft in drafts.values():
            draft.unlink(missing_ok=True)
    return list(files)
