"""A discrete simulator of its own, with switches that plant faults.

Point elements that move with the base, as in the paper: RK4 for the indenter, Eqs. 8-25 for the
elements. It shares no code with the package beyond the description of the scene. `RULES` are ways to
decide which elements press on the indenter: one is right, the others are mistakes that people make.
"""

import math

import numpy as np

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
    "cleared": peel,
    **{"frozen": flagged, "unrelaxed": stale},
}
"""`dropped` tests elements at rest in x, so that the contact is lost while the indenter rises. `cleared`
forgets the free surface where sliding reverses. The last two leave the free surface as it is: the one with
flags, the other by u <- max(g, u)."""


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


def simulate(scene, per_length=200e3, time_step=None, rule="peel"):
    """Return a time series in SI, from t = 0 on; the step is 2 dx/V as in the paper, or as given."""
    R, K, tau = scene.indenter.radius, scene.foundation.stiffness, scene.foundation.retardation_time
    held, rigid, spring = scene.support.kind == "fixed", scene.drive.rigid, scene.drive
    W, k_s = (
        (0.0, 0.0) if held else (scene.support.weight, getattr(scene.support, "stiffness", 0.0))
    )
    depth_0 = scene.support.depth if held else (3 * W / (4 * K * math.sqrt(2 * R))) ** (2 / 3)
    velocity, dx, end = drive(scene), 1.0 / per_length, scene.run.duration
    h = time_step or 2.0 * dx / abs(scene.drive.final_velocity)
    reach = REACH * math.sqrt(2 * R * depth_0)
    room = reach if rigid else (1 + SWING) * reach
    travel = np.cumsum(velocity(np.linspace(0, end + h, 20001))) * (end + h) / 20000
    ends = -room - max(travel.max(), 0), room - min(travel.min(), 0)
    X = (np.arange(math.floor(ends[0] / dx), math.ceil(ends[1] / dx)) + 0.37) * dx
    u = np.maximum(depth_0 - X**2 / (2 * R), 0.0)
    touched = u > 0

    def contact(t, state, decay, near):
        """Return the sliding velocity, and x and the forces of the elements that press."""
        Y, depth, rate, _, along_rate = state
        sliding, x = velocity(t) - along_rate, X[near] + Y
        g = depth - x * x / (2 * R)
        p = K * (g + tau * (rate - x / R * sliding))
        on = RULES[rule](g, p, u[near], decay, touched[near])
        if rule == "dropped" and decay < 1 and rate < 0:
            on[:] = False
        return sliding, x[on], dx * p[on]

    def slope(state, sliding, x, f):
        """Return the rates of Y, depth, depth rate, and on a spring of x and x'."""
        _, depth, rate, along, along_rate = state
        lift = 0.0 if held else (W - k_s * (depth - depth_0) - f.sum()) / scene.support.mass
        drag = 0.0
        if not rigid:
            pull_back = spring.stiffness * along + spring.damping * along_rate
            drag = (-(x @ f) / R - pull_back) / scene.drive_mass
        return np.array([sliding, rate, lift, along_rate, drag])

    state, rows, forward = np.array([0.0, depth_0, 0.0, 0.0, 0.0]), [], True
    for n in range(math.ceil(end / h - 1e-9) + 1):
        t, (Y, depth, rate, along, along_rate) = n * h, state
        near = slice(*np.searchsorted(X, [-reach - Y, reach - Y]))
        sliding, x, f = contact(t, state, 1.0, near)
        turned, forward = forward, sliding > 0 if sliding else forward
        turned = turned != forward
        edges = (x[0], x[-1])[:: 1 if forward else -1] if x.size else (math.nan, math.nan)
        forces = f.sum(), -(x @ f) / R
        held_by = () if rigid else (sliding, spring.stiffness * along + spring.damping * along_rate)
        peak = f.max(initial=0.0) / dx
        rows.append((t, velocity(t), depth, rate, *forces, *edges, peak, *held_by))
        k = [slope(state, sliding, x, f)]
        for part in (0.5, 0.5, 1.0):
            between = state + part * h * k[-1]
            k.append(
                slope(between, *contact(t + part * h, between, math.exp(-part * h / tau), near))
            )
        state = state + h * (k[0] + 2 * k[1] + 2 * k[2] + k[3]) / 6
        if not abs(state[1]) < DIVERGED * depth_0:
            break
        Y, depth, rate, _, along_rate = state  # free elements relax (Eq. 25), the others follow
        x = X + Y
        g = depth - x * x / (2 * R)
        if rule == "unrelaxed":
            u = np.maximum(g, u)
        elif rule == "frozen":
            sliding = velocity(t + h) - along_rate
            p = K * (g + tau * (rate - x / R * sliding))
            touched = flagged(g, p, u, 1.0, touched)
            u = np.where(touched, g, u)
        else:
            left = 0.0 if rule == "cleared" and turned else math.exp(-h / tau)
            u = np.maximum(g, u * left)
    names = (
        *("time", "velocity", "depth", "depth_rate", "normal_force", "friction_force"),
        *("leading_edge", "trailing_edge", "peak_pressure"),
        *(() if rigid else ("sliding_velocity", "spring_force")),
    )
    return dict(zip(names, np.array(rows).T, strict=True))
