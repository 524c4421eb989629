"""Mistakes in the contact rule or the initial state of a simulator, as hypotheses.

What each one changes in the curves is simulated (`trial_elements`) and added to theory.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from kvtheory.checks.hypotheses import Bench, Hypothesis, Pair, fixed
from kvtheory.checks.theory import Array, Curves
from kvtheory.checks.trial_elements import Rule, changes
from kvtheory.scene import Scene


class Mistake(NamedTuple):
    """A fault: its name, its description, and its rules, of which the one that fits best counts."""

    name: str
    text: str
    rules: Sequence[Rule]
    shows: str = ""  # the kind of scenes in which it can show (`SHOWS`)
    strengths: Sequence[float] = ()  # one for each rule: an unknown, shown in the text
    right: float | None = None  # the strength without effect


SHOWS: Mapping[str, Callable[[Scene], bool]] = {
    "Kelvin-Voigt": lambda scene: not scene.foundation.arms,
    "arms": lambda scene: bool(scene.foundation.arms),
    "moves": lambda scene: not scene.held or bool(scene.depths),
    "starts at rest": lambda scene: not scene.held and scene.start.at_rest,
    "comes back": lambda scene: (
        bool(scene.depths) or not (scene.drive.constant and scene.drive.rigid)
    ),
    "ball": lambda scene: not scene.indenter.per_width,
    "line": lambda scene: scene.indenter.per_width,
    "": lambda _scene: True,
}
"""Kinds of scenes in which a mistake can show."""
FORGETFUL, DAMPERS = math.inf, (0.3, 1.0, 3.0)
TIMES, PARTS, RATES = (0.4, 0.7, 1.4), (0.03, 0.1, 0.25), (0.5, 0.8, 1.25, 2.0)
STARTS, LOSSES, LAGS = (0.85, 1.15), (0.3, 0.6, 0.8, 0.95), (0.0, 0.1, 0.25, 0.6)
"""Simulated strengths: factors of damping, of a time, of a rate and of the depth; parts of a force and of a
length; and lags, of which Runge-Kutta is unstable with more than the last one."""
BETWEEN = 5
"""Starts of a fit for each simulated strength: beyond some strength there may be no slope."""
HUGE, BEYOND = 1e100, 0.02
"""Largest change that is interpolated, as a wrong rule may diverge, and how far strengths may go beyond."""
MISTAKES = (
    Mistake("no sliding term in the compression rate",
            "the compression rate is delta' alone: an element that moves with the base under a slope is "
            "compressed at u' = delta' - h' V (Eq. 7)",
            [Rule(slide_rate=0.0), Rule(slide_rate=0.0, decay=FORGETFUL)]),
    Mistake("no depth term in the compression rate",
            "the compression rate is -h' V alone: an indenter that sinks or rises adds delta' (Eq. 7)",
            [Rule(depth_rate=0.0), Rule(depth_rate=0.0, decay=FORGETFUL)], "moves"),
    Mistake("wrong depth term in the compression rate",
            "the compression rate is {:.3g} delta' - h' V: the whole of delta' counts (Eq. 7)",
            [Rule(depth_rate=factor) for factor in RATES], "moves", RATES, 1.0),
    Mistake("sign of the compression rate",
            "the pressure falls with the compression rate: it is p = K u + C u' (Eq. 5)",
            [Rule(depth_rate=-1.0, slide_rate=-1.0, decay=FORGETFUL)]),
    Mistake("sign of the sliding term",
            "the sliding term of the compression rate has the wrong sign: it is u' = delta' - h' V (Eq. 7), "
            "so that the pressure is higher where the foundation enters",
            [Rule(slide_rate=-1.0), Rule(slide_rate=-1.0, decay=FORGETFUL)]),
    Mistake("no damper", "the pressure is K u, without a damper (Eq. 5)",
            [Rule(depth_rate=0.0, slide_rate=0.0, decay=FORGETFUL)]),
    Mistake("Hunt-Crossley damping",
            "the damping grows with the compression, p = K u (1 + c u') with c = {:.3g} tau/delta_0, as in "
            "the law of Hunt and Crossley: that of Kelvin and Voigt is constant, p = K u + C u' (Eq. 5)",
            [Rule(hunt_crossley=c, decay=FORGETFUL) for c in DAMPERS], "Kelvin-Voigt", DAMPERS),
    Mistake("sign of the slope in friction",
            "friction is computed from a pressure with the wrong sign of h' V (Eqs. 7 and 15)",
            [Rule(friction=-1.0)], "Kelvin-Voigt"),
    Mistake("friction by the normal in the middle",
            "friction is F_z times the slope in the middle of the contact patch, as for a single contact "
            "point: it is the integral of p h' (Eq. 15)", [Rule(central=True)]),
    Mistake("sine of the slope in friction",
            "friction is the integral of the pressure times the sine of the slope: it is that of p h', its "
            "tangent, as p is a force per area of the plane (Eq. 15)", [Rule(sine=True)]),
    Mistake("pressure along the surface",
            "the pressure is summed along the surface, as p sqrt(1 + h'^2) dx: it is a force per area of the "
            "plane, p dx (Eqs. 14 and 15)", [Rule(arc=True)]),
    Mistake("circle instead of its parabola",
            "the profile is a circle, R - sqrt(R^2 - x^2): theory has the parabola x^2/(2 R) in its place "
            "(Eq. 3), which it is where x is much smaller than R", [Rule(circle=True)], "line"),
    Mistake("tension allowed at the trailing edge",
            "the foundation stays attached where it would pull (no peeling): an element must detach where "
            "its pressure vanishes (Eqs. 23, 24 and 33)", [Rule(tension=True)]),
    Mistake("contact lost while rising",
            "elements lose contact where the indenter rises, for the surface of the last step is taken for "
            "the present one: a free surface relaxes within the step too (Eqs. 20 and 25, F8)",
            [Rule(stale=part) for part in LOSSES], "moves", LOSSES, 0.0),
    Mistake("contact lost while rising",
            "contact is lost from the equation of motion while the indenter rises, by {:.2g} of the force, "
            "as where an element counts as free once the indenter is above where the last step left it "
            "(Eqs. 24 and 25, F8)",
            [Rule(drops=part) for part in LOSSES], "moves", LOSSES, 0.0),
    Mistake("contact lost while rising",
            "contact is lost within a Runge-Kutta step, in the stages at which the indenter rises: it sinks "
            "until half of the force bears the load, with the lag of half a step, {:.2g} M/(C A), A being "
            "its contact at rest (Eqs. 24 and 25, F8)",
            [Rule(drops=0.5, creep=lag) for lag in LAGS], "moves", LAGS),
    Mistake("no relaxation of the free surface",
            "the free surface does not relax where the indenter recedes from it or comes back to it: it "
            "decays as exp(-t/tau) (Eqs. 20 and 25, F8)", [Rule(decay=0.0), Rule(freezes=True)]),
    Mistake("memory forgotten where sliding reverses",
            "the indenter meets an undeformed foundation where it re-enters ground that it left: the "
            "surface there is still compressed, and relaxes as exp(-t/tau) (Eq. 20, F8)",
            [Rule(decay=FORGETFUL), Rule(clears=True)], "comes back"),
    Mistake("wrong time of the free surface",
            "the free surface relaxes {:.3g} times as fast as exp(-t/tau) (Eq. 20)",
            [Rule(decay=factor) for factor in TIMES], "Kelvin-Voigt", TIMES, 1.0),
    Mistake("half of the contact",
            "only half of the contact presses: all of its elements count (Eqs. 14 and 15)",
            [Rule(front=0.5, back=0.5), Rule(back=0.0), Rule(front=0.0)]),
    Mistake("elements lost at the leading edge",
            "elements at the leading edge do not count, over {:.2g} of the half length: the foundation "
            "enters there, and the pressure is largest (Eqs. 14 and 32)", [Rule(lost=part) for part in PARTS],
            strengths=PARTS, right=0.0),
    Mistake("a ball by the formulas of a line",
            "every strip of the ball is as deep as its middle plane: a strip at y is at the depth delta - "
            "y^2/(2 R) (F20)", [Rule(flat=True)], "ball"),
    Mistake("extra vertical damper",
            "the indenter is damped by {:.2g} C A beside the foundation, A being its contact at rest (Eq. "
            "17): as a damper of its own, or as the damping of a time integration",
            [Rule(damper=share) for share in DAMPERS], "moves", DAMPERS, 0.0),
    Mistake("undeformed at the start",
            "at t = 0 the indenter touches an undeformed foundation, where theory has it at rest at its "
            "static depth (Eq. 40)", [Rule(start=0.0)], "starts at rest"),
    Mistake("wrong initial depth",
            "the depth at t = 0 is {:.4g} times the static depth, at which theory starts (Eq. 40)",
            [Rule(start=start) for start in STARTS], "starts at rest", STARTS, 1.0),
    Mistake("arms loaded at the start",
            "the arms bear load at t = 0, as if the indenter had been pressed in at that instant: at rest "
            "they have relaxed (Eq. 40)", [Rule(loaded=True)], "arms"),
)  # fmt: skip
"""Every mistake that is tried."""


def mistakes(
    bench: Bench, changes: Callable[..., Sequence[Curves]] = changes
) -> Iterator[Hypothesis]:
    """Yield each mistake that can show in the scene: theory, and what the mistake changes in a simulation."""
    tried = [mistake for mistake in MISTAKES if SHOWS[mistake.shows](bench.theory.scene)]
    made = iter(changes(bench.theory, [rule for each in tried for rule in each.rules], bench.time))

    def changed(change: Curves) -> Pair:
        there = {name: bench.now[name] + change[name] for name in change if name in bench.now}
        return bench.columns, {**bench.now, **there}

    for mistake in tried:
        found = [next(made) for _ in mistake.rules]
        if mistake.strengths:
            yield _fitted(mistake, found, changed)
        else:
            yield from (fixed(mistake.name, mistake.text, changed(change)) for change in found)


def _fitted(
    mistake: Mistake, found: Sequence[Curves], changed: Callable[[Curves], Pair]
) -> Hypothesis:
    """Return the hypothesis of a mistake of unknown strength, interpolated between simulations."""
    right = mistake.right
    known = dict(zip(mistake.strengths, found, strict=True))
    if right is not None:
        known[right] = {name: np.zeros_like(values) for name, values in found[0].items()}
    strengths, names = np.array(sorted(known)), list(found[0])
    table: Array = np.array([[known[s][name] for name in names] for s in strengths])
    between = PchipInterpolator(strengths, np.clip(table, -HUGE, HUGE), axis=0)

    def make(x: float) -> Pair | None:
        if not max(strengths[0] - BEYOND, 0.0) <= x <= strengths[-1] + BEYOND:
            return None
        return changed(dict(zip(names, between(x), strict=True)))

    places = np.linspace(0.0, strengths.size - 1.0, BETWEEN * (strengths.size - 1) + 1)
    starts = np.interp(places, np.arange(strengths.size), strengths)
    return Hypothesis(mistake.name, mistake.text, make, starts.tolist())
