"""Mistakes in a simulation itself, as data: a wrong rule of contact, or a wrong start.

A simulator makes the mistake, and what that changes is added to theory.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from kvtheory.checks.faults import Trial, judged
from kvtheory.checks.fitting import LARGEST, NO_FIT, Bench, Fitted
from kvtheory.checks.theory import CURVES, Curves, curves
from kvtheory.results.schemes import RK4_LIMIT

Array = NDArray[np.float64]


class Mistake(NamedTuple):
    """What a simulator does wrong, by name as `Methods.elements` knows it, and what to say.

    `comes_back` says that it shows only where the indenter comes back over ground that it left, as where the
    drive does not keep its velocity, or has a spring. `by_step` says that what it does depends on the time
    step, which is fitted where it is not known.
    """

    name: str
    text: str
    does: Mapping[str, Any]
    comes_back: bool = False
    by_step: bool = False


UNRELAXED = "no relaxation of the free surface"
MISTAKES = (
    Mistake("tension allowed at the trailing edge",
            "the foundation is not let go where it would pull (no peeling): an element must detach where "
            "its pressure vanishes (Eqs. 23, 24 and 33)", {"pulls": True}),
    Mistake("contact lost while rising",
            "elements lose contact where the indenter rises, for the surface of the last step is taken for "
            "the present one: a free surface relaxes within the step too (Eqs. 20 and 25, F8)",
            {"flags": False, "stale": True}),
    Mistake("contact lost while rising",
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
            "the indenter meets undisturbed ground where it comes back over ground that it left: the surface "
            "there is still compressed, and relaxes as exp(-t/tau) (Eq. 20, F8)",
            {"remembers": False}, comes_back=True),
    Mistake("undeformed at the start",
            "at t = 0 the indenter touches an undeformed foundation, where theory has it at rest at its "
            "static depth (Eq. 40)", {"start": 0.0}),
)  # fmt: skip

MORE = 0.05
"""By which the initial depth is changed to see what it does."""
PER_HALF_LENGTH = 250.0
"""Elements in the static half length of a simulation with a mistake: its difference to one without is wanted,
in which most of their coarseness cancels."""
LONGEST_RUN = 1500
"""Steps of such a simulation; what it does later is taken to stay the same."""
SOUGHT, SOME = 8.0, 0.3
"""A time step that is not known is sought up to so many times longer and shorter than the one assumed, if
that explains this part of the difference."""
STEP_KNOWN_TO, LONGEST_SOUGHT = 0.01, 5000
"""Accuracy of its logarithm, and the steps of such a simulation; what it does later stays the same."""
INSTANTS = 400
"""At which it is reported, about."""
STABLE = 0.5
"""Of the largest stable step of the paper's scheme."""
PASSED = 1.618
"""Elements that pass in a step: about as in the paper, but never in step with those that enter."""


def mistakes(bench: Bench) -> Iterator[Trial]:
    """Let a simulator make a mistake, and add to theory what that changes."""
    right = _simulated(bench, {})
    if right is None:
        return
    theory = bench.case.theory

    def fit(wrong: Curves | None) -> Fitted:
        if wrong is None:
            return NO_FIT
        return judged(bench, (bench.columns, _changed(bench, right, wrong, 1.0)))

    least = math.inf
    for name, text, does, comes_back, by_step in MISTAKES:
        if comes_back and theory.scene.drive.constant and theory.scene.drive.rigid:
            continue
        if by_step and theory.scene.held:
            continue
        by_steps = partial(_in_steps, bench, does)
        found = (
            _at_best_step(bench, by_steps, fit, least) if by_step else fit(_simulated(bench, does))
        )
        least = min(least, found.fit.score)
        yield Trial(name, text, found)
    deeper = None if theory.scene.held else _simulated(bench, {"start": 1.0 + MORE})
    if deeper is None:
        return
    found = bench.fitted(lambda x: (bench.columns, _changed(bench, right, deeper, x / MORE)), [0.0])
    text = (
        f"the depth at t = 0 is {1.0 + found.value:.4g} times the static depth, at which theory has the "
        "indenter at rest (Eq. 40)"
    )
    yield Trial("wrong initial depth", text, found, 1.0 + found.value)


def _at_best_step(
    bench: Bench,
    simulated: Callable[[float], Curves | None],
    fit: Callable[[Curves | None], Fitted],
    least: float,
) -> Fitted:
    """Return how a mistake fits at the time step of the simulation, or where that is not known, at the best.

    It is sought where the step assumed explains something, and leaves less than `least`, the best so far.
    """
    step = bench.case.resolution.time_step
    fits = [fit(simulated(step))]
    start = bench.fit(bench.columns, bench.now).score
    enough = min((1.0 - SOME) * start, least)
    if bench.case.resolution.step_known or not fits[0].fit.score < enough:
        return fits[0]

    def score(x: float) -> float:
        fits.append(fit(simulated(step * math.exp(x))))
        return min(fits[-1].fit.score, LARGEST)

    most = math.log(SOUGHT)
    minimize_scalar(score, bounds=(-most, most), method="bounded", options={"xatol": STEP_KNOWN_TO})
    return min(fits, key=lambda found: found.fit.score)


def _simulated(bench: Bench, does: Mapping[str, Any]) -> Curves | None:
    """Return the curves of elements that make a mistake, at the times of the rows."""
    half, speed = bench.case.theory.static.half_length, bench.case.theory.motion.highest_speed
    step = min(PASSED * half / PER_HALF_LENGTH / speed if speed else math.inf, _stable(bench))
    times, index = np.unique(np.clip(bench.time, 0.0, LONGEST_RUN * step), return_inverse=True)
    found = _elements(bench, step, times, does)
    return found and {name: values[index] for name, values in found.items()}


def _in_steps(bench: Bench, does: Mapping[str, Any], step: float) -> Curves | None:
    """Return the same by this time step (s), or the longest that is stable, with none shortened."""
    step = min(step, _stable(bench))
    end = min(float(bench.time[-1]), LONGEST_SOUGHT * step)
    apart = 2.0 * step * math.ceil(end / (2.0 * step * INSTANTS))
    times = np.minimum(apart * np.arange(math.ceil(end / apart) + 1), end)
    found = _elements(bench, step, times, does)
    return found and {name: np.interp(bench.time, times, values) for name, values in found.items()}


def _stable(bench: Bench) -> float:
    """Return a time step in s at which the paper's scheme is stable."""
    scene, half = bench.case.theory.scene, bench.case.theory.static.half_length
    contact = 2.0 * half * scene.foundation.damping
    return math.inf if scene.held else STABLE * RK4_LIMIT * scene.support.mass / contact


def _elements(bench: Bench, step: float, times: Array, does: Mapping[str, Any]) -> Curves | None:
    """Return the curves of elements that make a mistake, or None where they have none."""
    theory = bench.case.theory
    scene, spacing = theory.scene, theory.static.half_length / PER_HALF_LENGTH
    try:
        return curves(theory.methods.elements(scene, spacing, step, times.tolist(), does), scene)
    except (ValueError, ArithmeticError):
        return None


def _changed(bench: Bench, right: Curves, wrong: Curves, share: float) -> Curves:
    """Return theory plus a share of the change that a mistake makes."""
    moving = bench.time >= 0.0
    return {
        name: bench.now[name]
        + share * np.where(moving, np.nan_to_num(wrong[name] - right[name]), 0.0)
        for name in CURVES
    }
