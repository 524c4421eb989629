"""Table 1 with the numbers that follow from it, and Table 2 with exact coefficients."""

import sympy as sp

from ..engine.book import tex
from ..engine.chapter import Chapter
from ..engine.nomenclature import symbol
from ..engine.record import Table
from ..engine.step import Proof
from . import asymptotics as asy
from . import steady
from .asymptotics import V_star, mu_high, mu_low
from .model import K, M, N, R, V, delta, g, tau
from .steady import W, a, mu, q

delta_0 = symbol("delta_0", "static depth", "m", source="scaled-pressure")

result = Chapter("Tables")

_milli, _third = sp.Rational(1, 1000), sp.Rational(1, 3)

STANDARD = {
    R: 10 * _milli,
    M: sp.Integer(1000),
    K: sp.Integer(10) ** 10,
    tau: 100 * _milli,
    N: sp.Integer(200_000),
    delta: 300 * _milli**2,
    V: 100 * _milli,
    g: sp.Rational("9.80665"),
}
"""The parameter values of the paper and standard gravity, exactly, in SI units."""

static_depth = (3 * M * g / (4 * K * sp.sqrt(2 * R))) ** (2 * _third)

_half = sp.sqrt(2 * R * delta)
_drive = V * tau / _half
_trailing = sp.sqrt(1 + _drive**2) - _drive


def _fixed(expr: sp.Expr) -> sp.Expr:
    """Return a result of steady sliding for the fixed indenter of Table 1."""
    return expr.subs(a, _half).subs(q, _trailing)


_GIVEN = (
    ("Curvature radius", "$R$", R, _milli, "mm"),
    ("Mass per unit width", "$M$", M, 1000, "kg/mm"),
    ("Stiffness per unit area", "$K$", K, 10**9, r"GN/m$^3$"),
    ("Retardation time", r"$\tau$", tau, _milli, "ms"),
    ("Number of elements per unit length", "$N$", N, 1000, r"mm$^{-1}$"),
    ("Indentation depth (fixed)", r"$\delta$", delta, _milli**2, r"$\mu$m"),
    ("Drive velocity", "$V$", V, _milli, "mm/s"),
)
_DERIVED = (
    ("Damping per unit area", r"$C = K \tau$", K * tau, 10**9, r"GN s/m$^3$"),
    ("Half length (fixed)", r"$a$ (28)", _half, _milli, "mm"),
    ("Retardation length", r"$l_{\mathrm{r}}$ (29)", V * tau, _milli, "mm"),
    ("Load (fixed)", "$W$", _fixed(steady.load), 1000, "N/mm"),
    ("Friction force (fixed)", "$F$", _fixed(steady.friction), 1000, "N/mm"),
    ("Friction coefficient (fixed)", r"$\mu$ (37)", _fixed(steady.friction_coefficient), 1, ""),
    ("Load (dead weight)", "$W = M g$", M * g, 1000, "N/mm"),
    ("Static depth (dead weight)", r"$\delta_0$", static_depth, _milli**2, r"$\mu$m"),
    ("Drive number (fixed)", r"$V \tau (R \delta)^{-1/2}$", V * tau / sp.sqrt(R * delta), 1, ""),
    ("Drive number (dead weight)", r"$V \tau (K/R W)^{1/3}$",
     V * tau * (K / (R * M * g)) ** _third, 1, ""),
    ("Drive number (transient)", r"$\lambda = V \tau/a_0$",
     V * tau / sp.sqrt(2 * R * static_depth), 1, ""),
    ("Inertia number (transient)", r"$\epsilon = \delta_0/(g \tau^2)$",
     static_depth / (g * tau**2), 1, ""),
)  # fmt: skip


@result("table1")
def _standard_values(proof: Proof) -> None:
    r"""Standard parameter values.

    The values of the paper and what follows from them, computed exactly and then rounded to six digits; $g =
    9.80665$ m/s$^2$, and $a_0$ and $\delta_0$ are those of the contact at rest.
    """
    proof.recall("load", "eq28")
    proof.define(q, sp.S.One, "at rest the contact is symmetric")
    proof.equal(W, 4 * _third * K * a * delta, "the load at rest")
    reason = r"this load is the weight, $\frac{4}{3} K a_0 \delta_0 = M g$"
    carried = 4 * _third * K * a * delta - M * g
    proof.root(carried, delta, static_depth, reason, name=delta_0)
    rows = tuple(
        (name, symbol, _six_digits(value, unit), unit_name)
        for name, symbol, value, unit, unit_name in (*_GIVEN, *_DERIVED)
    )
    table = Table(("Quantity", "Symbol", "Value", "Unit"), rows)
    proof.done(delta_0, static_depth, table=table)


def _six_digits(value: sp.Expr, unit: sp.Expr | int) -> str:
    return f"{float(sp.N(value.subs(STANDARD) / unit, 30)):.6g}"


@result("table2")
def _velocity_dependences(proof: Proof) -> None:
    r"""Velocity dependences of the friction coefficient.

    Here $\alpha = 2\sqrt{2}/3$; $V^{*}$ is where the two asymptotes meet exactly: Eqs. (47) and (48) give its
    order.
    """
    proof.asymptote("eq42", mu, mu_low)
    proof.asymptote("eq45", mu, mu_high)
    proof.recall("critical-fixed")
    proof.define(V, V_star, "at the critical velocity")
    meets = "the crossing of the fixed indenter; that of the dead weight is (critical-dead-weight)"
    proof.equal(mu_low, mu_high, meets)
    slow = r"$\mu = \frac{C V}{R K}$ (42)"
    rows = (
        (
            "Critical velocity $V^{*}$",
            rf"$V^{{*}} = {tex(asy.critical_fixed)}$ (critical-fixed), in order (47)",
            rf"$V^{{*}} = {tex(asy.critical_dead_weight)}$ (critical-dead-weight), in order (48)",
        ),
        (r"Friction coefficient for $V \ll V^{*}$", slow, slow),
        (
            r"Friction coefficient for $V \gg V^{*}$",
            rf"$\mu = {tex(asy.high_coefficient)}$ (45)",
            rf"$\mu = {tex(asy.high_coefficient_dead_weight)}$ (46)",
        ),
    )
    table = Table(("", "Fixed indenter", "Dead weight"), rows)
    proof.done(table=table)
