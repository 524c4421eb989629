"""The discrete simulator: order and stability of its schemes (F15).

A contact of length L that does not change within a step makes the motion linear in the depth; it is
scaled by the static state, with b = (3/4) L/a_0 for its length, h for the time step over tau, and
z = h b/epsilon = dt C L/M, the stability number.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbol
from ..engine.step import Proof
from .theorems import kappa
from .transient_memory import PUSH, compression, earlier, pushed_by, time, zeta
from .transient_rates import DAMPING, STIFFNESS, quadratic, sigma
from .transient_scaling import eps

letter("d_1", "depth at the end of a step")
letter(r"\Delta x", "spacing of the elements", "m")
letter(r"\Delta t", "step in time", "s")
letter(r"\ell_{\mathrm{c}}", "length of the contact", "m")
letter(r"\hat R", "factor of a step")
letter(r"\hat z", "damping number of a step, the step times the rate of the fast mode")
letter("k_1", "first slope of the Runge-Kutta method")
letter("k_2", "second slope")
letter("k_3", "third slope")
letter("k_4", "fourth slope")
letter(r"\theta", "weight of the end of a step in the velocity")
letter(r"\theta_{+}", r"$\theta - \frac{1}{2}$")
eta = symbol("eta", "weight of the end of a step in the mean force", printed=r"\hat \eta")
letter(r"\hat D", "relative change in a step")
b = symbol("b", "damping of the contact in the elements' motion, scaled", printed=r"b_{\mathrm{e}}")
polynomial = symbol(
    "m_e", r"characteristic polynomial of a step, in $\hat D$", latex=r"\hat m", real=True
)
letter(r"\varpi", r"variable of the half plane, $\hat D = 2 \varpi/(1 - \varpi)$")
letter("v_0", "scaled velocity at the beginning of a step")
letter("v_1", "scaled velocity at the end of a step")
letter(r"\hat \varrho", "residual of the exact motion in the equation of a step")
letter(r"\hat \varrho_1", "bounded factor of a remainder")
letter(r"\hat \varrho_2", "bounded factor of a remainder")
letter(r"\hat \varrho_3", "bounded factor of a remainder")
letter("p_e", "pressure at the leading edge", "Pa")
letter("p_s", "slope of the pressure there", "Pa/m")
letter(r"\hat \eta_{+}", r"$\hat\eta - \frac{1}{2}$")
letter("c_0", "constant coefficient of a quadratic")
letter("c_1", "linear coefficient of a quadratic")
letter("c_2", "quadratic coefficient of a quadratic")
letter(r"\tilde x", "real part of a root")
letter(r"\tilde y", "imaginary part of a root")

SECTION = "Discrete elements"

_h, _z, _y = sp.symbols("h z E", positive=True)
_theta = sp.Symbol("theta", positive=True)
_excess = sp.Symbol("theta_+", nonnegative=True)
_beyond = sp.Symbol("eta_+", positive=True)
_R, _D, _w = sp.symbols("R D w", real=True)
_k1, _k2, _k3, _k4 = sp.symbols("k_1:5", real=True)
_rest = sp.symbols("r_1:4", real=True)
_end, _pressure_rate = sp.symbols("p_e p_s", real=True)

CUBIC = 24 - 12 * _z + 4 * _z**2 - _z**3
"""Its real root is the stability limit of the classical Runge-Kutta method on the negative axis."""
RUNGE_KUTTA = 1 - _z + _z**2 / 2 - _z**3 / 6 + _z**4 / 24
THETA_STEP = (1 - (1 - _theta) * _z) / (1 + _theta * _z)
FIT = 1 / (1 - sp.exp(-_z)) - 1 / _z
"""theta of the exponential scheme."""
MOTION = eps * _D**2 / _h**2 + (1 + _theta * _D) * (b + kappa + (b * eta + kappa * _theta) * _D)
"""Vanishes for the relative change D of the depth in a step of an implicit scheme."""
WEIGHT = 1 / (1 - sp.exp(-_h))
"""eta: the weight of a change of the depth within the step in the mean force of F8."""

result = Chapter(SECTION)


@result("F15-runge-kutta")
def _runge_kutta(proof: Proof) -> None:
    r"""Stability limit of the paper's scheme.

    The fast mode, $d'' = -(b/\varepsilon) d'$ (compare F12), is the damping of the mass $M$ by the damping $C
    L$ of all elements in contact. A step of length $\Delta t$ of the classical Runge-Kutta method multiplies
    the velocity by $R(z)$, $z = \Delta t\, C L/M$. With $\Delta t = 2 \Delta x/V$ the paper's simulation
    becomes unstable below $V = 2 \Delta x\, C L/(2.785 M)$.
    """
    proof.recall("F12-linear", quadratic)
    proof.define(b, DAMPING, "of the length of the contact")
    fast = (quadratic - STIFFNESS) / sigma
    proof.root(fast, sigma, -b / eps, "fast mode: the mass is stopped before the spring is felt")
    for stage, at in ((_k1, 0), (_k2, _k1 / 2), (_k3, _k2 / 2), (_k4, _k3)):
        proof.define(stage, -_z * (1 + at), "slope of the velocity")
    proof.define(_R, 1 + (_k1 + 2 * _k2 + 2 * _k3 + _k4) / 6, "after one step")
    proof.equal(_R, RUNGE_KUTTA, "the Taylor series of $e^{-z}$ to the fourth order")
    proof.equal(1 - _R, _z * CUBIC / 24, r"so that $R \le 1$ as long as the cubic is positive")
    proof.sign(1 + _R, ">", 0, (_z, 0, sp.oo), "the other bound is never reached")
    proof.unique_root(CUBIC, (_z, 0, sp.oo), "one limit")
    stable, unstable = sp.Rational(2785, 1000), sp.Rational(2786, 1000)
    proof.sign(CUBIC, ">", 0, (_z, 0, stable), r"stable for $z \le 2.785$")
    proof.sign(CUBIC, "<", 0, (_z, unstable, sp.oo), r"unstable for $z \ge 2.786$")
    proof.done(_R, RUNGE_KUTTA)


@result("F15-euler")
def _euler(proof: Proof) -> None:
    """Stability limit of Euler's method.

    The same mode by explicit Euler steps.
    """
    proof.recall("F15-runge-kutta", _k1)
    proof.define(_R, 1 + _k1, "after one step")
    proof.equal(1 - _R**2, _z * (2 - _z), r"positive exactly for $z < 2$")
    proof.sign(_z * (2 - _z), ">", 0, (_z, 0, 2), "stable")
    proof.sign(_z * (2 - _z), "<", 0, (_z, 2, sp.oo), "unstable")
    proof.done(1 - _R**2, _z * (2 - _z))


@result("element-mean-force")
def _mean_force(proof: Proof) -> None:
    """Mean force on an element.

    The memory of F8 gives the pressure on an element, averaged over a step with the weight $e^{s}$, from the
    compressions at its ends alone. It is never negative, and differs from the plain mean by $h^2/12$ times
    the rate of the pressure.
    """
    u = compression
    over = (zeta, time, time + _h)
    pushed = sp.Integral(sp.exp(zeta) * PUSH(zeta), over)
    proof.holds(pushed, ">=", 0, "no element pulls")
    proof.recall("F8", pushed_by(), at={earlier: time, time: time + _h})
    weights = sp.Integral(sp.exp(zeta), over)
    whole = sp.exp(time + _h) - sp.exp(time)
    proof.integral(weights, sp.exp(zeta), over, "the weights", value=whole)
    mean = (u(time + _h) - sp.exp(-_h) * u(time)) / (1 - sp.exp(-_h))
    proof.equal(pushed / weights, mean, "the mean, which is zero for an element without contact")
    _centre(proof)
    proof.done(pushed / weights, mean)


def mean_push() -> sp.Expr:
    """Return the mean pressure over a step, as element-mean-force has it."""
    over = (zeta, time, time + _h)
    return sp.Integral(sp.exp(zeta) * PUSH(zeta), over) / sp.Integral(sp.exp(zeta), over)


def _centre(proof: Proof) -> None:
    """Derive the centre of the weights, and from it the effect of a changing pressure on the mean."""
    over = (zeta, 0, _h)
    first = zeta * sp.exp(zeta)
    weights = sp.exp(_h) - 1
    moment = 1 + (_h - 1) * sp.exp(_h)
    proof.integral(sp.Integral(first, over), first, over, "the moment of the weights", value=moment)
    centre = _h * WEIGHT - 1
    proof.equal(moment / weights, centre, "the centre of the weights")
    proof.leading_order(centre - _h / 2, _h**2 / 12, _h, 0,
                        "its distance behind the middle of the step")  # fmt: skip
    line = _end + _pressure_rate * zeta
    proof.integral(sp.Integral(line, over), line, over, "a pressure that changes linearly",
                   value=_h * (_end + _pressure_rate * _h / 2))  # fmt: skip
    weighted = sp.exp(zeta) * line
    proof.integral(sp.Integral(weighted, over), weighted, over, "and with the weights",
                   value=weights * (_end + _pressure_rate * centre))  # fmt: skip
    proof.leading_order((_end + _pressure_rate * centre) - (_end + _pressure_rate * _h / 2),
                        _pressure_rate * _h**2 / 12, _h, 0, "the difference of the two means")  # fmt: skip


@result("element-fit")
def _fitted(proof: Proof) -> None:
    r"""Exponential fit of the damping.

    The step $v_1 = v_0 - z [(1-\theta) v_0 + \theta v_1]$ multiplies the velocity of the fast mode by $[1 -
    (1-\theta) z]/(1 + \theta z)$. With $\theta = 1/(1 - e^{-z}) - 1/z$ this is exact, whatever the step;
    $\theta$ lies between $1/2$ and 1.
    """
    proof.define(_theta, FIT, "the weight of the end of the step")
    proof.equal(THETA_STEP, sp.exp(-_z), "the exact decay of the velocity")
    below = _z * (1 + sp.exp(-_z)) / 2 - (1 - sp.exp(-_z))
    above = 1 - (1 + _z) * sp.exp(-_z)
    for difference, gap in ((_theta - sp.S.Half, below), (1 - _theta, above)):
        proof.equal(difference, gap / (_z * (1 - sp.exp(-_z))), "to compare")
        proof.holds(gap, ">", 0, "it begins at 0 and rises")
    proof.leading_order(_theta, sp.Rational(1, 2), _z, 0, "the trapezoidal rule")
    proof.recall("F15-runge-kutta", sigma)
    proof.define(_z, _h * b / eps, "the step of that mode")
    proof.equal(sp.exp(-_z), sp.exp(sigma * _h), "its exact decay")
    proof.done(THETA_STEP, sp.exp(-_z))


@result("element-stability")
def _unconditional(proof: Proof) -> None:
    r"""Stability at any step.

    Both implicit schemes: $\varepsilon (v_1 - v_0)/h = -b\,[d_0 + \eta (d_1 - d_0)] - \kappa\,[(1-\theta) d_0
    + \theta d_1]$ with $\eta = 1/(1 - e^{-h})$ from the mean force, and $d_1 - d_0 = h [(1-\theta) v_0 +
    \theta v_1]$. A quadratic with positive coefficients has its roots in the left half plane: no mode grows,
    for any step, mass, spring and contact, if $\theta \ge 1/2$.
    """
    second = eps / _h**2 + _theta * (b * eta + kappa * _theta)
    first = _theta * (b + kappa) + b * eta + kappa * _theta
    zeroth = b + kappa
    form = second * _D**2 + first * _D + zeroth
    proof.define(polynomial, MOTION, "a step multiplies the depth by $1 + D$ where it vanishes")
    proof.equal(polynomial, form, "by powers of this change")
    lead = 4 * eps / _h**2 + b * (2 * _theta - 1) * (2 * eta - 1) + kappa * (2 * _theta - 1) ** 2
    middle = 2 * (b * (_theta + eta - 1) + kappa * (2 * _theta - 1))
    proof.equal(
        MOTION.subs(_D, 2 * _w / (1 - _w)),
        sum(each / (1 - _w) ** 2 for each in (lead * _w**2, middle * _w, zeroth)),
        r"at $D = 2 w/(1 - w)$ it is $(c_2 w^2 + c_1 w + c_0)/(1 - w)^2$: the outside of the unit "
        "circle becomes a half plane",
    )
    u, change = compression(time), compression(time + _h) - compression(time)
    proof.recall("element-mean-force")
    proof.equal(mean_push(), u + WEIGHT * change, r"the mean force, with $\eta = 1/(1 - e^{-h})$")
    half = sp.Rational(1, 2)
    proof.sign(1 / (1 - _y) - half, ">", 0, (_y, 0, 1), r"$\eta > \frac{1}{2}$, with $E = e^{-h}$")
    proof.define(_theta, half + _excess, r"$\theta_{+} \ge 0$, as by (element-fit)")
    proof.define(eta, half + _beyond, r"and $\eta_{+} > 0$")
    proof.holds(lead, ">", 0, "the coefficient $c_2$")
    proof.holds(middle, ">", 0, "$c_1$")
    proof.holds(zeroth, ">", 0, "and $c_0$")
    _routh(proof)
    proof.done(polynomial, form)


def _routh(proof: Proof) -> None:
    """Prove that a quadratic with positive coefficients has no root in the right half plane."""
    leads = sp.symbols("c_2 c_1 c_0", positive=True)
    real, imaginary = sp.Symbol("x", nonnegative=True), sp.Symbol("y", real=True)
    place = real + sp.I * imaginary
    value = sp.expand(leads[0] * place**2 + leads[1] * place + leads[2])
    parts = sp.re(value), sp.im(value)
    shown = leads[0] * (real**2 - imaginary**2) + leads[1] * real + leads[2]
    slope = 2 * leads[0] * real + leads[1]
    factor = (1 + _w) / (1 - _w)
    proof.equal(1 + 2 * _w / (1 - _w), factor, r"$1 + D$, the factor of a step")
    proof.equal((1 + real) ** 2 - (1 - real) ** 2, 4 * real,
                r"$|1 + w|^2 - |1 - w|^2$ at $w = x + i y$: a mode grows only if $x > 0$")  # fmt: skip
    proof.equal(parts[1], imaginary * slope, r"imaginary part of $c_2 w^2 + c_1 w + c_0$ there")
    proof.holds(slope, ">", 0, r"so for $x \ge 0$ it vanishes for $y = 0$ only")
    proof.equal(parts[0], shown, "real part")
    proof.holds(shown.subs(imaginary, 0), ">", 0, "which is positive there: no root has $x \\ge 0$")


@result("element-orders")
def _orders(proof: Proof) -> None:
    r"""Order in time.

    The exact motion $e^{\sigma s}$, with $\varepsilon \sigma^2 + b \sigma + b + \kappa = 0$, is inserted into
    the equation of a step, $\varepsilon D^2/h^2 + (1 + \theta D) [b + \kappa + (b \eta + \kappa \theta) D] =
    0$ with $D = e^{\sigma h} - 1$. The residual $r$ is of the order of the scheme in $h$.
    """
    growth = sp.exp(sigma * _h) - 1
    proof.leading_order(growth, sigma * _h, _h, 0, "$D$")
    proof.leading_order(WEIGHT, 1 / _h, _h, 0, r"$\eta$")
    trapezoid = sp.Rational(1, 2) + _z / 12
    proof.leading_order(FIT, trapezoid, _z, 0, r"$\theta$, with $z = h b/\varepsilon$")
    D = sigma * _h * (1 + sigma * _h / 2 + (sigma * _h) ** 2 / 6 + _h**3 * _rest[0])
    weight = (1 + _h / 2 + _h**2 / 12 + _h**3 * _rest[1]) / _h
    fit = sp.Rational(1, 2) + b * _h / (12 * eps) + _h**3 * _rest[2]
    proof.define(_D, D, r"with a bounded $r_1$")
    proof.define(eta, weight, r"with a bounded $r_2$")
    proof.define(kappa, -eps * sigma**2 - b * sigma - b, "the exact rates")
    proof.recall("element-stability")
    proof.where(sp.Gt(fit, 0), "a short step")
    first = -_h * sigma * (b * sigma + b + 2 * eps * sigma**2) / 2
    second = (
        -(_h**2)
        * sigma
        / (12 * eps)
        * (b**2 * sigma + b**2 + 3 * b * eps * sigma**2 - b * eps + 2 * eps**2 * sigma**3)
    )
    for theta, leading, why in (
        (sp.S.One, first, r"order one, $\theta = 1$"),
        (fit, second, r"order two, fitted $\theta$ with a bounded $r_3$"),
    ):
        step = sp.Subs(polynomial, _theta, theta)
        proof.leading_order(step, leading, _h, 0, why, short=True)
