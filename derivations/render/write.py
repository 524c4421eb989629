"""Write derivations to files, all or none."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryFile

from ..engine.record import Derivation
from ..labels import unknown
from . import bibliography, fragments, html, json, latex, markdown, notebook, pdf
from .edition import Edition, edition

Files = dict[str, bytes]
"""The output of a format: contents by file name, relative to the directory."""


def _tex(edition: Edition) -> Files:
    alone = {
        f"fragments/{each.label}.tex": fragments.equation(each, edition)
        for each in edition.derivations
    }
    whole = {
        f"fragments/{each.label}-steps.tex": fragments.with_steps(each, edition)
        for each in edition.derivations
    }
    files = {"derivations.tex": latex.article(edition), **alone, **whole}
    return {name: text.encode() for name, text in files.items()}


def _pdf(edition: Edition) -> Files:
    return {"derivations.pdf": pdf.typeset(latex.article(edition))[0]}


def _one(name: str, document: Callable[[Edition], str]) -> Callable[[Edition], Files]:
    return lambda edition: {name: document(edition).encode()}


FORMATS: Mapping[str, Callable[[Edition], Files]] = {
    "tex": _tex,
    "html": _one("derivations.html", html.document),
    "pdf": _pdf,
    "json": _one("derivations.json", json.document),
    "md": _one("derivations.md", markdown.document),
    "ipynb": _one("derivations.ipynb", notebook.document),
    "bib": _one("derivations.bib", bibliography.document),
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
        Where to write; created if it is missing.
    formats
        Names of `FORMATS`.
    only
        Names that `labels.find` understands; all derivations if empty.
    command
        The command that asks for the files, to be named in the documents.

    Raises
    ------
    ValueError
        For an unknown format or label.
    RenderError
        If a format cannot be made.
    """
    check_formats(formats)
    return write_edition(edition(derivations, only, command=command), directory, formats)


def write_edition(
    edition: Edition,
    directory: Path,
    formats: Iterable[str],
    report: Callable[[float, str], None] | None = None,
) -> list[Path]:
    """Write one printing in each of the formats; `report` is told the share done, and of what."""
    files: Files = {}
    wanted = list(formats)
    for done, name in enumerate(wanted):
        if report is not None:
            report(done / len(wanted), f"writing {name}")
        files |= FORMATS[name](edition)
    return _place({Path(directory) / name: content for name, content in files.items()})


def check_formats(formats: Sequence[str]) -> None:
    """Raise for no format, an unknown one, or one that this machine cannot make."""
    if not formats:
        raise ValueError(f"no format: expected some of {','.join(FORMATS)}")
    mistakes = [unknown(name, FORMATS, "format") for name in formats if name not in FORMATS]
    if mistakes:
        raise ValueError("\n".join(mistakes))
    if "pdf" in formats:
        pdf.require_engine()


def check_directory(directory: Path) -> None:
    """Raise unless files can be written there; leave nothing behind."""
    missing = [path for path in (directory, *directory.parents) if not path.exists()]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=directory):
            pass
    except OSError as error:
        raise ValueError(f"cannot write to {str(directory)!r}: {error.strerror}") from error
    finally:
        for path in missing:
            if path.is_dir() and not any(path.iterdir()):
                path.rmdir()


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
