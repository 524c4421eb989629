"""`kvtheory foundation` and `fit`: from measurements to a scene."""

from pathlib import Path
from typing import Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main
from kvtheory.cli.outputs import OutputFile

FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@main.command(
    example="kvtheory foundation dma.csv --thickness '2 mm' --poisson-ratio 0.3 -o rubber.toml --plot fit.png"
)
@click.argument("data", type=FILE)
@click.option(
    "--thickness", metavar='"2 mm"', help="Thickness of the layer that is the foundation."
)
@click.option("--poisson-ratio", metavar="0.3", help="Its Poisson's ratio.")
@click.option("--temperature", metavar='"60 degC"', help="Temperature of the foundation.")
@click.option(
    "--shift-factors", type=FILE, help="CSV of T [degC],log10 a_T; default: fitted to the sweeps."
)
@click.option("--vertical", is_flag=True, help="Let moduli shift vertically too.")
@click.option("--modulus", metavar="E|G", help="What the moduli are, if the headers do not say.")
@click.option("--arms", type=click.IntRange(1), help="Default: the fewest within the scatter.")
@click.option("--rtol", type=float, help="Relative misfit allowed, instead of the scatter.")
@click.option("--scene", type=FILE, help="Scene that is given this foundation; default: Table 1.")
@click.option(
    "-o",
    "--output",
    type=OutputFile(".toml"),
    help="Write the scene with this foundation to FILE.toml.",
)
@console.plot_option
@console.overwrite_option
@console.json_option
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
        if how["poisson_ratio"] is not None:
            how["poisson_ratio"] = _number(how["poisson_ratio"])
        found = fit_foundation(data, load_scene(scene), **how)
        text = found.to_toml() if output else ""

    def save(path: Path) -> None:
        path.write_text(text, encoding="utf-8")

    console.write_files({output: save} if output else {}, found, plot)
    if as_json:
        console.print_json(found.as_dict())
        return
    click.echo(str(found))
    if found.scene is None:
        click.echo("Give --thickness and --poisson-ratio for the foundation of a scene.")


def _number(text: str) -> Any:
    """Return a number, or the text for a message."""
    try:
        return float(text)
    except ValueError:
        return text
