"""How results show themselves: text, tables for notebooks, pictures and files."""

import csv

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import STEADY_UNITS, TRANSIENT_UNITS

V = {"drive.velocity": np.geomspace(1e-3, 1.0, 7)}
RESULTS = {
    "one state": kv.steady,
    "many states": lambda: kv.steady(over=V),
    "transient": lambda: kv.transient(at=["0 ms", "1 ms", "200 ms"]),
    "solution": kv.solve,
    "solution over time": lambda: kv.solve(at=["0 ms", "1 ms"], rtol=1e-2),
    "simulation": lambda: kv.elements(at=["0 ms", "1 ms"], per_length="50 /mm", certify=False),
}


@pytest.fixture(params=RESULTS, scope="module")
def result(request):
    return RESULTS[request.param]()


def test_text_and_table_are_short_and_name_quantities_units_model_and_error(result):
    lines, html = repr(result).splitlines(), result._repr_html_()
    assert len(lines) <= 10
    assert max(map(len, lines)) <= 110
    assert result.model in lines[0]
    errors = result.certificate
    assert (errors.statement if errors.kind == "none" else errors.relative_to) in lines[-1]
    assert "friction_force" in repr(result)
    units = TRANSIENT_UNITS if hasattr(result, "time") else STEADY_UNITS
    assert html.count("<tr>") == 1 + len(units)
    assert all(f"<td>{name}</td>" in html for name in units)
    assert "N/mm" in html
    assert result.certificate.statement.split(",")[0][:30] in html.replace("&quot;", '"')


def test_a_result_without_errors_says_so():
    result = kv.steady(method="asymptote")
    assert "Errors are not estimated" in str(result)
    assert "errors up to" not in str(result)
    assert "Errors are not estimated" in result._repr_html_()


def test_files_hold_what_the_result_holds(result, tmp_path):
    """CSV, NetCDF and `Dataset`: first what varies, then the quantities."""
    import xarray

    for name in ("result.csv", "result.NC"):
        result.save(tmp_path / name)
    result.to_csv(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == (tmp_path / "result.csv").read_text()
    units = TRANSIENT_UNITS if hasattr(result, "time") else STEADY_UNITS
    held = dict(result.over) | {name: getattr(result, name) for name in units}
    with (tmp_path / "result.csv").open(newline="") as file:
        head, *rows = list(csv.reader(file))
    assert head == [f"{name} [{result.units[name]}]" for name in held]
    data = result.to_xarray()
    for (name, values), column in zip(held.items(), np.array(rows, dtype=float).T, strict=True):
        assert np.array_equal(column, np.ravel(values))
        assert np.array_equal(data[name], values)
        assert data[name].attrs["units"] == result.units[name]
        assert (name in data.coords) == (name == "time" or name in result.over)
    with xarray.open_dataset(tmp_path / "result.NC", decode_times=False) as read:
        assert read.identical(data)
    with pytest.raises(ValueError, match=r"\.csv or \.nc"):
        result.save(tmp_path / "result.xlsx")
    assert len(list(tmp_path.iterdir())) == 3


def test_steady_sliding_is_drawn_as_a_curve_or_as_its_pressure():
    state = kv.steady(over=V)
    (line,) = state.plot().axes[0].lines
    assert line.get_ydata() == pytest.approx(state.friction_coefficient)
    assert line.get_xdata() == pytest.approx(V["drive.velocity"] * 1e3)
    assert line.axes.get_xlabel() == "drive velocity $V$ [mm/s]"
    for velocity in ("50 mm/s", "-50 mm/s", "1 mm/s"):
        single = kv.steady(over={"drive.velocity": velocity})
        x, p = single.plot().axes[0].lines[0].get_data()
        assert p.max() == pytest.approx(single.peak_pressure / 1e6, rel=1e-3)
        edges = sorted((single.leading_edge * 1e3, single.trailing_edge * 1e3))
        assert sorted((x[0], x[-1])) == pytest.approx(edges)
        at_trailing = p[np.argmin(np.abs(x - single.trailing_edge * 1e3))]
        assert abs(at_trailing) < 1e-9 * p.max()
    with pytest.raises(ValueError, match="parabola and for a ball"):
        kv.steady(kv.Scene(indenter=kv.Wedge(0.1))).plot()


SPEEDS, TIMES, RADII = (np.linspace(1.0, 2.0, n) for n in (12, 9, 3))
MU = "friction"


@pytest.mark.parametrize(
    ("over", "axes"),
    [
        ({"foundation.retardation_time": TIMES}, ("retardation time", MU)),
        ({"indenter.radius": RADII, "drive.velocity": RADII}, ("drive velocity", MU)),
        ({"drive.velocity": SPEEDS[:, None], "indenter.radius": RADII}, ("drive velocity", MU)),
        ({"foundation.retardation_time": TIMES[:, None], "drive.velocity": SPEEDS},
         ("drive velocity", "retardation time")),
        ({"drive.velocity": RADII + 0.1 * RADII[:, None]}, None),
        ({"drive.velocity": np.empty(0)}, None),
        ({"drive.velocity": np.ones((2, 2, 2)) * RADII[:2]}, None),
    ],
)  # fmt: skip
def test_steady_sliding_is_drawn_over_what_varies(over, axes):
    state = kv.steady(over=over)
    if axes is None:
        with pytest.raises(ValueError, match=r"form a table|empty"):
            state.plot()
        return
    ax = state.plot().axes[0]
    assert (ax.get_xlabel()[: len(axes[0])], ax.get_ylabel()[: len(axes[1])]) == axes


@pytest.mark.parametrize("velocity", ["50 mm/s", "-5 mm/s", "0 mm/s", "3 m/s"])
def test_the_pressure_of_a_ball_is_that_of_its_middle_plane(velocity):
    ball = kv.Sphere("10 mm", radius_across="20 mm")
    rest = {"support": kv.Fixed("0.1 mm"), "drive": kv.Drive(velocity)}
    scene = kv.Scene(indenter=ball, **rest)
    ax = kv.steady(scene).plot().axes[0]
    x, p = ax.lines[0].get_data()
    assert "middle plane" in ax.get_ylabel()
    inside = slice(1, -1)
    truth = kv.footprint(scene).pressure(x[inside] * 1e-3, 0.0) * 1e-6
    assert p[inside] == pytest.approx(truth, rel=1e-9, abs=1e-12)
    refused = [kv.Scene(indenter=kv.Revolved(kv.Wedge(0.1)), **rest)]
    if scene.drive.velocity:  # at rest all foundations are springs
        rubber = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"]])
        refused.append(kv.Scene(ball, rubber, **rest))
    for other in refused:
        with pytest.raises(ValueError, match="give several velocities"):
            kv.steady(other).plot()


def test_a_series_is_drawn_as_in_figure_3_and_a_notebook_shows_it_without_pyplot():
    low, high = kv.transient(kv.Scene(drive=kv.Drive(1e-12))).plot().axes[1].get_ylim()
    assert high - low > 0.01  # mm: rounding is not drawn
    held = kv.Scene(drive=kv.Drive(0.1, stiffness=1e6))
    alone = kv.solve(held, quantity="spring_force", at=[0.0, 0.01], rtol=0.1).plot()
    assert [ax.get_ylabel()[1] for ax in alone.axes] == ["V", "F"]
    figure = kv.transient(at="0 ms:20 ms:21").plot()
    assert len(figure.axes) == 4
    assert figure.axes[1].lines[0].get_ydata()[-1] < 0.0  # z_A in mm
    turned = kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.01, 0.1), (0.01, -0.1)]))
    t, V = kv.transient(turned, at="0 ms:20 ms:3").plot().axes[0].lines[0].get_data()
    assert set(V.round(9)) == {0.0, 100.0, -100.0}
    assert 0.0 < t[V < 0.0].min() - t[V > 0.0].max() < 1e-9  # ms: a jump is drawn as one
    assert np.diff(t).max() < 2.0  # between the times that were asked for, too
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_comparison_shows_itself(tmp_path):
    run = kv.transient(at=np.linspace(0, 0.2, 50), certify=False)
    for factor in (1.0, 1.5):
        data = {"time": run.time, "depth": factor * run.depth}
        found = kv.compare(data=data)
        assert found.verdict == ("agrees" if factor == 1.0 else "disagrees")
        lines = repr(found).splitlines()
        assert len(lines) <= 10
        assert found.verdict in lines[0]
        assert found.diagnosis == lines[1]
        assert found._repr_html_().count("<tr>") == 1 + len(found.checks)
        assert found.plot() is not None
        held = found.to_xarray()
        for kind, values in ("data", data), ("theory", found.theory), ("allowed", found.allowed):
            assert np.array_equal(held[f"depth, {kind}"], values["depth"])
        found.to_csv(tmp_path / "compared.csv")
        head, *rows = (tmp_path / "compared.csv").read_text().splitlines()
        assert head.startswith('time [s],"depth, data [m]","depth, theory [m]","depth, allowed')
        assert len(rows) == 50
        assert found.as_dict().keys().isdisjoint({"series", "theory", "allowed", "units"})


@pytest.mark.parametrize(("at", "title"), [
    (["1 ms", "5 ms", "10 ms"], "Transient by continuum, 3 times up to 10 ms"),
    (["2 ms"], "Transient by continuum, 1 times up to 2 ms"),
])  # fmt: skip
def test_the_title_of_a_series_tells_its_last_time(at, title):
    assert str(kv.transient(at=at, certify=False)).splitlines()[0] == title
