"""The methods of the work-precision charts for transients, each with its accuracy parameter."""

import math
import os
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from kvtheory.charts.naive import Array, Law, solve_by_scipy
from kvtheory.charts.problems import Curves, Problem, by_continuum, by_elements, by_two_states
from kvtheory.charts.work_precision import Clock, Method
from kvtheory.compilation import available
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.slow_manifold.motion import follow
from kvtheory.models.slow_manifold.start import start

TOLERANCES = tuple(10.0**-k for k in range(2, 13))
TWO_STATES = "RK45", "DOP853", "Radau", "BDF", "LSODA"
"""The solvers of SciPy that take the two states."""
STIFF = {"Radau": 0.22, "BDF": 0.14}
"""Powers of the tolerance with which a run takes longer, of methods of low order."""
DENSITIES = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)
"""Elements per static half length."""
LINES_RTOL = 1e-6
"""Tolerance of the method of lines: its error in time is below that of the elements."""
SUNDIALS_LOGS = "SUNLOGGER_WARNING_FILENAME", "SUNLOGGER_ERROR_FILENAME"
"""Environment variables: files for the messages of SUNDIALS, which would otherwise appear within a table."""
REACH = 1.6
"""How far the elements of the method of lines extend beyond the indenter's path, in half lengths."""


def transient_methods() -> dict[str, Method]:
    """Return the available methods; those that are not installed are left out."""
    solvers: dict[str, Any] = dict.fromkeys(TWO_STATES, solve_by_scipy)
    if find_spec("sksundae"):
        solvers["CVODE"] = _solve_by_cvode
    found = [
        Method("slow manifold", "rtol", TOLERANCES[:9:2], "evaluations", _slow_manifold, "model",
               _starts_forward),
        *(Method(f"continuum, {how}", "rtol", TOLERANCES, "evaluations", partial(by_continuum, fast=fast),
                 cost=0.05 if fast else None)
          for how, fast in (("interpreted", False), ("compiled", True)) if not fast or available()),
        *(Method(f"two states, {name}", "rtol", TOLERANCES[:-1], "evaluations",
                 partial(by_two_states, method=name, solve=solve), suits=lambda problem: problem.two_states,
                 growth=STIFF.get(name, 0.1))
          for name, solve in solvers.items()),
        Method("method of lines", "elements", DENSITIES[:5], "element updates", _lines, suits=_from_rest,
               growth=2.8, cost=60.0),
        *(Method(f"elements, {name}", "elements per a_0", DENSITIES, "element updates",
                 partial(by_elements, scheme=name), growth=0.5, cost=0.05) for name in SCHEMES),
    ]  # fmt: skip
    return {method.name: method for method in found}


def _from_rest(problem: Problem) -> bool:
    """Whether two states suit, and the motion starts at rest, as the method of lines requires."""
    return problem.two_states and problem.scene.start.at_rest


def _starts_forward(problem: Problem) -> bool:
    """Whether the drive number is positive and constant, as the slow manifold requires."""
    numbers = [number for _, _, number in problem.pieces]
    return (
        _from_rest(problem) and len(numbers) == 1 and not callable(numbers[0]) and numbers[0] > 0.0
    )


def _solve_by_cvode(
    law: Law, ends: tuple[float, float], y: Array, s: Array, _: str, rtol: float
) -> tuple[Array, int]:
    for name in SUNDIALS_LOGS:  # its status says the same
        os.environ.setdefault(name, os.devnull)
    from sksundae.cvode import CVODE

    def rhs(t: float, y: Array, out: Array) -> None:
        out[:] = law(t, y)

    times = np.unique([*ends, *s])
    with redirect_stdout(None), redirect_stderr(None):
        run = CVODE(rhs, method="BDF", rtol=rtol, atol=0.01 * rtol).solve(times, y)
    if not run.success:
        raise ArithmeticError(run.message)
    return run.y[np.searchsorted(times, [*s, ends[1]])].T, run.nfev


def _slow_manifold(problem: Problem, rtol: float, _: Clock) -> tuple[Curves, int]:
    units = problem.units
    given = start(problem.pieces[0][2], units.inertia_number, units.support_number)
    found = follow(given, problem.times / units.time, rtol).values
    return Curves(found["depth"], found["friction_force"]), 0


def _lines(problem: Problem, density: float, clock: Clock) -> tuple[Curves, int]:
    """Solve d' = v, d'' and u' of every element together, as one system, by SciPy's RK45."""
    from scipy.integrate import solve_ivp

    s, dx = problem.times / problem.units.time, 1.0 / density
    places = [problem.drive.at(float(t))[0] for t in np.linspace(0.0, problem.drive.end, 201)]
    first, last = math.floor((-REACH - max(places)) / dx), math.ceil((REACH - min(places)) / dx)
    X = dx * np.arange(first, last + 1)
    epsilon, kappa = problem.units.inertia_number, problem.units.support_number
    y, rows, updates = np.array([1.0, 0.0, *np.maximum(1.0 - X * X, 0.0)]), [], 0

    def pressed(t: float, y: Array) -> tuple[Any, Any, Any]:
        Y, number, _ = problem.drive.at(t)
        xi = X + Y
        g, g_rate = y[0] - xi * xi, y[1] - 2.0 * number * xi
        p = np.where((g >= y[2:] - LINES_RTOL) & (g + g_rate > 0.0), g + g_rate, 0.0)
        return xi, g_rate, p

    def law(t: float, y: Array) -> Array:
        clock.check()
        _, g_rate, p = pressed(t, y)
        pull = 1.0 - 0.75 * dx * float(p.sum()) - kappa * (y[0] - 1.0)
        return np.concatenate([[y[1], pull / epsilon], np.where(p > 0.0, g_rate, -y[2:])])

    for a, b, _ in problem.pieces:
        run = solve_ivp(
            law, (a, b), y, "RK45", t_eval=np.unique([*s[(s >= a) & (s < b)], b]),
            rtol=LINES_RTOL, atol=0.1 * LINES_RTOL,
        )  # fmt: skip
        if not run.success:
            raise ArithmeticError(run.message)
        y, updates = run.y[:, -1], updates + run.nfev * X.size
        kept = run.t.size if b == problem.drive.end else run.t.size - 1
        for t, state in zip(run.t[:kept], run.y.T[:kept], strict=True):
            xi, _, p = pressed(float(t), state)
            rows.append((state[0], -1.5 * dx * float(xi @ p)))
    return Curves(*np.array(rows).T), updates
