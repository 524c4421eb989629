"""The transient on a Prony series from the stresses of the material: a table of references for tests.

The program has no accumulators, no moments, and no equation for an edge. The surface is a row of segments of
material with the stress of each arm at Gauss points. In a step d and Y are polynomials; every point of the
material moves exactly on them, by a convolution in contact and by modes where it is free; the edges are roots
along the material, forces integrals of the pressure; collocation of the equations of motion gives the
polynomials. Ground that enters or leaves becomes new segments. A step ends where an edge turns, or passes
ground with a kink, and at take-off and landing.

Scaled: stiffness 1, u = d - x^2 with x = X + Y, f_z = 3/4 int p dx, f_x = -3/2 int x p dx.
`python -m tests.prony_reference` writes the table, in some ten minutes; its errors, relative to the state at
rest, are the changes from longer to shorter steps.
"""

import itertools
import json
import math
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial import polynomial as p_
from scipy.optimize import brentq, minimize_scalar

TABLE = Path(__file__).parent / "data" / "prony_reference.json"
STIFFNESS, RADIUS, LOAD, DEPTH = 1e10, 0.01, 9806.65, 1e-4
QUANTITIES = "depth", "normal_force", "friction_force", "left_edge", "right_edge", "peak_pressure"
STAGES, NODES, STEPS = 5, 10, (0.06, 0.03)
LAYERS = 12
"""Halvings of new ground towards an edge that turned."""
AGE, AGES = (legendre.leggauss(14) + np.array([[1.0], [0.0]])) * 0.5
STIFF = 4.0
"""From so many relaxation times on the convolution is a series in the derivatives instead of Gauss's rule."""


def value(t, powers):
    return p_.polyval(t, powers)


class Step:
    """Polynomials d and Y of theta in [0, 1] over a time h, and the motion of points on them."""

    def __init__(self, arms, h, d, y):
        self.arms, self.h, self.d, self.y = arms, h, d, y
        slide = p_.polyder(y) / h
        rise = p_.polysub(p_.polyder(d) / h, 2.0 * p_.polymul(y, slide))
        self.rates = [np.zeros((max(len(rise), len(slide)), 2))]  # u' = rise - 2 X slide
        self.rates[0][: len(rise), 0], self.rates[0][: len(slide), 1] = rise, slide
        while len(self.rates[-1]) > 1:
            self.rates.append(p_.polyder(self.rates[-1]) / h)

    def gap(self, X, t):
        return value(t, self.d) - (X + value(t, self.y)) ** 2

    def rate(self, X, t):
        rise, slide = value(t, self.rates[0])
        return rise - 2.0 * X * slide

    def stress(self, s, X, a, b):
        """Return s_i (arms, points) at b of points in contact since a, when it was s."""
        k, T = self.arms.T[:, :, None]
        a, b = np.broadcast_arrays(np.atleast_1d(a).astype(float), b)
        z = self.h * (b - a) / T
        soft = np.exp(-np.minimum(z, STIFF)[:, :, None] * (1.0 - AGE)) * AGES
        rates = value(a[:, None] + (b - a)[:, None] * AGE, self.rates[0])
        c = np.einsum("cpq,ipq->cip", rates, soft) * (self.h * (b - a))
        if z.max(initial=0.0) > STIFF:
            series = [
                sum(
                    (-1) ** m * T ** (m + 1) * value(t, r)[:, None]
                    for m, r in enumerate(self.rates)
                )
                for t in (a, b)
            ]
            c = np.where(z <= STIFF, c, series[1] - np.exp(-z) * series[0])
        return np.exp(-z) * s + k * (c[0] - 2.0 * X * c[1])


class Ground:
    """Segments [a, b] of the material; s_i of those in contact, i <= j < k, and modes of the others."""

    def __init__(self, arms, reach):
        self.arms = np.array(arms, dtype=float)
        (k, T), count = self.arms.T, len(arms)
        self.glass, ratio = 1.0 + k.sum(), np.sqrt(k / T)
        self.decay, v = np.linalg.eigh(np.outer(ratio, ratio) / self.glass - np.diag(1.0 / T))
        self.back, self.to = np.sqrt(k * T)[:, None] * v, v.T / np.sqrt(k * T)
        self.u = -self.back.sum(axis=0)  # u + sum s_i = 0
        self.x, self.weights = legendre.leggauss(NODES)
        self.fit = np.linalg.inv(legendre.legvander(self.x, NODES - 1)).T
        self.a, self.b = np.array([-reach, -1.0, 1.0]), np.array([-1.0, 1.0, reach])
        self.s, self.i, self.k = np.zeros((3, count, NODES)), 1, 2
        self.edges, self.ends = [-1.0, 1.0], [np.zeros(count)] * 2
        self.kinks = [-1.0, 1.0]

    def points(self, a, b):
        return 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * self.x

    def read(self, j, X):
        """Return what segments hold at points: (arms, all points)."""
        a, b = self.a[j][:, None], self.b[j][:, None]
        basis = legendre.legvander((2.0 * X - a - b) / (b - a), NODES - 1)
        return flat(np.einsum("pqc,pic->piq", basis, self.s[j] @ self.fit))

    def modes(self, q, step, t):
        return q * np.exp(self.decay[:, None] * step.h * t)

    def margin(self, step, t, j, X):
        """Return p at points of a segment in contact, or how deep they are below the indenter."""
        held = self.read(np.array([j]), X[None])
        if self.i <= j < self.k:
            return step.gap(X, t) + step.stress(held, X, 0.0, t).sum(axis=0)
        return step.gap(X, t) - self.u @ self.modes(held, step, t)

    def root(self, step, t, j, near, far):
        """Return where the margin of a segment, positive at `near`, vanishes before `far`."""
        a, b = min(near, far), max(near, far)
        c = self.fit.T @ self.margin(step, t, j, 0.5 * (a + b) + 0.5 * (b - a) * self.x)
        at = lambda X: legendre.legval((2.0 * X - a - b) / (b - a), c)  # noqa: E731
        if b - a < 1e-14 or at(near) <= 0.0:
            return near
        return far if at(far) >= 0.0 else brentq(at, a, b, xtol=1e-15, rtol=1e-15)

    def largest(self, margin, js):
        """Return the largest margin over segments, and its place."""
        js = [j for j in js if self.b[j] - self.a[j] > 1e-11]  # others are rounding
        grids = [np.linspace(self.a[j], self.b[j], 2 * NODES + 1) for j in js]
        tops = np.array([margin(j, grid).max() for j, grid in zip(js, grids, strict=True)])
        best, place = -math.inf, math.nan
        for n in range(max(tops.argmax() - 1, 0), min(tops.argmax() + 2, len(js))):
            values, grid = margin(js[n], grids[n]), grids[n]
            m = values.argmax()
            low, high = grid[max(m - 1, 0)], grid[min(m + 1, len(grid) - 1)]
            found = minimize_scalar(
                lambda X, j=js[n]: -margin(j, np.array([X]))[0], bounds=(low, high), method="bounded",
                options={"xatol": 1e-10 * (high - low)},
            )  # fmt: skip
            for top, at in ((values[m], grid[m]), (-found.fun, found.x)):
                if top > best:
                    best, place = float(top), float(at)
        return best, place

    def pieces(self, edge, old, js, span, fresh):
        """Return pieces between an edge and its old place, smaller towards the edge where it is needed."""
        z = span / self.arms[:, 1].min()
        fine = 0.5 ** np.arange(
            1, 1 + max(LAYERS * fresh, math.ceil(math.log2(4.0 * z)) if z > 0.25 else 0)
        )
        cuts = edge + (old - edge) * np.concatenate([fine, 1.0 - fine] if fresh else [fine])
        inner, (low, high) = self.a[js[0] + 1 : js[1]], sorted((edge, old))
        cuts = np.unique(np.concatenate([[low, high], cuts, inner]).clip(low, high))
        a, b = cuts[:-1], cuts[1:]
        a, b = a[b - a > 1e-15], b[b - a > 1e-15]
        return a, b, js[0] + np.searchsorted(inner, 0.5 * (a + b))

    def entry(self, step, X, q, end):
        """Return when the indenter meets points with the modes q, and their s_i then."""

        def gap(t):
            now = self.modes(q, step, t)
            slope = step.rate(X, t) - self.u @ (self.decay[:, None] * now)
            return step.gap(X, t) - self.u @ now, step.h * slope

        t = zeros(gap, X.size, end)
        return t, self.back @ self.modes(q, step, t)

    def leave(self, step, X, s):
        """Return when the pressure of points vanishes, and their s_i then."""

        def tension(t):
            now = step.stress(s, X, 0.0, t)
            slope = (now / self.arms[:, 1:]).sum(axis=0) - self.glass * step.rate(X, t)
            return -step.gap(X, t) - now.sum(axis=0), step.h * slope

        t = zeros(tension, X.size, 1.0)
        return t, step.stress(s, X, 0.0, t)

    def contact(self, step, t, fresh):
        """Return the contact at t, or the largest pressure and its place where there is none."""
        edges, states, places, new = [0.0, 0.0], [0, 0], [0, 0], [None, None]
        for side, out in ((0, -1), (1, 1)):
            e, ends = self.edges[side], (self.a, self.b)
            p = step.gap(e, t) + step.stress(self.ends[side][:, None], np.array([e]), 0.0, t).sum()
            states[side] = 1 if p > 0.0 else -1
            j, near = (self.i - 1, self.k)[side], e
            if p > 0.0:
                while self.margin(step, t, j, ends[side][[j]])[0] >= 0.0:
                    j, near = j + out, ends[side][j]
                far = ends[side][j]
            else:
                j -= out
                while (
                    self.i <= j < self.k and self.margin(step, t, j, ends[1 - side][[j]])[0] <= 0.0
                ):
                    j -= out
                if self.i <= j < self.k:
                    near, far = ends[1 - side][j], ends[side][j]
                else:
                    js = list(range(self.i, self.k))
                    top, place = (
                        self.largest(lambda j, X: self.margin(step, t, j, X), js)
                        if js
                        else (-1.0, e)
                    )
                    if top <= 0.0:
                        return top, place
                    j = self.i + int(np.searchsorted(self.a[self.i + 1 : self.k], place))
                    near, far = place, ends[side][j]
            edges[side], places[side] = self.root(step, t, j, near, far), j
            if p > 0.0:
                a, b, js = self.pieces(
                    edges[side], e, ((j, self.i), (self.k, j + 1))[side], step.h * t, fresh
                )
                X = self.points(a, b)
                since, s = self.entry(step, X.ravel(), self.read(js, X), t)
                new[side] = a, b, pieced(step.stress(s, X.ravel(), since, t))
        if edges[0] >= edges[1]:
            return 0.0, edges[0]
        return edges, states, places, [n for n in new if n], self.held(step, t, edges)

    def held(self, step, t, edges):
        """Return the pieces that remain in contact, with their s_i."""
        run = np.arange(self.i, self.k)
        a, b = self.a[run].clip(*edges), self.b[run].clip(*edges)
        run, a, b = (q[b - a > 1e-15] for q in (run, a, b))
        X = self.points(a, b)
        return a, b, pieced(step.stress(self.read(run, X), X.ravel(), 0.0, t))

    def forces(self, step, t, found):
        """Return f_z and f_x."""
        if len(found) == 2:
            return 0.0, 0.0
        Y, total = value(t, step.y), np.zeros(2)
        for a, b, s in (*found[3], found[4]):
            X = self.points(a, b)
            p = (step.gap(X, t) + s.sum(axis=1)) * self.weights * 0.5 * (b - a)[:, None]
            total += p.sum(), ((X + Y) * p).sum()
        return 0.75 * total[0], -1.5 * total[1]

    def at_edges(self, step, found):
        """Return s_i of the material at the edges, and the rates of its pressure if it is in contact."""
        rows = []
        for edge, state, j in zip(*found[:3], strict=True):
            X = np.array([edge])
            q = self.read(np.array([j]), X[None])
            s = step.stress(q, X, 0.0, 1.0) if state < 0 else self.back @ self.modes(q, step, 1.0)
            rows.append(
                (
                    s[:, 0],
                    float(self.glass * step.rate(X, 1.0)[0] - (s[:, 0] / self.arms[:, 1]).sum()),
                )
            )
        return rows

    def advance(self, step, found, fresh, closed=None):
        """Move the ground to the end of a step, at which the contact may have closed at a place."""
        free = pieced(self.modes(flat(self.s), step, 1.0))
        if found is None:
            self.s = free
            return
        ends, run = [], []
        if closed is None:
            edges, states, places, new, held = found
            ends, run = self.at_edges(step, found), [*new, held]
        else:
            edges, states = [closed] * 2, [-1, -1]
            places = [self.i + int(np.searchsorted(self.a[self.i + 1 : self.k], closed))] * 2
        outside = [], []
        for side in range(2):
            e, j, part = edges[side], places[side], outside[side]
            touches = states[side] > 0
            rest = (slice(0, j if touches else self.i), slice(j + 1 if touches else self.k, None))[
                side
            ]
            part.append((self.a[rest], self.b[rest], free[rest]))
            if touches:
                a, b = (self.a[[j]], np.array([e])) if side == 0 else (np.array([e]), self.b[[j]])
                if b[0] - a[0] > 1e-15:
                    part.append(
                        (
                            a,
                            b,
                            pieced(
                                self.modes(self.read(np.array([j]), self.points(a, b)), step, 1.0)
                            ),
                        )
                    )
            else:
                a, b, js = self.pieces(
                    e, self.edges[side], ((self.i, j + 1), (j, self.k))[side], step.h, fresh
                )
                X = self.points(a, b)
                since, s = self.leave(step, X.ravel(), self.read(js, X))
                part.append((a, b, pieced(self.modes(self.to @ s, step, 1.0 - since))))
        rows = [
            [np.concatenate(q) for q in zip(*part, strict=True)]
            for part in (outside[0], run, outside[1])
            if part
        ]
        ordered = [[q[np.argsort(row[0])] for q in row] for row in rows]
        self.a, self.b, self.s = (np.concatenate(q) for q in zip(*ordered, strict=True))
        self.i = len(rows[0][0])
        self.k = self.i + (len(rows[1][0]) if run else 0)
        self.edges, self.ends = list(edges), [s for s, _ in ends]

    def land(self, place):
        """Begin a contact at a place."""
        j = int(np.searchsorted(self.a, place)) - 1
        a, b = np.array([self.a[j], place]), np.array([place, self.b[j]])
        s = self.back @ self.read(np.array([j]), np.array([[place]]))[:, 0]
        two = pieced(self.read(np.array([j, j]), self.points(a, b)))
        for name, new in (("a", a), ("b", b), ("s", two)):
            old = getattr(self, name)
            setattr(self, name, np.concatenate([old[:j], new, old[j + 1 :]]))
        self.i = self.k = j + 1
        self.edges, self.ends = [place, place], [s, s]


def flat(s):
    return s.transpose(1, 0, 2).reshape(s.shape[1], -1)


def pieced(s):
    return s.reshape(len(s), -1, NODES).transpose(1, 0, 2)


def zeros(function, count, end):
    """Return the zeros in [0, end] of functions that rise through them; also their slopes are given."""
    low, high, t = np.zeros(count), np.full(count, float(end)), np.full(count, 0.5 * end)
    for _ in range(60):
        f, slope = function(t)
        low, high = np.where(f <= 0.0, t, low), np.where(f > 0.0, t, high)
        with np.errstate(all="ignore"):
            new = t - f / slope
        new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
        change, t = np.abs(new - t).max(initial=0.0), new
        if change < 1e-13:
            break
    return t


def lagrange(nodes, j):
    """Return the coefficients of the polynomial that is 1 at one node and 0 at the others."""
    others = np.delete(nodes, j)
    return p_.polyfromroots(others) / np.prod(nodes[j] - others)


class Solver:
    """A transient: `drive` are pieces (t, Y, V, V'), `along` inertia, damping and stiffness of its spring."""

    def __init__(self, arms, eps, kappa, drive, end, along, longest):
        self.eps, self.kappa, self.drive, self.along, self.longest = (
            eps,
            kappa,
            drive,
            along,
            longest,
        )
        reach = 4.0 + max(abs(Y) + abs(V) * end + abs(slope) * end**2 for _, Y, V, slope in drive)
        self.ground, self.flies = Ground(arms, reach), False
        legs = legendre.Legendre.basis(STAGES) - legendre.Legendre.basis(STAGES - 1)
        self.c = c = np.sort(0.5 * (legs.roots() + 1.0)).clip(0.0, 1.0)  # of Radau IIA
        basis = np.array([lagrange(c, j) for j in range(STAGES)])
        self.rise = np.array([p_.polyint(b) for b in basis])
        self.lift, whole = value(c, self.rise.T).T, np.append(0.0, c)
        slopes = [value(c, p_.polyder(lagrange(whole, j))) for j in range(STAGES + 1)]
        self.slopes = np.array(slopes).T
        self.t, self.now = 0.0, np.array([1.0, 0.0, 0.0, 0.0])  # d, d', x, x'
        self.first = min(0.01 * longest, 0.3 * self.ground.arms[:, 1].min())

    def attempt(self, h, fresh):
        """Return d' and x' at the stages of a step, the step, and the contacts of the stages."""
        (d, v, x, w), ground = self.now, self.ground
        start, Y, V, slope = [q for q in self.drive if q[0] <= self.t + 1e-12][-1]
        s = self.t - start
        y = np.array(
            [Y + V * s + 0.5 * slope * s * s - x, h * (V + slope * s), 0.5 * h * h * slope]
        )
        on = [self.eps is not None, self.along is not None]
        state = {}

        def residual(z):
            vs, ws = full = np.zeros((2, STAGES))
            full[on] = z.reshape(-1, STAGES)
            step = Step(
                ground.arms,
                h,
                p_.polyadd([d], h * vs @ self.rise),
                p_.polysub(y, h * ws @ self.rise),
            )
            found = [None if self.flies else ground.contact(step, c, fresh) for c in self.c]
            f = np.array(
                [
                    (0.0, 0.0) if q is None else ground.forces(step, c, q)
                    for q, c in zip(found, self.c, strict=True)
                ]
            )
            state.update(rates=full, step=step, found=found)
            rows = []
            if on[0]:
                depth = d + h * self.lift @ vs
                rows.append(
                    self.eps * (self.slopes @ np.append(v, vs)) / h
                    - 1.0
                    + f[:, 0]
                    + self.kappa * (depth - 1.0)
                )
            if on[1]:
                inertia, damping, spring = self.along
                place = x + h * self.lift @ ws
                rows.append(
                    inertia * (self.slopes @ np.append(w, ws)) / h
                    - f[:, 1]
                    + damping * ws
                    + spring * place
                )
            return np.concatenate(rows)

        if not any(on):
            step = Step(ground.arms, h, np.array([d]), y)
            return np.zeros((2, STAGES)), step, [ground.contact(step, c, fresh) for c in self.c]
        wide = 0.0 if self.flies else ground.edges[1] - ground.edges[0]
        mid = 0.0 if self.flies else 0.5 * sum(ground.edges) + y[0]
        k, T = ground.arms.T
        stiff = wide * (1.0 + (k * -np.expm1(-0.5 * h / T) / (0.5 * h / T)).sum())
        blocks = np.zeros((2, STAGES, 2, STAGES))
        blocks[0, :, 0] = (self.eps or 0.0) * self.slopes[:, 1:] / h + h * self.lift * (
            0.75 * stiff + self.kappa
        )
        blocks[0, :, 1] = blocks[1, :, 0] = h * self.lift * 1.5 * stiff * mid
        if on[1]:
            moment = 3.0 * stiff * (mid * mid + wide**2 / 12.0)
            inertia, damping, spring = self.along
            blocks[1, :, 1] = (
                inertia * self.slopes[:, 1:] / h
                + damping * np.eye(STAGES)
                + h * self.lift * (spring + moment)
            )
        jacobian = blocks[on][:, :, on].reshape(sum(on) * STAGES, -1)
        guess = np.repeat(self.now[[1, 3]][on], STAGES)
        inverse, z, r = np.linalg.inv(jacobian), guess, residual(guess)
        last = math.inf
        for turn in range(60):
            move = -inverse @ r
            z = z + move
            change = residual(z) - r
            r, size, down = r + change, np.abs(move).max(), move @ inverse @ change
            if size < 1e-14 or (turn > 3 and 0.5 * last <= size < 1e-11):
                return state["rates"], state["step"], state["found"]
            if abs(down) > 1e-300:  # Broyden
                inverse += np.outer(move - inverse @ change, move @ inverse) / down
            last = size
        raise ArithmeticError(f"no convergence at {self.t}")

    def events(self, step, found):
        """Return what happens in a step: numbers that are negative after it, and places."""
        ground = self.ground
        if self.flies:
            Y, half = value(1.0, step.y), math.sqrt(max(value(1.0, step.d), 0.0)) + 1e-9
            js = np.nonzero((ground.b > -Y - half) & (ground.a < -Y + half))[0]
            top, place = ground.largest(lambda j, X: ground.margin(step, 1.0, j, X), js)
            return {"landing": (-top, place)}
        last, out = found[-1], {}
        if any(len(q) == 2 for q in found):
            return {"take-off": last if len(last) == 2 else (-1.0, 0.0)}
        for side, (_, rate) in enumerate(ground.at_edges(step, last)):
            state, old, new = last[1][side], ground.edges[side], last[0][side]
            same = all(q[1][side] == state for q in found)
            out["turn", side] = rate * state + 1e-10 if same else -1.0, 0.0
            for kink in ground.kinks:
                way = math.copysign(1.0, new - old)
                if (kink - old) * way > 1e-9:
                    out["kink", side, kink] = (kink - new) * way + 1e-13, kink
        return out

    def run(self, outs):
        """Return d, f_z, f_x, both edges and the largest pressure at times."""
        ground, rows, size, fresh = self.ground, [], self.first, True
        starts = [q[0] for q in self.drive if q[0] > 0.0]
        while len(rows) < len(outs):
            stop = min(q for q in (*starts, *outs) if q > self.t + 1e-13)
            h = stop - self.t
            h = h if h <= size else min(size, 0.5 * h) if h < 2.0 * size else size
            tried = self.attempt(h, fresh)
            seen = self.events(*tried[1:])
            event = None
            if min(seen.values())[0] < 0.0:
                h, event, place, tried = self.locate(h, fresh)
            rates, step, found = tried
            kind = event[0] if isinstance(event, tuple) else event
            taking = kind == "take-off"
            ground.advance(step, found[-1], fresh or kind == "turn", place if taking else None)
            self.t = stop if event is None and h == stop - self.t else self.t + h
            d, x = value(1.0, step.d), self.now[2] + h * rates[1] @ self.rise.sum(axis=1)
            self.now, fresh = np.array([d, rates[0, -1], x, rates[1, -1]]), False
            if taking:
                self.flies = True
                ground.kinks.append(place)
            if kind == "landing":
                ground.land(place)
                self.flies, fresh = False, True
            if kind or any(abs(self.t - q) < 1e-12 for q in starts):
                if not self.flies:
                    ground.kinks += ground.edges
                fresh = kind != "kink" and not self.flies
                size = max(self.first, 0.1 * size) if kind == "kink" else self.first
            else:
                size = min(self.longest, 1.5 * max(h, 0.5 * size if h < size else size))
            if any(abs(self.t - q) <= 1e-12 for q in outs):
                rows.append(self.row(value(1.0, step.y), found[-1], step))
        return np.array(rows)

    def locate(self, h, fresh):
        """Return the time until the first event in a step, what and where it is, and the step until then.

        Steps approach a take-off, before which the force falls as the power 3/2 of the time left.
        """
        tried = {}

        def margin(at):
            now = self.attempt(at, fresh)
            seen = self.events(*now[1:])
            name = min(seen, key=lambda q: seen[q][0])
            tried[at] = seen[name][0], name, seen[name][1], now
            return seen[name][0]

        brentq(lambda at: margin(at) if at > 0.0 else 1.0, 0.0, h, xtol=1e-13, rtol=1e-15)
        at = max(at for at, (size, *_) in tried.items() if size >= 0.0)
        _, name, place, _ = tried[min(at for at, (size, *_) in tried.items() if size < 0.0)]
        share = 10.0 * self.longest
        if name == "take-off" and at > 1e-3 * self.longest:
            return share * at, None, 0.0, self.attempt(share * at, fresh)
        return at, name, place, tried[at][-1]

    def row(self, Y, found, step):
        """Return the quantities at the end of a step."""
        if self.flies:
            return self.now[0], 0.0, 0.0, math.nan, math.nan, 0.0
        ground, d = self.ground, self.now[0]
        p = lambda j, X: d - (X + Y) ** 2 + ground.read(np.array([j]), X[None]).sum(axis=0)  # noqa: E731
        peak, _ = ground.largest(p, range(ground.i, ground.k))
        return d, *ground.forces(step, 1.0, found), found[0][0] + Y, found[0][1] + Y, peak


def scene(
    arms, history, end, support="dead-weight", mass=1000.0, stiffness=None, steps=STEPS, drive=()
):
    """Return a scene in SI; a number is the velocity of a start from rest."""
    points = history if isinstance(history, list) else [[0.0, history]]
    points = points if points[-1][0] == end else [*points, [end, points[-1][1]]]
    given = {
        "arms": arms,
        "history": points,
        "support": support,
        "mass": mass,
        "stiffness": stiffness,
    }
    return given | {
        "drive": dict(drive),
        "steps": steps,
        "time": [end * k / 4 for k in (1, 2, 3, 4)],
    }


def stop(V, t, after=0.0):
    return [[0.0, V], [t, V], [t, after]]


THREE = [[2e10, 2e-3], [1e10, 0.02], [5e9, 0.3]]
SIX = [[3e10, 1e-6], [1e10, 1e-4], [2e10, 2e-3], [1e10, 0.02], [5e9, 1.0], [1e10, 100.0]]
TEN = [[1e10, 1e-4], [2e10, 4e-4], [5e9, 1e-3], [1.5e10, 3e-3], [1e10, 0.01], [7e9, 0.03], [4e9, 0.1],
       [3e9, 0.4], [2e9, 2.0], [1e9, 30.0]]  # fmt: skip
ONE, TWO, FINE = [[5e10, 0.1]], [[3e10, 0.01], [5e9, 0.5]], (0.03, 0.015)
SPRING = {"stiffness": 1e6, "mass": 100.0}
SCENES = {
    "start": scene(ONE, 0.05, 0.06, steps=FINE),
    "start, fixed": scene([[5e10, 0.03]], 0.05, 0.12, "fixed"),
    "start, suspended": scene(TWO, 0.1, 0.04, "suspended", 3000.0, 1e8),
    "start, ten arms": scene(TEN, 0.05, 0.05, steps=FINE),
    "start, fixed, eight decades": scene(SIX, 0.05, 0.06, "fixed"),
    "start, heavy": scene(SIX[1:], 0.1, 0.06, mass=2e5),
    "start, light": scene(THREE, 0.05, 0.05, mass=30.0, steps=(0.01, 0.005)),
    "start, stiff fast arm": scene([[1e12, 1e-3]], 0.1, 0.03, mass=3000.0),
    "start, frozen arm": scene([[2e10, 0.02], [3e10, 1e3]], -0.05, 0.06, steps=FINE),
    "ramp": scene([[3e10, 0.02]], [[0.0, 0.0], [0.03, 0.1]], 0.06),
    "stop, fixed": scene([[5e10, 0.03]], stop(0.05, 0.03), 0.08, "fixed"),
    "stop": scene(THREE, stop(0.05, 0.025), 0.06),
    "reversal, fixed": scene(TWO, stop(0.05, 0.03, -0.05), 0.08, "fixed"),
    "reversal, suspended": scene(THREE, stop(0.1, 0.015, -0.1), 0.04, "suspended", 3000.0, 1e8),
    "to and fro": scene(
        [[3e10, 0.01]], [[0.0, 0.0], [0.015, 0.1], [0.045, -0.1], [0.06, 0.0]], 0.06
    ),
    "spring and damper": scene(
        THREE, 0.05, 0.06, drive={"stiffness": 3e7, "damping": 1e5, "mass": 1000.0}
    ),
    "stick-slip": scene(ONE, 0.05, 0.08, steps=(0.03, 0.02), drive=SPRING),
    "stick-slip, fixed": scene(ONE, 0.05, 0.08, "fixed", drive=SPRING),
    "stick-slip, suspended": scene(
        THREE,
        0.1,
        0.08,
        "suspended",
        1000.0,
        1e7,
        drive={"stiffness": 1e6, "damping": 100.0, "mass": 10.0},
    ),
    "hop": scene([[3e11, 0.01]], 0.3, 0.0168, steps=(0.06, 0.04)),
}


def entry(name, given):
    """Return a scene with its values, and with errors relative to the state at rest."""
    fixed, points = given["support"] == "fixed", given["history"]
    depth = DEPTH if fixed else (0.75 * LOAD / STIFFNESS / math.sqrt(2 * RADIUS)) ** (2 / 3)
    half = math.sqrt(2 * RADIUS * depth)
    load, tau = 4 / 3 * STIFFNESS * half * depth, half / max(abs(V) for _, V in points)
    drive, Y = [], 0.0
    for (t, V), (end, last) in itertools.pairwise(points):
        if end > t:
            drive.append((t / tau, Y, V * tau / half, (last - V) / (end - t) * tau**2 / half))
            Y += 0.5 * (V + last) * (end - t) / half
    unit, along = half**2 / (load * depth), given["drive"] or None
    if along:
        along = (
            along["mass"] * unit / tau**2,
            along.get("damping", 0.0) * unit / tau,
            along["stiffness"] * unit,
        )
    found = [
        Solver(
            [(k / STIFFNESS, T / tau) for k, T in given["arms"]],
            None if fixed else given["mass"] * depth / (load * tau**2),
            (given["stiffness"] or 0.0) * depth / load,
            drive, points[-1][0] / tau, along, longest,
        ).run([t / tau for t in given["time"]])
        for longest in given["steps"]
    ]  # fmt: skip
    units = depth, load, load * depth / half, half, half, STIFFNESS * depth
    values = {
        q: [None if math.isnan(v) else float(f"{v * u:.13g}") for v in row]
        for q, u, row in zip(QUANTITIES, units, found[1].T, strict=True)
    }
    errors = np.nanmax(np.abs(found[1] - found[0]), axis=0)
    shown = {q: v for q, v in given.items() if q != "steps"}
    return {"name": name, **shown, **values, "errors": [float(f"{e:.1e}") for e in errors]}


if __name__ == "__main__":
    TABLE.write_text(
        "[\n" + ",\n".join(json.dumps(entry(*item)) for item in SCENES.items()) + "\n]\n"
    )
