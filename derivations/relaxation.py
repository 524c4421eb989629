r"""Steady sliding on a foundation with any relaxation function: theorem F17 without arms, and corollaries.

G(t) is positive, does not rise, and has an integral from t = 0; nothing else is assumed. Where the
chapter before this one adds up arms, this one integrates by parts. Beside it: the surface that the standard
linear solid leaves behind, and the one interval of contact on every Prony series.
"""

from functools import partial

import sympy as sp

from .algebra import antiderivative
from .record import Derivation
from .step import Proof, tex
from .symbols import (
    K,
    R,
    a,
    arm_length,
    arm_ratio,
    behind,
    contact_length,
    damper_1,
    damper_2,
    edge_distance,
    excess_share,
    fading,
    felt,
    from_trailing,
    left_behind,
    memory,
    moment_ahead,
    moment_bulge,
    moment_twist,
    on_off,
    other_trailing,
    parting,
    pressed,
    repeated,
    share_1,
    share_2,
    shift,
    slope_free,
    spare_1,
    spare_2,
    spring_1,
    spring_2,
    spring_share,
    x_te,
)  # fmt: skip
from .viscoelastic import MOMENTS, SECTION, UNIT, B, D, E, P, Q

y, X, c, w, l = edge_distance, behind, contact_length, from_trailing, arm_length
G, (G_1, G_2, G_3, G_4) = memory, repeated
PRESSURE = sp.Lambda(y, (a * G_1(y) - G_2(y)) / R)
LOAD = (a * G_2(c) - G_3(c)) / R
WORK = ((a - c) * (a * G_2(c) - G_3(c)) + a * G_3(c) - G_4(c)) / R**2

_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove F17 for any relaxation function, and the relaxation of the surface behind the contact."""
    return (
        *(_pressure(), _concave(), _forces(), _moments(), _positive()),
        *(_stored(), _stored_springpot(), _surface(), _interval()),
    )


def name_integrals(proof: Proof, count: int, place: sp.Symbol = y) -> None:
    """Name repeated integrals of the relaxation function over the distance back."""
    for integral, part in zip(repeated[:count], (G, *repeated)[:count], strict=True):
        proof.define(sp.Derivative(integral(place), place), part(place), "a repeated integral")
        proof.define(integral(0), sp.S.Zero, "from the leading edge on")


def _pressure() -> Derivation:
    proof = _theorem("F17-any", title="Any relaxation function: the pressure", text=_PRESSURE)
    name_integrals(proof, 2)
    rate = (a - X + y) / R
    value = PRESSURE(X)
    whole = sp.Integral(G(y) * rate, (y, 0, X))
    proof.integral(whole, G(y) * rate, (y, 0, X), rate * G_1(y) - G_2(y) / R,
                   r"by parts; this is the pressure $p(\breve X)$", value=value)  # fmt: skip
    return proof.done(whole, value)


_PRESSURE = (
    r"An element at the distance $\breve X$ behind the leading edge was compressed at the rate $(a "
    r"- \breve X + \breve y)/R$ when it was $\breve y$ ahead of its present position; $\breve "
    r"G(\breve y) = G(\breve "
    r"y/V)$, and $\breve G_1$ to $\breve G_4$ are its repeated integrals. $G$ need not be a sum of arms."
)


def _concave() -> Derivation:
    proof = _theorem("F17-concave", title="Any relaxation function: one trailing edge",
                     text=_CONCAVE, uses=("F17-any",))  # fmt: skip
    name_integrals(proof, 2)
    first = (a * G(y) - G_1(y)) / R
    proof.equal(sp.Derivative(PRESSURE(y), y), first, "slope of the pressure")
    proof.define(sp.Derivative(G(y), y), -fading(y), "G does not increase")
    second = -(a * fading(y) + G(y)) / R
    proof.equal(sp.Derivative(first, y), second, "and its slope")
    proof.holds(second, "<", 0, "the pressure is concave")
    return proof.done(sp.Derivative(first, y), second)


_CONCAVE = (
    "The pressure begins with 0, or with a jump where $G$ holds a dashpot, rises at first and is "
    r"concave: it vanishes at one point behind, the trailing edge, where $a \breve G_1 = \breve G_2$. "
    r"(Where $G$ falls by steps, concavity is that of $\int (a - \breve X + \breve y)\, dG$, which "
    r"was not checked by machine.)"
)


def _forces() -> Derivation:
    proof = _theorem("F17-forces", title="Any relaxation function: load and friction force",
                     text=_FORCES, uses=("F17-any",))  # fmt: skip
    name_integrals(proof, 4)
    over = (y, 0, c)
    load = sp.Integral(PRESSURE(y), over)
    primitive = (a * G_2(y) - G_3(y)) / R
    proof.integral(load, PRESSURE(y), over, primitive, "this is the load $W$", value=LOAD)
    rate = (a - y) / R
    work = sp.Integral(rate * PRESSURE(y), over)
    whole = rate * primitive + (a * G_3(y) - G_4(y)) / R**2
    proof.integral(work, rate * PRESSURE(y), over, whole, "the work of the pressure, which is $F$",
                   value=WORK)  # fmt: skip
    return proof.done(work, WORK)


_FORCES = (
    r"With $a = \breve G_2/\breve G_1$ at $\breve c$ everything is explicit in the length $\breve c$ of "
    r"the contact. As $p = \int G u'$, the friction force is the quadratic form $\int p\, u' = \int \int "
    r"G(\breve X - \breve y)\, u'(\breve y)\, u'(\breve X)$ over $\breve y < \breve X$."
)


def _moments() -> Derivation:
    proof = _theorem("F17-parts", title="Any relaxation function: the moments by parts", text=_PARTS,
                     uses=("F17-forces", "F17-load", "F17"))  # fmt: skip
    name_integrals(proof, 4)
    parts = (G_1(y), G_2(y), G_3(y), G_4(y))
    for name in (moment_ahead, moment_bulge, moment_twist):
        weight = sp.expand(MOMENTS[name][0].subs(w, y / c)) / c
        primitive = sum((-1) ** n * sp.diff(weight, y, n) * part for n, part in enumerate(parts))
        ends = [sp.diff(weight, y, n).subs(y, c) * part.subs(y, c) for n, part in enumerate(parts)]
        value = sum((-1) ** n * end for n, end in enumerate(ends))
        proof.integral(
            name, weight * G(y), (y, 0, c), primitive, "by parts", value=sp.expand(value)
        )
    proof.define(a, G_2(c) / G_1(c), "F17-concave: no pressure at the trailing edge")
    proof.define(excess_share, a / c - sp.Rational(1, 2), "the excess over half of the contact")
    e, load, work = excess_share, LOAD, WORK
    proof.equal(load, c**3 / R * (moment_bulge + e * moment_ahead), "the load of F17-load")
    form = c**4 / R**2 * (moment_twist + e**2 * moment_ahead)
    proof.equal(work, form, "the friction force of F17")
    return proof.done(work, form)


_PARTS = (
    "The moments of F17-moments, applied to the whole relaxation function: load and friction force are "
    "those of F17-load and F17, whether or not $G$ is a sum of arms. (F17-sign shows that the moments "
    "are positive.)"
)


def _positive() -> Derivation:
    proof = _theorem("F17-sign", title="Any relaxation function: friction is positive", text=_SIGN,
                     uses=("F17-parts",))  # fmt: skip
    proof.define(sp.Derivative(G(w), w), -fading(w), "the relaxation function does not rise")
    for name in (P, Q, D, B, E):
        weight = (1 - 2 * w) / 2 if name == B else MOMENTS[name][0]
        gained = sp.factor(antiderivative(weight, w))
        inside, end = weight * G(w) - gained * fading(w), gained.subs(w, 1) * G(1)
        proof.integral(sp.Integral(inside, UNIT), inside, UNIT, gained * G(w), rf"${tex(name)}$ by parts",
                       value=end)  # fmt: skip
        proof.holds(sp.Integral(gained * fading(w), UNIT), ">=", 0, "not negative in the contact")
    return proof.done(sp.Integral(inside, UNIT), end)


_SIGN = (
    r"Each moment is a multiple of $\breve G$ at the trailing edge and an integral of its fall $\breve "
    r"H$, both with factors that are not negative. Where $G$ does not rise, $F = (\breve c^4/R^2)(\breve "
    r"E + \breve \eta^2 \breve P)$ with $\breve \eta = \breve B/\breve A$ is therefore positive unless "
    r"$G$ is constant: convexity of $G$ is not needed. A springpot, infinite at $\breve w = 0$, gives no "
    r"boundary term there, because $\breve w\, G$ vanishes."
)


def _stored() -> Derivation:
    proof = _theorem("F17-stored", title="Any relaxation function: energy behind the contact",
                     text=_STORED, uses=("F17-energy",))  # fmt: skip
    from .viscoelastic import PRESSURE as ARM
    from .viscoelastic import b, z
    from .viscoelastic import y as at

    held = sp.Integral(sp.exp(-z * w) * (b - 1 + w), UNIT)
    primitive = -sp.exp(-z * w) * ((b - 1 + w) / z + 1 / z**2)
    proof.integral(held, sp.exp(-z * w) * (b - 1 + w), UNIT, primitive,
                   "stress of an arm at the trailing edge", value=ARM.subs(at, 1))  # fmt: skip
    return proof.done(held, ARM.subs(at, 1))


_STORED_SPRINGPOT = (
    r"With $u' \sim \breve h + \breve w$, $\breve h = a/\breve c - 1$, and $G \sim \breve w^{\breve \nu - "
    "1}$: twice the energy of the springpot at the trailing edge, in the units of F17-springpot."
)
_STORED = (
    r"Half of the square of this is the energy stored in the spring of an arm (F17-energy), "
    r"$\frac{1}{2} \int \int "
    r"e^{-\breve z (\breve w + \breve w')} u' u'$. Added up over arms it is $\frac{1}{2} \int \int "
    r"G(\breve w + \breve w')\, u'(\breve w)\, u'(\breve w')$ for every $G$ that is a sum or an integral "
    "of arms (Bernstein: that is completely monotone), the springpot among them. It is lost while the "
    "surface relaxes behind the contact; the rest of $F$ is lost inside it. For other relaxation "
    "functions $G$ alone does not determine the stored energy."
)


def _stored_springpot() -> Derivation:
    proof = _theorem("F17-stored-springpot", title="Fractional Kelvin-Voigt: energy behind the contact",
                     text=_STORED_SPRINGPOT, uses=("F17-stored",))  # fmt: skip
    nu, h, v = spring_share, shift, other_trailing
    both = w + v
    parts = (h + v) * both**nu / nu - both ** (nu + 1) / (nu * (nu + 1))
    once = parts.subs(v, 1) - parts.subs(v, 0)
    proof.integral(felt, both ** (nu - 1) * (h + v), (v, 0, 1), parts, "by parts", value=once)
    outer = sp.Integral((h + w) * felt, UNIT)

    def part(base: sp.Expr, power: sp.Expr) -> sp.Expr:
        """Integrate (h + w) base**power over w."""
        whole = base ** (power + 1) / (power + 1)
        return (h + w) * whole - base ** (power + 2) / ((power + 1) * (power + 2))

    near = part(1 + w, nu + 1) - part(w, nu + 1)
    primitive = ((h + 1) * part(1 + w, nu) - h * part(w, nu) - near / (nu + 1)) / nu
    two = 2**nu
    none, mixed, square = (
        2 * (two - 1) / (nu * (nu + 1)),
        (2 * two - 1) / ((1 + nu) * (2 + nu)),
        2 * (1 - (1 - nu) * two) / (nu * (1 + nu) * (3 + nu)),
    )
    value = square + 2 * h * mixed + h**2 * none
    proof.integral(outer, (h + w) * felt, UNIT, primitive, "and once more", value=value)
    return proof.done(outer, value)


def _surface() -> Derivation:
    proof = _theorem("F17-surface", title="Standard linear solid: the surface behind the contact",
                     text=_SURFACE, uses=("F17-concave",))  # fmt: skip
    rate = slope_free
    u, stretch = left_behind, (1 + arm_ratio) * l
    free = K * arm_ratio * rate + K * rate + K * u / l
    proof.root(free, rate, -u / stretch,
               r"the slope of the free surface, where the arm carries $-K \breve u$: "
               r"$-K \breve \chi_0 = K_1 \breve \chi_0 + K \breve u/l_i$")  # fmt: skip
    proof.define(
        x_te / R, u / stretch + parting, "the slope of the indenter at the edge, larger by this"
    )
    leaving = -K * (1 + arm_ratio) * x_te / R + K * u / l
    proof.equal(leaving, -K * (1 + arm_ratio) * parting,
                "slope of the pressure at the end of the contact, negative by F17-concave")  # fmt: skip
    part = sp.Symbol("zeta", positive=True)
    over = (part, 0, y / stretch)
    above = sp.Integral(1 - sp.exp(-part), over)
    proof.integral(above, 1 - sp.exp(-part), over, part + sp.exp(-part),
                   "an exponential above its tangent",
                   value=sp.exp(-y / stretch) - 1 + y / stretch)  # fmt: skip
    indenter = u - x_te * y / R - y**2 / (2 * R)
    gap = u * sp.exp(-y / stretch) - indenter
    form = y**2 / (2 * R) + parting * y + u * above
    proof.equal(gap, form, "the gap between indenter and free surface")
    proof.holds(form, ">=", y**2 / (2 * R), "never again in contact")
    return proof.done(gap, form)


_SURFACE = (
    r"A spring $K$ in parallel with one arm of $K_1 = \breve \beta K$ leaves the contact with the "
    r"compression $\breve u$. At the distance $\breve y$ behind the edge it is $\breve u e^{-\breve "
    r"y/((1 + \breve "
    r"\beta) l_i)}$: the free surface relaxes with the time $(1 + \breve \beta) \tau_i$, which is $\tau = "
    r"C/K$ for $\breve \beta \gg 1$. It leaves the edge at an angle $\breve \sigma > 0$, which is "
    r"zero for Kelvin-Voigt, and does not touch again."
)


def _interval() -> Derivation:
    proof = _theorem(
        "F17-interval", title="Prony series: the contact is one interval", text=_INTERVAL
    )
    u, stiff = left_behind, K + spring_1 + spring_2
    pressure = K * u + spring_1 * (u - damper_1) + spring_2 * (u - damper_2)
    proof.define(share_1, spring_1 / stiff, "share of an arm in the glassy stiffness")
    proof.define(share_2, spring_2 / stiff, "likewise")
    free = share_1 * damper_1 + share_2 * damper_2
    proof.equal(pressure, stiff * (u - free), r"the pressure: a free surface is at this mean")
    proof.where(on_off < 1, "free for 0; for 1, in contact, what follows is 0")
    drive = on_off * pressed + (1 - on_off) * free
    proof.equal(sp.Derivative(drive, damper_2), (1 - on_off) * share_2,
                "no dashpot reduces the extension of another: the system is cooperative")  # fmt: skip
    proof.holds((1 - on_off) * share_2, ">=", 0, "so that larger drives give larger extensions")
    ones = on_off + (1 - on_off) * (share_1 + share_2) - 1
    proof.equal(ones, -(1 - on_off) * K / stiff, "with all extensions and the indenter at 1")
    proof.holds(
        -(1 - on_off) * K / stiff, "<", 0, "they fall: the weights of the past add up to less"
    )
    weights = share_1 * (1 - spare_1) + share_2 * (1 - spare_2)
    bend = -K / stiff - share_1 * spare_1 - share_2 * spare_2
    proof.equal(
        -1 + weights, bend, "second derivative along the foundation, over that of the indenter"
    )
    proof.holds(bend, "<", 0, "concave")
    return proof.done(-1 + weights, bend)


_INTERVAL = (
    r"The dashpot of an arm follows $\tau_i\, \mathrm{d}\breve u_1/\mathrm{d}t = \breve u - \breve u_1$; "
    r"the surface is the larger of $\breve g$ and of the free surface $\breve \gamma_1 \breve u_1 + "
    r"\breve \gamma_2 \breve u_2$. Shown with two arms; nothing depends on their number. Not "
    r"checked by machine: the larger of two is the upper bound of all mixtures with weights $\breve "
    r"\theta$ and $1 - \breve \theta$, so that by the comparison theorem of cooperative systems (Kamke) "
    r"each extension is the upper bound, over all histories $\breve \theta(t)$, of the solution of a "
    r"linear system: an integral of the past of $\breve g$ with weights that are not negative and add up "
    r"to $1 - \breve \omega_1$, at most 1. Along the foundation $\breve g$ is one parabola, displaced "
    "from instant to instant, so that the height of the indenter over the free surface is a lower bound "
    "of concave functions, and concave. An element is in contact where it is not negative, which is one "
    "interval, for any drive and any motion: two edges describe the contact on every Prony series, "
    "as F9 says for Kelvin-Voigt."
)
