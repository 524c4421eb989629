r"""The maxima of friction over velocity, of every scene for which steady sliding is known.

On Kelvin-Voigt a dead weight has one in closed form (theorems F3, F19, F20); a fixed indenter, whose
friction rises to a limit, and a wedge, whose friction coefficient reaches a plateau, have none. Otherwise
mu(V) is evaluated at equal steps of ln V over all time scales of the scene, more finely on shoulders, and
each maximum is refined by a bracketing optimiser. It is accepted only if mu falls by more than its errors on
both sides: a maximum is certain between these two velocities, and they give the error of its velocity.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.models.steady.methods import CLOSED, METHODS, plain
from kvtheory.models.steady.power_law import trailing_edge
from kvtheory.results import Certificate
from kvtheory.scene.capabilities import lacks_kelvin_voigt
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf

Array = NDArray[np.float64]
Friction = Callable[[Array, Array], tuple[Array, Array]]
"""The friction coefficient and its relative error at ln V, of the scenes with some indices."""

FINE = 3.0, 16, 0.0
"""Decades searched beyond the time scales, velocities per decade, and the smallest tolerance of ln V."""
INTEGRATED = 2.0, 6, 1e-4
"""The same where each velocity costs a quadrature of tens of milliseconds."""
IN_STRIPS = 1.0, 3, 1e-2
"""The same where each costs a quadrature over strips of several seconds."""
MOST_DECADES = 200.0
"""Limit of the search: for a springpot of order alpha it extends 1/alpha times as far."""
FLAT = 0.02
"""Change of ln mu from one velocity to the next below which a shoulder is searched more finely. On two arms
a maximum that is still missed is less than 3e-8 above its surroundings, without this 2e-4."""
WIDEST = 2.0
"""Largest error of ln V; a flatter maximum cannot be distinguished from a plateau."""
CLOSED_ERROR = 1e-14
CLOSED_STATEMENT = "closed forms, with one well-conditioned root, proved to be the only one"
STATEMENT = (
    "search at {1} velocities per decade, more finely on shoulders, up to {0:g} decades beyond the time "
    "scales of the scene; at both ends of the error of its velocity, friction is below a maximum by more "
    "than its own errors"
)


def report(scene: Scene, method: str) -> dict[str, Any]:
    """Return the maxima for an `AsymptoteReport`, by a method of steady sliding."""
    base = scene.at(1.0)  # the maxima do not depend on the velocity of the drive
    closed = scene.indenter.shape in CLOSED and not lacks_kelvin_voigt(scene)
    statement = CLOSED_STATEMENT
    if closed and (scene.held or scene.indenter.shape == "wedge"):
        found = np.empty((*base.shape, 0, 4))
    elif closed and np.all(scene.support.spring == 0.0):
        errors = np.full(base.shape, CLOSED_ERROR)
        parts = np.broadcast_arrays(*_peak_of_dead_weight(base), errors, errors)
        found = np.stack(parts, axis=-1)[..., None, :]
    else:
        scan = FINE
        if method != "exact" and (lacks_kelvin_voigt(scene) or not scene.indenter.convex):
            scan = INTEGRATED if scene.indenter.per_width else IN_STRIPS
        found, statement = _search(base, method, *scan), STATEMENT.format(*scan)
    found = np.broadcast_to(found, (*scene.shape, *found.shape[-2:]))
    certificate = Certificate("estimated", statement, _named(found, slice(2, 4)))
    return {**_named(found, slice(2)), "maxima_certificate": certificate}


def _named(found: Array, columns: slice) -> dict[str, Any]:
    """Return columns of the maxima by name, the highest first; NaN if there is none."""
    padded = np.concatenate([found, np.full((*found.shape[:-2], 1, 4), np.nan)], axis=-2)
    heights = np.nan_to_num(padded[..., 1], nan=-1.0)
    heights[..., -1] = 0.0
    best = heights.argmax(axis=-1)[..., None, None]
    peak = np.take_along_axis(padded, best, axis=-2)[..., 0, columns]
    every = np.moveaxis(found[..., columns], -2, 0)
    return {
        "peak_velocity": plain(peak[..., 0]),
        "peak_friction_coefficient": plain(peak[..., 1]),
        "maxima": tuple((plain(each[..., 0]), plain(each[..., 1])) for each in every),
    }


PEAK_BRACKET = 0.5, 4.0
"""The maximum of a dead weight is at l between 1 (n -> 1) and 2 (n -> oo), that of a ball at 1.842345."""


def _peak_of_dead_weight(scene: Scene) -> tuple[Array, Array]:
    """Return velocity and friction coefficient at the one maximum of a dead weight on Kelvin-Voigt."""
    line = scene.indenter.per_width
    slope = np.asarray(scene.indenter.power[2]) if line else np.asarray(2.0)
    n = np.broadcast_to(slope, scene.shape).astype(float)

    def contact(l: Array, n: Array) -> tuple[Array, ...]:
        """Return the sign of dmu/dl, the load over that at rest, and mu a/delta."""
        if line:
            q = trailing_edge(n, l)
            load = cf.power_law_load(n, l, *q) / cf.power_law_static_load(n)
            mu = cf.power_law_friction_coefficient(n, l, *q)
            return cf.power_law_friction_rise(n, l, *q), load, mu
        tail = angle_and_tail(l)[1]
        load = cf.ball_load_factor(l, tail) / (0.5 * np.pi)
        mu = 2.0 * cf.ball_friction_coefficient_factor(l, tail)
        return cf.ball_friction_rise(l, tail), load, mu

    ends = tuple(np.full_like(n, end) for end in PEAK_BRACKET)
    l = elementwise.find_root(lambda l, n: contact(l, n)[0], ends, args=(n,)).x
    _, load, mu = contact(l, n)
    depth, a = asymptotes.at_rest(scene)
    s = load ** (-1.0 / (n + (1.0 if line else 2.0)))
    return l * s * a / scene.foundation.retardation_time, depth / a * s ** (n - 1.0) * mu


def _search(base: Scene, method: str, decades: float, per_decade: int, tolerance: float) -> Array:
    """Return velocity, friction coefficient and their errors: a row for each maximum of each scene."""
    start, end, steps = _ends(base, METHODS[method](base.at(0.0)), decades, per_decade)
    grid = np.linspace(start, end, steps, axis=-1).reshape(-1, steps)
    flat = base.flat()

    def friction(y: Array, index: Array) -> tuple[Array, Array]:
        state = METHODS[method]((flat.rows(index) if base.shape else base).at(np.exp(y)))
        error = state.certificate.relative_error["friction_coefficient"]
        return state.friction_coefficient, np.broadcast_to(error, y.shape)

    mu, error = friction(grid, np.broadcast_to(np.arange(len(grid))[:, None], grid.shape))
    row, place = np.nonzero(peaks(mu, error))
    brackets = [grid[row, place + side] for side in (-1, 0, 1)]
    shoulder, place = np.nonzero(_nearly_flat(mu, error))
    if shoulder.size:
        closer = np.linspace(
            grid[shoulder, place], grid[shoulder, place + 3], 4 * per_decade, axis=-1
        )
        found = peaks(*friction(closer, np.broadcast_to(shoulder[:, None], closer.shape)))
        part, place = np.nonzero(found)
        row = np.concatenate([row, shoulder[part]])
        more = [closer[part, place + side] for side in (-1, 0, 1)]
        brackets = [np.concatenate(pair) for pair in zip(brackets, more, strict=True)]
    found = np.empty((4, 0))
    if row.size:
        found = _refined(friction, brackets, row, max(tolerance, 0.25 * np.sqrt(error.min())))
        order = np.lexsort((found[0], row))
        order = order[~np.isnan(found[0, order])]
        found, row = found[:, order], row[order]
    number = np.arange(row.size) - np.searchsorted(row, row)  # of the maximum in its scene
    table = np.full((len(grid), int(number.max(initial=-1)) + 1, 4), np.nan)
    table[row, number] = found.T
    return table.reshape(*base.shape, *table.shape[1:])


def _ends(base: Scene, rest: Any, decades: float, per_decade: int) -> tuple[Array, Array, int]:
    """Return the ends of the search in ln V and the number of velocities, from the state at rest."""
    foundation = base.foundation
    relaxing = [arm.relaxation_time for arm in foundation.arms] or [foundation.retardation_time]
    slow = np.maximum.reduce(np.broadcast_arrays(*relaxing, foundation.retardation_time))
    fast = np.minimum.reduce(np.broadcast_arrays(*relaxing))
    if foundation.arms and np.any(foundation.damping):  # that resists as much as all springs do
        glassy = foundation.stiffness + sum(arm.stiffness for arm in foundation.arms)
        beside = np.where(foundation.damping > 0.0, foundation.damping / glassy, np.inf)
        fast = np.minimum(fast, beside)
    order = foundation.order
    kappa = 0.0 if base.held else base.support.spring * (rest.depth / rest.load)
    beyond = np.minimum((decades + np.log10(1.0 + kappa)) / order, MOST_DECADES)
    start = np.log10(rest.half_length / slow) - np.minimum(decades / order, MOST_DECADES)
    end = np.log10(rest.half_length / fast) + beyond
    steps = 1 + int(np.ceil(np.max((end - start) * order, initial=0.0) * per_decade))
    return np.log(10.0) * start, np.log(10.0) * end, steps


def peaks(mu: Array, error: Array) -> Array:
    """Return where each row of mu has a maximum that stands out by more than the errors on both sides.

    >>> peaks(np.array([[0.1, 1.0, 0.8, 0.9, 0.1]]), np.full((1, 5), 0.02)).astype(int)
    array([[0, 1, 0, 1, 0]])
    >>> peaks(np.array([[0.1, 1.0, 0.8, 0.9, 0.1]]), np.full((1, 5), 0.1)).astype(int)
    array([[0, 1, 0, 0, 0]])
    >>> bool(peaks(np.array([[1.0, 0.5, 0.1]]), np.zeros((1, 3))).any())  # it falls from the start
    False
    """
    found, row = np.zeros(mu.shape, dtype=bool), np.arange(len(mu))
    rising, last = np.ones(len(mu), dtype=bool), np.zeros(len(mu), dtype=int)
    for place in range(1, mu.shape[1]):
        rise, doubt = mu[:, place] / mu[row, last] - 1.0, error[:, place] + error[row, last]
        up = np.where(rising, rise, -rise)
        turned = up < -doubt
        found[row, last] |= turned & rising
        rising ^= turned
        last = np.where(turned | (up > 0.0), place, last)
    found[:, 0] = False
    return found


def _nearly_flat(mu: Array, error: Array) -> NDArray[np.bool_]:
    """Return where mu has a shoulder, at the second of four points, that may hide a maximum and a minimum."""
    slope = np.diff(np.log(mu), axis=1)
    before, here, after = slope[:, :-2], slope[:, 1:-1], slope[:, 2:]
    least = np.abs(here) <= np.minimum(np.abs(before), np.abs(after))
    doubt = 2.0 * error[:, 1:-2]
    flat = (np.abs(here) < FLAT) & (np.abs(here) > doubt)
    return least & (before * here > 0.0) & (here * after > 0.0) & flat


def _refined(friction: Friction, bracket: Sequence[Array], row: Any, tolerance: float) -> Array:
    """Return the maxima within brackets in columns; NaN where one cannot be distinguished from a plateau."""

    def depth(y: Array, row: Array) -> Array:
        return -friction(y, row)[0]

    tolerances = {"xatol": tolerance, "xrtol": 0.0}
    best = elementwise.find_minimum(depth, tuple(bracket), args=(row,), tolerances=tolerances)
    y = np.where(best.success, best.x, bracket[1])
    top, own = friction(y, row)
    far, low, fallen = np.full_like(y, 4.0 * tolerance), np.zeros_like(y), np.zeros(y.shape, bool)
    while (left := np.flatnonzero(~fallen & (far < WIDEST))).size:
        sides = [friction(y[left] + side * far[left], row[left]) for side in (-1.0, 1.0)]
        low[left] = np.min([mu for mu, _ in sides], axis=0)
        fallen[left] = np.all(
            [mu * (1.0 + e) < (top * (1.0 - own))[left] for mu, e in sides], axis=0
        )
        far[left] *= np.where(fallen[left], 1.0, 2.0)
    return np.where(fallen, [np.exp(y), top, np.expm1(far), own + (1.0 - low / top)], np.nan)
