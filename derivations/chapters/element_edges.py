"""The error of point elements at an edge, and its correction by parts of elements (F15).

Elements are a distance Delta apart. The default scheme of the simulator, "edge-corrected", adds `KINK`
and `END` at each edge to the area of the compression; forces are reported by trapezoids up to the edges.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbols
from ..engine.step import Proof
from .element_schemes import SECTION
from .model import C, V, x

letter("x_k", "position of an element behind the leading edge", "m")
letter(r"\vartheta",
       "position of an edge between two elements, or of a rim between two strips, in spacings",
       source="F15-sawtooth")  # fmt: skip
letter(r"m_{\mathrm{k}}", "slope difference of two surfaces where they meet")
letter(r"\hat w_0", "depth of the indenter below the free surface at the last element outside", "m")
letter(r"\hat w_1", "depth of the indenter below the free surface at the first element inside", "m")
letter(r"\hat w", "depth of the indenter below the free surface along an element", "m")
letter(r"\hat w_2", r"second derivative of $\hat w$", "1/m")
letter(r"f_\Delta", "excess of the sum over elements", "N/m")

_slope, _spacing, _share = sp.symbols("m Delta vartheta", positive=True)
_inside, _outside = sp.Symbol("w_1", positive=True), sp.Symbol("w_0", negative=True)
_surplus, _bend = sp.symbols("f_Delta w_2", real=True)
_end, _rise = sp.symbols("p_e p_s", real=True)
_u = sp.Function("u", real=True)
added, begins, lacks = symbols(r"""
    a_s  a_{\mathrm{s}}  m²  what the scheme adds at an edge  real
    m_t  m_{\mathrm{t}}  1   slope of the compression where trapezoids begin  real
    e_t  e_{\mathrm{t}}  m²  what trapezoids lack because of the slope where they begin  real
""")
result = Chapter(SECTION)

KINK = _spacing * _inside * _outside / (2 * (_inside - _outside))
"""The area missed by the chord over a kink."""
END = _spacing * (_inside - _outside) / 12
"""The area missed by trapezoids where the surface has the slope of the indenter immediately."""


@result("F15-sawtooth")
def _sawtooth(proof: Proof) -> None:
    r"""Noise of elements entering the contact.

    The pressure jumps to $p_e$ at the leading edge and changes from there as $p_e + p_s x$; elements are at
    $x_k = (k + \vartheta) \Delta$, $0 \le \vartheta \le 1$. Each represents the length $\Delta$ around it,
    with the exact integral of a straight line, so that the sum begins at $(\vartheta - \frac{1}{2}) \Delta$
    instead of 0. As elements enter, the normal force has a sawtooth of $\pm p_e \Delta/2$, and the friction
    force one of that times $-h'$: first order in the spacing. The edge-corrected scheme reports forces by
    trapezoids up to the edge.
    """
    first = (_share - sp.Rational(1, 2)) * _spacing
    line = _end + _rise * x
    missed = -(_end * first + _rise * first**2 / 2)
    proof.integral(_surplus, line, (x, first, 0), "the excess of the sum over elements",
                   value=missed)  # fmt: skip
    largest = _end * _spacing / 2 - _rise * _spacing**2 / 8
    just_in, about_to = (sp.Subs(missed, _share, place) for place in (0, 1))
    proof.equal(just_in, largest, r"an element has just entered, $\vartheta = 0$")
    proof.equal(about_to, -_end * _spacing / 2 - _rise * _spacing**2 / 8,
                r"the next one is about to enter, $\vartheta = 1$")  # fmt: skip
    inside = _end + _rise * _share * _spacing
    mended = missed + _spacing * (_share * (inside + _end) - inside) / 2
    reason = "with a trapezoid up to the edge for half of the first element: no sawtooth"
    proof.equal(mended, -_rise * _spacing**2 / 8, reason)
    proof.done(just_in, largest)


@result("element-trapezoids")
def _trapezoids(proof: Proof) -> None:
    r"""Trapezoids between elements.

    For a compression $u$ with four continuous derivatives from one element to the next. Summed over elements,
    the slopes cancel but for those at both ends: the trapezoidal sum is too large by $\Delta^2/12$ times the
    slope at the end less that at the beginning. Under a parabola $u'''' = 0$, so that there is no other
    error.
    """
    over = (x, 0, _spacing)
    kernel = x**2 * (_spacing - x) ** 2 / 24
    derivatives = [sp.Derivative(_u(x), (x, order)) for order in (4, 3, 2, 1)]
    parts = sum(
        (-1) ** order * sp.diff(kernel, x, order) * inner
        for order, inner in enumerate([*derivatives[1:], _u(x)])
    )
    slopes = [sp.Subs(derivatives[-1], x, place) for place in (0, _spacing)]
    proof.define(slopes[0], begins, "the slope at the beginning")
    proof.define(lacks, _spacing**2 / 12 * begins, "what is lacking because of it")
    value = _spacing**2 / 12 * slopes[1] - lacks - _spacing * (_u(0) + _u(_spacing)) / 2
    integrand = kernel * derivatives[0] - _u(x)
    proof.integral(sp.Integral(integrand, over), integrand, over, "by parts, four times",
                   value=value, antiderivative=parts)  # fmt: skip
    proof.holds(kernel, ">=", 0, "so the error depends on the mean of $u''''$")
    proof.integral(sp.Integral(kernel, over), kernel, over,
                   r"the remaining error per element is at most this times the greatest $|u''''|$",
                   value=_spacing**5 / 720)  # fmt: skip
    proof.done(sp.Integral(integrand, over), value)


@result("element-kink")
def _kink(proof: Proof) -> None:
    r"""Part of an element at an edge.

    Between an element outside, where the indenter is above the free surface by $-w_0 > 0$, and the next one
    inside, where it is below by $w_1 > 0$, the surface has a kink. The rule of trapezoids takes its chord.
    The edge-corrected scheme adds the difference to $U = \int u \, dx$, of which the force is $K U + C \dot
    U$: with it the sawtooth of the forces is gone, and the forces are of second order in the spacing.
    """
    line = _outside + (_inside - _outside) * x / _spacing
    meets = -_outside * _spacing / (_inside - _outside)
    area = _spacing * _inside**2 / (2 * (_inside - _outside))
    proof.integral(sp.Integral(line, (x, meets, _spacing)), line, (x, meets, _spacing),
                   "the larger of both surfaces, above the free one", value=area)  # fmt: skip
    trapezoid = _spacing * _inside / 2
    proof.equal(area - trapezoid, KINK, r"without the trapezoid of the elements, $\Delta w_1/2$")
    proof.define(begins, sp.diff(line, x), "where the trapezoids begin")
    proof.recall("element-trapezoids", lacks)
    proof.define(added, KINK + END, "what the scheme adds")
    exact = area - trapezoid + lacks
    proof.equal(exact, added, "all that is left out, for straight surfaces")
    inside, outside = _slope * _spacing * (1 - _share), -_slope * _spacing * _share
    in_cell = -_slope * _spacing**2 * _share * (1 - _share) / 2
    proof.define(_inside, inside, r"surfaces at the angle $m$ that meet at $\vartheta \Delta$")
    proof.define(_outside, outside)
    proof.equal(KINK, in_cell, "the kink at its place within the element")
    proof.sign(in_cell + _slope * _spacing**2 / 8, ">=", 0, (_share, 0, 1), "of second order")
    proof.define(_end, C * V * _slope, "pressure at a leading edge, its elements met with $m V$")
    proof.define(_rise, sp.S.Zero, "to first order")
    proof.recall("F15-sawtooth", _surplus)
    reason = r"as the base moves, $\Delta \dot\vartheta = -V$: the sawtooth"
    proof.equal(C * sp.Derivative(in_cell, _share) * -V / _spacing, _surplus, reason)
    proof.done(exact, added)


@result("element-bent")
def _bent(proof: Proof) -> None:
    r"""Error of the part of an element.

    Where the surfaces do not meet in straight lines, but with an overlap $w$ of curvature $w_2$: the error of
    the scheme is of third order in the spacing, $\Delta^3 w_2$ times a bounded factor, so that the forces are
    of second order.
    """
    overlap = _slope * (x - _share * _spacing) + _bend * (x - _share * _spacing) ** 2 / 2
    over = (x, _share * _spacing, _spacing)
    area = sp.Integral(overlap, over)
    proof.integral(area, overlap, over, "its area inside")
    proof.where(_share < 1, "the contact ends between two elements")
    proof.where(2 * _slope + _spacing * (1 - _share) * _bend > 0, "the first one inside overlaps")
    proof.define(_inside, overlap.subs(x, _spacing), "at the first element inside")
    proof.define(_outside, overlap.subs(x, 0), "at the last one outside")
    end = sp.diff(overlap, x).subs(x, _spacing)
    proof.define(begins, end, "where the trapezoids begin")
    proof.recall("element-trapezoids", lacks, "element-kink", (added, KINK + END))
    due = area - _spacing * _inside / 2 + lacks - added
    rest = (
        2 * _slope * (4 * _share**3 - 6 * _share**2 + 1),
        -_spacing * _bend * (2 * _share**4 - 4 * _share**3 + 2 * _share - 1),
    )
    rises = 2 * _slope + _spacing * _bend * (1 - 2 * _share)
    proof.where(rises > 0, "the overlap grows inward")
    result = sum(-(_spacing**3) * _bend * each / (24 * rises) for each in rest)
    proof.equal(due, result, "the exact value less that of the scheme")
