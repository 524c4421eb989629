"""Steady sliding of a parabola on viscoelastic foundations, to hundreds of digits by ball arithmetic.

By the iterated integrals G_n of the relaxation function, as theorem F17 prints them; they cancel, which does
not matter with so many digits, and share nothing with the moments that the package evaluates:

    p = (a G_1 - G_2)/R,  a = G_2(c)/G_1(c),  W = (G_2^2/G_1 - G_3)/R,
    F = [a W - (a (c G_2 - G_3) - c G_3 + G_4)/R]/R.
"""

from flint import arb, ctx

import kvtheory as kv
from kvtheory.models.steady.methods import solve_exact
from kvtheory.theory import laws
from tests import reference

BITS = 1100
"""The cancellation of G_4 takes four times the decades of the fastest arm over the contact."""
WIDTH = arb(2) ** -300


class Prony:
    """G = K + sum K_i e^(-X/l_i), and l_C delta(X) of a damper, which is the last of an odd number."""

    def __init__(self, K, V, parameters):
        self.K, pairs = K, list(map(arb, parameters))
        self.damper = abs(V) * pairs.pop() if len(pairs) % 2 else arb(0)
        self.arms = [(k, abs(V) * tau) for k, tau in zip(pairs[0::2], pairs[1::2], strict=True)]
        self.arms = self.arms if V != 0 else []

    def integrals(self, X):
        """G_0 to G_4."""
        sums = [self.K * X**n / arb(n).fac() for n in range(5)]
        for n in range(1, 5):
            sums[n] += self.damper * X ** (n - 1) / arb(n - 1).fac()
        for stiffness, l in self.arms:
            inner = (-X / l).exp()
            for n in range(5):
                sums[n] += stiffness * inner
                inner = l * (X**n / arb(n).fac() - inner)
        return sums

    def stored(self, R, a, c):
        """Energy of the arms where the contact ends."""
        total = arb(0)
        for stiffness, l in self.arms:
            first = l * (1 - (-c / l).exp())
            total += stiffness * ((a * first - l * (c - first)) / R) ** 2 / 2
        return total


class Fractional:
    """G = K [1 + (X/l)^(-alpha)/Gamma(1 - alpha)]."""

    def __init__(self, K, V, parameters):
        tau, self.alpha = map(arb, parameters)
        self.K, self.l = K, abs(V) * tau

    def integrals(self, X):
        """G_0 to G_4."""
        return [
            self.K * (X**n / arb(n).fac() + self.l**self.alpha * X ** (n - self.alpha)
                      * (n + 1 - self.alpha).rgamma())
            for n in range(5)
        ]  # fmt: skip

    def stored(self, R, a, c):
        """Energy of the springpot's arms where the contact ends: 1/2 int int G(w + w') u' u' dw dw'."""
        alpha, shift = self.alpha, a / c - 1
        two = arb(2) ** -alpha
        none = (4 * two - 2) / ((1 - alpha) * (2 - alpha))
        once = (8 * two - 2) / (2 * (2 - alpha) * (3 - alpha))
        both = 2 * (1 - 2 * two * alpha) / ((1 - alpha) * (2 - alpha) * (4 - alpha))
        whole = (both + 2 * shift * once + shift**2 * none) * (1 - alpha).rgamma()
        return self.K * (self.l / c) ** alpha * (c**2 / R) ** 2 * whole / 2


LAWS = {laws.Prony: Prony, laws.Fractional: Fractional}


def at_depth(law, parameters, radius, stiffness, retardation_time, velocity, depth):
    """Every steady quantity at a given depth."""
    with ctx.workprec(BITS):
        R, K, tau, V, depth = map(arb, (radius, stiffness, retardation_time, velocity, depth))
        row, a = LAWS[law](K, V, parameters), (2 * R * depth).sqrt()

        def excess(c):
            sums = row.integrals(c)
            return sums[2] / sums[1] - a, 1 - sums[2] * sums[0] / sums[1] ** 2

        return _quantities(R, row, tau, V, _root(excess, 1.5 * a))


def at_load(law, parameters, radius, stiffness, retardation_time, velocity, weight, spring=0.0):
    """Every steady quantity under a weight, on a spring relaxed at the static depth."""
    with ctx.workprec(BITS):
        R, K, tau, V, weight, k = map(
            arb, (radius, stiffness, retardation_time, velocity, weight, spring)
        )
        row = LAWS[law](K, V, parameters)
        a_0 = (3 * R * weight / (2 * K)) ** (arb(1) / 3)
        total = weight + k * a_0**2 / (2 * R)

        def excess(y):  # of the logarithm of the load, against that of c
            c = y.exp()
            sums = row.integrals(c)
            a, grows = sums[2] / sums[1], 1 - sums[2] * sums[0] / sums[1] ** 2
            load = (sums[2] * a - sums[3]) / R + k * a**2 / (2 * R)
            return (load / total).log(), c * grows * (sums[2] + k * a) / R / load

        return _quantities(R, row, tau, V, _root(excess, (2 * a_0).log()).exp())


def _root(excess, start):
    """Newton's method, and a change of sign around what it finds."""
    x = start.mid()
    for _ in range(200):
        value, slope = excess(x)
        step = (value / slope).mid()
        x = (x - step).mid()
        if abs(step) < WIDTH * abs(x):
            low, high = (excess(x + side * WIDTH * 2**20 * abs(x))[0] for side in (-1, 1))
            assert low < 0 < high
            return arb(x, WIDTH * 2**20 * abs(x))
    raise ArithmeticError("no root was found")


def _quantities(R, row, tau, V, c):
    G = row.integrals(c)
    a = G[2] / G[1]
    load = (G[2] * a - G[3]) / R
    friction = (a * load - (a * (c * G[2] - G[3]) - c * G[3] + G[4]) / R) / R
    side = -1 if V < 0 else 1
    found = {
        "depth": a**2 / (2 * R), "half_length": a, "retardation_length": abs(V) * tau,
        "leading_edge": -side * a, "trailing_edge": side * (c - a), "load": load,
        "friction_force": side * friction, "friction_coefficient": side * friction / load,
        "peak_pressure": _peak(R, row, a),
    }  # fmt: skip
    if V != 0 and not (isinstance(row, Fractional) and row.alpha == 1):
        left = row.K * (c * (2 * a - c) / (2 * R)) ** 2 / 2 + row.stored(R, a, c)
        found["dissipated_in_contact"] = 1 - left / friction
    return found


def _peak(R, row, a):
    """The pressure where a G = G_1, which bisection finds well enough: it is a maximum."""
    low, high = (a * 1e-40).log().mid(), a.log().mid()
    for _ in range(200):
        y = ((low + high) / 2).mid()
        sums = row.integrals(y.exp())
        low, high = (y, high) if a * sums[0] > sums[1] else (low, y)
    sums = row.integrals(y.exp())
    return (a * sums[1] - sums[2]) / R


def random_case(rng, kind, *, damped=False):
    """1 to 20 arms over ten decades, beta from 1e-3 to 1e6, V within twelve decades; any support, damper."""
    R, K, time = (float(10.0 ** rng.uniform(*ends)) for ends in ((-4, 0), (6, 12), (-4, 2)))
    weight = float(10.0 ** rng.uniform(0, 5))
    a = (1.5 * R * weight / K) ** (1 / 3)
    V = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-6, 6) * a / time)
    if rng.random() < 0.2 and not damped:
        law, parameters = laws.Fractional, (time, float(rng.choice([rng.uniform(), 1.0])))
    else:
        law, parameters = laws.Prony, []
        for _ in range(rng.integers(1, 21)):
            parameters += [K * 10.0 ** rng.uniform(-3, 6), time * 10.0 ** rng.uniform(-5, 5)]
        parameters += [K * time * 10.0 ** rng.uniform(-5, 5)] if damped else []
        parameters = tuple(map(float, parameters))
    given = (law, parameters, R, K, time, V)
    if kind == "fixed":
        return (*given, float(a * a / (2 * R)))
    spring = 0.0 if kind == "dead-weight" else float(weight / a * 10 ** rng.uniform(-4, 4))
    return (*given, weight, spring)


def scene_of(case):
    """Return the scene of a case."""
    law, parameters, R, K, _, V, *grip = case
    if law is laws.Fractional:
        foundation = kv.FractionalKelvinVoigt(K, *parameters)
    else:
        arms = list(zip(parameters[::2], parameters[1::2], strict=False))
        damping = parameters[-1] if len(parameters) % 2 else 0.0
        foundation = kv.GeneralizedMaxwell(K, arms=arms, damping=damping)
    if len(grip) == 1:
        support = kv.Fixed(*grip)
    else:
        load, spring = grip
        support = kv.Suspended(load=load, stiffness=spring) if spring else kv.DeadWeight(load=load)
    return kv.Scene(kv.Parabola(R), foundation, support, kv.Drive(V))


def errors(case):
    """The relative error of each quantity, over the one that is claimed."""
    state, truth = solve_exact(scene_of(case)), (at_depth if len(case) == 7 else at_load)(*case)
    del truth["retardation_length"]  # of a time that the case gives
    claimed = state.certificate.relative_error
    return {
        key: reference.relative_error(getattr(state, key), truth[key]) / claimed[key]
        for key in truth
    }
