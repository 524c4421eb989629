"""Checks of the arguments of public functions; each function declares its arguments once.

`checked` converts and checks them before the function runs, so that a message names the wrong one.
"""

import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import wraps
from operator import index
from os import PathLike
from typing import Any, TypeVar, cast

import numpy as np

from kvtheory.lists import split
from kvtheory.progress import listening
from kvtheory.scene.drives import TIME
from kvtheory.scene.mistakes import SHORT, Problems, SceneError, nearest, problem, shown
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity, convert, converted, listed
from kvtheory.scene.units import bare, to_si

Function = TypeVar("Function", bound=Callable[..., Any])
POSITION = Quantity("m", "position", -math.inf, True)
FAR = 1e60
"""A distance in m beyond every contact, whose square is still a number."""
Kind = Callable[[Any], Any]
"""Reads a value, or raises `ValueError` saying what is expected."""


def checked(**kinds: Kind) -> Callable[[Function], Function]:
    """Decorate a function: convert and check arguments by their kinds; a default is passed as it is.

    While the function runs, its `progress` also reports that kernels are being compiled.

    >>> @checked(jobs=count)
    ... def run(jobs=None):
    ...     return jobs
    >>> run(), run(jobs=2)
    (None, 2)
    >>> run(jobs="two")
    Traceback (most recent call last):
    kvtheory.scene.mistakes.SceneError: `jobs` = "two": expected a whole number of at least 1
    """

    def decorate(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        defaults = {name: parameters[name].default for name in kinds}

        @wraps(function)
        def run(*args: Any, **kwargs: Any) -> Any:
            problems = Problems()

            def read(name: str, value: Any) -> Any:
                if name not in kinds or value is defaults[name]:
                    return value
                with problems.catching(f"`{name}`", value):
                    return kinds[name](value)

            extra = args[len(parameters) :]
            args = (*map(read, parameters, args), *extra)
            kwargs = {name: read(name, value) for name, value in kwargs.items()}
            problems.report()
            if kwargs.get("progress") is None:
                return function(*args, **kwargs)
            with listening(kwargs["progress"]) as kwargs["progress"]:
                return function(*args, **kwargs)

        return cast(Function, run)

    return decorate


def a_scene(value: Any) -> Scene:
    """Read a scene."""
    if not isinstance(value, Scene):
        message = "expected a Scene; kvtheory.load_scene reads one from a file"
        raise TypeError(problem("`scene`", value, message))
    return value


def number(low: float, high: float = math.inf) -> Kind:
    """Return the kind of a finite number from `low` to `high`; if `high` is infinite, `low` is excluded."""
    said = f"a number from {low} to {high}" if math.isfinite(high) else f"a number above {low:g}"

    def read(value: Any) -> float:
        found = math.nan
        if not isinstance(value, str):
            with suppress(ValueError):
                found = to_si(value, "1")
        if not (low <= found <= high and math.isfinite(found) and (found > low or high < math.inf)):
            raise ValueError(f"expected {said}")
        return found

    return read


def measured(spec: Quantity) -> Kind:
    """Return the kind of one quantity, in SI or with a unit."""
    return lambda value: convert(value, spec)


def times(value: Any) -> list[float]:
    """Read times in s: one or several, also as text; report every mistake with its value."""
    problems, found = Problems(), list[float]()
    for one in value if isinstance(value, (list, tuple)) else [value]:
        with problems.catching("`at`", one):
            for given in split(one) if isinstance(one, str) else [one]:
                with problems.catching("`at`", given):
                    found += listed(given, TIME).tolist()
    if not found and not problems:
        problems.append('`at` is empty: expected times such as "0 ms,1 ms"')
    problems.report()
    return found


def instants(value: Any) -> Any:
    """Read a time in s, or an array of them."""
    several = isinstance(value, str) and "," in value
    return listed(value, TIME) if several else converted(value, TIME)


def instant(value: Any) -> float:
    """Read one time in s."""
    found = instants(value)
    if np.ndim(found):
        raise ValueError("expected one time")
    return float(found)


def positions(value: Any) -> Any:
    """Read positions in m, one or several; infinite ones are far away."""
    values, written = bare(value)
    array = np.asarray(values)
    if written is not None or array.dtype.kind not in "fiu":
        return converted(value, POSITION)
    if np.isnan(array).any():
        raise ValueError("holds what is not a number")
    return np.clip(array.astype(float), -FAR, FAR)


def count(value: Any) -> int:
    """Read a whole number of at least 1."""
    with suppress(TypeError):
        if not isinstance(value, bool) and index(value) >= 1:
            return index(value)
    raise ValueError("expected a whole number of at least 1")


def _accepting(said: str, fits: Callable[[Any], bool]) -> Kind:
    """Return the kind of a value that is only checked."""

    def read(value: Any) -> Any:
        if not fits(value):
            raise ValueError(f"expected {said}")
        return value

    return read


flag = _accepting("True or False", lambda value: isinstance(value, bool | np.bool_))
callback = _accepting("a function", lambda value: callable(value) and not isinstance(value, type))
pool = _accepting(
    "a concurrent.futures.Executor",
    lambda value: not isinstance(value, type) and callable(getattr(value, "submit", None)),
)
file_name = _accepting(
    "the name of a file",
    lambda value: isinstance(value, str | PathLike) and str(value) != "" and "\0" not in str(value),
)


def choice(options: Iterable[str]) -> Kind:
    """Return the kind of a name from a list."""
    options = list(options)

    def read(value: Any) -> str:
        name = value if isinstance(value, str) else ""
        if name not in options:
            raise ValueError(nearest(name, options))
        return name

    return read


def names(value: Any) -> list[str]:
    """Read one name, or a list or an array of names."""
    listed = [value]
    if not isinstance(value, (str, Mapping)):
        with suppress(TypeError):
            listed = list(bare(value)[0])
    if not all(isinstance(name, str) for name in listed):
        raise ValueError("expected a name, or a list of names")
    return listed


def replacements(value: Any) -> Mapping[Any, Any]:
    """Read a mapping of dotted keys to values; a tuple of keys stands for values that vary together."""
    if not isinstance(value, Mapping):
        raise ValueError('expected keys and their values, such as {"drive.velocity": "50 mm/s"}')
    for key in value:
        if not all(isinstance(name, str) for name in (key if isinstance(key, tuple) else [key])):
            message = 'expected a key as text, such as "drive.velocity"'
            raise SceneError([f"`over` {shown(SHORT.repr(key))}: {message}"])
    return value
