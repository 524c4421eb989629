"""Fig. 5 of the paper: steady sliding over the drive velocity, for both models and three tau.

Lines are the exact solution, points the quadrature, which shares no code with it.

`kvtheory chart fig5` draws it too, also for another scene and in another style.
"""

from figures import drawing
from kvtheory.plots.paper.fig5 import compute, draw

if __name__ == "__main__":
    drawing.run("fig5", compute, draw)
