r"""Dimensionless groups by the null space of the matrix of dimensions.

Lengths along x and along z are independent dimensions: the model keeps its form when they change by
independent factors (groups-lengths). Therefore steady sliding has one group; with one isotropic length it
would have two.

The base dimensions are force per unit width N, horizontal length X, vertical length Z and time T.
"""

from collections.abc import Mapping

import sympy as sp
from sympy.printing.latex import LatexPrinter

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbol
from ..engine.rules import Computed
from ..engine.step import Proof
from .model import K, M, R, V, delta, delta_t, depth_rate, h, tau, x
from .steady import W, mu, p

letter(r"\mathbf{D}", "matrix of the dimensions")
letter(r"\mathbf{E}", "matrix of the exponents of the groups")
letter(r"\mathsf{N}", "dimension of a force per unit width", "dimension", source="dimension")
letter(r"\mathsf{X}", "dimension of a length along the foundation", "dimension", source="dimension")
letter(r"\mathsf{Z}", "dimension of a vertical length", "dimension", source="dimension")
letter(r"\mathsf{T}", "dimension of a time", "dimension", source="dimension")
k_s = symbol("k_s", "stiffness of the suspension per unit width", "N/m²", source="")
depth_rate_now = symbol("delta_t", latex=r"\dot\delta", real=True)

result = Chapter("Dimensionless groups")

BASE = sp.symbols("N X Z T", positive=True)
_N, _X, _Z, _T = BASE
_dim = sp.Function(r"\dim", positive=True)
"""The dimension of a quantity."""

DIMENSIONS = {
    R: _X**2 / _Z,
    K: _N / (_X * _Z),
    tau: _T,
    V: _X / _T,
    delta: _Z,
    W: _N,
    mu: _Z / _X,
    M: _N * _T**2 / _Z,
    k_s: _N / _Z,
}

_third = sp.Rational(1, 3)

fixed_groups = {
    r"\frac{V \tau}{\sqrt{R \delta}}": V * tau / sp.sqrt(R * delta),
    r"\mu \sqrt{\frac{R}{\delta}}": mu * sp.sqrt(R / delta),
}
dead_weight_groups = {
    r"V \tau \left(\frac{K}{R W}\right)^{1/3}": V * tau * (K / (R * W)) ** _third,
    r"\mu \left(\frac{K R^2}{W}\right)^{1/3}": mu * (K * R**2 / W) ** _third,
}
transient_groups = {
    r"\frac{V \tau}{\sqrt{R \delta}}": V * tau / sp.sqrt(R * delta),
    r"\frac{M \delta}{W \tau^2}": M * delta / (W * tau**2),
    r"\frac{k_s \delta}{W}": k_s * delta / W,
}


class Rank(Computed):
    """The rank of a matrix, printed with the matrix."""

    def __new__(cls, matrix: sp.Matrix) -> "Rank":
        """Keep the matrix as it is."""
        return sp.Expr.__new__(cls, sp.ImmutableMatrix(matrix))

    def doit(self, **_: object) -> sp.Integer:
        """Return the number."""
        return sp.Integer(self.args[0].rank())

    def _latex(self, printer: LatexPrinter) -> str:
        return rf"\mathrm{{rank}} {printer._print(self.args[0])}"


_INDEPENDENT = "the exponents $E$ of these groups are independent"
_COMPLETE = "and they span the null space of $D$, so there is no other group"
_ISOTROPIC = "one length for both directions would leave one group more, and no master curve"


def dimension_matrix(quantities: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """Return the exponents of the base dimensions, one column for each quantity."""
    powers = [DIMENSIONS[quantity].as_powers_dict() for quantity in quantities]
    return sp.Matrix([[power[base] for power in powers] for base in BASE])


def isotropic(matrix: sp.Matrix) -> sp.Matrix:
    """Return the matrix that results when both lengths count as one dimension."""
    force, along, up, time = (matrix.row(i) for i in range(len(BASE)))
    return sp.Matrix.vstack(force, along + up, time)


@result("groups-lengths")
def _lengths(proof: Proof) -> None:
    """Two lengths.

    Let lengths along the foundation change by a factor $X$, vertical ones by $Z$, forces by $N$ and times by
    $T$, and every quantity by its dimension: $R$ by $X^2/Z$, $K$ by $N/(X Z)$, and so on. Shape and pressure
    keep their form, whatever the factors, and with them load and friction force, integrals over $x$ of $p$
    and $-h' p$. So $X$ and $Z$ count as two dimensions. This is due to the small slope: the shape is a
    parabola, and $-h'$ replaces the inclination; a circle does not allow it.
    """
    units = DIMENSIONS | {depth_rate_now: _Z / _T, x: _X}
    sag = x**2 / (2 * R)
    pressure = K * (delta - sag) + K * tau * (depth_rate_now - V * x / R)
    proof.recall("eq3")
    for law, unit, reason in (
        (h(x), _Z, "the shape keeps its form"),
        (h(x).diff(x), _Z / _X, "and its slope, by which a load becomes friction"),
    ):
        changed = sp.Subs(law, (R, x), (R * units[R], x * units[x]))
        proof.equal(changed, unit * law, reason)
    scaled = {each: each * unit for each, unit in units.items()}
    changed = pressure.subs(scaled, simultaneous=True)
    proof.equal(changed, _N / _X * pressure, "the pressure keeps its form")
    proof.recall("pressure-moving", p, "eq22", tau)
    moving = {delta: delta_t, depth_rate_now: depth_rate}
    proof.equal(p, pressure.subs(moving), "which is that of a dense row")
    _circle(proof)
    proof.done(changed, _N / _X * pressure)


def _circle(proof: Proof) -> None:
    """Prove that a circle, whose slope is not small, allows one length only."""
    term = x**4 / (8 * R**3)
    circle = R - sp.sqrt(R**2 - x**2)
    proof.leading_order(circle - x**2 / (2 * R), term, x, 0, "the additional term of a circle",
                        eps=x**2)  # fmt: skip
    factor = _Z**3 / _X**2
    places = {R: R * DIMENSIONS[R], x: x * _X}
    proof.equal(sp.Subs(term, list(places), list(places.values())), factor * term,
                "changes by another factor than $Z$")  # fmt: skip
    proof.root(factor - _Z, _Z, _X, "except if both lengths change by the same factor")


def _groups(proof: Proof, groups: Mapping[str, sp.Expr], quantities: tuple[sp.Symbol, ...]) -> None:
    for quantity in quantities:
        proof.define(_dim(quantity), DIMENSIONS[quantity], "dimension")
    of = {quantity: _dim(quantity) for quantity in quantities}
    for group in groups.values():
        proof.equal(group.subs(of, simultaneous=True), sp.S.One, "all dimensions cancel")
    matrix = dimension_matrix(quantities)
    free = matrix.nullspace()
    powers = [group.as_powers_dict() for group in groups.values()]
    exponents = [sp.Matrix([power[quantity] for quantity in quantities]) for power in powers]
    n, m = len(quantities), len(groups)
    for found, expected, reason in (
        (
            n - Rank(matrix),
            m,
            "the matrix $D$ of dimensions, one row for each of $N$, $X$, $Z$, $T$",
        ),
        (Rank(sp.Matrix.hstack(*exponents)), m, _INDEPENDENT),
        (Rank(sp.Matrix.hstack(*exponents, *free)), m, _COMPLETE),
        (n - Rank(isotropic(matrix)), m + 1, _ISOTROPIC),
    ):
        proof.equal(found, sp.Integer(expected), reason)
    proof.done(next(iter(groups.values())).subs(of, simultaneous=True), 1)


_STEADY = "One group of the operation and the scaled friction coefficient, so one master curve."
_TRANSIENT = (
    r"Drive number $\lambda = V \tau/\sqrt{2 R \delta}$, inertia number "
    r"$\epsilon = M \delta/(W \tau^2)$ and support number $\kappa = k_s \delta/W$, with the depth "
    r"$\delta$ and the load $W$ at rest, which together determine $K$."
)
for _name, _scene, _quantities, _scaled, _text in (
    ("fixed", "fixed indenter", (R, K, tau, V, delta, mu), fixed_groups, _STEADY),
    ("dead-weight", "dead weight", (R, K, tau, V, W, mu), dead_weight_groups, _STEADY),
    ("transient", "transient", (R, tau, V, delta, M, W, k_s), transient_groups, _TRANSIENT),
):
    result(f"groups-{_name}", title=f"Groups: {_scene}", text=_text,
           groups=_scaled, quantities=_quantities)(_groups)  # fmt: skip
