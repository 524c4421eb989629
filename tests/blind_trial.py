"""Faults and sound series from a simulator written without looking at the diagnosis.

`python -m tests.blind_trial` prints each verdict and the counts, and with `seeds 1000` those of theory that
is disturbed in so many ways.
"""

import sys
from collections import Counter

import numpy as np

import kvtheory as kv
from kvtheory.checks.fitting import scaled_scene
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
    """Yield a name, a scene and a sound series: every scene, resolved and written in several ways."""
    rng = np.random.default_rng(11)
    for where, scene in SCENES.items():
        full = simulated(where)
        rows = np.sort(rng.choice(full["time"].size, 200, replace=False))
        thin = {name: full[name][rows] for name in FEW}
        noise = {name: 1.0 + 0.01 * rng.standard_normal(rows.size) for name in FEW[1:]}
        digits = {name: np.array([float(f"{v:.2g}") for v in full[name]]) for name in FEW[1:]}
        yield f"{where}, all", where, full, {}
        yield f"{where}, thinned", where, thin, {}
        yield f"{where}, noisy", where, {**thin, **{n: thin[n] * f for n, f in noise.items()}}, {}
        yield f"{where}, two digits", where, {"time": full["time"], **digits}, {}
        half = np.sqrt(2.0 * scene.indenter.radius * full["depth"][0])
        coarse = simulated(where, points=200, steps=2000)
        yield f"{where}, coarse, known", where, coarse, {"per_length": 200 / half}


KEYS = {"K": "foundation.stiffness", "tau": "foundation.retardation_time", "R": "indenter.radius",
        "M": "support.mass", "V": "drive.velocity"}  # fmt: skip
HOLDS = {"k_s": "support.stiffness", "delta": "support.depth"}


def faults():
    """Yield a name, the scene, the series, and the name that is right, if any is."""
    scaled = [("Table 1", symbol, factor) for symbol in KEYS for factor in (0.9, 1.01, 1.3)]
    for where in ("sine", "ramp"):
        scaled += [(where, "K", 1.1), (where, "tau", 1.1), (where, "V", 0.9)]
    scaled += [("suspended", "k_s", 1.3), ("fixed", "delta", 1.05)]
    for where, symbol, factor in scaled:
        data = simulated(where, key={**KEYS, **HOLDS}[symbol], factor=factor)
        yield f"{symbol} x {factor}", where, data, f"wrong {symbol}"
    planted = [
        ("reversal", "no relaxation", 0.0, "no relaxation of the free surface"),
        ("Table 1", "radius at the right depth", 1.05, "wrong R"),
        ("Table 1", "no damping", 0.0, None),
        ("Table 1", "shape", 2.2, None),
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
            yield name, where, {**plain, **edit}, name
    for where, plant, value, name in planted:
        yield plant, where, simulated(where, plant=plant, value=value), name


def main():
    """Print what is found in each."""
    agree = named = seen = count = number = 0
    for title, where, data, known in sound():
        found = kv.compare(SCENES[where], data, **known)
        agree, number = agree + (found.verdict == "agrees"), number + 1
        failed = [f"{c.name} {c.measured / c.allowed:.2f}" for c in found.checks if c.ok is False]
        print(f"{'ok' if not failed else 'NO'}  {title:26s} {found.verdict} {failed}", flush=True)
    for title, where, data, name in faults():
        found = kv.compare(SCENES[where], data)
        seen, count = seen + (found.verdict == "disagrees"), count + 1
        first = found.explanations[0] if found.explanations else None
        hit = first is not None and first.name == name
        named += hit
        others = [(each.name, each.factor) for each in found.explanations if each.enough]
        shown = None if first is None else (first.name, round(first.rank, 2), first.factor)
        row = f"{where:10s} {title:22s} {found.verdict} {shown} {others}"
        print("ok " if hit else "NO ", row, flush=True)
    print(f"sound: {agree} of {number} agree; faults: {seen} of {count} seen, {named} named first")


if __name__ == "__main__":
    seeds(int(sys.argv[2])) if len(sys.argv) > 2 else main()
