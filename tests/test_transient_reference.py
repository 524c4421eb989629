"""The solver against the table of independent solutions, and these against each other.

The table (`tests/transient_reference.py`) comes from Taylor series, SciPy's integrators on the two-state
form, and the supremum over the whole past at points of the foundation; it states its error.
"""

import json

import numpy as np
import pytest

from tests import transient_reference as ref
from tests.spring_random import solved
from tests.transient_history import QUANTITIES

TABLE = json.loads(ref.TABLE.read_text())
SCENES = ref.TAYLOR | ref.TWO_STATES | ref.HISTORY
RTOL, ALLOWED = 1e-9, 1e-8
"""At rtol 1e-9 every quantity is within 1e-8 of the static state, or of the largest value met."""
COLUMNS = {
    "d": "depth", "v": "depth_rate", "f_z": "normal_force", "f_x": "friction_force",
}  # fmt: skip


def column(name, quantity, part="values"):
    return np.array(TABLE[name][part][quantity], dtype=float)


def worst(states, columns, entry, times_stated=1.0):
    """Return by how much the states exceed the stated errors of a table, relative to the largest value."""
    excess = 0.0
    edges = dict(zip(("left", "right"), states["edges"].T, strict=True))
    found = {quantity: states[name] for quantity, name in columns.items()}
    for quantity, values in (found | (edges if "f_z" in columns else {})).items():
        truth, stated = (
            np.array(entry[part][quantity], dtype=float) for part in ("values", "errors")
        )
        assert np.array_equal(np.isnan(values), np.isnan(truth)), quantity
        scale = max(1.0, np.nanmax(np.abs(truth), initial=0.0))
        over = np.abs(values - truth) - times_stated * stated
        excess = max(excess, np.nanmax(over, initial=0.0) / scale)
    return excess


@pytest.mark.parametrize("name", TABLE)
def test_every_quantity_agrees_with_the_independent_solution(name):
    states = solved(SCENES[name], RTOL).states(TABLE[name]["times"])
    assert worst(states, COLUMNS, TABLE[name]) <= ALLOWED


@pytest.mark.parametrize("rtol", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10])
def test_the_error_of_a_start_is_in_proportion_to_the_tolerance(rtol):
    motion = {name: COLUMNS[name] for name in ("d", "v")}
    for name in ref.TAYLOR | ref.TWO_STATES:
        states = solved(SCENES[name], rtol).states(TABLE[name]["times"])
        assert worst(states, motion, TABLE[name]) <= (4.0 if rtol > 1e-6 else 2.0) * rtol, name


def test_table_is_of_these_scenes_with_these_errors():
    keys = "drive", "epsilon", "times", "kappa"
    assert {name: [found[key] for key in keys] for name, found in TABLE.items()} == {
        name: json.loads(json.dumps([getattr(scene, key) for key in keys]))
        for name, scene in SCENES.items()
    }
    for name in TABLE:
        error = max(np.nanmax(column(name, q, "errors")) for q in QUANTITIES)
        assert error < (2e-8 if name in ref.HISTORY else 5e-11), name
        flying = np.isnan(column(name, "left"))
        np.testing.assert_array_equal(flying, np.isnan(column(name, "right")))
        assert np.all((column(name, "f_z") == 0.0) == flying)
    assert np.isnan(column("hop", "left")).any()


@pytest.mark.parametrize(
    ("name", "method", "allowed"),
    [
        ("fixed-reversal", lambda scene: ref.history(scene, 1e-9, 0.05), 1e-6),
        ("start", lambda scene: ref.two_states(scene, 1e-12), 1e-12),
    ],
)
def test_each_method_reproduces_the_table(name, method, allowed):
    found = method(SCENES[name])
    for q in QUANTITIES:
        np.testing.assert_allclose(found[q], column(name, q), rtol=0.0, atol=allowed, err_msg=q)


def test_steady_sliding_at_fixed_depth():
    scene = ref.Scene([(0.0, 0.75)], None, (1.0,))
    found = ref.history(scene, 1e-9, 0.05)
    q, steady = 0.5, {"left": -1.0, "right": 0.5}  # lambda = (1 - q^2)/(2 q)
    steady["f_z"] = 0.75 * (1 + q) ** 2 * (q * q - 2 * q + 3) / (6 * q)
    steady["f_x"] = 1.5 * (1 - q) * (1 + q) ** 2 * (q * q - q + 4) / (12 * q)
    assert {key: found[key][0] for key in steady} == pytest.approx(steady, rel=1e-12)
