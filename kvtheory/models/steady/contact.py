r"""One steady contact of an indenter of any shape: its edges, and integrals over it.

Geometry, for V > 0 (V < 0 is the mirror image): the foundation moves through x with V. Its surface
meets the indenter at the leading edge, x_LE < 0, and leaves it at the trailing edge. Between them

    compression   u = delta - h(x)                        (Eq. 35)
    pressure      p = K (u - l_r h'(x)),  l_r = V tau     (Eqs. 12, 29, 36)

The leading edge is where h = delta on the entering side. The trailing edge is where p falls to zero,
by a root, or by a jump of h' as at the vertex of a wedge.

One contact: e^(x/l_r) u rises where p > 0, for its derivative is e^(x/l_r) p/(K l_r); the surface
that is left behind relaxes as e^(-x/l_r), and is met again only where e^(x/l_r) u exceeds its running
maximum. If h is convex, u is concave and log u + x/l_r too: there is one maximum, the trailing edge.
Shapes that are not known to be convex are checked on a fine sample of points.
"""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from kvtheory.scene.indenters import Indenter

ROOT_RTOL = 4.0 * float(np.finfo(float).eps)
"""The smallest tolerance that `brentq` accepts."""
QUADRATURE_RTOL = 1e-13
"""A digit above the rounding floor of `quad`, 1.1e-14."""
GROWTH = 8.0
"""Ratio of successive trial brackets: few trials over many decades, and a narrow bracket."""
CHECK_SAMPLES = 512
"""Points of each region in which a shape that is not known to be convex is checked."""
WAVY_PIECES = 64
"""Parts of each smooth piece of a shape that is not known to be convex: with the nodes of `quad` in
each, waves and bumps down to 1/500 of the contact are seen."""
CHECK_MARGIN = 1e-9
"""Share of a region left out at its ends, where kinks may be singular."""
CHECK_SPAN = 4.0
"""How far ahead of the contact and behind it that check goes, in contact lengths."""
CHECK_RTOL = 1e-11
"""Discrepancy that a check allows, relative to the depth; more would hide from the certificate."""
JUMP_HALVINGS = 40
JUMP_RATIO = 1e-6
"""A change of slope that keeps this share over so many halvings of its interval is a jump."""


class QuadratureError(ArithmeticError):
    """A quadrature, a root or the assumption of one contact failed; the message says why."""


@dataclass(frozen=True)
class Surface:
    """The surface of the indenter, mirrored (`side` = -1) for a drive in the negative direction."""

    indenter: Indenter
    side: float

    def height(self, x: float) -> float:
        """Return h, or raise where it is not a number."""
        return self._value(self.indenter.height, x)

    def slope(self, x: float) -> float:
        """Return h', or raise where it is not a number."""
        return self.side * self._value(self.indenter.slope, x)

    @property
    def breakpoints(self) -> list[float]:
        """The points between which the surface is smooth; the lowest point always counts as one."""
        return sorted({0.0, *(self.side * kink for kink in self.indenter.kinks)})

    @property
    def end(self) -> float:
        """The largest |x| at which the surface can be evaluated."""
        return math.nextafter(self.indenter.reach, 0.0)

    def _value(self, function: Callable[[float], Any], x: float) -> float:
        x = self.side * x
        try:
            value = float(function(x))
        except (ArithmeticError, ValueError) as error:
            raise QuadratureError(
                f"the indenter's shape failed at x = {x:.6g} m: {error}"
            ) from error
        if not math.isfinite(value):
            raise QuadratureError(f"the indenter's shape is {value} at x = {x:.6g} m")
        return value


@dataclass(frozen=True)
class Contact:
    """The contact at one depth and retardation length."""

    surface: Surface
    l_r: float
    depth: float

    def compression(self, x: float) -> float:
        """Return u (Eq. 35)."""
        return self.depth - self.surface.height(x)

    def pressure(self, x: float) -> float:
        """Return p/K."""
        return self.compression(x) - self.l_r * self.surface.slope(x)

    @cached_property
    def x_le(self) -> float:
        """The leading edge."""
        return -root(
            lambda x: -self.compression(-x), self.depth, self.surface.end, "the leading edge"
        )

    @cached_property
    def x_static(self) -> float:
        """The edge on the leaving side when nothing moves."""
        return root(lambda x: -self.compression(x), self.depth, self.surface.end, "the static edge")

    @cached_property
    def trailing(self) -> tuple[float, float]:
        """The trailing edge, x_TE and u_TE."""
        for start, end in self._cut(0.0, self.x_static):
            first, last = math.nextafter(start, end), math.nextafter(end, start)
            if self.pressure(first) <= 0.0:
                return start, self.compression(start)
            if self.pressure(last) <= 0.0:
                return self._released(brent(self.pressure, first, last))
        # Only rounding leaves a pressure at the static edge, where u = 0 and h' >= 0.
        return self._released(self.x_static)

    @cached_property
    def pieces(self) -> list[tuple[float, float]]:
        """The contact, cut where the surface is not smooth, and finely where it may be wavy."""
        cuts = self.smooth_pieces
        if self.surface.indenter.convex:
            return cuts
        return [
            part
            for start, end in cuts
            for part in itertools.pairwise(np.linspace(start, end, WAVY_PIECES + 1).tolist())
        ]

    @property
    def smooth_pieces(self) -> list[tuple[float, float]]:
        """The contact, cut where the surface is not smooth."""
        return self._cut(self.x_le, self.trailing[0])

    def integral(self, integrand: Callable[[float], float]) -> tuple[float, float]:
        """Integrate over the contact; return the value and the estimate of its error."""
        parts = [integral(integrand, start, end) for start, end in self.pieces]
        # The exactly rounded sum does not depend on the direction of the drive.
        return math.fsum(value for value, _ in parts), sum(error for _, error in parts)

    def _cut(self, start: float, end: float) -> list[tuple[float, float]]:
        points = [start, *(x for x in self.surface.breakpoints if start < x < end), end]
        return list(itertools.pairwise(points))

    def _released(self, x_te: float) -> tuple[float, float]:
        """Return x_TE and u_TE = l_r h', which does not cancel for small l_r, where p = 0."""
        u_te = self.l_r * self.surface.slope(x_te)
        if abs(self.compression(x_te) - u_te) > CHECK_RTOL * self.depth:
            raise QuadratureError(
                f"the pressure jumps through zero near x = {self.surface.side * x_te:.6g} m, "
                "where `kinks` does not say that the slope jumps"
            )
        return x_te, u_te


def check_one_contact(contact: Contact) -> None:
    """Raise unless h' is the derivative of h and the edges enclose the only contact."""
    surface, l_r, (x_te, u_te) = contact.surface, contact.l_r, contact.trailing
    allowed = CHECK_RTOL * contact.depth
    for start, end in contact.smooth_pieces:
        rise = surface.height(end) - surface.height(start)
        if abs(integral(surface.slope, start, end)[0] - rise) > allowed:
            raise QuadratureError(
                "the slope function is not the derivative of the height function, "
                "or jumps where `kinks` does not say so"
            )
        _check_smooth(surface.slope, _sample(start, end))
    if surface.height(0.0) != 0.0:
        raise QuadratureError(f"h(0) = {surface.height(0.0):.6g} m: expected 0, the lowest point")
    if any(contact.compression(x) > contact.depth + allowed for x in _sample(contact.x_le, x_te)):
        raise QuadratureError(
            "h is negative within the contact: expected h(0) = 0, the lowest point"
        )
    if any(contact.pressure(x) < -allowed for x in _sample(contact.x_le, x_te)):
        raise QuadratureError(
            "more than one contact: the surface leaves the indenter before the trailing edge"
        )
    if l_r and any(
        contact.compression(x) > u_te * math.exp((x_te - x) / l_r) + allowed
        for x in _sample(x_te, contact.x_static)
    ):
        raise QuadratureError(
            "more than one contact: the relaxing surface meets the indenter again"
        )
    span = CHECK_SPAN * (contact.x_static - contact.x_le)
    ahead = _sample(max(contact.x_le - span, -surface.end), contact.x_le)
    behind = _sample(contact.x_static, min(contact.x_static + span, surface.end))
    if any(contact.compression(x) > allowed for x in ahead + behind):
        raise QuadratureError(
            "more than one contact: the indenter reaches below the foundation's level elsewhere"
        )


def _sample(start: float, end: float) -> list[float]:
    """Return points of an interval, its very ends excepted."""
    margin = CHECK_MARGIN * (end - start)
    return np.linspace(start + margin, end - margin, CHECK_SAMPLES).tolist()


def _check_smooth(slope: Callable[[float], float], points: list[float]) -> None:
    """Raise if the largest change of slope between neighbouring points is a jump."""
    ends = [(x, slope(x)) for x in points]
    left, right = max(itertools.pairwise(ends), key=lambda pair: abs(pair[1][1] - pair[0][1]))
    change = abs(right[1] - left[1])
    for _ in range(JUMP_HALVINGS):
        x = 0.5 * (left[0] + right[0])
        middle = (x, slope(x))
        if abs(middle[1] - left[1]) > abs(right[1] - middle[1]):
            right = middle
        else:
            left = middle
    if abs(right[1] - left[1]) > JUMP_RATIO * change:
        raise QuadratureError(
            f"the slope jumps by {right[1] - left[1]:.3g} near x = {left[0]:.6g} m "
            "of the contact, where `kinks` does not say so"
        )


def integral(integrand: Callable[[float], float], start: float, end: float) -> tuple[float, float]:
    """Integrate a smooth function; return the value and the estimate of its error.

    x = start + width t^2 (3 - 2 t) flattens the ends, where the slope may be singular.
    """
    width = end - start
    value, error, *report = quad(
        lambda t: integrand(start + width * (t * t * (3.0 - 2.0 * t))) * (6.0 * t * (1.0 - t)),
        0.0,
        1.0,
        epsabs=0.0,
        epsrel=QUADRATURE_RTOL,
        limit=200,
        full_output=1,
    )
    if len(report) > 1:  # quad adds a message when it failed
        reason = " ".join(str(report[1]).split())
        raise QuadratureError(f"quadrature from {start:.6g} m to {end:.6g} m: {reason}")
    return width * value, width * error


def root(rising: Callable[[float], float], guess: float, last: float, what: str) -> float:
    """Find the root of a rising function on (0, last], bracketing it from the guess.

    `last` is what the indenter's reach permits.
    """
    low = high = min(guess, 0.5 * last)
    while rising(high) < 0.0:
        if high >= last:
            raise QuadratureError(
                f"{what} lies beyond the indenter's reach: it would have to exceed {last:.6g} m"
            )
        low, high = high, min(GROWTH * high, last)
    while rising(low) > 0.0:
        low, high = low / GROWTH, low
        if low == 0.0:
            raise QuadratureError(f"{what} is too close to zero")
    return brent(rising, low, high)


def brent(function: Callable[[float], float], low: float, high: float) -> float:
    """Find a root between points where the signs differ, to the last digits, however close to zero."""
    found, report = brentq(
        function, low, high, xtol=5e-324, rtol=ROOT_RTOL, maxiter=2000, full_output=True, disp=False
    )
    if not report.converged:
        raise QuadratureError(f"the root between {low:.6g} and {high:.6g}: {report.flag}")
    return float(found)
