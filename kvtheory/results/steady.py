"""Steady sliding: its state, its stability, and which asymptote of it holds."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.export import Columns
from kvtheory.results.errors import Certificate, Value
from kvtheory.results.presented import (
    Presented,
    Recorded,
    aligned,
    html_table,
    value_range,
    with_unit,
)
from kvtheory.results.table import STABILITY_UNITS, STEADY_UNITS

UNSTABLE = (
    "Steady sliding is unstable{} on the spring in the drive and will not persist; see `stability`."
)
UNKNOWN = (
    "Whether steady sliding is stable on this spring is known only for a parabola and a ball on "
    "independent elements, of Kelvin-Voigt or a Prony series."
)


@dataclass(frozen=True)
class PressureField:
    """The pressure (Pa) on the cells of a grid, of shape (x, y), whose centres are at `x` and `y`, in m.

    Of a line contact `y` is 0 alone. Where the pressure is singular, it is the mean over the cell.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    pressure: NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class SteadyState(Presented):
    """Steady sliding: each quantity a float, or an array where the input was an array.

    The edges are coordinates in the frame of the indenter, through which the foundation moves with the drive
    velocity: the leading edge is at x < 0 for a positive velocity. For a ball they are those of its middle
    plane; its contact extends over |y| < a sqrt(R'/R), and its forces are in N, see `units`.

    `pressure_field` is that of one scene by the method `layer`, else None.
    `stable` says whether steady sliding is stable (None: not known), as it is with a rigid drive. `over`
    holds the values that vary, by key of the scene, in SI; each has the shape of the quantities. `notes` are
    sentences about limits of the model that this scene exceeds.
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
    pressure_field: PressureField | None = field(default=None, compare=False)
    units: Mapping[str, str] = field(default_factory=STEADY_UNITS.copy, repr=False, compare=False)
    stable: Any = True
    over: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def unstable(self) -> str:
        """One line if steady sliding is unstable, or if its stability is not known; else empty."""
        if self.stable is None:
            return UNKNOWN
        count = np.size(self.stable) - np.count_nonzero(self.stable)
        of = "" if np.ndim(self.stable) == 0 else f" in {count} of {np.size(self.stable)} scenes"
        return UNSTABLE.format(of) if count else ""


@dataclass(frozen=True)
class Stability(Presented):
    """Stability of steady sliding: each quantity a value, or an array where the input was an array.

    `stable` means stable against small disturbances: the real parts of all rates are negative. `rates` holds,
    along its last axis but one, the rates of small motions in 1/s as pairs (real, imaginary), fastest growth
    first, and `time_constants` -1/real of each in s: negative for a growing motion. Steady sliding is stable
    if the spring in the drive is stiffer than `critical_stiffness` (N/m^2, of a ball N/m), or softer than
    `lower_critical_stiffness`, which is 0 where friction falls with velocity. `frequency` (Hz) is that of the
    motion at the upper critical stiffness. `critical_velocity` (m/s) is the smallest velocity at which the
    present stiffness is critical; V* of `kvtheory.asymptotes`, where the asymptotes of friction cross, is
    another one. Values that do not exist, or were not requested, are NaN. `over` is as in `SteadyState`.
    """

    stable: Any
    rates: Value
    time_constants: Value
    critical_stiffness: Value
    lower_critical_stiffness: Value
    critical_velocity: Value
    frequency: Value
    rigid_drive: bool
    model: str
    certificate: Certificate
    units: Mapping[str, str] = field(
        default_factory=STABILITY_UNITS.copy, repr=False, compare=False
    )
    over: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def motions(self) -> Any:
        """Growth (1/s) and frequency (Hz), along the last axis, of each motion; a pair of rates is one."""
        rates = np.asarray(self.rates)
        # nothing can move, or they were not requested
        if not rates.shape[-2] or rates.shape[-1] == 1:
            return np.full((*rates.shape[:-2], 1, 2), np.nan)
        once = np.where(rates[..., 1:] < 0.0, np.nan, rates / [1.0, math.tau])
        order = np.argsort(np.isnan(once[..., 0]), axis=-1, kind="stable")
        once = np.take_along_axis(once, order[..., np.newaxis], axis=-2)
        return once[..., : max((~np.isnan(once[..., 0])).sum(axis=-1).max(initial=1), 1), :]

    @property
    def growth_rate(self) -> Value:
        """Of the motion that grows fastest, or decays slowest, in 1/s."""
        return self.motions[..., 0, 0][()]

    @property
    def growth_frequency(self) -> Value:
        """Its frequency in Hz."""
        return self.motions[..., 0, 1][()]

    def _columns(self) -> Columns:
        columns = {**super()._columns(), "stable": (np.asarray(self.stable, dtype=float), "1")}
        for i in range(1, self.motions.shape[-2]):
            for k, (name, unit) in enumerate((("growth_rate", "1/s"), ("growth_frequency", "Hz"))):
                columns[f"{name}_{i + 1}"] = self.motions[..., i, k], unit
        return columns


REGIMES = {
    "low": "low-velocity regime", "high": "high-velocity regime",
    "between": "between the low- and the high-velocity regime, as some arms relax within the contact and "
    "others do not",
}  # fmt: skip


@dataclass(frozen=True)
class AsymptoteLine:
    """One asymptote of a scene: its value, the exact one, and its range.

    `relative_error` is asymptote/exact - 1; its magnitude is within the tolerance of the report for drive
    velocities |V| from `velocity_min` to `velocity_max` in m/s. Up to `velocity_proved`, or from it on for
    the high-velocity asymptote, a theorem guarantees this; for Kelvin-Voigt that is the whole range. Values
    that do not exist (the high asymptote of the depth at V = 0) are NaN.
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
    velocity_proved: Value


@dataclass(frozen=True)
class BodyLimits:
    """The limits of friction on the body itself, a layer: mu -> `low` V (s/m), mu -> `high`/V (m/s).

    They cross at `critical_velocity`, in m/s. What does not exist, as on a damper alone, is NaN.
    """

    low: Value
    high: Value
    critical_velocity: Value


@dataclass(frozen=True, repr=False)
class AsymptoteReport(Recorded):
    """Which asymptote of the friction coefficient holds.

    `critical_velocity` is V* of the paper (Eqs. 47, 48), where both asymptotes cross, not the one at which
    sliding on a spring becomes unstable (`kvtheory.stability`). `regime` is ``"low"`` or ``"high"``: V is
    below or above V*, or, on a Prony series, elements pass the contact in a time longer or shorter than all
    relaxation times; else ``"between"``. Of arms beside a damper C, the time is also longer than C/K in the
    former; in the latter it is shorter than C/G, G the sum of all stiffnesses. `use` names the asymptote that
    is within the tolerance, ``"L1"`` or ``"L2"``, or else ``"exact"``. `maxima` are all local maxima of the
    friction coefficient over V > 0 that
    stand out by more than the error of friction, as pairs of velocity and friction coefficient in the order
    of velocity;
    `peak_velocity` and `peak_friction_coefficient` are the highest, NaN if there is none. For arrays of
    scenes they are arrays, padded with NaN. Their relative errors have the same names and form in
    `maxima_certificate`.

    `layer` are the limits on the body itself, of a scene that is given by a layer, else None.

    Where the limits of friction are not known there are no `lines`, no V* (NaN) and no regime (None), and
    `notes` say so.
    """

    velocity: Value
    critical_velocity: Value
    peak_velocity: Value
    peak_friction_coefficient: Value
    maxima: tuple[tuple[Value, Value], ...]
    regime: Any
    use: Any
    tolerance: float
    lines: tuple[AsymptoteLine, ...]
    model: str
    certificate: Certificate
    maxima_certificate: Certificate
    layer: BodyLimits | None = None
    notes: tuple[str, ...] = field(default=(), compare=False)
    units: Mapping[str, str] = field(default_factory=STEADY_UNITS.copy, repr=False, compare=False)

    def __repr__(self) -> str:
        return "\n".join(
            [*self._summary(), *(["", *aligned(*self._table())] if self.lines else [])]
        )

    def _repr_html_(self) -> str:
        if not self.lines:
            return "".join(f"<p>{escape(line)}</p>" for line in self._summary())
        return html_table("; ".join(self._summary()), *self._table())

    def _summary(self) -> list[str]:
        """Return what to use, and the maxima: of several scenes the range of the highest."""
        velocity, several = with_unit(self.velocity, "m/s"), np.ndim(self.peak_velocity) > 0
        pairs = [(self.peak_velocity, self.peak_friction_coefficient)] if several else self.maxima
        places = (f"mu = {with_unit(mu, '1')} at V = {with_unit(V, 'm/s')}" for V, mu in pairs)
        name = "highest friction maximum" if several else "friction maximum"
        maxima = f"{name}: {'; '.join(places)}" if self.maxima else "no friction maximum"
        body = [_on_body(self.layer)] if self.layer else []
        if not self.lines:
            return [f"V = {velocity}", maxima, *body, *self.notes]
        regimes = " or ".join(REGIMES[each] for each in np.unique(self.regime))
        use = " or ".join(np.unique(self.use)).replace("exact", "the exact solution")
        ratio = with_unit(np.abs(self.velocity) / self.critical_velocity, "1")
        return [
            f"V = {velocity}, asymptotes cross at V* = "
            f"{with_unit(self.critical_velocity, 'm/s')}, V/V* = {ratio}: {regimes}",
            maxima,
            f"for the friction coefficient to within {self.tolerance:g}, use {use}",
            *body,
            *self.notes,
        ]

    def _table(self) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
        """Return heads and rows; a column for the proved range only where that is not the whole one."""
        partly, rows = self.certificate.kind != "proved", []
        heads = (
            "asymptote", "Eq.", "formula", "value", "exact", "relative error",
            f"within {self.tolerance:g} for", *["proved for"] * partly,
        )  # fmt: skip
        for line in self.lines:
            unit, known = self.units[line.quantity], line.velocity_proved
            proved = (0.0, known) if line.regime == "low" else (known, np.inf)
            rows.append(
                (
                    line.name, f"({line.equation})" if line.equation else "", line.formula,
                    with_unit(line.value, unit), with_unit(line.exact, unit),
                    value_range(line.relative_error, "+.3g"),
                    _velocities(line.velocity_min, line.velocity_max),
                    *[_velocities(*proved)] * partly,
                )
            )  # fmt: skip
        return heads, rows


def _on_body(limits: BodyLimits) -> str:
    """Return the limits of friction on the body itself, in words."""
    low = f"mu -> {value_range(limits.low)} s/m V at low velocity"
    if np.isnan(limits.high).all():
        return f"on the layer itself, {low}"
    high = f"mu -> {value_range(limits.high)} m/s / V at high velocity"
    return (
        f"on the layer itself, {low}, {high}; they cross at V* = "
        f"{with_unit(limits.critical_velocity, 'm/s')}"
    )


def _velocities(low: Value, high: Value) -> str:
    """Return the range of velocities over which something holds, in words."""
    if np.all(np.equal(low, 0.0) & np.isinf(high)):
        return "every V"
    if np.all(np.equal(high, 0.0) | np.isinf(low)):
        return "no V"
    upper = f"|V| <= {with_unit(high, 'm/s')}"
    return f"|V| >= {with_unit(low, 'm/s')}" if np.all(np.isinf(high)) else upper
