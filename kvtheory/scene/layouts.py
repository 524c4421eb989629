"""Where the tables of a text file are: the header, the units and the rows of each, and the text above it.

A header is a row that names what is needed, wherever it stands; where no row does, one behind a mark of
comments. Columns are separated by tabs, semicolons, commas or spaces, whichever splits a header into the
most known names; the rows need not be separated as the header is. Units are in the header or in the row
below it. A header may begin with a label that the rows lack ("Interval data:"), and rows with one that
the header lacks. Text between rows is the head of the next table; the header holds on below lines of a
single cell, of a key with a colon, or of two cells that are a key and its value.
"""

import csv
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from kvtheory.scene.tables import SEPARATED, number

Cells = list[str]
Names = Callable[[Sequence[str], Sequence[str]], int]
"""Returns how many known quantities a row of cells names, with the units below it."""

STARTS = re.compile(r"[\s,;\"]*(?:[-+.]*\d|nan\b)", re.IGNORECASE)
"""The beginning of a row of numbers; its first cells may be empty."""
COMMENT = re.compile(r"^\s*(?:#|%|//)+\s*(?:\w+:\s+)?")
"""The mark of a comment, and a word with a colon behind it, such as "columns:"."""
UNITLESS = "", "-", "1"
RULE = re.compile(r"[\s|+=_:,;-]*(?:-{2}|={2}|_{2})[\s|+=_:,;-]*$")
"""A line that is drawn between the rows of a table."""
SIZE = re.compile(r"(?<![^\s|])\|\s*(E|G|η|eta)\*?\s*\|")
"""A modulus between bars that are not those of a table."""
END = re.compile(r"\s*(?:\\\\|\\(?:hline|toprule|midrule|bottomrule)).*$")
"""The end of a row in LaTeX, and its rules."""
INCH = re.compile(r'(?<=[EG])"(?=\s*(?:[\[(/\t;, ]|$))')
"""A double prime written as a quotation mark, before a unit or at the end of a name."""
BEFORE_UNITS = 2
"""Most blank rows between a header and its row of units."""
DECIMAL = re.compile(r"[-+]?\d*[.,]\d")
"""The beginning of a cell that holds a number, with an error behind it or a mistake, and no unit."""
LONGEST_UNIT = 12
"""Longest text that may be a unit in a row of units."""


def _by(mark: str) -> Callable[[str], Cells]:
    def split(line: str) -> Cells:
        if '"' not in line and len(line) < csv.field_size_limit():
            return [cell.strip() for cell in line.split(mark)]
        quoted = INCH.sub("''", line)
        if quoted.count('"') % 2:
            quoted = quoted.replace('"', "''")
        return [cell.strip() for cell in next(csv.reader([quoted], delimiter=mark))]

    return split


def _at(pattern: str) -> Callable[[str], Cells]:
    return lambda line: re.split(pattern, INCH.sub("''", line).strip().replace('"', ""))


MARKS = {mark: _by(mark) for mark in "\t;,"}
SPACES = {"  ": _at(r"\s{2,}"), "] ": _at(r"(?<=[\])])\s+"), " ": _at(r"\s+(?![\[(])")}
"""Ways to split a header at spaces: at several, after units, between words with their units."""
ROWS = {**MARKS, "  ": SPACES["  "], " ": SPACES[" "]}


def splitter(mark: str) -> Callable[[str], Cells]:
    """Return what splits a line at a mark of separation."""
    return {**MARKS, **SPACES}.get(mark) or _by(mark)


@dataclass
class Layout:
    """A table: its header and the line of it, its units, the lines of its rows, and the text above them."""

    line: int
    heads: Cells
    units: Cells
    separator: str
    rows: list[int]
    above: list[str]
    numeric: int = 0  # numbers in its first row
    shift: int = 0  # of the cells of rows against those of the header

    def cells(self, line: str) -> Cells:
        """Return the cells of a row under the header; those of a label that the header lacks are left out."""
        cells = splitter(self.separator)(line)
        return [*[""] * self.shift, *cells] if self.shift > 0 else cells[-self.shift :]

    @property
    def decimal(self) -> str:
        """The decimal mark that rows may have beside the point."""
        return "." if self.separator == "," else ","


def undrawn(lines: Sequence[str]) -> list[str]:
    r"""Return the lines of a table without its rules, and with tabs for bars or the ampersands of LaTeX.

    >>> undrawn(["| f [Hz] | |G*| [Pa] |", "|---|---|", "| 1 | 2 |"])
    ['f [Hz] \t G* [Pa]', '', '1 \t 2']
    """
    lines = ["" if RULE.match(line) else line for line in lines]
    for mark in "|&":
        row = re.compile(rf"\s*[{mark}]?\s*[-+.]*\d[^{mark}]*[{mark}]")
        if any(mark in line and row.match(line) for line in lines):
            plain = (SIZE.sub(r"\1*", END.sub("", line)).strip() for line in lines)
            lines = [
                line.removeprefix(mark).removesuffix(mark).strip(" ").replace(mark, "\t")
                for line in plain
            ]
    return lines


def blank(line: str) -> bool:
    """Whether a line is empty or a comment."""
    return not line.strip(' \t\r;,"') or COMMENT.match(line) is not None


def best_row(lines: Sequence[str], names: Names) -> tuple[int, Cells]:
    """Return the row of text that names most known quantities, by place and cells; place -1 if none does."""
    rows = (
        (names(cells, ()), -at, cells)
        for at, line in enumerate(lines)
        if line.strip() and not STARTS.match(line)
        for _, cells in _splits(COMMENT.sub("", line), lines[0])
    )
    count, at, cells = max(rows, key=lambda row: (*row[:2], len(row[2])), default=(0, 1, []))
    return (-at, cells) if count else (-1, [])


def _splits(line: str, first: str) -> Iterator[tuple[str, Cells]]:
    """Split a line in every way; one with other marks only at several spaces, if there are any."""
    named = SEPARATED.match(first)
    ways = {named[1]: _by(named[1])} if named else {**MARKS, **SPACES}
    marked = re.search("[\t;,]", line)
    for mark, split in ways.items():
        cells = split(line)
        if not (marked and mark in SPACES and (mark != "  " or len(cells) == 1)):
            yield mark, cells


def tables(
    lines: Sequence[str], names: Names, *, words: bool = False
) -> tuple[list[Layout], int | None]:
    """Return the tables of a file, and the first line of numbers below them that no header names.

    `names` is zero for a row that is no header. If cells may be words, every line below the first header is a
    row of the only table.
    """
    found: list[Layout] = []
    heads = list(_headers(lines, names, commented=False))
    heads = heads or list(_headers(lines, names, commented=True))
    if words:
        for own in heads[:1]:
            rows = [k for k in range(own.line + 1, len(lines)) if not blank(lines[k])]
            found += [replace(own, rows=rows, units=[])] * bool(rows)
        return found, None
    above = list(lines[: heads[0].line]) if heads else []
    for k, header in enumerate(heads):
        end = heads[k + 1].line if k + 1 < len(heads) else len(lines)
        holds = True
        own = Layout(header.line, header.heads, header.units, header.separator, [], above)
        above = []
        for at in range(header.rows[0], end):
            line = lines[at]
            if blank(line):
                continue
            if STARTS.match(line) or _is_row(own, line):
                if not holds:
                    return found, at
                if above and own.rows:
                    own = replace(own, rows=[], above=above)
                elif above:
                    own.above += above
                above = []
                if not own.rows:
                    _align(own, line)
                    own.numeric = _numeric(own, line)
                    found.append(own)
                own.rows.append(at)
            else:
                above.append(line)
                holds = holds and _is_metadata(line)
        above = above if own.rows else [*own.above, *above]
    for each in found:
        _relabel(each, lines)
    return found, None


def _headers(lines: Sequence[str], names: Names, *, commented: bool) -> Iterator[Layout]:
    for at, line in enumerate(lines):
        if STARTS.match(line) or not line.strip() or commented != bool(COMMENT.match(line)):
            continue
        best, most = None, 0
        for mark, cells in _splits(COMMENT.sub("", line), lines[0]):
            if mark in SPACES and best:  # words of one name are apart by spaces, too
                break
            if len(cells) > 1 or mark == "\t":
                units, below = _units_below(lines, at + 1, mark, len(cells), commented=commented)
                if (count := names(cells, units)) > most:
                    best, most = Layout(at, cells, units, mark, [below], []), count
        if best:
            yield best


def _units_below(
    lines: Sequence[str], at: int, separator: str, count: int, *, commented: bool
) -> tuple[Cells, int]:
    """Return the units in the row below a header, if there is one, and where the rows of numbers begin."""

    def empty(line: str) -> bool:
        return not line.strip() or (blank(line) and not commented)

    below = at + len(list(takewhile(empty, lines[at : at + BEFORE_UNITS])))
    if below >= len(lines) or empty(lines[below]):
        return [], at
    raw = splitter(separator)(COMMENT.sub("", lines[below]))
    cells = [cell.strip("[]() ") for cell in raw]
    texts = [cell for cell in cells if cell]
    is_number = [DECIMAL.match(cell) or number(cell, ",") is not None for cell in texts
                 if cell not in UNITLESS]  # fmt: skip
    long = any(len(cell) > LONGEST_UNIT for cell in texts)
    spaced = separator in SPACES and len(cells) != count
    numbers = all(
        number(word, ",") is not None for word in re.split(r"[\s,;]+", lines[below].strip())
    )
    if numbers or not is_number or any(is_number) or long or spaced or len(cells) > count + 1:
        return [], at
    return cells, below + 1


def _numeric(own: Layout, line: str) -> int:
    return sum(number(cell, own.decimal) is not None for cell in own.cells(line))


def _is_row(own: Layout, line: str) -> bool:
    """Whether a line that begins with text has as many cells as the header, and numbers as the first row."""
    if len(own.cells(line)) < max(len(own.heads) - 1, 2) or _is_metadata(line):
        return False
    return 2 * _numeric(own, line) >= max(own.numeric, 1)


def _is_metadata(line: str) -> bool:
    cells = [cell for cell in re.split(r"[\t;,]", line.strip(' \t;,"')) if cell.strip()]
    return len(cells) == 1 or cells[0].rstrip(' "').endswith(":")


def _align(own: Layout, row: str) -> None:
    """Find how the rows of a table are separated, and whether its header begins with a label of its own."""
    count, marked = len(own.heads), own.separator not in SPACES
    if not (marked and len(own.cells(row)) > 1):
        fitting = [mark for mark in ROWS if len(ROWS[mark](row)) == count]
        own.separator = next(iter(fitting), own.separator if marked else " ")
    if len(own.cells(row)) == count - 1 and own.heads[0].endswith(":"):
        own.shift = 1


def _relabel(own: Layout, lines: Sequence[str]) -> None:
    """Leave out the first cell of rows that have one more than the header: a count or a label of each."""
    rows = [own.cells(lines[k]) for k in own.rows] if not own.shift else []
    if rows and all(len(row) == len(own.heads) + 1 for row in rows):
        counted = [row[0] for row in rows] in (
            [str(i + k) for i in range(len(rows))] for k in (0, 1)
        )  # fmt: skip
        if len(rows) > 2 and (counted or all(number(row[0], own.decimal) is None for row in rows)):
            own.shift = -1
