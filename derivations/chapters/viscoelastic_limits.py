r"""Distance of a foundation from its limits: proved bounds for V -> 0 and V -> oo, and the springpot (F18).

A bound uses two numbers of the relaxation function: for low velocity its integral C = int (G - K) dt and
the mean time int t (G - K) dt/C; for high velocity -G'(0)/G(0) and G''(0)/G'(0).
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof, tex
from .asymptote_errors import e_l2_fixed, e_l2_weight
from .model import F_x, F_z, K, R
from .relaxation import (
    FALLS, WEIGHTS, by_fall, fading, memory, other_trailing, spare_1, spare_2, spring_1, spring_2,
)  # fmt: skip
from .relaxation import y as back
from .steady import a, l, q
from .theorems import UNIT as RATIOS
from .theorems import m
from .theorems import w as w_steady
from .viscoelastic import (
    OF_ARM, SECTION, SPRINGPOT, UNIT, A, B, D, E, P, Q, contact_length, excess_share, half,
    half_share, spring_share, springpot, twelfth, w, z,
)  # fmt: skip

spare_3, spare_4, reach, delay = symbols(r"""
    omega_v3   \breve \omega_3   1  remainder of a third bound  nonnegative
    omega_v4   \breve \omega_4   1  remainder of a fourth bound  nonnegative
    lambda_v   \breve \lambda    1  distance ahead of the contact over its length
    epsilon_v  \breve \varepsilon  1  mean relaxation length over the length of the contact
""")
(
    *rates, voigt_half, spring_number, voigt_error, lack_mean, lack_ahead, lack_bulge, lack_twist,
    steepness, steepest, limit, haste, load_number, friction_number,
) = symbols(r"""
    r_1       -                1/s  rate of an arm  from scene
    r_2       -                1/s  rate of another arm  from scene
    a_v0      \breve a_0       m    half length on the Kelvin–Voigt foundation
    -         \bar t           s  mean relaxation time, $\int t (G - K)\,dt/C$
    -         \mu_0            1  friction coefficient on the Kelvin–Voigt foundation with the same $C$
    kappa_v   \breve \kappa    1  $K \breve c/(C V)$
    e_v       \breve e         1  bound of the relative error of Kelvin–Voigt
    alpha_vA  \breve \alpha_A  1  difference of a dashpot's $\breve A$ and this one  nonnegative
    alpha_vP  \breve \alpha_P  1  difference of a dashpot's $\breve P$ and this one  nonnegative
    alpha_vD  \breve \alpha_D  1  difference of $\breve D$ and that of a dashpot  nonnegative
    alpha_vE  \breve \alpha_E  1  difference of a dashpot's $\breve E$ and this one  nonnegative
    chi_v     \breve \chi      1  $C/(K \bar t)$, or $1/\breve \nu - 1$
    gamma_v   \breve \gamma    1  $-\breve c\, G'(0)/(V G(0))$
    m_vg      \breve m_{\infty}  1  limit of $\mu R/\breve c$ for high velocity
    omega_v   \breve \omega    1  $-\breve c\, G''(0)/(V G'(0))$
    Lambda_v  \breve \Lambda   1  load on spring and springpot, in units of $K \breve c^3/R$
    m_v       \breve m         1  $\mu R/\breve c$
""")  # fmt: skip
slowing = function("C_v", "how fast the fall slows", "N/m³", printed=r"\breve C", nonnegative=True)
weight_at = function("k_v", "any weight", printed=r"\breve k", nonnegative=True)

quarter = sp.Rational(1, 4)
kap, eps, nu = spring_number, delay, spring_share
LACKS = (
    (lack_ahead, eps, 1, spare_1), (lack_mean, lack_ahead, 1, spare_2), (lack_twist, eps, quarter, spare_3),
    (lack_bulge, eps, half, spare_4),
)  # fmt: skip
"""Differences of moments, what bounds them, and the letters that say how much less they are."""
SMALL = sp.Rational(1, 20)
"""Largest ratio of the mean relaxation length to the contact length."""
VOIGT = 7
"""Relative error of Kelvin–Voigt, over that number."""
HASTE = sp.Rational(1, 5)
MOST, SLOWED = {E: sp.Rational(1, 120), B: twelfth}, sp.Rational(1, 288)
"""Of a fall that does not slow; and how much less, for each part by which it slows over the contact."""
GLASSY = 2
"""The same for the glassy limit, over the length of the contact by that of the fastest arms."""
IN_CONTACT, _SLOWED = (back, 0, contact_length), sp.Integral(w * FALLS[E], UNIT)

result = Chapter(SECTION)


@result("F18-lacks")
def _lacks(proof: Proof) -> None:
    r"""Low velocity: moments near those of a dashpot.

    Let $\breve \zeta = C V/(K \breve c)$, and $\breve \varepsilon = V \bar t/\breve c$ with the mean
    relaxation time $\bar t = \int t\, (G - K)\, dt/C$, which is $\sum K_i \tau_i^2/\sum K_i \tau_i$.
    Without the spring, and over $\breve \zeta$, the moments $\breve A$, $\breve P$, $\breve D$ and
    $\breve E$ of F17-moments are $1 - \breve \alpha_A$, $1 - \breve \alpha_P$, $\breve \alpha_D$ and
    $\frac{1}{12} - \breve \alpha_E$; for a dashpot all four differences are 0. They are integrals of
    $\breve k = (G - K)/(K \breve \zeta) \ge 0$ over all $\breve w > 0$, with weights that are 1, 1, 0 and
    $\frac{1}{12}$ beyond the contact, $\breve w = 1$; here to any distance $\breve \lambda$ beyond it.
    """

    def felt(near: sp.Expr, far: sp.Expr | int) -> sp.Expr:
        """Add up the memory within the contact and ahead of it, where it is not zero."""
        over = (near, UNIT), (far, (w, 1, 1 + reach))
        return sum(sp.Integral(weight * weight_at(w), part) for weight, part in over if weight != 0)

    weights = {
        lack_mean: (0, 1), lack_ahead: (1 - WEIGHTS[P], 1), lack_bulge: (WEIGHTS[D], 0),
        lack_twist: (twelfth - WEIGHTS[E], twelfth), eps: (w, w),
    }  # fmt: skip
    for name, weight in weights.items():
        proof.define(name, felt(*weight), "within the contact and ahead of it")
    for small, bound, factor, spare in LACKS:
        pairs = zip(weights[bound], weights[small], strict=True)
        less = felt(*(sp.expand(factor * one - other) for one, other in pairs))
        proof.equal(factor * bound - small, less, "the difference")
        proof.holds(less, ">=", 0, "no weight is negative")
        proof.where(small > 0, "as for every arm; of a dashpot it is 0")
        proof.define(spare, less / small, "how much less")
        proof.equal(small, factor * bound / (1 + spare), "so")


@result("F18-voigt")
def _voigt(proof: Proof) -> None:
    r"""Low velocity: distance from Kelvin–Voigt.

    Let $\mu_0$ be the friction coefficient of the Kelvin–Voigt foundation with the same $K$ and $C$, on
    the same support at the same velocity. Then $|\mu/\mu_0 - 1| \le 7 \breve \varepsilon$ for $\breve
    \varepsilon = V \bar t/\breve c \le \frac{1}{20}$, whatever $G$, the support and $V \tau/a$ are. The
    steps, in units of $K \breve \zeta$ with $\breve \kappa = 1/\breve \zeta$, compare both foundations at
    one $\breve c$. There $a$ is between $1 - \breve \varepsilon$ and 1 times $\breve a_0$ of Kelvin–Voigt,
    the load between $(1 - \breve \varepsilon)(1 - 2 \breve \varepsilon)$ and $1 + 9 \breve \varepsilon/8$
    times, and $\mu$ between $(1 - 5 \breve \varepsilon)/(1 + 9 \breve \varepsilon/8)$ and $1/((1 - \breve
    \varepsilon)^2 (1 - 2 \breve \varepsilon))$ times.

    Argued: Then the contact on Kelvin–Voigt changes to the one on its own support. At a given velocity $W
    + k_s \delta$ grows at least as $a^2$, and $\mu_0$ with $a$ at most in proportion, so that the factor
    of $\mu_0$ is at most the root of that of the load. With the error of Eq. (42) on Kelvin–Voigt
    (error-L1) this bounds that of Eq. (42) on every foundation.
    """
    other = {a: voigt_half}  # at the same length of the contact, half lengths at rest differ
    proof.recall("F1", w_steady, m, at=other)
    proof.recall("scaling", l, at=other)
    for slope, relation, what in (
        (m, "<", r"$\mu_0 R/a$ grows with $l$"),
        (m / l, ">", "but less than in proportion"),
        (w_steady / l, ">", r"and $W$ grows faster than $a^2$ at a given velocity"),
    ):
        proof.sign(sp.Derivative(slope, q), relation, 0, RATIOS, what)
    plain_mean, plain_ahead = kap + 1, kap / 2 + 1
    product = plain_ahead / (2 * plain_mean)  # of the excess and the moment P on Kelvin–Voigt
    load, work = kap / 12 + product, twelfth + product / (2 * plain_mean)
    proof.define(q, kap / (kap + 2), r"$x_{\mathrm{TE}}/a$ on Kelvin–Voigt")
    proof.equal(l / (1 + q), 1 / kap, r"$\breve \zeta$, with $\breve c = a (1 + q)$")
    proof.equal(kap * w_steady / (2 * (1 + q) ** 3), load, "load of Kelvin–Voigt, in these units")
    proof.equal(kap * w_steady * m / (2 * (1 + q) ** 4), work, "and its friction force")
    proof.recall("F18-lacks", *(small for small, *_ in LACKS))
    mean, ahead = kap + 1 - lack_mean, kap / 2 + 1 - lack_ahead
    slant, twist = half - lack_ahead + lack_mean / 2, twelfth - lack_twist
    for low, value, high, what in (
        ((1 - eps) * plain_ahead, ahead, plain_ahead, r"$\breve P$"),
        ((1 - eps) * plain_mean, mean, plain_mean, r"$\breve A$"),
        ((half - eps), slant, half, r"$\breve B$"),
        ((1 - 3 * eps) * twelfth, twist, twelfth, r"$\breve E$"),
    ):  # fmt: skip
        proof.holds(value, ">=", low, f"{what}, with that of Kelvin–Voigt on the right")
        proof.holds(high, ">=", value, "and above")
    proof.holds(
        plain_ahead * mean, ">=", ahead * plain_mean, "so $a$ is at most as on Kelvin–Voigt"
    )
    proof.sign(load, ">", sp.Rational(4, 9), (kap, 0, sp.oo), "load of Kelvin–Voigt")
    most, less = kap / 12 + eps / 2, (1 - eps) * (1 - 2 * eps)
    proof.holds(most, ">=", kap / 12 + lack_bulge, r"$\breve D$, with the most on the left")
    proof.recall("F17-parts", excess_share, F_z, F_x)
    for name, form in {A: plain_mean, P: plain_ahead, B: half, D: most, E: twelfth}.items():
        proof.define(name, form, "as on Kelvin–Voigt" if name != D else "the most")
    proof.equal(F_z * R / contact_length**3, most + product, "load with these, which is no less")
    proof.holds((1 + 9 * eps / 8) * load, ">=", most + product, "the load, at most")
    proof.equal(F_x * R**2 / contact_length**4, work, "and the friction force")
    proof.where(eps < half, "slow enough")
    least = kap / 12 + less * product
    proof.holds(least, ">=", less * load, "and at least")
    proof.holds(
        work / ((1 - eps) * less * load), ">=", (twelfth + product / (2 * plain_mean * (1 - eps))) / least,
        r"$\mu$ at the same $\breve c$, at most",
    )  # fmt: skip
    proof.define(voigt_error, VOIGT * eps, "the bound")
    unit = (eps, 0, SMALL)
    lowest = (1 - 2 * eps) ** 2 * (1 - eps)
    proof.sign(
        lowest,
        ">",
        1 - 5 * eps,
        unit,
        r"on the left, over Kelvin–Voigt, the least $\breve \eta^2 \breve P$; $\breve E$ is closer",
    )
    proof.sign((1 - 5 * eps) ** 2 - (1 - voigt_error) ** 2 * (1 + 9 * eps / 8) ** 3, ">", 0, unit,
               r"$\mu/\mu_0 \ge (1 - 5 \breve \varepsilon)/(1 + 9 \breve \varepsilon/8)^{3/2}$")  # fmt: skip
    upper = (1 - eps) ** 5 * (1 - 2 * eps) ** 3 * (1 + voigt_error) ** 2
    proof.sign(upper, ">", 1, unit,
               r"and at most $1/\sqrt{(1 - \breve \varepsilon)^5 (1 - 2 \breve \varepsilon)^3}$")  # fmt: skip


@result("F18-window")
def _window(proof: Proof) -> None:
    r"""The window of the asymptotes for high velocity.

    With $l = V \tau/a$ and $\breve \chi = \tau/\bar t$, which is $\breve \beta$ for one arm, $\breve
    \varepsilon$ is below $l/\breve \chi$, because $\breve c > a$. The window is best at $l = \sqrt{2
    \breve \chi/21}$, where the bound is $4.3/\sqrt{\breve \chi}$. It opens slowly: for an error of 10 %
    by this bound an arm must be 1900 times as stiff as the spring.

    Argued: So the relative error of Eq. (45) is at most $(1 + \frac{2}{3 l})/(1 - 7 l/\breve \chi) - 1$
    upwards, and $7 l/\breve \chi$ downwards: it holds only for $1 \ll l \ll \breve \chi$.
    """
    proof.recall("F18-voigt", voigt_error)
    proof.define(eps, l / steepness, r"the most, as $\breve c > a$")
    best = sp.sqrt(2 * steepness / 21)
    both, least = 2 / (3 * l) + voigt_error, VOIGT / steepness * ((l - best) ** 2 / l + 2 * best)
    proof.equal(both, least, "both errors together, to first order")
    proof.recall("scaling", l, "error-L2-fixed", e_l2_fixed)
    proof.sign(e_l2_fixed, ">", 0, RATIOS, "Eq. (45) over Kelvin–Voigt, less 1")
    proof.sign(2 / (3 * l) - e_l2_fixed, ">", 0, RATIOS, r"it is below $2/(3 l)$ at every velocity")
    proof.done(both, least)


@result("F18-window-weight")
def _window_weight(proof: Proof) -> None:
    """The window under a dead weight.

    As Eq. (45) in F18-window, Eq. (46) has the error $1/l$ on Kelvin–Voigt; $a$ is that of the indenter
    that is lifted, and $l$ grows faster for it.
    """
    proof.recall("scaling", l, "F1", w_steady, m)
    square = (1 + e_l2_weight) ** 2
    proof.recall("error-L2-dead-weight", square)
    proof.sign(square, ">", 1, RATIOS, "Eq. (46) over Kelvin–Voigt, squared")
    proof.sign((1 + 1 / l) ** 2 - square, ">", 0, (q, 0, sp.Rational(2, 5)),
               r"$l > \frac{21}{20}$: its error is below $1/l$")  # fmt: skip


@result("F18-glass")
def _glass(proof: Proof) -> None:
    r"""High velocity: moments near those of a spring.

    In units of $G(0)$, with $\breve \gamma = -\breve c\, G'(0)/(V G(0))$ and $\breve \omega = -\breve c\,
    G''(0)/(V G'(0))$, that is $\breve c/V$ times $\sum K_i \tau_i^{-2}/\sum K_i \tau_i^{-1}$. As $G$ falls
    and is convex, and so is $-G'$ (a Prony series), $1 - \breve \gamma \breve w \le \breve G \le 1$ and
    $\breve \gamma (1 - \breve \omega \breve w) \le -\breve G' \le \breve \gamma$.
    """
    part, fall, slow = other_trailing, fading, slowing
    proof.define(memory(part).diff(part), -fall(part), r"$G$ falls, at the rate $\breve H$")
    proof.define(fall(part).diff(part), -slow(part), r"which slows, at the rate $\breve C$")
    over = (part, 0, w)
    rest = sp.Integral((w - part) * slow(part), over)
    proof.holds(rest, ">=", 0, r"$G$ is convex")
    proof.integral(rest, rest.function, over,
                   r"so $\breve G \ge \breve G(0) - \breve w \breve H(0)$",
                   value=memory(w) - memory(0) + w * fall(0),
                   antiderivative=memory(part) - (w - part) * fall(part))  # fmt: skip
    (r_1, r_2), glass = rates, K + spring_1 + spring_2
    first, second = spring_1 * r_1 + spring_2 * r_2, spring_1 * r_1**2 + spring_2 * r_2**2
    form = K * second + spring_1 * spring_2 * (r_1 - r_2) ** 2
    proof.equal(glass * second - first**2, form, "of Cauchy and Schwarz, with two arms")
    proof.holds(form, ">", 0, r"$\breve \omega > \breve \gamma$")
    for weight, value, what in (
        (WEIGHTS[A], half,
         r"$\breve A$ is less than its limit by at most $\breve \gamma$ times this"),
        (WEIGHTS[D], sp.Rational(1, 24), r"and $\breve D$ by at most $\breve \gamma$ times this"),
    ):  # fmt: skip
        whole = sp.Integral(w * weight, UNIT)
        proof.integral(whole, whole.function, UNIT, what, value=value)


@result("F18-fall")
def _fall(proof: Proof) -> None:
    r"""High velocity: moments of a fall that hardly slows.

    In the units of F18-glass, where the fall is at most $\breve \gamma$, and less by some $\breve k \ge
    0$; by at most $\breve \gamma \breve \omega \breve w$, which gives the last integral.
    """
    by_fall(proof, E, B)
    proof.define(fading(back), (steepest - weight_at(back)) / contact_length, "at most as at first")
    for name, value in MOST.items():
        most, less = _of_fall(name, 1), _of_fall(name, weight_at(back))
        proof.integral(most, most.function, IN_CONTACT, "at most", value=value)
        proof.equal(name, steepest * most - less, "a moment of the fall")
        proof.holds(less, ">=", 0, rf"so ${tex(name)}$ is at most $\breve \gamma$ times that")
    less = r"$\breve E$ is less by at most $\breve \gamma \breve \omega$ times this"
    proof.integral(_SLOWED, _SLOWED.function, UNIT, less, value=SLOWED)


def _of_fall(name: sp.Symbol, part: sp.Expr | int) -> sp.Integral:
    """Return a moment of a fall, over the length of the contact."""
    weight = sp.factor(FALLS[name].subs(w, back / contact_length) / contact_length)
    return sp.Integral(weight * part, IN_CONTACT)


@result("F18-glassy")
def _glassy(proof: Proof) -> None:
    r"""High velocity: distance from the glassy limit.

    The limit is $\mu_\infty = \frac{2}{5} \frac{a^2}{R V} \frac{-G'(0)}{G(0)}$ with the half length $a$
    on a spring of the stiffness $G(0)$ on the same support (F18-high). Then $|\mu/\mu_\infty - 1| \le 2
    \breve \omega$ for $\breve \omega \le \frac{1}{5}$, whatever $G$ and the support are.

    Argued: At one $\breve c$ the load is between $1 - \frac{\breve \omega}{2}$ and $1/(1 - \frac{\breve
    \omega}{2})$ times that of the spring of half length $\breve c/2$, and so is, on any support, $(2
    a/\breve c)^2$ of the spring that carries what is asked for, as $W + k_s \delta$ grows at least as
    $a^2$.
    """
    unit, o = (haste, 0, HASTE), haste
    part = 1 - o / 2
    share = sp.Rational(5, 12)
    lower, upper = (1 - share * o) * part**2, 1 + share * o / part**2
    longest = (1 + (o / 6) / part) * part
    twist, bulge = _of_fall(E, 1), _of_fall(B, 1)
    proof.recall("F18-fall", twist, bulge, _SLOWED)
    proof.asymptote("F18-high", OF_ARM, limit)
    proof.define(steepest, springpot * z / (1 + springpot), "of a spring and one arm")
    proof.equal(
        limit, steepest * twist / twelfth, r"$\mu_\infty R/\breve c$, with the greatest $\breve E$"
    )
    proof.where(o < HASTE, "fast enough")
    proof.equal(_SLOWED / twist, share, r"$\breve E$ is less by at most $\breve \omega$ times this")
    ratio = r"$\breve \eta^2 \breve P$ over $\breve E$, at most $\breve \gamma$ times this"
    proof.equal(bulge**2 / (2 * twist), share, ratio)
    proof.equal(longest, 1 - o / 3, r"greatest $2 \breve a$, times $1 - \breve \omega/2$")
    proof.sign(part - (1 - o / 3) ** 2, ">", 0, unit, "so its square is bounded as the load is")
    proof.sign(lower, ">", 1 - GLASSY * o, unit, r"$\mu$ over its limit is at least this")
    proof.sign((1 + GLASSY * o) * part**2 - upper, ">", 0, unit,
               r"and at most the last terms of this over $(1 - \breve \omega/2)^2$")  # fmt: skip


def _state(proof: Proof) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Name load, friction coefficient and half length, over those of the units, by the moments."""
    nu, t = proof._resolve(spring_share), springpot
    ahead, behind, bulge, twist = (SPRINGPOT[name].subs(spring_share, nu) for name in (P, Q, D, E))
    ahead, mean, bulge = half + t * ahead, 1 + t * (ahead + behind), twelfth + t * bulge
    for name, part in ((P, ahead), (A, mean), (D, bulge), (E, t * twist)):
        proof.define(name, part, "spring and springpot")
    proof.define(half_share, P / A, "F17-edge")
    proof.define(excess_share, half_share - half, "its excess over half of the contact")
    proof.define(load_number, D + excess_share * P, "F17-load")
    proof.define(friction_number, (E + excess_share**2 * P) / load_number, "F17")
    return load_number, friction_number, half_share


@result("F18-springpot", uses=("F17-springpot", "F17-load", "F17", "F17-growth"))
def _springpot(proof: Proof) -> None:
    r"""Fractional Kelvin–Voigt: both limits.

    With $\breve \zeta = (V \tau/\breve c)^\alpha/\Gamma(\breve \nu)$ and $\alpha = 1 - \breve \nu$ for
    the order, in units of $K$. At low velocity $\mu \to \frac{6 \alpha a}{(4 - \alpha) \Gamma(3 - \alpha) R}
    \left(\frac{V \tau}{2 a}\right)^\alpha$, at high velocity $\mu \to \frac{\alpha (3 - \alpha) a}{(4 -
    \alpha) R}$ and $W \to \frac{(2 - \alpha)^{2 - \alpha} K}{\Gamma(4 - \alpha) R} (V \tau)^\alpha a^{3 -
    \alpha}$; Eqs. (42), (45) and (43) for $\alpha = 1$. Under a dead weight $\mu$ falls as
    $V^{-\alpha/(3 - \alpha)}$. Slopes are over $\ln \breve \zeta$; $\breve \zeta$ grows with the velocity
    (F17-growth).

    Argued: At a fixed depth $\ln \breve c$ falls as $\ln \breve a$ grows, under a dead weight as
    $\frac{1}{3} \ln \breve \Lambda$ does, and on a spring by a mean of both with positive weights. The
    limit for low velocity over $\mu$ has the slope $1 - d \ln \breve m - \breve \nu\, d \ln \breve c$,
    and $\mu$ over that for high velocity, on a spring, $d \ln \breve m + (1 + 3\, d \ln \breve c)/(2 +
    \breve \nu)$. Both are positive at both ends of that mean, by these inequalities, so on every support:
    each limit is within a tolerance on a half-line of velocities.
    """
    proof.define(nu, 1 / (1 + steepness), "between 0 and 1")
    load, friction, share = _state(proof)
    ratio, t = friction / share, springpot
    rise, heavier, longer = (t * sp.Derivative(form, t) / form for form in (friction, load, share))
    for form, what in (
        (heavier, "the load grows"),
        (longer, r"the half length grows, at a given $\breve c$"),
        (1 - 3 * longer, "but slowly"),
        (1 - rise, r"$\breve m$ grows less than in proportion"),
        (rise - longer, r"but more than $\breve a$: at a fixed depth $\mu$ grows"),
        ((2 + nu) * rise + 1 - heavier, r"under a dead weight $\mu$ falls less than its limit"),
    ):  # fmt: skip
        proof.holds(form, ">", 0, what)
    slow, fast = (
        {"variable": t, "point": 0, "eps": t},
        {"variable": t, "point": sp.oo, "eps": 1 / t},
    )
    low = 6 * (1 - nu) * t / (nu * (1 + nu) * (3 + nu))
    heavy = t / (nu * (1 + nu) ** 2 * (2 + nu))
    high = (1 - nu) * (2 + nu) / (3 + nu)
    proof.leading_order(load, twelfth, reason="load at low velocity, of the spring alone", **slow)
    proof.leading_order(ratio, low, reason=r"$\mu R/a$ at low velocity", **slow)
    proof.leading_order(load, heavy, reason="load at high velocity, of the springpot", **fast)
    proof.leading_order(ratio, high, reason=r"$\mu R/a$ at high velocity", **fast)
