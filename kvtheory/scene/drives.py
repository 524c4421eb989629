"""How the foundation moves: at one velocity, along a history, or by a function of the time."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kvtheory.scene.fields import Quantity, SceneError, convert, problem, settle

VELOCITY = Quantity(
    "m/s", "V, drive velocity of the foundation, from rest to this at t = 0", -math.inf, True
)
TIME = Quantity("s", "time", 0.0, False)


LEAST_TOLERANCE = 1e-13
"""Of a drive that is a function: polynomials are not closer to it than rounding."""


@dataclass(frozen=True)
class Drive:
    """The motion of the foundation: one `velocity` from t = 0 on, a `history`, or a `function`.

    A history holds pairs (time, velocity). It is linear between its points and jumps where a time
    stands twice; it starts at t = 0 and keeps its last velocity.

    A function V(t), from Python only, gives m/s at the time in s, smoothly but at the `breaks`: the
    times at which it jumps or has a kink. The transient replaces it by polynomials, with an error of at
    most `tolerance` times max(|V|, a_0/tau), a_0 the static half length.

    Examples
    --------
    >>> Drive(history=[("0 s", "0 m/s"), ("50 ms", "0.1 m/s")]).final_velocity
    0.1
    >>> Drive(function=lambda t: 0.1 * math.sin(50.0 * t)).called(0.01)
    0.0479425538604203
    """

    velocity: float | None = field(default=None, metadata={"quantity": VELOCITY})
    history: Sequence[tuple[float, float]] | None = None
    function: Callable[[float], float] | None = None
    breaks: Sequence[float] = ()
    tolerance: float = 1e-12

    def __post_init__(self) -> None:
        if sum(given is not None for given in (self.velocity, self.history, self.function)) != 1:
            raise SceneError(
                [
                    'drive: expected one of velocity and history, such as velocity = "100 mm/s"; '
                    "or, in Python, a function"
                ]
            )
        if self.velocity is not None:
            settle(self, "drive")
        elif self.history is not None:
            object.__setattr__(self, "history", _history(self.history))
        object.__setattr__(self, "breaks", _breaks(self))

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """The points (time, velocity) of a history, or the one point of a velocity; see `history`.

        Raises
        ------
        SceneError
            If the drive is a function.
        """
        if self.function is not None:
            raise SceneError(
                [
                    "drive.function: a function V(t) moves the foundation in a transient only; give a "
                    "velocity or a history here"
                ]
            )
        return ((0.0, self.velocity),) if self.history is None else tuple(self.history)  # type: ignore[return-value]

    @property
    def final_velocity(self) -> float:
        """The velocity that the drive ends with, in m/s; a function has none, and raises SceneError."""
        return self.points[-1][1]

    def called(self, time: float) -> float:
        """Return what `function` gives at `time` (s), in m/s.

        Raises
        ------
        ValueError
            If it raises an exception, or gives anything but one finite number.
        """
        try:
            with np.errstate(all="ignore"):  # an infinity is reported below
                given = self.function(time)  # type: ignore[misc]
        except Exception as error:
            raise ValueError(
                f"drive.function raised {type(error).__name__} at t = {time!r} s: {error}"
            ) from error
        try:
            value = math.nan if isinstance(given, str) else float(given)
        except (TypeError, ValueError):
            value = math.nan
        if not math.isfinite(value):
            raise ValueError(
                problem(f"drive.function({time!r})", given, "expected a finite number, in m/s")
            )
        return value


def _breaks(drive: Drive) -> tuple[float, ...]:
    """Return the breaks in s and in order, or report everything about a function that is wrong."""
    problems, times = [], []
    if drive.function is None:
        if not (isinstance(drive.breaks, tuple) and drive.breaks == ()):
            problems.append(problem("drive.breaks", drive.breaks, "needs a function"))
    elif not callable(drive.function):
        problems.append(problem("drive.function", drive.function, "expected a function V(t)"))
    several = isinstance(drive.breaks, (Sequence, np.ndarray)) and not isinstance(drive.breaks, str)
    for time in drive.breaks if several else [drive.breaks]:
        try:
            times.append(convert(time, TIME))
        except ValueError as error:
            problems.append(problem("drive.breaks", time, str(error)))
    tolerance = drive.tolerance
    if not (isinstance(tolerance, (int, float)) and LEAST_TOLERANCE <= tolerance <= 1.0):
        problems.append(
            problem("drive.tolerance", tolerance, f"expected a number from {LEAST_TOLERANCE} to 1")
        )
    if problems:
        raise SceneError(problems)
    return tuple(sorted(times))


def _history(points: Any) -> tuple[tuple[float, float], ...]:
    """Convert the points of a drive history, or report every one that is wrong."""
    key = "drive.history"
    if isinstance(points, str) or not isinstance(points, Sequence) or not points:
        raise SceneError(
            [
                problem(
                    key,
                    points,
                    'expected points such as [["0 ms", "100 mm/s"], ["50 ms", "0 mm/s"]]',
                )
            ]
        )
    problems, converted = [], []
    for index, point in enumerate(points):
        if isinstance(point, str) or not isinstance(point, Sequence) or len(point) != 2:
            problems.append(
                problem(f"{key}[{index}]", point, 'expected a pair ["time", "velocity"]')
            )
            continue
        pair = []
        for value, spec in zip(point, (TIME, VELOCITY), strict=True):
            try:
                pair.append(convert(value, spec))
            except ValueError as error:
                problems.append(problem(f"{key}[{index}]", value, str(error)))
        converted.append(tuple(pair))
    if not problems:
        times = [time for time, _ in converted]
        if times[0] != 0.0:
            problems.append(problem(f"{key}[0]", points[0], "the first time must be 0 s"))
        problems += [
            problem(
                f"{key}[{i}]",
                points[i],
                "times must not decrease, and one time may stand at most twice",
            )
            for i in range(1, len(times))
            if times[i] < times[i - 1] or (i > 1 and times[i] == times[i - 2])
        ]
    if problems:
        raise SceneError(problems)
    return tuple(converted)  # type: ignore[arg-type]
