"""The law of one element, and the rule by which it is found to press, right or wrong.

An element that is compressed by u answers with the pressure

    p = K u + C u' + s_1 + s_2 + ...,   s_i' = K_i u' - s_i/tau_i:

a spring, a damper and Maxwell arms. Kelvin-Voigt has no arms, a Prony series no damper. The state of an
element is the column (u, s_1, s_2, ...), of a row of elements an array of such columns.
"""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.foundations import AnyFoundation

Array = NDArray[np.float64]

TIE = 1e-9
"""Relative: an element in contact is on the surface, up to rounding."""
SMALL = 2e-2
"""Below this z, the mean of a ramp is taken from its series to z^5, where the closed form would cancel."""


class Step(NamedTuple):
    """What the law says of a step of the length h: all is linear in the state.

    An element out of contact is left alone at first, one in contact is held where it is; besides, it is
    moved along a straight line to where the indenter ends, and no other history of u enters. `left` is the
    matrix of the state if left alone, `held` its factors if held, `held_pressure` gives the mean pressure
    then; `ramp` is the state that a unit ramp adds, `stiffness` the mean pressure that it adds; `damping`
    is that of the damper which, beside a spring, does to a ramp as the step does.
    """

    left: Array
    held: Array
    held_pressure: Array
    ramp: Array
    stiffness: float
    damping: float

    def alone(self, states: Array) -> Array:
        """Return what becomes of elements that are left alone."""
        return self.left @ states if len(states) > 1 else self.left[0, 0] * states


@dataclass(frozen=True, eq=False)
class Law:
    """An element with the stiffness K (N/m^3), the damping C (N s/m^3) and arms K_i, tau_i (s).

    >>> from kvtheory.scene import Foundation
    >>> law = Law.of(Foundation(2.0, 0.1))
    >>> one = law.at_rest(np.array([1.0]))
    >>> law.pressure(one, one[0], 5.0), (law.step(0.1).left @ one).round(6), round(law.step(0.1).stiffness, 6)
    (array([3.]), array([[0.367879]]), 3.163953)
    """

    stiffness: float
    damping: float
    arm_stiffness: Array
    arm_time: Array

    @classmethod
    def of(cls, foundation: AnyFoundation) -> "Law":
        """Return the law of a foundation of springs, dampers and arms."""
        arms = foundation.arms
        K_i, tau_i = (
            np.array([getattr(arm, name) for arm in arms], dtype=float)
            for name in ("stiffness", "relaxation_time")
        )
        return cls(foundation.stiffness, 0.0 if arms else foundation.damping, K_i, tau_i)

    @cached_property
    def retardation_time(self) -> float:
        """(C + sum K_i tau_i)/K, in s."""
        return (self.damping + float(self.arm_stiffness @ self.arm_time)) / self.stiffness

    @cached_property
    def at_once(self) -> float:
        """K + sum K_i, the stiffness that a sudden compression meets beside the damper."""
        return self.stiffness + float(self.arm_stiffness.sum())

    @cached_property
    def remembers(self) -> bool:
        """Whether there are arms, to which it matters when an element entered the contact."""
        return self.arm_stiffness.size > 0

    def stiffness_within(self, time: float) -> float:
        """Return about what a compression meets that takes so long; of faster arms the damping is left."""
        return self.stiffness + float(self.arm_stiffness @ (self.arm_time / (self.arm_time + time)))

    @property
    def slowest(self) -> float:
        """The longest retardation time, in s: so fast an element is forgotten that is left alone."""
        return 1.0 / float(self._modes[0].min())

    def at_rest(self, u: Array) -> Array:
        """Return the state of elements that have long been compressed by u."""
        return np.concatenate([u[None, :], np.zeros((self.arm_stiffness.size, u.size))])

    def pressure(self, state: Array, g: Array, g_rate: Any) -> Array:
        """Return p of elements on the indenter, g and g' there (Eqs. 6, 7, 12)."""
        p: Array = self.stiffness * g + self.damping * g_rate
        return p + state[1:].sum(axis=0) if self.remembers else p

    def followed(self, gap: Array, g_rate: Array, h: float) -> Array:
        """Return how much more p would be of an element off the indenter, had it followed for a time h.

        It is brought down by the gap at the start of that time, and then moves with the indenter.
        """
        step, K_i = self.step(h), self.arm_stiffness
        brought, moved = float(K_i @ step.held[1:]), float(step.ramp[1:].sum())
        more: Array = brought * gap + (moved - brought) * h * g_rate
        return more

    def ramps(self, h: Array) -> tuple[Array, Array]:
        """Return what unit ramps of these lengths leave in the arms, and the mean pressures of them."""
        K_i = self.arm_stiffness
        phi_1, phi_2 = ramp_functions(h / self.arm_time[:, None])
        return K_i[:, None] * phi_1, 0.5 * self.stiffness + K_i @ phi_2

    def lags(self, h: float) -> bool:
        """Whether a pressure can change suddenly: by a damper, or an arm that is faster than a step."""
        return self.damping > 0.0 or bool((self.arm_time < h).any())

    @lru_cache(maxsize=64)  # noqa: B019  # a law lives as long as its run
    def step(self, h: float) -> Step:
        """Return what the law says of a step of the length h.

        The mean pressure of a damper is that with the weight e^(t/tau): k (g - u e^(-h/tau)), k =
        K/(1 - e^(-h/tau)), whatever the history of u between. That of arms is the plain mean: with
        z_i = h/tau_i, phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, an arm has over a ramp the mean
        phi_1 s_i + phi_2 K_i (u_1 - u_0) and ends at e^(-z) s_i + phi_1 K_i (u_1 - u_0).
        """
        K, C, K_i = self.stiffness, self.damping, self.arm_stiffness
        z = h / self.arm_time
        phi_1, phi_2 = ramp_functions(z)
        spring = 0.5 * K
        if C:
            spring = -K / math.expm1(-h * K / C) if h else math.inf
        k = spring + float(K_i @ phi_2)
        weights = np.concatenate([[K], phi_1])
        return Step(
            left=self._left(h),
            held=np.concatenate([[1.0], np.exp(-z)]),
            held_pressure=weights,
            ramp=np.concatenate([[1.0], K_i * phi_1]),
            stiffness=k,
            damping=C + h * float(K_i @ (2.0 * phi_2 - phi_1)),
        )

    def _left(self, h: float) -> Array:
        """Return the matrix of a state that is left alone, where p = 0."""
        rates, modes, back = self._modes
        fall = np.exp(-h * rates)
        if self.damping:
            return np.diag(fall)
        # With y_i = u - s_i/K_i, the compressions of the dampers, u = sum K_i y_i/(K + sum K_i).
        K_i = self.arm_stiffness
        y = (modes * fall) @ back
        to_y = np.concatenate([np.ones((K_i.size, 1)), np.diag(-1.0 / K_i)], axis=1)
        u = (K_i / self.at_once) @ y
        return np.concatenate([u[None, :], K_i[:, None] * (u[None, :] - y)]) @ to_y

    @cached_property
    def _modes(self) -> tuple[Array, Array, Array]:
        """Retardation rates of an element that is left alone, and its modes, in y_i.

        y_i' = (u - y_i)/tau_i is symmetric with the weights sqrt(K_i tau_i); its inverse has the
        retardation times for eigenvalues, each longer than that of an arm.
        """
        if self.damping:
            return np.array([self.stiffness / self.damping]), np.eye(1), np.eye(1)
        weight = np.sqrt(self.arm_stiffness * self.arm_time)
        inverse = np.diag(self.arm_time) + np.outer(weight, weight) / self.stiffness
        times, vectors = np.linalg.eigh(inverse)
        rates = 1.0 / np.maximum(times, self.arm_time.min())
        return rates, vectors / weight[:, None], vectors.T * weight


def ramp_functions(z: Array) -> tuple[Array, Array]:
    """Return phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, from 1 and 1/2 at z = 0.

    >>> [value.round(6).tolist() for value in ramp_functions(np.array([0.0, 1.0, 1e9]))]
    [[1.0, 0.632121, 0.0], [0.5, 0.367879, 0.0]]
    """
    safe = np.where(z > 0.0, z, 1.0)
    phi_1 = np.where(z > 0.0, -np.expm1(-z) / safe, 1.0)
    series = np.ones_like(z)
    for n in (7, 6, 5, 4, 3):
        series = 1.0 - z * series / n
    return phi_1, np.where(z < SMALL, 0.5 * series, (1.0 - phi_1) / safe)


class ContactRule(NamedTuple):
    """How an element is found to press in an explicit scheme; a field that is not the default is a mistake.

    `flags`: an element in contact stays so until its pressure vanishes (Eqs. 23-25); without, it counts
    only where the surface of the foundation is met. `stale`: within a step that surface is the one at its
    start. `still`: elements stand still within it, and move at its end. `pulls`: an element below the plane
    z = 0 is never let go. `relaxes`: the free surface decays as e^(-t/tau) (Eq. 20). `remembers`: it is
    where the indenter left it; without, in the plane z = 0.
    """

    flags: bool = True
    stale: bool = False
    still: bool = False
    pulls: bool = False
    relaxes: bool = True
    remembers: bool = True

    def pressed(
        self, g: Array, p: Array, surface: tuple[Array, Array], touched: NDArray[np.bool_],
        *, within: bool,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Return which elements press; `surface` is that at the start of the step, and the present one."""
        if not self.remembers:
            return np.asarray((g > 0.0) & (p >= 0.0))
        free = surface[0] if self.stale and within else surface[1]
        met = touched | (g > free) if self.flags else g >= free * (1.0 - TIE)
        return np.asarray(met & (g > 0.0 if self.pulls else p >= 0.0))


RIGHT = ContactRule()
