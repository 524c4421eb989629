"""Shapes that touch in several places, against a fine grid with exact memory."""

import json
import math
import platform
from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from kvtheory.models.steady.methods import solve_quadrature
from kvtheory.scene.indenters import Parabola, Profile
from tests import flushed, steady
from tests.commands import python

at_depth, at_load = (
    partial(each, solve=solve_quadrature) for each in (steady.at_depth, steady.at_load)
)
POINTS = 50_001


class Smooth(Profile):
    """A profile whose functions take arrays too."""

    def height(self, x):
        return self.height_function(x)

    def slope(self, x):
        return self.slope_function(x)


def on_a_grid(profile, side, l_r, depth, half_width, points=POINTS):
    """W/K, F/K, edges and peak p/K by u <- max(g, u e^(-dx/l_r)), from the definitions."""
    x = np.linspace(-half_width, half_width, points)
    dx = x[1] - x[0]
    g = depth - profile.height(side * x)
    if l_r == 0.0:
        u = np.maximum(g, 0.0)
    else:
        raised = np.where(g > 0.0, np.log(np.maximum(g, 1e-300)) + x / l_r, -np.inf)
        u = np.exp(np.maximum.accumulate(raised) - x / l_r)
    touching = (u > 0.0) & (u <= g * (1.0 + 1e-12))
    pressure = np.where(touching, g - l_r * side * profile.slope(side * x), 0.0)
    load = np.trapezoid(u, x) + l_r * u[-1]  # the surface relaxes to zero beyond the grid
    friction = l_r * np.sum(np.diff(u) ** 2) / dx + 0.5 * u[-1] ** 2
    edges = x[touching][[0, -1]]
    return np.array([load, friction, *edges, pressure.max()])


def held_against_a_grid(profile, l_r, depth, half_width, side=1.0):
    """Compare at a depth, as far as two grids agree with each other; return the state."""
    state = at_depth(profile, 1.0, 1.0, side * l_r, depth)
    grids = [on_a_grid(profile, side, l_r, depth, half_width, n) for n in (POINTS // 4, POINTS)]
    load, friction, x_le, x_te, peak = grids[1]
    apart = np.abs(grids[1] - grids[0])
    dx = 2.0 * half_width / (POINTS - 1)
    assert state.load == pytest.approx(load, abs=2.0 * apart[0] + 1e-7 * load)
    assert side * state.friction_force == pytest.approx(
        friction, abs=2.0 * apart[1] + 1e-3 * friction
    )
    assert side * state.leading_edge == pytest.approx(x_le, abs=2.0 * dx)
    assert side * state.trailing_edge == pytest.approx(x_te, abs=2.0 * dx)
    assert state.peak_pressure == pytest.approx(peak, abs=2.0 * apart[4] + 1e-2 * peak)
    return state


class Waves(Smooth):
    """x^2/(2R) and cosines, placed with the lowest point of their sum at zero."""

    def __init__(self, radius, amplitudes, lengths, phases):
        numbers = (2.0 * np.pi / np.asarray(lengths)).tolist()
        terms = list(zip(np.asarray(amplitudes).tolist(), numbers, phases, strict=True))

        def raw(x):
            return x * x / (2.0 * radius) + sum(a * np.cos(k * x + c) for a, k, c in terms)

        def tilt(x):
            return x / radius - sum(a * k * np.sin(k * x + c) for a, k, c in terms)

        roughness = sum(a for a, _, _ in terms)
        width = math.sqrt(4.0 * radius * roughness) + 1e-6
        x, step = np.linspace(-width, width, 50_001, retstep=True)
        lowest = x[np.argmin(raw(x))]
        origin = brentq(tilt, lowest - step, lowest + step, xtol=1e-18)
        level = raw(origin)
        super().__init__(lambda x: raw(x + origin) - level, lambda x: tilt(x + origin))
        object.__setattr__(self, "roughness", roughness)
        object.__setattr__(self, "radius", radius)

    def width(self, depth):
        """Half of a width that holds every contact."""
        return 1.5 * math.sqrt(2.0 * self.radius * (depth + 2.0 * self.roughness))


def random_waves(seed):
    """A rough parabola over decades of radius, waves, depth and retardation length."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 6))
    amplitudes = 10.0 ** rng.uniform(-7.0, -5.0, count)
    lengths = 10.0 ** rng.uniform(-4.3, -2.5, count)
    radius = 10.0 ** rng.uniform(-3.0, 0.0)
    profile = Waves(radius, amplitudes, lengths, rng.uniform(0.0, 6.28, count).tolist())
    depth = profile.roughness * 10.0 ** rng.uniform(-1.0, 1.0)
    l_r = 0.0 if seed % 5 == 0 else 10.0 ** rng.uniform(-5.0, -1.0)
    return profile, l_r, depth, (1.0 if seed % 2 or not l_r else -1.0)


@pytest.mark.parametrize("seed", range(6))
def test_random_rough_profiles(seed):
    """At a depth, and at the load there; W is convex in the depth, which makes that depth unique."""
    profile, l_r, depth, side = random_waves(seed)
    state = held_against_a_grid(profile, l_r, depth, profile.width(depth), side)
    back = at_load(profile, 1.0, 1.0, side * l_r, state.load)
    error = state.certificate.relative_error["load"] + back.certificate.relative_error["depth"]
    assert abs(back.depth / depth - 1.0) <= error
    assert back.certificate.relative_error["depth"] < 1e-9
    depths = np.sort(np.append(profile.roughness * np.linspace(0.1, 3.0, 5), depth))
    loads = [at_depth(profile, 1.0, 1.0, side * l_r, d).load for d in depths.tolist()]
    slopes = np.diff(loads) / np.diff(depths)
    assert np.all(np.diff(slopes) > -1e-9 * slopes[-1])


def wavy():
    """1e-5 (x/1e-3)^2 + 1e-6 (1 - cos(6 pi x/1e-3)): a wave every third of a millimetre."""
    return Waves(0.05, [1e-6], [1e-3 / 3.0], [math.pi])


@pytest.mark.parametrize("velocity", [0.0, 1e-6, -1e-3, 0.02])
def test_the_load_carried_is_the_load_asked_for(velocity):
    """Among the weights are those at which a contact more has just begun."""
    profile, l_r = wavy(), abs(velocity) * 0.1
    for weight in [5.656373927816772, *np.geomspace(0.5, 50.0, 4).tolist()]:
        state = at_load(profile, 1e10, 0.1, velocity, weight)
        assert state.load == pytest.approx(weight, rel=1e-9)
        load, *_ = on_a_grid(profile, 1.0, l_r, state.depth, profile.width(state.depth))
        assert load == pytest.approx(weight / 1e10, rel=1e-5)


def test_the_static_depth_of_a_spring_counts_every_contact():
    state, rest = (at_load(wavy(), 1e10, 0.1, V, 6.0, k) for V, k in ((0.02, 3e6), (0.0, 0.0)))
    assert state.load == pytest.approx(6.0 + 3e6 * (rest.depth - state.depth), rel=1e-10)
    load, *_ = on_a_grid(wavy(), 1.0, 2e-3, state.depth, wavy().width(state.depth))
    assert load == pytest.approx(state.load / 1e10, rel=1e-5)


def pair(distance, lift, radius=0.01):
    """Two parabolas of the same radius, one of them lifted."""

    def second(x):
        return (x - distance) ** 2 / (2.0 * radius) + lift < x * x / (2.0 * radius)

    return Smooth(
        lambda x: (x - distance * second(x)) ** 2 / (2.0 * radius) + lift * second(x),
        lambda x: (x - distance * second(x)) / radius,
    )


@pytest.mark.parametrize("distance", [5e-3, 0.07, 300.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_far_asperities_touch_as_if_they_were_alone(distance, side):
    """No memory is left over a distance of many retardation lengths."""
    l_r, depth, lift = 1e-4, 1e-4, 5e-5
    both = at_depth(pair(side * distance, lift), 1.0, 1.0, l_r, depth)
    alone = [at_depth(Parabola(0.01), 1.0, 1.0, l_r, d) for d in (depth, depth - lift)]
    for name in ("load", "friction_force"):
        total = sum(getattr(state, name) for state in alone)
        error = both.certificate.relative_error[name]
        assert abs(getattr(both, name) / total - 1.0) <= error + 1e-14
        assert error < 1e-6
    assert both.peak_pressure == pytest.approx(alone[0].peak_pressure, rel=1e-9)


@pytest.mark.parametrize("l_r", [1e-5, 1e-3, 3e-3, 0.1])
@pytest.mark.parametrize("lift", [-0.0, 9.9e-5])
def test_an_asperity_in_the_wake_of_another(l_r, lift):
    for distance in (3.5e-3, -3.5e-3):
        held_against_a_grid(pair(distance, lift), l_r, 1e-4, 6e-3)


@pytest.mark.parametrize(("position", "width"), [(-1e-3, 2e-5), (-7e-4, 1e-5)])
def test_narrow_bumps_of_a_profile_are_seen(position, width):
    """A bump of 1/200 and 1/400 of the contact, which carries 2e-5 of the load."""

    def bump(x):
        return 1e-6 * np.exp(-(((x - position) / width) ** 2))

    profile = Smooth(
        lambda x: x * x / 0.02 + bump(x) - bump(0.0),
        lambda x: x / 0.01 - 2.0 * (x - position) / width**2 * bump(x),
    )
    held_against_a_grid(profile, 1e-3, 3e-4, 3e-3)


@pytest.mark.parametrize("l_r", [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize("place", [-1.2e-3, 5e-4, 1e-3])
def test_a_step(l_r, place):
    """A smooth step up, 20 um wide, within the contact and outside of it."""
    rise = math.copysign(2e-5, place)

    def height(x):
        t = np.tanh((x - place) / 1e-5) + math.tanh(place / 1e-5)
        return x * x / 0.02 + rise * t

    def slope(x):
        return x / 0.01 + rise / 1e-5 / np.cosh(np.minimum(abs(x - place) / 1e-5, 300.0)) ** 2

    held_against_a_grid(Smooth(height, slope), l_r, 1e-4, 3e-3)


@pytest.mark.parametrize("l_r", [0.0, 1e-3, 1e-2])
def test_waves_that_lift_off_and_touch_again(l_r):
    profile = Waves(0.01, [2e-5], [5e-4 if l_r == 1e-2 else 1e-3], [math.pi])
    held_against_a_grid(profile, l_r, 3e-4, profile.width(3e-4))


@pytest.mark.parametrize("at_kink", ["left", "right", "mean", "lower", "nonsense", "nan", "error"])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_what_the_slope_function_returns_at_a_kink_does_not_matter(at_kink, side):
    """Two contacts, the first ends at the kink. W and F are by mpmath, each piece in closed form."""
    a, b = 1.6610036122645326e-3, 6.424327871506451e-05
    D, e = -0.4051779669421389, 2.3919088664695193e-3
    kink, depth, l_r = -0.26152387244755915, 1.1312568762807481e-04, 8.138962364733335e-4

    def height(x):
        return min(a * x * x, b + e * (side * x - D) ** 2)

    def slope(x):
        left, right = 2.0 * e * (x - side * D), 2.0 * a * x
        if x != side * kink:
            return left if side * x < kink else right
        lower = left if b + e * (kink - D) ** 2 < a * kink * kink else right
        values = {"left": left, "right": right, "mean": 0.5 * (left + right), "lower": lower,
                  "nonsense": 7.0, "nan": math.nan}  # fmt: skip
        return values[at_kink] if at_kink != "error" else 1.0 / (x - x)

    state = at_depth(Profile(height, slope, kinks=(side * kink,)), 1.0, 1.0, side * l_r, depth)
    truth = {"load": 4.8681533963680223e-5, "friction_force": side * 1.42275496455146356e-10}
    for name, value in truth.items():
        error = state.certificate.relative_error[name]
        assert abs(getattr(state, name) / value - 1.0) <= error < 2e-13


def test_a_processor_that_flushes_subnormal_numbers_changes_nothing():
    """Warnings are errors there."""
    if platform.machine() != "x86_64":
        pytest.skip("the processor is set in the machine code of x86-64")
    there = json.loads(python("-m", "tests.flushed", "0.5"))
    for scene, values in flushed.states().items():
        for name, (value, error) in values.items():
            other, stated = there[scene][name]
            assert abs(other - value) <= (error + stated) * abs(value), (scene, name)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_whether_the_trailing_edge_is_at_a_corner_is_judged_on_its_own_side(side):
    """A wedge to the left; to the right all but one, whose edge is beyond the range of double precision."""
    n, L = 1.001, 0.01

    def height(x):
        return -0.1 * x if x < 0.0 else 0.1 * L / n * (x / L) ** n

    def slope(x):
        return -0.1 if x < 0.0 else 0.1 * (x / L) ** (n - 1.0)

    state = at_depth(Profile(height, slope, kinks=(0.0,)), 1.0, 1.0, side, 1e-4)
    error = state.certificate.relative_error["trailing_edge"]
    assert state.trailing_edge == 0.0
    assert error == math.inf if side > 0.0 else error < 1e-14
