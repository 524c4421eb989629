"""The foundation of a layer of any thickness: K from its contact at rest."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import slide
from kvtheory.scene.layer import layer_stiffness
from kvtheory.theory.contact_at_rest import (
    RELATIVE_ERROR,
    depth_at_rest,
    energy_at_rest,
    load_at_rest,
    poisson_ratio,
)
from tests.commands import printed, run
from tests.layer_rest_table import entry

RUBBER = {"modulus": "1 MPa", "retardation_time": "20 ms"}
ARMS = [("4 MPa", "20 ms"), ("2 MPa", "0.5 s")]
STILL = kv.Drive(velocity=0.0)
LOADED, HELD = (
    {"line": kv.DeadWeight(load=500.0), "ball": kv.DeadWeight(load="1 N")},
    kv.Fixed(1e-4),
)
SHAPES = {"line": kv.Parabola("10 mm"), "ball": kv.Sphere("10 mm")}


def layer(thickness, nu, **own):
    return kv.Foundation(thickness=thickness, poisson_ratio=nu, **{**RUBBER, **own})


def hertz(E):
    """Depth of the ball at rest on an incompressible half-space: W = (4/3) E/(1 - nu^2) R^1/2 d^3/2."""
    return (0.75 * 1.0 * 0.75 / E / math.sqrt(0.01)) ** (2 / 3)


@pytest.mark.parametrize(
    ("name", "thickness", "nu"),
    [("line", 1e-3, 0.5), ("line", 2e-2, 0.3), ("ball", 1e-3, 0.49), ("ball", math.inf, 0.5)],
)
def test_at_rest_the_foundation_has_the_depth_and_load_of_the_body(name, thickness, nu):
    for support in (LOADED[name], HELD):
        scene = kv.Scene(SHAPES[name], layer(thickness, nu), support, STILL)
        body = slide(
            scene.indenter, Body.of_foundation(scene.foundation), 0.0, Support.of_scene(support), 5e-3
        )  # fmt: skip
        found = kv.steady(scene)
        for quantity in ("depth", "load"):
            exact = getattr(body, quantity)
            allowed = RELATIVE_ERROR + body.errors[quantity] / exact
            assert getattr(found, quantity) == pytest.approx(exact, rel=allowed)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.45])
def test_on_a_thin_layer_the_stiffness_is_its_confined_modulus(name, nu):
    thickness = np.array([1e-3, 1e-2, 0.1]) * math.sqrt(2e-6)
    found = kv.Scene(SHAPES[name], layer(thickness, nu), HELD).foundation.stiffness
    share = found / layer_stiffness(1e6, thickness, nu) - 1.0
    c = nu * (4.0 * nu - 1.0) / (3.0 * (1.0 - nu) * (1.0 - 2.0 * nu))
    h = np.array([1e-3, 1e-2])
    next_term = -(1.5 if name == "line" else 4.0) * c * h * h
    assert share[:2] == pytest.approx(next_term, abs=3e-4)
    assert np.all(np.diff(np.abs(share)) >= 0.0)


def test_a_ball_on_a_half_space_is_hertz_and_a_layer_goes_to_it():
    scene = kv.Scene(SHAPES["ball"], layer([1.0, 1e3, math.inf], 0.5), LOADED["ball"])
    depth = hertz(1e6)
    assert scene.foundation.stiffness == pytest.approx(1.0 / (math.pi * 0.01 * depth**2), rel=3e-3)
    assert np.ptp(scene.foundation.stiffness[1:]) < 1e-5 * scene.foundation.stiffness[2]


@pytest.mark.parametrize(
    ("name", "h", "share"),
    [("line", 0.05, 0.0), ("line", 0.06, 0.5), ("line", 400.0, 0.3), ("ball", 150.0, 0.1)],
)
def test_beyond_its_entries_the_table_is_the_limit(name, h, share):
    nu = float(poisson_ratio(h, share))
    found = load_at_rest(1.0, 0.5, 2.0 * (1.0 - nu**2), h, nu, per_width=name == "line")
    assert found == pytest.approx(entry(name, h, share), rel=RELATIVE_ERROR)


@pytest.mark.parametrize("per_width", [True, False])
def test_depth_and_energy_follow_from_the_load(per_width):
    rng = np.random.default_rng(5)
    H, nu = 10 ** rng.uniform(-6.0, 0.0, 500), rng.choice([0.0, 0.3, 0.49, 0.4999, 0.5], 500)
    W = 10 ** rng.uniform(-2.0, 4.0, 500)
    depth = depth_at_rest(W, 0.01, 1e6, H, nu, per_width=per_width)
    assert load_at_rest(depth, 0.01, 1e6, H, nu, per_width=per_width) == pytest.approx(W, rel=1e-9)
    one = depth_at_rest(W[7], 0.01, 1e6, H[7], nu[7], per_width=per_width)
    assert one == depth[7]
    at = [np.linspace(0.0, 1e-4, 2001)[1:], 0.01, 1e6, 1e-3, 0.49]
    loads = np.append(0.0, load_at_rest(*at, per_width=per_width))
    energy = energy_at_rest(1e-4, *at[1:], per_width=per_width)
    assert energy == pytest.approx(np.trapezoid(loads, dx=5e-8), rel=1e-4)
    # Its shallower contacts are off the table.
    deep = energy_at_rest(1e-4, 0.01, 1e6, 900.0, 0.3, per_width=per_width)
    assert 0.39 < deep / 1e-4 / load_at_rest(1e-4, 0.01, 1e6, 900.0, 0.3, per_width=per_width) < 0.5
    share = energy_at_rest([1e-9, 1e-9], 0.01, 1e6, [1e-9, 1e-3], 0.0, per_width=per_width)
    share /= 1e-9 * load_at_rest(1e-9, 0.01, 1e6, [1e-9, 1e-3], 0.0, per_width=per_width)
    assert share == pytest.approx([0.4, 0.48] if per_width else [1 / 3, 0.4], abs=0.02)


def test_scenes_by_arrays_are_scenes_one_by_one():
    over = {
        "foundation.thickness": np.array([1e-4, 2e-3, math.inf]), "foundation.poisson_ratio": [[0.3], [0.5]],
    }  # fmt: skip
    rubber = kv.GeneralizedMaxwell(modulus="1 MPa", thickness="1 mm", poisson_ratio=0.4, arms=ARMS)
    ball = kv.Scene(SHAPES["ball"], rubber, LOADED["ball"])
    many = ball.replace(over)
    found = kv.steady(many)
    assert many.shape == found.depth.shape == (2, 3)
    for i, j in np.ndindex(2, 3):
        H, nu = over["foundation.thickness"][j], over["foundation.poisson_ratio"][i][0]
        one = ball.replace({"foundation.thickness": H, "foundation.poisson_ratio": nu})
        assert kv.steady(one).friction_force == found.friction_force[i, j]
        arm = one.foundation.arms[1]
        assert arm.stiffness == pytest.approx(2.0 * one.foundation.stiffness)
    swept = kv.sweep(ball, over={"support.load": [0.1, 1.0]}, quantities="depth")
    alone = ball.replace({"support.load": 0.1})
    assert swept["depth"][0] == kv.steady(alone).depth
    assert alone.foundation.stiffness > ball.foundation.stiffness
    assert alone.flat() is not alone
    voigt = replace(ball, foundation=layer("1 mm", 0.5))
    assert voigt.replace({"foundation.stiffness": 1e9}).foundation.modulus is None


def test_the_motion_the_simulator_and_stability_take_this_stiffness():
    scene = kv.Scene(SHAPES["line"], layer("2 mm", 0.5), LOADED["line"], kv.Drive(0.05))
    plain = replace(scene, foundation=scene.foundation.plain())
    for ask in (
        lambda each: kv.transient(each, at=[0.01]).depth,
        lambda each: kv.elements(each, at=[0.01], per_length=5e3, certify=False).depth,
        lambda each: kv.stability(each, quantity="critical_stiffness").critical_stiffness,
        lambda each: kv.asymptotes(each).critical_velocity,
    ):
        assert np.array_equal(ask(scene), ask(plain), equal_nan=True)
    for shape in (kv.Wedge(0.1), kv.Sphere(0.01, radius_across=0.02)):
        bare = replace(scene, indenter=shape, support=kv.Fixed(1e-4))
        with pytest.raises(ValueError, match='stiffness_from = "thin"'):
            kv.steady(bare)
    thin = replace(scene, foundation=layer("2 mm", 0.3, stiffness_from="thin"))
    assert replace(thin, indenter=kv.Wedge(0.1)).foundation.stiffness == layer_stiffness(
        1e6, 2e-3, 0.3
    )


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"thickness": "inf"}, "foundation.thickness = inf: a line contact has no depth"),
        ({"thickness": "100 km"}, "at most 1e+06 half lengths"),
        ({"poisson_ratio": "0.51"}, "of at most 0.5"),
        ({"poisson_ratio": "0.5", "stiffness_from": "thin"}, "incompressible"),
        ({"thickness": "inf", "stiffness_from": "thin"}, 'a half-space is not thin; expected "rest"'),
        ({"stiffness_from": "tin"}, 'did you mean "thin"'),
        ({"thickness": "-inf"}, "a value above 0"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("support", ["dead-weight", "fixed"])
def test_a_layer_that_cannot_be_is_one_message(given, message, support):
    keys = {"modulus": "3 MPa", "thickness": "2 mm", "poisson_ratio": "0.4", **given}
    words = [f"--set=foundation.{key}={value}" for key, value in keys.items()]
    told = run("steady", "--set", f"support.kind={support}", *words, status=2).output
    assert message in told
    assert told.count("error") == 1


def test_a_file_says_where_the_stiffness_is_from(tmp_path):
    path = tmp_path / "ball.toml"
    scene = kv.Scene(SHAPES["ball"], layer("inf", 0.5), LOADED["ball"])
    path.write_text(kv.to_toml(scene))
    assert 'thickness = "inf"' in path.read_text()
    assert kv.load_scene(path) == scene
    found = printed("scene", path)
    assert found["stiffness"] == pytest.approx(scene.foundation.stiffness)
    assert found["thickness"] is None
    own = kv.load_scene(path, ["foundation.thickness=1 mm", "foundation.poisson_ratio=0.3",
                               "foundation.stiffness_from=thin"])  # fmt: skip
    assert own.foundation.stiffness == layer_stiffness(1e6, 1e-3, 0.3)
    assert 'stiffness_from = "thin"' in kv.to_toml(own)
    path.write_text(kv.to_toml(own))
    assert kv.load_scene(path, ["foundation.stiffness=1 GN/m^3"]).foundation.stiffness == 1e9
    with pytest.raises(kv.SceneError, match="needs a layer"):
        kv.Foundation(1e9, 0.1, stiffness_from="rest")


def test_a_circle_is_taken_as_its_parabola():
    circle = kv.Scene(kv.Circle("10 mm"), layer("1 mm", 0.5), kv.DeadWeight(load=3000.0), STILL)
    body = Body.of_foundation(circle.foundation)
    exact = slide(circle.indenter, body, 0.0, Support(load=3000.0), 2e-3)
    found = kv.steady(circle)
    allowed = 0.1 * (found.half_length / 0.01) ** 2 + RELATIVE_ERROR
    assert found.depth == pytest.approx(exact.depth, rel=allowed)


def test_moduli_make_a_foundation_of_any_thickness():
    f = np.geomspace(0.1, 100.0, 21)
    z = 2 * np.pi * f * 0.02
    data = {"f [Hz]": f, "E' [MPa]": 1 + 3 * z**2 / (1 + z**2), "E'' [MPa]": 3 * z / (1 + z**2)}
    ball = kv.Scene(SHAPES["ball"], support=LOADED["ball"])
    found = kv.fit_foundation(data, ball, thickness="inf", poisson_ratio=0.5)
    assert found.foundation == found.scene.foundation
    assert found.stiffness == found.foundation.stiffness < 1e9
    assert 'thickness = "inf"' in found.to_toml()
    with pytest.raises(kv.SceneError, match="half-plane"):
        kv.fit_foundation(data, thickness="inf", poisson_ratio=0.5)


@pytest.mark.parametrize(
    ("thickness", "support"), [(1e-3, HELD), (3e-3, kv.Suspended(load=500.0, stiffness=1e7))]
)
def test_the_limits_of_the_layer_are_those_of_boundary_elements(thickness, support):
    arm = [("4 MPa", "20 ms")]
    rubber = kv.GeneralizedMaxwell(modulus=1e6, thickness=thickness, poisson_ratio=0.49, arms=arm)
    scene = kv.Scene(SHAPES["line"], rubber, support)
    report = kv.asymptotes(scene)
    found = report.layer
    assert found.low == pytest.approx(0.08 / 0.01)
    assert found.critical_velocity == pytest.approx(math.sqrt(found.high / found.low))
    V = found.critical_velocity * np.array([1e-2, 200.0])
    mu = kv.steady(scene, over={"drive.velocity": V}, method="layer").friction_coefficient
    assert mu == pytest.approx([found.low * V[0], found.high / V[1]], rel=0.025)
    words = str(report)
    assert f"mu -> {found.low:.6g} s/m V at low velocity" in words
    assert report.as_dict()["layer"]["high"] == found.high
    many = kv.asymptotes(scene, over={"foundation.modulus": [1e6, 2e6]}).layer
    assert many.high[0] == pytest.approx(found.high)
    assert many.low.shape == (2,)


def test_the_limit_of_a_ball_on_a_half_space_is_in_closed_form():
    rubber = kv.GeneralizedMaxwell(modulus=1e6, thickness="inf", poisson_ratio=0.5, arms=ARMS)
    found = kv.asymptotes(kv.Scene(SHAPES["ball"], rubber, LOADED["ball"])).layer
    depth = hertz(7e6)  # of the glassy modulus
    rate = (4e6 / 0.02 + 2e6 / 0.5) / 7e6
    assert found.high == pytest.approx(rate * 0.8 * depth, rel=1e-6)
    assert found.low == pytest.approx((4.0 * 0.02 + 2.0 * 0.5) / 0.01)


def test_limits_of_the_layer_that_do_not_exist():
    keys = {**RUBBER, "thickness": "1 mm", "poisson_ratio": "0.4"}
    words = [f"--set=foundation.{key}={value}" for key, value in keys.items()]
    found = printed("asymptotes", *words)["layer"]
    assert found == {"low": 2.0, "high": None, "critical_velocity": None}
    assert "on the layer itself, mu -> 2 s/m V at low velocity" in run("asymptotes", *words).stdout
    assert kv.asymptotes().layer is None
    pot = kv.FractionalKelvinVoigt(1e9, 0.02, 0.5).changed(
        stiffness=None, modulus=1e6, thickness=1e-3, poisson_ratio=0.3
    )
    assert kv.asymptotes(kv.Scene(foundation=pot)).layer is None
    thin = layer("1 mm", 0.4, stiffness_from="thin")
    assert kv.asymptotes(kv.Scene(foundation=thin)).layer.low == pytest.approx(2.0)
