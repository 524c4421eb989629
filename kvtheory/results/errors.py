"""Errors other than bad input, which is a `kvtheory.scene.SceneError` that lists every mistake."""

from collections.abc import Sequence


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
