"""Several values of one quantity: arrays, lists, and texts such as ``"0 ms,10 ms:1 s:200:log"``."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.quantities import Quantity, convert
from kvtheory.scene.units import bare

RANGE = "START:STOP:COUNT or START:STOP:COUNT:log"
MOST = 10**8
"""Most values in one list, which are held in memory; more than this is a typing error."""


def items(text: str) -> list[str]:
    """Split a text at its commas.

    >>> items("0 ms, 1 ms:3 ms:3")
    ['0 ms', '1 ms:3 ms:3']
    """
    return [item.strip() for item in text.split(",") if item.strip()]


def item_values(item: str, spec: Quantity) -> NDArray[np.float64]:
    """Return the values in SI of one item: a quantity, or a range with both ends.

    Raises
    ------
    ValueError
        If the item cannot be read; the message says why.

    Examples
    --------
    >>> from kvtheory.scene.drives import TIME
    >>> item_values("1 ms:3 ms:3", TIME).tolist()
    [0.001, 0.002, 0.003]
    """
    if ":" not in item:
        return np.array([convert(item, spec)])
    parts = [part.strip() for part in item.split(":")]
    if len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] != "log"):
        raise ValueError(f'expected {RANGE}, such as "1 mm/s:10 m/s:200:log"')
    start, stop = (convert(part, spec) for part in parts[:2])
    if not parts[2].isdecimal() or not 1 <= int(parts[2]) <= MOST:
        raise ValueError(f"COUNT must be a whole number from 1 to {MOST}; got {parts[2]}")
    count = int(parts[2])
    if len(parts) == 4 and min(start, stop) <= 0.0 <= max(start, stop):
        raise ValueError("a logarithmic range needs START and STOP of one sign, neither zero")
    with np.errstate(over="ignore", invalid="ignore"):
        array = (np.linspace if len(parts) == 3 else np.geomspace)(start, stop, count)
    if not spec.admits(array):
        raise ValueError("the range leaves that of double precision")
    return array


def array_of(value: Any, spec: Quantity) -> NDArray[np.float64]:
    """Return a value, or an array or a list of values of any library, in SI, checked element by element.

    Raises
    ------
    ValueError
        Saying what is wrong: with a value, or because values are masked.

    Examples
    --------
    >>> from kvtheory.scene.drives import TIME
    >>> array_of([["1 ms", 2.0], [3, "4 min"]], TIME).tolist()
    [[0.001, 2.0], [3.0, 240.0]]
    """
    values, written = bare(value)
    if isinstance(values, np.ndarray) and values.ndim:
        if written is None and values.dtype.kind in "fiu":
            array = values.astype(float)
            if not spec.admits(array):
                raise ValueError(
                    f"is out of range; expected {spec.range} in {spec.unit} throughout"
                )
            return array
        items = values.reshape(-1).tolist()
        if written is not None:
            items = [f"{item!r} {written}" for item in items]
        return np.array([convert(item, spec) for item in items]).reshape(values.shape)
    if not isinstance(values, (list, tuple, range)):
        return np.asarray(convert(value, spec))
    rows = [array_of(item, spec) for item in values]
    if len({row.shape for row in rows}) > 1:
        raise ValueError("holds rows of different lengths")
    return np.array(rows, dtype=float)
