"""The reference problems: what they cover, and the folders by which others judge their simulations."""

import json
import runpy
import sys
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from figures import reference_problems
from kvtheory.reference_problems import problem_text
from kvtheory.results.table import scales
from kvtheory.scene.foundations import FOUNDATIONS
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SUPPORTS
from kvtheory.scene.static_state import StaticState
from tests import commands

FOLDERS = {
    "paper-fixed": "transient",
    "wedge": "elements",
    "springpot": "steady",
    "point-contact": "transient",
    "ball": "elements",
}

RUBBER = {
    "rubber-start": {
        0.005: (2.95848088e-4, 11028.4325, 796.450166), 0.02: (2.03903403e-4, 9451.30178, 612.606839),
        0.1: (1.51821653e-4, 9921.82809, 156.870938),
    },
    "rubber-reversal": {
        0.03: (1.6867868e-4, 9619.4668, 329.57413), 0.05: (1.6332778e-4, 10003.4227, 104.2279),
        0.08: (1.9071024e-4, 9718.0520, 90.544901), 0.12: (2.6406175e-4, 9860.6781, 271.27592),
    },
    "rubber-stick-slip": {
        0.02: (1.71709897e-4, 9980.20802, 389.77253), 0.06: (1.44891729e-4, 10998.9543, 108.482791),
        0.1: (1.53075229e-4, 10189.8952, 131.703858),
    },
}  # fmt: skip
"""Time: depth, normal force and friction force, by programs that share no code with the solver: start and
stick-slip by material points followed one by one, the reversal by elements, extrapolated from 1,000 and
2,000 per mm."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    directory = tmp_path_factory.mktemp("problems")
    reference_problems.main(["-o", str(directory), *FOLDERS])
    return directory


@pytest.fixture
def run(monkeypatch, capsys):
    """A function that runs a script in this process, and returns its exit status and what it prints."""

    def script(path, *arguments):
        monkeypatch.setattr(sys, "argv", [str(path), *map(str, arguments)])
        try:
            runpy.run_path(str(path), run_name="__main__")
        except SystemExit as end:
            return int(end.code or 0), "".join(capsys.readouterr())
        return 0, "".join(capsys.readouterr())

    return script


def test_there_is_one_for_each_shape_support_and_foundation():
    scenes = [kv.problem(name) for name in kv.problems()]
    assert len(scenes) >= 15
    assert {scene.indenter.shape for scene in scenes} >= set(SHAPES)
    assert {scene.support.kind for scene in scenes} >= set(SUPPORTS)
    assert {scene.foundation.kind for scene in scenes} >= set(FOUNDATIONS)


def test_they_are_what_their_names_say():
    named = "take-off", "heavy-mass", "paper-dead-weight"
    series = {name: kv.transient(kv.problem(name), certify=False) for name in named}
    flies = {name: "take-off" in {e.kind for e in found.events} for name, found in series.items()}
    assert flies["take-off"]
    assert not flies["paper-dead-weight"]
    depth = series["heavy-mass"].depth / kv.steady(kv.problem("heavy-mass")).depth
    assert depth.min() < 0.9 < 1.05 < depth[np.argmin(depth) :].max()
    report = kv.asymptotes(kv.problem("friction-maximum"))
    assert report.velocity == pytest.approx(report.peak_velocity, rel=1e-3)
    assert kv.asymptotes(kv.problem("low-velocity")).use == "L1"
    assert kv.asymptotes(kv.problem("high-velocity")).use == "L2"
    assert kv.steady(kv.problem("wedge")).friction_coefficient == pytest.approx(0.1, rel=1e-14)


@pytest.mark.parametrize("name", RUBBER)
def test_those_on_rubber_have_the_values_of_other_programs(name):
    times, due = list(RUBBER[name]), np.array(list(RUBBER[name].values()))
    scene = replace(kv.problem(name), run=kv.Run(times[-1]))
    found = kv.transient(scene, at=times, rtol=1e-7, certify=False)
    measures = scales(StaticState.of(scene))
    for name, right in zip(("depth", "normal_force", "friction_force"), due.T, strict=True):
        assert np.abs(getattr(found, name) - right).max() < 1e-7 * measures[name]


def test_the_command_prints_what_the_library_loads(tmp_path):
    path = tmp_path / "scene.toml"
    for name, title in kv.problems().items():
        done = commands.run("scene", "--problem", name)
        assert done.output == problem_text(name)
        assert title in done.output
        path.write_text(done.output)
        assert kv.load_scene(path) == kv.problem(name)
    assert "take-off" in commands.run("scene", "--problem", "list").output


@pytest.mark.parametrize("options", [["--problem", "wegde"], ["--problem", "wedge", "--json"]])
def test_a_mistake_costs_one_message(options):
    done = commands.run("scene", *options, status=2)
    assert done.output.count("\n") == 1
    assert 'did you mean "wedge"' in done.output or "does not go with" in done.output


@pytest.mark.parametrize("name", FOLDERS)
def test_a_folder_holds_scene_reference_certificate_criteria_and_picture(folders, name):
    folder, kind = folders / name, FOLDERS[name]
    assert kv.load_scene(folder / "scene.toml") == kv.problem(name)
    certificate = json.loads((folder / "certificate.json").read_text())
    criteria = json.loads((folder / "criteria.json").read_text())
    assert certificate["kind"] in ("proved", "estimated")
    assert criteria["over"] == ("velocity" if kind == "steady" else "time")
    rows = np.genfromtxt(folder / "reference.csv", delimiter=",", names=True, deletechars="")
    for quantity, allowed in criteria["allowed"].items():
        column = next(n for n in rows.dtype.names if n.startswith(f"{quantity}_["))
        largest = np.nanmax(np.abs(rows[column]))
        assert 0.0 < allowed < 0.03 * largest
        unit = 1.0 if kind != "elements" else kv.problem(name).support.weight / largest
        if quantity == "normal_force" or kind != "elements":
            error = np.max(certificate["relative_error"][quantity])
            assert 2 * error * unit * largest < allowed
    assert (folder / "reference.png").read_bytes().startswith(b"\x89PNG")
    assert f'kvtheory.problem("{name}")' in (folder / "README.md").read_text()
    assert len((folder / "judge.py").read_text().splitlines()) < 35


@pytest.mark.parametrize("name", ["wedge", "springpot", "paper-fixed"])
def test_a_folder_judges_the_right_series_right_and_a_wrong_one_wrong(folders, name, tmp_path, run):
    head, *rows = (folders / name / "reference.csv").read_text().splitlines()
    drag = head.split(",").index("friction_force [N/m]")
    right = [row.split(",") for row in rows[:: 1 if name == "springpot" else 8]]
    wrong = [[*r[:drag], repr(1.1 * float(r[drag])), *r[drag + 1 :]] for r in right]
    path = tmp_path / "series.csv"
    for series, status in ((right, 0), (wrong, 1)):
        path.write_text("\n".join([head, *map(",".join, series)]) + "\n")
        assert run(folders / name / "judge.py", path)[0] == status


def test_a_point_contact_is_found_to_disagree(folders):
    folder = folders / "point-contact"
    commands.python(folder / "simulate.py")
    data = np.loadtxt(folder / "point-contact.csv", delimiter=",", skiprows=1)[::20]
    names = ("time", "depth", "normal_force", "friction_force")
    series = dict(zip(names, (data * [1, -1, 1, 1]).T, strict=True))
    found = kv.compare(kv.problem("point-contact"), data=series)
    assert found.verdict == "disagrees"
    assert "depth, largest" in {check.name for check in found.checks if check.ok is False}


def test_the_script_of_a_ball_names_a_fault_and_what_cannot_be_read(folders, run):
    """Theory is a simulation by elements there, and judges as for a line."""
    folder = folders / "ball"
    assert "F_z [N],F_x [N]" in (folder / "README.md").read_text()
    rows = np.loadtxt(folder / "reference.csv", delimiter=",", skiprows=1)[:, [0, 2, 4, 5]]
    for drag, status, told in (
        ("F_x [N]", 1, "times theory, while the rest"),
        ("fricton [N]", 2, "did you mean"),
    ):
        head = f"t [s],depth [m],F_z [N],{drag}"
        table = rows[::8] * [1.0, 1.0, 1.0, 0.5]
        np.savetxt(folder / "mine.csv", table, delimiter=",", header=head, comments="")
        found, printed = run(folder / "judge.py", folder / "mine.csv")
        assert (found, told in printed) == (status, True), printed


def test_the_command_writes_the_folder_whose_script_reads_any_unit(tmp_path, run):
    folder = tmp_path / "problem"
    given = ["scene", "--problem", "springpot", "-o", str(folder)]
    commands.run(*given)
    assert {"scene.toml", "reference.csv", "criteria.json", "judge.py"} <= {
        f.name for f in folder.iterdir()
    }
    state = kv.steady(kv.problem("springpot"), over={"drive.velocity": np.geomspace(1e-3, 1e-1, 7)})
    columns = np.geomspace(1.0, 100.0, 7), np.asarray(state.friction_force) * 1e-3
    for factor, status in ((1.0, 0), (1.2, 1)):
        rows = [
            f"{v!r};{factor * f!r}" for v, f in zip(*(c.tolist() for c in columns), strict=True)
        ]
        (folder / "mine.csv").write_text("\n".join(["V [mm/s];F_x [N/mm]", *rows]))
        assert run(folder / "judge.py", folder / "mine.csv")[0] == status
    assert run(folder / "judge.py", folder / "nothing.csv")[0] == 2
    commands.refused(given, ["is not an empty folder"])
    commands.refused(["scene", "-o", tmp_path / "other"], ["--problem NAME"])
