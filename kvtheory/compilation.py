"""Kernels compiled by numba, which is optional, and cached on disk."""

import inspect
import warnings
from collections.abc import Callable, Container, Mapping
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any

from kvtheory.progress import compiling

OPTIONS: Any = {"error_model": "numpy"}
"""Division by zero gives infinity, as in NumPy, and needs no check."""

NONE: Mapping[str, Any] = MappingProxyType({})


def available() -> bool:
    """Whether numba is installed: the extra `fast`."""
    return find_spec("numba") is not None


def register(
    module: ModuleType,
    inlined: Container[str] = (),
    compiled: Mapping[str, Any] = NONE,
    **options: Any,
) -> None:
    """Register the functions of a module with numba; those named in `inlined` are inlined.

    `compiled` has what stands for some of them where they are compiled. They may add up in any order.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    from numba.extending import overload

    from kvtheory.linking import PartCompiler

    for name, function in vars(module).items():
        if inspect.isfunction(function) and function.__module__ == module.__name__:
            body = compiled.get(name, function)
            own: Any = {**OPTIONS, **options, "forceinline": name in inlined}
            own["pipeline_class"] = PartCompiler
            if name in compiled:
                own["fastmath"] = {"reassoc", "nsz"}
            overload(function, jit_options=own, strict=False)(lambda *_, body=body, **__: body)


def on_disk(entry: Any) -> bool:
    """Return whether a `cached` entry was compiled before, so that loading it takes half a second."""
    files = getattr(entry._cache, "_cache_file", None)
    return files is not None and Path(files._index_path).exists()


def warn_not_kept(why: object) -> None:
    """Warn that kernels are compiled for this process only."""
    told = f"compiled kernels cannot be kept, and every process compiles them again: {why}"
    remedy = "set NUMBA_CACHE_DIR to a folder with space in which numba may write"
    warnings.warn(f"{told}; {remedy}", RuntimeWarning, stacklevel=2)


def cached(entry: Callable[..., Any], **options: Any) -> Any:
    """Return an entry that is compiled when called, and cached on disk if there is a writable place."""
    from numba import njit

    from kvtheory.linking import EntryCompiler

    options |= {**OPTIONS, "nogil": True, "no_cfunc_wrapper": True}
    options["pipeline_class"] = EntryCompiler
    try:
        compiled = njit(entry, cache=True, **options)
    except RuntimeError:
        warn_not_kept("package and home are read-only")
        compiling()
        return njit(entry, **options)
    disk: Any = compiled._cache  # type: ignore[attr-defined]
    load, save = disk.load_overload, disk.save_overload

    def load_or_forget(*key: Any) -> Any:
        found = None
        try:
            found = load(*key)
        except Exception:  # whatever damaged files raise, or those of another version
            with suppress(OSError):
                disk.flush()
        if found is None:
            compiling()
        return found

    def save_or_warn(*key: Any) -> None:
        try:
            save(*key)
        except OSError as error:  # the disk is full
            warn_not_kept(error)

    disk.load_overload, disk.save_overload = load_or_forget, save_or_warn
    return compiled
