"""Entries of the atlas about simulations with discrete elements."""

from typing import Any

import numpy as np

from kvtheory.api import elements, steady, transient
from kvtheory.charts.naive import Outcome, closed_forms, stale_elements
from kvtheory.charts.stability import PAPERS_DENSITY, unwatched
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.results.errors import DivergenceError
from kvtheory.scene.drives import Drive
from kvtheory.scene.model import Run, Scene

COARSE = 2e4
"""Elements per metre, a tenth of the paper's, so that single elements are seen in the forces."""
DETUNED = 2.02
"""Elements that pass between two samples, instead of 2: the sawtooth comes back every 50 samples."""


def _refusal(scene: Scene) -> str:
    """Return the message of the package where the paper's scheme does not work."""
    try:
        elements(scene, scheme="paper", certify=False)
    except (DivergenceError, ValueError) as error:
        return f"kv.elements: {error}"
    return ""


def _instability() -> Outcome:
    slow = Scene(drive=Drive(velocity=0.01), run=Run(0.1))
    steps = unwatched(slow, "paper", PAPERS_DENSITY, 2.0 / PAPERS_DENSITY / 0.01)
    t, d = np.array([(step.time, step.depth) for step in steps]).T
    times = np.linspace(0.0, 0.1, 101)
    ours = elements(slow, at=times, certify=False).depth
    right = transient(slow, at=[0.1]).depth[0]
    return Outcome(d[-1], right, ours[-1], (t, d), (times, ours), _refusal(slow))


def _force(scheme: str, times: Any, time_step: float) -> Any:
    """Return the normal force on a fixed indenter, which should be constant."""
    return elements(
        Scene.table1("fixed"), per_length=COARSE, scheme=scheme, at=times, time_step=time_step,
        certify=False,
    ).normal_force  # fmt: skip


def _forces(times: Any, time_step: float, said: str = "") -> Outcome:
    """Compare the forces of both schemes on a fixed indenter at these instants."""
    naive, ours = (_force(scheme, times, time_step) for scheme in ("paper", DEFAULT))
    return Outcome(np.ptp(naive), 0.0, np.ptp(ours), (times, naive), (times, ours), said)


def _sawtooth() -> Outcome:
    return _forces(np.linspace(0.01, 0.0125, 201), 1e-5)


def _grid_resonance() -> Outcome:
    """Sample the forces once for every 2.02 elements, each sample two steps after the last."""
    passing, samples = 1.0 / COARSE / 0.1, np.arange(151)
    locked = _force("paper", 0.01 + 2.0 * passing * samples, passing)[-1]
    wrong = locked / steady(Scene.table1("fixed")).load - 1.0
    every = DETUNED * passing
    said = f"with exactly two elements in a step it stands still, wrong by {wrong:+.2%}"
    return _forces(0.01 + every * samples, 0.5 * every, said)


def _step_at_rest() -> Outcome:
    ramp = Scene(drive=Drive(history=[(0.0, 0.0), (0.02, 0.1)]), run=Run(0.04))
    times = np.linspace(0.0, 0.04, 81)
    steps = unwatched(ramp, "paper", PAPERS_DENSITY, np.inf)  # 2 dx/V at the start of the ramp
    last = (steps[-1].depth, steps[-1].rate, 1.0) if steps else (1.0, 0.0, 0.0)
    friction = abs(closed_forms(*last)[1])  # after no steps at all: still at rest
    ours = elements(ramp, at=times, certify=False).friction_force
    right = transient(ramp, at=[0.02]).friction_force[0]
    return Outcome(
        friction, right, ours[np.searchsorted(times, 0.02)],
        (times, np.full_like(times, friction)), (times, ours),
        _refusal(Scene(drive=Drive(velocity=0.0))),
    )  # fmt: skip


def _stale_surface() -> Outcome:
    t, d = stale_elements(Scene(), PAPERS_DENSITY)
    ours = elements(at=t[::20], certify=False).depth
    return Outcome(d[-1], transient(at=[0.2]).depth[0], ours[-1], (t, d), (t[::20], ours))
