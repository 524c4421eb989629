"""The methods of steady sliding, and how a formula is evaluated on a scene or on scenes of arrays."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import (
    asymptotes,
    ball,
    ball_viscoelastic,
    exact,
    power_law,
    viscoelastic,
)
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState, units_for
from kvtheory.scene.capabilities import lacks_kelvin_voigt
from kvtheory.scene.model import Scene

CLOSED: Mapping[str, Any] = {
    "parabola": exact, "power-law": power_law, "wedge": power_law, "sphere": ball,
}  # fmt: skip
"""The closed forms on Kelvin-Voigt by shape; `kvtheory.scene.capabilities` lists the same shapes."""
MOMENTS: Mapping[str, Any] = {"parabola": viscoelastic, "sphere": ball_viscoelastic}
"""The same on any foundation, by the moments of its relaxation function."""

BLOCK, COLUMN = 16384, 1024
"""Scenes evaluated together by formulas and by quadrature, so that intermediate arrays stay in the cache."""
LIMIT_ALONE = Certificate(
    "none",
    "the limit of a regime alone; `asymptotes` gives its error relative to the exact state",
    {},
)
"""What is known of an asymptote without the exact state."""

QUANTITIES = tuple(STEADY_UNITS)
ODD = "leading_edge", "trailing_edge", "friction_force", "friction_coefficient"
"""Quantities that change their sign with the velocity."""
ODD_ROWS = [QUANTITIES.index(name) for name in ODD]
ZERO_AT_REST = "retardation_length", "friction_force", "friction_coefficient"
SMALLEST = float(np.finfo(float).tiny)

Array = NDArray[np.float64]
Formula = Callable[[Scene], Sequence[Any]]


def solve_exact(scene: Scene) -> SteadyState:
    """Evaluate the closed forms, or the moments of the relaxation function."""
    family = (MOMENTS if lacks_kelvin_voigt(scene) else CLOSED)[scene.indenter.shape]
    certificate = exact.HELD if family is exact and scene.held else family.CERTIFICATE
    floats = family in (exact, ball)
    return _evaluate(family.quantities, scene, certificate, family.OWN_ERRORS, floats=floats)


def solve_quadrature(scene: Scene) -> SteadyState:
    """Integrate the pressure of any indenter; raise if one of the scenes fails."""
    from kvtheory.models.steady import quadrature  # slow to import

    certificate = quadrature.certificate(scene)
    return _evaluate(
        quadrature.quantities, scene, certificate, QUANTITIES, model="quadrature", block=COLUMN
    )


def solve_asymptote(scene: Scene) -> SteadyState:
    """Evaluate the asymptote of the regime of each velocity."""
    limits = asymptotes.limits(scene)
    slow = np.abs(scene.drive.final_velocity) <= asymptotes.critical_velocity(scene)
    with np.errstate(divide="ignore", invalid="ignore"):  # the limit V -> oo at rest, not used
        low, high = (asymptotes.quantities(scene, limit) for limit in limits)
    values = {
        name: plain(np.broadcast_to(np.where(slow, low[name], high[name]), scene.shape))
        for name in QUANTITIES
    }
    units = units_for(scene.indenter, STEADY_UNITS)
    return SteadyState(**values, model="asymptote", certificate=LIMIT_ALONE, units=units)


METHODS: dict[str, Callable[[Scene], SteadyState]] = {
    "exact": solve_exact,
    "quadrature": solve_quadrature,
    "asymptote": solve_asymptote,
}


def _evaluate(
    formula: Formula,
    scene: Scene,
    certificate: Certificate,
    own_errors: tuple[str, ...],
    *,
    floats: bool = True,
    model: str = "exact",
    block: int | None = None,
) -> SteadyState:
    """Return the steady state that `formula` gives for a scene, or for each of its arrays.

    The formula returns the quantities at |V|, in the order of `STEADY_UNITS`, and then the relative errors of
    those in `own_errors`, which replace what the certificate says of them. It takes flat arrays, and floats
    too if `floats` says so. `FloatingPointError` if a value leaves the range of double precision.
    """
    shape, V = scene.shape, scene.drive.final_velocity
    with np.errstate(over="raise", divide="raise", invalid="raise", under="ignore"):
        if shape:
            flat = _blocks(formula, scene.flat(), own_errors, block or BLOCK)
            rows: Any = flat.reshape(len(flat), *shape)
        elif floats:
            rows = [float(each) for each in formula(scene)]
        else:
            rows = [float(np.ravel(each)[0]) for each in formula(scene.at(np.array([V])))]
    values = rows[: len(QUANTITIES)]
    if not shape:
        if V < 0.0:
            _mirror(values, -1.0)
        if not all(SMALLEST <= abs(each) < math.inf for each in values):
            _check_range(np.asarray(values), V, own_errors)
    own = dict(zip(own_errors, rows[len(values) :], strict=True))
    errors = {**certificate.relative_error, **own}
    certificate = Certificate(certificate.kind, certificate.statement, errors)
    units = units_for(scene.indenter, STEADY_UNITS)
    named: dict[str, Any] = dict(zip(QUANTITIES, values, strict=True))
    return SteadyState(**named, model=model, certificate=certificate, units=units)


def _blocks(formula: Formula, flat: Scene, own_errors: tuple[str, ...], block: int) -> Array:
    """Evaluate a formula for flat scenes, block by block."""
    (size,) = flat.shape
    result = np.empty((len(QUANTITIES) + len(own_errors), size))
    for start in range(0, size, block):
        part = slice(start, start + block)
        some = flat.rows(part)
        for row, values in zip(result, formula(some), strict=True):
            row[part] = values
        backwards = some.drive.final_velocity < 0.0
        if np.any(backwards):
            _mirror(result[:, part], np.where(backwards, -1.0, 1.0))
        _check_range(result[: len(QUANTITIES), part], some.drive.final_velocity, own_errors)
    return result


def _mirror(rows: Any, side: Any) -> None:
    """Give the odd rows the sign of the velocity: a reversed drive is the mirror image."""
    for row in ODD_ROWS:
        rows[row] = side * rows[row] + 0.0  # no negative zero


def _check_range(values: Array, velocity: Any, own_errors: tuple[str, ...]) -> None:
    """Raise if a value is not finite, or subnormal; zero is right at rest, or has its own error."""
    size = np.abs(values)
    if not size.size or (size.min() >= SMALLEST and size.max() < math.inf):
        return
    lost = size < SMALLEST
    lost[[QUANTITIES.index(name) for name in ZERO_AT_REST]] &= velocity != 0.0
    lost[[QUANTITIES.index(name) for name in own_errors]] = False
    for wrong, what in ((~np.isfinite(values), "overflow"), (lost, "underflow")):
        if wrong.any():
            row = wrong.reshape(len(values), -1).any(axis=1).argmax()
            raise FloatingPointError(f"{what} in {QUANTITIES[int(row)]}")


def plain(array: Any) -> Any:
    """Return an array without dimensions as a plain value."""
    return array if array.ndim else array.item()
