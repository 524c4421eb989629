"""The forces between two edges in closed form, and how they depend on the motion (F11)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .contact_interval import E
from .theorems import lam
from .transient_edges import MEETS, RADICAND, b, edge_path, left, rho, right
from .transient_memory import SECTION, eta, time
from .transient_scaling import PRESSURE, P, d, d_s, f_normal, xi

a, f_friction = symbols(r"""
    a           -    1  -
    f_friction  f_x  1  scaled friction force, $F_x a_0/(W_0 \delta_0)$  from eq15  real several
""")

CONTACT = (xi, left, right)
_LOAD_SHARE, _FRICTION_SHARE = sp.Rational(3, 4), -sp.Rational(3, 2)


def _in_bracket(above: int, below: int, difference: sp.Expr) -> sp.Expr:
    """Return a fraction of a difference, which SymPy would write as two terms."""
    return sp.Mul(sp.Rational(above, below), difference, evaluate=False)


_squares, _cubes, _fourths = (right**n - left**n for n in (2, 3, 4))
NORMAL_FORCE = sp.Mul(
    _LOAD_SHARE, (d + d_s) * (right - left) - lam * _squares - _in_bracket(1, 3, _cubes), evaluate=False
)  # fmt: skip
FRICTION_FORCE = lam * _cubes + _in_bracket(3, 8, _fourths) - (d + d_s) * _LOAD_SHARE * _squares
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
    proof.integral(f_normal, _LOAD_SHARE * P, CONTACT, "all pressure is between the edges",
                   value=NORMAL_FORCE)  # fmt: skip
    proof.integral(f_friction, _FRICTION_SHARE * friction, CONTACT,
                   r"weighted with the slope $2 \xi$ of the surface", value=FRICTION_FORCE)  # fmt: skip
    proof.done(f_normal, NORMAL_FORCE)


@result("F11-peel")
def _peeling_forces(proof: Proof) -> None:
    r"""Forces while the right edge peels.

    The pressure at the left edge is $b (2 \rho - b)$, so that $b \le 2 \rho$.
    """
    proof.define(d_s, (right + lam) ** 2 - lam**2 - d, r"no pressure at $r$")
    proof.define(lam, rho - right)
    proof.define(left, right - b, "$b$ is the width of the contact")
    proof.equal(PRESSURE, (right - xi) * (xi - right + 2 * rho), "one difference")
    proof.recall("F11")
    proof.equal(f_normal, PEELING_NORMAL_FORCE, "without differences of powers")
    proof.recall("F11", f_friction)
    proof.equal(f_friction, PEELING_FRICTION_FORCE, "without differences of powers")
    proof.equal(sp.Subs(PEELING_NORMAL_FORCE, b, 2 * rho), rho**3, "both edges peel")
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
    proof.recall("F10-peel", rho, "F10-peel")
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
    ends = {
        end: sp.Function(name, real=True)(d, d_s) for end, name in ((right, "r"), (left, "ell"))
    }
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
            slope = share * inside + share * ahead - share * behind
            proof.equal(sp.Derivative(force, variable), slope, "moving ends")
    proof.recall("F10-touch", "F11-edges")
    proof.define(xi, _touching)
    speed = sp.Derivative(edge_path, time)
    proof.equal(P * sp.Derivative(_touching, d), speed, _TOUCHES)


_TOUCHES = "an edge that touches: its velocity through the foundation"


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
        proof.equal(sp.Derivative(force, variable), value, "F11")
    proof.done(sp.Derivative(f_normal, d), JACOBIAN[0])
