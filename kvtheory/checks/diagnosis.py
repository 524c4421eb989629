"""What is wrong with data that disagree: the fault that explains them best, in words."""

from collections.abc import Callable, Iterator, Sequence

from kvtheory.checks.checklist import SAMPLING
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.faults import (
    WRONG,
    Trial,
    decades,
    offset,
    parameters,
    scales,
    spring,
    undone,
)
from kvtheory.checks.fitting import Bench, bench
from kvtheory.checks.mistakes import mistakes
from kvtheory.checks.other_scenes import damper, replaced
from kvtheory.checks.settling import PHASE
from kvtheory.checks.symptoms import coarse, rattling, seen, unmoved
from kvtheory.results.comparison import Check, Explanation

FAMILIES: tuple[tuple[Callable[[Bench], Iterator[Trial]], float], ...] = (
    (undone, 0.5), (replaced, 0.97), (decades, 0.5), (offset, 0.97), (parameters, 0.9), (damper, 0.9),
    (scales, 0.97), (mistakes, 1.0),
)  # fmt: skip
"""The families in the order in which they are tried, and the part of the difference that one of their faults
must explain for nothing else to be looked for: a sign or a unit is not fitted, so that little is enough."""
BY_ELEMENTS: tuple[tuple[Callable[[Bench], Iterator[Trial]], float], ...] = (
    (undone, 0.5), (replaced, 0.9), (spring, 1.0),
)  # fmt: skip
"""Those where each theory that others would ask for is a run of many elements."""
NAMED = 0.4
"""Part of the difference that a fault must explain to be named."""
SHOWN = 4
"""Explanations that are kept."""
UNTOLD = {
    SAMPLING: "The data are sampled too coarsely to show the transient",
    PHASE: "Where the cycle of this motion should be by now, theory cannot say for such elements and steps",
}
"""Checks whose failure says nothing against the data, and what it does say."""


def verdict(checks: Sequence[Check]) -> str:
    """Return whether the data agree; where only sampling or the phase of a cycle fails, that is not known."""
    failed = [check.name for check in checks if check.ok is False]
    if not failed:
        return "agrees"
    return "cannot tell" if all(name in UNTOLD for name in failed) else "disagrees"


def diagnose(case: Case, checks: Sequence[Check]) -> tuple[str, tuple[Explanation, ...]]:
    """Return the diagnosis in words, and the faults behind it, the best first."""
    failed = [check for check in checks if check.ok is False]
    made = sum(check.ok is not None for check in checks)
    if verdict(checks) == "agrees":
        return f"All {made} checks that could be made are passed.", ()
    if verdict(checks) == "cannot tell":
        why = "; ".join(UNTOLD[check.name] for check in failed)
        return (
            f"{why}; nothing else speaks against them, and the other {made - len(failed)} checks that could "
            "be made are passed."
        ), ()
    found = explanations(case)
    if not any(each.enough for each in found[:1]):
        found = [*unmoved(case, failed), *found, *coarse(case, failed)]
    found = sorted([*seen(case, failed), *rattling(case), *found], key=lambda each: -each.rank)
    named = [each for each in found if each.rank >= NAMED]
    return _words(failed, named), tuple((named or found)[:SHOWN])


def explanations(case: Case) -> list[Explanation]:
    """Try every fault and order them: those that explain the data first, then by what they leave."""
    rows = bench(case)
    start = rows.fit(rows.columns, rows.now).score
    trials: list[Trial] = []
    families = BY_ELEMENTS if case.theory.by_elements else FAMILIES
    for number, (family, good) in enumerate(families):
        for trial in family(rows):
            trials.append(trial)
            case.theory.methods.tell(number / len(families), f"{len(trials)} faults tried")
        fits = [trial.fitted.fit for trial in trials]
        if any(fit.enough and fit.score <= (1.0 - good) * start for fit in fits):
            break
    trials.sort(key=lambda trial: trial.fitted.fit.score)
    found: dict[str, Explanation] = {}
    for trial in trials:
        explained = 1.0 - trial.fitted.fit.score / start if start else 0.0
        enough = trial.fitted.fit.enough and explained >= NAMED
        each = Explanation(
            trial.name, trial.text, explained, enough, trial.factor, explained, trial.alike
        )
        found.setdefault(trial.name, each)
    return [each for each in found.values() if each.rank > 0.0]


def _words(failed: Sequence[Check], named: Sequence[Explanation]) -> str:
    """Say what explains the disagreement, what else would, and which checks failed."""
    which = "; ".join(f"{check.name} ({check.equation})" for check in failed)
    if not named:
        return f"No single known fault explains most of the difference. Failed: {which}."
    first, *rest = named
    text = first.text[0].upper() + first.text[1:]
    if not first.enough:
        part = (
            ""
            if first.explained is None
            else f", which explains {first.explained:.0%} of the difference"
        )
        text = f"Closest: {first.text}{part}, but not all"
    equal = [
        e
        for e in rest
        if e.enough and first.enough and e.name.removeprefix(WRONG) not in first.alike
    ]
    also = f" The data do not rule out: {'; '.join(each.text for each in equal)}." if equal else ""
    if first.alike:
        together = f"{first.name.removeprefix(WRONG)} and {' or '.join(first.alike)}"
        also = f" {together} cannot be told apart by these data.{also}"
    return f"{text}.{also} Failed: {which}."
