"""A foundation from measured moduli: `fit_foundation`."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.api._edge import double_precision, one_scene
from kvtheory.api._steady import method_for
from kvtheory.models.steady.methods import METHODS
from kvtheory.results.fits import FoundationFit
from kvtheory.scene.arguments import a_scene, checked, choice, count, flag, measured, number
from kvtheory.scene.foundations import (
    MEASURED_RANGES,
    MOST_ARMS,
    Foundation,
    GeneralizedMaxwell,
    beyond,
)
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import quantities
from kvtheory.scene.units import ZERO_CELSIUS, in_celsius

LAYER = quantities(GeneralizedMaxwell)
DIGITS = 6
"""Significant digits of a fitted number."""
STEPS, PRECISE = 60, 1e-9
"""Most steps of V <- f c(V), which halve the error at least, and the relative change that ends them."""


@checked(
    scene=a_scene, modulus=choice(("E", "G")), thickness=measured(LAYER["thickness"]),
    poisson_ratio=measured(LAYER["poisson_ratio"]), stiffness=measured(LAYER["stiffness"]),
    temperature=measured(LAYER["temperature"]), vertical=flag, arms=count, rtol=number(0.0),
)  # fmt: skip
def fit_foundation(
    data: Any,
    scene: Scene | None = None,
    *,
    modulus: str | None = None,
    thickness: Any = None,
    poisson_ratio: Any = None,
    stiffness: Any = None,
    temperature: Any = None,
    shift_factors: Any = None,
    vertical: bool = False,
    arms: int | None = None,
    rtol: float | None = None,
) -> FoundationFit:
    """Fit a Prony series with non-negative arms to measured moduli.

    The moduli are dynamic, two of E'(f), E''(f), |E*| and tan delta or the phase, or viscosities; or relax,
    E(t); or are creep compliances, which are converted. Over all non-negative spectra the
    relative misfit is convex, so that the best one is found, and how good it is: no series, of any number
    of arms, has a misfit below `least_misfit` of the result. The arms are the fewest within the scatter of
    the data.

    Parameters
    ----------
    data
        A file as instruments export it, or a mapping of arrays by header (``{"f [Hz]": ..., "E' [MPa]":
        ..., "E'' [MPa]": ...}``): units in the headers or in the row below it; E or G in Pa to GPa, or
        stiffnesses per unit area in N/m^3. Sweeps at several temperatures (a column T) are shifted to one
        master curve. Or a card of Abaqus (.inp) or ANSYS (.mac), whose series is taken over.
    scene
        The scene that is given this foundation; without it, the paper's Table 1 with a dead weight.
    modulus
        ``"E"`` or ``"G"``, where the headers do not say which.
    thickness, poisson_ratio
        Of the layer that is the foundation: any thickness, up to a ratio of 0.5; K is that of its contact at
        rest in the scene, or, where the foundation of the scene says so, of a thin layer. Poisson's ratio is
        needed for shear moduli: E = 2 G (1 + nu).
    stiffness
        The relaxed stiffness K of the foundation as measured, to which the arms are scaled, instead of a
        layer; only ratios of the moduli count then.
    temperature
        That of the foundation. The reference temperature is that of the nearest sweep; without
        `temperature`, that of the middle one.
    shift_factors
        A file, or a mapping, of temperatures and log10 a_T (or a_T), instead of fitted shifts.
    vertical
        Whether moduli may shift too, by a factor for each sweep.
    arms
        Number of arms.
    rtol
        Root mean square of the relative residuals that is allowed, instead of the scatter of the data.

    Returns
    -------
    FoundationFit
        Arms, relaxed modulus and misfits, in SI; the scene with this foundation, and its TOML text.

    Raises
    ------
    ValueError
        If the data cannot be read, with column and line; if no series is within `rtol`; if the moduli relax
        to zero; or if an argument is out of range.

    Examples
    --------
    >>> import numpy as np
    >>> import kvtheory as kv
    >>> f = np.geomspace(0.1, 100.0, 31)
    >>> z = 2 * np.pi * f * 0.02  # one arm of 3 MPa and 20 ms, beside 1 MPa
    >>> data = {"f [Hz]": f, "E' [MPa]": 1 + 3 * z**2 / (1 + z**2), "E'' [MPa]": 3 * z / (1 + z**2)}
    >>> found = kv.fit_foundation(data, thickness="2 mm", poisson_ratio=0.45)
    >>> found.arms, found.modulus, round(found.foundation.stiffness / 1e9, 4)
    (((3000000.0, 0.02),), 1000000.0, 1.475)

    References
    ----------
    Baumgaertel and Winter (1989), doi:10.1007/BF01332922; Lawson and Hanson (1974), chapter 23.
    """
    from kvtheory.fitting import cards
    from kvtheory.fitting.foundation import fit, of_card

    scene = one_scene(scene, "a fit")
    card = isinstance(data, (str, Path)) and Path(data).suffix.lower() in cards.SUFFIXES
    if card:
        found, nu = of_card(Path(data))
        poisson_ratio = nu if poisson_ratio is None and thickness is not None else poisson_ratio
    if (thickness is None) != (poisson_ratio is None) and thickness is not None:
        raise ValueError("`thickness` needs `poisson_ratio` beside it")
    if arms is not None and arms > MOST_ARMS:
        raise ValueError(f"`arms` = {arms}: expected at most {MOST_ARMS}")
    if not card:
        how: Any = {"vertical": vertical, "arms": arms, "rtol": rtol}
        found = fit(data, modulus, temperature, shift_factors, **how)
    per_area = found.measured.kind == "K"
    factor = _to_young(found.measured.kind, 0.0 if stiffness is not None else poisson_ratio)
    layered = thickness is not None
    if layered and (per_area or stiffness is not None):
        message = "the data are stiffnesses of a foundation, not moduli of a layer"
        raise ValueError(
            f"`thickness`: {message if per_area else '`stiffness` takes the place of a layer'}"
        )
    relaxed, master, law = _rounded(found.series.relaxed * factor), found.shifted, found.law
    arm = found.series.modulus * factor, found.series.time
    pairs = tuple((_rounded(E), _rounded(tau)) for E, tau in zip(*arm, strict=True))
    moduli, times = np.array(pairs).T
    series = replace(found.series, relaxed=relaxed / factor, modulus=moduli / factor, time=times)
    thermal = _thermal(found, temperature)
    x, residuals = found.data.x, series.residuals(found.data)
    ends = 1.0 / np.array(found.data.times)[::-1] / (math.tau if found.data.dynamic else 1.0)
    frequencies = _rounded(ends[0]), _rounded(ends[1])
    own = {"arms": pairs, **thermal, **dict(zip(MEASURED_RANGES[0], frequencies, strict=True))}
    whole = None
    if stiffness is not None:
        own["arms"] = tuple((_rounded(E * stiffness / relaxed), tau) for E, tau in pairs)
        whole = replace(scene, foundation=GeneralizedMaxwell(stiffness, **own))
    elif per_area or layered:
        layer = {"modulus": relaxed, "thickness": thickness, "poisson_ratio": poisson_ratio}
        layer["stiffness_from"] = scene.foundation.stiffness_from
        own |= {"stiffness": relaxed} if per_area else layer
        whole = replace(scene, foundation=GeneralizedMaxwell(**own))
    source = (
        Path(found.measured.source).name if isinstance(data, (str, Path)) else found.measured.source
    )
    return FoundationFit(
        arms=pairs,
        modulus=None if per_area else relaxed,
        stiffness=relaxed if per_area else None if whole is None else float(whole.foundation.stiffness),
        misfit=float(np.sqrt(np.mean(residuals**2))),
        largest_misfit=float(np.abs(residuals).max()),
        least_misfit=found.least_misfit,
        shift_factors=None if master is None else tuple(
            (round(T - ZERO_CELSIUS, 4), _rounded(shift))
            for T, shift in zip(master.temperatures.tolist(), master.log_shift.tolist(), strict=True)
        ),
        shift_errors=None if master is None else tuple(map(_rounded, master.errors.tolist())),
        shift_law=None if law is None else (
            f"{law.text} at {in_celsius(found.reference):.4g} degC"
            + (f", log10 a_T to {law.misfit:.2g}" if law.errors else "")
        ),
        reference_temperature=None if law is None else thermal["reference_temperature"],
        frequencies=frequencies,
        velocities=None if whole is None else _velocities(whole, frequencies),
        source=source,
        notes=tuple(filter(None, (
            *found.notes, _at(temperature, thermal), beyond(whole.foundation) if whole else "",
        ))),
        scene=whole,
        data={
            "x": x, "measured": found.data.values * factor,
            "fitted": series.values(x, dynamic=found.data.dynamic) * factor, "residuals": residuals,
            "sweeps": found.measured.sweeps, "shifted": master, "law": law, "factor": factor,
            "poisson_ratio": nu if card else poisson_ratio, "series": series,
        },
    )  # fmt: skip


def _to_young(kind: str, poisson_ratio: float | None) -> float:
    """Return the factor from moduli to Young's; where only their ratios count, Poisson's ratio is any."""
    if kind != "G":
        return 1.0
    if poisson_ratio is None:
        message = "the moduli are shear moduli: Young's modulus is 2 G (1 + nu)"
        raise ValueError(f"`poisson_ratio`: missing; {message}")
    return 2.0 * (1.0 + poisson_ratio)


def _thermal(found: Any, temperature: float | None) -> dict[str, Any]:
    """Return what a foundation is given of temperature: the law, the measured factors and their range."""
    law, master = found.law, found.shifted
    if law is None:
        if temperature is not None:
            message = "no law of the shift factor is known: it needs several temperatures, or `shift_factors`"
            raise ValueError(f"`temperature`: {message}")
        return {}
    constants = tuple(map(_rounded, law.constants))
    thermal: dict[str, Any] = (
        {"wlf": constants} if law.name == "wlf" else {"activation_energy": constants[0]}
    )
    thermal["reference_temperature"] = _rounded(found.reference)
    thermal |= {} if temperature is None else {"temperature": temperature}
    if master is None:  # of a card, which has no measured factors
        return thermal
    thermal["shift_factors"] = tuple(
        (_rounded(T), _rounded(log))
        for T, log in zip(master.temperatures.tolist(), master.log_shift.tolist(), strict=True)
    )
    ends = map(_rounded, master.temperatures[[0, -1]])
    return thermal | dict(zip(MEASURED_RANGES[1], ends, strict=True))


def _at(temperature: float | None, thermal: Any) -> str:
    """Return by how much the times differ at the temperature of the foundation from those of the arms."""
    if temperature is None or temperature == thermal["reference_temperature"]:
        return ""
    a_T = Foundation(1.0, 1.0, **thermal).shift_factor
    T, T_ref = (each - ZERO_CELSIUS for each in (temperature, thermal["reference_temperature"]))
    of = f"times that of the arms, which hold at {T_ref:.4g} degC"
    return f"At {T:.4g} degC every time is a_T = {a_T:.4g} {of}."


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _velocities(scene: Scene, ends: Any) -> tuple[float, float] | None:
    """Return the velocities at which V over the length of the contact is at the ends of the frequencies."""
    solve = METHODS[method_for(scene, None)]
    factor = scene.foundation.shift_factor
    V = np.asarray(ends) / factor
    try:
        for _ in range(STEPS):
            with double_precision(scene):
                state = solve(scene.at(V))
            last, V = V, np.asarray(ends) / factor * (state.trailing_edge - state.leading_edge)
            if np.allclose(V, last, rtol=PRECISE, atol=0.0):
                break
    except (ValueError, ArithmeticError):
        return None
    return _rounded(V[0]), _rounded(V[1])
