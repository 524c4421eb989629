"""Derivations as MyST Markdown: formulas between double dollars, with labels to refer to."""

from collections.abc import Collection, Iterable

from ..engine.record import Derivation, Table
from . import frame
from .edition import Edition
from .text import (
    Given,
    Line,
    Piece,
    by_section,
    calculation,
    citation,
    further,
    pieces,
    remark,
    sentence,
)


def document(edition: Edition) -> str:
    """Return the page, for Sphinx or Jupyter Book with the extensions `dollarmath` and `amsmath`."""
    labels = edition.labels
    told = [*frame.INTRODUCTION, *([frame.numbers_of(edition.scene)] if edition.scene else [])]
    parts = [f"# {_escape(edition.title)}", *(_text(paragraph, labels) for paragraph in told)]
    parts += [
        f"{frame.SIGNS[status]} *{status}*: {meaning}"
        for status, meaning in frame.VOCABULARY.items()
    ]
    if edition.command:
        parts.append(
            f"Made by {f'kvtheory {edition.version}'.strip()}: {frame.code_span(edition.command)}"
        )
    parts += ["## Nomenclature", _text(frame.MARKS, labels), _table(edition.table(), labels)]
    for section, members in by_section(edition.derivations).items():
        parts.append(f"## {_text(section, ())}")
        if (own := edition.chapter_table(section)).rows:
            parts.append(_table(own, labels))
        parts += [_derivation(member, edition) for member in members]
    parts += ["## Source", f"{frame.SOURCE} <https://doi.org/{frame.DOI}>"]
    return "\n\n".join(parts) + "\n"


def _derivation(derivation: Derivation, edition: Edition) -> str:
    labels = edition.labels
    parts = [f"### {_text(derivation.title, ())}", _text(derivation.text, labels)]
    parts += [_block(block, derivation.label, labels) for block in edition.blocks(derivation)]
    if derivation.table:
        parts.append(_table(derivation.table, labels))
    parts.append(edition.domain(derivation))
    if derivation.numbers:
        parts.append(frame.WITH_NUMBERS)
        for each in derivation.numbers:
            parts += [f"$$\n{_tame(calculation(each))}\n$$", _text(each.note, labels)]
    if others := further(derivation):
        links = ", ".join(_printed([citation(label, labels)]) for label in others)
        parts.append(f"Rests also on {links}.")
    return "\n\n".join(part for part in parts if part)


def _block(block: Given | Line, label: str, labels: Collection[str]) -> str:
    if isinstance(block, Given):
        return _printed(sentence(block, labels))
    mark = f" ({label})" if block.tag else ""
    reason = _printed(remark(block.step, labels))
    sign = frame.SIGNS[block.step.status]
    beside, below = ("", f"\n\n{reason} {sign}") if reason else (rf" \quad \text{{{sign}}}", "")
    return f"$$\n{_tame(block.step.latex)}{beside}\n$${mark}{below}"


def _table(table: Table, labels: Collection[str]) -> str:
    rows = [table.heads, ("---",) * len(table.heads), *table.rows]
    return "\n".join(f"| {' | '.join(_text(cell, labels) for cell in row)} |" for row in rows)


def _text(text: str, labels: Collection[str]) -> str:
    return _printed(pieces(text, labels))


def _printed(content: Iterable[Piece]) -> str:
    write = {
        "words": lambda piece: _escape(piece.content),
        "math": lambda piece: f"${_tame(piece.content)}$",
        "link": lambda piece: f"[{_escape(piece.content)}](#{piece.target})",
    }
    return "".join(write[piece.kind](piece) for piece in content)


def _escape(words: str) -> str:
    return "".join(f"\\{char}" if char in "\\`*_#<>|[]$" else char for char in words)


def _tame(latex: str) -> str:
    r"""Write mathematics so that no reader of Markdown takes a sign for the beginning of a tag.

    >>> _tame("0<q < 1")
    '0\\lt q \\lt  1'
    """
    return latex.replace("<", r"\lt ")
