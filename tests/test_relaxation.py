"""A Prony series for a relaxation function or a spectrum: the bound holds, and mistakes are messages."""

import math

import numpy as np
import pytest

import kvtheory as kv

OVER = 1e-4, 0.1


def lognormal(tau):
    return 2e9 * math.exp(-0.5 * (math.log(tau / 1e-3) / 2.0) ** 2)


def test_friction_of_a_spectrum_is_within_the_bound():
    """A dense series of the same spectrum: at equal contact length W and F are within 1 + eps."""
    found = kv.GeneralizedMaxwell.from_spectrum("1 GN/m^3", lognormal, rtol=0.05, over=OVER)
    tau = np.geomspace(1e-7, 1e2, 91)
    sizes = np.array([lognormal(t) for t in tau]) * math.log(tau[1] / tau[0])
    dense = kv.GeneralizedMaxwell(
        1e9, arms=[list(p) for p in zip(sizes[sizes > 1.0], tau[sizes > 1.0], strict=True)]
    )
    assert len(found.arms) < 12
    assert 0.0 < found.deviation <= 0.05
    V, key = np.geomspace(0.03, 10.0, 12), "drive.velocity"
    exact, own = (kv.steady(kv.Scene(foundation=each), over={key: V}) for each in (dense, found))
    passed = (exact.trailing_edge - exact.leading_edge) / V
    inside = (passed > OVER[0]) & (passed < OVER[1])
    assert inside.sum() > 5
    off = np.abs(own.friction_coefficient / exact.friction_coefficient - 1.0)[inside]
    r = (1.0 + found.deviation) / (1.0 - found.deviation)
    assert off.max() < r**4 - 1.0 < found.friction_bound == r**4.5 - 1.0
    own = kv.Scene(foundation=found)
    for speed, held in ((V[inside][0], True), (V[inside][-1], True), (300.0, False)):
        notes = kv.steady(own, over={key: speed}).notes
        assert f"differs by at most {found.friction_bound:.2g} of it" in notes[-1]
        assert any("is outside the frequencies" in note for note in notes) != held
    held = own.replace({"foundation.stiffness": 2e9})
    assert held.foundation.friction_bound == 0.0
    assert kv.steady(kv.Scene(kv.Parabola(1e-2), found, kv.Fixed("0.1 mm"))).notes == ()


@pytest.mark.parametrize(
    "G",
    [
        lambda t: 1e9 + 3e9 * math.exp(-((t / 1e-2) ** 0.5)),
        lambda t: 1e9 + 2e9 * (1.0 + t / 1e-4) ** -0.4,
        lambda t: 1e9 + (2e8 * t**-0.3 if t else math.inf),
    ],
)
def test_a_relaxation_function_is_met_within_the_range(G):
    found = kv.GeneralizedMaxwell.from_relaxation(G, rtol=0.02, over=("0.1 ms", "100 ms"))
    assert found.stiffness == 1e9
    assert found.deviation <= 0.02
    t = np.geomspace(*OVER, 40)
    relaxed = sum(arm.stiffness * np.exp(-t / arm.relaxation_time) for arm in found.arms)
    exact = np.array([G(each) for each in t]) - 1e9
    assert relaxed == pytest.approx(exact, rel=0.021)


def peak(width, beside):
    return lambda tau: beside + 4e9 * math.exp(-0.5 * (math.log10(tau / 1.0234e-2) / width) ** 2)


def test_a_narrow_peak_of_a_spectrum_is_within_the_bound_or_refused():
    H = peak(0.005, 1e8)
    found = kv.GeneralizedMaxwell.from_spectrum(1e9, H, rtol=0.05, over=OVER)
    tau, t = np.logspace(-8, 3, 110_001), np.geomspace(*OVER, 7)
    exact = (np.exp(-t[:, None] / tau) / tau) @ [H(x) for x in tau] * np.log(tau[1] / tau[0])
    slopes = sum(
        arm.stiffness / arm.relaxation_time * np.exp(-t / arm.relaxation_time) for arm in found.arms
    )
    assert np.abs(slopes / exact - 1.0).max() < found.deviation
    with pytest.raises(ValueError, match="`H` changes too fast"):
        kv.GeneralizedMaxwell.from_spectrum(1e9, peak(0.001, 0.0), rtol=0.05, over=OVER)


def test_one_arm_is_found_wherever_its_time_is():
    found = kv.GeneralizedMaxwell.from_relaxation(
        lambda t: 1e9 + 3e9 * math.exp(-t / 1e-2), over=OVER
    )
    ((stiffness, time),) = [(arm.stiffness, arm.relaxation_time) for arm in found.arms]
    assert (stiffness, time) == pytest.approx((3e9, 1e-2), rel=1e-4)


@pytest.mark.parametrize(
    ("G", "how", "told"),
    [
        (lambda t: 1e9 + t, {"over": OVER, "stiffness": 1e9}, "`G`: expected a finite function that falls"),
        (lambda t: 1e9, {"over": OVER}, "that falls"),
        (lambda t: 1.0 + math.exp(-t), {"over": (1.0, 0.1)}, "the shortest time first"),
        (lambda t: 1.0 + math.exp(-t), {"over": 1.0}, "the shortest and the longest time"),
        (lambda t: 1.0 + math.exp(-t), {"over": OVER, "rtol": 2.0}, "`rtol` = 2.0"),
        (lambda t: 1.0 + math.exp(-(t**1.5)), {"over": (0.1, 2.0), "rtol": 0.01}, "no series was found"),
        (lambda t: 1.0 + math.exp(-t) + (t < 0.5), {"over": (0.1, 2.0)}, "no series was found"),
        (lambda t: math.inf, {"over": OVER}, "`G` is inf at inf s: expected a finite number"),
        (lambda t: None, {"over": OVER}, "`G` is None at inf s"),
        (lambda t: 1.0, {"over": OVER, "stiffness": "1 mm"}, '`stiffness` = "1 mm": the unit'),
        (lambda t: 1.0, {"over": (0.0, 1.0)}, "`over` = 0.0: is out of range"),
        (lambda t: 1.0, {"over": (1e-300, 1e300)}, "by a factor of at most 1e\\+30"),
        (lambda t: 1.0, {"over": OVER, "rtol": "much"}, "`rtol` = 'much'"),
    ],
)  # fmt: skip
def test_mistakes_are_messages(G, how, told):
    with pytest.raises(ValueError, match=told):
        kv.GeneralizedMaxwell.from_relaxation(G, **how)
