"""The ladder: what it chooses and why, its bounds, and how it says that nothing is enough."""

import functools
import json
import math
import re
import signal
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.ladder import climbing
from kvtheory.models.slow_manifold.start import half_length
from kvtheory.models.steady import asymptote_bounds as asymptote
from kvtheory.models.steady import ball, exact, power_law
from kvtheory.results import STEADY_UNITS, TRANSIENT_UNITS
from kvtheory.results.errors import ToleranceError
from tests import SCENES, commands
from tests import ladder_scenes as scenes
from tests.ladder_scenes import enclosed
from tests.reference import relative_error
from tests.spring_random import of_unit_scales

NUMBERS = np.concatenate([[0.0], np.geomspace(1e-9, 1e9, 73)])
SUPPORT_NUMBERS = (0.0, 1e-3, 1.0, 1e3)


def on_power_laws(numbers, kappas, n):
    return power_law.scaled_root(np.full_like(numbers, n), numbers, kappas)[0]


ROOTS = {
    "parabola": (asymptote.PARABOLA, exact.scaled_root),
    "ball": (asymptote.BALL, ball.scaled_root),
    **{f"n = {n:g}": (asymptote.line(n), partial(on_power_laws, n=n)) for n in (1.0, 1.2, 4.0)},
}
"""Shapes, and the closed forms or roots of their half length."""


@pytest.mark.parametrize("name", ROOTS)
@pytest.mark.parametrize("kappa", SUPPORT_NUMBERS)
def test_the_half_length_is_enclosed(kappa, name):
    shape, roots = ROOTS[name]
    for number, root in zip(
        NUMBERS.tolist(), roots(NUMBERS, np.full_like(NUMBERS, kappa)).tolist(), strict=True
    ):
        found = asymptote.enclose(shape, number, kappa)
        assert found.low * (1 - 2e-15) <= root <= found.high * (1 + 2e-15)
        assert found.high / found.low <= 1.0 + 2e-6
        if name == "parabola":
            assert half_length(number, kappa) == pytest.approx(root, rel=1e-14)


def shaped(name, kappa, drive):
    """Return a scene of a shape of `ROOTS`, of unit scales for a parabola and a ball."""
    scene = of_unit_scales(1.0, kappa, drive, ball=name == "ball")
    n = ROOTS[name][0].exponent
    if n == 2.0:
        return scene
    return replace(scene, indenter=kv.Wedge(0.5) if n == 1.0 else kv.PowerLaw(0.5, n))


@pytest.mark.parametrize("name", ROOTS)
@pytest.mark.parametrize("kappa", [*SUPPORT_NUMBERS, math.inf])
def test_each_bound_covers_the_error_of_its_asymptote_and_is_not_far_above(kappa, name):
    """Held against ball arithmetic."""
    far = []
    for number in NUMBERS.tolist():
        scene = shaped(name, kappa, kv.Drive(number))
        exact, bounds = enclosed(scene), asymptote.enclosure_of(scene)
        for regime in ("low", "high"):
            if regime == "high" and number == 0.0:
                continue
            claimed = asymptote.errors(bounds, regime, tuple(STEADY_UNITS))
            for quantity, value in asymptote.values(scene, regime, tuple(STEADY_UNITS)).items():
                error, bound = relative_error(value, exact[quantity]), claimed[quantity]
                assert error <= bound * (1.0 + 1e-12), (quantity, regime, number)
                if 1e-8 < error < 0.3:
                    far.append(bound / error)
    assert np.median(far) < 1.2
    assert np.quantile(far, 0.95) < 2.0


def test_the_better_regime_is_chosen_where_both_are_near():
    """At 20 half lengths in the retardation time, on a spring ten times as stiff as the contact."""
    bounds = asymptote.enclose(asymptote.PARABOLA, 20.0, 10.0)
    wrong = {
        regime: asymptote.errors(bounds, regime, ("friction_coefficient",))["friction_coefficient"]
        for regime in ("low", "high")
    }
    assert wrong["high"] < 0.4 < wrong["low"]
    chosen = asymptote.choose(bounds, ("friction_coefficient",), 1e-2)
    assert chosen == ("high", wrong["high"])


BALL = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"), drive=kv.Drive("-1 um/s"))
FIXED, CIRCLE, RESTING = (
    kv.Scene.table1("fixed"),
    kv.Scene(kv.Circle(0.01)),
    kv.Scene(drive=kv.Drive(0.0)),
)
CHOICES = [
    *((kv.Scene(drive=kv.Drive(side * velocity)), "friction_coefficient", rtol, model)
      for side in (1.0, -1.0)
      for velocity, rtol, model in ((1e-4, 1e-2, "asymptote"), (1e-4, 1e-4, "exact"),
                                    (10.0, 1e-2, "asymptote"), (0.1, 0.01, "exact"))),
    (BALL, "friction_coefficient", 1e-4, "asymptote"), (BALL, "friction_coefficient", 1e-6, "exact"),
    (FIXED, "depth", 1e-12, "asymptote"), (FIXED, "friction_force", 1e-12, "exact"),
    (RESTING, "friction_force", 1e-14, "asymptote"), (RESTING, "depth", 1e-14, "asymptote"),
    (CIRCLE, "load", 1e-8, "quadrature"),
    *((kv.Scene(shape, support=support, drive=kv.Drive(V)), name, rtol, model)
      for shape in (kv.Wedge(0.1), kv.PowerLaw(0.01, 1.2), kv.PowerLaw(0.01, 8.5))
      for support in (kv.Fixed(1e-4), kv.DeadWeight(mass="1 kg/mm"), kv.Suspended(1000.0, 1e7))
      for V, name, rtol, model in ((0.05, "dissipated_in_contact", 1e-12, "exact"),
                                   (-1e-6, "friction_force", 0.02, "asymptote"),
                                   (1e-6, "dissipated_in_contact", 0.02, "asymptote"),
                                   (1e6, "friction_coefficient", 0.02, "asymptote"))),
    (kv.Scene(kv.Wedge(0.1), drive=kv.Drive(1.0)), "trailing_edge", 1e-14, "asymptote"),
]  # fmt: skip
"""The depth of a fixed indenter is known at every velocity; at rest the asymptote is exact."""


@pytest.mark.parametrize(("scene", "name", "rtol", "model"), CHOICES)
def test_the_cheapest_steady_model_is_chosen(scene, name, rtol, model):
    found = kv.solve(scene, quantity=name, rtol=rtol)
    assert found.model == model
    truth = getattr(kv.steady(scene, method="quadrature"), name)
    assert getattr(found, name) == pytest.approx(truth, rel=max(rtol, 1e-12))
    assert found.certificate.kind == ("proved" if model == "asymptote" else "estimated")
    names = [step.rung for step in found.climb]
    assert names == ["asymptote", "exact", "quadrature"][: len(names)]
    assert found.climb[-1].outcome == "used"
    assert all(step.outcome != "used" for step in found.climb[:-1])


def test_the_reasons_of_a_choice_are_told():
    assert "holds for the parabola" in kv.solve(CIRCLE, rtol=1e-8).climb[0].outcome
    arms = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"]])
    assert "kelvin-voigt" in kv.solve(replace(BALL, foundation=arms)).climb[0].outcome
    springpot = kv.Scene(foundation=kv.FractionalKelvinVoigt(1e10, 0.1, 0.5))
    with pytest.raises(ToleranceError, match=r"holds for foundation\.kind"):
        kv.solve(springpot, at=["1 ms"])
    everything = kv.solve(FIXED)
    assert everything.climb[0].outcome == "error too large"
    assert list(everything.values) == list(STEADY_UNITS)
    assert everything.trailing_edge == kv.steady(FIXED).trailing_edge


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        ({"rtol": 1e-14}, [r"rtol = 1e-14; try a tolerance from \d.\de-1", "quadrature: error too large"]),
        ({"at": "1 ms", "rtol": 1e-9}, ["slow manifold, continuum: holds for the parabola only"]),
    ],
)  # fmt: skip
def test_a_tolerance_that_nothing_meets_says_how_close_each_model_came(request_, words):
    with pytest.raises(ToleranceError) as error:
        kv.solve(CIRCLE, **request_)
    assert all(re.search(each, str(error.value)) for each in words)
    assert str(error.value).count("the parabola only") <= 1  # each reason once


@pytest.mark.parametrize(("error", "hint"), [(2.7, False), (0.3, True)])
def test_no_tolerance_is_suggested_that_would_be_refused(error, hint):
    rung = climbing.Rung("model", "none", lambda *_: climbing.Offer(error, None))
    with pytest.raises(ToleranceError, match=r"model: error too large") as failed:
        climbing.climb(CIRCLE, climbing.Request(("load",), 1e-3), [rung])
    assert ("try a tolerance" in str(failed.value)) == hint


def test_the_share_of_the_choice_counts_every_rung_that_was_not_used():
    found = kv.solve(quantity="depth", rtol=1e-6)
    times = [(1.0, 2.0), (4.0, 8.0), (16.0, 32.0)]
    steps = tuple(
        replace(found.climb[0], choosing=choosing, solving=solving) for choosing, solving in times
    )
    assert replace(found, climb=steps).choosing_share == (3.0 + 12.0 + 16.0) / (3.0 + 12.0 + 48.0)


def test_a_drive_that_is_a_function_has_no_steady_sliding():
    scene = kv.Scene(drive=kv.Drive(function=lambda t: 0.1 * math.sin(60 * t)))
    with pytest.raises(kv.SceneError, match=r"drive\.function"):
        kv.solve(scene)
    assert kv.solve(scene, at="10 ms", rtol=1e-3).model == "continuum"


command = partial(commands.run, "solve")


def test_the_command_prints_the_contract():
    shown = command("--quantity", "friction_coefficient", "--rtol", "1e-6", "--json")
    record = json.loads(shown.stdout)
    assert list(record) == ["friction_coefficient", "model", "certificate", "climb"]
    assert record["friction_coefficient"] == kv.steady().friction_coefficient
    assert [step["rung"] for step in record["climb"]] == ["asymptote", "exact"]
    series = json.loads(command("--at", "1 ms, 200 ms", "--json").stdout)
    assert list(series) == [*TRANSIENT_UNITS, "model", "certificate", "climb"]
    assert series["time"] == [1e-3, 0.2]
    depth = json.loads(command("--at", "1 ms", "--quantity", "depth", "--json").stdout)
    assert depth["friction_force"] == [None]
    assert depth["depth"] == pytest.approx([2.936e-4], rel=1e-3)


def test_the_command_explains_the_climb_and_writes_a_series_and_nothing_else(tmp_path):
    shown = command("--quantity", "depth", "--explain")
    words = "asymptote", "error too large", "used", "margin", "time to choose", "model: exact"
    assert all(each in shown.stdout for each in words)
    path = tmp_path / "run.csv"
    command("--rtol", "1e-2", "-o", path)
    head, *rows = path.read_text().splitlines()
    assert head.startswith("time [s],velocity [m/s],depth [m]")
    assert len(rows) > 20
    bad = command("--quantity", "depht", "-o", tmp_path / "none.csv", status=2)
    assert '"depth"' in bad.stderr or "did you mean depth" in bad.stderr
    assert [file.name for file in tmp_path.iterdir()] == ["run.csv"]


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


@pytest.mark.parametrize("kind", ["steady", "ball", "other shape", "start"])
def test_no_cheaper_model_would_have_done_in_nine_of_ten(kind):
    assert np.mean([one.cheapest for one in outcomes(kind).values() if one]) >= 0.9


def test_every_model_is_used():
    models = {one.model for kind in KINDS for one in outcomes(kind).values() if one}
    assert models == {"asymptote", "exact", "quadrature", "slow manifold", "continuum"}
