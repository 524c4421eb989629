"""All symbols of the chapters, by the names that they have there."""

from typing import Any

import sympy as sp

from .catalogue import CHAPTERS
from .engine.nomenclature import DECLARED


def __getattr__(name: str) -> Any:
    """Return a symbol from the chapter that declares it.

    >>> from derivations.symbols import l_r
    >>> l_r
    l_r
    """
    for chapter in CHAPTERS:
        found = vars(chapter).get(name)
        functions = [found.func] if isinstance(found, sp.core.function.AppliedUndef) else []
        if isinstance(found, tuple) or any(each in DECLARED for each in (found, *functions)):
            return found
    raise AttributeError(f"no chapter declares the symbol {name}")
