"""Every cell of what works with what: it answers with a certificate, or refuses in the words of the table."""

import math
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.explorer import explorer_page
from kvtheory.scene.capabilities import CLOSED, DRIVES, LAWS, QUESTIONS, SHAPES, SUPPORTS
from kvtheory.scene.foundations import DAMPED
from tests import SCENES

FUNCTIONS = kv.Profile(lambda x: 50.0 * x * x, lambda x: 100.0 * x)
BODIES = {
    "parabola": kv.Parabola(0.01), "circle": kv.Circle(0.01), "power-law": kv.PowerLaw(0.01, 3.0),
    "wedge": kv.Wedge(0.05), "callable": FUNCTIONS, "sphere": kv.Sphere(0.01),
    "revolved": kv.Revolved(kv.Parabola(0.01)), "revolved functions": kv.Revolved(FUNCTIONS),
}  # fmt: skip
assert {body.shape for body in BODIES.values()} == SHAPES.keys()
FOUNDATIONS = {
    "kelvin-voigt": kv.Foundation(1e10, 0.01),
    "generalized-maxwell": kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)]),
    DAMPED: kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)], damping=1e8),
    "fractional-kelvin-voigt": kv.FractionalKelvinVoigt(1e10, 0.01, 0.5),
}
SCALE = {True: 1.0, False: 1e-3}
"""A ball of the same radius carries about a thousandth of what a line contact carries per metre."""
AT = [0.0, 2e-4]
COARSE = {"per_length": "10 /mm", "certify": False}


def asked(question, shape, law, support, drive):
    """Whether the gate asks for the answer in a cell; `KVTHEORY_TEST_SCENES=1000` asks for every one."""
    if SCENES >= 1000:
        return True
    if question in ("compare", "sweep over time"):
        return False  # other tests hold the answers, which take long
    if question == "stability":
        return shape != "sphere" or (law, support) == ("kelvin-voigt", "dead-weight")
    if question == "maxima" and shape not in CLOSED:
        return (shape, law, support, drive) == ("circle", "kelvin-voigt", "fixed", "rigid")
    if question in ("quadrature", "maxima", "sweep"):
        plain = not shape.startswith("revolved") or law == LAWS[0]  # others take seconds
        return (support, drive) == ("fixed", "rigid") and plain
    if question == "layer":
        return shape in ("parabola", "revolved") and (support, drive) == ("fixed", "rigid")
    if question in ("elements", "explorer"):
        return (support, drive) == ("dead-weight", "spring")
    return True


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


def steady(each, method):
    found = kv.steady(each, method=method)
    return np.isfinite(found.friction_force) and certified(found)


def on_body(each):
    """The same on the body of the law, a layer; a law without one is refused as it is."""
    if not QUESTIONS["layer"].needs(each):
        layer = {"modulus": 1e6, "thickness": 1e-3, "poisson_ratio": 0.45}
        law = {"arms": [(4e6, 0.02)]} if each.foundation.arms else {"retardation_time": 0.01}
        own = type(each.foundation)(**layer, **law, stiffness_from="thin")
        each = replace(each, foundation=own, support=kv.Fixed(1e-4))
    return steady(each, method="layer")


def swept(each, **over_time):
    names = ["friction_force"]
    found = kv.sweep(each, over={"drive.velocity": [0.1, 0.11]}, quantities=names, **over_time)
    return found.failed == 0 and np.all(np.isfinite(found["friction_force"]))


def transient(each):
    found = kv.transient(each, at=AT)
    return np.all(np.isfinite(found.friction_force)) and certified(found)


def compared(each):
    if QUESTIONS["compare"].needs(each):
        return kv.compare(each, data={"time": [0.0, 1e-4], "depth": [1e-4, 1e-4]})
    motion = kv.elements(each, at=np.linspace(0.0, 3e-4, 20), **COARSE)
    names = ("time", "depth", "normal_force", "friction_force")
    report = kv.compare(each, data={name: getattr(motion, name) for name in names})
    return report.verdict in ("agrees", "disagrees", "cannot tell") and len(report.checks) > 0


ASK = {
    "exact": partial(steady, method="exact"),
    "quadrature": partial(steady, method="quadrature"),
    "asymptote": partial(steady, method="asymptote"),
    "layer": on_body,
    "maxima": lambda each: np.all(np.isfinite(np.array(kv.asymptotes(each).maxima))),
    "stability": lambda each: np.all(np.isfinite(kv.stability(each, quantity="rates").rates)),
    "transient": transient,
    "elements": lambda each: np.all(np.isfinite(kv.elements(each, at=AT, **COARSE).friction_force)),
    "compare": compared,
    "sweep": swept,
    "sweep over time": partial(swept, at=AT),
    "footprint": lambda each: np.isfinite(kv.footprint(each).half_width),
    "drop": lambda each: np.isfinite(kv.restitution(each, speed=0.1).contact_time),
    "explorer": lambda each: explorer_page(each).startswith("<!DOCTYPE html>"),
}


@pytest.mark.parametrize("question", ASK)
def test_what_the_table_allows_answers_and_what_it_refuses_says_so(question):
    wrong = []
    needs = QUESTIONS[question].needs
    for cell in product(BODIES, LAWS, SUPPORTS, DRIVES):
        given = scene(*cell)
        lacking = needs(given)
        assert bool(lacking) is (cell[1] not in needs.laws(given.indenter.shape, *cell[2:]))
        if not (lacking or asked(question, *cell)):
            continue
        try:
            answered = bool(ASK[question](given))
        except ValueError as error:
            answered = str(error)
        told = "holds for" if question in ("compare", "sweep over time") else lacking
        right = isinstance(answered, str) and told in answered if lacking else answered is True
        if not right:
            wrong.append((cell, lacking, answered))
    assert not wrong, wrong[:4]
