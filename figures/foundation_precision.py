"""Speed against accuracy of steady sliding on a Prony series: one arm, and twenty over ten decades.

Three methods for one friction coefficient at a fixed depth: the exact moments, the convolution of
`quadrature`, and a straightforward Gauss rule for the relaxation integral. Errors are relative to the exact
state; its own error is drawn at its claimed bound, 5.3e-15. Times are the shortest of a few calls of one
scene.
"""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED
from kvtheory.scene.foundations import Arm

NODES = (4, 8, 16, 32, 64, 128, 256)
REPEATS = 3
MANY = 20_000
"""Scenes solved in one call, to time one scene among many."""
R, K, DEPTH, V = 0.01, 1e10, 3e-4, 0.1


@dataclass(frozen=True)
class Data:
    """By number of arms and method: relative errors of mu, and seconds."""

    series: dict[int, dict[str, tuple[list[float], list[float]]]]
    columns: drawing.Columns


def arms(count: int) -> tuple[Arm, ...]:
    """Return arms of equal damping, one of the time a/V or many over ten decades around it."""
    times = [0.01] if count == 1 else np.geomspace(1e-7, 1e3, count).tolist()
    return tuple(Arm(3e10 * (0.01 / t) ** 0.3, t) for t in times)


def by_gauss(series: tuple[Arm, ...], count: int) -> float:
    """Return mu by Gauss's rule with this number of nodes for the history and for the contact."""
    place, weight = np.polynomial.legendre.leggauss(count)
    place, weight = 0.5 + 0.5 * place, 0.5 * weight
    stiffness, length = np.array([(arm.stiffness, V * arm.relaxation_time) for arm in series]).T
    a = np.sqrt(2.0 * R * DEPTH)

    def pressure(X: Any) -> Any:
        """Return int G(X - s) (a - s)/R ds."""
        s = X[:, None] * place
        G = K + (stiffness * np.exp(-(X[:, None] - s)[..., None] / length)).sum(axis=-1)
        return X * ((G * (a - s) / R) @ weight)

    c = brentq(lambda X: pressure(np.array([X]))[0], a, 2.0 * a, xtol=1e-300, rtol=1e-14)
    X = c * place
    p = pressure(X)
    return float((weight @ (p * (a - X) / R)) / (weight @ p))


def compute() -> Data:
    """Time each method on both foundations."""
    series: dict[int, dict[str, tuple[list[float], list[float]]]] = {}
    rows: list[tuple[Any, ...]] = []
    for count in (1, 20):
        some = arms(count)
        scene = kv.Scene(
            kv.Parabola(R), kv.GeneralizedMaxwell(K, arms=some), kv.Fixed(DEPTH), kv.Drive(V)
        )
        state = kv.steady(scene)
        truth, claimed = (
            state.friction_coefficient,
            state.certificate.relative_error["friction_coefficient"],
        )
        over = {"drive.velocity": np.full(MANY, V)}
        quadrature = partial(kv.steady, scene, method="quadrature")
        errors = [abs(by_gauss(some, n) / truth - 1.0) for n in NODES]
        each = {
            "exact": ([claimed], [_seconds(partial(kv.steady, scene))]),
            "exact, one of many": (
                [claimed],
                [_seconds(partial(kv.steady, scene, over=over)) / MANY],
            ),
            "quadrature": (
                [max(abs(quadrature().friction_coefficient / truth - 1.0), 1e-16)],
                [_seconds(quadrature)],
            ),
            "Gauss's rule by hand": (errors, [_seconds(partial(by_gauss, some, n)) for n in NODES]),
        }
        series[count] = each
        rows += [
            (count, name, *pair)
            for name, pairs in each.items()
            for pair in zip(*pairs, strict=True)
        ]
    heads = "arms", "method", "relative error of mu [1]", "time [s]"
    return Data(series, dict(zip(heads, zip(*rows, strict=True), strict=True)))


def _seconds(call: Callable[[], Any]) -> float:
    best = float("inf")
    for _ in range(REPEATS):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


def draw(data: Data) -> Figure:
    """Draw time over error, a panel for each foundation."""
    drawn = drawing.figure(7.2, 3.3)
    looks = {
        "exact": {"marker": "o", "color": BLUE}, "exact, one of many": {"marker": "s", "color": BLUE},
        "quadrature": {"marker": "D", "color": RED}, "Gauss's rule by hand": {"marker": ".", "color": BLACK},
    }  # fmt: skip
    panels = drawn.subplots(1, 2, sharex=True, sharey=True)
    for ax, (count, each) in zip(panels, data.series.items(), strict=True):
        for name, (errors, seconds) in each.items():
            ax.loglog(errors, seconds, label=name, **looks[name])
        ax.set(title="one arm" if count == 1 else f"{count} arms over ten decades",
               xlabel=r"relative error of $\mu$", xlim=(1e-16, 10.0))  # fmt: skip
        ax.invert_xaxis()
    panels[0].set_ylabel("time of one scene [s]")
    panels[0].legend(loc="lower left", fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("foundation_precision", compute, draw)
