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
from kvtheory.results.certificate import record
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
    return _README.format(
        title=problems()[name], about=about(name), name=name, scene=problem_text(name), what=what,
        certificate=f"{found.certificate.kind}: {found.certificate.statement}",
        rule=_RULES[rule] if problem(name).indenter.per_width else _RULES[rule].replace("N/mm", "N"),
        more=_POINT_CONTACT if name == "point-contact" else "",
    )  # fmt: skip


_RULES = {
    "compare": "`python judge.py my-series.csv` compares a series with columns such as\n`t [ms],z_A [mm],"
    "F_z [N/mm],F_x [N/mm]` with theory. The tolerance of each check follows from the sampling\nand the "
    "noise of the data, and a disagreement is explained.",
    "within": "`python judge.py my-series.csv` compares a series with `reference.csv`; columns and units "
    "are read as by"
    " `kvtheory compare`.\n`criteria.json` gives the allowed difference of each quantity.",
}
_POINT_CONTACT = """
## The failure of a point contact

`simulate.py` supports the indenter by one nonlinear spring and damper, F_z = k d^(3/2) (1 + c d'), after
Hunt and Crossley, with Coulomb friction; the static depth and the friction of steady sliding are fitted.
`python simulate.py && python judge.py point-contact.csv` finds that it disagrees. The normal force of a
contact without length does not depend on sliding: the indenter does not rise from 0.3 mm to 0.09 mm, and
neither force has a peak at the onset of sliding. A hydroelastic contact whose surface has no damping fails
in the same way.
"""
_README = """# {title}

{about}

```toml
{scene}```

The reference, `reference.csv`, is {what}. Its certificate is {certificate}.

![The reference](reference.png)

{rule}
{more}
`kvtheory.problem("{name}")` loads the scene; the command `kvtheory scene` prints it, and writes this folder.
"""


def _json(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _put(text: str, path: Path) -> None:
    path.write_text(text, encoding="utf-8")
