"""Error budget of a correct simulation: by how much it may differ from theory.

Four effects make a difference without a mistake, each known from theory or from the data:

- an element at an edge counts as a whole or not at all (F15): the normal force is off by up to
  b = p dx/2, p the pressure at that edge, the motion by the linear response to b (F12), and on a spring
  also by a disturbed motion along x (`spring_response`);
- a time step shifts the curves: theory within two steps before and after is as good; and unless the
  scheme is known to be of higher order, the rate may lag behind the depth by one step, and with it the
  force by h C L d'', which is the share z = h C L/M of the force that is not balanced;
- the data are noisy: sigma is measured by their second differences to theory, in which everything
  smooth cancels; it counts up to a limit only;
- the data are rounded: half their last digit, and times to the next one.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from kvtheory.checks.noise import extreme, noise, rounded, time_rounding
from kvtheory.checks.reading import Series
from kvtheory.checks.resolution import Resolution
from kvtheory.checks.spring_response import spring_response
from kvtheory.checks.theory import CURVES, SHALLOWEST, Array, Curves, Theory
from kvtheory.results.schemes import SCHEME_ROWS

STEPS_SMEARED = 2.0
"""Steps within which theory may lead or lag: a first-order scheme lags by one, and its start by one more."""
ELEMENTS_AT_AN_EDGE = 2.0
"""An edge is reported to the element, and two enter in a step of the paper's scheme."""
LARGEST_NOISE = 0.1
"""Of a curve or its scale: the part of louder noise that is allowed for."""
WHOLE_EDGE = 2.0
"""Half an element is the mean error of an edge, a whole one the largest."""
AN_EIGHTH, LAGGING = 0.25 / math.e, 0.25
"""Of the band: the lag of a first-order scheme, and what is allowed of the rate, for long steps add terms of
the next order in h/T."""
SWING = 2.0
"""An oscillation overshoots at most by this factor."""
INITIAL = 1e-3
"""Of the static depth: an initial depth may have been typed in with three digits."""
INPUT = 1e-6
"""Relative: what is given, not computed, agrees to the digits of a file."""
EXACT = {"velocity": 3, "sliding_velocity": 3}
"""Fewest significant digits that are taken for rounding: a velocity of 0.1 m/s is exact."""


@dataclass(frozen=True)
class Allowance:
    """By name: theory's `low` and `high` within the smear, `systematic` and random (`noise`) parts.

    `edge` has one curve, `normal_force`: the force b of half an element at an edge, in N/m. `rounding` is
    the part of `systematic` that comes from the digits.
    """

    low: Curves
    high: Curves
    systematic: Curves
    noise: Curves
    rounding: Curves
    edge: Curves

    @property
    def force(self) -> Array:
        """The force b, in N/m."""
        return self.edge["normal_force"]

    def excess(self, name: str, values: Array) -> Array:
        """Return how far values lie outside the band of theory."""
        with np.errstate(invalid="ignore"):
            return np.maximum(np.maximum(self.low[name] - values, values - self.high[name]), 0.0)

    def limit(self, name: str) -> Array:
        """Return how far a single value may lie outside the band."""
        return self.systematic[name] + extreme(self.systematic[name].size) * self.noise[name]

    def rows(self, rows: Array) -> "Allowance":
        """Return some rows of it."""
        parts = (getattr(self, field.name) for field in fields(self))
        return Allowance(*({name: v[rows] for name, v in part.items()} for part in parts))


def allowance(
    theory: Theory, series: Series, fine: Resolution, rtol: float
) -> tuple[Curves, Allowance]:
    """Return theory at the times of the series, and by how much the series may differ from it."""
    now, before, after, low, high = _bands(theory, series.time, fine.time_step, rtol)
    force = np.fmax.reduce([edge_force(theory, c, fine.spacing) for c in (now, before, after)])
    lags = [_first_order(theory, part, series, fine) for part in (now, before, after)]
    share, lagging = np.fmax.reduce([z for z, _ in lags]), np.fmax.reduce([f for _, f in lags])
    late = _lag(theory, now, series.time, high["depth_rate"] - low["depth_rate"])
    rest = AN_EIGHTH / LAGGING * late * (share > 0.0)
    lagging = lagging + theory.scene.foundation.damping * contact_extent(theory, now) * rest
    forces = (1.0 + share) * force, lagging
    smooth = _systematic(theory, now, series.time, forces, late, fine)
    if not theory.scene.drive.rigid:
        step = 0.0 if _higher_order(series) else fine.time_step
        moved = spring_response(theory, now, series.time, force, step, rtol)
        smooth = {name: smooth[name] + moved[name] for name in CURVES}
    given = {name: series.columns[name] for name in CURVES if name in series.columns}
    rounding = {name: rounded(values, EXACT.get(name, 0)) for name, values in given.items()}
    spread = {name: smooth[name] + rounding.get(name, 0.0) for name in CURVES}
    random = {
        name: np.minimum(
            noise(series.time, values - now[name], now[name]),
            LARGEST_NOISE * np.fmax(theory.scales[name], np.abs(now[name])),
        )
        for name, values in given.items()
    }
    return now, Allowance(low, high, spread, random, rounding, {"normal_force": force})


def _bands(theory: Theory, time: Array, step: float, rtol: float) -> tuple[Curves, ...]:
    """Return theory now, at both ends of the smear, and its least and largest within it."""
    smear = STEPS_SMEARED * step + time_rounding(time)
    jumps = [t for t in theory.scene.drive.jumps if t < time[-1]]
    sides = np.ravel([(np.nextafter(t, -1.0), t) for t in jumps])
    found = theory.at(np.concatenate([time, time - smear, time + smear, sides]), rtol)
    parts = {name: [*found[name][: 3 * time.size].reshape(3, -1)] for name in CURVES}
    near = np.abs(time[:, None] - sides) <= smear[:, None]  # a window over a jump holds both sides
    low, high = {}, {}
    for name in CURVES:
        over = [*np.where(near, found[name][3 * time.size :], np.nan).T]
        low[name], high[name] = (f.reduce([*parts[name], *over]) for f in (np.fmin, np.fmax))
    return *({name: parts[name][k] for name in CURVES} for k in range(3)), low, high


def _lag(theory: Theory, curves: Curves, time: Array, width: Array) -> Array:
    """Return by how much the rate of a first-order scheme still lags after the band of a fast change.

    Euler's method errs in exp(-t/T) by (h/2T)(t/T) exp(-t/T): an eighth of the width of the band, times
    t/T, and the rate soon turns, where the band is narrow. T = M/(C L) is that of the contact at the time;
    (t/T) exp(-t/T) is at most (2/e) exp(-t/2T).
    """
    support, foundation = theory.scene.support, theory.scene.foundation
    if theory.scene.held:
        return np.zeros_like(width)
    rate = 0.5 * foundation.damping * contact_extent(theory, curves) / support.mass
    ages = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    with np.errstate(divide="ignore"):
        left = np.maximum.accumulate(np.log(width) + ages) - ages
    return np.asarray(LAGGING * np.exp(left))


def contact_length(curves: Mapping[str, Array]) -> Array:
    """Return the length of the contact in m; zero in flight."""
    return np.asarray(np.nan_to_num(np.abs(curves["trailing_edge"] - curves["leading_edge"])))


def contact_extent(theory: Theory, curves: Mapping[str, Array]) -> Array:
    """Return what the damping of the foundation acts over: a length in m, of a ball an area in m^2."""
    return np.asarray(theory.width(curves["depth"]) * contact_length(curves))


def _first_order(
    theory: Theory, curves: Curves, series: Series, fine: Resolution
) -> tuple[Array, Array]:
    """Return z = h C L/M and z |M d''|, by which the force may lag in a scheme of first order (Eq. 17).

    Within a step, the rate responds to an element that enters, with the share z of its force.
    """
    support, foundation = theory.scene.support, theory.scene.foundation
    if theory.scene.held or _higher_order(series):
        none = np.zeros_like(curves["depth"])
        return none, none
    sunk = curves["depth"] - theory.static.depth
    net = support.weight - support.spring * sunk - curves["normal_force"]
    rate = foundation.damping * contact_extent(theory, curves) / support.mass
    z = np.minimum(fine.time_step * rate, 1.0)
    return z, z * np.abs(net)


def _higher_order(series: Series) -> bool:
    """Whether the scheme of the simulation is known to be of higher than first order."""
    scheme = SCHEME_ROWS.get(series.scheme or "")
    return scheme is not None and scheme.order_in_time > 1


def edge_force(theory: Theory, curves: Curves, spacing: float) -> Array:
    """Return b = p dx/2 at the edge of larger pressure, p = K g + C g' (Eq. 12); zero in flight.

    Of a ball it is that of the middle plane times the mean width: no more than this even if all strips agree.

    At rest p = 0 at both edges and the sum over elements is off by the second order K dx^2 a/R.
    """
    foundation = theory.scene.foundation
    R, K = theory.scene.indenter.radius, foundation.stiffness  # type: ignore[union-attr]
    pressures = []
    for name in ("leading_edge", "trailing_edge"):
        x = curves[name]
        rate = curves["depth_rate"] - x / R * curves["sliding_velocity"]
        pressures.append(K * (curves["depth"] - x * x / (2.0 * R)) + foundation.damping * rate)
    p = np.nan_to_num(np.fmax(np.maximum(pressures[0], 0.0), pressures[1]), nan=0.0)
    width = theory.width(curves["depth"])
    return np.asarray(width * (0.5 * p * spacing + K * spacing**2 * theory.static.half_length / R))


def _systematic(
    theory: Theory, curves: Curves, time: Array, forces: tuple[Array, Array], late: Array,
    fine: Resolution,
) -> dict[str, Array]:  # fmt: skip
    """Return what follows from the force b at the edge, by the linear response of F12, and from a lag.

    `forces` are b and the lag of the force, `late` is the lag of the rate.

    Leading edge, x^2 = 2 R delta: R/a times the depth; trailing edge, x^2 + 2 l_r x = 2 R (delta +
    tau delta') (Eq. 33): R/(x + l_r) times both; friction: b at x = a, and F_x in proportion to
    delta^(3/2).
    """
    foundation, dx, (force, lagging) = theory.scene.foundation, fine.spacing, forces
    R, tau = theory.scene.indenter.radius, foundation.retardation_time  # type: ignore[union-attr]
    a = np.sqrt(2.0 * R * np.maximum(curves["depth"], SHALLOWEST * theory.static.depth))
    l_r = curves["sliding_velocity"] * tau
    depth, depth_rate = _response(theory, curves, time, force, a, fine)
    depth_rate = depth_rate + late
    both = depth + tau * depth_rate
    slant = np.maximum(np.abs(curves["trailing_edge"] + l_r), dx)
    edge = ELEMENTS_AT_AN_EDGE * dx + R / a * depth
    carried = 1.5 * depth * 2.0 * R / (a * a) * np.abs(curves["friction_force"])
    slope = foundation.stiffness * (a + np.abs(l_r)) / R
    given = np.full_like(force, INPUT * theory.scales["velocity"])
    friction = (WHOLE_EDGE * force + lagging) * a / R + carried
    return {
        "velocity": given,
        "sliding_velocity": given,
        "depth": depth + INPUT * theory.scales["depth"],
        "depth_rate": depth_rate + INPUT * theory.scales["depth_rate"],
        "normal_force": WHOLE_EDGE * force + lagging,
        "friction_force": friction,
        "spring_force": friction,
        "leading_edge": edge,
        "trailing_edge": edge + np.nan_to_num(R * both / slant),
        "peak_pressure": slope * (edge + dx) + foundation.stiffness * both,
    }


def _response(
    theory: Theory, curves: Curves, time: Array, force: Array, a: Array, fine: Resolution
) -> tuple[Array, Array]:
    """Return by how much b moves the depth and its rate.

    The rate answers C L d' + (K A + k_s) d = b at once, and by b h/M in a step; the depth with the time
    constant T = C L/(K A + k_s) of the contact at the time. In flight nothing relaxes: the rate keeps what
    it had when the contact was lost, and the depth drifts with it.
    """
    support, foundation = theory.scene.support, theory.scene.foundation
    if theory.scene.held or theory.rates is None:
        return np.zeros_like(force), np.zeros_like(force)
    l_r = np.abs(curves["sliding_velocity"]) * foundation.retardation_time
    width = theory.width(curves["depth"])
    stiffness = foundation.stiffness * width * (np.hypot(a, l_r) + a) + support.spring
    damping = foundation.damping * width * np.maximum(contact_length(curves), a)
    still = force / stiffness
    larger = np.maximum(still, np.append(still[0], still[:-1]))
    ages = np.maximum(np.diff(time, prepend=0.0), 0.0)
    left = np.exp(-ages * stiffness / damping)
    at_rest = foundation.stiffness * fine.spacing**2 * theory.static.half_length
    at_rest *= float(theory.width(theory.static.depth))
    at_rest /= theory.scene.indenter.radius * float(stiffness[0])  # type: ignore[union-attr]
    depth, rate = [at_rest + INITIAL * theory.static.depth], [0.0]
    swing = SWING if theory.rates.oscillates else 1.0
    kick = force * (1.0 / damping + fine.time_step / support.mass)
    rows = zip(
        *(larger, left, ages, kick, stiffness / damping, contact_length(curves) == 0.0), strict=True
    )
    for most, share, age, step, decay, flies in rows:
        if flies:
            depth.append(depth[-1] + rate[-1] * age / swing)
            rate.append(rate[-1])
        else:
            depth.append(most + share * (depth[-1] - most))
            rate.append(step + swing * depth[-1] * decay)
    return swing * np.array(depth[1:]), np.array(rate[1:])
