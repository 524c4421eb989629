"""The ring in which identities are decided first: what it proves is true."""

import pytest
import sympy as sp
from kvtheory.derivations.engine.identity import vanishes

x, y, n = sp.symbols("x y n", positive=True)
_ROOT = sp.sqrt(1 + x)
_NESTED = sp.sqrt(2 + _ROOT)

TRUE = (
    1 / (1 + x) + x / (1 + x) - 1,
    _ROOT**3 - (1 + x) * _ROOT,
    1 / _ROOT - _ROOT / (1 + x),
    _NESTED**5 - (2 + _ROOT) ** 2 * _NESTED,
    (x + y) ** (n + 1) - (x + y) * (x + y) ** n,
    (x / (1 - y) + y) ** n - ((x + y - y**2) / (1 - y)) ** n,
    sp.exp(2 * x) - sp.exp(x) ** 2,
    (sp.exp(2 * x) - 1) / (sp.exp(x) - 1) - sp.exp(x) - 1,
)


@pytest.mark.parametrize("expr", TRUE, ids=str)
def test_an_identity_is_proved_and_no_neighbour_of_it(expr):
    """Off by a number, or by a variable, it is none."""
    assert vanishes(expr)
    assert not any(vanishes(expr + off) for off in (sp.Rational(1, 10**9), x, -y / (1 + x)))


def test_a_denominator_that_is_zero_proves_nothing():
    nothing = sp.sqrt(x**2 + 2 * x + 1) - x - 1
    assert not vanishes(1 / nothing - 2 / nothing)
    assert not vanishes(x / nothing + y / (nothing * (1 + y)))
