"""Steady sliding: its state, its stability, and which asymptote of it holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from html import escape
from typing import Any

import numpy as np

from kvtheory.results.certificate import Certificate, Value, record
from kvtheory.results.presented import Presented, aligned, html_table, value_range, with_unit
from kvtheory.results.table import STEADY_UNITS

UNSTABLE = (
    "Steady sliding is unstable{} on the spring in the drive and will not persist; see `stability`."
)
UNKNOWN = (
    "Whether steady sliding is stable on this spring is known only for a parabola and a ball on "
    "Kelvin-Voigt or a Prony series."
)


@dataclass(frozen=True, repr=False)
class SteadyState(Presented):
    """Steady sliding: each quantity a float, or an array where the input was an array.

    The edges are coordinates in the frame of the indenter, in which the foundation moves through
    x with the drive velocity: the leading edge is at x < 0 for a positive velocity. For a ball they are
    those of its middle plane; its contact extends over |y| < a sqrt(R'/R), and its forces are in N, see
    `units`.

    `stable` says whether steady sliding is stable: it is with a rigid drive; with a spring in the drive it
    is None if not known. `notes` are sentences about limits of the model that this scene exceeds.
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
    units: Mapping[str, str] = field(
        default_factory=lambda: STEADY_UNITS, repr=False, compare=False
    )
    """The SI unit of each quantity."""
    stable: Any = True
    over: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    """The values that vary, by key of the scene, in SI; each has the shape of the quantities."""
    notes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def unstable(self) -> str:
        """Return one line if steady sliding is unstable, or if its stability is not known; else nothing."""
        if self.stable is None:
            return UNKNOWN
        count = np.size(self.stable) - np.count_nonzero(self.stable)
        of = "" if np.ndim(self.stable) == 0 else f" in {count} of {np.size(self.stable)} scenes"
        return UNSTABLE.format(of) if count else ""

    def __repr__(self) -> str:
        """Return a summary in a few lines, with the notes."""
        return "\n".join([super().__repr__(), *self.notes])

    def _repr_html_(self) -> str:
        return super()._repr_html_() + "".join(f"<p>{escape(note)}</p>" for note in self.notes)

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return {f.name: record(getattr(self, f.name)) for f in fields(self) if f.repr}


@dataclass(frozen=True)
class Stability:
    """Stability of steady sliding: each quantity a value, or an array where the input was an array.

    `stable` is meant against small disturbances: the real parts of all rates are negative.
    `rates` holds, along its last axis but one, the rates of small motions in 1/s as pairs (real,
    imaginary), fastest growth first, and `time_constants` -1/real of each in s: negative for a growing
    motion. Above `critical_stiffness` (N/m^2, of a ball N/m) of the spring in the drive steady sliding is
    stable, and below `lower_critical_stiffness`, too, which is 0 where friction falls with velocity.
    `frequency` (Hz) is that of the motion at the onset of instability, at the upper critical stiffness.
    `critical_velocity` (m/s) is that of the onset of instability: the smallest at which the present stiffness
    becomes critical. It is not V* of `kvtheory.asymptotes`, where the asymptotes of friction cross.
    Values that do not exist, or were not requested, are NaN.
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

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        return record(self)


@dataclass(frozen=True)
class AsymptoteLine:
    """One asymptote of a scene: its value, the exact one, and its range.

    `relative_error` is asymptote/exact - 1; `velocity_min` and `velocity_max` bound the drive
    velocities |V| in m/s at which its magnitude is within the tolerance of the report. Values that do
    not exist (the high asymptote of the depth at V = 0) are NaN. Up to `velocity_proved`, or from it on for
    the high-velocity asymptote, a theorem guarantees this; for Kelvin-Voigt that is the whole range.
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


@dataclass(frozen=True, repr=False)
class AsymptoteReport:
    """Which asymptote of the friction coefficient holds.

    `critical_velocity` is V* of the paper (Eqs. 47, 48), where both asymptotes cross; the velocity at which
    a spring in the drive becomes unstable is another, see `kvtheory.stability`. `regime` is ``"low"`` or
    ``"high"`` (V below or above V*); `use` names the asymptote that is
    within the tolerance, ``"L1"`` or ``"L2"``, or else ``"exact"``.
    `maxima` are all local maxima of the friction coefficient over V > 0, as pairs of velocity and friction
    coefficient in the order of velocity; `peak_velocity` and `peak_friction_coefficient` are the highest,
    NaN if there is none. For arrays of scenes they are arrays, padded with NaN. Their relative errors have
    the same names and form in `maxima_certificate`; a maximum that does not stand out by more than the error
    of friction is not listed.

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
    notes: tuple[str, ...] = field(default=(), compare=False)
    units: Mapping[str, str] = field(
        default_factory=lambda: STEADY_UNITS, repr=False, compare=False
    )
    """The SI unit of each quantity."""

    def __repr__(self) -> str:
        """Return what to use, and a table of the asymptotes."""
        table = ["", *aligned(self._heads(), self._rows())] if self.lines else []
        return "\n".join([*self._summary(), *table])

    def _repr_html_(self) -> str:
        """Return the same for notebooks."""
        if not self.lines:
            return "".join(f"<p>{escape(line)}</p>" for line in self._summary())
        return html_table("; ".join(self._summary()), self._heads(), self._rows())

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None."""
        return {f.name: record(getattr(self, f.name)) for f in fields(self) if f.repr}

    def _summary(self) -> list[str]:
        velocity, maxima = with_unit(self.velocity, "m/s"), self._maxima()
        if not self.lines:
            return [f"V = {velocity}", maxima, *self.notes]
        regimes = " or ".join(f"{each}-velocity" for each in np.unique(self.regime))
        use = " or ".join(np.unique(self.use)).replace("exact", "the exact solution")
        ratio = with_unit(np.abs(self.velocity) / self.critical_velocity, "1")
        return [
            f"V = {velocity}, asymptotes cross at V* = "
            f"{with_unit(self.critical_velocity, 'm/s')}, V/V* = {ratio}: {regimes} regime",
            maxima,
            f"for the friction coefficient to within {self.tolerance:g}, use {use}",
        ]

    def _maxima(self) -> str:
        """Return the maxima of one scene, or the range of the highest of several."""
        if not self.maxima:
            return "no friction maximum"
        several = np.ndim(self.peak_velocity) > 0
        pairs = [(self.peak_velocity, self.peak_friction_coefficient)] if several else self.maxima
        name = "highest friction maximum" if several else "friction maximum"
        places = (f"mu = {with_unit(mu, '1')} at V = {with_unit(V, 'm/s')}" for V, mu in pairs)
        return f"{name}: {'; '.join(places)}"

    @property
    def _proved(self) -> bool:
        """Whether the whole range is proved."""
        return self.certificate.kind == "proved"

    def _heads(self) -> tuple[str, ...]:
        proved = () if self._proved else ("proved for",)
        heads = "asymptote", "Eq.", "formula", "value", "exact", "relative error"
        return (*heads, f"within {self.tolerance:g} for", *proved)

    def _rows(self) -> list[tuple[str, ...]]:
        rows = []
        for line in self.lines:
            unit, low = self.units[line.quantity], line.regime == "low"
            proved = (0.0, line.velocity_proved) if low else (line.velocity_proved, np.inf)
            rows.append(
                (
                    line.name, f"({line.equation})" if line.equation else "", line.formula,
                    with_unit(line.value, unit), with_unit(line.exact, unit),
                    value_range(line.relative_error, "+.3g"),
                    _velocities(line.velocity_min, line.velocity_max),
                    *(() if self._proved else (_velocities(*proved),)),
                )
            )  # fmt: skip
        return rows


def _velocities(low: Value, high: Value) -> str:
    """Return the range of velocities over which something holds, in words."""
    if np.all(np.equal(low, 0.0) & np.isinf(high)):
        return "every V"
    if np.all(np.equal(high, 0.0) | np.isinf(low)):
        return "no V"
    upper = f"|V| <= {with_unit(high, 'm/s')}"
    return f"|V| >= {with_unit(low, 'm/s')}" if np.all(np.isinf(high)) else upper
