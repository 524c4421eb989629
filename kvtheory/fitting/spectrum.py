r"""A Prony series from moduli: the best non-negative spectrum, and the fewest arms that are as good.

The moduli are linear in the spectrum, E = E_0 + sum E_i k(tau_i), with k = z^2/(1 + z^2) for the storage
and z/(1 + z^2) for the loss modulus, z = omega tau, or e^(-t/tau) for relaxation. Over all spectra E_i >= 0
the sum of squared relative residuals is convex: non-negative least squares (NNLS) on a fine grid of
relaxation times finds its minimum. With the residual r and unit data, D(tau) = k(tau) . r is then nowhere
positive; where it is by up to kappa k(tau) . 1, lambda = r - kappa 1 is admissible in the dual problem, and

    misfit^2 n >= 2 lambda . 1 - lambda . lambda    (dual bound)

for every series with any number of arms (`dual`). NNLS gathers the spectrum in few clusters. They become
arms, refined by bounded least squares; then the pair whose merger costs least becomes one arm, again and
again.
"""

from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]

PER_DECADE, FINER = 6, 8
"""Relaxation times of the grid per decade, and how many times finer that of the dual function is."""
CLOSE = 0.125
"""Decades up to which neighbouring times of a spectrum are one arm."""
BEYOND = 0.5
"""Decades by which relaxation times may lie beyond the data, where an arm still changes them."""
ROUNDS = 3
"""Times that points are added to the grid."""
FAR = 4.0
"""Decades beyond the data over which the dual function is evaluated; from there on it keeps its sign."""
LEAST_LOSS = 0.01
"""Smallest scale of a loss modulus, over |E*|: below it, its relative error says nothing."""
TRIED, FEW_STEPS = 3, 8
"""Pairs of arms whose merger is tried, and steps of the refinement until the number of arms is found."""
SPARE = 8
"""Arms beyond a given number down to which pairs are merged without trying others."""
MOST_POINTS = 1200
"""Most points that are fitted; more are averaged over equal steps of the logarithm."""
FINEST = 1e-4
"""Misfit below which more arms are never needed: no instrument is as accurate."""
SOLVED, MOST_STEPS, MOST_DAMPING = 1e-9, 60, 1e6
"""Gain of a step of the refinement at which it ends, its most steps, and its damping where none gains."""
RIDGE = 1e-12
"""Relative change of a diagonal that keeps normal equations solvable."""


@dataclass(frozen=True)
class Moduli:
    """Moduli over the angular frequency in rad/s (rows storage and loss), or over time in s (one row)."""

    x: Array
    values: Array

    @property
    def dynamic(self) -> bool:
        """Whether they are dynamic moduli."""
        return len(self.values) == 2

    @cached_property
    def scale(self) -> Array:
        """What residuals are relative to: the value; of a loss modulus at least a part of |E*|."""
        size = np.abs(self.values)
        return np.maximum(size, LEAST_LOSS * np.hypot.reduce(self.values, axis=0))

    @cached_property
    def times(self) -> tuple[float, float]:
        """The shortest and the longest time that they cover, in s."""
        seen = self.x[self.x > 0.0]
        ends = np.array([seen.min(), seen.max()])
        return tuple(np.sort(1.0 / ends if self.dynamic else ends).tolist())

    @cached_property
    def thinned(self) -> "Moduli":
        """The data, averaged over equal steps of log x if they are many."""
        order = np.argsort(self.x, kind="stable")
        x, values = self.x[order], self.values[:, order]
        if x.size <= MOST_POINTS:
            return Moduli(x, values)
        first = int(np.count_nonzero(x == 0.0))
        if first:  # relaxation from its start
            rest = Moduli(x[first:], values[:, first:]).thinned
            start = values[:, :first].mean(axis=1, keepdims=True)
            return Moduli(np.append(0.0, rest.x), np.concatenate([start, rest.values], axis=1))
        edges = np.geomspace(x[0], x[-1], MOST_POINTS + 1)
        starts = np.unique(np.searchsorted(x, edges[:-1]))
        count = np.diff(np.append(starts, x.size))
        mean = np.add.reduceat(values, starts, axis=1) / count
        return Moduli(np.exp(np.add.reduceat(np.log(x), starts) / count), mean)

    def kernel(self, tau: Array) -> Array:
        """Return the moduli of unit arms in columns, in the scale of the data; a spring has the time inf."""
        if self.dynamic:
            s = 1.0 / (self.x[:, None] * tau)
            storage = 1.0 / (1.0 + s * s)
            rows = np.stack([storage, s * storage])
        else:
            rows = np.exp(self.x[:, None] / -tau)[None]
        return (rows / self.scale[..., None]).reshape(-1, np.size(tau))

    def slopes(self, tau: Array) -> Array:
        """Return the derivatives of `kernel` by ln tau."""
        z = self.x[:, None] * tau if self.dynamic else self.x[:, None] / tau
        if self.dynamic:
            q = 1.0 / (1.0 + z * z)
            rows = np.stack([2.0 * (z * q) ** 2, z * (1.0 - z * z) * q * q])
        else:
            rows = (z * np.exp(-z))[None]
        return (rows / self.scale[..., None]).reshape(-1, tau.size)

    @cached_property
    def fine(self) -> tuple[Array, Array]:
        """The times of a spring and of a fine grid, and the `kernel` there."""
        times = np.append(np.inf, grid(self, FAR, PER_DECADE * FINER))
        return times, self.kernel(times)

    @cached_property
    def target(self) -> Array:
        """The data in their own scale."""
        return (self.values / self.scale).reshape(-1)


@dataclass(frozen=True)
class Series:
    """A Prony series fitted to moduli: the relaxed modulus, and the arms by increasing relaxation time."""

    relaxed: float
    modulus: Array
    time: Array

    def residuals(self, data: Moduli) -> Array:
        """Return fit minus data, in the scale of the data, in the shape of the data."""
        arms = data.kernel(np.append(np.inf, self.time))
        own = np.einsum("ij,j->i", arms, np.append(self.relaxed, self.modulus))
        return (own - data.target).reshape(data.values.shape)

    def misfit(self, data: Moduli) -> float:
        """Return the root mean square of the relative residuals."""
        return rms(self.residuals(data))

    def values(self, x: Array, *, dynamic: bool) -> Array:
        """Return the moduli of the series at frequencies or times."""
        unit = Moduli(x, np.ones((2 if dynamic else 1, x.size)))
        return self.residuals(unit) * unit.scale + unit.values


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values * values)))


def grid(data: Moduli, beyond: float, per_decade: int) -> Array:
    """Return relaxation times at equal steps of the logarithm."""
    low, high = np.log10(data.times)
    return np.logspace(low - beyond, high + beyond, 2 + int((high - low + 2 * beyond) * per_decade))


def solved(data: Moduli, time: Array) -> Series:
    """Return the series of least misfit with arms of these times, by NNLS."""
    return _solved(data, time)[1]


def _solved(data: Moduli, time: Array) -> tuple[float, Series]:
    """Return the norm of the residuals too."""
    held, norm = nnls(data.kernel(np.append(np.inf, time)), data.target, maxiter=_steps(time))
    return norm, _series(held, time)


def _steps(time: Array) -> int:
    return 30 * (time.size + 10)


def _series(held: Array, time: Array) -> Series:
    """Return the series of a spring and arms, by increasing time, without those that are zero."""
    order = np.argsort(time)
    order = order[held[1:][order] > 0.0]
    return Series(float(held[0]), held[1:][order], time[order])


def dual(data: Moduli, series: Series) -> tuple[float, Array]:
    """Return the dual bound, below which no misfit of any series is, and the times of arms that help."""
    times, arms = data.fine
    r, one = -series.residuals(data).reshape(-1), np.abs(data.target)
    slope, size = (np.einsum("ij,i->j", arms, each) for each in (r, one))
    ratio = slope[size > 0.0] / size[size > 0.0]
    bend = np.abs(np.diff(ratio[1:], 2))  # between points, a maximum is higher by an eighth of it
    kappa = max(float(ratio.max()), float((ratio[2:-1] + 0.25 * bend).max()), 0.0)
    rest = r - kappa * one
    bound = float(2.0 * rest @ data.target - rest @ rest)
    peaks = 1 + np.flatnonzero(
        (slope[1:-1] > np.maximum(slope[:-2], slope[2:])) & (slope[1:-1] > 0.0)
    )
    return float(np.sqrt(max(bound, 0.0) / one.size)), times[peaks]


def best(data: Moduli) -> tuple[Series, float]:
    """Return the best non-negative spectrum, on a grid refined where arms help, and the dual bound."""
    spectrum, least = solved(data, grid(data, FAR, PER_DECADE)), 0.0
    for _ in range(ROUNDS):
        bound, more = dual(data, spectrum)
        least = max(least, bound)
        spectrum = solved(data, np.union1d(spectrum.time, more))
    return spectrum, max(least, dual(data, spectrum)[0])


def clustered(data: Moduli, spectrum: Series) -> Series:
    """Return a spectrum of times that the data tell, with neighbours that are close gathered into one arm."""
    low, high = np.array(data.times) * 10.0 ** np.array([-BEYOND, BEYOND])
    own = solved(data, np.unique(np.clip(spectrum.time, low, high)))
    return _gathered(own, np.diff(np.log10(own.time)) <= CLOSE) if own.time.size else own


def _gathered(series: Series, joined: NDArray[np.bool_]) -> Series:
    """Return a series in which each arm is one with the next one where these are `joined`."""
    first = np.flatnonzero(np.append(True, ~joined))
    modulus = np.add.reduceat(series.modulus, first)
    mean = np.add.reduceat(series.modulus * np.log(series.time), first) / modulus
    return Series(series.relaxed, modulus, np.exp(mean))


def fewer(data: Moduli, series: Series, steps: int = FEW_STEPS) -> Series:
    """Return the best series with one arm less: two neighbours as one, or the slowest one in the spring."""
    cost, tau = _merging_costs(data, series), series.time
    merged = [_gathered(series, np.arange(cost.size) == i).time for i in np.argsort(cost)[:TRIED]]
    found = min((_solved(data, times) for times in [*merged, tau[:-1], tau[1:]]), key=itemgetter(0))
    return refined(data, found[1], steps)


def _merging_costs(data: Moduli, series: Series) -> Array:
    """Return the sum of squares by which the moduli change where a pair of neighbours becomes one arm."""
    E, tau = series.modulus, series.time
    both = E[:-1] + E[1:]
    mean = np.exp((E[:-1] * np.log(tau[:-1]) + E[1:] * np.log(tau[1:])) / both)
    own, merged = data.kernel(tau) * E, data.kernel(mean) * both
    return np.asarray(((own[:, :-1] + own[:, 1:] - merged) ** 2).sum(axis=0))


def arms_of(data: Moduli, start: Series, count: int | None, target: float) -> Series:
    """Return the series of the fewest arms with a misfit of at most `target`, or of at most `count` arms."""
    kept = start
    while count is not None and (excess := kept.time.size - count - SPARE) > 0:
        cost = _merging_costs(data, kept)
        around = np.pad(cost, 1, constant_values=np.inf)
        least = np.flatnonzero((cost <= around[2:]) & (cost < around[:-2]))  # these share no arm
        least = least[np.argsort(cost[least])[:excess]]
        kept = _gathered(kept, np.isin(np.arange(cost.size), least))
    while kept.time.size > max(count or 1, 1):
        less = fewer(data, kept, FEW_STEPS if count is None else 0)
        if count is None and less.misfit(data) > target:
            polished = refined(data, less)
            if polished.misfit(data) > target:
                break
            less = polished
        kept = less
    return refined(data, kept)


def refined(data: Moduli, series: Series, steps: int = MOST_STEPS) -> Series:
    """Return the series after variable projection: least squares in ln of its times, NNLS for moduli."""
    if not (steps and series.time.size):
        return series
    low, high = np.log(data.times) + np.log(10.0) * BEYOND * np.array([-1.0, 1.0])
    y, damping = np.clip(np.log(series.time), low, high), 1e-3

    def solve(y: Array) -> tuple[Array, Array, Array, float]:
        kernel = data.kernel(np.append(np.inf, np.exp(y)))
        held, norm = nnls(kernel, data.target, maxiter=_steps(y))
        return kernel, held, np.einsum("ij,j->i", kernel, held) - data.target, norm

    kernel, held, r, norm = solve(y)
    for _ in range(steps):
        rows, basis = data.slopes(np.exp(y)) * held[1:], kernel[:, held > 0.0]
        own = np.einsum("ij,ik->jk", basis, basis)
        own[np.diag_indices_from(own)] *= 1.0 + RIDGE
        rows = rows - basis @ np.linalg.solve(own, np.einsum("ij,ik->jk", basis, rows))
        curve, slope = np.einsum("ij,ik->jk", rows, rows), np.einsum("ij,i->j", rows, r)
        size = np.maximum(np.diag(curve), RIDGE * max(curve.max(), np.finfo(float).tiny))
        tried = np.clip(y - np.linalg.solve(curve + damping * np.diag(size), slope), low, high)
        new = solve(tried)
        if new[3] < norm:
            gain = 1.0 - new[3] / norm
            y, (kernel, held, r, norm), damping = tried, new, 0.2 * damping
            if gain < SOLVED:
                break
        elif (damping := 5.0 * damping) > MOST_DAMPING:
            break
    result = _series(held, np.exp(y))
    return result if result.misfit(data) <= series.misfit(data) else series
