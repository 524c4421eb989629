"""Speed of the dead-weight solution, measured side by side in one run: `make benchmark`.

Each method solves the same scenes; the error is the largest relative error of depth, friction force
and friction coefficient that it achieved, against the exact solution (for `exact` itself against
quadrature, which is known to 1e-12). Times are the least of several runs in random order.
"""

import os
import platform
import random
import time
import warnings
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import kvtheory as kv

R, K, TAU, WEIGHT = 0.01, 1e10, 0.1, 9806.65
REPEATS = 7
NAMES = ("depth", "friction_force", "friction_coefficient")


def velocities(count: int) -> np.ndarray:
    """Return drive velocities over eight decades around V*."""
    return 0.02 * 10.0 ** np.random.default_rng(1).uniform(-4, 4, count)


def exact(V: np.ndarray) -> np.ndarray:
    """Solve all scenes in one call."""
    state = kv.steady(over={"drive.velocity": V})
    return np.array([getattr(state, name) for name in NAMES])


def quadrature(V: np.ndarray) -> np.ndarray:
    """Solve all scenes by the package's quadrature."""
    state = kv.steady(over={"drive.velocity": V}, method="quadrature")
    return np.array([getattr(state, name) for name in NAMES])


def brentq_over_quad(V: np.ndarray) -> np.ndarray:
    """Solve each scene as a user would write it: a root of W(delta) - M g, W by quadrature."""

    def solve(v: float) -> tuple[float, float, float]:
        l_r = v * TAU

        def force(weight_of: Callable[[float], float], delta: float) -> float:
            a = np.sqrt(2 * R * delta)
            end = a * a / (np.sqrt(a * a + l_r * l_r) + l_r)

            def integrand(x: float) -> float:
                return weight_of(x) * K * (delta - x * x / (2 * R) - l_r * x / R)

            return float(quad(integrand, -a, end, epsabs=0, epsrel=1e-12)[0])

        delta = brentq(
            lambda d: force(lambda x: 1.0, d) - WEIGHT, 1e-12, 1e-3, xtol=1e-18, rtol=1e-14
        )
        friction = force(lambda x: -x / R, delta)
        return delta, friction, friction / WEIGHT

    return np.array([solve(float(v)) for v in V]).T


def quadrature_one_by_one(V: np.ndarray) -> np.ndarray:
    """Solve each scene by a call of its own."""
    return np.concatenate([quadrature(np.asarray(v)).reshape(-1, 1) for v in V], axis=1)


METHODS = {
    "exact": (exact, 1_000_000),
    "quadrature": (quadrature, 4_000),
    "quadrature, one by one": (quadrature_one_by_one, 100),
    "brentq over quad": (brentq_over_quad, 100),
}


def main() -> None:
    """Measure, and print one line for each method."""
    order = [name for name in METHODS for _ in range(REPEATS)]
    random.Random(0).shuffle(order)
    seconds: dict[str, float] = dict.fromkeys(METHODS, np.inf)
    errors: dict[str, float] = {}
    for name in order:
        method, count = METHODS[name]
        V = velocities(count)
        start = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # from quad, as friction cancels at low V
            result = method(V)
        seconds[name] = min(seconds[name], (time.perf_counter() - start) / count)
        other = quadrature(V[:40]) if name == "exact" else exact(V)
        errors[name] = float(np.max(np.abs(result[:, : other.shape[1]] / other - 1)))
    print(
        f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}, one core\n"
    )
    print(f"{'method':24}{'scenes/s':>14}{'ratio':>10}{'largest relative difference':>30}")
    slowest = max(seconds.values())
    for name, each in seconds.items():
        print(f"{name:24}{1 / each:14,.0f}{slowest / each:10,.0f}{errors[name]:30.1e}")


if __name__ == "__main__":
    main()
