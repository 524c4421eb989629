"""Quantities of a scene from measured friction: least squares over the exact theory of steady sliding.

Unknowns are logarithms. The first guess needs no help: the maximum of the measured friction gives the
stiffness of the foundation, and the velocities its times (fact F26); many points around them are tried at
once, as theory takes arrays, and the best ones are refined. The covariance is that of the linear theory at
the minimum. A direction of the unknowns that the data leave open by more than a factor of two is reported
by its keys.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from kvtheory.fitting.tables import Reader, Table, named
from kvtheory.scene.files import SECTIONS
from kvtheory.scene.foundations import Foundation, FractionalKelvinVoigt, GeneralizedMaxwell
from kvtheory.scene.mistakes import nearest
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import as_given, given
from kvtheory.scene.tables import parts

Array = NDArray[np.float64]
Solve = Callable[[Scene], Any]
"""Returns steady sliding of the scenes of arrays."""

CONDITIONS = {
    "drive.velocity": "V, v, velocity, speed, sliding velocity, drive velocity, Geschwindigkeit",
    "load": "W, load, F_z, F_n, normal force, normal load, Last, Normalkraft",
    "depth": "depth, delta, δ, indentation, indentation depth, Eindringtiefe",
    "indenter.radius": "R, radius",
    "foundation.temperature": "T, temp, temperature, Temperatur",
}
MEASURED = {
    "friction_coefficient": "mu, μ, µ, friction coefficient, COF, Reibungszahl, Reibwert",
    "friction_force": "F_x, F_t, F, friction, friction force, tangential force, Reibkraft, Reibungskraft",
}
STATIC = {"load": "support.load", "depth": "support.depth"}
"""The keys of a support that are conditions if it has them; on other supports they are measured too."""
STIFF = "foundation.stiffness", "foundation.modulus"
"""The keys of the stiffness of the foundation: its own, or that of a layer."""
FLOOR = 0.01
"""Smallest scale of a residual, over the largest value measured."""
PEAK = 0.886
"""mu at the maximum over depth/half length at rest, for a parabola under a dead weight on Kelvin-Voigt
(F3)."""
DECADES = 3, 18
"""Range of stiffnesses (N/m^3 or Pa, in powers of ten) in which the first guess is searched for."""
WIDE = {"stiffness": (1e-4, 1e2), "time": (1e-2, 1e2), "arm": (1e-2, 1e3), "other": (1e-2, 1e2)}
"""Ranges that are searched, over the first guess: below it and above it."""
FREE = 1e3
"""Factor beyond these ranges to which an unknown may go."""
ORDER = 0.05, 1.0
"""Range of the order of a springpot."""
TRIED, SOME = (6, 8, 10), 16
"""Points that are tried for one, two and more unknowns (as powers of two), and rows of the data at most."""
ROUNDS = (32, 6), (12, 10), (4, 15), (1, 200)
"""How many of the best points are refined, and by how many steps, in each round."""
SETTLED, MOST_DAMPING, LONGEST = 1e-10, 1e8, 2.0
"""Gain of a step and damping at which a refinement ends, and the longest step of ln of an unknown."""
SINGULAR = 1e-9
"""Smallest singular value, over the largest, that is distinguished from zero."""
STEP = 1e-5
"""Change of ln of an unknown for slopes by central differences, whose error is about 1e-10."""
OPEN = math.log(2.0)
"""Standard error of ln of a combination of unknowns from which the data do not tell it."""
SHARE = 0.2
"""Part of a key in an open direction, over the largest, from which it belongs to it."""
MOST_ARMS = 3
"""Most arms of the models that are weighed: friction over velocity tells hardly more."""
SHAPED = "retardation_time", "order"
"""Quantities that belong to one law of the foundation."""
PRECISE = 1e-8
"""Precision of slopes: scatter below it cannot be told from none."""
FAILED = 1e3
"""Residual where theory has no answer."""


class Data(NamedTuple):
    """Conditions by key of the scene, and measured quantities, in SI, a value for each row."""

    source: str
    conditions: Mapping[str, Array]
    measured: Mapping[str, Array]
    notes: tuple[str, ...]

    @property
    def size(self) -> int:
        """The number of rows."""
        return self.conditions["drive.velocity"].size


def read(data: Any, scene: Scene) -> Data:
    """Return a table of friction over velocity, whose other columns are conditions named as in a scene."""
    keys = scene.replaceable
    spelt = {key: key for key in keys} | {
        name: f"{name}, {own}" for name, own in CONDITIONS.items()
    }
    names = named(spelt | MEASURED)
    reader = Reader(
        names, lambda found: "drive.velocity" in found and bool(found & set(MEASURED)),
        "a row such as V [mm/s],mu",
    )  # fmt: skip
    table = reader.read(data)
    conditions, measured = {}, {}
    for name in table.columns:
        key = STATIC.get(name, name)
        if key in keys:
            spec = keys[key]
            values = table.number(name) if spec.unit == "1" else table.si(name, spec.dimension)[0]
            table.require(name, _admitted(spec, values), f"is out of range; expected {spec.range}")
            conditions[key] = values
        elif name in MEASURED or name in STATIC:
            measured[name] = _measured(table, name, scene)
        else:
            raise table.error(name, f"is not of this scene; {nearest(name, keys)}")
    if not np.any(conditions["drive.velocity"]):
        raise table.error("drive.velocity", "is zero throughout; friction needs sliding")
    for name, values in measured.items():
        if not np.any(values):
            raise table.error(name, "is zero throughout; there is nothing to fit")
    for head in table.ignored:
        if head.partition(".")[0] in SECTIONS:
            raise ValueError(f'{table.source}: column "{head}": {nearest(parts(head)[0], keys)}')
    notes = [f"Column {head} is not used." for head in table.ignored]
    if len(measured.keys() & MEASURED.keys()) > 1:
        notes.append("The friction coefficient is used, and not the friction force.")
        del measured["friction_force"]
    return Data(table.source, conditions, measured, tuple(notes))


def _admitted(spec: Any, values: Array) -> NDArray[np.bool_]:
    return np.array([spec.admits(float(value)) for value in values])


def _measured(table: Table, name: str, scene: Scene) -> Array:
    if name == "friction_coefficient":
        return table.number(name)
    force = "N/m" if scene.indenter.per_width else "N"
    return table.si(name, "m" if name == "depth" else force)[0]


@dataclass(frozen=True)
class Problem:
    """A scene, its free quantities, the data, and the theory."""

    scene: Scene
    keys: tuple[str, ...]
    data: Data
    solve: Solve

    def theory(self, points: Array) -> Mapping[str, Array]:
        """Return what is measured, of unknowns in rows, a column for each row of the data.

        NaN where theory has no answer.
        """
        over = {key: np.exp(points[:, [i]]) for i, key in enumerate(self.keys)}
        try:
            with np.errstate(over="raise", invalid="raise", divide="raise"):
                state = self.solve(self.scene.replace({**self.data.conditions, **over}))
        except (ValueError, ArithmeticError, RuntimeError):
            if len(points) == 1:
                return {
                    name: np.full((1, v.size), np.nan) for name, v in self.data.measured.items()
                }
            rows = [self.theory(point[None]) for point in points]
            return {
                name: np.concatenate([row[name] for row in rows]) for name in self.data.measured
            }
        shape = len(points), self.data.size
        return {name: np.broadcast_to(getattr(state, name), shape) for name in self.data.measured}

    @property
    def some(self) -> "Problem":
        """The same problem on some rows of the data."""
        part = slice(None, None, -(-self.data.size // SOME))
        conditions, measured = (
            {name: values[part] for name, values in columns.items()}
            for columns in (self.data.conditions, self.data.measured)
        )
        return replace(self, data=self.data._replace(conditions=conditions, measured=measured))

    def residuals(self, points: Array) -> Array:
        """Return the residuals of unknowns in rows, relative to the geometric mean of data and theory.

        Residuals relative to the data alone would bias the fit.
        """
        rows = []
        own = self.theory(points)
        for name, values in self.data.measured.items():
            scale = np.sqrt(np.abs(own[name] * values))
            rows.append((own[name] - values) / np.maximum(scale, FLOOR * np.abs(values).max()))
        return np.nan_to_num(np.concatenate(rows, axis=1), nan=FAILED)

    def slopes(self, points: Array, *, central: bool = False) -> Array:
        """Return the derivatives of the residuals by the unknowns, along the last axis; points in rows."""
        count, size = points.shape
        steps = STEP * (np.concatenate([np.eye(size), -np.eye(size)]) if central else np.eye(size))
        moved = self.residuals((points[:, None] + steps).reshape(-1, size)).reshape(
            count, len(steps), -1
        )
        other = moved[:, size:] if central else self.residuals(points)[:, None]
        return (moved[:, :size] - other).swapaxes(1, 2) / ((2.0 if central else 1.0) * STEP)

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
            elif name == "order":
                row = np.array(ORDER)
            else:
                row = np.asarray(self.scene.values()[key]) * np.array(WIDE["other"])
            rows.append(row)
        return np.log(np.array(rows))

    def _guess(self) -> tuple[float, Array]:
        """Return the stiffness (or modulus) of the foundation and the times of the data, by fact F26."""
        scene, measured = self.scene, self.data.measured
        key = STIFF[0] if scene.foundation.modulus is None else STIFF[1]
        still = {**self.some.data.conditions, "drive.velocity": 0.0}
        first = float(scene.values()[key])
        if key in self.keys:
            name = next(name for name in ("load", *reversed(MEASURED)) if name in measured)
            tried = np.logspace(*DECADES, 2 * (DECADES[1] - DECADES[0]) + 1)
            off = [self._expected(name, {**still, key: K}) for K in tried]
            off = np.log(np.array(off) / np.abs(measured[name]).max())
            if np.nanmax(off) - np.nanmin(off) > 1.0:  # else it does not depend on the stiffness
                first = float(tried[np.nanargmin(np.abs(off))])
        a = np.mean(self.solve(scene.replace({**still, key: first})).half_length)
        V = np.abs(self.data.conditions["drive.velocity"])
        moving = V[V > 0.0]
        return first, a / np.array([moving.max(), moving.min()])

    def _expected(self, name: str, still: Mapping[str, Any]) -> float:
        """Return the load at rest, or an estimate of the largest friction; NaN where there is no contact."""
        try:
            state = self.solve(self.scene.replace(still))
        except (ValueError, ArithmeticError, RuntimeError):
            return math.nan
        mu = PEAK * state.depth / state.half_length
        kinds = {"load": state.load, "friction_force": mu * state.load, "friction_coefficient": mu}
        return float(np.mean(kinds[name]))


class Solved(NamedTuple):
    """The best unknowns (ln), the residuals there, and their slopes."""

    point: Array
    residuals: Array
    slopes: Array

    @property
    def variance(self) -> float:
        """The variance of a residual, by the degrees of freedom."""
        free = max(self.residuals.size - self.point.size, 1)
        return float(self.residuals @ self.residuals) / free

    @property
    def covariance(self) -> Array:
        """The covariance of ln of the unknowns; huge in directions that the data leave open.

        Where they leave none open it allows for scatter that varies (HC3: MacKinnon and White, 1985).
        """
        _, s, V = np.linalg.svd(self.slopes, full_matrices=False)
        inverse = np.einsum("ki,k,kj->ij", V, np.maximum(s, SINGULAR * s[0]) ** -2.0, V)
        if self.open(range(self.point.size)):
            return inverse * self.variance
        gain = np.einsum("ni,ij->nj", self.slopes, inverse)
        left = np.maximum(1.0 - np.einsum("ni,ni->n", gain, self.slopes), 1.0 / self.residuals.size)
        return np.einsum("ni,n,nj->ij", gain, (self.residuals / left) ** 2, gain)

    def open(self, keys: Sequence[Any]) -> list[list[Any]]:
        """Return the keys of each combination of unknowns that the data leave open."""
        _, s, V = np.linalg.svd(self.slopes, full_matrices=False)
        deviation = max(math.sqrt(self.variance), PRECISE)
        directions = np.abs(V[deviation >= OPEN * np.maximum(s, SINGULAR * s[0])])
        return [
            [key for key, part in zip(keys, row, strict=True) if part > SHARE * row.max()]
            for row in directions
        ]


def solve(problem: Problem, seed: int = 0) -> Solved:
    """Return the minimum of the sum of squares over the whole range."""
    low, high = problem.ranges.T
    points = qmc.scale(
        qmc.Sobol(low.size, seed=seed).random_base2(TRIED[min(low.size, len(TRIED)) - 1]), low, high
    )
    score = np.sum(np.arctan(problem.some.residuals(points)) ** 2, axis=1)
    beyond = math.log(FREE)
    most = np.where([key.endswith(".order") for key in problem.keys], 0.0, high + beyond)
    for count, steps in ROUNDS:
        best = points[np.argsort(score)[: min(count, 4 * low.size**2)]]
        points, score = _descended(problem, best, low - beyond, most, steps)
    point = _sorted(points, problem.keys)
    r = problem.residuals(point)[0]
    return Solved(point[0], r, problem.slopes(point, central=True)[0])


def _descended(
    problem: Problem, points: Array, low: Array, high: Array, steps: int
) -> tuple[Array, Array]:
    """Return points after Levenberg's and Marquardt's method, all at once, and their sums of squares."""
    r = problem.residuals(points)
    cost, damping = np.einsum("si,si->s", r, r), np.full(len(points), 1e-2)
    active = np.full(len(points), True)
    for _ in range(steps):
        J = problem.slopes(points[active])
        curve, slope = np.einsum("sni,snj->sij", J, J), np.einsum("sni,sn->si", J, r[active])
        size = np.einsum("sii->si", curve)
        size = np.maximum(size, SINGULAR * size.max(axis=1, keepdims=True) + np.finfo(float).tiny)
        curve = curve + damping[active, None, None] * size[:, :, None] * np.eye(low.size)
        move = np.linalg.solve(curve, -slope[..., None])[..., 0]
        tried = np.clip(points[active] + np.clip(move, -LONGEST, LONGEST), low, high)
        new = problem.residuals(tried)
        total = np.einsum("si,si->s", new, new)
        better = total < cost[active]
        gain = np.where(better, 1.0 - total / cost[active], 1.0)
        at = np.flatnonzero(active)
        points[at[better]], r[at[better]], cost[at[better]] = (
            tried[better],
            new[better],
            total[better],
        )
        damping[at] *= np.where(better, 0.2, 5.0)
        active[at] = (gain > SETTLED) & (damping[at] < MOST_DAMPING)
        if not active.any():
            break
    return points, cost


def _sorted(points: Array, keys: Sequence[str]) -> Array:
    """Return points with the arms by increasing time, if all are free: their order means nothing."""
    arms = [i for i, key in enumerate(keys) if ".arms[" in key]
    times = [i for i in arms if keys[i].endswith("relaxation_time")]
    others = [i for i in arms if not keys[i].endswith("relaxation_time")]
    if arms and [keys[i].rpartition(".")[0] for i in times] == [
        keys[i].rpartition(".")[0] for i in others
    ]:
        order = np.argsort(points[0, times])
        points[:, times], points[:, others] = (
            points[:, times][:, order],
            points[:, others][:, order],
        )
    return points


def information(found: Solved) -> float:
    """Return Akaike's criterion AICc of a model; the lower, the better."""
    n, k = found.residuals.size, found.point.size + 1
    if n <= k + 1:
        return math.inf
    mean = max(float(found.residuals @ found.residuals) / n, np.finfo(float).eps ** 2)
    return n * math.log(mean) + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0)


def models(scene: Scene) -> dict[str, tuple[Scene, tuple[str, ...]]]:
    """Return the scene on each foundation that is weighed against the others, and the free keys."""
    old = scene.foundation
    layer = old.modulus is not None
    stiff, arm = (STIFF[1], "modulus") if layer else (STIFF[0], "stiffness")
    own = {name: as_given(getattr(old, name)) for name in given(old) if name not in SHAPED}
    size = float(scene.values()[stiff])
    own |= {} if old.wlf is None else {"wlf": old.wlf}
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
