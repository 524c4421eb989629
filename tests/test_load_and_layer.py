"""A load instead of a weight, and a thin layer instead of a stiffness: one scene in other words."""

import copy
import pickle
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.scene import template
from kvtheory.scene.layer import THIN, layer_stiffness
from tests.commands import printed, run

G = 9.80665
SUPPORTS = {"dead-weight": {}, "suspended": {"stiffness": 3e7}}
KINDS = {"dead-weight": kv.DeadWeight, "suspended": kv.Suspended}
LAYER = kv.Foundation(modulus="5 MPa", thickness="2 mm", poisson_ratio=0.45, retardation_time=0.1)
THINNED = replace(LAYER, stiffness_from="thin")
LAYER_KEYS = [
    "foundation.modulus=5 MPa", "foundation.thickness=2 mm", "foundation.poisson_ratio=0.45",
]  # fmt: skip

MODULI = [["30 MPa", "10 ms"], ["5 MPa", "1 s"]]
SOLID = {"modulus": "5 MPa", "thickness": "0.2 mm", "poisson_ratio": 0.3}
SOFT = kv.GeneralizedMaxwell(**SOLID, arms=MODULI)
ROOM = {"reference_temperature": "23 degC"}
LAWS = {"wlf": {"wlf": ["17.44", "51.6 K"]}, "arrhenius": {"activation_energy": "80 kJ/mol"}}
LAW = {**ROOM, **LAWS["wlf"]}


def scene(kind, **support):
    return kv.Scene(support=KINDS[kind](**SUPPORTS[kind], **support))


def assert_same_motion(a, b, rtol=0.0):
    for name in TRANSIENT_UNITS:
        one, other = getattr(a, name), getattr(b, name)
        atol = rtol * np.abs(other).max()
        np.testing.assert_allclose(one, other, rtol=rtol, atol=atol, err_msg=name)


@pytest.mark.parametrize("kind", KINDS)
def test_a_load_alone_is_the_weight_of_its_mass(kind):
    by_load, by_mass = scene(kind, load=1000.0 * G), scene(kind, mass=1000.0)
    assert by_load.support.mass == 1000.0
    assert_same_motion(kv.transient(by_load), kv.transient(by_mass))
    assert kv.steady(by_load) == kv.steady(by_mass)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("solver", [kv.transient, kv.elements])
def test_with_a_load_the_mass_is_inertia_alone(kind, solver):
    """M and W are independent: gravity chosen for the same pair gives the same motion."""
    mass, load = 40.0, 3000.0
    by_load = scene(kind, mass=mass, load=load)
    by_gravity = scene(kind, mass=mass, gravity=load / mass)
    found = (solver(each, at="0 ms:20 ms:5") for each in (by_load, by_gravity))
    assert_same_motion(*found, rtol=0.0 if solver is kv.transient else 1e-13)  # one may be compiled
    heavy = scene(kind, mass=1e3 * mass, load=load)
    assert kv.steady(by_load).load == kv.steady(heavy).load


def test_a_load_can_be_swept_and_the_mass_follows_only_where_it_was_not_given():
    loads = np.array([1e3, 5e3, 2e4])
    over = {"support.load": loads}
    follows, stays = kv.Scene(support=kv.DeadWeight(load=1.0)), kv.Scene()
    assert kv.steady(follows, over=over).load == pytest.approx(loads, rel=1e-14)
    for base in (follows, stays):
        swept = kv.sweep(base, over=over, quantities=["load", "depth.min", "load.steady"])
        assert swept["load"] == pytest.approx(loads, rel=1e-14)
        for load, least in zip(loads, swept["depth.min"], strict=True):
            own = kv.DeadWeight(mass=load / G if base is follows else 1000.0, load=load)
            velocity = {"drive.velocity": [0.1]}
            alone = kv.sweep(kv.Scene(support=own), over=velocity, quantities="depth.min")
            assert least == pytest.approx(alone["depth.min"][0], rel=1e-9)
    inertia = kv.sweep(follows, over={"support.mass": [1.0, 1e3]}, quantities=["load", "depth.min"])
    assert inertia["load"].tolist() == pytest.approx([1.0, 1.0])
    assert inertia["depth.min"][0] != inertia["depth.min"][1]


def test_the_layer_is_its_confined_modulus_over_its_thickness():
    E, nu, h = 5e6, 0.3, 2e-3
    lame, shear = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    assert layer_stiffness(E, h, nu) == pytest.approx((lame + 2 * shear) / h, rel=1e-14)
    assert layer_stiffness(E, h, 0.0) == E / h
    assert THINNED.stiffness == layer_stiffness(5e6, 2e-3, 0.45)


def compressed_layer(nu, thickness):
    """Load and half length of a parabola with a = 1 on a layer, over those on elements of stiffness K.

    By the exact compliance of a bonded layer in plane strain, without friction on its surface.
    """
    dx, n, count = 0.02, 125, 2048
    k = 2.0 * np.pi * np.fft.rfftfreq(count, dx)
    s = np.maximum(k * thickness, 1e-6)
    e = np.exp(-2.0 * s)
    above = (3.0 - 4.0 * nu) * (1.0 - e * e) / 2.0 - 2.0 * s * e
    below = (3.0 - 4.0 * nu) * (1.0 + e * e) / 2.0
    below += (2.0 * s * s + 5.0 - 12.0 * nu + 8.0 * nu * nu) * e
    compliance = 2.0 * (1.0 - nu) ** 2 / (1.0 - 2.0 * nu) * above / (s * below)  # 1 for s -> 0
    influence = np.fft.irfft(compliance * np.sinc(k * dx / (2.0 * np.pi)) ** 2, count)
    x = dx * np.arange(-n, n + 1)
    matrix = influence[np.abs(np.subtract.outer(np.arange(2 * n + 1), np.arange(2 * n + 1)))]
    depth, inside = 1.0 - x * x, np.abs(x) <= 1.0
    while True:
        pressure = np.zeros_like(x)
        pressure[inside] = np.linalg.solve(matrix[np.ix_(inside, inside)], depth[inside])
        touching = np.where(inside, pressure > 0.0, matrix @ pressure < depth - 1e-12)
        if (touching == inside).all():
            return pressure.sum() * dx / (4.0 / 3.0), dx * inside.sum() / 2.0
        inside = touching


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.45, 0.49])
def test_a_thin_layer_is_as_independent_as_its_limit_says(nu):
    load, half_length = compressed_layer(nu, np.sqrt(THIN * (1.0 - 2.0 * nu)))
    assert abs(load - 1.0) < 0.05
    assert abs(half_length - 1.0) < 0.15
    if nu == 0.49:  # and the next-order correction is right
        c = nu * (4.0 * nu - 1.0) / (3.0 * (1.0 - nu) * (1.0 - 2.0 * nu))
        share = c * THIN * (1.0 - 2.0 * nu)
        assert load == pytest.approx((1.0 - share) ** 1.5 + share**1.5, abs=2e-3)


def test_a_layer_that_is_not_thin_for_its_contact_is_noted():
    thick = kv.Scene(foundation=THINNED)
    state = kv.steady(thick)
    (note,) = state.notes
    assert f"= {(2e-3 / state.half_length) ** 2 / 0.1:.3g}, above 0.1" in note
    assert note in repr(state)
    assert note in state._repr_html_()
    assert state.as_dict()["notes"] == [note]
    for found in (kv.asymptotes(thick), kv.transient(thick, at=[0.0], certify=False)):
        assert "not thin for its contact" in found.notes[-1]
    assert kv.steady(thick, over={"foundation.stiffness": 1e9}).notes == ()
    (several,) = kv.steady(thick, over={"foundation.thickness": [1e-6, 1e-3, 2e-3]}).notes
    assert "in 2 of 3 scenes" in several
    assert kv.steady().notes == kv.steady(kv.problem("thin-layer")).notes == ()
    narrow = kv.Sphere(radius=1.0, radius_across=1e-4)  # thin for its length, not for its width
    ball = replace(thick, indenter=narrow, support=kv.Fixed(depth=3e-4))
    assert kv.steady(ball, over={"indenter.radius_across": 1.0}).notes == ()
    assert "not thin" in kv.steady(ball).notes[-1]


@pytest.mark.parametrize("shape", ["parabola", "circle"])
def test_the_scene_command_notes_a_thick_layer_for_the_contact_at_rest(shape):
    given = [*LAYER_KEYS, "foundation.stiffness_from=thin", f"indenter.shape={shape}"]
    command = ["scene", *(f"--set={each}" for each in given)]
    told = run(*command).stdout
    (note,) = printed(*command)["notes"]
    assert note in told
    assert (note,) == kv.steady(kv.load_scene(overrides=given), over={"drive.velocity": 0.0}).notes


def test_a_layer_is_swept_by_its_own_keys_or_gives_way_to_a_stiffness():
    by_layer = kv.Scene(foundation=THINNED)
    over = {"foundation.thickness": [1e-3, 2e-3, 4e-3], "foundation.modulus": [5e6, 6e6, 7e6]}
    zipped = {tuple(over): tuple(over.values())}
    swept = kv.sweep(by_layer, over=zipped, quantities=["depth", "depth.end"])
    assert np.array_equal(swept["depth"], kv.steady(by_layer, over=over).depth)
    for h, E, last in zip(*over.values(), swept["depth.end"], strict=True):
        alone = kv.Scene(foundation=kv.Foundation(layer_stiffness(E, h, 0.45), 0.1))
        assert last == pytest.approx(kv.transient(alone, at=0.2).depth[0], rel=1e-12)
    over = {"foundation.stiffness": [1e9, 1e10]}
    assert np.array_equal(kv.steady(by_layer, over=over).depth, kv.steady(over=over).depth)
    assert kv.sweep(by_layer, over=over, quantities="depth.end").failed == 0
    with pytest.raises(
        kv.SceneError, match=r"foundation\.thickness = .*: the scene needs foundation.modulus"
    ):
        kv.sweep(over={"foundation.thickness": [1e-3]})


@pytest.mark.parametrize(
    "scene",
    [
        kv.Scene(support=kv.DeadWeight(load=3e3)),
        kv.Scene(support=kv.DeadWeight(mass=2.0, load=3e3)),
        kv.Scene(support=kv.Suspended(load=3e3, stiffness=1e6, gravity=1.6)),
        kv.Scene(kv.Sphere("10 mm"), support=kv.Suspended("1 kg", "1 N/mm")),
        kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01), (5e9, 1.0)])),
        kv.Scene(foundation=kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)),
        kv.Scene(foundation=LAYER),
        kv.Scene(foundation=THINNED),
        kv.Scene(kv.Sphere("10 mm"), replace(LAYER, thickness="inf"), kv.DeadWeight("1 kg")),
        kv.Scene(foundation=replace(SOFT, **LAW, temperature="60 degC")),
        kv.Scene(foundation=kv.FractionalKelvinVoigt(1e9, 0.1, 0.5, **ROOM, **LAWS["arrhenius"])),
        kv.Scene(foundation=kv.Foundation(1e9, [0.1, 0.2], temperature=[[280.0], [300.0]], **LAW)),
    ],
)
def test_files_hold_what_was_given(tmp_path, scene):
    path = tmp_path / "scene.toml"
    path.write_text(kv.to_toml(scene))
    read = kv.load_scene(path)
    assert read == scene
    assert kv.to_toml(read) == kv.to_toml(scene)
    assert ("mass" in path.read_text()) == (scene.support.load is None or scene.support.mass == 2.0)
    assert read.support.changed(gravity=1.0).weight == scene.support.changed(gravity=1.0).weight


@pytest.mark.parametrize("support", KINDS)
def test_the_template_tells_of_both(support):
    told = re.sub("# (load|modulus|thickness|poisson)", r"\1", template(support))
    told = re.sub('^(mass|stiffness = "10 GN).*', "", told, flags=re.MULTILINE)
    tables = tomllib.loads(told)
    assert tables["support"]["load"] == "9.80665 N/mm"
    assert tables["foundation"]["poisson_ratio"] == 0.3


def test_overrides_exchange_a_stiffness_for_a_layer_and_back(tmp_path):
    read = kv.load_scene(overrides=LAYER_KEYS)
    assert read == kv.Scene(foundation=replace(LAYER))
    path = tmp_path / "layer.toml"
    path.write_text(kv.to_toml(read))
    assert kv.load_scene(path, ["foundation.stiffness=1 GN/m^3"]).foundation.stiffness == 1e9
    assert kv.load_scene(overrides=["support.load=3 N/mm"]).support.weight == 3000.0


def test_files_that_lack_or_contradict_are_told_all_at_once(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        '[indenter]\nradius = "10 mm"\n[foundation]\nmodulus = "5 MPa"\nthickness = "2 mm"\n'
        '[support]\nkind = "dead-weight"\ngravity = "1 m/s^2"\n[drive]\nvelocity = "1 m/s"\n'
    )
    with pytest.raises(kv.SceneError, match=r"or support\.load") as error:
        kv.load_scene(path)
    missing = [told.partition(": missing for kind")[0] for told in error.value.problems]
    assert missing == [
        "foundation.poisson_ratio", "foundation.retardation_time", "support.mass",
    ]  # fmt: skip


def test_the_arms_of_a_layer_are_moduli_and_follow_it():
    thin = replace(SOFT, stiffness_from="thin")
    per_modulus = layer_stiffness(1.0, 2e-4, 0.3)
    assert [arm.stiffness for arm in thin.arms] == pytest.approx(
        [3e7 * per_modulus, 5e6 * per_modulus]
    )
    by_layer = kv.Scene(foundation=SOFT)
    layer = by_layer.foundation
    arms = [(arm.stiffness * 1.0, arm.relaxation_time) for arm in layer.arms]
    assert [K / layer.stiffness for K, _ in arms] == pytest.approx([6.0, 1.0])
    by_stiffness = kv.Scene(foundation=kv.GeneralizedMaxwell(float(layer.stiffness), arms=arms))
    assert kv.steady(by_layer) == kv.steady(by_stiffness)
    assert kv.asymptotes(by_layer).maxima == kv.asymptotes(by_stiffness).maxima
    over = {"foundation.thickness": np.array([1e-4, 2e-4, 4e-4])}
    swept = kv.sweep(by_layer, over=over, quantities="depth")
    assert np.array_equal(swept["depth"], kv.steady(by_layer, over=over).depth)
    many = by_layer.replace({**over, "foundation.arms[1].modulus": [[6e6], [7e6]]})
    assert many.shape == (2, 3)
    found = kv.steady(many).friction_coefficient
    for i, j in np.ndindex(2, 3):
        layer = {**SOLID, "thickness": over["foundation.thickness"][j]}
        alone = kv.GeneralizedMaxwell(**layer, arms=[MODULI[0], [[6e6, 7e6][i], "1 s"]])
        assert kv.steady(kv.Scene(foundation=alone)).friction_coefficient == found[i, j]


@pytest.mark.parametrize(
    ("law", "foundation"),
    [
        ("wlf", kv.Foundation(1e10, 0.1)),
        ("arrhenius", SOFT),
        ("wlf", kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)),
    ],
    ids=["kelvin-voigt", "generalized-maxwell", "fractional-kelvin-voigt"],
)
def test_temperature_is_velocity(law, foundation):
    """F25: steady sliding at T and V is that at T_ref and V a_T, for every shape and support."""
    cold = replace(foundation, **ROOM, **LAWS[law])
    warm = replace(cold, temperature="40 degC")
    a_T = warm.shift_factor
    T, T_ref = 313.15, 296.15
    if law == "wlf":
        assert a_T == pytest.approx(10 ** (-17.44 * 17 / 68.6), rel=1e-12)
    else:
        assert a_T == pytest.approx(np.exp(8e4 / 8.31446261815324 * (1 / T - 1 / T_ref)), rel=1e-12)
    shapes = [
        kv.Parabola(0.01), kv.Sphere(0.01), kv.Circle(0.01), kv.PowerLaw(0.01, 3.0), kv.Wedge(0.05),
        kv.Revolved(kv.Wedge(0.05)), kv.Profile(lambda x: 50.0 * x * x, lambda x: 100.0 * x),
    ]  # fmt: skip
    chosen = {
        "generalized-maxwell": shapes[:3],
        "fractional-kelvin-voigt": [*shapes[:2], shapes[4]],
    }
    for shape in chosen.get(foundation.kind, shapes):
        quick = shape.shape in ("parabola", "sphere") or foundation.kind == "kelvin-voigt"
        for support in (kv.Fixed(1e-5), kv.DeadWeight(10.0))[: 1 + quick]:
            scene = kv.Scene(shape, cold, support, kv.Drive(0.1 * a_T))
            there = kv.steady(scene)
            here = kv.steady(replace(scene, foundation=warm, drive=kv.Drive(0.1)))
            for name in ("depth", "load", "friction_force", "half_length", "peak_pressure"):
                error = here.certificate.relative_error.get(name, 1e-12) + 1e-12
                wanted = getattr(there, name)
                assert getattr(here, name) == pytest.approx(wanted, rel=4 * error), (shape, name)


def test_temperatures_are_swept_and_everything_sees_the_shifted_times_only():
    rubber = kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01), (5e9, 1.0)], **LAW)
    scene = kv.Scene(foundation=rubber, run=kv.Run(1e-3))
    over = {"foundation.temperature": "0 degC:80 degC:3"}
    swept = kv.sweep(scene, over=over, quantities="friction_coefficient")
    many = scene.replace({"foundation.temperature": ["0 degC", "104 degF", 353.15]})
    assert swept["friction_coefficient"].tolist() == kv.steady(many).friction_coefficient.tolist()
    for i, temperature in enumerate((273.15, 313.15, 353.15)):
        alone = scene.replace({"foundation.temperature": temperature})
        plain = replace(scene, foundation=alone.foundation.plain())
        assert plain.foundation.arms[0].relaxation_time == 0.01 * alone.foundation.shift_factor
        assert kv.steady(plain).friction_force == kv.steady(many).friction_force[i]
        assert kv.steady(many.flat().rows(slice(i, i + 1))).depth[0] == kv.steady(plain).depth
        if i == 0:  # warmer, the times are too short for elements
            found = (kv.elements(each, at="1 ms") for each in (alone, plain))
            assert_same_motion(*found, rtol=1e-13)
    cold = alone.replace({"foundation.temperature": 300.0})
    assert cold.replace({"foundation.temperature": temperature}) == alone
    both = many.replace({"foundation.arms[0].relaxation_time": [[0.01], [0.02]]})
    assert both.shape == (2, 3)
    assert pickle.loads(pickle.dumps(both)) == both == copy.deepcopy(both)
    moved = pickle.loads(pickle.dumps(both)).replace({"foundation.temperature": 353.15})
    assert moved.foundation.arms[0].relaxation_time[0] == alone.foundation.arms[0].relaxation_time


POLE = "above T_ref - C_2 = 244.55 K, the pole"
WARM = {"temperature": "60 degC", **ROOM}
THERMAL_MISTAKES = [
    (WARM, "foundation.temperature: needs a law"),
    ({"temperature": "60 degC", **LAWS["wlf"]}, "foundation.reference_temperature: missing"),
    ({"temperature": 1.0, **LAWS["arrhenius"]}, "foundation.reference_temperature: missing"),
    (LAWS["wlf"], "foundation.reference_temperature: missing"),
    ({**LAW, **LAWS["arrhenius"]}, "foundation.wlf: cannot be given beside"),
    ({"temperature": "-274 degC", **LAW}, "foundation.temperature = .*above 0"),
    ({"temperature": "-29 degC", **LAW}, POLE),
    ({"temperature": [300.0, 244.0], **LAW}, POLE),
    ({"temperature": "-28.5 degC", **LAW}, "precision; check foundation.temp"),
    ({"temperature": "1 K", **ROOM, **LAWS["arrhenius"]}, "foundation.activation_energy"),
    ({**WARM, "wlf": ["17.44", "51.6 degC"]}, "not of a difference"),
    ({**WARM, "wlf": ["17.44 K", "51.6 K"]}, "dimensionless"),
    ({**WARM, "wlf": ["17.44"]}, "expected C_1 and C_2"),
]


@pytest.mark.parametrize(("given", "words"), THERMAL_MISTAKES)
def test_a_wrong_temperature_is_told_by_its_key(given, words):
    for cls, own in (
        (kv.Foundation, {"stiffness": 1e10, "retardation_time": 0.1}),
        (kv.GeneralizedMaxwell, {**SOLID, "arms": MODULI}),
    ):
        with pytest.raises(kv.SceneError, match=words):
            cls(**own, **given)


def test_a_key_that_needs_another_says_so():
    told = "the scene needs foundation.reference_temperature beside it"
    for ask in (kv.steady, kv.sweep):
        with pytest.raises(kv.SceneError, match=told):
            ask(over={"foundation.temperature": [300.0]})


def test_a_shift_that_leaves_double_precision_later_is_named():
    cold = kv.Foundation(1e10, 0.1, temperature=250.0, **ROOM, wlf=(20.0, 51.6))
    with pytest.raises(ValueError, match=r"a_T of foundation\.temperature = 2\.\d+e\+169"):
        kv.transient(kv.Scene(foundation=cold))


SPRUNG = kv.Drive(velocity=0.1, stiffness=1e6)
FOLLOWING = (
    kv.Scene(drive=SPRUNG),
    kv.Scene(support=kv.DeadWeight(load=3e3), drive=SPRUNG),
    kv.Scene(support=kv.Suspended(mass=2.0, load=3e3, stiffness=1e6)),
    kv.Scene(foundation=LAYER),
    kv.Scene(foundation=SOFT),
    kv.Scene(foundation=replace(SOFT, **LAW, temperature="25 degC")),
    kv.Scene.table1("fixed"),
)


@pytest.mark.parametrize("given", FOLLOWING)
def test_what_follows_from_a_replaced_value_is_as_in_a_scene_made_with_it(given):
    for key in sorted(given.replaceable.keys() & given.values().keys()):
        if key == "foundation.stiffness" and given.foundation.arms:
            continue  # the arms of a layer have moduli
        value = 1.05 * given.values()[key]
        made = given.replace({key: value}).values()
        arrays = given.replace({key: [value, value]}).values()
        assert made.keys() == arrays.keys(), key
        for name, expected in made.items():
            assert arrays[name] == pytest.approx(expected, rel=1e-15), (key, name)
