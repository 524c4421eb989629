"""A discrete simulator of its own, with switches that plant faults.

Point elements that move with the base, as in the paper: RK4 for the indenter, Eqs. 8-25 for the
elements. It shares no code with the package beyond the description of the scene. `RULES` are ways to
decide which elements press on the indenter: one is right, the others are mistakes that people make.
"""

import math

import numpy as np

from kvtheory.scene.model import Fixed, Suspended

REACH = 1.3
"""Elements within this multiple of the static half length are looked at; the indenter sinks no deeper."""
SWING = 3.0
"""Of the reach: room for a swing on the spring."""
DIVERGED = 1e3
"""Depths beyond this multiple of the static one end a run."""


def peel(g, p, u, decay, touched):
    """Eqs. 20-25: an element touches where the indenter is below it, and never pulls."""
    return (g >= u * decay * (1 - 1e-9)) & (p >= 0) & (g > 0)


def pull(g, p, u, decay, touched):
    """Tension: an element below the plane z = 0 is never let go."""
    return g > 0


def stale(g, p, u, decay, touched):
    """Contact lost while rising: the surface at the last step is taken for the present one."""
    return (g >= u) & (p >= 0) & (g > 0)


def flagged(g, p, u, decay, touched):
    """A flag for each element: contact ends where p < 0, and begins where the surface is met."""
    return np.where(touched, p >= 0, g >= u) & (g > 0)


def forgetful(g, p, u, decay, touched):
    """No memory: what the indenter left behind is taken for undisturbed ground, at z = 0."""
    return (p >= 0) & (g > 0)


RULES = {
    **{"forgetful": forgetful, "peel": peel, "pull": pull, "stale": stale, "dropped": peel},
    **{"frozen": flagged, "unrelaxed": stale},
}
"""`dropped` tests elements at rest in x, so that the whole contact is lost while the indenter rises. The last
two leave the free surface as it is: the one with flags, the other by u <- max(g, u)."""


class Simulator:
    """State and forces of the elements under one indenter."""

    def __init__(self, scene, per_length, rule, end):
        self.R = scene.indenter.radius
        self.K, self.tau = scene.foundation.stiffness, scene.foundation.retardation_time
        self.dx, self.rule = 1.0 / per_length, rule
        self.support = scene.support
        if isinstance(self.support, Fixed):
            self.depth_0 = self.support.depth
        else:
            W = self.support.weight
            self.depth_0 = (3 * W / (4 * self.K * math.sqrt(2 * self.R))) ** (2 / 3)
        self.reach = REACH * math.sqrt(2 * self.R * self.depth_0)
        self.velocity = drive(scene)
        self.drive, self.drive_mass = scene.drive, scene.drive_mass
        travel = np.cumsum(self.velocity(np.linspace(0, end, 20001))) * end / 20000
        swing = 0.0 if scene.drive.rigid else SWING * self.reach
        low = -self.reach - max(travel.max(), 0) - swing
        high = self.reach - min(travel.min(), 0) + swing
        self.X = np.arange(math.floor(low / self.dx), math.ceil(high / self.dx)) * self.dx
        self.X += 0.37 * self.dx
        self.u = np.maximum(self.depth_0 - self.X**2 / (2 * self.R), 0.0)
        self.touched = self.u > 0

    def window(self, Y):
        start = np.searchsorted(self.X, -self.reach - Y)
        return slice(start, np.searchsorted(self.X, self.reach - Y))

    def contact(self, sliding, Y, depth, rate, decay, window):
        """Return x, p and which elements press, at a sliding velocity."""
        x = self.X[window] + Y
        g = depth - x * x / (2 * self.R)
        p = self.K * (g + self.tau * (rate - x / self.R * sliding))
        return x, p, g, RULES[self.rule](g, p, self.u[window], decay, self.touched[window])

    def spring_force(self, along, along_rate):
        """Return what holds the indenter along x, dragged so far and so fast."""
        return self.drive.stiffness * along + self.drive.damping * along_rate

    def slope(self, t, state, decay, window):
        """Return the rates of Y, depth, depth rate, and on a spring of x and x'."""
        Y, depth, rate, along, along_rate = state
        sliding = self.velocity(t) - along_rate
        x, p, _, on = self.contact(sliding, Y, depth, rate, decay, window)
        if self.rule == "dropped" and decay < 1 and rate < 0:
            on = np.zeros_like(on)
        lift = drag = 0.0
        if not isinstance(self.support, Fixed):
            spring = self.support.stiffness if isinstance(self.support, Suspended) else 0.0
            pull = self.support.weight - spring * (depth - self.depth_0)
            lift = (pull - self.dx * p[on].sum()) / self.support.mass
        if not self.drive.rigid:
            friction = -self.dx * (x[on] @ p[on]) / self.R
            drag = (friction - self.spring_force(along, along_rate)) / self.drive_mass
        return np.array([sliding, rate, lift, along_rate, drag])

    def step(self, t, h, state):
        """Return the state after one step of RK4, and update the elements."""
        window, k = self.window(state[0]), [np.zeros(5)]
        for part in (0.0, 0.5, 0.5, 1.0):
            decay = math.exp(-part * h / self.tau)
            k.append(self.slope(t + part * h, state + part * h * k[-1], decay, window))
        state = state + h * (k[1] + 2 * k[2] + 2 * k[3] + k[4]) / 6
        self.settle(self.velocity(t + h) - state[4], *state[:3], math.exp(-h / self.tau))
        return state

    def settle(self, sliding, Y, depth, rate, decay):
        """Let the free elements relax (Eq. 25) and the others follow the indenter."""
        x = self.X + Y
        g = depth - x * x / (2 * self.R)
        if self.rule == "unrelaxed":
            self.u = np.maximum(g, self.u)
        elif self.rule == "frozen":
            p = self.K * (g + self.tau * (rate - x / self.R * sliding))
            self.touched = flagged(g, p, self.u, decay, self.touched)
            self.u = np.where(self.touched, g, self.u)
        else:
            self.u = np.maximum(g, self.u * decay)


def drive(scene):
    """Return V(t), just after a jump."""
    if scene.drive.history is None:
        return lambda t: scene.drive.velocity + 0.0 * t
    times, speeds = np.array(scene.drive.history).T

    def velocity(t):
        k = np.clip(np.searchsorted(times, t, side="right"), 1, times.size)
        after = np.minimum(k, times.size - 1)
        span = np.maximum(times[after] - times[k - 1], 1e-300)
        part = np.clip((t - times[k - 1]) / span, 0.0, 1.0)
        return speeds[k - 1] + (speeds[after] - speeds[k - 1]) * part

    return velocity


def simulate(scene, per_length=200e3, time_step=None, rule="peel", end=None):
    """Return a time series in SI, from t = 0 on; the step is 2 dx/V as in the paper, or as given."""
    end = scene.run.duration if end is None else end
    V = scene.drive.final_velocity
    h = time_step or 2.0 / (per_length * abs(V))
    count = math.ceil(end / h - 1e-9)
    model = Simulator(scene, per_length, rule, end + h)
    state, rows, forward = np.array([0.0, model.depth_0, 0.0, 0.0, 0.0]), [], V >= 0
    for n in range(count + 1):
        t = n * h
        Y, depth, rate, along, along_rate = state
        V_now = float(model.velocity(t))
        sliding = V_now - along_rate
        x, p, _, on = model.contact(sliding, Y, depth, rate, 1.0, model.window(Y))
        f = p[on] * model.dx
        forward = sliding > 0 if sliding else forward
        ends = x[on][[0, -1]] if on.any() else (math.nan, math.nan)
        edges = (*(ends if forward else ends[::-1]), p[on].max(initial=0.0))
        held = () if scene.drive.rigid else (sliding, model.spring_force(along, along_rate))
        rows.append((t, V_now, depth, rate, f.sum(), -(x[on] @ f) / model.R, *edges, *held))
        state = model.step(t, h, state)
        if not abs(state[1]) < DIVERGED * model.depth_0:
            break
    names = (
        *("time", "velocity", "depth", "depth_rate", "normal_force", "friction_force"),
        *("leading_edge", "trailing_edge", "peak_pressure"),
        *(() if scene.drive.rigid else ("sliding_velocity", "spring_force")),
    )
    return dict(zip(names, np.array(rows).T, strict=True))
