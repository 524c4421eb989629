"""Reference solutions of the transient, by four methods that share no code with the package.

Scaled form: lengths along x by a_0, depths by delta_0, time by tau, forces by the static load. At
the material point X = xi - Y, with Y' = lambda, the compression is

    u(X, s) = e^-s max(u_0(X), sup over s' <= s of e^s' g(X, s')),   g = d - xi^2,   (F8)

and p = u + u' where u = g. Before s = 0 the indenter rests: d = 1, lambda = 0, u_0 = 1 - X^2.

- `elements` takes (F8) as it stands, on a row of points; it knows nothing of a contact or its edges.
- `transient_history` finds the contact from the whole past, and is far more accurate.
- `two_states` and `taylor` have closed-form edges, for starts from rest that need no memory.

`python -m tests.transient_reference` writes the table of reference values, in some twenty minutes,
with the change from a coarser to a finer solution as the error of each.
"""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from scipy.integrate import solve_ivp

from tests.transient_history import (
    HISTORY,
    QUANTITIES,
    TAYLOR,
    TWO_STATES,
    Array,
    Scene,
    Solution,
    at_times,
    history,
)

TABLE = Path(__file__).parent / "data" / "transient_reference.json"

SPACINGS = 2.5e-4, 1.25e-4, 6.25e-5
"""Of elements and of their time steps."""
ROUNDING = 1e-15
SAFETY = 10.0
"""Edges cross elements at irregular phases, so that one change of refinement can be small by luck."""
REACH, SWING = 2.0, 4.0
"""The elements extend so far beyond the path of the indenter's axis, in half lengths; more on a spring."""
MARGIN = 0.3
"""Outside |xi| = sqrt(d + MARGIN) no element is touched in a step."""
NEWTON_STEPS = 50


def edges_in_closed_form(d: Any, v: Any, rate: Any, sqrt: Callable[[Any], Any]) -> tuple[Any, Any]:
    """Return the touching edge on undisturbed ground and the peeling edge (Eqs. 32 and 33)."""
    return -sqrt(d), (d + v) / (rate + sqrt(d + v + rate * rate))


def forces_in_closed_form(d: Any, v: Any, rate: Any, l: Any, r: Any) -> tuple[Any, Any]:
    """Return f_z and f_x by the antiderivatives of p and xi p (F11)."""
    f_z = (d + v) * (r - l) - (r**3 - l**3) / 3 - rate * (r**2 - l**2)
    f_x = (d + v) * (r**2 - l**2) / 2 - (r**4 - l**4) / 4 - 2 * rate * (r**3 - l**3) / 3
    return 3 * f_z / 4, -3 * f_x / 2


def _two_state_law(scene: Scene, number: Callable[[Any], Any], sqrt: Callable[[Any], Any]) -> Any:
    rate, epsilon, kappa = (number(x) for x in (scene.drive[0][1], scene.epsilon, scene.kappa))

    def law(_: Any, y: Any) -> list[Any]:
        d, v = y
        f_z, _ = forces_in_closed_form(d, v, rate, *edges_in_closed_form(d, v, rate, sqrt))
        return [v, (1 - f_z - kappa * (d - 1)) / epsilon]

    return law


def two_states(scene: Scene, tolerance: float) -> Solution:
    """Solve a start from rest to a constant lambda > 0 as an ODE of two states.

    Raises
    ------
    ValueError
        If an edge re-enters surface that it left earlier, so that memory is needed.
    """
    law = _two_state_law(scene, float, np.sqrt)
    span = (0.0, scene.times[-1])
    with np.errstate(invalid="ignore"):
        found = solve_ivp(
            law, span, [1.0, 0.0], "Radau", dense_output=True, rtol=tolerance, atol=0.01 * tolerance
        )
    if not found.success:
        raise ArithmeticError(f"the integration failed: {found.message}")
    rate, (d, v) = scene.drive[0][1], found.y
    _, r = edges_in_closed_form(d, v, rate, np.sqrt)
    _, acceleration = law(0.0, (d, v))
    if not (
        np.all(v + 2.0 * rate * np.sqrt(d) >= 0.0)
        and np.all(v + acceleration <= 2.0 * rate * (r + rate))
    ):
        raise ValueError("an edge re-enters surface that it left earlier: the scene needs memory")
    d, v = found.sol(np.array(scene.times))
    edges = edges_in_closed_form(d, v, rate, np.sqrt)
    rows = (d, v, *forces_in_closed_form(d, v, rate, *edges), *edges)
    return dict(zip(QUANTITIES, rows, strict=True))


def taylor(scene: Scene, digits: int) -> Solution:
    """Solve as `two_states`, by Taylor series with so many digits."""
    with mpmath.workdps(digits):
        law = _two_state_law(scene, mpmath.mpf, mpmath.sqrt)
        solve = mpmath.odefun(law, 0, [mpmath.mpf(1), mpmath.mpf(0)])
        rate, rows = mpmath.mpf(scene.drive[0][1]), []
        for s in scene.times:
            d, v = solve(s)
            edges = edges_in_closed_form(d, v, rate, mpmath.sqrt)
            rows.append((s, d, v, *forces_in_closed_form(d, v, rate, *edges), *edges))
        return at_times(scene, [tuple(map(float, row)) for row in rows], QUANTITIES)


def elements(scene, spacing, *, step=None, across=False):
    """Return s, d, x, w, U = int u dxi and M = int xi u dxi over all elements at every step, of second order.

    Both motions are written by balances of impulse, so that they need no pressure; c = 3/4, and 2/pi for a
    ball (`across`), whose rows of points take the rule of midpoints:

        eps v + c U,         (eps v + c U)' = 1 - kappa (d - 1) - c U
        eps_x w + 2 c M,     (eps_x w + 2 c M)' = -2 c (M - (lambda - w) U) - damping w - stiffness x

    The forces are f_z = c (U + U') and f_x = -2 c (M + M' - (lambda - w) U).
    """
    steps = _steps(scene, step or spacing)
    travel = [Y for _, _, Y, _, _ in steps] + ([-SWING, SWING] if scene.inertia else [])
    first, last = -REACH - max(travel), REACH - min(travel)
    X = spacing * np.arange(math.floor(first / spacing), math.ceil(last / spacing) + 1)
    eta = (np.arange(math.ceil(REACH / spacing)) + 0.5) * spacing if across else np.zeros(1)
    eta_square = (eta * eta)[:, None]
    area, c = (2.0 * spacing**2, 2.0 / math.pi) if across else (spacing, 0.75)
    moving = np.array([scene.epsilon is not None, scene.inertia is not None])
    eps, eps_x = scene.epsilon or 0.0, scene.inertia or 0.0
    largest = np.maximum(0.0, 1.0 - X * X - eta_square)  # u e^s: the largest e^s' g so far
    place, rate = np.array([1.0, 0.0]), np.zeros(2)  # d and x, v and w
    total, moment = largest.sum(), (X * largest).sum()
    U, M = area * total, area * moment
    rows = [(0.0, *place, 0.0, U, M)]
    for s, h, Y, before, after in steps:
        growth, half = math.exp(s), math.sqrt(max(place[0], 0.0) + MARGIN)
        window = slice(*np.searchsorted(X + Y - place[1], [-half, half]))
        at, free = X[window], largest[:, window] / growth
        rest, rest_moment = total / growth - free.sum(), moment / growth - (at * free).sum()
        new = place + moving * h * rate
        for _ in range(NEWTON_STEPS):
            xi = at + Y - new[1]
            g = new[0] - xi * xi - eta_square
            on = area * (g > free)
            u = np.maximum(g, free)
            U_new = area * (rest + u.sum())
            M_new = area * (rest_moment + (at * u).sum()) + (Y - new[1]) * U_new
            v, w = rate_new = 2.0 * (new - place) / h - rate
            slip = 0.5 * (M - (before - rate[1]) * U + M_new - (after - w) * U_new)
            d, x = 0.5 * (place + new)
            lacks = np.array([
                eps * (v - rate[0]) + c * (U_new - U)
                - h * (1.0 - scene.kappa * (d - 1.0) - 0.5 * c * (U + U_new)),
                eps_x * (w - rate[1]) + 2.0 * c * (M_new - M)
                + h * (2.0 * c * slip + 0.5 * scene.damping * (rate[1] + w) + scene.stiffness * x),
            ])  # fmt: skip
            U_by = np.array([on.sum(), 2.0 * (xi * on).sum()])
            M_by = np.array([(xi * on).sum(), 2.0 * (xi * xi * on).sum() - U_new])
            slip_by = 0.5 * (M_by - (after - w) * U_by + np.array([0.0, 2.0 * U_new / h]))
            slope = np.array([c * (1.0 + 0.5 * h) * U_by, 2.0 * c * (M_by + h * slip_by)])
            slope += np.diag([
                2.0 * eps / h + 0.5 * h * scene.kappa,
                2.0 * eps_x / h + scene.damping + 0.5 * h * scene.stiffness,
            ])  # fmt: skip
            slope[~moving] = np.eye(2)[~moving]
            change = np.linalg.solve(slope, lacks * moving)
            new = new - change
            if np.abs(change).max() < 1e-13:
                break
        else:
            raise ArithmeticError("Newton's method for a step of the elements did not converge")
        if on[:, [0, -1]].any():
            raise ArithmeticError(f"the contact outgrows the elements that it can touch at s = {s}")
        largest[:, window] = growth * u
        total, moment = growth * U_new / area, growth * (rest_moment + (at * u).sum())
        place, rate, U, M = new, rate_new * moving, U_new, M_new
        rows.append((s, *place, rate[1], U, M))
    return dict(zip(("s", "d", "x", "w", "U", "M"), np.array(rows).T, strict=True))


def _steps(scene, longest):
    """Return for each step its end, its length, the travel Y at its end, and lambda before and after."""
    steps, Y = [], 0.0
    for start, stop, rate in scene.pieces():
        grid = np.linspace(start, stop, math.ceil((stop - start) / longest) + 1)
        for a, b in pairwise(grid.tolist()):
            Y += (b - a) * (rate(a) + 4.0 * rate(0.5 * (a + b)) + rate(b)) / 6.0
            steps.append((b, b - a, Y, rate(a), rate(b)))
    return steps


def by_elements(scene, spacing, names=("d",)):
    """Return quantities by elements at the times of the scene."""
    found = elements(scene, spacing)
    rows = np.searchsorted(found["s"], np.array(scene.times) - 1e-12)
    return np.array([found[name][rows] for name in names])


def row(values: Array) -> list[float | None]:
    """Return numbers for JSON, where NaN is None."""
    return [None if math.isnan(x) else float(x) for x in values]


def entry(scene: Scene, method: str, coarse: Solution, fine: Solution) -> dict[str, Any]:
    """Return what the table holds of a scene; in flight there is no edge, which is None."""
    for q in fine:
        if np.any(np.isnan(coarse[q]) != np.isnan(fine[q])):
            raise ArithmeticError("a coarse and a fine solution differ about a flight")
    return asdict(scene) | {
        "method": method,
        "values": {q: row(fine[q]) for q in fine},
        "errors": {q: row(np.abs(fine[q] - coarse[q]) + ROUNDING) for q in fine},
    }


def extrapolated(
    scene: Scene, spacings: Sequence[float], names: Sequence[str]
) -> tuple[Array, Array]:
    """Return quantities by elements, and their estimated errors; each spacing is half of the one before."""
    found = [by_elements(scene, spacing, names) for spacing in spacings]
    better = [fine + (fine - coarse) / 3.0 for coarse, fine in pairwise(found)]
    return better[-1], SAFETY * np.abs(better[-1] - better[-2]) + ROUNDING


def table() -> dict[str, Any]:
    """Return the reference values of every scene, and the depth by elements where memory counts."""
    found = {}
    for name, scene in TAYLOR.items():
        found[name] = entry(scene, "taylor", taylor(scene, 20), taylor(scene, 30))
    for name, scene in TWO_STATES.items():
        found[name] = entry(scene, "two_states", two_states(scene, 1e-10), two_states(scene, 1e-12))
    for name, scene in HISTORY.items():
        coarse, fine = history(scene, 1e-12, 0.05), history(scene, 1e-13, 0.025)
        (d,), (error,) = extrapolated(scene, SPACINGS, ("d",))
        found[name] = entry(scene, "history", coarse, fine) | {
            "elements": {"d": row(d), "errors": row(error)}
        }
    return found


if __name__ == "__main__":
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(json.dumps(table(), indent=1) + "\n")
