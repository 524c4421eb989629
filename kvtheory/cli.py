"""The commands; each imports what it needs when it runs."""

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kvtheory.console import (
    SHOWN_UNITS,
    Examples,
    print_json,
    print_table,
    scene_command,
    shown,
    split,
    teaching,
    text,
    velocity_range,
)

if TYPE_CHECKING:
    from kvtheory.scene import Scene


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a Kelvin-Voigt foundation.

    Without a scene file, each command works on Table 1 of Nakano and Kono (2020) with a dead
    weight. Exit status: 0 done, 1 a check found disagreement, 2 bad input.
    """


@scene_command(
    main, "kvtheory scene --support fixed > my-scene.toml && kvtheory scene my-scene.toml"
)
@click.option(
    "--support",
    type=click.Choice(["fixed", "dead-weight", "suspended"]),
    default=None,
    help="Support of the template.",
)
def scene(scene: str | None, overrides: Sequence[str], as_json: bool, support: str | None) -> None:
    """Print a commented scene template, or check SCENE and print its dimensionless numbers."""
    from kvtheory.scene import Parabola, load_scene, template
    from kvtheory.scene.numbers import dimensionless_numbers, quantities_by_name

    if support and (scene or overrides or as_json):
        raise ValueError(
            "--support chooses the template; it does not go with SCENE, --set or --json"
        )
    if not (scene or overrides or as_json):
        click.echo(template(support or "dead-weight"))
        return
    checked = load_scene(scene, overrides)
    numbers = dimensionless_numbers(checked) if isinstance(checked.indenter, Parabola) else {}
    quantities = {**quantities_by_name(checked), **numbers}
    if as_json:
        kinds = {"shape": checked.indenter.shape, "support": checked.support.kind}
        print_json({**kinds, **quantities})
        return
    click.echo(f"Sound: {checked.indenter.shape} indenter, {checked.support.kind} support.\n")
    rows = [(name, f"{value:.6g}") for name, value in quantities.items()]
    print_table(("quantity", "value in SI"), rows)
    if not numbers:
        click.echo("\nThe dimensionless numbers are defined for a parabola only.")


@scene_command(main, 'kvtheory steady --set drive.velocity="50 mm/s" --json')
@click.option(
    "--method",
    default=None,
    metavar="exact|quadrature|asymptote",
    help="Default: exact, or quadrature for shapes other than the parabola.",
)
def steady(scene: str | None, overrides: Sequence[str], as_json: bool, method: str | None) -> None:
    """Print the state of steady sliding: depth, edges, load, friction, peak pressure."""
    from kvtheory.api import steady as solve
    from kvtheory.results import STEADY_UNITS
    from kvtheory.scene import load_scene

    checked = load_scene(scene, overrides)
    state = solve(checked, method=method)
    if as_json:
        print_json(state.as_dict())
        return
    _note_history(checked)
    errors = state.certificate.relative_error
    rows = [
        (name, *shown(getattr(state, name), unit), f"{errors[name]:.1e}")
        for name, unit in STEADY_UNITS.items()
    ]
    click.echo(f"Steady sliding, {checked.support.kind} support, model: {state.model}\n")
    print_table(("quantity", "value", "unit", "relative error"), rows)
    click.echo(f"\nErrors are {state.certificate.kind}: {state.certificate.statement}.")


@scene_command(main, "kvtheory asymptotes --tolerance 0.01")
@click.option(
    "--tolerance",
    type=float,
    default=0.05,
    show_default=True,
    help="Relative error up to which an asymptote is good.",
)
def asymptotes(
    scene: str | None, overrides: Sequence[str], as_json: bool, tolerance: float
) -> None:
    """Say which asymptote holds, how wrong it is, and over which velocities."""
    from kvtheory.api import asymptotes as examine
    from kvtheory.results import STEADY_UNITS
    from kvtheory.scene import load_scene

    checked = load_scene(scene, overrides)
    report = examine(checked, tolerance=tolerance)
    if as_json:
        print_json(report.as_dict())
        return
    _note_history(checked)
    ratio = abs(report.velocity) / report.critical_velocity
    click.echo(
        f"{checked.support.kind} support, V = {text(report.velocity, 'm/s')}, critical velocity "
        f"V* = {text(report.critical_velocity, 'm/s')}, V/V* = {ratio:.4g}: "
        f"{report.regime}-velocity regime"
    )
    if not math.isnan(report.peak_velocity):
        click.echo(
            f"friction maximum: mu = {report.peak_friction_coefficient:.6g} "
            f"at V = {text(report.peak_velocity, 'm/s')}"
        )
    advice = "the exact solution" if report.use == "exact" else report.use
    click.echo(f"for the friction coefficient to within {tolerance:g}, use {advice}\n")
    rows = [
        (
            line.name, f"({line.equation})" if line.equation else "", line.formula,
            text(line.value, STEADY_UNITS[line.quantity]),
            text(line.exact, STEADY_UNITS[line.quantity]),
            "-" if math.isnan(line.relative_error) else f"{line.relative_error:+.3g}",
            velocity_range(line.velocity_min, line.velocity_max),
        )
        for line in report.lines
    ]  # fmt: skip
    print_table(
        (
            "asymptote",
            "Eq.",
            "formula",
            "value",
            "exact",
            "relative error",
            f"within {tolerance:g} for",
        ),
        rows,
    )


@main.command(
    cls=Examples, example="kvtheory derive -o derivations-out --format tex,html --only eq27,F3"
)
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("paper/derivations"),
    show_default=True,
    help="Directory to write to.",
)
@click.option(
    "--format",
    "formats",
    default=None,
    metavar="tex,html,pdf,json",
    help="Default: all; pdf where a LaTeX engine is found.",
)
@click.option(
    "--only", default="", metavar="eq27,F3,...", help="Labels of the derivations to print."
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object about what was written."
)
@teaching
def derive(output: Path, formats: str | None, only: str, as_json: bool) -> None:
    """Derive the equations, check every step, and print them as LaTeX, HTML, PDF and JSON."""
    from derivations.catalogue import catalogue
    from derivations.render import latex_engine, write

    if formats is None:
        formats = "tex,html,pdf,json"
        if latex_engine() is None:
            formats = "tex,html,json"
            click.echo(
                "kvtheory: no LaTeX engine (pdflatex) found, so no PDF; the rest is written",
                err=True,
            )
    derived = catalogue()
    paths = write(derived, output, split(formats), split(only))
    counts: dict[str, int] = {}
    for derivation in derived:
        counts[derivation.status] = counts.get(derivation.status, 0) + 1
    if as_json:
        print_json(
            {
                "directory": str(output),
                "files": [str(path) for path in paths],
                "derivations": counts,
            }
        )
        return
    click.echo("Derived and checked: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
    for path in paths:
        if path.parent == output:
            click.echo(f"  {path}")
    fragments = [path for path in paths if path.parent != output]
    if fragments:
        click.echo(f"  {fragments[0].parent}{os.sep} ({len(fragments)} equations for \\input)")


@scene_command(
    main,
    'kvtheory transient --at "0 ms,1 ms,10 ms" && kvtheory transient -o run.csv --plot run.png',
)
@click.option(
    "--rtol", type=float, default=1e-6, show_default=True, help="Error allowed in a step."
)
@click.option("--at", default=None, metavar='"0 ms,1 ms,..."', help="Times to report.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=None,
    help="Write FILE.csv or FILE.nc.",
)
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    default=None,
    help="Draw the series to FILE.png, .svg or .pdf.",
)
def transient(
    scene: str | None,
    overrides: Sequence[str],
    as_json: bool,
    rtol: float,
    at: str | None,
    output: Path | None,
    plot: Path | None,
) -> None:
    """Follow the transient of SCENE: depth, forces, edges and events over time."""
    from kvtheory.api import transient as follow
    from kvtheory.results import TRANSIENT_UNITS
    from kvtheory.scene import load_scene

    result = follow(load_scene(scene, overrides), at=None if at is None else split(at), rtol=rtol)
    if output:
        from kvtheory.export import save_transient

        save_transient(result, output)
    if plot:
        from kvtheory.plots import save_transient_plot

        save_transient_plot(result, plot)
    if as_json:
        print_json(result.as_dict())
        return
    rows = _chosen_rows(result.time.size) if at is None else range(result.time.size)
    names = [name for name in TRANSIENT_UNITS if name != "depth_rate"]
    heads = [f"{name} [{SHOWN_UNITS[TRANSIENT_UNITS[name]][0]}]" for name in names]
    print_table(
        heads,
        [
            [shown(getattr(result, name)[i], TRANSIENT_UNITS[name])[0] for name in names]
            for i in rows
        ],
    )
    click.echo("\nevents:")
    for event in result.events:
        click.echo(f"  {text(event.time, 's')}: {event.kind}")
    worst = max(result.certificate.relative_error.values())
    click.echo(
        f"\n{result.steps} steps; error estimated at {worst:.1e}: {result.certificate.statement}."
    )


def _note_history(scene: "Scene") -> None:
    """Say which velocity of a history counts in steady sliding."""
    if scene.drive.history is not None:
        click.echo(
            f"The drive has a history; taken at its last velocity, {text(scene.drive.final_velocity, 'm/s')}."
        )


def _chosen_rows(count: int, shown_rows: int = 21) -> Sequence[int]:
    """Return the indices of at most about twenty rows, first and last among them."""
    return sorted({round(i * (count - 1) / (shown_rows - 1)) for i in range(shown_rows)})
