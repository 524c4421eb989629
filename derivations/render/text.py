r"""The common part of the renderers: the text of a record and the order of its steps.

>>> for piece in pieces(r"by Eq. (27), $\mu > 0$", {"eq27"}):
...     print([piece.kind, piece.content, piece.target])
['words', 'by Eq. ', '']
['link', '(27)', 'eq27']
['words', ', ', '']
['math', '\\mu > 0', '']
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from ..engine.record import Calculation, Derivation, Step
from .inline import inline

_REFERENCE = re.compile(
    r"\((?P<eq>\d+)\)|\((?P<name>[a-z][a-z0-9]*(?:-[a-z0-9]+)*)\)"
    r"|\bF(?P<F>\d+(?:-[a-z0-9]+)*)\b|\bTable (?P<table>\d+)"
)
"""How text names a derivation; the name of the group and the digits make its label."""

_ONE_EQUATION = re.compile(r"Eq\. \(\d+\)")

_TOKEN = re.compile(
    r"(?P<open>(?<!\\)\{|\\left(?![a-z]))|(?P<close>(?<!\\)\}|\\right(?![a-z]))"
    r"|=|<|>|\\(?:le|ge|lt|gt|approx|sim|equiv)(?![a-z])"
)
"""The opening of a group, its end, and a relation."""

_GLYPH = re.compile(
    r"\\(?:left|right|frac|sqrt|mathrm|text|[,;:! ])(?![A-Za-z])|(?P<seen>\\[A-Za-z]+|[^\s{}_^\\])"
)
_LETTER_GLYPHS, _FEW_GLYPHS, _MOST_GLYPHS = 5, 16, 50
"""A formula of few glyphs is repeated rather than cited; one of more would fill a line of text."""

_TALL = re.compile(r"\\(?:int|sum|begin)(?![a-z])")
"""An integral, a sum or cases: too tall for a line of text."""


@dataclass(frozen=True)
class Piece:
    """A piece of text: words, mathematics, or a link to the derivation `target`."""

    kind: str
    content: str
    target: str = ""


@dataclass(frozen=True)
class Line:
    """A displayed step and its number, which only the result has."""

    step: Step
    tag: str = ""


@dataclass(frozen=True)
class Given:
    """Consecutive steps that are printed in one sentence, and the mark that ends it."""

    steps: tuple[Step, ...]
    end: str


def pieces(text: str, labels: Collection[str]) -> Iterator[Piece]:
    """Split text into words, mathematics between dollar signs, and links to known labels."""
    parts = text.split("$")
    if len(parts) % 2 == 0:
        raise ValueError(f"a dollar sign without its partner in the text {text!r}")
    for index, part in enumerate(parts):
        yield from [Piece("math", inline(part))] if index % 2 else _words(part, labels)


def _words(text: str, labels: Collection[str]) -> Iterator[Piece]:
    start = 0
    for match in _REFERENCE.finditer(text):
        kind = match.lastgroup or ""
        label = f"{kind if kind != 'name' else ''}{match[kind]}"
        if label in labels:
            yield Piece("words", text[start : match.start()])
            yield Piece("link", match[0], label)
            start = match.end()
    if text[start:]:
        yield Piece("words", text[start:])


def by_section(derivations: Sequence[Derivation]) -> dict[str, list[Derivation]]:
    """Group the derivations by section, in the order in which the sections first appear."""
    sections: dict[str, list[Derivation]] = {}
    for derivation in derivations:
        sections.setdefault(derivation.section, []).append(derivation)
    return sections


def number(label: str) -> str:
    """Return the number in parentheses beside a result: 27 for eq27, F3, Table 2 for table2."""
    return re.sub("^table", "Table ", label.removeprefix("eq"))


def reference(label: str) -> str:
    """Return the usual name of a derivation, in a form that `pieces` turns into a link.

    >>> [reference(label) for label in ("eq27", "F3", "table2", "scaling")]
    ['Eq. (27)', 'F3', 'Table 2', '(scaling)']
    """
    shown = number(label)
    named = shown if shown[:1].isupper() else f"({shown})"
    return f"Eq. {named}" if shown.isdigit() else named


def calculation(numbers: Calculation) -> str:
    """Return a calculation as a chain of equalities."""
    parts = [numbers.symbol, numbers.formula, numbers.substituted, numbers.shown]
    return " = ".join(part for part in dict.fromkeys(parts) if part)


def relations(latex: str) -> list[str]:
    r"""Split a chain of relations in front of each, where a line may be broken.

    >>> relations(r"W = \int_{a = 0}^{b} p = \left(b = c\right) \le 1")
    ['W', '= \\int_{a = 0}^{b} p', '= \\left(b = c\\right)', '\\le 1']
    """
    links, start, depth = [], 0, 0
    for token in _TOKEN.finditer(latex):
        if token["open"]:
            depth += 1
        elif token["close"]:
            depth -= 1
        elif depth == 0:
            links.append(latex[start : token.start()].strip())
            start = token.start()
    return [*links, latex[start:].strip()]


def blocks(
    derivation: Derivation, before: Mapping[str, Derivation] | None = None
) -> Iterator[Given | Line]:
    """Arrange the steps: premises in sentences, proved steps and the result in lines.

    Premises are definitions and steps recalled from elsewhere; those too large for a sentence
    have a separate line. Long results that were printed `before` are cited, not repeated; of lines with
    one reason the first has it.
    """
    printed = [_short(line, before or {}) for line in _lines(derivation)]
    for is_given, group in groupby(printed, key=_is_given):
        members = list(group)
        if is_given:
            end = "." if members[-1] is printed[-1] else ","
            yield Given(tuple(line.step for line in members), end)
            continue
        last = ""
        for line in members:
            step = line.step
            again = step.reason == last and not (step.source or step.note or step.domain)
            yield replace(line, step=replace(step, reason="")) if again else line
            last = step.reason


def sentence(given: Given, labels: Collection[str]) -> Iterator[Piece]:
    """Return the sentence of the premises for the line that follows.

    A remark shared by several consecutive formulas is printed after the last of them.
    """
    remarks = [(step.source, step.reason) for step in given.steps]
    last = len(given.steps) - 1
    for index, (step, (source, reason)) in enumerate(zip(given.steps, remarks, strict=True)):
        yield Piece("words", "With " if index == 0 else " and " if index == last else ", ")
        if not step.left:
            yield citation(source, labels)
            continue
        yield Piece("math", inline(conclusion(step) if step.relation else step.left))
        if step.domain:
            yield from (Piece("words", " for "), Piece("math", inline(step.domain)))
        following = given.steps[index + 1] if index < last else step
        if index < last and following.left and remarks[index + 1] == (source, reason):
            continue
        if source:
            yield from (Piece("words", " "), citation(source, labels))
        if reason:
            known = (
                reason.removeprefix("Eq. ") if _ONE_EQUATION.fullmatch(reason) else f"({reason})"
            )
            yield from (Piece("words", " "), *pieces(known, labels))
    yield Piece("words", given.end)


def remark(step: Step, labels: Collection[str]) -> Iterator[Piece]:
    """Return the origin of a displayed step, its reason, and its domain: what stands after the formula."""
    if step.source:
        yield from (citation(step.source, labels), Piece("words", " "))
    yield from pieces(step.reason, labels)
    if step.note:
        yield from (Piece("words", ", " if step.reason else ""), *pieces(step.note, labels))
    elif step.domain:
        yield from (
            Piece("words", " (for "),
            Piece("math", inline(step.domain)),
            Piece("words", ")"),
        )


def further(derivation: Derivation) -> list[str]:
    """Return the labels on which a derivation rests besides those that its lines name."""
    named = {step.source for step in derivation.steps}
    return [label for label in derivation.uses if label not in named]


def citation(label: str, labels: Collection[str]) -> Piece:
    """Return the number of a derivation in parentheses, a link where the derivation is printed."""
    shown = f"({number(label)})"
    return Piece("link", shown, label) if label in labels else Piece("words", shown)


def _short(line: Line, before: Mapping[str, Derivation]) -> Line:
    """Leave out what is long and was printed before: its number or its letter says as much."""
    step = line.step
    source = before.get(step.source)
    if source is None or step.claim is None or _glyphs(conclusion(step)) <= _FEW_GLYPHS:
        return line
    sides = step.claim.lhs, step.claim.rhs
    printed = [
        each for each in source.steps if each.claim and (each.claim.lhs, each.claim.rhs) == sides
    ]
    if any(each.latex == source.latex for each in printed):
        return replace(line, step=replace(step, left="", relation="", right=""))
    if any(not each.source for each in printed) and _glyphs(step.left) <= _LETTER_GLYPHS:
        return replace(line, step=replace(step, relation="", right=""))
    return line


def _glyphs(latex: str) -> int:
    """Count what is seen of a formula."""
    return sum(bool(each["seen"]) for each in _GLYPH.finditer(latex))


def _is_given(line: Line) -> bool:
    step = line.step
    if not step.relation:
        return not line.tag and bool(step.source)
    if line.tag or not (step.source or step.status == "definition"):
        return False
    latex = inline(conclusion(step))
    return not _TALL.search(latex) and _glyphs(latex) <= _MOST_GLYPHS


def conclusion(step: Step) -> str:
    """Return the step, without the middle where a chain of equalities is recalled."""
    links = relations(step.latex)
    is_chain = all(link.startswith("=") for link in links[1:]) and r"\quad" not in step.latex
    return f"{links[0]} {links[-1]}" if step.source and is_chain else step.latex


def _lines(derivation: Derivation) -> list[Line]:
    """Return the steps with the number of each, which only the result has.

    The result is the step with the same formula; if there is none, an additional line ends the list.
    """
    tag = number(derivation.label)
    found = [Line(step, tag if step.latex == derivation.latex else "") for step in derivation.steps]
    if not any(line.tag for line in found):
        found.append(Line(Step(derivation.latex, "", "", "", derivation.status), tag))
    return found
