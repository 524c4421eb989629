"""Progress of long work: the callback of the public functions, and a bar that shows it."""

import io
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from threading import Event, Thread
from typing import Any, TextIO

Progress = Callable[[float, str], object]
"""Called repeatedly with the share done, from 0 to 1, and a text such as ``"600 of 1,000 points"``."""

COMPILING = "compiling, once for this installation"
"""Reported before kernels are compiled, which takes a quarter to half a minute."""
_LISTENER: ContextVar[Callable[[], object]] = ContextVar("_LISTENER", default=lambda: None)

PATIENCE = 1.0
"""Seconds before anything is shown."""
ON_TERMINAL, IN_LOG = 0.2, 10.0
"""Seconds between two states of the bar on a terminal, and between two lines in a log."""
BAR = "{desc}: {percentage:3.0f} %|{bar:20}| {elapsed}<{remaining}{postfix}"
"""The time so far, and the time that is left."""


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


@contextmanager
def progress_bar(
    label: str, begun: float | None = None, stream: TextIO | None = None
) -> Iterator[Progress]:
    """Provide a progress function whose reports are shown on a stream, by default standard error.

    After a second it is a bar of tqdm on a terminal, which goes on while nothing is reported, and in a log a
    line every ten seconds. `begun` is the start of the work on the clock `time.monotonic`.

    Examples
    --------
    >>> import kvtheory as kv
    >>> with progress_bar("sweep") as progress:
    ...     kv.sweep(over={"drive.velocity": "1 mm/s:1 m/s:3:log"}, progress=progress).points
    3
    """
    begun = time.monotonic() if begun is None else begun
    stream = stream or sys.stderr or io.StringIO()  # standard error may be closed
    last, over = [0.0, ""], Event()

    def report(share: float, words: str = "") -> None:
        last[:] = share, words

    showing = Thread(target=_show, args=(label, begun, stream, last, over), daemon=True)
    showing.start()
    try:
        yield report
    finally:
        over.set()
        showing.join()


def _show(label: str, begun: float, stream: TextIO, last: list[Any], over: Event) -> None:
    """Show the last report again and again, until the work is over."""
    with suppress(OSError, ValueError):  # of a stream that was closed
        terminal = stream.isatty()
        wait = ON_TERMINAL if terminal else IN_LOG
        if over.wait(max(begun + PATIENCE - time.monotonic(), 0.0) if terminal else IN_LOG):
            return
        from tqdm import tqdm  # after the wait, as most work is done by then

        width, height = shutil.get_terminal_size()
        with tqdm(
            total=1.0, desc=label, file=stream if terminal else io.StringIO(), bar_format=BAR,
            miniters=0, mininterval=0.0, ncols=width - 1, nrows=height,
        ) as bar:  # fmt: skip
            bar.start_t -= time.monotonic() - begun
            ended = False
            while not ended:
                ended = over.wait(wait)
                share, words = last
                bar.set_postfix_str(words, refresh=False)
                bar.update(max(share - bar.n, 0.0))
                if not terminal:
                    stream.write(f"{bar}\n")
                    stream.flush()
