"""Explicit schemes: Runge-Kutta methods on F_z = dx Σ (K g + C g'), with the paper's rules of contact.

An element in contact detaches where its pressure would be negative, relaxes as e^(-t/τ), and is in
contact again where the indenter meets it (Eqs. 20-25). The schemes are stable up to dt C L/M = 2.785
(the paper's) or 2 (Euler), L the length of the contact. Arms are loaded along a straight line from the start
of the step to each stage, which leaves the order two; the limit is then where the matrix of a step
(`stability.amplification`) begins to grow.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array
from kvtheory.models.elements.row import ElementRow, IndenterState, Under
from kvtheory.models.elements.strips import total

Tableau = tuple[tuple[float, ...], ...]
"""(c, a_1, a_2, …) for each stage, and then the weights."""


def explicit_step(row: ElementRow, now: IndenterState, h: float, tableau: Tableau) -> IndenterState:
    """Take a step of Runge-Kutta; which elements are in contact is settled at its end."""
    *stages, weights = tableau
    M, M_x = row.model.mass, row.model.mass_along
    states, pulls, drags = list[IndenterState](), list[float](), list[float]()

    def moved_on(c: float, a: Sequence[float]) -> IndenterState:
        rate, pull = _dot(a, [at.rate for at in states]), _dot(a, pulls)
        at = IndenterState(now.time + c * h, now.depth + h * rate, now.rate + h * pull / M)
        if not row.model.sprung:
            return at
        rate, drag = _dot(a, [at.along_rate for at in states]), _dot(a, drags)
        return at._replace(along=now.along + h * rate, along_rate=now.along_rate + h * drag / M_x)

    for c, *a in stages:
        at, pull, drag = moved_on(c, a), 0.0, 0.0
        if math.isfinite(min(M, M_x)):
            pull, drag = _meet(row, at, now, before=c == 1.0, within=c > 0.0)[:2]
        states.append(at)
        pulls.append(pull)
        drags.append(drag)
    new = moved_on(1.0, weights)
    pull, _, under, moved, pressed = _meet(row, new, now, before=True)
    row.settle(under, np.where(pressed, moved, under.left), pressed, h)
    if math.isinf(M):
        return new
    imbalance = abs(_dot(weights, pulls) - 0.5 * (pulls[0] + pull))
    force = row.model.weight + max(abs(pull), abs(pulls[0]))
    return new._replace(imbalance=imbalance, force=force)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _meet(
    row: ElementRow, at: IndenterState, now: IndenterState, *, before: bool, within: bool = False
) -> tuple[float, float, Under, Array, NDArray[np.bool_]]:
    """Return M δ'' and M_x x'', the elements, their state if pressed, and which of them are.

    Eqs. 17, 20-25.
    """
    model, delay = row.model, at.time - now.time
    still = within and model.rule.still
    under = row.under(now, now if still else at, delay, max(at.depth, now.depth))
    g = at.depth - under.height
    moved = row.pressed(under, now.depth, g)
    V = row.path.velocity(at.time, before=before) - at.along_rate
    slope = under.slope(model)
    g_rate = at.rate - V * slope
    p = model.law.pressure(moved, g, g_rate)
    surfaces = under.state[0], under.left[0]
    pressed = model.rule.pressed(g, p, surfaces, under.touched, within=within)
    weights = np.repeat(model.weights(at.depth, under.strips), under.along.size)
    each = model.spacing * weights[pressed] * p[pressed]
    pull = model.weight - model.spring * (at.depth - model.depth) - float(each.sum())
    drag = 0.0
    if model.sprung:
        held = model.spring_along * at.along + model.damping_along * at.along_rate
        drag = -total(slope[pressed], each) - held
    return pull, drag, under, moved, pressed
