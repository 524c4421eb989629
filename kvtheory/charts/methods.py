"""The methods of the work-precision charts for transients, each with the knob that it sweeps."""

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
from kvtheory.charts.naive import two_states
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
"""Where SUNDIALS writes what it would else print in the middle of a table."""
REACH = 1.6
"""The row of the method of lines extends so far beyond the indenter's path, in half lengths."""


class TimedOutError(Exception):
    """A run took longer than it was given."""


@dataclass
class Clock:
    """Ends a run that has gone on for too long, from within its own function."""

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

    `kind` is ``"model"`` where the error is that of a simpler model, which no knob can reduce; `work` is
    what is counted; `suits` says whether the method can take a problem at all.
    """

    name: str
    knob: str
    values: Sequence[float]
    work: Literal["evaluations", "element updates"]
    solve: Solve
    kind: Literal["numerical", "model"] = "numerical"
    suits: Callable[[Problem], bool] = lambda problem: not problem.fixed


def transient_methods() -> dict[str, Method]:
    """Return the methods that can run here: what is not installed is left out.

    Examples
    --------
    >>> [name for name in transient_methods() if name.startswith("elements")][0]
    'elements, paper'
    """
    found = [
        Method("slow manifold", "rtol", TOLERANCES[:9:2], "evaluations", _slow_manifold, "model",
               lambda problem: len(problem.pieces) == 1 and not problem.fixed
               and not callable(problem.pieces[0][2]) and problem.pieces[0][2] > 0.0),
        *(_continuum(fast) for fast in ((False, True) if compiled.available() else (False,))),
        *(_solve_ivp(name) for name in ("RK45", "DOP853", "Radau", "BDF", "LSODA")),
        *([_CVODE] if find_spec("sksundae") else []),
        Method("method of lines", "elements", LINES_DENSITIES, "element updates", _lines),
        *(_elements(name) for name in SCHEMES),
    ]  # fmt: skip
    return {method.name: method for method in found}


def _continuum(fast: bool) -> Method:
    def solve(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
        return problems.by_continuum(problem, rtol, fast=fast, progress=clock.check)

    name = "continuum, compiled" if fast else "continuum, interpreted"
    return Method(name, "rtol", TOLERANCES, "evaluations", solve, suits=lambda _: True)


def _solve_ivp(method: str) -> Method:
    def solve(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
        return problems.by_two_states(
            problem, method, rtol, lambda *numbers: clock.watched(two_states(*numbers))
        )

    return Method(f"two states, {method}", "rtol", LOOSE_TOLERANCES, "evaluations", solve)


def _cvode(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
    for name in SUNDIALS_LOGS:  # its status says the same
        os.environ.setdefault(name, os.devnull)
    from sksundae.cvode import CVODE

    s, y, rows, count = problem.times / problem.units.time, np.array([1.0, 0.0]), [], 0
    for a, b, number in problem.pieces:
        law = clock.watched(two_states(number, problem.epsilon, problem.kappa))
        inside = s[(s >= a) & (s < b)]
        wanted = np.unique([a, *inside, b])
        with redirect_stdout(None), redirect_stderr(None):
            run = CVODE(_in_place(law), method="BDF", rtol=rtol, atol=0.01 * rtol).solve(wanted, y)
        if not run.success:
            raise ArithmeticError(run.message)
        y, count = run.y[-1].copy(), count + run.nfev
        rows += problems.rows_of(s, a, b, run.y[np.searchsorted(wanted, inside)].T, number)
    rows += problems.rows_of(s, b, math.inf, y[:, None], number)
    depth, friction = np.array(rows).T
    return Curves(depth, friction), count


def _in_place(law: Callable[..., Any]) -> Callable[[float, Array, Array], None]:
    def rhs(t: float, y: Array, out: Array) -> None:
        out[:] = law(t, y)

    return rhs


_CVODE = Method("two states, CVODE", "rtol", LOOSE_TOLERANCES, "evaluations", _cvode)


def _slow_manifold(problem: Problem, rtol: float, clock: Clock) -> tuple[Curves, int]:
    del clock  # it takes a millisecond
    number = problem.pieces[0][2]
    given = start(number, problem.epsilon, problem.kappa)
    found = follow(given, problem.times / problem.units.time, rtol).values
    return Curves(found["depth"], found["friction_force"]), 0


def _elements(scheme: str) -> Method:
    def solve(problem: Problem, density: float, clock: Clock) -> tuple[Curves, int]:
        run = problems.by_elements(
            problem, density, scheme, progress=lambda done, whole: clock.check()
        )
        return problems.curves_of(problem, run), run.element_updates

    return Method(
        f"elements, {scheme}",
        "elements per a_0",
        DENSITIES,
        "element updates",
        solve,
        suits=lambda _: True,
    )


def _lines(problem: Problem, density: float, clock: Clock) -> tuple[Curves, int]:
    """Solve d' = v, d'' and u' of every element together, as one system, by SciPy's RK45."""
    from scipy.integrate import solve_ivp

    s, dx = problem.times / problem.units.time, 1.0 / density
    places = [problem.drive.at(float(t))[0] for t in np.linspace(0.0, problem.drive.end, 201)]
    X = (
        np.arange(
            math.floor((-REACH - max(places)) / dx), math.ceil((REACH - min(places)) / dx) + 1
        )
        * dx
    )
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
        last = run.t.size if b == problem.drive.end else run.t.size - 1
        for t, state in zip(run.t[:last], run.y.T[:last], strict=True):
            xi, _, p = pressed(float(t), state)
            rows.append((state[0], -1.5 * dx * float(xi @ p)))
    depth, friction = np.array(rows).T
    return Curves(depth, friction), updates
