"""Transient sliding on a Prony series: an equation of motion, accumulators for each arm, two edges (F23)."""

from kvtheory.models.continuum.prony import solved_scene

__all__ = ["solved_scene"]
