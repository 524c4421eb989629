"""Sliding friction of a rigid indenter on a Kelvin-Voigt foundation: derived, exact, checked."""

from kvtheory.api import asymptotes, steady, transient
from kvtheory.results import AsymptoteReport, Certificate, SteadyState, Transient
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

__version__ = "0.1.0"

__all__ = [
    "AsymptoteReport",
    "Certificate",
    "Circle",
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
    "SteadyState",
    "Suspended",
    "Transient",
    "Wedge",
    "asymptotes",
    "load_scene",
    "steady",
    "to_toml",
    "transient",
]
