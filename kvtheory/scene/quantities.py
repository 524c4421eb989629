"""Quantities of a scene: each field of a part declares its unit, range and meaning once, for every use.

Constructors, scene files and the template work from these declarations. A quantity is a float or an array of
floats, in SI.
"""

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.lists import split
from kvtheory.scene.mistakes import Problems, mistake
from kvtheory.scene.units import WHOLE, bare, expected, is_usual, to_si

MOST = 10**8
"""Largest number of values in a range; more would be a typing error, and fill the memory."""

Value = Any
"""A float, or an array of floats."""


class Derived(float):
    """A quantity that follows from others, computed again with them; `given` is a time before its shift."""

    given: Any = None


class DerivedArray(np.ndarray):
    """An array of derived quantities; what is computed from it is a plain array."""

    given: Any = None

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        """Apply a function to plain arrays."""
        plain = [np.asarray(x) if isinstance(x, DerivedArray) else x for x in inputs]
        return getattr(ufunc, method)(*plain, **options)

    def __reduce__(self) -> Any:
        return _derived, (np.asarray(self), self.given)

    def __deepcopy__(self, memo: Any) -> "DerivedArray":
        return _derived(np.array(self), self.given)


def _derived(value: Any, given: Any = None) -> Any:
    found: Any = Derived(value) if np.ndim(value) == 0 else np.asarray(value).view(DerivedArray)
    found.given = given
    return found


def is_derived(value: Any) -> bool:
    """Whether a quantity follows from others."""
    return isinstance(value, Derived | DerivedArray)


def as_given(value: Any) -> Any:
    """Return a quantity as it was given: a time before its shift by temperature."""
    return value.given if is_derived(value) and value.given is not None else value


class Part:
    """A frozen part of a scene, whose quantities are floats or arrays, with equality, hash and `mapped`."""

    arrayed: ClassVar[bool] = False
    """Whether a quantity is an array; set on instances by `validate`, so that the test is cheap."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _content(self) == _content(other)

    def __hash__(self) -> int:
        return hash(_content(self))

    def mapped(self, function: Callable[[Any], Any]) -> Any:
        """Return a copy with a function applied to every array, which is not checked again."""

        def mapped(value: Any) -> Any:
            if isinstance(value, np.ndarray):
                return function(np.asarray(value))
            if isinstance(value, Part):
                return value.mapped(function) if value.arrayed else value
            parts = isinstance(value, tuple) and value and isinstance(value[0], Part)
            return tuple(map(mapped, value)) if parts else value

        copy = object.__new__(self.__class__)
        values = {name: getattr(self, name) for name in _names(self.__class__)}
        if self.arrayed:
            values = {name: mapped(value) for name, value in values.items()} | {"arrayed": True}
        vars(copy).update(values)
        return copy

    def changed(self, **values: Any) -> Any:
        """Return a copy with some quantities replaced; quantities that these exclude are dropped."""
        specs = quantities(self)
        dropped = {other: None for name in specs.keys() & values for other in specs[name].excludes}
        return dataclasses.replace(self, **{**dropped, **values})  # type: ignore[type-var]

    def nested(self) -> Iterator[tuple[str, "Part"]]:
        """Yield the nested parts with their names within this one, such as "arms[0]"."""
        for name in _names(self.__class__):
            value = getattr(self, name)
            if isinstance(value, Part):
                yield name, value
            elif isinstance(value, tuple) and value and isinstance(value[0], Part):
                yield from ((f"{name}[{i}]", part) for i, part in enumerate(value))

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Return the arrays among the given quantities, those of parts within it by dotted name."""
        found: dict[str, Any] = {}
        if self.arrayed:
            own = {name: as_given(getattr(self, name)) for name in _names(self.__class__)}
            found |= {name: value for name, value in own.items() if type(value) is np.ndarray}
            for name, part in self.nested():
                found |= {f"{name}.{inner}": each for inner, each in part.arrays().items()}
        return found

    def mark(self, parts: Iterable["Part"]) -> None:
        """Set `arrayed` if one of its parts holds arrays."""
        if any(part.arrayed for part in parts):
            object.__setattr__(self, "arrayed", True)


def _content(part: Part) -> tuple[Any, ...]:
    values = (getattr(part, name) for name in _names(part.__class__))
    return tuple((v.shape, v.tobytes()) if isinstance(v, np.ndarray) else v for v in values)


_names: Any = cache(lambda cls: tuple(f.name for f in dataclasses.fields(cls)))
"""Return the names of the fields of a dataclass."""


@dataclass(frozen=True)
class Quantity:
    """A quantity of a scene, as a field declares it."""

    unit: str
    doc: str
    minimum: float
    exclusive: bool  # whether the range excludes its minimum
    below: float = math.inf
    maximum: float = math.inf
    needed: bool = False  # it must be given, unless the one named by `instead` is
    instead: str = ""
    beside: tuple[str, ...] = ()  # those with which it must be given
    excludes: tuple[str, ...] = ()  # those with which it must not
    per_width: bool = False  # a total for a ball
    difference: bool = False  # of temperatures
    infinite: bool = False  # whether it may be

    def fitting(self, per_width: bool) -> "Quantity":
        """Return this quantity per unit width, for a line contact, or as a total, for a ball."""
        if per_width or not self.per_width:
            return self
        return dataclasses.replace(self, unit=WHOLE[self.unit], per_width=False)

    @property
    def dimension(self) -> str:
        """The unit as `to_si` takes it, which distinguishes temperatures from their differences."""
        return f"delta {self.unit}" if self.difference else self.unit

    @property
    def words(self) -> str:
        """The meaning, and whether it is per unit width."""
        return f"{self.doc} per unit width" if self.per_width else self.doc

    def admits(self, value: ArrayLike) -> bool:
        """Whether every `value` (in SI) is in range, and finite unless it may be infinite."""
        value = value if isinstance(value, float) else np.asarray(value)
        above = value > self.minimum if self.exclusive else value >= self.minimum
        under = (abs(value) < math.inf) & (value < self.below) & (value <= self.maximum)
        inside = above & (under | (self.infinite & (value == math.inf)))
        return bool(inside if isinstance(value, float) else inside.all())

    @property
    def range(self) -> str:
        """The range in words."""
        if self.minimum == -math.inf:
            return "a finite value"
        below = f" and below {self.below:g}" if math.isfinite(self.below) else ""
        below += f" and of at most {self.maximum:g}" if math.isfinite(self.maximum) else ""
        above = "above" if self.exclusive else "of at least"
        finite = "a value" if self.infinite else "a finite value"
        return f"{finite} {above} {self.minimum:g}{below}"


def quantity(
    unit: str, doc: str, *, minimum: float = 0.0, exclusive: bool = True,
    default: Any = dataclasses.MISSING, **more: Any,
) -> Any:  # fmt: skip
    """Declare a dataclass field that holds a quantity in the SI unit `unit`; see `Quantity`."""
    spec = Quantity(unit, doc, minimum, exclusive, **more)
    return field(default=default, metadata={"quantity": spec})


def quantities(cls: Any) -> Mapping[str, Quantity]:
    """Return the quantities that a dataclass or its instance declares, by name."""
    return _declared(cls if isinstance(cls, type) else cls.__class__)


@cache
def _declared(cls: type) -> Mapping[str, Quantity]:
    return {f.name: f.metadata["quantity"] for f in dataclasses.fields(cls) if f.metadata}


def given(instance: Any) -> dict[str, Quantity]:
    """Return the quantities that an instance was given: those that exist and are not derived."""
    specs = quantities(instance)
    values = {name: as_given(getattr(instance, name)) for name in specs}
    return {n: s for n, s in specs.items() if values[n] is not None and not is_derived(values[n])}


def free(instance: Any) -> dict[str, Quantity]:
    """Return the quantities that can be replaced by other values, one by one."""
    there = {name for name in quantities(instance) if getattr(instance, name) is not None}
    return {n: s for n, s in quantities(instance).items() if n in there or there >= {*s.beside}}


@cache
def required(cls: Any, given: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return what must be given beside the `given` quantities; one that these exclude is another mistake."""
    specs, names = quantities(cls), set(given)
    for name in specs:
        if name in names:
            names -= set(specs[name].excludes)
    beside = {other for name in specs.keys() & names for other in specs[name].beside}
    first = {f.name for f in dataclasses.fields(cls) if f.default is dataclasses.MISSING}
    return tuple(
        name
        for name, spec in specs.items()
        if name not in names
        and (name in beside or ((spec.needed or name in first) and spec.instead not in names))
    )


def missing(section: str, name: str, spec: Quantity, of: str = "") -> str:
    """Return the message that a quantity is missing, and what may be given instead."""
    instead = f"; or {section}.{spec.instead}" if spec.instead else ""
    return f"{section}.{name}: missing{of}; expected {expected(spec.dimension)}{instead}"


def convert(value: Any, spec: Quantity) -> float:
    """Return one `value` in SI, or raise `ValueError` saying what is wrong with it."""
    number = to_si(value, spec.dimension)
    if not spec.admits(number):
        raise ValueError(f"is out of range; expected {spec.range}, {expected(spec.dimension)}")
    return number


def converted(value: Any, spec: Quantity) -> Any:
    """Return a value, or an array of them, in SI; each is checked.

    Arrays are those of any library, lists whose items may be texts, and ranges.

    >>> converted("1 m:3 m:3", Quantity("m", "length", 0.0, True)).tolist()
    [1.0, 2.0, 3.0]
    """
    if isinstance(value, str):
        return item_values(value, spec) if ":" in value else convert(value, spec)
    if isinstance(value, float):
        return convert(value, spec)
    array = array_of(value, spec)
    return array if array.ndim else float(array)


def array_of(value: Any, spec: Quantity) -> NDArray[np.float64]:
    """Return a value, an array of any library, or a list, in SI; each element is checked, none may be masked.

    >>> array_of([["1 ms", 2.0], [3, "4 min"]], Quantity("s", "time", 0.0, False)).tolist()
    [[0.001, 2.0], [3.0, 240.0]]
    """
    values, written = bare(value)
    if isinstance(values, np.ndarray) and values.ndim:
        if written is None and values.dtype.kind in "fiu":
            array = values.astype(float)
            if not spec.admits(array):
                message = f"is out of range; expected {spec.range} in {spec.unit} throughout"
                raise ValueError(message)
            return array
        items = values.reshape(-1).tolist()
        if written is not None:
            items = [f"{item!r} {written}" for item in items]
        return np.array([convert(item, spec) for item in items]).reshape(values.shape)
    if not isinstance(values, (list, tuple, range)):
        return np.asarray(convert(value, spec))
    rows = [array_of(item, spec) for item in values]
    if len({row.shape for row in rows}) > 1:
        raise ValueError("holds rows of different lengths")
    return np.array(rows, dtype=float)


def listed(value: Any, spec: Quantity) -> NDArray[np.float64]:
    """Return the values in SI of one list: a text with commas and ranges, an array or a list."""
    if isinstance(value, str):
        return np.concatenate([item_values(item, spec) for item in split(value)])
    array = np.atleast_1d(array_of(value, spec))
    if array.ndim > 1:
        raise ValueError("expected one list; give pairs as a tuple of keys with a list for each")
    if array.size == 0:
        raise ValueError("is empty; expected at least one value")
    return array


def item_values(item: str, spec: Quantity) -> NDArray[np.float64]:
    """Return the values in SI of a text: one quantity, or a range with both ends.

    >>> item_values("1 ms:3 ms:3", Quantity("s", "time", 0.0, False)).tolist()
    [0.001, 0.002, 0.003]
    """
    if ":" not in item:
        return np.array([convert(item, spec)])
    parts = [part.strip() for part in item.split(":")]
    if len(parts) not in (3, 4) or parts[3:] not in ([], ["log"]):
        form = 'START:STOP:COUNT or START:STOP:COUNT:log, such as "1 mm/s:10 m/s:200:log"'
        raise ValueError(f"expected {form}")
    start, stop = (convert(part, spec) for part in parts[:2])
    if not parts[2].isdecimal() or not 1 <= int(parts[2]) <= MOST:
        raise ValueError(f"COUNT must be a whole number from 1 to {MOST}; got {parts[2]}")
    if len(parts) == 4 and min(start, stop) <= 0.0 <= max(start, stop):
        raise ValueError("a logarithmic range needs START and STOP of one sign, neither zero")
    with np.errstate(over="ignore", invalid="ignore"):
        spaced = np.linspace if len(parts) == 3 else np.geomspace
        array = spaced(start, stop, int(parts[2]))
    if not spec.admits(array):
        raise ValueError("the range leaves that of double precision")
    return array


def validate(instance: Any, section: str) -> None:
    """Convert and check every quantity; `written` keeps those whose unit tells a line from a ball."""
    specs, written, values = quantities(instance), {}, {}
    for name in specs:
        value = as_given(getattr(instance, name))
        if is_derived(value):
            object.__setattr__(instance, name, None)
        elif value is not None:
            values[name] = value
    here = tuple(values)
    needed = required(instance.__class__, here)
    problems = Problems(missing(section, name, specs[name]) for name in needed)
    for place, (name, value) in enumerate(values.items()):
        spec = specs[name]
        try:
            if spec.per_width and (sample := written_sample(value)) is not None:
                spec = _written_as(sample, spec)
                written[name] = value, spec.per_width
            number = converted(value, spec)
            object.__setattr__(instance, name, number)
            if number.__class__ is np.ndarray:
                object.__setattr__(instance, "arrayed", True)
        except ValueError as error:
            message = str(error)
            if spec.per_width and message.endswith(
                expected(spec.unit)
            ):  # the shape is not known here
                message += f", of a line contact, or {expected(WHOLE[spec.unit])}, of a ball"
            problems.add(f"{section}.{name}", value, message)
        if excludes := specs[name].excludes:  # a pair is one mistake, not two
            others = [f"{section}.{other}" for other in here[place:] if other in excludes]
            if others:
                message = f"cannot be given beside {', '.join(others)}"
                problems.add(f"{section}.{name}", value, message)
    problems.report()
    if written:
        object.__setattr__(instance, "written", written)


def written_sample(value: Any) -> Any:
    """Return one item of a list, or one end of a range, if it has a unit; all have the same dimension."""
    while isinstance(value, list | tuple) and value:
        value = value[0]
    if isinstance(value, str):
        return value.split(":")[0]
    return value if hasattr(value, "units") else None


def _written_as(value: Any, spec: Quantity) -> Quantity:
    """Return the quantity that the unit of a value indicates: per unit width, or that of a ball."""
    kinds = spec, spec.fitting(False)
    for kind in kinds:
        if is_usual(value, kind.unit):  # without importing pint
            return kind
    for kind in kinds:
        with suppress(ValueError):
            to_si(value, kind.unit)
            return kind
    return spec


def derive(instance: Any, section: str, name: str, value: Any, of: str, given: Any = None) -> None:
    """Set a quantity that follows from others; for use in ``__post_init__`` after `validate`."""
    if not quantities(instance)[name].admits(value):
        raise mistake(f"{section}.{name}", value, f"follows from {of}, and is out of range")
    object.__setattr__(instance, name, _derived(value, given))
    if np.ndim(value):
        object.__setattr__(instance, "arrayed", True)
