"""How far a sweep is: points done, rate, time left; rewritten on a terminal, lines in a log."""

import sys
import time
from collections.abc import Callable
from typing import TextIO

ON_TERMINAL, IN_LOG = 0.2, 10.0
"""Seconds between two reports."""


class Progress:
    """Writes reports to a stream, standard error by default.

    Call it with the points done, those of them that an earlier run did, the points that failed, and
    all points; `finish` writes the last report.
    """

    def __init__(
        self, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._clock = clock
        self._began = self._shown = clock()
        self._terminal = self._stream.isatty()
        self._last = (0, 0, 0, 0)
        self._width = 0

    def __call__(self, done: int, before: int, failed: int, points: int) -> None:
        """Report, unless the last report is recent."""
        self._last = (done, before, failed, points)
        now = self._clock()
        if now - self._shown >= (ON_TERMINAL if self._terminal else IN_LOG):
            self._shown = now
            self._write()

    def finish(self) -> int:
        """Report for the last time, if there was anything to do; return the points of this run."""
        if self._last[3]:
            self._write()
            if self._terminal:
                self._stream.write("\n")
                self._stream.flush()
        return self._last[0] - self._last[1]

    def _write(self) -> None:
        text = line(*self._last, self._clock() - self._began)
        if self._terminal:
            self._stream.write("\r" + text.ljust(self._width))
            self._width = len(text)
        else:
            self._stream.write(text + "\n")
        self._stream.flush()


def line(done: int, before: int, failed: int, points: int, seconds: float) -> str:
    """Say how far a sweep is; the rate is that of this run alone.

    >>> line(600, 100, 2, 1000, 10.0)
    'sweep: 600 of 1,000 points (60 %), 50 a second, 8 s left, 2 failed'
    """
    share = 100 * done // points if points else 100
    text = f"sweep: {done:,} of {points:,} points ({share} %)"
    rate = (done - before) / seconds if seconds > 0.0 else 0.0
    if rate > 0.0:
        text += f", {rate:,.0f} a second" if rate >= 10.0 else f", {rate:.2g} a second"
        if done < points:
            text += f", {_duration((points - done) / rate)} left"
    return text + (f", {failed:,} failed" if failed else "")


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    minutes, hours = whole // 60, whole // 3600
    return f"{minutes} min" if minutes < 120 else f"{hours} h {minutes % 60} min"
