"""The checks: each compares one number with what theory allows for it.

`CHECKS` lists them in the order in which they are shown. A check that cannot be made says why.
"""

from collections.abc import Callable, Iterator

import numpy as np

from kvtheory.checks.balance import missing_force, random_part, windows
from kvtheory.checks.comparison_case import Case, Measured, NotMade, check, made, rms
from kvtheory.checks.discretization import elements, sawtooth, stability
from kvtheory.checks.noise import SURE, extreme
from kvtheory.checks.settling import fast_constant, phase, slow_constant, steady_limit
from kvtheory.results.comparison import Check

EQUATIONS = {"depth": "Eq. 17", "depth_rate": "Eq. 17", "normal_force": "Eq. 14",
             "friction_force": "Eq. 15", "leading_edge": "Eq. 32", "trailing_edge": "Eq. 33",
             "peak_pressure": "Eq. 12", "velocity": "the drive of the scene", "sliding_velocity": "F22",
             "spring_force": "F22"}  # fmt: skip
"""The equation behind each curve."""
RELATIVE = "relative to the static state"

TRANSIENT = 3.0
"""Slow time constants after the last change of the drive: three samples in them show the transient."""
SAMPLING = "sampling"
"""The check whose failure alone says nothing against the data."""


@check("initial rest state", "Eq. 40", "depth, relative to the static depth")
def initial_rest(case: Case) -> Measured:
    """Compare the depth at t <= 0 with the static depth."""
    time, depth_0 = case.series.time, case.theory.static.depth
    (depth,) = case.columns("depth")
    before = time <= 0.0
    if not before.any():
        raise NotMade(f"the data begin at {time[0] * 1e3:.4g} ms, after the start")
    off = abs(float(depth[before].mean()) / depth_0 - 1.0)
    sigma = float(case.allowance.noise["depth"][before].max()) / depth_0
    random = SURE * sigma / np.sqrt(before.sum())
    return off, case.tolerance * random + case.limit("depth")[before].max(), ""


@check("jump at t = 0+", "F11", f"distance from theory, {RELATIVE}")
def jump(case: Case) -> Measured:
    """Compare the force right after the start with the jump that theory gives."""
    time, theory = case.series.time, case.theory
    force = next((n for n in ("normal_force", "friction_force") if n in case.names), None)
    if 0.0 not in theory.scene.drive.jumps:
        raise NotMade("the drive does not jump at t = 0")
    if force is None:
        raise NotMade("the data hold no force")
    fast = np.inf if theory.rates is None else abs(theory.rates.fast)
    first, after = (int(np.searchsorted(time, 0.0, side=side)) for side in ("left", "right"))
    if after == time.size or time[after] > fast:
        raise NotMade(
            f"no sample within the fast time constant, {fast * 1e3:.3g} ms, after the start"
        )
    excess, limit = case.excess(force), case.limit(force)
    k = max((first, after), key=lambda row: excess[row] / limit[row])
    return excess[k], limit[k], f"{force} at {time[k] * 1e3:.4g} ms"


@check(
    SAMPLING,
    lambda case: "F12" if case.theory.scene.drive.rigid else "F22",
    "s, mean distance of samples",
)
def sampling(case: Case) -> Measured:
    """Compare the mean distance of the samples during the transient with the slow time constant."""
    rates, time = case.theory.rates, case.series.time
    if rates is None:
        raise NotMade("a fixed indenter has no transient of its own")
    changed = case.theory.last_change
    slow, start = abs(rates.slow), changed if changed < time[-1] else 0.0
    window = min(TRANSIENT * slow, time[-1] - start)
    inside = int(np.count_nonzero((time > start) & (time <= start + window)))
    note = f"{inside} samples within {TRANSIENT:g} slow time constants"
    return window / max(inside, 1), case.tolerance * slow, note


@check("impulse balance", "Eq. 17", "mean force that is missing, relative to the load")
def balance(case: Case) -> Measured:
    """Compare M z'' with F_z - W, of the data alone, over windows."""
    columns, now = case.series.columns, case.now
    support, static, allowed = case.theory.scene.support, case.theory.static, case.allowance
    if case.theory.scene.held:
        raise NotMade("the indenter is fixed")
    if "depth" not in columns or "normal_force" not in columns:
        raise NotMade("it needs the depth and the normal force")
    smear = np.nan_to_num(allowed.high["normal_force"] - allowed.low["normal_force"])
    smooth = np.nan_to_num(allowed.systematic["normal_force"]) + 0.5 * smear
    found = []
    for window in windows(case.series.time):
        part = slice(window.start, window.stop)
        lacks, sampled = (
            abs(missing_force(window, c, support, static.depth)) for c in (columns, now)
        )
        sigmas = allowed.noise["depth"][part], allowed.noise["normal_force"][part]
        random = random_part(window, *sigmas, support.mass)
        steady = float(
            np.abs(window.force) @ smooth[part]
            + support.mass * np.abs(window.inertia) @ allowed.rounding["depth"][part]
        )
        limit = case.tolerance * (
            2.0 * sampled + steady / window.impulse + extreme(case.series.time.size) * random
        )
        span = case.series.time[[window.start, window.stop - 1]] * 1e3
        found.append((lacks, limit, f"worst from {span[0]:.4g} to {span[1]:.4g} ms"))
    if not found:
        raise NotMade("too few samples for a window")
    lacks, limit, note = max(found, key=lambda each: each[0] / each[1])
    return lacks / static.load, limit / static.load, note


def curves(case: Case) -> Iterator[Check]:
    """Each curve against theory: the value that is worst for what is allowed, and all together."""
    for name in case.names:
        title, excess, limit = name.replace("_", " "), case.excess(name), case.limit(name)
        ratio = excess / limit
        k = int(np.argmax(ratio))
        wrong = np.flatnonzero(ratio > 1.0)
        time = case.series.time * 1e3
        note = f"worst at {time[k]:.4g} ms"
        if wrong.size:
            note += f", first disagreement at {time[wrong[0]]:.4g} ms"
        for kind, measured, allowed, words in (
            ("largest", excess[k], limit[k], note), ("RMS", rms(excess), case.rms_limit(name), "")
        ):  # fmt: skip
            yield made(f"{title}, {kind}", EQUATIONS[name], RELATIVE, measured, allowed, words)


CHECKS: tuple[Callable[[Case], Iterator[Check]], ...] = (
    sampling, initial_rest, jump, balance, curves, fast_constant, slow_constant, steady_limit, phase,
    sawtooth, elements, stability,
)  # fmt: skip
"""In the order in which they are shown."""


def judge(case: Case) -> tuple[Check, ...]:
    """Make every check; that of the phase of a cycle where the drive has a spring."""
    rigid = case.theory.scene.drive.rigid
    return tuple(c for make in CHECKS if make is not phase or not rigid for c in make(case))
