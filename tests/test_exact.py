"""The closed forms: against ball arithmetic, and the identities that steady sliding must obey."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.steady import ball, exact, methods
from kvtheory.models.steady.methods import ODD
from kvtheory.results import STEADY_UNITS
from tests import SCENES, SUPPORTS, reference, steady
from tests.steady import at_depth, at_load

UNIT = 2.0**-53
ERRORS = {np.hypot: 2 * UNIT, np.cbrt: 8 * UNIT}
"""One unit in the last place; for cube roots four, as with the C library of GNU up to 2.40."""
DERIVATIVES = {
    np.add: lambda x, y: (1.0, 1.0),
    np.subtract: lambda x, y: (1.0, -1.0),
    np.multiply: lambda x, y: (y, x),
    np.divide: lambda x, y: (1.0 / y, -x / (y * y)),
    np.sqrt: lambda x: (0.5 / math.sqrt(x),),
    np.cbrt: lambda x: (np.cbrt(x) / (3.0 * x),),
    np.hypot: lambda x, y: (x / math.hypot(x, y), y / math.hypot(x, y)),
    np.negative: lambda x: (-1.0,),
    np.absolute: lambda x: (math.copysign(1.0, x),),
}
EXACT = np.negative, np.absolute
CHOICES = np.minimum, np.maximum


class Rounded(np.lib.mixins.NDArrayOperatorsMixin):
    """A computed number, with its derivatives to the errors of operations and what these can be at most."""

    def __init__(self, value, terms=()):
        self.value, self.terms = float(value), dict(terms)

    @property
    def worst(self):
        """The largest relative error."""
        total = sum(abs(slope) * most for slope, most in self.terms.values())
        return total / abs(self.value) if total else 0.0

    def __array_ufunc__(self, ufunc, method, *inputs, **_):
        values = [float(getattr(each, "value", each)) for each in inputs]
        found = ufunc(*values)
        if found.dtype == bool:
            return found
        if ufunc in CHOICES:
            chosen = inputs[values.index(found)]
            return chosen if isinstance(chosen, Rounded) else Rounded(found)
        terms = {}
        for each, slope in zip(inputs, DERIVATIVES[ufunc](*values), strict=True):
            for key, (own, most) in getattr(each, "terms", {}).items():
                terms[key] = terms.get(key, (0.0, most))[0] + slope * own, most
        doubled = ufunc is np.multiply and any(abs(math.frexp(x)[0]) == 0.5 for x in values)
        if ufunc not in EXACT and not doubled:
            terms[object()] = float(found), ERRORS.get(ufunc, UNIT)
        return Rounded(found, terms)


EPS = np.finfo(float).eps
SHAPES = {"parabola": (reference.parabola, exact), "ball": (reference.ball, ball)}


def random_scenes(shape, support, seed=2020):
    """R, R' of a ball, K, tau, V and the support; V tau/a_0 over 24 decades, kappa over 18 of them."""
    rng = np.random.default_rng(seed)
    ends = np.array([[-6, 3], [3, 15], [-6, 3], [-6, 9], [-12, 12], [-9, 9], [-2, 2]]).T[..., None]
    R, K, tau, W, number, kappa, across = 10.0 ** rng.uniform(*ends, (7, 3 * SCENES))
    number[:4] = 1e-12, 1e12, 1e-12, 1e12
    depth = (9 * (W / K) ** 2 / (32 * R)) ** (1 / 3)
    if shape == "ball":
        number[::3] = 10.0 ** rng.uniform(-1, 1, number[::3].size)  # where T changes its form
        depth = np.sqrt(W / (np.pi * K * R * np.sqrt(across)))
    V = number / tau * np.sqrt(2 * R * depth) * rng.choice([-1.0, 1.0], 3 * SCENES)
    grip = {"fixed": (depth,), "dead-weight": (W,), "suspended": (W, kappa * W / depth)}[support]
    return (R, *([R * across] if shape == "ball" else []), K, tau, V, *grip)


@pytest.mark.processor
@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("shape", SHAPES)
def test_error_stays_below_the_certificate(shape, support):
    given, (truth, module) = random_scenes(shape, support), SHAPES[shape]
    method = "at_depth" if support == "fixed" else "at_load"
    indenter, rest = (
        (given[0], given[1:]) if shape == "parabola" else (kv.Sphere(*given[:2]), given[2:])
    )
    state = getattr(steady, method)(indenter, *rest)
    claimed = exact.HELD if (shape, support) == ("parabola", "fixed") else module.CERTIFICATE
    for i, scene in enumerate(zip(*(x.tolist() for x in given), strict=True)):
        right = getattr(truth, method)(*scene)
        for name, most in claimed.relative_error.items():
            error = reference.relative_error(float(getattr(state, name)[i]), right[name])
            assert error <= most < 1e-14, (name, scene)
    assert dict(state.certificate.relative_error) == dict(claimed.relative_error)


@pytest.mark.parametrize("support", SUPPORTS)
def test_the_certificate_is_the_worst_case_of_rounding(support):
    """Whatever processor and C library round, over 24 decades of velocity and 18 of the suspension."""
    R, K, tau, W = 0.017, 1.3e10, 0.13, 9876.5
    a_0 = np.cbrt(1.5 * R * W / K)
    depth, worst = float(a_0 * a_0 / (2 * R)), 0.0
    for number in 10.0 ** np.linspace(-12.0, 12.0, 25):
        for kappa in 10.0 ** np.linspace(-9.0, 9.0, 4) if support == "suspended" else [0.0]:
            grip = {"depth": depth, "weight": W, "spring": kappa * W / depth}
            scene = SimpleNamespace(
                indenter=SimpleNamespace(radius=Rounded(R)),
                foundation=SimpleNamespace(stiffness=Rounded(K), retardation_time=Rounded(tau)),
                drive=SimpleNamespace(final_velocity=Rounded(number * a_0 / tau)),
                support=SimpleNamespace(**{key: Rounded(value) for key, value in grip.items()}),
                held=support == "fixed",
            )
            worst = max(worst, *(value.worst for value in exact.quantities(scene)))
    claimed = (exact.HELD if support == "fixed" else exact.CERTIFICATE).relative_error["load"]
    assert worst <= claimed
    assert support == "dead-weight" or worst > claimed - EPS


def test_power_is_spent_inside_and_behind_the_contact():
    """Theorem F6, each loss from its definition: C V^2 int h'^2 dx and V K u_TE^2/2."""
    R, K, tau = 0.01, 1e10, 0.1
    V, depth = np.meshgrid(np.geomspace(1e-6, 1e6, 30), np.geomspace(1e-6, 1e6, 10))
    state = at_depth(R, K, tau, V, depth)
    inside = K * tau * V**2 * (state.trailing_edge**3 - state.leading_edge**3) / (3 * R**2)
    left_over = V * tau * state.trailing_edge / R  # u_TE = l_r h'(x_TE), where p = 0
    behind = V * K * left_over**2 / 2
    power = state.friction_force * V
    assert inside + behind == pytest.approx(power, rel=1e-12)
    assert inside / power == pytest.approx(state.dissipated_in_contact, rel=1e-12)
    assert np.all(
        (state.dissipated_in_contact >= 0.8 - 1e-15) & (state.dissipated_in_contact <= 1.0)
    )


def test_rest_is_the_winkler_contact():
    state = at_load(0.01, 1e10, 0.1, 0.0, 9806.65)
    a = (1.5 * 0.01 * 9806.65 / 1e10) ** (1 / 3)
    assert state.friction_force == state.friction_coefficient == 0.0
    assert state.leading_edge == -state.trailing_edge == pytest.approx(-a, rel=1e-14)
    assert state.peak_pressure == pytest.approx(1e10 * state.depth, rel=1e-14)
    assert state.dissipated_in_contact == 1.0


@pytest.mark.processor
def test_arrays_broadcast_and_do_not_depend_on_the_blocks(monkeypatch):
    V, tau = np.geomspace(1e-3, 1e1, 7)[:, None], np.array([0.01, 0.1, 1.0])
    whole = at_load(0.01, 1e10, tau, V, 9806.65)
    monkeypatch.setattr(methods, "BLOCK", 2)
    blocks = at_load(0.01, 1e10, tau, V, 9806.65)
    for name in STEADY_UNITS:
        assert getattr(whole, name).shape == (7, 3)
        assert np.array_equal(getattr(whole, name), getattr(blocks, name))
    assert at_load(0.01, 1e10, 0.1, np.empty((0, 3)), 9806.65).depth.shape == (0, 3)


KELVIN_VOIGT = kv.Scene().foundation
MAXWELL = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]])
FRACTIONAL = kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)
LINES = (
    kv.Parabola(0.01),
    kv.Wedge(0.1),
    *(kv.PowerLaw(0.01, n) for n in (1.0, 1.2, 1.5, 2.0, 3.0, 8.6)),
)
BALL = kv.Sphere(0.01)
SOLVED = (
    *((line, KELVIN_VOIGT, "exact") for line in LINES),
    *((LINES[0], MAXWELL, "exact"), (LINES[0], FRACTIONAL, "exact")),
    *((BALL, foundation, "exact") for foundation in (KELVIN_VOIGT, MAXWELL, FRACTIONAL)),
    *(
        (line, KELVIN_VOIGT, "quadrature")
        for line in (*LINES, kv.Circle(0.01), kv.PowerLaw(0.01, 20.0))
    ),
)


@pytest.mark.processor
@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize(("shape", "foundation", "method"), SOLVED, ids=str)
def test_each_scene_of_an_array_is_solved_for_itself_and_mirrored(
    shape, foundation, method, support
):
    """The same bits alone and among others; odd and even in the velocity; elastic at rest."""
    own = kv.Scene.table1(support).support
    if shape is BALL:
        held = kv.Suspended(mass=1.0, stiffness=1e4)
        own = {"fixed": kv.Fixed(1e-4), "dead-weight": kv.DeadWeight(mass=1.0), "suspended": held}[
            support
        ]
    scene = kv.Scene(shape, foundation, own)
    V = np.append(np.geomspace(1e-6, 1e3, 20), 0.0)

    def solved(V):
        return kv.steady(scene, over={"drive.velocity": V}, method=method)

    together, back = solved(V), solved(-V)
    rest = kv.steady(kv.Scene(shape, KELVIN_VOIGT, own), over={"drive.velocity": 0.0})
    for size in (1, 3, 8):
        for start in range(0, V.size, size):
            part = slice(start, start + size)
            few = solved(V[part])
            for name in STEADY_UNITS:
                assert np.array_equal(getattr(few, name), getattr(together, name)[part]), name
    alone = solved(float(V[9]))
    for name in STEADY_UNITS:
        value, there = getattr(alone, name), getattr(together, name)
        assert isinstance(value, float)
        claimed = alone.certificate.relative_error[name]
        assert value == pytest.approx(there[9], rel=1e-14 if method == "exact" else claimed), name
        side = -1.0 if name in ODD else 1.0
        assert np.array_equal(getattr(back, name)[:-1], side * there[:-1]), name
        assert there[-1] == pytest.approx(getattr(rest, name), rel=1e-11, abs=0.0), name


def test_the_exponent_may_be_an_array():
    n = np.array([1.0, 1.5, 2.0, 6.0])
    found = kv.steady(kv.Scene(kv.PowerLaw(0.01, 2.0)), over={"indenter.exponent": n})
    alone = [kv.steady(kv.Scene(kv.PowerLaw(0.01, each))).depth for each in n.tolist()]
    assert found.depth == pytest.approx(alone, rel=4e-15)


@pytest.mark.processor
def test_the_first_guess_needs_no_more_than_the_steps_it_is_given(monkeypatch):
    numbers = np.geomspace(1e-14, 1e14, 2001)
    for kappa in (0.0, 1e-6, 1e-3, 0.03, 0.3, 1.0, 3.0, 1e2, 1e8, 1e14):
        kappas = np.full_like(numbers, kappa)
        found = exact.scaled_root(numbers, kappas)
        with monkeypatch.context() as patch:
            patch.setattr(exact, "HALLEY_STEPS", 6)
            assert np.max(np.abs(found / exact.scaled_root(numbers, kappas) - 1)) <= 4 * EPS


@pytest.mark.parametrize(
    ("shape", "K", "V", "depth"),
    [(1e300, 1e300, 1.0, 1e300), (kv.PowerLaw(0.01, 3.0), 1e200, 1e150, 1e2),
     (kv.PowerLaw(0.01, 3.0), 1e10, 1e-320, 1e-4)],
)  # fmt: skip
def test_what_leaves_double_precision_is_an_error(shape, K, V, depth):
    with pytest.raises(FloatingPointError):
        at_depth(shape, K, 0.1, V, depth)
