"""The rates of small motions about steady sliding with many digits, from the equations of motion alone.

The forces are integrals of the pressure between edges that are found anew at each state; their Jacobian is
taken numerically. Nothing here is shared with the closed forms, nor with the derivations.
"""

import mpmath as mp
import numpy as np

DIGITS = 80


def forces(d, rate, lam):
    """Return f_z and f_x in units of the static state: pressure integrated from edge to edge."""
    left, right = -mp.sqrt(d), mp.sqrt(d + rate + lam**2) - lam
    pressure = (0, d + rate), (1, -2 * lam), (2, -1)  # powers of x and their factors

    def moment(n):
        powers = ((n + power + 1, factor) for power, factor in pressure)
        return sum(factor * (right**k - left**k) / k for k, factor in powers)

    return mp.mpf(3) / 4 * moment(0), -mp.mpf(3) / 2 * moment(1)


def steady_depth(lam, kappa, guess):
    return mp.findroot(lambda d: forces(d, 0, lam)[0] + kappa * (d - 1) - 1, guess)


def slopes(lam, d):
    """Return the derivatives of both forces by depth, rate and drive number, by central differences."""
    h = mp.mpf(10) ** -(mp.mp.dps // 3)
    point = [d, mp.mpf(0), lam]
    found = []
    for which in range(3):
        # Fourth order: the remainder is that of the fifth power of the step.
        values = []
        for step in (-2, -1, 1, 2):
            moved = list(point)
            moved[which] += step * h * (1 + abs(point[which]))
            values.append(forces(*moved))
        width = 12 * h * (1 + abs(point[which]))
        found.append([(a - 8 * b + 8 * c - e) / width for a, b, c, e in zip(*values, strict=True)])
    return found


def quartic(lam, eps, kappa, eps_x, c_x, kappa_x, guess):
    """Return the characteristic polynomial, from the highest coefficient on: a 2 by 2 determinant."""
    d = steady_depth(lam, kappa, guess)
    (z_d, x_d), (z_r, x_r), (z_l, x_l) = slopes(lam, d)
    across, along = [eps, z_r, z_d + kappa], [eps_x, x_l + c_x, kappa_x]
    # d: across d - z_l s x = 0;  x: along x - (x_d + x_r s) d = 0
    product = [mp.mpf(0)] * 5
    for i, a in enumerate(across):
        for j, b in enumerate(along):
            product[i + j] += a * b
    product[2] -= z_l * x_r
    product[3] -= z_l * x_d
    return product


def scaled(values):
    """Return drive number, inertia, support, inertia, damper and spring numbers along x of SI values."""
    of = {key: mp.mpf(float(value)) for key, value in values.items()}
    K, tau = of["foundation.stiffness"], of["foundation.retardation_time"]
    R = of["indenter.radius"]
    W = of["support.load"]
    a_0 = mp.cbrt(mp.mpf(3) / 2 * R * W / K)
    delta_0 = a_0**2 / (2 * R)
    along = a_0**2 / (W * delta_0)
    return {
        "lam": abs(of["drive.velocity"]) * tau / a_0,
        "eps": of["support.mass"] * delta_0 / (W * tau**2),
        "kappa": of.get("support.stiffness", mp.mpf(0)) * delta_0 / W,
        "eps_x": of["drive.mass"] * along / tau**2,
        "c_x": of["drive.damping"] * along / tau,
        "kappa_x": of["drive.stiffness"] * along,
        "along": along,
    }


def critical(numbers, guess):
    """Return the largest kappa_x at which the determinant of Hurwitz vanishes, and the frequency there."""

    def hurwitz(kappa_x):
        a4, a3, a2, a1, a0 = quartic(**{**numbers, "kappa_x": kappa_x}, guess=guess)
        return a1 * (a2 * a3 - a1 * a4) - a3**2 * a0, a1 / a3

    # Quadratic in kappa_x: three values give it.
    unit = numbers["eps_x"] / numbers["eps"] if numbers["eps"] > 1 else mp.mpf(1)
    at = [hurwitz(k * unit)[0] for k in (0, 1, 2)]
    c0, c2 = at[0], (at[2] - 2 * at[1] + at[0]) / 2
    c1 = at[1] - at[0] - c2
    square = c1**2 - 4 * c2 * c0
    if square < 0:
        return None
    root = (-c1 + mp.sqrt(square)) / (2 * c2) * unit
    return None if root <= 0 else (root, mp.sqrt(hurwitz(root)[1]))


def random_scenes(count, seed, decades):
    """Yield SI values of scenes that scatter over powers of ten about Table 1."""
    rng = np.random.default_rng(seed)
    for _ in range(count):

        def about(value):
            return value * 10.0 ** rng.uniform(-decades, decades)

        yield {
            "indenter.radius": about(0.01),
            "foundation.stiffness": about(1e10),
            "foundation.retardation_time": about(0.1),
            "support.load": about(9806.65),
            "support.mass": about(1000.0),
            "drive.velocity": about(0.1) * rng.choice([-1.0, 1.0]),
            "drive.stiffness": about(1e7),
            "drive.mass": about(1000.0),
            "drive.damping": rng.choice([0.0, about(1e4)]),
            **({} if rng.random() < 0.5 else {"support.stiffness": about(3e7)}),
        }
