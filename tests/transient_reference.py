"""Reference solutions of the transient, by four methods that share no code with the package.

Scaled form: lengths along x by a_0, depths by delta_0, time by tau, forces by the static load. At
the material point X = xi - Y, with Y' = lambda, the compression is

    u(X, s) = e^-s max(u_0(X), sup over s' <= s of e^s' g(X, s')),   g = d - xi^2,   (F8)

and p = u + u' where u = g. Before s = 0 the indenter rests: d = 1, lambda = 0, u_0 = 1 - X^2.

- `elements` takes (F8) as it stands, on a row of points; it knows nothing of a contact or its edges.
- `history` finds the contact from the whole past, and is far more accurate.
- `two_states` and `taylor` have closed-form edges, for starts from rest that need no memory.

`python -m tests.transient_reference` writes the table of reference values, in some twenty minutes,
with the change from a coarser to a finer solution as the error of each.
"""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]
Rate = Callable[[float], float]
Solution = dict[str, Array]

TABLE = Path(__file__).parent / "data" / "transient_reference.json"
QUANTITIES = ("d", "v", "f_z", "f_x", "left", "right")

SPACING = 2e-3
"""Of elements and of their time steps, before refinement; it divides the static half length."""
REACH = 2.0
"""The elements extend so far beyond the path of the indenter's axis, in half lengths."""
MARGIN = 0.1
"""More than d grows in a step; outside |xi| = sqrt(d + MARGIN) no element can be touched."""
NEWTON_STEPS = 50
REFINEMENTS = (8, 16, 32)
PER_STEP = 4
"""Past instants kept for each step; the most forbidding one between them is found by a search."""
RECENT = 1e-9
"""Instants closer than this are left to the limit s' -> s: their differences would be rounding."""
ROUNDING = 1e-15
SAFETY = 10.0
"""Edges cross elements at irregular phases, so that one change of refinement can be small by luck."""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


def _line(a: float, y: float, b: float, z: float) -> Rate:
    """Return the line from (a, y) to (b, z)."""
    slope = (z - y) / (b - a)
    return lambda s: y + slope * (s - a)


@dataclass(frozen=True)
class Scene:
    """A drive, the inertia number (None: fixed), the support number, and the times of interest.

    `drive` is a list of points (s, lambda), linear between them, with a jump where a time is
    repeated, and constant after the last; or {"mean", "amplitude", "frequency"}, which stands for
    lambda = mean + amplitude cos(frequency s).
    """

    drive: Any
    epsilon: float | None
    times: Sequence[float]
    kappa: float = 0.0

    def pieces(self) -> list[tuple[float, float, Rate]]:
        """Return the intervals between jumps, times of interest and the end, with lambda(s)."""
        if isinstance(self.drive, dict):
            mean, amplitude, frequency = self.drive.values()
            rates = [(0.0, lambda s: mean + amplitude * math.cos(frequency * s))]
        else:
            points = [*self.drive, (math.inf, self.drive[-1][1])]
            rates = [(a, _line(a, y, b, z)) for (a, y), (b, z) in pairwise(points) if b > a]
        end = self.times[-1]
        stops = sorted({0.0, end, *self.times, *(a for a, _ in rates if a < end)})
        return [
            (start, stop, next(rate for a, rate in reversed(rates) if a <= start))
            for start, stop in zip(stops, [*stops[1:], end], strict=True)
        ]


def elements(scene: Scene, refinement: int) -> Solution:
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
            d, J = _trapezoidal(scene.epsilon, scene.kappa, d, J, U, h, dx, xi * xi, free)
        if half > REACH or d > half * half:
            raise ArithmeticError(f"the contact outgrows the elements that it can touch at s = {s}")
        w[window] = np.maximum(old, growth * (d - xi * xi))
        total = others + w[window].sum()
        moment += X[window] @ (w[window] - old)
        U = dx * total / growth
        rows.append((s, d, U, dx * (moment + Y * total) / growth))
    return _at_times(scene, rows, ("d", "U", "M"))


def _steps(scene: Scene, refinement: int) -> list[tuple[float, float, float]]:
    """Return for each step its end, its length and the travel Y at its end; the first is s = 0."""
    steps = [(0.0, 0.0, 0.0)]
    for start, stop, rate in scene.pieces():
        count = refinement * math.ceil((stop - start) / SPACING)
        for s in np.linspace(start, stop, count + 1)[1:]:
            h = s - steps[-1][0]
            simpson = rate(s - h) + 4.0 * rate(s - 0.5 * h) + rate(s)
            steps.append((float(s), h, steps[-1][2] + h * simpson / 6.0))
    return steps


def _trapezoidal(
    epsilon: float,
    kappa: float,
    d: float,
    J: float,
    U: float,
    h: float,
    dx: float,
    square: Array,
    free: Any,
) -> tuple[float, float]:
    """Return d and J after a step, by Newton's method for the implicit trapezoidal rule."""
    others, surface = free
    new = d
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


@dataclass
class Past:
    """The motion so far: sampled instants, and the steps that interpolate between them."""

    s: Array = field(default_factory=lambda: np.zeros(1))
    d: Array = field(default_factory=lambda: np.ones(1))
    Y: Array = field(default_factory=lambda: np.zeros(1))
    steps: list[Any] = field(default_factory=list)

    def add(self, step: Any) -> None:
        s = np.linspace(step.t_old, step.t, PER_STEP + 1)[1:]
        d, _, Y = step(s)
        self.s, self.d, self.Y = (
            np.append(old, new) for old, new in ((self.s, s), (self.d, d), (self.Y, Y))
        )
        self.steps.append(step)

    def at(self, s: float) -> tuple[float, float]:
        """Return d and Y at a past instant."""
        if s <= 0.0:
            return 1.0, 0.0
        d, _, Y = self.steps[(int(np.searchsorted(self.s, s)) - 1) // PER_STEP](s)
        return d, Y


def ends(b: Any, c: Any) -> Array:
    """Return both roots of xi^2 + 2 b xi - c without cancellation; NaN if there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        far = -b - np.copysign(np.sqrt(b * b + c), b)
        return np.sort([far, -c / far], axis=0)


def allowed(delay: Any, d: float, m: Any, d_past: Any) -> Array:
    """Return where g(xi, s) >= e^-delay g(xi - m, s - delay): an interval, or NaN."""
    decay, lost = np.exp(-delay), -np.expm1(-delay)
    return ends(decay * m / lost, d + decay * (d - d_past + m * m) / lost)


def contact(s: float, y: Array, rates: Sequence[float], past: Past) -> Array:
    """Return the ends of the contact: what no past instant forbids; NaN in flight.

    The instant s' forbids every xi where e^s' g was above e^s g; their difference is concave in
    xi, so that each leaves an interval. Two limits belong to the past: s' -> -oo, undisturbed
    ground, where g >= 0, and s' -> s, where p >= 0. `rates` holds lambda, and at a jump also the
    lambda before it. No xi is in contact if one interval is empty or they do not overlap.
    """
    d, v, Y = y
    n = int(np.searchsorted(past.s, s - RECENT))
    samples = allowed(s - past.s[:n], d, Y - past.Y[:n], past.d[:n])
    limits = ends(np.array([0.0, *rates]), np.array([d, *(d + v for _ in rates)]))

    def interval(instant: float) -> Array:
        d_past, Y_past = past.at(instant)
        return allowed(s - instant, d, Y - Y_past, d_past)

    left = -_least(-limits[0], -samples[0], past.s[:n], lambda t: -interval(t)[0])
    right = _least(limits[1], samples[1], past.s[:n], lambda t: interval(t)[1])
    return np.array([left, right] if left < right else [math.nan, math.nan])


def _least(limits: Array, samples: Array, instants: Array, end: Rate) -> float:
    """Return the least of the limits, and of `end` over all instants; NaN if one is NaN."""
    bound = float(np.min(limits))
    if samples.size == 0:
        return bound
    k = int(np.argmin(samples))
    near = slice(max(k - 1, 0), k + 2)
    # A smooth curve dips between its samples by less than it changes from one to the next.
    if 2.0 * samples[k] - samples[near].max() > bound:
        return bound
    bracket = instants[near][[0, -1]]
    found = minimize_scalar(end, bounds=bracket, method="bounded", options={"xatol": 1e-9})
    return float(np.min([bound, samples[k], found.fun]))


def forces(d: float, v: float, rate: float, edges: Array) -> tuple[float, float]:
    """Return (3/4) int p dxi and -(3/2) int xi p dxi over the contact; nothing in flight."""
    if np.isnan(edges).any():
        return 0.0, 0.0
    half = 0.5 * (edges[1] - edges[0])
    xi = edges.mean() + half * POINTS
    p = half * WEIGHTS * (d + v - xi * (xi + 2.0 * rate))
    return 0.75 * float(p.sum()), -1.5 * float(xi @ p)


def history(scene: Scene, tolerance: float, longest_step: float) -> Solution:
    """Return the quantities at the times of the scene, just after a jump."""
    past, y, before = Past(), np.array([1.0, 0.0, 0.0]), 0.0
    rows = []
    for start, stop, rate in scene.pieces():
        law = _motion(scene, start, rate, before, past)
        edges = contact(start, y, (rate(start), before), past)
        rows.append((start, *y[:2], *forces(y[0], y[1], rate(start), edges), *edges))
        if stop == start:
            break
        solver = DOP853(law, start, y, stop, longest_step, tolerance, 0.01 * tolerance)
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"the integration failed at s = {solver.t}: {message}")
            past.add(solver.dense_output())
        y, before = solver.y, rate(stop)
    return _at_times(scene, rows, QUANTITIES)


def _motion(scene: Scene, start: float, rate: Rate, before: float, past: Past) -> Any:
    """Return the derivatives of (d, v, Y) after `start`, where lambda was `before`."""

    def law(s: float, y: Array) -> tuple[float, float, float]:
        d, v, _ = y
        if scene.epsilon is None:
            return 0.0, 0.0, rate(s)
        rates = (rate(s), before) if s == start else (rate(s),)
        f_z, _ = forces(d, v, rate(s), contact(s, y, rates, past))
        return v, (1.0 - f_z - scene.kappa * (d - 1.0)) / scene.epsilon, rate(s)

    return law


def _at_times(scene: Scene, rows: Iterable[Any], names: Sequence[str]) -> Solution:
    """Pick the rows at the times of the scene; their first entry is the instant."""
    found = {row[0]: row[1:] for row in rows}
    return dict(zip(names, np.array([found[s] for s in scene.times]).T, strict=True))


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
        return _at_times(scene, [tuple(map(float, row)) for row in rows], QUANTITIES)


def _jump(time: float, first: float, second: float) -> list[tuple[float, float]]:
    return [(0.0, first), (time, first), (time, second)]


LAMBDA, EPSILON = 4.0812765306, 0.00306095740
"""Of Table 1."""
EARLY = (0.0, 1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0)
LATER = (0.1, 0.5, 0.501, 0.51, 0.6, 0.8, 1.0, 1.5)
LONG = (0.0, 0.1, 1.0, 2.0, 5.0, 10.0, 20.0)
SHORT = (0.0, 1e-3, 1e-2, 0.05, 0.1, 0.2)

TAYLOR = {
    "start": Scene([(0.0, LAMBDA)], EPSILON, EARLY),
    "start-heavy": Scene([(0.0, 1.0)], 1.0, EARLY),
    "start-heavier": Scene([(0.0, 0.1)], 100.0, LONG),
}
TWO_STATES = {
    f"start-epsilon-{epsilon:g}-lambda-{rate:g}": Scene(
        [(0.0, rate)], epsilon, LONG if epsilon > 0.5 else EARLY
    )
    for epsilon in (1e-6, 1e-4, 1e-3, 1e-2, 1.0, 100.0)
    for rate in (1e-2, 1.0)
} | {"start-suspended": Scene([(0.0, LAMBDA)], EPSILON, EARLY, 1.0)}
HISTORY = {
    "stop": Scene(_jump(0.5, LAMBDA, 0.0), EPSILON, LATER),
    "slow-down": Scene(_jump(0.5, LAMBDA, 0.2 * LAMBDA), EPSILON, LATER),
    "stop-and-go": Scene(
        [*_jump(0.5, LAMBDA, 0.0), (0.7, 0.0), (0.7, LAMBDA)],
        EPSILON,
        (0.5, 0.6, 0.7, 0.701, 0.71, 0.8, 1.0, 1.5),
    ),
    "reversal": Scene(_jump(0.5, LAMBDA, -LAMBDA), EPSILON, LATER),
    "ramp": Scene(
        [(0.0, 0.0), (0.2, LAMBDA), (0.5, 1.0), (0.7, 1.0), (1.0, 0.0)],
        EPSILON,
        (0.0, 0.1, 0.2, 0.5, 0.7, 1.0, 1.5),
    ),
    "oscillation-slow": Scene(
        {"mean": 0.0, "amplitude": 2.0, "frequency": 6.0}, EPSILON, (0.0, 0.1, 0.5, 0.8, 1.0, 1.5)
    ),
    "oscillation-fast": Scene(
        {"mean": 2.0, "amplitude": 4.0, "frequency": 20.0}, EPSILON, (0.0, 0.1, 0.3, 0.5, 1.0)
    ),
    "suspended-stop": Scene(_jump(0.5, LAMBDA, 0.0), EPSILON, LATER, 1.0),
    "suspended-reversal": Scene(_jump(0.5, LAMBDA, -LAMBDA), EPSILON, LATER, 1.0),
    "fixed-stop": Scene(_jump(0.5, LAMBDA, 0.0), None, LATER),
    "fixed-reversal": Scene(_jump(0.5, LAMBDA, -LAMBDA), None, LATER),
    "hop": Scene([(0.0, 4.0)], 0.3, (0.0, 0.1, 0.5, 1.0, 1.4, 2.0, 3.0, 4.0)),
    "hops": Scene([(0.0, 10.0)], 0.3, (0.0, 0.1, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)),
    "drop": Scene(_jump(0.5, 30.0, 0.0), 0.01, (0.0, 0.01, 0.1, 0.5, 0.6, 0.8, 1.0, 2.0)),
    "bounce": Scene(_jump(1.0, 2.0, 0.05), 100.0, (0.5, 1.0, 1.01, 2.0, 5.0, 10.0, 15.0, 20.0)),
    "start-lambda-100": Scene([(0.0, 100.0)], 0.01, SHORT),
    "start-lambda-100-heavy": Scene([(0.0, 100.0)], 1.0, SHORT),
}


def _row(values: Array) -> list[float | None]:
    return [None if math.isnan(x) else float(x) for x in values]


def entry(scene: Scene, method: str, coarse: Solution, fine: Solution) -> dict[str, Any]:
    """Return what the table holds of a scene; in flight there is no edge, which is None."""
    for q in QUANTITIES:
        if np.any(np.isnan(coarse[q]) != np.isnan(fine[q])):
            raise ArithmeticError("a coarse and a fine solution differ about a flight")
    return asdict(scene) | {
        "method": method,
        "values": {q: _row(fine[q]) for q in QUANTITIES},
        "errors": {q: _row(np.abs(fine[q] - coarse[q]) + ROUNDING) for q in QUANTITIES},
    }


def extrapolated(scene: Scene, refinements: Sequence[int]) -> tuple[Array, Array]:
    """Return d by elements, each refinement twice the one before, and its estimated error."""
    d = [elements(scene, refinement)["d"] for refinement in refinements]
    better = [fine + (fine - coarse) / 3.0 for coarse, fine in pairwise(d)]
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
        d, error = extrapolated(scene, REFINEMENTS)
        found[name] = entry(scene, "history", coarse, fine) | {
            "elements": {"d": _row(d), "errors": _row(error)}
        }
    return found


if __name__ == "__main__":
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(json.dumps(table(), indent=1) + "\n")
