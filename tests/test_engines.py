"""What the page on engines says of the stored series of Drake and MuJoCo."""

from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from figures import engines
from figures.benchmark_engines import judged


@pytest.mark.parametrize(
    ("name", "verdict", "words"),
    [
        ("start", "agrees", "All"),
        ("steady", "disagrees", "The data fit tau = 20.1 ms rather than 20 ms"),
        ("Hunt-Crossley", "disagrees", "The damping grows with the compression"),
        ("MuJoCo", "disagrees", "Friction coefficient: zero throughout"),
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


def test_the_errors_of_drake_are_those_of_the_page():
    """In percent: sharp slopes, the size of the faces of a ball, small steps, and the time step of Lagged."""
    stored = engines.stored()

    def error(name, theory, quantity="friction_force"):
        return 100 * float(stored[name][quantity][-1] / theory - 1)

    sharp = engines.RUNS["radius 0.01"].scene
    sharp = kv.steady(replace(sharp, foundation=kv.Foundation(engines.K, engines.TAU + 1e-4)))
    assert sharp.half_length / 0.01 == pytest.approx(0.11, abs=0.005)
    ball = kv.steady(engines.RUNS["ball 1000"].scene).depth
    law = engines.LOAD * engines.hunt_crossley(0.5)
    for name, theory, quantity, percent in (
        ("radius 0.01", sharp.friction_force, "friction_force", -0.5),
        ("radius 0.01", sharp.depth, "depth", 0.1),
        *(
            (f"ball {n}", ball, "depth", of)
            for n, of in ((250, 21), (500, 6), (1000, 2), (2000, 2))
        ),
        ("steady 2, step 2e-05", engines.LOAD, "normal_force", 0.8),
        ("Hunt-Crossley 0.5", law, "friction_force", 1.3),
        ("Hunt-Crossley 0.5, step 2e-05", law, "friction_force", 0.3),
    ):
        digits = 1 if isinstance(percent, float) else 0
        assert round(error(name, theory, quantity), digits) == percent
