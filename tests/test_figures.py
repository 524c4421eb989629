"""The figure scripts run, write what they promise, and plot what they computed."""

import csv
import importlib
import math
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import generators
import matplotlib as mpl
import numpy as np
import pytest
from generators import gallery

import kvtheory as kv
from figures import __main__ as every
from figures import drawing, onset_maps, work_precision
from figures.__main__ import FIGURES
from kvtheory.charts import collection, stability
from kvtheory.charts.work_precision import Effort
from kvtheory.plots import STYLE, files, plot_asymptote_errors, plot_steady
from kvtheory.plots.paper import fig5, fig6, table2
from kvtheory.scene.static_state import StaticState
from tests.commands import python, refused, run

BRIEF = (
    (onset_maps, "NUMBERS", onset_maps.NUMBERS[::4]),
    (onset_maps, "INERTIAS", onset_maps.INERTIAS[::3]),
    (stability, "QUICK_POINTS", (3, 3)),
    (stability, "growth", lambda *_, steady: 0.9 if steady else 1.1),
    (collection, "QUICK", Effort(repeats=1, longest=0.1, whole=0.5, every=5)),
    (work_precision, "SCENES", ("table-1",)),
    (files, "STYLE", {**STYLE, "savefig.dpi": gallery.DPI}),
)
"""Coarse where it takes minutes. `test_charts_stability` and `test_charts_work_precision` test the charts."""
KINDS = {"fig3": list(drawing.FORMATS), "stability_map": (), "work_precision": ()}
"""The formats in which a figure is saved if not as PNG alone; tests of their charts save the last two."""


@pytest.fixture(scope="module")
def made(site):
    """Every figure, drawn once: its data, its axes and its files, which the site takes over."""
    result = {}
    with pytest.MonkeyPatch.context() as patch:
        for brief in BRIEF:
            patch.setattr(*brief)
        for name in FIGURES:
            script = importlib.import_module(f"figures.{name}")
            data = script.compute()
            with mpl.rc_context(files.STYLE):
                drawn = script.draw(data)
            if name in gallery.DRAWN:
                drawn.set_layout_engine("none")  # the site does not show it: nothing need fit
            patch.setattr(drawing, "FORMATS", KINDS.get(name, ["png"]))
            paths = drawing.produce(
                name, lambda data=data: data, lambda _, drawn=drawn: drawn, site / "pictures"
            )
            result[name] = data, drawn, paths
            if name in gallery.HERE:
                generators.made(f"figure {name}", site)
        yield result


@pytest.mark.parametrize("name", FIGURES)
def test_each_figure_is_saved_with_its_data(made, name):
    data, _, paths = made[name]
    begin = {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG", "csv": b""}
    kinds = [*KINDS.get(name, ["png"]), "csv"]
    assert [path.name for path in paths] == [f"{name}.{kind}" for kind in kinds]
    assert all(path.read_bytes().startswith(begin[path.suffix[1:]]) for path in paths)
    with paths[-1].open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    assert head == list(data.columns)
    assert len(rows) == len(next(iter(data.columns.values())))
    for column, cells in zip(data.columns.values(), zip(*rows, strict=True), strict=True):
        missing = [isinstance(v, float) and math.isnan(v) for v in np.asarray(column).tolist()]
        assert [cell == "" for cell in cells] == missing
        assert not all(missing)
        assert not {"nan", "inf", "-inf"} & set(cells)
    assert not list(paths[0].parent.glob(".*"))


def test_small_motions_grow_below_the_critical_stiffness_only(made):
    data, drawn, _ = made["spring_stability"]
    script = importlib.import_module("figures.spring_stability")
    stiffness = script.STIFFNESSES[:, np.newaxis]
    for tau, critical in data.critical.items():
        line = np.nan_to_num(critical)
        below, above = stiffness < 0.99 * line, stiffness > 1.01 * line
        past = 1.001 * data.peak[tau] < script.VELOCITIES
        assert np.all(data.growth[tau][below & past] > 0.0)
        assert np.all(data.growth[tau][above] < 0.0)
    assert len(drawn.axes) == 4


def test_motions_end_in_steady_sliding_above_the_critical_stiffness_only(made):
    data, drawn, _ = made["spring_stability"]
    for ax, (tau, points) in zip(drawn.axes, data.settled.items(), strict=False):
        V, k, steadily = np.array(points).T
        over = {"drive.velocity": V, "drive.stiffness": k, "foundation.retardation_time": tau}
        assert np.array_equal(steadily, kv.stability(over=over, quantity="stable").stable)
        marks = {mark.get_marker(): mark.get_xdata().size for mark in ax.get_lines()[2:]}
        assert marks == {"o": np.sum(steadily == 1.0), "x": np.sum(steadily == 0.0)}
    ends = [steadily for points in data.settled.values() for _, _, steadily in points]
    assert min(ends.count(True), ends.count(False)) >= 10


def test_a_stiffer_drive_measures_more_of_the_friction_curve(made):
    data, _, _ = made["measurable_friction"]
    peak = kv.asymptotes().peak_velocity
    assert np.all(np.diff(data.velocities) > 0.0)
    assert data.velocities[0] == pytest.approx(peak, rel=0.1)


def test_fig5_shows_exact_lines_under_quadrature_points(made):
    data, drawn, _ = made["fig5"]
    assert len(drawn.axes) == 8
    for key, points in data.points.items():
        exact = data.curves[key]
        for name in ("depth", "load", "friction_force", "friction_coefficient"):
            assert getattr(points, name) == pytest.approx(getattr(exact, name)[::20], rel=1e-12)
    line = drawn.axes[-1].get_lines()[0]
    assert np.array_equal(line.get_ydata(), data.curves["dead-weight", 0.01].friction_coefficient)


def test_fig6_points_of_random_scenes_fall_on_the_master_curves(made):
    data, _, _ = made["fig6"]
    unit = {"indenter.radius": 1.0, "foundation.stiffness": 1.0, "foundation.retardation_time": 1.0}
    for support, grip in (("fixed", "support.depth"), ("dead-weight", "support.mass")):
        numbers, points = data.points[support]
        over = {**unit, grip: 1.0, "drive.velocity": numbers}
        if support == "dead-weight":
            over["support.gravity"] = 1.0
        curve = kv.steady(kv.Scene.table1(support), over=over).friction_coefficient
        assert points == pytest.approx(curve, rel=1e-12)


def test_foundations_tend_to_kelvin_voigt_and_stepprofile_carries_the_load(made):
    data, _, _ = made["foundations"]
    for family in data.curves.values():
        plain = family["Kelvin–Voigt"]
        assert family[r"$\alpha = 1$"] == pytest.approx(plain, rel=1e-13)
        window = data.columns["V tau/a_0 [1]"] < 1.0
        off = [
            np.abs(family[rf"$\beta = {beta}$"] / plain - 1)[window].max()
            for beta in (100, 1000, 10000)
        ]
        assert off[0] > 5 * off[1] > 25 * off[2]
    for support, names in data.limits.items():
        curves, (low, high) = data.curves[support], names[r"$\alpha = 0.4$"]
        assert low[0] == pytest.approx(curves[r"$\alpha = 0.4$"][0], rel=0.1)
        assert high[-1] == pytest.approx(curves[r"$\alpha = 0.4$"][-1], rel=0.1)
        for beta in (1, 10):
            name = rf"$\beta = {beta}$"
            assert names[name][0][-1] == pytest.approx(curves[name][-1], rel=0.01)
    for name, (x, p) in data.profiles.items():
        assert np.trapezoid(p, x) == pytest.approx(4 / 3, rel=2e-2), name


def test_the_rubber_is_kelvin_voigt_in_the_ranges_that_are_drawn(made):
    data, _, _ = made["rubber"]
    V = data.columns["V [m/s]"]
    assert np.all(np.abs(data.error[data.measured >= V]) <= 0.01)
    assert 0 < data.proved < data.measured < V[-1]
    known = np.isfinite(data.bound)
    assert np.all(np.abs(data.error[known]) <= data.bound[known])


def test_gauss_by_hand_converges_on_one_arm_and_not_on_twenty(made):
    series = made["foundation_precision"][0].series
    best = {count: min(each["Gauss's rule by hand"][0]) for count, each in series.items()}
    assert best[1] < 1e-12
    assert best[20] > 1e-6
    assert all(each["quadrature"][0][0] < 1e-12 for each in series.values())


def test_curves_of_all_temperatures_lie_on_the_master_curve(made):
    data, _, _ = made["temperature"]
    script = importlib.import_module("figures.temperature")
    for celsius, mu in data.curves.items():
        shifted = script.SPEEDS * data.shift_factors[celsius]
        right = kv.steady(script.scene(script.REFERENCE), over={"drive.velocity": shifted})
        assert mu == pytest.approx(right.friction_coefficient, rel=1e-9)
    assert data.shift_factors[0.0] > 1.0 > data.shift_factors[40.0] > data.shift_factors[80.0]


def test_the_true_change_by_fewer_arms_is_below_its_bound(made):
    data, _, _ = made["fewer_arms"]
    assert np.all(data.change < data.bound)
    assert np.all(np.diff(data.change) < 0.0)
    assert data.arms[0] < 10 < 17 <= data.arms[-1]


def test_table2_carries_the_papers_coefficients(made):
    columns = made["table2"][0].columns
    alpha, R, K, C, delta, W = 2 * np.sqrt(2) / 3, 0.01, 1e10, 1e9, 3e-4, 9806.65
    fixed = [alpha * K * np.sqrt(R * delta) / C, C * 1e-3 / (R * K), alpha * np.sqrt(delta / R)]
    assert columns["fixed"] == pytest.approx(fixed, rel=1e-13)
    critical = alpha ** (2 / 3) * np.cbrt(R * K**2 * W) / C
    movable = [critical, C * 1e-3 / (R * K), alpha * np.sqrt(W / (R * C * 1e-3))]
    assert columns["dead-weight"] == pytest.approx(movable, rel=1e-13)


def test_energy_split_has_its_minimum_at_four_fifths(made):
    data, _, _ = made["energy_split"]
    assert data.points == pytest.approx(data.exact[::15], rel=1e-12)
    assert data.exact.min() == pytest.approx(0.8, abs=1e-4)


def test_circle_tends_to_the_leading_term_with_the_fourth_power(made):
    data, _, _ = made["circle_error"]
    slopes = np.asarray(next(iter(data.columns.values())))
    small = (slopes > 0.02) & (slopes < 0.2)
    for measured, leading in zip(data.measured, data.leading, strict=True):
        rest = np.log(np.abs(measured - leading)[small])
        order = np.polyfit(np.log(slopes[small]), rest, 1)[0]
        assert order == pytest.approx(4.0, abs=0.15)


def test_the_closed_form_boundary_separates_monotone_from_oscillating(made):
    data, _, _ = made["regime_map"]
    columns = {name: np.array(column) for name, column in data.columns.items()}
    number, eps = columns["drive_number [1]"], columns["inertia_number [1]"]
    order = np.argsort(data.boundary[0])
    limit = np.interp(np.log(number), np.log(data.boundary[0][order]), data.boundary[1][order])
    # Near the boundary a single turn is too small to be seen above the tolerance.
    assert set(columns["class"][eps < 0.9 * limit]) == {"monotone"}
    assert set(columns["class"][eps > 1.5 * limit]) == {"oscillating", "take-off"}


def test_the_phase_portrait_ends_in_the_steady_state_on_the_slow_manifold(made):
    data, _, _ = made["phase_portrait"]
    depth, rate = data.manifold
    assert np.interp(data.steady_depth, depth, rate) == pytest.approx(0.0, abs=1e-3)
    for d, v in data.curves.values():
        assert d[-1] == pytest.approx(data.steady_depth, abs=2e-3)
        assert v[-1] == pytest.approx(0.0, abs=5e-3)


def test_plot_functions_return_their_artists(made):
    ax = made["asymptote_error"][1].axes[0]
    V = np.array([0.01, 0.1])
    (line,) = plot_steady(ax, V, kv.steady(over={"drive.velocity": V}), "load")
    assert line.get_xdata().tolist() == [10.0, 100.0]
    assert line.get_ydata() == pytest.approx([9.80665, 9.80665])
    report = kv.asymptotes(over={"drive.velocity": V})
    artists = plot_asymptote_errors(ax, report, {"L1": {}, "L2": {}})
    assert len(artists) == 2
    assert artists[0].get_ydata() == pytest.approx(np.abs(report.lines[0].relative_error))


def test_a_script_runs_alone(tmp_path):
    assert str(tmp_path / "table2.png") in python("-m", "figures.table2", "-o", tmp_path)


def test_a_script_runs_by_its_path(tmp_path, monkeypatch):
    """The path of a script holds its folder, where `figures` is a module that finds the package."""
    folder = Path(drawing.__file__).parent
    path = [each for each in sys.path if Path(each).resolve() != folder.parent]
    monkeypatch.setattr(sys, "path", [str(folder), *path])
    monkeypatch.delitem(sys.modules, "figures")
    monkeypatch.setattr(sys, "argv", ["fig6.py", "-o", str(tmp_path)])
    monkeypatch.setattr(drawing, "FORMATS", ("png",))
    runpy.run_path(str(folder / "table2.py"), run_name="__main__")
    assert {each.name for each in tmp_path.iterdir()} == {"table2.png", "table2.csv"}


OTHER = kv.Scene(
    kv.Parabola("5 mm"),
    kv.Foundation(2e9, "2 ms"),
    kv.Suspended("1 kg/mm", "30 MN/m^2"),
    kv.Drive(0.3),
)


def test_a_scene_has_its_place_on_the_master_curves_of_fig6():
    data = fig6.compute(OTHER)
    for support, (x, y) in data.own.items():
        curve = np.exp(np.interp(np.log(x), np.log(fig6.NUMBERS), np.log(data.curves[support])))
        assert y == pytest.approx(curve, rel=1e-3)
    assert data.own["dead-weight"][0] == pytest.approx(0.3 * 2e-3 * np.cbrt(2e9 / (5e-3 * 9806.65)))
    assert set(data.columns["y of the scene, fixed [1]"]) == {data.own["fixed"][1]}


def test_fig5_and_table2_are_those_of_the_scene():
    data = fig5.compute(OTHER)
    assert sorted(set(data.columns["retardation_time [s]"])) == [2e-4, 2e-3, 2e-2]
    state = data.curves["dead-weight", 2e-3]
    assert state.load == pytest.approx(np.full_like(data.velocities, 9806.65))
    peak = np.argmax(state.friction_coefficient)
    assert 50 < peak < 150  # the velocities are around the maximum
    low = table2.compute(OTHER).columns["fixed"][1]
    assert low == pytest.approx(2e-3 * 1e-3 / 5e-3)


def test_a_figure_in_ones_own_style_with_its_data(tmp_path):
    style, picture = tmp_path / "mine.mplstyle", tmp_path / "t.png"
    style.write_text("figure.figsize: 9, 3\nsavefig.dpi: 50\nfont.family: serif\n")
    words = "chart", "table2", "--style", str(style), "-o", str(picture)
    for _ in range(2):  # it may be replaced
        assert run(*words).stdout.split() == [str(picture), str(tmp_path / "t.csv")]
    assert mpl.image.imread(picture).shape[:2] == (150, 450)
    assert (tmp_path / "t.csv").read_text().startswith("quantity,fixed,dead-weight\n")
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    refused(words, ["t.csv", "is not what this command writes"])


@pytest.mark.parametrize("width", [3.3, 3.5, 5.0, 7.0])
def test_a_table_fits_the_column_that_the_style_gives_it(width, monkeypatch):
    drawn = []
    monkeypatch.setattr(files, "_save", lambda figure, *_: drawn.append(figure))
    monkeypatch.setattr(files, "replace_files", lambda writers: next(iter(writers.values()))(None))
    data, style = table2.compute(OTHER), {"figure.figsize": (width, 3.0)}
    files.save_picture(lambda: table2.draw(data), Path("x.png"), style=style)
    (table,) = drawn[0].axes[0].tables
    assert table.get_window_extent().width <= width * drawn[0].dpi  # this places its cells
    cells = [each.get_window_extent() for each in table.get_celld().values()]
    assert min(each.x0 for each in cells) >= 0.0
    assert max(each.x1 for each in cells) <= width * drawn[0].dpi
    assert 5.0 <= table[0, 0].get_fontsize() <= 9.0


def test_the_font_size_of_a_style_is_that_of_all_letters(monkeypatch):
    sizes = []
    monkeypatch.setattr(files, "replace_files", lambda _: None)
    data = table2.compute(OTHER)

    def draw():
        sizes.append([mpl.rcParams[key] for key in ("axes.titlesize", "legend.fontsize")])
        return table2.draw(data)

    for style in ({"font.size": 4.5}, {"font.size": 4.5, "axes.titlesize": 7.0}):
        files.save_picture(draw, Path("x.png"), style=style)
    assert sizes == [[STYLE["axes.titlesize"] / 2.0, STYLE["legend.fontsize"] / 2.0], [7.0, 4.0]]


def test_a_table_that_would_be_illegible_is_refused(tmp_path):
    style = tmp_path / "mine.mplstyle"
    style.write_text("figure.figsize: 1.5, 3")
    words = "chart", "table2", "--style", style, "-o", tmp_path / "u.png"
    refused(words, ["the table needs a figure.figsize of", "in at least"])
    assert list(tmp_path.iterdir()) == [style]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("font.sizes: 9", "font.sizes"),
        ("font.size: large-ish", "font.size"),
        ("font.size", "Missing colon in file"),
        ("font.size: 9\nfont.size: 8", "Duplicate key in file"),
        ("figure.figsize: 0.5, 0.5", "Try making figure larger"),
        ("figure.figsize: 0, 0", "matplotlib cannot draw with it: divide by zero"),
        ("savefig.dpi: 1e9", "matplotlib cannot draw with it"),
        ("font.family: NoSuchFont", "Font family 'NoSuchFont' not found"),
    ],
)
def test_a_style_that_cannot_be_read_is_refused(tmp_path, text, why):
    style = tmp_path / "mine.mplstyle"
    style.write_text(text)
    words = "chart", "fig6", "--style", style, "-o", tmp_path / "x.png"
    message = refused(words, ["--style", why])
    assert message.count("\n") == 1
    assert list(tmp_path.iterdir()) == [style]


@pytest.mark.parametrize(
    ("name", "own", "why"),
    [
        (
            "fig5",
            ["indenter.shape=sphere", "support.mass=1 kg"],
            "holds for the parabola only",
        ),
        (
            "fig3",
            ["indenter.shape=sphere", "support.mass=1 kg"],
            "holds for the parabola only",
        ),
        ("fig6", ["drive.velocity=0 m/s"], "no place on a logarithmic axis"),
        ("fig4", ["drive.stiffness=1 MN/m^2"], "holds for a rigid drive only"),
        ("fig3", ["start.gap=5 mm"], "begins at rest at the static depth"),
        ("fig3", ['drive.velocity=["0.1 m/s", "1 m/s"]'], "a figure of the paper is for one scene"),
        ("table2", ['drive.velocity=["0.1 m/s", "1 m/s"]'], "for one scene"),
    ],
)
def test_a_scene_without_such_a_figure_is_refused(tmp_path, name, own, why):
    sets = [word for each in own for word in ("--set", each)]
    refused(("chart", name, *sets, "-o", tmp_path / "x.png"), [why])
    assert not list(tmp_path.iterdir())


def test_the_list_of_charts_says_what_each_figure_shows():
    assert "Draw Fig. 3: the onset of sliding" in run("chart", "--help").stdout


@pytest.mark.parametrize("missing", [True, False])
def test_where_numba_is_missing_it_is_said_before_the_wait(monkeypatch, capsys, missing):
    monkeypatch.setattr(every, "FIGURES", ())
    monkeypatch.setattr(every, "find_spec", lambda _: None if missing else object())
    monkeypatch.setattr(sys, "argv", ["figures"])
    every.main()
    assert ("several minutes" in " ".join(capsys.readouterr().err.split())) is missing


def test_a_failed_picture_leaves_nothing_behind(tmp_path):
    def draw(data):
        raise RuntimeError("no ink")

    with pytest.raises(RuntimeError, match="no ink"):
        drawing.produce("broken", lambda: SimpleNamespace(columns={}), draw, tmp_path / "out")
    assert not list(tmp_path.rglob("*.*"))


def test_stick_slip_cycles_close_and_grow_with_the_velocity(made):
    data, drawn, _ = made["stick_slip"]
    assert len(drawn.axes) == 5
    spans = []
    for x, v, depth in data.cycles.values():
        for values in (x, v, depth):
            assert values[0] == pytest.approx(values[-1], abs=0.02 * np.ptp(values))
        spans.append(np.ptp(x))
    assert spans == sorted(spans)
    amplitude = made["stick_slip_amplitude"][0].curves
    assert all(curve[1][0] == 0.0 < curve[1][-1] for curve in amplitude.values())


def test_ball_has_its_points_on_its_curve_and_the_pressure_of_its_footprints(made):
    data, drawn, _ = made["ball"]
    for support, (numbers, points) in data.points.items():
        curve = np.exp(np.interp(np.log(numbers), np.log(data.columns["V tau/a_0 [1]"]),
                                 np.log(data.curves[support, "ball"])))  # fmt: skip
        assert points == pytest.approx(curve, rel=1e-3)
    for found in data.footprints:
        l = found.retardation_length
        assert found.pressure(-min(l, 1.0), 0.0) == pytest.approx(1 + l * l if l < 1 else 2 * l)
    assert [ax.get_title() for ax in drawn.axes[:2]] == ["given depth", "dead weight"]


def test_pressure_of_a_ball_has_the_peak_that_its_series_reports(made):
    data, drawn, _ = made["ball_pressure"]
    script = importlib.import_module("figures.ball_pressure")
    for found in data.results.values():
        for time in (0.0, 1e-3, 0.1):
            row = int(np.argmin(np.abs(found.time - time)))
            x = np.linspace(found.leading_edge[row], found.trailing_edge[row], 5)
            p = found.pressure(x, time)
            assert p.max() == pytest.approx(found.peak_pressure[row], rel=1e-2)
            assert p[-1] == pytest.approx(0.0, abs=1e-2 * p.max())
    assert [ax.get_title() for ax in drawn.axes[:2]] == list(script.TITLES.values())


def test_the_peak_is_that_of_the_fixed_indenter_and_no_inertia_changes_it(made):
    data, _, _ = made["onset_maps"]
    scene = kv.Scene()
    own = StaticState.of(scene)
    velocity = onset_maps.NUMBERS * own.half_length / scene.foundation.retardation_time
    over = {"drive.velocity": velocity}
    at_depth = kv.Scene(support=kv.Fixed(depth=own.depth))
    peak = kv.steady(at_depth, over=over).friction_force
    ratio = peak / kv.steady(scene, over=over).friction_force
    assert data.ratio == pytest.approx(np.tile(ratio, (onset_maps.INERTIAS.size, 1)), rel=1e-9)


def test_hops_and_settling_come_with_speed_and_mass_as_the_maps_show(made):
    data, drawn, _ = made["onset_maps"]
    assert not data.hops[:, onset_maps.NUMBERS < 1.0].any()
    assert data.hops[-1, -1] > 1
    assert (data.hops[0] <= 1).all()
    at_once, later = data.settling == 0.0, np.isnan(data.settling)
    assert at_once[:, onset_maps.NUMBERS < 0.1].all()
    assert not at_once[:, onset_maps.NUMBERS > 0.2].any()
    inertia, number = np.meshgrid(onset_maps.INERTIAS, onset_maps.NUMBERS, indexing="ij")
    assert (number * inertia)[later].min(initial=np.inf) > 5.0
    assert data.columns["settling_time/tau [1]"].count("later") == later.sum() > 0
    for ax, values in ((0, data.ratio), (2, data.hops)):
        assert np.array_equal(drawn.axes[ax].collections[0].get_array(), values)


def test_on_rubber_sliding_starts_without_the_first_peak_of_kelvin_voigt(made):
    """All end in steady sliding, which is dotted."""
    data, drawn, _ = made["rubber_start"]
    for support, found in data.starts.items():
        plain, *others = found.values()
        assert plain.normal_force[0] == plain.normal_force.max() > 3.5e4
        for each in others:
            assert each.friction_force[0] == pytest.approx(0.0, abs=1e-9)
            assert each.normal_force[0] < 0.3 * plain.normal_force[0]
            assert each.friction_force.max() < 0.6 * plain.friction_force[0]
        for name, each in found.items():
            friction = data.ends[support][name].friction_force
            assert each.friction_force[-1] == pytest.approx(float(friction), rel=2e-3)
    kinds = importlib.import_module("figures.rubber_start").foundations().values()
    assert [each.slow_damping for each in kinds] == pytest.approx([1e9, 1e9, 1e9])
    assert len(drawn.axes) == 6
