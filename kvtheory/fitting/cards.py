"""Prony series as cards of Abaqus (.inp) and ANSYS (.mac): moduli relative to the instantaneous one.

Both give E_0 = E + sum E_i, Poisson's ratio, and pairs g_i = E_i/E_0 and relaxation time; so E = E_0
(1 - sum g_i). A Poisson's ratio that does not change in time means equal g_i for shear and for bulk. WLF's
law is *TRS in Abaqus and TB,SHIFT in ANSYS: reference temperature, C_1, C_2; ANSYS multiplies times by A =
1/a_T, with log10 A = C_1 (T - T_ref)/(C_2 + T - T_ref). Other laws are left out, and the card says so. Cards
have no units: a comment names them.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from kvtheory.fitting.spectrum import Series
from kvtheory.scene.mistakes import shown
from kvtheory.scene.tables import read_text
from kvtheory.scene.units import ZERO_CELSIUS, to_si

SUFFIXES = ".inp", ".mac"
UNITS = re.compile(
    r"\bunits?\b\W*(?P<modulus>[kMG]?Pa|N/mm\^?2)\W+(?P<time>ms|s|min|h)\b"
    r"(?:\W+(?P<temperature>deg ?C|C|K)\b)?", re.IGNORECASE
)  # fmt: skip
EXPECTED = 'expected a comment such as "units: MPa, s'
PER_LINE = 3
"""Pairs in a line of TBDATA."""


class Card(NamedTuple):
    """What stands in a card; `relaxed` tells whether the modulus is the relaxed one."""

    E: float
    relaxed: bool
    poisson_ratio: float
    shear: list[list[float]]
    bulk: list[list[float]]
    law: str
    constants: list[float]


class Thermal(NamedTuple):
    """WLF's constants, and the reference temperature in K."""

    constants: tuple[float, float]
    reference: float


def read(path: Path) -> tuple[Series, float, Thermal | None, list[str]]:
    """Return the series of a card (Pa, s), Poisson's ratio, WLF's law, and notes; or raise ValueError."""
    lines = [line.strip() for line in read_text(path).splitlines()]
    units = next((found for line in lines if (found := UNITS.search(line))), None)
    if units is None:
        raise ValueError(f'{path}: {EXPECTED}", as cards have none')
    abaqus = path.suffix.lower() == SUFFIXES[0]
    try:
        card = (_abaqus if abaqus else _ansys)(lines)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    g, time = np.array(card.shear).T
    if not ((g > 0.0).all() and g.sum() < 1.0 and (time > 0.0).all() and card.E > 0.0):
        message = (
            "expected relative moduli above 0, of a sum below 1, and times and modulus above 0"
        )
        raise ValueError(f"{path}: {message}")
    notes, thermal = [], None
    if card.bulk and not np.allclose([pair[0] for pair in card.bulk], g, rtol=1e-3):
        notes.append(
            "The bulk modulus of the card relaxes otherwise than the shear modulus that is used."
        )
    if card.law == "WLF":
        if len(card.constants) != 3:
            raise ValueError(f"{path}: WLF's law: expected reference temperature, C_1 and C_2")
        if not units["temperature"]:
            raise ValueError(f'{path}: {EXPECTED}, degC", as the card has a reference temperature')
        unit = "K" if units["temperature"].upper() == "K" else "degC"
        T, *constants = card.constants
        thermal = Thermal((constants[0], constants[1]), to_si(f"{T} {unit}", "K"))
    elif card.law:
        notes.append(
            f"The law of temperature of the card, {card.law}, is not used: only WLF's is read. "
            "The arms hold at the reference temperature of the card."
        )
    scale, second = to_si(f"1 {units['modulus']}", "N/m^2"), to_si(f"1 {units['time']}", "s")
    instant = card.E * scale / (1.0 - g.sum() if card.relaxed else 1.0)
    order = np.argsort(time)
    relaxed = instant * (1.0 - float(g.sum()))
    series = Series(relaxed, instant * g[order], time[order] * second)
    return series, card.poisson_ratio, thermal, notes


def _floats(k: int, line: str, cells: Iterable[str]) -> list[float]:
    """Return the numbers in cells of a line; empty ones are left out."""
    try:
        return [float(cell) for cell in cells if cell.strip()]
    except ValueError:
        raise ValueError(f'line {k + 1}, "{shown(line)}": expected numbers') from None


def _abaqus(lines: list[str]) -> Card:
    rows: dict[str, list[list[float]]] = {"ELASTIC": [], "VISCOELASTIC": [], "TRS": []}
    options, keyword, law = dict.fromkeys(rows, ""), "", ""
    for k, line in enumerate(lines):
        if line.startswith("*"):
            name, _, rest = line[1:].upper().replace(" ", "").partition(",")
            if not line.startswith("**"):
                keyword = name
                options |= {keyword: rest}
                definition = re.search(r"DEFINITION=(\w+)", rest)
                law = (definition[1] if definition else "WLF") if keyword == "TRS" else law
        elif line and keyword in rows and (keyword != "TRS" or law == "WLF"):
            rows[keyword].append(_floats(k, line, line.split(",")))
    elastic, pairs = rows["ELASTIC"], rows["VISCOELASTIC"]
    if [len(row) for row in elastic] != [2] or "TIME=PRONY" not in options["VISCOELASTIC"]:
        message = "expected *ELASTIC with a row of E and nu, and *VISCOELASTIC, TIME=PRONY"
        raise ValueError(f"{message} with rows of g, k and tau")
    if not pairs or any(len(row) not in (2, 3) for row in pairs):
        raise ValueError("*VISCOELASTIC: expected rows of g, k and tau")
    return Card(
        elastic[0][0], "INSTANTANEOUS" not in options["ELASTIC"], elastic[0][1],
        [[row[0], row[-1]] for row in pairs], [row[1:] for row in pairs if len(row) > 2],
        law, [value for row in rows["TRS"] for value in row],
    )  # fmt: skip


def _ansys(lines: list[str]) -> Card:
    elastic: dict[str, list[float]] = {}
    tables: dict[str, list[float]] = {}
    which = law = ""
    for k, line in enumerate(lines):
        cells = [cell.strip().upper() for cell in line.partition("!")[0].split(",")]
        command, name, *rest = [*cells, *[""] * 6]
        if command in ("MP", "MPDATA"):
            elastic[name] = _floats(k, line, rest[1 if command == "MP" else 2 :])
        elif command == "TB":
            which = {"PRONY": rest[3], "SHIFT": name}.get(name, "")
            law = (rest[3] or "WLF") if which == "SHIFT" else law
        elif command == "TBDATA" and which and (which != "SHIFT" or law == "WLF"):
            tables.setdefault(which, []).extend(_floats(k, line, rest))
    nu = elastic.get("NUXY", elastic.get("PRXY"))
    if not elastic.get("EX") or not nu or "SHEAR" not in tables:
        raise ValueError("expected MP,EX, MP,NUXY and TB,PRONY,,,,SHEAR with TBDATA")
    if any(len(elastic[name]) > 1 for name in elastic):
        raise ValueError("MP: expected a modulus and a Poisson's ratio that do not vary")
    shear, bulk = (np.array(tables.get(name, [])) for name in ("SHEAR", "BULK"))
    if shear.size % 2 or bulk.size % 2:
        raise ValueError("TB,PRONY: expected pairs of a relative modulus and a time")
    pairs = [each.reshape(-1, 2).tolist() for each in (shear, bulk)]
    return Card(elastic["EX"][0], False, nu[0], pairs[0], pairs[1], law, tables.get("SHIFT", []))


def written(
    suffix: str, relaxed: float, arms: Sequence[tuple[float, float]], poisson_ratio: float, source: str,
    thermal: Thermal | None = None, left_out: str = "",
) -> str:  # fmt: skip
    """Return the card of a series, in Pa and s, with WLF's law or a comment on the law that is left out."""
    instant = relaxed + sum(E for E, _ in arms)
    pairs = [(f"{E / instant:.9g}", f"{tau:.9g}") for E, tau in arms]
    mark = "**" if suffix == SUFFIXES[0] else "!"
    head = [f"{mark} Prony series fitted to {source}; units: Pa, s, degC"]
    head += [f"{mark} {left_out}"] if left_out else []
    row = (thermal.reference - ZERO_CELSIUS, *thermal.constants) if thermal else ()
    wlf = ", ".join(f"{each:.9g}" for each in row)
    if suffix == SUFFIXES[0]:
        rows = [f"{g}, {g}, {tau}" for g, tau in pairs]
        lines = [
            *head, "*MATERIAL, NAME=FITTED",
            "*ELASTIC, MODULI=INSTANTANEOUS", f"{instant:.9g}, {poisson_ratio:.9g}",
            "*VISCOELASTIC, TIME=PRONY", *rows, *(("*TRS, DEFINITION=WLF", wlf) if wlf else ()),
        ]  # fmt: skip
        return "\n".join([*lines, ""])
    lines = [*head, f"MP,EX,1,{instant:.9g}", f"MP,NUXY,1,{poisson_ratio:.9g}"]
    for which in ("SHEAR", "BULK"):
        lines.append(f"TB,PRONY,1,1,{len(pairs)},{which}")
        for first in range(0, len(pairs), PER_LINE):
            own = ",".join(f"{g},{tau}" for g, tau in pairs[first : first + PER_LINE])
            lines.append(f"TBDATA,{2 * first + 1},{own}")
    lines += ["TB,SHIFT,1,1,3,WLF", f"TBDATA,1,{wlf.replace(' ', '')}"] if wlf else []
    return "\n".join([*lines, ""])
