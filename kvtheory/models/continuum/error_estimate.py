"""Error of a transient, estimated from a solution with a tighter tolerance and other steps."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum.deviation import DEVIATION
from kvtheory.models.continuum.evaluation import MEASURED
from kvtheory.models.continuum.run import StepControl
from kvtheory.models.continuum.solver import Trajectory
from kvtheory.results.errors import AT_REST, Certificate

Array = NDArray[np.float64]

LOOSEST, TIGHTEST = 1e-4, 1e-13
"""Looser tolerances would save no steps; tighter ones would be below rounding."""
TIGHTER = 100.0
"""Ratio of the tolerances of the solution and of the one it is compared with; with a smaller ratio, the
latter would be no more accurate in three of a thousand scenes."""
COMPARISON = StepControl(first_step=0.17, longest=0.3, grow=6.0, straight=0.85)
"""Different steps where the tolerance does not set them: after a jump, on pieces of the drive, and before an
event, where a last short step covers the singularity of a take-off."""
MARGIN = 10.0
"""Safety factor on the difference: in one of a thousand scenes with hops, the error is this many times as
large."""
FLOOR = 1e-2
"""Least difference in units of the tolerance, which is relative to 1 + the largest magnitude of a quantity;
a smaller one is a coincidence, for the error of the other solution may be as large."""

STATEMENT = (
    f"{MARGIN:g} times the difference to a solution with {1 / TIGHTER:g} times the tolerance and other "
    "step sizes, plus a bound of rounding. Values at a jump, as at a landing, are compared at the same time "
    "from it; `jump_time` is the error of that time, relative to the retardation time; `pressure` holds "
    "inside the contact, `surface` for the whole foundation"
)
NOTHING = "not known: the solution with a tighter tolerance failed"
NOT_ASKED = "not known: not requested"


def methods(rtol: float) -> tuple[tuple[float, StepControl], tuple[float, StepControl]]:
    """Return the tolerance and the steps of a solution, and those of the one it is compared with."""
    rtol = min(rtol, LOOSEST)
    return (rtol, StepControl()), (max(rtol / TIGHTER, TIGHTEST), COMPARISON)


def certificate(
    fine: Trajectory, other: Trajectory | None, times: Array | None, tolerance: float, why: str
) -> Certificate:
    """Return the certificate of the states at the scaled `times`, by default the natural ones.

    `tolerance` is that of the polynomials that approximate a drive; `why` there is no `other`.
    """
    if other is None:
        return unknown(why, sprung=fine.given.sprung)
    given, whole = fine.given, fine.deviations(other)
    held = given.fixed and not len(fine.run.depths)
    here = whole if times is None else fine.deviations(other, times)
    found = errors(here, whole, given.rtol, held, sprung=given.sprung, tolerance=tolerance)
    numbers = {name: float(error) for name, error in found.items()}
    return Certificate("estimated", STATEMENT, numbers, AT_REST)


def unknown(why: str, *, sprung: bool = False) -> Certificate:
    """Return the certificate of a transient whose error is unknown."""
    nothing = np.zeros((), DEVIATION)
    names = errors(nothing, nothing, 1.0, False, sprung=sprung, tolerance=1.0)
    return Certificate("estimated", why, dict.fromkeys(names, math.inf) | {"time": 0.0}, AT_REST)


def errors(
    here: Any, whole: Any, rtol: float, held: bool, *, sprung: bool, tolerance: float
) -> dict[str, Any]:
    """Return the error of each quantity from the deviations at some times, and those over the whole run.

    The error of the pressure inside the contact, d + d' - xi^2 - 2 lambda xi, follows from those of the
    depth, its rate and lambda. The surface is the largest of e^-(s - sigma) (d - xi^2) over the past instants
    sigma (fact F8): its error comes from the largest error of the depth so far, and from that of the sliding
    distance since then, which includes the position along x. Deviations may be arrays over many scenes.
    """
    moves, slides, sizes = 0.0 if held else 1.0, float(sprung), _named(whole["size"])
    apart, ever_apart = _named(here["apart"]), _named(whole["apart"])
    floors = {name: FLOOR * rtol * (1.0 + size) for name, size in sizes.items()}
    at_times, ever = (
        {name: np.maximum(MARGIN * each[name], floor) for name, floor in floors.items()}
        for each in (apart, ever_apart)
    )
    edges = at_times["edges"] + here["edge_rounding"]
    depth, arm = moves * ever["depth"], sizes["edges"]
    drive = tolerance * (1.0 + sizes["velocity"])
    way = slides * 2.0 * ever["offset"] + drive + 2.0 * whole["edge_rounding"]
    sliding = at_times["sliding_velocity"] + drive
    spring = {"sliding_velocity": sliding, "spring_force": at_times["spring_force"]}
    slid = slides * ever["sliding_velocity"] + drive
    hops = np.maximum(MARGIN * whole["hops"], FLOOR * rtol)
    return {
        "time": 0.0,
        "velocity": drive,
        "depth": moves * at_times["depth"],
        "depth_rate": moves * at_times["depth_rate"],
        "normal_force": at_times["normal_force"] + here["normal_rounding"],
        "friction_force": at_times["friction_force"] + here["friction_rounding"],
        "leading_edge": edges,
        "trailing_edge": edges,
        "peak_pressure": at_times["peak_pressure"] + here["peak_rounding"],
        "pressure": depth + moves * ever["depth_rate"] + 2.0 * arm * slid,
        "surface": depth + 2.0 * arm * way,
        "jump_time": moves * (hops + whole["hop_rounding"]),
        **(spring if sprung else {}),
    }


def _named(values: Any) -> dict[str, Array]:
    """Return values of the measured quantities by name, and the larger one of both edges."""
    found = dict(zip(MEASURED, np.moveaxis(np.asarray(values), -1, 0), strict=True))
    return {**found, "edges": np.maximum(found["left_edge"], found["right_edge"])}
