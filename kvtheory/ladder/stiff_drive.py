"""A spring so stiff that the drive may count as rigid: the error of that, to first order in 1/k_x.

In scaled form (fact F22) the indenter on the spring follows the friction f of the rigid drive with the
displacement x = f/κ_x and the velocity f'/κ_x. Where f jumps, the indenter rings about that, at a velocity
w = Δf/sqrt(κ_x ε_x). This decays at least as fast as with a damper L^3/4 in addition to c_x, L being the
contact length: its dampers resist a motion along x at least so much (derivations F22-dampers, F22-ringing).
With ξ_m the middle of the contact, all else depends on w through the sliding velocity λ - w:

    ∂f_x/∂λ = r^3 + a^3,   ∂f_z/∂λ = -(3/2) L ξ_m,   ∂p/∂λ = -2 ξ,   δd' = 2 ξ_m w.

So the depth, which responds to the mean of w, has an error of O(1/k_x), and all else of O(1/sqrt(k_x)) while
it rings. To second order a ringing w lowers the indenter, by at most w^2 r/(2 L) in unit time.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

SAFETY = 2.0
"""Safety factor of the estimate."""
FASTER = 3.0
"""Upper bound (1/tau) on how fast the depth recovers: A/B of fact F12, near 2 or less where it counts."""
TINY = 1e-300
SMALL = 0.3
"""Largest w over the sliding velocity: above it, and in flight, a first-order estimate is meaningless."""
STATEMENT = (
    f"plus the error of the rigid drive: {SAFETY:g} times the change due to the stiff spring, "
    "to first order"
)


def ringing(at_rest: StaticState, first: float) -> float:
    """Estimate the least scaled error of a start from rest at a scaled time."""
    number, inertia = abs(at_rest.drive_number), at_rest.drive_inertia_number
    resistance = at_rest.drive_damping_number + 2.0  # L^3/4 of the contact at rest
    swing = math.sqrt(inertia * at_rest.drive_stiffness_number) + resistance
    return number / swing * math.exp(-0.5 * resistance / inertia * first)


def neglected(series: dict[str, Array], at_rest: StaticState) -> dict[str, Array]:
    """Return the scaled errors of a series on a rigid drive at each of its times."""
    s, number = series["time"] / at_rest.time, series["velocity"] / at_rest.velocity
    force = series["friction_force"] / at_rest.friction_force
    edges = np.array([series["leading_edge"], series["trailing_edge"]]) / at_rest.half_length
    left, right = np.sort(edges, axis=0)
    length, tilt = right - left, np.abs(right + left)
    inertia, stiffness = at_rest.drive_inertia_number, at_rest.drive_stiffness_number
    steps, jumps = np.diff(s, prepend=s[0]), np.abs(np.diff(force, prepend=0.0))
    slope = np.divide(jumps, steps, out=np.zeros_like(s), where=steps > 0.0)
    kinks = np.abs(np.diff(slope, prepend=0.0)) / stiffness
    kinks[0] = math.inf  # the friction jumps at the start
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
