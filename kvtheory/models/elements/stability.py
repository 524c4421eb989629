"""Stability of time steps: predicted before a run, and monitored during it.

Near any state, with a contact of length L that does not change within the step, the depth obeys
M σ^2 + C L σ + K L + k_s = 0 (F12 with the contact held). A step is stable if |R(σ h)| <= 1 for both
rates σ; for the fast rate, about -C L/M, this is fact F15, h C L/M <= 2.785 or 2.
"""

import math
from typing import Any

import numpy as np

from kvtheory.models.elements import kernels
from kvtheory.models.elements.kernels import Constants, Limits
from kvtheory.models.elements.model import Model, contact, sunk_depth
from kvtheory.models.elements.schemes import DEFAULT, Scheme
from kvtheory.results.errors import DivergenceError
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.theory.laws import Array

LONGEST_PASS = 0.25
"""Of the static half length, for the elements in a step; with more, some are pressed within a step."""
ADVISED = 0.9
"""Advised step, as a share of the stability limit."""
RISE = 5.0
"""An indenter that leaves so many times faster than the foundation can throw it has diverged."""
IMBALANCE = 0.05
"""Upper bound on the mean imbalance in a stable run, as a share of the forces, besides single elements."""
GROWS = 1e-10
"""Growth of a step above rounding, beyond which it is unstable."""
SHORTEST = 1e-6
"""Shortest step in the search for a stable one, times the fastest rate."""
LIMIT_RTOL = 1e-9
"""Relative tolerance of this search."""
ELEMENTS = 4.0
"""Elements, of all in contact at rest, whose entering and leaving may upset the balance in a stable run."""


def lengths(model: Model, path: BaseMotion) -> tuple[float, float]:
    """Return contact lengths (of a ball areas) that bound the step: in steady sliding, and at static depth.

    A step that is too long at the static depth only is unstable at first and may recover.
    """
    velocities = [0.0, *path.velocities] if model.sprung else path.velocities
    chosen = {min((V for V in velocities if V >= 0.0), default=velocities[-1]),
              max((V for V in velocities if V <= 0.0), default=velocities[0])}  # fmt: skip
    c = model.constants._replace(spacing=0.0, across=0.0, parts=False)
    held = math.isinf(c.mass)
    depths = {V: c.depth if held else min(sunk_depth(c, V), c.depth) for V in chosen}
    steady = max(contact(c, depth, V).extent for V, depth in depths.items())
    deepest = model.impact(path)[1]
    return steady, max(contact(c, deepest, V).extent for V in chosen)


def limit_at(scheme: Scheme, c: Constants, length: float) -> float:
    """Return the largest stable step for a contact of this length, in s: where |R| first exceeds 1.

    Along x a contact of the length ∫ h'^2 dx holds the indenter, with k_x and c_x. The rates of both together
    are at most the sum of those of each (Weyl).
    """
    if not scheme.tableau:
        return math.inf
    inverse, axes = 0.0, [(c, length)]
    if math.isfinite(c.mass_along):
        at_rest = contact(c, c.depth)
        tilt = length * at_rest.tilt / at_rest.extent  # as steep as the contact at rest
        law = c.law._replace(damping=c.law.damping + c.damping_along / tilt)
        axes.append((c._replace(mass=c.mass_along, spring=c.spring_along, law=law), tilt))
    for one, L in axes:
        if math.isfinite(one.mass):
            stiff = (one.law.stiffness_within(0.0) * L + one.spring) / one.mass
            fastest = one.law.damping * L / one.mass + math.sqrt(stiff)

            def growth(
                h: float, one: Constants = one, L: float = L, fastest: float = fastest
            ) -> float:
                if h * fastest <= SHORTEST:
                    return -1.0
                rates = np.linalg.eigvals(amplification(scheme, one, L, h))
                return float(abs(rates).max()) - 1.0 - GROWS

            inverse += 1.0 / kernels.bisect(growth, 1.0 / fastest, LIMIT_RTOL)
    return 1.0 / inverse if inverse else math.inf


def amplification(scheme: Scheme, c: Constants, length: float, h: float) -> Array:
    """Return the matrix of one explicit step of (δ, δ', s_1, s_2, ...), the contact held.

    For Kelvin-Voigt its eigenvalues are R(σ h), R(z) = 1 + z + z^2/2 + ... of the tableau (F15).
    """
    start, rates = np.eye(2 + c.law.arm_stiffness.size), list[Array]()
    for share, *a in scheme.table:
        moved = (x * rate for x, rate in zip(a, rates, strict=False))
        at = start[:2] + h * sum(moved, 0.0 * start[:2])
        step = c.law.step(share * h)
        arms = step.held[:, None] * start[2:] + step.ramp[:, None] * (at[0] - start[0])
        force = length * (c.law.pressure(*at) + arms.sum(axis=0)) + c.spring * at[0]
        rates.append(np.array([at[1], -force / c.mass]))
    return np.vstack([at, arms])


def step_warning(scheme: Scheme, model: Model, path: BaseMotion, h: float) -> str:
    """Return a warning about a time step before the run begins, or an empty text."""
    if scheme.tableau and h > limit_at(scheme, model.constants, max(lengths(model, path))):
        return f"the run may diverge: {describe(scheme, model, path, h)}"
    passed = h * model.fastest(path) / model.at_rest.half_length
    if passed > LONGEST_PASS:
        return (
            f"the time step, {h * 1e3:.4g} ms, is long: elements pass {passed:.2g} half lengths of the "
            f"contact in it; {LONGEST_PASS * h / passed * 1e3:.3g} ms would do"
        )
    return ""


def describe(scheme: Scheme, model: Model, path: BaseMotion, h: float) -> str:
    """Compare a step with the largest stable one, and suggest one that would do."""
    c, length = model.constants, max(lengths(model, path))
    limit = limit_at(scheme, c, length)
    if math.isinf(limit):
        return f"its time step is {h * 1e3:.4g} ms"
    number = h * c.law.damping * length / c.mass
    has = f"has the stability number dt C L/M = {number:.3g}" if number else "is too long"
    of = f"{length * 1e6:.4g} mm^2" if c.surface.ball else f"{length * 1e3:.4g} mm"
    return (
        f"its time step, {h * 1e3:.4g} ms, {has} for a contact of L = {of}, where the scheme "
        f'"{scheme.row.name}" is stable up to dt = {limit * 1e3:.4g} ms; a time step of '
        f'{ADVISED * limit * 1e3:.3g} ms would do, or the scheme "{DEFAULT}", which is stable at any step'
    )


def limits(model: Model, path: BaseMotion) -> Limits:
    """Return the rates and the imbalance that no stable run reaches."""
    c, fastest = model.constants, model.fastest(path)
    arms = model.contact.extent * float(c.law.arm_stiffness.sum())
    yields = c.law.stiffness / c.law.damping if c.law.damping else 1.0 / c.law.retardation_time
    rates = yields + math.sqrt(c.spring / c.mass) + math.sqrt(arms / c.mass)
    thrown = c.depth * rates + fastest * model.steepest + model.impact(path)[0]
    return Limits(
        rate=-RISE * thrown if math.isfinite(c.mass) else -math.inf,
        along_rate=RISE * (fastest + math.sqrt(model.at_rest.energy / c.mass_along)),
        imbalance=IMBALANCE + ELEMENTS * c.spacing / (2.0 * c.half_length),
    )


def divergence(
    status: int, scheme: Scheme, model: Model, path: BaseMotion, h: float, time: float, now: Any,
    deepest: float,
) -> DivergenceError:  # fmt: skip
    """Return the error about a run that was found to be unstable, or sank to `deepest` static depths.

    `now` is the `INDENTER` then.
    """
    share = now.mean_imbalance / max(now.mean_force, kernels.TINY)
    sign = {
        kernels.OUTGROWN: f"the indenter sank to {deepest:g} times its static depth",
        kernels.THROWN_UP: f"the indenter is thrown upward with {-now.rate:.3g} m/s",
        kernels.THROWN_ALONG: f"the indenter is thrown along x with {abs(now.along_rate):.3g} m/s",
        kernels.UNBALANCED: f"the forces fail to balance the motion by {share:.0%}",
    }[status]
    return DivergenceError(
        f"the run diverged at t = {time:.6g} s, where {sign}: {describe(scheme, model, path, h)}"
    )
