r"""A power law at a given depth over velocity: monotonicity, both limits, and their crossing (F19)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .power_law import (
    HIGH_COEFFICIENT, LOW_SLOPE, SECTION, SQUARES, Q, excess, in_q, m_n, n, phi_n, w_n, z,
)  # fmt: skip
from .steady import l, q

w_rest, w_l, phi_l, m_low, m_high, l_cross, more_load, more_work = symbols(r"""
    -        \bar z        1  $1 - q^n$
    w_rest   w_{n,0}       1  scaled load of a power law at rest
    w_l      w_n'          1  -
    phi_l    \varphi_n'    1  -
    m_low    m_{n,0}'      1  friction coefficient of a power law at low velocity, over $l$
    m_high   m_{n,\infty}  1  friction coefficient of a power law at high velocity
    l_cross  l^{*}         1  scaled retardation length where the asymptotes meet
    e_w      e_w           1  $w_n/l$ less its limit at high velocity
    e_phi    e_{\varphi}   1  $\varphi_n/l$ less its limit at high velocity
""")

AT_REST = 2 * n / (n + 1)
"""w_n of a contact at rest."""

result = Chapter(SECTION)


@result("F19-monotonic")
def _monotonic(proof: Proof) -> None:
    r"""Power law: forces grow with velocity.

    At a given depth load, friction force and friction coefficient grow with the velocity, while $w_n/l$,
    $\varphi_n/l$ and with them $m_n/l$ fall. A prime is the derivative with respect to $l$.
    """
    in_q(proof)
    proof.recall("F19-load", "F19-friction")

    for name, form, growth, reason in (
        (w_l, w_n, n * l * Q, "the load grows"),
        (phi_l, phi_n, n**2 * SQUARES, "and so does friction"),
    ):
        proof.define(name, sp.Derivative(form, q) / sp.Derivative(l, q), "chain rule")
        proof.equal(name, growth, reason)
    rest = n * (1 + q + l * q * Q) / (n + 1)
    proof.equal(w_n - l * w_l, rest, "$w_n/l$ falls: positive")
    less = n**2 * l**2 * Q**2 / 2
    proof.equal(phi_n - l * phi_l, less, r"$\varphi_n/l$ falls: positive")
    z, double = n * l * Q, n + excess
    growth = excess * (n**2 + excess * (n + 1)) + (n + 1) * double * q**n * (1 + z + z**2)
    growth += 2 * n**3 * q * (Q**2 + (1 + q * Q**2) * (1 + l * Q))
    gain = phi_l * w_n - phi_n * w_l
    proof.equal(2 * (n + 1) * (2 * n - 1) * gain, growth, "the friction coefficient grows")
    proof.holds(growth, ">", 0, r"with $\nu = n - 1$ each term is positive")
    proof.done(w_n - l * w_l, rest)


@result("F19-low")
def _low(proof: Proof) -> None:
    r"""Power law: low velocity.

    At rest $q = Q = 1$ and $l = 0$. The load tends to the load at rest, $w_{n,0}$ in units of $K \delta
    a$, and $\mu$ to $m_{n,0}' l$ in units of $\delta/a$.
    """
    rest = (q, Q, l), (1, 1, 0)
    proof.recall("F19-load", "F19")
    proof.define(w_rest, sp.Subs(w_n, *rest), "load at rest")
    proof.equal(w_rest, AT_REST, "in units of $K \\delta a$")
    ratio = n * (n + 1) * (SQUARES + l * Q**2 / 2) / (1 + q + l + l**2 * Q)
    proof.equal(m_n / l, ratio, "friction coefficient per $l$, continuous at rest")
    proof.define(m_low, sp.Subs(ratio, *rest), "friction coefficient per $l$ at rest")
    proof.equal(m_low, LOW_SLOPE, r"in units of $\delta/a$")
    in_q(proof)
    proof.leading_order(w_n, AT_REST, q, 1, "the load tends to this")
    proof.leading_order(m_n / l, LOW_SLOPE, q, 1, "and friction to this, times $l$")
    proof.done(m_low, LOW_SLOPE)


@result("F19-high")
def _high(proof: Proof) -> None:
    r"""Power law: high velocity.

    For $l \to \infty$ what is left of the limits is at most of the order $1/l$: $W \to C V \delta$, which
    the damper carries, and $\mu \to \frac{\delta}{a} m_{n,\infty}$.
    """
    in_q(proof)
    proof.where(q < 1, "the edge is inside of its place at rest")
    proof.recall("F19-load", "F19-friction", "F19", (m_n, phi_n / w_n))
    proof.define(z, 1 - q**n, "a share")
    proof.define(m_high, HIGH_COEFFICIENT, r"the limit of $\mu$, in units of $\delta/a$")
    for name, whole, form, most, what in (
        (more_load, w_n / l - 1, (n * (1 + q) - q * z / n) / ((n + 1) * l), 2 * n / ((n + 1) * l),
         "load"),
        (more_work, phi_n / l - m_high, z**2 / (2 * l) + q * z**2 / ((2 * n - 1) * l**2),
         1 / (2 * l) + 1 / ((2 * n - 1) * l**2), "friction force"),
    ):  # fmt: skip
        proof.equal(whole, form, f"{what} per $l$, less its limit")
        proof.holds(form, ">", 0, "more than the limit")
        proof.holds(most, ">", form, "which it approaches")
        proof.define(name, whole, "by this")
    proof.equal(m_n, (m_high + more_work) / (1 + more_load), "friction coefficient")


@result("F19-crossing")
def _crossing(proof: Proof) -> None:
    """Power law: crossing of the asymptotes.

    At a given depth; for $n = 2$ this is Eq. (47).
    """
    proof.recall("F19-low", "F19-high", m_high)
    reason = r"the asymptotes meet, at $V^{*} \tau/a$"
    proof.root(m_low * l_cross - m_high, l_cross, n / (n + 1), reason)
