"""The folder of a reference problem, as the command `kvtheory scene` writes it.

It can be dropped into another repository: the scene, a reference series with its certificate,
acceptance criteria, a picture, and a script that tests a series.
"""

import json
import shutil
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory import reference_problems
from kvtheory.api._compare import compare
from kvtheory.api._elements import elements
from kvtheory.api._steady import steady
from kvtheory.api._transient import transient
from kvtheory.export import replace_file
from kvtheory.reference_problems import problem, problem_text, problems
from kvtheory.reference_problems.named import about
from kvtheory.results.presented import record
from kvtheory.scene import Scene

DRIVERS = Path(reference_problems.__file__).with_name("drivers")
INSTANTS = 401
"""Rows of a series, evenly over the run."""
SPEEDS = np.geomspace(1e-2, 1e2, 81)
"""Velocities of a steady reference, over that of the scene."""
PER_LENGTH, TIME_STEPS = "200 /mm", 4000
TOLERANCE = 0.02
"""Tolerance of the acceptance criteria, relative to the largest value: a careful simulation meets it."""
JUDGED = ("depth", "normal_force", "friction_force", "friction_coefficient")


def reference(scene: Scene) -> tuple[Any, str]:
    """Return the best reference solution of a scene, and its kind.

    A transient if theory provides it, else a simulation by elements with its estimated error, else steady
    sliding over velocity: a model that does not apply to the scene raises an error.
    """
    for kind, compute in REFERENCES.items():
        try:
            return compute(scene), kind
        except ValueError:
            continue
    raise ValueError("`scene` has no reference: no model applies to it")


def _instants(scene: Scene) -> Any:
    return np.linspace(0.0, scene.run.duration, INSTANTS)


def _transient(scene: Scene) -> Any:
    return transient(scene, at=_instants(scene), rtol=1e-8)


def _elements(scene: Scene) -> Any:
    step = scene.run.duration / TIME_STEPS
    return elements(scene, at=_instants(scene), per_length=PER_LENGTH, time_step=step)


def _steady(scene: Scene) -> Any:
    return steady(scene, over={"drive.velocity": scene.drive.final_velocity * SPEEDS})


REFERENCES = {"transient": _transient, "elements": _elements, "steady": _steady}
"""The kinds, best first; the last exists for every scene."""


def judge(scene: Scene, found: Any, kind: str) -> str:
    """Return the script that tests a series: against theory, if `compare` accepts the scene."""
    if kind == "steady":
        return "within"
    try:
        return "within" if compare(scene, data=found).verdict == "disagrees" else "compare"
    except ValueError:
        return "within"


def criteria(found: Any, kind: str) -> dict[str, Any]:
    """Return the allowed difference of a series from the reference, by quantity in SI, and the quantities.

    It is a share of the largest value; the error of the reference is well below it.
    """
    allowed = {}
    for name in (name for name in JUDGED if hasattr(found, name)):
        values = np.asarray(getattr(found, name))
        largest = float(np.nanmax(np.abs(values)))
        allowed[name] = float(f"{TOLERANCE * largest:.3g}")
    return {"over": "velocity" if kind == "steady" else "time", "allowed": allowed}


def write_problem(name: str, folder: Path) -> Path:
    """Write the folder of a problem, and return it.

    It holds the scene, a reference series with its certificate and picture, acceptance criteria, and a script
    that tests a series.
    """
    scene = problem(name)
    found, kind = reference(scene)
    folder.mkdir(parents=True, exist_ok=True)
    rule = judge(scene, found, kind)
    texts = {
        "scene.toml": problem_text(name),
        "certificate.json": _json({"model": found.model, **record(found.certificate)}),
        "criteria.json": _json(criteria(found, kind)),
        "README.md": readme(name, found, kind, rule),
    }
    for file, text in texts.items():
        replace_file(folder / file, partial(_put, text))
    found.to_csv(folder / "reference.csv")
    found.plot().savefig(folder / "reference.png", dpi=110)
    replace_file(folder / "judge.py", partial(shutil.copy, DRIVERS / f"{rule}.py"))
    if name == "point-contact":
        replace_file(folder / "simulate.py", partial(shutil.copy, DRIVERS / "point_contact.py"))
    return folder


def readme(name: str, found: Any, kind: str, rule: str) -> str:
    """Return the page of a problem in Markdown."""
    what = {
        "transient": "the exact transient",
        "elements": "a simulation by elements, with its estimated error",
        "steady": "steady sliding over velocity",
    }[kind]
    texts = {
        part: (DRIVERS / f"{part}.md").read_text(encoding="utf-8")
        for part in ("README", rule, "point_contact")
    }
    unit = "N/mm" if problem(name).indenter.per_width else "N"
    return texts["README"].format(
        title=problems()[name], about=about(name), name=name, scene=problem_text(name), what=what,
        certificate=f"{found.certificate.kind}: {found.certificate.statement}",
        rule=texts[rule].strip().replace("N/mm", unit),
        more=texts["point_contact"] if name == "point-contact" else "",
    )  # fmt: skip


def _json(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _put(text: str, path: Path) -> None:
    path.write_text(text, encoding="utf-8")
