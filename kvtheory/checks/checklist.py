"""The checks: each compares one number with what theory allows for it.

`CHECKS` lists them in the order in which they are shown. A check that cannot be made says why.
"""

from collections.abc import Callable, Iterator

import numpy as np

from kvtheory.checks.balance import missing_force, random_part, windows
from kvtheory.checks.comparison_case import Case, not_made, rms
from kvtheory.checks.discretization import elements, sawtooth, stability
from kvtheory.checks.noise import SURE, extreme
from kvtheory.checks.settling import fast_constant, phase, slow_constant, steady_limit
from kvtheory.results.comparison import Check
from kvtheory.results.table import SHOWN_UNITS

STATES = {"depth": "Eq. 17", "depth_rate": "Eq. 17", "normal_force": "Eq. 14", "friction_force": "Eq. 15",
          "leading_edge": "Eq. 32", "trailing_edge": "Eq. 33", "peak_pressure": "Eq. 12",
          "velocity": "the drive of the scene", "sliding_velocity": "F22", "spring_force": "F22"}  # fmt: skip
"""The equation behind each curve."""

TRANSIENT = 3.0
"""Slow time constants after the last change of the drive: three samples in them show the transient."""
SAMPLING = "sampling"
"""The check whose failure alone says nothing against the data."""


def initial_rest(case: Case) -> Iterator[Check]:
    """Depth at t <= 0 against the static depth."""
    name, equation = "initial rest state", "Eq. 40"
    time, columns, theory = case.series.time, case.series.columns, case.theory
    before = time <= 0.0
    if "depth" not in columns:
        yield not_made(name, equation, "the data hold no depth")
        return
    if not before.any():
        yield not_made(name, equation, f"the data begin at {time[0] * 1e3:.4g} ms, after the start")
        return
    static = theory.static
    off = abs(float(columns["depth"][before].mean()) / static.depth - 1.0)
    sigma = float(case.allowance.noise["depth"][before].max()) / static.depth
    random = SURE * sigma / np.sqrt(before.sum())
    allowed = case.tolerance * random + case.most("depth")[before].max()
    yield case.check(name, off, allowed, equation, "depth, relative to the static depth")


def jump(case: Case) -> Iterator[Check]:
    """Compare the force right after the start with the jump that theory gives."""
    name, equation = "jump at t = 0+", "F11"
    time, theory = case.series.time, case.theory
    force = next((n for n in ("normal_force", "friction_force") if n in case.series.columns), None)
    if 0.0 not in theory.scene.drive.jumps:
        yield not_made(name, equation, "the drive does not jump at t = 0")
        return
    if force is None:
        yield not_made(name, equation, "the data hold no force")
        return
    fast = np.inf if theory.rates is None else abs(theory.rates.fast)
    first, after = (int(np.searchsorted(time, 0.0, side=side)) for side in ("left", "right"))
    if after == time.size or time[after] > fast:
        why = f"no sample within the fast time constant, {fast * 1e3:.3g} ms, after the start"
        yield not_made(name, equation, why)
        return
    excess, most = case.excess(force), case.most(force)
    k = max((first, after), key=lambda row: excess[row] / most[row])
    note = f"{force} at {time[k] * 1e3:.4g} ms"
    shown, factor = SHOWN_UNITS[theory.units[force]]
    unit = f"distance from theory, relative to {factor * theory.scales[force]:.4g} {shown}"
    yield case.check(name, excess[k], most[k], equation, unit, note)


def sampling(case: Case) -> Iterator[Check]:
    """Compare the mean distance of the samples during the transient with the slow time constant."""
    rates, time = case.theory.rates, case.series.time
    name, equation = SAMPLING, "F12" if case.theory.scene.drive.rigid else "F22"
    if rates is None:
        yield not_made(name, equation, "a fixed indenter has no transient of its own")
        return
    changed = case.theory.last_change
    slow, start = abs(rates.slow), changed if changed < time[-1] else 0.0
    window = min(TRANSIENT * slow, time[-1] - start)
    inside = np.count_nonzero((time > start) & (time <= start + window))
    distance = window / max(int(inside), 1)
    yield case.check(name, distance, case.tolerance * slow, equation, "s, mean distance of samples",
                f"{inside} samples within {TRANSIENT:g} slow time constants")  # fmt: skip


def balance(case: Case) -> Iterator[Check]:
    """M z'' against F_z - W, of the data alone, over windows."""
    name, equation, columns = "impulse balance", "Eq. 17", case.series.columns
    support, static = case.theory.scene.support, case.theory.static
    if case.theory.scene.held:
        yield not_made(name, equation, "the indenter is fixed")
        return
    if "depth" not in columns or "normal_force" not in columns:
        yield not_made(name, equation, "it needs the depth and the normal force")
        return
    depth_0, sigma, digits = static.depth, case.allowance.noise, case.allowance.rounding["depth"]
    smear = np.nan_to_num(case.allowance.high["normal_force"] - case.allowance.low["normal_force"])
    found = []
    for window in windows(case.series.time):
        part = slice(window.start, window.stop)
        lacks = abs(missing_force(window, columns, support, depth_0))
        sampled = abs(missing_force(window, case.now, support, depth_0))
        random = random_part(
            window, sigma["depth"][part], sigma["normal_force"][part], support.mass
        )
        smooth = float(
            np.abs(window.force)
            @ (np.nan_to_num(case.allowance.systematic["normal_force"][part]) + 0.5 * smear[part])
            + support.mass * np.abs(window.inertia) @ digits[part]
        )
        allowed = case.tolerance * (
            2.0 * sampled + smooth / window.impulse + extreme(case.series.time.size) * random
        )
        span = case.series.time[[window.start, window.stop - 1]] * 1e3
        found.append((lacks, allowed, f"worst from {span[0]:.4g} to {span[1]:.4g} ms"))
    if not found:
        yield not_made(name, equation, "too few samples for a window")
        return
    W = static.load
    unit = "mean force that is lacking, relative to the load"
    lacks, allowed, note = max(found, key=lambda each: each[0] / each[1])
    yield case.check(name, lacks / W, allowed / W, equation, unit, note)


def curves(case: Case) -> Iterator[Check]:
    """Each curve against theory: the value that is worst for what is allowed, and all together."""
    for name in case.names:
        excess, most = case.excess(name), case.most(name)
        ratio = excess / most
        k = int(np.argmax(ratio))
        wrong = np.flatnonzero(ratio > 1.0)
        time = case.series.time * 1e3
        note = f"worst at {time[k]:.4g} ms"
        if wrong.size:
            note += f", first disagreement at {time[wrong[0]]:.4g} ms"
        unit = "relative to the static state"
        title = name.replace("_", " ")
        yield case.check(f"{title}, largest", excess[k], most[k], STATES[name], unit, note)
        yield case.check(f"{title}, RMS", rms(excess), case.together(name), STATES[name], unit)


CHECKS: tuple[Callable[[Case], Iterator[Check]], ...] = (
    sampling, initial_rest, jump, balance, curves, fast_constant, slow_constant, steady_limit, phase,
    sawtooth, elements, stability,
)  # fmt: skip
"""In the order in which they are shown."""


def judge(case: Case) -> tuple[Check, ...]:
    """Make every check."""
    return tuple(result for make in CHECKS for result in make(case))
