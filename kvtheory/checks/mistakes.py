"""Mistakes in a simulation itself, as data: a wrong rule of contact, or a wrong start.

A simulator makes the mistake, and what that changes is added to theory.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from kvtheory.checks.faults import Trial, judged
from kvtheory.checks.fitting import Bench
from kvtheory.checks.theory import CURVES, Curves, curves
from kvtheory.results.schemes import RK4_LIMIT


class Mistake(NamedTuple):
    """What a simulator does wrong, by name as `Methods.elements` knows it, and what to say.

    `comes_back` says that it shows only where the indenter comes back over ground that it left, as where the
    drive does not keep its velocity, or has a spring.
    """

    name: str
    text: str
    does: Mapping[str, Any]
    comes_back: bool = False


UNRELAXED = "no relaxation of the free surface"
MISTAKES = (
    Mistake("tension allowed at the trailing edge",
            "the foundation is not let go where it would pull (no peeling): an element must detach where "
            "its pressure vanishes (Eqs. 23, 24 and 33)", {"pulls": True}),
    Mistake("contact lost while rising",
            "elements lose contact where the indenter rises, for the surface of the last step is taken for "
            "the present one: a free surface relaxes within the step too (Eqs. 20 and 25, F8)",
            {"flags": False, "stale": True}),
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
    for name, text, does, comes_back in MISTAKES:
        if comes_back and theory.scene.drive.constant and theory.scene.drive.rigid:
            continue
        wrong = _simulated(bench, does)
        pair = None if wrong is None else (bench.columns, _changed(bench, right, wrong, 1.0))
        yield Trial(name, text, judged(bench, pair))
    deeper = None if theory.scene.held else _simulated(bench, {"start": 1.0 + MORE})
    if deeper is None:
        return
    found = bench.fitted(lambda x: (bench.columns, _changed(bench, right, deeper, x / MORE)), [0.0])
    text = (
        f"the depth at t = 0 is {1.0 + found.value:.4g} times the static depth, at which theory has the "
        "indenter at rest (Eq. 40)"
    )
    yield Trial("wrong initial depth", text, found, 1.0 + found.value)


def _simulated(bench: Bench, does: Mapping[str, Any]) -> Curves | None:
    """Return the curves of elements that make a mistake, at the times of the rows."""
    theory = bench.case.theory
    scene, half = theory.scene, theory.static.half_length
    spacing, speed = half / PER_HALF_LENGTH, theory.motion.highest_speed
    step = PASSED * spacing / speed if speed else math.inf
    if not scene.held:
        contact = 2.0 * half * scene.foundation.damping
        step = min(step, STABLE * RK4_LIMIT * scene.support.mass / contact)
    times = np.clip(bench.time, 0.0, LONGEST_RUN * step)
    unique, index = np.unique(times, return_inverse=True)
    try:
        found = theory.methods.elements(scene, spacing, step, unique.tolist(), does)
    except (ValueError, ArithmeticError):
        return None
    return {name: values[index] for name, values in curves(found, scene).items()}


def _changed(bench: Bench, right: Curves, wrong: Curves, share: float) -> Curves:
    """Return theory plus a share of the change that a mistake makes."""
    moving = bench.time >= 0.0
    return {
        name: bench.now[name]
        + share * np.where(moving, np.nan_to_num(wrong[name] - right[name]), 0.0)
        for name in CURVES
    }
