"""Naive implementations: for comparison in the charts, and for the failures of the atlas.

None of them uses the methods of the package. Scaled form: depths by delta_0, time by tau, lengths by
a_0, forces by W_0 (f_x by W_0 delta_0/a_0).
"""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from kvtheory.scene import DeadWeight, Drive, Foundation, Parabola, Run, Scene

Array = NDArray[np.float64]
Law = Callable[[float, Any], tuple[float, ...]]
Piece = tuple[float, float, Any]
"""Start, end, and lambda between them: a number, or a function of s."""

LOAD = 4.0 / 3.0
"""Static load (N/m) of a scaled scene, and its unit of both forces."""


@dataclass(frozen=True)
class Outcome:
    """The numbers of a failure in SI, NaN or infinite without a result, and its curves."""

    wrong: float
    right: float  # by a formula or a method that shares no code with that of `package`
    package: float
    naive: tuple[Array, Array]  # x and y
    ours: tuple[Array, Array]
    said: str = ""  # the message of the package

    def __post_init__(self) -> None:
        for name in ("wrong", "right", "package"):  # may be NumPy scalars
            object.__setattr__(self, name, float(getattr(self, name)))


def scaled_scene(pieces: Sequence[Piece], epsilon: float) -> Scene:
    """Return a dead weight with R = 1/2 and K = tau = delta_0 = 1, hence a_0 = 1, driven by lambda(s)."""
    history = [(s, number) for start, end, number in pieces for s in (start, end)]
    drive = Drive(history=history) if len(pieces) > 1 else Drive(velocity=pieces[0][2])
    support = DeadWeight(LOAD * epsilon, 1.0 / epsilon)
    return Scene(Parabola(0.5), Foundation(1.0, 1.0), support, drive, Run(pieces[-1][1]))


def closed_forms(d: float, v: float, number: float) -> tuple[float, float]:
    """Return f_z and f_x with the edges of Eqs. 32 and 33 as written, without memory; radicands >= 0."""
    speed = abs(number)
    l, r = -math.sqrt(max(d, 0.0)), math.sqrt(max(d + v + speed * speed, 0.0)) - speed
    mean = d + v
    l2, r2 = l * l, r * r
    l3, r3 = l2 * l, r2 * r
    f_z = 0.75 * (mean * (r - l) - (r3 - l3) / 3.0 - speed * (r2 - l2))
    moment = 0.5 * mean * (r2 - l2) - 0.25 * (r3 * r - l3 * l) - speed * (r3 - l3) / 1.5
    return f_z, math.copysign(1.5, number) * -moment


def two_states(number: float | Callable[[float], float], epsilon: float, kappa: float = 0.0) -> Law:
    """Return d' and d'' as a function of s and (d, d'): the equation of motion with `closed_forms`."""
    rate = number if callable(number) else lambda _: number

    def law(s: float, y: Sequence[float]) -> tuple[float, float]:
        d, v = y
        return v, (1.0 - closed_forms(d, v, rate(s))[0] - kappa * (d - 1.0)) / epsilon

    return law


def solve_by_scipy(
    law: Law, ends: tuple[float, float], y: Any, s: Array, method: str, rtol: float
) -> tuple[Array, int]:
    """Return the states at the instants and at the end by `solve_ivp`, and the evaluations."""
    tolerances = {"rtol": max(rtol, 3e-14), "atol": 0.01 * rtol}
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of LSODA: its message says the same
        try:
            run = solve_ivp(law, ends, y, method, dense_output=True, **tolerances)
        except (ValueError, OverflowError) as error:  # from numbers that are not finite
            raise ArithmeticError(str(error)) from None
    if not run.success:
        raise ArithmeticError(run.message)
    return np.column_stack([run.sol(s), run.y[:, -1]]), run.nfev


def without_memory(
    pieces: Iterable[Piece], s: Array, law_of: Callable[[Any], Law], method: str, rtol: float,
    solve: Callable[..., tuple[Array, int]] = solve_by_scipy, start: Sequence[float] = (1.0, 0.0),
) -> tuple[Array, int]:  # fmt: skip
    """Return d, f_z and f_x by the two states, restarted at each jump, and the number of evaluations."""
    y, rows, evaluations, pieces = np.array(start), [], 0, list(pieces)
    for a, b, number in pieces:
        inside = s[(s >= a) & ((s < b) | (b == pieces[-1][1]))]
        values, count = solve(law_of(number), (a, b), y, inside, method, rtol)
        y, evaluations = values[:, -1], evaluations + count
        for x, d, v in zip(inside.tolist(), *values[:, :-1].tolist(), strict=True):
            rows.append((d, *closed_forms(d, v, number(x) if callable(number) else number)))
    return np.array(rows).T, evaluations


def stale_elements(scene: Scene, per_length: float) -> tuple[Array, Array]:
    """Return t (s) and depth (m) by the paper's scheme, with contact judged by surfaces of the last step."""
    R: float = scene.indenter.radius  # type: ignore[union-attr]
    K, tau = scene.foundation.stiffness, scene.foundation.retardation_time
    M, W, V = scene.support.mass, scene.support.weight, scene.drive.final_velocity
    dx = 1.0 / per_length
    h = 2.0 * dx / V
    d, v = (1.5 * R * W / K) ** (2.0 / 3.0) / (2.0 * R), 0.0
    half = math.ceil(1.5 * math.sqrt(2.0 * R * d) / dx)
    x = dx * np.arange(-half, half + 1)
    height, u = x * x / (2.0 * R), np.maximum(d - x * x / (2.0 * R), 0.0)

    def pressure(d: float, v: float, surface: Array) -> Array:
        p = K * (d - height) + K * tau * (v - V * x / R)
        return np.where((d - height >= surface) & (p > 0.0), p, 0.0)

    def pull(d: float, v: float) -> float:
        return (W - dx * float(pressure(d, v, u).sum())) / M

    time, depth = [0.0], [d]
    for k in range(round(scene.run.duration / h)):
        a1 = pull(d, v)
        a2 = pull(d + 0.5 * h * v, v + 0.5 * h * a1)
        a3 = pull(d + 0.5 * h * v + 0.25 * h * h * a1, v + 0.5 * h * a2)
        a4 = pull(d + h * v + 0.5 * h * h * a2, v + h * a3)
        d, v = d + h * v + h * h * (a1 + a2 + a3) / 6.0, v + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6.0
        # Two elements pass per step.
        free = np.concatenate([np.zeros(2), u[:-2]]) * math.exp(-h / tau)
        u = np.where(pressure(d, v, free) > 0.0, d - height, free)
        time.append((k + 1) * h)
        depth.append(d)
    return np.array(time), np.array(depth)
