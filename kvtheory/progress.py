"""Progress of long work: the callback of the public functions, and a line that shows it."""

import io
import shutil
import sys
import time
from collections.abc import Callable
from typing import TextIO

Progress = Callable[[float, str], object]
"""Called repeatedly with the share of the work done, from 0 to 1, and a text such as
``"600 of 1,000 points"``, which may be empty."""


PATIENCE = 1.0
"""Seconds before anything is shown."""
ON_TERMINAL, IN_LOG = 0.2, 10.0
"""Seconds between two reports."""
BEAT = 1.0
"""Seconds between two signs of life on a terminal, where nothing is reported."""
SETTLING = 0.5
"""Seconds before the remaining time is shown."""


def silent(share: float, words: str) -> None:
    """Report nothing."""


class ProgressLine:
    """Shows progress on a stream, standard error by default: one line on a terminal, lines in a log.

    Examples
    --------
    >>> seconds = iter([0.0, 0.0, 20.0])
    >>> line = ProgressLine("sweep", stream=sys.stdout, clock=lambda: next(seconds))
    >>> line(0.2, "200 of 1,000 points")
    >>> line(0.6, "600 of 1,000 points")
    sweep: 60 %, 20 s left, 600 of 1,000 points
    """

    def __init__(
        self,
        label: str,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
        patience: float = PATIENCE,
    ) -> None:
        self._label, self._clock = label, clock
        self._stream = stream or sys.stderr or io.StringIO()  # standard error may be closed
        self._terminal = self._stream.isatty()
        self._begun = clock()
        self._due = self._begun + (patience if self._terminal else IN_LOG)
        self._first: tuple[float, float] | None = None
        self._last: tuple[float, str] | None = None
        self._width = 0
        self._stale = False

    def __call__(self, share: float, words: str = "") -> None:
        """Report, unless the last report is recent."""
        now = self._clock()
        self._first = self._first or (share, now)
        self._last, self._stale = (share, words), True
        if now >= self._due:
            self._due = now + (ON_TERMINAL if self._terminal else IN_LOG)
            self._write(now)

    def beat(self) -> None:
        """Show on a terminal that the work goes on, where nothing has been reported for a while."""
        if not self._terminal or (now := self._clock()) < self._due:
            return
        self._due = now + BEAT
        share, words = self._last or (0.0, "")
        known = [f"{int(100 * share)} %", words] if self._last else []
        text = ", ".join(filter(None, (*known, f"{duration(now - self._begun)} so far")))
        text = f"{self._label}: {text}"[: shutil.get_terminal_size().columns - 1]
        self._stream.write("\r" + text.ljust(self._width))
        self._stream.flush()
        self._width, self._stale = len(text), True

    def finish(self) -> None:
        """End the line on a terminal, and report for the last time, if anything was shown."""
        if not self._width:
            return
        if self._stale:
            self._write(self._clock())
        if self._terminal:
            self._stream.write("\n")
            self._stream.flush()

    def _write(self, now: float) -> None:
        if self._last is None or self._first is None:
            return
        share, words = self._last
        done, seconds = share - self._first[0], now - self._first[1]
        text = f"{self._label}: {int(100 * share)} %"
        if done > 0.0 and share < 1.0 and seconds > SETTLING:
            text += f", {duration((1.0 - share) * seconds / done)} left"
        text += f", {words}" if words else ""
        if self._terminal:
            text = text[: shutil.get_terminal_size().columns - 1]
            self._stream.write("\r" + text.ljust(self._width))
        else:
            self._stream.write(text + "\n")
        self._width, self._stale = len(text), False
        self._stream.flush()


def duration(seconds: float) -> str:
    """Return a duration in words, to a digit or two.

    >>> [duration(s) for s in (8.2, 300.0, 9000.0, 1e6, 1e10)]
    ['8 s', '5 min', '2 h 30 min', '11 days', '317 years']
    """
    whole = round(seconds)
    minutes, hours, days = whole // 60, whole // 3600, whole // 86400
    if whole < 120:
        return f"{whole} s"
    if minutes < 120:
        return f"{minutes} min"
    if hours < 48:
        return f"{hours} h {minutes % 60} min"
    return f"{days} days" if days < 730 else f"{days // 365:,} years"
