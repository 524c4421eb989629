"""Draw every figure: `python -m figures [-o DIRECTORY]`."""

import argparse
import sys
import time
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from figures import drawing

TOPICS = {
    "The paper": ("fig3", "fig4", "fig5", "fig6", "table2"),
    "Energy, limits and regimes": (
        *("energy_split", "asymptote_error", "circle_error"),
        *("phase_portrait", "regime_map", "onset_maps"),
    ),
    "Other foundations": (
        *("foundations", "rubber", "rubber_start"),
        *("temperature", "fewer_arms", "foundation_precision", "layer_error"),
    ),
    "The ball": ("ball", "ball_start", "ball_pressure"),
    "A spring in the drive": (
        *("spring_stability", "measurable_friction", "stick_slip", "stick_slip_amplitude"),
    ),
    "Methods": ("ladder", "stability_map", "work_precision", "engines"),
}
FIGURES = tuple(name for names in TOPICS.values() for name in names)

INTERPRETED = (
    "numba is not installed, so that transients are interpreted: regime_map and onset_maps take several "
    'minutes, not seconds; in the checkout, pip install ".[fast]" installs it'
)


def main() -> None:
    """Draw each figure and print how long it took."""
    parser = argparse.ArgumentParser(prog="python -m figures", description=__doc__)
    parser.add_argument(
        "-o", "--output", type=Path, default=drawing.OUTPUT, help="default: %(default)s"
    )
    directory = parser.parse_args().output
    if find_spec("numba") is None:
        print(INTERPRETED, file=sys.stderr, flush=True)
    for number, name in enumerate(FIGURES, start=1):
        start = time.perf_counter()
        script = import_module(f"figures.{name}")
        paths = drawing.produce(name, script.compute, script.draw, directory)
        seconds = time.perf_counter() - start
        print(f"[{number}/{len(FIGURES)}] {paths[0].with_suffix('')}  {seconds:.1f} s", flush=True)


if __name__ == "__main__":
    main()
