"""The presentation of a result: a few lines of text, a table in a notebook, a picture, a file."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.results.above import above
from kvtheory.results.certificate import Certificate
from kvtheory.results.table import QUANTITIES, SHOWN_UNITS


class Presented:
    """A result that holds quantities of the table as attributes, and a certificate.

    Examples
    --------
    >>> import kvtheory as kv
    >>> print(repr(kv.steady()).splitlines()[1])
    depth 0.0896613 mm                     half_length 1.33911 mm
    """

    model: str
    certificate: Certificate
    units: Mapping[str, str]

    @property
    def _title(self) -> str:
        return f"{type(self).__name__} by {self.model}"

    @property
    def _named(self) -> tuple[str, ...]:
        """The quantities that this result holds, in order."""
        return tuple(name for name in QUANTITIES if hasattr(self, name))

    def _shown(self) -> Iterator[tuple[str, str, str, str]]:
        """Yield name, value, unit and error of each quantity as text."""
        for name in self._named:
            unit, factor = SHOWN_UNITS[self.units[name]]
            error = self.certificate.relative_error.get(name)
            worst = "" if error is None else f"{float(np.max(error, initial=0.0)):.1e}"
            yield name, spread(getattr(self, name), factor=factor), unit, worst

    def __repr__(self) -> str:
        """Return a summary in ten lines at most."""
        cells = [f"{name} {value} {unit}".rstrip() for name, value, unit, _ in self._shown()]
        pairs = [
            f"{a:38} {b}".rstrip() for a, b in zip(cells[::2], [*cells[1::2], ""], strict=False)
        ]
        errors = self.certificate.relative_error.values()
        worst = max((float(np.max(error, initial=0.0)) for error in errors), default=0.0)
        told = (
            f"errors up to {worst:.1e} of {self.certificate.relative_to} ({self.certificate.kind})"
        )
        return "\n".join([self._title, *pairs, told])

    def _repr_html_(self) -> str:
        """Return a table for notebooks, with units and certificate."""
        heads = ("quantity", "value", "unit", f"error, relative to {self.certificate.relative_to}")
        told = f"Errors are {self.certificate.kind}: {self.certificate.statement}."
        return f"{html_table(self._title, heads, self._shown())}<p>{escape(told)}</p>"

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Draw the result and return the figure; `ax` is an axes or several, else they are new.

        A time series is drawn as in Fig. 3 of the paper; steady sliding as its friction coefficient over what
        varies, or, for a single parabola or ball, as its pressure over the contact.
        """
        return above("plot_result")(self, ax, **style)

    def to_xarray(self) -> Any:
        """Return an `xarray.Dataset` with units.

        Raises
        ------
        ValueError
            If xarray is missing.
        """
        return above("dataset")(self)

    def to_csv(self, path: str | Path) -> None:
        """Write one row for each time, or for each state, with units in the header, in SI."""
        above("save_csv")(self, Path(path))

    def save(self, path: str | Path) -> None:
        """Write to ``.csv`` or ``.nc`` (needs xarray).

        Raises
        ------
        ValueError
            If the suffix is neither, or xarray is missing.
        OSError
            If the file cannot be written.
        """
        above("save_result")(self, Path(path))


def aligned(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table with columns as wide as they need to be.

    >>> aligned(("a", "b"), [("12", "3")])
    ['a   b', '12  3']
    """
    table = [heads, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]


def with_unit(value: Any, unit: str) -> str:
    """Return an SI value, or the least and the largest of several, with the unit of the tables.

    >>> with_unit(0.05, "m/s"), with_unit([0.05, 2.0], "m/s"), with_unit(float("nan"), "m/s")
    ('50 mm/s', '50 … 2000 mm/s', '-')
    """
    name, factor = SHOWN_UNITS[unit]
    text = spread(value, factor=factor)
    return text if text == "-" else f"{text} {name}".rstrip()


def html_table(caption: str, heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table of texts in HTML."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f"<table><caption>{escape(caption)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def spread(value: Any, style: str = "", factor: float = 1.0) -> str:
    """Return a number as text, or the least and the largest of several; a dash if there is none."""
    array = np.asarray(value, dtype=float) * factor
    known = array[~np.isnan(array)]
    if not known.size:
        return "-"
    if known.min() == known.max():
        return format(known.flat[0], style or ".6g")
    return f"{known.min():{style or '.4g'}} … {known.max():{style or '.4g'}}"
