"""Judge a simulation of this scene: python judge.py my-series.csv, with the options of `kvtheory compare`."""

import sys
from pathlib import Path

from kvtheory.cli import main

main(["compare", str(Path(__file__).with_name("scene.toml")), "--data", *sys.argv[1:]])
