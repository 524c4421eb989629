r"""Steady sliding of a power law h = |x|**n/(n L**(n - 1)), n > 1: theorem F19.

One number fixes the contact: q = x_TE/a, or l = l_r/a = (1 - q**n)/(n q**(n - 1)). With Q = q**(n - 1)
load, friction force and the rest are sums of positive terms in l, q and Q, which neither cancel nor
overflow. They hold for n = 1 as well, the wedge, where q = max(0, 1 - l); `derivations.wedge` proves it.
"""

from functools import partial

import sympy as sp

from derivations.record import Derivation
from derivations.step import Proof
from derivations.symbols import (
    C,
    F,
    K,
    L,
    P,
    P_n,
    Q,
    V,
    W,
    a,
    delta,
    eta_n,
    excess,
    exponent,
    l,
    l_cross,
    l_r,
    lost_ahead,
    lost_behind,
    m_n,
    mu,
    p,
    phi_ahead,
    phi_behind,
    phi_n,
    q,
    w_ahead,
    w_behind,
    w_n,
    y,
    z_peeled,
)  # fmt: skip

SECTION = "Power law and wedge"

n, z = exponent, z_peeled
NUMBER = (1 - q**n) / (n * q ** (n - 1))
"""l as a function of q."""
SLOPE_POWER = q ** (n - 1)
"""Q as a function of q."""
AHEAD, BEHIND = (1 - y**n + side * n * l * y ** (n - 1) for side in (1, -1))
"""p/(K delta) at x = -y a and at x = y a."""
SQUARES = (1 + q * Q**2) / (2 * n - 1)
"""The integral of (|x|/a)**(2 n - 2) over the contact: the damper's part of the friction force."""
LOAD = n * (1 + q + l + l**2 * Q) / (n + 1)
FRICTION_FORCE = n**2 * l * (SQUARES + l * Q**2 / 2)
FRICTION_COEFFICIENT = n * (n + 1) * l * (SQUARES + l * Q**2 / 2) / (1 + q + l + l**2 * Q)
LOW_SLOPE = n * (n + 1) / (2 * n - 1)
"""m/l at rest."""
HIGH_COEFFICIENT = n**2 / (2 * n - 1)
"""m for l -> oo."""

_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove F19 for every exponent n > 1."""
    return (
        *(_pressure(), _edge(), _load(), _friction(), _coefficient()),
        *(_monotonic(), _peak_pressure(), _energy(), _low(), _high(), _crossing()),
    )


def in_q(proof: Proof) -> None:
    """Let l and Q be functions of q and n = 1 + nu."""
    proof.define(n, 1 + excess, r"$n > 1$, that is, $\nu > 0$")
    proof.define(l, NUMBER, r"$q = x_{\mathrm{TE}}/a$ names the state")
    proof.define(Q, SLOPE_POWER, "the slope at the trailing edge over that at $x = a$")


def _pressure() -> Derivation:
    proof = _theorem("F19-pressure", title="Power law: pressure", text=_PRESSURE,
                     uses=("eq22", "eq29", "pressure"))  # fmt: skip
    height, slope = (y * a) ** n / (n * L ** (n - 1)), (y * a / L) ** (n - 1)
    proof.define(delta, a**n / (n * L ** (n - 1)), r"$h(a) = \delta$: the half length at rest")
    proof.define(C, K * l_r / V, "Eqs. (22) and (29)")
    proof.define(l_r, l * a, "the retardation length in half lengths")
    for side, form, where in ((1, AHEAD, "-y a"), (-1, BEHIND, "y a")):
        proof.equal(
            *((K * (delta - height) + side * C * V * slope) / (K * delta), form, f"at $x = {where}$"),
            left=rf"\frac{{K (\delta - h) - C V h'}}{{K \delta}}",
        )
    proof.define(P, BEHIND, "behind the tip, with $y = x/a$")
    proof.equal(
        sp.Derivative(BEHIND, y), -n * y ** (n - 2) * (y + (n - 1) * l), "falling behind the tip"
    )
    return proof.done(P, BEHIND)


_PRESSURE = (
    r"The indenter $h = |x|^n/(n L^{n-1})$ with $n > 1$ has the slope 1 at $x = L$; $n = 2$ is the "
    r"parabola of radius $L$. Here $l = l_{\mathrm{r}}/a$, and $y = |x|/a$ is the distance from the tip."
)


def _edge() -> Derivation:
    proof = _theorem("F19-edge", title="Power law: trailing edge", text=_EDGE, uses=("F19-pressure",))
    proof.define(n, 1 + excess, r"$n > 1$, that is, $\nu > 0$")
    proof.root(BEHIND.subs(y, q), l, NUMBER, "no pressure at the trailing edge, $y = q$")
    proof.equal(
        *(sp.diff(NUMBER, q), -(n - 1 + q**n) / (n * q**n), "slope"),
        left=r"\frac{d l}{d q}",
    )
    proof.positive((excess + q**n) / (n * q**n), r"$l$ falls strictly: each $l > 0$ has one $q$")
    proof.equal(NUMBER.subs(q, 1), sp.S.Zero, r"at rest, and $l \to \infty$ for $q \to 0$",
                left="l(1)")  # fmt: skip
    proof.define(l, NUMBER, "the same as a rule")
    proof.define(Q, SLOPE_POWER, "the slope at the trailing edge over that at $x = a$")
    proof.equal(n * l * Q, 1 - q**n, "which replaces the difference $1 - q^n$")
    proof.equal(1 / (q + n * l), Q, "one equation for $q$, without a difference")
    return proof.done(1 / (q + n * l), Q)


_EDGE = (
    r"The pressure falls from the tip to $x = a$, where it is not positive; it vanishes once between, at "
    r"$x_{\mathrm{TE}} = q a$. In the variable $\ln q$ the equation $(n - 1) \ln q + \ln(q + n l) = 0$ is "
    "increasing and convex, so that Newton's method descends to its root from every point above."
)


def _load() -> Derivation:
    proof = _theorem("F19-load", title="Power law: load", text=_SUMS, uses=("F19-edge",))
    in_q(proof)
    primitive = y - y ** (n + 1) / (n + 1)
    proof.integral(w_ahead, AHEAD, (y, 0, 1), primitive + l * y**n, "ahead of the tip")
    proof.integral(w_behind, BEHIND, (y, 0, q), primitive - l * y**n, "behind it")
    proof.define(w_n, w_ahead + w_behind, r"$W/(K \delta a)$")
    explicit = n / (n + 1) + q - q ** (n + 1) / (n + 1) + (1 - q**n) ** 2 / (n * q ** (n - 1))
    proof.equal(w_n, explicit, "as a function of $q$")
    proof.equal(w_n, LOAD, "a sum of positive terms")
    return proof.done(w_n, LOAD)


_SUMS = r"With $Q = q^{n-1}$ the forms in $l$, $q$ and $Q$ lose no digits in either limit."


def _friction() -> Derivation:
    proof = _theorem("F19-friction", title="Power law: friction force", text=_SUMS, uses=("F19-edge",))
    in_q(proof)
    primitive = y**n - y ** (2 * n) / 2
    damper = n**2 * l * y ** (2 * n - 1) / (2 * n - 1)
    for name, pressure, side, end in (
        (phi_ahead, AHEAD, 1, sp.S.One), (phi_behind, BEHIND, -1, q),
    ):  # fmt: skip
        integrand = sp.expand(n * y ** (n - 1) * pressure)
        where = "pushed back ahead of the tip" if side == 1 else "and forward behind it"
        proof.integral(name, integrand, (y, 0, end), primitive + side * damper, where)
    proof.define(phi_n, phi_ahead - phi_behind, r"$F/(K \delta^2)$")
    explicit = (1 - q**n) ** 2 / 2
    explicit += n * (1 - q**n) * (1 + q ** (2 * n - 1)) / ((2 * n - 1) * q ** (n - 1))
    proof.equal(phi_n, explicit, "as a function of $q$")
    proof.equal(phi_n, FRICTION_FORCE, "a sum of positive terms")
    return proof.done(phi_n, FRICTION_FORCE)


def _coefficient() -> Derivation:
    proof = _theorem("F19", title="Power law: friction coefficient", text=_COEFFICIENT)
    proof.recall("F19-load", w_n, LOAD)
    proof.recall("F19-friction", phi_n, FRICTION_FORCE)
    proof.define(F, K * delta**2 * phi_n, "friction force")
    proof.define(W, K * delta * a * w_n, "load")
    proof.define(mu, F / W, "Eq. (37)")
    proof.define(m_n, mu * a / delta, r"$\mu$ in units of $\delta/a$")
    proof.equal(m_n, phi_n / w_n, "the same")
    proof.equal(m_n, FRICTION_COEFFICIENT, "a quotient of positive terms")
    return proof.done(m_n, FRICTION_COEFFICIENT)


_COEFFICIENT = (
    r"For $h = |x|^n/(n L^{n-1})$, $n > 1$, with $q = x_{\mathrm{TE}}/a$, $Q = q^{n-1}$ and $l = "
    r"l_{\mathrm{r}}/a = (1 - q^n)/(n Q)$. For $n = 2$ this is F1."
)


def _monotonic() -> Derivation:
    proof = _theorem("F19-monotonic", title="Power law: more speed, more force", text=_MONOTONIC,
                     uses=("F19-load", "F19-friction"))  # fmt: skip
    in_q(proof)
    state = {l: NUMBER, Q: SLOPE_POWER}
    load, friction = (form.subs(state) for form in (LOAD, FRICTION_FORCE))

    def rate(form: sp.Expr) -> sp.Expr:
        return sp.diff(form, q) / sp.diff(NUMBER, q)

    load_rate, friction_rate = n * l * Q, n**2 * SQUARES
    proof.equal(rate(load), load_rate, "the load grows", left=r"\frac{d w_n}{d l}")
    proof.equal(rate(friction), friction_rate, "and so does friction", left=r"\frac{d \varphi_n}{d l}")
    rest = n * (1 + q + l * q * Q) / (n + 1)
    proof.equal(LOAD - l * load_rate, rest, "$w_n/l$ falls: positive",
                left=r"w_n - l \frac{d w_n}{d l}")  # fmt: skip
    less = n**2 * l**2 * Q**2 / 2
    proof.equal(FRICTION_FORCE - l * friction_rate, less, r"$\varphi_n/l$ falls: positive",
                left=r"\varphi_n - l \frac{d \varphi_n}{d l}")  # fmt: skip
    z, double = n * l * Q, n + excess
    growth = excess * (n**2 + excess * (n + 1)) + (n + 1) * double * q**n * (1 + z + z**2)
    growth += 2 * n**3 * q * (Q**2 + (1 + q * Q**2) * (1 + l * Q))
    below = 2 * n**2 * (n + 1) * (2 * n - 1)
    proof.equal(
        *((friction_rate * LOAD - FRICTION_FORCE * load_rate) / n**2, growth / below,
          "the friction coefficient grows"),
        left=r"\frac{w_n^2}{n^2} \frac{d m_n}{d l}",
    )
    proof.positive(growth, r"with $\nu = n - 1$, each term")
    return proof.done(LOAD - l * load_rate, rest)


_MONOTONIC = (
    r"At a given depth load, friction force and friction coefficient grow with the velocity, while "
    r"$w_n/l$, $\varphi_n/l$ and with them $m_n/l$ fall."
)


def _peak_pressure() -> Derivation:
    proof = _theorem("F19-peak", title="Power law: peak pressure", text=_PEAK, uses=("F19-pressure",))
    slope = n * y ** (n - 2) * ((n - 1) * l - y)
    proof.equal(sp.Derivative(AHEAD, y), slope, r"zero at $y = (n - 1) l$", left=r"\frac{d \hat p}{d y}")
    inside = 1 + l * ((n - 1) * l) ** (n - 1)
    form = 1 + y ** (n - 1) * (n * l - y)
    proof.equal(AHEAD, form, "the pressure ahead of the tip")
    proof.equal(form.subs(y, (n - 1) * l), inside, "inside the contact", left=r"\hat p")
    proof.equal(form.subs(y, 1), n * l, "at the leading edge", left=r"\hat p")
    proof.define(y, sp.Min(1, (n - 1) * l), "where the peak is")
    proof.define(P_n, form, "both cases in one form")
    return proof.done(P_n, form)


_PEAK = (
    r"The peak is inside the contact, at $x = -(n - 1) l_{\mathrm{r}}$, while that is behind the leading "
    "edge, and at the leading edge from there on."
)


def _energy() -> Derivation:
    proof = _theorem("F19-energy", title="Power law: energy dissipated inside the contact",
                     text=_ENERGY, uses=("energy-any-shape",))  # fmt: skip
    inside = lost_ahead, lost_behind
    proof.define(n, 1 + excess, r"$n > 1$")
    proof.define(Q, SLOPE_POWER)
    density, primitive = n**2 * l * y ** (2 * n - 2), n**2 * l * y ** (2 * n - 1) / (2 * n - 1)
    for name, end, where in zip(inside, (1, q), ("ahead of the tip", "behind it"), strict=True):
        proof.integral(name, density, (y, 0, end), primitive, where, left=r"\frac{1}{K \delta^2} "
                       r"\int K l_{\mathrm{r}} h'^2 \, dx")  # fmt: skip
    form = 2 * (1 + q * Q**2) / (2 * (1 + q * Q**2) + (2 * n - 1) * l * Q**2)
    proof.define(eta_n, (lost_ahead + lost_behind) / phi_n, "by definition")
    proof.recall("F19-friction", phi_n, FRICTION_FORCE)
    proof.equal(eta_n, form, "fraction inside")
    return proof.done(eta_n, form)


_ENERGY = (
    r"Of the power $F V$ the fraction $\eta$ is dissipated inside the contact, the rest in the surface "
    "that relaxes behind it. It is 1 in both limits."
)


def _low() -> Derivation:
    proof = _theorem("F19-low", title="Power law: low velocity", text=_LOW,
                     uses=("F19-load", "F19-friction"))  # fmt: skip
    rest = {q: 1, Q: 1, l: 0}
    ratio = sp.cancel(FRICTION_COEFFICIENT / l)
    proof.equal(LOAD.subs(rest), 2 * n / (n + 1), "load at rest", left="w_n(0)")
    proof.equal((FRICTION_FORCE / l).subs(rest), 2 * n**2 / (2 * n - 1), "friction force per $l$",
                left=r"\frac{\varphi_n}{l}(0)")  # fmt: skip
    proof.equal(ratio.subs(rest), LOW_SLOPE, "friction coefficient per $l$", left=r"\frac{m_n}{l}(0)")
    return proof.done(ratio.subs(rest), LOW_SLOPE)


_LOW = (
    r"At rest $q = Q = 1$ and $l = 0$, where the forms are continuous: $W \to \frac{2 n}{n + 1} K \delta "
    r"a$ and $\mu \to \frac{\delta}{a}\, l\, \frac{n (n + 1)}{2 n - 1}$."
)


def _high() -> Derivation:
    proof = _theorem("F19-high", title="Power law: high velocity", text=_HIGH,
                     uses=("F19-load", "F19-friction"))  # fmt: skip
    proof.define(l, z / (n * Q), "$n l Q = 1 - q^n = z$")
    fast = {q: 0, Q: 0, z: 1}
    share = n * ((1 + q) * n * Q / z + 1 + z / n) / (n + 1)
    damper = n**2 * (SQUARES + z * Q / (2 * n))
    proof.equal(LOAD / l, share, "load per $l$")
    proof.equal(FRICTION_FORCE / l, damper, "friction force per $l$")
    proof.equal(share.subs(fast), sp.S.One, "the damper carries all", left=r"\frac{w_n}{l}(\infty)")
    limit = damper.subs(fast) / share.subs(fast)
    proof.equal(limit, HIGH_COEFFICIENT, "friction coefficient", left=r"m_n(\infty)")
    return proof.done(limit, HIGH_COEFFICIENT)


_HIGH = (
    r"For $l \to \infty$ the edge goes to the tip, $q \to 0$ and $Q \to 0$ with $n l Q \to 1$: $W \to "
    r"C V \delta$ and $\mu \to \frac{\delta}{a} \frac{n^2}{2 n - 1}$."
)


def _crossing() -> Derivation:
    proof = _theorem("F19-crossing", title="Power law: crossing of the asymptotes",
                     text="At a given depth; for $n = 2$ this is Eq. (47).",
                     uses=("F19-low", "F19-high"))  # fmt: skip
    proof.root(LOW_SLOPE * l - HIGH_COEFFICIENT, l, n / (n + 1), "the asymptotes meet")
    proof.define(l_cross, n / (n + 1), r"$V^{*} \tau/a$")
    return proof.done(l_cross, n / (n + 1))
