"""Fig. 6 of the paper: the master curves of the friction coefficient and their asymptotes.

The scaled friction coefficient depends on one number: V tau (R delta)^(-1/2) for a fixed indenter and
V tau (K/(R W))^(1/3) for a dead weight. The curves are exact; the points come from quadrature on
scenes with random parameters, and fall on the curves.

`kvtheory chart fig6` draws it too, also for another scene and in another style.
"""

from figures import drawing
from kvtheory.plots.paper.fig6 import compute, draw

if __name__ == "__main__":
    drawing.run("fig6", compute, draw)
