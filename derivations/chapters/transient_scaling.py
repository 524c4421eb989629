"""Transient sliding: the scaled equations with their three numbers, and the edges that peel (Eq. 33)."""

import sympy as sp

from ..engine.book import Shown
from ..engine.chapter import Chapter
from ..engine.nomenclature import function, letter, symbol
from ..engine.step import Proof
from .groups import k_s
from .model import (
    C,
    F_z,
    K,
    M,
    R,
    V,
    compression_rate,
    delta_t,
    depth_rate,
    g,
    h,
    slope,
    t,
    tau,
    u_i,
    x,
    x_i,
)
from .power_law_weight import a_0
from .steady import a, l_r, p
from .tables import delta_0
from .theorems import kappa, lam

z_a = function(
    "z_A", "height of the lowest point of the indenter", "m", printed=r"z_{\mathrm{A}}", real=True
)(t)
letter("x_{-}", "smaller zero of the pressure", "m")
W_0 = symbol("W_0", "static load per unit width", "N/m")
d = symbol("d", r"scaled depth, $\delta/\delta_0$")
d_s = symbol("d_s", latex="d'", real=True)
d_ss = symbol("d_ss", latex="d''", real=True)
eps = symbol("epsilon", r"inertia number, $M \delta_0/(W_0 \tau^{2})$", latex=r"\varepsilon")
f_normal = symbol(
    "f_normal", "scaled normal force, $F_z/W_0$", latex="f_z", source="eq14", real=True
)
xi = symbol("xi", "scaled coordinate, $x/a_0$", latex=r"\xi", real=True)
P = symbol("P", r"scaled pressure, $p/(K \delta_0)$", latex=r"\hat p", printed=r"\bar p", real=True)


PRESSURE = d + d_s - xi**2 - 2 * lam * xi
"""p/(K delta_0) in the contact."""

_half = sp.sqrt(2 * R * delta_t)
_x_minus = symbol("x_-", latex="x_{-}", real=True)
_x_plus = symbol("x_TE", latex=r"x_{\mathrm{TE}}", real=True)
"""Zeros of the pressure; x_TE may be negative under an indenter that moves."""
TRAILING = sp.sqrt(a**2 * (1 + tau * depth_rate / delta_t) + l_r**2) - l_r
"""Eq. 33: the zeros of the pressure."""
LEADING = -sp.sqrt(a**2 * (1 + tau * depth_rate / delta_t) + l_r**2) - l_r

_RADICAND = r"a^2 \left(1 + \tau \frac{\dot\delta}{\delta}\right) + l_{\mathrm{r}}^2"
result = Chapter("Transient sliding")


def _scale(proof: Proof) -> None:
    """Define the scaled variables."""
    proof.define(a_0, sp.sqrt(2 * R * delta_0), right=r"\sqrt{2 R \delta_0}")
    proof.define(W_0, sp.Rational(4, 3) * K * a_0 * delta_0, "the load at rest")
    proof.define(xi, x_i / a_0, right="x_i/a_0")
    proof.define(d, delta_t / delta_0, right=r"\delta/\delta_0")
    proof.define(d_s, tau * depth_rate / delta_0, left="d'", right=r"\tau \dot\delta/\delta_0")


@result("scaled-pressure")
def _scaled_pressure(proof: Proof) -> None:
    r"""Scaled pressure.

    The unit of lengths along $x$ is $a_0 = \sqrt{2 R \delta_0}$, the half length of the contact at rest, that
    of depths the static depth $\delta_0$, that of forces the static load $W_0 = \frac{4}{3} K a_0 \delta_0$
    and that of time $\tau$; a prime is the derivative with respect to $s = t/\tau$.
    """
    _scale(proof)
    proof.recall("eq22")
    proof.define(slope, x_i / R, "Eq. (3)", left="h'(x_i)", right="x_i/R")
    proof.define(h(x_i), x_i**2 / (2 * R), "Eq. (3)", left="h(x_i)", right="x_i^2/(2 R)")
    proof.recall("eq6")
    proof.equal(u_i / delta_0, d - xi**2, "compression under the indenter")
    proof.recall("eq7")
    proof.define(lam, V * tau / a_0, "drive number")
    shown = r"\frac{\tau \dot u_i}{\delta_0}"
    proof.equal(tau * compression_rate / delta_0, d_s - 2 * lam * xi, "its rate", left=shown)
    here = sp.Symbol("p", real=True)
    proof.define(here, K * u_i + C * compression_rate, right=r"K u_i + C \dot u_i")
    proof.define(P, here / (K * delta_0))
    proof.equal(P, PRESSURE, "scaled pressure")
    proof.equal(
        *(
            here * a_0 / W_0,
            sp.Rational(3, 4) * P,
            r"share of the load, for Eq. (14), with $dx = a_0 d\xi$",
        ),
    )
    proof.equal(
        -slope * here * a_0 / (W_0 * delta_0 / a_0),
        -sp.Rational(3, 2) * xi * P,
        r"share of the friction force, in units of $W_0 \delta_0/a_0$",
    )
    proof.done(P, PRESSURE)


@result("scaled-form", uses=("scaled-pressure",))
def _scaled_motion(proof: Proof) -> None:
    r"""Scaled motion of the indenter.

    Three dimensionless numbers remain: $\lambda = V \tau/a_0$, $\varepsilon = M \delta_0/(W_0 \tau^2)$ and
    $\kappa = k_s \delta_0/W_0$. A dead weight has $\kappa = 0$; a spring of stiffness $k_s$, relaxed at the
    static depth, makes the indenter suspended, and $\kappa \to \infty$ holds it at $d = 1$.
    """
    force = F_z - M * g - k_s * (z_a + delta_0)
    proof.recall("eq18")
    proof.define(d, delta_t / delta_0, right=r"\delta/\delta_0")
    proof.define(d_ss, tau**2 * delta_t.diff(t, 2) / delta_0, right=r"\tau^2 \ddot\delta/\delta_0")
    proof.define(f_normal, F_z / W_0)
    proof.define(eps, M * delta_0 / (W_0 * tau**2), "inertia number")
    proof.define(kappa, k_s * delta_0 / W_0, "support number")
    proof.define(g, W_0 / M, "the weight is the load at rest")
    proof.define(
        *(z_a.diff(t, 2), force / M, "Eq. (17) with the force of the spring"),
        left=r"\ddot z_{\mathrm{A}}",
    )
    result = 1 - f_normal - kappa * (d - 1)
    shown: Shown = {"left": r"\varepsilon d''", "right": r"1 - f_z - \kappa (d - 1)"}
    proof.equal(eps * d_ss, result, "scaled motion", **shown)


@result("eq33")
def _peeling_edges(proof: Proof) -> None:
    """Trailing edge of the movable indenter.

    It holds while the edge peels, that is, while elements leave the contact there because their pressure
    vanishes. The paper gives one zero of the pressure; the other is a leading edge that peels, as occurs when
    the indenter is lifted faster than the edge advances onto undisturbed ground. If there is no zero, no
    element can be pressed and the indenter has left the foundation.
    """
    half = K / (2 * R)
    square = a**2 * (1 + tau * depth_rate / delta_t) + l_r**2
    proof.recall("pressure-moving", p)
    proof.recall("eq3")
    proof.recall("eq22")
    proof.recall("eq29")
    proof.define(a, _half, "now depends on time", right=r"\sqrt{2 R \delta(t)}")
    proof.equal(
        *(p, half * (square - (x + l_r) ** 2), r"largest at $x = -l_{\mathrm{r}}$"),
        right=rf"\frac{{K}}{{2 R}} \left[{_RADICAND} - (x + l_{{\mathrm{{r}}}})^2\right]",
    )
    proof.notation |= {"x_{-}": LEADING, r"x_{\mathrm{TE}}": TRAILING}
    proof.where(sp.Gt(square, 0), "else no element can be pressed", left=_RADICAND)
    proof.equal(
        *(p, half * (TRAILING - x) * (x - LEADING), "positive exactly between its zeros"),
        right=r"\frac{K}{2 R} \left(x_{\mathrm{TE}} - x\right) \left(x - x_{-}\right)",
    )
    proof.root(
        *(p, x, LEADING, "a leading edge that peels, where Eq. (32) does not hold"),
        over=(x, -sp.oo, -l_r), name=_x_minus, right=rf"-\sqrt{{{_RADICAND}}} - l_{{\mathrm{{r}}}}",
    )  # fmt: skip
    proof.root(
        *(p, x, TRAILING, "the trailing edge while it peels"), over=(x, -l_r, sp.oo),
        name=_x_plus, right=rf"\sqrt{{{_RADICAND}}} - l_{{\mathrm{{r}}}}",
    )  # fmt: skip
