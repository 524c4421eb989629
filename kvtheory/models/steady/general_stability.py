"""Stability of steady sliding on any law with a response to e^(st), with a spring in the drive (theorem F24).

A stiffness k_x(s) = D - M_x s^2 - c_x s - B C/(M s^2 + k_s + A) belongs to each rate s. A stiff spring
keeps sliding stable. On the way to a soft one two rates enter or leave the right half plane at each frequency
where k_x(i omega) is real and positive: they enter where its imaginary part falls through zero over the
frequency, and leave where it rises. All these frequencies, found on a grid and bisected, tell which
stiffnesses are stable.

The equation for the rates is transcendental and has infinitely many roots, finitely many to the right of any
line. The least stable ones are found by Newton's method from many starts; the argument principle counts
whether any is missing.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball_viscoelastic
from kvtheory.models.steady.small_motions import Complex, Contact, contact
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]

PER_DECADE, ROUGHLY, BEYOND = 48, 20, 2.0
"""Frequencies per decade, of one velocity and of many; and decades beyond the times of a scene."""
LOWER, LOWER_COUNT = 10.0, 16
"""Further decades for soft springs next to the maximum of friction, where nothing else changes."""
TURN, REFINEMENTS, CLOSER = 0.4, 24, 3
"""Phase in a cell above which it is halved, the most halvings, and those of the cells at a zero."""
BISECTIONS = 52
NEARBY = 1e-5
"""Relative difference of frequencies, of rates and of velocities for slopes."""
ROUNDING, IN_STRIPS = 16 * 2.0**-52, ball_viscoelastic.RELATIVE_ERROR
"""Relative error of the response of a parabola, and of a ball in any number of strips."""
STRIPS, MORE, MOST = 24, 4, 384
"""Strips of half a ball, the factor by which they grow until the error is small, and the most of them. Twice
as many show the error."""
FEW = 6
"""Strips in which rates and unstable velocities are looked for, before they are followed into more."""
ACCURATE = 1e-8
"""Relative error of a critical stiffness that needs no more strips."""
POLISHING, MOVED = 4, 0.1
"""Newton steps from the roots in few strips to those in more, and how far a logarithm may move."""
NEWTON_STEPS, SETTLED, SAME = 60, 1e-9, 1e-6
ANGLES, RADII = 9, 5
"""Starts of Newton's method: directions in the upper half plane, and distances per decade."""
FAR = 100.0
"""Distance in logarithms of a stiffness from a critical one that does not exist."""
SPEEDS, SPEED_DECADES = 6, 4.0
"""Velocities per decade, and decades beyond c/V = tau_i, among which the critical velocity is sought."""


class Crossings(NamedTuple):
    """Where two rates cross the imaginary axis, with relative errors.

    `way` is 1 where softer springs have two more unstable rates, and -1 where they have two fewer.
    """

    row: NDArray[np.int_]
    stiffness: Array
    omega: Array
    way: NDArray[np.int_]
    error: Array
    omega_error: Array

    def unstable(self, stiffness: Array) -> NDArray[np.bool_]:
        """Return whether a spring of each scene has rates in the right half plane."""
        beyond = self.stiffness > stiffness[self.row]
        return np.bincount(self.row, self.way * beyond, len(stiffness)) > 0.5


def scales(given: Contact) -> Array:
    """Return the rates in 1/s that a scene brings along, on the first axis."""
    passing, law = given.V / given.c, given.law
    found = [*(given.V / law.time), passing.min(axis=0), passing.max(axis=0)]
    if law.damping is not None:
        found.append(given.V * law.K / law.damping)
    if not given.held:
        soft = (given.c * given.width).sum(axis=0) * law.K
        stiff = soft * (1.0 + law.stiffness.sum(axis=0) / law.K)
        found += [np.sqrt((given.spring + each) / given.mass) for each in (soft, stiff)]
    return np.stack(found)


Places = tuple[NDArray[np.int_], Array, NDArray[np.int_]]
"""Scenes, logarithms of frequencies, and ways of crossings."""


def places(given: Contact, per_decade: int = PER_DECADE) -> Places:
    """Return where the imaginary part of the stiffness changes its sign, by bisection on a grid."""
    own = scales(given)
    low, high = (np.log(own.min(axis=0)), np.log(own.max(axis=0)))
    low, high = low - BEYOND * np.log(10.0), high + BEYOND * np.log(10.0)
    fine = np.linspace(low, high, 2 + int(per_decade * np.max(high - low) / np.log(10.0)))
    soft = np.linspace(low - LOWER * np.log(10.0), low, LOWER_COUNT, endpoint=False)
    log = np.concatenate([soft, fine]).T
    rows = np.broadcast_to(np.arange(len(log))[:, np.newaxis], log.shape).ravel()
    rows, log, k, _ = refined(given, rows, log.ravel())
    cell = (rows[1:] == rows[:-1]) & ((k.imag[1:] > 0.0) != (k.imag[:-1] > 0.0))
    row, start, end = rows[:-1][cell], log[:-1][cell], log[1:][cell]
    way = np.where(k.imag[:-1][cell] > 0.0, 1, -1)
    for _ in range(BISECTIONS):
        middle = 0.5 * (start + end)
        before = (stiffness(given, row, middle)[0].imag > 0.0) == (way > 0)
        start, end = np.where(before, middle, start), np.where(before, end, middle)
    return row, 0.5 * (start + end), way


def moved(given: Contact, found: Places) -> Places:
    """Return the places in other strips, by Newton's method from those in fewer; NaN where they are lost."""
    row, start, way = found
    log = start.copy()
    for _ in range(POLISHING):
        low, here, high = (
            stiffness(given, row, log + step)[0].imag for step in (-NEARBY, 0.0, NEARBY)
        )
        with np.errstate(all="ignore"):
            log = log - 2.0 * NEARBY * here / (high - low)
    return row, np.where(np.abs(log - start) < MOVED, log, np.nan), way


def crossings(given: Contact, finer: Contact, found: Places) -> Crossings:
    """Return those at a positive stiffness, with errors to first order; `finer` has twice as many strips."""
    row, log, way = found
    k, _, size = stiffness(given, row, log)
    near = [stiffness(given, row, log + step)[0] for step in (-NEARBY, NEARBY)]
    slope = (near[1] - near[0]) / (2.0 * NEARBY)
    doubt = _rounding(given) * size + 2.0 * np.abs(stiffness(finer, row, log)[0] - k)
    omega = np.exp(log)
    with np.errstate(divide="ignore"):
        off = doubt / np.abs(slope.imag) + ROUNDING
    inertia = given.mass_along[row] * omega * omega
    wrong = np.abs(slope.real) * off + doubt + ROUNDING * inertia
    some = k.real > 0.0
    parts = row, k.real, omega, way, wrong / np.abs(k.real), off
    chosen: list[Any] = [each[some] for each in parts]
    return Crossings(*chosen)


def _rounding(given: Contact) -> float:
    return ROUNDING if len(given.c) == 1 else IN_STRIPS


def stiffness(given: Contact, row: Any, log: Array) -> tuple[Complex, Complex, Array]:
    """Return `Contact.stiffness` on the imaginary axis."""
    return given.rows(row).stiffness(1j * np.exp(log))


def refined(given: Contact, rows: Any, log: Array) -> tuple[Any, Array, Complex, Complex]:
    """Halve cells until no resonance of the vertical motion is between two frequencies."""
    k, across, _ = stiffness(given, rows, log)
    for turn in range(REFINEMENTS):
        same = rows[1:] == rows[:-1]
        wide = np.abs(np.angle(across[1:] / across[:-1])) > TURN
        if turn < CLOSER:
            zero = same & ((k.imag[1:] > 0.0) != (k.imag[:-1] > 0.0))
            wide |= zero
            wide[1:] |= zero[:-1]
            wide[:-1] |= zero[1:]
        (at,) = np.nonzero(same & wide)
        if not at.size:
            break
        new, middle = rows[at], 0.5 * (log[at] + log[at + 1])
        more = stiffness(given, new, middle)
        rows, log, k, across = (
            np.insert(old, at + 1, add)
            for old, add in zip((rows, log, k, across), (new, middle, *more[:2]), strict=True)
        )
    return rows, log, k, across


def critical(found: Crossings, count: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the critical stiffnesses and the frequency of the upper one by name, and their errors.

    Between the lower and the upper one there may be stable ranges too.
    """
    upper, lower = np.full((2, 4, count), np.nan)
    order = np.argsort(found.stiffness)  # of several of a scene the last one written stays
    known = np.stack([found.stiffness, found.omega / (2.0 * np.pi), found.error, found.omega_error])
    for each, places in ((upper, order), (lower, order[::-1])):
        for i in places:
            each[:, found.row[i]] = known[:, i]
    lower[:, found.unstable(np.zeros(count))] = 0.0
    values = upper[0], lower[0], upper[1]
    names = "critical_stiffness", "lower_critical_stiffness", "frequency"
    errors = upper[2], lower[2], upper[3]
    return dict(zip(names, values, strict=True)), dict(zip(names, errors, strict=True))


def solve(scene: Scene) -> tuple[Contact, Contact, Contact, Crossings]:
    """Return what small motions see in few strips, in enough, and in twice as many, and all crossings.

    They are found in few strips and followed into more; where one is lost on the way, all are sought again.
    """
    given = contact(scene, STRIPS)
    if scene.indenter.per_width:
        return given, given, given, crossings(given, given, places(given))
    few, strips, known = contact(scene, FEW), STRIPS, places(given)
    while True:
        finer = contact(scene, 2 * strips)
        found = crossings(given, finer, known)
        if strips >= MOST or (found.error <= ACCURATE).all():
            return few, given, finer, found
        strips *= MORE
        given = contact(scene, strips)
        known = moved(given, known)
        if np.isnan(known[1]).any():
            known = places(given)


def rates(
    given: Contact, fine: Contact, finer: Contact, spring: float | None
) -> tuple[Complex, Array]:
    """Return the least stable rates of one scene and their relative errors: as many as on Kelvin-Voigt.

    They are sought and counted in the strips of `given`, and followed into those of `fine`; those of `finer`
    show the error.

    These are four, or two for a rigid drive or a fixed indenter, and none for both; NaN where fewer are
    found, as next to rest, where those left of -1/tau_i of the slowest arm do not exist. An infinite error
    says that the count of the argument principle differs.
    """
    degree = 2 * ((spring is not None) + (not given.held))
    if not degree:
        return np.empty(0, complex), np.empty(0)

    def value(s: Complex, given: Contact = given) -> tuple[Any, Any]:
        k, across, size = given.rows(np.zeros(s.shape, int)).stiffness(s)
        if spring is None:
            return across, np.abs(s * s) * given.mass + np.abs(across)
        return across * (spring - k), np.abs(across) * (spring + np.abs(k) + size)

    with np.errstate(all="ignore"):
        found, error = _newton((given, fine, finer), value, spring)
    upper = found.imag > SAME * np.abs(found)
    found = np.concatenate([found, found[upper].conj()])
    error = np.concatenate([error, error[upper]])
    order = np.lexsort((found.imag, -found.real))
    found, error = found[order], error[order]
    if not found.size:
        return np.full(degree, np.nan, complex), np.full(degree, np.inf)
    last = found[min(degree, len(found)) - 1].real
    left = found.real[found.real < last - SAME * abs(last)]
    line = 0.5 * (last + left[0]) if left.size else 1.05 * last
    if _count(given, value, line, degree, spring) != np.count_nonzero(found.real > line):
        error = np.full_like(error, np.inf)
    short = max(degree - len(found), 0)
    found = np.append(found, np.full(short, np.nan))
    error = np.append(error, np.full(short, np.inf))
    return found[:degree], error[:degree]


def _range(given: Contact, spring: float | None) -> Array:
    own = scales(given)[:, 0]
    return own if spring is None else np.append(own, np.sqrt(spring / given.mass_along))


def _newton(
    strips: tuple[Contact, Contact, Contact], value: Any, spring: float | None
) -> tuple[Complex, Array]:
    """Return the roots in the closed upper half plane that Newton's method reaches, and their errors."""
    given, fine, finer = strips
    own = np.log10(_range(given, spring))
    low, high = own.min() - BEYOND, own.max() + BEYOND
    radii = np.logspace(low, high, int(RADII * (high - low)))
    polar = radii[:, np.newaxis] * np.exp(1j * np.linspace(0.0, np.pi, ANGLES))
    passing = (given.V / given.c).min()
    chain = passing * (np.arange(-1.0, 12.0, 2.0)[:, np.newaxis] - 1j * np.linspace(0.0, 60.0, 16))
    s = np.concatenate(
        [polar.ravel(), *(-rate - chain.ravel() for rate in (given.V / given.law.time)[:, 0])]
    )
    moving = np.arange(s.size)
    for _ in range(NEWTON_STEPS):
        here = s[moving]
        f, h = value(here)[0], NEARBY * here
        step = h * f / (value(here + h)[0] - f)
        limited = np.minimum(1.0, 0.5 * np.abs(here) / np.abs(step))
        s[moving] = np.where(np.isfinite(step), here - limited * step, np.nan)
        moving = moving[np.abs(step) > SETTLED * np.abs(here)]
        if not moving.size:
            break
    s[moving] = np.nan
    s = s[np.isfinite(s)]
    s = np.where(np.abs(s.imag) < SETTLED * np.abs(s), s.real, s.real + 1j * np.abs(s.imag))
    kept: list[int] = []
    for i in np.argsort(-s.real):
        if all(abs(s[i] - s[j]) > SAME * abs(s[i]) for j in kept):
            kept.append(i)
    s = s[kept]
    for _ in range(POLISHING if fine is not given else 0):
        h = NEARBY * s
        s = s - 2.0 * h * value(s, fine)[0] / (value(s + h, fine)[0] - value(s - h, fine)[0])
    s = s[np.isfinite(s)]
    (f, size), h = value(s, fine), NEARBY * s
    slope = (value(s + h, fine)[0] - value(s - h, fine)[0]) / (2.0 * h)
    off = np.abs(f) + _rounding(given) * size + 2.0 * np.abs(value(s, finer)[0] - f)
    return s, off / np.abs(slope * s) + ROUNDING


def _count(given: Contact, value: Any, line: float, degree: int, spring: float | None) -> int:
    """Return the number of roots right of a line by the argument principle."""
    own = np.append(np.log(_range(given, spring)), np.log(abs(line)))
    omega = np.exp(np.linspace(own.min() - 7.0, own.max() + 9.0, 2000))
    omega = np.insert(omega, 0, 0.0)
    with np.errstate(all="ignore"):
        f = value(line + 1j * omega)[0]
        for _ in range(REFINEMENTS):
            (at,) = np.nonzero(np.abs(np.angle(f[1:] / f[:-1])) > TURN)
            if not at.size:
                break
            middle = 0.5 * (omega[at] + omega[at + 1])
            f = np.insert(f, at + 1, value(line + 1j * middle)[0])
            omega = np.insert(omega, at + 1, middle)
    turned = np.angle(f[1:] / f[:-1]).sum()
    return round(0.5 * degree - turned / np.pi) if np.isfinite(turned) else -1


def critical_velocity(scene: Scene) -> tuple[float, float]:
    """Return the smallest velocity at which one scene becomes unstable, or NaN, and its error."""
    given = contact(scene.at(np.ones(1)), STRIPS)
    length = np.log10(given.c.max() * given.V / given.law.time)
    low, high = length.min() - SPEED_DECADES, length.max() + SPEED_DECADES
    spring = np.broadcast_to(scene.drive.stiffness, (1,))

    def there(log: Array, strips: int) -> Contact:
        return contact(scene.rows(np.zeros(log.size, int)).at(10.0**log), strips)

    def found(log: Array, strips: int = STRIPS, per_decade: int = PER_DECADE) -> Crossings:
        coarse = there(log, strips)
        return crossings(coarse, coarse, places(coarse, per_decade))

    def signed(log: float) -> float:
        each = found(np.array([log]))
        if not each.row.size:
            return -FAR
        distance = float(np.min(np.abs(np.log(each.stiffness / spring))))
        return distance if each.unstable(spring)[0] else -distance

    grid = np.linspace(low, high, 1 + int(SPEEDS * (high - low)))
    now = found(grid, FEW, ROUGHLY).unstable(np.repeat(spring, grid.size))
    (change,) = np.nonzero(now[1:] & ~now[:-1])
    if not change.size:
        return np.nan, np.nan
    bracket = grid[change[0]], grid[change[0] + 1]
    if (
        not signed(bracket[0]) < 0.0 < signed(bracket[1])
    ):  # in more strips it is next to a point of the grid
        bracket = bracket[0] - 1.0 / SPEEDS, bracket[1] + 1.0 / SPEEDS

    from scipy.optimize import brentq

    onset = brentq(signed, *bracket, xtol=1e-15)
    strips = STRIPS
    own = found(np.array([onset]))
    if not own.row.size:
        return 10.0**onset, np.inf
    log = np.log(own.omega[[np.argmin(np.abs(own.stiffness / spring - 1.0))]])

    def crossing(onset: float, finer: int = 1) -> Crossings:
        """Return the crossing at a velocity, followed from the one at the onset in few strips."""
        here = there(np.array([onset]), strips)
        place = moved(here, (np.zeros(1, int), log, np.ones(1, int)))
        return crossings(here, there(np.array([onset]), finer * strips), place)

    while True:
        for _ in range(0 if scene.indenter.per_width or strips == STRIPS else POLISHING):
            k = [crossing(onset + side * NEARBY).stiffness for side in (-1.0, 1.0)]
            if not all(each.size for each in k):
                return 10.0**onset, np.inf
            low, high = (float(np.log(each / spring)[0]) for each in k)
            onset -= NEARBY * (low + high) / (high - low)
        near = [crossing(onset + side * NEARBY, 2) for side in (-1.0, 1.0)]
        error = _velocity_error(near) + ROUNDING * (1.0 + abs(onset))
        if scene.indenter.per_width or strips >= MOST or error <= ACCURATE:
            return 10.0**onset, error
        strips *= MORE


def _velocity_error(near: list[Crossings]) -> float:
    """Return the error of the critical stiffness over its logarithmic derivative."""
    if not all(each.row.size for each in near):
        return np.inf
    before, after = (float(np.log(each.stiffness[0])) for each in near)
    with np.errstate(divide="ignore"):
        steepness = np.abs(after - before) / (2.0 * NEARBY * np.log(10.0))
        return float(near[1].error[0] / steepness)
