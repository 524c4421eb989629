r"""How many arms are enough: a bound on what a series with other arms changes (F27).

Everything that decides steady sliding is a sum of positive functionals of the fall of the relaxation function
(F17-sign), and so close in two series as their falls are.
"""

import sympy as sp

from ..engine.algebra import antiderivative
from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .model import F_x, F_z, R
from .relaxation import (
    FALLS, LOADED, WORKED, G, a, arm_ratio, by_fall, c, fading, name_integrals, spare_1, spare_2,
    weighted, y,
)  # fmt: skip
from .viscoelastic import SECTION, A, B, D, E, P, e, w
from .viscoelastic_limits import slowing, spare_3, weight_at

relative = symbol("rho_v", "relative difference of the falls of two series", latex=r"\breve \rho")
other_fading = function(
    "H_w", "fall of another one", "Pa/m²", printed=r"\breve H_1", nonnegative=True
)
part_at = function("n_v", "place between two bounds", printed=r"\breve n", nonnegative=True)

force_slope, power, slowed, left, *differences = symbols(r"""
    f_v    \breve f    1  slope of the friction force over the load, at one velocity  real
    q_v    \breve q    1  bound of $\mathrm{d} \ln F_x/\mathrm{d} \ln F_z$
    J_s    \breve J_s  N/m³  part of $10 \breve E - \breve B$ by how the fall slows  nonnegative
    J_r    \breve J_r  N/m³  rest of it  real
    r_W    \breve r_W  1  most by which the loads on two series differ, as a factor
    s_W    \breve s_W  1  least by which they differ
    r_F    \breve r_F  1  most by which the friction forces differ, as a factor
    s_F    \breve s_F  1  least by which they differ
""")
loads, frictions = differences[:2], differences[2:]

eps, up, low = relative, 1 + relative, 1 - relative
SLIGHT, BOUND = (relative, 0, sp.Rational(1, 100)), 14
"""Relative differences of two series for which friction at a load differs by at most 14 times as much."""
STEEPEST = sp.Rational(5, 2)
"""Of friction over the load, logarithmically, at one velocity."""
_kernel_of = 10 * FALLS[E] - FALLS[B]
_gained = sp.factor(c * antiderivative(_kernel_of, w).subs(w, y / c))
SLOWED = sp.Integral(_gained * slowing(y), (y, 0, c))
LEFT = sp.Integral(sp.factor(_kernel_of.subs(w, y / c)) * fading(y) - SLOWED.function, (y, 0, c))
"""10 E - B, by how the fall slows, and the rest, which vanishes."""
IN_PARTS = (B + slowed + left) / 10
"""E by these."""
LACKING = sp.Integral((c - 2 * y) ** 2 * G(y) / c**3, (y, 0, c))
"""A - 8 D."""

result = Chapter(SECTION)


@result("F27-slope")
def _along(proof: Proof) -> None:
    r"""Any relaxation function: friction force over the load.

    At one velocity $\mathrm{d}F_x/\mathrm{d}F_z = (a - x_{\mathrm{TE}})/R$: twice the slope of the
    indenter in the middle of the contact.
    """
    name_integrals(proof, 4, c)
    proof.recall("F17-concave", a)
    for total, integral in ((F_z, LOADED), (F_x, WORKED)):
        proof.recall("F17-forces", integral)
        proof.define(total, integral, "over the contact")
    load, work = sp.Derivative(F_z, c), sp.Derivative(F_x, c)
    proof.where(load > 0, "the load grows with the contact, F17-growth")
    proof.define(force_slope, work / load, "at one velocity")
    proof.equal(force_slope, (2 * a - c) / R, "both grow with the contact")


@result("F27-kernel")
def _kernel(proof: Proof) -> None:
    r"""Any relaxation function: two inequalities of its moments.

    As every Prony series $G$ is convex: its fall $\breve H$ slows at the rate $\breve C \ge 0$.
    """
    by_fall(proof, E, B)
    proof.define(sp.Derivative(fading(y), y), -slowing(y), "the relaxation function is convex")
    proof.define(slowed, SLOWED, "one part")
    proof.define(left, LEFT, "the other one")
    proof.equal(E, IN_PARTS, "both")
    proof.integral(left, LEFT.function, (y, 0, c), "by parts", value=sp.S.Zero,
                   antiderivative=_gained * fading(y))  # fmt: skip
    proof.holds(slowed, ">=", 0, r"so $\breve B \le 10 \breve E$")
    for name in (A, D):
        proof.define(name, weighted(name), "a moment")
    proof.equal(D, (A - LACKING) / 8, "what is left")
    proof.holds(LACKING, ">=", 0, r"so $\breve D \le \breve A/8$")


@result("F27-steepest")
def _steepest(proof: Proof) -> None:
    r"""Any relaxation function: steepest growth of friction with load.

    $\mathrm{d} \ln F_x/\mathrm{d} \ln F_z$ at one velocity.
    """
    half = sp.Rational(1, 2)
    proof.recall("F27-slope", force_slope, "F17-parts", (a, c * (e + half)), e, F_z, F_x)
    proof.where(E > 0, "$G$ is not constant")
    ratio = 2 * e * (D + e * P) / (E + e**2 * P)
    proof.equal(force_slope * F_z / F_x, ratio, "by the moments")
    proof.recall("F27-kernel", (E, IN_PARTS), left, D)
    proof.define(power, STEEPEST, "a bound of it")
    surplus = (e**2 * P / 2 + (slowed + e * LACKING) / 4) / (E + e**2 * P)
    proof.equal(power - ratio, surplus, r"what $\mathrm{d} \ln F_x/\mathrm{d} \ln F_z$ is less")
    proof.holds(surplus, ">=", 0, "no term is negative")
    proof.done(power - ratio, surplus)


@result("F27-close")
def _close(proof: Proof) -> None:
    r"""Any relaxation function: two series that are close.

    The other series has the same $K$ and a fall $\breve H_1$ between $1 - \breve \rho$ and $1 + \breve
    \rho$ times that of the first, $\breve n$ saying where; and it has come as close to $K$ where the
    contact ends. Compared are load and friction force at the same length of the contact.

    Argued: All moments are sums of end values and falls with positive weights (F17-falls), and therefore
    as close; $\breve \omega_1$ to $\breve \omega_3$ say how much closer.
    """
    share = (1 - part_at(y)) / (1 + part_at(y))
    proof.define(eps, arm_ratio / (1 + arm_ratio), "any number between 0 and 1")
    proof.define(other_fading(y), fading(y) * (1 + eps * share), "anywhere between the bounds")
    for gap, side in ((up * fading(y) - other_fading(y), "above"),
                      (other_fading(y) - low * fading(y), "below")):  # fmt: skip
        proof.holds(
            sp.Integral(weight_at(y) * gap, (y, 0, c)), ">=", 0, f"bounded {side}, for every weight"
        )
    one, two, three = (1 + spare for spare in (spare_1, spare_2, spare_3))
    proof.recall("F17-parts", e, F_z, F_x)
    proof.where(E > 0, "$G$ is not constant")
    for power, form, own, (most_of, least_of), what in (
        (1, F_z * R / c**3, D, loads, "load"), (2, F_x * R**2 / c**4, E, frictions, "friction force"),
    ):  # fmt: skip
        most = up * own / one + (up * B / (low * A * two)) ** power * up * P / three
        least = low * own * one + (low * B * two / (up * A)) ** power * low * P * three
        proof.define(most_of, up ** (1 + power) / low**power, f"most by which the {what} differs")
        proof.define(least_of, low ** (1 + power) / up**power, "and the least")
        proof.holds(
            most_of * form, ">=", most, f"{what} of the other series at the same length, at most"
        )
        proof.holds(least, ">=", least_of * form, "and at least")


@result("F27")
def _enough(proof: Proof) -> None:
    r"""How many arms are enough.

    Friction forces at a load are compared at the length of the contact on the first series; what the loads
    differ by there counts at most to the power $\breve q$ (F27-steepest, integrated).

    Argued: So $\mu$ under a dead weight differs by less than $14 \breve \rho$ of it, for $\breve \rho <
    \frac{1}{100}$, at every velocity: a series may be replaced by one with fewer arms.
    """
    proof.recall("F27-close", *loads, *frictions, "F27-steepest", power)
    most, least = (
        (friction / load**power) ** 2
        for friction, load in zip(frictions, reversed(loads), strict=True)
    )
    proof.sign((1 + BOUND * eps) ** 2, ">", most, SLIGHT, "the square of the most")
    proof.sign(least, ">", (1 - BOUND * eps) ** 2, SLIGHT, "and that of the least")
