"""A ball in steady sliding on a foundation with any relaxation function: one quadrature over its strips.

Each strip along x is a parabola, explicit in the length c of its contact (F17). So c, and not the place of
the strip, is the variable of the sum: no root is to be found.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .model import R, delta
from .power_law_weight import a_0
from .relaxation import LOADED, WORKED, name_integrals, repeated
from .steady import a
from .viscoelastic import SECTION, contact_length

across = symbol("R_y", latex=r"R_{\mathrm{y}}")
middle, offset, ball_load, ball_friction = symbols(r"""
    c_m  c_{\mathrm{m}}  m  length of the contact in the middle of a ball
    y_m  y_{\mathrm{m}}  m  distance of a strip from the middle of a ball
    W_s  W_{\mathrm{s}}  N  load of a ball in steady sliding  real
    F_s  F_{\mathrm{s}}  N  friction force of a ball in steady sliding  real
""")
strip_load = function("W_2", "load of a strip of a ball per unit width", "N/m", real=True)
strip_friction = function("F_2", "friction force of a strip per unit width", "N/m", real=True)
strip_place = function("y_2", "distance of the strip with a contact of this length", "m", real=True)

c, (_, G_2, _, _) = contact_length, repeated
ALONG = (c, 0, middle)
PLACE = sp.sqrt(across / R) * sp.sqrt(a_0**2 - a**2)
"""Distance of a strip from the middle, by its half length."""
LOAD_RATE = G_2(c) / R
"""Load of a strip that is gained with its half length."""
FRICTION_RATE = G_2(c) * (2 * a - c) / R**2
"""Friction force of a strip that is gained with it."""
result = Chapter(SECTION)


@result("F17-strip")
def _strip(proof: Proof) -> None:
    r"""Any relaxation function: load and friction force that a longer contact gains.

    With $a = \breve G_2/\breve G_1$ as a function of $\breve c$.
    """
    name_integrals(proof, 4, c)
    proof.recall("F17-concave", a)
    for name, whole, rate, what in (
        (strip_load(c), LOADED, LOAD_RATE, "load"),
        (strip_friction(c), WORKED, FRICTION_RATE, "friction force"),
    ):  # fmt: skip
        proof.recall("F17-forces", whole)
        proof.define(name, whole, what)
        proof.equal(sp.Derivative(name, c), rate * sp.Derivative(a, c), f"{what} gained")


@result("F20-strips")
def _places(proof: Proof) -> None:
    r"""Ball: the place of a strip by its half length.

    A strip at the distance $y_{\mathrm{m}}$ from the middle is a parabola that is less deep by
    $y_{\mathrm{m}}^2/(2 R_{\mathrm{y}})$.
    """
    proof.define(delta, a_0**2 / (2 * R), "depth in the middle")
    proof.where(sp.Lt(a, a_0), "a strip beside the middle")
    gap = delta - offset**2 / (2 * across) - a**2 / (2 * R)
    proof.root(gap, offset, PLACE, "its depth is $a^2/(2 R)$")


def _summed(proof: Proof, total: sp.Symbol, strip: sp.Expr, what: str) -> None:
    """Add up strips, with the length of the contact as the variable."""
    name, place = strip(c), strip_place(c)
    proof.define(strip(0), sp.S.Zero, "the last strip has no contact")
    both = sp.Derivative(name, c) * place + name * sp.Derivative(place, c)
    whole, one = sp.Integral(both, ALONG), sp.Integral(sp.Derivative(name, c) * place, ALONG)
    proof.define(total, 2 * one - 2 * whole, "by parts")
    proof.equal(total, -2 * sp.Integral(name * sp.Derivative(place, c), ALONG), f"{what} of all")
    proof.integral(whole, both, ALONG, "nothing at the ends", value=sp.S.Zero,
                   antiderivative=name * place)  # fmt: skip


@result("F20-any")
def _sum(proof: Proof) -> None:
    r"""Ball on any relaxation function: load and friction force, one quadrature.

    With $a = \breve G_2/\breve G_1$ as a function of the length $\breve c$ of the contact of a strip, and the
    strip at $y_2 = \sqrt{R_{\mathrm{y}}/R} \sqrt{a_0^2 - a^2}$ (F20-strips). In the middle, where $\breve c =
    c_{\mathrm{m}}$, $a$ is $a_0 = \sqrt{2 R \delta}$; that is the only root. For arms all of these are
    sums of exponentials and powers.
    """
    proof.recall("F17-strip", a)
    proof.define(strip_place(middle), sp.S.Zero, "the longest contact is in the middle")
    for total, strip, rate, what in (
        (ball_load, strip_load, LOAD_RATE, "load"),
        (ball_friction, strip_friction, FRICTION_RATE, "friction force"),
    ):
        _summed(proof, total, strip, what)
        proof.recall("F17-strip", sp.Derivative(strip(c), c))
        value = 2 * sp.Integral(strip_place(c) * rate * sp.Derivative(a, c), ALONG)
        proof.equal(total, value, f"the {what}, in terms of the half length")
