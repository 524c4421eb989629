"""The cycle in which a motion on a spring ends: of any shape by elements, its error, and notes before it."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.prony.trajectory import Trajectory
from kvtheory.models.elements.limit_cycle import ENOUGH, MOST_RUNS, limit_cycle
from kvtheory.results.cycles import CYCLE, Cycle, cycle, sampled
from kvtheory.scene.static_state import StaticState
from tests.transient_ball import sheet_on_spring

SPRING = {"stiffness": "1 kN/m", "mass": "100 g"}
BALL = kv.Scene(
    kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"), drive=kv.Drive("150 mm/s", **SPRING),
    run=kv.Run("1.2 s"),
)  # fmt: skip
AMPLITUDE, PERIOD = "stick_slip_amplitude", "stick_slip_period"


def test_the_cycle_of_a_ball_is_that_of_a_sheet_of_points_and_its_errors_cover():
    found = kv.sweep(BALL, over={"drive.velocity": [0.15]}, quantities=list(CYCLE))
    assert found["stick_slip_settles"].tolist() == [1.0]
    at_rest = StaticState.of(BALL)
    s, _, slides, force = sheet_on_spring(at_rest, 1.2 / at_rest.time, 24.0, 0.005)
    late = s * at_rest.time > 1.0
    slides, x = slides[late] * at_rest.velocity, force[late] * at_rest.friction_force / 1e3
    ups = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]))
    expected = {
        AMPLITUDE: 0.5 * np.ptp(x),
        PERIOD: np.diff(s[late][ups]).mean() * at_rest.time,
        "sliding_velocity.cycle_max": slides.max(),
        "sliding_velocity.cycle_min": slides.min(),
    }
    for name, value in expected.items():
        scale = np.ptp(slides) if name.startswith("sliding") else value
        off = abs(found[name][0] - value) / scale
        assert off < min(found.certificate.relative_error[name] + 3e-3, 8e-3), name


def test_elements_and_the_continuum_end_in_the_same_cycle():
    drive = kv.Drive("150 mm/s", stiffness="1 MN/m^2", mass="0.1 kg/mm")
    scene = kv.Scene(drive=drive, run=kv.Run("0.8 s"))
    truth = kv.transient(scene, at=[0.8], rtol=1e-5).cycle
    found = kv.elements(scene, per_length="60 /mm", at=[0.8]).cycle
    assert truth.settles == found.settles == 1.0
    assert truth.smallest_slide < 0.2 * drive.velocity
    ranges = np.ptp(truth.values[2:4]), np.ptp(truth.values[4:])
    scale = np.array([truth.amplitude, truth.period, *np.repeat(ranges, 2)])
    off = abs(found.values - truth.values) / scale
    assert np.all(off <= np.add(found.errors, truth.errors))
    assert off[:2].max() < 5e-3


@pytest.mark.parametrize("follow", ["transient", "elements"])
def test_a_note_says_by_how_much_the_ripple_changes_in_a_period(follow):
    line = kv.Scene(drive=kv.Drive("60 mm/s", stiffness="1 MN/m^2", mass="0.1 kg/mm"))
    scene = replace(line if follow == "transient" else BALL, run=kv.Run("0.5 s"))
    scene = scene.replace({"drive.velocity": 0.06})
    rate, frequency = kv.stability(scene, quantity="rates").rates[0]
    how = {"rtol": 1e-4, "certify": False} if follow == "transient" else {"per_length": "30 /mm"}
    (told,) = getattr(kv, follow)(scene, at=[0.5], **how).notes
    factor, period = re.search(
        r"shrinks .* by a factor of (\S+) per period of (\S+) s", told
    ).groups()
    assert float(period) == pytest.approx(2.0 * math.pi / abs(frequency), rel=1e-2)
    assert float(factor) == pytest.approx(math.exp(rate * float(period)), rel=2e-2)


LINE = kv.Scene(
    drive=kv.Drive("94.9126514 mm/s", stiffness="1 MN/m^2", mass="0.1 kg/mm"), run=kv.Run("1.2 s")
)
"""At 1.02 times the critical velocity, for 16 periods."""


def test_the_cycle_near_the_onset_is_found_without_waiting_for_it():
    found = kv.solve(LINE, quantity=[AMPLITUDE, PERIOD], rtol=0.02)
    assert found.model == "elements"
    # The solver without elements in 120 periods (amplitude to 2e-5).
    for name, expected in ((AMPLITUDE, 2.638309e-4), (PERIOD, 0.07407942)):
        off = abs(found.values[name] / expected - 1.0)
        assert off <= found.certificate.relative_error[name] <= 0.02
    assert abs(found.values[AMPLITUDE] / 2.638309e-4 - 1.0) < 2e-3


def test_the_cycle_of_a_ball_near_the_onset_is_that_of_a_long_run_with_more_elements():
    critical = 0.0832471309555956
    shares = np.array([1.02, 1.1])
    found = kv.sweep(BALL, over={"drive.velocity": critical * shares}, quantities=[AMPLITUDE])
    # 130 elements in a mm: at 1.02 by its growth, at 1.1 in a run of 72 periods.
    off = np.abs(found[AMPLITUDE] / [2.0744e-4, 4.6766e-4] - 1.0)
    assert off.max() < found.certificate.relative_error[AMPLITUDE] < 0.25
    assert off.max() < 0.02


@pytest.mark.parametrize("share", [0.97, 1.0 + 1e-4])
def test_a_ripple_near_the_onset_is_steady_sliding_only_where_it_fades(share):
    scene = LINE.replace({"drive.velocity": 0.09305161908366982 * share})
    run = kv.elements(scene, per_length="60 /mm", at=[1.2])
    assert run.cycle.settles == 0.0
    for rates in (kv.stability(scene).rates, None):
        found = limit_cycle(scene, run, rates)
        assert (found.amplitude == 0.0) == (share < 1.0)


def test_a_search_ends_after_so_much_work_and_shows_its_progress(monkeypatch):
    scene = LINE.replace({"drive.velocity": 0.09305161908366982 * (1.0 + 1e-4)})
    run, shares = kv.elements(scene, per_length="60 /mm", at=[1.2]), list[float]()
    rates = kv.stability(scene).rates

    def runs():
        shares.clear()
        found = limit_cycle(scene, run, rates, progress=lambda share, _: shares.append(share))
        assert found.settles == 0.0
        return 1 + sum(b < a for a, b in itertools.pairwise(shares))

    assert runs() > MOST_RUNS
    monkeypatch.setitem(ENOUGH, True, run.element_updates)
    assert runs() == MOST_RUNS
    monkeypatch.setitem(ENOUGH, True, 1.0)
    assert runs() == 1


def test_a_search_begins_at_the_amplitude_with_fewer_elements():
    run = kv.elements(LINE, per_length="60 /mm", at=[1.2])
    rates, ends = kv.stability(LINE).rates, list[float]()
    found = limit_cycle(LINE, run, rates, 2.64e-4, lambda share, _: ends.append(share))
    assert found.amplitude == pytest.approx(2.638309e-4, rel=5e-3)
    assert 1 + sum(b < a for a, b in itertools.pairwise(ends)) == MOST_RUNS


def test_a_run_too_short_for_its_cycle_is_told_how_long_it_would_take():
    with pytest.raises(kv.ToleranceError, match=r"change at 0.386 1/s.* last about 17.9 s"):
        kv.solve(replace(LINE, run=kv.Run("0.15 s")), quantity=AMPLITUDE)


def test_a_cycle_beside_stable_steady_sliding_says_so():
    slow = replace(kv.Scene().foundation, retardation_time="1 s")
    drive = kv.Drive("4.3 mm/s", stiffness="0.1 MN/m^2")
    scene = kv.Scene(foundation=slow, drive=drive, run=kv.Run("60 s"))
    found = kv.solve(scene, quantity=AMPLITUDE, rtol=0.05)
    assert found.stick_slip_amplitude > 1e-3
    assert any("stable as well" in note for note in found.notes)
    gently = kv.Drive(history=[("0 s", "0 m/s"), ("20 s", "4.3 mm/s")], stiffness="0.1 MN/m^2")
    scene = replace(scene, drive=gently, run=kv.Run("100 s"))
    assert kv.solve(scene, quantity=AMPLITUDE, rtol=0.05).stick_slip_amplitude == 0.0


@pytest.mark.parametrize("follow", ["transient", "elements"])
def test_the_cycle_is_in_json_by_the_names_of_solve(follow):
    drive = kv.Drive("150 mm/s", stiffness="1 MN/m^2", mass="0.1 kg/mm")
    how = {} if follow == "transient" else {"per_length": "60 /mm"}
    run = getattr(kv, follow)(kv.Scene(drive=drive, run=kv.Run("0.8 s")), at=[0.8], **how)
    told = run.as_dict()["cycle"]
    assert set(told) == {*CYCLE, "relative_error"}
    assert set(told["relative_error"]) == set(CYCLE)
    assert told[AMPLITUDE] == run.cycle.amplitude == pytest.approx(1.4916e-3, rel=5e-3)
    assert told["relative_error"][AMPLITUDE] < 0.05
    unknown = getattr(kv, follow)(kv.Scene(drive=drive, run=kv.Run("0.1 s")), at=[0.1], **how)
    assert unknown.as_dict()["cycle"] is None
    assert "cycle" not in getattr(kv, follow)(at=[0.1], **how).as_dict()


def test_solve_gives_the_cycle_or_says_why_not():
    steady = kv.solve(BALL.replace({"drive.velocity": 0.04}), quantity=[AMPLITUDE, PERIOD])
    assert steady.model == "elements"
    assert (steady.stick_slip_amplitude, math.isnan(steady.stick_slip_period)) == (0.0, True)
    assert any("no stick-slip" in note for note in steady.notes)
    with pytest.raises(
        kv.ToleranceError, match=r"neither a cycle, .* choose a longer run.duration"
    ):
        kv.solve(replace(BALL, run=kv.Run("0.1 s")), quantity=AMPLITUDE)
    with pytest.raises(kv.SceneError, match=r"stick_slip_amplitude.*needs drive.stiffness"):
        kv.solve(quantity=AMPLITUDE)
    with pytest.raises(kv.SceneError, match="leave out the times"):
        kv.solve(BALL, quantity=AMPLITUDE, at="1 ms")
    with pytest.raises(kv.SceneError, match="does not belong to the cycle"):
        kv.solve(BALL, quantity=[AMPLITUDE, "load"])


def test_the_cycle_on_rubber_needs_no_peak_pressures(monkeypatch):
    rubber, asked = kv.GeneralizedMaxwell("10 GN/m^3", arms=[["50 GN/m^3", "100 ms"]]), list[bool]()
    drive = kv.Drive("50 mm/s", stiffness="1 MN/m^2")
    run = kv.transient(kv.Scene(foundation=rubber, drive=drive, run=kv.Run("5 ms")), rtol=1e-4)
    states = Trajectory.states

    def watched(self, s, *, peaks=True):
        asked.append(peaks)
        return states(self, s, peaks=peaks)

    monkeypatch.setattr(Trajectory, "states", watched)
    assert run.cycle.settles == 0.0
    assert asked
    assert not any(asked)


@pytest.mark.parametrize(
    ("velocity", "ramp", "after", "steady"),
    [(0.04, 1.0, 1.0, True), (0.04, 3.0, 0.5, False), (0.1, 10.0, 0.5, False)],
)
def test_a_ramp_ends_in_steady_sliding_of_unknown_stability_only_if_the_motion_fades(
    velocity, ramp, after, steady
):
    # At 0.1 m/s it ends in a cycle, to be seen eight seconds later.
    history = [(0.0, 0.0), (ramp, velocity)]
    drive = kv.Drive(history=history, stiffness="1 MN/m^2", mass="0.1 kg/mm")
    scene = kv.Scene(kv.Circle("10 mm"), drive=drive, run=kv.Run(ramp + after))
    found = kv.elements(scene, per_length="30 /mm", at=[ramp + after])
    assert (found.cycle.settles, found.cycle.amplitude == 0.0) == (float(steady), steady)
    assert (found.as_dict()["cycle"] is None) == (not steady)


def ripple(t, growth, size=2e-5):
    """Return a ripple that grows, as a motion."""
    grown, turns = size * np.exp(growth * t), 30.0
    x, rate = (
        grown * np.sin(turns * t),
        grown * (turns * np.cos(turns * t) + growth * np.sin(turns * t)),
    )
    return sampled(t, x, rate, sliding_velocity=10.0 - rate, friction_force=x)


def test_a_ripple_that_still_grows_is_not_steady_sliding_however_small_it_is():
    t = np.linspace(0.0, 10.0, 5000)
    assert cycle(t, ripple(t, -0.2)).amplitude == 0.0
    assert cycle(t, ripple(t, 0.2)).settles == 0.0


@pytest.mark.parametrize("growth", [-1e-4, -1e-5, -1e-6, 1e-6, 1e-5])
@pytest.mark.parametrize("duration", [2.0, 10.0])
def test_a_ripple_that_changes_slowly_is_no_cycle(growth, duration):
    t = np.linspace(0.0, duration, 3000)
    assert cycle(t, ripple(t, growth, 0.1)).settles == 0.0
    assert cycle(t, ripple(t, 0.0, 0.1)).amplitude == pytest.approx(0.1, rel=1e-6)


def test_a_heavy_mass_that_swings_ever_less_is_no_stick_slip():
    drive = kv.Drive("80 mm/s", stiffness="300 GN/m^2", mass="3e4 kg/mm")
    scene = kv.Scene(drive=drive, start=kv.Start(sliding_velocity="0 m/s"), run=kv.Run("0.5 s"))
    assert kv.stability(scene, quantity="stable").stable
    assert kv.transient(scene, at=[0.5], rtol=1e-5).cycle.settles == 0.0
    assert kv.elements(scene, at=[0.5], per_length="30 /mm").as_dict()["cycle"] is None


def test_a_cycle_in_which_no_other_solution_ends_is_not_known():
    steady = Cycle(1.0, 0.0, math.nan, 1.0, 1.0, 1.0, 1.0, (0.0,) * 6)
    assert steady.beside([steady], 4.0).settles == 1.0
    assert steady.beside([Cycle(0.0)], 4.0).known.settles == 0.0
    swings = Cycle(1.0, 2.0, 3.0, 1.0, 0.0, 1.0, 0.0, (0.0,) * 6)
    assert max(swings.beside([], 4.0).relative_errors.values()) == math.inf
    found = swings.beside([steady], 4.0)
    assert max(found.relative_errors.values()) == math.inf
    assert (found.known.settles, max(found.known.relative_errors.values())) == (0.0, 0.0)
    assert swings.beside([replace(swings, amplitude=2.1)], 4.0).errors[0] == pytest.approx(0.2)
