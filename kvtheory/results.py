"""What a model answers: values in SI units, and how wrong they may be."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

Value = Any
"""A float, or an array of floats where the input held arrays."""

STEADY_UNITS = {
    "depth": "m",
    "half_length": "m",
    "retardation_length": "m",
    "leading_edge": "m",
    "trailing_edge": "m",
    "load": "N/m",
    "friction_force": "N/m",
    "friction_coefficient": "1",
    "peak_pressure": "Pa",
    "dissipated_in_contact": "1",
}
"""The quantities of steady sliding and their units, in the order in which they are shown."""

TRANSIENT_UNITS = {
    "time": "s",
    "velocity": "m/s",
    "depth": "m",
    "depth_rate": "m/s",
    "normal_force": "N/m",
    "friction_force": "N/m",
    "leading_edge": "m",
    "trailing_edge": "m",
    "peak_pressure": "Pa",
}
"""The quantities of a transient and their units, `time` first."""


@dataclass(frozen=True)
class Certificate:
    """How wrong a result may be, and what stands behind that.

    `kind` is ``"proved"`` (a bound derived in `derivations`) or ``"estimated"`` (measured by the
    tests, or by the method itself); `statement` says it in words; `relative_error` maps the name of
    a quantity to a bound of |computed - true| / |true|.
    """

    kind: str
    statement: str
    relative_error: Mapping[str, Value]


@dataclass(frozen=True)
class SteadyState:
    """Steady sliding: each quantity a float, or an array where the input was an array.

    The edges are coordinates in the frame of the indenter, in which the foundation moves through
    x with the drive velocity: the leading edge is at x < 0 for a positive velocity.
    """

    depth: Value
    half_length: Value
    retardation_length: Value
    leading_edge: Value
    trailing_edge: Value
    load: Value
    friction_force: Value
    friction_coefficient: Value
    peak_pressure: Value
    dissipated_in_contact: Value
    model: str
    certificate: Certificate

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return _record(self)


@dataclass(frozen=True)
class AsymptoteLine:
    """One asymptote of a scene: its value, the exact one, and where it is good enough.

    `relative_error` is asymptote/exact - 1; `velocity_min` and `velocity_max` bound the drive
    velocities |V| in m/s at which its magnitude is within the tolerance of the report. What does
    not exist (the high asymptote of the depth at V = 0) is NaN.
    """

    name: str
    quantity: str
    regime: str
    equation: int | None
    formula: str
    value: Value
    exact: Value
    relative_error: Value
    velocity_min: Value
    velocity_max: Value


@dataclass(frozen=True)
class AsymptoteReport:
    """Which asymptote of the friction coefficient holds.

    `regime` is ``"low"`` or ``"high"`` (V below or above V*); `use` names the asymptote that is
    within the tolerance, ``"L1"`` or ``"L2"``, or else ``"exact"``.
    `peak_velocity` and `peak_friction_coefficient` locate the friction maximum of a dead weight
    (theorem F3); they are NaN for the other supports.
    """

    velocity: Value
    critical_velocity: Value
    peak_velocity: Value
    peak_friction_coefficient: Value
    regime: Any
    use: Any
    tolerance: float
    lines: tuple[AsymptoteLine, ...]
    model: str
    certificate: Certificate

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return _record(self)


class Event(NamedTuple):
    """What happened to the contact, and when (in s)."""

    time: float
    kind: str


@dataclass(frozen=True)
class Transient:
    """A transient as a time series: arrays in SI over `time`; in flight the edges are NaN.

    `leading_state` and `trailing_state` say whether an edge is ``"peeling"`` (its pressure is zero),
    ``"touching"`` (it meets the free surface) or ``"free"`` (the indenter flies). At an instant where
    the drive jumps, values are those just after the jump.
    """

    time: Value
    velocity: Value
    depth: Value
    depth_rate: Value
    normal_force: Value
    friction_force: Value
    leading_edge: Value
    trailing_edge: Value
    peak_pressure: Value
    leading_state: tuple[str, ...]
    trailing_state: tuple[str, ...]
    events: tuple[Event, ...]
    steps: int
    evaluations: int
    model: str
    certificate: Certificate
    solution: Any = field(repr=False, compare=False)
    """The solved motion, from which `pressure` is evaluated."""

    def pressure(self, x: Any, time: float) -> Any:
        """Return the contact pressure in Pa at the positions `x` (m) and one `time` (s)."""
        return self.solution.pressure(x, time)

    def surface(self, x: Any, time: float) -> Any:
        """Return the compression u of the foundation in m at the positions `x` (m) and one `time` (s).

        Under the indenter u = depth - x^2/2R; outside it relaxes from what the indenter left (fact F8).

        Examples
        --------
        >>> import kvtheory as kv
        >>> result = kv.transient(rtol=1e-9)
        >>> print((result.surface([-3e-3, 0.0, 1e-3], 0.1) * 1e6).round(3))
        [ 0.    89.738 81.644]
        """
        return self.solution.surface(x, time)

    def energy(self, time: Any) -> Any:
        """Return the energy ledger at the times (s): a `Ledger` of values or arrays in J/m (fact F14).

        The work of the drive, int F_x V dt, and what was stored at rest are spent on the kinetic
        energy, on the potential energies -M g (delta - delta_0) and k_s (delta - delta_0)^2/2, on what
        is stored, int K u^2/2 dx, and on what was dissipated, int int C (du/dt)^2 dx dt; the last two
        under the indenter (`..._contact`) and in the surface that relaxes (`..._surface`). `balance` is
        what is left over: only the error.

        Examples
        --------
        >>> import kvtheory as kv
        >>> books = kv.transient(rtol=1e-9).energy(0.1)
        >>> print(f"{books.work:.4f} {books.dissipated_contact:.4f} {books.stored_surface:.4f}")
        10.3091 7.7910 0.3461
        """
        return self.solution.energy(time)

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON: `time` first; what does not exist is None."""
        return {
            f.name: _record(getattr(self, f.name)) for f in fields(self) if f.name != "solution"
        }


def _record(result: Any) -> Any:
    """Turn a result, and what it holds, into what `json` writes."""
    if is_dataclass(result):
        return {f.name: _record(getattr(result, f.name)) for f in fields(result)}
    if isinstance(result, Mapping):
        return {key: _record(value) for key, value in result.items()}
    if isinstance(result, Event):
        return result._asdict()
    if isinstance(result, (np.ndarray, np.generic)):
        return _record(result.tolist())
    if isinstance(result, (tuple, list)):
        return [_record(item) for item in result]
    return None if isinstance(result, float) and not math.isfinite(result) else result
