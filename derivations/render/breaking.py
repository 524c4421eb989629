r"""Formulas wider than a line, broken as by hand: at relations, then at plus and minus.

>>> lines(r"\mu = a + b", 30)
['\\mu = a + b']
>>> lines(r"W = \int_{a}^{b} p \, dx = 1 + 2 + 3", 9)
['W &= \\int_{a}^{b} p \\, dx', '&= 1 + 2 + 3']
"""

import re
from itertools import pairwise

from .text import relations

EM = {"relation": 1.4, "sign": 1.25, "letter": 0.58, "digit": 0.5, "fence": 0.5, "operator": 0.9}
"""Widths in em, relations and signs with the space about them, a little more than they measure."""
SCRIPT = 0.72
"""Size of an index or exponent against the text."""

SHORT, INDENT = 0.3, 2.0
"""A left side that takes no more than this share of the line stays in it; indentation in em."""

_LEAST = 4.0
"""Width in em of factors before a bracket that make a line of their own."""

_TOKEN = re.compile(
    r"(?P<frac>\\frac)(?![A-Za-z])|(?P<begin>\\begin\{[a-z*]+\})|(?P<end>\\end\{[a-z*]+\})"
    r"|(?P<relation>[=<>]|\\(?:le|ge|lt|gt|to|sim|approx|equiv|iff)(?![a-z]))|(?P<sign>[+-]|\\cdot)"
    r"|(?P<operator>\\(?:int|sum)(?![a-z]))|(?P<wide>\\q?quad)|(?P<none>\\[,!;: ]|\\(?:left|right|limits"
    r"|mathrm|text|displaystyle|dot|ddot|bar|hat|operatorname|mathsf|mathbf)(?![a-z]))"
    r"|(?P<sqrt>\\sqrt(?:\[.\])?)|(?P<word>\\(?:sin|cos|tan|exp|log|ln|max|min|sup|atan)(?![a-z]))"
    r"|(?P<letter>\\[A-Za-z]+|[A-Za-z])|(?P<digit>[0-9.,'])|(?P<fence>[()\[\]|])"
    r"|(?P<script>[\^_])|(?P<open>\{)|(?P<close>\})|(?P<space>.)",
    re.S,
)
_GROUP = {"open": 1, "close": -1, "begin": 1, "end": -1}
_BEGINNING = re.compile(r"\s*(?:[=<>]|\\(?:le|ge|lt|gt|to|sim|approx|equiv|iff))?\s*")
"""What stands before the first term."""
_FENCED = re.compile(r"\\(left|right)(?![a-z])")


def width(latex: str) -> float:
    """Estimate the width of a displayed formula in em."""
    total, rest = 0.0, latex
    while rest:
        token = _TOKEN.match(rest)
        if token is None:
            return total
        rest = rest[token.end() :]
        kind = token.lastgroup or ""
        if kind in {"frac", "script", "open", "sqrt"}:
            found, rest = _braced(kind, rest)
            total += found
        else:
            total += EM.get(kind, {"wide": 1.5, "word": 1.9}.get(kind, 0.0))
    return total


def _braced(kind: str, rest: str) -> tuple[float, str]:
    """Return the width of what follows a fraction, a root, an index or a brace, and what is left."""
    if kind == "open":
        inner, rest = _group("{" + rest)
        return width(inner), rest
    inner, rest = _group(rest)
    if kind == "frac":
        below, rest = _group(rest)
        return max(width(inner), width(below)) + 0.25, rest
    return (SCRIPT * width(inner), rest) if kind == "script" else (width(inner) + 0.9, rest)


def _group(text: str) -> tuple[str, str]:
    """Split off the group in braces, or the one token, at the beginning."""
    text = text.lstrip()
    if not text.startswith("{"):
        token = re.match(r"\\[A-Za-z]+|.", text)
        end = token.end() if token else 0
        return text[:end], text[end:]
    depth = 0
    for position, character in enumerate(text):
        escaped = position > 0 and text[position - 1] == "\\"
        depth += 0 if escaped else {"{": 1, "}": -1}.get(character, 0)
        if depth == 0:
            return text[1:position], text[position + 1 :]
    return text[1:], ""


def lines(latex: str, most: float) -> list[str]:
    """Return the formula in one line, or in several with the marks of `split` for their alignment.

    Relations stand below each other where the left side is short, else they are set in.
    """
    if width(latex) <= most:
        return [latex]
    left, *links = relations(latex)
    beside = bool(links) and width(left) <= SHORT * most
    room = most - (width(left) if beside else INDENT) - INDENT
    rows = [] if beside else [f"&{term}" for term in _terms(left, most)]
    for link in links:
        first, *rest = _terms(link, room)
        rows += [rf"&{'' if beside else chr(92) + 'quad '}{first}"]
        rows += [rf"&\qquad {term}" for term in rest]
    broken = [f"{left} {rows[0]}", *rows[1:]] if beside else rows
    return broken if all(map(_balanced, broken)) else [latex]


def cut_at_signs(link: str, most: float) -> list[str]:
    r"""Cut one side of a relation before its signs outside brackets, if it is wider than `most`.

    >>> cut_at_signs(r"\le - a + \left(b + c\right) (d - e)", 3), cut_at_signs("a + b", 9)
    (['\\le - a', '+ \\left(b + c\\right) (d - e)'], ['a + b'])
    """
    cuts = _cuts(link, "sign") if width(link) > most else []
    cuts = [
        cut for cut in cuts
        if len(re.findall(r"[(\[]", link[:cut])) == len(re.findall(r"[)\]]", link[:cut]))
    ]  # fmt: skip
    return [link[start:end].strip() for start, end in pairwise([0, *cuts, len(link)])]


def cut_at_brackets(term: str, most: float) -> list[str]:
    r"""Cut a product before its factors in brackets, if it is wider than `most`.

    >>> cut_at_brackets(r"= \exp\left(b + c\right) \left(d - e\right)", 9)
    ['= \\exp\\left(b + c\\right)', '\\left(d - e\\right)']
    """
    cuts = [0]
    for cut in _cuts(term, "fence") if width(term) > most else ():
        # What a function takes follows its name at once; a sign of integration does not stand alone.
        if term[cut - 1] == " " and width(term[cuts[-1] : cut]) > _LEAST:
            cuts.append(cut)
    return [term[start:end].strip() for start, end in pairwise([*cuts, len(term)])]


def _balanced(row: str) -> bool:
    r"""Tell whether a row closes the braces and fences that it opens."""
    fences = [match[1] for match in _FENCED.finditer(row)]
    return row.count("{") == row.count("}") and fences.count("left") == fences.count("right")


def _terms(link: str, most: float) -> list[str]:
    """Break a sum that is too wide at its signs, or a product before its factors in fences."""
    if width(link) <= most:
        return [link]
    for cuts in (_cuts(link, "sign"), _cuts(link, "fence")):
        parts = [link[start:end].strip() for start, end in pairwise([0, *cuts, len(link)])]
        packed = [parts[0]]
        for part in parts[1:]:
            if width(f"{packed[-1]} {part}") <= most:
                packed[-1] += f" {part}"
            else:
                packed.append(part)
        if max(map(width, packed)) <= most:
            return packed
    return packed if len(packed) > 1 else opened(link, most)


def opened(link: str, most: float) -> list[str]:
    r"""Break within the widest pair of fences, which then are set apart in each line.

    >>> opened(r"= 2 \left(a + b - c - d\right) e", 7)
    ['= 2 \\left( a + b \\right.', '\\left. - c - d \\right)  e']
    """
    start, depth = -1, 0
    spans = []
    for fence in _FENCED.finditer(link):
        if fence[1] == "left":
            start = fence.start() if depth == 0 else start
            depth += 1
        else:
            depth -= 1
            if depth == 0:
                spans.append((start, fence.end() + 1))
    if not spans:
        return [link]
    start, end = max(spans, key=lambda span: width(link[slice(*span)]))
    inner = link[start + 6 : end - 7]
    parts = _terms(inner, most - 3)
    if len(parts) == 1:
        return [link]
    opening, closing = link[start : start + 6], link[end - 7 : end]
    return [
        rf"{link[:start]}{opening} {parts[0]} \right.",
        *(rf"\left. {part} \right." for part in parts[1:-1]),
        rf"\left. {parts[-1]} {closing} {link[end:]}".rstrip(),
    ]


def _cuts(link: str, kind: str) -> list[int]:
    """Find the signs, or the opening fences after the first, that stand in no group."""
    found, depth, position = [], 0, 0
    while position < len(link):
        fence = _FENCED.match(link, position)
        token = _TOKEN.match(link, position)
        if token is None:
            break
        at_top = depth == 0 and not _BEGINNING.fullmatch(link, 0, position)
        if fence:
            if fence[1] == "left" and kind == "fence" and at_top:
                found.append(position)
            depth += 1 if fence[1] == "left" else -1
        else:
            if kind == "sign" and token.lastgroup == "sign" and at_top:
                found.append(position)
            depth += _GROUP.get(token.lastgroup or "", 0)
        position = token.end()
    return found
