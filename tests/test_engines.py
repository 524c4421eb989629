"""What the page on engines says of the stored series of Drake and MuJoCo."""

import numpy as np
import pytest

import kvtheory as kv
from figures import engines
from figures.benchmark_engines import judged


@pytest.mark.parametrize(
    ("name", "verdict", "words"),
    [
        ("start", "agrees", "All"),
        ("steady", "disagrees", "The data fit tau = 20.09 ms rather than 20 ms"),
        ("reversal", "disagrees", "The indenter meets an undeformed foundation"),
        ("start, Hunt-Crossley", "disagrees", "The damping grows with the compression"),
        ("start, MuJoCo", "disagrees", "The compression rate is delta' alone"),
    ],
)
def test_compare_names_what_an_engine_lacks(name, verdict, words):
    found = judged(name)
    assert found.verdict == verdict
    assert found.diagnosis.startswith(words)


def test_drake_slides_with_the_retardation_time_and_one_step():
    stored, scene = engines.stored(), engines.RUNS["start"].scene

    def deviation(names, **over):
        theory = kv.steady(scene, over=over).friction_coefficient
        measured = [stored[name]["friction_force"][-1] / engines.LOAD for name in names]
        return np.max(np.abs(measured / theory - 1))

    V, steps = np.array(engines.SPEEDS[1:]), np.array(engines.STEPS)
    key, at = "foundation.retardation_time", [f"steady {v:g}" for v in V]
    assert deviation(at, **{"drive.velocity": V, key: engines.TAU + 1e-4}) < 5e-4
    assert 4e-3 < deviation(at, **{"drive.velocity": V}) < 5e-3
    assert deviation([f"step {h:g}" for h in steps], **{key: engines.TAU + steps}) < 3e-4


def test_mujoco_has_no_friction_and_the_depth_that_was_asked_for():
    stored = engines.stored()
    for V in engines.SPEEDS:
        assert stored[f"MuJoCo {V:g}"]["friction_force"][-1] == 0.0
        assert stored[f"MuJoCo {V:g}"]["depth"][-1] == pytest.approx(engines.REST, rel=1e-8)
