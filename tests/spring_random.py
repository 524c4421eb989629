"""Scenes of the reference tables, random ones on a spring, and how well motions keep the balances."""

import math
from dataclasses import dataclass

import numpy as np

import kvtheory as kv
from kvtheory.models.continuum.energy import ledger
from kvtheory.models.continuum.run import Spring
from kvtheory.models.continuum.solver import Trajectory, solve
from kvtheory.models.continuum.surface import integrals
from kvtheory.scene.base_motion import BaseMotion

SWINGS = 30
"""That a run takes at most, along x."""


def of_unit_scales(eps, kappa, drive, end=1.0, *, ball=False):
    """Return the scene whose scales R, K and tau make 1: its SI numbers are the scaled ones."""
    support = kv.DeadWeight(mass=eps, gravity=1 / eps)
    if math.isinf(kappa):
        support = kv.Fixed(1.0)
    elif kappa > 0.0:
        support = kv.Suspended(mass=eps, stiffness=kappa, gravity=1 / eps)
    shape, K = (kv.Sphere(0.5), 2.0 / math.pi) if ball else (kv.Parabola(0.5), 0.75)
    return kv.Scene(shape, kv.Foundation(K, 1.0), support, drive, kv.Run(end))


def solved(given, rtol=1e-9):
    """Follow a scene of the reference tables (`tests.transient_history.Scene`)."""
    end, kappa = given.times[-1], math.inf if given.epsilon is None else given.kappa
    if isinstance(given.drive, list):
        drive = BaseMotion.from_points(given.drive, end)
    else:
        drive = BaseMotion.from_function(swing(**given.drive), end)
    spring = given.inertia and Spring(given.inertia, given.damping, given.stiffness)
    return solve(drive, given.epsilon or 1.0, kappa, end, rtol, spring=spring)


def in_si(given):
    """Return such a scene in SI."""
    drive = {"stiffness": given.stiffness, "damping": given.damping, "mass": given.inertia}
    drive = drive if given.inertia else {}
    listed = isinstance(given.drive, list)
    drive |= {"history": given.drive} if listed else {"function": swing(**given.drive)}
    kappa = math.inf if given.epsilon is None else given.kappa
    return of_unit_scales(given.epsilon or 1.0, kappa, kv.Drive(**drive), given.times[-1])


def swing(mean, amplitude, frequency):
    return lambda s: mean + amplitude * math.cos(frequency * s)


@dataclass(frozen=True)
class Case:
    """A scene in scaled form."""

    history: tuple[tuple[float, float], ...]
    eps: float
    kappa: float
    spring: Spring
    end: float

    @property
    def times(self):
        """Return times away from the jumps."""
        return np.linspace(0.0, self.end, 20)[1:-1] + 1e-3 * self.end

    def solved(self, rtol, *, fast=None) -> Trajectory:
        """Follow it."""
        given = BaseMotion.from_points(self.history, self.end)
        return solve(given, self.eps, self.kappa, self.end, rtol, spring=self.spring, fast=fast)

    def scene(self):
        """Return it in SI."""
        mass, damping, stiffness = self.spring
        drive = kv.Drive(history=self.history, stiffness=stiffness, damping=damping, mass=mass)
        return of_unit_scales(self.eps, self.kappa, drive, self.end)


def random_case(seed, sign=1):
    """Draw lambda, eps, eps_x, kappa_x and c_x over decades: starts, stops, reversals and ramps."""
    rng = np.random.default_rng(seed)
    number, eps = sign * 10 ** rng.uniform(-1, 1.5), 10 ** rng.uniform(-3, 1)
    spring = Spring(
        10 ** rng.uniform(-2.5, 1),
        float(rng.choice([0.0, 10 ** rng.uniform(-3, 0)])),
        10 ** rng.uniform(-2, 2),
    )
    kappa = float(rng.choice([0.0, 0.0, 10 ** rng.uniform(-1, 2), math.inf]))
    end = min(6.0, 1.0 + 2 * math.pi * SWINGS * math.sqrt(spring.eps / spring.stiffness))
    jump = end * rng.uniform(0.2, 0.6)
    history = (
        ((0.0, number),),
        ((0.0, number), (jump, number), (jump, 0.0)),
        ((0.0, number), (jump, number), (jump, -number)),
        ((0.0, 0.0), (jump, number)),
    )[seed % 4]
    return Case(history, eps, kappa, spring, end)


def balances(motion):
    """Return by how much energy and both impulses do not balance at four times, over what was turned over."""
    times = np.linspace(0.0, motion.end, 5)[1:]
    given, states = motion.given, motion.states(times)
    books = ledger(motion, times)
    starts = np.array(motion.starts)

    def impulse(*names):
        def force(_, s):
            found = motion.states(s.reshape(-1))
            return np.stack([found[name] for name in names], axis=-1).reshape(*s.shape, len(names))

        index = np.searchsorted(starts, times, side="right") - 1
        whole = integrals(force, starts, np.append(starts[1:], motion.end))
        last = integrals(force, starts[index], times)
        return np.array([whole[:k].sum(axis=0) + part for k, part in zip(index, last, strict=True)])

    f_z, f_x, f_s, d = impulse("normal_force", "friction_force", "spring_force", "depth").T
    along = given.eps_x * states["offset_rate"] - (f_x - f_s)
    up = given.eps * states["depth_rate"] - (times - f_z - given.kappa * (d - times))
    up = 0.0 * times if given.fixed else up
    rates = np.array([states[name] for name in ("depth_rate", "sliding_velocity")])
    size = 1.0 + np.abs(rates).max() + np.abs(f_x) + np.abs(f_z)
    turned_over = 1.0 + np.abs(books.work) + books.kinetic_along
    eps = 0.0 if given.fixed else given.eps
    return {
        "energy": float(np.max(np.abs(books.balance) / turned_over)),
        "impulse along x": float(np.max(np.abs(along) / (size * max(1.0, given.eps_x)))),
        "impulse along z": float(np.max(np.abs(up) / (size * (1.0 + eps)))),
    }
