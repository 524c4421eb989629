"""`kvtheory foundation` and `fit`: from measurements to a scene."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main
from kvtheory.cli.outputs import OutputFile

FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


def scene_output(command: Any) -> Any:
    """Give a command `-o` for the scene that it finds, `--plot` and `--json`."""
    option = click.option(
        "-o",
        "--output",
        type=OutputFile(".toml"),
        help="Write the scene that is found to FILE.toml.",
    )
    return option(console.plot_option(console.overwrite_option(console.json_option(command))))


@main.command(
    example="kvtheory foundation dma.csv --thickness '2 mm' --poisson-ratio 0.3 -o rubber.toml --plot fit.png"
)
@click.argument("data", type=FILE)
@click.option(
    "--thickness", metavar='"2 mm"', help="Thickness of the layer that is the foundation."
)
@click.option("--poisson-ratio", type=float, metavar="0.3", help="Its Poisson's ratio.")
@click.option("--temperature", metavar='"60 degC"', help="Temperature of the foundation.")
@click.option(
    "--shift-factors", type=FILE, help="CSV of T [degC],log10 a_T; default: fitted to the sweeps."
)
@click.option("--vertical", is_flag=True, help="Let moduli shift vertically too.")
@click.option("--modulus", metavar="E|G", help="What the moduli are, if the headers do not say.")
@click.option("--arms", type=click.IntRange(1), help="Default: the fewest within the scatter.")
@click.option("--rtol", type=float, help="Relative misfit allowed, instead of the scatter.")
@click.option(
    "--scene",
    type=FILE,
    help="Scene that is given this foundation; it may have none. Default: Table 1.",
)
@scene_output
def foundation(
    data: Path,
    scene: Path | None,
    output: Path | None,
    plot: Path | None,
    *,
    as_json: bool,
    **how: Any,
) -> None:
    """Fit a Prony series to measured moduli DATA.

    DATA is a CSV of dynamic moduli over frequency (f [Hz],E' [MPa],E'' [MPa] or tan delta) or of a relaxation
    modulus over time, as instruments export it; with a column T, at several temperatures.
    """
    from kvtheory.api import fit_foundation
    from kvtheory.scene import load_scene

    with console.progress_bar("foundation"):
        found = fit_foundation(data, load_scene(scene, foundation=False), **how)
    _finish(found, output, plot, as_json=as_json)
    if found.scene is None and not as_json:
        click.echo("Give --thickness and --poisson-ratio for the foundation of a scene.")


@main.command(
    example="kvtheory fit --data mu.csv --free foundation.stiffness,foundation.retardation_time && "
    "kvtheory fit --data run.csv --free foundation.retardation_time"
)
@console.scene_options
@click.option(
    "--data", type=FILE, required=True, multiple=True,
    help="CSV of friction over velocity (V [mm/s],mu) or over time (t [ms],F_x [N/mm],z_A [mm]); repeatable.",
)  # fmt: skip
@click.option("--free", metavar="KEY,...", help="Quantities of the scene to be fitted.")
@click.option(
    "--models", is_flag=True, help="Weigh Kelvin-Voigt, a springpot and one to three arms instead."
)
@scene_output
def fit(
    scene: str | None, overrides: Sequence[str], data: Sequence[Path], free: str | None,
    output: Path | None, plot: Path | None, *, models: bool, as_json: bool,
) -> None:  # fmt: skip
    """Fit quantities of SCENE to measured friction.

    DATA is friction over velocity, or a time series of the transient. Over velocity, other columns vary
    quantities from row to row: F_z [N] the load, T [degC] the temperature, or any key of the scene. Several
    --data are fitted together.
    """
    from kvtheory.api import fit as find
    from kvtheory.scene import load_scene

    checked = load_scene(scene, overrides)
    with console.progress_bar("fit") as progress:
        found = find(
            checked, list(data), free=console.split(free or ""), models=models, progress=progress
        )
    _finish(found, output, plot, as_json=as_json)


def _finish(found: Any, output: Path | None, plot: Path | None, *, as_json: bool) -> None:
    """Write the files, and print the result."""
    text = found.to_toml() if output else ""

    def save(path: Path) -> None:
        path.write_text(text, encoding="utf-8")

    console.write_files({output: save} if output else {}, found, plot)
    if as_json:
        console.print_json(found.as_dict())
    else:
        click.echo(str(found))
