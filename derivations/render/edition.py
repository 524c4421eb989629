"""One edition of the derivations: their selection, notation and source."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..catalogue import SYMBOLS
from ..engine.atoms import Atom, atoms, replaced
from ..engine.nomenclature import HEADS, Symbol
from ..engine.record import Derivation, Step, Table
from ..labels import closure, find
from .domain import domain
from .frame import TITLE
from .notation import check_letters
from .text import conclusion, reference

_ARGUMENT = re.compile(r"(?:(?:\{?\\left)?\(.{1,12}\)\}?)?")


PREFIX = "kv:"
_PREFIX = re.compile(r"[A-Za-z0-9:.+/-]{0,30}")


@dataclass(frozen=True)
class Edition:
    """The derivations to print and the surrounding text."""

    derivations: tuple[Derivation, ...]
    nomenclature: tuple[Symbol, ...]
    """The symbols that the derivations show, in the order of the table."""
    command: str = ""
    """The command that asked for it."""
    version: str = ""
    """The version of the package that made it."""
    title: str = TITLE
    values: Mapping[str, str] = field(default_factory=dict)
    """Quantities of a scene in LaTeX, by the symbol as it is printed."""
    scene: str = ""
    """The scene of the numbers, in words."""
    letters: Mapping[str, str] = field(default_factory=dict)
    """New LaTeX by the symbol that it replaces."""
    label_prefix: str = PREFIX
    """What each label of a fragment begins with."""

    @property
    def labels(self) -> set[str]:
        """The labels to which the text may refer."""
        return {each.label for each in self.derivations}

    def table(self, symbols: Collection[Symbol] | None = None) -> Table:
        """Return the nomenclature, or the rows of some symbols, with the values of the scene."""
        heads = (*HEADS, "Value") if self.values else HEADS
        rows = self.nomenclature if symbols is None else symbols
        return Table(heads, tuple(self._row(each) for each in rows))

    def _row(self, symbol: Symbol) -> tuple[str, ...]:
        source = reference(symbol.source) if symbol.source else "scene"
        row = (f"${symbol.latex}$", symbol.meaning, symbol.unit, source)
        value = self.values.get(symbol.latex)
        return (*row, f"${value}$" if value else "") if self.values else row

    def domain(self, derivation: Derivation) -> str:
        """Return the values of its symbols for which a result holds."""
        return _words(domain(derivation), self.letters.get)

    def symbols(self, derivation: Derivation) -> tuple[Symbol, ...]:
        """Return the rows of the nomenclature that the formulas of a derivation need."""
        shown = symbols_of(derivation, words=False)
        return tuple(each for each in self.nomenclature if each.latex in shown)


def edition(
    derivations: Sequence[Derivation],
    only: Sequence[str] = (),
    *,
    with_premises: bool = False,
    notation: Mapping[str, str] | None = None,
    command: str = "",
    version: str = "",
    title: str = TITLE,
    values: Mapping[str, str] | None = None,
    scene: str = "",
    symbols: Sequence[Symbol] = (),
    label_prefix: str = PREFIX,
) -> Edition:
    """Select derivations, with those that they depend on if wanted, and write them in other letters.

    `notation` gives new LaTeX by the LaTeX of a symbol of the nomenclature, as `notation.read_notation`
    returns it; a letter that then had two meanings raises `ValueError`. `symbols` are rows of the
    nomenclature that come before those of the same symbol.
    """
    uses = {each.label: each.uses for each in derivations}
    by_label = {each.label: each for each in derivations}
    labels = find(only, by_label) if only else list(by_label)
    if with_premises:
        labels = [label for label in closure(labels, uses) if label in by_label]
    chosen = tuple(by_label[label] for label in labels)
    shown = {symbol for each in chosen for symbol in symbols_of(each)}
    own = {symbol.latex for symbol in symbols}
    rows = (*(row for row in SYMBOLS if row.latex not in own), *symbols)
    origins = introductions(derivations)
    listed = tuple(
        row if row.source is not None else replace(row, source=origins[row.latex])
        for row in rows
        if row.latex in shown
    )
    values = dict(values or {})
    if notation:
        check_letters(notation, shown)
        values = {notation.get(symbol, symbol): value for symbol, value in values.items()}
        chosen = tuple(_in_letters(each, notation.get) for each in chosen)
        listed = tuple(_row_in_letters(each, notation.get) for each in listed)
    return Edition(
        chosen, listed, command, version, title, values, scene, notation or {}, label_prefix
    )


def check_prefix(prefix: str) -> None:
    """Raise `ValueError` for a prefix that a label of LaTeX cannot have."""
    if not _PREFIX.fullmatch(prefix):
        raise ValueError(
            f"--label-prefix {prefix!r}: expected up to 30 of A-Z a-z 0-9 : . + / -, as in 'kv:'"
        )


def introductions(derivations: Iterable[Derivation]) -> dict[str, str]:
    """Return for each symbol the first derivation that has it alone on a left side, or else prints it."""
    named: dict[str, str] = {}
    printed: dict[str, str] = {}
    for each in derivations:
        printed = dict.fromkeys(symbols_of(each), each.label) | printed
        for step in each.steps:
            atom = next(atoms(step.left), None)
            if not step.source and step.relation == "=" and atom and _is_alone(step.left, atom):
                named.setdefault(atom.symbol, each.label)
    return printed | named


def _is_alone(latex: str, atom: Atom) -> bool:
    """Tell whether LaTeX is one symbol, perhaps with its argument, and no derivative."""
    bare = atom.start == 0 and not (atom.dots or atom.primes)
    return bare and bool(_ARGUMENT.fullmatch(latex[atom.end :].strip()))


def symbols_of(derivation: Derivation, *, words: bool = True) -> dict[str, None]:
    """Return the symbols of a derivation in the order in which they first appear."""
    formulas = [derivation.latex, *(conclusion(step) for step in derivation.steps)]
    if words:
        cells = [cell for row in derivation.table.rows for cell in row] if derivation.table else []
        texts = [derivation.title, derivation.text, *cells]
        texts += [step.reason for step in derivation.steps]
        formulas += [part for text in texts for part in text.split("$")[1::2]]
    return {atom.symbol: None for formula in formulas for atom in atoms(formula)}


Letters = Callable[[str], str | None]


def _in_letters(derivation: Derivation, new: Letters) -> Derivation:
    table = derivation.table
    if table:
        rows = tuple(tuple(_words(cell, new) for cell in row) for row in table.rows)
        table = Table(tuple(_words(head, new) for head in table.heads), rows)
    return replace(
        derivation,
        title=_words(derivation.title, new),
        text=_words(derivation.text, new),
        latex=replaced(derivation.latex, new),
        domain=tuple(replaced(each, new) for each in derivation.domain),
        steps=tuple(_step_in_letters(step, new) for step in derivation.steps),
        table=table,
        numbers=tuple(
            replace(
                each,
                symbol=replaced(each.symbol, new),
                formula=replaced(each.formula, new),
                substituted=replaced(each.substituted, new),
            )
            for each in derivation.numbers
        ),
    )


def _step_in_letters(step: Step, new: Letters) -> Step:
    return replace(
        step,
        left=replaced(step.left, new),
        right=replaced(step.right, new),
        reason=_words(step.reason, new),
        note=_words(step.note, new),
        domain=replaced(step.domain, new),
    )


def _row_in_letters(symbol: Symbol, new: Letters) -> Symbol:
    return replace(symbol, latex=replaced(symbol.latex, new), meaning=_words(symbol.meaning, new))


def _words(text: str, new: Letters) -> str:
    """Write other letters in the mathematics between dollar signs."""
    parts = text.split("$")
    return "$".join(replaced(part, new) if i % 2 else part for i, part in enumerate(parts))
