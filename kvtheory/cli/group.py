"""The command `kvtheory`: the group that the other modules add their commands to, errors and exit status."""

import os
import re
import sys
import traceback
import warnings
from contextlib import suppress
from datetime import UTC, datetime
from importlib.resources import files
from typing import Any

import click

from kvtheory.cli.outputs import check_outputs

DISAGREES, BAD_INPUT, INTERNAL_ERROR, INTERRUPTED, BROKEN_PIPE = 1, 2, 70, 130, 141
"""Exit statuses other than 0; 2 also if the output cannot be written."""


class Failure(click.ClickException):
    """An error message and its exit status."""

    def __init__(self, message: str, status: int = BAD_INPUT) -> None:
        super().__init__(message)
        self.exit_code = status  # type: ignore[misc]

    def show(self, file: Any = None) -> None:
        """Write the message to standard error, without control characters."""
        from kvtheory.scene.mistakes import printable

        lines = map(printable, f"kvtheory: {self.message}".splitlines())
        click.echo("\n".join(lines), file=file, err=True)


class Command(click.Command):
    """A command whose help ends with an example, and that reports errors as messages."""

    def __init__(self, *args: Any, example: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.example = example

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the options, on one line, to be copied."""
        with formatter.section("Example"):
            formatter.write(f"{'':{formatter.current_indent}}{self.example}\n")

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command, and turn its errors into messages: bad input is status 2, never 1."""
        try:
            check_epoch()
            check_outputs(ctx)
            return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit, BrokenPipeError):
            raise
        except KeyboardInterrupt as error:
            raise Failure(str(error) or "interrupted", INTERRUPTED) from None
        except MemoryError as error:
            why = str(error) or "ask for less at a time"
            raise Failure(f"error: out of memory: {why}") from None
        except OSError as error:
            if error.filename is None and error.errno is not None:  # from standard output
                raise
            named = f'"{error.filename}": {error.strerror}' if error.filename else str(error)
            raise Failure(f"error: {in_options(named, self)}") from None
        except (ValueError, ArithmeticError, RuntimeError) as error:
            lines = in_options(str(error), self).splitlines() or [type(error).__name__]
            count = len(getattr(error, "problems", lines))
            head = "error:" if count == 1 else f"{count:,} mistakes:\n "
            raise Failure(f"{head} " + "\n  ".join(lines)) from None
        except Exception:
            report = f"internal error, please report it:\n{traceback.format_exc()}"
            raise Failure(report, INTERNAL_ERROR) from None


def check_epoch() -> None:
    """Raise `ValueError` for a SOURCE_DATE_EPOCH with which NumPy or matplotlib would fail."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")
    try:
        datetime.fromtimestamp(int(epoch), tz=UTC)
    except (ValueError, OverflowError, OSError):
        message = "expected a whole number of seconds since 1970"
        raise ValueError(f'environment variable SOURCE_DATE_EPOCH = "{epoch}": {message}') from None


class Group(click.Group):
    """A group that exits with one of the statuses above, even if its output cannot be written."""

    command_class = Command
    group_class = type

    def main(self, *args: Any, standalone_mode: bool = True, **kwargs: Any) -> Any:
        """Run a command and exit; characters that the console lacks are written as escapes."""
        run: Any = super().main
        if not standalone_mode:
            return run(*args, standalone_mode=False, **kwargs)
        output, status = sys.stdout, 0
        warnings.formatwarning = lambda message, *_, **__: f"kvtheory: warning: {message}\n"
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        try:
            try:
                status = run(*args, standalone_mode=False, **kwargs) or 0
            except OSError as error:
                why = f"error: the output cannot be written: {error.strerror}"
                raise Failure(why) from None
        except click.ClickException as error:
            status = error.exit_code
            with suppress(OSError):  # where standard error cannot be written either
                error.show()
        except click.Abort:
            status = INTERRUPTED
        except SystemExit as end:  # from click, which replaces the output if its pipe is closed
            status = end.code if sys.stdout is output else BROKEN_PIPE  # type: ignore[assignment]
        try:
            for stream in filter(None, (output, sys.stderr)):
                stream.flush()
        except OSError:  # else Python would fail at exit on buffered output
            nowhere = os.open(os.devnull, os.O_WRONLY)
            for stream in (sys.stdout, sys.stderr):
                with suppress(AttributeError, OSError, ValueError):
                    os.dup2(nowhere, stream.fileno())
        sys.exit(status)


def in_options(message: str, command: click.Command) -> str:
    """Replace the names of arguments in a message of the library by the options of a command.

    >>> command = click.Command("a", params=[click.Option(["--per-length"])])
    >>> in_options('`per_length` = 3: expected 1/m; see `h`, or give `per_length`', command)
    '--per-length 3: expected 1/m; see `h`, or give --per-length'
    """
    options = {parameter.name: parameter.opts[0] for parameter in command.params}

    def option(found: re.Match[str]) -> str:
        if found[1] not in options:
            return found[0]
        return options[found[1]] + (" " if found[2] else "")

    return re.sub(r"`(\w+)`( = )?", option, message)


@click.group(
    cls=Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}
)
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a viscoelastic foundation.

    SCENE is a TOML file that describes what is modelled; `kvtheory scene` prints a template. Without it,
    commands use Table 1 of Nakano and Kono (2020) with a dead weight.

    No command overwrites a file that it reads. It overwrites a file of another kind than it writes only
    with --overwrite.

    Exit status: 0 done, 1 a check found disagreement, 2 bad input, 70 internal error, 130 interrupted.
    """


@main.command(example="kvtheory cite >> references.bib")
def cite() -> None:
    """Print BibTeX entries for this version and for the paper."""
    from kvtheory import __version__

    text = files("kvtheory.cli").joinpath("citation.bib").read_text(encoding="utf-8")
    click.echo(text % __version__, nl=False)
