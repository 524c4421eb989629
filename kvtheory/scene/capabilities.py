"""Capabilities: the scenes for which each question is answered, and the messages about the others.

A scene has a shape, a foundation law, a support and a drive. A question is answered for certain sets of
these; messages, tests and a page of the documentation are made from the table `QUESTIONS`.
"""

from collections.abc import Callable
from dataclasses import dataclass

from kvtheory.scene.foundations import ARMS, DAMPED, LAWS
from kvtheory.scene.indenters import SHAPES as CLASSES
from kvtheory.scene.indenters import Profile, Revolved
from kvtheory.scene.layer import not_at_rest
from kvtheory.scene.model import SUPPORTS as KINDS
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import quantities

SHAPES = {cls.shape: cls.words for cls in (*CLASSES.values(), Profile, Revolved)}
"""The shapes of the table, in words."""
SUPPORTS = tuple(KINDS)
MOVING = tuple(name for name, cls in KINDS.items() if "depth" not in quantities(cls))
DRIVES = "rigid", "spring"

KELVIN_VOIGT, ONE_OF_BOTH, FINITE = LAWS[:1], LAWS[:2], LAWS[:3]
"""The laws with a damper alone, with a damper or arms, and with both: those with a finite state."""
CLOSED = "parabola", "power-law", "wedge", "sphere"
"""Shapes whose steady sliding on a Kelvin-Voigt foundation is in closed form, with one root at most."""
QUADRATIC = "parabola", "sphere"
TRACE = "a ball that rises lifts its rim off the ground and meets its own trace again"


@dataclass(frozen=True)
class Scenes:
    """The scenes with one of these shapes, laws, supports and drives."""

    shapes: tuple[str, ...] = tuple(SHAPES)
    laws: tuple[str, ...] = LAWS
    supports: tuple[str, ...] = SUPPORTS
    drives: tuple[str, ...] = DRIVES
    why: str = ""

    def lacking(self, shape: str, law: str, support: str, drive: str, kind: str = "") -> list[str]:
        """Return the conditions that a scene does not meet, in words; `kind` is that of its foundation."""
        found = []
        if shape not in self.shapes:
            named = _listed([SHAPES[name] for name in self.shapes], "and")
            message = f'indenter.shape = "{shape}"'
            found.append(f"holds for {named} only, not for {message}")
        for key, valid, name in (
            ("foundation.kind", self.laws, law), ("support.kind", self.supports, support)
        ):  # fmt: skip
            if name not in valid:
                named = _listed([f'"{each}"' for each in valid if each != DAMPED], "or")
                why = f": {self.why}" if self.why and key == "support.kind" else ""
                own = f'"{kind if name == law else name}"'
                own = "arms beside foundation.damping" if name == DAMPED else own
                found.append(f"holds for {key} = {named} only, not for {own}{why}")
        if drive not in self.drives:
            found.append("holds for a rigid drive only, not with drive.stiffness")
        return found


class Needs:
    """A requirement on a scene, which is met by any of several sets of scenes.

    Called with a scene, it returns an empty text if the scene meets it; else the first condition of the
    nearest set that it does not meet. All but those `on_body` need the stiffness K of independent elements.

    >>> lacks_parabola(Scene())
    ''
    """

    def __init__(
        self, *sets: Scenes, over_time: tuple[str, ...] = (), on_body: bool = False
    ) -> None:
        self.sets, self.on_body = sets, on_body
        self.over_time = over_time  # the laws on which the depth of a fixed indenter may change
        self.messages: dict[tuple[str, ...], str] = {}

    def __call__(self, scene: Scene) -> str:
        """Return what the scene lacks."""
        if scene.foundation.stiffness is None and not self.on_body:
            own = not_at_rest(scene.indenter)
            body = 'the body itself by `method` = "layer" of `steady`'
            expected = f'expected foundation.stiffness_from = "thin", or {body}'
            return f"needs the K of the contact at rest, which {own}; {expected}"
        if scene.depths and scene.foundation.law not in self.over_time:
            return "holds at one depth only, not for support.history"
        kind = *scene.kind, scene.foundation.kind
        if kind not in self.messages:
            shape = kind[0]
            # What is named, shapes or laws, is as much as holds.

            def narrow(s: Scenes) -> tuple[bool, int]:
                return (False, -len(s.laws)) if shape in s.shapes else (True, -len(s.shapes))

            sets = sorted(self.sets, key=narrow)
            nearest = min((each.lacking(*kind) for each in sets), key=len)
            self.messages[kind] = nearest[0] if nearest else ""
        return self.messages[kind]

    def laws(self, shape: str, support: str, drive: str) -> list[str]:
        """Return the foundation laws for which a shape, support and drive meet the requirement."""
        met = [s.laws for s in self.sets if not s.lacking(shape, s.laws[0], support, drive)]
        return [law for law in LAWS if any(law in laws for laws in met)]


lacks_parabola = Needs(Scenes(("parabola",)))
lacks_quadratic = Needs(Scenes(QUADRATIC), over_time=LAWS)
lacks_kelvin_voigt = Needs(Scenes(laws=KELVIN_VOIGT))
lacks_arms = Needs(Scenes(laws=FINITE), over_time=FINITE)
lacks_drop = Needs(Scenes(QUADRATIC, KELVIN_VOIGT, MOVING))
lacks_dropped = Needs(Scenes(QUADRATIC, supports=MOVING))
lacks_ball = Needs(Scenes(("sphere",), KELVIN_VOIGT))
lacks_rigid_drive = Needs(Scenes(drives=("rigid",)))
lacks_paper_model = Needs(Scenes(("parabola",), KELVIN_VOIGT))
lacks_rigid_paper_model = Needs(Scenes(("parabola",), KELVIN_VOIGT, drives=("rigid",)))
lacks_slow_manifold = Needs(Scenes(("parabola",), KELVIN_VOIGT, MOVING, ("rigid",)))
lacks_continuum = Needs(Scenes(("parabola",), FINITE), over_time=FINITE)
lacks_rigid_continuum = Needs(Scenes(("parabola",), FINITE, drives=("rigid",)))
lacks_stability = Needs(Scenes(QUADRATIC, FINITE))
lacks_quadratic_on_arms = Needs(Scenes(QUADRATIC, FINITE), over_time=FINITE)
lacks_asymptotes = Needs(Scenes(CLOSED, KELVIN_VOIGT))
lacks_numbers = Needs(Scenes(QUADRATIC, ONE_OF_BOTH), *lacks_asymptotes.sets)
lacks_limits = lacks_closed_form = Needs(Scenes(QUADRATIC), *lacks_asymptotes.sets)
lacks_quadrature = Needs(Scenes())
lacks_body = Needs(Scenes(laws=ONE_OF_BOTH), on_body=True)
lacks_scripts = Needs(Scenes(QUADRATIC), Scenes((*CLOSED, "circle"), KELVIN_VOIGT))


@dataclass(frozen=True)
class Question:
    """A question about a scene: its name, the call, the requirement, and what theory is missing."""

    what: str
    call: str
    needs: Needs
    missing: str = ""


_NO_ELEMENTS = "A springpot has no finite state; a Prony series that approximates it has one."
QUESTIONS = {
    "exact": Question(
        "steady sliding in closed form", 'steady(scene, method="exact")', lacks_closed_form,
        "On other laws only the parabola, and with it the strips of a ball, have a pressure explicit in the "
        "length of the contact. The circle has no closed form.",
    ),
    "quadrature": Question(
        "steady sliding by integration", 'steady(scene, method="quadrature")', lacks_quadrature,
        "Beyond Kelvin-Voigt one interval of contact is proved for convex profiles only: functions that are "
        "not convex are refused when they are solved.",
    ),
    "asymptote": Question(
        "steady sliding by asymptotes", 'steady(scene, method="asymptote")', lacks_asymptotes,
        "Other laws have other limits, which `asymptotes` gives without proved errors.",
    ),
    "layer": Question(
        "steady sliding on the body itself", 'steady(scene, method="layer")', lacks_body,
        "The foundation has to be given by modulus, thickness and Poisson's ratio, and functions have to be "
        "convex. A springpot has no retardation times, and a damper beside arms has no modulus.",
    ),
    "limits": Question(
        "limits of steady sliding", "asymptotes(scene)", lacks_limits,
        "The limits of other shapes on other laws are not derived; their maxima of friction are given.",
    ),
    "maxima": Question("maxima of friction", "asymptotes(scene).maxima", lacks_quadrature),
    "stability": Question(
        "the stability of steady sliding", "stability(scene)", lacks_stability,
        "The response of the contact to small motions is derived for the parabola, for the strips of a ball, "
        "and for laws with a finite state.",
    ),
    "transient": Question(
        "the transient", "transient(scene)", lacks_continuum,
        f"Without elements the contact has to be known as one interval in every strip: {TRACE}. Elements "
        "answer.",
    ),
    "slow manifold": Question(
        "the slow manifold", "solve(scene, at=...)", lacks_slow_manifold,
        "It is derived for the paper's model; a fixed indenter does not move, and has none.",
    ),
    "elements": Question("the simulator", "elements(scene)", lacks_arms, _NO_ELEMENTS),
    "series": Question("the cheapest transient", "solve(scene, at=...)", lacks_arms, _NO_ELEMENTS),
    "compare": Question(
        "the theory of the transient", "compare(scene, data)", lacks_quadratic_on_arms,
        "The static state of other shapes, whose scales the comparison uses, is not in closed form.",
    ),
    "sweep": Question("sweeps of steady sliding", "sweep(scene, over=...)", lacks_quadrature),
    "sweep over time": Question(
        "sweeps of transients", "sweep(scene, over=..., at=...)", lacks_arms, _NO_ELEMENTS
    ),
    "drop": Question(
        "a drop in closed form", "restitution(scene)", lacks_drop,
        "On other laws a drop has more than one number, and other shapes are not derived: `transient` and "
        "`elements` follow it.",
    ),
    "footprint": Question(
        "the footprint", "footprint(scene)", lacks_ball,
        "The pressure over the area of other contacts is not in closed form."
    ),
    "explorer": Question(
        "the explorer", "kvtheory explore", lacks_scripts,
        "The scripts of the page know closed forms, and the integral of the circle.",
    ),
    "numbers": Question(
        "derivations with numbers", "kvtheory derive, with numbers", lacks_numbers,
        "The derivations are of closed forms: on Kelvin-Voigt, and of a parabola and a ball on arms.",
    ),
}  # fmt: skip
"""The only table of capabilities. For scenes that are not covered, theory is missing."""

IN_MOTION = (
    lacks_parabola, lacks_paper_model, lacks_rigid_paper_model, lacks_arms, lacks_quadratic_on_arms,
    lacks_continuum, lacks_rigid_continuum,
)  # fmt: skip
"""The requirements of methods for transients; where one is not met, another method may apply."""


def lacks_one_scene(scene: Scene) -> str:
    """Return why a function for one scene does not take arrays of them, or an empty text."""
    keys = ", ".join(scene.arrays())
    message = "use `sweep`, or give one value of each"
    return f"is for one scene, not for arrays ({keys}); {message}" if keys else ""


def require(lacks: Callable[[Scene], str], scene: Scene, what: str) -> None:
    """Raise `ValueError` if the scene does not meet a requirement of `what`, naming an alternative."""
    if not (lacking := lacks(scene)):
        return
    instead = ""
    if scene.foundation.stiffness is None:
        pass  # `lacking` says what to do
    elif lacks in IN_MOTION and lacks_arms(scene):
        prony = f'a Prony series (foundation.kind = "{ARMS}") that approximates it'
        instead = f"; `steady` holds for it, and `elements` follows {prony}"
    elif lacks in IN_MOTION:
        instead = "; `elements`, or `solve` with `at`, follows any shape and any Prony series"
    raise ValueError(f"{what} {lacking}{instead}")


def _listed(names: list[str], word: str) -> str:
    return f"{', '.join(names[:-1])} {word} {names[-1]}" if len(names) > 1 else names[0]
