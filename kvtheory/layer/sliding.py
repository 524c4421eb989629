r"""Steady sliding of a rigid indenter on a viscoelastic layer or half-space, by boundary elements.

The frame is that of the indenter; the body moves through it along +x with V > 0, so that the leading edge
is at x < 0. The cells are centred at (i + 1/2) times their length, symmetric about the lowest point: at
rest there is no friction, and at low velocity it is not drowned by that of the grid. Cells become shorter
by factors of two, and the contact on each grid is the start of the next. Their lengths are powers of
sqrt(2) of the thickness, so that velocities and scenes share grids, hence elastic influences, which are
kept.

The errors are those of the grid, of second order in its cells: they follow from the changes between the
last three.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from kvtheory.layer import compliance
from kvtheory.layer.body import Body, Support
from kvtheory.layer.contact import Contact
from kvtheory.layer.grid import Found, Grid
from kvtheory.progress import Progress, silent
from kvtheory.results.errors import ToleranceError

Array = NDArray[np.float64]
Elastic = tuple[float, float, float]

COARSE = 12
"""Cells along the contact on the first grid, at least."""
FINEST = {True: 4000, False: 300}
"""Cells along the contact from which no finer grid follows: of a line, of a ball."""
THINNEST = 1.0 / 8.0
"""Least thickness in cells: the influence of a cell much longer than the layer is thick is not resolved."""
LEVELS = 3
"""Grids from which an error follows."""
SAFETY, SLOWEST = 2.0, 0.95
"""Safety of the errors, and largest ratio of successive changes that is taken for convergence."""
CONVERGED = "depth", "load", "friction_force"
"""Quantities that are to be within the tolerance, unless others are named."""
CLOSE = 0.1
"""Difference of the logarithms of depths at which a grid made for the one is good for the other."""


@dataclass(frozen=True)
class Sliding:
    """Steady sliding on the body itself: SI values, their errors by name, and the pressure (x, y) on a grid.

    Forces are per width under a line. Of a ball the grid is that of y > 0; the other half is its mirror
    image. The peak pressure is infinite on Kelvin-Voigt, where the surface enters, and under an edge of the
    indenter; elsewhere it may rise within the first cell, which is allowed for.
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

    def relative_error(self, name: str) -> float:
        """Return a relative error, of an edge to the length of the contact; what is exact has none."""
        size = getattr(self, name)
        if name.endswith("edge"):
            size = self.trailing_edge - self.leading_edge
        return self.errors[name] / abs(size) if self.errors[name] else 0.0


def slide(
    shape: Any,
    body: Body,
    velocity: float,
    support: Support,
    rtol: float = 1e-3,
    names: tuple[str, ...] = CONVERGED,
    report: Progress = silent,
) -> Sliding:
    """Return steady sliding at a velocity in m/s, with the quantities `names` to a relative error `rtol`.

    Edges are relative to the length of the contact. `shape` is a convex one of `kvtheory.scene.indenters`, a
    line or a ball. Raises ValueError for what the method does not cover, and `ToleranceError` if the finest
    grid does not reach the tolerance.

    >>> from kvtheory.scene.indenters import Parabola
    >>> rubber = Body.of_series(1e6, 1e-3, 0.49, [(4e6, 0.02)])
    >>> found = slide(Parabola(radius=0.01), rubber, 0.05, Support(depth=1e-4))
    >>> print(f"{found.load:.4g} N/m, {found.friction_coefficient:.4f}")
    2320 N/m, 0.0367
    """
    _require(shape, body)
    support = relaxed(shape, body, support, rtol)
    known: list[dict[str, float]] = []
    wrong = "the error is not known"
    for found in levels(shape, body, velocity, support):
        grid = found.grid
        known.append(found.values(shape, body, velocity))
        if len(known) >= LEVELS:
            errors = errors_of(known, grid.length)
            errors["friction_force"] += SAFETY * found.lag
            errors["friction_coefficient"] += SAFETY * found.lag / known[-1]["load"]
            pressure = found.pressure(body)
            state = Sliding(**known[-1], errors=errors, x=grid.x[:, 0], y=grid.y, pressure=pressure)
            worst = max(names, key=state.relative_error)
            if state.relative_error(worst) <= rtol:
                return state
            wrong = f"{worst} has a relative error of {state.relative_error(worst):.1e}"
        share = min(found.cells / FINEST[shape.per_width], 1.0)
        report(share, f"{found.cells:,} cells along the contact")
    hint = "the limits that `asymptotes` has need no grid"
    if not body.creep.glassy:
        hint = "the limit at low velocity that `asymptotes` has needs no grid; arms have one at high too"
    if found.kinked(shape):
        hint = "an edge presses: slowly, friction falls as V ln(1/V), which takes cells shorter than V tau"
    message = f"at {velocity:g} m/s, on the finest grid, {wrong}, above {rtol:g}"
    raise ToleranceError(f"{message}; {hint}")


@lru_cache(maxsize=64)
def at_rest(
    shape: Any, elastic: Elastic, support: Support, rtol: float, names: tuple[str, ...] = CONVERGED
) -> Sliding:
    """Return the contact at rest, which is kept; `elastic` is the body without its creep."""
    return slide(shape, Body.kelvin_voigt(*elastic, 0.0), 0.0, support, rtol, names)


def relaxed(shape: Any, body: Body, support: Support, rtol: float) -> Support:
    """Return a support whose spring is relaxed at a depth: unless one is given, that at rest."""
    if not support.spring or support.relaxed_depth is not None:
        return support
    found = at_rest(shape, body[:3], Support(load=support.load), rtol)
    return support._replace(relaxed_depth=found.depth)


def levels(shape: Any, body: Body, velocity: float, support: Support) -> Iterator[Found]:
    """Yield the contact on grids of cells that become shorter by a factor of two.

    They end with the finest, or before the first on which the contact is not found; if that is the coarsest,
    `ToleranceError` is raised.
    """
    found, cells = None, 0
    while cells < FINEST[shape.per_width]:
        try:
            if found:
                start = found.finer()
            elif support.depth is None:
                start = depth_under(shape, body, velocity, support)
            else:
                start = first_grid(shape, body, support.depth)
            found = start.settled(shape, body, velocity, support)
        except ArithmeticError as failed:
            if found:
                return
            raise ToleranceError(f"at {velocity:g} m/s, on the first grid, {failed}") from None
        yield found
        cells = found.cells


def errors_of(known: list[dict[str, float]], cell: float) -> dict[str, float]:
    """Return the errors of the last of values on three grids or more.

    The last change counts, but not less than a third of the one before, as one may be small by chance: the
    ends of the contact jump from cell to cell. Changes that fall by a factor r from grid to grid add up to
    r/(1 - r) of the last one; r is the smaller of the last two ratios, where there are two. An edge is known
    to a cell at best, and the ratios of its jumps say nothing.
    """
    found = {}
    for name, last in known[-1].items():
        changes = [abs(late[name] - early[name]) for early, late in pairwise(known[-LEVELS - 1 :])]
        ratios = [late / early if early else 0.0 for early, late in pairwise(changes)]
        ratio = min(*ratios, SLOWEST)
        error = SAFETY * max(changes[-1], changes[-2] / 3.0)
        grown = (
            max(error, cell) if name.endswith("edge") else error * max(1.0, ratio / (1.0 - ratio))
        )
        found[name] = 0.0 if math.isinf(last) else grown
    return found


def _require(shape: Any, body: Body) -> None:
    """Raise ValueError for what boundary elements do not cover."""
    if shape.per_width and math.isinf(body.thickness):
        raise ValueError(
            "a line on a half-space has no depth; expected a finite thickness, or a ball"
        )
    if not 0.0 <= body.poisson_ratio <= 0.5:
        raise ValueError(f"`poisson_ratio` = {body.poisson_ratio:g}: expected from 0 to 0.5")


def half_length(shape: Any, depth: float) -> float:
    """Return |x| where the surface is as high as the depth, on the farther side of the lowest point."""

    def height(x: float) -> float:
        """Return the height, at most twice the depth: that of a steep shape overflows far away."""
        try:
            with np.errstate(over="ignore"):
                return min(float(shape.height(x)), 2.0 * depth)
        except OverflowError:
            return 2.0 * depth

    def above(x: float) -> float:
        return min(height(-x), height(x)) - depth

    inner = shape.reach * (1.0 - 1e-12)
    far = min(depth, inner)
    while far < inner and above(far) < 0.0:
        far = min(2.0 * far, inner)
    return float(brentq(above, 0.0, far, xtol=1e-300, rtol=1e-6)) if above(far) > 0.0 else far


def first_grid(shape: Any, body: Body, depth: float) -> Found:
    """Return a coarse grid for a contact at a depth, and all cells below the surface in contact."""
    a, H = half_length(shape, depth), body.thickness
    base = 1.0 if math.isinf(H) else H
    length = base * 2.0 ** (math.floor(2.0 * math.log2(2.0 * a / COARSE / base)) / 2.0)
    length = min(length, H / THINNEST)
    n = math.ceil(a / length) + 2
    if n > FINEST[shape.per_width]:
        message = "is too thin for this contact; expected independent elements of its stiffness"
        raise ValueError(f"`thickness` = {H:g} m {message}")
    width = None if shape.per_width else float(shape.stretch)
    grid = Grid(length, -n, n, 1 if width is None else n, width)
    _require_convex(shape, grid.x[:, 0])
    return Found(grid, Contact(np.where(grid.height(shape, 0.0) < depth, 1e-9 * depth, 0.0), depth))


def _require_convex(shape: Any, x: Array) -> None:
    """Raise ValueError if the slope of a shape falls somewhere: it may have more than one contact."""
    with np.errstate(over="ignore"):
        slopes = shape.slope(x[np.abs(x) < shape.reach])
    slopes = slopes[np.isfinite(slopes)]
    if np.any(np.diff(slopes) < -1e-9 * np.abs(slopes).max()):
        raise ValueError(
            f"{shape.words} is not convex, as it has to be here: its contact may not be one"
        )


def depth_under(shape: Any, body: Body, velocity: float, support: Support) -> Found:
    """Return the contact under the load of a support, on a coarse grid for nearly its depth."""
    depth = _first_depth(shape, body, support)
    for _ in range(60):
        found = first_grid(shape, body, depth).settled(shape, body, velocity, support)
        if abs(math.log(found.contact.depth / depth)) < CLOSE:
            return found
        depth = found.contact.depth
    raise ArithmeticError("no depth was found that carries the load")


def _first_depth(shape: Any, body: Body, support: Support) -> float:
    """Return a depth of the order of that which carries a load: a wave of the length of the contact."""

    def excess(log_depth: float) -> float:
        depth = math.exp(log_depth)
        a = half_length(shape, depth)
        area = 2.0 * a if shape.per_width else math.pi * a * a * shape.stretch
        T = float(compliance.transform(body.thickness / a, body.poisson_ratio))
        load = area * depth / (body.compliance * T * a) + support.spring * depth
        return math.log(load / support.carried)

    return math.exp(brentq(excess, -60.0, 20.0, xtol=0.1))
