"""Faults that are another scene: a damper for arms, a rigid drive for a spring, a damper beside it."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kvtheory.checks.faults import WRONG, Trial, judged
from kvtheory.checks.fitting import Bench, Pair
from kvtheory.scene import Scene
from kvtheory.scene.foundations import Foundation

SHARES = (0.01, 0.1, 1.0)
"""Of critical damping: from where the fit of a damper may start."""


def replaced(bench: Bench) -> Iterator[Trial]:
    """Put a damper in the place of arms, and a rigid drive in that of a spring."""
    scene = bench.case.theory.scene
    simpler: list[tuple[str, str, Scene]] = []
    if scene.foundation.arms:
        plain = Foundation(scene.foundation.stiffness, scene.foundation.retardation_time)
        text = (
            "the foundation of the data is Kelvin-Voigt, with the damping C = sum K_i tau_i: its arms have "
            "no stiffness and no relaxation times, which count unless the motion is slow (F18)"
        )
        simpler.append(("Kelvin-Voigt instead of arms", text, replace(scene, foundation=plain)))
    if not scene.drive.rigid:
        text = (
            "the drive of the data is rigid: the indenter slides at the velocity of the drive, where it "
            "swings on the spring of the scene (F22)"
        )
        rigid = replace(scene.drive, stiffness=None, damping=None, mass=None)
        simpler.append(("rigid drive instead of a spring", text, replace(scene, drive=rigid)))
    for name, text, other in simpler:
        curves = bench.solved(other)
        pair = None if curves is None else (bench.columns, curves)
        yield Trial(name, text, judged(bench, pair))


def damper(bench: Bench) -> Iterator[Trial]:
    """Fit a damper beside a spring that has none."""
    scene = bench.case.theory.scene
    if scene.drive.stiffness is None or scene.drive.damping:
        return
    unit = 2.0 * math.sqrt(scene.drive.stiffness * scene.drive_mass)  # that of critical damping

    def damped(x: float) -> Pair | None:
        drive = scene.drive.changed(damping=math.exp(x) * unit)
        curves = bench.solved(replace(scene, drive=drive))
        return None if curves is None else (bench.columns, curves)

    found = bench.fitted(damped, np.log(SHARES).tolist())
    size = math.exp(found.value) * unit
    text = f"the data fit a damper c_x = {size:.4g} N s/m^2 beside the spring in the drive, which has none"
    yield Trial(f"{WRONG}c_x", text, found)
