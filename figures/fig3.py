"""Fig. 3 of the paper: the onset of sliding, for both models, from the exact transient.

`kvtheory chart fig3` draws it too, also for another scene and in another style.
"""

from figures import drawing
from kvtheory.plots.paper.fig3 import compute, draw

if __name__ == "__main__":
    drawing.run("fig3", compute, draw)
