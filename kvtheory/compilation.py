"""Kernels compiled by numba, which is optional, and cached on disk."""

import inspect
from collections.abc import Callable, Container
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from kvtheory.progress import compiling

OPTIONS: Any = {"error_model": "numpy"}
"""Division by zero gives infinity, as in NumPy, and needs no check."""


def available() -> bool:
    """Whether numba is installed: the extra `fast`."""
    return find_spec("numba") is not None


def kept(entry: Callable[..., Any], module: ModuleType) -> Any:
    """Return a kernel entry that is compiled when called, and cached on disk if there is a writable place.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    register(module)
    return cached(entry)


def register(module: ModuleType, inlined: Container[str] = (), **options: Any) -> None:
    """Register the functions of a module with numba; those named in `inlined` are inlined."""
    from numba.extending import register_jitable

    for name, function in vars(module).items():
        if inspect.isfunction(function) and function.__module__ == module.__name__:
            register_jitable(**OPTIONS, **options, forceinline=name in inlined)(function)


def cached(entry: Callable[..., Any], **options: Any) -> Any:
    """Return an entry that is compiled when called, and cached on disk if there is a writable place."""
    from numba import njit

    try:
        compiled = njit(entry, cache=True, nogil=True, **OPTIONS, **options)
    except RuntimeError:  # package and home are read-only
        compiling()
        return njit(entry, nogil=True, **OPTIONS, **options)
    disk: Any = compiled._cache  # type: ignore[attr-defined]
    load = disk.load_overload

    def load_or_forget(*key: Any) -> Any:
        found = None
        try:
            found = load(*key)
        except Exception:  # whatever damaged files raise, or those of another version
            disk.flush()
        if found is None:
            compiling()
        return found

    disk.load_overload = load_or_forget
    return compiled
