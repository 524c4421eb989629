"""Faults and sound series from a simulator written without looking at the diagnosis.

`python -m tests.blind_trial` prints each verdict and the counts, and with `seeds 1000` those of theory that
is disturbed in so many ways.
"""

import sys
from collections import Counter
from functools import partial

import numpy as np

import kvtheory as kv
from kvtheory.checks.fitting import scaled_scene
from tests.confusion import Plant, report
from tests.continuous_row import run
from tests.faulty_simulator import drive

SCENES = {
    "Table 1": kv.Scene(),
    "slow": kv.Scene(drive=kv.Drive(0.04)),
    "fixed": kv.Scene.table1("fixed"),
    "suspended": kv.Scene.table1("suspended"),
    "soft": kv.Scene(
        kv.Parabola(0.02), kv.Foundation(2e8, 0.02), kv.DeadWeight(40.0), kv.Drive(0.3), kv.Run(0.15)
    ),
    "reversal": kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.08, 0.1), (0.08, -0.05)])),
    "ramp": kv.Scene(drive=kv.Drive(history=[(0.0, 0.0), (0.05, 0.1)])),
    "sine": kv.Scene(drive=kv.Drive(function=lambda t: 0.06 + 0.04 * np.sin(60.0 * t))),
}  # fmt: skip
FEW = ("time", "depth", "normal_force", "friction_force")


def simulated(where, *, key="", factor=1.0, **options):
    """Return a run of a scene of which one parameter is multiplied."""
    scene = SCENES[where]
    velocity, speed = scene.drive.function or drive(scene), 1.0
    if key == "drive.velocity":
        speed = factor
    elif key:
        scene = scaled_scene(scene, {key: 1.0}, factor)
    return run(scene, lambda t: speed * velocity(t), scene.run.duration, **options)


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


def seeds(count):
    """Print how many of so many disturbed series of theory agree, at several levels."""
    for where in ("Table 1", "suspended", "fixed"):
        scene = SCENES[where]
        exact = kv.transient(scene, at=np.linspace(0.0, scene.run.duration, 400).tolist())
        for level, digits in ((0.005, None), (0.01, None), (0.02, None), (0.0, 2), (0.0, 3)):
            wrong = Counter()
            for seed in range(count):
                found = kv.compare(scene, disturbed(exact, seed, level, digits))
                wrong.update({"series": 1} if found.verdict != "agrees" else {})
                wrong.update(check.name for check in found.checks if check.ok is False)
            print(
                f"{where}, noise {level:g}, digits {digits}: {dict(wrong)} of {count}", flush=True
            )


def sound():
    """Yield sound series: every scene, resolved and written in several ways."""
    rng = np.random.default_rng(11)
    for where, scene in SCENES.items():
        full = simulated(where)
        rows = np.sort(rng.choice(full["time"].size, 200, replace=False))
        thin = {name: full[name][rows] for name in FEW}
        noisy = {n: thin[n] * (1.0 + 0.01 * rng.standard_normal(rows.size)) for n in FEW[1:]}
        digits = {name: np.array([float(f"{v:.2g}") for v in full[name]]) for name in FEW[1:]}
        half = np.sqrt(2.0 * scene.indenter.radius * full["depth"][0])
        coarse = simulated(where, points=200, steps=2000)
        for title, data, known in (
            ("all", full, {}),
            ("thinned", thin, {}),
            ("noisy", {**thin, **noisy}, {}),
            ("two digits", {"time": full["time"], **digits}, {}),
            ("coarse, known", coarse, {"per_length": 200 / half}),
        ):
            yield Plant(title, where, lambda data=data: data, "agrees", known=known)


KEYS = {"K": "foundation.stiffness", "tau": "foundation.retardation_time", "R": "indenter.radius",
        "M": "support.mass", "V": "drive.velocity", "k_s": "support.stiffness",
        "delta": "support.depth"}  # fmt: skip


def faults():
    """Yield faults; of some there is no name."""
    scaled = [("Table 1", symbol, factor) for symbol in [*KEYS][:5] for factor in (0.9, 1.01, 1.3)]
    for where in ("sine", "ramp"):
        scaled += [(where, "K", 1.1), (where, "tau", 1.1), (where, "V", 0.9)]
    for where, symbol, factor in [*scaled, ("suspended", "k_s", 1.3), ("fixed", "delta", 1.05)]:
        data = partial(simulated, where, key=KEYS[symbol], factor=factor)
        yield Plant(f"{symbol} x {factor}", where, data, f"wrong {symbol}")
    planted = [
        ("reversal", "no relaxation", 0.0, "no relaxation of the free surface"),
        ("Table 1", "radius at the right depth", 1.05, "wrong R"),
        ("Table 1", "no damping", 0.0, "none"),
        ("Table 1", "shape", 2.2, "none"),
    ]
    for where in ("Table 1", "reversal", "soft"):
        plain = simulated(where)
        arm = 0.08 * np.sqrt(2 * SCENES[where].indenter.radius * plain["depth"][0])
        planted += [
            (where, "no inertia", 0.0, "wrong inertia"),
            (where, "initial depth", 1.05, "wrong initial depth"),
            (where, "lever arm", arm, "lever arm of friction_force"),
        ]
        edits = [("sign of friction_force", {"friction_force": -plain["friction_force"]})]
        if where != "reversal":
            planted += [(where, "undeformed", 0.0, "undeformed at the start")]
            edits += [("time offset", {"time": plain["time"] + late}) for late in (3e-3, 1e3)]
            edits += [("unit of normal_force", {"normal_force": 1e3 * plain["normal_force"]})]
        for name, edit in edits:
            yield Plant(name, where, lambda data={**plain, **edit}: data, name)
    for where, plant, value, name in planted:
        yield Plant(plant, where, partial(simulated, where, plant=plant, value=value), name)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        seeds(int(sys.argv[2]))
    else:
        report([*sound()], SCENES)
        report([*faults()], SCENES)
