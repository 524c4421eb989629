"""Faults other than contact rules, as hypotheses.

A fault is a wrong parameter of the scene, another scene, a column with a wrong sign, unit, scale, offset or
lever arm, or wrong times.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from kvtheory.checks.hypotheses import (
    VELOCITY,
    WRONG,
    Bench,
    Hypothesis,
    Pair,
    fixed,
    power_of_ten,
    scaled_scene,
)  # fmt: skip
from kvtheory.checks.theory import CURVES, Array
from kvtheory.scene import Drive, Scene
from kvtheory.scene.foundations import Foundation, GeneralizedMaxwell


class Parameter(NamedTuple):
    """A quantity of a scene: its symbol, the keys that it scales with their powers, and a remark."""

    symbol: str
    powers: Mapping[str, float]
    words: str = ""


PARAMETERS = (
    Parameter("tau", {"foundation.retardation_time": 1.0}),
    Parameter("K", {"foundation.stiffness": 1.0}),
    Parameter("C", {"foundation.damping": 1.0}, " (the damper beside the arms)"),
    Parameter("R", {"indenter.radius": 1.0}),
    Parameter("M", {"support.mass": 1.0}),
    Parameter("g", {"support.gravity": 1.0}),
    Parameter("inertia", {"support.mass": 1.0, "support.gravity": -1.0},
              " as inertia alone (Eq. 17), the weight being right"),
    Parameter("M_z", {"support.mass": 1.0, "drive.mass": 0.0},
              " (what moves along z, the mass along x being right)"),
    Parameter("inertia along z", {"support.mass": 1.0, "support.gravity": -1.0, "drive.mass": 0.0},
              " (Eq. 17), the weight and the mass along x being right"),
    Parameter("k_s", {"support.stiffness": 1.0}),
    Parameter("delta", {"support.depth": 1.0}),
    Parameter("V", {VELOCITY: 1.0}),
    Parameter("k_x", {"drive.stiffness": 1.0}, " (the spring in the drive)"),
    Parameter("M_x", {"drive.mass": 1.0}, " (what moves along x)"),
    Parameter("c_x", {"drive.damping": 1.0}, " (beside the spring in the drive)"),
    Parameter("R_y", {"indenter.radius_across": 1.0}, " (across the motion)"),
)  # fmt: skip
"""The parameters that may be wrong, if the scene has them."""
USUAL = {"s": ("ms", 1e3), "m": ("mm", 1e3), "m/s": ("mm/s", 1e3), "N/m^3": ("GN/m^3", 1e-9),
         "N*s/m^3": ("GN s/m^3", 1e-9),
         "kg/m": ("kg/mm", 1e-3), "N/m^2": ("MN/m^2", 1e-6), "N/m": ("MN/m", 1e-6)}  # fmt: skip
"""The units in which parameters are shown, by their SI unit."""


def parameters_of(scene: Scene) -> Iterator[Parameter]:
    """Yield the parameters of a scene, those of each arm among them."""
    values = scene.values()
    shared = scene.drive.mass is None
    for each in PARAMETERS:
        known = all(values.get(key) or key == VELOCITY for key in each.powers)
        if known and (shared or each.powers.get("drive.mass") != 0.0):  # else it is M or inertia
            yield each
    for symbol, name in (("K", "stiffness"), ("tau", "relaxation_time")):
        arms = (key for key in values if key.startswith("foundation.arms["))
        keys = [key for key in arms if key.endswith(f".{name}")]
        for i, key in enumerate(keys, start=1):
            yield Parameter(f"{symbol}_{i}", {key: 1.0}, f" (arm {i})")
        if len(keys) > 1:
            words = " (that of the first arm, the others alike)"
            yield Parameter(f"all {symbol}_i", dict.fromkeys(keys, 1.0), words)
    listed = {key for each in PARAMETERS for key in each.powers}
    for name in scene.foundation.own:  # of a law that is not listed above
        if (key := f"foundation.{name}") in values and key not in listed:
            yield Parameter(name.replace("_", " "), {key: 1.0})


GROUPS = {
    **{name: (name,) for name in CURVES if name != "velocity"},
    "friction_coefficient": ("friction_coefficient",),
    "both forces": ("normal_force", "friction_force"),
    "both forces along x": ("friction_force", "spring_force"),
    "both edges": ("leading_edge", "trailing_edge"),
    "the lengths": ("depth", "leading_edge", "trailing_edge"),
}
"""Columns that may share a wrong sign, unit or scale."""
SIGNS = {
    "friction_force": ": F_x on the indenter is positive for V > 0 (Eqs. 13 and 15)",
    "depth": ": delta = -z_A is positive (Eq. 18)",
    "spring_force": ": the spring force balances F_x, and has its sign",
    "normal_force": ": F_z on the indenter is positive (Eqs. 12 and 14)",
}
"""What fixes the sign of a column."""
MEASURED = "friction_coefficient", "normal_force", "friction_force", "spring_force", "depth"
"""Columns measured by a sensor, whose zero may be off."""
FACTORS = (0.5, 2.0, 0.1, 10.0, 1e-3, 1e3)
"""Remote initial guesses for the factor of a parameter: a diameter for a radius, and wrong units; the first
two alone where theory is a simulation by elements, which takes longer."""
LARGEST_FACTOR, SMALLEST_FACTOR = 2e3, 1e-9
"""Largest factor of a fitted parameter, up or down: no wrong unit is farther off; smallest of a column."""
DAMPING_SHARES = (0.01, 0.03, 0.1, 0.3, 1.0)
"""Initial guesses for a damper, as fractions of critical damping."""
LEAST = {"dry friction": 0.0}
"""Smallest number of what is added to a column, where a smaller one would be unphysical."""
RAMPS = (0.01, 0.05, 0.2)
"""Initial guesses for the time in which the velocity rises, in spans of the data."""
NOTHING = 1e-6
"""Largest value, relative to the scale of a column, that counts as zero."""
FRICTION = "friction_coefficient", "friction_force", "spring_force"
MADE_BY = "; in theory it comes from the sliding term -h' V of the rate, and from the damper (Eqs. 5 and 7)"
"""Columns that contain friction, and its origin."""
CUT_OFF = "digits cut off"
"""The name of a fault within the resolution of the data: where it is enough, nothing else is asserted."""
DECADES = (-6, -3, -2, -1, 1, 2, 3)
"""Powers of ten by which the times may be off."""
TIME_UNIT = "time: off by a power of ten, 10^{}; check the unit"
LONGEST = 30.0
"""Longest motion that is computed to try a unit of the time, in durations of the run or of the data."""
SHIFTS = (0.002, 0.005, 0.012, 0.03, 0.08, 0.2, 0.5)
"""Initial guesses for an offset of the time, in both directions, in spans of the data."""
HUNDREDTH = 0.01
"""Unit in which an offset of the time is fitted, as a fraction of the span."""
FORCES = "normal_force", "friction_force"
"""Columns that may be late or filtered, together or alone."""
SIGNED = "friction_coefficient", "friction_force", "spring_force", "velocity", "sliding_velocity"
"""Columns whose sign follows that of the velocity."""
DELAYS, TIME_CONSTANTS = np.geomspace(0.02, 50.0, 60), (0.05, 0.2, 0.5, 1.2, 3.0, 8.0, 20.0)
"""Initial guesses for a delay, dense as a force may jump; and for a time constant; in 1/100 of the span."""
SMALL = 1e-6
"""A step relative to a time constant, below which it is expanded."""
ONSET = 0.1
"""Change of a force, relative to its range, from which the drive has started."""


def parameters(bench: Bench) -> Iterator[Hypothesis]:
    """Fit each parameter of the scene."""
    theory, scene = bench.theory, bench.theory.scene
    values = {**scene.values(), VELOCITY: theory.final_velocity or theory.motion.highest_speed}

    def scaled(factor: float, powers: Mapping[str, float]) -> Pair | None:
        if factor == 1.0 or not 1.0 / LARGEST_FACTOR < factor < LARGEST_FACTOR:
            return (bench.columns, bench.now) if factor == 1.0 else None
        return bench.against(scaled_scene(scene, powers, factor))

    remote = np.log(FACTORS[:2] if theory.by_elements else FACTORS).tolist()
    for symbol, powers, words in parameters_of(scene):
        key = next(iter(powers))
        si = scene.replaceable[key].unit
        unit, per_si = USUAL.get(si, (si.replace("*", " "), 1.0))
        old = values[key] * per_si
        size = f"{{1:.4g}} {unit} rather than {old:.4g} {unit}, {{2}}"
        yield Hypothesis(
            f"{WRONG}{symbol}", f"the data fit {symbol} = {size}{words}", partial(scaled, powers=powers),
            [0.0], shown=old, log=True, remote=remote, powers=powers,
        )  # fmt: skip


def other_scenes(bench: Bench) -> Iterator[Hypothesis]:
    """Replace arms by a damper or leave one out, the spring in the drive by a rigid one, or add a damper."""
    scene = bench.theory.scene
    K, C = scene.foundation.stiffness, scene.foundation.damping
    arms = [(a.stiffness, a.relaxation_time) for a in scene.foundation.arms]
    maxwell: Any = partial(GeneralizedMaxwell, damping=C)  # takes pairs

    def other(name: str, text: str, **parts: Any) -> Hypothesis:
        return fixed(name, text, bench.against(replace(scene, **parts)))

    if arms:
        text = (
            f"the foundation of the data is Kelvin-Voigt, with the damping C {'+' if C else '='} sum K_i "
            "tau_i: its arms have no stiffness and no relaxation times, which count unless the motion is "
            "slow (F18)"
        )
        damper = Foundation(K, scene.foundation.retardation_time)
        yield other("Kelvin-Voigt instead of arms", text, foundation=damper)
        if C:
            text = f"the damper beside the arms is missing: {C:.4g} N s/m^3"
            yield other("damper missing", text, foundation=maxwell(K, arms, damping=0.0))
        relaxed = K - sum(K_i for K_i, _ in arms)
        if relaxed > 0.0:
            text = "the stiffness of the scene is taken for the glassy one: it is the relaxed one"
            yield other("glassy stiffness", text, foundation=maxwell(relaxed, arms))
        for i, (K_i, tau_i) in enumerate(arms):
            left, which = arms[:i] + arms[i + 1 :], f"arm {i + 1}"
            if left:
                text = f"{which} is missing: {K_i:.4g} N/m^3 with {tau_i * 1e3:.4g} ms"
                yield other(f"{which} missing", text, foundation=maxwell(K, left))
    V, jumps = bench.theory.final_velocity, scene.drive.constant and scene.drive.rigid
    if jumps and V and scene.start.at_rest and not bench.series.curve:
        text = "the velocity of the data rises to V within {1:.4g} ms: that of the scene jumps at the start"
        yield Hypothesis(
            "drive that starts slowly", text,
            lambda time: bench.against(replace(scene, drive=Drive(history=[(0.0, 0.0), (time, V)]))),
            np.log(RAMPS).tolist(), float(bench.time[-1]), log=True,
        )  # fmt: skip
    if not scene.drive.rigid:
        text = (
            "the drive of the data is rigid: the indenter slides at the velocity of the drive, while it "
            "oscillates on the spring of the scene (F22)"
        )
        rigid = replace(scene.drive, stiffness=None, damping=None, mass=None)
        start = replace(scene.start, sliding_velocity=None)
        yield other("rigid drive instead of a spring", text, drive=rigid, start=start)
        if scene.drive.damping:
            text = "the spring in the drive has no damper beside it, which the scene has"
            yield other(f"{WRONG}c_x", text, drive=scene.drive.changed(damping=0.0))
        else:
            text = "the data fit a damper c_x = {:.4g} N s/m^2 beside the spring, which has none"
            yield Hypothesis(
                f"{WRONG}c_x", text,
                lambda c_x: bench.against(replace(scene, drive=scene.drive.changed(damping=c_x))),
                np.log(DAMPING_SHARES).tolist(), log=True,
                unit=2.0 * math.sqrt(scene.drive.stiffness * scene.drive_mass),
            )  # fmt: skip


def signs_and_units(bench: Bench) -> Iterator[Hypothesis]:
    """Try wrong signs and units, exchanged edges, and a reversed drive."""
    for title, factor, exact, pair in _factors(bench):
        power, names = power_of_ten(factor), title.replace("_", " ")
        if power == 0 and exact < 0.0:
            text = f"{names}: has the wrong sign{SIGNS.get(title, '')}"
            yield fixed(f"sign of {title}", text, pair, exact)
        elif power:
            sign = "" if exact > 0.0 else " and has the wrong sign"
            text = f"{names}: off by a power of ten, 10^{-power}{sign}; check the unit"
            yield fixed(f"unit of {title}", text, pair, 1.0 / exact)
    for name in bench.names:
        if np.nanmax(np.abs(bench.columns[name])) <= NOTHING * bench.theory.scales[name]:
            there = {**bench.now, name: np.zeros_like(bench.time)}
            text = f"{name.replace('_', ' ')}: zero throughout{MADE_BY * (name in FRICTION)}"
            yield fixed(f"no {name}", text, (bench.columns, there))
    edges = GROUPS["both edges"]
    if set(edges) <= set(bench.names):
        exchanged = dict(zip(edges, [bench.columns[name] for name in reversed(edges)], strict=True))
        text = "the edges are exchanged: the leading one is where the foundation enters, at x < 0 for V > 0"
        yield fixed("edges exchanged", text, ({**bench.columns, **exchanged}, bench.now))
    for name in SIGNED:
        if name in bench.names and (bench.now[name] < -bench.allowed(name)).any():
            text = f"{name.replace('_', ' ')}: its magnitude is given, without the sign that reverses with V"
            given = {**bench.now, name: np.abs(bench.now[name])}
            yield fixed(f"sign of {name} lost", text, (bench.columns, given))
    backward = scaled_scene(bench.theory.scene, {"drive.velocity": 1.0}, -1.0)
    text = "the base moves in the other direction: x and V have the other sign"
    yield fixed("direction of the drive", text, bench.against(backward), -1.0)


def scales_and_offsets(bench: Bench) -> Iterator[Hypothesis]:
    """Fit scale, offset and drift of columns, and what may be added to the friction force."""
    theory, columns, now, friction = bench.theory, bench.columns, bench.now, "friction_force"
    for title, factor, _, _ in _factors(bench):
        if power_of_ten(factor) in (None, 0) and factor > 0.0:
            text = f"{title.replace('_', ' ')}: {{2}} theory, while the rest agrees"
            make = partial(_multiplied, bench, GROUPS[title])
            yield Hypothesis(f"scale of {title}", text, make, [1.0 / factor], least=SMALLEST_FACTOR)
    share = (bench.time - bench.time[0]) / (bench.time[-1] - bench.time[0])
    added = [
        (title, name, theory.scales[name], by, f"off by {{:.4g}} {theory.units.get(name, '')} {where}")
        for name in bench.names if name in MEASURED
        for title, by, where in (
            ("offset", np.ones_like(share), "throughout, while the rest agrees"),
            ("drift", share, "at the end, in proportion to the time"),
        )
    ]  # fmt: skip
    if friction in bench.names:
        pressed = columns.get("normal_force", now["normal_force"])
        half, against = theory.static.half_length, np.sign(now["sliding_velocity"])
        arm = (
            "its lever arm is off by {1:.3g} mm, F_x being the moment of the pressure about another point "
            "than the lowest of the indenter (Eqs. 13 and 15)"
        )
        dry = (
            "holds a dry friction of {:.3g} F_z beside that of the foundation, which is all that a smooth "
            "indenter has (Eq. 15)"
        )
        added += [("lever arm", friction, half, pressed / theory.radius, arm),
                  ("dry friction", friction, 1.0, against * pressed, dry)]  # fmt: skip

    def without(part: float, name: str, by: Array) -> Pair:
        return {**columns, name: columns[name] - part * by}, now

    for title, name, unit, by, words in added:
        text, make = f"{name.replace('_', ' ')}: {words}", partial(without, name=name, by=by)
        yield Hypothesis(
            f"{title} of {name}", text, make, [0.0], unit, least=LEAST.get(title, -math.inf)
        )
    failing = [n for n in bench.names if (bench.excess(n) > bench.limit(n)).any()]
    digits = {name: np.nan_to_num(bench.bands[name].rounding) for name in failing}
    if any(half.any() for half in digits.values()):
        cut = {name: x + np.sign(x) * digits.get(name, 0.0) for name, x in columns.items()}
        text = (
            "the difference is within the last digit of the data: digits are cut off, not rounded, or too "
            "few to name a fault"
        )
        yield fixed(CUT_OFF, text, (cut, now))


def _factors(bench: Bench) -> Iterator[tuple[str, float, float, Pair]]:
    """Yield by group of columns the factor that fits best, the one to try, and the pair that it gives."""
    for title, group in GROUPS.items():
        if not set(group) <= set(bench.names):
            continue
        limits = [bench.allowed(n) for n in group]
        pair = bench.columns, bench.now
        data, theory = (np.array([curves[n] for n in group]) / limits for curves in pair)
        known = np.isfinite(data) & np.isfinite(theory)
        square = float(data[known] @ data[known])
        factor = float(data[known] @ theory[known]) / square if square else math.nan
        if math.isfinite(factor) and factor != 0.0:
            power = power_of_ten(factor)
            plain = power is None or (power == 0 and factor > 0.0)
            exact = factor if plain else math.copysign(10.0 ** (power or 0), factor)
            yield title, factor, exact, _multiplied(bench, group, 1.0 / exact)


def _multiplied(bench: Bench, group: Sequence[str], factor: float) -> Pair:
    """Return the data with the columns of a group divided by a factor that they hold, and theory."""
    scaled = {name: _scaled(bench, name, 1.0 / factor) for name in group}
    return {**bench.columns, **scaled}, bench.now


def _scaled(bench: Bench, name: str, factor: float) -> Array:
    """Return a column times a factor, its difference relative to errors of the data that grow with it."""
    band, now = bench.bands[name], bench.now[name]
    smooth, limit = band.systematic - band.rounding, band.limit()
    return now + (factor * bench.columns[name] - now) * limit / (
        smooth + abs(factor) * (limit - smooth)
    )


def time_units(bench: Bench) -> Iterator[Hypothesis]:
    """Multiply the times by powers of ten that leave some motion.

    Much later all is steady sliding, and much sooner the start: any such unit fits data that are constant.
    """
    scene, end = bench.theory.scene, float(bench.time[-1])
    ends = scene.run.duration, end
    shortest, longest = min(ends) / LONGEST, LONGEST * max(ends)
    for power in (power for power in DECADES if shortest <= end * 10.0**power <= longest):
        pair = bench.against(scene, bench.time * 10.0**power)
        yield fixed("unit of time", TIME_UNIT.format(-power), pair, 10.0**-power)


def delays(bench: Bench) -> Iterator[Hypothesis]:
    """Fit an offset of the time from several starts, and the delay or a filter of forces."""
    end, span = float(bench.time[-1]), float(bench.time[-1] - bench.time[0])
    if not bench.theory.scene.drive.rigid and end > LONGEST * bench.theory.scene.run.duration:
        return
    unit = HUNDREDTH * span
    values = bench.columns[next(name for name in MEASURED if name in bench.columns)]
    change = np.abs(values - values[0])
    onset = bench.time[np.argmax(change >= ONSET * np.nanmax(change))]
    starts = [0.0, float(bench.time[0]) / unit, float(onset) / unit]
    starts += [share / HUNDREDTH for part in SHIFTS for share in (part, -part)]
    text = "the times are off by {1:.6g} ms: in the data the drive starts at that time"
    yield Hypothesis("time offset", text, bench.late, starts, unit)

    def shorter(make: Callable[..., Pair], names: Sequence[str]) -> Callable[[float], Pair | None]:
        return lambda time: make(time, names) if time <= span else None  # no longer one shows

    kinds: Any = (
        ("delay", "late by {1:.4g} ms, while the rest agrees", bench.late, DELAYS),
        ("low pass", "filtered by a low pass, its time constant {1:.4g} ms", partial(_filtered, bench),
         TIME_CONSTANTS),
    )  # fmt: skip
    for title, names in (("both forces", FORCES), *((name, (name,)) for name in FORCES)):
        for kind, words, make, guesses in kinds if set(names) <= set(bench.names) else ():
            if kind != "delay" or len(bench.names) > len(names):  # else it is an offset of the time
                yield Hypothesis(
                    f"{kind} of {title}", f"{title.replace('_', ' ')}: {words}", shorter(make, names),
                    np.log(guesses).tolist(), unit, log=True, last=True,
                )  # fmt: skip


def _filtered(bench: Bench, time_constant: float, names: Sequence[str]) -> Pair:
    """Return the data, and theory with curves that went through a low pass of the first order."""
    known, now = bench.dense, {}
    z = np.diff(known["time"]) / time_constant
    kept = np.exp(-z)
    mean = np.where(z > SMALL, -np.expm1(-z) / np.maximum(z, SMALL), 1.0 - 0.5 * z)
    for name in names:
        x, found = known[name], [float(bench.columns[name][0])]
        # Exact for a straight line between two instants.
        driven = (mean - kept) * x[:-1] + (1.0 - mean) * x[1:]
        for fall, added in zip(kept.tolist(), driven.tolist(), strict=True):
            found.append(fall * found[-1] + added)
        now[name] = np.interp(bench.time, known["time"], found)
    return bench.columns, {**bench.now, **now}
