"""One edition of the derivations: their selection, notation and source."""

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..catalogue import CONTENTS, SYMBOLS
from ..engine.atoms import Atom, atoms, replaced
from ..engine.nomenclature import HEADS, Symbol
from ..engine.record import Derivation, Step, Table
from ..labels import closure, find
from .domain import domain
from .frame import TITLE
from .notation import check_letters
from .text import Given, Line, blocks, conclusion, reference

_ACCENT = re.compile(r"\\(?:bar|hat|tilde|breve|check) ?")
_TAKEN = {"e", "i", "d", r"\pi"}
_SHORT, _USUAL = 60, 3
"""Rows of a nomenclature that is whole; in a longer one stands what as many sections show."""
_ARGUMENT = re.compile(r"(?:(?:\{?\\left)?\(.{1,12}\)\}?)?")


PREFIX = "kv:"
_PREFIX = re.compile(r"[A-Za-z0-9:.+/-]{0,30}")


@dataclass(frozen=True)
class Edition:
    """The derivations to print and the surrounding text."""

    derivations: tuple[Derivation, ...]
    nomenclature: tuple[Symbol, ...]
    """The symbols with one meaning throughout that the derivations show, in the order of the table."""
    chapters: Mapping[str, tuple[Symbol, ...]] = field(default_factory=dict)
    """The other symbols, by the section that shows them."""
    command: str = ""
    """The command that asked for it."""
    version: str = ""
    """The version of the package that made it."""
    title: str = TITLE
    values: Mapping[str, str] = field(default_factory=dict)
    """Quantities of a scene in LaTeX, by the symbol as it is printed."""
    scene: str = ""
    """The scene of the numbers, in words."""
    conditions: Mapping[str, str] = field(default_factory=dict)
    """The sentence on the values for which a result holds, by its label."""
    label_prefix: str = PREFIX
    """What each label of a fragment begins with."""
    columns: int = 1
    """How many columns the page has for which fragments are broken into lines."""

    @property
    def labels(self) -> set[str]:
        """The labels to which the text may refer."""
        return {each.label for each in self.derivations}

    def table(self, symbols: Collection[Symbol] | None = None) -> Table:
        """Return the nomenclature, or the rows of some symbols, with the values of the scene."""
        heads = (*HEADS, "Value") if self.values else HEADS
        rows = self.nomenclature if symbols is None else symbols
        return Table(heads, tuple(self._row(each) for each in rows))

    def chapter_table(self, section: str) -> Table:
        """Return the symbols that stand in the table of their section alone."""
        rows = (self._row(each)[:3] for each in self.chapters.get(section, ()))
        return Table(HEADS[:3], tuple(rows))

    def _row(self, symbol: Symbol) -> tuple[str, ...]:
        named = symbol.source if symbol.source in CONTENTS.keys() | self.labels else ""
        source = reference(named) if named else "" if symbol.source else "given"
        meaning = "; ".join(part for part in (symbol.meaning, symbol.sign) if part)
        row = (f"${symbol.latex}$", meaning, symbol.unit, source)
        value = self.values.get(symbol.latex)
        return (*row, f"${value}$" if value else "") if self.values else row

    def blocks(self, derivation: Derivation) -> Iterator[Given | Line]:
        """Return the sentences and lines of a derivation, which cite what was printed before."""
        place = self.derivations.index(derivation)
        return blocks(derivation, {each.label: each for each in self.derivations[:place]})

    def domain(self, derivation: Derivation) -> str:
        """Return the values of its symbols for which a result holds."""
        return self.conditions[derivation.label]

    def symbols(self, derivation: Derivation) -> tuple[Symbol, ...]:
        """Return the rows of the nomenclature that the formulas of a derivation need."""
        shown = symbols_of(derivation, words=False)
        rows = {
            each.latex: each
            for each in (*self.nomenclature, *self.chapters.get(derivation.section, ()))
        }
        return tuple(row for latex, row in rows.items() if latex in shown)


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
    columns: int = 1,
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
    shown = {each.section: dict[str, None]() for each in chosen}
    for each in chosen:
        shown[each.section] |= symbols_of(each)
    new = dict(notation or {})
    check_letters(new, {symbol for found in shown.values() for symbol in found})
    own = {symbol.latex for symbol in symbols}
    origins = introductions(derivations)
    rows = {
        row.latex: row
        if row.source is not None
        else replace(row, source=origins.get(row.latex, ""))
        for row in (*(row for row in SYMBOLS if row.latex not in own), *symbols)
    }
    letters = {section: _letters(section, derivations, new) for section in shown}
    common = _common(shown, letters)
    chapters = {
        section: tuple(
            _row_in_letters(row, letters[section].get)
            for latex, row in rows.items()
            if latex in found and latex not in common
        )
        for section, found in shown.items()
    }
    everywhere = next(iter(letters.values()), {}) if len(letters) == 1 else new
    return Edition(
        derivations=tuple(_in_letters(each, letters[each.section].get) for each in chosen),
        nomenclature=tuple(
            _row_in_letters(row, everywhere.get) for latex, row in rows.items() if latex in common
        ),
        chapters=chapters,
        command=command,
        version=version,
        title=title,
        values={everywhere.get(symbol, symbol): value for symbol, value in (values or {}).items()},
        scene=scene,
        conditions={each.label: _words(domain(each), letters[each.section].get) for each in chosen},
        label_prefix=label_prefix,
        columns=columns,
    )


def _letters(
    section: str, derivations: Iterable[Derivation], notation: Mapping[str, str]
) -> dict[str, str]:
    """Return the letters of a section: those of the user, else without the accents that it does not need."""
    shown = dict[str, None]()
    for each in derivations:
        shown |= symbols_of(each) if each.section == section else {}
    found = {symbol: notation[symbol] for symbol in shown if symbol in notation}
    taken = {*_TAKEN, *notation.values(), *(symbol for symbol in shown if symbol not in notation)}
    for symbol in shown:
        bare = _ACCENT.sub("", symbol)
        if symbol not in notation and bare not in taken:
            found[symbol] = bare
            taken.add(bare)
    return found


def _common(
    shown: Mapping[str, Collection[str]], letters: Mapping[str, Mapping[str, str]]
) -> set[str]:
    """Return the symbols of the nomenclature: of one section all, else those that several print alike."""
    count = Counter(symbol for found in shown.values() for symbol in found)
    if len(shown) <= 1:
        return set(count)
    forms: dict[str, set[str]] = {}
    for section, found in shown.items():
        for symbol in found:
            forms.setdefault(symbol, set()).add(letters[section].get(symbol, symbol))
    least = 1 if len(count) <= _SHORT else _USUAL
    return {
        symbol
        for symbol, printed in forms.items()
        if count[symbol] >= least and len(printed) == 1 and not _ACCENT.match(symbol)
    }


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
        premises=tuple(replaced(each, new) for each in derivation.premises),
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
