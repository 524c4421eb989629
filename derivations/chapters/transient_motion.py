"""The forces between two edges in closed form, and how they depend on the motion (F11)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof, tex
from .contact_interval import E
from .theorems import lam
from .transient_edges import MEETS, RADICAND, b, edge_path, left, rho, right
from .transient_memory import SECTION, eta, time
from .transient_scaling import PRESSURE, P, d, d_s, f_normal, xi

a, f_friction = symbols(r"""
    a           -    1  -
    f_friction  f_x  1  scaled friction force, $F_x a_0/(W_0 \delta_0)$  from eq15  real
""")

CONTACT = (xi, left, right)
_LOAD_SHARE, _FRICTION_SHARE = sp.Rational(3, 4), -sp.Rational(3, 2)

NORMAL_FORCE = _LOAD_SHARE * (
    (d + d_s) * (right - left) - (right**3 - left**3) / 3 - lam * (right**2 - left**2)
)
FRICTION_FORCE = _FRICTION_SHARE * (
    (d + d_s) * (right**2 - left**2) / 2
    - (right**4 - left**4) / 4
    - 2 * lam * (right**3 - left**3) / 3
)
PEELING_NORMAL_FORCE = b**2 * (3 * rho - b) / 4
"""Right edge at r = rho - lambda, left edge at r - b: no cancellation."""
PEELING_FRICTION_FORCE = b**2 * (4 * right * (b - 3 * rho) + b * (8 * rho - 3 * b)) / 8
JACOBIAN = (
    _LOAD_SHARE * (right + a + lam + d_s / (2 * a)),
    _LOAD_SHARE * (right + a),
    _LOAD_SHARE * (a**2 - right**2 + 2 * lam * a + d_s),
    _LOAD_SHARE * (a**2 - right**2),
)
"""Derivatives of both forces with respect to d and d' after a start from rest."""

START = {right: sp.sqrt(RADICAND) - lam, left: -sp.sqrt(d)}
"""The edges after a start from rest: the right one peels, the left one touches undisturbed ground."""

_touching = sp.Function("xi", real=True)(d, d_s)
"""The dependence of a touching edge on the motion."""
result = Chapter(SECTION)


@result("F11")
def _forces(proof: Proof) -> None:
    r"""Forces between two edges.

    In units of $W_0$ and $W_0 \delta_0/a_0$, with the edges $\ell < r$ of F10: there is no pressure outside.
    """
    friction = sp.expand(xi * PRESSURE)
    proof.recall("scaled-pressure")
    proof.integral(
        *(f_normal, _LOAD_SHARE * P, CONTACT, _LOAD_SHARE * sp.integrate(PRESSURE, xi)),
        "all pressure is between the edges", value=NORMAL_FORCE, right=_NORMAL,
    )  # fmt: skip
    proof.integral(
        *(f_friction, _FRICTION_SHARE * friction, CONTACT, _FRICTION_SHARE * sp.integrate(friction, xi)),
        r"weighted with the slope $2 \xi$ of the surface", value=FRICTION_FORCE, right=_FRICTION,
    )  # fmt: skip
    proof.done(f_normal, NORMAL_FORCE)


_NORMAL = (
    r"\frac{3}{4} \left[(d + d') (r - \ell) - "
    r"\frac{r^3 - \ell^3}{3} - \lambda (r^2 - \ell^2)\right]"
)
_FRICTION = (
    r"-\frac{3}{2} \left[(d + d') \frac{r^2 - "
    r"\ell^2}{2} - \frac{r^4 - \ell^4}{4} - 2 \lambda \frac{r^3 - \ell^3}{3}\right]"
)


@result("F11-peel")
def _peeling_forces(proof: Proof) -> None:
    r"""Forces while the right edge peels.

    The pressure at the left edge is $b (2 \rho - b)$, so that $b \le 2 \rho$.
    """
    proof.define(d_s, (right + lam) ** 2 - lam**2 - d, r"no pressure at $r$")
    proof.define(lam, rho - right)
    proof.define(left, right - b, "$b$ is the width of the contact")
    proof.notation |= {r"\hat p": PRESSURE, "f_z": sp.Lambda(b, PEELING_NORMAL_FORCE)}
    proof.equal(PRESSURE, (right - xi) * (xi - right + 2 * rho), "one difference", left=r"\hat p")
    proof.recall("F11")
    proof.equal(f_normal, PEELING_NORMAL_FORCE, "without differences of powers")
    proof.recall("F11", f_friction)
    proof.equal(f_friction, PEELING_FRICTION_FORCE, "without differences of powers")
    both = PEELING_NORMAL_FORCE.subs(b, 2 * rho)
    proof.equal(both, rho**3, "both edges peel: $b = 2 \\rho$", left=r"f_z(2 \rho)")
    proof.done(f_normal, PEELING_NORMAL_FORCE)


@result("F11-edges")
def _edges(proof: Proof) -> None:
    r"""How edges depend on the motion.

    An edge that peels is a zero of the pressure. One that touches at $\xi$ meets ground that was left at
    $\eta$, where $d - \xi^2 = E (d_0 - \eta^2)$ with $\eta = \xi - m$, $d_0$ and $E$ of that instant. Where
    each element was left at its own instant, this has no effect to first order, as (F10-gradual) shows.
    """
    moved = sp.Symbol("m", real=True)
    proof.define(xi, _touching, "a touching edge moves with the depth")
    proof.recall("F10-touch", MEETS)
    proof.define(eta, _touching - moved, "where the element was when the edge left it")
    proof.where(sp.Gt(_touching, E * eta), "a right edge; a left one mirrors it")
    per_depth = 1 / (2 * (_touching - E * eta))
    for variable, value in ((d, per_depth), (d_s, sp.S.Zero)):
        slope = sp.Derivative(_touching, variable)
        proof.root(sp.Derivative(MEETS, variable), slope, value, "an edge that touches")
    proof.where(sp.Gt(RADICAND, 0), "the indenter is on the foundation")
    proof.recall("F10-peel", rho)
    proof.recall("F10-peel")
    for variable in (d, d_s):
        slope = sp.Derivative(right, variable)
        proof.equal(slope, 1 / (2 * rho), "an edge that peels")
    proof.done(sp.Derivative(_touching, d), per_depth)


@result("F11-derivatives")
def _derivatives(proof: Proof) -> None:
    r"""How forces depend on the motion.

    At an edge that peels $\hat p$ vanishes (F10-peel), and with it the term of that edge. An edge that
    touches does not depend on $d'$; it contributes its velocity $X_{\mathrm{e}}'$ through the foundation to
    $\partial f_z/\partial d$.
    """
    ends = {right: sp.Function("r", real=True)(d, d_s), left: sp.Function("ell", real=True)(d, d_s)}
    proof.notation |= {r"\hat p": sp.Lambda(xi, PRESSURE), r"\ell": ends[left], "r": ends[right]}
    proof.recall("F11", f_normal, f_friction)
    for end, moves in ends.items():
        proof.define(end, moves, "an edge that moves")
    for variable in (d, d_s):
        for force, share, weight in ((f_normal, _LOAD_SHARE, 1), (f_friction, _FRICTION_SHARE, xi)):
            inside = sp.integrate(weight, CONTACT)
            ahead, behind = (
                (weight * PRESSURE).subs(xi, end) * sp.Derivative(end, variable)
                for end in ends.values()
            )
            proof.equal(
                *(sp.Derivative(force, variable), share * (inside + ahead - behind), "moving ends"),
                left=_partial(force, variable), right=_moving_ends(share, inside, force, variable),
            )  # fmt: skip
    proof.recall("F10-touch")
    proof.recall("F11-edges")
    proof.define(xi, _touching)
    speed = sp.Derivative(edge_path, time)
    proof.notation |= {r"\hat p": P, r"X_{\mathrm{e}}": edge_path}
    proof.equal(P * sp.Derivative(_touching, d), speed, _TOUCHES, right=r"X_{\mathrm{e}}'")


_TOUCHES = "an edge that touches: its velocity through the foundation"


def _partial(force: sp.Expr, variable: sp.Expr) -> str:
    return rf"\frac{{\partial {tex(force)}}}{{\partial {tex(variable)}}}"


def _moving_ends(share: sp.Expr, inside: sp.Expr, force: sp.Expr, variable: sp.Expr) -> str:
    """Print share * (inside + what the integrand has at the ends, times how they move)."""
    ends = [
        rf"{tex(end) if force == f_friction else ''} \hat p({tex(end)}) {_partial(end, variable)}"
        for end in (right, left)
    ]
    return rf"{tex(share)} \left[{tex(inside)} + {ends[0]} - {ends[1]}\right]"


@result("F11-start")
def _start_from_rest(proof: Proof) -> None:
    """How forces depend on the motion after a start from rest.

    While the drive does not slow down, the right edge peels and the left one touches undisturbed ground: the
    motion is an ordinary differential equation of two variables, without memory, with this Jacobian.
    """
    proof.recall("F10-peel", rho, right, reason="the right edge peels")
    proof.recall("F10-touch", left, reason="the left one touches undisturbed ground")
    proof.define(a, sp.sqrt(d), "half of a contact at rest")
    proof.recall("F11", f_normal, f_friction)
    pairs = [(force, variable) for force in (f_normal, f_friction) for variable in (d, d_s)]
    for (force, variable), value in zip(pairs, JACOBIAN, strict=True):
        proof.equal(sp.Derivative(force, variable), value, "F11", left=_partial(force, variable))
    proof.done(sp.Derivative(f_normal, d), JACOBIAN[0])
