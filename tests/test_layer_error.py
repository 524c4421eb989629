"""The bounds of the error of independent elements for a layer."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import kvtheory as kv
from kvtheory.layer.model_error import half_width, relative_error, spectrum, stiffening_at
from kvtheory.theory.contact_at_rest import load_at_rest
from tests.layer_error_table import (
    DEPTH,
    HALF_LENGTH,
    MODULUS,
    RADIUS,
    names,
    on_the_body,
    scene_of,
)

SCENES = [
    ("dead-weight", "line", 2.0, 0.45, [(5.0, 0.02)], 0.4),
    ("dead-weight", "line", 0.2, 0.498, [(0.8, 0.02), (3.0, 0.5)], 0.2),
    ("dead-weight", "line", 50.0, 0.2, [(20.0, 0.02), (3.0, 1e-4)], 0.5),
    ("dead-weight", "line", 0.5, 0.35, [], 1.1),
    ("dead-weight", "line", 13.2, 0.497, [(1.3, 1e-3), (1.8, 0.21), (2.5, 46.0), (0.9, 1e4)], 0.31),
    ("dead-weight", "line", 27.8, 0.12, [(34.0, 1e-3), (5.0, 0.12), (43.0, 14.0)], -0.36),
    ("dead-weight", "ball", 2.0, 0.47, [(2.5, 0.02), (2.5, 0.5)], 0.1),
    ("dead-weight", "ball", math.inf, 0.5, [(1.0, 1e-4), (2.0, 0.02), (2.0, 3.0)], 0.7),
    ("fixed", "line", 0.2, 0.498, [(5.0, 0.02)], 0.4),
    ("fixed", "line", 6.0, 0.2, [(30.0, 0.02), (3.0, 1e-4)], 0.5),
    ("fixed", "line", 43.2, 0.5, [(18.3, 0.02)], 0.57),
    ("fixed", "ball", 2.0, 0.47, [(2.5, 0.02), (2.5, 0.5)], 0.1),
    ("fixed", "ball", 0.5, 0.1, [(10.0, 0.02)], -0.2),
]
"""Support, kind, H/a, Poisson's ratio, arms and place of scenes that the map does not hold. On arms far
apart the errors have peaks where it has none."""


@pytest.mark.parametrize(("support", "kind", "h", "nu", "arms", "place"), SCENES)
def test_bounds_cover_the_layer_between_the_entries_of_the_map(support, kind, h, nu, arms, place):
    width, stiffening = spectrum(arms)
    ratio = 10 ** (place * float(half_width(width, stiffening)))
    scene, body = scene_of(support, kind, h, nu, arms)
    scene = scene.replace({"drive.velocity": ratio * float(kv.asymptotes(scene).critical_velocity)})
    found, true = kv.steady(scene), on_the_body(scene, body, scene.drive.final_velocity)
    reached = stiffening_at(arms, scene.drive.final_velocity / HALF_LENGTH)
    bounds = relative_error(kind, h, nu, ratio, width, stiffening, reached, support == "fixed")
    for name, layer, bound in zip(names(scene), true, bounds, strict=False):
        assert abs(getattr(found, name) / layer - 1.0) < bound < 3.0


def test_bounds_cover_the_depth_at_high_velocity():
    """There both are elastic: the layer with its glassy modulus, at rest under the same load."""
    rng = np.random.default_rng(4)
    for _ in range(40):
        line = bool(rng.integers(2))
        h, M = 10 ** rng.uniform(-0.9, 0.9), 10 ** rng.uniform(0.1, 2.0)
        nu = 0.5 - 10 ** rng.uniform(-4, -0.3)

        def excess(depth, h=h, nu=nu, line=line, M=M):
            """Difference of the load at a depth, with the glassy modulus, and that at rest."""
            loads = load_at_rest(
                np.array([depth, DEPTH]), RADIUS, MODULUS, h * HALF_LENGTH, nu, per_width=line
            )
            return M * loads[0] - loads[1]

        layer = brentq(excess, max(DEPTH / (2.0 * M), (h / 99.0) ** 2 * DEPTH), DEPTH)
        elements = DEPTH * M ** (-2.0 / 3.0 if line else -0.5)
        bound = relative_error("line" if line else "ball", h, nu, 1e9, 0.0, M)[1]
        assert abs(elements / layer - 1.0) < bound


def test_the_foundation_is_right_at_low_velocity():
    h, nu = np.geomspace(0.1, 100.0, 9)[:, None], np.linspace(0.0, 0.5, 6)
    for kind in ("line", "ball"):
        for bound in relative_error(kind, h, nu, 1e-6, 0.0, 6.0):
            assert bound.shape == (9, 6)
            assert np.all((bound > 0.0) & (bound < 0.1))


def test_on_arms_far_apart_the_bound_grows_with_the_stiffening_that_is_reached():
    for held in (False, True):
        bounds = [
            relative_error("ball", 9.0, 0.3, 1e-3, 5.0, 50.0, M, held) for M in (1.0, 5.0, 50.0)
        ]
        friction = [float(each[0]) for each in bounds]
        assert friction[0] < friction[1] < friction[2]
        assert bounds[2] == relative_error("ball", 9.0, 0.3, 1e-3, 5.0, 50.0, held=held)
    one = relative_error("ball", 9.0, 0.3, 1e-3, 0.0, 50.0, 1.0)
    assert one == relative_error("ball", 9.0, 0.3, 1e-3, 0.0, 50.0, 50.0)


def test_no_bound_is_claimed_where_none_is_known():
    assert np.isinf(relative_error("line", 200.0, 0.3, 1.0, 0.0, 6.0)).all()
    assert np.isinf(relative_error("ball", 1.0, 0.3, 1.0, 0.0, 1e4)).all()
    assert np.isinf(relative_error("ball", 1.0, 0.3, [1.0, 1e3], 0.0, math.inf)[0]).tolist() == [
        False,
        True,
    ]
    space = relative_error("ball", [200.0, math.inf], 0.3, 1.0, 0.0, 6.0)[0]
    assert space[0] == space[1] < 1.0
    with pytest.raises(ValueError, match=r'kind.*"cylinder".*"line" or "ball"'):
        relative_error("cylinder", 1.0, 0.3, 1.0, 0.0, 6.0)
    with pytest.raises(ValueError, match=r"poisson_ratio.*0 to 0.5"):
        relative_error("line", 1.0, 0.6, 1.0, 0.0, 6.0)
