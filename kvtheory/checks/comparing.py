"""A series compared with theory: the checks, the verdict, and the fault that explains a disagreement best."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kvtheory.checks import comparison_case as case_of
from kvtheory.checks import faults
from kvtheory.checks.checklist import PHASE, SAMPLING, judge
from kvtheory.checks.comparison_case import (
    COARSE,
    NUMBER,
    SAWTOOTH,
    UNKNOWN,
    UNSTABLE,
    Case,
    make_case,
)
from kvtheory.checks.contact_rules import mistakes
from kvtheory.checks.detectable import detectable
from kvtheory.checks.hypotheses import WRONG, Bench, Hypothesis, Pair, Trial, bench, scaled_scene
from kvtheory.checks.theory import Theory
from kvtheory.checks.trial_elements import Rule, changes
from kvtheory.fitting.series import Series
from kvtheory.results import TRANSIENT_UNITS, DivergenceError
from kvtheory.results.comparison import Check, Comparison, Explanation

Family = Callable[[Bench], Iterator[Hypothesis]]

Families = Sequence[tuple[str, Family]]

FAMILIES: Families = (
    ("signs and units", faults.signs_and_units), ("scales and offsets", faults.scales_and_offsets),
    ("other foundations and drives", faults.other_scenes), ("contact rules", mistakes),
    ("parameters", faults.parameters), ("delays and filters", faults.delays),
    ("units of the time", faults.time_units),
)  # fmt: skip
"""The faults that are tried, in their order."""
OF_TIME = {"delays and filters", "units of the time"}
"""The families that show in a series alone."""
EXACT, MOST_SOLVED = 0.999, 300
"""Part of the difference that ends the search; and scenes that are solved before no family is begun and no
distant guess tried: counted, not timed, so that a diagnosis is the same on any machine."""
REFINED, FLEXIBLE = 3, 0.1
"""Number of distant guesses tried; and the part by which a fault with an unknown must fit better than
one without. A parameter must fit the better, the further it is from its value."""
NAMED, TIED = 0.5, 0.02
"""Part of the difference that a fault must explain to be named; and by how much more, to be named alone."""
SHOWN = 4
"""Most explanations that are kept, and most parameters that are named as indistinguishable."""
MOST_NAMED = 20
"""Largest number of unused columns that are named in the diagnosis."""
SCATTER = "scatter"
"""Name of the check of the scatter of a measured curve."""
INCONCLUSIVE = {
    SAMPLING: "The data are sampled too coarsely to show the transient",
    SCATTER: "The points scatter too much to test the curve",
    UNKNOWN: "The differences may be the error of a sound method, not a fault: a time step "
    f"{case_of.LONGER:g} times as long as assumed allows them, on a ball or on arms alone with elements "
    f"{case_of.COARSER:g} times as far apart, and these data do not show theirs",
    PHASE: "Theory cannot predict the phase of the cycle by now, for such elements and steps",
}
"""Checks whose failure is no evidence against the data, and what the failure means."""
NOT_OF_CURVES = COARSE, NUMBER
"""Checks of elements and steps, after which no fault is tried: the curves agree."""
LARGER = 1.5
"""Factor on a quantity that must show in the data, for the quantity to count as tested."""
NEEDED = "depth", "normal_force", "friction_force"
"""Columns whose absence is worth a remark."""


def _untested(case: Case, limits: Mapping[str, float | None]) -> str:
    """Say what an error would not show of in these data, and the reference problem in which it would."""
    rows, scene, motion = bench(case), case.theory.scene, case.theory.motion
    powers = {each.symbol: each.powers for each in faults.parameters_of(scene)}
    per_tau = {"foundation.retardation_time": -1.0} if "tau" in powers else {}
    stiffness = {**powers["K"], **per_tau}
    named = "tau", "all tau_i", "tau_1", *(name.replace("_", " ") for name in scene.foundation.own)
    times = next(powers[name] for name in named if name in powers)
    parts = [
        ("the stiffness", "low-velocity", stiffness),
        ("the damper" if "tau" in powers else "the relaxation times", "high-velocity", times),
        *([] if scene.held else [("the inertia", "heavy-mass", powers["inertia"])]),
    ]
    if (limits["retardation_time"] or math.inf) < LARGER - 1.0:  # it shows
        del parts[1]
    untested = [f"{what}, as {LARGER:g} times as much would not show ({problem})"
            for what, problem, by in parts
            if not rows.shows(rows.against(scaled_scene(scene, by, LARGER)))]  # fmt: skip
    memory = "the memory of the free surface"
    one_way = scene.drive.constant and scene.drive.rigid and not scene.depths
    if one_way and motion.highest_speed:
        untested.append(f"{memory}, as the sliding never reverses (reversal)")
    elif one_way or not rows.shows(_without_memory(rows)):
        untested.append(f"{memory}, as its absence would not show (reversal)")
    if scene.held:
        untested.append("the inertia, as the indenter is fixed (paper-dead-weight)")
    elif not np.isnan(case.now["leading_edge"]).any():
        untested.append("a flight and a landing (take-off)")
    if missing := [name.replace("_", " ") for name in NEEDED if name not in case.columns]:
        untested.append(f"the {' and the '.join(missing)}, which the data do not hold")
    problems = "(in brackets, the reference problem that does)"
    return f" Not tested {problems}: {'; '.join(untested)}." if untested else ""


def _without_memory(rows: Bench) -> Pair:
    """Return the data, and theory as it were without a memory of the free surface."""
    change = changes(rows.theory, [Rule(decay=math.inf)], rows.time)[0]
    return rows.columns, {name: rows.now[name] + change[name] for name in rows.names}


@np.errstate(over="ignore", invalid="ignore")  # data that diverge overflow when squared
def compare(
    theory: Theory, series: Series, per_length: float | None, scheme: str | None, tolerance: float
) -> Comparison:
    """Compare a series with theory; `kvtheory.compare` documents it."""
    series = replace(series, scheme=scheme or series.scheme)
    try:
        case = make_case(theory, series, per_length, tolerance, case_of.COARSEST)
    except ArithmeticError as error:
        power = round(math.log10(theory.scene.run.duration / float(series.time[-1])))
        if power in faults.DECADES:
            times = {**series.columns, "time": series.time * 10.0**power}
            found = compare(theory, replace(series, columns=times), per_length, scheme, tolerance)
            return _off_by(power, found, series)
        until = f"up to t = {series.time[-1]:.6g} s, where the data end ({error})"
        message = f"{series.source}: the theory cannot be computed {until}; is the unit of the time right?"
        raise ArithmeticError(message) from None
    checks = judge(case)
    others = {check.name for check in checks if check.ok is False} - {COARSE}
    if others and case.resolution.spacing_read == SAWTOOTH:  # noise is not of elements alone
        case = make_case(theory, series, per_length, tolerance, case_of.LARGEST_SAWTOOTH)
        checks = judge(case)
    elif others and case.resolution.spacing_read:  # the edges may be wrong themselves
        case = replace(case, resolution=case.resolution._replace(spacing_read=""))
        checks = judge(case)
    case, checks = _undecided(case, checks)
    text, explanations = diagnose(case, checks)
    known, limits = verdict(checks), dict[str, float | None]()
    if known != "disagrees":
        longer = case_of.with_longer_steps(case) if known == "agrees" else None
        limits, shown = detectable(longer or case)  # with what would count as not known
        text += shown + (_untested(case, limits) if known == "agrees" else "")
    allowed = {name: case.allowed(name) for name in case.names}
    return Comparison(
        known, checks, text + unused(series), explanations, series.source, tolerance,
        dict(series.columns), dict(case.now), allowed, theory.units, limits,
    )  # fmt: skip


def _undecided(case: Case, checks: tuple[Check, ...]) -> tuple[Case, tuple[Check, ...]]:
    """Return what longer steps allow, and that they are not known, if nothing tells these from a fault."""
    failed = [each for each in checks if each.ok is False and each.name not in INCONCLUSIVE]
    worst = max(float((case.excess(name) / case.limit(name)).max()) for name in case.names)
    longer = case_of.with_longer_steps(case) if failed and worst <= case_of.LONGER else None
    if longer is None or verdict(found := judge(longer)) == "disagrees":
        return case, checks
    unit = "time step, over the one assumed, with which all other checks pass"
    return longer, (*found, Check(UNKNOWN, case_of.LONGER, 1.0, False, "F15", unit))


def _off_by(power: int, found: Comparison, series: Series) -> Comparison:
    """Return the verdict on a series that was judged with its times multiplied by a power of ten."""
    text = faults.TIME_UNIT.format(-power)
    unit = "times of the data over those of the run"
    check = Check("unit of time", 10.0**-power, 1.0, False, "", unit)
    then = f"With the times in that unit: {found.diagnosis}"
    enough = found.verdict == "agrees"
    fault = Explanation("unit of time", text, 1.0, enough, 10.0**-power)
    return replace(
        found, verdict="disagrees", checks=(check, *found.checks), diagnosis=f"{_sentence(text)}. {then}",
        explanations=(fault, *found.explanations), series={**found.series, "time": series.time},
    )  # fmt: skip


def unused(series: Series) -> str:
    """Name the columns that were not used."""
    unnamed = len(series.ignored) - MOST_NAMED
    more = f" and {unnamed} more" if unnamed > 0 else ""
    names = ", ".join(series.ignored[:MOST_NAMED])
    return f" Columns that were not used: {names}{more}." if names else ""


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


def diagnose(
    case: Case, checks: Sequence[Check], families: Families = FAMILIES
) -> tuple[str, tuple[Explanation, ...]]:
    """Return the diagnosis in words, and the faults behind it, the best first."""
    failed, known = [check for check in checks if check.ok is False], verdict(checks)
    made = sum(check.ok is not None for check in checks)
    if known == "agrees":
        return f"All {made} checks that could be made passed.", ()
    if known == "cannot tell":
        why = "; ".join(INCONCLUSIVE[check.name] for check in failed)
        return f"{why}; all of the other {made - len(failed)} checks that could be made passed.", ()
    of_curves = any(check.name not in NOT_OF_CURVES for check in failed)
    tried, skipped = explanations(case, families) if of_curves else ([], [])
    seen = case_of.symptoms(case, failed) if families is FAMILIES else ()
    found = sorted([*seen, *tried], key=_order)
    named = [each for each in found if each.rank >= NAMED or each.enough]
    if small := all((case.excess(name) <= case.limit(name)).all() for name in case.names):
        sure = [each for each in named if each.enough]
        if bench(case).untouched.enough:  # what failed does not show in the trials
            sure = [each for each in sure if each.explained is None]
        named = sure or [replace(each, enough=False) for each in named]
    text = _words(failed, named, small)
    text += f" Not tried, after {MOST_SOLVED} scenes: {', '.join(skipped)}." if skipped else ""
    return text, tuple(named if small else (named or found)[:SHOWN])


def _order(each: Explanation) -> float:
    """Order by rank; a fault that is not enough goes before no symptom that is likely."""
    tried_in_vain = not each.enough and each.explained is not None
    return -min(each.rank, case_of.LIKELY) if tried_in_vain else -each.rank


def explanations(case: Case, families: Families = FAMILIES) -> tuple[list[Explanation], list[str]]:
    """Try every fault and order them by the remaining difference; name the families that were not tried."""
    rows = bench(case)
    trials: list[Trial] = []
    skipped = []

    def tell(number: int) -> None:
        case.theory.methods.tell(number / len(families), f"{len(trials)} faults tried")

    for number, (words, family) in enumerate(families):
        best = min((trial.score for trial in trials), default=math.inf)
        if family is not faults.signs_and_units and best <= (1.0 - EXACT) * rows.start:
            break
        if len(rows.solved) > MOST_SOLVED:
            skipped.append(words)
            continue
        for hypothesis in family(rows):
            trials.append(rows.tried(hypothesis))
            tell(number)
    if not any(trial.enough for trial in trials):
        remote = []
        for each, x in ((trial.hypothesis, x) for trial in trials for x in trial.hypothesis.remote):
            if len(rows.solved) <= MOST_SOLVED:
                remote.append(rows.rated(each, each.make(x), x))
        for found in sorted(remote, key=lambda trial: trial.score)[:REFINED]:
            trials.append(rows.tried(found.hypothesis, [found.value]))
    return _ranked(rows, trials), skipped


def _ranked(rows: Bench, trials: Sequence[Trial]) -> list[Explanation]:
    """Return the explanations, the best first; a fitted one that changes nothing explains nothing."""

    def unlikely(trial: Trial) -> float:
        cut_off = trial.enough and trial.hypothesis.name == faults.CUT_OFF
        if cut_off and (pair := trial.hypothesis.pair(0.0)) and rows.allows(pair):
            return 0.0  # a difference within the resolution proves no other fault
        far = abs(trial.value) if trial.hypothesis.powers else 0.0
        left = trial.score * (1.0 + max(far, FLEXIBLE * bool(trial.hypothesis.starts)))
        return max(left, after) if trial.hypothesis.last else left

    others = (unlikely(each) for each in trials if each.enough and not each.hypothesis.last)
    after = min(others, default=0.0)
    trials = sorted(trials, key=lambda trial: trial.hypothesis.last)  # that of others goes first
    ordered, found = sorted(trials, key=unlikely), dict[str, Explanation]()
    least = min((rows.quiet, rows.start, *(trial.score for trial in trials)))
    whole = math.sqrt(rows.start**2 - least**2)

    def part(left: float) -> float:
        """Return the part of the difference, beyond noise, that is explained where a score is left."""
        return 1.0 - math.sqrt(max(left**2 - least**2, 0.0)) / whole if whole else 0.0

    best = next((trial for trial in ordered if trial.hypothesis.powers), None)
    for trial in ordered:
        fault, score, enough, x = trial
        explained, rank = part(score), part(unlikely(trial))
        alike = rows.indistinguishable(best, ordered) if trial is best and enough else ()
        found.setdefault(fault.name, Explanation(
            fault.name, fault.words(x), rank, enough and max(rank, explained) >= NAMED, fault.number(x),
            explained, alike,
        ))  # fmt: skip
    return [each for each in found.values() if each.rank > 0.0]


def _words(failed: Sequence[Check], named: Sequence[Explanation], small: bool) -> str:
    """Say what explains the disagreement, what else would, and which checks failed.

    A `small` difference is within the allowance of each row: how well a fault fits rows tells nothing then.
    """
    which = "; ".join(f"{check.name} ({check.equation})" for check in failed)
    if small and not (len(named) == 1 and named[0].enough):
        text = "Each row is within its allowance, and too little is off to name one fault"
        if named:
            how = (
                "Each of these would explain it"
                if named[0].enough
                else "Not proved, but fits better"
            )
            text += f". {how}: {'; '.join(each.text for each in named[:SHOWN])}"
        if (hidden := len(named) - SHOWN) > 0:
            text += f"; and {hidden} other{'s' * (hidden > 1)}"
        return f"{text}. Failed: {which}."
    if not named:
        return f"No single known fault explains most of the difference. Failed: {which}."
    first, *rest = named
    symbol, text = first.name.removeprefix(WRONG), _sentence(first.text)
    alike = {WRONG + name for name in first.alike} | {*first.alike}
    possible = [each for each in rest if each.enough and each.name not in alike]
    tied = [each.text for each in possible if first.enough and each.rank > first.rank - TIED]
    others = [each.text for each in possible if each.text not in tied]
    if tied:
        text = f"{'; or '.join([text, *tied])}: these data do not tell which"
    also = f" Also possible: {'; '.join(others)}." if others else ""
    if not first.enough:
        part = "" if first.explained is None else f", {first.explained:.0%} of the difference"
        text = f"Closest, but not all{part}: {first.text}"
    if first.alike:
        more = " or others" if len(first.alike) > SHOWN else ""
        together = f"{symbol} and {' or '.join(first.alike[:SHOWN])}{more}"
        also = f" {together} cannot be told apart by these data.{also}"
    return f"{text}.{also} Failed: {which}."


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]
