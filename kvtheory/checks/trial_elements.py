"""Simulates every mistake in the contact rule at once.

Arrays run over rules, rows and columns of elements: a line contact has one row, a ball several. The first
rule is the right one, and only differences from it are used: most errors of the discretization cancel.
Steady sliding uses the same elements in the order in which they pass. It is NumPy alone, and shares no code
with the models.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm

from kvtheory.checks.theory import Array, Theory
from kvtheory.scene import Scene, Sphere
from kvtheory.scene.start import StartState
from kvtheory.scene.static_state import StaticState


class Rule(NamedTuple):
    """How an element presses on the indenter; any value but the default is a mistake."""

    depth_rate: float = 1.0  # factor on delta' in the compression rate
    slide_rate: float = 1.0  # factor on -h' V there
    decay: float = 1.0  # the free surface decays as exp(-decay t/tau); infinite: no memory
    tension: bool = False  # elements may pull, until they are back at z = 0
    stale: float = 0.0  # part of the pressure of receding elements that the motion misses
    drops: float = 0.0  # part of the whole force that it misses while the indenter rises
    creep: float = 0.0  # lag of a step that rises and sinks by turns, in M/C over the contact
    hunt_crossley: float = 0.0  # factor on the damping C u/delta_0 of the law of Hunt and Crossley
    friction: float = 1.0  # factor on h' V in the pressure from which friction is computed
    central: bool = False  # friction is F_z times the slope in the middle of the patch
    sine: bool = False  # friction is that of the sine of the slope
    arc: bool = False  # pressure acts on the length of the surface
    circle: bool = False  # the profile is a circle, not its parabola
    front: float = 1.0  # weight of elements before the lowest point
    back: float = 1.0  # weight of those behind it
    lost: float = 0.0  # part of the half length without elements at the leading edge
    flat: bool = False  # every strip of a ball is as deep as the middle one
    start: float = 1.0  # initial depth over the static depth
    loaded: bool = False  # arms bear load at the start
    clears: bool = False  # the free surface is forgotten at the instant at which sliding reverses
    freezes: bool = False  # what the indenter has left, where p < 0, does not relax
    damper: float = 0.0  # a damper on the indenter, in units of C times the contact


COLUMNS, ROWS = {False: 100, True: 26}, 8
"""Elements per static half length of a line contact and of a ball; rows per half width of a ball."""
WINDOW = 1.7
"""Half width of the simulated region, in half lengths at rest, or at the depth that an impact reaches."""
PASSED = 1.618
"""Elements that pass in a step; no whole number, so that entries are not in phase with steps."""
FEWEST_STEPS, LONGEST_RUN = 300, 1500
"""Fewest and most steps of a simulation; curves are constant afterwards."""
FINEST, GROWTH = 0.02, 1.3
"""First step after a change of the drive, relative to the longest one; growth factor of the next ones."""
OSCILLATION = 0.05
"""Longest step, in sqrt(M_x/k_x)."""
SWING = 4.0
"""Largest displacement on the spring, in static half lengths."""
SIMULATED = ("velocity", "depth", "depth_rate", "normal_force", "friction_force", "leading_edge",
             "trailing_edge", "peak_pressure", "sliding_velocity", "spring_force")  # fmt: skip
"""The curves that a simulation returns, in this order."""
POINTS, HALVINGS = 24, 24
"""Most velocities at which steady sliding is computed, and halvings of the interval of its depth."""
SHALLOWEST, DEEPEST = 1e-3, 4.0
"""Ends of that interval, in static depths."""
STEADY = ("slide_rate", "tension", "hunt_crossley", "friction", "central", "sine", "arc", "circle", "front",
          "back", "lost", "flat")  # fmt: skip
EVEN = "depth", "normal_force", "peak_pressure"
"""Fields of a rule that affect steady sliding; and the curves that do not change sign with the velocity."""
SLOWEST, TINY, STEEPEST = 1e-9, 1e-300, 1e-2
"""Lowest speed on arms, in a_0/tau; the divisor if the force vanishes; and least 1 - (x/R)^2 of a circle."""
IMPLICIT = 0.52
"""Weight of the end of a step; slightly more than the trapezoidal rule, for damping."""


class Pressed(NamedTuple):
    """Forces (`lift` moves the indenter) and their slopes, by rule; pressures at places x, and new state."""

    normal: Array
    lift: Array
    friction: Array
    slope: Array
    drag: Array | float
    pressure: Array
    x: Array
    surface: Array
    stress: Array
    on: Array


@dataclass
class Elements:
    """Elements of every rule as arrays (rules, rows, columns); `stress` has the arms as first axis.

    `seen` is the time to which a column is up to date; `heights` are y^2/(2 R').
    """

    scene: Scene
    rule: Any
    places: Array
    heights: Array
    areas: Array
    length: float
    surface: Array
    stress: Array
    on: Array
    seen: Array

    @classmethod
    def at_rest(
        cls, scene: Scene, rules: Sequence[Rule], low: float, high: float, depth: float,
        wider: float = 1.0,
    ) -> "Elements":  # fmt: skip
        """Return elements at rest under the indenter at a depth (m), between two places (m).

        A ball has rows for a contact that is `wider` than at rest.
        """
        static, ball = StaticState.of(scene), isinstance(scene.indenter, Sphere)
        rule = Rule(*np.array(rules, dtype=float).T[:, :, None, None])
        length = static.half_length / COLUMNS[ball]
        places: Any = np.arange(math.floor(low / length), math.ceil(high / length) + 1) * length
        heights, areas = np.zeros((len(rules), 1, 1)), np.full((len(rules), 1, 1), length)
        if isinstance(scene.indenter, Sphere):
            y = (np.arange(int(ROWS * WINDOW * wider)) + 0.5)[:, None] / ROWS  # over the half width
            heights = static.depth * np.where(rule.flat > 0.0, 0.0, y * y)
            width = 2.0 * static.half_length * scene.indenter.stretch / ROWS
            areas = length * width * ((rule.flat == 0.0) | (y < 1.0))
        R = scene.indenter.radius  # type: ignore[union-attr]
        surface = np.maximum(rule.start * depth - heights - places**2 / (2.0 * R), 0.0)
        moduli = np.array([arm.stiffness for arm in scene.foundation.arms])[:, None, None, None]
        stress, seen = moduli * rule.loaded * surface, np.zeros(places.size)
        return cls(
            scene, rule, places, heights, areas, length, surface, stress, surface > 0.0, seen
        )

    @cached_property
    def having(self) -> Any:
        """The rules with each mistake, by number: what few rules do is computed for these alone."""
        pairs = zip(self.rule, Rule(), strict=True)
        return Rule(*(np.flatnonzero(values != right) for values, right in pairs))  # type: ignore[arg-type]

    def pressed(self, h: float, near: slice, *state: Array) -> Pressed:
        """Press the columns `near` for a step h (s).

        `state` is, by rule, the depth, its rate, the displacement of the base and the sliding velocity.
        """
        depth, rate, moved, speed = (each[:, None, None] for each in state)
        rule, having, R = self.rule, self.having, self.scene.indenter.radius  # type: ignore[union-attr]
        rigid = self.scene.drive.rigid  # then all indenters are at the same place
        at = self.places[near] + (moved[:1] if rigid else moved)
        slope = at / R
        g = depth - self.heights - 0.5 * at * slope
        if having.circle.size:
            g, slope = _under_circle(g, slope, having.circle, R)
        rise = rule.depth_rate * rate - rule.slide_rate * speed * slope
        law = self._arms if self.scene.foundation.arms else self._kelvin_voigt
        inclined = np.abs(slope) * self.length
        touching = g > -0.5 * inclined  # with a part of the element
        on, p, damping, stiffness, surface, stress = law(h, near, g, rise, touching)
        area = np.clip(0.5 + g / (inclined + TINY), 0.0, 1.0) * self.areas
        x, slopes = (np.broadcast_to(each, (len(g), 1, at.shape[2])) for each in (at, slope))
        for k, weight in ((having.front, rule.front), (having.back, rule.back)):
            if k.size:
                counts = (x[k] < 0.0) == (weight is rule.front)
                area[k] *= np.where(counts, weight[k], 1.0)
        if (k := having.arc).size:
            area[k] *= np.sqrt(1.0 + slopes[k] ** 2)
        if (k := having.lost).size:
            reach = np.sqrt(2.0 * R * np.maximum(depth[k], 0.0))
            lost = (np.abs(x[k]) > (1.0 - rule.lost[k]) * reach) & (x[k] * speed[k] < 0.0)
            area[k] = np.where(lost, 0.0, area[k])

        def borne(p: Array, k: Any = slice(None)) -> Array:
            return np.where(on[k], np.maximum(p, np.where(rule.tension[k], -np.inf, 0.0)), 0.0)

        if (rubs := having.friction).size:
            change = (1.0 - rule.friction[rubs]) * np.broadcast_to(damping, p.shape)[rubs]
            rubbed = (
                borne(p[rubs] + change * slopes[rubs] * speed[rubs], rubs)
                * slopes[rubs]
                * area[rubs]
            )
        p = borne(p)
        force = p * area
        normal, friction = _total(force), -_total(force * slope)
        lift = normal
        if rubs.size:
            friction[rubs] = -_total(rubbed)
        if (k := having.sine).size:
            friction[k] = -_total(force[k] * slopes[k] / np.sqrt(1.0 + slopes[k] ** 2))
        if (k := having.stale).size:
            missed = rule.stale[k] * (g[k] < self.surface[k][:, :, near])
            lift = normal.copy()
            lift[k] = _total(force[k] * (1.0 - missed))
        if (k := having.central).size:
            friction[k] = -normal[k] * np.nan_to_num(sum(_edges(p[k], x[k]))) / (2.0 * R)
        held = area * (p != 0.0)

        stiff = _total(held * np.maximum(damping * rule.depth_rate + h * stiffness, 0.0))
        drag: Any = 0.0
        if not rigid:
            drag = np.maximum(damping * rule.slide_rate, 0.0) + h * stiffness
            drag = _total(held * drag * (slope * slope))
        return Pressed(normal, lift, friction, stiff, drag, p, x, surface, stress, on)

    def _kelvin_voigt(self, h: float, near: slice, g: Any, rise: Any, touching: Any) -> Any:
        """Return which elements press, p = K u + C u', C, K, and the new state by the exact memory (F8)."""
        foundation, rule, having = self.scene.foundation, self.rule, self.having
        old = self.surface[:, :, near]
        forgets = np.isinf(rule.decay)
        age = np.where(forgets, 0.0, rule.decay) * h / foundation.retardation_time
        kept = (
            np.where(forgets | (rule.tension > 0.0), 0.0, np.exp(-age)) if h else np.ones_like(age)
        )
        free = kept * old
        on = (g >= free) | (touching & (old == 0.0))
        if (k := having.tension).size:
            on[k] = g[k] > 0.0
        damping: Any = foundation.damping
        if (k := having.hunt_crossley).size:
            damping = np.full(g.shape, damping)
            damping[k] *= rule.hunt_crossley[k] * g[k] / StaticState.of(self.scene).depth
        p, surface = foundation.stiffness * g + damping * rise, np.maximum(g, free)
        if (k := having.freezes).size:
            on[k] = (g[k] > 0.0) & np.where(self.on[k][:, :, near], p[k] >= 0.0, g[k] >= old[k])
            surface[k] = np.where(on[k], g[k], old[k])
        return on, p, damping, foundation.stiffness, surface, self.stress[:, :, :, near]

    def _arms(self, h: float, near: slice, g: Any, rise: Any, touching: Any) -> Any:
        """Return the same on arms, strained at a constant rate during the step, and a damper beside them."""
        foundation, rule, old = self.scene.foundation, self.rule, self.surface[:, :, near]
        sticks, forgets = rule.tension > 0.0, np.isinf(rule.decay)
        moduli, times = _moduli_and_times(self.scene)
        kept, C = np.exp(-h / times), foundation.damping
        gain = moduli * ((1.0 - kept) * times / h if h else 1.0)
        glassy = foundation.stiffness + gain.sum()
        stress = kept * self.stress[:, :, :, near]
        slow = C / h if h else 0.0
        free = ((gain * old - stress).sum(axis=0) + slow * old) / (glassy + slow)
        free = np.where(forgets | sticks, 0.0, np.where(rule.decay > 0.0, free, old)) if h else old
        on = (g > 0.0) & (sticks | (g >= free))
        if C:  # with it, pressure jumps at an edge on undisturbed ground
            on = np.where(~sticks & (old == 0.0), touching, on)
        surface = np.where(on, np.maximum(g, 0.0), free)
        right = (rule.depth_rate == 1.0) & (rule.slide_rate == 1.0)
        stress = stress + gain * np.where(right | ~on, surface - old, h * rise)
        stress = np.where((forgets | sticks) & ~on & (h > 0.0), 0.0, stress)
        stress = np.where((rule.freezes > 0.0) & ~on, self.stress[:, :, :, near], stress)
        p = foundation.stiffness * surface + stress.sum(axis=0) + C * rise
        return on, p, C, glassy, surface, stress

    def near(self, moved: Array, reach: float) -> slice:
        """Return the columns near the indenter, by any rule."""
        ends = -reach - moved.max(), reach - moved.min()
        return slice(*np.searchsorted(self.places, ends).tolist())

    def keep(self, time: float, near: slice, found: Pressed) -> None:
        """Accept the state at the end of a step."""
        self.surface[:, :, near], self.stress[:, :, :, near] = found.surface, found.stress
        self.on[:, :, near] = found.on
        self.seen[near] = time

    def direction(self, forward: Any, speed: Array, depth: Array, moved: Array) -> Array:
        """Return which indenters slide forward; of one that has turned, a rule may clear the free surface."""
        now = np.where(speed == 0.0, forward, speed > 0.0)
        clears = (self.rule.clears > 0.0) & (now != forward)[:, None, None]
        if clears.any():
            x = self.places + moved[:, None, None]
            g = depth[:, None, None] - self.heights - x * x / (2.0 * self.scene.indenter.radius)  # type: ignore[union-attr]
            free = clears & (self.surface > np.maximum(g, 0.0))
            self.surface[free], self.stress[:, free] = 0.0, 0.0
        return now

    def relax(self, time: float, near: slice) -> None:
        """Relax the columns near the indenter from the time they were last in use to this one."""
        late = np.flatnonzero(self.seen[near] < time) + near.start
        decay = np.where(self.rule.freezes > 0.0, 0.0, np.minimum(self.rule.decay, 1e9))
        for k in late[self.surface[:, :, late].any(axis=(0, 1))]:
            gap = time - self.seen[k]
            if self.scene.foundation.arms:
                state = np.concatenate([self.surface[None, ..., k], self.stress[..., k]])
                left = np.einsum("ab,brj->arj", expm(_free_rates(self.scene) * gap), state)
                left = np.where(np.isinf(self.rule.decay[..., 0]), 0.0, left)
                state = np.where(self.rule.decay[..., 0] > 0.0, left, state)
                self.surface[..., k], self.stress[..., k] = state[0], state[1:]
            else:
                tau = self.scene.foundation.retardation_time
                self.surface[..., k] *= np.exp(-decay[..., 0] * gap / tau)
        self.seen[late] = time


def _total(values: Array) -> Array:
    """Return the sum over the elements, by rule."""
    return values.sum(axis=(1, 2))


def _under_circle(g: Array, slope: Array, k: Any, R: float) -> tuple[Array, Array]:
    """Return overlap and slope where the indenters `k` are circles, not parabolas."""
    g, slope = g.copy(), np.broadcast_to(slope, g.shape).copy()
    cosine = np.sqrt(np.maximum(1.0 - slope[k] ** 2, STEEPEST))
    g[k] += R * (0.5 * slope[k] ** 2 - (1.0 - cosine))
    slope[k] /= cosine
    return g, slope


def _edges(pressure: Array, x: Array) -> tuple[Array, Array]:
    """Return the ends of what presses, by rule."""
    pressing = np.where((pressure != 0.0).any(axis=1), x[:, 0], np.nan)
    return np.fmin.reduce(pressing, axis=1), np.fmax.reduce(pressing, axis=1)


def _moduli_and_times(scene: Scene) -> tuple[Array, Array]:
    arms = np.array([(arm.stiffness, arm.relaxation_time) for arm in scene.foundation.arms])
    return arms[:, 0, None, None, None], arms[:, 1, None, None, None]


def _free_rates(scene: Scene) -> Array:
    """Return the matrix of the rates of u and s_i of a free element: K u + C u' + sum s_i = 0."""
    K, C = scene.foundation.stiffness, scene.foundation.damping
    moduli, times = (part[:, 0, 0, 0] for part in _moduli_and_times(scene))
    fades = np.diag(np.append(0.0, 1.0 / times))
    sinks = np.append(0.0, 1.0 / times) / (K + moduli.sum())  # without damper K u' = -sum s_i'
    sinks = -np.append(K, np.ones(moduli.size)) / C if C else sinks
    return np.outer(np.append(1.0, moduli), sinks) - fades


def instants(scene: Scene, motion: Any, end: float) -> Array:
    """Return the ends of the steps, short ones after each change of the drive, whose time comes twice."""
    length = StaticState.of(scene).half_length / COLUMNS[not scene.indenter.per_width]
    longest = end / FEWEST_STEPS
    if motion.highest_speed:
        longest = min(longest, PASSED * length / motion.highest_speed)
    if scene.drive.stiffness:
        longest = min(longest, OSCILLATION * math.sqrt(scene.drive_mass / scene.drive.stiffness))
    first = longest * FINEST * GROWTH ** np.arange(math.ceil(-math.log(FINEST) / math.log(GROWTH)))
    changes = sorted({0.0, *(t for t in motion.changes if 0.0 < t < end)})
    found: list[float] = []
    for start, stop in pairwise([*changes, end]):
        ramp = start + np.cumsum(first)
        rest = np.arange(ramp[-1] + longest, stop, longest)
        found += [start, *ramp[ramp < stop].tolist(), *rest.tolist(), stop]
    return np.array(found[:LONGEST_RUN])


@lru_cache(maxsize=8)
def simulate(scene: Scene, rules: tuple[Rule, ...], end: float) -> tuple[Array, dict[str, Array]]:
    """Return times, and each curve as an array (times, rules), up to a time (s): Newton-trapezoidal steps."""
    static = StaticState.of(scene)
    motion: Any = scene.motion(scene.run.duration, static.velocity)
    times = instants(scene, motion, end)
    drive, held = scene.drive, scene.held
    begun, reach, elements = _begin(scene, rules, motion, float(times[-1]))
    M, M_x = scene.support.mass, scene.drive_mass
    k_s, k_x = 0.0 if held else scene.support.spring, drive.stiffness or 0.0
    depth, damper, creep, drops = _of_rules(scene, rules, begun.depth)
    first = np.array([[begun.rate], [0.0], [begun.along_rate], [0.0], [0.0], [0.0]])
    rate, along, along_rate, lifted, pulled, sinks = np.repeat(first, len(rules), axis=1)

    def lift(sunk: Array, rate: Array, found: Pressed, kept: Array | float = 1.0) -> Array:
        spring = k_s * (sunk - static.depth) + damper * rate
        return scene.support.weight - spring - kept * found.lift

    def pull(shift: Array, speed: Array, found: Pressed) -> Array:
        return found.friction - k_x * shift - drive.damping * speed

    forward, now, rows = motion.forward(float(times[-1])), 0.0, []
    for time, following in zip(times.tolist(), [*times[1:].tolist(), math.inf], strict=True):
        last, h, now = now, time - now, time
        base, V = motion.displacement(now), motion.velocity(now, before=following == time)
        near = elements.near(base - along, reach)
        elements.relax(last, near)

        def at(h: float) -> tuple[Array, Array, Pressed]:
            sunk = depth + h * ((1.0 - IMPLICIT) * before + IMPLICIT * rate)  # noqa: B023
            shift = along + h * ((1.0 - IMPLICIT) * before_along + IMPLICIT * along_rate)  # noqa: B023
            state = sunk, rate, base - shift, V - along_rate  # noqa: B023
            return sunk, shift, elements.pressed(h, near, *state)  # noqa: B023

        before, before_along = rate, along_rate
        if h > 0.0 and scene.depths:
            before = rate = (np.interp(now, *np.transpose(scene.depths)) - depth) / h
        if h > 0.0 and (not drive.rigid or not held):
            sunk, shift, found = at(h)
            if not held:
                slope = damper + IMPLICIT * h * k_s + found.slope
                full, less = (
                    rate + h * (IMPLICIT * lift(sunk, rate, found, kept) + (1.0 - IMPLICIT) * lifted)
                    / M / (1.0 + IMPLICIT * h * slope / M)
                    for kept in (1.0, drops)
                )  # fmt: skip
                # Where the whole force raises the indenter and what is left lowers it, it stays, or creeps.
                sinks = creep * np.maximum(-lift(sunk, rate, found), 0.0)
                rate = np.maximum(full, np.minimum(less, sinks))
            if not drive.rigid:
                a = IMPLICIT * pull(shift, along_rate, found) + (1.0 - IMPLICIT) * pulled
                slope = drive.damping + IMPLICIT * h * k_x + found.drag
                along_rate = along_rate + h * a / M_x / (1.0 + IMPLICIT * h * slope / M_x)
        depth, along, found = at(h)
        elements.keep(now, near, found)
        if not held:
            full, less = (lift(depth, rate, found, kept) for kept in (1.0, drops))
            lifted = np.select([rate > sinks, rate < 0.0], [full, less], np.clip(0.0, full, less))
        if not drive.rigid:
            pulled = pull(along, along_rate, found)
        speed = V - along_rate
        forward = elements.direction(forward, speed, depth, base - along)
        edges = np.where(forward, ends := _edges(found.pressure, found.x), ends[::-1])
        spring = found.friction if drive.rigid else k_x * along + drive.damping * along_rate
        rows.append((np.full_like(depth, V), depth, rate, found.normal, found.friction, *edges,
                     found.pressure.max(axis=(1, 2)), speed, spring))  # fmt: skip
    return times, dict(zip(SIMULATED, np.array(rows).transpose(1, 0, 2), strict=True))


def _of_rules(scene: Scene, rules: Sequence[Rule], depth: float) -> Array:
    """Return the depths at the start, dampers, creep and shares of the lift that remain, by rule."""
    law, static = scene.foundation, StaticState.of(scene)
    damping = law.slow_damping * static.load / law.stiffness / static.depth
    parts = np.array([(rule.start, rule.damper, rule.creep, 1.0 - rule.drops) for rule in rules])
    return (parts * [depth, damping, 1.0 / damping, 1.0]).T


def _begin(
    scene: Scene, rules: Sequence[Rule], motion: Any, end: float
) -> tuple[StartState, float, Elements]:
    """Return the state just after t = 0, how far a contact reaches, and the elements that it meets."""
    static = StaticState.of(scene)
    begun = scene.start.of(motion, static.depth)
    deepest = static.depth if scene.start.at_rest else static.impact(begun)[1]
    wider, (low, high) = math.sqrt(deepest / static.depth), motion.extremes(0.0, end)
    reach = WINDOW * static.half_length * wider
    outside = reach + _swing(scene, begun, motion, end)
    place = -high - outside, -low + outside
    return begun, reach, Elements.at_rest(scene, rules, *place, begun.depth, wider)


def _swing(scene: Scene, begun: StartState, motion: Any, end: float) -> float:
    """Return the largest displacement along x, on the spring or without one."""
    drive, k_x = scene.drive, scene.drive.stiffness or 0.0
    if drive.rigid:
        return 0.0
    swing = SWING * StaticState.of(scene).half_length
    if begun.along_rate or not k_x:
        lasts = min(end, math.sqrt(scene.drive_mass / k_x)) if k_x else end
        swing += lasts * (abs(begun.along_rate) + motion.highest_speed)
    return swing


def changes(theory: Theory, rules: Sequence[Rule], times: Array) -> list[dict[str, Array]]:
    """Return by rule what it changes in each curve at times (s)."""
    with np.errstate(all="ignore"):  # a wrong rule may diverge
        grid, found = simulate(theory.scene, (Rule(), *rules), float(times[-1]))
    off = [{name: values[:, k] - values[:, 0] for name, values in found.items()}
           for k in range(1, len(rules) + 1)]  # fmt: skip
    moving = (times >= 0.0) & (times <= 2.0 * grid[-1])
    return [{n: moving * np.interp(times, grid, np.nan_to_num(curve)) for n, curve in each.items()}
            for each in off]  # fmt: skip


def steady_changes(theory: Theory, rules: Sequence[Rule], speeds: Array) -> list[dict[str, Array]]:
    """Return by rule what it changes in each curve of steady sliding at speeds (m/s, increasing)."""
    kinds = [Rule(**{key: getattr(rule, key) for key in STEADY}) for rule in rules]
    V = np.abs(speeds)
    some = np.unique(np.quantile(V, np.linspace(0.0, 1.0, POINTS), method="nearest"))
    found = {rule: steady(theory, rule, some) for rule in {Rule(), *kinds}}
    sign = np.where(speeds < 0.0, -1.0, 1.0)
    return [{name: np.interp(V, some, np.nan_to_num(values - found[Rule()][name]))
             * (1.0 if name in EVEN else sign) for name, values in found[rule].items()}
            for rule in kinds]  # fmt: skip


def steady(theory: Theory, rule: Rule, speeds: Array) -> dict[str, Array]:
    """Return the curves of steady sliding by a rule at speeds (m/s)."""
    scene, static, count = theory.scene, theory.static, speeds.size
    reach, zero = WINDOW * static.half_length, np.zeros(count)
    elements = Elements.at_rest(scene, [rule] * count, -reach, reach, static.depth)
    x = elements.places
    elements.surface = np.zeros((count, elements.heights.shape[1], x.size))
    if scene.foundation.arms:
        moduli, times = _moduli_and_times(scene)
        speed = np.maximum(speeds, SLOWEST * static.velocity)[:, None, None]
        ages = (x - x[:, None]) / speed
        age = elements.length / (speed * times)
        passed = np.where(ages < 0.0, 0.0, np.exp(-np.maximum(ages, 0.0) / times))
        passed = rule.slide_rate * moduli * -np.expm1(-age) / age * passed

    def pressed(depth: Array) -> Pressed:
        if scene.foundation.arms:  # the stress of each strain that has passed
            overlap = depth[:, None, None] - elements.heights - 0.5 * x * (x / theory.radius)
            elements.surface = np.maximum(overlap, 0.0)
            elements.stress = np.diff(elements.surface, axis=-1, prepend=0.0) @ passed
        return elements.pressed(0.0, slice(None), depth, zero, zero, speeds)

    low, high = static.depth * np.array([[SHALLOWEST], [DEEPEST]]) * np.ones(count)
    for _ in range(0 if scene.held else HALVINGS):
        middle = 0.5 * (low + high)
        pushed = scene.support.weight - scene.support.spring * (middle - static.depth)
        light = pressed(middle).normal < pushed
        low, high = np.where(light, middle, low), np.where(light, high, middle)
    depth = np.full(count, static.depth) if scene.held else 0.5 * (low + high)
    found = pressed(depth)
    mu = found.friction / np.maximum(found.normal, TINY)
    left, right = _edges(found.pressure, found.x)
    return {"depth": depth, "normal_force": found.normal, "friction_force": found.friction,
            "friction_coefficient": mu, "leading_edge": left, "trailing_edge": right,
            "peak_pressure": found.pressure.max(axis=(1, 2))}  # fmt: skip
