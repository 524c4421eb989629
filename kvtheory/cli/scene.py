"""`kvtheory scene`: a template, or a check of a scene file."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main

AMBIGUOUS = {"support.stiffness", "drive.stiffness", "drive.damping", "drive.mass"}
"""Keys whose last part occurs in another section too: they are printed with their section."""


@main.command(
    example="kvtheory scene --support fixed > my-scene.toml && kvtheory scene my-scene.toml"
)
@console.scene_options
@console.json_option
@click.option(
    "--support", type=click.Choice(["fixed", "dead-weight", "suspended"]),
    help="Support of the template.",
)  # fmt: skip
@click.option(
    "--problem", metavar="NAME", help='Print a reference problem instead; "list" names them all.'
)
@click.option(
    "-o",
    "--output",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Write the folder of the problem: scene, reference series, criteria, and a script that judges.",
)
def scene(
    scene: str | None, overrides: Sequence[str], as_json: bool, support: str | None,
    problem: str | None, output: Path | None,
) -> None:  # fmt: skip
    """Print a scene template, or check SCENE.

    A check lists every mistake, or prints the quantities and the dimensionless numbers.
    """
    import numpy as np  # not needed for help texts

    from kvtheory.api._model_error import layer_notes
    from kvtheory.reference_problems import problem_text, problems
    from kvtheory.results import record
    from kvtheory.results.presented import value_range
    from kvtheory.scene import load_scene, template
    from kvtheory.scene.capabilities import lacks_ball, lacks_quadratic

    given = bool(scene or overrides or as_json)
    if (problem and (given or support)) or (support and given):
        option, others = (
            ("--problem", "--set, --json or --support")
            if problem
            else ("--support", "--set or --json")
        )
        raise ValueError(f"{option} prints a template; it does not go with SCENE, {others}")
    if output is not None:
        _write_problem(problem, output)
        return
    if problem == "list":
        console.print_table(("problem", "what it is"), problems().items())
        return
    if not given:
        click.echo(
            problem_text(problem) if problem else template(support or "dead-weight") + "\n",
            nl=False,
        )
        return
    checked = load_scene(scene, overrides)
    foundation = checked.foundation
    quantities = {
        key.replace(".", "_") if key in AMBIGUOUS else key.split(".", 1)[1]: value
        for key, value in checked.values().items()
    }
    if foundation.stiffness is not None and np.isfinite(foundation.slow_damping).all():
        name = "slow_damping" if foundation.arms else "damping"
        quantities[name] = foundation.slow_damping
    if foundation.temperature is not None:
        quantities["shift_factor"] = foundation.shift_factor
        quantities |= {
            f"shifted_arms[{i}].relaxation_time": arm.relaxation_time
            for i, arm in enumerate(foundation.arms)
        }
        name = "damping" if foundation.arms else "retardation_time"
        if np.any(shifted := getattr(foundation, name)):
            quantities[f"shifted_{name}"] = shifted
    numbers = {} if lacks_quadratic(checked) else _dimensionless(checked)
    quantities |= numbers
    notes = layer_notes(checked)
    kinds = {
        "shape": checked.indenter.shape, "foundation": foundation.kind,
        "support": checked.support.kind,
    }  # fmt: skip
    if as_json:
        console.print_json(record({**kinds, **quantities, "notes": notes}))
        return
    count = f"{math.prod(checked.shape):,} scenes; " if checked.shape else ""
    click.echo(
        f"Valid: {count}{{shape}} indenter, {{foundation}} foundation, {{support}} support.\n".format(
            **kinds
        )
    )
    rows = [(name, value_range(value, ".6g")) for name, value in quantities.items()]
    console.print_table(("quantity", "value in SI"), rows)
    if not lacks_ball(checked) and checked.drive.ends:
        _print_equivalent_line(checked)
    if not numbers:
        click.echo("\nThe dimensionless numbers are defined for a parabola and a ball only.")
    for note in notes:
        click.echo(f"\n{note}")


def _dimensionless(scene: Any) -> dict[str, Any]:
    """Return the static state of a scene and its dimensionless numbers, or arrays of them."""
    import numpy as np

    from kvtheory.scene.static_state import StaticState

    if not scene.shape:
        return StaticState.of(scene).named()
    flat = scene.flat()
    each = [StaticState.of(flat.rows(i)).named() for i in range(math.prod(scene.shape))]
    return {name: np.reshape([one[name] for one in each], scene.shape) for name in each[0]}


def _write_problem(name: str | None, folder: Path) -> None:
    """Write the folder of a reference problem."""
    from kvtheory.api._problem_folder import write_problem
    from kvtheory.reference_problems import problem_text

    if name is None or name == "list":
        raise ValueError("-o writes the folder of a reference problem; name it by --problem NAME")
    problem_text(name)  # whether it exists
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise ValueError(f"-o {folder}: exists and is not an empty folder; name another")
    click.echo(f"Wrote {write_problem(name, folder)}: start with README.md")


def _print_equivalent_line(scene: Any) -> None:
    """Print the line contact equivalent to a ball, and its error."""
    from kvtheory.api import steady
    from kvtheory.models.steady import ball

    *lengths, load = ball.equivalent_line(steady(scene), scene.indenter.stretch)
    width, depth = (console.text(length, "m") for length in lengths)
    click.echo(
        f"\nEquivalent line contact in steady sliding at this velocity: a parabola of the same radius, "
        f"{width} wide,\nunder {console.text(load, 'N/m')}, at the depth {depth}. Its load is right "
        f"within {ball.LOAD_ERROR:.1%}, its friction\ncoefficient within "
        f"{ball.FRICTION_COEFFICIENT_ERROR:.2%}. It is equivalent at every velocity if the depth is "
        "kept; the depth\nof a dead weight changes with velocity, and with it the width."
    )
