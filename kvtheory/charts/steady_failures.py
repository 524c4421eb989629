"""Entries of the atlas about steady sliding."""

import math
import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq, newton

from kvtheory.api import asymptotes, steady
from kvtheory.charts.entry import Line, Outcome, Picture
from kvtheory.scene.drives import Drive
from kvtheory.scene.foundations import Arm, Foundation, GeneralizedMaxwell
from kvtheory.scene.indenters import Circle, Parabola
from kvtheory.scene.model import DeadWeight, Fixed, Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

FAR = 1e9
"""l_r/a of the entry on cancellation: Eq. 27 loses twice as many digits as it has decades."""
SHALLOW = 1e-9
"""Depth (m) of a contact that a quadrature over the whole indenter misses."""
WANTED_FRICTION = 0.05
FIRST_GUESS = 0.1
"""Velocity (m/s) of Table 1, which lies beyond the maximum of the friction coefficient."""
RUBBER = Arm(3e10, 0.01), Arm(5e9, 1.0)
"""Arms of a foundation that is not Kelvin-Voigt; its C is mostly that of the slow one."""
STEEP = 0.8
"""a/R of the static contact in the entry on the parabola."""


def _cancellation() -> Outcome:
    fixed = Scene.table1("fixed")
    delta, R, tau = 3e-4, 0.01, fixed.foundation.retardation_time
    a = math.sqrt(2.0 * R * delta)
    ratios = np.geomspace(1e3, FAR, 121)
    l_r = a * ratios
    as_written = np.sqrt(a * a + l_r * l_r) - l_r  # Eq. 27
    ours = steady(fixed, over={"drive.velocity": l_r / tau}).trailing_edge
    series = a / (2.0 * ratios) * (1.0 - 0.25 / ratios**2 + 0.125 / ratios**4)  # to 1e-19
    errors = [np.maximum(np.abs(x / series - 1.0), 1e-17) for x in (as_written, ours)]
    labels = r"$l_\mathrm{r}/a$", r"relative error of $x_\mathrm{TE}$"
    curves = ((ratios, error) for error in errors)
    return Outcome(
        float(as_written[-1]), float(series[-1]), float(ours[-1]),
        Picture.of(*labels, *curves, log_x=True, log_y=True),
    )  # fmt: skip


def _asymptote() -> Outcome:
    table1 = Scene()
    critical = asymptotes(table1).critical_velocity
    V = critical * np.geomspace(1e-2, 1e2, 81)
    by_integration = steady(over={"drive.velocity": [critical]}, method="quadrature")
    exact = steady(over={"drive.velocity": V})
    lines = asymptotes(over={"drive.velocity": V}).lines[:2]
    nearer = np.minimum(lines[0].value, lines[1].value)
    at_critical = asymptotes(over={"drive.velocity": [critical]})
    return Outcome(
        float(at_critical.lines[0].value[0]),
        float(by_integration.friction_coefficient[0]),
        float(steady(over={"drive.velocity": [critical]}).friction_coefficient[0]),
        Picture.of("V [mm/s]", "friction coefficient", (1e3 * V, nearer),
                   (1e3 * V, exact.friction_coefficient), log_x=True, log_y=True),
        f'kv.asymptotes: regime "{at_critical.regime[0]}", error of the asymptote '
        f'{at_critical.lines[0].relative_error[0]:.0%}, use "{at_critical.use[0]}"',
    )  # fmt: skip


def _load_over_the_whole_indenter(depth: float) -> float:
    """Integrate the pressure of a contact at rest over the whole indenter, as if it had no edges."""
    R, K = 0.01, 1e10
    found: float = quad(lambda x: K * max(depth - x * x / (2.0 * R), 0.0), -R, R)[0]
    return found


def _kink() -> Outcome:
    depths = np.geomspace(1e-10, 1e-3, 85)
    right = 4.0 / 3.0 * 1e10 * np.sqrt(0.02 * depths) * depths  # Eq. 40, exact at rest
    naive = np.array([_load_over_the_whole_indenter(float(depth)) for depth in depths])
    still = Scene(support=Fixed(SHALLOW), drive=Drive(velocity=0.0))
    ours = [
        float(steady(still, over={"support.depth": [float(depth)]}, method="quadrature").load[0])
        for depth in depths[::7]
    ]
    return Outcome(
        _load_over_the_whole_indenter(SHALLOW),
        4.0 / 3.0 * 1e10 * math.sqrt(0.02 * SHALLOW) * SHALLOW,
        steady(still, method="quadrature").load,
        Picture.of("depth [mm]", "load / exact load", (1e3 * depths, naive / right),
                   (1e3 * depths[::7], np.array(ours) / right[::7]), log_x=True),
    )  # fmt: skip


def _no_bracket() -> Outcome:
    def friction(V: float) -> float:
        return float(steady(over={"drive.velocity": [V]}).friction_coefficient[0])

    def root(guess: float) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a secant that leaps to 1e50
            found = newton(
                lambda V: friction(V) - WANTED_FRICTION, guess, disp=False, full_output=True
            )
        return float(found[0]) if found[1].converged else math.nan

    guesses = np.geomspace(1e-3, 1.0, 61)
    found = np.array([root(float(guess)) for guess in guesses])
    peak = float(asymptotes().peak_velocity)
    # mu rises from zero to its maximum there (fact F3).
    ours = brentq(lambda V: friction(V) - WANTED_FRICTION, 0.0, peak, xtol=1e-18, rtol=1e-15)
    # F1 and F2 the other way round: the root q of mu^3 K R^2/W = m^3/w, found among all of them.
    q = _ratio_of_friction(WANTED_FRICTION**3 * 1e10 * 0.01**2 / 9806.65)
    a = WANTED_FRICTION * 0.01 * 2 * (q * q - 2 * q + 3) / ((1 - q) * (q * q - q + 4))
    right = a * (1.0 - q * q) / (2.0 * q) / 0.1
    return Outcome(
        root(FIRST_GUESS), right, ours,
        Picture("first guess of V [mm/s]", "root V [mm/s]",
                (Line("wrong", 1e3 * guesses, 1e3 * found),
                 Line("right", 1e3 * guesses, np.full_like(guesses, 1e3 * right))), log_x=True),
        f"kv.asymptotes: peak_velocity = {1e3 * peak:.4g} mm/s, peak_friction_coefficient = "
        f"{asymptotes().peak_friction_coefficient:.4g}",
    )  # fmt: skip


def _ratio_of_friction(cube: float) -> float:
    """Return the largest q in (0, 1) at which a dead weight has mu^3 K R^2/W = `cube`: the slow branch."""
    m = np.polynomial.Polynomial([4.0, -5.0, 2.0, -1.0])  # (1 - q)(q^2 - q + 4)
    n = np.polynomial.Polynomial([3.0, -2.0, 1.0])  # q^2 - 2 q + 3
    rise = np.polynomial.Polynomial([1.0, 1.0]) ** 2 * n**4  # (1 + q)^2 n^4
    roots = (m**3 * np.polynomial.Polynomial([0.0, 1.5]) - cube * rise).roots()
    inside = roots.real[(abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real < 1.0)]
    return float(inside.max())


def _steep() -> Outcome:
    R, foundation = 0.01, Scene().foundation
    weights = foundation.stiffness * np.geomspace(0.05, STEEP, 16) ** 3 * R * R / 1.5
    scenes = [
        Scene(shape, foundation, DeadWeight(float(W) / 9.80665), Drive(velocity=0.1))
        for W in weights for shape in (Parabola(R), Circle(R))
    ]  # fmt: skip
    mu = np.array([steady(scene).friction_coefficient for scene in scenes]).reshape(-1, 2)
    slopes = np.array([StaticState.of(scene).half_length / R for scene in scenes[::2]])
    return Outcome(
        float(mu[-1, 0]), _circle_by_sums(scenes[-1]), float(mu[-1, 1]),
        Picture.of(r"static half length $a_0/R$", "friction coefficient",
                   (slopes, mu[:, 0]), (slopes, mu[:, 1])),
    )  # fmt: skip


def _glassy() -> Outcome:
    rubber = Scene(foundation=GeneralizedMaxwell(1e10, RUBBER), drive=Drive(velocity=1.0))
    plain = replace(rubber, foundation=Foundation(1e10, rubber.foundation.retardation_time))
    V = np.geomspace(1e-6, 10.0, 141)
    over = {"drive.velocity": V}
    ours, wrong = (steady(scene, over=over).friction_coefficient for scene in (rubber, plain))
    end = asymptotes(rubber, tolerance=0.01).lines[1].velocity_max
    return Outcome(
        float(steady(plain).friction_coefficient),
        float(steady(rubber, method="quadrature").friction_coefficient),
        float(steady(rubber).friction_coefficient),
        Picture.of("V [mm/s]", "friction coefficient", (1e3 * V, wrong), (1e3 * V, ours),
                   log_x=True, log_y=True),
        f"kv.asymptotes: Kelvin-Voigt with the same C within 1 % up to {1e3 * end:.3g} mm/s",
    )  # fmt: skip


def _circle_by_sums(scene: Scene) -> float:
    """Return mu of a circle by sums over 400 000 points, a brute-force method."""
    R, K, W = 0.01, 1e10, scene.support.weight
    l_r = 0.1 * scene.foundation.retardation_time
    half = 0.5 * math.pi * (np.arange(400_000) + 0.5) / 400_000
    theta = np.concatenate([-half[::-1], half])
    width = R * np.cos(theta) * (half[1] - half[0])
    height, slope = R * (1.0 - np.cos(theta)), np.tan(theta)

    def pressure(depth: float) -> Array:
        return K * np.maximum(depth - height - l_r * slope, 0.0) * (height < depth)

    depth = brentq(lambda d: pressure(d) @ width - W, 0.0, R, xtol=1e-18, rtol=1e-15)
    return float(-(pressure(depth) * slope) @ width / W)
