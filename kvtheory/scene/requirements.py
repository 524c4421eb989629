"""The requirements of methods on a scene: one predicate and one wording for each."""

from collections.abc import Callable

from kvtheory.scene.foundations import Foundation, GeneralizedMaxwell
from kvtheory.scene.indenters import Parabola, PowerLaw, Sphere, Wedge
from kvtheory.scene.model import Scene

Lacking = Callable[[Scene], str]

CLOSED_FORMS = (Parabola, PowerLaw, Wedge, Sphere)
"""Shapes whose steady sliding on a Kelvin-Voigt foundation is in closed form, with one root at most."""


def lacks_parabola(scene: Scene) -> str:
    """Return why a method that needs a parabola does not apply to a scene, or an empty text.

    >>> lacks_parabola(Scene())
    ''
    """
    return lacks_shape(scene, (Parabola,), "the parabola")


def lacks_quadratic(scene: Scene) -> str:
    """Return why a method that needs a parabola or a ball does not apply, or an empty text."""
    return lacks_shape(scene, (Parabola, Sphere), "the parabola and the ball")


def lacks_ball(scene: Scene) -> str:
    """Return why a method for a ball on a Kelvin-Voigt foundation does not apply, or an empty text."""
    return lacks_shape(scene, (Sphere,), "the ball") or lacks_kelvin_voigt(scene)


def lacks_one_scene(scene: Scene) -> str:
    """Return why what is made for one scene does not take arrays of them, or an empty text.

    >>> lacks_one_scene(Scene())
    ''
    """
    keys = ", ".join(scene.arrays())
    return f"is for one scene, not for arrays ({keys}); use `sweep`, or one value" if keys else ""


def lacks_strips(scene: Scene) -> str:
    """Return why the transient of a ball by strips without memory does not apply, or an empty text."""
    if lacking := lacks_ball(scene) or lacks_rigid_drive(scene):
        return lacking
    told = 'holds for support.kind = "fixed" only: a ball that rises lifts its rim off the ground'
    return "" if scene.held else f"for a ball {told} and meets its own trace again"


def lacks_kelvin_voigt(scene: Scene) -> str:
    """Return why a method that needs a Kelvin-Voigt foundation does not apply, or an empty text."""
    if isinstance(scene.foundation, Foundation):
        return ""
    named = f'foundation.kind = "{scene.foundation.kind}"'
    return f'holds for foundation.kind = "{Foundation.kind}" only, not for {named}'


def lacks_arms(scene: Scene) -> str:
    """Return why a foundation has no finite state for a transient, or an empty text."""
    return "" if scene.foundation.arms else lacks_kelvin_voigt(scene)


def lacks_paper_model(scene: Scene) -> str:
    """Return why a method for a parabola on a Kelvin-Voigt foundation does not apply, or an empty text."""
    return lacks_parabola(scene) or lacks_kelvin_voigt(scene)


def lacks_stability(scene: Scene) -> str:
    """Return why the stability of steady sliding is not known, or an empty text."""
    if (lacking := lacks_quadratic(scene)) or not lacks_arms(scene):
        return lacking
    known = f'foundation.kind = "{Foundation.kind}" or "{GeneralizedMaxwell.kind}"'
    return f'holds for {known} only, not for "{scene.foundation.kind}"'


def lacks_rigid_drive(scene: Scene) -> str:
    """Return why a method for a rigid drive does not apply, or an empty text.

    Steady sliding, whatever drives it, does not depend on a spring.

    >>> lacks_rigid_drive(Scene())
    ''
    """
    return "" if scene.drive.rigid else "holds for a rigid drive only, not with drive.stiffness"


def lacks_rigid_paper_model(scene: Scene) -> str:
    """Return why a method for transients of the paper's model does not apply, or an empty text."""
    return lacks_paper_model(scene) or lacks_rigid_drive(scene)


def lacks_quadratic_on_arms(scene: Scene) -> str:
    """Return why there is no theory to compare a transient with, or an empty text."""
    return lacks_quadratic(scene) or lacks_arms(scene)


def lacks_asymptotes(scene: Scene) -> str:
    """Return why a method that needs closed forms of Kelvin-Voigt does not apply, or an empty text."""
    named = "the parabola, the power law, the wedge and the ball"
    lacking = lacks_shape(scene, CLOSED_FORMS, named)
    return lacking or lacks_kelvin_voigt(scene)


def lacks_limits(scene: Scene) -> str:
    """Return why the limits of steady sliding are not known, or an empty text."""
    return lacks_asymptotes(scene) if lacks_quadratic(scene) else ""


def lacks_closed_form(scene: Scene) -> str:
    """Return why steady sliding is not in closed form, with one scalar root at most, or an empty text.

    >>> lacks_closed_form(Scene())
    ''
    """
    lacking = lacks_asymptotes(scene)
    return lacking if lacks_quadratic(scene) else ""


def lacks_quadrature(scene: Scene) -> str:
    """Return why the pressure of steady sliding cannot be integrated, or an empty text.

    Beyond Kelvin-Voigt, non-convex shapes of a line contact are detected only during the computation;
    profiles of revolution must be known to be convex.

    >>> lacks_quadrature(Scene())
    ''
    """
    indenter = scene.indenter
    if indenter.per_width or indenter.convex or not (lacking := lacks_kelvin_voigt(scene)):
        return ""
    return f'of a profile of functions, indenter.shape = "{scene.indenter.shape}" {lacking}'


def lacks_shape(scene: Scene, shapes: tuple[type, ...], named: str) -> str:
    """Return why a method for some shapes, listed in `named`, does not apply, or an empty text."""
    if isinstance(scene.indenter, shapes):
        return ""
    return f'holds for {named} only, not for indenter.shape = "{scene.indenter.shape}"'


IN_MOTION = (
    lacks_parabola, lacks_paper_model, lacks_rigid_paper_model, lacks_arms, lacks_quadratic_on_arms,
    lacks_strips,
)  # fmt: skip
"""The requirements of methods for transients; where one is not met, another method may apply."""


def require(lacks: Lacking, scene: Scene, what: str) -> None:
    """Raise `ValueError` if the scene does not meet a requirement of `what`, naming an alternative."""
    if lacking := lacks(scene):
        raise ValueError(f"{what} {lacking}{_instead(lacks, scene)}")


def _instead(lacks: Lacking, scene: Scene) -> str:
    """Return the methods for a scene that the paper's model does not cover."""
    asked = lacks in IN_MOTION and (lacks_paper_model(scene) or lacks_arms(scene))
    if not asked:
        return ""
    if lacks_arms(scene):
        return (
            "; `steady` holds for it, and `elements` follows a Prony series (foundation.kind = "
            f'"{GeneralizedMaxwell.kind}") that comes near it'
        )
    return "; `elements`, or `solve` with `at`, follows any shape and any Prony series"
