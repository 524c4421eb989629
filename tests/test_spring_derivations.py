"""Derivations F22 against equations written on their own, with many digits."""

from functools import cache
from itertools import pairwise

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import (
    rubber_drive,
    spring_drive,
    spring_ringing,
    spring_stability,
)

from tests import reference_stability as reference

SCENES = (  # drive, inertia and support number, then inertia, damper and spring number along x
    ("0.3", "0.01", "0", "0.2", "0", "1.5"),
    ("1.7", "0.4", "0", "3", "0.2", "0.7"),
    ("6", "20", "2.5", "0.5", "0", "40"),
)


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(reference.DIGITS):
        yield


def contact(scene):
    """Return the numbers of a scene, and its steady contact: depth, half length and edge."""
    lam, eps, kappa, eps_x, c_x, kappa_x = map(mp.mpf, scene)
    depth = reference.steady_depth(lam, kappa, mp.mpf("0.5"))
    half = mp.sqrt(depth)
    edge = mp.sqrt(depth + lam**2) - lam
    known = {
        s.lam: lam, s.eps: eps, s.kappa: kappa, s.eps_x: eps_x, s.damper: c_x, s.kappa_x: kappa_x,
        s.a: half, s.right: edge, s.per_depth: edge + lam + half, s.per_rate: edge + half,
    }  # fmt: skip
    along = {"eps_x": eps_x, "c_x": c_x, "kappa_x": kappa_x}
    truth = reference.quartic(lam=lam, eps=eps, kappa=kappa, guess=depth, **along)
    return known, truth


@cache
def compiled(expr):
    names = sorted(expr.free_symbols, key=str)
    return names, sp.lambdify(names, expr, "mpmath")


def value(expr, known):
    names, function = compiled(expr)
    return function(*(known[name] for name in names))


@pytest.mark.parametrize("scene", SCENES)
def test_the_quartic_is_that_of_the_equations_of_motion(scene):
    known, truth = contact(scene)
    ours = [value(each, known) for each in sp.Poly(spring_drive.QUARTIC, s.sigma).all_coeffs()]
    for one, other in zip(ours, truth, strict=True):
        assert abs(one - other) <= abs(other) * mp.mpf(10) ** -35


@pytest.mark.parametrize("scene", SCENES)
def test_falling_friction_is_the_slope_of_the_steady_curve(scene):
    """`RISE` by a difference of steady states, each found by its own root."""
    known, _ = contact(scene)
    lam, kappa, damper = known[s.lam], known[s.kappa], known[s.damper]

    def friction(number):
        depth = reference.steady_depth(number, kappa, known[s.a] ** 2)
        return reference.forces(depth, 0, number)[1]

    slope = mp.diff(friction, lam) + damper
    q = known[s.right] / known[s.a]
    along = known[s.a] ** 3 + known[s.right] ** 3
    across = mp.mpf(3) / 4 * known[s.per_rate]
    own = value(spring_stability.DEAD_WEIGHT_RISE, {s.q: q})
    shares = {s.damper_share: damper / along, s.support_rate: kappa / across}
    found = value(spring_stability.RISE, {s.q: q, s.own_rise: own, **shares})
    stiffness = (mp.mpf(3) / 4 * known[s.per_depth] + kappa) / across
    assert abs(found - stiffness * slope / (along + damper)) <= abs(found) * mp.mpf(10) ** -15


@pytest.mark.parametrize(("left", "right"), [("-1.2", "0.1"), ("0.3", "0.9"), ("-1", "1")])
def test_the_dampers_of_a_contact_take_no_less_than_those_of_a_depth_that_follows(left, right):
    """The power by quadrature of the squared rates of compression, the least one by search."""
    low, high, slides = mp.mpf(left), mp.mpf(right), mp.mpf("0.7")

    def power(sinks):
        return mp.quad(lambda xi: 0.75 * (sinks - 2 * xi * slides) ** 2, [low, high])

    least = value(spring_ringing.RESISTANCE, {s.length: high - low}) * slides**2
    follows = mp.findroot(lambda sinks: mp.diff(power, sinks), 0)
    assert abs(follows - (low + high) * slides) < mp.mpf(10) ** -15
    assert abs(power(follows) - least) < mp.mpf(10) ** -25
    assert min(power(follows + step) for step in (-1, -0.01, 0.01, 1)) > least


RUBBER = (  # arms, velocity in m/s; critical stiffness in N/m^2 and frequency in rad/s, of another program
    ([("50e9", "0.1")], "0.05", "4.533990e6", "66.6002"),
    ([("50e9", "0.1")], "0.3", "146.7647e6", None),
    ([("30e9", "0.01"), ("5e9", "0.5")], "0.2", "44.7401e6", None),
    ([("30e9", "0.01"), ("5e9", "0.5")], "0.05", None, None),  # stable for every stiffness
)


@pytest.mark.parametrize(("arms", "speed", "stiffness", "frequency"), RUBBER)
def test_f24_gives_the_critical_stiffness_of_a_prony_series(arms, speed, stiffness, frequency):
    K, R, M, V = mp.mpf("10e9"), mp.mpf("0.01"), mp.mpf(1000), mp.mpf(speed)
    series = [(mp.mpf(k), mp.mpf(time)) for k, time in arms]
    weight = M * mp.mpf("9.80665")

    def moments(c):
        """Return the moments of F17 of the whole series, by quadrature."""

        def relaxation(w):
            return K + sum(k * mp.exp(-w * c / (V * time)) for k, time in series)

        return [mp.quad(lambda w, f=weight: f(w) * relaxation(w), [0, 1]) for weight in
                (lambda w: 1 - w, lambda w: w, lambda w: w * (1 - w) / 2)]  # fmt: skip

    def kernel(n, m):
        """Return the function n at -m, by its recurrence."""
        return (1 / mp.fac(n - 1) - kernel(n - 1, m)) / m if n > 1 else (1 - mp.exp(-m)) / m

    def load(c):
        P, Q, D = moments(c)
        return c**3 / R * (D + (P - Q) / (2 * (P + Q)) * P)

    with mp.workdps(30):
        c = mp.findroot(lambda c: load(c) / weight - 1, mp.mpf("0.001"))
        P, Q, _ = moments(c)
        eta = (P - Q) / (2 * (P + Q))

        def spring(omega):
            """Return k_x at i omega from the proved forces."""
            rate = mp.mpc(0, omega)
            total = {name: mp.mpf(0) for name in rubber_drive.FORCES}
            for k, time in series:
                z, w = c / (V * time), rate * c / V
                known = {
                    s.arm_number: z, s.rate_number: w, s.excess_share: eta,
                    **{name: kernel(n, z + w) for n, name in enumerate(s.kernels, 1)},
                    **{name: kernel(n, z) for n, name in enumerate(s.kernels_still, 1)},
                }  # fmt: skip
                for name, form in rubber_drive.FORCES.items():
                    total[name] += k * value(form, known)
            A = c * (K + total[s.normal_per_depth])
            B = c**2 / R * total[s.normal_per_drag]
            C = c**2 / R * (K * eta + total[s.rubbing_per_depth])
            D = c**3 / R**2 * total[s.rubbing_per_drag]
            return D - M * rate**2 - B * C / (M * rate**2 + A)

        if stiffness is None:
            values = [spring(mp.mpf(10) ** (mp.mpf(k) / 10)) for k in range(41)]
            pairs = [pair for pair in pairwise(values) if mp.im(pair[0]) * mp.im(pair[1]) <= 0]
            assert all(mp.re(each) < 0 for pair in pairs for each in pair)
            return
        guess = mp.mpf(frequency or mp.sqrt(mp.mpf(stiffness) / M))
        omega = mp.findroot(lambda omega: mp.im(spring(omega)) / K, (guess, guess * mp.mpf("1.01")))
        assert mp.re(spring(omega)) == pytest.approx(float(stiffness), rel=2e-6)
        if frequency:
            assert omega == pytest.approx(float(frequency), rel=2e-6)
