"""Messages that teach: hints near in meaning, what was given, files in any encoding, no foreign words."""

import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
from click.testing import CliRunner

import kvtheory as kv
from kvtheory.cli import main
from kvtheory.results import QUANTITIES
from kvtheory.scene import template
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SUPPORTS
from kvtheory.scene.quantities import MEANT, closest, quantities

ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252", "latin-1")


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_scenes_and_drives_are_read_in_the_encodings_of_shells_and_spreadsheets(
    tmp_path, encoding, end
):
    text = template().replace('"10 mm"', '"10000 µm"') + "# größer, °, ²\n"
    path = tmp_path / "scene.toml"
    path.write_bytes(text.replace("\n", end).encode(encoding))
    assert kv.load_scene(path) == kv.Scene()
    table = tmp_path / "drive.csv"
    table.write_bytes(f"t [µs],V [mm/s]{end}0,0{end}1000,100{end}".encode(encoding))
    text = text.replace('velocity = "100 mm/s"', 'file = "drive.csv"')
    path.write_bytes(text.replace("\n", end).encode(encoding))
    assert kv.load_scene(path).drive.history == ((0.0, 0.0), (0.001, 0.1))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\xff\xfeA", r"scene\.toml is not a TOML file"),
        (b"\x00\x01\x02", r"scene\.toml is not a TOML file"),
        (b"\x81\x8d\x8f", r"scene\.toml is not a TOML file"),
        (b"PK\x03\x04\x00", r"scene\.toml is not a TOML file"),
        (b'[run]\nduration = "1 s"\nduration = "2 s"\n', r'line 3, .*: duration = "2 s"'),
    ],
)
def test_what_is_no_toml_is_told_with_its_name_or_its_line(tmp_path, content, words):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(kv.SceneError, match=words):
        kv.load_scene(path)


HOSTILE = {
    "nested": "[run]\nduration = " + "[" * 90_000,
    "nested and closed": "[run]\nduration = " + "[" * 150 + "]" * 150,
    "a key of two lines": '[run]\n"a\\nb" = 1',
    "a key that steers a terminal": '[run]\n"\\u001b[31m" = 1',
    "a long key": f"[run]\n{'k' * 5000} = 1",
    "many mistakes": "[run]\n" + "\n".join(f"k{i} = 1" for i in range(2000)),
    "a value that steers a terminal": '[run]\nduration = "5 ms\\u001b[31m"',
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_a_message_is_short_and_only_shown_whatever_a_file_holds(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    found = CliRunner().invoke(main, ["scene", str(path)])
    assert found.exit_code == 2
    assert len(found.output) < 6000
    assert found.output.replace("\n", "").isprintable()
    assert "recursion" not in found.output
    assert "scene.toml" in found.output or "run." in found.output


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("support.depth=1 mm", ['"1 mm"', 'depth is of kind = "fixed"']),
        ("support.delta=1 mm", ['depth is of kind = "fixed"']),
        ("support.weight=3 N/mm", ['did you mean "load"', '"3 N/mm"']),
        ("foundation.E=5 MPa", ['did you mean "modulus"']),
        ("foundation.tau=1 s", ['did you mean "retardation_time"', '"1 s"']),
        ("foundation.height=1 mm", ['did you mean "thickness"']),
        ("foundation.viscosity=1 Pa s", ['did you mean "retardation_time"']),
        (["support.kind=fixed", "support.load=3 N/mm"],
         ['load is of kind = "dead-weight" or "suspended"']),
        ("indenter.inclination=0.1", ['inclination is of shape = "wedge"']),
        ("indenter.R=1 mm", ['did you mean "radius"']),
        ("drive.V=1 m/s", ['did you mean "velocity"']),
        ("run.end=1 s", ['did you mean "duration"']),
        ("tau=3", ['did you mean "foundation.retardation_time"']),
        ("E=3", ['did you mean "foundation.modulus"']),
        ("V=3", ['did you mean "drive.velocity"']),
        ("R=3", ['did you mean "indenter.radius"']),
        ("mass=3", ['did you mean "support.mass"']),
        ("load=3", ['did you mean "support.load"']),
        ("duration=3", ['did you mean "run.duration"']),
        ("depth=3", ['did you mean "support.depth"']),
    ],
)  # fmt: skip
def test_hints_are_near_in_meaning_and_quote_what_was_given(override, words):
    overrides = [override] if isinstance(override, str) else override
    with pytest.raises(kv.SceneError) as error:
        kv.load_scene(overrides=overrides)
    for word in words:
        assert word in str(error.value), error.value


def test_what_is_meant_exists():
    models = [*SHAPES.values(), *SUPPORTS.values(), kv.Foundation, kv.Run, kv.Drive]
    known = set(QUANTITIES) | {name for model in models for name in quantities(model)}
    assert set(MEANT.values()) <= known
    for symbol, name in MEANT.items():
        assert closest(symbol, sorted(known)) == name
        assert closest(f"support.{symbol}", [f"support.{name}", "other"]) == f"support.{name}"


@pytest.mark.parametrize("name", ["mu", "μ", "F", "W", "a", "p_max"])
def test_symbols_of_quantities_are_understood_in_hints(name):
    with pytest.raises(kv.SceneError, match=f'did you mean "{MEANT[name]}"'):
        kv.solve(quantity=name)
    with pytest.raises(kv.SceneError, match=f'did you mean "{MEANT[name]}"'):
        kv.sweep(over={"drive.velocity": [1.0]}, quantities=name)


def test_a_density_is_blamed_only_where_it_was_given():
    large = kv.Scene(kv.Parabola(1e6), support=kv.Fixed(1e3), drive=kv.Drive(1e3))
    own = r"default density, 200 elements per mm.*give `per_length`"
    with pytest.raises(ValueError, match=own):
        kv.elements(large)
    with pytest.raises(ValueError, match=r"^`per_length` = 200000"):
        kv.elements(large, per_length=200e3)


def command(*arguments, status=2):
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == status, result.output
    return result


def test_the_command_line_names_its_options_where_the_library_names_arguments(tmp_path):
    cases = {
        "--at": ["transient", "--at", "1 furlong"],
        "--rtol": ["transient", "--rtol", "5"],
        "--per-length": ["elements", "--per-length", "-1 /mm"],
        "--quantity": ["solve", "--quantity", "depht"],
        "--set": ["steady", "--set", "nonsense"],
        "--method": ["steady", "--method", "exat"],
        "--over": ["sweep", "--over", "a.b=1", "-o", str(tmp_path / "a.csv")],
        "--only": ["chart", "failures", "--only", "nothing"],
        "--standard": ["chart", "work-precision", "--standard", "nothing"],
    }
    for option, arguments in cases.items():
        told = command(*arguments).stderr
        assert option in told, told
        assert "`" not in told.replace("`kinds`", ""), told


SWEEP = ["sweep", "--over", "drive.velocity=1 m/s", "-o", "a.csv"]


@pytest.mark.parametrize(
    "text", ["sys:exit", "sys:modules", "this_is:not", "os.path:join", "builtins:int", "json:", ":x",
             "builtins:ThreadPoolExecutor", "concurrent.futures:Executor", "antigravity.no:x"],
)  # fmt: skip
def test_what_makes_no_executor_is_told(tmp_path, monkeypatch, text):
    monkeypatch.chdir(tmp_path)
    assert f'--executor "{text}"' in command(*SWEEP, "--executor", text).stderr
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match="`executor`"):  # nor is a class
        kv.sweep(over={"drive.velocity": [1.0]}, executor=ThreadPoolExecutor)


@pytest.mark.parametrize(
    "code", ["raise SystemExit(0)", "1/0", "import no_such", "syntax error", ""]
)
def test_a_module_that_does_not_import_is_told(tmp_path, monkeypatch, code):
    (tmp_path / "broken_cluster.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    told = command(*SWEEP, "--executor", "broken_cluster:make").stderr
    assert '--executor "broken_cluster:make"' in told
    sys.modules.pop("broken_cluster", None)


def test_times_are_lists_and_ranges():
    listed = kv.transient(at=["0 ms", "1 ms", "2 ms", 0.1])
    for at in ("0 ms:2 ms:3, 100 ms", "0 ms,1 ms,2 ms,0.1 s", ["0 ms:2 ms:3", "100 ms"]):
        assert kv.transient(at=at).time.tolist() == pytest.approx(listed.time.tolist(), rel=1e-15)
    assert kv.elements(per_length="20 /mm", at="1 ms:100 ms:3:log").time == pytest.approx(
        [1e-3, 1e-2, 1e-1]
    )
    for wrong in ("0 ms:1 s:5", "0 ms:1 ms", "1 ms:2 ms:0", "0:1:2", "1 ms:2 kg:3", ""):
        with pytest.raises(kv.SceneError, match="`at`"):
            kv.transient(at=wrong)


@pytest.mark.parametrize("command", [kv.transient, lambda s: kv.sweep(
    s, over={"drive.velocity": [0.1]}, quantities=["hops"])])  # fmt: skip
def test_what_needs_a_parabola_says_what_does_not(command):
    known = r"`elements`, or `solve` with `at`, follows any shape|`elements` gives series"
    with pytest.raises(ValueError, match=known):
        command(kv.Scene(indenter=kv.Wedge(0.1)))
