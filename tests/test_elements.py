"""`kv.elements` and `kvtheory elements`: stability, memory, shapes, symmetry, files and errors."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.charts.stability import contact_lengths
from kvtheory.models.elements import kernels, row, simulation
from kvtheory.models.elements.model import Model, surface_of
from kvtheory.models.elements.row import ElementRow, IndenterState
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.elements.stability import limit_at
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.results.errors import DivergenceError
from tests import SUPPORTS
from tests.commands import printed, refused, run
from tests.test_elements_certificate import errors

IMPLICIT = ("semi-implicit", "exponential", "edge-corrected")
FOUNDATIONS = {
    "Kelvin-Voigt": kv.Foundation(1e10, 0.1),
    "Prony": kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01), (1e10, 0.1)]),
}


def sliding(velocity, tau=0.1, support="dead-weight", duration=0.2, **changes):
    return kv.Scene(
        foundation=kv.Foundation(1e10, tau),
        support=kv.Scene.table1(support).support,
        drive=kv.Drive(velocity),
        run=kv.Run(duration),
        **changes,
    )


# Stability


@pytest.mark.parametrize("scheme", ["paper", "explicit-euler"])
def test_measured_stability_limit_is_the_derived_one(scheme):
    """From a steady state on: below the limit a run stays there, a little above it does not."""
    slow = sliding(0.005, duration=0.6)  # there the contact is hardly longer at the start
    limit = limit_at(SCHEMES[scheme], Model.of(slow).constants, contact_lengths(slow)[0])
    kv.elements(slow, scheme=scheme, time_step=0.96 * limit, certify=False)
    with pytest.raises(DivergenceError) as error:
        kv.elements(slow, scheme=scheme, time_step=1.08 * limit, certify=False)
    assert "stability number" in str(error.value)
    assert '"edge-corrected", which is stable at any step' in str(error.value)


@pytest.mark.parametrize("scheme", IMPLICIT)
@pytest.mark.parametrize("mass", [1.0, 1e3, 1e6])
def test_implicit_schemes_are_stable_at_a_hundred_times_the_limit(scheme, mass):
    scene = kv.Scene(
        support=kv.DeadWeight(mass, 9806.65 / mass), drive=kv.Drive(1e-3), run=kv.Run(2.0)
    )
    limit, own = (
        limit_at(SCHEMES[name], Model.of(scene).constants, max(contact_lengths(scene)))
        for name in ("paper", scheme)
    )
    assert own == math.inf
    step, end = min(100.0 * limit, 0.05), 2.0 if mass > 1.0 else 0.3
    steady = kv.steady(scene)
    end = kv.elements(scene, scheme=scheme, time_step=step, at=[0.1, end], certify=False)
    assert np.all(np.isfinite(end.depth))
    if mass < 1e6:  # the heaviest still swings
        assert end.depth[-1] == pytest.approx(steady.depth, rel=1e-3)


def test_a_doubtful_step_is_announced_before_the_run():
    said = []
    scene = sliding(0.0125, duration=0.02)
    result = kv.elements(scene, scheme="paper", certify=False, warn=said.append)
    assert said == [result.warning]
    assert "a time step of" in said[0]
    assert kv.elements(at=0.0).warning == ""
    assert "elements pass" in kv.elements(at=0.05, time_step=0.025, certify=False).warning


# Memory


def test_memory_does_not_grow_with_time(monkeypatch):
    sizes = []
    move = ElementRow._move

    def recorded(elements, *arguments):
        move(elements, *arguments)
        sizes.append(elements.stored.elements.u.size)

    monkeypatch.setattr(ElementRow, "_move", recorded)
    swing = kv.Drive(function=lambda t: 0.05 + 0.1 * math.cos(50.0 * t))
    for drive in (kv.Drive(0.1), kv.Drive(-0.1), swing):
        sizes.clear()
        scene = kv.Scene(drive=drive, run=kv.Run(3.0))
        kv.elements(scene, per_length="12 /mm", time_step="4 ms", certify=False)
        assert len(sizes) > 6
        assert max(sizes[len(sizes) // 2 :]) <= 1.05 * max(sizes[: len(sizes) // 2])
        assert max(sizes) < 12.0 * 60  # elements in 60 mm, where the base moves by 150 or 300


@pytest.mark.parametrize("back", [-0.1, -0.02])
def test_what_was_forgotten_did_not_matter(monkeypatch, back):
    history = [(0.0, 0.1), (0.1, 0.1), (0.1, back), (0.2, back), (0.2, 0.05)]
    scene = kv.Scene(drive=kv.Drive(history=history), run=kv.Run(0.4))
    options = {"per_length": "25 /mm", "certify": False}
    first = kv.elements(scene, **options)
    monkeypatch.setattr(row, "FORGOTTEN", 1e-100)
    monkeypatch.setattr(simulation, "KEPT_DEPTH", 100.0)
    whole = kv.elements(scene, **options)
    np.testing.assert_allclose(first.depth, whole.depth, rtol=1e-9)
    np.testing.assert_allclose(first.normal_force, whole.normal_force, rtol=1e-9)


def test_an_indenter_that_sinks_deep_is_followed_with_more_room(monkeypatch):
    options = {"at": [0.05, 0.2], "per_length": "50 /mm", "certify": False}
    drive = kv.Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, 0.0)])
    before = kv.elements(kv.Scene(drive=drive), **options)
    monkeypatch.setattr(simulation, "KEPT_DEPTH", 0.5)  # the room of the first attempt
    assert np.array_equal(kv.elements(kv.Scene(drive=drive), **options).depth, before.depth)
    monkeypatch.setitem(simulation.DEEPEST, False, 0.1)
    with pytest.raises(DivergenceError, match="times its static depth"):
        kv.elements(kv.Scene(drive=drive), **options)


# Instants


FORTH_AND_BACK = [(0.0, 0.1), (0.05, 0.1), (0.05, -0.1)]
NEAR = [0.05 - 1e-12, math.nextafter(0.05, 0.0), 0.05, math.nextafter(0.05, 1.0), 0.05 + 1e-12]


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_instants_that_differ_by_rounding_are_as_good_as_any(scheme, support):
    """Also across a jump of the drive: before it and after it."""
    still = kv.Scene.table1(support)
    scene = kv.Scene(support=still.support, drive=kv.Drive(history=FORTH_AND_BACK))
    times = [*NEAR, 0.06, math.nextafter(0.06, 1.0), 0.06 + 1e-13]
    found = kv.elements(scene, at=times, scheme=scheme, certify=False)
    theory = kv.transient(scene, at=times)
    np.testing.assert_allclose(found.velocity, theory.velocity, rtol=1e-14)
    for name in ("depth", "normal_force", "friction_force"):
        given, expected = getattr(found, name), getattr(theory, name)
        np.testing.assert_allclose(
            given, expected, atol=5e-3 * np.abs(expected).max(), err_msg=name
        )


def test_instants_are_reported_as_asked_for():
    times = [0.02, 0.0, 5e-324, 0.01, 0.01, 1e-300]
    found = kv.elements(at=times, per_length="50 /mm", certify=False)
    assert found.time.tolist() == times
    assert found.depth[3] == found.depth[4] < found.depth[1] == found.depth[2]
    assert kv.elements(at=0.0).steps == 0


def test_the_longest_step_is_the_one_that_was_taken():
    slow = sliding(0.005)  # 2 dx/V = 2 ms
    for times, step in ((np.linspace(0.0, 0.2, 401), 2.5e-4), ([0.2], 2e-3)):
        found = kv.elements(slow, at=times, time_step=2e-3, certify=False)
        assert found.time_step == pytest.approx(step)


# Shapes, symmetry, rest


STEADY = {"depth": "depth", "normal_force": "load", "friction_force": "friction_force",
          "leading_edge": "leading_edge", "trailing_edge": "trailing_edge",
          "peak_pressure": "peak_pressure"}  # fmt: skip
SHAPES = [
    (kv.Circle(0.01), 2e-4), (kv.PowerLaw(0.01, 4.0), 1e-3), (kv.PowerLaw(0.01, 1.5), 2e-3),
    (kv.Wedge(0.1), 2e-4), (kv.Profile(lambda x: 50.0 * x * x, lambda x: 100.0 * x), 2e-4),
]  # fmt: skip
"""Shapes on Kelvin-Voigt, and how near they come to steady sliding."""
WIDER = kv.Sphere("10 mm", radius_across="25 mm")
DAMPED = kv.Drive(-0.1, stiffness="100 kN/m", damping="0.5 kN*s/m", mass="2 kg")
MANY = kv.GeneralizedMaxwell(1e10, arms=[(2e9, float(tau)) for tau in np.geomspace(1e-9, 0.1, 20)])


def prony(scene):
    return replace(scene, foundation=FOUNDATIONS["Prony"])


def balls():
    """Return balls on every support and on springs, Kelvin-Voigt and Prony, both ways."""
    fast = kv.Foundation("10 GN/m^3", "20 ms")
    rubber = kv.GeneralizedMaxwell("10 GN/m^3", arms=[["20 GN/m^3", "10 ms"]])
    fixed, weight = kv.Fixed(depth=1e-4), kv.DeadWeight(load="9.8 N")
    hung, run = kv.Suspended(mass="1 kg", stiffness="30 kN/m"), kv.Run(0.3)
    held = [(fixed, fast, 0.1), (weight, fast, -0.025), (hung, fast, 0.1), (fixed, rubber, -0.1),
            (weight, rubber, 0.1)]  # fmt: skip
    yield from (kv.Scene(WIDER, on, by, kv.Drive(V), run) for by, on, V in held)
    for shape in (WIDER, kv.Revolved(kv.PowerLaw("10 mm", 3.0))):
        yield kv.Scene(shape, fast, weight, DAMPED, run)


STARTS = [
    *((sliding(0.1, support=support, duration=0.3, indenter=shape), "edge-corrected", 100, bound)
      for support in SUPPORTS for shape, bound in SHAPES),
    *((prony(sliding(0.1, duration=0.3, indenter=shape)), "edge-corrected", 100, bound)
      for shape, bound in ((kv.Circle(0.01), 1e-3), (kv.PowerLaw(0.01, 4.0), 1e-3), (kv.Wedge(0.1), 2e-2))),
    *((prony(sliding(0.1, support=support, duration=0.3)), scheme, 50,
       4e-4 if scheme == "edge-corrected" else 1e-2) for support in SUPPORTS for scheme in SCHEMES),
    *((scene, "edge-corrected", 14, 5e-3) for scene in balls()),
    *((next(balls()), scheme, 20, 2e-2) for scheme in SCHEMES),
    *((sliding(-0.07, support=support, duration=0.4, indenter=kv.Wedge(0.1)), "edge-corrected", 83, 2e-4)
      for support in ("fixed", "dead-weight")),
    *((kv.Scene(shape, drive=kv.Drive(V, stiffness=1e7, damping=1e5), run=kv.Run(0.5)), "edge-corrected",
       50, 6e-3) for shape in (kv.Circle(0.01), kv.Wedge(0.1)) for V in (0.1, -0.1)),
    *((kv.Scene(kv.Revolved(profile), support=kv.Fixed(1e-4), drive=kv.Drive(0.01), run=kv.Run(0.05)),
       "edge-corrected", 60, 1e-2) for profile in (kv.Wedge(0.1), kv.Circle(2e-3))),
    (kv.Scene(foundation=MANY, support=kv.Fixed("0.1 mm"), run=kv.Run(0.05)), "edge-corrected", 50, 2e-3),
]  # fmt: skip
"""Scenes, schemes, elements in a millimetre, and how near the end is to steady sliding."""


@pytest.mark.parametrize(("scene", "scheme", "density", "bound"), STARTS)
def test_a_start_ends_in_steady_sliding_and_the_certificate_covers(scene, scheme, density, bound):
    state, end = kv.steady(scene), scene.run.duration
    certify = not scene.indenter.per_width or scene.foundation is MANY
    run = kv.elements(
        scene, per_length=1e3 * density, scheme=scheme, at=[0.9983 * end, end], certify=certify
    )
    if row.KERNEL.compiled:  # one layout of all arguments: one compilation
        assert len(row.KERNEL.compiled.signatures) == 1
    expected = {column: float(getattr(state, name)) for column, name in STEADY.items()}
    if not scene.drive.rigid:
        expected |= {
            "spring_force": expected["friction_force"],
            "sliding_velocity": scene.drive.velocity,
        }
    for column, value in expected.items():
        size = abs(expected["leading_edge" if "edge" in column else column])
        slack = 8e-3 if column == "trailing_edge" and scene.indenter.kinks else 0.0
        assert np.abs(getattr(run, column) - value).max() <= (bound + slack) * size, column
    for column, error in errors(run, expected, scene).items() if certify else ():
        assert error <= run.certificate.relative_error[column] + 1e-9, column


@pytest.mark.parametrize("foundation", FOUNDATIONS)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_reversal_of_the_drive_is_the_mirror_image(scheme, foundation):
    history = np.array([(0.0, 0.1), (0.03, 0.1), (0.03, -0.05), (0.1, -0.05)])
    drives = (kv.Drive(history=(history * [1, sign]).tolist()) for sign in (1, -1))
    options = {"per_length": "50 /mm", "scheme": scheme, "certify": False}
    forth, back = (
        kv.elements(kv.Scene(foundation=FOUNDATIONS[foundation], drive=drive, run=kv.Run(0.1)), **options)
        for drive in drives
    )  # fmt: skip
    np.testing.assert_allclose(back.depth, forth.depth, rtol=1e-9)
    scale = np.abs(forth.friction_force).max()
    np.testing.assert_allclose(back.friction_force, -forth.friction_force, atol=1e-6 * scale)
    np.testing.assert_allclose(back.leading_edge, -forth.leading_edge, atol=1e-8)


@pytest.mark.parametrize("foundation", FOUNDATIONS)
@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize("scheme", [name for name in SCHEMES if name != "paper"])
def test_rest_stays_rest(support, scheme, foundation):
    scene = replace(sliding(0.0, support=support), foundation=FOUNDATIONS[foundation])
    result = kv.elements(scene, scheme=scheme, per_length="50 /mm", certify=False)
    assert np.ptp(result.depth) <= 1e-12 * result.depth[0]
    assert np.all(np.abs(result.friction_force) < 1e-9 * result.normal_force)
    expected = kv.transient(sliding(0.0, support=support), at=0.0).normal_force[0]
    assert result.normal_force == pytest.approx(expected, rel=2e-3)


# Compiled and interpreted


BALL = kv.Scene(
    kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"),
    drive=kv.Drive(history=[(0.0, 0.1), (0.01, 0.1), (0.01, -0.05)]), run=kv.Run(0.02),
)  # fmt: skip
BOTH_WAYS = {
    "edge-corrected": (kv.Scene(), "edge-corrected"),
    "paper": (kv.Scene(), "paper"),
    "fixed": (kv.Scene.table1("fixed"), "exponential"),
    "arms": (kv.Scene(foundation=FOUNDATIONS["Prony"]), "edge-corrected"),
    "arms, explicit": (kv.Scene(foundation=FOUNDATIONS["Prony"]), "paper"),
    "ball": (BALL, "edge-corrected"),
    "ball on arms": (replace(BALL, foundation=FOUNDATIONS["Prony"]), "edge-corrected"),
    "wedge on a spring": (
        kv.Scene(kv.Wedge(0.1), drive=kv.Drive(0.1, stiffness=1e6)),
        "edge-corrected",
    ),
    "power law": (kv.Scene(kv.PowerLaw(0.01, 3.3)), "semi-implicit"),
    "cone": (replace(BALL, indenter=kv.Revolved(kv.Wedge(0.1))), "edge-corrected"),
}


@pytest.mark.parametrize("name", BOTH_WAYS)
def test_compiled_kernels_give_what_interpreted_ones_give(name, monkeypatch):
    pytest.importorskip("numba")
    (scene, scheme), found = BOTH_WAYS[name], []
    for compiles in (False, True):
        monkeypatch.setattr(row.KERNEL, "worthwhile", lambda *_, compiles=compiles: compiles)
        options = {"scheme": scheme, "per_length": "30 /mm", "certify": False}
        found.append(kv.elements(scene, at=[0.0, 0.003, 0.011, 0.02], **options))
    slow, fast = found
    assert (slow.compiled, fast.compiled) == (False, True)
    for quantity in TRANSIENT_UNITS:
        one, other = getattr(slow, quantity), getattr(fast, quantity)
        scale = np.nanmax(np.abs(one))
        np.testing.assert_allclose(other, one, atol=1e-7 * scale, err_msg=quantity)


SURFACES = (
    kv.Parabola(0.01),
    kv.Circle(0.01),
    kv.PowerLaw(0.01, 4.0),
    kv.PowerLaw(0.01, 1.5),
    kv.Wedge(0.1),
)


@pytest.mark.parametrize("shape", SURFACES)
def test_kernels_know_the_shapes_of_the_scene(shape):
    x = np.linspace(-0.0099, 0.0099, 23)
    for body in (shape, kv.Revolved(shape)):
        surface = surface_of(body)
        where = (x,) if body is shape else (x, 0.001)
        height, slope = kernels.surface_at(surface, x, 0.001)
        np.testing.assert_allclose(height, body.height(*where), rtol=1e-13)
        np.testing.assert_allclose(slope, body.slope(*where), rtol=1e-12, atol=1e-15)
    depth = 0.4 * float(shape.height(0.005))
    reached = kernels.extent(surface_of(shape), depth, 1.0)
    assert shape.height(reached) == pytest.approx(depth, rel=1e-13)


def test_steps_that_find_no_element_fly():
    """In flight the indenter falls freely."""
    for scheme in SCHEMES.values():
        model = Model.of(kv.Scene(), 5e-6, parts=scheme.row.parts_of_elements)
        elements = ElementRow(model.constants, kv.Drive(0.1).motion(1.0, least=0.1), scheme)
        elements.lay(model.at_rest.depth, lambda x, y: 0.0 * x)
        new = elements.step(IndenterState(0.0, -1e-3, 0.0), 1e-4)
        assert new.rate == pytest.approx(9.80665e-4, rel=1e-9)


def test_a_circle_pressed_in_almost_to_its_reach():
    scene = sliding(0.1, indenter=kv.Circle(0.01), duration=0.02)
    scene = replace(scene, support=kv.Fixed(0.0095))
    edge = kv.steady(scene, method="quadrature").leading_edge
    for scheme in SCHEMES:
        result = kv.elements(scene, per_length="20 /mm", scheme=scheme, certify=False)
        assert np.all(np.isfinite(result.friction_force))
        assert result.leading_edge == pytest.approx(edge, rel=5e-3)


# Use


def test_progress_counts_to_the_end():
    seen = []
    result = kv.elements(
        at=[0.01, 0.02], certify=False, progress=lambda share, words: seen.append((share, words))
    )
    assert seen[-1] == (1.0, f"{result.steps:,} of {result.steps:,} steps")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"scheme": "papper"}, ['"papper"', 'did you mean "paper"']),
        ({"scheme": "rk4"}, ["scheme", '"rk4"', "edge-corrected"]),
        ({"per_length": "200"}, ["per_length", "no unit", "/mm"]),
        ({"per_length": -1.0}, ["per_length", "range"]),
        ({"per_length": "1 /m"}, ["per_length", "expected"]),
        ({"per_length": 1e15}, ["per_length", "expected"]),
        ({"time_step": "0 s"}, ["time_step", "above 0"]),
        ({"time_step": "1e-30 s"}, ["time_step", "expected at most", "steps"]),
        ({"at": "1 s"}, ["at", "run.duration"]),
        ({"at": "1 m", "time_step": "fast"}, ["at", "time_step"]),
    ],
)
def test_bad_arguments(options, words):
    with pytest.raises(ValueError, match=words[0]) as error:
        kv.elements(**options)
    for word in words:
        assert word in str(error.value)


def test_a_ball_of_too_many_strips_is_refused_before_it_is_made():
    plate = kv.Sphere(3e15, radius_across=9e29)
    with pytest.raises(ValueError, match=r"give `per_length`, expected .* 8 to 4898 elements"):
        kv.elements(kv.Scene(plate, support=kv.DeadWeight(mass=1.0)), at=0.0)


def test_the_papers_step_needs_motion():
    with pytest.raises(ValueError, match="infinite for a drive at rest: give a `time_step`"):
        kv.elements(sliding(0.0), scheme="paper")
    still = kv.elements(sliding(0.0), scheme="paper", time_step="0.2 ms", certify=False)
    assert np.ptp(still.depth) <= 1e-12 * still.depth[0]


def test_command_prints_and_writes(tmp_path):
    shorter = ["--set", "run.duration=0.1 s"]
    record = printed("elements", "--at", "0 ms,1 ms,200 ms")
    assert list(record)[: len(TRANSIENT_UNITS)] == list(TRANSIENT_UNITS)
    assert record["normal_force"] == pytest.approx([35367.19, 12732.9, 9806.65], rel=1e-3)
    assert (record["model"], record["scheme"]) == ("elements", "edge-corrected")
    target = tmp_path / "run.csv"
    shown = run("elements", "-o", target, "--per-length", "50 /mm", *shorter).stdout
    assert "nan" not in shown
    assert "50 elements per mm" in shown
    with target.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][:3] == ["time [s]", "velocity [m/s]", "depth [m]"]
    run("elements", "-o", tmp_path / "run.nc", "--per-length", "50 /mm", *shorter)
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(tmp_path / "run.nc", engine="scipy") as data:
        assert data.attrs["model"] == "elements"
        assert data["depth"].size == len(rows) - 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--scheme", "euler"], ['"euler"', "explicit-euler"]),
        (["--per-length", "200 mm"], ["per-length", "1/m"]),
        (["--time-step", "1"], ["time-step", "no unit"]),
        (["-o", "run.xls"], ["run.xls", ".csv"]),
        (["-o", "nowhere/run.csv"], ['there is no directory "nowhere"']),
        (["--scheme", "paper", "--set", "drive.velocity=5 mm/s", "-o", "run.csv"],
         ["warning: the run may diverge", "diverged at t =", "would do"]),
    ],
)  # fmt: skip
def test_bad_input_costs_status_2_and_writes_nothing(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(["elements", *arguments], words)
    assert not list(tmp_path.iterdir())
