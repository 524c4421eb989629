"""`kvtheory steady`, `asymptotes` and `stability`: steady sliding."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli import console

if TYPE_CHECKING:
    from kvtheory.scene import Scene


@console.scene_command('kvtheory steady --set drive.velocity="50 mm/s" --json')
@click.option(
    "--method", metavar="exact|quadrature|asymptote|layer",
    help="Default: exact for parabola, power law, wedge and ball, quadrature for others; "
    "layer: the body itself, not its foundation.",
)  # fmt: skip
@console.result_options
def steady(scene: "Scene", progress: Any, method: str | None) -> Iterator[Any]:
    """Print the state of steady sliding: depth, forces, edges."""
    from kvtheory.api import steady as solve
    from kvtheory.results import STEADY_UNITS

    state = solve(scene, method=method, progress=progress)
    yield state
    _print_final_velocity(scene)
    click.echo(f"Steady sliding, {scene.support.kind} support, model: {state.model}\n")
    if scene.shape:
        console.print_scenes(scene, state, {name: state.units[name] for name in STEADY_UNITS})
    else:
        console.print_quantities(state, state.units)
    click.echo(f"\n{state.certificate.sentence}")
    for note in state.notes:
        click.echo(note)


@console.scene_command("kvtheory asymptotes --tolerance 0.01")
@click.option(
    "--tolerance", type=float, default=0.05, show_default=True,
    help="Relative error up to which an asymptote is accepted.",
)  # fmt: skip
def asymptotes(scene: "Scene", progress: Any, tolerance: float) -> Iterator[Any]:
    """Print which asymptotes of friction hold, and their errors.

    Also the velocities over which each holds, and the maxima of friction over velocity.
    """
    from kvtheory.api import asymptotes as examine

    report = examine(scene, tolerance=tolerance)
    yield report
    _print_final_velocity(scene)
    click.echo(f"{scene.support.kind} support, {report}")


@console.scene_command(
    'kvtheory stability --set drive.velocity="91 mm/s" --set drive.stiffness="1 MN/m^2"'
)
@console.result_options
def stability(scene: "Scene", progress: Any) -> Iterator[Any]:
    """Print whether steady sliding on a spring is stable.

    Also the critical stiffness of the spring, and the velocity at the onset of instability.
    The spring drive.stiffness holds the indenter in the sliding direction, with drive.damping and
    drive.mass; without a stiffness the drive is rigid. Stable means against small disturbances: a large
    one, such as a sudden start, may still end in stick-slip. --plot draws the fastest growth over what
    varies, such as drive.velocity = "1 mm/s:1 m/s:50:log", or all rates of one scene.
    """
    from kvtheory.api import stability as examine
    from kvtheory.results import QUANTITIES

    found = examine(scene)
    yield found
    _print_final_velocity(scene)
    kind = scene.support.kind
    units = {name: unit for name, unit in found.units.items() if name in QUANTITIES}
    if scene.shape:
        click.echo(f"Steady sliding, {kind} support\n")
        console.print_scenes(scene, found, {"stable": "1", **units})
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
    units = {name: unit for name, unit in units.items() if not name.startswith("growth")}
    console.print_quantities(found, units, {key: QUANTITIES[key].words})
    if found.rates.size:  # of a pair one; the time constant of a growing motion is negative
        errors = found.certificate.relative_error["rates"]
        rows = [
            (f"{real:.6g}", f"{imaginary / math.tau:.6g}", f"{1e3 * time:.6g}", console.error_text(error))
            for (real, imaginary), time, error in zip(found.rates, found.time_constants, errors, strict=True)
            if imaginary >= 0.0
        ]  # fmt: skip
        heads = "rate [1/s]", "frequency [Hz]", "time constant [ms]", "relative error"
        click.echo()
        console.print_table(heads, rows)
    click.echo(f"\n{found.certificate.sentence}")


def _print_final_velocity(scene: "Scene") -> None:
    """Print the velocity of a history at which steady sliding is computed."""
    if scene.drive.history is not None:
        velocity = console.text(scene.drive.final_velocity, "m/s")
        click.echo(f"The drive has a history; taken at its final velocity, {velocity}.")
