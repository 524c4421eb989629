"""Theorems F1 to F3 by ball arithmetic, from formulas that are typed here."""

import numpy as np
import pytest
from flint import arb, ctx

from kvtheory.theory import closed_forms as cf
from tests.reference import relative_error
from tests.steady import at_load


@pytest.fixture(autouse=True)
def precision():
    with ctx.workprec(300):
        yield


def scaled_friction(q):
    """Theorems F1 and F2 by hand: mu (K R^2/W)^(1/3) at fixed load, as a function of q."""
    m = (1 - q) * (q * q - q + 4) / (2 * (q * q - 2 * q + 3))
    return m * (2 / load_factor(q)).root(3)  # a = (2 R W/(K w))^(1/3)


def load_factor(q):
    return (1 + q) ** 2 * (q * q - 2 * q + 3) / (6 * q)


def test_the_friction_maximum_is_enclosed():
    peak = 2 - arb(3).sqrt()
    velocity = (1 - peak * peak) / (2 * peak) * (2 / load_factor(peak)).root(3)
    assert relative_error(cf.PEAK_DRIVE_NUMBER, velocity) <= 2e-16
    assert relative_error(cf.PEAK_FRICTION, scaled_friction(peak)) <= 2e-16
    # A maximum: the centred slope changes its sign over an interval of 1e-20 around q.
    step, h = arb(10) ** -20, arb(10) ** -30
    for side, sign in ((-1, 1), (1, -1)):
        q = peak + side * step
        assert sign * (scaled_friction(q + h) - scaled_friction(q - h)) > 0


@pytest.mark.processor
def test_the_root_of_the_quartic_is_enclosed():
    """2 L q^2 (q^2 - 2 q + 3) = 3 (1 - q)^3 (1 + q) with L = Lambda^3 has one root in (0, 1)."""
    numbers = 10.0 ** np.random.default_rng(100).uniform(-12.5, 12.5, 120)
    states = at_load(1.0, 1.0, 1.0, numbers, 1.0)
    ratios = states.retardation_length / states.half_length  # accurate relatively in both limits
    found = states.trailing_edge / states.half_length
    for number, l, q in zip(numbers.tolist(), ratios.tolist(), found.tolist(), strict=True):
        excess = []
        for side in (1, -1):
            x = arb(l) * (1 + side * arb(2e-15))
            root = 1 / (x + (1 + x * x).sqrt())
            left = 2 * arb(number) ** 3 * root * root * (root * root - 2 * root + 3)
            excess.append(3 * (1 - root) ** 3 * (1 + root) - left)
        assert excess[0] > 0 > excess[1]
        assert relative_error(q, 1 / (arb(l) + (1 + arb(l) ** 2).sqrt())) <= 4e-15
