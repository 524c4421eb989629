"""What the explorer has sliders for: the quantities of a scene, from the dataclasses that declare them."""

import math
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from kvtheory.results import SHOWN_UNITS
from kvtheory.scene.drives import Drive
from kvtheory.scene.foundations import FOUNDATIONS, Arm
from kvtheory.scene.indenters import Parabola, PowerLaw, Wedge
from kvtheory.scene.model import SUPPORTS, Run, Scene
from kvtheory.scene.quantities import Quantity, given, quantities, required
from kvtheory.scene.requirements import lacks_closed_form

SHAPES = {cls.shape: cls for cls in (Parabola, PowerLaw, Wedge)}
"""The shapes that the explorer's scripts compute with."""
SECTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "indenter": ("shape", SHAPES),
    "foundation": ("kind", FOUNDATIONS),
    "support": ("kind", SUPPORTS),
}
"""The key that chooses, and what it chooses from."""
PLAIN = {"drive": (Drive, "velocity"), "run": (Run, "duration")}
"""Sections of which one quantity counts here."""
START = {
    "radius": 0.01, "length": 0.01, "exponent": 4.0, "inclination": 0.1,
    "stiffness": 1e10, "retardation_time": 0.1, "order": 0.5,
    "modulus": 5e6, "thickness": 2e-3, "poisson_ratio": 0.45,
    "depth": 3e-4, "mass": 1000.0, "gravity": 9.80665, "load": 9806.65,
    "velocity": 0.1, "duration": 0.2, "relaxation_time": 0.01,
}  # fmt: skip
"""Where a slider stands that the scene says nothing about, in SI: Table 1, and what is usual."""
START_OF = {("suspended", "stiffness"): 3e7, ("arm", "stiffness"): 3e10}
LINEAR = {"exponent": (1.0, 8.0), "order": (0.05, 1.0), "poisson_ratio": (0.0, 0.49)}
"""Ranges of the sliders that are not logarithmic."""
DECADES = 3
"""How far the others reach to either side of where they stand at first."""


def controls(scene: Scene) -> dict[str, Any]:
    """Return sections, choices and sliders as plain data, and where the scene puts them.

    >>> found = controls(Scene())["sections"]["indenter"]["choices"]["parabola"]["radius"]
    >>> found["unit"], found["start"], found["exponent"]
    ('mm', '10', -3)
    """
    sections = {
        section: {
            "chooser": chooser,
            "choices": {
                name: _sliders(section, cls, getattr(scene, section))
                for name, cls in models.items()
            },
            "alternatives": {name: _alternatives(cls) for name, cls in models.items()},
            "classes": {name: cls.__name__ for name, cls in models.items()},
        }
        for section, (chooser, models) in SECTIONS.items()
    }
    velocity = scene.drive.final_velocity
    plain = {
        "drive": {"velocity": _slider("drive", Drive, "velocity", velocity or START["velocity"])},
        "run": {"duration": _slider("run", Run, "duration", scene.run.duration)},
    }
    return {
        "sections": sections,
        "plain": plain,
        "arm": {name: _slider("arm", Arm, name, None) for name in quantities(Arm)},
        "allowed": _allowed(),
        "scene": _scene(scene),
    }


def _scene(scene: Scene) -> dict[str, Any]:
    """Return what the scene chooses and gives, as texts in the units that are shown."""
    values = {"drive.velocity": _text(scene.drive.final_velocity, "m/s")}
    values["run.duration"] = _text(scene.run.duration, "s")
    for section in SECTIONS:
        part = getattr(scene, section)
        for name, spec in given(part).items():
            values[f"{section}.{name}"] = _text(getattr(part, name), spec.unit)
    return {
        "choices": {
            section: getattr(type(getattr(scene, section)), chooser)
            for section, (chooser, _) in SECTIONS.items()
        },
        "values": values,
        "arms": [
            [_text(arm.stiffness, "N/m^3"), _text(arm.relaxation_time, "s")]
            for arm in scene.foundation.arms or _arms()
        ],
    }


def _arms() -> tuple[Arm, Arm]:
    return Arm(3e10, 0.01), Arm(5e9, 1.0)


def _sliders(section: str, cls: Any, part: Any) -> dict[str, Any]:
    own = given(part) if isinstance(part, cls) else {}
    return {
        name: _slider(getattr(cls, "kind", section), cls, name, getattr(part, name) if name in own else None)
        for name in quantities(cls)
    }  # fmt: skip


def _slider(of: str, cls: Any, name: str, value: float | None) -> dict[str, Any]:
    spec: Quantity = quantities(cls)[name]
    unit, _ = SHOWN_UNITS[spec.unit]
    start = START_OF.get((of, name), START[name]) if value is None else value
    return {
        "doc": spec.doc, "unit": unit, "exponent": _exponent(spec.unit), "start": _text(start, spec.unit),
        "linear": LINEAR.get(name), "decades": DECADES, "range": spec.range,
        "minimum": _finite(spec.minimum), "exclusive": spec.exclusive,
        "below": _finite(spec.below), "maximum": _finite(spec.maximum),
    }  # fmt: skip


def _alternatives(cls: Any) -> list[list[str]]:
    """Return the sets of quantities of which one is to be given: those needed, or others instead.

    >>> _alternatives(FOUNDATIONS["kelvin-voigt"])
    [['stiffness', 'retardation_time'], ['modulus', 'thickness', 'poisson_ratio', 'retardation_time']]
    """
    return list(_sets(cls))


def _sets(cls: Any) -> Iterator[list[str]]:
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
    """Return the pairs of shape and foundation whose steady state is in closed form."""
    pairs = []
    for shape, indenter in SHAPES.items():
        for kind, foundation in FOUNDATIONS.items():
            arms = {"arms": _arms()} if kind == "generalized-maxwell" else {}
            scene = Scene(
                indenter(**{name: START[name] for name in quantities(indenter)}),
                foundation(**{name: START[name] for name in required(foundation)}, **arms),
            )
            if not lacks_closed_form(scene):
                pairs.append([shape, kind])
    return pairs


def _exponent(unit: str) -> int:
    """Return the power of ten that a value in the unit that is shown has to be multiplied by."""
    return -round(math.log10(SHOWN_UNITS[unit][1]))


def _text(value: float, unit: str) -> str:
    """Return an SI value in the unit that is shown, with the same decimals."""
    number = Decimal(repr(float(value))).scaleb(-_exponent(unit)).normalize()
    return f"{number:f}" if -8 < number.adjusted() < 12 else f"{number:e}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
