"""What CONTRIBUTING says of adding a part, followed to the letter in a copy of the package.

A shape, a law, a support or a waveform is a class in its file and an entry of the table below it.
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
    "foundations.py": (
        '''@dataclass(frozen=True, eq=False)
class StandardLinearSolid(_Relaxed):
    """G = K [1 + (ratio - 1) e^(-t/tau)]."""

    kind: ClassVar[str] = "standard-linear-solid"
    relaxation_time: Value = quantity("s", "tau", default=None, needed=True)
    ratio: Value = quantity("1", "G(0)/K", default=None, needed=True, minimum=1.0)

    @property
    def arms(self):
        return (Arm((self.ratio - 1.0) * self.stiffness, +self.relaxation_time),)
''',
        "AnyFoundation = ", "(Foundation, GeneralizedMaxwell, FractionalKelvinVoigt)",
        "(Foundation, GeneralizedMaxwell, FractionalKelvinVoigt, StandardLinearSolid)",
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


SERVER = """
import json, sys
from click.testing import CliRunner
from kvtheory.cli import main

for line in sys.stdin:
    found = CliRunner().invoke(main, json.loads(line))
    print(json.dumps([found.stdout, found.stderr]), flush=True)
"""
"""Runs commands in one process, for it takes longer to import the package than to answer."""


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """How to start Python in a copy of the package with all four."""
    folder = tmp_path_factory.mktemp("copy")
    # What Python has compiled stays valid, but of the files that change; kernels have a cache of their own.
    kernels = shutil.ignore_patterns("*.nb?")
    shutil.copytree(Path(kv.__file__).parent, folder / "kvtheory", ignore=kernels)
    for name, (text, place, before, after) in ADDED.items():
        file = folder / "kvtheory" / "scene" / name
        source = file.read_text()
        assert source.count(before) == source.count(f"\n{place}") == 1
        file.write_text(source.replace(f"\n{place}", f"\n{text}\n\n{place}").replace(before, after))
    return {"cwd": folder, "env": os.environ | {"PYTHONPATH": str(folder)}, "text": True}


@pytest.fixture(scope="module")
def run(copy):
    """Commands of the copy; they return standard output and error."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", SERVER], **copy, **pipes) as server:

        def run(*words):
            print(json.dumps(words), file=server.stdin, flush=True)
            return json.loads(server.stdout.readline())

        yield run
        server.stdin.close()


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


LAWS_ALIKE = """
from dataclasses import replace
import numpy as np
import kvtheory as kv
from kvtheory.scene.foundations import FOUNDATIONS

room = {"temperature": 300.0, "reference_temperature": 293.0, "wlf": (17.44, 51.6)}
layer = {"modulus": 5e6, "thickness": 2e-3, "poisson_ratio": 0.45, **room}
solid = FOUNDATIONS["standard-linear-solid"]
alike = (
    ({"stiffness": 1e10}, [(3e10, 0.01)], kv.Parabola(0.01)),
    (layer, [("15 MPa", 0.01)], kv.Circle(0.01)),
)
for given, arms, shape in alike:
    one = kv.Scene(shape, solid(**given, ratio=4.0, relaxation_time=0.01), run=kv.Run(2e-3))
    two = replace(one, foundation=kv.GeneralizedMaxwell(**given, arms=arms))
    asked = {
        "friction_force": lambda scene: kv.steady(scene),
        "maxima": lambda scene: kv.asymptotes(scene),
        "depth": lambda scene: kv.elements(scene, at=[1e-3], per_length=5e3),
    }
    if given is not layer:
        asked["critical_stiffness"] = lambda scene: kv.stability(
            scene.replace({"drive.velocity": 0.2}), quantity="critical_stiffness")
        asked["normal_force"] = lambda scene: kv.transient(scene, at=[1e-3])
        motion = kv.elements(one, at=np.linspace(0.0, 2e-3, 20), per_length=1e4, certify=False)
        names = "time", "depth", "normal_force", "friction_force"
        data = {name: getattr(motion, name) for name in names}
        assert kv.compare(one, data=data).verdict == kv.compare(two, data=data).verdict == "agrees"
    for name, ask in asked.items():
        a, b = (np.asarray(getattr(ask(each), name)) for each in (one, two))
        assert np.array_equal(a, b) and np.isfinite(a).all(), (name, a, b)
swept = kv.sweep(one, over={"foundation.ratio": [2.0, 4.0]}, quantities=["friction_force"])
assert swept["friction_force"][1] == kv.steady(two).friction_force
"""
"""In the copy: a solid of its own answers as the Prony series with its arms, also as a layer."""


def test_a_law_is_a_class_and_a_row(copy, run):
    call = [sys.executable, "-c", LAWS_ALIKE]
    found = subprocess.run(call, **copy, capture_output=True, check=False)
    assert (found.stdout, found.stderr) == ("", "")
    kind = ("--set", "foundation.kind=standard-linear-solid", "--set", "foundation.ratio=4")
    time = ("--set", "foundation.relaxation_time=10 ms")
    refused = run("steady", "--method", "asymptote", *kind, *time)[1]
    assert 'foundation.kind = "kelvin-voigt" only, not for "standard-linear-solid"' in refused
    assert "foundation.relaxation_time: missing" in run("steady", *kind)[1]
    assert "no sliders for foundation.kind" in run("explore", "-o", "x.html", *kind, *time)[1]
    assert "standard-linear-solid" in run("scene")[0]
