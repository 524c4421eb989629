"""Transient sliding: the scaled equations with their three numbers."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol
from ..engine.step import Proof
from .groups import k_s
from .model import (
    C, F_z, K, M, R, V, compression_rate, delta_t, depth_rate, g, h, slope, t, tau, u_i, x_i,
)  # fmt: skip
from .power_law_weight import a_0
from .tables import delta_0
from .theorems import kappa, lam

z_a = function(
    "z_A", "height of the lowest point of the indenter", "m", printed=r"z_{\mathrm{A}}", real=True
)(t)
W_0 = symbol("W_0", "static load per unit width", "N/m")
d = symbol("d", r"scaled depth, $\delta/\delta_0$")
d_s = symbol("d_s", latex="d'", real=True)
d_ss = symbol("d_ss", latex="d''", real=True)
eps = symbol("epsilon", r"inertia number, $M \delta_0/(W_0 \tau^{2})$", latex=r"\varepsilon")
f_normal = symbol("f_normal", "scaled normal force, $F_z/W_0$", latex="f_z", source="eq14",
                  several=True, real=True)  # fmt: skip
xi = symbol("xi", "scaled coordinate, $x/a_0$", latex=r"\xi", real=True)
P = symbol("P", r"scaled pressure, $p/(K \delta_0)$", latex=r"\hat p", printed=r"\bar p", real=True)


PRESSURE = d + d_s - xi**2 - 2 * lam * xi
"""p/(K delta_0) in the contact."""

result = Chapter("Transient sliding")


def _scale(proof: Proof) -> None:
    """Define the scaled variables."""
    proof.define(a_0, sp.sqrt(2 * R * delta_0))
    proof.define(W_0, sp.Rational(4, 3) * K * a_0 * delta_0, "the load at rest")
    proof.define(xi, x_i / a_0)
    proof.define(d, delta_t / delta_0)
    proof.define(d_s, tau * depth_rate / delta_0)


@result("scaled-pressure")
def _scaled_pressure(proof: Proof) -> None:
    r"""Scaled pressure.

    The unit of lengths along $x$ is $a_0 = \sqrt{2 R \delta_0}$, the half length of the contact at rest, that
    of depths the static depth $\delta_0$, that of forces the static load $W_0 = \frac{4}{3} K a_0 \delta_0$
    and that of time $\tau$; a prime is the derivative with respect to $s = t/\tau$.
    """
    _scale(proof)
    proof.recall("eq22")
    proof.define(slope, x_i / R, "Eq. (3)")
    proof.define(h(x_i), x_i**2 / (2 * R), "Eq. (3)")
    proof.recall("eq6")
    proof.equal(u_i / delta_0, d - xi**2, "compression under the indenter")
    proof.recall("eq7")
    proof.define(lam, V * tau / a_0, "drive number")
    proof.equal(tau * compression_rate / delta_0, d_s - 2 * lam * xi, "its rate")
    here = sp.Symbol("p", real=True)
    proof.define(here, K * u_i + C * compression_rate)
    proof.define(P, here / (K * delta_0))
    proof.equal(P, PRESSURE, "scaled pressure")
    proof.equal(here * a_0 / W_0, sp.Rational(3, 4) * P,
                r"share of the load, for Eq. (14), with $dx = a_0 d\xi$")  # fmt: skip
    proof.equal(-slope * here * a_0 / (W_0 * delta_0 / a_0), -sp.Rational(3, 2) * xi * P,
                r"share of the friction force, in units of $W_0 \delta_0/a_0$")  # fmt: skip
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
    proof.define(d, delta_t / delta_0)
    proof.define(d_ss, tau**2 * delta_t.diff(t, 2) / delta_0)
    proof.define(f_normal, F_z / W_0)
    proof.define(eps, M * delta_0 / (W_0 * tau**2), "inertia number")
    proof.define(kappa, k_s * delta_0 / W_0, "support number")
    proof.define(g, W_0 / M, "the weight is the load at rest")
    proof.define(z_a.diff(t, 2), force / M, "Eq. (17) with the force of the spring")
    result = 1 - f_normal - kappa * (d - 1)
    proof.equal(d_ss, result / eps, "solved for the acceleration")
    proof.equal(eps * d_ss, result, "scaled motion")
