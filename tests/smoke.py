"""Whether an installed package does its work: each command once, in a directory of its own.

`make package` runs it with wheel and sdist in clean environments, without the extras.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import kvtheory as kv

COMMANDS = {
    "scene --problem wedge": "",
    "steady --json": "",
    "steady --plot steady.svg": "steady.svg",
    "asymptotes": "",
    "stability": "",
    "solve --quantity friction_coefficient --explain": "",
    "transient -o series.csv": "series.csv",
    "compare --data series.csv --report report.html": "report.html",
    "elements --per-length 20/mm": "",
    "sweep --over drive.velocity=1mm/s,1m/s -o map.csv": "map.csv",
    "chart failures --only cancellation -o failures.html": "failures.html",
    "chart work-precision --help": "",
    "derive --only 27,F3 --format tex,html,md,ipynb,json -o derived": "derived/derivations.html",
    "explore -o explorer.html": "explorer.html",
    "cite": "",
}
"""Commands, and the file that each must write."""


def main() -> None:
    """Run everything; whatever fails ends it."""
    if not Path(kv.__file__).is_relative_to(sys.prefix):
        raise SystemExit(f"{kv.__file__} is not what was installed in {sys.prefix}")
    program = Path(sys.prefix) / "bin" / "kvtheory"
    with tempfile.TemporaryDirectory() as place:
        for command, written in COMMANDS.items():
            done = subprocess.run(
                [program, *command.split()], cwd=place, capture_output=True, text=True, check=False,
                env={**os.environ, "PYTHONWARNINGS": "error"},
            )  # fmt: skip
            if done.returncode or (written and not (Path(place) / written).stat().st_size):
                raise SystemExit(f"kvtheory {command}: {done.stdout}{done.stderr}")
            if command == "steady --json":
                shown = json.loads(done.stdout)
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
