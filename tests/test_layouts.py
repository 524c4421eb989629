"""Tables in the layouts of instruments, programs and spreadsheets: what is read, and what is refused."""

import re
import sys

import numpy as np
import openpyxl
import pytest

import kvtheory as kv
from kvtheory.fitting import creep, moduli, records
from kvtheory.fitting import series as motions
from kvtheory.fitting.spectrum import Series
from kvtheory.scene.columns import history_from

ROWS = [(0.1, 2.0, 0.2), (1.0, 3.0, 0.6), (10.0, 5.0, 0.9), (100.0, 6.0, 0.3), (1e3, 6.5, 0.1)]
"""Angular frequency in rad/s, storage and loss modulus (G) in MPa."""


def table(form, factor=1.0):
    """Return a line for each row, by a template of w, f (Hz), G, L, size, tan, phase (deg) and i."""
    lines = []
    for i, (w, storage, loss) in enumerate(ROWS):
        G, L = factor * storage, factor * loss
        size, phase = np.hypot(G, L), np.degrees(np.arctan(L / G))
        known = {"f": w / 2 / np.pi, "size": size, "tan": L / G, "phase": phase}
        known |= {"eta": L / w, "eta2": G / w, "size_eta": size / w}
        digits = {name: repr(float(value)) for name, value in known.items()}
        lines.append(form.format(w=w, G=G, L=L, i=i, **digits) + "\n")
    return "".join(lines)


HEAD, PLAIN = "w [rad/s],G' [MPa],G'' [MPa]\n", table("{w:g},{G:g},{L:g}")
ALIKE = {
    "label first": "sample," + HEAD + table("A-{i},{w},{G},{L}"),
    "label of digits": "sample," + HEAD + table("7-{i}b,{w},{G},{L}"),
    "text in the middle": "w [rad/s],state,G' [MPa],G'' [MPa]\n" + table("{w},0xB5,{G},{L}"),
    "round brackets": "w (rad/s),G' (MPa),G'' (MPa)\n" + PLAIN,
    "brackets in brackets": "ω/(rad/s);G'/(MPa);G''/(MPa)\n" + table("{w};{G};{L}").replace(".", ","),
    "units after a comma": "Angular frequency, rad/s;G', MPa;G'', MPa\n" + table("{w};{G};{L}"),
    "suffixes": "omega_rad_s,G_storage_mpa,G_loss_mpa\n" + PLAIN,
    "suffix in hertz": "freq_hz,G_stor_MPa,G_loss_MPa\n" + table("{f},{G},{L}"),
    "spaces": "w[rad/s]   G'[MPa]   G''[MPa]\n" + table("   {w}    {G}   {L}"),
    "single spaces": "# w [rad/s] G' [MPa] G'' [MPa]\n" + table("{w} {G} {L}"),
    "words and spaces": "Angular frequency [rad/s] G' [MPa] G'' [MPa]\n" + table("{w} {G} {L}"),
    "spaces, units below": "w     G'     G\"    Strain\nrad/s   MPa   MPa   %\n" + table("{w}  {G}  {L}  1"),
    "comma header, space rows": "# w [rad/s], G' [MPa], G'' [MPa]\n" + table("{w:e} {G:e} {L:e}"),
    "header in a comment": "## program 7\n## " + HEAD + PLAIN,
    "header in a comment of MATLAB": "% w [rad/s];G' [MPa];G'' [MPa]\n" + table("{w};{G};{L}"),
    "units in a comment": "# w,G',G''\n# rad/s,MPa,MPa\n" + PLAIN,
    "components": (
        "Action\tFrequency(Hz)\tShear modulus (elastic component)(MPa)\t"
        "Shear modulus (viscous component)(MPa)\n"
        + table("sweep\t{f}\t{G}\t{L}")
    ),
    "date above": "12.03.2026 10:15\n3 points\n" + HEAD + PLAIN,
    "Fortran": HEAD + table("{w:.3e},{G:.3e},{L:.3e}").replace("e", "D"),
    "names of rows": '"w [rad/s]","G\' [MPa]","G\'\' [MPa]"\n' + table('"{i}",{w},{G},{L}'),
    "index of a data frame": "," + HEAD + table("{i},{w},{G},{L}"),
    "labels of a table": (
        "[Step]\nStep name\tsweep\nVariables\tRun time\tAngular frequency\tStatus\tG'\tG''\n"
        "Units\ts\trad/s\t\tMPa\tMPa\n" + table("Data point\t10\t{w}\tFRT\t{G}\t{L}")
    ),
    "a label that rows lack": (
        "Interval data:\tAngular Frequency\tG'\tG''\t|G*|\n\t[rad/s]\t[MPa]\t[MPa]\t[MPa]\n"
        + table("{w}\t{G}\t{L}\t{size}")
    ),
    "mean in the last row": HEAD + PLAIN + "Mean,3.1,0.4\n",
    "columns in a comment": (
        "% made by hand\n% columns: w [rad/s], G' [MPa], G'' [MPa]\n" + table("{w} {G} {L}")
    ),
    "words before symbols": (
        "Kreisfrequenz [rad/s];Speichermodul G' [MPa];Verlustmodul G'' [MPa]\n" + table("{w};{G};{L}")
    ),
    "end in the last row": HEAD + PLAIN + "End of data\n",
    "bars of Markdown": "| w[rad/s] | G'[MPa] | G''[MPa] |\n|--|--:|--|\n" + table("| {w} | {G} | {L} |"),
    "bars and |G*|": "w [rad/s] | |G*| [MPa] | phase [deg]\n" + table("{w} | {size} | {phase}"),
    "drawn": (
        "+----+----+----+\n| w | G' | G'' |\n| rad/s | MPa | MPa |\n+====+====+====+\n"
        + table("| {w} | {G} | {L} |") + "+----+----+----+\n"
    ),
    "LaTeX": (
        "$\\omega$ (rad/s) & $G'$ (MPa) & $G''$ (MPa) \\\\ \\hline\n" + table("{w} & {G} & {L} \\\\")
    ),
    "underlined": "w[rad/s]  G'[MPa]  G''[MPa]\n--------  -------  ---\n" + table("{w}  {G}  {L}"),
    "symbols behind words": (
        "Angular frequency ω [rad/s],Storage modulus (G') (MPa),Loss (G'') <MPa>\n" + PLAIN
    ),
    "signs of typography": HEAD + table("{w:e},{G:e},{L:e}").replace("-", "\N{MINUS SIGN}"),
    "|G*| and phase": "w [rad/s],|G*| [MPa],phase angle [deg]\n" + table("{w},{size},{phase}"),
    "|G*| and tan delta": "w [rad/s],G* [MPa],tan(delta)\n" + table("{w},{size},{tan}"),
    "tan delta in percent": "w [rad/s],G' [MPa],tan_delta [%]\n" + table("{w},{G},{tan}e2"),
    "G'' and tan delta": "w [rad/s],G'' [MPa],loss factor [-]\n" + table("{w},{L},{tan}"),
    "|G*| and G'": "w [rad/s],|G*| [MPa],G' [MPa]\n" + table("{w},{size},{G}"),
    "viscosities": "w [rad/s],η' [MPa s],η'' [MPa s]\n" + table("{w},{eta},{eta2}"),
    "complex viscosity": (
        "w [rad/s],complex viscosity [MPa·s],Phasenwinkel [°]\n" + table("{w},{size_eta},{phase}")
    ),
}  # fmt: skip


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "data.txt"
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize("name", ALIKE)
def test_layouts_of_moduli_are_read_alike(tmp_path, name):
    for encoding in ("utf-8", "utf-16") if name == "spaces" else ("utf-8",):
        found = moduli.read(written(tmp_path, ALIKE[name], encoding))
        (sweep,) = found.sweeps
        assert found.kind == "G"
        expected = np.array(ROWS).T * [[1.0], [1e6], [1e6]]
        assert sweep.moduli.x == pytest.approx(expected[0])
        assert sweep.moduli.values == pytest.approx(expected[1:], rel=1e-12)


INTERVAL = (
    "\nInterval:\t{k}\t5\nTemperature:\t{T} °C\nInterval data:\tw [rad/s]\tG' [MPa]\tG'' [MPa]\n"
)
STEPS = "[Step]\nStep name\tFrequency sweep ({T} °C)\nw\tG'\tG''\nrad/s\tMPa\tMPa\n"
KEYS = "Segment;{k}\nSet temperature;{T};°C\nw;G';G''\nrad/s;MPa;MPa\n"
ONE_HEADER = "Temperature: {T} °C\n"


@pytest.mark.parametrize("head", [INTERVAL, STEPS, KEYS, ONE_HEADER])
def test_the_head_of_a_table_tells_its_temperature(tmp_path, head):
    first = "w [rad/s]\tG' [MPa]\tG'' [MPa]\n" * (head is ONE_HEADER)
    text = first + "".join(
        head.format(T=T, k=k)
        + table("{w};{G};{L}" if head is KEYS else "{w}\t{G}\t{L}", 1.0 - 0.1 * k)
        for k, T in enumerate((25, 35, 45))
    )
    found = moduli.read(written(tmp_path, text))
    assert [sweep.temperature for sweep in found.sweeps] == pytest.approx([298.15, 308.15, 318.15])
    assert [sweep.moduli.values[0, 0] for sweep in found.sweeps] == pytest.approx(
        [2e6, 1.8e6, 1.6e6]
    )
    assert "The temperature is that in the head of each table." in found.notes


REFUSED = {
    "no temperature": (HEAD + PLAIN + HEAD + table("{w},{G},{L}", 0.5),
                       "its 2 tables hold other moduli at the same frequencies"),
    "one head without": ("Temperature: 25 °C\n" + HEAD + PLAIN + "next:\n" + HEAD + PLAIN,
                         "line 9: the head of this table names no temperature"),
    "two headers of one": (HEAD + PLAIN + "time [s],torque\n1,2\n", "line 8 holds numbers, and no row"),
    "the row that names most": ("a,b\nw [rad/s],G' [MPa],X\nHz,Pa,m\n1,2,3\n",
                                "line 2, \"w [rad/s],G' [MPa],X\": has only angular frequency, G'"),
    "no phase": ("w [rad/s],|G*| [MPa]\n1,2\n2,3\n", "has only angular frequency, |G*|"),
    "phase without unit": ("w [rad/s],|G*| [MPa],phase\n" + table("{w},{size},{phase}"),
                           "expected deg or rad"),
    "phase above 90": ("w [rad/s],|G*| [MPa],phase [deg]\n1,2,91\n", "is not from 0 to below 90 degrees"),
    "another |G*|": ("w [rad/s],G' [MPa],G'' [MPa],|G*| [MPa]\n" + table("{w},{G},{L},1"),
                     "leave out the column that is wrong"),
    "logarithms": ("f [Hz],log G' [Pa],log G'' [Pa]\n1,6,5\n",
                   "\"log G' [Pa]\" is a logarithm, expected the values themselves"),
    "without units": ("w | G' | G''\n" + table("{w} | {G} | {L}"),
                      'line 1, column "w": has no unit; expected rad/s'),
    "a page": ("<html>\n" + HEAD + PLAIN, "not a table but a page of HTML, XML or JSON"),
    "in a row": ("w [rad/s],1,2,3\nG' [MPa],1,2,3\nG'' [MPa],1,2,3\n",
                 "holds the values of one quantity; expected a column for each, not a row"),
    "other mark": ("w [rad/s] : G' [MPa] : G'' [MPa]\n1 : 2 : 3\n",
                   "line 2 has 5 cells, the header has 3, separated by spaces"),
    "errors": ("w [rad/s]\tG' [MPa]\tG'' [MPa]\n1\t2.0 ± 0.1\t1.0 ± 0.1\n",
               'line 2, column "G\' [MPa]": "2.0 ± 0.1" is not a number'),
    "nothing below": (HEAD + "text\n", "no numbers stand below line 1"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_read_is_said_of_the_row_that_matters(tmp_path, name):
    text, told = REFUSED[name]
    with pytest.raises(ValueError, match=re.escape(told)):
        moduli.read(written(tmp_path, text))


def test_all_cells_without_a_number_are_reported_together(tmp_path):
    text = HEAD + "1,2,3\n2,x,y\n3,,1\n1,2,3,4\n"
    with pytest.raises(kv.SceneError) as caught:
        moduli.read(written(tmp_path, text))
    found = [re.search(r": (line \d+)", message)[1] for message in caught.value.problems]
    assert found == ["line 3", "line 3", "line 4", "line 5"]


def test_numbers_above_the_header_are_noted(tmp_path):
    text = "p,q\n1,2\n3,4\n5,6\n\n" + HEAD + PLAIN
    notes = moduli.read(written(tmp_path, text)).notes
    assert notes == ("Lines 2 to 4, above the header in line 6, are not used.",)


@pytest.mark.parametrize("unit", ["(Pa)", "[Pa]"])
def test_relaxation_may_begin_at_its_start(tmp_path, unit):
    t = np.append(0.0, np.geomspace(1e-3, 10.0, 20))
    G = Series(0.6e6, np.array([1.2e6, 0.5e6]), np.array([0.01, 1.0])).values(t, dynamic=False)[0]
    rows = "".join(f"{a:.9g},{b:.9g}\n" for a, b in zip(t, G, strict=True))
    found = kv.fit_foundation(written(tmp_path, f"t (s),G(t) {unit}\n{rows}"), poisson_ratio=0.25)
    assert np.array(found.arms) == pytest.approx(np.array([[3e6, 0.01], [1.25e6, 1.0]]), rel=1e-5)
    assert found.frequencies == pytest.approx((0.1, 1000.0))


def test_a_creep_compliance_gives_the_series_that_made_it():
    """Zener: J = 1/E_0 - (1/E_0 - 1/(E_0 + E_1)) e^(-t E_0/((E_0 + E_1) tau))."""
    E_0, E_1, tau, t = 0.6, 1.2, 0.03, np.geomspace(1e-3, 3.0, 25)
    J = 1 / E_0 - (1 / E_0 - 1 / (E_0 + E_1)) * np.exp(-t * E_0 / (E_0 + E_1) / tau)
    series = Series(E_0, np.array([E_1]), np.array([tau]))
    assert creep.compliance(series, t) == pytest.approx(J, rel=1e-12)
    found = kv.fit_foundation({"t [s]": t, "D(t) [1/MPa]": J})
    assert found.arms == (pytest.approx((1.2e6, 0.03), rel=1e-3),)
    assert found.modulus == pytest.approx(0.6e6, rel=1e-3)
    assert "The creep compliance of the series is off by" in found.notes[-1]


@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_noise_of_a_compliance_is_not_amplified(noise):
    series = Series(0.6, np.array([1.2, 0.5, 0.2]), np.array([1e-3, 0.03, 1.0]))
    t = np.geomspace(1e-4, 100.0, 60)
    J = creep.compliance(series, t) * (
        1.0 + noise * np.random.default_rng(0).standard_normal(t.size)
    )
    E, misfit = creep.relaxing(t, J)
    assert misfit < noise + 1e-4
    assert np.sqrt(np.mean((E / series.values(t, dynamic=False)[0] - 1.0) ** 2)) < noise + 1e-4
    flowing, _ = creep.relaxing(t, 1.0 + t)  # a Maxwell liquid
    assert flowing == pytest.approx(np.exp(-t), abs=1e-3)


@pytest.mark.parametrize(
    "text", ["t [s],X [mm]\n", "Time (s);Position (mm)\n", "# t [s]\tx [mm]\n", "t_s,x_mm\n"]
)
def test_a_position_is_differentiated(tmp_path, text):
    t = np.linspace(0.0, 0.1, 81)
    mark = ";" if ";" in text else "\t" if "\t" in text else ","
    rows = "".join(f"{a:.6f}{mark}{0.4 * (1 - np.cos(40 * np.pi * a)):.7f}\n" for a in t)
    found = np.array(history_from(written(tmp_path, text + rows))).T
    assert found[1] == pytest.approx(16e-3 * np.pi * np.sin(40 * np.pi * t), abs=2e-3)
    with pytest.raises(kv.SceneError, match="positions need times that increase"):
        history_from(written(tmp_path, f"{text}0{mark}1\n1{mark}2\n1{mark}3\n"))


V = np.geomspace(1e-3, 1.0, 8)
FRICTION = {
    "tribometer": ("Sliding speed (mm/s),COF (-)\n", "{V}e3,{mu}"),
    "percent": ("V [mm/s],mu [%]\n", "{V}e3,{mu}e2"),
    "factor": ("Sliding Speed;Friction Factor\n[m/s];[1]\n", "{V};{mu}"),
    "label": ("run;V [m/s];Reibwert\n", "Lauf {i};{V};{mu}"),
    "units below": ("Speed   COF\nmm/s   -\n", "{V}e3   {mu}"),
    "suffix": ("v_mm_s,mu\n", "{V}e3,{mu}"),
}


@pytest.mark.parametrize("name", FRICTION)
def test_layouts_of_friction_are_read_alike(tmp_path, name):
    head, form = FRICTION[name]
    rows = "".join(
        form.format(V=f"{v:.9g}" if "e3" not in form else f"{v:.9f}", mu=f"{0.1 * v:.9f}", i=i)
        + "\n"
        for i, v in enumerate(V)
    )
    path = written(tmp_path, head + rows)
    found = records.read(path, kv.Scene())
    assert found.conditions["drive.velocity"] == pytest.approx(V, abs=1e-9)
    assert found.measured["friction_coefficient"] == pytest.approx(0.1 * V, abs=1e-9)
    if "label" not in name:
        assert motions.read(path).curve


def test_a_tribometer_writes_grams_and_t_in_seconds(tmp_path):
    head = "Created by Viewer\n\nRun # 1\n\nFx,Fz,Z,T,COF\ng,g,mm,sec,\n"
    rows = "".join(f"{120 + i}.5,-200,-0.6,{i / 100},0.6\n" for i in range(10))
    ball = kv.Scene(
        indenter=kv.Sphere("3 mm"), support=kv.DeadWeight(load="1.961 N"), drive=kv.Drive("10 mm/s")
    )
    found = records.read(written(tmp_path, head + rows), ball)
    assert found.time == pytest.approx(np.arange(10) / 100)
    assert found.measured["normal_force"] == pytest.approx(np.full(10, 0.2 * 9.80665))
    assert "was read as pressing" in "".join(found.notes)


def test_sheets_of_excel_are_read_as_text_is(tmp_path, monkeypatch):
    path, book = tmp_path / "data.xlsx", openpyxl.Workbook()
    book.active.title = "Details"
    book.active.append(["operator", "A"])
    for T in (25, 45):
        sheet = book.create_sheet(f"Frequency sweep ({T} °C)")
        for row in (["w", "G'", "G''"], ["rad/s", "MPa", "MPa"], *ROWS):
            sheet.append(row)
    book.save(path)
    found = moduli.read(path)
    assert [sweep.temperature for sweep in found.sweeps] == pytest.approx([298.15, 318.15])
    expected = np.array(ROWS).T * [[1.0], [1e6], [1e6]]
    assert found.sweeps[1].moduli.values == pytest.approx(expected[1:])
    assert "Of the file, these sheets are not used: Details." in found.notes
    sheet["B4"] = "two"
    book.save(path)
    with pytest.raises(
        ValueError, match=r'one after the other.*: line 13, column "G\'": "two" is not a'
    ):
        moduli.read(path)
    path.write_text(HEAD + PLAIN)
    with pytest.raises(ValueError, match="not an Excel file"):
        moduli.read(path)
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(ValueError, match="Excel files need openpyxl"):
        moduli.read(path)


def test_units_behind_per_and_symbols_behind_words_are_read(tmp_path):
    text = "V_mm_per_s,Friction force F_R [N/mm],Friction force F_y [N/mm]\n1,2,7\n3,4,7\n"
    found = records.read(written(tmp_path, text), kv.Scene())
    assert found.conditions["drive.velocity"] == pytest.approx([1e-3, 3e-3])
    assert found.measured["friction_force"] == pytest.approx([2e3, 4e3])
    warm = {"V [mm/s]": [1, 3], "T [degC]": [23, 24], "mu": [0.1, 0.2]}
    assert "temperature does not vary" in records.read(warm, kv.Scene()).notes[0]
    pulled = records.read(
        {"V [mm/s]": [1, 3], "F_z [N/mm]": [-5, -4], "mu": [0.1, 0.2]}, kv.Scene()
    )
    assert pulled.conditions["support.load"] == pytest.approx([5e3, 4e3])
    assert pulled.notes == ("The normal force is below 0 throughout, and was read as pressing.",)
