r"""How many arms are enough: a bound on what a series with other arms changes (F27).

Everything that decides steady sliding is a sum of positive functionals of the fall of the relaxation function
(F17-sign), and so close in two series as their falls are.
"""

import sympy as sp

from ..engine.algebra import antiderivative
from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol
from ..engine.step import Proof
from .model import R
from .relaxation import (
    G_1,
    G_2,
    LOAD,
    WORK,
    G,
    a,
    arm_ratio,
    c,
    fading,
    name_integrals,
    spare_1,
    spare_2,
)
from .viscoelastic import MOMENTS, SECTION, UNIT, A, B, D, E, P, e, w
from .viscoelastic_limits import slowing, spare_3, weight_at

relative = symbol("rho_v", "relative difference of the falls of two series", latex=r"\breve \rho")
other_fading = function(
    "H_w", "fall of another series", "N/m³", printed=r"\breve H_1", nonnegative=True
)
part_at = function(
    "n_v", "place of a value between two bounds", printed=r"\breve n", nonnegative=True
)

eps, up, low = relative, 1 + relative, 1 - relative
SLIGHT, BOUND = (relative, 0, sp.Rational(1, 100)), 14
"""Relative differences of two series for which friction at a load differs by at most 14 times as much."""
STEEPEST = sp.Rational(5, 2)
"""Of friction over the load, logarithmically, at one velocity."""

result = Chapter(SECTION)


@result("F27-slope", uses=("F17-forces", "F17-concave"))
def _along(proof: Proof) -> None:
    r"""Any relaxation function: friction force over the load.

    At one velocity $\mathrm{d}F/\mathrm{d}W = (a - x_{\mathrm{TE}})/R$: twice the slope of the indenter in
    the middle of the contact.
    """
    name_integrals(proof, 4, c)
    proof.define(a, G_2(c) / G_1(c), "F17-concave")
    load, work = (sp.Derivative(form, c) for form in (LOAD, WORK))
    proof.equal(work, (2 * a - c) / R * load, "both grow with the contact")


@result("F27-steepest", uses=("F27-slope", "F17-sign"))
def _steepest(proof: Proof) -> None:
    r"""Any relaxation function: steepest growth of friction with load.

    $\mathrm{d} \ln F/\mathrm{d} \ln W$ at one velocity, by F27-slope in the moments of F17-load and F17. As
    every Prony series $G$ is convex, its fall $\breve H = -\breve G'$ slows at the rate $\breve C \ge 0$.
    """
    kernel = 10 * w * (1 - w) ** 2 * (2 + w) / 24 - w * (1 - w) / 2
    primitive = sp.factor(antiderivative(kernel, w))
    proof.define(sp.Derivative(fading(w), w), -slowing(w), "the relaxation function is convex")
    rest = sp.Integral(kernel * fading(w) - primitive * slowing(w), UNIT)
    proof.integral(rest, kernel * fading(w) - primitive * slowing(w), UNIT, primitive * fading(w),
                   r"$10 \breve E - \breve B$ by parts", value=sp.S.Zero)  # fmt: skip
    proof.holds(
        sp.Integral(primitive * slowing(w), UNIT), ">=", 0, r"so $\breve B \le 10 \breve E$"
    )
    lack = sp.Rational(1, 8) - MOMENTS[D][0]
    proof.holds(sp.Integral(lack * G(w), UNIT), ">=", 0, r"$\breve D \le \breve A/8$")
    proof.define(e, B / A, "F17-edge")
    proof.define(E, B / 10 + spare_1, "as found")
    proof.define(D, A / (8 * (1 + spare_2)), "as found")
    ratio = 2 * e * (D + e * P) / (E + e**2 * P)
    proof.holds(ratio, "<=", STEEPEST, r"$\mathrm{d} \ln F/\mathrm{d} \ln W$")


@result("F27-close", uses=("F17-sign", "F17-parts"))
def _close(proof: Proof) -> None:
    r"""Any relaxation function: two series that are close.

    The other series has the same $K$ and a fall $\breve H_1$ between $1 - \breve \rho$ and $1 + \breve
    \rho$ times that of the first, $\breve n$ saying where; and it has come as close to $K$ where the
    contact ends. Compared are the load $\breve D + \breve \eta \breve P$ and the friction force $\breve E
    + \breve \eta^2 \breve P$, $\breve \eta = \breve B/\breve A$.

    Argued: All moments are sums of end values and falls with positive weights (F17-sign), and therefore
    as close; $\breve \omega_1$ to $\breve \omega_3$ say how much closer.
    """
    share = (1 - part_at(w)) / (1 + part_at(w))
    proof.define(eps, arm_ratio / (1 + arm_ratio), "any number between 0 and 1")
    proof.define(other_fading(w), fading(w) * (1 + eps * share), "anywhere between the bounds")
    for gap, side in ((up * fading(w) - other_fading(w), "above"),
                      (other_fading(w) - low * fading(w), "below")):  # fmt: skip
        proof.holds(
            sp.Integral(weight_at(w) * gap, UNIT), ">=", 0, f"bounded {side}, for every weight"
        )
    one, two, three = (1 + spare for spare in (spare_1, spare_2, spare_3))
    for power, own, what in ((1, D, "load"), (2, E, "friction force")):
        form = own + (B / A) ** power * P
        most = up * own / one + (up * B / (low * A * two)) ** power * up * P / three
        least = low * own * one + (low * B * two / (up * A)) ** power * low * P * three
        above, below = up ** (1 + power) / low**power, low ** (1 + power) / up**power
        proof.holds(
            above * form, ">=", most, f"{what} of the other series at the same length, at most"
        )
        proof.holds(least, ">=", below * form, "and at least")


@result("F27", uses=("F27-steepest", "F27-close"))
def _enough(proof: Proof) -> None:
    r"""How many arms are enough.

    Friction forces at a load are compared at the length of the contact on the first series (F27-close);
    what the loads differ by there counts at most to the power $\frac{5}{2}$ (F27-steepest, integrated).

    Argued: So $\mu$ under a dead weight differs by less than $14 \breve \rho$ of it, for $\breve \rho <
    \frac{1}{100}$, at every velocity: a series may be replaced by one with fewer arms.
    """
    most, least = (
        (a**3 / b**2) ** 2 * (a / b**2) ** (2 * STEEPEST) for a, b in ((up, low), (low, up))
    )
    proof.sign((1 + BOUND * eps) ** 2, ">", most, SLIGHT, "the square of the most")
    proof.sign(least, ">", (1 - BOUND * eps) ** 2, SLIGHT, "and that of the least")
