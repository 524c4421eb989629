"""What happened to the contact in a motion that was followed, in the order of time."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import evaluation, stepping
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import TOUCHING
from kvtheory.scene import base_motion as b_

REVERSAL = "sliding reverses"
"""The kind of an event that only an indenter on a spring has."""


class ScaledEvent(NamedTuple):
    """What happened at the time `s`."""

    s: float
    kind: str


def events_of(motion: Any) -> tuple[ScaledEvent, ...]:
    """Return the events of a `solver.Trajectory`."""
    rows = _counted(motion, motion.rows.events, r_.EVENTS).tolist()
    found = [ScaledEvent(s, stepping.KINDS[int(kind)]) for s, kind in rows]
    return tuple(sorted([*found, *_memory(motion), *_reversals(motion)], key=lambda event: event.s))


def _counted(motion: Any, rows: Any, count: int) -> NDArray[np.float64]:
    """Return the rows of a run that are in use."""
    return np.asarray(rows[: motion.rows.counts[count]])


def _memory(motion: Any) -> Iterator[ScaledEvent]:
    """Yield when an edge begins to touch ground that was touched before, and when it ceases to."""
    records = _counted(motion, motion.rows.records, r_.RECORDS)
    left_at = _counted(motion, motion.rows.nodes, r_.NODES)[:, c_.IN_S]
    sides = records[:, h_.LEFT_STATE : h_.LEFT_X]
    nodes = sides[:, 1::2].astype(int)
    remembers = (sides[:, ::2] == TOUCHING) & (left_at[nodes] > -math.inf)
    before = np.zeros_like(remembers)
    before[1:] = remembers[:-1]
    for at, k in np.argwhere(remembers != before).tolist():
        what, name = "begins" if remembers[at, k] else "ends", ("left", "right")[k]
        yield ScaledEvent(float(records[at, h_.START]), f"memory {what} at the {name} edge")


def _reversals(motion: Any) -> Iterator[ScaledEvent]:
    """Yield when the indenter on a spring begins to slide the other way: where lambda changes sign."""
    before = 0.0
    for index in range(motion.steps if motion.rows.given.sprung else 0):
        record = motion.records[index]
        row, start, span = motion.pieces[int(record[h_.PIECE])], record[h_.START], record[h_.SPAN]
        powers = [c * span**k for k, c in enumerate(row[b_.POWERS :])]
        roots = polynomial.polyroots(np.trim_zeros(powers, "b") or [1.0])
        share = (evaluation.natural_step(motion.rows, index)[1] - start) / span
        within = sorted(x for x in roots.real.tolist() if 0.0 < x < share)
        for low, high in pairwise([0.0, *within, share]):
            number = b_.evaluate(row, start + 0.5 * (low + high) * span)[1]
            if number * before < 0.0:
                yield ScaledEvent(start + low * span, REVERSAL)
            before = number or before
