"""Steady sliding of a power law or a wedge in ball arithmetic: enclosures to hold the package against.

The shape is h = slope |x|^n/(n L^(n-1)), n >= 1. Everything follows from the definitions: h(a) = delta, no
pressure K (delta - h - l_r h') at the trailing edge, W = int p dx by its antiderivative, and F by the energy
balance F = K (u_TE^2/2 + l_r int h'^2 dx). Arguments are the exact values of floats.
"""

from typing import NamedTuple

from flint import arb, ctx

from tests.reference import BITS, WIDTH


class Shape(NamedTuple):
    slope: arb
    length: arb
    exponent: arb

    def height(self, x):
        return self.rise(x) * x / self.exponent

    def rise(self, x):
        """h' at x >= 0."""
        return self.slope * (x / self.length) ** (self.exponent - 1) if x != 0 else self._tip

    @property
    def _tip(self):
        return self.slope if self.exponent == 1 else arb(0)

    def area(self, x):
        """The integral of h from 0 to x."""
        return self.height(x) * x / (self.exponent + 1)

    def squares(self, x):
        """The integral of h'^2 from 0 to x."""
        return self.rise(x) ** 2 * x / (2 * self.exponent - 1)

    def half_length(self, depth):
        return self.length * (self.exponent * depth / (self.slope * self.length)) ** (
            1 / self.exponent
        )


def at_depth(slope, length, exponent, stiffness, retardation_time, velocity, depth):
    """Enclose every steady quantity at a given depth; floats or balls."""
    with ctx.workprec(BITS):
        shape = Shape(arb(slope), arb(length), arb(exponent))
        return _quantities(shape, *map(arb, (stiffness, retardation_time, velocity, depth)))


def at_load(slope, length, exponent, stiffness, retardation_time, velocity, weight, spring=0.0):
    """Enclose every steady quantity under a weight, on a spring relaxed at the static depth."""
    with ctx.workprec(BITS):
        shape = Shape(arb(slope), arb(length), arb(exponent))
        K, tau, V, weight, k_s = map(arb, (stiffness, retardation_time, velocity, weight, spring))
        n, L = shape.exponent, shape.length
        a_0 = ((n + 1) * L ** (n - 1) * weight / (2 * K * shape.slope)) ** (1 / (n + 1))
        static = shape.height(a_0)
        depth = static
        if V != 0:
            depth = _depth(shape, K, abs(V) * tau, weight + k_s * static, k_s, static)
        return _quantities(shape, K, tau, V, depth)


def trailing_edge(shape, l_r, a):
    """Enclose x_TE > 0 with h + l_r h' = h(a): for a wedge it may be 0, the tip."""
    n, c = shape.exponent, shape.exponent * l_r / a
    if n == 1:
        return (a - l_r).max(arb(0))
    if l_r == 0:
        return a

    def excess(t):
        return (n - 1) * t + (t.exp() + c).log()

    t = arb(0) if c < 1 else -c.log() / (n - 1)
    t = t.mid()
    for _ in range(400):
        share = t.exp() / (t.exp() + c)
        step = (excess(t) / (n - 1 + share)).mid()
        t = (t - step).mid()
        if abs(step) < WIDTH:
            break
    for widening in range(0, 200, 20):  # the ball of c may itself be wider
        width = WIDTH * arb(2) ** widening
        if excess(t - width) < 0 < excess(t + width):
            return a * arb(t, width).exp()
    raise ArithmeticError("the trailing edge was not enclosed")


def _load(shape, K, l_r, depth):
    """W and dW/d(delta)."""
    a = shape.half_length(depth)
    x_te = trailing_edge(shape, l_r, a)
    elastic = depth * (x_te + a) - shape.area(x_te) - shape.area(a)
    u_te = depth - shape.height(x_te)
    return K * (elastic + l_r * u_te), K * (x_te + a + l_r)


def _depth(shape, K, l_r, total, spring, guess):
    """Enclose the root of W(delta) + k_s delta = total, by Newton's method and a change of sign."""
    depth = guess.mid()
    width = WIDTH * 2**40
    for _ in range(400):
        load, slope = _load(shape, K, l_r, depth)
        step = ((total - load - spring * depth) / (slope + spring)).mid()
        depth = max((depth + step).mid(), depth / 1000)
        if abs(step) < depth * WIDTH * 2**20:
            break
    low, high = depth * (1 - width), depth * (1 + width)
    below, above = (_load(shape, K, l_r, d)[0] + spring * d for d in (low, high))
    if not below < total < above:
        raise ArithmeticError("the depth was not enclosed")
    return arb(depth, depth * width)


def _quantities(shape, K, tau, V, depth):
    l_r = abs(V) * tau
    side = -1 if V < 0 else 1
    a = shape.half_length(depth)
    x_te = trailing_edge(shape, l_r, a)
    load, _ = _load(shape, K, l_r, depth)
    u_te = depth - shape.height(x_te)
    lost = K * l_r * (shape.squares(x_te) + shape.squares(a))
    friction = K * u_te**2 / 2 + lost
    x_peak = a.min((shape.exponent - 1) * l_r)
    peak = K * (depth - shape.height(x_peak) + l_r * shape.rise(x_peak))
    moving = l_r > 0
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * x_te,
        "load": load,
        "friction_force": side * friction if moving else arb(0),
        "friction_coefficient": side * friction / load if moving else arb(0),
        "peak_pressure": peak,
        "dissipated_in_contact": lost / friction if moving else arb(1),
    }
