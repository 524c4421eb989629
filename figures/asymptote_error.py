"""The error of each asymptote of the friction coefficient, over V/V*."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED, plot_asymptote_errors

RATIOS = np.geomspace(1e-4, 1e4, 241)
TOLERANCE = 0.05
PANELS = {"fixed": "FI: fixed indenter", "dead-weight": "MI: dead weight"}
STYLES = {
    "L1": {"color": BLUE, "linestyle": "-", "label": "$L_1$, Eq. 42"},
    "L2": {"color": RED, "linestyle": "--", "label": "$L_2$, Eq. 45 or 46"},
}


@dataclass(frozen=True)
class Data:
    """A report over `RATIOS` for each support."""

    reports: dict[str, kv.AsymptoteReport]
    columns: drawing.Columns


def compute() -> Data:
    """Make the reports at velocities around V*."""
    reports = {}
    for support in PANELS:
        scene = kv.Scene.table1(support)
        critical = kv.asymptotes(scene).critical_velocity
        reports[support] = kv.asymptotes(
            scene, over={"drive.velocity": RATIOS * critical}, tolerance=TOLERANCE
        )
    columns = {"V/V* [1]": RATIOS}
    for support, report in reports.items():
        for line in report.lines[:2]:
            columns[f"error of {line.name}, {support} [1]"] = line.relative_error
    return Data(reports, columns)


def draw(data: Data) -> Figure:
    """Draw the errors, and the ranges in which they are within the tolerance."""
    drawn = drawing.figure(7.2, 3.2)
    for ax, (support, title) in zip(drawn.subplots(1, 2, sharey=True), PANELS.items(), strict=True):
        report = data.reports[support]
        plot_asymptote_errors(ax, report, STYLES)
        low, high = report.lines[:2]
        critical = report.critical_velocity[0]
        ax.axhline(TOLERANCE, color=BLACK, linewidth=0.8, linestyle=":")
        ax.text(1.5 * RATIOS[0], 1.3 * TOLERANCE, f"{TOLERANCE:.0%}", fontsize=8)
        for edge, span in (
            (low.velocity_max[0], (RATIOS[0], None)),
            (high.velocity_min[0], (None, RATIOS[-1])),
        ):
            ratio = edge / critical
            ax.axvspan(span[0] or ratio, span[1] or ratio, color=BLACK, alpha=0.06, linewidth=0)
            ax.text(
                ratio, 2e-4, f"{ratio:.3g} ", ha="right" if span[0] is None else "left", fontsize=8
            )
        ax.set(title=title, ylim=(1e-4, 1e4), xlim=(RATIOS[0], RATIOS[-1]))
        ax.text(0.03, 0.5, f"grey: within {TOLERANCE:.0%}", transform=ax.transAxes, fontsize=8)
        ax.legend(loc="upper center", frameon=True, edgecolor="none", framealpha=1.0)
    return drawn


if __name__ == "__main__":
    drawing.run("asymptote_error", compute, draw)
