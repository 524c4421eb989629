r"""Equations to `\input` in any document that loads amsmath: alone, or with all that they need.

A fragment has no number: the document numbers it, and refers to it by its label, `kv:eq27` for Eq. (27).
The prefix keeps it apart from the labels of the document.
"""

from collections.abc import Callable, Collection
from functools import partial

from ..catalogue import CONTENTS
from ..engine.record import Derivation, Table
from . import frame
from .breaking import lines, width
from .edition import Edition
from .latex_words import escape, printed, words
from .text import (
    Given,
    Line,
    Piece,
    blocks,
    calculation,
    number,
    remark,
    sentence,
)

LINES = {1: 27.0, 2: 16.5}
"""Width of a numbered formula in em: what a line of 345 pt, that of `article`, leaves in 10 pt, and what its
second column does, by the number of columns."""

Link = Callable[[Piece], str]

SIZES = ((1.0, ""), (1.05, "small"), (1.15, "footnotesize"), (1.4, "scriptsize"), (9.0, "tiny"))
"""What cannot be broken is set smaller: by width in lines, the size."""

_REFER = (
    r"\providecommand{\derivationref}[2]{\ifcsname r@#1\endcsname(\ref{#1})\else#2\fi}"
    " % the number in this document or, if it is not there, the name\n"
)


def equation(derivation: Derivation, edition: Edition) -> str:
    """Return the result alone."""
    name = edition.label_prefix + derivation.label
    return f"% {_comment(derivation)}\n{_display(derivation.latex, LINES[edition.columns], name)}"


def with_steps(derivation: Derivation, edition: Edition) -> str:
    """Return the result with its steps, the meaning of its symbols and its domain."""
    labels = CONTENTS.keys() | edition.labels
    prefix, line = edition.label_prefix, LINES[edition.columns]
    link = partial(_reference, prefix)
    parts = [
        f"% {_comment(derivation)}",
        f"% rests on: {', '.join(derivation.uses) or 'nothing else'}",
        _REFER + r"\begingroup\emergencystretch=6em\raggedright",
        rf"\paragraph{{{words(derivation.title, ())}.}}",
        words(derivation.text, labels, link),
        *(
            _block(block, line, prefix + derivation.label, labels, link)
            for block in blocks(derivation)
        ),
    ]
    parts += _where(edition.table(edition.symbols(derivation)), labels, link)
    if holds := edition.domain(derivation):
        parts.append(rf"\par\smallskip {words(holds, labels, link)}")
    if derivation.numbers:
        parts.append(rf"\par {frame.WITH_NUMBERS}")
        for each in derivation.numbers:
            note = rf"\par\nopagebreak ({words(each.note, ())})" if each.note else ""
            parts.append(_display(calculation(each), line) + note)
    return "\n".join(part for part in [*parts, r"\par\endgroup"] if part) + "\n"


def _where(table: Table, labels: Collection[str], link: Link) -> list[str]:
    """Return the list of symbols with meaning, unit, where from and, if there is one, value."""
    if not table.rows:
        return []
    items = []
    for symbol, meaning, unit, source, *value in table.rows:
        shown = "".join(f", {each}" for each in value if each)
        text = f"{meaning} [{unit}]{source and ', '}{source}{shown}"
        items.append(rf"\item[{symbol}] {words(text, labels, link)}")
    start = r"\begin{description}\itemsep=0pt\parsep=0pt"
    return [
        r"\par Symbols, positive unless another sign is given:",
        start,
        *items,
        r"\end{description}",
    ]


def _comment(derivation: Derivation) -> str:
    return f"{derivation.label}: {derivation.title} [{derivation.status}]"


def _display(latex: str, line: float, label: str = "") -> str:
    """Return a displayed formula, broken where it is wide, with its label if it is numbered."""
    star, room = ("", line) if label else ("*", line + 4)
    broken = lines(latex, room)
    body = broken[0]
    if "&" in body:
        rows = " \\\\\n    ".join(broken)
        body = f"\\begin{{split}}\n    {rows}\n  \\end{{split}}"
    wide = max(map(width, broken)) / room
    size = next((name for most, name in SIZES if wide <= most), SIZES[-1][1])
    mark = rf"\label{{{label}}}" if label else ""
    shown = f"\\begin{{equation{star}}}{mark}\n  {body}\n\\end{{equation{star}}}\n"
    return f"\\begingroup\\{size}\n{shown}\\endgroup\n" if size else shown


def _block(
    block: Given | Line, line: float, label: str, labels: Collection[str], link: Link
) -> str:
    if isinstance(block, Given):
        return printed(sentence(block, labels), link)
    reason = printed(remark(block.step, labels), link)
    told = rf"\nopagebreak ({reason})\par" if reason else ""
    return _display(block.step.latex, line, label if block.tag else "").rstrip() + told


def _reference(prefix: str, piece: Piece) -> str:
    """Print a reference: the number in parentheses if the document contains the equation, else a name."""
    label = piece.target
    name = number(label)
    name = f"{escape(name)} of Nakano and Kono" if name.isdigit() else escape(name)
    name = f"({name})" if piece.content.startswith("(") else name
    return rf"\derivationref{{{prefix}{label}}}{{{name}}}"
