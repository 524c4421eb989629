"""The sliders of the explorer: the quantities that a scene gives, and those that its parts could be given."""

import dataclasses
import json
import math
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from kvtheory.layer import model_error
from kvtheory.results import SHOWN_UNITS
from kvtheory.scene.capabilities import DRIVES, LAWS, SUPPORTS, lacks_scripts
from kvtheory.scene.foundations import (
    BARELY,
    FOUNDATIONS,
    GAS_CONSTANT,
    GLASS,
    NEAR,
    SAME_TEMPERATURE,
    Arm,
)
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.layer import LARGE_SLOPE, LARGE_STRAIN, THIN, THIN_WAY
from kvtheory.scene.layer import SHAPES as REST_SHAPES
from kvtheory.scene.model import SECTIONS as ALL_SECTIONS
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity, as_given, given, quantities, required
from kvtheory.theory.contact_at_rest import splines

START = {
    "radius": 0.01, "radius_across": 0.02, "length": 0.01, "exponent": 4.0, "inclination": 0.1,
    "stiffness": 1e10, "retardation_time": 0.1, "order": 0.5,
    "modulus": 2e6, "thickness": 2.5e-4, "poisson_ratio": 0.3,
    "depth": 3e-4, "mass": 1000.0, "gravity": 9.80665, "load": 9806.65,
    "velocity": 0.1, "damping": 1000.0, "duration": 0.2, "relaxation_time": 0.01,
}  # fmt: skip
"""Start value, in SI, of a slider that the scene does not set: Table 1, and usual values.

A quantity per unit width in a line contact has the same digits for a ball, in its own unit: 1 kg for
1 kg/mm."""
STIFFNESSES = {"suspended": 3e7, "drive": 1e6, "arm": 3e10}
"""Start values of the stiffnesses other than that of a foundation."""
CELSIUS = (173.15, 473.15)
LINEAR = {
    "exponent": (1.0, 8.0), "order": (0.05, 1.0), "poisson_ratio": (0.0, 0.5),
    "temperature": CELSIUS, "reference_temperature": CELSIUS,
    "lowest_temperature": CELSIUS, "highest_temperature": CELSIUS,
    "activation_energy": (10.0, 400.0), "wlf.c_1": (1.0, 50.0), "wlf.c_2": (10.0, 500.0),
}  # fmt: skip
"""Ranges of the sliders that are not logarithmic, in the units shown; the value of the scene widens them."""
HALF_SPACE = 1e6
"""Thickness (m) that stands for a half-space."""
DECADES = 3
"""Range of the other sliders, in decades to either side of their start value."""
ADDED: dict[tuple[str, str], list[tuple[str, list[str]]]] = {
    ("indenter", "sphere"): [
        ("one radius: a ball", []),
        ("another radius across", ["radius_across"]),
    ],
    ("drive", "drive"): [
        ("rigid", []),
        ("with a spring", ["stiffness", "damping"]),
        ("with a spring and its own mass", ["stiffness", "damping", "mass"]),
    ],
}
"""By section and choice: titles and names of the sets of optional quantities."""
VARIES = "The drive of the scene varies in time; the page takes its final velocity."
RUBBER = (3.0, 0.01), (0.5, 1.0)
"""Arms shown for a scene without any: share of the relaxed stiffness, and relaxation time (s)."""
DIGITS = 6
"""Digits of the stiffnesses of these arms: all of them would not fit into a field."""
UNITS = SHOWN_UNITS | {
    "N*s/m": ("N*s/m", 1.0), "N*s/m^2": ("kN*s/m^2", 1e-3), "K": ("K", 1.0), "1/s": ("Hz", 1.0),
    "J/mol": ("kJ/mol", 1e-3), "N*s/m^3": ("N*s/mm^3", 1e-9),
}  # fmt: skip

SECTIONS = {name: each for name, each in ALL_SECTIONS.items() if name != "start"}
"""The sections that steady sliding depends on."""


def controls(scene: Scene) -> dict[str, Any]:
    """Return sections, choices and sliders as plain data, and the values of the scene.

    A class has sliders for what defines it (`_alternatives`), and for all else that the scene gives and it
    can hold, such as a temperature.

    >>> found = controls(Scene())["sections"]["indenter"]["choices"]["parabola"]["radius"]
    >>> found["unit"], found["start"], found["exponent"]
    ('mm', '10', -3)
    """
    line = scene.indenter.per_width
    sections: dict[str, Any] = {}
    values: dict[str, str] = {}
    for section, (chooser, classes) in SECTIONS.items():
        # A foundation of another kind has no sliders.
        models = {k: cls for k, cls in classes.items() if section != "foundation" or k in LAWS}
        own = _given(scene, section)
        alternatives = {kind: _alternatives(section, kind, cls) for kind, cls in models.items()}
        choices = {}
        for kind, cls in models.items():
            fields = {field.name for field in dataclasses.fields(cls)}
            named = {name for each in alternatives[kind] for name in each["names"]}
            specs = {name: spec for name, spec in quantities(cls).items() if name in named}
            specs |= {n: spec for n, (_, spec) in own.items() if n.partition(".")[0] in fields}
            choices[kind] = {
                name: _slider(getattr(cls, "kind", section), spec, name, own.get(name), line)
                for name, spec in specs.items()
            }
        sections[section] = {
            "chooser": chooser, "choices": choices, "alternatives": alternatives,
            "classes": {kind: cls.__name__ for kind, cls in models.items()},
        }  # fmt: skip
        values |= {
            f"{section}.{name}": _text(value, spec.fitting(line).unit)
            for name, (value, spec) in own.items()
        }
    shown = {
        "choices": {
            section: getattr(getattr(scene, section), chooser) if chooser else section
            for section, (chooser, _) in SECTIONS.items()
        },
        "values": values, "arms": _arms(scene.foundation),
        "note": "" if scene.drive.constant else VARIES,
        "thin": scene.foundation.stiffness_from == THIN_WAY,
    }  # fmt: skip
    return {
        "sections": sections, "allowed": _allowed(), "scene": shown,
        "arm": {name: _slider("arm", s, name, None, True) for name, s in quantities(Arm).items()},
        "rest": {"shapes": REST_SHAPES, **{name: each.tolist() for name, each in splines().items()}},
        "model_error": None if scene.foundation.modulus is None else _model_error(),
        "whole": [name for name, cls in SHAPES.items() if not cls.per_width],
        "thin": THIN, "large_strain": LARGE_STRAIN, "large_slope": LARGE_SLOPE,
        "barely": BARELY, "near": NEAR, "glass": GLASS, "gas_constant": GAS_CONSTANT,
        "shift_factors": scene.foundation.shift_factors or [], "same_temperature": SAME_TEMPERATURE,
    }  # fmt: skip


def _model_error() -> dict[str, Any]:
    """Return the map of the error of a layer; it is large, and left out of the page of another foundation."""
    names = "SAFETY", "LEAST", "APART", "REACHED"
    own = {name.lower(): getattr(model_error, name) for name in names}
    return {"table": json.loads(model_error.TABLE.read_text()), **own}


def _given(scene: Scene, section: str) -> dict[str, tuple[float, Quantity]]:
    """Return what a part of the scene and the parts within it, but arms, are given, in SI and with its spec.

    Of a drive that is its final velocity. Times are those at the reference temperature.
    """
    part = getattr(scene, section)
    inner = () if section == "drive" else part.nested()
    parts = {"": part, **{f"{name}.": each for name, each in inner if not isinstance(each, Arm)}}
    found = {
        f"{prefix}{name}": (as_given(getattr(each, name)), spec)
        for prefix, each in parts.items()
        for name, spec in given(each).items()
    }
    if section == "drive":
        specs = quantities(part)
        found["velocity"] = part.final_velocity, specs["velocity"]
        found |= {} if part.rigid else {"damping": (part.damping, specs["damping"])}
    if section == "foundation" and not part.damping:
        found.pop("damping", None)
    return found


def _arms(foundation: Any) -> list[list[str]]:
    """Return stiffness, or of a layer modulus, and relaxation time of each arm, those of `RUBBER` if none."""
    name, unit = ("stiffness", "N/m^3") if foundation.modulus is None else ("modulus", "N/m^2")
    pairs = [(getattr(arm, name), as_given(arm.relaxation_time)) for arm in foundation.arms]
    relaxed = getattr(foundation, name)
    usual = [(float(f"{share * relaxed:.{DIGITS}g}"), time) for share, time in RUBBER]
    return [[_text(size, unit), _text(time, "s")] for size, time in pairs or usual]


def _slider(
    of: str, spec: Quantity, name: str, own: tuple[float, Quantity] | None, per_width: bool
) -> dict[str, Any]:
    unit, whole = spec.unit, spec.fitting(False).unit
    if own and own[0]:
        start = _text(own[0], spec.fitting(per_width).unit)
    else:
        usual = STIFFNESSES.get(of, START[name]) if name == "stiffness" else START[name]
        start = _text(usual, unit)
    ends = LINEAR.get(name)
    return {
        "doc": spec.doc, "unit": UNITS[unit][0], "exponent": _exponent(unit), "start": start,
        "whole": {"unit": UNITS[whole][0], "exponent": _exponent(whole)} if spec.per_width else None,
        "linear": ends and [min(ends[0], float(start)), max(ends[1], float(start))],
        "decades": DECADES, "range": spec.range, "difference": spec.difference,
        "minimum": _finite(spec.minimum), "exclusive": spec.exclusive,
        "below": _finite(spec.below), "maximum": _finite(spec.maximum),
    }  # fmt: skip


def _alternatives(section: str, name: str, cls: Any) -> list[dict[str, Any]]:
    """Return the alternative sets of quantities, one of which is to be given, with their titles.

    >>> [each["names"] for each in _alternatives("foundation", "kelvin-voigt", FOUNDATIONS["kelvin-voigt"])]
    [['stiffness', 'retardation_time'], ['modulus', 'thickness', 'poisson_ratio', 'retardation_time']]
    >>> [each["told"] for each in _alternatives("drive", "drive", SECTIONS["drive"][1]["drive"])]
    ['rigid', 'with a spring', 'with a spring and its own mass']
    """
    if (section, name) in ADDED:
        added = ADDED[section, name]
        always = [each for each in quantities(cls) if each not in added[-1][1]]
        return [{"told": title, "names": [*always, *more]} for title, more in added]
    sets, found, specs = list(_sets(cls)), [], quantities(cls)
    for names in sets:
        own = [name for name in names if not all(name in other for other in sets)]
        implied = {each for name in own[:1] for each in specs[name].beside}
        told = ", ".join(name for name in own if name not in implied)
        found.append({"told": f"given by {told}".replace("_", " "), "names": names})
    return found


def _sets(cls: Any) -> Iterator[list[str]]:
    """Yield the sets of quantities that define a part: the required ones, then those with alternatives."""
    specs, first = quantities(cls), _always(cls)
    yield first
    for name in first:
        if (other := specs[name].instead) in specs:
            beside = other, *specs[other].beside
            yield [*beside, *(each for each in first if each != name)]
            if other not in specs[name].excludes:
                yield [*beside, *first]


def _always(cls: Any) -> list[str]:
    """Return the quantities that a part has in any case: the required ones, and those with a default."""
    defaults = {field.name: field.default for field in dataclasses.fields(cls)}
    return [n for n in quantities(cls) if n in required(cls) or isinstance(defaults[n], float)]


def _allowed() -> list[list[str]]:
    """Return the pairs of shape and foundation that the scripts can compute."""
    laws = {shape: lacks_scripts.laws(shape, SUPPORTS[0], DRIVES[0]) for shape in SHAPES}
    return [[shape, law] for shape in SHAPES for law in FOUNDATIONS if law in laws[shape]]


def _exponent(unit: str) -> int:
    """Return the power of ten that converts a value in the displayed unit to SI."""
    return -round(math.log10(UNITS[unit][1]))


def _text(value: float, unit: str) -> str:
    """Return an SI value in the displayed unit, with the same digits."""
    value = min(float(value), HALF_SPACE) if unit == "m" else float(value)
    number = Decimal(repr(value)).scaleb(-_exponent(unit)).normalize()
    return f"{number:f}" if -5 < number.adjusted() < 8 else f"{number:e}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
