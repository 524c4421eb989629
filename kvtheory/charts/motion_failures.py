"""Entries of the atlas about the motion of the indenter.

Scaled scenes are run with R = 1/2, K = tau = delta_0 = 1: the static half length is 1, the static
load 4/3, and so the unit of both forces is 4/3 N/m.
"""

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from kvtheory.api import elements, transient
from kvtheory.charts.entry import Outcome, Picture
from kvtheory.charts.naive import closed_forms, two_states
from kvtheory.models.slow_manifold.motion import follow
from kvtheory.models.slow_manifold.start import start
from kvtheory.scene.drives import Drive
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import DeadWeight, Foundation, Run, Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

LOAD = 4.0 / 3.0
RTOL = 1e-9
FINE = 120.0
"""Elements per unit length, of a static contact that is 2 long: the independent check of the right number."""

FLIGHTS = "take-off", "landing"
"""Kinds of events."""


def _scaled(points: Sequence[tuple[float, float]], epsilon: float, end: float) -> Scene:
    """Return a scene with this drive number over s, under a dead weight."""
    support = DeadWeight(LOAD * epsilon, 1.0 / epsilon)
    return Scene(Parabola(0.5), Foundation(1.0, 1.0), support, Drive(history=points), Run(end))


def _without_past(
    points: Sequence[tuple[float, float]], epsilon: float, s: Array
) -> tuple[Array, Array, Array]:
    """Return d, f_z and f_x by SciPy's Radau on the two states, with the edges of Eqs. 32 and 33."""
    y, rows = (1.0, 0.0), []
    for (a, number), (b, _) in itertools.pairwise([*points, (s[-1], 0.0)]):
        if b == a:
            continue
        law = two_states(number, epsilon)
        run = solve_ivp(law, (a, b), y, "Radau", dense_output=True, rtol=RTOL, atol=1e-2 * RTOL)
        y = run.y[:, -1]
        inside = s[(s >= a) & ((s < b) | (b == s[-1]))]
        rows += [(d, *closed_forms(d, v, number)) for d, v in run.sol(inside).T]
    d, f_z, f_x = np.array(rows).T
    return d, f_z, f_x


def _leading_edge_peels() -> Outcome:
    stop, points = 1.0, [(0.0, 4.0), (1.0, 4.0), (1.0, 0.1)]
    s = np.append(np.linspace(0.5, stop, 101)[:-1], np.linspace(stop, 1.3, 121))
    scene = _scaled(points, 3.0, 1.3)
    ours = transient(scene, at=s, rtol=RTOL).normal_force
    _, naive, _ = _without_past(points, 3.0, s)
    at = int(np.argmin(naive))
    right = elements(scene, per_length=FINE, at=[float(s[at])], certify=False)
    return Outcome(
        LOAD * float(naive[at]), float(right.normal_force[0]), float(ours[at]),
        Picture.of("t/τ", "normal force / weight", (s, naive), (s, ours / LOAD)),
    )  # fmt: skip


def _negative_radicand() -> Outcome:
    points, end = [(0.0, 10.0)], 3.0
    s = np.linspace(0.0, end, 301)
    scene = _scaled(points, 0.3, end)
    ours = transient(scene, at=s, rtol=RTOL)
    d = _without_past(points, 0.3, s)[0]
    last = int(np.argmax(np.abs(d - ours.depth)))
    right = elements(scene, per_length=FINE, at=[float(s[last])], certify=False)
    return Outcome(
        float(d[last]), float(right.depth[0]), float(ours.depth[last]),
        Picture.of("t/τ", "depth / static depth", (s, d), (s, ours.depth)),
        "kv.transient: "
        + ", ".join(f"{e.kind} at {e.time:.3f} τ" for e in ours.events if e.kind in FLIGHTS),
    )  # fmt: skip


def _memory_ignored() -> Outcome:
    after = 0.058
    scene = Scene(drive=Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, 0.0)]), run=Run(0.15))
    t = np.append(np.linspace(0.02, 0.05, 121)[:-1], np.linspace(0.05, 0.15, 201))
    t = np.sort(np.append(t, after))
    numbers = StaticState.of(Scene())
    tau, number = 0.1, numbers.drive_number
    points = [(0.0, number), (0.5, number), (0.5, 0.0)]
    friction = numbers.load * numbers.depth / numbers.half_length
    naive = friction * _without_past(points, numbers.inertia_number, t / tau)[2]
    ours = transient(scene, at=t, rtol=RTOL).friction_force
    at = int(np.searchsorted(t, after))
    right = elements(scene, at=[after], certify=False)
    return Outcome(
        float(naive[at]), float(right.friction_force[0]), float(ours[at]),
        Picture.of("t [ms]", "friction force [N/mm]", (1e3 * t, 1e-3 * naive), (1e3 * t, 1e-3 * ours)),
    )  # fmt: skip


def _slow_manifold() -> Outcome:
    number, epsilon, end = 4.0812765306, 0.306095740, 4.0
    s = np.linspace(0.0, end, 241)
    scene = _scaled([(0.0, number)], epsilon, end)
    naive = follow(start(number, epsilon, 0.0), s, RTOL).values["depth"]
    ours = transient(scene, at=s, rtol=RTOL)
    at = int(np.argmin(ours.depth))
    right = elements(scene, per_length=FINE, at=[float(s[at])], certify=False)
    return Outcome(
        float(naive[at]), float(right.depth[0]), float(ours.depth[at]),
        Picture.of("t/τ", "depth / static depth", (s, naive), (s, ours.depth)),
    )  # fmt: skip


def _event_missed() -> Outcome:
    start, stop, fast = 0.15, 0.1502, 4.0
    numbers = StaticState.of(Scene())
    tau, number = 0.1, numbers.drive_number
    unit = numbers.load * numbers.depth / numbers.half_length

    def rate(s: float) -> float:
        return fast * number if start <= s * tau < stop else number

    run = solve_ivp(
        two_states(rate, numbers.inertia_number), (0.0, 2.0), (1.0, 0.0), "Radau",
        rtol=1e-6, atol=1e-9, events=lambda s, _: rate(s) - 2.0 * number,
    )  # fmt: skip
    t = run.t * tau
    naive = np.array(
        [unit * closed_forms(d, v, rate(s))[1] for s, d, v in zip(run.t, *run.y, strict=True)]
    )
    V = 0.1
    history = [(0.0, V), (start, V), (start, fast * V), (stop, fast * V), (stop, V)]
    scene = Scene(drive=Drive(history=history))
    times = np.sort([*np.linspace(0.14, 0.17, 301), start, stop])
    ours = transient(scene, at=times, rtol=RTOL).friction_force
    # Steady sliding at V until the pulse begins; then the closed forms at the same depth and 4 V.
    d = transient(at=[start], rtol=RTOL)
    late = t >= 0.14
    drawn = late & (t <= 0.17)
    right = unit * closed_forms(
        float(d.depth[0]) / numbers.depth,
        float(d.depth_rate[0]) * tau / numbers.depth, fast * number,
    )[1]  # fmt: skip
    return Outcome(
        float(naive[late].max()), right, float(ours.max()),
        Picture.of("t [ms]", "friction force [N/mm]",
                   (1e3 * t[drawn], 1e-3 * naive[drawn]), (1e3 * times, 1e-3 * ours)),
        f"solve_ivp: status {run.status}, events found: {run.t_events[0].size}",
    )  # fmt: skip
