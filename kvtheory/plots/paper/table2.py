"""Table 2 of the paper: critical velocity and friction coefficient, with the values for Table 1."""

from dataclasses import dataclass

from matplotlib.figure import Figure

from kvtheory.api import asymptotes
from kvtheory.plots.paper.models import SUPPORTS, Columns, sliding
from kvtheory.plots.style import Picture
from kvtheory.scene import Scene

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
    """The cells of the table: for each support a head, and rows of quantity, formula and value."""

    cells: list[list[str]]
    columns: Columns


def compute(scene: Scene | None = None) -> Data:
    """Evaluate the formulas; the asymptotes at 1 mm/s give their coefficients."""
    over = {"drive.velocity": "1 mm/s"}
    reports = {support: asymptotes(each, over=over) for support, each in sliding(scene).items()}
    values = {
        support: (report.critical_velocity, report.lines[0].value, report.lines[1].value)
        for support, report in reports.items()
    }
    powers = {"fixed": "", "dead-weight": r"$\;(V$ / mm/s$)^{-1/2}$"}
    shown = {
        support: (f"{1e3 * v:.5g} mm/s", rf"{low:.4g} $V$ / mm/s", f"{high:.4g}{powers[support]}")
        for support, (v, low, high) in values.items()
    }
    whose = "for the scene" if scene else "for Table 1"
    cells = [
        cells
        for support, formulas in FORMULAS.items()
        for cells in (
            [SUPPORTS[support], r"$\alpha = 2\sqrt{2}/3$", whose],
            *map(list, zip(ROWS, formulas, shown[support], strict=True)),
        )
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
    drawn = Picture(5.2, 3.5)
    ax = drawn.subplots()
    ax.axis("off")
    table = ax.table(data.cells, loc="center", cellLoc="left", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(9)
    table.auto_set_column_width(range(len(data.cells[0])))
    table.scale(1.0, 2.1)
    table.set_in_layout(False)  # it is made to fit the figure, not the other way round
    ax.set_title("Steady sliding with its exact coefficients", wrap=True)
    return drawn
