"""A step on trial: its error, and its first event."""

import math

from kvtheory.transients import contact as c_
from kvtheory.transients import history as h_
from kvtheory.transients.contact import FREE, TOUCHING
from kvtheory.transients.drive import Drive, evaluate
from kvtheory.transients.flight import summit
from kvtheory.transients.history import motion
from kvtheory.transients.integrator import (
    NODES,
    PROBES,
    STAGES,
    collocate,
    defect_error,
    imbalance,
)
from kvtheory.transients.sides import SIDES, Sides

EVENT_SHARE, EVENT_FLOOR = 1e-2, 1e-12
"""Share of the tolerance by which a state of an edge must be violated, or rounding would toggle it."""
EVENT_RESOLUTION = 1e-13


class Attempts(Sides):
    """Steps from the present state (s, d, v), on trial.

    `smooth` says whether the motion goes on smoothly from the last record.
    """

    def __init__(
        self, drive: Drive, inertia_number: float, support_number: float, rtol: float
    ) -> None:
        super().__init__([list(piece) for piece in drive.pieces])
        self.eps, self.rtol = inertia_number, rtol
        self.allowed = max(EVENT_SHARE * rtol, EVENT_FLOOR)
        self.fixed = math.isinf(support_number)
        self.kappa = 0.0 if self.fixed else support_number
        self.s, self.d, self.v = 0.0, 1.0, 0.0
        self.piece, self.smooth, self.evaluations = 0, False, 0

    def drive_at(self, s: float) -> tuple[float, float, float]:
        """Return Y, lambda, lambda' of the present piece of the drive."""
        return evaluate(self.pieces[self.piece], s)

    def attempt(self, record: list[float]) -> tuple[float, float | None, tuple[float, ...]]:
        """Return the error of a step by its tolerance, infinite if it failed, and its first event.

        The event is given by its time and the monitors just after it.
        """
        if not self.fixed:
            guess = [0.0] * STAGES
            if self.smooth:
                last = self.records[-1]
                guess = [motion(last, self.s + c * record[h_.SPAN])[1] - self.v for c in NODES]
            count = collocate(
                record,
                guess,
                self.eps,
                self.kappa,
                self.rtol,
                self.nodes,
                self.records,
                self.pieces,
            )
            self.evaluations += count
            if count == 0:
                return math.inf, None, ()
        start, span = record[h_.START], record[h_.SPAN]
        size, before, found = 0.0, start, None
        for number, theta in enumerate(PROBES):
            s = start + theta * span
            slack, error = self._probe(record, s, number)
            size = max(size, error)
            if math.isnan(slack):
                return math.inf, None, ()
            if found is None and slack < 0.0:
                found = before, s
            before = s
        if found is None:
            return size, None, ()
        return size, *self._locate(record, *found)

    def _probe(self, record: list[float], s: float, probe: int) -> tuple[float, float]:
        """Return the slack of all states at `s`, and the error there by the tolerance."""
        monitors, F, F_d, F_v, dv = self.monitors(record, s)
        if self.fixed or probe >= len(PROBES) - 1:
            return min(monitors), 0.0
        self.evaluations += 1
        error = defect_error(record[h_.SPAN], self.eps, F_d, F_v, self.eps * dv, F, probe)
        return min(monitors), error / (self.rtol * (1.0 + abs(self.v)))

    def monitors(
        self, record: list[float], s: float
    ) -> tuple[tuple[float, ...], float, float, float, float]:
        """Return what must stay positive, and F, dF/dd, dF/dv and v'.

        In contact these are the width, and state and ground of each side; in flight, the gap.
        """
        d, v, dv = motion(record, s)
        Y, number, slope = self.drive_at(s)
        memory = self.nodes, self.records, self.pieces
        sides = record[h_.LEFT_STATE : h_.LEFT_X]
        F, F_d, F_v, l, r = imbalance(s, d, v, Y, number, sides, self.kappa, *memory)
        if sides[0] == FREE:
            gap = -d if d < 0.0 else -summit(s, d, Y, self.top[0], self.top[1], *memory)[0]
            return (gap + self.allowed,), F, F_d, F_v, dv
        instant = d, v, dv, Y, number, slope
        values = [r - l]
        for k, xi in enumerate((l, r)):
            node = self.top[k]
            if self.state[k] == TOUCHING:
                node = c_.reached(SIDES[k], node, s, d, Y, self.nodes)
            values += c_.slack(SIDES[k], self.state[k], self.nodes[node], s, xi, instant)
        return tuple(value + self.allowed for value in values), F, F_d, F_v, dv

    def _locate(
        self, record: list[float], low: float, high: float
    ) -> tuple[float, tuple[float, ...]]:
        """Return the time of the first violation in (low, high], and the monitors just after it."""
        violated = self.monitors(record, high)[0]
        at_low, at_high, turn = math.nan, min(violated), 0
        while high - low > EVENT_RESOLUTION * (1.0 + abs(high)):
            turn += 1
            middle = 0.5 * (low + high)
            if turn % 3 and not math.isnan(at_low):  # by halves now and then: secants may crawl
                secant = low + (high - low) * at_low / (at_low - at_high)
                margin = 0.01 * (high - low)
                middle = min(max(secant, low + margin), high - margin)
            monitors = self.monitors(record, middle)[0]
            value = min(monitors)
            if value < 0.0:
                high, at_high, violated = middle, value, monitors
            else:
                low, at_low = middle, value
        return (self.s if low == self.s else high), violated
