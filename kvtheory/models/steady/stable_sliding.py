"""Stability of steady sliding for arrays of scenes: `stability` on Kelvin-Voigt, else `general_stability`."""

import math
from collections.abc import Set
from typing import Any

import numpy as np

from kvtheory.models.steady import general_stability, stability
from kvtheory.results import Certificate, Stability
from kvtheory.results.cycles import Cycle
from kvtheory.scene.capabilities import lacks_stability
from kvtheory.scene.model import Scene

BLOCK, ON_GRID, ON_ARMS, BALL_ON_ARMS = 8192, 64, 64, 4
"""Scenes treated at a time, so that intermediate arrays stay in the cache: with closed forms alone, on a grid
of velocities, on a grid of frequencies, and in each strip of a ball as well."""
RATES = "rates", "time_constants"
"""The quantities with a last axis for the rates."""
CRITICAL = "critical_stiffness", "lower_critical_stiffness", "frequency"


def solve(scene: Scene, wanted: Set[str]) -> Stability:
    """Return the wanted quantities of a scene, or of its arrays; the indenter is a parabola or a ball.

    With a rigid drive the critical stiffness is that of a spring without damper and with the mass of the
    support; a fixed one has none.
    """
    shape, on_arms = scene.shape, bool(scene.foundation.arms)
    size = ON_GRID if "critical_velocity" in wanted else BLOCK
    if on_arms:
        size = ON_ARMS if scene.indenter.per_width else BALL_ON_ARMS
    flat = scene.at(np.broadcast_to(scene.drive.final_velocity, shape or (1,))).flat()
    starts = range(0, max(math.prod(shape), 1), size)
    parts = [_block(flat.rows(slice(start, start + size)), wanted) for start in starts]

    def joined(which: int, name: str) -> Any:
        whole = np.concatenate([part[which][name] for part in parts])
        array = whole.reshape((*shape, *whole.shape[1:]))
        return array if array.ndim else array.item()

    found, errors = ({name: joined(i, name) for name in parts[0][i]} for i in (0, 1))
    statement = (general_stability if on_arms else stability).STATEMENT
    certificate = Certificate("estimated", statement, errors)
    return Stability(**found, rigid_drive=scene.drive.rigid, model="exact", certificate=certificate)


def lasts(scene: Scene) -> Any:
    """Return whether steady sliding of scenes is stable; None if that is not known for their spring.

    >>> lasts(Scene().replace({"drive.velocity": [0.02, 0.091], "drive.stiffness": 1e6})).tolist()
    [True, False]
    """
    if scene.drive.rigid:
        return True
    return None if lacks_stability(scene) else solve(scene, {"stable"}).stable


def rates_of(scene: Scene) -> Any:
    """Return the rates of small motions of one scene, see `Stability`; None if they are not known."""
    return None if lacks_stability(scene) else solve(scene, {"rates"}).rates


def ended(scene: Scene, found: Cycle) -> Cycle:
    """Return how a motion ends, unknown if in steady sliding that is unstable: its ripple is still small.

    So it may be where stability is not known, unless the motion was shown to fade.
    """
    known = lasts(scene) if found.amplitude == 0.0 else True
    return found if (found.fell if known is None else known) else Cycle(0.0)


def _block(scene: Scene, wanted: Set[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the quantities of flat scenes by name, NaN where they are not wanted, and their errors."""
    nothing, rigid = np.full(scene.shape, np.nan), scene.drive.rigid
    found: dict[str, Any] = {
        "stable": np.full(scene.shape, True),
        "rates": nothing[:, np.newaxis, np.newaxis],
        "time_constants": nothing[:, np.newaxis],
        **dict.fromkeys((*CRITICAL, "critical_velocity"), nothing),
    }
    errors: dict[str, Any] = dict.fromkeys(CRITICAL, nothing)
    s, error = np.empty((*scene.shape, 0), complex), np.empty((*scene.shape, 0))
    if not (rigid and scene.held):  # else nothing can move
        spring = None if rigid else np.broadcast_to(scene.drive.stiffness, scene.shape)
        on_arms = scene.foundation.arms and scene.shape != (
            0,
        )  # else there is nothing to search for
        module = general_stability if on_arms else stability
        motions = module.SmallMotions(scene)
        values, wrong = motions.critical()
        found |= zip(CRITICAL, values, strict=True)
        errors |= zip(CRITICAL, wrong, strict=True)
        if spring is not None:
            found["stable"] = motions.stable(spring)
            if "critical_velocity" in wanted:
                pair = module.critical_velocity(scene)
                found["critical_velocity"], errors["critical_velocity"] = pair
        if not wanted.isdisjoint(RATES):
            s, error = motions.rates(spring)
    if not wanted.isdisjoint(RATES):
        found["rates"] = np.stack([s.real, s.imag], axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):  # rates that neither grow nor decay
            found["time_constants"] = -1.0 / s.real
            errors |= {"rates": error, "time_constants": error * np.abs(s) / np.abs(s.real)}
    return found, errors
