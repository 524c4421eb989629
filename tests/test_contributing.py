"""What CONTRIBUTING says of adding a part, followed to the letter in a copy of the package.

A shape, a support or a waveform is a class in its file and an entry of the table below it.
"""

import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import kvtheory as kv

ADDED = {
    "indenters.py": (
        '''@dataclass(frozen=True, eq=False)
class Catenary(Shape):
    """h = L (cosh(x/L) - 1)."""

    shape: ClassVar[str] = "catenary"
    words: ClassVar[str] = "the catenary"
    length: Value = quantity("m", "L, radius at the lowest point")

    def height(self, x):
        return 2.0 * self.length * np.sinh(0.5 * x / self.length) ** 2

    def slope(self, x):
        return np.sinh(x / self.length)

    def bend(self, x):
        return x / self.length / np.tanh(x / self.length)
''',
        "Convex = ", "PowerLaw, Wedge, Sphere)", "PowerLaw, Wedge, Sphere, Catenary)",
    ),
    "model.py": (
        '''@dataclass(frozen=True, eq=False)
class Buoyant(_Support):
    """A dead weight that a constant lift relieves."""

    kind: ClassVar[str] = "buoyant"
    table1: ClassVar[dict[str, float]] = {"mass": 1000.0, "lift": 1000.0}
    spring: ClassVar[Value] = 0.0
    depth: ClassVar[Value] = None
    mass: Value = quantity("kg/m", "M, mass of the indenter", per_width=True)
    lift: Value = quantity("N/m", "constant force upward", per_width=True)

    @property
    def weight(self):
        """M g less the lift."""
        return self.mass * STANDARD_GRAVITY - self.lift
''',
        "Support = ", "(Fixed, DeadWeight, Suspended)}", "(Fixed, DeadWeight, Suspended, Buoyant)}",
    ),
    "waveforms.py": (
        '''@dataclass(frozen=True, eq=False)
class Decay(Waveform):
    """V = velocity exp(-t/time)."""

    waveform: ClassVar[str] = "decay"
    final_velocity: ClassVar[float] = 0.0
    start: Value = quantity("m/s", "velocity at the start")
    time: Value = quantity("s", "time constant")

    def __call__(self, t):
        return self.start * math.exp(-t / self.time)
''',
        "WAVEFORMS: ", "(Sine, Triangle, SmoothRamp)", "(Sine, Triangle, SmoothRamp, Decay)",
    ),
}  # fmt: skip
"""By file: the class, the line before which it goes, and the row of the table before and after."""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Commands of a copy of the package with all three; they return standard output and error."""
    folder = tmp_path_factory.mktemp("copy")
    package = Path(kv.__file__).parent
    shutil.copytree(package, folder / "kvtheory", ignore=shutil.ignore_patterns("__pycache__"))
    for name, (text, place, before, after) in ADDED.items():
        file = folder / "kvtheory" / "scene" / name
        source = file.read_text()
        assert source.count(before) == source.count(f"\n{place}") == 1
        file.write_text(source.replace(f"\n{place}", f"\n{text}\n\n{place}").replace(before, after))

    def run(*words):
        command = [sys.executable, "-m", "kvtheory", *words]
        found = subprocess.run(
            command, cwd=folder, env=os.environ | {"PYTHONPATH": str(folder)}, text=True,
            capture_output=True, check=False,
        )  # fmt: skip
        return found.stdout, found.stderr

    return run


def test_a_shape_is_a_class_and_a_row(run):
    """Steady sliding of a catenary, held against integrals over its contact; and its series by elements."""
    scene = ("--set", "indenter.shape=catenary", "--set", "indenter.length=10 mm")
    fixed = ("--set", "support.kind=fixed", "--set", "support.depth=1 mm")
    text, message = run("steady", "--json", *scene, *fixed)
    assert not message
    found = json.loads(text)
    L, delta, K, C, V = 0.01, 1e-3, 1e10, 1e9, 0.1

    def pressure(x):
        return K * (delta - 2 * L * math.sinh(x / L / 2) ** 2) - C * V * math.sinh(x / L)

    a = L * math.acosh(1.0 + delta / L)
    edges = -a, brentq(pressure, -a, a)
    assert [found["leading_edge"], found["trailing_edge"]] == pytest.approx(edges, rel=1e-9)
    assert found["load"] == pytest.approx(quad(pressure, *edges)[0], rel=1e-9)
    force = quad(lambda x: -pressure(x) * math.sinh(x / L), *edges)[0]
    assert found["friction_force"] == pytest.approx(force, rel=1e-9)

    coarse = ("--set", "run.duration=150 ms", "--at", "150 ms", "--json", "--per-length", "5 /mm")
    text, message = run("elements", *scene, *fixed, *coarse)
    assert not message
    assert json.loads(text)["normal_force"][0] == pytest.approx(found["load"], rel=0.01)
    assert 'not for indenter.shape = "catenary"' in run("transient", *scene)[1]
    assert "sphere, catenary" in run("steady", "--set", "indenter.shape=cat")[1]
    assert "sphere, catenary" in run("scene")[0]


def test_a_support_is_a_class_and_a_row(run):
    text, message = run(
        "steady", "--json", "--set", "support.kind=buoyant", "--set", "support.lift=8 N/mm"
    )
    assert not message
    assert json.loads(text)["load"] == pytest.approx(9806.65 - 8000.0, rel=1e-12)
    text, message = run(
        "transient", "--json", "--at", "0 ms, 200 ms", "--set", "support.kind=buoyant"
    )
    assert not message
    assert json.loads(text)["normal_force"][1] == pytest.approx(8806.65, rel=1e-4)


def test_a_waveform_is_a_class_and_a_row(run):
    wave = ("drive.waveform=decay", "drive.start=100 mm/s", "drive.time=20 ms")
    words = [word for key in wave for word in ("--set", key)]
    text, message = run("transient", "--json", "--at", "0 ms, 200 ms", *words)
    assert not message
    force = json.loads(text)["friction_force"]
    assert abs(force[1]) < 0.05 * abs(force[0])
