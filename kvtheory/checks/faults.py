"""The faults that the diagnosis knows, as data: what to vary, and what to say when it fits.

A fault is a parameter of the scene that the data were not made with, a column that has to be undone
(its sign, its unit), times that are off, or a wrong rule of contact.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.fitting import Bench, Curves, Fit, best, scaled_scene
from kvtheory.checks.rules import RULES, run
from kvtheory.checks.theory import CURVES

Array = NDArray[np.float64]


class Parameter(NamedTuple):
    """A quantity of a scene: key, symbol, and the unit in which it is shown."""

    key: str
    symbol: str
    unit: str
    per_si: float


PARAMETERS = (
    Parameter("foundation.retardation_time", "tau", "ms", 1e3),
    Parameter("foundation.stiffness", "K", "GN/m^3", 1e-9),
    Parameter("indenter.radius", "R", "mm", 1e3),
    Parameter("support.mass", "M", "kg/mm", 1e-3),
    Parameter("support.gravity", "g", "m/s^2", 1.0),
    Parameter("support.stiffness", "k_s", "MN/m^2", 1e-6),
    Parameter("support.depth", "delta", "mm", 1e3),
    Parameter("drive.velocity", "V", "mm/s", 1e3),
)
"""What may be wrong in a scene; those that the scene has not are passed over."""

GROUPS = {
    **{name: (name,) for name in CURVES if name != "velocity"},
    "both forces": ("normal_force", "friction_force"),
    "both edges": ("leading_edge", "trailing_edge"),
    "the lengths": ("depth", "leading_edge", "trailing_edge"),
}  # fmt: skip
"""Columns that may share a wrong sign, unit or scale."""

WRONG_RULES = {
    "tension": (
        "tension allowed at the trailing edge",
        "the foundation is not let go where it would pull (no peeling): an element must detach where its "
        "pressure vanishes (Eqs. 23, 24 and 33)",
    ),
    "stale": (
        "contact lost while rising",
        "elements lose contact where the indenter rises, for the surface of the last step is taken for the "
        "present one: a free surface relaxes within the step too (Eqs. 20 and 25, F8)",
    ),
    "unrelaxed": (
        "no relaxation of the free surface",
        "the free surface does not relax, so that the contact ends where the indenter recedes from it: it "
        "decays as exp(-t/tau) (Eqs. 20 and 25, F8)",
    ),
    "frozen": (
        "no relaxation of the free surface",
        "the free surface does not relax where the indenter comes back to it: it decays as exp(-t/tau) "
        "(Eqs. 20 and 25, F8)",
    ),
}
"""Wrong rules of contact, by their name in `kvtheory.checks.rules`."""

FACTORS = np.array([1e-3, 1e-2, *np.geomspace(0.05, 20.0, 19), 1e2, 1e3])
"""Factors of a parameter that are tried first: near 1, where mistakes are, and wrong units."""
POWER_OF_TEN = 0.02
"""In the decadic logarithm: nearer to a whole number, a factor is a power of ten."""
DECADES = (-6, -3, -2, -1, 1, 2, 3)
"""Powers of ten by which the times may be off."""
NO_SHIFT = 1e-6
"""Of what is allowed: how much better a shift by the whole duration has to be than none."""
SHIFTS = np.geomspace(1e-3, 0.5, 13)
"""Of the duration: offsets of the time that are tried first, in both directions."""


Family = Callable[[Bench], Iterator["Trial"]]


@dataclass(frozen=True)
class Trial:
    """A fault tried: how it fits, what was fitted, and what to say."""

    name: str
    text: str
    fit: Fit
    factor: float | None = None


def parameters(bench: Bench) -> Iterator[Trial]:
    """Vary each parameter of the scene, and the direction of the drive."""
    scene, values = bench.theory.scene, dict(bench.theory.scene.values())

    def fitted(key: str, factor: float) -> Fit:
        curves = bench.solved(scaled_scene(scene, key, factor))
        return Fit(math.inf, False) if curves is None else bench.fit(bench.columns, curves)

    for key, symbol, unit, per_si in PARAMETERS:
        if key not in values or values[key] == 0.0:
            continue
        factor = _best_factor(partial(fitted, key))
        old, new = values[key] * per_si, factor * values[key] * per_si
        text = f"the data fit {symbol} = {new:.4g} {unit} rather than {old:.4g} {unit}, {factor:.4g} times"
        yield Trial(f"wrong {symbol}", text + ten(factor), fitted(key, factor), factor)
    backward = fitted("drive.velocity", -1.0)
    text = "the base moves in the other direction: x and V have the other sign"
    yield Trial("direction of the drive", text, backward, -1.0)


def _best_factor(fitted: Callable[[float], Fit]) -> float:
    """Return the factor that fits best."""
    _, log = best(lambda x: fitted(math.exp(x)).score, np.log(FACTORS))
    return math.exp(log)


def undone(bench: Bench) -> Iterator[Trial]:
    """Undo signs, units and an exchange of the edges."""
    return (trial for trial in _columns(bench) if not trial.name.startswith(SCALE))


def scales(bench: Bench) -> Iterator[Trial]:
    """Multiply columns by what fits best."""
    return (trial for trial in _columns(bench) if trial.name.startswith(SCALE))


def _columns(bench: Bench) -> Iterator[Trial]:
    """Multiply columns by what fits best, and exchange the edges."""
    curves = bench.case.now
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
        fit, names = bench.fit(changed, curves), title.replace("_", " ")
        if whole and decades == 0 and exact < 0.0:
            yield Trial(
                f"sign of {title}", f"{names}: has the wrong sign{SIGNS.get(title, '')}", fit, exact
            )
        elif whole and decades:
            sign = "" if exact > 0.0 else " and has the wrong sign"
            yield Trial(
                f"unit of {title}",
                f"{names}: off by a power of ten, 10^{-decades}{sign}; check the unit",
                fit,
                1.0 / exact,
            )
        elif not whole:
            yield Trial(
                f"{SCALE} of {title}",
                f"{names}: {1.0 / exact:.4g} times theory, while the rest agrees",
                fit,
                1.0 / exact,
            )
    if all(name in bench.names for name in GROUPS["both edges"]):
        first, last = (bench.columns[name] for name in GROUPS["both edges"])
        swapped = {**bench.columns, "leading_edge": last, "trailing_edge": first}
        text = (
            "leading and trailing edge are exchanged: the leading edge is where the foundation enters, at "
            "x < 0 for V > 0"
        )
        yield Trial("edges exchanged", text, bench.fit(swapped, curves))


SCALE = "scale"
"""How the names of faults begin that multiply a column by a fitted factor."""
SIGNS = {
    "friction_force": ": F_x on the indenter is positive for V > 0 (Eqs. 13 and 15)",
    "depth": ": delta = -z_A is positive (Eq. 18)",
    "normal_force": ": F_z on the indenter is positive (Eqs. 12 and 14)",
}
"""What fixes the sign of a column."""


def _least_squares(bench: Bench, group: tuple[str, ...]) -> float:
    """Return the factor by which columns fit theory best, by their allowances."""
    top = bottom = 0.0
    for name in group:
        most = bench.case.most(name) * bench.theory.scales[name]
        data, theory = bench.columns[name] / most, bench.case.now[name] / most
        known = np.isfinite(data) & np.isfinite(theory)
        top += float(data[known] @ theory[known])
        bottom += float(data[known] @ data[known])
    return top / bottom if bottom else math.nan


def decades(bench: Bench) -> Iterator[Trial]:
    """Multiply the times by powers of ten."""
    for power in DECADES:
        text = f"time: off by a power of ten, 10^{-power}; check the unit"
        yield Trial("unit of time", text, _timed(bench, bench.time * 10.0**power), 10.0**-power)


def offset(bench: Bench) -> Iterator[Trial]:
    """Shift the times."""
    span = float(bench.time[-1] - bench.time[0])
    grid = span * np.concatenate([-SHIFTS[::-1], [0.0], SHIFTS])
    # Of shifts that fit as well, such as those of a force that never changes, the smallest counts.
    _, shift = best(lambda t: _timed(bench, bench.time - t).score + NO_SHIFT * abs(t) / span, grid)
    text = f"the times are off by {shift * 1e3:.4g} ms: in the data the drive starts at that time"
    yield Trial("time offset", text, _timed(bench, bench.time - shift), shift)


def _timed(bench: Bench, moments: Array) -> Fit:
    curves = bench.solved(bench.theory.scene, moments)
    return Fit(math.inf, False) if curves is None else bench.fit(bench.columns, curves)


def rules(bench: Bench) -> Iterator[Trial]:
    """Break the rules of contact."""
    theory = bench.theory
    scene, static, tau = theory.scene, theory.static, theory.scene.foundation.retardation_time
    half, end = static.half_length, max(float(bench.time[-1]), 1e-12) / tau

    def drive(s: Array) -> Array:
        return np.asarray(theory.at(s * tau)["velocity"] * tau / half)

    epsilon = None if scene.held else static.inertia_number
    kappa = 0.0 if scene.held else static.support_number
    s, right = run(RULES["right"], drive, epsilon, kappa, end)
    for rule, (name, text) in WRONG_RULES.items():
        _, wrong = run(RULES[rule], drive, epsilon, kappa, end)
        curves = _shifted(bench, s * tau, {key: wrong[key] - right[key] for key in wrong})
        yield Trial(name, text, bench.fit(bench.columns, curves))


def _shifted(bench: Bench, time: Array, change: dict[str, Array]) -> Curves:
    """Return theory plus the change that a rule makes, in SI."""
    forward = bench.case.now["velocity"][-1] >= 0.0
    first, last = ("left", "right") if forward else ("right", "left")
    names = {"depth": "depth", "depth_rate": "depth_rate", "normal_force": "normal_force",
             "friction_force": "friction_force", "leading_edge": first, "trailing_edge": last}  # fmt: skip
    curves = dict(bench.case.now)
    for name, key in names.items():
        added = np.interp(bench.time, time, np.nan_to_num(change[key]))
        curves[name] = (
            curves[name] + np.where(bench.time < 0.0, 0.0, added) * bench.theory.scales[name]
        )
    return curves


def ten(factor: float) -> str:
    """Say so if a factor is a power of ten."""
    power = math.log10(abs(factor))
    near = round(power)
    return " (a power of ten: check its unit)" if near and abs(power - near) < POWER_OF_TEN else ""


FAMILIES: tuple[tuple[Family, float], ...] = (
    (undone, 0.5), (decades, 0.5), (offset, 0.97), (parameters, 0.97), (scales, 0.97),
    (rules, 1.0),
)  # fmt: skip
"""The families in the order in which they are tried, and the part of the difference that one of their faults
must explain for nothing else to be looked for: a sign or a unit is not fitted, so that little is enough."""
