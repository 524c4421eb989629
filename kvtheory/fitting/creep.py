r"""Creep compliance and relaxation modulus from each other, exactly, by the spectra of both.

A compliance J = J_0 + sum J_k (1 - e^(-t r_k)) + phi t with non-negative J_k is the response s L[J] = J_0 +
sum J_k r_k/(s + r_k) + phi/s to e^(st). Its zeros s = -x lie one between two neighbours of the rates r_k:
they are the rates of the modulus E = 1/(s L[J]), whose arms E_i = 1/(x_i |d(s L[J])/ds|) are positive. The
way back is the same. So noise in J is not amplified, as it is where the convolution of both is inverted.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq, nnls

from kvtheory.fitting.spectrum import Array, Series, rms

PER_DECADE, BEYOND = 24, 0.5
"""Retardation times per decade, and decades by which they lie beyond the data."""
LEAST = 1e-4
"""Smallest instant compliance, over the least that is measured: its arms relax before the data begin."""
INSIDE = 1e-12
"""Relative distance from a pole at which the search for a zero begins."""


def relaxing(t: Array, J: Array) -> tuple[Array, float]:
    """Return the relaxation modulus at times (s), and the misfit (RMS, relative) of the compliance."""
    seen = t[t > 0.0]
    low, high = np.log10(seen[[0, -1]]) + BEYOND * np.array([-1.0, 1.0])
    rates = 10.0 ** -np.arange(low, high, 1.0 / PER_DECADE)
    columns = np.column_stack([np.ones_like(t), t / seen[-1], -np.expm1(-np.outer(t, rates))])
    held, norm = nnls(columns / J[:, None], np.ones_like(J), maxiter=30 * (rates.size + 10))
    instant, flow = max(float(held[0]), LEAST * float(J.min())), float(held[1]) / seen[-1]
    kept = held[2:] > 0.0
    return _relaxing(instant, flow, held[2:][kept], rates[kept], t), float(norm) / t.size**0.5


def _relaxing(instant: float, flow: float, J: Array, rates: Array, t: Array) -> Array:
    order = np.argsort(rates)
    J, r = J[order], rates[order]

    def response(x: float) -> float:
        return instant + float((J * r / (r - x)).sum()) - flow / x

    last = 2.0 * (float(r[-1]) if r.size else 0.0) + 2.0 * (float(J @ r) + flow) / instant
    ends = np.concatenate([[0.0] if flow else [], r, [last]])
    x = _zeros(response, ends)
    slope = (J * r / (r - x[:, None]) ** 2).sum(axis=1) + flow / x**2
    relaxed = 0.0 if flow else 1.0 / (instant + float(J.sum()))
    return np.asarray(relaxed + np.exp(-np.outer(t, x)) @ (1.0 / (x * slope)))


def compliance(series: Series, t: Array) -> Array:
    """Return the creep compliance of a Prony series at times (s)."""
    E, r = series.modulus[::-1], 1.0 / series.time[::-1]

    def response(x: float) -> float:
        return -series.relaxed - float((E * x / (x - r)).sum())

    x = _zeros(response, np.append(0.0, r))
    slope = (E * r / (r - x[:, None]) ** 2).sum(axis=1)
    return np.asarray(1.0 / series.relaxed - np.exp(-np.outer(t, x)) @ (1.0 / (x * slope)))


def _zeros(response: Callable[[float], float], ends: Array) -> Array:
    """Return the zero of a rising function between each two of its poles."""
    found = []
    for low, high in pairwise(ends.tolist()):
        a, b = max(low * (1.0 + INSIDE), high * 1e-30), high * (1.0 - INSIDE)
        if response(a) >= 0.0 or response(b) <= 0.0:  # too near a pole, as its term is small
            found.append(a if response(a) >= 0.0 else b)
            continue
        found.append(brentq(response, a, b, xtol=1e-300, rtol=1e-13, maxiter=500))
    return np.array(found)


def misfit(series: Series, t: Array, J: Array) -> float:
    """Return the relative misfit (RMS) of the compliance of a series."""
    return rms(compliance(series, t) / J - 1.0)
