"""Foundations: rows of independent viscoelastic elements, each known by its relaxation function G(t).

An element compressed by u exerts the pressure p(t) = int G(t - t') du/dt' dt'. Every
foundation has its `kind`; the relaxed `stiffness` K; the `arms` of a Prony series, in addition to
it; and the `damping` C = int (G - K) dt, which governs slow sliding, with `retardation_time` C/K.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from kvtheory.scene.quantities import (
    Part,
    SceneError,
    Value,
    collecting,
    derive,
    problem,
    quantity,
    settle,
)

LAYER = ("modulus", "thickness", "poisson_ratio")
THIN = 0.1
"""Largest `layer_number` of a thin layer. Up to it K predicts the load at a given depth to 5 % for a parabola
and 11 % for a ball, and the length of the contact to 15 %: measured by solving the contact with the exact
compliance of the layer, for nu from 0 to nearly 1/2."""
MOST_ARMS = 100
PAIRS = 'pairs of stiffness and relaxation time, such as ["30 GN/m^3", "10 ms"]'
DISTINCT = 1e-6
"""Relative difference of relaxation times below which two arms count as the same."""


def layer_stiffness(modulus: Any, thickness: Any, poisson_ratio: Any) -> Any:
    """Return K = E (1 - nu) / ((1 + nu) (1 - 2 nu) h) of a thin layer bonded to a rigid base, in N/m^3.

    A layer of modulus E (Pa) and thickness h (m) that is thin for its contact is compressed without lateral
    strain: K is its confined modulus over its thickness. `layer_number` says whether it is thin.

    Numbers or arrays; Johnson, Contact Mechanics (1985), section 5.8.

    >>> round(layer_stiffness(5e6, 2e-3, 0.45) / 1e9, 4)
    9.4828
    """
    return (
        modulus * (1 - poisson_ratio) / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)) / thickness
    )


def layer_number(thickness: Any, half_length: Any, poisson_ratio: Any) -> Any:
    """Return (h/a)^2/(1 - 2 nu): a layer is thin for a contact of half length a if it is below `THIN`.

    Under a pressure of wave number k a bonded layer of thickness h without friction on its surface is
    compressed by u = (p/K) [1 + c (k h)^2 + ...], c = nu (4 nu - 1)/(3 (1 - nu)(1 - 2 nu)). The first term
    is the foundation. The second one is (k h)^2/(3 (1 - 2 nu)) near nu = 1/2, where the layer flows sideways
    instead of being compressed: with L^2 = c h^2 a parabola at a given depth then carries
    (1 - L^2/a^2)^(3/2) + L^3/a^3 of the load that K predicts.

    The same parameter decides in Chandler and Vella (2020), Proc. R. Soc. A 476, arXiv:2010.11133.

    >>> round(layer_number(2e-3, 1.6e-3, 0.45), 2)
    15.63
    """
    return (thickness / half_length) ** 2 / (1 - 2 * poisson_ratio)


def thick_layer(thickness: Any, half_length: Any, poisson_ratio: Any) -> str:
    """Return a note if a layer is not thin for its contact, or an empty text; numbers or arrays.

    >>> thick_layer(1e-4, 1.6e-3, 0.45)
    ''
    """
    number = np.asarray(layer_number(thickness, half_length, poisson_ratio))
    thick = np.count_nonzero(number > THIN)
    if not thick:
        return ""
    value = f"= {number:.3g}" if number.ndim == 0 else f"is up to {number.max():.3g}"
    where = f" in {thick} of {number.size} scenes" if number.ndim else ""
    return (
        f"The layer is not thin for its contact{where}: (thickness/half_length)^2/(1 - 2 poisson_ratio) "
        f"{value}, above {THIN:g}, so that it does not act as independent elements of stiffness K. Reduce "
        "foundation.thickness or foundation.poisson_ratio (no K describes an incompressible layer, "
        "poisson_ratio = 0.5), or enlarge the contact; otherwise use a boundary-element code."
    )


@dataclass(frozen=True, eq=False)
class _Relaxed(Part):
    """The common part of all foundations: a stiffness, or a thin bonded layer that determines it."""

    stiffness: Value = quantity(
        "N/m^3", "K, stiffness of the foundation per unit area",
        default=None, needed=True, instead="modulus", excludes=LAYER,
    )  # fmt: skip
    _: KW_ONLY
    modulus: Value = quantity(
        "N/m^2", "E, Young's modulus of a thin bonded layer, instead of the stiffness",
        default=None, beside=("thickness", "poisson_ratio"), excludes=("stiffness",),
    )  # fmt: skip
    thickness: Value = quantity(
        "m", "h, thickness of the layer, small compared with the contact",
        default=None, beside=("modulus", "poisson_ratio"), excludes=("stiffness",),
    )  # fmt: skip
    poisson_ratio: Value = quantity(
        "1", "nu, Poisson's ratio of the layer", default=None, exclusive=False, below=0.5,
        beside=("modulus", "thickness"), excludes=("stiffness",),
    )  # fmt: skip

    def __post_init__(self) -> None:
        settle(self, "foundation")
        if self.modulus is not None:
            stiffness = layer_stiffness(self.modulus, self.thickness, self.poisson_ratio)
            derive(self, "foundation", "stiffness", stiffness, "the layer")


@dataclass(frozen=True, eq=False)
class Foundation(_Relaxed):
    """Independent Kelvin-Voigt elements: G = K + C delta(t), C = K tau, all per unit area.

    A thin bonded layer is given by `modulus`, `thickness` and `poisson_ratio` instead of `stiffness`,
    which then follows from them; see `layer_stiffness` for where that holds.

    >>> layer = Foundation(modulus="5 MPa", thickness="2 mm", poisson_ratio=0.45, retardation_time=0.1)
    >>> round(layer.stiffness / 1e9, 4)
    9.4828
    """

    kind: ClassVar[str] = "kelvin-voigt"
    arms: ClassVar[tuple["Arm", ...]] = ()
    retardation_time: Value = quantity(
        "s", "tau = C/K, retardation time of the foundation (Eq. 22)", default=None, needed=True
    )

    @property
    def damping(self) -> Value:
        """C = K tau, damping per unit area, in N s/m^3 (Eq. 22)."""
        return self.stiffness * self.retardation_time


@dataclass(frozen=True, eq=False)
class Arm(Part):
    """A Maxwell arm, spring and damper in series: K_i e^(-t/tau_i), a term of a Prony series."""

    stiffness: Value = quantity("N/m^3", "K_i, stiffness of the arm per unit area")
    relaxation_time: Value = quantity("s", "tau_i, relaxation time of the arm")

    def __post_init__(self) -> None:
        settle(self, "arm")


@dataclass(frozen=True, eq=False)
class GeneralizedMaxwell(_Relaxed):
    """A spring in parallel with Maxwell arms: G = K + sum K_i e^(-t/tau_i), a Prony series.

    `arms` are pairs of stiffness and relaxation time, one to a hundred, with different times. One arm
    is the standard linear solid (Zener).

    >>> zener = GeneralizedMaxwell("10 GN/m^3", arms=[["30 GN/m^3", "10 ms"]])
    >>> zener.arms[0].relaxation_time, zener.damping, zener.retardation_time
    (0.01, 300000000.0, 0.03)
    """

    kind: ClassVar[str] = "generalized-maxwell"
    arms: tuple[Arm, ...] = ()

    def __post_init__(self) -> None:
        problems: list[str] = []
        with collecting(problems, "foundation", self):
            super().__post_init__()
        with collecting(problems, "foundation.arms", self.arms):
            object.__setattr__(self, "arms", arms_of(self.arms))
            self.mark(self.arms)
        if problems:
            raise SceneError(problems)

    @property
    def damping(self) -> Value:
        """C = sum K_i tau_i, in N s/m^3: that of the equivalent Kelvin-Voigt foundation in slow sliding."""
        return sum(arm.stiffness * arm.relaxation_time for arm in self.arms)

    @property
    def retardation_time(self) -> Value:
        """C/K, in s."""
        return self.damping / self.stiffness


@dataclass(frozen=True, eq=False)
class FractionalKelvinVoigt(_Relaxed):
    """A spring in parallel with a springpot: G = K [1 + (t/tau)^(-alpha)/Gamma(1 - alpha)], 0 < alpha <= 1.

    With `order` alpha = 1 it is the Kelvin-Voigt foundation. Below 1 its damping is infinite: the
    springpot relaxes too slowly for C = int (G - K) dt to converge.

    >>> FractionalKelvinVoigt("10 GN/m^3", "100 ms", 0.5).damping
    inf
    """

    kind: ClassVar[str] = "fractional-kelvin-voigt"
    arms: ClassVar[tuple[Arm, ...]] = ()
    retardation_time: Value = quantity(
        "s", "tau, time scale of the springpot", default=None, needed=True
    )
    order: Value = quantity(
        "1", "alpha, order of the springpot", default=None, needed=True, maximum=1.0
    )

    @property
    def damping(self) -> Value:
        """C = int (G - K) dt, in N s/m^3."""
        finite = self.stiffness * self.retardation_time
        if np.ndim(self.order) == 0:
            return finite if self.order == 1.0 else math.inf
        return np.where(self.order == 1.0, finite, math.inf)


AnyFoundation = Foundation | GeneralizedMaxwell | FractionalKelvinVoigt
FOUNDATIONS: dict[str, Any] = {
    cls.kind: cls for cls in (Foundation, GeneralizedMaxwell, FractionalKelvinVoigt)
}
"""The kinds that a scene file can name."""


def arms_of(given: Any) -> tuple[Arm, ...]:
    """Make the arms of a Prony series from pairs of stiffness and relaxation time, or from arms.

    Raises
    ------
    SceneError
        Listing every mistake.
    """
    pairs = given if isinstance(given, Sequence) and not isinstance(given, str) else ()
    if not 1 <= len(pairs) <= MOST_ARMS:
        raise ValueError(f"expected 1 to {MOST_ARMS} {PAIRS}")
    problems: list[str] = []
    arms: dict[int, Arm] = {}
    for number, pair in enumerate(pairs):
        key = f"foundation.arms[{number}]"
        if isinstance(pair, Arm):
            arms[number] = pair
        elif isinstance(pair, Sequence) and not isinstance(pair, str) and len(pair) == 2:
            try:
                arms[number] = Arm(*pair)
            except SceneError as error:
                problems += [line.replace("arm", key, 1) for line in error.problems]
        else:
            problems.append(problem(key, pair, f"expected one of {PAIRS}"))
    problems += _equal_times(arms)
    if problems:
        raise SceneError(problems)
    return tuple(arms.values())


def _equal_times(arms: Mapping[int, Arm]) -> list[str]:
    """Report the arms that have a relaxation time in common."""
    if not arms:
        return []
    numbers = np.array(list(arms))
    times = np.stack(np.broadcast_arrays(*(arm.relaxation_time for arm in arms.values())))
    times = times.reshape(len(arms), -1)
    order = np.argsort(times, axis=0, kind="stable")
    times = np.take_along_axis(times, order, axis=0)
    close = np.argwhere(times[1:] <= times[:-1] * (1.0 + DISTINCT))
    pairs = {(numbers[order[i, j]], numbers[order[i + 1, j]]): times[i, j] for i, j in close}
    return [
        f"foundation.arms[{one}] and foundation.arms[{two}] have the relaxation time {time:g} s in "
        "common; expected one arm with the sum of both"
        for (one, two), time in pairs.items()
    ]
