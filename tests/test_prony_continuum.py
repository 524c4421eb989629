"""The transient on a Prony series without elements: values, limits, certificates, and what it refuses."""

import os
import sys
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory import compilation
from kvtheory.models.continuum.prony import contact, energy, evaluation, trajectory, walk
from kvtheory.results.table import scales
from kvtheory.scene.static_state import StaticState

SCENES = int(os.environ.get("KVTHEORY_TEST_SCENES", "200"))
ZENER = [(5e10, 0.1)]
SERIES = (
    "depth",
    "normal_force",
    "friction_force",
    "leading_edge",
    "trailing_edge",
    "peak_pressure",
)


def sliding(arms, velocity=0.05, duration=0.06, **parts):
    foundation = kv.GeneralizedMaxwell(1e10, arms=arms)
    drive = velocity if isinstance(velocity, kv.Drive) else kv.Drive(velocity=velocity)
    return kv.Scene(foundation=foundation, drive=drive, run=kv.Run(duration=duration), **parts)


def apart(one, other, scene, names=SERIES):
    """Return the largest difference of two series, relative to the scene at rest."""
    measures = scales(StaticState.of(scene))
    return max(
        float(np.nanmax(np.abs(getattr(one, name) - getattr(other, name)))) / measures[name]
        for name in names
    )


def test_the_values_of_two_other_programs():
    """Fact F23: Table 1 with one arm of 50 GN/m^3 and 100 ms at 50 mm/s."""
    found = kv.transient(sliding(ZENER), at=[0.06], rtol=1e-8, certify=False)
    assert found.depth[0] == pytest.approx(0.12105290e-3, rel=4e-8)
    assert found.normal_force[0] == pytest.approx(9631.5699, rel=6e-9)
    assert found.friction_force[0] == pytest.approx(300.69993, rel=2e-8)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_a_tolerance_is_met(rtol):
    scene = sliding([(5e10, 0.1), (1e9, 1e-6)], support=kv.Suspended(mass=3000.0, stiffness=1e8))
    at = np.linspace(0.0, 0.06, 7)
    found, truth = (
        kv.transient(scene, at=at, rtol=each, certify=each == rtol) for each in (rtol, 1e-9)
    )
    assert apart(found, truth, scene) < 3.0 * rtol
    for name in SERIES:
        error = apart(found, truth, scene, [name])
        assert error <= found.certificate.relative_error[name] <= 1e4 * rtol


def test_no_arms_are_elastic():
    found = kv.transient(sliding([(1e-3, 0.1)]), at=[0.0, 0.03, 0.06])
    assert found.depth == pytest.approx(found.depth[0], rel=1e-12)
    assert np.abs(found.friction_force).max() < 1e-8


def test_a_fast_arm_tends_to_kelvin_voigt_to_first_order():
    """K_1 tau_1 = C; towards it the motion does not become harder to solve."""
    at, errors, steps = [0.01, 0.03, 0.06], [], []
    support = kv.Suspended(load=9806.65, mass=10.0, stiffness=3e7)
    damper = kv.Scene(support=support, drive=kv.Drive(velocity=0.05), run=kv.Run(duration=0.06))
    truth = kv.transient(damper, at=at, rtol=1e-10)
    for time in (1e-5, 1e-6, 1e-11):
        scene = sliding([(1e9 / time, time)], support=support)
        found = kv.transient(scene, at=at, rtol=1e-7, certify=False)
        errors.append(apart(found, truth, scene, SERIES[:3]))
        steps.append(found.steps)
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.05)
    assert errors[2] < 3e-7
    assert max(steps) < 150


def test_it_ends_in_steady_sliding():
    for velocity in (0.2, -0.2):
        scene = sliding([(3e10, 0.01)], velocity, 0.5)
        found, steady = kv.transient(scene, at=[0.5], certify=False), kv.steady(scene)
        for name in ("depth", "friction_force", "trailing_edge", "peak_pressure"):
            assert getattr(found, name)[0] == pytest.approx(getattr(steady, name), rel=1e-5)


def test_a_long_slide_on_slow_arms_ends_in_steady_sliding():
    """Over 360 half lengths and back, with accumulators that are restarted on the way."""
    history = [(0.0, 30.0), (0.03, 30.0), (0.03, -30.0), (0.06, -30.0)]
    arms, at, x = [(3e10, 5e-4), (5e9, 2e-3)], [0.03, 0.06], np.linspace(-2.4e-3, 1e-3, 5)
    scene = sliding(arms, kv.Drive(history=history), 0.06, support=kv.Fixed(3e-4))
    found = kv.transient(scene, at=at, certify=False)
    steady, error = (
        kv.steady(replace(scene, drive=kv.Drive(30.0))),
        3e-7 * StaticState.of(scene).load,
    )
    assert found.friction_force == pytest.approx(
        [steady.friction_force, -steady.friction_force], abs=error
    )
    assert found.peak_pressure == pytest.approx([steady.peak_pressure] * 2, rel=1e-5)
    assert found.pressure(x, 0.03) == pytest.approx(found.pressure(-x, 0.06), rel=1e-5)
    books = found.energy([0.002, *at])
    assert np.abs(books.balance / (books.stored_at_rest + books.work)).max() < 1e-5


def test_what_is_dissipated_is_the_power_of_the_arm_over_time():
    """That power, int s^2/(K_1 tau_1) dx with s = p - K u, from pressures and surfaces at many instants."""
    K, K_1, tau = 4e9, 3e10, 0.01
    drive = kv.Drive(history=[(0.0, 0.05), (0.01, 0.05), (0.01, -0.05), (0.02, -0.05)])
    scene = kv.Scene(
        foundation=kv.GeneralizedMaxwell(K, [[K_1, tau]]), drive=drive, run=kv.Run(0.02)
    )
    nodes, weights = (np.polynomial.legendre.leggauss(8) + np.array([[1.0], [0.0]])) / 2.0
    times = np.concatenate([0.01 * nodes, 0.01 + 0.01 * nodes])
    found = kv.transient(scene, at=times, rtol=1e-7, certify=False)
    inside, outside = [], []
    for k, time in enumerate(times):
        low, high = sorted([found.leading_edge[k], found.trailing_edge[k]])
        x = np.linspace(low, high, 61)[1:-1]
        within = found.pressure(x, time) - K * found.surface(x, time)
        free = np.append(np.linspace(low - 3e-3, low, 121), np.linspace(high, high + 3e-3, 121))
        beyond = -K * np.where((free < low) | (free > high), found.surface(free, time), 0.0)
        assert not beyond[[0, -1]].any()  # all of what is compressed
        inside.append((within**2).sum() * (high - low) / 60.0)
        outside.append((beyond**2).sum() * 2.5e-5)
    books = found.energy([0.0, 0.02])
    for name, squares in (("contact", inside), ("surface", outside)):
        expected = 0.01 * np.append(weights, weights) @ squares / (K_1 * tau)
        none, measured = getattr(books, f"dissipated_{name}")
        assert none == 0.0
        assert measured == pytest.approx(expected, rel=0.02), name
    assert np.abs(books.balance).max() < 1e-8 * books.work[1]


def test_small_disturbances_decay_at_the_rates_of_f24(monkeypatch):
    """A while after a small change of the velocity four rates are left, whose recurrence the depth obeys."""
    monkeypatch.setattr(trajectory.KERNEL, "worthwhile", lambda *_: compilation.available())
    arms, V, held = (
        [(3e10, 0.01), (5e9, 0.2)],
        0.2,
        {"stiffness": 2e7, "damping": 2e5, "mass": 1000.0},
    )
    rates = kv.stability(sliding(arms, kv.Drive(velocity=V, **held))).rates @ [1.0, 1.0j]
    times, depths = 0.5 + 0.002 * np.arange(8), []
    for later in (V, V * (1.0 + 1e-4)):
        drive = kv.Drive(history=[(0.0, V), (0.4, V), (0.4, later), (0.6, later)], **held)
        depths.append(
            kv.transient(sliding(arms, drive, 0.6), at=times, rtol=1e-11, certify=False).depth
        )
    change = np.diff(depths[1] - depths[0])
    rest = np.convolve(change, np.poly(np.exp(0.002 * rates)).real, "valid")
    assert np.abs(rest).max() < 2e-5 * np.abs(change).max()


def test_the_peak_is_the_largest_pressure():
    found = kv.transient(sliding([(5e10, 0.1), (2e10, 3e-3)]), rtol=1e-6, certify=False)
    for k in (5, len(found.time) // 2, -1):
        x = np.linspace(found.leading_edge[k], found.trailing_edge[k], 2001)
        p = found.pressure(x, found.time[k])
        assert p[0] == pytest.approx(0.0, abs=1e-6 * p.max())
        assert p[-1] == pytest.approx(0.0, abs=1e-4 * p.max())
        assert 0.0 <= found.peak_pressure[k] - p.max() < 1e-3 * p.max()  # it may have a kink


STOP = [(0.0, 0.05), (0.02, 0.05), (0.02, 0.0), (0.045, 0.0)]
REVERSAL = [(0.0, 0.0), (0.02, 0.05), (0.03, -0.1), (0.045, -0.1)]


@pytest.mark.parametrize("points", [STOP, REVERSAL])
def test_stops_and_reversals_agree_with_elements(points):
    """Edges turn, meet ground that they left, and pass from one segment of it to the next."""
    scene = sliding([(2e10, 0.1), (2e10, 3e-3)], kv.Drive(history=points), 0.045)
    at = [0.01, 0.021, 0.025, 0.03, 0.035, 0.04, 0.045]
    found = kv.transient(scene, at=at, rtol=1e-5, certify=False)
    assert {"right edge touches", "left edge peels"} <= {event.kind for event in found.events}
    coarse, fine = (kv.elements(scene, per_length=each, at=at) for each in (1e5, 2e5))
    for name in SERIES:
        limit = (4.0 * getattr(fine, name) - getattr(coarse, name)) / 3.0  # of second order
        off = np.abs(getattr(found, name) - limit).max() / scales(StaticState.of(scene))[name]
        assert off < 0.7 * apart(fine, coarse, scene, [name]) + 2e-5, name


def test_the_free_surface_relaxes_behind_the_contact():
    scene = sliding([(2e10, 0.1), (2e10, 3e-3)])
    found = kv.transient(scene, at=[0.0, 0.06], rtol=1e-6, certify=False)
    edge, a = found.trailing_edge[-1], found.depth[-1]
    x = edge + np.array([-1e-9, 1e-9, 2e-4, 5e-4])
    u = found.surface(x, 0.06)
    assert u[0] == pytest.approx(a - x[0] ** 2 / 0.02, rel=1e-5)
    assert u[1] == pytest.approx(u[0], abs=1e-5 * a)
    assert (u[1:] > a - x[1:] ** 2 / 0.02).all()
    assert found.surface([found.leading_edge[-1] - 1e-5], 0.06) == [0.0]
    assert (found.pressure(x[1:], 0.06) == 0.0).all()


def test_a_reversal_over_ground_that_the_other_edge_left_is_one_interval():
    """Free ground on one side reaches under the contact, and beyond the edge of the other side."""
    arms, V = [(7.858e10, 0.2), (12.069e10, 4.2)], 0.0053484
    drive = kv.Drive(history=[(0.0, V), (1.08, V), (1.08, -V), (3.6, -V)])
    scene = sliding(arms, drive, 3.6, support=kv.Fixed(depth=1e-4))
    at = [1.0, 1.5, 1.7, 2.5, 3.6]
    found = kv.transient(scene, at=at, rtol=1e-4, certify=False)
    assert apart(found, kv.elements(scene, per_length=1e5, at=at), scene, SERIES[:5]) < 2e-3


def test_a_jump_of_remembered_stresses_does_not_stop_an_edge():
    """After a stop and a reversal an edge peels over places where the other one passed to other ground."""
    history = [(0.0, 0.1), (0.04, 0.1), (0.04, 0.0), (0.06, 0.0), (0.06, -0.1)]
    scene = sliding([(1e10, 5e-3), (1e10, 0.05), (1e10, 0.5)], kv.Drive(history=history), 0.1)
    found = kv.transient(scene, at=[0.05, 0.09, 0.1], rtol=1e-6)
    assert max(found.certificate.relative_error.values()) < 1e-4


def test_an_edge_peels_over_ground_that_it_wrote_while_the_other_one_turned():
    """Stick-slip: the indenter comes to rest, so that one edge turns on ground that the other still meets."""
    drive = kv.Drive(velocity=0.091, stiffness=2e5, mass=100.0)
    scene = sliding([(1e10, 5e-3), (1e10, 0.05), (1e10, 0.5)], drive, 0.168)
    found = kv.transient(scene, at=[0.16, 0.168], rtol=1e-6)
    assert "left edge peels" in {event.kind for event in found.events}
    assert max(found.certificate.relative_error.values()) < 1e-4


def test_an_edge_turns_in_time_behind_a_fast_arm():
    """Slips on a stiff spring: p' of an element is lost in the terms of the arm, edges turned too late."""
    drive = kv.Drive(velocity=0.1, stiffness=1e9, mass=30.0)
    scene = sliding([(2e17, 1e-9)], drive, 0.04, support=kv.Fixed(depth=3e-4))
    assert kv.transient(scene, at=[0.04], rtol=3e-5, certify=False).steps < 250


def test_each_end_of_a_segment_is_passed_by_the_edge_next_to_it():
    """Both edges peel before a take-off; where the right one leaves the ground at rest, not the left."""
    support = kv.DeadWeight(load=3000.0, mass=500.0)
    scene, at = sliding([(1e12, 0.01)], 2.0, 0.0014, support=support), [0.0005, 0.00118, 0.0012]
    found = kv.transient(scene, at=at, rtol=1e-5)
    truth = kv.elements(scene, per_length=5e4, at=at)
    for name in SERIES:
        claimed = [each.certificate.relative_error[name] for each in (found, truth)]
        assert apart(found, truth, scene, [name]) <= sum(claimed), name
        assert claimed[0] < 1e-3


def test_an_edge_is_the_nearest_root_of_the_gap():
    """After a reversal free ground reaches under the whole contact: the gap above it has two roots."""
    drive = kv.Drive(history=[(0.0, 1.0), (0.004, 1.0), (0.004, -1.0), (0.009, -1.0)])
    scene = sliding([(1e12, 0.01)], drive, 0.009, support=kv.Fixed(depth=1e-4))
    found = kv.transient(scene, at=[0.0085, 0.009], rtol=1e-5, certify=False)
    truth = kv.elements(scene, per_length=1e5, at=[0.0085, 0.009])
    assert apart(found, truth, scene, SERIES[:5]) < 2e-3


def test_a_peak_is_found_where_all_elements_in_contact_entered_within_one_step():
    points = [(0.0, 2.0), (0.006, 2.0), (0.006, 0.0), (0.01, 0.0), (0.01, 2.0), (0.02, 2.0)]
    scene = sliding([(4e11, 0.02)], kv.Drive(history=points), 0.02, support=kv.Fixed(depth=1e-4))
    found = kv.transient(scene, at=np.linspace(0.0, 0.02, 41), rtol=1e-6)
    assert found.peak_pressure.min() >= 1e6
    assert found.certificate.relative_error["peak_pressure"] < 1e-4


def test_an_iteration_that_overflows_only_ends_a_step():
    """The slide reverses so fast that an iteration diverges; the depths are those of elements, too."""
    arms = [(4.023985780818568, 2.5739791807988586), (3.141290211081011, 0.16706778811650697)]
    V, times = 7.849591239058096, (1.1527881712585648, 1.659631951304448, 2.176492146505446)
    scene = kv.Scene(
        kv.Parabola(0.5),
        kv.GeneralizedMaxwell(0.75, arms),
        kv.DeadWeight(mass=0.1, gravity=10.0),
        kv.Drive(history=list(zip((0.0, *times), (0.0, -V, -V, V), strict=True))),
        kv.Run(times[-1]),
    )
    found = kv.transient(scene, at=[1.7, 2.1], rtol=1e-5, certify=False)
    assert found.depth == pytest.approx([-0.0275, 0.1534], abs=2e-4)


def test_an_edge_is_no_place_where_the_ground_stands_still():
    """After a dwell much of the history of an edge is one place, where the search for a root may not end."""
    history = [(0.0, 365.0), (7e-5, 365.0), (7e-5, 0.0), (4e-4, 0.0), (4e-4, 94.0)]
    scene = sliding(
        [(4.5e8, 1.5e-6), (4.6e10, 20.0)], kv.Drive(history=history), 4.2e-4, support=kv.Fixed(3e-4)
    )
    found = kv.transient(scene, at=[4.2e-4], rtol=1e-6)
    assert found.certificate.relative_error["trailing_edge"] < 1e-5


def test_a_short_run_has_no_large_error():
    support = kv.DeadWeight(load=9806.65, mass=1000.0)
    found = kv.transient(sliding(ZENER, 100.0, 1e-9, support=support), at=[1e-9])
    assert max(found.certificate.relative_error.values()) < 1e-5


@pytest.mark.parametrize("amplitude", [1.4, 1.5])
def test_it_takes_off_from_ground_that_was_in_contact_at_rest(amplitude):
    """The search for an edge may not begin with a move that is longer than the contact is wide."""
    drive = kv.Drive(waveform=kv.Sine(amplitude=amplitude, frequency=260.0))
    scene = sliding(
        [(3e10, 0.01), (1e10, 1e-4)], drive, 0.003, support=kv.DeadWeight(load=9806.65, mass=100.0)
    )
    found = kv.transient(scene, at=[0.003], rtol=1e-9)
    assert "take-off" in [event.kind for event in found.events]
    assert found.certificate.relative_error["depth"] < 1e-6


def test_many_arms_are_interpreted_at_once(interpreted):
    """A hundred arms need little more Python than a few, each of which an array would not make faster."""
    calls = []
    for count in (4, 100):
        arms = [(5e10 / count, 0.1 * 10.0 ** (4.0 * i / count - 2.0)) for i in range(count)]
        scene, called = sliding(arms, duration=0.02), [0]

        def count_call(frame, event, _, called=called):
            called[0] += event == "call"

        before = sys.getprofile()
        sys.setprofile(count_call)
        try:
            steps = kv.transient(scene, at=[0.02], rtol=1e-4, certify=False).steps
        finally:
            sys.setprofile(before)
        calls.append(called[0] / steps)
    assert calls[1] < 3.0 * calls[0]


def test_hops_agree_with_elements():
    """The indenter leaves the foundation, flies, lands on relaxing ground, and leaves it again."""
    scene = sliding([(3e11, 0.01)], 0.3, 0.026)
    at = [0.003, 0.005, 0.0056, 0.01, 0.0165, 0.018, 0.0195, 0.021, 0.025]
    found = kv.transient(scene, at=at, rtol=1e-6)
    kinds = [event.kind for event in found.events if event.kind in ("take-off", "landing")]
    assert kinds == ["take-off", "landing", "take-off"]
    assert [found.leading_state[k] for k in (2, 3, 4)] == ["peeling", "free", "touching"]
    assert np.isnan(found.trailing_edge[[3, 8]]).all()
    assert found.normal_force[3] == found.peak_pressure[3] == 0.0
    coarse, fine = (kv.elements(scene, per_length=each, at=at) for each in (5e4, 1e5))
    for name in SERIES:
        limit = (4.0 * getattr(fine, name) - getattr(coarse, name)) / 3.0  # of second order
        off = np.nanmax(np.abs(getattr(found, name) - limit)) / scales(StaticState.of(scene))[name]
        assert off < 0.5 * apart(fine, coarse, scene, [name]), name
        assert found.certificate.relative_error[name] < 1e-4
    x = np.linspace(-2e-3, 2e-3, 41)
    flat = found.depth[3] - x**2 / 0.02
    assert (found.surface(x, at[3]) > flat).all()
    assert (found.pressure(x, at[3]) == 0.0).all()


def random_scene(seed):
    """Return a scene with up to twelve arms over eight decades, which mostly slides one way."""
    rng = np.random.default_rng(seed)
    V, count = 10.0 ** rng.uniform(-3, 0), int(rng.integers(1, 13 if seed % 8 == 7 else 4))
    transit = 1.4e-3 / V
    share = rng.dirichlet(np.ones(count)) * 10.0 ** rng.uniform(-0.5, 1.5)
    arms = [
        (float(1e10 * k), float(t))
        for k, t in zip(share, transit * 10.0 ** rng.uniform(-4, 4, count), strict=True)
    ]
    M, duration = (
        1000.0 * 10.0 ** rng.uniform(-2, 2),
        float(transit * 10.0 ** rng.uniform(-0.5, 0.8)),
    )
    support = [
        kv.DeadWeight(load=9806.65, mass=M),
        kv.Suspended(load=9806.65, mass=M, stiffness=10.0 ** rng.uniform(6, 9)),
        kv.Fixed(depth=1e-4),
    ][seed % 3]
    T, spring = duration, {}
    if rng.random() < 0.2:
        spring = {
            "stiffness": 10.0 ** rng.uniform(6, 9),
            "mass": 1000.0 * 10.0 ** rng.uniform(-2, 1),
        }
    faster = [(0.0, V), (0.3 * T, V), (0.3 * T, V * rng.uniform(1, 2)), (T, 2.0 * V)]
    history = [[(0.0, V), (T, V)], [(0.0, 0.0), (T * rng.uniform(0.05, 0.5), V), (T, V)], faster]
    return sliding(
        arms, kv.Drive(history=history[seed % 7 % 3], **spring), duration, support=support
    )


def test_random_scenes_agree_with_elements_within_both_certificates():
    solved = 0
    for seed in range(SCENES // 25):
        scene = random_scene(seed)
        at = np.linspace(0.1, 1.0, 7) * scene.run.duration
        try:
            found = kv.transient(scene, at=at, max_steps=60)
        except (ValueError, ArithmeticError):
            continue
        truth = kv.elements(scene, per_length=3e4, at=at)
        solved += 1
        for name in SERIES:
            claimed = (each.certificate.relative_error[name] for each in (found, truth))
            assert apart(found, truth, scene, [name]) <= sum(claimed), (seed, name)
    assert solved >= 0.3 * SCENES // 25


def test_compiled_kernels_give_the_same_numbers(monkeypatch):
    pytest.importorskip("numba")
    scene = sliding([(5e10, 0.1), (2e10, 3e-3)], kv.Drive(velocity=0.05, stiffness=1e8))
    found = []
    for fast in (False, True):
        monkeypatch.setattr(trajectory.KERNEL, "worthwhile", lambda *_, fast=fast: fast)
        found.append(kv.transient(scene, at=[0.01, 0.06]))
    assert [each.compiled for each in found] == [False, True]
    assert apart(*found, scene) < 1e-12
    assert found[0].steps == found[1].steps


def test_a_history_of_many_points_has_steps_for_each(monkeypatch):
    corners = [(1e-4 * i, 0.05 + 0.001 * (i % 3)) for i in range(13)]
    scene = kv.Scene(
        foundation=kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)]),
        drive=kv.Drive(history=corners),
        run=kv.Run(1.2e-3),
    )
    monkeypatch.setattr(trajectory, "STEP_LIMIT", 0)
    assert kv.transient(scene, at=[1.2e-3], certify=False).steps > 0


def test_a_history_of_many_points_costs_as_much_for_each_of_them(monkeypatch, interpreted):
    """The contact has a segment for each point: no step, peak or energy looks at all of them."""
    corners = [(2e-4 * i, 0.05 + 0.02 * (i % 2)) for i in range(41)]
    scene = sliding([(3e10, 0.01)], kv.Drive(history=corners), 8e-3, support=kv.Fixed(1e-4))

    def solved():
        return kv.transient(scene, at=[4e-3, 8e-3], rtol=1e-3, certify=False)

    whole, looks = solved(), []
    monkeypatch.setattr(walk, "INSIDE", 4)
    monkeypatch.setattr(evaluation, "MANY", 8)
    monkeypatch.setattr(walk, "pressed", lambda *each: looks.append(each) or contact.pressed(*each))
    found = solved()
    now = found.solution.motion.counts
    assert now.count > 35
    assert now.chain < 8 * now.count
    assert len(looks) <= 3 * 5 * now.steps
    assert apart(found, whole, scene) == 0.0
    calls = []
    parts = energy.Ground._parts
    monkeypatch.setattr(
        energy.Ground, "_parts", lambda ground, step: calls.append(step) or parts(ground, step)
    )
    assert abs(found.energy([4e-3, 8e-3]).balance).max() < 1e-4
    assert len(calls) == 2  # the ground of a step is all that came before
