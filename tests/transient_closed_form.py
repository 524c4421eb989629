"""Starts from rest that need no memory: an ODE of two states, whose edges have closed forms.

The scaled form is explained in `tests.transient_reference`.
"""

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
from scipy.integrate import solve_ivp

from tests.transient_scenes import QUANTITIES, Scene, Solution, at_times


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
        If an edge moves back over ground that it left, so that memory is needed.
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
        raise ValueError("an edge moves back over ground that it left: the scene needs memory")
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
