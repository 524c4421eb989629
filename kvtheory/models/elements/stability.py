"""Which time steps are stable: known before a run, and watched during it.

Near any state, with a contact of length L that does not change within the step, the depth obeys
M σ^2 + C L σ + K L + k_s = 0 (F12 with the contact held). A step is stable if |R(σ h)| <= 1 for both
rates σ; for the fast rate, about -C L/M, this is fact F15, h C L/M <= 2.785 or 2.
"""

import math
from collections import deque

import numpy as np

from kvtheory.models.elements.model import Model, span
from kvtheory.models.elements.row import ElementRow, IndenterState
from kvtheory.models.elements.schemes import DEFAULT, Scheme
from kvtheory.results.errors import DivergenceError
from kvtheory.scene.base_motion import BaseMotion

LONGEST_PASS = 0.25
"""Of the static half length, for the elements in a step; with more, some are pressed within a step."""
ADVISED = 0.9
"""Of the stability limit, for the step that is advised."""
RISE = 5.0
"""An indenter that leaves so many times faster than the foundation can throw it has diverged."""
WINDOW = 40
"""Steps over which the balance of forces is judged: a sudden change of the drive upsets only a few."""
IMBALANCE = 0.05
"""Of the forces: a mean imbalance that a stable run stays below, besides that of single elements."""

ELEMENTS = 4.0
"""Elements whose coming and going may upset the balance in a stable run, of all in contact at rest."""


def lengths(model: Model, path: BaseMotion) -> tuple[float, float]:
    """Return the contact lengths (m) that bound the step: in steady sliding, and at the static depth.

    Each is the longest over the velocities of the drive; between those the velocity is linear, and
    the length falls with |V|. A drive that passes through rest has the contact at rest among them. A
    step that is too long for the latter only, at a start, is unstable at first and may recover.
    """
    velocities = path.velocities
    if velocities[0] < 0.0 < velocities[-1]:
        velocities = [0.0, *velocities]
    # The slowest motion in each direction has the longest contact.
    chosen = {min((V for V in velocities if V >= 0.0), default=velocities[-1]),
              max((V for V in velocities if V <= 0.0), default=velocities[0])}  # fmt: skip
    held = math.isinf(model.mass)
    depths = {V: model.depth if held else min(model.sliding_depth(V), model.depth) for V in chosen}
    steady = max(model.sliding(depth, V)[0] for V, depth in depths.items())
    return steady, max(model.sliding(model.depth, V)[0] for V in chosen)


def limit_at(scheme: Scheme, model: Model, length: float) -> float:
    """Return the largest stable step for a contact of this length, in s."""
    R = scheme.stability_polynomial
    if not R or math.isinf(model.mass):
        return math.inf
    law = model.law
    rates = np.roots([model.mass, law.damping * length, law.stiffness * length + model.spring])
    return min(_reach(R, complex(rate)) for rate in rates)


def _reach(R: tuple[float, ...], rate: complex) -> float:
    """Return the first h > 0 with |R(rate h)| = 1, by the roots of a polynomial in h."""
    along = np.array([c * (rate / abs(rate)) ** k for k, c in enumerate(R)])
    square = np.polynomial.polynomial.polymul(along, along.conj()).real
    square[0] -= 1.0
    roots = np.polynomial.polynomial.polyroots(square[1:])  # without the root h = 0
    positive = roots.real[(abs(roots.imag) < 1e-9 * abs(roots)) & (roots.real > 0.0)]
    first = float(positive.min()) if positive.size else math.inf
    growing = np.polynomial.polynomial.polyval(0.5 * min(first, 1.0), square) > 0.0
    return 0.0 if growing else first / abs(rate)


def doubts(scheme: Scheme, model: Model, path: BaseMotion, h: float) -> str:
    """Return what is doubtful about a time step before the run begins, or nothing."""
    if math.isfinite(model.mass) and h > limit_at(scheme, model, max(lengths(model, path))):
        return f"the run may diverge: {stability_text(scheme, model, path, h)}"
    passed = h * path.highest_speed / model.half_length
    if passed > LONGEST_PASS:
        return (
            f"the time step, {h * 1e3:.4g} ms, is long: elements pass {passed:.2g} half lengths of the "
            f"contact in it; {LONGEST_PASS * h / passed * 1e3:.3g} ms would do"
        )
    return ""


def stability_text(scheme: Scheme, model: Model, path: BaseMotion, h: float) -> str:
    """Say how a step compares with the largest stable one, and what would do."""
    length = max(lengths(model, path))
    limit = limit_at(scheme, model, length)
    if math.isinf(limit):
        return f"its time step is {h * 1e3:.4g} ms"
    number = h * model.law.damping * length / model.mass
    return (
        f"its time step, {h * 1e3:.4g} ms, has the stability number dt C L/M = {number:.3g} for a contact "
        f'of L = {length * 1e3:.4g} mm, where the scheme "{scheme.row.name}" is stable up to '
        f"dt = {limit * 1e3:.4g} ms; a time step of {ADVISED * limit * 1e3:.3g} ms would do, or the scheme "
        f'"{DEFAULT}", which is stable at any step'
    )


class Watch:
    """Stops a run that has become unstable.

    No element pulls, p >= 0, so that an indenter in contact rises at most with g/τ - V h'; beyond that
    it has left the foundation, and only a spring can lift it faster. But an unstable step does not
    always throw it off: when the contact gives way, the oscillation may settle at some amplitude, or
    on a wrong state at rest, with forces that do not balance the motion. So the balance over each
    step, M δ'' = W - k_s (δ - δ_0) - F_z, is checked too.
    """

    def __init__(self, row: ElementRow, scheme: Scheme) -> None:
        model = row.model
        self._row, self._scheme = row, scheme
        ends = np.array(span(model.indenter, model.depth))
        thrown = (
            model.depth / model.law.retardation_time
            + row.path.highest_speed * float(abs(model.slope(ends)).max())
            + model.depth * math.sqrt(model.spring / model.mass)
        )
        self._limit = -RISE * thrown if math.isfinite(model.mass) else -math.inf
        self._allowed = IMBALANCE + ELEMENTS * model.spacing / (2.0 * model.half_length)
        self._balances: deque[tuple[float, float]] = deque(maxlen=WINDOW)

    def see(self, motion: IndenterState, h: float) -> None:
        """Judge a step.

        Raises
        ------
        DivergenceError
            If it shows that the run is unstable.
        """
        model, sign = self._row.model, ""
        if not motion.rate >= self._limit:  # NaN is not above it either
            sign = f"where the indenter is thrown upward with {-motion.rate:.3g} m/s"
        elif self._scheme.tableau:
            self._balances.append((motion.imbalance, motion.force))
            imbalance, force = map(sum, zip(*self._balances, strict=True))
            if len(self._balances) == WINDOW and imbalance > self._allowed * force:
                sign = f"where the forces fail to balance the motion by {imbalance / force:.0%}"
        if sign:
            raise DivergenceError(
                f"the run diverged at t = {motion.time:.6g} s, {sign}: "
                f"{stability_text(self._scheme, model, self._row.path, h)}"
            )
