"""The atlas of failures: one entry for each way in which a method fails, computed on request."""

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np

from kvtheory.charts import motion_failures, steady_failures
from kvtheory.charts.naive import Outcome
from kvtheory.scene.mistakes import nearest

ROLES = "wrong", "right", "package"
TEXTS = "key", "title", "scene", "why", "quantity", "notice", "package"


@dataclass(frozen=True)
class Entry:
    """One way in which a method fails."""

    key: str
    title: str
    scene: str
    why: str
    quantity: str
    unit: str  # in which numbers are shown
    factor: float  # to it from SI
    notice: str
    package: str
    tolerance: float  # allowed error of the package relative to the right number, or to `scale`
    x: tuple[str, float, str]  # label, factor and scale of an axis
    y: tuple[str, float, str]
    measure: Callable[[], Outcome]
    scale: float = 0.0  # in SI, where the right number is zero


@dataclass(frozen=True)
class Finding:
    """An entry with its outcome."""

    entry: Entry
    outcome: Outcome

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        numbers = {role: getattr(self.outcome, role) for role in ROLES}
        return {
            **{name: getattr(self.entry, name) for name in TEXTS},
            **{f"{role}_value": x if np.isfinite(x) else None for role, x in numbers.items()},
            "said": self.outcome.said,
        }


MEASURES = {**vars(motion_failures), **vars(steady_failures)}
"""Each entry is computed by the function of its name."""
ATLAS = {
    key: Entry(key=key, measure=MEASURES["_" + key.replace("-", "_")], **words)
    for key, words in tomllib.loads(
        files("kvtheory.charts").joinpath("atlas.toml").read_text(encoding="utf-8")
    ).items()
}
"""The entries by their keys."""


def findings(only: Sequence[str] = ()) -> Iterator[Finding]:
    """Compute the entries named in `only`, or all of them; `ValueError` if there is no such entry."""
    for key in only:
        if key not in ATLAS:
            raise ValueError(f'`only` "{key}": {nearest(key, ATLAS)}')
    return (Finding(ATLAS[key], ATLAS[key].measure()) for key in only or ATLAS)
