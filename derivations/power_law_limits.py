r"""A power law at a given depth over velocity: monotonicity, both limits, and their crossing (F19)."""

from functools import partial

import sympy as sp

from .power_law import (
    FRICTION_COEFFICIENT,
    FRICTION_FORCE,
    HIGH_COEFFICIENT,
    LOAD,
    LOW_SLOPE,
    NUMBER,
    SECTION,
    SLOPE_POWER,
    SQUARES,
    in_q,
    n,
    z,
)
from .record import Derivation
from .step import Proof
from .symbols import Q, excess, l, l_cross, m_high, m_low, q, w_rest

_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove how the forces of a power law depend on the velocity."""
    return _monotonic(), _low(), _high(), _crossing()


def _monotonic() -> Derivation:
    proof = _theorem("F19-monotonic", title="Power law: forces grow with velocity", text=_MONOTONIC,
                     uses=("F19-load", "F19-friction"))  # fmt: skip
    in_q(proof)
    state = {l: NUMBER, Q: SLOPE_POWER}
    load, friction = (form.subs(state) for form in (LOAD, FRICTION_FORCE))

    def rate(form: sp.Expr) -> sp.Expr:
        return sp.diff(form, q) / sp.diff(NUMBER, q)

    proof.notation |= {"w_n": load, r"\varphi_n": friction}
    proof.notation |= {"w_n'": rate(load), r"\varphi_n'": rate(friction)}
    load_rate, friction_rate = n * l * Q, n**2 * SQUARES
    proof.equal(rate(load), load_rate, "the load grows", left="w_n'")
    proof.equal(rate(friction), friction_rate, "and so does friction", left=r"\varphi_n'")
    rest = n * (1 + q + l * q * Q) / (n + 1)
    proof.equal(LOAD - l * load_rate, rest, "$w_n/l$ falls: positive",
                left="w_n - l w_n'")  # fmt: skip
    less = n**2 * l**2 * Q**2 / 2
    proof.equal(FRICTION_FORCE - l * friction_rate, less, r"$\varphi_n/l$ falls: positive",
                left=r"\varphi_n - l \varphi_n'")  # fmt: skip
    z, double = n * l * Q, n + excess
    growth = excess * (n**2 + excess * (n + 1)) + (n + 1) * double * q**n * (1 + z + z**2)
    growth += 2 * n**3 * q * (Q**2 + (1 + q * Q**2) * (1 + l * Q))
    gain = friction_rate * LOAD - FRICTION_FORCE * load_rate
    proof.equal(
        *(2 * (n + 1) * (2 * n - 1) * gain, growth, "the friction coefficient grows"),
        left=r"2 (n + 1) (2 n - 1) (w_n \varphi_n' - \varphi_n w_n')",
    )
    proof.holds(growth, ">", 0, r"with $\nu = n - 1$ each term is positive")
    return proof.done(LOAD - l * load_rate, rest)


_MONOTONIC = (
    r"At a given depth load, friction force and friction coefficient grow with the velocity, while "
    r"$w_n/l$, $\varphi_n/l$ and with them $m_n/l$ fall. A prime is the derivative with respect to $l$."
)


def _low() -> Derivation:
    proof = _theorem("F19-low", title="Power law: low velocity", text=_LOW,
                     uses=("F19-load", "F19-friction"))  # fmt: skip
    rest = {q: 1, Q: 1, l: 0}
    ratio = sp.cancel(FRICTION_COEFFICIENT / l)
    proof.define(w_rest, LOAD.subs(rest), "load at rest")
    proof.equal(w_rest, 2 * n / (n + 1), "in units of $K \\delta a$")
    proof.define(m_low, ratio.subs(rest), "friction coefficient per $l$")
    proof.equal(m_low, LOW_SLOPE, r"in units of $\delta/a$")
    return proof.done(m_low, LOW_SLOPE)


_LOW = (
    r"At rest $q = Q = 1$ and $l = 0$, where the forms are continuous: $W \to \frac{2 n}{n + 1} K "
    r"\delta a$ and $\mu \to \frac{\delta}{a}\, l\, \frac{n (n + 1)}{2 n - 1}$."
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
    proof.equal(share.subs(fast), sp.S.One, "the damper carries the total load")
    proof.define(m_high, damper.subs(fast) / share.subs(fast), "friction coefficient")
    proof.equal(m_high, HIGH_COEFFICIENT, r"in units of $\delta/a$")
    return proof.done(m_high, HIGH_COEFFICIENT)


_HIGH = (
    r"For $l \to \infty$ the edge goes to the tip, $q \to 0$ and $Q \to 0$ with $n l Q \to 1$: $W "
    r"\to C V \delta$ and $\mu \to \frac{\delta}{a} \frac{n^2}{2 n - 1}$."
)


def _crossing() -> Derivation:
    proof = _theorem("F19-crossing", title="Power law: crossing of the asymptotes",
                     text="At a given depth; for $n = 2$ this is Eq. (47).",
                     uses=("F19-low", "F19-high"))  # fmt: skip
    proof.root(LOW_SLOPE * l - HIGH_COEFFICIENT, l, n / (n + 1), "the asymptotes meet")
    proof.define(l_cross, n / (n + 1), r"$V^{*} \tau/a$")
    return proof.done(l_cross, n / (n + 1))
