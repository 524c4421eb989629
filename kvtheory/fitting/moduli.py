"""Moduli as instruments export them: over frequency or time, at one temperature or more."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.fitting.creep import relaxing
from kvtheory.fitting.records import plausible
from kvtheory.fitting.spectrum import Array, Moduli
from kvtheory.scene.columns import SPELLINGS, Reader, Table
from kvtheory.scene.units import ZERO_CELSIUS, in_celsius

NAMES = {
    "frequency": "f, freq, freq., frequency, test frequency, Frequenz, Messfrequenz",
    "angular frequency": "ω, omega, w, angular frequency, ang. frequency, angular freq, "
    "ang. freq., Kreisfrequenz",
    "time": SPELLINGS["time"],
    "temperature": SPELLINGS["temperature"],
    "E'": "E', E_stor, E_storage, E1, tensile storage modulus",
    "G'": "G', G_stor, G_storage, G1, shear storage modulus, shear modulus (elastic component)",
    "storage modulus": "storage modulus, Speichermodul, storage_modulus, stor. modulus",
    "E''": "E'', E_loss, E2, tensile loss modulus",
    "G''": "G'', G_loss, G2, shear loss modulus, shear modulus (viscous component)",
    "loss modulus": "loss modulus, Verlustmodul",
    "|E*|": "|E*|, E*, E_abs, |E|",
    "|G*|": "|G*|, G*, G_abs, |G|, shear modulus (complex component)",
    "complex modulus": "complex modulus, dynamic modulus, komplexer Modul",
    "eta'": "η', eta', dynamic viscosity",
    "eta''": "η'', eta''",
    "|eta*|": "|η*|, η*, |eta*|, eta*, complex viscosity, komplexe Viskosität",
    "tan delta": "tan δ, tan_delta, tan(δ), tan(delta), tan d, tan(d), loss factor, damping factor, "
    "Verlustfaktor, loss tangent, tand",
    "phase": "phase, phase angle, δ, delta, phase shift, loss angle, Phasenwinkel, Verlustwinkel, "
    "phase_angle",
    "E(t)": "E(t), E_relax, E_r",
    "G(t)": "G(t), G_relax, G_r",
    "relaxation modulus": "relaxation modulus, Relaxationsmodul",
    "D(t)": "D(t), tensile creep compliance",
    "J(t)": "J(t), J, shear creep compliance",
    "creep compliance": "creep compliance, compliance, Kriechnachgiebigkeit, Nachgiebigkeit",
}
DYNAMIC = {
    "storage": ("E'", "G'", "storage modulus", "eta''"),
    "loss": ("E''", "G''", "loss modulus", "eta'"),
    "size": ("|E*|", "|G*|", "complex modulus", "|eta*|"),
    "tangent": ("tan delta", "phase"),
}
"""The names of what two of tell the dynamic moduli; a viscosity is a modulus over the angular frequency."""
RELAXING = "E(t)", "G(t)", "relaxation modulus"
CREEPING = "D(t)", "J(t)", "creep compliance"
KINDS = {"D(t)": "E", "J(t)": "G", "storage modulus": None, "loss modulus": None, "complex modulus": None,
         "relaxation modulus": None, "creep compliance": None}  # fmt: skip
"""Whether names mean E or G: by default their letter, and G for a viscosity."""
RADIANS = (
    "rad/s",
    "rad/sec",
    "1/s",
    "s^-1",
    "rad s^-1",
    "rad*s^-1",
    "rad·s⁻¹",
    "rad s⁻¹",
    "rads^-1",
    "rad/S",
)
FREQUENCIES = {
    "frequency": {
        "Hz": 2.0 * math.pi, "hz": 2.0 * math.pi, "HZ": 2.0 * math.pi, "kHz": 2e3 * math.pi,
        "mHz": 2e-3 * math.pi, **dict.fromkeys((each for each in RADIANS if "rad" in each), 1.0),
    },
    "angular frequency": dict.fromkeys(RADIANS, 1.0),
}  # fmt: skip
"""The factor to rad/s of each unit that leaves no doubt."""
DOUBTFUL = "Hz", "1/s", "s^-1"
"""Units that do: of an angular frequency, or of a frequency."""
ANGLES = {**dict.fromkeys(("°", "deg", "degree", "degrees", "Grad"), math.pi / 180.0), "rad": 1.0}
AGREE = 1e-3
"""Relative difference up to which a frequency and an angular frequency of one row are the same."""
DIFFER = 0.1
"""Relative difference from which a column contradicts the others, beyond digits and rounding."""
REPEATED = 0.25
"""Median change of a modulus from table to table from which they are no repetition of one measurement."""
SPREAD, GAP = 2.0, 1.0
"""Largest spread of the temperatures of one sweep, and smallest gap to the next one, in K."""
FEWEST = 4
"""Fewest moduli from which a relaxed modulus and one arm can be found."""


def _parts(found: Any) -> dict[str, list[str]]:
    """Return the names that a table has of each of the four from which dynamic moduli follow."""
    return {
        part: own for part, names in DYNAMIC.items() if (own := [n for n in names if n in found])
    }


def _needed(found: set[str]) -> bool:
    dynamic = found & set(FREQUENCIES) and len(_parts(found)) > 1
    return bool(dynamic or ("time" in found and found & {*RELAXING, *CREEPING}))


READER = Reader(
    NAMES, _needed,
    "a row such as f [Hz],E' [MPa],E'' [MPa], or |G*| and a phase, or t [s],E(t) [MPa], or J(t) [1/MPa]",
    in_head=True,
)  # fmt: skip


class Sweep(NamedTuple):
    """Moduli at one temperature in K, or at an unknown one (NaN)."""

    temperature: float
    moduli: Moduli


class Measured(NamedTuple):
    """The sweeps of a file by temperature; whether moduli are E, G or K (per thickness); notes.

    `scatter` is the relative error that moduli have beside their own scatter, as they were converted from
    the creep compliances at times in `creep`.
    """

    source: str
    sweeps: tuple[Sweep, ...]
    kind: str
    notes: tuple[str, ...]
    scatter: float = 0.0
    creep: tuple[Array, Array] | None = None


def read(data: Any, modulus: str | None = None) -> Measured:
    """Return what a file, or a mapping of arrays, holds; `modulus` is E or G where headers do not say."""
    table = READER.read(data)
    notes = [*table.notes, *(f"Column {head} is not used." for head in table.ignored)]
    dynamic = bool(set(FREQUENCIES) & set(table.columns)) and len(_parts(table)) > 1
    x = _angular_frequency(table) if dynamic else table.si("time", "s")[0]
    name = "time" if not dynamic else _first(table, FREQUENCIES)
    least = np.nextafter(0.0, 1.0) if dynamic else 0.0  # a relaxation may begin at its start
    table.require(
        name, plausible(table, name, x) >= least, "is not above 0" if dynamic else "is negative"
    )
    rows, kind = _dynamic(table, x, modulus, notes) if dynamic else _over_time(table, modulus)
    temperature = np.full(x.size, np.nan)
    if "temperature" in table:
        temperature = plausible(table, "temperature", table.si("temperature", "K")[0])
        table.require("temperature", temperature > 0.0, "is not above absolute zero")
    else:
        _require_one_temperature(table, x, rows[0])
    sweeps, scatter, creep = [], 0.0, None
    creeping = not dynamic and not any(each in table for each in RELAXING)
    for each in _by_temperature(table, temperature):
        own = np.stack([x[each], *(row[each] for row in rows)])
        own = own[:, np.lexsort(own[::-1])]
        own = own[:, np.append(True, (np.diff(own, axis=1) != 0.0).any(axis=0))]
        if own.shape[1] < each.size:
            notes.append(f"{each.size - own.shape[1]} rows occur twice and count once.")
        if own.shape[1] < FEWEST or own[0, 0] == own[0, -1]:
            what, one = "frequencies" if dynamic else "times", len(temperature) == each.size
            where = "" if one else f" at {in_celsius(temperature[each].mean()):.4g} degC"
            message = (
                f"{own.shape[1]} rows{where}; at least {FEWEST} at different {what} are needed"
            )
            raise ValueError(f"{table.source}: holds {message}")
        if creeping:
            creep = own[0].copy(), own[1].copy()
            own[1], off = relaxing(*creep)
            scatter = max(scatter, off)
        sweeps.append(Sweep(float(np.mean(temperature[each])), Moduli(own[0], own[1:])))
    if creeping:
        message = "The creep compliance was converted to a relaxation modulus, by a spectrum of retardation"
        notes.append(f"{message} that fits it to {scatter:.2g} (root mean square, relative).")
    creep = creep if len(sweeps) == 1 else None
    return Measured(table.source, tuple(sweeps), kind, tuple(notes), scatter, creep)


def _require_one_temperature(table: Table, x: Array, modulus: Array) -> None:
    """Raise if tables of one file repeat frequencies with other moduli, so that something else changed."""
    if table.parts is None or table.parts[-1] == 0:
        return
    first = table.parts == 0
    order = np.argsort(x[first], kind="stable")
    at, values = x[first][order], np.log(modulus[first][order])
    for k in range(1, int(table.parts[-1]) + 1):
        own = (table.parts == k) & (x >= at[0] / (1.0 + AGREE)) & (x <= at[-1] * (1.0 + AGREE))
        change = np.abs(np.log(modulus[own]) - np.interp(x[own], at, values))
        if own.any() and np.median(change) > REPEATED:
            what = f"its {int(table.parts[-1]) + 1} tables hold other moduli at the same frequencies or times"
            message = (
                f"{what}, and neither a column nor the head of each table names the temperature"
            )
            raise ValueError(f"{table.source}: {message}; expected a column T [degC]")


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


def _modulus(table: Table, name: str, modulus: str | None, *units: str) -> tuple[Array, str]:
    """Return a column in SI, and whether it is E, G or K."""
    values, unit = table.si(name, *units)
    kind = (
        "K"
        if unit == "N/m^3"
        else KINDS.get(name, "G" if "eta" in name else name.strip("|")[0]) or modulus
    )
    if kind is None:
        message = 'may be E or G; name the column so, or give `modulus` = "E" or "G"'
        raise table.error(name, message)
    if kind != "K" and modulus not in (None, kind):
        raise table.error(name, f'is {kind}, and `modulus` = "{modulus}"')
    return plausible(table, name, values), kind


def _over_time(table: Table, modulus: str | None) -> tuple[list[Array], str]:
    """Return a relaxation modulus, or a creep compliance, in SI, and what it is of."""
    name = _first(table, (*RELAXING, *CREEPING))
    units = ("m^2/N",) if name in CREEPING else ("N/m^2", "N/m^3")
    values, kind = _modulus(table, name, modulus, *units)
    table.require(name, values > 0.0, "is not above 0")
    return [values], kind


def _dynamic(
    table: Table, omega: Array, modulus: str | None, notes: list[str]
) -> tuple[list[Array], str]:
    """Return storage and loss modulus in SI from two of the columns that tell them, and what they are."""
    found, kinds, parts = dict[str, Array](), dict[str, str](), _parts(table)
    for part, names in parts.items():
        name = names[0]
        if part == "tangent":
            found[part] = _tangent(table, name)
        else:
            viscous = "eta" in name
            units = ("N*s/m^2",) if viscous else ("N/m^2", "N/m^3")
            values, kinds[name] = _modulus(table, name, modulus, *units)
            found[part] = values * omega if viscous else values
            least = 0.0 if part == "loss" else np.nextafter(0.0, 1.0)
            table.require(name, values >= least, "is not above 0" if least else "is negative")
    if len(set(kinds.values())) > 1:
        one, other = list(kinds)[:2]
        raise table.error(other, f"is not of the same kind as {one}")
    E, L = _completed(table, parts, found)
    if not L.any():
        last = parts[next(part for part in ("loss", "tangent", "size") if part in parts)][0]
        raise table.error(last, "is zero throughout: without loss there is nothing to fit")
    seen = L > 0.0
    for part, own in (("tangent", L / E), ("size", np.hypot(E, L))):
        if part in found:
            ratio = float(np.median(found[part][seen] / own[seen]))
            if abs(ratio - 1.0) > DIFFER:
                what = (
                    f"{parts['loss'][0]} over {parts['storage'][0]}"
                    if part == "tangent"
                    else "that of the moduli"
                )
                message = f"is {ratio:.3g} times {what} (median of the rows)"
                name = parts[part][0]
                raise table.error(name, f"{message}; leave out the column that is wrong")
            if "storage" in found and "loss" in found:
                notes.append(f"The loss modulus is used, and not {parts[part][0]}.")
    return [E, L], next(iter(kinds.values()))


def _completed(table: Table, parts: Any, found: dict[str, Array]) -> tuple[Array, Array]:
    """Return storage and loss modulus from two of storage, loss, size and tangent."""
    values: list[Any] = [found.get(part) for part in DYNAMIC]
    E, L, size, tangent = values
    if E is not None and L is not None:
        return E, L
    if tangent is not None:
        if E is None and size is None:
            table.require(parts["tangent"][0], tangent > 0.0, "is not above 0")
            return L / tangent, np.asarray(L)
        E = size / np.hypot(1.0, tangent) if E is None else E
        return E, E * tangent if L is None else L
    own = E if L is None else L  # beside the size
    table.require(parts["size"][0], size > own, "is not above the modulus beside it")
    rest = np.sqrt(size**2 - own**2)
    return (own, rest) if L is None else (rest, L)


def _tangent(table: Table, name: str) -> Array:
    """Return tan delta of a column of it, or of a phase."""
    if name == "phase":
        column = table.columns[name]
        if column.unit not in ANGLES:
            what = f'has the unit "{column.unit}"' if column.unit else "has no unit"
            raise table.error(name, f"{what}; expected deg or rad")
        phase = plausible(table, name, column.values) * ANGLES[column.unit]
        table.require(
            name, (phase >= 0.0) & (phase < 0.5 * math.pi), "is not from 0 to below 90 degrees"
        )
        return np.asarray(np.tan(phase))
    loss = plausible(table, name, table.number(name))
    table.require(name, loss >= 0.0, "is negative")
    return loss


def _by_temperature(table: Table, temperature: Array) -> list[NDArray[np.int_]]:
    """Return the rows of each sweep: temperatures closer than `GAP` belong together."""
    order = np.argsort(temperature, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(temperature[order]) > GAP) + 1)
    for part in parts:
        low, high = temperature[part[0]] - ZERO_CELSIUS, temperature[part[-1]] - ZERO_CELSIUS
        if high - low > SPREAD:
            message = (
                f"drifts from {low:.4g} to {high:.4g} degC without a gap of {GAP:g} K; expected sweeps "
                f"at temperatures constant to {SPREAD:g} K"
            )
            raise table.error("temperature", message)
    return parts
