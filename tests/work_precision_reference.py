"""Independent solutions of the standard scenes of the work-precision charts.

`python -m tests.work_precision_reference` writes them with the data of the package, in a minute or two:
by `transient_history`, or where no memory is needed by `two_states`; they share no code with
the package. The solution on a Prony series is kept as it is: it is by a program that follows material points
one by one, which takes minutes; with half as many steps it differs by 1.5e-9.
"""

import json
from pathlib import Path

import kvtheory
from kvtheory.charts.problems import ARMS, STANDARD, TABLE, Problem, standard_scene
from tests.transient_history import Scene, history
from tests.transient_reference import two_states

NO_MEMORY = ("table-1", "low-velocity", "small-inertia")
PATH = Path(kvtheory.__file__).parent / "charts" / TABLE
TOLERANCE, LONGEST = 1e-11, 0.05


def solve(name: str, tolerance: float = TOLERANCE) -> dict[str, list[float]]:
    """Return times, depth and friction force of a standard scene."""
    pieces, epsilon = STANDARD[name]
    points = [(s, number) for start, end, number in pieces for s in (start, end)]
    times = Problem(name, standard_scene(name)).times.tolist()
    scene = Scene(points, epsilon, tuple(times))
    memory = name not in NO_MEMORY
    found = history(scene, tolerance, LONGEST) if memory else two_states(scene, tolerance)
    return {"times": times, "depth": found["d"].tolist(), "friction": found["f_x"].tolist()}


if __name__ == "__main__":
    kept = {name: row for name, row in json.loads(PATH.read_text()).items() if name in ARMS}
    found = {name: solve(name) for name in STANDARD if name not in ARMS}
    PATH.write_text(json.dumps(found | kept, indent=1) + "\n")
