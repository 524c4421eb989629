"""The graph of premises and the tables of assumptions, as pieces of HTML made from the records."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

import sympy as sp
from kvtheory.derivations.catalogue import SYMBOLS
from kvtheory.derivations.engine.book import tex
from kvtheory.derivations.engine.letters import letters, printed
from kvtheory.derivations.engine.record import Claim, Derivation, Step
from kvtheory.derivations.labels import closure
from kvtheory.derivations.render.edition import symbols_of
from kvtheory.derivations.render.html import mathml
from kvtheory.derivations.render.notation import plain
from kvtheory.derivations.render.text import by_section, reference
from sympy.core.function import AppliedUndef

from generators.labels import anchor_of, page_of

SIGNS = {
    "positive": "> 0",
    "negative": "< 0",
    "nonnegative": r"\ge 0",
    "integer": r"\in \mathbb{Z}",
}
"""What may be assumed of a symbol; the first that holds says the rest."""
SHOWN = 8
"""Most links in a cell that is not folded."""

Links = Mapping[str, Sequence[str]]
Stated = Callable[[Derivation], Mapping[str, str]]
"""The assumptions that a record states itself, with words."""


@dataclass
class Assumption:
    """An assumption, and the records that use it directly, or through their premises."""

    latex: str
    words: str = ""
    direct: set[str] = field(default_factory=set)
    through: set[str] = field(default_factory=set)


def pages(derivations: Sequence[Derivation]) -> dict[str, str]:
    """Return the graph, the lists beside it, and a table for each kind of assumption."""
    graph, lists = _graph(derivations)
    reading = [each.label for each in derivations]
    kinds = {name: _table(found, reading) for name, found in assumptions(derivations).items()}
    return {
        f"premises/{name}.html": text
        for name, text in {"graph": graph, "lists": lists, **kinds}.items()
    }


def assumptions(derivations: Sequence[Derivation]) -> dict[str, list[Assumption]]:
    """Return the assumptions of each kind, those on which most results rest first."""
    by_label = {each.label: each for each in derivations}
    uses = {each.label: each.uses for each in derivations}
    ordered = [by_label[label] for label in closure(uses, uses)]  # premises before results
    letter, signs = {each.label: _signs(each) for each in ordered}, {}
    for each in ordered:
        signs[each.label] = {*letter[each.label]}.union(*(signs[use] for use in each.uses))
    premises = {latex for each in derivations for latex in each.premises}
    given = {each.label: dict(_given(each)) for each in ordered}
    steps = [step for each in given.values() for step in each.items()]
    names = {
        k
        for k, step in steps
        if k in premises and step.claim.check == "define" and step.claim.lhs.is_Symbol
    }
    meanings = {row.latex: row.meaning for row in SYMBOLS}

    def stated(among: set[str]) -> Stated:
        return lambda record: {k: s.reason for k, s in given[record.label].items() if k in among}

    def meant(record: Derivation) -> dict[str, str]:
        return {sign: meanings.get(symbol, "") for sign, symbol in letter[record.label].items()}

    return {
        "laws": _index(ordered, stated(premises - names), lambda each: {*each.premises} - names),
        "ranges": _index(ordered, _ranges, lambda each: each.domain),
        "signs": _index(ordered, meant, lambda each: signs[each.label]),
        "definitions": _index(ordered, stated(names), lambda each: {*each.premises} & names),
    }


def _index(
    ordered: Sequence[Derivation], stated: Stated, rests: Callable[[Derivation], Iterable[str]]
) -> list[Assumption]:
    found: dict[str, Assumption] = {}
    for record in ordered:
        own = stated(record)
        for latex in {*own, *rests(record)}:
            one = found.setdefault(latex, Assumption(latex))
            one.words = one.words or own.get(latex, "")
            inherited = (one.direct | one.through) & {*record.uses}
            (one.through if inherited and latex not in own else one.direct).add(record.label)
    return sorted(found.values(), key=lambda one: (-len(one.direct | one.through), one.latex))


def _own(record: Derivation) -> Iterator[tuple[Step, Claim]]:
    """Yield the steps that are not recalled, with what was asked."""
    yield from ((step, step.claim) for step in record.steps if step.claim and not step.source)


def _given(record: Derivation) -> Iterator[tuple[str, Step]]:
    """Yield the equations that the steps of a record assume, in LaTeX."""
    for step, claim in _own(record):
        if claim.check == "define":
            yield step.latex, step
        elif claim.check == "integral":  # a name for an integral, and its value
            yield step.latex.rpartition(" = ")[0], step
        elif claim.check == "root":
            zero = claim.arguments["expr"].subs(claim.arguments["variable"], claim.lhs)
            yield f"{_tex(zero, record)} = 0", step


def _ranges(record: Derivation) -> dict[str, str]:
    """Return the inequalities and intervals that the steps of a record state, the former with reasons."""
    found = {step.domain: "" for step, _ in _own(record) if step.domain}
    return found | {s.latex: s.reason for s, claim in _own(record) if claim.check == "where"}


def _signs(record: Derivation) -> dict[str, str]:
    """Return the signs of the symbols and functions that the steps of a record check, and their letters."""
    found = {}
    for _, claim in _own(record):
        for side in (claim.lhs, claim.rhs, *claim.arguments.values()):
            parts = (
                side.free_symbols | side.atoms(AppliedUndef) if isinstance(side, sp.Basic) else ()
            )
            for part in sorted(parts, key=str):
                kind = next((kind for kind in SIGNS if getattr(part, f"is_{kind}")), "")
                if kind and not isinstance(part, sp.Dummy):
                    letter = _tex(part, record)
                    found[f"{letter} {SIGNS[kind]}"] = letter
    return found


def _tex(expr: sp.Expr, record: Derivation) -> str:
    return printed(tex(expr), letters(record.label, record.section))


def _graph(derivations: Sequence[Derivation]) -> tuple[str, str]:
    """Return the graph, and what each record rests on and is used by as lists."""
    places = {row.latex: index for index, row in enumerate(SYMBOLS)}
    uses = {each.label: each.uses for each in derivations}
    used = {label: [each for each in uses if label in uses[each]] for label in uses}
    chips, choices, lists = "", "", ""
    for section, members in by_section(derivations).items():
        head, chip, choice, entry = escape(section), "", "", ""
        for each in members:
            name, symbols = (
                f"{each.label}: {escape(each.title)}",
                sorted(places[symbol] for symbol in symbols_of(each, words=False)),
            )
            chip += f'<a href="#of-{each.label}" data-label="{each.label}" data-uses="{" ".join(each.uses)}" '
            chip += f'data-symbols="{" ".join(map(str, symbols))}" title="{name}">{each.label}</a> '
            choice += f'<option value="{each.label}">{name}</option>'
            page = f"../generated/theory/{page_of(section)}.html#{anchor_of(each.label)}"
            link = f'<a href="{page}">{reference(each.label)}</a> {escape(each.title)}'
            before, after = _near_and_far(each.label, uses), _near_and_far(each.label, used)
            entry += (
                f'<dt id="of-{each.label}">{link}</dt><dd>Rests on {before}. Used by {after}.</dd>'
            )
        chips += f"<section><h3>{head}</h3><p>{chip}</p></section>"
        choices += f'<optgroup label="{head}">{choice}</optgroup>'
        lists += f"<h3>{head}</h3><dl>{entry}</dl>"
    symbols = sorted((plain(row.latex), escape(row.meaning.partition("$")[0].rstrip(", ")), places[row.latex])
                     for row in SYMBOLS)  # fmt: skip
    names = "".join(
        f'<option value="{place}">{name}: {meaning}</option>' for name, meaning, place in symbols
    )
    return (
        f"{_FORM.format(choices=choices, names=names)}<div class='map'><svg></svg>{chips}</div></div>",
        lists,
    )


_FORM = """<div id="premises"><form hidden>
<label>Record <select name="record"><option value="">all</option>{choices}</select></label>
<label>Symbol <select name="symbol"><option value="">all</option>{names}</select></label>
<button type="reset">Show all</button> <output></output></form>"""


def _near_and_far(label: str, links: Links) -> str:
    near, found = links[label], closure([label], links)
    far = [each for each in links if each in found and each not in (label, *near)]
    more = f" <details><summary>and through these {len(far)} more</summary>{_links(far)}</details>"
    return (_links(near) or "none") + (more if far else "")


def _table(found: Iterable[Assumption], reading: Sequence[str]) -> str:
    rows = ""
    for one in found:
        parts = enumerate(one.words.split("$"))
        words = "".join(mathml(part) if index % 2 else escape(part) for index, part in parts)
        near, far = (
            _folded([label for label in reading if label in each])
            for each in (one.direct, one.through)
        )
        cells = f"<div>{mathml(one.latex)}</div>", words, near, far
        rows += f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
    heads = "<th>assumption</th><th>in words</th><th>used by</th><th>through premises</th>"
    return f'<table class="assumptions table"><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'


def _folded(labels: Sequence[str]) -> str:
    links, many = _links(labels, "premises.html"), len(labels) > SHOWN
    return f"<details><summary>{len(labels)} records</summary>{links}</details>" if many else links


def _links(labels: Iterable[str], page: str = "") -> str:
    return ", ".join(f'<a href="{page}#of-{label}">{label}</a>' for label in labels)
