"""A point contact after Hunt and Crossley under the weight of this scene: writes point-contact.csv."""

import math
from pathlib import Path

import kvtheory as kv

scene = kv.load_scene(Path(__file__).with_name("scene.toml"))
weight, mass, steady = scene.support.weight, scene.support.mass, kv.steady(scene)
rest = kv.steady(scene, over={"drive.velocity": 0.0}).depth
k, c = weight / rest**1.5, 1.5 * scene.foundation.retardation_time / rest  # as at rest
depth, rate, step = float(rest), 0.0, 1e-5
rows = ["t [s],z_A [m],F_z [N/m],F_x [N/m]"]
for number in range(round(scene.run.duration / step) + 1):
    normal = max(0.0, k * max(depth, 0.0) ** 1.5 * (1.0 + c * rate))
    if number % 50 == 0:
        friction = (
            steady.friction_coefficient * normal * math.copysign(1.0, scene.drive.final_velocity)
        )
        rows.append(f"{number * step!r},{-depth!r},{normal!r},{friction!r}")
    rate += step * (weight - normal) / mass
    depth += step * rate
Path(__file__).with_name("point-contact.csv").write_text("\n".join(rows) + "\n")
