"""`kvtheory steady`, `asymptotes` and `stability`: steady sliding."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kvtheory.cli.console import (
    error_text,
    print_json,
    print_quantities,
    print_scenes,
    print_table,
    progress_bar,
    result_options,
    scene_command,
    text,
    write_result,
)

if TYPE_CHECKING:
    from kvtheory.scene import Scene


@scene_command('kvtheory steady --set drive.velocity="50 mm/s" --json')
@click.option(
    "--method", metavar="exact|quadrature|asymptote",
    help="Default: exact for parabola, power law, wedge and ball, quadrature for others.",
)  # fmt: skip
@result_options
def steady(
    scene: str | None, overrides: Sequence[str], as_json: bool, method: str | None,
    output: Path | None, plot: Path | None,
) -> None:  # fmt: skip
    """Print the state of steady sliding: depth, forces, edges."""
    with progress_bar("steady"):
        from kvtheory.api import steady as solve
        from kvtheory.results import STEADY_UNITS
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        state = solve(checked, method=method)
    if write_result(state, output, plot, as_json=as_json):
        return
    _print_final_velocity(checked)
    click.echo(f"Steady sliding, {checked.support.kind} support, model: {state.model}\n")
    if checked.shape:
        print_scenes(checked, state, {name: state.units[name] for name in STEADY_UNITS})
    else:
        print_quantities(state, state.units)
    click.echo(f"\nErrors are {state.certificate.kind}: {state.certificate.statement}.")
    for note in state.notes:
        click.echo(note)


@scene_command("kvtheory asymptotes --tolerance 0.01")
@click.option(
    "--tolerance", type=float, default=0.05, show_default=True,
    help="Relative error up to which an asymptote is accepted.",
)  # fmt: skip
def asymptotes(
    scene: str | None, overrides: Sequence[str], as_json: bool, tolerance: float
) -> None:
    """Print which asymptotes of friction hold, and their errors.

    Beside them the velocities over which each holds, and the maxima of friction over velocity.
    """
    with progress_bar("asymptotes"):
        from kvtheory.api import asymptotes as examine
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        report = examine(checked, tolerance=tolerance)
    if as_json:
        print_json(report.as_dict())
        return
    _print_final_velocity(checked)
    click.echo(f"{checked.support.kind} support, {report}")


@scene_command('kvtheory stability --set drive.velocity="91 mm/s" --set drive.stiffness="1 MN/m^2"')
def stability(scene: str | None, overrides: Sequence[str], as_json: bool) -> None:
    """Print whether steady sliding on a spring is stable.

    Beside that the critical stiffness of the spring, and the velocity at the onset of instability.
    The spring drive.stiffness holds the indenter in the sliding direction, with drive.damping and
    drive.mass; without a stiffness the drive is rigid. Stable means against small disturbances: a large
    one, such as a sudden start, may still end in stick-slip.
    """
    with progress_bar("stability"):
        from kvtheory.api import stability as examine
        from kvtheory.results import QUANTITIES, STABILITY_UNITS, units_for
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        found = examine(checked)
    if as_json:
        print_json(found.as_dict())
        return
    _print_final_velocity(checked)
    units, kind = units_for(checked.indenter, STABILITY_UNITS), checked.support.kind
    if checked.shape:
        click.echo(f"Steady sliding, {kind} support\n")
        print_scenes(checked, found, {"stable": "1", **units})
        return
    verdict = "stable against small disturbances; a large one, such as a sudden start, may end in stick-slip"
    if found.rigid_drive:
        verdict = "stable, for the drive is rigid; the critical stiffness is that of a spring in its place"
    elif not found.stable:
        between = found.lower_critical_stiffness > 0.0
        where = "between the critical stiffnesses" if between else "below the critical stiffness"
        verdict = f"unstable, {where} of the spring"
    click.echo(f"Steady sliding, {kind} support: {verdict}\n")
    key = "critical_velocity"  # not V* of `asymptotes`, which has the same name
    print_quantities(found, units, {key: QUANTITIES[key].words})
    if found.rates.size:  # the time constant of a growing motion is negative
        rates = zip(found.rates, found.certificate.relative_error["rates"], strict=True)
        rows = [
            (f"{real:.6g}", f"{imaginary / math.tau:.6g}", f"{1e3 * time:.6g}", error_text(error))
            for ((real, imaginary), error), time in zip(rates, found.time_constants, strict=True)
        ]
        click.echo()
        print_table(("rate [1/s]", "frequency [Hz]", "time constant [ms]", "relative error"), rows)
    click.echo(f"\nErrors are {found.certificate.kind}: {found.certificate.statement}.")


def _print_final_velocity(scene: "Scene") -> None:
    """Print at which velocity of a history steady sliding is taken."""
    if scene.drive.history is not None:
        velocity = text(scene.drive.final_velocity, "m/s")
        click.echo(f"The drive has a history; taken at its final velocity, {velocity}.")
