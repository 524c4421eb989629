"""Entries of the atlas about motion: by elements, by two states without memory, and on a spring.

In scaled scenes the unit of both forces is 4/3 N/m.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from kvtheory.api import elements, steady, transient
from kvtheory.charts import naive
from kvtheory.charts.stability import PAPERS_DENSITY, unwatched
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.models.slow_manifold.motion import follow
from kvtheory.models.slow_manifold.start import start
from kvtheory.results.errors import DivergenceError
from kvtheory.scene import Drive, Run, Scene
from kvtheory.scene.static_state import StaticState

RTOL = 1e-9
FINE = 120.0
"""Elements per unit length in the independent solution; the static contact has length 2."""
TABLE1 = StaticState.of(Scene())
PATH = 3000
"""Points of the prescribed path in a simulation by elements."""
COARSE = 2e4
"""Elements per metre, a tenth of the paper's, so that single elements are visible in the forces."""
DETUNED = 2.02
"""Elements that pass between two samples, instead of 2: the sawtooth repeats every 50 samples."""


def _without_memory(pieces: Sequence[naive.Piece], epsilon: float, s: naive.Array) -> Any:
    """Return d, f_z and f_x by SciPy's Radau on the two states, with the edges of Eqs. 32 and 33."""
    law_of = partial(naive.two_states, epsilon=epsilon)
    return naive.without_memory(pieces, s, law_of, "Radau", RTOL)[0]


def _compare(
    scene: Scene, quantity: str, times: naive.Array, wrong: naive.Array, ours: Any, at: int, said: str = "",
    **elements_options: float,
) -> naive.Outcome:  # fmt: skip
    """Return the outcome at one of the instants; the right number is from a simulation by elements."""
    right = elements(scene, at=[float(times[at])], certify=False, **elements_options)  # type: ignore[arg-type]
    package = getattr(ours, quantity)
    return naive.Outcome(
        wrong[at], getattr(right, quantity)[0], package[at], (times, wrong), (times, package), said
    )


def _leading_edge_peels() -> naive.Outcome:
    pieces = [(0.0, 1.0, 4.0), (1.0, 1.3, 0.1)]
    s = np.append(np.linspace(0.5, 1.0, 101)[:-1], np.linspace(1.0, 1.3, 121))
    scene = naive.scaled_scene(pieces, 3.0)
    ours = transient(scene, at=s, rtol=RTOL)
    wrong = naive.LOAD * _without_memory(pieces, 3.0, s)[1]
    at = int(np.argmin(wrong))
    return _compare(scene, "normal_force", s, wrong, ours, at, per_length=FINE)


def _negative_radicand() -> naive.Outcome:
    pieces, s = [(0.0, 3.0, 10.0)], np.linspace(0.0, 3.0, 301)
    scene = naive.scaled_scene(pieces, 0.3)
    ours = transient(scene, at=s, rtol=RTOL)
    wrong = _without_memory(pieces, 0.3, s)[0]
    at = int(np.argmax(np.abs(wrong - ours.depth)))
    flights = [e for e in ours.events if e.kind in ("take-off", "landing")]
    said = "kv.transient: " + ", ".join(f"{e.kind} at {e.time:.3f} τ" for e in flights)
    return _compare(scene, "depth", s, wrong, ours, at, said, per_length=FINE)


def _memory_ignored() -> naive.Outcome:
    after, number = 0.058, TABLE1.drive_number
    scene = Scene(drive=Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, 0.0)]), run=Run(0.15))
    t = np.append(np.linspace(0.02, 0.05, 121)[:-1], np.linspace(0.05, 0.15, 201))
    t = np.sort(np.append(t, after))
    pieces = [(0.0, 0.5, number), (0.5, 1.5, 0.0)]
    scaled = _without_memory(pieces, TABLE1.inertia_number, t / TABLE1.time)[2]
    ours = transient(scene, at=t, rtol=RTOL)
    at = int(np.searchsorted(t, after))
    return _compare(scene, "friction_force", t, TABLE1.friction_force * scaled, ours, at)


def _slow_manifold() -> naive.Outcome:
    number, epsilon = 4.0812765306, 0.306095740
    s = np.linspace(0.0, 4.0, 241)
    scene = naive.scaled_scene([(0.0, 4.0, number)], epsilon)
    wrong = np.asarray(follow(start(number, epsilon, 0.0), s, RTOL).values["depth"])
    ours = transient(scene, at=s, rtol=RTOL)
    at = int(np.argmin(ours.depth))
    return _compare(scene, "depth", s, wrong, ours, at, per_length=FINE)


def _event_missed() -> naive.Outcome:
    start, stop, fast, V = 0.15, 0.1502, 4.0, 0.1
    tau, number, unit = TABLE1.time, TABLE1.drive_number, TABLE1.friction_force

    def rate(s: float) -> float:
        return fast * number if start <= s * tau < stop else number

    run = solve_ivp(
        naive.two_states(rate, TABLE1.inertia_number), (0.0, 2.0), (1.0, 0.0), "Radau",
        rtol=1e-6, atol=1e-9, events=lambda s, _: rate(s) - 2.0 * number,
    )  # fmt: skip
    t = run.t * tau
    states = zip(run.t, *run.y, strict=True)
    wrong = unit * np.array([naive.closed_forms(d, v, rate(s))[1] for s, d, v in states])
    history = [(0.0, V), (start, V), (start, fast * V), (stop, fast * V), (stop, V)]
    times = np.sort([*np.linspace(0.14, 0.17, 301), start, stop])
    ours = transient(Scene(drive=Drive(history=history)), at=times, rtol=RTOL).friction_force
    # Steady sliding at V until the pulse begins; then the closed forms at the same depth and 4 V.
    now = transient(at=[start], rtol=RTOL)
    d, v = now.depth[0] / TABLE1.depth, now.depth_rate[0] * tau / TABLE1.depth
    right = unit * naive.closed_forms(d, v, fast * number)[1]
    late, drawn = t >= 0.14, (t >= 0.14) & (t <= 0.17)
    said = f"solve_ivp: status {run.status}, events found: {run.t_events[0].size}"
    curves = (t[drawn], wrong[drawn]), (times, ours)
    return naive.Outcome(wrong[late].max(), right, ours.max(), *curves, said)


def _on_spring(rest: StaticState, s: naive.Array) -> naive.Array:
    """Return (d, d', x, x') by SciPy's Radau, with edges that assume undisturbed ground."""

    def law(_: float, y: Sequence[float]) -> tuple[float, ...]:
        d, v, x, w = y
        f_z, f_x = naive.closed_forms(d, v, rest.drive_number - w)
        pull = f_x - rest.drive_stiffness_number * x
        return v, (1.0 - f_z) / rest.inertia_number, w, pull / rest.drive_inertia_number

    at_rest = (1.0, 0.0, 0.0, 0.0)
    run = solve_ivp(law, (0.0, s[-1]), at_rest, "Radau", t_eval=s, rtol=1e-8, atol=1e-10)
    return np.asarray(run.y)


def _past_the_maximum() -> naive.Outcome:
    V, t = 0.091, np.linspace(0.0, 0.8, 401)
    scene = Scene(drive=Drive(velocity=V, stiffness=1e6), run=Run(0.8))
    rest = StaticState.of(scene)
    # Sliding never reverses here, so the ground ahead is undisturbed: closed forms suffice.
    right = V - rest.velocity * _on_spring(rest, t / rest.time)[3]
    slowest = int(np.argmin(right))
    ours: Any = transient(scene, at=t, rtol=RTOL, certify=False)
    force = steady(scene).friction_force / 1e3
    return naive.Outcome(
        V, right[slowest], ours.sliding_velocity[slowest],
        (t, np.full(t.size, V)), (t, ours.sliding_velocity),
        f"steady friction force {force:.3g} N/mm, on a curve that does not show its stability",
    )  # fmt: skip


def _reversal_forgotten() -> naive.Outcome:
    end, number, s = 1.4, 3.0, np.linspace(0.0, 1.4, 351)
    rigid = naive.scaled_scene([(0.0, end, number)], 0.05)
    drive = replace(rigid.drive, stiffness=2.0 * naive.LOAD, mass=0.01 * naive.LOAD)
    scene = replace(rigid, drive=drive)
    ours: Any = transient(scene, at=s, rtol=RTOL, certify=False)
    d, v, _, w = _on_spring(StaticState.of(scene), s)
    states = zip(d, v, number - w, strict=True)
    wrong = naive.LOAD * np.array([naive.closed_forms(*state)[1] for state in states])
    # Elements on the same path: they always keep the memory of the surface.
    fine = np.linspace(0.0, end, PATH)
    path: Any = transient(scene, at=fine, rtol=RTOL, certify=False)
    history = list(zip(fine.tolist(), path.sliding_velocity.tolist(), strict=True))
    at = int(np.argmax(np.abs(wrong - ours.friction_force)))
    reversals = [e for e in ours.events if e.kind == "sliding reverses"]
    said = ", ".join(f"{e.kind} at {e.time:.3f} τ" for e in reversals)
    along = replace(rigid, drive=Drive(history=history))
    return _compare(along, "friction_force", s, wrong, ours, at, said, per_length=FINE)


def _refusal(scene: Scene) -> str:
    """Return the message of the package where the paper's scheme fails."""
    try:
        elements(scene, scheme="paper", certify=False)
    except (DivergenceError, ValueError) as error:
        return f"kv.elements: {error}"
    return ""


def _instability() -> naive.Outcome:
    slow = Scene(drive=Drive(velocity=0.01), run=Run(0.1))
    steps = unwatched(slow, "paper", PAPERS_DENSITY, 2.0 / PAPERS_DENSITY / 0.01)
    t, d = np.array([(step.time, step.depth) for step in steps]).T
    times = np.linspace(0.0, 0.1, 101)
    ours = elements(slow, at=times, certify=False).depth
    right = transient(slow, at=[0.1]).depth[0]
    return naive.Outcome(d[-1], right, ours[-1], (t, d), (times, ours), _refusal(slow))


def _force(scheme: str, times: Any, time_step: float) -> Any:
    """Return the normal force on a fixed indenter, which should be constant."""
    how = {"per_length": COARSE, "scheme": scheme, "at": times, "time_step": time_step}
    return elements(Scene.table1("fixed"), certify=False, **how).normal_force


def _forces(times: Any, time_step: float, said: str = "") -> naive.Outcome:
    """Compare the forces of both schemes on a fixed indenter at these instants."""
    wrong, ours = (_force(scheme, times, time_step) for scheme in ("paper", DEFAULT))
    return naive.Outcome(np.ptp(wrong), 0.0, np.ptp(ours), (times, wrong), (times, ours), said)


def _sawtooth() -> naive.Outcome:
    return _forces(np.linspace(0.01, 0.0125, 201), 1e-5)


def _grid_resonance() -> naive.Outcome:
    """Sample the forces once for every 2.02 elements, each sample two steps after the last."""
    passing, samples = 1.0 / COARSE / 0.1, np.arange(151)
    locked = _force("paper", 0.01 + 2.0 * passing * samples, passing)[-1]
    wrong = locked / steady(Scene.table1("fixed")).load - 1.0
    every = DETUNED * passing
    said = f"with exactly two elements per step the force is constant, wrong by {wrong:+.2%}"
    return _forces(0.01 + every * samples, 0.5 * every, said)


def _step_at_rest() -> naive.Outcome:
    ramp = Scene(drive=Drive(history=[(0.0, 0.0), (0.02, 0.1)]), run=Run(0.04))
    times = np.linspace(0.0, 0.04, 81)
    steps = unwatched(ramp, "paper", PAPERS_DENSITY, np.inf)  # 2 dx/V at the start of the ramp
    last = (steps[-1].depth, steps[-1].rate, 1.0) if steps else (1.0, 0.0, 0.0)
    friction = abs(naive.closed_forms(*last)[1])  # after no steps at all: still at rest
    ours = elements(ramp, at=times, certify=False).friction_force
    right = transient(ramp, at=[0.02]).friction_force[0]
    return naive.Outcome(
        friction, right, ours[np.searchsorted(times, 0.02)],
        (times, np.full_like(times, friction)), (times, ours),
        _refusal(Scene(drive=Drive(velocity=0.0))),
    )  # fmt: skip


def _stale_surface() -> naive.Outcome:
    t, d = naive.stale_elements(Scene(), PAPERS_DENSITY)
    ours = elements(at=t[::20], certify=False).depth
    return naive.Outcome(d[-1], transient(at=[0.2]).depth[0], ours[-1], (t, d), (t[::20], ours))
