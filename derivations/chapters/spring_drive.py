"""A drive with a spring: the motion along the foundation, and its small motions in steady sliding (F22)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof
from .model import F_x, V, t, tau
from .power_law_weight import a_0
from .tables import delta_0
from .theorems import lam
from .transient_edges import left, rho, right
from .transient_memory import time
from .transient_motion import JACOBIAN, a, f_friction
from .transient_rates import QUADRATIC, at_motion, change, per_depth, per_rate, sigma
from .transient_scaling import W_0, d, d_s, d_ss, eps, f_normal

(
    quartic, M_x, k_x, C_x, eps_x, damper, kappa_x, lam_0, along, along_s, along_ss, along_0, swing, small,
) = symbols(r"""
    P_4        -               1       quartic of the rates  real
    M_x        -               kg/m    mass per unit width that moves along the foundation  from scene
    k_x        -               N/m²    stiffness of the spring in the drive per unit width  from scene
    C_x        -               N s/m²  damping of the damper beside it per unit width  from
            scene  nonnegative
    -          x_{\mathrm{A}}  m       how far the indenter has been dragged along the foundation
    epsilon_x  \varepsilon_x   1       inertia number along the foundation
    c_x        -               1       damper number  nonnegative
    kappa_x    \kappa_x        1       spring number
    lambda_0   -               1       drive number of the drive itself  real
    x_d        \check x        1       $x_{\mathrm{A}}/a_0$  real
    x_ds       \check x'       1       -  real
    x_dss      \check x''      1       -  real
    -          \check X        1       $\check x$ near steady sliding
    x_d0       \check x_0      1       $\check x$ in steady sliding  real
    x_d1       \check x_1      1       amplitude of the change of the position along the foundation  real
    theta_d    \check \theta   1       small number that multiplies both amplitudes  real
""")  # fmt: skip
x_a = function("x_A", real=True)(t)

SECTION = "A drive with a spring"
result = Chapter(SECTION)

_unit = W_0 * delta_0 / a_0
"""Of the friction force and of all forces along the foundation."""
LONGITUDINAL = eps_x * sigma**2 + (right**3 + a**3 + damper) * sigma + kappa_x
"""Its roots are the rates along the foundation of an indenter that is held at its depth."""
COUPLING = sp.Rational(9, 4) * lam**2 * right * sigma * (right + a + right * sigma)
QUARTIC = QUADRATIC * LONGITUDINAL - COUPLING


@result("F22-scaled")
def _scaled(proof: Proof) -> None:
    r"""Motion along the foundation.

    The indenter, of mass $M_x$ as far as it moves along the foundation, hangs on a spring of stiffness $k_x$
    and a damper $C_x$; $x_{\mathrm{A}}$ is how far it has been dragged. Two numbers more, and one for the
    damper, in the units $a_0$, $\tau$ and $W_0 \delta_0/a_0$ of (scaled-pressure). For $\kappa_x \to \infty$
    the drive is rigid.
    """
    proof.define(along_s, tau * x_a.diff(t) / a_0, "its velocity")
    proof.define(along_ss, tau**2 * x_a.diff(t, 2) / a_0, "its acceleration")
    proof.define(lam_0, V * tau / a_0, "drive number of the drive")
    proof.define(lam, (V - x_a.diff(t)) * tau / a_0, "and of the foundation under the indenter")
    proof.equal(lam, lam_0 - along_s, "the foundation slides under an indenter that gives way")
    proof.define(along, x_a / a_0, "its position")
    proof.define(f_friction, F_x / _unit, "friction force")
    proof.define(eps_x, M_x * a_0 / (_unit * tau**2), "inertia number along the foundation")
    proof.define(damper, C_x * a_0 / (_unit * tau), "damper number")
    proof.define(kappa_x, k_x * a_0 / _unit, "spring number")
    force = F_x - C_x * x_a.diff(t) - k_x * x_a
    proof.define(x_a.diff(t, 2), force / M_x, "friction, damper and spring")
    result = f_friction - damper * along_s - kappa_x * along
    proof.equal(along_ss, result / eps_x, "solved for the acceleration")
    proof.equal(eps_x * along_ss, result, "scaled motion")


@result("F22-forces")
def _forces(proof: Proof) -> None:
    """Stiffness and damping, along and across.

    How both forces depend on the depth, on its rate and on the velocity at which the foundation slides, after
    a start from rest.
    """
    _forces_of_start(proof)
    proof.recall("F11-start", a)
    slope, other = sp.Derivative(f_normal, lam), sp.Derivative(f_friction, d_s)
    proof.equal(slope, JACOBIAN[3], "F11; an edge that touches does not depend on it")
    proof.equal(slope, other, "a reciprocity")
    proof.equal(sp.Derivative(f_friction, lam), right**3 + a**3, "F11")
    proof.define(per_depth, right + lam + a, "stiffness of the contact")
    proof.define(per_rate, right + a, "damping of the contact: its length")
    values = (
        *(sp.Rational(3, 4) * per_depth, sp.Rational(3, 4) * per_rate, sp.Rational(3, 2) * lam * right),
        *(sp.Rational(3, 2) * lam * (right + a), sp.Rational(3, 2) * lam * right, right**3 + a**3),
    )  # fmt: skip
    pairs = [(force, variable) for force in (f_normal, f_friction) for variable in (d, d_s, lam)]
    for (force, variable), value in zip(pairs, values, strict=True):
        here, there = (sp.Subs(each, d_s, 0) for each in (sp.Derivative(force, variable), value))
        proof.equal(here, there, "in steady sliding, $d' = 0$")
    proof.done(slope, other)


def _forces_of_start(proof: Proof) -> None:
    """Let the forces be those of the edges after a start from rest."""
    proof.recall("F11-start", rho, right, left, "F11", f_normal, f_friction)


def _partial(force: str, variable: str) -> str:
    return rf"\frac{{\partial {force}}}{{\partial {variable}}}"


@result("F22")
def _quartic(proof: Proof) -> None:
    r"""Rates with a spring in the drive.

    Both motions near steady sliding: the depth is $D = a^2 + \check \theta \hat d e^{\sigma s}$, and the
    indenter is at $\check X = \check x_0 + \check \theta \check x_1 e^{\sigma s}$, so that the foundation
    slides at $\lambda - \check X'$. To first order both equations of motion hold if $\sigma$ is a root of the
    quartic.
    """
    place = a**2 + small * change * sp.exp(sigma * time)
    dragged = along_0 + small * swing * sp.exp(sigma * time)
    rate, slides = place.diff(time), lam - dragged.diff(time)
    proof.recall("F12-linear", per_depth, per_rate)
    own = [QUADRATIC, -sp.Rational(3, 2) * lam * right * sigma]
    other = [-sp.Rational(3, 2) * lam * (right + a + right * sigma), LONGITUDINAL]
    proof.define(quartic, QUARTIC, r"changes as $e^{\sigma s}$ are possible where it vanishes")
    determinant = own[0] * other[1] - own[1] * other[0]
    proof.equal(determinant, quartic, "the determinant of the two motions below")
    _forces_of_start(proof)
    proof.recall("scaled-form", d_ss, "F22-scaled", along_ss)
    edge = per_rate - a
    proof.equal(at_motion(right, {d: a**2, d_s: 0}), edge, "the trailing edge in steady sliding")
    proof.where(sp.Gt(place, 0), "the change is small")
    proof.where(sp.Gt(slides, 0), "the foundation slides on")
    proof.where(sp.Gt(place + rate + slides**2, 0), "and the contact remains")
    moving = {d: place, d_s: rate, lam: slides, along: dragged, along_s: dragged.diff(time)}
    for inertia, acceleration, row in (
        (eps * d_ss, eps * place.diff(time, 2), own),
        (eps_x * along_ss, eps_x * dragged.diff(time, 2), other),
    ):
        motion = acceleration - at_motion(inertia, moving)
        first = sp.Subs(sp.Derivative(motion, small), small, 0)
        linear = (row[0] * change + row[1] * swing).subs(right, edge) * sp.exp(sigma * time)
        proof.equal(first, linear, r"the terms of first order in $\check \theta$")
    proof.done(determinant, quartic)


@result("F22-energy")
def _energy(proof: Proof) -> None:
    r"""Balance of energy with the spring.

    What the drive gives, in dimensional form $F_x V$, becomes energy of the motion along the foundation and
    of the spring, or is lost in its damper; the rest, $\lambda f_x$, goes to the foundation and the motion
    across, as with a rigid drive (F14-energy).
    """
    place = sp.Function(r"\check x", real=True)(time)
    moves = sp.Derivative(place, time)
    proof.recall("F22-scaled", "F22-scaled", lam)
    for name, value in ((along, place), (along_s, moves)):
        proof.define(name, value, "in time")
    proof.define(sp.Derivative(place, (time, 2)), along_ss, "and its rate")
    stored = eps_x * moves**2 / 2 + kappa_x * place**2 / 2
    spent = lam * f_friction + sp.Derivative(stored, time) + damper * moves**2
    proof.equal(lam_0 * f_friction, spent, "by the balance of forces")
