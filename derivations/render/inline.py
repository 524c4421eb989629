r"""Mathematics in a line of text: a fraction is written with a slash, so that the line stays low.

>>> inline(r"h(x) = \frac{x^{2}}{2 R} - \frac{1}{2}")
'h(x) = x^{2}/(2 R) - 1/2'
>>> inline(r"w = \frac{K a}{3 R} \left(1 + \frac{l}{a}\right) + \sqrt{\frac{W}{K}}")
'w = K a (1 + l/a)/(3 R) + \\sqrt{W/K}'
"""

import re
from collections.abc import Iterator
from itertools import pairwise

_PIECE = re.compile(
    r"(?P<frac>\\frac(?![A-Za-z]))|(?P<open>\{|\((?!\))|\[|\\left(?![a-z])\s*(?:\\?.))"
    r"|(?P<close>\}|\)|\]|\\right(?![a-z])\s*(?:\\?.))"
    r"|(?P<relation>[=<>,;]|\\(?:le|ge|neq|to|in|ll|gg|sim|approx|equiv|iff|quad|qquad|propto|ldots|cdots)(?![a-z]))"
    r"|(?P<sign>[+-]|\\pm(?![a-z]))|(?P<script>[\^_])|(?P<space>\s+|\\[,;! ])|(?P<other>\\[A-Za-z]+|.)",
    re.S,
)
_OPERATOR = re.compile(r"(?:\\mathrm\{d\}|\\partial|d)\s*(?:\^\{?\d\}?)?\s*$")
_STAYS = re.compile(
    r"/|^\\left\.|\\(?:int|sum|ln|exp|log|max|min|sin|cos|tan|arctan|operatorname|partial)(?![a-z])"
)
"""What takes in all that follows it."""
_CALLED = re.compile(r"\((?:\d|[A-Za-z]|\\[a-z]+)\)")
"""A place where a function is taken; a factor in brackets is a sum."""
_ACCENTS = (
    r"\mathsf",
    r"\mathbf",
    r"\sqrt",
    r"\bar",
    r"\hat",
    r"\tilde",
    r"\breve",
    r"\check",
    r"\dot",
    r"\mathrm",
    r"\mathrm{d}",
)
"""What makes one factor with the next piece."""


def inline(latex: str) -> str:
    """Return mathematics without fractions that have a line, where they can do without."""
    return _sum(latex) if r"\frac" in latex and r"\begin" not in latex else latex


def _tokens(latex: str) -> Iterator[tuple[str, str]]:
    """Split into pieces: what stands in brackets, or above and below a line, is one."""
    place = 0
    while place < len(latex):
        token = _PIECE.match(latex, place)
        assert token is not None
        kind, start = token.lastgroup or "", place
        place = token.end()
        if kind == "frac":
            place = _end(latex, _end(latex, place))
        elif kind == "open":
            place = _end(latex, start)
        elif kind == "script":
            place = _end(latex, place)
        yield kind, latex[start:place]


def _end(latex: str, place: int) -> int:
    """Return where the group, or the one token, ends that begins at a place."""
    depth = 0
    while place < len(latex):
        token = _PIECE.match(latex, place)
        assert token is not None
        depth += (token.lastgroup == "open") - (token.lastgroup == "close")
        place = token.end()
        if depth <= 0 and token.lastgroup != "space":
            return place
    return place


def _sum(latex: str) -> str:
    """Write the terms of a sum, and what stands between relations, in turn."""
    shown, term = [], list[tuple[str, str]]()
    for kind, text in _tokens(latex):
        if kind in ("relation", "sign"):
            shown += [_term(term), text]
            term = []
        else:
            term.append((kind, text))
    return "".join([*shown, _term(term)])


def _term(pieces: list[tuple[str, str]]) -> str:
    """Write a product as one fraction with a slash, unless it has a derivative, an integral or a function."""
    fractions = [_parts(text) for kind, text in pieces if kind == "frac"]
    others = " ".join(text for kind, text in pieces if kind in ("other", "open"))
    raised = any(one == "frac" and other == "script" for (one, _), (other, _) in pairwise(pieces))
    if (
        not fractions
        or raised
        or _STAYS.search(others)
        or any(_OPERATOR.match(each[0]) for each in fractions)
    ):
        return "".join(_inner(*each) for each in pieces)
    lone = all(kind in ("frac", "space") for kind, _ in pieces) and len(fractions) == 1
    parts = [
        _bracketed(_sum(_parts(text)[0])) if kind == "frac" else _inner(kind, text)
        for kind, text in pieces
    ]
    above = "".join(
        "" if part == "1" and not lone else f" {part} " if kind == "frac" else part
        for (kind, _), part in zip(pieces, parts, strict=True)
    )
    shown = [_sum(each[1]) for each in fractions]
    below = " ".join(map(_bracketed, shown) if len(shown) > 1 else shown)
    below = below if len(_factors(below)) == 1 and not _is_sum(below) else f"({below})"
    tail = "".join(text for kind, text in pieces[-1:] if kind == "space")
    lead = "".join(text for kind, text in pieces[:1] if kind == "space")
    return f"{lead}{' '.join(above.split()) or '1'}/{below}{tail}"


def _inner(kind: str, text: str) -> str:
    """Write what stands in brackets or scripts on one line, too."""
    if kind == "frac":
        above, below = _parts(text)
        return rf"\frac{{{_sum(above)}}}{{{_sum(below)}}}"
    if kind == "script":
        return text[0] + (f"{{{_sum(text[2:-1])}}}" if text[1:2] == "{" else text[1:])
    if kind != "open":
        return text
    first, last = next(iter(_PIECE.finditer(text)))[0], list(_PIECE.finditer(text))[-1][0]
    inner = _sum(text[len(first) : len(text) - len(last)])
    if (
        first.startswith(r"\left")
        and first[-1] in "(["
        and not re.search(r"\\(?:frac|int|sum|left)", inner)
    ):
        first, last = first[-1], last[-1]
    return f"{first}{inner}{last}"


def _parts(fraction: str) -> tuple[str, str]:
    middle = _end(fraction, len(r"\frac"))
    above, below = fraction[len(r"\frac") : middle].strip(), fraction[middle:].strip()
    return above.removeprefix("{").removesuffix("}"), below.removeprefix("{").removesuffix("}")


def _is_sum(latex: str) -> bool:
    return any(kind == "sign" for kind, _ in list(_tokens(latex.strip()))[1:])


def _bracketed(latex: str) -> str:
    divided = any(text == "/" for _, text in _tokens(latex))
    return f"({latex})" if divided or _is_sum(latex) else latex


def _factors(latex: str) -> list[str]:
    """Return the factors of a product, each with its scripts."""
    found: list[str] = []
    for kind, text in _tokens(latex.strip()):
        glued = (
            kind in ("script", "space")
            or text == "'"
            or (found and found[-1][-1:].strip() and _CALLED.fullmatch(text))  # f(x)
            or (found and re.fullmatch(r"\\sqrt\[\d\]", found[-1]))
            or (text.isdigit() and found and found[-1][-1:].isdigit())
        )
        if (glued and found) or (found and found[-1].strip() in _ACCENTS):
            found[-1] += text
        else:
            found.append(text)
    return [each for each in found if each.strip()]
