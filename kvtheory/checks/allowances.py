r"""By how much a sound simulation may differ from theory, and its data from itself.

Four things make a difference without a mistake, each from theory or from the data:

- an element at an edge counts as a whole or not at all (F15): the normal force is off by up to
  b = p dx/2, p the pressure at that edge, and what follows from b by the linear response of F12;
- a time step smears the curves: theory within two steps before and after is as good; and unless the
  scheme is known to be of higher order, the rate may lag behind the depth by one step, and with it the
  force by h C L d'', which is the share z = h C L/M of the force that is not balanced;
- the data are noisy: sigma is measured by their second differences to theory, in which everything
  smooth cancels; it counts up to a limit only;
- the data are rounded: half their last digit.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.reading import Series
from kvtheory.checks.theory import CURVES, Theory
from kvtheory.results.schemes import SCHEME_ROWS

Array = NDArray[np.float64]

STANDARD = 200e3
FEWEST_ASSUMED, MOST_ASSUMED = 200.0, 490.0
"""Elements per m where the density is not known: the paper's 200 /mm, but so many in the static half
length at least, and at most as many as in Table 1."""
STEPS_SMEARED = 2.0
"""Steps of the time within which theory is as good as at the instant: a first-order scheme lags by one,
and its start by one more."""
ELEMENTS_AT_AN_EDGE = 2.0
"""An edge is reported to the element, and two enter in a step of the paper's scheme."""
LARGEST_NOISE = 0.1
"""Of the scale of a curve: louder data cannot be judged, and their noise does not excuse them."""
NORMAL_MAD = 0.6745
"""Median of the magnitude of a normal variate of variance one."""
UNKNOWN_STEP = 0.25
"""Of the fast time constant: the most that an unknown time step is taken for, unless the data are
sampled more coarsely than that."""
WHOLE_EDGE = 2.0
"""Half an element is the mean error of an edge, a whole one the largest."""


@dataclass(frozen=True)
class Resolution:
    """Spacing of the elements (m) and time step (s), and whether they are known or assumed."""

    spacing: float
    time_step: float
    spacing_known: bool
    step_known: bool


@dataclass(frozen=True)
class Allowance:
    """By name: theory's `low` and `high` within the smear, `systematic` and random (`noise`) parts.

    `force` is b, in N/m, at each time; `rounding` is the part of `systematic` that the digits leave.
    """

    low: Mapping[str, Array]
    high: Mapping[str, Array]
    systematic: Mapping[str, Array]
    noise: Mapping[str, float]
    force: Array
    rounding: Mapping[str, Array]

    def excess(self, name: str, values: Array) -> Array:
        """Return how far values lie outside the band of theory."""
        with np.errstate(invalid="ignore"):
            return np.maximum(np.maximum(self.low[name] - values, values - self.high[name]), 0.0)

    def most(self, name: str) -> Array:
        """Return what a single value may lie outside the band, by the number of values."""
        return self.systematic[name] + extreme(self.systematic[name].size) * self.noise[name]


def extreme(count: int) -> float:
    """Return a multiple of sigma that the largest of so many normal errors hardly exceeds."""
    return math.sqrt(2.0 * math.log(max(count, 2))) + 1.0


def resolution(theory: Theory, series: Series, per_length: float | None) -> Resolution:
    """Return the spacing and the step, known or else those of the paper for this scene."""
    given = per_length or series.per_length
    half = theory.static.half_length
    spacing = 1.0 / (given or min(max(STANDARD, FEWEST_ASSUMED / half), MOST_ASSUMED / half))
    speed, span = theory.top_speed, float(series.time[-1] - series.time[0])
    step = 2.0 * spacing / speed if speed else span / MOST_STEPS
    if series.time_step is not None:
        return Resolution(spacing, float(series.time_step), bool(given), True)
    paper = series.scheme == "paper" and bool(given)
    if not paper and theory.rates is not None:
        sampled = float(np.median(np.diff(series.time)))
        step = min(step, max(UNKNOWN_STEP * abs(theory.rates.fast), sampled))
    return Resolution(spacing, min(step, span / SHORTEST_RUN), bool(given), paper)


MOST_STEPS = 1000.0
"""Steps assumed for a base that never moves."""
SHORTEST_RUN = 20.0
"""Steps that a run must at least have, so that an assumed step does not smear all of it."""


def allowance(
    theory: Theory, series: Series, fine: Resolution, rtol: float
) -> tuple[Mapping[str, Array], Allowance]:
    """Return theory at the times of the series, and by how much the series may differ from it."""
    time, smear = series.time, STEPS_SMEARED * fine.time_step
    count = time.size
    jumps = np.array(
        [(np.nextafter(t, -1.0), t) for t in theory.scene.drive.jumps if t < time[-1]]
    ).reshape(-1)
    curves = theory.at(np.concatenate([time, time - smear, time + smear, jumps]), rtol)
    now, before, after = (
        {name: curves[name][k * count : (k + 1) * count] for name in CURVES} for k in range(3)
    )
    near = np.abs(time[:, None] - jumps) <= smear  # a window over a jump holds both its sides
    low, high = {}, {}
    for name in CURVES:
        sides = curves[name][3 * count :]
        parts = now[name], before[name], after[name]
        low[name] = np.fmin.reduce(
            [*parts, np.fmin.reduce(np.where(near, sides, np.nan), axis=1, initial=np.nan)]
        )
        high[name] = np.fmax.reduce(
            [*parts, np.fmax.reduce(np.where(near, sides, np.nan), axis=1, initial=np.nan)]
        )
    force = np.fmax.reduce(
        [edge_force(theory, part, fine.spacing) for part in (now, before, after)]
    )
    lags = [first_order(theory, part, series, fine) for part in (now, before, after)]
    share, lagging = np.fmax.reduce([z for z, _ in lags]), np.fmax.reduce([f for _, f in lags])
    late = lag(theory, now, time, high["depth_rate"] - low["depth_rate"])
    rest = AN_EIGHTH / LAGGING * late * (share > 0.0)
    lagging = lagging + theory.scene.foundation.damping * contact_length(now) * rest
    smooth = systematic(theory, now, (1.0 + share) * force, lagging, fine)
    smooth["depth_rate"] = smooth["depth_rate"] + late
    rounding = {name: rounded(series.columns[name]) for name in CURVES if name in series.columns}
    spread = {name: smooth[name] + rounding.get(name, 0.0) for name in CURVES}
    sigma = {name: noise(time, series.columns[name] - now[name]) for name in rounding}
    capped = {name: min(s, LARGEST_NOISE * theory.scales[name]) for name, s in sigma.items()}
    return now, Allowance(low, high, spread, capped, force, rounding)


def lag(theory: Theory, curves: Mapping[str, Array], time: Array, width: Array) -> Array:
    """Return what a scheme of first order still lacks of a fast change of the rate, after its band is over.

    Euler's method errs in exp(-t/T) by (h/2T)(t/T) exp(-t/T): an eighth of the width of the band, times
    t/T, and the rate soon turns, where the band is narrow. T = M/(C L) is that of the contact at the time;
    (t/T) exp(-t/T) is at most (2/e) exp(-t/2T).
    """
    support, foundation = theory.scene.support, theory.scene.foundation
    if theory.scene.held:
        return np.zeros_like(width)
    rate = 0.5 * foundation.damping * contact_length(curves) / support.mass
    ages = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    with np.errstate(divide="ignore"):
        left = np.maximum.accumulate(np.log(width) + ages) - ages
    return np.asarray(LAGGING * np.exp(left))


AN_EIGHTH, LAGGING = 0.25 / math.e, 0.25
"""Of the band, what a lag of first order is, and what is allowed of the rate: more, for what long steps add
of the next order in h/T."""


def contact_length(curves: Mapping[str, Array]) -> Array:
    """Return the length of the contact in m; zero in flight."""
    return np.asarray(np.nan_to_num(np.abs(curves["trailing_edge"] - curves["leading_edge"])))


def first_order(
    theory: Theory, curves: Mapping[str, Array], series: Series, fine: Resolution
) -> tuple[Array, Array]:
    """Return z = h C L/M and z |M d''|, by which the force may lag in a scheme of first order (Eq. 17).

    An element that enters is answered to within a step by the rate, with the share z of its force.
    """
    support, foundation = theory.scene.support, theory.scene.foundation
    none = np.zeros_like(curves["depth"])
    scheme = SCHEME_ROWS.get(series.scheme or "")
    if theory.scene.held or (scheme is not None and scheme.order_in_time > 1):
        return none, none
    spring = support.spring
    sunk = curves["depth"] - theory.static.depth
    net = support.weight - spring * sunk - curves["normal_force"]
    rate = foundation.damping * contact_length(curves) / support.mass
    z = np.minimum(fine.time_step * rate, 1.0)
    return z, z * np.abs(net)


def edge_force(theory: Theory, curves: Mapping[str, Array], spacing: float) -> Array:
    """Return b = p dx/2 at the edge of larger pressure, p = K g + C g' (Eq. 12); zero in flight.

    At rest p = 0 at both edges and the sum over elements is off by the second order K dx^2 a/R.
    """
    foundation = theory.scene.foundation
    R, K = theory.scene.indenter.radius, foundation.stiffness  # type: ignore[union-attr]
    pressures = []
    for name in ("leading_edge", "trailing_edge"):
        x = curves[name]
        rate = curves["depth_rate"] - x / R * curves["velocity"]
        pressures.append(K * (curves["depth"] - x * x / (2.0 * R)) + foundation.damping * rate)
    p = np.nan_to_num(np.fmax(np.maximum(pressures[0], 0.0), pressures[1]), nan=0.0)
    return 0.5 * p * spacing + K * spacing**2 * theory.static.half_length / R


def systematic(
    theory: Theory, curves: Mapping[str, Array], force: Array, lagging: Array, fine: Resolution
) -> dict[str, Array]:
    """Return what follows from the force b at the edge, by the linear response of F12, and from a lag.

    Leading edge, x^2 = 2 R delta: R/a times the depth; trailing edge, x^2 + 2 l_r x = 2 R (delta +
    tau delta') (Eq. 33): R/(x + l_r) times both; friction: b at x = a, and F_x in proportion to
    delta^(3/2).
    """
    foundation, dx = theory.scene.foundation, fine.spacing
    R, tau = theory.scene.indenter.radius, foundation.retardation_time  # type: ignore[union-attr]
    a = np.sqrt(2.0 * R * np.maximum(curves["depth"], SHALLOWEST * theory.static.depth))
    l_r = curves["velocity"] * tau
    depth, depth_rate, kick = response(theory, force, a, np.abs(l_r), fine.time_step)
    both = depth + tau * depth_rate
    slant = np.maximum(np.abs(curves["trailing_edge"] + l_r), dx)
    edge = ELEMENTS_AT_AN_EDGE * dx + R / a * depth
    carried = 1.5 * depth * 2.0 * R / (a * a) * np.abs(curves["friction_force"])
    slope = foundation.stiffness * (a + np.abs(l_r)) / R
    return {
        "velocity": np.full_like(force, SAME * theory.scales["velocity"]),
        "depth": depth + SAME * theory.scales["depth"],
        "depth_rate": depth_rate + kick + SAME * theory.scales["depth_rate"],
        "normal_force": WHOLE_EDGE * force + lagging,
        "friction_force": (WHOLE_EDGE * force + lagging) * a / R + carried,
        "leading_edge": edge,
        "trailing_edge": edge + np.nan_to_num(R * both / slant),
        "peak_pressure": slope * (edge + dx) + foundation.stiffness * both,
    }


def response(
    theory: Theory, force: Array, a: Array, l_r: Array, step: float
) -> tuple[Array, Array, Array]:
    """Return by how much b moves the depth, b/(K A + k_s), its rate, b/(C a), and b h/M in a step."""
    support, foundation = theory.scene.support, theory.scene.foundation
    if theory.scene.held or theory.rates is None:
        none = np.zeros_like(force)
        return none, none, none
    worst = np.maximum.accumulate(force)
    spring = support.spring
    depth = worst / (foundation.stiffness * (np.hypot(a, l_r) + a) + spring)
    swing = SWING if theory.rates.oscillates else 1.0
    return swing * depth, worst / (foundation.damping * a), worst * step / support.mass


SHALLOWEST = 1e-3
"""Of the static depth: where the contact vanishes, the response to b is taken at this depth."""
SWING = 2.0
"""An oscillation overshoots at most by this factor."""
SAME = 1e-6
"""Relative: what is given, not computed, agrees to the digits of a file."""


def noise(time: Array, residual: Array) -> float:
    """Return sigma of the random part of a residual, from its differences to its neighbours' line.

    For white noise the difference has the variance sigma^2 (1 + w^2 + (1 - w)^2), w the weight of the
    earlier neighbour; the median of magnitudes is robust against jumps.
    """
    known = np.isfinite(residual)
    t, r = time[known], residual[known]
    if t.size < 5:
        return 0.0
    span = t[2:] - t[:-2]
    use = span > 0.0
    w = (t[2:] - t[1:-1])[use] / span[use]
    gap = r[1:-1][use] - w * r[:-2][use] - (1.0 - w) * r[2:][use]
    scaled = np.abs(gap) / np.sqrt(1.0 + w * w + (1.0 - w) ** 2)
    return float(np.median(scaled)) / NORMAL_MAD if scaled.size else 0.0


def rounded(values: Array) -> Array:
    """Return what rounding leaves: half the smallest step between values, or half their last digit.

    >>> rounded(np.array([1.23e-4, 4.56e-4, 1.24e-3])).round(9).tolist()
    [5e-07, 5e-07, 5e-06]
    """
    distinct = np.unique(values[np.isfinite(values)])
    step = float(np.diff(distinct).min()) if distinct.size >= SEVERAL else 0.0
    on_grid = step > 0.0 and np.abs(distinct / step - np.round(distinct / step)).max() <= ON_GRID
    half = 0.5 * step if on_grid else 0.0
    size = 10.0 ** np.floor(np.log10(np.maximum(np.abs(np.nan_to_num(values)), 1e-300)))
    for digits in FEW_DIGITS:
        last = size * 10.0 ** (1 - digits)
        off = np.abs(values / last - np.round(values / last))
        if np.nanmax(off, initial=0.0) <= SAME:
            return np.asarray(np.maximum(half, 0.5 * last))
    return np.full_like(values, half)


FEW_DIGITS = (3, 4, 5)
"""Significant digits to which a column may have been written; more do not matter, and fewer are those of
exact numbers such as a velocity of 0.1 m/s."""
SEVERAL = 10
"""Distinct values whose smallest distance, if all are multiples of it, says how finely they were written."""
ON_GRID = 1e-3
