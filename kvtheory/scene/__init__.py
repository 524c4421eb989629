"""What is modelled: scenes, their files, and units at the edge."""

from kvtheory.scene.fields import SceneError
from kvtheory.scene.files import load_scene, template, to_toml
from kvtheory.scene.indenters import Circle, Indenter, Parabola, PowerLaw, Profile, Wedge
from kvtheory.scene.model import (
    DeadWeight,
    Drive,
    Fixed,
    Foundation,
    Run,
    Scene,
    Support,
    Suspended,
)

__all__ = [
    "Circle",
    "DeadWeight",
    "Drive",
    "Fixed",
    "Foundation",
    "Indenter",
    "Parabola",
    "PowerLaw",
    "Profile",
    "Run",
    "Scene",
    "SceneError",
    "Support",
    "Suspended",
    "Wedge",
    "load_scene",
    "template",
    "to_toml",
]
