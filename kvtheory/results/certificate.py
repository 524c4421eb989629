"""How wrong a result may be, and results as plain Python values."""

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
    """How wrong a result may be, and what stands behind that.

    `kind` is ``"proved"`` (a bound derived in `derivations`), ``"estimated"`` (measured by the tests,
    or by the method itself) or ``"none"`` (nobody asked for one, and `relative_error` is empty);
    `statement` says it in words; `relative_error` maps the name of
    a quantity to a bound of |computed - true| over what `relative_to` names: `THE_TRUTH` itself in
    steady sliding, and in a time series, which may pass through zero, `AT_REST`: the state before the
    motion, by whose products `kvtheory.results.table.scales` measures each quantity.
    """

    kind: str
    statement: str
    relative_error: Mapping[str, Value]
    relative_to: str = THE_TRUTH


def record(result: Any) -> Any:
    """Turn a result, and what it holds, into what `json` writes."""
    if is_dataclass(result):
        return {f.name: record(getattr(result, f.name)) for f in fields(result)}
    if isinstance(result, Mapping):
        return {key: record(value) for key, value in result.items()}
    if isinstance(result, tuple) and hasattr(result, "_asdict"):
        return record(result._asdict())
    if isinstance(result, (np.ndarray, np.generic)):
        return record(result.tolist())
    if isinstance(result, (tuple, list)):
        return [record(item) for item in result]
    return None if isinstance(result, float) and not math.isfinite(result) else result
