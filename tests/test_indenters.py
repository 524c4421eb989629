import math

import mpmath
import numpy as np
import pytest

from kvtheory.scene.indenters import Circle, Parabola, PowerLaw, Profile, Wedge

INDENTERS = [
    Parabola(radius=0.01),
    Circle(radius=0.01),
    PowerLaw(length=0.01, exponent=1.5),
    PowerLaw(length=0.01, exponent=4.0),
    PowerLaw(length=0.01, exponent=20.0),
    Wedge(inclination=0.2),
    Profile(lambda x: 3.0 * x * x + x**3, lambda x: 6.0 * x + 3.0 * x * x),
]
X = np.array([-7e-3, -1e-3, -2e-5, 4e-5, 3e-3, 8e-3])


@pytest.mark.parametrize("indenter", INDENTERS)
def test_height_and_slope_belong_together_and_take_arrays(indenter):
    step = 1e-5 * np.abs(X)
    difference = (indenter.height(X + step) - indenter.height(X - step)) / (2.0 * step)
    np.testing.assert_allclose(indenter.slope(X), difference, rtol=1e-8)
    for function in (indenter.height, indenter.slope):
        np.testing.assert_array_equal(function(X), [float(function(x)) for x in X.tolist()])
    assert float(indenter.height(0.0)) == 0.0  # the lowest point is the origin
    assert np.all(indenter.height(X) > 0.0)
    if indenter.convex:  # and even
        np.testing.assert_array_equal(indenter.height(-X), indenter.height(X))
        np.testing.assert_array_equal(indenter.slope(-X), -indenter.slope(X))
        bend = (indenter.slope(X + step) - indenter.slope(X - step)) / (2.0 * step)
        np.testing.assert_allclose(indenter.bend(X), X * bend / indenter.slope(X), rtol=1e-7)


@pytest.mark.parametrize("fraction", [1e-12, 1e-6, 0.3, 0.999, 1.0 - 1e-12])
def test_circle_does_not_cancel(fraction):
    circle = Circle(radius=0.02)
    x = fraction * circle.radius
    with mpmath.workdps(50):
        R, exact = mpmath.mpf(circle.radius), mpmath.mpf(x)
        height = R - mpmath.sqrt(R * R - exact * exact)
        slope = exact / mpmath.sqrt(R * R - exact * exact)
        assert abs(circle.height(x) / height - 1) < 4e-16
        assert abs(circle.slope(x) / slope - 1) < 4e-16


def test_circle_ends_with_a_vertical_surface():
    circle = Circle(radius=0.02)
    assert circle.reach == 0.02
    assert circle.slope(0.02) == math.inf
    assert math.isnan(circle.height(0.021))


def test_power_law_contains_the_parabola_and_the_wedge():
    np.testing.assert_allclose(PowerLaw(0.01, 2.0).height(X), Parabola(0.01).height(X), rtol=4e-16)
    np.testing.assert_array_equal(PowerLaw(0.01, 1.0).height(X), Wedge(1.0).height(X))
