"""A series and its theory, as all checks use them, and the effects of elements and time steps (F15)."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.allowances import (
    EDGES,
    MARGIN,
    UNKNOWN_STEP,
    Band,
    Resolution,
    allowance,
    beside_jumps,
    contact_extent,
    edge_jumps,
    resolution,
)
from kvtheory.checks.noise import SURE, gaps, means, noise
from kvtheory.checks.theory import CURVES, Array, Curves, Theory
from kvtheory.fitting.series import Series
from kvtheory.results.comparison import Check, Explanation
from kvtheory.results.table import SCHEME_ROWS

THEORY_RTOL = 1e-7
"""Tolerance of the theory: its error is far below every allowance."""
SMALLEST = 1e-9
"""Relative difference that is always allowed."""
LARGEST_SAWTOOTH, COARSEST = 0.025, 0.1
"""Force of half an element at an edge, over the load: beyond the first the contact is not resolved; beyond
the second the data are wrong rather than coarse."""
IN_STEP = 1.75
"""Margin on the spacing read from a sawtooth nearly in step with samples."""
MEDIAN_GAP, LARGE_GAP, QUANTILE = 0.43, 1.08, 0.95
"""Median and 95th percentile of the gaps of a sawtooth +-b sampled at random, in units of b."""
EVEN = 0.6
"""Part of the expected ratio of both below which some samples are in step with the elements."""
FINEST = 0.1
"""Part of the assumed spacing below which a sawtooth is due to samples in step, or to rounding."""
OTHER = 4.0
"""Smooth error of the normal force, in b, beyond which elements, at most 2 b, are the smaller part of it."""
ROUNDED = 1.64
"""Gap due to rounding, by `gaps`, in units of half the last digit."""
COMMON, CERTAIN = 0.5, 0.9
"""Squared correlation of the noise of both forces from which it is the sawtooth of F15; and in few rows,
which may have the first one by chance."""
QUIET = 0.1
"""Noise of an edge over its jumps below which these are elements: between them an edge moves smoothly."""
LOUD = 4.0
"""Multiple of the median to which larger differences, which are jumps, are clipped."""
FEW_ROWS, LONGER = 32, 8.0
"""Rows that do not show the elements of a simulation, and with them its steps; and how much longer than
assumed these may be where neither user nor rows tell: none do of a ball, as its strips gain elements one by
one, nor without a damper, as elements then enter without a force."""
COARSER = 2.0
"""And how much farther apart than assumed elements may be that rows cannot show."""
SAWTOOTH = "the sawtooth"
"""What the spacing is estimated from, if not from the edges."""
NOISE, COARSE, NUMBER = "discretization noise", "elements enough", "stability number"
UNKNOWN = "known time step"
"""The names of the checks."""
NEGLIGIBLE, LARGEST_UNCORRELATED = 1e-9, 0.09
"""Noise over the load that is negligible; and the largest allowed that is not of elements."""
LIKELY, READ = 0.8, 0.75
"""Ranks of faults that show but cannot be tried: an unknown time step, and an estimated spacing."""
LARGE, MANY = 10.0, 30.0
"""Multiples of the scale and of the initial difference beyond which a difference has grown."""
LOST, NEAR, SEVERAL = 0.75, 0.12, 2
"""Part of a force below which contact counts as lost, if nine in ten other rows are as near to theory as the
second; and the fewest losses that are told."""
UNSTABLE, FEW, DROPS = "unstable time step", "too few elements", "contact lost for single steps"
"""The names of the faults."""


class NotMade(Exception):  # noqa: N818
    """A check cannot be made; the text gives the reason."""


@dataclass(frozen=True)
class Case:
    """A series, theory at its times (`now`), and the differences allowed.

    `names` are the curves to compare; `edge_force` is the force b of half an element at an edge, in N/m.
    """

    theory: Theory
    series: Series
    names: tuple[str, ...]
    resolution: Resolution
    now: Curves
    bands: dict[str, Band]
    edge_force: Array
    tolerance: float

    @property
    def time(self) -> Array:
        """The times in s."""
        return self.series.time

    @property
    def columns(self) -> Curves:
        """The data, in SI."""
        return self.series.columns

    def residual(self, name: str) -> Array:
        """Return data less theory, relative to the scale of the curve."""
        return (self.columns[name] - self.now[name]) / self.theory.scales[name]

    def excess(self, name: str, rows: int = 1) -> Array:
        """Return how far the data, or means of so many rows, lie outside the band, relative to the scale."""
        values = self.bands[name].averaged(rows).excess(means(self.columns[name], rows))
        return np.asarray(np.nan_to_num(values) / self.theory.scales[name])

    def limit(self, name: str, rows: int = 1) -> Array:
        """Return how far a single value, or mean, may lie outside the band, relative to the scale."""
        values = np.nan_to_num(self.bands[name].averaged(rows).limit(), nan=0.0)
        return np.asarray(self.tolerance * (values / self.theory.scales[name] + SMALLEST))

    def allowed(self, name: str) -> Array:
        """Return the limit in the unit of the curve."""
        return np.asarray(self.limit(name) * self.theory.scales[name])

    def beyond(self, name: str, rows: int) -> Callable[[Array], float]:
        """Return the root mean square beyond the smooth error too, which leaves noise, of such means."""
        band, scale = self.bands[name].averaged(rows), self.theory.scales[name]
        smooth = self.tolerance * np.nan_to_num(band.systematic / scale)
        return lambda values: rms(
            np.maximum(np.nan_to_num(band.excess(values)) / scale - smooth, 0.0)
        )

    def rms_limit(self, name: str, rows: int = 1) -> float:
        """Return the largest value of `beyond` that is due to noise."""
        random = rms(self.bands[name].noise) / math.sqrt(rows) / self.theory.scales[name]
        few = SURE * math.sqrt(2.0 * rows / self.time.size)
        return self.tolerance * (random * (1.0 + few) + SMALLEST)


def make_case(
    theory: Theory, series: Series, per_length: float | None, tolerance: float, coarsest: float
) -> Case:
    """Compare a series with theory; an unknown spacing is estimated, up to b = `coarsest` times the load."""
    names = tuple(name for name in CURVES if name in series.columns)

    def of(fine: Resolution) -> Case:
        budget = allowance(theory, series, fine, THEORY_RTOL)
        return Case(theory, series, names, fine, *budget, tolerance)

    fine = resolution(theory, series, per_length)
    case = of(fine)
    if fine.spacing_known:
        return case
    largest = coarsest * theory.static.load / float(np.median(case.edge_force))
    seen = _coarser(case) if (common_noise(case) or 0.0) >= COMMON else MARGIN
    calm = ~beside_jumps(theory, series.time, fine.time_step)
    edges = [
        (edge_jumps((case.columns[n] - case.now[n])[calm]) - 2.0 * float(case.bands[n].rounding.max()),
         rms(case.bands[n].noise)) for n in EDGES if n in names
    ]  # fmt: skip
    (jump, loud), read = max(edges, default=(0.0, 0.0)), SAWTOOTH if seen != MARGIN else ""
    if jump > seen * fine.spacing:
        seen, read = jump / fine.spacing, "the edges" if loud < QUIET * jump else ""
    wider = min(seen, max(largest, MARGIN))
    return of(fine._replace(spacing=wider * fine.spacing, spacing_read=read))


def with_longer_steps(case: Case) -> Case | None:
    """Return the case of a simulation with longer steps, if the data may be of such a one."""
    fine = case.resolution
    scene = case.theory.scene
    hidden = not scene.indenter.per_width or not scene.foundation.damping
    shown = bool(fine.spacing_read) or case.time.size > FEW_ROWS
    if fine.spacing_known or fine.step_known or (shown and not hidden):
        return None
    longer, rates = LONGER * fine.time_step, case.theory.rates
    if rates is not None and rates.oscillation:  # which a sound method resolves
        longer = min(longer, max(fine.time_step, UNKNOWN_STEP * abs(rates.oscillation)))
    coarse = fine._replace(time_step=longer, spacing=(COARSER if hidden else 1.0) * fine.spacing)
    budget = allowance(case.theory, case.series, coarse, THEORY_RTOL)
    return Case(case.theory, case.series, case.names, coarse, *budget, case.tolerance)


def _coarser(case: Case) -> float:
    """Return the spacing over the assumed one by the sawtooth +-b of the normal force (F15)."""
    force = "normal_force"
    band, b = case.bands[force], case.edge_force
    other = band.systematic - band.rounding > OTHER * b  # than elements is what these may show
    other |= beside_jumps(case.theory, case.time, case.resolution.time_step)
    off = np.where(other, np.nan, case.columns[force] - case.now[force])
    gap, rows = gaps(case.time, off)
    b, digits = b[rows], band.rounding[rows]
    if not (b > 0.0).any():
        return MARGIN
    gap = np.maximum(gap - ROUNDED * digits, 0.0)
    median, large = np.quantile(gap[b > 0.0] / b[b > 0.0], [0.5, QUANTILE])
    median, large = float(median) / MEDIAN_GAP, float(large) / LARGE_GAP
    shown = float(np.median(digits)) <= FINEST * float(np.median(b))
    even = shown and FINEST <= EVEN * large <= median
    return MARGIN * max(median, large) if even else max(IN_STEP * large, MARGIN)


def common_noise(case: Case) -> float | None:
    """Return the squared correlation of the noise of both forces, which an entering element changes alike."""
    if not {"normal_force", "friction_force"} <= set(case.columns):
        return None
    parts = []
    for name in ("normal_force", "friction_force"):
        rough = np.diff(case.residual(name), 2)
        loud = LOUD * float(np.median(np.abs(rough)))
        parts.append(np.clip(rough, -loud, loud))
    norms = [float(np.linalg.norm(part)) for part in parts]
    if min(norms) == 0.0:
        return None
    return float((parts[0] @ parts[1]) / (norms[0] * norms[1])) ** 2


def alike(case: Case) -> bool:
    """Whether the noise of both forces is that of elements, and of few rows not so by chance."""
    least = COMMON if case.time.size > FEW_ROWS else CERTAIN
    return (common_noise(case) or 0.0) >= least


def rms(values: Array) -> float:
    """Return the root mean square of the finite values."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known * known))) if known.size else 0.0


def sawtooth(case: Case) -> tuple[float, float, str]:
    """Compare the noise of the normal force with that of entering elements."""
    W, fine = case.theory.static.load, case.resolution
    sigma, density = float(np.median(case.bands["normal_force"].noise)) / W, 1e-3 / fine.spacing
    of_elements = alike(case)
    kind = f"{'common to both forces, as' if of_elements else 'not seen to be'} that of elements"
    if not fine.spacing_known:
        limit = COARSEST if of_elements else LARGEST_UNCORRELATED
        how = f"estimated from {fine.spacing_read}" if fine.spacing_read else "assumed"
        return sigma, case.tolerance * limit, f"{kind}; {density:.3g} elements per mm, {how}"
    allowed = 2.0 * float(case.edge_force.max()) / W + NEGLIGIBLE
    if common_noise(case) is not None and not of_elements:  # as of a sensor, on top of them
        allowed = max(allowed, LARGEST_UNCORRELATED)
    rates = case.theory.rates
    if rates and rates.oscillation:  # second differences of a smooth error that sways with it
        turn = float(np.median(np.diff(case.time))) / abs(rates.oscillation)
        sway = float(np.median(case.bands["normal_force"].systematic)) / W
        allowed += min(turn * turn, 1.0) / math.sqrt(12.0) * sway
    allowed *= case.tolerance
    b = float(np.median(case.edge_force)) / W
    return sigma, allowed, f"{kind}; N = {density:.4g} /mm, sawtooth +-{b:.2g} of the load"


def elements(case: Case) -> tuple[float, float, str]:
    """Compare one element at the leading edge with the load."""
    fine, load = case.resolution, case.theory.static.load
    if case.theory.scene.held:  # sliding presses it, at a given depth, harder than rest does
        load = max(load, float(np.median(case.now["normal_force"])))
    b = float(np.median(case.edge_force)) / load
    chance = fine.spacing_read == SAWTOOTH and not alike(case)
    unread = not fine.spacing_read or chance or "normal_force" not in case.names
    if not fine.spacing_known and unread:
        raise NotMade("the element density is not given (per_length), nor shown by the forces")
    if not case.theory.scene.indenter.per_width:
        bound = f"{b:.2g} of the load, if all strips gain an element at once"
        raise NotMade(f"for a ball only an upper bound is known: {bound}")
    limit = case.tolerance * LARGEST_SAWTOOTH
    if fine.spacing_known:
        return b, limit, ""
    if fine.spacing_read == SAWTOOTH:
        b /= IN_STEP
    else:  # edges may jump by noise too: what counts is the smooth part of the difference
        force = "normal_force"
        off = rms(case.excess(force)) * case.theory.scales[force]
        random = rms(case.bands[force].noise)
        b = math.sqrt(max(off * off - random * random, 0.0)) / load
    return b, limit, f"about {_density(case):.2g} /mm, estimated from {fine.spacing_read}"


def _density(case: Case) -> float:
    """Return the elements per mm, as known or estimated."""
    fine = case.resolution
    return 1e-3 * (IN_STEP if fine.spacing_read == SAWTOOTH else 1.0) / fine.spacing


def _at_least(density: float) -> float:
    """Return a density with two digits, rounded up."""
    digit = 10.0 ** (math.floor(math.log10(density)) - 1)
    return math.ceil(density / digit) * digit


def _stability_number(case: Case, step: float) -> float:
    """Return dt C L/M of a time step in s, with the longest contact."""
    extent = float(contact_extent(case.theory, case.now).max())
    scene = case.theory.scene
    return step * scene.foundation.slow_damping * extent / scene.support.mass


def stability(case: Case) -> tuple[float, float, str]:
    """Compare dt C L/M of an explicit scheme with its limit."""
    scene, scheme = case.theory.scene, case.series.scheme or ""
    limit = SCHEME_ROWS[scheme].stability_limit if scheme in SCHEME_ROWS else math.nan
    for reason, holds in (
        ("the indenter is fixed", scene.held),
        ("F15 holds for Kelvin-Voigt", bool(scene.foundation.arms)),
        ("the time step is not known", not case.resolution.step_known),
        (f'the scheme "{scheme}" is stable at any time step', math.isinf(limit)),
        (f'no limit is known of the scheme "{scheme}"', math.isnan(limit)),
    ):
        if holds:
            raise NotMade(reason)
    return _stability_number(case, case.resolution.time_step), limit, f"scheme {scheme}"


def symptoms(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Yield the faults that need no trial: a failed check of elements or steps, or growth."""
    known, density = case.resolution.spacing_known, _density(case)
    for check in failed:
        measured, allowed = check.measured or 0.0, check.allowed or 1.0
        if check.name == NUMBER:
            longest = case.resolution.time_step * allowed / measured
            text = f"dt C L/M = {measured:.3g}, above {allowed:.4g}; take dt below {longest * 1e3:.3g} ms"
            yield Explanation(UNSTABLE, f"the time step is unstable (F15): {text}", 1.0, True)
        elif check.name == COARSE:
            text = (
                f"too few elements (F15): one that enters at the leading edge changes the normal force by "
                f"{2.0 * measured:.2g} of the load; take {_at_least(density * measured / allowed):.4g} /mm "
                f"or more rather than {density:.3g} /mm"
            )
            yield Explanation(FEW, text, 1.0 if known else READ, True)
    if (drops := _drops(case)).size >= SEVERAL:
        text = (
            f"the contact is lost for single steps, {drops.size} times from {drops[0] * 1e3:.4g} ms on, and "
            "is back at once: elements in contact fail its test by rounding, as where x is once at the time "
            "k dt + dt and once at (k + 1) dt; test with a tolerance, or keep contact until p < 0 (Eq. 23)"
        )
        yield Explanation(DROPS, text, LIKELY, True)
    if case.theory.scene.held or case.resolution.step_known:
        return
    steps = np.diff(case.time)
    h = float(steps[steps > 0.0].min())
    number, force, loud = _stability_number(case, h), "normal_force", 0.0
    if force in case.names:  # its noise is not capped here
        loud = float(np.median(noise(case.time, case.residual(force), case.now[force])))
    rough = loud > LARGEST_SAWTOOTH and (common_noise(case) or 0.0) > COMMON
    limits = [row.stability_limit for row in SCHEME_ROWS.values() if row.stability_limit < np.inf]
    needs = f"an explicit scheme needs dt C L/M below {max(limits):.4g}"
    if number > min(limits) and rough:
        now = f"{number:.3g} with their smallest interval of {h * 1e3:.3g} ms"
        text = f"if the data hold every step: {needs}, and it is {now}"
    elif _grows(case):
        text = f"for the data grow beyond all bounds: {needs}"
    else:
        return
    yield Explanation(UNSTABLE, f"the time step is unstable (F15), {text}", LIKELY, False)


def _drops(case: Case) -> Array:
    """Return the times at which all forces fall far below theory, if other rows are near it."""
    forces = [name for name in ("normal_force", "friction_force") if name in case.names]
    with np.errstate(all="ignore"):
        part = np.array([case.columns[name] / case.now[name] for name in forces])
    lost: NDArray[np.bool_] = np.all(part < LOST, axis=0)
    others = np.abs(part[:1, ~lost] - 1.0)
    known = others[~np.isnan(others)]  # 0/0 where theory and data have no contact
    if not known.size or np.quantile(known, 0.9) > NEAR:
        return np.zeros(0)
    return case.time[1:][lost[1:] & ~lost[:-1]]


def _grows(case: Case) -> bool:
    """Whether the difference from theory becomes large: of the depth at any time, of a force at the end."""
    quarter = max(case.time.size // 4, 1)
    for name, late, early in (("depth", 0, 1), ("normal_force", -quarter, quarter)):
        if name in case.names:
            off = np.abs(case.residual(name))
            if off[late:].max() > max(LARGE, MANY * off[:early].max()):
                return True
    return False
