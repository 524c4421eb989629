"""What slides on what: the body, and the support of the indenter, in SI."""

from typing import Any, NamedTuple

import numpy as np

from kvtheory.layer.contact import Balance
from kvtheory.layer.memory import Creep


class Support(NamedTuple):
    """A given depth, or a load and a spring, relaxed at a depth: by default that at rest under the load.

    Loads are in N/m and springs in N/m^2 under a line, in N and N/m under a ball.
    """

    depth: float | None = None
    load: float = 0.0
    spring: float = 0.0
    relaxed_depth: float | None = None

    @classmethod
    def of_scene(cls, support: Any) -> "Support":
        """Return the support of a scene."""
        if support.depth is not None:
            return cls(depth=support.depth)
        return cls(load=support.weight, spring=support.spring)

    @property
    def carried(self) -> float:
        """The load that the contact would carry at no depth."""
        return self.load + self.spring * (self.relaxed_depth or 0.0)

    def balance(self, unit: float) -> Balance:
        """Return its balance where a sum of pressures of 1 carries the load `unit`."""
        if self.depth is not None:
            return Balance(0.0, 1.0, self.depth)
        return Balance(1.0, self.spring / unit, self.carried / unit)


class Body(NamedTuple):
    """A layer bonded to a rigid base, or a half-space (`thickness` inf).

    The relaxed `modulus` is in Pa, the thickness in m; Poisson's ratio, from 0 to 1/2, is constant in time.
    """

    modulus: float
    thickness: float
    poisson_ratio: float
    creep: Creep

    @classmethod
    def of_series(cls, modulus: float, thickness: float, poisson_ratio: float, arms: Any) -> "Body":
        """Return the body of a Prony series: `arms` are pairs of modulus and relaxation time, in SI."""
        moduli, times = np.array(arms, dtype=float).reshape(-1, 2).T
        creep = Creep.of_series(modulus, moduli, times)
        return cls(modulus, thickness, poisson_ratio, creep)

    @classmethod
    def kelvin_voigt(
        cls, modulus: float, thickness: float, poisson_ratio: float, retardation_time: float
    ) -> "Body":
        """Return the body with E(s) = E_0 (1 + s tau)."""
        return cls(modulus, thickness, poisson_ratio, Creep.kelvin_voigt(retardation_time))

    @classmethod
    def of_foundation(cls, foundation: Any) -> "Body":
        """Return the body of a foundation of a scene that is given by a layer, at its temperature."""
        given = foundation.modulus, foundation.thickness, foundation.poisson_ratio
        if None in given:
            raise ValueError(
                "foundation.stiffness is that of independent elements, not of a body; expected modulus, "
                "thickness and poisson_ratio of `foundation` instead, and arms with moduli"
            )
        if foundation.arms:
            arms = [(arm.modulus, arm.relaxation_time) for arm in foundation.arms]
            return cls.of_series(*given, arms)
        if foundation.kind != "kelvin-voigt":
            message = (
                "expected kelvin-voigt or generalized-maxwell: a springpot has no retardation times"
            )
            raise ValueError(f'`foundation.kind` = "{foundation.kind}": {message}')
        return cls.kelvin_voigt(*given, foundation.retardation_time)

    @property
    def compliance(self) -> float:
        """S = 2 (1 - nu^2)/E_0."""
        return 2.0 * (1.0 - self.poisson_ratio**2) / self.modulus
