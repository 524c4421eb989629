"""What a method needs of a scene: one predicate and one wording for each need."""

from kvtheory.scene.indenters import Parabola, PowerLaw, Wedge
from kvtheory.scene.model import Scene

CLOSED_FORMS = (Parabola, PowerLaw, Wedge)
"""Shapes whose steady sliding is in closed form, with one scalar root at most."""


def lacks_parabola(scene: Scene) -> str:
    """Say why a method that needs a parabola does not hold for a scene; nothing if it does.

    >>> lacks_parabola(Scene())
    ''
    """
    return _lacks(scene, (Parabola,), "the parabola")


def lacks_closed_form(scene: Scene) -> str:
    """Say why a method that needs closed forms does not hold for a scene; nothing if it does.

    >>> lacks_closed_form(Scene())
    ''
    """
    return _lacks(scene, CLOSED_FORMS, "the parabola, the power law and the wedge")


def _lacks(scene: Scene, shapes: tuple[type, ...], named: str) -> str:
    if isinstance(scene.indenter, shapes):
        return ""
    return f'holds for {named} only, not for indenter.shape = "{scene.indenter.shape}"'


def require_closed_form(scene: Scene, what: str) -> None:
    """Raise `ValueError` if the shape has no closed forms; `what` needs them."""
    if lacking := lacks_closed_form(scene):
        raise ValueError(f"{what} {lacking}")


def require_parabola(scene: Scene, what: str) -> None:
    """Raise `ValueError` if the indenter is not a parabola; `what` needs it."""
    if lacking := lacks_parabola(scene):
        raise ValueError(f"{what} {lacking}; `elements`, or `solve` with `at`, follows any shape")
