"""Elements under an indenter on a spring: against the continuum, its energy, its limits, its orders."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import ElementRow, IndenterState
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.elements.stability import lengths, limit_at
from kvtheory.results import SERIES_UNITS
from tests import SUPPORTS, spring_reference
from tests.spring_random import in_si
from tests.test_elements_certificate import errors

TABLE_1 = kv.Scene(
    drive=kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2", damping="2 kN*s/m^2"), run=kv.Run(0.02)
)
STOP_AND_BACK = [(0.0, 0.1), (0.05, 0.1), (0.05, 0.0), (0.08, 0.0), (0.08, -0.1)]
TURNED = kv.Scene(drive=kv.Drive(history=STOP_AND_BACK), run=kv.Run(0.1))
HARD = (
    "light along x", "overdamped", "suspended", "fixed, soft", "fixed, stop", "stop", "stop, soft",
    "reversal", "to and fro", "stick-slip", "hop",
)  # fmt: skip
"""Of the reference scenes: all supports, stops, reversals, stick-slip, backward sliding and flight."""


@pytest.mark.parametrize("name", HARD)
def test_elements_agree_with_the_continuum_and_the_certificate_covers(name):
    given = spring_reference.SCENES[name]
    scene, times = in_si(given), given.times
    run = kv.elements(scene, per_length=40.0, at=times)
    truth = kv.transient(scene, at=times, rtol=1e-8, certify=False)
    found, claimed = errors(run, truth, scene), run.certificate.relative_error
    assert set(claimed) == set(SERIES_UNITS)
    for quantity, error in found.items():
        assert error <= claimed[quantity], quantity
    assert max(found[quantity] for quantity in ("depth", "spring_force")) < 4e-3


def test_edges_may_change_places_where_sliding_may_go_either_way():
    history = [(0.0, 0.112), (0.134, 0.112), (0.134, -0.03)]
    drive = kv.Drive(history=history, stiffness=0.926, damping=0.0615, mass=0.22)
    support = kv.DeadWeight(mass=0.166, gravity=8.03)
    scene = kv.Scene(kv.Parabola(0.5), kv.Foundation(1.0, 1.0), support, drive, kv.Run(0.6))
    run = kv.elements(scene, per_length=10.0, at=[0.4, 0.57])
    truth = kv.transient(scene, at=[0.4, 0.57], rtol=1e-8, certify=False)
    assert run.sliding_velocity[1] < 0.0 < truth.sliding_velocity[1]
    off = np.abs(run.leading_edge - truth.leading_edge).max() / Model.of(scene).at_rest.half_length
    assert 1.9 < off < run.certificate.relative_error["leading_edge"]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_order_of_every_scheme(scheme):
    """In time and spacing together: the first at least, and the second with the parts of elements."""
    times, found = [0.005, 0.01, 0.02], []
    truth = kv.transient(TABLE_1, at=times, rtol=1e-9, certify=False)
    densities = np.array([25e3, 50e3, 100e3])
    for density in densities:
        run = kv.elements(
            TABLE_1, per_length=density, scheme=scheme, at=times, certify=False, time_step=2.0 / density
        )  # fmt: skip
        found.append(errors(run, truth, TABLE_1))
    a_0 = Model.of(TABLE_1).at_rest.half_length
    for name in ("depth", "sliding_velocity", "spring_force"):
        column = np.array([each[name] for each in found])
        assert np.max(column * densities * a_0) < 0.3, name
        if scheme == "edge-corrected":
            order = -np.polyfit(np.log(densities), np.log(column), 1)[0]
            assert order == pytest.approx(2.0, abs=0.15), name


def compressed(row):
    """Return u of all stored elements of a line contact, and the forces of their arms."""
    stored, law = row.stored, row.constants.law
    modes, touched = row.stored.modes[:, 0] * row.faded[:, None], stored.elements.touched[0]
    u = np.where(touched, stored.elements.u[0], law.shares @ modes)
    arms = law.arm_stiffness.size
    free = law.arm_stiffness[:, None] * (u - law.from_modes @ modes) if arms else modes[:0]
    return u, np.where(touched, stored.modes[:arms, 0], free)


def energies(row, state, h, count):
    """Return the energy of a Kelvin-Voigt scene on a drive at rest, over so many steps."""
    c, found = row.constants, []
    for _ in range(count):
        risen = c.depth - state.depth
        moving = c.mass * state.rate**2 if math.isfinite(c.mass) else 0.0
        moving += c.mass_along * state.along_rate**2 + c.spring_along * state.along**2
        lifted = c.weight * risen if math.isfinite(c.mass) else 0.0
        springs = c.law.stiffness * c.spacing * float(np.square(compressed(row)[0]).sum())
        found.append(0.5 * (moving + c.spring * risen**2 + springs) + lifted)
        state = row.step(state, h)
    return np.array(found)


@pytest.mark.parametrize("h", [1e-4, 1e-2, 0.2])
@pytest.mark.parametrize("support", SUPPORTS)
def test_no_step_gains_energy_however_long(support, h):
    """The mean forces do the work by which elements are compressed: swings, hops and all."""
    drive = kv.Drive(velocity=0.0, stiffness="0.1 MN/m^2", mass="0.2 kg/mm")
    scene = kv.Scene(support=kv.Scene.table1(support).support, drive=drive)
    model = Model.of(scene, 2e-5)
    row = ElementRow(model.constants, model.path(scene), SCHEMES["exponential"], 1e7)
    start = IndenterState(0.0, model.at_rest.depth, 0.0, along_rate=0.02)
    energy = energies(row, start, h, 60)
    assert energy[0] > energy[-1]
    assert np.all(np.diff(energy) <= 1e-6 * (energy[0] - energy[-1]))


@pytest.mark.parametrize("shape", [kv.Parabola(0.01), kv.Circle(0.01), kv.PowerLaw(0.01, 4.0)])
def test_the_energy_of_arms_on_a_spring_is_balanced(shape):
    """What the drive does is kinetic, potential, stored or lost, also where elements are left and met."""
    arms = [["30 GN/m^3", "10 ms"], ["5 GN/m^3", "50 ms"]]
    drive = kv.Drive(velocity=0.1, stiffness=1e6, damping=1e3, mass=300.0)
    rubber = kv.GeneralizedMaxwell("10 GN/m^3", arms=arms)
    scene = kv.Scene(shape, rubber, drive=drive, run=kv.Run(0.04))
    lacking = []
    for density in (1e4, 2e4, 4e4):
        model = Model.of(scene, 1.0 / density)
        c, h = model.constants, 4.0 / density
        row = ElementRow(c, model.path(scene), SCHEMES["exponential"])
        state, rows = IndenterState(0.0, c.depth, 0.0), []
        K_i, tau = c.law.arm_stiffness[:, None], c.law.arm_time[:, None]
        for _ in range(round(0.04 / h) + 1):
            u, s = compressed(row)
            springs = c.law.stiffness * u @ u + (s * s / K_i).sum()
            moving = c.mass * state.rate**2 + c.mass_along * state.along_rate**2
            held = 1e6 * state.along + 1e3 * state.along_rate
            rows.append((
                0.5 * (moving + 1e6 * state.along**2 + c.spacing * springs)
                - c.weight * state.depth,
                c.spacing * (s * s / (K_i * tau)).sum() + 1e3 * state.along_rate**2,
                0.1 * held,
            ))  # fmt: skip
            last, state = state, row.step(state, h)
        stored, lost, power = np.array(rows).T
        # That of friction on the base, F_x = k_x x + c_x x' + M_x x''.
        work = np.trapezoid(power, dx=h) + 0.1 * c.mass_along * last.along_rate
        lacking.append(abs(stored[-1] - stored[0] + np.trapezoid(lost, dx=h) - work) / work)
    assert lacking[-1] < 2e-3
    assert lacking[0] / lacking[-1] > 3.0


@pytest.mark.parametrize(
    ("scene", "name", "taus", "bound"),
    [(TABLE_1, "spring_force", (2e-4, 1e-4), 0.02), (TURNED, "depth", (1e-4, 5e-5), 1e-3)],
)
def test_fast_arms_are_the_damper_of_the_continuum_in_first_order(scene, name, taus, bound):
    """A Prony series whose arms are over at once, K_1 tau_1 = C, against another model on Kelvin-Voigt."""
    times = (np.array([0.25, 0.5, 0.7, 1.0]) * scene.run.duration).tolist()
    truth, far = kv.transient(scene, at=times, rtol=1e-8, certify=False), []
    for tau in taus:
        fast = replace(scene, foundation=kv.GeneralizedMaxwell(1e10, arms=[(1e9 / tau, tau)]))
        run = kv.elements(fast, per_length="100 /mm", at=times, certify=False)
        far.append(errors(run, truth, scene)[name])
    assert far[1] < bound
    assert far[0] / far[1] == pytest.approx(2.0, abs=0.4 if name == "spring_force" else 0.2)


@pytest.mark.parametrize("damping", ["0 N*s/m^2", "1 MN*s/m^2"])
def test_the_stable_step_of_a_light_mass_along_x(damping):
    """The damping of the contact along x, C ∫ h'^2 dx/M_x, bounds the step as C L/M does (F15)."""
    drive = kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2", mass="1 g/mm", damping=damping)
    scene = kv.Scene(drive=drive, run=kv.Run(0.02))
    model = Model.of(scene, 1e-5)
    limit = limit_at(SCHEMES["paper"], model.constants, max(lengths(model, model.path(scene))))
    assert limit < 0.1 * limit_at(
        SCHEMES["paper"], Model.of(kv.Scene()).constants, 2.0 * model.at_rest.half_length
    )

    def run(share):
        step = {"scheme": "paper", "time_step": share * limit, "certify": False}
        return kv.elements(scene, per_length="100 /mm", at=[0.02], **step)

    right = kv.elements(scene, per_length="100 /mm", at=[0.02], certify=False)
    assert run(0.9).spring_force[0] == pytest.approx(right.spring_force[0], rel=2e-2)
    with pytest.raises(kv.DivergenceError, match="diverged"):
        run(2.5)
