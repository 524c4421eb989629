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

from tests.transient_history import history
from tests.transient_scenes import (
    HISTORY,
    QUANTITIES,
    TAYLOR,
    TWO_STATES,
    Array,
    Scene,
    Solution,
    at_times,
)

TABLE = Path(__file__).parent / "data" / "transient_reference.json"

REFINEMENTS = (8, 16, 32)
ROUNDING = 1e-15
SAFETY = 10.0
"""Edges cross elements at irregular phases, so that one change of refinement can be small by luck."""
SPACING = 2e-3
"""Of elements and of their time steps, before refinement; it divides the static half length."""
REACH = 2.0
"""The elements extend so far beyond the path of the indenter's axis, in half lengths."""
MARGIN = 0.1
"""More than d grows in a step; outside |xi| = sqrt(d + MARGIN) no element can be touched."""
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


def elements(scene, refinement):
    """Return d, U = int u dx and M = int xi u dx over all elements, of second order.

    The motion is written by the balance of impulse, so that it needs no pressure:

        J = epsilon v + (3/4) U,   J' = 1 - kappa (d - 1) - (3/4) U.

    For the forces, f_z = (3/4) (U + U') and f_x = -(3/2) (M + M' - lambda U).
    """
    steps = _steps(scene, refinement)
    dx = SPACING / refinement
    travel = [Y for _, _, Y in steps]
    first, last = -REACH - max(travel), REACH - min(travel)
    X = dx * np.arange(math.floor(first / dx), math.ceil(last / dx) + 1)
    w = np.maximum(0.0, 1.0 - X * X)  # u e^s: the largest e^s' g so far
    total, moment = w.sum(), X @ w
    d, U, J = 1.0, dx * total, 0.75 * dx * total
    rows = []
    for s, h, Y in steps:
        half = math.sqrt(max(d, 0.0) + MARGIN)
        window = slice(*np.searchsorted(X, [-half - Y, half - Y]))
        xi, old, growth = X[window] + Y, w[window].copy(), math.exp(s)
        others = total - old.sum()
        if scene.epsilon is not None and h > 0.0:
            free = dx * others / growth, old / growth
            d, J = _trapezoidal(scene, d, J, U, h, dx, xi * xi, free)
        if half > REACH or d > half * half:
            raise ArithmeticError(f"the contact outgrows the elements that it can touch at s = {s}")
        w[window] = np.maximum(old, growth * (d - xi * xi))
        total = others + w[window].sum()
        moment += X[window] @ (w[window] - old)
        U = dx * total / growth
        rows.append((s, d, U, dx * (moment + Y * total) / growth))
    return at_times(scene, rows, ("d", "U", "M"))


def _steps(scene, refinement):
    """Return for each step its end, its length and the travel Y at its end; the first is s = 0."""
    steps = [(0.0, 0.0, 0.0)]
    for start, stop, rate in scene.pieces():
        count = refinement * math.ceil((stop - start) / SPACING)
        for s in np.linspace(start, stop, count + 1)[1:]:
            h = s - steps[-1][0]
            simpson = rate(s - h) + 4.0 * rate(s - 0.5 * h) + rate(s)
            steps.append((float(s), h, steps[-1][2] + h * simpson / 6.0))
    return steps


def _trapezoidal(scene, d, J, U, h, dx, square, free):
    """Return d and J after a step, by Newton's method for the implicit trapezoidal rule."""
    others, surface = free
    epsilon, kappa, new = scene.epsilon, scene.kappa, d
    for _ in range(NEWTON_STEPS):
        g = new - square
        U_new = others + dx * np.maximum(g, surface).sum()
        width = dx * np.count_nonzero(g > surface)
        J_new = J + h * (1.0 - kappa * (0.5 * (d + new) - 1.0) - 0.375 * (U + U_new))
        residual = epsilon * (new - d) - 0.5 * h * (J + J_new - 0.75 * (U + U_new))
        slope = 0.375 * width + 0.25 * h * (kappa + 0.75 * width)
        change = residual / (epsilon + h * slope)
        new -= change
        if abs(change) < 1e-14:
            return new, J_new
    raise ArithmeticError("Newton's method for a step of the elements did not converge")


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


def extrapolated(by: Any, scene: Scene, refinements: Sequence[float]) -> tuple[Array, Array]:
    """Return d, or d and x, by elements, and the estimated error; each refinement is twice the one before."""
    d = [by(scene, refinement) for refinement in refinements]
    better = [fine + (fine - coarse) / 3.0 for coarse, fine in pairwise(d)]
    return better[-1], SAFETY * np.abs(better[-1] - better[-2]) + ROUNDING


def depth_by_elements(scene: Scene, refinement: int) -> Array:
    """Return d by elements."""
    return elements(scene, refinement)["d"]


def table() -> dict[str, Any]:
    """Return the reference values of every scene, and the depth by elements where memory counts."""
    found = {}
    for name, scene in TAYLOR.items():
        found[name] = entry(scene, "taylor", taylor(scene, 20), taylor(scene, 30))
    for name, scene in TWO_STATES.items():
        found[name] = entry(scene, "two_states", two_states(scene, 1e-10), two_states(scene, 1e-12))
    for name, scene in HISTORY.items():
        coarse, fine = history(scene, 1e-12, 0.05), history(scene, 1e-13, 0.025)
        d, error = extrapolated(depth_by_elements, scene, REFINEMENTS)
        found[name] = entry(scene, "history", coarse, fine) | {
            "elements": {"d": row(d), "errors": row(error)}
        }
    return found


if __name__ == "__main__":
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(json.dumps(table(), indent=1) + "\n")
