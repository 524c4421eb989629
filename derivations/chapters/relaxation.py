r"""Steady sliding on a foundation with any relaxation function: theorem F17 without arms, and corollaries.

G(t) is positive, does not rise, and has an integral from t = 0; nothing else is assumed. Where the
chapter before this one adds up arms, this one integrates by parts. Beside it: the surface that the standard
linear solid leaves behind, and the one interval of contact on every Prony series.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .model import F_x, F_z, K, R
from .steady import W, a, x_te
from .viscoelastic import (
    FALL, MOMENTS, SECTION, UNIT, A, B, D, E, P, Q, arm_lost, arm_work, b, contact_length,
    edge_pressure, excess_share, from_moments, from_trailing, spring_share, springs, under_pressure,
    z,
)  # fmt: skip

arm_length = symbol("l_v", r"length over which an arm relaxes, $V \tau_i$", "m", latex="l_i")
memory = function(
    "G_v", "relaxation function, over the distance", "N/m³", printed=r"\breve G", positive=True
)
repeated = tuple(
    function(f"G_v{n}", rf"integral of ${inner}$", unit, printed=rf"\breve G_{n}", nonnegative=True)
    for n, inner, unit in (
        (1, r"\breve G", "N/m²"), (2, r"\breve G_1", "N/m"),
        (3, r"\breve G_2", "N"), (4, r"\breve G_3", "N m"),
    )
)  # fmt: skip
behind = symbol("X_v", "distance from the leading edge", "m", latex=r"\breve X")
edge_distance = symbol(
    "y_v", "distance back from there, or behind the trailing edge", "m", latex=r"\breve y"
)
fading = function("H_v", "rate of decrease of the relaxation function", "Pa/m²",
                  printed=r"\breve H", nonnegative=True)  # fmt: skip
(
    other_trailing, felt, shift, left_behind, arm_ratio, parting, slope_free, pressed, damper_1,
    damper_2, spring_1, spring_2, share_1, share_2, on_off, spare_1, spare_2,
) = symbols(r"""
    v_v       \breve v         1     as $\breve w$, of another position
    J_v       \breve J         1     part of a double integral  real
    h_v       \breve h         1     $\breve a - 1$  real
    u_v       \breve u         m     compression of the free surface
    beta_v    \breve \beta     1     stiffness of the one arm over that of the spring
    sigma_v   \breve \sigma    1     angle between indenter and surface behind the contact
    s_vf      \breve \chi_0    1     slope of the free surface  real
    g_v       \breve g         m     depth of the indenter below the undisturbed surface  real
    u_v1      \breve u_1       m     extension of the dashpot of an arm  nonnegative
    u_v2      \breve u_2       m     extension of the dashpot of another arm  nonnegative
    K_v1      K_1              N/m³  stiffness of one arm per unit area
    K_v2      K_2              N/m³  stiffness of another arm per unit area
    gamma_v1  \breve \gamma_1  1     share of an arm in the glassy stiffness  nonnegative
    gamma_v2  \breve \gamma_2  1     share of another arm  nonnegative
    theta_v   \breve \theta    1     weight of the indenter relative to the free surface  nonnegative
    omega_v1  \breve \omega_1  1     remainder of a bound  nonnegative
    omega_v2  \breve \omega_2  1     remainder of another bound  nonnegative
""")  # fmt: skip

y, X, c, w, l = edge_distance, behind, contact_length, from_trailing, arm_length
e = excess_share
G, (G_1, G_2, G_3, G_4) = memory, repeated
PRESSURE = sp.Lambda(y, (a * G_1(y) - G_2(y)) / R)
PRESSED = sp.Integral(G(y) * (a - X + y) / R, (y, 0, X))
"""The pressure at the distance X from the leading edge."""
LOADED = sp.Integral(PRESSURE(y), (y, 0, c))
"""The load: the pressure over the contact."""
WORKED = sp.Integral((a - y) / R * PRESSURE(y), (y, 0, c))
"""The friction force: its work."""
LOAD = (a * G_2(c) - G_3(c)) / R
WORK = ((a - c) * (a * G_2(c) - G_3(c)) + a * G_3(c) - G_4(c)) / R**2
WEIGHTS = {name: MOMENTS[name][0] for name in (P, D, E)} | {A: sp.S.One, B: (1 - 2 * w) / 2}
"""Of the moments that give load and friction force."""
FALLS = {
    P: w * (2 - w) / 2, D: w**2 * (3 - 2 * w) / 12, E: w * (1 - w) ** 2 * (2 + w) / 24,
    A: w, B: w * (1 - w) / 2,
}  # fmt: skip
"""With which the fall of the relaxation function counts in them: their integrals from the trailing edge."""

result = Chapter(SECTION)


def name_integrals(proof: Proof, count: int, place: sp.Symbol = y) -> None:
    """Name repeated integrals of the relaxation function over the distance back."""
    for integral, part in zip(repeated[:count], (G, *repeated)[:count], strict=True):
        proof.define(sp.Derivative(integral(place), place), part(place), "a repeated integral")
        proof.define(integral(0), sp.S.Zero, "from the leading edge on")


def weighted(name: sp.Symbol) -> sp.Integral:
    """Return a moment of the relaxation function."""
    return sp.Integral(sp.factor(WEIGHTS[name].subs(w, y / c) / c) * G(y), (y, 0, c))


def in_parts(name: sp.Symbol) -> tuple[sp.Integral, sp.Integral]:
    """Return a moment as one of the fall, and the rest, of which only the value at the end is left."""
    fallen = sp.Integral(sp.factor(FALLS[name].subs(w, y / c)) * fading(y), (y, 0, c))
    return fallen, sp.Integral(weighted(name).function - fallen.function, (y, 0, c))


@result("F17-any")
def _pressure(proof: Proof) -> None:
    r"""Any relaxation function: the pressure.

    An element at the distance $\breve X$ behind the leading edge was compressed at the rate $(a - \breve X +
    \breve y)/R$ when it was $\breve y$ ahead of its present position; $\breve G(\breve y) = G(\breve y/V)$,
    and $\breve G_1$ to $\breve G_4$ are its repeated integrals. $G$ need not be a sum of arms.
    """
    name_integrals(proof, 2)
    rate = (a - X + y) / R
    proof.integral(PRESSED, PRESSED.function, (y, 0, X),
                   r"by parts; this is the pressure $p(\breve X)$", value=PRESSURE(X),
                   antiderivative=rate * G_1(y) - G_2(y) / R)  # fmt: skip


@result("F17-concave", uses=("F17-any",))
def _concave(proof: Proof) -> None:
    r"""Any relaxation function: one trailing edge.

    The pressure begins with 0, or with a jump where $G$ holds a dashpot, rises at first and is concave:
    it vanishes at one point behind, the trailing edge.

    Argued: Where $G$ falls by steps, concavity is that of $\int (a - \breve X + \breve y)\, dG$.
    """
    name_integrals(proof, 2)
    proof.recall("F17-any", at={X: c})
    for part in (G_1(c), G_2(c)):
        proof.where(part > 0, "an integral of a positive function")
    proof.root(PRESSED.subs(X, c), a, G_2(c) / G_1(c), "no pressure where the contact ends")
    first = (a * G(y) - G_1(y)) / R
    proof.equal(sp.Derivative(PRESSURE(y), y), first, "slope of the pressure")
    proof.define(sp.Derivative(G(y), y), -fading(y), "G does not increase")
    second = -(a * fading(y) + G(y)) / R
    proof.equal(sp.Derivative(first, y), second, "and its slope")
    proof.holds(second, "<", 0, "the pressure is concave")
    proof.done(sp.Derivative(first, y), second)


@result("F17-forces", uses=("F17-any",))
def _forces(proof: Proof) -> None:
    r"""Any relaxation function: load and friction force.

    With $a = \breve G_2/\breve G_1$ at $\breve c$ everything is explicit in the length $\breve c$ of the
    contact. As $p = \int G u'$, the friction force is the quadratic form $\int p\, u' = \int \int G(\breve X
    - \breve y)\, u'(\breve y)\, u'(\breve X)$ over $\breve y < \breve X$.
    """
    name_integrals(proof, 4)
    over, rate = (y, 0, c), (a - y) / R
    primitive = (a * G_2(y) - G_3(y)) / R
    proof.integral(LOADED, LOADED.function, over, "this is the load $W$", value=LOAD,
                   antiderivative=primitive)  # fmt: skip
    whole = rate * primitive + (a * G_3(y) - G_4(y)) / R**2
    proof.integral(WORKED, WORKED.function, over, "the work of the pressure, which is $F$",
                   value=WORK, antiderivative=whole)  # fmt: skip


@result("F17-growth")
def _growth(proof: Proof) -> None:
    r"""Any relaxation function: growth of the contact.

    With $\frac{1}{2} \le a' < 1$ each depth belongs to one length of the contact, and with $W' > 0$ each
    load.
    """
    name_integrals(proof, 3, c)
    proof.recall("F17-concave", a)
    whole, first, second = G(c), G_1(c), G_2(c)
    slope = 1 - second * whole / first**2
    proof.equal(sp.Derivative(a, c), slope, "by the quotient rule: less than 1")
    gap, fall = first**2 - 2 * second * whole, sp.Derivative(whole, c)
    proof.equal(slope - sp.Rational(1, 2), gap / (2 * first**2), "more than one half, if")
    proof.equal(sp.Derivative(gap, c), -2 * second * fall,
                r"this, which is 0 for $\breve c = 0$, rises: $G$ falls")  # fmt: skip
    proof.recall("F17-forces", LOADED)
    proof.define(W, LOADED, "the load")
    rise = second * slope / R
    proof.equal(sp.Derivative(W, c), rise, r"$a' \breve G_2/R$: no pressure at the trailing edge")


@result("F17-parts", uses=("F17-forces",))
def _moments(proof: Proof) -> None:
    """Any relaxation function: the moments by parts.

    The moments of F17-moments, applied to the whole relaxation function: load and friction force are as in
    F17-load and F17, whether or not $G$ is a sum of arms. (F17-sign shows that the moments are positive.)
    """
    name_integrals(proof, 4)
    for name in WEIGHTS:
        whole = weighted(name).function
        weight = whole / G(y)
        parts = sum((-1) ** n * sp.diff(weight, y, n) * part(y) for n, part in enumerate(repeated))
        proof.integral(name, whole, (y, 0, c), "by parts", value=sp.expand(parts.subs(y, c)),
                       antiderivative=parts)  # fmt: skip
    proof.recall("F17-concave", a)
    proof.define(e, a / c - sp.Rational(1, 2), "the excess over half of the contact")
    proof.equal(a, c * (e + sp.Rational(1, 2)), "solved for the half length")
    proof.equal(e, B / A, "no pressure at the trailing edge")
    edge = {a: G_2(c) / G_1(c)}
    for total, integral, form in (
        (F_z, LOADED, c**3 / R * (D + e * P)), (F_x, WORKED, c**4 / R**2 * (E + e**2 * P)),
    ):  # fmt: skip
        proof.recall("F17-forces", integral, at=edge)
        proof.define(total, integral.subs(edge), "over the contact")
        proof.equal(total, form, "in terms of the moments")


@result("F17-falls")
def _falls(proof: Proof) -> None:
    r"""Any relaxation function: the moments by its fall.

    Each moment of F17-parts is a multiple of $\breve G$ at the trailing edge and an integral of its fall
    $\breve H$, both with factors that are not negative. A springpot, infinite at $\breve y = 0$, gives no
    boundary term there, because $\breve y\, G$ vanishes.
    """
    proof.define(sp.Derivative(G(y), y), -fading(y), "the relaxation function does not rise")
    for name in WEIGHTS:
        proof.define(name, weighted(name), "a moment")
        fallen, rest = in_parts(name)
        proof.equal(name, fallen + rest, "by parts")
        proof.integral(rest, rest.function, (y, 0, c), "the end",
                       value=FALLS[name].subs(w, 1) * G(c),
                       antiderivative=FALLS[name].subs(w, y / c) * G(y))  # fmt: skip
        proof.holds(fallen, ">=", 0, "not negative in the contact")
    proof.done(name, fallen + rest)


def by_fall(proof: Proof, *names: sp.Symbol) -> None:
    """Recall moments as integrals of the fall."""
    for name in names:
        fallen, rest = in_parts(name)
        proof.recall("F17-falls", (name, fallen + rest), rest)


@result("F17-sign")
def _positive(proof: Proof) -> None:
    r"""Any relaxation function: friction is positive.

    Where $G$ does not rise, $F_x$ is not negative, and is zero only where $G$ is
    constant and $\breve \eta = 0$: convexity of $G$ is not needed.
    """
    proof.recall("F17-parts", F_x)
    by_fall(proof, E, P)
    form = c**4 / R**2 * (in_parts(E)[0] + e**2 * (in_parts(P)[0] + G(c) / 2))
    proof.equal(F_x, form, "by the fall")
    proof.holds(form, ">=", 0, "no term is negative")
    proof.done(F_x, form)


@result("F17-stored")
def _stored(proof: Proof) -> None:
    r"""Any relaxation function: energy behind the contact.

    Half of the square of the stress of an arm at the trailing edge is the energy stored in its spring,
    $\frac{1}{2} \int \int e^{-\breve z (\breve w + \breve w')} u' u'$.

    Argued: Added up over arms it is $\frac{1}{2} \int \int G(\breve w + \breve w')\, u'(\breve w)\,
    u'(\breve w')$ for every $G$ that is a sum or an integral of arms (Bernstein: that is completely
    monotone), the springpot among them. It is lost while the surface relaxes behind the contact; the rest
    of $F$ is lost inside it. For other relaxation functions $G$ alone does not determine the stored
    energy.
    """
    under_pressure(proof)
    proof.recall("F17-edge")
    held = sp.Integral(sp.exp(-z * w) * (b - 1 + w), UNIT)
    proof.integral(held, held.function, UNIT, "stress of an arm at the trailing edge",
                   value=edge_pressure)  # fmt: skip
    proof.recall("F17", arm_work, "F17-energy")
    proof.equal(arm_work - arm_lost, held**2 / 2, "what the arm does not lose in the contact")


@result("F17-stored-springpot", uses=("F17-stored",))
def _stored_springpot(proof: Proof) -> None:
    r"""Fractional Kelvin–Voigt: energy behind the contact.

    With $u' \sim \breve h + \breve w$, $\breve h = a/\breve c - 1$, and $G \sim \breve w^{\breve \nu - 1}$:
    twice the energy of the springpot at the trailing edge, in the units of F17-springpot.
    """
    nu, h, v = spring_share, shift, other_trailing
    both = w + v
    parts = (h + v) * both**nu / nu - both ** (nu + 1) / (nu * (nu + 1))
    once = parts.subs(v, 1) - parts.subs(v, 0)
    proof.integral(felt, both ** (nu - 1) * (h + v), (v, 0, 1), "by parts", value=once,
                   antiderivative=parts)  # fmt: skip
    outer = sp.Integral((h + w) * felt, UNIT)

    def part(base: sp.Expr, power: sp.Expr) -> sp.Expr:
        """Integrate (h + w) base**power over w."""
        whole = base ** (power + 1) / (power + 1)
        return (h + w) * whole - base ** (power + 2) / ((power + 1) * (power + 2))

    near = part(1 + w, nu + 1) - part(w, nu + 1)
    primitive = ((h + 1) * part(1 + w, nu) - h * part(w, nu) - near / (nu + 1)) / nu
    two = 2**nu
    none, mixed, square = (2 * (two - 1) / (nu * (nu + 1)), (2 * two - 1) / ((1 + nu) * (2 + nu)),
                           2 * (1 - (1 - nu) * two) / (nu * (1 + nu) * (3 + nu)))  # fmt: skip
    value = square + 2 * h * mixed + h**2 * none
    proof.integral(outer, (h + w) * felt, UNIT, "and once more", value=value,
                   antiderivative=primitive)  # fmt: skip


@result("F17-surface")
def _surface(proof: Proof) -> None:
    r"""Standard linear solid: the surface behind the contact.

    A spring $K$ in parallel with one arm of $K_1 = \breve \beta K$ leaves the contact with the compression
    $\breve u$. At the distance $\breve y$ behind the edge it is $\breve u e^{-\breve y/((1 + \breve \beta)
    l_i)}$: the free surface relaxes with the time $(1 + \breve \beta) \tau_i$, which is $\tau = C/K$ for
    $\breve \beta \gg 1$. It leaves the edge at an angle $\breve \sigma > 0$, which is zero for Kelvin–Voigt,
    and does not touch again.
    """
    u, stretch, beta = left_behind, (1 + arm_ratio) * l, arm_ratio
    rate = slope_free
    proof.root(K * beta * rate + K * rate + K * u / l, rate, -u / stretch,
               r"the slope of the free surface, where the arm carries $-K \breve u$: "
               r"$-K \breve \chi_0 = K_1 \breve \chi_0 + K \breve u/l_i$")  # fmt: skip
    from_moments(proof)
    proof.recall("F17-edge")
    spring = proof.asymptote("F17-limits", edge_pressure, springs[0], "of the spring")
    proof.define(e, beta * B / (1 + beta * A), "the excess over half of the contact, as there is")
    proof.equal(springs[0] + beta * edge_pressure, sp.S.Zero, "no pressure at the trailing edge")
    proof.define(l, c / z, "length of the arm")
    proof.define(x_te, c / 2 - c * e, "by definition of the excess")
    proof.define(u, c**2 * spring / R, "what the spring carries there")
    angle = (1 + beta * (2 * (1 + z) * Q + FALL) + 2 * beta**2 * Q) / (
        2 * (1 + beta) * (1 + beta * A)
    )
    proof.define(parting, c / R * angle, "positive")
    proof.equal(
        x_te / R, u / stretch + parting, "slope of the indenter at the edge, larger by this"
    )
    part = sp.Symbol("zeta", positive=True)
    over = (part, 0, y / stretch)
    above = sp.Integral(1 - sp.exp(-part), over)
    proof.integral(above, 1 - sp.exp(-part), over, "an exponential above its tangent",
                   value=sp.exp(-y / stretch) - 1 + y / stretch)  # fmt: skip
    indenter = u - x_te * y / R - y**2 / (2 * R)
    gap = u * sp.exp(-y / stretch) - indenter
    form = y**2 / (2 * R) + parting * y + u * above
    proof.equal(gap, form, "the gap between indenter and free surface")
    proof.holds(form, ">=", y**2 / (2 * R), "never again in contact")
    proof.done(gap, form)


@result("F17-interval")
def _interval(proof: Proof) -> None:
    r"""Prony series: the contact is one interval.

    The dashpot of an arm follows $\tau_i\, \mathrm{d}\breve u_1/\mathrm{d}t = \breve u - \breve u_1$; the
    surface is the larger of $\breve g$ and of the free surface $\breve \gamma_1 \breve u_1 + \breve
    \gamma_2 \breve u_2$. Shown with two arms; nothing depends on their number.

    Argued: The larger of two is the upper bound of all mixtures with weights $\breve \theta$ and $1 -
    \breve \theta$, so that by the comparison theorem of cooperative systems (Kamke) each extension is the
    upper bound, over all histories $\breve \theta(t)$, of the solution of a linear system: an integral of
    the past of $\breve g$ with weights that are not negative and add up to $1 - \breve \omega_1$, at most
    1. Along the foundation $\breve g$ is one parabola, displaced from instant to instant, so that the
    height of the indenter over the free surface is a lower bound of concave functions, and concave. An
    element is in contact where it is not negative, which is one interval, for any drive and any motion:
    two edges describe the contact on every Prony series, as F9 says for Kelvin–Voigt.
    """
    u, stiff = left_behind, K + spring_1 + spring_2
    pressure = K * u + spring_1 * (u - damper_1) + spring_2 * (u - damper_2)
    proof.define(share_1, spring_1 / stiff, "share of an arm in the glassy stiffness")
    proof.define(share_2, spring_2 / stiff, "share of the other arm")
    free = share_1 * damper_1 + share_2 * damper_2
    proof.equal(pressure, stiff * (u - free), r"the pressure: a free surface is at this mean")
    proof.where(on_off < 1, "free for 0; for 1, in contact, what follows is 0")
    drive = on_off * pressed + (1 - on_off) * free
    proof.equal(sp.Derivative(drive, damper_2), (1 - on_off) * share_2,
                "no dashpot reduces the extension of another: the system is cooperative")  # fmt: skip
    proof.holds((1 - on_off) * share_2, ">=", 0, "so that larger drives give larger extensions")
    ones = on_off + (1 - on_off) * (share_1 + share_2) - 1
    proof.equal(ones, -(1 - on_off) * K / stiff, "with all extensions and the indenter at 1")
    proof.holds(-(1 - on_off) * K / stiff, "<", 0, "they fall: weights of the past add up to less")
    weights = share_1 * (1 - spare_1) + share_2 * (1 - spare_2)
    bend = -K / stiff - share_1 * spare_1 - share_2 * spare_2
    proof.equal(-1 + weights, bend, "second derivative, over that of the indenter")
    proof.holds(bend, "<", 0, "concave")
    proof.done(-1 + weights, bend)
