"""A ball by elements in strips: against steady sliding, closed-form edges, and a sheet of points."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.elements import kernels
from kvtheory.models.elements import model as elements_model
from kvtheory.models.elements.model import Model, span
from kvtheory.models.elements.row import ElementRow, IndenterState
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.scene.static_state import StaticState
from tests.spring_random import of_unit_scales
from tests.test_ball import GRIPS, WIDER
from tests.test_elements_certificate import errors
from tests.transient_ball import sheet, sheet_on_spring


def ball(support, velocity=0.1, end=0.3, foundation=None):
    foundation = foundation or kv.Foundation("10 GN/m^3", "20 ms")
    return kv.Scene(WIDER, foundation, support, kv.Drive(velocity), kv.Run(end))


def test_strips_with_closed_form_edges_agree_at_constant_depth():
    history = [["0 s", "0 m/s"], ["4 ms", "0.1 m/s"], ["60 ms", "50 mm/s"], ["80 ms", "0.2 m/s"]]
    scene = replace(ball(GRIPS["fixed"]), drive=kv.Drive(history=history), run=kv.Run(0.08))
    times = np.linspace(0.0, 0.08, 23)
    truth, run = kv.solve(scene, at=times), kv.elements(scene, per_length="80 /mm", at=times)
    for name, error in errors(run, {n: getattr(truth, n) for n in TRANSIENT_UNITS}, scene).items():
        assert error <= max(run.certificate.relative_error[name], 1e-9), name
        assert error < (2e-3 if "edge" in name or "friction" in name else 4e-4), name


EPSILON, END = 0.05, 1.2
PIECES = {
    "start": [(END, 3.0)],
    "stop": [(0.6, 3.0), (END, 0.0)],
    "reversal": [(0.6, 3.0), (END, -2.0)],
}


@pytest.mark.parametrize(("motion", "kappa"), [("start", 0.0), ("stop", 0.7), ("reversal", 0.0)])
def test_a_ball_that_rises_against_a_sheet_of_points(motion, kappa):
    """Two computations that share nothing: rims that lift, stops, and ground met again."""
    pieces, history, begun = PIECES[motion], [], 0.0
    for end, number in pieces:
        history += [(begun, number), (end, number)]
        begun = end
    scene = of_unit_scales(EPSILON, kappa, kv.Drive(history=history), END, ball=True)
    s, d, f_z = sheet(pieces, EPSILON, kappa, 80, 2e-3)
    rows = [int(np.argmin(np.abs(s - at))) for at in (0.1, 0.3, 0.59, 0.7, 0.9, 1.19)]
    run = kv.elements(scene, per_length=200.0, at=s[rows].tolist())
    assert np.abs(run.depth - d[rows]).max() < 1.5e-4
    assert np.abs(run.depth - d[rows]).max() < run.certificate.relative_error["depth"]
    assert np.abs(run.normal_force - f_z[rows]).max() < 5e-3


def test_order_in_both_spacings():
    """Elements, steps and strips together: order two, against strips with closed-form edges."""
    scene = ball(GRIPS["fixed"], 0.05, 0.01)
    truth = kv.solve(scene, at=[0.01])
    densities, left = [50e3, 100e3, 200e3], []
    for density in densities:
        runs = [
            kv.elements(scene, per_length=factor * density, at=[0.01], certify=False)
            for factor in (0.9, 1.0, 1.1)
        ]
        left.append(max(abs(run.friction_force[0] / truth.friction_force[0] - 1.0) for run in runs))
    assert -np.polyfit(np.log(densities), np.log(left), 1)[0] > 1.8


def test_extremes_of_a_ball():
    """At rest, without inertia, with huge inertia, in flight: numbers, and no warning."""
    rest = kv.elements(ball(GRIPS["dead-weight"], 0.0, 0.1), at=[0.1], certify=False)
    assert rest.normal_force[0] == pytest.approx(9.8, rel=1e-5)
    assert abs(rest.friction_force[0]) < 1e-9
    for mass in (1e-9, 1e9):
        scene = ball(kv.DeadWeight(mass=mass, gravity=9.8 / mass), 0.02, 0.01)
        run = kv.elements(scene, per_length="20 /mm", at=[0.01], time_step="0.1 ms", certify=False)
        assert np.isfinite([run.depth, run.normal_force, run.leading_edge]).all()
    light = ball(kv.DeadWeight(mass="100 g"), 20.0, 5e-4)
    flown = kv.elements(light, per_length="20 /mm", time_step="2 us", certify=False)
    assert (np.isnan(flown.leading_edge) == (flown.normal_force == 0.0)).all()
    assert np.isnan(flown.leading_edge).any()


def test_strips_are_added_where_the_ball_sinks():
    """From a fifth of its depth it sinks to where it rests, on strips that were not there at first."""
    model = Model.of(ball(GRIPS["dead-weight"], 0.0, 0.5), 2e-5, parts=True)
    row, c = ElementRow(model.constants, kv.Drive(0.0).motion(0.5, 0.1)), model.constants
    row.lay(0.2 * c.depth, lambda x, y: np.maximum(0.2 * c.depth - model.height(x, y), 0.0))
    begun, state = row.stored.counts.strips, IndenterState(0.0, 0.2 * c.depth, 0.0)
    for _ in range(250):
        state = row.step(state, 2e-3)
    rims = [span(c.surface, share * c.depth)[1] * WIDER.stretch for share in (0.2, 1.0)]
    assert begun == 1 + int(rims[0] / c.across)
    assert row.stored.counts.strips >= 1 + int(rims[1] / c.across)
    assert state.depth == pytest.approx(c.depth, rel=1e-6)


def test_solve_takes_the_cheapest_model_of_a_ball():
    fixed, risen = ball(GRIPS["fixed"], end=0.05), ball(GRIPS["dead-weight"], end=0.05)
    ramp = replace(fixed, drive=kv.Drive(history=[["0 s", "0 m/s"], ["20 ms", "0.1 m/s"]]))
    turned = kv.Drive(history=[["0 s", "9 mm/s"], ["20 ms", "9 mm/s"], ["20 ms", "-9 mm/s"]])
    models = {"exact": [fixed, ramp], "elements": [replace(fixed, drive=turned), risen]}
    for model, scenes in models.items():
        for scene in scenes:
            found = kv.solve(scene, at=[0.01, 0.05], rtol=2e-2, quantity="depth")
            assert found.model == model


HUNG = kv.Drive("100 mm/s", stiffness="10 kN/m", damping="2 N*s/m", mass="50 g")
"""Holds a ball along x so softly that it swings."""


@pytest.mark.parametrize("support", ["dead-weight", "suspended"])
def test_a_ball_on_a_spring_moves_as_a_sheet_of_points(support):
    scene = replace(ball(GRIPS[support], end=0.03), drive=HUNG)
    at_rest = StaticState.of(scene)
    s, *found = sheet_on_spring(at_rest, 0.03 / at_rest.time, 40.0, 0.01)
    run = kv.elements(scene, per_length="40 /mm", at=(s * at_rest.time).tolist(), certify=False)
    names = ("depth", "sliding_velocity", "spring_force")
    measures = (at_rest.depth, at_rest.velocity, at_rest.friction_force)
    assert np.ptp(run.sliding_velocity) > 0.5 * HUNG.velocity
    for name, expected, measure in zip(names, found, measures, strict=True):
        assert np.abs(getattr(run, name) / measure - expected).max() < 5e-3, name


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_scheme_carries_a_ball_on_a_spring(scheme):
    scene = replace(ball(GRIPS["suspended"], end=0.02), drive=HUNG)
    runs = [
        kv.elements(
            scene, per_length=density, scheme=name, time_step=8.0 / density, at=[5e-3, 20e-3], certify=False
        )
        for density, name in ((20e3, scheme), (40e3, scheme), (80e3, "edge-corrected"))
    ]  # fmt: skip
    names = ("depth", "sliding_velocity", "spring_force")
    truth = {name: getattr(runs[-1], name) for name in names}
    rough, fine = (max(errors(run, truth, scene).values()) for run in runs[:2])
    assert fine < 0.15
    assert math.log2(rough / fine) > min(SCHEMES[scheme].row.order_in_time, 2) - 0.3


def test_strips_are_weighed_by_the_contact_halfway_through_a_step():
    """A sinking ball; edge-corrected weights end at its rim."""
    scene = ball(GRIPS["dead-weight"])
    model = Model.of(scene, 1e-4, parts=True)
    c, h = model.constants, 2e-4
    row = ElementRow(c, model.path(scene))
    rate = 0.1 * c.depth / h
    row.step(IndenterState(0.0, c.depth, rate), h)
    rim = c.surface.stretch * kernels.extent(c.surface, c.depth + 0.5 * h * rate, 1.0)
    expected = kernels.weigh(np.empty_like(row.stored.weights), c.across, rim)
    np.testing.assert_array_equal(row.stored.weights, expected)


@pytest.mark.parametrize("stiffness", [1e8, 1e11])
@pytest.mark.parametrize("shape", [kv.Sphere(0.01), kv.Parabola(0.01), kv.Wedge(inclination=0.1)])
def test_the_depth_at_rest_is_found_in_few_steps_from_anywhere(monkeypatch, shape, stiffness):
    """The logarithm of the force over that of the depth is a straight line, but for whole elements."""
    scene, calls, contact = (
        kv.Scene(shape, kv.Foundation(stiffness, 0.05)),
        [],
        elements_model.contact,
    )
    monkeypatch.setattr(elements_model, "contact", lambda *a: calls.append(a) or contact(*a))
    found = Model.of(scene)
    assert found.contact.force == pytest.approx(scene.support.weight, rel=1e-9)
    assert len(calls) <= 10
