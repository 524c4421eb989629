r"""The error of the parabola h = x**2/(2 R) for a true circle h = R - sqrt(R**2 - x**2).

With eps = (a/R)**2, where a = sqrt(2 R delta) belongs to the parabola, each quantity of steady sliding
is that of the parabola times 1 + c eps + O(eps**2). Shape and edges are analytic in eps, so that the
coefficients c follow from the first terms of the pressure and of the moving edges. What a circle of any depth
dissipates inside its contact has a closed form, by which the explorer computes its friction.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .model import R, delta, x
from .steady import a, l, q
from .theorems import (
    UNIT, A, B, f, f_s, m, phi, s, w, xi,
)  # fmt: skip

(
    eps, steeper, recedes, W_1, F_1, c_w, c_f, c_mu, deeper, c_delta_load, c_mu_load, tilt, circle_number,
    turning, turning_angle, slope_square,
) = symbols(r"""
    epsilon     \varepsilon   1  $(a/R)^2$ of a true circle  prints \gamma
    h_circle    \hat h_1      1  height that a circle adds to the parabola, over the depth, to first order
    e_circle    \hat e        1  by which its leading edge recedes, over the half length, to first order
    W_1         -             1  first-order change of the scaled load by the circle  real
    F_1         -             1  first-order change of the scaled friction force by the circle  real
    c_W         -             1  coefficient of the circle in the load  real
    c_F         -             1  coefficient of the circle in the friction force  real
    c_mu        -             1  coefficient of the circle in the friction coefficient  real
    c_delta     c_\delta      1  change of the depth, over $\varepsilon$  real
    c_delta_W   c_{\delta,W}  1  coefficient of the circle in the depth at given load  real
    c_mu_W      c_{\mu,W}     1  coefficient of the circle in the friction coefficient at given load  real
    -           \hat h        1  height of a true circle over $R$
    slope       \hat h'       1  -
    -           \hat v        1  slope of a true circle
    v_c         \hat l        1  $l_{\mathrm{r}}/R$ of a true circle
    s_c         \hat s        1  $-x/R$ at the peak pressure of a true circle
    angle       \hat \theta   1  angle that gives $\hat s$
    slope_square  \hat S        1  integral of $h'^2$ over a contact, over $R$  real
    -           \hat t        1  shift of the trailing edge of a circle, over $\gamma a$
    -           m_l           1  logarithmic slope of $m$ over $l$
""")  # fmt: skip


CONTACT = (xi, -1, q)
PARABOLA = 1 - xi**2 - 2 * l * xi
"""p/(K delta) of the parabola at x = xi a."""
CORRECTION = -(xi**4) / 4 - l * xi**3
"""The addition by the fourth-order term of the circle, per eps."""
_shift = sp.Symbol("t", real=True)
STEEPER = 2 * xi**2 / (1 + sp.sqrt(1 - eps * xi**2)) - xi**2
"""By which the circle is higher than the parabola, over the depth."""
RECEDES = 1 - sp.sqrt(1 - eps / 4)
"""By which its leading edge is behind that of the parabola, over the half length."""

LOAD_COEFFICIENT = -3 * q * (1 + (1 - q) * (1 - 3 * q * (1 - q))) / (20 * A)
FORCE_COEFFICIENT = 9 * (1 - q * (1 - q) * (1 + q**2)) / (10 * B)
LOADED_COEFFICIENT = sp.Rational(3, 10) * ((1 + q) * (3 * (1 - q) ** 2 + 2 * q) / B)

result = Chapter("True circle")


@result("circle-shape")
def _shape(proof: Proof) -> None:
    r"""Shape and leading edge of a true circle.

    Scaled by $a$ and $\delta$ of the parabola, with $\varepsilon = (a/R)^2 = 2\delta/R$.
    """
    first = eps * xi**4 / 4
    proof.leading_order(STEEPER, first, eps, 0, "by this the circle is higher than the parabola")
    proof.leading_order(RECEDES, eps / 8, eps, 0, "and by this its leading edge recedes")
    proof.define(a, R * sp.sqrt(eps), r"$\varepsilon = (a/R)^2$")
    proof.recall("eq28", delta)
    proof.where(eps * xi**2 < 1, "within the radius, $|x| < R$")
    proof.equal(
        (R - sp.sqrt(R**2 - (xi * a) ** 2)) / delta, xi**2 + STEEPER, r"$h/\delta$ of a circle"
    )
    reason = (
        r"$h = \delta$ where $(R - \delta)^2 = R^2 - x^2$: at $\xi = -\sqrt{1 - \varepsilon/4}$"
    )
    proof.equal((R - delta) ** 2, R**2 - ((1 - RECEDES) * a) ** 2, reason)
    proof.done(STEEPER, first)


@result("circle-fixed")
def _fixed(proof: Proof) -> None:
    r"""True circle at given depth.

    Load, friction force and friction coefficient are those of the parabola times $1 + c_W \varepsilon$, $1 +
    c_F \varepsilon$ and $1 + c_\mu \varepsilon$, up to $O(\varepsilon^2)$. The pressure vanishes at the
    trailing edge, whose shift therefore has no effect to this order; at the leading edge it does not vanish.
    """
    proof.recall("scaling")
    proof.asymptote("circle-shape", STEEPER, steeper, "the height that the circle adds")
    proof.asymptote("circle-shape", RECEDES, recedes, "by which its leading edge recedes")
    change = -steeper - l * sp.Derivative(steeper, xi)
    proof.equal(change, eps * CORRECTION, "what it adds to the pressure")
    proof.root(PARABOLA, xi, q, "no pressure at the trailing edge", over=(xi, 0, sp.oo))
    proof.sign(sp.diff(PARABOLA, xi).subs(xi, q), "<", 0, UNIT, "simple zero: the edge is analytic")
    proof.equal(sp.Subs(PARABOLA, xi, -1), 2 * l, "pressure at the leading edge")
    proof.recall("F1", w, phi)
    moved = (xi, -1 + recedes, q + _shift * eps)
    slope = sp.Derivative(xi**2 + steeper, xi) / 2
    for total, weight, scale, coefficient, value, name in (
        (W_1, 1, w, c_w, LOAD_COEFFICIENT, "load"),
        (F_1, -slope, phi, c_f, FORCE_COEFFICIENT, "friction force"),
    ):
        density = weight * (PARABOLA + change)
        known = density.xreplace({steeper: eps * xi**4 / 4}).doit()
        primitive = sp.integrate(sp.expand(known), xi)
        low, high = (sp.Subs(primitive, xi, end) for end in moved[1:])
        proof.integral(total, density, moved, _MOVED, value=high - low, antiderivative=primitive)
        proof.define(coefficient, _per_eps(total / scale),
                     r"the change per $\varepsilon$, over that of the parabola")  # fmt: skip
        proof.equal(coefficient, value, f"{name}: the shift $t$ of the trailing edge drops out")
    proof.sign(c_w, "<", 0, UNIT, "the circle carries less")
    proof.sign(c_f, ">", 0, UNIT, "and has more friction")
    proof.define(c_mu, c_f - c_w, r"$\mu = F/W$, a sum of positive terms")


_MOVED = (
    r"between the edges of the circle, of which the trailing one is at $q + t \varepsilon$; terms of "
    r"order $\varepsilon^2$ are left out in the pressure and in the edges"
)


@result("circle-dead-weight")
def _dead_weight(proof: Proof) -> None:
    r"""True circle at given load.

    With $\varepsilon = (a/R)^2$ of the parabola at the same load and velocity, depth and friction coefficient
    change by $c_{\delta,W} \varepsilon$ and $c_{\mu,W} \varepsilon$ of themselves, to first order in
    $\varepsilon$.
    """
    change = sp.Symbol("m_l", real=True)
    slipping = l * sp.Derivative(m, q) / sp.Derivative(l, q) / m
    proof.recall("scaling", l, "F1", m, "balance", s * f_s / f, "circle-fixed", c_w, c_f,
                 "circle-fixed")  # fmt: skip
    kept = c_w + s * f_s / f / 2 * deeper
    reason = r"with the depth $1 + c_\delta \varepsilon$ the load is kept, to first order"
    proof.root(kept, deeper, -c_w * A / 3, reason, name=c_delta_load)
    proof.define(change, slipping, r"$\mathrm{d} \ln m/\mathrm{d} \ln l$, by $q$")
    proof.equal(change, q * (1 + q) * ((2 - q) ** 2 + 3) / (A * B), "logarithmic slope of $m$")
    reason = r"chain rule: $\mu = (a/R)\, m(l)$ with $a \propto \sqrt{\delta}$ and $l \propto 1/a$"
    proof.define(c_mu_load, c_mu + c_delta_load * (1 - change) / 2, reason)
    proof.equal(c_mu_load, LOADED_COEFFICIENT, "friction coefficient")


def _per_eps(form: sp.Expr) -> sp.Expr:
    """Return the first change with the circle."""
    return sp.Subs(sp.Derivative(form, eps), eps, 0)


@result("circle-steepness")
def _steepness(proof: Proof) -> None:
    r"""True circle: the square of its slope.

    $\frac{1}{R} \int h'^2\, dx$ from the lowest point to where the slope is $\hat h'$. The integrand is
    positive; where the slope is small the closed form cancels, and the integral does not.
    """
    y = sp.Symbol("y", nonnegative=True)
    place, size = R * y / sp.sqrt(1 + y**2), (1 + y**2) ** sp.Rational(3, 2)
    slope = x / sp.sqrt(R**2 - x**2)
    proof.equal(sp.Derivative(R - sp.sqrt(R**2 - x**2), x), slope, "slope of the circle")
    proof.equal(slope.subs(x, place), y, r"it is $y$ at $x = R y/\sqrt{1 + y^2}$")
    proof.equal(sp.Derivative(place, y), R / size, r"how $x$ grows with the slope")
    closed = sp.asinh(y) - y / sp.sqrt(1 + y**2)
    value = closed.subs(y, tilt)
    proof.integral(slope_square, y**2 / size, (y, 0, tilt), _SQUARE, value=value,
                   antiderivative=closed)  # fmt: skip


_SQUARE = "the slope as variable"


@result("circle-peak")
def _peak(proof: Proof) -> None:
    r"""True circle: peak pressure.

    Ahead of the lowest point the pressure is $p = K [\delta - R (1 - \sqrt{1 - y^2}) + l_{\mathrm{r}}
    y/\sqrt{1 - y^2}]$ at $x = -R y$. It rises up to $y = \hat s$, and again beyond the other positive root:
    the peak is there or at the leading edge. For $\hat l > 2/(3 \sqrt{3})$ it rises all the way.
    """
    y, root = sp.Symbol("y", positive=True), sp.sqrt(3)
    proof.where(y < 1, "within the radius")
    height, slope = 1 - sp.sqrt(1 - y**2), y / sp.sqrt(1 - y**2)
    rise = circle_number - y * (1 - y**2)
    proof.equal(sp.Derivative(circle_number * slope - height, y), rise / (1 - y**2) ** sp.Rational(3, 2),
                r"slope of $p/(K R)$ ahead of the lowest point, at $x = -R y$")  # fmt: skip
    proof.where(turning_angle < sp.pi / 6, r"for $\hat l < 2/(3 \sqrt{3})$")
    proof.define(
        circle_number, 2 * sp.sin(3 * turning_angle) / (3 * root), r"$\hat l = l_{\mathrm{r}}/R$"
    )
    proof.define(turning, 2 * sp.sin(turning_angle) / root, "where the slope changes its sign")
    others = y**2 + turning * y + turning**2 - 1
    proof.equal(rise, (y - turning) * others, r"$\hat s$ is the smallest positive root")
    proof.done(turning, 2 * sp.sin(turning_angle) / root)
