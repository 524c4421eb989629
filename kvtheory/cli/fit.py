"""`kvtheory foundation` and `fit`: from measurements to a scene."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kvtheory.cli import console
from kvtheory.cli.group import main
from kvtheory.cli.outputs import OutputFile

if TYPE_CHECKING:
    from kvtheory.scene import Scene

FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


def scene_output(*others: str, words: str) -> Any:
    """Give a command `-o` for the scene that it finds, or other files of it, and `--plot`."""
    option = click.option("-o", "--output", type=OutputFile(".toml", *others), help=words)
    return lambda command: option(console.plot_option(console.overwrite_option(command)))


def _save_scene(found: Any, _: Any, path: Path) -> None:
    toml = path.suffix.lower() == ".toml"
    text = found.to_toml() if toml else found.to_card(path.suffix.lower())
    path.write_text(text, encoding="utf-8")


@main.command(
    example="kvtheory foundation dma.csv --thickness '2 mm' --poisson-ratio 0.3 -o rubber.toml --plot fit.png"
)
@click.argument("data", type=FILE)
@click.option(
    "--thickness", metavar='"2 mm"', help="Thickness of the layer that is the foundation, or inf."
)
@click.option("--poisson-ratio", type=float, metavar="0.3", help="Its Poisson's ratio, up to 0.5.")
@click.option("--stiffness", metavar='"3.5 GN/m^3"', help="A measured K, instead of a layer.")
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
@scene_output(
    ".inp", ".mac",
    words="Write the scene that is found to FILE.toml, or a card of Abaqus (.inp) or ANSYS (.mac).",
)  # fmt: skip
@console.json_option
def foundation(
    data: Path, scene: Path | None, output: Path | None, plot: Path | None, *, as_json: bool, **how: Any
) -> None:  # fmt: skip
    """Fit a Prony series to measured moduli DATA.

    DATA is a table of dynamic moduli over frequency (f [Hz],E' [MPa],E'' [MPa], or two of E', E'', |E*| and
    tan delta or phase), of a relaxation modulus or a creep compliance over time, as instruments export it;
    with a column T, at several temperatures. Or it is a card of Abaqus (.inp) or ANSYS (.mac).
    """
    from kvtheory.api import fit_foundation
    from kvtheory.scene import load_scene

    with console.progress_bar("foundation"):
        found = fit_foundation(data, load_scene(scene, foundation=False), **how)
    console.finish(
        found,
        _shown(found, output),
        plot,
        {output: partial(_save_scene, found, None)},
        as_json=as_json,
    )


def _shown(found: Any, output: Path | None) -> Iterator[None]:
    click.echo(str(found))
    if output is not None and output.suffix.lower() != ".toml" and found.left_out:
        click.echo(f"{output.name}: {found.left_out}.")
    if found.scene is None:
        click.echo(
            "Give --thickness and --poisson-ratio, or --stiffness, for the foundation of a scene."
        )
    yield


@console.scene_command(
    "kvtheory fit --data mu.csv --free foundation.stiffness,foundation.retardation_time && "
    "kvtheory fit --data run.csv --free foundation.retardation_time",
    _save_scene,
)
@click.option(
    "--data", type=FILE, required=True, multiple=True,
    help="CSV of friction over velocity (V [mm/s],mu) or over time (t [ms],F_x [N/mm],z_A [mm]); repeatable.",
)  # fmt: skip
@console.names_option("--free", metavar="KEY,...", help="Quantities of the scene to be fitted.")
@click.option(
    "--models", is_flag=True, help="Weigh Kelvin-Voigt, a springpot and one to three arms instead."
)
@click.option(
    "--offset", is_flag=True, help="One unknown more: friction that does not depend on velocity."
)
@scene_output(words="Write the scene that is found to FILE.toml.")
def fit(
    scene: "Scene",
    progress: Any,
    data: Sequence[Path],
    free: list[str] | None,
    *,
    models: bool,
    offset: bool,
) -> Iterator[Any]:
    """Fit quantities of SCENE to measured friction.

    DATA is friction over velocity, or a time series of the transient. Over velocity, other columns vary
    quantities from row to row: F_z [N] the load, T [degC] the temperature, or any key of the scene. Several
    --data are fitted together.
    """
    from kvtheory.api import fit as find

    found = find(
        scene, list(data), free=free or [], models=models, offset=offset, progress=progress
    )
    yield found
    click.echo(str(found))
