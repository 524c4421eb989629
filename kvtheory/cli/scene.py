"""`kvtheory scene`: a template, or a check of a scene file."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli.console import print_json, print_table, scene_command, text
from kvtheory.cli.group import main

if TYPE_CHECKING:
    from kvtheory.scene import Scene

AMBIGUOUS = {"support.stiffness", "drive.stiffness", "drive.damping", "drive.mass"}
"""Keys whose last part occurs in another section too: they are printed with their section."""


@scene_command(
    main, "kvtheory scene --support fixed > my-scene.toml && kvtheory scene my-scene.toml"
)
@click.option(
    "--support", type=click.Choice(["fixed", "dead-weight", "suspended"]),
    help="Support of the template.",
)  # fmt: skip
@click.option(
    "--problem", metavar="NAME", help='Print a reference problem instead; "list" names them all.'
)
def scene(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    support: str | None,
    problem: str | None,
) -> None:
    """Print a scene template, or check SCENE.

    A check lists every mistake, or prints the quantities and the dimensionless numbers.
    """
    from kvtheory.scene import load_scene, template
    from kvtheory.scene.capabilities import lacks_ball, lacks_quadratic
    from kvtheory.scene.static_state import StaticState

    if problem:
        _print_problem(problem, bare=not (scene or overrides or as_json or support))
        return
    if support and (scene or overrides or as_json):
        raise ValueError(
            "--support chooses the template; it does not go with SCENE, --set or --json"
        )
    if not (scene or overrides or as_json):
        click.echo(template(support or "dead-weight"))
        return
    checked = load_scene(scene, overrides)
    numbers = {} if lacks_quadratic(checked) else StaticState.of(checked).named()
    named = {
        key.replace(".", "_") if key in AMBIGUOUS else key.split(".", 1)[1]: value
        for key, value in checked.values().items()
    }
    damping = {"damping": checked.foundation.damping}
    quantities = {
        **named,
        **(damping if math.isfinite(damping["damping"]) else {}),
        **_shifted(checked.foundation),
        **numbers,
    }
    notes = _notes(checked)
    if as_json:
        kinds = checked.indenter.shape, checked.foundation.kind, checked.support.kind
        print_json(
            {
                **dict(zip(("shape", "foundation", "support"), kinds, strict=True)),
                **quantities,
                "notes": notes,
            }
        )
        return
    click.echo(
        f"Valid: {checked.indenter.shape} indenter, {checked.foundation.kind} foundation, "
        f"{checked.support.kind} support.\n"
    )
    rows = [(name, f"{value:.6g}") for name, value in quantities.items()]
    print_table(("quantity", "value in SI"), rows)
    if not lacks_ball(checked) and checked.drive.ends:
        _tell_line(checked)
    if not numbers:
        click.echo("\nThe dimensionless numbers are defined for a parabola and a ball only.")
    for note in notes:
        click.echo(f"\n{note}")


def _shifted(foundation: Any) -> dict[str, float]:
    """Return a_T and the times that it shifts, at the temperature of the foundation."""
    if foundation.temperature is None:
        return {}
    found = {"shift_factor": foundation.shift_factor}
    if foundation.arms:
        return found | {
            f"shifted_arms[{i}].relaxation_time": arm.relaxation_time
            for i, arm in enumerate(foundation.arms)
        }
    return found | {"shifted_retardation_time": foundation.retardation_time}


def _notes(scene: "Scene") -> tuple[str, ...]:
    """Return whether a layer is thin for the contact at rest."""
    from kvtheory.api import steady
    from kvtheory.scene import Drive

    if scene.foundation.modulus is None:
        return ()
    return steady(replace(scene, drive=Drive(velocity=0.0))).notes


def _print_problem(name: str, *, bare: bool) -> None:
    """Print the scene file of a reference problem, or the list of them."""
    from kvtheory.reference_problems import problem_text, problems

    if not bare:
        raise ValueError(
            "--problem prints a scene; it does not go with SCENE, --set, --json or --support"
        )
    if name == "list":
        print_table(("problem", "what it is"), problems().items())
    else:
        click.echo(problem_text(name), nl=False)


def _tell_line(scene: "Scene") -> None:
    """Print the line contact equivalent to a ball, and its error."""
    from kvtheory.api import steady
    from kvtheory.models.steady.footprint import (
        FRICTION_COEFFICIENT_ERROR,
        LOAD_ERROR,
        equivalent_line,
    )

    line = equivalent_line(steady(scene), scene.indenter.stretch)  # type: ignore[union-attr]
    click.echo(
        f"\nEquivalent line contact in steady sliding at this velocity: a parabola of the same radius, "
        f"{text(line.width, 'm')} wide,\nunder {text(line.load, 'N/m')}, at the depth "
        f"{text(line.depth, 'm')}. Its load is right within {LOAD_ERROR:.1%}, its friction\ncoefficient "
        f"within {FRICTION_COEFFICIENT_ERROR:.2%}. It is equivalent at every velocity if the depth is kept; "
        "the depth\nof a dead weight changes with velocity, and with it the width."
    )
