"""What is derived for other shapes, held against numbers from elsewhere: integrals, roots, brute force."""

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import friction_identity, power_law, power_law_weight, wedge

from tests.conftest import digits

_digits = digits(50)


class Contact:
    """A power law on a foundation of stiffness 1, by quadrature of the elements' law."""

    def __init__(self, exponent, number):
        self.n, self.l = mp.mpf(exponent), mp.mpf(number)
        low, high = mp.mpf(0), mp.mpf(1)
        for _ in range(180):
            middle = (low + high) / 2
            low, high = (middle, high) if self.pressure(middle) > 0 else (low, middle)
        self.q = low
        pieces = [-1, 0, self.q]
        self.load = mp.quad(self.pressure, pieces)
        self.friction = mp.quad(lambda x: -self.slope(x) * self.pressure(x), pieces)
        self.lost = self.l * mp.quad(lambda x: self.slope(x) ** 2, pieces)

    def slope(self, x):
        """The slope of h, in units of delta/a."""
        return mp.sign(x) * self.n * abs(x) ** (self.n - 1)

    def pressure(self, x):
        return 1 - abs(x) ** self.n - self.l * self.slope(x)

    def value(self, expr):
        point = {s.exponent: self.n, s.l: self.l, s.q: self.q, s.Q: self.q ** (self.n - 1)}
        return mp.mpf(str(sp.N(expr.subs({k: sp.Float(v, 50) for k, v in point.items()}), 50)))


@pytest.mark.parametrize("exponent", ["1.5", "3.7", "9"])
@pytest.mark.parametrize("number", ["0.001", "0.6", "40"])
def test_the_forms_of_a_power_law_are_those_of_quadrature(exponent, number):
    contact = Contact(exponent, number)
    inside = (1 + s.q * s.Q**2) * s.exponent**2 * s.l / (2 * s.exponent - 1)
    for expr, truth in (
        (power_law.NUMBER, contact.l),
        (power_law.LOAD, contact.load),
        (power_law.FRICTION_FORCE, contact.friction),
        (power_law.FRICTION_COEFFICIENT, contact.friction / contact.load),
        (inside, contact.lost),
    ):
        assert mp.almosteq(contact.value(expr), truth, rel_eps=mp.mpf("1e-25"))


@pytest.mark.parametrize("exponent", ["1.2", "2", "5"])
def test_friction_rises_under_a_weight_where_the_derivation_says(exponent):
    def friction(number):
        contact = Contact(exponent, number)
        n = contact.n
        size = (2 * n / (n + 1) / contact.load) ** (1 / (n + 1))
        return size ** (n - 1) * contact.friction / contact.load, contact

    for number in ("0.5", "1.2", "1.7", "9"):
        step = mp.mpf("1e-12")
        (low, _), (high, contact) = (
            friction(mp.mpf(number) * (1 + side * step)) for side in (-1, 1)
        )
        assert mp.sign(high - low) == mp.sign(contact.value(power_law_weight.SLIP))


@pytest.mark.parametrize(("support", "drive"), [(0, "0.3"), (2, "0.7"), (0, "4"), (5, "40")])
def test_the_depth_of_a_wedge_balances_its_weight(support, drive):
    lam, kappa = mp.mpf(drive), mp.mpf(support)
    peeling = 1.5 * lam**2 + kappa * lam < 1 + kappa
    form = wedge.SCALED_PEELING if peeling else wedge.SCALED_PEELED
    held = {s.held: 1 + s.kappa - s.lam**2 / 2}
    numbers = {s.lam: sp.Float(drive, 50), s.kappa: support}
    depth = mp.mpf(str(sp.N(form.subs(held).subs(numbers), 50)))
    number = lam / depth
    assert (number < 1) == peeling
    load = 1 + number**2 / 2 if number < 1 else number + mp.mpf(1) / 2
    assert abs(depth**2 * load + kappa * (depth - 1) - 1) < mp.mpf("1e-40") * (1 + kappa)


def test_the_load_of_the_friction_identity_is_that_of_two_lines():
    assert s.K * (s.a**3 + s.r**3 - s.l_r**3) / (3 * s.R) == friction_identity.LOAD
