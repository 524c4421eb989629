"""A run: which step, which instants, what is reported, and how wrong it may be."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kvtheory.models.elements.contact import Contact, parts_of_elements, pressure, whole_elements
from kvtheory.models.elements.model import Array, Model, span
from kvtheory.models.elements.row import KEPT_DEPTH, OutgrownError, Row
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Motion, Scheme
from kvtheory.models.elements.stability import lengths, limit_at
from kvtheory.models.elements.watch import DivergenceError, Watch, doubts, stability_text
from kvtheory.results import TRANSIENT_UNITS, Certificate, Simulation
from kvtheory.results.table import scales
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.model import Scene

ELEMENTS_PER_STEP = 2.0
"""Elements that pass in a step, as in the paper: dt = 2 dx/V."""
PER_RELAXATION = 100.0
"""Steps in a retardation time, at least: the force is a mean over the step weighted by e^(t/τ)."""
PER_OSCILLATION = 20.0
"""Steps in a period of the mass on the contact at rest, at least."""
MOST_STEPS = 20_000
"""In a run, for the sake of these two: where the foundation or the spring is far faster than the run
lasts, no more is resolved than this; the implicit schemes stay stable, and the certificate tells."""
STABLE_SHARE = 0.5
"""Of the largest stable step, for an explicit scheme."""
PER_NOTICE = 500
"""Steps from one notice of the progress to the next: a few a second."""
ROWS = 400
"""Instants reported where none are asked for, at most about so many."""
SAFETY = 4.0
"""Of the estimated errors: one change of the density can be small by luck. Over the regimes of the
tests at 15 densities, from 13 to 130 elements in a half length, none of 1620 differences to theory was
larger than estimated; with 2 it was one in forty."""
KNOWN = 0.5
"""Of an element: how well an edge is known after a jump of the drive, which leaves pressure on it."""
MORE_ROOM = 16.0
"""Ratio of the depths for which elements are kept, from one attempt to the next."""
MOST_OF_ALL = 1e9
"""Steps: so many would take days."""
TOGETHER = 1e-6
"""Of the time step: instants that are no farther apart share a state. A step so short would change
it by less than a millionth of what one step does, and times that differ by rounding leave no step at all."""
DEEPEST = 1e7
"""Times the static depth: no scene sinks deeper."""

Rows = dict[str, Array]
Leg = tuple[float, float, int]
"""From one instant to another in so many steps."""
Progress = Callable[[int, int], None]
"""Called with the steps done and the steps in all."""


def simulate(
    scene: Scene,
    spacing: float,
    scheme: Scheme,
    *,
    at: Sequence[float] | None,
    time_step: float | None,
    certify: bool,
    progress: Progress | None = None,
    warn: Callable[[str], None] | None = None,
) -> Simulation:
    """Return the time series of a scene, with elements at this spacing (m).

    Raises
    ------
    ValueError
        If the spacing does not suit the contact, or the scheme has no step for this drive.
    DivergenceError
        If the run is unstable.
    """
    model = Model.of(scene, spacing)
    path = model.path(scene)
    h = time_step or default_step(model, path, scheme)
    stops, wanted = _instants(scene, path, h, at)
    if stops[-1] > MOST_OF_ALL * h:
        raise ValueError(
            f"`time_step` = {h:.6g} s: expected at least {stops[-1] / MOST_OF_ALL:.3g} s, so that at most "
            f"{MOST_OF_ALL:g} steps lead to t = {stops[-1]:.6g} s"
        )
    legs = _legs(stops, path.changes, h)
    h = max(((stop - start) / count for start, stop, count in legs if count), default=h)
    warning = doubts(scheme, model, path, h)
    if warning and warn is not None:
        warn(warning)
    rows, updates = _with_room(model, path, scheme, legs, wanted, progress)
    certificate = Certificate(
        "estimated", "not asked for", dict.fromkeys(TRANSIENT_UNITS, math.inf)
    )
    if certify:
        coarse = Model.of(scene, 2.0 * spacing)
        best, half = SCHEMES[DEFAULT], [(start, stop, count // 2) for start, stop, count in legs]
        others = [_with_room(coarse, path, best, half, wanted, None)[0]]
        if scheme is not best:
            others.append(_with_room(model, path, best, legs, wanted, None)[0])
        certificate = _certificate(model, path, rows, others)
    return Simulation(
        **rows, scheme=scheme.name, per_length=1.0 / spacing, time_step=h,
        steps=sum(count for _, _, count in legs), element_updates=updates, warning=warning,
        model="elements", certificate=certificate,
    )  # fmt: skip


def default_step(model: Model, path: BaseMotion, scheme: Scheme) -> float:
    """Return the time step of a scheme where none is given, in s.

    Raises
    ------
    ValueError
        If it is the paper's, 2 dx/V, and the base never moves.
    """
    passing = (
        ELEMENTS_PER_STEP * model.spacing / path.highest_speed if path.highest_speed else math.inf
    )
    if scheme.name == "paper":
        if math.isinf(passing):
            raise ValueError(
                "the paper's time step 2 dx/V is infinite for a drive at rest: give a `time_step`, "
                f'such as "{0.01 * model.retardation_time * 1e3:.4g} ms", or `scheme` = "{DEFAULT}"'
            )
        return passing
    stiffness = 2.0 * model.half_length * model.stiffness + model.spring
    period = 2.0 * math.pi * math.sqrt(model.mass / stiffness)
    resolved = min(model.retardation_time / PER_RELAXATION, period / PER_OSCILLATION)
    stable = limit_at(scheme, model, max(lengths(model, path)))
    return min(passing, max(resolved, path.end / MOST_STEPS), STABLE_SHARE * stable)


def _instants(
    scene: Scene, path: BaseMotion, h: float, at: Sequence[float] | None
) -> tuple[list[float], list[float]]:
    """Return the instants on which steps end, in order, and those that are reported, as asked for."""
    end = scene.run.duration if at is None else max(at)
    breaks = [t for t in path.changes if t < end]
    if at is not None:
        return sorted({*breaks, *at, 0.0}), list(at)
    stride = h * 2.0 * math.ceil(end / h / ROWS / 2.0)
    regular = [
        start + k * stride
        for start, stop in itertools.pairwise([*breaks, end])
        for k in range(math.ceil((stop - start) / stride * (1.0 - 1e-9)))
    ]
    return [*regular, end], [*regular, end]


def _with_room(
    model: Model, path: BaseMotion, scheme: Scheme, legs: list[Leg], wanted: list[float],
    progress: Progress | None,
) -> tuple[Rows, int]:  # fmt: skip
    """Run, and run again with more elements kept, should the indenter sink very deep."""
    kept = KEPT_DEPTH
    while True:
        try:
            row = Row(model, path, kept)
            return _run(row, scheme, legs, wanted, progress)
        except OutgrownError as outgrown:
            kept *= MORE_ROOM
            if kept > DEEPEST:
                h = max((stop - start) / max(count, 1) for start, stop, count in legs)
                error = DivergenceError(
                    f"the run diverged: the indenter sank to {DEEPEST:g} times its static depth; "
                    f"{stability_text(scheme, model, path, h)}"
                )
                error.rows = outgrown.rows
                raise error from None


@np.errstate(all="ignore")  # the watch judges what comes of it
def _run(
    row: Row, scheme: Scheme, legs: list[Leg], wanted: list[float], progress: Progress | None
) -> tuple[Rows, int]:
    watch, motion, done = Watch(row, scheme), Motion(0.0, row.model.depth, 0.0), 0
    total, asked = sum(count for _, _, count in legs), set(wanted)
    found: dict[float, tuple[float, ...]] = {}
    try:
        for start, stop, count in legs:
            for k in range(1, count + 1):
                time = stop if k == count else start + (stop - start) * k / count
                motion = replace(scheme.step(row.model, row, motion, time - motion.time), time=time)
                watch.see(motion, (stop - start) / count)
                done += 1
                if progress is not None and (done % PER_NOTICE == 0 or done == total):
                    progress(done, total)
            if not count and stop in row.path.changes:
                motion = replace(motion, time=stop)
            if stop in asked:
                found[stop] = _report(row, scheme, motion, stop)
    except (DivergenceError, OutgrownError) as error:
        error.rows = tuple(found.values())
        raise
    columns = np.array([found[time] for time in wanted]).T
    return dict(zip(TRANSIENT_UNITS, columns, strict=True)), row.updates


def _legs(stops: Sequence[float], breaks: Sequence[float], h: float) -> list[Leg]:
    """Return for each stop whence the run comes and in how many steps; in none if it is there already."""
    legs: list[Leg] = []
    start = 0.0
    for stop in stops:
        count = _count(stop - start, h) if stop - start > TOGETHER * h else 0
        legs.append((start, stop, count))
        if count or stop in breaks:
            start = stop
    return legs


def _count(length: float, h: float) -> int:
    """Return an even number of steps of at most h, so that half as many fit too."""
    return max(2 * math.ceil(0.5 * length / h * (1.0 - 1e-9)), 2)


def _report(row: Row, scheme: Scheme, at: Motion, time: float) -> tuple[float, ...]:
    """Return the columns at a time, for which the state `at` stands; where V jumps, just after it."""
    model, V = row.model, row.path.velocity(time)
    under = row.under(at.time, 0.0, max(at.depth, model.depth))
    p = pressure(model, under, at.depth, at.rate, V)
    pressed = under.touched & (p >= 0.0)
    V_before = row.path.velocity(at.time, before=True)
    p_before = p if V_before == V else pressure(model, under, at.depth, at.rate, V_before)
    contact: Contact = (
        parts_of_elements(model, under, p, p_before, pressed, at.depth)
        if scheme.edges
        else whole_elements(model, under, p, pressed)
    )
    edges = (contact.left, contact.right)
    leading, trailing = edges if row.path.forward(time) else edges[::-1]
    forces = contact.normal_force, contact.friction_force
    return time, V, at.depth, at.rate, *forces, leading, trailing, contact.peak_pressure


def _certificate(model: Model, path: BaseMotion, rows: Rows, others: Sequence[Rows]) -> Certificate:
    """Compare with other runs; where an edge exists in one of them only, it is not compared.

    Let the error of this run be e and that of the best scheme at this density c, at half of it 4 c: the
    sum of both differences, |e - 4 c| + |e - c|, is at least 3/4 |e|. For the best scheme it is 3 |e|.
    """
    scale = scales(model.at_rest)
    differences = {
        name: sum(
            float(np.nanmax(np.abs(rows[name] - other[name]), initial=0.0)) for other in others
        )
        for name in TRANSIENT_UNITS
    }
    if len(path.changes) > 1:
        known = KNOWN * model.spacing
        pressure_there = float(rows["peak_pressure"].max())
        differences["leading_edge"] += known
        differences["trailing_edge"] += known
        differences["normal_force"] += known * pressure_there
        differences["friction_force"] += known * pressure_there * _steepest(model)
    runs = "half as many elements and steps" + (", and as many" if len(others) > 1 else "")
    return Certificate(
        "estimated",
        f'{SAFETY:g} times the largest difference to the scheme "{DEFAULT}" with {runs}, relative to the '
        "static depth, half length and load",
        {name: SAFETY * difference / scale[name] for name, difference in differences.items()},
    )


def _steepest(model: Model) -> float:
    """Return the largest |h'| at the ends of the contact at rest."""
    return float(abs(model.slope(np.array(span(model.indenter, model.depth)))).max())
