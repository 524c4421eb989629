"""Runs sweeps for the tests that disturb them; each reports how many points are kept, as it goes on.

`python -m tests.sweep_driver OUTPUT JOBS [FILE_SIZE_LIMIT]` runs one, by processes if JOBS > 1.
`... kill OUTPUT` runs it in children that are killed at random moments, until one comes to the end,
and prints for each its first and last report, and what was in the work file afterwards.
"""

import json
import os
import random
import resource
import signal
import sys
import time
from pathlib import Path

import numpy as np

import kvtheory as kv
from kvtheory.sweeps.store import records

POINTS, BLOCK, SLOW_POINTS = 3000, 20, 60
OVER = {"drive.velocity": f"1 mm/s:10 m/s:{POINTS}:log"}
PAUSE = 0.02
"""Seconds after each block, so that there is time to disturb the sweep."""
MOST_REPORTS, LONGEST_DELAY = 8, 2e-3
"""A child is killed after so many reports, of the 150 that a whole sweep makes, and so many seconds."""


def run(output, **more):
    return kv.sweep(over=OVER, quantities=["load", "depth"], output=output, block=BLOCK, **more)


def run_slowly(output, **more):
    """Run a sweep that is not done on arrays, for which own workers are processes."""
    over = {"drive.velocity": f"10 mm/s:1 m/s:{SLOW_POINTS}:log"}
    how = {"quantities": "load", "method": "quadrature", "block": 2}
    return kv.sweep(over=over, output=output, **how, **more)


def kept(output):
    """Points in the work file, or None where there is none."""
    work = Path(f"{output}.part")
    if not work.exists():
        return None
    with work.open("rb") as file:
        blocks = [json.loads(content.partition(b"\n")[0]) for _, content in records(file)][1:]
    return sum(stop - start for start, stop, *_ in blocks)


def assert_same(a, b):
    """Hold the values of two sweeps against each other, to the last bit."""
    assert list(a.values) == list(b.values)
    for name in b.values:
        assert a[name].dtype == b[name].dtype
        assert np.array_equal(a[name], b[name], equal_nan=b.units[name] != ""), name


def done_of(words):
    return int(words.partition(" ")[0].replace(",", ""))


def kill(output):
    kv.sweep(over={"drive.velocity": "1 mm/s:1 m/s:2"})  # imports once what every child needs
    chance, lives = random.Random(0), []
    while True:
        ours, theirs = os.pipe()
        child = os.fork()
        if not child:
            tell = lambda _, words, pipe=theirs: os.write(pipe, b"%d\n" % done_of(words))  # noqa: E731
            run(output, progress=tell)
            os._exit(0)
        os.close(theirs)
        told, reports = b"", chance.randint(1, MOST_REPORTS)
        while told.count(b"\n") < reports and (more := os.read(ours, 1 << 20)):
            told += more
        time.sleep(chance.uniform(0.0, LONGEST_DELAY))
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        while more := os.read(ours, 1 << 20):
            told += more
        os.close(ours)
        counts = [int(line) for line in told.split()] or [POINTS]
        lives.append((counts[0], counts[-1], kept(output)))
        if os.waitstatus_to_exitcode(status) == 0:
            return lives


def main(output, jobs, *limit):
    def tell(share, words):
        print(done_of(words), flush=True)
        time.sleep(PAUSE)

    if limit:
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit[0]),) * 2)
    try:
        (run if jobs == "1" else run_slowly)(Path(output), jobs=int(jobs), progress=tell)
    except OSError as error:
        sys.exit(f"{type(error).__name__}: {error}")


if __name__ == "__main__":
    print(json.dumps(kill(sys.argv[2]))) if sys.argv[1] == "kill" else main(*sys.argv[1:])
