"""Progress of long work: the callback of the public functions, and a line that shows it."""

import io
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TextIO

Progress = Callable[[float, str], object]
"""Called repeatedly with the share done, from 0 to 1, and a text such as ``"600 of 1,000 points"``."""

COMPILING = "compiling, once for this installation"
"""Reported before kernels are compiled, which takes a quarter to half a minute."""
_LISTENER: ContextVar[Callable[[], object]] = ContextVar("_LISTENER", default=lambda: None)

PATIENCE, UNTIL_RATE = 1.0, 0.5
"""Seconds before anything is shown, and before the remaining time is extrapolated."""
ON_TERMINAL, IN_LOG, BEAT = 0.2, 10.0, 1.0
"""Seconds between two reports; and between two updates of a terminal while nothing is reported."""


def silent(share: float, words: str) -> None:
    """Report nothing."""


@contextmanager
def listening(progress: Progress) -> Iterator[Progress]:
    """Provide a progress function to which `compiling` reports, too."""
    reached = 0.0

    def report(share: float, words: str) -> None:
        nonlocal reached
        reached = share
        progress(share, words)

    before = _LISTENER.set(lambda: progress(reached, COMPILING))
    try:
        yield report
    finally:
        _LISTENER.reset(before)


def compiling() -> None:
    """Report to the progress function of this thread that kernels are being compiled."""
    _LISTENER.get()()


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
        self, label: str, stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic, patience: float = PATIENCE,
    ) -> None:  # fmt: skip
        self._label, self._clock, self._begun = label, clock, clock()
        self._stream = stream or sys.stderr or io.StringIO()  # standard error may be closed
        self._terminal = self._stream.isatty()
        self._due = self._begun + (patience if self._terminal else IN_LOG)
        # Share and time from which the remaining time is extrapolated.
        self._rated: tuple[float, float] | None = None
        self._last = 0.0, "", self._begun
        self._width, self._current = 0, True

    def __call__(self, share: float, words: str = "") -> None:
        """Report, unless the last report is recent."""
        now, (_, before, reported) = self._clock(), self._last
        start, since = self._rated or (share, now)
        self._rated = start, since + (now - reported if before == COMPILING else 0.0)
        self._last, self._current = (share, words, now), False
        if now >= self._due or (words == COMPILING and self._terminal):
            self._due = now + (ON_TERMINAL if self._terminal else IN_LOG)
            self._report(now)

    def beat(self) -> None:
        """Show on a terminal that the work goes on if nothing has been reported for a while."""
        now, (share, words, _) = self._clock(), self._last
        if not self._terminal or now < self._due:
            return
        self._due = now + BEAT
        known = [f"{int(100 * share)} %", words] if self._rated else []
        self._show(*known, f"{duration(now - self._begun)} so far")
        self._current = False

    def finish(self) -> None:
        """End the line on a terminal with a last report, if anything was shown."""
        if self._width and self._rated and not self._current:
            self._report(self._clock())
        if self._width and self._terminal:
            self._stream.write("\n")
            self._stream.flush()

    def _report(self, now: float) -> None:
        """Show the last report, with the remaining time once it is known."""
        (share, words, _), (start, since) = self._last, self._rated or (0.0, now)
        left = ""
        if start < share < 1.0 and now - since > UNTIL_RATE and words != COMPILING:
            left = f"{duration((1.0 - share) * (now - since) / (share - start))} left"
        self._show(f"{int(100 * share)} %", left, words)
        self._current = True

    def _show(self, *parts: str) -> None:
        text = f"{self._label}: {', '.join(filter(None, parts))}"
        if self._terminal:
            text = text[: shutil.get_terminal_size().columns - 1]
            self._stream.write("\r" + text.ljust(self._width))
        else:
            self._stream.write(text + "\n")
        self._stream.flush()
        self._width = len(text)


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
