r"""The errors of the asymptotes of a power law: exact relative errors, stable in both limits (F19).

Every error is asymptote/exact - 1 in terms of l, q and Q. The factors that vanish at rest are the peeled
parts 1 - q and 1 - Q and the bend l - (1 - q), which have forms without cancellation.
"""

from dataclasses import dataclass

import sympy as sp
from sympy.codegen.cfunctions import expm1, log1p

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .power_law import (
    SECTION, Q, excess, in_q, n, phi_n, w_n, y, z,
)  # fmt: skip
from .power_law_limits import m_high, m_low, w_rest
from .steady import l, q

(
    gap_edge, gap_slope, bend, phi_rise, phi_fall, psi, omega, blunt, damped, sharp, tip, whole,
    e_n_l1, e_n_l2, e_n_load_low, e_n_load_high, e_n_friction_low, e_n_friction_high,
    e_n_depth_high,
) = symbols(r"""
    gap_q       \bar q            1  -
    gap_Q       \bar Q            1  $1 - Q$
    bend        b_n               1  $l - (1 - q)$, the difference of $l$ and $1 - q$  real
    -           \phi_2            1  $\phi_2(x) = (e^x - 1 - x)/x^2$, as in exponential integrators
    phi_rise    \phi_{2,+}        1  $\phi_2$ at a positive argument
    phi_fall    \phi_{2,-}        1  $\phi_2$ at a negative argument
    psi         -                 1  logarithmic slope of $\varphi_n$ over $l$
    omega       -                 1  logarithmic slope of $w_n$ over $l$
    -           \varrho           1  $1 - \psi$, positive because $\varphi_n/l$ falls
    blunt       D_{\mathrm{b}}    1  part of $e_{\mathrm{L2},n} l D_{\mathrm{d}}$ that vanishes for a
            wedge
    damped      D_{\mathrm{d}}    1  $(2 n - 1) \varphi_n/(n^2 l)$
    sharp       D_{\mathrm{s}}    1  part of $e_{\mathrm{L2},n} l D_{\mathrm{d}}$ that remains for a wedge
    tip         D_{\mathrm{t}}    1  $n (n + 1) (w_n - l)$
    whole       D_{\mathrm{w}}    1  $(n + 1) w_n/n$
    e_L1_n      e_{\mathrm{L1},n}  1  relative error of the asymptote for low velocity, power law  real
    e_L2_n      e_{\mathrm{L2},n}  1  relative error of the asymptote for high velocity, power law  real
    e_W_low_n   e_{W\!,\,V\to0,n}  1  relative error of the load for low velocity, power law  real
    e_W_high_n  e_{W\!,\,V\to\infty,n}  1  relative error of the load for high velocity, power law  real
    e_F_low_n   e_{F\!,\,V\to0,n}  1  relative error of the friction force for low velocity, power
            law  real
    e_F_high_n  e_{F\!,\,V\to\infty,n}  1  relative error of the friction force for high velocity, power
            law  real
    e_depth_high_n  e_{\delta,\,V\to\infty,n}  1  relative error of the depth for high velocity, power
            law  real
    -           j                 1  counter  from counter
""")  # fmt: skip

_SHORT = {
    damped: 1 + q * Q**2 + (2 * n - 1) * l * Q**2 / 2,
    whole: 1 + q + l + l**2 * Q,
    tip: n**2 + q * (n**2 - 1 + q * Q),
    blunt: (n - 1) * (2 * n**2 - 1 + 2 * (n + 1) * q * (n + Q)) / (2 * n**2 * (n + 1)),
    sharp: q**2 * Q * (2 * n / (n + 1) + Q) / (2 * n**2),
}
"""Shorthands: (2 n - 1) phi_n/(n**2 l), (n + 1) w_n/n, n (n + 1) (w_n - l), and the two parts of the
error for high velocity, of which a wedge has the second only."""


_SOURCES = {
    w_n: "F19-load", phi_n: "F19-friction", w_rest: "F19-low", m_low: "F19-low", m_high: "F19-high",
}  # fmt: skip


@dataclass(frozen=True)
class Asymptote:
    """An asymptote over the exact value, and the form of its error."""

    label: str
    title: str
    symbol: sp.Symbol
    ratio: sp.Expr
    form: sp.Expr
    limit: str
    """What it tends to, in words."""


ASYMPTOTES = (
    Asymptote("L1", "friction coefficient at low velocity", e_n_l1, m_low * l * w_n / phi_n,
              (q * gap_slope * (1 + Q) + l + l**2 * Q - (2 * n - 1) * l * Q**2 / 2) / damped,
              r"$\frac{2 n - 1}{4}\, l$ at low velocity"),
    Asymptote(
        *("L2", "friction coefficient at high velocity", e_n_l2),
        m_high * w_n / phi_n,
        (blunt + sharp) / (l * damped),
        r"$\frac{(n - 1)(2 n^2 - 1)}{2 n^2 (n + 1)}\, l^{-1}$ at high velocity; no term is negative",
    ),
    Asymptote("load-low", "load at low velocity", e_n_load_low, w_rest / w_n,
              -(l**2 * Q + bend) / whole, r"$-\frac{n + 1}{4}\, l^2$ at low velocity"),
    Asymptote("load-high", "load at high velocity", e_n_load_high, l / w_n, -tip / (n**2 * whole),
              r"$-\frac{n}{n + 1}\, l^{-1}$ at high velocity"),
    Asymptote("friction-low", "friction force at low velocity", e_n_friction_low,
              2 * m_high * l / phi_n,
              (gap_edge + q * gap_slope * (1 + Q) - (2 * n - 1) * l * Q**2 / 2) / damped,
              r"$\frac{2 n - 1}{4}\, l$ at low velocity"),
    Asymptote("friction-high", "friction force at high velocity", e_n_friction_high,
              m_high * l / phi_n, -(q * Q**2 + (2 * n - 1) * l * Q**2 / 2) / damped,
              r"$-\frac{2 n - 1}{2 n^2}\, l^{-1}$ at high velocity"),
    Asymptote("depth-high", "depth at high velocity, dead weight", e_n_depth_high, w_n / l,
              tip / (n * (n + 1) * l), r"$\frac{n}{n + 1}\, l^{-1}$ at high velocity"),
)  # fmt: skip

result = Chapter(SECTION)


@result("F19-peeled")
def _peeled(proof: Proof) -> None:
    r"""Power law: the peeled parts.

    For small $z = n l Q = 1 - q^n$ the differences $1 - q$ and $1 - Q$ follow from $z$ by the functions
    $\operatorname{log1p}(x) = \ln(1 + x)$ and $\operatorname{expm1}(x) = e^x - 1$.
    """
    logarithm = log1p(-z)
    edge, slope = expm1(logarithm / n), expm1((n - 1) * logarithm / n)
    proof.define(logarithm, sp.log(1 - z), "accurate for small $z$")
    for power in (edge, slope):
        proof.define(power, sp.exp(power.args[0]) - 1, r"accurate for small arguments")
    in_q(proof)
    proof.define(z, 1 - q**n, "$z = n l Q$")
    proof.define(gap_edge, 1 - q, "the peeled part of the outlet side")
    proof.equal(gap_edge, -edge, "without a difference")
    proof.define(gap_slope, 1 - Q, "the decrease of the slope there")
    proof.equal(gap_slope, -slope, "without a difference")


@result("F19-bend")
def _bend(proof: Proof) -> None:
    r"""Power law: the bend of the trailing edge.

    With $\phi_2(x) = (e^x - 1 - x)/x^2 = \sum_k x^k/(k + 2)!$, a sum of positive terms for $x > 0$, and $y =
    -\ln q$.
    """
    form = (n - 1) * y**2 * ((n - 1) * phi_rise + phi_fall) / n
    in_q(proof)
    proof.define(q, sp.exp(-y), r"$y = -\ln q$")
    proof.define(phi_rise, (sp.exp((n - 1) * y) - 1 - (n - 1) * y) / ((n - 1) * y) ** 2,
                 r"$\phi_2((n - 1) y)$")  # fmt: skip
    proof.define(phi_fall, (sp.exp(-y) - 1 + y) / y**2, r"$\phi_2(-y)$")
    proof.define(bend, l - (1 - q), "the difference of $l$ and $1 - q$")
    proof.equal(bend, form, "without a difference")


def _error(proof: Proof, asymptote: Asymptote) -> None:
    in_q(proof)
    for part, difference, label in (
        (gap_edge, 1 - q, "F19-peeled"), (gap_slope, 1 - Q, "F19-peeled"), (bend, l - (1 - q), "F19-bend"),
    ):  # fmt: skip
        if asymptote.form.has(part):
            proof.recall(label, (part, difference))
    for part, sum_of in _SHORT.items():
        if asymptote.form.has(part):
            proof.define(part, sum_of, "a shorthand")
    for part, label in _SOURCES.items():
        if asymptote.ratio.has(part):
            proof.recall(label, part)
    proof.define(asymptote.symbol, asymptote.ratio - 1, "asymptote over exact value")
    proof.equal(asymptote.symbol, asymptote.form, "in this form exact also where it is small")


for _each in ASYMPTOTES:
    result(
        f"F19-error-{_each.label}", title=f"Power law: error of the {_each.title}",
        text=f"The asymptote over the exact value is 1 plus this error, which tends to {_each.limit}.",
        asymptote=_each,
    )(_error)  # fmt: skip


@result("F19-error-monotonic")
def _monotonic(proof: Proof) -> None:
    r"""Power law: the errors are monotonic.

    At a given depth this is F19-monotonic: $w_n$ and $m_n$ grow with $l$, and $w_n/l$, $\varphi_n/l$ and
    $m_n/l$ fall. Under a dead weight $d \ln s/d \ln l = -\omega/(n + 1)$ (F19-balance), under a spring
    between that and 0: the error of the asymptote for low velocity grows with the velocity (for $n > 2$
    the spring only reduces a positive term).

    Argued: The asymptote for high velocity over the exact value is $(W_\infty/W)^{1 - 1/n} (w_n/l)^{1 -
    1/n}/m_n$, each factor of which falls. So each asymptote is within a tolerance on a half-line of
    velocities.
    """
    rest = sp.Symbol("varrho", positive=True)
    proof.define(psi, 1 - rest, r"$d \ln \varphi_n/d \ln l < 1$, because $\varphi_n/l$ falls")
    sinking = -omega / (n + 1)
    slope = (2 - n) * sinking + 1 - (psi - omega)
    form = rest + (n + excess) * omega / (n + 1)
    proof.define(n, 1 + excess, r"$n > 1$")
    proof.equal(slope, form, r"logarithmic slope of $s^{2 - n}\, l/m_n$, that is, of $L_1/\mu$")
    proof.holds(form, ">", 0, r"$\omega = d \ln w_n/d \ln l > 0$")
    proof.done(slope, form)
