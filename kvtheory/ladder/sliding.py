"""The rungs of steady sliding: asymptote, exact, quadrature."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from kvtheory.ladder.climbing import Answer, Offer, Request, Rung, need
from kvtheory.models.steady import asymptote_bounds
from kvtheory.results import Certificate, SteadyState
from kvtheory.scene.capabilities import (
    lacks_asymptotes,
    lacks_closed_form,
    lacks_kelvin_voigt,
    lacks_quadratic,
    lacks_quadrature,
)
from kvtheory.scene.model import Scene

Steady = Callable[..., SteadyState]
"""`kvtheory.steady`."""

BEST = {
    "exact": 1.9e-15, "exact, power law": 8.0e-15, "exact, any foundation": 5.3e-15,
    "quadrature": 1e-14, "convolution": 2e-13,
}  # fmt: skip
"""Smallest certified error of each method; none is run for a smaller tolerance."""

CLOSED = "steady sliding of a parabola, power law, wedge or ball"
PROVED = (
    "asymptotes against the closed forms at both ends of proved bounds of the steady half length, between "
    "which these are monotonic, or a product of such (derivations scaled-load, error-L1, F19-balance, "
    "F19-monotonic, F20-balance, F20-error-L1), relative to the truth"
)


def rungs(steady: Steady) -> tuple[Rung, ...]:
    """Return the rungs in order of cost; `steady` runs the last two."""
    exact, quadrature = (partial(_steady, steady, name) for name in ("exact", "quadrature"))
    return (
        Rung("asymptote", f"{CLOSED}, V far from V*", _asymptote),
        Rung("exact", CLOSED, exact),
        Rung("quadrature", "steady sliding of any shape", quadrature),
    )


def _asymptote(scene: Scene, request: Request) -> Offer:
    need(lacks_asymptotes(scene))
    bounds, names = asymptote_bounds.enclosure_of(scene), request.quantities
    regime, error = asymptote_bounds.choose(bounds, names, request.rtol)

    def run() -> Answer:
        values = asymptote_bounds.values(scene, regime, names)
        return Answer(values, Certificate("proved", PROVED, dict.fromkeys(names, error)))

    return Offer(error, run)


def _steady(steady: Steady, method: str, scene: Scene, request: Request) -> Offer:
    """Offer a method of `steady`."""
    need((lacks_closed_form if method == "exact" else lacks_quadrature)(scene))
    known = method
    if lacks_kelvin_voigt(scene):
        known = "exact, any foundation" if method == "exact" else "convolution"
    elif method == "exact" and lacks_quadratic(scene):
        known = "exact, power law"

    def run() -> Answer:
        state, names = steady(scene, method=method), request.quantities
        errors = {name: state.certificate.relative_error[name] for name in names}
        own = replace(state.certificate, relative_error=errors)
        return Answer({name: getattr(state, name) for name in names}, own, state)

    return Offer(BEST[known], run)
