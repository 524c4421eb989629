"""`kvtheory stability`: whether steady sliding is stable on a spring."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from kvtheory.cli.console import (
    print_json,
    print_scenes,
    print_table,
    progress_bar,
    scene_command,
    shown,
)
from kvtheory.cli.group import main
from kvtheory.cli.steady import note_history

if TYPE_CHECKING:
    from kvtheory.results import Stability

UNITS = {
    "critical_stiffness": "N/m^2",
    "lower_critical_stiffness": "N/m^2",
    "frequency": "Hz",
    "critical_velocity": "m/s",
}

WORDS = {"critical_velocity": "velocity at the onset of instability"}
"""What the table says where the name alone is ambiguous: V* of `asymptotes` is another velocity."""


@scene_command(
    main,
    'kvtheory stability --set drive.velocity="91 mm/s" --set drive.stiffness="1 MN/m^2"',
)
def stability(scene: str | None, overrides: Sequence[str], as_json: bool) -> None:
    """Print whether steady sliding is stable, and the critical stiffness of the drive.

    The spring drive.stiffness holds the indenter in the sliding direction, with drive.damping and
    drive.mass; without a stiffness the drive is rigid. Stable means against small disturbances: a large
    one, such as a sudden start, may still end in stick-slip.
    """
    with progress_bar("stability"):
        from kvtheory.api import stability as examine
        from kvtheory.results import units_for
        from kvtheory.scene import load_scene

        checked = load_scene(scene, overrides)
        found = examine(checked)
    if as_json:
        print_json(found.as_dict())
        return
    note_history(checked)
    if checked.shape:
        click.echo(f"Steady sliding, {checked.support.kind} support\n")
        units = {"stable": "1", **units_for(checked.indenter, UNITS)}
        print_scenes(checked, found, units)
        return
    click.echo(f"Steady sliding, {checked.support.kind} support: {_verdict(found)}\n")
    errors = found.certificate.relative_error
    print_table(
        ("quantity", "value", "unit", "relative error"),
        [
            (
                WORDS.get(name, name),
                *shown(getattr(found, name), unit),
                _number(errors.get(name, math.nan)),
            )
            for name, unit in units_for(checked.indenter, UNITS).items()
        ],
    )
    if found.rates.size:
        click.echo()
        print_table(
            ("rate [1/s]", "frequency [Hz]", "time constant [ms]", "relative error"),
            _rates(found),
        )
    click.echo(f"\nErrors are {found.certificate.kind}: {found.certificate.statement}.")


def _verdict(found: "Stability") -> str:
    """Return one line about the stability with this drive."""
    if found.rigid_drive:
        return "stable, for the drive is rigid; the critical stiffness is that of a spring in its place"
    if not found.stable:
        between = found.lower_critical_stiffness > 0.0
        where = "between the critical stiffnesses" if between else "below the critical stiffness"
        return f"unstable, {where} of the spring"
    return "stable against small disturbances; a large one, such as a sudden start, may end in stick-slip"


def _number(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "-"


def _rates(found: "Stability") -> list[tuple[str, str, str, str]]:
    """Return a row for each rate; the time constant of a growing motion is negative."""
    errors = found.certificate.relative_error["rates"]
    return [
        (f"{real:.6g}", f"{imaginary / math.tau:.6g}", shown(time, "s")[0], _number(error))
        for (real, imaginary), time, error in zip(
            found.rates, found.time_constants, errors, strict=True
        )
    ]
