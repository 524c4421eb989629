r"""Arms beside a damper, the law that contains all others: steady sliding, both limits, free ground (F33).

Spring, damper and arms carry loads that add up, at one length of the contact: what F17 says of each gives
what holds of all. One arm is enough; of several, each term with the stiffness of the arm is a sum.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.step import Proof
from .asymptotics import V_star, alpha, mu_high, mu_low
from .model import C, K, R, V, delta
from .relaxation import arm_ratio, spring_1
from .steady import W, a
from .viscoelastic import (
    SECTION, A, B, D, E, P, arm_load, arm_work, c, dashpots, e, edge_pressure, from_moments, half,
    springpot, springs, twelfth, z,
)  # fmt: skip

tau_1, damping_share, whole_load, whole_work, slow, fast, C_all, fades = symbols(r"""
    tau_1   -                   s        relaxation time of an arm  from scene
    chi_d   \breve \chi_1       1        damping of the damper over that of the arm, $C/(K \tau_1)$
    W_va    \breve W_1          1        load on spring, damper and arm, in units of $K \breve c^3/R$
    F_va    \breve F_1          1        friction force on them, in units of $K \breve c^4/R^2$  real
    m_v1    \breve m_1          1        limit of $\mu R/\breve c$ for low velocity beside a damper
    m_v2    \breve m_2          1        limit of $\mu R/\breve c$ for high velocity beside a damper
    C_all   C_{\Sigma}          N s/m³   damping of damper and arms at low velocity, $C + \sum K_i \tau_i$
    r_d     \breve \varrho      1/s      rate at which free ground relaxes beside a damper
""")

WHOLE = {
    P: half + springpot + arm_ratio * P, A: 1 + springpot + arm_ratio * A,
    D: twelfth + arm_ratio * D,
    E: springpot / 12 + arm_ratio * E, B: springpot / 2 + arm_ratio * B,
}  # fmt: skip
"""The moments of F17 of spring, damper and arm together: those of the damper are 1, 1, 0, 1/12 and 1/2."""
LOAD, WORK = WHOLE[D] + e * WHOLE[P], WHOLE[E] + e**2 * WHOLE[P]

result = Chapter(SECTION)


@result("F33")
def _steady(proof: Proof) -> None:
    r"""Arms beside a damper: steady sliding.

    For $p = K u + C \dot u + \sum s_i$, in units of $K$: $\breve \zeta = C V/(K \breve c)$ is the damper and
    $\breve \beta = K_1/K$ one arm. With more arms $\breve \beta \breve P$ stands for the sum of all $K_i
    \breve P/K$, and so on. Without a damper this is F17-parts, without arms F17-kelvin-voigt.
    """
    from_moments(proof)
    proof.recall("F17-edge", "F17-load", "F17")
    for name, of_spring in zip((edge_pressure, arm_load, arm_work), springs, strict=True):
        proof.asymptote("F17-limits", name, of_spring, "of a spring")
    for name, of_damper in zip((edge_pressure, arm_load, arm_work), dashpots, strict=True):
        proof.asymptote("F17-limits", z * name, of_damper, "of a damper")
    edge, load, work = (
        spring + springpot * damper + arm_ratio * arm
        for spring, damper, arm in zip(
            springs, dashpots, (edge_pressure, arm_load, arm_work), strict=True
        )
    )
    proof.define(e, WHOLE[B] / WHOLE[A], "the excess over half of the contact, as there is")
    proof.equal(edge, sp.S.Zero, "no pressure at the trailing edge")
    proof.define(whole_load, load, "loads add up")
    proof.equal(whole_load, LOAD, "$W R/(K \\breve c^3)$, by the moments of all")
    proof.define(whole_work, work, "and so do friction forces")
    proof.equal(whole_work, WORK, "$F R^2/(K \\breve c^4)$, by the moments of all")


def _over_velocity(proof: Proof) -> None:
    """Let load and friction force be functions of the velocity, by that of the arm."""
    from_moments(proof)
    proof.recall("F33", e, whole_load, whole_work)
    proof.define(
        springpot, damping_share / z, r"$C V/(K \breve c)$, as $\breve z = \breve c/(V \tau_1)$"
    )


@result("F33-low")
def _low(proof: Proof) -> None:
    r"""Arms beside a damper: low velocity.

    The damping of damper and arms adds up: Eq. (42) with $C + \sum K_i \tau_i$, as F18-low says of every
    foundation.
    """
    _over_velocity(proof)
    proof.leading_order(whole_work / whole_load, (damping_share + arm_ratio) / z, z, sp.oo,
                        r"$\mu R/\breve c$")  # fmt: skip


@result("F33-high")
def _high(proof: Proof) -> None:
    r"""Arms beside a damper: high velocity.

    The damper alone is left, whatever the arms are: Eqs. (43) and (45), with $\breve c \to a$.
    """
    _over_velocity(proof)
    edge = (1 + arm_ratio) * z / (2 * damping_share)
    proof.leading_order(half - e, edge, z, 0, r"$x_{\mathrm{TE}}/\breve c$, so $\breve c \to a$")
    proof.leading_order(whole_load, damping_share / (2 * z), z, 0, r"$W R/(K \breve c^3)$")
    proof.leading_order(whole_work / whole_load, sp.Rational(2, 3), z, 0, r"$\mu R/\breve c$")


def _critical(proof: Proof, *, at_load: bool) -> None:
    proof.asymptote("F33-low", whole_work / whole_load, slow)
    proof.asymptote("F33-high", whole_work / whole_load, fast)
    proof.define(V, V_star, "at the velocity at which")
    proof.define(z, c / (V * tau_1), "the length of the contact over that of the arm")
    proof.define(damping_share, C / (K * tau_1), "the damper")
    proof.define(arm_ratio, spring_1 / K, "and the arm")
    proof.define(C_all, C + spring_1 * tau_1, "damping at low velocity")
    proof.define(mu_low, c / R * slow, "F33-low")
    proof.equal(mu_low, C_all * V / (R * K), "Eq. (42) with this damping")
    proof.define(mu_high, a / R * fast, r"F33-high, with $\breve c \to a$")
    third = sp.Rational(1, 3)
    if at_load:
        proof.define(a, sp.sqrt(2 * R * W / (C * V)), r"$W \to C V a^2/(2 R)$, F33-high")
        critical = alpha ** (2 * third) * (R * K**2 * W / (C * C_all**2)) ** third
    else:
        proof.define(a, sp.sqrt(2 * R * delta), "Eq. (28)")
        critical = alpha * K * sp.sqrt(R * delta) / C_all
    proof.root(mu_low - mu_high, V_star, critical, "the two asymptotes meet")


for _label, _name, _at_load in (
    ("F33-critical", "fixed indenter", False), ("F33-critical-weight", "dead weight", True),
):  # fmt: skip
    result(_label, title=f"Arms beside a damper: critical velocity, {_name}", at_load=_at_load,
           text=r"""With more arms $C_{\Sigma} = C + \sum K_i \tau_i$. Without arms this is the critical
           velocity of Kelvin–Voigt (critical-fixed, critical-dead-weight).""")(_critical)  # fmt: skip


@result("F33-free")
def _free(proof: Proof) -> None:
    r"""Arms beside a damper: free ground.

    With $K u + C \dot u + s_1 = 0$ and $\dot s_1 = K_1 \dot u - s_1/\tau_1$ free ground is linear, with the
    compression $u$ among its states: with one arm $u \sim e^{-\breve \varrho t}$ has two rates. They are real
    and positive, with the rate of the arm between them.
    """
    rate = fades
    law = (K - C * rate) * (1 / tau_1 - rate) - spring_1 * rate
    form = C * rate**2 - (K + spring_1 + C / tau_1) * rate + K / tau_1
    proof.equal(law, form, r"it vanishes where $u, s_1 \sim e^{-\breve \varrho t}$")
    proof.holds(
        form.subs(rate, 1 / tau_1), "<", 0, "at the rate of the arm; positive at 0 and beyond"
    )
    spread = (K + spring_1 - C / tau_1) ** 2 + 4 * C * spring_1 / tau_1
    proof.equal((K + spring_1 + C / tau_1) ** 2 - 4 * C * K / tau_1, spread, "the discriminant")
    proof.holds(spread, ">", 0, "two real rates")
    proof.done(law, form)
