"""Judge a series against the reference: python judge.py my-series.csv; exit status 1 if it disagrees.

Columns and units are read as `kvtheory compare` reads them.
"""

import json
import sys
from pathlib import Path

import numpy as np

import kvtheory as kv
from kvtheory.fitting.series import read
from kvtheory.results import SERIES_UNITS, units_for

here = Path(__file__).parent
units = units_for(kv.load_scene(here / "scene.toml").indenter, SERIES_UNITS)
mine, right = (read(path, units).columns for path in (sys.argv[1], here / "reference.csv"))
wrong = []
for name, allowed in json.loads((here / "criteria.json").read_text())["allowed"].items():
    if name in mine:
        off = np.abs(mine[name] - np.interp(mine["time"], right["time"], right[name])).max()
        print(f"{name}: off by {off:.3g}, allowed {allowed:.3g}")
        wrong += [name] * bool(not off <= allowed)
sys.exit(bool(wrong))
