"""The public functions: a scene in, a result out."""

from kvtheory.api._asymptotes import asymptotes
from kvtheory.api._compare import compare
from kvtheory.api._drop import foundation_of_drop, foundation_of_mode, restitution
from kvtheory.api._elements import elements
from kvtheory.api._fewer_arms import fewer_arms
from kvtheory.api._fit import fit
from kvtheory.api._fit_foundation import fit_foundation
from kvtheory.api._solve import solve
from kvtheory.api._stability import stability
from kvtheory.api._steady import footprint, steady
from kvtheory.api._sweep import sweep
from kvtheory.api._transient import transient

__all__ = [
    "asymptotes", "compare", "elements", "fewer_arms", "fit", "fit_foundation", "footprint",
    "foundation_of_drop", "foundation_of_mode", "restitution", "solve", "stability", "steady", "sweep",
    "transient",
]  # fmt: skip
