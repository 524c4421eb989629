r"""The strips of a ball: what the trapezoidal rule over them lacks at the rim of the contact (F20).

Strips are a distance Delta apart, in units of the half width; the first inside is vartheta Delta from the
rim. The force of a strip at the distance y from the rim begins as p_1 y + p_2 y^(3/2).
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbol
from ..engine.step import Proof
from .element_schemes import SECTION
from .friction_identity import r
from .model import K, delta
from .steady import W, a, l, l_r

letter(r"\Delta y", "spacing of the strips of a ball, in units of its half width")
letter(r"y_{\mathrm{s}}", "distance from the rim of a ball, in units of its half width")
letter(r"\breve \psi", r"square root of $y_{\mathrm{s}}$")
letter(r"v_{\mathrm{s}}", "distance of a strip from the rim, in spacings")
letter(r"x_{\mathrm{s}}", "distance from that strip inward, in spacings")
letter(r"Q_{\mathrm{s}}", "error of the trapezoidal rule between two strips")
letter(r"\zeta_{\mathrm{H}}", "zeta function of Hurwitz")
letter(r"\breve p_1", r"slope of a strip's load over $y_{\mathrm{s}}$ at the rim")
letter(r"\breve p_2", r"coefficient of $y_{\mathrm{s}}^{3/2}$ in the load near the rim")

middle = symbol("a_m", "half length of the contact of a ball", "m", r"a_{\mathrm{m}}")
_spacing, _share, _y, _v, _x, _root = sp.symbols("Delta vartheta y v x psi", positive=True)
_rest = sp.Symbol("Q", real=True)
result = Chapter(SECTION)

POWER = sp.Rational(3, 2)
BERNOULLI = _share**2 - _share + sp.Rational(1, 6)
"""B_2, to which the correction of the last strip but one is due."""
SECOND = BERNOULLI * sp.sqrt(1 + _share) / 2
"""What the correction adds of y^(3/2), in units of Delta^(5/2)."""
START = _v**POWER / 2 - 2 * _v ** sp.Rational(5, 2) / 5 - sp.sqrt(_v) / 8
"""Half of the first strip, without what lies before it and with the slope at which trapezoids begin."""


@result("strips-rim")
def _rim(proof: Proof) -> None:
    r"""Strips at the rim of a ball.

    The strip at the distance $\psi^2$ from the rim, in units of the half width, carries this load, in the
    units $K \delta a$ of the middle strip (compare F20-load). It begins in proportion to the distance, at
    rest with its power $\frac{3}{2}$, and goes on in powers of $\psi$.

    Argued: Its contact is as long as an element where $\psi$ is of the order of $\Delta$ over the half
    length: strips nearer to the rim carry the order of $\Delta^4$, and by element-bent all others are wrong
    by the order of $\Delta^2$. So is a ball, whatever the spacing of its strips.
    """
    width = _root**2 * (2 - _root**2)
    proof.where(2 - _root**2 > 0, "on this side of the opposite rim")
    load = sp.Rational(2, 3) * (width**POWER + (width + l**2) ** POWER - l**3)
    proof.recall("F21-load", r, W)
    proof.define(a, middle * sp.sqrt(width), "half length of the strip")
    proof.define(l_r, middle * l, "the same for all strips")
    proof.recall("eq28", delta)
    own = W / (K * delta * a)
    proof.equal(own * width**POWER, load, r"F21-load; $\delta$ and $a$ are those of the strip")
    proof.leading_order(load, 2 * l * _root**2, _root, 0, "in sliding")
    at_rest, begun = sp.Rational(4, 3) * width**POWER, 8 * sp.sqrt(2) / 3 * _root**3
    proof.leading_order(at_rest, begun, _root, 0, "at rest, $l = 0$")
    over, line = (_y, 0, _root**2), 2 * l * _y
    proof.integral(sp.Integral(line, over), line, over,
                   "what all strips nearer to the rim carry, in sliding", value=l * _root**4)  # fmt: skip
    proof.done(load, 2 * l * _root**2)


@result("strips-rule", uses=("strips-rim", "element-trapezoids"))
def _rule(proof: Proof) -> None:
    r"""Order of the rule over the strips of a ball.

    Strips are $\Delta$ apart, the first at $\vartheta \Delta$ from the rim, $0 < \vartheta \le 1$, and
    the load begins as $p_1 y + p_2 y^{3/2}$. The error of the trapezoidal rule is due to the rim alone,
    since the load is even about the middle plane. For $y^{3/2}$ it is, in units of $\Delta^{5/2}$,
    $\frac{1}{2} \vartheta^{3/2} - \frac{2}{5} \vartheta^{5/2} - \frac{1}{8} \vartheta^{1/2} - \sum_{j \ge 0}
    Q(\vartheta + j)$, where $Q$ makes the sum converge.

    Argued: This solves the last equation, as Hurwitz's $\zeta_{\mathrm{H}}(-\frac{3}{2}, \vartheta)$
    does; their difference has period 1 and vanishes for large $\vartheta$, so that they are equal.
    With the correction, the error of the rule over strips is $p_2 \Delta^{5/2} [\zeta_{\mathrm{H}}(
    -\frac{3}{2}, \vartheta) + \frac{1}{2} (\vartheta^2 - \vartheta + \frac{1}{6}) \sqrt{1 + \vartheta}]$ and
    terms of the order of $\Delta^3$: its order is $\frac{5}{2}$.
    """
    over = (_y, 0, _share * _spacing)
    line = sp.Integral(_y, over)
    begun = _share**2 * _spacing**2 / 2
    proof.integral(line, _y, over, "before the first strip", value=begun)
    surplus = _share * _spacing**2 / 2 - _spacing**2 / 12 - line
    lacks = -(_spacing**2) * BERNOULLI / 2
    proof.equal(surplus, lacks, r"error of the rule for the load $y$")
    second = _spacing * BERNOULLI / (2 * (1 + _share))
    reason = "with a larger weight of the second strip no error is left"
    proof.equal(lacks + second * (1 + _share) * _spacing, 0, reason)
    grown = second * ((1 + _share) * _spacing) ** POWER
    proof.equal(grown, _spacing ** (POWER + 1) * SECOND, r"the same for the load $y^{3/2}$")
    _cell(proof)
    later = START.subs(_v, _v + 1)
    proof.equal(START - later - _rest, _v**POWER,
                r"the difference equation of $\zeta_{\mathrm{H}}(-\frac{3}{2}, v)$")  # fmt: skip


_MORE = r"\frac{\Delta (\vartheta^2 - \vartheta + \frac{1}{6})}{2 (1 + \vartheta)}"


def _cell(proof: Proof) -> None:
    """Prove the error of the trapezoidal rule for y^(3/2) from one strip to the next, with Delta = 1."""
    over, u = (_x, 0, 1), (_v + _x) ** POWER
    kernel = _x**2 * (1 - _x) ** 2 / 24
    integrand = kernel * sp.diff(u, _x, 4)
    primitive = sum(
        (-1) ** order * sp.diff(kernel, _x, order) * sp.diff(u, _x, 3 - order) for order in range(4)
    ) + sp.Rational(2, 5) * (_v + _x) ** sp.Rational(5, 2)
    value = START - START.subs(_v, _v + 1) - _v**POWER
    proof.holds(integrand, ">=", 0, "of the error between two strips, by element-trapezoids")
    proof.integral(_rest, integrand, over, "by parts, four times", value=value,
                   antiderivative=primitive)  # fmt: skip
    proof.equal(sp.Subs(value, _v, 0), sp.Rational(1, 40), "its greatest value: it falls with $v$")
    least = 9 * kernel / 16
    proof.integral(sp.Integral(least, over), least, over, r"so that $Q < \frac{1}{1280} v^{-5/2}$",
                   value=sp.Rational(1, 1280))  # fmt: skip
