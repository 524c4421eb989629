"""Power law and wedge in closed form: against ball arithmetic, quadrature, the parabola, and identities."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.steady import power_law, power_law_contact
from kvtheory.models.steady.methods import solve_quadrature
from kvtheory.results import STEADY_UNITS
from tests import reference, reference_power_law, steady

SUPPORTS = ("fixed", "dead-weight", "suspended")
EXPONENTS = (1.0, 1.0 + 1e-9, 1.0001, 1.03, 1.3, 1.5, 2.0, 2.7, 3.0, 4.0, 6.0, 11.5, 20.0, 24.0)
SCENES = 40
OWN = "trailing_edge"
EPS = float(np.finfo(float).eps)
STATED = power_law.CERTIFICATE.relative_error


def random_case(rng, n, kind, decades=12):
    """Return the arguments of `power_law.at_depth` or `at_load`, |V| within some decades of a_0/tau."""
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


def both(case, kind):
    method = "at_depth" if kind == "fixed" else "at_load"
    shape = kv.Wedge(case[0]) if case[2] == 1.0 else kv.PowerLaw(*case[1:3])
    return getattr(steady, method)(shape, *case[3:]), getattr(reference_power_law, method)(*case)


@pytest.mark.processor
@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("n", EXPONENTS)
def test_every_quantity_is_within_its_error_of_ball_arithmetic(n, kind):
    rng = np.random.default_rng([int(1000 * n), SUPPORTS.index(kind)])
    for _ in range(SCENES):
        case = random_case(rng, n, kind)
        state, truth = both(case, kind)
        for name in STEADY_UNITS:
            error = reference.relative_error(getattr(state, name), truth[name])
            claimed = state.certificate.relative_error[name]
            assert error <= claimed, (name, case, error, claimed)
            assert name == OWN or claimed <= 1e-14
            if name == OWN and n >= 1.3:  # d ln x_TE/d ln V is at most 1/(n - 1)
                assert claimed <= (1 + 1 / (n - 1)) * STATED[OWN] * (1 + 1e-12)


@pytest.mark.processor
@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize(
    ("n", "profile"),
    [*((n, False) for n in EXPONENTS), *((n, True) for n in EXPONENTS if n == 1.0 or n > 1.01)],
)
def test_quadrature_is_within_its_error_of_ball_arithmetic(n, kind, profile):
    """Of the shape, and of functions that say no more than h and h'; edges close to the tip included."""
    rng = np.random.default_rng([int(1000 * n), 7, SUPPORTS.index(kind)])
    method = "at_depth" if kind == "fixed" else "at_load"
    for _ in range(3 if profile else SCENES):
        case = random_case(rng, n, kind, 6 if profile else 12)
        shape = kv.PowerLaw(case[1], n) if n > 1.0 else kv.Wedge(case[0])
        if profile:
            shape = kv.Profile(shape.height, shape.slope, kinks=(0.0,))
        state = getattr(steady, method)(shape, *case[3:], solve=solve_quadrature)
        truth = getattr(reference_power_law, method)(*case)
        for name in STEADY_UNITS:
            error = reference.relative_error(getattr(state, name), truth[name])
            claimed = state.certificate.relative_error[name]
            assert error <= claimed, (name, case, error, claimed)
            sure = name != OWN or state.trailing_edge != 0.0 or n == 1.0
            assert profile or (claimed < 1e-11) == sure, (name, case)


def test_the_trailing_edge_of_nearly_a_wedge_says_how_uncertain_it_is():
    """For n -> 1 it is the wedge's, to first order in n - 1; far beyond l = 1 it leaves double precision."""
    state = steady.at_depth(kv.PowerLaw(0.01, 1.001), 1e10, 0.1, [1e-4, 1e-3, 3e-3, 1e2], 3e-4)
    claimed = state.certificate.relative_error[OWN]
    assert claimed[0] < 1e-14 < claimed[2] < 1e-11
    assert (state.trailing_edge[3], claimed[3]) == (0.0, np.inf)
    assert np.all(state.load > 0)
    assert state.certificate.relative_error["load"] == STATED["load"]


def test_the_parabola_is_the_power_law_of_exponent_2():
    V = np.geomspace(1e-9, 1e9, 61)
    for support in ("fixed", "dead-weight", "suspended"):
        parabola = kv.Scene.table1(support)
        twin = kv.Scene(
            kv.PowerLaw(parabola.indenter.radius, 2.0), parabola.foundation, parabola.support
        )
        one, other = (kv.steady(scene, over={"drive.velocity": V}) for scene in (parabola, twin))
        for name in STEADY_UNITS:
            assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-14, abs=0), name


def test_the_wedge_is_the_power_law_of_exponent_1():
    V = np.geomspace(1e-6, 1e3, 37)
    for support in SUPPORTS:
        base = kv.Scene.table1(support)
        wedge, power = (
            kv.steady(kv.Scene(shape, base.foundation, base.support), over={"drive.velocity": V})
            for shape in (kv.Wedge(1.0), kv.PowerLaw(0.37, 1.0))
        )
        for name in STEADY_UNITS:
            assert getattr(power, name) == pytest.approx(getattr(wedge, name), rel=2e-15, abs=0)


SHAPES = (kv.Wedge(0.1), *(kv.PowerLaw(0.01, n) for n in (1.0, 1.2, 1.5, 3.0, 4.0, 8.5)))


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_quadrature_confirms_the_closed_forms(shape, kind):
    base = kv.Scene.table1(kind)
    for V in (-0.003, 0.0, 0.02, 0.4):
        scene = kv.Scene(shape, base.foundation, base.support, kv.Drive(V))
        exact, other = (kv.steady(scene, method=method) for method in ("exact", "quadrature"))
        assert exact.model == "exact" == kv.steady(scene).model
        for name in STEADY_UNITS:
            allowed = sum(state.certificate.relative_error[name] for state in (exact, other))
            value = getattr(exact, name)
            assert getattr(other, name) == pytest.approx(value, rel=allowed + 1e-15, abs=1e-300), (
                name
            )


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_arrays_give_what_single_scenes_give(shape):
    scene = kv.Scene(shape, support=kv.Suspended(mass=1000.0, stiffness=1e7))
    V = np.array([[0.0, 1e-4, 0.01], [-0.2, 0.03, 30.0]])
    tau = np.array([[0.1], [2.0]])
    together = kv.steady(scene, over={"drive.velocity": V, "foundation.retardation_time": tau})
    for place in np.ndindex(V.shape):
        over = {"drive.velocity": V[place], "foundation.retardation_time": tau[place[0], 0]}
        alone = kv.steady(scene, over=over)
        for name in STEADY_UNITS:
            assert getattr(together, name)[place] == pytest.approx(getattr(alone, name), rel=1e-14)
            assert isinstance(getattr(alone, name), float)


def test_the_exponent_may_be_an_array():
    scene = kv.Scene(kv.PowerLaw(0.01, 2.0))
    n = np.array([1.0, 1.5, 2.0, 6.0])
    found = kv.steady(scene, over={"indenter.exponent": n})
    for place, exponent in enumerate(n):
        alone = kv.steady(kv.Scene(kv.PowerLaw(0.01, float(exponent))))
        assert found.depth[place] == pytest.approx(alone.depth, rel=4e-15)


def test_a_reversed_drive_is_the_mirror_image():
    for shape in SHAPES:
        scene = kv.Scene(shape)
        there, back = (kv.steady(scene, over={"drive.velocity": V}) for V in (0.05, -0.05))
        mirrored = {"leading_edge", "trailing_edge", "friction_force", "friction_coefficient"}
        for name in STEADY_UNITS:
            sign = -1.0 if name in mirrored else 1.0
            assert getattr(back, name) == sign * getattr(there, name)


def test_friction_of_a_wedge_is_its_slope_from_its_crossover_on():
    scene = kv.Scene(kv.Wedge(0.07))
    fast = kv.steady(scene, over={"drive.velocity": np.geomspace(0.05, 1e6, 30)})
    assert np.all(fast.trailing_edge == 0.0)
    assert fast.friction_coefficient == pytest.approx(0.07, rel=1e-15, abs=0)


def test_the_trailing_edge_solves_its_equation_in_any_corner():
    l = np.geomspace(1e-300, 1e300, 1201)
    for n in (1.0, 1.0 + 2e-16, 1.0 + 1e-10, 1.01, 2.0, 20.0, 1e4):
        q, Q = power_law_contact.trailing_edge(np.full_like(l, n), l)
        assert np.all((q >= 0.0) & (q <= 1.0) & (Q > 0.0) & (Q <= 1.0 + EPS))
        assert np.all(np.diff(q) <= 2 * EPS)
        assert np.all(np.diff(Q) <= 2 * EPS)
        assert q * Q + n * l * Q == pytest.approx(1.0, rel=1e-15)


def test_what_leaves_double_precision_raises():
    with pytest.raises(FloatingPointError):
        steady.at_load(kv.PowerLaw(0.01, 3.0), 1e10, 0.1, 1e-320, 1e4)
    with pytest.raises(FloatingPointError):
        steady.at_depth(kv.PowerLaw(0.01, 3.0), 1e200, 0.1, 1e150, 1e2)


def test_the_ladder_uses_the_closed_forms():
    for shape in SHAPES:
        found = kv.solve(kv.Scene(shape), quantity="friction_coefficient", rtol=1e-12)
        assert found.model == "exact"
        assert [step.rung for step in found.climb] == ["asymptote", "exact"]
    circle = kv.solve(kv.Scene(kv.Circle(0.01)), quantity="friction_coefficient", rtol=1e-9)
    assert circle.model == "quadrature"
