"""The memory of the foundation: theorems F8 and F9, for any drive and any motion of the indenter.

Element X of the foundation is at xi = X + Y(s), with Y' = lambda, where the surface of the indenter is
at the compression g(X, s) = d - xi**2: negative where it hangs above the undisturbed foundation.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, letter, symbol, symbols
from ..engine.step import Proof
from .model import K, N, c, compression_rate, f_z, k, tau, u_i
from .tables import delta_0
from .theorems import lam
from .transient_scaling import P, d, d_s, xi

time = symbol("s", r"scaled time, $t/\tau$", source="scaled-pressure", real=True)
earlier = symbol("s_1", "earlier instant", real=True)
end = symbol("s_2", "end of a step", real=True)
depth = function("d", real=True)(time)
compression = function("u", r"scaled compression, $u/\delta_0$", printed=r"\bar u", real=True)
letter(r"\bar u_0", "scaled compression at the beginning")
indenter = function(
    "g",
    "scaled depth of the indenter's surface, negative above the undisturbed foundation",
    printed=r"\bar g",
    real=True,
)
material = symbol(
    "X", "scaled coordinate in the foundation, which moves with it", source="F8", real=True
)
letter("X_1", "first of two elements")
letter("X_2", "second of two elements")
travel = function("Y", r"scaled displacement of the foundation, with $Y' = \lambda$", real=True)(
    time
)
sigma, eta, zeta, mix = symbols(r"""
    sigma  -         1  earlier instant, at which an element was at an edge  prints \bar \sigma  real
    eta    -         1  position of an element then  prints \bar \eta
    zeta   -         1  variable of integration  from F8  real
    -      \bar c    1  clearance of the indenter above an element
    -      \check f  1  memory $e^{s} g$ within a step, over the exponential at its end
    -      \check v  1  slope of $\check f$
    -      \check c  1  difference of $\check M$ and the decrease of that slope
    -      \check b  1  time from the nearer end of a step to the largest value
    -      \check y  1  time from the nearer end of a step
    -      \check k  1  half of the additional distance to the other end
    -      \check M  1  greatest magnitude of the second derivative of $\check f$
    -      J         1  jump that a proof excludes
    -      D         1  $e^{s} \bar g$ of an element less $e^{s_1} \bar g$ at an earlier instant
    -      D_1       1  difference $D$ at one position
    theta  -         1  share of two elements in one between them  prints \bar \theta
    -      \Delta s  1  scaled step in time
    -      D_2       1  difference $D$ at another position
""")

SECTION = "Transient: theorems"

_NOTATION = (
    r"An element with the material coordinate $X$ is at $\xi = X + Y(s)$ with $Y' = \lambda$, and the "
    r"indenter there is at $g(X, s) = d - \xi^2$."
)
_h = sp.Symbol("h", positive=True)
PUSH = sp.Function(r"\hat p", nonnegative=True)
"""The pressure on an element, p/(K delta_0), as a function of time."""
_clear = sp.Function(r"\bar c", nonnegative=True)
"""How far the indenter is above the surface of an element."""
CLEAR = sp.exp(time) * _clear(time) - sp.exp(earlier) * _clear(earlier)
_HEIGHT = depth - (material + travel) ** 2
SURFACE = sp.Lambda((material, time), _HEIGHT)
"""g(X, s), the surface of the indenter above an element."""

OF_TIME = {d: depth, d_s: sp.Derivative(depth, time)}
"""The depth and its rate as functions of the scaled time."""

_MOVING = {**OF_TIME, xi: material + travel, lam: sp.Derivative(travel, time)}
result = Chapter(SECTION)


@result("scaled-element")
def _element(proof: Proof) -> None:
    r"""Scaled pressure of an element.

    In the units of (scaled-pressure), with $s = t/\tau$; the element is in contact or free.
    """
    u = compression
    proof.recall("eq12", "eq22", k, c, tau)
    force, rate = N * f_z / (K * delta_0), sp.Derivative(u(time), time)
    proof.define(u_i, delta_0 * u(time), "compression in units of the static depth")
    proof.define(compression_rate, delta_0 * rate / tau, "its rate, with $s = t/\\tau$")
    proof.root(force - PUSH(time), rate, PUSH(time) - u(time), "the force per area, never negative")


@result("F8", text=_NOTATION)
def _memory(proof: Proof) -> None:
    r"""Memory in closed form.

    Its surface is never above the indenter, $u \ge g$; its pressure $\hat p = u + u'$ is never negative, and
    zero unless $u = g$. Then, for any motion of drive and indenter, $e^{s} u$ is the running maximum of
    $e^{s} g$. The start counts as a contact with $u_0$, the compression at $s = 0$: an element that has not
    been touched since keeps $e^{s} u = u_0$, though $u$ itself decays.
    """
    u, g = compression, indenter
    whole = (zeta, earlier, time)
    pushed = sp.Integral(sp.exp(zeta) * PUSH(zeta), whole)
    kept = sp.exp(time) * u(time)
    proof.recall("scaled-element", reason=r"$\hat p = u + u'$, never negative", at={time: zeta})
    proof.integral(
        pushed,
        sp.exp(zeta) * PUSH(zeta),
        whole,
        r"$\frac{d}{ds} \left[e^{s} u\right] = e^{s} \hat p$: so $e^{s} u$ never decreases",
        value=kept - sp.exp(earlier) * u(earlier),
        antiderivative=sp.exp(zeta) * u(zeta),
    )
    proof.define(g(earlier), u(earlier) - _clear(earlier), r"the clearance $c$ is never negative")
    proof.define(g(time), u(time) - _clear(time), "and now")
    gained = sp.exp(time) * g(time) - sp.exp(earlier) * g(earlier)
    proof.equal(pushed, gained + CLEAR, "in terms of the indenter")
    at_last = {earlier: sigma}
    proof.define(pushed.subs(at_last), sp.S.Zero, r"no pressure since $\sigma$, the last contact")
    proof.define(_clear(sigma), sp.S.Zero, "where the element met the indenter")
    proof.where(sp.Gt(time, sigma), "that contact is over")
    value = sp.exp(sigma - time) * g(sigma)
    proof.define(u(sigma), g(sigma), r"$c(\sigma) = 0$")
    since = kept - sp.exp(sigma) * u(sigma)
    proof.root(*(since, u(time), value, r"the free element since $\sigma$"))
    proof.where(sp.Gt(time, earlier), "any earlier instant")
    proof.greatest(kept, sp.exp(earlier) * g(earlier), (earlier, sigma), _BOUND,
                   surplus=pushed + sp.exp(earlier) * _clear(earlier))  # fmt: skip
    proof.done(u(time), value)


def pushed_by() -> tuple[sp.Expr, sp.Expr]:
    """Return the integral of the pressure on an element and its value, as F8 has them."""
    whole = sp.Integral(sp.exp(zeta) * PUSH(zeta), (zeta, earlier, time))
    return whole, sp.exp(time) * compression(time) - sp.exp(earlier) * compression(earlier)


_BOUND = (
    r"the difference is $\int_{s_1}^{s} e^{\zeta} \hat p \, d\zeta + e^{s_1} c(s_1) \ge 0$, and zero for "
    r"$s_1 = \sigma$: the least upper bound is attained"
)


@result("F8-update", text=_NOTATION)
def _update(proof: Proof) -> None:
    r"""Memory from one instant to the next.

    The update needs no contact flag. It is exact if $e^{s} g$ takes its maximum over the step at an end of
    it, so always where it is monotone. It is inexact only if, within the step, an element is first compressed
    and then released; there $u$ is too small by at most $h^2/8$ times the greatest $|\hat p + \hat p'|$ of
    the step (F8-remainder).
    """
    u, g = compression, indenter
    for name, value in _MOVING.items():
        proof.define(name, value)
    proof.recall("scaled-pressure")
    proof.equal(sp.Derivative(sp.exp(time) * _HEIGHT, time), sp.exp(time) * P, _RISES)
    after, clearance = u(time + _h), sp.Symbol("c", nonnegative=True)
    impulse = sp.Symbol("J", nonnegative=True)
    larger = sp.Max(sp.exp(-_h) * u(time), g(time + _h))
    proof.define(g(time + _h), after - clearance, r"never below the surface, $c \ge 0$")
    step = (zeta, time, time + _h)
    pushed = sp.Integral(sp.exp(zeta) * PUSH(zeta), step)
    proof.holds(pushed, ">=", 0, "over one step")
    proof.recall("F8", pushed_by(), at={earlier: time, time: time + _h})
    proof.define(u(time), sp.exp(_h) * after - sp.exp(-time) * impulse, r"with $J \ge 0$")
    proof.equal(pushed, impulse, "which this is")
    either = (sp.Eq(impulse, 0), sp.Eq(clearance, 0))
    proof.equal(*(after, larger, "free until then, or in contact at the end"), cases=either)


_RISES = r"it rises where contact would give a pressure $\hat p > 0$, and falls elsewhere"


@result("F8-remainder")
def _remainder(proof: Proof) -> None:
    r"""Error of the memory within a step.

    Where $e^{s} g$ is largest within a step, at the time $b_8$ from its nearer end, let $f_8(y_8)$ be it over
    the exponential at its end, at the time $y_8$ from the nearer end; the update takes $f_8(0)$ for
    $f_8(b_8)$. Its second derivative is $\hat p + \hat p'$ times at most 1, and $M_8$ its greatest
    magnitude: so $u$ is too small by at most $M_8 h^2/8$. The slope falls by $M_8 - c_8$ with $c_8
    \ge 0$.
    """
    f, slope = (sp.Function(name, real=True) for name in ("f_8", "v_8"))
    unused = sp.Function("c_8", nonnegative=True)
    y, b, most = sp.symbols("y_8 b_8 M_8", positive=True)
    later = sp.Symbol("k_8", nonnegative=True)
    missed = f(b) - f(0)
    rise = sp.Derivative(sp.exp(time) * _HEIGHT, time)
    proof.recall("F8-update", *_MOVING, P, rise)
    bends = sp.exp(time - end) * (P + sp.Derivative(P, time))
    proof.equal(sp.Derivative(sp.exp(-end) * rise, time), bends, "its second derivative")
    proof.define(sp.Derivative(f(y), y), slope(y), "its slope")
    proof.define(sp.Derivative(slope(y), y), unused(y) - most, "which falls by at most this bound")
    whole, spare = (y, 0, b), sp.Integral(y * unused(y), (y, 0, b))
    primitive = most * y**2 / 2 + y * slope(y) - f(y)
    proof.integral(spare, y * unused(y), whole, "by parts", antiderivative=primitive)
    proof.define(slope(b), sp.S.Zero, "the largest value is at $b_8$")
    proof.equal(missed, most * b**2 / 2 - spare, "error of the value at the nearer end of the step")
    proof.define(_h, 2 * (b + later), "the other end is at least as far")
    proof.equal(most * _h**2 / 8 - missed, most * later * (2 * b + later) / 2 + spare, "the rest")
    proof.holds(most * later * (2 * b + later) / 2 + spare, ">=", 0, "never negative")
    proof.done(most * _h**2 / 8 - missed, most * later * (2 * b + later) / 2 + spare)


def margin_of(position: sp.Expr) -> sp.Expr:
    """Return e**s g now minus e**s_1 g at an earlier instant, for the element X = position."""
    now = depth - (position + travel) ** 2
    return sp.exp(time) * now - sp.exp(earlier) * now.subs(time, earlier)


_one, _other = sp.symbols("X_1 X_2", real=True)
_first, _second = sp.symbols("D_1 D_2", real=True)
_BETWEEN, _CHORD = margin_of(mix * _one + (1 - mix) * _other), mix * _first + (1 - mix) * _second
_BULGE = mix * (1 - mix) * (sp.exp(time) - sp.exp(earlier)) * (_one - _other) ** 2


@result("F9", text=_NOTATION)
def _interval(proof: Proof) -> None:
    r"""The contact is one interval.

    By F8 an element is in contact at $s$ if and only if $e^{s} g(X, s)$ is not less than $e^{s_1} g(X, s_1)$
    at each earlier instant, and not less than $u_0$, which is zero or $g(X, 0)$: without a clearance $\bar c$
    the difference is not negative, and for its last contact it is $-e^{s} \bar c(s)$. Each of these,
    $D(X)$, is concave (with $u_0 = 0$ in place of the earlier instant it bulges by $e^{s}$), so that the
    elements between two in contact satisfy the same conditions: the contact has no gap. So two edges describe
    the contact, for any drive $\lambda(s)$ and depth $d(s)$. That the differences are concave needs the
    parabola, whose curvature is the same everywhere; that the contact is one interval does not.
    """
    margin = margin_of(material)
    curvature = sp.Derivative(margin, (material, 2))
    proof.sign(-2 * (eta - 1), "<", 0, (eta, 1, sp.oo), r"time passes: $\eta = e^{s - s_1} > 1$")
    proof.define(eta, sp.exp(time - earlier))
    proof.equal(curvature, -2 * sp.exp(earlier) * (eta - 1), "concave, for each past instant")
    contact_condition(proof, _HEIGHT, _HEIGHT.subs(time, earlier), margin)
    proof.where(sp.Gt(time, earlier), "any earlier instant")
    proof.where(mix < 1, "between two elements in contact")
    for name, place, shown in ((_first, _one, "X_1"), (_second, _other, "X_2")):
        proof.define(name, margin_of(place), f"at ${shown}$, not negative")
    reason = r"at $\theta X_1 + (1 - \theta) X_2$: its chord, and how far it bulges above"
    proof.equal(_BETWEEN, _CHORD + _BULGE, reason)
    proof.holds(_BULGE, ">=", 0, _CONVEX)
    proof.done(curvature, -2 * sp.exp(earlier) * (eta - 1))


_CONVEX = (
    "and so is the sum, for each past instant and hence for all: what is between is in contact too"
)


def contact_condition(proof: Proof, now: sp.Expr, then: sp.Expr, margin: sp.Expr) -> None:
    """Prove by F8 what the difference is of which the sign decides about contact."""
    proof.define(indenter(time), now, "the indenter at the element now")
    proof.define(indenter(earlier), then, "and then")
    proof.recall("F8", pushed_by()[0])
    proof.equal(margin, pushed_by()[0] - CLEAR, r"not negative where $\bar c(s) = 0$")


@result("F9-landing")
def _landing(proof: Proof) -> None:
    r"""Landing is at one point.

    While the indenter flies since $s_0$, an element is touched when $D(X)$ of (F9) is no longer negative for
    any $s_1 \le s_0$, and $e^{s} g$ not less than $u_0$. If two elements were touched at the same instant,
    those between them would exceed this condition by at least $\theta (1 - \theta) (e^{s} - e^{s_0}) (X_1 -
    X_2)^2$, whatever $s_1$ is: they would have been compressed before.
    """
    proof.where(sp.Gt(time, earlier), "any earlier instant")
    proof.where(mix < 1, "between two elements")
    proof.recall("F9", _BETWEEN)
    proof.where(sp.Gt(_one, _other), "that are not the same")
    proof.holds(_BETWEEN, ">", _CHORD,
                "if both landed at the same instant, the elements between would have before")  # fmt: skip
