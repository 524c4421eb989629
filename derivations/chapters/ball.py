r"""Steady sliding of a ball on independent elements: theorem F20.

The strips along x do not know of each other: each is a parabola of depth delta - y**2/(2 R'), and the ball is
their sum. Lengths along x are scaled by the half length a, those across by the half width a sqrt(R'/R), so
that another radius across only scales y. ``theta`` is arctan(1/l), ``T`` and ``D`` are integrals of positive
functions, by which every result is a sum without cancellation.
"""

from collections.abc import Mapping

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof
from .friction_identity import LOAD as STRIP_LOAD
from .friction_identity import p_le, p_te, r
from .model import C, F_x, F_z, K, R, V, delta, delta_t, t, t_0, u_i, x
from .steady import W, a, any_pressure, l, l_r, p, trailing_edge, x_le, x_te
from .theorems import kappa, lam, s

(
    aside, ball_angle, ball_load, ball_mean, ball_rest, ball_kept, ball_lost, ball_tail,
    ball_loss, strip_half, ball_friction, ball_coefficient, ball_share, ball_scaled, ball_scaled_s,
    ball_scaled_ss, ball_cross, ball_lam_cross, ball_slip, ball_l1, ball_l2, ball_load_low,
    ball_load_high, ball_friction_low, ball_friction_high, ball_low, ball_high,
) = symbols(r"""
    y_b         \tilde \zeta      1  place of a strip of a ball over the half width $a
            \sqrt{R_{\mathrm{y}}/R}$  from coordinate
    -           R_{\mathrm{y}}    m  radius of a ball across the sliding direction  from scene
    theta_b     \tilde \theta     1  $\arctan(1/l)$
    w_b         \tilde w          1  scaled load of a ball, $W/(K \delta a^2 \sqrt{R_{\mathrm{y}}/R})$
    g_b         \tilde g          1  $(\pi + \tilde T)/4$
    K_b         \tilde K          1  $\frac{2}{15} - l^2 \tilde D$
    M_b         \tilde M          1  $\tilde D - \tilde N$
    N_b         \tilde N          1  half of $-l\, d \tilde D/d l$
    T_b         \tilde T          1  part of the load of a ball that vanishes at high velocity
    D_b         \tilde D          1  integral by which a ball leaves energy behind
    a_b         \tilde a          m  half length of a strip of a ball
    phi_b       \tilde \varphi    1  scaled friction force of a ball, $F R/(K \delta a^3
            \sqrt{R_{\mathrm{y}}/R})$
    m_b         \tilde m          1  scaled friction coefficient of a ball, $\mu R/a$
    eta_b       \tilde \eta       1  fraction of the power dissipated inside the contact of a ball  real
    f_b         \tilde f          1  scaled load of a ball that has been lifted
    f_b_s       \tilde f'         1  -
    f_b_ss      \tilde f''        1  -
    l_b         \tilde l^{*}      1  scaled crossing velocity of a ball at a given depth
    lambda_b    \tilde \lambda^{*}  1  scaled crossing velocity of a ball at a given load
    E_b         \tilde E          1  slope of the friction coefficient of a ball at a given load,
            scaled  real
    e_b_L1      \tilde e_{\mathrm{L1}}  1  relative error of the low asymptote, ball  real
    e_b_L2      \tilde e_{\mathrm{L2}}  1  relative error of the high asymptote, ball  real
    e_b_W_low   \tilde e_{W\!,\,V\to0}  1  relative error of the load at rest, ball  real
    e_b_W_high  \tilde e_{W\!,\,V\to\infty}  1  relative error of the load at high velocity, ball  real
    e_b_F_low   \tilde e_{F\!,\,V\to0}  1  relative error of the friction force at low velocity,
            ball  real
    e_b_F_high  \tilde e_{F\!,\,V\to\infty}  1  relative error of the friction force at high velocity,
            ball  real
    m_b_low     \tilde m_{\mathrm{L1}}  1  asymptote of $\tilde m$ for low velocity
    m_b_high    \tilde m_{\mathrm{L2}}  1  asymptote of $\tilde m$ for high velocity
""")  # fmt: skip

strip_load, strip_friction, strip_loss = (
    function(name, rf"{what} of the strips of a ball at one distance from its middle, scaled")
    for name, what in (("S_b", "load"), ("R_b", "friction force"), ("U_b", "loss behind"))
)  # fmt: skip

SECTION = "Ball"

y, theta, T, D = aside, ball_angle, ball_tail, ball_loss
w, phi, m = ball_load, ball_friction, ball_coefficient
PI = sp.pi
ANGLE = sp.atan(1 / l)
EDGE = sp.sqrt(1 + l**2 - y**2)
"""(x_TE + l_r)/a of a strip."""
TAIL = 2 * (1 + l**2) ** 2 * theta - 2 * l**3 - sp.Rational(10, 3) * l
LOSS = (sp.Rational(2, 3) - l * T / 2) / (1 + l**2)
LOAD = (PI + sp.Rational(16, 3) * l + T) / 4
FRICTION = l * (PI + T) / 4
COEFFICIENT = l * (PI + T) / (PI + sp.Rational(16, 3) * l + T)
STRIPS = sp.Rational(4, 3) * (
    y * (5 - 2 * y**2) * sp.sqrt(1 - y**2) / 8 + 3 * sp.asin(y) / 8
    + y * (5 * (1 + l**2) - 2 * y**2) * EDGE / 8 + 3 * (1 + l**2) ** 2 * sp.atan(y / EDGE) / 8 - l**3 * y
)  # fmt: skip
"""The load of the strips up to y."""
BEHIND = sp.Integral(
    C / V * (V * sp.Derivative(u_i.subs(t, t_0 + (x - x_te) / V), x)) ** 2, (x, x_te, sp.oo)
)
"""What is lost behind the contact per distance slid."""
REST = sp.Rational(2, 15) - l**2 * (sp.Rational(2, 3) + l**2 - l * (1 + l**2) * theta)
HIGH = 3 * PI / 16
UNIT = (y, 0, 1)

result = Chapter(SECTION)


def _angle(proof: Proof) -> None:
    proof.define(theta, ANGLE, r"half the angle of the contact as seen from $-l_{\mathrm{r}}$")


def known(proof: Proof, at: Mapping[sp.Symbol, sp.Expr] | None = None) -> None:
    """Recall the tail of the load, perhaps at another l."""
    proof.define(theta, ANGLE.subs(at or {}), "half the angle of the contact, F20-tail")
    proof.recall("F20-tail", at=at)


def _sums(proof: Proof) -> None:
    """State what every later theorem uses."""
    known(proof)
    proof.recall("F20-load")


@result("F20-tail")
def _tail(proof: Proof) -> None:
    r"""Ball: the closed form without cancellation.

    For $l \gg 1$ the terms of $\tilde T$ grow as $l^3$ and cancel; the integral does not. It falls with $l$,
    from $\pi$ at $l = 0$ to zero.
    """
    _angle(proof)
    positive = 2 * l * (1 - y**2) ** 2 / (l**2 + y**2)
    primitive = 2 * l * (y**3 / 3 - (2 + l**2) * y) + 2 * (1 + l**2) ** 2 * sp.atan(y / l)
    proof.integral(T, positive, UNIT, "of a positive function", value=TAIL,
                   antiderivative=primitive)  # fmt: skip
    proof.leading_order(T, sp.Rational(16, 15) / l, l, sp.oo, "at high velocity")
    proof.done(T, TAIL)


@result("F20-strip")
def _strip(proof: Proof) -> None:
    r"""Ball: a strip of it.

    A strip at $\tilde \zeta$, in units of the half width $a \sqrt{R_{\mathrm{y}}/R}$, is a parabola: $1 -
    \tilde \zeta^2$ times as deep as the ball, with the half length $a \sqrt{1 - \tilde \zeta^2}$. What it
    carries, rubs and leaves behind, for both sides of the ball.
    """
    width = 1 - y**2
    laws = (
        sp.Rational(4, 3) * (width ** sp.Rational(3, 2) + EDGE**3 - l**3),
        l * (strip_load(y) - 2 * l * width), 2 * l**2 * (EDGE - l) ** 2,
    )  # fmt: skip
    for law, form in zip((strip_load, strip_friction, strip_loss), laws, strict=True):
        proof.define(law(y), form, "over both sides")
    proof.where(width > 0, "within the contact")
    strip = {a: strip_half, delta: delta * width}
    proof.recall("F21-load", (r, sp.sqrt(a**2 + l_r**2)), (W, STRIP_LOAD), at=strip)
    proof.recall("eq27", (x_te, trailing_edge), at=strip)
    proof.recall("eq26", at=strip)
    proof.recall("pressure", (p, any_pressure), at={delta: delta * width})
    proof.recall("eq3", "eq29", C)
    proof.recall("F21", at={delta_t: delta * width})
    for edge, place in ((p_te, x_te), (p_le, x_le)):
        proof.define(edge, sp.Subs(p, x, place), "the pressure of steady sliding")
    proof.define(F_z, W, "its load")
    proof.recall("energy-behind", at={delta: delta * width})
    proof.recall("eq3", at={x: x_te})
    proof.recall("eq28", delta)
    proof.define(l_r, l * a, "the retardation length in half lengths")
    proof.define(strip_half, a * sp.sqrt(width), "half length of the strip")
    proof.equal(2 * W / (K * delta * a), strip_load(y), "F21-load, both sides")
    proof.equal(2 * F_x * R / (K * delta * a**2), strip_friction(y), "and F21")
    proof.equal(2 * BEHIND * R / (K * delta * a**2), strip_loss(y), "by the surface behind")


@result("F20-load")
def _load(proof: Proof) -> None:
    r"""Ball: load.

    The contact is the disc of the contact at rest, ahead of the curve $x_{\mathrm{TE}}/a = \sqrt{1 - \tilde
    \zeta^2 + l^2} - l$ on which the pressure vanishes.
    """
    known(proof)
    proof.recall("F20-strip", strip_load(y))
    proof.integral(w, strip_load(y), UNIT,
                   r"all strips: $W/(K \delta a^2 \sqrt{R_{\mathrm{y}}/R})$", value=LOAD,
                   antiderivative=STRIPS)  # fmt: skip


@result("F20-loss")
def _loss(proof: Proof) -> None:
    r"""Ball: what leaves the contact.

    $\tilde D$ is positive and less than $\frac{2}{15 l^2}$, for $l^2 + \tilde \zeta^2 > l^2$.
    """
    positive = y**2 * (1 - y**2) / (l**2 + y**2)
    primitive = -(y**3) / 3 + (1 + l**2) * y - l * (1 + l**2) * sp.atan(y / l)
    closed = sp.Rational(2, 3) + l**2 - l * (1 + l**2) * theta
    known(proof)
    proof.integral(D, positive, UNIT, "of a positive function", value=closed,
                   antiderivative=primitive)  # fmt: skip
    proof.equal(D, LOSS, "from the same tail")
    proof.equal(sp.Derivative(T, l), -8 * D, "so the tail falls")
    proof.leading_order(D, sp.Rational(2, 15) / l**2, l, sp.oo, "at high velocity")
    proof.done(D, LOSS)


@result("F20")
def _friction(proof: Proof) -> None:
    r"""Ball: friction.

    The forces of a ball: $W = \sqrt{R_{\mathrm{y}}/R}\, K \delta a^2 \tilde w$ and $F = \frac{a}{R}
    \sqrt{R_{\mathrm{y}}/R}\, K \delta a^2 \tilde \varphi$ depend, like $\mu = \frac{a}{R} \tilde m$, on $l =
    V \tau/a$ alone; of $R_{\mathrm{y}}$, the radius across, only the scale depends, and not $\mu$ at all at a
    given depth. In both limits a line contact with the same $R$, of the half length $\frac{9 \pi}{32} a$ and
    as wide as $\frac{4}{3} (\frac{32}{9 \pi})^2 a \sqrt{R_{\mathrm{y}}/R}$ has the same forces, by F1.
    """
    _sums(proof)
    proof.recall("F20-strip", strip_load(y), strip_friction(y))
    depth = 2 * y - 2 * y**3 / 3
    proof.integral(phi, strip_friction(y), UNIT,
                   r"all strips: $F R/(K \delta a^3 \sqrt{R_{\mathrm{y}}/R})$", value=FRICTION,
                   antiderivative=l * (STRIPS - l * depth))  # fmt: skip
    proof.equal(phi / w, COEFFICIENT, "friction coefficient")
    proof.define(m, COEFFICIENT, r"$\mu R/a$")


@result("F20-energy")
def _energy(proof: Proof) -> None:
    r"""Ball: energy dissipated inside the contact.

    Of the power $F V$ the surface behind a strip takes $\frac{K}{2} V u_{\mathrm{TE}}^2$ per unit width,
    $u_{\mathrm{TE}} = \frac{l_{\mathrm{r}}}{R} x_{\mathrm{TE}}$. The fraction inside the contact is 1 in both
    limits.
    """
    primitive = (1 + 2 * l**2) * y - y**3 / 3 - l * (y * EDGE + (1 + l**2) * sp.atan(y / EDGE))
    known(proof)
    proof.recall("F20-loss", "F20-strip", strip_loss(y))
    lost = sp.Integral(strip_loss(y), UNIT)
    proof.integral(lost, strip_loss(y), UNIT, "all strips", value=2 * l**2 * D,
                   antiderivative=2 * l**2 * primitive)  # fmt: skip
    proof.recall("F20", phi)
    share = 1 - 8 * l * D / (PI + T)
    proof.define(ball_share, 1 - lost / phi, r"the rest of $F V$ relaxes behind")
    proof.equal(ball_share, share, "fraction inside")
    proof.done(ball_share, share)


@result("F20-low")
def _limits(proof: Proof) -> None:
    r"""Ball: low velocity.

    $\mu \to \frac{C V}{K R}$, which is Eq. (42): neither load nor shape across matter. At rest $W = \pi K R
    \delta^2 \sqrt{R_{\mathrm{y}}/R}$.
    """
    _sums(proof)
    proof.recall("F20")
    near = {"variable": l, "point": 0, "eps": l}
    proof.leading_order(w, PI / 2, reason="load at rest", **near)
    proof.leading_order(m, l, reason="friction coefficient: that of the cylinder", **near)


@result("F20-high")
def _high(proof: Proof) -> None:
    r"""Ball: high velocity.

    At a given load $W = \frac{4}{3} C V \delta a \sqrt{R_{\mathrm{y}}/R}$ makes $a^3 \sim 1/V$: the friction
    coefficient of a ball falls as $V^{-1/3}$, where that of a cylinder falls as $V^{-1/2}$.
    """
    _sums(proof)
    proof.recall("F20")
    far = {"variable": l, "point": sp.oo, "eps": 1 / l}
    proof.leading_order(w, sp.Rational(4, 3) * l, reason=r"$W \to C V$ times the mean depth", **far)
    proof.leading_order(m, HIGH, reason=r"$\mu \to \frac{3 \pi}{16} \frac{a}{R}$", **far)


@result("F20-balance")
def _balance(proof: Proof) -> None:
    r"""Ball: one depth for a weight.

    On a spring of support number $\kappa$ the balance is $\tilde f + \kappa (s^2 - 1) = 1$. As $d \ln \tilde
    f/d \ln s$ is above 3 and below 4, there is one depth, and its relative error is less than that of the
    load.
    """
    whole = 2 * s**4 * w / PI
    scaled = s**3 * (s * (1 + T / PI) / 2 + 8 * lam / (3 * PI))
    slope = 4 * s**2 * (PI * s**2 / 2 + s * lam + (s**2 + lam**2) * theta) / PI
    curve = 8 * s**2 * (PI * s**2 + 2 * s * lam + (2 * s**2 + lam**2) * theta) / PI
    proof.define(l, lam / s, r"$\lambda = V \tau/a_0$, $s = a/a_0$")
    known(proof, {l: lam / s})
    proof.recall("F20-load", at={l: lam / s})
    proof.define(ball_scaled, whole, r"$W/W_0$, $W_0 = \pi K R \delta_0^2 \sqrt{R_{\mathrm{y}}/R}$")
    proof.equal(ball_scaled, scaled, "a sum of positive terms")
    proof.define(ball_scaled_s, slope, r"$d \tilde f/d \ln s$ at fixed $\lambda$")
    proof.equal(s * sp.Derivative(ball_scaled, s), ball_scaled_s, "a deeper ball carries more")
    proof.define(ball_scaled_ss, curve, r"$d^2 \tilde f/d (\ln s)^2$")
    proof.equal(s * sp.Derivative(ball_scaled_s, s), ball_scaled_ss, "the second derivative")
    proof.recall("F20-loss", at={l: lam / s})
    gain = 2 * s**4 * ((PI + T) / 4 + 2 * lam / s * D) / PI
    proof.equal(ball_scaled_s - 3 * ball_scaled, gain, "more than the damper alone")
    number = lam / s
    less = 4 * s**3 * lam * (2 * number**2 / 3 + number * T / 2) / (1 + number**2) / PI
    proof.equal(4 * ball_scaled - ball_scaled_s, less, "less than the spring alone")
    for form in (gain, less):
        proof.holds(form, ">", 0, "all terms are positive")
    balance = ball_scaled + kappa * (s**2 - 1) - 1
    proof.crossing(balance, (s, 0, sp.oo), "exactly once", slope=ball_scaled_s / s + 2 * kappa * s)
    proof.done(ball_scaled, scaled)


@result("F20-crossing")
def _crossing(proof: Proof) -> None:
    r"""Ball: crossing velocity.

    The asymptotes $\mu = V \tau/R$ and $\mu = \frac{3 \pi}{16} \frac{a}{R}$ meet at $V^{*} \tau = \frac{3
    \pi}{16} a$ for a given depth; at a given load ($\kappa = 0$) or on a spring at $V^{*} \tau = \tilde
    \lambda^{*} a_0$.
    """
    proof.asymptote("F20-low", m, ball_low)
    proof.asymptote("F20-high", m, ball_high)
    reason = "the asymptotes meet at a given depth"
    proof.root(ball_low - ball_high, l, HIGH, reason, name=ball_cross)
    held = HIGH * (2 * (1 + kappa)) ** sp.Rational(1, 4)
    lifted = 3 * PI * (1 + kappa) / (8 * lam)
    reason = r"$\lambda = \frac{3 \pi}{16} s$ with $s^3 = \frac{3 \pi (1 + \kappa)}{8 \lambda}$"
    proof.root(lam**3 - ball_high**3 * lifted, lam, held, reason, name=ball_lam_cross)


@result("F20-peak")
def _slip(proof: Proof) -> None:
    r"""Ball: friction maximum of a dead weight.

    At a given load $a \sim \tilde w^{-1/4}$, and $V \tau = a l$ grows with $l$. The friction coefficient
    rises where $\tilde E > 0$: at low velocity, where $\tilde E \to \frac{\pi}{2}$; and it falls at high
    velocity, where $\tilde E \to - \frac{l}{3}$. The one root of $\tilde E$ in between (F20-unique) is $l =
    1.842345$, beside the $\sqrt{3}$ of a cylinder (F3).
    """
    known(proof)
    proof.recall("F20-loss", "F20-load", "F20", phi)
    gain = l * (sp.Rational(4, 3) - 2 * D)
    proof.equal(l * sp.Derivative(w, l), gain, "a faster ball carries more")
    proof.equal(l * sp.Derivative(phi, l), phi - 2 * l**2 * D, "and rubs more")
    slip = (1 - 8 * l * D / (PI + T)) * w - sp.Rational(5, 4) * gain
    proof.define(ball_slip, slip, "has the sign of the slope of the friction coefficient")
    proof.equal(phi * slip, (phi - 2 * l**2 * D) * w - sp.Rational(5, 4) * gain * phi,
                r"$\tilde \varphi \tilde w \frac{d}{d \ln l} \ln (\tilde \varphi \tilde w^{-5/4})$, for "
                r"$\mu = F/W$ and $F \sim a^5 \tilde \varphi$")  # fmt: skip
    proof.done(ball_slip, slip)


@result("F20-unique")
def _unique(proof: Proof) -> None:
    r"""Ball: one friction maximum.

    With F20-loss, $\frac{d \tilde T}{d l} = - 8 \tilde D$. As $\tilde E/l$ falls strictly, from infinity to
    $- \frac{1}{3}$, it has one root, $l = 1.842345$ within $10^{-6}$: a ball under a dead weight has one
    friction maximum.
    """
    arc, whole = sp.atan(y / l), 1 + l**2
    rest, kept, lost, g = ball_rest, ball_kept, ball_lost, ball_mean
    square, wide = y**2 * (1 - y**2), l**2 + y**2
    lose = y**3 / 3 - whole * y + l * whole * arc
    forget = l * (-l * y + (1 + 3 * l**2) * arc / 2 - l * whole * y / (2 * wide))
    known(proof)
    proof.integral(rest, y**2 * square / wide, UNIT, r"$\frac{2}{15} - l^2 \tilde D$", value=REST,
                   antiderivative=y**3 / 3 - y**5 / 5 + l**2 * lose)  # fmt: skip
    for name, form, primitive, what in (
        (lost, l**2 * square / wide**2, forget, r"$-\frac{l}{2}$ times the slope of $\tilde D$"),
        (kept, y**2 * square / wide**2, -lose - forget, "what remains"),
    ):
        proof.integral(name, form, UNIT, what, antiderivative=primitive)
    proof.recall("F20-loss")
    proof.define(g, (PI + T) / 4, r"$\tilde \varphi/l$")
    shape = g / l - sp.Rational(1, 3) + D / 2 - sp.Rational(8, 3) * l * D / g
    proof.recall("F20-load", "F20-peak")
    proof.equal(ball_slip / l, shape, "over $l$")
    size = (
        g**2 - sp.Rational(16, 45) + sp.Rational(8, 3) * rest
        + l * g * (2 * D + lost) + sp.Rational(16, 3) * l**2 * (kept + l * D**2 / g)
    )  # fmt: skip
    fall = -(l**2) * g * sp.Derivative(shape, l)
    proof.equal(fall, size, "how steeply it falls; no term but one is negative")
    size = size.subs(g, (PI + T) / 4)
    proof.holds(size, ">", 0, r"it is outweighed: $\frac{\pi^2}{16} > \frac{16}{45}$")
    for place, sign in zip(PEAK, "><", strict=True):
        proof.holds(sp.Subs(shape, l, place), sign, 0, "beside the root")
    proof.crossing(shape, (l, 0, sp.oo), "exactly once", slope=-size / (l**2 * (PI + T) / 4))


PEAK = sp.Rational(1842344, 10**6), sp.Rational(1842346, 10**6)
"""Between these l the friction coefficient of a dead weight is greatest."""


def _error(
    proof: Proof, name: sp.Symbol, ratio: sp.Expr, error: sp.Expr, slope: sp.Expr, sign: str
) -> None:
    """Prove the error of an asymptote, and that it grows with l or falls."""
    for label, part in (("F20-load", w), ("F20", phi), ("F20", m)):
        if ratio.has(part):
            proof.recall(label, part)
    proof.define(name, ratio - 1, "asymptote over the truth, less one")
    proof.equal(name, error, "without cancellation")
    known(proof)
    proof.recall("F20-loss")
    if slope.has(ball_rest):
        proof.recall("F20-unique", ball_rest)
    proof.equal(sp.Derivative(error, l), slope, "its slope")
    proof.holds(slope, sign, 0, "of one sign")
    proof.done(name, error)


_g, _whole = (PI + T) / 4, PI + sp.Rational(16, 3) * l + T
_slower = 2 * (2 * l**2 / 3 + l * T / 2) / (1 + l**2)
"""4/3 - 2 D, by which the load grows with l."""
for _label, _title, _name, _ratio, _form, _growth, _sign in (
    ("L1", "low velocity", ball_l1, l / m, 4 * l / (3 * _g),
     sp.Rational(4, 3) * (_g + 2 * l * D) / _g**2, ">"),
    ("L2", "high velocity, given depth", ball_l2, HIGH / m, HIGH / l - T / (PI + T),
     (8 * PI * (sp.Rational(2, 15) - ball_rest) / (PI + T) ** 2 - HIGH) / l**2, "<"),
    ("load-low", "load at low velocity, given depth", ball_load_low, PI / 2 / w,
     -(sp.Rational(16, 3) * l - (PI - T)) / _whole, -8 * PI * _slower / _whole**2, "<"),
    ("load-high", "load at high velocity, given depth", ball_load_high, sp.Rational(4, 3) * l / w,
     -(PI + T) / _whole, (8 * D * _whole + 4 * (PI + T) * _slower) / _whole**2, ">"),
    ("friction-low", "friction force at low velocity, given depth", ball_friction_low,
     PI / 2 * l / phi, (PI - T) / (PI + T), 16 * PI * D / (PI + T) ** 2, ">"),
    ("friction-high", "friction force at high velocity, given depth", ball_friction_high,
     PI / 4 * l / phi, -T / (PI + T), 8 * PI * D / (PI + T) ** 2, ">"),
):  # fmt: skip
    result(f"F20-error-{_label}", title=f"Ball: relative error, {_title}", text="It is monotonic in $l$.",
           name=_name, ratio=_ratio, error=_form, slope=_growth,
           sign=_sign)(_error)  # fmt: skip
