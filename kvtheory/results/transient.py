"""Motions as time series: a transient, and a simulation by elements."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from kvtheory.results.cycles import Cycle, Ripple
from kvtheory.results.errors import Certificate, Value
from kvtheory.results.presented import Presented, record
from kvtheory.results.table import SERIES_UNITS, TRANSIENT_UNITS
from kvtheory.scene.arguments import checked, instant, instants, positions

STOPPED = 0.01
"""Share of the sliding velocity at the start below which a coasting indenter counts as stopped."""


class Event(NamedTuple):
    """What happened to the contact, and when (in s)."""

    time: float
    kind: str


@dataclass(frozen=True, repr=False, kw_only=True)
class TimeSeries(Presented):
    """Arrays in SI over `time`, as `TRANSIENT_UNITS` names them; in flight the edges are NaN.

    A note says if V/c, c the length of the contact, leaves the frequencies of a measured foundation.

    Of a drop, from a gap, `restitution` is the speed up at the first take-off over the speed down at the
    first landing, and `contact_time` (s) the time between both. Of an indenter that coasts, the sliding
    velocity stays below one hundredth of that at the start from `stopping_time` (s) on, after a sliding
    distance `stopping_distance` (m): friction vanishes with the velocity, so that the rest fades
    exponentially and never ends. They are None where they do not occur within the run.
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
    model: str
    certificate: Certificate
    units: Mapping[str, str] = field(
        default_factory=TRANSIENT_UNITS.copy, repr=False, compare=False
    )
    notes: tuple[str, ...] = field(default=(), compare=False)
    restitution: float | None = None
    contact_time: float | None = None
    stopping_time: float | None = None
    stopping_distance: float | None = None

    @property
    def _title(self) -> str:
        end, count = float(self.time[-1]) if len(self.time) else 0.0, len(self.time)
        return f"{super()._title}, {count} times up to {end * 1e3:.4g} ms"


@dataclass(frozen=True, repr=False, kw_only=True)
class Transient(TimeSeries):
    """A transient as a time series: arrays in SI over `time`; in flight the edges are NaN.

    `leading_state` and `trailing_state` say whether an edge is ``"peeling"`` (its pressure is zero),
    ``"touching"`` (it meets the free surface) or ``"free"`` (the indenter flies). Where the drive jumps,
    values are those just after the jump. `compiled` says whether the kernels were compiled (extra ``fast``)
    or interpreted; the numbers are the same.
    """

    leading_state: tuple[str, ...]
    trailing_state: tuple[str, ...]
    events: tuple[Event, ...]
    steps: int
    evaluations: int
    compiled: bool
    solution: Any = field(repr=False, compare=False)

    @checked(x=positions, time=instant)
    def pressure(self, x: Any, time: Any) -> Any:
        """Return the contact pressure in Pa at the positions `x` (m) and one `time` (s)."""
        return self.solution.pressure(x, time)

    @checked(x=positions, time=instant)
    def surface(self, x: Any, time: Any) -> Any:
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

    @checked(time=instants)
    def energy(self, time: Any) -> Any:
        """Return the energy balance at one or several times (s): a `Ledger` in J/m (fact F14).

        The work of the drive, int F_x V dt, and the energy stored at rest equal the sum of the kinetic
        energy, the potential energies -M g (delta - delta_0) and k_s (delta - delta_0)^2/2, the stored
        energy, int K u^2/2 dx, and the dissipated energy, int int C (du/dt)^2 dx dt; the last two are split
        into `..._contact` and `..._surface`, the relaxing surface. On a Prony series each arm, of stress s,
        also stores int s^2/2K_i dx, and it dissipates int int s^2/(K_i tau_i) dx dt. A spring in the drive
        adds `kinetic_along`, `stored_drive` and `dissipated_drive`. `balance` is the residual, a measure of
        the error.

        Examples
        --------
        >>> import kvtheory as kv
        >>> books = kv.transient(rtol=1e-9).energy(0.1)
        >>> print(f"{books.work:.4f} {books.dissipated_contact:.4f} {books.stored_surface:.4f}")
        10.3091 7.7910 0.3461
        """
        return self.solution.energy(time)

    @checked(time=instants)
    def impulse(self, time: Any) -> Any:
        """Return the vertical impulses on the indenter until one or several times (s), in N s/m, downward.

        The momentum at the start, M d(delta)/dt (`of_start`), and the impulses since then of the weight, of
        the spring of the support and of the foundation, -int F_z dt, make the `momentum`; `balance` is the
        residual (Eq. 17). A fixed indenter has none: ValueError.

        Examples
        --------
        >>> import kvtheory as kv
        >>> scene = kv.Scene(start=kv.Start(gap="1 mm", depth_rate="0.1 m/s"), run=kv.Run(0.05))
        >>> found = kv.transient(scene, rtol=1e-8).impulse(0.05)
        >>> f"{found.of_start:.1f} {found.of_weight:.1f} {abs(found.balance) < 1e-4}"
        '100.0 490.3 True'
        """
        return self.solution.impulse(time)


class Ending:
    """What a motion on a spring has beside its series: the cycle in which it ends, None if it coasts."""

    cycle: Any

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; what does not exist is None, as a cycle not reached."""
        cycle = self.cycle
        return {**record(self), "cycle": cycle.as_dict() if cycle and cycle.settles else None}


@dataclass(frozen=True, repr=False, kw_only=True)
class SprungTransient(Ending, Transient):
    """A transient with a spring in the drive: also `sliding_velocity` and `spring_force`.

    The sliding velocity is that of the base under the indenter, V - dx/dt, with x the displacement of the
    indenter; leading and trailing edge follow its sign. `spring_force` is that of spring and damper,
    k_x x + c_x dx/dt. `cycle` is that in which the motion ends; in JSON an object with its quantities by the
    names that `solve` has, and `relative_error`, None where the motion does not show its end.
    """

    sliding_velocity: Value
    spring_force: Value
    units: Mapping[str, str] = field(default_factory=SERIES_UNITS.copy, repr=False, compare=False)
    ended: Callable[[Cycle], Cycle] | None = field(default=None, repr=False, compare=False)
    """Of a cycle, itself; of steady sliding that is unstable, an unknown end."""

    @property
    def cycle(self) -> Cycle | None:
        """The cycle in which the motion ends: steady sliding, or stick-slip."""
        if self.solution.coasts:
            return None
        found: Cycle = self.solution.cycle
        return self.ended(found) if self.ended else found


@dataclass(frozen=True, repr=False, kw_only=True)
class Simulation(TimeSeries):
    """A run of the elements as a time series: arrays in SI over `time`; in flight the edges are NaN.

    Where the drive jumps, values are those just after the jump. `per_length` is the number of elements per
    length (1/m), `time_step` the longest step (s), `element_updates` the number of updates of single
    elements; `warning` says why the step may be too long, if so; `compiled` is as in `Transient`.
    """

    scheme: str
    per_length: float
    time_step: float
    steps: int
    element_updates: int
    warning: str
    compiled: bool


@dataclass(frozen=True, repr=False, kw_only=True)
class SprungSimulation(Ending, Simulation):
    """A run of the elements on a spring, with the series and the `cycle` that a `SprungTransient` adds."""

    sliding_velocity: Value
    spring_force: Value
    units: Mapping[str, str] = field(default_factory=SERIES_UNITS.copy, repr=False, compare=False)
    cycle: Cycle | None = field(default=None, repr=False, compare=False)
    ripples: tuple[Ripple, ...] = field(default=(), repr=False, compare=False)
