"""Sliding friction of a rigid indenter on a Kelvin-Voigt foundation: derived, exact, checked."""

from kvtheory.api import asymptotes, compare, elements, solve, steady, sweep, transient
from kvtheory.results import (
    AsymptoteReport,
    Certificate,
    Comparison,
    Simulation,
    Solution,
    SteadyState,
    Transient,
)
from kvtheory.scene import (
    Circle,
    DeadWeight,
    Drive,
    Fixed,
    Foundation,
    Parabola,
    PowerLaw,
    Profile,
    Run,
    Scene,
    SceneError,
    Suspended,
    Wedge,
    load_scene,
    to_toml,
)
from kvtheory.sweeps.result import Sweep

__version__ = "0.1.0"

__all__ = [
    "AsymptoteReport",
    "Certificate",
    "Circle",
    "Comparison",
    "DeadWeight",
    "Drive",
    "Fixed",
    "Foundation",
    "Parabola",
    "PowerLaw",
    "Profile",
    "Run",
    "Scene",
    "SceneError",
    "Simulation",
    "Solution",
    "SteadyState",
    "Suspended",
    "Sweep",
    "Transient",
    "Wedge",
    "asymptotes",
    "compare",
    "elements",
    "load_scene",
    "solve",
    "steady",
    "sweep",
    "to_toml",
    "transient",
]
