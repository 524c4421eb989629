"""Steady sliding from plain numbers in SI, by the method that a scene takes."""

import numpy as np

from kvtheory.models.steady.methods import solve_exact
from kvtheory.results import STEADY_UNITS
from kvtheory.scene import DeadWeight, Drive, Fixed, Foundation, Parabola, Scene, Suspended


def at_depth(indenter, K, tau, V, depth, solve=solve_exact):
    """Return the steady state at a depth; the indenter may be the radius of a parabola."""
    return solve(_scene(indenter, K, tau, V, Fixed(depth)))


def at_load(indenter, K, tau, V, weight, spring=0.0, solve=solve_exact):
    """Return the steady state under a weight, on a spring or without."""
    if np.any(spring):
        return solve(_scene(indenter, K, tau, V, Suspended(load=weight, stiffness=spring)))
    return solve(_scene(indenter, K, tau, V, DeadWeight(load=weight)))


def _scene(indenter, K, tau, V, support):
    shape = indenter if hasattr(indenter, "height") else Parabola(indenter)
    foundation = K if hasattr(K, "kind") else Foundation(K, tau)
    return Scene(shape, foundation, support, Drive(V))


def agree(found, truth, most=1.0):
    """Hold all quantities of two states against the sum of their errors, those of the first below `most`."""
    for name in STEADY_UNITS:
        value = getattr(truth, name)
        one, other = (state.certificate.relative_error[name] for state in (found, truth))
        assert np.all(np.abs(getattr(found, name) - value) <= (one + other) * np.abs(value)), name
        assert np.max(one) < most or most == np.inf, name
