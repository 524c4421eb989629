r"""Steady sliding of a parabola on any linear viscoelastic foundation: theorem F17.

Everything is linear in the relaxation function, so that one arm is enough, which relaxes as exp(-X/l) over
the distance X. A spring is an arm with l -> oo, a Prony series a sum of arms; a springpot, like every
relaxation function that is completely monotone, is an integral over arms (Bernstein). Lengths are scaled by
the length of the contact.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .steady import a, l, q
from .theorems import phi as scaled_friction
from .theorems import w as scaled_load

(
    contact_length, arm_number, place, passed, half_share, arm_pressure, from_trailing,
    moment_ahead, moment_behind, moment_bulge, moment_twist, moment_mean, moment_slant,
    excess_share, arm_load, arm_work, arm_lost, edge_pressure,
) = symbols(r"""
    c_v    \breve c     m  length of the contact
    z_v    \breve z     1  length of the contact over that of an arm, $\breve c/l_i$
    x_v    \breve x     1  distance from the leading edge over the length of the contact
    s_v    \breve s     1  as $\breve x$, of an earlier position  real
    a_v    \breve a     1  half length at rest over the length of the contact
    p_v    \breve p     1  pressure of an arm, in units of $K_i \breve c^2/R$  real
    w_v    \breve w     1  distance from the trailing edge over the length of the contact
    P_v    \breve P     1  moment of the relaxation function, of weight $1 - \breve w$
    Q_v    \breve Q     1  moment of weight $\breve w$
    D_v    \breve D     1  moment of weight $\breve w (1 - \breve w)/2$
    E_v    \breve E     1  moment of weight $(1 - 3 \breve w + 2 \breve w^3)/12$  real
    A_v    \breve A     1  mean of the relaxation function, $\breve P + \breve Q$
    B_v    \breve B     1  $(\breve P - \breve Q)/2$
    eta_v  \breve \eta  1  $\breve a - \frac{1}{2}$
    W_v    \breve W     1  load of an arm, in units of $K_i \breve c^3/R$
    F_v    \breve F     1  friction force of an arm, in units of $K_i \breve c^4/R^2$  real
    L_v    \breve L     1  part of $\breve F$ that is lost in the contact  real
    p_ve   \breve p_e   1  $\breve p$ at the trailing edge  real
""")  # fmt: skip
springs = symbols(r"""
    p_vk  \breve p_k  1  pressure of a spring at the trailing edge, in units of $K \breve c^2/R$
    W_vk  \breve W_k  1  load of a spring, in units of $K \breve c^3/R$
    F_vk  \breve F_k  1  friction force of a spring, in units of $K \breve c^4/R^2$
""")
dashpots = symbols(r"""
    p_vc  \breve p_c  1  pressure of a dashpot there, in the same units, over $\breve \zeta$  real
    W_vc  \breve W_c  1  load of a dashpot, likewise
    F_vc  \breve F_c  1  friction force of a dashpot, likewise
""")
voigt_load, voigt_work = symbols(r"""
    W_v0  \breve W_0  1  load on Kelvin–Voigt, in units of $K \breve c^3/R$
    F_v0  \breve F_0  1  friction force on Kelvin–Voigt, in units of $K \breve c^4/R^2$
""")
ratio_first, ratio_second, spring_share, springpot = symbols(r"""
    t_v0    \breve t_0    1  ratio of two modified spherical Bessel functions
    t_v1    \breve t_1    1  ratio of the next two modified spherical Bessel functions
    nu_v    \breve \nu    1  1 less the order of a springpot
    zeta_v  \breve \zeta  1  stiffness of springpot or arm over the spring's
    -       \Gamma        1  Gamma function  from constant
""")

SECTION = "Any linear viscoelastic foundation"

z, y, s, w, b, e, c, nu = (
    arm_number, place, passed, from_trailing, half_share, excess_share, contact_length,
    spring_share,
)  # fmt: skip
FALL = sp.exp(-z)
P, Q, A, B = moment_ahead, moment_behind, moment_mean, moment_slant
D, E = moment_bulge, moment_twist
MOMENTS = {
    P: (1 - w, (z - 1 + FALL) / z**2),
    Q: (w, (1 - (1 + z) * FALL) / z**2),
    D: (w * (1 - w) / 2, (z - 2 + (z + 2) * FALL) / (2 * z**3)),
    E: (
        (1 - 3 * w + 2 * w**3) / 12,
        (z**3 - 3 * z**2 + 12 - 3 * (z**2 + 4 * z + 4) * FALL) / (12 * z**4),
    ),
}
"""Each moment of exp(-z w): its weight, and its value."""
PRESSURE = (b * z - z * y + 1 - (b * z + 1) * sp.exp(-z * y)) / z**2
LOAD = D + e * P
WORK = E + e**2 * P
LOST = E - B**2 / 2 + e * (A * B + e * (B + A * z * P / 2))
OF_ARM = (springs[2] + springpot * arm_work) / (springs[1] + springpot * arm_load)
"""The friction coefficient of a spring and one arm, over c/R."""
UNIT = (w, 0, 1)
half, twelfth = sp.Rational(1, 2), sp.Rational(1, 12)

result = Chapter(SECTION)


@result("F17-pressure")
def _pressure(proof: Proof) -> None:
    r"""Any relaxation function: pressure of an arm.

    An element at the distance $X$ behind the leading edge is compressed by $u$, $R u' = a - X$; a foundation
    with the relaxation function $G(t)$ exerts the pressure $p = \int G((X - X')/V)\, u'\, dX'$. This is
    linear in $G$. One arm is $G = K_i e^{-X/l_i}$, $l_i = V \tau_i$; its pressure is $\breve p$ in units of
    $K_i \breve c^2/R$, where $\breve c$ is the length of the contact, $\breve z = \breve c/l_i$, $\breve x =
    X/\breve c$ and $\breve a = a/\breve c$.
    """
    integrand = sp.exp(-z * (y - s)) * (b - s)
    reason = r"$\int G\,\dot u\,dt$ of one arm, with $R u' = a - X$ in the contact"
    proof.integral(arm_pressure, integrand, (s, 0, y), reason, value=PRESSURE)
    slope = sp.Derivative(arm_pressure, y)
    proof.equal(slope, b - y - z * arm_pressure, "the arm is strained by $a - X$, and relaxes")
    proof.done(arm_pressure, PRESSURE)


@result("F17-moments")
def _moments(proof: Proof) -> None:
    r"""Any relaxation function: four moments.

    The moments weight the memory of an arm at the trailing edge, at the distance $\breve w \breve c$ ahead of
    it. The weights of the first three are positive; that of the last has no mean and changes its sign, but by
    parts its moment is that of a positive weight. For any $G$ that falls F17-sign shows the same.
    """
    for name, (weight, form) in MOMENTS.items():
        integrand = weight * sp.exp(-z * w)
        proof.integral(name, integrand, UNIT, "a moment of $e^{-\\breve z \\breve w}$", value=form)
    positive = z * w * (1 - w) ** 2 * (2 + w) / 24 * sp.exp(-z * w)
    by_parts = sp.Integral(positive, UNIT)
    proof.integral(by_parts, positive, UNIT, "the last one, by parts", value=E)
    proof.holds(by_parts, ">=", 0, r"so $\breve E$ is not negative")
    proof.define(A, P + Q, "its mean")
    proof.define(B, (P - Q) / 2, "half of its slant")
    proof.equal(A, (1 - FALL) / z, "mean")
    proof.equal(B, z * D, "one moment gives another")
    proof.equal(1 - A, z * P, "which replaces the difference")
    proof.done(A, P + Q)


def from_moments(proof: Proof) -> None:
    """Let the moments stand for their values, and a/c for 1/2 + e."""
    proof.recall("F17-moments", *MOMENTS, "F17-moments", "F17-moments", (B, (P - Q) / 2))
    proof.define(b, half + e, "the half length, by its excess over half of the contact")


def under_pressure(proof: Proof) -> None:
    """Let the pressure of an arm stand for its value too."""
    from_moments(proof)
    proof.recall("F17-pressure")


@result("F17-edge")
def _edge(proof: Proof) -> None:
    r"""Any relaxation function: trailing edge.

    All arms and the spring together have no pressure there: $a = \breve c \sum K_i \breve P/\sum K_i \breve
    A$ and $x_{\mathrm{TE}} = \breve c \sum K_i \breve Q/\sum K_i \breve A$, with the moments of each arm. The
    length of the contact therefore determines the half length at rest. The slope of the pressure, $R p' = a G
    - \int_0^X G$, falls where $G$ does, so that $p$ is concave and vanishes once.
    """
    under_pressure(proof)
    proof.define(edge_pressure, sp.Subs(arm_pressure, y, 1), "its pressure at the trailing edge")
    proof.equal(edge_pressure, b * A - P, "in terms of the moments")
    proof.equal(edge_pressure, e * A - B, "and by the excess over half of the contact")


@result("F17-load")
def _load(proof: Proof) -> None:
    r"""Any relaxation function: load.

    Of one arm, in units of $K_i \breve c^3/R$. So $W = (\breve c^3/R) \sum K_i (\breve D + \breve \eta \breve
    P)$, a sum of positive terms.
    """
    under_pressure(proof)
    proof.integral(arm_load, arm_pressure, (y, 0, 1), "the integral of the pressure", value=LOAD)


@result("F17")
def _work(proof: Proof) -> None:
    r"""Any relaxation function: friction force.

    Of one arm, in units of $K_i \breve c^4/R^2$. So $F = (\breve c^4/R^2) \sum K_i (\breve E + \breve \eta^2
    \breve P)$: friction is positive where $G$ falls and is convex, and no sum cancels.
    """
    under_pressure(proof)
    proof.integral(arm_work, arm_pressure * (b - y), (y, 0, 1), "the integral of $u' p$",
                   value=WORK)  # fmt: skip


@result("F17-energy")
def _energy(proof: Proof) -> None:
    r"""Any relaxation function: energy.

    What is stored in the springs at the trailing edge, $\breve p(1)^2/2$, is lost while the surface relaxes
    behind the contact.
    """
    under_pressure(proof)
    stored = sp.Derivative(arm_pressure**2, y) / 2
    work = arm_pressure * (b - y)
    proof.equal(work, stored + z * arm_pressure**2, "stored in the spring of the arm, or lost")
    proof.integral(arm_lost, z * arm_pressure**2, (y, 0, 1), "lost in the contact", value=LOST)
    proof.equal(arm_lost + (e * A - B) ** 2 / 2, WORK, "and what is stored where it ends")
    proof.done(arm_lost, LOST)


@result("F17-arm")
def _forms(proof: Proof) -> None:
    r"""Any relaxation function: an arm without cancellation.

    $\breve t_0 = 1/(3 + (\breve z/2)^2 \breve t_1)$ begins Gauss's continued fraction of $\coth$, which
    continues with 5, 7 and so on, all positive; ten terms give full double precision for $\breve z \le 4$.
    """
    from_moments(proof)
    x = z / 2
    hyperbolic = (1 + FALL) / (1 - FALL)
    proof.define(
        ratio_first, (hyperbolic - 1 / x) / x, r"$(\coth(\breve z/2) - 2/\breve z)\, 2/\breve z$"
    )
    proof.define(ratio_second, (1 / ratio_first - 3) / x**2, "the next of the continued fraction")
    t_0, t_1 = ratio_first, ratio_second
    proof.equal(P, A * (1 + x * t_0) / 2, "all terms positive")
    proof.equal(Q, A * (1 - x * t_0) / 2, r"$\breve z \breve t_0/2$ is below 1")
    proof.equal(1 - x * t_0, 1 / x - 2 * FALL / (1 - FALL), r"for $\breve z > 4$")
    proof.equal(D, A * t_0 / 4, "all terms positive")
    proof.equal(E, A * t_0 * x * (1 + t_1 * (1 + x)) / 24, "all terms positive")


@result("F17-springpot")
def _springpot(proof: Proof) -> None:
    r"""Fractional Kelvin–Voigt: moments.

    For $G = K (1 + \breve \zeta \breve w^{\breve \nu - 1}/\Gamma(\breve \nu))$, $\breve \zeta = (V
    \tau/\breve c)^{1 - \breve \nu}$, of the order $1 - \breve \nu$ between 0 and 1. The moments are divided
    by $\Gamma(\breve \nu)$; for $\breve \nu \to 0$ they are then those of a dashpot, 1, 0, 0 and 1/12.
    """
    fade = w ** (nu - 1)
    for name, (weight, _) in MOMENTS.items():
        integrand = sp.powsimp(sp.expand(fade * weight))
        proof.integral(name, integrand, UNIT, "a moment", value=SPRINGPOT[name])


SPRINGPOT = {
    P: 1 / (nu * (1 + nu)),
    Q: 1 / (1 + nu),
    D: 1 / (2 * (1 + nu) * (2 + nu)),
    E: (1 - nu) / (4 * nu * (1 + nu) * (3 + nu)),
}


@result("F17-limits")
def _one_arm(proof: Proof) -> None:
    r"""Any relaxation function: an arm that is long or short.

    An arm much longer than the contact is a spring, for $\breve z \to 0$, and one much shorter a dashpot, for
    $\breve z \to \infty$.
    """
    proof.where(e < half, r"$x_{\mathrm{TE}} > 0$")
    proof.recall("F17-edge")
    under_pressure(proof)
    proof.recall("F17-load", "F17")
    near, far = (
        {"variable": z, "point": 0, "eps": z},
        {"variable": z, "point": sp.oo, "eps": 1 / z},
    )
    for whole, spring, dashpot, what in (
        (edge_pressure, e, e - half, "pressure at the trailing edge"),
        (arm_load, twelfth + e / 2, e, "load"),
        (arm_work, e**2 / 2, twelfth + e**2, "friction force"),
    ):
        proof.leading_order(whole, spring, reason=f"{what} of a spring", **near)
        proof.leading_order(z * whole, dashpot, reason="and of a dashpot", **far)


def _spring(proof: Proof) -> tuple[sp.Symbol, ...]:
    """Recall the pressure at the trailing edge, the load and the friction force of a spring."""
    for whole, name in zip((edge_pressure, arm_load, arm_work), springs, strict=True):
        proof.asymptote("F17-limits", whole, name, "of a spring")
    return springs


@result("F17-kelvin-voigt")
def _kelvin_voigt(proof: Proof) -> None:
    r"""Any relaxation function: Kelvin–Voigt.

    A spring in parallel with a dashpot, with $\breve \zeta = l_{\mathrm{r}}/\breve c$, gives the steady state
    of F1.
    """
    lam = springpot
    edge, load, work = _spring(proof)
    for whole, name in zip((edge_pressure, arm_load, arm_work), dashpots, strict=True):
        proof.asymptote("F17-limits", z * whole, name, "of a dashpot")
    edge_d, load_d, work_d = dashpots
    proof.define(e, lam / (2 * (1 + lam)), "the excess over half a contact, as there is")
    proof.equal(edge + lam * edge_d, sp.S.Zero, "no pressure at the trailing edge")
    product = lam * (half + lam) / (2 * (1 + lam))
    proof.define(voigt_load, load + lam * load_d, "both loads")
    proof.equal(voigt_load, twelfth + product, "the load")
    proof.define(voigt_work, work + lam * work_d, "both friction forces")
    proof.equal(voigt_work, lam / 12 + product * lam / (2 * (1 + lam)), "the friction force")
    proof.define(a, c * (half + e), "the half length")
    proof.recall("scaling")
    proof.define(q, (c - a) / a, r"$x_{\mathrm{TE}}/a$")
    proof.equal(l, lam * c / a, r"$l_{\mathrm{r}}/a$")
    proof.recall("F1", scaled_load, scaled_friction)
    proof.equal(voigt_load * c**3 / (a**3 / 2), scaled_load, r"$W/(K \delta a)$ of F1")
    proof.equal(voigt_work * c**4 / (a**4 / 2), scaled_friction, r"$F R/(K \delta a^2)$ of F1")


def _spring_and_arm(proof: Proof) -> None:
    """Let a spring and one arm have no pressure together where the contact ends."""
    from_moments(proof)
    edge, *_ = _spring(proof)
    proof.recall("F17-edge")
    proof.define(
        e, springpot * B / (1 + springpot * A), "the excess over half a contact, as there is"
    )
    proof.equal(edge + springpot * edge_pressure, sp.S.Zero, "no pressure at the trailing edge")
    proof.recall("F17-load", "F17")


@result("F18-low")
def _slow(proof: Proof) -> None:
    r"""Any relaxation function: low velocity.

    Of a spring and one arm, with $\breve \zeta = K_i/K$: $\mu \to V (K_i/K) \tau_i/R$.

    Argued: To this order arms add up: $\mu \to C V/(K R)$ with $C = \int (G - K) \, dt = \sum K_i
    \tau_i$, which is Eq. (42). At low velocity every foundation with a finite $C$ is Kelvin–Voigt.
    """
    _spring_and_arm(proof)
    proof.leading_order(OF_ARM, springpot / z, z, sp.oo, r"$\mu R/\breve c$")


@result("F18-high")
def _fast(proof: Proof) -> None:
    r"""Any relaxation function: high velocity.

    Of a spring and one arm, with $\breve c \to 2 a$: $\mu \to \frac{2}{5} \frac{a^2}{R V}
    \frac{-G'(0)}{G(0)}$, as $G(0) = K (1 + \breve \zeta)$ and $-G'(0) = K \breve \zeta/\tau_i$; for
    several arms see F18-glassy. The half length is that of the stiffness $G(0)$. So friction has a
    maximum even at a fixed depth, and Eqs. (45) and (46) hold only in a window, in which most of the arms
    have relaxed and the fastest have not.
    """
    _spring_and_arm(proof)
    proof.leading_order(e, springpot * z / (12 * (1 + springpot)), z, 0, r"so $\breve c \to 2 a$")
    high = springpot * z / (10 * (1 + springpot))
    proof.leading_order(OF_ARM, high, z, 0, r"$\mu R/\breve c$")
