"""Messages about wrong input: what they name, quote and suggest; and files in any encoding."""

import math
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import pytest

import kvtheory as kv
from kvtheory.results import QUANTITIES
from kvtheory.scene import template
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.mistakes import MEANT, closest
from kvtheory.scene.model import SUPPORTS
from kvtheory.scene.quantities import quantities
from tests import REFUSALS
from tests.commands import run

V = "drive.velocity"
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
        (b"t [s],mu\n0,1\n", r"scene\.csv is not a TOML file: .*`compare`"),
        (b"\xff\xfeA", r"scene\.toml is not a TOML file"),
        (b"\x00\x01\x02", r"scene\.toml is not a TOML file"),
        (b"\x81\x8d\x8f", r"scene\.toml is not a TOML file"),
        (b"PK\x03\x04\x00", r"scene\.toml is not a TOML file"),
        (b'[run]\nduration = "1 s"\nduration = "2 s"\n', r'line 3, .*: duration = "2 s"'),
    ],
)
def test_what_is_no_toml_is_told_with_its_name_or_its_line(tmp_path, content, words):
    path = tmp_path / ("scene.csv" if "csv" in words else "scene.toml")
    path.write_bytes(content)
    with pytest.raises(kv.SceneError, match=words):
        kv.load_scene(path)


HOSTILE = {
    "nested": "[run]\nduration = " + "[" * 90_000,
    "an endless integer": "[run]\nduration = 0x" + "F" * 6000,
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
    found = run("scene", path, status=2)
    assert len(found.output) < 6000
    assert found.output.replace("\n", "").isprintable()
    assert "recursion" not in found.output
    assert "scene.toml" in found.output or "run." in found.output


def test_hints_are_near_in_meaning_and_quote_what_was_given():
    for given, *words in REFUSALS["keys"]["overrides"]:
        with pytest.raises(kv.SceneError) as error:
            kv.load_scene(overrides=[given] if isinstance(given, str) else given)
        assert all(word in str(error.value) for word in words), error.value


LAYER = {"modulus": "5 MPa", "thickness": "0.2 mm", "poisson_ratio": 0.3}
MODULI = [["30 MPa", "10 ms"], ["5 MPa", "1 s"]]


def soft():
    return kv.GeneralizedMaxwell(**LAYER, arms=MODULI)


MISTAKES = [
    (kv.DeadWeight, ["support.mass: missing", "or support.load"]),
    (lambda: kv.DeadWeight(load="-3 N/mm"), ["support.load", "above 0"]),
    (lambda: kv.DeadWeight(load="3 kg"), ["support.load", "wrong dimension", "N/m"]),
    (lambda: kv.DeadWeight(load=1e300, gravity=1e-300), ["follows from support.load"]),
    (lambda: kv.Suspended(load=1.0), ["support.stiffness: missing"]),
    (lambda: kv.Foundation(1e9), ["retardation_time: missing"]),
    (lambda: kv.Foundation(retardation_time=1.0), ["stiffness: missing", "foundation.modulus"]),
    (lambda: kv.Foundation(1e9, 1.0, modulus=1e6, thickness=1e-3),
     ["foundation.stiffness = 1000000000.0", "beside foundation.modulus, foundation.thickness"]),
    (lambda: kv.Foundation(retardation_time=1.0, **{**LAYER, "poisson_ratio": 0.6}),
     ["foundation.poisson_ratio", "at least 0 and of at most 0.5"]),
    (lambda: kv.GeneralizedMaxwell(1e10), ["foundation.arms: missing; expected pairs of stiffness"]),
    (lambda: kv.GeneralizedMaxwell(1e10, arms=MODULI), ["arms[0] ", "only a layer"]),
    (lambda: kv.GeneralizedMaxwell(**LAYER, arms=[["1 GN/m^3", "1 s"]]), ["has arms with moduli"]),
    (lambda: kv.GeneralizedMaxwell(**LAYER, arms=[MODULI[0], ["1 GN/m^3", "1 s"]]),
     ["arms[1] ", "with moduli"]),
    (lambda: kv.GeneralizedMaxwell(1e10, arms=soft().arms), ["only a layer"]),
    (lambda: kv.Scene(foundation=soft()).replace({"foundation.stiffness": 1e9}), ["only a layer"]),
    (kv.Drive, ["drive: expected one of velocity, history and waveform", "function"]),
    (lambda: kv.Drive(0.1, function=math.sin), ["one of velocity, history"]),
    (lambda: kv.Drive(0.1, waveform=kv.Sine(0.1, 5.0)), ["one of velocity, history"]),
    (lambda: kv.Drive(waveform=math.sin), ["drive.waveform", "expected a Sine"]),
    (lambda: kv.Drive(function=3.0), ["drive.function = 3.0", "function V(t)"]),
    (lambda: kv.Drive(0.1, breaks=[0.1]), ["drive.breaks", "needs a function"]),
    (lambda: kv.Drive(function=math.sin, breaks="soon"), ["drive.breaks", '"soon"']),
    (lambda: kv.Drive(function=math.sin, breaks=[0.1, "5 mm"]), ["drive.breaks", "'5 mm'"]),
    (lambda: kv.Drive(function=math.sin, breaks=[-0.1]), ["drive.breaks = [-0.1]", "out of range"]),
    (lambda: kv.Drive(function=math.sin, tolerance=0.0), ["drive.tolerance = 0.0", "1e-13 to 1"]),
    (lambda: kv.Drive(function=math.sin, tolerance="1e-9"), ["drive.tolerance", "1e-13 to 1"]),
    (lambda: kv.PowerLaw(length="1 mm", exponent=0.5), ["indenter.exponent", "at least 1"]),
    (lambda: kv.Profile(abs, abs, reach=float("nan")), ["indenter.reach", "above 0"]),
    (lambda: kv.Profile(abs, abs, reach="10 mm"), ["indenter.reach", "above 0"]),
    (lambda: kv.Profile(abs, abs, kinks=(float("nan"),)), ["indenter.kinks", "finite numbers"]),
    (lambda: kv.Profile(abs, abs, kinks=1.0), ["indenter.kinks", "finite numbers"]),
    (lambda: kv.Profile("x", abs), ["indenter", "functions h(x)"]),
    (lambda: kv.Revolved(kv.Sphere(0.01)), ["indenter.profile", "line contact"]),
    (lambda: kv.Drive(0.1, damping=1.0), ["drive.damping = 1.0", "needs drive.stiffness"]),
    (lambda: kv.stability(quantity="critical_stifness"), ["critical_stiffness"]),
    (lambda: kv.Scene(support=kv.DeadWeight(load="3 N")), ["support.load", "that of a ball"]),
    (lambda: kv.Scene(support=kv.Suspended(1.0, "1 N/mm")), ["support.stiffness", "that of a ball"]),
    (lambda: kv.Scene(kv.Sphere(0.01), support=kv.DeadWeight("1 kg/mm")), ["mass", "per unit width"]),
    (lambda: kv.steady(kv.Scene(kv.Sphere(0.01), support=kv.DeadWeight("1 kg")),
                       over={"support.mass": ["1 kg/m"]}), ["expected a quantity in kg"]),
]  # fmt: skip


CALLS = [
    (kv.steady, {"method": "exakt"}, ['"exakt"', 'did you mean "exact"']),
    (kv.steady, {"over": {V: [0.1, math.nan]}}, ["finite"]),
    (kv.steady, {"over": {"support.mass": 1e308, "support.gravity": 1e308}}, ["double precision"]),
    (kv.steady, {"over": {V: 1e300}}, ["double precision"]),
    (kv.steady, {"over": {V: 1e300}, "method": "quadrature"}, ["double precision"]),
    (kv.steady, {"over": {"support.mass": 1e-300}}, ["underflow in", "check support.mass = 1e-300 kg/m"]),
    (kv.transient, {"scene": kv.Scene(foundation=kv.Foundation(1e10, 1e300))},
     ["check foundation.retardation_time = 1e+300 s"]),
    *((kv.asymptotes, {"tolerance": each}, ["tolerance"]) for each in (0.0, -1.0, 2.0, math.nan)),
    (kv.transient, {"at": ["1 mm"]}, ["wrong dimension"]),
    (kv.transient, {"at": ["-1 ms"]}, ["out of range"]),
    (kv.transient, {"at": ["300 ms"]}, ["after the end"]),
    (kv.transient, {"at": "300 ms:400 ms:30"}, ['`at` = "0.3 s": is after the end', "so are 29 more"]),
    (kv.transient, {"at": []}, ["empty"]),
    (kv.transient, {"at": [math.nan]}, ["out of range"]),
    *((kv.transient, {"rtol": each}, ["rtol"]) for each in (0.0, 1.0, math.nan, 1e-20)),
    (kv.solve, {"quantity": "frictoin_force"}, ["friction_force"]),
    (kv.solve, {"quantity": "depth_rate"}, ["a time series; give the times"]),
    (kv.solve, {"quantity": "load", "at": "1 ms"}, ["steady sliding; leave out"]),
    (kv.solve, {"quantity": []}, ["is empty"]),
    (kv.solve, {"quantity": 5}, ["`quantity`"]),
    (kv.solve, {"rtol": 0.0}, ["`rtol` = 0.0"]),
    (kv.solve, {"rtol": math.nan}, ["`rtol` = nan"]),
    (kv.solve, {"at": "1 s"}, ["after the end of the run"]),
    (kv.solve, {"quantity": "spring_force", "at": "1 ms"}, ['"spring_force": needs drive.stiffness']),
]  # fmt: skip
MISTAKES += [(partial(function, **given), words) for function, given, words in CALLS]


@pytest.mark.parametrize(("make", "words"), MISTAKES)
def test_a_mistake_in_python_is_one_message(make, words):
    with pytest.raises(ValueError, match=r".") as error:
        make()
    (told,) = getattr(error.value, "problems", [str(error.value)])
    assert all(word in told for word in words), told
    where = make.keywords if isinstance(make, partial) else {"at"}
    assert isinstance(error.value, kv.SceneError) or "at" not in where


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


def test_a_class_is_no_executor():
    with pytest.raises(ValueError, match="`executor`"):
        kv.sweep(over={"drive.velocity": [1.0]}, executor=ThreadPoolExecutor)


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
