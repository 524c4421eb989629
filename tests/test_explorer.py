"""The explorer in a browser: its numbers are those of Python, and it can be used by hand, key and phone."""

import json
import math
import re
import tomllib
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._model_error import model_error
from kvtheory.explorer import save_explorer
from kvtheory.explorer.controls import SECTIONS, controls
from kvtheory.results import STEADY_UNITS
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.layer import THIN, layer_number
from kvtheory.scene.quantities import quantities
from kvtheory.scene.static_state import StaticState
from kvtheory.theory import closed_forms
from tests import SCENES, SUPPORTS
from tests.browser import Browser

TABLE1 = kv.Scene()
EACH = max(30, SCENES // 8)
"""Random scenes of each of nine families."""


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    save_explorer(TABLE1, path)
    return path


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    browser = Browser(tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


@contextmanager
def watched(session, page, state="", width=1280, height=900, *, phone=False):
    """Open the page on a screen; there may be no errors and no further requests."""
    session.errors.clear()
    session.requests.clear()
    session.screen(width, height, phone=phone)
    session.open(page, state)
    yield session
    assert session.errors == []
    assert {url.partition("#")[0] for url in session.requests} - {"about:blank"} == {page.as_uri()}


@pytest.fixture
def browser(session, page):
    """The page as it opens on a screen."""
    with watched(session, page) as opened:
        yield opened


def random_scenes():
    """Scenes of each shape and each foundation on every support, at rest and in both directions."""
    random = np.random.default_rng(16)

    def between(low, high):
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    shapes = {
        "parabola": kv.Parabola, "wedge": kv.Wedge, "circle": kv.Circle, "ball": kv.Sphere,
        "power law": lambda R: kv.PowerLaw(R, random.uniform(1.3, 8.0)),
        "paraboloid": lambda R: kv.Sphere(R, radius_across=R * random.uniform(1.0, 8.0)),
    }  # fmt: skip
    foundations = {
        "kelvin-voigt": kv.Foundation,
        "arms": lambda K, tau: kv.GeneralizedMaxwell(K, arms=[[3 * K, tau], [K / 2, 50 * tau]]),
        "both": lambda K, tau: kv.GeneralizedMaxwell(
            K, arms=[[3 * K, tau], [K / 2, 50 * tau]], damping=K * tau * between(1e-3, 10.0)
        ),
        "springpot": lambda K, tau: kv.FractionalKelvinVoigt(K, tau, random.uniform(0.05, 1.0)),
    }
    pairs = [(shape, "kelvin-voigt") for shape in list(shapes)[:5]]
    pairs += [
        (shape, law)
        for shape in ("parabola", "paraboloid")
        for law in ("arms", "both", "springpot")
    ]
    for shape, law in pairs:
        for k in range(EACH):
            R, W = between(1e-3, 0.1), between(10.0, 1e5)
            supports = (
                kv.Fixed(R / 100), kv.DeadWeight(W / 9.80665),
                kv.Suspended(W / 9.80665, 1e3 * W),
            )  # fmt: skip
            speed = 0.0 if k % 25 == 7 else between(1e-7, 1e3)
            drive = kv.Drive(speed if k % 5 else -speed)
            foundation = foundations[law](between(1e8, 1e12), between(1e-3, 10.0))
            yield kv.Scene(shapes[shape](R), foundation, supports[k % 3], drive)


def in_javascript(scene):
    """The scene as the scripts of the page take it."""
    indenter, foundation, support = scene.indenter, scene.foundation, scene.support
    shape = {
        "power-law": lambda i: [1, i.length, i.exponent], "wedge": lambda i: [i.inclination, 1, 1],
    }.get(indenter.shape, lambda i: [1, i.radius, 2])(indenter)  # fmt: skip
    found = {
        "indenter": indenter.shape, "shape": shape, "stretch": getattr(indenter, "stretch", 1.0),
        "K": foundation.stiffness, "tau": foundation.retardation_time,
        "V": scene.drive.velocity,
        "kelvin_voigt": foundation.kind == "kelvin-voigt", "support": support.kind,
    }  # fmt: skip
    if foundation.arms:
        found["arms"] = [[arm.stiffness, arm.relaxation_time] for arm in foundation.arms]
        found["damping"] = foundation.damping
    if foundation.kind == "fractional-kelvin-voigt":
        found["order"] = foundation.order
    if not scene.drive.rigid:
        names = {name: getattr(scene.drive, name) for name in ("stiffness", "damping")}
        found["drive"] = {**names, "mass": scene.drive_mass}
    if scene.held:
        return found | {"depth": support.depth}
    return found | {"weight": support.weight, "spring": support.spring, "mass": support.mass}


def ask(browser, function, scene):
    """Return what a function of the scripts gives for a scene, or for each of a list."""
    several = isinstance(scene, list)
    given = [in_javascript(each) for each in (scene if several else [scene])]
    found = browser.run(f"{json.dumps(given)}.map({function})")
    return found if several else found[0]


def test_random_scenes_agree_with_python(browser):
    scenes = list(random_scenes())
    found = ask(browser, f"s => (t => {list(STEADY_UNITS)}.map(n => t[n]))(slide(s))", scenes)
    assert len(found) == 11 * EACH
    for scene, row in zip(scenes, found, strict=True):
        try:
            state = kv.steady(scene)
        except QuadratureError:  # a circle that is too heavy
            assert row[list(STEADY_UNITS).index("load")] is None, scene
            continue
        for name, value in zip(STEADY_UNITS, row, strict=True):
            known = np.isfinite(state.certificate.relative_error[name])
            if known and not (name == "trailing_edge" and abs(state.trailing_edge) < 1e-290):
                right = pytest.approx(getattr(state, name), rel=1e-12, abs=1e-300)
                assert value == right, (name, scene)


def test_every_closed_form_that_python_has_gives_the_same(browser):
    random, names = np.random.default_rng(3), {}
    for name, function in vars(closed_forms).items():
        if callable(function) and function.__module__ == closed_forms.__name__ and name != "Value":
            count = function.__code__.co_argcount
            names[name] = random.uniform(0.05, 0.95, (20, count)) + (
                function.__code__.co_varnames[0] == "n"
            ) * np.eye(1, count)
    assert len(names) > 40
    given = json.dumps({name: points.tolist() for name, points in names.items()})
    found = browser.run(
        f"Object.fromEntries(Object.entries({given}).map(([n, p]) => [n, p.map(x => globalThis[n](...x))]))"
    )
    for name, points in names.items():
        right = [getattr(closed_forms, name)(*map(np.float64, point)) for point in points]
        assert found[name] == pytest.approx(right, rel=1e-13), name
    for name in ("ALPHA", "CRITICAL_DRIVE_NUMBER", "PEAK_DRIVE_NUMBER", "PEAK_FRICTION"):
        assert browser.run(name) == getattr(closed_forms, name)


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize(
    "indenter",
    [kv.Parabola(0.01), kv.PowerLaw(0.01, 3.0), kv.Wedge(0.2), kv.Sphere(0.01, radius_across=0.03)],
)
def test_limits_and_maximum_are_those_of_python(browser, support, indenter):
    held = kv.Scene.table1(support).support
    if not indenter.per_width and support != "fixed":
        held = kv.DeadWeight(1.0) if support == "dead-weight" else kv.Suspended(1.0, 3e4)
    scene = kv.Scene(indenter, support=held, drive=kv.Drive(0.3))
    report = kv.asymptotes(scene)
    limits = "s => (k => [k.low(0.3), k.high(0.3), k.critical])(limits(s))"
    low, high, critical = ask(browser, limits, scene)
    assert [low, high] == pytest.approx([line.value for line in report.lines[:2]], rel=1e-12)
    assert critical == pytest.approx(report.critical_velocity, rel=1e-12)
    if np.isfinite(report.peak_velocity):
        (top,) = ask(browser, "s => curve_data(s).tops", scene)
        assert top["friction"] == pytest.approx(report.peak_friction_coefficient, rel=1e-12)
        assert top["V"] == pytest.approx(report.peak_velocity, rel=1e-5)


@pytest.mark.parametrize("support", SUPPORTS)
def test_limits_beside_a_damper_are_those_of_python(browser, support):
    both = kv.GeneralizedMaxwell(1e10, arms=[[3e10, 1e-4], [2e10, 3.0]], damping=2e9)
    scene = replace(kv.Scene.table1(support), foundation=both, drive=kv.Drive(0.3))
    report = kv.asymptotes(scene)
    found = ask(browser, "s => (k => [k.low(0.3), k.high(0.3), k.critical])(limits(s))", scene)
    right = [report.lines[0].value, report.lines[2].value, report.critical_velocity]
    assert found == pytest.approx(right, rel=1e-12)


def test_limits_and_every_maximum_of_a_prony_series_are_those_of_python(browser):
    scene = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=[[3e10, 1e-4], [2e10, 3.0]]))
    report = kv.asymptotes(scene)
    low, high = ask(browser, "s => (k => [k.low(0.1), k.high(0.1)])(limits(s))", scene)
    assert [low, high] == pytest.approx([report.lines[0].value, report.lines[2].value], rel=1e-12)
    tops = ask(browser, "s => curve_data(s).tops", scene)
    right = sorted(report.maxima, key=lambda velocity_and_friction: -velocity_and_friction[1])
    assert len(tops) == len(right) == 2
    for top, (velocity, friction) in zip(tops, right, strict=True):
        assert top["friction"] == pytest.approx(friction, rel=1e-10)
        assert top["V"] == pytest.approx(velocity, rel=1e-4)


def on_springs(count, ball, rubber):
    """Scenes on every support, around Table 1 or a ball of 10 N, on springs soft and stiff."""
    random = np.random.default_rng(22)

    def power(low, high):
        return float(10 ** random.uniform(low, high))

    unit, load = (1.0, 10.0) if ball else (1e3, 1e4)
    for k in range(count):
        mass = unit * power(-2.0, 2.0)
        supports = (
            kv.Fixed(3e-4 if ball else 1e-4), kv.DeadWeight(mass, load=load),
            kv.Suspended(mass, 3e4 * unit, load=load),
        )  # fmt: skip
        spring = {
            "stiffness": unit * power(0.5, 5.0), "mass": unit * power(-2.0, 2.0),
            "damping": float(random.choice([0.0, unit * power(-2.0, 2.0)])),
        }  # fmt: skip
        velocity = 0.0 if k % 40 == 7 and not rubber else power(-3.0, 1.5)
        arms = [[power(9.0, 11.0), power(-3.0, 0.0)] for _ in range(1 + k % 3)]
        damper = {"damping": 1e9} if k % 4 == 3 else {}
        yield kv.Scene(
            kv.Sphere(0.01, radius_across=0.01 * (1 + k % 4)) if ball else kv.Parabola(0.01),
            kv.GeneralizedMaxwell(1e10, arms=arms, **damper)
            if rubber
            else kv.Foundation(1e10, 0.1),
            supports[k % 3],
            kv.Drive(velocity, **({} if k % 10 == 9 and not rubber else spring)),
        )


@pytest.mark.parametrize(
    ("ball", "rubber", "count"), [(False, False, 120), (True, False, 120), (False, True, 8), (True, True, 4)]
)  # fmt: skip
def test_stability_on_a_spring_is_that_of_python(browser, ball, rubber, count):
    apart, scenes = 1e-8 if rubber else 1e-12, list(on_springs(count, ball, rubber))
    function = (
        "s => ((o, r) => [!s.drive || o.stable(s.drive.stiffness), o.upper.stiffness,"
        " o.lower.stiffness, o.upper.frequency, r])"
        "(onset_of(s, slide(s)), s.arms ? [] : rates(s, slide(s)))"
    )
    found = ask(browser, function, scenes)
    names, kinds = ("critical_stiffness", "lower_critical_stiffness", "frequency"), set()
    for scene, (stable, *numbers, pairs) in zip(scenes, found, strict=True):
        right = kv.stability(scene, quantity=("stable", *names, *([] if rubber else ["rates"])))
        errors = right.certificate.relative_error
        assert stable == right.stable, scene
        for name, number in zip(names, numbers, strict=True):
            allowed = apart + 2.0 * float(np.nan_to_num(errors[name]))
            known = pytest.approx(getattr(right, name), rel=allowed, nan_ok=True)
            assert (math.nan if number is None else number) == known, (name, scene)
        kinds.add((stable, bool(right.critical_stiffness > 0.0)))
        if not rubber:
            rates = np.array([complex(*pair) for pair in pairs])
            expected = np.array([complex(*pair) for pair in right.rates])
            off = np.abs(rates - expected[:, np.newaxis]).min(axis=1, initial=np.inf)
            assert rates.shape == expected.shape
            assert np.all(off <= (1e-12 + 2.0 * errors["rates"]) * np.abs(expected)), scene
    assert {(True, True), (False, True), (True, False)} <= kinds or rubber
    assert {(True, True), (False, True)} <= kinds or count < 8


BACK = "the trailing edge re-enters surface that it left earlier"
STARTS = [
    (support, speed, {}, "")
    for support in ("dead-weight", "suspended")
    for speed in (0.001, 0.1, 0.3)
]
STARTS += [
    ("dead-weight", 0.091, {"stiffness": 1e6}, ""),
    ("dead-weight", 0.091, {"stiffness": 3e7, "damping": 1e4, "mass": 10.0}, BACK),
    ("suspended", 0.091, {"stiffness": 1e5, "damping": 3e3}, BACK),
    ("fixed", 0.091, {"stiffness": 1e7, "mass": 300.0}, BACK),
]


@pytest.mark.parametrize(("support", "velocity", "spring", "why"), STARTS)
def test_the_start_from_rest_is_that_of_the_transient(browser, support, velocity, spring, why):
    drive = kv.Drive(velocity, **spring)
    scene = kv.Scene(support=kv.Scene.table1(support).support, drive=drive)
    found = ask(
        browser,
        "s => (rest => start_from_rest({ lam: s.V * s.tau / rest.half_length,"
        " along: s.drive && numbers_along(s, rest),"
        " kappa: s.depth === undefined ? s.spring * rest.depth / rest.load : Infinity,"
        " epsilon: s.depth === undefined ? s.mass * rest.depth / (rest.load * s.tau ** 2) : 1 }, 2))"
        "(at_rest(s))",
        scene,
    )
    rest = StaticState.of(scene)
    rows = [row for row in found["rows"][1:] if row["s"] * rest.time <= 0.2 * (1.0 + 1e-12)]
    assert len(rows) > 10
    assert found["why"] == why
    right = kv.transient(scene, at=[min(row["s"] * rest.time, 0.2) for row in rows])
    names = [
        ("depth", "d", rest.depth), ("normal_force", "f_z", rest.load),
        ("friction_force", "f_x", rest.friction_force), ("trailing_edge", "r", rest.half_length),
    ]  # fmt: skip
    if spring:
        names.append(("spring_force", "f_s", rest.friction_force))
        sliding = [(rest.drive_number - row["w"]) * rest.velocity for row in rows]
        assert sliding == pytest.approx(right.sliding_velocity, abs=1e-6 * velocity)
    for name, key, unit in names:
        due = pytest.approx(getattr(right, name) / unit, abs=3e-6 if spring else 2e-6)
        assert [row[key] for row in rows] == due, name


def test_the_start_ends_where_the_indenter_takes_off(browser):
    scene = kv.Scene(drive=kv.Drive(1.0))
    rest = StaticState.of(scene)
    numbers = {"lam": rest.drive_number, "epsilon": rest.inertia_number, "kappa": 0.0}
    found = browser.run(f"start_from_rest({json.dumps(numbers)}, 2.0)")
    off = next(event.time for event in kv.transient(scene).events if event.kind == "take-off")
    assert found["rows"][-1]["s"] * rest.time == pytest.approx(off, rel=1e-3)
    assert "leaves" in found["why"]
    browser.run("set_value('drive.velocity', '1000'), soon()")
    browser.settle()
    note = browser.run("document.querySelector('#motion-note').textContent")
    assert f"hold up to {1e3 * off:.3f} ms" in note


def text(browser, name):
    return browser.run(f"document.querySelector('[data-name={name}]').textContent")


def test_keys_move_a_slider_and_the_answer_follows(browser):
    assert text(browser, "friction_coefficient") == "0.085709"
    browser.run("document.getElementById('drive.velocity').focus()")
    for _ in range(3):
        browser.press("ArrowRight", 39)
    velocity = float(browser.run("state.values['drive.velocity']"))
    assert velocity > 100.0
    mu = kv.steady(over={"drive.velocity": velocity / 1e3}).friction_coefficient
    assert float(text(browser, "friction_coefficient")) == pytest.approx(mu, rel=1e-4)
    shown = browser.run("document.querySelector('[data-key=\"drive.velocity\"]').value")
    assert float(shown) == velocity
    assert "velocity" in browser.run("location.hash")


@pytest.mark.parametrize(
    ("before", "after"), [("-100", -115.0), ("100", 115.0), ("0.01", 0.115), ("-0.01", -0.115)]
)
def test_a_slider_keeps_the_direction_of_sliding(browser, before, after):
    browser.run(f"restore('#drive.velocity={before}')")
    browser.run("document.getElementById('drive.velocity').focus()")
    browser.press("ArrowRight", 39)
    assert float(browser.run("state.values['drive.velocity']")) == after
    assert float(text(browser, "friction_coefficient")) * after > 0.0


def test_every_control_can_be_reached_by_tab_and_says_what_it_is(browser):
    reached = set()
    for _ in range(60):
        browser.press("Tab", 9, settle=False)
        focus = "(e => e.id || e.getAttribute('aria-label'))(document.activeElement)"
        reached.add(browser.run(focus))
    names = {"drive.velocity", "indenter shape", "support.mass", "copy-toml", "play", "instant"}
    assert names <= reached
    unnamed = browser.run(
        "[...document.querySelectorAll('input, select, button, textarea')]"
        ".filter(e => !(e.textContent.trim() || e.getAttribute('aria-label') ||"
        ' document.querySelector(`label[for="${e.id}"]`))).length'
    )
    assert unnamed == 0


def test_a_choice_by_key_keeps_its_place_and_enter_plays_the_start(browser):
    browser.run("document.querySelector('[data-section=support]').focus()")
    browser.press("ArrowDown", 40)
    assert browser.run("state.choices.support") == "suspended"
    assert browser.run("document.activeElement.dataset.section") == "support"
    browser.run("document.querySelector('[data-set=drive]').focus()")
    browser.press("ArrowDown", 40)
    assert browser.run("state.values['drive.stiffness']") == "1"
    assert browser.run("document.activeElement.dataset.set") == "drive"
    browser.run("restore('')")
    browser.run("document.getElementById('play').focus()")
    browser.press("Enter", 13)
    browser.run("new Promise(f => setTimeout(f, 200))")
    assert browser.run("player.playing && player.share > 0")


STATES = (
    "", "#foundation=generalized-maxwell", "#foundation=fractional-kelvin-voigt&support=suspended",
    "#indenter=power-law&drive.velocity=-3", "#indenter=wedge&support=fixed", "#drive.velocity=0",
    "#indenter=circle&support=suspended", "#indenter=sphere&support=fixed",
    "#indenter=sphere&indenter.radius_across=40&foundation=generalized-maxwell&drive.velocity=-30",
    "#drive.stiffness=1&drive.damping=0&drive.velocity=91", "#drive.stiffness=1&support=fixed",
    "#indenter=sphere&foundation=fractional-kelvin-voigt&drive.stiffness=2&drive.damping=3&drive.mass=4",
)  # fmt: skip


@pytest.mark.parametrize("state", STATES)
def test_every_scene_fits_a_phone_and_its_copies_are_what_is_shown(session, page, state, tmp_path):
    with watched(session, page, state, 375, 812, phone=True) as browser:
        assert browser.run("document.documentElement.scrollWidth") <= 375
        assert browser.run("document.querySelector('#problem').hidden")
        bounds = "[...document.querySelectorAll('{}')].map(e => e.getBoundingClientRect())"
        card = browser.run(bounds.format("#curve-card") + ".map(r => [r.right, r.bottom])[0]")
        words = browser.run(
            bounds.format("#curve-legend > span") + ".map(r => [r.right, r.bottom])"
        )
        assert (np.array(words) < card).all()  # none is cut off
        assert card[1] < browser.run(bounds.format(".controls") + "[0].top")
        assert "NaN" not in browser.run("document.body.innerHTML.replace(/<script[^]*/, '')")
        written = browser.run("as_toml(state)")
        path = tmp_path / "scene.toml"
        path.write_text(written, encoding="utf-8")
        scene = kv.load_scene(path)
        names = {}
        exec(browser.run("as_python(state)"), names)
        assert names["scene"] == scene
        found = browser.run("slide(scene_of(state))")
        right = kv.steady(scene)
        assert found["friction_coefficient"] == pytest.approx(right.friction_coefficient, rel=1e-12)
        assert found["load"] == pytest.approx(right.load, rel=1e-12)
        again = browser.run("as_toml(from_hash(as_hash(state)))")
        assert tomllib.loads(again) == tomllib.loads(written)
        drawn = browser.run(
            "(s => contact_shapes(s, slide(s)).touched.map(([x]) => [x, pressure_at(s, slide(s), x)]))"
            "(scene_of(state))"
        )
        if scene.indenter.per_width:
            x, p = np.transpose(drawn)
            assert np.trapezoid(p, x) == pytest.approx(right.load, rel=1e-2)
        browser.screen(1280, 900)  # where no formula is cut
        cut = "[...document.querySelectorAll('.formula')].map(f => f.scrollWidth - f.clientWidth)"
        assert max(browser.run(cut), default=0) <= 0


@pytest.mark.parametrize(
    "foundation",
    [
        kv.Foundation(1e10, 0.1), *(kv.FractionalKelvinVoigt(1e10, 0.1, n) for n in (0.3, 0.7, 1.0)),
        kv.GeneralizedMaxwell(1e10, arms=[(1e10, 0.01)], damping=1e9),
    ],
)  # fmt: skip
def test_the_free_surface_bears_no_load(browser, foundation):
    """W = K int u dx over all elements: a damper or springpot that is left alone ends where it began."""
    function = (
        "s => { const state = slide(s), { touched } = contact_shapes(s, state);"
        " const away = Array.from({ length: 300 }, (_, k) => 1e-6 * 1.08 ** k);"
        " return [state.load, touched, away, relaxed(s, state, away, touched)]; }"
    )
    found = ask(browser, function, kv.Scene(foundation=foundation, drive=kv.Drive(0.02)))
    load, touched, away, left = found
    x, z = np.transpose(touched)
    under = np.trapezoid(-z, x) + 0.5 * away[0] * (-z[-1] + left[0])
    assert 1e10 * (under + np.trapezoid(left, away)) == pytest.approx(load, rel=0.02)
    assert np.all(np.diff(left) <= 0.0)


def test_the_footprint_is_that_of_python(browser):
    ball = kv.Sphere("10 mm", radius_across="40 mm")
    scene = kv.Scene(ball, support=kv.DeadWeight(mass="1 kg"), drive=kv.Drive(0.02))
    springpot = replace(scene, foundation=kv.FractionalKelvinVoigt(1e10, 0.1, 1.0))
    for given, error in ((scene, 1e-12), (springpot, 1e-6)):
        found = ask(browser, "s => footprint(s, slide(s))", given)
        y, front, back = np.transpose(found)[:, :-1]
        edges = kv.footprint(scene).edges(y)
        assert front == pytest.approx(edges[0], rel=error)
        assert back == pytest.approx(edges[1], rel=error)


@pytest.mark.parametrize("across", [0.5, 10, 300])
@pytest.mark.parametrize("velocity", [100, -3000])
def test_the_footprint_fills_its_frame_and_stays_in_it(browser, across, velocity):
    browser.run(
        f"restore('#indenter=sphere&indenter.radius_across={across}&drive.velocity={velocity}')"
    )
    browser.settle()
    left, right, top, bottom = browser.run(
        "(([a, b]) => [a.left - b.left, b.right - a.right, a.top - b.top, b.bottom - a.bottom])"
        "(['critical', 'axis'].map(c => document.querySelector(`#footprint .${c}`).getBoundingClientRect()))"
    )
    size = browser.run(
        "(({ width, height }) => [width, height])"
        "(document.querySelector('#footprint .axis').getBoundingClientRect())"
    )
    spare = np.array([left + right, top + bottom]) / size
    assert min(left, right, top, bottom) > 0.0
    assert min(spare) == pytest.approx(0.3 / 2.3, rel=0.02)


def test_a_ball_starts_at_a_fixed_depth_alone_and_the_others_say_why_not(browser):
    def told(state):
        browser.run(f"restore('{state}')")
        browser.settle()
        shown = "[document.querySelector('#motion-note').textContent, player.run !== null]"
        return browser.run(shown)

    held = kv.Scene(kv.Sphere("10 mm"), support=kv.Fixed("0.3 mm"), drive=kv.Drive(0.05))
    right = kv.solve(held, at=[0.1])
    assert told("#indenter=sphere&support=fixed&drive.velocity=50")[1]
    row, rest = browser.run("[player.run.rows.at(-1), player.run.rest]")
    drag = rest["load"] * rest["depth"] / rest["half_length"]
    assert row["f_z"] * rest["load"] == pytest.approx(right.normal_force[0], rel=1e-12)
    assert row["f_x"] * drag == pytest.approx(right.friction_force[0], rel=1e-12)
    for state, why in (
        ("#indenter=sphere", "lifts its rim"),
        ("#indenter=circle", "for a parabola and for a ball"),
        ("#indenter=sphere&drive.stiffness=1&drive.damping=0", "under a rigid drive only"),
        ("#foundation=generalized-maxwell", "on Kelvin\u2013Voigt elements only"),
        ("#drive.velocity=0", "nothing starts"),
    ):
        note, runs = told(state)
        assert why in note
        assert not runs


@pytest.mark.parametrize(
    ("chosen", "scene", "spring", "unit"),
    [
        ("", TABLE1, 1e6, "MN/m\u00b2"),
        ("indenter=sphere&", kv.Scene(kv.Sphere(0.01), support=kv.DeadWeight(1.0)), 1e3, "N/mm"),
    ],
)
def test_the_page_tells_from_which_speed_a_spring_is_too_soft(browser, chosen, scene, spring, unit):
    browser.run(f"restore('#{chosen}drive.stiffness=1&drive.damping=0&drive.velocity=91')")
    browser.settle()
    right = kv.stability(scene, over={"drive.velocity": 0.091, "drive.stiffness": spring})
    assert browser.run("kept.data.from") == pytest.approx(right.critical_velocity, rel=1e-10)
    assert not browser.run("document.querySelector('#stability p').dataset.stable === 'true'")
    rows = browser.run("document.querySelector('#stability').textContent")
    assert f"stable above{right.critical_stiffness / spring:.4g} {unit}" in rows
    assert f"{right.frequency:.4g} Hz" in rows


def test_unstable_speeds_on_arms_are_found_between_pictures_for_the_last_scene(browser):
    state = (
        "restore('#foundation=generalized-maxwell&arms=30_10&drive.stiffness={}&drive.damping=0')"
    )
    browser.run(
        "looked = [], look = (f => (data, until) => (looked.push(data), f(data, until)))(look)"
    )
    for stiffness in (0.01, 0.03):
        browser.run(f"first = kept; {state.format(stiffness)}")
        browser.settle()
        browser.run("looked.length = 0")
        assert browser.run("kept.scene.drive.stiffness") == stiffness * 1e6
    browser.run(
        "new Promise(done => (f => f(f))(f => kept.data.looking ? setTimeout(f, 5, f) : done()))"
    )
    arms = kv.GeneralizedMaxwell(1e10, arms=[[3e10, 0.01]])
    scene = kv.Scene(foundation=arms, drive=kv.Drive(0.1, stiffness=3e4))
    right = kv.stability(scene, quantity="critical_velocity")
    assert browser.run("kept.data.from") == pytest.approx(right.critical_velocity, rel=1e-4)
    legend = browser.run("document.querySelector('#curve-legend').textContent")
    assert browser.run("!looked.includes(first.data)")
    assert f"unstable on this spring, from {1e3 * right.critical_velocity:.4g} mm/s" in legend


@pytest.mark.parametrize("velocity", ["1e-6", "1e9"])
def test_the_exact_curve_reaches_a_scene_far_from_the_others(browser, velocity):
    browser.run(f"restore('#drive.velocity={velocity}')")
    browser.settle()
    path = "document.querySelector('#curve path.exact').getBoundingClientRect()"
    dot = "document.querySelector('#curve circle.present').getBoundingClientRect()"
    assert browser.run(f"{path}.left <= {dot}.left + 6 && {path}.right >= {dot}.right - 6")


def test_units_follow_the_indenter(browser):
    browser.run("state.choices.indenter = 'sphere', build_controls(), soon()")
    browser.settle()
    ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    assert text(browser, "friction_force") == f"{kv.steady(ball).friction_force:.5g} N"
    units = "[...document.querySelectorAll('[data-key=\"support.mass\"] + .unit')].map(e => e.textContent)"
    assert browser.run(units) == ["kg"]
    assert tomllib.loads(browser.run("as_toml(state)"))["support"]["mass"] == "1 kg"


@pytest.mark.parametrize(
    ("chosen", "indenter", "labels"),
    [
        ("", kv.Parabola(0.01), ("eq42", "F1", "eq46")),
        ("indenter=sphere&", kv.Sphere(0.01), ("F20-low", "F20", "F20-high")),
    ],
)
def test_the_formula_shown_is_the_limit_that_holds(browser, chosen, indenter, labels):
    for velocity, label, line in zip((0.5, 100.0, 30000.0), labels, (0, None, 1), strict=True):
        browser.run(f"restore('#{chosen}drive.velocity={velocity}')")
        browser.settle()
        shown = browser.run("document.querySelector('#formula').textContent")
        assert f"--only {label} " in shown
        assert "#" not in shown
        mass = 1000.0 if indenter.per_width else 1.0
        scene = kv.Scene(indenter, support=kv.DeadWeight(mass), drive=kv.Drive(velocity / 1e3))
        lines = kv.asymptotes(scene).lines
        right = lines[0].exact if line is None else lines[line].value
        value = float(browser.run("document.querySelector('#formula-value').textContent"))
        assert value == pytest.approx(right, rel=1e-4)


TYPED = {
    "5 m/s": "5000", "5m/s": "5000", "0,5": "0.5", "\u2212.5 m\u00b7s^-1": "-500", "36 km/h": "10000",
    "1e-3": "1e-3",
    "20 \u00b5m/ms": "20", "5 N/m": "does not fit", "5 furlong": "not known", "1,500": "comma",
    "5 mx/s": "not known", "5 kfoo": "not known", "5 qm/s": "not known",
    "1,5,0": "number", "fast": "number", "": "number", "1e400": "number",
}  # fmt: skip


def type_in(browser, key, text):
    """Type a text into a field, and return what the scene has, the mistake that is told and the address."""
    return browser.run(
        f"(box => {{ box.value = {json.dumps(text)};"
        " box.dispatchEvent(new Event('change', { bubbles: true }));"
        " const told = document.getElementById(box.getAttribute('aria-describedby'));"
        f" return [state.values['{key}'], box.getAttribute('aria-invalid'),"
        " told.hidden ? '' : told.textContent]; })"
        f"(document.querySelector('input[type=text][data-key=\"{key}\"]'))"
    )


def test_a_typed_value_is_understood_or_refused_and_not_kept(browser):
    for text, expected in TYPED.items():
        browser.run("restore('')")
        value, invalid, told = type_in(browser, "drive.velocity", text)
        browser.settle()
        address = browser.run("decodeURIComponent(location.hash)")
        if re.match(r"[a-z]", expected):
            assert (value, invalid) == ("100", "true"), text
            assert expected in told
            assert address in ("", "#")
            assert type_in(browser, "drive.velocity", "7 mm/s") == ["7", None, ""]
        else:
            assert (value, invalid, told) == (expected, None, ""), text
            assert address == f"#drive.velocity={value}"
    for key, text, value in (
        ("support.mass", "2 g/m", "0.000002"), ("foundation.stiffness", "12 MPa/mm", "12"),
        ("foundation.stiffness", "3 kN m^-1/cm\u00b2", "0.03"), ("indenter.radius", "1,2 cm", "12"),
        ("foundation.retardation_time", "2 min", "120000"),
    ):  # fmt: skip
        shown, _, told = type_in(browser, key, text)
        assert (float(shown), told) == (float(value), ""), text
    assert "out of range" in type_in(browser, "indenter.radius", "-1 mm")[2]
    browser.run("restore('#foundation=fractional-kelvin-voigt')")
    assert "out of range" in type_in(browser, "foundation.order", "1.5")[2]
    browser.run("restore('#drive.velocity=fast&indenter.radius=-3&support.mass=2')")
    kept = browser.run("[state.values['drive.velocity'], as_hash(state)]")
    assert kept == ["100", "support.mass=2"]


LAYER = (
    "#without=foundation.stiffness&foundation.modulus={}&foundation.thickness={}"
    "&foundation.poisson_ratio={}"
)


@pytest.mark.parametrize(
    ("modulus", "thickness", "ratio", "thin"),
    [
        (4, 0.1, 0.3, True), (2, 0.25, 0.3, True), (5, 2, 0.45, False), (2, 0.25, 0.499, False),
        (2, 0.3, 0.3, False), (0.05, 0.25, 0.3, True), (0.05, 2, 0.3, True),
    ],
)  # fmt: skip
def test_a_layer_that_is_not_thin_is_said_to_be_so(session, page, modulus, thickness, ratio, thin):
    with watched(session, page, LAYER.format(modulus, thickness, ratio)) as browser:
        layer = {"modulus": modulus * 1e6, "thickness": thickness * 1e-3, "poisson_ratio": ratio}
        layer |= {"retardation_time": "100 ms", "stiffness_from": "thin"}
        state = kv.steady(kv.Scene(foundation=kv.Foundation(**layer)))
        browser.run("MODEL.scene.thin = true, update()")
        number = layer_number(thickness * 1e-3, state.half_length, ratio)
        assert thin == (number <= THIN)
        hidden, told, shown = browser.run(
            "(p => [p.hidden, p.textContent, document.querySelector('#readout').textContent])"
            "(document.querySelector('#layer'))"
        )
        assert hidden == (not state.notes)
        assert ("not thin" in shown) != thin
        for words in (
            "not thin",
            "Strains are large",
            "depth/thickness",
            "slope",
            "no such contact",
        ):
            assert (words in told) == any(words in note for note in state.notes), words
        due = pytest.approx(number, rel=5e-3)
        assert thin or float(re.search(r"2\u03bd\) = ([0-9.]+), above", told)[1]) == due


@pytest.mark.parametrize(
    ("shape", "support", "thickness", "arms"),
    [
        (kv.Parabola(0.01), kv.Suspended(load=500.0, stiffness=1e6), 2e-3, [(4e6, 0.02), (2e6, 0.5)]),
        (kv.Sphere(0.01), kv.DeadWeight(load=1.0), np.inf, [(4e6, 0.02)]),
        (kv.Sphere(0.01), kv.Suspended(load=1.0, stiffness=1e3), 3e-3, [(4e6, 0.02), (2e6, 80.0)]),
        (kv.Sphere(0.01), kv.Suspended(load=1.0, stiffness=1e3), 3e-3, None),
        (kv.Parabola(0.01), kv.Fixed(1e-4), 2e-3, None),
    ],
)  # fmt: skip
def test_the_limits_on_the_layer_itself_are_shown(
    session, tmp_path, shape, support, thickness, arms
):
    layer = {"modulus": 1e6, "thickness": thickness, "poisson_ratio": 0.5}
    law = {"arms": arms} if arms else {"retardation_time": 0.02}
    foundation = (kv.GeneralizedMaxwell if arms else kv.Foundation)(**layer, **law)
    scene = kv.Scene(shape, foundation, support)
    path = tmp_path / "explorer.html"
    save_explorer(scene, path)
    right = kv.asymptotes(scene).layer
    with watched(session, path) as browser:
        K, low, high, errors, words, drawn = browser.run(
            "(s => (l => [s.K, l.low(1), l.high ? l.high(1) : null, model_error(s), "
            "document.getElementById('body').textContent, "
            "document.querySelectorAll('#curve .layer').length])(layer_limits(s)))(scene_of(state))"
        )
    assert pytest.approx(scene.foundation.stiffness, rel=1e-6 if thickness == np.inf else 1e-9) == K
    assert low == pytest.approx(right.low)
    mu, other = model_error(scene)
    assert errors == pytest.approx([float(mu), float(other)], rel=1e-5)
    second = "load" if scene.held else "depth"
    shown = re.search(rf"\u03bc is within ([\d.]+) %, {second} within ([\d.]+) %", words)
    assert [float(each) for each in shown.groups()] == pytest.approx(
        [100 * float(mu), 100 * float(other)], rel=0.06
    )
    assert words.startswith("On the layer itself")
    assert drawn == 1 + bool(arms)
    if arms:
        assert high == pytest.approx(right.high, rel=1e-5)
        assert f"{1e3 * right.critical_velocity:.4g}" in words
    else:
        assert high is None


def test_the_curve_stays_in_sight_on_a_phone_and_the_buttons_on_a_low_screen(session, page):
    box = "(e => (r => [r.top, r.bottom])(e.getBoundingClientRect()))(document.{})"
    with watched(session, page, "", 375, 812, phone=True) as browser:
        for key in ("drive.velocity", "support.mass", "foundation.retardation_time"):
            browser.run(f"document.getElementById('{key}').scrollIntoView({{ block: 'center' }})")
            browser.settle()
            top, bottom = browser.run(box.format("getElementById('curve')"))
            slider = browser.run(box.format(f"getElementById('{key}')"))
            assert 0 <= top < bottom < slider[0] < slider[1] < 812
    with watched(session, page, "#foundation=generalized-maxwell", 1280, 700) as browser:
        for name in ("copy-toml", "reset"):
            top, bottom = browser.run(box.format(f"getElementById('{name}')"))
            assert 0 < top < bottom < 700


LAWS = {
    kv.Foundation: {"retardation_time": 0.1},
    kv.GeneralizedMaxwell: {},
    kv.FractionalKelvinVoigt: {"retardation_time": 0.1, "order": 0.4},
}
SHAPES = (
    (kv.Parabola(0.01), LAWS), (kv.Sphere(0.01), LAWS), (kv.Sphere(0.01, radius_across=0.003), LAWS),
    (kv.Circle(0.02), [kv.Foundation]), (kv.Wedge(0.03), [kv.Foundation]),
    (kv.PowerLaw(0.01, 2.6), [kv.Foundation]),
)  # fmt: skip
BASES = (
    {"stiffness": 2e10},
    {"modulus": 3e6, "thickness": 2e-4, "poisson_ratio": 0.35},
    {"modulus": 2e5, "thickness": 2e-3, "poisson_ratio": 0.495},
    {"modulus": 2e6, "thickness": 6e-3, "poisson_ratio": 0.4999},
)
ARRHENIUS = {"reference_temperature": 293.15, "activation_energy": 8e4}
CLIMATES = (
    {},
    {"temperature": 300.15, **ARRHENIUS, "lowest_temperature": 253.15, "highest_temperature": 313.15},
    {"temperature": 272.15, "reference_temperature": 296.15, "wlf": [5.0, 51.6]},
    {"temperature": 250.15, "reference_temperature": 260.15, "wlf": [8.0, 95.0],
     "shift_factors": [[240.15, 2.4], [260.15, 0.0], [280.15, -1.5]],
     "lowest_frequency": 1e-2, "highest_frequency": 3e4},
    {**ARRHENIUS, "lowest_frequency": 1e-3, "highest_frequency": 2.0},
    {"temperature": 316.15, **ARRHENIUS, "lowest_temperature": 263.15, "highest_temperature": 313.15,
     "lowest_frequency": 1e-2, "highest_frequency": 1e-1},
)  # fmt: skip
CARRIED = (
    kv.Fixed(1e-4), kv.DeadWeight(30.0), kv.DeadWeight(load=700.0), kv.DeadWeight(5.0, load=300.0),
    kv.Suspended(40.0, 3e5), kv.Suspended(stiffness=2e6, load=200.0, gravity=1.62),
    kv.Suspended(9.0, 1e5, load=90.0),
)  # fmt: skip
RIGID = kv.Drive(0.1), kv.Drive(-0.02), kv.Drive(history=[(0.0, 0.2), (0.1, 0.01)])
DRIVES = (
    *RIGID, kv.Drive(3.0, stiffness=1e5, mass=7.0), kv.Drive(0.01, stiffness=3e6, damping=20.0, mass=1.0),
)  # fmt: skip


def scenes_of_all_kinds():
    """Scenes of each shape and foundation, in which layers, temperatures, supports and drives take turns."""
    pairs = [(indenter, law) for indenter, laws in SHAPES for law in laws]
    for count, (indenter, law) in enumerate(pairs * 4):
        turn = count + count // len(pairs)
        base = BASES[turn % len(BASES)]
        own = {**LAWS[law], **base, **CLIMATES[turn % len(CLIMATES)]}
        unknown = (
            indenter.shape in ("wedge", "power-law") or getattr(indenter, "stretch", 1.0) != 1.0
        )
        if "modulus" in base and (unknown or turn % 4 == 0):
            own["stiffness_from"] = "thin"
        if law is kv.GeneralizedMaxwell:
            first = next(iter(base.values()))
            own["arms"] = [[3.0 * first, 1e-3], [0.5 * first, 0.2]][: 1 + turn // 3 % 2]
            if "stiffness" in base and turn // 3 % 2:
                own["damping"] = 1e-3 * first
        slow = law is kv.GeneralizedMaxwell and not indenter.per_width  # on a spring, a second each
        drives = RIGID if slow else DRIVES
        yield kv.Scene(
            indenter, law(**own), CARRIED[turn % len(CARRIED)], drives[turn % len(drives)],
            kv.Run(0.1 + 0.01 * count),
        )  # fmt: skip


def keys_of(table):
    """The keys of a scene file that hold numbers, and those of every class of a scene."""
    return {
        f"{section}.{name}"
        for section, own in table.items()
        for key in own.keys() - {"kind", "shape", "arms", "stiffness_from", "shift_factors"}
        for name in (["wlf.c_1", "wlf.c_2"] if key == "wlf" else [key])
    }


def number(text):
    """The number that the page shows, such as 1.2\u00b710\u207b\u2075."""
    plain = str.maketrans(
        "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079", "-0123456789"
    )
    return float(text.replace("\u00b710", "e").translate(plain))


OPENED = """page => {
  Object.assign(MODEL, page);
  Object.assign(SECTIONS, page.sections);
  state = original();
  build_controls();
  update();
  const all = (selector, of) => [...document.querySelectorAll(selector)].map(of);
  return {
    numbers: Object.fromEntries(all("#numbers b", (b) => [b.dataset.name, b.firstChild.textContent])),
    found: slide(scene_of(state)), toml: as_toml(state),
    problem: document.getElementById("problem").textContent,
    notes: ["layer", "measured"].map((id) => !document.getElementById(id).hidden),
    sliders: all(
      "input[type=range][data-key]", (e) => [e.dataset.key, Number(e.min), Number(e.value), Number(e.max)],
    ),
  };
}"""


def test_the_page_opens_at_scenes_of_every_kind_and_keeps_all_they_say(browser, tmp_path):
    scenes = list(scenes_of_all_kinds())
    pages = browser.run(f"{json.dumps([controls(scene) for scene in scenes])}.map({OPENED})")
    path, seen, notes = tmp_path / "scene.toml", set(), set()
    for scene, page in zip(scenes, pages, strict=True):
        right, force = kv.steady(scene), 1e-3 if scene.indenter.per_width else 1.0
        assert page["problem"] == "", scene
        for name, factor in (("friction_coefficient", 1.0), ("load", force), ("depth", 1e3)):
            due = getattr(right, name)
            close = 1e-9 if scene.foundation.stiffness_from == "rest" else 1e-12
            assert page["found"][name] == pytest.approx(due, rel=close), (name, scene)
            assert number(page["numbers"][name]) == pytest.approx(factor * due, rel=1e-4), scene
        noted = [
            any(word in note for note in right.notes for word in words)
            for words in (("not thin", "Strains are large", "no such contact"), ("extrapolates",))
        ]
        assert page["notes"] == noted, scene
        path.write_text(page["toml"], encoding="utf-8")
        spring = {name: getattr(scene.drive, name) for name in ("stiffness", "damping", "mass")}
        drive = kv.Drive(scene.drive.final_velocity, **({} if scene.drive.rigid else spring))
        assert kv.load_scene(path) == replace(scene, drive=drive)
        keys = {key for key, *_ in page["sliders"] if not key.startswith("arms")}
        assert keys == keys_of(tomllib.loads(page["toml"]))
        assert len(page["sliders"]) == len(keys) + 2 * len(scene.foundation.arms)
        assert all(low <= value <= high for _, low, value, high in page["sliders"]), scene
        seen |= keys
        notes.add(tuple(noted))
    declared = {
        section: {name: 0 for cls in classes.values() for name in quantities(cls)}
        for section, (_, classes) in SECTIONS.items()
    }
    declared["foundation"]["wlf"] = 0
    assert seen == keys_of(declared)
    assert len(notes) == 4
    assert len(scenes) >= 40


def test_a_temperature_can_be_typed_and_every_time_follows_it(session, tmp_path):
    law = {"reference_temperature": 293.15, "activation_energy": 8e4, "temperature": 300.15}
    layer = {"modulus": 3e6, "thickness": 2e-4, "poisson_ratio": 0.35}
    scene = kv.Scene(foundation=kv.GeneralizedMaxwell(arms=[[6e6, 0.1]], **layer, **law))
    path = tmp_path / "explorer.html"
    save_explorer(scene, path)
    with watched(session, path) as browser:
        for key, given, kept, value in (
            ("temperature", "60 degC", "333.15", 333.15), ("temperature", "35 \u00b0C", "308.15", 308.15),
            ("activation_energy", "1e5 J/mol", "100", 1e5), ("activation_energy", "0.09 MN m/mol", "90", 9e4),
        ):  # fmt: skip
            assert type_in(browser, f"foundation.{key}", given) == [kept, None, ""]
            scene = scene.replace({f"foundation.{key}": value})
            browser.settle()
            right = kv.steady(scene).friction_coefficient
            assert float(text(browser, "friction_coefficient")) == pytest.approx(right, rel=1e-4)
        assert "not known" in type_in(browser, "drive.velocity", "20 degC")[2]
        relaxed = "state => (s => [s.K, s.arms[0][0] / s.K])(scene_of(state))"
        pick = (
            "(e => {{ e.value = {}; e.dispatchEvent(new Event('change', {{ bubbles: true }})); }})"
        )
        select = "(document.querySelector('select[data-set=foundation]'))"
        for choice, field in ((0, "stiffness"), (1, "modulus")):
            browser.run(pick.format(choice) + select)
            browser.settle()
            assert browser.run("measure_of(state)") == field
            assert browser.run(f"({relaxed})(state)")[1] == pytest.approx(2.0, rel=1e-5)
            assert browser.run("state.values['foundation.activation_energy']") == "90"
            path = tmp_path / f"{field}.toml"
            path.write_text(browser.run("as_toml(state)"), encoding="utf-8")
            names = {}
            exec(browser.run("as_python(state)"), names)
            assert names["scene"] == kv.load_scene(path)
            assert browser.run("as_toml(from_hash(as_hash(state))) === as_toml(state)")
            right = kv.steady(kv.load_scene(path)).friction_coefficient
            assert float(text(browser, "friction_coefficient")) == pytest.approx(right, rel=1e-4)


def test_values_that_contradict_each_other_are_told(session, tmp_path):
    law = {"reference_temperature": 293.15, "wlf": [8.0, 50.0], "temperature": 300.15}
    measured = {"lowest_frequency": 1.0, "highest_frequency": 100.0}
    path = tmp_path / "explorer.html"
    save_explorer(kv.Scene(foundation=kv.Foundation(1e10, 0.1, **law, **measured)), path)
    with watched(session, path) as browser:
        for key, value, words in (
            ("temperature", "243", "the pole of the WLF law"),
            ("highest_frequency", "1", "expected above foundation.lowest_frequency"),
        ):
            browser.run(f"restore('#foundation.{key}={value}')")
            browser.settle()
            told = browser.run(
                "(p => [p.hidden, p.textContent])(document.querySelector('#problem'))"
            )
            assert not told[0]
            assert words in told[1]
        browser.run("restore('#foundation.wlf.c_2=60&foundation.temperature=20 degC')")
        assert browser.run("decodeURIComponent(as_hash(state))") == (
            "foundation.temperature=293.15&foundation.wlf.c_2=60"
        )
        names = {}
        exec(browser.run("as_python(state)"), names)
        assert names["scene"].foundation.wlf == kv.scene.foundations.WLF(8.0, 60.0)


EXTREME = (
    "drive.velocity", "indenter.radius", "support.mass", "foundation.stiffness",
    "foundation.retardation_time",
)  # fmt: skip


@pytest.mark.parametrize("family", ["", "indenter=sphere&", "foundation=generalized-maxwell&"])
def test_ten_decades_either_side_leave_no_gap_and_a_mistake_is_told(browser, family):
    for key in EXTREME:
        for value in ("1e-9", "1e11"):
            browser.run(f"restore('#{family}{key}={value}')")
            browser.settle()
            html = browser.run("document.body.innerHTML.replace(/<script[^]*/, '')")
            assert not re.search("NaN|Infinity|undefined", html), (key, value)
            assert browser.run("document.querySelector('#problem').hidden"), (key, value)
    browser.run("set_value('indenter.radius', '-1'), soon()")
    browser.settle()
    told = browser.run("(p => [p.textContent, p.hidden])(document.querySelector('#problem'))")
    assert told == ["indenter.radius = -1: out of range: a finite value above 0", False]
