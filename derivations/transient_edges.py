"""The two edges of the contact (F10): where they peel, where they touch, and where they turn.

An edge at xi = X + Y peels while it moves inward through the foundation and touches while it moves
outward: onto undisturbed ground, or onto ground that it left before and that still remembers it.
"""

from functools import partial

import sympy as sp

from .record import Derivation
from .step import Proof
from .symbols import (
    E,
    P,
    c,
    d,
    d_s,
    depth,
    drift,
    eta,
    lam,
    left,
    lift,
    material,
    rho,
    right,
    sigma,
    start,
    time,
    travel,
    xi,
    zeta,
)  # fmt: skip
from .transient_memory import OF_TIME, SECTION, SURFACE
from .transient_scaling import PRESSURE

RADICAND = d + d_s + lam**2
"""rho**2 of the edges that peel."""

_radius = sp.sqrt(lift + E * drift**2)
LEFT_AT_ONCE, RIGHT_AT_ONCE = -E * drift - _radius, -E * drift + _radius
"""Edges on ground that was left at one instant."""

_MOVING = {**OF_TIME, lam: sp.Derivative(travel, time)}
_d_0, _moved = sp.symbols("d_0 m", real=True)
_h = sp.Symbol("h", positive=True)
edge_path = sp.Function("X_e", real=True)(time)
"""The element at an edge of the contact."""
TOUCHING_PRESSURE = 2 * (xi - E * eta) * sp.Derivative(edge_path, time)
"""p/(K delta_0) at an edge that touches."""
_theorem = partial(Proof, equation=None, section=SECTION, notation={"g": SURFACE})


def derive() -> tuple[Derivation, ...]:
    """Prove F10."""
    return _peeling(), _touching(), _at_once(), _gradually(), _turning()


def _peeling() -> Derivation:
    proof = _theorem("F10-peel", title="Edges that peel", text=_PEEL, uses=("eq33",))
    proof.recall("scaled-pressure", P, PRESSURE)
    proof.define(rho, sp.sqrt(RADICAND))
    proof.equal(P, rho**2 - (xi + lam) ** 2, r"largest, $\rho^2$, at $\xi = -\lambda$")
    pressure = PRESSURE.subs(_MOVING).subs(xi, material + travel)
    radius = sp.sqrt(RADICAND).subs(_MOVING)
    proof.where(sp.Gt(radius**2, 0), "else no element can be pressed")
    for sign, name, edge in ((-1, "left", r"\ell"), (1, "right", "r")):
        position = sign * radius - sp.Derivative(travel, time) - travel
        loss = sp.diff(pressure, time).subs(material, position)
        moving = sign * radius - sp.Derivative(travel, time)
        proof.notation |= {
            edge: sp.Lambda(time, moving),
            r"\hat p": pressure,
            "Y": travel,
            "X": material,
        }
        proof.notation |= {r"\rho": radius, r"\lambda": sp.Derivative(travel, time)}
        side = (xi, -sp.oo, -lam) if sign < 0 else (xi, -lam, sp.oo)
        called = left if sign < 0 else right
        proof.root(P, xi, sign * rho - lam, f"{name} edge", over=side, name=called)
        proof.equal(
            *(loss, 2 * sign * radius * sp.Derivative(position, time), _LEAVES),
            left=rf"\left.\frac{{d\hat p}}{{ds}}\right|_{{X = {edge} - Y}}",
            right=rf"{2 * sign} \rho \left({edge}' - \lambda\right)",
        )
    return proof.done(right, rho - lam)


_LEAVES = "the element there loses its pressure while the edge moves inward"
_PEEL = (
    r"An edge peels where the pressure vanishes: Eq. (33) in scaled form. If $d + d' + \lambda^2 < 0$ "
    "no element can be pressed: the indenter has left the foundation."
)


def _touching() -> Derivation:
    proof = _theorem("F10-touch", title="Edges that touch", text=_TOUCH, uses=("F8", "F9", "eq32"))
    for sign, called, words in ((-1, left, "left"), (1, right, "right")):
        side = (xi, -sp.oo, 0) if sign < 0 else (xi, 0, sp.oo)
        ground = f"{words} edge on undisturbed ground"
        proof.root(d - xi**2, xi, sign * sp.sqrt(d), ground, over=side, name=called)
    now = depth - (material + travel) ** 2
    proof.notation |= {r"\hat p": PRESSURE.subs(_MOVING)}
    meeting = sp.exp(time) * now - sp.exp(sigma) * now.subs(time, sigma)
    condition = r"\left[e^{s} g(X, s) - e^{\sigma} g(X, \sigma)\right]"
    along = -2 * sp.exp(time) * (xi - E * eta)
    in_time = sp.exp(time) * PRESSURE.subs(_MOVING)
    proof.define(xi, material + travel)
    proof.define(eta, material + travel.subs(time, sigma), r"where the element was at $\sigma$")
    proof.define(E, sp.exp(sigma - time))
    proof.equal(
        *(sp.Derivative(meeting, material), along, "along the foundation"),
        left=rf"\frac{{\partial}}{{\partial X}} {condition}",
    )
    proof.equal(
        *(sp.Derivative(meeting, time), in_time, "in time"),
        left=rf"\frac{{\partial}}{{\partial s}} {condition}", right=r"e^{s} \hat p",
    )  # fmt: skip
    speed = sp.Derivative(edge_path, time)
    reason = r"the edge $X_{\mathrm{e}}(s)$ keeps both at zero"
    proof.notation[r"X_{\mathrm{e}}"] = edge_path
    proof.root(sp.exp(time) * P + along * speed, P, TOUCHING_PRESSURE, reason, right=_SPEED)
    return proof.done(P, TOUCHING_PRESSURE)


_SPEED = r"2 (\xi - E \eta) X_{\mathrm{e}}'"
_TOUCH = (
    r"An edge touches where the indenter meets the free surface, $g = u$: on undisturbed ground at $\xi "
    r"= \mp\sqrt{d}$ (Eq. 32), and on ground whose last contact was at $\sigma$ where $e^{s} g(X, s) = "
    r"e^{\sigma} g(X, \sigma)$. The pressure $\hat p$ at the edge is proportional to the velocity "
    r"$X_{\mathrm{e}}'$ of the edge through the foundation, and positive while it moves outward, because "
    r"$\xi - E \eta$ has the sign of the side (F9). On undisturbed ground $E = 0$. How $\sigma$ depends "
    r"on $X$ does not matter: either all of the ground was left at once, or each element when its "
    r"pressure, and with it $\partial(e^{\sigma} g)/\partial\sigma$, vanished."
)


def _at_once() -> Derivation:
    proof = _theorem(
        "F10-instant", title="Ground left at one instant", text=_INSTANT, uses=("F10-touch",)
    )
    left_then = d - xi**2 - E * (_d_0 - (xi - _moved) ** 2)
    quotient = (lift + E * (1 - E) * drift**2) / (E * drift + _radius)
    whole = (zeta, start, time)
    inner = depth.subs(time, zeta)
    growth = sp.exp(zeta) * (inner + sp.Derivative(inner, zeta))
    proof.integral(
        *(sp.Integral(growth, whole), growth, whole, sp.exp(zeta) * inner),
        r"hence $\bar d$ is the mean of $d + d'$ since $s_0$, weighted with $e^{\zeta}$",
        left=r"\int_{s_0}^{s} e^{\zeta} \left(d(\zeta) + d'(\zeta)\right) d\zeta",
        right=r"e^{s} d(s) - e^{s_0} d(s_0)",
        value=sp.exp(time) * depth - sp.exp(start) * depth.subs(time, start),
    )
    proof.define(lift, (d - E * _d_0) / (1 - E), "$d$ now, $d_0$ then")
    proof.define(drift, _moved / (1 - E), "$m = Y(s) - Y(s_0)$")
    middle = -E * drift
    proof.where(E < 1, "time has passed")
    proof.where(sp.Gt(lift + E * drift**2, 0), "else the indenter is above all of this ground")
    proof.root(left_then, xi, LEFT_AT_ONCE, "left edge", over=(xi, -sp.oo, middle), name=left)
    proof.root(left_then, xi, RIGHT_AT_ONCE, "right edge", over=(xi, middle, sp.oo), name=right)
    proof.where(drift > 0, "the foundation has moved on")
    proof.equal(RIGHT_AT_ONCE, quotient, "without a difference")
    return proof.done(right, RIGHT_AT_ONCE)


_INSTANT = (
    r"A jump of the drive at $s_0$ lets go of all ground between the old edge and the new one at once. "
    r"With $E = e^{-(s - s_0)}$ and $m$, the way since then, $g(X, s) = E g(X, s_0)$ is a quadratic in "
    r"$\xi$. For $s \to s_0$ the root tends to $-\lambda + \sqrt{d + d' + \lambda^2}$, at which the "
    r"edge peels after the jump; for $s \to \infty$ it tends to $\sqrt{d}$, undisturbed ground."
)


def _gradually() -> Derivation:
    proof = _theorem("F10-gradual", title="Ground left element by element", text=_GRADUAL,
                     uses=("F10-peel", "F10-touch"))  # fmt: skip
    element, was_depth, moved = (f.subs(time, sigma) for f in (edge_path, depth, travel))
    now, then = depth - (element + travel) ** 2, was_depth - (element + moved) ** 2
    meeting = sp.exp(time) * now - sp.exp(sigma) * then
    slope = -2 * sp.exp(time) * (xi - E * eta) * sp.Derivative(element, sigma)
    peeling = eta**2 + 2 * eta * sp.Derivative(moved, sigma) - was_depth
    proof.define(xi, element + travel, "where the element is now")
    proof.define(eta, element + moved, r"and where it was at $\sigma$")
    proof.define(E, sp.exp(sigma - time))
    proof.define(
        *(sp.Derivative(was_depth, sigma), peeling, r"no pressure there at $\sigma$"),
        left=r"d'(\sigma)", right=r"\eta^2 + 2 Y'(\sigma) \eta - d(\sigma)",
    )  # fmt: skip
    proof.equal(
        *(sp.Derivative(meeting, sigma), slope, "slope of this equation"),
        left=r"\frac{d}{d\sigma} \left[e^{s} g(X_{\mathrm{e}}(\sigma), s) - e^{\sigma} "
        r"g(X_{\mathrm{e}}(\sigma), \sigma)\right]",
        right=r"-2 e^{s} (\xi - E \eta) X_{\mathrm{e}}'(\sigma)",
    )
    return proof.done(sp.Derivative(meeting, sigma), slope)


_GRADUAL = (
    r"An edge that peeled at $\xi = \eta$ left the element $X_{\mathrm{e}}(\sigma)$ at $\sigma$. When it "
    r"comes back at $s$, it is where $e^{s} g(X_{\mathrm{e}}(\sigma), s) = e^{\sigma} "
    r"g(X_{\mathrm{e}}(\sigma), \sigma)$: one equation for $\sigma$. The difference of both sides is "
    "positive at the innermost of these elements and concave across them (F9), so that it vanishes at "
    "most once on the way outward."
)


def _turning() -> Derivation:
    proof = _theorem(
        "F10-turn", title="Where an edge turns", text=_TURN, uses=("F8", "F10-gradual")
    )
    peel = c * zeta**2 / 2
    lost = -2 * rho * (peel.subs(zeta, sigma) - peel)
    total = sp.Integral(lost, (zeta, sigma, _h))
    value = rho * c * (_h - sigma) ** 2 * (2 * sigma + _h) / 3
    reason = r"pressure since $\sigma$ on the element $X = c \sigma^2/2$, to leading order"
    proof.integral(
        *(total, lost, (zeta, sigma, _h), sp.integrate(lost, zeta), reason), value=value,
    )  # fmt: skip
    proof.root(value, sigma, -_h / 2, "left as long before the turn as half the time since",
               over=(sigma, -sp.oo, _h))  # fmt: skip
    at_root = sp.Subs(sp.Derivative(value, sigma), sigma, -_h / 2)
    proof.equal(at_root, 3 * rho * c * _h**2 / 2, "not zero: a simple root")
    quarter = peel.subs(zeta, _h) / 4
    proof.equal(sp.Subs(peel, zeta, -_h / 2), quarter, r"where the edge is: $X = c \sigma^2/2$",
                right=r"\frac{1}{4} \frac{c h^2}{2}")  # fmt: skip
    return proof.done(sp.Subs(peel, zeta, -_h / 2), quarter)


_TURN = (
    r"Let a right edge that peels stop moving inward at $s_0$. The zero of the pressure turns there: "
    r"counted from its turn it is at $X = c \zeta^2/2$ with $c > 0$, at the time $s_0 + \zeta$. The edge "
    r"itself then touches ground that it has just left, and follows with a quarter of the curvature, $X "
    r"= c h^2/8$ at $s_0 + h$. By F8 the pressure $e^{\zeta} \hat p$, which is $-2 \rho$ per distance to "
    r"its zero, must add up to nothing from $\sigma$ to $h$. The terms left out are smaller by a factor "
    r"$h$, so that they move the simple root by $O(h^2)$."
)
