"""The result of the cheapest sufficient model, and how it was found."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kvtheory.results.certificate import Certificate, Value, record
from kvtheory.results.presented import Presented


@dataclass(frozen=True)
class ClimbStep:
    """One rung that was tried.

    `assumed` states the assumptions of the model, `outcome` is ``"used"`` or why it was not, `error` the
    largest relative error that it may have (NaN if not known), `margin` the tolerance over it; `choosing`
    and `solving` are the seconds spent on judging the model and on running it.
    """

    rung: str
    assumed: str
    outcome: str
    error: float
    margin: float
    choosing: float
    solving: float


@dataclass(frozen=True, repr=False)
class Solution(Presented):
    """Values within a tolerance, by the cheapest model that is known to be enough.

    `values` maps the name of each quantity to a float (steady sliding) or to an array (a time series,
    `time` first); each is also an attribute: ``solution.friction_force``. Quantities of a series that were
    not requested are NaN. `answer` is the full result of the model, if it has one.
    """

    values: Mapping[str, Value]
    rtol: float
    model: str
    certificate: Certificate
    climb: tuple[ClimbStep, ...]
    answer: Any = field(default=None, repr=False, compare=False)
    units: Mapping[str, str] = field(default_factory=dict, repr=False, compare=False)

    def __getattr__(self, name: str) -> Value:
        if name.startswith("_") or name == "values" or name not in self.values:
            raise AttributeError(f"a {type(self).__name__} of this request has no `{name}`")
        return self.values[name]

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes of the model that was used."""
        return getattr(self.answer, "notes", ())

    @property
    def choosing_share(self) -> float:
        """Share of the time spent on the choice, including rungs that were run but not used."""
        vain = sum(step.choosing + step.solving for step in self.climb[:-1])
        last = self.climb[-1]
        return (vain + last.choosing) / (vain + last.choosing + last.solving)

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        rest = {"model": self.model, "certificate": self.certificate, "climb": self.climb}
        return dict(record({**self.values, **rest}))
