"""The rungs of steady sliding: asymptote, exact, quadrature."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from kvtheory.ladder.climbing import Answer, Judgement, Request, Rung
from kvtheory.models.steady import asymptote_bounds as asy
from kvtheory.results import Certificate, SteadyState
from kvtheory.scene.capabilities import (
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
"""No certificate of theirs is below these: nothing is run where less is asked."""

PROVED = (
    "bounds from the closed forms of the asymptotes' errors (derivations error-L1, error-L2-fixed, "
    "error-L2-dead-weight and others, of a ball F20-error-L1, F20-error-L2 and others) and from bounds of "
    "the steady half length, relative to the truth"
)


def rungs(steady: Steady) -> tuple[Rung, ...]:
    """Return the rungs in order of cost; `steady` runs the last two."""

    def by(method: str) -> Callable[[Scene, Request, Any], Answer]:
        def solve(scene: Scene, request: Request, _: Any) -> Answer:
            return _picked(steady(scene, method=method), request)

        return solve

    return (
        Rung("asymptote", "steady sliding of a parabola or ball, V far from V*", _far, _asymptote),
        Rung(
            "exact", "steady sliding of a parabola, power law, wedge or ball", _closed, by("exact")
        ),
        Rung("quadrature", "steady sliding of any shape", _any_shape, by("quadrature")),
    )


def _closed(scene: Scene, request: Request) -> Judgement:
    known = "exact, power law" if lacks_quadratic(scene) else "exact"
    known = "exact, any foundation" if lacks_kelvin_voigt(scene) else known
    return Judgement(lacks_closed_form(scene), BEST[known])


def _any_shape(scene: Scene, request: Request) -> Judgement:
    on_any = lacks_kelvin_voigt(scene)
    return Judgement(lacks_quadrature(scene), BEST["convolution" if on_any else "quadrature"])


def _far(scene: Scene, request: Request) -> Judgement:
    if lacking := lacks_quadratic(scene) or lacks_kelvin_voigt(scene):
        return Judgement(lacking)
    choice = asy.choose(asy.enclosure_of(scene), request.quantities, request.rtol)
    return Judgement(error=choice.error, known=choice)


def _asymptote(scene: Scene, request: Request, choice: asy.Choice) -> Answer:
    errors = dict.fromkeys(request.quantities, choice.error)
    values = asy.values(scene, choice.regime, request.quantities)
    return Answer(values, Certificate("proved", PROVED, errors))


def _picked(state: SteadyState, request: Request) -> Answer:
    own = state.certificate
    errors = {name: own.relative_error[name] for name in request.quantities}
    values = {name: getattr(state, name) for name in request.quantities}
    return Answer(values, replace(own, relative_error=errors), state)
