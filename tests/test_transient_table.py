"""The frozen table of reference transients: its scenes and its errors."""

import json
from dataclasses import asdict

import numpy as np

from tests import transient_reference as ref

TABLE = json.loads(ref.TABLE.read_text())
SCENES = ref.TAYLOR | ref.TWO_STATES | ref.HISTORY


def column(name, quantity, part="values"):
    return np.array(TABLE[name][part][quantity], dtype=float)


def test_table_is_of_these_scenes():
    assert {
        name: {key: found[key] for key in ("drive", "epsilon", "times", "kappa")}
        for name, found in TABLE.items()
    } == {name: json.loads(json.dumps(asdict(scene))) for name, scene in SCENES.items()}


def test_errors_of_the_table():
    worst = {
        name: max(np.nanmax(column(name, q, "errors")) for q in ref.QUANTITIES) for name in TABLE
    }
    assert max(worst[name] for name in (*ref.TAYLOR, *ref.TWO_STATES)) < 5e-11
    assert max(worst[name] for name in ref.HISTORY) < 2e-8
