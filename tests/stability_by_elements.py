"""Growth of a small disturbance of steady sliding in a row of discrete elements, without any response e^(st).

``python -m tests.stability_by_elements`` compares both sides of eleven critical stiffnesses.
"""

import numpy as np
from scipy.optimize import minimize

import kvtheory as kv

CELLS, CYCLES, SMALL, STRIPS = 300, 8.0, 1e-4, 10
ZENER, TWO = [(5e10, 0.1)], [(3e10, 0.01), (5e9, 0.5)]
CASES = [
    ("line", ZENER, 0.05, 1000.0), ("line", ZENER, 0.05, 100.0), ("line", TWO, 0.2, 50.0),
    ("line", ZENER, 0.3, 30.0), ("line", [(5e10, 0.01)], 0.5, 10.0), ("line", [(2e11, 5e-3)], 0.091, 100.0),
    ("line", [(3e10, 0.02), (5e9, 0.2), (1e10, 0.005)], 0.2, 50.0), ("suspended", ZENER, 0.1, 100.0),
    ("ball", [(5e10, 0.05)], 0.1, 0.03), ("ball", [(3e10, 0.01), (5e9, 0.1)], 0.3, 0.01),
    ("ball", [(5e10, 0.01)], 0.5, 0.01),
]  # fmt: skip
"""Kind, arms, velocity, and the mass in both directions."""


def scene_of(kind, arms, velocity, mass):
    """Return a scene on a soft spring."""
    load = 9.80665 if kind == "ball" else 9806.65
    support = kv.DeadWeight(mass=mass, load=load)
    if kind == "suspended":
        support = kv.Suspended(mass=mass, load=load, stiffness=2e7)
    shape = kv.Sphere(0.01) if kind == "ball" else kv.Parabola(0.01)
    drive = kv.Drive(velocity, stiffness=1e6, mass=mass)
    return kv.Scene(shape, kv.GeneralizedMaxwell(1e10, arms=arms), support, drive)


class Row:
    """Elements that slide below the indenter by one cell a step, each arm exact over a step."""

    def __init__(self, scene):
        state, self.R, self.K = kv.steady(scene), scene.indenter.radius, scene.foundation.stiffness
        self.drop, self.width = np.zeros((1, 1)), np.ones((1, 1))
        if not scene.indenter.per_width:
            angles, weights = (0.25 * np.pi * x for x in np.polynomial.legendre.leggauss(STRIPS))
            cosines = np.cos(0.25 * np.pi + angles)[:, None]
            self.drop = state.half_length**2 * (1.0 - cosines**2) / (2.0 * self.R)
            self.width = 2.0 * state.half_length * cosines * weights[:, None]
        self.dx = 2.16 * state.half_length / CELLS
        self.dt = self.dx / scene.drive.velocity
        self.x = self.dx * (np.arange(CELLS) + 0.5 - 0.5 * CELLS)
        times = np.array([arm.relaxation_time for arm in scene.foundation.arms])[:, None, None]
        stiffness = np.array([arm.stiffness for arm in scene.foundation.arms])[:, None, None]
        self.decay = np.exp(-self.dt / times)
        self.gain = stiffness * (1.0 - self.decay) * times / self.dt
        self.stress = np.zeros((len(times), len(self.drop), CELLS))
        self.u, self.touching, self.shift = np.zeros(self.stress.shape[1:]), False, 0.0

    def step(self, depth, moved):
        """Return load and friction force after the row has moved."""
        self.shift += moved
        if self.shift >= 0.5 * self.dx:
            self.shift -= self.dx
            for each in (self.stress, self.u, self.touching):
                each[...] = np.roll(each, 1, axis=-1)
                each[..., 0] = 0.0
        x = self.x + self.shift
        level = depth - self.drop - x * x / (2.0 * self.R)
        touching = self.touching | ((x < 0.0) & (level > 0.0))
        u = np.where(touching, level, 0.0)
        stress = self.decay * self.stress + self.gain * (u - self.u)
        p = self.K * u + stress.sum(axis=0)
        self.touching = touching & ~((p <= 0.0) & (x > 0.0))
        self.u, self.stress = u * self.touching, stress * self.touching
        p = self.width * self.dx * p * self.touching
        return p.sum(), -(p * x).sum() / self.R


def growth(scene, stiffness, rate):
    """Return growth and frequency in the row, in 1/s, of a disturbance whose expected rate is `rate`."""
    row, support, omega = Row(scene), scene.support, abs(rate.imag)
    rest, dt, step = kv.steady(scene).depth, row.dt, row.dx
    row.touching = np.zeros(row.u.shape, bool)
    for _ in range(int(2.2 * CELLS)):
        load, friction = row.step(rest, step)
    W, F, depth, X, down, along, found = load, friction, rest * (1.0 + SMALL), 0.0, 0.0, 0.0, []
    for _ in range(int(CYCLES * 2.0 * np.pi / omega / dt)):
        down += dt * (load - W - support.spring * (depth - rest)) / support.mass
        along += dt * (F - friction - stiffness * X) / scene.drive_mass
        depth, X = depth + dt * down, X + dt * along
        W, F = row.step(depth, step - dt * along)
        found.append(X)
    t, X = dt * np.arange(len(found)), np.array(found)
    t, X = t[t > 3.0 * np.pi / omega], X[t > 3.0 * np.pi / omega]
    slowest = max(arm.relaxation_time for arm in scene.foundation.arms)

    def misfit(pair):
        e, phase = np.exp(pair[0] * omega * t), pair[1] * omega * t
        base = np.stack([t**0, np.exp(-t / slowest), e * np.cos(phase), e * np.sin(phase)], axis=1)
        return np.linalg.norm(X - base @ np.linalg.lstsq(base, X, rcond=None)[0])

    options = {"xatol": 1e-7, "fatol": 1e-12 * np.linalg.norm(X)}
    starts = ((-0.02, 1.0), (0.02, 1.0))
    best = min((minimize(misfit, each, method="Nelder-Mead", options=options) for each in starts),
               key=lambda each: each.fun)  # fmt: skip
    return best.x * omega


def both(case, side):
    """Return the critical stiffness, and the rate at `side` times it by `kv.stability` and in the row."""
    scene = scene_of(*case)
    critical = kv.stability(scene, quantity="critical_stiffness").critical_stiffness
    over = {"drive.stiffness": side * critical}
    rate = complex(*kv.stability(scene, over=over, quantity="rates").rates[0])
    return critical, rate, complex(*growth(scene, side * critical, rate))


if __name__ == "__main__":
    for case in CASES:
        for side in (0.7, 1.4):
            print(*case, side, *both(case, side))
