"""Cells of pressure under the indenter: the contact on one grid, and grids that follow the contact."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.layer import compliance, memory
from kvtheory.layer.body import Body, Support
from kvtheory.layer.contact import Contact, Influence, unilateral
from kvtheory.scene.indenters import beside

Array = NDArray[np.float64]

FINELY = 4
"""Steps in a cell in which the elastic displacement is averaged where its shortest wave matters."""
IN_PHASE = 0.5
"""Lag in radians of the shortest wave of a grid up to which it does not matter."""
SLOW = 0.2
"""Cells travelled in a retardation time below which friction under a parabola, circle or ball is its limit at
low velocity: what edges add, which jump from cell to cell, is larger than what the limit lacks."""
SLOWEST_DECAY = 1e-12
"""Decay of the memory in a cell below which the preconditioner takes no less."""
HALVINGS = 0.5 ** np.arange(1, 100)


def rounded(size: int) -> int:
    """Return a size with three binary digits, not below the given one, so that grids share influences."""
    step = 1 << max(size.bit_length() - 3, 0)
    return -(-size // step) * step


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
        return (np.arange(self.first, self.last, dtype=float)[:, None] + 0.5) * self.length

    @property
    def y(self) -> Array:
        """Centres across, (m,)."""
        return (np.arange(self.rows, dtype=float) + 0.5) * (self.width or 0.0) * self.length

    def height(self, shape: Any, shift: float = 0.0) -> Array:
        """Return the height of a shape, infinite beyond its reach; `shift` is in cells."""
        x, y = np.broadcast_arrays(self.x + shift * self.length, self.y)
        inside = np.hypot(x, y) < shape.reach
        found = np.full(x.shape, math.inf)
        where = (x[inside],) if self.width is None else (x[inside], y[inside])
        found[inside] = shape.height(*where)
        return found

    def bending(self, shape: Any, inside: Any) -> Array:
        """Return the change of the slope along x over the cells `inside`, within the reach of a shape."""
        return self.slope(shape, inside, 0.5) - self.slope(shape, inside, -0.5)

    def slope(self, shape: Any, inside: Any, shift: float = 0.0) -> Array:
        """Return the slope of a shape along x in the cells `inside`, else zero; `shift` is in cells."""
        x, y = np.broadcast_arrays(self.x + shift * self.length, self.y)
        x = np.clip(x, -shape.reach, shape.reach)
        found = np.zeros(x.shape)
        found[inside] = shape.slope(
            *((x[inside],) if self.width is None else (x[inside], y[inside]))
        )
        return found

    def shift(self, body: Body, velocity: float) -> float:
        """Return how far behind their middle cells are compared with the indenter, in cells.

        The shortest wave of the grid is two cells long. Where its displacement lags its pressure, by a
        quarter of it on Kelvin-Voigt, it is felt in full only that far behind, and hardly in the middle.
        """
        lag = body.creep.phase(math.pi / self.length, abs(velocity))
        return math.copysign(lag / math.pi, velocity) if lag > IN_PHASE else 0.0

    def influence(self, body: Body, velocity: float) -> Influence:
        """Return the influence of its cells in sliding at a velocity."""
        n, m, shift = self.last - self.first, self.rows, abs(self.shift(body, velocity))
        H, nu, per_cell = body.thickness / self.length, body.poisson_ratio, FINELY if shift else 1

        def elastic(per_cell: int, shift: float) -> Array:
            if self.width is None:
                return compliance.of_line(rounded(n + 1), per_cell, shift, H, nu)
            sizes = rounded(n + 1), rounded(2 * m + 1)
            return compliance.of_cell(*sizes, per_cell, shift, H, nu, self.width)

        found, decay = elastic(per_cell, shift), 0.0
        loss = np.zeros_like(found)
        if velocity != 0.0:
            travelled = abs(velocity) * body.creep.times / self.length
            found, loss = memory.influence(
                found, body.creep, travelled, per_cell, shift, H, nu, self.width
            )
            if body.creep.glassy == 0.0:
                decay = math.copysign(math.exp(-max(1.0 / travelled[0], SLOWEST_DECAY)), velocity)
        forward = slice(None, None, -1 if velocity < 0.0 else None)
        still = elastic(1, 0.0) if decay else found
        return Influence(found[forward], loss[forward], n, m, still, decay)

    def adapted(self, contact: Contact, finer: int) -> tuple["Grid", Contact]:
        """Return a grid with cells `finer` times shorter around a contact, and the contact on it."""
        spread = contact.pressure
        for axis in (0, 1)[: 1 if self.width is None else 2]:
            spread = np.repeat(spread, finer, axis)
        i, j = (np.flatnonzero((spread > 0.0).any(axis)) for axis in (1, 0))
        margin = 2 + int(i[-1] - i[0]) // 10
        low, high = int(i[0]) - margin, int(i[-1]) + 1 + margin
        rows = 1 if self.width is None else int(j[-1]) + 1 + margin
        grid = Grid(
            self.length / finer,
            self.first * finer + low,
            self.first * finer + high,
            rows,
            self.width,
        )
        pressure = np.zeros((high - low, rows))
        kept = spread[max(low, 0) : high, :rows]
        pressure[max(-low, 0) :][: len(kept), : kept.shape[1]] = kept
        return grid, Contact(pressure, contact.depth)

    def grown(self, contact: Contact) -> tuple["Grid", Contact] | None:
        """Return a larger grid if the contact reaches the rim of this one, and the contact on it."""
        active = contact.active
        if not (
            active[0].any() or active[-1].any() or (self.width is not None and active[:, -1].any())
        ):
            return None
        n, m = (2 + each // 5 for each in active.shape)
        m = 0 if self.width is None else m
        larger = self._replace(first=self.first - n, last=self.last + n, rows=self.rows + m)
        return larger, contact._replace(pressure=np.pad(contact.pressure, ((n, n), (0, m))))

    def per_pressure(self, body: Body) -> float:
        """Return the load for each unit of the sum of pressures of a `Contact`."""
        across = 1.0 if self.width is None else 2.0 * self.width * self.length
        return across / body.compliance

    def settled(
        self, shape: Any, body: Body, velocity: float, support: Support, start: Contact
    ) -> "Found":
        """Return the contact on this grid, or on one that is larger if need be."""
        unit, shift = self.per_pressure(body), self.shift(body, velocity)
        influence = self.influence(body, velocity)
        height = self.height(shape, shift)
        contact = unilateral(influence, height, support.balance(unit), start)
        larger = self.grown(contact)
        if larger is not None:
            return larger[0].settled(shape, body, velocity, support, larger[1])
        travelled = abs(velocity) * body.creep.times / self.length
        lag = 0.0
        if travelled.max() < SLOW and hasattr(shape, "radius"):
            lag = 2.0 * float(travelled.max()) / np.count_nonzero(contact.active.any(axis=1))
            delay = float(np.sum(body.creep.shares * travelled))
            bent = self.bending(shape, contact.active)
            friction = math.copysign(delay * float(np.sum(contact.pressure * bent)), velocity)
        elif shift:
            friction = -float(np.sum(contact.pressure * self.slope(shape, contact.active)))
        else:
            friction = math.copysign(influence.lost(contact.pressure) / self.length, velocity)
        return Found(self, contact, unit * friction, lag)


class Found(NamedTuple):
    """The contact on a grid, and its friction force, in SI.

    Where that is its limit at low velocity (F28), `lag` bounds its relative error by what is travelled in
    the longest retardation time over the half length. It is 0.7 times this, as on independent elements (F4).
    """

    grid: Grid
    contact: Contact
    friction: float = 0.0
    lag: float = 0.0

    def finer(self, factor: int = 2) -> "Found":
        """Return the start on a grid with cells `factor` times shorter."""
        return Found(*self.grid.adapted(self.contact, factor))

    def values(self, shape: Any, body: Body, velocity: float) -> dict[str, float]:
        """Return the quantities of `Sliding` that are numbers, in SI."""
        grid, x = self.grid, self.grid.x
        touching = np.flatnonzero(self.contact.active.any(axis=1))
        load = grid.per_pressure(body) * float(np.sum(self.contact.pressure))
        edges = x[touching[0], 0] - 0.5 * grid.length, x[touching[-1], 0] + 0.5 * grid.length
        leading, trailing = edges if velocity >= 0.0 else edges[::-1]
        return {
            "depth": self.contact.depth, "load": load, "friction_force": self.friction,
            "friction_coefficient": self.friction / load,
            "leading_edge": float(leading), "trailing_edge": float(trailing),
            "peak_pressure": math.inf if self.kinked(shape) else self.peak(body, velocity),
        }  # fmt: skip

    def pressure(self, body: Body) -> Array:
        """Return the pressure of the cells, in Pa."""
        return self.contact.pressure / (body.compliance * self.grid.length)

    def peak(self, body: Body, velocity: float) -> float:
        """Return the highest pressure, in Pa: of the cells, or as it may rise within the first of them.

        Near the leading edge p varies as E(V/x) sqrt(x), E the modulus at the rate at which the material at
        the distance x was reached. On Kelvin-Voigt this is singular.
        """
        cells = self.pressure(body)
        highest = float(cells.max())
        if velocity == 0.0:
            return highest
        touching = np.flatnonzero(self.contact.active[:, 0])
        first = cells[touching[0 if velocity > 0.0 else -1], 0]
        if body.creep.glassy == 0.0:
            return math.inf
        rate = abs(velocity) / self.grid.length
        rise = np.sqrt(HALVINGS) * body.creep.modulus(rate / HALVINGS) / body.creep.modulus(rate)
        return max(highest, float(first * rise.max()))

    def kinked(self, shape: Any) -> bool:
        """Whether an edge of the indenter, where its slope jumps, presses: there the pressure is singular."""
        touching, cell = self.grid.x[self.contact.active[:, 0]], self.grid.length
        return any(
            touching.min() - cell <= x <= touching.max() + cell
            and shape.slope(beside(x, math.inf)) != shape.slope(beside(x, -math.inf))
            for x in shape.kinks
        )
