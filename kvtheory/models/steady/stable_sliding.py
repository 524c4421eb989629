"""Stability of steady sliding on whole arrays of scenes, block by block, with its certificate."""

import math
from collections.abc import Sequence, Set
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import general_stability
from kvtheory.models.steady.critical_velocity import critical_velocity
from kvtheory.models.steady.rates import rates
from kvtheory.models.steady.stability import Numbers, is_stable, numbers, onsets
from kvtheory.results import Certificate, Stability
from kvtheory.scene.capabilities import lacks_stability
from kvtheory.scene.model import Scene

BLOCK = 8192
"""Scenes treated at a time: the intermediate arrays of a block stay in the processor's cache."""
ON_GRID = 64
"""Scenes treated at a time where each is evaluated on a grid of velocities."""

STATEMENT = (
    "closed forms (theorem F22) in double precision, with what rounding makes of them to first order; "
    "rates by their polynomial, the velocity to where its stiffness is critical"
)
ON_ARMS = (
    "memory integrals in closed form, checked by quadrature, with what rounding and sums over strips make "
    "of them to first order; critical stiffnesses from a grid of frequencies that follows resonances; "
    "the least stable rates, counted by the argument principle (an error of infinity: the count differs)"
)
FREQUENCIES = 64
"""Scenes on arms treated at a time: each is evaluated on a grid of frequencies, a ball in each strip."""
SLOW = "rates", "time_constants"
"""The quantities with a last axis for the rates."""


def solve(scene: Scene, wanted: Set[str]) -> Stability:
    """Return the wanted quantities of a scene, or of its arrays; the indenter is a parabola or a ball.

    With a rigid drive the critical stiffness is that of a spring without damper and with the mass of the
    support; a fixed one has none.
    """
    shape, on_arms = scene.shape, bool(scene.foundation.arms)
    size = ON_GRID if "critical_velocity" in wanted else BLOCK
    if on_arms:
        size = FREQUENCIES if scene.indenter.per_width else FREQUENCIES // 16
    flat = scene.at(np.broadcast_to(scene.drive.final_velocity, shape or (1,))).flat()
    starts = range(0, max(math.prod(shape), 1), size)
    block = _block_on_arms if on_arms else _block
    parts = [block(flat.rows(slice(start, start + size)), wanted) for start in starts]
    found, errors = (
        {name: _joined([part[which][name] for part in parts], shape) for name in parts[0][which]}
        for which in (0, 1)
    )
    return Stability(
        **found,
        rigid_drive=scene.drive.rigid,
        model="exact",
        certificate=Certificate("estimated", ON_ARMS if on_arms else STATEMENT, errors),
    )


def lasts(scene: Scene) -> Any:
    """Return whether steady sliding of scenes is stable; None if that is not known for their spring.

    >>> lasts(Scene().replace({"drive.velocity": [0.02, 0.091], "drive.stiffness": 1e6})).tolist()
    [True, False]
    """
    if scene.drive.rigid:
        return True
    return None if lacks_stability(scene) else solve(scene, {"stable"}).stable


def _block(scene: Scene, wanted: Set[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the quantities of flat scenes by name, NaN where they are not wanted, and their errors."""
    tau, spring = np.broadcast_to(scene.foundation.retardation_time, scene.shape), None
    if not scene.drive.rigid:
        spring = np.broadcast_to(scene.drive.stiffness, scene.shape)
    given = Numbers(*(np.broadcast_to(each, scene.shape) for each in numbers(scene)))
    lower, upper = onsets(given, tau)
    found = _unless_wanted(scene.shape) | {
        "critical_stiffness": upper.stiffness,
        "lower_critical_stiffness": lower.stiffness,
        "frequency": upper.frequency,
    }
    errors = {
        "critical_stiffness": upper.error,
        "lower_critical_stiffness": lower.error,
        "frequency": upper.error,
    }
    if spring is not None:
        found["stable"] = is_stable(spring, lower, upper)
        if "critical_velocity" in wanted:
            found["critical_velocity"], errors["critical_velocity"] = critical_velocity(scene)
    if not wanted.isdisjoint(SLOW):
        sigma, error = rates(given, tau, spring)
        _add_rates(found, errors, sigma, error)
    return found, errors


def _block_on_arms(scene: Scene, wanted: Set[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what `_block` does for a Prony series."""
    found, errors = _unless_wanted(scene.shape), dict[str, Any]()
    rigid, rows, spring = scene.drive.rigid, range(*scene.shape), None
    if rigid and scene.held:  # nothing can move
        _add_rates(found, errors, np.empty((*scene.shape, 0), complex), np.empty((*scene.shape, 0)))
        return found, errors
    few, fine, finer, crossings = general_stability.solve(scene)
    stiffnesses, errors = general_stability.critical(crossings, *scene.shape)
    found |= stiffnesses
    if not rigid:
        spring = np.broadcast_to(scene.drive.stiffness, scene.shape)
        found["stable"] = ~crossings.unstable(spring)
        if "critical_velocity" in wanted:
            each = [scene.rows(slice(i, i + 1)) for i in rows]
            pairs = [general_stability.critical_velocity(one) for one in each]
            found["critical_velocity"], errors["critical_velocity"] = np.reshape(pairs, (-1, 2)).T
    if not wanted.isdisjoint(SLOW):
        parts = [
            general_stability.rates(
                few.rows([i]),
                fine.rows([i]),
                finer.rows([i]),
                None if spring is None else float(spring[i]),
            )
            for i in rows
        ]
        s, error = (np.array([part[which] for part in parts]) for which in (0, 1))
        _add_rates(found, errors, s, error)
    return found, errors


def _add_rates(found: dict[str, Any], errors: dict[str, Any], s: Any, error: Any) -> None:
    """Add rates and time constants; those that neither grow nor fade have an infinite one."""
    found["rates"] = np.stack([s.real, s.imag], axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        found["time_constants"] = -1.0 / s.real
        errors["rates"] = error
        errors["time_constants"] = error * np.abs(s) / np.abs(s.real)


def _unless_wanted(shape: tuple[int, ...]) -> dict[str, Any]:
    """Return what stands for the quantities of flat scenes that are not computed."""
    nothing = np.full(shape, np.nan)
    return {
        "stable": np.full(shape, True),
        "rates": nothing[:, np.newaxis, np.newaxis],
        "time_constants": nothing[:, np.newaxis],
        **dict.fromkeys(
            ("critical_stiffness", "lower_critical_stiffness", "critical_velocity", "frequency"),
            nothing,
        ),
    }


def _joined(parts: Sequence[NDArray[Any]], shape: tuple[int, ...]) -> Any:
    """Join the blocks of a quantity to the shape of the scenes; of one scene it is a plain value."""
    whole = np.concatenate(parts)
    array = whole.reshape((*shape, *whole.shape[1:]))
    return array if array.ndim else array.item()
