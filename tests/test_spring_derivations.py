"""Derivations F22 against equations written on their own, with many digits."""

from functools import cache

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import rubber_drive, spring_drive, spring_stability

import kvtheory as kv
from tests import reference_stability as reference
from tests.conftest import digits
from tests.test_rubber_stability import TWO, forces, rubber

SCENES = (  # drive, inertia and support number, then inertia, damper and spring number along x
    ("0.3", "0.01", "0", "0.2", "0", "1.5"),
    ("1.7", "0.4", "0", "3", "0.2", "0.7"),
    ("6", "20", "2.5", "0.5", "0", "40"),
)
_digits = digits(reference.DIGITS)


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


def kernel(n, m):
    """Return the function n at -m, by its recurrence."""
    return (1 / mp.fac(n - 1) - kernel(n - 1, m)) / m if n > 1 else (1 - mp.exp(-m)) / m


@pytest.mark.parametrize("rate", [40j, 3.0 + 200j])
def test_f24_sums_the_history_of_each_element(rate):
    """The forces of small motions in the derived form and by quadrature, of which stability is then found."""
    scene = rubber(TWO, 0.2)
    state, K, R, V = kv.steady(scene), 1e10, 0.01, 0.2
    c = state.trailing_edge - state.leading_edge
    eta, total = state.half_length / c - 0.5, dict.fromkeys(rubber_drive.FORCES, 0.0)
    for stiffness, time in TWO:
        z, w = c / (V * time), mp.mpc(rate) * c / V
        known = {
            s.arm_number: z, s.rate_number: w, s.excess_share: eta,
            **{name: kernel(n, z + w) for n, name in enumerate(s.kernels, 1)},
            **{name: kernel(n, z) for n, name in enumerate(s.kernels_still, 1)},
        }  # fmt: skip
        for name, form in rubber_drive.FORCES.items():
            total[name] += stiffness * complex(value(form, known))
    total[s.normal_per_depth] += K
    total[s.rubbing_per_depth] += K * eta
    units = {
        s.normal_per_depth: c, s.normal_per_drag: c**2 / R,
        s.rubbing_per_depth: c**2 / R, s.rubbing_per_drag: c**3 / R**2,
    }  # fmt: skip
    derived = [unit * total[name] for name, unit in units.items()]
    assert derived == pytest.approx(forces(scene, state.half_length, rate), rel=1e-9)
