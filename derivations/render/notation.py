"""Other people's letters: a map from the symbols of the nomenclature to LaTeX."""

import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path

from ..catalogue import SYMBOLS
from ..engine.atoms import GREEK, atoms
from ..labels import unknown


def plain(latex: str) -> str:
    r"""Return the name of a symbol as one types it.

    >>> [plain(latex) for latex in (r"x_{\mathrm{TE}}", r"\delta_0", r"V^{*}", r"\hat p")]
    ['x_TE', 'delta_0', 'V*', 'hat p']
    """
    return re.sub(r"\\mathrm|\\text|[\\{}^]", "", latex)


NAMES = {plain(symbol.latex): symbol.latex for symbol in SYMBOLS}
"""The LaTeX of each symbol by its name."""


_SIGN = (
    rf"(?:[A-Za-z0-9]|{GREEK}|\\(?:infty|prime|ast|star|circ|parallel|perp|max|min|to)(?![A-Za-z])"
    r"|\\(?:mathrm|mathit|mathsf|mathbf|text)\{[A-Za-z0-9 ,.+*-]+\})"
)
_INDEX = rf"(?:{_SIGN}|\{{(?:{_SIGN}|[ ,.+*()-]|\\[,!]|_(?:{_SIGN}|\{{{_SIGN}+\}})(?!_))+\}})"
_STAR = r"\^(?:\*|\{\*\})"
_SETTABLE = re.compile(
    rf"(?:\\(?:bar|hat|tilde|breve|check|dot|ddot)(?![A-Za-z]) ?)?(?:{_SIGN}|\{{{_SIGN}\}}|\\Delta [a-z])"
    rf"(?:{_STAR}(?:_{_INDEX})?|_{_INDEX}(?:{_STAR})?)?"
)
"""What LaTeX with amsmath and a browser set as one symbol; markup of no format is among it."""


def read_notation(path: Path) -> dict[str, str]:
    r"""Read a TOML file of lines like ``l_r = "\\ell"`` and return new LaTeX by the LaTeX of a symbol.

    Raises
    ------
    ValueError
        For a file that is not TOML, an unknown symbol, a letter that is not one symbol, and one letter
        for two symbols; all mistakes at once, one a line.
    """
    try:
        wanted = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"--notation {path}: not TOML: {error}") from error
    mistakes = [unknown(name, NAMES, "symbol") for name in wanted if name not in NAMES]
    letters = {NAMES[name]: letter for name, letter in wanted.items() if name in NAMES}
    for symbol, letter in letters.items():
        mistakes += _mistakes(symbol, letter)
    valid = {symbol: letter for symbol, letter in letters.items() if isinstance(letter, str)}
    mistakes += _clashes(valid, valid)
    if mistakes:
        raise ValueError("\n".join(f"--notation {path}: {each}" for each in mistakes))
    return valid


def check_letters(letters: Mapping[str, str], shown: Collection[str]) -> None:
    """Raise `ValueError` if a new letter stands for another of the symbols that are shown."""
    if mistakes := _clashes({each: letters[each] for each in letters if each in shown}, shown):
        raise ValueError("\n".join(f"--notation: {each}" for each in mistakes))


def _mistakes(symbol: str, letter: object) -> list[str]:
    if not isinstance(letter, str):
        return [f'{plain(symbol)} = {letter!r}: expected text, as in {plain(symbol)} = "b"']
    found = list(atoms(letter))
    whole = [(atom.start, atom.end) for atom in found] == [(0, len(letter))]
    if not (whole and _SETTABLE.fullmatch(letter)) or found[0].primes:
        return [f"{plain(symbol)} = {letter!r}: expected one symbol in LaTeX, such as \\ell or b_0"]
    return []


def _clashes(letters: Mapping[str, str], shown: Collection[str]) -> list[str]:
    """Say which letters would have two meanings among the symbols that are shown."""
    meaning = {symbol: symbol for symbol in shown if symbol not in letters}
    found = []
    for symbol, letter in letters.items():
        for atom in atoms(letter):
            other = meaning.setdefault(atom.symbol, symbol)
            if other != symbol:
                found.append(
                    f"{plain(symbol)} = {letter!r}: that letter already stands for {plain(other)} "
                    "in these derivations; choose another, or rename that symbol too"
                )
    return found
