r"""The errors of the asymptotes of Eqs. 40-49: exact relative errors, and bounds valid at every velocity.

Every error is asymptote/exact - 1 as a function of l = l_r/a and q = x_TE/a. It is monotonic in q, so
that an asymptote is within a tolerance on a half-line of velocities; a power of l bounds it.
"""

from dataclasses import dataclass

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof, tex
from .asymptotics import F_high, F_low, W_high, W_low, mu_high, mu_low
from .model import V, delta
from .steady import F, W, l, l_r, mu, q
from .theorems import (
    FRICTION_COEFFICIENT, FRICTION_FORCE, LOAD, NUMBER, UNIT, A, B, f, kappa, m, phi, s, w,
)  # fmt: skip

(
    gap, e_l1, e_l2_fixed, e_l2_weight, e_load_low, e_load_high, e_friction_low, e_friction_high,
    e_depth_low, e_depth_high, e_load_spring, S, b, E, depth_high,
) = symbols(r"""
    gap         \bar q            1  $1 - q$
    e_L1        e_{\mathrm{L1}}   1  relative error of the asymptote of the friction coefficient for low
            velocity  real
    e_L2        e_{\mathrm{L2\text{-}FI}}  1  relative error of the friction coefficient for high
            velocity, fixed indenter  real
    e_L2_weight  e_{\mathrm{L2\text{-}MI}}  1  relative error of the friction coefficient for high
            velocity, dead weight  real
    e_W_low     e_{W\!,\,V\to0}   1  relative error of the load for low velocity  real
    e_W_high    e_{W\!,\,V\to\infty}  1  relative error of the load for high velocity  real
    e_F_low     e_{F\!,\,V\to0}   1  relative error of the friction force for low velocity  real
    e_F_high    e_{F\!,\,V\to\infty}  1  relative error of the friction force for high velocity  real
    e_depth_low  e_{\delta,\,V\to0}  1  relative error of the static depth for low velocity  real
    e_depth_high  e_{\delta,\,V\to\infty}  1  relative error of the depth for high velocity  real
    e_W         e_{W}             1  relative error of the static load of a suspended indenter  real
    S           -                 1  $\sqrt{1 + e_{\delta,\,V\to\infty}} - 1$, the error of the root of
            the depth
    b           -                 1  root of the static depth over the depth, $(1 +
            E_\delta)^{1/3}$  prints b_\delta
    E           -                 1  relative excess of the load over the static one  prints E_\delta
    depth_high  \delta_{\mathrm{L2}}  m  asymptote of the depth for high velocity
""")  # fmt: skip

result = Chapter("Errors of the asymptotes")


@dataclass(frozen=True)
class Asymptote:
    """An asymptote over the exact value, and the statements to be proved about it."""

    label: str
    title: str
    equation: str
    of: sp.Symbol
    """The quantity."""
    term: sp.Symbol
    """Its leading term."""
    symbol: sp.Symbol
    """The error."""
    ratio: sp.Expr
    """Asymptote/exact in terms of w, phi, m and l."""
    stable: sp.Expr
    """Asymptote/exact - 1 without cancellation."""
    power: int
    """The error is bounded on both sides by multiples of l**power ..."""
    lower: sp.Expr | int
    upper: sp.Expr | int
    """... with these factors, which it approaches."""
    growth: str
    """Sign of the change of the error with growing q, that is, with falling velocity."""


def _rational(numerator: int, denominator: int) -> sp.Expr:
    return sp.Rational(numerator, denominator)


ASYMPTOTES = (
    Asymptote(
        "error-L1",
        "Friction coefficient at low velocity",
        *("eq42", mu, mu_low, e_l1, l / m, 6 * l / ((1 + q) * B)),
        *(1, _rational(3, 4), _rational(3, 2), "<"),
    ),
    Asymptote(
        "error-L2-fixed",
        "Friction coefficient at high velocity, fixed depth",
        *("eq45", mu, mu_high, e_l2_fixed, 2 / (3 * m), (1 + q) * (7 - 2 * q + 3 * q**2) / (6 * l * B)),
        *(-1, _rational(7, 24), _rational(2, 3), ">"),
    ),
    Asymptote(
        "error-load-low",
        "Load at low velocity, fixed depth",
        *("eq40", W, W_low, e_load_low, 4 / (3 * w), -(gap**2) * (q**2 + 2 * q + 3) / ((1 + q) ** 2 * A)),
        *(2, -_rational(3, 4), 0, ">"),
    ),
    Asymptote(
        "error-load-high",
        "Load at high velocity, fixed depth",
        *("eq43", W, W_high, e_load_high, l / w, -q * B / ((1 + q) * A)),
        *(-1, -_rational(2, 3), 0, "<"),
    ),
    Asymptote(
        "error-friction-low",
        "Friction force at low velocity, fixed depth",
        *("eq41", F, F_low, e_friction_low, 4 * l / (3 * phi), gap * (q**2 + q + 4) / ((1 + q) * B)),
        *(1, 0, _rational(3, 4), "<"),
    ),
    Asymptote(
        "error-friction-high",
        "Friction force at high velocity, fixed depth",
        *("eq44", F, F_high, e_friction_high, 2 * l / (3 * phi), -q * (q**2 + 3) / ((1 + q) * B)),
        *(-1, -_rational(3, 8), 0, "<"),
    ),
    Asymptote(
        "error-depth-high",
        "Depth at high velocity, dead weight",
        *("eq49", delta, depth_high, e_depth_high, w / l, (1 + q) * B / (6 * l)),
        *(-1, _rational(2, 3), _rational(4, 3), ">"),
    ),
)  # fmt: skip


_F1 = {w: LOAD, phi: FRICTION_FORCE, m: FRICTION_COEFFICIENT}
_IN_Q = {**_F1, l: NUMBER}


def _recall(proof: Proof, ratio: sp.Expr) -> None:
    """Recall the parts of the ratio from theorem F1."""
    proof.recall("scaling")
    for part in filter(ratio.has, _F1):
        proof.recall("F1", part)


def _dimensional(proof: Proof, equation: str, of: sp.Symbol, term: sp.Symbol) -> None:
    """Recall an asymptote, and the quantities that are in it and in what it approaches."""
    leading = proof.asymptote(equation, of, term)
    proof.recall("eq28", delta, "scaling", V, l_r)
    wanted = {W, F, mu} & {of, *leading.free_symbols}
    for part in sorted(wanted, key=str):
        proof.recall("F1", part)


def _gap(proof: Proof) -> None:
    proof.define(gap, 1 - q, "the peeled part of the outlet side")
    proof.equal(gap, 2 * q * l / (1 + q), "without a difference")


def _error(proof: Proof, asymptote: Asymptote) -> None:
    error, size = asymptote.symbol, l**asymptote.power
    _recall(proof, asymptote.ratio)
    if asymptote.stable.has(gap):
        _gap(proof)
    _dimensional(proof, asymptote.equation, asymptote.of, asymptote.term)
    proof.define(error, asymptote.term / asymptote.of - 1, "asymptote over exact value")
    proof.equal(error, asymptote.ratio - 1, "in scaled quantities")
    proof.equal(error, asymptote.stable, "in this form exact also where it is small")
    proof.sign(sp.Derivative(error, q), asymptote.growth, 0, UNIT, "monotonic")
    proof.sign(error / size, ">", asymptote.lower, UNIT, "bound at every velocity")
    proof.sign(error / size, "<", asymptote.upper, UNIT, "bound at every velocity")
    proof.done(error, asymptote.stable)


for _each in ASYMPTOTES:
    result(_each.label, title=_each.title, asymptote=_each,
           text=rf"The asymptote over the exact value is $1 + {tex(_each.symbol)}$.")(_error)  # fmt: skip


@result("error-depth-low")
def _depth_low(proof: Proof) -> None:
    r"""Depth at low velocity, dead weight.

    The static depth over the exact depth is $(W(\delta)/W_0(\delta))^{2/3} = (3 w/4)^{2/3}$, where $W_0$ is
    the static load.
    """
    excess = gap**2 * (q**2 + 2 * q + 3) / (8 * q)
    root = sp.cbrt(1 + E)
    form = E * (1 + b) / (1 + b + b**2)
    proof.define(b, root, "$b^2$ is static depth over depth")
    proof.define(e_depth_low, b**2 - 1, "asymptote over exact value")
    proof.equal(e_depth_low, form, "without a difference")
    proof.sign((1 + 2 * E / 3) ** 3 - (1 + E) ** 2, ">", 0, (E, 0, sp.oo), _CONCAVE)
    proof.sign(sp.Derivative((1 + E) ** 2, E), ">", 0, (E, 0, sp.oo), "grows with $E$")
    _recall(proof, w)
    _gap(proof)
    _dimensional(proof, "eq40", W, W_low)
    proof.define(E, W / W_low - 1, "excess of the load over the static load at this depth")
    proof.equal(E, 3 * w / 4 - 1, "in scaled quantities")
    proof.equal(E, excess, "without a difference")
    proof.sign(sp.Derivative(3 * LOAD / 4, q), "<", 0, UNIT, "monotonic")
    proof.sign(E / l**2, "<", _rational(3, 4), UNIT, r"hence the error is below $l^2/2$")
    proof.done(e_depth_low, form)


_CONCAVE = r"$(1 + E)^{2/3} < 1 + \frac{2}{3} E$"


@result("error-L2-dead-weight")
def _dead_weight(proof: Proof) -> None:
    r"""Friction coefficient at high velocity, dead weight.

    The error of the asymptote at fixed depth, and that of the depth, which enters it under a square root. It
    is monotonic, and $1 + e < (1 + \frac{2}{3 l})^2$ at every velocity.
    """
    form = e_l2_fixed + S * (1 + e_l2_fixed)
    squared = w / l * (2 / (3 * m)) ** 2
    root = sp.sqrt(1 + e_depth_high)
    for error in ASYMPTOTES:
        if error.symbol in (e_depth_high, e_l2_fixed):
            proof.recall(error.label, (error.symbol, error.ratio - 1))
    _dimensional(proof, "eq46", mu, mu_high)
    proof.define(e_l2_weight, mu_high / mu - 1, "asymptote over exact value")
    proof.equal(e_l2_weight, 2 / (3 * m) * sp.sqrt(w / l) - 1, "in scaled quantities")
    proof.equal(e_l2_weight, root * (1 + e_l2_fixed) - 1, "both errors")
    proof.define(S, e_depth_high / (1 + root), "half the error of the depth, at first order")
    proof.equal(S, root - 1, "without a difference on the left")
    proof.equal(e_l2_weight, form, "a sum of positive terms")
    _recall(proof, squared)
    proof.equal((1 + e_l2_weight) ** 2, squared, r"the square of $\mu_{\mathrm{L2}}/\mu$")
    proof.sign(sp.Derivative((1 + e_l2_weight) ** 2, q), ">", 0, UNIT, "monotonic")
    proof.sign((1 + 2 / (3 * l)) ** 4 - squared, ">", 0, UNIT, "bound at every velocity")
    proof.leading_order(squared - 1, 5 / (4 * l), q, 0, r"hence $e \sim 5/(8 l)$", eps=1 / l)
    proof.done(e_l2_weight, form)


@result("error-load-suspended")
def _suspended(proof: Proof) -> None:
    r"""Load of a suspended indenter at high velocity.

    On a spring of support number $\kappa$ the load grows to $(1 + \kappa) W_0$, when the indenter has been
    lifted by its whole static depth; this over the exact load.
    """
    form = 4 * kappa / (3 * s * w)
    proof.recall("scaled-load", (f, 3 * s**3 * w / 4))
    proof.define(e_load_spring, (f + kappa * s**2) / f - 1, r"as $1 + \kappa = f + \kappa s^2$")
    proof.equal(e_load_spring, form, "the part that the spring still carries")
    proof.done(e_load_spring, form)
