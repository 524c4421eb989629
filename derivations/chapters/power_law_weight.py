r"""A power law under a weight: balance of forces, exponents, and the one friction maximum (F19).

In units of the static state: s = a/a_0, delta/delta_0 = s**n, lambda = V tau/a_0, f = W/W_0.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbol
from ..engine.step import Proof
from .model import C, K, V, delta
from .power_law import (
    HIGH_COEFFICIENT, LOW_SLOPE, NUMBER, SECTION, SLOPE_POWER, L, Q, excess, in_q, m_n, n, phi_n,
    w_n, z,
)  # fmt: skip
from .power_law_limits import AT_REST, m_high, phi_l, w_l
from .steady import W, a, l, l_r, mu, q
from .tables import delta_0
from .theorems import kappa, lam, r, s

scaled_n = symbol("f_n", "scaled load of a power law that has been lifted, $W/W_0$")
scaled_n_s = symbol("f_n_s", latex="f_n'")
L_1 = symbol("L_1", "asymptote of the friction coefficient for low velocity")
L_2 = symbol("L_2", "asymptote of the friction coefficient for high velocity")
W_0 = symbol("W_0")
slip_n = symbol("D_n", "logarithmic slope of the friction coefficient of a power law", real=True)
T_n = symbol("T_n", "scaled friction of a power law over its asymptote for low velocity", real=True)
lam_cross = symbol("lambda_cross", "drive number where the asymptotes meet", latex=r"\lambda^{*}")
a_0 = symbol("a_0", "static half length of the contact", "m")

SCALED_LOAD = s**n * (s + r + lam + lam**2 / (r + n * lam)) / 2
SCALED_SLOPE = (n + 1) * s ** (n - 1) * (s + r + lam) / 2
_SHARE = (n - 1) / (2 * n - 1)
CROSSING = n * 2**_SHARE * (1 + kappa) ** _SHARE / (n + 1)
_DAMPED = 1 + q * Q**2
SLIP = _DAMPED * (1 + q + l - (2 * n - 1) * l**2 * Q) - n * (2 * n - 1) * l**3 * Q**3
"""Has the sign of d mu/dV at a given load."""

result = Chapter(SECTION)


@result("F19-scaled-load")
def _scaled_load(proof: Proof) -> None:
    r"""Power law: load of an indenter that has been lifted.

    In units of the static state, $s = a/a_0$, so that $\delta/\delta_0 = s^n$, with $\lambda = V \tau/a_0$,
    $r = x_{\mathrm{TE}}/a_0$ and $W_0 = \frac{2 n}{n + 1} K \delta_0 a_0$.
    """
    proof.recall("F19-load")
    proof.define(
        scaled_n, s ** (n + 1) * w_n / AT_REST, r"$W = K \delta a\, w_n$ over its value at rest"
    )
    proof.define(lam, s * l, r"$l = V \tau/a$")
    proof.define(r, s * q, r"$x_{\mathrm{TE}}/a_0$")
    proof.recall("F19-edge", q)
    proof.equal(scaled_n, SCALED_LOAD, "a sum of positive terms")


@result("F19-balance")
def _balance(proof: Proof) -> None:
    r"""Power law: a unique depth at a load.

    On a spring of support number $\kappa$ (none for a dead weight) $G = f_n + \kappa (s^n - 1) - 1$ vanishes.
    $G$ increases from $-(1 + \kappa)$ at $s = 0$ to $f_n(1) - 1 \ge 0$ at $s = 1$, because the load grows
    with the velocity; so there is one depth. As $n < d \ln f_n/d \ln s < n + 1$, the relative error of
    $\delta = s^n \delta_0$ is, to first order, at most that with which the two sides of the balance are
    computed, and Newton's method in $\ln s$ divides the error by at least $n$ from wherever it starts.
    """
    in_q(proof)
    proof.define(s, lam / NUMBER, r"at fixed velocity, $\lambda$ constant")
    proof.define(r, s * q, r"$x_{\mathrm{TE}}/a_0$")
    proof.recall("F19-scaled-load")
    slope = SCALED_SLOPE * sp.Derivative(s, q)
    proof.equal(sp.Derivative(scaled_n, q), slope, "a deeper indenter carries more")
    proof.define(scaled_n_s, SCALED_SLOPE, r"$\partial f_n/\partial s$")
    elasticity, whole = s * scaled_n_s / scaled_n, 1 + q + l + l**2 * Q
    above, below = (1 + q + l * q**n) / whole, (n + 1) * l**2 * Q / whole
    proof.equal(elasticity - n, above, "more than for the damper alone")
    proof.equal(n + 1 - elasticity, below, "less than for the spring alone")
    proof.holds(above, ">", 0, "a quotient of positive terms")
    proof.holds(below, ">", 0, "a quotient of positive terms")
    proof.done(elasticity - n, above)


@result("F19-exponents")
def _exponents(proof: Proof) -> None:
    r"""Power law: dead weight at high velocity.

    At a given load, $\delta \propto V^{-1}$ and $\mu \propto V^{-(1 - 1/n)}$: $V^{-1/2}$ for the parabola
    (Eq. 46), nearly $V^{-1}$ for a flat punch with rounded edges, and no decrease for $n \to 1$. At low
    velocity $\mu \propto V$ for every $n$.
    """
    power = 1 - 1 / n
    proof.define(delta, W / (C * V), r"F19-high, $W = C V \delta$")
    proof.define(a, (n * L ** (n - 1) * delta) ** (1 / n), r"$h(a) = \delta$")
    proof.recall("F19-high", m_high)
    proof.define(mu, m_high * delta / a, "the asymptote for high velocity")
    result = HIGH_COEFFICIENT * n ** (-1 / n) * (W / (C * V * L)) ** power
    proof.equal(mu, result, "falls as a power of the velocity")


@result("F19-crossing-weight")
def _crossing(proof: Proof) -> None:
    r"""Power law: crossing of the asymptotes at a load.

    At a given load the asymptotes $\frac{\delta_0}{a_0} \lambda \frac{n (n + 1)}{2 n - 1}$ and
    $\frac{\delta}{a} \frac{n^2}{2 n - 1}$ meet at one velocity. For $n = 2$ and $\kappa = 0$ this is Eq.
    (48).
    """
    lifted = AT_REST * (1 + kappa) / lam
    proof.define(W_0, AT_REST * K * delta_0 * a_0, "the load at rest")
    proof.define(l_r, lam * a_0, "the retardation length")
    reason = r"$\delta/\delta_0$ where $(1 + \kappa) W_0 = C V \delta$"
    proof.equal((1 + kappa) * W_0 / (K * l_r * delta_0), lifted, reason)
    proof.define(n, 1 + excess, r"$n > 1$, that is, $\nu > 0$")
    proof.define(lam_cross, CROSSING, r"$V^{*} \tau/a_0$")
    proof.define(L_1, LOW_SLOPE * lam, "in units of $\\delta_0/a_0$")
    proof.define(L_2, HIGH_COEFFICIENT * lifted ** (1 - 1 / n), "likewise")
    ratio, drive = sp.log(L_2 / L_1), sp.log(lam_cross / lam)
    proof.equal(n * ratio, (2 * n - 1) * drive, "so they meet at $\\lambda = \\lambda^{*}$")
    proof.done(lam_cross, CROSSING)


@result("F19-at-load")
def _at_load(proof: Proof) -> None:
    """Power law: friction coefficient at a load.

    Under a dead weight, in units of the static state.
    """
    friction = sp.Symbol("varphi_n", positive=True)
    load = AT_REST / s ** (n + 1)
    proof.define(n, 1 + excess, "the exponent of the shape")
    proof.define(w_n, load, r"$s^{n + 1} w_n = \frac{2 n}{n + 1}$")
    proof.define(m_n, friction / w_n,
                 r"$\mu = (\delta/a)\, m_n$, in units of $\delta_0/a_0$: $s^{n - 1} m_n$")  # fmt: skip
    power = sp.log(friction) - 2 * n / (n + 1) * sp.log(w_n) + (n - 1) / (n + 1) * sp.log(AT_REST)
    proof.equal(sp.log(s ** (n - 1) * m_n), power, "the friction coefficient at a given load")
    proof.done(w_n, load)


@result("F19-slip")
def _slip(proof: Proof) -> None:
    r"""Power law: friction over velocity at a load.

    Under a dead weight $\mu$ rises with the velocity where $D_n > 0$ and falls where $D_n < 0$; $l$ grows
    with the velocity, because $d \ln \lambda/d \ln l = 1 + d \ln s/d \ln l > 1 - \frac{1}{n + 1}$.
    """
    proof.recall("F19-monotonic", w_l, phi_l, "F19-load", "F19-friction")
    rates = (n + 1) * w_n * phi_l - 2 * n * phi_n * w_l
    slip = n**3 * SLIP / (2 * n - 1)
    proof.equal(rates, slip, r"its logarithmic slope times $w_n \varphi_n$")
    proof.define(slip_n, SLIP, "an expression with its sign")


@result("F19-maximum")
def _maximum(proof: Proof) -> None:
    """Power law: one friction maximum under a dead weight.

    $T_n$ increases strictly with $q$ from a negative to a positive value, so that it has one root: for every
    $n > 1$ the friction coefficient of a dead weight has exactly one maximum over the velocity. For $n = 2$
    it is that of F3.
    """
    in_q(proof)
    peeled = 1 - q**n
    damped, double = 1 + q * Q**2, n + excess
    form = Q * (1 + q) + z / n - (2 * n - 1) * (z**2 + z**3 * Q / damped) / n**2
    proof.define(z, peeled, r"$z = n l Q$")
    proof.define(T_n, form, "in this variable")
    proof.recall("F19-slip")
    slip_scaled = slip_n * Q / damped
    proof.equal(slip_scaled, T_n, "the same sign as $D_n$")
    rest = excess**2 + n**2 * q * Q**2 + double * q**n * (1 + z + z**2)
    slope = excess * q ** (n - 2) * (q + rest / (n**2 * damped)) + double / n**2 * (
        2 * n * z * Q + 3 * n * z**2 * Q**2 / damped + double * z**3 * Q**3 / damped**2
    )
    proof.equal(sp.Derivative(T_n, q), slope, "slope")
    proof.holds(slope, ">", 0, r"with $\nu = n - 1$, each term")
    proof.crossing(form.subs({Q: SLOPE_POWER, z: peeled}), (q, 0, 1),
                   r"from $-\nu/n^2$ in the fast limit to 2 at rest", slope=slope)  # fmt: skip
    proof.done(slip_scaled, T_n)
