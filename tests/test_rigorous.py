"""Rigorous enclosures by ball arithmetic: the floating-point results lie within their stated error."""

import numpy as np
import pytest
from flint import arb, ctx, fmpq_poly, fmpz

from kvtheory.models.steady import exact
from kvtheory.theory import closed_forms as cf
from tests import reference
from tests.steady import at_depth, at_load

BITS = 300
STATED = exact.HELD.relative_error
SCENES = 300


def covers(bound, value, truth):
    """Whether |value - truth| <= bound |truth| for certain."""
    return reference.relative_error(float(value), truth) <= bound


@pytest.fixture(autouse=True)
def precision():
    with ctx.workprec(BITS):
        yield


def scaled_friction(q):
    """Theorems F1 and F2 by hand: mu (K R^2/W)^(1/3) at fixed load, as a function of q."""
    m = (1 - q) * (q * q - q + 4) / (2 * (q * q - 2 * q + 3))
    w = (1 + q) ** 2 * (q * q - 2 * q + 3) / (6 * q)
    return m * (2 / w).root(3)  # a = (2 R W/(K w))^(1/3)


def scaled_velocity(q):
    return (1 - q * q) / (2 * q) * (2 / ((1 + q) ** 2 * (q * q - 2 * q + 3) / (6 * q))).root(3)


def test_the_friction_maximum_is_enclosed():
    peak = 2 - arb(3).sqrt()
    assert covers(2e-16, cf.PEAK_DRIVE_NUMBER, scaled_velocity(peak))
    assert covers(2e-16, cf.PEAK_FRICTION, scaled_friction(peak))
    # A maximum: the centred slope changes its sign over an interval of 1e-20 around q.
    step, h = arb(10) ** -20, arb(10) ** -30
    for side, sign in ((-1, 1), (1, -1)):
        q = peak + side * step
        assert sign * (scaled_friction(q + h) - scaled_friction(q - h)) > 0


def test_no_other_velocity_has_more_friction():
    """Cover (0, 1) with balls: outside the ball of the peak, friction is below its maximum."""
    top = scaled_friction(2 - arb(3).sqrt())
    count = 4000
    for i in range(count):
        centre = (arb(2 * i) + 1) / (2 * count)
        ball = arb(centre.mid(), arb(1) / (2 * count))
        if i == 0:
            continue  # below q = 1/4000 friction is under its asymptote, tested next
        value = scaled_friction(ball)
        assert value < top or abs(float(centre) - (2 - 3**0.5)) < 0.02
    assert scaled_friction(arb(1) / count) < top / 2


@pytest.mark.processor
@pytest.mark.parametrize("decade", range(-12, 13, 3))
def test_the_root_of_the_quartic_is_enclosed(decade):
    """2 L q^2 (q^2 - 2 q + 3) = 3 (1 - q)^3 (1 + q) with L = Lambda^3 has one root in (0, 1)."""
    rng = np.random.default_rng(decade + 100)
    for exponent in rng.uniform(decade - 0.5, decade + 0.5, SCENES // 9 + 1):
        number = float(10.0**exponent)
        cube = arb(number) ** 3

        def excess(q, cube=cube):
            return 3 * (1 - q) ** 3 * (1 + q) - 2 * cube * q * q * (q * q - 2 * q + 3)

        state = at_load(1.0, 1.0, 1.0, number, 1.0)
        found = state.trailing_edge / state.half_length
        # The root in terms of l = (1 - q^2)/(2 q), whose relative accuracy holds in both limits.
        l = state.retardation_length / state.half_length
        low, high = (
            1 / (x + (1 + x * x).sqrt()) for x in (arb(l) * (1 + s * arb(2e-15)) for s in (1, -1))
        )
        assert excess(low) > 0 > excess(high)
        assert covers(4e-15, found, 1 / (arb(l) + (1 + arb(l) ** 2).sqrt()))


def test_the_quartic_has_one_root_between_0_and_1_by_sturm():
    rng = np.random.default_rng(4)
    for exponent in rng.uniform(-3, 3, 20):
        L = fmpz(int(10.0 ** (exponent + 6)))
        q = fmpq_poly([0, 1])
        quartic = 3 * (1 - q) ** 3 * (1 + q) * 10**6 - 2 * L * q * q * (q * q - 2 * q + 3)
        roots = [r for r, _ in quartic.complex_roots()]
        inside = [r for r in roots if r.imag.contains(0) and 0 < r.real < 1]
        assert len(inside) == 1


@pytest.mark.processor
def test_load_and_friction_are_within_their_error_of_the_enclosed_integrals():
    rng = np.random.default_rng(7)
    for _ in range(SCENES):
        R, K, tau, depth = (float(x) for x in 10.0 ** rng.uniform([-4, 6, -4, -8], [0, 12, 2, -2]))
        V = float(10.0 ** rng.uniform(-6, 6) * np.sqrt(2 * R * depth) / tau)
        load, friction = reference.integrals(R, K, tau, V, depth)
        state = at_depth(R, K, tau, V, depth)
        assert covers(STATED["load"], state.load, load)
        assert covers(STATED["friction_force"], state.friction_force, friction)
