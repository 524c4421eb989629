"""Dissipation of the power of the friction force: theorem F6, and the identity behind it for any shape."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .model import C, K, R, V, delta, h, t, t_0, u_i, x
from .steady import F, a, l, l_r, q, x_le, x_te
from .theorems import UNIT, B, phi

F_elastic, F_viscous, eta = symbols(r"""
    -          u_{\mathrm{TE}}  m    compression at the trailing edge
    F_elastic  F_{\mathrm{e}}   N/m  elastic part of the friction force  real
    F_viscous  F_{\mathrm{v}}   N/m  viscous part of the friction force  real
    eta        -                1    part of the power $F V$ that is dissipated inside the contact
""")


_shape = h(x)
_slope = sp.Derivative(_shape, x)
_contact = (x, x_le, x_te)
_STORED = sp.Integral(-K * (delta - _shape) * _slope, _contact)
_INSIDE = sp.Integral(K * l_r * _slope**2, _contact)
_ASSUMPTIONS = (
    r"Any shape $h$ whose slope may jump, in contact on one interval at whose leading edge $u = \delta - "
    "h$ vanishes."
)

FRACTION = 4 * (q**2 - q + 1) / B
"""Share of the power that is dissipated inside the contact."""

result = Chapter("Energy")


@result("energy-split")
def _split(proof: Proof) -> None:
    r"""Friction force: an elastic and a viscous part.

    Any shape $h$ whose slope may jump, in contact on one interval at whose leading edge $u = \delta - h$
    vanishes.
    """
    whole = sp.Integral(-_slope * (K * (delta - _shape) - C * V * _slope), _contact)
    proof.recall("eq29", C)
    proof.define(F_elastic, _STORED, "the spring: $K u u'$ with $u = \\delta - h$")
    proof.define(F_viscous, _INSIDE, r"the damper: $C V h'^2 = C \dot{u}^2/V$, power lost over $V$")
    proof.equal(whole, F_elastic + F_viscous, "the integral of $-h' p$, term by term")
    proof.define(F, F_elastic + F_viscous, "the friction force")


@result("energy-behind")
def _relaxation(proof: Proof) -> None:
    r"""Energy lost behind the contact.

    Per distance slid: the surface that leaves the contact with $u = u_{\mathrm{TE}}$ relaxes freely, $u =
    u_{\mathrm{TE}} e^{-(x - x_{\mathrm{TE}})/l_{\mathrm{r}}}$ (Eqs. 25, 29).
    """
    u_te = delta - h(x_te)
    surface = u_i.subs(t, t_0 + (x - x_te) / V)
    proof.define(u_i.subs(t, t_0), u_te, "where it leaves the contact")
    proof.recall("eq29", surface, C)
    integrand = C / V * (V * sp.Derivative(surface, x)) ** 2
    behind = sp.Integral(integrand, (x, x_te, sp.oo))
    proof.integral(behind, integrand, (x, x_te, sp.oo),
                   r"$C \dot{u}^2/V$ behind the contact: all that was stored at the trailing edge",
                   value=K * u_te**2 / 2, antiderivative=-K * surface**2 / 2)  # fmt: skip


@result("energy-any-shape", text=_ASSUMPTIONS)
def _any_shape(proof: Proof) -> None:
    """Friction force of any shape is dissipation.

    The first term is the power lost in the surface that relaxes behind the contact, the second the power lost
    inside it, both over $V$.
    """
    result = K * (delta - h(x_te)) ** 2 / 2 + _INSIDE
    difference = K * (delta - h(x_te)) ** 2 / 2 - K * (delta - h(x_le)) ** 2 / 2
    proof.recall("energy-split", "energy-split", F_viscous)
    # u is continuous and piecewise smooth, so that kinks of the shape change nothing here.
    elastic = -K * (delta - _shape) * _slope
    stored = K * (delta - _shape) ** 2 / 2
    proof.integral(F_elastic, elastic, _contact, "$u u' = (u^2/2)'$", value=difference,
                   antiderivative=stored)  # fmt: skip
    proof.define(h(x_le), delta, r"$u(x_{\mathrm{LE}}) = 0$")
    proof.equal(F, result, r"two losses, $u_{\mathrm{TE}} = \delta - h(x_{\mathrm{TE}})$")


@result("F6")
def _parabola(proof: Proof) -> None:
    r"""Energy dissipated inside the contact.

    The fraction $\eta$ of the power $F V$ that is dissipated inside the contact of a parabola is 1 in both
    limits and never below 4/5, which is reached at $l_{\mathrm{r}} = \frac{3}{4} a$.
    """
    dissipation = K * l_r * (x / R) ** 2
    proof.define(l_r, l * a, "the retardation length in half lengths")
    proof.recall("eq28", delta, "scaling", "F1", phi, F)
    proof.integral(F_viscous, dissipation, (x, -a, q * a), "inside the contact",
                   value=K * l_r * a**3 * (1 + q**3) / (3 * R**2))  # fmt: skip
    proof.equal(F - F_viscous, K * (delta - (q * a) ** 2 / (2 * R)) ** 2 / 2,
                r"behind: $K u_{\mathrm{TE}}^2/2$")  # fmt: skip
    proof.define(eta, F_viscous / F, "by definition")
    proof.equal(eta, FRACTION, "fraction inside")
    proof.sign(eta, ">=", sp.Rational(4, 5), UNIT, "never less than four fifths")
    proof.equal(eta - sp.Rational(4, 5), 4 * (1 - 2 * q) ** 2 / (5 * B), "least at $q = 1/2$")
    there = sp.Subs(l, q, sp.Rational(1, 2))
    proof.equal(there, sp.Rational(3, 4), "the retardation length there")
    proof.equal(1 - eta, 3 * q * (1 - q) / B, "the rest vanishes in both limits")
    proof.done(eta, FRACTION)
