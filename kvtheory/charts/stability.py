"""Stability maps: where a scheme of the elements is stable, as predicted and as measured.

Predicted (derivations, F15): a step h is stable if |R(σ h)| <= 1 for both rates of the contact,
M σ^2 + C L σ + K L + k_s = 0, with L of the contact at the static depth, where a start from rest
begins, and with L in steady sliding. Measured: two runs with a tiny difference in velocity; the scheme is
unstable if their difference grows by more than a factor of 1 per step. No stability theory enters the
measurement.

Up to about 1.5 times the limit the runs may leave steady sliding for a cycle with a shorter contact, in
which their difference decays: there the result depends on the positions of the elements. For lambda above
about 20 a step near the limit crosses much of the contact, which the prediction takes as fixed: there it is
too optimistic.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice, product

import numpy as np
from numpy.typing import NDArray

from kvtheory.api import steady as steady_sliding
from kvtheory.charts.naive import Array, scaled_scene
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import ElementRow, IndenterState, OutgrownError
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.elements.simulation import ELEMENTS_PER_STEP
from kvtheory.models.elements.stability import lengths, limit_at
from kvtheory.progress import Progress, silent
from kvtheory.results import SteadyState
from kvtheory.scene import Drive, Foundation, Scene
from kvtheory.scene.static_state import StaticState

STEPS = 30
"""Steps over which growth is measured: 2 % per step gives a factor of 1.8."""
LATEST = 8
"""Steps after which growth counts in steady sliding. A run that has diverged may settle later."""
NUDGE = 1e-9
"""Initial difference of both runs, in depths per step: it changes no contact, and is far above rounding."""
BLOWN_UP, DIED_OUT = 1e4, 0.1
"""Multiple of the first difference at which a measurement ends."""
INITIAL_GROWTH = 1.08
"""Growth in the first steps that counts as unstable: stable runs grow by up to 1.06, once."""
DEEP = 1e6
"""Depth that the elements allow, over the static depth: an unstable indenter may sink."""
PER_HALF_LENGTH = 100.0
"""Elements per static half length in the maps over the step."""
PAPERS_DENSITY = 2e5
"""Elements per metre of the paper (Table 1)."""

VELOCITY_RANGE, TAU_RANGE = (1e-3, 1.0), (3e-3, 3.0)
NUMBER_RANGE, STEP_RANGE = (0.1, 100.0), (0.2, 5.0)
"""Ranges of the axes of the maps: V in m/s, tau in s, lambda, and the step over its limit."""
POINTS, QUICK_POINTS = (31, 24), (13, 10)
"""Points along the axes of a map; maps of schemes that are stable everywhere have half as many."""

CLASSES = "stable", "unstable at first", "unstable in steady sliding"
"""Classes of a point of a map: the start from rest may be unstable though steady sliding is not."""


@dataclass(frozen=True)
class Map:
    """One map of one scheme: rows over `y`, columns over `x`."""

    scheme: str
    x: Array
    y: Array
    start: Array  # measured growth per step from rest
    steady: Array  # and in steady sliding
    predicted_start: Array  # the step in units of its predicted limit
    predicted_steady: Array

    @property
    def classes(self) -> NDArray[np.int64]:
        """Index of the class of every point, as measured."""
        return np.where(self.steady > 1.0, 2, (self.start > INITIAL_GROWTH).astype(np.int64))


def contact_lengths(scene: Scene) -> tuple[float, float]:
    """Return the contact lengths (m) that bound the step: in steady sliding, and at the static depth."""
    model = Model.of(scene)
    return lengths(model, model.path(scene))


def _walk(
    scene: Scene, name: str, per_length: float, time_step: float, *, nudge: float = 0.0,
    steady: SteadyState | None = None,
) -> Iterator[IndenterState]:  # fmt: skip
    """Yield steps from rest or steady sliding, with initial velocity `nudge`, until it sinks too deep."""
    scheme = SCHEMES[name]
    model = Model.of(scene, 1.0 / per_length, parts=scheme.row.parts_of_elements)
    row = ElementRow(model.constants, model.path(scene), scheme, DEEP)
    state = IndenterState(0.0, model.at_rest.depth, nudge)
    if steady is not None:
        depth, front, back = map(float, (steady.depth, steady.leading_edge, steady.trailing_edge))
        left = depth - float(model.height(back))

        def surface(x: Array, y: float) -> Array:
            behind = left * np.exp(-np.maximum(x - back, 0.0) / steady.retardation_length)
            u = np.where(x > back, behind, depth - model.height(x, y))
            return np.where(x < front, 0.0, u)

        row.lay(depth, surface, lambda x: np.asarray((x >= front) & (x <= back)))
        state = state._replace(depth=depth)
    with np.errstate(all="ignore"):
        while True:
            try:
                state = row.step(state, time_step)
            except (OutgrownError, OverflowError, ValueError):  # of a depth that is not a number
                return
            yield state


def unwatched(
    scene: Scene, scheme: str, per_length: float, time_step: float
) -> list[IndenterState]:
    """Return the steps of a run from rest to the end of the scene, however unstable it is."""
    steps = _walk(scene, scheme, per_length, time_step)
    return list(islice(steps, round(scene.run.duration / time_step)))


def growth(
    scene: Scene, scheme: str, per_length: float, time_step: float, *, steady: bool
) -> float:
    """Return the growth factor per step of the difference of two runs, initially a tiny velocity.

    Above 1 the scheme is unstable, below 1 stable. The indenter is a parabola that is driven at one
    positive velocity. With `steady` it begins in steady sliding; else it begins at its static depth,
    where the first steps count, because the contact soon changes.
    """
    sliding = steady_sliding(scene) if steady else None
    depth = StaticState.of(scene).depth if sliding is None else float(sliding.depth)
    nudge = NUDGE * depth / time_step
    how = scene, scheme, per_length, time_step
    runs = (_walk(*how, nudge=more, steady=sliding) for more in (0.0, nudge))
    differences: list[float] = []
    for one, other in islice(zip(*runs, strict=False), STEPS):
        differences.append(abs(one.rate - other.rate) / nudge)
        if not differences[-1] < BLOWN_UP or max([1.0, *differences][-LATEST:]) < DIED_OUT:
            break
    else:
        if len(differences) < STEPS:  # it sank too deep
            differences.append(BLOWN_UP)
    differences[-1] = min(np.nan_to_num(differences[-1], nan=BLOWN_UP), BLOWN_UP)
    first = min(LATEST, len(differences)) if steady else 1
    count = np.arange(first, len(differences) + 1)
    return float(max(np.array(differences[first - 1 :]) ** (1.0 / count)))


def velocity_map(scheme: str, velocities: Array, retardation_times: Array) -> Map:
    """Return the map over V (m/s) and tau (s), Table 1 otherwise, at the paper's step and density."""

    def point(V: float, tau: float) -> tuple[Scene, float]:
        foundation = Foundation(Scene().foundation.stiffness, tau)
        scene = Scene(foundation=foundation, drive=Drive(velocity=V))
        return scene, ELEMENTS_PER_STEP / PAPERS_DENSITY / V

    return _map(scheme, velocities, retardation_times, point, PAPERS_DENSITY)


def step_map(scheme: str, numbers: Array, steps: Array) -> Map:
    """Return the map over lambda and the step over the limit (F15) of the scheme, or of the paper's."""
    epsilon = StaticState.of(Scene()).inertia_number
    limited = SCHEMES[scheme if SCHEMES[scheme].tableau else "paper"]

    def point(number: float, share: float) -> tuple[Scene, float]:
        scene = scaled_scene([(0.0, 1.0, number)], epsilon)
        return scene, share * limit_at(
            limited, Model.of(scene).constants, contact_lengths(scene)[0]
        )

    return _map(scheme, numbers, steps, point, PER_HALF_LENGTH)


def _map(
    scheme: str, x: Array, y: Array, point: Callable[[float, float], tuple[Scene, float]],
    per_length: float,
) -> Map:  # fmt: skip
    """Return growth from rest and in steady sliding, and the steps over their limits, at every point."""

    def measured(scene: Scene, time_step: float) -> list[float]:
        model, (sliding, first) = Model.of(scene), contact_lengths(scene)
        limits = [limit_at(SCHEMES[scheme], model.constants, length) for length in (first, sliding)]
        ways = False, True
        found = [growth(scene, scheme, per_length, time_step, steady=steady) for steady in ways]
        return [*found, *(time_step / limit for limit in limits)]

    rows = np.array([[measured(*point(a, b)) for a in x] for b in y])
    return Map(scheme, x, y, *np.moveaxis(rows, -1, 0))


def stability_maps(*, quick: bool = False, progress: Progress = silent) -> dict[str, list[Map]]:
    """Return the maps of every scheme: over ``"velocity"`` and tau, and over lambda and the ``"step"``."""
    kinds = {
        "velocity": (velocity_map, VELOCITY_RANGE, TAU_RANGE),
        "step": (step_map, NUMBER_RANGE, STEP_RANGE),
    }
    found: dict[str, list[Map]] = {kind: [] for kind in kinds}
    for done, (kind, name) in enumerate(product(kinds, SCHEMES), 1):
        make, *ends = kinds[kind]
        points = QUICK_POINTS if quick else POINTS
        if not SCHEMES[name].tableau:
            points = (points[0] + 1) // 2, (points[1] + 1) // 2
        axes = [np.geomspace(*end, n) for end, n in zip(ends, points, strict=True)]
        found[kind].append(make(name, *axes))
        progress(done / (len(kinds) * len(SCHEMES)), name)
    return found
