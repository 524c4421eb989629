"""Where steady sliding with a spring in the drive is stable (F22): the critical stiffness in closed form."""

from functools import partial

import sympy as sp

from .record import Derivation
from .spring_drive import COUPLING, LONGITUDINAL, SECTION
from .step import Proof
from .symbols import (
    B_x,
    B_z,
    Omega,
    Omega_minus,
    Omega_plus,
    S_c,
    S_x,
    S_z,
    T_x,
    T_z,
    a,
    bias,
    constant,
    coupling,
    damper,
    damper_share,
    eps,
    eps_x,
    hurwitz,
    kappa,
    kappa_x,
    l,
    lag_plus,
    linear,
    onset_square,
    onset_sum,
    own_rise,
    q,
    right,
    rise,
    sigma,
    spread,
    support_rate,
    uncoupled,
)  # fmt: skip
from .transient_rates import QUADRATIC, steady_sliding

PEELED = (1 - q) ** 2 + q
"""1 - q + q**2, without a difference of nearly equal numbers."""
DEAD_WEIGHT_RISE = (1 + q) * (4 * q - 1 - q**2) / (4 * q * PEELED)
RISE = (own_rise + damper_share * (1 + q) / (2 * q)) / (1 + damper_share) + support_rate
ACROSS, ALONG = (T * sigma**2 + sigma + S for T, S in ((T_z, S_z), (T_x, S_x)))
SCALED = ACROSS * ALONG - coupling * sigma * (sigma + S_c)
"""The quartic over both dampings."""
COEFFICIENTS = (
    S_z * S_x,
    S_x + rise,
    T_z * S_x + uncoupled + S_z * T_x,
    T_z + T_x,
    T_z * T_x,
)
"""Of the scaled quartic, from the constant one on."""
_a0, _a1, _a2, _a3, _a4 = COEFFICIENTS
HURWITZ = _a1 * (_a2 * _a3 - _a1 * _a4) - _a3**2 * _a0
REST = T_z**2 * S_x + T_x**2 * S_z + uncoupled * (T_z + T_x) + T_z * T_x * coupling * S_c
SQUARE = bias**2 - 4 * uncoupled * T_z * rise
ONSET = T_z**2 * Omega**2 + (bias - 2 * T_z * rise) * Omega + S_z * rise
"""Vanishes for the square of the frequency at onset."""
AT_ONSET = Omega * (T_x + (S_c - lag_plus) / (Omega + S_c * lag_plus))

_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove when steady sliding is stable."""
    return _quadratics(), _numbers(), _routh(), _onset(), _critical(), _forms()


def _quadratics() -> Derivation:
    proof = _theorem("hurwitz", title="Rates of a quartic: the condition of Routh and Hurwitz",
                     text=_LEMMA)  # fmt: skip
    (b_1, b_2), (c_1, c_2) = linear, constant
    product = (sigma**2 + b_1 * sigma + c_1) * (sigma**2 + b_2 * sigma + c_2)
    a_3, a_2, a_1, a_0 = b_1 + b_2, c_1 + c_2 + b_1 * b_2, b_1 * c_2 + b_2 * c_1, c_1 * c_2
    proof.equal(product, sigma**4 + a_3 * sigma**3 + a_2 * sigma**2 + a_1 * sigma + a_0,
                "two quadratic factors, real")  # fmt: skip
    proof.equal(a_1 * a_2 * a_3 - a_1**2 - a_3**2 * a_0, b_1 * b_2 * ((c_1 - c_2) ** 2 + a_1 * a_3),
                "the determinant of Hurwitz")  # fmt: skip
    proof.where(sp.Gt(a_0, 0))
    for total, parts, what in (
        (c_1 + c_2, c_1**2 + a_0, "two numbers with positive sum and product are positive"),
        (a_1, b_2 * c_1**2 + b_1 * a_0, "as they are if another sum is, with positive weights"),
    ):
        proof.equal(c_1 * total, parts, what)
        proof.holds(parts, ">", 0, "so the first has the sign of the sum")
    return proof.done(a_1 * a_2 * a_3 - a_1**2 - a_3**2 * a_0,
                      b_1 * b_2 * ((c_1 - c_2) ** 2 + a_1 * a_3))  # fmt: skip


_LEMMA = (
    "Every real quartic has two real quadratic factors, whose roots have negative real parts if and only "
    "if their coefficients are positive; then those of the quartic and the determinant are positive. "
    r"Conversely, where these are, $\check b_1 \check b_2$ and $\check b_1 + \check b_2$ are positive, "
    r"and so both; and by the constant and the linear coefficient $\check c_1$ and $\check c_2$."
)


def _numbers() -> Derivation:
    proof = _theorem("F22-numbers", title="The numbers of the rates", text=_SIX, uses=("F22",))
    steady_sliding(proof)
    proof.define(right, a * q)
    proof.define(B_z, 3 * a * (1 + q) / 4, "the damping of the contact across the foundation")
    proof.define(B_x, a**3 * (1 + q) * PEELED, "and along it")
    proof.equal(right**3 + a**3, B_x, "indeed")
    proof.define(damper_share, damper / B_x)
    proof.define(T_z, eps / B_z)
    proof.define(T_x, eps_x / (B_x + damper))
    proof.define(support_rate, kappa / B_z)
    proof.define(S_z, (1 + q) / (2 * q) + support_rate)
    proof.define(S_x, kappa_x / (B_x + damper))
    proof.define(S_c, (1 + q) / q)
    proof.define(coupling, 3 * (l * q) ** 2 / ((1 + q) ** 2 * PEELED * (1 + damper_share)))
    proof.equal(QUADRATIC, B_z * ACROSS, "across")
    proof.equal(LONGITUDINAL, (B_x + damper) * ALONG, "along")
    whole, form = QUADRATIC * LONGITUDINAL - COUPLING, B_z * (B_x + damper) * SCALED
    proof.equal(whole, form, "and both together")
    own = ((1 + q) ** 2 / (4 * PEELED) + damper_share) / (1 + damper_share)
    proof.define(uncoupled, own)
    proof.equal(1 - coupling, uncoupled, "positive: without stiffness nothing would grow")
    proof.define(own_rise, DEAD_WEIGHT_RISE)
    proof.define(rise, RISE)
    proof.equal(S_z - coupling * S_c, rise, "it has the sign of $dF/dV$ (F22-soft)")
    return proof.done(whole, form)


_SIX = (
    r"With both motions divided by their dampings: $\vartheta$ are times of inertia, $\varrho$ rates of "
    r"stiffness, in units of $\tau$ and $1/\tau$, and $\check g$ is how strongly the motions are coupled. "
    r"$\check h$ and $\check e$ decide about stability; the forms are without differences of nearly equal "
    "numbers."
)


def lay_down(proof: Proof) -> None:
    """Let the coupling and its stiffness be what is left of the dampings and of the stiffness."""
    proof.define(uncoupled, 1 - coupling)
    proof.define(rise, S_z - coupling * S_c)


def _routh() -> Derivation:
    proof = _theorem(
        "F22-routh", title="Condition of stability", text=_ROUTH, uses=("F22-numbers", "hurwitz")
    )
    lay_down(proof)
    series = sum(each * sigma**power for power, each in enumerate(COEFFICIENTS))
    proof.equal(SCALED, series, "by powers of the rate")
    proof.define(hurwitz, HURWITZ, "the determinant of Hurwitz")
    proof.equal(_a2 * _a3 - _a1 * _a4, REST, "one part of it")
    proof.holds(REST, ">", 0, r"so $\check H > 0$ says that $\varrho_x + \check e > 0$, too")
    proof.define(bias, uncoupled - T_z * coupling * S_c)
    square = (2 * T_z**2 * S_x + (T_z + T_x) * bias - 2 * T_z * T_x * rise) ** 2
    form = (square - (T_z + T_x) ** 2 * SQUARE) / (4 * T_z**2)
    proof.equal(
        hurwitz, form, r"quadratic in $\varrho_x$; its discriminant does not hold $\vartheta_x$"
    )
    proof.equal(sp.Subs(hurwitz, S_x, 0), rise * sp.Subs(REST, S_x, 0), "without a spring")
    return proof.done(hurwitz, form)


_ROUTH = (
    r"Steady sliding is stable if every coefficient and $\check H$ are positive (Routh and Hurwitz). All "
    r"coefficients are but for $\varrho_x + \check e$, and that one is where $\check H$ is: $\check H > 0$ "
    "is the whole condition."
)


def _onset() -> Derivation:
    proof = _theorem("F22-onset", title="Frequency at onset", text=_ONSET, uses=("F22-routh",))
    lay_down(proof)
    proof.define(bias, uncoupled - T_z * coupling * S_c)
    proof.define(S_x, (T_z + T_x) * Omega - rise, "the imaginary part of the quartic vanishes")
    real = _a4 * Omega**2 - _a2 * Omega + _a0
    proof.equal(real, -ONSET, r"its real part does not hold $\vartheta_x$ and $\varrho_x$")
    lag = S_z - T_z * Omega
    proof.equal(lag**2 + uncoupled * Omega - coupling * S_c * lag, ONSET, "another form of it",
                left=r"(\varrho_z - \vartheta_z \Omega)^2 + \check h \Omega - \check g \varrho_{\mathrm{c}} "
                r"(\varrho_z - \vartheta_z \Omega)")  # fmt: skip
    return proof.done(real, -ONSET)


_ONSET = (
    r"Where stability is lost a rate is imaginary, $\sigma = i \sqrt{\Omega}$. The frequency depends "
    "neither on the mass nor on the spring along the foundation: the spring only has to be such that with "
    "this mass it gives this frequency, so that the critical stiffness is linear in the mass."
)


def _frequencies(proof: Proof) -> None:
    """Let the roots of the quadratic be known."""
    lay_down(proof)
    proof.define(bias, uncoupled - T_z * coupling * S_c)
    proof.where(sp.Gt(SQUARE, 0), "else no frequency is real")
    proof.define(onset_square, SQUARE)
    proof.define(spread, sp.sqrt(onset_square))
    proof.define(onset_sum, bias - 2 * T_z * rise)


def _critical() -> Derivation:
    proof = _theorem(
        "F22-critical", title="Critical stiffness", text=_CRITICAL, uses=("F22-routh", "F22-onset")
    )
    _frequencies(proof)
    proof.define(Omega_plus, (spread - onset_sum) / (2 * T_z**2))
    proof.define(Omega_minus, -(spread + onset_sum) / (2 * T_z**2))
    for each in (Omega_plus, Omega_minus):
        proof.equal(ONSET.subs(Omega, each), sp.S.Zero, "a root of the quadratic of F22-onset")
    proof.equal(Omega_plus * Omega_minus, S_z * rise / T_z**2, "their product")
    high, low = ((T_z + T_x) * each - rise for each in (Omega_plus, Omega_minus))
    between = (T_z + T_x) * spread / T_z**2
    proof.equal(high - low, between, r"the stiffness at $\Omega_{+}$ is the larger")
    proof.holds(between, ">", 0, "all terms are positive")
    proof.holds(
        S_z * rise / T_z**2, "<", 0, r"$\Omega_{-}$ does not exist", cases=(sp.Lt(rise, 0),)
    )
    proof.define(hurwitz, HURWITZ)
    proof.equal(hurwitz, T_z**2 * (S_x - high) * (S_x - low), "F22-onset gives both roots")
    return proof.done(hurwitz, T_z**2 * (S_x - high) * (S_x - low))


_CRITICAL = (
    r"$\check H$ vanishes at the stiffnesses of both frequencies. It is positive above the larger one, so "
    r"the critical stiffness is that of $\Omega_{+}$. Where friction falls, $\check e < 0$, the product of "
    r"the frequencies is negative: $\Omega_{-}$ does not exist, and every softer spring is unstable. "
    "Without a positive root steady sliding is stable for every stiffness."
)


def _forms() -> Derivation:
    proof = _theorem(
        "F22-falling", title="The same where friction falls", text=_FALLING, uses=("F22-critical",)
    )
    _frequencies(proof)
    proof.where(sp.Lt(rise, 0), "friction falls")
    proof.where(sp.Gt(onset_sum, 0))
    proof.define(Omega, (spread - onset_sum) / (2 * T_z**2), r"this is $\Omega_{+}$")
    proof.equal(Omega, -2 * S_z * rise / (spread + onset_sum), "of positive terms")
    proof.define(lag_plus, S_z - T_z * Omega)
    proof.equal(
        lag_plus, 2 * uncoupled * S_z / (uncoupled + T_z * coupling * S_c + spread), "likewise"
    )
    proof.equal(lag_plus * (coupling * S_c - lag_plus), uncoupled * Omega, "positive")
    proof.holds(uncoupled * Omega / lag_plus, ">", 0,
                r"so $\check p_{+} < \check g \varrho_{\mathrm{c}} < \varrho_{\mathrm{c}}$")  # fmt: skip
    proof.define(S_x, (T_z + T_x) * Omega - rise)
    proof.equal(S_x, AT_ONSET, "the critical stiffness")
    return proof.done(S_x, AT_ONSET)


_FALLING = (
    "Friction that falls with the velocity has one critical stiffness, below which steady sliding is "
    "unstable; here without a difference of nearly equal numbers, however small the inertia. Where "
    r"$\check n \le 0$, $\Omega_{+}$ of F22-critical has none."
)
