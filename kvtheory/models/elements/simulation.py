"""A run: its time steps, its instants, its results and their error."""

import itertools
import math
from collections.abc import Callable, Collection, Sequence
from operator import itemgetter
from time import thread_time
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.elements import kernels, stability
from kvtheory.models.elements.kernels import REPORT, Instants
from kvtheory.models.elements.model import Model, contact
from kvtheory.models.elements.row import KEPT_DEPTH, ElementRow, course_of
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Scheme
from kvtheory.progress import Progress, silent
from kvtheory.records import readable, structured, value
from kvtheory.results import (
    SERIES_UNITS,
    TRANSIENT_UNITS,
    Certificate,
    Simulation,
    SprungSimulation,
    units_for,
)
from kvtheory.results.cycles import States, cycle, note, ripple, sampled
from kvtheory.results.errors import AT_REST
from kvtheory.results.table import scales
from kvtheory.results.transient import STOPPED
from kvtheory.scene.base_motion import POWERS, BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.theory.laws import Array

ELEMENTS_PER_STEP = 2.0
"""Elements that pass in a step, as in the paper: dt = 2 dx/V."""
PER_RELAXATION = 100.0
"""Steps in a retardation time, at least: the force is a mean over the step weighted by e^(t/τ)."""
PER_OSCILLATION = 20.0
"""Steps in a period of the mass on the contact at rest, at least."""
ROUGHLY = 0.9
"""The iteration for a period ends when the new period is at least this share of the previous one."""
PER_STOPPING = 4.0
"""Fewest steps, after a jump of the drive, in the time in which dampers stop the mass; later the steps grow
with the time since the jump, up to the step of the run."""
FINER = 1.0 / 16.0
"""Steps in that time for each element in half a contact, if these are more: more elements are more accurate
there, too."""
JUMP = 1e-6
"""Share of the highest speed: a smaller jump of the drive is rounding between pieces of a function."""
MOST_STEPS = 20_000
"""Most steps of a run for these two: where the foundation or the spring is far faster than the run lasts,
it is resolved no further; the implicit schemes stay stable, and the certificate states the error."""
STABLE_SHARE = 0.5
"""Default step of an explicit scheme, as a share of the largest stable step."""
COARSE = 0.25
"""Work of a run with half as many elements and steps, for the error, as a share of the main run's."""
MOST_REPORTS = 20_000
"""Approximate upper bound on the instants from which it is found how a motion on a spring or a drop goes."""
ROWS = 400
"""Approximate upper bound on the instants reported if none are requested."""
MORE_ROOM = 16.0
"""Ratio of the depths for which elements are kept, from one attempt to the next."""
PAUSE = {True: 3e7, False: 1e5}
"""Elements times steps between two reports of progress, compiled and interpreted."""
MOST_OF_ALL = 2e9
"""Upper bound on elements in the contact at rest times steps: so many take seconds to hours."""
TOGETHER = 1e-6
"""Of the time step: instants that are no farther apart share a state. A step so short would change
it by less than a millionth of what one step does, and times that differ by rounding leave no step at all."""
DEEPEST = {False: 1e7, True: 256.0}
"""Times the static depth: no scene sinks deeper. Of a ball, elements grow as the depth, not as its root."""

SAFETY = 4.0
"""Factor on the estimated errors: a difference can be small by chance. With one coarse run a bound was
exceeded in one of a hundred random scenes, by any factor; two, whose elements are half a spacing apart,
are seldom both small by chance."""
KNOWN = 0.5
"""Uncertainty of an edge, in elements, after a change of the drive, if a damper leaves pressure on it."""
KINKED = 0.05
"""Uncertainty of an edge, in elements, under a shape with kinks, whose overlap is straight anywhere, and on
arms, where pressure is extrapolated to it; and of the forces, in elements at the peak pressure, where arms
remember a kink that moved by less than an element."""
WATCHED = 8
"""Earlier instants at which runs are also compared, for each that is reported. An error swings with the
masses, and a difference vanishes twice in a swing, at times for both coarse runs at once: compared at one
instant alone, one in a thousand was off by more than claimed, on springs in two scenes of five."""
RECENT = 0.5
"""Share of the time since the last jump of the drive over which these instants lie."""
ROUNDING = 1e-12
"""Least error, due to rounding, where a method is exact."""
SHIFTS = (0.0, 0.5)
"""Offsets of the elements of the coarse runs, in spacings."""
RELATIVE_TO = (
    "of the scene at rest: depth relative to δ_0, its rate to δ_0/τ, edges to a_0, normal force to W_0, "
    "friction force to W_0 δ_0/a_0, pressure to K δ_0"
)
ON_SPRING = ", sliding velocity to a_0/τ, spring force as friction"
UNKNOWN = Certificate("none", "no error was estimated, since certify=False", {}, AT_REST)

Rows = dict[str, Any]
"""The columns of reports by name, see `kernels.REPORT`."""


class Unsure(NamedTuple):
    """Uncertainty of an edge, in elements."""

    at_jumps: float  # where a damper leaves pressure on it after a change of the drive
    anywhere: float


class Timetable(NamedTuple):
    """When steps are taken, and what is reported."""

    times: Array  # before the first step and after each
    steps: Array  # lengths
    instants: Instants


def simulate(
    scene: Scene, spacing: float, scheme: Scheme, *,
    at: Sequence[float] | None, time_step: float | None, certify: bool,
    progress: Progress | None = None, warn: Callable[[str], None] | None = None,
) -> Simulation:  # fmt: skip
    """Return the time series of a scene by elements at this spacing (m), or raise with the reason."""
    model = Model.of(scene, spacing, parts=scheme.row.parts_of_elements)
    path = model.path(scene)
    h = time_step or _default_step(model, path, scheme)
    wanted = _instants(scene, path, h) if at is None else list(at)
    elements = model.contact.extent / (model.constants.spacing * (model.constants.across or 1.0))
    updates = elements * max(wanted) / h
    if updates > MOST_OF_ALL:
        raise ValueError(
            f"`time_step` = {h:.6g} s: {updates / elements:,.3g} steps with {elements:,.3g} elements in the "
            f"contact are {updates:.2g} updates, expected at most {MOST_OF_ALL:g}; take longer steps, fewer "
            "elements (`per_length`), or a shorter run"
        )
    own_step = time_step is None and not scheme.tableau
    graded = _graded(model, path, h, max(wanted)) if own_step else {}
    jumps = set(_jumps(model, path, max(wanted))) if own_step and at is not None else set[float]()
    fine = _timetable(path, wanted, h, graded, jumps)
    if certify:
        fine = _watched(model, path, fine)
    times, steps, instants = fine
    asked = np.searchsorted(instants.time, wanted)
    h = float(steps.max(initial=0.0)) or h
    warning = stability.step_warning(scheme, model, path, h)
    if warning and warn is not None:
        warn(warning)
    best, halved = SCHEMES[DEFAULT], instants._replace(after=instants.after // 2)
    half = Timetable(times[::2], 2.0 * steps[::2], halved)
    marked = model.start.gap is not None or scene.drive.coasts
    swings = model.sprung and not scene.drive.coasts and steps.size > 0
    runs = [(model, scheme, fine, 1.0)]
    if certify:
        for shift in SHIFTS:
            coarse = Model.of(scene, spacing, parts=True, shift=shift, coarser=2.0)
            runs.append((coarse, best, half, COARSE))
        if scheme is not best:
            runs.append((Model.of(scene, spacing, parts=True), best, fine, 1.0))
    ends = np.cumsum([0.0, *(share for *_, share in runs)])

    def part(k: int) -> Progress:
        """Return the progress of one of several runs by its share of the work; the later ones are checks."""
        begun, end = ends[k : k + 2] / ends[-1]
        show, purpose = progress or silent, " for the error" * (k > 0)
        return lambda share, done: show(float(begun + (end - begun) * share), done + purpose)

    found = []
    for k, (one, by, table, _) in enumerate(runs):
        dense = _everywhere(path, table) if swings or (marked and k == 0) else table
        kept = np.isin(dense.instants.after, table.instants.after)
        found.append((*_run(one, path, by, dense, wanted, part(k)), kept))
    (whole, row, _), *_ = found
    marks = _landmarks(model, path, whole) if marked else {}
    marks |= _ending(model, [each for each, *_ in found]) if swings else {}
    rows, *others = (
        {name: column[kept] for name, column in each.items()} for each, _, kept in found
    )
    unsure = _unsure(model, path, h)
    certificate = _estimate(model, unsure, rows, others)
    kind, names = (
        (Simulation, TRANSIENT_UNITS) if not model.sprung else (SprungSimulation, SERIES_UNITS)
    )
    return kind(
        **{name: rows[name][asked] for name in names}, scheme=scheme.row.name, per_length=1.0 / spacing,
        time_step=h, steps=len(steps),
        element_updates=int(value(row.stored.counts, "updates")), warning=warning, model="elements",
        certificate=certificate, compiled=row.compiled, units=units_for(scene.indenter, names), **marks,
    )  # fmt: skip


def _default_step(model: Model, path: BaseMotion, scheme: Scheme) -> float:
    """Return the time step of a scheme where none is given, in s."""
    c, law, fastest = model.constants, model.constants.law, model.fastest(path)
    sinks = max((abs(rate) for _, rate in path.depths), default=0.0)
    fastest += sinks * c.half_length / c.depth
    passing = ELEMENTS_PER_STEP * c.spacing / fastest if fastest else math.inf
    if scheme.row.papers_step:
        if math.isinf(passing):
            raise ValueError(
                "the paper's time step 2 dx/V is infinite for a drive at rest: give a `time_step`, "
                f'such as "{0.01 * law.retardation_time * 1e3:.4g} ms", or `scheme` = "{DEFAULT}"'
            )
        return passing
    # That of the mass on the contact at rest, or after an impact, as stiff as arms are within such a period.
    shorter, extent = math.inf, model.contact.extent
    if not model.start.at_rest:
        extent = contact(c, model.impact(path)[1]).extent
    while True:
        period, within = shorter, shorter / (2.0 * math.pi)
        stiffness = extent * law.stiffness_within(within) + c.spring
        shorter = 2.0 * math.pi * math.sqrt(c.mass / stiffness)
        if not shorter < ROUGHLY * period:
            break
    # Along x, the dampers of the contact at rest may suppress the oscillation.
    if model.sprung:
        resistance = c.damping_along + law.damping * model.contact.tilt
        if resistance * resistance < 4.0 * c.spring_along * c.mass_along:
            shorter = min(shorter, 2.0 * math.pi * math.sqrt(c.mass_along / c.spring_along))
    resolved = min(law.retardation_time / PER_RELAXATION, shorter / PER_OSCILLATION)
    step = min(passing, max(resolved, path.end / MOST_STEPS))
    if not scheme.tableau:
        return step
    return min(
        step, STABLE_SHARE * stability.limit_at(scheme, c, max(stability.lengths(model, path)))
    )


def _graded(model: Model, path: BaseMotion, h: float, end: float) -> dict[float, float]:
    """Return times after jumps and a landing, from which steps are shorter, as dampers stop M in M/(C L)."""
    c = model.constants
    resistance = c.law.damping * model.contact.extent
    if not resistance or math.isinf(c.mass):
        return {}
    stopping, steps = c.mass / resistance, max(PER_STOPPING, FINER * c.half_length / c.spacing)
    count, found = math.ceil(math.log2(max(steps * h / stopping, 1.0))), {}
    for jump, after in itertools.pairwise([*_jumps(model, path, end), end]):
        for k in range(count + 1 if count else 0):
            start = jump + stopping * (2.0**k - 1.0)
            if start < after:
                found[start] = h if k == count else min(h, stopping * 2.0**k / steps)
    return found


def _jumps(model: Model, path: BaseMotion, end: float) -> list[float]:
    """Return the times before the end at which a velocity jumps, or the indenter first lands; one is 0."""
    least, landing = JUMP * path.highest_speed, model.landing(path)
    jumps = [t for t in path.changes
             if abs(path.velocity(t) - path.velocity(t, before=True)) > least]  # fmt: skip
    rates = [rate for _, rate in path.depths]
    turns = [t for t, a, b in zip(path.starts[1:], rates, rates[1:], strict=False) if a != b]
    return sorted({0.0, *(t for t in (*jumps, *turns, landing) if 0.0 < t < end)})


def _instants(scene: Scene, path: BaseMotion, h: float) -> list[float]:
    """Return regular instants, which are ends of steps, for each piece of the drive."""
    end = scene.run.duration
    stride = h * 2.0 * math.ceil(end / h / ROWS / 2.0)
    found = [
        start + k * stride
        for start, stop in itertools.pairwise([*(t for t in path.changes if t < end), end])
        for k in range(math.ceil((stop - start) / stride * (1.0 - 1e-9)))
    ]
    return [*found, end]


def _timetable(
    path: BaseMotion, wanted: list[float], h: float, graded: dict[float, float],
    jumps: Collection[float] = (),
) -> Timetable:  # fmt: skip
    """Return steps of at most h, or of the graded lengths, that end on the wanted instants.

    From a jump to an instant they are so many that runs can be compared in between.
    """
    asked, end = set(wanted), max(wanted)
    times, lengths, instants = [0.0], list[float](), list[Any]()
    start, step = 0.0, graded.get(0.0, h)
    for stop in sorted({0.0, *asked, *graded, *(t for t in path.changes if t < end)}):
        if stop - start > TOGETHER * step:
            # An even number of steps, so that half as many fit too.
            fewest = 2 * WATCHED if start in jumps and stop in asked else 2
            count = max(2 * math.ceil(0.5 * (stop - start) / step * (1.0 - 1e-9)), fewest)
            lengths += [(stop - start) / count] * count
            times += [start + (stop - start) * k / count for k in range(1, count)] + [stop]
            start = stop
        elif stop in path.changes:
            times[-1] = start = stop
        if stop in asked:
            Y = path.displacement(times[-1])
            instants.append((len(lengths), stop, path.velocity(stop), path.forward(stop), Y))
        step = graded.get(stop, step)
    return Timetable(np.array(times), np.array(lengths), _instants_of(instants))


def _instants_of(rows: list[Any]) -> Instants:
    """Return instants from a row of values for each."""
    after, *columns = zip(*rows, strict=True)
    return Instants(np.array(after), *np.array(columns, dtype=float))


def _watched(model: Model, path: BaseMotion, table: Timetable) -> Timetable:
    """Return steps with earlier instants added, ends of steps of all runs, unless others are as near."""
    times, lengths, asked = table
    after, instants = asked.after, asked.time
    jumps = np.array(_jumps(model, path, math.inf))
    since = instants - jumps[np.maximum(np.searchsorted(jumps, instants) - 1, 0)]
    stride = RECENT / WATCHED * since
    earlier = instants - np.outer(np.arange(1.0, WATCHED + 1.0), stride)
    bounded = np.concatenate([[-math.inf], instants, [math.inf]])
    k = np.searchsorted(bounded, earlier)
    lonely = np.minimum(earlier - bounded[k - 1], bounded[k] - earlier) > 0.5 * stride
    numbers = np.interp(earlier[lonely], times, np.arange(times.size))
    more = np.setdiff1d(2 * np.rint(0.5 * numbers).astype(np.int64), after)
    rows = list(zip(*asked, strict=True))
    for n, t in zip(more.tolist(), times[more].tolist(), strict=True):
        rows.append((n, t, path.velocity(t), path.forward(t), path.displacement(t)))
    return Timetable(times, lengths, _instants_of(sorted(rows, key=itemgetter(0))))


def _everywhere(path: BaseMotion, table: Timetable) -> Timetable:
    """Return steps with every second one reported, too, in a very long run fewer."""
    times, lengths, asked = table
    stride = 2 * math.ceil(0.5 * times.size / MOST_REPORTS)
    more = np.setdiff1d(np.arange(0, times.size, stride), asked.after)
    rows = list(zip(*asked, strict=True))
    for n, t in zip(more.tolist(), times[more].tolist(), strict=True):
        rows.append((n, t, path.velocity(t), path.forward(t), path.displacement(t)))
    return Timetable(times, lengths, _instants_of(sorted(rows, key=itemgetter(0))))


def _landmarks(model: Model, path: BaseMotion, rows: Rows) -> dict[str, Any]:
    """Return restitution and contact time of a drop, or where and when a coasting indenter stops.

    The first landing is known. The take-off is between two rows, and the velocity hardly changes there.
    """
    time, flies, found = rows["time"], np.isnan(rows["leading_edge"]), dict[str, Any]()
    landing = model.landing(path)
    up = np.flatnonzero(flies & (time > landing) & (np.cumsum(~flies & (time > landing)) > 0))
    if model.start.gap is not None and up.size:
        down = model.start.landing_speed(model.constants, model.constants.depth)
        found["restitution"] = float(-rows["depth_rate"][up[0]] / down)
        found["contact_time"] = float(0.5 * (time[up[0] - 1] + time[up[0]]) - landing)
    slides = rows["sliding_velocity"]
    late = np.flatnonzero(np.abs(slides) > STOPPED * abs(slides[0]))
    if model.sprung and not model.constants.spring_along and late.size and late[-1] + 1 < time.size:
        last = slice(late[-1], late[-1] + 2)
        share = np.interp(STOPPED * abs(slides[0]), np.abs(slides[last])[::-1], [1.0, 0.0])
        way = np.append(0.0, np.cumsum(0.5 * (slides[1:] + slides[:-1]) * np.diff(time)))
        found["stopping_time"] = float(np.interp(share, [0.0, 1.0], time[last]))
        found["stopping_distance"] = abs(float(np.interp(share, [0.0, 1.0], way[last])))
    return found


def _ending(model: Model, runs: list[Rows]) -> dict[str, Any]:
    """Return the cycle in which the first run ends, compared with the others, and a note if it goes on."""
    c, motions = model.constants, list[States]()
    for rows in runs:
        rate = rows["velocity"] - rows["sliding_velocity"]
        x = (rows["spring_force"] - c.damping_along * rate) / c.spring_along
        series = {name: rows[name] for name in ("sliding_velocity", "friction_force", "depth")}
        motions.append(sampled(rows["time"], x, rate, **series))
    cycles = [cycle(rows["time"], states) for rows, states in zip(runs, motions, strict=True)]
    said = note(runs[0]["time"], motions[0])
    ripples = [ripple(rows["time"], states) for rows, states in zip(runs, motions, strict=True)]
    return {
        "ripples": () if any(each is None for each in ripples) else tuple(ripples),
        "cycle": cycles[0].beside(cycles[1:], SAFETY),
        "notes": (said,) if said else (),
    }


def _run(
    model: Model, path: BaseMotion, scheme: Scheme, table: Timetable, wanted: list[float],
    progress: Progress,
) -> tuple[Rows, ElementRow]:  # fmt: skip
    """Take all steps and report at the instants; if the indenter sinks deep, store more elements.

    Should it fail, the error tells what was reported at the wanted instants.
    """
    times, steps, instants = table
    c, h, kept = model.constants, float(steps.max(initial=0.0)), KEPT_DEPTH
    deepest = DEEPEST[c.surface.ball]
    while True:
        row = ElementRow(c, path, scheme, kept, model.begun(path))
        limits = stability.limits(model, path)
        course = course_of(path, c.law, *table, _unsure(model, path, h).at_jumps, limits)
        found = row.reports(instants.time.size)
        status, done, reported, until, begun = kernels.DONE, 0, 0, -1, thread_time()
        while status == kernels.DONE and until < len(steps):
            left = (thread_time() - begun) * (len(steps) / max(done, 1) - 1.0)
            row.compile(course, left)
            found = structured(found, REPORT) if row.compiled else found
            pause = max(1, int(PAUSE[row.compiled] / (1.0 + row.stored.elements.u.size)))
            until = min(done + pause, len(steps))
            status, done, reported = row.run(course, found, (done, reported), until)
            if done:
                progress(done / len(steps), f"{done:,} of {len(steps):,} steps")
        if status == kernels.DONE:
            columns = structured(found, REPORT)
            return {name: columns[name] for name in REPORT.names or ()}, row
        kept *= MORE_ROOM
        if status != kernels.OUTGROWN or kept > deepest:
            error = stability.divergence(
                status, scheme, model, path, h, times[done], readable(row.stored.now), deepest
            )  # fmt: skip
            asked = np.isin(instants.time[:reported], wanted)
            columns = structured(found, REPORT)[:reported][asked]
            error.rows = tuple(columns[list(TRANSIENT_UNITS)].tolist())
            raise error


def _unsure(model: Model, path: BaseMotion, h: float) -> Unsure:
    """Return how unsure edges are with steps of at most h."""
    c = model.constants
    known = KNOWN if c.law.damping > 0.0 or (c.law.arm_time < h).any() else 0.0
    changes = len(path.pieces) > 1 or any(path.pieces[0][POWERS + 1 :])
    jump = known if changes or path.depths or not model.start.at_rest else 0.0
    return Unsure(jump, known if math.isfinite(c.mass_along) else jump)


def _estimate(model: Model, unsure: Unsure, rows: Rows, others: list[Rows]) -> Certificate:
    """Estimate the error from runs of the best scheme: two coarse ones, and one as fine for other schemes.

    All are compared at the reported instants, and shortly before each.

    Let the error of this run be e and that of the best scheme at this density c, at half of it 4 c: the
    sum of both differences, |e - 4 c| + |e - c|, is at least 3/4 |e|. For the best scheme it is 3 |e|.
    """
    if not others:
        return UNKNOWN
    c, scale, differences = model.constants, scales(model.at_rest), dict[str, float]()
    for name in scale:
        apart = [float(np.nanmax(abs(rows[name] - other[name]), initial=0.0)) for other in others]
        differences[name] = max(apart[: len(SHIFTS)]) + sum(apart[len(SHIFTS) :])
    kinks, arms = bool(c.kinks.size), bool(c.law.arm_time.size)
    edge = (unsure.anywhere + KINKED * (kinks or arms)) * c.spacing
    width = 2.0 * c.surface.stretch * c.half_length if c.surface.ball else 1.0
    one, sawtooth = (
        c.spacing * width * float(rows[name].max()) for name in ("peak_pressure", "at_edge")
    )
    # The sawtooth of an element that enters is at most that high, and no estimate.
    force = unsure.at_jumps / SAFETY * sawtooth + KINKED * (kinks and arms) * one
    # An edge may have passed less than an element since the pressure at it had a kink: no run sees that.
    force += float(rows["unloaded"].max()) / SAFETY
    for name, more in {
        "leading_edge": edge, "trailing_edge": edge, "normal_force": force,
        "friction_force": force * model.steepest, "peak_pressure": float(rows["doubt"].max()),
    }.items():  # fmt: skip
        differences[name] += more
    if model.sprung:  # where sliding may go either way, so may the edge that leads
        speed = rows["sliding_velocity"]
        apart = np.max([abs(speed - other["sliding_velocity"]) for other in others], axis=0)
        either = (speed != 0.0) & (abs(speed) <= SAFETY * apart)
        swapped = abs(rows["leading_edge"] - rows["trailing_edge"])[either] / SAFETY
        for name in ("leading_edge", "trailing_edge"):
            differences[name] += float(np.nanmax(swapped, initial=0.0))
    runs = "half as many elements and steps" + ", and as many" * (len(others) > len(SHIFTS))
    return Certificate(
        "estimated",
        f'{SAFETY:g} times the largest difference, there and shortly before, to the scheme "{DEFAULT}" with '
        f"{runs}, {RELATIVE_TO}" + ON_SPRING * model.sprung,
        {name: max(SAFETY * d / scale[name], ROUNDING) for name, d in differences.items()},
        AT_REST,
    )
