"""Motion of the base: its velocity V(t) as a piecewise polynomial, and the exact integral Y(t).

Every model takes V and Y from here; times and lengths may be in SI or scaled. At a jump, V is the value
just after it.
"""

import itertools
import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial, polynomial
from numpy.typing import NDArray

DEGREE = 8
"""Degree of the polynomials that approximate a function: a period of a sine takes a few pieces."""
CHECKS = 2 * DEGREE + 3
"""Number of points at which a piece is compared with its function, most of them between the nodes."""
SHORTEST = 1e-12
"""Shortest piece, as a fraction of the motion; if a shorter one is needed, there is a jump or a kink."""
PIECE_LIMIT = 100_000
EARLY, LOOKS, WIDER = 500, 16, 4.0
"""A function is refused early if `EARLY` pieces show that too many would be needed, and a piece `WIDER` times
as long represents it at none of `LOOKS` places."""
SAME_TIME = 1024.0
"""Times that differ by at most this many units in the last place count as equal."""
ON_REST = 16.0 * 2.0**-52
"""Rounding error of a velocity whose terms cancel, relative to these terms."""
START, END, DISPLACEMENT, POWERS = 0, 1, 2, 3
"""Layout of a piece: its times, Y at its start, then the coefficients of V in t - start."""

Piece = Sequence[float]
Span = tuple[float, float, tuple[float, ...]]
"""A piece without its displacement: its times, and the coefficients of V."""


@dataclass(frozen=True)
class BaseMotion:
    """V(t) in pieces; it may jump between pieces, and does not change sign within one.

    Each piece is (start, end, Y(start), c_0, c_1, ...), V = sum c_k (t - start)^k, all of one length. Within
    a piece the base moves one way: a model whose steps end with the pieces misses no reversal, however brief.
    A last piece of zero length gives V just after a jump at the end. `changes` are the times at which V may
    jump or have a kink. Before t = 0 the base is at rest.

    `depths` are the depth at the start of each piece, and its constant rate within it, of an indenter that is
    held at a depth that changes; else there are none.
    """

    pieces: tuple[tuple[float, ...], ...]
    changes: tuple[float, ...] = (0.0,)
    depths: tuple[tuple[float, float], ...] = ()

    @classmethod
    def constant(cls, velocity: float, end: float) -> "BaseMotion":
        """Return the start from rest: V = `velocity` from t = 0 to `end`."""
        return cls.from_points([(0.0, velocity)], end)

    @classmethod
    def from_points(cls, points: Sequence[tuple[float, float]], end: float) -> "BaseMotion":
        """Return the motion, linear between `points` (t, V), a jump where t repeats, then at a constant V.

        >>> motion = BaseMotion.from_points([(0.0, 0.0), (1.0, 2.0), (1.0, -1.0)], end=3.0)
        >>> [motion.at(t)[:2] for t in (0.5, 1.0, 3.0)]
        [(0.25, 1.0), (1.0, -1.0), (-1.0, -1.0)]
        """
        near = SAME_TIME * math.ulp(end)
        points = [(end if abs(t - end) <= near else t, velocity) for t, velocity in points]
        found = [
            (a, b, (left, (right - left) / (b - a)))
            for (a, left), (b, right) in itertools.pairwise(points)
            if b - a > SAME_TIME * math.ulp(b)
        ]
        last, velocity = points[-1]
        found.append((last, max(float(end), last), (velocity, 0.0)))
        return cls(_joined(_one_way(found)), tuple(start for start, _, _ in found))

    @classmethod
    def from_function(
        cls,
        function: Callable[[float], float],
        end: float,
        *,
        tolerance: float = 1e-12,
        breaks: Sequence[float] = (),
        least: float = 1.0,
    ) -> "BaseMotion":
        """Return a motion within `tolerance` x max(`least`, |V|) of `function` on [0, `end`].

        Pieces are Chebyshev interpolants, halved until they agree with the function at points between their
        nodes. `breaks` are the times at which the function jumps or has kinks; a function that needs too many
        halvings raises ValueError, as it must jump elsewhere or change too fast.

        >>> motion = BaseMotion.from_function(math.sin, end=6.0)
        >>> abs(motion.at(5.0)[0] - (1.0 - math.cos(5.0))) < 1e-12
        True
        """
        near = SAME_TIME * math.ulp(end)
        inner = sorted(t for t in breaks if near < t < end - near)
        inner = [b for a, b in itertools.pairwise([0.0, *inner]) if b - a > near]
        latest = min((t for t in breaks if abs(t - end) <= near), default=math.inf) - near
        todo = list(itertools.pairwise([0.0, *inner, end]))[::-1]
        found: list[Span] = []

        def value(t: float) -> float:
            return function(_beside(min(t, latest), breaks))

        def fits(a: float, b: float) -> bool:
            return _fit(value, a, b, least)[1] <= tolerance

        while todo:
            a, b = todo.pop()
            coefficients, error = _fit(value, a, b, least)
            if error <= tolerance:
                # The exact value of the function at the start, so that a base at rest stays at rest.
                found.append((a, b, (value(a), *coefficients[1:])))
                if len(found) != EARLY or end - b <= PIECE_LIMIT * (b - a):
                    continue
                wide = WIDER * (b - a)
                if not any(fits(t, t + wide) for t in np.linspace(b, end - wide, LOOKS).tolist()):
                    raise ValueError(
                        f"drive.function changes too fast: it would take polynomials as short as {b - a:.2g} "
                        f"s, and more than {PIECE_LIMIT} of them until {end:.6g} s; give a shorter run or a "
                        "larger `tolerance`"
                    )
                continue
            middle = 0.5 * (a + b)
            if b - a <= SHORTEST * end or len(found) + len(todo) > PIECE_LIMIT:
                raise ValueError(
                    f"drive.function is not smooth near t = {middle!r} s: give the times of its jumps "
                    "and kinks as `breaks`, or a larger `tolerance`"
                )
            todo += [(middle, b), (a, middle)]
        return cls(_joined(_one_way(found)), (0.0, *inner))

    def repeated(self, end: float) -> "BaseMotion":
        """Return the motion repeated periodically until `end`.

        >>> swing = BaseMotion.from_function(lambda t: math.sin(2.0 * math.pi * t), end=1.0)
        >>> abs(swing.repeated(1000.0).velocity(999.3) - math.sin(0.6 * math.pi)) < 1e-11
        True
        """
        starts = (k * self.end for k in range(math.ceil(end / self.end)))
        found = [
            (start + a, min(start + b, end), tuple(coefficients))
            for start in starts
            for a, b, _, *coefficients in self.pieces
            if start + a < end
        ]
        return BaseMotion(_joined(found))

    def holding(self, points: Sequence[tuple[float, float]]) -> "BaseMotion":
        """Return the motion with depths that are linear between `points` (t, depth), then constant.

        Its pieces also end at the points.

        >>> motion = BaseMotion.constant(2.0, end=3.0).holding([(0.0, 0.0), (1.0, 0.5)])
        >>> motion.pieces, motion.depths
        (((0.0, 1.0, 0.0, 2.0, 0.0), (1.0, 3.0, 2.0, 2.0, 0.0)), ((0.0, 0.5), (0.5, 0.0)))
        """
        near = SAME_TIME * math.ulp(self.end)
        times = np.array([t if abs(t - self.end) > near else self.end for t, _ in points])
        depth = np.array([depth for _, depth in points])
        rates = np.append(np.diff(depth) / np.diff(times), 0.0)
        found: list[Span] = []
        for a, b, _, *coefficients in self.pieces:
            cuts = [t for t in times.tolist() if a + near < t < b - near]
            for start, stop in itertools.pairwise([a, *cuts, b]):
                moved = Polynomial(coefficients)(Polynomial([start - a, 1.0])).coef
                powers = np.pad(moved, (0, len(coefficients) - moved.size))
                found.append((start, stop, tuple(powers.tolist())))
        if times[-1] == self.end > found[-1][0]:  # a last piece gives the rate after the end
            found.append((self.end, self.end, (self.velocity(self.end), *found[-1][2][1:])))
        starts = np.array([start for start, _, _ in found])
        k = np.searchsorted(times, starts + near, side="right") - 1
        here = depth[k] + rates[k] * np.maximum(starts - times[k], 0.0)
        changes = tuple(sorted({*self.changes, *times[times <= self.end].tolist()}))
        depths = tuple(zip(here.tolist(), rates[k].tolist(), strict=True))
        return BaseMotion(_joined(found), changes, depths)

    def kept(self, end: float) -> "BaseMotion":
        """Return the motion, extended at its last velocity from its end to `end`."""
        if end <= self.end:
            return self
        last = (self.velocity(self.end), *(0.0 for _ in self.pieces[-1][POWERS + 1 :]))
        found = [(a, b, tuple(coefficients)) for a, b, _, *coefficients in self.pieces]
        return BaseMotion(_joined([*found, (self.end, end, last)]), self.changes)

    def shifted(self, by: float) -> "BaseMotion":
        """Return the motion of a base that is displaced by so much at t = 0."""
        pieces = tuple((a, b, Y + by, *V) for a, b, Y, *V in self.pieces)
        return replace(self, pieces=pieces)

    def scaled(self, time: float, length: float, depth: float = 1.0) -> "BaseMotion":
        """Return the motion in units of `time`, `length` and `depth`."""
        pieces = [
            (
                a / time,
                b / time,
                Y / length,
                *(c * time ** (k + 1) / length for k, c in enumerate(V)),
            )
            for a, b, Y, *V in self.pieces
        ]
        depths = tuple((each / depth, rate * time / depth) for each, rate in self.depths)
        return BaseMotion(tuple(pieces), tuple(t / time for t in self.changes), depths)

    @property
    def end(self) -> float:
        """The time at which the last piece ends."""
        return self.pieces[-1][END]

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """The pieces as one array, a row for each."""
        return np.array(self.pieces)

    @cached_property
    def starts(self) -> list[float]:
        """The times at which the pieces begin."""
        return [piece[START] for piece in self.pieces]

    def at(self, t: float) -> tuple[float, float, float]:
        """Return Y, V and V' at `t`; where V jumps, just after the jump."""
        return evaluate(self._piece(t), t)

    def velocity(self, t: float, *, before: bool = False) -> float:
        """Return V; at a jump just after it, or just before it."""
        return evaluate(self._piece(t - SAME_TIME * math.ulp(t) if before else t), t)[1]

    def displacement(self, t: float) -> float:
        """Return Y."""
        return evaluate(self._piece(t), t)[0]

    def forward(self, t: float) -> bool:
        """Whether V > 0, or was when the base last moved; true if it has not moved yet."""
        for piece in reversed(self.pieces[: bisect_right(self.starts, t)]):
            V = evaluate(piece, 0.5 * (piece[START] + t))[1]
            if V != 0.0:
                return V > 0.0
            t = piece[START]
        return True

    def extremes(self, start: float, end: float) -> tuple[float, float]:
        """Return the smallest and the largest Y between two times; Y reverses only where pieces meet.

        >>> BaseMotion.from_points([(0.0, 0.0), (1.0, 2.0), (1.0, -1.0)], 3.0).extremes(0.0, 3.0)
        (-1.0, 1.0)
        """
        between = self.pieces[bisect_left(self.starts, start) : bisect_left(self.starts, end)]
        found = [piece[DISPLACEMENT] for piece in between]
        found += [self.displacement(start), self.displacement(end)]
        return min(found), max(found)

    @cached_property
    def velocities(self) -> list[float]:
        """Velocities of the motion in order: at both ends of each piece, and between if it is curved."""
        found: set[float] = set()
        for piece in self.pieces:
            count = 2 if len(piece) <= POWERS + 2 else CHECKS
            times = np.linspace(piece[START], piece[END], count).tolist()
            found.update(evaluate(piece, t)[1] for t in times)
        return sorted(found)

    @property
    def highest_speed(self) -> float:
        """The largest |V|."""
        return max(map(abs, self.velocities))

    def _piece(self, t: float) -> Piece:
        return self.pieces[max(bisect_right(self.starts, t) - 1, 0)]


def evaluate(piece: Piece, t: float) -> tuple[float, float, float]:
    """Return Y, V and V' of one piece at `t`."""
    after = t - piece[START]
    displacement = velocity = slope = 0.0
    for k in range(len(piece) - 1, POWERS - 1, -1):
        slope = slope * after + velocity
        velocity = velocity * after + piece[k]
        displacement = displacement * after + piece[k] / (k - POWERS + 1)
    return piece[DISPLACEMENT] + displacement * after, velocity, slope


def _one_way(found: Iterable[Span]) -> Iterator[Span]:
    """Cut the pieces where V passes through zero."""
    for a, b, coefficients in found:
        start, powers = a, coefficients
        for zero in _reversals(coefficients, a, b):
            yield start, zero, powers
            start, shifted = zero, np.zeros(len(coefficients))
            moved = Polynomial(coefficients)(Polynomial([zero - a, 1.0])).coef
            shifted[1 : moved.size] = moved[1:]  # at the zero itself V = 0
            powers = tuple(shifted.tolist())
        yield start, b, powers


def _reversals(coefficients: Sequence[float], a: float, b: float) -> list[float]:
    """Return the times within a piece at which V changes sign by more than rounding errors."""
    powers = [c * (b - a) ** k for k, c in enumerate(coefficients)]
    size = sum(map(abs, powers))
    if 2.0 * abs(powers[0]) >= size:
        return []
    near = SAME_TIME * math.ulp(b) / (b - a)
    if not any(powers[2:]):
        share = -powers[0] / powers[1]
        return [a + share * (b - a)] if near < share < 1.0 - near else []
    roots = polynomial.polyroots([c if abs(c) > 1e-3 * ON_REST * size else 0.0 for c in powers])
    inner = np.sort(roots.real[(roots.imag == 0.0) & (abs(roots.real - 0.5) < 0.5 - near)])
    ends = np.concatenate([[0.0], inner, [1.0]])
    V = polynomial.polyval(0.5 * (ends[1:] + ends[:-1]), powers) / (ON_REST * size)
    changes = (np.minimum(V[1:], V[:-1]) < -1.0) & (np.maximum(V[1:], V[:-1]) > 1.0)
    return [a + float(share) * (b - a) for share in inner[changes]]


def _beside(t: float, breaks: Iterable[float]) -> float:
    """Return `t`; if it equals a break up to rounding, move it clear of the break, on its own side."""
    near = next((b for b in breaks if abs(t - b) <= SAME_TIME * math.ulp(b)), None)
    return t if near is None else near + math.copysign(SAME_TIME * math.ulp(near), t - near)


def _fit(
    function: Callable[[float], float], a: float, b: float, least: float
) -> tuple[tuple[float, ...], float]:
    """Interpolate on [a, b]; return powers of t - a, and the error relative to max(`least`, |V|)."""
    open_end = math.nextafter(b, a)  # at a jump, use the value before it

    def values_at(times: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([function(t) for t in np.minimum(times, open_end).tolist()])

    fit = Chebyshev.interpolate(values_at, DEGREE, [a, b])
    coefficients = fit.convert(kind=Polynomial, domain=[a, a + 2.0], window=[0.0, 2.0]).coef
    t = np.linspace(a, open_end, CHECKS)
    values = values_at(t)
    error = np.abs(Polynomial(coefficients)(t - a) - values).max()
    padded = np.zeros(DEGREE + 1)
    padded[: coefficients.size] = coefficients
    return tuple(padded.tolist()), float(error / max(least, np.abs(values).max()))


def _joined(found: Iterable[Span]) -> tuple[tuple[float, ...], ...]:
    """Add to each piece (a, b, coefficients) its initial displacement, where the previous one ended."""
    pieces: list[tuple[float, ...]] = []
    displacement = 0.0
    for a, b, coefficients in found:
        piece = (a, b, displacement, *coefficients)
        displacement = evaluate(piece, b)[0]
        pieces.append(piece)
    return tuple(pieces)
