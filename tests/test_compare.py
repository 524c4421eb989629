"""Anybody's time series, read and held against theory: what agrees, and what cannot be judged."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._compare import METHODS
from kvtheory.checks.checklist import judge
from kvtheory.checks.comparing import verdict
from kvtheory.checks.comparison_case import make_case
from kvtheory.checks.hypotheses import scaled_scene
from kvtheory.checks.theory import Theory
from kvtheory.fitting.series import MOST_ROWS, read
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.plots.comparison import save_comparison_report
from kvtheory.results.table import SCHEME_ROWS
from kvtheory.scene.columns import SPELLINGS
from tests import SCENES as MANY
from tests import confusion
from tests.browser import Browser
from tests.commands import printed, refused, run
from tests.confusion import disturbed
from tests.faulty_simulator import simulate

HEADS = "t [ms],z_A [mm],F_z [N/mm],F_x [N/mm]"
SCALED = {"time": 1e3, "depth": -1e3, "normal_force": 1e-3, "friction_force": 1e-3}
HISTORY = [["0 ms", "100 mm/s"], ["50 ms", "100 mm/s"], ["50 ms", "-60 mm/s"], ["120 ms", "-60 mm/s"],
           ["120 ms", "0 mm/s"], ["160 ms", "0 mm/s"], ["160 ms", "100 mm/s"]]  # fmt: skip
RAMP = [["0 ms", "0 mm/s"], ["40 ms", "100 mm/s"], ["80 ms", "20 mm/s"]]
SOFT = {"stiffness": "1 MN/m^2"}


def scene(**drive):
    return kv.Scene(drive=kv.Drive(**drive))


LINES = {
    "dead-weight": kv.Scene(),
    "fixed": kv.Scene.table1("fixed"),
    "suspended": kv.Scene.table1("suspended"),
    "slow": scene(velocity=0.02),
    "backward": scene(velocity=-0.1),
    "history": scene(history=HISTORY),
    "ramp": scene(history=RAMP),
    "light": kv.Scene(support=kv.DeadWeight(mass=100.0)),
    "heavy": kv.Scene(support=kv.DeadWeight(mass=30000.0)),
}
SPRINGS = {
    "stable": confusion.SCENES["spring"],
    "to and fro": confusion.SCENES["spring, to and fro"],
    "stick-slip": scene(velocity="91 mm/s", **SOFT),
    "held by a spring": kv.Scene(
        support=kv.Fixed("0.3 mm"), drive=kv.Drive("0.1 m/s", mass="1 kg/mm", **SOFT)
    ),
    "backward on a spring": scene(history=confusion.STOP_AND_GO, **SOFT),
}
SCENES = LINES | SPRINGS
BALL = kv.Scene(kv.Sphere(0.01), support=kv.DeadWeight(mass=1.0), run=kv.Run(0.016))
BALLS = {
    "dead-weight": BALL,
    "fixed": replace(BALL, support=kv.Fixed(1.7667919077651083e-4)),  # its static depth
    "suspended": replace(BALL, support=kv.Suspended(mass=1.0, stiffness=3e4)),
}


@cache
def simulated(name):
    stepped = name in ("history", "ramp", *SPRINGS)
    return simulate(SCENES[name], time_step=1e-4 if stepped else None)


@pytest.fixture(scope="module")
def sound():
    return simulated("dead-weight")


def exact(given, count=401):
    """Return theory itself, without what is given."""
    at = np.linspace(0.0, given.run.duration, count)
    found = kv.transient(given, at=at, rtol=1e-9, certify=False)
    return {name: getattr(found, name) for name in found.units if name != "velocity"}


def write(path, series, heads=HEADS, separator=","):
    table = np.array([series[name] * factor for name, factor in SCALED.items()]).T
    rows = [separator.join(f"{value:.8g}" for value in row) for row in table]
    path.write_text("\n".join(["# my program, version 1", heads, *rows]) + "\n", encoding="utf-8")
    return path


def failed(comparison):
    return [check.name for check in comparison.checks if check.ok is False]


@pytest.mark.parametrize("name", SCENES)
def test_a_sound_simulation_agrees_in_every_scene_and_with_noise(name):
    """It shares no code with theory. Of the noisy series there are few, uneven rows."""
    series = simulated(name)
    found = kv.compare(SCENES[name], series)
    assert failed(found) == []
    assert found.verdict == "agrees"
    made = {check.name for check in found.checks if check.ok}
    assert len(made) >= 14
    if name in SPRINGS:
        assert {"sliding velocity, largest", "spring force, largest", "velocity, largest"} <= made
        return
    rng, size = np.random.default_rng(7), series["time"].size
    rows = np.sort(rng.choice(size, min(size, 400), replace=False))
    kept = {key: series[key][rows] for key in SCALED}
    noisy = {key: value + 0.01 * np.std(value) * rng.standard_normal(rows.size)
             for key, value in kept.items() if key != "time"} | {"time": kept["time"]}  # fmt: skip
    assert failed(kv.compare(SCENES[name], kept)) == []
    assert failed(kv.compare(SCENES[name], noisy)) == []


@pytest.mark.parametrize(
    "name", ["dead-weight", *(name for name in SPRINGS if name != "to and fro")]
)
def test_theory_agrees_with_itself_noisy_and_rounded_too(name):
    rng, series = np.random.default_rng(3), exact(SCENES[name])
    found = kv.compare(SCENES[name], series)
    worst = {check.name: check.measured / check.allowed for check in found.checks if check.ok}
    curves = [ratio for check, ratio in worst.items() if check.endswith(("RMS", "largest"))]
    assert len(curves) >= 14
    assert max(curves) < 1e-3
    if name in SPRINGS:  # what lasts of the error of friction overshoots, and may be all of it
        late = {key: found.allowed[key][-100:] for key in ("spring_force", "friction_force")}
        assert np.all(late["spring_force"] > 0.95 * late["friction_force"])
    few = ("depth", "normal_force", "friction_force", "spring_force", "sliding_velocity")
    given = {key: series[key] for key in few if key in series}
    noisy = {key: x * (1.0 + 0.01 * rng.standard_normal(x.size)) for key, x in given.items()}
    digits = {key: np.array([float(f"{v:.3g}") for v in x]) for key, x in given.items()}
    for changed in (noisy, digits):
        assert failed(kv.compare(SCENES[name], {"time": series["time"], **changed})) == []


def test_a_spring_that_elements_load_in_long_steps_agrees():
    """Elements are farther apart than those assumed, and with them the paper's steps are longer."""
    given = kv.Scene(
        kv.Parabola(0.0177), kv.Foundation(5e9, 0.2), kv.DeadWeight(1730.0),
        kv.Drive(0.0116, stiffness=13e6, damping=45e3), kv.Run(1.4),
    )  # fmt: skip
    a = float(kv.steady(given, over={"drive.velocity": 0.0}).half_length)
    how = {"scheme": "semi-implicit", "time_step": 2.0 * a / 287 / 0.0116, "certify": False}
    found = kv.elements(given, per_length=287 / a, at=np.linspace(0.0, 1.4, 41), **how)
    names = ("time", "depth", "normal_force", "friction_force", "spring_force")
    assert failed(kv.compare(given, {name: getattr(found, name) for name in names})) == []


@pytest.mark.parametrize("steps", [400, 800])
def test_an_oscillation_by_a_first_order_scheme_may_grow_with_the_time(steps):
    """Euler's method takes h/(2 |T|^2) from its decay; nothing is said of scheme and step."""
    given = kv.Scene(
        kv.Sphere(0.0077), kv.Foundation(4.7e8, 0.047), kv.DeadWeight(7.8), kv.Drive(0.4),
        kv.Run(0.054),
    )  # fmt: skip
    a = float(kv.steady(given, over={"drive.velocity": 0.0}).half_length)
    how = {"per_length": 117 / a, "time_step": given.run.duration / steps, "certify": False}
    run = kv.elements(given, scheme="explicit-euler", at=np.linspace(0.0, 0.054, 118), **how)
    found = kv.compare(given, {name: getattr(run, name) for name in SCALED})
    assert found.verdict == "agrees", found.diagnosis


UNHURRIED = {
    "gentle": scene(velocity=0.05),
    "soft": kv.Scene(
        kv.Parabola(0.02), kv.Foundation(2e8, 0.02), kv.DeadWeight(40.0), kv.Drive(0.5), kv.Run(0.15)
    ),
    "to and fro": scene(history=[(0.0, 0.08), (0.07, 0.08), (0.07, -0.04)]),
    "stop and go": scene(history=[(0.0, 0.1), (0.06, 0.1), (0.06, 0.0), (0.15, 0.0), (0.15, 0.1)]),
}  # fmt: skip


@pytest.mark.parametrize("scheme", ["explicit-euler", "semi-implicit"])
@pytest.mark.parametrize("name", UNHURRIED)
def test_first_order_simulations_at_the_papers_step_agree(tmp_path, name, scheme):
    """Nothing is said of their elements and steps, fewer and of lower order than in the paper.

    The inertia that follows from a depth of few digits is rough, but says nothing against the data.
    """
    given = UNHURRIED[name]
    spacing = kv.steady(given, over={"drive.velocity": 0.0}).half_length / 400
    step = 2.0 * spacing / max(abs(V) for _, V in given.drive.points)
    how = {"per_length": 1.0 / spacing, "time_step": step, "scheme": scheme, "certify": False}
    run = kv.elements(given, at=np.arange(0.0, given.run.duration, step), **how)
    series = {name: getattr(run, name) for name in (*SCALED, "depth_rate")}
    assert failed(kv.compare(given, series)) == []
    if name in ("gentle", "soft") and scheme == "semi-implicit":
        table = np.array([series[key] * factor for key, factor in SCALED.items()]).T
        for digits in (3, 4):
            cells = [[f"{t:.7g}", *(f"{v:.{digits}g}" for v in rest)] for t, *rest in table]
            path = tmp_path / f"{digits}.csv"
            path.write_text("\n".join([HEADS, *map(",".join, cells)]), encoding="utf-8")
            assert failed(kv.compare(given, path)) == []


@pytest.mark.parametrize(
    ("name", "scheme"),
    [
        *(("history", scheme) for scheme in SCHEMES),
        *(("suspended", scheme) for scheme in ("paper", "exponential")),
        *(("backward on a spring", scheme) for scheme in ("edge-corrected", "semi-implicit")),
    ],
)
def test_each_of_our_schemes_agrees(name, scheme):
    found = kv.compare(SCENES[name], scheme=scheme)
    assert failed(found) == []
    assert (found.verdict, found.source) == ("agrees", scheme)


@pytest.mark.parametrize("per_length", ["20 /mm", "40 /mm", "60 /mm"])
@pytest.mark.parametrize("name", BALLS)
def test_a_correct_ball_agrees_however_coarse_its_elements(name, per_length):
    """An upper bound of the force of an element is told in the note, and decides nothing."""
    found = kv.compare(BALLS[name], per_length=per_length)
    assert (found.verdict, failed(found)) == ("agrees", [])
    enough = next(check for check in found.checks if check.name == "elements enough")
    assert enough.ok is None
    assert "of the load" in enough.note


def test_our_own_run_is_judged_at_the_steps_of_its_scheme():
    """Instants that it has to stop at would shorten the steps, and hide that they are too long."""
    found = kv.compare(scene(velocity=0.05), scheme="paper")
    checks = {check.name: check for check in found.checks}
    length = np.abs(found.theory["trailing_edge"] - found.theory["leading_edge"]).max()
    assert checks["stability number"].measured == pytest.approx(2e-4 * 1e9 * length / 1e3, rel=1e-3)
    assert found.verdict == "agrees"


def test_our_own_run_that_diverges_disagrees_and_is_written(tmp_path):
    report = tmp_path / "r.html"
    pictures = ["--plot", str(tmp_path / "p.svg"), "--report", str(report)]
    for velocity, outputs in (("12.5 mm/s", pictures), ("0.01 mm/s", [])):
        given = "compare", "--scheme", "paper", "--set", f"drive.velocity={velocity}"
        record = printed(*given, *outputs, status=1)
        assert [check["name"] for check in record["checks"]] == ["run to the end"]
        assert "The time step is unstable (F15): the run diverged at t = " in record["diagnosis"]
    assert "unstable" in report.read_text(encoding="utf-8")
    slow = kv.Scene(drive=kv.Drive("12 mm/s", stiffness="1 MN/m^2"))
    found = kv.compare(slow, scheme="paper", per_length="60 /mm")
    assert failed(found) == ["run to the end"]
    assert found.explanations[0].name == "unstable time step"
    found.to_csv(tmp_path / "a.csv")
    assert "depth, theory [m]" in (tmp_path / "a.csv").read_text(encoding="utf-8")


def test_a_run_too_long_for_our_own_simulation_is_refused_before_it():
    given = kv.load_scene(overrides=["run.duration=1e6 s"])
    with pytest.raises(ValueError, match=r"run\.duration = 1000000\.0 s is too long"):
        kv.compare(given)


@pytest.mark.parametrize("velocity", [2.0, 10.0])
def test_a_simulation_in_flight_keeps_the_error_with_which_it_took_off(velocity):
    given = kv.Scene(drive=kv.Drive(velocity=velocity), run=kv.Run(0.05))
    assert np.isnan(kv.transient(given, at="20 ms:50 ms:30").leading_edge).any()
    held = kv.compare(given, per_length="100 /mm")
    assert held.verdict == "agrees", held.diagnosis


@pytest.mark.parametrize(("scheme", "rows"), [("semi-implicit", 201), ("explicit-euler", 60)])
def test_a_landing_may_be_early_by_what_the_depth_is_off_and_steady_sliding_comes_after_it(
    scheme, rows
):
    given, how = (
        kv.Scene(drive=kv.Drive(1.0), run=kv.Run(0.1)),
        {"per_length": "200 /mm", "scheme": scheme},
    )
    run = kv.elements(given, at=np.linspace(0.0, 0.1, rows), certify=False, **how)
    found = kv.compare(given, {name: getattr(run, name) for name in SCALED}, **how)
    assert set(failed(found)) <= {"sampling"}


def test_noise_below_the_last_digit_of_a_given_depth_agrees():
    """It flips that digit in a few rows; and a depth is not given with more digits than are written."""
    given = kv.Scene(support=kv.Fixed(1.429204e-4), run=kv.Run(0.05))
    exact, rng = kv.transient(given, at="0 ms:50 ms:201", certify=False), np.random.default_rng(0)
    rows = {name: np.array(getattr(exact, name)) for name in SCALED}
    for level, digits in ((1e-4, 4), (0.0, 6)):
        noise = {n: x * (1.0 + level * rng.standard_normal(201)) for n, x in rows.items()}
        cut = {n: np.array([float(f"{v:.{digits}g}") for v in x]) for n, x in noise.items()}
        assert failed(kv.compare(given, {**cut, "time": rows["time"]})) == []


SEEDS = MANY // 40


def sine(t):
    return 0.06 + 0.04 * np.sin(60.0 * t)


EACH, NOISE, DIGITS = ((0.005, None), (0.02, None), (0.0, 2)), ((0.02, None),), ((0.0, 2),)


@pytest.mark.parametrize(
    ("given", "seeds", "ways", "rows"),
    [(kv.Scene(), range(SEEDS), EACH, 300), (scene(function=sine), range(SEEDS // 3), EACH, 300),
     (kv.Scene(), (755, 902), NOISE, 400), (LINES["suspended"], (17, 48, 51), DIGITS, 400)],
    ids=["Table 1", "sine", "noise", "digits"],
)  # fmt: skip
def test_noise_in_proportion_to_the_value_and_two_digits_agree(given, seeds, ways, rows):
    """The last two look worst: noise told from few large values, and rounding that looks like elements."""
    theory = kv.transient(given, at=np.linspace(0.0, given.run.duration, rows).tolist())
    for seed in seeds:
        for level, digits in ways:
            assert failed(kv.compare(given, disturbed(theory, seed, level, digits))) == []


@pytest.mark.parametrize(
    ("given", "untested"), [(kv.Scene(), True), (scene(history=HISTORY), False)]
)
def test_agreement_says_where_the_memory_was_not_tested(given, untested):
    found = kv.compare(given, kv.transient(given, at="0 ms:200 ms:201"))
    assert found.verdict == "agrees"
    assert (
        "the memory of the free surface, as the sliding never reverses" in found.diagnosis
    ) == untested


SWING = kv.Drive("91 mm/s", stiffness="20 MN/m^2", damping="2 kN*s/m^2")


@pytest.mark.parametrize(
    "given",
    [kv.Scene(), scene(history=HISTORY), replace(kv.problem("light-mass"), run=kv.Run(0.2)),
     replace(kv.Scene(), drive=SWING), kv.Scene(drive=kv.Drive(1e-5))],
    ids=["Table 1", "back", "light", "swinging", "creeping"],
)  # fmt: skip
def test_what_is_said_to_be_untested_is_what_data_of_a_wrong_scene_do_not_show(given):
    told = kv.compare(given, exact(given)).diagnosis
    for what, powers in (("the inertia", {"support.mass": 1.0, "support.gravity": -1.0}),
                         ("the damper", {"foundation.retardation_time": 1.0})):  # fmt: skip
        wrong = read(exact(scaled_scene(given, powers, 1.5)))
        shows = verdict(judge(make_case(Theory(given, METHODS), wrong, None, 1.0, 0.1))) != "agrees"
        assert shows != (f"{what}, as 1.5 times as much" in told)


def test_a_base_that_never_moves_and_a_given_depth_test_nothing_else():
    time = np.linspace(0.0, 0.2, 50)
    still, fixed = scene(velocity=0.0), kv.Scene.table1("fixed")
    alone = {"time": time, "depth": np.full(50, float(kv.steady(still).depth))}
    rest = kv.compare(still, alone).diagnosis
    given = kv.compare(fixed, {**alone, "depth": np.full(50, fixed.support.depth)}).diagnosis
    for told in rest, given:
        for what in ("the damper", "the inertia", "the memory of the free surface"):
            assert f"{what}, as " in told
        assert "the normal force and the friction force, which the data do not hold" in told
    assert "the stiffness, as " in given
    assert "the stiffness, as " not in rest


def test_where_the_phase_is_lost_agreement_says_nothing():
    """Coarse elements, and swings enough to be anywhere."""
    given = replace(SCENES["stick-slip"], run=kv.Run(20.0))
    data = exact(given, 1500)
    found = kv.compare(given, data, per_length="50 /mm")
    assert failed(found) == ["phase of the cycle"]
    assert found.verdict == "cannot tell"
    assert "Theory cannot predict the phase of the cycle" in found.diagnosis
    assert kv.compare(given, data, per_length="1000 /mm").verdict == "agrees"


def test_on_a_spring_steady_sliding_is_the_limit_where_it_is_stable():
    spring = kv.Drive("20 mm/s", stiffness="1 MN/m^2", damping="50 kN*s/m^2")
    settled = kv.Scene(drive=spring, run=kv.Run(2.0))
    still, cycle, end = (
        {check.name: check for check in kv.compare(given, exact(given)).checks}
        for given in (SCENES["held by a spring"], SCENES["stick-slip"], settled)
    )
    assert still["phase of the cycle"].ok is None
    assert "unstable" in cycle["steady limit"].note
    assert cycle["phase of the cycle"].ok
    assert end["steady limit"].ok


def test_noise_of_the_depth_counts_in_the_spring_of_a_suspension_too():
    """It is far stiffer than the foundation: its force is as noisy as the depth times its stiffness."""
    stiff = kv.Scene(support=kv.Suspended(mass=1000.0, stiffness=1e9))
    for seed in range(3):
        noisy = disturbed(kv.transient(stiff, at="0 ms:200 ms:240", rtol=1e-9), seed, 0.01)
        assert failed(kv.compare(stiff, noisy)) == []


def test_noise_on_a_known_discretization_is_no_fault_unless_it_is_that_of_elements():
    """White noise is not alike in both forces; an element that enters changes both alike."""
    run = kv.elements(per_length="200 /mm", certify=False, at="0 ms:200 ms:121")
    how, rng = {"per_length": "200 /mm", "scheme": run.scheme}, np.random.default_rng(1)
    for seed in range(3):
        assert failed(kv.compare(data=disturbed(run, seed, 0.03), **how)) == []
    data, common = disturbed(run, 0, 0.0), 0.03 * rng.standard_normal(121)
    alike = {name: data[name] * (1.0 + common) for name in ("normal_force", "friction_force")}
    assert "discretization noise" in failed(kv.compare(data={**data, **alike}, **how))


def test_a_row_at_a_reversal_is_not_taken_for_few_elements():
    """It may be of either side of the jump; theory is just after it."""
    scene = confusion.SCENES["reversal"]
    data, at = exact(scene, 16), np.linspace(0.0, 0.15, 16)
    before = kv.transient(scene, at=[0.05 - 1e-9], rtol=1e-9, certify=False)
    row = int(np.argmin(np.abs(at - 0.05)))
    for name in ("depth", "normal_force", "friction_force"):
        data[name] = np.where(np.arange(16) == row, getattr(before, name), data[name])
    assert at[row] == pytest.approx(0.05)
    assert "elements enough" not in failed(kv.compare(scene, data))


@pytest.mark.parametrize("scheme", ["exponential", "semi-implicit", "edge-corrected"])
def test_steps_that_do_not_resolve_the_swing_on_a_spring_agree(scheme):
    """The base speeds up within a step whose motion does not know it, which costs a force of C dV."""
    scene = kv.Scene(
        kv.Parabola(0.0195), kv.Foundation(1.91e10, 0.435), kv.DeadWeight(430.0),
        kv.Drive(0.00272, stiffness=2.82e7, damping=3.3e4), kv.Run(1.79),
    )  # fmt: skip
    how = {"per_length": 154e3, "scheme": scheme}
    at = np.linspace(0.0, 1.79, 290)
    found = kv.elements(scene, at=at, time_step=4.77e-3, certify=False, **how)
    assert failed(kv.compare(scene, disturbed(found, 0, 1e-6), **how)) == []


OSCILLATING = kv.Scene(
    kv.Parabola(0.011), kv.GeneralizedMaxwell(1e10, [(5e10, 0.05)]), kv.DeadWeight(350.0),
    kv.Drive(0.012), kv.Run(0.1),
)  # fmt: skip


def test_the_rates_of_an_indenter_on_arms_are_nearly_those_of_its_stability():
    (decay, frequency), *_ = kv.stability(OSCILLATING, quantity="rates").rates
    pace = 1.0 / Theory(OSCILLATING, METHODS).rates.oscillation
    assert abs(pace.imag) == pytest.approx(abs(frequency), rel=1e-2)
    assert pace.real == pytest.approx(-decay, rel=0.1)


@pytest.mark.parametrize("scheme", ["explicit-euler", "semi-implicit", "exponential"])
def test_an_oscillation_on_arms_may_drift_by_the_steps_of_a_sound_scheme(scheme):
    at = np.linspace(0.0, 0.1, 121)
    found = kv.elements(OSCILLATING, at=at, per_length=100e3, scheme=scheme, certify=False)
    assert not found.warning
    assert failed(kv.compare(OSCILLATING, disturbed(found, 0, 1e-6), scheme=scheme)) == []


def test_a_rigid_drive_slides_at_its_velocity_and_holds_the_friction():
    data = kv.transient(at=np.linspace(0.0, 0.2, 200).tolist(), rtol=1e-9)
    columns = {
        "time": data.time, "sliding_velocity": data.velocity, "spring_force": data.friction_force,
    }  # fmt: skip
    assert kv.compare(data=columns).verdict == "agrees"


def test_tolerance_multiplies_what_is_allowed(sound):
    one, two = (kv.compare(data=sound, tolerance=factor) for factor in (1.0, 2.0))
    for a, b in zip(one.checks, two.checks, strict=True):
        if a.ok is not None and a.name != "stability number":
            assert b.allowed == pytest.approx(2.0 * a.allowed, rel=0.3)
    off = {**sound, "depth": 1.004 * sound["depth"]}
    assert kv.compare(data=off).verdict == "disagrees"
    assert kv.compare(data=off, tolerance=10.0).verdict == "agrees"


def test_columns_that_are_not_there_are_not_passed(sound):
    found = kv.compare(data={name: sound[name] for name in ("time", "normal_force")})
    reasons = {check.name: check.note for check in found.checks if check.ok is None}
    for name in ("impulse balance", "initial rest state"):
        assert reasons[name] == "not made: the data hold no depth"
    assert reasons["elements enough"].startswith("not made: the element density is not given")
    assert found.as_dict()["checks"][1]["ok"] is None


def test_few_rows_cannot_tell(tmp_path, sound):
    chosen = np.linspace(0, sound["time"].size - 1, 12).round().astype(int)
    few = {name: sound[name][chosen] for name in SCALED}
    found = kv.compare(data=few)
    assert (found.verdict, found.explanations) == ("cannot tell", ())
    path = write(tmp_path / "few.csv", few)
    record = printed("compare", "--data", path, "--report", tmp_path / "r.html")
    assert record["verdict"] == "cannot tell"


# Columns and files


@pytest.mark.parametrize(
    ("header", "quantity", "factor"),
    [("t [ms]", "time", 1e-3), ("Time (s)", "time", 1.0), ("z_A [mm]", "depth", -1e-3),
     ("zA (µm)", "depth", -1e-6), ("delta [m]", "depth", 1.0), ("F_z [N/mm]", "normal_force", 1e3),
     ("Fz (kN/m)", "normal_force", 1e3), ("$F_{x}$ [N/mm]", "friction_force", 1e3),
     ("x_TE [mm]", "trailing_edge", 1e-3), ("p_max [MPa]", "peak_pressure", 1e6),
     ("V [mm/s]", "velocity", 1e-3), ("depth_rate [m/s]", "depth_rate", 1.0),
     ("sliding velocity [mm/s]", "sliding_velocity", 1e-3), ("F_s [N/mm]", "spring_force", 1e3),
     ("Federkraft [N/mm]", "spring_force", 1e3)],
)  # fmt: skip
def test_columns_are_recognised_by_name_and_unit(header, quantity, factor):
    others = {"time": range(8), "normal_force": range(8)}
    data = {header: range(8), **{key: x for key, x in others.items() if key != quantity}}
    assert read(data).columns[quantity][1] == pytest.approx(factor, rel=1e-15)


def test_no_spelling_has_two_meanings_and_si_is_read_exactly():
    meant = {}  # only letters that stand alone have a case
    for name, spellings in SPELLINGS.items():
        for each in spellings.split(", "):
            key = each if len(each) == 1 else each.casefold()
            assert meant.setdefault(key, name) == name
    exact = read({"t [s]": range(8), "F_z [N/m]": range(8), "z_A [m]": range(8)}).columns
    assert exact["normal_force"].tolist() == list(range(8)) == (-exact["depth"]).tolist()


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_separators_and_comments(tmp_path, sound, separator):
    path = write(tmp_path / "a.csv", sound, HEADS.replace(",", separator), separator)
    assert read(path).columns["depth"][0] == pytest.approx(sound["depth"][0], rel=1e-6)
    assert kv.compare(data=path).verdict == "agrees"


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"]
)
def test_what_a_spreadsheet_writes_is_read(tmp_path, encoding):
    heads = "Zeit / ms;Eindringtiefe in µm;Normalkraft (N/mm);F_x/(N/mm);Raumtemperatur [°C];Notiz"
    lines = [f"{k / 10};{300 - k};9,8;{k * 1e-3:.6f};21,5;gut".replace(".", ",") for k in range(40)]
    path = tmp_path / "MESSUNG.CSV"
    path.write_text("\n".join(["sep=;", heads, *lines]), encoding=encoding)
    series = read(path)
    assert series.ignored == ("Raumtemperatur [°C]", "Notiz")
    assert series.time[10] == pytest.approx(1e-3)
    assert series.columns["depth"][10] == pytest.approx(290e-6)
    assert series.columns["normal_force"][0] == pytest.approx(9800.0)
    assert series.columns["friction_force"][39] == pytest.approx(39.0)


def test_long_data_are_thinned_when_they_are_read(sound):
    long = {name: np.repeat(values, 3) for name, values in sound.items()}
    long["time"] = np.linspace(0.0, 0.2, long["time"].size)
    assert read(long).time.size <= MOST_ROWS


def test_columns_that_are_not_used_are_named_shortly_and_only_shown(sound):
    others = {f"{k}\x1b[31m{'x' * 500} [K]": sound["time"] for k in range(300)}
    found = kv.compare(data={**sound, "Raumtemperatur [K]": sound["time"] + 293.0, **others})
    assert found.verdict == "agrees"
    assert "not used: Raumtemperatur [K]" in found.diagnosis
    assert "and 281 more" in found.diagnosis
    assert len(found.diagnosis) < 3000
    assert found.diagnosis.isprintable()


def rows(*lines):
    return "\n".join(lines)


GOOD = [f"{k},-0.3,9.8,0" for k in range(12)]
BAD = {
    "empty": ("", "is empty; expected"),
    "header only": (HEADS, "holds a header and no rows"),
    "no header": (rows(*GOOD), "line 1 holds numbers"),
    "short": (rows(HEADS, *GOOD[:5]), "at least 8"),
    "NaN": (rows(HEADS, *GOOD[:5], "5,nan,9.8,0", *GOOD[6:]), 'column "z_A [mm]": 1 of 12 values'),
    "empty cell": (rows(HEADS, *GOOD[:5], "5,,9.8,0", *GOOD[6:]), "the first in line 7"),
    "infinite": (rows(HEADS, *GOOD, "12,inf,9.8,0"), "diverged"),
    "backward": (rows(HEADS, *GOOD, "3,-0.3,9.8,0"), "must increase, but 0.003 s in line 14 follows 0.011 s"),
    "brief": (rows(HEADS, *[f"{k}e-297,-0.3,9.8,0" for k in range(12)]), "do not span a transient"),
    "standing": (rows(HEADS, *["1,-0.3,9.8,0"] * 12), "do not span a transient"),
    "text": (rows(HEADS, *GOOD, "12,abc,9.8,0"), '"abc" is not a number'),
    "quotation": (rows(HEADS, *GOOD[:5], '"5,-0.3,9.8,0', *GOOD[6:]), "is not a number"),
    "too long": (rows(HEADS, *[f"{k}e300,-0.3,9.8,0" for k in range(12)]), "is the unit of the time right"),
    "ragged": (rows(HEADS, *GOOD, "12,-0.3"), "the first in line 14"),
    "too many cells": (rows(HEADS, *GOOD, "12,-0,3,9,8,0"), "has 6 cells, the header has 4"),
    "decimal comma": (rows(HEADS, '0,"-0,3",9,0'), "write the decimal mark as a point"),
    "two marks": (rows(HEADS.replace(",", ";"), "0;-1.000,3;9;0"), "write the decimal mark as a point"),
    "endless cell": (rows(HEADS, "0," + "9" * 200_000 + ",9,0"), "not a table of numbers: field larger"),
    "no number": (rows("t [ms],V [mm/s]", *["1,2"] * 9, "ten,2", "1,2"), '"ten" is not a number'),
    "nothing known": (rows("a,b", "1,2"), 'line 1, "a,b": has no column that is known'),
    "no unit": (rows("t [ms],depth", "0,1"), 'expected "depth [m]"'),
    "wrong unit": (rows("t [ms],F_z [N]", "0,1"), '"F_z [N]": the unit "N" has the wrong dimension'),
    "unknown unit": (rows("t [ms],z_A [furlongz]", "0,1"), '"furlongz" is not a known unit'),
    "misspelt": (rows("t [ms],Fricton [N/mm]", "0,1"), 'did you mean "friction"'),
    "twice": (rows("t [ms],depth [m],z_A [mm]", "0,1,1"), 'bad.csv: columns "depth [m]" and "z_A [mm]"'),
    "no time": (rows("z_A [mm],F_z [N/mm]", *["1,2"] * 9), "no column is the time"),
    "nothing to judge": (rows("t [ms],V [mm/s]", *["1,2"] * 9), "nothing to judge"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_read_costs_one_message_and_writes_nothing(tmp_path, name):
    text, message = BAD[name]
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    outputs = "--report", tmp_path / "r.html", "--plot", tmp_path / "p.png"
    refused(["compare", "--data", path, *outputs], [message.replace("diverged", "diverges")])
    assert [file.name for file in tmp_path.iterdir()] == ["bad.csv"]


@pytest.mark.parametrize(
    ("options", "message"),
    [({"data": 3.0}, "expected a path to a CSV"),
     ({"tolerance": 0.0}, "`tolerance`"), ({"tolerance": float("nan")}, "`tolerance`"),
     ({"scheme": "papper"}, 'did you mean "paper"'),
     ({"per_length": "200 mm"}, "`per_length`"), ({"per_length": -1.0}, "`per_length`"),
     ({"scene": kv.Scene(drive=kv.Drive(function=lambda t: 1 / 0))}, "drive.function")],
)  # fmt: skip
def test_bad_arguments_are_named(sound, options, message):
    with pytest.raises((ValueError, TypeError), match=message):
        kv.compare(**{"data": sound, **options})


# The command


def test_the_command(tmp_path, sound):
    path = write(tmp_path / "mine.csv", {**sound, "friction_force": -sound["friction_force"]})
    report, plot = tmp_path / "r.html", tmp_path / "p.svg"
    record = printed("compare", "--data", path, "--report", report, "--plot", plot, status=1)
    assert record["verdict"] == "disagrees"
    assert {"name", "measured", "allowed", "ok"} <= set(record["checks"][0])
    assert "wrong sign" in record["diagnosis"]
    page = report.read_text(encoding="utf-8")
    assert "wrong sign" in page
    assert "<svg" in page
    assert not any(word in page for word in ("<script", "src=", "@import", "<link"))
    assert plot.read_text(encoding="utf-8").startswith("<?xml")
    again = run("compare", "--data", path, "--set", "drive.velocity=-100 mm/s")
    assert "agrees with theory" in again.stdout
    shown = run("compare", "--help")
    assert "kvtheory compare" in shown.stdout.split("Example")[1]


def test_the_report_can_be_read_on_a_phone(tmp_path, sound):
    wrong = {**sound, "friction_force": -sound["friction_force"]}
    report = tmp_path / "r.html"
    save_comparison_report(kv.compare(data=wrong), kv.Scene(), report)
    browser = Browser(tmp_path / "profile")
    try:
        browser.screen(390, 844, phone=True)
        browser.open(report)
        assert browser.run("document.documentElement.scrollWidth") == 390
        assert not browser.run(
            "[...document.querySelectorAll('body *')].filter(e => e.scrollWidth > e.clientWidth + 1 &&"
            " e.tagName !== 'PRE' && getComputedStyle(e).overflowX !== 'visible').length"
        )
        rows = browser.run(
            "[...document.querySelectorAll('tr')].map(row => [row, ...row.cells]"
            ".map(e => e.getBoundingClientRect()).map(r => [r.left, r.right, r.top, r.bottom]))"
        )
    finally:
        browser.close()
    assert len(rows) > 15
    for row, *cells in rows:
        left, right, top, bottom = np.transpose(cells)
        assert left.min() >= 0.0
        assert right.max() <= 390.0
        assert row[3] - row[2] < bottom.max() - top.min() + 12.0  # no empty lines
        assert left[-1] < 200.0 < right[-1]  # what is measured has half of the width


def test_the_table_of_schemes_says_what_their_polynomials_do():
    assert set(SCHEMES) <= set(SCHEME_ROWS)
    for name, scheme in SCHEMES.items():
        row, R = SCHEME_ROWS[name], np.array(scheme.stability_polynomial)
        at_limit = abs(np.polynomial.polynomial.polyval(-row.stability_limit, R)) if R.size else 1.0
        assert scheme.row is row
        assert at_limit == pytest.approx(1.0)
        assert np.isinf(row.stability_limit) == (not R.size)
