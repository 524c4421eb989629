"""A time series held against theory."""

from dataclasses import dataclass, field, fields
from typing import Any

from kvtheory.results.certificate import record


@dataclass(frozen=True)
class Check:
    """One thing that was looked at.

    `measured` must not exceed `allowed`; both are in `unit`, which says what is measured. `equation`
    is what stands behind it. A check that cannot be made has no numbers, `ok` is None, and `note` says
    why.
    """

    name: str
    measured: float | None
    allowed: float | None
    ok: bool | None
    equation: str
    unit: str
    note: str = ""


@dataclass(frozen=True)
class Explanation:
    """A fault that would explain a disagreement.

    `rank` orders them, from 0 to 1. For a fault that was tried on theory it is `explained`, the part of
    the difference (root mean square, relative to what is allowed) that goes away with it; for one that is
    read off signs in the data, it is how telling the sign is taken to be, and `explained` is None.
    `enough` says whether what remains is allowed; `factor` is what was fitted, if anything.
    """

    name: str
    text: str
    rank: float
    enough: bool
    factor: float | None = None
    explained: float | None = None


@dataclass(frozen=True)
class Comparison:
    """Whether a time series agrees with theory, check by check, and if not, why.

    `verdict` is ``"agrees"``, ``"disagrees"`` if one of the checks that could be made failed, or
    ``"cannot tell"`` if it was that of the sampling alone. `diagnosis` says it in words; `explanations`
    are the faults behind it, the best first.
    """

    verdict: str
    checks: tuple[Check, ...]
    diagnosis: str
    explanations: tuple[Explanation, ...]
    source: str
    tolerance: float
    series: Any = field(repr=False, compare=False)
    """The data as arrays in SI by name, `time` first."""
    theory: Any = field(repr=False, compare=False)
    """The theory at the times of the data."""
    allowed: Any = field(repr=False, compare=False)
    """By how much the data may differ, by name, at the times of the data."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON, without the series."""
        left_out = ("series", "theory", "allowed")
        return {
            f.name: record(getattr(self, f.name)) for f in fields(self) if f.name not in left_out
        }
