"""A series compared with theory: the checks, the verdict, and the fault that explains a disagreement best."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from kvtheory.checks import comparison_case as case_of
from kvtheory.checks import faults
from kvtheory.checks.checklist import SAMPLING, judge
from kvtheory.checks.comparison_case import COARSE, UNSTABLE, Case, make_case
from kvtheory.checks.contact_rules import mistakes
from kvtheory.checks.fitting import Bench, Hypothesis, Trial, bench
from kvtheory.checks.reading import Series
from kvtheory.checks.settling import PHASE
from kvtheory.checks.theory import Theory
from kvtheory.results import TRANSIENT_UNITS, DivergenceError
from kvtheory.results.comparison import Check, Comparison, Explanation

Family = Callable[[Bench], Iterator[Hypothesis]]

FAMILIES: tuple[tuple[Family, float], ...] = (
    (faults.signs_and_units, 0.5), (faults.other_scenes, 0.97), (faults.time_units, 0.5),
    (faults.time_offset, 0.97), (faults.parameters, 0.9), (faults.damper, 0.9),
    (faults.scales_and_offsets, 0.97), (mistakes, 1.0),
)  # fmt: skip
"""Families in the order in which they are tried, and the part of the difference that a fault must explain to
end the search: signs and units are not fitted, so that a small part suffices."""
BY_ELEMENTS: tuple[tuple[Family, float], ...] = (
    (faults.signs_and_units, 0.5), (faults.other_scenes, 0.9), (faults.scales_and_offsets, 0.97),
    (faults.parameters, 0.9),
)  # fmt: skip
"""The families that are tried where each theory is a run of many elements."""
NOT_TRIED = (
    "; units and offsets of the time, and contact rules, are not tried where theory is by elements"
)
NAMED = 0.4
"""Part of the difference that a fault must explain to be named."""
SHOWN = 4
"""Largest number of explanations that are kept."""
MOST_NAMED = 20
"""Largest number of unused columns that are named in the diagnosis."""
INCONCLUSIVE = {
    SAMPLING: "The data are sampled too coarsely to show the transient",
    PHASE: "Theory cannot predict the phase of the cycle by now, for such elements and steps",
}
"""Checks whose failure is no evidence against the data, and what the failure means."""
MEMORY_UNUSED = (
    " The sliding never reverses, so that the memory of the free surface was not tested."
)


@np.errstate(over="ignore", invalid="ignore")  # data that diverge overflow when squared
def compare(
    theory: Theory, series: Series, per_length: float | None, scheme: str | None, tolerance: float
) -> Comparison:
    """Compare a series with theory; `kvtheory.compare` documents it."""
    series = replace(series, scheme=scheme or series.scheme)
    try:
        case = make_case(theory, series, per_length, tolerance, case_of.COARSEST)
    except ArithmeticError as error:
        until = f"up to t = {series.time[-1]:.6g} s, where the data end ({error})"
        told = f"{series.source}: the theory cannot be computed {until}; is the unit of the time right?"
        raise ArithmeticError(told) from None
    checks = judge(case)
    others = {check.name for check in checks if check.ok is False} - {COARSE}
    if others and case.resolution.spacing_read:  # a large noise is then not that of elements alone
        case = make_case(theory, series, per_length, tolerance, case_of.LARGEST_SAWTOOTH)
        checks = judge(case)
    text, explanations = diagnose(case, checks)
    if series.ignored:
        unnamed = len(series.ignored) - MOST_NAMED
        more = f" and {unnamed} more" if unnamed > 0 else ""
        text += f" Columns that were not used: {', '.join(series.ignored[:MOST_NAMED])}{more}."
    allowed = {name: case.allowed(name) for name in case.names}
    return Comparison(
        verdict(checks), checks, text, explanations, series.source, tolerance,
        dict(series.columns), dict(case.now), allowed, theory.units,
    )  # fmt: skip


def broken_off(
    theory: Theory, error: DivergenceError, scheme: str | None, tolerance: float
) -> Comparison:
    """Return the verdict on a simulation of ours that diverged, which is not compared with theory."""
    series = dict(zip(TRANSIENT_UNITS, np.array(error.rows).T, strict=True))
    now = theory.at(series["time"])
    missing = 1.0 - float(series["time"][-1]) / theory.scene.run.duration
    unit = "part of the duration that is missing"
    check = Check("run to the end", missing, 0.0, False, "F15", unit)
    text = f"the time step is unstable (F15): {error}"
    allowed = {name: np.zeros_like(now[name]) for name in series if name in now}
    return Comparison(
        "disagrees", (check,), f"{_sentence(text)}. Failed: {check.name} (F15).",
        (Explanation(UNSTABLE, text, 1.0, True),), scheme or "our own simulation", tolerance,
        series, now, allowed, theory.units,
    )  # fmt: skip


def verdict(checks: Sequence[Check]) -> str:
    """Return whether the data agree; if only sampling or the phase of a cycle fails, that is not known."""
    failed = [check.name for check in checks if check.ok is False]
    if not failed:
        return "agrees"
    return "cannot tell" if all(name in INCONCLUSIVE for name in failed) else "disagrees"


def diagnose(case: Case, checks: Sequence[Check]) -> tuple[str, tuple[Explanation, ...]]:
    """Return the diagnosis in words, and the faults behind it, the best first."""
    failed, known = [check for check in checks if check.ok is False], verdict(checks)
    made = sum(check.ok is not None for check in checks)
    if known == "agrees":
        one_way = case.theory.scene.drive.constant and case.theory.scene.drive.rigid
        return f"All {made} checks that could be made passed.{MEMORY_UNUSED * one_way}", ()
    if known == "cannot tell":
        why = "; ".join(INCONCLUSIVE[check.name] for check in failed)
        return f"{why}; all of the other {made - len(failed)} checks that could be made passed.", ()
    found = sorted(
        [*case_of.symptoms(case, failed), *explanations(case)], key=lambda each: -each.rank
    )
    named = [each for each in found if each.rank >= NAMED]
    return _words(case, failed, named), tuple((named or found)[:SHOWN])


def explanations(case: Case) -> list[Explanation]:
    """Try every fault and order them: those that explain the data first, then by the remaining difference."""
    rows = bench(case)
    trials: list[Trial] = []
    families = BY_ELEMENTS if case.theory.by_elements else FAMILIES
    for number, (family, good) in enumerate(families):
        tried: list[Trial] = []
        for hypothesis in family(rows):
            tried.append(rows.tried(hypothesis, min((t.score for t in tried), default=np.inf)))
            count = len(trials) + len(tried)
            case.theory.methods.tell(number / len(families), f"{count} faults tried")
        fitted = [trial for trial in tried if trial.hypothesis.powers]
        best = min(fitted, key=lambda trial: trial.score, default=None)
        if best and best.enough:
            alike = rows.indistinguishable(best, [t.hypothesis for t in fitted if t is not best])
            symbols = tuple(name.removeprefix(faults.WRONG) for name in alike)
            tried = [t._replace(alike=symbols) if t is best else t for t in tried]
        trials += tried
        if any(trial.enough and trial.score <= (1.0 - good) * rows.start for trial in trials):
            break
    found: dict[str, Explanation] = {}
    for fault, score, enough, x, alike in sorted(trials, key=lambda trial: trial.score):
        explained = 1.0 - score / rows.start if rows.start else 0.0
        found.setdefault(fault.name, Explanation(
            fault.name, fault.text(x), explained, enough and explained >= NAMED,
            fault.factor(x), explained, alike,
        ))  # fmt: skip
    return [each for each in found.values() if each.rank > 0.0]


def _words(case: Case, failed: Sequence[Check], named: Sequence[Explanation]) -> str:
    """Say what explains the disagreement, what else would, and which checks failed."""
    which = "; ".join(f"{check.name} ({check.equation})" for check in failed)
    if not named:
        not_tried = NOT_TRIED * case.theory.by_elements
        return f"No single known fault explains most of the difference{not_tried}. Failed: {which}."
    first, *rest = named
    symbol, text, also = first.name.removeprefix(faults.WRONG), _sentence(first.text), ""
    if first.enough:
        alike = {faults.WRONG + name for name in first.alike} | {*first.alike}
        others = [each.text for each in rest if each.enough and each.name not in alike]
        also = f" Also possible: {'; '.join(others)}." if others else ""
    else:
        part = "" if first.explained is None else f", {first.explained:.0%} of the difference"
        text = f"Closest, but not all{part}: {first.text}"
    if first.alike:
        together = f"{symbol} and {' or '.join(first.alike)}"
        also = f" {together} cannot be told apart by these data.{also}"
    return f"{text}.{also} Failed: {which}."


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]
