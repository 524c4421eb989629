r"""Friction on any viscoelastic body (F28, F29): both asymptotes from one elastic contact.

The body answers a displacement w of its surface with the pressure A[w], times a modulus that depends on time.
Of A only this is used: it is symmetric, and the same at every place. Independent elements, a layer and a
half-space are three such bodies.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof
from .layer import modulus
from .model import R, V, delta, h, x
from .steady import F, W, mu

(
    first, last, arm_1, arm_2, time_1, time_2, glassy, mean_time, fading_rate, rate, answer, change, kept,
    damped, faded, stored, stiff, power, depth,
) = symbols(r"""
    x_1      -                m    place ahead of a contact, outside of it  real
    x_2      -                m    place behind it, outside of it  real
    E_1      -                Pa   modulus of one arm of a body  from scene
    E_2      -                Pa   modulus of another arm  from scene
    tau_1    -                s    relaxation time of an arm  from scene
    tau_2    -                s    relaxation time of another arm  from scene
    E_g      E_{\mathrm{g}}   Pa   glassy modulus of a body
    tau_E    \tau_E           s    integral of the fading part of the modulus over the relaxed modulus
    r_E      -                1/s  rate at which the glassy modulus begins to fade
    s_E      -                1/s  rate of a process that goes as $e^{s_E t}$
    E_s      E_s              Pa   modulus of a body for a process of one rate
    E_c      E_{\mathrm{c}}   Pa   change of the modulus of a body to first order
    J_1      -                N/m  force without dissipation  real
    J_2      -                Pa   force for a pressure that goes as the rate, per unit of it  real
    J_3      -                N    force for a pressure that goes as the integral, per unit of it  real
    U_g      U_{\mathrm{g}}   N    elastic energy of the glassy contact
    b_E      -                N/m  load of the elastic contact at the depth $\delta$
    m_E      -                1    power of the depth with which a load goes
    d_E      -                m    depth on the way to $\delta$
""")  # fmt: skip
displacement = function("w_0", "displacement of the surface into the body", "m", real=True)
pressure = function("p_0", "pressure of the elastic contact, at rest or glassy", "Pa", real=True)
summed = function("q_0", "its integral along the motion", "Pa m", real=True)

SECTION = "Any viscoelastic body"
w, P, Q = displacement(x), pressure(x), summed(x)
ALL = (x, first, last)
_d = sp.Derivative
MODULUS = (
    modulus
    + arm_1 * rate * time_1 / (1 + rate * time_1)
    + arm_2 * rate * time_2 / (1 + rate * time_2)
)
BENDING = sp.Integral(_d(h(x), (x, 2)) * P, ALL)
result = Chapter(SECTION)


def _modulus(proof: Proof) -> None:
    proof.define(answer, MODULUS, "a spring and two arms")


@result("F28-modulus")
def _slowly(proof: Proof) -> None:
    r"""A body that is deformed slowly.

    Shown with two arms; nothing depends on their number. $\tau_E$ is $\frac{1}{E_0} \int (E(t) - E_0) \, dt$.
    """
    _modulus(proof)
    proof.define(mean_time, (arm_1 * time_1 + arm_2 * time_2) / modulus, "of the arms")
    proof.leading_order(answer, modulus, rate, 0, "slow")
    c = mean_time * modulus
    proof.leading_order(answer - modulus, c * rate, rate, 0,
                        "so the modulus is $E_0 (1 + \\tau_E s_E)$")  # fmt: skip


@result("F29-modulus")
def _quickly(proof: Proof) -> None:
    r"""A body that is deformed quickly.

    $r_E$ is $-E'(0)/E(0)$.
    """
    _modulus(proof)
    proof.define(glassy, modulus + arm_1 + arm_2, "nothing has relaxed")
    proof.define(fading_rate, (arm_1 / time_1 + arm_2 / time_2) / glassy, "of the arms")
    proof.leading_order(answer, glassy, rate, sp.oo, "quick")
    proof.leading_order(glassy - answer, fading_rate * glassy / rate, rate, sp.oo,
                        "so the modulus is $E_{\\mathrm{g}} (1 - r_E/s_E)$")  # fmt: skip


def _symmetric(proof: Proof, *vanishing: sp.Expr) -> None:
    """Prove that a symmetric body without memory gives no friction."""
    for end in vanishing:
        proof.define(end, sp.S.Zero, "outside the contact" if end.func == pressure else "far away")
    half = (_d(w, x) * P + w * _d(P, x)) / 2
    proof.define(kept, sp.Integral(half, ALL), r"$\int w_0' p_0 \, dx$, as $A$ is symmetric")
    proof.integral(kept, half, ALL, "a body without memory makes no friction",
                   antiderivative=w * P / 2)  # fmt: skip


@result("F28")
def _slow(proof: Proof) -> None:
    r"""Any viscoelastic body: friction at low velocity.

    The mean of $h''$ over the elastic contact at rest, weighted by its pressure. In steady sliding
    $\frac{\partial}{\partial t}$ is $V \frac{\mathrm{d}}{\mathrm{d} x}$, which stands for $s_E$; $p_0'$ is
    $A[w_0']$, because $A$ is the same at every place. It holds for a contact of any width across, with the
    integral over the area.

    Argued: To first order in $V$ surface and contact are those at rest, as the pressure vanishes at the
    edges.
    """
    proof.asymptote("F28-modulus", answer - modulus, change)
    _symmetric(proof, pressure(first), pressure(last))
    parts = _d(w, x) * _d(P, x) + _d(w, (x, 2)) * P
    whole, rest = sp.Integral(parts, ALL), sp.Integral(_d(w, (x, 2)) * P, ALL)
    proof.define(damped, whole - rest, "by parts")
    proof.equal(damped, sp.Integral(_d(w, x) * _d(P, x), ALL), "for a pressure that is as the rate")
    proof.integral(whole, parts, ALL, "no pressure at the ends", value=sp.S.Zero,
                   antiderivative=_d(w, x) * P)  # fmt: skip
    proof.define(F, kept + V * change / (modulus * rate) * damped,
                 r"$\int w_0' p \, dx$ with $p = p_0 + V \tau_E p_0'$")  # fmt: skip
    proof.define(_d(w, (x, 2)), -_d(h(x), (x, 2)), r"in the contact, $w_0 = \delta - h$")
    proof.equal(F, V * mean_time * BENDING, "friction force")
    proof.define(W, sp.Integral(P, ALL), "the load")
    proof.recall("eq37")
    proof.equal(mu, V * mean_time * BENDING / sp.Integral(P, ALL), "the friction coefficient")


@result("F28-parabola")
def _parabola(proof: Proof) -> None:
    r"""Any viscoelastic body: friction of a parabola or a ball at low velocity.

    It does not depend on the body: Eq. (42), where $\tau_E$ is $C/K$.
    """
    proof.recall("F28", (F, V * mean_time * BENDING), W)
    proof.define(_d(h(x), (x, 2)), 1 / R, "Eq. (3)")
    proof.define(_d(Q, x), P, "a primitive of the pressure")
    ends = summed(last) - summed(first)
    proof.integral(BENDING, _d(h(x), (x, 2)) * P, ALL, "of a constant curvature", value=ends / R,
                   antiderivative=Q / R)  # fmt: skip
    proof.integral(W, P, ALL, "the load", value=ends, antiderivative=Q)
    proof.equal(F, V * mean_time / R * W, "a constant is its own mean")
    proof.recall("eq37")
    proof.equal(mu, V * mean_time / R, "the friction coefficient")


@result("F29")
def _fast(proof: Proof) -> None:
    r"""Any viscoelastic body: friction at high velocity.

    $p_0$ and $w_0$ are those of the elastic contact with the glassy modulus, $U_{\mathrm{g}} = \frac{1}{2}
    \int p_0 w_0 \, dx$ is its energy, and $q_0$ the pressure that belongs to $\int w_0 \, dx$, which stands
    for $V w_0/s_E$.

    Argued: To first order in $1/V$ surface and contact are those of the glassy body, and the displacement
    vanishes before and behind.
    """
    proof.asymptote("F29-modulus", glassy - answer, change)
    _symmetric(proof, pressure(first), pressure(last), displacement(first), displacement(last))
    proof.define(_d(Q, x), P, "$A$ is the same at every place")
    parts = _d(w, x) * Q + w * P
    whole, rest = sp.Integral(parts, ALL), sp.Integral(w * P, ALL)
    proof.define(faded, whole - rest, "by parts")
    proof.equal(faded, sp.Integral(_d(w, x) * Q, ALL), "for a pressure that goes as the integral")
    proof.integral(whole, parts, ALL, "no displacement at the ends", value=sp.S.Zero,
                   antiderivative=w * Q)  # fmt: skip
    proof.define(F, kept - change * rate / (glassy * V) * faded,
                 r"$\int w_0' p \, dx$ with $p = p_0 - (r_E/V) q_0$")  # fmt: skip
    proof.define(rest, 2 * stored, "the elastic energy")
    proof.equal(F, 2 * stored * fading_rate / V, "friction force")
    proof.recall("eq37")
    proof.equal(mu, fading_rate / V * 2 * stored / W, "the friction coefficient")


@result("F29-power")
def _of_depth(proof: Proof) -> None:
    r"""Any viscoelastic body: friction at high velocity, from the depth.

    Where the load of the elastic contact goes with a power of the depth.
    """
    proof.recall("F29")
    ratio = depth / delta
    proof.define(W, stiff, r"the load, which goes with $\delta^{m_E}$")
    proof.integral(stored, stiff * ratio**power, (depth, 0, delta), "the work of the load")
    proof.equal(mu, fading_rate / V * 2 * delta / (power + 1), "the friction coefficient")


def _case(proof: Proof, exponent: sp.Expr, factor: sp.Expr) -> None:
    proof.recall("F29-power")
    proof.define(power, exponent, "the load over the depth")
    proof.equal(mu, fading_rate / V * factor * delta, "the friction coefficient")


for _label, _what, _exponent, _factor, _text in (
    ("line", "a parabola on independent elements", sp.Rational(3, 2), sp.Rational(4, 5),
     r"""$W = \frac{4}{3} K \sqrt{2 R} \delta^{3/2}$. As $\frac{4}{5} \delta = \frac{2}{5} a^2/R$, this is
     F18-high."""),
    ("ball", "a ball on independent elements", sp.S(2), sp.Rational(2, 3),
     r"$W = \pi K R \delta^2$, $K$ the glassy stiffness."),
    ("Hertz", "a ball on a half-space", sp.Rational(3, 2), sp.Rational(4, 5),
     r"Hertz: $W$ goes with $\delta^{3/2}$."),
):  # fmt: skip
    result(f"F29-{_label}", title=f"Any viscoelastic body: high velocity, {_what}", text=_text,
           exponent=_exponent, factor=_factor)(_case)  # fmt: skip
