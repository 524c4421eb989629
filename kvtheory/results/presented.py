"""What results have in common: text, tables in notebooks, pictures and files; and the result of any model."""

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.export import (
    SERIES_SUFFIXES,
    Columns,
    above,
    check_path,
    dataset,
    replace_file,
    save_csv,
)
from kvtheory.results.errors import Certificate, Value
from kvtheory.results.table import QUANTITIES, SHOWN_UNITS


class Recorded:
    """A result that can be written as JSON."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return dict(record(self))


def record(result: Any) -> Any:
    """Return a result, and everything in it that is shown, as values that `json` can write."""
    if is_dataclass(result):
        return {f.name: record(getattr(result, f.name)) for f in fields(result) if f.repr}
    if isinstance(result, Mapping):
        return {key: record(value) for key, value in result.items()}
    if isinstance(result, tuple) and hasattr(result, "_asdict"):
        return record(result._asdict())
    if isinstance(result, (np.ndarray, np.generic)):
        return record(result.tolist())
    if isinstance(result, (tuple, list)):
        return [record(item) for item in result]
    return None if isinstance(result, float) and not math.isfinite(result) else result


class Exported(Recorded):
    """A result with columns that can be written to files; `units` are those of its quantities, in SI."""

    over: Mapping[str, Any] = {}
    """The values that vary over the states of the result, by key of the scene."""

    def _columns(self) -> Columns:
        raise NotImplementedError

    def _attributes(self) -> Mapping[str, str]:
        raise NotImplementedError

    def to_xarray(self) -> Any:
        """Return an `xarray.Dataset` with units; what varies is a coordinate. Needs xarray."""
        return dataset(self._columns(), self._attributes()).set_coords(list(self.over))

    def to_csv(self, path: str | Path) -> None:
        """Write one row for each time, or for each state, with units in the header, in SI."""
        save_csv(Path(path), self._columns())

    def plot(self) -> Any:
        """Draw the result, with what it is compared with, and return the figure."""
        return above("plots").plot_result(self)

    def save(self, path: str | Path) -> None:
        """Write to ``.csv``, or to ``.nc`` with xarray; raise `ValueError` for any other suffix."""
        path = Path(path)
        check_path(path, SERIES_SUFFIXES)
        if path.suffix.lower() == ".csv":
            self.to_csv(path)
        else:
            data = self.to_xarray()
            replace_file(path, lambda part: data.to_netcdf(part, engine="scipy"))


class Presented(Exported):
    """A result that holds quantities of the table as attributes, and a certificate."""

    model: str
    certificate: Certificate
    units: Mapping[str, str]

    @property
    def _title(self) -> str:
        return f"{type(self).__name__} by {self.model}"

    def _columns(self) -> Columns:
        held = {name: getattr(self, name) for name in self.units if hasattr(self, name)}
        return {name: (values, self.units[name]) for name, values in {**self.over, **held}.items()}

    def _attributes(self) -> Mapping[str, str]:
        attributes = {"model": self.model, "certificate": self.certificate.statement}
        if hasattr(self, "events"):
            attributes["events"] = json.dumps([event._asdict() for event in self.events])
        return attributes

    def _shown(self) -> Iterator[tuple[str, str, str, str]]:
        """Yield name, value, unit and error of each quantity as text."""
        for name in filter(lambda name: hasattr(self, name), QUANTITIES):
            error = self.certificate.relative_error.get(name)
            worst = "" if error is None else f"{float(np.max(error, initial=0.0)):.1e}"
            yield name, *in_shown_unit(getattr(self, name), self.units[name]), worst

    def __repr__(self) -> str:
        cells = [f"{name} {value} {unit}".rstrip() for name, value, unit, _ in self._shown()]
        pairs = [
            f"{a:38} {b}".rstrip() for a, b in zip(cells[::2], [*cells[1::2], ""], strict=False)
        ]
        errors = self.certificate.relative_error.values()
        worst = max((float(np.max(error, initial=0.0)) for error in errors), default=0.0)
        scale, kind = self.certificate.relative_to, self.certificate.kind
        known = f"errors up to {worst:.1e} of {scale} ({kind})"
        message = self.certificate.sentence if kind == "none" else known
        return "\n".join([self._title, *pairs, message, *getattr(self, "notes", ())])

    def _repr_html_(self) -> str:
        heads = ("quantity", "value", "unit", f"error, relative to {self.certificate.relative_to}")
        said = self.certificate.sentence, *getattr(self, "notes", ())
        notes = "".join(f"<p>{escape(each)}</p>" for each in said)
        return html_table(self._title, heads, self._shown()) + notes

    def plot(self, *, ax: Any = None, **style: Any) -> Any:
        """Draw the result and return the figure; `ax` is an axes or several, else they are new.

        A time series is drawn as in Fig. 3 of the paper; steady sliding as its friction coefficient over what
        varies, or, for a single parabola or ball, as its pressure over the contact.
        """
        return above("plots").plot_result(self, ax, **style)


@dataclass(frozen=True)
class ClimbStep:
    """One rung that was tried.

    `assumed` states the assumptions of the model, `outcome` is ``"used"`` or why it was not, `error` the
    largest relative error that it may have (NaN if not known), `margin` the tolerance over it; `choosing`
    and `solving` are the seconds spent on judging the model and on running it.
    """

    rung: str
    assumed: str
    outcome: str
    error: float
    margin: float
    choosing: float
    solving: float


@dataclass(frozen=True, repr=False)
class Solution(Presented):
    """Values within a tolerance, by the cheapest model that is known to be enough.

    `values` maps the name of each quantity to a float (steady sliding) or to an array (a time series,
    `time` first); each is also an attribute: ``solution.friction_force``. Quantities of a series that were
    not requested are NaN. `answer` is the full result of the model, if it has one, and `notes` are its notes.
    """

    values: Mapping[str, Value]
    rtol: float
    model: str
    certificate: Certificate
    climb: tuple[ClimbStep, ...]
    answer: Any = field(default=None, repr=False, compare=False)
    units: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)

    def __getattr__(self, name: str) -> Value:
        if name.startswith("_") or name == "values" or name not in self.values:
            raise AttributeError(f"a {type(self).__name__} of this request has no `{name}`")
        return self.values[name]

    @property
    def choosing_share(self) -> float:
        """Share of the time spent on the choice, including rungs that were run but not used."""
        vain = sum(step.choosing + step.solving for step in self.climb[:-1])
        last = self.climb[-1]
        return (vain + last.choosing) / (vain + last.choosing + last.solving)

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        rest = {"model": self.model, "certificate": self.certificate, "climb": self.climb}
        return dict(record({**self.values, **rest}))


def aligned(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table with columns as wide as they need to be."""
    table = [heads, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    return ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]


def in_shown_unit(value: Any, unit: str) -> tuple[str, str]:
    """Return an SI value, or the range of several, as text in the unit of the tables, and that unit."""
    name, factor = SHOWN_UNITS[unit]
    return value_range(value, factor=factor), name


def with_unit(value: Any, unit: str) -> str:
    """Return an SI value, or the range of several, with the unit of the tables.

    >>> with_unit([0.05, 2.0], "m/s"), with_unit(-0.0, "m/s"), with_unit(float("nan"), "m/s")
    ('50 … 2000 mm/s', '0 mm/s', '-')
    """
    text, name = in_shown_unit(value, unit)
    return text if text == "-" else f"{text} {name}".rstrip()


def value_range(value: Any, style: str = "", factor: float = 1.0) -> str:
    """Return a number as text, or the least and the largest of several; a dash if there is none."""
    array = np.asarray(value, dtype=float) * factor + 0.0  # never minus zero
    known = array[~np.isnan(array)]
    if not known.size:
        return "-"
    if known.min() == known.max():
        return format(known.flat[0], style or ".6g")
    return f"{known.min():{style or '.4g'}} … {known.max():{style or '.4g'}}"


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
