"""The commands; each imports what it needs when it runs."""

from kvtheory.cli import (
    chart,
    cite,
    compare,
    derive,
    elements,
    scene,
    solve,
    steady,
    sweep,
    transient,
)
from kvtheory.cli.group import main

__all__ = [
    "chart",
    "cite",
    "compare",
    "derive",
    "elements",
    "main",
    "scene",
    "solve",
    "steady",
    "sweep",
    "transient",
]
