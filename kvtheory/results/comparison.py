"""A time series compared with theory."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kvtheory.export import Columns
from kvtheory.results.presented import Exported, html_table
from kvtheory.results.table import SERIES_UNITS


@dataclass(frozen=True)
class Check:
    """One check: `measured` must not exceed `allowed`; both are in `unit`, which says what is measured.

    `equation` is the basis of the check. One that cannot be made has no numbers, `ok` is None, and `note`
    says why.
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

    `rank` orders them, up to 1. `explained` is the part of the difference (root mean square, relative to the
    allowance, beyond the noise) that the fault removes; the rank is a little lower for a fault with an
    unknown, and more so for a parameter far from its value. For a fault inferred from a symptom the rank is
    an assumed strength of the evidence, and `explained` is None. `enough` says whether the remaining
    difference is allowed; `factor` is the fitted factor or shift, if any. `alike` are the parameters that the
    data cannot distinguish from this one.
    """

    name: str
    text: str
    rank: float
    enough: bool
    factor: float | None = None
    explained: float | None = None
    alike: tuple[str, ...] = ()


MOST_SHOWN = 6
"""Largest number of failed checks in the text of a comparison."""
MARKS = {True: "ok", False: "NO", None: "not made"}
HEADS = "check", "measured", "allowed", "", "equation", "what is measured"


@dataclass(frozen=True, repr=False)
class Comparison(Exported):
    """Whether a time series agrees with theory, check by check, and if not, why.

    `verdict` is ``"agrees"``, ``"disagrees"`` if one of the checks that could be made failed, or
    ``"cannot tell"`` if only the check of the sampling, or of the phase of a cycle, failed. `diagnosis`
    explains it in words; `explanations` are possible faults, the most likely first. `series` holds the data
    as arrays in SI by name, `time` first (for a curve, `velocity`); `theory`, and the `allowed` difference,
    are at the same times. `detectable` is the smallest relative error of each quantity that data which do not
    disagree would have shown; None if none up to 100 % would, or if scene and data lack the quantity.
    """

    verdict: str
    checks: tuple[Check, ...]
    diagnosis: str
    explanations: tuple[Explanation, ...]
    source: str
    tolerance: float
    series: Any = field(repr=False, compare=False)
    theory: Any = field(repr=False, compare=False)
    allowed: Any = field(repr=False, compare=False)
    units: Mapping[str, str] = field(default_factory=SERIES_UNITS.copy, repr=False, compare=False)
    detectable: Mapping[str, float | None] = field(default_factory=dict)

    def __repr__(self) -> str:
        failed = [check for check in self.checks if check.ok is False]
        rows = [f"{c.name}: {c.measured:.3g}, allowed {c.allowed:.3g}" for c in failed[:MOST_SHOWN]]
        rows += [f"and {len(failed) - MOST_SHOWN} more"] * (len(failed) > MOST_SHOWN)
        return "\n".join([f"Comparison of {self.source}: {self.verdict}", self.diagnosis, *rows])

    @property
    def rows(self) -> list[tuple[str, ...]]:
        """The checks as text, below `HEADS`."""
        return [
            (
                c.name, *("-" if c.ok is None else f"{x:.3g}" for x in (c.measured, c.allowed)),
                MARKS[c.ok], c.equation, "; ".join(filter(None, (c.unit, c.note))),
            )
            for c in self.checks
        ]  # fmt: skip

    def _repr_html_(self) -> str:
        return html_table(f"{self.source}: {self.verdict}. {self.diagnosis}", HEADS, self.rows)

    def _columns(self) -> Columns:
        """Return data, theory and the allowed difference of each quantity."""
        axis = next(iter(self.series))
        columns = {axis: (self.series[axis], self.units[axis])}
        kinds = {"data": self.series, "theory": self.theory, "allowed": self.allowed}
        for name in self.allowed:
            for kind, values in kinds.items():
                columns[f"{name}, {kind}"] = values[name], self.units[name]
        return columns

    def _attributes(self) -> Mapping[str, str]:
        return {"verdict": self.verdict, "diagnosis": self.diagnosis}
