"""The start of sliding on rubber, and on Kelvin-Voigt with the same stiffness and damping.

The scene is Table 1. A standard linear solid, and five arms a decade apart from 0.1 ms to 1 s, stand for its
damper, with the same sum of K_i tau_i. At t = 0 the pressure of a damper jumps, that of an arm does not: the
first peak of both forces on Kelvin-Voigt does not exist on rubber. An arm that relaxes more slowly than an
element passes the contact is a spring: it carries load but hardly dissipates. Dotted, exact steady sliding.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED
from kvtheory.scene.foundations import Arm

TITLES = {"fixed": "given depth", "dead-weight": "dead weight"}
TIMES = np.concatenate([[0.0], np.geomspace(1e-5, 0.2, 150)])
RELAXATION_TIMES = np.array([1e-4, 1e-3, 1e-2, 1e-1, 1.0])
SLOPE = -0.5
"""Stiffness of the five arms over their relaxation time, as an exponent: a typical transition."""
RTOL = 1e-4
QUANTITIES = {
    "depth": (r"depth $\delta$ [mm]", 1e3),
    "normal_force": ("normal force $F_z$ [N/mm]", 1e-3),
    "friction_force": ("friction force $F_x$ [N/mm]", 1e-3),
}
"""Labels, and the factors from SI."""
STEADY = {"depth": "depth", "normal_force": "load", "friction_force": "friction_force"}


@dataclass(frozen=True)
class Data:
    """By support and foundation: the start from rest, and exact steady sliding at its end."""

    starts: dict[str, dict[str, Any]]
    ends: dict[str, dict[str, Any]]
    columns: drawing.Columns


def foundations() -> dict[str, Any]:
    """Return the foundations of equal stiffness and damping, by their labels."""
    plain = kv.Scene().foundation
    share = RELAXATION_TIMES ** (1.0 + SLOPE)
    stiffnesses = plain.damping * share / share.sum() / RELAXATION_TIMES
    five = tuple(
        Arm(float(k), float(t)) for k, t in zip(stiffnesses, RELAXATION_TIMES, strict=True)
    )
    single = (Arm(plain.damping / 1e-2, 1e-2),)
    return {
        "Kelvin–Voigt": plain,
        "standard linear solid": kv.GeneralizedMaxwell(plain.stiffness, single),
        "five arms": kv.GeneralizedMaxwell(plain.stiffness, five),
    }


def compute() -> Data:
    """Follow both starts on every foundation."""
    starts: dict[str, dict[str, Any]] = {support: {} for support in TITLES}
    ends: dict[str, dict[str, Any]] = {support: {} for support in TITLES}
    columns: dict[str, Any] = {"time [s]": TIMES}
    for support in TITLES:
        for name, foundation in foundations().items():
            scene = replace(kv.Scene.table1(support), foundation=foundation)
            found = kv.transient(scene, at=TIMES, rtol=RTOL, certify=False)
            starts[support][name], ends[support][name] = found, kv.steady(scene)
            columns |= {
                f"{quantity}, {support}, {name} [{'m' if quantity == 'depth' else 'N/m'}]":
                getattr(found, quantity) for quantity in QUANTITIES
            }  # fmt: skip
    return Data(starts, ends, columns)


def draw(data: Data) -> Figure:
    """Draw depth and forces over the time, a column for each support."""
    drawn = drawing.figure(7.2, 7.0)
    axes = drawn.subplots(3, 2, sharex=True, sharey="row")
    colors = dict(zip(foundations(), (BLACK, BLUE, RED), strict=True))
    for column, (support, title) in zip(axes.T, TITLES.items(), strict=True):
        column[0].set_title(title)
        for ax, (quantity, (label, factor)) in zip(column, QUANTITIES.items(), strict=True):
            for name, found in data.starts[support].items():
                style: Any = {
                    "color": colors[name],
                    "linestyle": "--" if colors[name] == BLACK else "-",
                }
                ax.semilogx(
                    1e3 * TIMES[1:], factor * getattr(found, quantity)[1:], label=name, **style
                )
                end = factor * float(getattr(data.ends[support][name], STEADY[quantity]))
                ax.axhline(end, color=colors[name], linestyle=":", linewidth=0.9)
            ax.set(ylabel=label, ylim=(0.0, None), xlabel="time [ms]")
            ax.label_outer()
    axes[0, 0].legend(fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("rubber_start", compute, draw)
