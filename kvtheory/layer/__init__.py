"""The deformable body itself: a bonded layer of any thickness, or a half-space, in steady sliding."""

from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import Sliding, slide, slide_at
from kvtheory.theory.contact_at_rest import load_at_rest

__all__ = ["Body", "Sliding", "Support", "load_at_rest", "slide", "slide_at"]
