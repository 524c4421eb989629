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

Tableau = tuple[tuple[float, ...], ...]
"""(c, a_1, a_2, …) for each stage, and then the weights."""


def explicit_step(row: ElementRow, now: IndenterState, h: float, tableau: Tableau) -> IndenterState:
    """Take a step of Runge-Kutta; which elements are in contact is settled at its end."""
    *stages, weights = tableau
    M, rates, pulls = row.model.mass, list[float](), list[float]()
    for c, *a in stages:
        depth, rate = now.depth + h * _dot(a, rates), now.rate + h * _dot(a, pulls) / M
        at = IndenterState(now.time + c * h, depth, rate)
        rates.append(rate)
        pulls.append(
            _meet(row, at, now, before=c == 1.0, within=c > 0.0)[0] if math.isfinite(M) else 0.0
        )
    depth, rate = now.depth + h * _dot(weights, rates), now.rate + h * _dot(weights, pulls) / M
    new = IndenterState(now.time + h, depth, rate)
    pull, under, moved, pressed = _meet(row, new, now, before=True)
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
) -> tuple[float, Under, Array, NDArray[np.bool_]]:
    """Return M δ'', the elements under the indenter, their state if pressed, and which of them are.

    Eqs. 17, 20-25.
    """
    model, under = row.model, row.under(at.time, at.time - now.time, max(at.depth, now.depth))
    g = at.depth - under.height
    moved = row.pressed(under, now.depth, g)
    g_rate = at.rate - row.path.velocity(at.time, before=before) * model.slope(under.x)
    p = model.law.pressure(moved, g, g_rate)
    surfaces = under.state[0], under.left[0]
    pressed = model.rule.pressed(g, p, surfaces, under.touched, within=within)
    force = model.spacing * float(p[pressed].sum())
    return model.weight - model.spring * (at.depth - model.depth) - force, under, moved, pressed
