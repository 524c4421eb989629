"""A drive with a spring in scenes: keys, files, overrides, sweeps, numbers, and who refuses it."""

import dataclasses
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

import kvtheory as kv
from kvtheory.cli import main
from kvtheory.scene.static_state import StaticState

SUPPORT = 'kind = "dead-weight"\nmass = "1000.0 kg/m"'
FIXED = 'kind = "fixed"\ndepth = "0.3 mm"'
SPRING = 'stiffness = "1 MN/m^2"\ndamping = "2 kN*s/m^2"\nmass = "3 kg/mm"'
WAYS = {
    "velocity": 'velocity = "91 mm/s"',
    "history": 'history = [["0 s", "0 m/s"], ["1 s", "1 m/s"]]',
    "waveform": 'waveform = "sine"\namplitude = "0.1 m/s"\nfrequency = "5 Hz"',
    "smooth-ramp": 'waveform = "smooth-ramp"\nvelocity = "0.1 m/s"\nrise_time = "5 ms"',
    "file": 'file = "drive.csv"',
}


def scene_file(folder, drive, support=SUPPORT):
    (folder / "drive.csv").write_text("t [s],V [m/s]\n0,0\n1,1\n")
    path = folder / "scene.toml"
    text = kv.to_toml(kv.Scene()).replace('gravity = "9.80665 m/s^2"\n', "")
    path.write_text(text.replace('velocity = "0.1 m/s"', drive).replace(SUPPORT, support))
    return path


@pytest.mark.parametrize("way", WAYS)
def test_a_spring_goes_with_every_way_to_drive_and_comes_back_from_a_file(tmp_path, way):
    path = scene_file(tmp_path, f"{WAYS[way]}\n{SPRING}")
    drive = kv.load_scene(path).drive
    assert (drive.stiffness, drive.damping, drive.mass) == (1e6, 2e3, 3e3)
    assert not drive.rigid
    path.write_text(kv.to_toml(kv.load_scene(path)))
    assert kv.load_scene(path).drive == drive
    other = kv.load_scene(path, ["drive.velocity=1 m/s"])  # another way to drive keeps the spring
    assert (other.drive.stiffness, other.drive.mass) == (1e6, 3e3)
    assert drive.faster(2.0).stiffness == drive.changed(velocity=1.0).stiffness == 1e6


def test_a_function_takes_a_spring_and_the_mass_is_that_of_the_support():
    scene = kv.Scene(drive=kv.Drive(function=math.sin, stiffness="2 MN/m^2"))
    assert (scene.drive.damping, scene.drive.mass, scene.drive_mass) == (0.0, None, 1000.0)
    assert scene.values()["drive.stiffness"] == 2e6
    assert scene.values()["drive.mass"] == 1000.0
    moved = dataclasses.replace(scene, drive=scene.drive.changed(mass=5.0))
    assert moved.drive_mass == 5.0
    assert moved.drive.function is math.sin


def test_scene_prints_the_spring_and_its_numbers_and_of_a_rigid_drive_none():
    arguments = ["scene", "--set", "drive.stiffness=1 MN/m^2", "--json"]
    printed = json.loads(CliRunner().invoke(main, arguments).stdout)
    assert (printed["drive_stiffness"], printed["drive_mass"], printed["mass"]) == (1e6, 1e3, 1e3)
    assert printed["drive_damping"] == 0.0
    assert printed["drive_stiffness_number"] > 0.0
    assert "stiffness" not in kv.to_toml(kv.Scene()).partition("[drive]")[2]
    assert not any(key in kv.Scene().values() for key in ("drive.stiffness", "drive.damping"))
    at_rest = StaticState.of(kv.Scene())
    assert at_rest.rigid_drive
    assert list(at_rest.named())[-3:] == ["drive_number", "inertia_number", "support_number"]


def test_scaled_numbers_are_those_of_the_motion_along_x():
    """eps_x x'' = f_x - c_x x' - kappa_x x is M_x d2x/dt2 = F_x - c dx/dt - k_x x in scaled form."""
    drive = kv.Drive(velocity=0.1, stiffness=1e6, damping=2e3, mass=3e3)
    scene = kv.Scene(drive=drive)
    own = StaticState.of(scene)
    K, R, tau, W = 1e10, 0.01, 0.1, 1000.0 * 9.80665
    a_0 = (1.5 * R * W / K) ** (1 / 3)
    force = W * (a_0**2 / (2 * R)) / a_0
    assert own.drive_stiffness_number == pytest.approx(1e6 * a_0 / force, rel=1e-14)
    assert own.drive_damping_number == pytest.approx(2e3 * (a_0 / tau) / force, rel=1e-14)
    assert own.drive_inertia_number == pytest.approx(3e3 * (a_0 / tau**2) / force, rel=1e-14)
    soon = kv.Foundation(K, 1e-5)
    with pytest.raises(ValueError, match="range of double precision"):
        StaticState.of(dataclasses.replace(scene, drive=drive.changed(mass=1e308), foundation=soon))


def test_mistakes_beside_a_spring_are_told_together(tmp_path):
    path = scene_file(tmp_path, f'{WAYS["velocity"]}\nstiffness = "1 MN/m^2"', FIXED)
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(path, ["run.duration=-1 s", "indenter.radius=0 m"])
    assert [text.split(" =")[0].split(":")[0] for text in caught.value.problems] == [
        "indenter.radius", "run.duration", "drive.mass",
    ]  # fmt: skip
    with pytest.raises(kv.SceneError) as caught:
        kv.Drive(damping=-1.0, mass="1 s", tolerance=2.0)
    keys = [text.split(" =")[0].split(":")[0] for text in caught.value.problems]
    assert keys == ["drive", *["drive.damping", "drive.mass"] * 2, "drive.tolerance"]


def test_springs_are_swept_and_steady_sliding_does_not_depend_on_them():
    scene = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6))
    over = {"drive.stiffness": [1e5, 1e7], "drive.mass": [1.0, 2.0], "drive.damping": [0.0, 3.0]}
    found = kv.sweep(scene, over=over, quantities="friction_force")["friction_force"]
    assert found.shape == (2, 2, 2)
    assert np.all(found == kv.steady().friction_force)
    assert kv.steady(over={"drive.stiffness": [1e5, 1e6]}).friction_force.shape == (2,)
    with pytest.raises(kv.SceneError, match=r"drive\.damping"):
        kv.sweep(over={"drive.damping": [0.0, 1.0]})


def test_solve_follows_a_spring():
    scene = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6), run=kv.Run(1e-3))
    assert kv.solve(scene, at="1 ms").model == "continuum"
    stiff = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e9))  # where steady sliding is stable
    assert kv.solve(stiff, quantity="friction_force").model == "exact"
