"""Quantities of a scene from measured friction: least squares over the exact theory.

Unknowns are logarithms. The first guess needs no help: the maximum of the measured friction gives the
stiffness of the foundation, and the velocities its times (fact F26); many points around them are tried at
once, as theory takes arrays, and the best ones are refined, with the best of each part of the range: the
sum of squares may have several minima, which are kept as far as the data allow them. The covariance is that
of the linear theory at the lowest one. A combination of unknowns that is uncertain by more than a factor of
two is reported by its keys.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist
from scipy.stats import qmc

from kvtheory.fitting.least_squares import Fit, descend, sloped, student
from kvtheory.fitting.records import FRICTION, Data, largest_speed, speeds
from kvtheory.scene.foundations import Foundation, FractionalKelvinVoigt, GeneralizedMaxwell
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import as_given, given

Array = NDArray[np.float64]
Solve = Callable[[Scene], Any]
"""Returns steady sliding of the scenes of arrays."""
Follow = Callable[[Scene, Array, float], Mapping[str, Any]]
"""Returns the transient of one scene by name, at times (s), within a tolerance."""
Report = Callable[[float], Any]

OFFSET = "offset"
"""The unknown of a friction coefficient that does not depend on velocity, beside that of the foundation."""
STIFF = "foundation.stiffness", "foundation.modulus"
"""The keys of the stiffness of the foundation: its own, or that of a layer."""
FLOOR = 0.01
"""Smallest scale of a residual, over the largest value measured."""
PEAK = 0.886
"""mu at the maximum over depth/half length at rest: parabola, dead weight, Kelvin-Voigt (F3)."""
DECADES = 3, 18
"""Range of stiffnesses (N/m^3 or Pa, in powers of ten) in which the first guess is searched for."""
WIDE = {
    "stiffness": (1e-4, 1e2),
    "time": (1e-2, 1e2),
    "arm": (1e-2, 1e3),
    "other": (1e-2, 1e2),
    "offset": (1e-3, 1.0),
}
"""Ranges that are searched, over the first guess: below it and above it."""
FREE = 1e3
"""Factor beyond these ranges to which an unknown may go."""
ORDER = 0.05, 1.0
"""Range of the order of a springpot."""
TRIED, SOME = {False: (6, 8, 10), True: (4, 5, 7)}, 16
"""Points that are tried for one, two and more unknowns (as powers of two), of steady sliding and of a time
series, and rows of the data at most."""
ROUNDS = {False: ((48, 6), (16, 10), (12, 15), (12, 200)), True: ((6, 6), (3, 12), (3, 40))}
"""How many of the best points are refined, and by how many steps, in each round; likewise."""
USUAL_STEPS = 30
"""Steps that a descent to the end takes, about, to tell how much of the work is done."""
NEIGHBOURS = 8
"""Nearest neighbours above which a point has to be the best of its part of the range."""
APART = 0.1
"""Least difference of ln of an unknown between two points that are both refined."""
LOOSE = 4.0
"""Rise of the sum of squares over that of 95 % up to which a point is refined in the last round."""
REWEIGHED, SAME = 3, 0.05
"""Times that columns are weighed by their scatter at most, and relative change of weights that ends it."""
FINE, COARSE = 1e-7, 1e-3
"""Tolerances of the transient for the result, and for the search or where theory is less precise."""
STEP = {0.0: 1e-5, FINE: 1e-3, COARSE: 3e-2}
"""Change of ln of an unknown for slopes, by the tolerance of theory; 0 is steady sliding."""
PRECISION = {0.0: 0.0, FINE: 1e-6, COARSE: 1e-3}
"""Step of ln of an unknown at which a descent ends, likewise."""
MOST_ARMS = 3
"""Most arms of the models that are weighed: friction over velocity tells hardly more."""
SHAPED = "retardation_time", "order", "damping"
"""Quantities that belong to one law of the foundation."""
FAILED = 1e3
"""Residual where theory has no answer."""


@dataclass(frozen=True)
class Problem:
    """A scene, its free keys, data and theory; `memory` holds transients by data set and unknowns."""

    scene: Scene
    keys: tuple[str, ...]
    data: tuple[Data, ...]
    solve: Solve
    follow: Follow | None = None
    weights: Any = 1.0
    precise: bool = True
    rough: bool = False
    memory: dict[Any, dict[str, Array]] = field(default_factory=dict, compare=False)

    @cached_property
    def rtol(self) -> float:
        """The tolerance of the transient; 0 where there is no time series."""
        if all(data.time is None for data in self.data):
            return 0.0
        return COARSE if self.rough or not self.precise else FINE

    @property
    def costly(self) -> bool:
        """Whether there is a time series, which takes milliseconds for each point."""
        return self.rtol > 0.0

    @property
    def step(self) -> float:
        """The change of ln of an unknown for slopes."""
        return STEP[self.rtol]

    def theory(self, points: Array) -> list[dict[str, Array]]:
        """Return what is measured, of unknowns in rows, a column for each row; NaN without an answer."""
        return [self._values(i, points) for i in range(len(self.data))]

    def _values(self, i: int, points: Array) -> dict[str, Array]:
        data, shape = self.data[i], (len(points), self.data[i].size)
        if data.time is None or len(points) == 1:
            over = {key: np.exp(points[:, [k]]) for k, key in enumerate(self.keys)}
            try:
                found = self._steady(data, over) if data.time is None else self._over_time(i, over)
                return {name: np.broadcast_to(values, shape) for name, values in found.items()}
            except (ValueError, ArithmeticError, RuntimeError):
                if len(points) == 1:
                    return {name: np.full(shape, np.nan) for name in data.measured}
        rows = [self._values(i, point[None]) for point in points]
        return {name: np.concatenate([row[name] for row in rows]) for name in data.measured}

    def _steady(self, data: Data, over: Mapping[str, Array]) -> dict[str, Array]:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            state = self.solve(self.of({**data.conditions, **over}))
        found = {name: getattr(state, name) for name in data.measured}
        return self._lifted(found, over, np.sign(data.conditions["drive.velocity"]), state.load)

    def of(self, values: Mapping[str, Any]) -> Scene:
        """Return the scene with quantities by key; the offset is none of it."""
        return self.scene.replace({key: value for key, value in values.items() if key != OFFSET})

    def _lifted(
        self, found: dict[str, Any], over: Mapping[str, Any], sign: Any, load: Any
    ) -> dict[str, Any]:
        """Return what theory gives, with the offset in friction."""
        if OFFSET in over:
            for name, factor in (("friction_coefficient", 1.0), ("friction_force", load)):
                if name in found:
                    found[name] = found[name] + over[OFFSET] * sign * factor
        return found

    def _over_time(self, i: int, over: Mapping[str, Array]) -> dict[str, Array]:
        """Return the means of the transient over the bins of a time series."""
        data, own = self.data[i], {key: float(value.item()) for key, value in over.items()}
        place = i, *own.values()
        if place not in self.memory:
            nodes, at = data.nodes
            scene = self.of({**data.conditions, "run.duration": float(nodes[-1]), **own})
            found = dict(self.follow(scene, nodes, self.rtol))  # type: ignore[misc]
            self._lifted(found, own, np.sign(speeds(scene, nodes)), found["normal_force"])
            self.memory[place] = {name: found[name][at].mean(axis=0) for name in data.measured}
        return self.memory[place]

    @property
    def some(self) -> "Problem":
        """The same problem on some rows of the data, within coarse tolerances."""
        parts = tuple(each.part(-(-each.size // SOME)) for each in self.data)
        return replace(self, data=parts, rough=True, memory={})

    def columns(self, points: Array) -> list[Array]:
        """Return the relative residuals of each column measured, times its weights, of unknowns in rows."""
        return [
            np.nan_to_num(relative(data, name, own[name]) * data.weight, nan=FAILED)
            for data, own in zip(self.data, self.theory(points), strict=True)
            for name in data.measured
        ]

    def count(self, point: Array) -> float:
        """Return the number of residuals; those relative to the floor scatter less, and count in part."""
        count = 0.0
        for data, own in zip(self.data, self.theory(point[None]), strict=True):
            for name, values in data.measured.items():
                share = np.abs(own[name][0] * values) / (FLOOR * np.abs(values).max()) ** 2
                count += data.size if data.time is not None else np.minimum(share, 1.0).sum()
        return float(count)

    def residuals(self, points: Array) -> Array:
        """Return the residuals of unknowns in rows, times the weights."""
        return np.concatenate(self.columns(points), axis=1) * self.weights

    def sloped(self, points: Array, *, central: bool = False) -> tuple[Array, Array]:
        """Return the residuals, and their derivatives by the unknowns, along the last axis."""
        return sloped(self.residuals, points, step=self.step, central=central)

    def weighed(self, point: Array) -> "Problem":
        """Return the problem in which each column has the weight of its scatter at a point."""
        columns = [column[0] for column in self.columns(point[None])]
        if len(columns) == 1:
            return self
        sizes = np.array([np.sqrt(np.mean(column * column)) for column in columns])
        scatter = np.maximum(sizes, FLOOR * sizes.max() + np.finfo(float).tiny)
        parts = [np.full(c.size, scatter.min() / s) for c, s in zip(columns, scatter, strict=True)]
        return replace(self, weights=np.concatenate(parts))

    @cached_property
    def ranges(self) -> Array:
        """The range of ln of each unknown that is searched, in rows."""
        stiff, time = self._guess()
        rows = []
        for key in self.keys:
            name = key.rpartition(".")[2]
            if key in STIFF:
                row = stiff * np.array(WIDE["stiffness"])
            elif ".arms[" in key and name != "relaxation_time":
                row = stiff * np.array(WIDE["arm"])
            elif name in {"retardation_time", "relaxation_time"}:
                row = time * np.array(WIDE["time"])
            elif key == "foundation.damping":
                row = stiff * time * np.array(WIDE["time"])
            elif name == "order":
                row = np.array(ORDER)
            elif key == OFFSET:
                row = self._largest() * np.array(WIDE["offset"])
            else:
                row = np.asarray(self.scene.values()[key]) * np.array(WIDE["other"])
            rows.append(row)
        return np.log(np.array(rows))

    @property
    def limits(self) -> tuple[Array, Array]:
        """The least and the largest ln of each unknown."""
        low, high = self.ranges.T
        orders = [key.endswith(".order") for key in self.keys]
        return low - math.log(FREE), np.where(orders, 0.0, high + math.log(FREE))

    @cached_property
    def passage(self) -> Array:
        """The times in which half a contact is passed, at the largest and at the smallest speed."""
        return self._guess()[1]

    def _guess(self) -> tuple[float, Array]:
        """Return the stiffness (or modulus) of the foundation and the times of the data, by fact F26."""
        scene, data = self.scene, self.some.data[0]
        key = STIFF[0] if scene.foundation.modulus is None else STIFF[1]
        still = {**data.conditions, "drive.velocity": 0.0}
        first = float(scene.values()[key])
        tried = np.logspace(*DECADES, 2 * (DECADES[1] - DECADES[0]) + 1)
        for name in [n for n in ("load", "normal_force", "depth", *FRICTION) if n in data.measured]:
            off = [self._expected(name, {**still, key: K}) for K in tried if key in self.keys]
            off = np.log(np.array(off) / np.abs(self.data[0].measured[name]).max())
            if off.size and np.nanmax(off) - np.nanmin(off) > 1.0:  # else it does not depend on it
                first = float(tried[np.nanargmin(np.abs(off))])
                break
        if scene.depths:  # it need not slide
            time = np.hstack([each.time for each in self.data if each.time is not None])
            return first, np.array([time[time > 0.0].min(), time.max()])
        a = np.mean(self.solve(scene.replace({**still, key: first})).half_length)
        speeds = [
            each.conditions["drive.velocity"]
            if each.time is None
            else largest_speed(scene, each.time)
            for each in self.data
        ]
        V = np.abs(np.hstack(speeds))
        moving = V[V > 0.0]
        return first, a / np.array([moving.max(), moving.min()])

    def _largest(self) -> float:
        """Return the largest friction coefficient that was measured, about."""
        for data in self.data:
            if "friction_coefficient" in data.measured:
                return float(np.abs(data.measured["friction_coefficient"]).max())
        still = {**self.data[0].conditions, "drive.velocity": 0.0}
        forces = [
            each.measured["friction_force"]
            for each in self.data
            if "friction_force" in each.measured
        ]
        return float(max(np.abs(force).max() for force in forces)) / self._expected("load", still)

    def _expected(self, name: str, still: Mapping[str, Any]) -> float:
        """Return the load or depth at rest, or an estimate of the largest friction; NaN without contact."""
        try:
            state = self.solve(self.scene.replace(still))
        except (ValueError, ArithmeticError, RuntimeError):
            return math.nan
        mu = PEAK * state.depth / state.half_length
        static = {"friction_coefficient": mu, "depth": state.depth, "load": state.load}
        static["normal_force"] = state.load
        return float(np.mean(static.get(name, mu * state.load)))


def relative(data: Data, name: str, found: Array) -> Array:
    """Return the relative residuals of a column measured.

    Over velocity relative to the geometric mean of data and theory, without bias; over time to the root mean
    square.
    """
    values = data.measured[name]
    scale: Any = np.sqrt(np.mean(values * values))
    if data.time is None:
        scale = np.maximum(np.sqrt(np.abs(found * values)), FLOOR * np.abs(values).max())
    return np.asarray((found - values) / scale)


def solve(
    problem: Problem, seed: int = 0, report: Report | None = None, *, share: float = 1.0
) -> tuple[Problem, Fit]:
    """Return the problem with the weights of its columns, and the minima of its sum of squares.

    With a `share` of the points below 1, other minima than the lowest may be missed.
    """
    low, high = problem.ranges.T
    least, most = problem.limits
    tried, rounds = TRIED[problem.costly], ROUNDS[problem.costly]
    unit = qmc.Sobol(low.size, seed=seed).random_base2(tried[min(low.size, len(tried)) - 1])
    some, points = problem.some, qmc.scale(unit, low, high)
    score = np.sum(np.arctan(some.residuals(points)) ** 2, axis=1)
    points = points[_starts(unit, score, min(rounds[0][0], 4 * low.size**2))]

    def descended(of: Problem, points: Array, steps: int) -> tuple[Array, Array]:
        how: Any = {"step": of.step, "costly": of.costly, "precision": PRECISION[of.rtol]}
        found, score = descend(of.residuals, points, least, most, steps, **how)
        return _apart(_sorted(found, of.keys), score)

    work = np.cumsum(
        [
            len(unit),
            *((low.size + 1) * points * min(steps, USUAL_STEPS) for points, steps in rounds),
        ]
    )
    for done, (most_points, steps) in enumerate(rounds):
        if report:
            report(float(work[done] / work[-1]))
        last = done + 1 == len(rounds)
        if last:
            points = points[score <= _plausible(some if problem.costly else problem, score[0])]
        near = some if problem.costly and not last else problem
        count = math.ceil(share * min(most_points, 4 * low.size**2))
        points, score = descended(near, points[:count], steps)
    for _ in range(REWEIGHED):
        before, problem = problem.weights, problem.weighed(points[0])
        if np.allclose(problem.weights, before, rtol=SAME, atol=0.0):
            break
        points, score = descended(problem, points, rounds[-1][1])
    point = points[0]
    if (np.concatenate(problem.columns(point[None]), axis=1) == FAILED).all():
        message = f"theory has no answer for any value of {', '.join(problem.keys)} that was tried"
        raise ValueError(f"{problem.data[0].source}: {message}; check the scene")
    r, J = problem.sloped(point[None], central=True)
    return problem, Fit(point, r[0], J[0], problem.count(point), points)


def _starts(unit: Array, score: Array, count: int) -> list[int]:
    """Return the places of so many points of a cube: those better than their neighbours, and the best of all.

    Topographical global optimization: Törn and Viitanen (1992).
    """
    near = cKDTree(unit).query(unit, NEIGHBOURS + 1)[1][:, 1:]
    lowest, order = (score[:, None] < score[near]).all(axis=1), np.argsort(score)
    half = order[lowest[order]][: count // 2]
    return list(dict.fromkeys([*half.tolist(), *order[: count - half.size].tolist()]))


def _plausible(problem: Problem, least: float) -> float:
    """Return the sum of squares up to which a point may be a minimum that the data allow."""
    freedom = sum(each.size * len(each.measured) for each in problem.data) - len(problem.keys)
    return least * (1.0 + LOOSE * student(freedom) ** 2 / max(freedom, 1))


def _apart(points: Array, score: Array) -> tuple[Array, Array]:
    """Return points with the best one first, without those that are near a better one."""
    order = np.argsort(score, kind="stable")
    near = cdist(points[order], points[order], "chebyshev") < APART
    kept: list[int] = []
    for i in range(order.size):
        if not near[i, kept].any():
            kept.append(i)
    return points[order[kept]], score[order[kept]]


def _sorted(points: Array, keys: Sequence[str]) -> Array:
    """Return points with the arms by increasing time, if all are free: their order means nothing."""
    arms = [i for i, key in enumerate(keys) if ".arms[" in key]
    times = [i for i in arms if keys[i].endswith("relaxation_time")]
    others = [i for i in arms if not keys[i].endswith("relaxation_time")]
    if arms and [keys[i].rpartition(".")[0] for i in times] == [
        keys[i].rpartition(".")[0] for i in others
    ]:
        order = np.argsort(points[:, times], axis=1)
        for own in (times, others):
            points[:, own] = np.take_along_axis(points[:, own], order, axis=1)
    return points


def information(problem: Problem, found: Fit) -> float:
    """Return Akaike's criterion AICc of a model, each column with its own scatter; the lower, the better."""
    columns = [column[0] for column in problem.columns(found.point[None])]
    n, k = found.residuals.size, found.point.size + len(columns)
    if n <= k + 1:
        return math.inf
    least = np.finfo(float).eps ** 2
    fit = sum(c.size * math.log(max(float(c @ c) / c.size, least)) for c in columns)
    return fit + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0)


def models(scene: Scene) -> dict[str, tuple[Scene, tuple[str, ...]]]:
    """Return the scene on each foundation that is weighed against the others, and the free keys."""
    old = scene.foundation
    layer = old.modulus is not None
    stiff, arm = (STIFF[1], "modulus") if layer else (STIFF[0], "stiffness")
    own = {name: as_given(getattr(old, name)) for name in given(old) if name not in SHAPED}
    size = float(scene.values()[stiff])
    others = ("wlf", "shift_factors", "stiffness_from")
    own |= {name: held for name in others if (held := getattr(old, name)) is not None}
    found: dict[str, Any] = {
        "kelvin-voigt": (Foundation(**own, retardation_time=1.0), ["retardation_time"]),
        "springpot": (
            FractionalKelvinVoigt(**own, retardation_time=1.0, order=0.5), ["retardation_time", "order"]
        ),
    }  # fmt: skip
    for count in range(1, MOST_ARMS + 1):
        arms = [(size, 10.0**i) for i in range(count)]
        keys = [f"arms[{i}].{name}" for i in range(count) for name in (arm, "relaxation_time")]
        found[f"{count} arm{'s' * (count > 1)}"] = GeneralizedMaxwell(**own | {"arms": arms}), keys
    return {
        name: (replace(scene, foundation=each), (stiff, *(f"foundation.{key}" for key in keys)))
        for name, (each, keys) in found.items()
    }
