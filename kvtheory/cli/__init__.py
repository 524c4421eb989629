"""The commands; each imports what it needs when it runs."""

from kvtheory.cli import derive, scene, steady, transient
from kvtheory.cli.group import main

__all__ = ["derive", "main", "scene", "steady", "transient"]
