"""Judge a series against the reference; exit status 1 if it disagrees, 2 if it cannot be read.

Columns and units are read as `kvtheory compare` reads them.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

import kvtheory as kv
from kvtheory.fitting.series import read
from kvtheory.results import SERIES_UNITS, units_for

here, parser = Path(__file__).parent, argparse.ArgumentParser(description=__doc__)
parser.add_argument("series", help="a CSV with units in its header")
units = units_for(kv.load_scene(here / "scene.toml").indenter, SERIES_UNITS)
try:
    series = parser.parse_args().series
    mine, right = (read(path, units).columns for path in (series, here / "reference.csv"))
except (ValueError, OSError) as error:
    parser.error(str(error))
wrong = []
for name, allowed in json.loads((here / "criteria.json").read_text())["allowed"].items():
    if name in mine:
        off = np.abs(mine[name] - np.interp(mine["time"], right["time"], right[name])).max()
        print(f"{name}: off by {off:.3g} {units.get(name, '')}, allowed {allowed:.3g}")
        wrong += [name] * bool(not off <= allowed)
sys.exit(bool(wrong))
