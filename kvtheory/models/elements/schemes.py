"""One step in time, by name: each scheme moves the indenter and then its elements.

The indenter obeys M δ'' = W - k_s (δ - δ_0) - F_z (Eq. 17; a prime is d/dt). The schemes differ in how
F_z is summed over the elements and over the step.

`explicit` schemes are Runge-Kutta methods on F_z = dx Σ (K g + C g'), with the contact rules of the
paper (Eqs. 20-25): an element in contact detaches where its pressure would be negative, relaxes as
e^(-t/τ), and is in contact again where the indenter meets it. They are stable up to
dt C L/M = 2.785 (paper) or 2 (Euler), L the length of the contact.

`implicit` schemes rest on the exact memory u <- max(g, u e^(-h/τ)) (F8), which needs no rules. By it
the force, averaged over the step with the weight e^(t/τ), is

    F_z = K/(1 - e^(-h/τ)) Σ dx max(g - u e^(-h/τ), 0),

never negative, free of elements that are left alone, and convex in the depth at the end of the step,
which therefore is the one root of a monotone function. The depth advances with the mean velocity
(1-θ) v_0 + θ v_1. With θ = 1 the damping is that of the backward Euler method; with the exponential
fit θ = 1/(1 - e^(-z)) - 1/z, z = h C L/M, the velocity falls by e^(-z) exactly as it should, and the
order is two. Both are stable at any step, since θ >= 1/2 (derivations, `element-stability`).

The default is "edge-corrected": the exponential scheme in which the kink of the surface at an edge,
between two elements, is taken into account. The other schemes sum whole elements, and their forces
carry the sawtooth of theorem F15-sawtooth: on Table 1 at the paper's density 2e-3 of the force at the
start, 1e-3 in steady sliding, halved with the spacing. The default has 1e-4 and 1e-6, and quarters
them; its depth is within 1e-5 of theory. Only at the very instant of a jump of the drive, where
pressure is left on an edge, is it of first order too.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.contact import Edges, kink_area, pressure
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import Row, Under

NEWTON_STEPS = 60
"""The iteration ends after three or four; a monotone convex function cannot need many more."""
NEWTON_RTOL = 1e-14
SMALL = 1e-2
"""Below it, θ(z) is taken from its series to z^3, where the closed form would cancel."""


@dataclass(frozen=True)
class Motion:
    """Time (s), depth (m) and its rate (m/s); after an explicit step, two forces to judge it by.

    `imbalance` says by how much M δ'' over the step differs from the mean of the forces at its ends, and
    `force` is the larger of these and the weight (N/m).
    """

    time: float
    depth: float
    rate: float
    imbalance: float = 0.0
    force: float = 0.0


@dataclass(frozen=True)
class Scheme:
    """A way to advance by one step.

    `order` is that of the depth while spacing and step are refined together; forces summed over whole
    elements are of order one. `tableau` holds (c, a_1, a_2, …) for each stage and then the weights, for
    an explicit scheme; `theta` is θ(z) of an implicit one; `edges` says whether parts of elements count.
    """

    name: str
    summary: str
    order: int
    tableau: tuple[tuple[float, ...], ...] = ()
    theta: Callable[[float], float] | None = None
    edges: bool = False

    @property
    def stability_polynomial(self) -> tuple[float, ...]:
        """R(z) of an explicit scheme, constant first; empty for one that is stable at any step."""
        if not self.tableau:
            return ()
        return tuple(1.0 / math.factorial(k) for k in range(len(self.tableau)))

    def step(self, model: Model, row: Row, motion: Motion, h: float) -> Motion:
        """Advance the indenter and the elements by h."""
        if self.theta is None:
            return _explicit(self, model, row, motion, h)
        return _implicit(self, model, row, motion, h)


def exponential_fit(z: float) -> float:
    """Return θ = 1/(1 - e^(-z)) - 1/z, from 1/2 at z = 0 to 1 at infinity.

    >>> exponential_fit(0.0), round(exponential_fit(1.0), 6), exponential_fit(1e9)
    (0.5, 0.581977, 0.999999999)
    """
    return 0.5 + z / 12.0 - z * z * z / 720.0 if z < SMALL else -1.0 / math.expm1(-z) - 1.0 / z


def backward(_: float) -> float:
    """Return θ = 1."""
    return 1.0


_ALL = (
    Scheme("paper", "Runge-Kutta of order 4, dt = 2 dx/V, contact rules 20-25, as in the paper", 1,
           ((0.0,), (0.5, 0.5), (0.5, 0.0, 0.5), (1.0, 0.0, 0.0, 1.0),
            (1 / 6, 1 / 3, 1 / 3, 1 / 6))),
    Scheme("explicit-euler", "Euler's method with the paper's contact rules", 1, ((0.0,), (1.0,))),
    Scheme("semi-implicit", "exact memory (F8), implicit damping, order 1", 1, theta=backward),
    Scheme("exponential", "exact memory (F8), exponentially fitted damping, order 2 in time", 2,
           theta=exponential_fit),
    Scheme("edge-corrected", "the exponential scheme with part of an element at each edge, order 2", 2,
           theta=exponential_fit, edges=True),
)  # fmt: skip
SCHEMES = {scheme.name: scheme for scheme in _ALL}
"""The schemes by name."""
DEFAULT = "edge-corrected"


def _explicit(scheme: Scheme, model: Model, row: Row, now: Motion, h: float) -> Motion:
    """Take a step of Runge-Kutta; which elements are in contact is settled at its end."""
    *stages, weights = scheme.tableau
    rates: list[float] = []
    pulls: list[float] = []
    for c, *a in stages:
        depth = now.depth + h * _dot(a, rates)
        rate = now.rate + h * _dot(a, pulls) / model.mass
        at = Motion(now.time + c * h, depth, rate)
        rates.append(rate)
        pulls.append(
            _meet(model, row, at, now, before=c == 1.0)[0] if math.isfinite(model.mass) else 0.0
        )
    new = Motion(
        now.time + h,
        now.depth + h * _dot(weights, rates),
        now.rate + h * _dot(weights, pulls) / model.mass,
    )
    pull, under, pressed = _meet(model, row, new, now, before=True)
    row.settle(under, np.where(pressed, new.depth - under.height, under.free), pressed, h)
    if math.isinf(model.mass):
        return new
    imbalance = abs(_dot(weights, pulls) - 0.5 * (pulls[0] + pull))
    return replace(new, imbalance=imbalance, force=model.weight + max(abs(pull), abs(pulls[0])))


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _meet(
    model: Model, row: Row, at: Motion, now: Motion, *, before: bool
) -> tuple[float, Under, NDArray[np.bool_]]:
    """Return M δ'', the elements under the indenter, and which of them press (Eqs. 17, 20-25)."""
    under = row.under(at.time, at.time - now.time, max(at.depth, now.depth))
    V = row.path.velocity(at.time, before=before)
    p = pressure(model, under, at.depth, at.rate, V)
    pressed = (under.touched | (at.depth - under.height > under.free)) & (p >= 0.0)
    force = model.spacing * float(p[pressed].sum())
    return model.weight - model.spring * (at.depth - model.depth) - force, under, pressed


def _implicit(scheme: Scheme, model: Model, row: Row, now: Motion, h: float) -> Motion:
    """Take a step in which the depth at its end is the root of the balance of momentum."""
    end = now.time + h
    if math.isinf(model.mass):
        new, under = Motion(end, now.depth, 0.0), row.under(end, h, now.depth)
    else:
        new, under = _balance(scheme, model, row, now, h)
    u = np.maximum(new.depth - under.height, under.free)
    row.settle(under, u, new.depth >= under.height + under.free, h)
    return new


def _balance(scheme: Scheme, model: Model, row: Row, now: Motion, h: float) -> tuple[Motion, Under]:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for the new depth by Newton's method."""
    M, W, k_s, dx = model.mass, model.weight, model.spring, model.spacing
    fall = now.depth + _sinking(model, now, h)
    under = row.under(now.time + h, h, max(fall, now.depth))
    meets = under.height + under.free
    sunk = min(h * now.rate, fall - now.depth)
    length = dx * max(np.count_nonzero(meets <= now.depth + sunk), np.count_nonzero(under.touched))
    theta = scheme.theta(h * model.damping * length / M)  # type: ignore[misc]
    stiffness = -model.stiffness / math.expm1(-h / model.retardation_time)
    kinks = _Kinks(model, row, now, under, h) if scheme.edges else None

    # The unknown is how far it sinks: the depths themselves cancel where the step is short.
    def velocity(sunk: float) -> float:
        return (sunk / h - (1.0 - theta) * now.rate) / theta

    for _ in range(NEWTON_STEPS):
        depth = now.depth + sunk
        pressed = depth > meets
        area = dx * float(np.maximum(depth - meets, 0.0).sum())
        width = dx * np.count_nonzero(pressed)
        if kinks is not None:
            more, wider = kinks(depth, pressed)
            area, width = area + more, width + wider
        mean = now.depth - model.depth + theta * sunk
        residual = M * (velocity(sunk) - now.rate) / h - W + k_s * mean + stiffness * area
        change = residual / (M / (theta * h * h) + theta * k_s + stiffness * width)
        sunk -= change
        if abs(change) <= NEWTON_RTOL * model.depth:
            break
    return Motion(now.time + h, now.depth + sunk, velocity(sunk)), under


def _sinking(model: Model, now: Motion, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    q = model.spring * h * h / model.mass
    pull = max(model.weight + model.spring * (model.depth - now.depth), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return h * max(now.rate, 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / model.mass


class _Kinks:
    """What the kinks of the surface, at edges between two elements, add to the area that is pressed.

    A kink counts where the edge moves outward over the free surface, that is, where e^(t/τ) g rises
    just outside. Where the edge moves inward, the surface has no kink, or one that is left behind and
    relaxes like all that is free.
    """

    def __init__(self, model: Model, row: Row, now: Motion, under: Under, h: float) -> None:
        self.model, self.now, self.under = model, now, under
        self.decay = math.exp(-h / model.retardation_time)
        path = row.path
        self.x_before = under.x - (path.displacement(now.time + h) - path.displacement(now.time))
        self.before = Edges.of(under.touched)
        gaps = self.before.gaps(model, now.depth, self.x_before, row.u[under.place])
        self.area_before = self.decay * kink_area(model, gaps)[0]
        self.moves_out: dict[int, bool] = {}

    def __call__(self, depth: float, pressed: NDArray[np.bool_]) -> tuple[float, float]:
        """Return the area at this depth beyond what relaxed of that before, and its rate with depth."""
        model, under = self.model, self.under
        edges = Edges.of(pressed)
        gaps = edges.gaps(model, depth, under.x, under.free)
        areas, rates = kink_area(model, gaps)
        area = rate = 0.0
        for side in (-1, 1):
            here = edges.outward == side
            if not here.any():
                continue
            # Decided once, so that Newton's method cannot go to and fro.
            if side not in self.moves_out:
                self.moves_out[side] = self._moves_out(edges.free[here], depth)
            if self.moves_out[side]:
                earlier = self.area_before[self.before.outward == side]
                area += float(areas[here].sum() - earlier.sum())
                rate += float(rates[here].sum())
        return area, rate

    def _moves_out(self, free: NDArray[np.intp], depth: float) -> bool:
        g, g_before = (
            d - self.model.height(x[free])
            for d, x in ((depth, self.under.x), (self.now.depth, self.x_before))
        )
        return bool(np.any(g > self.decay * g_before))
