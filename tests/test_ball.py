"""The ball: closed forms against ball arithmetic, units, asymptotes, identities."""

import numpy as np
import pytest

from kvtheory.models.steady import ball
from kvtheory.results import STEADY_UNITS
from tests import reference_ball
from tests.reference import relative_error

EPS = np.finfo(float).eps
SCENES = 700
"""Random scenes for each support."""


def random_scenes(count, seed):
    """R, R'/R, K, tau, V, W over many decades, V tau/a_0 over 24 of them."""
    rng = np.random.default_rng(seed)
    R, K, tau, W = 10.0 ** rng.uniform([[-6], [3], [-6], [-6]], [[3], [15], [3], [9]], (4, count))
    across = R * 10.0 ** rng.uniform(-2, 2, count)
    number = 10.0 ** rng.uniform(-12, 12, count)
    number[::3] = 10.0 ** rng.uniform(-1, 1, number[::3].size)  # where T changes its form
    a_0 = (4 * R * R * (W / (np.pi * K * np.sqrt(R * across)))) ** 0.25
    V = number / tau * a_0 * rng.choice([-1.0, 1.0], count)
    return R, across, K, tau, V, W


def depths(R, across, K, W):
    return np.sqrt(W / (np.pi * K * np.sqrt(R * across)))


SUPPORTS = {
    "fixed": lambda R, S, K, W, rng: (depths(R, S, K, W),),
    "dead-weight": lambda R, S, K, W, rng: (W,),
    "suspended": lambda R, S, K, W, rng: (W, W / depths(R, S, K, W) * 10 ** rng.uniform(-9, 9, W.size)),
}  # fmt: skip


@pytest.mark.parametrize("support", SUPPORTS)
def test_error_stays_below_the_certificate(support):
    R, S, K, tau, V, W = random_scenes(SCENES, seed=20)
    extra = SUPPORTS[support](R, S, K, W, np.random.default_rng(15))
    method = "at_depth" if support == "fixed" else "at_load"
    state = getattr(ball, method)(R, np.sqrt(S / R), K, tau, V, *extra)
    worst = dict.fromkeys(STEADY_UNITS, 0.0)
    for i, scene in enumerate(zip(*(x.tolist() for x in (R, S, K, tau, V, *extra)), strict=True)):
        truth = getattr(reference_ball, method)(*scene)
        for name in worst:
            worst[name] = max(
                worst[name], relative_error(float(getattr(state, name)[i]), truth[name])
            )
    print({name: f"{error / EPS:.1f} eps" for name, error in worst.items()})
    for name, error in worst.items():
        assert error <= ball.CERTIFICATE.relative_error[name] < 1e-14, name
