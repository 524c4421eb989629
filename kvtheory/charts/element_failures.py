"""Entries of the atlas about simulations with discrete elements."""

from typing import Any

import numpy as np

from kvtheory.api import elements, steady, transient
from kvtheory.charts.entry import Outcome, Picture
from kvtheory.charts.naive import closed_forms, stale_elements
from kvtheory.charts.stability import PAPERS_DENSITY, unwatched
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.results.errors import DivergenceError
from kvtheory.scene.drives import Drive
from kvtheory.scene.model import Run, Scene

COARSE = 2e4
"""Elements per metre, a tenth of the paper's, so that single elements are seen in the forces."""
DETUNED = 2.02
"""Elements that pass between two samples, instead of 2: the sawtooth comes back every 50 samples."""


def _instability() -> Outcome:
    slow = Scene(drive=Drive(velocity=0.01), run=Run(0.1))
    h = 2.0 / PAPERS_DENSITY / 0.01
    steps = unwatched(slow, "paper", PAPERS_DENSITY, h)
    t, d = np.array([(step.time, step.depth) for step in steps]).T
    times = np.linspace(0.0, 0.1, 101)
    ours = elements(slow, at=times, certify=False).depth
    right = transient(slow, at=[0.1])
    return Outcome(
        float(d[-1]), float(right.depth[0]), float(ours[-1]),
        Picture.of("t [ms]", "depth [mm]", (1e3 * t, 1e3 * d), (1e3 * times, 1e3 * ours)),
        _refusal(slow),
    )  # fmt: skip


def _refusal(scene: Scene) -> str:
    """Return the message of the package where the paper's scheme does not work."""
    try:
        elements(scene, scheme="paper", certify=False)
    except (DivergenceError, ValueError) as error:
        return f"kv.elements: {error}"
    return ""


def _fixed(scheme: str, times: Any, time_step: float) -> Any:
    """Return the normal force on a fixed indenter, which should be constant."""
    fixed = Scene.table1("fixed")
    return elements(
        fixed, per_length=COARSE, scheme=scheme, at=times, time_step=time_step, certify=False
    ).normal_force


def _forces(times: Any, time_step: float, said: str = "") -> Outcome:
    """Compare the forces of both schemes on a fixed indenter at these instants."""
    naive, ours = (_fixed(scheme, times, time_step) for scheme in ("paper", DEFAULT))
    curves = ((1e3 * times, 1e-3 * force) for force in (naive, ours))
    picture = Picture.of("t [ms]", "normal force [N/mm]", *curves)
    return Outcome(float(np.ptp(naive)), 0.0, float(np.ptp(ours)), picture, said)


def _sawtooth() -> Outcome:
    return _forces(np.linspace(0.01, 0.0125, 201), 1e-5)


def _grid_resonance() -> Outcome:
    """Sample the forces once for every 2.02 elements, each sample two steps after the last."""
    passing, samples = 1.0 / COARSE / 0.1, np.arange(151)
    locked = _fixed("paper", 0.01 + 2.0 * passing * samples, passing)[-1]
    wrong = locked / steady(Scene.table1("fixed")).load - 1.0
    every = DETUNED / COARSE / 0.1
    said = f"with exactly two elements in a step it stands still, wrong by {wrong:+.2%}"
    return _forces(0.01 + every * samples, 0.5 * every, said)


def _step_at_rest() -> Outcome:
    ramp = Scene(drive=Drive(history=[(0.0, 0.0), (0.02, 0.1)]), run=Run(0.04))
    times = np.linspace(0.0, 0.04, 81)
    with np.errstate(divide="ignore"):
        h = float(np.divide(2.0 / PAPERS_DENSITY, 0.0))  # 2 dx/V at the start of the ramp
    steps = unwatched(ramp, "paper", PAPERS_DENSITY, h)
    last = (steps[-1].depth, steps[-1].rate, 1.0) if steps else (1.0, 0.0, 0.0)
    friction = abs(closed_forms(*last)[1])  # of no steps at all: still at rest
    ours = elements(ramp, at=times, certify=False).friction_force
    right = transient(ramp, at=[0.02]).friction_force[0]
    return Outcome(
        friction, float(right), float(ours[np.searchsorted(times, 0.02)]),
        Picture.of("t [ms]", "friction force [N/mm]",
                   (1e3 * times, np.full_like(times, friction)), (1e3 * times, 1e-3 * ours)),
        _refusal(Scene(drive=Drive(velocity=0.0))),
    )  # fmt: skip


def _stale_surface() -> Outcome:
    t, d = stale_elements(Scene(), PAPERS_DENSITY)
    ours = elements(at=t[::20], certify=False).depth
    picture = Picture.of("t [ms]", "depth [mm]", (1e3 * t, 1e3 * d), (1e3 * t[::20], 1e3 * ours))
    return Outcome(float(d[-1]), float(transient(at=[0.2]).depth[0]), float(ours[-1]), picture)
