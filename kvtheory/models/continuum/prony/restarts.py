"""Accumulators are restarted where the ground has slid far, and the moments of slow arms with them.

On an arm that is slow beside the motion, A_i grows as the square of the distance slid, and stresses are small
differences of it. F_i and M_i add up the rounding, the latter twice. So where A_i is large, it and B_i begin
again from zero, and F_i and M_i from their integrals over the contact, by Radau's rule between the ends of
steps. An element in contact keeps the stress k_i (A_i - xi B_i) of that instant, see `contact`.
"""

from kvtheory.models.continuum.edge_states import PEELING
from kvtheory.models.continuum.prony.contact import at_present, derivative, motion, present, pressed
from kvtheory.models.continuum.prony.records import NEVER, Run
from kvtheory.models.continuum.prony.segments import here

LARGE = 0.06
"""Share of the largest A_i that a step may reach, from which on it is restarted."""


def in_contact(run: Run, number: int) -> tuple[float, float]:
    """Return between which instants those elements of a segment entered that are in contact, or their X."""
    segment = run.segments[number]
    low, high = segment.a, min(segment.b, run.now.s)
    if segment.step == NEVER:
        low, high = segment.X_a, segment.X_b
    for k in range(2):
        side = run.now.sides[k]
        if side.state == PEELING and side.segment == number:
            at = here(run, k) if segment.step == NEVER else side.sigma
            low, high = (low, at) if segment.edge == k else (at, high)
    return low, high


def restart_accumulators(run: Run) -> None:
    """Restart the accumulators of slow arms from zero if they are large."""
    now, state, many = run.now, run.state, range(run.given.arms)
    most, large = 0.0, LARGE * run.given.farthest
    for i in many:
        most = max(most, abs(state.accumulated_depth[i]))
        if abs(state.accumulated_depth[i]) > large:
            state.force[i] = state.moment[i] = 0.0
    if not most > large:
        return
    at_present(run)
    for n in range(now.first, now.first + now.count):
        number = run.chain[n]
        segment = run.segments[number]
        low, high = in_contact(run, number)
        if segment.step == NEVER:
            integrate(run, NEVER, segment.edge, low, high, large)
            continue
        index = segment.step
        while low < high:
            while index + 1 < now.steps and run.steps[index + 1].start <= low:
                index += 1
            end = min(high, run.steps[index + 1].start) if index + 1 < now.steps else high
            integrate(run, index, segment.edge, low, end, large)
            low = end
    for i in many:
        if abs(state.accumulated_depth[i]) > large:
            state.accumulated_depth[i] = state.accumulated_slide[i] = 0.0
    now.restart = now.steps


def integrate(run: Run, index: int, edge: int, low: float, high: float, large: float) -> None:
    """Add the integrals over elements that entered between two instants of a step to F_i and M_i."""
    n = run.given.stages
    at = present(run)
    for j in range(n):
        x, weight = low + (high - low) * run.stages.node[j], high - low
        if index != NEVER:
            then, step = motion(run, index, x), run.steps[index]
            rate = derivative(run.polynomials.edges[index, :, edge], then.theta)
            weight *= abs(rate - step.lasts * then.number) / step.span
        _, xi = pressed(run, at, x + at.Y, edge, index, x)
        for i in range(run.given.arms):
            if abs(run.state.accumulated_depth[i]) > large:
                force = weight * run.method.A[n - 1, j] * run.element.stress[i]
                run.state.force[i] += force
                run.state.moment[i] += xi * force
