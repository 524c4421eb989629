"""A drive from a CSV of times and velocities."""

from pathlib import Path

from kvtheory.scene.drives import history_points
from kvtheory.scene.quantities import mistake
from kvtheory.scene.tables import numbers, parts, plain, read_table
from kvtheory.scene.units import to_si

KEY = "drive.file"
EXPECTED = 'expected a first line such as "t [ms],V [mm/s]", and then numbers'
NAMES = {
    "s": ("t", "time", "zeit"),
    "m/s": ("v", "velocity", "speed", "drivevelocity", "vdrive", "geschwindigkeit"),
}
"""Possible names of the columns of time and velocity, by their units."""


def history_from(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (t, V) in SI of a CSV whose header names the units; other columns are ignored.

    Raises
    ------
    SceneError
        If the file cannot be read; the message says in which line.
    """
    try:
        table = read_table(path)
        heads = [parts(head) for head in table.heads]
        at, factors = [], []
        for unit, names in NAMES.items():
            found = [i for i, (name, _) in enumerate(heads) if plain(name) in names]
            if len(found) != 1:
                told = "no column" if not found else "more than one column"
                raise ValueError(f"{told} is named {' or '.join(names[:2])}")
            at += found
            factors.append(to_si(f"1 {heads[found[0]][1]}", unit))
        used = [i in at for i in range(len(heads))]
        rows = [numbers(path, table, line, cells, used) for line, cells in table.rows]
    except OSError as error:
        raise mistake(KEY, str(path), f"cannot be read: {error.strerror}") from None
    except ValueError as error:
        told = str(error).removeprefix(f"{path}: ")
        raise mistake(KEY, str(path), f"{told}; {EXPECTED}") from None
    (t, V), (of_t, of_V) = at, factors
    points = [(row[t] * of_t, row[V] * of_V) for row in rows]
    return history_points(points, f"{KEY} ({path.name})")
