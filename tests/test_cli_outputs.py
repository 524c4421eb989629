"""What commands write: never over what they read, over other kinds of files only when told."""

import subprocess
import sys

import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

import kvtheory as kv
from kvtheory.cli import main

FOREIGN = b"precious,data\n1,2\n"
SHORT = ["--at", "0 ms,1 ms"]
OVER = ["--over", "drive.velocity=1 mm/s,1 m/s"]
COMMANDS = {
    "transient -o a.csv": ["transient", *SHORT, "-o", "a.csv"],
    "transient -o a.nc": ["transient", *SHORT, "-o", "a.nc"],
    "transient --plot a.png": ["transient", *SHORT, "--plot", "a.png"],
    "transient --plot a.svg": ["transient", *SHORT, "--plot", "a.svg"],
    "elements -o a.csv": ["elements", "--per-length", "20 /mm", *SHORT, "-o", "a.csv"],
    "solve -o a.csv": ["solve", *SHORT, "-o", "a.csv"],
    "solve --plot a.png": ["solve", *SHORT, "--plot", "a.png"],
    "steady -o a.csv": ["steady", "-o", "a.csv"],
    "steady --plot a.svg": ["steady", "--plot", "a.svg"],
    "sweep -o a.csv": ["sweep", *OVER, "-o", "a.csv"],
    "sweep -o a.nc": ["sweep", *OVER, "-o", "a.nc"],
    "sweep --plot a.pdf": ["sweep", *OVER, "-o", "b.csv", "--plot", "a.pdf"],
    "compare --report a.html": ["compare", "--data", "../data.csv", "--report", "a.html"],
    "compare --plot a.png": ["compare", "--data", "../data.csv", "--plot", "a.png"],
    "derive into derivations.md": ["derive", "-o", ".", "--only", "eq27", "--format", "md"],
    "derive into derivations.tex": ["derive", "-o", ".", "--only", "eq27", "--format", "tex"],
    "failures -o a.html": ["chart", "failures", "--only", "cancellation", "-o", "a.html"],
}


def run(*arguments, status=0):
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == status, result.output
    return result


@pytest.fixture
def place(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    times = [0.002 * i for i in range(101)]
    kv.transient(at=times, certify=False).to_csv(tmp_path / "data.csv")
    return tmp_path / "here"


@pytest.mark.parametrize(
    "arguments",
    [
        ["steady", "-o", "a.csv", "--plot", "a.png", "--set", "indenter.shape=wedge",
         "--set", "indenter.inclination=0.1"],
        ["compare", "--data", "../data.csv", "--plot", "a.png", "--report", "a.html"],
        ["chart", "stability", "--quick", "-o", "a.png"],
    ],
)  # fmt: skip
def test_all_outputs_are_written_or_none(place, monkeypatch, arguments):
    """The first is refused by its result; of the others the second file cannot be made."""
    from kvtheory.charts import stability
    from kvtheory.plots import comparison, files

    def refuse(*_):
        raise ValueError("cannot be made")

    monkeypatch.setattr(comparison, "save_comparison_report", refuse)
    monkeypatch.setattr(files, "save_page", refuse)
    monkeypatch.setattr(stability, "stability_maps", lambda **_: {"velocity": (), "step": ()})
    monkeypatch.setattr("kvtheory.plots.stability.draw_stability", lambda *_: Figure())
    run(*arguments, status=2)
    assert list(place.iterdir()) == []


@pytest.mark.parametrize("name", COMMANDS)
def test_files_of_another_kind_are_left_alone_unless_told(place, name):
    arguments, path = COMMANDS[name], place / name.split()[2]
    path.write_bytes(FOREIGN)
    message = run(*arguments, status=2).stderr
    assert f'"{path.name}"' in message
    assert "overwrite" in message
    assert path.read_bytes() == FOREIGN
    assert list(place.iterdir()) == [path]
    run(*arguments, "--overwrite")
    assert path.read_bytes() != FOREIGN
    run(*arguments)  # what the command wrote itself it may replace, or has nothing left to do


@pytest.mark.parametrize("name", COMMANDS)
def test_an_empty_file_is_free(place, name):
    (place / name.split()[2]).touch()
    if not name.startswith("sweep -o"):
        run(*COMMANDS[name])


@pytest.mark.parametrize("more", [[], ["--overwrite"]])
@pytest.mark.parametrize(
    "arguments",
    [
        ["transient", "in.csv", "-o", "in.csv"],
        ["transient", "in.csv", "-o", "./in.csv"],
        ["transient", "in.csv", "-o", "link.csv"],
        ["elements", "in.csv", "-o", "in.csv"],
        ["solve", "in.csv", "-o", "in.csv"],
        ["sweep", "in.csv", *OVER, "-o", "in.csv"],
    ],
)
def test_what_is_read_is_never_written_over(place, arguments, more):
    scene = place / "in.csv"
    scene.write_text(kv.to_toml(kv.Scene()))
    (place / "link.csv").symlink_to(scene)
    before = scene.read_bytes()
    assert "is what this command reads" in run(*arguments, *more, status=2).stderr
    assert scene.read_bytes() == before


@pytest.mark.parametrize("more", [[], ["--overwrite"]])
def test_the_table_of_a_drive_is_read_too(place, more):
    table = place / "in.csv"
    table.write_text("t [ms],V [mm/s]\n0,10\n5,20\n")
    arguments = ["transient", "--set", "drive.file=in.csv", "-o", "in.csv", *more]
    assert "is what this command reads" in run(*arguments, status=2).stderr
    assert table.read_text().startswith("t [ms],V")


def test_a_picture_that_cannot_be_drawn_is_refused_before_the_sweep(place):
    three = [*OVER, "--over", "support.mass=1 kg/m,2 kg/m", "--over", "indenter.radius=1 mm,2 mm"]
    assert (
        "two dimensions" in run("sweep", *three, "-o", "a.csv", "--plot", "a.png", status=2).stderr
    )
    texts = [*OVER, "--quantity", "events", "-o", "a.csv", "--plot", "a.png"]
    assert "nothing can be drawn" in run("sweep", *texts, status=2).stderr
    assert not list(place.iterdir())


@pytest.mark.parametrize("stem", ["a$b$", "c^2", "d{e}", "f_g%s", "ä ö", "[x]"])
def test_names_with_signs_are_names(place, stem):
    run("transient", *SHORT, "-o", f"{stem}.csv", "--plot", f"{stem}.png")
    run("sweep", *OVER, "-o", f"{stem}-map.csv", "--plot", f"{stem}-map.svg")
    assert len(list(place.iterdir())) == 4


def test_capital_endings_are_endings(place):
    run("transient", *SHORT, "-o", "A.CSV", "--plot", "A.PNG")
    run("sweep", *OVER, "-o", "B.CSV")
    assert (place / "A.CSV").read_bytes().startswith(b"time [s]")
    assert (place / "B.CSV").read_bytes().startswith(b"# kvtheory sweep")


def shell(line, **environment):
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {line.replace('kvtheory', f'{sys.executable} -m kvtheory')}"],
        capture_output=True, check=False, env={"PATH": "/usr/bin:/bin", **environment},
        cwd=kv.__path__[0] + "/..",
    )  # fmt: skip
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("command", ["steady", "transient", "compare --help", "asymptotes --json"])
def test_a_reader_that_goes_is_no_mistake(command):
    status, _, message = shell(f"kvtheory {command} | true")
    assert message == b""
    assert status in (0, 141)


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "> /dev/full"])
def test_closed_streams_end_in_no_traceback(closed):
    status, _, message = shell(f"kvtheory steady {closed}")
    assert b"Traceback" not in message
    assert status in (0, 2, 141)


@pytest.mark.parametrize("command", ["steady --set a=b", "steady --nope", "nope"])
def test_bad_input_is_2_also_where_nothing_can_be_told(command):
    assert shell(f"kvtheory {command} 2> /dev/full")[0] == 2


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252", "utf-8"])
def test_output_never_dies_of_the_encoding_of_the_console(encoding, tmp_path):
    scene = tmp_path / "größe-µ-日本.toml"
    scene.write_text(kv.to_toml(kv.Scene()), encoding="utf-8")
    commands = [
        f"kvtheory steady '{scene}'",
        f"kvtheory scene '{scene}'",
        "kvtheory chart failures --only cancellation",
    ]
    for line in commands:
        status, out, message = shell(line, PYTHONIOENCODING=encoding, LC_ALL="C.UTF-8")
        assert (status, message) == (0, b""), message
        assert out
    status, _, message = shell(
        f"kvtheory steady --set 'support.mass=5 µq' '{scene}'",
        PYTHONIOENCODING=encoding, LC_ALL="C.UTF-8",
    )  # fmt: skip
    assert (status, b"support.mass" in message) == (2, True), message


def test_an_interrupt_is_130_and_nothing_but_disagreement_is_1(monkeypatch, place):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    for name in ("transient", "steady", "elements", "solve", "asymptotes"):
        with monkeypatch.context() as patch:
            patch.setattr(f"kvtheory.api.{name}", interrupted)
            assert "interrupted" in run(name, status=130).stderr
    errors = {MemoryError: 2, TypeError: 70, RecursionError: 2, KeyError: 70, ArithmeticError: 2}
    for error, status in errors.items():

        def failing(*_, error=error, **__):
            raise error

        with monkeypatch.context() as patch:
            patch.setattr("kvtheory.api.steady", failing)
            run("steady", status=status)
