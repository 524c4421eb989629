"""The atlas of failures: one entry for each way in which a method fails, computed on request."""

import tomllib
from collections.abc import Iterator, Sequence
from importlib.resources import files

from kvtheory.charts import element_failures, motion_failures, spring_failures, steady_failures
from kvtheory.charts.entry import Entry, Finding
from kvtheory.scene.quantities import nearest

MEASURES = {
    **vars(element_failures),
    **vars(motion_failures),
    **vars(spring_failures),
    **vars(steady_failures),
}
"""Each entry is computed by the function of its name."""
WORDS = tomllib.loads(files("kvtheory.charts").joinpath("atlas.toml").read_text(encoding="utf-8"))
ATLAS = {
    key: Entry(key=key, measure=MEASURES["_" + key.replace("-", "_")], **words)
    for key, words in WORDS.items()
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
