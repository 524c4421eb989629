"""The commands; each imports what it needs when it runs."""

from kvtheory.cli import (  # noqa: F401  # each adds its command to `main`
    chart,
    compare,
    derive,
    elements,
    scene,
    solve,
    steady,
    sweep,
)
from kvtheory.cli.group import main

__all__ = ["main"]
