r"""What wrong rules of contact would do to a scene: elements in scaled form, with the rule as a choice.

The model serves the diagnosis alone: a rule's effect is its difference to the right rule in this model,
added to theory, so that the coarseness of the model cancels. Compression u, g = d - xi^2,
p = d + d' - xi^2 - 2 lambda xi; the depth rate is implicit, the contact that of the predicted depth.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

ELEMENTS = 500
"""In the static half length, about as in Table 1: the effect of a rule is then larger than that of one."""
ELEMENTS_PER_STEP = 2.0
"""The foundation moves by so many in a step, as in the paper's scheme."""
FEWEST_STEPS, MOST_STEPS = 800, 4000
"""Fewer do not resolve the fast transient; more would take long, and the rest is steady."""
REACH = 1.3
"""Half width of the row in static half lengths: the indenter hardly sinks below its static depth."""
TIE = 1e-9
"""Relative: an element in contact is on the surface, up to rounding."""
FIRST_STAGE = 1.0 / 6.0
"""Weight of the first stage of RK4, for which alone the surface of the last step is the present one."""


class Element(NamedTuple):
    """What a rule may look at, for each element near the indenter."""

    g: Array
    p: Array
    u: Array
    decay: float
    flag: Flags


def _right(e: Element) -> Flags:
    return np.asarray((e.g >= e.u * e.decay * (1.0 - TIE)) & (e.p >= 0.0) & (e.g > 0.0))


def _pulled(e: Element) -> Flags:
    return np.asarray(e.g > 0.0)


def _receding(e: Element) -> Flags:
    return np.asarray((e.g >= e.u) & (e.p >= 0.0) & (e.g > 0.0))


def _stale(e: Element) -> Array:
    return np.where(_receding(e), 1.0, FIRST_STAGE * _right(e))


def _flagged(e: Element) -> Flags:
    return np.asarray(np.where(e.flag, e.p >= 0.0, e.g >= e.u) & (e.g > 0.0))


@dataclass(frozen=True)
class Rule:
    """How much each element presses while a step is taken, which are reported, whether the others relax."""

    press: Callable[[Element], Array | Flags]
    report: Callable[[Element], Flags]
    relax: bool = True


RULES = {
    "right": Rule(_right, _right),
    "tension": Rule(_pulled, _pulled),
    "stale": Rule(_stale, _right),
    "unrelaxed": Rule(_receding, _receding, relax=False),
    "frozen": Rule(_flagged, _flagged, relax=False),
}
"""The right rule (Eqs. 20-25), and mistakes."""

Series = tuple[Array, dict[str, Array]]


def run(
    rule: Rule, drive: Callable[[Array], Array], epsilon: float | None, kappa: float, end: float
) -> Series:
    """Return scaled times, and by name depth, rate, forces and edges, under a rule of contact.

    `drive` is lambda(s) just after a jump; `epsilon` is None if the indenter is fixed.
    """
    top = float(np.abs(drive(np.linspace(0.0, end, FEWEST_STEPS))).max())
    dx = 1.0 / ELEMENTS
    count = int(min(max(FEWEST_STEPS, math.ceil(end * top / (ELEMENTS_PER_STEP * dx))), MOST_STEPS))
    h = min(end / count, ELEMENTS_PER_STEP * dx / max(top, 1e-300))
    s = np.asarray(np.arange(count + 1) * h, dtype=np.float64)
    number = drive(s)
    Y = np.concatenate([[0.0], np.cumsum(0.5 * h * (number[1:] + number[:-1]))])
    X = (
        np.arange(math.floor((-REACH - Y.max()) / dx), math.ceil((REACH - Y.min()) / dx)) * dx
        + 0.5 * dx
    )
    u, flag = np.maximum(1.0 - X * X, 0.0), np.abs(X) < 1.0
    d, v, decay, rows = 1.0, 0.0, math.exp(-h), []
    for k in range(count + 1):
        part = slice(*np.searchsorted(X, (-REACH - Y[k], REACH - Y[k])))
        xi = X[part] + Y[k]
        if k:
            predicted = d + h * v
            e = _element(xi, predicted, v, number[k], u[part], decay, flag[part])
            d, v = _step(rule.press(e), xi, number[k], d, v, (epsilon, kappa, h, dx))
        e = _element(xi, d, v, number[k], u[part], decay if k else 1.0, flag[part])
        on = rule.report(e)
        rows.append((d, v, *_forces(on, e.p, xi, dx)))
        flag[part] = on
        if rule.relax:
            u *= decay if k else 1.0
        u[part] = (
            np.where(on, e.g, u[part]) if rule is RULES["frozen"] else np.maximum(e.g, u[part])
        )
    names = ("depth", "depth_rate", "normal_force", "friction_force", "left", "right")
    return s, dict(zip(names, np.array(rows).T, strict=True))


def _element(
    xi: Array, d: float, v: float, number: float, u: Array, decay: float, flag: Flags
) -> Element:
    g = d - xi * xi
    return Element(g, g + v - 2.0 * number * xi, u, decay, flag)


def _step(
    on: Array | Flags,
    xi: Array,
    number: float,
    d: float,
    v: float,
    how: tuple[float | None, float, float, float],
) -> tuple[float, float]:
    """Return d and v after eps v' = 1 - f_z - kappa (d - 1), f_z linear in the new v."""
    epsilon, kappa, h, dx = how
    if epsilon is None:
        return d, 0.0
    each = 0.75 * dx * on
    width = float(each.sum())
    rest = width * d - float(each @ (xi * (xi + 2.0 * number)))
    v = (epsilon * v / h + 1.0 - kappa * (d - 1.0) - rest) / (
        epsilon / h + kappa * h + width * (1.0 + h)
    )
    return d + h * v, v


def _forces(on: Flags, p: Array, xi: Array, dx: float) -> tuple[float, float, float, float]:
    """Return f_z, f_x and both edges; in flight no force and no edges."""
    if not on.any():
        return 0.0, 0.0, math.nan, math.nan
    x, q = xi[on], p[on]
    return 0.75 * dx * float(q.sum()), -1.5 * dx * float(x @ q), float(x[0]), float(x[-1])
