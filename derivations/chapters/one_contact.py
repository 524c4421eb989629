"""There is no second contact behind the trailing edge of steady sliding (Eq. 27)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbol
from ..engine.step import Proof
from .model import R, V, delta, t, t_0, u_i, x
from .steady import SECTION, l_r, x_te

x_b = symbol("x_b", "distance behind the trailing edge", "m", r"x_{\mathrm{b}}")
result = Chapter(SECTION)


@result("one-contact")
def _one_contact(proof: Proof) -> None:
    """No second contact.

    Behind the trailing edge the surface relaxes by Eqs. (25) and (29), and the indenter rises as a parabola.
    Both leave the edge with the same slope, and then separate.
    """
    proof.recall("eq28", "eq27")
    y, part = x_b, sp.Symbol("zeta", positive=True)
    indenter, left = delta - (x_te + y) ** 2 / (2 * R), l_r * x_te / R
    proof.equal(delta - x_te**2 / (2 * R), left, "the compression at the trailing edge")
    proof.equal(indenter, left * (1 - y / l_r) - y**2 / (2 * R),
                r"the indenter behind it, at $x = x_{\mathrm{TE}} + x_{\mathrm{b}}$")  # fmt: skip
    over = (part, 0, y / l_r)
    above = sp.Integral(1 - sp.exp(-part), over)
    proof.integral(above, 1 - sp.exp(-part), over, "an exponential above its tangent",
                   value=sp.exp(-y / l_r) - 1 + y / l_r)  # fmt: skip
    start, later = u_i.subs(t, t_0), u_i.subs(t, t_0 + (x - x_te) / V)
    proof.define(start, left, "where it leaves the contact")
    proof.recall("eq29", later, reason="and relaxes", at={x: x_te + y})
    gap = later.subs(x, x_te + y) - indenter
    proof.equal(gap, y**2 / (2 * R) + left * above, "the gap between indenter and free surface")
    proof.holds(y**2 / (2 * R) + left * above, ">=", y**2 / (2 * R), "never again in contact")
    proof.done(gap, y**2 / (2 * R) + left * above)
