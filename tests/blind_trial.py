"""Faults and sound series from a simulator written without looking at the diagnosis.

`python -m tests.blind_trial` prints each verdict and the counts, and with `seeds 1000` those of theory that
is disturbed in so many ways.
"""

import sys
from collections import Counter
from dataclasses import replace

import numpy as np

import kvtheory as kv
from tests.continuous_row import run

SCENES = {
    "Table 1": (kv.Scene(), lambda t: 0.1),
    "slow": (kv.Scene(drive=kv.Drive(0.04)), lambda t: 0.04),
    "fixed": (kv.Scene.table1("fixed"), lambda t: 0.1),
    "suspended": (kv.Scene.table1("suspended"), lambda t: 0.1),
    "soft": (
        kv.Scene(kv.Parabola(0.02), kv.Foundation(2e8, 0.02), kv.DeadWeight(40.0), kv.Drive(0.3),
                 kv.Run(0.15)),
        lambda t: 0.3,
    ),
    "reversal": (
        kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.08, 0.1), (0.08, -0.05)])),
        lambda t: 0.1 if t < 0.08 else -0.05,
    ),
    "ramp": (
        kv.Scene(drive=kv.Drive(history=[(0.0, 0.0), (0.05, 0.1)])),
        lambda t: min(t / 0.05, 1.0) * 0.1,
    ),
    "sine": (
        kv.Scene(drive=kv.Drive(function=lambda t: 0.06 + 0.04 * np.sin(60.0 * t))),
        lambda t: 0.06 + 0.04 * np.sin(60.0 * t),
    ),
}  # fmt: skip
ALL = ("time", "depth", "depth_rate", "normal_force", "friction_force", "leading_edge",
       "trailing_edge", "peak_pressure")  # fmt: skip
FEW = ("time", "depth", "normal_force", "friction_force")


def changed(scene, key, factor):
    section, name = key.split(".")
    part = getattr(scene, section)
    return replace(scene, **{section: replace(part, **{name: factor * getattr(part, name)})})


def simulated(where, *, key="", factor=1.0, **options):
    """Return a run of a scene of which one parameter is multiplied."""
    scene, velocity = SCENES[where]
    if key == "drive.velocity":
        given = velocity
        velocity = lambda t: factor * given(t)  # noqa: E731
    elif key:
        scene = changed(scene, key, factor)
    return run(scene, velocity, scene.run.duration, **options)


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
        scene, _ = SCENES[where]
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
    for where, (scene, _) in SCENES.items():
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


def faults():
    """Yield a name, the scene, the series, and the names that are right."""
    for symbol, key in KEYS.items():
        for factor in (0.9, 1.01, 1.3):
            data = simulated("Table 1", key=key, factor=factor)
            yield f"{symbol} x {factor}", "Table 1", data, (f"wrong {symbol}",)
    for symbol, key, factor in (
        ("K", KEYS["K"], 1.1),
        ("tau", KEYS["tau"], 1.1),
        ("V", KEYS["V"], 0.9),
    ):
        yield (
            f"{symbol} x {factor}",
            "sine",
            simulated("sine", key=key, factor=factor),
            (f"wrong {symbol}",),
        )
        yield (
            f"{symbol} x {factor}",
            "ramp",
            simulated("ramp", key=key, factor=factor),
            (f"wrong {symbol}",),
        )
    k_s = simulated("suspended", key="support.stiffness", factor=1.3)
    yield "k_s x 1.3", "suspended", k_s, ("wrong k_s",)
    depth = simulated("fixed", key="support.depth", factor=1.05)
    yield "depth x 1.05", "fixed", depth, ("wrong delta",)
    for where in ("Table 1", "reversal", "soft"):
        plain = simulated(where)
        yield "no inertia", where, simulated(where, plant="no inertia"), ("wrong inertia",)
        yield (
            "initial depth + 5 %",
            where,
            simulated(where, plant="initial depth", value=1.05),
            ("wrong initial depth",),
        )
        arm = 0.08 * np.sqrt(2 * SCENES[where][0].indenter.radius * plain["depth"][0])
        yield (
            "lever arm",
            where,
            simulated(where, plant="lever arm", value=arm),
            ("lever arm of friction_force",),
        )
        yield (
            "friction sign",
            where,
            {**plain, "friction_force": -plain["friction_force"]},
            ("sign of friction_force",),
        )
    for where in ("Table 1", "soft"):
        plain = simulated(where)
        yield (
            "undeformed",
            where,
            simulated(where, plant="undeformed"),
            ("undeformed at the start",),
        )
        yield "3 ms late", where, {**plain, "time": plain["time"] + 3e-3}, ("time offset",)
        yield "1000 s late", where, {**plain, "time": plain["time"] + 1e3}, ("time offset",)
        yield (
            "forces in N",
            where,
            {**plain, "normal_force": 1e3 * plain["normal_force"]},
            ("unit of normal_force",),
        )
    back = simulated("reversal", plant="no relaxation")
    yield "no relaxation", "reversal", back, ("no relaxation of the free surface",)
    right = simulated("Table 1", plant="radius at the right depth", value=1.05)
    yield "R x 1.05, depth kept", "Table 1", right, ("wrong R",)
    yield "no damping", "Table 1", simulated("Table 1", plant="no damping"), ()
    yield "shape |x|^2.2", "Table 1", simulated("Table 1", plant="shape", value=2.2), ()


def main():
    """Print what is found in each."""
    agree = named = seen = count = number = 0
    for title, where, data, known in sound():
        found = kv.compare(SCENES[where][0], data, **known)
        agree, number = agree + (found.verdict == "agrees"), number + 1
        failed = [f"{c.name} {c.measured / c.allowed:.2f}" for c in found.checks if c.ok is False]
        print(f"{'ok' if not failed else 'NO'}  {title:26s} {found.verdict} {failed}", flush=True)
    for title, where, data, names in faults():
        found = kv.compare(SCENES[where][0], data)
        seen, count = seen + (found.verdict == "disagrees"), count + 1
        first = found.explanations[0] if found.explanations else None
        hit = first is not None and first.name in names
        named += hit
        others = [(each.name, each.factor) for each in found.explanations if each.enough]
        shown = None if first is None else (first.name, round(first.rank, 2), first.factor)
        print(
            f"{'ok' if hit else 'NO'}  {where:10s} {title:22s} {found.verdict} {shown} {others}",
            flush=True,
        )
    print(f"sound: {agree} of {number} agree; faults: {seen} of {count} seen, {named} named first")
    return 0


if __name__ == "__main__":
    sys.exit(seeds(int(sys.argv[2])) if len(sys.argv) > 2 else main())
