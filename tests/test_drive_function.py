"""A drive that is a Python function: against histories and closed forms, and what it refuses."""

import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.solved_scene import scaled_drive
from kvtheory.scene.static_state import StaticState
from tests import SUPPORTS

QUANTITIES = (
    "velocity", "depth", "depth_rate", "normal_force", "friction_force",
    "leading_edge", "trailing_edge", "peak_pressure",
)  # fmt: skip
TIMES = np.linspace(0.0, 0.2, 41)


def scene(support="dead-weight", **drive):
    return kv.Scene(support=kv.Scene.table1(support).support, drive=kv.Drive(**drive))


def difference(a, b):
    """Return the largest difference of any quantity, relative to its largest value if that is not 0."""
    return max(
        np.abs(getattr(a, name) - getattr(b, name)).max() / (np.abs(getattr(b, name)).max() or 1.0)
        for name in QUANTITIES
    )


@pytest.mark.parametrize("support", SUPPORTS)
def test_a_ramp_is_the_ramp(support):
    points = [("0 s", "0 m/s"), ("50 ms", "0.1 m/s"), ("120 ms", "-20 mm/s")]
    ramp = kv.transient(scene(support, history=points), at=TIMES, rtol=1e-11)
    t, V = [0.0, 0.05, 0.12], [0.0, 0.1, -0.02]
    function = scene(support, function=lambda s: np.interp(s, t, V), breaks=["50 ms", 0.12])
    found = kv.transient(function, at=TIMES, rtol=1e-11)
    assert difference(found, ramp) <= 1e-9
    assert [event.kind for event in found.events] == [event.kind for event in ramp.events]


@pytest.mark.parametrize("spring", [{}, {"stiffness": 1e6}])
def test_the_certificate_covers_how_far_the_velocity_is_from_the_function(spring):
    def V(t):
        return 0.05 * math.sin(60.0 * t)

    one = scene(function=V, tolerance=1e-4, **spring)
    found = kv.transient(one, at=TIMES)
    error = np.abs(found.velocity - np.vectorize(V)(TIMES)).max() / StaticState.of(one).velocity
    assert 1e-9 < error <= found.certificate.relative_error["velocity"] < 1e-3


@pytest.mark.parametrize("at_the_jump", [0.1, -0.03])
def test_a_jump_may_take_either_value_where_it_is(at_the_jump):
    """A time that is put into units of tau and back need not be the same."""
    for jump in (0.05, 0.07, 0.1 + 0.2 / 7):
        points = [(0.0, 0.1), (jump, 0.1), (jump, -0.03)]
        history = kv.transient(scene(history=points), at=TIMES, rtol=1e-11)

        def V(t, jump=jump):
            return at_the_jump if t == jump else 0.1 if t < jump else -0.03

        found = kv.transient(scene(function=V, breaks=(jump,)), at=TIMES, rtol=1e-11)
        assert difference(found, history) <= 1e-9


@pytest.mark.parametrize("at_the_jump", [0.1, -0.05, 0.03])
def test_the_jumps_of_a_function_are_those_of_the_same_history(at_the_jump):
    """At some of its breaks it has a kink, or nothing at all."""
    points = [(0.0, 0.1), (0.02, 0.1), (0.02, -0.05), (0.04, -0.05), (0.06, 0.02)]
    times, levels = (np.array(column) for column in zip(*points, strict=True))

    def velocity(t):
        if t == 0.02:
            return at_the_jump
        side = slice(0, 2) if t < 0.02 else slice(2, None)
        return float(np.interp(t, times[side], levels[side]))

    drive = kv.Drive(function=velocity, breaks=[0.02, 0.03, 0.04, 0.06])
    assert drive.jumps == kv.Drive(history=points).jumps == (0.0, 0.02)
    assert kv.Drive(function=math.sin, breaks=[0.0, 0.5]).jumps == ()
    swing = {"frequency": 3.0, "amplitude": 0.1}
    assert kv.Drive(waveform=kv.Triangle(**swing)).jumps == ()
    assert kv.Drive(waveform=kv.Sine(**swing, mean=0.2)).jumps == (0.0,)


@pytest.mark.parametrize("tau", [1.0, 7e-3])
@pytest.mark.parametrize("place", [0.05, 0.1])
@pytest.mark.parametrize("ulps", [-900, -5, -1, 1, 5, 900])
def test_changes_that_rounding_sets_apart_are_one(ulps, place, tau):
    """From each other, or from the end of the run."""
    late = place + ulps * math.ulp(place)
    first, second = sorted((place, late))
    history = [(0.0, 1.0), (first, 1.0), (second, -1.0)]
    changing = [
        kv.Drive(history=history),
        kv.Drive(function=lambda t: 1.0 if t < second else -1.0, breaks=[first, second]),
    ]
    base = kv.Parabola(0.5), kv.Foundation(1.0, tau), kv.DeadWeight(1.0, 1.0)
    ends = [kv.transient(kv.Scene(*base, drive, kv.Run(0.1)), at=[0.04, 0.1]) for drive in changing]
    assert np.all(ends[0].normal_force > 0.0)
    assert ends[1].depth == pytest.approx(ends[0].depth, rel=1e-7)


def test_a_change_right_before_the_end_is_resolved_within_its_error():
    """A reversal within 1e-13 of tau: edges, and with them forces, follow the root of the time it takes."""
    base = kv.Parabola(0.5), kv.Foundation(1.0, 1.0), kv.DeadWeight(1.0, 1.0)
    found = []
    for ulps in (5000, 20000, 80000):
        points = [(0.0, 1.0), (0.1 - ulps * math.ulp(0.1), 1.0), (0.1, -1.0)]
        each = kv.Scene(*base, kv.Drive(history=points), kv.Run(0.1))
        found.append(kv.transient(each, at=[0.1]))
    quick, slower, slowest = (result.normal_force[0] for result in found)
    off = abs(quick - (slower - 0.5 * (slowest - slower)))
    assert abs(slower - quick) > 1e-7
    assert off <= found[0].certificate.relative_error["normal_force"]


def test_a_fixed_indenter_knows_only_the_present_velocity_of_a_rising_drive():
    """Eqs. (32) and (33): its edges are -a and sqrt(a^2 + l_r^2) - l_r, whatever went before."""
    rising = scene("fixed", function=lambda t: 0.05 + 0.1 * t + 2.0 * t**3)
    found = kv.transient(rising, at=TIMES, rtol=1e-11)
    V = 0.05 + 0.1 * TIMES + 2.0 * TIMES**3
    steady = kv.steady(rising, over={"drive.velocity": V})
    assert found.velocity == pytest.approx(V, rel=1e-12)
    assert found.normal_force == pytest.approx(steady.load, rel=1e-11)
    for name in ("friction_force", "leading_edge", "trailing_edge", "peak_pressure"):
        assert getattr(found, name) == pytest.approx(getattr(steady, name), rel=1e-11), name


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_tolerance_bounds_the_error_of_the_velocity(tolerance):
    def V(t):
        return 0.3 * math.exp(-50.0 * t) * math.sin(300.0 * t)

    given = scene(function=V, tolerance=tolerance)
    units = StaticState.of(given)
    drive = scaled_drive(given, units)
    t = np.random.default_rng(1).uniform(0.0, 0.2, 500)
    found = np.array([drive.at(s)[1] for s in t / units.time]) * units.velocity
    right = np.array([V(s) for s in t])
    allowed = tolerance * np.maximum(np.abs(right).max(), units.velocity)
    assert np.abs(found - right).max() <= allowed
    travel = drive.at(0.2 / units.time)[0] * units.half_length
    # int of e^(-b t) sin(w t) from 0 to T, with b = 50/s, w = 300/s, T = 0.2 s
    exact = (
        0.3 * (300 - math.exp(-10) * (50 * math.sin(60) + 300 * math.cos(60))) / (50**2 + 300**2)
    )
    assert abs(travel - exact) <= 0.2 * allowed


def test_steady_sliding_needs_a_velocity():
    sine = scene(function=math.sin)
    for refused in (kv.steady, kv.asymptotes):
        with pytest.raises(kv.SceneError, match=r"drive\.function.*velocity or a history"):
            refused(sine)
    assert kv.steady(sine, over={"drive.velocity": 0.1}).depth == kv.steady().depth
    assert "drive.velocity" not in sine.values()
    assert "drive_number" not in StaticState.of(sine).named()
    with pytest.raises(kv.SceneError, match="unknown key"):
        sine.replace({"drive.velocty": 0.1})


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda t: 1.0 / (t - t), ["drive.function", "ZeroDivisionError", "t = ", "division"]),
        (lambda t: math.nan if t > 0.1 else 1.0, ["drive.function(", "nan", "finite number"]),
        (lambda t: np.exp(1e6 * t), ["drive.function(", "inf", "finite number"]),
        (lambda _: "0.1", ['"0.1"', "finite number"]),
        (lambda _: None, ["None", "finite number"]),
        (lambda _: [0.1, 0.2], ["[0.1, 0.2]", "finite number"]),
        (lambda: 0.1, ["drive.function", "TypeError", "positional"]),
        (lambda t: 0.1 * abs(math.sin(100 * t)), ["not smooth near", "0.031415", "kinks"]),
        (lambda t: 0.1 if t < 0.0517 else 0.2, ["not smooth near", "0.0517", "`breaks`"]),
    ],
)
def test_what_the_function_does_wrong_is_said(function, words):
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the words are checked
        kv.transient(scene(function=function))
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_a_function_that_is_too_fast_is_refused_early():
    calls = []

    def fast(t):
        calls.append(t)
        return 0.1 * math.sin(1e6 * t)

    with pytest.raises(ValueError, match="changes too fast"):
        kv.Drive(function=fast).motion(10.0, 0.01)
    assert len(calls) < 100_000
