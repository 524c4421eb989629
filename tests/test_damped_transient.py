"""The transient on arms beside a damper (fact F33): values, both limits, balances, and elements."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum import solver
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.continuum.run import Spring
from kvtheory.results.table import scales
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.static_state import StaticState
from tests import SCENES, damped_elements
from tests.spring_random import of_unit_scales

RUBBER = kv.GeneralizedMaxwell(1e10, arms=[(2e10, 5e-3), (1e10, 0.2)], damping=5e8)
QUANTITIES = "depth", "depth_rate", "normal_force", "friction_force", "peak_pressure"


def history(points, end):
    return [*points, (end, points[-1][1])]


def test_the_values_of_two_other_programs():
    """Table 1, dead weight, from rest to 100 mm/s: depths to 1e-6, friction to 0.4 %."""
    scene = kv.Scene(foundation=RUBBER, drive=kv.Drive(0.1), run=kv.Run(0.15))
    found = kv.transient(scene, at=[2e-3, 0.02, 0.15], rtol=1e-6)
    assert found.depth == pytest.approx([0.289390e-3, 0.172051e-3, 0.117546e-3], rel=4e-6)
    assert found.friction_force == pytest.approx([1763.0, 1091.0, 800.0], rel=4e-3)
    assert found.certificate.relative_error["depth"] < 1e-6


@pytest.mark.parametrize(
    ("velocity", "end", "W", "F"),
    [(1e-3, 8.0, 9955.691, 214.8258), (0.03, 3.0, 19014.63, 1486.771)],
)
def test_it_ends_in_steady_sliding(velocity, end, W, F):
    scene = kv.Scene(
        foundation=RUBBER, support=kv.Fixed(3e-4), drive=kv.Drive(velocity), run=kv.Run(end)
    )
    found, steady = kv.transient(scene, at=[end], rtol=1e-5, certify=False), kv.steady(scene)
    assert found.normal_force[0] == pytest.approx(W, rel=1e-6)
    assert found.friction_force[0] == pytest.approx(F, rel=1e-6)
    for name in ("friction_force", "trailing_edge", "peak_pressure"):
        assert getattr(found, name)[0] == pytest.approx(getattr(steady, name), rel=1e-6)


CASES = {
    "start": ([(0.0, 4.0)], 0.04, 0.0, None),
    "stop, fixed": ([(0.0, 1.5), (1.0, 1.5), (1.0, 0.0)], 1.0, math.inf, None),
    "reversal": ([(0.0, 4.0), (0.5, 4.0), (0.5, -4.0)], 0.04, 0.5, None),
    "to and fro": ([(0.0, 0.0), (0.3, 3.0), (0.9, -3.0), (1.2, 0.0)], 0.5, 0.5, None),
    "spring": ([(0.0, 2.0), (0.9, 2.0), (0.9, 0.5)], 0.1, 0.0, Spring(0.5, 0.1, 3.0)),
    "hop": ([(0.0, 4.0), (0.4, 4.0), (0.4, 0.0)], 0.2, 0.0, None),
}


@pytest.mark.parametrize("name", CASES)
def test_without_arms_it_is_kelvin_voigt(name):
    """An edge, and each force, agree with the solver that has closed forms for both."""
    points, eps, kappa, spring = CASES[name]
    drive, end, rtol = BaseMotion.from_points(points, 1.5), 1.5, 1e-5
    truth = solver.solve(drive, eps, kappa, end, 1e-10, spring=spring)
    found = trajectory.solve(drive, [], (eps, kappa), end, rtol, damper=1.0, spring=spring)
    s = np.linspace(0.0, end, 31)[1:]
    here, there = found.states(s), truth.states(s)
    for quantity in (*QUANTITIES, "sliding_velocity", "edges"):
        expected = pytest.approx(there[quantity], abs=5.0 * rtol, nan_ok=True)
        assert here[quantity] == expected, quantity
    hops = [event for event in truth.events if event.kind in ("take-off", "landing")]
    assert bool(hops) == (name == "hop")


def test_a_weak_damper_changes_the_motion_in_proportion():
    points, arms = [(0.0, 3.0), (0.5, 3.0), (0.5, -1.0)], [(2.0, 0.1), (0.5, 1.0)]
    drive, s = BaseMotion.from_points(points, 1.0), np.array([0.1, 0.4, 0.6, 1.0])
    solved = [
        trajectory.solve(drive, arms, (0.1, 0.0), 1.0, 1e-7, damper=c).states(s)
        for c in (0.0, 1e-6, 1e-4)
    ]
    for name in ("depth", "normal_force", "friction_force"):
        none, weak, more = (each[name] for each in solved)
        assert np.abs(weak - none).max() < 1e-5
        assert np.abs(more - none) == pytest.approx(100.0 * np.abs(weak - none), rel=0.02, abs=1e-6)


@pytest.mark.parametrize("spring", [{}, {"stiffness": 2.0, "mass": 0.5, "damping": 0.1}])
@pytest.mark.parametrize("kappa", [0.0, math.inf])
def test_energy_is_kept(kappa, spring):
    """In jumps of the drive, and where an edge goes back over its ground."""
    points = [(0.0, 2.0), (0.5, 2.0), (0.5, -2.0)]
    drive = kv.Drive(history=history(points, 0.8), **spring)
    rubber = kv.GeneralizedMaxwell(0.75, arms=[(1.5, 0.05), (0.75, 1.0)], damping=0.3)
    scene = replace(of_unit_scales(0.2, kappa, drive, 0.8), foundation=rubber)
    found = kv.transient(scene, at=[0.8], rtol=1e-4, certify=False)
    books = found.energy([0.3, 0.5, 0.8])
    assert np.abs(books.balance).max() <= 1e-4 * (books.stored_at_rest + books.work).max()
    assert (np.diff(books.dissipated_contact) > 0.0).all()
    assert (np.diff(books.dissipated_surface) > 0.0).all()


def test_a_jump_of_the_drive_is_one_of_the_pressure():
    """The value at a jump is the one just after it; the depth has no jump, and no time passes."""
    points = [(0.0, 2.0), (0.5, 2.0), (0.5, 1.0)]
    scene = replace(
        of_unit_scales(0.2, 0.0, kv.Drive(history=history(points, 1.0)), 1.0),
        foundation=kv.GeneralizedMaxwell(0.75, arms=[(1.5, 0.05)], damping=0.75),
    )
    before, at, after = 0.5 - 1e-9, 0.5, 0.5 + 1e-9
    found = kv.transient(scene, at=[0.0, before, at, after], rtol=1e-6)
    assert found.velocity.tolist() == [2.0, 2.0, 1.0, 1.0]
    assert found.depth[1:] == pytest.approx([found.depth[2]] * 3, abs=1e-7)
    assert found.friction_force[2] == pytest.approx(found.friction_force[3], rel=1e-4)
    assert found.friction_force[2] < 0.7 * found.friction_force[1]
    assert found.friction_force[0] > 0.5
    assert np.diff(found.solution.natural_times).min() > 0.0


def random_case(seed):
    """Return a scene with up to three arms, starts, stops, reversals, springs, in every support."""
    rng = np.random.default_rng(seed)
    V, end = (
        float(rng.choice((-1, 1)) * 10.0 ** rng.uniform(-1.0, 0.8)),
        float(rng.uniform(0.5, 2.0)),
    )
    turns = np.sort(rng.uniform(0.1, 0.9, 2)) * end
    levels = [V, *(float(V * rng.choice((0.0, 0.5, -1.0, 1.5))) for _ in turns)]
    jumps = [(0.0, V)]
    for t, last, level in zip(turns.tolist(), levels, levels[1:], strict=False):
        jumps += [(t, last), (t, level)]
    spring = {}
    if seed % 4 == 3:
        spring = {"stiffness": 10.0 ** rng.uniform(-0.5, 1.0), "mass": 10.0 ** rng.uniform(-1, 0.5)}
    arms = [
        (float(10.0 ** rng.uniform(-1, 1)), float(10.0 ** rng.uniform(-1.5, 0.5)))
        for _ in range(rng.integers(1, 4))
    ]
    kappa = (0.0, 10.0 ** rng.uniform(-1, 1), math.inf)[seed % 3]
    drive = kv.Drive(history=history(jumps, end), **spring)
    damper = float(10.0 ** rng.uniform(-1.5, 0.3))
    rubber = kv.GeneralizedMaxwell(
        0.75, arms=[(0.75 * k, T) for k, T in arms], damping=0.75 * damper
    )
    eps = 10.0 ** rng.uniform(-1.5, 1.0)
    scene = replace(of_unit_scales(eps, kappa, drive, end), foundation=rubber)
    times = np.sort(rng.uniform(0.02, 1.0, 6)) * end
    along = (spring["mass"], 0.0, spring["stiffness"]) if spring else None
    return scene, (arms, damper, eps, kappa, times.tolist(), along)


@pytest.mark.parametrize("seed", range(0, max(SCENES // 50, 1), 2))
def test_elements_agree_within_both_errors(seed):
    scene, given = random_case(seed)
    found = kv.transient(scene, at=given[4], rtol=1e-4)
    drive, measures = scene.drive.motion(scene.run.duration, 1.0), scales(StaticState.of(scene))
    truth, errors = damped_elements.extrapolated(drive, *given, count=100, step=8e-3)
    for name, column, error in zip(QUANTITIES, truth.T, errors, strict=True):
        unit = 0.75 if name == "peak_pressure" else 1.0
        off = np.abs(getattr(found, name) - unit * column).max() / measures[name]
        claimed = found.certificate.relative_error[name]
        assert off <= claimed + unit * error / measures[name], name
        assert claimed < 0.02, name
