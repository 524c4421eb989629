"""Sliding friction of a rigid indenter on a viscoelastic foundation: derived, exact, checked."""

TYPE_CHECKING = False  # as in `typing`, whose import takes long enough to be interrupted
if TYPE_CHECKING:
    from kvtheory.api import (
        asymptotes,
        compare,
        elements,
        fewer_arms,
        fit,
        fit_foundation,
        footprint,
        foundation_of_drop,
        foundation_of_mode,
        restitution,
        solve,
        stability,
        steady,
        sweep,
        transient,
    )
    from kvtheory.reference_problems import problem, problems
    from kvtheory.results import (
        AsymptoteReport,
        Certificate,
        Comparison,
        DivergenceError,
        FewerArms,
        FoundationFit,
        FrictionFit,
        Impact,
        QuadratureError,
        Simulation,
        Solution,
        SprungTransient,
        Stability,
        SteadyState,
        Sweep,
        ToleranceError,
        Transient,
        TransientError,
    )
    from kvtheory.scene import (
        Circle,
        DeadWeight,
        Drive,
        Fixed,
        Foundation,
        FractionalKelvinVoigt,
        GeneralizedMaxwell,
        Parabola,
        PowerLaw,
        Profile,
        Revolved,
        Run,
        Scene,
        SceneError,
        Sine,
        SmoothRamp,
        Sphere,
        Start,
        Suspended,
        Triangle,
        Wedge,
        load_scene,
        to_toml,
    )

__version__ = "0.1.0"

__all__ = [
    "AsymptoteReport", "Certificate", "Circle", "Comparison", "DeadWeight", "DivergenceError",
    "Drive", "FewerArms", "Fixed", "Foundation", "FoundationFit", "FractionalKelvinVoigt",
    "FrictionFit", "GeneralizedMaxwell", "Impact", "Parabola", "PowerLaw", "Profile",
    "QuadratureError", "Revolved", "Run", "Scene", "SceneError", "Simulation", "Sine",
    "SmoothRamp", "Solution", "Sphere", "SprungTransient", "Stability", "Start", "SteadyState",
    "Suspended", "Sweep", "ToleranceError", "Transient", "TransientError", "Triangle", "Wedge",
    "asymptotes", "compare", "elements", "fewer_arms", "fit", "fit_foundation", "footprint",
    "foundation_of_drop", "foundation_of_mode", "load_scene", "problem", "problems",
    "restitution", "solve", "stability", "steady", "sweep", "to_toml", "transient",
]  # fmt: skip

HOMES = "api", "reference_problems", "results", "scene"
"""Packages whose names are those of this one."""


if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Return a public name, or one of its packages, which is imported when it is first used."""
        from importlib import import_module

        if name in HOMES:
            return import_module(f"kvtheory.{name}")
        for home in HOMES if name in __all__ else ():
            module = import_module(f"kvtheory.{home}")
            if name in module.__all__:
                return globals().setdefault(name, getattr(module, name))
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        """Return the public names, for completion."""
        return sorted({*globals(), *__all__})
