"""A Prony series with fewer arms: `fewer_arms`."""

from typing import Any

import numpy as np

from kvtheory.api._edge import double_precision, one_scene
from kvtheory.api._steady import method_for
from kvtheory.models.steady.methods import METHODS
from kvtheory.results.fits import FewerArms
from kvtheory.scene.arguments import a_scene, checked, flag, number
from kvtheory.scene.drives import VELOCITY
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import converted

AROUND = np.geomspace(1.0 / 30.0, 30.0, 25)
"""Velocities over that of the drive, if none are given."""


@checked(
    scene=a_scene, rtol=number(0.0), proved=flag,
    velocities=lambda value: np.atleast_1d(converted(value, VELOCITY)),
)  # fmt: skip
def fewer_arms(
    scene: Scene, *, velocities: Any = None, rtol: float = 0.01, proved: bool = True
) -> FewerArms:
    """Replace a Prony series by one with fewer arms, whose friction is the same within a tolerance.

    Elements and transients cost as much as there are arms, and a scene seldom needs all of them.

    Parameters
    ----------
    scene
        A parabola or a ball on a Prony series.
    velocities
        Those at which friction counts, in m/s or as text such as ``"1 mm/s:1 m/s:20:log"``; by default from
        a thirtieth to thirty times that of the drive.
    rtol
        Largest relative change of the friction coefficient in steady sliding at the velocities.
    proved
        Whether the proved bound on the change has to be within `rtol`, and not just the change itself,
        which is often a hundredth of it. There is a bound for a parabola under a load or at a depth.

    Returns
    -------
    FewerArms
        The scene with fewer arms, the bound, and the true change of friction. The relaxed stiffness stays.

    Raises
    ------
    ValueError
        If the foundation has no arms, or no bound is known.

    Examples
    --------
    >>> import kvtheory as kv
    >>> arms = [(3e10 / 2**k, 10.0 ** (0.25 * k - 6)) for k in range(21)]
    >>> found = kv.fewer_arms(kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms)))
    >>> len(found.arms), found.bound < 0.01, found.difference < 1e-4
    (16, True, True)

    References
    ----------
    Fact F27 of the derivations.
    """
    from kvtheory.fitting.fewer import has_bound, reduced

    scene = one_scene(scene, "fewer arms")
    if not scene.foundation.arms:
        raise ValueError(f'`scene`: foundation.kind = "{scene.foundation.kind}" has no arms')
    if proved and not has_bound(scene):
        message = "a bound is known for a parabola under a dead weight or at a fixed depth"
        raise ValueError(f"`proved` = True: {message}; give False")
    V = abs(scene.drive.final_velocity) * AROUND if velocities is None else np.abs(velocities)
    if not V.size or not V.all():
        message = "expected one value or more, other than 0, at which there is no friction"
        raise ValueError(f"`velocities`: {message}")
    with double_precision(scene):
        found = reduced(METHODS[method_for(scene, None)], scene, np.sort(V), rtol, proved=proved)
    return FewerArms(
        arms=tuple((arm.stiffness, +arm.relaxation_time) for arm in found.scene.foundation.arms),
        bound=found.bound,
        difference=found.difference,
        velocities=(float(V.min()), float(V.max())),
        scene=found.scene,
    )
