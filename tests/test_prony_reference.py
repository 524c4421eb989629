"""The transient on a Prony series: values of an independent program, and balances of energy and impulse."""

import functools
import itertools
import json
import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.prony import evaluation as e_
from kvtheory.models.continuum.prony.energy import volume
from kvtheory.results.table import scales
from kvtheory.scene.static_state import StaticState
from tests import SCENES
from tests.prony_reference import DEPTH, LOAD, QUANTITIES, STIFFNESS, TABLE

CASES = {case["name"]: case for case in json.loads(TABLE.read_text())}
ALL = SCENES > 200
"""All scenes take a minute, on demand: KVTHEORY_TEST_SCENES=201."""
FINE = "start, fixed", "start, suspended", "stop, fixed", "reversal, fixed"
ROUGH = "start, ten arms", "ramp", "to and fro", "spring and damper", "stick-slip, fixed", "hop"
FINE_CASES = [(name, 1e-9) for name in (CASES if ALL else (*FINE, "ramp"))]
ROUGH_CASES = [(name, 1e-6) for name in (CASES if ALL else ROUGH)]
pytestmark = pytest.mark.usefixtures("interpreted")


def scene_of(case):
    supports = {
        "fixed": lambda: kv.Fixed(depth=DEPTH),
        "dead-weight": lambda: kv.DeadWeight(load=LOAD, mass=case["mass"]),
        "suspended": lambda: kv.Suspended(
            load=LOAD, mass=case["mass"], stiffness=case["stiffness"]
        ),
    }
    return kv.Scene(
        foundation=kv.GeneralizedMaxwell(STIFFNESS, arms=case["arms"]),
        support=supports[case["support"]](),
        drive=kv.Drive(history=case["history"], **case["drive"]),
        run=kv.Run(duration=case["time"][-1]),
    )


@functools.cache
def solved(name, rtol):
    return kv.transient(
        scene_of(CASES[name]), at=CASES[name]["time"], rtol=rtol, certify=rtol < 1e-8
    )


def apart(found, case):
    """Return for each quantity the difference from the table, and the error of the table in SI."""
    edges = np.sort([found.leading_edge, found.trailing_edge], axis=0)
    values = {"left_edge": edges[0], "right_edge": edges[1]}
    for name, error in zip(QUANTITIES, case["errors"], strict=True):
        other = np.array(case[name], dtype=float)
        own = values.get(name, getattr(found, name, None))
        assert (np.isnan(own) == np.isnan(other)).all()
        yield name.replace("left", "leading").replace("right", "leading"), own - other, error


@pytest.mark.parametrize(("name", "rtol"), FINE_CASES)
def test_values_agree_with_an_independent_program(name, rtol):
    """To 1e-8 of the state at rest, and within the certificate and the error of the table."""
    found, case = solved(name, rtol), CASES[name]
    measures, certified = scales(StaticState.of(scene_of(case))), found.certificate.relative_error
    for quantity, difference, error in apart(found, case):
        largest = float(np.nanmax(np.abs(difference))) / measures[quantity]
        assert largest <= 1e-8 + error
        assert largest <= certified[quantity] + 2.0 * error + 1e-12
        assert certified[quantity] <= 1e-6


@pytest.mark.parametrize(("name", "rtol"), ROUGH_CASES + FINE_CASES)
def test_both_balances_close(name, rtol):
    """Ledger and impulse take stresses and compressions from the memory, the forces from the moments."""
    found = solved(name, rtol)
    books = found.energy([0.0, *CASES[name]["time"]])
    assert np.abs(books.balance / (books.stored_at_rest + np.abs(books.work))).max() <= 2.0 * rtol
    assert books.stored_surface[-1] > 0.0
    assert impulse(found.solution.motion) <= 2.0 * rtol


def impulse(motion):
    """Return how far U = int u dxi over the surface is from that of one element with the pressure 4/3 f_z.

    U + sum S_i = 4/3 f_z = f, S_i' = k_i U' - S_i/T_i, so S = k f/(1 + sum k) + R, R' = A S, A as for a
    free element. The modes of R are integrated on panels that double from the end of a step backwards.
    """
    k, T = motion.run.arms[:, :2].T
    glass, ratio = 1.0 + k.sum(), np.sqrt(k / T)
    rates, modes = np.linalg.eigh(np.outer(ratio, ratio) / glass - np.diag(1.0 / T))
    gain, out = rates * (modes.T @ ratio) / glass, np.sqrt(k * T) @ modes
    x, weights = (np.polynomial.legendre.leggauss(12) + np.array([[1.0], [0.0]])) * 0.5
    force = lambda s: motion.states(s, peaks=False)[e_.NORMAL_FORCE] * 4.0 / 3.0  # noqa: E731
    ends = np.append(motion.steps["start"], motion.counts.s)
    R, worst, seldom = -gain / rates * force([0.0]), 0.0, max(len(ends) // 6, 1)
    for n, (start, end) in enumerate(itertools.pairwise(ends), 1):
        halvings = max(math.ceil(math.log2(-rates.min() * (end - start))), 0) + 2
        cuts = end - (end - start) * np.append(0.5 ** np.arange(halvings), 0.0)
        t = (cuts[:-1, None] + np.diff(cuts)[:, None] * x).reshape(-1)
        fade = np.exp(rates[:, None] * (end - t)) * np.outer(np.diff(cuts), weights).reshape(-1)
        R = R * np.exp(rates * (end - start)) + gain * (fade @ force(t))
        if n % seldom == 0 or n == len(ends) - 1:
            U = force([end])[0] / glass - out @ R
            worst = max(worst, abs(U - volume(motion, end)))
    return worst / (4.0 / 3.0)


def test_entries_are_the_energies_they_are_called():
    """On one arm s = p - K u in the contact, and s = -K u behind it."""
    found, (K, K_1) = solved("stop, fixed", 1e-9), (STIFFNESS, 5e10)
    for time in found.time[2:3]:
        books, x = found.energy(float(time)), np.linspace(-2e-3, 3e-3, 501)
        u, p = found.surface(x, float(time)), found.pressure(x, float(time))
        inside = p > 0.0
        density = 0.5 * K * u**2 + 0.5 * (p - K * u) ** 2 / K_1
        assert np.trapezoid(density * inside, x) == pytest.approx(books.stored_contact, rel=5e-3)
        assert np.trapezoid(density, x) == pytest.approx(
            books.stored_contact + books.stored_surface, rel=2e-4
        )


def test_a_fast_arm_has_the_ledger_of_kelvin_voigt():
    drive, run = kv.Drive(velocity=0.05), kv.Run(duration=0.03)
    kelvin_voigt = kv.Foundation(stiffness=1e10, retardation_time=0.02)
    fast = kv.GeneralizedMaxwell(1e10, arms=[(2e8 / 2e-6, 2e-6)])
    one, other = (
        kv.transient(kv.Scene(foundation=f, drive=drive, run=run), rtol=1e-6, certify=False).energy(
            0.03
        )
        for f in (kelvin_voigt, fast)
    )
    for name in (
        "work",
        "stored_contact",
        "stored_surface",
        "dissipated_contact",
        "dissipated_surface",
    ):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-3)
    assert abs(other.balance) <= 1e-9 * other.stored_at_rest
