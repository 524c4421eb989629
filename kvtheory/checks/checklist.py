"""The checks: each compares one number with what theory allows, or raises `NotMade` with the reason."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks import comparison_case as case_of
from kvtheory.checks.allowances import ELEMENTS_AT_AN_EDGE, beside_jumps
from kvtheory.checks.comparison_case import COARSE, SMALLEST, Case, NotMade, rms
from kvtheory.checks.noise import SURE, extreme, means, noise
from kvtheory.checks.theory import Array, Curves
from kvtheory.results.comparison import Check
from kvtheory.scene.model import Support

EQUATIONS = {"depth": "Eq. 17", "depth_rate": "Eq. 17", "normal_force": "Eq. 14",
             "friction_force": "Eq. 15", "leading_edge": "Eq. 32", "trailing_edge": "Eq. 33",
             "peak_pressure": "Eq. 12", "velocity": "the drive of the scene", "sliding_velocity": "F22",
             "spring_force": "F22"}  # fmt: skip
"""The equation behind each curve."""
RELATIVE = "relative to the static state"
TRANSIENT = 3.0
"""Length of a transient after a change of the drive, in slow time constants."""
SAMPLING = "sampling"
"""The check whose failure alone is no evidence against the data."""
SHORTEST_WINDOW, LONGEST_WINDOWS, OVERLAP = 16, 6, 2
"""Fewest samples in a window of the impulse balance, to resolve phi''; number of lengths, from the whole
series down by halves; and number of windows of each length that cover a sample."""
AVERAGED, FEWEST_MEANS = (1, 4, 16), 12
"""Rows in a mean, and fewest means that are compared together."""
SETTLED = 7.0
"""Slow time constants from the last change of the drive to steady sliding: e^-7 is below a thousandth."""
FEWEST_LATE = 3
"""Fewest samples of steady sliding for a mean."""
ALONG, ARM_OF_BALL = ("friction_force", "spring_force"), 8.0 / (3.0 * math.pi)
"""The forces along x; and the mean of a(y)^2 over that of a(y), in units of a."""
PHASE = "phase of the cycle"
"""The check whose failure alone is no evidence against the data: theory cannot predict the phase."""
LOST = 0.25
"""Allowance, relative to the sliding velocity, from which the phase is lost."""

Measured = tuple[float, float, str]
"""What a check measures, what is allowed (with the tolerance), and a note."""


class Row(NamedTuple):
    """A check; `columns` are those that the data must hold for it."""

    name: str
    equation: str
    unit: str
    measure: Callable[[Case], Measured]
    columns: tuple[str, ...] = ()


class Mean(NamedTuple):
    """The mean of a weighted sum of curves over some rows: what theory gives, and is allowed, both in SI."""

    weights: Mapping[str, float]  # by curve, that of the first is 1
    rows: NDArray[np.bool_]
    expected: float
    allowed: float
    words: str = ""  # with the mean as {0}, what theory gives as {1}

    def off(self, columns: Curves) -> float:
        """Return how far the mean is from theory."""
        found = (by * columns[name][self.rows].mean() for name, by in self.weights.items())
        return float(sum(found)) - self.expected


def worst_mean(case: Case, means_of: Callable[[Case], Sequence[Mean]]) -> Measured:
    """Compare the mean that is worst relative to its allowance."""
    worst = max(means_of(case), key=lambda each: abs(each.off(case.columns)) / each.allowed)
    name, off = next(iter(worst.weights)), worst.off(case.columns)
    note = f"{name} {worst.words.format(worst.expected + off, worst.expected)} in SI"
    scale = case.theory.scales[name]
    return abs(off) / scale, worst.allowed / scale, note if worst.words else ""


def initial_rest(case: Case) -> list[Mean]:
    """Return the depth at t <= 0, which is the static or given depth (Eq. 40)."""
    time = case.time
    if not case.theory.scene.start.at_rest:
        raise NotMade("the motion does not start at rest")
    before = time <= 0.0
    if not before.any():
        raise NotMade(f"the data begin at {time[0] * 1e3:.4g} ms, after the start")
    random = SURE * float(case.bands["depth"].noise[before].max()) / np.sqrt(before.sum())
    allowed = case.tolerance * random + case.allowed("depth")[before].max()
    return [Mean({"depth": 1.0}, before, case.theory.begun.depth, float(allowed))]


def jump(case: Case) -> Measured:
    """Compare the force right after the start with the jump that theory gives."""
    time, theory = case.time, case.theory
    force = next((n for n in ("normal_force", "friction_force") if n in case.names), None)
    if 0.0 not in theory.jumps:
        raise NotMade("the drive does not jump at t = 0")
    if force is None:
        raise NotMade("the data hold no force")
    fast = np.inf if theory.rates is None else abs(theory.rates.fast)
    first, after = (int(np.searchsorted(time, 0.0, side=side)) for side in ("left", "right"))
    if after == time.size or time[after] > fast:
        raise NotMade(f"no sample in the fast time constant, {fast * 1e3:.3g} ms, after the start")
    excess, limit = case.excess(force), case.limit(force)
    k = max((first, after), key=lambda row: excess[row] / limit[row])
    return excess[k], limit[k], f"{force} at {time[k] * 1e3:.4g} ms"


def sampling(case: Case) -> Measured:
    """Compare the mean sampling interval during the transient with the slow time constant."""
    rates, time, changed = case.theory.rates, case.time, case.theory.last_change
    if rates is None:
        raise NotMade("a fixed indenter has no transient of its own")
    slow, start = abs(rates.slow), changed if changed < time[-1] else 0.0
    window = min(TRANSIENT * slow, time[-1] - start)
    inside = int(np.count_nonzero((time > start) & (time <= start + window)))
    note = f"{inside} samples within {TRANSIENT:g} slow time constants"
    return window / max(inside, 1), case.tolerance * slow, note


class Window(NamedTuple):
    """The samples of a window, weights of force and inertia, and int phi dt."""

    rows: slice
    force: Array
    inertia: Array
    impulse: float

    def missing_force(self, columns: Curves, support: Support, depth_0: float) -> float:
        """Return the mean force in N/m that is missing from the balance."""
        depth = columns["depth"][self.rows] - depth_0
        force = support.weight - columns["normal_force"][self.rows] - support.spring * depth
        return float(support.mass * (self.inertia @ depth) - self.force @ force) / self.impulse


def windows(time: Array) -> Iterator[Window]:
    """Yield windows of falling lengths with phi = (1 - s^2)^3, s from -1 to 1, exact for a uniform motion."""
    for length in (time.size >> halving for halving in range(LONGEST_WINDOWS)):
        if length < SHORTEST_WINDOW:
            return
        for start in range(0, time.size - length + 1, max(length // OVERLAP, 1)):
            rows = slice(start, start + length)
            t = time[rows]
            half = 0.5 * (t[-1] - t[0])
            if half <= 0.0:
                continue
            s = (t - t[0]) / half - 1.0
            rest = 1.0 - s * s
            weight = np.gradient(t)  # of the trapezoidal rule: phi is zero at both ends
            bend = weight * 6.0 * rest * (5.0 * s * s - 1.0) / half**2
            line = np.stack([np.ones_like(s), s])
            bend -= weight * (np.linalg.solve((line * weight) @ line.T, line @ bend) @ line)
            force = weight * rest**3
            yield Window(rows, force, bend, float(force.sum()))


def balances(case: Case) -> Iterator[tuple[Window, float]]:
    """Yield windows of M z'' = F_z - W, and the mean force in N/m that may be missing in each.

    For a test function phi that vanishes at both ends of a window with its derivative, partial integration
    of M z'' = F_z - W - k_s (z - z_0), with z = -delta, gives

        int phi'' M delta dt = int phi (W - F_z - k_s (delta - delta_0)) dt.

    The difference of both sides, over int phi dt, is the mean force that is missing in the data.
    """
    depth, force = case.bands["depth"], case.bands["normal_force"]
    support, depth_0 = case.theory.scene.support, case.theory.static.depth
    smooth = np.nan_to_num(force.systematic) + 0.5 * np.nan_to_num(force.high - force.low)
    for window in windows(case.time):
        rows = window.rows
        moved = support.mass * window.inertia + support.spring * window.force  # by the depth
        steady = np.abs(window.force) @ smooth[rows] + np.abs(moved) @ depth.rounding[rows]
        parts = depth.noise[rows] * moved, force.noise[rows] * window.force
        random = extreme(case.time.size) * math.hypot(*map(np.linalg.norm, parts))
        sampled = abs(window.missing_force(case.now, support, depth_0))
        yield window, case.tolerance * (2.0 * sampled + (float(steady) + random) / window.impulse)


def balance(case: Case) -> Measured:
    """Compare M z'' with F_z - W in the data alone, over windows, without differentiating them."""
    support, static = case.theory.scene.support, case.theory.static
    if case.theory.scene.held:
        raise NotMade("the indenter is fixed")
    found = [
        (abs(window.missing_force(case.columns, support, static.depth)), limit, window.rows)
        for window, limit in balances(case)
    ]
    if not found:
        raise NotMade("too few samples for a window")
    lacks, limit, rows = max(found, key=lambda each: each[0] / each[1])
    first, last = case.time[rows][[0, -1]] * 1e3
    note = f"worst from {first:.4g} to {last:.4g} ms"
    return lacks / static.load, limit / static.load, note


def lengths(case: Case) -> list[int]:
    """Return how many rows are averaged: in means a smooth difference shows below the noise of each row."""
    return [n for n in AVERAGED if n == 1 or n * FEWEST_MEANS <= case.time.size]


def largest(case: Case, name: str) -> Measured:
    """Compare the value of a curve, or mean of neighbours, that is worst relative to its allowance."""

    def worst(rows: int) -> Measured:
        excess, limit = case.excess(name, rows), case.limit(name, rows)
        ratio, time = excess / limit, means(case.time, rows) * 1e3
        k, wrong = int(np.argmax(ratio)), np.flatnonzero(ratio > 1.0)
        first = f", first disagreement at {time[wrong[0]]:.4g} ms" if wrong.size else ""
        return excess[k], limit[k], f"worst at {time[k]:.4g} ms{first}"

    return max(map(worst, lengths(case)), key=lambda each: each[0] / each[1])


def root_mean_square(case: Case, name: str) -> Measured:
    """Compare all values or means of a curve together: what noise may leave beyond the smooth allowance."""
    found = [
        (case.beyond(name, n)(means(case.columns[name], n)), case.rms_limit(name, n))
        for n in lengths(case)
    ]
    return *max(found, key=lambda each: each[0] / each[1]), ""


def steady_limit(case: Case) -> list[Mean]:
    """Return the means over the part in which sliding is steady, and what theory gives there.

    Friction is that less F_z a/R, free of the leading edge, if less is allowed for it. Theory by elements is
    as wrong as it is far from exact steady sliding.
    """
    theory, time = case.theory, case.time
    if math.isinf(theory.last_change):
        raise NotMade("the drive is a function, which need not settle")
    if theory.scene.drive.coasts:
        raise NotMade("the indenter coasts")
    if theory.scene.depths and theory.scene.depths[-1][1] <= 0.0:
        raise NotMade("the indenter is withdrawn")
    steady, speed = theory.steady_state, abs(theory.final_velocity)
    if theory.rates is not None:
        slow = theory.rates.settling
    else:
        slow = theory.scene.foundation.retardation_time if theory.last_change else 0.0
    if math.isinf(slow):
        raise NotMade("steady sliding is unstable on this spring (F22)")
    length = abs(float(steady.trailing_edge - steady.leading_edge))
    passing = length / speed if theory.scene.foundation.arms and speed else 0.0
    last = max([theory.last_change, *time[np.isnan(case.now["leading_edge"])]])  # flight
    settled = last + max(SETTLED * slow, passing)
    late = (time > settled) & ~beside_jumps(theory, time, case.resolution.time_step)
    if late.sum() < FEWEST_LATE:
        raise NotMade(f"the data end before {settled * 1e3:.4g} ms, when the transient is over")
    found = []
    exact = {"depth": steady.depth, "normal_force": steady.load,
             "friction_force": steady.friction_force, "spring_force": steady.friction_force}  # fmt: skip
    since = f"mean after {case.time[late][0] * 1e3:.4g} ms: {{:.6g}}, theory {{:.6g}}"
    for curve in (name for name in exact if name in case.columns):
        ways = [({curve: 1.0}, case.bands[curve].systematic, since)]
        if curve in ALONG and speed and "normal_force" in case.columns:
            part = "" if theory.scene.indenter.per_width else f"{ARM_OF_BALL:.2g} "
            ways.append((*_without_the_edge(case, curve), f"less {part}F_z a/R, {since}"))
        means = []
        for weights, smooth, words in ways:
            data, theirs = (
                np.sum([by * curves[name] for name, by in weights.items()], axis=0)
                for curves in (case.columns, case.now)
            )
            expected = float(theirs[late].mean())
            own = abs(expected - sum(by * float(exact[name]) for name, by in weights.items()))
            sigma = rms(noise(time, data - theirs, case.now[curve])[late])
            allowed = float(smooth[late].mean()) + SURE * sigma / math.sqrt(late.sum())
            allowed += own * theory.by_elements + SMALLEST * theory.scales[curve]
            means.append(Mean(weights, late, expected, case.tolerance * allowed, words))
        found.append(min(means, key=lambda mean: mean.allowed))
    return found


def _without_the_edge(case: Case, curve: str) -> tuple[dict[str, float], Array]:
    """Return the weights of F_x - F_z a/R, and its smooth error.

    Elements that lack the force b at the leading edge lack the friction b a/R too. A free indenter then sinks
    by b/(K_z + k_s), where F_z grows by K_z and F_x by K_x, the slopes of steady sliding. Where data are in
    step with elements, so is delta', by half of what b changes in a step, with a mean slope of a/2R. At the
    other edge p = 0, and elements change p' x dx, with p' = (K x_TE + C V)/R. The strips of a ball reach
    as far as a(y), and so does the pressure at their edges: b acts at `ARM_OF_BALL` of a in the mean. Those
    that are within sqrt(2 dx/a) of the middle, as y/b, enter at once.
    """
    theory, scene, fine = case.theory, case.theory.scene, case.resolution
    state, R, V = theory.steady_state, theory.radius, abs(theory.final_velocity)
    normal, a = case.bands["normal_force"], float(state.half_length)
    edges = float(state.leading_edge), float(state.trailing_edge)
    L, width = abs(edges[1] - edges[0]), float(theory.width(state.depth))
    arm = a * (1.0 if scene.indenter.per_width else ARM_OF_BALL)
    off = ELEMENTS_AT_AN_EDGE * fine.spacing
    slope = scene.foundation.stiffness * (L - a) + V * theory.damping(L / max(V, off))
    trailing = 0.5 * width * slope * off * off * L / R
    off += (a - arm) * math.sqrt(2.0 * fine.spacing / a) * 2.0 / math.pi
    if not scene.held:
        (K_z, K_x), k_s = theory.slopes, scene.support.spring
        off += abs(arm - (R * K_x + arm * k_s) / (K_z + k_s))
        damping = theory.damping(fine.time_step) * width * L
        off += 0.25 * a * min(fine.time_step * damping / scene.support.mass, 1.0)
    smooth = ((normal.systematic - normal.rounding) * off + trailing) / R
    smooth += case.bands[curve].rounding + arm / R * normal.rounding
    return {curve: 1.0, "normal_force": -math.copysign(arm / R, theory.final_velocity)}, smooth


def column_means(case: Case) -> list[Mean]:
    """Return the mean of each column of a measured curve."""
    every, found = np.ones(case.time.size, dtype=bool), []
    for name in case.names:
        band = case.bands[name]
        random = SURE * rms(band.noise) / math.sqrt(case.time.size)
        allowed = case.tolerance * (rms(band.systematic) + random)
        found.append(Mean({name: 1.0}, every, float(case.now[name].mean()), allowed))
    return found


def means_of(case: Case) -> Iterator[Mean]:
    """Yield every mean that is compared with theory."""
    for means_of in (column_means,) if case.series.curve else (initial_rest, steady_limit):
        with suppress(NotMade):
            yield from (each for each in means_of(case) if each.weights.keys() <= {*case.names})


def phase(case: Case) -> Measured:
    """Compare the allowance for the sliding velocity with that velocity: disturbances shift a cycle."""
    theory, curve = case.theory, "sliding_velocity"
    if theory.rates is not None and math.isfinite(theory.rates.settling):
        raise NotMade("steady sliding is stable")
    may_be = case.tolerance * rms(case.bands[curve].systematic)
    return may_be / rms(case.now[curve]), LOST, ""


def rows_of(case: Case) -> Iterator[Row]:
    """Yield the checks for a case in the order in which they are shown."""
    scene = case.theory.scene
    theorem = "F12" if scene.drive.rigid else "F22"
    yield Row(SAMPLING, theorem, "s, mean sampling interval", sampling)
    rest = "depth, relative to the static depth"
    start = partial(worst_mean, means_of=initial_rest)
    yield Row("initial rest state", "Eq. 40", rest, start, ("depth",))
    yield Row("jump at t = 0+", "F11", f"distance from theory, {RELATIVE}", jump)
    missing = "mean force that is missing, relative to the load"
    yield Row("impulse balance", "Eq. 17", missing, balance, ("depth", "normal_force"))
    for name in case.names:
        title, equation = name.replace("_", " "), EQUATIONS[name]
        yield Row(f"{title}, largest", equation, RELATIVE, partial(largest, name=name))
        yield Row(f"{title}, RMS", equation, RELATIVE, partial(root_mean_square, name=name))
    limit = "F17" if scene.foundation.arms else "F1" if scene.indenter.per_width else "F20"
    yield Row("steady limit", limit, RELATIVE, partial(worst_mean, means_of=steady_limit))
    if not scene.drive.rigid:
        error = "possible error of the sliding velocity by elements and steps, relative to it"
        yield Row(PHASE, "F22", error, phase)
    sigma = "standard deviation, relative to the load"
    yield Row(case_of.NOISE, "F15", sigma, case_of.sawtooth, ("normal_force",))
    yield Row(COARSE, "F15", "half an element's force, relative to the load", case_of.elements)
    yield Row(case_of.NUMBER, "F15", "dt C L/M", case_of.stability)


def judge(case: Case, rows: Iterable[Row] | None = None) -> tuple[Check, ...]:
    """Run checks, by default all of a series."""
    checks = []
    for name, equation, unit, measure, columns in rows or rows_of(case):
        try:
            for column in columns:
                if column not in case.columns:
                    raise NotMade(f"the data hold no {column.replace('_', ' ')}")
            measured, allowed, note = measure(case)
        except NotMade as reason:
            checks.append(Check(name, None, None, None, equation, "", f"not made: {reason}"))
        else:
            ok = bool(measured <= allowed)
            checks.append(Check(name, float(measured), float(allowed), ok, equation, unit, note))
    return tuple(checks)
