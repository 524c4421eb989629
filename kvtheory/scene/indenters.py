"""Shapes of the indenter: the height h(x) of its surface above its lowest point, at x = 0 (Eq. 3).

Every shape has `height` (h, in m) and `slope` (h', dimensionless), for floats and arrays; `reach` (m): the
surface is defined for |x| < reach; `kinks` (m), where h' jumps or a derivative is singular; and `convex`,
whether h is known to be convex: then also `bend`, x h''/h'. Line contacts have forces `per_width`; balls and
other bodies of revolution have total forces, and their shape is that of the middle plane, y = 0. A new shape
is a class with these, its name `shape` and its `words`, and an entry of `SHAPES`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np

from kvtheory.scene.mistakes import SceneError, mistake
from kvtheory.scene.quantities import Part, Value, quantity, validate
from kvtheory.theory.powers import power


class Shape(Part):
    """What shapes have in common: h(x), h'(x), and what is usual of a line contact."""

    shape: ClassVar[str]
    words: ClassVar[str]
    convex: ClassVar[bool] = True
    per_width: ClassVar[bool] = True
    reach: float = math.inf
    kinks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        validate(self, "indenter")


class _Power(Shape):
    """A line contact with h = s |x|^n/(n L^(n-1)) = x h'/n; `power` are s, L and n."""

    power: Any
    slope: Any

    def height(self, x: Value) -> Value:
        """Return h(x)."""
        return x * self.slope(x) / self.power[2]

    def bend(self, x: Value) -> Value:
        """Return x h''/h'."""
        return self.power[2] - 1.0


@dataclass(frozen=True, eq=False)
class Parabola(_Power):
    """The paper's cylinder, h = x^2/(2R) (Eq. 3).

    >>> Parabola(radius=0.01).height(0.002)
    0.0002
    """

    shape: ClassVar[str] = "parabola"
    words: ClassVar[str] = "the parabola"
    radius: Value = quantity("m", "R, curvature radius of the indenter (Eq. 3)")
    power = property(lambda self: (1.0, self.radius, 2.0))

    def height(self, x: Value) -> Value:
        """Return h(x)."""
        return x * (x / (2.0 * self.radius))

    def slope(self, x: Value) -> Value:
        """Return h'(x)."""
        return x / self.radius


@dataclass(frozen=True, eq=False)
class Circle(Shape):
    """A true cylinder, h = R - sqrt(R^2 - x^2), up to |x| = R, where its surface is vertical.

    >>> print(f"{Circle(radius=0.01).height(0.006):.12g}")
    0.002
    """

    shape: ClassVar[str] = "circle"
    words: ClassVar[str] = "the circle"
    radius: Value = quantity("m", "R, curvature radius of the indenter (Eq. 3)")

    @property
    def reach(self) -> float:  # type: ignore[override]
        """The radius: the lower half of the cylinder ends there."""
        return self.radius

    def height(self, x: Value) -> Value:
        """Return h(x) in a form that does not cancel for |x| << R."""
        return x * (x / (self.radius + self._centre_height(x)))

    def slope(self, x: Value) -> Value:
        """Return h'(x)."""
        with np.errstate(divide="ignore"):
            return x / self._centre_height(x)

    def bend(self, x: Value) -> Value:
        """Return x h''/h'."""
        return (self.radius / self._centre_height(x)) ** 2

    def _centre_height(self, x: Value) -> Value:
        """Return R - h(x), factored against cancellation for |x| close to R; NaN beyond."""
        with np.errstate(invalid="ignore"):
            return np.sqrt((self.radius - x) * (self.radius + x))


@dataclass(frozen=True, eq=False)
class PowerLaw(_Power):
    """A blunt (n > 2) or pointed (n < 2) indenter, h = |x|^n/(n L^(n-1)), n >= 1.

    With n = 2 it is the parabola of radius L; the slope is 1 at |x| = L for every n.

    >>> float(PowerLaw(length=0.01, exponent=4.0).height(0.01))
    0.0025
    """

    shape: ClassVar[str] = "power-law"
    words: ClassVar[str] = "the power law"
    kinks = (0.0,)
    length: Value = quantity("m", "L, where |h'| = 1")
    exponent: Value = quantity("1", "n, at least 1", minimum=1.0, exclusive=False)
    power = property(lambda self: (1.0, self.length, self.exponent))

    def slope(self, x: Value) -> Value:
        """Return h'(x)."""
        return np.sign(x) * power(np.abs(x) / self.length, self.exponent - 1.0)


@dataclass(frozen=True, eq=False)
class Wedge(_Power):
    """A wedge, h = slope |x|.

    >>> float(Wedge(inclination=0.1).height(-0.02))
    0.002
    """

    shape: ClassVar[str] = "wedge"
    words: ClassVar[str] = "the wedge"
    kinks = (0.0,)
    inclination: Value = quantity("1", "slope |h'| of the flanks")
    power = property(lambda self: (self.inclination, 1.0, 1.0))

    def slope(self, x: Value) -> Value:
        """Return h'(x)."""
        return self.inclination * np.sign(x)


@dataclass(frozen=True, eq=False)
class Profile(Shape):
    """Any shape, from Python functions of one float: h(x), lowest at h(0) = 0, and h'(x).

    At a kink, h' is taken from both sides; the value of its function there does not matter.

    >>> ellipse = Profile(lambda x: 0.001 * (1 - math.sqrt(1 - (x / 0.02) ** 2)),
    ...                   lambda x: 0.05 * (x / 0.02) / math.sqrt(1 - (x / 0.02) ** 2), reach=0.02)
    >>> print(f"{ellipse.height(0.012):.6g}")
    0.0002
    """

    shape: ClassVar[str] = "callable"
    words: ClassVar[str] = "a profile of functions"
    convex: ClassVar[bool] = False
    height_function: Callable[[float], float]
    slope_function: Callable[[float], float]
    reach: float = math.inf
    kinks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not (callable(self.height_function) and callable(self.slope_function)):
            raise SceneError(["indenter: expected functions h(x) and h'(x) of one float"])
        if not (isinstance(self.reach, (int, float)) and self.reach > 0.0):
            raise mistake("indenter.reach", self.reach, "expected a number above 0, in m")
        listed = self.kinks if isinstance(self.kinks, (tuple, list)) else [None]
        if not all(isinstance(x, (int, float)) and math.isfinite(x) for x in listed):
            raise mistake("indenter.kinks", self.kinks, "expected finite numbers, in m")
        object.__setattr__(self, "kinks", tuple(map(float, self.kinks)))

    def height(self, x: Value) -> Value:
        """Return h(x)."""
        return _pointwise(self.height_function, x)

    def slope(self, x: Value) -> Value:
        """Return h'(x): at a kink the mean of both sides, whatever the function says there."""
        return _pointwise(self._slope if self.kinks else self.slope_function, x)

    def _slope(self, x: float) -> float:
        if x not in self.kinks:
            return self.slope_function(x)
        before, after = (self.slope_function(beside(x, to)) for to in (-math.inf, math.inf))
        return 0.5 * (before + after)

    def mirrored(self) -> "Profile":
        """Return the profile with the shape of x > 0 on both sides."""
        right = [kink for kink in self.kinks if kink >= 0.0]
        return Profile(
            partial(_even, self.height_function), partial(_odd, self.slope_function), self.reach,
            (*right, *(-kink for kink in right if kink)),
        )  # fmt: skip


def _even(function: Callable[[float], float], x: float) -> float:
    return function(abs(x))


def _odd(function: Callable[[float], float], x: float) -> float:
    return math.copysign(1.0, x) * function(abs(x))


def beside(x: float, to: float) -> float:
    """Return the next float from x towards `to`; from 0, the smallest that no processor flushes to 0."""
    return math.nextafter(x, to) if x else math.copysign(float(np.finfo(float).tiny), to)


def _pointwise(function: Callable[[float], float], x: Value) -> Value:
    """Apply a function of one float to a float or to each element of an array."""
    if isinstance(x, np.ndarray):
        return np.array([function(float(value)) for value in x.flat], dtype=float).reshape(x.shape)
    return function(x)


@dataclass(frozen=True, eq=False)
class Sphere(Shape):
    """A ball, the paraboloid h = x^2/(2R) + y^2/(2R'), with R' = R unless `radius_across` is given.

    It approximates a sphere as the parabola does a cylinder, to a relative error of the order of (a/R)^2. Its
    strips along x are parabolas of depth delta - y^2/(2R').

    >>> Sphere(radius="10 mm").stretch, Sphere("10 mm", radius_across="40 mm").stretch
    (1.0, 2.0)
    """

    shape: ClassVar[str] = "sphere"
    words: ClassVar[str] = "the ball"
    per_width: ClassVar[bool] = False
    radius: Value = quantity("m", "R, radius of the ball, in the sliding direction")
    radius_across: Value = quantity(
        "m", "R', radius across the sliding direction; that of the ball if not given", default=None
    )

    @property
    def stretch(self) -> Value:
        """sqrt(R'/R), the ratio of width to length of the contact at rest."""
        return 1.0 if self.radius_across is None else (self.radius_across / self.radius) ** 0.5

    @property
    def profile(self) -> Parabola:
        """The shape in the middle plane."""
        return Parabola(self.radius)

    def height(self, x: Value, y: Value = 0.0) -> Value:
        """Return h(x, y), by default in the middle plane."""
        across = self.radius if self.radius_across is None else self.radius_across
        return x * (x / (2.0 * self.radius)) + y * (y / (2.0 * across))

    def slope(self, x: Value, y: Value = 0.0) -> Value:
        """Return dh/dx, the same for every y."""
        return x / self.radius


@dataclass(frozen=True, eq=False)
class Revolved(Shape):
    """Any profile h(rho) revolved about the vertical axis: a true sphere, a cone, a blunt punch.

    In Python only; the profile is one of the shapes of this module, of which x = rho >= 0 counts.

    >>> cone = Revolved(Wedge(inclination=0.1))
    >>> round(float(cone.height(-0.03, 0.04)), 12), cone.stretch
    (0.005, 1.0)
    """

    shape: ClassVar[str] = "revolved"
    words: ClassVar[str] = "a revolved profile"
    per_width: ClassVar[bool] = False
    stretch: ClassVar[float] = 1.0
    profile: "Line"

    def __post_init__(self) -> None:
        if not (isinstance(self.profile, Shape) and self.profile.per_width):
            message = "expected a shape h(x) of a line contact"
            raise mistake("indenter.profile", self.profile, message)
        if isinstance(self.profile, Profile):  # the middle plane has both sides
            object.__setattr__(self, "profile", self.profile.mirrored())
        self.mark([self.profile])

    convex = property(
        attrgetter("profile.convex"), doc="Whether the profile is known to be convex."
    )
    reach = property(attrgetter("profile.reach"), doc="Largest |x| of the profile, in m.")
    kinks = property(attrgetter("profile.kinks"), doc="Points where h' jumps or is singular, in m.")

    def height(self, x: Value, y: Value = 0.0) -> Value:
        """Return h(rho), by default in the middle plane."""
        return self.profile.height(np.hypot(x, y))

    def slope(self, x: Value, y: Value = 0.0) -> Value:
        """Return dh/dx = h'(rho) x/rho, zero at the lowest point."""
        rho = np.hypot(x, y)
        return self.profile.slope(rho) * (x / np.maximum(rho, np.finfo(float).tiny))


Convex = Parabola | Circle | PowerLaw | Wedge
Line = Convex | Profile
Spot = Sphere | Revolved
Indenter = Line | Spot

SHAPES: dict[str, Any] = {cls.shape: cls for cls in (Parabola, Circle, PowerLaw, Wedge, Sphere)}
"""The shapes that a scene file can name."""
