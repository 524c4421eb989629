"""The command `kvtheory`, to which the modules beside this one add theirs."""

import os
import sys
from contextlib import suppress
from typing import Any, NoReturn

import click

BAD_OUTPUT, INTERRUPTED, BROKEN_PIPE = 2, 130, 141
"""Exit status if the output cannot be written; after Ctrl-C, and if its reader has closed the pipe, as in
shells."""


class Commands(click.Group):
    """A group whose output survives the console: its encoding, or a reader that has closed the pipe."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command; letters that the console lacks are written as escapes."""
        run: Any = super().main
        if not kwargs.pop("standalone_mode", True):
            return run(*args, standalone_mode=False, **kwargs)
        output = sys.stdout
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        try:
            status = run(*args, standalone_mode=False, **kwargs)
            _flush()
        except click.ClickException as error:
            with suppress(OSError):
                error.show()
            _flush_quietly()
            sys.exit(error.exit_code)
        except click.Abort:
            sys.exit(INTERRUPTED)
        except BrokenPipeError:
            leave_quietly()
        except OSError as error:  # of standard output: all else is told by the commands
            leave_quietly(f"the output cannot be written: {error.strerror}")
        except SystemExit:
            if sys.stdout is not output:  # click's own way out of a broken pipe has status 1
                leave_quietly()
            _flush_quietly()
            raise
        sys.exit(status if isinstance(status, int) else 0)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()


def _flush_quietly() -> None:
    """Write the rest of the output of a command that has already reported its error."""
    try:
        _flush()
    except OSError:
        _silence()


def _silence() -> None:
    """Discard what is still buffered."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            os.dup2(nowhere, stream.fileno())
        except (AttributeError, OSError, ValueError):
            continue


def leave_quietly(message: str = "") -> NoReturn:
    """Exit because the output cannot be written: its reader has closed the pipe, or the disk is full."""
    if message:
        with suppress(OSError):
            click.echo(f"kvtheory: error: {message}", err=True)
    _silence()
    sys.exit(BAD_OUTPUT if message else BROKEN_PIPE)


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a viscoelastic foundation.

    Without a scene file, each command works on Table 1 of Nakano and Kono (2020) with a dead
    weight. Exit status: 0 done, 1 a check found disagreement, 2 bad input, 130 interrupted.

    No command overwrites a file that it reads. A file of another kind than the command
    writes is overwritten only if --overwrite is given.
    """
