"""What users call: a scene in, a result out, by the method asked for."""

from kvtheory.api.cheapest import solve
from kvtheory.api.cross_validation import compare
from kvtheory.api.discrete import elements
from kvtheory.api.many_scenes import sweep
from kvtheory.api.steady_sliding import asymptotes, steady
from kvtheory.api.whole_transient import transient

__all__ = ["asymptotes", "compare", "elements", "solve", "steady", "sweep", "transient"]
