"""The deformable body itself: a bonded layer of any thickness, or a half-space, in steady sliding."""
