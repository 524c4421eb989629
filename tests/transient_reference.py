"""Reference solutions of the transient, by four methods that share no code with the package.

Scaled form: lengths along x by a_0, depths by delta_0, time by tau, forces by the static load. At
the material point X = xi - Y, with Y' = lambda, the compression is

    u(X, s) = e^-s max(u_0(X), sup over s' <= s of e^s' g(X, s')),   g = d - xi^2,   (F8)

and p = u + u' where u = g. Before s = 0 the indenter rests: d = 1, lambda = 0, u_0 = 1 - X^2.

- `transient_elements` takes (F8) as it stands, on a row of points; it knows nothing of a
  contact or its edges.
- `transient_history` finds the contact from the whole past, and is far more accurate.
- `transient_closed_form` has closed-form edges, for starts from rest that need no memory.

`python -m tests.transient_reference` writes the table of reference values, in some twenty minutes,
with the change from a coarser to a finer solution as the error of each.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from tests.transient_closed_form import taylor, two_states
from tests.transient_elements import elements
from tests.transient_history import history
from tests.transient_scenes import HISTORY, TAYLOR, TWO_STATES, Array, Scene, Solution

TABLE = Path(__file__).parent / "data" / "transient_reference.json"

REFINEMENTS = (8, 16, 32)
ROUNDING = 1e-15
SAFETY = 10.0
"""Edges cross elements at irregular phases, so that one change of refinement can be small by luck."""


def row(values: Array) -> list[float | None]:
    """Return numbers for JSON, where NaN is None."""
    return [None if math.isnan(x) else float(x) for x in values]


def entry(scene: Scene, method: str, coarse: Solution, fine: Solution) -> dict[str, Any]:
    """Return what the table holds of a scene; in flight there is no edge, which is None."""
    for q in fine:
        if np.any(np.isnan(coarse[q]) != np.isnan(fine[q])):
            raise ArithmeticError("a coarse and a fine solution differ about a flight")
    return asdict(scene) | {
        "method": method,
        "values": {q: row(fine[q]) for q in fine},
        "errors": {q: row(np.abs(fine[q] - coarse[q]) + ROUNDING) for q in fine},
    }


def extrapolated(by: Any, scene: Scene, refinements: Sequence[float]) -> tuple[Array, Array]:
    """Return d, or d and x, by elements, and the estimated error; each refinement is twice the one before."""
    d = [by(scene, refinement) for refinement in refinements]
    better = [fine + (fine - coarse) / 3.0 for coarse, fine in pairwise(d)]
    return better[-1], SAFETY * np.abs(better[-1] - better[-2]) + ROUNDING


def depth_by_elements(scene: Scene, refinement: int) -> Array:
    """Return d by elements."""
    return elements(scene, refinement)["d"]


def table() -> dict[str, Any]:
    """Return the reference values of every scene, and the depth by elements where memory counts."""
    found = {}
    for name, scene in TAYLOR.items():
        found[name] = entry(scene, "taylor", taylor(scene, 20), taylor(scene, 30))
    for name, scene in TWO_STATES.items():
        found[name] = entry(scene, "two_states", two_states(scene, 1e-10), two_states(scene, 1e-12))
    for name, scene in HISTORY.items():
        coarse, fine = history(scene, 1e-12, 0.05), history(scene, 1e-13, 0.025)
        d, error = extrapolated(depth_by_elements, scene, REFINEMENTS)
        found[name] = entry(scene, "history", coarse, fine) | {
            "elements": {"d": row(d), "errors": row(error)}
        }
    return found


if __name__ == "__main__":
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(json.dumps(table(), indent=1) + "\n")
