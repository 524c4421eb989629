r"""Small motions of an indenter that slides on any Prony series, held by a spring (F24); temperature (F25).

As in F17 everything is linear in the relaxation function, so that one arm is enough: G = K_i e^(-t/tau_i).
To first order the edges do not matter, since the pressure vanishes at both.
"""

import sympy as sp

from ..engine.algebra import antiderivative
from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .groups import k_s
from .model import C, F_x, F_z, M, R, V, delta, t, x
from .relaxation import behind, edge_distance
from .spring_drive import C_x, M_x, k_x, small, x_a
from .steady import F, W, a, x_le
from .theorems import lam
from .transient_edges import left, rho, right
from .transient_motion import f_friction
from .transient_rates import at_motion
from .transient_scaling import d, d_s, f_normal, z_a
from .viscoelastic import arm_number, contact_length, excess_share, half_share, place, springpot

strained = function("x_u", real=True)
kernels = tuple(
    symbol(
        f"phi_r{n}", rf"$\int_0^1 e^{{-\tilde z v}} {share}\, dv$",
        latex=rf"\tilde \phi_{n}", source="F24-kernels",
    )
    for n, share in enumerate(("", "(1 - v)", "(1 - v)^2/2", "(1 - v)^3/6"), 1)
)  # fmt: skip
kernels_still = tuple(
    symbol(
        f"psi_r{n}", rf"$\tilde \phi_{n}$ at $\breve z$", latex=rf"\tilde \psi_{n}", source="F24-kernels"
    )
    for n in range(1, 5)
)  # fmt: skip
(
    swing_rate, time_back, delta_swing, x_swing, swing_u, rate_number, shifted_number, age, fading_depth,
    fading_drag, normal_per_depth, rubbing_per_depth, normal_per_drag, rubbing_per_drag,
    total_normal_per_depth, total_rubbing_per_depth, total_normal_per_drag, total_rubbing_per_drag,
    shift_factor, stiffer,
) = symbols(r"""
    s_r      \tilde s       1/s   rate of a small motion; complex where it oscillates
    t_r      \tilde t       s     time back
    delta_r  \tilde \delta  m     change of the depth, at the time 0  real
    X_r      \tilde X       m     displacement of the indenter, at the time 0  real
    u_r      \tilde u       m     change of the compression of an element  real
    sigma_r  \tilde \sigma  1     $\tilde s \breve c/V$
    z_r      \tilde z       1     $\breve z + \tilde \sigma$
    v_r      \tilde v       1     time back, in units of $\breve c/V$
    alpha_r  \tilde \alpha  1     change of an arm's pressure with the depth, over $K_i$  real
    beta_r   \tilde \beta   1     change of the pressure of an arm with the displacement, in units of
            $K_i \breve c/R$  real
    f_zd     f_{z\delta}    1     change of $F_z$ of an arm with the depth, over $K_i \breve c$
    f_xd     f_{x\delta}    1     change of $F_x$ with the depth, over $K_i \breve c^2/R$  real
    f_zX     f_{zX}         1     change of $F_z$ with the displacement, over $K_i \breve c^2/R$  real
    f_xX     f_{xX}         1     change of $F_x$ with the displacement, over $K_i \breve c^3/R^2$  real
    F_zd     F_{z\delta}    N/m²  change of $F_z$ with the depth
    F_xd     F_{x\delta}    N/m²  change of $F_x$ with the depth  real
    F_zX     F_{zX}         N/m²  change of $F_z$ with the displacement  real
    F_xX     F_{xX}         N/m²  change of $F_x$ with the displacement  real
    a_T      -              1     shift factor of all times by temperature  from scene
    b_T      -              1     factor of all moduli by temperature  from scene
""")  # fmt: skip
memory_warm = function("G_T", "relaxation function at another temperature", "N/m³", real=True)
memory_cold = function("G", "relaxation function at the reference temperature", "N/m³",
                       printed=r"G_{\mathrm{r}}", source="", real=True)  # fmt: skip
temperature, T_ref, wlf_1, wlf_2, activation, gas_constant = symbols(r"""
    T    -               K        temperature  from scene
    T_r  T_{\mathrm{r}}  K        temperature at which the times were measured  from scene
    C_1  -               1        first coefficient of Williams, Landel and Ferry  from scene
    C_2  -               K        second coefficient of Williams, Landel and Ferry  from scene
    E_A  E_{\mathrm{A}}  J/mol    activation energy  from scene
    R_g  R_{\mathrm{g}}  J/(mol K)  gas constant  from constant
""")

result = Chapter("A drive with a spring on rubber")

z, y, b, e, c = arm_number, place, half_share, excess_share, contact_length
sigma, m, v, s = rate_number, shifted_number, age, swing_rate
HALF = sp.Rational(1, 2)
ALPHA = (sigma + z * sp.exp(-m * y)) / m
"""Pressure of an arm for a change of depth, in units of K_i; the next one for a displacement, in K_i c/R."""
BETA = (
    (y - b) * sigma / m - 1 / z + z / m**2
    + (b + 1 / z) * sp.exp(-z * y) - (b + 1 / m) * z / m * sp.exp(-m * y)
)  # fmt: skip


@result("F24-compression")
def _compression(proof: Proof) -> None:
    r"""Rubber: compression in small motions.

    The depth is $\delta + \check \theta \tilde \delta e^{\tilde s t}$, and the indenter is at $\check
    \theta \tilde X e^{\tilde s t}$. The element that is now at $x$ was $\tilde t$ ago where the
    foundation and the indenter had then taken it, and was compressed by $\delta - x^2/2R$ of that place
    and that depth.

    Argued: All that follows is analytic in $\tilde s$: what is proved where it is positive holds in the
    complex plane.
    """
    place_then = x - V * time_back + small * x_swing * (sp.exp(s * t) - sp.exp(s * (t - time_back)))
    then = delta + small * delta_swing * sp.exp(s * (t - time_back)) - place_then**2 / (2 * R)
    fall = sp.exp(-s * time_back)
    value = delta_swing * fall - (x - V * time_back) / R * x_swing * (1 - fall)
    first = sp.Subs(sp.Derivative(then, small), small, 0)
    proof.define(swing_u, first, r"the terms of first order in $\check \theta$")
    proof.equal(swing_u, value * sp.exp(s * t), "due to both motions")


def _numbers(proof: Proof) -> None:
    proof.define(
        m, z + sigma, r"the decay of the arm and the rate $\tilde \sigma = \tilde s \breve c/V$"
    )


@result("F24-arm")
def _arm(proof: Proof) -> None:
    r"""Rubber: pressure of an arm in small motions.

    The pressure of an arm is $K_i [u(0) - \int_0^{\breve x} \breve z e^{-\breve z \tilde v}\, u(\tilde v)\,
    d\tilde v]$, with the time $\tilde v\, \breve c/V$ back. Since $u$ vanishes where an element enters, the
    change of that time is of second order. With the compression of F24-compression the pressure changes by
    $K_i (\tilde \alpha \tilde \delta + \tilde \beta \tilde X \breve c/R) e^{\tilde s t}$.
    """
    _numbers(proof)
    units = {time_back: v * c / V, s: sigma * V / c, x: c * (y - b)}
    proof.recall("F24-compression")
    for name, value in units.items():
        proof.define(name, value, "in units of the contact")
    changes = delta_swing * sp.exp(-sigma * v) - x_swing * c / R * (y - b - v) * (
        1 - sp.exp(-sigma * v)
    )
    proof.equal(swing_u * sp.exp(-s * t), changes, r"compression at the time $\tilde v$ back")
    followed = z * sp.exp(-z * v) * sp.exp(-sigma * v)
    lost = proof.integral(sp.Integral(followed, (v, 0, y)), followed, (v, 0, y),
                          "what the arm has forgotten of it", value=z * (1 - sp.exp(-m * y)) / m)  # fmt: skip
    proof.define(fading_depth, 1 - lost, "the pressure for a change of depth")
    proof.equal(fading_depth, ALPHA, "one less what is forgotten")
    dragged = z * sp.exp(-z * v) * (y - b - v) * (1 - sp.exp(-sigma * v))
    proof.integral(fading_drag, dragged, (v, 0, y), "the pressure for a displacement", value=BETA)


@result("F24-kernels")
def _kernels(proof: Proof) -> None:
    r"""Rubber: four functions of one argument.

    The functions of exponential integrators, at $-\tilde z$ ($\tilde \phi_1$ to $\tilde \phi_4$) and at
    $-\breve z$ ($\tilde \psi_1$ to $\tilde \psi_4$). The integrals lose no digits at small arguments, the
    recurrence none at large ones.
    """
    for number, found in ((m, kernels), (z, kernels_still)):
        before = None
        for n, kernel in enumerate(found, 1):
            weight = (1 - v) ** (n - 1) / sp.factorial(n - 1)
            integrand = weight * sp.exp(-number * v)
            known = 1 / sp.factorial(n - 1)
            value = (1 - sp.exp(-number)) / number if before is None else (known - before) / number
            proof.integral(kernel, integrand, (v, 0, 1),
                           "an exponential" if before is None else "by parts: from the one before",
                           value=value)  # fmt: skip
            before = kernel
    proof.done(kernels[3], (sp.Rational(1, 6) - kernels[2]) / m)


def _recalled(proof: Proof) -> None:
    """Let the kernels stand for their values."""
    _numbers(proof)
    proof.recall("F24-kernels", *kernels, *kernels_still)
    proof.define(b, HALF + e, "F17-edge")


_1, _2, _3, _4 = kernels
_, _S2, _S3, _S4 = kernels_still
FORCES = {
    normal_per_depth: _1 + sigma * _2,
    rubbing_per_depth: _2 + sigma * _3 - (HALF - e) * (_1 + sigma * _2),
    normal_per_drag: z * (_S3 - _3 - (HALF + e) * (_S2 - _2)),
    rubbing_per_drag: -z * (_S3 - _3 - (_S4 - _4) - (sp.Rational(1, 4) - e**2) * (_S2 - _2)),
}
"""Changes of both forces of an arm, in units of K_i c, K_i c^2/R, K_i c^2/R and K_i c^3/R^2."""


@result("F24-forces", uses=("F24-arm",))
def _forces(proof: Proof) -> None:
    r"""Rubber: forces of an arm in small motions.

    In units of $K_i \breve c$, $K_i \breve c^2/R$, again $K_i \breve c^2/R$ and $K_i \breve c^3/R^2$. The
    spring $K$ is an arm with $\breve z = 0$: it adds $1$, $\breve \eta$, $0$ and $0$. A ball is the sum of
    its strips.
    """
    _recalled(proof)
    proof.recall("F24-arm", fading_depth, "F24-arm")
    for name, pressure, form, lever in (
        (normal_per_depth, fading_depth, ALPHA, 1), (rubbing_per_depth, fading_depth, ALPHA, b - y),
        (normal_per_drag, fading_drag, BETA, 1), (rubbing_per_drag, fading_drag, BETA, b - y),
    ):  # fmt: skip
        primitive = antiderivative(form * lever, y)
        proof.integral(name, pressure * lever, (y, 0, 1),
                       "the pressure" if lever == 1 else "the pressure times the slope",
                       value=FORCES[name], antiderivative=primitive)  # fmt: skip


DAMPED = {
    normal_per_depth: 1 + sigma, rubbing_per_depth: HALF + e + e * sigma,
    normal_per_drag: -e * sigma, rubbing_per_drag: -(sp.Rational(1, 12) + e**2) * sigma,
}  # fmt: skip
"""The same of a damper, in units of C V/c for K_i c and so on."""


@result("F24-damper")
def _damper(proof: Proof) -> None:
    r"""Rubber: forces of a damper in small motions.

    The pressure $C \dot u$ of a damper beside the arms jumps at the leading edge, which touches undisturbed
    ground and moves with the depth; at the trailing edge, $\breve c - a$, the pressures of spring, damper and
    arms add up to zero, so that its motion has no effect to first order. With $C V/\breve c$ for $K_i \breve
    z$ the damper changes the forces as a fast arm does (F24-kelvin-voigt).
    """
    swing = sp.exp(s * t)
    depth = delta + small * delta_swing * swing
    proof.where(sp.Gt(depth, 0), "the change is small")
    proof.define(x_le, -sp.sqrt(2 * R * depth), "Eq. (32) at this depth")
    proof.recall("F24-compression")
    rate = s * (delta_swing + x_swing * x / R) * swing
    proof.equal(sp.Subs(-sp.Derivative(swing_u, time_back), time_back, 0), rate,
                r"change of $\dot u$, which is $-V x/R$ in steady sliding")  # fmt: skip
    for force, power, factor, reason in (
        (F_z, 1, C, "the pressure"), (F_x, 2, -C / R, "the pressure times the slope"),
    ):  # fmt: skip
        density = factor * x ** (power - 1) * (small * rate - V * x / R)
        first, second = (((c - a) ** n - x_le**n) / n for n in (power, power + 1))
        value = factor * (
            small * s * (delta_swing * first + x_swing * second / R) * swing - V * second / R
        )
        proof.integral(force, density, (x, x_le, c - a), reason, value=value)
    proof.recall("eq28", delta)
    proof.define(a, c * (HALF + e), "F17-edge")
    proof.define(s, sigma * V / c)
    for force, depth, drag, arm in (
        (F_z, normal_per_depth, normal_per_drag, 1), (F_x, rubbing_per_depth, rubbing_per_drag, c / R),
    ):  # fmt: skip
        change = sp.Subs(sp.Derivative(force, small), small, 0)
        both = DAMPED[depth] * delta_swing + DAMPED[drag] * x_swing * c / R
        proof.equal(change, C * V * arm * both * swing, "to first order, the leading edge included")


@result("F24")
def _rates(proof: Proof) -> None:
    r"""Rates and critical stiffness on rubber.

    With the sums of (F24-forces) over the spring and all arms, and with (F24-damper) beside them, the forces
    change by $F_{z\delta} \tilde \delta + F_{zX} \tilde X$ and $F_{x\delta} \tilde \delta + F_{xX} \tilde X$.
    On the imaginary axis $k_x$ is explicit: $k_x = F_{xX} - M_x \tilde s^2 - C_x \tilde s - F_{zX}
    F_{x\delta}/(M \tilde s^2 + k_s + F_{z\delta})$, and the critical stiffness is the largest real value that
    it takes there.
    """
    A, B, C, D = (
        total_normal_per_depth, total_normal_per_drag, total_rubbing_per_depth, total_rubbing_per_drag,
    )  # fmt: skip
    up = M * s**2 + k_s + A
    along = M_x * s**2 + C_x * s + k_x - D
    across, lengthwise = up * delta_swing + B * x_swing, along * x_swing - C * delta_swing
    both = (up * along + B * C) * delta_swing
    sinks, drags = (sp.Function(name, real=True)(t) for name in (r"\tilde \delta", r"\tilde X"))
    proof.recall("scaled-form", z_a.diff(t, 2), "F22-scaled", x_a.diff(t, 2))
    for name, steady, change in (
        (z_a, -delta, -sinks), (x_a, F / k_x, drags),
        (F_z, W, A * sinks + B * drags), (F_x, F, C * sinks + D * drags),
    ):  # fmt: skip
        proof.define(name, steady + small * change, "steady sliding, and a small change")
    proof.define(sinks.diff(t, 2), s**2 * sinks, r"as $e^{\tilde s t}$")
    for order in (1, 2):
        proof.define(drags.diff(t, order), s**order * drags, r"as $e^{\tilde s t}$")
    for mass, name, motion in (
        (M, z_a, -up * sinks - B * drags),
        (M_x, x_a, along * drags - C * sinks),
    ):
        moved = sp.Derivative(small * {z_a: -sinks, x_a: drags}[name], (t, 2))
        first = sp.Subs(sp.Derivative(mass * (moved - name.diff(t, 2)), small), small, 0)
        proof.equal(first, motion, "the equation of motion, to first order")
    proof.equal(along * across - B * lengthwise, both,
                r"both equations of motion hold: $\tilde X$ is eliminated")  # fmt: skip
    value = D - M_x * s**2 - C_x * s - B * C / up
    proof.define(k_x, value, "the stiffness explicit in the rate")
    proof.equal(up * along + B * C, sp.S.Zero, r"so $\tilde s$ is a rate for this stiffness")
    proof.done(along * across - B * lengthwise, both)


@result("F24-kelvin-voigt")
def _kelvin_voigt(proof: Proof) -> None:
    r"""Rubber: a fast arm is a damper.

    For $\breve z \to \infty$ with $K_i \tau_i = C$ the arm and the spring $K$ give the derivatives of F11,
    lengths in units of $\breve c$ and forces in those of $K \breve c^3/R$: half the length of the contact at
    rest is $\frac{1}{2} + \breve \eta$, and $\lambda = \breve \zeta$. They are approached at first order in
    $\tau_i$.
    """
    _recalled(proof)
    proof.recall("F24-forces", *FORCES)
    far = {"variable": z, "point": sp.oo, "eps": 1 / z}
    for name, limit in DAMPED.items():
        proof.leading_order(
            name, limit / z, **far, reason=r"times $K_i \breve z = C V/\breve c$: a damper"
        )
    zeta = springpot
    shown = r"F17-kelvin-voigt, with $\breve \zeta = l_{\mathrm{r}}/\breve c$"
    proof.define(e, zeta / (2 * (1 + zeta)), shown)
    proof.define(lam, zeta, "the drive number in units of the contact")
    proof.recall("F11-start", rho, right, left, "F11", f_normal, f_friction)
    steady = {d: (HALF + e) ** 2, d_s: 0}
    for factor, force, variable, form, reason in (
        (sp.Rational(4, 3), f_normal, d, 1 + zeta, r"$F_{z\delta}$ at $\tilde s = 0$"),
        (sp.Rational(2, 3), f_friction, d, e + zeta * (HALF + e),
         r"$F_{x\delta}$ at $\tilde s = 0$"),
        (sp.Rational(2, 3), f_normal, lam, e, r"$-F_{zX}$ over $\tilde \sigma \breve \zeta$"),
        (sp.Rational(1, 3), f_friction, lam, sp.Rational(1, 12) + e**2, "$-F_{xX}$ over the same"),
    ):  # fmt: skip
        change = at_motion(sp.Derivative(force, variable), steady)
        proof.equal(factor * change, form, reason)


@result("F25")
def _temperature(proof: Proof) -> None:
    r"""Temperature is velocity.

    The pressure at the distance $\breve X$ behind the leading edge is $\int G_T\, \mathrm{d}u$, for every
    shape and every relaxation function; $x_u(\breve y)$ is the slope of the compression, that of the
    indenter, or behind the contact of the free surface, where it makes the pressure 0.

    Argued: If temperature multiplies all times by $a_T$ and leaves the moduli, $b_T = 1$, then the steady
    state at the velocity $V$ is that at the reference temperature and the velocity $V a_T$, for every
    shape and support. Moduli that change by the factor $b_T$ change the forces by it at the same contact:
    that is the steady state of the load $W/b_T$.
    """
    y, X = edge_distance, behind
    over, rate = (y, 0, X), strained(y)
    proof.define(memory_warm((X - y) / V), stiffer * memory_cold((X - y) / (V * shift_factor)),
                 r"$G_T(t) = b_T G(t/a_T)$: all times and all moduli are shifted alike")  # fmt: skip
    warm = sp.Integral(memory_warm((X - y) / V) * rate, over)
    cold = stiffer * sp.Integral(memory_cold((X - y) / (V * shift_factor)) * rate, over)
    proof.equal(warm, cold, r"the pressure at $V$ is $b_T$ times that at the velocity $V a_T$")


@result("F25-activation")
def _wlf(proof: Proof) -> None:
    r"""Two laws of the shift factor.

    Williams, Landel and Ferry: $\log_{10} a_T = -C_1 (T - T_{\mathrm{r}})/(C_2 + T - T_{\mathrm{r}})$.
    Arrhenius: $\ln a_T = (E_{\mathrm{A}}/R_{\mathrm{g}})(1/T - 1/T_{\mathrm{r}})$. Both fall where the
    temperature rises; by (F25) the velocity of the friction maximum then rises by $1/a_T$.
    """
    T, T_r = temperature, T_ref
    proof.where(sp.Gt(wlf_2 + T - T_r, 0), "above the pole of the equation")
    exponent = -sp.log(10) * wlf_1 * (T - T_r) / (wlf_2 + T - T_r)
    apparent = -gas_constant * T**2 * sp.Derivative(exponent, T)
    value = sp.log(10) * gas_constant * wlf_1 * wlf_2 * T**2 / (wlf_2 + T - T_r) ** 2
    proof.equal(apparent, value, "the apparent activation energy of Williams, Landel and Ferry")
    arrhenius = activation / gas_constant * (1 / T - 1 / T_r)
    proof.equal(-gas_constant * T**2 * sp.Derivative(arrhenius, T), activation, "that of Arrhenius")
    proof.done(apparent, value)
