"""A drive from a CSV of times and velocities."""

import csv
from collections.abc import Sequence
from pathlib import Path

from kvtheory.scene.quantities import mistake
from kvtheory.scene.texts import read_text
from kvtheory.scene.units import to_si

KEY = "drive.file"
HEAD = 'a first line "t [ms],V [mm/s]", and then two numbers in each line'
SEPARATORS = ",;\t"


def history_from(path: Path) -> list[tuple[float, float]]:
    """Return the points (t, V) in SI of a CSV whose head names the units of both columns.

    Raises
    ------
    SceneError
        If the file cannot be read, saying in which line.
    """
    try:
        text = read_text(path)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise mistake(KEY, str(path), f"cannot be read: {reason}") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    separator = max(SEPARATORS, key=(lines or [""])[0].count)
    rows = list(csv.reader(lines, delimiter=separator))
    try:
        factors = [
            to_si(f"1 {head.partition('[')[2].rstrip('] ')}", unit)
            for head, unit in zip(rows[0][:2], ("s", "m/s"), strict=True)
        ]
    except (IndexError, ValueError) as error:
        raise mistake(KEY, str(path), f"expected {HEAD} ({error})") from None
    return [_point(path, number, row, factors) for number, row in enumerate(rows[1:], start=2)]


def _point(
    path: Path, number: int, row: Sequence[str], factors: Sequence[float]
) -> tuple[float, float]:
    try:
        t, V = (float(cell) * factor for cell, factor in zip(row, factors, strict=True))
    except ValueError as error:
        raise mistake(KEY, str(path), f"row {number}: {error}; expected {HEAD}") from None
    return t, V
