r"""The symbols in a piece of LaTeX: a letter with its bar or hat, its index and its star.

Dots and primes are not part of a symbol: they denote derivatives.

>>> [atom.symbol for atom in atoms(r"\dot{u}_{i} = \bar a^{2} d'/l_{\mathrm{r}} + \int_{a}^b h(x)")]
['u_i', '\\bar a', 'd', 'l_{\\mathrm{r}}', 'a', 'b', 'h', 'x']
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

GREEK = (
    r"\\(?:var(?:epsilon|theta|pi|rho|sigma|phi)|alpha|beta|gamma|delta|epsilon|zeta|theta|eta|iota|kappa|lambda|mu|nu|xi|pi|rho|sigma"
    r"|tau|upsilon|phi|chi|psi|omega|Gamma|Delta|Theta|Lambda|Xi|Pi|Sigma|Phi|Psi|Omega|ell)(?![A-Za-z])"
)
_BRACES = r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}"
_LETTER = rf"(?:\\Delta [stxy](?![A-Za-z_'])|\\math(?:sf|bf)\{{[A-Za-z]\}}|{GREEK}|[A-Za-z])"
_TOKEN = re.compile(
    rf"\\(?:mathrm|operatorname|text|textrm|begin|end|phantom)\*?{_BRACES}"
    rf"|(?P<dots>\\d*dot\s*)?(?P<accent>\\(?:bar|hat|tilde|breve|check)\s*)?"
    rf"(?P<letter>{_LETTER}|(?<=dot)\{{{_LETTER}\}}|(?<=bar)\{{{_LETTER}\}}|(?<=hat)\{{{_LETTER}\}})"
    rf"(?P<primes>'*)(?P<star>\^(?:\*|\{{\*\}}))?"
    rf"(?P<index>_(?:{_BRACES}|{_LETTER}|[0-9]|\\mathrm{_BRACES}))?(?P<late>\^(?:\*|\{{\*\}}))?"
    r"|\\(?:[A-Za-z]+|.)"
)
"""Words, functions and units, then symbols, then all other commands."""


@dataclass(frozen=True)
class Atom:
    """A symbol, and the dots and primes about it."""

    symbol: str
    dots: str
    primes: str
    start: int
    end: int


def atoms(latex: str) -> Iterator[Atom]:
    """Find the symbols, from left to right."""
    return iter(_atoms(latex))


@lru_cache(maxsize=32768)
def _atoms(latex: str) -> tuple[Atom, ...]:
    found = []
    for token in _TOKEN.finditer(latex):
        if letter := token["letter"]:
            accent = f"{token['accent'].strip()} " if token["accent"] else ""
            star = "^{*}" if token["star"] or token["late"] else ""
            bare = letter if letter.startswith(r"\math") else letter.strip("{}")
            symbol = f"{accent}{bare}{star}{_index(token['index'] or '')}"
            dots = (token["dots"] or "").strip()
            found.append(Atom(symbol, dots, token["primes"], *token.span()))
    return tuple(found)


@lru_cache
def _index(index: str) -> str:
    """Write one character or command without braces."""
    return re.sub(rf"_\{{({_LETTER}|[0-9])\}}$", r"_\1", index)


def replaced(latex: str, new: Callable[[str], str | None]) -> str:
    r"""Write other LaTeX for the symbols for which `new` returns some.

    >>> replaced(r"\dot a + a_0 + \frac{d a}{a^{2}}", {"a": "b"}.get)
    '\\dot{b} + a_0 + \\frac{d b}{b^{2}}'
    """
    parts, done = [], 0
    for atom in atoms(latex):
        other = new(atom.symbol)
        if other is not None:
            letter, mark, index = other.partition("_") if atom.dots else (other, "", "")
            dotted = f"{atom.dots}{{{letter}}}{mark}{index}" if atom.dots else other
            script = latex[: atom.start].endswith(("_", "^")) and len(other) > 1
            dotted = f"{{{dotted}}}" if script else dotted
            before = latex[done : atom.start]
            # A command must not run into the letter after it, nor a number into another.
            apart = " " if re.match("[A-Za-z]", latex[atom.end : atom.end + 1]) else ""
            parts += [before, dotted + atom.primes + apart]
            done = atom.end
    return "".join([*parts, latex[done:]])
