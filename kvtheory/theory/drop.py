r"""A drop on a Kelvin-Voigt foundation, without gravity and sliding: one number decides it (fact F32).

M, R, K, tau; v speed in; D with K sqrt(2 R) D^(5/2) = M v^2 (of a ball pi K R' D^3 = M v^2, R' the geometric
mean of its radii), eta = tau v/D. With depths in units of D, times in D/v and the elastic force f = (4/3)
d^(3/2) (ball: d^2) in M v^2/D, both ways obey

    d' = y - eta f,    y' = -f,

going in from d = 0, y = 1 until d' = 0; coming out, with d for delta + tau delta', from there with y = 0
until d = 0, where y = -e. The force is f + eta f' d' going in, and f coming out.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

FACTOR = {True: (4.0 / 3.0, 1.5), False: (1.0, 2.0)}
"""The elastic force: its factor and power, of a line contact (True) and of a ball."""
RTOL, ATOL = 1e-11, 1e-14
LARGEST, MOST = 1e3, 100.0
"""Largest eta, with a restitution of 8e-6, and the largest that is found from a restitution: 4e-4."""


class Drop(NamedTuple):
    """Speed out over speed in, time in contact over D/v, force and depth at most, over M v^2/D and D."""

    restitution: float
    contact_time: float
    peak_force: float
    peak_depth: float


@lru_cache(maxsize=256)
def drop(eta: float, *, line: bool) -> Drop:
    """Return the drop of one number eta = tau v/D, from 0 to `LARGEST`.

    >>> round(drop(0.2, line=True).restitution, 7), round(drop(0.2, line=False).restitution, 7)
    (0.7067313, 0.7129687)
    """
    from scipy.integrate import solve_ivp
    from scipy.optimize import minimize_scalar

    if not 0.0 <= eta <= LARGEST:
        raise ValueError(f"`eta` must be from 0 to {LARGEST:g}, got {eta!r}")
    factor, power = FACTOR[line]

    def rates(s: float, state: np.ndarray) -> tuple[float, float]:
        force = factor * max(state[0], 0.0) ** power
        return state[1] - eta * force, -force

    def turns(s: float, state: np.ndarray) -> float:
        return float(rates(s, state)[0])

    def parts(s: float, state: np.ndarray) -> float:
        return float(state[0]) if s > 0.0 else 1.0

    turns.terminal = parts.terminal = True  # type: ignore[attr-defined]
    turns.direction = parts.direction = -1.0  # type: ignore[attr-defined]
    how = {"method": "LSODA", "rtol": RTOL, "atol": ATOL, "dense_output": True}
    end = 1e3 * (1.0 + eta)
    inward = solve_ivp(rates, (0.0, end), (0.0, 1.0), events=turns, **how)
    top = float(inward.y[0, -1])
    outward = solve_ivp(rates, (0.0, end), (top, 0.0), events=parts, **how)

    def pressed(s: float) -> float:
        d, y = inward.sol(s)
        d = max(d, 0.0)
        force, slope = factor * d**power, factor * power * d ** (power - 1.0)
        return float(force + eta * slope * (y - eta * force))

    s = inward.t
    best = int(np.argmax([pressed(each) for each in s]))
    around = s[max(best - 1, 0)], s[min(best + 1, s.size - 1)]
    peak = minimize_scalar(lambda each: -pressed(each), bounds=around, options={"xatol": 1e-12})
    force, speed = max(-float(peak.fun), pressed(s[best])), -float(outward.y[1, -1])
    return Drop(min(speed, 1.0), float(s[-1] + outward.t[-1]), force, top)


def number_of(restitution: float, *, line: bool) -> float:
    """Return eta of a restitution between 0 and 1, which falls with eta.

    >>> round(number_of(drop(0.3, line=True).restitution, line=True), 9)
    0.3
    """
    from scipy.optimize import brentq

    least = drop(MOST, line=line).restitution
    if not least <= restitution < 1.0:
        raise ValueError(f"expected a restitution from {least:.2g} to below 1, got {restitution!r}")
    small = (1.0 - restitution) * 1e-2

    def off(log: float) -> float:
        return drop(math.exp(log), line=line).restitution - restitution

    return math.exp(brentq(off, math.log(small), math.log(MOST), xtol=1e-13, rtol=1e-13))
