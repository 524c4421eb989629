r"""The letters of the catalogue: each has one meaning; an edition drops the accents that a section can spare.

A derivation is written in the letters that suit it best; where two chapters use one letter for two
things, one of them prints another. A renaming of symbols keeps every equality that was checked.

>>> printed(r"\frac{d}{ds} u + \int g \, dX", letters("F8", "Transient: theorems"))
'\\frac{\\mathrm{d}}{\\mathrm{d}s} \\bar u + \\int \\bar g \\, \\mathrm{d}X'
"""

import re
from collections.abc import Mapping
from functools import cache

from .atoms import replaced

_CIRCLE = {r"\varepsilon": r"\gamma", r"\xi": r"\hat x", "t": r"\hat t"}
_LIFTED = {"s": r"\hat a", "f": r"\hat f", "r": r"\hat r"}
_STEP = {"h": r"\Delta s"}
_PASSED = {r"\sigma": r"\bar\sigma", r"\eta": r"\bar\eta", "m": r"\bar m"}
_SHAPES = {
    **_PASSED, r"\theta": r"\bar\theta", "f": r"\bar f", "y": r"\hat y",
    "y_1": r"\hat y_1", "y_2": r"\hat y_2", "d_1": r"\bar d_1", "k": r"\bar k", "c": r"\hat c",
}  # fmt: skip

BY_SECTION: dict[str, dict[str, str]] = {
    "Model": {"z_A": r"z_{\mathrm{A}}"},
    "Dimensionless groups": {
        **{letter: rf"\mathsf{{{letter}}}" for letter in "NXZT"},
        "D": r"\mathbf{D}", "E": r"\mathbf{E}",
        r"\epsilon": r"\varepsilon",
    },
    "Tables": {r"\epsilon": r"\varepsilon"},
    "Friction without integrals": {"r": r"\bar r"},
    "Power law and wedge": {
        "s": r"\hat a", "s_1": r"\hat a_1", "s_2": r"\hat a_2", "r": r"\hat r", "z": r"\bar z",
        "c": r"\hat c", "k": "j",
    },
    "Any linear viscoelastic foundation": {
        "G_v": r"\breve G", **{f"G_{{v{n}}}": rf"\breve G_{n}" for n in (1, 2, 3, 4)},
        "H_v": r"\breve H", "H_w": r"\breve H_1", "C_v": r"\breve C", "k_v": r"\breve k", "n_v": r"\breve n",
    },
    "Rubber in transient sliding": {
        r"\xi": r"\tilde \xi", "Y": r"X_{\mathrm{s}}", "v": r"V_{\mathrm{s}}",
        "x_{LE}": r"x_{\mathrm{LE}}", "x_{TE}": r"x_{\mathrm{TE}}",
    },
    "True circle": _CIRCLE,
    "Ball": {"s": r"\hat a"},
    "Transient sliding": {r"\hat p": r"\bar p", "z_A": r"z_{\mathrm{A}}"},
    "Transient: theorems": {
        "X_e": r"X_{\mathrm{e}}",
        r"\hat p": r"\bar p", "a": r"\hat a", "u": r"\bar u", "u_0": r"\bar u_0", "g": r"\bar g",
    },
    "A drive with a spring": {
        "a": r"\hat a", "z_A": r"z_{\mathrm{A}}", "x_A": r"x_{\mathrm{A}}",
    },
    "A drive with a spring on rubber": {"z_A": r"z_{\mathrm{A}}", "x_A": r"x_{\mathrm{A}}"},
    "Discrete elements": {
        r"\hat p": r"\bar p", "u": r"\bar u", "L": r"\ell_{\mathrm{c}}", "R": r"\hat R", "z": r"\hat z",
        "y": r"\bar y", r"\Delta": r"\Delta x", r"\eta": r"\hat\eta",
        "D": r"\hat D", "b": r"b_{\mathrm{e}}", "k": "j", "m": r"m_{\mathrm{k}}", **_STEP,
        **{f"r{end}": rf"\hat\varrho{end}"
           for end in ("", "_1", "_2", "_3")},
        **{f"w{end}": rf"\hat w{end}" for end in ("", "_0", "_1", "_2")},
    },
}  # fmt: skip
"""By section: the letter as it is written, and as it is printed."""

BY_LABEL: dict[str, dict[str, str]] = {
    "F25": {"G": r"G_{\mathrm{r}}", "x_u": r"\breve u'"},
    "eq26": {"s": r"\bar s"},
    "one-contact": {"y": r"x_{\mathrm{b}}"},
    "F2": {letter: rf"\hat {letter}" for letter in "XYT"},
    "F3": {letter: rf"\hat {letter}" for letter in "XYT"},
    "F7": {"n": r"\hat n", r"\xi": r"\hat x"},
    "F16": {r"\xi": r"\hat x"},
    "scaled-load": _LIFTED,
    "balance": _LIFTED,
    "error-load-suspended": _LIFTED,
    "error-depth-low": {"b": r"b_\delta", "E": r"E_\delta"},
    "circle-dead-weight": {**_LIFTED, "m": "m"},
    "circle-steepness": {"y": r"\hat v"},
    "circle-peak": {"y": r"\hat y"},
    "F8": {**_STEP, **_PASSED, "c": r"\bar c"},
    "F8-remainder": {
        **_STEP,
        **{f"{letter}_8": rf"\check {letter}" for letter in "fvcbyMk"},
    },
    "F9": _SHAPES,
    "F10": {
        **_STEP,
        **_PASSED,
        "c": r"c_{\mathrm{t}}",
        "k": r"\bar k",
        "y": r"\bar y",
        "k_1": r"\bar k_1",
        "k_2": r"\bar k_2",
        "k_3": r"\bar k_3",
    },
    "F11": _PASSED,
    "F12": {"D": r"\tilde d"},
    "F22": {"D": r"\tilde d"},
    "F13": {"f": r"f_{\mathrm{b}}"},
    "F13-root": {"f": r"f_{\mathrm{b}}", "n": r"\bar n", r"\beta": r"\bar b"},
    "F14": {"E": r"E_{\mathrm{s}}", "S": r"\bar U", "g": "g"},
    "F15-runge-kutta": {"u": "u"},
    "element-kink": {"u": "u", r"\hat p": r"\bar p"},
    "element-trapezoids": {"u": "u"},
    "element-stability": {
        "m": r"\hat m",
        "w": r"\varpi",
        "c": "c_1",
        "x": r"\tilde x",
        "y": r"\tilde y",
        r"\eta_{+}": r"\hat\eta_{+}",
    },
    "F15-sawtooth": {"h": "h"},
    "strips-rim": {"y": r"y_{\mathrm{s}}", r"\psi": r"\breve \psi"},
    "strips-rule": {
        **{letter: rf"{letter}_{{\mathrm{{s}}}}" for letter in "yvxQ"},
        **{letter: rf"\breve {letter}" for letter in ("p_1", "p_2")},
        r"\Delta": r"\Delta y",
    },
    "element-arms": {
        "s": r"\check s",
        "s_0": r"\check s_0",
        "y": r"\check t",
        "r": r"\check r",
        "z": r"\check z",
        "u": "u",
    },
}
"""Beside these, by label or by the first part of one; they come before those of the section."""

_DIFFERENTIAL = re.compile(
    r"(?<![A-Za-z\\])d(?=[A-Za-z](?![A-Za-z])|\\(?:xi|zeta|sigma|ell|hat|bar|tilde|breve|check)(?![a-z]))"
)
_SPACED = re.compile(r"\\frac\{d((?:\^\{\d+\})?)\}\{d (?=[A-Za-z\\])")
_FRACTION = re.compile(r"\\frac\{d ((?:[^{}]|\{[^{}]*\})+)\}\{d ")
_OPERATOR = re.compile(r"\\frac\{d((?:\^\{?\d\}?)?)\}(?=\{\\mathrm\{d\})")


@cache
def _merged(label: str, section: str) -> Mapping[str, str]:
    family = label.split("-", maxsplit=1)[0]
    return {
        **BY_SECTION.get(section, {}),
        **(BY_LABEL[label] if label in BY_LABEL else BY_LABEL.get(family, {})),
    }


def letters(label: str, section: str) -> Mapping[str, str]:
    """Return the letters that a derivation prints for those that it is written in."""
    return _merged(label, section)


def printed(latex: str, new: Mapping[str, str]) -> str:
    """Write mathematics in other letters, with upright differentials."""
    spaced = _SPACED.sub(r"\\frac{\\mathrm{d}\1}{\\mathrm{d} ", latex)
    spaced = _FRACTION.sub(r"\\frac{\\mathrm{d} \1}{\\mathrm{d} ", spaced)
    upright = _OPERATOR.sub(r"\\frac{\\mathrm{d}\1}", _DIFFERENTIAL.sub(r"\\mathrm{d}", spaced))
    return replaced(upright, new.get)


def told(text: str, new: Mapping[str, str]) -> str:
    """Write text in which mathematics stands between dollar signs in other letters."""
    parts = text.split("$")
    return "$".join(printed(part, new) if i % 2 else part for i, part in enumerate(parts))
