"""Quantities with units at the edge of the package: text or pint quantities in, SI floats out.

Numbers are read as exact fractions and rounded once, so ``"5 µm"`` is 5e-06 to the last bit. pint
is imported only for a unit that is not among the usual ones.
"""

import difflib
import json
import math
import re
from decimal import Decimal
from fractions import Fraction
from functools import cache, lru_cache, partial
from numbers import Real
from typing import Any

import numpy as np

EXAMPLES = {
    "m": ("10 mm", "300 µm", "0.01 m"),
    "s": ("100 ms", "0.1 s", "5 min"),
    "m/s": ("100 mm/s", "0.1 m/s", "1 km/h"),
    "m/s^2": ("9.80665 m/s^2", "1620 mm/s^2"),
    "kg": ("1 kg", "300 g"),
    "N": ("3 N", "9.8 kN"),
    "kg/m": ("1 kg/mm", "1000 kg/m", "10 g/mm"),
    "N/m": ("10 N/mm", "9.8 kN/m"),
    "N/m^2": ("30 MN/m^2", "30 MPa", "30 N/mm^2"),
    "N*s/m": ("100 N*s/m", "0.1 kN*s/m"),
    "N*s/m^2": ("100 N*s/m^2", "0.1 kN*s/m^2", "100 Pa*s"),
    "1/s": ("5 Hz", "300 /min", "5 s^-1"),
    "1/m": ("200 /mm", "200 mm^-1", "2e5 /m"),
    "m^2/N": ("1 /MPa", "1e-6 /Pa", "1 m^2/MN"),
    "N/m^3": ("10 GN/m^3", "10 N/mm^3", "10 MPa/mm"),
    "N*s/m^3": ("0.5 GN*s/m^3", "0.5 N*s/mm^3", "0.5 MPa*s/mm"),
    "K": ("23 degC", "296.15 K", "73.4 degF"),
    "delta K": ("51.6 K", "51.6 delta_degC"),
    "J/mol": ("80 kJ/mol", "8e4 J/mol"),
}
"""Ways to write a quantity of each SI unit that a scene uses; messages show the first one. Differences of
temperatures have the unit "delta K": "20 degC" is not a difference."""

WHOLE = {"kg/m": "kg", "N/m": "N", "N/m^2": "N/m", "N*s/m^2": "N*s/m", "J/m": "J"}
"""For each unit of a quantity per unit width, the unit of the total quantity of a ball."""

FREQUENCY = "1/s"
"""The unit of a frequency, in cycles per second; an angle over time is read as well."""

_METRES = {"km": 3, "m": 0, "cm": -2, "mm": -3, "um": -6, "µm": -6, "μm": -6, "nm": -9}
_SECONDS = {"s": 0, "ms": -3, "us": -6, "µs": -6, "μs": -6}
_NEWTONS = {"GN": 9, "MN": 6, "kN": 3, "N": 0, "mN": -3}
_KILOGRAMS = {"kg": 0, "g": -3}
_PASCALS = {"GPa": 9, "MPa": 6, "kPa": 3, "Pa": 0}


def _ratios(above: dict[str, int], below: dict[str, int], power: int) -> dict[str, int]:
    written = f"^{power}" if power > 1 else ""
    return {
        f"{upper}/{lower}{written}": m - power * n
        for upper, m in above.items()
        for lower, n in below.items()
    }


USUAL = {
    "m": _METRES,
    "s": _SECONDS,
    "m/s": _ratios(_METRES, _SECONDS, 1),
    "m/s^2": _ratios(_METRES, _SECONDS, 2),
    "kg": _KILOGRAMS,
    "N": _NEWTONS,
    "kg/m": _ratios(_KILOGRAMS, _METRES, 1),
    "N/m": _ratios(_NEWTONS, _METRES, 1),
    "N/m^2": _ratios(_NEWTONS, _METRES, 2) | _PASCALS,
    "N/m^3": _ratios(_NEWTONS, _METRES, 3),
    "1/m": _ratios({"": 0}, _METRES, 1),
    "delta K": dict.fromkeys(("K", "kelvin", "delta_degC", "delta_degree_Celsius"), 0),
    "J/mol": {"J/mol": 0, "kJ/mol": 3},
}
"""Usual ways to write each unit, and their powers of ten: importing pint takes longer than a computation."""

_FAHRENHEIT = Fraction(5, 9), Fraction(45967, 180)
ZERO_CELSIUS = 273.15
"""In K."""
_CELSIUS = Fraction(1), Fraction(27315, 100)
TEMPERATURES = (
    dict.fromkeys(("K", "kelvin"), (Fraction(1), Fraction(0)))
    | dict.fromkeys(("degC", "°C", "℃", "celsius", "degree_Celsius"), _CELSIUS)
    | dict.fromkeys(("degF", "°F", "℉", "fahrenheit", "degree_Fahrenheit"), _FAHRENHEIT)
)
"""Scales of temperature: the size of a degree in K, and the zero of the scale in K."""


def celsius(T: float) -> str:
    """Return a temperature in K as text in degrees Celsius, without the rounding of its difference.

    >>> celsius(273.15 - 1e-13), celsius(298.1812)
    ('0', '25.03')
    """
    return f"{round(T - ZERO_CELSIUS, 6) + 0.0:.4g}"


LONGEST_UNIT = 60
_NUMBER = re.compile(
    r"[+-]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?|inf(?:inity)?|nan)(?![0-9.])", re.I
)
# One exponent digit and no nested powers: "mm^9^9^9" would take too long to evaluate.
_UNIT = re.compile(r"(?:[a-zµμ_ ]|[*/()]|(?:\^|\*\*)-?[0-9](?![0-9^*])|[²³])+", re.I)


def to_si(value: Any, unit: str) -> float:
    """Return text with a unit, a pint quantity, or a plain number in SI already, as a float in an SI unit.

    `unit` is a key of `EXAMPLES`, or ``"1"`` for a dimensionless number. It raises ValueError if the text
    cannot be read or has the wrong dimension; the message says what is expected.

    >>> to_si("5 µm", "m"), to_si("10 GN/m^3", "N/m^3")
    (5e-06, 10000000000.0)
    """
    if isinstance(value, str):
        if "," in value:
            message = "write the decimal mark as a point, and no thousands separator"
            if all(re.search(r"\d\s*[^\W\d]", each) for each in value.split(",")):
                message = "is not one value; several are a list: " + json.dumps(
                    re.split(r"\s*,\s*", value.strip())
                )
            raise ValueError(f"{message}; expected {expected(unit)}")
        text = value.strip()
        digits = _NUMBER.match(text)
        if digits is None:
            raise ValueError(f"is not a number followed by a unit; expected {expected(unit)}")
        return _scaled(digits.group(), text[digits.end() :].strip(), unit)
    value, written = bare(value)
    if getattr(value, "shape", None) == ():  # a NumPy scalar
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real | Decimal):
        raise ValueError(f"expected {expected(unit)}")
    try:
        number = float(value)
    except (OverflowError, TypeError, ValueError):
        raise ValueError(f"expected {expected(unit)}") from None
    return number if written is None else _scaled(number, written, unit)


def bare(value: Any) -> tuple[Any, str | None]:
    """Return a number or an array (as one of NumPy) without its unit, and the unit or None.

    The unit is that of pint, or the attribute ``units`` of xarray and pandas; masked values raise ValueError.
    """
    written = None
    if type(value) in (float, int):
        return value, None
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        value, written = value.magnitude, f"{value.units:C}".replace("dimensionless", "")
    elif isinstance(attributes := getattr(value, "attrs", None), dict):
        units = attributes.get("units")
        written = ("" if units == "1" else units) if isinstance(units, str) else None
    parts = value if isinstance(value, list) else [value]
    # As `numpy.ma.getmask` does, without its import, which takes 5 ms.
    if masked := int(sum(np.count_nonzero(getattr(part, "_mask", False)) for part in parts)):
        raise ValueError(
            f"has {masked} masked value{'s' * (masked > 1)}; leave masked values out "
            "(`.compressed()`), or fill them (`.filled()`)"
        )
    if hasattr(value, "__array__") and not isinstance(value, type):
        try:
            value = np.asarray(value)
        except Exception:  # whatever its library raises
            raise ValueError(f"a {type(value).__name__} is no array of numbers") from None
        if value.dtype.kind == "m":
            value, written = value / np.timedelta64(1, "s"), "s"
    return value, written


def is_usual(value: Any, unit: str) -> bool:
    """Whether a text is a number with a usual unit of this dimension, for which pint is not needed."""
    text = value.strip() if isinstance(value, str) else ""
    number = _NUMBER.match(text)
    return number is not None and text[number.end() :].strip() in USUAL.get(unit, ())


def expected(unit: str) -> str:
    """Return how a quantity of `unit` is written, in words and with an example."""
    if unit == "1":
        return "a dimensionless number"
    if unit == "delta K":
        return f'a difference of temperatures in K, such as "{EXAMPLES[unit][0]}"'
    return f'a quantity in {unit}, such as "{EXAMPLES[unit][0]}"'


def _scaled(number: str | float, written: str, unit: str) -> float:
    """Multiply `number` by the unit as `written`; both exactly, then round."""
    approximate = float(number)
    if not math.isfinite(approximate):
        return approximate
    if unit == "1":
        if written:
            raise ValueError(f'has the unit "{written}"; expected {expected(unit)}')
        return approximate
    if not written:
        raise ValueError(f"has no unit; expected {expected(unit)}")
    if unit == "K" and written in TEMPERATURES:
        degree, zero = TEMPERATURES[written]
        usual = 1e-9 < abs(approximate) < 1e9  # beyond, a power of ten would be huge
        return float(Fraction(number if usual else approximate) * degree + zero)
    factor = _factor(written, unit)
    # A value that underflows is zero, before a huge power of ten is formed.
    exact = Fraction(number) * factor if approximate else Fraction(0)
    try:
        return float(exact)
    except OverflowError:
        return math.copysign(math.inf, approximate)


@lru_cache(maxsize=1024)
def _factor(written: str, unit: str) -> Fraction:
    if written in USUAL.get(unit, ()):
        return Fraction(10) ** USUAL[unit][written]
    # The usual ways to write a power: mm3, s-1, m ^ 3, N·m.
    written = re.sub(r"\s*(\^|\*\*)\s*", "^", written.replace("·", "*"))
    written = re.sub(r"(?<=[^\W\d_])(?=-?[0-9])", "^", written)
    written = re.sub(r"^(1\s*)?/", "dimensionless/", written)
    if len(written) > LONGEST_UNIT or not _UNIT.fullmatch(written):
        raise ValueError(f'"{written}" is not a unit; expected {expected(unit)}')
    if unit == "delta K" and TEMPERATURES.get(written, (1, 0))[1]:  # a scale with another zero
        message = f'"{written}" is the unit of a temperature, not of a difference'
        raise ValueError(f"{message}; expected {expected(unit)}")
    try:
        factor, angle = _in_root_units(written, unit.removeprefix("delta "))
    except Exception:  # pint raises many kinds, not all of them documented
        known = {example.split(" ", 1)[1].lower(): example for example in EXAMPLES[unit]}
        near = difflib.get_close_matches(written.lower(), known, n=1, cutoff=0.5)
        hint = f', did you mean "{known[near[0]].split(" ", 1)[1]}"?' if near else ""
        message = f'"{written}" is not a known unit{hint}; expected {expected(unit)}'
        raise ValueError(message) from None
    if angle:
        raise ValueError(
            f'the unit "{written}" holds an angle or a count; expected {expected(unit)}'
        )
    if factor is None:
        raise ValueError(f'the unit "{written}" has the wrong dimension; expected {expected(unit)}')
    return factor


def _in_root_units(written: str, unit: str) -> tuple[Fraction | None, bool]:
    """Return the factor of a unit to one of SI, or None, and whether they differ by an angle or a count.

    For pint an angle has no dimension; its root unit is the radian. A frequency counts cycles, so that one of
    an angle over time is divided by that of a full turn.
    """
    make = partial(_registry().Quantity, Fraction(1))
    si, given = make(unit).to_root_units(), make(written).to_root_units()
    if unit == FREQUENCY and given.units != si.units:
        given = (given / make("turn")).to_root_units()
    if given.units != si.units:
        return None, given.dimensionality == si.dimensionality
    if _registry().Quantity(Fraction(0), written).to_root_units().magnitude:
        raise ValueError("a unit with another zero")
    return Fraction(given.magnitude / si.magnitude), False


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Fraction)
