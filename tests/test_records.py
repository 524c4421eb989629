"""Records with named fields: one source reads and writes them, interpreted and compiled."""

import pickle

import numpy as np
import pytest

from kvtheory.records import blanks, filled, new, readable, record, structured, value

SIDE = record(x="f8", state="i8")
NOW = record(depth="f8", count="i8", sides=(SIDE, (2,)), rates=("f8", (3,)))


def sink(now, h):
    """Change fields of all kinds."""
    for k in range(2):
        now.sides[k].x += h * now.rates[k]
        now.sides[k].state = k + 1
    now.depth += h * now.rates[2]
    now.count += 1


def started():
    now = new(NOW, 0.5, 3, [(-1.0, 0), (1.0, 0)], [0.1, 0.2, 0.3])
    assert blanks(1, NOW)[0].sides[1].x == 0.0
    return now


def test_an_object_and_a_structured_array_hold_the_same():
    now = started()
    sink(now, 2.0)
    array = structured([now], NOW)
    assert array.dtype == NOW
    assert array[0].tolist()[:2] == (1.1, 4)
    (again,) = filled(NOW, array)
    assert (again.depth, again.sides[0].x, again.sides[1].state) == (1.1, -0.8, 2)
    assert pickle.loads(pickle.dumps(again)).sides[1].x == again.sides[1].x
    assert value(array[0], "depth") == value(again, "depth") == readable(array[0]).depth


def test_compiled_code_writes_the_same_fields():
    numba = pytest.importorskip("numba")
    one, other = started(), structured([started()], NOW)
    sink(one, 0.25)
    numba.njit(sink)(other[0], 0.25)
    np.testing.assert_array_equal(structured([one], NOW), other)
