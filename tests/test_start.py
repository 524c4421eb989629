"""Motions that do not start at rest: drops, releases, coasting, drawn springs, and restitution (F32)."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.checks.trial_elements import Rule, simulate
from kvtheory.models.continuum import solver
from kvtheory.models.continuum.prony import records, trajectory
from kvtheory.models.continuum.run import Beginning, Spring
from kvtheory.results.table import scales
from kvtheory.scene.base_motion import END, START, BaseMotion
from kvtheory.scene.static_state import StaticState
from kvtheory.theory.drop import drop, number_of
from tests import start_elements

WEIGHT = kv.DeadWeight(mass=1000.0)
ARMS = kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)])
BOTH = kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)], damping=5e8)


def dropped(**changes):
    """Return a scene with a line, almost without weight, that lands at 1 m/s."""
    given = {
        "foundation": kv.Foundation(1e10, 2e-5), "support": kv.DeadWeight(mass=1.0, load=1e-3),
        "drive": kv.Drive(0.0), "run": kv.Run(2e-3), "start": kv.Start(gap=1e-4, depth_rate=1.0),
    }  # fmt: skip
    return kv.Scene(**{**given, **changes})


@pytest.mark.parametrize(
    ("kind", "seed"), [*zip(start_elements.KINDS, range(1200, 1205), strict=True)]
)
def test_starts_agree_with_an_independent_program(kind, seed):
    """The seeds draw all laws; run the module itself for more of them."""
    ratio, _ = start_elements.compared(kind, seed)
    assert ratio.max() < 1.0


STARTS = {
    "release": ((0.5, 2.0, 0.0), None), "thrown off": ((3.0, -8.0, 0.0), None),
    "drop": ((-1.0, 3.0, 0.0), None), "thrown up": ((0.0, -2.0, 0.0), None),
    "laid down": ((0.0, 0.0, 0.0), None), "oblique": ((-1.0, 2.0, 2.0), Spring(1.0, 0.0, 0.0)),
    "drawn": ((1.0, 0.0, 4.0), Spring(1.0, 0.1, 2.0)),
}  # fmt: skip


@pytest.mark.parametrize("name", STARTS)
def test_both_solvers_agree_and_the_energy_of_the_start_is_in_the_ledger(name):
    (start, spring), drive, end = STARTS[name], BaseMotion.constant(4.0, end=2.0), 2.0
    how = {"spring": spring, "start": Beginning(*start)}
    one = solver.solve(drive, 0.4, 0.5, end, 1e-8, **how)
    two = trajectory.solve(drive, [], (0.4, 0.5), end, 1e-8, damper=1.0, **how)
    times = np.linspace(0.0, end, 11)
    for quantity in ("depth", "normal_force", "friction_force", "sliding_velocity"):
        apart = one.states(times)[quantity] - two.states(times)[quantity]
        assert np.abs(apart).max() < 2e-5 * (1.0 + np.abs(one.states(times)[quantity]).max())
    for motion in (one, two):
        books = motion.ledger(times)
        given = books.stored_at_rest + books.of_start
        assert np.abs(books.balance).max() < 1e-6 * (np.abs(given) + np.abs(books.work)).max()
        found = motion.impulses(times)
        assert np.abs(found.balance).max() < 1e-6 * (1.0 + np.abs(found.momentum).max())
        assert found.of_start[-1] == 0.4 * start[1]
        first = motion.states([0.0])[0]
        assert (first["depth"], first["depth_rate"]) == pytest.approx(start[:2], abs=1e-12)
        assert first["sliding_velocity"] == pytest.approx(4.0 - start[2], abs=1e-12)


def test_a_start_at_rest_by_its_numbers_is_that_without_a_start():
    scene = kv.Scene(run=kv.Run(0.02))
    told = replace(scene, start=kv.Start(depth=StaticState.of(scene).depth, depth_rate=0.0))
    at = [0.0, 1e-3, 0.02]
    one, two = (kv.transient(each, at=at, certify=False) for each in (scene, told))
    assert np.array_equal(one.depth, two.depth)
    assert np.array_equal(one.friction_force, two.friction_force)


def test_the_force_just_after_a_start_at_another_depth():
    """F11 with the edges of this depth: W_0 (d^(3/2) + (3/2) d^(1/2) d') while both edges touch."""
    scene = kv.Scene(drive=kv.Drive(0.0), start=kv.Start(depth="0.2 mm", depth_rate="1 mm/s"))
    rest, tau = StaticState.of(scene), scene.foundation.retardation_time
    d, rate = 2e-4 / rest.depth, 1e-3 * tau / rest.depth
    found = kv.transient(scene, at=[0.0], certify=False)
    assert found.normal_force[0] == pytest.approx(rest.load * (d**1.5 + 1.5 * math.sqrt(d) * rate))
    assert found.leading_edge[0] == pytest.approx(-math.sqrt(2.0 * 0.01 * 2e-4))


@pytest.mark.parametrize("law", [kv.Foundation(1e10, 0.05), ARMS, BOTH])
@pytest.mark.parametrize(
    ("start", "drive"),
    [
        (kv.Start(gap="0.2 mm"), kv.Drive(0.1)),
        (kv.Start(sliding_velocity=0.0), kv.Drive(0.1, stiffness=1e6)),
        (kv.Start(), kv.Drive(0.05, stiffness=0.0)),
    ],
)
def test_elements_and_solver_agree_within_their_certificates(law, start, drive):
    scene = kv.Scene(foundation=law, support=WEIGHT, drive=drive, start=start, run=kv.Run(0.02))
    at = np.linspace(0.0, 0.02, 9)[1:]
    one, two = kv.transient(scene, at=at), kv.elements(scene, at=at, per_length="100 /mm")
    unit = scales(StaticState.of(scene))
    for name in ("depth", "depth_rate", "normal_force", "friction_force"):
        apart = np.abs(getattr(one, name) - getattr(two, name)).max() / unit[name]
        allowed = one.certificate.relative_error[name] + two.certificate.relative_error[name]
        assert apart <= allowed, name


def test_a_ball_falls_by_elements_and_an_impact_has_the_restitution_of_the_closed_form():
    ball = kv.Scene(
        kv.Sphere(0.01), kv.Foundation(1e10, 1e-4), kv.DeadWeight(mass=0.03, load=0.01),
        kv.Drive(0.0), kv.Run(2.5e-3), kv.Start(gap=1e-4, depth_rate=0.5),
    )  # fmt: skip
    known = kv.restitution(ball, speed=0.5)
    run = kv.elements(ball, per_length="25 /mm", time_step="5 us", certify=False)
    assert run.restitution == pytest.approx(known.restitution, rel=1e-2)
    assert run.contact_time == pytest.approx(known.contact_time, rel=2e-2)
    assert run.depth.max() == pytest.approx(known.peak_depth, rel=1e-2)


@pytest.mark.parametrize(
    ("eta", "line", "ball"),
    [(0.05, 0.9101172, 0.9108869), (0.2, 0.7067313, 0.7129687), (1.0, 0.2808203, 0.3053201)],
)
def test_restitution_is_that_of_the_derivation(eta, line, ball):
    assert drop(eta, line=True).restitution == pytest.approx(line, abs=6e-8)
    assert drop(eta, line=False).restitution == pytest.approx(ball, abs=6e-8)


def test_restitution_tends_to_its_series_and_its_inverse_returns_eta():
    for line, first, second in ((True, 1.941177, 3.083547), (False, 1.937184, 3.360324)):
        lost = 1.0 - drop(1e-3, line=line).restitution
        assert lost == pytest.approx(first * 1e-3 - second * 1e-6, rel=1e-5)
        for eta in (1e-4, 0.3, 20.0):
            assert number_of(drop(eta, line=line).restitution, line=line) == pytest.approx(
                eta, rel=1e-6
            )
    with pytest.raises(ValueError, match="expected a restitution"):
        number_of(1.0, line=True)


@pytest.mark.parametrize("tau", [1e-6, 2e-5, 1e-3])
def test_the_closed_form_of_a_drop_is_the_transient_without_weight(tau):
    scene = dropped(foundation=kv.Foundation(1e10, tau))
    known, found = kv.restitution(scene), kv.transient(scene, rtol=1e-8)
    assert found.restitution == pytest.approx(known.restitution, rel=1e-5)
    assert found.contact_time == pytest.approx(known.contact_time, rel=1e-5)
    assert found.depth.max() == pytest.approx(known.peak_depth, rel=1e-3)


def test_a_damper_beside_weak_arms_has_the_restitution_of_the_damper_alone():
    law = kv.GeneralizedMaxwell(1e10, arms=[(1e2, 1e-3)], damping=1e10 * 2e-5)
    known, found = kv.restitution(dropped()), kv.transient(dropped(foundation=law), certify=False)
    assert found.restitution == pytest.approx(known.restitution, rel=1e-4)


@pytest.mark.parametrize(
    ("indenter", "support"),
    [
        (kv.Parabola(0.01), kv.DeadWeight(mass=30.0)),
        (kv.Sphere(0.01, 0.02), kv.DeadWeight(mass=0.03)),
    ],
)
def test_foundations_have_the_drop_and_the_mode_that_they_were_made_for(indenter, support):
    scene = kv.Scene(indenter, support=support, drive=kv.Drive(0.0))
    wanted = {"restitution": 0.6, "contact_time": 2e-3}
    made = kv.foundation_of_drop(scene, speed=1.0, **wanted)
    found = kv.restitution(replace(scene, foundation=made), speed=1.0)
    assert {name: getattr(found, name) for name in wanted} == pytest.approx(wanted, rel=1e-6)
    made = kv.foundation_of_mode(scene, frequency=400.0, damping_ratio=0.3)
    rates = kv.stability(replace(scene, foundation=made)).rates
    assert rates[:, 0] == pytest.approx([-120.0, -120.0], rel=1e-9)
    assert np.abs(rates[:, 1]) == pytest.approx([400.0 * math.sqrt(0.91)] * 2, rel=1e-9)


def test_a_coasting_indenter_stops_as_its_momentum_says():
    """Friction of slow sliding is W V tau/R (Eq. 42): the rest decays with M_x R/(W tau)."""
    drive = kv.Drive(1e-4, stiffness=0.0, mass=1000.0)
    scene = kv.Scene(foundation=kv.Foundation(1e10, 0.02), drive=drive, run=kv.Run(0.6))
    found = kv.transient(scene, rtol=1e-8)
    decay = 1000.0 * 0.01 / (WEIGHT.weight * 0.02)
    assert found.stopping_time == pytest.approx(decay * math.log(100.0), rel=0.02)
    assert found.stopping_distance == pytest.approx(0.99e-4 * decay, rel=0.02)
    assert np.all(found.spring_force == 0.0)
    assert kv.transient(kv.Scene(run=kv.Run(1e-3))).stopping_time is None


def test_elements_coast_as_far():
    scene = kv.Scene(
        foundation=kv.Foundation(1e10, 0.02), drive=kv.Drive(0.05, stiffness=0.0), run=kv.Run(0.4)
    )
    found = kv.transient(scene)
    run = kv.elements(scene, per_length="50 /mm", certify=False)
    assert run.stopping_time == pytest.approx(found.stopping_time, rel=3e-3)
    assert run.stopping_distance == pytest.approx(found.stopping_distance, rel=3e-3)
    brief = replace(scene, run=kv.Run(0.01))
    assert kv.elements(brief, per_length="50 /mm", certify=False).stopping_time is None


def test_which_end_of_the_spring_is_drawn():
    """Constant friction would differ as much: the spring is loaded from zero where its far end is drawn."""
    drive = kv.Drive("10 mm/s", stiffness="3 MN/m^2")
    based = kv.transient(kv.Scene(drive=drive), at=[0.0, 1e-3], certify=False)
    drawn = kv.transient(
        kv.Scene(drive=drive, start=kv.Start(sliding_velocity=0.0)), at=[0.0, 1e-3], certify=False
    )
    assert based.sliding_velocity[0] == 0.01
    assert drawn.sliding_velocity[0] == 0.0
    assert drawn.spring_force[1] > 10.0 * abs(based.spring_force[1])


def test_a_sweep_over_gaps_has_the_values_of_single_motions():
    scene = dropped()
    names = ["restitution", "contact_time", "depth.max", "hops", "stopping_time"]
    table = kv.sweep(scene, over={"start.gap": [1e-4, 1e-3]}, quantities=names)
    one = kv.transient(scene.replace({"start.gap": 1e-3}))
    assert table["restitution"][1] == pytest.approx(one.restitution, rel=1e-6)
    assert table["contact_time"][1] == pytest.approx(one.contact_time, rel=1e-6)
    assert np.isnan(table["stopping_time"]).all()


def test_solve_and_compare_know_the_start():
    scene = kv.Scene(start=kv.Start(gap="0.1 mm"), run=kv.Run(0.03))
    solved = kv.solve(scene, at=[0.01, 0.03], rtol=1e-3)
    assert solved.model == "continuum"
    assert solved.depth == pytest.approx(kv.transient(scene, at=[0.01, 0.03]).depth, rel=1e-3)
    held = kv.Scene(support=kv.Fixed(3e-4), drive=kv.Drive(0.1, stiffness=1e6, mass=10.0))
    started = replace(held, start=kv.Start(sliding_velocity=0.0), run=kv.Run(1e-3))
    assert kv.solve(started, at=[1e-4], quantity="depth").model == "continuum"
    assert kv.compare(scene).verdict == "agrees"
    rest = kv.compare(replace(scene, start=kv.Start()), data=kv.transient(scene))
    assert rest.verdict == "disagrees"


def test_solve_returns_what_a_drop_or_coasting_is_asked_for():
    scene = kv.problem("drop")
    found = kv.solve(scene, quantity=["restitution", "contact_time"], rtol=1e-4)
    known = kv.transient(scene, rtol=1e-9, certify=False)
    for name in ("restitution", "contact_time"):
        error = found.certificate.relative_error[name]
        assert error <= 1e-4
        assert found.values[name] == pytest.approx(getattr(known, name), rel=error)
    with pytest.raises(kv.ToleranceError, match=r"there is no stopping_time within run\.duration"):
        kv.solve(scene, quantity="stopping_time")
    coasting = kv.solve(kv.problem("coasting"), quantity=["stopping_time", "stopping_distance"])
    assert coasting.stopping_time == pytest.approx(0.11470373, rel=2e-4)
    with pytest.raises(ValueError, match="is of a whole motion"):
        kv.solve(scene, quantity=["restitution", "depth"])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"start": {"gap": -1e-3}}, "start.gap = -0.001: is out of range"),
        (
            {"start": {"gap": 1e-3, "depth": 1e-4}},
            "start.gap = 0.001: cannot be given beside start.depth",
        ),
        ({"start": {"depth": 0.0}}, "start.depth = 0.0: is out of range"),
        ({"start": {"gap": 1e-3}, "support": kv.Fixed(1e-4)}, "which holds the depth"),
        ({"start": {"sliding_velocity": 0.0}}, "needs drive.stiffness"),
    ],
)
def test_a_wrong_start_costs_one_clear_message(parts, message):
    with pytest.raises(kv.SceneError) as caught:
        kv.Scene(**{**parts, "start": kv.Start(**parts["start"])})
    (problem,) = caught.value.problems
    assert message in problem


def test_a_coasting_indenter_has_no_steady_state_to_be_stable():
    scene = kv.Scene(drive=kv.Drive(0.1, stiffness=0.0))
    with pytest.raises(ValueError, match="coasts to rest"):
        kv.stability(scene)
    with pytest.raises(kv.ToleranceError, match="coasts to rest"):
        kv.solve(scene)
    assert "unstable" in kv.steady(scene).notes[0]


def test_a_scene_file_keeps_the_start_and_an_override_replaces_what_it_excludes(tmp_path):
    scene = kv.Scene(start=kv.Start(gap="2 mm", depth_rate="1 m/s"))
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene), "utf-8")
    assert kv.load_scene(path) == scene
    other = kv.load_scene(path, overrides=["start.depth=0.2 mm"])
    assert (other.start.gap, other.start.depth, other.start.depth_rate) == (None, 2e-4, 1.0)
    assert "[start]" not in kv.to_toml(kv.Scene())


def test_a_drop_without_a_speed_and_a_start_says_so():
    with pytest.raises(ValueError, match=r"needs a `speed`"):
        kv.restitution()
    assert kv.restitution(kv.Scene(start=kv.Start(gap=1e-3))).number > 0.0


def test_a_fit_of_a_drop_returns_the_foundation_and_the_gap():
    scene = kv.problem("drop")
    seen = kv.transient(scene, at=np.linspace(0.0, 0.04, 60), certify=False)
    data = {
        "time [s]": seen.time, "normal_force [N/m]": seen.normal_force, "depth [m]": seen.depth,
    }  # fmt: skip
    first = scene.replace({"foundation.stiffness": 7e9, "start.gap": 1.1e-3})
    free = ["foundation.stiffness", "foundation.retardation_time", "start.gap"]
    found = kv.fit(first, data=data, free=free)
    values = [found.parameters[key].value for key in free]
    assert values == pytest.approx([1e10, 1e-3, 1e-3], rel=1e-4)


CYCLE = [(0.0, 0.0), (0.1, 3e-4), (0.2, 3e-4), (0.3, -1e-4), (0.4, 3e-4)]
"""Indentation, hold, withdrawal into the air, and a second indentation, of ground that has not relaxed."""


@pytest.mark.parametrize("seed", [3, 4, 9, 12, 13])
def test_depths_over_time_agree_with_an_independent_program(seed):
    """On a damper or an arm; run the module itself for more of them."""
    ratio, _ = start_elements.compared(start_elements.HELD, seed)
    assert ratio.max() < 1.0


@pytest.mark.parametrize("seed", [2, 5, 50])
def test_depths_over_time_on_a_damper_beside_arms_agree_with_an_independent_program(seed):
    drive, arms, damper, _, _, points, _, times = drawn = start_elements.drawn("held", seed)
    known, error = start_elements.extrapolated(*drawn)
    scene = kv.Scene(
        kv.Parabola(0.5), kv.GeneralizedMaxwell(1.0, arms, damping=damper), kv.Fixed(history=points),
        kv.Drive(drive.velocity(0.0)), kv.Run(2.4),
    )  # fmt: skip
    dense = 100.0 / max(d for _, d in points) ** 0.5
    simulated = kv.elements(scene, at=times, per_length=dense, certify=False)
    for found, more in ((simulated, 2e-3), (kv.transient(scene, at=times, certify=False), 0.0)):
        rows = np.array(
            [found.depth, found.depth_rate, 0.75 * found.normal_force, 0.75 * found.friction_force]
        )
        assert np.abs(rows.T - known[:, :4]).max() < error.max() + more


def test_ground_that_is_left_where_the_rate_of_the_depth_jumps_is_kept():
    """The contact closes in no time at 0.6; an edge that turns just before passes no ground by rounding."""
    drive = BaseMotion.constant(0.47, end=0.65).holding(
        [(0.0, 0.1), (0.5, 1.0), (0.6, 1.0), (0.7, 0.8)]
    )
    given, start = (0.65, 1e-8), Beginning(0.1, 1.8, 0.0)
    motion = trajectory.solve(drive, [], (1.0, math.inf), *given, damper=1.0, start=start)
    known = solver.solve(drive, 1.0, math.inf, *given, start=start)
    assert [kind for _, kind in motion.events].count("take-off") == 1
    assert motion.ledger(0.62).balance == pytest.approx(0.0, abs=1e-7)
    xi = np.linspace(-1.5, 1.5, 7)
    assert motion.compression(xi, 0.62) == pytest.approx(known.compression(xi, 0.62), abs=1e-8)


def test_energy_is_kept_where_a_contact_opens_beside_the_place_where_it_closed():
    """It covers that place, and both parts of its trace, in its first step."""
    drive = BaseMotion.constant(1e-5, end=0.8).holding(
        [(0.0, 1.4), (0.1, -0.3), (0.6, -0.3), (0.8, 0.9)]
    )
    start = Beginning(*drive.depths[0], 0.0)
    motion = trajectory.solve(drive, [(2.0, 0.6)], (1.0, math.inf), 0.8, 1e-7, start=start)
    assert motion.ledger(0.8).balance == pytest.approx(0.0, abs=1e-10)


def test_a_contact_withdraws_from_ground_on_which_it_opened_in_one_step():
    """The pressure there seems largest beside the middle, within a width that counts as closed."""
    law = kv.GeneralizedMaxwell(1e10, [(2.756e10, 0.694)])
    times = [0.0, 0.075, 0.225, 0.4, 0.425, 0.475]
    depths = [3.948e-4, 2.266e-4, -1e-4, 1.87e-4, 3.99e-4, 3.74e-5]
    scene = kv.Scene(
        foundation=law, support=kv.Fixed(history=list(zip(times, depths, strict=True))),
        drive=kv.Drive(0.0), run=kv.Run(0.475),
    )  # fmt: skip
    at = [0.41, 0.425, 0.44, 0.4456]
    found, known = (kv.transient(scene, at=at, rtol=r, certify=False) for r in (1e-6, 1e-7))
    one, two = ([e.time for e in run.events if e.kind == "take-off"] for run in (found, known))
    assert len(one) == 2
    assert one == pytest.approx(two, rel=1e-8)
    least = 1e-8 * known.normal_force.max()
    assert found.normal_force == pytest.approx(known.normal_force, rel=1e-6, abs=least)


def test_at_a_jump_of_the_rate_of_the_depth_on_a_damper_beside_arms_values_are_those_just_after():
    """The clock pauses there; by rounding, no time may lie between the pause and what follows."""
    points = [
        (0.0, 1.0),
        (0.17, 1.1),
        (0.23, 0.9),
        (0.29, 1.0),
        (0.37, 0.8),
        (0.41, 1.0),
        (0.7, 0.9),
    ]
    drive, start = BaseMotion.constant(0.0, end=0.7).holding(points), Beginning(1.0, 0.0, 0.0)
    times, depths = np.array(points).T
    rates = np.diff(depths) / np.diff(times)
    for unit in np.linspace(0.3, 1.3, 11):
        pieces, *_ = records.with_pauses(drive.scaled(unit, 1.0), 0.7 / unit, needed=True)
        assert np.array_equal(pieces[1:, START], pieces[:-1, END])
    motion = trajectory.solve(
        drive, [(2.0, 0.6)], (1.0, math.inf), 0.7, 1e-4, damper=0.3, start=start
    )
    found = motion.states(times[:-1], peaks=False)
    assert found["depth_rate"] == pytest.approx(rates, rel=1e-9)
    assert found["depth"] == pytest.approx(depths[:-1], rel=1e-12)


@pytest.mark.parametrize("law", [kv.Foundation(1e10, 0.1), ARMS], ids=["damper", "arms"])
@pytest.mark.parametrize("velocity", [0.0, 0.05])
def test_a_contact_that_is_opened_and_closed_agrees_with_elements_and_keeps_energy(law, velocity):
    scene = kv.Scene(
        foundation=law, support=kv.Fixed(history=CYCLE), drive=kv.Drive(velocity), run=kv.Run(0.5)
    )
    at = np.array([0.05, 0.15, 0.19, 0.29, 0.36, 0.45])
    exact, simulated = kv.transient(scene, at=at), kv.elements(scene, at=at, certify=False)
    assert exact.depth == pytest.approx(np.interp(at, *np.array(CYCLE).T), abs=1e-15)
    assert np.isnan(exact.leading_edge[3])
    for name in ("normal_force", "friction_force", "peak_pressure"):
        one, other = getattr(exact, name), getattr(simulated, name)
        assert other == pytest.approx(one, abs=2e-4 * max(np.abs(one).max(), 1.0))
    books = exact.solution.energy(at)
    assert np.abs(books.balance).max() < 1e-4 * np.abs(books.work).max()


def test_indentation_is_the_closed_form_on_a_damper():
    """On the static contact, p = K (d - h) + C d' (F17), and so is the force."""
    K, tau, R, speed = 1e10, 0.1, 0.01, 3e-3
    points = [(0.0, 0.0), (0.1, 0.1 * speed)]
    scene = kv.Scene(support=kv.Fixed(history=points), drive=kv.Drive(0.0), run=kv.Run(0.1))
    found = kv.transient(scene, at=[0.02, 0.05, 0.09])
    a = np.sqrt(2.0 * R * speed * found.time)
    assert found.leading_edge == pytest.approx(-a, rel=1e-7)
    force = K * 4.0 / 3.0 * a * speed * found.time + K * tau * speed * 2.0 * a
    assert found.normal_force == pytest.approx(force, rel=1e-7)


@pytest.mark.parametrize(
    "law",
    [kv.Foundation(1e10, 0.01), kv.GeneralizedMaxwell(1e10, [(3e10, 4e-3)])],
    ids=["damper", "arms"],
)
def test_a_small_oscillation_returns_the_dynamic_modulus(law):
    """With the corrections of chords of length h, in their middle; the motion of edges is of second order.

    What the start from rest leaves of an arm has decayed after a period.
    """
    K, d, share, w, count = 1e10, 3e-4, 1e-5, 2.0 * math.pi / 0.05, 40
    t = np.linspace(0.0, 0.1, 2 * count + 1)
    points = list(zip(t.tolist(), (d * (1.0 + share * np.sin(w * t))).tolist(), strict=True))
    scene = kv.Scene(
        foundation=law, support=kv.Fixed(history=points), drive=kv.Drive(0.0), run=kv.Run(0.1)
    )
    at = t[count:-1] + 0.5 * t[1]
    found = kv.transient(scene, at=at, rtol=1e-8, certify=False)
    turning = np.exp(-1j * w * at)
    force = np.mean(found.normal_force * turning) / np.mean(share * d * np.sin(w * at) * turning)
    h, turned = t[1], np.exp(0.5j * w * t[1])
    rate = (turned - 1.0 / turned) / h  # over the value in the middle
    modulus = K * math.cos(0.5 * w * h) + law.damping * rate
    for arm in law.arms:
        tau, kept = arm.relaxation_time, math.exp(-0.5 * h / arm.relaxation_time)
        at_node = (1.0 - kept**2) / (turned**2 - kept**2)
        modulus += arm.stiffness * tau * rate * (kept * at_node + 1.0 - kept)
    assert force / 2.0 / math.sqrt(0.02 * d) == pytest.approx(modulus, rel=3e-5)


@pytest.mark.parametrize(
    "shape", [kv.Sphere(0.01), kv.Circle(0.01), kv.Wedge(0.1)], ids=lambda s: s.shape
)
def test_every_shape_held_after_an_indentation_presses_as_at_a_constant_depth(shape):
    scene = kv.Scene(
        shape, support=kv.Fixed(history=CYCLE[:3]), drive=kv.Drive(0.0), run=kv.Run(0.25)
    )
    held = kv.elements(scene, at=[0.15], certify=False).normal_force[0]
    static = kv.elements(
        replace(scene, support=kv.Fixed(3e-4)), at=[0.15], certify=False
    ).normal_force[0]
    assert held == pytest.approx(static, rel=1e-6)


def test_a_history_of_the_depth_is_read_from_scenes_and_tables(tmp_path):
    scene = kv.Scene(support=kv.Fixed(history=CYCLE), run=kv.Run(0.5))
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    assert kv.load_scene(path) == scene
    for name, column, unit in (("depth.csv", "depth", 1e3), ("height.csv", "z", -1e3)):
        rows = "\n".join(f"{t},{unit * d}" for t, d in CYCLE)
        (tmp_path / name).write_text(f"t [s],{column} [mm]\n{rows}")
        text = kv.to_toml(scene).split("\n")
        lines = [f'file = "{name}"' if "history" in line else line for line in text]
        path.write_text("\n".join(lines))
        read = kv.load_scene(path).support
        assert np.array(read.history) == pytest.approx(np.array(CYCLE), abs=1e-18)


@pytest.mark.parametrize(
    ("support", "message"),
    [
        ({"history": [(0.0, 0.0), (0.0, 1e-4)]}, "the depth would jump, with an infinite rate"),
        ({"history": [(0.0, -1e-4)]}, "expected one above 0"),
        ({"history": [(0.0, 1e-4)], "depth": 1e-4}, "cannot be given beside support.history"),
        ({"history": []}, "expected points such as"),
        ({}, "support.depth: missing"),
    ],
)
def test_a_wrong_history_of_the_depth_is_refused(support, message):
    with pytest.raises(ValueError, match=message):
        kv.Fixed(**support)


def test_what_holds_at_one_depth_refuses_a_history_and_a_sweep_takes_it():
    scene = kv.Scene(support=kv.Fixed(history=CYCLE), run=kv.Run(0.1))
    for question in (kv.steady, kv.asymptotes, kv.stability):
        with pytest.raises(ValueError, match="holds at one depth only"):
            question(scene)
    over = {"support.depth": [1e-4, 3e-4], "foundation.retardation_time": [0.05, 0.1]}
    table = kv.sweep(scene, over=over, quantities=["normal_force.end"])
    half = scene.replace({"support.depth": 1e-4})
    assert table["normal_force.end"][0, 1] == pytest.approx(
        kv.transient(half, at=[0.1]).normal_force[0], rel=1e-6
    )
    assert kv.solve(scene, at=[0.05]).model == "continuum"


def test_an_indentation_is_compared_with_theory():
    support, drive = kv.Fixed(history=CYCLE), kv.Drive(0.02)
    scene = kv.Scene(kv.Parabola(0.01), kv.Foundation(1e10, 0.1), support, drive, kv.Run(0.5))
    assert kv.compare(scene).verdict == "agrees"
    other = kv.transient(
        scene.replace({"foundation.retardation_time": 0.13}),
        at=np.linspace(0.0, 0.5, 60),
        certify=False,
    )
    data = {"t [s]": other.time, "depth [m]": other.depth, "F_z [N/m]": other.normal_force}
    found = kv.compare(scene, data=data)
    assert (found.verdict, found.explanations[0].name) == ("disagrees", "wrong tau")
    grid, known = simulate(scene, (Rule(depth_rate=0.0), Rule()), 0.5)
    assert known["depth"][:, 1] == pytest.approx(np.interp(grid, *np.transpose(CYCLE)), abs=1e-9)
    exact = kv.transient(scene, at=[0.05, 0.15], certify=False).normal_force
    assert np.interp([0.05, 0.15], grid, known["normal_force"][:, 1]) == pytest.approx(
        exact, rel=0.02
    )


@pytest.mark.parametrize(
    "law", [kv.Foundation(8e9, 0.05), kv.GeneralizedMaxwell(8e9, [(2e10, 0.05)])]
)
def test_a_fit_of_an_indentation_returns_its_foundation(law):
    """Force over time in an indentation, hold and withdrawal, without sliding."""
    points = [(0.0, 0.0), (0.05, 3e-4), (0.15, 3e-4), (0.25, 0.0)]
    parts = {"support": kv.Fixed(history=points), "drive": kv.Drive(0.0), "run": kv.Run(0.25)}
    scene, t = kv.Scene(foundation=law, **parts), np.linspace(0.01, 0.24, 12)
    force = kv.transient(scene, at=t, certify=False).normal_force
    time = "retardation_time" if not law.arms else "arms[0].relaxation_time"
    given = scene.replace({"foundation.stiffness": 1e10, f"foundation.{time}": 0.1})
    keys = ["foundation.stiffness", f"foundation.{time}"]
    found = kv.fit(given, data={"t [s]": t, "F_z [N/m]": force}, free=keys)
    assert found.parameters[keys[0]].value == pytest.approx(8e9, rel=1e-3)
    assert found.parameters[keys[1]].value == pytest.approx(0.05, rel=1e-3)
