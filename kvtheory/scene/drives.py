"""How the foundation moves: at one velocity, along a history, or by a function of the time."""

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from kvtheory.scene.base_motion import SAME_TIME, BaseMotion
from kvtheory.scene.mistakes import Problems, SceneError, mistake, problem
from kvtheory.scene.quantities import (
    Derived,
    Part,
    Quantity,
    Value,
    array_of,
    convert,
    quantities,
    quantity,
    validate,
)
from kvtheory.scene.waveforms import WAVEFORMS, Waveform

VELOCITY = Quantity(
    "m/s", "V, drive velocity of the foundation, from rest to this at t = 0", -math.inf, True
)
TIME = Quantity("s", "time", 0.0, False)
SPRING = "stiffness", "damping", "mass"
"""The quantities of the spring between the drive and the indenter."""

LEAST_TOLERANCE = 1e-13
"""Smallest tolerance of a drive that is a function; below it rounding limits the polynomials."""
MOST_CYCLES = 10_000
"""Largest number of periods of a waveform in a run, which computes them one by one."""
SMOOTH = 1e-9
"""Largest relative change of a function across a break that is not a jump."""
ON_LINE = 4.0 * 2.0**-52
"""A point of a history this near to the line between its neighbours, relative to V, is redundant."""


@dataclass(frozen=True, eq=False)
class Drive(Part):
    """The motion of the foundation: a `velocity` from t = 0 on, a `history`, `waveform` or `function`.

    A history holds pairs (time, velocity). It is linear between its points and jumps where a time
    is repeated; it starts at t = 0 and keeps its final velocity.

    A `waveform` oscillates or rises smoothly: `Sine`, `Triangle` or `SmoothRamp`.

    A function V(t), in Python only, returns m/s for a time in s. It is smooth except at the `breaks`: the
    times at which it jumps or has a kink. The transient replaces it by polynomials, with an error of at
    most `tolerance` times max(|V|, a_0/tau), a_0 the static half length.

    With a `stiffness` the drive holds the indenter along x by a spring, with a `damping` in parallel; the
    `mass` that moves along x is that of the support if not given. Without a stiffness the drive is rigid.

    >>> Drive(history=[("0 s", "0 m/s"), ("50 ms", "0.1 m/s")]).final_velocity
    0.1
    >>> Drive(function=lambda t: 0.1 * math.sin(50.0 * t)).called(0.01)
    0.0479425538604203
    >>> from kvtheory.scene.waveforms import SmoothRamp
    >>> Drive(waveform=SmoothRamp(velocity="0.1 m/s", rise_time="10 ms")).final_velocity
    0.1
    >>> Drive(velocity="0.1 m/s", stiffness="1 MN/m^2").stiffness
    1000000.0
    """

    velocity: float | None = field(default=None, metadata={"quantity": VELOCITY})
    history: Sequence[tuple[float, float]] | None = None
    function: Callable[[float], float] | None = None
    waveform: Waveform | None = None
    breaks: Sequence[float] = ()
    tolerance: float = 1e-12
    stiffness: Value = quantity(
        "N/m^2",
        "k_x, stiffness of a spring between drive and indenter; zero if it coasts",
        exclusive=False, default=None, per_width=True,
    )  # fmt: skip
    damping: Value = quantity(
        "N*s/m^2", "c_x, damping beside the spring",
        exclusive=False, default=Derived(0.0), per_width=True,
    )  # fmt: skip
    mass: Value = quantity(
        "kg/m", "M_x, mass that moves along x; that of the support if not given",
        default=None, per_width=True,
    )  # fmt: skip

    def __post_init__(self) -> None:
        problems = Problems()
        function = None if self.function is self.waveform else self.function  # of a copy
        ways = self.velocity, self.history, function, self.waveform
        if sum(given is not None for given in ways) != 1:
            message = "drive: expected one of velocity, history and waveform, such as "
            problems.append(message + 'velocity = "100 mm/s"; or, in Python, a function')
        if not isinstance(self.waveform, Waveform | None):
            *names, last = (cls.__name__ for cls in WAVEFORMS.values())
            message = f"expected a {', '.join(names)} or {last}"
            problems.add("drive.waveform", self.waveform, message)
        elif self.waveform is not None:
            object.__setattr__(self, "function", self.waveform)
            self.mark([self.waveform])
        with problems.catching("drive", self):
            validate(self, "drive")
        for name, value in {"damping": self.damping, "mass": self.mass}.items():
            if self.rigid and value is not None:
                message = "needs drive.stiffness, of the spring between drive and indenter"
                problems.add(f"drive.{name}", value, message)
        if self.damping is None:
            object.__setattr__(self, "damping", Derived(0.0))
        if self.history is not None:
            with problems.catching("drive.history", self.history):
                object.__setattr__(self, "history", history_points(self.history))
        if self.function is None:
            if not (isinstance(self.breaks, tuple) and self.breaks == ()):
                problems.add("drive.breaks", self.breaks, "needs a function")
        elif not callable(self.function):
            problems.add("drive.function", self.function, "expected a function V(t)")
        with problems.catching("drive.breaks", self.breaks):
            breaks = sorted(np.atleast_1d(array_of(self.breaks, TIME)).tolist())
            object.__setattr__(self, "breaks", tuple(breaks))
        given = self.tolerance
        if not (isinstance(given, (int, float)) and LEAST_TOLERANCE <= given <= 1.0):
            problems.add("drive.tolerance", given, f"expected a number from {LEAST_TOLERANCE} to 1")
        problems.report()

    def arrays(self) -> dict[str, Any]:
        """Return the arrays among the quantities; those of a waveform are keys of the drive itself."""
        own = {name: each for name, each in super().arrays().items() if "." not in name}
        return own if self.waveform is None else {**own, **self.waveform.arrays()}

    @property
    def rigid(self) -> bool:
        """Whether the indenter cannot move along x: there is no spring."""
        return self.stiffness is None

    @property
    def coasts(self) -> bool:
        """Whether the indenter is free to move along x, without a spring that would hold it."""
        return not (self.rigid or np.all(self.stiffness))

    @cached_property
    def points(self) -> tuple[tuple[float, float], ...]:
        """The necessary points (time, velocity), in SI; a drive that is a function raises SceneError.

        A constant velocity has one; points of a history are left out if they lie on the line between their
        neighbours, or repeat the final velocity.

        >>> Drive(history=[(0.0, 0.1), (1.0, 0.1), (1.0, 0.2), (2.0, 0.2)]).points
        ((0.0, 0.1), (1.0, 0.1), (1.0, 0.2))
        """
        if self.function is not None:
            way = "function" if self.waveform is None else "waveform"
            message = (
                "it moves the foundation in a transient only; give a velocity or a history here"
            )
            raise SceneError([f"drive.{way}: {message}"])
        if self.history is None:
            return ((0.0, self.velocity),)  # type: ignore[return-value]
        history = self.history
        if len(history) > 1 and history[1][0] == history[0][0]:
            history = history[1:]  # a jump at t = 0 starts from rest
        kept = [history[0]]
        for point, (later, next_velocity) in pairwise(history[1:]):
            (before, last), (time, velocity) = kept[-1], point
            if point == kept[-1]:
                continue
            size = ON_LINE * max(abs(last), abs(velocity), abs(next_velocity))
            if later > before and (before < time < later or last == velocity == next_velocity):
                share = (time - before) / (later - before)
                if abs(last + share * (next_velocity - last) - velocity) <= size:
                    continue
            kept.append(point)
        if len(history) > 1:
            kept.append(history[-1])
        while len(kept) > 1 and kept[-1][1] == kept[-2][1]:
            kept.pop()
        return tuple(kept)

    @property
    def final_velocity(self) -> Any:
        """The final velocity of the drive, in m/s; a function has none, and raises SceneError."""
        last = getattr(self.waveform, "final_velocity", None)
        return self.points[-1][1] if last is None else last

    @property
    def ends(self) -> bool:
        """Whether the drive has a final velocity."""
        return self.function is None or getattr(self.waveform, "final_velocity", None) is not None

    @property
    def constant(self) -> bool:
        """Whether the velocity is constant from t = 0 on; that of a function is assumed to vary."""
        return self.function is None and len(self.points) == 1

    @property
    def jumps(self) -> tuple[float, ...]:
        """The times in s at which the velocity jumps, t = 0 among them; of a function, those of its `breaks`.

        >>> Drive(function=lambda t: 0.1 * t if t < 1.0 else 0.3, breaks=[1.0, 2.0]).jumps
        (1.0,)
        """
        if self.function is None:
            later = [b for (a, _), (b, _) in pairwise(self.points) if a == b]
            return (*([0.0] if self.points[0][1] != 0.0 else []), *later)

        def jumps(time: float) -> bool:  # a smooth function changes by no more than rounding
            before, after = (self.called(math.nextafter(time, to)) for to in (0.0, math.inf))
            return abs(after - before) > SMOOTH * max(abs(before), abs(after))

        later = [t for t in sorted(set(self.breaks)) if t > 0.0 and jumps(t)]
        return (*([0.0] if self.called(0.0) != 0.0 else []), *later)

    @property
    def changes(self) -> tuple[float, ...]:
        """The times in s at which V jumps or has a kink, in order, with t = 0; not those of a waveform."""
        times = self.breaks if self.function is not None else (time for time, _ in self.points)
        return tuple(sorted({0.0, *times}))

    @property
    def last_change(self) -> float:
        """The time in s after which the velocity stays the same; a function has none, and raises."""
        if self.waveform is not None and self.waveform.settled < math.inf:
            return self.waveform.settled
        return self.points[-1][0]

    def faster(self, times: float) -> "Drive":
        """Return the drive with every velocity multiplied by `times`.

        >>> Drive(history=[(0.0, 0.1), (1.0, -0.2)]).faster(2.0).points
        ((0.0, 0.2), (1.0, -0.4))
        """
        if self.function is not None:
            return replace(self, function=lambda t: times * self.called(t), waveform=None)
        if self.history is not None:
            return replace(self, history=[(time, times * speed) for time, speed in self.history])
        return replace(self, velocity=times * self.final_velocity)

    def changed(self, **values: float) -> "Drive":
        """Return the drive with some quantities replaced: those of its waveform, or of its spring.

        A velocity replaces a history, waveform or function.

        >>> Drive(history=[(0.0, 0.1), (1.0, 0.2)], stiffness=1e6).changed(velocity=0.3).points
        ((0.0, 0.3),)
        """
        wave = self.waveform
        new: dict[str, Any] = {name: value for name, value in values.items() if name in SPRING}
        moves = {name: value for name, value in values.items() if name not in SPRING}
        if moves and wave is not None and moves.keys() <= quantities(wave).keys():
            new |= {"waveform": wave.changed(**moves), "function": None}
        elif moves:
            new |= {"history": None, "function": None, "waveform": None, "breaks": (), **moves}
        return replace(self, **new)

    def motion(self, end: float, least: float) -> BaseMotion:
        """Return V(t) and Y(t) as polynomials, up to the time `end` (s) or the end of a longer history.

        The error of a function is relative to max(|V|, `least`); one with more breaks raises ValueError.
        """
        if self.function is None:
            return BaseMotion.from_points(self.points, end)
        wave = self.waveform or Waveform()
        if end > MOST_CYCLES * wave.period:
            message = f"more than {MOST_CYCLES:,} cycles until {end:.6g} s; expected a shorter run"
            raise mistake("drive.frequency", f"{1.0 / wave.period:g} Hz", message)
        if (points := getattr(wave, "points", None)) is not None:
            return BaseMotion.from_points(points(end), end)
        first = min(end, wave.period, wave.settled)
        motion = BaseMotion.from_function(
            self.called, first, tolerance=0.5 * self.tolerance, breaks=self.breaks, least=least
        )
        return motion.repeated(end) if wave.period < math.inf else motion.kept(end)

    def called(self, time: float) -> float:
        """Return the value of `function` at `time` (s), in m/s; it must be one finite number."""
        try:
            with np.errstate(all="ignore"):  # an infinity is reported below
                given = self.function(time)  # type: ignore[misc]
        except Exception as error:
            message = f"drive.function raised {type(error).__name__} at t = {time!r} s: {error}"
            raise ValueError(message) from error
        value = math.nan
        if not isinstance(given, str):
            with suppress(TypeError, ValueError):
                value = float(given)
        if not math.isfinite(value):
            key = f"drive.function({time!r})"
            raise ValueError(problem(key, given, "expected a finite number, in m/s"))
        return value


def history_points(
    points: Any, key: str = "drive.history", of: Quantity = VELOCITY, name: str = "velocity",
    example: str = '[["0 ms", "100 mm/s"], ["50 ms", "0 mm/s"]]',
) -> tuple[tuple[float, float], ...]:  # fmt: skip
    """Convert the points of a history, of a drive or a depth, or report every one that is wrong."""
    if isinstance(points, np.ndarray):
        points = points.tolist()
    if isinstance(points, str) or not isinstance(points, Sequence) or not points:
        raise mistake(key, points, f"expected points such as {example}")
    problems = Problems()
    values: list[float] = []
    for index, point in enumerate(points):
        if isinstance(point, str) or not isinstance(point, Sequence) or len(point) != 2:
            problems.add(f"{key}[{index}]", point, f'expected a pair ["time", "{name}"]')
            continue
        for value, spec in zip(point, (TIME, of), strict=True):
            with problems.catching(f"{key}[{index}]", value):
                values.append(convert(value, spec))
    if not problems:
        times, velocities = values[::2], values[1::2]
        for i, (before, time) in enumerate(pairwise(times), start=1):
            if 0.0 < before - time <= SAME_TIME * math.ulp(before):
                times[i] = before  # the same but for rounding, as in i * 0.1 + 0.1
        if times[0] != 0.0:
            problems.add(f"{key}[0]", points[0], "the first time must be 0 s")
        message = "times must not decrease, and a time may occur at most twice"
        for i in range(1, len(times)):
            if times[i] < times[i - 1] or (i > 1 and times[i] == times[i - 2]):
                problems.add(f"{key}[{i}]", points[i], message)
    problems.report()
    return tuple(zip(times, velocities, strict=True))
