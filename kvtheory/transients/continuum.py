r"""The whole transient without discretizing the foundation: one equation of motion, two edges.

    eps d'' = 1 - f_z - kappa (d - 1),    d(0) = 1, d'(0) = 0, at rest for s < 0

with f_z in closed form in d, d', lambda and the two edges (fact F11). Between events the right-hand
side is smooth; a step that runs over an event is cut there, for its polynomial continues the states
of the edges that it began with. A fixed indenter, d = 1, needs no equation, only events.
"""

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from kvtheory.transients import contact as c_
from kvtheory.transients import history as h_
from kvtheory.transients.contact import FREE, PEELING, TOUCHING
from kvtheory.transients.drive import Drive, evaluate
from kvtheory.transients.history import motion
from kvtheory.transients.integrator import imbalance
from kvtheory.transients.stepping import Event, Run


class Moment(NamedTuple):
    """State at one time in scaled form; edges are NaN and states ``"free"`` in flight."""

    s: float
    depth: float
    rate: float
    acceleration: float
    left: float
    right: float
    left_state: str
    right_state: str
    normal_force: float
    friction_force: float


STATE_NAMES = {PEELING: "peeling", TOUCHING: "touching", FREE: "free"}


@dataclass(frozen=True)
class Motion:
    """A solved transient: evaluate it anywhere in [0, end] with `at`."""

    end: float
    events: tuple[Event, ...]
    steps: int
    rejected: int
    evaluations: int
    inertia_number: float
    support_number: float
    pieces: Sequence[Sequence[float]]
    records: Sequence[Sequence[float]]
    nodes: Sequence[Sequence[float]]
    starts: Sequence[float]

    def at(self, s: float) -> Moment:
        """Return the state at `s`; where the drive jumps, just after the jump."""
        if not 0.0 <= s <= self.end:
            raise ValueError(f"`s` must lie in [0, {self.end!r}], got {s!r}")
        record = self.records[bisect.bisect_right(self.starts, s) - 1]
        d, v, dv = motion(record, s)
        Y, number, _ = evaluate(self.pieces[int(record[h_.PIECE])], s)
        sides = record[h_.LEFT_STATE : h_.LEFT_X]
        if s > record[h_.START]:
            *_, l, r = imbalance(
                s, d, v, Y, number, sides, 0.0, self.nodes, self.records, self.pieces
            )
        else:  # what was left at this very instant confines nothing yet
            l, r = (X + Y if sides[0] != FREE else math.nan for X in record[h_.LEFT_X : h_.POWERS])
        f_z, f_x = c_.forces(l, r, d, v, number) if sides[0] != FREE else (0.0, 0.0)
        names = STATE_NAMES[sides[0]], STATE_NAMES[sides[2]]
        return Moment(s, d, v, dv, l, r, *names, f_z, f_x)


def solve(
    drive: Drive, inertia_number: float, support_number: float, end: float, rtol: float = 1e-9
) -> Motion:
    """Follow the transient of `drive` from rest until `end`, in scaled form.

    Parameters
    ----------
    drive
        The drive number lambda(s); it must reach `end`.
    inertia_number
        eps > 0; not used if the support is fixed.
    support_number
        kappa >= 0; infinity is the fixed indenter, d = 1.
    end
        Time until which to solve, in units of tau.
    rtol
        Error allowed in a step for d' relative to 1 + |d'|, all along the step.

    Raises
    ------
    TransientError
        If a step cannot be made, or too many would be needed.

    Examples
    --------
    >>> motion = solve(Drive.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> print(f"{motion.at(2.0).depth:.6f}")
    0.303968
    """
    if not 0.0 < end <= drive.end:
        raise ValueError(f"`end` must be positive and within the drive, got {end!r}")
    if not (inertia_number > 0.0 and support_number >= 0.0 and 1e-13 <= rtol <= 1e-2):
        raise ValueError(
            "expected `inertia_number` > 0, `support_number` >= 0, 1e-13 <= `rtol` <= 1e-2"
        )
    run = Run(drive, float(inertia_number), float(support_number), rtol)
    run.follow(float(end))
    return Motion(
        end,
        tuple(run.events),
        len(run.records),
        run.rejected,
        run.evaluations,
        inertia_number,
        support_number,
        run.pieces,
        run.records,
        run.nodes,
        [record[h_.START] for record in run.records],
    )
