"""Whether an installed package does its work: each command once, in a directory of its own.

`make package` runs it with wheel and sdist in clean environments, without the extras.
"""

import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import kvtheory as kv

LOG = "log.txt"
LIBRARIES = ["click", "matplotlib.figure", "numpy", "scipy.optimize", "sympy"]
"""Loaded once; each command is a fork of the process that holds them, and imports what is ours."""

COMMANDS = {
    "scene --problem wedge": "",
    "steady --plot steady.svg": "steady.svg",
    "asymptotes": "",
    "stability": "",
    "solve --quantity friction_coefficient --explain": "",
    "transient -o series.csv": "series.csv",
    "compare --data series.csv --report report.html": "report.html",
    "elements --per-length 20/mm": "",
    "sweep --over drive.velocity=1mm/s,1m/s -o map.csv": "map.csv",
    "chart failures --only cancellation -o failures.html": "failures.html",
    "chart table2 -o table2.svg": "table2.csv",
    "chart work-precision --help": "",
    "derive --only 27,F3 --format tex,html,md,ipynb,json -o derived": "derived/derivations.html",
    "explore -o explorer.html": "explorer.html",
    "cite": "",
}
"""Commands, and the file that each must write."""


def command(words: str) -> None:
    """Run a command in this process; what it prints goes to the file LOG."""
    from kvtheory.cli import main

    with Path(LOG).open("w") as log:
        for stream in (1, 2):
            os.dup2(log.fileno(), stream)
    sys.argv = ["kvtheory", *words.split()]
    main()


def main() -> None:
    """Run everything; whatever fails ends it."""
    if not Path(kv.__file__).is_relative_to(sys.prefix):
        raise SystemExit(f"{kv.__file__} is not what was installed in {sys.prefix}")
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a process with threads had better not fork
    own = multiprocessing.get_context("forkserver")
    own.set_forkserver_preload(LIBRARIES)
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        for words, written in COMMANDS.items():
            process = own.Process(target=command, args=[words])
            process.start()
            process.join()
            if process.exitcode or (written and not Path(written).stat().st_size):
                told = Path(LOG).read_text()
                raise SystemExit(f"kvtheory {words}: exit status {process.exitcode}: {told}")
        program = [Path(sys.prefix) / "bin" / "kvtheory", "steady", "--json"]
        shown = json.loads(subprocess.run(program, capture_output=True, check=True).stdout)
        state = kv.steady()
        for name in ("load", "friction_coefficient", "trailing_edge"):
            if shown[name] != float(getattr(state, name)):
                raise SystemExit(f"{name}: {shown[name]} and {getattr(state, name)}")
        if abs(state.load / 9806.65 - 1.0) > 1e-12:
            raise SystemExit(f"the load of Table 1 is not its weight: {state.load}")
        last = kv.transient(at=[0.2]).depth[0]
        if abs(last / state.depth - 1.0) > 1e-3:
            raise SystemExit(f"the transient ends at {last}, not at {state.depth}")


if __name__ == "__main__":
    main()
