"""Drives with a shape and drives from a table: what they are, and what is said of mistakes."""

import dataclasses
import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.scene.waveforms import AT_LAST

WAVES = {
    "sine": kv.Sine(amplitude="80 mm/s", frequency="7 Hz", mean="10 mm/s"),
    "triangle": kv.Triangle(amplitude="80 mm/s", frequency="7 Hz", mean="-5 mm/s"),
    "smooth-ramp": kv.SmoothRamp(velocity="-60 mm/s", rise_time="13 ms"),
}
TIMES = np.linspace(0.0, 0.2, 57)


@pytest.mark.parametrize("name", WAVES)
def test_a_waveform_is_followed_and_comes_back_from_its_file(name, tmp_path):
    wave = WAVES[name]
    scene = kv.Scene(drive=kv.Drive(waveform=wave))
    found = kv.transient(scene, at=TIMES, rtol=1e-9)
    assert found.velocity == pytest.approx([wave(t) for t in TIMES], abs=1e-10)
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    assert kv.load_scene(path) == scene
    bumpy = kv.elements(scene, at=TIMES, per_length="100 /mm", certify=False)
    assert bumpy.velocity == pytest.approx(found.velocity, abs=1e-8)
    assert bumpy.depth == pytest.approx(found.depth, abs=2e-3 * found.depth[0])


@pytest.mark.parametrize("given", ["60 rpm", "360 deg/s", "1 cycle/s", f"{2 * math.pi!r} rad/s"])
def test_a_frequency_counts_cycles_wherever_it_is_read(given, tmp_path):
    one, crest = pytest.approx(1.0, rel=1e-15), 0.1 * math.sin(0.25 * math.pi)
    assert kv.Sine(amplitude=0.1, frequency=given).frequency == one
    path = tmp_path / "scene.toml"
    wave = f'waveform = "sine"\namplitude = "0.1 m/s"\nfrequency = "{given}"'
    path.write_text(kv.to_toml(kv.Scene()).replace('velocity = "0.1 m/s"', wave))
    scene = kv.load_scene(path)
    assert scene.drive.waveform.frequency == one
    assert kv.transient(scene, at=0.125).velocity == pytest.approx(crest)
    bumpy = kv.elements(scene, at=0.125, per_length="50 /mm", certify=False)
    assert bumpy.velocity == pytest.approx(crest)
    changed = kv.load_scene(path, [f"drive.frequency={given}"]).drive.waveform
    assert changed.frequency == one
    over = {"drive.frequency": f"{given}:{given}:2"}
    assert scene.replace(over).drive.waveform.frequency == pytest.approx(1.0)
    swept = kv.sweep(scene, over=over, at=0.125, quantities=["velocity"])
    assert swept.axes[0].values["drive.frequency"] == pytest.approx(1.0)
    measured = {"lowest_frequency": given, "highest_frequency": "2 Hz"}
    assert kv.Foundation(1e10, 0.1, **measured).lowest_frequency == one


def test_a_triangle_is_its_history():
    wave = kv.Triangle(amplitude=0.1, frequency=5.0, mean=0.02)
    corners = wave.points(0.2)
    assert corners[-1][0] >= 0.2
    t = np.linspace(0.0, 0.2, 333)
    assert [wave(x) for x in t] == pytest.approx(np.interp(t, *np.array(corners).T), abs=1e-14)
    plain = kv.transient(kv.Scene(drive=kv.Drive(history=corners)), at=TIMES)
    shaped = kv.transient(kv.Scene(drive=kv.Drive(waveform=wave)), at=TIMES)
    assert np.array_equal(plain.depth, shaped.depth)


def test_what_ends_with_a_velocity_slides_steadily_at_last():
    ramp = kv.Scene(drive=kv.Drive(waveform=WAVES["smooth-ramp"]))
    steady = kv.Scene(drive=kv.Drive(velocity="-60 mm/s"))
    assert kv.steady(ramp).depth == kv.steady(steady).depth
    last = ramp.drive.last_change
    assert math.tanh(AT_LAST) == 1.0
    assert WAVES["smooth-ramp"](last) == -0.06
    for name in ("sine", "triangle"):
        with pytest.raises(kv.SceneError, match=r"drive\.waveform.*velocity or a history"):
            kv.steady(kv.Scene(drive=kv.Drive(waveform=WAVES[name])))


def test_another_way_to_drive_replaces_the_one_before():
    wave = ["drive.waveform=sine", "drive.amplitude=1 mm/s", "drive.frequency=2 Hz"]
    drive = kv.load_scene(overrides=wave).drive
    assert drive.velocity is None
    assert kv.load_scene(overrides=[*wave, "drive.velocity=5 mm/s"]).drive.velocity == 0.005
    assert dataclasses.replace(drive, tolerance=1e-9).waveform == drive.waveform


def test_a_long_history_is_read_in_time_that_grows_with_it():
    """Units are looked up once, not once for each point."""
    points = [[f"{i} ms", f"{i % 7} mm/s"] for i in range(5_000)]
    assert len(kv.Drive(history=points).history) == len(points)


ROUND = [(0.0, 0.0), (0.0105, 0.0075)]


@pytest.mark.parametrize(
    ("text", "encoding", "points"),
    [
        ("t [ms];V [mm/s]\n0;0\n10,5;7,5\n", "cp1252", ROUND),
        ("sep=;\nZeit (ms);Geschwindigkeit (mm/s);Kommentar\n0;0;a\n10,5;7,5;größer\n", "cp1252", ROUND),
        ("V/(mm/s)\tt/ms\n0\t0\n7.5\t10.5\n", "utf-16", ROUND),
        ("time [s],velocity [m/s],depth [m]\n0,0,\n0.0105,0.0075,1e-4\n", "utf-8-sig", ROUND),
        ("t [ms],V [mm/s]\n# a remark\n0,0\n\n20,90\n20,-10\n", "ascii",
         [(0.0, 0.0), (0.02, 0.09), (0.02, -0.01)]),
    ],
)  # fmt: skip
def test_a_table_is_a_history(tmp_path, text, encoding, points):
    (tmp_path / "drive.CSV").write_text(text, encoding=encoding)
    scene = tmp_path / "scene.toml"
    scene.write_text(kv.to_toml(kv.Scene()).replace('velocity = "0.1 m/s"', 'file = "drive.CSV"'))
    found = np.array(kv.load_scene(scene).drive.history)
    assert found == pytest.approx(np.array(points))
    assert np.array_equal(np.array(kv.Drive(history=found).history), found)
    scene.write_text(scene.read_text().replace("[run]", 'history = [["0 s", "1 m/s"]]\n[run]'))
    with pytest.raises(kv.SceneError, match=r"drive\.file = .* beside drive\.history"):
        kv.load_scene(scene)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"t [ms],V [mm/s]\n0," + b"1" * 200_000 + b"\n", "field larger than field limit"),
        (bytes(range(256)), "not a text file"),
        (b"\0", "not a text file"),
        (b"", "is empty"),
        (b'"', "is empty"),
        (b"0,1\n", "line 1 holds numbers"),
        (b"t [ms],V [mm]\n0,1\n", "wrong dimension"),
        (b"t [ms],V [mm/s]\n0,fast\n", '"fast" is not a number'),
        (b"t [ms],V [mm/s]\n0\n", "the cell is empty"),
        (b"t [ms],V [mm/s]\n", "a header and no rows"),
        (b"t [ms]\n0\n", "has only time"),
        (b"t [ms],V [mm/s]\n0,1\n1,nan\n", "finite"),
        (b"t [ms],V [mm/s]\n5,1\n", "first time must be 0 s"),
        (b"t [ms],V [mm/s],v [m/s]\n0,1,1\n", "both the velocity"),
        (b't [ms],V [mm/s]\n0,"1\n1,1\n', "is not a number"),
        (b"t [ms],V [mm/s]\n0,\n1,1\n", 'line 2, column "V [mm/s]": the cell is empty'),
    ],
)
def test_a_table_that_is_none_is_refused_in_one_line(tmp_path, text, words):
    path = tmp_path / "drive.csv"
    path.write_bytes(text)
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(overrides=[f"drive.file={path}"])
    (line,) = caught.value.problems
    assert line.startswith("drive.file")
    assert words in line
    assert "drive.csv" in line
    assert len(line) < 400


def test_mistakes_of_a_table_are_reported_together_under_the_key_of_the_scene(tmp_path):
    path = tmp_path / "drive.csv"
    path.write_text("t [ms],V [mm/s]\n0,fast\n1,\n2,3\n")
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(overrides=[f"drive.file={path}"])
    first, second = caught.value.problems
    assert first.startswith("drive.file")
    assert second.startswith("drive.file")
    assert ': line 2, column "V [mm/s]": "fast" is not a number' in first
    assert ': line 3, column "V [mm/s]": the cell is empty' in second


def test_a_long_swing_is_followed_like_a_short_one():
    wave = kv.Sine(amplitude=0.1, frequency=900.0, mean=0.03)
    motion = kv.Drive(waveform=wave).motion(2.0, 1e-3)
    for t in np.random.default_rng(3).uniform(0.0, 2.0, 200).tolist():
        assert motion.velocity(t) == pytest.approx(wave(t), abs=1e-11)
        turned = (1.0 - math.cos(2.0 * math.pi * 900.0 * t)) / (2.0 * math.pi * 900.0)
        assert motion.displacement(t) == pytest.approx(0.03 * t + 0.1 * turned, abs=1e-12)


@pytest.mark.parametrize("shape", [kv.Sine, kv.Triangle])
def test_a_swing_of_more_cycles_than_can_be_followed_is_refused(shape):
    drive = kv.Drive(waveform=shape(amplitude=0.1, frequency=20.0))
    with pytest.raises(kv.SceneError, match=r'drive\.frequency = "20 Hz": more than'):
        drive.motion(1e299, 1e-3)


def test_a_sudden_ramp_is_followed_however_long_the_run():
    wave = kv.SmoothRamp(velocity=0.1, rise_time=1e-9)
    motion = kv.Drive(waveform=wave).motion(1e9, 1e-3)
    assert motion.velocity(1e-9) == pytest.approx(wave(1e-9), rel=1e-9)
    assert motion.velocity(5e8) == 0.1
    assert motion.end == 1e9
