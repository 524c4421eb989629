"""Faults that are planted in data, for the diagnosis to name.

Each plant is a run of `tests.faulty_simulator`, changed as its name says, which the theory of the
unchanged scene is held against.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np

import kvtheory as kv
from kvtheory.checks.hypotheses import scaled_scene
from tests.faulty_simulator import simulate

STOP_AND_GO = [["0 ms", "100 mm/s"], ["50 ms", "100 mm/s"], ["50 ms", "-60 mm/s"], ["100 ms", "-60 mm/s"],
               ["100 ms", "100 mm/s"]]  # fmt: skip
SPRING = {"stiffness": "1 MN/m^2", "damping": "20 kN*s/m^2", "mass": "2 kg/mm"}
LIGHT = {"stiffness": "1 MN/m^2", "damping": "1 kN*s/m^2", "mass": "0.1 kg/mm"}
SHORT, LONG = kv.Run("0.1 s"), kv.Run("0.15 s")
SCENES = {
    "Table 1": kv.Scene(run=SHORT),
    "suspended": replace(kv.Scene.table1("suspended"), run=SHORT),
    "10 mm/s": kv.Scene(drive=kv.Drive(velocity=0.01)),
    "reversal": kv.Scene(drive=kv.Drive(history=STOP_AND_GO), run=LONG),
    "spring": kv.Scene(drive=kv.Drive("91 mm/s", **SPRING)),
    "spring, to and fro": kv.Scene(drive=kv.Drive(history=STOP_AND_GO, **LIGHT), run=LONG),
}
STEP, SIGN = 1e-4, "sign of friction_force"
SYMBOLS = {"tau": "foundation.retardation_time", "K": "foundation.stiffness", "R": "indenter.radius",
           "M": "support.mass", "g": "support.gravity", "V": "drive.velocity", "k_x": "drive.stiffness",
           "M_x": "drive.mass", "c_x": "drive.damping"}  # fmt: skip
RULES = {"pull": "tension allowed at the trailing edge", "stale": "contact lost while rising",
         "dropped": "contact lost while rising", "frozen": "no relaxation of the free surface",
         "unrelaxed": "no relaxation of the free surface",
         "forgetful": "memory forgotten where sliding reverses",
         "cleared": "memory forgotten where sliding reverses"}  # fmt: skip
"""The name of the fault of each wrong rule of the simulator."""


class Plant(NamedTuple):
    """A fault: how the data come about, the name that is right for it, and the factor to be found."""

    name: str
    scene: str
    data: Callable[[], dict[str, Any]]
    fault: str
    factor: float | None = None
    known: dict[str, Any] = {}  # noqa: RUF012


@cache
def run(scene, **options):
    return simulate(scene, **{"time_step": STEP, **options})


def series(scene, changes, **options):
    """Return a run of the changed scene without its velocity, which a wrong simulator would not know."""
    for key, factor in changes.items():
        scene = scaled_scene(scene, {key: 1.0}, factor)
    return {name: x for name, x in run(scene, **options).items() if name != "velocity"}


def edited(scene, shift=0.0, **factors):
    """Return a sound run with columns multiplied, or the time shifted."""
    data = series(scene, {})
    data |= {name: factor * data[name] for name, factor in factors.items()}
    return {**data, "time": data["time"] + shift}


def parameters(where):
    scene = SCENES[where]
    for (symbol, key), factor in product(SYMBOLS.items(), (0.9, 1.2)):
        if key in scene.values():
            data = partial(series, scene, {key: factor})
            yield Plant(f"{symbol} x {factor}", where, data, f"wrong {symbol}", factor)


def rules(where, names):
    for rule in names:
        data = partial(series, SCENES[where], {}, rule=rule)
        yield Plant(f"rule: {rule}", where, data, RULES[rule])


def others():
    """Plants in Table 1 that are neither a parameter nor a rule, and those of steps and of the drive."""
    scene, edit = SCENES["Table 1"], partial(edited, SCENES["Table 1"])
    ten = partial(series, scene, {"foundation.stiffness": 10.0})
    coarse = partial(series, scene, {}, per_length=10e3)
    unstable, named = partial(series, SCENES["10 mm/s"], {}, time_step=None), "unstable time step"
    spring, rigid = SCENES["spring"], kv.Drive(SCENES["spring"].drive.velocity)
    ours = {"per_length": "200 /mm", "scheme": "paper"}
    for name, where, data, fault, factor, known in (
        ("K x 10", "Table 1", ten, "wrong K", 10.0, {}),
        ("sign of friction", "Table 1", partial(edit, friction_force=-1.0), SIGN, None, {}),
        ("F_z in N/m for N/mm", "Table 1", partial(edit, normal_force=1e3), "unit of normal_force", 1e3, {}),
        ("depth in cm for mm", "Table 1", partial(edit, depth=0.1), "unit of depth", 0.1, {}),
        ("time in s for ms", "Table 1", partial(edit, time=1e3), "unit of time", 1e3, {}),
        ("starts 5 ms late", "Table 1", partial(edit, 5e-3), "time offset", 5e-3, {}),
        ("starts 2 ms early", "Table 1", partial(edit, -2e-3), "time offset", -2e-3, {}),
        ("10 elements/mm", "Table 1", coarse, "too few elements", None, {}),
        ("10 elements/mm, known", "Table 1", coarse, "too few elements", None, {"per_length": "10 /mm"}),
        ("dt = 2 dx/V at 10 mm/s", "10 mm/s", unstable, named, None, {}),
        ("the same, known", "10 mm/s", unstable, named, None, ours),
        ("rigid drive", "spring", partial(series, replace(spring, drive=rigid), {}),
         "rigid drive instead of a spring", None, {}),
        ("no damper", "spring", partial(series, spring, {"drive.damping": 0.0}), "wrong c_x", None, {}),
    ):  # fmt: skip
        yield Plant(name, where, data, fault, factor, known)


def plants():
    """Return every plant."""
    wrong = {
        "Table 1": ("pull", "dropped", "unrelaxed"),
        "reversal": ("pull", "stale", "frozen", "unrelaxed", "forgetful", "cleared"),
        "suspended": ("pull", "dropped"),
        "spring, to and fro": ("forgetful", "stale", "frozen"),
    }
    scaled = [parameters(where) for where in ("Table 1", "reversal", "suspended", "spring")]
    ruled = [rules(where, names) for where, names in wrong.items()]
    return [plant for family in (*scaled, *ruled, others()) for plant in family]


def quick():
    """Return one plant of each kind, for the tests."""
    alike = {"tau x 0.9", "K x 1.2", "R x 0.9", "M x 0.9", "g x 1.2", "V x 1.2", "time in s for ms"}
    # Where the base keeps its velocity, stale contacts do less than the elements at an edge.
    more = {
        "reversal": {"rule: frozen", "rule: stale", "rule: forgetful", "rule: cleared"},
        "spring": {"k_x x 0.9", "M_x x 1.2", "c_x x 1.2", "rigid drive"},
        "spring, to and fro": {"rule: forgetful"},
    }
    return [
        plant
        for plant in plants()
        if (plant.scene in ("Table 1", "10 mm/s") and plant.name not in alike)
        or plant.name in more.get(plant.scene, ())
    ]


FEW = ("time", "depth", "normal_force", "friction_force")


def disturbed(exact, seed, level, digits=None):
    """Return theory with noise in proportion to each value, or written with a few digits."""
    rng = np.random.default_rng(seed)
    series = {name: np.array(getattr(exact, name)) for name in FEW}
    if digits is not None:  # of other instants in each seed
        kept = np.sort(rng.choice(series["time"].size, series["time"].size // 2, replace=False))
        written = {
            n: np.array([float(f"{v:.{digits}g}") for v in series[n][kept]]) for n in FEW[1:]
        }
        return {"time": series["time"][kept], **written}
    noisy = {n: series[n] * (1.0 + level * rng.standard_normal(series[n].size)) for n in FEW[1:]}
    return {"time": series["time"], **noisy}
