"""`kvtheory steady` and `kvtheory asymptotes`: steady sliding."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kvtheory.cli.console import (
    print_json,
    print_scenes,
    print_steady,
    progress_bar,
    scene_command,
    text,
)
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_results, deliver, result_options

if TYPE_CHECKING:
    from kvtheory.scene import Scene


@scene_command(main, 'kvtheory steady --set drive.velocity="50 mm/s" --json')
@click.option(
    "--method", metavar="exact|quadrature|asymptote",
    help="Default: exact for parabola, power law, wedge and ball, quadrature for others.",
)  # fmt: skip
@result_options
def steady(
    scene: str | None, overrides: Sequence[str], as_json: bool, method: str | None,
    output: Path | None, plot: Path | None,
) -> None:  # fmt: skip
    """Print the state of steady sliding: depth, edges, load, friction, peak pressure."""
    check_results(output, plot)
    with progress_bar("steady"):
        from kvtheory.api import steady as solve
        from kvtheory.results import STEADY_UNITS
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        state = solve(checked, method=method)
    if deliver(state, output, plot, as_json=as_json):
        return
    note_history(checked)
    click.echo(f"Steady sliding, {checked.support.kind} support, model: {state.model}\n")
    if checked.shape:
        print_scenes(checked, state, {name: state.units[name] for name in STEADY_UNITS})
    else:
        print_steady(state, state.units)
    click.echo(f"\nErrors are {state.certificate.kind}: {state.certificate.statement}.")
    for note in state.notes:
        click.echo(note)


@scene_command(main, "kvtheory asymptotes --tolerance 0.01")
@click.option(
    "--tolerance", type=float, default=0.05, show_default=True,
    help="Relative error up to which an asymptote is accepted.",
)  # fmt: skip
def asymptotes(
    scene: str | None, overrides: Sequence[str], as_json: bool, tolerance: float
) -> None:
    """Print which asymptote holds, its error, and over which velocities it holds."""
    with progress_bar("asymptotes"):
        from kvtheory.api import asymptotes as examine
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        report = examine(checked, tolerance=tolerance)
    if as_json:
        print_json(report.as_dict())
        return
    note_history(checked)
    click.echo(f"{checked.support.kind} support, {report}")


def note_history(scene: "Scene") -> None:
    """Print at which velocity of a history steady sliding is taken."""
    if scene.drive.history is not None:
        velocity = text(scene.drive.final_velocity, "m/s")
        click.echo(f"The drive has a history; taken at its final velocity, {velocity}.")
