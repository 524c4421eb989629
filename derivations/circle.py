r"""The error of the parabola h = x**2/(2 R) for a true circle h = R - sqrt(R**2 - x**2).

With eps = (a/R)**2, where a = sqrt(2 R delta) belongs to the parabola, each quantity of steady sliding
is that of the parabola times 1 + c eps + O(eps**2). Shape and edges are analytic in eps, so that the
coefficients c follow from the first terms of the pressure and of the moving edges. What a circle of any depth
dissipates inside its contact has a closed form, by which the explorer computes its friction.
"""

from functools import partial

import sympy as sp

from .record import Derivation
from .step import Proof
from .symbols import (
    F_1,
    W_1,
    R,
    a,
    c_delta_load,
    c_f,
    c_mu,
    c_mu_load,
    c_w,
    circle_number,
    delta,
    eps,
    f,
    f_s,
    l,
    phi,
    q,
    s,
    slope_square,
    tilt,
    turning,
    turning_angle,
    w,
    x,
    xi,
)  # fmt: skip
from .theorems import (
    FRICTION_COEFFICIENT,
    FRICTION_FORCE,
    LOAD,
    NUMBER,
    RATIO,
    UNIT,
    A,
    B,
)

SECTION = "True circle"

CONTACT = (xi, -1, q)
PARABOLA = 1 - xi**2 - 2 * l * xi
"""p/(K delta) of the parabola at x = xi a."""
CORRECTION = -(xi**4) / 4 - l * xi**3
"""The addition by the fourth-order term of the circle, per eps."""
_shift = sp.Symbol("t", real=True)
EDGE = sp.Rational(1, 8)
"""The leading edge of the circle is at xi = -1 + eps/8 + O(eps**2)."""

LOAD_COEFFICIENT = -3 * q * (1 + (1 - q) * (1 - 3 * q * (1 - q))) / (20 * A)
FORCE_COEFFICIENT = 9 * (1 - q * (1 - q) * (1 + q**2)) / (10 * B)
LOADED_COEFFICIENT = sp.Rational(3, 10) * ((1 + q) * (3 * (1 - q) ** 2 + 2 * q) / B)

_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove the leading corrections for a true circle, and the integral of the square of its slope."""
    return _shape(), _fixed(), _dead_weight(), _steepness(), _peak()


def _shape() -> Derivation:
    proof = _theorem(
        "circle-shape",
        title="Shape and leading edge of a true circle",
        text=r"Scaled by $a$ and $\delta$ of the parabola, with $\varepsilon = (a/R)^2 = 2\delta/R$.",
    )
    circle = 2 * xi**2 / (1 + sp.sqrt(1 - eps * xi**2))
    edge = sp.sqrt(1 - eps / 4)
    proof.define(a, R * sp.sqrt(eps), r"$\varepsilon = (a/R)^2$")
    proof.recall("eq28", delta, a**2 / (2 * R))
    proof.where(eps * xi**2 < 1, "within the radius, $|x| < R$")
    proof.equal((R - sp.sqrt(R**2 - (xi * a) ** 2)) / delta, circle, r"$h/\delta$ of the circle")
    first = eps * xi**4 / 4
    proof.leading_order(circle - xi**2, first, eps, 0, "the difference to the parabola", eps=eps)
    reason = (
        r"$h = \delta$ where $(R - \delta)^2 = R^2 - x^2$: at $\xi = -\sqrt{1 - \varepsilon/4}$"
    )
    proof.equal((R - delta) ** 2, R**2 - (edge * a) ** 2, reason)
    proof.leading_order(1 - edge, EDGE * eps, eps, 0, "the leading edge recedes by", eps=eps)
    return proof.done(circle - xi**2, first)


def _fixed() -> Derivation:
    proof = _theorem(
        "circle-fixed",
        title="True circle at given depth",
        text=r"Load, friction force and friction coefficient are those of the parabola times $1 + c_W "
        r"\varepsilon$, $1 + c_F \varepsilon$ and $1 + c_\mu \varepsilon$, up to "
        r"$O(\varepsilon^2)$. The pressure vanishes at the trailing edge, whose shift therefore has "
        r"no effect to this order; at the leading edge it does not vanish.",
        uses=("circle-shape", "F16"),
    )
    proof.recall("scaling", l, NUMBER, RATIO)
    change = -(xi**4) / 4 - l * sp.Derivative(xi**4 / 4, xi)
    proof.equal(
        change, CORRECTION, r"$-h - l h'$ of the term that the circle adds, per $\varepsilon$"
    )
    proof.root(PARABOLA, xi, q, "no pressure at the trailing edge", over=(xi, 0, sp.oo))
    proof.sign(
        sp.diff(PARABOLA, xi).subs(xi, q), "<", 0, UNIT, "a simple zero: the edge is analytic"
    )
    proof.notation[r"\hat p"] = sp.Lambda(xi, PARABOLA)
    leading = PARABOLA.subs(xi, -1)
    proof.equal(leading, 2 * l, "pressure at the leading edge", left=r"\hat p(-1)")
    proof.recall("F1", w, LOAD)
    proof.recall("F1", phi, FRICTION_FORCE)
    moved = (xi, -1 + EDGE * eps, q + _shift * eps)
    slope = xi + eps * xi**3 / 2
    for total, weight, scale, coefficient, value, name in (
        (W_1, 1, w, c_w, LOAD_COEFFICIENT, "load"),
        (F_1, -slope, phi, c_f, FORCE_COEFFICIENT, "friction force"),
    ):
        density = sp.expand(weight * (PARABOLA + eps * CORRECTION))
        primitive = sp.integrate(density, xi)
        low, high = (sp.Subs(primitive, xi, end) for end in moved[1:])
        proof.integral(total, density, moved, primitive, _MOVED, value=high - low)
        per_eps = sp.Subs(sp.Derivative(total / scale, eps), eps, 0)
        proof.define(
            coefficient, per_eps, r"the change per $\varepsilon$, over that of the parabola"
        )
        proof.equal(coefficient, value, f"{name}: the shift $t$ of the trailing edge drops out")
    proof.sign(c_w, "<", 0, UNIT, "the circle carries less")
    proof.sign(c_f, ">", 0, UNIT, "and has more friction")
    proof.define(c_mu, c_f - c_w, r"$\mu = F/W$, a sum of positive terms")
    return proof.done(c_mu, c_f - c_w)


_MOVED = (
    r"between the edges of the circle, of which the trailing one is at $q + t \varepsilon$; terms of "
    r"order $\varepsilon^2$ are left out in the pressure and in the edges"
)


def _dead_weight() -> Derivation:
    proof = _theorem(
        "circle-dead-weight",
        title="True circle at given load",
        text=r"With $\varepsilon = (a/R)^2$ of the parabola at the same load and velocity, depth and "
        r"friction coefficient are those of the parabola times $1 + c_{\delta,W} \varepsilon$ and $1 + "
        r"c_{\mu,W} \varepsilon$, up to $O(\varepsilon^2)$: the depth adjusts until the load is the same.",
    )
    loading = 3 / A
    slipping = sp.diff(FRICTION_COEFFICIENT, q) / FRICTION_COEFFICIENT * NUMBER / sp.diff(NUMBER, q)
    slope = q * (1 + q) * ((2 - q) ** 2 + 3) / (A * B)
    proof.recall("balance", s * f_s / f, 6 / A)
    proof.recall("circle-fixed", c_w, LOAD_COEFFICIENT)
    proof.recall("circle-fixed", c_f, FORCE_COEFFICIENT)
    proof.recall("circle-fixed", c_mu, c_f - c_w)
    proof.equal(s * f_s / f / 2, loading, r"$d \ln W/d \ln \delta$ at fixed velocity")
    proof.define(c_delta_load, -c_w / loading, "depth: the load is kept")
    change = sp.Symbol("m_l", real=True)
    proof.define(change, slipping, r"$d \ln m/d \ln l$, by $q$")
    proof.equal(change, slope, "logarithmic slope of $m$")
    proof.define(c_mu_load, c_mu + c_delta_load * (1 - change) / 2, _CHAIN)
    proof.equal(c_mu_load, LOADED_COEFFICIENT, "friction coefficient")
    return proof.done(c_mu_load, LOADED_COEFFICIENT)


def _steepness() -> Derivation:
    proof = _theorem("circle-steepness", title="True circle: the square of its slope", text=_STEEP,
                     uses=("energy-any-shape",))  # fmt: skip
    y = sp.Symbol("y", nonnegative=True)
    place, size = R * y / sp.sqrt(1 + y**2), (1 + y**2) ** sp.Rational(3, 2)
    slope = x / sp.sqrt(R**2 - x**2)
    proof.equal(sp.Derivative(R - sp.sqrt(R**2 - x**2), x), slope, "slope of the circle")
    proof.equal(slope.subs(x, place), y, r"it is $y$ at $x = R y/\sqrt{1 + y^2}$")
    proof.equal(sp.Derivative(place, y), R / size, r"how $x$ grows with the slope")
    closed = sp.asinh(y) - y / sp.sqrt(1 + y**2)
    value = closed.subs(y, tilt)
    proof.integral(slope_square, y**2 / size, (y, 0, tilt), closed, _SQUARE, value=value)
    return proof.done(slope_square, value)


_STEEP = (
    r"$\frac{1}{R} \int h'^2\, dx$ from the lowest point to where the slope is $\hat h'$. The integrand is "
    "positive; where the slope is small the closed form cancels, and the integral does not."
)
_SQUARE = "the slope as variable"


def _peak() -> Derivation:
    proof = _theorem("circle-peak", title="True circle: peak pressure", text=_HIGHEST)
    y, root = sp.Symbol("y", positive=True), sp.sqrt(3)
    proof.where(y < 1, "within the radius")
    height, slope = 1 - sp.sqrt(1 - y**2), y / sp.sqrt(1 - y**2)
    rise = circle_number - y * (1 - y**2)
    proof.equal(sp.Derivative(circle_number * slope - height, y), rise / (1 - y**2) ** sp.Rational(3, 2),
                r"slope of $p/(K R)$ ahead of the lowest point, at $x = -R y$")  # fmt: skip
    proof.define(circle_number, 2 * sp.sin(3 * turning_angle) / (3 * root), _NUMBER)
    proof.define(turning, 2 * sp.sin(turning_angle) / root, "where the slope changes its sign")
    others = y**2 + turning * y + turning**2 - 1
    proof.equal(rise, (y - turning) * others, r"$\hat s$ is the smallest positive root")
    return proof.done(turning, 2 * sp.sin(turning_angle) / root)


_HIGHEST = (
    r"Ahead of the lowest point the pressure is $p = K [\delta - R (1 - \sqrt{1 - y^2}) + l_{\mathrm{r}} "
    r"y/\sqrt{1 - y^2}]$ at $x = -R y$. It rises up to $y = \hat s$, and again beyond the other positive "
    r"root: the peak is there or at the leading edge. For $\hat l > 2/(3 \sqrt{3})$ it rises all the way."
)
_NUMBER = (
    r"$\hat l = l_{\mathrm{r}}/R$, if $\hat l \le 2/(3 \sqrt{3})$, with $0 < \hat \theta \le "
    r"\frac{\pi}{6}$"
)
_CHAIN = r"$\mu = (a/R)\, m(l)$ with $a \propto \sqrt{\delta}$ and $l \propto 1/a$"
