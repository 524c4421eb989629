"""Faults other than contact rules, as hypotheses.

A fault is a wrong parameter of the scene, another scene, a column with a wrong sign, unit, scale, offset or
lever arm, or wrong times.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from kvtheory.checks.fitting import Bench, Hypothesis, Pair, fixed, scaled_scene
from kvtheory.checks.theory import CURVES
from kvtheory.scene.foundations import Foundation


class Parameter(NamedTuple):
    """A quantity of a scene: its symbol, the keys that it scales with their powers, and how it is shown."""

    symbol: str
    powers: Mapping[str, float]
    unit: str
    per_si: float
    words: str = ""


PARAMETERS = (
    Parameter("tau", {"foundation.retardation_time": 1.0}, "ms", 1e3),
    Parameter("K", {"foundation.stiffness": 1.0}, "GN/m^3", 1e-9),
    Parameter("R", {"indenter.radius": 1.0}, "mm", 1e3),
    Parameter("M", {"support.mass": 1.0}, "kg/mm", 1e-3),
    Parameter("g", {"support.gravity": 1.0}, "m/s^2", 1.0),
    Parameter("inertia", {"support.mass": 1.0, "support.gravity": -1.0}, "kg/mm", 1e-3,
              " as inertia alone (Eq. 17), the weight being right"),
    Parameter("k_s", {"support.stiffness": 1.0}, "MN/m^2", 1e-6),
    Parameter("delta", {"support.depth": 1.0}, "mm", 1e3),
    Parameter("V", {"drive.velocity": 1.0}, "mm/s", 1e3),
    Parameter("k_x", {"drive.stiffness": 1.0}, "MN/m^2", 1e-6, " (the spring in the drive)"),
    Parameter("M_x", {"drive.mass": 1.0}, "kg/mm", 1e-3, " (what moves along x)"),
    Parameter("c_x", {"drive.damping": 1.0}, "N s/m^2", 1.0, " (beside the spring in the drive)"),
)  # fmt: skip
"""The parameters that may be wrong; those that the scene does not have are left out."""
PER_WIDTH = {"kg/mm": ("kg", 1.0), "MN/m^2": ("MN/m", 1e-6), "N s/m^2": ("N s/m", 1.0)}
"""Units of a line contact, and those of a ball in their place."""
WRONG = "wrong "
"""Prefix of the names of faults that are a wrong parameter."""
GROUPS = {
    **{name: (name,) for name in CURVES if name != "velocity"},
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
MEASURED = "normal_force", "friction_force", "spring_force", "depth"
"""Columns measured by a sensor, whose zero may be off."""
FACTORS = (1.0, 0.5, 2.0, 0.1, 10.0, 1e-3, 1e3)
"""Initial guesses for the factor of a parameter: near 1, and those of wrong units."""
LARGEST_FACTOR = 2e3
"""Factor up and down beyond which a fitted parameter explains nothing: no wrong unit is so far off."""
DAMPING_SHARES = (0.01, 0.1, 1.0)
"""Initial guesses for a damper, as fractions of critical damping."""
POWER_OF_TEN = 0.02
"""A factor counts as a power of ten if its decadic logarithm is this close to a whole number."""
DECADES = (-6, -3, -2, -1, 1, 2, 3)
"""Powers of ten by which the times may be off."""
LONGEST = 30.0
"""Longest motion on a spring that is computed to try a unit, in durations of the run or of the data."""
SHIFTS = (0.002, 0.005, 0.012, 0.03, 0.08, 0.2, 0.5)
"""Initial guesses for an offset of the time, in both directions, as fractions of the span of the data."""
HUNDREDTH = 0.01
"""Unit in which an offset of the time is fitted, as a fraction of the span."""
ONSET = 0.1
"""Fraction of the range of a force: once the force has changed by this much, the drive has started."""


def _power_of_ten(factor: float) -> int | None:
    """Return the power if a factor is a power of ten, or its negative."""
    power = math.log10(abs(factor))
    return round(power) if abs(power - round(power)) < POWER_OF_TEN else None


def parameters(bench: Bench) -> Iterator[Hypothesis]:
    """Fit each parameter of the scene; from 1 only where each theory is a run of many elements."""
    theory, scene = bench.theory, bench.theory.scene
    values = {"drive.velocity": theory.final_velocity, **scene.values()}
    starts = [0.0] if theory.by_elements else np.log(FACTORS).tolist()

    def scaled(x: float, powers: Mapping[str, float]) -> Pair | None:
        if abs(x) > math.log(LARGEST_FACTOR):
            return None
        return bench.against(scaled_scene(scene, powers, math.exp(x)))

    def text(x: float, parameter: Parameter) -> str:
        unit, per_si = parameter.unit, parameter.per_si
        if not scene.indenter.per_width:
            unit, per_si = PER_WIDTH.get(unit, (unit, per_si))
        old, factor = values[next(iter(parameter.powers))] * per_si, math.exp(x)
        ten = " (a power of ten: check its unit)" if _power_of_ten(factor) else ""
        size = f"{factor * old:.4g} {unit} rather than {old:.4g} {unit}, {factor:.4g} times"
        return f"the data fit {parameter.symbol} = {size}{parameter.words}{ten}"

    for each in PARAMETERS:
        if all(values.get(name) for name in each.powers):
            yield Hypothesis(
                f"{WRONG}{each.symbol}", partial(text, parameter=each),
                partial(scaled, powers=each.powers), starts, factor=math.exp, powers=each.powers,
            )  # fmt: skip


def other_scenes(bench: Bench) -> Iterator[Hypothesis]:
    """Replace arms by a damper, the spring in the drive by a rigid drive."""
    scene = bench.theory.scene
    if scene.foundation.arms:
        plain = Foundation(scene.foundation.stiffness, scene.foundation.retardation_time)
        text = (
            "the foundation of the data is Kelvin-Voigt, with the damping C = sum K_i tau_i: its arms have "
            "no stiffness and no relaxation times, which count unless the motion is slow (F18)"
        )
        pair = bench.against(replace(scene, foundation=plain))
        yield fixed("Kelvin-Voigt instead of arms", text, pair)
    if not scene.drive.rigid:
        rigid = replace(scene.drive, stiffness=None, damping=None, mass=None)
        text = (
            "the drive of the data is rigid: the indenter slides at the velocity of the drive, while it "
            "oscillates on the spring of the scene (F22)"
        )
        pair = bench.against(replace(scene, drive=rigid))
        yield fixed("rigid drive instead of a spring", text, pair)


def damper(bench: Bench) -> Iterator[Hypothesis]:
    """Fit a damper beside a spring that has none."""
    scene = bench.theory.scene
    if scene.drive.stiffness is None or scene.drive.damping:
        return
    critical = 2.0 * math.sqrt(scene.drive.stiffness * scene.drive_mass)
    text = (
        "the data fit a damper c_x = {:.4g} N s/m^2 beside the spring in the drive, which has none"
    )

    def damped(x: float) -> Pair | None:
        drive = scene.drive.changed(damping=math.exp(x) * critical)
        return bench.against(replace(scene, drive=drive))

    starts = np.log(DAMPING_SHARES).tolist()
    words = lambda x: text.format(math.exp(x) * critical)  # noqa: E731
    yield Hypothesis(f"{WRONG}c_x", words, damped, starts)


def signs_and_units(bench: Bench) -> Iterator[Hypothesis]:
    """Try wrong signs and units, exchanged edges, and a reversed drive."""
    for title, factor, exact, pair in _factors(bench):
        power, names = _power_of_ten(factor), title.replace("_", " ")
        if power == 0 and exact < 0.0:
            text = f"{names}: has the wrong sign{SIGNS.get(title, '')}"
            yield fixed(f"sign of {title}", text, pair, exact)
        elif power:
            sign = "" if exact > 0.0 else " and has the wrong sign"
            text = f"{names}: off by a power of ten, 10^{-power}{sign}; check the unit"
            yield fixed(f"unit of {title}", text, pair, 1.0 / exact)
    edges = GROUPS["both edges"]
    if set(edges) <= set(bench.names):
        exchanged = dict(zip(edges, [bench.columns[name] for name in reversed(edges)], strict=True))
        text = "the edges are exchanged: the leading one is where the foundation enters, at x < 0 for V > 0"
        yield fixed("edges exchanged", text, ({**bench.columns, **exchanged}, bench.now))
    backward = scaled_scene(bench.theory.scene, {"drive.velocity": 1.0}, -1.0)
    text = "the base moves in the other direction: x and V have the other sign"
    yield fixed("direction of the drive", text, bench.against(backward), -1.0)


def scales_and_offsets(bench: Bench) -> Iterator[Hypothesis]:
    """Fit the scale and the offset of columns, and the lever arm of the friction force."""
    theory, columns = bench.theory, bench.columns
    for title, factor, exact, pair in _factors(bench):
        if _power_of_ten(factor) is None:
            text = (
                f"{title.replace('_', ' ')}: {1.0 / exact:.4g} times theory, while the rest agrees"
            )
            yield fixed(f"scale of {title}", text, pair, 1.0 / exact)

    def shifted(title: str, name: str, by: object, words: str, unit: float) -> Hypothesis:
        """Return the fault of a column that is off by x times `by`; the text shows x times `unit`."""
        return Hypothesis(
            f"{title} of {name}", lambda x: words.format(x * unit, 1e3 * x * unit),
            lambda x: ({**columns, name: columns[name] - x * np.asarray(by)}, bench.now), [0.0],
            factor=partial(float.__mul__, unit),
        )  # fmt: skip

    for name in (name for name in bench.names if name in MEASURED):
        off = f"off by {{:.4g}} {theory.units[name]} throughout, while the rest agrees"
        words = f"{name.replace('_', ' ')}: {off}"
        yield shifted("offset", name, theory.scales[name], words, theory.scales[name])
    if "friction_force" in bench.names:
        half = theory.static.half_length
        moment = half / theory.radius * columns.get("normal_force", bench.now["normal_force"])
        words = (
            "friction force: its lever arm is off by {1:.3g} mm, F_x being the moment of the pressure about "
            "another point than the lowest of the indenter (Eqs. 13 and 15)"
        )
        yield shifted("lever arm", "friction_force", moment, words, half)


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
            power = _power_of_ten(factor)
            exact = factor if power is None else math.copysign(10.0**power, factor)
            changed = {**bench.columns, **{name: exact * bench.columns[name] for name in group}}
            yield title, factor, exact, (changed, bench.now)


def time_units(bench: Bench) -> Iterator[Hypothesis]:
    """Multiply the times by powers of ten; a cycle on a spring is not computed for too long."""
    scene, end = bench.theory.scene, float(bench.time[-1])
    longest = math.inf if scene.drive.rigid else LONGEST * max(scene.run.duration, end)
    for power in (power for power in DECADES if end * 10.0**power <= longest):
        text = f"time: off by a power of ten, 10^{-power}; check the unit"
        pair = bench.against(scene, bench.time * 10.0**power)
        yield fixed("unit of time", text, pair, 10.0**-power)


def time_offset(bench: Bench) -> Iterator[Hypothesis]:
    """Fit an offset of the time, first from zero, the start of the data, and the first change of a force."""
    scene, unit = bench.theory.scene, HUNDREDTH * float(bench.time[-1] - bench.time[0])
    values = bench.columns[next(name for name in MEASURED if name in bench.columns)]
    change = np.abs(values - values[0])
    onset = bench.time[np.argmax(change >= ONSET * np.nanmax(change))]
    known = [0.0, float(bench.time[0]) / unit, float(onset) / unit]
    text = "the times are off by {:.6g} ms: in the data the drive starts at that time"
    yield Hypothesis(
        "time offset", lambda x: text.format(x * unit * 1e3),
        lambda x: bench.against(scene, bench.time - x * unit),
        [*known, *(s / HUNDREDTH for p in SHIFTS for s in (p, -p))],
        factor=partial(float.__mul__, unit),
    )  # fmt: skip
