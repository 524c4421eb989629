"""The limits of steady sliding on every shape and law: their errors, crossings and ranges."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.steady import asymptotes, regimes
from kvtheory.results import STEADY_UNITS
from tests import SUPPORTS, reference
from tests.test_power_law import random_case

SCENES = 10
V = "drive.velocity"
ZENER = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]])
UNSOUGHT = {"peak_velocity": np.nan, "peak_friction_coefficient": np.nan, "maxima": ()}
"""In place of the maxima, whose search on a ball takes longer than all limits."""


def supported(ball=False):
    """Return the supports of a ball, or of Table 1."""
    if ball:
        return {
            "fixed": kv.Fixed(1e-4),
            "dead-weight": kv.DeadWeight(load=10.0),
            "suspended": kv.Suspended(load=10.0, stiffness=1e5),
        }
    return {kind: kv.Scene.table1(kind).support for kind in SUPPORTS}


def of(shape, kind, foundation=None):
    ball = isinstance(shape, kv.Sphere)
    return kv.Scene(shape, foundation or kv.Scene().foundation, supported(ball)[kind])


def power_law(n):
    return kv.Wedge(0.1) if n == 1.0 else kv.PowerLaw(0.01, n)


def reported(scene, tolerance=0.05, velocity=None):
    """Return the report of the limits, without the maxima."""
    scene = scene if velocity is None else scene.replace({V: velocity})
    return regimes.report(scene, tolerance, UNSOUGHT | {"maxima_certificate": None})


def errors(scene, line, velocities):
    """Return how far a line is from the exact state, at other velocities."""
    exact = np.abs(getattr(kv.steady(scene, over={V: velocities}), line.quantity))
    return np.abs(np.abs(line.at(scene.replace({V: velocities}))) / exact - 1.0)


def random_scene(rng, n, kind):
    """Return a scene of a power law, for n = 0 of a ball, and its truth; |V| up to eight decades from V*."""
    case = random_case(rng, n or 2.0, kind, decades=8)
    slope, L, exponent, K, tau, velocity, *grip = case
    support = (
        kv.Fixed(*grip) if kind == "fixed"
        else kv.DeadWeight(load=grip[0]) if kind == "dead-weight"
        else kv.Suspended(load=grip[0], stiffness=grip[1])
    )  # fmt: skip
    shape = kv.Wedge(slope) if n == 1.0 else kv.PowerLaw(L, exponent)
    method = "at_depth" if kind == "fixed" else "at_load"
    if n == 2.0:
        shape, truth = (
            kv.Parabola(L),
            getattr(reference.parabola, method)(L, K, tau, velocity, *grip),
        )
    elif n == 0.0:
        across = L * 10 ** rng.uniform(-1, 1)
        shape = kv.Sphere(L, radius_across=across)
        truth = getattr(reference.ball, method)(L, across, K, tau, velocity, *grip)
    else:
        truth = getattr(reference.power_law, method)(*case)
    return kv.Scene(shape, kv.Foundation(K, tau), support, kv.Drive(velocity)), truth


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("n", [0.0, 1.0, 1.0 + 1e-9, 1.0001, 1.03, 1.3, 2.0, 2.7, 6.0, 24.0])
def test_each_asymptote_is_a_limit(n, kind):
    """In every quantity, against ball arithmetic, to first order in V/V* or V*/V; n = 0 is the ball."""
    rng = np.random.default_rng([int(1000 * n), SUPPORTS.index(kind), 7])
    seen = dict.fromkeys(STEADY_UNITS, 0.0)
    for _ in range(SCENES):
        scene, truth = random_scene(rng, n, kind)
        found = kv.steady(scene, method="asymptote")
        assert (found.model, found.certificate.kind) == ("asymptote", "none")
        ratio = abs(scene.drive.velocity) / asymptotes.critical_velocity(scene)
        for name in STEADY_UNITS:
            error = reference.relative_error(getattr(found, name), truth[name])
            seen[name] = max(seen[name], error)
            if kind != "suspended" and (
                ratio < 1.0 or name != "trailing_edge"
            ):  # its limit is zero
                assert error <= 30.0 * min(ratio, 1.0 / ratio) + 1e-13, (name, scene, error)
    given = {"depth", "half_length", "leading_edge"} if kind == "fixed" else set()
    exact = {"retardation_length", *given, *({"load"} if kind == "dead-weight" else ())}
    assert {name for name, error in seen.items() if error < 1e-10} == exact


LIMITS = [
    *((power_law(n), None) for n in (1.0, 1.2, 3.0, 8.0)),
    *((shape, law)
      for shape in (kv.Parabola(0.01), kv.Sphere(0.01, radius_across=0.03))
      for law in (None, ZENER, *(kv.FractionalKelvinVoigt(1e10, 0.1, order) for order in (0.2, 0.9)))),
]  # fmt: skip


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize(("shape", "law"), LIMITS, ids=str)
def test_a_limit_is_within_the_tolerance_over_its_range(shape, law, kind):
    """Off by the tolerance at its end, by less within and more beyond, by hardly anything far inside.

    The limits of friction meet at V*.
    """
    scene, tolerance = of(shape, kind, law), 0.01
    order, report = getattr(law, "order", 1.0), reported(scene, tolerance)
    there = scene.at(report.critical_velocity)
    meeting = [asymptotes.quantity(there, each) for each in asymptotes.limits(there)]
    assert meeting[0] == pytest.approx(meeting[1], rel=1e-14)
    for line, told in zip(regimes.lines(scene), report.lines, strict=True):
        state = kv.steady(scene)
        assert told.exact == pytest.approx(getattr(state, line.quantity), rel=1e-15)
        off = abs(told.value) / abs(told.exact) - 1.0
        assert told.relative_error == pytest.approx(off, rel=1e-9, abs=1e-11)
        low = line.regime == "low"
        edge, inward = (told.velocity_max, -1) if low else (told.velocity_min, 1)
        if not 0.0 < edge < np.inf:  # the load on a soft spring hardly changes
            assert line.quantity == "load"
            rest = kv.steady(scene, over={V: 0.0})
            assert scene.support.spring * rest.depth < rest.load * tolerance
            continue
        places = np.array([0.0, 1e-6, 0.01, 0.3, 1.0, 3.0, 5.0, -0.05]) / order
        off = errors(scene, line, edge * 10.0 ** (inward * places))
        assert off[0] == pytest.approx(tolerance, rel=1e-6)
        assert np.all(off[1:-1] < tolerance)
        assert off[-1] > tolerance
        assert off[6] < 1e-2 * tolerance or line.quantity == "load"


def test_a_limit_that_nowhere_holds_to_the_tolerance_has_an_empty_range():
    slow, fast = reported(
        kv.Scene(foundation=kv.FractionalKelvinVoigt(1e10, 0.1, 0.02)), 1e-6
    ).lines
    assert (slow.velocity_max, fast.velocity_min) == (0.0, np.inf)


@pytest.mark.parametrize("kind", SUPPORTS)
def test_the_regimes_are_told_apart_at_the_critical_velocity(kind):
    scene = kv.Scene.table1(kind)
    critical = kv.asymptotes(scene).critical_velocity
    found = kv.steady(scene, over={V: np.array([0.999, 1.001]) * critical}, method="asymptote")
    assert found.trailing_edge[0] == found.half_length[0]
    assert found.trailing_edge[1] == 0.0
    mu = found.friction_coefficient
    assert mu[0] == pytest.approx(mu[1], rel=2.1e-3)
    at_rest, exact = (kv.steady(scene, over={V: 0.0}, method=m) for m in ("asymptote", "exact"))
    for name in STEADY_UNITS:
        assert getattr(at_rest, name) == pytest.approx(getattr(exact, name), rel=1e-14, abs=0)


@pytest.mark.parametrize("ball", [False, True])
def test_the_regimes_of_a_broad_spectrum_are_those_of_all_its_arms(ball):
    """Low, where V/c is below 1/tau of every arm, and high above; V*, between both, tells nothing."""
    shape = kv.Sphere(0.01) if ball else kv.Parabola(0.01)
    arms = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "1 us"], ["2 GN/m^3", "1000 s"]])
    scene = of(shape, "dead-weight", arms)
    V_of = np.geomspace(1e-7, 1e5, 60)
    state = kv.steady(scene, over={V: V_of})
    rate = V_of / (state.trailing_edge - state.leading_edge)
    expected = np.where(rate < 1e-3, "low", np.where(rate > 1e6, "high", "between"))
    assert reported(scene, velocity=-V_of).regime.tolist() == expected.tolist()
    assert len(set(expected)) == 3
    assert "between the low- and the high-velocity regime" in str(kv.asymptotes(scene))


@pytest.mark.parametrize("ball", [False, True])
@pytest.mark.parametrize("kind", SUPPORTS)
def test_one_law_is_the_limit_of_another(kind, ball):
    """A springpot of order 1 is Kelvin-Voigt; fast arms fall as 1/V, by 2/5 of a parabola, 1/3 of a ball."""
    shape = kv.Sphere(0.01, radius_across=0.03) if ball else kv.Parabola(0.01)
    springpot = reported(
        of(shape, kind, kv.FractionalKelvinVoigt(1e10, 0.1, 1.0)), velocity=[1e-4, 0.5]
    )
    plain = reported(of(shape, kind), velocity=[1e-4, 0.5])
    for one, other in zip(springpot.lines, plain.lines[:2], strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-13)
        edges = ("velocity_min", "velocity_max")
        for edge in edges if ball else (*edges, "velocity_proved"):
            assert getattr(one, edge) == pytest.approx(getattr(other, edge), rel=1e-8)
    assert springpot.critical_velocity == pytest.approx(plain.critical_velocity, rel=1e-13)
    assert springpot.use.tolist() == plain.use.tolist()
    scene = of(shape, kind, ZENER)
    state = kv.steady(scene, over={V: [1e4, 1e5]})
    falls = (3e10 / 0.01 + 5e9 / 1.0) / 4.5e10 / np.array([1e4, 1e5])
    glassy = (1.0 / 3.0 if ball else 0.4) * state.half_length**2 / 0.01 * falls
    off = state.friction_coefficient / glassy - 1.0
    assert np.all(np.abs(off) < 2e-3)
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.05)
    slow = kv.steady(scene, over={V: [1e-6, 1e-7]}).friction_coefficient
    off = slow / (ZENER.slow_damping * np.array([1e-6, 1e-7]) / (1e10 * 0.01)) - 1.0
    assert np.all(np.abs(off) < 1e-2)
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.1)


def test_the_advice_names_the_first_formula_that_is_within_the_tolerance():
    report = kv.asymptotes(
        of(kv.Parabola(0.01), "dead-weight", ZENER), over={V: [0.0, 1e-6, 0.1, 1e5, -1e5]}
    )
    assert report.use.tolist() == ["L1", "L1", "exact", "glassy", "glassy"]
    assert report.lines[-1].value[-1] == -report.lines[-1].value[-2]
    far = kv.asymptotes(of(kv.PowerLaw(0.01, 3.0), "fixed")).critical_velocity * 10.0 ** np.arange(
        -18, 19, 6
    )
    report = kv.asymptotes(of(kv.PowerLaw(0.01, 3.0), "fixed"), over={V: far})
    assert report.use.tolist() == ["L1"] * 3 + ["exact"] + ["L2"] * 3


@pytest.mark.parametrize("kind", SUPPORTS)
def test_what_is_proved_of_a_foundation_covers_its_error(kind):
    """F18-voigt and F18-glassy on random arms: within the proved range the error is within the tolerance."""
    rng, tolerance, over = np.random.default_rng(SUPPORTS.index(kind)), 0.01, {}
    scene = of(kv.Parabola(0.01), kind, ZENER)
    for number in range(2):
        key = f"foundation.arms[{number}]."
        over[key + "stiffness"] = 1e10 * 10 ** rng.uniform(-3, 5, 6)
        over[key + "relaxation_time"] = 10 ** rng.uniform(-4, 2, 6)
    scene = scene.replace(over)
    shown = zip(regimes.lines(scene), reported(scene, tolerance).lines, strict=True)
    for line, told in shown:
        low = line.regime == "low"
        edge, proved = told.velocity_max if low else told.velocity_min, told.velocity_proved
        assert np.all((proved > 0) & (proved < np.inf))
        assert np.all((proved <= edge) if low else (proved >= edge))
        there = proved * 10.0 ** ((-1 if low else 1) * np.array([[0.0], [0.1], [1.0]]))
        assert np.all(errors(scene, line, there) <= tolerance)


def test_the_bound_of_kelvin_voigt_is_not_idle():
    """Of 7 V t/c, more than a third is reached, so that a smaller factor would not cover."""
    scene = of(kv.Parabola(0.01), "dead-weight", kv.GeneralizedMaxwell(1e10, arms=[[1e13, 1e-5]]))
    proved = reported(scene, 0.01).lines[1].velocity_proved
    assert 0.002 < errors(scene, regimes.lines(scene)[1], proved) < 0.01


def test_what_leaves_double_precision_names_a_key():
    soft = kv.FractionalKelvinVoigt(1e10, 0.1, 1e-6)
    support = kv.Suspended(mass=1000.0, stiffness=3e7)
    with pytest.raises(ValueError, match=r"double precision: .*check foundation\.order = 1e-06"):
        kv.asymptotes(kv.Scene(foundation=soft, support=support))
