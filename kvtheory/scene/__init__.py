"""Scenes: the model, its files, and units on input."""

from kvtheory.scene.files import load_scene, template, to_toml
from kvtheory.scene.foundations import Foundation, FractionalKelvinVoigt, GeneralizedMaxwell
from kvtheory.scene.indenters import (
    Circle,
    Indenter,
    Parabola,
    PowerLaw,
    Profile,
    Revolved,
    Sphere,
    Wedge,
)  # fmt: skip
from kvtheory.scene.mistakes import SceneError
from kvtheory.scene.model import DeadWeight, Drive, Fixed, Run, Scene, Support, Suspended
from kvtheory.scene.start import Start
from kvtheory.scene.waveforms import Sine, SmoothRamp, Triangle

__all__ = [
    "Circle", "DeadWeight", "Drive", "Fixed", "Foundation", "FractionalKelvinVoigt",
    "GeneralizedMaxwell", "Indenter", "Parabola", "PowerLaw", "Profile", "Revolved", "Run", "Scene",
    "SceneError", "Sine", "SmoothRamp", "Sphere", "Start", "Support", "Suspended", "Triangle",
    "Wedge", "load_scene", "template", "to_toml",
]  # fmt: skip
