"""Errors: the certificate of a result, and what ends a computation.

Bad input is a `kvtheory.scene.SceneError`, which lists every mistake.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Value = Any
"""A float, or an array of floats where the input held arrays."""

THE_TRUTH = "the true value"
AT_REST = "the static depth, half length and load"
"""What errors are relative to."""


@dataclass(frozen=True)
class Certificate:
    """The error of a result, and its justification.

    `kind` is ``"proved"`` (a bound derived in `derivations`), ``"estimated"`` (measured by the tests,
    or by the method itself) or ``"none"`` (not requested, and `relative_error` is empty); `statement`
    explains it. `relative_error` maps the name of a quantity to a bound of |computed - true| over the scale
    that `relative_to` names: for steady sliding the true value; for a time series, which may pass through
    zero, the state at rest, with the scale of each quantity from `kvtheory.results.table.scales`.
    """

    kind: str
    statement: str
    relative_error: Mapping[str, Value]
    relative_to: str = THE_TRUTH

    @property
    def sentence(self) -> str:
        """The kind and its explanation, below a table."""
        kind = "not estimated" if self.kind == "none" else self.kind
        return f"Errors are {kind}: {self.statement}."


class TransientError(ArithmeticError):
    """The transient could not be computed further; the message says why and when."""

    def __init__(self, reason: str, s: float, name: str = "s", unit: str = "") -> None:
        super().__init__(f"{reason} at {name} = {s:.6g}{unit}")
        self.reason, self.s = reason, s


class DivergenceError(ArithmeticError):
    """The time step is so long that the run became unstable; the message says when and why.

    `rows` holds the output until then: tuples in the order of `TRANSIENT_UNITS`.
    """

    rows: Sequence[tuple[float, ...]] = ()


class QuadratureError(ArithmeticError):
    """A quadrature, a root or the assumption of one contact failed; the message says why."""


class ToleranceError(ArithmeticError):
    """No model is known to be within the tolerance; the message gives the error of each."""
