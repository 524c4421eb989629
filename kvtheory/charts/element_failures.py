"""Entries of the atlas about simulations with discrete elements."""

from typing import Any

import numpy as np

from kvtheory.api import elements, steady, transient
from kvtheory.charts.entry import Line, Outcome, Picture
from kvtheory.charts.naive import closed_forms, stale_elements
from kvtheory.charts.stability import PAPERS_DENSITY, unwatched
from kvtheory.results import Simulation
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
    try:
        elements(slow, scheme="paper", certify=False)
        said = ""
    except DivergenceError as error:
        said = f"kv.elements: {error}"
    times = np.linspace(0.0, 0.1, 101)
    ours = elements(slow, at=times, certify=False).depth
    right = transient(slow, at=[0.1])
    return Outcome(
        float(d[-1]), float(right.depth[0]), float(ours[-1]),
        Picture("t [ms]", "depth [mm]",
                (Line("wrong", 1e3 * t, 1e3 * d), Line("package", 1e3 * times, 1e3 * ours))),
        said,
    )  # fmt: skip


def _fixed(scheme: str, times: Any, time_step: float) -> Simulation:
    """Return the forces on a fixed indenter, which should not change at all."""
    fixed = Scene.table1("fixed")
    return elements(
        fixed, per_length=COARSE, scheme=scheme, at=times, time_step=time_step, certify=False
    )


def _sawtooth() -> Outcome:
    times = np.linspace(0.01, 0.0125, 201)
    naive, ours = (_fixed(name, times, 1e-5).normal_force for name in ("paper", "edge-corrected"))
    lines = Line("wrong", 1e3 * times, 1e-3 * naive), Line("package", 1e3 * times, 1e-3 * ours)
    return Outcome(
        float(np.ptp(naive)), 0.0, float(np.ptp(ours)),
        Picture("t [ms]", "normal force [N/mm]", lines),
    )  # fmt: skip


def _resonance() -> Outcome:
    """Sample the forces once for every 2.02 elements, each sample two steps after the last."""
    every = DETUNED / COARSE / 0.1
    times = 0.01 + every * np.arange(151)
    naive, ours = (
        _fixed(name, times, 0.5 * every).normal_force for name in ("paper", "edge-corrected")
    )
    locked = _fixed(
        "paper", 0.01 + 2.0 / COARSE / 0.1 * np.arange(151), 1.0 / COARSE / 0.1
    ).normal_force
    exact = steady(Scene.table1("fixed")).load
    lines = Line("wrong", 1e3 * times, 1e-3 * naive), Line("package", 1e3 * times, 1e-3 * ours)
    return Outcome(
        float(np.ptp(naive)), 0.0, float(np.ptp(ours)),
        Picture("t [ms]", "normal force [N/mm]", lines),
        f"with exactly two elements in a step it stands still, wrong by {locked[-1] / exact - 1:+.2%}",
    )  # fmt: skip


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
    try:
        elements(Scene(drive=Drive(velocity=0.0)), scheme="paper", certify=False)
        said = ""
    except ValueError as error:
        said = f"kv.elements: {error}"
    lines = (
        Line("wrong", 1e3 * times, np.full_like(times, friction)),
        Line("package", 1e3 * times, 1e-3 * ours),
    )
    return Outcome(
        friction, float(right), float(ours[np.searchsorted(times, 0.02)]),
        Picture("t [ms]", "friction force [N/mm]", lines), said,
    )  # fmt: skip


def _stale_surface() -> Outcome:
    t, d = stale_elements(Scene(), PAPERS_DENSITY)
    ours = elements(at=t[::20], certify=False).depth
    lines = Line("wrong", 1e3 * t, 1e3 * d), Line("package", 1e3 * t[::20], 1e3 * ours)
    return Outcome(
        float(d[-1]), float(transient(at=[0.2]).depth[0]), float(ours[-1]),
        Picture("t [ms]", "depth [mm]", lines),
    )  # fmt: skip


ELEMENT_FAILURES = {
    "instability": _instability,
    "sawtooth": _sawtooth,
    "grid-resonance": _resonance,
    "step-at-rest": _step_at_rest,
    "stale-surface": _stale_surface,
}
"""The entries about elements."""
