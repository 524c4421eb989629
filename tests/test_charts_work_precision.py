"""Work-precision charts: what is right, what is measured, what fails and why. No test looks at a time."""

import json
import math
import re
import tomllib

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.charts import methods, naive
from kvtheory.charts.added import read_runs, with_runs
from kvtheory.charts.collection import (
    SteadyProblem,
    brentq_over_quad,
    chosen,
    measure,
    steady_methods,
    suits,
)
from kvtheory.charts.methods import transient_methods
from kvtheory.charts.problems import (
    ARMS,
    STANDARD,
    Curves,
    Problem,
    by_continuum,
    by_two_states,
    errors,
    standard_scene,
)
from kvtheory.charts.work_precision import (
    REASONS,
    Clock,
    Effort,
    Measurement,
    Method,
    Point,
    TimedOutError,
    make_chart,
)
from kvtheory.plots.work_precision import LOOKS, MARKS, draw_work_precision
from kvtheory.scene import template
from tests import work_precision_reference as stored
from tests.commands import refused, run

BRIEF = Effort(repeats=1, longest=60.0, whole=1.0, every=5)
METHODS = transient_methods()
MEMORY = ("stop-and-go", "reversal", "hop")


def problem(name):
    return Problem(name, standard_scene(name), quick=True)


@pytest.mark.parametrize("name", [name for name in STANDARD if name not in ARMS])
def test_references_agree_and_each_method_is_right_where_it_says_so(name):
    right = problem(name).reference()
    assert right.methods[1] == "stored solution, see the tests"
    assert max(right.agreement.values()) < 2e-9
    assert max(right.agreement[key] for key in ("depth, maximum", "depth, L2")) < 1e-10
    found = by_continuum(problem(name), 1e-8)[0]
    assert max(errors(found, right.solution).values()) < 1e-6
    if name not in (*MEMORY, "high-velocity"):
        found = by_two_states(problem(name), 1e-8, method="LSODA")[0]
        assert max(errors(found, right.solution).values()) < 1e-5


def test_on_a_prony_series_the_continuum_agrees_with_material_points_followed_one_by_one():
    """Two states and the method of lines do not apply."""
    table, one = json.loads(stored.PATH.read_text())["rubber"], problem("rubber")
    assert table["times"] == one.times.tolist()
    right = Curves(np.array(table["depth"]), np.array(table["friction"]))
    assert max(errors(by_continuum(one, 1e-6, fast=False)[0], right).values()) < 1e-7
    elements = METHODS["elements, edge-corrected"].solve(one, 40.0, Clock())[0]
    assert 1e-4 < errors(elements, right)["depth, maximum"] < 1e-3
    suits = {name for name, method in METHODS.items() if method.suits(one)}
    assert {name.partition(",")[0] for name in suits} == {"continuum", "elements"}


def test_stored_solutions_are_those_of_their_generator():
    table = json.loads(stored.PATH.read_text())["table-1"]
    found = stored.solve("table-1", 1e-7)
    assert found["times"] == table["times"]
    assert found["depth"] == pytest.approx(table["depth"], abs=1e-5)
    assert found["friction"] == pytest.approx(table["friction"], abs=1e-5)


def test_reference_of_a_users_scene_without_and_with_memory():
    start = Problem("mine", kv.Scene(), quick=True).reference()
    assert start.methods[1].startswith("two states")
    assert max(start.agreement.values()) < 1e-8
    stop = kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, 0.0)]), run=kv.Run(0.1))
    found = Problem("mine", stop, quick=True).reference()
    assert found.methods[1].startswith("elements")
    assert 1e-9 < found.agreement["depth, maximum"] < 1e-3


@pytest.mark.parametrize(
    ("start", "other", "agreed"),
    [
        (kv.Start(depth=4e-4, depth_rate=5e-3), "two states", 1e-8),
        (kv.Start(gap=1e-5, depth_rate=0.01), "elements", 2e-3),
    ],
    ids=["release", "drop"],
)
def test_references_agree_on_other_starts_and_methods_that_know_rest_only_are_left_out(
    start, other, agreed
):
    found, suited = chosen(kv.Scene(start=start, run=kv.Run(0.03)), (), quick=True)[-1]
    reference = found.reference()
    assert reference.methods[1].startswith(other)
    assert reference.agreement["depth, maximum"] < agreed
    assert reference.agreement["friction, maximum"] < agreed
    names = {method.name for method in suited if method.suits(found)}
    assert "elements, paper" in names
    assert not names & {"slow manifold", "method of lines"}
    assert ("two states, Radau" in names) == (other == "two states")


def test_errors_by_hand():
    right = Curves(np.array([1.0, 0.5, 0.25]), np.array([-4.0, 2.0, 1.0]))
    due = {
        "depth, final": 0.0, "depth, maximum": 0.1, "depth, L2": 0.1 / math.sqrt(3.0),
        "friction, final": 0.5, "friction, maximum": 0.5,
        "friction, L2": math.sqrt((0.0625 + 0.25) / 3.0), "peak friction": 0.25,
    }  # fmt: skip
    found = errors(Curves(np.array([1.0, 0.6, 0.25]), np.array([-3.0, 2.0, 3.0])), right)
    assert found == pytest.approx(due)


def test_instants_hold_the_jumps_and_drives_are_numbers_or_functions():
    one = problem("stop-and-go")
    assert {0.0, 0.5, 0.7, 1.5} <= set(one.times.tolist())
    assert np.diff(one.times).min() > 1e-7
    assert len(one.pieces) == 3
    assert one.pieces[1][2] == 0.0
    scene = kv.Scene(drive=kv.Drive(history=[(0.0, 0.0), (0.1, 0.1), (0.1, 0.3)]))
    ((_, end, rate), (_, _, held)) = Problem("ramp", scene).pieces
    assert rate(0.5 * end) == pytest.approx(held / 6.0)
    assert rate(end) == pytest.approx(held / 3.0)  # before the jump


@pytest.mark.parametrize("name", MEMORY)
def test_two_states_report_success_and_are_wrong_where_memory_is_needed(name):
    chart = make_chart(problem(name), [METHODS["two states, LSODA"]], effort=BRIEF)
    reasons = {point.reason for point in chart.series[0].points if point.knob < 1e-3}
    assert reasons <= {"wrong but reported success", "missed event"}
    assert reasons
    if name == "hop":
        assert reasons == {"missed event"}


@pytest.mark.parametrize("method", [name for name in METHODS if "lines" not in name])
def test_every_method_meets_its_own_accuracy_on_table_1(method):
    given, one = METHODS[method], problem("table-1")
    knob = 1e-6 if given.knob == "rtol" else 40.0
    curves, work = given.solve(one, knob, Clock())
    found = errors(curves, one.reference().solution)["depth, maximum"]
    if given.kind == "model":
        assert 5e-3 < found < 0.05
        assert work == 0
    else:
        assert found < {"rtol": 1e-5, "elements per a_0": 5e-3}[given.knob]
        assert work > 0


def test_method_of_lines_converges_and_counts_its_updates():
    one = Problem("short", kv.Scene(run=kv.Run(0.02)), quick=True)
    right, solve = one.reference().solution, METHODS["method of lines"].solve
    runs = [solve(one, density, Clock()) for density in (10.0, 40.0)]
    found = [errors(curves, right)["depth, maximum"] for curves, _ in runs]
    assert found[1] < 0.5 * found[0] < 0.01
    assert runs[1][1] > 3 * runs[0][1] > 0


def test_every_method_has_a_look_of_its_own_and_cvode_is_left_out_where_it_is_not_installed(
    monkeypatch,
):
    assert {*METHODS, *(method.name for method in steady_methods())} <= set(LOOKS)
    assert len(set(LOOKS.values())) == len(LOOKS)
    monkeypatch.setattr(methods, "find_spec", lambda name: None)
    assert "two states, CVODE" not in transient_methods()


def test_a_run_that_takes_too_long_is_ended_and_the_dearer_ones_are_not_begun():
    begun = []

    def slow(one, knob, clock):
        begun.append(knob)
        while len(begun) > 1:  # the very first call is without a limit
            clock.check()
        return by_continuum(one, 1e-3)

    only = Method("continuum, compiled", "rtol", (1e-2, 1e-3), "evaluations", slow)
    chart = make_chart(problem("table-1"), [only], effort=Effort(1, 0.01, 1.0, 1))
    assert [point.reason for point in chart.series[0].points] == ["timed out"] * 2
    assert begun == [1e-2, 1e-2]
    with pytest.raises(TimedOutError):
        Clock(0.0, -1.0).check()


def test_reasons_of_failures_are_kept_and_an_unstable_scheme_is_on_the_rail():
    for error, reason in ((ArithmeticError("no"), "not converged"), (ValueError("no"), "refused")):

        def fail(one, knob, clock, error=error):
            raise error

        only = Method("method of lines", "rtol", (1e-2,), "evaluations", fail)
        (point,) = make_chart(problem("table-1"), [only], effort=BRIEF).series[0].points
        assert (point.reason, point.message) == (reason, "no")
    slow = Problem("slow", kv.Scene(drive=kv.Drive(velocity=0.02), run=kv.Run(0.5)), quick=True)
    only = Method("elements, paper", "elements per a_0", (40.0,), "element updates",
                  METHODS["elements, paper"].solve)  # fmt: skip
    chart = make_chart(slow, [only], effort=BRIEF)
    (point,) = chart.series[0].points
    assert point.reason == "unstable"
    (marker,) = draw_work_precision([chart], ["depth, maximum"]).axes[1].get_lines()
    assert marker.get_xdata()[0] == REASONS.index("unstable")


@pytest.mark.parametrize("V", [1e-3, 0.1, 10.0])
def test_both_references_of_steady_sliding_agree_to_forty_digits(V):
    one = SteadyProblem("steady", kv.Scene(drive=kv.Drive(velocity=V)))
    depth, mu = one.by_simpson()
    for value, other in zip((depth, mu), one.by_ratio(), strict=True):
        assert abs(value / other - 1) < 1e-40
    state = kv.steady(one.scene)
    assert state.friction_coefficient == pytest.approx(float(mu), rel=1e-15)
    found, count = brentq_over_quad(one, 1e-12, Clock())
    assert found == pytest.approx((state.depth, state.friction_coefficient), rel=1e-9)
    assert count > 100


def test_steady_chart():
    problem, densities = SteadyProblem("table-1", kv.Scene()), (10.0, 320.0)
    only = [
        method if "elements" not in method.name
        else Method(method.name, method.knob, densities, method.work, method.solve)
        for method in steady_methods()
    ]  # fmt: skip
    chart = make_chart(problem, only, effort=Effort(1, 60.0, 1.0, 1))
    found = {series.method: series for series in chart.series}
    assert max(chart.floor.values()) < 1e-40
    for name in ("exact", "exact, 10 000 at once"):
        assert found[name].points[0].errors["friction coefficient"] < 1e-14
    assert found["asymptote"].kind == "model"
    assert found["asymptote"].points[0].errors["depth"] == pytest.approx(0.0937, abs=1e-3)
    coarse, fine = (p.errors["depth"] for p in found["elements, edge-corrected"].points)
    assert fine < 0.1 * coarse < 1e-3
    assert not suits(kv.Scene.table1("fixed"))
    assert not suits(kv.Scene(drive=kv.Drive(velocity=-0.1)))


def test_picture_shows_what_was_measured():
    only = [METHODS[name] for name in ("slow manifold", "two states, LSODA")]
    chart = make_chart(problem("table-1"), only, effort=BRIEF)
    drawn = draw_work_precision([chart], ["depth, maximum"])
    line = next(a for a in drawn.axes[0].get_lines() if a.get_label() == "two states, LSODA")
    points = chart.series[1].points
    assert line.get_xdata().tolist() == [point.errors["depth, maximum"] for point in points]
    assert line.get_ydata().tolist() == [point.seconds for point in points]
    point = Point(1.0, times=[4.0, 1.0, 2.0, 3.0, 5.0])
    assert (point.seconds, point.quartiles) == (1.0, (2.0, 4.0))


def test_command(tmp_path, monkeypatch):
    monkeypatch.setattr("kvtheory.charts.collection.QUICK", Effort(1, 0.3, 0.5, 6))
    mine = tmp_path / "mine.csv"
    mine.write_text(
        'method,seconds,error\n"my loop, RK4",4.5,2e-4\n"my loop, RK4",0.4,1e-3\nnone,1,0\n'
    )
    given = "--quick", "--set", "run.duration=20 ms", "--add", str(mine), "-o", str(tmp_path)
    done = run("chart", "work-precision", *given)
    assert re.search(r"^measuring takes about \S+ s$", done.stderr, re.MULTILINE)
    assert re.search(r"the others take about \S+ s$", done.stderr, re.MULTILINE)
    assert (tmp_path / "work_precision.png").read_bytes().startswith(b"\x89PNG")
    data = json.loads((tmp_path / "work_precision.json").read_text())
    assert [chart["name"] for chart in data["charts"]] == ["this scene, steady", "this scene"]
    assert data["environment"]["processors"] >= 1
    assert "agree on depth to" in done.output
    own = {each["method"]: each["points"] for each in data["charts"][1]["series"][-2:]}
    assert [point["seconds"] for point in own["my loop, RK4"]] == [0.4, 4.5]
    assert own["none"][0]["errors"] == {"depth, maximum": 0.0}


HEAD = "method,seconds,error\n"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", ['is empty; expected a first line "method,seconds,error"']),
        (HEAD, ["holds a header and no rows"]),
        ("method,second,error\na,1,1\n", ['"second" may be "seconds"']),
        ("method,seconds,error,error\na,1,1,2\n", ["are both the error; keep one of them"]),
        (
            HEAD + "a,1\n\nb,fast,good\n" + 'c,"1,5",0\n' + 3 * "my loop, RK4,1,2\n",
            [
                'line 2, column "error": the cell is empty',
                *('line 4, column "seconds": "fast" is not', 'line 4, column "error": "good" is'),
                'line 5, column "seconds": "1,5" is not a number',
                "line 8 has 4 cells, the header has 3",
            ],
        ),
        (
            HEAD + "a,1,-1\na,0,1\nexact,1,1\n,1,1e300\n\u4e2d,1,1\n",
            [
                *(
                    'line 2, column "error": "-1.0" is not',
                    'line 3, column "seconds": "0.0" is not',
                ),
                'line 4, column "method": "exact" is empty, or a method of the chart',
                *('line 5, column "method": "" is', 'line 5, column "error": "1e+300" is not'),
                'line 6, column "method": "\u4e2d" has letters that the font of the chart lacks',
            ],
        ),
        (HEAD + "".join(f"{k},1,1\n" for k in range(9)), ["has 9 methods; expected at most 8"]),
        (HEAD + 1001 * "a,1,1\n", ["has 1001 runs; expected at most 1000"]),
    ],
)
def test_mistakes_in_runs_are_reported_together_before_anything_is_measured(tmp_path, text, why):
    path = tmp_path / "mine.csv"
    path.write_text(text, encoding="utf-8")
    words = "chart", "work-precision", "--quick", "--add", path, "-o", tmp_path / "x.png"
    message = refused(words, [str(path), *why])
    assert message.count("\n") >= len(why)
    assert list(tmp_path.iterdir()) == [path]


def test_runs_are_read_as_any_table_is(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("# mine\nmethod;seconds [ms];error [%]\na;1;1\n2;1,5;0\na;3;4\n")
    runs = read_runs(path, LOOKS, len(MARKS), str.isalnum)
    assert runs == {"a": [(0.001, 0.01), (0.003, 0.04)], "2": [(0.0015, 0.0)]}


def test_runs_of_several_scenes_cannot_be_added(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("method,seconds,error\na,1,1\n")
    refused(
        ("chart", "work-precision", "--add", path, "--standard", "all"), ["--add is for one scene"]
    )


def test_added_methods_have_marks_of_their_own():
    chart = make_chart(problem("table-1"), [METHODS["slow manifold"]], effort=BRIEF)
    runs = {rf"mine $\oo$ {k}": [(1.0 + k, 1e-3)] for k in range(len(MARKS))}
    chart = with_runs(chart, runs, "depth, maximum")
    lines = draw_work_precision([chart], ["depth, maximum"]).axes[0].get_lines()
    looks = {line.get_label(): (line.get_color(), line.get_marker()) for line in lines}
    found = [looks[name.replace("$", r"\$")] for name in runs]  # no mathematics
    assert len({*found, *LOOKS.values()}) == len(found) + len(LOOKS)


@pytest.mark.parametrize("longest", [0.4, 20.0])
def test_the_time_of_a_chart_is_forecast_within_a_factor_of_two(longest):
    """From times that were measured once; the last settings are not known to the forecast."""
    measured = {
        "two states, RK45": [0.0091, 0.0095, 0.02, 0.036, 0.069],
        "two states, DOP853": [0.019, 0.012, 0.026, 0.048, 0.069],
        "two states, BDF": [0.0099, 0.028, 0.07, 0.099, 0.24],
        "two states, LSODA": [0.0065, 0.0042, 0.0094, 0.011, 0.017],
        "continuum, interpreted": [0.0021, 0.006, 0.0038, 0.0052, 0.0076, 0.011],
        "elements, explicit-euler": [0.18, 0.18, 0.2],
        "elements, semi-implicit": [0.057, 0.07, 0.1],
        "method of lines": [0.6, 5.0, 31.0],
    }
    effort = Effort(3, longest, 3.0, 2)
    one = Measurement(problem("table-1"), [METHODS[name] for name in measured], effort)
    true, repeated = 0.0, []
    for series in one.series:
        ended = False
        for k, (point, seconds) in enumerate(
            zip(series.points, measured[series.method], strict=True)
        ):
            point.first = 0.0 if ended else min(seconds, longest)
            true += point.first if k >= one.begun else 0.0
            repeated += [seconds] if seconds < longest else []
            ended = ended or seconds >= longest
            if k >= one.begun:
                point.first = 0.0
    once, short = sum(repeated), sum(t for t in repeated if t <= 0.25 * longest)
    true += once + min(2.0 * short, max(3.0 - once, 0.0))
    assert 0.5 < one.forecast() / true < 2.0


@pytest.mark.parametrize("command", [("explore",), ("chart", "work-precision", "--quick")])
@pytest.mark.parametrize(
    ("section", "own", "key"),
    [
        ("drive", {"velocity": ["10 mm/s"]}, "drive.velocity"),
        ("drive", {"velocity": "1 mm/s:1 m/s:4:log"}, "drive.velocity"),
        ("support", {"kind": "dead-weight", "mass": ["1 kg/mm", "2 kg/mm"]}, "support.mass"),
        (
            "foundation",
            {"kind": "generalized-maxwell", "stiffness": "10 GN/m^3",
             "arms": [[["30 GN/m^3", "20 GN/m^3"], "10 ms"]]},
            "foundation.arms[0].stiffness",
        ),
        (
            "foundation",
            {"stiffness": "10 GN/m^3", "retardation_time": "100 ms", "temperature": ["20 degC", "30 degC"],
             "reference_temperature": "20 degC", "wlf": ["17.44", "51.6 K"]},
            "foundation.temperature",
        ),
    ],
)  # fmt: skip
def test_what_shows_one_scene_says_which_key_holds_a_list(tmp_path, command, section, own, key):
    scene = tomllib.loads(template())
    scene[section] = own
    lines = [
        f"[{name}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in table.items())
        for name, table in scene.items()
    ]
    path, output = tmp_path / "scene.toml", tmp_path / "drawn"
    path.write_text("\n".join(lines), encoding="utf-8")
    output.mkdir()
    file = output / ("page.html" if command == ("explore",) else "chart.png")
    told = refused((*command, path, "-o", file), [f"is for one scene, not for arrays ({key})"])
    assert told.count("\n") == 1
    assert "use `sweep`, or give one value of each" in told
    assert not list(output.iterdir())


def test_all_standard_scenes_have_a_chart_and_charts_report_their_progress():
    assert len(chosen(kv.Scene(), ["all"], quick=True)) == len(STANDARD) + 3
    reports = []

    def half(one, knob, clock):
        return Curves(*one.reference().solution), 1

    method, told = Method("half", "-", (0.0,), "evaluations", half), []
    jobs = [(problem("table-1"), [method])] * 2
    coarse = Measurement(*jobs[0], Effort(1, 1.0, 1.0, 6))
    assert coarse.begun == 2  # else nothing is known of the growth of the time
    measure(
        jobs,
        quick=True,
        progress=lambda *x: reports.append(x),
        announce=lambda _, seconds: told.append(seconds),
    )
    shares = [share for share, _ in reports]
    assert shares == sorted(shares)
    assert shares[:3] == pytest.approx([0.0, 0.15, 0.3])
    assert shares[-1] < 1.0
    assert [words for _, words in reports] == [*["half"] * 2, *["half", *["repeats"] * 3] * 2]
    assert len(told) == 2
    assert min(told) > 0.0

    def slow(one, knob, clock):
        raise TimedOutError

    jobs = [(problem("table-1"), [Method("slow", "-", (0.0,), "evaluations", slow)])]
    (chart,) = measure(jobs, quick=True, announce=lambda _, seconds: told.append(seconds))
    assert chart.series[0].points[0].reason == "timed out"
    assert told[3] == 0.0


def test_a_run_that_is_not_finite_has_not_converged():
    one = problem("table-1")
    right = one.reference()
    nothing = Curves(*(np.full_like(each, math.nan) for each in right.solution))
    assert one.assess(nothing, right, 1e-6)[1] == "not converged"
    assert one.assess(right.solution, right, 1e-6)[1] == ""


def test_the_evaluations_of_all_pieces_are_counted():
    def solve(law, ends, y, s, method, rtol):
        return np.ones((2, s.size + 1)), 7

    pieces = [(0.0, 1.0, 0.5), (1.0, 2.0, 0.0)]
    law_of = lambda number: None  # noqa: E731
    _, count = naive.without_memory(pieces, np.array([0.5, 1.5]), law_of, "any", 1e-6, solve)
    assert count == 14
