"""The certificate of a result's error, and results as plain Python values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

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


class Recorded:
    """A result that can be written as JSON."""

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return dict(record(self))


def record(result: Any) -> Any:
    """Return a result, and everything in it that is shown, as values that `json` can write."""
    if is_dataclass(result):
        return {f.name: record(getattr(result, f.name)) for f in fields(result) if f.repr}
    if isinstance(result, Mapping):
        return {key: record(value) for key, value in result.items()}
    if isinstance(result, tuple) and hasattr(result, "_asdict"):
        return record(result._asdict())
    if isinstance(result, (np.ndarray, np.generic)):
        return record(result.tolist())
    if isinstance(result, (tuple, list)):
        return [record(item) for item in result]
    return None if isinstance(result, float) and not math.isfinite(result) else result
