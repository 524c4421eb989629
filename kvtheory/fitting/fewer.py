r"""A Prony series with fewer arms instead of another one, and by how much friction may change (fact F27).

P - Q and 12 E are integrals of -g'(w) over the contact, 0 < w < 1, with the weights w (1 - w) and w (1 -
w)^2 (1 + w/2); P, Q and D add g(1) to such integrals. All weights are positive, and for w <= w_1 between (1
- w_1)^2 and 1 times w or w^2. Let another series H with the same K have within the factors 1 - eps and 1 +
eps

    -H'(t) of -G'(t) from t_1 on, up to the longest contact time c/V, and H - K of G - K there,
    the integrals of -H' t and -H' t^2 from 0 to t_1 of those of -G' (faster arms are dampers),

where t_1 is w_1 times the shortest contact time. Then, with eps' = (1 + eps)/(1 - w_1)^2 - 1 for eps, all
five moments are within these factors at an equal length of the contact. With r = (1 + eps)/(1 - eps) and
eta = (P - Q)/(2 (P + Q)) that gives

    1/r <= eta_H/eta_G <= r,   1/r <= W_H/W_G <= r,   1/r^2 <= F_H/F_G <= r^2,

as W = (c^3/R)(D + eta P), F = (c^4/R^2)(E + eta^2 P), eta P = (P - Q)(1/2 + eta)/2 and (1 + r)/2 = 1/(1 -
eps); a damper beside the arms adds the same to P, P - Q and E of both. Load and friction grow with c: p
vanishes at the trailing edge, so that only the growth of a contributes, and

    dF/dc = (a'/R^2) (a - c/2) int int G(|X - s|/V) dX ds >= 0.

So the contact of H under the load W is no longer than that of G under r W and no shorter than under W/r,
and

    F_G(W/r)/r^2 <= F_H(W) <= r^2 F_G(r W);

at a given depth likewise between the half lengths (1 - eps) a and (1 + eps) a. What bounds friction is thus
the exact friction of G itself.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.special import gammainc

from kvtheory.fitting.spectrum import Array, Moduli, Series, fewer, refined
from kvtheory.scene.foundations import Arm, GeneralizedMaxwell
from kvtheory.scene.model import Scene

PER_DECADE = 16
"""Times per decade at which slopes are compared, and at which arms are tried."""
MARGIN = 1.5
"""Factor of times beyond the contact at which slopes count: under r W it is r^2 times as long at most."""
EARLY = 0.01
"""w_1 over the tolerance."""
LATEST = 60.0
"""Multiple of the longest relaxation time after which nothing is left to compare: e^-60 = 1e-26."""


@dataclass(frozen=True)
class Slopes(Moduli):
    """-G'(t) of a Prony series as data, and G - K at the last time, in the scale of themselves."""

    stiffness: Array
    time: Array

    @classmethod
    def of(cls, stiffness: Array, time: Array, shortest: float, longest: float) -> "Slopes":
        """Return the slopes between two times, and the integrals before and after."""
        count = int(np.log10(longest / shortest) * PER_DECADE) + 3
        x = np.geomspace(shortest, longest, count)
        x = np.concatenate([x, [shortest, shortest, longest]])
        return cls(x, np.ones((1, x.size)), stiffness, time)

    def kernel(self, tau: Array) -> Array:
        """Return the rows of arms of stiffness 1 over those of the series; a spring has none."""
        return self._rows(tau)[0] / self._own[:, None]

    def slopes(self, tau: Array) -> Array:
        """Return the derivatives of `kernel` by ln tau."""
        return self._rows(tau)[1] / self._own[:, None]

    @cached_property
    def _own(self) -> Array:
        return np.asarray(np.einsum("ij,j->i", self._rows(self.time)[0], self.stiffness))

    def _rows(self, tau: Array) -> tuple[Array, Array]:
        """Return -G', both early integrals and G - K at the end, and the derivatives by ln tau."""
        finite = np.where(np.isinf(tau), 1.0, tau)
        z = np.where(np.isinf(tau), np.inf, self.x[:, None] / finite)
        fall = np.exp(-z)
        slope = np.where(fall > 0.0, fall * (np.where(fall > 0.0, z, 0.0) - 1.0), 0.0) / finite
        rows, rises = fall / finite, slope
        for row, n in ((-3, 2), (-2, 3)):  # incomplete Gamma functions, integrals of t and t^2
            size = math.factorial(n - 1) * finite ** (n - 1)
            part = gammainc(n, z[row])
            z_n = np.where(fall[row] > 0.0, np.where(fall[row] > 0.0, z[row], 0.0) ** n, 0.0)
            rows[row] = np.where(np.isinf(tau), 0.0, size * part)
            rises[row] = size * ((n - 1) * part - z_n * fall[row] / math.factorial(n - 1))
        rows[-1], rises[-1] = fall[-1], np.where(fall[-1] > 0.0, z[-1], 0.0) * fall[-1]
        return rows, rises

    @property
    def times(self) -> tuple[float, float]:
        """The shortest and the longest relaxation time of the series."""
        return float(self.time.min()), float(self.time.max())

    def deviation(self, series: Series) -> float:
        """Return eps, with twice what the curvature of the ratio adds between the times."""
        ratio = np.einsum("ij,j->i", self.kernel(series.time), series.modulus) - 1.0
        bend = float(np.abs(np.diff(ratio[:-3], 2)).max(initial=0.0))
        return float(np.abs(ratio).max()) + 0.25 * bend


class Fewer(NamedTuple):
    """The scene with fewer arms, eps, the bound on the change of mu, and its change, both relative."""

    scene: Scene
    deviation: float
    bound: float
    difference: float


def has_bound(scene: Scene) -> bool:
    """Whether the theorem holds for a scene: a parabola under a load or at a depth."""
    rigid = scene.held or scene.support.spring == 0.0
    return rigid and scene.indenter.shape == "parabola"


def bound(solve: Callable[[Scene], Any], scene: Scene, V: Array, eps: float) -> float:
    """Return by how much the friction coefficient at the velocities may change, relative to itself."""
    r = (1.0 + eps) / (1.0 - eps) if eps < 1.0 else math.inf
    if r * r > MARGIN:
        return math.inf
    key = "support.depth" if scene.held else "support.load"
    sides = np.array([(1.0 - eps) ** 2, 1.0, (1.0 + eps) ** 2] if scene.held else [1.0 / r, 1.0, r])
    size = scene.support.depth if scene.held else scene.support.weight
    low, mid, high = _friction(solve(scene.replace({key: (size * sides)[:, None]}).at(V)))
    F = low[0] / r**2, high[0] * r**2
    W = (low[1] / r, high[1] * r) if scene.held else (mid[1], mid[1])
    mu = mid[0] / mid[1]
    return float(max(np.max(F[1] / W[0] / mu) - 1.0, np.max(1.0 - F[0] / W[1] / mu)))


def _friction(state: Any) -> Any:
    return zip(np.abs(state.friction_force), state.load, strict=True)


def reduced(
    solve: Callable[[Scene], Any], scene: Scene, V: Array, rtol: float, *, proved: bool
) -> Fewer:
    """Return the scene with the fewest arms that keep mu, or its bound if `proved`, within `rtol`."""
    foundation: Any = scene.foundation
    size = np.array([arm.stiffness for arm in foundation.arms])
    time = np.array([arm.relaxation_time for arm in foundation.arms])
    moving, early = solve(scene.at(V)), EARLY * rtol
    ages = (moving.trailing_edge - moving.leading_edge) / V
    last = min(MARGIN * float(ages.max()), LATEST * float(time.max()))
    data = Slopes.of(size, time, min(early / MARGIN * float(ages.min()), 0.1 * last), last)
    order = np.argsort(time)
    line = has_bound(scene)
    best = Fewer(scene, 0.0, 0.0 if line else math.nan, 0.0)
    series = Series(0.0, size[order], time[order])
    while series.time.size > 1:
        series = refined(data, fewer(data, series, 0))
        eps = (1.0 + data.deviation(series)) / (1.0 - early) ** 2 - 1.0
        limit = bound(solve, scene, V, eps) if line else math.nan
        if proved and limit > rtol:
            break
        pairs = zip(series.modulus.tolist(), series.time.tolist(), strict=True)
        arms = tuple(Arm(*pair) for pair in pairs)
        own = GeneralizedMaxwell(+foundation.stiffness, arms=arms, damping=+foundation.damping)
        other = replace(scene, foundation=own)
        mu = solve(other.at(V)).friction_coefficient
        off = float(np.max(np.abs(mu / moving.friction_coefficient - 1.0)))
        if off > rtol:
            break
        best = Fewer(other, eps, limit, off)
    return best
