"""The smallest errors that a series would have shown, by the allowances that judge it.

An error x of a quantity changes each curve by x times its slope: that of a column is the column itself, that
of a parameter the change of theory over that of the parameter. All that is compared with an allowance is
linear in the curves, except root mean squares.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from scipy.optimize import brentq

from kvtheory.checks.checklist import balances, lengths, means_of
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.faults import FRICTION, parameters_of
from kvtheory.checks.hypotheses import VELOCITY, Bench, bench, scaled_scene
from kvtheory.checks.noise import means
from kvtheory.checks.theory import TRIAL_RTOL, Array, Curves

QUANTITIES = {
    "friction_force": ("friction", ("friction_force", *FRICTION)),
    "load": ("load", ("normal_force",)), "depth": ("depth", ("depth",)),
    "stiffness": ("K", ("K",)), "retardation_time": ("tau", ("tau", "all tau_i", "tau_1")),
    "mass": ("M", ("M",)), "velocity": ("V", ("V",)), "radius": ("R", ("R",)),
}  # fmt: skip
"""Each quantity with its word, and the columns or symbols that stand for it, of which the first counts."""
STEP, SMALLEST_STEP = {False: 0.03, True: 0.2}, {False: 1e-6, True: 0.2}
"""Change of a parameter for slopes, and the smallest one; larger where theory is a simulation by elements."""
FAR, MOST_STEPS = 2.0, 12
"""A slope is taken again, so often at most, where the error that is found is so many times the step, or less
than its part: a force that jumps, as at a landing, is no line."""
MOST, PRECISE = 1.0, 0.01
"""Largest error that is looked for: as much as the quantity itself; and precision of what is found."""

Bounds = tuple[Callable[[Curves], Array], Array, Array, Array]


def detectable(case: Case) -> tuple[dict[str, float | None], str]:
    """Return the smallest relative error of each quantity that data which agree would have shown, and words.

    It is None for a quantity that is not in the data or the scene, or of which no error up to `MOST` shows.
    """
    rows, bounds = bench(case, 2 * case.time.size), _bounds(case)
    powers = {each.symbol: each.powers for each in parameters_of(case.theory.scene)}
    found: dict[str, float | None] = {}
    shown, unseen = [], []
    for name, (word, ways) in QUANTITIES.items():
        x, way = MOST, next((way for way in ways if way in (*case.names, *powers)), None)
        if way in powers:
            x = _of_parameter(case, rows, bounds, powers[way])
        elif way:
            x = _smallest(case, bounds, {way: case.columns[way]})
        found[name] = x if x < MOST else None
        if x < MOST:
            shown.append(f"{float(f'{100.0 * x:.2g}'):g}% in {word}")
        elif way:
            unseen.append(word)
    text = f" These data would have shown an error of {', '.join(shown)}." if shown else ""
    text += f" They would not show one of {MOST:.0%} in {', '.join(unseen)}." if unseen else ""
    return found, text


def _of_parameter(case: Case, rows: Bench, bounds: Bounds, powers: Mapping[str, float]) -> float:
    """Return the smallest error of a parameter that shows, between a step that does not and one that does."""
    step, least = STEP[case.theory.by_elements], SMALLEST_STEP[case.theory.by_elements]
    hidden, shown, x = 0.0, np.inf, np.inf
    for _ in range(MOST_STEPS):
        x = _smallest(case, bounds, _slopes(rows, powers, step))
        if step / FAR <= x <= FAR * step or (x == shown == np.inf):
            return x
        hidden, shown = (step, shown) if x > step else (hidden, step)
        if shown <= FAR * hidden:
            return math.sqrt(hidden * shown)
        last, step = step, min(max(x, least), MOST)
        if not hidden < step < shown:
            step = math.sqrt(max(hidden, least) * min(shown, MOST))
        if step == last:
            return x
    return x


def _slopes(rows: Bench, powers: Mapping[str, float], step: float) -> dict[str, Array]:
    """Return the slope of each curve by a parameter; a velocity in the data would be as wrong as it is."""
    scene, times = rows.theory.scene, None
    if rows.series.curve and VELOCITY in powers:
        times = rows.time * (1.0 + step)
    else:
        scene = scaled_scene(scene, powers, 1.0 + step)
    if (pair := rows.against(scene, times)) is None:
        return {}
    given, found = ("velocity", "sliding_velocity")[: 1 + scene.drive.rigid], {}
    for name in rows.names:
        change = pair[1][name] - rows.now[name]
        seen = (np.abs(change) > TRIAL_RTOL * rows.theory.scales[name]) & (name not in given)
        found[name] = np.where(seen, change, 0.0) / step
    return found


def _bounds(case: Case) -> Bounds:
    """Return what is linear in the curves, as a function of these; its values, and the least and greatest."""
    parts: list[tuple[Callable[[Curves], Any], Any, Any]] = []
    for name in case.names:
        for n in lengths(case):
            band = case.bands[name].averaged(n)
            allowed = case.limit(name, n) * case.theory.scales[name]
            averages = partial(lambda curves, name, n: means(curves[name], n), name=name, n=n)
            parts.append((averages, band.low - allowed, band.high + allowed))
    parts += [(each.off, -each.allowed, each.allowed) for each in means_of(case)]
    support, depth_0 = case.theory.scene.support, case.theory.static.depth
    free = not (case.series.curve or case.theory.scene.held)
    if free and {"depth", "normal_force"} <= {*case.names}:
        for window, limit in balances(case):
            missing = partial(window.missing_force, support=support, depth_0=depth_0)
            parts.append((missing, -limit, limit))

    functions, low, high = zip(*parts, strict=True)

    def joined(values: Iterable[Any]) -> Array:
        return np.concatenate([np.atleast_1d(each) for each in values])

    def values(curves: Curves) -> Array:
        return joined(function(curves) for function in functions)

    return values, values(case.columns), joined(low), joined(high)


def _smallest(case: Case, bounds: Bounds, slopes: Curves) -> float:
    """Return the smallest error with which the data fail, the mean of both signs; infinite if they never do.

    What the data are off already adds to an error of one sign and hides one of the other.
    """
    values, here, low, high = bounds
    slope = values({**case.columns, **{n: case.columns[n] + by for n, by in slopes.items()}}) - here
    found = []
    for sign in (1.0, -1.0):
        with np.errstate(all="ignore"):
            room = np.where(sign * slope > 0.0, high - here, here - low) / np.abs(slope)
        x = max(float(np.nanmin(room[slope != 0.0], initial=np.inf)), 0.0)
        for name, n in product(slopes, lengths(case)):
            left = _beyond(case, name, n, sign * slopes[name])
            if x > 0.0 and left(end := min(x, MOST)) > 0.0:
                x = float(brentq(left, 0.0, end, rtol=PRECISE))
        found.append(x)
    return sum(found) / 2.0


def _beyond(case: Case, name: str, rows: int, slope: Array) -> Callable[[float], float]:
    """Return by which part the root mean square of a curve exceeds its limit, as a function of the error."""
    beyond, limit = case.beyond(name, rows), case.rms_limit(name, rows)
    here, by = means(case.columns[name], rows), means(slope, rows)
    return lambda x: beyond(here + x * by) / limit - 1.0
