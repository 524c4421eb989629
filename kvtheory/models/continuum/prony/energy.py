r"""The energy ledger of a transient on a Prony series (facts F14, F23 and F33).

In units of K, each arm of an element stores s_i^2/2k_i and dissipates s_i^2/(k_i T_i), and a damper
dissipates c u'^2, in the contact and where the surface relaxes behind it. The ledger takes the stresses of
each element from the memory, not the moments from which the solver computes the forces, so that its balance
checks them. It is integrated by
Gauss's rule over the ground that the edges passed: between the ends of steps, on panels that double from the
present backwards, since the stresses of fast arms change there: from the shortest relaxation time on in the
contact, from the shortest time in which the free surface relaxes behind it.

What was dissipated until now needs no integral over the ground at each past instant. In the contact
Q_i = int s_i^2 dxi follows the balance, with the moments F_i and M_i, over both edges,

    Q_i' = 2 k_i (d' F_i - 2 lambda M_i) - 2 Q_i/T_i +- s_e^2 X_e' = P_i - 2 Q_i/T_i,

    int_0^s Q_i/T_i ds' = 1/2 int_0^s P_i(s') (1 - e^-2(s - s')/T_i) ds'.

An element that an edge left at sigma relaxes in modes, m_j e^-r_j(s - sigma), and has lost since then

    sum_jl m_j m_l L_jl (1 - e^-(r_j + r_l)(s - sigma))/(r_j + r_l)

with s_i = sum_j f_ij m_j, u = sum_j h_j m_j and L_jl = sum_i f_ij f_il/(k_i T_i) + c h_j r_j h_l r_l: that of
free ground follows from the ground at present, and that of ground which an
edge meets again from the element at this edge.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum.energy import MOVING, Ledger, entries
from kvtheory.models.continuum.prony import records as r_
from kvtheory.models.continuum.prony.step import forces, moments
from kvtheory.models.continuum.run import FREE, PEELING, TOUCHING
from kvtheory.records import readable, structured
from kvtheory.scene import base_motion as drive_

Array = NDArray[np.float64]

ABSCISSAE, WEIGHTS = (np.polynomial.legendre.leggauss(10) + np.array([[1.0], [0.0]])) * 0.5
"""Gauss's rule on [0, 1]."""
HALVINGS = 52
"""Bisections for the instant at which an edge passed an element."""
BLOCK = 20
"""Number of times at which the integrals over the ground are evaluated together."""


class Integrals(NamedTuple):
    """Integrals over the ground: of u, of u^2 + sum s_i^2/k_i, of what was lost since an edge left it."""

    volume: Array
    stored: Array
    lost: Array


class Ground:
    """The elements that the edges passed, with their stresses at any time."""

    def __init__(self, motion: Any) -> None:
        run, self.motion = motion.run, motion
        count = motion.counts.steps
        self.steps = motion.steps
        self.polynomials = r_.named(r_.together(run.polynomials, r_.POLYNOMIAL)[:count])
        self.memory = r_.named(r_.together(run.memory, r_.ARM_STATE)[:count])
        self.segments = structured(run.segments[: motion.counts.segments], r_.SEGMENT)
        self.pieces, self.arms = np.asarray(run.pieces), r_.named(r_.together(run.arms, r_.ARM))
        self.modes = r_.named(r_.together(run.modes, r_.MODE))
        self.paused = r_.named(r_.together(run.clock, r_.PIECE)).paused
        self.damper, self.fixed = readable(run.given[0]).damper, readable(run.given[0]).fixed
        self.starts, self.chain = self.steps["start"], np.asarray(run.chain)
        longest = float(motion.counts.s)
        self.ages = [
            fastest * 0.5 * 2.0 ** np.arange(max(0.0, np.log2(longest / fastest) + 2.0))
            for fastest in (
                1.0 / self.modes.rate.max(),
                self.arms.relaxation_time.min(initial=longest),
            )
        ]

    def time(self, index: Any, s: Array) -> Array:
        """Return the time at clocks in steps."""
        step = self.steps[index]
        return np.asarray(step["time"] + np.where(step["lasts"] > 0.0, s - step["start"], 0.0))

    def step_at(self, s: Array) -> Any:
        """Return the steps at times."""
        return np.maximum(np.searchsorted(self.starts, s, side="right") - 1, 0)

    def _parts(self, index: int) -> list[tuple[int, int, bool]]:
        """Return the segments that a step finds, the edge that cuts each, and whether it is in contact."""
        step, segments, found = self.steps[index], self.segments, []
        peeled = [s["segment"] if s["state"] == PEELING else r_.NEVER for s in step["sides"]]
        for number in self.chain[step["first"] : step["first"] + step["count"]].tolist():
            cuts = [k for k in range(2) if peeled[k] == number]
            found.append((number, 2 if len(cuts) == 2 else (cuts or [r_.NEVER])[0], True))
        for k, side in enumerate(step["sides"]):
            number = int(side["own"] if side["state"] == PEELING else side["segment"])
            edge = r_.NEVER if side["state"] in (PEELING, FREE) else k
            while number != r_.NEVER:
                if segments[number]["step"] != r_.NEVER:
                    found.append((number, edge, False))
                number, edge = int(segments[number]["next"]), r_.NEVER
        return found

    def place(self, edge: Any, sigma: Array) -> tuple[Array, Array, Any, Array]:
        """Return X of an edge at instants, dX/dsigma, and step and theta there."""
        index = self.step_at(sigma)
        step = self.steps[index]
        theta = (sigma - step["start"]) / step["span"]
        Y, number = self.slid(index, theta, sigma)
        powers = self.polynomials.edges[index, :, edge].T
        xi = polynomial.polyval(theta, powers, tensor=False)
        rate = polynomial.polyval(theta, polynomial.polyder(powers), tensor=False) / step["span"]
        return xi - Y, rate - np.where(step["lasts"] > 0.0, number, 0.0), index, theta

    def slid(self, index: Any, theta: Array, s: Array) -> tuple[Array, Array]:
        """Return Y and lambda of the base under the indenter."""
        step = self.steps[index]
        piece, along = self.pieces[step["piece"]].T, self.polynomials.offset_rate[index].T
        t, powers = s - piece[drive_.START], piece[drive_.POWERS :]
        moved = polynomial.polyval(t, polynomial.polyint(powers), tensor=False)
        Y = piece[drive_.DISPLACEMENT] + np.where(self.paused[step["piece"]], 0.0, moved)
        Y -= step["along"] + step["lasts"] * polynomial.polyval(
            theta, polynomial.polyint(along), tensor=False
        )
        number = polynomial.polyval(t, powers, tensor=False)
        return Y, number - polynomial.polyval(theta, along, tensor=False)

    def instants(self, edge: Any, X: Array, low: Array, high: Array) -> Array:
        """Return when an edge passed X, for each X, between two instants."""
        rises = self.place(edge, low)[0] < self.place(edge, high)[0]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            before = (self.place(edge, middle)[0] < X) == rises
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        return high

    def integrals(self, s: Array) -> tuple[Integrals, Integrals]:
        """Return the integrals at times, in the contact and outside it."""
        blocks = [self._block(s[i : i + BLOCK]) for i in range(0, s.size, BLOCK)]
        found = np.concatenate([np.zeros((2, 3, 0)), *blocks], axis=-1)
        return Integrals(*found[0]), Integrals(*found[1])

    def _block(self, s: Array) -> Array:
        """Return the integrals at a few times: (2, 3, times)."""
        states = self.motion.states(self.time(self.step_at(s), s), peaks=False)
        (l, r), Y = states["edges"].T, states["way"]
        indices = enumerate(self.step_at(s).tolist())
        rows = [(i, *part) for i, index in indices for part in self._parts(index)]
        found = np.zeros((2, 3, s.size))
        if not rows:
            return found
        owner, number, cut, inside = (np.array(column) for column in zip(*rows, strict=True))
        segment = self.segments[number]
        rest = segment["step"] == r_.NEVER
        low, high = segment["a"].copy(), np.minimum(segment["b"], s[owner])
        for side in range(2):
            here = np.nonzero(~rest & ((cut == side) | (cut == 2)))[0]
            X = (l, r)[side][owner[here]] - Y[owner[here]]
            at = self.instants(segment["edge"][here], X, low[here], np.maximum(high, low)[here])
            own = segment["edge"][here] == side
            high[here], low[here] = np.where(own, at, high[here]), np.where(own, low[here], at)
        low[rest] = np.maximum(segment["X_a"], (l - Y)[owner])[rest]
        high[rest] = np.minimum(segment["X_b"], (r - Y)[owner])[rest]
        rows_of = zip(s[owner], low, high, rest, [self.ages[int(k)] for k in inside], strict=True)
        panels = [self._panels(*row) for row in rows_of]
        which = np.repeat(np.arange(len(rows)), [len(p) - 1 for p in panels])
        a = np.concatenate([p[:-1] for p in panels])
        width = np.concatenate([np.diff(p) for p in panels])
        nodes = (a[:, None] + width[:, None] * ABSCISSAE).reshape(-1)
        weights = (width[:, None] * WEIGHTS).reshape(-1)
        which = np.repeat(which, ABSCISSAE.size)
        for contact in (True, False):
            of = inside[which] == contact
            k = which[of]
            values = self._values(
                s[owner[k]], nodes[of], segment["edge"][k], rest[k], contact, states[owner[k]]
            )
            for n, value in enumerate(values):
                found[0 if contact else 1, n] = np.bincount(owner[k], weights[of] * value, s.size)
        return found

    def _panels(self, s: float, low: float, high: float, rest: bool, given: Array) -> Array:
        """Return the ends of the panels of one segment, at given ages among others."""
        if not low < high:
            return np.zeros(1)
        if rest:
            return np.array([low, high])
        first, last = np.searchsorted(self.starts, [low, high], side="right")
        ages = s - given
        inner = np.concatenate([self.starts[first:last], ages[(low < ages) & (ages < high)]])
        return np.unique(np.concatenate([[low], inner, [high]]))

    def _values(
        self, s: Array, nodes: Array, edge: Any, rest: Any, contact: bool, states: Any
    ) -> Integrals:
        """Return the three integrands at times `s` for elements that the edges passed at `nodes`.

        Those in contact at rest have X instead of an instant.
        """
        k, T = self.arms.stiffness[:, None], self.arms.relaxation_time[:, None]
        at = np.where(rest, 0.0, nodes)
        X, rate, index, theta = self.place(edge, at)
        xi_e = X + self.slid(index, theta, at)[0]
        X, rate = np.where(rest, nodes, X), np.where(rest, 1.0, np.abs(rate))
        now = self.step_at(s)
        age = np.maximum(self.time(now, s) - self.time(index, at), 0.0)
        memory = self.memory
        stress = self._stress(index, edge, theta)
        if contact:
            xi = X + states["way"]
            u = states["depth"] - xi * xi
            A = _of_arms(memory.accumulated_depth, index, theta)
            B = _of_arms(memory.accumulated_slide, index, theta)
            left = stress - k * (A - xi_e * B)
            fade = np.exp(-age / T)
            when = (s - self.starts[now]) / self.steps["span"][now]
            A = _of_arms(memory.accumulated_depth, now, when)
            B = _of_arms(memory.accumulated_slide, now, when)
            stress = k * (A - xi * B) + np.where(rest, 0.0, left * fade)
            self._carry_over(stress, s, X, now, np.where(rest, 0, index))
            lost = np.zeros_like(u)
        else:
            modes = self._modes(stress, self._depth(index, theta) - xi_e * xi_e)
            lost = self._lost(modes, age)
            modes = modes * np.exp(-age * self.modes.rate[:, None])
            u = np.einsum("m,mq->q", self.modes.share, modes)
            stress = np.einsum("im,mq->iq", self.motion.run.from_modes, modes)
        return Integrals(u * rate, (u * u + (stress * stress / k).sum(axis=0)) * rate, lost * rate)

    def _modes(self, stress: Array, u: Array) -> Array:
        """Return the modes of elements with these stresses, and u; without a damper, p = 0 gives it."""
        u = u if self.damper else -stress.sum(axis=0)
        each = u - stress / self.arms.stiffness[:, None]
        each = np.concatenate([each, u[None]]) if self.damper else each
        return np.asarray(np.einsum("mi,iq->mq", self.motion.run.to_modes, each))

    def _lost(self, modes: Array, age: Array) -> Array:
        """Return what free elements lost since an edge left them with these modes."""
        arms, modes_of, f = self.arms, self.modes, self.motion.run.from_modes
        k, T, rates = arms.stiffness, arms.relaxation_time, modes_of.rate
        rise = rates * modes_of.share
        each = np.einsum("ij,il,i->jl", f, f, 1.0 / (k * T))
        each += self.damper * np.outer(rise, rise)
        both = rates[:, None] + rates
        faded = -np.expm1(-both[..., None] * age) / both[..., None]
        return np.asarray(np.einsum("jq,lq,jl,jlq->q", modes, modes, each, faded))

    def _depth(self, index: Any, theta: Array) -> Array:
        """Return d in steps at theta."""
        step, powers = self.steps[index], self.polynomials.depth_rate[index].T
        risen = polynomial.polyval(theta, polynomial.polyint(powers), tensor=False)
        return np.asarray(step["depth"] + step["lasts"] * risen)

    def powers(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Return the powers at clocks: of the drive, of both dampers over their damping, and P_i of each arm.

        The damper of the foundation is the second one. In a pause only what is kept changes.
        """
        index = self.step_at(s)
        theta = (s - self.starts[index]) / self.steps["span"][index]
        number = self.slid(index, theta, s)[1]

        def along(powers: Array) -> Array:
            return polynomial.polyval(theta, powers.T, tensor=False)

        polynomials, memory, step = self.polynomials, self.memory, self.steps[index]
        rate = along(polynomials.depth_rate[index])
        F, M = _of_arms(memory.force, index, theta), _of_arms(memory.moment, index, theta)
        l, r = (along(polynomials.edges[index, :, k]) for k in range(2))
        of_arrays: Any = forces
        integrals_of: Any = moments
        c, lasts, d = self.damper, step["lasts"] > 0.0, self._depth(index, theta)
        damped = c * rate, 2.0 * c * number
        normal, friction = of_arrays(l, r, d, damped, F.sum(axis=0), M.sum(axis=0))
        I_0, I_1, I_2, _ = integrals_of(l, r)
        pressed = rate * rate * I_0 - 4.0 * number * (rate * I_1 - number * I_2)
        power = 2.0 * self.arms.stiffness[:, None] * (rate * F - 2.0 * number * M)
        w = along(polynomials.offset_rate[index])
        power = np.where(lasts, power, 0.0)
        for k, side in enumerate((-1.0, 1.0)):
            _, moves, _, _ = self.place(k, s)
            flies = step["sides"]["state"][:, k] == FREE
            power += side * np.where(flies, 0.0, moves) * self._stress(index, k, theta) ** 2
        held = rate * normal if self.fixed else 0.0  # what holds the indenter moves it
        drive = (number + w) * friction + held
        return lasts * drive, lasts * w * w, lasts * pressed, power

    def spent(self, s: float, damping: float) -> tuple[float, float, float, float]:
        """Return the work until `s`, and what contact, ground that was met again and damper lost."""
        panels = self._panels(s, 0.0, s, False, self.ages[1])
        if panels.size < 2:
            return 0.0, 0.0, 0.0, 0.0
        width = np.diff(panels)[:, None]
        t = (panels[:-1, None] + width * ABSCISSAE).reshape(-1)
        weights = (width * WEIGHTS).reshape(-1)
        drive, damper, pressed, powers = self.powers(t)
        age = self.time(self.step_at(np.array([s])), np.array([s])) - self.time(self.step_at(t), t)
        fade = -2.0 * age / self.arms.relaxation_time[:, None]
        kept = -np.expm1(fade) / self.arms.stiffness[:, None]
        inside = 0.375 * (kept * powers).sum(axis=0) + 0.75 * self.damper * pressed
        rows = drive, inside, 0.75 * self.met_again(t), damping * damper
        work, contact, again, lost = (float(weights @ row) for row in rows)
        return work, contact, again, lost

    def met_again(self, s: Array) -> Array:
        """Return what elements had lost that an edge meets again at times, per time."""
        index, found = self.step_at(s), np.zeros_like(s)
        for k in range(2):
            side = self.steps["sides"][index, k]
            number = np.where(side["state"] == TOUCHING, side["segment"], r_.NEVER)
            at = np.nonzero(number != r_.NEVER)[0]
            at = at[self.segments["step"][number[at]] != r_.NEVER]
            if not at.size:
                continue
            segment = self.segments[number[at]]
            X, moves, _, _ = self.place(k, s[at])
            edge = segment["edge"]
            last = np.nextafter(np.minimum(segment["b"], s[at]), 0.0)  # at b a flight may begin
            sigma = self.instants(edge, X, segment["a"], last)
            _, _, then, theta = self.place(edge, sigma)
            u = self._depth(then, theta) - (X + self.slid(then, theta, sigma)[0]) ** 2
            modes = self._modes(self._stress(then, edge, theta), u)
            age = np.maximum(self.time(index[at], s[at]) - self.time(then, sigma), 0.0)
            found[at] += self._lost(modes, age) * np.abs(moves)
        return found

    def _stress(self, index: Any, edge: Any, theta: Array) -> Array:
        """Return s_i of the elements at edges in steps at theta."""
        powers = self.memory.stress_at_edge[index, :, :, edge]
        return np.asarray(polynomial.polyval(theta, powers.T, tensor=False))

    def _carry_over(self, stress: Array, s: Array, X: Array, now: Any, entered: Any) -> None:
        """Add to stresses in the steps `now` those carried over from before restarts of the accumulators."""
        restart, memory = self.steps["restart"], self.memory
        k, T = self.arms.stiffness[:, None], self.arms.relaxation_time[:, None]
        j, first = restart[now], restart[entered]
        while (of := np.nonzero(j > first)[0]).size:
            start, last = self.starts[j[of]], j[of] - 1
            gone = self.time(now[of], s[of]) - self.time(last, start)
            theta = (start - self.starts[last]) / self.steps["span"][last]
            A, B = (
                _of_arms(powers, last, theta) - powers[j[of], :, 0].T
                for powers in (memory.accumulated_depth, memory.accumulated_slide)
            )
            xi = X[of] + self.slid(last, theta, start)[0]
            stress[:, of] += k * (A - xi * B) * np.exp(-gone / T)
            j[of] = restart[last]


def _of_arms(powers: Array, index: Any, theta: Array) -> Array:
    """Return a quantity of the arms in steps at theta: (arms, times)."""
    return np.asarray(polynomial.polyval(theta, powers[index].T, tensor=False))


def volume(motion: Any, s: float) -> float:
    """Return U = int u dxi over the whole surface; f_z = 3/4 (U + sum S_i), S_i' = k_i U' - S_i/T_i (F14)."""
    within, outside = Ground(motion).integrals(motion.clock([s]))
    return float(within.volume[0] + outside.volume[0])


def ledger(motion: Any, s: ArrayLike) -> Ledger:
    """Return the energy ledger at the times `s`, in their shape; its entries are as on Kelvin-Voigt.

    >>> from kvtheory.models.continuum.prony.trajectory import solve
    >>> from kvtheory.scene.base_motion import BaseMotion
    >>> motion = solve(BaseMotion.constant(1.0, end=2.0), [(5.0, 1.0)], (0.04, 0.0), 2.0, 1e-9)
    >>> books = ledger(motion, 1.0)
    >>> print(f"{books.work:.6f} {books.dissipated_contact:.6f} {abs(books.balance) < 1e-8}")
    0.705742 0.143332 True
    """
    times, ground, given = np.asarray(s, dtype=float), Ground(motion), readable(motion.run.given[0])
    flat = times.reshape(-1)
    clock = motion.clock(flat)
    sums = np.array([ground.spent(t, given.damping) for t in clock.tolist()]).reshape(-1, 4).T
    states, (within, outside) = motion.states(flat, peaks=False), ground.integrals(clock)
    sums[2] += 0.75 * outside.lost
    moving = np.array([states[name] for name in MOVING])
    stored = 0.375 * np.array([within.stored, outside.stored])
    return entries(given, moving, sums, stored, times.shape)
