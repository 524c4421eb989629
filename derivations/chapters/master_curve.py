r"""The dead-weight indenter over its velocity: master curve, friction maximum, series, crossing velocity.

``q`` = x_TE/a in (0, 1) names the state, as in `derivations.theorems`, whose section this continues.
"""

import sympy as sp

from ..engine.book import established
from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.record import Table
from ..engine.step import Proof
from .asymptotics import alpha, mu_high, mu_high_weight, mu_low
from .model import K, R, V, delta, tau
from .steady import Lambda, W, a, l, l_r, mu, q
from .theorems import SECTION, UNIT, A, B, m, w

Lambda_peak, mu_peak, Lambda_fixed, Lambda_weight, X, Y, T, mu_max, V_max = symbols(r"""
    Lambda_peak  \Lambda_{\max}    1    scaled velocity at the friction maximum of a dead weight
    mu_peak     \hat\mu_{\max}    1    scaled friction maximum of a dead weight, $\mu (K R^2/W)^{1/3}$
    Lambda_fixed  \Lambda^{*}_{\mathrm{FI}}  1    scaled crossing velocity, fixed indenter, $V^{*}
            \tau/\sqrt{R \delta}$
    Lambda_weight  \Lambda^{*}_{\mathrm{MI}}  1    scaled crossing velocity, dead weight, $V^{*} \tau
            (K/(R W))^{1/3}$
    X_m         X                 1    $\Lambda^3$  prints \hat X
    Y           -                 1    cube of the scaled friction coefficient, $\mu^3 K R^2/W$  prints
            \hat Y
    T           -                 1    ratio of the friction coefficient to its low-velocity
            asymptote  prints \hat T
    mu_max      \mu_{\max}        1    friction maximum of a dead weight over its velocity  from scene
    V_max       V_{\max}          m/s  velocity of the friction maximum  from scene
""")

DRIVE_CUBED = 3 * (1 - q) ** 3 * (1 + q) / (2 * q**2 * A)
FRICTION_CUBED = 3 * q * (1 - q) ** 3 * B**3 / (2 * (1 + q) ** 2 * A**4)
PEAK = 2 - sp.sqrt(3)

result = Chapter(SECTION)


def state_at(cubed: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Return the polynomial of F2 with a number for the cube of the scaled velocity, and its root q."""
    polynomial = sp.numer(sp.together(cubed - established("F2", X)))
    (state,) = (root for root in sp.Poly(polynomial, q).real_roots() if 0 < root < 1)
    return polynomial, state


@result("F2")
def _master_curve(proof: Proof) -> None:
    r"""Master curve of the dead-weight indenter.

    With $X = (V\tau)^3 K/(R W)$ and $Y = \mu^3 K R^2/W$, the cubes of the axes of Fig. 6, $X$ falls from
    $\infty$ to 0 while $q$ goes from 0 to 1: depth, friction force and friction coefficient follow from one
    root $q$ of a quartic. With $T = \mu R K/(C V)$, so that $T^3 = Y/X$, the curve is one polynomial relation
    between $T$ and $X$, of degrees 4 and 3: the resultant.
    """
    quartic = 2 * X * q**2 * A - 3 * (1 - q) ** 3 * (1 + q)
    relation = sp.resultant(quartic, q * B - T * (1 + q) * A, q)
    proof.crossing(
        DRIVE_CUBED - X,
        UNIT,
        r"it falls from $\infty$ at $q = 0$: exactly one root, one state for each velocity",
    )
    proof.recall("scaling", "F1", w, "F1")
    proof.define(V, l * a / tau, "Eq. (29)")
    proof.recall("F1", W, mu, "eq28", delta)
    proof.define(X, (V * tau) ** 3 * K / (R * W), "cube of the abscissa")
    proof.equal(X, DRIVE_CUBED, "scaled velocity")
    proof.leading_order(X, 1 / (2 * q**2), q, 0, "the fast limit")
    proof.leading_order(X, sp.Rational(3, 2) * (1 - q) ** 3, q, 1, "it comes to rest")
    proof.equal(quartic, sp.S.Zero, "the quartic")
    proof.define(Y, mu**3 * K * R**2 / W, "cube of the ordinate")
    proof.equal(Y, FRICTION_CUBED, "scaled friction coefficient")
    proof.define(l_r, l * a, "the retardation length over the half length")
    proof.define(T, mu * R / l_r, "over the asymptote of Eq. (42)")
    proof.equal(T, q * B / ((1 + q) * A), "rational")
    proof.equal(T**3, Y / X, "the same in the scales of Fig. 6")
    proof.equal(relation, sp.S.Zero, "$q$ eliminated: the resultant")
    proof.done(X, DRIVE_CUBED)


@result("F3")
def _peak(proof: Proof) -> None:
    r"""Friction maximum of the dead-weight indenter.

    $\mu (K R^2/W)^{1/3}$ has one maximum over all velocities; F3-values says where.
    """
    parabola = q**2 - 4 * q + 1
    rest = 18 * (1 - q) ** 2 * (1 + q**2) * B**2 / ((1 + q) ** 3 * A**5)
    proof.recall("F2", Y)
    proof.equal(sp.Derivative(FRICTION_CUBED, q), rest * parabola, "slope")
    proof.sign(rest, ">", 0, UNIT, "the sign is that of the last factor")
    proof.unique_root(parabola, UNIT, "positive at $q = 0$, negative at $q = 1$")
    proof.root(parabola, q, PEAK, "friction maximum", over=UNIT)


@result("F3-values")
def _peak_values(proof: Proof) -> None:
    """Values at the friction maximum."""
    third = sp.cbrt(3 - sp.sqrt(3))
    proof.recall("F3", "scaling")
    proof.equal(l, sp.sqrt(3), r"$l_{\mathrm{r}} = \sqrt{3}\, a$")
    proof.recall("F1")
    proof.equal(m, 3 * (sp.sqrt(3) - 1) / 4, r"$\mu R/a$")
    proof.recall("F2")
    proof.define(Lambda_peak, sp.cbrt(X), r"$V \tau (K/(R W))^{1/3}$")
    proof.equal(Lambda_peak, sp.sqrt(3) / third, "1.60027...")
    proof.define(mu_peak, m * Lambda_peak / l, r"$\mu (K R^2/W)^{1/3}$")
    proof.equal(mu_peak, 3 * (sp.sqrt(3) - 1) / (4 * third), "0.507265...")


@result("F26")
def _bell(proof: Proof) -> None:
    r"""Stiffness and retardation time from the friction maximum.

    The maximum of $\mu(V)$ of a dead weight, of the height $\mu_{\max}$ at the velocity $V_{\max}$, gives
    both constants of a Kelvin–Voigt foundation. Far below it $\mu = C V/(R K)$ tells $C/K$ only, on every
    linear foundation (F18-low).
    """
    proof.recall("F3-values", mu_peak, Lambda_peak)
    stiffness, time = (mu_peak / mu_max) ** 3 * W / R**2, Lambda_peak * sp.cbrt(R * W / K) / V_max
    known = r"$\mu_{\max} (K R^2/W)^{1/3}$ is known"
    proof.root(mu_max * sp.cbrt(K * R**2 / W) - mu_peak, K, stiffness, known)
    reason = r"$V_{\max} \tau (K/(R W))^{1/3}$, too"
    proof.root(V_max * tau * sp.cbrt(K / (R * W)) - Lambda_peak, tau, time, reason)
    height, place = established("F3-values", mu_peak), established("F3-values", Lambda_peak)
    numbers = {
        r"\hat \mu_{\max}": height,
        r"\hat \mu_{\max}^3": height**3,
        r"\Lambda_{\max}": place,
    }
    rows = tuple((f"${name}$", str(sp.N(value, 9))) for name, value in numbers.items())
    proof.done(tau, time, table=Table(("Number", "Value"), rows))


def _expansion(
    proof: Proof,
    end: int,
    small: sp.Expr,
    first: sp.Expr,
    second: sp.Expr,
    last: sp.Expr,
) -> None:
    proof.recall("scaling", "F1")
    proof.leading_order(m, first, q, end, "the asymptote", eps=small)
    proof.leading_order(first + second - m, last, q, end, "two terms, less the exact", eps=small)


result("F4-low", title="Friction coefficient at low velocity: series", end=1, small=l, first=l,
       second=-3 * l**2 / 4, last=-9 * l**4 / 16)(_expansion)  # fmt: skip
result("F4-high", title="Friction coefficient at high velocity: series", end=0, small=1 / l,
       first=sp.Rational(2, 3), second=-7 / (36 * l), last=1 / (27 * l**2))(_expansion)  # fmt: skip


@result("F5")
def _intersections(proof: Proof) -> None:
    """Crossing velocity and friction maximum.

    The crossing velocity is where the two asymptotes of the friction coefficient meet. For a dead-weight
    indenter the maximum is at 1.664 times that velocity.
    """
    proof.recall("eq22")
    for label, name in (("eq42", mu_low), ("eq45", mu_high), ("eq46", mu_high_weight)):
        proof.asymptote(label, mu, name)
    reached = "fixed indenter: 1 at"
    proof.equal(mu_low / mu_high, V * tau / sp.sqrt(R * delta) / alpha, reached)
    proof.root(
        Lambda / alpha - 1, Lambda, alpha, r"$V^{*} \tau/\sqrt{R \delta}$", name=Lambda_fixed
    )
    proof.define(V, Lambda * sp.cbrt(R * W / K) / tau, "in units of the dead weight")
    ratio = Lambda ** sp.Rational(3, 2) / alpha
    proof.equal(mu_low / mu_high_weight, ratio, "dead weight: 1 at")
    proof.root(ratio - 1, Lambda, sp.cbrt(alpha**2), r"$V^{*} \tau (K/(R W))^{1/3}$",
               name=Lambda_weight)  # fmt: skip
    proof.recall("F3-values", Lambda_peak)
    beyond = (Lambda_peak / Lambda_weight) ** 3
    proof.equal(beyond, 27 * (1 + sp.sqrt(3)) / 16, "the maximum lies beyond the intersection")
