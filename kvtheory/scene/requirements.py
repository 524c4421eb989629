"""What a method needs of a scene: one predicate and one wording for each need."""

from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import Scene


def lacks_parabola(scene: Scene) -> str:
    """Say why a method that needs a parabola does not hold for a scene; nothing if it does.

    >>> lacks_parabola(Scene())
    ''
    """
    if isinstance(scene.indenter, Parabola):
        return ""
    return f'holds for the parabola only, not for indenter.shape = "{scene.indenter.shape}"'


def require_parabola(scene: Scene, what: str) -> None:
    """Raise `ValueError` if the indenter is not a parabola; `what` needs it."""
    if lacking := lacks_parabola(scene):
        raise ValueError(f"{what} {lacking}")
