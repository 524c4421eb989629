"""The atlas of failures: in each entry the naive method fails, and the package does not.

What is right is held against numbers from elsewhere too: the paper, theorems, the other methods.
"""

import math
import re

import generators
import numpy as np
import pytest
from generators import atlas
from matplotlib.figure import Figure

import kvtheory as kv
from kvtheory.charts import naive
from kvtheory.charts.failures import ATLAS, findings
from kvtheory.plots.failures import plot_failure, shown
from tests.commands import printed, run

LEAST_ERROR = {
    "instability": 0.05, "sawtooth": 0.02, "grid-resonance": 0.02, "step-at-rest": 0.9,
    "stale-surface": 1.0, "leading-edge-peels": 0.03, "negative-radicand": 0.5,
    "memory-ignored": 1.0, "slow-manifold": 0.2, "event-missed": 0.5, "cancellation": 0.9,
    "asymptote": 0.5, "kink": 0.9, "no-bracket": 10.0, "steep": 0.05,
    "glassy": 0.5, "past-the-maximum": 0.5, "reversal-forgotten": 0.2,
}  # fmt: skip
"""By how much each naive number is wrong, at least, in the units of its entry."""
KNOWN = {
    "step-at-rest": 1631.07, "stale-surface": 8.96613e-5, "cancellation": 1.224744871e-12,
    "asymptote": 0.100874301, "kink": 5.96284794e-5, "event-missed": 3242.017,
    "sawtooth": 0.0, "grid-resonance": 0.0,
}  # fmt: skip
"""Right numbers that were computed once more, by hand or by another program."""


@pytest.fixture(scope="module")
def found():
    return {finding.entry.key: finding for finding in findings()}


def test_the_lists_are_complete():
    assert set(ATLAS) == set(LEAST_ERROR)


@pytest.mark.parametrize("key", ATLAS)
def test_the_naive_method_fails_and_the_package_does_not(found, key):
    entry, outcome = found[key].entry, found[key].outcome
    unit = entry.scale or abs(outcome.right)
    assert abs(outcome.wrong - outcome.right) > LEAST_ERROR[key] * unit
    assert abs(outcome.package - outcome.right) <= entry.tolerance * unit
    assert entry.tolerance <= 0.01
    assert LEAST_ERROR[key] >= 20.0 * entry.tolerance
    if key in KNOWN:
        assert outcome.right == pytest.approx(KNOWN[key], rel=2e-5)


def test_each_failure_is_of_the_kind_that_the_entry_describes(found):
    outcome = {key: finding.outcome for key, finding in found.items()}
    assert "the run diverged" in outcome["instability"].said
    d = outcome["instability"].naive[1]
    assert np.sum(np.diff(np.sign(np.diff(d))) != 0.0) > 20  # it alternates
    # F15: from peak to peak, p_LE dx, less what one sample of 201 may miss.
    steady = kv.steady(kv.Scene.table1("fixed"))
    assert outcome["sawtooth"].wrong == pytest.approx(steady.peak_pressure / 2e4, rel=0.03)
    force = outcome["grid-resonance"].naive[1]  # has a period of fifty samples
    assert force[50:100] == pytest.approx(force[:50], abs=30.0)
    assert np.ptp(force[:50]) > 1000.0
    assert "wrong by" in outcome["grid-resonance"].said
    assert outcome["leading-edge-peels"].wrong < 0.0 < outcome["leading-edge-peels"].right
    assert outcome["memory-ignored"].wrong < 0.0 < outcome["memory-ignored"].package
    assert outcome["event-missed"].said == "solve_ivp: status 0, events found: 0"
    for value in (outcome["no-bracket"].package, outcome["no-bracket"].wrong):
        mu = kv.steady(over={"drive.velocity": [value]}).friction_coefficient[0]
        assert mu == pytest.approx(0.05, rel=1e-9)  # both do: the wrong one is on the other branch
    assert outcome["no-bracket"].package < kv.asymptotes().peak_velocity
    with pytest.raises(ValueError, match="infinite for a drive at rest"):
        kv.elements(kv.Scene(drive=kv.Drive(velocity=0.0)), scheme="paper")


def test_naive_closed_forms_are_right_where_nothing_fails():
    """A start from rest that needs no memory: the failures are those of the scenes, not of a typo."""
    scene = kv.Scene()
    numbers = (4.081276530645, 0.003060957408)
    law, s = naive.two_states(*numbers), np.array([0.01, 0.1, 2.0])
    (d, v), _ = naive.solve_by_scipy(law, (0.0, 2.0), (1.0, 0.0), s, "Radau", 1e-9)
    ours = kv.transient(scene, at=[0.001, 0.01, 0.2], rtol=1e-9)
    depth, load = 3.0018e-4, 9806.65
    assert d[:3] * depth == pytest.approx(ours.depth, rel=1e-3)
    f_z, f_x = np.transpose([naive.closed_forms(*y, numbers[0]) for y in zip(d, v, strict=True)])
    assert f_z[:3] * load == pytest.approx(ours.normal_force, rel=1e-6)
    drag = load * math.sqrt(depth / 0.02)
    assert f_x[:3] * drag == pytest.approx(ours.friction_force, rel=1e-3)


def test_package_lines_are_drawn_over_the_naive_ones(found):
    for finding in found.values():
        curves = finding.outcome.naive, finding.outcome.ours
        factors = [axis[1] for axis in (finding.entry.x, finding.entry.y)]
        for artist, curve in zip(plot_failure(Figure().subplots(), finding), curves, strict=True):
            for drawn, values, factor in zip(artist.get_data(), curve, factors, strict=True):
                assert np.array_equal(drawn, values * factor, equal_nan=True)
            assert np.isfinite(curve[1]).any()


def test_pages_hold_every_entry_and_load_nothing(found, site):
    atlas.write(site, list(found.values()))
    generators.made("atlas", site)
    table = (site / "atlas.md").read_text("utf-8")
    assert re.findall(r"^\| <a href=\"\.\./failures\.html#([^\"]+)", table, re.M) == list(ATLAS)
    page = (site / "extra" / "failures.html").read_text("utf-8")
    assert re.findall(r'<article[^>]*\bid="([^"]+)"', page) == list(ATLAS)
    assert re.findall(r'<a href="([^"]+)', page) == [f"#{key}" for key in ATLAS]
    assert not re.search(r"<(script|link|img)\b", page)
    assert not re.findall(r"url\((?!#)", page)
    for key in ATLAS:
        assert f"kvtheory chart failures --only {key}" in page
    assert "<b>-226.6 N/m</b>" in page
    assert "l<sub>r</sub>" in page
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'(?:href="|url\()#([^")]+)', page)) <= set(ids)
    assert shown(found["kink"], "right") == "0.05963 mN/m"
    assert shown(found["asymptote"], "wrong") == "0.2058"


def test_each_entry_runs_alone(tmp_path):
    command, path = ("chart", "failures", "--only"), tmp_path / "one.html"
    told = run(*command, "cancellation,asymptote", "-o", path).output
    assert "0.001225 nm" in told
    assert "How to notice" in told
    assert path.read_text(encoding="utf-8").count("<article") == 2
    (entry,) = printed(*command, "asymptote")["failures"]
    assert entry["wrong_value"] == pytest.approx(0.20580506)
    assert entry["right_value"] == pytest.approx(0.1008743)
    assert 'use "exact"' in entry["said"]
