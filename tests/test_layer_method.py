"""Steady sliding by the method "layer": scenes, arrays, commands and refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.layer.answer import RTOL
from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import slide
from kvtheory.results import ToleranceError
from tests.commands import printed, run

LAYER = {"modulus": "1 MPa", "thickness": "1 mm", "poisson_ratio": 0.49}
RUBBER = kv.GeneralizedMaxwell(**LAYER, arms=[("4 MPa", "20 ms")])
LINE = kv.Scene(kv.Parabola("10 mm"), RUBBER, kv.Fixed("0.1 mm"), kv.Drive("50 mm/s"))
BALL = kv.Scene(kv.Sphere("10 mm"), RUBBER, kv.DeadWeight(load="1 N"), kv.Drive("50 mm/s"))
KEYS = [
    "foundation.modulus=1 MPa", "foundation.thickness=1 mm", "foundation.poisson_ratio=0.49",
    "foundation.retardation_time=20 ms", "support.mass=100 kg/m",
]  # fmt: skip
SET = [f"--set={key}" for key in KEYS]
NAMES = "depth", "load", "friction_force", "friction_coefficient", "leading_edge", "trailing_edge"


@pytest.mark.parametrize("scene", [LINE, BALL])
def test_the_method_is_boundary_elements_of_the_body(scene):
    state = kv.steady(scene, method="layer")
    found = slide(
        scene.indenter, Body.of_foundation(RUBBER), 0.05, Support.of_scene(scene.support),
        RTOL[scene.indenter.per_width],
    )  # fmt: skip
    for name in (*NAMES, "peak_pressure"):
        assert getattr(state, name) == getattr(found, name)
    errors, length = state.certificate.relative_error, found.trailing_edge - found.leading_edge
    assert errors["friction_force"] == found.errors["friction_force"] / found.friction_force
    assert errors["trailing_edge"] == found.errors["trailing_edge"] / length
    assert (state.model, state.certificate.kind, state.notes) == ("layer", "estimated", ())
    assert state.units["load"] == ("N/m" if scene is LINE else "N")
    assert state.retardation_length == pytest.approx(0.05 * 0.08)
    at_rest = kv.steady(
        scene.replace({"drive.velocity": 0.0}), method="layer",
        over={"support.depth": state.depth} if scene is LINE else {},
    )  # fmt: skip
    if scene is LINE:
        assert state.half_length == pytest.approx(at_rest.trailing_edge, rel=0.02)
    assert at_rest.friction_force == 0.0
    assert at_rest.certificate.relative_error["friction_force"] == 0.0


@pytest.mark.parametrize("scene", [LINE, BALL])
def test_the_pressure_carries_the_load_and_is_drawn(scene, tmp_path):
    states = [
        kv.steady(scene.replace({"drive.velocity": V}), method="layer") for V in (0.05, -0.05)
    ]
    for state in states:
        field = state.pressure_field
        assert field.pressure.shape == (field.x.size, field.y.size)
        line = scene is LINE
        forces = field.pressure * (field.x[1] - field.x[0]) * (1.0 if line else np.diff(field.y)[0])
        assert forces.sum() == pytest.approx(state.load, rel=1e-9)
        slope = field.x[:, None] / 0.01 + 0.0 * field.y
        assert -np.sum(forces * slope) == pytest.approx(state.friction_force, rel=0.05)
        assert field.pressure.max() <= state.peak_pressure
        ax = state.plot().axes[0]
        x, p = ax.lines[0].get_data()
        assert np.array_equal(p, field.pressure[:, 0 if line else field.y.size // 2] * 1e-6)
        edges = sorted([state.leading_edge, state.trailing_edge])
        assert np.all((x[p > 0.0] > 1e3 * edges[0]) & (x[p > 0.0] < 1e3 * edges[1]))
        assert ("middle plane" in ax.get_ylabel()) == (not line)
    path, picture = tmp_path / "scene.toml", tmp_path / "pressure.svg"
    path.write_text(kv.to_toml(scene))
    printed_field = printed("steady", path, "--method", "layer", "--plot", picture)[
        "pressure_field"
    ]
    assert printed_field["pressure"] == states[0].pressure_field.pressure.tolist()
    assert printed_field["x"] == states[0].pressure_field.x.tolist()
    assert "pressure" in picture.read_text()
    assert printed("steady", path)["pressure_field"] is None


def test_arrays_are_scenes_one_by_one():
    told = []
    velocities = [[0.0, 0.02], [-0.02, 0.3]]
    held = kv.Scene(
        LINE.indenter, RUBBER, kv.Suspended(load=500.0, stiffness=5e6), kv.Drive(velocities)
    )
    state = kv.steady(held, method="layer", progress=lambda share, words: told.append(share))
    assert told == sorted(told)
    assert {0.25, 0.5, 0.75, 1.0} < set(told)
    assert state.friction_force.shape == (2, 2) == state.certificate.relative_error["load"].shape
    one = kv.steady(held.replace({"drive.velocity": 0.3}), method="layer")
    for name in NAMES:
        assert getattr(state, name)[1, 1] == getattr(one, name)
    assert state.friction_force[1, 0] == pytest.approx(-state.friction_force[0, 1], rel=1e-9)
    assert state.leading_edge[1, 0] > 0.0 > state.trailing_edge[1, 0]
    assert state.pressure_field is None

    over = {"foundation.thickness": [1e-3, 2e-3], "drive.velocity": 0.02}
    both = kv.steady(LINE, over=over, method="layer")
    thick = kv.steady(LINE, over={**over, "foundation.thickness": 2e-3}, method="layer")
    assert both.load[1] == thick.load < both.load[0]
    assert both.over["foundation.thickness"].tolist() == [1e-3, 2e-3]
    assert kv.steady(LINE, over={"drive.velocity": []}, method="layer").load.shape == (0,)


def test_commands_print_a_table_and_json():
    table = run("steady", "--method", "layer", *SET).stdout
    assert "model: layer" in table
    assert "boundary elements of the body" in table
    assert "peak pressure is infinite" in table
    assert "not thin" not in table
    found = printed("steady", "--method", "layer", *SET)
    assert (found["model"], found["peak_pressure"], found["dissipated_in_contact"]) == (
        "layer", None, None,
    )  # fmt: skip
    assert found["load"] == pytest.approx(980.665)
    thin = "--set", "foundation.stiffness_from=thin"
    assert "method `layer` of `steady`" in run("steady", *SET, *thin).stdout


@pytest.mark.parametrize(
    "indenter",
    [
        kv.Wedge(0.05),
        kv.PowerLaw(length="10 mm", exponent=4),
        kv.Profile(lambda x: x * x / 0.02, lambda x: x / 0.01),
        kv.Sphere("10 mm", radius_across="5 mm"),
    ],
)
def test_every_convex_shape_slides_on_a_layer(indenter):
    """The K of independent elements, which follows from a contact at rest that is not known, is not used."""
    scene = kv.Scene(indenter, RUBBER, kv.Fixed("0.1 mm"), kv.Drive("50 mm/s"))
    assert scene.foundation.stiffness is scene.foundation.arms[0].stiffness is None
    state = kv.steady(scene, method="layer")
    assert state.retardation_length == pytest.approx(0.05 * 0.08)
    tolerance = RTOL[indenter.per_width]
    body, support = Body.of_foundation(RUBBER), Support(1e-4)
    right = slide(indenter, body, 0.05, support, tolerance)
    assert state.friction_force == right.friction_force > 0.0
    back = slide(indenter, body, -0.05, support, tolerance)
    assert back.friction_force == pytest.approx(-right.friction_force, rel=2 * tolerance)


def test_shapes_without_a_contact_at_rest_slide_where_no_layer_is_thin(tmp_path):
    """An incompressible layer, and a half-space, have no K of a thin layer."""
    rubber = replace(RUBBER, poisson_ratio=0.5)
    wedge = kv.Scene(kv.Wedge(0.05), rubber, LINE.support, LINE.drive)
    space = replace(RUBBER, thickness=math.inf)
    ball = kv.Scene(kv.Sphere(0.01, radius_across=0.005), space, BALL.support, BALL.drive)
    for scene in (wedge, ball):
        state = kv.steady(scene, method="layer")
        assert state.friction_coefficient > 0.0
        path = tmp_path / "scene.toml"
        path.write_text(kv.to_toml(scene))
        found = printed("steady", path, "--method", "layer")
        assert found["friction_force"] == state.friction_force
        assert "is not known here" in printed("scene", path)["notes"][0]
        assert kv.solve(scene, quantity="depth", rtol=0.03).model == "layer"
        for ask in (
            kv.steady, kv.asymptotes, kv.stability, lambda each: kv.transient(each, at=[0.0]),
            lambda each: kv.elements(each, at=[0.0]), kv.restitution, kv.footprint,
            lambda each: kv.sweep(each, over={"drive.velocity": [0.1]}),
        ):  # fmt: skip
            with pytest.raises(ValueError, match=r'"thin", or the body itself.*`method` = "layer"'):
                ask(scene)
    own = replace(wedge, indenter=LINE.indenter)
    assert own.foundation.stiffness > 0.0
    assert replace(own, indenter=kv.Wedge(0.05)) == wedge


def test_solve_climbs_to_grids_for_the_tolerance_that_is_asked():
    """Against a finer grid; what no grid reaches is refused at once."""
    told = []
    asked = {"quantity": "friction_coefficient", "rtol": 1e-3}
    found = kv.solve(BALL, **asked, progress=lambda share, words: told.append(words))
    body, support = Body.of_foundation(RUBBER), Support.of_scene(BALL.support)
    finer = slide(BALL.indenter, body, 0.05, support, 2e-4)
    error = found.certificate.relative_error["friction_coefficient"]
    assert found.model == "layer"
    assert error < 1e-3
    assert found.friction_coefficient == pytest.approx(finer.friction_coefficient, rel=error)
    assert "cells along the contact" in told[0]
    edge = kv.solve(LINE, quantity="half_length", rtol=5e-3)
    assert edge.certificate.relative_error["half_length"] < 5e-3
    with pytest.raises(
        ToleranceError, match=r"try a tolerance from 1.0e-04; .*layer: error too large"
    ):
        kv.solve(BALL, quantity="friction_force", rtol=1e-5)


def test_an_array_in_a_message_is_a_list():
    over = {"foundation.thickness": ["1 mm", "inf"]}
    with pytest.raises(kv.SceneError, match=r"foundation.thickness = \[0.001, inf\]: a line"):
        kv.steady(LINE, over=over)


def test_stability_on_a_spring_is_not_claimed():
    state = kv.steady(
        kv.Scene(LINE.indenter, RUBBER, LINE.support, kv.Drive(0.05, stiffness=1e6, mass=1.0)),
        method="layer",
    )
    assert state.stable is None
    assert "independent elements" in state.notes[0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "expected modulus, thickness and poisson_ratio"),
        (["--set", "foundation.thickness=inf", *SET[:1], *SET[2:]], "foundation.thickness"),
        (["--set", "foundation.poisson_ratio=0.6", *SET[:2], *SET[3:]], "at most 0.5"),
        (
            [*SET, "--set", "foundation.kind=fractional-kelvin-voigt", "--set", "foundation.order=0.5"],
            'only, not for "fractional-kelvin-voigt"',
        ),
    ],
)  # fmt: skip
def test_refusals(options, message):
    refused = run("steady", "--method", "layer", *options, status=2).output
    assert message in refused
    assert refused.count("error") == 1


def test_a_sweep_solves_the_layer_itself(tmp_path):
    over = {"drive.velocity": np.array([0.02, 0.2]), "foundation.thickness": [1e-3, 2e-3]}
    swept = kv.sweep(LINE, over=over, method="layer", output=tmp_path / "layer.csv")
    grid = {"drive.velocity": over["drive.velocity"][:, None], "foundation.thickness": [1e-3, 2e-3]}
    right = kv.steady(LINE, over=grid, method="layer")
    assert swept["friction_force"] == pytest.approx(right.friction_force, rel=1e-3)
    assert np.isnan(swept["dissipated_in_contact"]).all()
    with pytest.raises(ValueError, match="steady quantities only"):
        kv.sweep(LINE, over=over, quantities="depth.end", method="layer")
    assert right.plot().axes[0].get_xlabel() == "drive velocity $V$ [mm/s]"


def test_the_peak_on_a_damper_is_infinite_and_the_rest_is_not():
    voigt = kv.Foundation(**LAYER, retardation_time="20 ms")
    state = kv.steady(kv.Scene(LINE.indenter, voigt, LINE.support, LINE.drive), method="layer")
    assert state.peak_pressure == math.inf
    assert np.isfinite(list(state.certificate.relative_error.values())).all()
