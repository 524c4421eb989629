r"""Steady sliding of a ball on any linear viscoelastic foundation: one quadrature over its strips.

A strip at y is a parabola of the half length a with a^2 = a_0^2 - y^2 R/R'. Its load W_2 and friction force
F_2 are explicit in the length c of its contact (theorem F17), and so is a(c): with c as the variable

    W = int W_2(c) dy,    dy = - sqrt(R'/R) a a'(c)/y' dc,    y'^2 = a_0^2 - a(c)^2,

the only root is that of the middle plane (derivation F17-growth). The double-exponential rule resolves
the square root at y' = 0 and the singularity at c = 0. Where c is close to that of the middle plane, a_0 - a
follows from the derivatives of a. The load grows with the depth as

    dW/da_0 = a_0 int (c^2 P/(R a)) dy,

which gives Newton's method for the length that carries a load.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import viscoelastic
from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import ball_stiffness
from kvtheory.theory.laws import Law
from kvtheory.theory.powers import converge

Array = NDArray[np.float64]

STEP, LAST = 0.0625, 3.9
"""Step of the double-exponential rule, and where its weights vanish."""
T = STEP * np.arange(-int(LAST / STEP), int(LAST / STEP) + 1)
FALL = np.exp(-np.pi * np.sinh(T))
NODES = 1.0 / (1.0 + FALL)
GAPS = FALL * NODES
"""Distances of the nodes from 1."""
WEIGHTS = STEP * np.pi * np.cosh(T) * NODES * GAPS
CLOSE = 1e-6
"""Relative distance from the middle plane's c below which a_0 - a is taken from its derivatives."""
MOST_STEPS, LAST_STEP = 60, 1e-8
"""Most iterations, of which six are needed; a step whose square, the error left, is below rounding."""
PART = 256
"""Scenes evaluated together, so that their nodes stay in the cache."""

RELATIVE_ERROR = 1e-11
OWN_ERRORS = viscoelastic.OWN_ERRORS
CERTIFICATE = Certificate(
    kind="estimated",
    statement="one quadrature over strips, whose moments do not cancel; more than ten times the worst "
    "difference to strips by Gauss's rule on random scenes of 1 to 5 arms over ten decades of relaxation "
    "times, and of fractional orders",
    relative_error=dict.fromkeys(STEADY_UNITS, RELATIVE_ERROR),
)


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, and the error of the last one."""
    row = viscoelastic.law(scene)
    c = contact_length(scene, row)
    plane = viscoelastic.state(scene, row, c)
    _, load, _, friction, lost, error = _sums(scene, row, c, friction=True)
    moving = friction > 0.0
    inside = np.where(moving, lost / np.where(moving, friction, 1.0), 1.0)
    error = np.where(moving, error, 0.0) + RELATIVE_ERROR
    return *plane[:5], load, friction, friction / load, plane[8], inside, error


def contact_length(scene: Scene, row: Law) -> Array:
    """Return the length of the contact in the middle plane; at a load by Newton in logarithms, from rest."""
    R, load, spring = scene.indenter.radius, scene.support.weight, scene.support.spring
    if scene.held:
        half = np.broadcast_to(np.sqrt(2.0 * R * scene.support.depth), scene.shape)
        return viscoelastic.length_at_half(row, half)
    static = np.sqrt(load / ball_stiffness(scene.foundation.stiffness, R, scene.indenter.stretch))
    target = load + spring * static
    first = np.broadcast_to(2.0 * np.sqrt(2.0 * R * static), scene.shape)

    def step(c: Array) -> Array:
        a, carried, growth = _sums(scene, row, c)
        held = spring * a * (a / (2.0 * R))
        total = carried + held
        share, slope, _ = viscoelastic.growth(row.moments(c))
        rise = (growth * carried + 2.0 * (slope / share) * held) / total
        return np.log(total / target) / rise

    return converge(step, first, LAST_STEP, MOST_STEPS)


def _sums(scene: Scene, row: Law, c: Array, *, friction: bool = False) -> Array:
    """Return the half length at rest, the load over the strips and d ln W/d ln c.

    With `friction` also that, and the energy dissipated in the contact per distance, with its error.
    """
    parts = []
    for i in range(0, c.size, PART):
        part = slice(i, i + PART), None
        parts.append(_part(scene.rows(part), row.at(*part), c[part], friction))
    return np.concatenate(parts, axis=1)


def _part(scene: Scene, row: Law, middle: Array, with_friction: bool) -> tuple[Array, ...]:
    R = scene.indenter.radius
    share, slope, bend = viscoelastic.growth(row.moments(middle))
    a_0, c = middle * share, middle * NODES
    M = row.moments(c)
    ratio, rise, _ = viscoelastic.growth(M)
    a, eta = c * ratio, M.eta
    gap = np.where(GAPS < CLOSE, middle * GAPS * (slope - 0.5 * bend * GAPS), a_0 - a)
    y = np.sqrt(gap * (a_0 + a))
    dy = 2.0 * scene.indenter.stretch * a * rise * (middle * WEIGHTS) / y
    size = c * (c / R)
    load = (dy * (size * c * (M.D + eta * M.P))).sum(axis=1)
    deeper = (dy * size * M.P / a).sum(axis=1) * a_0[:, 0]  # dW/da_0
    found = a_0[:, 0], load, deeper * (slope * middle)[:, 0] / load
    if not with_friction:
        return found
    work = M.E + eta * eta * M.P
    friction = dy * (size * size * work)
    inside, error = row.dissipated(M, c, np.where(work > 0.0, work, 1.0))
    lost = (friction * inside).sum(axis=1)
    doubt = (friction * inside * error).sum(axis=1) / np.where(lost > 0.0, lost, 1.0)
    return *found, friction.sum(axis=1), lost, doubt
