"""The states of an edge of the contact, and its sides: the left edge is number 0, the right one number 1."""

PEELING, TOUCHING, FREE = 0, 1, 2
"""At a peeling edge the pressure vanishes, a touching one meets the free surface; both are free in flight."""
SIDES = (-1.0, 1.0)
"""Outward directions."""
STATE_NAMES = {PEELING: "peeling", TOUCHING: "touching", FREE: "free"}
