"""The faults that the diagnosis knows, as data: what to vary, and what to say when it fits.

A fault is a parameter of the scene that the data were not made with, a column that has to be undone
(its sign, its unit, the point that a force acts about), times that are off, or what `mistakes` holds.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.fitting import (
    NO_FIT,
    STEP,
    Bench,
    Fitted,
    Pair,
    scaled_scene,
    uncertainty,
)
from kvtheory.checks.theory import CURVES

Array = NDArray[np.float64]


class Parameter(NamedTuple):
    """A quantity of a scene: its symbol, the keys that it scales with their powers, how it is shown."""

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
"""What may be wrong in a scene; those that the scene has not are passed over."""
OF_SPRING = PARAMETERS[-3:]
"""Those of the spring in the drive."""

WRONG = "wrong "
"""How the names of faults begin that are a parameter."""
GROUPS = {
    **{name: (name,) for name in CURVES if name != "velocity"},
    "both forces": ("normal_force", "friction_force"),
    "both forces along x": ("friction_force", "spring_force"),
    "both edges": ("leading_edge", "trailing_edge"),
    "the lengths": ("depth", "leading_edge", "trailing_edge"),
}
"""Columns that may share a wrong sign, unit or scale."""


FACTORS = (1.0, 0.5, 2.0, 0.1, 10.0, 1e-3, 1e3)
"""Factors of a parameter from which the fit may start: near 1, where mistakes are, and wrong units."""
POWER_OF_TEN = 0.02
"""In the decadic logarithm: nearer to a whole number, a factor is a power of ten."""
DECADES = (-6, -3, -2, -1, 1, 2, 3)
"""Powers of ten by which the times may be off."""
LONGEST = 30.0
"""Times the run of the scene, or the data: farther no motion on a spring is followed to try a unit."""
SHIFTS = (0.002, 0.005, 0.012, 0.03, 0.08, 0.2, 0.5)
"""Of the span of the data: offsets of the time from which the fit may start, in both directions."""
HUNDREDTH = 0.01
"""Of the span: the unit in which an offset of the time is fitted."""
ONSET = 0.1
"""Of the range of the normal force: where it has changed by as much, the drive has started."""


@dataclass(frozen=True)
class Trial:
    """A fault tried: how it fits, what to say, and the factor or shift that was found.

    `alike` are the parameters that the data do not tell from the one that it names.
    """

    name: str
    text: str
    fitted: Fitted
    factor: float | None = None
    alike: tuple[str, ...] = ()


def parameters(bench: Bench) -> Iterator[Trial]:
    """Fit each parameter of the scene, and try the direction of the drive."""
    yield from _fitted(bench, PARAMETERS, FACTORS)
    backward = _scaled(bench, {"drive.velocity": 1.0}, -1.0)
    text = "the base moves in the other direction: x and V have the other sign"
    yield Trial("direction of the drive", text, judged(bench, backward), -1.0)


def spring(bench: Bench) -> Iterator[Trial]:
    """Fit the parameters of the spring alone, from what the scene says: where each theory takes a while."""
    if not bench.case.theory.scene.drive.rigid:
        yield from _fitted(bench, OF_SPRING, FACTORS[:1])


def _scaled(bench: Bench, powers: Mapping[str, float], factor: float) -> Pair | None:
    curves = bench.solved(scaled_scene(bench.case.theory.scene, powers, factor))
    return None if curves is None else (bench.columns, curves)


def _fitted(
    bench: Bench, several: Sequence[Parameter], factors: Sequence[float]
) -> Iterator[Trial]:
    """Fit each of several parameters that the scene has, starting from the best of some factors."""
    values = dict(bench.case.theory.scene.values())
    values.setdefault("drive.velocity", bench.case.theory.final_velocity)
    there = [each for each in several if all(values.get(name) for name in each.powers)]
    trials: list[Trial] = []
    for symbol, powers, unit, per_si, words in there:
        key, starts = next(iter(powers)), np.log(factors).tolist()
        found = bench.fitted(lambda x, p=powers: _scaled(bench, p, math.exp(x)), starts)  # type: ignore[misc]
        factor = math.exp(found.value)
        old, new = values[key] * per_si, factor * values[key] * per_si
        size = f"{new:.4g} {unit} rather than {old:.4g} {unit}"
        text = f"the data fit {symbol} = {size}, {factor:.4g} times{words}{_ten(factor)}"
        trials.append(Trial(f"{WRONG}{symbol}", text, found, factor))
    best = min(range(len(there)), key=lambda k: trials[k].fitted.fit.score)
    if trials[best].fitted.fit.enough:
        trials[best] = replace(
            trials[best], alike=_alike(bench, there, best, trials[best].fitted.value)
        )
    yield from trials


def _alike(bench: Bench, there: list[Parameter], best: int, value: float) -> tuple[str, ...]:
    """Return the parameters that the data do not tell from the best one, whose logarithm is off by `value`.

    With such a one free beside it, the fit leaves that logarithm uncertain by more than it is off: the
    data do not need it. The slopes are those of theory at the best fit.
    """
    scene = scaled_scene(bench.case.theory.scene, there[best].powers, math.exp(value))
    here, slopes = bench.solved(scene), []
    for parameter in there:
        curves = bench.solved(scaled_scene(scene, parameter.powers, math.exp(STEP)))
        if here is None or curves is None:
            return ()
        slopes.append(bench.effect(curves, here) / STEP)
    return tuple(
        other.symbol
        for k, other in enumerate(there)
        if k != best and uncertainty(slopes[best], slopes[k]) >= abs(value)
    )


def judged(bench: Bench, pair: Pair | None) -> Fitted:
    """Judge a fault without an unknown."""
    return NO_FIT if pair is None else Fitted(bench.fit(*pair))


def undone(bench: Bench) -> Iterator[Trial]:
    """Undo signs, units and an exchange of the edges."""
    return (trial for trial in _columns(bench) if not trial.name.startswith(SCALE))


def scales(bench: Bench) -> Iterator[Trial]:
    """Multiply columns by what fits best, and shift the point that the friction force acts about."""
    yield from (trial for trial in _columns(bench) if trial.name.startswith(SCALE))
    if "friction_force" not in bench.names:
        return
    theory = bench.case.theory
    half, R = theory.static.half_length, theory.scene.indenter.radius  # type: ignore[union-attr]
    F_z = bench.columns.get("normal_force", bench.now["normal_force"])

    def about(x: float) -> Pair:
        shifted = bench.columns["friction_force"] - x * half / R * F_z
        return {**bench.columns, "friction_force": shifted}, bench.now

    found = bench.fitted(about, [0.0])
    arm = found.value * half
    text = (
        f"friction force: its lever arm is off by {arm * 1e3:.3g} mm, F_x being the moment of the pressure "
        "about another point than the lowest of the indenter (Eqs. 13 and 15)"
    )
    yield Trial("lever arm of friction_force", text, found, arm)


def _columns(bench: Bench) -> Iterator[Trial]:
    """Multiply columns by what fits best, and exchange the edges."""
    for title, group in GROUPS.items():
        if not all(name in bench.names for name in group):
            continue
        factor = _least_squares(bench, group)
        if not math.isfinite(factor) or factor == 0.0:
            continue
        decades = round(math.log10(abs(factor)))
        whole = abs(math.log10(abs(factor)) - decades) < POWER_OF_TEN
        exact = math.copysign(10.0**decades, factor) if whole else factor
        changed = {**bench.columns, **{name: exact * bench.columns[name] for name in group}}
        found, names = Fitted(bench.fit(changed, bench.now)), title.replace("_", " ")
        if whole and decades == 0 and exact < 0.0:
            text = f"{names}: has the wrong sign{SIGNS.get(title, '')}"
            yield Trial(f"sign of {title}", text, found, exact)
        elif whole and decades:
            sign = "" if exact > 0.0 else " and has the wrong sign"
            text = f"{names}: off by a power of ten, 10^{-decades}{sign}; check the unit"
            yield Trial(f"unit of {title}", text, found, 1.0 / exact)
        elif not whole:
            text = f"{names}: {1.0 / exact:.4g} times theory, while the rest agrees"
            yield Trial(f"{SCALE} of {title}", text, found, 1.0 / exact)
    if all(name in bench.names for name in GROUPS["both edges"]):
        first, last = (bench.columns[name] for name in GROUPS["both edges"])
        swapped = {**bench.columns, "leading_edge": last, "trailing_edge": first}
        text = (
            "leading and trailing edge are exchanged: the leading edge is where the foundation enters, at "
            "x < 0 for V > 0"
        )
        yield Trial("edges exchanged", text, Fitted(bench.fit(swapped, bench.now)))


SCALE = "scale"
"""How the names of faults begin that multiply a column by a fitted factor."""
SIGNS = {
    "friction_force": ": F_x on the indenter is positive for V > 0 (Eqs. 13 and 15)",
    "depth": ": delta = -z_A is positive (Eq. 18)",
    "spring_force": ": the spring holds the indenter against F_x, and counts as F_x does",
    "normal_force": ": F_z on the indenter is positive (Eqs. 12 and 14)",
}
"""What fixes the sign of a column."""


def _least_squares(bench: Bench, group: tuple[str, ...]) -> float:
    """Return the factor by which columns fit theory best, by their allowances."""
    top = bottom = 0.0
    for name in group:
        most = bench.case.most(name) * bench.case.theory.scales[name]
        data, theory = bench.columns[name] / most, bench.now[name] / most
        known = np.isfinite(data) & np.isfinite(theory)
        top += float(data[known] @ theory[known])
        bottom += float(data[known] @ data[known])
    return top / bottom if bottom else math.nan


def decades(bench: Bench) -> Iterator[Trial]:
    """Multiply the times by powers of ten; a cycle on a spring goes on, and is not followed for too long."""
    scene, end = bench.case.theory.scene, float(bench.time[-1])
    longest = math.inf if scene.drive.rigid else LONGEST * max(scene.run.duration, end)
    for power in (power for power in DECADES if end * 10.0**power <= longest):
        text = f"time: off by a power of ten, 10^{-power}; check the unit"
        pair = _timed(bench, bench.time * 10.0**power)
        yield Trial("unit of time", text, judged(bench, pair), 10.0**-power)


def offset(bench: Bench) -> Iterator[Trial]:
    """Shift the times: from none, from the start of the data, and from where the force changes first."""
    unit = HUNDREDTH * float(bench.time[-1] - bench.time[0])
    known = [0.0, float(bench.time[0]), _onset(bench)]
    starts = [*(t / unit for t in known), *(s / HUNDREDTH for p in SHIFTS for s in (p, -p))]
    found = bench.fitted(lambda x: _timed(bench, bench.time - x * unit), starts)
    shift = found.value * unit
    text = f"the times are off by {shift * 1e3:.6g} ms: in the data the drive starts at that time"
    yield Trial("time offset", text, found, shift)


def _onset(bench: Bench) -> float:
    """Return when a force of the data changes first, in s."""
    name = next(
        name
        for name in ("normal_force", "friction_force", "spring_force", "depth")
        if name in bench.columns
    )
    change = np.abs(bench.columns[name] - bench.columns[name][0])
    return float(bench.time[np.argmax(change >= ONSET * np.nanmax(change))])


def _timed(bench: Bench, moments: Array) -> Pair | None:
    curves = bench.solved(bench.case.theory.scene, moments)
    return None if curves is None else (bench.columns, curves)


def _ten(factor: float) -> str:
    """Say so if a factor is a power of ten."""
    power = math.log10(abs(factor))
    near = round(power)
    return " (a power of ten: check its unit)" if near and abs(power - near) < POWER_OF_TEN else ""
