"""Fewer arms: the bound holds, the difference is true, and what has no bound is refused (F27)."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.fitting.fewer import Slopes, bound
from kvtheory.fitting.spectrum import Series
from kvtheory.models.steady.methods import METHODS

EXACT = METHODS["exact"]
ARMS = [(3e10 * 2.0**-k, 10.0 ** (0.3 * k - 6)) for k in range(21)]
RUBBER = kv.GeneralizedMaxwell(1e10, arms=ARMS)


@pytest.mark.parametrize(
    "support", [kv.DeadWeight(mass=1000.0), kv.Fixed("0.1 mm")], ids=lambda x: x.kind
)
def test_fewer_arms_change_friction_by_less_than_the_bound(support):
    scene = kv.Scene(foundation=RUBBER, support=support)
    V = np.geomspace(1e-4, 1.0, 30)
    counts = []
    for rtol in (0.3, 0.03, 0.003):
        found = kv.fewer_arms(scene, velocities=V, rtol=rtol)
        between = kv.steady(
            scene, over={"drive.velocity": np.sqrt(V[1:] * V[:-1])}
        ).friction_coefficient
        mu = kv.steady(
            found.scene, over={"drive.velocity": np.sqrt(V[1:] * V[:-1])}
        ).friction_coefficient
        assert np.abs(mu / between - 1.0).max() <= found.bound <= rtol
        assert found.difference <= found.bound
        counts.append(len(found.arms))
    assert counts == sorted(counts)
    assert counts[0] < 16
    loose = kv.fewer_arms(scene, velocities=V, rtol=0.01, proved=False)
    assert len(loose.arms) < len(kv.fewer_arms(scene, velocities=V, rtol=0.01).arms)
    assert loose.difference <= 0.01 < loose.bound


def test_friction_of_any_series_within_the_factors_is_within_the_bound():
    """Series whose slopes differ by up to eps at all times: the arms scaled one by one."""
    rng = np.random.default_rng(0)
    V = np.geomspace(1e-4, 10.0, 12)
    worst = 0.0
    for eps in (0.01, 0.1, 0.4):
        for support in (kv.DeadWeight(mass=1000.0), kv.Fixed("0.1 mm")):
            scene = kv.Scene(foundation=RUBBER, support=support)
            limit = bound(EXACT, scene, V, eps)
            for _ in range(10):
                arms = [(K * (1.0 + eps * rng.choice([-1.0, 1.0])), tau) for K, tau in ARMS]
                other = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms), support=support)
                ratio = (
                    EXACT(other.at(V)).friction_coefficient
                    / EXACT(scene.at(V)).friction_coefficient
                )
                worst = max(worst, np.abs(ratio - 1.0).max() / limit)
    assert 0.05 < worst <= 1.0


def test_rows_of_arms_are_the_integrals_and_slopes_that_the_theorem_names():
    from scipy.integrate import quad

    K, tau, first, last = 2.0, 0.3, 0.05, 4.0
    data = Slopes.of(np.array([1.0]), np.array([1.0]), first, last)
    rows = data.kernel(np.array([tau]))[:, 0] * K

    def slope(t, K, tau):
        return K / tau * np.exp(-t / tau)

    def early(n, K, tau):
        return quad(lambda t: slope(t, K, tau) * t**n, 0.0, first, epsabs=0.0)[0]

    assert rows[3] == pytest.approx(slope(data.x[3], K, tau) / slope(data.x[3], 1.0, 1.0))
    assert rows[-3] == pytest.approx(early(1, K, tau) / early(1, 1.0, 1.0))
    assert rows[-2] == pytest.approx(early(2, K, tau) / early(2, 1.0, 1.0))
    assert rows[-1] == pytest.approx(K * np.exp(-last / tau) / np.exp(-last))
    h = 1e-6
    both = [data.kernel(np.array([tau * np.exp(side)]))[:, 0] for side in (h, -h)]
    assert data.slopes(np.array([tau]))[:, 0] == pytest.approx(
        (both[0] - both[1]) / (2 * h), rel=1e-6
    )
    assert data.deviation(Series(0.0, np.array([1.0]), np.array([1.0]))) < 1e-12


def test_a_ball_has_a_difference_and_no_bound():
    ball = kv.Scene(kv.Sphere("10 mm"), RUBBER, kv.DeadWeight(load="1 N"))
    with pytest.raises(ValueError, match="a bound is known for a parabola"):
        kv.fewer_arms(ball)
    found = kv.fewer_arms(ball, velocities=["1 mm/s", "10 mm/s"], rtol=0.01, proved=False)
    assert len(found.arms) < 12
    assert np.isnan(found.bound)
    assert found.as_dict()["bound"] is None
    with pytest.raises(ValueError, match="has no arms"):
        kv.fewer_arms(kv.Scene())
    with pytest.raises(ValueError, match="other than 0"):
        kv.fewer_arms(kv.Scene(foundation=RUBBER), velocities=[0.0, 1.0])
