"""A drive with a spring: the motion along the foundation, and its small motions in steady sliding (F22)."""

import sympy as sp

from ..engine.book import established
from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof
from .model import F_x, V, t, tau
from .power_law_weight import a_0
from .tables import delta_0
from .theorems import kappa, lam
from .transient_edges import right
from .transient_memory import time
from .transient_motion import JACOBIAN, START, a, f_friction
from .transient_rates import QUADRATIC, change, per_depth, per_rate, sigma
from .transient_scaling import W_0, d, d_s, eps, f_normal

(
    M_x, k_x, C_x, eps_x, damper, kappa_x, lam_0, along, along_s, along_ss, along_0, swing, small,
) = symbols(r"""
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


@result("F22-scaled", uses=("scaled-pressure", "eq15"))
def _scaled(proof: Proof) -> None:
    r"""Motion along the foundation.

    The indenter, of mass $M_x$ as far as it moves along the foundation, hangs on a spring of stiffness $k_x$
    and a damper $C_x$; $x_{\mathrm{A}}$ is how far it has been dragged. Two numbers more, and one for the
    damper, in units of $a_0$, $\tau$ and $W_0 \delta_0/a_0$. For $\kappa_x \to \infty$ the drive is rigid.
    """
    proof.define(along_s, tau * x_a.diff(t) / a_0)
    proof.define(along_ss, tau**2 * x_a.diff(t, 2) / a_0)
    proof.define(lam_0, V * tau / a_0)
    proof.define(lam, (V - x_a.diff(t)) * tau / a_0)
    proof.equal(lam, lam_0 - along_s, "the foundation slides under an indenter that gives way")
    proof.define(along, x_a / a_0)
    proof.define(f_friction, F_x / _unit)
    proof.define(eps_x, M_x * a_0 / (_unit * tau**2))
    proof.define(damper, C_x * a_0 / (_unit * tau))
    proof.define(kappa_x, k_x * a_0 / _unit)
    force = F_x - C_x * x_a.diff(t) - k_x * x_a
    proof.define(x_a.diff(t, 2), force / M_x, "friction, damper and spring")
    result = f_friction - damper * along_s - kappa_x * along
    proof.equal(eps_x * along_ss, result, "scaled motion")


@result("F22-forces", uses=("F11-start",))
def _forces(proof: Proof) -> None:
    """Stiffness and damping, along and across.

    How both forces depend on the depth, on its rate and on the velocity at which the foundation slides, after
    a start from rest.
    """
    proof.where(sp.Gt(d + d_s + lam**2, 0), "the indenter is on the foundation")
    proof.define(right, START[right], "peels")
    proof.define(a, sp.sqrt(d))
    named = {"f_z": f_normal, "f_x": f_friction}
    forces = {name: established("F11", each).subs(START) for name, each in named.items()}
    proof.notation |= forces
    slopes = {name: sp.Derivative(force, lam) for name, force in forces.items()}
    proof.equal(slopes["f_z"], JACOBIAN[3], "F11; an edge that touches does not depend on it",
                left=_partial("f_z", r"\lambda"))  # fmt: skip
    proof.equal(slopes["f_z"], sp.Derivative(forces["f_x"], d_s), "a reciprocity",
                left=_partial("f_z", r"\lambda"), right=_partial("f_x", "d'"))  # fmt: skip
    proof.equal(slopes["f_x"], right**3 + a**3, "F11", left=_partial("f_x", r"\lambda"))
    proof.define(per_depth, right + lam + a)
    proof.define(per_rate, right + a)
    steady = (
        ("f_z", "d", d, sp.Rational(3, 4) * per_depth),
        ("f_z", "d'", d_s, sp.Rational(3, 4) * per_rate),
        ("f_z", r"\lambda", lam, sp.Rational(3, 2) * lam * right),
        ("f_x", "d", d, sp.Rational(3, 2) * lam * (right + a)),
        ("f_x", "d'", d_s, sp.Rational(3, 2) * lam * right),
        ("f_x", r"\lambda", lam, right**3 + a**3),
    )
    for name, latex, variable, value in steady:
        slope = sp.Subs(sp.Derivative(forces[name], variable), d_s, 0)
        here = sp.Subs(value, d_s, 0)
        proof.equal(slope, here, "in steady sliding, $d' = 0$",
                    left=rf"\left. {_partial(name, latex)} \right|_{{d' = 0}}")  # fmt: skip
    proof.done(slopes["f_z"], sp.Derivative(forces["f_x"], d_s))


def _partial(force: str, variable: str) -> str:
    return rf"\frac{{\partial {force}}}{{\partial {variable}}}"


@result("F22", uses=("scaled-form", "F22-scaled", "F11-start", "F12-linear"))
def _quartic(proof: Proof) -> None:
    r"""Rates with a spring in the drive.

    Both motions near steady sliding: the depth is $D = a^2 + \check \theta \hat d e^{\sigma s}$, and the
    indenter is at $\check x = \check x_0 + \check \theta \check x_1 e^{\sigma s}$, so that the foundation
    slides at $\lambda - \check x'$. To first order both equations of motion hold if $\sigma$ is a root of the
    quartic.
    """
    place = a**2 + small * change * sp.exp(sigma * time)
    dragged = along_0 + small * swing * sp.exp(sigma * time)
    rate, slides = place.diff(time), lam - dragged.diff(time)
    forces = {
        name: sp.Lambda((d, d_s, lam), established("F11", force).subs(START))
        for name, force in (("f_z", f_normal), ("f_x", f_friction))
    }
    pushed, rubbed = (force(place, rate, slides) for force in forces.values())
    across = eps * place.diff(time, 2) - (1 - pushed - kappa * (place - 1))
    lengthwise = eps_x * dragged.diff(time, 2) - (
        rubbed - damper * dragged.diff(time) - kappa_x * dragged
    )
    proof.notation |= {"D": sp.Lambda(time, place), r"\check x": sp.Lambda(time, dragged), **forces}
    proof.where(sp.Gt(place, 0), "the change is small")
    proof.where(sp.Gt(place + rate + slides**2, 0), "and the contact remains")
    proof.define(right, sp.sqrt(a**2 + lam**2) - lam, "the trailing edge in steady sliding")
    proof.define(per_depth, sp.sqrt(a**2 + lam**2) + a)
    proof.define(per_rate, right + a)
    own = [QUADRATIC, -sp.Rational(3, 2) * lam * right * sigma]
    other = [-sp.Rational(3, 2) * lam * (right + a + right * sigma), LONGITUDINAL]
    for motion, row, shown in (
        (across, own, r"\varepsilon D'' - \left(1 - f_z(D, D', \lambda - \check x') - \kappa (D - 1)\right)"),
        (lengthwise, other, r"\varepsilon_x \check x'' - \left(f_x(D, D', \lambda - \check x') - c_x "
         r"\check x' - \kappa_x \check x\right)"),
    ):  # fmt: skip
        first = sp.Subs(sp.Derivative(motion, small), small, 0)
        proof.equal(
            *(first, (row[0] * change + row[1] * swing) * sp.exp(sigma * time), _FIRST),
            left=rf"\left. \frac{{\partial}}{{\partial \check \theta}} \left[{shown}\right] "
            r"\right|_{\check \theta = 0}",
        )  # fmt: skip
    determinant = own[0] * other[1] - own[1] * other[0]
    both = rf"\left({_ACROSS}\right) \left({_ALONG}\right)"
    proof.equal(
        *(determinant, QUARTIC, "both vanish for some motion: the determinant does"),
        left=both
        + r" - \left(\frac{3}{2} \lambda r \sigma\right) \left(\frac{3}{2} \lambda (r + a + r \sigma)\right)",
        right=both + r" - \frac{9}{4} \lambda^2 r \sigma (r + a + r \sigma)",
    )  # fmt: skip


_ACROSS = r"\varepsilon \sigma^2 + \frac{3}{4} B \sigma + \frac{3}{4} A + \kappa"
_ALONG = r"\varepsilon_x \sigma^2 + (r^3 + a^3 + c_x) \sigma + \kappa_x"
_FIRST = r"the terms of first order in $\check \theta$"


@result("F22-energy", uses=("F22-scaled", "F14-energy"))
def _energy(proof: Proof) -> None:
    """Balance of energy with the spring.

    What the drive gives, in dimensional form $F_x V$, becomes energy of the motion along the foundation and
    of the spring, or is lost in its damper; the rest goes to the foundation and the motion across, as with a
    rigid drive.
    """
    place = sp.Function(str(along), real=True)(time)
    moves = sp.Derivative(place, time)
    held = f_friction - damper * moves - kappa_x * place
    proof.notation[r"\check x"] = place
    proof.define(sp.Derivative(place, (time, 2)), held / eps_x, "F22-scaled", left=r"\check x''",
                 right=r"\frac{f_x - c_x \check x' - \kappa_x \check x}{\varepsilon_x}")  # fmt: skip
    proof.define(lam, lam_0 - moves, right=r"\lambda_0 - \check x'")
    stored = eps_x * moves**2 / 2 + kappa_x * place**2 / 2
    spent = lam * f_friction + sp.Derivative(stored, time) + damper * moves**2
    proof.equal(
        *(lam_0 * f_friction, spent, r"$\lambda f_x$ is spent as in F14-energy"),
        right=r"\lambda f_x + \frac{d}{ds} \left[\frac{\varepsilon_x \check x'^2}{2} + "
        r"\frac{\kappa_x \check x^2}{2}\right] + c_x \check x'^2",
    )  # fmt: skip
