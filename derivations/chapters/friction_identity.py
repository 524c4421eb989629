r"""Friction without integrals (F21): the friction force from the load and the pressure at the edges.

In the contact of a parabola the pressure has the slope -(K/R)(x + l_r), at every instant of every motion.
So x p is a multiple of p plus a derivative of p**2, and the friction force needs no separate integral.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from . import steady
from .model import C, F_x, F_z, K, R, V, delta, delta_t, depth_rate, h, x
from .steady import F, W, a, l, l_r, mu, p, x_le, x_te

p_le, p_te, r = symbols(r"""
    p_LE     p_{\mathrm{LE}}  Pa   pressure at the leading edge  real
    p_TE     p_{\mathrm{TE}}  Pa   pressure at the trailing edge  real
    r        -                m    half the distance of the zeros of the pressure, $\sqrt{a^2 +
            l_{\mathrm{r}}^2}$  prints \bar r
""")


LOAD = K * (a**3 + r**3 - l_r**3) / (3 * R)
"""W, with r = sqrt(a**2 + l_r**2) = x_TE + l_r."""
FRICTION = l_r * (W - C * V * delta) / R

result = Chapter("Friction without integrals")


@result("F21-shape")
def _any_shape(proof: Proof) -> None:
    r"""Friction force of any smooth shape.

    At every instant of every motion, with $l_{\mathrm{r}} = V \tau$ of that instant. Integrated over the
    contact, $F_x = l_{\mathrm{r}} \int h'' p \, dx - \frac{1}{2 K} (p_{\mathrm{LE}}^2 - p_{\mathrm{TE}}^2)$.
    """
    _recall_pressure(proof)
    bending = C * V * sp.Derivative(h(x), (x, 2))
    proof.recall("eq29", C)
    work = -sp.Derivative(h(x), x) * p
    result = sp.Derivative(p**2, x) / (2 * K) + bending / K * p
    proof.equal(work, result, "the integrand of Eq. (15)")


@result("F21")
def _instant(proof: Proof) -> None:
    """Friction force at every instant.

    For the parabola, for any drive and any motion of the indenter, under any support; LE and TE are the two
    ends of the contact, whichever way they move, and $V$ has its sign.
    """
    _recall_pressure(proof)
    proof.recall("eq3", "eq29", C)
    slope = -K / R * (x + l_r)
    reason = r"neither $\delta$ nor $\dot\delta$ matters"
    proof.equal(sp.Derivative(p, x), slope, reason)
    proof.equal(-x / R * p, slope * p / K + l_r / R * p,
                r"the integrand of Eq. (15); the first term is $p\, p'/K$")  # fmt: skip
    terms = (K * delta_t + C * depth_rate, 0), (-C * V / R, 1), (-K / (2 * R), 2)
    for force, power, factor, density, reason in (
        (F_z, 1, sp.S.One, p, "for a dense row, a polynomial of the edges"),
        (F_x, 2, -1 / R, -h(x).diff(x) * p, "and along the foundation"),
    ):
        proof.recall("dense-row", force)
        parts = [(factor * each / (power + order), power + order) for each, order in terms]
        value = sum(part * (x_te**n - x_le**n) for part, n in parts)
        proof.integral(force, density, steady.CONTACT, reason, value=value)
    proof.define(p_le, sp.Subs(p, x, x_le), "at the leading edge")
    proof.define(p_te, sp.Subs(p, x, x_te), "at the trailing edge")
    whole = l_r / R * F_z - (p_le**2 - p_te**2) / (2 * K)
    proof.equal(F_x, whole, "friction without an integral")


def _recall_pressure(proof: Proof) -> None:
    """Let the pressure be that of the movable indenter at any instant."""
    proof.recall("pressure-moving", p)


@result("F21-load")
def _load(proof: Proof) -> None:
    """Load of steady sliding in one line."""
    proof.recall("eq26", "eq27", "pressure", "eq28", delta)
    proof.define(r, sp.sqrt(a**2 + l_r**2), r"$x_{\mathrm{TE}} = r - l_{\mathrm{r}}$, Eq. (27)")
    centred = K / (2 * R) * (r**2 - (x + l_r) ** 2)
    proof.equal(p, centred, "the pressure of steady sliding")
    proof.recall("dense-row", F_z)
    proof.integral(F_z, p, steady.CONTACT, "Eq. (14) for a dense row", value=LOAD)
    proof.define(W, F_z, "in steady sliding")
    proof.equal(W, LOAD, "the load")


@result("F21-steady")
def _steady(proof: Proof) -> None:
    r"""Friction force of steady sliding in one line.

    With the load of F21-load this is all of steady sliding.
    """
    proof.recall("F21", at={delta_t: delta})
    proof.recall("eq26", "pressure", "eq28", delta, "eq29", C, "scaling", x_te, l_r, l)
    for edge, place in ((p_te, x_te), (p_le, x_le)):
        proof.define(edge, sp.Subs(p, x, place), "the pressure of steady sliding")
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
