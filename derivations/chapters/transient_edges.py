"""The two edges of the contact (F10): where they peel, where they touch, and where they turn.

An edge at xi = X + Y peels while it moves inward through the foundation and touches while it moves
outward: onto undisturbed ground, or onto ground that it left before and that has not yet recovered.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .contact_interval import E
from .model import u_i
from .tables import delta_0
from .theorems import lam
from .transient_memory import (
    CLEAR, OF_TIME, SECTION, compression, depth, earlier, eta, indenter, margin_of, material,
    pushed_by, sigma, time, travel, zeta,
)  # fmt: skip
from .transient_scaling import PRESSURE, P, d, d_s, xi

start, left, right, b, rho, drift, lift, c = symbols(r"""
    s_0         -               1  instant at which ground is left or an edge turns  real
    -           d_0             1  depth at an earlier instant or at the beginning of a step
    -           X_{\mathrm{e}}  1  element at an edge
    ell         -               1  scaled left edge of the contact  real
    right       r               1  scaled right edge of the contact  real
    b           -               1  scaled length of the contact, from edge to edge  from F11-peel
    rho         -               1  $\sqrt{d + d' + \lambda^2}$, which is $r + \lambda$ at an edge that
            peels
    lambda_bar  \bar\lambda     1  mean drive number since an earlier instant, weighted by memory  real
    d_bar       \bar d          1  mean depth since an earlier instant, weighted by memory  real
    c           -               1  rate at which an edge turns  prints c_{\mathrm{t}}
    -           \bar k_1        1  bounded factor of the remainder after the leading order
    -           \bar k_2        1  second bounded factor
    -           \bar k_3        1  third bounded factor
    -           \bar y          1  earlier instant over the time since the turn, $\bar \sigma/\Delta s$
""")

RADICAND = d + d_s + lam**2
"""rho**2 of the edges that peel."""

_radius = sp.sqrt(lift + E * drift**2)
LEFT_AT_ONCE, RIGHT_AT_ONCE = -E * drift - _radius, -E * drift + _radius
"""Edges on ground that was left at one instant."""

_MOVING = {**OF_TIME, lam: sp.Derivative(travel, time)}
_PRESSED_NOW = PRESSURE.subs(_MOVING).subs(xi, material + travel)
_d_0, _moved = sp.symbols("d_0 m", real=True)
_h, _ahead = sp.symbols("h k", positive=True)
MEETS = sp.exp(time) * (indenter(time) - compression(time))
"""Vanishes where the indenter meets the free surface."""
edge_path = sp.Function("X_e", real=True)(time)
"""The element at an edge of the contact."""
TOUCHING_PRESSURE = 2 * (xi - E * eta) * sp.Derivative(edge_path, time)
"""p/(K delta_0) at an edge that touches."""
result = Chapter(SECTION)


@result("F10-peel")
def _peeling(proof: Proof) -> None:
    r"""Edges that peel.

    An edge peels where the pressure vanishes: Eq. (33) in scaled form. If $d + d' + \lambda^2 < 0$ no element
    can be pressed: the indenter has left the foundation.
    """
    falls = (material + travel) ** 2 + 2 * (material + travel) * travel.diff(time) - depth
    proof.root(_PRESSED_NOW, depth.diff(time), falls, "of an element that has no pressure")
    proof.recall("scaled-pressure")
    proof.define(rho, sp.sqrt(RADICAND))
    proof.equal(P, rho**2 - (xi + lam) ** 2, r"largest, $\rho^2$, at $\xi = -\lambda$")
    for side, sign, name, called in (
        ((xi, -sp.oo, -lam), -1, "left", left), ((xi, -lam, sp.oo), 1, "right", right)
    ):  # fmt: skip
        proof.root(P, xi, sign * rho - lam, f"{name} edge", over=side, name=called)


@result("F10-inward")
def _inward(proof: Proof) -> None:
    r"""An edge that peels moves inward.

    The elements there must lose their pressure, which vanishes. A left edge is the mirror image.
    """
    for name, value in _MOVING.items():
        proof.define(name, value, "at every instant")
    proof.recall("F10-peel", rho, right)
    proof.where(sp.Gt(RADICAND, 0), "else no element can be pressed")
    rises = sp.Subs(sp.Derivative(_PRESSED_NOW, time), material, right - travel)
    reason = "the pressure falls while a right edge moves inward"
    proof.equal(rises, 2 * rho * sp.Derivative(right - travel, time), reason)


@result("F10-touch")
def _touching(proof: Proof) -> None:
    r"""Edges that touch.

    An edge touches where the indenter meets the free surface, $g = u$: on undisturbed ground at $\xi =
    \mp\sqrt{d}$ (compare Eq. 32), and on ground whose last contact was at $\sigma$ where $e^{s} g(X, s) =
    e^{\sigma} g(X, \sigma)$. The pressure $\hat p$ at the edge is proportional to the velocity
    $X_{\mathrm{e}}'$ of the edge through the foundation, and positive while it moves outward, because $\xi -
    E \eta$ has the sign of the side (F10-signs). On undisturbed ground $E = 0$. How $\sigma$ depends on $X$
    does not matter: either all of the ground was left at once, or each element when its pressure, and with it
    $\partial(e^{\sigma} g)/\partial\sigma$, vanished.
    """
    proof.recall("scaled-pressure", u_i / delta_0)
    for sign, called, words in ((-1, left, "left"), (1, right, "right")):
        side = (xi, -sp.oo, 0) if sign < 0 else (xi, 0, sp.oo)
        ground = f"{words} edge on undisturbed ground"
        proof.root(u_i / delta_0, xi, sign * sp.sqrt(d), ground, over=side, name=called)
    now = depth - (material + travel) ** 2
    along = -2 * sp.exp(time) * (xi - E * eta)
    proof.define(E, sp.exp(sigma - time), r"the decay since $\sigma$")
    proof.define(xi, material + travel, "where the element is")
    proof.define(_moved, travel - travel.subs(time, sigma), "how far it has moved")
    proof.define(d, depth, "the depth now")
    proof.define(_d_0, depth.subs(time, sigma), "and then")
    for place in (time, sigma):
        proof.define(indenter(place), now.subs(time, place), "the indenter at the element")
    proof.recall("F8")
    reason = "it vanishes where the surfaces meet"
    proof.equal(MEETS, sp.exp(time) * (d - xi**2 - E * (_d_0 - (xi - _moved) ** 2)), reason)
    proof.define(eta, material + travel.subs(time, sigma), r"and where it was at $\sigma$")
    proof.equal(sp.Derivative(MEETS, material), along, "along the foundation")
    in_time, speed = sp.Derivative(sp.exp(time) * now, time), sp.Derivative(edge_path, time)
    proof.recall("F8-update", in_time, reason="in time")
    reason = r"the edge $X_{\mathrm{e}}(s)$ keeps it at zero"
    proof.root(in_time + along * speed, P, TOUCHING_PRESSURE, reason)


@result("F10-signs")
def _signs(proof: Proof) -> None:
    r"""An edge that touches moves outward.

    In the foundation a right edge is at $X_{\mathrm{e}}$. Where it touches it moves outward, for its pressure
    is not negative. A left edge is the mirror image.
    """
    speed, at_left = sp.Derivative(edge_path, time), {material: material - b, earlier: sigma}
    margin = margin_of(material).subs(earlier, sigma)
    slope = material + travel - sp.exp(sigma - time) * (material + travel.subs(time, sigma))
    inside, bulge = sp.Symbol("D_2", real=True), (sp.exp(time) - sp.exp(sigma)) * b**2
    proof.define(inside, margin_of(material).subs(at_left), "$D(X - b)$, at the left edge")
    reason = r"$2 e^{s} b (\xi - E \eta) = D_2 - D(X) + (e^{s} - e^{\sigma}) b^2$; at a right edge $D(X) = 0$"
    proof.equal(2 * sp.exp(time) * b * slope, inside - margin + bulge, reason)
    proof.recall("F9", margin_of(material), at=at_left)
    pressed = (pushed_by()[0] - CLEAR).subs(earlier, sigma)
    proof.equal(inside, pressed, "not negative: there is contact, $\\bar c(s) = 0$")
    proof.where(time > sigma, "an earlier instant")
    proof.holds(bulge, ">", 0, r"and $D_2 \ge 0$, so that $\xi > E \eta$ there")
    proof.recall("F10-touch")
    proof.define(xi, E * eta + _ahead, "with $k > 0$")
    proof.equivalent(P, speed, sp.S.Zero, r"the same as $\hat p \ge 0$ at an edge that touches")


@result("F10-instant")
def _at_once(proof: Proof) -> None:
    r"""Ground left at one instant.

    A jump of the drive at $s_0$ detaches all ground between the old edge and the new one instantly. With $E =
    e^{-(s - s_0)}$ and $m$, the way since then, $g(X, s) = E g(X, s_0)$ is a quadratic in $\xi$.
    """
    quotient = (lift + E * (1 - E) * drift**2) / (E * drift + _radius)
    whole = (zeta, start, time)
    inner = depth.subs(time, zeta)
    growth = sp.exp(zeta) * (inner + sp.Derivative(inner, zeta))
    proof.integral(sp.Integral(growth, whole), growth, whole,
                   r"hence $\bar d$ is the mean of $d + d'$ since $s_0$, weighted with $e^{\zeta}$",
                   value=sp.exp(time) * depth - sp.exp(start) * depth.subs(time, start),
                   antiderivative=sp.exp(zeta) * inner)  # fmt: skip
    proof.define(lift, (d - E * _d_0) / (1 - E), "$d$ now, $d_0$ then")
    proof.define(drift, _moved / (1 - E), "$m = Y(s) - Y(s_0)$")
    proof.recall("F10-touch", MEETS, at={sigma: start})
    middle = -E * drift
    proof.where(E < 1, "time has passed")
    proof.where(sp.Gt(lift + E * drift**2, 0), "else the indenter is above all of this ground")
    proof.root(MEETS, xi, LEFT_AT_ONCE, "left edge", over=(xi, -sp.oo, middle), name=left)
    proof.root(MEETS, xi, RIGHT_AT_ONCE, "right edge", over=(xi, middle, sp.oo), name=right)
    proof.where(drift > 0, "the foundation has moved on")
    proof.equal(RIGHT_AT_ONCE, quotient, "without a difference")
    proof.done(right, RIGHT_AT_ONCE)


@result("F10-instant-limits")
def _soon_and_late(proof: Proof) -> None:
    r"""Ground left at one instant: early and late.

    The right edge $r(E, \bar d, \bar \lambda)$ of F10-instant is continuous. Soon after the jump the depth is
    $d + d' h$ and the way $\lambda h$, with $d$, $d'$ and $\lambda$ of the instant after it; long after it
    $E$ vanishes, and $m$ is what the way has been.
    """
    past, factor = 1 - sp.exp(-_h), _h / (1 - sp.exp(-_h))
    proof.leading_order(factor, sp.S.One, _h, 0, r"with $h = s - s_0$")
    proof.equal((d + d_s * _h - (1 - past) * d) / past, d + d_s * factor, r"$\bar d$ just after it")
    proof.leading_order((d - E * _d_0) / (1 - E), d, E, 0, r"$\bar d$ long after it")
    proof.leading_order(_moved / (1 - E), _moved, E, 0, r"$\bar \lambda$ long after it")
    proof.recall("F10-instant", "F10-peel", rho)
    means = E, lift, drift
    for ends, edge, words in (
        ((1, d + d_s, lam), rho - lam, "soon: it peels, as in F10-peel"),
        ((0, d, _moved), sp.sqrt(d), "late: as on undisturbed ground"),
    ):
        proof.equal(sp.Subs(right, means, ends), edge, words)


@result("F10-gradual", uses=("F10-touch",))
def _gradually(proof: Proof) -> None:
    r"""Ground left element by element.

    An edge that peeled at $\xi = \eta$ left the element $X_{\mathrm{e}}(\sigma)$ at $\sigma$. When it
    comes back at $s$, it is where $e^{s} g(X_{\mathrm{e}}(\sigma), s) = e^{\sigma}
    g(X_{\mathrm{e}}(\sigma), \sigma)$: one equation for $\sigma$.

    Argued: The difference of both sides is positive at the innermost of these elements and concave across
    them (F9), so that it vanishes at most once on the way outward.
    """
    element, was_depth, moved = (f.subs(time, sigma) for f in (edge_path, depth, travel))
    now, then = depth - (element + travel) ** 2, was_depth - (element + moved) ** 2
    meeting = sp.exp(time) * now - sp.exp(sigma) * then
    slope = -2 * sp.exp(time) * (xi - E * eta) * sp.Derivative(element, sigma)
    proof.define(xi, element + travel, "where the element is now")
    proof.define(eta, element + moved, r"and where it was at $\sigma$")
    proof.define(E, sp.exp(sigma - time))
    reason = r"no pressure there at $\sigma$"
    proof.recall("F10-peel", depth.diff(time), reason=reason, at={time: sigma, material: element})
    proof.equal(sp.Derivative(meeting, sigma), slope, "slope of this equation")


@result("F10-turn", uses=("F8", "F10-gradual"))
def _turning(proof: Proof) -> None:
    r"""Where an edge turns.

    Let a right edge that peels stop moving inward at $s_0$. The zero of the pressure turns there: counted
    from its turn it is at $X(\zeta) = \frac{c \zeta^2}{2} (1 + k_1 \zeta)$ with $c > 0$, at the time $s_0 +
    \zeta$, and the pressure $e^{\zeta} \hat p$ is $-2 \rho (1 + k_2 \zeta)$ per distance to it. The edge
    itself then touches ground that it has just left at $\sigma$: by F8 the pressure must add up to nothing
    from $\sigma$ to $h$. To leading order it does for $\sigma = -h/2$, and because this root is simple, for
    $\sigma = -h/2 + k_3 h^2$: the edge follows with a quarter of the curvature, whatever $k_1$, $k_2$ and
    $k_3$ are.
    """
    bend, drop, shift, y = sp.symbols("k_1 k_2 k_3 y", real=True)
    peel = c * zeta**2 / 2 * (1 + bend * zeta)
    lost = 2 * rho * (1 + drop * zeta) * (peel - peel.subs(zeta, sigma))
    since = (zeta, sigma, _h)
    width = _h - sigma
    value = rho * c * width**2 * (_h + 2 * sigma) / 3
    value += rho * c * bend * width**2 * (_h**2 + 2 * _h * sigma + 3 * sigma**2) / 4
    value += rho * c * drop * (_h**2 - sigma**2) ** 2 / 4
    powers = 2 * _h**3 + 4 * _h**2 * sigma + 6 * _h * sigma**2 + 3 * sigma**3
    value += rho * c * bend * drop * width**2 * powers / 10
    proof.integral(sp.Integral(lost, since), lost, since, "pressure since then", value=value)
    first = rho * c * _h**3 * (1 - y) ** 2 * (1 + 2 * y) / 3
    proof.leading_order(value.subs(sigma, y * _h), first, _h, 0, r"with $\sigma = y h$", short=True)
    proof.root(first, y, -sp.S.Half, "left as long before the turn as half the time since",
               over=(y, -sp.oo, 1))  # fmt: skip
    simple = sp.Subs(sp.Derivative(first, y), y, -sp.S.Half)
    proof.equal(simple, 3 * rho * c * _h**3 / 2, "not zero: a simple root")
    edge, quarter = peel.subs(zeta, -_h / 2 + shift * _h**2), c * _h**2 / 8
    proof.leading_order(edge, quarter, _h, 0, "where the edge is then", short=True)
