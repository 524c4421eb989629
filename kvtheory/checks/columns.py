"""The columns of a time series by name and bracketed unit, as people write them.

``t [ms]``, ``Time (s)``, ``t/ms``, ``z_A [mm]``, ``F_z in N/mm``, ``Zeit [ms]`` are recognised; a height of
the indenter, z_A = -depth (Eq. 18), becomes a depth.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from kvtheory.results.table import SERIES_UNITS
from kvtheory.scene.tables import parts, plain
from kvtheory.scene.units import to_si

PRESSURE = {"peak_pressure": "N/m^2"}
"""As `kvtheory.scene.units` spells its unit."""
SI_UNITS: Mapping[str, str] = {**SERIES_UNITS, **PRESSURE}
"""The units of the series of a line contact as they are spelt there."""

SPELLINGS = {
    "time": "time, t, Zeit",
    "velocity": "velocity, V, drive velocity, v_drive, Geschwindigkeit",
    "sliding_velocity": "sliding_velocity, sliding velocity, v_s, v_slide, slip velocity, "
    "Gleitgeschwindigkeit",
    "depth": "depth, delta, δ, indentation, indentation depth, penetration, Tiefe, Eindringtiefe",
    "-depth": "z_A, z, position, indenter position, height, Höhe, Hoehe, Lage",
    "depth_rate": "depth_rate, delta_dot, ddelta/dt, depth velocity",
    "-depth_rate": "v_z, vz_A, dz_A/dt, z_A_dot, vertical velocity",
    "normal_force": "normal_force, F_z, F_n, normal load, vertical force, Normalkraft, Vertikalkraft",
    "friction_force": "friction_force, F_x, F_t, F, friction, tangential force, horizontal force, "
    "Reibkraft, Reibungskraft, Tangentialkraft",
    "spring_force": "spring_force, spring force, F_s, F_spring, drive force, pulling force, Federkraft, "
    "Zugkraft",
    "leading_edge": "leading_edge, x_LE, Vorderkante",
    "trailing_edge": "trailing_edge, x_TE, Hinterkante",
    "peak_pressure": "peak_pressure, p_max, maximum pressure, pressure maximum, Druckmaximum, Maximaldruck",
}
"""How each quantity may be named; a minus sign marks those that point the other way."""

MISSPELT = 0.8
"""Likeness of a name to a known one from which on it is taken for misspelt, and not for something else."""


@dataclass(frozen=True)
class Column:
    """What a column of a file holds: `quantity` = `factor` times its numbers, in SI."""

    header: str
    quantity: str
    factor: float


KNOWN = {
    plain(spelling): quantity
    for quantity, spellings in SPELLINGS.items()
    for spelling in spellings.split(", ")
}
SHOWN = (
    "time, depth (or z_A), normal_force, friction_force, spring_force, leading_edge, trailing_edge"
)


def recognise(header: str, units: Mapping[str, str] = SI_UNITS) -> Column | None:
    """Return what a column holds; None if its name is of no quantity, nor nearly.

    `units` are those of the scene: the forces of a ball are whole.

    Raises
    ------
    ValueError
        Naming the column, what it lacks or which unit is expected, and the nearest known name.

    Examples
    --------
    >>> recognise("z_A [mm]")
    Column(header='z_A [mm]', quantity='depth', factor=-0.001)
    """
    header = header.strip()
    name, unit = (header, "") if plain(header) in KNOWN else parts(header)  # "dz_A/dt" is a name
    quantity = KNOWN.get(plain(name))
    if quantity is None:
        hint = _suggestion(name)
        if not hint:
            return None
        raise ValueError(f'column "{header}": unknown name{hint}')
    sign, quantity = (-1.0, quantity[1:]) if quantity[0] == "-" else (1.0, quantity)
    si = units[quantity]
    if not unit:
        raise ValueError(f'column "{header}": has no unit; expected "{name} [{si}]" or the like')
    try:
        factor = 1.0 if unit == si else to_si(f"1 {unit}", si)
        return Column(header, quantity, sign * factor)
    except ValueError as error:
        raise ValueError(f'column "{header}": {error}') from None


def _suggestion(name: str) -> str:
    """Say which known name is nearest, if one is near, and which there are."""
    spellings = {plain(s): s for names in SPELLINGS.values() for s in names.split(", ")}
    near = get_close_matches(plain(name), spellings, n=1, cutoff=MISSPELT)
    if not near:
        return ""
    known = "; ".join(f"{q.lstrip('-')}: {names}" for q, names in SPELLINGS.items())
    hint = f', did you mean "{spellings[near[0]]}"?'
    return f"{hint}; known names are {known}; rename a column that is something else"
