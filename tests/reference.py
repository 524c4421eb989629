"""Steady sliding in ball arithmetic: rigorous enclosures to hold the package against.

A shape gives, over the stiffness and from the definitions, its static depth, its load and all that follows
from a depth; `steady` adds the support. Arguments are the exact values of floats; the precision leaves 60
digits after the worst cancellation.
"""

from dataclasses import dataclass, fields

from flint import acb, arb, ctx

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

    return at_depth, at_load


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


at_depth, at_load = steady(Parabola)


def integrals(radius, stiffness, retardation_time, velocity, depth):
    """Enclose W and F of a parabola as integrals of the definitions, for V >= 0."""
    with ctx.workprec(BITS):
        R, K, tau, V, depth = map(arb, (radius, stiffness, retardation_time, velocity, depth))
        ends = Parabola(R).edges(V * tau, depth)

        def pressure(x, _):
            return K * (depth - x * x / (2 * R) - V * tau * x / R)

        friction = acb.integral(lambda x, _: -x / R * pressure(x, _), *ends)
        return acb.integral(pressure, *ends).real, friction.real


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
