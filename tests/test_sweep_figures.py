"""The pictures that only a sweep can give are held against theory."""

import numpy as np
import pytest

import kvtheory as kv
from figures import onset_maps
from kvtheory.scene.static_state import StaticState


@pytest.fixture(scope="module")
def data():
    return onset_maps.compute()


def test_the_peak_is_that_of_the_fixed_indenter_and_no_inertia_changes_it(data):
    scene = kv.Scene()
    own = StaticState.of(scene)
    velocity = onset_maps.NUMBERS * own.half_length / scene.foundation.retardation_time
    over = {"drive.velocity": velocity}
    at_depth = kv.Scene(support=kv.Fixed(depth=own.depth))
    peak = kv.steady(at_depth, over=over).friction_force
    ratio = peak / kv.steady(scene, over=over).friction_force
    assert data.ratio == pytest.approx(np.tile(ratio, (onset_maps.INERTIAS.size, 1)), rel=1e-9)


def test_hops_come_with_speed_and_mass(data):
    assert not data.hops[:, onset_maps.NUMBERS < 1.0].any()
    assert data.hops[-1, -1] > 1
    assert (data.hops[0] <= 1).all()


def test_what_settles_at_once_is_slow_and_what_does_not_is_fast_and_heavy(data):
    at_once = data.settling == 0.0
    assert at_once[:, onset_maps.NUMBERS < 0.1].all()
    assert not at_once[:, onset_maps.NUMBERS > 0.2].any()
    inertia, number = np.meshgrid(onset_maps.INERTIAS, onset_maps.NUMBERS, indexing="ij")
    later = np.isnan(data.settling)
    assert later.any()
    assert (number * inertia)[later].min() > 5.0


def test_the_columns_are_the_maps(data):
    assert np.array_equal(data.columns["hops [1]"], data.hops.reshape(-1))
    told = data.columns["settling_time/tau [1]"]
    assert told.count("later") == np.isnan(data.settling).sum()


def test_the_picture_shows_the_maps(data):
    drawn = onset_maps.draw(data)
    shown = drawn.axes[0].collections[0].get_array()
    assert np.array_equal(np.asarray(shown), data.ratio)
    hops = drawn.axes[2].collections[0].get_array()
    assert np.array_equal(np.asarray(hops), data.hops)
