"""Steady sliding of a parabola in ball arithmetic: rigorous enclosures to hold the package against.

Everything follows from the definitions: the edges of Eqs. 26 and 27, the pressure
p = K (delta - h - l_r h'), and W = int p dx, F = int -h' p dx. `at_depth` and `at_load` integrate the
polynomials by their antiderivatives; `integrals` lets Arb enclose the integrals themselves. Arguments
are the exact values of floats; the precision leaves 60 digits after the worst cancellation.
"""

from flint import acb, arb, ctx

BITS = 600
"""Twelve decades of drive number either way cost up to 250 bits in differences."""
WIDTH = arb(2) ** -420
"""Relative half width of the interval in which the sign of the balance is shown to change; the
static depth, which enters the balance on a spring, is enclosed more narrowly."""


def at_depth(radius, stiffness, retardation_time, velocity, depth):
    """Enclose every steady quantity at a given depth; a float, an integer or a ball."""
    with ctx.workprec(BITS):
        return _quantities(*_exact(radius, stiffness, retardation_time, velocity, depth))


def at_load(radius, stiffness, retardation_time, velocity, weight, spring=0.0):
    """Enclose every steady quantity under a weight, on a spring relaxed at the static depth."""
    with ctx.workprec(BITS):
        R, K, tau, V, weight, k_s = _exact(
            radius, stiffness, retardation_time, velocity, weight, spring
        )
        l_r = abs(V) * tau
        guess = ((weight / K) ** 2 / R).root(3)
        static = _depth(R, K, arb(0), weight, arb(0), guess, WIDTH / 2**60)
        total = weight + k_s * static
        depth = _depth(R, K, l_r, total, k_s, static, WIDTH) if l_r > 0 else static
        return _quantities(R, K, tau, V, depth)


def integrals(radius, stiffness, retardation_time, velocity, depth):
    """Enclose W and F of `at_depth` as integrals of the definitions, for V >= 0."""
    with ctx.workprec(BITS):
        R, K, tau, V, depth = _exact(radius, stiffness, retardation_time, velocity, depth)
        l_r = V * tau
        x_le, x_te = _edges(R, l_r, depth)

        def pressure(x, _):
            return K * (depth - x * x / (2 * R) - l_r * x / R)

        def friction(x, _):
            return -x / R * pressure(x, _)

        return acb.integral(pressure, x_le, x_te).real, acb.integral(friction, x_le, x_te).real


def relative_error(value, truth):
    """Bound |value - truth|/|truth| as a float; where the truth is zero, 0 or infinity."""
    with ctx.workprec(BITS):
        if truth == 0:
            return 0.0 if value == 0 else float("inf")
        return float((abs(arb(value) - truth) / abs(truth)).upper())


def _exact(*values):
    return [arb(value) for value in values]


def _edges(R, l_r, depth):
    a_squared = 2 * R * depth  # Eq. 28
    return -a_squared.sqrt(), (a_squared + l_r * l_r).sqrt() - l_r  # Eqs. 26, 27


def _load(R, K, l_r, depth):
    """W and dW/d(delta), the pressure being zero at the one edge and K l_r |h'| at the other."""
    x_le, x_te = _edges(R, l_r, depth)
    width = x_te - x_le
    squares, cubes = x_te**2 - x_le**2, x_te**3 - x_le**3
    return K * (depth * width - cubes / (6 * R) - l_r * squares / (2 * R)), K * (width + l_r)


def _depth(R, K, l_r, total, spring, guess, width):
    """Enclose the root of W(delta) + k_s delta = total by Newton's method and a change of sign."""
    depth = guess.mid()
    for _ in range(200):
        load, slope = _load(R, K, l_r, depth)
        step = ((total - load - spring * depth) / (slope + spring)).mid()
        depth = (depth + step).mid()
        if abs(step) < depth * width:
            break
    low, high = depth * (1 - width), depth * (1 + width)
    if not (
        _load(R, K, l_r, low)[0] + spring * low < total < _load(R, K, l_r, high)[0] + spring * high
    ):
        raise ArithmeticError("the depth was not enclosed")
    return arb(depth, depth * width)


def _quantities(R, K, tau, V, depth):
    l_r = abs(V) * tau  # Eq. 29
    side = -1 if V < 0 else 1
    x_le, x_te = _edges(R, l_r, depth)
    load, _ = _load(R, K, l_r, depth)
    squares, cubes, fourths = (x_te**n - x_le**n for n in (2, 3, 4))
    friction = -K / R * (depth * squares / 2 - fourths / (8 * R) - l_r * cubes / (3 * R))
    lost = K * l_r * cubes / (3 * R * R)  # C V int h'^2 dx
    x_peak = x_le.max(-l_r)  # where p' = 0, or the edge beyond which it lies
    return {
        "depth": depth,
        "half_length": -x_le,
        "retardation_length": l_r,
        "leading_edge": side * x_le,
        "trailing_edge": side * x_te,
        "load": load,
        "friction_force": side * friction if l_r > 0 else arb(0),
        "friction_coefficient": side * friction / load if l_r > 0 else arb(0),
        "peak_pressure": K * (depth - x_peak**2 / (2 * R) - l_r * x_peak / R),
        "dissipated_in_contact": lost / friction if l_r > 0 else arb(1),
    }
