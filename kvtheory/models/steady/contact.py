r"""The steady contact of a convex, even shape, for one scene or for columns of scenes.

Geometry, for V > 0 (V < 0 is the mirror image): the foundation moves through x with V. Its surface
meets the indenter at the leading edge, x_LE < 0, and leaves it at the trailing edge. Between them

    compression   u = delta - h(x)                        (Eq. 35)
    pressure      p = K (u - l_r h'(x)),  l_r = V tau     (Eqs. 12, 29, 36)

The leading edge is where h = delta on the entering side. The trailing edge is where p falls to zero,
by a root of h + l_r h' = delta, or by the jump of h' at the vertex of a wedge.

There is one contact: e^(x/l_r) u rises where p > 0, for its derivative is e^(x/l_r) p/(K l_r); the surface
left behind relaxes as e^(-x/l_r), and is touched again only where e^(x/l_r) u exceeds its running maximum.
As h is convex, log u + x/l_r is concave: there is one maximum, the trailing edge.

The pressure vanishes at a root of the trailing edge, and the leading edge moves by d(-x_LE) = d(delta)/|h'|
with p_LE = K l_r |h'|; hence dW/d(delta) = K (x_TE - x_LE + l_r) and dF/d(delta) = K u_TE + p_LE.

Roots are found by Newton's method for ln h as a function of ln x, which is exact for a power. For powers and
for the circle, ln(h + l_r h') is convex in ln x, so that the steps converge to the root from above.
All operations work for floats and for columns, of shape (n, 1).
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from kvtheory.models.steady import double_exponential as d_
from kvtheory.models.steady.double_exponential import Quantities, Value
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Convex

EPS = float(np.finfo(float).eps)
LINEAR = 1e-8
"""Newton's method squares an error: after a step of this size the error is below rounding."""
STRIDES = tuple(4.0 ** (2.0**power) for power in range(6, -9, -1))
"""Factors by which a half length far too short is increased at first, while it remains too short."""
COARSE, CLOSER = 7, 3
"""How many are enough where `CLOSER` Newton steps follow, on the load of a parabola as blunt."""
NEAR_REACH = 0.5
"""The search for the half length starts at no more than this share of the reach."""
MOST_STEPS = 200
"""Most steps of a root; a few suffice unless a vertex or the reach of a circle is close."""
VERTEX, FLOOR = 1e-290, 1e-20
"""Shares of the half length below which the trailing edge and the peak count as at the lowest point."""
PEAK_RTOL, PEAK_STEPS = 1e-8, 8
"""Tolerance of the position of the peak (its value is of second order), and secant steps at most."""
TINY = 1e-300
"""Added to a divisor that may vanish together with its dividend."""


class Contact:
    """The contact of a line at one depth; forces are over the stiffness."""

    def __init__(self, line: "ConvexLine", depth: Value, guess: tuple[Value, ...]) -> None:
        self.shape, self.l_r, self.depth = shape, l_r, _ = line.shape, line.l_r, depth
        start, x = guess or (line.start(depth),) * 2
        self.half_length, self.a_moves = a, a_moves = _leading(shape, depth, start)
        # 0 where the trailing edge is at the vertex, where the pressure jumps through zero
        self.rolls = rolls = (l_r * shape.slope(VERTEX * a) < depth) * 1.0
        self.x, x_moves = x, _ = _trailing(shape, l_r * rolls, depth, a, x * (a / start))
        self.guess, self.x_moves = (a, x), rolls * x_moves
        below, error = d_.integral(shape.height, (a, x), (a, rolls * x), not shape.kinks)
        # Where p = 0, u_TE = l_r h', which does not cancel for a small l_r.
        self.u_te = l_r * rolls * shape.slope(x) + (1.0 - rolls) * depth
        length = a + rolls * x
        self.load = depth * length - below + l_r * self.u_te
        self.load_error = error * below / self.load  # relative, at this very depth
        self.load_slope, self.load_curvature = length + l_r, a_moves + self.x_moves
        # Relative error of the depth equivalent to rounding: of x_LE, and of u.
        self.noise = d_.ROUNDING * (1.0 + a / (a_moves * depth))

    def friction(self) -> tuple[Value, Value, Value]:
        """Return the friction over K, the part of it lost in the contact, and the relative error."""
        drag, error, left = self._drag()
        return self.l_r * (drag + 0.5 * self.u_te * left), self.l_r * drag, error

    def _drag(self) -> tuple[Value, Value, Value]:
        """Return int h'^2 dx with its relative error, and u_TE/l_r."""
        shape, rolls, a, x = self.shape, self.rolls, self.half_length, self.x
        ends = (a, x), (a, rolls * x)
        drag, error = d_.integral(lambda x: shape.slope(x) ** 2, *ends, not shape.kinks)
        return drag, error, rolls * shape.slope(x) + (1.0 - rolls) * self.depth / (self.l_r + rolls)

    def quantities(self) -> Quantities:
        """Return quantities over K, their errors, d ln/d ln delta; F = l_r (int h'^2 dx + u_TE^2/(2 l_r))."""
        shape, l_r, depth, rolls = self.shape, self.l_r, self.depth, self.rolls
        a, x, load = self.half_length, self.x, self.load
        a_moves, x_moves = self.a_moves, self.x_moves
        drag, drag_error, left = self._drag()
        at_a, at_x, spring = shape.slope(a), shape.slope(x), 0.5 * self.u_te * left
        total = drag + spring
        # Both edges are rounded independently: what they contribute to the share of the drag does not cancel.
        by_a = at_a * (spring / drag)
        by_x = left - at_x * at_x * x_moves * (total / drag)
        peak = _peak(shape, l_r, depth, a)
        edge = depth * a_moves / a
        # The trailing edge is exactly 0 at a corner; at a rounded tip, 0 means too close to be resolved.
        lost = d_.pick((rolls * x < d_.SMALLEST) & (shape.bend(x) != 0.0), math.inf, 0.0)
        values = a, -a, rolls * x, load, l_r * total, peak, drag / total
        own = {"trailing_edge": lost, "load": self.load_error, "friction_force": drag_error}
        steeper = -d_.least(-1.0 + 0.0 * l_r, -l_r * shape.bend(a) / a)
        powers = (
            edge, edge, depth * x_moves / x, depth * self.load_slope / load, depth * (left + at_a) / total,
            depth / peak * steeper, depth * (by_a + abs(by_x)) / total,
        )  # fmt: skip
        names = d_.OF_LINE
        return dict(zip(names, values, strict=True)), own, dict(zip(names, powers, strict=True))


class ConvexLine:
    """A convex, even shape on Kelvin-Voigt: one scene or a column of them."""

    in_columns, floor = True, d_.ROUNDING
    """Whether columns of depths are solved together; relative rounding error of every quantity."""

    def __init__(self, shape: Any, l_r: Value) -> None:
        self.shape, self.l_r, self.reach = shape, l_r, shape.reach

    def strips(self, strip: Any) -> "ConvexLine":
        """Return the line contacts of strips, in a column."""
        return ConvexLine(strip, np.full(strip.y.shape, self.l_r))

    @property
    def deepest(self) -> Value:
        """The depth at which the contact is as wide as the reach."""
        reach = self.reach
        return math.inf if reach is math.inf else self.shape.height(reach * (1.0 - EPS))

    def shallow(self, load: Value, width: Callable[[float], float]) -> Value:
        """Return an approximate depth at a load: depth times `width` of the half length is the load."""
        return self.shape.height(_spaced(self.shape, load**0.5, load, width, STRIDES))

    def first(self, load: Value, spring: Value) -> tuple[Value, tuple[Value, ...]]:
        """Return initial guesses of depth and edges at a load: of a parabola as blunt as the shape."""
        shape, l_r = self.shape, self.l_r
        extra = l_r + spring
        a = _spaced(shape, load**0.5, load, lambda x: x + extra)
        for _ in range(CLOSER):
            depth, slope = shape.height(a), shape.slope(a)
            beyond = l_r + abs(a + 1j * l_r)
            x = a * (a / beyond)
            width = (a + x + l_r + l_r * (l_r / beyond)) / 1.5 + spring
            power = a * slope * (a + x + extra) / (depth * width)
            a = _within(shape, a, (load / (depth * width)) ** (1.0 / power))
        return shape.height(a), (a, x)

    def at(self, depth: Value, guess: tuple[Value, ...] = ()) -> Contact:
        """Return the contact at a depth, from guesses of its edges."""
        return Contact(self, depth, guess)

    def half_length(self, depth: Value) -> Value:
        """Return a > 0 with h(a) = depth."""
        return _leading(self.shape, depth, self.start(depth))[0]

    def start(self, depth: Value) -> Value:
        """Return where the search for the half length of a contact at a depth begins."""
        if not d_.largest(depth - self.deepest) < 0.0:
            raise QuadratureError("the leading edge lies beyond the indenter's reach")
        return _spaced(self.shape, depth, depth, lambda x: 1.0)


def _spaced(
    shape: Convex,
    scale: Value,
    load: Value,
    width: Callable[[Value], Value],
    strides: tuple[float, ...] = STRIDES[:COARSE],
) -> Value:
    """Return the first of spaced points x where h times a width is the load, or the last."""
    most = NEAR_REACH * shape.reach
    x = d_.least(scale / strides[0], most)
    for stride in strides:
        wider = d_.least(x * stride, most)
        x = d_.pick(shape.height(wider) * width(wider) < load, wider, x)
    return d_.least(x * strides[-1], most)


def _within(shape: Convex, a: Value, factor: Value) -> Value:
    """Return a half length times a factor, at most halfway to the reach."""
    return d_.least(a * factor, 0.5 * (a + shape.reach))


def _leading(shape: Convex, depth: Value, a: Value) -> tuple[Value, Value]:
    """Return a > 0 with h(a) = depth, and d a/d(delta)."""
    active, moves = depth > 0.0, a
    for _ in range(MOST_STEPS):
        height, slope = shape.height(a), shape.slope(a)
        factor = (depth / height) ** (height / (a * slope))
        moves = d_.pick(active, 1.0 / slope, moves)
        a = d_.pick(active, _within(shape, a, factor), a)
        active = active & (abs(depth / height - 1.0) >= LINEAR)
        if not d_.some(active):
            return a, moves
    raise QuadratureError("the leading edge lies beyond the indenter's reach")


def _trailing(shape: Convex, l_r: Value, depth: Value, a: Value, x: Value) -> tuple[Value, Value]:
    """Return x in (0, a] with h(x) + l_r h'(x) = depth, and d x/d(delta)."""
    active, moves = depth > 0.0, x
    for _ in range(MOST_STEPS):
        slope = shape.slope(x)
        total = shape.height(x) + l_r * slope
        rise = slope * (x + l_r * shape.bend(x))
        factor = (depth / total) ** (total / rise)
        moves = d_.pick(active, x / rise, moves)
        # Where the slope hardly changes a step may overshoot the tip; the next ones approach from there.
        x = d_.pick(active, d_.least(-d_.least(-x * factor, -VERTEX * a), a), x)
        active = active & (abs(factor - 1.0) + abs(depth / total - 1.0) >= LINEAR)
        if not d_.some(active):
            return x, moves
    raise QuadratureError("the trailing edge was not found: it is too close to a vertex")


def _peak(shape: Convex, l_r: Value, depth: Value, a: Value) -> Value:
    """Return the highest p/K, at y = -x > 0: p' = 0 means y = l_r y h''/h', or it is at the leading edge.

    Every iterate is a pressure of this contact, so that the highest of them is never too high.
    """
    peak, last = l_r * shape.slope(a), (a, 0.0 * l_r)
    y, active = d_.least(l_r, a) + FLOOR * a, l_r >= 0.0
    for _ in range(PEAK_STEPS):
        slope = shape.slope(y)
        peak = -d_.least(-peak, -(depth - shape.height(y) + l_r * slope))
        to = l_r * shape.bend(y) + FLOOR * a
        gain = (to - last[1]) / (y - last[0] + TINY)
        last = y, to
        active = active & (abs(d_.least(to, a) / y - 1.0) >= PEAK_RTOL)
        if not d_.some(active):
            break
        y = d_.pick(active, d_.least(abs((to - gain * y) / (1.0 - gain + TINY)), a), y)
    return peak
