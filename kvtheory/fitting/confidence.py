"""The values of fitted unknowns that the data allow: the profile of the sum of squares over each of them.

Allowed are values at which the sum of squares, minimized over the other unknowns, is at most as much above
its minimum as linear theory predicts at the standard errors that hold 95 % (Student's t). Each minimum that
is low enough lies in an interval of them; intervals that overlap are one, the others are pieces apart. Where
another unknown has left the range of the search before, the interval has no end.

Notes say what else should be known about a fit: residuals that are not scatter, too large a contact.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kvtheory.fitting.friction import FINE, STEP, Problem
from kvtheory.fitting.least_squares import Fit, covariance, student, updated
from kvtheory.fitting.records import Data

Array = NDArray[np.float64]
Places = NDArray[np.int_]

NEWTON, LONGEST, CLOSE, RIDGE = 60, 1.0, 0.01, 1e-9
"""Most steps to the limit of an interval, the longest step of ln of an unknown, the relative error of the
rise of the sum of squares there, and the relative change of a diagonal that keeps equations solvable."""
OPEN = 0.05
"""Fall of the sum of squares over this rise, by a step of other unknowns out of the range of the search, from
which on an interval has no end."""


def intervals(problem: Problem, found: Fit) -> list[list[tuple[float, float]]]:
    """Return the pieces of 95 % of ln of each unknown, that of the best fit first; limits may be infinite."""
    errors = np.maximum(np.sqrt(np.diag(found.covariance)), problem.step**2)
    least = float(found.residuals @ found.residuals)
    linear = np.diag(covariance(found.slopes))
    rise = (student(found.freedom) * errors) ** 2 / linear
    sums = np.sum(problem.residuals(found.minima) ** 2, axis=1)
    sums[0] = least
    place, own = np.nonzero(sums[:, None] <= least + rise)
    limits = _limits(problem, found, place, own, least, rise)
    return [_joined(limits[own == i], float(best)) for i, best in enumerate(found.point)]


def others(
    problem: Problem, found: Fit, limits: Sequence[Sequence[tuple[float, float]]]
) -> list[str]:
    """Return a note on each minimum in other pieces than the best fit: its values, and how good it is."""
    specs, notes, seen = problem.scene.replaceable, [], set()
    sums = np.sum(problem.residuals(found.minima) ** 2, axis=1)
    for point, total in zip(found.minima, sums, strict=True):
        place = tuple(
            next((k for k, (low, high) in enumerate(pieces) if low <= y <= high), 0)
            for y, pieces in zip(point.tolist(), limits, strict=True)
        )
        if any(place) and place not in seen:
            seen.add(place)
            values = ", ".join(
                f"{key} = {value:.3g} {specs[key].unit if key in specs else ''}".strip().removesuffix(
                    " 1"
                )
                for key, value in zip(problem.keys, np.exp(point), strict=True)
            )
            worse = f"with a sum of squares {total / sums[0]:.3g} times the least"
            notes.append(f"The data allow another fit, {worse}: {values}.")
    return notes


def _joined(spans: Array, best: float) -> list[tuple[float, float]]:
    """Return intervals of which those that overlap are joined, the one that holds a value first."""
    whole: list[tuple[float, float]] = []
    for low, high in sorted(map(tuple, spans.tolist())):
        if whole and low <= whole[-1][1]:
            whole[-1] = whole[-1][0], max(whole[-1][1], high)
        else:
            whole.append((low, high))
    return sorted(whole, key=lambda span: not span[0] <= best <= span[1])


def _limits(
    problem: Problem, found: Fit, place: Places, own: Places, least: float, rise: Array
) -> Array:
    """Return the limits of unknowns `own` around the minima at `place`, or infinity.

    Venzon and Moolgavkar (1988).
    """
    size, (low, high) = found.point.size, problem.limits
    pairs = place.size
    place, own, side = np.tile(place, 2), np.tile(own, 2), np.repeat([-1.0, 1.0], pairs)
    wanted, limits = least + rise[own], side * np.inf
    points = found.minima[place]
    active = np.full(2 * pairs, True)
    if problem.costly:
        last, (r, J) = points.copy(), problem.sloped(found.minima)
        last_r, last_J = r[place], J[place]
    for _ in range(NEWTON):
        at = np.flatnonzero(active)
        if not at.size:
            break
        i = own[at]
        if problem.costly:
            r = problem.residuals(points[at])
            J = updated(last_J[at], r - last_r[at], points[at] - last[at])
            last[at], last_r[at], last_J[at] = points[at], r, J
        else:
            r, J = problem.sloped(points[at])
        rows = np.arange(at.size)
        H, g = np.einsum("sni,snj->sij", J, J), np.einsum("sni,sn->si", J, r)
        stuck = ((points[at] <= low) & (g > 0.0)) | ((points[at] >= high) & (g < 0.0))
        others = np.stack([g, H[rows, :, i]], axis=-1)
        moves = ~stuck & (np.arange(size) != i[:, None])
        inner = _inner(H, others, moves)  # of the other unknowns, at a given one
        a = H[rows, i, i] - np.einsum("sj,sj->s", others[..., 1], inner[..., 1])
        b = g[rows, i] - np.einsum("sj,sj->s", others[..., 1], inner[..., 0])
        total = np.einsum("sn,sn->s", r, r)
        c = total - np.einsum("sj,sj->s", others[..., 0], inner[..., 0]) - wanted[at]
        a = np.maximum(a, RIDGE * H[rows, i, i] + np.finfo(float).tiny)
        move = (-b + side[at] * np.sqrt(np.maximum(b * b - a * c, 0.0))) / a
        step = -inner[..., 0] - inner[..., 1] * move[:, None]
        step[rows, i] = move
        off = np.maximum(np.abs(total - wanted[at]), np.abs(c + wanted[at] - total))
        closed = off < CLOSE * rise[i]
        # By how much the sum would fall if the unknowns that are stuck went on.
        beyond = _inner(H, g[..., None], np.arange(size) != i[:, None])[..., 0]
        fall = np.einsum("sj,sj->s", g, beyond - inner[..., 0])
        fall *= np.minimum(1.0, LONGEST / np.maximum(np.abs(beyond).max(axis=1), 1e-300))
        ends = closed & (fall <= OPEN * rise[i])
        limits[at[ends]] = points[at, i][ends]
        step *= np.minimum(1.0, LONGEST / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        points[at] = np.clip(points[at] + step, low, high)
        out = (points[at, i] <= low[i]) | (points[at, i] >= high[i])
        active[at[closed | out]] = False
    return limits.reshape(2, pairs).T


def standard_errors(found: Fit, limits: Sequence[Sequence[tuple[float, float]]]) -> Array:
    """Return relative standard errors: linear ones, or the longer side of 95 % over Student's t."""
    linear = np.sqrt(np.diag(found.covariance))
    nearest = np.array([pieces[0] for pieces in limits])
    sides = np.abs(np.expm1(nearest - found.point[:, None])).max(axis=1) / student(found.freedom)
    return np.where(np.isfinite(sides), np.maximum(sides, linear), linear)


def _inner(H: Array, right: Array, moves: Array) -> Array:
    """Return H^-1 times the columns of `right` for the unknowns that move, and zero for the others."""
    own = np.einsum("sii->si", H)
    rest = H * moves[:, :, None] * moves[:, None]
    rest += np.eye(own.shape[1]) * np.where(moves & (own > 0.0), RIDGE * own, 1.0)[:, None]
    return np.asarray(np.linalg.solve(rest, right * moves[..., None]), dtype=np.float64)


ALIKE, RARE = 0.5, 2.6
"""Least correlation of neighbouring residuals that are not scatter, as such and over its standard error."""
VISIBLE = {True: STEP[FINE] ** 2, False: 1e-4}
"""Least scatter of residuals over time, and over velocity, whose order counts: rounding is below it."""
PARABOLAS = "parabola", "sphere"
"""Shapes that stand for a cylinder and a ball near the lowest point."""
LARGE = 1.0 / 3.0
"""Half length or depth over the radius from which no ball or cylinder is a parabola."""
FAR = 30.0
"""Factor by which a time may be outside of those of the data."""


def alike(problem: Problem, point: Array) -> list[str]:
    """Return a note on each column whose residuals are alike from row to row, over time or velocity."""
    names = [(data, name) for data in problem.data for name in data.measured]
    notes = []
    for (data, name), rows in zip(names, problem.columns(point[None]), strict=True):
        r = rows[0][_order(data)]
        r = r - r.mean() if r.size else r
        correlation = float(r[1:] @ r[:-1] / max(float(r @ r), np.finfo(float).tiny))
        least = max(ALIKE, RARE / max(r.size, 1) ** 0.5)
        over_time = data.time is not None
        if correlation > least and float(np.std(r)) > VISIBLE[over_time]:
            over = "time" if over_time else "velocity"
            message = f"The residuals of {name} over {over} are alike from row to row"
            off = "the model is off, and the standard errors are too small"
            notes.append(f"{message} (correlation {correlation:.2f}): {off}.")
    return notes


def _order(data: Data) -> NDArray[np.int_]:
    """Return the rows in the order of time, or of the speed where there is one."""
    if data.time is not None:
        return np.arange(data.size)
    V = np.abs(data.conditions["drive.velocity"])
    return np.argsort(V, kind="stable")[np.count_nonzero(V == 0.0) :]


def large(problem: Problem, point: Array) -> list[str]:
    """Return a note if the contact of the fitted scene is not small against the radius."""
    own = dict(zip(problem.keys, np.exp(point).tolist(), strict=True))
    if problem.scene.indenter.shape not in PARABOLAS:
        return []
    long = deep = 0.0
    for data in problem.data:
        V = {} if data.time is None else {"drive.velocity": 0.0}
        scene = problem.of({**data.conditions, **V, **own})
        state, R = problem.solve(scene), scene.values()["indenter.radius"]
        long = max(long, float(np.max(state.half_length / R)))
        deep = max(deep, float(np.max(state.depth / R)))
    if max(long, deep) <= LARGE:
        return []
    message = f"The fitted contact is up to {long:.3g} radii long on each side of the lowest point"
    message += f" and {deep:.3g} radii deep"
    return [f"{message}, where no ball or cylinder is a parabola: check radius, load and friction."]


def unseen(problem: Problem, point: Array) -> list[str]:
    """Return a note on fitted times that are far from those in which the data pass the contact."""
    low, high = np.log([1.0 / FAR, FAR]) + np.sort(np.log(problem.passage))[[0, -1]]
    far = [
        f"{key} = {value:.3g} s"
        for key, y, value in zip(problem.keys, point.tolist(), np.exp(point), strict=True)
        if key.endswith("_time") and not low <= y <= high
    ]
    if not far:
        return []
    ends = np.sort(problem.passage)
    which = f"the data pass half a contact in {ends[0]:.3g} to {ends[-1]:.3g} s, and tell little of them"
    return [f"{', '.join(far)}: {which}."]
