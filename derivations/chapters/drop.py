r"""A drop: an indenter that falls onto the foundation without sliding, and how fast it leaves it (F32).

There is no gravity while the contact lasts. Going in, every element under the indenter follows it; coming
out, elements detach where their pressure vanishes, and the force is that of an elastic contact at the depth
w = delta + tau delta'. Both ways are one pair of equations, started twice, with one number, eta.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .model import (
    C, F_z, K, M, N, R, c, compression_rate, delta_t, depth_rate, f_z, h, k, t, tau, u_i, x, x_i,
)  # fmt: skip
from .steady import CONTACT, p, x_le, x_te

height_there = symbol("h_i", "height of the indenter at a free element over its lowest point", "m")
ball_depth = symbol("delta_b", "depth of a ball", "m", latex=r"\delta_{\mathrm{B}}")
ball_rate = symbol("delta_b'", latex=r"\dot\delta_{\mathrm{B}}", real=True)
ball_relaxed = symbol("w_bin", r"depth of an elastic contact with the edges of a ball coming out",
                      "m", latex=r"w_{\mathrm{B}}")  # fmt: skip
ball_mass = symbol("M_ball", "mass of a ball", "kg", latex=r"M_{\mathrm{B}}")
radius_across = symbol("R_y", latex=r"R_{\mathrm{y}}")
(
    relaxed, speed_in, depth_scale, number, deep, deep_relaxed, velocity, slowing, aside, ball_force,
    deepest, speed, restitution, loss, force_at_top, slowed, bending, share, clock,
) = symbols(r"""
    w_in    w_{\mathrm{in}}  m    depth of an elastic contact with the edges of a drop coming
            out, $\delta + \tau \dot\delta$
    v_in    v_{\mathrm{in}}  m/s  velocity with which a drop meets the foundation
    D_in    D_{\mathrm{in}}  m    depth where the springs hold a drop, as a scale
    eta_in  \eta_{\mathrm{in}}  1  number of a drop, $\tau v_{\mathrm{in}}/D_{\mathrm{in}}$
    d_d     -                1    scaled depth of a drop, $\delta/D_{\mathrm{in}}$
    w_d     -                1    scaled depth of the elastic contact, $w_{\mathrm{in}}/D_{\mathrm{in}}$
    v_d     -                1    scaled velocity of a drop, $\dot\delta/v_{\mathrm{in}}$  real
    a_d     -                1    scaled acceleration of a drop, $D_{\mathrm{in}}
            \ddot\delta/v_{\mathrm{in}}^2$  real
    zeta_d  -                1    place of a strip of a ball over the half width  real
    F_d     -                N    vertical force on a ball  real
    d_m     d_{\max}         1    greatest scaled depth of a drop without dampers
    u_d     -                1    scaled speed of a drop without dampers
    e_r     e_{\mathrm{r}}   1    coefficient of restitution, speed up over speed down
    I_d     -                1    scaled energy that the dampers take each way, to first order
    f_m     f_{\max}         1    greatest scaled force on a drop without dampers
    J_d     -                1    what the dampers take less each way, as a drop is slower, to second order
    Q_d     -                1    what the dampers take less coming out, as the force is curved
    z_d     -                1    share of the springs in the energy of a drop without dampers
    s_d     -                1    scaled time of a drop, $t v_{\mathrm{in}}/D_{\mathrm{in}}$  real
""")  # fmt: skip
impulse = function("y_d", "scaled velocity of a drop, with the impulse of its dampers", real=True)
force = function("f_d", "scaled elastic force on a drop", real=True)
energy = function("U_d", "scaled energy of an elastic contact", real=True)
incomplete = function("B_d", "incomplete beta function", real=True)

SECTION = "A drop"
ROOT = sp.sqrt(2 * R)
LINE = sp.Rational(4, 3), sp.Rational(3, 2)
"""The elastic force of a line over K sqrt(2 R): its factor, and its power of the depth."""
BALL = sp.S.One, sp.S(2)
"""That of a ball over pi K R."""
FORCE_IN = (
    K
    * ROOT
    * (sp.Rational(4, 3) * delta_t ** sp.Rational(3, 2) + 2 * tau * sp.sqrt(delta_t) * depth_rate)
)
FORCE_OUT = sp.Rational(4, 3) * K * ROOT * relaxed ** sp.Rational(3, 2)
MEAN_RADIUS = sp.sqrt(R * radius_across)
BALL_IN = sp.pi * K * MEAN_RADIUS * (ball_depth**2 + 2 * tau * ball_depth * ball_rate)
BALL_OUT = sp.pi * K * MEAN_RADIUS * ball_relaxed**2

result = Chapter(SECTION)


@result("F32-pressure")
def _pressure(proof: Proof) -> None:
    """Pressure under a drop.

    The foundation does not move along: Eqs. (6) and (12) with a base at rest.
    """
    proof.recall("eq6")
    proof.define(x_i.diff(t), sp.S.Zero, "no sliding")
    proof.equal(compression_rate, depth_rate, "an element under the indenter follows it")
    proof.recall("eq12", "eq22", k, c)
    proof.define(p, K * (delta_t - h(x)) + C * depth_rate, "force per area of a dense row")
    proof.equal(sp.Subs(p, x, x_i), N * f_z, "$N$ elements per length, each with this force")


@result("F32-in")
def _going_in(proof: Proof) -> None:
    r"""A drop, going in: force of a line.

    The edges are where the indenter meets the undisturbed surface. The pressure is positive up to them.
    """
    proof.recall("F32-pressure", p, "eq3", "eq22", "dense-row", F_z)
    proof.define(x_te, sp.sqrt(2 * R * delta_t), "undisturbed ground, Eq. (3)")
    proof.define(x_le, -sp.sqrt(2 * R * delta_t), "by symmetry")
    proof.integral(F_z, p, CONTACT, "Eq. (14) for a dense row", value=FORCE_IN)


@result("F32-edge")
def _edge(proof: Proof) -> None:
    r"""A drop, coming out: edges of the contact.

    With $w_{\mathrm{in}} = \delta + \tau \dot\delta$ the pressure is that of an elastic contact of this
    depth, and elements detach where it vanishes. The contact ends with $w_{\mathrm{in}} = 0$.
    """
    _coming_out(proof)
    proof.equal(p, K * (relaxed - x**2 / (2 * R)), "the pressure")
    proof.root(p, x, sp.sqrt(2 * R * relaxed), "an edge where elements detach",
               over=(x, 0, sp.oo), name=x_te)  # fmt: skip


def _coming_out(proof: Proof) -> None:
    proof.recall("F32-pressure", p, "eq3", "eq22")
    proof.define(
        depth_rate, (relaxed - delta_t) / tau, r"$w_{\mathrm{in}} = \delta + \tau \dot\delta$"
    )


@result("F32-out")
def _out(proof: Proof) -> None:
    r"""A drop, coming out: force of a line.

    With $w_{\mathrm{in}} = \delta + \tau \dot\delta$; it vanishes with $w_{\mathrm{in}}$.
    """
    _coming_out(proof)
    proof.recall("dense-row", F_z, "F32-edge", x_te)
    proof.define(x_le, -sp.sqrt(2 * R * relaxed), "by symmetry")
    proof.integral(F_z, p, CONTACT, "Eq. (14) for a dense row", value=FORCE_OUT)


@result("F32-apart")
def _apart(proof: Proof) -> None:
    r"""A drop, coming out: what detaches does not touch again.

    A free element relaxes by Eq. (20). Behind an edge, where $h_i > w_{\mathrm{in}}$, it stays below the
    indenter, and the edge goes inward: by F32-up both terms of $w_d'$ are negative while the indenter rises.
    """
    place, grown = height_there, sp.exp(t / tau)
    gap, form = (u_i - (delta_t - place)) * grown, (place - relaxed) / tau * grown
    proof.recall("eq20")
    proof.define(
        depth_rate, (relaxed - delta_t) / tau, r"$w_{\mathrm{in}} = \delta + \tau \dot\delta$"
    )
    proof.equal(sp.Derivative(gap, t), form, "the gap, at a place of the height $h_i$")
    proof.where(sp.Gt(place, relaxed), "behind the edge")
    proof.holds(form, ">", 0, "it opens, from nothing at the edge")
    proof.done(sp.Derivative(gap, t), form)


def _all_strips(proof: Proof, name: str, depth: sp.Expr, value: sp.Expr) -> None:
    """Add up the strips of a ball, each of which is a line whose depth is `name`."""
    y = aside
    shape, width = sp.sqrt(1 - y**2), sp.sqrt(2 * radius_across * depth)
    cubed, plain = y * (5 - 2 * y**2) * shape / 8 + 3 * sp.asin(y) / 8, (y * shape + sp.asin(y)) / 2
    spring = sp.Rational(4, 3) * K * ROOT * width * depth ** sp.Rational(3, 2)
    primitive = spring * cubed
    if name == "F32-in":
        primitive += 2 * K * tau * ROOT * width * sp.sqrt(depth) * ball_rate * plain
    proof.recall(name)
    proof.integral(ball_force, F_z * width, (y, -1, 1), "the sum of the strips", value=value,
                   antiderivative=primitive)  # fmt: skip


@result("F32-ball-in")
def _ball_in(proof: Proof) -> None:
    r"""A drop, going in: force of a ball.

    The strip along $x$ at the place $\zeta_d$, in units of the half width $\sqrt{2 R_{\mathrm{y}}
    \delta_{\mathrm{B}}}$, is a line; the rate of its depth is that of the ball.
    """
    proof.define(delta_t, ball_depth * (1 - aside**2), "depth of a strip")
    proof.define(depth_rate, ball_rate, "at a fixed place")
    _all_strips(proof, "F32-in", ball_depth, BALL_IN)


@result("F32-ball-out")
def _ball_out(proof: Proof) -> None:
    r"""A drop, coming out: force of a ball.

    With $w_{\mathrm{B}} = \delta_{\mathrm{B}} + \tau \dot\delta_{\mathrm{B}}$, and strips in units of the
    half width $\sqrt{2 R_{\mathrm{y}} w_{\mathrm{B}}}$.
    """
    proof.define(relaxed, ball_relaxed * (1 - aside**2), "depth of the elastic contact of a strip")
    _all_strips(proof, "F32-out", ball_relaxed, BALL_OUT)


def _motion(proof: Proof, line: bool, rising: bool) -> None:
    """Prove the scaled motion of a line or a ball, one way."""
    factor, power = LINE if line else BALL
    total, mass = (F_z, M) if line else (ball_force, ball_mass)
    size = K * ROOT * depth_scale**power if line else sp.pi * K * MEAN_RADIUS * depth_scale**power
    depth, rate = (delta_t, depth_rate) if line else (ball_depth, ball_rate)
    proof.recall("F32" + ("" if line else "-ball") + ("-out" if rising else "-in"))
    if rising:
        proof.define(relaxed if line else ball_relaxed, depth_scale * deep_relaxed, "scaled depth")
        value = -factor * deep_relaxed**power
    else:
        proof.define(depth, depth_scale * deep, "scaled depth")
        proof.define(rate, speed_in * velocity, "scaled velocity")
        value = -factor * deep**power - number * factor * power * deep ** (power - 1) * velocity
    proof.define(mass, size * depth_scale / speed_in**2, r"this says what $D_{\mathrm{in}}$ is")
    proof.define(tau, number * depth_scale / speed_in, r"and this what $\eta_{\mathrm{in}}$ is")
    proof.define(slowing, -total / mass * depth_scale / speed_in**2, "Newton's law without gravity")
    proof.equal(slowing, value, "scaled motion")
    _pair(proof, factor, power, rising)
    proof.done(slowing, value)


def _pair(proof: Proof, factor: sp.Expr, power: sp.Expr, rising: bool) -> None:
    """Write the motion as two equations of first order."""
    s, eta = clock, number
    depth, speed = sp.Function("d_d", positive=True)(s), sp.Function("v_d", real=True)(s)
    proof.define(sp.Derivative(depth, s), speed, "in time")
    proof.define(sp.Derivative(speed, s), slowing, "likewise")
    if rising:
        proof.define(
            deep_relaxed, depth + eta * speed, r"$w_{\mathrm{in}} = \delta + \tau \dot\delta$"
        )
        form = speed - eta * factor * deep_relaxed**power
        proof.equal(sp.Derivative(deep_relaxed, s), form, "the pair of F32")
        return
    proof.define(deep, depth, "the depth over time")
    proof.define(velocity, speed, "and the velocity")
    changed = sp.Derivative(velocity + eta * factor * deep**power, s)
    proof.equal(changed, -factor * deep**power, "the pair of F32, with $y_d$ for what changes")


for _shape, _first in (("line", "F32"), ("ball", "F32-ball")):
    result(f"{_first}-down", title=f"A drop of a {_shape}, going in: one number",
           line=_shape == "line", rising=False)(_motion)  # fmt: skip
    result(f"{_first}-up", title=f"A drop of a {_shape}, coming out: one number",
           line=_shape == "line", rising=True)(_motion)  # fmt: skip


@result("F32")
def _energy(proof: Proof) -> None:
    r"""A drop: one pair of equations for both ways, and its energy.

    With $f_d = \frac{4}{3} d_d^{3/2}$ for a line and $d_d^2$ for a ball: the pair starts at $d_d = 0$, $y_d =
    1$, until $d_d' = 0$ (F32-down); there it starts again, at the same depth with $y_d = 0$, until $d_d = 0$
    (F32-up, where $w_d$ stands for $d_d$ and $v_d$ for $y_d$). Then the force is zero, and the velocity stays
    what it is, $y_d = -e_{\mathrm{r}}$. So the coefficient of restitution is a function of
    $\eta_{\mathrm{in}}$ alone.
    """
    s, eta = clock, number
    depth, driven = sp.Function("d_d", real=True)(s), impulse(s)
    pushed = force(depth)
    proof.define(sp.Derivative(depth, s), driven - eta * pushed, "the first equation")
    proof.define(sp.Derivative(driven, s), -pushed, "the second one")
    kept = energy(s)
    proof.define(sp.Derivative(kept, s), pushed * sp.Derivative(depth, s), "energy of the springs")
    proof.equal(sp.Derivative(driven**2 / 2 + kept, s), -eta * pushed**2, "what the dampers take")


def _loss(proof: Proof, factor: sp.Expr, power: sp.Expr) -> None:
    """Prove what the dampers take each way, to first order: an integral of Euler's."""
    z, part = share, power / (power + 1)
    weight = z ** (part - 1) * sp.sqrt(1 - z)
    proof.define(deepest, ((power + 1) / (2 * factor)) ** (1 / (power + 1)),
                 "there the springs hold all energy")  # fmt: skip
    proof.define(deep, deepest * z ** (1 / (power + 1)), "where they hold the share $z_d$")
    proof.define(speed, sp.sqrt(1 - 2 * factor * deep ** (power + 1) / (power + 1)), "no dampers")
    proof.equal(speed, sp.sqrt(1 - z), "the rest is kinetic energy")
    proof.define(force_at_top, factor * deepest**power, "the greatest force")
    density = factor * power * deep ** (power - 1) * speed * sp.Derivative(deep, z)
    proof.equal(density, part * force_at_top * weight, "of the damper, with $z_d$ as the variable")
    proof.define(sp.Derivative(incomplete(z), z), weight, "incomplete beta function")
    proof.define(incomplete(0), sp.S.Zero, "an integral from 0 on")
    proof.integral(loss, part * force_at_top * weight, (z, 0, 1), "what the dampers take",
                   value=part * force_at_top * incomplete(1),
                   antiderivative=part * force_at_top * incomplete(z))  # fmt: skip


def _second(proof: Proof, family: str, factor: sp.Expr, power: sp.Expr) -> None:
    """Prove what changes the loss to second order."""
    z, eta, part = share, number, power / (power + 1)
    proof.recall(f"{family}-loss")
    shape = z ** (part - 1)
    proof.define(
        sp.Derivative(incomplete(z), z), shape * sp.sqrt(1 - z), "incomplete beta function"
    )
    proof.define(incomplete(0), sp.S.Zero, "an integral from 0 on")
    whole = loss * part * force_at_top
    primitive = whole * ((2 * part + 1) * incomplete(z) - 2 * z**part * sp.sqrt(1 - z))
    proof.integral(slowed, whole * shape / sp.sqrt(1 - z), (z, 0, 1), "less, as the drop is slower",
                   value=(2 * part + 1) * loss**2, antiderivative=primitive)  # fmt: skip
    proof.where(sp.Gt(1 - 2 * eta * loss, 0), "a drop that comes out")
    lower = (1 - 2 * eta * loss) ** (part + sp.Rational(1, 2))
    proof.equal(sp.Subs(sp.Derivative(lower, eta), eta, 0), -slowed / loss,
                "as much less, as it comes from a lower energy")  # fmt: skip
    proof.define(deepest, ((power + 1) / (2 * factor)) ** (1 / (power + 1)), "the greatest depth")
    proof.define(force_at_top, factor * deepest**power, "the greatest force")
    elastic, left = factor * deep**power, 1 - 2 * factor * deep ** (power + 1) / (power + 1)
    primitive = sp.diff(elastic, deep) * left + elastic**2
    proof.integral(bending, sp.diff(elastic, deep, 2) * left, (deep, 0, deepest),
                   "less coming out, as the force is curved", value=force_at_top**2)  # fmt: skip
    proof.done(slowed, (2 * part + 1) * loss**2)


def _series(proof: Proof, family: str) -> None:
    """Prove the series of the square root of what is left."""
    eta = number
    proof.recall(f"{family}-second", slowed, bending)
    squared = 1 - 4 * eta * loss + eta**2 * (4 * slowed + bending)
    proof.define(restitution, sp.sqrt(squared), "from the energy that is left, to second order")
    proof.leading_order(1 - restitution, 2 * loss * eta, eta, 0, "what is lost")


for _shape, _family, _law, _euler, _values in (
    (
        "line",
        "F32",
        LINE,
        r"\Gamma(3/5) \Gamma(3/2)/\Gamma(21/10)",
        ("1.941177", "3.083547", "5/2"),
    ),
    (
        "ball",
        "F32-ball",
        BALL,
        r"\Gamma(2/3) \Gamma(3/2)/\Gamma(13/6)",
        ("1.937184", "3.360324", "3"),
    ),
):
    result(f"{_family}-loss", title=f"A drop of a {_shape}: what the dampers take",
           text=rf"""To first order in $\eta_{{\mathrm{{in}}}}$ the dampers take the energy
           $\eta_{{\mathrm{{in}}}} I_d$ going in, and as much coming out, which is the integral of $f_d'
           u_d$ over the depth, $u_d$ the speed without dampers. By Euler's integral $B_d(1) = {_euler}$.""",
           factor=_law[0], power=_law[1])(_loss)  # fmt: skip
    result(f"{_family}-second", title=f"A drop of a {_shape}: what the dampers take to second order",
           text=r"""$J_d$ is $I_d$ times the integral of $f_d'/u_d$, and $Q_d$ that of $f_d'' u_d^2$, over
           the depth. What the dampers take changes by $-\eta_{\mathrm{in}}^2 J_d$ in all, going in and coming
           out, because the drop is slower, and by another $-\eta_{\mathrm{in}}^2 J_d$ because it comes
           back from less deep; $f_d(d_d + \eta_{\mathrm{in}} v_d)$, expanded, saves
           $\eta_{\mathrm{in}}^2 Q_d/2$.""",
           family=_family, factor=_law[0], power=_law[1])(_second)  # fmt: skip
    result(f"{_family}-series",
           title=rf"A drop of a {_shape}: restitution for small $\eta_{{\mathrm{{in}}}}$",
           text=rf"""In numbers $e_{{\mathrm{{r}}}} = 1 - {_values[0]} \eta_{{\mathrm{{in}}}} + {_values[1]}
           \eta_{{\mathrm{{in}}}}^2$.
           Argued: The energy that the dampers take is expanded under the integral, also near the
           turning point, where $u_d$ vanishes. Of this are the terms in the root; that the contact ends at
           $d_d = \eta_{{\mathrm{{in}}}} e_{{\mathrm{{r}}}}$ and not at $d_d = 0$ matters from the order
           $\eta_{{\mathrm{{in}}}}^{{{_values[2]}}}$ on.""", family=_family)(_series)  # fmt: skip
