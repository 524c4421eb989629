"""Balls and bodies of revolution: quadrature over strips, other foundations, the footprint, units."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import kvtheory as kv
from kvtheory.ladder.series import never_steady
from kvtheory.models.steady import revolved
from kvtheory.models.steady.ball import (
    FRICTION_COEFFICIENT_ERROR,
    LOAD_ERROR,
    SHORTER,
    WIDTH,
)
from kvtheory.results import STEADY_UNITS
from tests.steady import agree, at_depth

BALL = kv.Scene(indenter=kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
WIDER = kv.Sphere("10 mm", radius_across="25 mm")
GRIPS = {
    "fixed": kv.Fixed(depth=1e-4),
    "dead-weight": kv.DeadWeight(load="9.8 N"),
    "suspended": kv.Suspended(mass="1 kg", stiffness="30 kN/m"),
}
V = "drive.velocity"
SPEEDS = np.array([0.0, 1e-8, 1e-4, 1e-3, 1e-2, -0.03, 0.1, 1.0, -1e3, 1e8])


@pytest.mark.parametrize("support", GRIPS)
def test_quadrature_agrees_within_its_certificate(support):
    scene = kv.Scene(indenter=WIDER, support=GRIPS[support])
    found, truth = (kv.steady(scene, over={V: SPEEDS}, method=m) for m in ("quadrature", "exact"))
    agree(found, truth, 1e-12)
    units = {**STEADY_UNITS, "load": "N", "friction_force": "N", V: "m/s"}
    assert found.units == truth.units == units


@pytest.mark.parametrize("slope", [0.03, 0.3])
def test_a_cone_at_any_velocity(slope):
    """The strips next to its axis have a sharp tip; fast, W = C V delta b and mu = (pi/4) slope."""
    velocity = np.geomspace(1e-3, 1e4, 15)
    scene = kv.Scene(indenter=kv.Revolved(kv.Wedge(slope)), support=kv.Fixed(depth=1e-4))
    found = kv.steady(scene, over={V: velocity})
    l = found.retardation_length / found.half_length
    fast = l > 10.0
    viscous = 1e10 * found.retardation_length * 1e-4 * found.half_length
    for ratio in (found.load / viscous, found.friction_coefficient / (np.pi / 4 * slope)):
        assert (np.abs(ratio[fast] - 1.0) < 2.0 / l[fast]).all()
    assert (np.diff(found.load) > 0.0).all()


def by_definition(profile, l_r, depth, rim, kink=0.0):
    """W/K and F/K of a convex profile of revolution, by adaptive quadrature of p over x and over y."""

    @cache
    def strip(y):
        cut, end = np.sqrt(max(kink * kink - y * y, 0.0)), np.sqrt((rim - y) * (rim + y))

        def slope(x):
            rho = math.hypot(x, y)
            return float(profile.slope(rho)) * x / rho

        def gap(x):
            return depth - float(profile.height(math.hypot(x, y)))

        cuts = [-end, -cut, 0.0]
        for low, high in ((0.0, cut), (cut, end)):
            near, far = low + 1e-13 * (high - low), high - 1e-13 * (high - low)
            if high > low and gap(near) > l_r * slope(near):
                falls = gap(far) < l_r * slope(far)
                cuts.append(brentq(lambda x: gap(x) - l_r * slope(x), near, far) if falls else high)
        u_te = gap(cuts[-1])
        pieces = [ends for ends in pairwise(cuts) if ends[1] > ends[0]]
        area, drag = (
            sum(quad(f, *ends, epsabs=0.0, epsrel=1e-10, limit=500)[0] for ends in pieces)
            for f in (gap, lambda x: slope(x) ** 2)
        )
        return area + l_r * u_te, 0.5 * u_te * u_te + l_r * drag

    def total(which):
        return quad(
            lambda t: 2.0 * rim * np.cos(t) * strip(rim * np.sin(t))[which], 0.0, 0.5 * np.pi,
            epsabs=0.0, epsrel=1e-9, limit=200, points=[np.arcsin(kink / rim)] if kink else None,
        )[0]  # fmt: skip

    return total(0), total(1)


KINK = 3e-4
BENT = kv.Profile(
    lambda x: 0.05 * abs(x) + 0.2 * max(abs(x) - KINK, 0.0),
    lambda x: math.copysign(0.05 + 0.2 * (abs(x) > KINK), x),
    kinks=(-KINK, 0.0, KINK),
)
"""A cone with two slopes, whose trailing edge stays at the kink in some strips."""


@pytest.mark.parametrize(
    ("profile", "rim", "kink"),
    [
        (kv.Circle(radius=2e-3), np.sqrt(2e-3**2 - 1.9e-3**2), 0.0),
        (kv.PowerLaw(length=1e-2, exponent=4.0), (4e-6 * 1e-4) ** 0.25, 0.0),
        (kv.Wedge(inclination=0.1), 1e-3, 0.0),
        (BENT, KINK + (1e-4 - 0.05 * KINK) / 0.25, KINK),
    ],
    ids=["circle", "power law", "cone", "cone of two slopes"],
)
@pytest.mark.parametrize("velocity", [1e-3, 0.1])
def test_profiles_of_revolution_against_their_definition(profile, rim, kink, velocity):
    scene = kv.Scene(kv.Revolved(profile), support=kv.Fixed(1e-4), drive=kv.Drive(velocity))
    found, sought = kv.steady(scene), by_definition(profile, 0.1 * velocity, 1e-4, rim, kink)
    for name, value in zip(("load", "friction_force"), sought, strict=True):
        assert getattr(found, name) == pytest.approx(1e10 * value, rel=1e-9)
        assert found.certificate.relative_error[name] < 1e-9


def test_the_maximum_of_a_dead_weight():
    report = kv.asymptotes(BALL)
    top = kv.steady(BALL, over={V: report.peak_velocity * np.array([0.99, 1.0, 1.01])})
    l = top.retardation_length / top.half_length
    assert l[1] == pytest.approx(1.842345, abs=5e-7)
    assert top.friction_coefficient[1] == pytest.approx(report.peak_friction_coefficient, rel=1e-14)
    assert top.friction_coefficient[1] > top.friction_coefficient[[0, 2]].max()
    assert report.units["load"] == "N"
    edge = report.lines[1].velocity_min
    limit, exact = (
        kv.steady(BALL, over={V: edge}, method=method).friction_coefficient
        for method in ("asymptote", "exact")
    )
    assert abs(limit / exact - 1.0) == pytest.approx(report.tolerance, rel=1e-9)


@pytest.mark.parametrize("kind", ["maxwell", "fractional"])
def test_other_foundations_against_a_sum_of_their_strips(kind):
    rng = np.random.default_rng(17)
    nodes, weights = np.polynomial.legendre.leggauss(300)
    t, weights = 0.25 * np.pi * (nodes + 1), 0.25 * np.pi * weights
    for _ in range(5):
        arms = [[10 ** rng.uniform(8, 12), 10 ** rng.uniform(-8, 2)] for _ in range(3)]
        foundation = kv.GeneralizedMaxwell(1e10, arms=arms)
        if kind == "fractional":
            foundation = kv.FractionalKelvinVoigt(1e10, 0.1, rng.uniform(0.05, 0.98))
        drive = kv.Drive(velocity=10 ** rng.uniform(-5, 2))
        scene = kv.Scene(kv.Sphere(0.01), foundation, kv.Fixed(depth=3e-4), drive)
        found = kv.steady(scene)
        line = kv.Scene(kv.Parabola(0.01), foundation, kv.Fixed(depth=3e-4), drive)
        rows = kv.steady(line, over={"support.depth": 3e-4 * np.cos(t) ** 2})
        dy = 2.0 * found.half_length * np.cos(t) * weights
        assert found.load == pytest.approx((rows.load * dy).sum(), rel=2e-12)
        assert found.friction_force == pytest.approx((rows.friction_force * dy).sum(), rel=2e-12)
        lost = (rows.friction_force * rows.dissipated_in_contact * dy).sum() / found.friction_force
        assert found.dissipated_in_contact == pytest.approx(lost, rel=1e-11)
        weight = kv.Scene(kv.Sphere(0.01), foundation, kv.DeadWeight(load=found.load), drive)
        assert kv.steady(weight).depth == pytest.approx(3e-4, rel=2e-11)


MAXWELL = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]])
FRACTIONAL = kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)


@pytest.mark.parametrize(
    ("foundation", "support", "velocity"),
    [(MAXWELL, "suspended", -0.1), (FRACTIONAL, "fixed", 3.0)],
    ids=["maxwell", "fractional"],
)
def test_other_foundations_by_quadrature(foundation, support, velocity):
    """Both methods share no code: moments without roots, and convolution in each strip."""
    scene = kv.Scene(WIDER, foundation, GRIPS[support], kv.Drive(velocity))
    found, truth = kv.steady(scene, method="quadrature"), kv.steady(scene)
    agree(found, truth, 1e-11)
    assert found.units == truth.units


def test_a_cone_on_the_springpot_of_order_one_is_on_kelvin_voigt():
    laws = kv.FractionalKelvinVoigt(1e10, 0.1, 1.0), kv.Foundation(1e10, 0.1)
    rest = kv.Fixed(1e-4), kv.Drive(0.01)
    agree(*(kv.steady(kv.Scene(kv.Revolved(kv.Wedge(0.3)), law, *rest)) for law in laws))


def test_a_cone_on_an_arm():
    """Fast, the foundation is a stiffer spring: W = G(0) pi b^2 delta/3."""
    arm = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"]])
    found = kv.steady(kv.Scene(kv.Revolved(kv.Wedge(0.3)), arm, kv.Fixed(1e-4), kv.Drive(1e6)))
    whole = 4e10 * np.pi / 3 * found.half_length**2 * 1e-4
    assert found.model == "quadrature"
    assert found.load == pytest.approx(whole, rel=1e-6)


def test_the_footprint_carries_the_forces():
    for velocity in (0.01, -0.01):
        scene = kv.Scene(WIDER, support=kv.Fixed(1e-4), drive=kv.Drive(velocity))
        state, found = kv.steady(scene), kv.footprint(scene)
        assert found.half_width == pytest.approx(found.half_length * 2.5**0.5)
        x = np.linspace(-found.half_length, found.half_length, 1201)
        y = np.linspace(-found.half_width, found.half_width, 1201)[:, None]
        p = found.pressure(x, y)
        area = (x[1] - x[0]) * (y[1, 0] - y[0, 0])
        assert p.sum() * area == pytest.approx(state.load, rel=2e-3)
        assert (-x / 0.01 * p).sum() * area == pytest.approx(state.friction_force, rel=5e-3)
        assert p.max() == pytest.approx(state.peak_pressure, rel=1e-3)
        edges = found.edges(0.0)
        assert edges == pytest.approx((state.leading_edge, state.trailing_edge))


def test_a_line_contact_stands_for_the_ball():
    speeds = np.geomspace(1e-8, 1e8, 2001)
    rest = {"K": 1.0, "tau": 1.0, "V": speeds}
    found = at_depth(kv.Sphere(1.0), depth=1.0, **rest)
    line = at_depth(1.0, depth=SHORTER**2, **rest)
    load = WIDTH * found.half_length * line.load / found.load - 1.0
    mu = line.friction_coefficient / found.friction_coefficient - 1.0
    assert 0.9 * LOAD_ERROR < np.abs(load).max() < LOAD_ERROR
    assert 0.9 * FRICTION_COEFFICIENT_ERROR < np.abs(mu).max() < FRICTION_COEFFICIENT_ERROR
    assert np.abs([load[0], load[-1], mu[0], mu[-1]]).max() < 1e-7


def test_a_ball_at_a_constant_depth_slides_steadily_at_every_instant():
    """By closed forms, against elements that follow the surface."""
    history = [(0.0, 0.0), (0.05, -0.04), (0.05, -0.1), (0.2, -0.09)]
    scene = kv.Scene(WIDER, support=kv.Fixed(depth=1e-4), drive=kv.Drive(history=history))
    found = kv.solve(scene, at="2 ms:198 ms:41", rtol=1e-9)
    assert found.model == "exact"
    assert found.units["normal_force"] == "N"
    run = kv.elements(scene, per_length="60 /mm", at="2 ms:198 ms:41")
    scale = kv.steady(scene, over={V: 0.0}).load
    for name in ("normal_force", "friction_force"):
        error = np.abs(getattr(found, name) - getattr(run, name)).max() / scale
        assert error <= min(run.certificate.relative_error[name], 1e-3)


@pytest.mark.parametrize(
    ("end", "words"),
    [("0 m/s", "stops"), ("-10 mm/s", "reverses"), ("1 mm/s", "too fast")],
)
def test_a_drive_that_the_foundation_remembers_is_refused(end, words):
    drive = kv.Drive(history=[["0 s", "100 mm/s"], ["100 ms", "100 mm/s"], ["100.1 ms", end]])
    scene = kv.Scene(WIDER, support=kv.Fixed(depth=1e-4), drive=drive)
    assert words in never_steady(scene)
    assert kv.solve(scene, at=["0.1 s"], rtol=0.1, quantity="depth").model == "elements"


@pytest.mark.parametrize(
    ("overrides", "units"),
    [
        ([], {"support.mass": "kg"}),
        (["support.kind=suspended"], {"support.mass": "kg", "support.stiffness": "N/m"}),
        (["support.kind=suspended", "support.mass=1 kg"], {"support.stiffness": "N/m"}),
        (["support.kind=fixed", "drive.stiffness=1 N/mm"], {"drive.mass": "kg"}),
    ],
)
def test_a_ball_on_the_built_in_scene_is_told_what_it_needs_and_nothing_that_it_did_not_give(
    overrides, units
):
    with pytest.raises(kv.SceneError) as caught:
        kv.load_scene(overrides=["indenter.shape=sphere", *overrides])
    told = caught.value.problems
    assert [line.split(": missing")[0] for line in told] == list(units)
    for line, unit in zip(told, units.values(), strict=True):
        assert f"expected a quantity in {unit}," in line
        assert "1000" not in line
    enough = kv.load_scene(overrides=["indenter.shape=sphere", "support.load=5 N"])
    assert enough.support == kv.DeadWeight(load=5.0)


def test_every_output_is_in_whole_units(tmp_path):
    state = kv.steady(BALL)
    assert kv.steady(BALL, over={"support.load": ["3 N"]}).load == pytest.approx([3.0])
    assert "load 9.80665 N" in repr(state)
    state.to_csv(tmp_path / "state.csv")
    head = (tmp_path / "state.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "load [N],friction_force [N]" in head
    assert state.to_xarray()["load"].attrs["units"] == "N"
    swept = kv.sweep(BALL, over={"support.mass": ["1 kg", "2 kg"]}, quantities="load")
    assert (swept.units["support.mass"], swept.units["load"]) == ("kg", "N")
    ax = swept.plot("load")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mass $M$ [kg]", "load $W$ [N]")
    solved = kv.solve(BALL, quantity="load")
    assert (solved.model, solved.units["load"]) == ("asymptote", "N")  # it is the weight
    assert "load 9.80665 N" in repr(solved)
    others = {"stable", "notes", "model", "certificate", "pressure_field"}
    assert set(state.as_dict()) == {*STEADY_UNITS, *others}


@pytest.mark.parametrize("worst", ["load", "friction"])
def test_the_sums_over_strips_are_as_wrong_as_the_worse_of_both(worst, monkeypatch):
    strip, doubt = revolved.Strips._strip, {"load": 1e-12, "friction": 1e-12} | {worst: 1e-8}

    def doubtful(*given):
        rows = strip(*given)
        for k, name in enumerate(doubt):
            if len(rows) > 3 * k:
                rows[3 * k + 2] = doubt[name] * rows[3 * k]
        return rows

    monkeypatch.setattr(revolved.Strips, "_strip", doubtful)
    scene = kv.Scene(indenter=kv.Revolved(kv.Circle(0.01)), support=kv.Fixed(1e-4))
    errors = kv.steady(scene, method="quadrature").certificate.relative_error
    assert 1e-8 <= errors["friction_force"] < 2e-8
    assert 1e-8 <= errors["load"] < 2e-8


def test_of_a_revolved_profile_only_the_side_x_above_0_counts():
    """A measured profile is never quite even; the middle plane of its body is, with its tip."""
    lopsided = kv.Profile(
        lambda x: 0.1 * abs(x) + 900 * x**3, lambda x: math.copysign(0.1, x) + 2700 * x**2,
        kinks=(-1e-3, 0.0),
    )  # fmt: skip
    body, x = kv.Revolved(lopsided), np.array([-2e-3, -1e-3, 1e-3, 2e-3])
    assert body.profile.height(x) == pytest.approx(0.1 * abs(x) + 900 * abs(x) ** 3, rel=1e-15)
    slope = np.sign(x) * (0.1 + 2700 * x**2)
    assert body.profile.slope(x) == pytest.approx(slope, rel=1e-15)
    assert body.profile.slope(0.0) == 0.0
    assert body.profile.kinks == (0.0,)
    assert body.height(-1e-3) == body.profile.height(-1e-3)
