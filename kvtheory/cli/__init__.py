"""The commands; each imports what it needs when it runs."""

from kvtheory.cli import chart, derive, fit, scene, solve, steady, sweep  # noqa: F401  # they add commands
from kvtheory.cli.group import main

__all__ = ["main"]
