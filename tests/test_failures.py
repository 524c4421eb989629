"""The atlas of failures: in each entry the naive method fails, and the package does not.

What is right is held against numbers from elsewhere too: the paper, theorems, the other methods.
"""

import json
import math
import re
from html.parser import HTMLParser

import generators
import numpy as np
import pytest
from click.testing import CliRunner
from generators import atlas

import kvtheory as kv
from kvtheory.charts import naive
from kvtheory.charts.failures import ATLAS, findings
from kvtheory.cli import main
from kvtheory.plots.failures import failures_page, plot_failure, shown

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


def test_the_page_of_the_site_has_a_row_and_an_article_for_each(found, site):
    atlas.write(site, list(found.values()))
    generators.made("atlas", site)
    page, whole = (site / "atlas.md").read_text("utf-8"), site / "extra" / "failures.html"
    assert re.findall(r"^\| <a href=\"\.\./failures\.html#([^\"]+)", page, re.M) == list(ATLAS)
    assert whole.read_text("utf-8").count("<article") == len(ATLAS)


def test_the_lists_are_complete():
    assert set(ATLAS) == set(LEAST_ERROR)


@pytest.mark.parametrize("key", ATLAS)
def test_the_naive_method_fails_and_the_package_does_not(found, key):
    entry, outcome = found[key].entry, found[key].outcome
    assert entry.error(outcome.wrong, outcome.right) > LEAST_ERROR[key]
    assert entry.error(outcome.package, outcome.right) <= entry.tolerance
    assert entry.tolerance <= 0.01
    assert LEAST_ERROR[key] >= 20.0 * entry.tolerance


@pytest.mark.parametrize("key", KNOWN)
def test_right_numbers_are_right(found, key):
    assert found[key].outcome.right == pytest.approx(KNOWN[key], rel=2e-5)


def test_instability_is_refused_and_explained(found):
    assert "the run diverged" in found["instability"].outcome.said
    d = found["instability"].outcome.picture.lines[0].y
    assert np.sum(np.diff(np.sign(np.diff(d))) != 0.0) > 20  # it alternates


def test_sawtooth_is_that_of_the_theorem(found):
    """F15: from peak to peak, p_LE dx, less what one sample of 201 may miss."""
    steady = kv.steady(kv.Scene.table1("fixed"))
    assert found["sawtooth"].outcome.wrong == pytest.approx(steady.peak_pressure / 2e4, rel=0.03)


def test_resonance_has_a_period_of_fifty_samples(found):
    force = found["grid-resonance"].outcome.picture.lines[0].y
    assert force[50:100] == pytest.approx(force[:50], abs=0.03)
    assert np.ptp(force[:50]) > 1.0
    assert "wrong by" in found["grid-resonance"].outcome.said


def test_step_at_rest_is_refused():
    with pytest.raises(ValueError, match="infinite for a drive at rest"):
        kv.elements(kv.Scene(drive=kv.Drive(velocity=0.0)), scheme="paper")


def test_naive_closed_forms_are_right_where_nothing_fails():
    """A start from rest that needs no memory: the failures are those of the scenes, not of a typo."""
    from scipy.integrate import solve_ivp

    scene = kv.Scene()
    numbers = (4.081276530645, 0.003060957408)
    run = solve_ivp(
        naive.two_states(*numbers), (0.0, 2.0), (1.0, 0.0), "Radau", rtol=1e-9, atol=1e-11,
        t_eval=[0.01, 0.1, 2.0],
    )  # fmt: skip
    ours = kv.transient(scene, at=[0.001, 0.01, 0.2], rtol=1e-9)
    depth, load = 3.0018e-4, 9806.65
    assert run.y[0] * depth == pytest.approx(ours.depth, rel=1e-3)
    for k, y in enumerate(run.y.T):
        f_z, f_x = naive.closed_forms(*y, numbers[0])
        assert f_z * load == pytest.approx(ours.normal_force[k], rel=1e-6)
        assert f_x * load * math.sqrt(depth / 0.02) == pytest.approx(
            ours.friction_force[k], rel=1e-3
        )


def test_leading_edge_peels_by_the_package_but_pulls_as_written(found):
    outcome = found["leading-edge-peels"].outcome
    assert outcome.wrong < 0.0 < outcome.right


def test_residual_friction_has_the_wrong_sign_without_memory(found):
    outcome = found["memory-ignored"].outcome
    assert outcome.wrong < 0.0 < outcome.package


def test_solve_ivp_reported_success_and_no_event(found):
    assert found["event-missed"].outcome.said == "solve_ivp: status 0, events found: 0"


def test_root_fulfils_what_was_asked(found):
    for value in (found["no-bracket"].outcome.package, found["no-bracket"].outcome.wrong):
        mu = kv.steady(over={"drive.velocity": [value]}).friction_coefficient[0]
        assert mu == pytest.approx(0.05, rel=1e-9)  # both do: the wrong one is on the other branch
    assert found["no-bracket"].outcome.package < kv.asymptotes().peak_velocity


def test_package_lines_are_drawn_over_the_naive_ones(found):
    from matplotlib.figure import Figure

    for finding in found.values():
        picture = finding.outcome.picture
        artists = plot_failure(Figure().subplots(), picture)
        assert picture.lines[0].role == "wrong"
        for artist, line in zip(artists, picture.lines, strict=True):
            assert np.array_equal(artist.get_ydata(), line.y, equal_nan=True)
            assert np.isfinite(line.y).any()


class Tags(HTMLParser):
    """Collects ids, links and what would be loaded from elsewhere."""

    def __init__(self):
        super().__init__()
        self.ids, self.links, self.open = set(), [], []

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        if tag == "article":
            self.ids.add(values["id"])
        if tag == "a":
            self.links.append(values["href"])
        assert tag not in ("script", "link", "img")


def test_page_holds_every_entry_and_loads_nothing(found):
    page = failures_page(list(found.values()))
    tags = Tags()
    tags.feed(page)
    assert tags.ids == set(ATLAS)
    assert tags.links == [f"#{key}" for key in ATLAS]
    assert not re.findall(r"url\((?!#)", page)
    for finding in found.values():
        assert f"kvtheory chart failures --only {finding.entry.key}" in page
    assert "<b>-226.6 N/m</b>" in page
    assert "l<sub>r</sub>" in page
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'(?:href="|url\()#([^")]+)', page)) <= set(ids)


def test_shown_numbers_have_units(found):
    assert shown(found["kink"], "right") == "0.05963 mN/m"
    assert shown(found["asymptote"], "wrong") == "0.2058"


def invoke(*arguments):
    return CliRunner().invoke(main, ["chart", "failures", *arguments])


def test_each_entry_runs_alone(tmp_path):
    path = tmp_path / "one.html"
    done = invoke("--only", "cancellation,kink", "-o", str(path))
    assert done.exit_code == 0, done.output
    assert "0.001225 nm" in done.output
    assert "How to notice" in done.output
    page = path.read_text(encoding="utf-8")
    assert page.count("<article") == 2


def test_json():
    done = invoke("--only", "asymptote", "--json")
    (entry,) = json.loads(done.output)["failures"]
    assert entry["wrong_value"] == pytest.approx(0.20580506)
    assert entry["right_value"] == pytest.approx(0.1008743)
    assert 'use "exact"' in entry["said"]
