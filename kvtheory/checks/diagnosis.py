"""What is wrong with data that disagree: the fault that explains them best, in words."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from kvtheory.checks import faults
from kvtheory.checks.checklist import SAMPLING
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.contact_rules import mistakes
from kvtheory.checks.fitting import Bench, Hypothesis, Trial, bench
from kvtheory.checks.settling import PHASE
from kvtheory.checks.symptoms import growing, in_failed_checks
from kvtheory.results.comparison import Check, Explanation

Family = Callable[[Bench], Iterator[Hypothesis]]

FAMILIES: tuple[tuple[Family, float], ...] = (
    (faults.signs_and_units, 0.5), (faults.other_scenes, 0.97), (faults.time_units, 0.5),
    (faults.time_offset, 0.97), (faults.parameters, 0.9), (faults.damper, 0.9),
    (faults.scales_and_offsets, 0.97), (mistakes, 1.0),
)  # fmt: skip
"""The families in the order in which they are tried, and the part of the difference that one of their faults
must explain to end the search: a sign or a unit is not fitted, so that little is enough."""
BY_ELEMENTS: tuple[tuple[Family, float], ...] = (
    (faults.signs_and_units, 0.5), (faults.other_scenes, 0.9), (faults.scales_and_offsets, 0.97),
    (faults.parameters, 0.9),
)  # fmt: skip
"""Those where each theory is a run of many elements."""
NOT_TRIED = (
    "; other units and offsets of the time, and wrong contact rules, are not tried where theory is a "
    "simulation"
)
NAMED = 0.4
"""Part of the difference that a fault must explain to be named."""
SHOWN = 4
"""Explanations that are kept."""
INCONCLUSIVE = {
    SAMPLING: "The data are sampled too coarsely to show the transient",
    PHASE: "Theory cannot say where the cycle of this motion is by now, for such elements and steps",
}
"""Checks whose failure says nothing against the data, and what it does say."""
MEMORY_UNUSED = (
    " The sliding never reverses, so that the memory of the free surface was not tested."
)


def verdict(checks: Sequence[Check]) -> str:
    """Return whether the data agree; if only sampling or the phase of a cycle fails, that is not known."""
    failed = [check.name for check in checks if check.ok is False]
    if not failed:
        return "agrees"
    return "cannot tell" if all(name in INCONCLUSIVE for name in failed) else "disagrees"


def diagnose(case: Case, checks: Sequence[Check]) -> tuple[str, tuple[Explanation, ...]]:
    """Return the diagnosis in words, and the faults behind it, the best first."""
    failed = [check for check in checks if check.ok is False]
    made = sum(check.ok is not None for check in checks)
    if verdict(checks) == "agrees":
        one_way = case.theory.scene.drive.constant and case.theory.scene.drive.rigid
        return f"All {made} checks that could be made passed.{MEMORY_UNUSED * one_way}", ()
    if verdict(checks) == "cannot tell":
        why = "; ".join(INCONCLUSIVE[check.name] for check in failed)
        return f"{why}; all of the other {made - len(failed)} checks that could be made passed.", ()
    found = explanations(case)
    found = sorted([*in_failed_checks(case, failed), *growing(case), *found], key=lambda e: -e.rank)
    named = [each for each in found if each.rank >= NAMED]
    return _words(case, failed, named), tuple((named or found)[:SHOWN])


def explanations(case: Case) -> list[Explanation]:
    """Try every fault and order them: those that explain the data first, then by what they leave."""
    rows = bench(case)
    trials: list[Trial] = []
    families = BY_ELEMENTS if case.theory.by_elements else FAMILIES
    for number, (family, good) in enumerate(families):
        tried: list[Trial] = []
        for hypothesis in family(rows):
            best = min((trial.score for trial in tried), default=float("inf"))
            tried.append(rows.tried(hypothesis, best))
            told = len(trials) + len(tried)
            case.theory.methods.tell(number / len(families), f"{told} faults tried")
        trials += _with_alike(rows, tried)
        if any(trial.enough and trial.score <= (1.0 - good) * rows.start for trial in trials):
            break
    found: dict[str, Explanation] = {}
    for trial in sorted(trials, key=lambda trial: trial.score):
        fault, x = trial.hypothesis, trial.value
        explained = 1.0 - trial.score / rows.start if rows.start else 0.0
        each = Explanation(
            fault.name, fault.text(x), explained, trial.enough and explained >= NAMED,
            fault.factor(x), explained, trial.alike,
        )  # fmt: skip
        found.setdefault(fault.name, each)
    return [each for each in found.values() if each.rank > 0.0]


def _with_alike(rows: Bench, tried: list[Trial]) -> list[Trial]:
    """Add to the best parameter of a family those that the data cannot distinguish from it."""
    best = min((t for t in tried if t.hypothesis.powers), key=lambda t: t.score, default=None)
    if best is None or not best.enough:
        return tried
    others = [t.hypothesis for t in tried if t.hypothesis.powers and t is not best]
    alike = rows.indistinguishable(best, others)
    symbols = tuple(name.removeprefix(faults.WRONG) for name in alike)
    return [replace(each, alike=symbols) if each is best else each for each in tried]


def _words(case: Case, failed: Sequence[Check], named: Sequence[Explanation]) -> str:
    """Say what explains the disagreement, what else would, and which checks failed."""
    which = "; ".join(f"{check.name} ({check.equation})" for check in failed)
    if not named:
        not_tried = NOT_TRIED * case.theory.by_elements
        return f"No single known fault explains most of the difference{not_tried}. Failed: {which}."
    first, *rest = named
    text = first.text[0].upper() + first.text[1:]
    if not first.enough:
        part = "" if first.explained is None else f", {first.explained:.0%} of the difference"
        text = f"Closest, but not all{part}: {first.text}"
    equal = [
        e
        for e in rest
        if e.enough and first.enough and e.name.removeprefix(faults.WRONG) not in first.alike
    ]
    also = f" Also possible: {'; '.join(each.text for each in equal)}." if equal else ""
    if first.alike:
        together = f"{first.name.removeprefix(faults.WRONG)} and {' or '.join(first.alike)}"
        also = f" {together} cannot be told apart by these data.{also}"
    return f"{text}.{also} Failed: {which}."
