"""Derivations as a LaTeX article that needs no more than texlive-latex-base, and as fragments."""

import re
from collections.abc import Collection, Iterable, Sequence

from derivations.record import Derivation, Table
from derivations.render import frame
from derivations.render.text import (
    Given,
    Line,
    Piece,
    blocks,
    by_section,
    citation,
    number,
    pieces,
    remark,
    sentence,
)

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

_GAP = 0.03
"""Between the columns of a table, as a share of the line."""

_PREAMBLE = r"""\documentclass[11pt,a4paper]{article}
\usepackage[margin=25mm]{geometry}
\usepackage{amsmath,amssymb,array,multicol}
\usepackage[hidelinks]{hyperref}
\setcounter{secnumdepth}{1}
\setcounter{tocdepth}{2}
\setlength{\parindent}{0pt}
\setlength{\parskip}{3pt plus 1pt}
\setlength{\lineskip}{3pt}
\setlength{\lineskiplimit}{2pt}
\relpenalty=2000
\binoppenalty=5000
\raggedbottom
\emergencystretch=3em
\clubpenalty=10000
\widowpenalty=10000
\makeatletter
% Headings run into the text; entries of the contents are ragged, for their columns are narrow.
\renewcommand{\subsection}{\@startsection{subsection}{2}{0pt}{2ex plus 1ex}{-0.7em}{\bfseries}}
\renewcommand{\@tocrmarg}{2.5em plus 1fil}
\newcommand{\numbered}[2]{\phantomsection\def\@currentlabel{#2}\label{#1}(#2)}
% What introduces a line (a heading without text, a sentence) stays on its page.
\newcommand{\startline}{\if@noskipsec\leavevmode\fi \ifhmode\par\nopagebreak\fi}

% Mathematics on one line or, where it is wider than #1, broken at relations and signs.
\newcommand{\fit}[2]{%
  \sbox0{$\displaystyle #2$}%
  \ifdim\wd0>#1\relax
    \parbox{#1}{\raggedright \hangindent=2em \relpenalty=0 \binoppenalty=100
      \lineskiplimit=4pt \lineskip=8pt $\displaystyle #2$}%
  \else\box0 \fi}
% A checked line: number (empty but for a result), status, reason, mathematics.
% The reason stands beside the mathematics where both are short, above it where they are not.
\newsavebox{\formula}
\newsavebox{\remark}
\newsavebox{\number@}
\newdimen\indented \indented=2em
\newdimen\usual@ \usual@=3em
\newdimen\numbers@
\newdimen\room
\newcommand{\checked}[4]{%
  \startline
  \sbox{\formula}{$\displaystyle #4$}\sbox{\remark}{\small #3\quad\textit{#2}}\sbox{\number@}{#1}%
  \numbers@=\dimexpr\wd\number@+1em\relax
  \ifdim\numbers@<\usual@ \numbers@=\usual@ \fi
  \room=\dimexpr\linewidth-\indented-\numbers@\relax
  \ifdim\dimexpr\wd\formula+\wd\remark+2em>\room
    {\small #3\nobreak\hfill\penalty50\quad\null\nobreak\hfill\textit{#2}\hspace*{\usual@}\par}%
    \nopagebreak
    \sbox{\formula}{\fit{\room}{#4}}\sbox{\remark}{}%
  \fi
  \hspace*{\indented}\makebox[\room]{\usebox{\formula}\hfill\usebox{\remark}}%
  \hfill\usebox{\number@}\par}
\makeatother
"""


def article(derivations: Sequence[Derivation], command: str = "") -> str:
    """Return the complete article."""
    labels = {derivation.label for derivation in derivations}
    introduction = [_text(paragraph, labels) for paragraph in frame.INTRODUCTION]
    if command:
        introduction.append(rf"Made by \texttt{{{_escape(command)}}}.")
    body = [
        _PREAMBLE,
        rf"\hypersetup{{pdftitle={{{_escape(frame.TITLE)}}}}}",
        r"\begin{document}",
        rf"\begin{{center}}\LARGE {_escape(frame.TITLE)}\end{{center}}",
        r"\begin{abstract}\noindent",
        "\n\n".join(introduction).replace(frame.AUTHORS, rf"{frame.AUTHORS}~\cite{{paper}}"),
        r"\end{abstract}",
        _vocabulary(),
        r"\columnsep=2em\begin{multicols}{2}\small\parskip=0pt\tableofcontents\end{multicols}",
        r"\section*{Nomenclature}\addcontentsline{toc}{section}{Nomenclature}",
        _tabular(Table(frame.NOMENCLATURE_HEADS, frame.NOMENCLATURE), labels, (0.2, 0.6, 0.14)),
    ]
    for section, members in by_section(derivations).items():
        body.append(rf"\section{{{_heading(section)}}}")
        body.extend(_derivation(member, labels) for member in members)
    body += [
        r"\begin{thebibliography}{1}",
        rf"\bibitem{{paper}} {_escape(frame.SOURCE)}",
        rf"\href{{https://doi.org/{frame.DOI}}}{{doi:\,{frame.DOI}}}",
        r"\end{thebibliography}",
        r"\end{document}",
    ]
    return "\n".join(body) + "\n"


def fragment(derivation: Derivation) -> str:
    r"""Return the result as an equation to `\input` in any document that loads amsmath."""
    comment = f"{derivation.label}: {derivation.title} [{derivation.status}]"
    return (
        f"% {comment}\n\\begin{{equation}}\n  {derivation.latex}\n"
        f"  \\tag{{{number(derivation.label)}}}\\label{{{derivation.label}}}\n\\end{{equation}}\n"
    )


def _derivation(derivation: Derivation, labels: Collection[str]) -> str:
    shown = f"({number(derivation.label)}) {_heading(derivation.title)}"
    parts = [
        rf"\subsection[{{{shown}}}]{{{shown}}}",
        _text(derivation.text, labels),
        *(_block(block, derivation.label, labels) for block in blocks(derivation)),
    ]
    if derivation.table:
        columns = len(derivation.table.heads)
        width = (1 - _GAP * (columns - 1)) / columns
        parts.append(_tabular(derivation.table, labels, [width] * columns))
    cited = {step.source for step in derivation.steps}
    further = [citation(label, labels) for label in derivation.uses if label not in cited]
    if further:
        links = ", ".join(_printed([each]) for each in further)
        parts.append(rf"\nopagebreak{{\small Also used: {links}.\par}}")
    return "\n".join(part for part in parts if part)


def _block(block: Given | Line, label: str, labels: Collection[str]) -> str:
    if isinstance(block, Given):
        return _printed(sentence(block, labels))
    step, tag = block.step, _escape(block.tag)
    numbered = rf"\numbered{{{label}}}{{{tag}}}" if tag else ""
    return (
        rf"\checked{{{numbered}}}{{{_escape(step.status)}}}"
        rf"{{{_printed(remark(step, labels))}}}{{{step.latex}}}"
    )


def _vocabulary() -> str:
    items = [
        rf"\item[{_escape(status)}] {_escape(meaning)};"
        for status, meaning in frame.VOCABULARY.items()
    ]
    items[-1] = items[-1][:-1] + "."
    return "\n".join([r"\begin{description}\itemsep=0pt", *items, r"\end{description}"])


def _tabular(table: Table, labels: Collection[str], widths: Sequence[float]) -> str:
    """Return a table with columns of these shares of the line, rows as high as fractions need."""
    stretch = 2.4 if any(r"\frac" in cell for row in table.rows for cell in row) else 1.3
    columns = rf"@{{\hspace{{{_GAP}\linewidth}}}}".join(
        rf">{{\raggedright\arraybackslash}}p{{{width:.4f}\linewidth}}" for width in widths
    )
    rows = [" & ".join(_text(cell, labels) for cell in row) + r" \\" for row in table.rows]
    heads = " & ".join(rf"\textbf{{{_text(head, labels)}}}" for head in table.heads)
    return "\n".join(
        [
            rf"\par{{\small\renewcommand{{\arraystretch}}{{{stretch}}}\everymath{{\displaystyle}}",
            rf"\begin{{tabular}}{{@{{}}{columns}@{{}}}}",
            rf"\hline {heads} \\ \hline",
            *rows,
            r"\hline\end{tabular}\par}",
        ]
    )


def _heading(text: str) -> str:
    """Return text for a heading, with words alone for the bookmark where it has mathematics."""
    if "$" not in text:
        return _text(text, ())
    words = "".join(re.sub(r"[\\{}^_]", "", piece.content) for piece in pieces(text, ()))
    return rf"\texorpdfstring{{{_text(text, ())}}}{{{_escape(words)}}}"


def _text(text: str, labels: Collection[str]) -> str:
    return _printed(pieces(text, labels))


def _printed(content: Iterable[Piece]) -> str:
    printed = {
        "words": lambda piece: _escape(piece.content),
        "math": lambda piece: f"${piece.content}$",
        "link": lambda piece: rf"\hyperref[{piece.target}]{{{_escape(piece.content)}}}",
    }
    return "".join(printed[piece.kind](piece) for piece in content)


def _escape(words: str) -> str:
    escaped = "".join(_ESCAPES.get(char, char) for char in words)
    return re.sub('"([^"]*)"', r"``\1''", escaped)
