"""Stability of a ball on a spring: closed forms against a numerical Jacobian of plain sums over strips."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import kvtheory as kv
from kvtheory.cli import main

NODES, WEIGHTS = np.polynomial.legendre.leggauss(400)
STEP = 1e-3


def forces(depth, rate, velocity):
    """W and F of a ball with R = 1/2, K = tau = 1, from the pressure d + d' - x^2 - 2 V x in each strip."""
    t, w = 0.25 * np.pi * (NODES + 1.0), 0.25 * np.pi * WEIGHTS
    half = np.sqrt(depth) * np.cos(t)
    level = half**2 + rate
    right = np.sqrt(level + velocity**2) - velocity
    sums = [right**n / n - (-half) ** n / n for n in range(1, 5)]
    strips = 2.0 * half * w
    load = level * sums[0] - sums[2] - 2.0 * velocity * sums[1]
    push = level * sums[1] - sums[3] - 2.0 * velocity * sums[2]
    return np.array([load @ strips, -2.0 * push @ strips])  # h' = 2 x


def polynomial(at, mass, mass_along, spring, damper, spring_along):
    """Return the coefficients of the quartic, from the highest on."""
    slopes = []
    for which in range(3):
        total = 0.0
        for factor, steps in ((-1.0, 2.0), (8.0, 1.0)):
            for side in (1.0, -1.0):
                moved = list(at)
                moved[which] += side * steps * STEP * at[0]
                total = total + side * factor * forces(*moved)
        slopes.append(total / (12.0 * STEP * at[0]))
    (z_d, x_d), (z_r, x_r), (z_v, x_v) = slopes
    across = [mass, z_r, z_d + spring]
    along = [mass_along, x_v + damper, spring_along]
    return np.polysub(np.polymul(across, along), [z_v * x_r, z_v * x_d, 0.0])


def scene_of(velocity, mass, spring, mass_along, damper, spring_along, across=0.5):
    """Return the scene of weight 1 in these units."""
    support = kv.DeadWeight(mass, 1.0 / mass)
    if spring:
        support = kv.Suspended(mass, spring, 1.0 / mass)
    drive = kv.Drive(velocity, stiffness=spring_along, damping=damper, mass=mass_along)
    return kv.Scene(kv.Sphere(0.5, across), kv.Foundation(1.0, 1.0), support, drive)


@pytest.mark.parametrize("seed", range(12))
def test_rates_are_those_of_a_numerical_jacobian(seed):
    rng = np.random.default_rng(seed)
    velocity, mass, mass_along, spring_along = 10.0 ** rng.uniform(
        [-1.5, -2, -2, -2], [1.5, 1, 1, 1]
    )
    spring, damper = rng.choice([0.0, 0.3]), rng.choice([0.0, 0.2])
    given = mass, spring, mass_along, damper, spring_along
    scene = scene_of(velocity, *given)
    found, steady = kv.stability(scene), kv.steady(scene)
    assert forces(steady.depth, 0.0, velocity)[0] == pytest.approx(steady.load, rel=1e-9)
    at = steady.depth, 0.0, velocity
    exact = np.roots(polynomial(at, mass, mass_along, spring, damper, spring_along))
    rates = found.rates[:, 0] + 1j * found.rates[:, 1]
    assert np.sort_complex(rates) == pytest.approx(np.sort_complex(exact), rel=1e-5, abs=1e-6)
    assert bool(found.stable) == bool((exact.real < 0.0).all()) == bool(steady.stable)


@pytest.mark.parametrize("velocity", [2.0, 5.0, 20.0])
def test_at_the_critical_stiffness_small_motions_neither_grow_nor_fade(velocity):
    rest = {"mass": 0.01, "spring": 0.0, "mass_along": 0.3, "damper": 0.0}
    found = kv.stability(scene_of(velocity, **rest, spring_along=1e-3))
    assert found.lower_critical_stiffness == 0.0
    at = kv.steady(scene_of(velocity, **rest, spring_along=1e-3)).depth, 0.0, velocity
    edge = polynomial(at, 0.01, 0.3, 0.0, 0.0, found.critical_stiffness)
    fastest = max(np.roots(edge), key=lambda rate: rate.real)
    assert abs(fastest.real) < 1e-6 * abs(fastest)
    assert abs(fastest.imag) == pytest.approx(2.0 * np.pi * found.frequency, rel=1e-6)
    again = kv.stability(scene_of(velocity, **rest, spring_along=0.5 * found.critical_stiffness))
    there = kv.stability(
        scene_of(again.critical_velocity, **rest, spring_along=0.5 * found.critical_stiffness)
    )
    assert there.critical_stiffness == pytest.approx(0.5 * found.critical_stiffness, rel=1e-9)


def test_a_soft_spring_is_unstable_from_the_maximum_of_friction_on():
    top = kv.asymptotes(scene_of(1.0, 0.01, 0.0, 0.3, 0.0, 1e-9)).peak_velocity
    speeds = {"drive.velocity": top * np.array([0.999, 1.001])}
    found = kv.stability(scene_of(1.0, 0.01, 0.0, 0.3, 0.0, 1e-9), over=speeds)
    assert found.stable.tolist() == [True, False]


def test_another_radius_across_and_a_held_ball():
    wide = kv.stability(scene_of(5.0, 0.02, 0.0, 0.6, 0.0, 2e-3, across=2.0))
    narrow = scene_of(5.0, 0.01, 0.0, 0.3, 0.0, 1e-3)
    half = kv.stability(  # twice as wide: twice of everything
        kv.Scene(narrow.indenter, narrow.foundation, kv.DeadWeight(0.01, 50.0), narrow.drive)
    )
    assert wide.critical_stiffness == pytest.approx(2.0 * half.critical_stiffness, rel=1e-12)
    held = kv.Scene(narrow.indenter, narrow.foundation, kv.Fixed(0.1), narrow.drive)
    assert kv.stability(held).stable
    assert kv.stability(held).rates.shape == (2, 2)


def test_the_command_names_whole_units():
    arguments = ["--set", "indenter.shape=sphere", "--set", "support.mass=1 kg"]
    shown = CliRunner().invoke(main, ["stability", *arguments])
    assert shown.exit_code == 0, shown.output
    assert "N/mm " in shown.output
    assert "N/m^2" not in shown.output
    record = json.loads(CliRunner().invoke(main, ["stability", *arguments, "--json"]).stdout)
    assert record["critical_stiffness"] > 0.0


def test_sweeps_say_whether_a_ball_slides_stably():
    ball = kv.Scene(
        indenter=kv.Sphere("10 mm"),
        support=kv.DeadWeight(mass="1 kg"),
        drive=kv.Drive(velocity="91 mm/s", stiffness="1 kN/m"),
    )
    over = {"drive.velocity": ["1 mm/s", "91 mm/s"]}
    assert kv.sweep(ball, over=over)["stable"].tolist() == [1.0, 0.0]
    assert kv.stability(ball, over=over).stable.tolist() == [True, False]
