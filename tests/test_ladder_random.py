"""The ladder on random scenes: within the tolerance, and seldom dearer than need be.

The lists of known defects are meant to empty: a request that is mended must leave its list.
"""

import functools
import signal
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results.errors import ToleranceError
from tests import SCENES
from tests import ladder_scenes as scenes

KINDS = {
    "steady": (scenes.steady_case, 20_000, 500),
    "ball": (lambda rng: scenes.steady_case(rng, ball=True), 20_000, 100),
    "other shape": (scenes.shape_case, 20_000, 12),
    "start": (scenes.start_case, 20_002, 38),
    "memory": (lambda rng: scenes.start_case(rng, memory=True), 20_000, 4),
}
"""How scenes of each kind are drawn, the first seed, and how many; the truth of the two starts before these
takes too long for a test."""
PATIENCE = 5.0
"""Seconds for the truth of one scene."""
KNOWN_WRONG: dict[str, list[int]] = {}
"""Seeds whose true error is above the tolerance."""
KNOWN_REFUSED: dict[str, list[int]] = {}
"""Seeds for which no model was known to be enough."""


@dataclass(frozen=True)
class Outcome:
    """What became of one request."""

    model: str
    within: bool
    cheapest: bool


@contextmanager
def limited():
    """Give up on an independent truth that takes too long."""

    def too_long(*_):
        raise ArithmeticError("the truth takes too long")

    before = signal.signal(signal.SIGALRM, too_long)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def outcome(kind, seed):
    """Solve one random request and hold it against the truth; None where no model would do."""
    case = KINDS[kind][0](np.random.default_rng(seed))
    try:
        found = kv.solve(case.scene, **case.request)
    except ToleranceError:
        return None
    with limited():
        within = any(
            scenes.true_error(case, found.values, found.model, truer) <= case.request["rtol"]
            for truer in (scenes.TRUER, scenes.TRUEST)
        )
        return Outcome(found.model, within, not scenes.cheaper_would_do(case, found.model))


@functools.cache
def outcomes(kind):
    """Return the outcome of each seed; the truth of some cannot be found, which is no fault of ours."""
    _, first, count = KINDS[kind]
    found = {}
    for seed in range(first, first + count * SCENES // 200):
        try:
            found[seed] = outcome(kind, seed)
        except ArithmeticError:
            continue
    assert len(found) >= 0.8 * (count * SCENES // 200)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_the_true_error_is_within_the_tolerance(kind):
    found = outcomes(kind)
    assert [seed for seed, one in found.items() if one is None] == KNOWN_REFUSED.get(kind, [])
    wrong = [seed for seed, one in found.items() if one and not one.within]
    assert wrong == KNOWN_WRONG.get(kind, [])


@pytest.mark.parametrize("kind", ["steady", "ball", "start"])
def test_no_cheaper_model_would_have_done_in_nine_of_ten(kind):
    assert np.mean([one.cheapest for one in outcomes(kind).values() if one]) >= 0.9


def test_every_model_is_used():
    models = {one.model for kind in KINDS for one in outcomes(kind).values() if one}
    assert models == {"asymptote", "exact", "quadrature", "slow manifold", "continuum"}
