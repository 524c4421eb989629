"""Several values of one quantity in a text: ``"10 ms,1 s"`` and ``"1 mm/s:10 m/s:200:log"``."""

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.quantities import Quantity, convert

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
