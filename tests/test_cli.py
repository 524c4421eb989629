"""The commands as a shell runs them: what they print and write, their mistakes and their exit status."""

import json
import os
import shlex
import subprocess
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import click
import numpy as np
import pytest
from matplotlib.figure import Figure

import kvtheory as kv
from kvtheory.cli import main
from kvtheory.results import STEADY_UNITS
from tests import REFUSALS
from tests.commands import printed, python, refused, run


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    path = tmp_path_factory.mktemp("data") / "data.csv"
    short = kv.Scene(run=kv.Run(0.02))
    kv.transient(short, at=[0.001 * i for i in range(21)], certify=False).to_csv(path)
    return path.read_bytes()


@pytest.fixture
def place(tmp_path, monkeypatch, table):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "data.csv").write_bytes(table)
    return tmp_path / "here"


# Help


def commands(group=main, path="kvtheory"):
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, f"{path} {name}")
        else:
            yield f"{path} {name}", command


COMMANDS = dict(commands())
SLOW = {
    "charts.failures.findings": lambda _: [],
    "charts.stability.stability_maps": lambda **_: {"velocity": (), "step": ()},
    "plots.failures.draw_stability": lambda *_: Figure(),
    "charts.collection.measure": lambda *_, **__: (),
    "plots.work_precision.save_work_precision": lambda *_: None,
    "plots.files.save_picture": lambda *_, **__: None,
}
"""What takes long, and what stands for it."""


def test_the_list_of_commands_cuts_no_description_off():
    for arguments in ([], ["chart"]):
        assert "..." not in run(*arguments, "--help").stdout.split("Commands:")[1]


DMA = Path(__file__).parents[1] / "docs" / "data" / "dma"


@pytest.mark.parametrize("name", COMMANDS)
def test_help_ends_with_an_example_that_runs(name, place, monkeypatch):
    """Some do without what takes long; the example of `derive` runs in `test_derive_cli`."""
    example = COMMANDS[name].example
    assert run(*name.split()[1:], "--help").stdout.endswith(f"Example:\n  {example}\n")
    (place / "my-scene.toml").write_text(kv.to_toml(kv.Scene()))
    (place / "mine.csv").write_bytes((place.parent / "data.csv").read_bytes())
    (place / "run.csv").write_bytes((place.parent / "data.csv").read_bytes())
    (place / "dma.csv").write_bytes((DMA / "time_user_raw.csv").read_bytes())
    (place / "mine.mplstyle").write_text("font.size: 9")
    (place / "mu.csv").write_text(
        "V [m/s],mu\n1e-3,0.0010\n1e-2,0.0099\n0.1,0.0857\n1,0.0662\n3,0.0390\n"
    )
    for replaced, by in SLOW.items():
        monkeypatch.setattr(f"kvtheory.{replaced}", by)
    for line in example.split(" && ") if name != "kvtheory derive" else ():
        call, _, file = line.partition(" >")
        assert call.startswith(name)
        shown = run(*shlex.split(call)[1:]).stdout
        if file:
            Path(file.strip("> ")).write_text(shown)


# What is printed


def test_scene_checks_a_file(place):
    Path("scene.toml").write_text(run("scene", "--support", "suspended").stdout, encoding="utf-8")
    shown = run("scene", "scene.toml").stdout
    assert "suspended support" in shown
    assert "support_number" in shown
    record = printed("scene", "scene.toml")
    assert record["support_stiffness"] == 3e7
    assert record["damping"] == 1e9
    assert record["drive_number"] == pytest.approx(4.0812765)
    for method in ("exact", "quadrature", "asymptote"):
        record = printed("steady", "scene.toml", "--method", method)
        assert record == kv.steady(kv.load_scene("scene.toml"), method=method).as_dict()
        others = {"model", "certificate", "stable", "notes", "pressure_field"}
        assert {*STEADY_UNITS, *others} == set(record)


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
CASES = [(0.01, 3e10, 1.0, 1e-3), (0.02, 4e10, 2.0, 1.0)]
"""Radius, stiffness of the first arm, load and velocity of both scenes."""


def test_a_scene_of_arrays_is_many_scenes(place):
    path, table = place / "many.toml", place / "many.csv"
    path.write_text(ARRAYS, encoding="utf-8")
    scene = kv.load_scene(path)
    path.write_text(kv.to_toml(scene), encoding="utf-8")
    assert kv.load_scene(path) == scene
    forces = printed("steady", "many.toml")["friction_force"]
    for force, (radius, glassy, load, velocity) in zip(forces, CASES, strict=True):
        rubber = kv.GeneralizedMaxwell(1e10, arms=[(glassy, 0.01), (5e9, 1.0)])
        one = kv.Scene(kv.Sphere(radius), rubber, kv.DeadWeight(load=load), kv.Drive(velocity))
        assert force == kv.steady(one).friction_force
    for _ in range(2):  # the second time it replaces its own file
        shown = run("steady", "many.toml", "-o", "many.csv").stdout
    keys = ["indenter.radius [m]", "foundation.arms[0].stiffness [N/m^3]", "support.load [N]"]
    assert all(key in shown for key in keys)
    assert table.read_text("utf-8").startswith(",".join([*keys, "drive.velocity [m/s],depth [m]"]))


def test_a_check_shows_the_numbers_of_many_scenes_in_their_shape(place):
    path, ones = place / "many.toml", []
    path.write_text(ARRAYS, encoding="utf-8")
    for radius, glassy, load, velocity in CASES:
        rubber = kv.GeneralizedMaxwell(1e10, arms=[(glassy, 0.01), (5e9, 1.0)])
        one = kv.Scene(kv.Sphere(radius), rubber, kv.DeadWeight(load=load), kv.Drive(velocity))
        (place / "one.toml").write_text(kv.to_toml(one), encoding="utf-8")
        ones.append(printed("scene", "one.toml"))
    found = printed("scene", "many.toml")
    for name, both in {name: [one[name] for one in ones] for name in ones[0]}.items():
        assert np.array_equal(found[name], both) or found[name] == both[0] == both[1], name
    lines = dict(
        line.split("  ", 1)
        for line in run("scene", "many.toml").stdout.splitlines()
        if "  " in line
    )
    assert lines["radius"].strip() == "0.01 … 0.02"
    assert "2 scenes; sphere" in run("scene", "many.toml").stdout
    law = ["temperature", "reference_temperature"]
    thermal = [f"foundation.{key}=20 degC" for key in law] + [
        "foundation.activation_energy=80 kJ/mol"
    ]
    thermal[0] = 'foundation.temperature=["20 degC", "30 degC"]'
    warm = printed("scene", *(part for each in thermal for part in ("--set", each)))
    assert warm["shift_factor"] == pytest.approx([1.0, 0.33868], rel=1e-5)


def test_commands_take_ranges_and_refuse_them_over_time():
    many = ("--set", "drive.velocity=1 mm/s:1 m/s:50:log")
    lines = run("steady", *many).stdout.splitlines()
    assert "21 of 50 scenes; --json prints all" in lines
    assert [line.split()[0] for line in lines[3:24:10]] == ["0.001", "0.0294705", "1"]
    few = run("steady", "--set", "drive.velocity=1 mm/s:1 m/s:31:log").stdout.splitlines()
    assert [line.split()[0] for line in few[3:35:30]] == ["0.001", "1"]
    assert not any("of 31 scenes" in line for line in few)
    pair = "stability", "--set", "drive.velocity=91 mm/s", "--set", "drive.stiffness=1 MN/m^2"
    rates = [line.split()[:2] for line in run(*pair).stdout.splitlines()[-5:-2]]
    assert [frequency for _, frequency in rates] == ["4.85237", "0", "0"]
    stable = run("stability", *many, "--set", "drive.stiffness=1 MN/m^2").stdout
    assert stable.splitlines()[2].startswith("drive.velocity [m/s]  stable  critical_stiffness")
    assert "V = 1 … 1000 mm/s" in run("asymptotes", *many).stdout
    for command in ("transient", "elements", "compare"):
        refused([command, *many], ["arrays (drive.velocity); use `sweep`"])


def test_tables_are_in_the_units_of_the_paper_and_a_large_error_stands_above():
    shown = {
        line.split()[0]: line.split()[1:3] for line in run("steady").stdout.splitlines() if line
    }
    assert shown["depth"] == ["0.0896613", "mm"]
    series = run("transient", "--at", "0 ms,1 ms").stdout.splitlines()
    assert series[0].split("  ")[0] == "time [ms]"
    depth = kv.transient(at=["0 ms", "1 ms"]).depth[1]
    assert series[2].split()[:3] == ["1", "100", f"{1e3 * depth:.6g}"]
    lines = run("elements", "--per-length", "5 /mm", "--at", "1 ms,10 ms").stdout.splitlines()
    assert lines[0].startswith("! Large error")
    assert "peak_pressure" in lines[0]
    assert "--per-length" in lines[0]
    assert lines[1].startswith("time [ms]")
    assert run("elements", "--at", "10 ms").stdout.startswith("time [ms]")


def test_overrides_and_a_history():
    assert printed("steady", "--set", 'drive.velocity="-50 mm/s"')["friction_force"] < 0
    assert printed("steady", "--set", "support.kind=fixed")["depth"] == 3e-4
    history = 'drive.history=[["0 s", "1 m/s"], ["1 s", "20 mm/s"]]'
    for command in ("steady", "asymptotes", "stability"):
        assert "final velocity, 20 mm/s" in run(command, "--set", history).stdout
        printed(command, "--set", history)


def test_asymptotes_and_series_are_printed():
    shown = run("asymptotes", "--tolerance", "0.1").stdout
    assert shown == f"dead-weight support, {kv.asymptotes(tolerance=0.1)}\n"
    assert "use L2" in shown
    assert "friction maximum" in shown
    record = printed("asymptotes")
    assert record["use"] == "exact"
    assert record["critical_velocity"] == pytest.approx(0.0205805, rel=1e-5)
    at_rest = ("asymptotes", "--set", "drive.velocity=0 m/s")
    assert printed(*at_rest)["lines"][3]["value"] is None
    assert "nan" not in run(*at_rest).stdout
    record = printed("transient", "--at", "0 ms, 1 ms,200 ms")
    assert record["time"] == [0.0, 0.001, 0.2]
    assert record["normal_force"] == pytest.approx([35367.19, 12732.9, 9806.65], rel=1e-4)
    shown = run("transient").stdout
    assert "right edge peels" in shown
    assert "nan" not in shown


def test_an_option_of_a_list_may_be_repeated():
    for path, command in commands():
        for option in command.params:
            listed = isinstance(option, click.Option) and "," in (option.metavar or "")
            assert not listed or option.multiple, (path, option.name)
    record = printed("solve", "--quantity", "load,depth", "--quantity", "peak_pressure")
    assert list(record)[:3] == ["load", "depth", "peak_pressure"]
    assert printed("elements", "--at", "0 ms, 1 ms", "--at", "2 ms")["time"] == [0.0, 0.001, 0.002]


def test_citing_names_version_and_paper():
    told = run("cite").stdout
    assert f"version = {{{kv.__version__}}}" in told
    assert "10.3389/fmech.2020.00038" in told
    assert told.count("@") == 2
    assert told.count("{") == told.count("}")


# Mistakes

WEDGE = ["--set", "indenter.shape=wedge", "--set", "indenter.inclination=0.1"]
MODULES = {
    "exits": "raise SystemExit(0)", "fails": "1/0", "imports": "import no_such",
    "misspelt": "syntax error", "empty": "",
}  # fmt: skip


ARMS = """--set 'foundation.arms=[["30 GN/m^3", "10 ms"]]'"""
ONE = "sweep -o a.csv --over 'drive.velocity=1 m/s'"
BAD = [(line.replace("$ARMS", ARMS), words) for line, *words in REFUSALS["shell"]["commands"]]
BAD += [
    (f"$ONE --executor {name}", [f'--executor "{name}"']) for name in REFUSALS["shell"]["executors"]
]


@pytest.mark.parametrize(("line", "words"), BAD)
def test_bad_input_costs_one_message_and_status_2(line, words, place, monkeypatch):
    """Nothing is written, and what Python calls an argument is an option there."""
    (place.parent / "modules").mkdir()
    for name, code in MODULES.items():
        (place.parent / "modules" / f"{name}.py").write_text(code)
    monkeypatch.syspath_prepend(str(place.parent / "modules"))
    (place / "folder.html").mkdir()
    told = refused(shlex.split(line.replace("$ONE", ONE)), words)
    assert "`" not in told.replace("`kinds`", "") or not words[0].startswith("--")
    assert [path.name for path in place.iterdir()] == ["folder.html"]
    for name in MODULES:
        sys.modules.pop(name, None)


def test_all_mistakes_of_a_scene_are_listed_once(place):
    text = '[indenter]\nradius = 10\n[fundation]\n[support]\nkind = "fixed"\n'
    Path("scene.toml").write_text(text, encoding="utf-8")
    message = refused(["steady", "scene.toml"], [])
    for key in ("indenter.radius", "[fundation]", "support.depth", "[drive]"):
        assert message.count(key) == 1
    assert message.startswith("kvtheory: 4 mistakes")


def test_an_interrupt_is_130_and_nothing_but_disagreement_is_1(monkeypatch, place):
    errors = {MemoryError: 2, TypeError: 70, RecursionError: 2, KeyError: 70, ArithmeticError: 2}
    cases = [("steady", *case) for case in errors.items()]
    names = ("transient", "steady", "elements", "solve", "asymptotes")
    for name, error, status in [*((name, KeyboardInterrupt, 130) for name in names), *cases]:

        def failing(*_, error=error, **__):
            raise error

        with monkeypatch.context() as patch:
            patch.setattr(f"kvtheory.api.{name}", failing)
            told = run(name, status=status).stderr
            assert ("interrupted" in told) == (status == 130)
            assert ("Traceback" in told) == (status == 70)
    for verdict, status in {"agrees": 0, "cannot tell": 0, "disagrees": 1}.items():
        found = kv.Comparison(verdict, (), "", (), "data", 1.0, {}, {}, {})
        monkeypatch.setattr("kvtheory.api._compare.compare", lambda *_, found=found, **__: found)
        assert json.loads(run("compare", "--json", status=status).stdout)["verdict"] == verdict


# Files

FOREIGN = b"precious,data\n1,2\n"
SHORT = ["--at", "0 ms,1 ms"]
OVER = ["--over", "drive.velocity=1 mm/s,1 m/s"]
DATA = ["--data", "../data.csv", "--set", "run.duration=20 ms"]
OUTPUTS = {
    "transient -o a.csv": SHORT,
    "transient -o a.nc": SHORT,
    "transient --plot a.png": SHORT,
    "transient --plot a.svg": SHORT,
    "elements -o a.csv": ["--per-length", "20 /mm", *SHORT],
    "solve -o a.csv": SHORT,
    "solve --plot a.png": SHORT,
    "steady -o a.csv": [],
    "steady --plot a.svg": [],
    "stability -o a.csv": [],
    "stability --plot a.svg": [],
    "sweep -o a.csv": OVER,
    "sweep -o a.nc": OVER,
    "sweep --plot a.pdf": [*OVER, "-o", "b.csv"],
    "compare --report a.html": DATA,
    "compare --plot a.png": DATA,
    "derive -o derivations.md": ["--only", "eq3", "--format", "md"],
    "derive -o derivations.tex": ["--only", "eq3", "--format", "tex"],
    "chart failures -o a.html": ["--only", "cancellation"],
}
ALIKE = {
    "compare --plot a.png",
    "solve --plot a.png",
    "transient --plot a.svg",
    "compare --report a.html",
}
"""Those whose files begin as others do."""


@pytest.mark.parametrize("name", OUTPUTS)
def test_files_of_another_kind_are_left_alone_unless_told(place, name):
    *command, option, file = name.split()
    path = place / file
    arguments = [*command, option, "." if command == ["derive"] else file, *OUTPUTS[name]]
    path.write_bytes(FOREIGN)
    assert "overwrite" in refused(arguments, [f'"{file}"'])
    assert path.read_bytes() == FOREIGN
    assert list(place.iterdir()) == [path]
    run(*arguments, "--overwrite")
    assert path.read_bytes() != FOREIGN
    if name not in ALIKE:
        run(*arguments)  # what the command wrote itself it may replace, or has nothing left to do
    if name in ("transient -o a.csv", "steady --plot a.svg"):
        path.write_bytes(b"")  # an empty file is free
        run(*arguments)


@pytest.mark.parametrize(
    "arguments",
    [
        ["steady", "-o", "a.csv", "--plot", "a.png", *WEDGE],
        ["compare", *DATA, "--plot", "a.png", "--report", "a.html"],
        ["chart", "stability", "--quick", "-o", "a.png"],
    ],
)  # fmt: skip
def test_all_outputs_are_written_or_none(place, monkeypatch, arguments):
    """The first is refused by its result; of the others the second file cannot be made."""

    def refuse(*_):
        raise ValueError("cannot be made")

    monkeypatch.setattr("kvtheory.plots.comparison.save_comparison_report", refuse)
    monkeypatch.setattr("kvtheory.plots.files.save_page", refuse)
    for replaced, by in SLOW.items():
        monkeypatch.setattr(f"kvtheory.{replaced}", by)
    run(*arguments, status=2)
    assert list(place.iterdir()) == []


@pytest.mark.parametrize("more", [[], ["--overwrite"]])
def test_what_is_read_is_never_written_over(place, more):
    Path("in.csv").write_text(kv.to_toml(kv.Scene()))
    Path("link.csv").symlink_to(place / "in.csv")
    Path("drive.csv").write_text("t [ms],V [mm/s]\n0,10\n5,20\n")
    before = {path.name: path.read_bytes() for path in place.iterdir()}
    for arguments in (
        ["transient", "in.csv", "-o", "in.csv"],
        ["transient", "in.csv", "-o", "./in.csv"],
        ["transient", "in.csv", "-o", "link.csv"],
        ["elements", "in.csv", "-o", "in.csv"],
        ["solve", "in.csv", "-o", "in.csv"],
        ["sweep", "in.csv", *OVER, "-o", "in.csv"],
        ["transient", "--set", "drive.file=drive.csv", "-o", "drive.csv"],
    ):
        refused([*arguments, *more], ["is what this command reads"])
    assert {path.name: path.read_bytes() for path in place.iterdir()} == before


def test_a_picture_that_cannot_be_drawn_is_refused_before_the_sweep(place):
    three = [*OVER, "--over", "support.mass=1 kg/m,2 kg/m", "--over", "indenter.radius=1 mm,2 mm"]
    to = ["-o", "a.csv", "--plot", "a.png"]
    refused(["sweep", *three, *to], ["two dimensions"])
    refused(["sweep", *OVER, "--quantity", "events", *to], ["nothing can be drawn"])
    assert not list(place.iterdir())


@pytest.mark.parametrize("stem", ["a$b$ c^2", "d{e}_g%s", "ä ö [x]"])
def test_names_with_signs_are_names_and_capital_endings_are_endings(place, stem):
    run("steady", "-o", f"{stem}.CSV", "--plot", f"{stem}.PNG")
    run("sweep", *OVER, "-o", f"{stem}-map.CSV", "--plot", f"{stem}-map.svg")
    assert len(list(place.iterdir())) == 4
    assert Path(f"{stem}.CSV").read_bytes().startswith(b"depth [m]")
    assert Path(f"{stem}.PNG").read_bytes().startswith(b"\x89PNG")
    assert Path(f"{stem}-map.CSV").read_bytes().startswith(b"# kvtheory sweep")


def test_a_read_only_directory_is_refused_before_the_work_by_the_name_of_the_file(
    place, monkeypatch
):
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
    for command in (["transient", *SHORT], ["sweep", *OVER]):
        told = refused([*command, "-o", "a.csv"], ['"a.csv" cannot be written', "read-only"])
        assert ".part" not in told


def test_threads_may_write_one_file(place):
    state = kv.steady(over={"drive.velocity": np.geomspace(0.01, 1.0, 50)})
    with ThreadPoolExecutor(10) as pool:
        list(pool.map(lambda _: state.to_csv("a.csv"), range(50)))
    assert [path.name for path in place.iterdir()] == ["a.csv"]


def test_an_epoch_that_is_no_time_costs_one_message(place, monkeypatch):
    for epoch in ("x", "9" * 30):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
        refused(["steady", "--plot", "a.svg"], ["SOURCE_DATE_EPOCH", epoch[:20], "whole number"])
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1")
    run("steady", "--plot", "a.svg")


# Streams


def shell(line, **environment):
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {line.replace('kvtheory', f'{sys.executable} -m kvtheory')}"],
        capture_output=True, check=False, env={"PATH": os.defpath, **environment},
        cwd=kv.__path__[0] + "/..",
    )  # fmt: skip
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(
    ("line", "statuses"),
    [
        ("kvtheory compare --json | true", {0, 141}),  # a reader that goes away is no disagreement
        ("kvtheory transient --json --at '0 ms:200 ms:3000' | head -c 1", {141}),
        ("kvtheory steady 2>&-", {0}),
        ("kvtheory steady >&- 2>&-", {0, 2, 141}),
        ("kvtheory steady > /dev/full", {2}),
        ("kvtheory steady --set a=b 2> /dev/full", {2}),
        ("kvtheory nope 2> /dev/full", {2}),
    ],
)
def test_streams_that_are_closed_or_full_end_in_no_traceback(line, statuses):
    status, _, message = shell(line)
    assert status in statuses
    assert message == (
        b"kvtheory: error: the output cannot be written: No space left on device\n"
        if line.endswith(" > /dev/full") else b""
    )  # fmt: skip


def test_output_never_dies_of_the_encoding_of_the_console(tmp_path):
    scene = tmp_path / "größe-µ-日本.toml"
    scene.write_text(kv.to_toml(kv.Scene()), encoding="utf-8")
    line = f"kvtheory asymptotes '{scene}' --set 'drive.velocity=1 mm/s:1 m/s:3'"
    status, out, message = shell(line, PYTHONIOENCODING="ascii", LC_ALL="C.UTF-8")
    assert (status, message) == (0, b""), message
    assert b"V = 1 " in out
    line = f"kvtheory steady --set 'support.mass=5 µq' '{scene}'"
    status, _, message = shell(line, PYTHONIOENCODING="cp1252", LC_ALL="C.UTF-8")
    assert (status, b"support.mass" in message) == (2, True), message


def test_warnings_read_as_messages():
    run("cite")
    shown = warnings.formatwarning("compiled anew", RuntimeWarning, "x.py", 1)
    assert shown == "kvtheory: warning: compiled anew\n"


INTERRUPTED = """
import builtins, sys
import kvtheory.__main__ as entry
assert "numpy" not in sys.modules and "typing" not in sys.modules  # whose imports could be interrupted
genuine = builtins.__import__
def stopped(name, *rest, **how):
    if name == "numpy":
        raise KeyboardInterrupt
    return genuine(name, *rest, **how)
builtins.__import__ = stopped
sys.argv = ["kvtheory", "steady"]
entry.command()
"""


def test_an_interrupt_during_the_imports_is_a_message_too():
    done = subprocess.run(
        [sys.executable, "-S", "-c", INTERRUPTED], capture_output=True, text=True, check=False,
        env={"PATH": os.defpath, "PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "kvtheory: interrupted\n")


@pytest.mark.parametrize(
    "words",
    [
        ("sweep", "--quantity", "depth,,load", "--over", "drive.velocity=1 m/s", "-o", "s.csv"),
        ("sweep", "--over", "drive.velocity=1 mm/s,,2 mm/s", "-o", "s.csv"),
        ("solve", "--quantity", "depth,,load"),
        ("transient", "--at", "1 ms,,2 ms"),
        ("chart", "failures", "--only", "hop,,gap"),
        ("chart", "work-precision", "--standard", "hop,,rubber"),
        ("derive", "--only", "eq27,,F3"),
        ("fit", "--data", __file__, "--free", "foundation.stiffness,,indenter.radius"),
    ],
)
def test_an_empty_item_of_a_list_is_a_mistake(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(
        words,
        ["item 2 of the list is empty; expected at least one item, and one comma between two"],
    )
    assert not list(tmp_path.iterdir())


def test_nothing_numerical_is_imported_before_a_command_has_chosen_its_threads():
    code = "import sys, kvtheory.cli.chart; print(sys.modules.keys() & {'numpy', 'scipy'})"
    assert python("-c", code).strip() == "set()"
