"""Words in LaTeX: special characters of TeX are escaped, and references become links."""

import re
from collections.abc import Callable, Collection, Iterable

from .text import Piece, pieces

_ESCAPES = {
    **{char: rf"\{char}" for char in "#$%&_{}"},
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    # OT1 fonts have other glyphs in these places.
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "²": r"\textsuperscript{2}",
    "³": r"\textsuperscript{3}",
}


_UNKNOWN = re.compile(r"[^ -~\n–²³À-ÏÑ-ÝßÀ-ïñ-ýÿ]")
"""What the fonts of plain LaTeX lack."""


def linked(piece: Piece) -> str:
    """Print a reference as a link of hyperref."""
    return rf"\hyperref[{piece.target}]{{{escape(piece.content)}}}"


def words(text: str, labels: Collection[str], link: Callable[[Piece], str] = linked) -> str:
    """Print text in which mathematics stands between dollar signs."""
    return printed(pieces(text, labels), link)


def printed(content: Iterable[Piece], link: Callable[[Piece], str] = linked) -> str:
    """Print pieces of text."""
    write = {
        "words": lambda piece: escape(piece.content),
        "math": lambda piece: f"${piece.content}$",
        "link": link,
    }
    return "".join(write[piece.kind](piece) for piece in content)


def escape(words: str) -> str:
    """Escape words that are no mathematics, and set quotation marks."""
    escaped = "".join(_ESCAPES.get(char, char) for char in _UNKNOWN.sub("?", words))
    return re.sub('"([^"]*)"', r"``\1''", escaped)
