r"""Which limit of steady sliding holds for a scene, its error, and over which velocities it holds.

Every formula is compared with the exact state, and its range ends where the error passes the tolerance. On
Kelvin-Voigt, and for a parabola on a springpot, the errors are monotonic in V (derivations "F19-error-...",
"F20-error-...", "F18-springpot"), so that a range has one end. Otherwise the error is evaluated at `POINTS`
velocities from the limit on, and the range ends where it first passes the tolerance.

For a parabola on a Prony series a shorter range is also proved: with C = sum K_i tau_i and the length c of
the contact, mu is within 7 V t/c of Kelvin-Voigt, t = sum K_i tau_i^2/C, where V t/c <= 1/20 (theorem
F18-voigt; a damper, the limit of an arm, adds to C but not to t). Without a damper it is within 2 c/(V s) of
the glassy limit, s = (sum K_i/tau_i)/(sum K_i/tau_i^2), where c/(V s) <= 1/5 (theorem F18-glassy). On every
support V/c grows with V (theorem F17-growth).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial, reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.methods import plain, solve_exact
from kvtheory.results import (
    STEADY_UNITS,
    AsymptoteLine,
    AsymptoteReport,
    Certificate,
    SteadyState,
    units_for,
)
from kvtheory.scene.capabilities import lacks_kelvin_voigt, lacks_limits
from kvtheory.scene.foundations import Foundation
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Formula = Callable[[Scene], Any]
"""A formula of a quantity, in the shape of the scene, for |V|."""
Excess = Callable[[Scene, Mapping[str, Array]], Array]
"""A function of a scene and of the magnitudes of its exact state, in the shape of the scene."""

ROUNDING = 64 * 2.0**-52
"""Rounding error of an asymptote and of the exact state it is compared with, about twenty operations each."""
DECADES, ON_ARMS, MOST_DECADES = 30.0, 15.0, 200.0
"""Decades from V* within which the end of a range is searched for; times 1/alpha for a springpot."""
POINTS = 301
"""Velocities at which an error that may not be monotonic is evaluated, before the end is refined."""
VOIGT, MOST_DELAY = 7.0, 0.05
"""Relative error over V t/c, and the largest V t/c (theorem F18-voigt)."""
GLASSY, MOST_HASTE = 2.0, 0.2
"""Relative error over c/(V s), and the largest c/(V s) (theorem F18-glassy)."""
MONOTONIC = (
    "limit over exact state, less one, to 2e-14 (1 + |e|) of the relative error e, which is monotonic in V "
    "(derivations F19-error-..., F20-error-..., F18-springpot)"
)
SCANNED = (
    "differences to the exact state; a range ends where the error first passes the tolerance between the "
    "limit and the far side of V*, if it grows all the way; up to (high: from) `velocity_proved` it is "
    "proved (derivations F18-voigt, F18-glassy)"
)
NOTE = (
    "The limits of friction at low and high velocity are known for a parabola and a ball on any foundation, "
    "and for a power law and a wedge on Kelvin-Voigt; for this scene only the maxima are."
)

MU = "friction_coefficient"
EXACT = MU, "depth", "load", "friction_force", "half_length", "trailing_edge"
"""Quantities of the exact state that lines and bounds are compared with."""
LISTED: dict[str, tuple[tuple[str, int | None, int | None], ...]] = {
    "fixed": ((MU, 42, 45), ("load", 40, 43), ("friction_force", 41, 44)),
    "dead-weight": ((MU, 42, 46), ("depth", None, 49)),
    "suspended": ((MU, 42, None), ("depth", None, None), ("load", None, None)),
}
"""Quantities listed for each support, with the paper's equations of both limits for a parabola."""
FIXED = {
    "parabola": (
        "C V/(R K)", "alpha sqrt(delta/R)", "2 alpha R^(1/2) K delta^(3/2)", "C V delta",
        "2 alpha R^(-1/2) C V delta^(3/2)", "alpha R^(-1/2) C V delta^(3/2)",
    ),
    "power-law": (
        "n (n+1)/(2n-1) delta C V/(K a^2)", "n^2/(2n-1) delta/a", "2n/(n+1) K delta a", "C V delta",
        "2n^2/(2n-1) C V delta^2/a", "n^2/(2n-1) C V delta^2/a",
    ),
    "sphere": (
        "C V/(R K)", "(3 pi/16) a/R", "pi K R delta^2", "(4/3) C V delta a", "pi C V delta^2",
        "(pi/4) C V delta a^2/R",
    ),
}  # fmt: skip
LOADED = {
    "parabola": (
        "C V/(R K)", "alpha sqrt(W/(R C V))", "delta_0 = (3 W/(4 K sqrt(2 R)))^(2/3)", "W/(C V)",
    ),
    "power-law": (
        "n (n+1)/(2n-1) delta_0 C V/(K a_0^2)", "n^2/(2n-1) delta/a, delta = W/(C V)",
        "delta_0 = (n+1)/(2n) W/(K a_0)", "W/(C V)",
    ),
    "sphere": (
        "C V/(R K)", "(3 pi/16) a/R, a^3 = 3 R W/(2 C V)", "delta_0 = (W/(pi K R))^(1/2)",
        "a^2/(2 R), a as above",
    ),
}  # fmt: skip
"""Formulas on Kelvin-Voigt by shape, of a fixed indenter and under the load W; n = 1 for a wedge. Of a ball
with a radius R' across, K and C are multiplied by sqrt(R'/R) where W or F are involved."""
SUSPENDED = "M g", "(M g + k_s delta_0)"
"""W of a suspended indenter at low and at high velocity."""
ON_SPRINGPOT = (
    "6 A/((4-A) Gamma(3-A)) (a/R) (V tau/(2 a))^A, A = order",
    "A (3-A)/(4-A) a/R",
)
ON_SPRINGPOT_BALL = (
    "6 A/((4-A) Gamma(3-A)) S(4-A)/S(3) (a/R) (V tau/(2 a))^A, A = order",
    "A (3-A)/(4-A) S(4-A)/S(3-A) a/R, S(p) = B(1/2, 1 + p/2)",
)


class Line(NamedTuple):
    """A formula of a quantity, as it is listed, with a proved bound of its error if one is known."""

    name: str
    quantity: str
    regime: str
    equation: int | None
    formula: str
    at: Formula
    bound: Excess | None = None


def lines(scene: Scene) -> list[Line]:
    """Return what is listed for a scene, the friction coefficient first.

    >>> lines(Scene())[3][:5]
    ('depth, high V', 'depth', 'high', 49, 'W/(C V)')
    """
    shape, support = scene.indenter.shape, scene.support.kind
    line = scene.indenter.per_width
    low, high = (partial(_limit, MU, regime) for regime in ("low", "high"))
    if scene.foundation.springpot:
        slow, fast = ON_SPRINGPOT if line else ON_SPRINGPOT_BALL
        return [Line("L1", MU, "low", None, slow, low), Line("L2", MU, "high", None, fast, high)]
    kind = shape if shape in FIXED else "power-law"
    formulas = list(FIXED[kind] if support == "fixed" else LOADED[kind])
    if support == "suspended":
        formulas = [text.replace("W", SUSPENDED[i % 2]) for i, text in enumerate(formulas)]
        formulas += [text.strip("()") for text in SUSPENDED]
    if lacks_kelvin_voigt(scene):
        bounds = (_slow_bound, _voigt_bound, _glassy_bound) if line else (None, None, None)
        fast = f"{'2/5' if line else '1/3'} (a^2/R) (-G'(0)/G(0))/V, a of G(0)"
        name, total, equation = "glassy", "C = sum K_i tau_i", None
        if np.any(scene.foundation.damping):
            there = "" if np.all(scene.foundation.damping) else f"; where C_0 = 0, {fast}"
            fast = formulas[1].replace("C V", "C_0 V") + there
            name, total = "L2", "C = C_0 + sum K_i tau_i, C_0 of the damper"
            equation, bounds = LISTED[support][0][2] if line else None, (*bounds[:2], None)
        return [
            Line("L1", MU, "low", 42 if line else None, f"C V/(R K), {total}", low, bounds[0]),
            Line("Kelvin-Voigt", MU, "low", None, "exact with K and C", _voigt, bounds[1]),
            Line(name, MU, "high", equation, fast, high, bounds[2]),
        ]
    found: list[Line] = []
    for quantity, *numbers in LISTED[support]:
        for regime, number in zip(("low", "high"), numbers, strict=True):
            name = f"{quantity.removesuffix('_force')}, {regime} V"
            name = f"L{len(found) + 1}" if quantity == MU else name
            equation = number if shape == "parabola" else None
            limit = partial(_limit, quantity, regime)
            found.append(Line(name, quantity, regime, equation, formulas[len(found)], limit))
    return found


def _limit(quantity: str, regime: str, scene: Scene) -> Any:
    return asymptotes.quantity(scene, asymptotes.limits(scene)[regime == "high"], quantity)


def _voigt(scene: Scene) -> Array:
    """Return the friction coefficient on the Kelvin-Voigt foundation with the same K and C."""
    own = Foundation(scene.foundation.stiffness, scene.foundation.retardation_time)
    return np.abs(solve_exact(replace(scene, foundation=own)).friction_coefficient)


def _sum(scene: Scene, power: int) -> Any:
    """Return sum K_i tau_i^power over the arms."""
    return sum(arm.stiffness * arm.relaxation_time**power for arm in scene.foundation.arms)


def _passing(scene: Scene, exact: Mapping[str, Array]) -> Array:
    """Return the rate V/c at which elements pass the contact."""
    return np.abs(scene.drive.final_velocity) / (exact["half_length"] + exact["trailing_edge"])


def _within(off: Array, most: float, factor: float) -> Array:
    """Return the bound of limit/exact - 1 from factor times `off`; infinite where none holds."""
    wrong = factor * np.minimum(off, most)
    return np.where(off <= most, wrong / (1.0 - wrong), np.inf)


def _voigt_bound(scene: Scene, exact: Mapping[str, Array]) -> Array:
    delay = _passing(scene, exact) * (_sum(scene, 2) / scene.foundation.slow_damping)
    return _within(delay, MOST_DELAY, VOIGT)


def _slow_bound(scene: Scene, exact: Mapping[str, Array]) -> Array:
    return _limit(MU, "low", scene) / _voigt(scene) * (1.0 + _voigt_bound(scene, exact)) - 1.0


def _glassy_bound(scene: Scene, exact: Mapping[str, Array]) -> Array:
    haste = _sum(scene, -2) / _sum(scene, -1) / _passing(scene, exact)
    return _within(haste, MOST_HASTE, GLASSY)


def report(
    scene: Scene, tolerance: float, maxima: Mapping[str, Any], method: str = "asymptote"
) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes`, which documents it; `method` found the maxima."""
    signed = np.broadcast_to(scene.drive.final_velocity, scene.shape)
    known = {"velocity": plain(signed), "tolerance": tolerance, **maxima}
    known["units"] = units_for(scene.indenter, STEADY_UNITS)
    if lacks_limits(scene):
        nothing, unknown, exact = (plain(np.full(scene.shape, x)) for x in (np.nan, None, "exact"))
        return AsymptoteReport(
            **known, critical_velocity=nothing, regime=unknown, use=exact, lines=(), model=method,
            certificate=Certificate("none", "the limits of friction are not known", {}), notes=(NOTE,),
        )  # fmt: skip
    shown = lines(scene)
    foundation = scene.foundation
    monotonic = not foundation.arms and (scene.indenter.per_width or not foundation.springpot)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        critical = np.broadcast_to(asymptotes.critical_velocity(scene), scene.shape)
        truth = solve_exact(scene)
        ranges = _ranges(scene, shown, critical, tolerance, monotonic)
        found = [_line(scene, line, truth, *ranges[line]) for line in shown]
    use = np.full(scene.shape, "exact", dtype=object)
    for line in reversed(found):
        if line.quantity == MU:
            use = np.where(np.abs(line.relative_error) <= tolerance, line.name, use)
    kind, statement = ("proved", MONOTONIC) if monotonic else ("estimated", SCANNED)
    return AsymptoteReport(
        **known, critical_velocity=plain(critical), use=plain(use), lines=tuple(found),
        regime=plain(_regime(scene, truth, critical)), model="asymptote",
        certificate=Certificate(kind, statement, {}),
    )  # fmt: skip


def _regime(scene: Scene, truth: SteadyState, critical: Array) -> Array:
    """Return "low" or "high", by V* or by the arms, see `AsymptoteReport`."""
    slow, foundation = critical >= np.abs(scene.drive.final_velocity), scene.foundation
    fast = ~slow
    if times := [arm.relaxation_time for arm in foundation.arms]:
        rate = _passing(scene, {name: np.abs(getattr(truth, name)) for name in EXACT})
        K, C = foundation.stiffness, foundation.damping
        slow = rate * reduce(np.maximum, [*times, C / K]) <= 1.0
        fast = np.where(
            C > 0.0, rate * C >= K + _sum(scene, 0), rate * reduce(np.minimum, times) >= 1.0
        )
    return np.select([slow, fast], ["low", "high"], "between")


def _line(
    scene: Scene, line: Line, truth: SteadyState, edge: Array, proved: Array
) -> AsymptoteLine:
    exact, low = np.asarray(getattr(truth, line.quantity)), line.regime == "low"
    value = np.broadcast_to(line.at(scene), scene.shape)
    value, error = (
        plain(np.where(np.isfinite(each), each, np.nan))
        for each in (np.copysign(value, exact), asymptotes.error(value, np.abs(exact)))
    )
    ends = (np.zeros_like(edge), edge) if low else (edge, np.full_like(edge, np.inf))
    return AsymptoteLine(
        *line[:5], value=value, exact=plain(exact), relative_error=error, velocity_min=plain(ends[0]),
        velocity_max=plain(ends[1]), velocity_proved=plain(proved),
    )  # fmt: skip


def _exact(scene: Scene) -> dict[str, Array]:
    """Return the magnitudes of the exact values that lines and bounds need."""
    state = solve_exact(scene)
    return {name: np.abs(getattr(state, name)) for name in EXACT}


def _ranges(
    scene: Scene, shown: Sequence[Line], critical: Array, tolerance: float, monotonic: bool
) -> dict[Line, tuple[Array, Array]]:
    """Return the velocity at which the range of each line ends, and up to or from which it is proved.

    A range ends where the error first passes the tolerance, from the limit on, if it does.
    """
    decades = (ON_ARMS if scene.foundation.arms else DECADES) / scene.foundation.order
    far = np.broadcast_to(np.minimum(decades, MOST_DECADES), critical.shape)
    grid = far[..., np.newaxis] * np.linspace(-1.0, 1.0, 2 if monotonic else POINTS)
    wide = scene.mapped(lambda x: np.broadcast_to(x, scene.shape)[..., np.newaxis])
    wide = wide.at(critical[..., np.newaxis] * 10.0**grid)
    exact, doubt = _exact(wide), solve_exact(scene).certificate.relative_error

    def wrong_by(line: Line, scene: Scene, exact: Mapping[str, Array]) -> Array:
        error = np.abs(asymptotes.error(line.at(scene), exact[line.quantity]))
        wrong: Array = error + (ROUNDING + doubt[line.quantity]) * (1.0 + error) - tolerance
        return wrong

    def unproved_by(line: Line, scene: Scene, exact: Mapping[str, Array]) -> Any:
        return np.minimum(line.bound(scene, exact), 2.0) - tolerance if line.bound else np.inf

    searches: list[Excess] = []
    brackets, wrong = [], {}
    for line in shown:
        way = slice(None, None, 1 if line.regime == "low" else -1)
        wrong[line] = (wrong_by(line, wide, exact) > 0.0)[..., way]
        first = np.maximum(wrong[line].argmax(axis=-1), 1)[..., np.newaxis]
        searches.append(partial(wrong_by, line))
        brackets.append(
            [np.take_along_axis(grid[..., way], first - back, -1)[..., 0] for back in (1, 0)]
        )
    if not monotonic:
        searches += [partial(unproved_by, line) for line in shown]
        brackets += [[-far, far] for _ in shown]
    edges = _crossings(scene, searches, critical, np.moveaxis(np.array(brackets), 1, 0))
    ranges = {}
    for line, edge, proved in zip(shown, edges, edges[-len(shown) :], strict=False):
        nowhere, everywhere = (0.0, np.inf) if line.regime == "low" else (np.inf, 0.0)
        end = np.where(wrong[line][..., 0], nowhere, edge)
        end = np.where(wrong[line].any(axis=-1), end, everywhere)
        known = end if monotonic else np.where(np.isnan(proved), nowhere, proved)
        ranges[line] = end, known
    return ranges


def _crossings(scene: Scene, searches: Sequence[Excess], critical: Array, brackets: Array) -> Array:
    """Return the velocities at which functions vanish, between powers of ten away from V*; NaN without."""
    flat = scene.flat()

    def excess(decades: Array, which: Array, index: Array, critical: Array) -> Array:
        there = (flat.rows(index) if scene.shape else flat).at(critical * 10.0**decades)
        exact, found = _exact(there), np.empty_like(decades)
        for i, search in enumerate(searches):
            mine = which == i
            if mine.any():
                found[mine] = search(there.rows(mine), {name: x[mine] for name, x in exact.items()})
        return found

    which = np.arange(len(searches)).reshape(-1, *(1,) * critical.ndim)
    index = np.arange(critical.size).reshape(critical.shape)
    found = elementwise.find_root(excess, tuple(brackets), args=(which, index, critical))
    return np.where(found.success, critical * 10.0**found.x, np.nan)
