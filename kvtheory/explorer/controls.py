"""The sliders of the explorer: the quantities of a scene, from the dataclasses that declare them."""

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal
from typing import Any

from kvtheory.results import SHOWN_UNITS
from kvtheory.scene.capabilities import lacks_scripts
from kvtheory.scene.foundations import FOUNDATIONS, MEASURED, THERMAL, THIN, Arm
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SECTIONS, Scene
from kvtheory.scene.quantities import Quantity, given, required
from kvtheory.scene.quantities import quantities as declared

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
LINEAR = {"exponent": (1.0, 8.0), "order": (0.05, 1.0), "poisson_ratio": (0.0, 0.49)}
"""Ranges of the sliders that are not logarithmic."""
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
RUBBER = Arm(3e10, 0.01), Arm(5e9, 1.0)
"""Arms shown for a scene without any."""
DIGITS = 6
"""Digits of what follows from a temperature or a layer: all of them would not fit into a field."""
UNITS = SHOWN_UNITS | {"N*s/m": ("N*s/m", 1.0), "N*s/m^2": ("kN*s/m^2", 1e-3)}


def quantities(cls: Any) -> dict[str, Quantity]:
    """Return the quantities that have sliders: all but temperatures, and the moduli of arms."""
    hidden = {*THERMAL, *MEASURED, *(["modulus"] if cls is Arm else [])}
    return {name: spec for name, spec in declared(cls).items() if name not in hidden}


def controls(scene: Scene) -> dict[str, Any]:
    """Return sections, choices and sliders as plain data, and the values of the scene.

    >>> found = controls(Scene())["sections"]["indenter"]["choices"]["parabola"]["radius"]
    >>> found["unit"], found["start"], found["exponent"]
    ('mm', '10', -3)
    """
    foundation = scene.foundation
    if foundation.shift_factor != 1.0 or (foundation.arms and foundation.modulus is not None):
        scene = replace(scene, foundation=foundation.plain())
        own = (pair for pair in scene.values().items() if pair[0].startswith("foundation."))
        scene = scene.replace({key: float(f"{value:.{DIGITS}g}") for key, value in own})
    values = {section: _values(scene, section) for section in SECTIONS}
    line = scene.indenter.per_width
    sections = {}
    for section, (chooser, models) in SECTIONS.items():
        part = getattr(scene, section)
        sections[section] = {
            "chooser": chooser,
            "choices": {
                kind: {
                    name: _slider(
                        getattr(cls, "kind", section), spec, name,
                        values[section].get(name) if isinstance(part, cls) else None, line,
                    )
                    for name, spec in quantities(cls).items()
                }
                for kind, cls in models.items()
            },
            "alternatives": {
                kind: _alternatives(section, kind, cls) for kind, cls in models.items()
            },
            "classes": {kind: cls.__name__ for kind, cls in models.items()},
        }  # fmt: skip
    shown = {
        "choices": {
            section: getattr(getattr(scene, section), chooser) if chooser else section
            for section, (chooser, _) in SECTIONS.items()
        },
        "values": {
            f"{section}.{name}": _text(
                value, quantities(getattr(scene, section))[name].fitting(line).unit
            )
            for section, own in values.items()
            for name, value in own.items()
        },
        "arms": [
            [_text(arm.stiffness, "N/m^3"), _text(arm.relaxation_time, "s")]
            for arm in scene.foundation.arms or RUBBER
        ],
        "note": "" if scene.drive.constant else VARIES,
    }
    arm = {name: _slider("arm", spec, name, None, True) for name, spec in quantities(Arm).items()}
    whole = [name for name, cls in SHAPES.items() if not cls.per_width]
    return {
        "sections": sections, "arm": arm, "allowed": _allowed(), "thin": THIN, "whole": whole,
        "scene": shown,
    }  # fmt: skip


def _values(scene: Scene, section: str) -> dict[str, float]:
    """Return the quantities that a part of the scene sets, in SI; for a drive its final velocity."""
    part = getattr(scene, section)
    found = {name: getattr(part, name) for name in given(part)}
    if section == "drive":
        found |= {"velocity": part.final_velocity}
        found |= {} if part.rigid else {"damping": part.damping}
    return found


def _slider(
    of: str, spec: Quantity, name: str, value: float | None, per_width: bool
) -> dict[str, Any]:
    unit, whole = spec.unit, spec.fitting(False).unit
    start = _text(STIFFNESSES.get(of, START[name]) if name == "stiffness" else START[name], unit)
    if value:
        start = _text(value, spec.fitting(per_width).unit)
    return {
        "doc": spec.doc, "unit": UNITS[unit][0], "exponent": _exponent(unit), "start": start,
        "whole": {"unit": UNITS[whole][0], "exponent": _exponent(whole)} if spec.per_width else None,
        "linear": LINEAR.get(name), "decades": DECADES, "range": spec.range,
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
    sets, found = list(_sets(cls)), []
    for names in sets:
        own = [name for name in names if not all(name in other for other in sets)]
        found.append({"told": f"given by {', '.join(own)}".replace("_", " "), "names": names})
    return found


def _sets(cls: Any) -> Iterator[list[str]]:
    """Yield the sets of quantities that define a part: the required ones, then those with alternatives."""
    specs = quantities(cls)
    optional = {name for spec in specs.values() for name in (spec.instead, *spec.excludes)}
    first = [name for name in specs if name in required(cls) or name not in optional]
    yield first
    for name in first:
        if other := specs[name].instead:
            beside = other, *specs[other].beside
            yield [*beside, *(each for each in first if each != name)]
            if other not in specs[name].excludes:
                yield [*beside, *first]


def _allowed() -> list[list[str]]:
    """Return the pairs of shape and foundation that the scripts can compute."""
    pairs = []
    for shape, indenter in SHAPES.items():
        for kind, foundation in FOUNDATIONS.items():
            arms = {"arms": RUBBER} if kind == "generalized-maxwell" else {}
            scene = Scene(
                indenter(**{name: START[name] for name in quantities(indenter)}),
                foundation(**{name: START[name] for name in required(foundation)}, **arms),
            )
            if not lacks_scripts(scene):
                pairs.append([shape, kind])
    return pairs


def _exponent(unit: str) -> int:
    """Return the power of ten that converts a value in the displayed unit to SI."""
    return -round(math.log10(UNITS[unit][1]))


def _text(value: float, unit: str) -> str:
    """Return an SI value in the displayed unit, with the same digits."""
    number = Decimal(repr(float(value))).scaleb(-_exponent(unit)).normalize()
    return f"{number:f}" if -5 < number.adjusted() < 8 else f"{number:e}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
