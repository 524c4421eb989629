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


def notes_everywhere(scene, tmp_path):
    """The notes of each answer for one scene."""
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    end = {"run.duration": [0.01]}
    return {
        "steady": kv.steady(scene).notes, "asymptotes": kv.asymptotes(scene).notes,
        "transient": kv.transient(scene, at=[0.0], certify=False).notes,
        "solve": kv.solve(scene, quantity=MU, rtol=0.9).notes,
        "solved over time": kv.solve(scene, at=[0.0], quantity=["depth"], rtol=0.1).notes,
        "scene": printed("scene", path)["notes"], "sweep": kv.sweep(scene, over=end).notes,
        "motions": kv.sweep(scene, over=end, quantities="depth.end").notes,
    }  # fmt: skip


@pytest.mark.parametrize("way", ["rest", "thin"])
def test_every_answer_says_where_a_contact_on_a_layer_is_beyond_linear_theory(way, tmp_path):
    layer = kv.Foundation(
        modulus="1 MPa", thickness="2 mm", poisson_ratio=0.49, retardation_time="1 ms",
        stiffness_from=way,
    )  # fmt: skip
    scene = kv.Scene(kv.Parabola("10 mm"), layer, kv.Fixed(1e-4), kv.Drive(0.05), kv.Run(0.01))
    edge = "slope of the indenter at the edge of the contact {}0.31, above 0.3"
    cases = (
        (0.38e-3, 0.1, ""),
        (0.42e-3, 0.1, "depth/thickness {}0.21, above 0.2"),
        (0.2e-3, 0.4e-3 / 0.29**2, ""),
        (0.2e-3, 0.4e-3 / 0.31**2, edge),
        (2.2e-3, 0.1, "depth/thickness {}1.1, above 1, so that the indenter would reach the"),
    )
    one = "steady", "asymptotes", "transient", "solve", "scene"
    for depth, R, words in cases:
        there = scene.replace({"support.depth": depth, "indenter.radius": R})
        for answer, notes in notes_everywhere(there, tmp_path).items():
            own = words.format("= " if answer in one else "is up to ")
            large = [note for note in notes if "linear theory" in note or "no such" in note]
            assert len(large) == bool(words), (answer, notes)
            assert own in "".join(notes), (answer, notes)


def test_small_and_unlayered_contacts_have_no_note_on_strains(tmp_path):
    assert kv.steady().notes == kv.steady(over={"support.load": 1e6}).notes == ()
    (note,) = kv.steady(HELD, over={"support.depth": 6e-4}, method="layer").notes
    assert note.startswith("Strains are large: depth/thickness = 0.3, above 0.2, and the slope")
    (note, _) = kv.steady(HELD, over={"support.depth": [1e-4, 3e-4, 3e-3]}).notes
    assert note.startswith(
        "There is no such contact in 1 of 3 scenes: depth/thickness is up to 1.5"
    )
    over_time = kv.Fixed(history=[("0 s", "0.1 mm"), ("0.1 s", "0.5 mm"), ("0.2 s", "0.1 mm")])
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(replace(HELD, support=over_time)))
    assert "depth/thickness = 0.25, above 0.2" in "".join(printed("scene", path)["notes"])
    narrow = kv.Sphere("20 mm", radius_across="2 mm")
    layer = replace(RUBBER, stiffness_from="thin")
    notes = kv.steady(kv.Scene(narrow, layer, kv.Fixed(1e-4), kv.Drive(0.05))).notes
    assert "slope of the indenter at the edge of the contact = 0.316" in "".join(notes)


def test_a_layer_taken_as_thin_is_noted_everywhere(tmp_path):
    thin = replace(LINE, foundation=replace(RUBBER, stiffness_from="thin"), run=kv.Run(0.01))
    for answer, notes in notes_everywhere(thin, tmp_path).items():
        assert any("not thin for its contact" in note for note in notes), answer
    (note,) = kv.sweep(
        thin, over={"foundation.thickness": [1e-6, 2e-3], "drive.velocity": [0.05]}
    ).notes
    assert "in some scenes" in note
    assert kv.sweep(thin, over={"foundation.thickness": [2e-6]}).notes == ()


@pytest.mark.parametrize("way", ["rest", "thin"])
def test_fits_and_comparisons_say_how_far_elements_are_from_the_layer(way):
    scene = replace(LINE, foundation=replace(RUBBER, stiffness_from=way), run=kv.Run(0.01))
    words = {"rest": "The foundation gives mu within", "thin": "not thin for its contact"}[way]
    V = np.geomspace(1e-3, 1.0, 12)
    curve = {"V [m/s]": V, "mu": kv.steady(scene.at(V)).friction_coefficient}
    found = kv.fit(scene, curve, free=["foundation.modulus"])
    assert words in found.notes[-1]
    assert kv.compare(scene, curve).verdict == "agrees"
    assert words in kv.compare(scene, curve).diagnosis
    assert (
        "layer"
        not in kv.compare(replace(scene, foundation=kv.Foundation(1e9, 0.01)), curve).diagnosis
    )


def test_a_fault_is_found_on_the_elements_of_a_layer_with_arms():
    scene = replace(LINE, run=kv.Run(0.01))
    elements = scene.foundation.elements
    alone = replace(scene, foundation=elements)
    assert elements.modulus is None
    assert kv.steady(alone).friction_force == kv.steady(scene).friction_force
    stiffer = alone.replace({"foundation.stiffness": 1.3 * elements.stiffness})
    found = kv.compare(scene, kv.transient(stiffer, at=np.linspace(0.0, 0.01, 100)))
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == "wrong K"
    assert found.explanations[0].factor == pytest.approx(1.3, rel=1e-3)


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
    finer = kv.steady(LINE, method="layer")  # to 0.1 %
    both = sum(found.certificate.relative_error[MU] for found in (strict, finer))
    assert strict.friction_coefficient == pytest.approx(finer.friction_coefficient, rel=both)
    reasons = {step.rung: step.outcome for step in strict.climb}
    assert f"{MU} on independent elements is within {error:.2g}" in reasons["exact"]
    every = kv.solve(LINE, rtol=1e-3)
    assert set(every.values) == {MU, "friction_force", "depth", "load"}
    assert every.model == "layer"
    assert kv.solve(LINE, quantity="peak_pressure", rtol=0.2).model == "layer"


def test_solve_says_what_the_layer_does_not_know():
    with pytest.raises(kv.ToleranceError, match=r"try a tolerance from 1.0e-04; .*within"):
        kv.solve(BALL, rtol=1e-5)
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


def test_a_shape_without_a_contact_at_rest_is_told_of_what_the_command_has():
    wedge = replace(LINE, indenter=kv.Wedge(inclination=0.1))
    curve = {"V [m/s]": [0.01, 0.1, 1.0], "mu": [0.01, 0.05, 0.02]}
    for answer in (
        lambda: kv.asymptotes(wedge), lambda: kv.steady(wedge),
        lambda: kv.fit(wedge, curve, free=["foundation.modulus"]),
    ):  # fmt: skip
        with pytest.raises(
            ValueError, match=r"^steady sliding on independent elements needs the K"
        ):
            answer()
    with pytest.raises(ValueError, match=r'^`method` = "quadrature" needs the K'):
        kv.steady(wedge, method="quadrature")


def test_the_friction_maximum_of_a_circle_on_a_layer_with_arms():
    found = kv.asymptotes(replace(LINE, indenter=kv.Circle("10 mm")))
    ((velocity, friction),) = found.maxima
    near = np.array([0.98, 1.0, 1.02]) * velocity
    below, at, above = kv.steady(
        replace(LINE, indenter=kv.Circle("10 mm")).at(near)
    ).friction_coefficient
    assert max(below, above) < at == pytest.approx(friction, rel=1e-6)
