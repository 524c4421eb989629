"""How far a foundation is from the layer that gives it: notes, and `solve`, which climbs to the layer."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._model_error import SMALL, errors_of, model_error
from tests.commands import printed, run

RUBBER = kv.GeneralizedMaxwell(
    modulus="1 MPa", thickness="2 mm", poisson_ratio=0.49, arms=[("4 MPa", "20 ms")]
)
LINE = kv.Scene(kv.Parabola("10 mm"), RUBBER, kv.DeadWeight(load=500.0), kv.Drive(0.05))
HELD = replace(LINE, support=kv.Fixed(1e-4))
BALL = kv.Scene(kv.Sphere("10 mm"), RUBBER, kv.DeadWeight(load=1.0), kv.Drive(0.05))
MU = "friction_coefficient"


@pytest.mark.parametrize("scene", [LINE, HELD])
def test_the_error_of_the_model_covers_that_against_boundary_elements(scene):
    foundation, body = kv.steady(scene), kv.steady(scene, method="layer")
    for name, allowed in errors_of(scene).items():
        own, truth = getattr(foundation, name), getattr(body, name)
        known = body.certificate.relative_error[name] + 1e-12
        assert abs(own / truth - 1.0) <= allowed + known, name


def test_notes_say_it_wherever_it_counts(tmp_path):
    mu, depth = (f"{100 * float(each):.2g} %" for each in model_error(LINE))
    words = f"The foundation gives mu within {mu}, depth within {depth} here"
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(LINE))
    for notes in (
        kv.steady(LINE).notes, kv.asymptotes(LINE).notes, kv.transient(LINE, at=[0.0]).notes,
        kv.solve(LINE, quantity=MU, rtol=0.9).notes, printed("scene", path)["notes"],
    ):  # fmt: skip
        assert any(each.startswith("The foundation gives mu within") for each in notes), notes
    assert words in run("steady", path).stdout
    assert ", load within" in kv.steady(HELD).notes[0]
    (note,) = kv.steady(LINE, over={"drive.velocity": [0.01, 0.1]}).notes
    assert "throughout" in note
    assert kv.steady(LINE, method="layer").notes == ()
    thin = {"foundation.thickness": 1e-5, "foundation.poisson_ratio": 0.3, "support.load": 100.0}
    assert max(model_error(LINE.replace(thin))) <= SMALL
    assert kv.steady(LINE, over=thin).notes == ()
    taken = replace(LINE, foundation=replace(RUBBER, stiffness_from="thin"))
    assert "not thin" in kv.steady(taken).notes[0]
    assert model_error(taken) is model_error(kv.Scene()) is None


@pytest.mark.parametrize("scene", [LINE, HELD])
def test_a_sweep_says_how_far_it_is_from_the_layer(scene, tmp_path):
    over = {"drive.velocity": [0.01, 0.05, 0.2], "foundation.thickness": [1e-3, math.inf]}
    output = tmp_path / "map.csv"
    swept = kv.sweep(scene, over=over, block=2, output=output)
    assert swept.failed == 3
    there = {"foundation.thickness": 1e-3, "drive.velocity": over["drive.velocity"]}
    assert swept.model_error == errors_of(scene.replace(there))
    assert swept.notes == kv.steady(scene, over=there).notes
    assert "depth.model" not in swept.certificate.relative_error
    again = kv.sweep(scene, over=over, block=2, output=output)
    assert (again.computed, again.model_error, again.notes) == (0, swept.model_error, swept.notes)
    moved = kv.sweep(scene, over={"run.duration": [0.01]}, quantities="depth.end")
    assert moved.notes == kv.transient(scene, at=[0.0]).notes
    assert kv.sweep(scene, over=there, method="layer", quantities="load").notes == ()
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    words = "--over", "drive.velocity=10 mm/s,50 mm/s", "-o", tmp_path / "two.csv"
    assert "The foundation gives mu within" in run("sweep", path, *words).stdout
    assert "throughout" in printed("sweep", path, *words)["notes"][0]


def test_solve_climbs_to_the_layer_where_the_foundation_is_not_enough():
    error = errors_of(LINE)[MU]
    loose = kv.solve(LINE, quantity=MU, rtol=error * 1.01)
    assert loose.model == "exact"
    assert loose.friction_coefficient == kv.steady(LINE).friction_coefficient
    assert error <= loose.certificate.relative_error[MU] <= error * 1.01
    assert "independent elements" in loose.certificate.statement
    strict = kv.solve(LINE, quantity=MU, rtol=error * 0.99)
    assert strict.model == "layer"
    assert strict.friction_coefficient == kv.steady(LINE, method="layer").friction_coefficient
    reasons = {step.rung: step.outcome for step in strict.climb}
    assert f"{MU} on independent elements is within {error:.2g}" in reasons["exact"]
    every = kv.solve(LINE, rtol=1e-3)
    assert set(every.values) == {MU, "friction_force", "depth", "load"}
    assert every.model == "layer"
    assert kv.solve(LINE, quantity="peak_pressure", rtol=0.2).model == "layer"


def test_solve_says_what_the_layer_does_not_know():
    with pytest.raises(kv.ToleranceError, match=r"try a tolerance from 1.0e-02; .*within"):
        kv.solve(BALL, rtol=1e-3)
    with pytest.raises(kv.ToleranceError, match="dissipated_in_contact on the layer is not known"):
        kv.solve(LINE, quantity="dissipated_in_contact", rtol=0.5)
    thin = replace(LINE, foundation=replace(RUBBER, stiffness_from="thin"))
    assert kv.solve(thin, quantity=MU, rtol=1e-6).model == "exact"


def test_the_table_of_the_climb_names_the_layer(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(LINE))
    told = run("solve", path, "--quantity", MU, "--rtol", "1e-3", "--explain").stdout
    assert "steady sliding on the layer itself" in told
    assert "against the layer" in told
    assert "model: layer" in told


def test_arrays_have_the_errors_of_their_scenes():
    over = {"foundation.thickness": np.array([1e-4, 2e-3, 5e-2]), "drive.velocity": [[0.01], [0.1]]}
    for scene in (LINE, HELD):
        many = model_error(scene.replace(over))
        assert many[0].shape == many[1].shape == (2, 3)
        for i, j in np.ndindex(2, 3):
            own = {key: np.broadcast_to(value, (2, 3))[i, j] for key, value in over.items()}
            one = model_error(scene.replace(own))
            assert [each[i, j] for each in many] == [float(each) for each in one]
    arm = {"foundation.arms[0].modulus": [1e6, 4e6, 1e12]}
    assert np.isinf(model_error(LINE.replace(arm))[0]).tolist() == [False, False, True]
    (note,) = kv.steady(LINE, over={"foundation.arms[0].modulus": 1e12}).notes
    assert note.startswith("How far the foundation is from its layer is not known here")
