"""Prony series from measured moduli: reading, fitting, shifting, and the scene that is written."""

import re
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.fitting import foundation, moduli, shifting, spectrum
from kvtheory.fitting.spectrum import Moduli, Series
from kvtheory.plots.fits import draw_fit
from kvtheory.sweeps.plan import REMARKS
from tests.commands import printed, refused, run

DMA = Path(__file__).parents[1] / "docs" / "data" / "dma"
TRUE = Series(1e6, np.array([5e6, 3e6, 1e6]), np.array([1e-4, 1e-2, 0.5]))
OMEGA = np.geomspace(0.05, 1e5, 60)


def measured(series, omega, noise, rng, lift=0.0):
    """Return storage and loss moduli with noise, 10^lift times those of a series."""
    values = series.values(omega, dynamic=True) * 10.0**lift
    return values * (1.0 + noise * rng.standard_normal(values.shape))


def dynamic(noise=0.0, seed=1, series=TRUE, omega=OMEGA):
    noisy = measured(series, omega, noise, np.random.default_rng(seed))
    return {"omega [rad/s]": omega, "E' [Pa]": noisy[0], "E'' [Pa]": noisy[1]}


def written(tmp_path, text, name="data.csv", encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


NUMBERS = [(0.1, 2.0, 0.2), (1.0, 3.0, 0.6), (10.0, 5.0, 0.9), (100.0, 6.0, 0.3), (1e3, 6.5, 0.1)]
"""Frequency in Hz, storage and loss modulus in MPa."""


def table(form, order=1):
    """Return a line for each row of NUMBERS, written by a template of f, E, L (MPa), omega, tan and i."""
    return "".join(
        form.format(f=f, E=E, L=L, omega=repr(2 * np.pi * f), tan=repr(L / E), i=i) + "\n"
        for i, (f, E, L) in enumerate(NUMBERS[::order])
    )


ROWS = table("{f:g},{E:g},{L:g}")
GERMAN = table("{f:g};{E:g};{L:g}").replace(".", ",")
TRIOS = (
    "Filename\tC:\\TA\\sample.tri\nInstrument name\tDMA850\nnumber of points\t5\n\n"
    "[step]\nFrequency sweep - 1\n"
    "Angular frequency\tStorage modulus\tLoss modulus\tTan(delta)\tTemperature\tStep time\n"
    "rad/s\tMPa\tMPa\t\t°C\ts\n"
)
RHEOCOMPASS = (
    "Project:\tRubber\nTest:\tsweep\n\nInterval and data points:\t1\t5\n"
    "Interval data:\tPoint No.\tAngular Frequency\tStorage Modulus\tLoss Modulus\tLoss Factor\n"
    "\t\t\t\t\t\n\t\t[rad/s]\t[Pa]\t[Pa]\t[1]\n\n"
)
FILES = {
    "two rows": "f, E_stor, E_loss\nHz, MPa, MPa\n" + ROWS,
    "brackets": "f [Hz];E' [MPa];E'' [MPa]\n" + GERMAN,
    "slashes": "f/Hz\tE'/MPa\tE''/MPa\n" + GERMAN.replace(";", "\t"),
    "bracketed units below": "Frequency;E';E''\n[Hz];[MPa];[MPa]\n" + GERMAN,
    "mark and comments": "\ufeff# sample 7\nf,E′,E″\nHz,MPa,MPa\n# begin\n" + ROWS,
    "double quotes": '"f [Hz]","E\' [MPa]","E\'\' [MPa]"\n' + ROWS,
    "inch mark": "f [Hz];E' [MPa];E\" [MPa]\n" + GERMAN,
    "other units": "f [kHz],E' [GPa],E'' [kPa]\n" + table("{f:g}e-3,{E:g}e-3,{L:g}e3"),
    "tan delta": "f [Hz],E' [MPa],tan δ\n" + table("{f:g},{E:g},{tan}"),
    "unsorted": "f [Hz],E'' [MPa],E' [MPa]\n" + table("{f:g},{L:g},{E:g}", -1),
    "rows twice": "f [Hz],E' [MPa],E'' [MPa]\n" + ROWS + ROWS,
    "both frequencies": (
        "f [Hz],omega [rad/s],E' [MPa],E'' [MPa],tan(delta)\n"
        + table("{f:g},{omega},{E:g},{L:g},{tan}")
    ),
    "TRIOS": TRIOS + table("{omega}\t{E:g}\t{L:g}\t{tan}\t23.0{i}\t{i}"),
    "RheoCompass": RHEOCOMPASS + table("\t{i}\t{omega}\t{E:g}e6\t{L:g}e6\t{tan}"),
}


@pytest.mark.parametrize("name", FILES)
def test_exports_of_instruments_are_read_alike(tmp_path, name):
    encodings = ("utf-8", "utf-16") if name == "RheoCompass" else ("utf-8",)
    modulus = "E" if name in {"TRIOS", "RheoCompass"} else None
    for encoding in encodings:
        found = moduli.read(written(tmp_path, FILES[name], encoding=encoding), modulus)
        (sweep,) = found.sweeps
        assert found.kind == "E"
        assert sweep.moduli.x == pytest.approx([2 * np.pi * f for f, _, _ in NUMBERS])
        assert sweep.moduli.values[0] == pytest.approx([1e6 * a for _, a, _ in NUMBERS])
        assert sweep.moduli.values[1] == pytest.approx([1e6 * b for _, _, b in NUMBERS])


HEAD = "f [Hz],E' [MPa],E'' [MPa]\n"
BAD = {
    "not a number": (HEAD + ROWS + "9,x,1\n", 'line 7, column "E\' [MPa]": "x" is not a number'),
    "empty cell": (HEAD + "9,,1\n" + ROWS, 'line 2, column "E\' [MPa]": the cell is empty'),
    "nan": (HEAD + ROWS + "9,1,nan\n", "line 7, column \"E'' [MPa]\": nan is not a finite number"),
    "negative": (HEAD + "9,-1,1\n" + ROWS, 'line 2, column "E\' [MPa]": -1 is not above 0'),
    "negative loss": (HEAD + "9,1,-2\n" + ROWS, "line 2, column \"E'' [MPa]\": -2 is negative"),
    "huge frequency": (
        HEAD + ROWS + "1e300,7,1\n",
        'line 7, column "f [Hz]": 1e+300 is not plausible',
    ),
    "tiny frequency": (
        HEAD + "1e-300,1,1\n" + ROWS,
        'line 2, column "f [Hz]": 1e-300 is not plausible',
    ),
    "huge modulus": (HEAD + ROWS + "1e4,1e300,1\n", 'column "E\' [MPa]": 1e+300 is not plausible'),
    "tiny modulus": (
        HEAD + "1e-3,1e-300,1\n" + ROWS,
        'column "E\' [MPa]": 1e-300 is not plausible',
    ),
    "huge loss": (HEAD + ROWS + "1e4,7,1e300\n", "column \"E'' [MPa]\": 1e+300 is not plausible"),
    "huge tan delta": (
        "f [Hz],E' [MPa],tan δ\n" + table("{f},{E},{i}e300"),
        'column "tan δ": 1e+300 is not plausible',
    ),
    "another tan delta": (
        "f [Hz],E' [MPa],E'' [MPa],tan δ\n" + table("{f},{E},0.1,{tan}"),
        "column \"tan δ\": is 3 times E'' over E' (median of the rows); leave out the column that is wrong",
    ),
    "huge time": (
        "t [s],E(t) [MPa]\n1,4\n2,3\n4,2\n1e300,1\n",
        'column "t [s]": 1e+300 is not plausible',
    ),
    "huge temperature": (
        "f [Hz],E' [MPa],E'' [MPa],T [C]\n" + table("{f},{E},{L},1e300"),
        "1e+300 is not plausible",
    ),
    "zero frequency": (HEAD + "0,1,1\n" + ROWS, 'line 2, column "f [Hz]": 0 is not above 0'),
    "two rows": (HEAD + "1,2,1\n2,3,1\n", "2 rows; at least 4"),
    "one frequency": (HEAD + "1,2,1\n1,3,1\n1,4,1\n1,5,1\n", "at different frequencies"),
    "no loss": (HEAD + "1,2,0\n2,2,0\n3,2,0\n4,2,0\n", "without loss there is nothing to fit"),
    "no header": (ROWS, "line 1 holds numbers, and no row above it names the columns"),
    "unknown": ("a,b,c\n" + ROWS, 'line 1, "a,b,c": has no column that is known'),
    "misspelt": (HEAD.replace("f", "freqency") + ROWS, '"freqency [Hz]" may be "frequency"'),
    "two marks": (
        HEAD.replace(",", ";") + "1;1,5;0,2\n2;1.6;0.2\n",
        "a comma in line 2 and a point in line 3",
    ),
    "comma twice": (HEAD + "1,0,1,5,0,2\n", "are there decimal commas"),
    "empty": ("", "is empty; expected"),
    "no unit": ("f [Hz],E',E''\n" + ROWS, 'column "E\'": has no unit'),
    "wrong unit": ("f [Hz],E' [mm],E'' [MPa]\n" + ROWS, "expected a quantity in N/m^2"),
    "frequency in 1/s": (
        "f [1/s],E' [MPa],E'' [MPa]\n" + ROWS,
        'unit "1/s", which may mean Hz or rad/s; expected Hz',
    ),
    "omega in Hz": (
        "omega [Hz],E' [MPa],E'' [MPa]\n" + ROWS,
        'unit "Hz", which may mean Hz or rad/s; expected rad/s',
    ),
    "unknown kind": ("f [Hz],storage modulus [MPa],loss modulus [MPa]\n" + ROWS, "may be E or G"),
    "mixed": ("f [Hz],E' [MPa],G'' [MPa]\n" + ROWS, "not of the same kind"),
    "twice": ("f [Hz],E' [MPa],E_stor [MPa],E'' [MPa]\n", "both the E'"),
    "two units": ("f [Hz],E' [MPa],E'' [MPa]\nHz,GPa,MPa\n" + ROWS, 'and "GPa" below it'),
    "no temperature": (
        "f [Hz],E' [MPa],E'' [MPa],T [C]\n" + table("{f},{E},{L},20") + "1,2,1,\n",
        'line 7, column "T [C]": the cell is empty',
    ),
    "drifting temperature": (
        "f [Hz],E' [MPa],E'' [MPa],T [C]\n" + table("{f},{E},{L},{i}"),
        "drifts from",
    ),
    "disagreeing frequencies": (
        "f [Hz],omega [rad/s],E' [MPa],E'' [MPa]\n" + table("{f},{f},{E},{L}"),
        "is not the angular frequency",
    ),
    "liquid": (
        "t [s],E(t) [MPa]\n1,0.36788\n2,0.13534\n4,0.018316\n8,3.3546e-4\n",
        "relax to zero",
    ),
    "stiffening": ("t [s],E(t) [MPa]\n1,1\n10,2\n100,3\n1000,4\n", "the moduli do not relax"),
    "constant": ("t [s],E(t) [MPa]\n1,1\n10,1\n100,1\n1000,1.0\n", "the moduli do not relax"),
    "softening": (HEAD + "1,5,1\n10,4,1\n100,3,1\n1e3,2,1\n1e4,1,1\n", "or stiffen as they relax"),
}


@pytest.mark.parametrize("name", BAD)
def test_doubtful_data_are_refused_with_column_and_line(tmp_path, name):
    text, told = BAD[name]
    with pytest.raises(ValueError, match=re.escape(told)):
        kv.fit_foundation(written(tmp_path, text))


def test_a_known_series_is_found_with_as_many_arms():
    found = kv.fit_foundation(dynamic(), thickness="2 mm", poisson_ratio=0.3)
    assert np.array(found.arms) == pytest.approx(
        np.column_stack([TRUE.modulus, TRUE.time]), rel=1e-5
    )
    assert found.modulus == pytest.approx(1e6, rel=1e-5)
    assert found.misfit < 1e-5
    assert found.notes == ()
    t = np.geomspace(1e-5, 10.0, 80)
    relaxing = {"t [s]": t, "E(t) [MPa]": TRUE.values(t, dynamic=False)[0] / 1e6}
    again = kv.fit_foundation(relaxing)
    assert np.array(again.arms) == pytest.approx(np.array(found.arms), rel=1e-4)


@pytest.mark.parametrize("noise", [0.003, 0.02, 0.05])
def test_noise_adds_no_arms_and_the_misfit_is_the_noise(noise):
    for seed in range(2):
        found = kv.fit_foundation(dynamic(noise, seed))
        assert len(found.arms) == 3, (seed, found.arms)
        assert found.least_misfit <= found.misfit < 1.2 * noise
        assert found.notes == ()
        assert np.array(found.arms) == pytest.approx(
            np.column_stack([TRUE.modulus, TRUE.time]), rel=5 * noise
        )


def test_times_are_half_a_decade_beyond_the_data_at_most():
    """2 ms and 200 s, seen from 10 ms to 1 s only."""
    series = Series(1e6, np.array([5e6, 3e6]), np.array([2e-3, 200.0]))
    found = kv.fit_foundation(dynamic(series=series, omega=np.geomspace(1.0, 100.0, 30)))
    assert [tau for _, tau in found.arms] == pytest.approx([10.0**-2.5, 10.0**0.5], rel=1e-5)


def test_the_picture_names_the_temperatures_and_the_marks():
    data, _ = wlf_sweeps(0.01)
    data["T [C]"] = np.round(data["T [C]"], -1) - 1e-14
    axes = draw_fit(kv.fit_foundation(data)).axes
    assert axes[0].get_title() == "measured at -10 to 50 °C (light)"
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["storage", "loss"]


def test_no_series_is_better_than_the_dual_bound_and_the_best_is_close_to_it():
    rng = np.random.default_rng(3)
    for seed in range(3):
        x, series = (
            np.geomspace(1e-3, 1e3, 25),
            Series(1.0, rng.uniform(0, 4, 5), 10.0 ** rng.uniform(-3, 3, 5)),
        )
        values = series.values(x, dynamic=True) * rng.uniform(0.8, 1.25, (2, x.size))
        data = Moduli(x, values)
        found, least = spectrum.best(data)
        for _ in range(20):
            times = np.sort(10.0 ** rng.uniform(-5, 5, rng.integers(1, 60)))
            assert spectrum.solved(data, times).misfit(data) >= least
        assert least <= found.misfit(data) <= 1.03 * least, seed


def test_arms_and_rtol_choose_the_number_of_arms():
    data = dynamic(0.02)
    assert len(kv.fit_foundation(data, arms=2).arms) == 2
    assert len(kv.fit_foundation(data, rtol=0.4).arms) < 3
    with pytest.raises(ValueError, match="the least misfit of any is 0"):
        kv.fit_foundation(data, rtol=0.005)
    assert "arms fit best; 50 would be no better" in kv.fit_foundation(data, arms=50).notes[0]


def test_moduli_that_no_series_fits_are_told_with_where():
    data = dynamic(0.005)
    hump = 1.0 + 0.5 * np.exp(-(np.log(OMEGA / 300.0) ** 2))
    bad = kv.fit_foundation(data | {"E'' [Pa]": data["E'' [Pa]"] * hump})
    (note,) = bad.notes
    assert "Kramers-Kronig" in note
    assert "The loss modulus is off most from" in note


def wlf_sweeps(noise, vertical=0.0):
    """Return sweeps at seven temperatures, and log10 a_T relative to 20 degC."""
    law = shifting.Law("wlf", (8.0, 120.0))
    parts, rng = [], np.random.default_rng(5)
    for T in np.arange(-10.0, 60.0, 10.0):
        f = np.geomspace(0.1, 100.0, 16)
        omega = 2.0 * np.pi * f * 10.0 ** law.log_shift(T, 20.0) * 30.0
        values = measured(TRUE, omega, noise, rng, vertical * (T - 20.0))
        parts.append(np.vstack([f, values, T + rng.uniform(-0.2, 0.2, f.size)]))
    whole = np.hstack(parts)[:, rng.permutation(7 * 16)]
    return dict(zip(("f [Hz]", "E' [Pa]", "E'' [Pa]", "T [C]"), whole, strict=True)), law


def test_sweeps_shift_to_the_master_curve_and_wlf_is_found():
    data, law = wlf_sweeps(0.01)
    found = kv.fit_foundation(data, temperature="22 degC", thickness="2 mm", poisson_ratio=0.3)
    T, shift = np.array(found.shift_factors).T
    errors = np.array(found.shift_errors)
    assert np.abs(shift - law.log_shift(T, 20.0)).max() < 0.15
    assert np.all(np.abs(shift - law.log_shift(T, 20.0)) < 3.0 * errors + 0.03)
    assert found.shift_law.startswith("WLF")
    assert len(found.arms) == 3
    assert found.arms[1][1] == pytest.approx(0.3, rel=0.05)
    assert found.foundation.shift_factor == pytest.approx(
        10.0 ** law.log_shift(22.0, 20.0), rel=0.1
    )


@pytest.mark.parametrize(("last", "notes"), [(-2.505, 1), (-1.9, 0)])
def test_a_law_that_misses_a_shift_factor_is_noted(last, notes):
    """The first shift factors fall ever faster, as those of no WLF law do; the others obey Arrhenius' law."""
    T = np.array([273.15, 293.15, 333.15])
    master = SimpleNamespace(
        temperatures=T,
        log_shift=np.array([1.2, 0.0, last]),
        errors=np.full(3, 0.01),
        reference=T[1],
    )
    found = foundation._about_shifts(master, shifting.law_of(master))
    assert len(found) == notes
    assert all("Arrhenius misses the shift factor at" in note for note in found)


def swept(law, omega, T, noise=0.0, seed=0, lift=0.0, series=TRUE):
    """Return moduli at temperatures in degrees Celsius, and log10 a_T relative to the one in the middle."""
    rng, middle = np.random.default_rng(seed), T[len(T) // 2]
    shifts = law.log_shift(np.array(T) + 273.15, middle + 273.15)
    rows = []
    for each, shift in zip(T, shifts, strict=True):
        values = measured(series, omega * 10.0**shift, noise, rng, lift * (each - middle))
        rows.append(np.vstack([omega, values, np.full(omega.size, each)]))
    names = "w [rad/s]", "E' [Pa]", "E'' [Pa]", "T [degC]"
    return dict(zip(names, np.hstack(rows), strict=True)), shifts


WLF = shifting.Law("wlf", (8.86, 101.6))


def test_errors_of_shifts_cover_where_sweeps_hardly_overlap():
    """Three decades each, 2.9 apart: log-linear interpolation is off by 0.09."""
    series = Series(1000.0, np.array([4000.0, 800.0]), np.array([2e-3, 0.1]))
    data, shifts = swept(WLF, np.geomspace(0.628, 628.0, 16), [0.0, 25.0, 50.0], series=series)
    found = kv.fit_foundation(data)
    off = np.abs(np.array(found.shift_factors)[:, 1] - shifts)
    assert (off <= 2.0 * np.array(found.shift_errors)).all()
    assert off.max() < 5e-3
    assert not any("Kramers" in note for note in found.notes)


def test_errors_of_shifts_cover_the_truth_for_few_points():
    within = []
    for seed in range(6):
        omega = np.geomspace(1.0, 300.0, 5 + seed % 3 * 5)
        data, shifts = swept(WLF, omega, [0.0, 10.0, 20.0, 30.0], 0.02, seed)
        found = shifting.shifted(moduli.read(data).sweeps, 293.15, None, vertical=False)
        off = np.abs(found.log_shift - shifts)[found.errors > 0.0]
        within += (off < 2.0 * found.errors[found.errors > 0.0]).tolist()
    assert np.mean(within) > 0.9


def test_vertical_shifts_are_proposed_where_they_are():
    for lift in (0.0, 0.01):
        data, _ = swept(
            WLF, np.geomspace(0.3, 300.0, 16), [0.0, 10.0, 20.0, 30.0], 0.005, lift=lift
        )
        notes = "".join(kv.fit_foundation(data).notes)
        assert ("Try `vertical`" in notes) == (lift > 0.0)
        assert "Kramers" not in notes


def test_reversed_shift_factors_are_recognised():
    T = [0.0, 20.0, 40.0]
    data, shifts = swept(WLF, np.geomspace(0.3, 300.0, 16), T, 0.01)
    kv.fit_foundation(data, shift_factors={"T [degC]": T, "log_aT": shifts})
    with pytest.raises(ValueError, match="are reversed"):
        kv.fit_foundation(data, shift_factors={"T [degC]": T, "log_aT": -shifts})


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.1])
def test_a_liquid_has_no_relaxed_modulus_whatever_the_noise(noise):
    liquid = Series(0.0, np.array([1e5, 5e5]), np.array([1.0, 1e-2]))
    with pytest.raises(ValueError, match="relax to zero within the data"):
        kv.fit_foundation(dynamic(noise, 2, liquid, np.geomspace(0.01, 1e3, 40)))
    for seed in range(4):  # of some, a series has a spring by chance
        with pytest.raises(ValueError, match="relax to zero within the data"):
            kv.fit_foundation(dynamic(noise, seed, liquid, np.geomspace(0.01, 1e3, 41)))
    solid = Series(1e4, liquid.modulus, liquid.time)
    assert not kv.fit_foundation(dynamic(noise, 2, solid, np.geomspace(0.01, 1e3, 40))).notes


def test_a_loss_of_a_thousandth_of_the_modulus_tells_the_shifts():
    """On the plateau of a rubber the storage modulus is nearly constant, and tells none."""
    rng, law = np.random.default_rng(1), shifting.Law("wlf", (8.86, 101.6))
    times, rows = 10.0 ** np.arange(-8.0, 2.1, 0.5), []
    arms = 60e6 * 10.0 ** (-0.28 * np.arange(times.size))
    for T in np.arange(-20.0, 61.0, 10.0):
        for f in np.geomspace(0.1, 50.0, 10):
            x = 2j * np.pi * f * 10.0 ** law.log_shift(T, 20.0) * times
            E = 1.8e6 + (arms * x / (1.0 + x)).sum()
            rows.append((T, f, *(E.real, E.imag) * (1.0 + 0.01 * rng.standard_normal(2))))
    names = "T [degC]", "f [Hz]", "E' [Pa]", "E'' [Pa]"
    found = kv.fit_foundation(dict(zip(names, np.transpose(rows), strict=True)))
    T, shift = np.array(found.shift_factors).T
    assert shift == pytest.approx(law.log_shift(T, 20.0), abs=0.02)
    assert found.misfit < 0.02
    assert not any("Kramers" in remark for remark in found.remarks)


def test_moduli_shift_vertically_if_allowed():
    data, law = wlf_sweeps(0.003, vertical=0.004)
    found = kv.fit_foundation(data, temperature=293.15, vertical=True)
    T, shift = np.array(found.shift_factors).T
    assert np.abs(shift - law.log_shift(T, 20.0)).max() < 0.1
    assert found.misfit < 0.5 * kv.fit_foundation(data, temperature=293.15, arms=3).misfit
    with pytest.raises(ValueError, match="vertical"):
        kv.fit_foundation({"t [s]": OMEGA, "E(t) [Pa]": 1.0 + 1.0 / OMEGA}, vertical=True)


def test_given_shift_factors_are_used_and_arrhenius_is_found(tmp_path):
    data, _ = wlf_sweeps(0.01)
    T = np.arange(-10.0, 60.0, 10.0)
    law = shifting.Law("arrhenius", (9e4,))
    text = "".join(f"{t:g};{law.log_shift(t + 273.15, 293.15):.6f}\n".replace(".", ",") for t in T)
    path = written(tmp_path, "\ufeffT;log_aT\nC;-\n" + text)
    found = kv.fit_foundation(data, shift_factors=path, arms=4)
    assert "Arrhenius: E_a = 90" in found.shift_law
    assert found.shift_factors[0] == pytest.approx((-10.0, law.log_shift(263.15, 293.15)), abs=0.3)
    with pytest.raises(ValueError, match="no temperature with a_T = 1"):
        kv.fit_foundation(data, shift_factors={"T [degC]": T, "log_aT": T + 100.0})
    for name, far in (("log_aT", -400.0 * np.sign(T - 20.0)), ("a_T", 10.0 ** (-7.0 * (T - 20.0)))):
        with pytest.raises(
            ValueError, match=rf'column "{name}": .* expected log10 a_T from -30 to 30'
        ):
            kv.fit_foundation(data, shift_factors={"T [degC]": T, name: far})
    with pytest.raises(ValueError, match="has none for"):
        kv.fit_foundation(data, shift_factors={"T [degC]": T[:-1], "log_aT": 20.0 - T[:-1]})


def test_shear_moduli_need_poissons_ratio_and_stiffnesses_no_layer():
    data = dynamic()
    shear = {key.replace("E", "G"): values for key, values in data.items()}
    with pytest.raises(ValueError, match="poisson_ratio"):
        kv.fit_foundation(shear)
    assert kv.fit_foundation(shear, poisson_ratio=0.25).modulus == pytest.approx(2.5e6, rel=1e-5)
    per_area = {key.replace("[Pa]", "[N/m^3]"): values for key, values in data.items()}
    found = kv.fit_foundation(per_area)
    assert found.modulus is None
    assert found.foundation.stiffness == found.stiffness == pytest.approx(1e6, rel=1e-5)
    with pytest.raises(ValueError, match="give `thickness` and `poisson_ratio`"):
        _ = kv.fit_foundation(data).foundation


@pytest.mark.parametrize("name", ["freq_user_master", "time_user_raw"])
def test_the_sample_data_are_fitted_to_their_scatter(name):
    found = kv.fit_foundation(DMA / f"{name}.csv")
    assert found.least_misfit <= found.misfit <= 1.13 * found.least_misfit
    assert ("Kramers-Kronig" in "".join(found.notes)) == (name == "freq_user_master")


def test_the_command_writes_a_scene_that_loads_and_slides(tmp_path):
    path, picture, bare = (tmp_path / name for name in ("rubber.toml", "fit.png", "bare.toml"))
    layer = ["--thickness", "2 mm", "--poisson-ratio", "0.3"]
    command = ["foundation", DMA / "time_user_raw.csv", *layer, "--temperature", "30 degC"]
    found = printed(*command, "--arms", 12, "-o", path, "--plot", picture)
    told = ["arms", "modulus", "stiffness", "misfit", "largest_misfit", "shift_factors"]
    assert set(told) <= found.keys()
    scene = kv.load_scene(path)
    assert [arm.modulus for arm in scene.foundation.arms] == [E for E, _ in found["arms"]]
    assert scene.foundation.stiffness == pytest.approx(found["stiffness"])
    V = np.array(found["velocities"])
    state = kv.steady(scene, over={"drive.velocity": V})
    rate = V / (state.trailing_edge - state.leading_edge)  # at the temperature of the scene
    assert rate * scene.foundation.shift_factor == pytest.approx(found["frequencies"], rel=1e-3)
    assert picture.stat().st_size > 10_000
    assert "misfit" in path.read_text()
    small = ["foundation", written(tmp_path, HEAD + ROWS), *layer, "-o", path]
    bare.write_text(re.sub(r"(?s)\[foundation\].*?(?=\n\[)", "", kv.to_toml(kv.Scene())))
    run(*small, "--scene", bare)
    assert kv.load_scene(path).support == kv.Scene().support
    path.write_text("mine")
    run(*small, status=2)
    assert path.read_text() == "mine"


def test_mistakes_in_the_options_are_messages(tmp_path):
    data = written(tmp_path, HEAD + ROWS)
    for options, told in (
        (["-o", str(tmp_path / "x.toml")], "--thickness"),
        (["--thickness", "2", "--poisson-ratio", "0.3"], "--thickness"),
        (["--thickness", "2 mm"], "--poisson-ratio"),
        (["--poisson-ratio", "half"], "--poisson-ratio"),
        (["--temperature", "20 degC"], "no law of the shift factor is known"),
        (["--modulus", "K"], "expected one of: E, G"),
        (["--modulus", "G"], "is E"),
    ):
        refused(["foundation", data, "--arms", 1, *options], [told])
        assert len(list(tmp_path.iterdir())) == 1


def test_sliding_outside_the_measured_frequencies_is_noted(tmp_path):
    cold = {"activation_energy": "80 kJ/mol", "reference_temperature": "20 degC"}
    for temperature in ("20 degC", "5 degC"):
        rubber = kv.GeneralizedMaxwell(
            "10 GN/m^3", arms=[["30 GN/m^3", "10 ms"]], temperature=temperature, **cold,
            lowest_frequency="2 Hz", highest_frequency="30 Hz",
        )  # fmt: skip
        scene = kv.Scene(foundation=rubber)
        V = np.geomspace(1e-4, 1.0, 30)
        curve = kv.steady(scene, over={"drive.velocity": V})
        f = V / (curve.trailing_edge - curve.leading_edge) * rubber.shift_factor
        outside = np.flatnonzero((f < 2.0) | (f > 30.0))
        assert f"V a_T/c is, in {outside.size} of 30 scenes, outside" in curve.notes[0]
        for k in (outside[0], outside[-1]):
            (note,) = kv.steady(scene, over={"drive.velocity": -V[k]}).notes
            assert f"V a_T/c = {f[k]:.3g} Hz is outside" in note
        assert not kv.steady(scene, over={"drive.velocity": 0.0}).notes
    within = scene.replace({"foundation.highest_frequency": "1 THz"})
    for over_time in (partial(kv.transient, rtol=1e-4), partial(kv.elements, per_length="20 /mm")):
        found = over_time(scene, at=["10 ms", "20 ms"], certify=False)
        assert "outside the frequencies" in str(found)
        assert not over_time(within, at=["10 ms", "20 ms"], certify=False).notes
    assert kv.solve(scene, quantity="friction_force").notes
    swept = kv.sweep(scene, over={"drive.velocity": V}, quantities="friction_force")
    assert "outside the frequencies" in swept.certificate.statement
    wide = scene.replace(
        {"foundation.lowest_frequency": "1 nHz", "foundation.highest_frequency": "1 EHz"}
    )
    report = kv.asymptotes(wide)
    assert not report.notes
    (note,) = kv.asymptotes(wide.replace({"foundation.lowest_frequency": "1 PHz"})).notes
    assert "At the friction maximum at V = " in note
    assert "V/c is outside the frequencies" in note
    assert note.count("m/s") == len(report.maxima)
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    assert kv.load_scene(path) == scene
    with pytest.raises(ValueError, match=r"expected above foundation\.lowest_frequency"):
        scene.replace({"foundation.highest_frequency": "1 Hz"})
    with pytest.raises(ValueError, match=r"foundation\.highest_frequency: missing"):
        kv.Foundation("10 GN/m^3", "10 ms", lowest_frequency="1 Hz")


def test_a_temperature_at_which_the_shift_is_not_known_is_noted(tmp_path):
    """Beyond the measured sweeps, or, where these are not known, near the pole of WLF's law."""
    data, _ = wlf_sweeps(0.01)
    layer = {"thickness": "0.1 mm", "poisson_ratio": 0.3}
    fitted = kv.fit_foundation(data, **layer).scene
    own = fitted.foundation
    assert (own.lowest_temperature, own.highest_temperature) == pytest.approx(
        (263.15, 323.15), abs=0.5
    )
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(fitted))
    assert kv.load_scene(path) == fitted
    with pytest.raises(ValueError, match=r"expected above foundation\.lowest_temperature"):
        fitted.replace({"foundation.highest_temperature": "-40 degC"})
    assert any("a_T extrapolates (263" in note for note in
               kv.fit_foundation(data, temperature="60 degC", **layer).notes)  # fmt: skip
    wlf = {"reference_temperature": "23 degC", "wlf": ["17.44", "51.6 K"]}
    given = kv.Scene(foundation=kv.Foundation("10 GN/m^3", "1 s", **wlf))
    key, slowly = "foundation.temperature", {"drive.velocity": "1 um/s"}
    for scene, within, outside in ((fitted, "45 degC", "60 degC"), (given, "60 degC", "-5 degC")):
        known, far = (scene.replace({key: T, **slowly}) for T in (within, outside))
        for answer in (kv.steady, kv.asymptotes, partial(kv.elements, at=[0.0], certify=False)):
            assert "a_T extrapolates" in str(answer(far).notes)
            assert "a_T extrapolates" not in str(answer(known).notes)
        several = kv.steady(scene, over={key: [within, outside]})
        assert "in 1 of 2 scenes, is outside" in str(several.notes)
        assert REMARKS[1] in kv.sweep(scene, over={key: [within, outside]}).certificate.statement


def test_a_fitted_foundation_remembers_what_the_data_cover():
    found = kv.fit_foundation(dynamic(), thickness="0.1 mm", poisson_ratio=0.3)
    own = found.foundation
    assert (own.lowest_frequency, own.highest_frequency) == found.frequencies
    assert found.frequencies == pytest.approx(OMEGA[[0, -1]] / (2.0 * np.pi), rel=1e-5)
    slow, fast = found.velocities

    def outside(V):
        notes = kv.steady(found.scene, over={"drive.velocity": V}).notes
        return any("outside the frequencies" in note for note in notes)

    assert [outside(V) for V in (0.99 * slow, slow, fast, 1.01 * fast)] == [
        True,
        False,
        False,
        True,
    ]


def test_a_long_record_is_averaged_and_read_in_one_go(tmp_path):
    omega = np.geomspace(0.05, 1e5, 30_000)
    data = dynamic(0.05, omega=omega)
    path = tmp_path / "long.csv"
    columns = np.column_stack(list(data.values()))
    np.savetxt(path, columns, delimiter="\t", header="\t".join(data), comments="")
    found = kv.fit_foundation(path)
    assert len(found.arms) == 3
    assert found.arms[1][0] == pytest.approx(3e6, rel=3e-3)
    assert "30,000 values were averaged to 1,200" in found.notes[0]


def test_as_many_constants_as_shift_factors_are_taken_where_the_simpler_law_misses():
    """Shifts of a rubber that obeys WLF: Arrhenius' law is off by half a decade."""
    T, log_shift = np.array([273.15, 293.15, 333.15]), np.array([2.155, 0.0, -2.503])
    errors, T_ref = np.array([0.007, 0.0, 0.009]), 293.15
    three = shifting.law_of(
        SimpleNamespace(temperatures=T, log_shift=log_shift, errors=errors, reference=T_ref)
    )
    assert three.name == "wlf"
    assert three.log_shift(T, T_ref) == pytest.approx(log_shift, abs=1e-6)
    assert "none is left to test it" in three.test
    assert 0.05 < three.errors[0] / three.constants[0] < 0.5
    two = shifting.law_of(
        SimpleNamespace(
            temperatures=T[:2], log_shift=log_shift[:2], errors=errors[:2], reference=T_ref
        )
    )
    assert two.name == "arrhenius"
    assert "none is left to test it" in two.test
    turned = SimpleNamespace(
        temperatures=T[:2], log_shift=-log_shift[:2], errors=errors[:2], reference=T_ref
    )
    assert shifting.law_of(turned) is None
    assert two.errors[0] / two.constants[0] == pytest.approx(np.hypot(0.1, 0.007) / 2.155, rel=1e-3)


def test_measured_shift_factors_hold_in_the_scene_where_the_law_misses_them(tmp_path):
    T = [0.0, 20.0, 60.0]
    bent = SimpleNamespace(log_shift=lambda T, T_ref: -(T - T_ref) * (0.06 + 3e-4 * (T - T_ref)))
    data, shifts = swept(bent, np.geomspace(0.03, 3000.0, 26), T)
    layer = {"thickness": "0.1 mm", "poisson_ratio": 0.3}
    found = kv.fit_foundation(data, temperature="60 degC", **layer)
    assert found.shift_law.startswith("Arrhenius")
    assert any("Arrhenius misses the shift factor at" in note for note in found.notes)
    assert found.reference_temperature == 333.15
    assert "Prony series at 60 degC" in str(found)
    path = tmp_path / "rubber.toml"
    path.write_text(found.to_toml())
    scene = kv.load_scene(path)
    assert scene == found.scene
    for each, shift in zip(T, shifts - shifts[-1], strict=True):
        a_T = scene.replace({"foundation.temperature": f"{each} degC"}).foundation.shift_factor
        assert np.log10(a_T) == pytest.approx(shift, abs=5e-3)
    between = kv.fit_foundation(data, temperature="30 degC", **layer)
    assert "a_T" in between.notes[-1]
    assert "which hold at 20 degC" in between.notes[-1]
    for factors, told in (
        ([["20 degC", 1.0]], "log10 a_T = 0 at foundation.reference_temperature"),
        ([["20 degC", 0.0], ["20 degC", 1.0]], "different temperatures"),
        ("20 degC", "pairs of temperature"),
    ):
        with pytest.raises(kv.SceneError, match=told):
            kv.Foundation(1e9, 1.0, reference_temperature="20 degC", activation_energy="80 kJ/mol",
                          shift_factors=factors)  # fmt: skip
    with pytest.raises(kv.SceneError, match=r"needs foundation.* and a law"):
        kv.Foundation(1e9, 1.0, shift_factors=[["20 degC", 0.0]])


@pytest.mark.parametrize("suffix", [".inp", ".mac"])
def test_cards_of_other_programs_are_written_and_read_back(tmp_path, suffix):
    path, card = written(tmp_path, HEAD + ROWS), tmp_path / f"card{suffix}"
    layer = ["--thickness", "2 mm", "--poisson-ratio", "0.3"]
    first = printed("foundation", path, *layer, "-o", card)
    again = printed("foundation", card, "--thickness", "2 mm")
    assert np.array(again["arms"]) == pytest.approx(np.array(first["arms"]), rel=1e-5)
    for key in ("modulus", "stiffness"):
        assert again[key] == pytest.approx(first[key], rel=1e-5)
    assert again["misfit"] < 1e-5
    text = card.read_text()
    assert f"{first['modulus'] + sum(E for E, _ in first['arms']):.9g}" in text
    card.write_text(text.replace("units", "unit is not told"))
    refused(["foundation", card], ['expected a comment such as "units: MPa, s"'])


def test_cards_keep_the_law_of_temperature_or_say_that_they_do_not(tmp_path):
    layer, omega = {"thickness": "2 mm", "poisson_ratio": 0.3}, np.geomspace(0.03, 3000.0, 16)
    found = kv.fit_foundation(swept(WLF, omega, [0.0, 20.0, 40.0, 60.0])[0], **layer)
    of = found.foundation
    arrhenius = shifting.Law("arrhenius", (120e3,))
    three = kv.fit_foundation(swept(arrhenius, omega, [0.0, 20.0, 60.0])[0], **layer)
    assert three.shift_law.startswith("Arrhenius")
    for suffix in (".inp", ".mac"):
        card, text = tmp_path / f"card{suffix}", found.to_card(suffix)
        card.write_text(text)
        again = kv.fit_foundation(card, thickness="2 mm", temperature="50 degC")
        assert again.foundation.wlf == of.wlf
        assert again.foundation.reference_temperature == of.reference_temperature == 313.15
        assert again.shift_law.endswith(" K at 40 degC")
        card.write_text(text.replace("degC", "?"))
        refused(["foundation", card], ['"units: MPa, s, degC"', "reference temperature"])
        card.write_text(text.replace("WLF", "USER"))
        assert "USER, is not used" in kv.fit_foundation(card, thickness="2 mm").notes[0]
        assert "Without the law of temperature: the arms hold at 20 degC" in three.to_card(suffix)


BAD_CARDS = {
    "** units: Pa, s\n*ELASTIC\nx, 0.3\n": 'line 3, "x, 0.3": expected numbers',
    "** units: Pa, s\n*ELASTIC\n1, 0.3, 20\n2, 0.3, 40\n*VISCOELASTIC, TIME=PRONY\n0.5, 0, 1\n": "a row of",
    "** units: Pa, s\n*ELASTIC\n1, 0.3\n*VISCOELASTIC, TIME=PRONY\n0.5\n": "rows of g, k and tau",
    "** units: Pa, s\n*ELASTIC\n1, 0.3\n*VISCOELASTIC, TIME=PRONY\n0.5, 0, 1\n*TRS\n20, 5\n": "C_1 and C_2",
}


@pytest.mark.parametrize("text", BAD_CARDS)
def test_a_card_that_cannot_be_read_is_refused_with_the_line(tmp_path, text):
    refused(["foundation", written(tmp_path, text, "card.inp")], ["card.inp", BAD_CARDS[text]])


def test_a_card_may_give_the_relaxed_modulus_in_other_units(tmp_path):
    text = "** units: MPa, s\n*ELASTIC\n30, 0.45\n*VISCOELASTIC, TIME=PRONY\n0.5, 0., 1e-3\n0.3,0.,0.1\n"
    found = kv.fit_foundation(written(tmp_path, text, "card.INP"), thickness="2 mm")
    assert found.modulus == pytest.approx(30e6)
    assert np.array(found.arms) == pytest.approx(np.array([[75e6, 1e-3], [45e6, 0.1]]))
    assert "bulk modulus" in found.notes[0]
    relative = {"modulus": "30 MPa", "thickness": "2 mm", "poisson_ratio": 0.45}
    with pytest.raises(kv.SceneError, match="relative to the instantaneous modulus"):
        kv.GeneralizedMaxwell(**relative, arms=[["0.5", "1 ms"]])


def test_a_measured_stiffness_scales_the_arms():
    data = dynamic()
    found = kv.fit_foundation(data, stiffness="3.5 GN/m^3")
    own = found.foundation
    assert own.stiffness == 3.5e9
    assert [arm.stiffness for arm in own.arms] == pytest.approx(3.5e3 * TRUE.modulus, rel=1e-4)
    shear = {key.replace("E", "G"): values for key, values in data.items()}
    assert kv.fit_foundation(shear, stiffness="3.5 GN/m^3").foundation == own
    with pytest.raises(ValueError, match="takes the place of a layer"):
        kv.fit_foundation(data, stiffness=1e9, thickness="2 mm", poisson_ratio=0.3)
