"""`kv.steady` and `kv.asymptotes` as users call them."""

import json

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import STEADY_UNITS


@pytest.mark.parametrize("support", ["fixed", "dead-weight", "suspended"])
def test_exact_and_quadrature_agree(support):
    over = {"drive.velocity": [0.0, 1e-4, -0.02, 0.1, 50.0], "foundation.retardation_time": 0.2}
    scene = kv.Scene.table1(support)
    exact, integrated = (kv.steady(scene, over=over, method=m) for m in ("exact", "quadrature"))
    assert (exact.model, integrated.model) == ("exact", "quadrature")
    for name in STEADY_UNITS:
        assert getattr(integrated, name) == pytest.approx(getattr(exact, name), rel=1e-12, abs=0)


def test_other_shapes_are_integrated_by_default():
    scene = kv.Scene(indenter=kv.Circle(radius=0.01))
    assert kv.steady(scene).model == "quadrature"
    swept = kv.steady(scene, over={"indenter.radius": [0.01, 0.02], "drive.velocity": 0.01})
    assert swept.depth.shape == (2,)
    assert swept.certificate.relative_error["depth"].shape == (2,)
    for method in ("exact", "asymptote"):
        with pytest.raises(ValueError, match=r'the ball only.*"circle"'):
            kv.steady(scene, method=method)
    with pytest.raises(ValueError, match="the ball only"):
        kv.asymptotes(scene)


def test_a_profile_from_python_is_integrated():
    parabola = kv.Profile(lambda x: x * x / 0.02, lambda x: x / 0.01)
    integrated = kv.steady(kv.Scene(indenter=parabola))
    for name in STEADY_UNITS:
        assert getattr(integrated, name) == pytest.approx(getattr(kv.steady(), name), rel=1e-11)


def test_mistakes_are_named():
    with pytest.raises(ValueError, match=r'"exakt".*did you mean "exact"'):
        kv.steady(method="exakt")
    with pytest.raises(kv.SceneError, match="finite"):
        kv.steady(over={"drive.velocity": [0.1, np.nan]})
    with pytest.raises(ValueError, match="double precision"):
        kv.steady(over={"support.mass": 1e308, "support.gravity": 1e308})
    for method in ("exact", "quadrature"):
        with pytest.raises(ValueError, match="double precision"):
            kv.steady(over={"drive.velocity": 1e300}, method=method)
    with pytest.raises(ValueError, match=r"underflow in.*check support\.mass = 1e-300 kg/m$"):
        kv.steady(over={"support.mass": 1e-300})
    with pytest.raises(ValueError, match=r"check foundation\.retardation_time = 1e\+300 s$"):
        kv.transient(kv.Scene(foundation=kv.Foundation(1e10, 1e300)))
    for wrong in ("scene.toml", 0.1):
        with pytest.raises(TypeError, match="load_scene"):
            kv.steady(wrong)


def test_no_scenes_give_no_states():
    for method in ("exact", "quadrature"):
        assert kv.steady(over={"drive.velocity": []}, method=method).depth.shape == (0,)


def test_results_do_not_share_their_certificates():
    kv.steady().certificate.relative_error["depth"] = 1.0
    assert kv.steady().certificate.relative_error["depth"] < 1e-14
    for tolerance in (0.0, -1.0, 2.0, float("nan")):
        with pytest.raises(ValueError, match="tolerance"):
            kv.asymptotes(tolerance=tolerance)


def test_a_history_slides_steadily_at_its_last_velocity():
    scene = kv.Scene(drive=kv.Drive(history=[(0.0, 0.3), (1.0, 0.1)]))
    assert kv.steady(scene) == kv.steady()


def test_results_become_json():
    record = kv.steady(over={"drive.velocity": [0.1, 0.2]}).as_dict()
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    assert record["model"] == "exact"
    assert record["certificate"]["kind"] == "estimated"
    assert len(record["depth"]) == 2


@pytest.mark.parametrize("support", ["fixed", "dead-weight", "suspended"])
@pytest.mark.parametrize("tolerance", [1e-8, 1e-3, 0.05, 0.4])
def test_asymptotes_hold_exactly_in_their_ranges(support, tolerance):
    scene = kv.Scene.table1(support)
    report = kv.asymptotes(scene, tolerance=tolerance)
    critical = report.critical_velocity
    for i, line in enumerate(report.lines):
        edge = line.velocity_max if line.regime == "low" else line.velocity_min
        if not 0 < edge < np.inf:
            continue
        inward = 0.999 if line.regime == "low" else 1.001
        velocities = [edge, edge * inward, edge / inward, edge * (critical / edge) ** -0.5]
        near = kv.asymptotes(scene, over={"drive.velocity": velocities}, tolerance=tolerance).lines[
            i
        ]
        error = np.abs(near.relative_error)
        assert error[0] == pytest.approx(tolerance, rel=1e-6)
        assert error[1] <= tolerance <= error[2]
        assert near.value / near.exact - 1 == pytest.approx(
            near.relative_error, rel=1e-5, abs=1e-14
        )


def test_regime_and_advice():
    report = kv.asymptotes(over={"drive.velocity": [1e-5, 0.02, 0.03, 10.0]})
    assert report.regime.tolist() == ["low", "low", "high", "high"]
    assert report.use.tolist() == ["L1", "exact", "exact", "L2"]
    backwards = kv.asymptotes(over={"drive.velocity": [-1e-5, -10.0]})
    assert backwards.lines[0].value[0] == -report.lines[0].value[0]
    assert backwards.use.tolist() == ["L1", "L2"]


def test_the_asymptotes_meet_at_the_critical_velocity():
    for support in ("fixed", "dead-weight", "suspended"):
        scene = kv.Scene.table1(support)
        critical = kv.asymptotes(scene).critical_velocity
        low, high = kv.asymptotes(scene, over={"drive.velocity": critical}).lines[:2]
        assert low.value == pytest.approx(high.value, rel=1e-14)


def test_the_reported_peak_is_the_maximum():
    report = kv.asymptotes()
    V = report.peak_velocity * np.array([0.99, 1.0, 1.01])
    mu = kv.steady(over={"drive.velocity": V}).friction_coefficient
    assert mu[1] == pytest.approx(report.peak_friction_coefficient, rel=1e-14)
    assert mu[1] > max(mu[0], mu[2])
    assert np.isnan(kv.asymptotes(kv.Scene.table1("fixed")).peak_velocity)


def test_at_rest_what_does_not_exist_is_nan_and_null():
    report = kv.asymptotes(over={"drive.velocity": 0.0})
    depth_high = next(line for line in report.lines if line.equation == 49)
    assert np.isnan(depth_high.value)
    record = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert record["lines"][3]["value"] is None
