"""What users call: a scene in, a result out, by the method asked for."""

from kvtheory.api.steady_sliding import asymptotes, steady
from kvtheory.api.whole_transient import transient

__all__ = ["asymptotes", "steady", "transient"]
