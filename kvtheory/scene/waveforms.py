"""Waveforms: velocities V(t) that a scene file can name, each a function of the time in s.

A new one is a class with its name `waveform` and V(t), and an entry of `WAVEFORMS`.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from kvtheory.scene.quantities import Part, Value, quantity, validate

AT_LAST = 20.0
"""Rise times after which tanh is 1 to the last digit."""
MOST_CORNERS = 100_000
"""Most corners of a list; a drive has fewer, see `drives.MOST_CYCLES`."""


class Waveform(Part):
    """A velocity V(t): its period, the time in s at which it has settled, and its final velocity."""

    waveform: ClassVar[str]
    period: float = math.inf
    settled: float = math.inf
    final_velocity: ClassVar[float | None] = None

    def __post_init__(self) -> None:
        validate(self, "drive")


@dataclass(frozen=True, eq=False)
class _Swing(Waveform):
    amplitude: Value = quantity("m/s", "largest velocity minus the mean")
    frequency: Value = quantity("1/s", "cycles per unit time")
    mean: Value = quantity("m/s", "mean velocity", minimum=-math.inf, default=0.0)

    @property
    def period(self) -> float:  # type: ignore[override]
        """The duration of a cycle."""
        return 1.0 / self.frequency


@dataclass(frozen=True, eq=False)
class Sine(_Swing):
    """V = mean + amplitude sin(2 pi frequency t), in m/s.

    >>> round(Sine(amplitude="100 mm/s", frequency="5 Hz")(0.05), 12)
    0.1
    """

    waveform: ClassVar[str] = "sine"

    def __call__(self, t: float) -> float:
        """Return V."""
        return self.mean + self.amplitude * math.sin(2.0 * math.pi * self.frequency * t)


@dataclass(frozen=True, eq=False)
class Triangle(_Swing):
    """V rises and falls linearly between mean + amplitude and mean - amplitude, starting at the mean.

    >>> wave = Triangle(amplitude=0.1, frequency=5.0)
    >>> [round(wave(t), 12) for t in (0.025, 0.05, 0.1, 0.15)]
    [0.05, 0.1, 0.0, -0.1]
    """

    waveform: ClassVar[str] = "triangle"

    def __call__(self, t: float) -> float:
        """Return V."""
        quarters = 4.0 * self.frequency * t
        nearest = 2.0 * round(0.5 * quarters)  # where it crosses the mean
        sign = -1.0 if round(0.5 * quarters) % 2 else 1.0
        return self.mean + sign * self.amplitude * (quarters - nearest)

    def points(self, end: float) -> list[tuple[float, float]]:
        """Return the corners (t, V), at most `MOST_CORNERS`, up to the first one at or after `end`."""
        if 2.0 * self.frequency * end > MOST_CORNERS:
            raise ValueError(f"more than {MOST_CORNERS} corners until {end!r} s")
        found, k = [(0.0, self.mean)], 0
        while found[-1][0] < end:
            height = self.amplitude * (-1.0 if k % 2 else 1.0)
            found.append(((2 * k + 1) / (4.0 * self.frequency), self.mean + height))
            k += 1
        return found


@dataclass(frozen=True, eq=False)
class SmoothRamp(Waveform):
    """V = velocity tanh(t/rise_time): a smooth rise from rest, with a kink only at the start.

    >>> round(SmoothRamp(velocity=0.1, rise_time="10 ms")(0.01), 6)
    0.076159
    """

    waveform: ClassVar[str] = "smooth-ramp"
    velocity: Value = quantity("m/s", "final velocity", minimum=-math.inf)
    rise_time: Value = quantity("s", "time to reach tanh 1 = 76 % of it")

    @property
    def settled(self) -> float:  # type: ignore[override]
        """The time after which tanh is 1 to the last digit."""
        return AT_LAST * self.rise_time

    @property
    def final_velocity(self) -> float:  # type: ignore[override]
        """The final velocity."""
        return self.velocity

    def __call__(self, t: float) -> float:
        """Return V."""
        return self.velocity * math.tanh(t / self.rise_time)


WAVEFORMS: dict[str, Any] = {cls.waveform: cls for cls in (Sine, Triangle, SmoothRamp)}
"""The waveforms that a scene file can name."""
