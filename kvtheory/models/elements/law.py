"""The law of one element, and the rule by which it is found to press, right or wrong.

An element that is compressed by u answers with the pressure

    p = K u + C u' + s_1 + s_2 + ...,   s_i' = K_i u' - s_i/tau_i:

a spring, a damper and Maxwell arms. Kelvin-Voigt has no arms, a Prony series no damper. A free element, whose
p vanishes, is a sum of modes that decay exponentially, u = Σ c_k m_k, m_k' = -r_k m_k; without arms the one
mode is u itself.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.foundations import AnyFoundation

Array = NDArray[np.float64]


class Law(NamedTuple):
    """An element with the stiffness K (N/m^3), the damping C (N s/m^3) and arms K_i, tau_i (s).

    Its modes decay at the `rates` r_k and have the `shares` c_k; `to_modes` and `from_modes` go between them
    and the compressions of the dampers of the arms, y_i = u - s_i/K_i.

    >>> law = Law.of(2.0, 0.2)
    >>> law.retardation_time, law.longest_time, law.pressure(1.0, 5.0)
    (0.1, 0.1, 3.0)
    """

    stiffness: float
    damping: float
    arm_stiffness: Array
    arm_time: Array
    rates: Array
    shares: Array
    to_modes: Array
    from_modes: Array

    @classmethod
    def of(cls, stiffness: float, damping: float, arms: Any = ()) -> "Law":
        """Return the law of an element with a damper, or with arms (K_i, tau_i).

        y_i' = (u - y_i)/tau_i is symmetric with the weights sqrt(K_i tau_i); its inverse has the
        retardation times for eigenvalues, each longer than that of an arm.
        """
        stiffness, damping = float(stiffness), float(damping)
        K_i, tau_i = np.array(arms, dtype=float).reshape(-1, 2).T.copy()
        if not K_i.size:
            one = np.ones(1)
            return cls(
                stiffness,
                damping,
                K_i,
                tau_i,
                one * (stiffness / damping),
                one,
                np.eye(1),
                np.eye(1),
            )
        weight = np.sqrt(K_i * tau_i)
        times, vectors = np.linalg.eigh(np.diag(tau_i) + np.outer(weight, weight) / stiffness)
        back = vectors / weight[:, None]
        shares = K_i / (stiffness + K_i.sum()) @ back
        rates = 1.0 / np.maximum(times, tau_i.min())
        return cls(
            stiffness,
            0.0,
            K_i,
            tau_i,
            rates,
            shares,
            np.ascontiguousarray(vectors.T * weight),
            back,
        )

    @classmethod
    def of_foundation(cls, foundation: AnyFoundation) -> "Law":
        """Return the law of a foundation of springs, dampers and arms."""
        arms = [(arm.stiffness, arm.relaxation_time) for arm in foundation.arms]
        return cls.of(foundation.stiffness, 0.0 if arms else foundation.damping, arms)

    @property
    def retardation_time(self) -> float:
        """(C + sum K_i tau_i)/K, in s."""
        return (self.damping + float(self.arm_stiffness @ self.arm_time)) / self.stiffness

    @property
    def longest_time(self) -> float:
        """The longest retardation time, in s, in which a free element is forgotten."""
        return 1.0 / float(self.rates.min())

    @property
    def glassy_stiffness(self) -> float:
        """K + sum K_i, the stiffness that a sudden compression meets beside the damper."""
        return self.stiffness + float(self.arm_stiffness.sum())

    def stiffness_within(self, time: float) -> float:
        """Return the effective stiffness for loading over this time; of faster arms the damping is left."""
        return self.stiffness + float(self.arm_stiffness @ (self.arm_time / (self.arm_time + time)))

    def pressure(self, g: Any, g_rate: Any) -> Any:
        """Return p of elements on the indenter whose arms are relaxed (Eqs. 6, 7, 12)."""
        return self.stiffness * g + self.damping * g_rate

    def lags(self, h: float) -> bool:
        """Whether a pressure can change suddenly: by a damper, or an arm that is faster than a step."""
        return self.damping > 0.0 or bool((self.arm_time < h).any())


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


RIGHT = ContactRule()
