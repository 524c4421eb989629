r"""The steady contacts of an indenter of any shape: their edges and forces.

In steady sliding the surface of the foundation is (fact F8, with x = V t along the base)

    u(x) = max(0, sup over x' <= x of g(x') e^(-(x - x')/l_r)),   g = delta - h,

so that u e^(x/l_r) is the running maximum of g e^(x/l_r), which rises where p/K = g - l_r h' > 0. Each
rise that exceeds the maximum so far is a contact. It ends where the rise ends (p = 0). It begins
where the rise crosses the surface left by the previous contact, or the undisturbed level of the
foundation. From p = K (u + l_r u') and p = 0 elsewhere,

    W = K sum (int u dx + l_r (u_TE - u_LE)),
    F = K sum ((u_TE^2 - u_LE^2)/2 + l_r int h'^2 dx),      dW/d(delta) = K int du/d(delta) dx,

where du/d(delta) is 1 in contact and decays as e^(-x/l_r) behind it. As a supremum of functions linear in
the depth, u is convex in the depth, and so is W, which vanishes at zero depth: d ln W/d ln delta >= 1, and
every load is carried at exactly one depth.
"""

import itertools
import math
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from kvtheory.models.steady.cells import DEGREE, DENSE, TAIL_MARGIN, VALUES, Surface
from kvtheory.models.steady.double_exponential import (
    OF_LINE,
    ROUNDING,
    SMALLEST,
    Quantities,
    share_lost,
)
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import beside

NODES, WEIGHTS = np.polynomial.legendre.leggauss(DEGREE + 1)
"""Gauss's rule, exact for the square of a series."""
PEAK_BAND, PEAK_XTOL = 0.02, 1e-8
"""Local maxima of the sampled pressure within this share of the highest are refined; tolerance of their
position, over the distance of two samples: the error of the value is of second order."""
CORNER, AT_CORNER = (1e-10, 1e-290), 1e-9
"""Distances from the lowest point, over that of x_LE; at a corner the slopes there agree to `AT_CORNER`."""
HALF, BALANCED = 0.5, 1e-6
"""Share of the depth below which u_TE is taken from the slope, and within which both agree without a jump."""
ONE_SIDED = 1e3
"""Upper bound, over the last coefficients, of the difference of series and function at a kink, even for a
singular slope: if it is larger, the function gives the slope of the other side."""
DEPTH_STEP, ROOT_RTOL = 2.0**-20, 4.0 * float(np.finfo(float).eps)
"""Relative step of the depth for derivatives; the smallest tolerance that `brentq` accepts."""


class Patch(NamedTuple):
    """One contact: its edges, and u at them."""

    x_le: float
    x_te: float
    u_le: float
    u_te: float


class Contact:
    """All contacts at one depth; forces are over the stiffness."""

    load_curvature = None
    """None: the load is not smooth where another contact begins."""
    guess = ()

    def __init__(self, surface: Surface, l_r: float, depth: float) -> None:
        self.surface, self.l_r, self.depth = surface, l_r, depth
        self.cells = surface.cells(depth)
        self.patches = self.patches_at(l_r)
        for x in surface.jumps:
            if surface.height(x) < depth:
                raise QuadratureError(
                    f"the slope jumps near x = {surface.side * x:.6g} m of the contact, "
                    "where `kinks` does not say so"
                )
        ends = [*(patch.x_le for patch in self.patches[1:]), math.inf]
        self.load = self.load_error = self.load_slope = 0.0
        for patch, end in zip(self.patches, ends, strict=True):
            length = patch.x_te - patch.x_le
            below, error = self.integral(patch, 1)
            self.load += depth * length - below + l_r * (patch.u_te - patch.u_le)
            self.load_error += error
            behind = -math.expm1((patch.x_te - end) / l_r) if l_r else 0.0
            self.load_slope += length + l_r * behind
        self.load_error /= self.load

    def gap(self, x: float) -> float:
        """Return g."""
        return self.depth - self.surface.height(x)

    def pressure(self, x: float, l_r: float) -> float:
        """Return p/K where there is contact."""
        return self.gap(x) - (l_r * self.surface.slope(x) if l_r else 0.0)

    def patches_at(self, l_r: float) -> list[Patch]:
        """Return the contacts at a retardation length."""
        x, g, p = self._sampled(l_r)
        if max(g[0], g[-1]) >= 0.0:
            raise QuadratureError(
                f"the contact lies beyond the indenter's reach, or beyond {x[-1]:.6g} m"
            )
        found: list[Patch] = []
        turns = np.flatnonzero((p[1:] > 0.0) != (p[:-1] > 0.0)).tolist()
        turns = [-1, *turns] if p[0] > 0.0 else turns
        for begin, end in zip(turns[::2], turns[1::2], strict=False):
            x_le, x_te = self._turn(x, p, begin, l_r), self._turn(x, p, end, l_r)
            u_le, u_te = 0.0, self.gap(x_te)
            if u_te < HALF * self.depth and x_te not in self.surface.kinks:
                rolling = l_r * self.surface.slope(x_te)  # where p = 0; it does not cancel
                u_te = rolling if abs(rolling - u_te) < BALANCED * self.depth else u_te
            if l_r:
                last = found[-1] if found else Patch(0.0, x_le, 0.0, 0.0)

                def level(y: Any, last: Patch = last) -> Any:
                    """Return the surface left by the previous contact."""
                    return last.u_te * np.exp((last.x_te - y) / l_r)

                if u_te <= level(x_te):
                    continue
                inside = slice(begin + 1, end + 1)
                highest = float(x[inside][np.argmax(g[inside] - level(x[inside]))])
                x_le = _root(lambda y: self.gap(y) - level(y), x_le, highest)
                u_le = float(level(x_le))
            found.append(Patch(x_le, x_te, u_le, u_te))
        return found

    def _sampled(self, l_r: float) -> tuple[Any, Any, Any]:
        """Return points in order, with g and p/K there from the series; cells keep both their ends."""
        c = self.cells
        x = 0.5 * (c.start + c.end)[:, None] + 0.5 * (c.end - c.start)[:, None] * DENSE
        x[:, 0], x[:, -1] = c.start, c.end
        g = self.depth - c.height @ VALUES
        p = g - l_r * (c.slope @ VALUES)
        # Where the truncation error of the series could change the sign, the shape itself is evaluated.
        tail = c.height_tail + l_r * c.slope_tail
        unsure = abs(p) <= TAIL_MARGIN * tail[:, None]
        # Likewise at a kink, where the slope may be singular, unless it is that of the other side.
        kinks = np.isin(x, self.surface.kinks)
        kinks[:, 1:-1] = False
        for row, column in np.argwhere(unsure | kinks).tolist():
            point = self.surface.beside(x[row, column], 0.5 * (c.start[row] + c.end[row]))
            value = self.pressure(point, l_r)
            if not kinks[row, column] or abs(value - p[row, column]) <= ONE_SIDED * tail[row]:
                p[row, column] = value
        # Two roots may lie between samples: then the parabola through three samples crosses zero.
        left, middle, right = p[:, :-2], p[:, 1:-1], p[:, 2:]
        bend, tilt = left - 2.0 * middle + right, 0.5 * (right - left)
        shift, vertex = -tilt / bend, middle - 0.5 * tilt * tilt / bend
        hidden = (abs(shift) < 1.0) & (vertex * middle <= 0.0)
        hidden &= (left * middle > 0.0) & (right * middle > 0.0)
        for row, column in np.argwhere(hidden).tolist():
            step = (c.end[row] - c.start[row]) / (DENSE.size - 1)
            at, point = (row, column + 1), x[row, column + 1] + shift[row, column] * step
            x[at], g[at], p[at] = point, self.gap(point), self.pressure(point, l_r)
        return x.ravel(), g.ravel(), p.ravel()

    def _turn(self, x: Any, p: Any, index: int, l_r: float) -> float:
        """Return where p changes its sign after a sample."""
        low, high = max(index, 0), min(index + 1, x.size - 1)
        start, end = float(x[low]), float(x[high])
        if index < 0 or (end > start and index % DENSE.size == DENSE.size - 1):
            return start
        if end == start:  # two cells meet
            if start in self.surface.kinks or p[low - 1] * p[high + 1] >= 0.0:
                return start
            low, high = low - 1, high + 1
        start, end = x[[low, high]].tolist()
        return _root(lambda y: self.pressure(y, l_r), start, end, p[[low, high]].tolist())

    def integral(self, patch: Patch, power: int) -> tuple[float, float]:
        """Integrate h (power 1) or h'^2 (power 2) over a contact; return also an estimate of the error."""
        c = self.cells.only((self.cells.end > patch.x_le) & (self.cells.start < patch.x_te))
        series, tail = (c.height, c.height_tail) if power == 1 else (c.slope, c.slope_tail)
        start, end = np.maximum(c.start, patch.x_le), np.minimum(c.end, patch.x_te)
        x = 0.5 * (start + end) + 0.5 * (end - start) * NODES[:, None]
        means = 0.5 * (WEIGHTS @ c.values(series, slice(None), x) ** power)
        error = tail * power * np.sqrt(abs(means)) ** (power - 1)
        return float((end - start) @ means), float((end - start) @ error)

    @cached_property
    def half_length(self) -> float:
        """Half the length of all contacts at rest."""
        rest = self.patches_at(0.0)
        return 0.5 * (rest[-1].x_te - rest[0].x_le)

    @property
    def noise(self) -> float:
        """Relative error of the depth equivalent to rounding: of edges, of h and of h'."""
        c, edges = self.cells, np.array(self.patches)[:, :2]
        middle = 0.5 * (edges[0, 0] + edges[-1, 1])
        beside, slope = self.surface.beside, self.surface.slope
        shift = max(abs(x * slope(beside(x, middle))) for x in edges.ravel().tolist())
        # The slope counts where the pressure falls to zero.
        ends = np.any([(c.start <= x) & (x <= c.end) for x in edges[:, 1]], axis=0)
        tail = c.height_tail[c.lowest() < self.depth].max() + self.l_r * c.slope_tail[ends].max()
        return ROUNDING + (ROUNDING * shift + float(tail)) / self.depth

    def peak(self) -> float:
        """Return the highest p/K, with one-sided values at edges and kinks."""
        x, _, p = self._sampled(self.l_r)
        inside = [(x >= patch.x_le) & (x <= patch.x_te) for patch in self.patches]
        somewhere, kinks = np.any(inside, axis=0), self.surface.kinks
        starts = (self.surface.beside(patch.x_le, patch.x_te) for patch in self.patches)
        highest = max(self.pressure(start, self.l_r) for start in starts)
        highest = max(highest, p[np.isin(x, kinks) & somewhere].max(initial=0.0))
        high = p > (1.0 - PEAK_BAND) * max(highest, p[somewhere].max(initial=0.0))
        intervals = set()
        for patch, samples in zip(self.patches, inside, strict=True):
            for i in np.flatnonzero(samples & high).tolist():
                # Where two cells meet there are two samples, and the peak may be on either side.
                points = x[max(i - 2, 0) : i + 3].clip(patch.x_le, patch.x_te).tolist()
                if p[i] >= max(p[i - 1 : i + 2]):
                    intervals |= {ends for ends in itertools.pairwise(points) if ends[0] < ends[1]}
        for start, end in intervals:
            found = minimize_scalar(
                lambda y: -self.pressure(y, self.l_r),
                bounds=(start, end),
                method="bounded",
                options={"xatol": PEAK_XTOL * (end - start)},
            )
            values = [self.pressure(y, self.l_r) for y in (start, end) if y not in kinks]
            highest = max(highest, -float(found.fun), *values)
        return float(highest)

    def friction(self) -> tuple[float, float, float]:
        """Return the friction over K, the part of it lost in the contact, and the relative error."""
        drags = np.array([self.integral(patch, 2) for patch in self.patches])
        drag, error = drags.sum(axis=0).tolist()
        left = sum(0.5 * (patch.u_te**2 - patch.u_le**2) for patch in self.patches)
        return left + self.l_r * drag, self.l_r * drag, error / drag

    def quantities(self) -> Quantities:
        """Return quantities over the stiffness, of all contacts, their errors, and d ln/d ln delta."""
        nearby = Contact(self.surface, self.l_r, self.depth * (1.0 - DEPTH_STEP))
        (values, own), (others, _) = self._values(), nearby._values()
        powers = {
            name: (1.0 - others[name] / value) / DEPTH_STEP if value else 0.0
            for name, value in values.items()
        }
        return values, own, powers

    def _values(self) -> tuple[dict[str, float], dict[str, float]]:
        friction, lost, error = self.friction()
        edges, share = (self.patches[0].x_le, self.patches[-1].x_te), share_lost(friction, lost)
        values = self.half_length, *edges, self.load, friction, self.peak(), share
        unresolved = 0.0
        if abs(edges[1]) < SMALLEST:  # at the lowest point, unless that is a corner
            near, nearer = (self.surface.slope(-part * edges[0]) for part in CORNER)
            unresolved = 0.0 if math.isclose(near, nearer, rel_tol=AT_CORNER) else math.inf
        own = {"trailing_edge": unresolved, "load": self.load_error, "friction_force": error}
        return dict(zip(OF_LINE, values, strict=True)), own


def _root(function: Callable[[float], float], low: float, high: float, ends: Any = None) -> float:
    """Return a root between two points, or one of them, if the signs of `ends` differ by rounding only."""
    low, high = low or beside(low, high), high or beside(high, low)
    left, right = ends or (function(low), function(high))
    if (left > 0.0) == (right > 0.0):
        return low if abs(left) < abs(right) else high
    known = {low: left, high: right}
    # The root may be close to a tip.
    while (low > 0.0) == (high > 0.0) and not 0.5 * abs(high) <= abs(low) <= 2.0 * abs(high):
        middle = math.copysign(math.sqrt(abs(low)) * math.sqrt(abs(high)), low)
        known[middle] = function(middle)
        low, high = (low, middle) if (known[middle] > 0.0) != (left > 0.0) else (middle, high)
    found = brentq(
        lambda x: known[x] if x in known else function(x),
        low, high, xtol=SMALLEST, rtol=ROOT_RTOL, maxiter=2000,
    )  # fmt: skip
    return float(found)


class AnyLine:
    """A shape of any kind on Kelvin-Voigt; it may touch in several places."""

    in_columns, floor, deepest = False, ROUNDING, math.inf

    def __init__(self, surface: Surface, l_r: float) -> None:
        self.surface, self.l_r, self.shallow = surface, l_r, surface.shallow

    @property
    def reach(self) -> float:
        """The largest x at which the shape has been examined."""
        return self.surface.examined

    def strips(self, strip: Any) -> "AnyLine":
        """Return the line contact of one strip."""
        return AnyLine(Surface(strip, 1.0, strip.nearest), self.l_r)

    def first(self, load: float, spring: float) -> tuple[float, tuple[()]]:
        """Return an initial guess of the depth at a load."""
        return self.shallow(load, lambda x: x + self.l_r + spring), ()

    def at(self, depth: float, guess: tuple[()] = ()) -> Contact:
        """Return the contacts at a depth."""
        return Contact(self.surface, self.l_r, depth)
