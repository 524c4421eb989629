"""Fig. 4 of the paper: the contact pressure over position and time, with both edges.

`kvtheory chart fig4` draws it too, also for another scene and in another style.
"""

from figures import drawing
from kvtheory.plots.paper.fig4 import compute, draw

if __name__ == "__main__":
    drawing.run("fig4", compute, draw)
