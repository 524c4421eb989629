r"""Steady sliding of a rigid indenter on a viscoelastic layer or half-space, by boundary elements.

The frame is that of the indenter; the body moves through it along +x with V > 0, so that the leading edge is at
x < 0. The cells are centred at (i + 1/2) times their length, symmetric about the lowest point: at rest there is no
friction, and at low velocity it is not drowned by that of the grid. The grid follows the contact: it is refined
by factors of two, and the contact on each grid is the start of the next. Lengths of cells
are powers of sqrt(2) of the thickness, so that grids, hence elastic influences, are shared by velocities and scenes.

The errors are those of the grid: the change from the grid with cells twice as long.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from kvtheory.layer import compliance, memory
from kvtheory.layer.contact import Balance, Contact, Influence, unilateral
from kvtheory.results.errors import ToleranceError

Array = NDArray[np.float64]

COARSE = 12
"""Cells along the contact on the first grid, at least."""
FINEST = {True: 1600, False: 500}
"""Cells along the contact on the last grid, at most: of a line, of a ball."""
THINNEST = 1.0 / 60.0
"""Thickness in cells below which the influence is not resolved."""
SAFETY = 1.0
LEVELS = 3
CONVERGED = "depth", "load", "friction_force"
FINELY = 4
IN_PHASE = 0.5


class Support(NamedTuple):
    """A given depth, or a load and a spring that is relaxed at a depth, in SI."""

    depth: float | None = None
    load: float = 0.0
    spring: float = 0.0
    relaxed_depth: float = 0.0

    @property
    def carried(self) -> float:
        """The load that the contact would carry at no depth."""
        return self.load + self.spring * self.relaxed_depth

    def balance(self, unit: float) -> Balance:
        """Return its balance where a sum of pressures of 1 carries the load `unit`."""
        if self.depth is not None:
            return Balance(0.0, 1.0, self.depth)
        return Balance(1.0, self.spring / unit, self.carried / unit)


class Body(NamedTuple):
    """A layer bonded to a rigid base, or a half-space (`thickness` inf): E_0, in Pa, H, nu and its creep."""

    modulus: float
    thickness: float
    poisson_ratio: float
    creep: memory.Creep

    @classmethod
    def of_series(cls, modulus: float, thickness: float, poisson_ratio: float, arms: Any) -> "Body":
        """Return the body of a Prony series, `arms` pairs of modulus, in Pa, and relaxation time, in s."""
        moduli, times = np.array(arms, dtype=float).reshape(-1, 2).T
        return cls(modulus, thickness, poisson_ratio, memory.Creep.of_series(modulus, moduli, times))

    @classmethod
    def kelvin_voigt(cls, modulus: float, thickness: float, poisson_ratio: float, time: float) -> "Body":
        """Return the body with a damper beside each spring, E(s) = E_0 (1 + s tau)."""
        return cls(modulus, thickness, poisson_ratio, memory.Creep.kelvin_voigt(time))

    @property
    def compliance(self) -> float:
        """S = 2 (1 - nu^2)/E_0."""
        return 2.0 * (1.0 - self.poisson_ratio**2) / self.modulus


@dataclass(frozen=True)
class Sliding:
    """Steady sliding on the body itself: SI values, errors by their names, and the pressure on its grid.

    Forces are per width under a line. `pressure` is of shape (x, y); y > 0 only, the other half is its mirror image.
    """

    depth: float
    load: float
    friction_force: float
    friction_coefficient: float
    leading_edge: float
    trailing_edge: float
    peak_pressure: float
    errors: dict[str, float]
    x: Array
    y: Array
    pressure: Array


class Grid(NamedTuple):
    """Cells at (i + 1/2) `length`, first <= i < last, and as many across: `rows`, `width` lengths wide."""

    length: float
    first: int
    last: int
    rows: int
    width: float | None

    @property
    def x(self) -> Array:
        """Centres along x, (n, 1)."""
        return (np.arange(self.first, self.last)[:, None] + 0.5) * self.length

    @property
    def y(self) -> Array:
        """Centres across, (m,)."""
        return (np.arange(self.rows) + 0.5) * (self.width or 0.0) * self.length

    def height(self, shape: Any, shift: float = 0.0) -> Array:
        """Return the height of a shape above its lowest point, infinite beyond its reach; `shift` in cells."""
        x, y = np.broadcast_arrays(self.x + shift * self.length, self.y)
        inside = np.hypot(x, y) < shape.reach
        found = np.full(x.shape, math.inf)
        where = (x[inside],) if self.width is None else (x[inside], y[inside])
        found[inside] = shape.height(*where)
        return found

    def shift(self, body: Body, velocity: float) -> float:
        """Return how far behind their middle the displacement of cells is compared with the surface, in cells.

        The shortest wave of the grid is two cells long. Where its displacement lags its pressure, by a quarter
        of it on Kelvin-Voigt, it is felt in full only that far behind, and hardly in the middle.
        """
        lag = body.creep.phase(math.pi / self.length, abs(velocity))
        return math.copysign(lag / math.pi, velocity) if lag > IN_PHASE else 0.0

    def influence(self, body: Body, velocity: float) -> Influence:
        """Return the influence of its cells in sliding at a velocity."""
        n, m, shift = self.last - self.first, self.rows, abs(self.shift(body, velocity))
        H, nu, per_cell = body.thickness / self.length, body.poisson_ratio, FINELY if shift else 1
        if self.width is None:
            found = compliance.of_line(n + 1, per_cell, shift, H, nu)
        else:
            found = compliance.of_cell(n + 1, 2 * m + 1, per_cell, shift, H, nu, self.width)
        if velocity != 0.0:
            travelled = abs(velocity) * body.creep.times / self.length
            found = memory.influence(found, body.creep, travelled, per_cell, shift, H, nu, self.width)
        return Influence(found if velocity >= 0.0 else found[::-1], n, m)

    def adapted(self, contact: Contact, finer: int) -> tuple["Grid", Contact]:
        """Return a grid with cells `finer` times shorter around a contact, and the contact on it."""
        spread = contact.pressure
        for axis in (0, 1)[: 1 if self.width is None else 2]:
            spread = np.repeat(spread, finer, axis)
        i, j = (np.flatnonzero((spread > 0.0).any(axis)) for axis in (1, 0))
        margin = 2 + (i[-1] - i[0]) // 10
        low, high = i[0] - margin, i[-1] + 1 + margin
        rows = 1 if self.width is None else j[-1] + 1 + margin
        grid = Grid(self.length / finer, self.first * finer + low, self.first * finer + high, rows, self.width)
        pressure = np.zeros((high - low, rows))
        kept = spread[max(low, 0) : high, :rows]
        pressure[max(-low, 0) :][: len(kept), : kept.shape[1]] = kept
        return grid, Contact(pressure, contact.depth)


    def grown(self, contact: Contact) -> tuple["Grid", Contact] | None:
        """Return a larger grid if the contact reaches the rim of this one, and the contact on it."""
        active = contact.active
        if not (active[0].any() or active[-1].any() or (self.width is not None and active[:, -1].any())):
            return None
        n, m = (2 + each // 5 for each in active.shape)
        m = 0 if self.width is None else m
        larger = self._replace(first=self.first - n, last=self.last + n, rows=self.rows + m)
        return larger, contact._replace(pressure=np.pad(contact.pressure, ((n, n), (0, m))))

    def per_pressure(self, body: Body) -> float:
        """Return the load per sum of the pressures of a `Contact`: S p times the length, and half of a ball."""
        across = 1.0 if self.width is None else 2.0 * self.width * self.length
        return across / body.compliance

    def settled(self, shape: Any, body: Body, velocity: float, support: Support, start: Contact) -> "Found":
        """Return the contact on this grid, or on one that is larger if need be."""
        balance = support.balance(self.per_pressure(body))
        height = self.height(shape, self.shift(body, velocity))
        contact = unilateral(self.influence(body, velocity), height, balance, start)
        larger = self.grown(contact)
        return Found(self, contact) if larger is None else larger[0].settled(shape, body, velocity, support, larger[1])


class Found(NamedTuple):
    """The contact on a grid."""

    grid: Grid
    contact: Contact

    def finer(self, factor: int = 2) -> "Found":
        """Return the start on a grid with cells `factor` times shorter."""
        return Found(*self.grid.adapted(self.contact, factor))

    def values(self, shape: Any, body: Body, velocity: float) -> dict[str, float]:
        """Return the quantities of `Sliding` that are numbers, in SI."""
        grid, pressure = self.grid, self.contact.pressure
        unit, x = grid.per_pressure(body), grid.x
        touching = np.flatnonzero(self.contact.active.any(axis=1))
        at = (x,) if grid.width is None else np.broadcast_arrays(x, grid.y)
        inside = pressure > 0.0
        slope = shape.slope(*(np.broadcast_to(each, pressure.shape)[inside] for each in at))
        load = unit * float(np.sum(pressure))
        friction = -unit * float(np.sum(pressure[inside] * slope))
        edges = x[touching[0], 0] - 0.5 * grid.length, x[touching[-1], 0] + 0.5 * grid.length
        leading, trailing = edges if velocity >= 0.0 else edges[::-1]
        return {
            "depth": self.contact.depth, "load": load, "friction_force": friction,
            "friction_coefficient": friction / load, "leading_edge": float(leading), "trailing_edge": float(trailing),
            "peak_pressure": float(pressure.max()) / (body.compliance * grid.length),
        }  # fmt: skip


def half_length(shape: Any, depth: float) -> float:
    """Return where the surface is as high as the depth, on the farther side of the lowest point."""
    found = []
    for side in (-1.0, 1.0):
        far = min(depth, 0.5 * shape.reach)
        while (far := min(2.0 * far, shape.reach)) < shape.reach and shape.height(side * far) < depth:
            pass
        inner = min(far, shape.reach * (1.0 - 1e-12))
        if shape.height(side * inner) <= depth:
            found.append(inner)
        else:
            found.append(brentq(lambda x, side=side: shape.height(side * x) - depth, 0.0, inner, xtol=1e-9 * inner))
    return max(found)


def first_grid(shape: Any, body: Body, depth: float) -> Found:
    """Return a coarse grid for a contact at a depth, and all cells below the surface in contact."""
    a, H = half_length(shape, depth), body.thickness
    base = 1.0 if math.isinf(H) else H
    length = base * 2.0 ** (math.floor(2.0 * math.log2(2.0 * a / COARSE / base)) / 2.0)
    n = math.ceil(a / length) + 2
    width = None if shape.per_width else float(shape.stretch)
    grid = Grid(length, -n, n, 1 if width is None else n, width)
    return Found(grid, Contact(np.where(grid.height(shape) < depth, 1.0, 0.0), depth))


def depth_under(shape: Any, body: Body, velocity: float, support: Support) -> Found:
    """Return the contact under a support on a coarse grid, from any distance: a secant in the logarithms."""
    carried = support.carried
    log_depth, tried = math.log(_first_depth(shape, body, carried, support.spring)), []
    for _ in range(60):
        start = first_grid(shape, body, math.exp(log_depth))
        found = start.grid.settled(shape, body, velocity, Support(math.exp(log_depth)), start.contact)
        load = found.values(shape, body, velocity)["load"] + support.spring * math.exp(log_depth)
        tried.append((log_depth, math.log(load / carried)))
        if abs(tried[-1][1]) < 0.1:
            return found
        slope = 1.5
        if len(tried) > 1 and tried[-1][0] != tried[-2][0]:
            slope = (tried[-1][1] - tried[-2][1]) / (tried[-1][0] - tried[-2][0])
        log_depth -= tried[-1][1] / min(max(slope, 0.7), 4.0)
    raise ArithmeticError("no depth was found that carries the load")


def _first_depth(shape: Any, body: Body, carried: float, spring: float) -> float:
    """Return a depth of the order of that which carries a load: a wave of the length of the contact."""
    low, high = -60.0, 20.0
    while high - low > 0.1:
        depth = math.exp(0.5 * (low + high))
        a = half_length(shape, depth)
        area = 2.0 * a if shape.per_width else math.pi * a * a * shape.stretch
        T = 1.0 if math.isinf(body.thickness) else float(compliance.transform(body.thickness / a, body.poisson_ratio))
        load = area * depth / (body.compliance * T * a) + spring * depth
        low, high = (low, math.log(depth)) if load > carried else (math.log(depth), high)
    return math.exp(0.5 * (low + high))


def levels(shape: Any, body: Body, velocity: float, support: Support) -> Iterator[Found]:
    """Yield the contact on grids of cells that become shorter by a factor of two."""
    if support.depth is None:
        start = depth_under(shape, body, velocity, support)
    else:
        start = first_grid(shape, body, support.depth)
    while True:
        found = start.grid.settled(shape, body, velocity, support, start.contact)
        yield found
        start = found.finer()


def slide(
    shape: Any, body: Body, velocity: float, support: Support, rtol: float = 1e-3
) -> Sliding:
    """Return steady sliding, with load or depth and friction to a relative error of `rtol`.

    Raises `ToleranceError` if the finest grid does not reach it, and ValueError for what cannot be computed.
    """
    require(shape, body)
    known: list[dict[str, float]] = []
    for found in levels(shape, body, velocity, support):
        known.append(found.values(shape, body, velocity))
        if len(known) < LEVELS:
            continue
        errors = errors_of(known, found.grid.length)
        if all(errors[name] <= rtol * abs(known[-1][name]) for name in CONVERGED):
            break
    return Sliding(**known[-1], errors=errors, x=found.grid.x[:,0], y=found.grid.y, pressure=found.contact.pressure/body.compliance/found.grid.length)


def errors_of(known: list[dict[str, float]], cell: float) -> dict[str, float]:
    """Return the errors of the last of the values on three grids or more, the edges to a cell."""
    last, before, first = (known[-k] for k in (1, 2, 3))
    changes = {name: max(abs(last[name] - before[name]), 0.25 * abs(before[name] - first[name])) for name in last}
    return {name: max(SAFETY * change, cell if "edge" in name else 0.0) for name, change in changes.items()}
