"""The command line; each command imports what it needs when it runs."""

import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any

import click

SHOWN_UNITS = {
    "m": ("mm", 1e3),
    "N/m": ("N/mm", 1e-3),
    "Pa": ("MPa", 1e-6),
    "m/s": ("mm/s", 1e3),
    "1": ("", 1.0),
}
"""Units of the tables for people, as in the paper; JSON and CSV are in SI."""


class Examples(click.Command):
    """A command whose help ends with an example, printed as it stands."""

    def __init__(self, *args: Any, example: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.example = example

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the options."""
        with formatter.section("Example"):
            formatter.write_text(self.example)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a Kelvin-Voigt foundation.

    Without a scene file, each command works on Table 1 of Nakano and Kono (2020) with a dead
    weight. Exit status: 0 done, 1 a check found disagreement, 2 bad input.
    """


def _teaching(command: Callable[..., None]) -> Callable[..., None]:
    """Turn errors about the input into one message and exit status 2."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except (ValueError, ArithmeticError, OSError, RuntimeError) as error:
            lines = str(error).splitlines()
            head = "error:" if len(lines) == 1 else f"{len(lines)} mistakes:\n "
            click.echo(f"kvtheory: {head} " + "\n  ".join(lines), err=True)
            sys.exit(2)

    return run


def _scene_command(example: str) -> Callable[[Callable[..., None]], click.Command]:
    """Declare a command on an optional scene file, with `--set` and `--json`."""

    def decorate(function: Callable[..., None]) -> click.Command:
        command = _teaching(function)
        command = click.option(
            "--json", "as_json", is_flag=True, help="Print one JSON object, in SI units."
        )(command)
        command = click.option(
            "--set", "overrides", multiple=True, metavar="KEY=VALUE",
            help='Override a key of the scene, such as drive.velocity="50 mm/s"; repeatable.',
        )(command)  # fmt: skip
        command = click.argument(
            "scene", required=False, type=click.Path(exists=True, dir_okay=False)
        )(command)
        return main.command(cls=Examples, example=example)(command)

    return decorate


@_scene_command("kvtheory scene --support fixed > my-scene.toml && kvtheory scene my-scene.toml")
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
        _print_json({**kinds, **quantities})
        return
    click.echo(f"Sound: {checked.indenter.shape} indenter, {checked.support.kind} support.\n")
    rows = [(name, f"{value:.6g}") for name, value in quantities.items()]
    _print_table(("quantity", "value in SI"), rows)
    if not numbers:
        click.echo("\nThe dimensionless numbers are defined for a parabola only.")


@_scene_command('kvtheory steady --set drive.velocity="50 mm/s" --json')
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
        _print_json(state.as_dict())
        return
    errors = state.certificate.relative_error
    rows = [
        (name, *_shown(getattr(state, name), unit), f"{errors[name]:.1e}")
        for name, unit in STEADY_UNITS.items()
    ]
    click.echo(f"Steady sliding, {checked.support.kind} support, model: {state.model}\n")
    _print_table(("quantity", "value", "unit", "relative error"), rows)
    click.echo(f"\nErrors are {state.certificate.kind}: {state.certificate.statement}.")


@_scene_command("kvtheory asymptotes --tolerance 0.01")
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
        _print_json(report.as_dict())
        return
    ratio = abs(report.velocity) / report.critical_velocity
    click.echo(
        f"{checked.support.kind} support, V = {_text(report.velocity, 'm/s')}, critical velocity "
        f"V* = {_text(report.critical_velocity, 'm/s')}, V/V* = {ratio:.4g}: "
        f"{report.regime}-velocity regime"
    )
    if not math.isnan(report.peak_velocity):
        click.echo(
            f"friction maximum: mu = {report.peak_friction_coefficient:.6g} "
            f"at V = {_text(report.peak_velocity, 'm/s')}"
        )
    advice = "the exact solution" if report.use == "exact" else report.use
    click.echo(f"for the friction coefficient to within {tolerance:g}, use {advice}\n")
    rows = [
        (
            line.name, f"({line.equation})" if line.equation else "", line.formula,
            _text(line.value, STEADY_UNITS[line.quantity]),
            _text(line.exact, STEADY_UNITS[line.quantity]),
            "-" if math.isnan(line.relative_error) else f"{line.relative_error:+.3g}",
            _range(line.velocity_min, line.velocity_max),
        )
        for line in report.lines
    ]  # fmt: skip
    _print_table(
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
@_teaching
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
    paths = write(derived, output, _split(formats), _split(only))
    counts: dict[str, int] = {}
    for derivation in derived:
        counts[derivation.status] = counts.get(derivation.status, 0) + 1
    if as_json:
        _print_json(
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


def _split(text: str) -> list[str]:
    return [item.strip() for item in text.split(",") if item.strip()]


def _shown(value: float, unit: str) -> tuple[str, str]:
    name, factor = SHOWN_UNITS[unit]
    return ("-" if math.isnan(value) else f"{value * factor:.6g}"), name


def _text(value: float, unit: str) -> str:
    return "-" if math.isnan(value) else " ".join(_shown(value, unit)).rstrip()


def _range(low: float, high: float) -> str:
    if low == 0.0 and high == float("inf"):
        return "every V"
    return f"|V| <= {_text(high, 'm/s')}" if low == 0.0 else f"|V| >= {_text(low, 'm/s')}"


def _print_json(result: Any) -> None:
    click.echo(json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False))


def _print_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print columns as wide as they need to be."""
    table = [heads, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(heads))]
    for row in table:
        click.echo(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        )
