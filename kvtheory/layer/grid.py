"""Cells of pressure under the indenter: the contact on one grid, and grids that follow the contact."""

import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import unit_impulse

from kvtheory.layer import compliance, memory
from kvtheory.layer.body import Body, Support
from kvtheory.layer.contact import Contact, Influence, unilateral
from kvtheory.scene.indenters import beside

Array = NDArray[np.float64]

FINELY = 4
"""Steps in a cell in which the elastic displacement is averaged where its shortest wave matters."""
IN_PHASE = 0.5
"""Lag in radians of a wave of one cell up to which it does not matter."""
SLOW = 0.5
"""Cells travelled in a retardation time below which friction is its limit at low velocity: what edges add,
which jump from cell to cell, is larger than what the limit lacks."""
JUMPY = 2.0
"""Cells travelled below which these jumps are not small yet, and may be equal on two grids by chance."""
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

    def points(self, shift: float) -> Any:
        """Return x of all cells, and of a ball y too; `shift` is in cells."""
        both = np.broadcast_arrays(self.x + shift * self.length, self.y)
        return both[:1] if self.width is None else both

    def height(self, shape: Any, shift: float) -> Array:
        """Return the height of a shape, infinite beyond its reach; `shift` is in cells."""
        points = self.points(shift)
        inside = np.linalg.norm(points, axis=0) < shape.reach
        found = np.full(inside.shape, math.inf)
        with np.errstate(over="ignore"):  # beside the contact of a steep shape
            found[inside] = shape.height(*(each[inside] for each in points))
        return found

    def slope(self, shape: Any, inside: Any, shift: float = 0.0) -> Array:
        """Return the slope of a shape along x in the cells `inside`; `shift` is in cells."""
        x, *y = (each[inside] for each in self.points(shift))
        return np.asarray(shape.slope(np.clip(x, -shape.reach, shape.reach), *y))

    def shift(self, body: Body, velocity: float) -> float:
        """Return how far behind their middle cells are compared with the indenter, in cells.

        Pressure that is constant in cells holds, beside a wave of number k, one of nearly the length of a
        cell. Its displacement lags by up to a quarter of it, on Kelvin-Voigt; in the middle of the cells it
        would be an error of the phase of k, of which friction is made. That far behind there is none.
        """
        lag = float(np.angle(body.creep.modulus(2j * math.pi / self.length * abs(velocity))))
        return math.copysign(0.5 * lag / math.pi, velocity) if lag > IN_PHASE else 0.0

    def influence(self, body: Body, velocity: float) -> Influence:
        """Return the influence of its cells in sliding along +x."""
        n, m, shift = self.last - self.first, self.rows, abs(self.shift(body, velocity))
        H, nu, per_cell = body.thickness / self.length, body.poisson_ratio, FINELY if shift else 1

        sizes = rounded(n + 1), rounded(2 * m + 1), per_cell
        found = compliance.of_cell(*sizes, shift, H, nu, self.width)
        loss, remembered = np.zeros_like(found), unit_impulse(n)
        if velocity != 0.0:
            travelled = self.travelled(body, velocity)
            remembered = body.creep.remembered(travelled, n)
            found, loss = memory.influence(
                found, body.creep, travelled, per_cell, shift, H, nu, self.width
            )
        stiffness = partial(compliance.stiffness, H=H, poisson_ratio=nu, width=self.width)
        return Influence(found, loss, m, remembered, stiffness)

    def travelled(self, body: Body, velocity: float) -> Array:
        """Return how many cells are travelled in each retardation time."""
        return abs(velocity) * body.creep.times / self.length

    def per_pressure(self, body: Body) -> float:
        """Return the load for each unit of the sum of pressures of a `Contact`."""
        across = 1.0 if self.width is None else 2.0 * self.width * self.length
        return across / body.compliance


class Found(NamedTuple):
    """The contact on a grid, and its friction force, in SI.

    At low velocity it is from the limit (F28), which takes p - e, e the average of p over the way l that is
    travelled in a retardation time of share c, as l p'. At each edge, where p is P sqrt(x), this adds
    (pi/8) S P^2 c (1 - c/2) l^2, exactly so on a half-plane with one time, which is taken off. `lag` is what
    may be wrong with that, or with what the edges add at somewhat higher velocity, an eighth of it without
    c/2: P is that of a few cells.
    """

    grid: Grid
    contact: Contact
    friction: float = 0.0
    lag: float = 0.0

    @property
    def cells(self) -> int:
        """How many cells are in contact along x."""
        return int(np.count_nonzero(self.contact.active.any(axis=1)))

    def finer(self) -> "Found":
        """Return the start on a grid with cells half as long, around the contact."""
        grid, spread = self.grid, 0.5 * self.contact.pressure.repeat(2, 0).repeat(2, 1)
        i, j = (np.flatnonzero(spread.any(axis)) for axis in (1, 0))
        margin = 2 + int(np.ptp(i)) // 10
        low, high = int(i[0]) - margin, int(i[-1]) + 1 + margin
        rows = 1 if grid.width is None else int(j[-1]) + 1 + margin
        around = (margin, margin), (0, max(rows - spread.shape[1], 0))
        spread = np.pad(spread, around)[low + margin : high + margin, :rows]
        first = 2 * grid.first
        finer = Grid(0.5 * grid.length, first + low, first + high, rows, grid.width)
        return Found(finer, Contact(spread, self.contact.depth))

    def settled(self, shape: Any, body: Body, velocity: float, support: Support) -> "Found":
        """Return the contact on this grid, or on one that is larger if need be."""
        grid, way = self.grid, math.copysign(1.0, velocity)
        unit, shift, line = grid.per_pressure(body), grid.shift(body, velocity), grid.width is None
        influence, ahead = grid.influence(body, velocity), slice(None, None, int(way))
        start = Contact(self.contact.pressure[ahead], self.contact.depth)
        height = grid.height(shape, shift)[ahead]
        pressure, depth = unilateral(influence, height, support.balance(unit), start)
        contact = Contact(pressure[ahead], depth)
        active, pressed = contact.active, contact.pressure[contact.active]
        if active[[0, -1]].any() or (active[:, -1].any() and not line):
            n, m = 2 + len(active) // 5, 0 if line else 2 + grid.rows // 5
            larger = grid._replace(first=grid.first - n, last=grid.last + n, rows=grid.rows + m)
            wider = Contact(np.pad(contact.pressure, ((n, n), (0, m))), depth)
            return Found(larger, wider).settled(shape, body, velocity, support)
        shares, travelled = body.creep.shares, grid.travelled(body, velocity)
        edges, lag = 0.125 * math.pi / grid.length * contact.rise(), 0.0
        if travelled.max() < JUMPY:
            lag = 0.125 * unit * edges * float(shares @ travelled**2)
        if travelled.max() < SLOW:
            bent = grid.slope(shape, active, 0.5) - grid.slope(shape, active, -0.5)
            lacks = edges * shares * (1.0 - 0.5 * shares) @ travelled**2
            friction = way * float(shares @ travelled * (pressed @ bent) - lacks)
        elif shift:
            friction = -float(pressed @ grid.slope(shape, active))
        else:
            friction = way * influence.lost(pressure) / grid.length
        return Found(grid, contact, unit * friction, lag)

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
