"""The reference problems: what they cover, and the folders by which others judge their simulations."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import kvtheory as kv
from figures import reference_problems
from kvtheory.cli import main
from kvtheory.reference_problems import problem_text
from kvtheory.scene.foundations import FOUNDATIONS
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SUPPORTS

FOLDERS = {
    "paper-fixed": "transient",
    "wedge": "elements",
    "springpot": "steady",
    "point-contact": "transient",
}
NAMED = "take-off", "heavy-mass", "paper-dead-weight"


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    directory = tmp_path_factory.mktemp("problems")
    reference_problems.main(["-o", str(directory), *FOLDERS])
    return directory


def judged(folder, series):
    return subprocess.run(
        [sys.executable, "-W", "error", folder / "judge.py", series],
        check=False,
        capture_output=True,
        text=True,
    )


def test_there_is_one_for_each_shape_support_and_foundation():
    scenes = [kv.problem(name) for name in kv.problems()]
    assert len(scenes) >= 15
    assert {scene.indenter.shape for scene in scenes} >= set(SHAPES)
    assert {scene.support.kind for scene in scenes} >= set(SUPPORTS)
    assert {scene.foundation.kind for scene in scenes} >= set(FOUNDATIONS)


def test_they_are_what_their_names_say():
    series = {name: kv.transient(kv.problem(name)) for name in NAMED}
    kinds = {name: {event.kind for event in found.events} for name, found in series.items()}
    assert "take-off" in kinds["take-off"]
    assert "take-off" not in kinds["paper-dead-weight"]
    depth = series["heavy-mass"].depth / kv.steady(kv.problem("heavy-mass")).depth
    assert depth.min() < 0.9 < 1.05 < depth[np.argmin(depth) :].max()
    report = kv.asymptotes(kv.problem("friction-maximum"))
    assert report.velocity == pytest.approx(report.peak_velocity, rel=1e-3)
    assert kv.asymptotes(kv.problem("low-velocity")).use == "L1"
    assert kv.asymptotes(kv.problem("high-velocity")).use == "L2"
    assert kv.steady(kv.problem("wedge")).friction_coefficient == pytest.approx(0.1, rel=1e-14)


def test_the_command_prints_what_the_library_loads(tmp_path):
    for name, title in kv.problems().items():
        done = CliRunner().invoke(main, ["scene", "--problem", name])
        assert done.exit_code == 0
        assert done.output == problem_text(name)
        assert title in done.output
        path = tmp_path / "scene.toml"
        path.write_text(done.output)
        assert kv.load_scene(path) == kv.problem(name)
    assert "take-off" in CliRunner().invoke(main, ["scene", "--problem", "list"]).output


@pytest.mark.parametrize("options", [["--problem", "wegde"], ["--problem", "wedge", "--json"]])
def test_a_mistake_costs_one_message(options):
    done = CliRunner().invoke(main, ["scene", *options])
    assert done.exit_code == 2
    assert done.output.count("\n") == 1
    assert 'did you mean "wedge"' in done.output or "does not go with" in done.output


@pytest.mark.parametrize("name", FOLDERS)
def test_a_folder_holds_scene_reference_certificate_criteria_and_picture(folders, name):
    folder = folders / name
    assert kv.load_scene(folder / "scene.toml") == kv.problem(name)
    certificate = json.loads((folder / "certificate.json").read_text())
    criteria = json.loads((folder / "criteria.json").read_text())
    errors = certificate["relative_error"]
    assert certificate["kind"] in ("proved", "estimated")
    assert criteria["over"] == ("velocity" if FOLDERS[name] == "steady" else "time")
    rows = np.genfromtxt(folder / "reference.csv", delimiter=",", names=True, deletechars="")
    for quantity, allowed in criteria["allowed"].items():
        column = next(n for n in rows.dtype.names if n.startswith(f"{quantity}_["))
        largest = np.nanmax(np.abs(rows[column]))
        assert 0.0 < allowed < 0.03 * largest
        unit = 1.0 if FOLDERS[name] != "elements" else kv.problem(name).support.weight / largest
        if quantity == "normal_force" or FOLDERS[name] != "elements":
            assert 2 * np.max(errors[quantity]) * unit * largest < allowed
    assert (folder / "reference.png").read_bytes().startswith(b"\x89PNG")
    assert f"kvtheory scene --problem {name}" in (folder / "README.md").read_text()
    assert len((folder / "judge.py").read_text().splitlines()) < 30


@pytest.mark.parametrize("name", ["wedge", "springpot", "paper-fixed"])
def test_a_folder_judges_the_right_series_right_and_a_wrong_one_wrong(folders, name, tmp_path):
    folder = folders / name
    head, *rows = (folder / "reference.csv").read_text().splitlines()
    sparse = tmp_path / "right.csv"
    sparse.write_text("\n".join([head, *rows[:: 1 if name == "springpot" else 8]]) + "\n")
    done = judged(folder, sparse)
    assert done.returncode == 0, done.stdout + done.stderr
    drag = head.split(",").index("friction_force [N/m]")
    wrong = [row.split(",") for row in rows[:: 1 if name == "springpot" else 8]]
    for cells in wrong:
        cells[drag] = repr(1.1 * float(cells[drag]))
    off = tmp_path / "wrong.csv"
    off.write_text("\n".join([head, *map(",".join, wrong)]) + "\n")
    assert judged(folder, off).returncode == 1


def test_a_point_contact_is_found_to_disagree(folders):
    folder = folders / "point-contact"
    subprocess.run([sys.executable, "-W", "error", folder / "simulate.py"], check=True)
    text = (folder / "point-contact.csv").read_text().splitlines()
    data = np.array([[float(cell) for cell in row.split(",")] for row in text[1::20]])
    found = kv.compare(kv.problem("point-contact"), data=dict(zip(
        ("time", "depth", "normal_force", "friction_force"), (data * [1, -1, 1, 1]).T, strict=True
    )))  # fmt: skip
    failed = {check.name for check in found.checks if check.ok is False}
    assert found.verdict == "disagrees"
    assert "depth, largest" in failed
    assert Path(reference_problems.DRIVERS).is_dir()
