"""Where steady sliding with a spring in the drive is stable (F22): the critical stiffness in closed form."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .spring_drive import LONGITUDINAL, QUARTIC, SECTION, damper, eps_x, kappa_x, quartic
from .steady import l, q
from .theorems import kappa
from .transient_edges import right
from .transient_motion import a
from .transient_rates import QUADRATIC, sigma, steady_sliding
from .transient_scaling import eps

(
    B_z, B_x, damper_share, T_z, T_x, S_z, S_x, support_rate, S_c, coupling, uncoupled, rise,
    own_rise, hurwitz, soft, Omega, Omega_plus, Omega_minus, bias, onset_square, spread, onset_sum,
    lag_plus, c_1, c_2, b_1, b_2,
) = symbols(r"""
    B_z      -                 1  damping of the contact across the foundation, scaled
    B_x      -                 1  damping of the contact along the foundation, scaled
    n_x      -                 1  damper over the damping of the contact  nonnegative
    T_z      \vartheta_z       1  time of inertia across, over $\tau$
    T_x      \vartheta_x       1  time of inertia along, over $\tau$
    S_z      \varrho_z         1  rate of stiffness across, times $\tau$
    S_x      \varrho_x         1  rate of stiffness along, times $\tau$
    S_s      \varrho_{\mathrm{s}}  1  part of $\varrho_z$ due to the suspension  nonnegative
    S_c      \varrho_{\mathrm{c}}  1  rate of the coupling, times $\tau$
    g_c      \check g          1  strength of the coupling of both motions
    h_c      \check h          1  $1 - \check g$
    e_c      \check e          1  quantity with the sign of $dF/dV$, damper included  real
    e_0      \check e_0        1  $\check e$ of a dead weight without a damper  real
    H_c      \check H          1  determinant of Hurwitz  real
    H_0      \check H_0        1  determinant of Hurwitz without a spring  real
    Omega    \Omega            1  square of the frequency at onset, times $\tau^2$
    Omega_p  \Omega_{+}        1  larger root $\Omega$ of the quadratic of onset  real
    Omega_m  \Omega_{-}        1  smaller root $\Omega$ of the quadratic of onset  real
    m_c      \check m          1  $\check h - \vartheta_z \check g \varrho_{\mathrm{c}}$  real
    D_c      \check D          1  discriminant of the quadratic in $\Omega$, over $\vartheta_z^{4}$  real
    root_c   \check w          1  root of the discriminant of the quadratic in $\Omega$  nonnegative
    n_c      \check n          1  $\check m - 2 \vartheta_z \check e$  real
    p_p      \check p_{+}      1  $\varrho_z - \vartheta_z \Omega_{+}$
    c_h1     \check c_1        1  coefficient of a quadratic factor  real
    c_h2     \check c_2        1  coefficient of a quadratic factor  real
    b_h1     \check b_1        1  coefficient of a quadratic factor
    b_h2     \check b_2        1  coefficient of a quadratic factor
""")  # fmt: skip

PEELED = (1 - q) ** 2 + q
"""1 - q + q**2, without a difference of nearly equal numbers."""
DEAD_WEIGHT_RISE = (1 + q) * (4 * q - 1 - q**2) / (4 * q * PEELED)
RISE = (own_rise + damper_share * (1 + q) / (2 * q)) / (1 + damper_share) + support_rate
ACROSS, ALONG = (T * sigma**2 + sigma + S for T, S in ((T_z, S_z), (T_x, S_x)))
SCALED = ACROSS * ALONG - coupling * sigma * (sigma + S_c)
"""The quartic over both dampings."""
COEFFICIENTS = (S_z * S_x, S_x + rise, T_z * S_x + uncoupled + S_z * T_x, T_z + T_x, T_z * T_x)
"""Of the scaled quartic, from the constant one on."""
_a0, _a1, _a2, _a3, _a4 = COEFFICIENTS
HURWITZ = _a1 * (_a2 * _a3 - _a1 * _a4) - _a3**2 * _a0
REST = T_z**2 * S_x + T_x**2 * S_z + uncoupled * (T_z + T_x) + T_z * T_x * coupling * S_c
SQUARE = bias**2 - 4 * uncoupled * T_z * rise
ONSET = T_z**2 * Omega**2 + (bias - 2 * T_z * rise) * Omega + S_z * rise
"""Vanishes for the square of the frequency at onset."""
REAL_PART = _a4 * Omega**2 - _a2 * Omega + _a0
"""Of the scaled quartic at the rate i sqrt(Omega)."""
AT_ONSET = Omega * (T_x + (S_c - lag_plus) / (Omega + S_c * lag_plus))

result = Chapter(SECTION)


@result("hurwitz")
def _quadratics(proof: Proof) -> None:
    r"""Rates of a quartic: the condition of Routh and Hurwitz.

    Where the coefficients of the quartic and the determinant are positive, so are $\check b_1 \check b_2$
    and $\check b_1 + \check b_2$, hence both factors; and by the constant and the linear coefficient
    $\check c_1$ and $\check c_2$.

    Argued: Every real quartic has two real quadratic factors, whose roots have negative real parts if and
    only if their coefficients are positive. The converse is plain: products and sums of positive numbers.
    """
    product = (sigma**2 + b_1 * sigma + c_1) * (sigma**2 + b_2 * sigma + c_2)
    a_3, a_2, a_1, a_0 = b_1 + b_2, c_1 + c_2 + b_1 * b_2, b_1 * c_2 + b_2 * c_1, c_1 * c_2
    proof.equal(product, sigma**4 + a_3 * sigma**3 + a_2 * sigma**2 + a_1 * sigma + a_0,
                "two quadratic factors, real")  # fmt: skip
    proof.equal(a_1 * a_2 * a_3 - a_1**2 - a_3**2 * a_0, b_1 * b_2 * ((c_1 - c_2) ** 2 + a_1 * a_3),
                "the determinant of Hurwitz")  # fmt: skip
    proof.where(sp.Gt(a_0, 0), "the constant coefficient is positive")
    for total, parts, what in (
        (c_1 + c_2, c_1**2 + a_0, "two numbers with positive sum and product are positive"),
        (a_1, b_2 * c_1**2 + b_1 * a_0, "as they are if another sum is, with positive weights"),
    ):
        proof.equal(c_1 * total, parts, what)
        proof.holds(parts, ">", 0, "so the first has the sign of the sum")
    proof.done(a_1 * a_2 * a_3 - a_1**2 - a_3**2 * a_0, b_1 * b_2 * ((c_1 - c_2) ** 2 + a_1 * a_3))


@result("F22-numbers")
def _numbers(proof: Proof) -> None:
    r"""The numbers of the rates.

    With both motions divided by their dampings: $\vartheta_z$ and $\vartheta_x$ are times of inertia,
    $\varrho_z$ and $\varrho_x$ rates of stiffness, in units of $\tau$ and $1/\tau$, and $\check g$ is how
    strongly the motions are coupled.
    $\check h$ and $\check e$ decide about stability; the forms are without differences of nearly equal
    numbers.
    """
    steady_sliding(proof)
    proof.define(right, a * q)
    proof.define(B_z, 3 * a * (1 + q) / 4, "the damping of the contact across the foundation")
    proof.define(B_x, a**3 * (1 + q) * PEELED, "and along it")
    proof.equal(right**3 + a**3, B_x, "as in F22-forces")
    proof.define(damper_share, damper / B_x, "the damper beside it")
    proof.define(T_z, eps / B_z, "inertia across")
    proof.define(T_x, eps_x / (B_x + damper), "inertia along")
    proof.define(support_rate, kappa / B_z, "stiffness of the suspension")
    proof.define(S_z, (1 + q) / (2 * q) + support_rate, "and with that of the contact")
    proof.define(S_x, kappa_x / (B_x + damper), "stiffness along")
    proof.define(S_c, (1 + q) / q, "stiffness of the coupling")
    proof.define(
        coupling, 3 * (l * q) ** 2 / ((1 + q) ** 2 * PEELED * (1 + damper_share)), "its strength"
    )
    proof.equal(QUADRATIC, B_z * ACROSS, "across")
    proof.equal(LONGITUDINAL, (B_x + damper) * ALONG, "along")
    proof.recall("F22", (quartic, QUARTIC))
    form = B_z * (B_x + damper) * SCALED
    proof.equal(quartic, form, "and both together")
    own = ((1 + q) ** 2 / (4 * PEELED) + damper_share) / (1 + damper_share)
    proof.define(uncoupled, own, "what is left of the dampings")
    proof.equal(1 - coupling, uncoupled, "positive: without stiffness nothing would grow")
    proof.define(own_rise, DEAD_WEIGHT_RISE, "of a dead weight without a damper")
    proof.define(rise, RISE, "what is left of the stiffness")
    proof.equal(S_z - coupling * S_c, rise, "it has the sign of $dF/dV$ (F22-soft)")
    proof.done(quartic, form)


def lay_down(proof: Proof) -> None:
    """Let the coupling and its stiffness be what is left of the dampings and of the stiffness."""
    proof.define(uncoupled, 1 - coupling, "what is left of the dampings")
    proof.define(rise, S_z - coupling * S_c, "and of the stiffness")


@result("F22-routh", uses=("hurwitz",))
def _routh(proof: Proof) -> None:
    r"""Condition of stability.

    Steady sliding is stable if every coefficient and $\check H$ are positive (Routh and Hurwitz). All
    coefficients are but for $\varrho_x + \check e$, and that one is where $\check H$ is: $\check H > 0$ is
    the whole condition.
    """
    lay_down(proof)
    series = sum(each * sigma**power for power, each in enumerate(COEFFICIENTS))
    proof.define(hurwitz, HURWITZ, "the determinant of Hurwitz")
    proof.equal(_a2 * _a3 - _a1 * _a4, REST, "its bracket: a sum of positive terms")
    proof.holds(REST, ">", 0, r"so $\check H > 0$ says that $\varrho_x + \check e > 0$, too")
    proof.define(bias, uncoupled - T_z * coupling * S_c, "a shorthand")
    square = (2 * T_z**2 * S_x + (T_z + T_x) * bias - 2 * T_z * T_x * rise) ** 2
    form = (square - (T_z + T_x) ** 2 * SQUARE) / (4 * T_z**2)
    proof.equal(hurwitz, form, r"quadratic in $\varrho_x$; its discriminant has no $\vartheta_x$")
    proof.define(soft, sp.Subs(hurwitz, S_x, 0), "without a spring")
    proof.equal(soft, rise * sp.Subs(REST, S_x, 0), "it has the sign of the other factor")
    proof.recall("F22-numbers", quartic)
    over = B_z * (B_x + damper)
    proof.equal(quartic / over, series, "of these coefficients: the quartic by powers of the rate")
    proof.done(hurwitz, form)


@result("F22-onset", uses=("F22-routh",))
def _onset(proof: Proof) -> None:
    r"""Frequency at onset.

    Where stability is lost a rate is imaginary, $\sigma = i \sqrt{\Omega}$. The frequency depends neither on
    the mass nor on the spring along the foundation: the spring only has to be such that with this mass it
    gives this frequency, so that the critical stiffness is linear in the mass.
    """
    lay_down(proof)
    proof.define(bias, uncoupled - T_z * coupling * S_c, "a shorthand")
    proof.define(S_x, (T_z + T_x) * Omega - rise, "the imaginary part of the quartic vanishes")
    proof.equal(REAL_PART, -ONSET, r"its real part does not hold $\vartheta_x$ and $\varrho_x$")
    lag = S_z - T_z * Omega
    proof.equal(lag**2 + uncoupled * Omega - coupling * S_c * lag, ONSET, "complete square")
    proof.done(REAL_PART, -ONSET)


def _frequencies(proof: Proof) -> None:
    """Let the roots of the quadratic be known."""
    lay_down(proof)
    proof.define(bias, uncoupled - T_z * coupling * S_c, "a shorthand")
    proof.where(sp.Gt(SQUARE, 0), "else no frequency is real")
    proof.define(onset_square, SQUARE, "the discriminant")
    proof.define(spread, sp.sqrt(onset_square), "its root")
    proof.define(onset_sum, bias - 2 * T_z * rise, "the linear coefficient of the quadratic")


@result("F22-critical", uses=("F22-routh",))
def _critical(proof: Proof) -> None:
    r"""Critical stiffness.

    $\check H$ vanishes at the stiffnesses of both frequencies. It is positive above the larger one, so
    the critical stiffness is that of $\Omega_{+}$.

    Argued: Where friction falls, $\check e < 0$, the product of the frequencies is negative: $\Omega_{-}$
    does not exist, and every softer spring is unstable. Without a positive root steady sliding is stable
    for every stiffness.
    """
    _frequencies(proof)
    proof.define(Omega_plus, (spread - onset_sum) / (2 * T_z**2), "one frequency")
    proof.define(Omega_minus, -(spread + onset_sum) / (2 * T_z**2), "the other")
    proof.equal(Omega_plus * Omega_minus, S_z * rise / T_z**2, "their product")
    high, low = ((T_z + T_x) * each - rise for each in (Omega_plus, Omega_minus))
    between = (T_z + T_x) * spread / T_z**2
    proof.equal(high - low, between, r"the stiffness at $\Omega_{+}$ is the larger")
    proof.holds(between, ">", 0, "all terms are positive")
    proof.holds(
        S_z * rise / T_z**2, "<", 0, r"$\Omega_{-}$ does not exist", cases=(sp.Lt(rise, 0),)
    )
    proof.define(hurwitz, HURWITZ)
    factors = T_z**2 * (S_x - high) * (S_x - low)
    proof.equal(hurwitz, factors, "it vanishes at the stiffnesses of both frequencies")
    proof.recall("F22-onset", S_x, (REAL_PART, -ONSET))
    zeros = -(T_z**2) * (Omega - Omega_plus) * (Omega - Omega_minus)
    proof.equal(REAL_PART, zeros, "as does the real part of the quartic of F22-onset")
    proof.done(hurwitz, factors)


@result("F22-falling", uses=("F22-critical",))
def _forms(proof: Proof) -> None:
    r"""The same where friction falls.

    Friction that falls with the velocity has one critical stiffness, below which steady sliding is unstable;
    here without a difference of nearly equal numbers, however small the inertia. Where $\check n \le 0$,
    $\Omega_{+}$ of F22-critical has none.
    """
    _frequencies(proof)
    proof.where(sp.Lt(rise, 0), "friction falls")
    proof.where(sp.Gt(onset_sum, 0), "the case of little inertia")
    proof.define(Omega, -2 * S_z * rise / (spread + onset_sum), "of positive terms")
    proof.equal(Omega, (spread - onset_sum) / (2 * T_z**2), r"this is $\Omega_{+}$")
    proof.define(lag_plus, 2 * uncoupled * S_z / (uncoupled + T_z * coupling * S_c + spread),
                 "likewise positive")  # fmt: skip
    proof.equal(S_z - T_z * Omega, lag_plus, "it is this difference")
    proof.equal(lag_plus * (coupling * S_c - lag_plus), uncoupled * Omega, "positive")
    proof.holds(uncoupled * Omega / lag_plus, ">", 0,
                r"so $\check p_{+} < \check g \varrho_{\mathrm{c}} < \varrho_{\mathrm{c}}$")  # fmt: skip
    proof.define(S_x, (T_z + T_x) * Omega - rise, "as in F22-onset")
    proof.equal(S_x, AT_ONSET, "the critical stiffness")
