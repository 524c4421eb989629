"""Stability of steady sliding on any law with a response to e^(st), on a spring in the drive (theorem F24).

The law of the foundation gives the response of a parabola (`kvtheory.theory.laws`); a ball is the sum of
its strips, by Gauss's rule in the angle whose cosine is the half length of a strip over the largest.

A stiffness k_x(s) = D - M_x s^2 - c_x s - B C/(M s^2 + k_s + A) belongs to each rate s. A stiff spring
keeps sliding stable. As it softens, two rates enter or leave the right half plane at each frequency
where k_x(i omega) is real and positive: they enter where its imaginary part falls through zero over the
frequency, and leave where it rises. These frequencies, found in the cells of a grid, give the
ranges of stable stiffness.

The equation for the rates is transcendental and has infinitely many roots, finitely many to the right of any
line. The least stable ones are found by Newton's method from many starts; the argument principle counts
whether any is missing.
"""

from collections.abc import Callable
from functools import cache, reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball_viscoelastic, viscoelastic
from kvtheory.scene.model import Scene
from kvtheory.theory.laws import Law

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

STATEMENT = (
    "memory integrals in closed form, checked by quadrature, with first-order bounds of rounding and of "
    "sums over strips; critical stiffnesses from a grid of frequencies that follows resonances; "
    "the least stable rates, counted by the argument principle (an error of infinity: the count differs)"
)
AT_REST = 1e-9
"""V tau_i/c of the slowest arm in the slow sliding that replaces rest."""
PER_DECADE, ROUGHLY, BEYOND = 48, 20, 2.0
"""Frequencies per decade, for one velocity and for many; decades searched beyond the scales of a scene."""
LOWER, LOWER_COUNT = 10.0, 16
"""Further decades for soft springs near the maximum of friction, and their number of frequencies."""
TURN, REFINEMENTS, CLOSER = 0.4, 24, 3
"""Phase change above which a cell is halved, most halvings, and halvings of the cells at a zero."""
NEARBY = 1e-5
"""Relative step of frequencies, rates and velocities in difference quotients."""
ROUNDING, IN_STRIPS = 16 * 2.0**-52, ball_viscoelastic.RELATIVE_ERROR
"""Relative error of the response of a parabola, and of a ball in any number of strips."""
FEW, STRIPS, MORE, MOST = 6, 24, 4, 384
"""Strips of half a ball: to search for rates and unstable velocities, for crossings at first, the factor by
which these increase until the error is small, and the most. Twice as many give the error."""
ACCURATE = 1e-8
"""Relative error of a critical stiffness below which the number of strips is not increased."""
POLISHING, MOVED, CONVERGING = 4, 0.1, 1e-7
"""Newton steps that refine a root, its largest change, and the step whose square is the error after it."""
NEWTON_STEPS, SETTLED, SAME = 60, 1e-9, 1e-6
"""Most Newton steps, tolerance of the relative step, and relative distance of roots taken as equal."""
ANGLES, RADII = 9, 5
"""Starts of Newton's method: directions in the upper half plane, and distances per decade."""
Zeros = tuple[NDArray[np.int_], Array, NDArray[np.int_]]
"""Zeros of the imaginary part of k_x: their scenes, logarithms of frequency, and directions: 1 where softer
springs have two more unstable rates, and -1 where they have two fewer."""
FAR = 100.0
"""Stands for |ln(critical stiffness/stiffness)| where there is no critical stiffness."""
SPEEDS, SPEED_DECADES = 6, 4.0
"""Velocities per decade, and decades beyond c/V = tau_i, in the search for the critical velocity."""


class Contact(NamedTuple):
    """Steady contacts of flat scenes, in strips along the first axis; a line is one strip."""

    scene: Scene
    """At velocities above zero."""
    law: Law
    """Over the distance travelled."""
    c: Array
    eta: Array
    width: Array
    """Of the strips; 1 for a line."""

    @classmethod
    def of(cls, scene: Scene, strips: int = 1) -> "Contact":
        """Return the contacts of parabolas, or of balls in strips."""
        law, foundation = viscoelastic.law(scene), scene.foundation
        if scene.indenter.per_width:
            c = viscoelastic.contact_length(scene, law)[np.newaxis]
            width = np.ones_like(c)
        else:
            middle = ball_viscoelastic.contact_length(scene, law)
            half = middle * viscoelastic.growth(law.moments(middle))[0]
            angles, weights = (0.25 * np.pi * x for x in np.polynomial.legendre.leggauss(strips))
            cosines = np.cos(0.25 * np.pi + angles)
            c = np.stack([viscoelastic.length_at_half(law, half * cosine) for cosine in cosines])
            width = 2.0 * scene.indenter.stretch * half * (cosines * weights)[:, np.newaxis]
        eta = np.stack([law.moments(each).eta for each in c])
        times = [arm.relaxation_time for arm in foundation.arms] or [foundation.retardation_time]
        least = AT_REST * c.max(axis=0) / reduce(np.maximum, times)
        moving = scene.at(np.maximum(np.abs(scene.drive.final_velocity), least))
        return cls(moving, viscoelastic.law(moving), c, eta, width)

    def rows(self, index: Any) -> "Contact":
        """Return some of the scenes."""
        c, eta, width = (each[:, index] for each in self[2:])
        return Contact(self.scene.rows(index), self.law.at(index), c, eta, width)

    def stiffness(self, s: Complex) -> tuple[Complex, Complex, Array]:
        """Return k_x at the rate s, the vertical dynamic stiffness, and the magnitude of the terms of k_x."""
        scene, support = self.scene, self.scene.support
        slope, share = self.c / scene.indenter.radius, self.c * self.width
        A, B, C, D = self.law.response(self.c, self.eta, s * (self.c / scene.drive.final_velocity))
        each = A, slope * B, slope * C, slope * slope * D
        A, B, C, D = ((share * term).sum(axis=0) for term in each)
        along = D - s * (scene.drive_mass * s + scene.drive.damping)
        if scene.held:
            return along, np.ones_like(s), np.abs(D)
        across = s * s * support.mass + support.spring + A
        coupled = B * C / across
        size = np.abs(s * s) * support.mass + support.spring + np.abs(A)
        return along - coupled, across, np.abs(D) + np.abs(coupled) * (1.0 + size / np.abs(across))

    def on_axis(self, row: Any, log: Array) -> tuple[Complex, Complex, Array]:
        """Return the same for some scenes at the angular frequencies e^log."""
        return self.rows(row).stiffness(1j * np.exp(log))

    @property
    def rounding(self) -> float:
        """Relative error of the response."""
        return ROUNDING if len(self.c) == 1 else IN_STRIPS

    @property
    def relaxing(self) -> Array:
        """The rates of the law in 1/s, along the first axis: of arms, and of a damper beside the springs."""
        V, law = self.scene.drive.final_velocity, self.law
        found = [*(V / law.time)]
        if law.damping is not None:
            damped, passing = law.damping > 0.0, (V / self.c).min(axis=0)
            C = np.where(damped, law.damping, 1.0)
            springs = law.K, law.K + law.stiffness.sum(axis=0)
            found += [np.where(damped, V * K / C, passing) for K in springs]
        return np.stack(found)

    def scales(self) -> Array:
        """Return the characteristic rates of each scene in 1/s, along the first axis."""
        V, law, support = self.scene.drive.final_velocity, self.law, self.scene.support
        found = [*self.relaxing, (V / self.c).min(axis=0), (V / self.c).max(axis=0)]
        if not self.scene.held:
            soft = (self.c * self.width).sum(axis=0) * law.K
            stiff = soft * (1.0 + law.stiffness.sum(axis=0) / law.K)
            found += [np.sqrt((support.spring + each) / support.mass) for each in (soft, stiff)]
        return np.stack(found)


def _zeros(given: Contact, per_decade: int = PER_DECADE) -> Zeros:
    """Return the zeros of all scenes, each in a cell of a grid that is refined at resonances."""
    from scipy.optimize import elementwise  # slow to import

    own = given.scales()
    low = np.log(own.min(axis=0)) - BEYOND * np.log(10.0)
    high = np.log(own.max(axis=0)) + BEYOND * np.log(10.0)
    fine = np.linspace(low, high, 2 + int(per_decade * np.max(high - low) / np.log(10.0)))
    soft = np.linspace(low - LOWER * np.log(10.0), low, LOWER_COUNT, endpoint=False)
    grid = np.concatenate([soft, fine]).T
    rows = np.broadcast_to(np.arange(len(grid))[:, np.newaxis], grid.shape).ravel()
    rows, log, k = _refined(given, rows, grid.ravel())
    cell = (rows[1:] == rows[:-1]) & ((k.imag[1:] > 0.0) != (k.imag[:-1] > 0.0))
    row, start, end = rows[:-1][cell], log[:-1][cell], log[1:][cell]
    way = np.where(k.imag[:-1][cell] > 0.0, 1, -1)

    def imaginary(log: Array, row: Any) -> Array:
        k, _, _ = given.on_axis(row, log)
        return k.imag

    return row, elementwise.find_root(imaginary, (start, end), args=(row,)).x, way


def _refined(given: Contact, rows: Any, log: Array) -> tuple[Any, Array, Complex]:
    """Halve cells until the grid resolves the resonances of the vertical motion."""
    k, across, _ = given.on_axis(rows, log)
    for turn in range(REFINEMENTS):
        same = rows[1:] == rows[:-1]
        wide = np.abs(np.angle(across[1:] / across[:-1])) > TURN
        if turn < CLOSER:
            zero = same & ((k.imag[1:] > 0.0) != (k.imag[:-1] > 0.0))
            wide |= np.convolve(zero, np.ones(3), "same") > 0.0  # with both neighbours
        (at,) = np.nonzero(same & wide)
        if not at.size:
            break
        new, middle = rows[at], 0.5 * (log[at] + log[at + 1])
        more = given.on_axis(new, middle)
        rows, log, k, across = (
            np.insert(old, at + 1, add)
            for old, add in zip((rows, log, k, across), (new, middle, *more[:2]), strict=True)
        )
    return rows, log, k


def _polished(given: Contact, zeros: Zeros) -> Zeros:
    """Return the zeros for more strips, by Newton's method from these; NaN where one is lost."""
    row, first, way = zeros
    log = first
    for _ in range(POLISHING):
        low, here, high = (
            given.on_axis(row, log + step)[0].imag for step in (-NEARBY, 0.0, NEARBY)
        )
        with np.errstate(all="ignore"):
            log = log - 2.0 * NEARBY * here / (high - low)
    return row, np.where(np.abs(log - first) < MOVED, log, np.nan), way


class Crossings(NamedTuple):
    """Where two rates cross the imaginary axis at a positive stiffness, with relative errors."""

    row: NDArray[np.int_]
    stiffness: Array
    omega: Array
    way: NDArray[np.int_]
    error: Array
    omega_error: Array

    @classmethod
    def at(cls, given: Contact, finer: Contact, zeros: Zeros) -> "Crossings":
        """Return those at the zeros, with errors to first order; `finer` has twice the strips."""
        row, log, way = zeros
        k, _, size = given.on_axis(row, log)
        near = [given.on_axis(row, log + step)[0] for step in (-NEARBY, NEARBY)]
        slope = (near[1] - near[0]) / (2.0 * NEARBY)
        doubt = given.rounding * size + 2.0 * np.abs(finer.on_axis(row, log)[0] - k)
        omega = np.exp(log)
        with np.errstate(divide="ignore"):
            off = doubt / np.abs(slope.imag) + ROUNDING
        inertia = given.scene.rows(row).drive_mass * omega * omega
        wrong = np.abs(slope.real) * off + doubt + ROUNDING * inertia
        parts: tuple[Any, ...] = (row, k.real, omega, way, wrong / np.abs(k.real), off)
        return cls(*(each[k.real > 0.0] for each in parts))

    def unstable(self, spring: Array) -> NDArray[np.bool_]:
        """Return whether a spring of each scene has rates in the right half plane."""
        beyond = self.stiffness > spring[self.row]
        return np.bincount(self.row, self.way * beyond, len(spring)) > 0.5


class SmallMotions:
    """Contacts of flat scenes in few strips, in enough and in twice as many; and all crossings."""

    def __init__(self, scene: Scene) -> None:
        self.size = scene.shape[0]
        if scene.indenter.per_width:
            self.few = self.fine = self.finer = Contact.of(scene)
            self.crossings = Crossings.at(self.few, self.few, _zeros(self.few))
            return
        self.few, self.fine, strips = Contact.of(scene, FEW), Contact.of(scene, STRIPS), STRIPS
        known = _zeros(self.fine)
        while True:
            self.finer = Contact.of(scene, 2 * strips)
            self.crossings = Crossings.at(self.fine, self.finer, known)
            if strips >= MOST or (self.crossings.error <= ACCURATE).all():
                return
            strips *= MORE
            self.fine = Contact.of(scene, strips)
            known = _polished(self.fine, known)
            if np.isnan(known[1]).any():
                known = _zeros(self.fine)

    def critical(self) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Return upper and lower critical stiffness (stable ranges may be between), frequency, errors."""
        found, (upper, lower) = self.crossings, np.full((2, 4, self.size), np.nan)
        hertz = found.omega / (2.0 * np.pi)
        known = np.stack([found.stiffness, hertz, found.error, found.omega_error])
        order = np.argsort(found.stiffness)  # the last one written for a scene stays
        for each, places in ((upper, order), (lower, order[::-1])):
            for i in places:
                each[:, found.row[i]] = known[:, i]
        lower[:, found.unstable(np.zeros(self.size))] = 0.0
        return (upper[0], lower[0], upper[1]), (upper[2], lower[2], upper[3])

    def stable(self, spring: Array) -> NDArray[np.bool_]:
        """Return whether sliding on a spring of each scene is stable."""
        return ~self.crossings.unstable(spring)

    def rates(self, spring: Array | None) -> tuple[Complex, Array]:
        """Return the least stable rates of each scene, as many as on Kelvin-Voigt, and their relative errors.

        NaN where fewer are found, as at rest; infinite errors where the argument principle counts others.
        """
        pairs = []
        for i in range(self.size):
            few, fine, finer = (each.rows([i]) for each in (self.few, self.fine, self.finer))
            pairs.append(_rates(few, fine, finer, None if spring is None else float(spring[i])))
        s, errors = zip(*pairs, strict=True)
        return np.array(s), np.array(errors)


Value = Callable[..., Complex]
"""The function whose zeros are the rates, in the strips of a contact."""


@np.errstate(all="ignore")
def _rates(
    given: Contact, fine: Contact, finer: Contact, spring: float | None
) -> tuple[Complex, Array]:
    """Find and count the rates of one scene in the strips of `given`; refine them in those of `fine`."""
    degree = 2 * ((spring is not None) + (not given.scene.held))
    own = given.scales()[:, 0]
    if spring is not None:
        own = np.append(own, np.sqrt(spring / given.scene.drive_mass))

    def value(s: Complex, given: Contact = given) -> Complex:
        k, across, _ = given.stiffness(s)
        return across if spring is None else across * (spring - k)

    def slope(s: Complex) -> Complex:
        h = NEARBY * s
        return (value(s + h, fine) - value(s - h, fine)) / (2.0 * h)

    s = _newton(given, value, own)
    s = np.append(s, s[s.imag > SAME * np.abs(s)].conj())
    s = s[np.lexsort((s.imag, -s.real))]
    missed = False
    if s.size:
        last = s[min(degree, len(s)) - 1].real
        left = s.real[s.real < last - SAME * abs(last)]
        line = 0.5 * (last + left[0]) if left.size else 1.05 * last
        missed = _count(value, line, degree, own) != np.count_nonzero(s.real > line)
    s = first = s[:degree]
    for _ in range(POLISHING):
        s = s - value(s, fine) / slope(s)
    k, across, size = fine.stiffness(s)
    if spring is None:
        size = np.abs(s * s) * given.scene.support.mass + np.abs(across)
    else:
        size = np.abs(across) * (spring + np.abs(k) + size)
    f = value(s, fine)
    off = np.abs(f) + given.rounding * size + 2.0 * np.abs(value(s, finer) - f)
    error = off / np.abs(slope(s) * s) + ROUNDING
    astray = missed | ~(np.abs(s - first) < MOVED * np.abs(first))
    order = np.lexsort((s.imag, -s.real))
    found, errors = np.full(degree, np.nan, complex), np.full(degree, np.inf)
    found[: s.size], errors[: s.size] = s[order], np.where(astray, np.inf, error)[order]
    return found, errors


def _newton(given: Contact, value: Value, own: Array) -> Complex:
    """Return the roots in the closed upper half plane that Newton's method reaches, each once."""
    low, high = np.log10(own).min() - BEYOND, np.log10(own).max() + BEYOND
    radii = np.logspace(low, high, int(RADII * (high - low)))
    polar = radii[:, np.newaxis] * np.exp(1j * np.linspace(0.0, np.pi, ANGLES))
    V = given.scene.drive.final_velocity
    passing = (V / given.c).min()
    chain = passing * (np.arange(-1.0, 12.0, 2.0)[:, np.newaxis] - 1j * np.linspace(0.0, 60.0, 16))
    arms = (V / given.law.time)[:, 0]
    s = np.concatenate([polar.ravel(), *(-rate - chain.ravel() for rate in arms)])
    moving = np.arange(s.size)
    for _ in range(NEWTON_STEPS):
        here = s[moving]
        f, h = value(here), NEARBY * here
        step = h * f / (value(here + h) - f)
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
    return s[kept]


def _count(value: Value, line: float, degree: int, own: Array) -> int:
    """Return the number of roots right of a line by the argument principle."""
    logs = np.append(np.log(own), np.log(abs(line)))
    omega = np.exp(np.linspace(logs.min() - 7.0, logs.max() + 9.0, 2000))
    omega = np.insert(omega, 0, 0.0)
    f = value(line + 1j * omega)
    for _ in range(REFINEMENTS):
        (at,) = np.nonzero(np.abs(np.angle(f[1:] / f[:-1])) > TURN)
        if not at.size:
            break
        middle = 0.5 * (omega[at] + omega[at + 1])
        f = np.insert(f, at + 1, value(line + 1j * middle))
        omega = np.insert(omega, at + 1, middle)
    turned = np.angle(f[1:] / f[:-1]).sum()
    return round(0.5 * degree - turned / np.pi) if np.isfinite(turned) else -1


def critical_velocity(scene: Scene) -> tuple[Array, Array]:
    """Return the smallest velocity at which each of flat scenes becomes unstable, or NaN, and its error."""
    each = [_critical_velocity(scene.rows(slice(i, i + 1))) for i in range(*scene.shape)]
    velocity, error = np.reshape(each, (-1, 2)).T
    return velocity, error


def _critical_velocity(scene: Scene) -> tuple[float, float]:
    """Return that of one scene: the first change on a grid of velocities, then Brent's method."""
    from scipy.optimize import brentq

    spring = np.broadcast_to(scene.drive.stiffness, (1,))
    given = Contact.of(scene.at(np.ones(1)), STRIPS)
    length = np.log10(given.c.max() * given.relaxing)
    low, high = length.min() - SPEED_DECADES, length.max() + SPEED_DECADES

    def there(log: Array) -> Scene:
        return scene.rows(np.zeros(log.size, int)).at(10.0**log)

    def found(log: Array, strips: int, per_decade: int) -> Crossings:
        coarse = Contact.of(there(log), strips)
        return Crossings.at(coarse, coarse, _zeros(coarse, per_decade))

    @cache
    def signed(log: float) -> float:
        each = found(np.array([log]), FEW, PER_DECADE)
        if not each.row.size:
            return -FAR
        distance = float(np.min(np.abs(np.log(each.stiffness / spring))))
        return distance if each.unstable(spring)[0] else -distance

    grid = np.linspace(low, high, 1 + int(SPEEDS * (high - low)))
    now = found(grid, FEW, ROUGHLY).unstable(np.repeat(spring, grid.size))
    (change,) = np.nonzero(now[1:] & ~now[:-1])
    if not change.size:
        return np.nan, np.nan
    bracket = float(grid[change[0]]), float(grid[change[0] + 1])
    if not signed(bracket[0]) < 0.0 < signed(bracket[1]):  # on a finer grid it left the cell
        bracket = bracket[0] - 1.0 / SPEEDS, bracket[1] + 1.0 / SPEEDS
    onset = brentq(signed, *bracket, xtol=1e-15)
    for _ in range(POLISHING):  # in more strips than `signed` has
        near = SmallMotions(there(onset + NEARBY * np.array([-1.0, 0.0, 1.0])))
        each, distance = near.crossings, np.log(near.crossings.stiffness / spring)
        nearest = [
            min(np.flatnonzero(each.row == side), key=lambda i: abs(distance[i]), default=-1)
            for side in range(3)
        ]
        if min(nearest) < 0:  # a very soft spring is first unstable at the friction maximum
            return 10.0**onset, np.inf
        off = distance[nearest]
        rise = (off[2] - off[0]) / (2.0 * NEARBY)
        miss, doubt = off[1] / rise, each.error[nearest[1]] / abs(rise)
        onset -= miss
        if abs(miss) <= CONVERGING:
            break
    return 10.0**onset, np.log(10.0) * (doubt + miss * miss) + ROUNDING * (1.0 + abs(onset))
