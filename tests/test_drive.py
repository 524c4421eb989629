"""What follows from a drive alone; points of a history that say nothing change nothing anywhere."""

import dataclasses
import itertools
import math
import pickle
from functools import partial

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.static_state import StaticState
from tests.commands import printed

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


SUPPORT = 'kind = "dead-weight"\nmass = "1000.0 kg/m"'
FIXED = 'kind = "fixed"\ndepth = "0.3 mm"'
SPRING = 'stiffness = "1 MN/m^2"\ndamping = "2 kN*s/m^2"\nmass = "3 kg/mm"'
WAYS = {
    "velocity": 'velocity = "91 mm/s"',
    "history": 'history = [["0 s", "0 m/s"], ["1 s", "1 m/s"]]',
    "waveform": 'waveform = "sine"\namplitude = "0.1 m/s"\nfrequency = "5 Hz"',
    "smooth-ramp": 'waveform = "smooth-ramp"\nvelocity = "0.1 m/s"\nrise_time = "5 ms"',
    "file": 'file = "drive.csv"',
}


def scene_file(folder, drive, support=SUPPORT):
    (folder / "drive.csv").write_text("t [s],V [m/s]\n0,0\n1,1\n")
    path = folder / "scene.toml"
    text = kv.to_toml(kv.Scene()).replace('gravity = "9.80665 m/s^2"\n', "")
    path.write_text(text.replace('velocity = "0.1 m/s"', drive).replace(SUPPORT, support))
    return path


@pytest.mark.parametrize("way", WAYS)
def test_a_spring_goes_with_every_way_to_drive_and_comes_back_from_a_file(tmp_path, way):
    path = scene_file(tmp_path, f"{WAYS[way]}\n{SPRING}")
    drive = kv.load_scene(path).drive
    assert (drive.stiffness, drive.damping, drive.mass) == (1e6, 2e3, 3e3)
    assert not drive.rigid
    path.write_text(kv.to_toml(kv.load_scene(path)))
    assert kv.load_scene(path).drive == drive
    other = kv.load_scene(path, ["drive.velocity=1 m/s"])  # another way to drive keeps the spring
    assert (other.drive.stiffness, other.drive.mass) == (1e6, 3e3)
    assert drive.faster(2.0).stiffness == drive.changed(velocity=1.0).stiffness == 1e6


def test_a_function_takes_a_spring_and_the_mass_is_that_of_the_support():
    scene = kv.Scene(drive=kv.Drive(function=math.sin, stiffness="2 MN/m^2"))
    assert (scene.drive.damping, scene.drive.mass, scene.drive_mass) == (0.0, None, 1000.0)
    assert scene.values()["drive.stiffness"] == 2e6
    assert scene.values()["drive.mass"] == 1000.0
    moved = dataclasses.replace(scene, drive=scene.drive.changed(mass=5.0))
    assert moved.drive_mass == 5.0
    assert moved.drive.function is math.sin


def test_scene_prints_the_spring_and_its_numbers_and_of_a_rigid_drive_none():
    shown = printed("scene", "--set", "drive.stiffness=1 MN/m^2")
    assert (shown["drive_stiffness"], shown["drive_mass"], shown["mass"]) == (1e6, 1e3, 1e3)
    assert shown["drive_damping"] == 0.0
    assert shown["drive_stiffness_number"] > 0.0
    assert "stiffness" not in kv.to_toml(kv.Scene()).partition("[drive]")[2]
    assert not any(key in kv.Scene().values() for key in ("drive.stiffness", "drive.damping"))
    at_rest = StaticState.of(kv.Scene())
    assert at_rest.rigid_drive
    assert list(at_rest.named())[-3:] == ["drive_number", "inertia_number", "support_number"]


def test_scaled_numbers_are_those_of_the_motion_along_x():
    """eps_x x'' = f_x - c_x x' - kappa_x x is M_x d2x/dt2 = F_x - c dx/dt - k_x x in scaled form."""
    drive = kv.Drive(velocity=0.1, stiffness=1e6, damping=2e3, mass=3e3)
    scene = kv.Scene(drive=drive)
    own = StaticState.of(scene)
    K, R, tau, W = 1e10, 0.01, 0.1, 1000.0 * 9.80665
    a_0 = (1.5 * R * W / K) ** (1 / 3)
    force = W * (a_0**2 / (2 * R)) / a_0
    assert own.drive_stiffness_number == pytest.approx(1e6 * a_0 / force, rel=1e-14)
    assert own.drive_damping_number == pytest.approx(2e3 * (a_0 / tau) / force, rel=1e-14)
    assert own.drive_inertia_number == pytest.approx(3e3 * (a_0 / tau**2) / force, rel=1e-14)
    soon = kv.Foundation(K, 1e-5)
    with pytest.raises(ValueError, match="range of double precision"):
        StaticState.of(dataclasses.replace(scene, drive=drive.changed(mass=1e308), foundation=soon))


def test_mistakes_beside_a_spring_are_told_together(tmp_path):
    path = scene_file(tmp_path, f'{WAYS["velocity"]}\nstiffness = "1 MN/m^2"', FIXED)
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(path, ["run.duration=-1 s", "indenter.radius=0 m"])
    assert [text.split(" =")[0].split(":")[0] for text in caught.value.problems] == [
        "indenter.radius", "run.duration", "drive.mass",
    ]  # fmt: skip
    with pytest.raises(kv.SceneError) as caught:
        kv.Drive(damping=-1.0, mass="1 s", tolerance=2.0)
    keys = [text.split(" =")[0].split(":")[0] for text in caught.value.problems]
    assert keys == ["drive", *["drive.damping", "drive.mass"] * 2, "drive.tolerance"]


def test_springs_are_swept_and_steady_sliding_does_not_depend_on_them():
    scene = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6))
    over = {"drive.stiffness": [1e5, 1e7], "drive.mass": [1.0, 2.0], "drive.damping": [0.0, 3.0]}
    found = kv.sweep(scene, over=over, quantities="friction_force")["friction_force"]
    assert found.shape == (2, 2, 2)
    assert np.all(found == kv.steady().friction_force)
    assert kv.steady(over={"drive.stiffness": [1e5, 1e6]}).friction_force.shape == (2,)
    with pytest.raises(kv.SceneError, match=r"drive\.damping"):
        kv.sweep(over={"drive.damping": [0.0, 1.0]})


def test_solve_follows_a_spring():
    scene = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6), run=kv.Run(1e-3))
    assert kv.solve(scene, at="1 ms").model == "continuum"
    stiff = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e9))  # where steady sliding is stable
    assert kv.solve(stiff, quantity="friction_force").model == "exact"
