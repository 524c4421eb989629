"""`kv.stability` against Jacobians of equations written on their own: with many digits, of a ball by sums."""

import json
import re
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import kvtheory as kv
from tests import reference_stability as reference
from tests.commands import printed, run
from tests.conftest import digits

TABLE1 = {0.02: None, 0.039: 0.1722e6, 0.091: 6.879e6, 0.214: 101.95e6}
"""Critical stiffness in N/m^2 by velocity in m/s, to four digits (fact F22)."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(400)
"""Of the strips of a ball."""
STEP = 1e-3
SAME = 1e-3
"""Distance from a critical stiffness, relative to it, from which on both sides are told apart."""
_digits = digits(reference.DIGITS)


def scene_of(values):
    """Return a scene with these values in SI."""
    parts = {name: {} for name in ("indenter", "foundation", "support", "drive")}
    for key, value in values.items():
        section, name = key.split(".")
        parts[section][name] = value
    kind = kv.Suspended if "stiffness" in parts["support"] else kv.DeadWeight
    return kv.Scene(
        kv.Parabola(**parts["indenter"]), kv.Foundation(**parts["foundation"]),
        kind(**parts["support"]), kv.Drive(**parts["drive"]),
    )  # fmt: skip


def random_arrays(count, seed, decades):
    scenes = list(reference.random_scenes(count, seed, decades))
    scenes = [each for each in scenes if "support.stiffness" in each]
    arrays = {key: np.array([each[key] for each in scenes]) for key in scenes[0]}
    return scene_of(scenes[0]), arrays


@pytest.mark.parametrize(("velocity", "stiffness"), TABLE1.items())
def test_critical_stiffness_of_table_1(velocity, stiffness):
    found = kv.stability(kv.Scene(drive=kv.Drive(velocity=velocity, stiffness=1e5)))
    if stiffness is None:
        assert np.isnan(found.critical_stiffness)
        assert found.stable
    else:
        assert found.critical_stiffness == pytest.approx(stiffness, rel=5e-4)
        assert found.lower_critical_stiffness == 0.0
        assert not found.stable


@pytest.mark.parametrize(("decades", "seed"), [(0.5, 1), (1.5, 2), (3.0, 3)])
def test_everything_agrees_with_the_equations_of_motion_and_errors_cover(decades, seed):
    unstable = 0
    for values in reference.random_scenes(15, seed, decades):
        numbers = reference.scaled(values)
        along, tau = numbers.pop("along"), mp.mpf(values["foundation.retardation_time"])
        found = kv.stability(scene_of(values), quantity=["stable", "rates", "critical_stiffness"])
        errors = found.certificate.relative_error
        guess = kv.steady(scene_of(values)).depth / mp.mpf(
            kv.steady(scene_of(values), over={"drive.velocity": 0.0}).depth
        )
        truth = reference.critical(numbers, guess)
        assert (truth is None) == np.isnan(found.critical_stiffness), values
        if truth is not None:
            unstable += 1
            for name, true in (
                ("critical_stiffness", truth[0] / along),
                ("frequency", truth[1] / (2 * mp.pi * tau)),
            ):
                wrong = abs(mp.mpf(getattr(found, name)) - true) / true
                assert wrong <= errors[name], (values, name, wrong)
        true = mp.polyroots(reference.quartic(**numbers, guess=guess), maxsteps=500, extraprec=400)
        ours = [mp.mpc(*pair) * tau for pair in found.rates.tolist()]
        for rate, error in zip(ours, errors["rates"], strict=True):
            nearest = min(true, key=lambda each: abs(each - rate))
            assert abs(rate - nearest) <= error * abs(nearest), (values, rate)
        assert found.stable == (max(each.real for each in true) < 0), values
    assert 3 <= unstable < 15


@pytest.mark.parametrize("decades", [1.0, 4.0])
def test_the_critical_stiffness_is_where_computed_rates_change_sign(decades):
    """Routh and Hurwitz against roots, on thousands of scenes."""
    scene, arrays = random_arrays(3000, 7, decades)
    first = kv.stability(scene, over=arrays, quantity="critical_stiffness")
    some = ~np.isnan(first.critical_stiffness)
    assert 0.1 < some.mean() < 0.95
    sure = first.certificate.relative_error["critical_stiffness"] < 1e-2 * SAME
    for side in (1.0 - SAME, 1.0 + SAME):
        stiffness = np.where(some, side * first.critical_stiffness, arrays["drive.stiffness"])
        found = kv.stability(scene, over={**arrays, "drive.stiffness": stiffness}, quantity="rates")
        inside = some & (side < 1.0) & (stiffness > first.lower_critical_stiffness)
        clear = sure | ~some
        assert np.array_equal(found.stable[clear], ~inside[clear])
        growth = found.rates[..., 0, 0]
        error = found.certificate.relative_error["rates"][..., 0]
        known = clear & (np.abs(growth) > error * np.hypot(*found.rates[..., 0, :].T))
        assert known.mean() > 0.95
        assert np.array_equal((growth < 0.0)[known], found.stable[known])


def test_heavy_indenters_flutter_where_friction_rises():
    heavy = kv.Scene(
        support=kv.DeadWeight(mass="1e9 kg/m", load="9.8 N/mm"), drive=kv.Drive(velocity="10 mm/s")
    )
    band = kv.stability(heavy, quantity="critical_stiffness")
    low, high = band.lower_critical_stiffness, band.critical_stiffness
    assert 0.0 < low < high
    for stiffness, stable in ((0.99 * low, True), ((low + high) / 2, False), (1.01 * high, True)):
        found = kv.stability(heavy, over={"drive.stiffness": stiffness})
        assert found.stable == stable
        assert (found.rates[0, 0] < 0.0) == stable
    light = kv.stability(heavy, over={"support.mass": 1e3}, quantity="critical_stiffness")
    assert np.isnan(light.critical_stiffness)


def ball_forces(depth, rate, velocity):
    """W and F of a ball with R = 1/2, K = tau = 1, from the pressure d + d' - x^2 - 2 V x in each strip."""
    t, w = 0.25 * np.pi * (NODES + 1.0), 0.25 * np.pi * WEIGHTS
    half = np.sqrt(depth) * np.cos(t)
    level = half**2 + rate
    right = np.sqrt(level + velocity**2) - velocity
    sums = [right**n / n - (-half) ** n / n for n in range(1, 5)]
    strips = 2.0 * half * w
    load = level * sums[0] - sums[2] - 2.0 * velocity * sums[1]
    push = level * sums[1] - sums[3] - 2.0 * velocity * sums[2]
    return np.array([load @ strips, -2.0 * push @ strips])  # h' = 2 x


def polynomial(at, mass, mass_along, spring, damper, spring_along):
    """Return the coefficients of the quartic, from the highest on."""
    slopes = []
    for which in range(3):
        total = 0.0
        for factor, steps in ((-1.0, 2.0), (8.0, 1.0)):
            for side in (1.0, -1.0):
                moved = list(at)
                moved[which] += side * steps * STEP * at[0]
                total = total + side * factor * ball_forces(*moved)
        slopes.append(total / (12.0 * STEP * at[0]))
    (z_d, x_d), (z_r, x_r), (z_v, x_v) = slopes
    across = [mass, z_r, z_d + spring]
    along = [mass_along, x_v + damper, spring_along]
    return np.polysub(np.polymul(across, along), [z_v * x_r, z_v * x_d, 0.0])


def ball_scene(velocity, mass, spring, mass_along, damper, spring_along, across=0.5):
    """Return the scene of weight 1 in these units."""
    support = kv.DeadWeight(mass, 1.0 / mass)
    if spring:
        support = kv.Suspended(mass, spring, 1.0 / mass)
    drive = kv.Drive(velocity, stiffness=spring_along, damping=damper, mass=mass_along)
    return kv.Scene(kv.Sphere(0.5, across), kv.Foundation(1.0, 1.0), support, drive)


@pytest.mark.parametrize("seed", range(8))
def test_rates_of_a_ball_are_those_of_a_numerical_jacobian(seed):
    rng = np.random.default_rng(seed)
    velocity, *masses, spring_along = 10.0 ** rng.uniform([-1.5, -2, -2, -2], [1.5, 1, 1, 1])
    given = masses[0], rng.choice([0.0, 0.3]), masses[1], rng.choice([0.0, 0.2])
    scene = ball_scene(velocity, *given, spring_along)
    found, steady = kv.stability(scene), kv.steady(scene)
    at = steady.depth, 0.0, velocity
    assert ball_forces(*at)[0] == pytest.approx(steady.load, rel=1e-9)
    exact = np.roots(polynomial(at, *given[::2], *given[1::2], spring_along))
    rates = found.rates @ [1.0, 1.0j]
    assert np.sort_complex(rates) == pytest.approx(np.sort_complex(exact), rel=1e-5, abs=1e-6)
    assert bool(found.stable) == bool((exact.real < 0.0).all()) == bool(steady.stable)
    if not np.isnan(found.critical_stiffness):  # there small motions neither grow nor decay
        edge = np.roots(polynomial(at, *given[::2], *given[1::2], found.critical_stiffness))
        fastest = max(edge, key=lambda rate: rate.real)
        assert abs(fastest.real) < 1e-6 * abs(fastest)
        assert abs(fastest.imag) == pytest.approx(2.0 * np.pi * found.frequency, rel=1e-6)


def test_a_wider_ball_needs_as_many_times_the_stiffness():
    wide = kv.stability(ball_scene(5.0, 0.02, 0.0, 0.6, 0.0, 2e-3, across=2.0))
    narrow = replace(ball_scene(5.0, 0.01, 0.0, 0.3, 0.0, 1e-3), support=kv.DeadWeight(0.01, 50.0))
    half = kv.stability(narrow).critical_stiffness
    assert wide.critical_stiffness == pytest.approx(2.0 * half, rel=1e-12)


@pytest.mark.parametrize("ball", [False, True])
def test_a_soft_spring_meets_the_friction_maximum(ball):
    """Theorem F3 at its velocity: a dead weight on the softest spring is unstable beyond it alone."""
    scene = ball_scene(1.0, 0.01, 0.0, 0.3, 0.0, 1e-9) if ball else kv.Scene()
    peak, near = kv.asymptotes(scene).peak_velocity, 1e-7 if ball else 1e-9
    speeds = {"drive.velocity": [(1 - near) * peak, (1 + near) * peak]}
    found = kv.stability(scene, over=speeds | {"drive.stiffness": 1e-9 if ball else 1e-3})
    assert found.stable.tolist() == [True, False]
    assert found.critical_velocity == pytest.approx(peak, rel=1e-6)


@pytest.mark.parametrize("support", ["dead-weight", "suspended", "ball"])
def test_the_critical_velocity_is_where_the_stiffness_is_critical(support):
    ball = support == "ball"
    scene = ball_scene(1.0, 0.01, 0.0, 0.3, 0.0, 1.0) if ball else kv.Scene.table1(support)
    springs = {"drive.stiffness": np.geomspace(*((1e-3, 1.0) if ball else (1e4, 1e12)), 9)}
    found = kv.stability(scene, over=springs, quantity="critical_velocity")
    speeds = found.critical_velocity
    assert np.all(np.diff(speeds) > 0.0)
    there = kv.stability(scene, over={**springs, "drive.velocity": speeds})
    error = found.certificate.relative_error["critical_velocity"]
    assert np.all(error < 1e-11)
    assert there.critical_stiffness == pytest.approx(springs["drive.stiffness"], rel=1e-9)
    for factor, stable in ((1 - 1e-9, True), (1 + 1e-9, False)):
        near = kv.stability(
            scene, over={**springs, "drive.velocity": factor * speeds}, quantity="stable"
        )
        assert np.all(near.stable == stable)
    spring = springs["drive.stiffness"][2]
    below = {"drive.stiffness": spring, "drive.velocity": speeds[2] * np.geomspace(1e-5, 10, 2000)}
    slow = kv.stability(scene, over=below, quantity="stable").stable
    assert np.array_equal(slow, below["drive.velocity"] < speeds[2])


def test_a_damper_leaves_a_window_of_velocities():
    damped = kv.Drive(velocity=0.1, stiffness=1e4, damping=1e3, mass=1000.0)
    scene = kv.Scene(drive=damped)
    found = kv.stability(
        scene, over={"drive.velocity": np.geomspace(1e-3, 1e3, 601)}, quantity="stable"
    )
    changes = np.flatnonzero(np.diff(found.stable.astype(int)))
    assert changes.size == 2
    first = np.geomspace(1e-3, 1e3, 601)[changes[0] : changes[0] + 2]
    assert first[0] < kv.stability(scene).critical_velocity < first[1]
    stiff = kv.stability(scene, over={"drive.damping": 1e6})
    assert np.isnan(stiff.critical_velocity)
    assert stiff.stable


def test_a_fixed_indenter_is_always_stable():
    drive = kv.Drive(velocity=0.1, stiffness=1e3, mass=1000.0)
    scene = kv.Scene(support=kv.Fixed(depth=3e-4), drive=drive)
    found = kv.stability(scene, over={"drive.velocity": [0.0, 1e-3, 1.0, -1e3]})
    assert found.stable.all()
    assert found.rates.shape == (4, 2, 2)
    assert (found.rates[..., 0] < 0.0).all()
    assert np.isnan(found.critical_stiffness).all()
    ball = kv.stability(replace(scene, indenter=kv.Sphere(0.01)))
    assert ball.stable
    assert ball.rates.shape == (2, 2)
    rigid = kv.stability(kv.Scene.table1("fixed"))
    assert rigid.stable
    assert rigid.rates.size == 0
    with pytest.raises(kv.SceneError, match=r"drive\.mass: missing"):
        kv.stability(kv.Scene.table1("fixed"), over={"drive.stiffness": 1e6})


def test_a_rigid_drive_has_the_two_time_constants_of_f12():
    found = kv.stability()
    assert found.rigid_drive
    assert found.time_constants * 1e3 == pytest.approx([11.75, 0.7444], rel=5e-4)
    stiff = kv.stability(over={"drive.stiffness": 1e16})
    near = np.isclose(stiff.time_constants[:, np.newaxis], found.time_constants, rtol=1e-3)
    assert near.any(axis=0).all()


def test_what_a_light_indenter_and_a_reversed_drive_do():
    light = {"support.mass": [1e-12, 1e-9], "drive.stiffness": 1e6}
    scene = kv.Scene(support=kv.DeadWeight(mass=1.0, load="9.8 N/mm"),
                     drive=kv.Drive(velocity=0.1, stiffness=1e6, mass=1000.0))  # fmt: skip
    found = kv.stability(scene, over=light, quantity="critical_stiffness")
    assert found.critical_stiffness[0] == pytest.approx(found.critical_stiffness[1], rel=1e-9)
    there, back = (
        kv.stability(over={"drive.velocity": V, "drive.stiffness": 1e6}) for V in (0.1, -0.1)
    )
    assert there.critical_stiffness == back.critical_stiffness
    assert np.array_equal(there.rates, back.rates)


def test_arrays_broadcast_and_give_what_single_scenes_give():
    over = {"drive.velocity": np.array([[0.02], [0.091]]), "drive.stiffness": [1e4, 1e7, 1e9]}
    found = kv.stability(over=over)
    assert found.stable.shape == found.critical_velocity.shape == (2, 3)
    assert found.rates.shape == (2, 3, 4, 2)
    assert found.stable.tolist() == [[True] * 3, [False, True, True]]
    single = kv.stability(over={"drive.velocity": 0.091, "drive.stiffness": 1e7})
    assert found.rates[1, 1] == pytest.approx(single.rates, rel=1e-12)
    assert found.critical_stiffness[1, 1] == pytest.approx(single.critical_stiffness, rel=1e-14)
    assert kv.stability(over={"drive.velocity": []}, quantity="stable").stable.shape == (0,)


@pytest.mark.parametrize("support", ["dead-weight", "suspended", "fixed"])
def test_extremes_give_numbers_without_a_warning(support):
    scene = kv.Scene(support=kv.Scene.table1(support).support,
                     drive=kv.Drive(velocity=0.1, stiffness=1e6, mass=1e3))  # fmt: skip
    for key in ("drive.velocity", "drive.stiffness", "drive.mass", "foundation.retardation_time"):
        base = scene.values()[key]
        found = kv.stability(scene, over={key: base * 10.0 ** np.arange(-10.0, 11.0)})
        assert np.isfinite(found.rates).all()
        assert not np.isnan(found.certificate.relative_error["rates"]).any()


def test_the_command_prints_a_table_and_json():
    command = ["stability", "--set", "drive.velocity=91 mm/s", "--set", "drive.stiffness=1 MN/m^2"]
    told = run(*command).stdout
    assert "unstable, below the critical stiffness" in told  # the lower one is 0
    assert re.search(r"velocity at the onset of instability +53\.6258 +mm/s", told)
    assert "critical velocity" not in run("asymptotes").stdout
    assert re.search(r"critical_stiffness +6\.87857 +MN/m\^2", told)
    assert re.search(r"frequency +12\.9277 +Hz", told)
    record = printed(*command)
    assert record["critical_stiffness"] == pytest.approx(6.879e6, rel=1e-3)
    assert len(record["rates"]) == len(record["time_constants"]) == 4
    assert record["stable"] is False
    rigid = printed("stability")
    assert rigid["rigid_drive"]
    assert rigid["critical_velocity"] is None
    ball = ["stability", "--set", "indenter.shape=sphere", "--set", "support.mass=1 kg"]
    told = run(*ball).stdout
    assert "N/mm " in told
    assert "N/m^2" not in told
    steady = run("steady", *command[1:]).stdout.splitlines()
    assert steady[-1].startswith("Steady sliding is unstable")
    record = printed("steady", *command[1:])
    assert record["stable"] is False


def test_a_pair_of_rates_is_one_motion_in_files_and_pictures(tmp_path):
    path, picture = tmp_path / "rates.csv", tmp_path / "rates.png"
    soft = ["stability", "--set", "drive.stiffness=1 MN/m^2", "-o", path, "--plot", picture]
    run(*soft, "--set", "drive.velocity=91 mm/s")
    assert picture.stat().st_size > 5000
    whole = kv.stability(over={"drive.velocity": 0.091, "drive.stiffness": 1e6})
    (row,) = np.genfromtxt(path, delimiter=",", names=True, ndmin=1)
    assert row["growth_rate_1s"] == whole.growth_rate == whole.rates[0, 0]
    assert row["growth_frequency_Hz"] == abs(whole.rates[0, 1]) / (2.0 * np.pi) > 4.0
    assert [row[f"growth_rate_{i}_1s"] for i in (2, 3)] == whole.rates[2:, 0].tolist()
    assert "growth_rate_4 [1/s]" not in path.read_text()  # of the pair
    told = run(*soft, "--set", "drive.velocity=10 mm/s:100 mm/s:3").stdout  # replaces its own files
    several = np.genfromtxt(path, delimiter=",", names=True)
    assert (
        several["stable_1"].tolist()
        == (several["growth_rate_1s"] < 0.0).tolist()
        == [True, False, False]
    )
    assert several["drivevelocity_ms"] == pytest.approx([0.01, 0.055, 0.1])
    assert f"{several['growth_rate_1s'][2]:.6g}" in told
    some = kv.stability(over={"drive.velocity": [0.01, 0.1], "drive.stiffness": 1e6})
    upper, lower = some.plot().axes
    assert upper.lines[0].get_ydata() == pytest.approx(some.growth_rate)
    assert lower.lines[0].get_ydata() == pytest.approx(some.growth_frequency)
    table = kv.stability(over={"drive.velocity": [[0.01, 0.1], [0.2, 0.3]], "drive.stiffness": 1e6})
    with pytest.raises(ValueError, match=r"drive\.velocity form a table, not a list; draw one row"):
        table.plot()
    with pytest.raises(ValueError, match="there are no rates to draw"):
        kv.stability(quantity="stable").plot()


def test_steady_and_solve_say_when_steady_sliding_does_not_happen():
    soft = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6))
    state = kv.steady(soft)
    assert state.stable is False
    assert "unstable" in repr(state).splitlines()[-1]
    assert json.loads(json.dumps(state.as_dict()))["stable"] is False
    assert kv.steady().stable is True
    assert kv.steady().unstable == ""
    several = kv.steady(over={"drive.stiffness": [1e6, 1e9]})
    assert several.stable.tolist() == [False, True]
    assert "1 of 2 scenes" in several.unstable
    circle = kv.steady(kv.Scene(indenter=kv.Circle(radius=0.01), drive=soft.drive))
    assert circle.stable is None
    assert "known only for a parabola" in circle.unstable
    sweep = kv.sweep(soft, over={"drive.stiffness": [1e6, 1e9]})
    assert sweep["stable"].tolist() == [0.0, 1.0]
    with pytest.raises(kv.ToleranceError, match="unstable on the spring"):
        kv.solve(soft, quantity="load")
    stiff = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e9))
    assert kv.solve(stiff, quantity="load").load == pytest.approx(9806.65)
