"""Temperature is velocity: friction at five temperatures, and the one master curve that they form.

A ball on a Prony series whose times follow the equation of Williams, Landel and Ferry (derivation F25). Left,
what a laboratory would see between 0.01 mm/s and 1 m/s. Right, the same over the velocity times the shift
factor a_T: all curves lie on that of the reference temperature. The series is synthetic.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK
from kvtheory.scene.foundations import WLF, Arm

CELSIUS = (0.0, 20.0, 40.0, 60.0, 80.0)
REFERENCE = 20.0
SPEEDS = np.geomspace(1e-5, 1.0, 61)
"""m/s, of the laboratory."""
REDUCED = np.geomspace(1e-8, 1e3, 221)
"""m/s, of the master curve."""
ARMS = (Arm(3e10, 1e-4), Arm(1.2e10, 3e-3), Arm(5e9, 0.1), Arm(2e9, 3.0))
"""At the reference temperature."""


@dataclass(frozen=True)
class Data:
    """mu over `SPEEDS` and shift factors by temperature in degrees Celsius; the master curve on `REDUCED`."""

    curves: dict[float, np.ndarray]
    shift_factors: dict[float, float]
    master: np.ndarray
    columns: drawing.Columns


def scene(celsius: float) -> kv.Scene:
    """Return a ball of 10 mm under 1 N on the rubber at a temperature."""
    rubber = kv.GeneralizedMaxwell(
        stiffness=1e9, arms=ARMS, wlf=WLF(6.7, 134.6), temperature=celsius + 273.15,
        reference_temperature=REFERENCE + 273.15,
    )  # fmt: skip
    return kv.Scene(kv.Sphere(0.01), rubber, kv.DeadWeight(mass=0.3, load=1.0))


def compute() -> Data:
    """Evaluate the exact curves."""
    curves, factors = {}, {}
    for celsius in CELSIUS:
        here = scene(celsius)
        curves[celsius] = kv.steady(here, over={"drive.velocity": SPEEDS}).friction_coefficient
        factors[celsius] = here.foundation.shift_factor
    master = kv.steady(scene(REFERENCE), over={"drive.velocity": REDUCED}).friction_coefficient
    columns = {"V [m/s]": SPEEDS} | {f"mu, {T:g} degC [1]": mu for T, mu in curves.items()}
    return Data(curves, factors, master, columns)


def draw(data: Data) -> Figure:
    """Draw the curves of all temperatures, and the master curve."""
    drawn = drawing.figure(7.2, 3.2)
    left, right = drawn.subplots(1, 2, sharey=True)
    right.loglog(REDUCED, data.master, color=BLACK, linewidth=1.0, label="master curve")
    for celsius, color in zip(CELSIUS, colormaps["plasma"](np.linspace(0.0, 0.8, 5)), strict=True):
        mu = data.curves[celsius]
        left.loglog(SPEEDS, mu, color=color, label=f"{celsius:g} °C")
        right.loglog(
            SPEEDS * data.shift_factors[celsius], mu, color=color, linewidth=3.0, alpha=0.5
        )
    left.set(xlabel="$V$ [m/s]", ylabel=r"$\mu$", title="in the laboratory")
    right.set(xlabel=r"$V a_T$ [m/s]", title="shifted to 20 °C")
    left.legend(fontsize=8)
    right.legend(loc="lower center", fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("temperature", compute, draw)
