"""The stability of the schemes: predictions against measured growth, and against whole runs."""

import json

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.charts import stability
from kvtheory.charts.stability import CLASSES, contact_lengths, step_map, unwatched, velocity_map
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.elements.stability import limit_at
from kvtheory.plots.failures import draw_stability
from kvtheory.results.errors import DivergenceError
from tests.commands import run

EXPLICIT = [name for name, scheme in SCHEMES.items() if scheme.tableau]
IMPLICIT = [name for name, scheme in SCHEMES.items() if not scheme.tableau]
PAPERS_STEP = 1e-5
"""Times 1/V: 2 dx/V with the paper's elements."""


@pytest.mark.parametrize(
    ("scheme", "tau", "boundary"),
    [
        ("paper", 0.1, 13.17e-3), ("paper", 1.0, 29.3e-3), ("explicit-euler", 0.1, 16.93e-3),
    ],
)  # fmt: skip
def test_growth_begins_where_it_is_predicted(scheme, tau, boundary):
    """Differences grow in steady sliding just below the boundary, and above it they do not."""

    def moving(V):
        return kv.Scene(foundation=kv.Foundation(1e10, tau), drive=kv.Drive(velocity=V))

    for near, V in ((0.99, 0.99 * boundary), (1.01, 1.01 * boundary)):
        grows = stability.growth(moving(V), scheme, 2e5, PAPERS_STEP / V, steady=True) > 1.0
        assert grows == (near < 1.0)
    for near, V in ((0.985, 0.985 * boundary), (1.015, 1.015 * boundary)):
        scene = moving(V)
        limit = limit_at(SCHEMES[scheme], Model.of(scene).constants, contact_lengths(scene)[0])
        assert (limit < PAPERS_STEP / V) == (near < 1.0)


def test_the_papers_scheme_diverges_on_its_own_parameters_at_low_velocity():
    """Table 1 and the paper's step: below 13 mm/s it diverges, at 14 mm/s it does not."""
    for V in (0.008, 0.012):
        scene = kv.Scene(drive=kv.Drive(velocity=V), run=kv.Run(0.1))
        with pytest.raises(DivergenceError, match="diverged"):
            kv.elements(scene, scheme="paper", certify=False)
        wrong = unwatched(scene, "paper", 2e5, PAPERS_STEP / V)[-1].depth
        right = kv.transient(scene, at=[0.1]).depth[0]
        assert abs(wrong / right - 1.0) > 0.03
        good = kv.elements(scene, at=[0.1], certify=False).depth[0]
        assert good == pytest.approx(right, rel=1e-5)
    scene = kv.Scene(drive=kv.Drive(velocity=0.014), run=kv.Run(0.1))
    run = kv.elements(scene, scheme="paper", at=[0.1], certify=False)
    assert run.depth[0] == pytest.approx(kv.transient(scene, at=[0.1]).depth[0], rel=1e-3)


@pytest.mark.parametrize("scheme", EXPLICIT)
def test_maps_of_explicit_schemes_agree_with_the_prediction(scheme):
    maps = [
        velocity_map(scheme, np.geomspace(1e-3, 0.3, 6), np.geomspace(1e-2, 1.0, 3)),
        step_map(scheme, np.geomspace(0.1, 10.0, 3), np.array([0.4, 0.8, 1.8, 2.5])),
    ]
    for found in maps:
        for growing, share, band in (
            (found.steady > 1.0, found.predicted_steady, 0.15),
            # From rest the contact is shorter already in the first step.
            (found.start > stability.INITIAL_GROWTH, found.predicted_start, 0.5),
        ):
            clear = np.abs(np.log(share)) > band
            assert clear.sum() > 0.6 * clear.size
            assert np.array_equal(growing[clear], (share > 1.0)[clear])
            assert 0 < growing.sum() < growing.size
    assert set(maps[0].classes.reshape(-1)) == {0, 1, 2}


@pytest.mark.parametrize("scheme", IMPLICIT)
def test_other_schemes_are_stable_at_any_step(scheme):
    found = velocity_map(scheme, np.geomspace(1e-4, 1.0, 3), np.geomspace(1e-2, 10.0, 2))
    assert set(found.classes.reshape(-1)) == {0}
    assert np.all(found.predicted_steady == 0.0)
    assert step_map(scheme, np.array([0.1, 4.0]), np.array([1.0, 30.0])).classes.max() == 0


def test_unwatched_is_what_the_simulator_does():
    scene = kv.Scene(run=kv.Run(0.02))
    steps = unwatched(scene, "paper", 2e5, 1e-4)
    run = kv.elements(scene, scheme="paper", at=[0.02], certify=False)
    assert steps[-1].depth == pytest.approx(run.depth[0], rel=1e-12)


def test_the_picture_shows_the_classes():
    found = velocity_map("paper", np.array([0.003, 0.1]), np.array([0.1, 1.0]))
    image = draw_stability([found], [found]).axes[0].collections[0]
    assert np.array_equal(image.get_array(), found.classes)
    assert [CLASSES[k] for k in found.classes[0]] == ["unstable in steady sliding", "stable"]


def test_command(tmp_path, monkeypatch):
    monkeypatch.setattr(stability, "QUICK_POINTS", (3, 3))
    monkeypatch.setattr(stability, "growth", lambda *_, steady: 0.9 if steady else 1.1)
    path = tmp_path / "map.png"
    run("chart", "stability", "--quick", "-o", path)
    assert path.read_bytes().startswith(b"\x89PNG")
    data = json.loads(path.with_suffix(".json").read_text())
    assert [found["scheme"] for found in data["maps"]["step"]] == list(SCHEMES)
    first = data["maps"]["velocity"][0]
    assert [np.unique(first[name]) for name in ("start", "steady")] == [1.1, 0.9]
    assert data["environment"]["kvtheory"] == kv.__version__
