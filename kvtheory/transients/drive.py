"""Drives: the drive number lambda(s) as a piecewise polynomial, and its exact integral Y(s)."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

DEGREE = 8
"""Of a piece that represents a callable: a few pieces for a period of a sine, at any tolerance."""
CHECKS = 2 * DEGREE + 3
"""Points at which a piece is compared with its callable, most of them between the nodes."""
SHORTEST = 1e-12
"""Share of the whole drive; a piece that would have to be shorter holds a jump or a kink."""
PIECE_LIMIT = 100_000

START, END, DISPLACEMENT, POWERS = 0, 1, 2, 3
"""Layout of a piece: its times, Y at its start, then the coefficients of lambda in s - start."""

Piece = Sequence[float]


@dataclass(frozen=True)
class Drive:
    """Drive number lambda(s) of pieces that follow each other; lambda may jump between them.

    Each piece is (start, end, Y(start), c_0, c_1, ...), lambda = sum c_k (s - start)^k, all of one
    length. Before s = 0 the foundation rests.
    """

    pieces: tuple[tuple[float, ...], ...]

    @classmethod
    def constant(cls, number: float, end: float) -> "Drive":
        """Return the start from rest: lambda = `number` from s = 0 to `end`."""
        return cls.from_points([(0.0, number)], end)

    @classmethod
    def from_points(cls, points: Sequence[tuple[float, float]], end: float) -> "Drive":
        """Return the drive that is linear between `points` (s, lambda), with a jump where s repeats.

        It keeps its last value until `end`.

        Examples
        --------
        >>> drive = Drive.from_points([(0.0, 0.0), (1.0, 2.0), (1.0, -1.0)], end=3.0)
        >>> [drive.at(s)[:2] for s in (0.5, 1.0, 3.0)]
        [(0.25, 1.0), (1.0, -1.0), (-1.0, -1.0)]
        """
        held = [(float(s), float(number)) for s, number in points]
        held.append((max(float(end), held[-1][0]), held[-1][1]))
        return cls(
            _joined(
                (a, b, (left, (right - left) / (b - a)))
                for (a, left), (b, right) in itertools.pairwise(held)
                if b - a > 4.0 * math.ulp(b)  # times that differ by rounding are one time: a jump
            )
        )

    @classmethod
    def from_callable(
        cls,
        function: Callable[[float], float],
        end: float,
        *,
        tolerance: float = 1e-12,
        breaks: Sequence[float] = (),
    ) -> "Drive":
        """Return a drive within `tolerance` x max(1, |lambda|) of `function` on [0, `end`].

        Pieces are Chebyshev interpolants, halved until they agree with the function at points
        between their nodes. `breaks` are the times at which the function jumps or has kinks.

        Raises
        ------
        ValueError
            If so many halvings are needed that the function must jump elsewhere than at `breaks`.

        Examples
        --------
        >>> drive = Drive.from_callable(math.sin, end=6.0)
        >>> abs(drive.at(5.0)[0] - (1.0 - math.cos(5.0))) < 1e-12
        True
        """
        inner = sorted(t for t in breaks if 0.0 < t < end)
        todo = list(itertools.pairwise([0.0, *inner, end]))[::-1]
        found: list[tuple[float, float, tuple[float, ...]]] = []
        while todo:
            a, b = todo.pop()
            coefficients, error = _fit(function, a, b)
            if error <= tolerance:
                found.append((a, b, coefficients))
                continue
            middle = 0.5 * (a + b)
            if b - a <= SHORTEST * end or len(found) + len(todo) > PIECE_LIMIT:
                raise ValueError(
                    f"`function` is not smooth near {middle!r}: give the times of its jumps and "
                    "kinks as `breaks`, or a larger `tolerance`"
                )
            todo += [(middle, b), (a, middle)]
        return cls(_joined(found))

    @property
    def end(self) -> float:
        """The time at which the last piece ends."""
        return self.pieces[-1][END]

    def at(self, s: float) -> tuple[float, float, float]:
        """Return Y, lambda and lambda' at `s`; where lambda jumps, just after the jump."""
        piece = next((p for p in self.pieces if s < p[END]), self.pieces[-1])
        return evaluate(piece, s)


def evaluate(piece: Piece, s: float) -> tuple[float, float, float]:
    """Return Y, lambda and lambda' of one piece at `s`."""
    t = s - piece[START]
    displacement = number = slope = 0.0
    for k in range(len(piece) - 1, POWERS - 1, -1):
        slope = slope * t + number
        number = number * t + piece[k]
        displacement = displacement * t + piece[k] / (k - POWERS + 1)
    return piece[DISPLACEMENT] + displacement * t, number, slope


def _fit(function: Callable[[float], float], a: float, b: float) -> tuple[tuple[float, ...], float]:
    """Interpolate on [a, b]; return powers of s - a, and the error relative to max(1, |lambda|)."""
    open_end = math.nextafter(b, a)  # at a jump the value before it counts
    fit = Chebyshev.interpolate(
        lambda t: np.array([function(min(float(x), open_end)) for x in t]), DEGREE, [a, b]
    )
    coefficients = fit.convert(kind=Polynomial, domain=[a, a + 2.0], window=[0.0, 2.0]).coef
    t = np.linspace(a, open_end, CHECKS)
    values = np.array([function(float(x)) for x in t])
    error = np.abs(Polynomial(coefficients)(t - a) - values).max()
    padded = np.zeros(DEGREE + 1)
    padded[: coefficients.size] = coefficients
    return tuple(padded.tolist()), float(error / max(1.0, np.abs(values).max()))


def _joined(found: object) -> tuple[tuple[float, ...], ...]:
    """Give each piece (a, b, coefficients) the displacement at which the one before it ends."""
    pieces: list[tuple[float, ...]] = []
    displacement = 0.0
    for a, b, coefficients in found:  # type: ignore[attr-defined]
        piece = (a, b, displacement, *coefficients)
        displacement = evaluate(piece, b)[0]
        pieces.append(piece)
    return tuple(pieces)
