"""The atlas of failures: one entry for each way in which a method fails, computed when it is asked for."""

from collections.abc import Iterator, Sequence

from kvtheory.charts.element_failures import ELEMENT_FAILURES
from kvtheory.charts.entry import Entry, Finding
from kvtheory.charts.motion_failures import MOTION_FAILURES
from kvtheory.charts.steady_failures import STEADY_FAILURES
from kvtheory.scene.quantities import nearest

ATLAS: dict[str, Entry] = {
    entry.key: entry for entry in (*ELEMENT_FAILURES, *MOTION_FAILURES, *STEADY_FAILURES)
}
"""The entries by their keys."""


def findings(only: Sequence[str] = ()) -> Iterator[Finding]:
    """Compute the entries named in `only`, or all of them, one after the other.

    Raises
    ------
    ValueError
        If there is no such entry; before anything is computed.

    Examples
    --------
    >>> (found,) = findings(["cancellation"])
    >>> found.outcome.wrong
    0.0
    >>> print(f"{found.outcome.package:.12g}")
    1.22474487139e-12
    """
    for key in only:
        if key not in ATLAS:
            raise ValueError(f'`only` "{key}": {nearest(key, ATLAS)}')
    return (Finding(ATLAS[key], ATLAS[key].measure()) for key in only or ATLAS)
