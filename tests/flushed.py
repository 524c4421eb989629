"""States of many kinds, printed as JSON; with an argument, computed with subnormal numbers flushed to zero.

Any library compiled with -ffast-math may set the processor so, for the whole process.
"""

import ctypes
import json
import math
import mmap
import sys
from dataclasses import replace
from itertools import product

import kvtheory as kv

LDMXCSR = bytes.fromhex("0fae17c3")
"""ldmxcsr (%rdi); ret"""
FLUSHED = 0x1F80 | 1 << 15 | 1 << 6
"""All exceptions masked; results and operands flushed."""


def flush():
    """Set the processor of this thread."""
    page = mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
    page.write(LDMXCSR)
    load = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(
        ctypes.addressof(ctypes.c_char.from_buffer(page))
    )
    load(ctypes.addressof(ctypes.c_uint32(FLUSHED)))
    if sys.float_info.min * float(sys.argv[1]) != 0.0:
        raise SystemExit("subnormal numbers are not flushed")


def scenes():
    """Return scenes by name."""
    wedge = kv.Profile(lambda x: 0.1 * abs(x), lambda x: math.copysign(0.1, x), kinks=(0.0,))
    blunt = kv.Profile(
        lambda x: max(abs(x) - 1e-3, 0.0) ** 2 / 0.02,
        lambda x: math.copysign(max(abs(x) - 1e-3, 0.0) / 0.01, x),
        kinks=(-1e-3, 1e-3),
    )
    sharp = kv.PowerLaw(1.0, 1.02)
    power = kv.Profile(
        lambda x: float(sharp.height(x)), lambda x: float(sharp.slope(x)), kinks=(0.0,)
    )
    shapes = {"parabola": kv.Parabola(0.01), "circle": kv.Circle(0.01), "wedge": kv.Wedge(0.1),
              "power law": sharp, "own wedge": wedge, "own punch": blunt, "own power law": power,
              "ball": kv.Sphere(0.01), "cone": kv.Revolved(kv.Wedge(0.1)),
              "own cone": kv.Revolved(wedge)}  # fmt: skip
    maxwell = kv.GeneralizedMaxwell(1e10, arms=[[3e10, 0.01], [1e9, 3.0]])
    laws = {"kelvin-voigt": kv.Foundation(1e10, 0.1), "maxwell": maxwell}
    for (shape, indenter), (law, foundation) in product(shapes.items(), laws.items()):
        if shape != "own cone" or law == "kelvin-voigt":
            for V in (1e-9, -0.1) if law == "kelvin-voigt" else (1e-9,):
                drive = kv.Drive(velocity=V)
                yield f"{shape}, {law}, {V}", kv.Scene(indenter, foundation, kv.Fixed(1e-4), drive)
    for law, foundation in laws.items():
        yield f"weight, {law}", kv.Scene(foundation=foundation, support=kv.DeadWeight(mass=1000.0))


def states():
    """Return values and relative errors by name."""
    found = {}
    for name, scene in scenes():
        state = kv.steady(scene, method="quadrature") if "own" in name else kv.steady(scene)
        found[name] = {
            key: [float(getattr(state, key)), float(error)]
            for key, error in state.certificate.relative_error.items()
        }
    rest = kv.Scene(run=kv.Run(duration=0.02))
    arms = kv.GeneralizedMaxwell(1e10, arms=[[3e10, 0.01]])
    runs = ("transient", rest.foundation), ("elements", rest.foundation), ("elements", arms)
    for name, foundation in runs:
        run = getattr(kv, name)(replace(rest, foundation=foundation), at=[1e-3, 0.02])
        found[f"{name}, {type(foundation).__name__}"] = {
            key: [float(getattr(run, key)[-1]), 1e-9]
            for key in ("depth", "normal_force", "friction_force")
        }
    return found


if __name__ == "__main__":
    if len(sys.argv) > 1:
        flush()
    print(json.dumps(states()))
