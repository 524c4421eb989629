"""The asymptotes of low and high velocity with their next order, and where they meet (Eqs. 40-50).

The paper estimates load and friction by integrals over the limiting contact. Each integral is
evaluated here as given, and compared with the exact load and with the friction force of F21.
"""

from functools import partial

import sympy as sp

from . import friction_identity, steady
from .book import Shown
from .record import Derivation
from .step import Proof
from .symbols import (
    C,
    F,
    K,
    R,
    V,
    V_star,
    W,
    a,
    alpha,
    delta,
    h,
    l,
    l_r,
    load_excess,
    mu,
    q,
    x,
)  # fmt: skip

SECTION = "Asymptotes"

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

LOW_LOAD = r"2 \alpha R^{1/2} K \delta^{3/2}"
LOW_FRICTION = r"2 \alpha R^{-1/2} C V \delta^{3/2}"
HIGH_FRICTION = r"\alpha R^{-1/2} C V \delta^{3/2}"
HIGH_FIXED = r"\alpha \sqrt{\frac{\delta}{R}}"
HIGH_DEAD_WEIGHT = r"\alpha \sqrt{\frac{W}{R C V}}"
CRITICAL_FIXED = r"\frac{\alpha K \sqrt{R \delta}}{C}"
CRITICAL_DEAD_WEIGHT = r"\frac{\alpha^{2/3} \sqrt[3]{R K^2 W}}{C}"

_SHAPE = x**2 / (2 * R)
_compression = delta - h(x)
_rate = -h(x).diff(x) * V
_low, _high = (q, 1), (q, 0)
_equation = partial(Proof, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Derive Eqs. 40-50."""
    return (
        *(_estimate(*case) for case in _ESTIMATES[:2]),
        _low_coefficient(),
        *(_estimate(*case) for case in _ESTIMATES[2:]),
        _high_coefficient(),
        _high_dead_weight(),
        _critical_fixed(),
        _critical_dead_weight(),
        _lift(),
        _vanishing_friction(),
    )


_ESTIMATES = (
    (40, "Load at low velocity", W, K * _compression, True, low_load, LOW_LOAD),
    (41, "Friction force at low velocity", F, -h(x).diff(x) * C * _rate, True, low_friction,
     LOW_FRICTION),
    (43, "Load at high velocity", W, C * _rate, False, high_load, r"C V \delta"),
    (44, "Friction force at high velocity", F, -h(x).diff(x) * C * _rate, False, high_friction,
     HIGH_FRICTION),
)  # fmt: skip
_INTEGRANDS = {
    40: r"\int_{-a}^{a} K u \, \mathrm{d}x",
    41: r"\int_{-a}^{a} -h' C \dot{u} \, \mathrm{d}x",
    43: r"\int_{-a}^{0} C \dot{u} \, \mathrm{d}x",
    44: r"\int_{-a}^{0} -h' C \dot{u} \, \mathrm{d}x",
}


def _estimate(
    number: int, title: str, force: sp.Symbol, integrand: sp.Expr, low: bool,
    leading: sp.Expr, shown: str,
) -> Derivation:  # fmt: skip
    """Evaluate the integral of the paper, and compare it with the exact force."""
    proof = _equation(f"eq{number}", number, title=title, text=_TEXT,
                      notation={"u": _compression, r"\dot{u}": _rate})  # fmt: skip
    proof.recall("eq3", h(x), _SHAPE)
    _recall_exact(proof)
    end = a if low else sp.S.Zero
    inner = sp.expand(integrand.subs(h(x), _SHAPE).doit())
    paper = sp.Integral(integrand, (x, -a, end))
    reason = r"the integral of the paper, with $u = \delta - h$ and $\dot{u} = -h' V$"
    sides: Shown = {"left": _INTEGRANDS[number], "right": shown}
    proof.integral(
        paper, integrand, (x, -a, end), _primitive(inner), reason, value=leading, **sides
    )
    point, small = (_low, l_r / a) if low else (_high, a / l_r)
    if force == F:
        spring = low_load if low else low_load / 2
        reason = "what the spring carries: all of the load at rest" if low else _HALF
        proof.define(load_excess, W - C * V * delta, "F21 needs the load without the damper's part")
        proof.leading_order(load_excess, spring, *point, reason, eps=small)
        proof.equal(leading, l_r / R * spring, r"$l_{\mathrm{r}}/R$ times that", left=shown)
    proof.leading_order(force, leading, *point, "the exact force", eps=small, right=shown)
    return proof.done(force, leading)


_HALF = "what the spring carries: half of the load at rest"


def _primitive(polynomial: sp.Expr) -> sp.Expr:
    return sp.Poly(polynomial, x).integrate(x).as_expr()


_TEXT = r"Here $\alpha = 2\sqrt{2}/3$; the remainder is that of the exact force."


def _recall_exact(proof: Proof) -> None:
    """Let half length, velocity, load and friction be expressions in q."""
    for label, lhs, rhs in (
        ("eq28", a, sp.sqrt(2 * R * delta)),
        ("scaling", l, steady.number),
        ("scaling", l_r, a * l),
        ("scaling", V, K * l_r / C),
        ("load", W, steady.load),
        ("F21-steady", F, friction_identity.FRICTION),
    ):
        proof.recall(label, lhs, rhs)


def _coefficient(number: int, title: str, text: str = "") -> Proof:
    proof = _equation(f"eq{number}", number, title=title, text=text)
    _recall_exact(proof)
    proof.recall("eq37", mu, F / W)
    return proof


def _low_coefficient() -> Derivation:
    proof = _coefficient(42, "Friction coefficient at low velocity", _BOTH)
    ratio = low_friction / low_load
    shown: Shown = {"left": rf"\frac{{{LOW_FRICTION}}}{{{LOW_LOAD}}}"}
    proof.equal(sp.UnevaluatedExpr(ratio), low_coefficient, "Eqs. (40) and (41)", **shown)
    proof.leading_order(mu, low_coefficient, *_low, "exact $F/W$", eps=l_r / a)
    return proof.done(mu, low_coefficient)


_BOTH = (
    r"The asymptotes $\mathrm{L}_{1\mathrm{-FI}}$ and $\mathrm{L}_{1\mathrm{-MI}}$ are the same: "
    "neither depth nor load enters."
)


def _high_coefficient() -> Derivation:
    proof = _coefficient(45, "Friction coefficient at high velocity, fixed indenter")
    ratio = high_friction / high_load
    shown: Shown = {"left": rf"\frac{{{HIGH_FRICTION}}}{{C V \delta}}", "right": HIGH_FIXED}
    proof.equal(sp.UnevaluatedExpr(ratio), high_coefficient, "Eqs. (43) and (44)", **shown)
    proof.leading_order(mu, high_coefficient, *_high, "exact $F/W$", eps=a / l_r, right=HIGH_FIXED)
    return proof.done(mu, high_coefficient)


def _high_dead_weight() -> Derivation:
    title = "Friction coefficient at high velocity, dead weight"
    proof = _coefficient(46, title, _IN_DRIVE)
    _define_critical(proof)
    proof.leading_order(
        mu, high_coefficient_dead_weight, *_high, "exact $F/W$ at the load $W$",
        eps=(V_star / V) ** sp.Rational(3, 2), right=HIGH_DEAD_WEIGHT,
    )  # fmt: skip
    return proof.done(mu, high_coefficient_dead_weight)


_IN_DRIVE = "The velocity $V^{*}$ is that of Eq. (48); the load $W$ is given."


def _define_critical(proof: Proof) -> None:
    proof.define(V_star, critical_dead_weight, "Eq. (48)", right=CRITICAL_DEAD_WEIGHT)


def _critical_fixed() -> Derivation:
    proof = _equation("eq47", 47, title="Critical velocity, fixed indenter", uses=("eq42", "eq45"))
    proof.define(V, V_star, "the two asymptotes meet")
    reason = "Eq. (42) equals Eq. (45)"
    gap = low_coefficient - high_coefficient
    proof.root(gap, V_star, critical_fixed, reason, right=CRITICAL_FIXED)
    return proof.done(V_star, critical_fixed)


def _critical_dead_weight() -> Derivation:
    uses = ("eq42", "eq46")
    proof = _equation("eq48", 48, title="Critical velocity, dead weight", uses=uses)
    proof.define(V, V_star, "the two asymptotes meet")
    reason = "Eq. (42) equals Eq. (46)"
    gap = low_coefficient - high_coefficient_dead_weight
    proof.root(gap, V_star, critical_dead_weight, reason, right=CRITICAL_DEAD_WEIGHT)
    return proof.done(V_star, critical_dead_weight)


def _lift() -> Derivation:
    proof = _equation("eq49", 49, title="Vertical lift", text=_LIFT)
    _recall_exact(proof)
    proof.recall("eq48", V_star, critical_dead_weight)
    small = (V_star / V) ** sp.Rational(3, 2)
    reason = "Eq. (43) solved for the depth at the load $W$"
    proof.leading_order(delta, W / (C * V), *_high, reason, eps=small)
    return proof.done(delta, W / (C * V))


_LIFT = "At a given load the depth falls as $V^{-1}$ once $V$ is far above $V^{*}$ of Eq. (48)."


def _vanishing_friction() -> Derivation:
    proof = _coefficient(50, "Friction vanishes at high velocity, dead weight", _VANISH)
    proof.recall("eq48", V_star, critical_dead_weight)
    limit = C * V_star / (R * K) * (V_star / V) ** sp.Rational(1, 2)
    small = (V_star / V) ** sp.Rational(3, 2)
    shown = r"\frac{C V^{*}}{R K} \sqrt{\frac{V^{*}}{V}}"
    reason = r"tends to 0 as $V/V^{*} \to \infty$"
    proof.leading_order(mu, limit, *_high, reason, eps=small, right=shown)
    return proof.done(mu, limit)


_VANISH = r"With the load held, $\mu \to 0$ for $V/V^{*} \to \infty$, as $(V^{*}/V)^{1/2}$."
