"""The discrete simulator against theory, in each regime of the transient.

The truth is the frozen table of `tests/transient_reference.py`, computed by methods that share no code
with the simulator, and `kv.transient`. Scaled scenes have R = 1/2, K = 3/4, tau = delta_0 = 1, so that
static half length and load are 1.
"""

from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from tests.spring_random import in_si
from tests.test_elements_certificate import errors
from tests.test_transient_reference import SCENES, TABLE

COLUMNS = {"d": "depth", "v": "depth_rate", "f_z": "normal_force", "f_x": "friction_force",
           "left": "leading_edge", "right": "trailing_edge"}  # fmt: skip
DENSITY = 60.0
REGIMES = [
    name for name in TABLE if "epsilon" not in name
    and name not in ("start-heavier", "hops", "start-lambda-100-heavy")
]  # fmt: skip
POINT_SCHEMES = ("paper", "explicit-euler", "semi-implicit", "exponential")


def scene(name):
    return in_si(SCENES[name])


def simulate(name, density=DENSITY, **options):
    return kv.elements(scene(name), per_length=density, at=TABLE[name]["times"], **options)


def differences(name, run):
    """Return the largest error of each quantity."""
    values = {q: np.array(TABLE[name]["values"][q], dtype=float) for q in COLUMNS}
    return errors(run, {COLUMNS[q]: value for q, value in values.items()}, scene(name))


@pytest.mark.parametrize("name", REGIMES)
def test_every_regime_agrees_with_theory_and_the_certificate_covers_the_error(name):
    run, values = simulate(name), TABLE[name]["values"]
    flying = np.isnan(np.array(values["left"], dtype=float))
    assert np.array_equal(np.isnan(run.leading_edge), flying)
    assert np.all(run.normal_force[flying] == 0.0)
    found = differences(name, run)
    for q, column in COLUMNS.items():
        largest = max(1.0, np.nanmax(np.abs(np.array(values[q], dtype=float))))
        assert found[column] <= run.certificate.relative_error[column] + 1e-12, q
        assert found[column] <= 0.03 * largest, q
    assert run.warning == ""


@pytest.mark.parametrize("scheme", POINT_SCHEMES)
@pytest.mark.parametrize("name", ["start-heavy", "stop-and-go", "oscillation-fast", "hop"])
def test_the_certificate_covers_the_error_of_every_scheme(scheme, name):
    run = simulate(name, scheme=scheme, time_step=0.004)
    for quantity, error in differences(name, run).items():
        assert error <= run.certificate.relative_error[quantity], quantity


def fitted_order(errors):
    """Return the slope of log error over log refinement, refined twofold each time."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]


@cache
def while_refining(name, scheme):
    """Return the differences with 40 to 320 elements in a half length, and steps in proportion."""
    return [
        differences(
            name, simulate(name, 40.0 * k, scheme=scheme, time_step=0.004 / k, certify=False)
        )
        for k in (1, 2, 4, 8)
    ]


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        *(("hop", q) for q in ("d", "v", "f_z", "f_x", "left", "right")),
        *(("start-heavy", q) for q in ("d", "f_x", "left")),
        *(("suspended-stop", "d"), ("reversal", "d"), ("oscillation-fast", "f_x")),
    ],
)
def test_edge_corrected_is_of_second_order(name, quantity):
    runs = while_refining(name, "edge-corrected")
    order = fitted_order([found[COLUMNS[quantity]] for found in runs])
    assert order == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("scheme", POINT_SCHEMES)
@pytest.mark.parametrize("quantity", ["normal_force", "friction_force"])
def test_forces_of_whole_elements_are_of_first_order(scheme, quantity):
    order = fitted_order([found[quantity] for found in while_refining("hop", scheme)])
    assert order == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(
    ("scheme", "order"), [("semi-implicit", 1.0), ("explicit-euler", 1.0), ("exponential", 2.0)]
)
def test_order_in_time_at_a_fine_spacing(scheme, order):
    options = {"density": 400.0, "scheme": scheme, "certify": False}
    errors = [
        differences("start-heavy", simulate("start-heavy", time_step=h, **options))["depth_rate"]
        for h in (0.1, 0.05, 0.025)
    ]
    assert fitted_order(errors) == pytest.approx(order, abs=0.15)


def test_whole_elements_carry_a_sawtooth_of_the_edge_pressure():
    """Theorem F15-sawtooth: +- p_LE dx/2, at instants that see every phase of the elements."""
    still = kv.Scene.table1("fixed")
    steady = kv.steady(still)
    dx, times = 5e-6, np.linspace(0.01, 0.0101, 60)
    runs = {
        scheme: kv.elements(still, at=times, scheme=scheme, time_step=2e-6, certify=False)
        for scheme in ("paper", "exponential", "edge-corrected")
    }
    predicted = 0.5 * steady.peak_pressure * dx
    for scheme in ("paper", "exponential"):
        excess = runs[scheme].normal_force - steady.load
        assert excess.max() == pytest.approx(predicted, rel=0.1)
        assert excess.min() == pytest.approx(-predicted, rel=0.1)
    corrected = np.abs(runs["edge-corrected"].normal_force - steady.load)
    assert corrected.max() < 2e-3 * predicted


def test_a_start_faster_than_elements_pass_is_resolved():
    """The dampers stop the ball in a thirtieth of the time in which two elements pass."""
    scene = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(load="9.8 N"))
    coarse, fine = (
        kv.elements(scene, per_length=density, at=1e-3, certify=density == "20 /mm")
        for density in ("20 /mm", "100 /mm")
    )
    # Of the last half millisecond, in which the error falls to a quarter.
    assert coarse.certificate.relative_error["peak_pressure"] < 0.07
    assert coarse.peak_pressure == pytest.approx(fine.peak_pressure, rel=1e-3)


def test_an_indenter_that_is_flat_in_double_precision_is_refused():
    flat = kv.Scene(indenter=kv.Parabola("1e308 m"))
    with pytest.raises(ValueError, match="leaves the range of double precision: check"):
        kv.elements(flat, per_length="50 /mm")
