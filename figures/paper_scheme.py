"""A plain C loop over the elements of the paper's scheme: the peer that the simulator is measured against."""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene import DeadWeight, Drive, Parabola
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]
Loop = Callable[[Any, float, float], tuple[Array, Array, Array, int]]


def compiled_loop() -> Loop | None:
    """Return the C loop, compiled on the spot; None without a compiler.

    It takes a scene, the number of elements per m and the end in s, and returns the times of its steps, the
    depth and the friction force then, and the count of element updates.
    """
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        library = f"{folder}/paper_scheme.so"
        source = str(Path(__file__).with_suffix(".c"))
        command = [compiler, "-O3", "-shared", "-fPIC", source, "-o", library, "-lm"]
        subprocess.run(command, check=True)
        run = ctypes.CDLL(library).run
    pointer = np.ctypeslib.ndpointer(dtype=float, flags="C_CONTIGUOUS")
    run.restype, run.argtypes = (
        ctypes.c_long,
        [ctypes.c_double] * 8 + [ctypes.c_long, pointer, pointer],
    )

    def loop(scene: Any, per_length: float, end: float) -> tuple[Array, Array, Array, int]:
        R, K, tau = (
            scene.indenter.radius,
            scene.foundation.stiffness,
            scene.foundation.retardation_time,
        )
        M, W, V, depth = (
            scene.support.mass,
            scene.support.weight,
            scene.drive.velocity,
            StaticState.of(scene).depth,
        )
        steps = round(end * V * per_length / 2.0)
        depths, frictions = np.empty(steps + 1), np.empty(steps + 1)
        updates = run(R, K, tau, M, W, V, 1.0 / per_length, depth, steps, depths, frictions)
        return np.arange(steps + 1.0) * (2.0 / per_length / V), depths, frictions, int(updates)

    return loop


def suits(scene: Scene) -> bool:
    """Whether the C loop covers a scene: a parabola on Kelvin-Voigt, a dead weight, a constant velocity."""
    V = scene.drive.velocity
    steady = V is not None and scene.drive == Drive(velocity=V)
    plain = isinstance(scene.indenter, Parabola) and not scene.foundation.arms
    return plain and isinstance(scene.support, DeadWeight) and steady
