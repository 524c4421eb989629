"""How wrong independent elements are for a layer: bounds from a map by boundary elements.

The stiffness K of the elements is that which gives the depth at rest of the layer under the load. At low
velocity friction and depth are then right (F28); beyond, they are wrong because the stiffness of a layer
depends on the length of the contact. The error depends on

    H/a, a = sqrt(2 R depth) the half length at rest;
    Poisson's ratio;
    V/V*, V* the intersection of the asymptotes of the elements;
    the stiffening E_g/E_0 = 1 + sum E_i/E_0 from the relaxed modulus to the glassy one, which is infinite
    on Kelvin-Voigt;
    the width of the spectrum, log10(<tau> <1/tau>) with means weighted by the moduli: 0 of one arm, 5.4 of
    two equal arms six decades apart.

From its low to its high limit friction needs 1 + log10(1 + tau r)/2 decades on either side of V*, with
tau = sum E_i tau_i/E_0 and r = sum (E_i/tau_i)/E_g, over which the map is written by
`tests/layer_error_table.py`.

Arms far apart in time relax one after the other, and the error of friction has a peak for each of them. The
width alone does not say where: the bound is then at least the largest one at any velocity, of one arm of the
stiffening E'/E_0 that is reached there, at the frequency 3 V/a.
"""

import json
import math
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAFETY, LEAST = 0.5, 2e-2
"""Share of the errors at the nearest entries that is added, as the map is not linear, and least error."""
APART = 2.0
"""Width, in decades, from which the place of a peak is not known; below, a share of it counts."""
REACHED = 3.0
"""Frequency over V/a of the stiffening that is reached at a velocity."""
TABLE = Path(__file__).parent / "model_error.json"


def spectrum(arms: Any) -> tuple[Any, Any]:
    """Return width, in decades, and stiffening E_g/E_0 of arms: pairs of E_i/E_0, or K_i/K, and tau_i.

    These are numbers, or arrays that broadcast. No arms are the damper of Kelvin-Voigt.

    >>> print(*spectrum([(4.0, 0.02)]), "%.2f %.0f" % spectrum([(2.0, 1e-3), (2.0, 1.0)]), *spectrum([]))
    0.0 5.0 2.40 5 0.0 inf
    """
    if not len(arms):
        return 0.0, np.inf
    size = sum(E for E, _ in arms)
    spread = sum(E * tau for E, tau in arms) * sum(E / tau for E, tau in arms) / size**2
    return np.log10(np.maximum(spread, 1.0)), 1.0 + size


def stiffening_at(arms: Any, rate: Any) -> Any:
    """Return the stiffening reached at a rate V/a, E'/E_0 at `REACHED` times it; infinite without arms.

    >>> print(stiffening_at([(4.0, 0.02)], 0.0), round(stiffening_at([(4.0, 0.02)], 50.0), 6))
    1.0 4.6
    """
    turns = [(E, REACHED * rate * tau) for E, tau in arms]
    return 1.0 + sum(E * z * z / (1.0 + z * z) for E, z in turns) if turns else np.inf


def half_width(spectrum_width: Any, stiffening: Any) -> Any:
    """Return how many decades of V on either side of V* friction needs from its low to its high limit."""
    M = np.asarray(stiffening, dtype=float)
    finite = np.where(np.isinf(M), 1.0, M)
    steps = 10.0**spectrum_width * (finite - 1.0) ** 2 / finite
    return 1.0 + 0.5 * np.log10(1.0 + steps)


def relative_error(
    kind: str,
    thickness_over_half_length: Any,
    poisson_ratio: Any,
    velocity_over_critical: Any,
    spectrum_width: Any,
    stiffening: Any,
    reached: Any = None,
    held: bool = False,
) -> tuple[Array, Array]:
    """Return bounds of the relative error of friction coefficient and depth; arrays broadcast.

    At a given depth (`held`) the second is the error of the load, whose K gives the load at rest. `reached`
    is the stiffening at the velocity, see `stiffening_at`; by default the whole one.

    `kind` is "line" or "ball", for a parabola; the error is that of the elements over the layer. It is
    interpolated in the map, and half of the errors at the entries nearby and 2 % are added. Of 300 random
    scenes, of one to six arms or a damper, friction is below its bound in all 283 in which a grid resolves it
    to 2 %, depth or load in 299. Of 600 scenes of two to four arms over 3.5 to 7 decades, friction is below
    it in all of 585, depth or load in 599. The other two are loads at a given depth, at most 1.014 times
    their bounds. Below H = 0.1 a the bound is that at 0.1 a, and so with velocity and stiffening.

    It is inf where no bound is known: a line on more than 100 a, a stiffening above that of the map but not
    infinite, Kelvin-Voigt above 150 V*. Raises ValueError for another kind, or a Poisson's ratio that is
    not from 0 to 1/2.

    >>> friction, depth = relative_error("ball", [1.0, np.inf], 0.49, 1.0, 0.0, 6.0)
    """
    if kind not in ("line", "ball"):
        raise ValueError(f'`kind` = "{kind}": expected "line" or "ball"')
    given = (
        thickness_over_half_length,
        poisson_ratio,
        velocity_over_critical,
        spectrum_width,
        stiffening,
        stiffening if reached is None else reached,
    )
    h, nu, v, width, M, partly = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in given))
    if not np.all((nu >= 0.0) & (nu <= 0.5)):
        raise ValueError("`poisson_ratio`: expected from 0 to 0.5")
    support = "fixed" if held else "dead-weight"
    with np.errstate(divide="ignore", invalid="ignore"):
        place = np.log10(np.abs(v)) / half_width(width, M)
        arms, voigt = _map(support, kind, "arms"), _map(support, kind, "kelvin_voigt")
        found = np.where(
            np.isinf(M)[..., None],
            _at(*voigt, np.log(h), nu, place),
            _at(*arms, np.log(h), nu, np.log(M), width, place),
        )
        peak = _at(*_peaks(support, kind), np.log(h), nu, np.log(partly))
        thicknesses, _, places = voigt[0]
        thick = (kind == "line") & (np.log(h) > thicknesses[-1])
        fast = np.where(np.isinf(M), place > places[-1], np.log(M) > arms[0][2][-1])
    lowest, highest, largest = np.moveaxis(found.reshape(*found.shape[:-1], 3, 2), -2, 0)
    bound = np.maximum(abs(lowest), abs(highest)) + SAFETY * largest + LEAST
    apart = np.clip(width / APART, 0.0, 1.0)[..., None]
    bound = np.maximum(bound, apart * ((1.0 + SAFETY) * peak + LEAST))
    bound = np.where((thick | fast)[..., None], np.inf, bound)
    return bound[..., 0], bound[..., 1]


@cache
def _map(support: str, kind: str, law: str) -> tuple[list[Array], Array]:
    """Return the axes of the map, and the lowest, highest and largest errors of both quantities."""
    table = json.loads(TABLE.read_text())
    own = table[support]
    axes = [np.log(table["thickness"]), np.array(table["poisson_ratio"]), np.array(table["place"])]
    if law == "arms":
        axes[2:2] = [np.log(own["stiffening"]), np.array(own["width"])]
    found = np.reshape(own[f"{kind} {law}"], (*map(len, axes), 4)) * 1e-3  # from per mille
    largest = np.maximum(abs(found[..., :2]), abs(found[..., 2:]))
    return axes, np.concatenate([found, largest], axis=-1)


@cache
def _peaks(support: str, kind: str) -> tuple[list[Array], Array]:
    """Return axes and entries of the largest errors of one arm at any velocity; unstiffened there is none."""
    (thicknesses, ratios, stiffenings, _, _), entries = _map(support, kind, "arms")
    found = np.abs(entries[:, :, :, 0]).max(axis=3)[..., 4:]
    axes = [thicknesses, ratios, np.append(0.0, stiffenings)]
    return axes, np.concatenate([0.0 * found[:, :, :1], found], axis=2)


def _at(axes: list[Array], entries: Array, *point: Any) -> Array:
    """Return entries at a point, linear along each axis; beyond the ends of an axis, those at its end."""
    corners: list[tuple[Any, Any]] = []
    for x, axis in zip(np.broadcast_arrays(*point), axes, strict=True):
        i = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, axis.size - 2)
        share = np.clip((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0, 1.0)
        corners.append(((i, 1.0 - share), (i + 1, share)))
    return sum(
        math.prod(weight for _, weight in corner)[..., None] * entries[tuple(i for i, _ in corner)]
        for corner in product(*corners)
    )
