"""Steady sliding on any linear viscoelastic foundation: against balls, limits, identities, and mistakes."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations.chapters import viscoelastic as theory

import kvtheory as kv
from kvtheory.models.steady import convolution, viscoelastic
from kvtheory.models.steady.methods import ODD, solve_exact, solve_quadrature
from kvtheory.models.steady.revolved import Strip
from kvtheory.results import STEADY_UNITS
from kvtheory.theory import laws
from kvtheory.theory.laws import Fractional
from tests import SCENES, SUPPORTS, reference_viscoelastic
from tests.steady import agree

STATED = viscoelastic.RELATIVE_ERROR
ARMS = [["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]]
ZENER = kv.GeneralizedMaxwell(1e10, arms=ARMS)
HALF = kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)


def scene(foundation, support="dead-weight", **parts):
    return replace(kv.Scene.table1(support), foundation=foundation, **parts)


def by_quadrature(foundation, support, indenter, V):
    here = scene(foundation, support, indenter=indenter)
    return kv.steady(here, over={"drive.velocity": V}, method="quadrature")


@pytest.mark.processor
@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("damped", [False, True])
def test_every_quantity_is_within_its_error_of_ball_arithmetic(kind, damped):
    """1 to 20 arms over ten decades, and springpots; arms beside a damper of any size."""
    rng = np.random.default_rng(SUPPORTS.index(kind))
    for _ in range((2 if damped else 3) * SCENES // 40):
        case = reference_viscoelastic.random_case(rng, kind, damped=damped)
        for name, error in reference_viscoelastic.errors(case).items():
            assert error <= 1.0, (name, case)


def test_the_peak_is_found_where_newtons_steps_go_to_and_fro():
    """Arms far apart: the highest of many pressures of the same contact is not higher."""
    rng = np.random.default_rng(7)
    for _ in range(100):
        case = reference_viscoelastic.random_case(rng, "dead-weight")
        here, R = reference_viscoelastic.scene_of(case), case[2]
        state = solve_exact(here)
        X = state.half_length * np.geomspace(1e-14, 1.0, 1500)
        M = viscoelastic.law(here.at(np.array([here.drive.velocity]))).moments(X)
        highest = ((state.half_length * (M.P + M.Q) - X * M.P) * X / R).max()
        assert highest <= state.peak_pressure * (1 + STATED)
        assert highest >= state.peak_pressure * (1 - 1e-3)


def test_a_springpot_of_low_order_says_how_badly_its_loss_is_known():
    for order in (1e-8, 1e-6, 1e-3, 0.1, 0.999999):
        case = Fractional, (0.1, order), 0.01, 1e10, 0.1, 0.1, 9806.65
        state = solve_exact(reference_viscoelastic.scene_of(case))
        assert max(reference_viscoelastic.errors(case).values()) <= 1.0
        assert state.certificate.relative_error["dissipated_in_contact"] < 1e-12 / order
        by_rules = kv.steady(reference_viscoelastic.scene_of(case), method="quadrature")
        for name, claimed in by_rules.certificate.relative_error.items():
            assert abs(getattr(by_rules, name) / getattr(state, name) - 1.0) <= claimed, name


@pytest.mark.parametrize("z", [0.0, 1e-9, 0.3, 3.999999, 4.000001, 60.0, 1e6])
def test_moments_are_those_of_the_derivations(z):
    P, Q, D, E, end = laws.exponential_moments(np.array([z]))
    found = dict(zip((theory.P, theory.Q, theory.D, theory.E), (P, Q, D, E), strict=True))
    for name, (weight, form) in theory.MOMENTS.items():
        exactly = sp.Rational(z)
        if z == 0.0:
            truth = sp.integrate(weight, theory.UNIT)
        else:
            truth = form.subs(theory.z, exactly).evalf(60, maxn=400)
        assert float(found[name][0]) == pytest.approx(float(truth), rel=4e-15, abs=1e-17), name
    assert end[0] == pytest.approx(np.exp(-z), rel=1e-15)


@pytest.mark.parametrize("support", SUPPORTS)
def test_kelvin_voigt_is_a_damper_and_the_springpot_of_order_one(support):
    """The closed forms against the moments of both laws."""
    over = {"drive.velocity": np.concatenate((-np.geomspace(1e-6, 1e6, 25), [0.0, 1e-3, 1.0, 1e3]))}
    plain = kv.Scene.table1(support).replace(over).flat()
    springpot = scene(kv.FractionalKelvinVoigt(1e10, 0.1, 1.0), support).replace(over).flat()
    truth = kv.steady(plain)
    for each in (plain, springpot):
        for name, value in zip(STEADY_UNITS, viscoelastic.quantities(each), strict=False):
            sign = np.where(plain.drive.velocity < 0.0, -1.0, 1.0) if name in ODD else 1.0
            assert sign * value == pytest.approx(getattr(truth, name), rel=2e-14, abs=0), name


def test_mistakes_of_arms_are_listed_together():
    arms = [["30 GN/m^3", "10 mm"], [-1.0, 2.0], 3, [1.0, 5.0], [2.0, 5.0], [1.0, 1e-3]]
    with pytest.raises(kv.SceneError) as caught:
        kv.GeneralizedMaxwell("1 mm", arms=arms)
    text = str(caught.value)
    for told in (
        'foundation.stiffness = "1 mm"', 'arms[0].relaxation_time = "10 mm"', "arms[1].stiffness = -1.0",
        "arms[2] = 3: expected", "arms[3] and foundation.arms[4] have the relaxation time 5 s",
    ):  # fmt: skip
        assert told in text
    assert len(caught.value.problems) == 5
    for wrong in ([], "x", None, [[1.0, 1.0 + i] for i in range(101)]):
        with pytest.raises(kv.SceneError, match="1 to 100"):
            kv.GeneralizedMaxwell(1e10, arms=wrong)


SHAPES = {
    "parabola": kv.Parabola(0.01),
    "circle": kv.Circle(0.01),
    "power": kv.PowerLaw(0.01, 4.0),
    "sharp": kv.PowerLaw(0.01, 1.4),
    "wedge": kv.Wedge(0.1),
}


@pytest.mark.processor
@pytest.mark.parametrize("support", SUPPORTS)
def test_convolution_confirms_the_moments(support):
    rng = np.random.default_rng(SUPPORTS.index(support))
    for _ in range(8):
        here = reference_viscoelastic.scene_of(reference_viscoelastic.random_case(rng, support))
        state, truth = solve_quadrature(here), solve_exact(here)
        agree(state, truth)
        claimed = dict(state.certificate.relative_error)
        assert claimed.pop("trailing_edge") < 1e-6
        assert max(claimed.values()) < 1e-12


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("support", SUPPORTS)
def test_convolution_of_any_shape_is_kelvin_voigt_for_order_one(shape, support):
    laws = kv.FractionalKelvinVoigt(1e10, 0.1, 1.0), kv.Scene().foundation
    for V in (-0.3, 0.0, 1e-4, 5.0):
        agree(*(by_quadrature(law, support, SHAPES[shape], V) for law in laws))


LOPSIDED = kv.Profile(
    lambda x: x * x / 0.02 + (x > 1e-4) * 0.03 * (x - 1e-4) + (x > 0) * 5.0 * x**3,
    lambda x: x / 0.01 + (x > 1e-4) * 0.03 + (x > 0) * 15.0 * x * x,
    kinks=(1e-4,),
)
"""Convex, with a kink, steeper behind."""


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("shape", [*SHAPES, "lopsided"])
def test_convolution_of_any_shape_agrees_with_a_row_of_elements(shape, side):
    """Elements that follow the shape at a constant depth, each arm exact over a step: order h."""
    from scipy.signal import lfilter

    indenter, depth = SHAPES.get(shape, LOPSIDED), 1e-4 if shape in SHAPES else 1e-5
    fixed = kv.Scene(indenter, ZENER, kv.Fixed(depth), kv.Drive(0.1 * side))
    state = kv.steady(fixed, method="quadrature")
    found = []
    for cells in (2000, 4000):
        last = 1.1 * abs(state.trailing_edge) + 0.1 * state.half_length
        x = np.linspace(-abs(state.leading_edge), last, cells + 1)
        u, h = depth - indenter.height(side * x), x[1] - x[0]
        p = 1e10 * u
        for arm in ZENER.arms:
            l = 0.1 * arm.relaxation_time
            gain = -np.expm1(-h / l) * l / h * np.diff(u)
            p[1:] += arm.stiffness * lfilter([1.0], [1.0, -np.exp(-h / l)], gain)
        end = int(np.argmax((p <= 0) & (np.arange(p.size) > np.argmax(u))))
        mid, du = 0.5 * (p[: end - 1] + p[1:end]), np.diff(u[:end])
        found.append((mid.sum() * h, side * (mid * du).sum(), p.max()))
        assert abs(x[end] - abs(state.trailing_edge)) < 2 * h
    truth = state.load, state.friction_force, state.peak_pressure
    for coarse, fine, value in zip(*found, truth, strict=True):
        assert fine == pytest.approx(value, rel=3e-3)
        assert abs(fine - value) < 0.7 * abs(coarse - value) + 1e-6 * abs(value)


OWN = {
    "parabola": kv.Profile(lambda x: x * x / 0.02, lambda x: x / 0.01),
    "circle": kv.Profile(
        lambda x: x * x / (0.01 + math.sqrt(1e-4 - x * x)), lambda x: x / math.sqrt(1e-4 - x * x),
        reach=0.01,
    ),
    "wedge": kv.Profile(lambda x: 0.1 * abs(x), lambda x: math.copysign(0.1, x), kinks=(0.0,)),
}  # fmt: skip


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("shape", OWN)
def test_a_shape_of_python_functions_is_the_named_one(shape, support):
    for V, foundation in ((-0.3, ZENER), (0.02, HALF)):
        indenters = OWN[shape], SHAPES[shape]
        agree(*(by_quadrature(foundation, support, each, V) for each in indenters), 1e-10)


def test_a_node_that_rounds_to_before_the_leading_edge():
    """There a springpot raised a negative length to a broken power."""
    R, kink = 0.012405181050498832, -8.297472106578946e-05
    c, V = 376.6851309204793, 6.303886700724625
    own = kv.Profile(
        lambda x: x * x / 2.0 / R + c * max(kink - x, 0.0) ** 2,
        lambda x: x / R - 2.0 * c * max(kink - x, 0.0),
        kinks=(kink,),
    )
    springpot = kv.FractionalKelvinVoigt(1e10, 0.0011513546970316273, 0.20978043346173947)
    weight = kv.DeadWeight(load=230.92946340465673)
    state = kv.steady(kv.Scene(own, springpot, weight, kv.Drive(velocity=V)))
    assert state.load == pytest.approx(230.92946340465673, rel=1e-12)


def bend_at(x):
    """Height and slope of a parabola that is steeper beyond x, and its kink."""

    def height(y):
        return y * y / 0.02 + 250.0 * max(y - x, 0.0) ** 2

    return height, lambda y: y / 0.01 + 500.0 * max(y - x, 0.0), (x,)


def test_a_jump_of_the_curvature_need_not_be_declared():
    """In the contact, at its lowest point, and, hard to see, on a border of cells or close to one."""
    border = 2.0**-10 * 1.375
    for height, slope, kinks in (
        (lambda x: max(abs(x) - 1e-3, 0.0) ** 2 / 0.02,
         lambda x: math.copysign(max(abs(x) - 1e-3, 0.0) / 0.01, x), (-1e-3, 1e-3)),
        (lambda x: x * x / (0.02 if x < 0.0 else 6e-3), lambda x: x / (0.01 if x < 0.0 else 3e-3), (0.0,)),
        *map(bend_at, (2e-4, border, border * (1.0 + 1e-9), border * (1.0 - 2e-4))),
    ):  # fmt: skip
        indenters = (kv.Profile(height, slope, kinks=named) for named in ((), kinks))
        agree(*(by_quadrature(ZENER, "fixed", indenter, 0.1) for indenter in indenters), 1e-8)


def test_a_shape_that_may_touch_in_several_places_is_refused_beyond_kelvin_voigt():
    def height(x):
        return x * x / 0.02 + 2e-6 * (1.0 - math.cos(x / 1e-5))

    def slope(x):
        return x / 0.01 + 0.2 * math.sin(x / 1e-5)

    here = scene(ZENER, "fixed", indenter=kv.Profile(height, slope))
    with pytest.raises(kv.QuadratureError, match="not convex down to"):
        kv.steady(here)


def test_a_kink_that_is_not_declared_is_refused_beyond_kelvin_voigt():
    def slope(x):
        return math.copysign(0.1 if abs(x) < 1e-4 else 0.4, x)

    bent = kv.Profile(lambda x: 0.1 * abs(x) + 0.3 * max(abs(x) - 1e-4, 0.0), slope)
    with pytest.raises(kv.QuadratureError, match="the slope jumps where `kinks`"):
        kv.steady(scene(ZENER, "fixed", indenter=bent))


BRANCHES = {
    "a slow and a fast arm": convolution.Arms([10.0, 3.0], [1e-2, 1e-6]),
    "a springpot": convolution.Springpot(1e-3, 0.4),
    "none": None,
}
HEIGHTS = kv.Parabola(0.01), kv.PowerLaw(0.01, 3.0), kv.Wedge(0.1)


@pytest.mark.parametrize("memory", BRANCHES)
@pytest.mark.parametrize("shape", HEIGHTS)
@np.errstate(all="ignore")
def test_the_load_of_a_convolution_is_that_of_its_pressure(shape, memory):
    """One integral for the load, with the relaxation function integrated, and two for the pressure."""
    contact = convolution.ViscoelasticLine(shape, BRANCHES[memory], 1e-3).at(1e-4)
    carried, _ = contact.total(contact.pressure)
    assert contact.load == pytest.approx(carried, rel=1e-13, abs=0.0)


@np.errstate(all="ignore")
def test_a_strip_next_to_a_tip_takes_the_finer_rule():
    """There its flank bends within the distance of the strip, and the coarse rule errs by 1e-11."""
    cone, depth = kv.Wedge(0.1), 1e-4
    line = convolution.ViscoelasticLine(cone, BRANCHES["a slow and a fast arm"], 1e-3)
    rules = {}
    for y in (1e-9, 3e-4):
        strip = line.strips(Strip(cone, y, line.reach, 1e-9))
        contact = strip.at(depth - cone.height(y))
        coarse, fine = (
            convolution.Contact(strip.shape, strip.memory, contact.depth, rule) for rule in (0, 1)
        )
        rules[y] = contact.rule
        if contact.rule:
            assert abs(coarse.load / fine.load - 1.0) > 1e-13
            assert contact.load == fine.load
        assert contact.load == pytest.approx(fine.load, rel=1e-14, abs=0.0)
        assert contact.friction()[:2] == pytest.approx(fine.friction()[:2], rel=1e-13, abs=0.0)
    assert rules == {1e-9: 1, 3e-4: 0}
