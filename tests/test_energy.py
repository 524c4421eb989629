"""The balance laws (fact F14): impulse, and the energy ledger, its entries and shares in steady sliding."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.energy import ledger
from kvtheory.models.continuum.solved_scene import force_maxima
from kvtheory.models.continuum.solver import solve
from kvtheory.models.continuum.surface import height, volume
from kvtheory.scene.base_motion import BaseMotion
from tests import SCENES
from tests.spring_random import solved
from tests.test_transient_random import KNOWN_FAILURES, random_case
from tests.test_transient_reference import SCENES as REFERENCES

RTOL, BALANCE, CHECKS = 1e-10, 1e-9, 6
"""Of each law, relative to what it sums up, at so many times."""
X, WEIGHTS = (np.polynomial.legendre.leggauss(12) + np.array([[1.0], [0.0]])) / 2
END = 2.0
STOP_AND_GO = [(0, 4), (0.3, 4), (0.3, 0), (0.6, 0), (0.6, 4), (0.9, 4), (0.9, 0.5)]
REVERSAL = [(0, 4), (0.5, 4), (0.5, -4)]
HISTORIES = {
    "start": ([(0, 4)], 0.003, 0.0),
    "stop": ([(0, 4), (0.5, 4), (0.5, 0)], 0.04, 0.0),
    "stiff stop": ([(0, 4), (0.5, 4), (0.5, 0)], 1e-5, 0.0),
    "slow-down": ([(0, 4), (0.5, 4), (1.0, 1)], 0.04, 0.0),
    "reversal": (REVERSAL, 0.04, 0.5),
    "there and back": ([(0, 0), (0.5, 4), (1.5, -4), (2.0, 3)], 0.2, 0.0),
    "heavy": ([(0, 0.3), (1.0, 0.3), (1.0, 0)], 300.0, 0.0),
    "hop": ([(0, 7.1)], 0.078, 0.12),
    "hops": ([(0, 2.0), (0.3, 8.0), (0.3, -5), (1.0, 0), (1.0, 9)], 0.2, 0.04),
    "stop-and-go": (STOP_AND_GO, 0.04, 0.0),
    "suspended": (STOP_AND_GO, 1.0, 0.5),
    "fixed": (STOP_AND_GO, 1.0, math.inf),
    "fixed reversal": (REVERSAL, 1.0, math.inf),
}


for kappa in (0.0, 0.5, math.inf):
    HISTORIES[f"oscillation, kappa {kappa}"] = (
        lambda s: 2 * math.sin(5 * s) + 1.5 * math.sin(13.7 * s), 0.04, kappa,
    )  # fmt: skip
    HISTORIES[f"one step sweeps much ground, kappa {kappa}"] = (
        [(0, 0), (0.4, 3000), (1.0, -2000), (1.1, -2000), (1.4, 0)], 0.04, kappa,
    )  # fmt: skip


def drive_of(name):
    drive = HISTORIES[name][0]
    return (BaseMotion.from_function if callable(drive) else BaseMotion.from_points)(drive, END)


def of(name, rtol=1e-10):
    """Return the drive and the motion of a history."""
    given = drive_of(name)
    return given, solve(given, *HISTORIES[name][1:], END, rtol)


def impulse(motion):
    """Return how far U = U_0 e^-s + 4/3 int e^(t - s) f_z dt is from the volume, at the worst.

    At the ends of a step f_z may be a square root of t: t = a + (b - a) x^2 (3 - 2 x), on two panels of x.
    """
    checked = {*np.linspace(1, len(motion.starts), CHECKS).astype(int).tolist()}
    x = np.concatenate([X / 2, 0.5 + X / 2])
    weights = np.tile(WEIGHTS / 2, 2) * 6 * x * (1 - x)
    low, high = np.array([*itertools.pairwise([*motion.starts, motion.end])]).T[..., None]
    t = np.minimum(low + (high - low) * x * x * (3 - 2 * x), high)
    f_z = motion.states(t.reshape(-1))["normal_force"].reshape(t.shape)
    gains = 4 / 3 * ((high - low) * np.exp(t - high) * f_z) @ weights
    U = scale = 4 / 3
    worst = 0.0
    for step, (a, b, gain) in enumerate(zip(low[:, 0], high[:, 0], gains, strict=True), 1):
        U, scale = U * math.exp(a - b) + gain, scale + gain
        if step in checked:
            worst = max(worst, abs(volume(motion, b) - U) / scale)
    return worst


def unbalanced(motion):
    """Return how far the impulse balance and the ledger are from closing, at the worst."""
    starts = motion.starts[:: max(1, len(motion.starts) // CHECKS)]  # at jumps and landings, too
    books = ledger(motion, [*np.linspace(0.0, motion.end, CHECKS), *starts])
    scale = 1 + np.abs(books.work) + np.abs(books.potential_weight) + books.potential_spring
    return float(np.max([impulse(motion), *np.abs(books.balance) / scale]))


@pytest.mark.parametrize("name", [*REFERENCES, *HISTORIES])
def test_both_laws_hold_in_each_scene_of_the_tables(name):
    motion = of(name)[1] if name in HISTORIES else solved(REFERENCES[name], RTOL)
    assert unbalanced(motion) <= BALANCE


def test_both_laws_hold_in_each_random_scene():
    worst = {}
    for seed in set(range(SCENES // 5)) - KNOWN_FAILURES.keys():
        case = random_case(seed, 1)
        worst[seed] = unbalanced(solve(case.drive, case.eps, case.kappa, case.drive.end, RTOL))
    assert {seed: value for seed, value in worst.items() if not value <= BALANCE} == {}


@pytest.mark.parametrize("name", ["stiff stop", "reversal", "hops", "fixed reversal"])
def test_entries_are_the_energies_they_are_called(name):
    (_, eps, kappa), (_, motion) = HISTORIES[name], of(name)
    xi = np.linspace(-12, 14, 100_001)
    for s in (0.35, 0.8, 1.3):
        books, now = ledger(motion, s), motion.at(s)
        stored = 0.375 * height(motion, xi, s) ** 2
        under = (now.left <= xi) & (xi <= now.right)
        total = np.trapezoid(stored, xi)
        assert books.stored_surface > 0.0
        assert books.stored_contact + books.stored_surface == pytest.approx(total, abs=2e-7)
        assert books.stored_contact == pytest.approx(np.trapezoid(stored * under, xi), abs=2e-4)
    if kappa < math.inf:
        moving = books.kinetic + books.potential_weight + books.potential_spring
        expected = 0.5 * eps * now.rate**2 + (1 - now.depth) + 0.5 * kappa * (1 - now.depth) ** 2
        assert moving == pytest.approx(expected, rel=1e-14)


def test_behind_the_contact_twice_what_is_stored_is_dissipated():
    _, motion = of("reversal")
    low, high = ledger(motion, 0.9), ledger(motion, 0.9002)
    rate = (high.dissipated_surface - low.dissipated_surface) / 2e-4
    assert rate == pytest.approx(low.stored_surface + high.stored_surface, rel=1e-6)


@pytest.mark.parametrize("number", [0.1, 0.75, 4.0])
def test_shares_of_steady_sliding(number):
    """Fact F6: the share 4 (q^2 - q + 1)/(q^2 - q + 4) is dissipated inside the contact."""
    motion = solve(BaseMotion.constant(number, 22.0), 1.0, math.inf, 22.0, 1e-10)
    q = motion.at(1.0).right
    low, high = ledger(motion, 20.0), ledger(motion, 22.0)
    work = high.work - low.work
    inside = (high.dissipated_contact - low.dissipated_contact) / work
    assert inside == pytest.approx(4 * (q * q - q + 1) / (q * q - q + 4), rel=1e-12)
    assert inside + (high.dissipated_surface - low.dissipated_surface) / work == pytest.approx(1.0)


def test_ledger_in_joules():
    result = kv.transient(rtol=1e-9)
    books = result.energy(result.time)
    F_x, time = result.friction_force, result.time
    late = time >= 0.05
    work = books.work[late][-1] - books.work[late][0]
    assert work == pytest.approx(np.trapezoid(0.1 * F_x[late], time[late]), rel=1e-4)
    assert books.kinetic == pytest.approx(0.5 * 1000.0 * result.depth_rate**2, abs=1e-15)
    depth = result.depth - result.depth[0]
    assert books.potential_weight == pytest.approx(-9806.65 * depth, abs=1e-12)
    assert np.abs(books.balance).max() <= 1e-8 * books.stored_at_rest[0]
    with pytest.raises(ValueError, match="`time`"):
        result.energy([0.1, 0.3])


def maxima(scene):
    events = kv.transient(scene, rtol=1e-10).events
    assert [event.time for event in events] == sorted(event.time for event in events)
    kinds = ("normal force maximum", "friction force maximum")
    return [event.time for kind in kinds for event in events if event.kind == kind]


def test_the_largest_forces_of_a_start_are_at_once():
    for support in ("fixed", "dead-weight", "suspended"):
        assert maxima(kv.Scene.table1(support)) == [0.0, 0.0]
        for foundation in (kv.Foundation(1e10, 0.1), kv.GeneralizedMaxwell(1e10, [(1e9, 0.1)])):
            still = dataclasses.replace(
                kv.Scene.table1(support), foundation=foundation, drive=kv.Drive(0.0)
            )
            assert not maxima(still)


def test_the_largest_friction_before_a_jump():
    """A fixed indenter: with the velocity the friction rises, then the drive stops or turns."""
    for last in ("0 m/s", "-50 mm/s"):
        drive = kv.Drive(history=[("0 s", "0 m/s"), ("50 ms", "0.1 m/s"), ("50 ms", last)])
        scene = kv.Scene(support=kv.Scene.table1("fixed").support, drive=drive)
        assert maxima(scene) == pytest.approx([0.05, 0.05], abs=1e-15)


def test_the_largest_forces_within_a_step():
    fixed = solve(BaseMotion.from_function(lambda s: 2 * math.sin(5 * s), END), 1.0, math.inf, END)
    assert force_maxima(fixed) == pytest.approx((math.pi / 10,) * 2, abs=1e-11)


@pytest.mark.parametrize("name", ["there and back", "hops"])
def test_forces_are_stationary_at_their_maxima(name):
    _, motion = of(name, 1e-12)
    grid = [motion.at(s) for s in np.linspace(0, END, 2001)]
    for k, s in enumerate(force_maxima(motion)):
        force = lambda moment, k=k: abs(moment[-2 + k])  # noqa: E731
        low, at, high = (force(motion.at(s + step)) for step in (-1e-4, 0.0, 1e-4))
        assert at >= max(map(force, grid))
        assert abs(high - low) / 2e-4 <= 1e-3 * (2 * at - low - high) / 1e-8


def test_the_maxima_lie_within_the_run():
    """The ends of steps, put together again from their parts, may lie beyond the run by rounding."""
    given = BaseMotion.constant(2.9076177602310533, 0.48166010429977285)
    motion = solve(given, 2.0784278908362998e-05, 0.0, given.end, 9.170774506742931e-05)
    assert force_maxima(motion) == (0.0, 0.0)


@pytest.mark.parametrize("foundation", [None, kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)])])
def test_times_and_places_are_read_as_everywhere(foundation):
    own = {} if foundation is None else {"foundation": foundation}
    run = kv.transient(kv.Scene(**own, run=kv.Run(5e-3)), certify=False)
    assert run.energy("2 ms").work == run.energy(0.002).work > 0.0
    for several in ("1 ms,2 ms", ["1 ms", 0.002], "1 ms:2 ms:2", np.array([0.001, 0.002])):
        assert run.energy(several).work.tolist() == run.energy([0.001, 0.002]).work.tolist()
    assert run.pressure("-1 mm", "2 ms") == run.pressure(-1e-3, 0.002) > 0.0
    for far in (np.inf, -np.inf, 1e200):
        assert run.surface(far, "2 ms") == run.pressure(far, "2 ms") == 0.0
    for time in ([0.001, 0.002], "1 ms,2 ms"):
        with pytest.raises(kv.SceneError, match=r"`time` = .*expected one time"):
            run.surface(0.0, time)
    for call in (run.energy, lambda time: run.pressure(0.0, time)):
        with pytest.raises(kv.SceneError, match=r"`time` = .*masked"):
            call(np.ma.masked_array(0.001, mask=True))
        with pytest.raises(ValueError, match=r"`time` must lie in \[0, 0.005\] s"):
            call("6 ms")
    with pytest.raises(kv.SceneError, match=r"`x` = nan: holds what is not a number"):
        run.surface(np.nan, 0.0)
