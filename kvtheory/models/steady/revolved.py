r"""Steady sliding of a ball and of any profile of revolution, on any foundation: strips across y.

Elements are independent: a strip along x at the distance y from the middle plane is a separate line contact,
whose shape is h(sqrt(x^2 + y^2)) - h(|y|) and whose depth is delta - h(|y|). A line contact is solved by
`ConvexLine`, `AnyLine` or `ViscoelasticLine`, and

    W = int W_2 dy,    F = int F_2 dy    over |y| < b,    h(b) = delta,    y = b sin t,

and likewise for dW/d(delta). Strips at the rim suffer cancellation in delta - h(|y|) and carry almost
nothing: strips beyond `RIM` are omitted. The middle plane gives the edges and the peak pressure.
"""

import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from kvtheory.models.steady.double_exponential import (
    RULES,
    SMALLEST,
    SUMS,
    Quantities,
    power_bounds,
    share_lost,
)
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Spot

Array = NDArray[np.float64]

RIM = {True: 3e-4, False: 3e-3}
"""cos t of the last strip of a convex profile, and of one that is evaluated point by point, which is more
sensitive to rounding: its fourth power is an upper bound of the share of the load beyond."""
MIDDLE = 1e-10
"""Smallest y/b of a strip: closer to the middle plane, a sharper tip makes no difference."""
NEAR = 0.02
"""Rise over y up to which h is integrated from the lowest point of a strip: a difference would cancel."""
NARROWEST = 1e-6
"""Half width of the narrowest strip that is sought, over that of the contact."""
GAUSS = tuple((0.5 + 0.5 * s, 0.5 * w) for s, w in zip(*leggauss(4), strict=True))

LEAST, SHARP = 5.0, 4e-12
"""Least relative error of a sum, over that of a strip, and for a kink, where strips have a sharp tip."""
RTOL, LIMIT = {True: 1e-12, False: 1e-9}, 1e-6
"""Estimates above which the next rule is taken, and above which the last one is refused."""
MARGIN = 4.0
"""Safety factor on the ratio of the last two differences, which estimates the next one."""
BESIDE = 1e-9
"""Relative distance from a kink at which the slopes on both sides are taken, to see where strips change."""


class Strip:
    """The shape of a strip at the distances y, floats or a column of them, of a profile of revolution."""

    def __init__(self, profile: Any, y: Any, reach: float, nearest: float) -> None:
        self.profile, self.y, self.convex = profile, y, profile.convex
        self.nearest = nearest
        """Half width at which the search for a contact begins."""
        self.lowest = profile.height(y)
        radii = [kink for kink in profile.kinks if kink > 0.0]
        self.clear = np.min([y, *(abs(kink - y) for kink in radii)], axis=0)
        """Distance of y from the nearest point where the profile may be singular."""
        cuts = [math.sqrt((kink - y) * (kink + y)) for kink in radii if kink > y]
        cuts += [y] if 0.0 in profile.kinks and not profile.convex else []  # a tip is rounded there
        self.kinks = tuple(side * x for x in cuts for side in (-1.0, 1.0))
        self.reach = math.inf if reach == math.inf else np.sqrt((reach - y) * (reach + y))

    def height(self, x: Any) -> Any:
        """Return h above the lowest point of the strip: next to it, as the integral of h'."""
        rho = np.hypot(x, self.y)
        rise = x * (x / (rho + self.y))  # rho - y
        near, h = rise < NEAR * self.clear, np.array(self.profile.height(rho) - self.lowest)
        mean = sum(w * self.profile.slope((self.y + s * rise)[near]) for s, w in GAUSS)
        h[near] = mean * rise[near]
        return h

    def slope(self, x: Any) -> Any:
        """Return dh/dx."""
        rho = np.hypot(x, self.y)
        return self.profile.slope(rho) * (x / rho)

    def bend(self, x: Any) -> Any:
        """Return x h''/h'."""
        rho = np.hypot(x, self.y)
        return 1.0 + (self.profile.bend(rho) - 1.0) * (x / rho) ** 2


class Contact(NamedTuple):
    """The middle plane of a contact, and the sums over its strips, over the stiffness."""

    strips: "Strips"
    middle: Any
    depth: float
    noise: float
    load: float
    load_slope: float
    load_error: float  # relative, of every sum
    load_curvature: None = None
    guess: tuple[()] = ()

    def quantities(self) -> Quantities:
        """Return quantities over the stiffness, their errors at this depth, and d ln/d ln delta."""
        values, own, powers = self.middle.quantities()
        (load, _, _, friction, lost, _), error = self.strips.sums(self.middle, with_friction=True)
        values |= {"load": load, "friction_force": friction}
        values["dissipated_in_contact"] = share_lost(friction, lost)
        own |= dict.fromkeys(SUMS, error)
        return values, own, powers | power_bounds(self)


class Strips:
    """A body of revolution, stretched across y, as strips that are line contacts."""

    def __init__(self, indenter: Spot, line: Any) -> None:
        self.indenter, self.line, self.l_r = indenter, line, line.l_r
        self.profile: Any = indenter.profile
        self.deepest, self.floor = line.deepest, line.floor

    def first(self, load: float, spring: float) -> tuple[float, tuple[()]]:
        """Return an initial guess of the depth at a load: that of a ball as blunt as the profile."""
        wide, l_r = self.indenter.stretch, self.l_r
        return self.line.shallow(load, lambda a: a * wide * (1.5 * a + 1.3 * l_r) + spring), ()

    def at(self, depth: float, guess: tuple[()] = ()) -> Contact:
        """Return the contact at a depth, with the load."""
        middle = self.line.at(depth)
        (load, slope, _), error = self.sums(middle, with_friction=False)
        return Contact(self, middle, middle.depth, float(middle.noise), load, slope, error)

    def sums(self, middle: Any, *, with_friction: bool) -> tuple[list[float], float]:
        """Return the rows of `_strip` summed over the strips, by finer rules until two of them agree.

        The relative error is that of every sum.
        """
        depth, half, convex = middle.depth, middle.half_length, self.profile.convex
        rim = RIM[convex]
        pieces = list(pairwise([0.0, *self._breaks(depth, half), 0.5 * math.pi]))
        for nodes, (fine, _) in RULES[1 + convex :]:
            # Weights of the rule, and of those of twice and four times its step.
            every = np.array([[1], [2], [4]])
            rule = fine * np.where((np.arange(fine.size) - fine.size // 2) % every == 0, every, 0)
            t = np.concatenate([start + (end - start) * nodes for start, end in pieces])
            weights = np.concatenate([(end - start) * rule for start, end in pieces], axis=1)
            kept = np.cos(t) > rim
            t, weights = t[kept], weights[:, kept]
            y = half * np.maximum(np.sin(t), MIDDLE)
            deep = np.maximum(depth - self.profile.height(y), SMALLEST)
            weights *= 2.0 * half * self.indenter.stretch * np.cos(t)
            each = np.einsum("ij,kj->ik", self._rows(y, deep, with_friction), weights)
            sums = np.maximum(each[::3], SMALLEST)
            last, before = (np.abs(np.diff(each)[::3]) / sums[:, :1]).max(axis=0).tolist()
            # An analytic integrand squares its error with each rule; any other one divides it.
            estimate = last**1.5 if convex else last * min(MARGIN * last / before, 1.0)
            if estimate < RTOL[convex]:
                break
        error = estimate + float((each[2::3, 0] / sums[:, 0]).max()) + rim**4
        if not error < LIMIT:
            raise QuadratureError(
                "quadrature over the strips fails: the indenter's reach is too close"
            )
        error += SHARP if self.profile.kinks else LEAST * self.floor
        return each[:, 0].tolist(), error

    def _rows(self, y: Array, depth: Array, with_friction: bool) -> Array:
        """Return the rows of `_strip`, a column for each strip."""
        nearest = 2.0 ** math.floor(math.log2(NARROWEST * y.max()))
        if self.line.in_columns:
            return self._strip(y[:, None], depth[:, None], nearest, with_friction)[..., 0]
        pairs = zip(y.tolist(), depth.tolist(), strict=True)
        return np.transpose([self._strip(*pair, nearest, with_friction) for pair in pairs])

    def _strip(self, y: Any, depth: Any, nearest: float, with_friction: bool) -> Array:
        """Return load, its slope and its error, and with friction also that, its part lost, and its error."""
        line = self.line.strips(Strip(self.profile, y, self.line.reach, nearest))
        contact = line.at(depth)
        rows = [contact.load, contact.load_slope, contact.load * contact.load_error]
        if with_friction:
            friction, lost, error = contact.friction()
            rows += [friction, lost, friction * error]
        return np.array(rows)

    def _breaks(self, depth: float, half: float) -> list[float]:
        """Return t of the strips that touch a kink of the profile, or whose pressure vanishes there."""
        profile, breaks = self.profile, set()
        for kink in profile.kinks:
            if 0.0 < kink < half:
                beside = (kink * (1.0 + side * BESIDE) for side in (-1, 1))
                slopes = [self.l_r * abs(profile.slope(x)) for x in beside]
                rise = depth - profile.height(kink)
                shares = [0.0, *(rise / slope for slope in slopes if 0.0 < rise < slope)]
                breaks |= {math.asin(kink / half * math.sqrt(1.0 - share**2)) for share in shares}
        return sorted(breaks)
