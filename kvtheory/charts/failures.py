"""The atlas of failures: one entry for each way in which a method fails, computed on request.

The functions here are those of the entries about steady sliding.
"""

import math
import tomllib
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import quad
from scipy.optimize import brentq, newton

from kvtheory.api import asymptotes, steady
from kvtheory.charts import motion_failures
from kvtheory.charts.naive import Array, Outcome
from kvtheory.scene.drives import Drive
from kvtheory.scene.foundations import Arm, Foundation, GeneralizedMaxwell
from kvtheory.scene.indenters import Circle, Parabola
from kvtheory.scene.mistakes import nearest
from kvtheory.scene.model import DeadWeight, Fixed, Scene
from kvtheory.scene.static_state import StaticState

ROLES = "wrong", "right", "package"
TEXTS = "key", "title", "scene", "why", "quantity", "notice", "package"
R, K, TAU, LOAD = 0.01, 1e10, 0.1, 9806.65
"""Table 1, in SI."""
FAR = 1e9
"""l_r/a of the entry on cancellation: Eq. 27 loses two digits for each decade of it."""
SHALLOW = 1e-9
"""Depth (m) of a contact that a quadrature over the whole indenter misses."""
GIVEN_FRICTION = 0.05
FIRST_GUESS = 0.1
"""Velocity (m/s) of Table 1, which lies beyond the maximum of the friction coefficient."""
RUBBER = Arm(3e10, 0.01), Arm(5e9, 1.0)
"""Arms of a foundation that is not Kelvin-Voigt; most of its C is that of the slow arm."""
STEEP = 0.8
"""a/R of the static contact in the entry on the parabola."""


@dataclass(frozen=True)
class Entry:
    """One way in which a method fails."""

    key: str
    title: str
    scene: str
    why: str
    quantity: str
    unit: str  # in which numbers are shown
    factor: float  # to it from SI
    notice: str
    package: str
    tolerance: float  # allowed error of the package relative to the right number, or to `scale`
    x: tuple[str, float, str]  # label, factor and scale of an axis
    y: tuple[str, float, str]
    measure: Callable[[], Outcome]
    scale: float = 0.0  # in SI, where the right number is zero


@dataclass(frozen=True)
class Finding:
    """An entry with its outcome."""

    entry: Entry
    outcome: Outcome

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        numbers = {role: getattr(self.outcome, role) for role in ROLES}
        return {
            **{name: getattr(self.entry, name) for name in TEXTS},
            **{f"{role}_value": x if np.isfinite(x) else None for role, x in numbers.items()},
            "said": self.outcome.said,
        }


def _friction(V: float) -> float:
    return float(steady(over={"drive.velocity": [V]}).friction_coefficient[0])


def _cancellation() -> Outcome:
    a = math.sqrt(2.0 * R * 3e-4)
    ratios = np.geomspace(1e3, FAR, 121)
    l_r = a * ratios
    as_written = np.sqrt(a * a + l_r * l_r) - l_r  # Eq. 27
    ours = steady(Scene.table1("fixed"), over={"drive.velocity": l_r / TAU}).trailing_edge
    series = a / (2.0 * ratios) * (1.0 - 0.25 / ratios**2 + 0.125 / ratios**4)  # to 1e-19
    errors = [np.maximum(np.abs(x / series - 1.0), 1e-17) for x in (as_written, ours)]
    curves = (ratios, errors[0]), (ratios, errors[1])
    return Outcome(as_written[-1], series[-1], ours[-1], *curves)


def _asymptote() -> Outcome:
    critical = asymptotes().critical_velocity
    V, there = critical * np.geomspace(1e-2, 1e2, 81), {"drive.velocity": [critical]}
    exact = steady(over={"drive.velocity": V}).friction_coefficient
    low, high = (line.value for line in asymptotes(over={"drive.velocity": V}).lines[:2])
    at_critical = asymptotes(over=there)
    line = at_critical.lines[0]
    return Outcome(
        line.value[0], steady(over=there, method="quadrature").friction_coefficient[0],
        _friction(critical), (V, np.minimum(low, high)), (V, exact),
        f'kv.asymptotes: regime "{at_critical.regime[0]}", error of the asymptote '
        f'{line.relative_error[0]:.0%}, use "{at_critical.use[0]}"',
    )  # fmt: skip


def _kink() -> Outcome:
    def load(depth: float) -> float:
        """Integrate the pressure over the whole indenter, as if the contact had no edges."""
        return float(quad(lambda x: K * max(depth - x * x / (2.0 * R), 0.0), -R, R)[0])

    depths = np.geomspace(1e-10, 1e-3, 85)
    right = 4.0 / 3.0 * K * np.sqrt(2.0 * R * depths) * depths  # Eq. 40, exact at rest
    still = Scene(support=Fixed(SHALLOW), drive=Drive(velocity=0.0))
    few = depths[::7]
    ours = steady(still, over={"support.depth": few}, method="quadrature").load / right[::7]
    return Outcome(
        load(SHALLOW), 4.0 / 3.0 * K * math.sqrt(2.0 * R * SHALLOW) * SHALLOW,
        steady(still, method="quadrature").load,
        (depths, np.array([load(float(depth)) for depth in depths]) / right), (few, ours),
    )  # fmt: skip


def _no_bracket() -> Outcome:
    def excess(V: float) -> float:
        return _friction(V) - GIVEN_FRICTION

    def root(guess: float) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # from a secant that leaps to 1e50
            found = newton(excess, guess, disp=False, full_output=True)
        return float(found[0]) if found[1].converged else math.nan

    guesses, report = np.geomspace(1e-3, 1.0, 61), asymptotes()
    peak = float(report.peak_velocity)
    # mu rises from zero to its maximum there (fact F3).
    ours = brentq(excess, 0.0, peak, xtol=1e-18, rtol=1e-15)
    # F1 and F2 inverted: mu^3 K R^2/W = m^3/w; its largest root q is on the slow branch.
    m, n = Polynomial([4.0, -5.0, 2.0, -1.0]), Polynomial([3.0, -2.0, 1.0])
    cube = GIVEN_FRICTION**3 * K * R * R / LOAD
    rise = Polynomial([1.0, 1.0]) ** 2 * n**4  # (1 + q)^2 n^4
    roots = (m**3 * Polynomial([0.0, 1.5]) - cube * rise).roots()
    q = roots.real[(abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real < 1.0)].max()
    right = GIVEN_FRICTION * R * 2.0 * n(q) / m(q) * (1.0 - q * q) / (2.0 * q) / TAU
    return Outcome(
        root(FIRST_GUESS), right, ours, (guesses, np.array([root(float(V)) for V in guesses])),
        (guesses, np.full_like(guesses, ours)),
        f"kv.asymptotes: peak_velocity = {1e3 * peak:.4g} mm/s, peak_friction_coefficient = "
        f"{report.peak_friction_coefficient:.4g}",
    )  # fmt: skip


def _steep() -> Outcome:
    weights = K * np.geomspace(0.05, STEEP, 16) ** 3 * R * R / 1.5
    scenes = [
        Scene(shape, support=DeadWeight(W / 9.80665), drive=Drive(velocity=0.1))
        for W in weights.tolist() for shape in (Parabola(R), Circle(R))
    ]  # fmt: skip
    mu = np.array([steady(scene).friction_coefficient for scene in scenes]).reshape(-1, 2)
    slopes = np.array([StaticState.of(scene).half_length / R for scene in scenes[::2]])
    # mu of the circle by sums over 400,000 points, a brute-force method.
    half = 0.5 * math.pi * (np.arange(400_000) + 0.5) / 400_000
    theta = np.concatenate([-half[::-1], half])
    width = R * np.cos(theta) * (half[1] - half[0])
    height, slope, W = R * (1.0 - np.cos(theta)), np.tan(theta), float(weights[-1])

    def pressure(depth: float) -> Array:
        return K * np.maximum(depth - height - 0.1 * TAU * slope, 0.0) * (height < depth)

    depth = brentq(lambda d: pressure(d) @ width - W, 0.0, R, xtol=1e-18, rtol=1e-15)
    right = float(-(pressure(depth) * slope) @ width / W)
    return Outcome(mu[-1, 0], right, mu[-1, 1], (slopes, mu[:, 0]), (slopes, mu[:, 1]))


def _glassy() -> Outcome:
    rubber = Scene(foundation=GeneralizedMaxwell(K, RUBBER), drive=Drive(velocity=1.0))
    plain = replace(rubber, foundation=Foundation(K, rubber.foundation.retardation_time))
    V = np.geomspace(1e-6, 10.0, 141)
    wrong, ours = (
        steady(scene, over={"drive.velocity": V}).friction_coefficient for scene in (plain, rubber)
    )
    end = asymptotes(rubber, tolerance=0.01).lines[1].velocity_max
    return Outcome(
        steady(plain).friction_coefficient,
        steady(rubber, method="quadrature").friction_coefficient,
        steady(rubber).friction_coefficient, (V, wrong), (V, ours),
        f"kv.asymptotes: Kelvin-Voigt with the same C within 1 % up to {1e3 * end:.3g} mm/s",
    )  # fmt: skip


MEASURES = {**vars(motion_failures), **globals()}
"""Each entry is computed by the function of its name."""
ATLAS = {
    key: Entry(key=key, measure=MEASURES["_" + key.replace("-", "_")], **words)
    for key, words in tomllib.loads(
        files("kvtheory.charts").joinpath("atlas.toml").read_text(encoding="utf-8")
    ).items()
}
"""The entries by their keys."""


def findings(only: Sequence[str] = ()) -> Iterator[Finding]:
    """Compute the entries named in `only`, or all of them; `ValueError` if there is no such entry."""
    for key in only:
        if key not in ATLAS:
            raise ValueError(f'`only` "{key}": {nearest(key, ATLAS)}')
    return (Finding(ATLAS[key], ATLAS[key].measure()) for key in only or ATLAS)
