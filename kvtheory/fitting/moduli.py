"""Moduli as instruments export them: over frequency or time, at one temperature or more."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.fitting.records import plausible
from kvtheory.fitting.spectrum import Array, Moduli
from kvtheory.scene.columns import SPELLINGS, Reader, Table

NAMES = {
    "frequency": "f, freq, frequency, Frequenz",
    "angular frequency": "ω, omega, w, angular frequency, ang. frequency, Kreisfrequenz",
    "time": SPELLINGS["time"],
    "temperature": SPELLINGS["temperature"],
    "E'": "E', E_stor, E_storage, E1, tensile storage modulus",
    "G'": "G', G_stor, G_storage, G1, shear storage modulus",
    "storage modulus": "storage modulus, Speichermodul, storage_modulus",
    "E''": "E'', E_loss, E2, tensile loss modulus",
    "G''": "G'', G_loss, G2, shear loss modulus",
    "loss modulus": "loss modulus, Verlustmodul",
    "tan delta": "tan δ, tan_delta, tan(δ), tan(delta), tan d, tan(d), loss factor, damping factor, "
    "Verlustfaktor, tan delta",
    "E(t)": "E(t), E_relax, E_r",
    "G(t)": "G(t), G_relax, G_r",
    "relaxation modulus": "relaxation modulus, Relaxationsmodul",
}
STORAGE = "E'", "G'", "storage modulus"
LOSS = "E''", "G''", "loss modulus"
RELAXING = "E(t)", "G(t)", "relaxation modulus"
FREQUENCIES = {
    "frequency": {"Hz": 2.0 * math.pi, "kHz": 2e3 * math.pi, "mHz": 2e-3 * math.pi, "rad/s": 1.0},
    "angular frequency": {"rad/s": 1.0, "1/s": 1.0, "s^-1": 1.0, "rad s^-1": 1.0, "rad*s^-1": 1.0},
}
"""The factor to rad/s of each unit that leaves no doubt."""
DOUBTFUL = "Hz", "1/s", "s^-1"
"""Units that do: of an angular frequency, or of a frequency."""
AGREE = 1e-3
"""Relative difference up to which a frequency and an angular frequency of one row are the same."""
DIFFER = 0.1
"""Relative difference from which a tan delta contradicts both moduli, beyond digits and rounding."""
SPREAD, GAP = 2.0, 1.0
"""Largest spread of the temperatures of one sweep, and smallest gap to the next one, in K."""
FEWEST = 4
"""Fewest moduli from which a relaxed modulus and one arm can be found."""


def _needed(found: set[str]) -> bool:
    dynamic = found & set(FREQUENCIES) and found & set(STORAGE) and found & {*LOSS, "tan delta"}
    return bool(dynamic or ("time" in found and found & set(RELAXING)))


READER = Reader(NAMES, _needed, "a row such as f [Hz],E' [MPa],E'' [MPa] or t [s],E(t) [MPa]")


class Sweep(NamedTuple):
    """Moduli at one temperature in K, or at an unknown one (NaN)."""

    temperature: float
    moduli: Moduli


class Measured(NamedTuple):
    """The sweeps of a file by temperature; whether moduli are E, G or K (per thickness); notes."""

    source: str
    sweeps: tuple[Sweep, ...]
    kind: str
    notes: tuple[str, ...]


def read(data: Any, modulus: str | None = None) -> Measured:
    """Return what a file, or a mapping of arrays, holds; `modulus` is E or G where headers do not say."""
    table = READER.read(data)
    notes = [f"Column {head} is not used." for head in table.ignored]
    dynamic = bool(set(FREQUENCIES) & set(table.columns))
    x = _angular_frequency(table) if dynamic else table.si("time", "s")[0]
    name = "time" if not dynamic else _first(table, FREQUENCIES)
    table.require(name, plausible(table, name, x) > 0.0, "is not above 0")
    rows, kind = _rows(table, dynamic, modulus)
    if "tan delta" in table and any(each in table for each in LOSS):
        notes.append("The loss modulus is used, and not tan delta.")
    temperature = np.full(x.size, np.nan)
    if "temperature" in table:
        temperature = plausible(table, "temperature", table.si("temperature", "K")[0])
        table.require("temperature", temperature > 0.0, "is not above absolute zero")
    sweeps = []
    for each in _by_temperature(table, temperature):
        own = np.stack([x[each], *(row[each] for row in rows)])
        own = own[:, np.lexsort(own[::-1])]
        own = own[:, np.append(True, (np.diff(own, axis=1) != 0.0).any(axis=0))]
        if own.shape[1] < each.size:
            notes.append(f"{each.size - own.shape[1]} rows occur twice and count once.")
        if own.shape[1] < FEWEST or own[0, 0] == own[0, -1]:
            what, one = "frequencies" if dynamic else "times", len(temperature) == each.size
            where = "" if one else f" at {temperature[each].mean() - 273.15:.4g} degC"
            message = (
                f"{own.shape[1]} rows{where}; at least {FEWEST} at different {what} are needed"
            )
            raise ValueError(f"{table.source}: holds {message}")
        sweeps.append(Sweep(float(np.mean(temperature[each])), Moduli(own[0], own[1:])))
    return Measured(table.source, tuple(sweeps), kind, tuple(notes))


def _first(table: Table, names: Any) -> str:
    return next(name for name in names if name in table)


def _angular_frequency(table: Table) -> Array:
    found = []
    for name, units in FREQUENCIES.items():
        if name in table:
            column = table.columns[name]
            if column.unit not in units:
                what = f'has the unit "{column.unit}"' if column.unit else "has no unit"
                what += ", which may mean Hz or rad/s" if column.unit in DOUBTFUL else ""
                raise table.error(name, f"{what}; expected {' or '.join(units)}")
            found.append(column.values * units[column.unit])
    if len(found) == 2:
        same = np.abs(found[0] - found[1]) <= AGREE * np.abs(found[1])
        table.require("frequency", same, "is not the angular frequency of its row over 2 pi")
    return found[0]


def _rows(table: Table, dynamic: bool, modulus: str | None) -> tuple[list[Array], str]:
    """Return the moduli in SI, and what they are."""
    names = [_first(table, STORAGE if dynamic else RELAXING)]
    if dynamic and any(each in table for each in LOSS):
        names.append(_first(table, LOSS))
    rows, kinds = [], set()
    for name in names:
        values, unit = table.si(name, "N/m^2", "N/m^3")
        kind = "K" if unit == "N/m^3" else name[0] if name[0] in "EG" else modulus
        if kind is None:
            message = 'may be E or G; name the column so, or give `modulus` = "E" or "G"'
            raise table.error(name, message)
        if kind != "K" and modulus not in (None, kind):
            raise table.error(name, f'is {kind}, and `modulus` = "{modulus}"')
        kinds.add(kind)
        least = 0.0 if name in LOSS else np.nextafter(0.0, 1.0)
        table.require(name, values >= least, "is negative" if least == 0.0 else "is not above 0")
        rows.append(plausible(table, name, values))
    if len(kinds) > 1:
        raise table.error(names[1], f"is not of the same kind as {names[0]}")
    if dynamic and "tan delta" in table:
        loss = plausible(table, "tan delta", table.number("tan delta"))
        table.require("tan delta", loss >= 0.0, "is negative")
        rows.append(rows[0] * loss)
    if dynamic and not rows[1].any():
        raise table.error(names[-1], "is zero throughout: without loss there is nothing to fit")
    if len(rows) > 2:
        seen = rows[1] > 0.0
        ratio = float(np.median(rows[2][seen] / rows[1][seen]))
        if abs(ratio - 1.0) > DIFFER:
            several = f"is {ratio:.3g} times {names[1]} over {names[0]} (median of the rows)"
            raise table.error("tan delta", f"{several}; leave out the column that is wrong")
        del rows[2]
    return rows, kinds.pop()


def _by_temperature(table: Table, temperature: Array) -> list[NDArray[np.int_]]:
    """Return the rows of each sweep: temperatures closer than `GAP` belong together."""
    order = np.argsort(temperature, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(temperature[order]) > GAP) + 1)
    for part in parts:
        low, high = temperature[part[0]] - 273.15, temperature[part[-1]] - 273.15
        if high - low > SPREAD:
            message = (
                f"drifts from {low:.4g} to {high:.4g} degC without a gap of {GAP:g} K; expected sweeps "
                f"at temperatures constant to {SPREAD:g} K"
            )
            raise table.error("temperature", message)
    return parts
