"""The command `kvtheory`, to which the modules beside this one add theirs."""

import os
import sys
from typing import Any

import click

BROKEN_PIPE = 141
"""Exit status where the reader of the output has gone, as shells have it."""


class Commands(click.Group):
    """A group whose output never dies of the console: of its encoding, or of a reader that has gone."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command; letters that the console lacks are written as escapes."""
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        try:
            return super().main(*args, **kwargs)
        finally:
            _flush()


def _flush() -> None:
    """Write what is left; a reader that has gone is no mistake, and nobody is told."""
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except BrokenPipeError:
        leave_quietly()


def leave_quietly() -> None:
    """End because the reader of the output has gone; what is still buffered goes nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            os.dup2(nowhere, stream.fileno())
        except (AttributeError, OSError, ValueError):
            continue
    sys.exit(BROKEN_PIPE)


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a Kelvin-Voigt foundation.

    Without a scene file, each command works on Table 1 of Nakano and Kono (2020) with a dead
    weight. Exit status: 0 done, 1 a check found disagreement, 2 bad input, 130 interrupted.

    An output is never a file that the command reads. A file that holds something else than this
    command writes is left alone, unless --overwrite is given.
    """
