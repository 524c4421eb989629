"""Steady sliding of a ball in ball arithmetic: rigorous enclosures to hold the package against.

`at_depth` and `at_load` evaluate the sums over the strips as they are printed in books, with so many digits
that their cancellation does not matter; `integrals` lets Arb enclose the double integrals of the pressure.
"""

from flint import acb, arb, ctx

from tests.reference import BITS, WIDTH


def at_depth(radius, across, stiffness, retardation_time, velocity, depth):
    """Enclose every steady quantity at a given depth."""
    with ctx.workprec(BITS):
        return _quantities(
            *map(arb, (radius, across, stiffness, retardation_time, velocity, depth))
        )


def at_load(radius, across, stiffness, retardation_time, velocity, weight, spring=0.0):
    """Enclose every steady quantity under a weight, on a spring relaxed at the static depth."""
    with ctx.workprec(BITS):
        R, S, K, tau, V, weight, k_s = map(
            arb, (radius, across, stiffness, retardation_time, velocity, weight, spring)
        )
        static = (weight / (arb.pi() * K * (R * S).sqrt())).sqrt()
        depth = _depth(R, S, K, abs(V) * tau, weight + k_s * static, k_s, static)
        return _quantities(R, S, K, tau, V, depth)


def integrals(radius, across, stiffness, retardation_time, velocity, depth):
    """Enclose W and F of `at_depth` as integrals over the contact, for V > 0: y = b sin(t)."""
    with ctx.workprec(100):
        R, S, K, tau, V, depth = map(
            arb, (radius, across, stiffness, retardation_time, velocity, depth)
        )
        l_r, b = V * tau, (2 * S * depth).sqrt()

        def strip(t, power):
            d = depth * t.cos() ** 2
            a = (2 * R * depth).sqrt() * t.cos()
            x_te = (2 * R * d + l_r * l_r).sqrt() - l_r
            sums = [x_te**n - (-a) ** n for n in range(5)]
            load = d * sums[1] - sums[3] / (6 * R) - l_r * sums[2] / (2 * R)
            friction = -(d * sums[2] / 2 - sums[4] / (8 * R) - l_r * sums[3] / (3 * R)) / R
            return (friction if power else load) * b * t.cos() * K

        ends = acb(0), acb(arb.pi() / 2)
        return [2 * acb.integral(lambda t, _, n=n: strip(t, n), *ends).real for n in (0, 1)]


def _load(R, S, K, l, depth):
    """W = (K/8R) sqrt(R'/R) [pi a^4 + 2 a^3 l - 2 a l^3 + 2 (a^2 + l^2)^2 arctan(a/l)], dW/d(delta)."""
    a = (2 * R * depth).sqrt()
    theta = (a / l).atan() if l > 0 else arb.pi() / 2
    scale, r = K / (8 * R) * (S / R).sqrt(), a * a + l * l
    load = scale * (arb.pi() * a**4 + 2 * a**3 * l - 2 * a * l**3 + 2 * r * r * theta)
    slope = scale * (4 * arb.pi() * a**3 + 8 * a * a * l + 8 * a * r * theta)
    return load, slope * R / a


def _depth(R, S, K, l, total, spring, guess):
    """Enclose the root of W(delta) + k_s delta = total by Newton's method and a change of sign."""
    depth = guess.mid()
    for _ in range(500):
        load, slope = _load(R, S, K, l, depth)
        step = ((total - load - spring * depth) / (slope + spring)).mid()
        depth = (depth + step).mid() if depth + step > 0 else depth / 2
        if abs(step) < depth * WIDTH:
            break
    low, high = depth * (1 - 2 * WIDTH), depth * (1 + 2 * WIDTH)
    if not _load(R, S, K, l, low)[0] + spring * low < total:
        raise ArithmeticError("the depth was not enclosed")
    if not total < _load(R, S, K, l, high)[0] + spring * high:
        raise ArithmeticError("the depth was not enclosed")
    return arb(depth, depth * 2 * WIDTH)


def _quantities(R, S, K, tau, V, depth):
    l = abs(V) * tau
    side = -1 if V < 0 else 1
    a = (2 * R * depth).sqrt()
    load, _ = _load(R, S, K, l, depth)
    friction = l / R * (load - K * l * a**3 * 2 / (3 * R) * (S / R).sqrt())
    theta = (a / l).atan() if l > 0 else arb.pi() / 2
    behind = K * l * l / R**2 * (2 * a**3 / 3 + a * l * l - l * (a * a + l * l) * theta)
    x = (-a).max(-l)  # where the pressure of the middle plane is greatest
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l,
        "leading_edge": -side * a,
        "trailing_edge": side * ((a * a + l * l).sqrt() - l),
        "load": load,
        "friction_force": side * friction if l > 0 else arb(0),
        "friction_coefficient": side * friction / load if l > 0 else arb(0),
        "peak_pressure": K * (depth - x * x / (2 * R) - l * x / R),
        "dissipated_in_contact": 1 - behind * (S / R).sqrt() / friction if l > 0 else arb(1),
    }
