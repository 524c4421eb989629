"""Prony series as cards of Abaqus (.inp) and ANSYS (.mac): moduli relative to the instantaneous one.

Both give E_0 = E + sum E_i, Poisson's ratio, and pairs g_i = E_i/E_0 and relaxation time; so E = E_0
(1 - sum g_i). A Poisson's ratio that does not change in time means equal g_i for shear and for bulk. Cards
have no units: a comment names them.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from kvtheory.fitting.spectrum import Series
from kvtheory.scene.tables import read_text
from kvtheory.scene.units import to_si

SUFFIXES = ".inp", ".mac"
UNITS = re.compile(
    r"\bunits?\b\W*(?P<modulus>[kMG]?Pa|N/mm\^?2)\W+(?P<time>ms|s|min|h)\b", re.IGNORECASE
)
EXPECTED = 'expected a comment such as "units: MPa, s", as cards have none'
PER_LINE = 3
"""Pairs in a line of TBDATA."""


def read(path: Path) -> tuple[Series, float, list[str]]:
    """Return the series of a card (Pa, s), Poisson's ratio, and notes; or raise ValueError."""
    lines = [line.strip() for line in read_text(path).splitlines()]
    units = next((found for line in lines if (found := UNITS.search(line))), None)
    if units is None:
        raise ValueError(f"{path}: {EXPECTED}")
    abaqus = path.suffix.lower() == SUFFIXES[0]
    E, nu, relaxed, shear, bulk = (_abaqus if abaqus else _ansys)(path, lines)
    g, time = np.array(shear).T
    if not (g > 0.0).all() or g.sum() >= 1.0 or not (time > 0.0).all() or not E > 0.0:
        message = (
            "expected relative moduli above 0 with a sum below 1, and times and modulus above 0"
        )
        raise ValueError(f"{path}: {message}")
    notes = []
    if bulk and not np.allclose(np.array(bulk)[:, 0], g, rtol=1e-3):
        notes.append(
            "The bulk modulus of the card relaxes otherwise than the shear modulus, which is used."
        )
    scale, second = to_si(f"1 {units['modulus']}", "N/m^2"), to_si(f"1 {units['time']}", "s")
    instant = E * scale / (1.0 - g.sum() if relaxed else 1.0)
    order = np.argsort(time)
    series = Series(instant * (1.0 - float(g.sum())), instant * g[order], time[order] * second)
    return series, nu, notes


Card = tuple[float, float, bool, list[list[float]], list[list[float]]]
"""Modulus, Poisson's ratio, whether the modulus is the relaxed one, pairs of shear and of bulk."""


def _abaqus(path: Path, lines: list[str]) -> Card:
    rows: dict[str, list[list[float]]] = {}
    keyword, words = "", ""
    for line in lines:
        if line.startswith("*"):
            keyword = "" if line.startswith("**") else line[1:].split(",")[0].strip().upper()
            words += f" {line.upper()}" if keyword in ("ELASTIC", "VISCOELASTIC") else ""
        elif line and keyword in ("ELASTIC", "VISCOELASTIC"):
            rows.setdefault(keyword, []).append(
                [float(cell) for cell in line.split(",") if cell.strip()]
            )
    if set(rows) != {"ELASTIC", "VISCOELASTIC"} or not re.search(r"TIME\s*=\s*PRONY", words):
        raise ValueError(f"{path}: expected *ELASTIC with E and nu, and *VISCOELASTIC, TIME=PRONY")
    pairs = [[row[0], row[-1]] for row in rows["VISCOELASTIC"]]
    bulk = [[row[1], row[-1]] for row in rows["VISCOELASTIC"] if len(row) > 2]
    E, nu = rows["ELASTIC"][0][:2]
    return E, nu, "INSTANTANEOUS" not in words, pairs, bulk


def _ansys(path: Path, lines: list[str]) -> Card:
    elastic: dict[str, float] = {}
    tables: dict[str, list[float]] = {}
    which = ""
    for line in lines:
        cells = [cell.strip() for cell in line.partition("!")[0].split(",")]
        command = cells[0].upper()
        if command == "MP" and len(cells) > 3:
            elastic[cells[1].upper()] = float(cells[3])
        elif command == "TB":
            which = cells[5].upper() if cells[1].upper() == "PRONY" and len(cells) > 5 else ""
        elif command == "TBDATA" and which:
            tables.setdefault(which, []).extend(float(cell) for cell in cells[2:] if cell)
    nu = elastic.get("NUXY", elastic.get("PRXY"))
    if "EX" not in elastic or nu is None or "SHEAR" not in tables:
        raise ValueError(f"{path}: expected MP,EX, MP,NUXY and TB,PRONY,,,,SHEAR with TBDATA")
    shear, bulk = ([list(pair) for pair in zip(t[::2], t[1::2], strict=True)]
                   for t in (tables["SHEAR"], tables.get("BULK", [])))  # fmt: skip
    return elastic["EX"], nu, False, shear, bulk


def written(
    suffix: str,
    relaxed: float,
    arms: Sequence[tuple[float, float]],
    poisson_ratio: float,
    source: str,
) -> str:
    """Return the card of a series, in Pa and s."""
    instant = relaxed + sum(E for E, _ in arms)
    pairs = [(f"{E / instant:.9g}", f"{tau:.9g}") for E, tau in arms]
    if suffix == SUFFIXES[0]:
        rows = [f"{g}, {g}, {tau}" for g, tau in pairs]
        lines = [
            f"** Prony series fitted to {source}; units: Pa, s", "*MATERIAL, NAME=FITTED",
            "*ELASTIC, MODULI=INSTANTANEOUS", f"{instant:.9g}, {poisson_ratio:.9g}",
            "*VISCOELASTIC, TIME=PRONY", *rows,
        ]  # fmt: skip
        return "\n".join([*lines, ""])
    lines = [f"! Prony series fitted to {source}; units: Pa, s",
             f"MP,EX,1,{instant:.9g}", f"MP,NUXY,1,{poisson_ratio:.9g}"]  # fmt: skip
    for which in ("SHEAR", "BULK"):
        lines.append(f"TB,PRONY,1,1,{len(pairs)},{which}")
        for first in range(0, len(pairs), PER_LINE):
            own = ",".join(f"{g},{tau}" for g, tau in pairs[first : first + PER_LINE])
            lines.append(f"TBDATA,{2 * first + 1},{own}")
    return "\n".join([*lines, ""])
