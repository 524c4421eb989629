"""The asymptotes of low and high velocity with their next order, and where they meet (Eqs. 40-50).

The paper estimates load and friction by integrals over the limiting contact. Each integral is
evaluated here as given, and compared with the exact load and with the friction force of F21.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import constant, symbols
from ..engine.step import Proof
from . import friction_identity
from .model import C, K, R, V, delta, h, x
from .steady import F, W, a, l, l_r, mu, q

load_excess, V_star, mu_low, mu_high, mu_high_weight, W_low, W_high, F_low, F_high = symbols(r"""
    W_e      W_{\mathrm{e}}     N/m  elastic part of the load  real
    V_star   V^{*}              m/s  crossing velocity, where the two asymptotes meet  from critical-fixed
    mu_low   \mu_{\mathrm{L1}}  1    asymptote of the friction coefficient for low velocity  from eq42
    mu_high  \mu_{\mathrm{L2}}  1    asymptote of the friction coefficient for high velocity  from eq45
    mu_high_weight  \mu_{\mathrm{L2\text{-}MI}}  1  asymptote for high velocity, dead weight
    W_low       W_{\mathrm{L1}}   N/m  asymptote of the load for low velocity
    W_high      W_{\mathrm{L2}}   N/m  asymptote of the load for high velocity
    F_low       F_{\mathrm{L1}}   N/m  asymptote of the friction force for low velocity
    F_high      F_{\mathrm{L2}}   N/m  asymptote of the friction force for high velocity
""")
alpha = constant(r"\alpha", 2 * sp.sqrt(2) / 3, r"$2 \sqrt{2}/3$")


third = sp.Rational(1, 3)
low_load = 2 * alpha * sp.sqrt(R) * K * delta ** sp.Rational(3, 2)
low_friction = 2 * alpha * C * V * delta ** sp.Rational(3, 2) / sp.sqrt(R)
low_coefficient = C * V / (R * K)
high_load = C * V * delta
high_friction = alpha * C * V * delta ** sp.Rational(3, 2) / sp.sqrt(R)
high_coefficient = alpha * sp.sqrt(delta / R)
high_coefficient_dead_weight = alpha * sp.sqrt(W / (R * C * V))
critical_fixed = alpha * K * sp.sqrt(R * delta) / C
critical_dead_weight = alpha ** (2 * third) * (R * K**2 * W) ** third / C

_SHAPE = x**2 / (2 * R)
_compression = delta - h(x)
_rate = -h(x).diff(x) * V
_low, _high = (q, 1), (q, 0)
_small = (V_star / V) ** sp.Rational(3, 2)
result = Chapter("Asymptotes")


def _recall_exact(proof: Proof) -> None:
    """Let half length, velocity, load and friction be expressions in q."""
    proof.recall("eq28", "scaling", l, l_r, V, "load", "F21-steady",
                 (F, friction_identity.FRICTION))  # fmt: skip


def _recall_coefficient(proof: Proof) -> None:
    _recall_exact(proof)
    proof.recall("eq37")


def _estimate(
    proof: Proof, force: sp.Symbol, integrand: sp.Expr, low: bool, leading: sp.Expr,
) -> None:  # fmt: skip
    """Evaluate the integral of the paper, and compare it with the exact force."""
    proof.recall("eq3")
    _recall_exact(proof)
    over = (x, -a, a if low else sp.S.Zero)
    reason = r"the integral of the paper, with $u = \delta - h$ and $\dot{u} = -h' V$"
    proof.integral(sp.Integral(integrand, over), integrand, over, reason, value=leading)
    point, small = (_low, l_r / a) if low else (_high, a / l_r)
    if force == F:
        spring = low_load if low else low_load / 2
        reason = f"what the spring carries: {'all' if low else 'half'} of the load at rest"
        proof.define(load_excess, W - C * V * delta, "F21 needs the load without the damper's part")
        proof.leading_order(load_excess, spring, *point, reason, eps=small)
        proof.equal(leading, l_r / R * spring, r"$l_{\mathrm{r}}/R$ times that")
    proof.leading_order(force, leading, *point, "the exact force", eps=small)


_Case = tuple[int, str, sp.Symbol, sp.Expr, sp.Expr]


def _estimates(low: bool, cases: tuple[_Case, ...]) -> None:
    """Add the estimates of the paper for low or high velocity."""
    for number, force_name, force, integrand, leading in cases:
        result(
            f"eq{number}", title=f"{force_name} at {'low' if low else 'high'} velocity",
            text=r"Here $\alpha = 2\sqrt{2}/3$; the remainder is that of the exact force.",
            force=force, integrand=integrand, low=low, leading=leading,
        )(_estimate)  # fmt: skip


_estimates(True, (
    (40, "Load", W, K * _compression, low_load),
    (41, "Friction force", F, -h(x).diff(x) * C * _rate, low_friction),
))  # fmt: skip


@result("eq42")
def _low_coefficient(proof: Proof) -> None:
    r"""Friction coefficient at low velocity.

    The asymptotes $\mathrm{L}_{1\mathrm{-FI}}$ and $\mathrm{L}_{1\mathrm{-MI}}$ are the same: neither depth
    nor load enters.
    """
    _recall_coefficient(proof)
    proof.asymptote("eq40", W, W_low)
    proof.asymptote("eq41", F, F_low)
    proof.equal(F_low / W_low, low_coefficient, "Eqs. (40) and (41)")
    proof.leading_order(mu, low_coefficient, *_low, "exact $F/W$", eps=l_r / a)


_estimates(False, (
    (43, "Load", W, C * _rate, high_load),
    (44, "Friction force", F, -h(x).diff(x) * C * _rate, high_friction),
))  # fmt: skip


@result("eq45")
def _high_coefficient(proof: Proof) -> None:
    """Friction coefficient at high velocity, fixed indenter."""
    _recall_coefficient(proof)
    proof.asymptote("eq43", W, W_high)
    proof.asymptote("eq44", F, F_high)
    proof.equal(F_high / W_high, high_coefficient, "Eqs. (43) and (44)")
    proof.leading_order(mu, high_coefficient, *_high, "exact $F/W$", eps=a / l_r)


@result("eq46")
def _high_dead_weight(proof: Proof) -> None:
    """Friction coefficient at high velocity, dead weight.

    The load $W$ is given. The velocity $V^{*}$ is where this asymptote meets that of low velocity
    (critical-dead-weight).
    """
    _recall_coefficient(proof)
    reason = "exact $F/W$ at the load $W$"
    proof.leading_order(mu, high_coefficient_dead_weight, *_high, reason, eps=a / l_r)
    proof.define(V_star, critical_dead_weight, "a scale of velocity")
    proof.leading_order(mu, high_coefficient_dead_weight, *_high, "in this scale", eps=_small)


def _critical(proof: Proof, high: str, critical: sp.Expr) -> None:
    proof.asymptote("eq42", mu, mu_low)
    proof.asymptote(high, mu, mu_high)
    proof.define(V, V_star, "at the velocity at which")
    proof.root(mu_low - mu_high, V_star, critical, "the two asymptotes meet")


def _critical_scale(proof: Proof, source: str, scale: sp.Expr, factor: sp.Expr) -> None:
    proof.recall(source)
    proof.proportional(V_star, scale, factor, "where the two asymptotes meet")


for _number, _label, _name, _term, _value, _factor in (
    (47, "critical-fixed", "fixed indenter", "eq45", critical_fixed, alpha),
    (48, "critical-dead-weight", "dead weight", "eq46", critical_dead_weight, alpha ** (2 * third)),
):  # fmt: skip
    result(_label, title=f"Crossing of the asymptotes, {_name}", high=_term, critical=_value,
           text=r"The paper gives the order of magnitude; the factor, with $\alpha = 2\sqrt{2}/3$, is new.",
           )(_critical)  # fmt: skip
    result(f"eq{_number}", title=f"Critical velocity, {_name}", source=_label, scale=_value / _factor,
           text=rf"The factor is that of ({_label}).", factor=_factor)(_critical_scale)  # fmt: skip


@result("eq49")
def _lift(proof: Proof) -> None:
    """Vertical lift.

    At a given load the depth falls as $V^{-1}$ once $V$ is far above $V^{*}$ of (critical-dead-weight).
    """
    _recall_exact(proof)
    proof.recall("critical-dead-weight")
    reason = "Eq. (43) solved for the depth at the load $W$"
    proof.leading_order(delta, W / (C * V), *_high, reason, eps=_small)


@result("eq50")
def _vanishing_friction(proof: Proof) -> None:
    r"""Friction vanishes at high velocity, dead weight.

    With the load held, $\mu \to 0$ for $V/V^{*} \to \infty$, as $(V^{*}/V)^{1/2}$.
    """
    _recall_coefficient(proof)
    proof.recall("critical-dead-weight")
    limit = C * V_star / (R * K) * (V_star / V) ** sp.Rational(1, 2)
    reason = r"tends to 0 as $V/V^{*} \to \infty$"
    proof.leading_order(mu, limit, *_high, reason, eps=_small)
