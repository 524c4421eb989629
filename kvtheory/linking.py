"""How numba compiles kernels that call each other: each is lowered, and all are optimised together.

Numba would link into each function all that it calls, optimise this and translate it, so that what is ten
calls deep is compiled eleven times. Here it is done once, for the entry, which takes less than half the time.
Importing this module needs numba.
"""

import gc
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class _Part(JITCodeLibrary):
    """The code of a function that only others call: it is neither optimised nor translated."""

    def finalize(self) -> None:
        """Leave the code as it was lowered."""

    def get_pointer_to_function(self, name: str) -> int:
        """Return the null pointer: there is no machine code."""
        return 0

    @property
    def codegen(self) -> "_Part":
        """What is asked to set the environment of a function, which numba looks for in machine code."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: kernels use no objects of Python."""


class _Whole(JITCodeLibrary):
    """The code of an entry, with all that it calls."""

    def finalize(self) -> None:
        """Link, optimise and translate all parts: those that are called, what they call, and so on."""
        found = self._linking_libraries
        for library in found:  # it grows
            found += [
                each for each in dict.fromkeys(library._linking_libraries) if each not in found
            ]
        super().finalize()


class PartCompiler(Compiler):
    """Compiles a function that only others call."""

    def __init__(self, *args: Any) -> None:
        """Give it a library in which it remains as it was lowered."""
        super().__init__(*args)
        self.state.library = _Part(self.state.targetctx.codegen(), "part")


class EntryCompiler(Compiler):
    """Compiles an entry, and whatever it calls."""

    def __init__(self, *args: Any) -> None:
        """Give it a library that is optimised as a whole, and can be kept on disk."""
        super().__init__(*args)
        self.state.library = _Whole(self.state.targetctx.codegen(), "entry")
        self.state.library.enable_object_caching()

    def compile_extra(self, func: Any) -> Any:
        """Compile without garbage collection, which would take a tenth of the time."""
        collects = gc.isenabled()
        gc.disable()
        try:
            return super().compile_extra(func)
        finally:
            if collects:
                gc.enable()
