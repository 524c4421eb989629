"""Derivations as a LaTeX article that needs no more than texlive-latex-base."""

import re
from collections.abc import Collection, Sequence

from ..engine.record import Calculation, Derivation, Table
from . import frame
from .edition import Edition
from .latex_words import escape, printed, words
from .text import (
    Given,
    Line,
    by_section,
    calculation,
    citation,
    further,
    number,
    pieces,
    remark,
    sentence,
)

_GAP = 0.03
"""Between the columns of a table, as a share of the line."""
_WIDTHS = {3: (0.13, 0.68, 0.13), 4: (0.11, 0.46, 0.12, 0.22), 5: (0.1, 0.35, 0.11, 0.18, 0.14)}
"""Of the columns of the nomenclature, by their number."""

_SIGNS = {
    "definition": r"$\stackrel{\scriptscriptstyle\mathrm{def}}{=}$", "proved": r"{\tiny$\blacksquare$}",
    "proved-leading-order": r"$\approx$",
    "argued": r"$\dagger$",
}  # fmt: skip

_PREAMBLE = r"""\documentclass[11pt,a4paper]{article}
\usepackage[margin=25mm]{geometry}
\usepackage{amsmath,amssymb,array,longtable,multicol}
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
\emergencystretch=6em
\clubpenalty=10000
\widowpenalty=10000
\makeatletter
% Headings run into the text; entries of the contents are ragged, for their columns are narrow.
\renewcommand{\subsection}{\@startsection{subsection}{2}{0pt}{2ex plus 1ex}{-0.7em}{\bfseries}}
\renewcommand{\@tocrmarg}{2.5em plus 1fil}
% Room for #1 lines, else a new page: a section has its table on its page, and a record too.
\newcommand{\spare}[1]{\if@nobreak\else
  \par\penalty-100\relax\ifdim\dimexpr\pagegoal-\pagetotal\relax<#1\baselineskip\newpage\fi\fi}
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
% A checked line: number (empty but for a result), sign of its status, reason, mathematics.
% The reason stands after the mathematics: in its line or, where that is full, in the next one.
\newsavebox{\formula}
\newsavebox{\remark}
\newsavebox{\number@}
\newdimen\indented \indented=1em
\newdimen\room
\newcommand{\checked}[4]{%
  \startline
  \sbox{\number@}{#1}%
  \room=\dimexpr\linewidth-\indented-\wd\number@-1em\relax
  \def\reason{#3}%
  \ifx\reason\@empty
    \sbox{\formula}{\fit{\room}{#4\quad\mbox{\small#2}}}\sbox{\remark}{}%
  \else \sbox{\formula}{\fit{\room}{#4}}\sbox{\remark}{\small\quad #3~#2}\fi
  \ifdim\dimexpr\wd\formula+\wd\remark\relax>\room
    \hspace*{\indented}\usebox{\formula}\hfill\usebox{\number@}\par\nopagebreak
    {\small\leftskip=2\indented\raggedright\hangindent=1em #3~#2\par}%
  \else
    \hspace*{\indented}\usebox{\formula}\usebox{\remark}\hfill\usebox{\number@}\par
  \fi}
\makeatother
"""


def article(edition: Edition) -> str:
    """Return the complete article."""
    labels, table = edition.labels, edition.table()
    introduction = [words(paragraph, labels) for paragraph in frame.INTRODUCTION]
    if edition.command:
        version = escape(f"kvtheory {edition.version}".strip())
        introduction.append(rf"Made by {version}: \texttt{{{escape(edition.command)}}}")
    if edition.scene:
        introduction.append(words(frame.numbers_of(edition.scene), labels))
    body = [
        _PREAMBLE,
        rf"\hypersetup{{pdftitle={{{escape(edition.title)}}}}}",
        r"\begin{document}",
        rf"\begin{{center}}\LARGE {escape(edition.title)}\end{{center}}",
        r"\begin{abstract}\noindent",
        "\n\n".join(introduction).replace(frame.AUTHORS, rf"{frame.AUTHORS}~\cite{{paper}}"),
        r"\end{abstract}",
        _vocabulary(),
    ]
    if len(edition.derivations) > 1:
        contents = (
            r"\columnsep=2em\begin{multicols}{2}\small\parskip=0pt\tableofcontents\end{multicols}"
        )
        body.append(contents)
    body += [
        r"\section*{Nomenclature}\addcontentsline{toc}{section}{Nomenclature}",
        words(frame.MARKS, labels),
        tabular(table, labels, _WIDTHS[len(table.heads)], environment="longtable"),
    ]
    for section, members in by_section(edition.derivations).items():
        body.append(rf"\spare{{12}}\section{{{_heading(section)}}}")
        if (own := edition.chapter_table(section)).rows:
            body.append(tabular(own, labels, _WIDTHS[3], environment="longtable"))
        body.extend(_derivation(member, edition) for member in members)
    body += [
        r"\begin{thebibliography}{1}",
        rf"\bibitem{{paper}} {escape(frame.SOURCE)}",
        rf"\href{{https://doi.org/{frame.DOI}}}{{doi:\,{frame.DOI}}}",
        r"\end{thebibliography}",
        r"\end{document}",
    ]
    return "\n".join(body) + "\n"


def _derivation(derivation: Derivation, edition: Edition) -> str:
    labels = edition.labels
    shown = f"({number(derivation.label)}) {_heading(derivation.title)}"
    parts = [
        rf"\spare{{{2 * len(derivation.table.rows) + 12}}}" if derivation.table else "",
        rf"\subsection[{{{shown}}}]{{{shown}}}",
        words(derivation.text, labels),
        *(_block(block, derivation.label, labels) for block in edition.blocks(derivation)),
    ]
    if holds := edition.domain(derivation):
        parts.append(rf"\nopagebreak{{\small\raggedright {words(holds, labels)}\par}}")
    if derivation.table:
        columns = len(derivation.table.heads)
        width = (1 - _GAP * (columns - 1)) / columns
        parts.append(tabular(derivation.table, labels, [width] * columns))
    parts += _numbers(derivation.numbers, labels)
    if others := further(derivation):
        links = ", ".join(printed([citation(label, labels)]) for label in others)
        parts.append(rf"\nopagebreak{{\small Rests also on {links}.\par}}")
    return "\n".join(part for part in parts if part)


def _block(block: Given | Line, label: str, labels: Collection[str]) -> str:
    if isinstance(block, Given):
        return printed(sentence(block, labels))
    step, tag = block.step, escape(block.tag)
    numbered = rf"\numbered{{{label}}}{{{tag}}}" if tag else ""
    return (
        rf"\checked{{{numbered}}}{{{_SIGNS[step.status]}}}"
        rf"{{{printed(remark(step, labels))}}}{{{step.latex}}}"
    )


def _vocabulary() -> str:
    items = [
        rf"\item[{_SIGNS[status]}] {escape(status)}: {escape(meaning)};"
        for status, meaning in frame.VOCABULARY.items()
    ]
    items[-1] = items[-1][:-1] + "."
    return "\n".join([r"\begin{description}\itemsep=0pt", *items, r"\end{description}"])


def _numbers(numbers: Sequence[Calculation], labels: Collection[str]) -> list[str]:
    """Return the closed forms with the numbers of a scene."""
    if not numbers:
        return []
    lines = [
        rf"\checked{{}}{{}}{{{words(each.note, labels)}}}{{{calculation(each)}}}"
        for each in numbers
    ]
    return [words(frame.WITH_NUMBERS, labels), *lines]


def tabular(
    table: Table,
    labels: Collection[str],
    widths: Sequence[float],
    environment: str = "tabular",
) -> str:
    """Return a table with columns of these shares of the line, rows as high as fractions need."""
    stretch = 2.4 if any(r"\frac" in cell for row in table.rows for cell in row[:1]) else 1.3
    columns = rf"@{{\hspace{{{_GAP}\linewidth}}}}".join(
        rf">{{\raggedright\arraybackslash}}p{{{width:.4f}\linewidth}}" for width in widths
    )
    rows = [" & ".join(words(cell, labels) for cell in row) + r" \\" for row in table.rows]
    heads = " & ".join(rf"\textbf{{{words(head, labels)}}}" for head in table.heads)
    long = environment == "longtable"
    repeat, apart, style = (
        (r"\endhead", "", "") if long else ("", r"\nopagebreak", r"\everymath{\displaystyle}")
    )
    return "\n".join(
        [
            rf"\par{apart}{{\small\renewcommand{{\arraystretch}}{{{stretch}}}{style}",
            rf"\begin{{{environment}}}{{@{{}}{columns}@{{}}}}",
            rf"\hline {heads} \\ \hline{repeat}",
            *rows,
            rf"\hline\end{{{environment}}}\par}}",
        ]
    )


def _heading(text: str) -> str:
    """Return text for a heading, with words alone for the bookmark where it has mathematics."""
    if "$" not in text:
        return words(text, ())
    bare = "".join(re.sub(r"[\\{}^_]", "", piece.content) for piece in pieces(text, ()))
    return rf"\texorpdfstring{{{words(text, ())}}}{{{escape(bare)}}}"
