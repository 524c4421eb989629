"""Every cell of what works with what: it answers with a certificate, or refuses in the words of the table."""

import math
import os
from itertools import product

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.explorer import explorer_page
from kvtheory.scene.capabilities import CLOSED, DRIVES, LAWS, QUESTIONS, SHAPES, SUPPORTS

FUNCTIONS = kv.Profile(lambda x: 50.0 * x * x, lambda x: 100.0 * x)
BODIES = {
    "parabola": kv.Parabola(0.01), "circle": kv.Circle(0.01), "power-law": kv.PowerLaw(0.01, 3.0),
    "wedge": kv.Wedge(0.05), "callable": FUNCTIONS, "sphere": kv.Sphere(0.01),
    "revolved": kv.Revolved(kv.Parabola(0.01)), "revolved-callable": kv.Revolved(FUNCTIONS),
}  # fmt: skip
FOUNDATIONS = {
    "kelvin-voigt": kv.Foundation(1e10, 0.01),
    "generalized-maxwell": kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)]),
    "fractional-kelvin-voigt": kv.FractionalKelvinVoigt(1e10, 0.01, 0.5),
}
SCALE = {True: 1.0, False: 1e-3}
"""A ball of the same radius carries about a thousandth of what a line contact carries per metre."""
AT = [0.0, 2e-4]
COARSE = {"per_length": "10 /mm", "certify": False}


def slow(question, shape, law, support, drive):
    """Whether the gate leaves out a cell that answers; `KVTHEORY_TEST_SCENES=1000` asks for every one."""
    if question == "stability":
        return shape == "sphere" and law != "kelvin-voigt"
    if question in REFUSALS or (
        question == "maxima" and shape not in CLOSED and law != "kelvin-voigt"
    ):
        return True
    integrated = question in ("quadrature", "maxima", "sweep")
    return integrated and (
        (support, drive) != ("fixed", "rigid") or (shape == "revolved" and law in LAWS[1:])
    )


def scene(shape, law, support, drive):
    body = BODIES[shape]
    factor = SCALE[body.per_width]
    supports = {
        "fixed": kv.Fixed(1e-4),
        "dead-weight": kv.DeadWeight(mass=200.0 * factor),
        "suspended": kv.Suspended(mass=200.0 * factor, stiffness=3e7 * factor),
    }
    spring = {"stiffness": 1e9 * factor, "mass": 200.0 * factor} if drive == "spring" else {}
    return kv.Scene(
        body, FOUNDATIONS[law], supports[support], kv.Drive(0.1, **spring), kv.Run(3e-4)
    )


def certified(result):
    errors = result.certificate.relative_error.values()
    return all(np.all(np.nan_to_num(error, nan=np.inf) < math.inf) for error in errors)


def steady(method):
    def ask(each):
        found = kv.steady(each, method=method)
        return np.isfinite(found.friction_force) and certified(found)

    return ask


def maxima(each):
    return np.all(np.isfinite(np.array(kv.asymptotes(each).maxima)))


def series(result):
    return np.all(np.isfinite(result.friction_force))


def swept(each, **over_time):
    names = ["friction_force"]
    found = kv.sweep(each, over={"drive.velocity": [0.1, 0.11]}, quantities=names, **over_time)
    return found.failed == 0 and np.all(np.isfinite(found["friction_force"]))


def compared(each):
    motion = kv.elements(each, at=np.linspace(0.0, 3e-4, 20), **COARSE)
    names = ("time", "depth", "normal_force", "friction_force")
    report = kv.compare(each, data={name: getattr(motion, name) for name in names})
    return report.verdict in ("agrees", "disagrees", "cannot tell") and len(report.checks) > 0


REFUSALS = {
    "compare": lambda each: kv.compare(each, data={"time": [0.0, 1e-4], "depth": [1e-4, 1e-4]}),
    "sweep over time": lambda each: kv.sweep(each, over={"run.duration": [3e-4]}, at=AT),
}
"""Questions whose answers other tests hold, as they take long."""
ASK = {
    **REFUSALS,
    **{method: steady(method) for method in ("exact", "quadrature", "asymptote")},
    "maxima": maxima,
    "stability": lambda each: np.all(np.isfinite(kv.stability(each, quantity="rates").rates)),
    "transient": lambda each: (
        series(kv.transient(each, at=AT)) and certified(kv.transient(each, at=AT))
    ),
    "elements": lambda each: series(kv.elements(each, at=AT, **COARSE)),
    "sweep": swept,
    "footprint": lambda each: np.isfinite(kv.footprint(each).half_width),
    "explorer": lambda each: explorer_page(each).startswith("<!DOCTYPE html>"),
}
EVERY = int(os.environ.get("KVTHEORY_TEST_SCENES", "0")) >= 1000
CELLS = list(product(SHAPES, LAWS, SUPPORTS, DRIVES))


@pytest.mark.parametrize("question", ASK)
def test_what_the_table_allows_answers_and_what_it_refuses_says_so(question):
    wrong = []
    for cell in CELLS:
        given = scene(*cell)
        lacking = QUESTIONS[question].needs(given)
        if not (lacking or EVERY) and slow(question, *cell):
            continue
        assert bool(lacking) is (cell[1] not in QUESTIONS[question].needs.laws(cell[0], *cell[2:]))
        try:
            answered = bool(ASK[question](given))
        except ValueError as error:
            answered = str(error)
        told = "holds for" if question in REFUSALS else lacking
        right = isinstance(answered, str) and told in answered if lacking else answered is True
        if not right:
            wrong.append((cell, lacking, answered))
    assert not wrong, wrong[:4]
