r"""Steady sliding of a convex shape on any linear viscoelastic foundation, by convolution.

With X the distance from the leading edge, where h = delta, and u' = -h' the rate of compression,

    p(X) = K u + sum over branches m(X) <u'>,   m = int_0^X g(s) ds,   g = G - K,

where <u'> is the mean of u' over the memory of the branch: with v = (int_0^s g)/m in (0, 1) the past is
u'(X - s(v)), however fast the branch relaxes, and the integrand has no boundary layer. The trailing edge is
the first zero of the pressure, and

    W = int u'(X) int_0^(c - X) G ds dX,   F = int u' p dX,   dW/d(delta) = int_0^c G dX,

as a greater depth adds a step of compression at the leading edge, which relaxes with G. There is one zero:
where p = 0 behind the lowest point, p' <= -|u'| G(X) < 0, because |u'| rises and G does not.
"""

import math
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq, minimize_scalar
from scipy.special import gamma

from kvtheory.models.steady.cells import ConvexProfile
from kvtheory.models.steady.contact import ConvexLine
from kvtheory.models.steady.double_exponential import (
    OF_LINE,
    RULES,
    Quantities,
    power_bounds,
    share_lost,
)
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Convex
from kvtheory.scene.model import Scene

Array = Any
"""Of floats."""
Shape = Convex | ConvexProfile


def _with_coarser(nodes: Array, weights: Array) -> tuple[Array, Array]:
    """Return nodes, and the weights of a rule, and of those of twice and four times its step."""
    from_middle = np.arange(nodes.size) - nodes.size // 2
    return nodes, np.array([*weights, np.where(from_middle % 4 == 0, 4.0 * weights[0], 0.0)])


USED = tuple(_with_coarser(*rule) for rule in RULES[2:4])
"""Double-exponential rules from 0 to 1."""
ENOUGH = 2e-14
"""Estimated error from which the finer rule is taken: next to a tip, where a strip bends."""
TERMS, FAR = 12, 12.0
"""Terms of the series of u' between two nodes, the last two of which are its error; relaxation lengths from
which on the recurrence of its moments is stable."""
_AT, _GAUSS = legendre.leggauss(TERMS + 2)
BEHIND = 0.5 - 0.5 * _AT
"""Nodes of Gauss's rule between two nodes, as shares of the way back from the second one."""
MOMENTS = 0.5 * _GAUSS[:, None] * legendre.legvander(_AT, TERMS - 1)
TO_SERIES = MOMENTS * (2.0 * np.arange(TERMS) + 1.0)
"""Matrices from values there to moments, and to coefficients of the series."""
ROOT, TINY = 8.9e-16, 1e-300
"""Tolerances of edges: all digits, however small they are."""
VERTEX = 1e-290
"""Distance behind the lowest point, over the half length, at which the pressure there is taken."""
STRIDE, PEAK_RTOL = 1e-6, 1e-6
"""Relative step of x for the slope of the pressure at its zero, and tolerance of the position of the peak
between two nodes; the error of its value is of second order."""
MARGIN, FLOOR, LIMIT = 8.0, 2e-13, 1e-6
"""Safety factor on the estimates of the rules, rounding, and error from which a result is refused."""
OF_WORK = "friction_force", "friction_coefficient", "dissipated_in_contact"
CANCELLED = 3.6e-15
"""Rounding, over the order of a springpot, of its work: most of it returns if the order is low."""
JUMP = 1e-6
"""Pressure at the trailing edge, over that of the depth, from which it is a jump."""


class Arms:
    """Maxwell arms K_i e^(-X/l_i), and a damper of the impulse l_C if there is one, over K.

    Of an arm m is the impulse up to X; a damper, the last branch, has all of it at once, and no memory.
    """

    noise = 0.0

    def __init__(self, stiffness: Array, length: Array, damper: float = 0.0) -> None:
        self.stiffness, self.length = (np.asarray(row)[:, None] for row in (stiffness, length))
        self.damper = np.full((1, 1), damper)[: int(damper > 0.0)]
        self.impulse = np.concatenate([self.stiffness * self.length, self.damper])

    def amount(self, X: Array) -> Array:
        """Return m = K_i l_i (1 - e^(-X/l_i)), l_C of a damper."""
        return self.impulse * self._and_damper(-np.expm1(-X / self.length), 1.0)

    def delay(self, v: Array, X: Array) -> Array:
        """Return s at which the share v of m is reached: -l_i ln(1 - v (1 - e^(-X/l_i)))."""
        l, arms = self.length[..., None], len(self.length)
        return self._and_damper(-l * np.log1p(v[:arms] * np.expm1(-X[..., None] / l)), 0.0)

    def share(self, s: Array, X: Array) -> Array:
        """Return the share of m that is reached at s."""
        return self._and_damper(np.expm1(-s / self.length) / np.expm1(-X / self.length), 1.0)

    def at_nodes(self, sliding: "Contact") -> tuple[Array, float]:
        """Return the pressure of each branch at the nodes, and its error.

        An arm forgets at one rate: its pressure is what is left of that at the node before, and an integral
        over u' between, a series of Legendre polynomials. Over z relaxation lengths their moments are
        M_k = int_0^1 e^(-z s) P_k(1 - 2s) ds, and M_(k+1) = M_(k-1) - (2k + 1)(2/z) M_k.
        """
        width = np.maximum(np.diff(sliding.x, prepend=-sliding.a), 0.0)
        x = np.maximum(sliding.x[:, None] - width[:, None] * BEHIND, -sliding.a)
        series = -sliding.shape.slope(x) @ TO_SERIES
        z = width / self.length
        left, far, long = np.exp(-z), z > FAR, np.maximum(z, FAR)
        near = np.exp(-np.minimum(z, FAR)[..., None] * BEHIND) @ MOMENTS
        last, M = (1.0 + left) / long, (1.0 - left) / long
        mean, fewer = 0.0 * z, 0.0 * z
        for k in range(TERMS):
            fewer = mean if k == TERMS - 2 else fewer
            mean = mean + series[:, k] * np.where(far, M, near[..., k])
            last, M = M, last - (2 * k + 1) * (2.0 / long) * M
        added = self.stiffness * width * np.array([mean, fewer])
        rows, pressure = np.empty_like(added), np.zeros(added.shape[:2])
        for j in range(width.size):
            pressure = pressure * left[:, j] + added[..., j]
            rows[..., j] = pressure
        fine, fewer = rows
        apart = np.abs(fine - fewer).sum(axis=0).max() / max(np.abs(fine).sum(axis=0).max(), TINY)
        damped = -self.damper * sliding.shape.slope(sliding.x)
        return np.concatenate([fine, damped]), MARGIN * float(apart)

    def power(self, rows: Array, _rate: Array) -> Array:
        """Return what the branches lose per length, from their pressures."""
        return (rows**2 / self.impulse).sum(axis=0)

    def works(self, sliding: "Contact", left: Array) -> tuple[float, float]:
        """Return the work of the branches, and the part lost; `left` is their last pressure."""
        lost = sliding.passed.power
        stored = left[: len(self.length)] ** 2 / (2.0 * self.stiffness)
        return float(stored.sum()) + lost, lost

    def _and_damper(self, rows: Array, value: float) -> Array:
        """Return the rows of the arms, and one of a damper."""
        return np.concatenate([rows, np.full((len(self.damper), *rows.shape[1:]), value)])


class Springpot:
    """A springpot, (X/l)^(-alpha)/Gamma(1 - alpha), likewise; for alpha = 1 it has no memory."""

    def __init__(self, length: float, order: float) -> None:
        self.scale, self.rest = length**order / gamma(2.0 - order), 1.0 - order
        self.noise = CANCELLED / order

    def amount(self, X: Array) -> Array:
        """Return m = l^alpha X^(1 - alpha)/Gamma(2 - alpha)."""
        return self.scale * X[None, :] ** self.rest

    def delay(self, v: Array, X: Array) -> Array:
        """Return X v^(1/(1 - alpha))."""
        return X[..., None] * (v ** (1.0 / self.rest) if self.rest else 0.0 * v)

    def share(self, s: Array, X: Array) -> Array:
        """Return (s/X)^(1 - alpha)."""
        return (s / X) ** self.rest if self.rest else np.ones_like(X)

    def at_nodes(self, sliding: "Contact") -> tuple[Array, float]:
        """Return the pressure at the nodes, a row, and its error."""
        rows, apart = sliding.remembered(sliding.x)
        return rows, sliding.error_of(apart)

    def power(self, rows: Array, rate: Array) -> Array:
        """Return what goes into the springpot per length, from its pressure."""
        return rate * rows.sum(axis=0)

    def works(self, sliding: "Contact", left: Array) -> tuple[float, float]:
        """Return the work, and the part lost: 1/2 int int G(s + s') u' u' ds ds' is stored at the end."""
        work = sliding.passed.power
        if not self.rest:
            return work, work
        s = sliding.ahead
        kernel = (s[:, None] + s[None, :]) ** (self.rest - 1.0) / gamma(self.rest)
        scale = self.scale * gamma(1.0 + self.rest)
        weighed = sliding.weights[0] * sliding.rate
        return work, work - 0.5 * scale * float(weighed @ kernel @ weighed)


Memory = Arms | Springpot | None
"""Branches of a foundation beside its spring; none at rest."""


def memory_of(scene: Scene) -> Memory:
    """Return the branches of a foundation at the velocity of a scene, over its stiffness."""
    foundation, speed = scene.foundation, abs(scene.drive.final_velocity)
    if speed == 0.0:
        return None
    if foundation.springpot:
        return Springpot(speed * foundation.retardation_time, foundation.order)
    pairs = [(arm.stiffness, arm.relaxation_time) for arm in foundation.arms]
    arms = np.reshape(pairs, (-1, 2))
    K, damper = foundation.stiffness, speed * foundation.damping
    return Arms(arms[:, 0] / K, speed * arms[:, 1], damper / K)


class Passed(NamedTuple):
    """The pressure of each branch, `Memory.power` over the contact, and the relative error of integrals."""

    rows: Array
    power: float
    error: float


class Contact:
    """One contact, with the values at the nodes of a rule; pressures are over the stiffness."""

    load_curvature, guess, noise = None, (), 0.0

    def __init__(self, shape: Shape, memory: Memory, depth: float, rule: int = 0) -> None:
        self.shape, self.memory, self.depth, self.rule = shape, memory, depth, rule
        self.nodes, self.rules = nodes, rules = USED[rule]
        # The extent at rest: h(-a) = h(back) = depth.
        if isinstance(shape, ConvexProfile):
            self.a, self.back = shape.sides(depth)
        else:
            self.a = self.back = ConvexLine(shape, 0.0).half_length(depth)
        self.half_length = 0.5 * (self.a + self.back)
        self.x_te = x_te = self._trailing_edge()
        cuts = sorted(x for x in {0.0, *shape.kinks} if -self.a < x < x_te)
        pieces = list(pairwise([-self.a, *cuts, x_te]))
        pieces += [] if x_te > 0.0 else [(0.0, 0.0)]
        rows: list[list[Array]] = [[], [], []]
        # Nodes are exact towards the end that is closer to the lowest point.
        for start, end in pieces:
            forth, back = (end - start) * nodes, (end - start) * nodes[::-1]
            rows[0].append(start + forth if abs(start) < abs(end) else end - back)
            rows[1].append(x_te - end + back)
            rows[2].append((end - start) * rules)
        self.x, self.ahead, self.weights = (np.concatenate(each, axis=-1) for each in rows)
        """Positions, distances from the trailing edge, and weights of all rules."""
        self.rate = -shape.slope(self.x)
        impulse = self.ahead + (0.0 if memory is None else memory.amount(self.ahead).sum(axis=0))
        self.load, apart = self.total(self.rate * impulse)
        self.load_error = self.error_of(apart / self.load)
        self.load_slope = self.a + x_te  # dW/d(delta) over K
        if memory is not None:
            self.load_slope += float(memory.amount(np.array([self.a + x_te])).sum())

    def error_of(self, apart: float) -> float:
        """Return the relative error from the estimate of a rule."""
        error = MARGIN * (apart + getattr(self.shape, "noise", 0.0))
        if not error < LIMIT:
            raise QuadratureError(
                "quadrature of the shape does not converge: the indenter's reach is too close, or "
                "`kinks` does not name every kink"
            )
        return error

    @cached_property
    def passed(self) -> "Passed":
        """The pressure of each branch at the nodes, and integrals over it."""
        rows, error = np.zeros((1, self.x.size)), 0.0
        if self.memory is not None:
            rows, error = self.memory.at_nodes(self)
        pressure = self.depth - self.shape.height(self.x) + rows.sum(axis=0)
        load, load_apart = self.total(pressure)
        power, power_apart = 0.0, 0.0
        if self.memory is not None:
            power, power_apart = self.total(self.memory.power(rows, self.rate))
        apart = load_apart / load + power_apart / max(power, TINY)
        return Passed(rows, power, error + max(self.error_of(apart), self.load_error))

    @property
    def finer(self) -> "Contact | None":
        """The contact by the finer rule if pressures need it."""
        if self.passed.error < ENOUGH or self.rule + 1 == len(USED):
            return None
        return Contact(self.shape, self.memory, self.depth, self.rule + 1)

    @property
    def rows(self) -> Array:
        """The pressure of each branch at the nodes."""
        return self.passed.rows

    @property
    def pressure(self) -> Array:
        """The pressure at the nodes."""
        return self.depth - self.shape.height(self.x) + self.rows.sum(axis=0)

    def total(self, values: Array) -> tuple[float, float]:
        """Return the integral over the contact, and its estimated error."""
        sums = self.weights @ values
        return float(sums[0]), self._estimate(*np.abs(np.diff(sums)).tolist())

    def _estimate(self, last: float, before: float) -> float:
        """Return the error of a sum from its last two differences: the last one, times their ratio.

        For an analytic integrand that is about the square of the difference, in a thin layer in which arms
        are loaded a part of it; where the shape bends at an unknown place, it is the difference itself.
        """
        bent = getattr(self.shape, "bent", False)
        return last if bent else last * min(last / max(before, TINY), 1.0)

    def remembered(self, x: Array) -> tuple[Array, float]:
        """Return the pressure of each branch at the positions x, and the largest error of its mean."""
        shape, memory, a = self.shape, self.memory, self.a
        if memory is None:
            return np.zeros((1, x.size)), 0.0
        X = np.maximum(a + x, 0.0)  # not below by rounding
        amount = memory.amount(X)
        cuts = [np.zeros_like(amount), np.ones_like(amount)]
        for kink in shape.kinks:  # one rule on either side of each that has been passed
            if kink > -a:
                share = memory.share(np.maximum(x - kink, 0.0), X) + 0.0 * amount
                cuts.insert(1, np.where(x > kink, share, 0.0))
        means = []
        for first, last in pairwise(cuts):
            width = last - first
            if width.any():
                past = memory.delay(first[..., None] + width[..., None] * self.nodes, X)
                rate = -shape.slope(np.maximum(x[:, None] - past, -a))
                means.append(width[..., None] * (rate @ self.rules.T))
        sums = amount * np.moveaxis(sum(means), -1, 0)
        size = max(np.abs(sums[0]).sum(axis=0).max(), TINY)
        apart = np.abs(np.diff(sums, axis=0)).sum(axis=1).max(axis=1) / size
        return sums[0], self._estimate(*apart.tolist())

    def pressure_at(self, x: float) -> float:
        """Return the pressure at x."""
        rows, _ = self.remembered(np.array([x]))
        return float(self.depth - self.shape.height(np.array([x]))[0] + rows.sum())

    def _trailing_edge(self) -> float:
        """Return the first zero of the pressure."""
        near, back = VERTEX * self.back, self.back
        if self.memory is None:
            return back
        if self.pressure_at(near) <= 0.0:  # beyond the vertex of a wedge
            return 0.0
        if self.pressure_at(back) >= 0.0:  # the memory is below rounding
            return back
        return float(brentq(self.pressure_at, near, back, xtol=TINY, rtol=ROOT, maxiter=2000))

    def peak(self) -> float:
        """Return the greatest pressure: at the highest node, or between its neighbours."""
        x, best = self.x, int(self.pressure.argmax())
        low, high = x[max(best - 1, 0)], x[min(best + 1, x.size - 1)]
        found = minimize_scalar(  # over a share, as the layer at the leading edge may be thin
            lambda share: -self.pressure_at(low + share * (high - low)),
            bounds=(0.0, 1.0),
            method="bounded",
            options={"xatol": PEAK_RTOL},
        )
        return max(float(self.pressure[best]), -float(found.fun))

    def friction(self) -> tuple[float, float, float]:
        """Return the friction over K, the part of it lost in the contact, and the relative error."""
        if self.memory is None:
            return 0.0, 0.0, self.load_error
        if finer := self.finer:
            return finer.friction()
        error = self.passed.error
        left, _ = self.remembered(np.array([self.x_te]))
        work, lost = self.memory.works(self, left)
        # K u = -(memory) at the trailing edge, unless the pressure jumps there.
        rest, held = -float(left.sum()), self.depth - float(self.shape.height(self.x_te))
        rest = held if abs(rest - held) > JUMP * self.depth else rest
        return work + 0.5 * rest * rest, lost, error + self.memory.noise

    def quantities(self) -> Quantities:
        """Return quantities over the stiffness, their errors at this depth, and d ln/d ln delta."""
        if finer := self.finer:
            return finer.quantities()
        friction, lost, error = self.friction()
        edges, share = (-self.a, self.x_te), share_lost(friction, lost)
        values = self.half_length, *edges, self.load, friction, self.peak(), share
        # Relative shift of the trailing edge over that of all pressures: at least that over the depth's, as
        # ahead of the lowest point u' >= 0, where the pressure is at least delta G/K of the trailing edge.
        edge, x = 1.0, self.x_te
        if x not in (0.0, self.back):
            near, far = (self.pressure_at(x * (1.0 + side * STRIDE)) for side in (-1.0, 1.0))
            edge = float(np.abs(self.pressure).max() * STRIDE / (near - far))
        own = dict.fromkeys(OF_LINE, self.load_error) | dict.fromkeys(OF_WORK, error)
        own["trailing_edge"] += FLOOR * edge
        powers = dict.fromkeys(OF_LINE, 1.0) | power_bounds(self) | {"trailing_edge": edge}
        return dict(zip(OF_LINE, values, strict=True)), own, powers


class ViscoelasticLine:
    """A convex shape on a foundation with a memory: one scene."""

    in_columns, floor = False, FLOOR

    def __init__(self, shape: Shape, memory: Memory, l_r: float) -> None:
        self.shape, self.memory, self.l_r, self.reach = shape, memory, l_r, shape.reach

    def strips(self, strip: Any) -> "ViscoelasticLine":
        """Return the line contact of one strip, which has the kinks of the profile at their radii."""
        y, shape = strip.y, self.shape
        cuts = {math.sqrt((x - y) * (x + y)) for x in map(abs, shape.kinks) if x > y}
        # Next to a tip, the strip has one nearly as sharp.
        strip.kinks = *({0.0} & set(shape.kinks)), *(side * x for x in cuts for side in (-1.0, 1.0))
        if isinstance(shape, ConvexProfile):
            strip.kinks = *strip.kinks, *((-y, y) if 0.0 in shape.kinks else ())
            strip.bent, strip.noise = shape.bent, shape.noise
        return ViscoelasticLine(strip, self.memory, self.l_r)

    @property
    def deepest(self) -> float:
        """The depth at which the contact is as wide as the reach."""
        end = math.nextafter(self.reach, 0.0)
        return min(float(self.shape.height(side * end)) for side in (-1.0, 1.0))

    def shallow(self, load: float, width: Any) -> float:
        """Return an approximate depth at a load: depth times `width` of the half length is the load."""
        if isinstance(self.shape, ConvexProfile):
            return self.shape.shallow(load, width)
        return float(ConvexLine(self.shape, self.l_r).shallow(load, width))

    def first(self, load: float, spring: float) -> tuple[float, tuple[()]]:
        """Return an initial guess of the depth at a load."""
        return self.shallow(load, lambda x: x + spring), ()

    def at(self, depth: float, guess: tuple[()] = ()) -> Contact:
        """Return the contact at a depth, by the finer rule if the load needs it."""
        if not getattr(self.shape, "bent", False):
            contact = Contact(self.shape, self.memory, depth)
            if contact.load_error < ENOUGH:
                return contact
        return Contact(self.shape, self.memory, depth, 1)
