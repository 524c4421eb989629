"""`python -m kvtheory` is the command `kvtheory`."""

import os
import sys

INTERRUPTED = 130


def command() -> None:
    """Run a command; an interrupt at any time, also while modules are imported, is a message and a status."""
    try:
        from kvtheory.cli import main

        main(prog_name="kvtheory")
    except KeyboardInterrupt:
        sys.stderr.write("kvtheory: interrupted\n")
    except SystemExit as end:
        if end.code != INTERRUPTED:
            raise
    # Python itself would end by the signal if the interrupt went through code of an extension module.
    for stream in filter(None, (sys.stdout, sys.stderr)):
        try:
            stream.flush()
        except (OSError, ValueError):  # closed, or full
            continue
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    command()
