"""Steady sliding in ball arithmetic: rigorous enclosures to hold the package against.

A shape gives, over the stiffness and from the definitions, its static depth, its load and all that follows
from a depth; `steady` adds the support. Arguments are the exact values of floats; the precision leaves 60
digits after the worst cancellation.
"""

from dataclasses import dataclass, fields
from types import SimpleNamespace

from flint import arb, ctx

BITS = 600
"""Twelve decades of drive number either way cost up to 250 bits in differences."""
WIDTH = arb(2) ** -420
"""Relative half width of an interval in which a sign is shown to change."""


def steady(shape):
    """Return `at_depth(*shape, K, tau, V, depth)` and `at_load(*shape, K, tau, V, weight, spring=0)`.

    Both enclose every steady quantity; the spring is relaxed at the static depth.
    """
    count = len(fields(shape))

    def at_depth(*given):
        with ctx.workprec(BITS):
            given = list(map(arb, given))
            return quantities(shape(*given[:count]), *given[count:])

    def at_load(*given):
        with ctx.workprec(BITS):
            given = list(map(arb, given))
            body, (K, tau, V, weight, *spring) = shape(*given[:count]), given[count:]
            k = spring[0] / K if spring else arb(0)
            depth = static = body.static_depth(weight / K)
            if V != 0:
                depth = _depth(body, abs(V) * tau, weight / K + k * static, k, static)
            return quantities(body, K, tau, V, depth)

    return SimpleNamespace(at_depth=at_depth, at_load=at_load)


def _depth(body, l_r, total, spring, guess):
    """Enclose the root of W/K + k depth = total by Newton's method and a change of sign."""
    depth, width = guess.mid(), WIDTH * 2**40
    for _ in range(500):
        load, slope = body.load(l_r, depth)
        step = ((total - load - spring * depth) / (slope + spring)).mid()
        depth = max((depth + step).mid(), (depth / 1000).mid())
        if abs(step) < depth * WIDTH * 2**20:
            break
    low, high = depth * (1 - width), depth * (1 + width)
    below, above = (body.load(l_r, d)[0] + spring * d for d in (low, high))
    if not below < total < above:
        raise ArithmeticError("the depth was not enclosed")
    return arb(depth, depth * width)


def quantities(body, K, tau, V, depth):
    """Enclose every steady quantity at a depth."""
    l_r, side = abs(V) * tau, -1 if V < 0 else 1
    load, _ = body.load(l_r, depth)
    a, x_te, friction, lost, peak = body.contact(l_r, depth, load)
    moving = l_r > 0
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * x_te,
        "load": K * load,
        "friction_force": side * K * friction if moving else arb(0),
        "friction_coefficient": side * friction / load if moving else arb(0),
        "peak_pressure": K * peak,
        "dissipated_in_contact": lost / friction if moving else arb(1),
    }


@dataclass
class Parabola:
    """Integrals of p = delta - h - l_r h' and of -h' p by their antiderivatives (Eqs. 26, 27)."""

    radius: arb

    def static_depth(self, weight):
        return ((3 * weight / 4) ** 2 / (2 * self.radius)).root(3)

    def edges(self, l_r, depth):
        a_squared = 2 * self.radius * depth  # Eq. 28
        return -a_squared.sqrt(), (a_squared + l_r * l_r).sqrt() - l_r

    def powers(self, l_r, depth):
        """Integrals of x^0 to x^3 over the contact."""
        x_le, x_te = self.edges(l_r, depth)
        return [(x_te**n - x_le**n) / n for n in range(1, 5)]

    def load(self, l_r, depth):
        one, x, square, _ = self.powers(l_r, depth)
        return depth * one - (square / 2 + l_r * x) / self.radius, one + l_r

    def contact(self, l_r, depth, load):
        _, x, square, cube = self.powers(l_r, depth)
        R, (x_le, x_te) = self.radius, self.edges(l_r, depth)
        friction = -(depth * x - (cube / 2 + l_r * square) / R) / R
        x_peak = x_le.max(-l_r)  # where p' = 0, or the edge beyond which it lies
        peak = depth - x_peak**2 / (2 * R) - l_r * x_peak / R
        return -x_le, x_te, friction, l_r * square / (R * R), peak  # lost: l_r int h'^2 dx


@dataclass
class Ball:
    """The sums over its strips as books print them: with so many digits cancellation does not matter."""

    radius: arb
    across: arb

    def static_depth(self, weight):
        return (weight / (arb.pi() * (self.radius * self.across).sqrt())).sqrt()

    def _theta(self, l_r, a):
        return (a / l_r).atan() if l_r > 0 else arb.pi() / 2

    def load(self, l_r, depth):
        """sqrt(R'/R) [pi a^4 + 2 a^3 l - 2 a l^3 + 2 (a^2 + l^2)^2 arctan(a/l)]/(8 R), and its slope."""
        R, l = self.radius, l_r
        a = (2 * R * depth).sqrt()
        theta, r = self._theta(l, a), a * a + l * l
        scale = (self.across / R).sqrt() / (8 * R)
        load = scale * (arb.pi() * a**4 + 2 * a**3 * l - 2 * a * l**3 + 2 * r * r * theta)
        slope = scale * (4 * arb.pi() * a**3 + 8 * a * a * l + 8 * a * r * theta)
        return load, slope * R / a

    def contact(self, l_r, depth, load):
        R, l, stretch = self.radius, l_r, (self.across / self.radius).sqrt()
        a, x_te, _, _, peak = Parabola(R).contact(l, depth, load)
        friction = l / R * (load - 2 * l * a**3 / (3 * R) * stretch)
        behind = 2 * a**3 / 3 + a * l * l - l * (a * a + l * l) * self._theta(l, a)
        return a, x_te, friction, friction - l * l / R**2 * behind * stretch, peak


@dataclass
class PowerLaw:
    """A power law or a wedge, h = slope |x|^n/(n L^(n-1)), n >= 1, from the definitions.

    h(a) = delta, no pressure delta - h - l_r h' at the trailing edge, W = int p dx by its antiderivative, and
    F by the energy balance F = u_TE^2/2 + l_r int h'^2 dx.
    """

    slope: arb
    length: arb
    exponent: arb

    def height(self, x):
        return self.rise(x) * x / self.exponent

    def rise(self, x):
        """h' at x >= 0."""
        tip = self.slope if self.exponent == 1 else arb(0)
        return self.slope * (x / self.length) ** (self.exponent - 1) if x != 0 else tip

    def static_depth(self, weight):
        n, L = self.exponent, self.length
        a_0 = ((n + 1) * L ** (n - 1) * weight / (2 * self.slope)) ** (1 / (n + 1))
        return self.height(a_0)

    def edges(self, l_r, depth):
        n, L = self.exponent, self.length
        a = L * (n * depth / (self.slope * L)) ** (1 / n)
        return a, self.trailing_edge(l_r, a)

    def trailing_edge(self, l_r, a):
        """Enclose x_TE > 0 with h + l_r h' = h(a): for a wedge it may be 0, the tip."""
        n, c = self.exponent, self.exponent * l_r / a
        if n == 1:
            return (a - l_r).max(arb(0))
        if l_r == 0:
            return a

        def excess(t):
            return (n - 1) * t + (t.exp() + c).log()

        t = (arb(0) if c < 1 else -c.log() / (n - 1)).mid()
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

    def load(self, l_r, depth):
        edges = a, x_te = self.edges(l_r, depth)
        below = sum(self.height(x) * x / (self.exponent + 1) for x in edges)
        u_te = depth - self.height(x_te)
        return depth * (x_te + a) - below + l_r * u_te, x_te + a + l_r

    def contact(self, l_r, depth, load):
        n, (a, x_te) = self.exponent, self.edges(l_r, depth)
        lost = l_r * sum(self.rise(x) ** 2 * x / (2 * n - 1) for x in (x_te, a))
        x_peak = a.min((n - 1) * l_r)
        peak = depth - self.height(x_peak) + l_r * self.rise(x_peak)
        return a, x_te, (depth - self.height(x_te)) ** 2 / 2 + lost, lost, peak


parabola, ball, power_law = steady(Parabola), steady(Ball), steady(PowerLaw)


def relative_error(value, truth):
    """Bound |value - truth|/|truth| as a float; where the truth is zero, 0 or infinity."""
    with ctx.workprec(BITS):
        if truth == 0:
            return 0.0 if value == 0 else float("inf")
        return float((abs(arb(value) - truth) / abs(truth)).upper())


def excess(state, truth):
    """Return the quantities of a state that are further from the truth than they claim, with both errors."""
    claimed = state.certificate.relative_error
    errors = {name: relative_error(float(getattr(state, name)), truth[name]) for name in truth}
    return {name: (e, claimed[name]) for name, e in errors.items() if not e <= claimed[name]}
