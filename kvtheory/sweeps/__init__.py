"""Many scenes: what is swept, the blocks it is cut into, who computes them, and where they last."""
