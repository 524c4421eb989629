r"""Steady sliding of a wedge h = c |x|: theorem F19 for n = 1, all in closed form.

While l = l_r/a < 1 the trailing edge is at a - l_r behind the tip; from l = 1 on it stays at the tip,
and the friction coefficient is the slope c of the wedge.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .model import C, K, delta, h, x
from .power_law import (
    FRICTION_COEFFICIENT, FRICTION_FORCE, LOAD, SECTION, Q, eta_n, m_n, n, phi_n, w_ahead, w_behind,
    w_n, y,
)  # fmt: skip
from .power_law_weight import scaled_n
from .steady import a, any_pressure, l, l_r, p, q
from .theorems import P, kappa, lam, s

inclination, side, held, s_peeling, s_peeled = symbols(r"""
    c_1   c       1  slope of a wedge  prints \hat c
    sigma_w  \hat \sigma  1  1 behind the tip of a wedge, $-1$ ahead of it  real
    held  \bar w  1  scaled load beyond the support of a wedge
    s_w1  s_1     1  half length of a wedge whose trailing edge is behind its tip  prints \hat a_1
    s_w2  s_2     1  half length of a wedge whose contact ends at its tip  prints \hat a_2
""")

c = inclination
PEELING, PEELED = {n: 1, Q: 1, l: 1 - q}, {n: 1, q: 0, Q: 1 / l}
"""The forms of a power law for n = 1: while the edge moves to the tip, and when it is there."""
SCALED_PEELING = 2 * held / (kappa + sp.sqrt(kappa**2 + 4 * held))
SCALED_PEELED = 2 * (1 + kappa) / (lam + kappa + sp.sqrt((lam + kappa) ** 2 + 2 * (1 + kappa)))

result = Chapter(SECTION)


@result("wedge-edge")
def _edge(proof: Proof) -> None:
    r"""Wedge: pressure and trailing edge.

    The indenter is $h = c\,|x|$, and $l = l_{\mathrm{r}}/a$ with $a = \delta/c$. The pressure jumps by $2 l K
    \delta$ at the tip. So $q = x_{\mathrm{TE}}/a = \max(0, 1 - l)$; the equation $Q (q + n l) = 1$ of a power
    law says the same for $n = 1$, with $Q = \min(1, 1/l)$, the limit of $q^{n - 1}$.
    """
    proof.recall("pressure", (p, any_pressure))
    proof.define(h(x), side * c * x, r"$\hat \sigma = 1$ behind the tip and $-1$ ahead of it")
    proof.define(delta, c * a, r"$h(a) = \delta$: the half length at rest")
    proof.recall("eq29", C)
    proof.define(l_r, l * a, "the retardation length over the half length")
    proof.define(P, sp.Subs(p, x, side * y * a) / (K * delta), r"at $x = \hat \sigma y a$, scaled")
    ahead = r"ahead of the tip, where it is largest, $1 + l$"
    proof.equal(P, 1 - y + l, ahead, cases=(sp.Eq(side, -1),))
    proof.equal(P, 1 - y - l, "behind the tip", cases=(sp.Eq(side, 1),))
    proof.define(side, sp.S.One, "behind the tip")
    proof.where(l < 1, "otherwise there is no contact behind the tip")
    proof.root(P, y, 1 - l, "the trailing edge", name=q)


def _forces(
    proof: Proof, state: dict[sp.Symbol, sp.Expr], edge: sp.Expr, load: sp.Expr, friction: sp.Expr
) -> None:
    if edge != 0:
        proof.recall("wedge-edge")
    proof.integral(w_ahead, 1 - y + l, (y, 0, 1), "ahead of the tip")
    rest = sp.S.Zero
    if edge != 0:
        rest = w_behind
        proof.integral(rest, 1 - y - l, (y, 0, edge), "behind it")
    proof.define(w_n, w_ahead + rest, r"$W/(K \delta a)$")
    proof.equal(w_n, load, "load")
    proof.define(phi_n, w_ahead - rest, r"$F/(K \delta^2)$, where $-h' = \pm c$")
    proof.equal(phi_n, friction, "friction force")
    proof.define(m_n, phi_n / w_n, r"$\mu/c$")
    proof.equal(m_n, friction / load, "friction coefficient")
    for name, general, own in (
        ("w_n", LOAD, load), (r"\varphi_n", FRICTION_FORCE, friction),
        ("m_n", FRICTION_COEFFICIENT, friction / load),
    ):  # fmt: skip
        form = general.subs({Q: state[Q], q: edge}).subs(n, 1)
        if form != own:  # otherwise the line would say nothing
            proof.equal(form, own, f"${name}$ of a power law, for $n = 1$")
    proof.define(eta_n, l * (1 + edge) / phi_n, r"$C V c^2 (x_{\mathrm{TE}} - x_{\mathrm{LE}})/F$")
    general = 2 * (1 + edge * state[Q] ** 2) / (2 * (1 + edge * state[Q] ** 2) + l * state[Q] ** 2)
    proof.equal(eta_n, general, "dissipated inside the contact, as for a power law")
    proof.done(m_n, friction / load)


result("wedge-peeling", title="Wedge: slow sliding", text="The contact reaches beyond the tip.",
       state=PEELING, edge=q, load=1 + l**2 / 2,
       friction=2 * l - l**2 / 2)(_forces)  # fmt: skip
result("wedge-peeled", title="Wedge: fast sliding",
       text=r"For $l \ge 1$: the contact ends at the tip.", state=PEELED, edge=sp.S.Zero,
       load=l + sp.Rational(1, 2), friction=l + sp.Rational(1, 2))(_forces)  # fmt: skip


@result("wedge-low")
def _slow(proof: Proof) -> None:
    r"""Wedge: low velocity.

    For $l \to 0$, in units of $c$; the error of the asymptote is $l/4$ at first order.
    """
    proof.recall("wedge-peeling")
    proof.leading_order(m_n, 2 * l, l, 0, "the asymptote")
    proof.root(2 * l - 1, l, sp.Rational(1, 2), r"it meets the other, $\mu = c$")
    slope = 4 * (1 - l) * (2 + l) / (2 + l**2) ** 2
    proof.equal(sp.Derivative(m_n, l), slope, r"$\mu$ grows until $l = 1$")
    proof.sign(slope, ">", 0, (l, 0, 1), "strictly")
    proof.done(m_n, 2 * l)


@result("wedge")
def _fast(proof: Proof) -> None:
    r"""Wedge: friction equals the slope.

    From $l_{\mathrm{r}} = a$ on the contact is on one flank only, so that $\mu = c$ exactly, at any depth and
    under any load: vertical lift does not reduce the friction coefficient of a sharp tip, and Eq. (50)
    requires a rounded one.
    """
    proof.recall("wedge-peeled", w_n, phi_n)
    proof.define(m_n, phi_n / w_n, r"$\mu/c$")
    proof.equal(m_n, sp.S.One, r"$\mu = c$")


def _depth(proof: Proof, source: str, name: sp.Symbol, root: sp.Expr, balance: sp.Expr) -> None:
    proof.root(balance, s, root, "its one positive root, without a difference", name=name)
    if name == s_peeling:
        proof.define(held, 1 + kappa - lam**2 / 2, r"positive, because $\lambda < 1$")
    proof.recall(source, w_n)
    proof.define(scaled_n, s**2 * w_n, r"$W/W_0$")
    proof.define(l, lam / s, r"$l = V \tau/a$")
    proof.equal(scaled_n + kappa * (s - 1) - 1, balance, "the balance of forces")
    switch = 3 * lam**2 / 2 + kappa * lam - (1 + kappa)
    proof.equal(sp.Subs(balance, s, lam), switch, r"which is negative if $s > \lambda$")
    proof.done(name, root)


_WEIGHT = (
    r"In units of the static state, $W_0 = K \delta_0^2/c$; $\kappa = 0$ is a dead weight. Sliding "
    r"is slow, $\lambda < s$, if $\frac{3}{2} \lambda^2 + \kappa \lambda < 1 + \kappa$, which is "
    r"the balance at $s = \lambda$; then $\lambda < 1$. No difference cancels."
)
for _regime, _sliding, _name, _root, _balance in (
    ("peeling", "slow", s_peeling, SCALED_PEELING, s**2 + kappa * s - held),
    ("peeled", "fast", s_peeled, SCALED_PEELED, s**2 / 2 + (lam + kappa) * s - (1 + kappa)),
):
    result(f"wedge-weight-{_regime}", title=f"Wedge: depth at a load, {_sliding} sliding", text=_WEIGHT,
           source=f"wedge-{_regime}", name=_name, root=_root, balance=_balance)(_depth)  # fmt: skip
