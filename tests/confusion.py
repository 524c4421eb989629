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
from kvtheory.checks.faults import parameters_of
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


LEVELS = 1e-6, 1e-4, 1e-2
"""Noise of the series of random scenes, relative to each value."""
KINDS = {"line": {}, "suspended": {}, "reversal": {}, "spring": {}}


def random_scene(rng, kind):
    """Return a cylinder of random size, load and foundation, as fast as its foundation relaxes or slower."""
    R, K, tau = 10.0 ** rng.uniform([-2.3, 9.0, -1.7], [-1.5, 10.5, -0.3])
    M = 10.0 ** rng.uniform(2.0, 3.5)
    rest = kv.steady(
        kv.Scene(kv.Parabola(R), kv.Foundation(K, tau), kv.DeadWeight(M), kv.Drive(0.0))
    )
    a, depth = float(rest.half_length), float(rest.depth)
    V = a / tau * 10.0 ** rng.uniform(-0.7, 0.5)
    T = float(rng.uniform(0.7, 1.5)) * max(tau, 3.0 * a / V)
    k = M * 9.80665 / depth
    support, drive = kv.DeadWeight(M), kv.Drive(V)
    if kind == "suspended":
        support = kv.Suspended(mass=M, stiffness=k * float(rng.uniform(0.3, 3.0)))
    if kind == "reversal":
        drive = kv.Drive(history=[(0.0, V), (0.4 * T, V), (0.4 * T, -0.6 * V), (T, -0.6 * V)])
    if kind == "spring":
        k_x = 0.1 * k * float(rng.uniform(1.0, 10.0))
        drive = kv.Drive(V, stiffness=k_x, damping=0.3 * (k_x * M) ** 0.5)
    return kv.Scene(kv.Parabola(R), kv.Foundation(K, tau), support, drive, kv.Run(T))


def columns(scene, rows=241):
    """Return theory of a scene, which here is somebody else's simulator, at uneven times from rest on."""
    end = scene.run.duration
    at = np.unique([*np.linspace(0.0, end, rows - 80), *(end * np.geomspace(1e-4, 0.1, 80))])
    found = kv.transient(scene, at=at, rtol=1e-9, certify=False)
    names = *FEW[1:], "leading_edge", *(() if scene.drive.rigid else ("spring_force",))
    still = kv.steady(scene, over={"drive.velocity": 0.0})
    rest = {FEW[1]: still.depth, FEW[2]: still.load, "leading_edge": -still.half_length}
    moving = {n: np.array([float(rest.get(n, 0.0)), *getattr(found, n)]) for n in names}
    return {"time": np.array([-1e-3 * end, *at]), **moving}


def late(series, delay, names):
    """Return a series with columns that are late by a time, before which they are at rest."""
    at = np.maximum(series["time"] - delay, series["time"][0])
    return {**series, **{n: np.interp(at, series["time"], series[n]) for n in names}}


def filtered(series, constant, names):
    """Return a series with columns behind a low pass, exact for straight lines between the samples."""
    time, moved = series["time"], {}
    for name in names:
        x, y = series[name], [series[name][0]]
        for k, h in enumerate(np.diff(time)):
            slope, kept = (x[k + 1] - x[k]) / h, np.exp(-h / constant)
            y.append(x[k + 1] - slope * constant + kept * (y[-1] - x[k] + slope * constant))
        moved[name] = np.array(y)
    return {**series, **moved}


FORCES = "normal_force", "friction_force"
EDITS = {
    "sign of friction_force": lambda s, _f: {**s, FORCES[1]: -s[FORCES[1]]},
    "unit of normal_force": lambda s, _f: {**s, FORCES[0]: 1e3 * s[FORCES[0]]},
    "unit of depth": lambda s, _f: {**s, "depth": 0.1 * s["depth"]},
    "scale of normal_force": lambda s, f: {**s, FORCES[0]: f * s[FORCES[0]]},
    "scale of friction_force": lambda s, f: {**s, FORCES[1]: f * s[FORCES[1]]},
    "offset of normal_force": lambda s, f: {**s, FORCES[0]: s[FORCES[0]] + (f - 1.0) * s[FORCES[0]][0]},
    "offset of depth": lambda s, f: {**s, "depth": s["depth"] + (f - 1.0) * s["depth"][0]},
    "drift of friction_force": lambda s, f: {**s, FORCES[1]: s[FORCES[1]] + (f - 1.0) * s[FORCES[0]][0]
                                             * s["time"] / s["time"][-1]},
    "dry friction of friction_force": lambda s, f: {**s, FORCES[1]: s[FORCES[1]] - abs(f - 1.0)
                                                    * np.sign(s["leading_edge"]) * s[FORCES[0]]},
    "delay of both forces": lambda s, f: late(s, abs(f - 1.0) * 0.2 * s["time"][-1], FORCES),
    "low pass of both forces": lambda s, f: filtered(s, abs(f - 1.0) * 0.2 * s["time"][-1], FORCES),
    "time offset": lambda s, f: {**s, "time": s["time"] + (f - 1.0) * 0.3 * s["time"][-1]},
    "unit of time": lambda s, _f: {**s, "time": 1e3 * s["time"]},
}  # fmt: skip
"""Columns that are changed on their way, with a factor by how much."""
WRONG = {
    "line": (*SYMBOLS, "inertia"), "suspended": ("k_s", "tau", "K"), "reversal": ("tau", "V"),
    "spring": ("k_x", "M_x", "c_x", "M_z", "inertia along z"),
}  # fmt: skip
RULED = {"line": ("pull", "dropped"), "reversal": ("stale", "forgetful", "cleared", "frozen")}
"""The parameters and contact rules that are wrong in each kind of scene."""


def random_faults(seed):
    """Yield scene, sound series, wrong series without noise, and the right name: each kind of fault once."""
    rng = np.random.default_rng(seed)
    for kind in KINDS:
        for symbol in WRONG[kind]:
            scene = random_scene(rng, kind)
            powers = {p.symbol: p.powers for p in parameters_of(scene)}
            if symbol in powers:
                wrong = scaled_scene(
                    scene, powers[symbol], float(rng.choice([0.8, 0.95, 1.1, 1.3]))
                )
                yield scene, columns(scene), columns(wrong), f"wrong {symbol}"
        for name in EDITS if kind in ("line", "reversal") else ():
            scene = random_scene(rng, kind)
            sound = columns(scene)
            yield scene, sound, EDITS[name](sound, float(rng.choice([0.9, 1.05, 1.2]))), name
        for rule in RULED.get(kind, ()):
            scene = random_scene(rng, kind)
            a = float(kv.steady(scene, over={"drive.velocity": 0.0}).half_length)
            stable = scene.support.mass / (
                3.0 * scene.foundation.damping * a
            )  # of an explicit scheme
            how = {"per_length": 200.0 / a, "time_step": min(scene.run.duration / 1500.0, stable)}
            sound, wrong = (simulate(scene, **how, rule=each) for each in ("peel", rule))
            names = (*FEW, "leading_edge")
            yield scene, sound, {n: wrong[n] for n in names}, RULES[rule]


def judged(scene, sound, wrong, name, level, seed):
    """Return how a fault was judged, its effect, and the comparison.

    It is "first", "tied", "unseen", "unnamed", "not all" or "wrongly" asserted. The effect is the largest
    root mean square of a column's change, relative to the column's largest value.
    """
    rng, effect = np.random.default_rng(seed), 0.0
    for each in (n for n in wrong if n in sound and n != "leading_edge"):
        if wrong[each].size == sound[each].size:
            off = np.nan_to_num(wrong[each] - sound[each])
            effect = max(
                effect, float(np.sqrt(np.mean(off * off)) / np.nanmax(np.abs(sound[each])))
            )
    noisy = {n: x * (1.0 + level * rng.standard_normal(x.size)) if n != "time" else x
             for n, x in wrong.items() if n != "leading_edge"}  # fmt: skip
    found = kv.compare(scene, noisy)
    if found.verdict != "disagrees":
        return "unseen", effect, found
    if not found.explanations:
        return "unnamed", effect, found
    first, *rest = found.explanations
    tied = {e.name for e in rest if e.enough and first.enough} | {f"wrong {n}" for n in first.alike}
    if first.name == name:
        return "first", effect, found
    return ("tied" if name in tied else "wrongly" if first.enough else "not all"), effect, found
