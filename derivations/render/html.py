"""Derivations as one HTML page: MathML, no script, nothing loaded from elsewhere."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape

from latex2mathml.converter import convert

from ..engine.record import Calculation, Derivation, Table
from . import frame
from .breaking import cut_at_brackets, cut_at_signs, opened, width
from .edition import Edition
from .pdf import RenderError
from .style import STYLE
from .text import (
    Given,
    Line,
    Piece,
    by_section,
    calculation,
    citation,
    further,
    number,
    pieces,
    relations,
    remark,
    sentence,
)

_CORRECTIONS = (
    (re.compile("<mi>&#x0007E;</mi>"), "<mo>&#x0223C;</mo>"),  # \sim
    # A browser sets a single letter in italics. Upright are the capital Greek ones and, where the
    # converter writes a Latin letter as a character reference, that one (\mathrm).
    (re.compile(r"<mi>(&#x00(?:0[4-7]|39|3A)[0-9A-F];)</mi>"), r'<mi mathvariant="normal">\1</mi>'),
    (re.compile("<mi>(&#x027F[8-A];)</mi>"), r"<mo>\1</mo>"),  # \iff and its halves
    (re.compile("<mo>(&#x0221E;)</mo>"), r"<mi>\1</mi>"),  # \infty
    (re.compile('<mo [^>]*fence="true"[^>]*/>'), ""),  # \left. takes no room
    # TeX sets a star as low as an operator.
    (re.compile("<mo>&#x0002A;</mo>"), "<mo>&#x02217;</mo>"),
    (re.compile("<mo>(/|&#x0002F;)</mo>"), r'<mo lspace="0" rspace="0">\1</mo>'),
    # TeX sets a sign after a relation, a fence or a comma tight, and a function name apart.
    (
        re.compile(r"(<mo[^>]*>&#x0(?:003[CDE]|226[45]|2192|0028|005B|002C);</mo>)<mo>&#x02212;"),
        r'\1<mo form="prefix">&#x02212;',
    ),
    (
        re.compile("<m[io]>(ln|[a-z]{3,})</m[io]>(?=<mo|<mrow><mrow><mo)"),
        r'<mo lspace="0.167em" rspace="0">\1</mo>',
    ),
    (
        re.compile("<m[io]>(ln|[a-z]{3,})</m[io]>"),
        r'<mo lspace="0.167em" rspace="0.167em">\1</mo>',
    ),
    (re.compile("</mfrac><mfrac>"), '</mfrac><mspace width="0.167em" /><mfrac>'),
    (re.compile(' xmlns="[^"]*"'), ""),  # HTML needs none
)
"""What latex2mathml writes, and its correction."""

_NARROW, _SCREEN = 18, 19
"""Widths in em: of a formula that fits on a telephone, and of its screen, for which brackets are opened."""
_SIGN_FIRST = re.compile(r"^((?:<m(?:ath|row)[^>]*>)*<mo)(?=>&#x0(?:002B|2212);)>")
"""A sign at the beginning of what follows in a bracket."""
_PUNCTUATED = re.compile(r"(\((?=<math))?(<math(?:(?!</math>).)*</math>)([.,;:)]+)?")
"""A formula and the punctuation that must stay on its line."""
_TWO_PRIMES = re.compile(r"(_(?:\w|\{[^{}]*\}))''")
"""After an index, where the converter would raise the second prime above the first."""

_LOW_FENCES = re.compile(
    r"\\left([(\[])((?:(?!\\left|\\right|\\frac|\\int|\\sqrt|\\sum).)*)\\right([)\]])"
)
"""Fences around nothing tall: a browser puts gaps beside fences that may stretch."""


def document(edition: Edition) -> str:
    """Return the complete page."""
    derivations, labels = edition.derivations, edition.labels
    sections = by_section(derivations)
    body = "\n".join(
        [
            _header(edition),
            _contents(sections),
            "<main>",
            '<section id="nomenclature"><h2>Nomenclature</h2>',
            f"<p>{_text(frame.MARKS, labels)}</p>",
            _table(edition.table(), labels),
            "</section>",
            *(
                _section(index, section, members, edition)
                for index, (section, members) in enumerate(sections.items(), start=1)
            ),
            "</main>",
            f'<footer id="source"><h2>Source</h2><p>{escape(frame.SOURCE)} '
            f'<a href="https://doi.org/{frame.DOI}">doi: {frame.DOI}</a></p></footer>',
        ]
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(edition.title)}</title>\n<style>\n{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def mathml(latex: str, display: str = "inline") -> str:
    r"""Return the mathematics as MathML.

    >>> mathml(r"l_{\mathrm{r}}")[:47]
    '<math display="inline"><mrow><msub><mi>l</mi><m'

    Raises
    ------
    RenderError
        For a macro that the converter does not know; it would print its name.
    """
    plain = _TWO_PRIMES.sub(r"\1^{\\prime\\prime}", _with_low_fences(latex))
    found = str(convert(plain, display=display))
    unknown = re.search(r"<m[ion]>(\\[^<]*)", found)
    if unknown:
        raise RenderError(f"no MathML for the macro {unknown[1]} in {latex}")
    for wrong, right in _CORRECTIONS:
        found = wrong.sub(right, found)
    return found


def _with_low_fences(latex: str) -> str:
    lowered, changes = _LOW_FENCES.subn(r"\1\2\3", latex)
    return _with_low_fences(lowered) if changes else lowered


def _header(edition: Edition) -> str:
    told = [*frame.INTRODUCTION, *([frame.numbers_of(edition.scene)] if edition.scene else [])]
    paragraphs = [f"<p>{_text(paragraph, edition.labels)}</p>" for paragraph in told]
    meanings = [
        f"<dt>{_badge(status)}</dt><dd>{status}: {escape(meaning)}</dd>"
        for status, meaning in frame.VOCABULARY.items()
    ]
    version = f"kvtheory {edition.version}".strip()
    made = f"<p>Made by {escape(version)}: <code>{escape(edition.command)}</code></p>"
    return "\n".join(
        [
            f"<header><h1>{escape(edition.title)}</h1>",
            *paragraphs,
            f'<dl class="vocabulary">{"".join(meanings)}</dl>{made if edition.command else ""}</header>',
        ]
    )


def _contents(sections: dict[str, list[Derivation]]) -> str:
    entries = ['<li><a href="#nomenclature">Nomenclature</a></li>']
    for index, (section, members) in enumerate(sections.items(), start=1):
        links = "".join(
            f'<li><a href="#{each.label}"><span class="number">({number(each.label)})</span> '
            f"<span>{_text(each.title, ())}</span></a></li>"
            for each in members
        )
        entries.append(
            f'<li><a href="#section-{index}">{_text(section, ())}</a><ul>{links}</ul></li>'
        )
    entries.append('<li><a href="#source">Source</a></li>')
    return f'<nav aria-label="Contents"><h2>Contents</h2><ul>{"".join(entries)}</ul></nav>'


def _section(index: int, section: str, members: Sequence[Derivation], edition: Edition) -> str:
    articles = [_article(each, edition) for each in members]
    heading = f'<section id="section-{index}"><h2>{_text(section, ())}</h2>'
    own = edition.chapter_table(section)
    return "\n".join(
        [heading, *([_table(own, edition.labels)] if own.rows else []), *articles, "</section>"]
    )


def _article(derivation: Derivation, edition: Edition) -> str:
    labels = edition.labels
    users = [each.label for each in edition.derivations if derivation.label in each.uses]
    parts = [
        f'<article id="{derivation.label}">',
        f'<h3><a href="#{derivation.label}">({number(derivation.label)})</a> '
        f"{_text(derivation.title, ())}</h3>",
        f"<p>{_text(derivation.text, labels)}</p>" if derivation.text else "",
        '<ol class="steps">',
        *(_block(block, labels) for block in edition.blocks(derivation)),
        "</ol>",
        f'<p class="domain">{_text(holds, labels)}</p>'
        if (holds := edition.domain(derivation))
        else "",
        _numbers(derivation.numbers, labels),
        _table(derivation.table, labels) if derivation.table else "",
        _related({"Rests also on": further(derivation), "Used by": users}, labels),
        "</article>",
    ]
    return "\n".join(part for part in parts if part)


def _block(block: Given | Line, labels: Collection[str]) -> str:
    if isinstance(block, Given):
        return f'<li class="given">{_printed(sentence(block, labels))}</li>'
    shown = f'<span class="number">({block.tag})</span>' if block.tag else ""
    badge, reason = _badge(block.step.status), _printed(remark(block.step, labels))
    chain = _chain(block.step.latex, "" if reason else badge)
    return (
        f'<li class="{"result" if block.tag else "step"}">'
        f'<div class="line"><div class="scroll">{chain}</div>'
        + (f'<p class="reason">{reason}&#160;{badge}</p>' if reason else "")
        + f"</div>{shown}</li>"
    )


def _chain(latex: str, end: str = "") -> str:
    """Return a displayed relation; the last of its pieces has the end."""
    shown = _broken(latex, "block")
    if end:
        shown[-1] = f'<span class="end">{shown[-1]} {end}</span>'
    return "".join(shown)


def _broken(latex: str, display: str) -> list[str]:
    """Return mathematics in terms, between which a browser may break the line; else before a bracket."""
    shown = []
    for link in relations(latex):
        for place, each in enumerate(cut_at_signs(link, _NARROW)):
            first, *rest = (
                _SIGN_FIRST.sub(r'\1 form="infix">', mathml(piece, display))
                if piece.startswith(r"\left.")
                else mathml(piece, display)
                for part in cut_at_brackets(each, _NARROW)
                for piece in (opened(part, _SCREEN) if width(part) > _SCREEN else [part])
            )
            # Else a sign at the beginning would be that of a number, without space about it.
            first = first.replace("<mo>", '<mo form="infix">', 1) if place else first
            shown.append(f'<span class="term">{first}{"".join(rest)}</span>' if rest else first)
    return shown


def _numbers(numbers: Sequence[Calculation], labels: Collection[str]) -> str:
    """Return the closed forms with the numbers of a scene."""
    lines = "".join(
        f'<li class="step"><div class="line"><div class="scroll">'
        f"{_chain(calculation(each))}</div>"
        f'<p class="reason">{_text(each.note, labels)}</p></div></li>'
        for each in numbers
    )
    return f'<p>{frame.WITH_NUMBERS}</p><ol class="steps numbers">{lines}</ol>' if lines else ""


def _related(related: Mapping[str, Collection[str]], labels: Collection[str]) -> str:
    lists = [
        f"<span>{words} {', '.join(_printed([citation(each, labels)]) for each in listed)}</span>"
        for words, listed in related.items()
        if listed
    ]
    return f'<p class="related">{" ".join(lists)}</p>' if lists else ""


def _badge(status: str) -> str:
    return f'<span class="status {status}" title="{status}">{frame.SIGNS[status]}</span>'


def _table(table: Table, labels: Collection[str]) -> str:
    heads = "".join(f'<th scope="col">{_text(head, labels)}</th>' for head in table.heads)
    rows = "".join(
        f"<tr>{''.join(f'<td>{_text(cell, labels)}</td>' for cell in row)}</tr>\n"
        for row in table.rows
    )
    return (
        f'<div class="scroll"><table><thead><tr>{heads}</tr></thead>\n'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _text(text: str, labels: Collection[str]) -> str:
    return _printed(pieces(text, labels))


def _printed(content: Iterable[Piece]) -> str:
    printed = {
        "words": lambda piece: escape(piece.content),
        "math": lambda piece: "".join(_broken(piece.content, "inline")),
        "link": lambda piece: f'<a href="#{piece.target}">{escape(piece.content)}</a>',
    }
    shown = "".join(printed[piece.kind](piece) for piece in content)
    return _PUNCTUATED.sub(_unbroken, shown)


def _unbroken(formula: re.Match[str]) -> str:
    marked = formula[1] or formula[3]
    return f'<span class="unbroken">{formula[0]}</span>' if marked else formula[0]
