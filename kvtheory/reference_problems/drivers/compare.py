"""Judge a simulation of this scene: python judge.py my-series.csv; exit status 1 if it disagrees."""

import sys
from pathlib import Path

import kvtheory as kv

found = kv.compare(kv.load_scene(Path(__file__).with_name("scene.toml")), data=sys.argv[1])
print(found)
sys.exit(found.verdict == "disagrees")
