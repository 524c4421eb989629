"""Faults of a simulator as hypotheses: a wrong contact rule, or a wrong initial state.

The paper's scheme runs with and without the fault, and the difference is added to theory.
"""

import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from kvtheory.checks.fitting import Bench, Hypothesis, Pair
from kvtheory.checks.theory import CURVES, Array, Curves, curves
from kvtheory.results.schemes import RK4_LIMIT


class Mistake(NamedTuple):
    """What a simulator does wrong: the name of the fault, its description, and the fields of the rule.

    `comes_back` says that it shows only where the indenter re-enters deformed foundation, as where the drive
    does not keep its velocity, or has a spring. `by_step` says that its effect depends on the time step,
    which is searched for if it is not known.
    """

    name: str
    text: str
    does: Mapping[str, Any]
    comes_back: bool = False
    by_step: bool = False


LOST, UNRELAXED = "contact lost while rising", "no relaxation of the free surface"
MISTAKES = (
    Mistake("tension allowed at the trailing edge",
            "the foundation stays attached where it would pull (no peeling): an element must detach where "
            "its pressure vanishes (Eqs. 23, 24 and 33)", {"pulls": True}),
    Mistake(LOST,
            "elements lose contact where the indenter rises, for the surface of the last step is taken for "
            "the present one: a free surface relaxes within the step too (Eqs. 20 and 25, F8)",
            {"flags": False, "stale": True}),
    Mistake(LOST,
            "contact is lost from the equation of motion while the indenter rises, as where an element "
            "counts as free once the indenter is above where the last step left it (Eqs. 24 and 25, F8)",
            {"flags": False, "stale": True, "still": True}, by_step=True),
    Mistake(UNRELAXED,
            "the free surface does not relax, so that the contact ends where the indenter recedes from it: "
            "it decays as exp(-t/tau) (Eqs. 20 and 25, F8)", {"flags": False, "relaxes": False}),
    Mistake(UNRELAXED,
            "the free surface does not relax where the indenter comes back to it: it decays as exp(-t/tau) "
            "(Eqs. 20 and 25, F8)", {"relaxes": False}, comes_back=True),
    Mistake("memory forgotten where sliding reverses",
            "the indenter meets an undeformed foundation where it re-enters ground that it left: the surface "
            "there is still compressed, and relaxes as exp(-t/tau) (Eq. 20, F8)",
            {"remembers": False}, comes_back=True),
    Mistake("undeformed at the start",
            "at t = 0 the indenter touches an undeformed foundation, where theory has it at rest at its "
            "static depth (Eq. 40)", {"start": 0.0}),
)  # fmt: skip

DEEPER = 0.05
"""Relative change of the initial depth that is simulated to see its effect."""
PER_HALF_LENGTH = 250.0
"""Elements in the static half length of a simulation with a mistake: its difference to one without is used,
in which most discretization errors cancel."""
LONGEST_RUN = 1500
"""Steps of such a simulation; its later curves are taken as constant."""
SPAN, LONGEST_SEARCHED = 8.0, 5000
"""Factor above and below the assumed time step within which an unknown one is searched for, and the largest
number of steps then."""
INSTANTS = 400
"""Approximate number of output times."""
STABLE = 0.5
"""Time step used, as a fraction of the largest stable one of the paper's scheme."""
PASSED = 1.618
"""Elements that pass in a step: about as in the paper, but never in step with those that enter."""


def mistakes(bench: Bench) -> Iterator[Hypothesis]:
    """Yield each mistake: what it changes in a simulation is added to theory."""
    right = _simulated(bench, {})
    if right is None:
        return
    scene, resolution = bench.theory.scene, bench.resolution
    span = 0.0 if resolution.step_known else math.log(SPAN)

    def changed(wrong: Curves | None, share: float = 1.0) -> Pair | None:
        if wrong is None:
            return None
        moving = share * (bench.time >= 0.0)
        change = {name: moving * np.nan_to_num(wrong[name] - right[name]) for name in CURVES}
        return bench.columns, {name: bench.now[name] + change[name] for name in CURVES}

    def made(x: float, mistake: Mistake) -> Pair | None:
        step = resolution.time_step * math.exp(x) if mistake.by_step else None
        return changed(_simulated(bench, mistake.does, step))

    for mistake in MISTAKES:
        never = mistake.comes_back and scene.drive.constant and scene.drive.rigid
        if not never and not (mistake.by_step and scene.held):
            yield Hypothesis(
                mistake.name, lambda _x, text=mistake.text: text,  # type: ignore[misc]
                partial(made, mistake=mistake), span=span * mistake.by_step,
            )  # fmt: skip
    deeper = None if scene.held else _simulated(bench, {"start": 1.0 + DEEPER})
    if deeper is not None:
        text = (
            "the depth at t = 0 is {:.4g} times the static depth, at which theory starts (Eq. 40)"
        )
        yield Hypothesis(
            "wrong initial depth", lambda x: text.format(1.0 + x),
            lambda x: changed(deeper, x / DEEPER), [0.0], factor=lambda x: 1.0 + x,
        )  # fmt: skip


def _simulated(bench: Bench, does: Mapping[str, Any], step: float | None = None) -> Curves | None:
    """Return the curves of a simulation with a mistake, or None if it fails.

    With a `step` (s), all time steps are that long, or the longest that is stable; without, the outputs
    are at the times of the rows, for which steps may be shortened.
    """
    theory, now = bench.theory, bench.time
    scene, half = theory.scene, theory.static.half_length
    spacing, speed = half / PER_HALF_LENGTH, theory.motion.highest_speed
    damping = 2.0 * half * scene.foundation.damping
    stable = math.inf if scene.held else STABLE * RK4_LIMIT * scene.support.mass / damping
    if step is None:
        step = min(PASSED * spacing / speed if speed else math.inf, stable)
        now = np.clip(now, 0.0, LONGEST_RUN * step)
        times: Array = np.unique(now)
    else:
        step = min(step, stable)
        end = min(float(now[-1]), LONGEST_SEARCHED * step)
        apart = 2.0 * step * math.ceil(end / (2.0 * step * INSTANTS))
        times = np.minimum(apart * np.arange(math.ceil(end / apart) + 1), end)
    try:
        found = theory.methods.elements(scene, spacing, step, times.tolist(), does)
    except (ValueError, ArithmeticError):
        return None
    return {name: np.interp(now, times, values) for name, values in curves(found, scene).items()}
