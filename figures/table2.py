"""Table 2 of the paper: critical velocity and friction coefficient, with the values for Table 1."""

from dataclasses import dataclass

from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing

ROWS = (
    r"critical velocity $V^*$",
    r"$\mu$ for $V \ll V^*$",
    r"$\mu$ for $V \gg V^*$",
)
FORMULAS = {
    "fixed": (
        r"$\alpha\,K\sqrt{R\delta}\,/\,C$",
        r"$CV/RK\;\sim\;V^{1}$",
        r"$\alpha\sqrt{\delta/R}\;\sim\;V^{0}$",
    ),
    "dead-weight": (
        r"$\alpha^{2/3}(RK^2W)^{1/3}\,/\,C$",
        r"$CV/RK\;\sim\;V^{1}$",
        r"$\alpha\sqrt{W/RCV}\;\sim\;V^{-1/2}$",
    ),
}


@dataclass(frozen=True)
class Data:
    """The cells of the table: a row of formula and value for each support."""

    cells: list[list[str]]
    columns: drawing.Columns


def compute() -> Data:
    """Evaluate the formulas for Table 1; the asymptotes at 1 mm/s give their coefficients."""
    over = {"drive.velocity": "1 mm/s"}
    reports = {support: kv.asymptotes(kv.Scene.table1(support), over=over) for support in FORMULAS}
    values = {
        support: (report.critical_velocity, report.lines[0].value, report.lines[1].value)
        for support, report in reports.items()
    }
    powers = {"fixed": "", "dead-weight": r"$\;(V$ / mm/s$)^{-1/2}$"}
    shown = {
        support: (f"{1e3 * v:.4f} mm/s", rf"{low:.4f} $V$ / mm/s", f"{high:.4f}{powers[support]}")
        for support, (v, low, high) in values.items()
    }
    cells = [
        [row, *(cell for support in FORMULAS for cell in (FORMULAS[support][i], shown[support][i]))]
        for i, row in enumerate(ROWS)
    ]
    columns = {
        "quantity": [
            "critical_velocity [m/s]",
            "friction_coefficient, low V [1]",
            "friction_coefficient, high V [1]",
        ],
        **{support: values[support] for support in FORMULAS},
    }
    return Data(cells, columns)


def draw(data: Data) -> Figure:
    """Draw the table."""
    drawn = drawing.figure(7.6, 1.9)
    ax = drawn.subplots()
    ax.axis("off")
    heads = ["", "FI model (fixed)", "for Table 1", "MI model (dead weight)", "for Table 1"]
    table = ax.table(data.cells, colLabels=heads, loc="center", cellLoc="left", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(9)
    table.auto_set_column_width(range(len(heads)))
    table.scale(1.0, 2.1)
    ax.set_title(r"Steady sliding with its exact coefficients, $\alpha = 2\sqrt{2}/3$")
    return drawn


if __name__ == "__main__":
    drawing.run("table2", compute, draw)
