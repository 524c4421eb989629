"""The error that `kv.elements` claims, held against theory on random scenes, and where it used to fail."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.elements.kernels import straight, touching
from kvtheory.models.elements.model import Model
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.results.table import scales

LOAD = 4.0 / 3.0
COMPARED = [name for name in TRANSIENT_UNITS if name not in ("time", "velocity")]
LEAST = 1e-9
"""Relative: below it the theory is not known well enough."""


def supports(rng):
    epsilon, kappa = 10.0 ** rng.uniform([-4.0, -1.5], [1.0, 1.5])
    mass, gravity = LOAD * epsilon, 1.0 / epsilon
    return [
        kv.Fixed(1.0),
        kv.DeadWeight(mass, gravity),
        kv.Suspended(mass, kappa * LOAD, gravity),
    ]


def histories(rng, end, top):
    """Return drives with stops, reversals and ramps, in units of the retardation time."""
    a, b = np.sort(rng.uniform(0.1, 0.8, 2)) * end
    back = -top * rng.uniform(0.1, 1.5)
    return [
        [(0.0, top)],
        [(0.0, top), (a, top), (a, 0.0)],
        [(0.0, top), (a, top), (a, back)],
        [(0.0, top), (a, top), (a, 0.0), (b, 0.0), (b, top)],
        [(0.0, 0.0), (a, top), (b, top), (end, -top)],
    ]


def drawn(seed):
    """Return a scene in scaled form, instants, and elements in a static half length."""
    rng = np.random.default_rng(seed)
    end, top = 10.0 ** rng.uniform([-0.7, -1.5], [0.5, 1.3]) * [1.0, rng.choice([-1.0, 1.0])]
    support = supports(rng)[rng.integers(3)]
    history = histories(rng, end, top)[rng.integers(5)]
    times = np.sort(rng.uniform(0.0, end, rng.integers(2, 30)))
    drive = kv.Drive(history=[(float(t), float(V)) for t, V in history])
    scene = kv.Scene(kv.Parabola(0.5), kv.Foundation(1.0, 1.0), support, drive, kv.Run(float(end)))
    return scene, times, 10.0 ** rng.uniform(0.9, 2.0)


def errors(run, theory, scene):
    """Return the largest error of each quantity by its scale, the edges from left to right."""
    scale = scales(Model.of(scene, 1.0 / run.per_length).at_rest)
    edges = np.array([theory.leading_edge, theory.trailing_edge])
    first = run.leading_edge < run.trailing_edge
    expected = {name: getattr(theory, name) for name in COMPARED}
    low, high = np.fmin(*edges), np.fmax(*edges)
    expected["leading_edge"] = np.where(first, low, high)
    expected["trailing_edge"] = np.where(first, high, low)
    return {
        name: np.nanmax(np.abs(getattr(run, name) - expected[name]), initial=0.0) / scale[name]
        for name in COMPARED
    }


@pytest.mark.parametrize("first", range(0, 80, 20))
def test_the_certificate_covers_the_error_on_random_scenes(first):
    for seed in range(first, first + 20):
        scene, times, density = drawn(seed)
        run = kv.elements(scene, per_length=density, at=times)
        theory = kv.transient(scene, at=times, rtol=1e-9)
        claimed = run.certificate.relative_error
        for name, error in errors(run, theory, scene).items():
            assert error <= max(claimed[name], LEAST), (seed, name)


@pytest.mark.parametrize("seed", range(24))
def test_the_certificate_covers_the_error_under_a_drive_that_is_a_function(seed):
    """A swinging drive leaves pressure on an edge, as a jump does."""
    plain, times, density = drawn(seed)
    rng = np.random.default_rng(seed)
    mean, rate = rng.uniform(-1.5, 1.5), 10.0 ** rng.uniform(-0.3, 1.2)
    drive = kv.Drive(function=lambda t: 3.0 * (mean + math.sin(rate * t)))
    scene = replace(plain, drive=drive)
    run = kv.elements(scene, per_length=density, at=times)
    theory = kv.transient(scene, at=times, rtol=1e-9)
    for name, error in errors(run, theory, scene).items():
        assert error <= max(run.certificate.relative_error[name], LEAST), name


@pytest.mark.parametrize("density", [8.0, 11.7, 40.0])
@pytest.mark.parametrize("support", ["fixed", "dead-weight"])
def test_a_start_so_slow_that_elements_hardly_move_is_certified_too(density, support):
    """The leading edge then presses less than an element farther out, and yet it touches."""
    mass = LOAD * 5.0
    held = kv.Fixed(1.0) if support == "fixed" else kv.DeadWeight(mass, LOAD / mass)
    for V in (0.01, -0.03, 0.06):
        scene = kv.Scene(kv.Parabola(0.5), kv.Foundation(1.0, 1.0), held, kv.Drive(V), kv.Run(0.5))
        times = np.linspace(0.0, 0.5, 7)
        run = kv.elements(scene, per_length=density, at=times)
        theory = kv.transient(scene, at=times, rtol=1e-9)
        found = errors(run, theory, scene)
        assert found["leading_edge"] * density < 0.1  # of an element
        for name, error in found.items():
            assert error <= max(run.certificate.relative_error[name], LEAST), (V, name)


@pytest.mark.parametrize("per_length", ["8 /mm", "16 /mm", "13.7 /mm"])
def test_the_peak_is_that_of_the_pressure_and_not_of_the_nearest_element(per_length):
    """Fixed: theory gives the peak exactly, and the coarse run has it at the same node."""
    scene = kv.Scene(support=kv.Fixed(3e-4), drive=kv.Drive(5e-3), run=kv.Run(0.02))
    run = kv.elements(scene, per_length=per_length, at=[0.01])
    assert run.peak_pressure == pytest.approx(kv.steady(scene).peak_pressure, rel=1e-12)
    assert min(run.certificate.relative_error.values()) > 0.0


def test_the_peak_under_a_tip_is_known_to_the_next_element():
    """The pressure jumps there, and no element is where it is highest."""
    for V in (0.02, 0.05):
        scene = kv.Scene(kv.Wedge(0.1), support=kv.Fixed(3e-4), drive=kv.Drive(V), run=kv.Run(0.05))
        peak = kv.steady(scene, method="quadrature").peak_pressure
        run = kv.elements(scene, per_length="21.3 /mm", at=[0.0493, 0.05])
        difference = np.abs(run.peak_pressure - peak).max() / (1e10 * 3e-4)
        assert 0.0 < difference <= run.certificate.relative_error["peak_pressure"] < 0.5


def test_friction_is_certified_relative_to_what_the_statement_says():
    """A deep contact: W_0 delta_0/a_0, to which friction is relative, is twelve times W_0."""
    scene = kv.Scene(
        kv.Parabola(0.46e-3), kv.Foundation(0.48e9, 52.0), kv.Suspended(109e3, 14e6),
        kv.Drive(2.27e-3), kv.Run(51.0),
    )  # fmt: skip
    times = [0.051, 0.1, 0.25]
    run = kv.elements(scene, per_length="100 /mm", at=times)
    at_rest = Model.of(scene, 1.0 / run.per_length).at_rest
    assert "friction force to W_0 δ_0/a_0" in run.certificate.statement
    measure = at_rest.load * at_rest.depth / at_rest.half_length
    assert measure == pytest.approx(12.5 * at_rest.load, rel=0.01)
    theory = kv.transient(scene, at=times, rtol=1e-9)
    difference = np.abs(run.friction_force - theory.friction_force).max()
    assert difference <= run.certificate.relative_error["friction_force"] * measure


def test_without_a_certificate_it_says_so():
    certificate = kv.elements(at=0.01, certify=False).certificate
    assert certificate.kind == "none"
    assert not certificate.relative_error
    assert "inf" not in repr(certificate)


def test_where_an_edge_is_between_two_elements():
    """On free ground w falls in a straight line; where contact peeled off, as a square."""
    x = np.arange(8.0)
    for place in (3.1, 3.5, 3.9):
        line = 2.0 * (place - x)
        assert 1.0 - touching(line[4:7]) == pytest.approx(place - 3.0)
        assert straight(line[4:7])
        square = -((x - place) ** 2)
        assert not straight(square[4:7])
        curved = (place - x) * (4.0 + x)
        assert 1.0 - touching(curved[4:7]) == pytest.approx(place - 3.0)
