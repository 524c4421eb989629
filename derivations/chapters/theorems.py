r"""Steady sliding beyond the paper: exact closed forms, the peak pressure, the balance of forces.

One number determines the contact: ``q`` = x_TE/a in (0, 1), or l = l_r/a = (1 - q**2)/(2 q). Where several
forms of a quantity are proved equal, the last one is the form for floating-point numbers: no
difference of nearly equal numbers, no overflow.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .model import K, R, delta, x
from .steady import F, W, a, l, l_r, mu, p, q

xi, P, P_max, n, w, phi, m, s, r, f, f_s, f_ss, G, G_s, lam, kappa = symbols(r"""
    xi      \xi            1  scaled coordinate, $x/a$  prints \hat x  from F16  real
    P       \hat p         1  scaled pressure, $p/(K \delta)$  real
    P_max   \hat p_{\max}  1  maximum of the scaled pressure
    n       -              1  position of the greatest pressure ahead of the lowest line, over the half
            length  prints \hat n
    w       -              1  scaled load, $W/(K \delta a)$
    phi     \varphi        1  scaled friction force, $F R/(K \delta a^{2})$
    m       -              1  scaled friction coefficient, $\mu R/a$
    s_a     s              1  half length in units of the static one, $a/a_0 = \sqrt{d}$  prints \hat
            a  from scaled-load
    r       -              1  $\sqrt{\hat a^2 + \lambda^2}$  prints \hat r
    f       -              1  scaled load of an indenter that has been lifted, $W/W_0$  prints \hat f
    f_s     f'             1  -
    f_ss    f''            1  -
    G       -              1  excess of the supporting forces over the load, in units of the static
            load  real
    G_s     G'             1  -  real
    lambda  -              1  drive number, $V \tau/a_0$  from scaled-pressure
    kappa   -              1  support number, $k_s \delta_0/W_0$  nonnegative
""")

SECTION = "Exact steady sliding"

UNIT = (q, 0, 1)
"""The interval of q: from the fast limit (0) to rest (1)."""

NUMBER = (1 - q**2) / (2 * q)
"""l as a function of q."""

A = (1 - q) ** 2 + 2
"""q**2 - 2 q + 3, the quadratic of the load, as a sum of positive terms."""

B = q**2 - q + 4
"""The quadratic of the friction force."""

LOAD = (1 + q) ** 2 * A / (6 * q)
FRICTION_FORCE = (1 - q) * (1 + q) ** 2 * B / (12 * q)
FRICTION_COEFFICIENT = (1 - q) * B / (2 * A)
STABLE_FRICTION_FORCE = l * (1 + q) * B / 6
STABLE_FRICTION_COEFFICIENT = l * q * B / ((1 + q) * A)
PROFILE = 1 - xi**2 - 2 * l * xi
"""p/(K delta) at x = xi a."""
SCALED_LOAD = s**2 * (s + r + lam**2 / (r + lam)) / 2

result = Chapter(SECTION)


@result("F1")
def _rational(proof: Proof) -> None:
    r"""The steady state is rational in one number.

    For a parabola in steady sliding at $V > 0$, load, friction force and friction coefficient are rational
    functions of $q = x_{\mathrm{TE}}/a$.
    """
    proof.recall("scaling", l_r, "eq28", delta, "scaling")
    proof.sign(sp.Derivative(NUMBER, q), "<", 0, UNIT, "each $l > 0$ belongs to one $q$")
    proof.recall("pressure")
    positive = (x, 0, sp.oo)
    proof.root(p, x, q * a, "the pressure vanishes at the trailing edge", over=positive)
    factored = K * delta * (q - x / a) * (1 + q * x / a) / q
    proof.equal(p, factored, "so that it is positive between the edges")
    proof.recall("load", "friction", "eq37")
    for scaled, whole, unit, form, name in (
        (w, W, K * delta * a, LOAD, "load"),
        (phi, F, K * delta * a**2 / R, FRICTION_FORCE, "friction force"),
        (m, mu, a / R, FRICTION_COEFFICIENT, "friction coefficient"),
    ):
        proof.define(scaled, whole / unit, f"scaled {name}")
        proof.equal(scaled, form, f"{name}: rational")
        proof.equal(whole, scaled * unit, "in units of length and force")
    proof.done(m, FRICTION_COEFFICIENT)


@result("F16")
def _cancellation(proof: Proof) -> None:
    r"""Forms without cancellation.

    Eq. (27) as written loses digits for $l_{\mathrm{r}} \gg a$, and $1 - q$ loses them for $l_{\mathrm{r}}
    \ll a$. The last forms of $q$, $\varphi$, $m$ and $p$ lose none.
    """
    root = sp.sqrt(1 + l**2)
    proof.recall("scaling")
    proof.equal(root - l, q, "Eq. (27) as it stands")
    condition = "condition number of this subtraction"
    proof.equal((root + l) / (root - l), q**-2, condition)
    proof.leading_order(q**-2, 4 * l**2, q, 0, "which grows without bound", eps=1 / l)
    proof.equal(q, 1 / (l + root), "the same number without a subtraction")
    proof.equal((1 - q) * (1 + q), 2 * q * l, "which replaces the difference $1 - q$")
    proof.recall("F1", w, phi)
    proof.equal(phi, STABLE_FRICTION_FORCE, "all terms positive")
    proof.recall("F1")
    proof.equal(m, STABLE_FRICTION_COEFFICIENT, "all terms positive")
    proof.define(P, 1 - xi**2 - 2 * l * xi, r"$p/(K\delta)$ at $x = \xi a$")
    proof.equal(P, (q - xi) * (1 + q * xi) / q, "one difference, exact near the edge")
    proof.done(q, 1 / (l + root))


@result("F7")
def _peak_pressure(proof: Proof) -> None:
    r"""Peak pressure.

    The peak is inside the contact, at $x = -l_{\mathrm{r}}$, while $l_{\mathrm{r}} < a$, and at the leading
    edge from $l_{\mathrm{r}} = a$ on.
    """
    form = 2 * l + (1 - n) ** 2
    proof.recall("F16", (P, PROFILE))
    proof.greatest(1 + l**2, P, (xi, -l), r"at $\xi = -l$, inside the contact if $l < 1$",
                   surplus=(xi + l) ** 2)  # fmt: skip
    proof.greatest(2 * l, P, (xi, -1), "at the leading edge, else",
                   surplus=(1 + xi) * (xi - 1 + 2 * l), given=(xi >= -1, l > 1))  # fmt: skip
    proof.define(n, sp.Min(1, l), "place of the peak ahead of the lowest line, in half lengths")
    proof.define(P_max, form, "its height in one form")
    proof.equal(form, 1 + l**2, "inside the contact", cases=(l < 1,))
    proof.equal(form, 2 * l, "at the leading edge", cases=(l > 1,))
    proof.done(P_max, form)


@result("scaled-load")
def _scaled_load(proof: Proof) -> None:
    r"""Load of an indenter that has been lifted.

    In units of the static state, $s = a/a_0 = \sqrt{\delta/\delta_0}$, $\lambda = V\tau/a_0$ and $f = W/W_0$
    with $W_0 = \frac{4}{3} K a_0 \delta_0$.
    """
    radius = sp.sqrt(s**2 + lam**2)
    slope = 3 * s * (s + r) / 2
    proof.define(r, radius, "a shorthand")
    proof.define(l, lam / s, r"$l = V \tau/a$")
    proof.define(q, s / (lam + r), "trailing edge")
    proof.equal(1 / (l + sp.sqrt(1 + l**2)), q, "which is F16 in these units")
    proof.recall("F1", w)
    proof.define(f, 3 * s**3 * w / 4, r"$W = K \delta a w$")
    proof.equal(f, SCALED_LOAD, "a sum of positive terms")
    proof.define(f_s, sp.Derivative(SCALED_LOAD.subs(r, radius), s), "at fixed velocity")
    proof.equal(f_s, slope, "positive: a deeper indenter carries more")
    proof.define(f_ss, sp.Derivative(slope.subs(r, radius), s), "second derivative")
    proof.equal(f_ss, 3 * (r + s) ** 2 / (2 * r), "positive")
    proof.done(f, SCALED_LOAD)


@result("balance")
def _balance(proof: Proof) -> None:
    r"""Balance of forces of a movable indenter.

    On a spring of support number $\kappa$ (none for a dead weight, $\kappa \to \infty$ for a fixed indenter)
    $G = f + \kappa (s^2 - 1) - 1$ vanishes, once, between $s = 0$ and $s = 1$. There $s\,G' \ge 2 (1 +
    \kappa)$: the relative error of $\delta = s^2 \delta_0$ is, to first order, at most that with which the
    two sides of the balance are computed.
    """
    logarithmic = s * f_s / f
    proof.define(r, sp.sqrt(s**2 + lam**2), "a shorthand")
    proof.crossing(SCALED_LOAD + kappa * (s**2 - 1) - 1, (s, 0, sp.oo), "the depth is unique",
                   slope=3 * s * (s + r) / 2 + 2 * kappa * s)  # fmt: skip
    proof.define(lam, s * l, r"$l = V \tau/a$")
    proof.recall("scaling", "scaled-load", "scaled-load", f_s)
    proof.equal(logarithmic, 6 / A, "the dependence of the load on the depth")
    proof.sign(logarithmic, ">", 2, UNIT, "the damper alone")
    proof.sign(logarithmic, "<", 3, UNIT, "the spring alone")
    proof.sign(f / s**3, ">", 1, UNIT, "hence $G > 0$ at $s = 1$")
    proof.define(G, f + kappa * (s**2 - 1) - 1, "excess of the supporting forces")
    proof.define(G_s, f_s + 2 * kappa * s, r"$\partial G/\partial s$ at fixed velocity")
    conditioning = 2 * (1 + kappa) + 2 * G + (s * f_s - 2 * f)
    proof.equal(s * G_s, conditioning, "slope of the balance")
    proof.sign(s * f_s - 2 * f, ">", 0, UNIT, r"hence $s\,G' \ge 2 (1 + \kappa)$ at the root")
    proof.done(s * G_s, conditioning)
