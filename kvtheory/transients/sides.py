"""Both sides of the contact: state and position of each edge, and the chain of what it left behind."""

from collections.abc import Sequence

from kvtheory.transients import contact as c_
from kvtheory.transients.contact import FREE, TOUCHING, Node
from kvtheory.transients.drive import Piece
from kvtheory.transients.flight import summit
from kvtheory.transients.history import instant

SIDES = (-1.0, 1.0)


class Sides:
    """The left side and the right side, in this order; at first the stationary contact at d = 1.

    `state` and the material coordinate `X` of each edge, `top` its innermost node among `nodes`, and
    the motion that swept them, `records` on `pieces` of the drive. `kink` is the time of the last
    kink or jump of the drive.
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.records: list[list[float]] = []
        self.nodes = [c_.undisturbed(side) for side in SIDES]
        self.state, self.top, self.X = [TOUCHING, TOUCHING], [0, 1], [-1.0, 1.0]
        self.kink = 0.0

    def push(self, k: int, row: list[float]) -> None:
        """Put a node on a chain; A is smooth across to the next if one edge swept both, smoothly."""
        below = self.nodes[self.top[k]]
        joined = (
            row[c_.RECORD] >= 0.0
            and below[c_.RECORD] >= 0.0
            and row[c_.OUT_S] == below[c_.IN_S]
            and row[c_.BRANCH] == below[c_.BRANCH]
            and row[c_.OUT_S] != self.kink
        )
        self._put(k, [*row, float(self.top[k]), float(joined)])

    def push_strip(self, k: int, inner: float, outer: float, now: list[float]) -> None:
        """Put a strip on a chain that is left as a whole `now`, at s, d, Y."""
        self.push(k, [inner, *now, outer, *now, -1.0, 0.0])

    def trim(self, k: int, s: float, d: float, Y: float) -> None:
        """Let the chain of a touching side begin at the edge."""
        row = list(self.nodes[self.top[k]])
        if row[c_.RECORD] >= 0.0:
            row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y] = c_.sweep(
                SIDES[k], row, s, d, Y, self.records, self.pieces
            )
        row[c_.IN_X] = self.X[k]
        self._put(k, row)

    def leave(self, s: float, d: float, Y: float) -> None:
        """Take off: all ground is memory."""
        for k in range(2):
            if self.state[k] == TOUCHING:
                self.trim(k, s, d, Y)
        if self.X[0] < self.X[1]:
            self.push_strip(1, self.X[0], self.X[1], [s, d, Y])
        self.state = [FREE, FREE]

    def land(self, s: float, d: float, Y: float) -> None:
        """Touch down: part the chains at the landing point, and let both edges touch."""
        _, X, side, node, sigma = summit(
            s, d, Y, self.top[0], self.top[1], self.nodes, self.records, self.pieces
        )
        near, far = (1, 0) if side > 0.0 else (0, 1)
        inner = self.top[near]
        while inner != node:
            self.push(far, _reversed(self.nodes[inner]))
            inner = int(self.nodes[inner][c_.NEXT])
        row = list(self.nodes[node])
        d_0, Y_0 = row[c_.IN_D], row[c_.IN_Y]
        if row[c_.RECORD] >= 0.0:
            d_0, _, _, Y_0, _, _ = instant(self.records, self.pieces, int(row[c_.RECORD]), sigma)
        cut = [X, sigma, d_0, Y_0]
        if row[c_.IN_X] != X:
            self.push(far, cut + _reversed(row)[4:])
        self._put(near, cut + row[4:])
        self.state, self.X = [TOUCHING, TOUCHING], [X, X]

    def _put(self, k: int, row: list[float]) -> None:
        self.nodes.append(row)
        self.top[k] = len(self.nodes) - 1


def _reversed(row: Node) -> list[float]:
    """Return a node as the other side sees it, without its links."""
    return [*row[4:8], *row[:4], *row[8:10]]
