"""How many arms are enough: the change of friction over the number of arms that are left (derivation F27).

A Prony series of 21 arms, three to a decade, is replaced by series with fewer arms. From 1 mm/s to 1 m/s the
true change of friction is far below the bound that is proved.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK
from kvtheory.scene.foundations import Arm

ARMS = tuple(Arm(3e10 * 2.0**-k, 10.0 ** (0.3 * k - 6)) for k in range(21))
SPEEDS = np.geomspace(1e-3, 1.0, 10)
"""m/s."""
CHANGES = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)
"""Largest relative changes of friction that are allowed."""


@dataclass(frozen=True)
class Data:
    """The number of arms, the true change of friction and its bound, infinite where none is proved."""

    arms: np.ndarray
    change: np.ndarray
    bound: np.ndarray
    columns: drawing.Columns


def compute() -> Data:
    """Reduce the series for each change that is allowed."""
    scene = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=ARMS))
    found = [kv.fewer_arms(scene, velocities=SPEEDS, rtol=rtol, proved=False) for rtol in CHANGES]
    rows = sorted({(len(each.arms), each.difference, each.bound) for each in found})
    arms, change, bound = np.array([row for row in rows if row[0] < len(ARMS)]).T
    columns = {
        "arms [1]": arms,
        "change of mu [1]": change,
        "bound [1]": np.where(bound < np.inf, bound, np.nan),
    }
    return Data(arms, change, bound, columns)


def draw(data: Data) -> Figure:
    """Draw the true change and the bound over the number of arms."""
    drawn = drawing.figure(4.5, 3.2)
    ax = drawn.subplots()
    proved = np.isfinite(data.bound)
    ax.semilogy(data.arms[proved], data.bound[proved], "s--", color="C1", label="proved bound")
    ax.semilogy(data.arms, data.change, "o-", color=BLACK, label="true change")
    ax.set(xlabel="arms left of 21", ylabel=r"relative change of $\mu$")
    ax.legend(fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("fewer_arms", compute, draw)
