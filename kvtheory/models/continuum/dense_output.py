"""The motion that the solver has found so far: one polynomial of the time for each step.

A record holds the depth rate v of a step as powers of theta = (s - start)/span; the depth is its
exact integral. Records and drive pieces are rows of floats, so that one source can be interpreted
and compiled.
"""

from collections.abc import Sequence
from typing import Any

from kvtheory.scene.base_motion import evaluate

START, SPAN, DEPTH, PIECE = 0, 1, 2, 3
LEFT_STATE, LEFT_NODE, RIGHT_STATE, RIGHT_NODE = 4, 5, 6, 7
LEFT_X, RIGHT_X = 8, 9
POWERS = 10
"""Layout of a record: times, depth at its start, drive piece, state and node of both sides, both edges
at its start, then v."""

Past = Any
"""A run in progress or done: here its `records`, its `nodes` and the `pieces` of its drive are read."""

Instant = tuple[float, float, float, float, float, float]
"""d, v, v', Y, lambda, lambda' at one time."""


def motion(record: Sequence[float], s: float) -> tuple[float, float, float]:
    """Return depth, depth rate and its derivative at `s`."""
    span = record[SPAN]
    theta = (s - record[START]) / span
    depth = rate = slope = 0.0
    for k in range(len(record) - 1, POWERS - 1, -1):
        slope = slope * theta + rate
        rate = rate * theta + record[k]
        depth = depth * theta + record[k] / (k - POWERS + 1)
    return record[DEPTH] + depth * theta * span, rate, slope / span


def instant(run: Past, index: int, s: float) -> Instant:
    """Return the motion at `s` from the record `index`."""
    record = run.records[index]
    return motion(record, s) + evaluate(run.pieces[int(record[PIECE])], s)
