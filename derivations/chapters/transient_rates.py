"""Rates of the transient: near the steady state (F12), and without inertia (F13)."""

from collections.abc import Mapping

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.record import Table
from ..engine.step import Proof
from . import tables
from .master_curve import state_at
from .model import K, M, R, V, g, tau
from .steady import l, q
from .theorems import LOAD, NUMBER, UNIT, A, kappa, lam, w
from .transient_edges import b, left, rho, right
from .transient_memory import SECTION, time
from .transient_motion import a
from .transient_scaling import P, d, d_s, d_ss, eps, f_normal, xi

eps_critical, quadratic, f, change, per_depth, per_rate, sigma, drive_excess, beta = symbols(r"""
    epsilon_c  \varepsilon_{\mathrm{c}}  1  inertia number between monotone and oscillating motion
    P_2        -                 1  quadratic of the rates  real
    f          -                 1  scaled force that balances weight and spring, $1 - \kappa (d -
            1)$  prints f_{\mathrm{b}}
    -          \tilde d          1  scaled depth near that of steady sliding
    d_hat      \hat d            1  amplitude of the change of depth  real
    A          -                 1  stiffness of the contact, scaled
    B          -                 1  damping of the contact, scaled
    sigma      -                 1  scaled rate of a small motion about steady sliding  real  from F12-linear
    -          \sigma_1          1  faster of two rates
    -          \sigma_2          1  slower of two rates
    -          T_1               s  shorter time constant
    -          T_2               s  longer time constant
    n_s        n                 1  parameter of the slow manifold, $(\lambda - \hat a)/(2
            f_{\mathrm{b}})^{1/3}$  prints \bar n  real
    beta       -                 1  scaled length of the contact on the slow manifold, $b/(2
            f_{\mathrm{b}})^{1/3}$  prints \bar b
""")

DAMPING, STIFFNESS = 3 * per_rate / 4, 3 * per_depth / 4 + kappa
"""The dependence of the force on the indenter on the depth rate, and on the depth."""
QUADRATIC = eps * sigma**2 + DAMPING * sigma + STIFFNESS
"""Its roots are the rates of small motions."""

_root = sp.sqrt(DAMPING**2 - 4 * eps * STIFFNESS)
FAST, SLOW = -(DAMPING + _root) / (2 * eps), -2 * STIFFNESS / (DAMPING + _root)
"""The rates per retardation time, without cancellation."""

_first, _second = sp.symbols("sigma_1 sigma_2", real=True)
_times = sp.symbols("T_1 T_2", real=True)

SLOW_RATE = right**2 + 2 * lam * right - d
"""d' of the slow manifold."""
SLOW_FORCE = (right + a) ** 2 * (2 * right + 3 * lam - a) / 4
"""f of the slow manifold."""
EXCESS = 2 * (1 - beta**3) / (3 * beta**2)
"""n of the slow manifold, for its width beta."""

result = Chapter(SECTION)


@result("F12-linear")
def _linearised(proof: Proof) -> None:
    r"""Small motions about steady sliding.

    The scaled motion with the force of F11-start, for the depth $D = a^2 + \hat d e^{\sigma s}$ near that of
    steady sliding, $a^2$. To first order in $\hat d$ it is obeyed if $\sigma$ is a root of the quadratic.
    """
    near = a**2 + change * sp.exp(sigma * time)
    rate = sp.diff(near, time)
    proof.define(per_depth, sp.sqrt(a**2 + lam**2) + a, "growth of the force with the depth")
    proof.define(per_rate, sp.sqrt(a**2 + lam**2) - lam + a, "and with its rate")
    proof.define(quadratic, QUADRATIC, r"changes as $e^{\sigma s}$ are possible where it vanishes")
    proof.recall("F11-start", rho, right, left, "F11", f_normal, "scaled-form", d_ss)
    by_depth, by_rate = (
        at_motion(sp.Derivative(eps * d_ss, variable), {d: a**2, d_s: 0}) for variable in (d, d_s)
    )
    linear = eps * sigma**2 - by_rate * sigma - by_depth
    proof.equal(linear, quadratic, "the scaled motion, linear in the change")
    proof.where(sp.Gt(near, 0), "the change is small")
    proof.where(sp.Gt(near + rate + lam**2, 0), "and the contact remains")
    motion = eps * sp.Derivative(near, (time, 2)) - at_motion(eps * d_ss, {d: near, d_s: rate})
    first = sp.Subs(sp.Derivative(motion, change), change, 0)
    reason = r"the terms of first order in $\hat d$"
    proof.equal(first, quadratic * sp.exp(sigma * time), reason)


def at_motion(expr: sp.Expr, places: Mapping[sp.Expr, sp.Expr]) -> sp.Expr:
    """Return an expression along a motion."""
    return sp.Subs(expr, tuple(places), tuple(places.values()))


@result("F12-steady")
def _contact(proof: Proof) -> None:
    """Stiffness and damping of the contact.

    In steady sliding, with the half length $a$ in units of $a_0$, and the trailing edge at $a q$.
    """
    proof.define(lam, a * l)
    proof.define(l, NUMBER)
    for name, form in _IN_Q.items():
        proof.recall("F12-linear", name)
        proof.equal(name, form, r"$\sqrt{1 + l^2} = l + q$")
    proof.done(per_depth, _IN_Q[per_depth])


_IN_Q = {per_depth: a * (1 + q) ** 2 / (2 * q), per_rate: a * (1 + q)}


@result("F12")
def _rates(proof: Proof) -> None:
    r"""Rates at the steady state.

    Near the steady state the change of depth is a sum of
    $e^{\sigma_1 s}$ and $e^{\sigma_2 s}$.
    """
    proof.recall("F12-linear", quadratic)
    proof.where(sp.Gt(DAMPING**2, 4 * eps * STIFFNESS), "no oscillation")
    middle = -DAMPING / (2 * eps)
    proof.root(quadratic, sigma, FAST, "fast", over=(sigma, -sp.oo, middle), name=_first)
    proof.root(quadratic, sigma, SLOW, "slow", over=(sigma, middle, sp.oo), name=_second)


def steady_sliding(proof: Proof) -> None:
    """Let A, B and lambda be those of steady sliding, by the half length and q."""
    proof.define(l, NUMBER)
    proof.recall("F12-steady", lam, *_IN_Q)


@result("F12-boundary", uses=("F1",))
def _critical_inertia(proof: Proof) -> None:
    r"""Where oscillation begins.

    The transient is monotone near the steady state for $\varepsilon \le \varepsilon_{\mathrm{c}}$ and
    oscillates for $\varepsilon > \varepsilon_{\mathrm{c}}$. For a dead weight the boundary in the plane of
    $\lambda$ and $\varepsilon$ is rational in $q$, up to cube roots.
    """
    cubed = 27 * q**4 / (64 * (1 + q) ** 2 * A)
    proof.define(eps_critical, DAMPING**2 / (4 * STIFFNESS))
    proof.equal(DAMPING**2 - 4 * eps_critical * STIFFNESS, sp.S.Zero, "both rates are equal")
    steady_sliding(proof)
    proof.define(kappa, sp.S.Zero, "dead weight")
    proof.equal(eps_critical, 3 * a * q / 8, "three eighths of the trailing edge $r = a q$")
    proof.define(a, sp.cbrt(4 / (3 * w)), r"the load $W_0 \frac{3}{4} a^3 w$ is the weight")
    proof.recall("F1", w)
    proof.equal(eps_critical**3, cubed, "the boundary, in terms of $q$")
    proof.equal(lam**3, (1 - q) ** 3 * (1 + q) / (q**2 * A), "and the drive number")
    proof.sign(sp.Derivative(cubed, q), ">", 0, UNIT, r"it falls with growing $\lambda$")
    rest, fast = sp.Rational(3, 8), 1 / (4 * lam**2)
    proof.equal(sp.Subs(cubed, q, 1), rest**3, "at rest")
    proof.leading_order(eps_critical**3, fast**3, q, 0, "fast", eps=lam ** -sp.Rational(3, 2))
    proof.done(eps_critical, 3 * a * q / 8)


@result("F12-time-constants")
def _time_constants(proof: Proof) -> None:
    r"""The two time constants.

    $T_1 = -\tau/\sigma_1$ and $T_2 = -\tau/\sigma_2$ for small $\varepsilon$: the fast one is due to the
    mass; the slow one is a fraction of the retardation time, which depends on the drive alone.
    """
    steady_sliding(proof)
    proof.define(kappa, sp.S.Zero, "dead weight")
    fast, slow = 4 * eps / (3 * a * (1 + q)), 2 * q / (1 + q)
    proof.recall("F12", _first, _second)
    for name, rate in zip(_times, (_first, _second), strict=True):
        proof.define(name, -tau / rate, "how long each change takes to decay")
    proof.leading_order(_times[0] / tau, fast, eps, 0, "inertia against damping")
    proof.leading_order(_times[1] / tau, slow, eps, 0, "damping against stiffness")


@result("F12-table1", uses=("F12", "F12-boundary", "table1"))
def _standard(proof: Proof) -> None:
    """Time constants under standard conditions.

    The paper reads "1 ms" and "10 ms" from its Fig. 3 for the dead weight. They are the two time constants of
    the steady state, computed here exactly and then rounded to four digits: the fast one is inertia against
    the damping of the foundation, the slow one damping against stiffness.
    """
    cubed = ((V * tau) ** 3 * K / (R * M * g)).subs(tables.STANDARD)
    quartic, state = state_at(cubed)
    proof.unique_root(quartic, UNIT, in_whole_numbers(cubed))
    half = sp.cbrt(4 / (3 * LOAD))
    inertia = (tables.static_depth / (g * tau**2)).subs(tables.STANDARD)
    known = {
        eps: inertia, kappa: 0, lam: half * NUMBER,
        per_depth: half * (1 + q) ** 2 / (2 * q), per_rate: half * (1 + q),
    }  # fmt: skip
    milliseconds = 1000 * tables.STANDARD[tau]
    rows = (
        ("Drive number", r"$\lambda$", lam, ""),
        ("Inertia number", r"$\varepsilon$", eps, ""),
        ("Boundary of oscillation", r"$\varepsilon_{\mathrm{c}}$", 3 * half * q / 8, ""),
        ("Trailing edge over half length", "$q$", q, ""),
        ("Depth over static depth", r"$\delta/\delta_0$", half**2, ""),
        ("Fast time constant", "$T_1$", -milliseconds / FAST, "ms"),
        ("Slow time constant", "$T_2$", -milliseconds / SLOW, "ms"),
    )
    proof.done(quartic, 0, table=Table(
        ("Quantity", "Symbol", "Value", "Unit"),
        tuple((name, symbol, _four_digits(value.subs(known).subs(q, state)), unit)
              for name, symbol, value, unit in rows),
    ))  # fmt: skip


def in_whole_numbers(cubed: sp.Expr) -> str:
    """Say which equation it is whose coefficients are numbers."""
    return rf"F2 with $\Lambda^3 = {float(cubed):.6g}$ by Table 1, in whole numbers"


def _four_digits(value: sp.Expr) -> str:
    return f"{float(sp.N(value, 30)):.4g}"


@result("F13")
def _manifold(proof: Proof) -> None:
    r"""Slow manifold.

    Without inertia the indenter is in balance, $f_z = f$ with $f = 1 - \kappa (d - 1)$: given $d$, this
    determines the right edge $r$, and $r$ determines $d'$. One differential equation of first order remains.
    It holds where the left edge touches undisturbed ground, $b \le 2 \rho$.
    """
    cubic = 2 * right**3 / 3 + (a + lam) * right**2 + 2 * lam * a * right + lam * a**2 - a**3 / 3
    proof.recall("scaled-pressure")
    proof.define(xi, right, "the right edge peels")
    proof.root(P, d_s, SLOW_RATE, "no pressure there")
    proof.define(rho, right + lam, "as an edge that peels")
    proof.define(b, right - left, "the length of the contact")
    proof.recall("F10-touch", left, reason="the left edge touches undisturbed ground")
    proof.define(a, sp.sqrt(d), "half of a contact at rest")
    proof.recall("scaled-form")
    balanced = 1 - kappa * (d - 1)
    proof.root(eps * d_ss, f_normal, balanced,
               "without inertia the force is the weight less the spring force")  # fmt: skip
    proof.define(f, f_normal, "this force")
    proof.recall("F11-peel")
    proof.equal(f, SLOW_FORCE, "which is a cubic in $r$")
    proof.equal(4 * f / 3, cubic, "expanded")
    proof.done(d_s, SLOW_RATE)


@result("F13-root")
def _one_root(proof: Proof) -> None:
    r"""Slow manifold: one root.

    With $b = (2 f)^{1/3} \beta$ and $\lambda - a = (2 f)^{1/3} n$ the cubic has no parameter but $n$: $2
    \beta^3 + 3 n \beta^2 = 2$ has exactly one positive root for each $n$.
    """
    unit = sp.cbrt(2 * f)
    positive = (beta, 0, sp.oo)
    relation = beta**2 * (2 * beta + 3 * drive_excess) / 2
    proof.root(relation - 1, drive_excess, EXCESS, r"where $f_z = f$")
    proof.sign(sp.Derivative(EXCESS, beta), "<", 0, positive, r"each $n$ has one $\beta$ at most")
    proof.leading_order(EXCESS, 2 / (3 * beta**2), beta, 0, r"$n \to \infty$")
    proof.leading_order(EXCESS, -2 * beta / 3, beta, sp.oo, r"$n \to -\infty$: to exactly one")
    proof.recall("F13", (f, SLOW_FORCE))
    proof.where(right + a > 0, "there is a contact")
    proof.define(beta, (right + a) / unit, "the length of the contact in this unit")
    proof.define(drive_excess, (lam - a) / unit)
    proof.equal(relation, sp.S.One, "the cubic of F13")
    proof.done(drive_excess, EXCESS)
