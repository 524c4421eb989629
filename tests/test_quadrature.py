import math
from functools import partial

import mpmath
import numpy as np
import pytest

from kvtheory.models.steady.methods import ODD, solve_quadrature
from kvtheory.results import STEADY_UNITS
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Circle, Parabola, PowerLaw, Profile, Wedge
from tests import SUPPORTS, reference, steady

at_depth, at_load = (
    partial(each, solve=solve_quadrature) for each in (steady.at_depth, steady.at_load)
)
K, TAU, DEPTH = 1e10, 0.1, 3e-4


def close(state, truth, rtol=1e-12):
    """Hold the errors against both the tolerance and the certificate."""
    for name, value in truth.items():
        allowed = min(rtol, state.certificate.relative_error[name]) * abs(value)
        assert float(abs(getattr(state, name) - value)) <= allowed, name


@pytest.mark.parametrize("support", SUPPORTS)
def test_parabola_agrees_with_the_rigorous_reference(support):
    """Rest, both ends, then 24 decades of drive number, 18 of all else."""
    rng, method = np.random.default_rng(len(support)), "at_depth"
    method = method if support == "fixed" else "at_load"
    for i in range(50):
        R, stiffness, weight = (10.0 ** rng.uniform(-9, 9, 3)).tolist()
        tau, number, kappa = (10.0 ** rng.uniform((-6, -12, -6), (6, 12, 6))).tolist()
        number = {0: 0.0, 1: 1e-12, 2: 1e12}.get(i // 2, number)
        V = (-1.0) ** i * number / tau * (R * weight / stiffness) ** (1 / 3)
        static = (9.0 * weight**2 / (32.0 * stiffness**2 * R)) ** (1 / 3)
        grips = {
            "fixed": (static,),
            "dead-weight": (weight,),
            "suspended": (weight, kappa * weight / static),
        }
        given = stiffness, tau, V, *grips[support]
        state = getattr(steady, method)(Parabola(R), *given, solve=solve_quadrature)
        assert not reference.excess(state, getattr(reference.parabola, method)(R, *given))
        assert max(state.certificate.relative_error.values()) < 1e-12


@pytest.mark.parametrize("ratio", [1e-9, 0.2, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 5.0, 1e9])
def test_wedge(ratio):
    """Peeling reaches the vertex at l_r = delta/slope, where the closed form changes branch."""
    s, b = 0.125, DEPTH / 0.125  # powers of two, so that l_r = b is met exactly
    l_r = ratio * b
    if ratio < 1.0:
        edge, inside = b - l_r, l_r * s**2 * (2.0 * b - l_r)
        load, friction = DEPTH * b + l_r**2 * s / 2.0, inside + (l_r * s) ** 2 / 2.0
    else:
        edge, inside = 0.0, l_r * s * DEPTH
        load, friction = DEPTH * b / 2.0 + l_r * DEPTH, inside + DEPTH**2 / 2.0
    state = at_depth(Wedge(s), K, 1.0, l_r, DEPTH)
    truth = {
        "leading_edge": -b,
        "load": K * load,
        "friction_force": K * friction,
        "friction_coefficient": friction / load,
        "peak_pressure": K * (DEPTH + l_r * s),
        "dissipated_in_contact": inside / friction,
    }
    assert state.trailing_edge == pytest.approx(edge, rel=1e-14, abs=1e-14 * b)
    close(state, truth)


@pytest.mark.parametrize("fraction", [0.01, 0.5, 0.9, 1.0 - 6.6e-5])
@pytest.mark.parametrize("l_r", [1.01e-8, 1.05e-8, 1e-6, 0.01, 10.0])
def test_circle(fraction, l_r):
    """With 40 digits. Nearly vertical, the sensitivities to both edges cancel; their rounding does not."""
    R, depth = 0.01, fraction * 0.01
    with mpmath.workdps(40):
        r, d, l = map(mpmath.mpf, (R, depth, l_r))

        def slope(x):
            return x / mpmath.sqrt(r * r - x * x)

        def pressure(x):
            return d - (r - mpmath.sqrt(r * r - x * x)) - l * slope(x)

        a = mpmath.sqrt(2 * r * d - d**2)
        x = mpmath.findroot(pressure, (0, a), solver="bisect", maxsteps=250, verify=False)
        below = sum(
            r * e - (e * mpmath.sqrt(r * r - e * e) + r * r * mpmath.asin(e / r)) / 2
            for e in (a, x)
        )
        load = d * (a + x) - below + l * l * slope(x)
        drag = sum(r * mpmath.atanh(end / r) - end for end in (a, x))  # int h'^2 dx
        friction = l * (drag + l * slope(x) ** 2 / 2)
        assert mpmath.almosteq(load, mpmath.quad(pressure, [-a, 0, x]), 1e-9)
        truth = {
            "leading_edge": -a,
            "trailing_edge": x,
            "load": K * load,
            "friction_force": K * friction,
            "friction_coefficient": friction / load,
            "dissipated_in_contact": l * drag / friction,
        }
        close(at_depth(Circle(R), K, 1.0, l_r, depth), truth, 1e-12 if fraction < 0.99 else 1e-5)


def lopsided(sign):
    """A parabola with a cubic term: blunter on one side than on the other."""
    c = 40.0 * sign
    return Profile(lambda x: (50.0 + c * x) * x * x, lambda x: (100.0 + 3.0 * c * x) * x, reach=0.4)


@pytest.mark.parametrize("V", [0.0, 1e-4, 0.1, 10.0])
def test_reversed_drive_is_the_mirror_image(V):
    forward = at_load(lopsided(1.0), K, TAU, V, 1e6)
    mirrored = at_load(lopsided(-1.0), K, TAU, -V, 1e6)
    other_way = at_load(lopsided(1.0), K, TAU, -V, 1e6)
    for name in STEADY_UNITS:
        if V == 0.0 and name.endswith("edge"):
            continue
        expected = (-1.0 if name in ODD else 1.0) * getattr(forward, name)
        # At rest both are integrated in the same direction, and sums are rounded in another order.
        assert getattr(mirrored, name) == pytest.approx(expected, rel=0.0 if V else 1e-14), name
    if V == 0.0:
        assert mirrored.leading_edge == pytest.approx(-forward.trailing_edge, rel=1e-14)
    else:
        assert abs(other_way.friction_force / forward.friction_force + 1.0) > 1e-6


def bent(declared):
    """Flanks that become steeper at |x| = 1 mm."""
    b = 1e-3
    return Profile(
        lambda x: 0.1 * abs(x) + 0.3 * max(abs(x) - b, 0.0),
        lambda x: math.copysign(0.1 if abs(x) < b else 0.4, x),
        kinks=(-b, b) if declared else (),
    )


@pytest.mark.parametrize("V", [1e-3, 5e-3, 0.2])
def test_kinks(V):
    """The trailing edge lies beyond the kink, on it and before it."""
    s, t, b, l_r = 0.1, 0.4, 1e-3, V * TAU
    a = b + (DEPTH - s * b) / t
    x_te = a - l_r if a - l_r > b else b if DEPTH / s - l_r > b else max(DEPTH / s - l_r, 0.0)
    h = s * x_te + (t - s) * max(x_te - b, 0.0)
    u, area = DEPTH - h, (DEPTH + DEPTH - s * b) * b / 2.0 + (DEPTH - s * b) ** 2 / (2.0 * t)
    inside = t * t * (a - b) + s * s * b + s * s * min(x_te, b) + t * t * max(x_te - b, 0.0)
    behind = min(x_te, b) * DEPTH - s * min(x_te, b) ** 2 / 2.0
    if x_te > b:
        behind += (x_te - b) * (DEPTH - s * b + u) / 2.0
    state = at_depth(bent(declared=True), K, TAU, V, DEPTH)
    assert state.leading_edge == pytest.approx(-a, rel=1e-14)
    assert state.trailing_edge == pytest.approx(x_te, rel=1e-13)
    assert state.load == pytest.approx(K * (area + behind + l_r * u), rel=1e-13)
    assert state.friction_force == pytest.approx(K * (u * u / 2.0 + l_r * inside), rel=1e-13)
    peak = max(DEPTH + l_r * s, DEPTH - s * b + l_r * t)
    assert state.peak_pressure == pytest.approx(K * peak, rel=1e-12)
    with pytest.raises(QuadratureError, match=r"the slope jumps .*`kinks`"):
        at_depth(bent(declared=False), K, TAU, V, DEPTH)


def plain(x):
    return x * x / 0.02


def tilt(x):
    return x / 0.01


FAILURES = {
    "height is nan": (Profile(lambda x: math.nan if x > 1e-3 else plain(x), tilt), "nan at x = "),
    "slope is nan": (
        Profile(plain, lambda x: math.nan if 1e-4 < x < 2e-4 else tilt(x)),
        "nan at x = ",
    ),
    "outside the domain of a function": (
        Profile(lambda x: 0.01 - math.sqrt(1e-4 - x * x) if x < 1e-3 else math.log(-x), plain),
        "shape failed at x",
    ),
    "wrong slope": (Profile(plain, lambda x: x / 0.011), "not the derivative"),
    "noise": (Profile(plain, lambda x: tilt(x) * (1.0 + 1e-6 * math.sin(1e14 * x))), "not smooth"),
    "contacts without an end": (
        Profile(lambda x: 1e-3 * math.sin(x / 1e-3) ** 2, lambda x: math.sin(x / 5e-4)),
        "search interval is too large",
    ),
    "flat": (
        Profile(lambda x: 1e-4 * math.tanh(x * x), lambda x: 2e-4 * x / math.cosh(x * x) ** 2),
        "does not rise|failed at",
    ),
    "reach too short": (
        Profile(plain, tilt, reach=1e-3),
        "contact lies beyond the indenter's reach",
    ),
    "not zero at the origin": (Profile(lambda x: plain(x) + 1e-5, tilt), "lowest point"),
    "lower beside the origin": (
        Profile(lambda x: plain(x - 1e-4) - plain(1e-4), lambda x: tilt(x - 1e-4)),
        "lowest point",
    ),
    "circle too deep": (Circle(2e-4), "beyond the indenter's reach"),
    "circle almost too deep": (Circle(DEPTH * (1.0 + 1e-9)), "reach"),
}


@pytest.mark.parametrize("name", FAILURES)
def test_failure_is_an_error_with_its_reason(name):
    indenter, reason = FAILURES[name]
    with pytest.raises(QuadratureError, match=reason):
        at_depth(indenter, K, TAU, 0.1, DEPTH)


@pytest.mark.parametrize("rounding", [2e-22, -2e-22])
def test_rounding_of_the_height_of_the_lowest_point_is_allowed(rounding):
    rounded = Profile(lambda x: plain(x) + rounding, tilt)
    expected = at_depth(Profile(plain, tilt), K, TAU, 0.1, DEPTH)
    assert at_depth(rounded, K, TAU, 0.1, DEPTH).load == pytest.approx(expected.load, rel=1e-12)
    loaded = at_load(rounded, K, TAU, 0.1, expected.load)
    assert loaded.depth == pytest.approx(DEPTH, rel=1e-12)


def test_weight_that_the_reach_cannot_carry():
    short = Profile(plain, tilt, reach=1e-3)
    assert at_load(short, K, TAU, 0.1, 300.0).load == pytest.approx(300.0, rel=1e-12)
    for shape in (Circle(1e-3), short):
        with pytest.raises(QuadratureError, match="beyond the indenter's reach"):
            at_load(shape, K, TAU, 0.1, 1e6)


SHAPES = [
    Parabola(0.01),
    Circle(0.01),
    Wedge(0.1),
    *(PowerLaw(0.01, n) for n in (1.0, 1.01, 1.25, 2.0, 3.5, 20.0)),
]
NAMED = [f"{shape.shape} {getattr(shape, 'exponent', '')}".strip() for shape in SHAPES]


@pytest.mark.parametrize("shape", SHAPES, ids=NAMED)
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_depth_under_a_load_carries_it(shape, side):
    """Over twenty decades of l_r, without a spring and with one."""
    # At rest a circle cannot carry what it carries at the highest velocities.
    V = side * np.geomspace(1.3e-11, 1e-2 if shape.reach < math.inf else 1e9, 41)[:, None]
    one = np.ones_like(V)
    depth = 1e-4 * one
    carried = at_depth(shape, K * one, TAU * one, V, depth)
    free = at_load(shape, K * one, TAU * one, V, carried.load, 0.0 * one)
    error = carried.certificate.relative_error["load"] + free.certificate.relative_error["depth"]
    assert np.all(np.abs(free.depth / depth - 1.0) <= error)
    rest = at_load(shape, K * one, TAU * one, 0.0 * V, carried.load, 0.0 * one)
    spring = carried.load / rest.depth
    held = at_load(shape, K * one, TAU * one, V, carried.load, spring)
    assert held.load == pytest.approx(carried.load + spring * (rest.depth - held.depth), rel=1e-12)
    for state in (carried, free, held):
        errors = dict(state.certificate.relative_error)
        seen = state.trailing_edge != 0.0  # of a nearly sharp tip it may be too close to tell
        assert np.all(np.isinf(errors["trailing_edge"][~seen]) | (shape.bend(1.0) == 0.0))
        errors["trailing_edge"] = errors["trailing_edge"][seen]
        assert max(np.max(error) for error in errors.values()) < 1e-11


def test_one_scene_of_a_column_that_fails_fails_all():
    depth = np.array([[1e-4], [2e-2], [1e-4]])
    one = np.ones_like(depth)
    with pytest.raises(QuadratureError, match="reach"):
        at_depth(Circle(0.01), K * one, TAU * one, 0.1 * one, depth)
