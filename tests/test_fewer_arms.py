"""Fewer arms: the bound holds, the difference is true, and what has no bound is refused (F27)."""

import re

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.fitting.fewer import Slopes, bound
from kvtheory.fitting.spectrum import Series
from kvtheory.models.steady.methods import METHODS

EXACT = METHODS["exact"]
ARMS = [(3e10 * 2.0**-k, 10.0 ** (0.3 * k - 6)) for k in range(21)]
OVER, STIFF = (1e-3, 1.0), Series(0.0, np.ones(1), np.ones(1))
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
            known = kv.GeneralizedMaxwell._of(1e10, OVER, STIFF, eps).friction_bound
            if not scene.held and np.isfinite(
                limit
            ):  # by the growth of friction with the load itself
                assert 0.3 * known < limit <= known
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


@pytest.mark.parametrize("V", [1e-9, 1e-3, 1e3])
def test_contacts_much_longer_or_shorter_than_relaxation_do_not_matter(V):
    arms = [(4.5e9, 2.4e-5), (1e9, 3.14e-3), (7.4e9, 3.3e-3), (6.5e9, 4.2e-3), (8.3e9, 4.5e-2)]
    scene = kv.Scene(foundation=kv.GeneralizedMaxwell(1e9, arms=arms))
    velocities = V * np.geomspace(0.03, 1.0, 8)
    found = kv.fewer_arms(scene, velocities=velocities, rtol=0.02)
    assert len(found.arms) < 5
    mu = [
        kv.steady(s, over={"drive.velocity": velocities}).friction_coefficient
        for s in (scene, found.scene)
    ]
    assert np.abs(mu[1] / mu[0] - 1.0).max() <= found.bound <= 0.02


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
    with pytest.raises(ValueError, match="`velocities`: expected one value or more"):
        kv.fewer_arms(kv.Scene(foundation=RUBBER), velocities=[])


def test_solve_follows_elements_with_no_more_arms_than_the_tolerance_needs():
    """A ball with 33 arms: as it is, elements would be too much work for this tolerance."""
    arms = [(3e9 * 1.6**-k, 10.0 ** (0.25 * k - 6)) for k in range(33)]
    drive = kv.Drive(history=[["0 s", "0 m/s"], ["10 ms", "0.1 m/s"]])
    rubber = kv.GeneralizedMaxwell(1e9, arms=arms)
    scene = kv.Scene(kv.Sphere("10 mm"), rubber, kv.DeadWeight(load="10 N"), drive)
    at = ["1 ms", "10 ms", "30 ms"]
    found = kv.solve(scene, at=at, rtol=0.04, quantity=["friction_force", "depth"])
    told = re.search(
        r"plus 2 times the change, .* by (\d+) arms instead of 33", found.certificate.statement
    )
    assert told
    assert int(told[1]) < 16
    whole = kv.elements(scene, per_length=found.answer.per_length, at=at, certify=False)
    assert found.friction_force == pytest.approx(whole.friction_force, rel=0.01)
    assert found.depth == pytest.approx(whole.depth, rel=0.01)
