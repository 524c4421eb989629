r"""Steady sliding of a power law h = |x|**n/(n L**(n - 1)), n > 1: theorem F19.

One number determines the contact: q = x_TE/a, or l = l_r/a = (1 - q**n)/(n q**(n - 1)). With Q = q**(n - 1)
load, friction force and the rest are sums of positive terms in l, q and Q, which neither cancel nor
overflow. They hold for n = 1 as well, the wedge, where q = max(0, 1 - l); `derivations.wedge` proves it.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .model import C, K, V, delta
from .steady import F, W, a, l, l_r, mu, q
from .theorems import P

(
    z_peeled, exponent, excess, L, Q, y, w_n, w_ahead, w_behind, phi_n, phi_ahead, phi_behind, m_n,
    eta_n, lost_ahead, lost_behind, P_n,
) = symbols(r"""
    peeled      z                 1  -
    n           -                 1  exponent of a power law  from F19-pressure
    nu          \nu               1  $n - 1$
    L           -                 m  length that gives the size of a shape
    Q           -                 1  $q^{n - 1}$
    y           -                 1  distance from the lowest line in half lengths, $|x|/a$
    w_n         -                 1  scaled load of a power law
    w_ahead     w_{\mathrm{a}}    1  part of the scaled load ahead of the lowest line
    w_behind    w_{\mathrm{b}}    1  part of the scaled load behind the lowest line  nonnegative
    phi_n       \varphi_n         1  scaled friction force of a power law
    phi_ahead   \varphi_{\mathrm{a}}  1  part of the scaled friction force ahead of the lowest line
    phi_behind  \varphi_{\mathrm{b}}  1  part of the scaled friction force behind the lowest
            line  nonnegative
    m_n         -                 1  scaled friction coefficient of a power law
    eta_n       -                 1  dissipated part inside the contact of a power law
    e_ahead     \eta_{\mathrm{a}}  1  dissipation ahead of the lowest line
    e_behind    \eta_{\mathrm{b}}  1  dissipation behind the lowest line  nonnegative
    P_n         \hat p_{\max,n}   1  maximum of the scaled pressure of a power law  real
""")  # fmt: skip

SECTION = "Power law and wedge"

n, z = exponent, z_peeled
NUMBER = (1 - q**n) / (n * q ** (n - 1))
"""l as a function of q."""
SLOPE_POWER = q ** (n - 1)
"""Q as a function of q."""
AHEAD, BEHIND = (1 - y**n + side * n * l * y ** (n - 1) for side in (1, -1))
"""p/(K delta) at x = -y a and at x = y a."""
SQUARES = (1 + q * Q**2) / (2 * n - 1)
"""The integral of (|x|/a)**(2 n - 2) over the contact: the damper's part of the friction force."""
LOAD = n * (1 + q + l + l**2 * Q) / (n + 1)
FRICTION_FORCE = n**2 * l * (SQUARES + l * Q**2 / 2)
FRICTION_COEFFICIENT = n * (n + 1) * l * (SQUARES + l * Q**2 / 2) / (1 + q + l + l**2 * Q)
LOW_SLOPE = n * (n + 1) / (2 * n - 1)
"""m/l at rest."""
HIGH_COEFFICIENT = n**2 / (2 * n - 1)
"""m for l -> oo."""

result = Chapter(SECTION)


def in_q(proof: Proof) -> None:
    """Let l and Q be functions of q and n = 1 + nu."""
    proof.recall("F19-edge", n, l, Q)


@result("F19-pressure")
def _pressure(proof: Proof) -> None:
    r"""Power law: pressure.

    The indenter $h = |x|^n/(n L^{n-1})$ with $n > 1$ has the slope 1 at $x = L$; $n = 2$ is the parabola of
    radius $L$. Here $l = l_{\mathrm{r}}/a$, and $y = |x|/a$ is the distance from the tip.
    """
    height, slope = (y * a) ** n / (n * L ** (n - 1)), (y * a / L) ** (n - 1)
    proof.define(delta, a**n / (n * L ** (n - 1)), r"$h(a) = \delta$: the half length at rest")
    proof.recall("eq29", C)
    proof.define(l_r, l * a, "the retardation length over the half length")
    for side, form, where in ((1, AHEAD, "-y a"), (-1, BEHIND, "y a")):
        pressure = K * (delta - height) + side * C * V * slope
        reason = rf"$(K (\delta - h) - C V h')/(K \delta)$ at $x = {where}$"
        proof.equal(pressure / (K * delta), form, reason)
    proof.define(P, BEHIND, "behind the tip, with $y = x/a$")
    proof.equal(sp.Derivative(BEHIND, y), -n * y ** (n - 2) * (y + (n - 1) * l), "it falls there")
    proof.done(P, BEHIND)


@result("F19-edge")
def _edge(proof: Proof) -> None:
    r"""Power law: trailing edge.

    The pressure falls from the tip to $x = a$, where it is not positive; it vanishes once between, at
    $x_{\mathrm{TE}} = q a$. In the variable $\ln q$ the equation $(n - 1) \ln q + \ln(q + n l) = 0$ is
    increasing and convex, so that Newton's method descends to its root from every point above.
    """
    proof.define(n, 1 + excess, r"$n > 1$, that is, $\nu > 0$")
    proof.recall("F19-pressure")
    proof.define(l, NUMBER, "$l$ for an edge at $y = q$")
    proof.equal(sp.Subs(P, y, q), sp.S.Zero, "no pressure there")
    proof.equal(sp.Derivative(l, q), -(n - 1 + q**n) / (n * q**n), "slope")
    falling = (excess + q**n) / (n * q**n)
    proof.holds(falling, ">", 0, r"$l$ falls strictly: each $l > 0$ has one $q$")
    proof.equal(sp.Subs(l, q, 1), sp.S.Zero, r"at rest, and $l \to \infty$ for $q \to 0$")
    proof.define(Q, SLOPE_POWER, "the slope at the trailing edge over that at $x = a$")
    proof.equal(n * l * Q, 1 - q**n, "which replaces the difference $1 - q^n$")
    proof.equal(q, 1 / Q - n * l, "solved for $q$")
    proof.equal(1 / (q + n * l), Q, "one equation for $q$, without a difference")


@result("F19-load")
def _load(proof: Proof) -> None:
    """Power law: load.

    With $Q = q^{n-1}$ the forms in $l$, $q$ and $Q$ lose no digits in either limit.
    """
    in_q(proof)
    primitive = y - y ** (n + 1) / (n + 1)
    for name, pressure, side, end, where in (
        (w_ahead, AHEAD, 1, sp.S.One, "ahead of the tip"), (w_behind, BEHIND, -1, q, "behind it"),
    ):  # fmt: skip
        whole = primitive + side * l * y**n
        proof.integral(name, pressure, (y, 0, end), where, value=whole.subs(y, end))
    proof.define(w_n, w_ahead + w_behind, r"$W/(K \delta a)$")
    explicit = n / (n + 1) + q - q ** (n + 1) / (n + 1) + (1 - q**n) ** 2 / (n * q ** (n - 1))
    proof.equal(w_n, explicit, "as a function of $q$")
    proof.equal(w_n, LOAD, "a sum of positive terms")


@result("F19-friction")
def _friction(proof: Proof) -> None:
    """Power law: friction force.

    With $Q = q^{n-1}$ the forms in $l$, $q$ and $Q$ lose no digits in either limit.
    """
    in_q(proof)
    primitive = y**n - y ** (2 * n) / 2
    damper = n**2 * l * y ** (2 * n - 1) / (2 * n - 1)
    for name, pressure, side, end in ((phi_ahead, AHEAD, 1, sp.S.One), (phi_behind, BEHIND, -1, q)):
        integrand = sp.expand(n * y ** (n - 1) * pressure)
        where = (
            "a backward force ahead of the tip" if side == 1 else "and a forward force behind it"
        )
        whole = primitive + side * damper
        proof.integral(
            name, integrand, (y, 0, end), where, value=whole.subs(y, end), antiderivative=whole
        )
    proof.define(phi_n, phi_ahead - phi_behind, r"$F/(K \delta^2)$")
    explicit = (1 - q**n) ** 2 / 2
    explicit += n * (1 - q**n) * (1 + q ** (2 * n - 1)) / ((2 * n - 1) * q ** (n - 1))
    proof.equal(phi_n, explicit, "as a function of $q$")
    proof.equal(phi_n, FRICTION_FORCE, "a sum of positive terms")


@result("F19")
def _coefficient(proof: Proof) -> None:
    r"""Power law: friction coefficient.

    For $h = |x|^n/(n L^{n-1})$, $n > 1$, with $q = x_{\mathrm{TE}}/a$, $Q = q^{n-1}$ and $l =
    l_{\mathrm{r}}/a = (1 - q^n)/(n Q)$. For $n = 2$ this is F1.
    """
    proof.recall("F19-load", "F19-friction")
    proof.define(F, K * delta**2 * phi_n, "friction force")
    proof.define(W, K * delta * a * w_n, "load")
    proof.recall("eq37")
    proof.define(m_n, mu * a / delta, r"$\mu$ in units of $\delta/a$")
    proof.equal(m_n, phi_n / w_n, r"$\mu = F/W$")
    proof.equal(m_n, FRICTION_COEFFICIENT, "a quotient of positive terms")


@result("F19-peak")
def _peak_pressure(proof: Proof) -> None:
    r"""Power law: peak pressure.

    The peak is inside the contact, at $x = -(n - 1) l_{\mathrm{r}}$, while that is behind the leading edge,
    and at the leading edge from there on.
    """
    proof.define(n, 1 + excess, r"$n > 1$")
    slope = n * y ** (n - 2) * ((n - 1) * l - y)
    proof.equal(sp.Derivative(AHEAD, y), slope, r"zero at $y = (n - 1) l$")
    inside = 1 + l * ((n - 1) * l) ** (n - 1)
    form = 1 + y ** (n - 1) * (n * l - y)
    proof.equal(AHEAD, form, "the pressure ahead of the tip")
    proof.equal(form.subs(y, (n - 1) * l), inside, "inside the contact")
    proof.equal(sp.Subs(form, y, 1), n * l, "at the leading edge")
    proof.define(y, sp.Min(1, (n - 1) * l), "where the peak is")
    proof.define(P_n, form, "both cases in one form")


@result("F19-energy")
def _energy(proof: Proof) -> None:
    r"""Power law: energy dissipated inside the contact.

    Of the power $F V$ the fraction $\eta$ is dissipated inside the contact, the rest in the surface that
    relaxes behind it. It is 1 in both limits.
    """
    inside = lost_ahead, lost_behind
    proof.define(n, 1 + excess, r"$n > 1$")
    proof.define(Q, SLOPE_POWER, "a shorthand")
    density = n**2 * l * y ** (2 * n - 2)
    for name, end, where in zip(
        inside, (1, q), (r"$K l_{\mathrm{r}} h'^2$, ahead of the tip", "behind it"), strict=True
    ):
        proof.integral(name, density, (y, 0, end), where, antiderivative=density * y / (2 * n - 1))
    form = 2 * (1 + q * Q**2) / (2 * (1 + q * Q**2) + (2 * n - 1) * l * Q**2)
    proof.define(eta_n, (lost_ahead + lost_behind) / phi_n, "by definition")
    proof.recall("F19-friction")
    proof.equal(eta_n, form, "fraction inside")
