"""Table 2 of the paper: critical velocity and friction coefficient, with the values for Table 1.

`kvtheory chart table2` draws it too, also for another scene and in another style.
"""

from figures import drawing
from kvtheory.plots.paper.table2 import compute, draw

if __name__ == "__main__":
    drawing.run("table2", compute, draw)
