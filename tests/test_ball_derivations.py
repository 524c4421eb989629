"""What F20 says, held against numbers from elsewhere: integrals over strips with 30 digits."""

from itertools import pairwise

import mpmath as mp
import pytest
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.symbols import l, lam, s

from tests.test_theorems import exact


@pytest.fixture(scope="module", autouse=True)
def _proved():
    catalogue(until=["F20-slopes"])


@pytest.fixture(autouse=True)
def _thirty_digits():
    with mp.workdps(30):
        yield


def tail(x):
    return exact("F20-load", sym.ball_tail, {l: x, sym.ball_angle: mp.atan(1 / x)})


def strip(x, y, power):
    """W_2 or F_2 of a strip over K delta a, by integrals of its pressure."""
    A = mp.sqrt(1 - y * y)
    end = mp.sqrt(A * A + x * x) - x
    return mp.quad(lambda xi: (-2 * xi) ** power * (A * A - xi * xi - 2 * x * xi), [-A, end])


@pytest.mark.parametrize("number", ["0.3", "20"])
@mp.workdps(16)
def test_load_and_friction_are_sums_over_strips(number):
    x = mp.mpf(number)
    known = {l: x, sym.ball_tail: tail(x)}

    def total(power):
        return 2 * mp.quad(
            lambda t: strip(x, mp.sin(t), power) * mp.cos(t), [0, 0.5, 1, 1.4, mp.pi / 2]
        )

    load, friction = total(0), total(1) / 2
    assert mp.almosteq(exact("F20-load", sym.ball_load, known), load, 1e-12)
    assert mp.almosteq(exact("F20", sym.ball_coefficient, known), friction / load, 1e-10)


@pytest.mark.parametrize("number", ["1e-3", "0.3", "20"])
def test_the_sums_of_trailing_edges(number):
    x = mp.mpf(number)
    for symbol, power in ((sym.ball_edges, 1), (sym.ball_cubes, 3)):
        truth = mp.quad(
            lambda t, n=power: (mp.hypot(mp.cos(t), x) - x) ** n * mp.cos(t),
            [0, 0.5, 1, 1.4, 1.55, 1.57, mp.pi / 2],
        )
        found = exact("F20-slopes", symbol, {l: x, sym.ball_tail: tail(x)})
        assert mp.almosteq(found, truth, 1e-14)


def test_the_maximum_is_where_the_root_is():
    def rise(x):
        return exact("F20-peak", sym.ball_slip, {l: x, sym.ball_tail: tail(x)})

    root = mp.findroot(rise, mp.mpf("1.8"))
    assert mp.nstr(root, 8) == "1.8423449"

    def friction(x):
        known = {l: x, sym.ball_tail: tail(x)}
        load = exact("F20-load", sym.ball_load, known)
        return exact("F20", sym.ball_coefficient, known) * load ** mp.mpf("-0.25")

    assert abs(mp.diff(friction, root)) < 1e-10
    assert friction(root) > max(friction(root * 0.99), friction(root * 1.01))


def test_what_is_said_to_fall_falls():
    """The slope of E/l over the whole range, by differences, beside the proof of its sign."""
    places = [mp.mpf(10) ** (mp.mpf(k) / 10) for k in range(-40, 41)]
    values = [exact("F20-peak", sym.ball_slip, {l: x, sym.ball_tail: tail(x)}) / x for x in places]
    assert all(one > two for one, two in pairwise(values))
    assert values[0] > 1e3
    assert values[-1] == pytest.approx(-1 / 3, abs=1e-3)


@pytest.mark.parametrize("drive", ["0.001", "1", "1000"])
def test_the_load_grows_between_its_third_and_fourth_power(drive):
    drive, place = mp.mpf(drive), mp.mpf("0.6")

    def load(at):
        return exact(
            "F20-balance", sym.ball_scaled, {s: at, lam: drive, sym.ball_tail: tail(drive / at)}
        )

    growth = mp.diff(lambda u: mp.log(load(mp.exp(u))), mp.log(place))
    told = exact(
        "F20-balance",
        sym.ball_scaled_s,
        {s: place, lam: drive, sym.ball_angle: mp.atan(place / drive)},
    )
    assert 3 < growth < 4
    assert mp.almosteq(growth * load(place), told, 1e-10)
