"""The methods of the work-precision charts for transients, each with its accuracy parameter."""

import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kvtheory.charts import problems
from kvtheory.charts.naive import Law, two_states
from kvtheory.charts.problems import Curves, Problem
from kvtheory.models.continuum import compiled
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.slow_manifold.motion import follow
from kvtheory.models.slow_manifold.start import start

Array = NDArray[np.float64]

TOLERANCES = tuple(10.0**-k for k in range(2, 13))
LOOSE_TOLERANCES = tuple(10.0**-k for k in range(2, 12))
DENSITIES = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)
"""Elements per static half length."""
LINES_DENSITIES = DENSITIES[:5]
LINES_RTOL = 1e-6
"""Tolerance of the method of lines: its error in time is below that of the elements."""
SUNDIALS_LOGS = "SUNLOGGER_WARNING_FILENAME", "SUNLOGGER_ERROR_FILENAME"
"""File to which SUNDIALS writes its messages, which would otherwise appear within a table."""
REACH = 1.6
"""Margin of the row of the method of lines beyond the indenter's path, in half lengths."""


class TimedOutError(Exception):
    """A run took longer than allowed."""


@dataclass
class Clock:
    """Ends a run that takes too long, from within its right-hand side."""

    seconds: float = math.inf
    began: float = 0.0

    def start(self) -> None:
        """Begin to count."""
        self.began = time.perf_counter()

    def check(self, *_: Any) -> None:
        """Raise `TimedOutError` if the time is up."""
        if time.perf_counter() - self.began > self.seconds:
            raise TimedOutError

    def watched(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function with a check before each call."""

        def call(*arguments: Any) -> Any:
            self.check()
            return function(*arguments)

        return call


Solve = Callable[[Problem, float, Clock], tuple[Curves, int]]


@dataclass(frozen=True)
class Method:
    """A way to solve a problem; `solve` returns the curves and the work that these took.

    `kind` is ``"model"`` where the error is that of a simpler model, which no parameter can reduce; `work`
    names the counted operations; `suits` says whether the method applies to a problem.
    """

    name: str
    knob: str
    values: Sequence[float]
    work: Literal["evaluations", "element updates"]
    solve: Solve
    kind: Literal["numerical", "model"] = "numerical"
    suits: Callable[[Problem], bool] = lambda problem: not problem.scene.held


def transient_methods() -> dict[str, Method]:
    """Return the methods that can run here: what is not installed is left out.

    Examples
    --------
    >>> [name for name in transient_methods() if name.startswith("elements")][0]
    'elements, paper'
    """
    found = [
        Method("slow manifold", "rtol", TOLERANCES[:9:2], "evaluations", _slow_manifold, "model",
               lambda problem: len(problem.pieces) == 1 and not problem.scene.held
               and not callable(problem.pieces[0][2]) and problem.pieces[0][2] > 0.0),
        *(_continuum(fast) for fast in ((False, True) if compiled.available() else (False,))),
        *(_two_states(name) for name in ("RK45", "DOP853", "Radau", "BDF", "LSODA")),
        *([_two_states("CVODE", _piece_by_cvode)] if find_spec("sksundae") else []),
        Method("method of lines", "elements", LINES_DENSITIES, "element updates", _lines),
        *(_elements(name) for name in SCHEMES),
    ]  # fmt: skip
    return {method.name: method for method in found}


def _continuum(fast: bool) -> Method:
    def solve(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
        return problems.by_continuum(problem, rtol, fast=fast, progress=clock.check)

    name = "continuum, compiled" if fast else "continuum, interpreted"
    return Method(name, "rtol", TOLERANCES, "evaluations", solve, suits=lambda _: True)


def _two_states(
    name: str, piece: Callable[..., tuple[Array, int]] = problems.piece_by_scipy
) -> Method:
    def solve(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
        def law_of(*numbers: Any) -> Law:
            return clock.watched(two_states(*numbers))

        return problems.by_two_states(problem, name, rtol, law_of, piece)

    return Method(f"two states, {name}", "rtol", LOOSE_TOLERANCES, "evaluations", solve)


def _piece_by_cvode(
    law: Law, ends: tuple[float, float], y: Array, s: Array, _: str, rtol: float
) -> tuple[Array, int]:
    for name in SUNDIALS_LOGS:  # its status says the same
        os.environ.setdefault(name, os.devnull)
    from sksundae.cvode import CVODE

    def rhs(t: float, y: Array, out: Array) -> None:
        out[:] = law(t, y)

    wanted = np.unique([*ends, *s])
    with redirect_stdout(None), redirect_stderr(None):
        run = CVODE(rhs, method="BDF", rtol=rtol, atol=0.01 * rtol).solve(wanted, y)
    if not run.success:
        raise ArithmeticError(run.message)
    return run.y[np.searchsorted(wanted, [*s, ends[1]])].T, run.nfev


def _slow_manifold(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
    del clock  # it takes a millisecond
    number = problem.pieces[0][2]
    given = start(number, problem.epsilon, problem.kappa)
    found = follow(given, problem.times / problem.units.time, rtol).values
    return Curves(found["depth"], found["friction_force"]), 0


def _elements(scheme: str) -> Method:
    def solve(problem: Problem, density: float, clock: Clock) -> tuple[Curves, int]:
        return problems.by_elements(problem, density, scheme, progress=clock.check)

    name, knob = f"elements, {scheme}", "elements per a_0"
    return Method(name, knob, DENSITIES, "element updates", solve, suits=lambda _: True)


def _lines(problem: Problem, density: float, clock: Clock) -> tuple[Curves, int]:
    """Solve d' = v, d'' and u' of every element together, as one system, by SciPy's RK45."""
    from scipy.integrate import solve_ivp

    s, dx = problem.times / problem.units.time, 1.0 / density
    places = [problem.drive.at(float(t))[0] for t in np.linspace(0.0, problem.drive.end, 201)]
    first, last = math.floor((-REACH - max(places)) / dx), math.ceil((REACH - min(places)) / dx)
    X = dx * np.arange(first, last + 1)
    epsilon, kappa = problem.epsilon, problem.kappa
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
