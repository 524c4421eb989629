"""What happened to the contact in a motion that was followed, in the order of time."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import polynomial

from kvtheory.models.continuum import stepping
from kvtheory.models.continuum.contact import TOUCHING
from kvtheory.models.continuum.run import EVENT, structured
from kvtheory.scene import base_motion as b_

REVERSAL = "sliding reverses"
"""The kind of an event that only an indenter on a spring has."""


class ScaledEvent(NamedTuple):
    """What happened at the time `s`."""

    s: float
    kind: str


def events_of(motion: Any) -> tuple[ScaledEvent, ...]:
    """Return the events of a `solver.Trajectory`."""
    found = [
        ScaledEvent(s, stepping.KINDS[kind])
        for s, kind in structured(motion.run.events[: motion.count("events")], EVENT).tolist()
    ]
    return tuple(sorted([*found, *_memory(motion), *_reversals(motion)], key=lambda event: event.s))


def _memory(motion: Any) -> Iterator[ScaledEvent]:
    """Yield when an edge begins to touch ground that was touched before, and when it ceases to."""
    sides, left_at = motion.records["sides"], motion.nodes["inner"]["s"]
    remembers = (sides["state"] == TOUCHING) & (left_at[sides["node"]] > -math.inf)
    before = np.zeros_like(remembers)
    before[1:] = remembers[:-1]
    for at, k in np.argwhere(remembers != before).tolist():
        verb, name = "begins" if remembers[at, k] else "ends", ("left", "right")[k]
        yield ScaledEvent(motion.starts[at], f"memory {verb} at the {name} edge")


def _reversals(motion: Any) -> Iterator[ScaledEvent]:
    """Yield when the indenter on a spring begins to slide the other way: where lambda changes sign."""
    before = 0.0
    if not motion.given.sprung:
        return
    steps, ends = motion.records, [*motion.starts[1:], motion.end]
    spans, rows = steps["span"].tolist(), motion.pieces[steps["piece"]].tolist()
    for start, end, span, row in zip(motion.starts, ends, spans, rows, strict=True):
        powers = [c * span**k for k, c in enumerate(row[b_.POWERS :])]
        roots = polynomial.polyroots(np.trim_zeros(powers, "b") or [1.0])
        share = (end - start) / span
        within = sorted(x for x in roots.real.tolist() if 0.0 < x < share)
        for low, high in pairwise([0.0, *within, share]):
            number = b_.evaluate(row, start + 0.5 * (low + high) * span)[1]
            if number * before < 0.0:
                yield ScaledEvent(start + low * span, REVERSAL)
            before = number or before
