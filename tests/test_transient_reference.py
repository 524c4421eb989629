"""The reference solutions of the transient, held against each other and against what is known."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from tests import transient_elements
from tests import transient_reference as ref

TABLE = json.loads(ref.TABLE.read_text())
SCENES = ref.TAYLOR | ref.TWO_STATES | ref.HISTORY
MOVING = [name for name, scene in ref.HISTORY.items() if scene.epsilon is not None]
QUICK = ["stop", "reversal", "stop-and-go", "ramp", "oscillation-slow", "suspended-stop", "hop"]


def column(name, quantity, part="values"):
    return np.array(TABLE[name][part][quantity], dtype=float)


@pytest.mark.parametrize("name", MOVING)
def test_depth_by_elements_agrees_with_the_table(name):
    elements = TABLE[name]["elements"]
    difference = np.abs(np.array(elements["d"]) - column(name, "d"))
    assert np.all(difference <= np.array(elements["errors"]) + column(name, "d", "errors"))
    assert difference.max() < 2e-7


@pytest.mark.parametrize("name", QUICK)
def test_elements_confirm_the_table(name):
    d, error = ref.extrapolated(SCENES[name], (1, 2, 4))
    assert np.all(np.abs(d - column(name, "d")) <= error)
    assert error.max() < 2e-5


def test_elements_are_of_second_order():
    exact = column("start", "d")[-2]
    coarse, fine = (abs(ref.elements(SCENES["start"], n)["d"][-2] - exact) for n in (2, 8))
    assert math.log(coarse / fine, 4) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    ("name", "s"),
    [
        ("start", 0.5),
        ("reversal", 0.8),
        ("oscillation-slow", 0.8),
        ("hop", 0.5),
        ("fixed-stop", 1.0),
    ],
)
def test_forces_by_impulse_balance_of_the_elements(name, s):
    offsets = 4e-3 * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    slope = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * 4e-3)
    found = ref.elements(replace(SCENES[name], times=tuple(s + offsets)), 4)
    rate = next(rate for start, _, rate in reversed(SCENES[name].pieces()) if start <= s)(s)
    U, M = found["U"], found["M"]
    k = TABLE[name]["times"].index(s)
    f_z, f_x = 0.75 * (U[2] + slope @ U), -1.5 * (M[2] + slope @ M - rate * U[2])
    assert f_z == pytest.approx(column(name, "f_z")[k], abs=1e-5)
    assert f_x == pytest.approx(column(name, "f_x")[k], abs=1e-5)


@pytest.mark.parametrize("name", ["stop", "hop", "fixed-reversal"])
def test_history_reproduces_the_table_within_a_looser_tolerance(name):
    found = ref.history(SCENES[name], 1e-9, 0.05)
    for q in ref.QUANTITIES:
        np.testing.assert_allclose(found[q], column(name, q), rtol=0.0, atol=1e-6, err_msg=q)


@pytest.mark.parametrize("name", ["start", "start-suspended", "start-epsilon-1-lambda-1"])
def test_history_agrees_with_closed_form_edges(name):
    found = ref.history(SCENES[name], 1e-11, 0.05)
    for q in ref.QUANTITIES:
        np.testing.assert_allclose(found[q], column(name, q), rtol=0.0, atol=1e-11, err_msg=q)


@pytest.mark.parametrize("name", ref.TAYLOR)
def test_two_states_agree_with_thirty_digits(name):
    found = ref.two_states(SCENES[name], 1e-12)
    for q in ref.QUANTITIES:
        np.testing.assert_allclose(found[q], column(name, q), rtol=0.0, atol=1e-12, err_msg=q)


def test_steady_sliding_at_fixed_depth():
    scene = ref.Scene([(0.0, 0.75)], None, (1.0,))
    found = ref.history(scene, 1e-9, 0.05)
    q, steady = 0.5, {"left": -1.0, "right": 0.5}  # lambda = (1 - q^2)/(2 q)
    steady["f_z"] = 0.75 * (1 + q) ** 2 * (q * q - 2 * q + 3) / (6 * q)
    steady["f_x"] = 1.5 * (1 - q) * (1 + q) ** 2 * (q * q - q + 4) / (12 * q)
    assert {key: found[key][0] for key in steady} == pytest.approx(steady, rel=1e-12)


def test_reversed_drive_is_the_mirror_image():
    scene = ref.Scene([(0.0, 3.0), (0.2, 3.0), (0.2, -1.0)], 0.01, (0.1, 0.2, 0.3))
    mirror = replace(scene, drive=[(s, -rate) for s, rate in scene.drive])
    there, back = (ref.history(x, 1e-9, 0.05) for x in (scene, mirror))
    np.testing.assert_allclose(there["f_x"], -back["f_x"], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(there["left"], -back["right"], rtol=0.0, atol=1e-8)


def test_edges_are_absent_only_in_flight():
    for name in TABLE:
        flying = np.isnan(column(name, "left"))
        np.testing.assert_array_equal(flying, np.isnan(column(name, "right")))
        assert np.all((column(name, "f_z") == 0.0) == flying)
    assert np.isnan(column("hop", "left")).any()


def test_closed_form_edges_refuse_a_scene_that_needs_memory():
    scene = ref.Scene([(0.0, 1.0)], 0.01, (0.0, 1.0), kappa=300.0)
    with pytest.raises(ValueError, match="needs memory"):
        ref.two_states(scene, 1e-9)


def test_elements_refuse_a_contact_that_outgrows_them(monkeypatch):
    monkeypatch.setattr(transient_elements, "REACH", 1.0)
    with pytest.raises(ArithmeticError, match="outgrows"):
        ref.elements(SCENES["stop"], 1)
