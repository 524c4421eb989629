r"""The shapes for which the contact is one interval under any motion: F9 beyond the parabola.

Let h be even, convex, h' > 0 for x > 0. The contact is one interval for every drive and every motion of
the indenter if ln h' is concave for x > 0, and for no other shape; a wedge of two slopes is a counterexample.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, letter, symbol
from ..engine.step import Proof
from .model import R
from .power_law import L, excess
from .transient_memory import (
    SECTION, compression, contact_condition, earlier, indenter, sigma, time, zeta,
)  # fmt: skip
from .wedge import inclination

letter(r"\bar k", r"relaxed depth less the present one, $E \bar d_1 - d$")
logarithm = function("psi", real=True)
E = symbol("E", "decay since an earlier instant")
travelled = symbol("m", "scaled displacement since an earlier instant", printed=r"\bar m")
letter(r"\bar d_1", "depth at an earlier instant, where $d$ is the present one")
letter(r"\bar f", r"$E\, h(\xi - \bar m) - h(\xi)$, relaxed earlier shape less the present one")
y = symbol("y", "distance from the lowest line, scaled", printed=r"\hat y")
letter(r"\hat y_1", "first of two scaled distances from the lowest line")
letter(r"\hat y_2", "second of two scaled distances from the lowest line")
slope_rate = function("chi", r"slope of the logarithm of $h'$, $(\ln h')'$", real=True)
ratio_gain = symbol("beta_1", "ratio of slopes in a counterexample", latex=r"\beta")
ratio_near = symbol("rho_1", "ratio of slopes at one position")
ratio_now = symbol("rho_2", "ratio of slopes at another position")

m = travelled
place = sp.Symbol("xi", real=True)
_h, (_now, _then) = sp.Function("h", real=True), sp.symbols("d d_1", real=True)
DIFFERENCE = sp.exp(time) * (_now - _h(place)) - sp.exp(earlier) * (_then - _h(place - m))
"""What decides about the contact of an element, for a shape h."""
_gain, _ahead = sp.symbols("J D", real=True)
_CASE = "It meets the condition of (F9-shapes): its contact is one interval."
result = Chapter(SECTION)


def _slope(place: sp.Expr) -> sp.Expr:
    """Return h' at a positive place, as exp(ln h')."""
    return sp.exp(logarithm(place))


def _height(place: sp.Expr) -> sp.Expr:
    """Return h at a positive place, the integral of h'."""
    return sp.Integral(_slope(zeta), (zeta, 0, place))


TURNING = sp.diff(_height(y) - E * _height(y + m), y)
"""f' ahead of the tip."""


@result("F9-difference")
def _condition(proof: Proof) -> None:
    r"""Contact condition from one past instant.

    An element is now at $\xi$, where the indenter is at $d - h(\xi)$; at $s_1 < s$ it was at $\xi - m$, and
    the indenter at $d_1 - h(\xi - m)$. Lengths, depths and $h$ may be scaled arbitrarily. As in (F9) the
    element is in contact if and only if $D_1 \ge 0$ for every past instant and $e^{s} (d - h) \ge u_0$, which
    is zero or the same difference for $s_1 = 0$; and $d \ge h(\xi)$ on one interval, because $h$ is even and
    convex.
    """
    E_then = E * _h(place - m)
    proof.define(E, sp.exp(earlier - time), "less than 1")
    form = sp.exp(time) * ((_now - E * _then) + (E_then - _h(place)))
    reason = r"$D_1$: a constant, and $f(\xi) = E h(\xi - m) - h(\xi)$"
    proof.equal(DIFFERENCE, form, reason)
    contact_condition(proof, _now - _h(place), _then - _h(place - m), DIFFERENCE)
    proof.done(DIFFERENCE, form)


@result("F9-shapes")
def _interval(proof: Proof) -> None:
    r"""The contact is one interval, for many shapes.

    Let $h$ be even and convex, $h' > 0$ and $\psi = \ln h'$ concave for $x > 0$. Let $m \ge 0$; motion in the
    other direction is the mirror image. From the tip on $f$ falls. Ahead of it, $\rho$ does not grow with
    $y$: going towards the tip $1 - E \rho$ can change its sign once only, from + to $-$.

    Argued: So $f$ rises to one place and falls beyond it, $D_1 \ge 0$ on one interval for each past
    instant, and intervals intersect in an interval, or not at all: the contact is described by two edges.
    Argued is also that a function which first rises and then falls is at or above a given value on an
    interval; that the integral of a non-positive function is not positive; and that where $h'$ or $\chi$
    has a kink, concavity itself, $\rho(y_2) \le \rho(y_1)$ for $y_2 > y_1$, takes the place of the
    integral.
    """
    relaxed = E * _h(place - m) - _h(place)
    proof.recall("F9-difference", E, "F9-difference")
    proof.equal(sp.Derivative(DIFFERENCE, place), sp.exp(time) * sp.Derivative(relaxed, place),
                "$D_1$ rises and falls with $f$")  # fmt: skip
    between = -_height(y) + E * _height(m - y)
    behind = -_height(y) + E * _height(y - m)
    ratio = sp.exp(logarithm(y + m) - logarithm(y))
    turning = _slope(y) * (1 - E * ratio)
    reason = (
        r"$f'(-y)$, ahead of the tip, with $\rho = h'(y + m)/h'(y) = e^{\psi(y + m) - \psi(y)}$"
    )
    proof.equal(TURNING, turning, reason)
    falling = _slope(y) + E * _slope(m - y)
    proof.equal(-sp.Derivative(between, y), falling, r"$-f'(y)$ at $0 < \xi = y < m$")
    proof.holds(falling, ">", 0, "so that $f$ falls there")
    convex = (1 - E) * _slope(y) + E * (_slope(y) - _slope(y - m))
    proof.equal(-sp.Derivative(behind, y), convex, r"$-f'(y)$ at $\xi = y > m$: the first term is not "
                "negative, because $h'$ does not fall, and the second is positive")  # fmt: skip
    rate = sp.Derivative(slope_rate(zeta), zeta)
    proof.integral(
        _gain,
        rate,
        (zeta, y, y + m),
        r"$J$ is the slope of $\ln \rho$, with $\chi = (\ln h')'$: not positive, as $\ln h'$ is concave",
        antiderivative=slope_rate(zeta),
    )
    proof.done(TURNING, turning)


def _shape(proof: Proof, slope: sp.Expr, rate: sp.Expr, gain: sp.Expr) -> None:
    """Prove that the slope of ln h' falls, and with it the ratio of slopes of F9-shapes."""
    proof.equal(sp.Derivative(sp.log(slope), y), rate, r"slope of $\ln h'$")
    for place in (y, y + m):
        proof.define(slope_rate(place), rate.subs(y, place), r"$\chi$ of F9-shapes")
    proof.recall("F9-shapes", _gain)
    proof.equal(_gain, gain, r"slope of $\ln \rho$")
    if gain != 0:
        proof.holds(gain, "<", 0, r"$\rho$ falls: $\ln h'$ is concave")
    proof.done(_gain, gain)


for _label, _name, _text, _rise, _rate, _form in (
    ("power", "every power law",
     r"$h = |x|^n/(n L^{n-1})$ with $n = 1 + \nu > 1$, the parabola among them.", (y / L) ** excess,
     excess / y, -excess * m / (y * (y + m))),
    ("catenary", "a catenary", r"$h = L (\cosh(x/L) - 1)$.", sp.sinh(y / L),
     sp.cosh(y / L) / (L * sp.sinh(y / L)),
     -sp.sinh(m / L) / (L * sp.sinh(y / L) * sp.sinh((y + m) / L))),
    (
        "wedge",
        "the wedge",
        r"$h = c\,|x|$: $\ln h'$ is constant, which concavity includes. That $h'$ jumps at the tip "
        "changes nothing: $f$ rises, or falls, on either side as before.",
        inclination,
        sp.S.Zero,
        sp.S.Zero,
    ),
):  # fmt: skip
    result(f"F9-{_label}", title=f"Concave logarithm of the slope: {_name}", text=f"{_text} {_CASE}",
           slope=_rise, rate=_rate, gain=_form)(_shape)  # fmt: skip


@result("F9-circle")
def _circle(proof: Proof) -> None:
    r"""Concave logarithm of the slope: a circle.

    $h = R - \sqrt{R^2 - x^2}$ meets the condition of (F9-shapes) for $|x| < R/\sqrt{3}$: the contact is one
    interval as long as no element is touched farther out, that is, up to a depth of $0.18 R$.
    """
    slope = y / sp.sqrt(R**2 - y**2)
    form = R**2 * (R**2 - 3 * y**2) / (y**2 * (R**2 - y**2) ** 2)
    curvature = -sp.Derivative(sp.log(y) - sp.log(R**2 - y**2) / 2, (y, 2))
    proof.where(y < R / sp.sqrt(3), "not on the outer part")
    proof.where(y < R, "which follows")
    proof.equal(sp.Derivative(R - sp.sqrt(R**2 - y**2), y), slope, "$h'$")
    proof.equal(curvature, form, r"$-(\ln h')''$")
    proof.holds(form, ">", 0, r"$\ln h'$ is concave")
    proof.done(curvature, form)


@result("F9-converse")
def _converse(proof: Proof) -> None:
    r"""Necessary condition for a single contact.

    If $\ln h'$ is not concave, some $\rho(y_2) = h'(y_2 + m)/h'(y_2)$ is greater than $\rho(y_1)$ with
    $y_1 < y_2$. Let the indenter rest at a depth $d_1$, be lifted, be moved by $m$ while $e^{s}$ grows to
    $1/E$, and be set down instantly to $d = E d_1 - k$. Elements are in contact where $f \ge k$ and $d
    \ge h$.

    Argued: With $k$ between the bottom of the valley and its lower rim, and $d_1$ so large that all of
    these elements were compressed, the contact consists of two parts, one on each side of the valley.
    """
    middle = 2 / (ratio_near + ratio_now)
    gain = ratio_gain / (2 * ratio_near + ratio_gain)
    proof.define(
        ratio_now, ratio_near + ratio_gain, r"$\rho(y_2) > \rho(y_1)$ for some $y_2 > y_1$ and $m$"
    )
    proof.define(E, middle, "a time that has passed; less than 1, because $h'$ does not fall")
    for sign, ratio, spot, what in (
        (1, ratio_near, "y_1", r"$f$ rises at $-y_1$"),
        (-1, ratio_now, "y_2", r"it falls at $-y_2$, farther out"),
    ):  # fmt: skip
        there = sp.Symbol(spot, positive=True)
        proof.define(
            logarithm(there + m), logarithm(there) + sp.log(ratio), rf"$\rho({spot})$ in logarithms"
        )
        proof.recall("F9-shapes", at={y: there})
        turns, slope = TURNING.subs(y, there), _slope(there)
        proof.equal(sign * turns, slope * gain, what)
    proof.holds(gain, ">", 0, "so that between them $f$ has a valley")
    proof.done(E, middle)


@result("F9-two-slopes")
def _two_slopes(proof: Proof) -> None:
    r"""Two contacts: a wedge of two slopes.

    The wedge $h = |x| + 3 \max(0, |x| - 1)$ is even and convex, but $\ln h'$ jumps up at $|x| = 1$. It rests
    at the depth 4, is lifted, moved by $m = \frac{1}{2}$ during $s = \ln 2$, and set down instantly to
    $\frac{15}{8}$. By F8 the surface at $\xi$ is then at $u = \frac{1}{2} \left[4 - h(\xi -
    \frac{1}{2})\right]$, and the indenter at $g = \frac{15}{8} - h(\xi)$: the contact is $[-\frac{19}{16},
    -\frac{5}{8}]$ and $[-\frac{1}{4}, \frac{1}{12}]$. (While it is being set down the indenter has pressed no
    element farther than in the end.)
    """
    half = sp.Rational(1, 2)

    def height(place: sp.Expr) -> sp.Expr:
        return sp.Abs(place) + 3 * sp.Max(0, sp.Abs(place) - 1)

    later = sp.log(2)
    proof.define(indenter(sp.S.Zero), 4 - height(place - half), "at rest")
    proof.recall("F8", at={sigma: sp.S.Zero, time: later})
    proof.define(_ahead, sp.Rational(15, 8) - height(place) - compression(later),
                 "how far it is below the surface")  # fmt: skip
    for spot, value, what in (
        (-1, "3/8", "in contact"), (-half, "-1/8", "free: the surface is still lower"),
        (0, "1/8", "in contact again"),
        ("-19/16", 0, "left edge of one contact"), ("-5/8", 0, "its right edge"),
        ("-1/4", 0, "left edge of the other"), ("1/12", 0, "its right edge"),
    ):  # fmt: skip
        proof.equal(sp.Subs(_ahead, place, sp.Rational(spot)), sp.Rational(value), what)
    proof.done(sp.Subs(_ahead, place, -half), -sp.Rational(1, 8))
