r"""Dimensionless groups by the null space of the matrix of dimensions.

Lengths along x and along z are independent dimensions: the model keeps its form when they change by
independent factors (groups-lengths). Therefore steady sliding has one group; with one isotropic length it
would have two.

The base dimensions are force per unit width N, horizontal length X, vertical length Z and time T.
"""

import sympy as sp
from sympy.printing.latex import LatexPrinter

from .record import Derivation
from .rules import Computed
from .step import Proof, tex
from .symbols import K, M, R, V, W, delta, depth_rate_now, mu, tau, x

SECTION = "Dimensionless groups"

k_s = sp.Symbol("k_s", positive=True)
"""Stiffness of the spring of a suspended indenter."""

BASE = sp.symbols("N X Z T", positive=True)
_N, _X, _Z, _T = BASE

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

fixed_groups = (V * tau / sp.sqrt(R * delta), mu * sp.sqrt(R / delta))
dead_weight_groups = (
    V * tau * (K / (R * W)) ** _third,
    mu * (K * R**2 / W) ** _third,
)
transient_groups = (
    V * tau / sp.sqrt(R * delta),
    M * delta / (W * tau**2),
    k_s * delta / W,
)


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


def derive() -> tuple[Derivation, ...]:
    """Derive the groups of steady sliding and of the transient."""
    fixed = (R, K, tau, V, delta, mu)
    dead_weight = (R, K, tau, V, W, mu)
    transient = (R, tau, V, delta, M, W, k_s)
    return (
        _lengths(),
        _groups("fixed", "fixed indenter", fixed, fixed_groups, _STEADY, _FIXED),
        _groups("dead-weight", "dead weight", dead_weight, dead_weight_groups, _STEADY, _DEAD),
        _groups("transient", "transient", transient, transient_groups, _TRANSIENT, _SCALED),
    )


_STEADY = "One group of the operation and the scaled friction coefficient, so one master curve."
_TRANSIENT = (
    r"Drive number $\lambda = V \tau/\sqrt{2 R \delta}$, inertia number "
    r"$\epsilon = M \delta/(W \tau^2)$ and support number $\kappa = k_s \delta/W$, with the depth "
    r"$\delta$ and the load $W$ at rest, which together determine $K$."
)
_INDEPENDENT = "the exponents $E$ of these groups are independent"
_COMPLETE = "and they span the null space of $D$, so there is no other group"
_ISOTROPIC = "one length for both directions would leave one group more, and no master curve"
_FIXED = (r"\frac{V \tau}{\sqrt{R \delta}}", r"\mu \sqrt{\frac{R}{\delta}}")
_DEAD = (
    r"V \tau \left(\frac{K}{R W}\right)^{1/3}",
    r"\mu \left(\frac{K R^2}{W}\right)^{1/3}",
)
_SCALED = (
    r"\frac{V \tau}{\sqrt{R \delta}}",
    r"\frac{M \delta}{W \tau^2}",
    r"\frac{k_s \delta}{W}",
)


def dimension_matrix(quantities: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """Return the exponents of the base dimensions, one column for each quantity."""
    powers = [DIMENSIONS[quantity].as_powers_dict() for quantity in quantities]
    return sp.Matrix([[power[base] for power in powers] for base in BASE])


def isotropic(matrix: sp.Matrix) -> sp.Matrix:
    """Return the matrix that results when both lengths count as one dimension."""
    force, along, up, time = (matrix.row(i) for i in range(len(BASE)))
    return sp.Matrix.vstack(force, along + up, time)


def _lengths() -> Derivation:
    """Prove that the model keeps its form when both lengths change by factors of their own."""
    proof = Proof("groups-lengths", None, section=SECTION, title="Two lengths", text=_LENGTHS,
                  uses=("eq3", "eq7", "eq12"))  # fmt: skip
    units = DIMENSIONS | {depth_rate_now: _Z / _T, x: _X}
    sag = x**2 / (2 * R)
    pressure = K * (delta - sag) + K * tau * (depth_rate_now - V * x / R)
    for name, law, unit, reason in (
        ("h", sag, _Z, "the shape, Eq. (3)"),
        ("h'", sp.Derivative(sag, x), _Z / _X, "its slope, by which a load becomes friction"),
    ):
        proof.notation["h"] = sp.Lambda((R, x), sag)
        proof.equal(
            *(sp.Subs(law, (R, x), (R * units[R], x * units[x])), unit * law, reason),
            left=rf"{name}\left(\frac{{X^2}}{{Z}} R, X x\right)", right=rf"{tex(unit)} {name}(R, x)",
        )  # fmt: skip
    proof.notation |= {"h": sag, "h'": sp.diff(sag, x)}
    given = [each for each in units if pressure.has(each)]
    changed = sp.Subs(pressure, given, [each * units[each] for each in given])
    proof.equal(
        *(changed, _N / _X * pressure, "the pressure, Eqs. (6), (7) and (12)"),
        left=_CHANGED, right=r"\frac{N}{X} [K (\delta - h) + K \tau (\dot\delta - V h')]",
    )  # fmt: skip
    _circle(proof)
    return proof.done(changed, _N / _X * pressure)


def _circle(proof: Proof) -> None:
    """Prove that a circle, whose slope is not small, allows one length only."""
    term = x**4 / (8 * R**3)
    circle = R - sp.sqrt(R**2 - x**2)
    proof.leading_order(
        circle - x**2 / (2 * R), term, x, 0, "the additional term of a circle", eps=x**2
    )
    factor = _Z**3 / _X**2
    places = {R: R * DIMENSIONS[R], x: x * _X}
    proof.equal(sp.Subs(term, list(places), list(places.values())), factor * term,
                "changes by another factor than $Z$")  # fmt: skip
    proof.root(factor - _Z, _Z, _X, "except if both lengths change by the same factor")


_CHANGED = (
    r"\frac{N}{X Z} K (Z \delta - Z h) + \frac{N}{X Z} K T \tau \left(\frac{Z}{T} \dot\delta - "
    r"\frac{X}{T} V \frac{Z}{X} h'\right)"
)
_LENGTHS = (
    r"Let lengths along the foundation change by a factor $X$, vertical ones by $Z$, forces by $N$ and "
    r"times by $T$, and every quantity by its dimension: $R$ by $X^2/Z$, $K$ by $N/(X Z)$, and so on. "
    r"Shape and pressure keep their form, whatever the factors, and with them load and friction force, "
    r"integrals over $x$ of $p$ and $-h' p$. So $X$ and $Z$ count as two dimensions. This is due to "
    r"the small slope: the shape is a parabola, and $-h'$ replaces the inclination; a "
    r"circle does not allow it."
)


def _groups(
    name: str,
    scene: str,
    quantities: tuple[sp.Symbol, ...],
    groups: tuple[sp.Expr, ...],
    text: str,
    shown: tuple[str, ...],
) -> Derivation:
    proof = Proof(f"groups-{name}", None, section=SECTION, title=f"Groups: {scene}", text=text)
    for quantity in quantities:
        proof.define(quantity, DIMENSIONS[quantity], "dimension", left=rf"[{tex(quantity)}]")
    for group, display in zip(groups, shown, strict=True):
        proof.equal(group, sp.S.One, "all dimensions cancel", left=rf"\left[{display}\right]")
    matrix = dimension_matrix(quantities)
    free = matrix.nullspace()
    powers = [group.as_powers_dict() for group in groups]
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
    return proof.done(groups[0], 1)
