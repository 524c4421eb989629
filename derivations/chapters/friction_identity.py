r"""Friction without integrals (F21): the friction force from the load and the pressure at the edges.

In the contact of a parabola the pressure has the slope -(K/R)(x + l_r), at every instant of every motion.
So x p is a multiple of p plus a derivative of p**2, and the friction force needs no separate integral.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from . import steady
from .model import C, F_x, F_z, K, R, V, delta, h, x
from .steady import F, W, a, l, l_r, mu, x_le, x_te

depth_rate_now, p_le, p_te, r = symbols(r"""
    delta_t  \dot\delta       1    -  real
    p_LE     p_{\mathrm{LE}}  Pa   pressure at the leading edge  nonnegative
    p_TE     p_{\mathrm{TE}}  Pa   pressure at the trailing edge  nonnegative
    r        -                m    half the distance of the zeros of the pressure, $\sqrt{a^2 +
            l_{\mathrm{r}}^2}$  prints \bar r
    -        I_p              Pa²  integral of $2 p p'$ over the contact
""")


LOAD = K * (a**3 + r**3 - l_r**3) / (3 * R)
"""W, with r = sqrt(a**2 + l_r**2) = x_TE + l_r."""
FRICTION = l_r * (W - C * V * delta) / R

_pressure = sp.Function("p", real=True)
_CONTACT = (x, x_le, x_te)
result = Chapter("Friction without integrals")


@result("F21-shape")
def _any_shape(proof: Proof) -> None:
    r"""Friction force of any smooth shape.

    At every instant of every motion, with $l_{\mathrm{r}} = V \tau$ of that instant. Integrated over the
    contact, $F_x = l_{\mathrm{r}} \int h'' p \, dx - \frac{1}{2 K} (p_{\mathrm{LE}}^2 - p_{\mathrm{TE}}^2)$.
    """
    inner = K * (delta - h(x)) + C * (depth_rate_now - V * sp.Derivative(h(x), x))
    bending = C * V * sp.Derivative(h(x), (x, 2))
    proof.define(_pressure(x), inner, "Eqs. (6), (7) and (12) for a dense row")
    proof.define(l_r, C * V / K, "Eqs. (22) and (29)")
    work = -sp.Derivative(h(x), x) * _pressure(x)
    result = sp.Derivative(_pressure(x) ** 2, x) / (2 * K) + bending / K * _pressure(x)
    proof.equal(work, result, "the integrand of Eq. (15)",
                right=r"\frac{1}{2 K} \frac{d}{d x} p^2 + l_{\mathrm{r}} h'' p")  # fmt: skip


@result("F21", uses=("F21-shape",))
def _instant(proof: Proof) -> None:
    """Friction force at every instant.

    For the parabola, for any drive and any motion of the indenter, under any support; LE and TE are the two
    ends of the contact, whichever way they move, and $V$ has its sign.
    """
    whole = l_r / R * F_z - (p_le**2 - p_te**2) / (2 * K)
    load, squares = sp.Integral(_pressure(x), _CONTACT), sp.Symbol("I_p", real=True)
    inner = K * (delta - x**2 / (2 * R)) + C * (depth_rate_now - V * x / R)
    slope = -K / R * (x + l_r)
    proof.recall("eq29", C)
    proof.notation["p"] = sp.Lambda(x, inner)
    reason = r"neither $\delta$ nor $\dot\delta$ matters"
    proof.equal(sp.Derivative(inner, x), slope, reason, left="p'")
    del proof.notation["p"]
    square = sp.Derivative(_pressure(x) ** 2, x)
    proof.integral(squares, square.doit(), _CONTACT, _pressure(x) ** 2, "for a continuous pressure")
    proof.equal(
        *(-x / R * _pressure(x), slope * _pressure(x) / K + l_r / R * _pressure(x),
          r"the integrand of Eq. (15); the first term is $p\, p'/K$"),
    )  # fmt: skip
    proof.define(F_z, load, "Eq. (14)")
    proof.define(_pressure(x_le), p_le, "at the leading edge")
    proof.define(_pressure(x_te), p_te, "at the trailing edge")
    proof.define(F_x, squares / (2 * K) + l_r / R * load, "integrated, term by term")
    proof.equal(F_x, whole, "friction without an integral")


@result("F21-load")
def _load(proof: Proof) -> None:
    r"""Load of steady sliding in one line.

    With $r = \sqrt{a^2 + l_{\mathrm{r}}^2}$.
    """
    proof.recall("eq28", delta)
    proof.define(r, sp.sqrt(a**2 + l_r**2), r"$x_{\mathrm{TE}} = r - l_{\mathrm{r}}$, Eq. (27)")
    centred = K / (2 * R) * (r**2 - (x + l_r) ** 2)
    proof.equal(steady.pressure, centred, "the pressure of steady sliding")
    primitive = K / (2 * R) * ((a**2 + l_r**2) * x - (x + l_r) ** 3 / 3)
    proof.integral(W, centred, (x, -a, r - l_r), primitive, "Eq. (14)", value=LOAD)


@result("F21-steady", uses=("pressure", "eq26", "eq27"))
def _steady(proof: Proof) -> None:
    r"""Friction force of steady sliding in one line.

    With F21-load, $W = \frac{K}{3 R} (a^3 + r^3 - l_{\mathrm{r}}^3)$, this is all of steady sliding.
    """
    proof.recall("F21")
    proof.recall("eq26")
    proof.recall("eq28", delta)
    proof.recall("eq29", C)
    proof.recall("scaling", x_te, l_r, l)
    for edge, place in ((p_te, x_te), (p_le, x_le)):
        proof.define(edge, steady.pressure.subs(x, place), "the pressure of steady sliding")
    proof.equal(p_te, sp.S.Zero, "none at the trailing edge")
    proof.equal(p_le, K * l_r * a / R, "at the leading edge only the damper acts")
    proof.recall("F21-load")
    proof.define(r, sp.sqrt(a**2 + l_r**2))
    proof.define(F_z, W, "steady load")
    proof.define(F, F_x, "steady friction force")
    proof.equal(F, FRICTION, "the total friction force")
    proof.recall("eq37")
    proof.equal(mu, l_r / R * (1 - C * V * delta / W), "Eq. (42), and the terms that it neglects")
    exact = steady.friction.subs(delta, a**2 / (2 * R))
    proof.equal(F, exact, "the same as by the integral of Eq. (15)")
    proof.done(F, FRICTION)
