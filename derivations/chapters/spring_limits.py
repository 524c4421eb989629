"""When steady sliding on a spring is stable at once: limits, and what friction does (F22)."""

from collections.abc import Mapping

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbols
from ..engine.record import Table
from ..engine.step import Proof
from . import tables
from .master_curve import PEAK, state_at
from .model import K, M, R, V, g, tau
from .spring_drive import LONGITUDINAL, QUARTIC, SECTION, damper, kappa_x, quartic
from .spring_stability import (
    DEAD_WEIGHT_RISE, HURWITZ, PEELED, REST, RISE, SQUARE, B_x, B_z, Omega_minus, S_c, S_x, S_z,
    T_x, T_z, bias, coupling, damper_share, hurwitz, onset_sum, own_rise, rise, soft, spread,
    support_rate, uncoupled,
)  # fmt: skip
from .steady import q
from .theorems import LOAD, UNIT, kappa, lam
from .transient_edges import left, rho, right
from .transient_motion import a, f_friction
from .transient_rates import at_motion, in_whole_numbers, per_depth, quadratic, steady_sliding
from .transient_scaling import d, d_s, f_normal

lag_minus, T_flutter, sinks = symbols(r"""
    p_m  \check p_{-}      1  $\varrho_z - \vartheta_z \Omega_{-}$
    T_f  \vartheta_{\mathrm{f}}  1  $\vartheta_z$ from which on there is flutter
    d_l  d_\lambda         1  change of the scaled depth with the drive number  real
""")

result = Chapter(SECTION)


@result("F22-flutter", uses=("F22-critical",))
def _flutter(proof: Proof) -> None:
    r"""Flutter where friction rises.

    Friction that rises with the velocity is stable for every stiffness up to the inertia
    $\vartheta_{\mathrm{f}}$.

    Argued: With more, both motions, each damped, drive each other where their frequencies are close:
    steady sliding is unstable between the stiffnesses of $\Omega_{-}$ and $\Omega_{+}$.
    """
    proof.where(sp.Gt(rise, 0), "friction rises")
    proof.where(sp.Gt(S_z - rise, 0), "in motion")
    proof.define(coupling, (S_z - rise) / S_c, "F22-numbers")
    proof.define(bias, uncoupled - T_z * coupling * S_c, "a shorthand")
    more, less = ((sp.sqrt(S_z) + sign * sp.sqrt(rise)) ** 2 for sign in (1, -1))
    proof.define(T_flutter, uncoupled / less, "an inertia")
    other = uncoupled / more
    form = (S_z - rise) ** 2 * (T_z - T_flutter) * (T_z - other)
    proof.equal(SQUARE, form, r"negative between the two: no frequency is real")
    product = 2 * uncoupled * sp.sqrt(S_z * rise)
    apart = 2 * product / (S_z - rise) ** 2
    proof.equal(T_flutter - other, apart, "the one is larger than the other")
    proof.holds(apart, ">", 0, "all terms are positive")
    proof.define(onset_sum, bias - 2 * T_z * rise, "the linear coefficient of the quadratic")
    proof.equal(sp.Subs(onset_sum, T_z, other), product / more,
                r"$\check n > 0$ at the lower and below: no positive $\Omega$ either")  # fmt: skip
    proof.equal(sp.Subs(onset_sum, T_z, uncoupled / less), -product / less, "two from the upper on")
    proof.where(sp.Gt(SQUARE, 0), "a frequency is real")
    proof.define(spread, sp.sqrt(SQUARE), "as in F22-critical")
    proof.where(sp.Lt(onset_sum, 0), r"above $\vartheta_{\mathrm{f}}$")
    proof.define(Omega_minus, -(spread + onset_sum) / (2 * T_z**2), "the lower end")
    proof.equal(Omega_minus, 2 * S_z * rise / (spread - onset_sum), "of positive terms")
    proof.define(lag_minus, S_z - T_z * Omega_minus, "as in F22-falling")
    proof.equal(lag_minus, (uncoupled + T_z * coupling * S_c + spread) / (2 * T_z),
                "a sum of positive terms")  # fmt: skip
    proof.done(SQUARE, form)


@result("F22-soft")
def _soft(proof: Proof) -> None:
    r"""A soft spring.

    $\check H$ has the sign of $\check e$ where $\varrho_x \to 0$, and that is the sign of what friction and
    damper gain with the velocity: a soft spring needs friction that rises. $f_x$ changes directly, and with
    the depth, by $d_\lambda$.
    """
    steady_sliding(proof)
    half = sp.Rational(3, 2)
    value = -half * lam * a * q / (3 * per_depth / 4 + kappa)
    proof.define(sinks, value, "how far it sinks for that")
    slope = a**3 * (1 + q**3) + half * lam * a * (1 + q) * sinks
    proof.recall("F11-start", rho, right, left, "F11", f_normal, f_friction)
    by = {
        (force, variable): at_motion(sp.Derivative(force, variable), {d: a**2, d_s: 0})
        for force in (f_normal, f_friction) for variable in (d, lam)
    }  # fmt: skip
    proof.equal(by[f_normal, lam] + (by[f_normal, d] + kappa) * sinks, sp.S.Zero, "the load stays")
    proof.equal(by[f_friction, lam] + by[f_friction, d] * sinks, slope, "what friction gains")
    proof.define(B_z, 3 * a * (1 + q) / 4, "damping of the contact across")
    proof.define(B_x, a**3 * (1 + q) * PEELED, "and along")
    proof.define(support_rate, kappa / B_z, "stiffness of the suspension")
    proof.define(damper_share, damper / B_x, "the damper beside the contact")
    proof.define(S_z, (1 + q) / (2 * q) + support_rate, "and with that of the contact")
    proof.define(own_rise, DEAD_WEIGHT_RISE, "of a dead weight without a damper")
    proof.define(rise, RISE, "F22-numbers")
    gain = S_z * (slope + damper) / (B_x + damper)
    proof.equal(gain, rise, "what friction and damper gain with velocity")
    proof.recall("F22-routh", soft)
    proof.equal(soft / sp.Subs(REST, S_x, 0), gain, r"so $\check H$ has this sign")
    proof.define(kappa, sp.S.Zero, "dead weight")
    proof.define(damper, sp.S.Zero, "no damper")
    proof.equal(rise, DEAD_WEIGHT_RISE, "rational")
    proof.root(DEAD_WEIGHT_RISE, q, PEAK, "where it changes its sign", over=UNIT)
    proof.recall("F3")
    proof.equal(DEAD_WEIGHT_RISE, sp.S.Zero, "at the friction maximum")
    proof.done(rise, DEAD_WEIGHT_RISE)


@result("F22-limits")
def _limits(proof: Proof) -> None:
    r"""Rigid drive, fixed indenter, no inertia.

    The quartic of F22 is linear in both stiffnesses. One motion alone is stable. Without inertia across
    the foundation $\check H$ is linear in the stiffness: there is one critical stiffness where friction
    falls, and none where it rises.
    """
    proof.recall("F22", (quartic, QUARTIC), "F12-linear", quadratic)
    for stiffness, other, reason in (
        (kappa_x, quadratic, r"all that is left for $\kappa_x \to \infty$, a rigid drive: F12"),
        (
            kappa,
            LONGITUDINAL,
            r"and for $\kappa \to \infty$, a fixed indenter: a damped oscillation",
        ),
    ):
        proof.equal(sp.Derivative(quartic, stiffness), other, reason)
    proof.recall("F22-routh", uncoupled, rise, (hurwitz, HURWITZ))
    light = T_x * (uncoupled * S_x + rise * (uncoupled + S_z * T_x))
    proof.equal(sp.Subs(hurwitz, T_z, 0), light, "a light indenter, across")
    proof.where(sp.Lt(rise, 0), "friction falls")
    proof.root(light, S_x, -rise * (uncoupled + S_z * T_x) / uncoupled, "its critical stiffness")
    proof.done(sp.Subs(hurwitz, T_z, 0), light)


VELOCITIES = (20, 39, 91, 214)
"""In mm/s."""


@result("F22-table1", uses=("F22-critical", "F22-falling", "F22-soft", "table1"))
def _standard(proof: Proof) -> None:
    """Critical stiffness under standard conditions.

    For the dead weight, with $M_x = M$ and no damper. At 20 mm/s friction rises, and steady sliding is stable
    for every stiffness.
    """
    rows = []
    for speed in VELOCITIES:
        at = {**tables.STANDARD, V: sp.Rational(speed, 1000)}
        cubed = ((V * tau) ** 3 * K / (R * M * g)).subs(at)
        quartic, state = state_at(cubed)
        proof.unique_root(quartic, UNIT, f"{in_whole_numbers(cubed)}, at {speed} mm/s")
        rows.append((str(speed), *_onset_at(sp.N(state, 40), at)))
    heads = ("$V$ [mm/s]", "$q$", r"$\check e$", "Critical stiffness [MN/m²]", "Frequency [Hz]")
    proof.done(quartic, 0, table=Table(heads, tuple(rows)))


def _onset_at(state: sp.Expr, at: Mapping[sp.Expr, sp.Expr]) -> tuple[str, ...]:
    """Return q, the rise of friction, critical stiffness and frequency of a dead weight, four digits each."""
    depth, weight = (tables.static_depth / 1).subs(at), (M * g).subs(at)
    half = sp.cbrt(4 / (3 * LOAD.subs(q, state)))
    along = 2 * at[R] / weight
    across = 3 * half * (1 + state) / 4
    known: dict[sp.Expr, sp.Expr] = {
        S_z: (1 + state) / (2 * state),
        S_c: (1 + state) / state,
        rise: DEAD_WEIGHT_RISE.subs(q, state),
        T_z: at[M] * depth / (weight * at[tau] ** 2) / across,
    }
    damping = half**3 * (1 + state) * PEELED.subs(q, state)
    known[T_x] = at[M] * along / at[tau] ** 2 / damping
    known[coupling] = (known[S_z] - known[rise]) / known[S_c]
    known[uncoupled] = 1 - known[coupling]
    known[bias] = (uncoupled - T_z * coupling * S_c).subs(known)
    shown = [f"${float(each):.4g}$" for each in (state, known[rise])]
    if known[rise] > 0:
        return *shown, "--", "--"
    known[onset_sum] = (bias - 2 * T_z * rise).subs(known)
    square = (sp.sqrt(SQUARE) - onset_sum).subs(known) / (2 * known[T_z] ** 2)
    stiffness = ((T_z + T_x) * square - rise).subs(known) * damping / along
    hertz = sp.sqrt(square) / (2 * sp.pi * at[tau])
    return *shown, *(f"{float(sp.N(each, 30)):.4g}" for each in (stiffness / 10**6, hertz))
