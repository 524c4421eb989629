"""The data of an entry of the atlas of failures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

Role = Literal["wrong", "right", "package"]
Curve = tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]


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

    @classmethod
    def of(cls, x: str, y: str, wrong: Curve, package: Curve, **logarithmic: bool) -> "Picture":
        """Return the wrong curve and that of the package, each as x and y."""
        return cls(x, y, (Line("wrong", *wrong), Line("package", *package)), **logarithmic)


@dataclass(frozen=True)
class Outcome:
    """The computed numbers: the wrong one, the right one and that of the package, in SI.

    `right` comes from a formula or a method that shares no code with that of `package`. A method without a
    result gives NaN or infinity. `said` is the message of the package, if any.
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
        """Return the error of a value, relative to the right one or to `scale`."""
        return abs(value - right) / (self.scale or abs(right))


@dataclass(frozen=True)
class Finding:
    """An entry with its outcome."""

    entry: Entry
    outcome: Outcome

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        numbers = {role: getattr(self.outcome, role) for role in get_args(Role)}
        return {
            **{name: getattr(self.entry, name) for name in TEXTS},
            **{f"{role}_value": x if np.isfinite(x) else None for role, x in numbers.items()},
            "said": self.outcome.said,
        }


TEXTS = "key", "title", "scene", "why", "quantity", "notice", "package"
