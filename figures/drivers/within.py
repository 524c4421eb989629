"""Judge a series against the reference: python judge.py my-series.csv; exit status 1 if it disagrees."""

import csv
import json
import sys
from pathlib import Path

import numpy as np


def columns(path: str | Path) -> dict[str, np.ndarray]:
    """Return the columns of a table by name, without their units."""
    head, *rows = csv.reader(Path(path).read_text().splitlines())
    return dict(
        zip((name.split(" [")[0] for name in head), np.array(rows, dtype=float).T, strict=True)
    )


here = Path(__file__).parent
criteria = json.loads((here / "criteria.json").read_text())
mine, right, over = columns(sys.argv[1]), columns(here / "reference.csv"), criteria["over"]
wrong = []
for name, allowed in criteria["allowed"].items():
    off = np.abs(mine[name] - np.interp(mine[over], right[over], right[name])).max()
    print(f"{name}: off by {off:.3g}, allowed {allowed:.3g}")
    wrong += [name] * bool(not off <= allowed)
sys.exit(bool(wrong))
