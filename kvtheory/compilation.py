"""Kernels that are interpreted, or compiled by numba where that pays. Numba is optional.

Compiling takes as long as thousands of interpreted steps, and loading what is kept on disk as long as
hundreds. Which is cheaper is decided while the work goes on, by `Kernel.worthwhile`.
"""

import hashlib
import inspect
import warnings
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path
from threading import RLock
from time import thread_time
from types import FunctionType, ModuleType
from typing import Any

from kvtheory.progress import compiling

PUBLIC: Any = {"error_model": "numpy"}
"""Division by zero gives infinity, as in NumPy, and needs no check."""
PRIVATE: Any = {"_nrt": False, "no_cfunc_wrapper": True}
"""Kernels allocate nothing, so that numba need not count references; runs take less than half the time.
Other versions of numba may not have these options, nor the classes that `linking` rests on."""

LOADING = 1.2
"""Time to import numba and to load kernels from disk."""
ORDINARY = 2.0
"""Time to compile without `linking`, over that with it."""
ENOUGH = 1.5
"""Interpreted work, over the cost of compiling or loading, from which that pays. Whether it is met a little
too soon or too late, a call takes at most about twice as long as the better of both ways."""
ONE_RUN, ALIKE = 1.0, 9.0
"""Most work to come, over that done, in a forecast: a run may become smooth at any time, whereas points of a
sweep, and steps of equal length, are alike."""
LOOPS, LOOP_TIME = 20_000, 0.75e-3
"""A loop, and its time on the processor to which all times here refer."""

_lock = RLock()
_unusable: list[str] = []


def available() -> bool:
    """Whether numba is installed, the extra `fast`, and can be used; else warn once why not."""
    return not _unusable and find_spec("numba") is not None and _imported()


@cache
def _imported() -> bool:
    try:
        import numba

        config: Any = numba.config
        switched_off = bool(config.DISABLE_JIT)
    except Exception as error:  # it does not fit Python or its libraries, or is another folder
        warn_unusable(f"numba cannot be imported ({_in_a_line(error)})", FITTING)
        return False
    if switched_off:
        warn_unusable("numba is switched off by NUMBA_DISABLE_JIT", "unset this variable")
        return False
    return True


FITTING = "install versions of numba and NumPy that fit together, or uninstall numba"


def _in_a_line(error: Exception) -> str:
    lines = str(error).split("\n")
    return f"{type(error).__name__}: {lines[0]}" if lines[0] else type(error).__name__


def known_unusable() -> tuple[str, ...]:
    """Return why numba cannot be used, as far as that is known."""
    return tuple(_unusable)


def give_up(reasons: Collection[str]) -> None:
    """Use numba no more in this process, of which another one has warned."""
    _unusable.extend(reasons)


def warn_unusable(why: str, remedy: str) -> None:
    """Use numba no more in this process, and warn why."""
    _unusable.append(why)
    message = f"{why}, so that kernels are interpreted, which is slower; {remedy}"
    warnings.warn(message, RuntimeWarning, stacklevel=2)


def warn_not_kept(why: object) -> None:
    """Warn that kernels are compiled for this process only."""
    message = f"compiled kernels cannot be kept, and every process compiles them again: {why}"
    remedy = "set NUMBA_CACHE_DIR to a folder with space in which numba may write"
    warnings.warn(f"{message}; {remedy}", RuntimeWarning, stacklevel=2)


def _types(arguments: Any) -> Any:
    """Return the types that numba gives to arguments."""
    from numba import typeof

    return tuple(map(typeof, arguments))


def _half(x: float) -> float:
    return 0.5 * x


def _quarter(x: float) -> float:
    return 0.5 * _half(x)


@cache
def linked() -> bool:
    """Whether this version of numba lets `linking` optimise all kernels together: two short ones tell."""
    try:
        from numba import njit

        from kvtheory.linking import EntryCompiler

        _register(_half, linking=True, inlined=True)
        entry: Any = njit(_quarter, pipeline_class=EntryCompiler, **PUBLIC, **PRIVATE)
        return bool(entry(2.0) == 0.5)
    except Exception:  # whatever private classes of another version raise
        return False


def _register(function: Any, stand_in: Any = None, *, linking: bool, inlined: bool) -> None:
    """Register a function with numba; what stands for it may add up in any order."""
    from numba.extending import overload

    body = stand_in or function
    own: Any = dict(PUBLIC)
    if stand_in:
        own["fastmath"] = {"reassoc", "nsz"}
    if linking:
        from kvtheory.linking import PartCompiler

        own |= {**PRIVATE, "forceinline": inlined, "pipeline_class": PartCompiler}
    overload(function, jit_options=own, strict=False)(lambda *_, **__: body)


@cache
def pace() -> float:
    """Return the time of a short loop here, over that on the processor of the constants above."""

    def measured() -> float:
        begun, total = thread_time(), 0.0
        for i in range(LOOPS):
            total += i * 0.5
        return thread_time() - begun

    return min(measured() for _ in range(10)) / LOOP_TIME


class Kernel:
    """An entry of kernels, interpreted until compiling it pays; both ways give the same numbers.

    Only the entry is compiled, with all that it calls from the `modules`. In their place stands what
    `COMPILED` of a module has for some of them. `inlined` are modules, or names of functions. Compiling takes
    so many `seconds`. Numba does not notice changes in other files, so the name under which the entry is kept
    on disk contains a digest of all sources.
    """

    def __init__(
        self, entry: Callable[..., Any], modules: tuple[ModuleType, ...], seconds: float,
        inlined: Collection[ModuleType | str] = (),
    ) -> None:  # fmt: skip
        self.entry, self.modules, self.seconds, self.inlined = entry, modules, seconds, inlined
        self.spent = 0.0
        """CPU time of the work interpreted in this process."""
        self.later = 0.0
        """Interpreted, that of the work that follows the present run, see `followed_by`."""
        self.compiled: Any = None
        """The compiled entry, once it is prepared; it releases the interpreter lock."""

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled entry, which must be `prepared`."""
        return self.compiled(*arguments)

    @contextmanager
    def interpreting(self) -> Iterator[None]:
        """Count the time of interpreted work."""
        begun = thread_time()
        try:
            yield
        finally:
            self.spent += thread_time() - begun

    @contextmanager
    def followed_by(self, seconds: float) -> Iterator[None]:
        """State how long interpreted work will take that is like what was done, and follows a run."""
        self.later = seconds
        try:
            yield
        finally:
            self.later = 0.0

    def worthwhile(self, left: float = 0.0, most: float = ONE_RUN) -> bool:
        """Return whether to go on with the compiled entry.

        `left` is how long the rest would take interpreted; it counts `most` times what was spent at most. If
        it is unknown, as much is expected as makes compiling pay once it would have taken as long.
        """
        if self.compiled is not None:
            return available()
        coming = min(left, most * self.spent) + min(self.later, ALIKE * self.spent)
        total = self.spent + max(coming, (ENOUGH - 1.0) * self.spent)
        return self.pays(total)

    def pays(self, total: float) -> bool:
        """Return whether to load or compile the entry for work that takes so long interpreted."""
        enough = ENOUGH * pace()
        if total < enough * LOADING or not available():
            return False
        if self.compiled is not None or self.on_disk:
            return True
        return total >= enough * self.seconds and (
            linked() or total >= enough * self.seconds * ORDINARY
        )

    @cached_property
    def on_disk(self) -> bool:
        """Whether the entry was compiled before, for this processor and these versions."""
        try:
            from numba.core.registry import cpu_target

            processor = cpu_target.target_context.codegen().magic_tuple()
            index = self._made(cache=True)._cache._cache_file._load_index()
            return any(processor in key for key in index)
        except Exception:  # no place for files, damaged ones, or another version of numba
            return False

    def prepared(self, *arguments: Any) -> bool:
        """Load or compile the entry for arguments like these; return whether that worked, else warn."""
        with _lock:
            if self.compiled is None and available():
                if (loaded := self._loaded(arguments)) is None:
                    compiling()  # what a progress function raises is not caught
                self.compiled = loaded or self._made_or_warned(arguments)
        return self.compiled is not None and available()

    @cached_property
    def digest(self) -> str:
        """A digest of the sources of the kernels."""
        sources = (Path(str(module.__file__)).read_bytes() for module in self.modules)
        return hashlib.sha256(b"".join(sources)).hexdigest()

    def _made(self, **options: Any) -> Any:
        """Return the entry as numba compiles it on call."""
        from numba import njit

        entry = FunctionType(self.entry.__code__, self.entry.__globals__, self.entry.__name__)
        entry.__qualname__ = f"{self.entry.__name__}_{self.digest}"
        return njit(entry, nogil=True, **PUBLIC, **options)

    def _loaded(self, arguments: Any) -> Any:
        """Return the entry if it is on disk, else None."""

        def load_or_stop(*key: Any) -> Any:
            try:
                found = load(*key)
            except Exception:  # whatever damaged files raise, or those of another version
                disk.flush()
                raise
            if found is None:
                raise LookupError
            return found

        try:
            entry = self._made(cache=True)
            disk = entry._cache
            load, disk.load_overload = disk.load_overload, load_or_stop
            entry.compile(_types(arguments))
        except Exception:
            return None
        return entry

    def _made_or_warned(self, arguments: Any) -> Any:
        """Compile the entry, and keep it on disk if there is a writable place; warn if that fails."""
        try:
            return self._made_for(_types(arguments))
        except Exception as error:  # whatever other versions of numba or LLVM raise
            warn_unusable(f"numba cannot compile the kernels ({_in_a_line(error)})", FITTING)
            return None

    def _made_for(self, signature: Any) -> Any:
        linking = linked()
        for module in self.modules:
            stand_ins = getattr(module, "COMPILED", {})
            for name, function in vars(module).items():
                if inspect.isfunction(function) and function.__module__ == module.__name__:
                    inlined = module in self.inlined or name in self.inlined
                    _register(function, stand_ins.get(name), linking=linking, inlined=inlined)
        options: Any = {}
        if linking:
            from kvtheory.linking import EntryCompiler

            options = {**PRIVATE, "pipeline_class": EntryCompiler}
        try:
            entry = self._made(cache=True, **options)
        except RuntimeError:
            warn_not_kept("package and home are read-only")
            entry = self._made(**options)
        with suppress(AttributeError):
            disk = entry._cache
            save = disk.save_overload

            def save_or_warn(*key: Any) -> None:
                try:
                    save(*key)
                except OSError as error:  # the disk is full
                    warn_not_kept(error)

            disk.save_overload = save_or_warn
        entry.compile(signature)
        return entry
