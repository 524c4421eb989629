r"""Every symbol of the derivations: what it means, its unit, and where it is defined.

A symbol is a letter with its bar or hat, index and star; `derivations.render.atoms` finds them. A dot
is the derivative with respect to time, a prime the one with respect to the argument, which for scaled
quantities of the transient is the scaled time.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Symbol:
    """A row of the nomenclature."""

    latex: str
    meaning: str
    unit: str
    source: str = ""
    """Label of the derivation that defines or derives it, or what else it is; none for what a scene gives."""


SYMBOLS = tuple(
    Symbol(*row)
    for row in (
        ("R", "radius of the indenter", "m"),
        ("M", "mass of the indenter per unit width", "kg/m"),
        ("K", "stiffness of the foundation per unit area", "N/m³"),
        ("C", "damping of the foundation per unit area", "N s/m³"),
        (r"\tau", "retardation time, $C/K$", "s", "eq22"),
        ("N", "number of elements per unit length", "1/m", "eq22"),
        ("k", "stiffness of one element per unit width, $K/N$", "N/m²", "eq22"),
        ("c", "damping of one element per unit width, $C/N$", "N s/m²", "eq22"),
        ("V", "drive velocity", "m/s"),
        ("g", "gravity", "m/s²"),
        ("t", "time", "s", "coordinate"),
        ("t_0", "time at which an element leaves the indenter", "s", "eq25"),
        ("x", "coordinate along the foundation", "m", "coordinate"),
        ("z", "coordinate across the foundation", "m", "coordinate"),
        ("i", "number of an element", "1", "counter"),
        ("h", "shape function of the indenter", "m", "eq3"),
        ("x_i", "position of an element", "m", "eq4"),
        ("u_i", "compression of an element", "m", "eq4"),
        ("u", "compression of the foundation", "m", "eq4"),
        (r"\theta_i", "inclination of the indenter at an element", "1", "eq10"),
        (r"f_{\mathrm{N}i}", "normal force on an element per unit width", "N/m", "eq11"),
        (r"f_{\mathrm{C}i}", "constraint force on an element per unit width", "N/m", "eq9"),
        ("f_{zi}", "vertical force of an element per unit width", "N/m", "eq12"),
        ("f_{xi}", "horizontal force of an element per unit width", "N/m", "eq13"),
        ("F_z", "vertical force per unit width", "N/m", "eq14"),
        ("F_x", "horizontal force per unit width", "N/m", "eq15"),
        (r"z_{\mathrm{A}}", "height of the lowest point of the indenter", "m", "eq16"),
        (r"\delta", "indentation depth", "m", "eq18"),
        ("a", r"half length of the stationary contact, $\sqrt{2 R \delta}$", "m", "eq28"),
        (r"l_{\mathrm{r}}", r"retardation length, $V \tau$", "m", "eq29"),
        (r"x_{\mathrm{LE}}", "leading edge of the contact", "m", "eq26"),
        (r"x_{\mathrm{TE}}", "trailing edge of the contact", "m", "eq27"),
        ("p", "contact pressure", "Pa", "pressure"),
        ("W", "load in steady sliding per unit width", "N/m", "load"),
        ("F", "friction force in steady sliding per unit width", "N/m", "friction"),
        (r"\mu", "friction coefficient, $F/W$", "1", "eq37"),
        ("V^{*}", "critical velocity, where the two asymptotes meet", "m/s", "eq47"),
        ("l", r"scaled retardation length, $l_{\mathrm{r}}/a$", "1", "scaling"),
        (
            "q",
            r"scaled trailing edge, $x_{\mathrm{TE}}/a$, from 1 at rest down to 0 at high velocity",
            "1",
            "scaling",
        ),
        (r"\alpha", r"$2 \sqrt{2}/3$", "1", "eq40"),
        (
            r"\Lambda",
            r"scaled velocity of the dead-weight model, $V \tau (K/(R W))^{1/3}$",
            "1",
            "drive",
        ),
    )
)
"""In the order in which they are listed: the scene, an element, the contact, scaled quantities."""

BY_LATEX = {symbol.latex: symbol for symbol in SYMBOLS}
HEADS = ("Symbol", "Meaning", "Unit", "From")
