"""The walk from step to step: step lengths, events, and what the edges leave behind."""

import math
from typing import NamedTuple

from kvtheory.transients import contact as c_
from kvtheory.transients.attempts import Attempts
from kvtheory.transients.contact import FREE, PEELING, TOUCHING
from kvtheory.transients.drive import END as PIECE_END
from kvtheory.transients.drive import Drive, evaluate
from kvtheory.transients.history import motion
from kvtheory.transients.integrator import STAGES
from kvtheory.transients.sides import SIDES

NAMES = ("left", "right")

SAFETY = 0.9
SHRINK, GROW, TINY = 0.2, 5.0, 1e-12
FIRST_STEP = 0.1
"""Of the fastest time constant, after a jump; if it is too long it is rejected."""
OVERRUN = 1e-4
"""Share of a step that may lie beyond an event: the states of the edges change there, and a step that
ran farther is repeated with the right length."""
BRIEF = 1e-10
"""A piece of a step up to an event so close to its start that it needs no repetition."""
LONGEST = 0.5
"""In units of tau: what the foundation forgets does not hide between the probes of a step."""
RELIEF = 0.25
"""How far the ground may slide in a step of the flight above it, in units of a_0."""
SMOOTH = 1e-9
"""Relative difference of lambda or lambda' at a joint of the drive that is only rounding."""
STEP_LIMIT = 100_000
TOGGLE_LIMIT = 12
"""Changes of state at one instant; more than a few would mean that no state is consistent."""


class TransientError(ArithmeticError):
    """The transient could not be followed further; the message says when and why."""


class Event(NamedTuple):
    """What happened at the time `s`."""

    s: float
    kind: str


class Run(Attempts):
    """A transient in progress; `records`, `nodes` and `events` are its outcome."""

    def __init__(
        self, drive: Drive, inertia_number: float, support_number: float, rtol: float
    ) -> None:
        super().__init__(drive, inertia_number, support_number, rtol)
        self.events: list[Event] = []
        self.rejected = self.toggles = 0
        self.span = math.inf

    def follow(self, end: float) -> None:
        """Walk to `end`."""
        for index, piece in enumerate(self.pieces):
            if self.s >= end:
                return
            self.piece = index
            self._meet_drive()
            until = min(piece[PIECE_END], end)
            while self.s < until:
                if len(self.records) + self.rejected > STEP_LIMIT:
                    raise TransientError(f"more than {STEP_LIMIT} steps: stopped at s = {self.s!r}")
                self._step(until)

    def _meet_drive(self) -> None:
        """Let a jump of lambda detach strips, or turn peeling edges where the pressure rises."""
        Y, number, slope = self.drive_at(self.s)
        _, last, last_slope = (
            evaluate(self.pieces[self.piece - 1], self.s) if self.piece else (0.0,) * 3
        )
        jumps = abs(number - last) > SMOOTH * (1.0 + abs(number))
        if jumps or abs(slope - last_slope) > SMOOTH * (1.0 + abs(slope)):
            self.kink = self.s
        if jumps or self.piece == 0:
            self._restart()
        if self.state[0] == FREE:
            return
        new = list(self.X)
        for k, side in enumerate(SIDES):
            p = c_.pressure(self.X[k] + Y, self.d, self.v, number)
            allowed = self.allowed * (1.0 + abs(number) + abs(self.v))
            if p < -allowed:
                limit = c_.root(side, number, self.d + self.v)[0] - Y
                new[k] = side * min(side * limit, side * self.X[k])
            elif p > allowed and self.state[k] == PEELING:
                self._turn(k)
        if new[0] >= new[1]:
            self._leave(Y)
            return
        for k in range(2):
            if new[k] != self.X[k]:
                if self.state[k] == TOUCHING:
                    self.trim(k, self.s, self.d, Y)
                    self._note(k, "peels")
                self.state[k] = PEELING
                self.push_strip(k, new[k], self.X[k], [self.s, self.d, Y])
                self.X[k] = new[k]

    def _restart(self) -> None:
        """Forget the step length, for v' jumps or is singular here."""
        _, number, _ = self.drive_at(self.s)
        width = self.X[1] - self.X[0] if self.state[0] != FREE else 1.0
        fast = self.eps / (self.eps + 0.75 * max(width, 1e-3)) if not self.fixed else 1.0
        self.span, self.smooth = FIRST_STEP * fast / (1.0 + abs(number)), False

    def _note(self, k: int, what: str) -> None:
        self.events.append(Event(self.s, f"{NAMES[k]} edge {what}"))

    def _step(self, until: float) -> None:
        """Try one step; keep it up to its first event, or try a shorter one next time."""
        span = min(self.span, until - self.s, self._longest())
        if not self.s + 0.1 * span > self.s:
            raise TransientError(f"the step length went to zero at s = {self.s!r}")
        if until - self.s - span < 0.1 * OVERRUN * span:
            span = until - self.s
        record = [self.s, span, self.d, float(self.piece)]
        for k in range(2):
            record += [self.state[k], float(self.top[k])]
        record += [*self.X, self.v] + [0.0] * STAGES
        size, found, violated = self.attempt(record)
        until_event = math.inf if found is None else found - self.s
        if BRIEF * (1.0 + self.s) < until_event < span / (1.0 + OVERRUN):
            self.rejected += 1
            self.span = (1.0 + 0.5 * OVERRUN) * until_event
            return
        factor = min(GROW, max(SHRINK, SAFETY * max(size, TINY) ** (-1.0 / (STAGES + 1))))
        if size > 1.0:
            self.rejected += 1
            self.span = span * factor
            return
        self.span = max(self.span, span * factor) if factor > 1.0 else span * factor
        end = until if span == until - self.s else self.s + span
        if found is not None:
            end = found
        if end > self.s:
            self._commit(record, end)
        if found is not None:
            self._change(violated)
        else:
            self.toggles = 0

    def _longest(self) -> float:
        if self.state[0] != FREE:
            return LONGEST
        _, number, _ = self.drive_at(self.s)
        slide = RELIEF / (RELIEF + abs(number))
        if self.d >= 0.0:
            return min(LONGEST, slide)
        return min(LONGEST, max(slide, -0.5 * self.d / (abs(self.v) + 1e-3)))

    def _commit(self, record: list[float], end: float) -> None:
        """Keep `record` up to `end`, and what the peeling edges swept meanwhile."""
        Y_0, _, _ = self.drive_at(self.s)
        d, v, _ = motion(record, end)
        Y, number, _ = self.drive_at(end)
        index = len(self.records)
        self.records.append(record)
        memory = self.nodes, self.records, self.pieces
        if self.state[0] != FREE:
            for k, side in enumerate(SIDES):
                xi, _, node = c_.edge(
                    side, self.state[k], self.top[k], end, d, v, Y, number, *memory
                )
                if self.state[k] == PEELING:
                    self.push(
                        k,
                        [xi - Y, end, d, Y, self.X[k], self.s, self.d, Y_0, float(index), side],
                    )
                else:
                    self.top[k] = node
                self.X[k] = xi - Y
        self.s, self.d, self.v, self.smooth = end, d, v, True

    def _change(self, violated: tuple[float, ...]) -> None:
        """Change the states that the event at the present time violates."""
        self.toggles += 1
        if self.toggles > TOGGLE_LIMIT:
            raise TransientError(f"no consistent state of the edges at s = {self.s!r}")
        Y, _, _ = self.drive_at(self.s)
        if self.state[0] == FREE:
            self._land(Y)
        elif violated[0] < 0.0:
            self._leave(Y)
        else:
            for k in range(2):
                state, ground = violated[2 * k + 1 : 2 * k + 3]
                if ground < 0.0:
                    self.top[k] = int(self.nodes[self.top[k]][c_.NEXT])
                    self._note(k, "crosses to older ground")
                elif state < 0.0 and self.state[k] != FREE:
                    self._change_side(k, Y)

    def _change_side(self, k: int, Y: float) -> None:
        if self.state[k] == PEELING:
            self._turn(k)
            return
        if SIDES[k] * (self.X[k] + Y + self.drive_at(self.s)[1]) <= 0.0:
            self._leave(Y)  # the pressure fell to zero at the root of the other side
            return
        self.trim(k, self.s, self.d, Y)
        self.state[k] = PEELING
        self._note(k, "peels")

    def _turn(self, k: int) -> None:
        self.state[k] = TOUCHING
        self._note(k, "touches")

    def _leave(self, Y: float) -> None:
        self.leave(self.s, self.d, Y)
        self.events.append(Event(self.s, "take-off"))
        self._restart()

    def _land(self, Y: float) -> None:
        self.land(self.s, self.d, Y)
        self.events.append(Event(self.s, "landing"))
        self._restart()
