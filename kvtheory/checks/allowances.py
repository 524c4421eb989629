"""Error budget of a correct simulation: how far it may differ from theory.

Four effects make a correct simulation differ; theory or the data give the size of each:

- Elements. One at an edge counts as a whole or not at all (F15): the normal force is off by up to
  b = p dx/2, p being the pressure at that edge; the depth follows by the linear response to b (F12), and on
  a spring the motion along x is disturbed as well (`_spring_response`).
- Time steps. Curves may lead or lag by two steps. A scheme of first order, or of unknown order, has a rate
  that lags by one step; the force is then off by h C L d'', a fraction z = h C L/M of the unbalanced force.
- Noise. Sigma comes from second differences of the residual, in which all that is smooth cancels; it is
  capped.
- Rounding. Half the last digit; times by up to the next digit.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.noise import SEVERAL, digits, extreme, means, noise, rounded, time_rounding
from kvtheory.checks.theory import CURVES, SHALLOWEST, Array, Curves, Theory
from kvtheory.fitting.series import Series
from kvtheory.results.table import SCHEME_ROWS
from kvtheory.scene.model import Fixed, Scene

Mask = NDArray[np.bool_]

STANDARD = 200e3
FEWEST_ASSUMED, MOST_ASSUMED = 200.0, 490.0
"""Elements per m assumed if none are given: the paper's 200 /mm, within these numbers of elements per static
half length, of which Table 1 has the larger one."""
MARGIN = 1.4
"""Margin on the spacing assumed or read from an even sawtooth; and on the error of a spring by the step."""
UNKNOWN_STEP = 0.25
"""Longest time step assumed if none is given, in fast time constants, the sampling interval if longer; and in
periods over 2 pi of the mass on its spring."""
MOST_STEPS, FEWEST_STEPS = 1000.0, 20.0
"""Steps of a run assumed for a base at rest; and the fewest assumed for any run."""
STEPS_SMEARED = 2.0
"""Steps by which data may lead or lag: a first-order scheme lags by one, its start by one more."""
ELEMENTS_AT_AN_EDGE = 2.0
"""Error of an edge in elements: two enter in a step of the paper's scheme, and edges lie on elements."""
EDGES, COARSEST_EDGE, NEARLY_ALL = ("leading_edge", "trailing_edge"), 0.12, 0.97
"""Columns that jump by one element; the largest accepted, in half lengths; and the quantile taken for one."""
BALL_EDGE = 0.02
"""Element of a ball assumed for its edges, in half lengths: its forces need few elements."""
LARGEST_NOISE = 0.1
"""Largest noise that is allowed for, as a fraction of the curve or of its scale."""
FORCES = "normal_force", "friction_force"
"""The columns that no scene gives."""
RATES = "depth_rate", "sliding_velocity"
"""The curves to which the dampers answer."""
WHOLE_EDGE = 2.0
"""Largest error of an edge (one element) over the mean error (half an element)."""
FIRST_ORDER_LAG, LAG = 0.25 / math.e, 0.25
"""Lag of the rate by a first-order scheme, as a fraction of the width of the band; and the lag allowed, as
long steps add terms of higher order in h/T."""
OVERSHOOT = 2.0
"""Largest overshoot of an oscillation, or of a spring under a sudden load."""
INITIAL = 1e-3
"""Error of the initial depth, relative to the static depth: it may be typed in with three digits."""
INPUT = 1e-6
"""Relative error of quantities that are given, not computed."""
GIVEN_DIGITS = 3
"""Fewest significant digits that count as rounded where the velocity is given: 0.1 m/s is exact."""
QUARTER = 0.5 * math.pi
"""Quarter of a period, in radians: two oscillations differ most so long after they cross."""


class Resolution(NamedTuple):
    """Spacing of elements (m) and time step (s), known or assumed; what the spacing was estimated from."""

    spacing: float
    time_step: float
    spacing_known: bool
    step_known: bool
    spacing_read: str = ""


def resolution(theory: Theory, series: Series, per_length: float | None) -> Resolution:
    """Return the spacing and the step: those given, or else the paper's for this scene."""
    given = per_length or series.per_length
    half, scheme = theory.static.half_length, SCHEME_ROWS.get(series.scheme or "")
    spacing = 1.0 / (given or min(max(STANDARD, FEWEST_ASSUMED / half), MOST_ASSUMED / half))
    speed, span = theory.motion.highest_speed, float(series.time[-1] - series.time[0])
    step = 2.0 * spacing / speed if speed else span / MOST_STEPS
    if series.time_step is not None:
        return Resolution(spacing, float(series.time_step), bool(given), True)
    paper = scheme is not None and scheme.papers_step and bool(given)
    if not paper and theory.rates is not None:
        sampled = float(np.median(np.diff(series.time)))
        step = min(step, max(UNKNOWN_STEP * abs(theory.rates.fast), sampled))
        if not theory.scene.drive.rigid:
            step = min(step, UNKNOWN_STEP * theory.swing)
    return Resolution(spacing, min(step, span / FEWEST_STEPS), bool(given), paper)


class Band(NamedTuple):
    """Range of theory within a few steps; outside it the smooth error, its rounding part, and sigma."""

    low: Array
    high: Array
    systematic: Array
    noise: Array
    rounding: Array

    def averaged(self, rows: int) -> "Band":
        """Return the band of means of so many rows, in which noise averages out."""
        found = Band(*(means(part, rows) for part in self))
        return found._replace(noise=found.noise / math.sqrt(rows))

    def excess(self, values: Array) -> Array:
        """Return how far values lie outside the range of theory."""
        return np.maximum(np.maximum(self.low - values, values - self.high), 0.0)

    def limit(self) -> Array:
        """Return how far a single value may lie outside the range."""
        return self.systematic + extreme(self.systematic.size) * self.noise


def allowance(
    theory: Theory, series: Series, fine: Resolution, rtol: float
) -> tuple[Curves, dict[str, Band], Array]:
    """Return theory at the times of the series, the band of each curve, and the force b at the edge."""
    time, support, C = series.time, theory.scene.support, theory.damping(fine.time_step)
    scheme = SCHEME_ROWS.get(series.scheme or "")
    first_order = scheme is None or scheme.order_in_time <= 1
    now, before, after, low, high = _bands(theory, time, _smear(time, fine.time_step), rtol)
    share, lagging, late, drift = (np.zeros_like(time) for _ in range(4))
    h, moves = fine.time_step, not theory.scene.held
    if moves:
        late = _lag(theory, now, time, high["depth_rate"] - low["depth_rate"])
    unbalanced = np.array([_unbalanced(theory, part) for part in (now, before, after)])
    if first_order and moves:
        for part, off in zip((now, before, after), unbalanced, strict=True):
            z = np.minimum(h * C * contact_extent(theory, part) / support.mass, 1.0)
            share, lagging = np.fmax(share, z), np.fmax(lagging, z * off)
        lagging += FIRST_ORDER_LAG / LAG * C * contact_extent(theory, now) * late
    oscillation = theory.rates.oscillation if theory.rates else None
    if moves and theory.scene.drive.rigid and oscillation:
        pace = 1.0 / abs(oscillation)
        growth = 0.5 * h * pace**2 if first_order else h * h * pace**3 / 12.0
        drift = _drift(np.fmax.reduce(unbalanced), time, oscillation, growth)
        lagging += drift
        late = late + drift / (support.mass * pace)
        drift = drift / (support.mass * pace**2)
    force = np.fmax.reduce([_edge_force(theory, c, fine.spacing) for c in (now, before, after)])
    if moves:
        lagging += _entering(theory, now, (before, after), 2.0 * force / fine.spacing)
        stiff = h * C * contact_extent(theory, now) > support.mass
        known = beside_jumps(theory, time, h) & theory.scene.drive.rigid
        order = stiff, first_order
        lagging += C * _unfollowed(theory, (now, before, after), (low, high), known, order)
    smooth = _systematic(theory, now, time, ((1.0 + share) * force, lagging), (drift, late), fine)
    if not theory.scene.drive.rigid:
        step = fine.time_step * (1.0 if fine.step_known else MARGIN) if first_order else 0.0
        for name, moved in _spring_response(theory, now, time, force, step, rtol).items():
            smooth[name] = smooth[name] + moved
    low, high = _landed(theory, now, time, smooth["depth"], (low, high), rtol)
    few = np.unique(series.columns.get("sliding_velocity", 0.0)).size < SEVERAL  # as driven
    bands, given = {}, ("velocity", "sliding_velocity")[: 1 + (few or theory.scene.drive.rigid)]
    for name in CURVES:
        rounding = sigma = np.zeros_like(time)
        if name in series.columns:
            values = series.columns[name]
            fewest = GIVEN_DIGITS if name in given else _written(series.columns, name, now[name])
            rounding = rounded(values, fewest, grid=name not in EDGES)
            loudest = LARGEST_NOISE * np.fmax(theory.scales[name], np.abs(now[name]))
            sigma = np.minimum(noise(time, values - now[name], now[name], rounding), loudest)
            if name in EDGES and not fine.spacing_known:
                jumps = edge_jumps(
                    (values - now[name])[~beside_jumps(theory, time, fine.time_step)]
                )
                jumps = min(jumps, COARSEST_EDGE * theory.static.half_length) - fine.spacing
                if not theory.scene.indenter.per_width:
                    jumps = max(jumps, BALL_EDGE * theory.static.half_length)
                smooth[name] = smooth[name] + ELEMENTS_AT_AN_EDGE * max(jumps, 0.0)
        bands[name] = Band(low[name], high[name], smooth[name] + rounding, sigma, rounding)
    return now, bands, force


def _written(columns: Curves, name: str, now: Array) -> float:
    """Return the fewest digits of a column: a constant that is that of theory has as many as the forces."""
    values = columns[name]
    if np.ptp(values) > 0.0 or not np.allclose(values, now, rtol=INPUT, atol=0.0):
        return 0.0
    others = (digits(columns[other]) for other in FORCES if other in columns)
    return max(others, default=0.0)


def edge_jumps(residual: Array) -> float:
    """Return by how much an edge jumps to the next element: nearly its largest change between samples."""
    changes = np.abs(np.diff(residual[np.isfinite(residual)]))
    return float(np.quantile(changes, NEARLY_ALL)) if changes.size else 0.0


def _smear(time: Array, step: float) -> Array:
    """Return by how much the data may lead or lag, in s."""
    return STEPS_SMEARED * step + time_rounding(time)


def beside_jumps(theory: Theory, time: Array, step: float) -> Mask:
    """Return which times are so near a jump of the drive that the data may be of its other side."""
    off = np.abs(time[:, None] - np.array([*theory.jumps]))
    return np.asarray((off <= _smear(time, step)[:, None]).any(axis=1))


def _landed(
    theory: Theory, now: Curves, time: Array, depth: Array, ends: tuple[Curves, Curves], rtol: float
) -> tuple[Curves, Curves]:
    """Return the least and greatest values where a landing may come earlier or later.

    It does by the error of the depth over the rate with which the indenter comes down.
    """
    flies = np.isnan(now["leading_edge"])
    down = flies & (now["depth_rate"] > 0.0)
    lands = np.flatnonzero(down[:-1] & ~flies[1:])
    if not lands.size:
        return ends
    shift = np.zeros_like(time)
    shift[lands] = depth[lands] / now["depth_rate"][lands]
    for row in lands:  # also where it lands before the next row, or after it
        shift[row - 1 : row + 1] = shift[row]
    *_, low, high = _bands(theory, time, np.maximum.accumulate(shift), rtol)
    least = {name: np.fmin(ends[0][name], low[name]) for name in CURVES}
    return least, {name: np.fmax(ends[1][name], high[name]) for name in CURVES}


def _bands(theory: Theory, time: Array, smear: Array, rtol: float) -> tuple[Curves, ...]:
    """Return theory at the times, so long before and after, and its least and greatest values between."""
    jumps = [t for t in theory.jumps if t < time[-1]]
    sides = np.ravel([(np.nextafter(t, -1.0), t) for t in jumps])
    found = theory.at(np.concatenate([time, time - smear, time + smear, sides]), rtol)
    parts = {name: [*found[name][: 3 * time.size].reshape(3, -1)] for name in CURVES}
    near = np.abs(time[:, None] - sides) <= smear[:, None]  # a range holds both sides of a jump
    low, high = {}, {}
    for name in CURVES:
        over = [*np.where(near, found[name][3 * time.size :], np.nan).T]
        low[name], high[name] = (f.reduce([*parts[name], *over]) for f in (np.fmin, np.fmax))
    return *({name: parts[name][k] for name in CURVES} for k in range(3)), low, high


def _lag(theory: Theory, curves: Curves, time: Array, width: Array) -> Array:
    """Return the lag of the rate that a first-order scheme keeps after a fast change.

    The error of Euler's method in exp(-t/T) is (h/2T)(t/T) exp(-t/T), an eighth of the band's width times
    t/T, with T = M/(C L) of the current contact; and (t/T) exp(-t/T) is at most (2/e) exp(-t/2T).
    """
    damping, mass = theory.scene.foundation.slow_damping, theory.scene.support.mass
    rate = 0.5 * damping * contact_extent(theory, curves) / mass
    ages = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    with np.errstate(divide="ignore"):
        left = np.maximum.accumulate(np.log(width) + ages) - ages
    return np.asarray(LAG * np.exp(left))


def _unbalanced(theory: Theory, curves: Curves) -> Array:
    """Return the magnitude of the force that accelerates the indenter, zero if it is fixed."""
    if theory.scene.held:
        return np.zeros_like(curves["depth"])
    support, sunk = theory.scene.support, curves["depth"] - theory.static.depth
    return np.asarray(np.abs(support.weight - support.spring * sunk - curves["normal_force"]))


def _drift(unbalanced: Array, time: Array, oscillation: complex, growth: float) -> Array:
    """Return the error of the force by a scheme whose oscillation gains or loses `growth` per second.

    A step h changes a motion exp(-t/T) by the rate h/(2 |T|^2) if the scheme is of first order, else by
    h^2/(12 |T|^3). Its amplitude is that of the unbalanced force of theory; where the phase is lost the error
    is twice that.
    """
    ages = np.maximum(time, 0.0)
    decay = ages * (1.0 / oscillation).real
    with np.errstate(divide="ignore"):
        left = np.maximum.accumulate(np.log(unbalanced) + decay) - decay
    return np.asarray(np.exp(left) * np.minimum(growth * ages, OVERSHOOT))


def _contact_length(curves: Mapping[str, Array]) -> Array:
    return np.asarray(np.nan_to_num(np.abs(curves["trailing_edge"] - curves["leading_edge"])))


def contact_extent(theory: Theory, curves: Mapping[str, Array]) -> Array:
    """Return the length of the contact in m, for a ball its area in m^2."""
    return np.asarray(theory.width(curves["depth"]) * _contact_length(curves))


def _edge_force(theory: Theory, curves: Curves, spacing: float) -> Array:
    """Return b = p dx/2 at the edge with the larger pressure, p = K g + C g' (Eq. 12); zero in flight.

    For a ball, p of the middle plane times the mean width is an upper bound. At rest p = 0 at both edges, and
    the error is K dx^2 a/R.
    """
    R, foundation = theory.radius, theory.scene.foundation
    p = np.zeros_like(curves["depth"])
    speed = np.abs(curves["sliding_velocity"])
    damping = theory.damping(spacing / np.maximum(speed, spacing / theory.static.time))
    for name in ("leading_edge", "trailing_edge"):
        x = curves[name]
        rate = curves["depth_rate"] - x / R * curves["sliding_velocity"]
        overlap = curves["depth"] - x * x / (2.0 * R)
        p = np.fmax(p, foundation.stiffness * overlap + damping * rate)
    at_rest = foundation.stiffness * spacing**2 * theory.static.half_length / R
    return np.asarray(theory.width(curves["depth"]) * (0.5 * p * spacing + at_rest))


def _entering(theory: Theory, now: Curves, others: Sequence[Curves], pressure: Array) -> Array:
    """Return the force of the elements that enter in a step because the leading edge moves.

    The motion of a step balances the elements at its start; those that enter later add p times their length.
    The edge moves by x dx = R d(delta), or over ground that it finds compressed after a reversal.
    """
    a = np.sqrt(2.0 * theory.radius * np.maximum(now["depth"], SHALLOWEST * theory.static.depth))
    shifts = []
    for part in others:
        shift = now["leading_edge"] - part["leading_edge"]
        same = np.sign(now["sliding_velocity"]) == np.sign(part["sliding_velocity"])
        shifts.append(theory.radius / a * np.abs(now["depth"] - part["depth"]))
        shifts.append(np.where(same, np.nan_to_num(np.abs(shift)), 0.0))
    return np.asarray(pressure * np.fmax.reduce(shifts) / STEPS_SMEARED)


def _unfollowed(
    theory: Theory, parts: Sequence[Curves], ends: Sequence[Curves], known: Mask, order: tuple[Mask, bool]
) -> Array:  # fmt: skip
    """Return the force over C by which delta' and V change in a step without its motion knowing.

    The motion of a step balances the forces at one rate delta' and velocity V; at its end the elements feel
    both as they are then. In a step that is long beside M/(C L), which makes any scheme one of first order,
    C L d(delta') is more than the unbalanced force. V adds C times the integral of -h' dV, unless it is
    `known` to jump; dV is that of a step, a part of the width of its band, or by a higher order its second
    difference.
    """
    now, before, after = parts
    low, high = ends
    stiff, first = order
    width = {name: (high[name] - low[name]) / (2.0 * STEPS_SMEARED) for name in RATES}
    V = "sliding_velocity"
    bend = np.abs(before[V] - 2.0 * now[V] + after[V]) / STEPS_SMEARED**2
    changed = np.where(known, 0.0, np.where(stiff | first, width[V], np.minimum(bend, width[V])))
    slant = np.abs(now["leading_edge"] ** 2 - now["trailing_edge"] ** 2) / (2.0 * theory.radius)
    found = contact_extent(theory, now) * np.where(stiff, width["depth_rate"], 0.0)
    return np.asarray(np.nan_to_num(found + theory.width(now["depth"]) * slant * changed))


def _systematic(
    theory: Theory, curves: Curves, time: Array, forces: tuple[Array, Array],
    lags: tuple[Array, Array], fine: Resolution,
) -> dict[str, Array]:  # fmt: skip
    """Return the smooth error of each curve by b, by a lag of the force, and by lags of depth and rate.

    The errors of the edges follow from x^2 = 2 R delta and x^2 + 2 l_r x = 2 R (delta + tau delta') (Eqs. 32
    and 33); that of friction is b at x = a, with F_x in proportion to delta^(3/2).
    """
    K, tau = theory.scene.foundation.stiffness, theory.scene.foundation.retardation_time
    R, dx, (force, lagging) = theory.radius, fine.spacing, forces
    a = np.sqrt(2.0 * R * np.maximum(curves["depth"], SHALLOWEST * theory.static.depth))
    l_r = curves["sliding_velocity"] * tau
    depth, depth_rate = lags
    if theory.rates is not None and not theory.scene.held:
        answers = _response(theory, curves, time, force, a, fine)
        depth, depth_rate = depth + answers[0], depth_rate + answers[1]
    both = depth + tau * depth_rate
    slant = np.maximum(np.abs(curves["trailing_edge"] + l_r), dx)
    edge = ELEMENTS_AT_AN_EDGE * dx + R / a * depth
    carried = 1.5 * depth * 2.0 * R / (a * a) * np.abs(curves["friction_force"])
    slope = K * (a + np.abs(l_r)) / R
    given = np.full_like(force, INPUT * theory.scales["velocity"])
    friction = (WHOLE_EDGE * force + lagging) * a / R + carried
    follows = np.full_like(force, INPUT * theory.scales["spring_force"])  # and `_spring_response`
    return {
        "velocity": given,
        "sliding_velocity": given,
        "depth": depth + INPUT * theory.scales["depth"],
        "depth_rate": depth_rate + INPUT * theory.scales["depth_rate"],
        "normal_force": WHOLE_EDGE * force + lagging,
        "friction_force": friction,
        "spring_force": friction if theory.scene.drive.rigid else follows,
        "leading_edge": edge,
        "trailing_edge": edge + np.nan_to_num(R * both / slant),
        "peak_pressure": slope * (edge + dx) + K * both,
    }


def _response(
    theory: Theory, curves: Curves, time: Array, force: Array, a: Array, fine: Resolution
) -> tuple[Array, Array]:
    """Return the errors of the depth and of its rate due to b; in flight the rate keeps its error.

    The rate answers C L d' + (K A + k_s) d = b at once, and by b h/M in a step; the depth follows with the
    time constant C L/(K A + k_s) of the current contact.
    """
    foundation, static = theory.scene.foundation, theory.static
    length = _contact_length(curves)
    l_r = np.abs(curves["sliding_velocity"]) * foundation.retardation_time
    stiffness = theory.stiffness(curves["depth"], a, l_r)
    damping = foundation.slow_damping * theory.width(curves["depth"]) * np.maximum(length, a)
    still = force / stiffness
    larger = np.maximum(still, np.append(still[0], still[:-1]))
    ages = np.maximum(np.diff(time, prepend=0.0), 0.0)
    left = np.exp(-ages * stiffness / damping)
    at_rest = foundation.stiffness * fine.spacing**2 * static.half_length / theory.radius
    at_rest *= float(theory.width(static.depth)) / float(stiffness[0])
    depth, rate = [at_rest + INITIAL * static.depth], [0.0]
    swing = OVERSHOOT if theory.rates and theory.rates.oscillation else 1.0
    kick = force * (1.0 / damping + fine.time_step / theory.scene.support.mass)
    rows = zip(larger, left, ages, kick, stiffness / damping, length == 0.0, strict=True)
    for most, share, age, step, decay, flies in rows:
        if flies:
            depth.append(depth[-1] + rate[-1] * age / swing)
            rate.append(rate[-1])
        else:
            depth.append(most + share * (depth[-1] - most))
            rate.append(step + swing * depth[-1] * decay)
    return swing * np.array(depth[1:]), np.array(rate[1:])


def _spring_response(
    theory: Theory, now: Curves, time: Array, force: Array, step: float, rtol: float
) -> Curves:
    """Return the error of each curve on a spring due to b (N/m), and to the step (s) of a first-order scheme.

    Motion along x decays slowly, or grows to a cycle whose phase shifts more and more (F22): theory of a
    disturbed scene covers that. Besides, the friction b a/R acts on the spring at once.
    """
    swing = theory.swing
    beside = QUARTER * (swing if swing < math.inf else theory.scene.foundation.retardation_time)
    first = np.searchsorted(time, time - beside, side="left")
    after = np.searchsorted(time, time + beside, side="right")
    ends = np.stack([first, after], axis=1).reshape(-1)
    moved = {name: np.zeros_like(time) for name in CURVES}
    lasting = float(np.trapezoid(force, time)) / float(time[-1] - time[0]) / theory.static.load
    for other in _disturbed(theory.scene, lasting, step):
        found = Theory(other, theory.methods).at(time, rtol)
        for name in CURVES:  # the largest difference within a quarter of a period
            off = np.append(np.nan_to_num(np.abs(found[name] - now[name])), 0.0)
            moved[name] += np.maximum.reduceat(off, ends)[::2]
    kick = OVERSHOOT * force * theory.static.half_length / theory.radius
    acted = np.clip(time, 0.0, swing)  # a mass needs time to move
    moved["spring_force"] += kick * (acted / swing) ** 2
    moved["sliding_velocity"] += kick * acted / theory.scene.drive_mass
    return moved


def _disturbed(scene: Scene, share: float, step: float) -> Iterator[Scene]:
    """Yield the scene with a larger load or stiffness; and with c_x = h k_x, as a first-order step acts."""
    support = scene.support
    if isinstance(support, Fixed):
        yield replace(scene, foundation=scene.foundation.plain(1.0 + share))
    else:
        yield replace(scene, support=replace(support, load=(1.0 + share) * support.weight))
    if step > 0.0:
        damping = scene.drive.damping + step * float(scene.drive.stiffness or 0.0)
        yield replace(scene, drive=scene.drive.changed(damping=damping))
