"""The deformable body itself: a bonded layer of any thickness, or a half-space, in steady sliding."""

from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import Sliding, slide, slide_at

__all__ = ["Body", "Sliding", "Support", "slide", "slide_at"]
