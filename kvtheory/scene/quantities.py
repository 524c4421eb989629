"""Fields of a scene: each says its unit, its range and what it means, once, for every use.

The reader of scene files, the template, the writer and the constructors work from this metadata.
"""

import dataclasses
import difflib
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.scene.units import expected, to_si


class SceneError(ValueError):
    """One or more mistakes in a scene, all of them listed in `problems`."""

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(self.problems))


@dataclass(frozen=True)
class Quantity:
    """What a field of a scene may hold."""

    unit: str
    doc: str
    minimum: float
    exclusive: bool

    def admits(self, value: ArrayLike) -> bool:
        """Whether every `value` (in SI) is finite and in range."""
        value = np.asarray(value)
        above = value > self.minimum if self.exclusive else value >= self.minimum
        return bool(np.all(np.isfinite(value) & above))

    @property
    def range(self) -> str:
        """The range in words."""
        if self.minimum == -math.inf:
            return "a finite value"
        return f"a finite value {'above' if self.exclusive else 'of at least'} {self.minimum:g}"


def quantity(
    unit: str,
    doc: str,
    *,
    minimum: float = 0.0,
    exclusive: bool = True,
    default: Any = dataclasses.MISSING,
) -> Any:
    """Declare a dataclass field that holds a quantity in the SI unit `unit`."""
    return field(default=default, metadata={"quantity": Quantity(unit, doc, minimum, exclusive)})


def quantities(cls: Any) -> dict[str, Quantity]:
    """Return the quantities that a dataclass or its instance declares, by name."""
    return {
        f.name: f.metadata["quantity"] for f in dataclasses.fields(cls) if "quantity" in f.metadata
    }


def required(cls: Any) -> list[str]:
    """Return the names of the quantities without a default."""
    return [
        f.name
        for f in dataclasses.fields(cls)
        if "quantity" in f.metadata and f.default is dataclasses.MISSING
    ]


def convert(value: Any, spec: Quantity) -> float:
    """Return `value` in SI, or raise `ValueError` saying what is wrong with it."""
    number = to_si(value, spec.unit)
    if not spec.admits(number):
        raise ValueError(f"is out of range; expected {spec.range}, {expected(spec.unit)}")
    return number


def settle(instance: Any, section: str) -> None:
    """Convert and check every quantity of a frozen dataclass; for use in ``__post_init__``."""
    problems = []
    for name, spec in quantities(instance).items():
        given = getattr(instance, name)
        try:
            object.__setattr__(instance, name, convert(given, spec))
        except ValueError as error:
            problems.append(problem(f"{section}.{name}", given, str(error)))
    if problems:
        raise SceneError(problems)


def problem(key: str, given: Any, what: str) -> str:
    """One line about one mistake: the key, what was given, and what is wrong."""
    shown = f'"{given}"' if isinstance(given, str) else repr(given)
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return f"{key} = {shown}: {what}"


def closest(name: str, valid: Iterable[str]) -> str | None:
    """Return the one of the `valid` names that was probably meant, if any."""
    return next(iter(difflib.get_close_matches(name, list(valid), n=1, cutoff=0.5)), None)


def nearest(name: str, valid: Iterable[str]) -> str:
    """Suggest the closest of the `valid` names, and list them all."""
    valid = list(valid)
    match = closest(name, valid)
    hint = f'did you mean "{match}"? ' if match else ""
    return f"{hint}expected one of: {', '.join(valid)}"


def absent(wanted: Iterable[str], given: Iterable[str]) -> list[str]:
    """Return the wanted names that are not given, not even misspelt."""
    wanted, given = list(wanted), list(given)
    meant = {closest(name, wanted) for name in given if name not in wanted}
    return [name for name in wanted if name not in given and name not in meant]
