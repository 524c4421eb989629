"""What follows from a drive alone; points of a history that say nothing change nothing anywhere."""

import itertools
import math
import pickle
from functools import partial

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.scene.base_motion import BaseMotion

PLAIN = {
    "start": [(0.0, 0.1)],
    "stop and go": [(0.0, 0.1), (0.05, 0.1), (0.05, 0.0), (0.1, 0.0), (0.1, 0.08)],
    "ramp": [(0.0, 0.0), (0.04, 0.12), (0.09, 0.02)],
}
REDUNDANT = {
    "start": [(0.0, 0.0), (0.0, 0.1), (0.0625, 0.1), (0.0625, 0.1), (0.25, 0.1)],
    "stop and go": [
        (0.0, 0.1), (0.025, 0.1), (0.05, 0.1), (0.05, 0.0), (0.07, 0.0), (0.1, 0.0), (0.1, 0.08),
        (0.15, 0.08), (0.45, 0.08),
    ],
    "ramp": [(0.0, 0.0), (0.02, 0.06), (0.04, 0.12), (0.065, 0.07), (0.09, 0.02), (0.34, 0.02)],
}  # fmt: skip
TIMES = np.linspace(0.0, 0.2, 41)
SPOKEN = ("last_change", "jumps", "changes", "constant", "final_velocity")


@pytest.fixture(params=PLAIN)
def pair(request):
    """The same drive with and without redundant points."""
    points = PLAIN[request.param], REDUNDANT[request.param]
    return tuple(kv.Scene(drive=kv.Drive(history=history)) for history in points)


def test_redundant_points_change_neither_the_drive_nor_a_motion(pair):
    plain, redundant = (scene.drive for scene in pair)
    for name in SPOKEN:
        assert getattr(redundant, name) == getattr(plain, name), name
    assert redundant.history != plain.history  # what was given is kept, for a file
    simulate = partial(kv.elements, at=TIMES, per_length="50 /mm", certify=False)
    for solve in (partial(kv.transient, at=TIMES), simulate):
        one, other = (solve(scene) for scene in pair)
        for name in kv.results.TRANSIENT_UNITS:
            a, b = getattr(one, name), getattr(other, name)
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12, err_msg=name)


def test_redundant_points_do_not_change_what_is_said_of_a_motion(pair):
    names = ["settling_time", "peak_to_steady_friction"]
    over = {"run.duration": ["0.5 s"]}
    measured = [kv.sweep(scene, over=over, quantities=names) for scene in pair]
    for name in names:
        assert measured[0][name] == pytest.approx(measured[1][name], rel=1e-9)
    assert measured[0]["settling_time"] > 0.01
    reports = [kv.compare(scene, data=kv.transient(scene, at=TIMES)) for scene in pair]
    checks = [{check.name: check.ok for check in report.checks} for report in reports]
    assert checks[0] == checks[1]
    models = [kv.solve(scene, at=TIMES[1:].tolist(), rtol=1e-2).model for scene in pair]
    assert models[0] == models[1]


@pytest.mark.parametrize(
    ("history", "points"),
    [
        ([(0.0, 0.0)], [(0.0, 0.0)]),
        ([(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0)]),
        ([(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (2.0, 1.0)], [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]),
        ([(0.0, 1.0), (0.0, 1.0), (1.0, 2.0)], [(0.0, 1.0), (1.0, 2.0)]),
        ([(0.0, 1.0), (1.0, 1.0), (1.0, 2.0), (2.0, 2.0)], [(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)]),
        ([(0.0, 0.1), (0.1, 0.2), (0.2, 0.3), (0.3, 0.4)], [(0.0, 0.1), (0.3, 0.4)]),
        ([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)], [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]),
    ],
)
def test_the_points_that_matter(history, points):
    assert kv.Drive(history=history).points == tuple(points)


def test_random_points_inside_a_history_are_found_redundant():
    rng = np.random.default_rng(3)
    for _ in range(50):
        times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 1.0, 6))])
        velocities = rng.normal(size=7)
        plain = list(zip(times.tolist(), velocities.tolist(), strict=True))
        extra = rng.uniform(0.0, times[-1], 10)
        between = zip(extra.tolist(), np.interp(extra, times, velocities).tolist(), strict=True)
        drive = kv.Drive(history=sorted([*plain, *between]))
        assert len(drive.points) == len(plain)


def test_on_a_piece_of_its_motion_the_base_moves_one_way():
    for velocity in (lambda t: (t - 0.7) ** 2 - 1e-9, lambda t: math.sin(5 * t) - 0.9999):
        motion = BaseMotion.from_function(velocity, 1.0)
        zeros = [piece[0] for piece in motion.pieces if piece[3] == 0.0]
        assert len(zeros) == 2
        for t in zeros:
            assert velocity(t) == pytest.approx(0.0, abs=1e-12)
            assert motion.at(t)[:2] == (pytest.approx(motion.displacement(t), abs=1e-15), 0.0)
            assert motion.forward(t - 1e-6) is not motion.forward(t + 1e-6)


def test_the_motion_of_a_drive_is_its_integral():
    points = [(0.0, 0.0), (1.0, 2.0), (1.0, -1.0), (3.0, 1.0)]
    motion = BaseMotion.from_points(points, 5.0)
    assert motion.changes == (0.0, 1.0, 3.0)
    assert motion.at(1.0) == (1.0, -1.0, 1.0)
    assert motion.velocity(1.0, before=True) == 2.0
    assert motion.displacement(5.0) == pytest.approx(3.0, rel=1e-15)
    assert motion.extremes(1.0, 3.0) == pytest.approx((0.5, 1.0), rel=1e-15)
    assert motion.highest_speed == 2.0
    assert [motion.forward(t) for t in (0.5, 1.5, 2.0, 2.5)] == [True, False, False, True]
    scaled = motion.scaled(2.0, 0.5)
    for t in (0.3, 1.0, 1.7, 4.0):
        Y, V, slope = motion.at(t)
        assert scaled.at(t / 2.0) == pytest.approx((Y / 0.5, V * 4.0, slope * 8.0), rel=1e-14)


def test_a_jump_at_the_very_end_counts_and_so_does_the_speed_between_two_ends():
    motion = kv.Drive(history=[(0.0, 0.1), (1.0, 0.1), (1.0, 0.3)]).motion(1.0, least=0.1)
    assert motion.velocity(1.0) == 0.3
    assert motion.velocity(1.0, before=True) == 0.1
    motion = kv.Drive(function=lambda t: math.sin(math.pi * t)).motion(1.0, least=1.0)
    assert motion.highest_speed == pytest.approx(1.0, rel=1e-3)


def test_the_edge_leads_that_led_before_whatever_instants_are_asked_for():
    drive = kv.Drive(history=[(0.0, -0.1), (0.05, -0.1), (0.05, 0.0)])
    late = [0.06, 0.08]
    scene = kv.Scene(drive=drive)
    whole = kv.transient(scene, at=[0.0, 0.02, *late])
    alone = kv.transient(scene, at=late)
    swept = kv.sweep(scene, over={"run.duration": [0.2]}, at=late, quantities=["leading_edge"])
    assert alone.leading_edge.tolist() == whole.leading_edge[2:].tolist()
    assert alone.trailing_edge.tolist() == whole.trailing_edge[2:].tolist()
    assert swept["leading_edge"][0].tolist() == alone.leading_edge.tolist()
    assert alone.leading_edge[0] > 0.0  # the base moved backward
    simulated = kv.elements(scene, at=late, certify=False)
    assert np.sign(simulated.leading_edge).tolist() == np.sign(alone.leading_edge).tolist()


def test_times_that_go_back_by_rounding_are_one_time():
    points = [(0.0, 0.0)]
    for i in range(1000):
        points += [(i * 0.1, 0.1), (i * 0.1 + 0.1, 0.1)]
    assert any(late[0] < early[0] for early, late in itertools.pairwise(points))
    times = [time for time, _ in kv.Drive(history=points).history]
    assert times == sorted(times)
    with pytest.raises(kv.SceneError, match="must not decrease"):
        kv.Drive(history=[(0.0, 0.0), (1.0, 0.1), (1.0 - 1e-11, 0.2)])


def test_of_many_mistakes_the_first_are_told_and_the_others_counted():
    with pytest.raises(kv.SceneError) as caught:
        kv.Drive(history=[(0.0, 0.0), *[("soon", 0.1)] * 1000])
    assert len(caught.value.problems) == 1000
    assert str(caught.value).count("\n") == caught.value.SHOWN
    assert str(caught.value).endswith("and 980 more mistakes")
    assert pickle.loads(pickle.dumps(caught.value)).problems == caught.value.problems


def test_the_limit_of_steps_grows_with_the_drive():
    """What the drive asks for is no reason to give up; what nobody asked for is."""
    scene = kv.Scene(
        drive=kv.Drive(history=[(0.001 * i, 0.1 + 0.01 * (i % 2)) for i in range(201)])
    )
    needed = kv.transient(scene, at=[0.2]).steps
    assert needed >= 200
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("kvtheory.models.continuum.solved_scene.STEP_LIMIT", 1)
        certificate = kv.transient(scene, at=[0.2]).certificate
        assert max(certificate.relative_error.values()) < 1e-3  # the second run came to the end too
    with pytest.raises(ArithmeticError, match="more than 100 steps"):
        kv.transient(scene, at=[0.2], max_steps=100)


@pytest.mark.parametrize(
    "given", [{"velocity": 0.1}, {"history": [(0.0, 0.1), (0.1, -0.2)]}, {"function": math.cos}]
)
def test_a_faster_drive_has_every_velocity_multiplied_whatever_it_is(given):
    drive = kv.Drive(**given)
    motion, faster = (each.motion(0.1, 1.0) for each in (drive, drive.faster(3.0)))
    assert faster.velocity(0.05) == pytest.approx(3.0 * motion.velocity(0.05), rel=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_ramp_down_to_rest_is_not_a_motion_backwards(sign):
    rng = np.random.default_rng(11)
    for start, length, speed in rng.uniform(0.01, 1.0, (200, 3)).tolist():
        points = [(0.0, sign * speed), (start, sign * speed), (start + length, 0.0)]
        motion = BaseMotion.from_points(points, end=3.0).scaled(0.7, 0.3)
        assert motion.forward(start + length) is motion.forward(motion.end) is (sign > 0.0)


def test_the_edges_keep_their_names_where_a_swing_turns():
    motion = BaseMotion.from_function(math.sin, end=10.0)
    assert [motion.forward(t) for t in (0.0, 1e-9, math.pi, 4.0, 2 * math.pi, 7.0)] == [
        True, True, True, False, False, True,
    ]  # fmt: skip
