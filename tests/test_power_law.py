"""Power law and wedge: closed forms and quadrature against ball arithmetic, the parabola, and identities."""

import mpmath as mp
import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.steady import power_law
from kvtheory.models.steady.methods import solve_exact, solve_quadrature
from kvtheory.theory.powers import cube_root, root
from tests import SUPPORTS, reference, steady

EXPONENTS = (1.0, 1.0 + 1e-9, 1.0001, 1.03, 1.3, 1.5, 2.0, 2.7, 3.0, 4.0, 6.0, 11.5, 20.0, 24.0)
OWN = "trailing_edge"
EPS = float(np.finfo(float).eps)
STATED = power_law.CERTIFICATE.relative_error


def random_case(rng, n, kind, decades=12):
    """Return the arguments of `reference.power_law.at_depth` or `at_load`, |V| within decades of a_0/tau."""
    slope = float(10 ** rng.uniform(-3, 0)) if n == 1.0 else 1.0
    L, K, tau = (float(10.0 ** rng.uniform(*ends)) for ends in ((-4, 0), (6, 12), (-4, 2)))
    weight = float(10.0 ** rng.uniform(0, 5))
    a = L * ((n + 1) * weight / (2 * K * slope * L * L)) ** (1 / (n + 1))
    depth = weight / (K * a)
    V = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-decades, decades) * a / tau)
    given = (slope, L, n, K, tau, V)
    if kind == "fixed":
        return (*given, depth)
    spring = 0.0 if kind == "dead-weight" else float(weight / depth * 10 ** rng.uniform(-4, 4))
    return (*given, weight, spring)


@pytest.mark.processor
@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize(
    ("n", "solve", "profile", "count"),
    [
        *((n, solve_exact, False, 20) for n in EXPONENTS),
        *((n, solve_quadrature, False, 10) for n in EXPONENTS),
        *((n, solve_quadrature, True, 2) for n in EXPONENTS if n == 1.0 or n > 1.01),
    ],
)
def test_every_quantity_is_within_its_error_of_ball_arithmetic(n, kind, solve, profile, count):
    """Of the shape, and of functions that give no more than h and h'; edges close to the tip included."""
    rng = np.random.default_rng([int(1000 * n), SUPPORTS.index(kind)])
    method = "at_depth" if kind == "fixed" else "at_load"
    for _ in range(count):
        case = random_case(rng, n, kind, 6 if profile else 12)
        shape = kv.PowerLaw(case[1], n) if n > 1.0 else kv.Wedge(case[0])
        if profile:
            shape = kv.Profile(shape.height, shape.slope, kinks=(0.0,))
        state = getattr(steady, method)(shape, *case[3:], solve=solve)
        assert not reference.excess(state, getattr(reference.power_law, method)(*case)), case
        for name, claimed in state.certificate.relative_error.items():
            sure = name != OWN or state.trailing_edge != 0.0 or n == 1.0
            if solve is solve_quadrature:
                assert profile or (claimed < 1e-11) == sure, (name, case)
            elif name != OWN:
                assert claimed <= 1e-14
            elif n >= 1.3:  # d ln x_TE/d ln V is at most 1/(n - 1)
                assert claimed <= (1 + 1 / (n - 1)) * STATED[OWN] * (1 + 1e-12)


def test_the_trailing_edge_of_nearly_a_wedge_says_how_uncertain_it_is():
    """For n -> 1 it is the wedge's, to first order in n - 1; far beyond l = 1 it leaves double precision."""
    state = steady.at_depth(kv.PowerLaw(0.01, 1.001), 1e10, 0.1, [1e-4, 1e-3, 3e-3, 1e2], 3e-4)
    claimed = state.certificate.relative_error[OWN]
    assert claimed[0] < 1e-14 < claimed[2] < 1e-11
    assert (state.trailing_edge[3], claimed[3]) == (0.0, np.inf)
    assert np.all(state.load > 0)
    assert state.certificate.relative_error["load"] == STATED["load"]


@mp.workdps(50)
def test_roots_are_rounded_without_a_bias():
    """On average to a tenth of a unit in the last place, and never off by more than one and a half."""
    base, degree = 10.0 ** np.random.default_rng(1).uniform((-30, 0), (30, 1.4), (4000, 2)).T
    for found, n in ((root(base, degree), degree), (cube_root(base), np.full_like(base, 3.0))):
        errors = [
            float(mp.mpf(r) / mp.mpf(b) ** (1 / mp.mpf(k)) - 1) / EPS
            for r, b, k in zip(found.tolist(), base.tolist(), n.tolist(), strict=True)
        ]
        assert abs(np.mean(errors)) < 0.1
        assert np.abs(errors).max() < 1.5


def test_friction_of_a_wedge_is_its_slope_from_its_crossover_on():
    fast = kv.steady(kv.Scene(kv.Wedge(0.07)), over={"drive.velocity": np.geomspace(0.05, 1e6, 30)})
    assert np.all(fast.trailing_edge == 0.0)
    assert fast.friction_coefficient == pytest.approx(0.07, rel=1e-15, abs=0)


def test_the_trailing_edge_solves_its_equation_in_any_corner():
    l = np.geomspace(1e-300, 1e300, 1201)
    for n in (1.0, 1.0 + 2e-16, 1.0 + 1e-10, 1.01, 2.0, 20.0, 1e4):
        q, Q = power_law.trailing_edge(np.full_like(l, n), l)
        assert np.all((q >= 0.0) & (q <= 1.0) & (Q > 0.0) & (Q <= 1.0 + EPS))
        assert np.all(np.diff(q) <= 2 * EPS)
        assert np.all(np.diff(Q) <= 2 * EPS)
        assert q * Q + n * l * Q == pytest.approx(1.0, rel=1e-15)
