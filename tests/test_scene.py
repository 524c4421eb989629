"""Scenes: from Python, from files, back to files, and what is refused."""

import copy
import pickle
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kvtheory as kv
from kvtheory.scene import files, tables, template
from kvtheory.scene.quantities import given as given_quantities
from kvtheory.scene.static_state import StaticState
from tests import REFUSALS

TABLE_1 = """
[indenter]
radius = "10 mm"
[foundation]
stiffness = "10 GN/m^3"
retardation_time = "100 ms"
[support]
kind = "dead-weight"
mass = "1 kg/mm"
[drive]
velocity = "100 mm/s"
[run]
duration = "200 ms"
"""


def write(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def problems(path, overrides=()):
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(path, overrides)
    return caught.value.problems


def test_the_file_of_table_1_is_the_built_in_scene(tmp_path):
    assert kv.load_scene(write(tmp_path, TABLE_1)) == kv.load_scene() == kv.Scene()


@pytest.mark.parametrize("support", ["fixed", "dead-weight", "suspended"])
def test_the_template_is_table_1(tmp_path, support):
    text = template(support)
    assert kv.load_scene(write(tmp_path, text)) == kv.Scene.table1(support)
    assert all("#" in line for line in text.splitlines() if "=" in line)
    assert tomllib.loads(text)["support"]["kind"] == support
    models = [known for chooser, known in files.SECTIONS.values() if chooser]
    names = [name for known in (*models, files.WAVEFORMS, files.DRIVES) for name in known]
    parts = [getattr(kv.Scene.table1(support), section) for section in files.SECTIONS]
    words = [spec.words for part in parts for spec in given_quantities(part).values()]
    for told in (*names, *words):
        assert told in text, told


POSITIVE = st.floats(1e-300, 1e300)
INDENTERS = st.one_of(
    POSITIVE.map(kv.Parabola),
    POSITIVE.map(kv.Circle),
    POSITIVE.map(kv.Wedge),
    st.builds(kv.PowerLaw, POSITIVE, st.floats(1.0, 50.0)),
)
SUPPORTS = st.one_of(
    POSITIVE.map(kv.Fixed),
    st.builds(kv.DeadWeight, POSITIVE, POSITIVE),
    st.builds(kv.Suspended, POSITIVE, POSITIVE, POSITIVE),
)
FINITE = st.floats(-1e300, 1e300)
TIMES = st.lists(st.floats(1e-300, 1e300), max_size=4, unique=True).map(lambda t: [0.0, *sorted(t)])
DRIVES = st.one_of(
    FINITE.map(kv.Drive),
    st.builds(lambda times, v: kv.Drive(history=[(t, v) for t in times]), TIMES, FINITE),
)


@given(
    st.builds(kv.Scene, INDENTERS, st.builds(kv.Foundation, POSITIVE, POSITIVE), SUPPORTS, DRIVES)
)
def test_a_scene_comes_back_from_its_file_to_the_last_bit(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("scene") / "scene.toml"
    path.write_text(kv.to_toml(scene), encoding="utf-8")
    assert kv.load_scene(path) == scene


def test_python_functions_do_not_go_into_a_file():
    flat = kv.Profile(lambda x: x * x, lambda x: 2 * x)
    for scene in (kv.Scene(indenter=flat), kv.Scene(drive=kv.Drive(function=abs))):
        with pytest.raises(ValueError, match="Python function"):
            kv.to_toml(scene)


@pytest.mark.parametrize("line", REFUSALS["file"])
def test_one_mistake_costs_one_clear_line(tmp_path, line):
    assert line in TABLE_1
    for new, *words in REFUSALS["file"][line]:
        (found,) = problems(write(tmp_path, TABLE_1.replace(line, new)))
        assert all(word in found for word in words), found


def test_all_mistakes_are_reported_together(tmp_path):
    text = TABLE_1.replace('"10 mm"', '"1,5 mm"').replace("mass", "mas").replace('"100 ms"', "3")
    found = problems(write(tmp_path, text), ["drive.velocity=fast", "nonsense"])
    assert len(found) == 5
    for key in ("indenter.radius", "support.mas =", "foundation.retardation_time"):
        assert any(key in text for text in found)
    assert any("drive.velocity" in text for text in found)
    assert any('`overrides` "nonsense"' in text for text in found)


def test_a_wrong_support_does_not_hide_the_other_mistakes(tmp_path):
    text = TABLE_1.replace('"dead-weight"', '"deadweight"').replace(
        'mass = "1 kg/mm"', "mass = 1\nstifness = 2"
    )
    found = problems(write(tmp_path, text))
    assert len(found) == 3
    assert 'did you mean "dead-weight"' in found[0]
    assert any("support.mass = 1" in text for text in found)
    assert any("support.stifness" in text for text in found)


def test_what_an_old_section_has_in_common_with_the_new_one_stays(tmp_path):
    path = write(tmp_path, TABLE_1)
    assert kv.load_scene(path, ["support.kind=dead-weight"]) == kv.Scene()
    assert kv.load_scene(path, ["indenter.shape=circle"]).indenter == kv.Circle(radius=0.01)
    hung = kv.load_scene(path, ["support.kind=suspended", "support.stiffness=1 MPa"])
    assert hung.support == kv.Suspended(mass=1000.0, stiffness=1e6)


def test_parts_of_the_wrong_kind_are_named():
    with pytest.raises(kv.SceneError) as caught:
        kv.Scene(indenter="parabola", drive="100 mm/s")
    assert [text.split(" = ")[0] for text in caught.value.problems] == ["`indenter`", "`drive`"]
    with pytest.raises(ValueError, match='did you mean "fixed"'):
        kv.Scene.table1("Fixed")


def test_a_missing_section_is_named(tmp_path):
    assert problems(write(tmp_path, "")) == tuple(
        f"[{name}]: this section is missing"
        for name in ("indenter", "foundation", "support", "drive")
    )


def test_overrides_replace_values_supports_shapes_and_drives(tmp_path):
    path = write(tmp_path, TABLE_1)
    overrides = ["drive.velocity = '50 mm/s'", 'support.mass="2 kg/mm"']
    scene = kv.load_scene(path, overrides)
    assert scene.drive.velocity == 0.05
    assert scene.support == kv.DeadWeight(mass=2000.0)
    fixed = kv.load_scene(path, ["support.kind=fixed", "support.depth=1 mm"])
    assert fixed.support == kv.Fixed(depth=0.001)
    assert kv.load_scene(None, ["support.kind=fixed"]).support == kv.Fixed(depth=3e-4)
    wedge = kv.load_scene(path, ["indenter.shape=wedge", "indenter.inclination=0.1"])
    assert wedge.indenter == kv.Wedge(inclination=0.1)
    history = kv.load_scene(path, ['drive.history=[["0 s", "1 m/s"], ["1 s", "0 m/s"]]'])
    assert history.drive == kv.Drive(history=((0.0, 1.0), (1.0, 0.0)))
    assert history.drive.final_velocity == 0.0
    assert "support.depth" in problems(path, ["support.kind=fixed"])[0]
    odd = write(tmp_path, TABLE_1.replace('velocity = "100 mm/s"', "waveform = []"))
    assert kv.load_scene(odd, ["drive.velocity=1 m/s"]).drive.velocity == 1.0


def test_python_takes_text_quantities_and_numbers():
    registry = pint.UnitRegistry()
    foundation = kv.Foundation(registry.Quantity(10, "GN/m^3"), "100 ms")
    assert foundation == kv.Foundation(1e10, 0.1)
    assert foundation.damping == 1e9
    with pytest.raises(kv.SceneError) as caught:
        kv.Foundation(-1.0, "100 mm")
    assert len(caught.value.problems) == 2


def test_quantities_are_replaced_by_arrays_that_broadcast_and_are_checked():
    scene = kv.Scene()
    many = scene.replace({"drive.velocity": [[0.1], [0.2]], "support.mass": np.array([1, 2, 3])})
    assert many.shape == (2, 3)
    assert scene.replace({"support.mass": "1 kg/mm"}).support.mass == 1000.0
    millimetres = pint.UnitRegistry().Quantity([1.0, 2.0], "mm")
    thick = scene.replace({"indenter.radius": millimetres})
    assert thick.indenter.radius.tolist() == [0.001, 0.002]
    with pytest.raises(kv.SceneError) as caught:
        scene.replace({"drive.velocty": 1.0, "support.mass": [1.0, -1.0], "support.depth": 1.0})
    assert len(caught.value.problems) == 3
    assert 'did you mean "drive.velocity"' in caught.value.problems[0]
    with pytest.raises(ValueError, match="do not broadcast"):
        scene.replace({"drive.velocity": [1.0, 2.0], "support.mass": [1.0, 2.0, 3.0]})


@pytest.mark.parametrize(
    ("scene", "key"),
    [
        (kv.Scene(drive=kv.Drive(waveform=kv.SmoothRamp([0.1, 0.2], 0.01))), "drive.velocity"),
        (
            kv.Scene(kv.Revolved(kv.Wedge([0.1, 0.2])), support=kv.DeadWeight(mass=1.0)),
            "indenter.profile.inclination",
        ),
    ],
)
def test_arrays_within_a_part_have_the_keys_that_replace_them(scene, key):
    found = kv.steady(scene)
    assert list(found.over) == list(scene.arrays()) == [key]
    one = scene.replace({key: 0.2})
    assert one.shape == ()
    assert found.friction_force[1] == kv.steady(one).friction_force


def test_a_scene_of_arrays_is_a_value():
    """Equality, hash, copies, and the scenes it holds one by one."""
    V = ["10 mm/s", "0.1 m/s"]
    arms = [[["30 GN/m^3", "40 GN/m^3"], "10 ms"], ["5 GN/m^3", "1 s"]]
    rubber = kv.GeneralizedMaxwell("10 GN/m^3", arms=arms)
    scene = kv.Scene(foundation=rubber, drive=kv.Drive(velocity=V))
    same = pickle.loads(pickle.dumps(scene))
    assert same == scene == copy.deepcopy(scene)
    assert hash(same) == hash(scene)
    assert scene != kv.Scene(foundation=rubber)
    assert scene.flat().rows(slice(1, 2)).drive.velocity.tolist() == [0.1]
    one = kv.Scene(foundation=replace(rubber, arms=[(4e10, 0.01), (5e9, 1.0)]), drive=kv.Drive(0.1))
    assert kv.steady(scene).friction_force[1] == kv.steady(one).friction_force
    load = kv.DeadWeight(load=["1 N/mm", "2 N/mm"])
    assert replace(load, load="9.80665 N/mm").mass == 1000.0


@pytest.mark.parametrize(
    "ask", [kv.transient, kv.elements, StaticState.of, lambda s: kv.solve(s, at=0.1)]
)
def test_what_runs_over_time_is_for_one_scene(ask):
    with pytest.raises(ValueError, match=r"arrays \(drive\.velocity\); use `sweep`"):
        ask(kv.Scene(drive=kv.Drive(velocity=[0.1, 0.2])))


def test_dimensionless_numbers_of_table_1():
    numbers = StaticState.of(kv.Scene.table1("suspended"))
    W, R, K, tau = 9806.65, 0.01, 1e10, 0.1
    depth = (3 * W / (4 * K * np.sqrt(2 * R))) ** (2 / 3)
    assert numbers.depth == pytest.approx(depth, rel=1e-14)
    assert numbers.drive_number == pytest.approx(0.1 * tau / np.sqrt(2 * R * depth), rel=1e-14)
    assert numbers.inertia_number == pytest.approx(1000 * depth / (W * tau**2), rel=1e-14)
    assert numbers.support_number == pytest.approx(3e7 * depth / W, rel=1e-14)
    assert "support_number" not in StaticState.of(kv.Scene.table1("fixed")).named()
    for extreme in (kv.DeadWeight(1e200), kv.DeadWeight(1e-320)):
        with pytest.raises(ValueError, match="double precision"):
            StaticState.of(kv.Scene(support=extreme))
    with pytest.raises(ValueError, match="parabola"):
        StaticState.of(kv.Scene(indenter=kv.Circle(radius=0.01)))


@pytest.mark.parametrize("device", [True, False])
def test_devices_and_files_that_are_too_large_are_not_read(tmp_path, monkeypatch, device):
    path, told = Path("/dev/zero"), "is a device"
    if not device:
        path, told = tmp_path / "large.csv", "holds more than 0 MB"
        path.write_text("t [s],V [m/s]\n0,1\n1,1\n")
        monkeypatch.setattr(tables, "MOST", 10)
    elif not path.exists():
        pytest.skip("this system has no such device")
    for read in (
        lambda: kv.load_scene(path),
        lambda: kv.load_scene(overrides=[f"drive.file={path}"]),
        lambda: kv.compare(data=path),
    ):
        with pytest.raises(
            (OSError, ValueError), match=rf"{path.name}.*{told}|{told}.*{path.name}"
        ):
            read()


MIXED = '[foundation]\nkind = "generalized-maxwell"\n' + (
    'stiffness = "10 GN/m^3"\narms = [["20 GN/m^3", "5 ms"], ["10 GN/m^3", "0.2 s"]]\n'
)


def test_arms_beside_a_damper(tmp_path):
    foundation = kv.GeneralizedMaxwell(
        "10 GN/m^3", arms=[["20 GN/m^3", "5 ms"], ["10 GN/m^3", "0.2 s"]], damping="0.5 MPa*s/mm"
    )
    scene = kv.Scene(foundation=foundation)
    assert foundation.damping == 5e8
    assert foundation.slow_damping == pytest.approx(2.6e9, rel=1e-15)
    assert foundation.retardation_time == pytest.approx(0.26, rel=1e-15)
    assert scene.values()["foundation.damping"] == 5e8
    path = tmp_path / "mixed.toml"
    path.write_text(files.to_toml(scene))
    assert kv.load_scene(path) == scene
    many = kv.load_scene(path, ['foundation.damping=["0 N*s/m^3", "1 GN*s/m^3"]'])
    assert many.shape == (2,)
    assert many.foundation.slow_damping == pytest.approx([2.1e9, 3.1e9])
    assert foundation.plain(2.0).slow_damping == pytest.approx(5.2e9)


def test_without_a_damper_arms_are_written_as_before():
    plain = kv.GeneralizedMaxwell(1e10, arms=[(2e10, 5e-3)])
    assert plain.damping == 0.0
    assert "damping" not in files.to_toml(kv.Scene(foundation=plain))
    assert plain == replace(plain, damping=0.0) == replace(plain)


def test_temperature_shifts_the_damper_with_the_times():
    """All times of G shift by a_T, so that int (G - K) dt does (F25)."""
    warm = kv.GeneralizedMaxwell(
        1e10, arms=[(2e10, 5e-3)], damping=5e8, temperature="60 degC",
        reference_temperature="23 degC", wlf=["17.44", "51.6 K"],
    )  # fmt: skip
    assert warm.damping == 5e8 * warm.shift_factor
    assert warm.slow_damping == pytest.approx(6e8 * warm.shift_factor, rel=1e-15)
    assert replace(warm) == warm
    assert kv.Scene(foundation=warm).values()["foundation.damping"] == 5e8
    kept = replace(warm, wlf=None, temperature=None, reference_temperature=None)
    assert kept.damping == warm.damping


@pytest.mark.parametrize(("damping", "told"), [
    ('"0.5 MPa"', 'foundation.damping = "0.5 MPa": the unit "MPa" has the wrong dimension; expected a '
     'quantity in N*s/m^3, such as "0.5 GN*s/m^3"'),
    ('"-1 N*s/m^3"', "of at least 0"),
    ("3", "foundation.damping = 3: has no unit; expected a quantity in N*s/m^3"),
])  # fmt: skip
def test_a_wrong_damping_beside_arms(tmp_path, damping, told):
    path = write(tmp_path, f"{MIXED}damping = {damping}\n")
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(path)
    assert told in str(caught.value)


def test_a_layer_takes_no_damper_and_a_kelvin_voigt_foundation_none_beside_its_own():
    layer = {"modulus": "5 MPa", "thickness": "2 mm", "poisson_ratio": 0.45}
    with pytest.raises(
        kv.SceneError, match=r"foundation\.damping = 1000\.0: a layer has arms alone"
    ):
        kv.GeneralizedMaxwell(**layer, arms=[["30 MPa", "10 ms"]], damping=1e3)
    assert kv.GeneralizedMaxwell(**layer, arms=[["30 MPa", "10 ms"]], damping=0.0).damping == 0.0
    with pytest.raises(kv.SceneError, match=r"foundation\.damping.*unknown key"):
        kv.load_scene(overrides=["foundation.damping=1 GN*s/m^3"])
