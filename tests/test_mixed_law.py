"""Arms beside a damper, the law that contains all others, in every question asked of it (fact F33)."""

from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.explorer import explorer_page
from kvtheory.models.steady import (
    asperities,
    ball,
    ball_viscoelastic,
    contact,
    convolution,
    general_stability,
    stability,
)
from kvtheory.models.steady.cells import ConvexProfile, Surface
from kvtheory.models.steady.revolved import Strip
from kvtheory.scene.capabilities import DAMPED
from tests import SUPPORTS, reference_motions

ARMS = [(2e10, 5e-3), (1e10, 0.2)]
MIXED = kv.GeneralizedMaxwell(1e10, arms=ARMS, damping=5e8)


def scene(support="dead-weight", foundation=MIXED, **parts):
    return replace(kv.Scene.table1(support), foundation=foundation, **parts)


def within(found, truth, names):
    """Assert that values differ by no more than both errors."""
    for name in names:
        claimed = [each.certificate.relative_error[name] for each in (found, truth)]
        off = np.abs(getattr(found, name) / getattr(truth, name) - 1.0)
        assert np.all(off <= np.add(*claimed)), name


# Steady sliding


@pytest.mark.parametrize("method", ["exact", "quadrature"])
def test_the_forces_at_a_depth(method):
    """Fact F33, by a quadrature of the history."""
    speeds = {"drive.velocity": [1e-3, 0.03, 1.0]}
    found = kv.steady(scene(support="fixed"), over=speeds, method=method)
    assert found.load == pytest.approx([9955.691, 19014.63, 169030.5], rel=5e-7)
    assert found.friction_force == pytest.approx([214.8258, 1486.771, 26179.89], rel=5e-7)


@pytest.mark.parametrize("support", SUPPORTS)
def test_slow_arms_leave_kelvin_voigt_and_no_damping_the_arms(support):
    V = np.geomspace(1e-4, 10.0, 12)
    plain = kv.Foundation(1e10, 0.05)
    soft = kv.GeneralizedMaxwell(1e10, arms=[(1e-6, 1e-3)], damping=5e8)
    ahead, limit = (kv.steady(scene(support, each).at(V)) for each in (plain, soft))
    none = kv.steady(scene(support, replace(MIXED, damping=0.0)).at(V))
    small = kv.steady(scene(support, replace(MIXED, damping=1e-11)).at(V))
    for name in ("depth", "load", "friction_force", "trailing_edge", "peak_pressure"):
        assert getattr(limit, name) == pytest.approx(getattr(ahead, name), rel=1e-13), name
        assert getattr(small, name) == pytest.approx(getattr(none, name), rel=1e-13), name


def test_a_fast_arm_is_a_damper_in_first_order():
    V = np.geomspace(1e-3, 1.0, 7)
    truth, off = kv.steady(scene().at(V)), []
    for tau in (1e-7, 1e-8):
        fast = kv.GeneralizedMaxwell(1e10, arms=[*ARMS, (5e8 / tau, tau)])
        off.append(
            np.abs(
                kv.steady(scene(foundation=fast).at(V)).friction_force / truth.friction_force - 1.0
            )
        )
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.05)


def test_dampings_may_be_an_array_with_zeros():
    given = kv.GeneralizedMaxwell(1e10, arms=ARMS, damping=[0.0, 5e8])
    both = kv.steady(scene(foundation=given))
    for i, damping in enumerate((0.0, 5e8)):
        one = kv.steady(scene(foundation=replace(MIXED, damping=damping)))
        assert both.friction_force[i] == pytest.approx(one.friction_force, rel=1e-14)


@pytest.mark.parametrize(
    "shape", [kv.Circle(0.01), kv.PowerLaw(0.01, 3.0), kv.Wedge(0.05), kv.Sphere(0.01)]
)
def test_any_shape_with_slow_arms_is_that_on_kelvin_voigt(shape):
    """By convolution: arms without weight beside a damper."""
    soft = kv.GeneralizedMaxwell(1e10, arms=[(1e-5, 1e-3)], damping=5e8)
    for V in (1e-3, 0.03, 3.0):
        here = kv.Scene(shape, soft, kv.Fixed(1e-4), kv.Drive(V))
        found = kv.steady(here, method="quadrature")
        truth = kv.steady(replace(here, foundation=kv.Foundation(1e10, 0.05)))
        within(found, truth, ["load", "friction_force", "peak_pressure", "dissipated_in_contact"])


@pytest.mark.parametrize(
    "shape", [kv.Parabola(0.01), kv.Circle(0.01), kv.PowerLaw(0.01, 1.4), kv.Wedge(0.05)]
)
def test_the_convolution_of_any_law_confirms_the_contact_on_kelvin_voigt(shape):
    """A damper without arms; two methods that share the shape alone."""
    plain = kv.Foundation(1e10, 0.05)
    for V in (1e-4, 1e-2, 1.0):
        here = kv.Scene(shape, plain, kv.Fixed(1e-4), kv.Drive(V))
        memory, l_r = convolution.memory_of(here), V * plain.retardation_time
        general = convolution.ViscoelasticLine(shape, memory, l_r).at(1e-4)
        known = contact.ConvexLine(shape, l_r).at(1e-4)
        values, errors, _ = general.quantities()
        truth, own, _ = known.quantities()
        for name, value in values.items():
            claimed = errors[name] + own.get(name, 0.0) + convolution.FLOOR
            assert value == pytest.approx(truth[name], rel=claimed, abs=0), name


@pytest.mark.parametrize("foundation", [MIXED, replace(MIXED, damping=0.0)])
def test_convolution_knows_the_error_of_work_where_arms_relax_close_to_the_edge(foundation):
    """The layer in which arms are loaded is a millionth of the contact: both rules have the work wrong."""
    for V in (1e-8, 1e-7, 1e-6, 1e-5):
        here = scene("fixed", foundation, drive=kv.Drive(V))
        within(kv.steady(here, method="quadrature"), kv.steady(here), ["friction_force", "load"])


@pytest.mark.parametrize("time", [1e-8, 1e-6])
@pytest.mark.parametrize("damping", [0.0, 1e3])
def test_convolution_knows_its_error_in_a_thin_layer_of_a_stiff_arm(time, damping):
    """Both rules have the load wrong by 3e-13, and differ little more; the peak is in the layer."""
    given = kv.GeneralizedMaxwell(1e10, arms=[(1e15, time)], damping=damping)
    found = kv.steady(scene(foundation=given), method="quadrature")
    names = ["depth", "load", "friction_force", "peak_pressure", "trailing_edge"]
    within(found, kv.steady(scene(foundation=given)), names)


def test_a_ball_is_the_sum_of_its_strips():
    here = kv.Scene(kv.Sphere(0.01), MIXED, kv.Fixed(1e-4), kv.Drive(0.03))
    found = kv.steady(here)
    s, w = np.polynomial.legendre.leggauss(200)
    angle, weight = 0.5 * np.pi * s, 0.5 * np.pi * w
    strips = replace(here, indenter=kv.Parabola(0.01), support=kv.Fixed(1e-4 * np.cos(angle) ** 2))
    each, across = kv.steady(strips), np.sqrt(2 * 0.01 * 1e-4) * np.cos(angle) * weight
    assert found.load == pytest.approx(across @ each.load, rel=1e-10)
    assert found.friction_force == pytest.approx(across @ each.friction_force, rel=1e-10)


@pytest.mark.parametrize("support", SUPPORTS)
def test_the_moments_of_any_law_confirm_the_closed_form_of_a_ball(support):
    load = {"mass": 1.0} if support != "fixed" else {"depth": 1e-4}
    kind = {"fixed": kv.Fixed, "dead-weight": kv.DeadWeight, "suspended": kv.Suspended}[support]
    held = kind(**load, stiffness=1e4) if support == "suspended" else kind(**load)
    here = kv.Scene(
        kv.Sphere(0.01), support=held, drive=kv.Drive(np.geomspace(1e-6, 1e3, 30))
    ).flat()
    for general, known in zip(
        ball_viscoelastic.quantities(here), ball.quantities(here), strict=False
    ):
        assert general == pytest.approx(known, rel=ball_viscoelastic.RELATIVE_ERROR)


def test_a_profile_of_functions_is_revolved_beyond_kelvin_voigt():
    profile = kv.Profile(lambda x: 50.0 * x * x, lambda x: 100.0 * x)
    springpot = kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)
    here = kv.Scene(kv.Revolved(profile), springpot, kv.Fixed(1e-4), kv.Drive(0.1))
    truth = kv.steady(replace(here, indenter=kv.Sphere(0.01)))
    within(kv.steady(here), truth, ["load", "friction_force", "trailing_edge", "peak_pressure"])


def test_strips_of_functions_with_a_kink_are_those_on_kelvin_voigt():
    """A strip has the kink of the profile where the circle of its radius crosses it."""
    profile = kv.Profile(
        lambda x: 50.0 * x * x + 0.02 * max(abs(x) - 8e-4, 0.0),
        lambda x: 100.0 * x + (np.copysign(0.02, x) if abs(x) > 8e-4 else 0.0), kinks=(-8e-4, 8e-4),
    )  # fmt: skip
    plain = kv.Foundation(1e10, 0.05)
    here = kv.Scene(kv.Revolved(profile), plain, kv.Fixed(1e-4), kv.Drive(0.03))
    middle = convolution.ViscoelasticLine(
        ConvexProfile(profile, 1.0), convolution.memory_of(here), 1.5e-3
    )
    known = asperities.AnyLine(Surface(profile, 1.0), 1.5e-3)
    middle.at(1e-4)
    for y in (2e-4, 9e-4):
        depth = 1e-4 - profile.height(y)
        found, truth = (
            line.strips(Strip(profile, y, np.inf, 1e-12)).at(depth) for line in (middle, known)
        )
        assert found.load == pytest.approx(truth.load, rel=1e-12)
        assert found.friction()[0] == pytest.approx(truth.friction()[0], rel=1e-12)


def test_functions_that_are_not_convex_are_refused_beyond_kelvin_voigt_when_revolved():
    hollow = kv.Profile(
        lambda x: 50.0 * x * x + 1e-5 * np.sin(4e3 * x) ** 2,
        lambda x: 100.0 * x + 4e-2 * np.sin(8e3 * x), reach=0.01,
    )  # fmt: skip
    here = kv.Scene(kv.Revolved(hollow), MIXED, kv.Fixed(1e-4))
    with pytest.raises(ArithmeticError, match="not convex down to"):
        kv.steady(here)


# Limits


@pytest.mark.parametrize(
    ("shape", "support"),
    [*((kv.Parabola(0.01), name) for name in SUPPORTS), (kv.Sphere(0.01), "fixed")],
)
def test_both_limits_are_approached(shape, support):
    """F18 with int (G - K) dt = C + sum K_i tau_i at low velocity; Eqs. 45, 46 with C alone at high."""
    here = scene(support, indenter=shape)
    report = kv.asymptotes(here)
    low, _, high = report.lines
    assert (low.name, high.name) == ("L1", "L2")
    assert high.equation == (
        {"fixed": 45, "dead-weight": 46}.get(support) if shape.per_width else None
    )
    for line, V, rate in ((0, 1e-6, 0.1), (2, 1e4, 10.0)):
        off = [abs(kv.asymptotes(here.at(V * r)).lines[line].relative_error) for r in (1.0, rate)]
        assert off[1] < 0.4 * off[0] < 0.02
    assert report.lines[0].velocity_proved <= report.lines[0].velocity_max


def test_regimes_follow_from_arms_and_damper():
    found = [kv.asymptotes(scene("fixed").at(V)).regime for V in (1e-5, 0.1, 1e2)]
    assert found == ["low", "between", "high"]


@pytest.mark.parametrize("damping", [1e6, 5e8])
def test_the_proved_bound_of_kelvin_voigt_covers_a_damper(damping):
    here = scene(foundation=replace(MIXED, damping=damping))
    line = kv.asymptotes(here, tolerance=0.01).lines[1]
    assert 0.0 < line.velocity_proved < line.velocity_max
    there = kv.asymptotes(here.at(line.velocity_proved)).lines[1]
    assert abs(there.relative_error) < 0.01


def test_maxima_are_found_at_the_time_of_a_small_damper():
    """Beside stiff arms a damper counts at C/(K + sum K_i), here far from all other times."""
    given = kv.GeneralizedMaxwell(1e10, arms=[(3e10, 1.0)], damping=4e4)
    found = kv.asymptotes(scene(foundation=given)).maxima
    assert len(found) == 2
    for V, mu in found:
        sides = kv.steady(scene(foundation=given).at(V * np.array([0.9, 1.1]))).friction_coefficient
        assert np.all(sides < mu)
    assert found[1][0] == pytest.approx(4e10 / 4e4 * 2e-3, rel=1.0)


# Stability


@pytest.mark.parametrize("shape", [kv.Parabola(0.01), kv.Sphere(0.01)])
def test_one_determinant_returns_the_closed_form_of_kelvin_voigt(shape):
    load = 9806.65 if shape.per_width else 9.80665
    V = np.array([0.02, 0.039, 0.091, 0.214])
    here = kv.Scene(
        shape, support=kv.DeadWeight(load=load), drive=kv.Drive(V, stiffness=1e6)
    ).flat()
    (upper, lower, hertz), _ = general_stability.SmallMotions(here).critical()
    truth, _ = stability.SmallMotions(here).critical()
    for found, known in zip((upper, lower, hertz), truth, strict=True):
        np.testing.assert_allclose(found, known, rtol=1e-9)
    if shape.per_width:
        assert upper[1:] == pytest.approx([0.1722e6, 6.879e6, 101.95e6], rel=1e-3)


@pytest.mark.parametrize("support", ["dead-weight", "suspended"])
@pytest.mark.parametrize("V", [0.214, 0.3])
def test_at_the_onset_of_instability_the_histories_of_all_elements_give_a_real_stiffness(
    support, V
):
    """Both edges carry pressure where the indenter moves; a rate without growth belongs to this stiffness."""
    here = scene(support, drive=kv.Drive(V, stiffness=1e6))
    found = kv.stability(here, quantity=["critical_stiffness", "frequency"])
    omega = 2.0 * np.pi * found.frequency
    k_x = reference_motions.stiffness(here, kv.steady(here).depth, omega)
    assert k_x == pytest.approx(found.critical_stiffness, rel=1e-6)


@pytest.mark.parametrize("number", [0.3, 3.0, 20.0])
def test_the_response_is_that_of_the_histories_of_all_elements(number):
    V, d, R = 0.1, 3e-4, 0.01
    given = general_stability.Contact.of(scene("fixed").at(np.array([V])))
    omega = number * V / np.sqrt(2 * R * d)
    sigma, slope = 1j * omega * given.c / V, given.c / R
    A, B, C, D = (each[0, 0] for each in given.law.response(given.c, given.eta, sigma))
    slope, c = slope[0, 0], given.c[0, 0]
    found = np.array([[A, slope * C], [slope * B, slope * slope * D]]) * c
    assert found == pytest.approx(
        np.array(reference_motions.response(MIXED, R, V, d, omega)), rel=1e-7
    )


# Other questions


@pytest.mark.parametrize("key", ["C", "viscosity"])
def test_the_symbol_of_the_damper_is_understood(key):
    told = rf'foundation\.{key}.*did you mean "damping"'
    arms = 'foundation.arms=[["20 GN/m^3", "5 ms"]]'
    with pytest.raises(kv.SceneError, match=told):
        kv.load_scene(
            overrides=["foundation.kind=generalized-maxwell", arms, f"foundation.{key}=1 N*s/m^3"]
        )


def test_without_a_damper_it_is_of_another_kind():
    assert scene().kind[1] == DAMPED
    assert scene(foundation=replace(MIXED, damping=0.0)).kind[1] == "generalized-maxwell"


def test_solve_takes_the_continuum():
    found = kv.solve(scene(), at=[2e-3, 20e-3], rtol=0.02)
    assert found.model == "continuum"
    assert found.depth == pytest.approx([0.289390e-3, 0.172051e-3], rel=1e-3)


def test_a_sweep_of_the_damper_does_not_neglect_it():
    plain = scene(foundation=replace(MIXED, damping=0.0))
    found = kv.sweep(plain, over={"foundation.damping": [0.0, 5e8]}, at=[2e-3], quantities="depth")
    for i, damping in enumerate((0.0, 5e8)):
        one = kv.elements(scene(foundation=replace(MIXED, damping=damping)), at=[2e-3])
        assert found["depth"][i] == pytest.approx(one.depth, rel=3e-3)
    assert found["depth"][0] > 1.02 * found["depth"][1]


def test_fewer_arms_keep_the_damper():
    arms = [(3e10 / 2**k, 10.0 ** (0.25 * k - 6)) for k in range(21)]
    here = scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms, damping=1e7))
    found = kv.fewer_arms(here)
    assert found.scene.foundation.damping == 1e7
    assert len(found.arms) < 21
    assert found.difference < found.bound < 0.01
    V = np.geomspace(0.01, 1.0, 9)
    one, other = (kv.steady(each.at(V)).friction_coefficient for each in (here, found.scene))
    assert np.abs(other / one - 1.0).max() <= found.bound


def test_a_fit_of_friction_finds_the_damper():
    V = np.geomspace(1e-3, 1.0, 20)
    data = {
        "velocity [m/s]": V,
        "friction_coefficient": kv.steady(scene().at(V)).friction_coefficient,
    }
    free = ["foundation.damping", "foundation.stiffness"]
    found = kv.fit(scene(foundation=replace(MIXED, damping=1e7)), data=data, free=free)
    assert found.parameters["foundation.damping"].value == pytest.approx(5e8, rel=1e-6)
    told = r"`free` foundation\.damping: is not above 0"
    with pytest.raises(kv.SceneError, match=told):
        kv.fit(scene(foundation=replace(MIXED, damping=0.0)), data=data, free=free)


@pytest.mark.parametrize("fault", ["damper missing", "wrong C", "Kelvin-Voigt instead of arms"])
def test_a_comparison_knows_faults_of_the_damper(fault):
    wrong = {
        "damper missing": replace(MIXED, damping=0.0), "wrong C": replace(MIXED, damping=1e9),
        "Kelvin-Voigt instead of arms": kv.Foundation(1e10, MIXED.retardation_time),
    }[fault]  # fmt: skip
    V = np.geomspace(1e-3, 1.0, 20)
    state = kv.steady(scene(foundation=wrong).at(V))
    data = {"velocity": V, "friction_coefficient": state.friction_coefficient, "depth": state.depth}
    found = kv.compare(scene(), data)
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == fault


def test_a_motion_is_held_against_elements():
    here = scene(drive=kv.Drive(0.03), run=kv.Run(0.02))
    at = np.linspace(0.0, 0.02, 41)
    names = "time", "depth", "normal_force", "friction_force"
    found = []
    for foundation in (MIXED, replace(MIXED, damping=0.0)):
        given = replace(here, foundation=foundation)
        motion = kv.elements(given, at=at, per_length="100 /mm", certify=False)
        found.append(kv.compare(here, {name: getattr(motion, name) for name in names}))
    assert [each.verdict for each in found] == ["agrees", "disagrees"]
    assert found[1].explanations[0].name == "damper missing"


def test_the_explorer_has_a_slider_of_a_damper_beside_arms_unless_it_is_zero():
    assert '"foundation.damping":"' in explorer_page(scene())
    plain = explorer_page(scene(foundation=replace(MIXED, damping=0.0)))
    assert '"foundation.damping":"' not in plain


def test_closed_forms_of_kelvin_voigt_refuse_a_damper_beside_arms():
    with pytest.raises(ValueError, match=r"only, not for arms beside foundation\.damping"):
        kv.steady(scene(), method="asymptote")
