"""Records with named fields, from one layout for interpreted and for compiled kernels.

Interpreted, a record is an object with attributes, and many of them are a list; compiled, they are structured
arrays. In both, `record.depth` is a field.
"""

from collections.abc import Callable
from functools import cache
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

import numpy as np


def record(**fields: Any) -> np.dtype[Any]:
    """Return the layout of a record: the types of its fields by name."""
    return np.dtype(list(fields.items()), align=True)


def structured(rows: Any, kind: np.dtype[Any]) -> Any:
    """Return records as a structured array; `rows` may be one already."""

    def plain(record: Any) -> Any:
        if isinstance(record, list):
            return [plain(each) for each in record]
        if not isinstance(record, _Record):
            return record
        values = record.fields(record)
        return tuple(map(plain, values)) if record.nested else values

    return rows if isinstance(rows, np.ndarray) else np.array(plain(rows), dtype=kind)


def readable(record: Any) -> Any:
    """Return a record whose plain fields are attributes."""
    if not isinstance(record, np.void):
        return record
    return SimpleNamespace(**dict(zip(record.dtype.names or (), record.tolist(), strict=True)))


def value(record: Any, name: str) -> Any:
    """Return one field of a record."""
    return record[name] if isinstance(record, np.void) else getattr(record, name)


def set_fields(record: Any, **values: Any) -> None:
    """Set fields of a record, interpreted or compiled."""
    for name, given in values.items():
        if isinstance(record, np.void):
            record[name] = given
        else:
            setattr(record, name, given)


def new(kind: np.dtype[Any], *values: Any) -> Any:
    """Return one object with the fields of a record."""
    return filled(kind, values)


class _Record:
    """An object with the fields of a record."""

    layout: np.dtype[Any]
    fields: Callable[[Any], tuple[Any, ...]]
    nested: bool

    def __reduce__(self) -> Any:
        """Return how it is made again in another process."""
        return _blank, (self.layout,), vars(self)


def _blank(kind: np.dtype[Any]) -> Any:
    return _class(kind)[0]()


@cache
def _class(kind: np.dtype[Any]) -> tuple[type, list[tuple[str, np.dtype[Any], int]]]:
    """Return the class of a record, whose plain fields are zero, and its other fields with their lengths."""
    shapes = {name: kind[name].shape or (0,) for name in kind.names or ()}
    nested = [(name, kind[name].base, count) for name, (count, *_) in shapes.items()
              if count or kind[name].names]  # fmt: skip
    plain = dict.fromkeys(shapes, 0) | {n: 0.0 for n in shapes if kind[n].kind == "f"}
    own = {"layout": kind, "fields": attrgetter(*shapes), "nested": bool(nested)}
    return type("Record", (_Record,), {**plain, **own}), nested


def blanks(count: int, kind: np.dtype[Any]) -> list[Any]:
    """Return `count` blank objects, or zeros."""
    if kind.names is None:
        return [0.0] * count
    make, nested = _class(kind)
    found = [make() for _ in range(count)]
    for record in found:
        for name, part, many in nested:
            setattr(record, name, blanks(many, part) if many else blanks(1, part)[0])
    return found


def filled(kind: np.dtype[Any], values: Any) -> Any:
    """Return an object or a list with these values."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list):
        return [filled(kind.base, value) for value in values]
    if kind.names is None:
        return values
    record = _class(kind)[0]()
    for name, value in zip(kind.names, values, strict=True):
        setattr(record, name, filled(kind[name], value))
    return record
