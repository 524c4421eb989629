"""The columns of a time series by name and bracketed unit, as people write them.

``t [ms]``, ``Time (s)``, ``z_A [mm]``, ``F_z [N/mm]``, ``depth [m]`` are recognised; a height of the
indenter, z_A = -depth (Eq. 18), becomes a depth.
"""

import re
from dataclasses import dataclass

from kvtheory.results import TRANSIENT_UNITS
from kvtheory.scene.quantities import closest
from kvtheory.scene.units import to_si

SI_UNITS = {**TRANSIENT_UNITS, "peak_pressure": "N/m^2"}
"""The units of a series as `kvtheory.scene.units` spells them."""

SPELLINGS = {
    "time": "time, t",
    "velocity": "velocity, V, drive velocity, v_drive, sliding velocity",
    "depth": "depth, delta, δ, indentation, indentation depth, penetration",
    "-depth": "z_A, z, position, indenter position, height",
    "depth_rate": "depth_rate, delta_dot, ddelta/dt, depth velocity",
    "-depth_rate": "v_z, vz_A, dz_A/dt, z_A_dot, vertical velocity",
    "normal_force": "normal_force, F_z, F_n, normal load, vertical force",
    "friction_force": "friction_force, F_x, F_t, F, friction, tangential force, horizontal force",
    "leading_edge": "leading_edge, x_LE",
    "trailing_edge": "trailing_edge, x_TE",
    "peak_pressure": "peak_pressure, p_max, maximum pressure, pressure maximum",
}
"""How each quantity may be named; a minus sign marks those that point the other way."""

_HEAD = re.compile(r"^(?P<name>.*?)\s*(?:\[(?P<square>[^\]]*)\]|\((?P<round>.*)\))\s*$")


@dataclass(frozen=True)
class Column:
    """What a column of a file holds: `quantity` = `factor` times its numbers, in SI."""

    header: str
    quantity: str
    factor: float


def _plain(name: str) -> str:
    """Return a name without what people write differently: case, spaces, underlines, TeX."""
    return re.sub(r"[\s_{}$\\^-]", "", name).casefold()


KNOWN = {
    _plain(spelling): quantity
    for quantity, spellings in SPELLINGS.items()
    for spelling in spellings.split(", ")
}
SHOWN = "time, depth (or z_A), normal_force, friction_force, leading_edge, trailing_edge"


def recognise(header: str) -> Column:
    """Return what a column holds.

    Raises
    ------
    ValueError
        Naming the column, what it lacks or which unit is expected, and the nearest known name.

    Examples
    --------
    >>> recognise("z_A [mm]")
    Column(header='z_A [mm]', quantity='depth', factor=-0.001)
    """
    match = _HEAD.match(header.strip())
    name = match["name"] if match else header.strip()
    quantity = KNOWN.get(_plain(name))
    if quantity is None:
        raise ValueError(f'column "{header}": unknown name{_suggestion(name)}')
    sign, quantity = (-1.0, quantity[1:]) if quantity[0] == "-" else (1.0, quantity)
    si = SI_UNITS[quantity]
    unit = "" if match is None else (match["square"] or match["round"] or "").strip()
    if not unit:
        raise ValueError(f'column "{header}": has no unit; expected "{name} [{si}]" or the like')
    try:
        return Column(header, quantity, sign * to_si(f"1 {unit}", si))
    except ValueError as error:
        raise ValueError(f'column "{header}": the unit {error}') from None


def _suggestion(name: str) -> str:
    """Say which known name is nearest, and which there are."""
    spellings = {_plain(s): s for names in SPELLINGS.values() for s in names.split(", ")}
    match = closest(_plain(name), spellings)
    hint = f', did you mean "{spellings[match]}"?' if match else ""
    known = "; ".join(f"{q.lstrip('-')}: {names}" for q, names in SPELLINGS.items())
    return f"{hint}; known names are {known}; remove a column that is something else"
