"""The commands, as a shell runs them."""

import json

import pytest
from click.testing import CliRunner

import kvtheory as kv
from kvtheory.cli import main
from kvtheory.results import STEADY_UNITS


def run(*arguments, status=0):
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == status, result.output
    assert "Traceback" not in result.output
    return result


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(run("scene", "--support", "suspended").stdout, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("command", ["scene", "steady", "asymptotes", "derive", "transient"])
def test_every_command_has_help_with_an_example(command):
    shown = run(command, "--help").stdout
    assert f"kvtheory {command}" in shown.split("Example")[1]


def test_scene_checks_a_file(scene_file):
    shown = run("scene", scene_file).stdout
    assert "suspended support" in shown
    assert "support_number" in shown
    record = json.loads(run("scene", scene_file, "--json").stdout)
    assert record["support_stiffness"] == 3e7
    assert record["damping"] == 1e9
    assert record["drive_number"] == pytest.approx(4.0812765)


@pytest.mark.parametrize("method", ["exact", "quadrature", "asymptote"])
def test_steady_prints_one_json_object_in_si(scene_file, method):
    record = json.loads(run("steady", scene_file, "--json", "--method", method).stdout)
    state = kv.steady(kv.load_scene(scene_file), method=method)
    assert record == state.as_dict()
    assert set(STEADY_UNITS) | {"model", "certificate", "stable", "notes"} == set(record)


ARRAYS = """
[indenter]
shape = "sphere"
radius = ["10 mm", "20 mm"]
[foundation]
kind = "generalized-maxwell"
stiffness = "10 GN/m^3"
arms = [[["30 GN/m^3", "40 GN/m^3"], "10 ms"], ["5 GN/m^3", "1 s"]]
[support]
kind = "dead-weight"
load = ["1 N", "2 N"]
[drive]
velocity = "1 mm/s:1 m/s:2:log"
"""


def test_a_scene_of_arrays_is_many_scenes(tmp_path):
    path, table = tmp_path / "many.toml", tmp_path / "many.csv"
    path.write_text(ARRAYS, encoding="utf-8")
    scene = kv.load_scene(path)
    text = kv.to_toml(scene)
    path.write_text(text, encoding="utf-8")
    assert kv.load_scene(path) == scene
    record = json.loads(run("steady", str(path), "--json").stdout)
    for i, (radius, glassy, load, velocity) in enumerate(
        [(0.01, 3e10, 1.0, 1e-3), (0.02, 4e10, 2.0, 1.0)]
    ):
        one = kv.Scene(
            kv.Sphere(radius), kv.GeneralizedMaxwell(1e10, arms=[(glassy, 0.01), (5e9, 1.0)]),
            kv.DeadWeight(load=load), kv.Drive(velocity),
        )  # fmt: skip
        assert record["friction_force"][i] == kv.steady(one).friction_force
    shown = run("steady", str(path), "-o", str(table)).stdout
    keys = ["indenter.radius [m]", "foundation.arms[0].stiffness [N/m^3]", "support.load [N]"]
    assert all(key in shown for key in keys)
    assert table.read_text("utf-8").startswith(",".join([*keys, "drive.velocity [m/s],depth [m]"]))


def test_commands_take_ranges_and_refuse_them_over_time():
    many = ("--set", "drive.velocity=1 mm/s:1 m/s:50:log")
    assert "21 of 50 scenes" in run("steady", *many).stdout
    stable = run("stability", *many, "--set", "drive.stiffness=1 MN/m^2").stdout
    assert stable.splitlines()[2].startswith("drive.velocity [m/s]  stable  critical_stiffness")
    assert "V = 1 … 1000 mm/s" in run("asymptotes", *many).stdout
    for command in ("transient", "elements", "compare", "scene"):
        told = run(command, *many, status=2).stderr
        assert "arrays (drive.velocity); use `sweep`" in told


def test_steady_prints_a_table_in_the_papers_units():
    lines = run("steady").stdout.splitlines()
    depth = next(line for line in lines if line.startswith("depth")).split()
    assert depth[1:3] == ["0.0896613", "mm"]


def test_a_large_error_stands_above_the_table():
    """With its quantities and its remedy; a good result has no such line."""
    lines = run("elements", "--per-length", "5 /mm", "--at", "1 ms,10 ms").stdout.splitlines()
    assert lines[0].startswith("! Large error")
    assert "peak_pressure" in lines[0]
    assert "--per-length" in lines[0]
    assert lines[1].startswith("time [ms]")
    assert run("elements", "--at", "10 ms").stdout.startswith("time [ms]")


def test_overrides():
    record = json.loads(run("steady", "--json", "--set", 'drive.velocity="-50 mm/s"').stdout)
    assert record["friction_force"] < 0
    fixed = json.loads(run("steady", "--json", "--set", "support.kind=fixed").stdout)
    assert fixed["depth"] == 3e-4


def test_asymptotes():
    shown = run("asymptotes", "--tolerance", "0.1").stdout
    assert shown == f"dead-weight support, {kv.asymptotes(tolerance=0.1)}\n"
    assert "use L2" in shown
    assert "friction maximum" in shown
    record = json.loads(run("asymptotes", "--json").stdout)
    assert record["use"] == "exact"
    assert record["critical_velocity"] == pytest.approx(0.0205805, rel=1e-5)
    at_rest = json.loads(run("asymptotes", "--json", "--set", "drive.velocity=0 m/s").stdout)
    assert at_rest["lines"][3]["value"] is None
    assert "nan" not in run("asymptotes", "--set", "drive.velocity=0 m/s").stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["steady", "no-such-file.toml"], ["no-such-file.toml", "does not exist"]),
        (["steady", "."], ["directory"]),
        (["steady", "--method", "exat"], ['"exat"', 'did you mean "exact"']),
        (
            ["steady", "--set", "drive.velocity=fast"],
            ["drive.velocity", '"fast"', "quantity in m/s"],
        ),
        (["steady", "--set", "drive.velocity=0.1"], ["drive.velocity", "no unit", "100 mm/s"]),
        (["steady", "--set", "drive.velocity"], ["KEY=VALUE"]),
        (["steady", "--set", "driv.velocity=1 m/s"], ["[driv]", 'did you mean "drive"']),
        (["steady", "--set", "support.depth=1 mm"], ["support.depth", "dead-weight"]),
        (["steady", "--set", "support.kind=floating"], ["support.kind", '"floating"', "fixed"]),
        (["asymptotes", "--tolerance", "0"], ["tolerance"]),
        (["asymptotes", "--tolerance", "little"], ["--tolerance", "little"]),
        (
            ["steady", "--set", "indenter.shape=circle", "--set", "indenter.radius=0.01 mm"],
            ["reach"],
        ),
        (["scene", "--support", "floating"], ["--support", "floating"]),
        (["scene", "--support", "fixed", "--json"], ["--support"]),
        (["stady"], ["stady"]),
    ],
)
def test_bad_input_costs_one_message_and_status_2(arguments, words):
    result = run(*arguments, status=2)
    assert result.stdout == ""
    for word in words:
        assert word in result.stderr, result.stderr


def test_a_history_is_mentioned():
    history = 'drive.history=[["0 s", "1 m/s"], ["1 s", "20 mm/s"]]'
    for command in ("steady", "asymptotes"):
        assert "final velocity, 20 mm/s" in run(command, "--set", history).stdout
        json.loads(run(command, "--json", "--set", history).stdout)


def test_all_mistakes_of_a_scene_are_listed_once(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        '[indenter]\nradius = 10\n[fundation]\n[support]\nkind = "fixed"\n', encoding="utf-8"
    )
    message = run("steady", str(path), status=2).stderr
    for key in ("indenter.radius", "[fundation]", "support.depth", "[drive]"):
        assert message.count(key) == 1
    assert message.startswith("kvtheory: 4 mistakes")


def test_transient_prints_series_and_writes_files(tmp_path):
    record = json.loads(run("transient", "--json", "--at", "0 ms, 1 ms,200 ms").stdout)
    assert record["time"] == [0.0, 0.001, 0.2]
    assert record["normal_force"] == pytest.approx([35367.19, 12732.9, 9806.65], rel=1e-4)
    shown = run(
        "transient", "-o", str(tmp_path / "a.csv"), "--plot", str(tmp_path / "a.png")
    ).stdout
    assert "right edge peels" in shown
    assert "nan" not in shown
    assert (tmp_path / "a.csv").read_text().startswith("time [s],velocity [m/s],depth [m]")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--at", "1 furlong"], ["at", "1 furlong", "quantity in s"]),
        (["--at", "5"], ["at", "no unit"]),
        (["--at", "1 s"], ["after the end", "run.duration"]),
        (["--rtol", "0"], ["rtol"]),
        (["-o", "a.xls"], ["a.xls", ".csv"]),
        (["--plot", "a.doc"], ["a.doc", ".png"]),
        (["-o", "no/such/place.csv"], ["no/such"]),
        (["--set", "indenter.shape=wedge", "--set", "indenter.inclination=0.1"], ["parabola only"]),
    ],
)
def test_bad_transient_input(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = run("transient", *arguments, status=2)
    assert result.stdout == ""
    for word in words:
        assert word in result.stderr, result.stderr
    assert not list(tmp_path.iterdir())
