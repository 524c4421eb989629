"""The page of the explorer as a file: what it holds, its colours, and which scenes it knows."""

import re
from itertools import combinations

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.explorer import explorer_page, save_explorer
from kvtheory.explorer.controls import controls
from kvtheory.explorer.page import formulas
from kvtheory.scene.foundations import MEASURED, THERMAL
from kvtheory.scene.quantities import quantities
from tests.commands import run

TABLE1 = kv.Scene()


def test_one_page_holds_everything_in_less_than_300_kB(tmp_path):
    page = tmp_path / "explorer.html"
    save_explorer(TABLE1, page)
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < 300_000
    assert not re.search(r'\b(src|href)\s*=\s*"(?!data:)', text)
    assert not re.search(r"https?://(?!www\.w3\.org/)", text)
    assert "{{" not in text.replace("}}", "").replace("${{", "")


BALL = kv.Scene(
    kv.Sphere("5 mm", radius_across="7 mm"), support=kv.Suspended(mass="2 kg", stiffness="3 kN/m")
)


@pytest.mark.parametrize(
    ("scene", "values", "absent", "note"),
    [
        (BALL, {"support.mass": "2", "support.stiffness": "3", "indenter.radius_across": "7"}, "", ""),
        (
            kv.Scene(drive=kv.Drive("50 mm/s", stiffness="2 MN/m^2")),
            {"drive.velocity": "50", "drive.stiffness": "2", "drive.damping": "0"}, "drive.mass", "",
        ),
        (
            kv.Scene(kv.PowerLaw("3 mm", 2.5), support=kv.DeadWeight(load="3 N/mm")),
            {"indenter.length": "3", "support.load": "3"}, "support.mass", "",
        ),
        (kv.problem("stop-and-go"), {}, "", "takes its final velocity"),
    ],
)  # fmt: skip
def test_the_page_opens_at_its_scene(scene, values, absent, note):
    held = controls(scene)["scene"]
    assert held["choices"]["indenter"] == scene.indenter.shape
    assert values.items() <= held["values"].items()
    assert absent not in held["values"]
    assert bool(held["note"]) == bool(note)
    assert note in held["note"]


def test_every_quantity_of_a_scene_has_a_slider():
    sections = controls(TABLE1)["sections"]
    for section, models in (
        ("foundation", kv.scene.foundations.FOUNDATIONS),
        ("support", kv.scene.model.SUPPORTS),
        ("indenter", kv.scene.indenters.SHAPES),
        ("drive", {"drive": kv.Drive}),
    ):
        for name, model in models.items():
            sliders = sections[section]["choices"][name]
            assert all(slider["unit"] or slider["exponent"] == 0 for slider in sliders.values())
            asked = sections[section]["alternatives"][name]
            unknown = {"damping"} & set(quantities(model)) if section == "foundation" else set()
            given_only = {*THERMAL, *MEASURED, *unknown}  # the scripts know no damper beside arms
            assert set(sliders) == set(quantities(model)) - given_only
            assert set().union(*(each["names"] for each in asked)) == set(sliders)


def test_every_formula_is_drawn_with_symbols_and_with_places_for_numbers():
    for key, row in formulas().items():
        assert not re.search(r"#\w+#", row["symbols"]), key
        assert re.search(r"#\w+#", row["numbers"]), key
        assert "<mi>\\" not in row["symbols"] + row["numbers"], key


def palette(dark):
    style = re.search(r"<style>(.*?)</style>", explorer_page(TABLE1), re.DOTALL)[1]
    light, night = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    colours = dict(re.findall(r"--(\w+): (#\w{6})", light))
    return colours | (dict(re.findall(r"--(\w+): (#\w{6})", night)) if dark else {})


def linear(colour):
    part = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    t = np.array(to_xyz) @ np.clip(rgb, 0, 1) / np.array([0.9505, 1.0, 1.089])
    f = np.where(t > 0.008856, np.cbrt(t), 7.787 * t + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


SIGHTS = {  # Vienot, Brettel and Mollon (1999), in linear RGB
    "normal": np.eye(3),
    "protanopia": np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]),
    "deuteranopia": np.array([[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]),
}  # fmt: skip


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("dark", [False, True])
def test_lines_stay_apart_in_colour_blindness_and_from_the_card(dark, sight):
    """Lines differ in dashes, points in shape, as well; colours must differ by what is plainly seen."""
    colours = palette(dark)
    names = "blue", "red", "green", "purple", "card"
    seen = {name: lab(SIGHTS[sight] @ linear(colours[name])) for name in names}
    for one, other in combinations(seen, 2):
        assert np.linalg.norm(seen[one] - seen[other]) > 15.0, (one, other)


@pytest.mark.parametrize("dark", [False, True])
def test_text_stands_out_from_the_card(dark):
    colours = palette(dark)

    def light(name):
        return float(linear(colours[name]) @ [0.2126, 0.7152, 0.0722])

    for name in ("ink", "soft"):
        low, high = sorted((light(name), light("card")))
        assert (high + 0.05) / (low + 0.05) > 4.5


def test_the_command_writes_the_page(tmp_path):
    path = tmp_path / "explorer.html"
    run("explore", "-o", path)
    assert path.read_text(encoding="utf-8") == explorer_page(TABLE1)


def test_a_foundation_is_shown_as_it_was_given():
    own = {"reference_temperature": "23 degC", "wlf": ["17.44", "51.6 K"], "temperature": "60 degC"}
    arms = [["1.5 MPa", "0.1 ms"], ["0.3 MPa", "0.1 s"]]
    layer = kv.GeneralizedMaxwell(
        modulus="0.5 MPa", thickness="2 mm", poisson_ratio=0.3, arms=arms, **own
    )
    page = controls(kv.Scene(foundation=layer))
    held = {key: text for key, text in page["scene"]["values"].items() if "foundation" in key}
    assert held == {
        "foundation.modulus": "0.5", "foundation.thickness": "2", "foundation.poisson_ratio": "0.3",
        "foundation.temperature": "333.15", "foundation.reference_temperature": "296.15",
        "foundation.wlf.c_1": "17.44", "foundation.wlf.c_2": "51.6",
    }  # fmt: skip
    assert page["scene"]["arms"] == [["1.5", "0.1"], ["0.3", "100"]]
    sliders = page["sections"]["foundation"]["choices"]["fractional-kelvin-voigt"]
    assert {key.removeprefix("foundation.") for key in held} <= set(sliders)
    assert sliders["temperature"]["unit"] == "K"
