"""Random requests to the ladder, and the truth of each by other methods than the one that answered.

Steady sliding is enclosed in ball arithmetic; that of a circle is integrated from the definitions. A start
from rest is solved as two states with SciPy, or, where the slow manifold answered, by the continuum with a
far smaller tolerance; a drive with memory from the whole past.
"""

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

import kvtheory as kv
from kvtheory.ladder.series import ODD, SOLVED
from kvtheory.models.slow_manifold import motion as slow_motion
from kvtheory.models.slow_manifold import start as slow_start
from kvtheory.models.steady import asymptote_bounds as asymptote
from kvtheory.results import STEADY_UNITS
from kvtheory.results.table import scales
from kvtheory.scene.static_state import StaticState
from tests import (
    reference,
    transient_history,
    transient_reference,
)
from tests.spring_random import of_unit_scales
from tests.transient_history import Scene as ScaledScene

TRUER, TRUEST = 1e-2, 1e-4
"""Tolerance of the truth, in units of that asked for; the latter where the former speaks against us."""
NODES, WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(80))
NODES = 0.5 + NODES
"""Of Gauss's rule from 0 to 1."""
LEAST_INERTIA, LONGEST_STEP = 1e-2, 0.02
"""Of solutions from the whole past."""


@dataclass(frozen=True)
class Case:
    """A scene and what is asked of it; `scaled` is the drive and numbers of a series."""

    kind: str
    scene: Any
    request: dict
    scaled: ScaledScene | None = None

    @property
    def names(self):
        """Return the quantities that are asked for."""
        asked = self.request.get("quantity")
        every = tuple(STEADY_UNITS) if self.scaled is None else SOLVED
        return every if asked is None else (asked,)


def steady_case(rng, ball=False):
    """Draw a parabola or a ball in any units, over eight decades of drive number."""
    R, K, tau = 10 ** rng.uniform((-4, 6, -4), (0, 11, 2))
    delta = R * 10 ** rng.uniform(-5, -1)
    a = math.sqrt(2 * R * delta)
    across = R * 10 ** rng.uniform(-1, 1) if ball else R
    weight = math.pi * K * math.sqrt(R * across) * delta**2 if ball else 4 / 3 * K * a * delta
    V = rng.choice((-1, 1)) * 10 ** rng.uniform(-4, 4) * a / tau * (rng.random() > 0.02)
    support = (
        kv.Fixed(delta),
        kv.DeadWeight(mass=weight / 9.8, gravity=9.8),
        kv.Suspended(mass=weight / 9.8, stiffness=weight / delta * 10 ** rng.uniform(-3, 3), gravity=9.8),
    )[rng.integers(3)]  # fmt: skip
    shape = kv.Sphere(R, radius_across=across) if ball else kv.Parabola(R)
    scene = kv.Scene(shape, kv.Foundation(K, tau), support, kv.Drive(V))
    return Case("steady", scene, _request(rng, STEADY_UNITS))


def shape_case(rng):
    """Draw another shape under a given depth or load, over eight decades of drive number."""
    shape = (
        kv.Circle(1.0),
        kv.Wedge(inclination=float(rng.uniform(0.05, 0.5))),
        kv.PowerLaw(length=1.0, exponent=float(rng.uniform(1.5, 4.0))),
    )[rng.integers(3)]
    V = 10 ** rng.uniform(-4, 4)
    support = (kv.Fixed(0.01), kv.DeadWeight(mass=1e-3, gravity=1.0))[rng.integers(2)]
    scene = kv.Scene(shape, kv.Foundation(1.0, 1.0), support, kv.Drive(0.1 * V))
    names = ("depth", "load", "friction_force", "friction_coefficient")
    return Case("other shape", scene, _request(rng, names, one=True))


def start_case(rng, memory=False):
    """Draw a start from rest, or a drive that changes once; all scales are 1, but for the sign of V."""
    eps = 10 ** rng.uniform(-2.5, 1) if memory else 10 ** rng.uniform(-7, 1)
    kappa = (0.0, 0.0, 10 ** rng.uniform(-2, 1.5), math.inf)[rng.integers(4)]
    number, side = 10 ** rng.uniform(-2, 1.5), rng.choice((-1.0, 1.0))
    end = rng.uniform(0.3, 4.0)
    times = np.sort(end * 10 ** rng.uniform(-2, 0, 5))
    drive, points = [(0.0, number)], None
    if memory:
        change, factor = rng.uniform(0.1, 0.6) * end, rng.choice((0.0, -0.5, 0.3, 2.0))
        drive = [(0.0, number), (change, number), (change, factor * number)]
        points = [(s, side * level) for s, level in drive]
        times = times[np.abs(times - change) > 1e-6]
        times = np.append(times, end)
    given = kv.Drive(history=points) if memory else kv.Drive(side * number)
    scene = of_unit_scales(eps, kappa, given, end)
    fixed = math.isinf(kappa)
    scaled = ScaledScene(drive, None if fixed else eps, tuple(times), 0.0 if fixed else kappa)
    request = {**_request(rng, SOLVED), "at": times.tolist()}
    return Case("memory" if memory else "start", scene, request, scaled)


def _request(rng, names, one=False):
    """Ask for one quantity, or one time in four for all, to within 1e-1 to 1e-8."""
    everything = not one and rng.random() < 0.25
    asked = None if everything else str(rng.choice(list(names)))
    return {"quantity": asked, "rtol": float(10 ** rng.uniform(-8, -1))}


def true_error(case, values, model, truer=TRUER):
    """Return the largest error of the values, by the measure of the case."""
    if case.scaled is None:
        circle = case.scene.indenter.shape == "circle"
        truth = from_definitions(case.scene) if circle else enclosed(case.scene)
        return max(reference.relative_error(values[name], truth[name]) for name in case.names)
    truth, measures = series_truth(case, model, truer), scales(StaticState.of(case.scene))
    worst = 0.0
    for name in case.names:
        value, right = np.nan_to_num(np.array([values[name], truth[name]]))
        worst = max(worst, float(np.max(np.abs(value - right))) / measures[name])
    return worst


def enclosed(scene):
    """Return the steady quantities of a parabola, a power law, a wedge or a ball, in ball arithmetic."""
    shape, f, support = scene.indenter, scene.foundation, scene.support
    truth, given = {
        "parabola": lambda: (reference.parabola, (shape.radius,)),
        "sphere": lambda: (reference.ball, (shape.radius, shape.radius_across or shape.radius)),
        "wedge": lambda: (reference.power_law, (shape.inclination, 1.0, 1.0)),
        "power-law": lambda: (reference.power_law, (1.0, shape.length, shape.exponent)),
    }[shape.shape]()
    given = *given, f.stiffness, f.retardation_time, scene.drive.velocity
    if isinstance(support, kv.Fixed):
        return truth.at_depth(*given, support.depth)
    return truth.at_load(*given, support.weight, getattr(support, "stiffness", 0.0))


def from_definitions(scene):
    """Return those of a circle from p = K (delta - h - l_r h'), W = int p dx, F = -int h' p dx."""
    h, slope, K = scene.indenter.height, scene.indenter.slope, scene.foundation.stiffness
    l_r = scene.drive.velocity * scene.foundation.retardation_time

    def integrals(delta):
        half = math.sqrt(delta * (2.0 * scene.indenter.radius - delta))
        trailing = brentq(
            lambda x: delta - h(x) - l_r * slope(x), 0.0, half, xtol=1e-300, rtol=1e-15
        )
        x = -half + (half + trailing) * NODES
        p = K * (half + trailing) * WEIGHTS * (delta - h(x) - l_r * slope(x))
        return p.sum(), -(slope(x) * p).sum()

    delta = scene.support.depth
    if delta is None:
        weight = scene.support.weight
        delta = brentq(lambda d: integrals(d)[0] - weight, 1e-9, 0.5, xtol=1e-18, rtol=1e-14)
    load, friction = integrals(delta)
    return {
        "depth": delta, "load": load, "friction_force": friction,
        "friction_coefficient": friction / load,
    }  # fmt: skip


def series_truth(case, model, truer=TRUER):
    """Return a series by a method that shares nothing with the model that answered.

    Where no such method gets to the end, the continuum with a far smaller tolerance stands in.
    """
    scaled, tolerance = case.scaled, max(truer * case.request["rtol"], 1e-12)
    if model != "slow manifold":
        try:
            if case.kind == "start" and scaled.epsilon is not None:
                with suppress(ValueError):  # it needs memory
                    return _in_si(case, transient_reference.two_states(scaled, tolerance))
            # with an explicit method: not where the inertia is next to nothing
            if scaled.epsilon is None or scaled.epsilon >= LEAST_INERTIA:
                past = transient_history.history(scaled, tolerance, LONGEST_STEP)
                return _in_si(case, past)
        except ArithmeticError:
            pass
    found = kv.transient(case.scene, at=case.request["at"], rtol=max(0.1 * tolerance, 1e-12))
    return {name: getattr(found, name) for name in SOLVED}


def _in_si(case, found):
    """Put the scaled solution for a positive first velocity into the units and signs of the scene."""
    side = math.copysign(1.0, case.scene.drive.points[0][1])
    left, right = found["left"], found["right"]
    drive = case.scaled.drive
    numbers = np.array([[n for s, n in drive if s <= time][-1] for time in case.scaled.times])
    leads = numbers >= 0.0  # whether the left edge leads; at rest, as it did before
    d, v = found["d"], found["v"]
    top = np.clip(-numbers, left, right)
    p = np.nan_to_num(d + v - top * (top + 2 * numbers))
    measures = scales(StaticState.of(case.scene))
    scaled = {
        "depth": d, "depth_rate": v, "normal_force": found["f_z"], "friction_force": side * found["f_x"],
        "leading_edge": side * np.where(leads, left, right),
        "trailing_edge": side * np.where(leads, right, left),
        "peak_pressure": np.maximum(p, 0.0),
    }  # fmt: skip
    return {name: value * measures[name] for name, value in scaled.items()}


def cheaper_would_do(case, model):
    """Whether a cheaper rung than the one that answered was within the tolerance after all."""
    if case.kind in ("steady", "other shape") and model != "asymptote":
        if case.scene.indenter.shape == "circle":
            return False
        regimes = ("low", "high") if case.scene.drive.velocity else ("low",)
        return any(
            true_error(case, asymptote.values(case.scene, regime, case.names), "asymptote")
            <= case.request["rtol"]
            for regime in regimes
        )
    moving = case.kind == "start" and case.scaled.epsilon is not None
    if not (moving and model == "continuum"):
        return False
    try:
        given = slow_start.start(case.scaled.drive[0][1], case.scaled.epsilon, case.scaled.kappa)
        times = np.array(case.scaled.times)
        found = slow_motion.follow(given, times, case.request["rtol"]).values
    except ArithmeticError:
        return False
    side, measures = np.sign(case.scene.drive.velocity), scales(StaticState.of(case.scene))
    values = {
        name: (side if name in ODD else 1.0) * measures[name] * found[name] for name in case.names
    }
    return true_error(case, values, "slow manifold") <= case.request["rtol"]
