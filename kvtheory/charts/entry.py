"""What an entry of the atlas of failures holds."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Role = Literal["wrong", "right", "package"]


@dataclass(frozen=True)
class Line:
    """A curve of the picture: `role` says whether it is the failure, the truth or the package."""

    role: Role
    x: NDArray[np.floating[Any]]
    y: NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Picture:
    """Curves over one axis; labels carry the units of the values."""

    x: str
    y: str
    lines: tuple[Line, ...]
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True)
class Outcome:
    """What was computed: the wrong number, the right one and that of the package, in SI.

    `right` comes from a formula or a method that shares no code with what gives `package`. A method that
    gives no number at all gives NaN or infinity. `said` is what the package tells the user, if it does.
    """

    wrong: float
    right: float
    package: float
    picture: Picture
    said: str = ""


@dataclass(frozen=True)
class Entry:
    """One way in which a method fails.

    `unit` and `factor` show the numbers, which are in SI; `tolerance` is how far, as a share of the
    right number (or of `scale`, in SI, where that is zero), the package may be off.
    """

    key: str
    title: str
    scene: str
    why: str
    quantity: str
    unit: str
    factor: float
    notice: str
    package: str
    tolerance: float
    measure: Callable[[], Outcome]
    scale: float = 0.0

    def error(self, value: float, right: float) -> float:
        """Return how wrong a value is, relative to the right one or to `scale`."""
        return abs(value - right) / (self.scale or abs(right))


@dataclass(frozen=True)
class Finding:
    """An entry with its outcome."""

    entry: Entry
    outcome: Outcome

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        entry, outcome = self.entry, self.outcome
        texts = {name: getattr(entry, name) for name in TEXTS}
        numbers = {name: _plain(getattr(outcome, name)) for name in ("wrong", "right", "package")}
        return {
            **texts,
            **{f"{name}_value": value for name, value in numbers.items()},
            "said": outcome.said,
        }


TEXTS = "key", "title", "scene", "why", "quantity", "notice", "package"


def _plain(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
