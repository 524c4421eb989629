r"""A dead weight on an indenter of a user's shape, h = c |x|**n: groups, asymptotes, crossing and maximum.

With q = x_TE/a as the parameter the load W determines a, so that everything is a function of q alone. The
unit of lengths along x is (W/(K c))**(1/(n + 1)).
"""

import math
from collections.abc import Callable, Iterator

import sympy as sp

from .chapters.asymptotics import V_star, mu_high, mu_low
from .chapters.model import K, V, tau
from .chapters.power_law import phi_n, w_n
from .chapters.steady import F, Lambda, W, a, l_r, mu
from .engine.book import established, tex
from .engine.nomenclature import Symbol, symbol
from .engine.record import Derivation
from .engine.step import Proof

scaled_friction = symbol("mu_W", latex=r"\hat \mu")
PLACES, PROVED = 6, 4
"""Digits of the maximum that are printed, and decimals of its place that are proved."""


ROWS = (Symbol(r"\Lambda", "retardation length in the units of the load", "1", None),
        Symbol(r"\hat \mu", "friction coefficient in the units of the load", "1", None),
        Symbol("w_n", "load in the units of the half length", "1", None),
        Symbol(r"\varphi_n", "friction force in the units of the half length", "1", None),
        Symbol(r"\mu_{\mathrm{L2}}", "asymptote of $\\mu$ for high velocity", "1", None))  # fmt: skip
"""What these letters mean for a dead weight of this shape."""


class Weight:
    """The derivations for one power, from those of its steady state."""

    def __init__(self, coefficient: sp.Expr, power: sp.Rational, q: sp.Symbol) -> None:
        self.c, self.n, self.q = coefficient, power, q
        self.length = (W / (K * coefficient)) ** (1 / (power + 1))
        self.friction = coefficient * self.length ** (power - 1)
        """The unit of the friction coefficient."""

    def derive(self) -> Iterator[Derivation]:
        """Derive them in reading order."""
        yield self._groups()
        yield self._low()
        yield self._high()
        yield self._crossing()
        yield self._maximum()

    def _proof(self, label: str, title: str, text: str) -> Proof:
        section = "An indenter of this shape"
        return Proof(f"shape-weight-{label}", None, section=section, title=title, text=text)

    def _number(self, form: sp.Expr) -> sp.Expr:
        """Return a form in which all quantities but q cancel."""
        ones = dict.fromkeys(form.free_symbols - {self.q}, sp.S.One)
        parts = sp.Mul.make_args(sp.factor(sp.powsimp(form.subs(ones))))
        falling = self.q - 1
        product = sp.Mul(*(1 - self.q if each == falling else each for each in parts))
        return -product if falling in parts else product

    def _groups(self) -> Derivation:
        proof = self._proof("groups", "Dead weight: groups and master curve", _GROUPS)
        for label, name in (("trailing", l_r), ("load", W), ("friction", F)):
            proof.recall(f"shape-{label}", name)
        proof.define(mu, F / W, "Eq. (37)")
        for name, form in ((Lambda, l_r / self.length), (scaled_friction, mu / self.friction)):
            proof.define(name, form, "in the units of the load")
            curve = self._number(proof._resolve(form))
            proof.equal(name, curve, "all else cancels")
        return proof.done(scaled_friction, curve)

    def _asymptotes(self, proof: Proof, label: str, name: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
        """Give load and friction coefficient their leading terms, and return these."""
        load = proof.asymptote(f"shape-{label}", W, W, "the load that the contact carries")
        return load, proof.asymptote(f"shape-{label}", mu, name)

    def _low_form(self, load: sp.Expr, friction: sp.Expr) -> sp.Expr:
        scale = self._number(load / (K * self.c * a ** (self.n + 1)))
        factor = self._number(friction / (self.c * l_r * a ** (self.n - 2)))
        return factor * scale ** ((2 - self.n) / (self.n + 1)) * self.friction * l_r / self.length

    def _high_form(self, load: sp.Expr, friction: sp.Expr) -> sp.Expr:
        scale = self._number(load / (K * self.c * l_r * a**self.n))
        factor = self._number(friction / (self.c * a ** (self.n - 1))) / scale ** (1 - 1 / self.n)
        return factor * self.friction * (self.length / l_r) ** (1 - 1 / self.n)

    def _low(self) -> Derivation:
        return self._limit("low", "Dead weight: low velocity", _LOW, mu_low, self._low_form)

    def _high(self) -> Derivation:
        text = _HIGH.format(tex(1 / self.n - 1))
        return self._limit("high", "Dead weight: high velocity", text, mu_high, self._high_form)

    def _limit(
        self, label: str, title: str, text: str, name: sp.Symbol, in_load: Callable[..., sp.Expr]
    ) -> Derivation:
        proof = self._proof(label, title, text)
        form = in_load(*self._asymptotes(proof, label, name)).subs(l_r, V * tau)
        proof.recall("eq29", l_r)
        proof.equal(name, form, "with the load in place of the half length")
        return proof.done(name, form)

    def _crossing(self) -> Derivation:
        proof = self._proof("crossing", "Dead weight: where the asymptotes meet", _CROSSING)
        for label, name in (("low", mu_low), ("high", mu_high)):
            proof.recall(f"shape-weight-{label}", name)
        low, high = (proof._resolve(name) for name in (mu_low, mu_high))
        power = 2 - 1 / self.n
        factor = self._number(high / low * (V * tau / self.length) ** power)
        place = factor ** (1 / power) * self.length / tau
        proof.define(V_star, place, "the critical velocity")
        proof.equal(mu_low / mu_high, (V / V_star) ** power, "1 there, and nowhere else")
        return proof.done(V_star, place)

    def _maximum(self) -> Derivation:
        q, rise, fall = self.q, self.n + 1, 2 * self.n
        load = self._number(established("shape-load", W) / (K * self.c * a**rise))
        friction = self._number(established("shape-friction", F) / (K * self.c**2 * a**fall))
        velocity, height = (
            established("shape-weight-groups", name) for name in (Lambda, scaled_friction)
        )
        slope = sp.factor(rise * load * sp.diff(friction, q) - fall * friction * sp.diff(load, q))
        polynomial = next(
            base for base, _ in sp.factor_list(sp.fraction(slope)[0])[1] if _crosses(base, q)
        )
        rest = sp.factor(slope / polynomial)
        if rest.subs(q, sp.Rational(1, 2)) < 0:
            polynomial, rest = -polynomial, -rest
        place = next(root for root in sp.real_roots(sp.Poly(polynomial, q)) if 0 < root < 1)
        found = [tex(sp.N(form.subs(q, place), PLACES)) for form in (place, velocity, height)]
        text = _MAXIMUM.format(tex(q), *found, tex(self.length), tex(self.friction))
        proof = self._proof("maximum", "Dead weight: the friction maximum", text)
        proof.recall("shape-weight-groups", scaled_friction)
        steepness = sp.Derivative(scaled_friction, q) / scaled_friction
        proof.define(w_n, load, "the load over $K c a^{n + 1}$")
        proof.define(phi_n, friction, "the friction force over $K c^2 a^{2 n}$")
        proof.equal(
            rise * w_n * phi_n * steepness, polynomial * rest, "the slope, times what is positive"
        )
        proof.holds(rest, ">", 0, "so that the other factor decides")
        proof.unique_root(polynomial, (q, 0, 1), "one maximum")
        low = sp.Rational(math.floor(place * 10**PROVED), 10**PROVED)
        proof.unique_root(polynomial, (q, low, low + sp.Rational(1, 10**PROVED)), "its place")
        return proof.done(rise * w_n * phi_n * steepness, polynomial * rest)


def _crosses(base: sp.Expr, q: sp.Symbol) -> bool:
    """Tell whether a factor changes its sign between 0 and 1."""
    ends = [(q, end) for end in (0, 1)]
    return bool(base.subs(*ends[0]) * base.subs(*ends[1]) < 0)


_GROUPS = (
    r"Two groups are left, $\hat \mu$ and the velocity $\Lambda$ in units of the length that the load gives; "
    r"the parameter of their curve is $q = x_{\mathrm{TE}}/a$."
)
_LOW = r"At a given load, for $V \to 0$; $\mu$ goes with $V$."
_HIGH = r"At a given load, for $V \to \infty$; $\mu$ goes with $V^{{{}}}$."
_CROSSING = "At a given load."
_MAXIMUM = (
    r"It is at ${0} = {1}$, where $V \tau = {2} \, {4}$ and $\mu = {3} \, {5}$. As $\mu$ vanishes at rest "
    r"and for $V \to \infty$, the one change of sign is a maximum; ${0}$ falls as $V$ grows (F19-edge, "
    r"F19-balance)."
)
