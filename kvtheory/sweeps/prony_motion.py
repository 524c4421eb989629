"""A motion on a Prony series with the states, extremes and settling time that sweeps measure."""

import math
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from kvtheory.models.continuum import maxima
from kvtheory.models.continuum.evaluation import MEASURED
from kvtheory.models.continuum.prony.solved_scene import SolvedPronyScene
from kvtheory.sweeps.plan import Array

GRID, ZOOMS, BESIDE = 65, 2, 2
"""Points around the largest sample, how often they are laid, and the samples that they cover on each side:
two, as a step ends where the next starts. The time is known to 1/256 of the distance of samples."""


class PronyMotion:
    """A solved motion with the interface of `continuum.solver.Trajectory`."""

    def __init__(self, solution: SolvedPronyScene, peaks: bool) -> None:
        self.solution, self.peaks, self.end = solution, peaks, solution.end
        self.given = SimpleNamespace(sprung=not solution.units.rigid_drive)

    @property
    def events(self) -> Any:
        """The events of the contact, and the force maxima."""
        return self.solution.events

    def states(self, s: Any) -> Any:
        """Return the states at an array of scaled times; peak pressures only if they are wanted."""
        there = self.solution.motion.states(s, peaks=self.peaks)
        for name, values in self.solution.scaled_series(there, np.asarray(s)).items():
            there[name] = values
        return there

    @cached_property
    def samples(self) -> tuple[Array, Any, int]:
        """Times that divide each step, the last just before its end; the states there; the number of both."""
        motion = self.solution.motion
        starts = motion.steps["time"][motion.steps["lasts"] > 0.0]
        ends = np.append(starts[1:] * maxima.JUST_BEFORE, motion.end)
        parts = np.linspace(0.0, 1.0, maxima.SAMPLES + 1)
        times = np.minimum(starts[:, None] + (ends - starts)[:, None] * parts, ends[:, None])
        times = np.minimum(times.reshape(-1), self.end)
        return times, self.states(times), times.size

    def largest(self, *wanted: tuple[str, int]) -> Any:
        """Return the extreme of each quantity in a sense, see `maxima.EXTREME`."""
        found = [
            (MEASURED.index(name), sense, *self._largest(name, sense)) for name, sense in wanted
        ]
        return np.array(found, maxima.EXTREME)

    def _largest(self, name: str, sense: int) -> tuple[float, float]:
        times, found, _ = self.samples
        for _ in range(ZOOMS + 1):
            values = found[name]
            measured = np.abs(values) if sense == maxima.MAGNITUDE else sense * values
            k = int(
                np.argmax(np.nan_to_num(measured, nan=-math.inf))
            )  # there are no edges in flight
            best = float(times[k]), float(values[k])
            low, high = times[max(k - BESIDE, 0)], times[min(k + BESIDE, times.size - 1)]
            times = np.unique(np.append(np.linspace(low, high, GRID), best[0]))
            found = self.states(times)
        magnitude = sense == maxima.MAGNITUDE
        return best[0], abs(best[1]) if magnitude else best[1]

    def settled(self, force: float, share: float) -> float:
        """Return the time from which friction stays within a share of `force`; NaN if it does not settle."""
        times, found, _ = self.samples

        def outside(states: Any) -> Any:
            return np.abs(states["friction_force"] - force) > share * abs(force)

        late = np.flatnonzero(outside(found))
        if force == 0.0 or outside(found)[-1]:
            return math.nan
        if not late.size:
            return 0.0
        low, high = times[late[-1]], times[late[-1] + 1]
        for _ in range(maxima.BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if outside(self.states([middle]))[0] else (low, middle)
        return float(high)
