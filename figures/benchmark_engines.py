"""Contact engines compared with theory: `python -m figures.benchmark_engines [--run]`.

What the engines computed is stored in `engines.csv` and judged by `kv.compare`. `--run` computes it anew in
minutes, with pip install ".[peers]".
"""

import argparse
import csv
from collections.abc import Iterator

import numpy as np

import kvtheory as kv
from figures.engines import (
    LIKE_TAU,
    LOAD,
    REST,
    RUNS,
    SERIES,
    SPEEDS,
    STORED,
    TAU,
    G,
    K,
    R,
    Run,
    stored,
)
from kvtheory.scene.static_state import StaticState

REACH = 0.006
"""Half the length of the mesh of the cylinder, in m."""
IMPEDANCE = 0.9
SLIDER = """
<mujoco><option timestep="{step}" gravity="0 0 -{G}"/><worldbody>
  <geom type="plane" size="9 9 1" condim="1" solref="{T} {zeta}" solimp="{d} {d} 1"/>
  <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
    <geom type="sphere" size="{R}" mass="{mass}" condim="1" solref="{T} {zeta}" solimp="{d} {d} 1"/>
  </body></worldbody></mujoco>"""


def by_drake(run: Run) -> Iterator[tuple[float, ...]]:
    """Yield time, depth and forces, of a cylinder on 1 m of width."""
    import pydrake.all as drake

    builder = drake.DiagramBuilder()
    settings = drake.MultibodyPlantConfig(
        time_step=run.step, contact_model="hydroelastic", discrete_contact_approximation=run.solver
    )
    plant, _ = drake.AddMultibodyPlant(settings, builder)
    ground, hard = drake.ProximityProperties(), drake.ProximityProperties()
    for material, d, tau in (ground, LIKE_TAU, TAU), (hard, 0.0, 0.0):  # a solver reads one of both
        smooth = drake.CoulombFriction(0.0, 0.0)
        drake.AddContactMaterial(dissipation=d, friction=smooth, properties=material)
        material.AddProperty("material", "relaxation_time", tau)
    drake.AddCompliantHydroelasticPropertiesForHalfSpace(0.01, 0.01 * K, ground)  # H, E = K H
    below = plant.world_body(), drake.RigidTransform(), drake.HalfSpace()
    plant.RegisterCollisionGeometry(*below, "ground", ground)
    drake.AddRigidHydroelasticProperties(1.0 / run.per_length, hard)
    x = np.linspace(-REACH, REACH, round(2 * REACH * run.per_length) + 1)
    mesh = [
        f"v {xi!r} {y} {xi * xi / (2 * run.radius)!r}" for xi in x.tolist() for y in (-0.5, 0.5)
    ]
    for i in range(1, 2 * x.size - 2, 2):
        mesh += [f"f {i} {i + 1} {i + 2}", f"f {i + 2} {i + 1} {i + 3}"]
    cylinder = drake.InMemoryMesh(mesh_file=drake.MemoryFile("\n".join(mesh), ".obj", "mesh"))
    shape = drake.Sphere(R) if run.ball else drake.Mesh(cylinder)
    carriage, body = (
        plant.AddRigidBody(name, drake.SpatialInertia.SolidSphereWithMass(mass, 1.0))
        for name, mass in (("carriage", 1e-3 * run.mass), ("indenter", run.mass))
    )
    world, frame = plant.world_frame(), carriage.body_frame()
    along = plant.AddJoint(drake.PrismaticJoint("along", world, frame, [1, 0, 0]))
    up = plant.AddJoint(drake.PrismaticJoint("up", frame, body.body_frame(), [0, 0, 1]))
    middle = drake.RigidTransform([0.0, 0.0, R if run.ball else 0.0])
    plant.RegisterCollisionGeometry(body, middle, shape, "hard", hard)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -G])
    plant.Finalize()
    simulator = drake.Simulator(builder.Build())
    state = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    up.set_translation(state, -float(StaticState.of(run.scene).depth))
    for k in range(1, round(run.duration / run.step) + 1):
        # A drive heavy enough to keep its velocity would spoil the tolerance of the solver, which is relative
        # to all momentum. So each step starts anew from V, of which friction takes less than 3e-4.
        along.set_translation_rate(state, -speed(run, k))
        simulator.AdvanceTo(k * run.step)
        found = plant.get_contact_results_output_port().Eval(state)
        infos = map(found.hydroelastic_contact_info, range(found.num_hydroelastic_contacts()))
        F = sum((info.F_Ac_W().translational() for info in infos), np.zeros(3))  # on the ground
        yield k * run.step, -up.get_translation(state), -F[2], -F[0]


def by_mujoco(run: Run) -> Iterator[tuple[float, ...]]:
    """Yield the same of a point contact that rests as deep and creeps as slowly: b/k = TAU."""
    import mujoco

    d = IMPEDANCE
    k = (1 - d) * G / (d * REST)
    T, zeta = 2 / (d * k * TAU), TAU * (d * k) ** 0.5 / 2
    values = {"step": run.step, "G": G, "T": T, "zeta": zeta, "d": d, "R": R, "mass": run.mass}
    model = mujoco.MjModel.from_xml_string(SLIDER.format(**values))
    state = mujoco.MjData(model)
    state.qpos[1] = R - REST
    for i in range(1, round(run.duration / run.step) + 1):
        state.qvel[0] = -speed(run, i)
        mujoco.mj_step(model, state)
        F_x, F_z = state.qfrc_constraint
        yield i * run.step, R - state.qpos[1], F_z, F_x


def speed(run: Run, k: int) -> float:
    """Return the velocity of the base in the k-th step."""
    return [V for t, V in run.history if t < (k - 0.5) * run.step][-1]


def rows(run: Run) -> list[tuple[float, ...]]:
    """Simulate, and return the rows to store."""
    steps = list((by_mujoco if run.solver == "mujoco" else by_drake)(run))
    return steps[len(steps) // run.rows - 1 :: len(steps) // run.rows]


def judged(name: str) -> kv.Comparison:
    """Compare a series, or the friction of a solver over velocity, with theory."""
    found = stored()
    if name in RUNS:
        return kv.compare(RUNS[name].scene, data=found[name], per_length=RUNS[name].per_length)
    mu = [found[f"{name} {V:g}"]["friction_force"][-1] / LOAD for V in SPEEDS]
    return kv.compare(RUNS["start"].scene, data={"velocity": SPEEDS, "friction_coefficient": mu})


def main() -> None:
    """Simulate if asked, and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", action="store_true", help="compute with the engines, and store")
    if parser.parse_args().run:
        lines = [["run", *SERIES]]
        for name, run in RUNS.items():
            lines += [[name, *(f"{cell:.9g}" for cell in row)] for row in rows(run)]
            print(*lines[-1], sep=", ", flush=True)
        with STORED.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(lines)
    for name in (
        "steady",
        "Hunt-Crossley",
        "MuJoCo",
        *(n for n, run in RUNS.items() if run.rows > 1),
    ):
        print(f"{name}: {(found := judged(name)).verdict}. {found.diagnosis}\n")


if __name__ == "__main__":
    main()
