"""A spring so stiff that the drive may count as rigid: what that neglects, to first order in 1/k_x.

In scaled form (fact F22) the spring lets the indenter follow the friction f of the rigid drive by
x = f/κ_x, at the velocity f'/κ_x. Where f jumps, the indenter rings about that, at a velocity w =
Δf/sqrt(κ_x ε_x). That decays at least as with a damper L^3/4 beside c_x, L the length of the contact: so
much its dampers resist a motion along x, however the depth follows (derivations F22-dampers, F22-ringing).
With ξ_m the middle of the contact, all else feels w through the sliding velocity λ - w:

    ∂f_x/∂λ = r^3 + a^3,   ∂f_z/∂λ = -(3/2) L ξ_m,   ∂p/∂λ = -2 ξ,   δd' = 2 ξ_m w.

So the depth, which feels the mean of w, is wrong by O(1/k_x), and while it rings all else by
O(1/sqrt(k_x)). To second order a ringing w sinks the indenter, by w^2 r/(2 L) at most in unit time.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

SAFETY = 2.0
"""Of the estimate."""
FASTER = 3.0
"""Rate, in 1/tau, at which the depth recovers at most: A/B of fact F12, near 2 or less where it counts."""
TINY = 1e-300
SMALL = 0.3
"""Of the sliding velocity: where w is more, or where it flies, an estimate of first order is meaningless."""
STATEMENT = (
    f"of the rigid drive, beside the error of its solution: {SAFETY:g} times what the stiff spring changes "
    "to first order"
)


def ringing(at_rest: StaticState, first: float) -> float:
    """Return about the least error, by its scales, that a start from rest has at a scaled time."""
    number, inertia = abs(at_rest.drive_number), at_rest.drive_inertia_number
    resistance = at_rest.drive_damping_number + 2.0  # L^3/4 of the contact at rest
    swing = math.sqrt(inertia * at_rest.drive_stiffness_number) + resistance
    return number / swing * math.exp(-0.5 * resistance / inertia * first)


def neglected(series: dict[str, Array], at_rest: StaticState) -> dict[str, Array]:
    """Return the errors of a series on a rigid drive over its times, by their scales."""
    s, number = series["time"] / at_rest.time, series["velocity"] / at_rest.velocity
    force = series["friction_force"] / at_rest.friction_force
    edges = np.array([series["leading_edge"], series["trailing_edge"]]) / at_rest.half_length
    left, right = np.sort(edges, axis=0)
    length, tilt = right - left, np.abs(right + left)
    inertia, stiffness = at_rest.drive_inertia_number, at_rest.drive_stiffness_number
    steps, jumps = np.diff(s, prepend=s[0]), np.abs(np.diff(force, prepend=0.0))
    slope = np.divide(jumps, steps, out=np.zeros_like(s), where=steps > 0.0)
    kinks = np.abs(np.diff(slope, prepend=0.0)) / stiffness
    kinks[0] = math.inf  # there it jumps
    wave, sunk, found = 0.0, 0.0, []
    for k, step in enumerate(steps.tolist()):
        resistance = at_rest.drive_damping_number + 0.25 * float(length[k]) ** 3
        stiff = 4.0 * inertia * stiffness
        bend = math.sqrt(max(resistance * resistance - stiff, 0.0))
        fall = 2.0 * stiffness / (resistance + bend) if bend else 0.5 * resistance / inertia
        swing = max(0.5 * math.sqrt(stiff), resistance)
        wave = wave * math.exp(-fall * step) + min(float(jumps[k]) / swing, float(kinks[k]))
        sunk = sunk * math.exp(-step) + float(tilt[k] * jumps[k]) / stiffness
        sunk += 0.5 * step * wave * wave
        found.append((wave, wave * swing, sunk + float(tilt[k]) * wave * swing / stiffness))
    wave, ring, depth = np.array(found).T  # w, ε_x x'' and the error of the depth
    speed, place = wave + slope / stiffness, (ring + np.abs(force)) / stiffness
    rate = tilt * speed + FASTER * depth
    far, near = np.maximum(-left, right), np.minimum(-left, right) + np.abs(number)
    edge = speed + place + 0.5 * (depth + rate) / np.maximum(near, TINY)
    errors = {
        "depth": depth,
        "depth_rate": rate,
        "normal_force": 0.75 * length * (depth + rate + tilt * speed),
        "friction_force": (right**3 - left**3) * speed + 0.75 * length * tilt * (depth + rate),
        "leading_edge": edge,
        "trailing_edge": edge,
        "peak_pressure": 2.0 * far * speed + depth + rate + 2.0 * np.abs(number) * edge,
        "sliding_velocity": speed,
    }
    errors["spring_force"] = errors["friction_force"] + ring  # f_s = f - ε_x x''
    least = 0.0 if np.all(speed <= SMALL * np.abs(number)) else math.inf
    return {name: SAFETY * error + least for name, error in errors.items()}
