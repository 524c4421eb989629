r"""Declarations of symbols: what each means, its unit, and how it is printed.

A chapter declares the symbols that it introduces, and later chapters import them from there. A declaration
is the SymPy symbol with the assumptions under which every step is proved, and a row of the nomenclature.

>>> symbol("rho_0", "density at rest", "kg/m³", source="scene")
rho_0
>>> BY_LATEX.pop(r"\rho_0").meaning
'density at rest'

A dot is the derivative with respect to time, a prime the one with respect to the argument, which for scaled
quantities of the transient is the scaled time.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.core.function import UndefinedFunction

from .atoms import atoms


@dataclass(frozen=True)
class Symbol:
    """A row of the nomenclature."""

    latex: str
    meaning: str
    unit: str
    source: str | None = ""
    """Label of the derivation that introduces it, or another source; empty if a scene gives it; None for
    the first derivation that defines it, or else prints it."""
    sign: str = ""
    """What is assumed of it, if not that it is a positive number."""


def sign_of(letter: sp.Expr) -> str:
    """Return what is assumed of a letter, in words; nothing for a positive one.

    >>> [sign_of(sp.Symbol("x", **{fact: True})) for fact in ("positive", "negative", "real")]
    ['', 'negative', 'of either sign']
    """
    known = (
        ("positive", ""),
        ("nonnegative", "not negative"),
        ("negative", "negative"),
        ("real", "of either sign"),
    )
    return next((words for fact, words in known if getattr(letter, f"is_{fact}")), "complex")


BY_LATEX: dict[str, Symbol] = {}
"""The rows by what is printed, complete once the chapters are imported (`catalogue`)."""
BY_NAME: dict[str, sp.Symbol] = {}
"""The declared letters by their names in SymPy."""
TEX: dict[sp.Symbol, str] = {}
"""How symbols are printed where SymPy's own choice differs from the paper's."""
SYMBOLS: set[str] = set()
"""How the declared letters that are no functions are printed."""
CONSTANTS: dict[str, sp.Expr] = {}
"""Numbers with a letter of their own."""
SEVERAL: set[sp.Symbol] = set()
"""The letters of quantities that depend on several others: their derivatives are partial."""
DECLARED: set[object] = set()
"""The symbols and functions that the chapters have declared."""
HEADS = ("Symbol", "Meaning", "Unit", "From")


def shared_letters() -> str:
    """Return the letters that a number shares with a function, which then is printed with its argument."""
    names = {
        sp.latex(sp.Symbol(each.__name__))
        for each in DECLARED
        if isinstance(each, UndefinedFunction)
    }
    return " ".join(sorted({each for each in SYMBOLS if each.rstrip("'") in names} | {*CONSTANTS}))


def letter(
    latex: str, meaning: str, unit: str = "1", source: str | None = None, sign: str = ""
) -> None:
    """Declare a letter that is printed: an index, or one that a symbol prints elsewhere."""
    if BY_LATEX.setdefault(latex, row := Symbol(latex, meaning, unit, source, sign)) != row:
        raise ValueError(f"{latex} has two meanings: {BY_LATEX[latex].meaning}, and {meaning}")


def symbol(
    name: str,
    meaning: str = "",
    unit: str = "1",
    latex: str = "",
    *,
    printed: str = "",
    source: str | None = None,
    several: bool = False,
    **assumptions: bool,
) -> sp.Symbol:
    """Declare a symbol, positive unless other assumptions are given.

    `latex` is how displays write it, if not as SymPy does, `printed` its letter where the document prints
    another one (`letters`); the derivatives of what depends on `several` letters are partial. Without a
    meaning it is no row: a derivative, or a letter declared elsewhere.
    """
    found = sp.Symbol(name, **(assumptions or {"positive": True}))
    if BY_NAME.setdefault(name, found) != found:
        raise ValueError(f"the letter {name} is declared twice, with different assumptions")
    SEVERAL.update([found] if several else [])
    SYMBOLS.add(latex or sp.latex(found))
    if latex and TEX.setdefault(found, latex) != latex:
        raise ValueError(f"{name} is printed {TEX[found]} and {latex}")
    return _declared(found, meaning, unit, printed or latex or sp.latex(found), source)


def symbols(table: str) -> tuple[Any, ...]:
    r"""Declare symbols, one in a row: its name, how displays write it, its unit, its meaning, and more.

    Two or more spaces separate the columns, "-" is an empty one; what is indented more goes on with the row
    before. More is what is assumed, what the document prints ("prints ..."), and the source ("from ...").
    A row without a name declares a letter alone.

    >>> table = r'''
    ...     n_9  \Xi_9       1  number of layers, the lowest
    ...             included  integer positive  from F1
    ...     -    \Upsilon_9  m  thickness of a layer
    ... '''
    >>> (n_9,) = symbols(table)
    >>> n_9.is_integer, TEX.pop(n_9)
    (True, '\\Xi_9')
    >>> rows = [BY_LATEX.pop(latex) for latex in (r"\Xi_9", r"\Upsilon_9")]
    >>> [(row.latex, row.unit, row.source) for row in rows]
    [('\\Xi_9', '1', 'F1'), ('\\Upsilon_9', 'm', None)]
    >>> rows[0].meaning
    'number of layers, the lowest included'
    """
    found = []
    for row in re.sub(r"\n {8,}(?=\S)", " ", table).strip().splitlines():
        columns = ["" if each == "-" else each for each in re.split("  +", row.strip())]
        name, latex, unit, meaning, *more = columns
        assumed: dict[str, bool] = {}
        source, shown = None, ""
        for each in more:
            key, _, rest = each.partition(" ")
            if key == "from":
                source = "" if rest == "scene" else rest
            elif key == "prints":
                shown = rest
            else:
                assumed |= dict.fromkeys(each.split(), True)
        if name:
            found.append(
                symbol(name, meaning, unit, latex, printed=shown, source=source, **assumed)
            )
        else:
            letter(latex, meaning, unit, source)
    return tuple(found)


def function(
    name: str,
    meaning: str = "",
    unit: str = "1",
    *,
    printed: str = "",
    source: str | None = None,
    **assumptions: bool,
) -> Callable[..., sp.Expr]:
    """Declare a function, in the same way."""
    found = sp.Function(name, **assumptions)
    return _declared(found, meaning, unit, printed or sp.latex(sp.Symbol(name)), source)


def constant(latex: str, value: sp.Expr, meaning: str) -> sp.Expr:
    """Declare a letter for a number."""
    letter(latex, meaning)
    CONSTANTS[latex] = value
    return _declared(value, "", "1", latex, None)


def _declared(found: sp.Expr, meaning: str, unit: str, latex: str, source: str | None) -> sp.Expr:
    DECLARED.add(found)
    if meaning:
        sign = sign_of(found) if isinstance(found, sp.Symbol) else ""
        letter(next(atoms(latex)).symbol, meaning, unit, source, sign)
    return found
