"""Measured friction: over velocity, where other columns are conditions of each row, or over time."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.columns import SPELLINGS, Reader, Table
from kvtheory.scene.mistakes import nearest
from kvtheory.scene.model import SECTIONS, Scene
from kvtheory.scene.tables import parts

Array = NDArray[np.float64]

CONDITIONS = {
    "drive.velocity": ("velocity", "sliding_velocity"), "load": ("load", "normal_force"), "depth": ("depth",),
    "indenter.radius": ("radius",), "foundation.temperature": ("temperature",),
}  # fmt: skip
"""What may vary from row to row, by the names of its spellings."""
FRICTION = "friction_coefficient", "friction_force", "spring_force"
STATIC = {"load": "support.load", "depth": "support.depth"}
"""The keys of a support that are conditions of a row if it has them; on other supports they are measured."""
MOST_ROWS = 2000
"""Most rows over velocity that are used: more would hardly sharpen a fit."""
FEWEST_BINS, MOST_BINS, SPLITS = 64, 256, 16
"""Bins over which a longer time series is averaged, at first and at most, and how many are split at once."""
VISIBLE = 3.0
"""Standard errors from which the two halves of a bin differ visibly."""
LARGEST = 1e30
"""Largest number, and one over the smallest, that is accepted as a measured one: squares do not overflow."""
SAME_CLIMATE = 2.0
"""Range of temperatures in K up to which a scene without a law of them is that of all rows."""
SAME_DRIVE = 0.05
"""Median difference of velocities from those of the scene, over the largest, up to which they agree."""


class Data(NamedTuple):
    """Conditions by key of the scene, and measured quantities, in SI, a value for each row."""

    source: str
    conditions: Mapping[str, Array]  # one value of each in a time series
    measured: Mapping[str, Array]
    notes: tuple[str, ...]
    time: Array | None = None  # s, of a time series
    spread: Any = 0.0  # of a row that is a mean of several, the standard deviation of their times
    weight: Any = 1.0  # and the square root of their number, relative to its root mean square

    @property
    def size(self) -> int:
        """The number of rows."""
        return next(iter(self.measured.values())).size

    def part(self, step: int) -> "Data":
        """Return one row in `step`; over velocity at random in each step, as loads may take turns."""
        rows = np.arange(0, self.size, step)
        if self.time is None:
            shift = np.random.default_rng(0).integers(step, size=rows.size)
            rows = np.minimum(rows + shift, self.size - 1)
        measured = {name: values[rows] for name, values in self.measured.items()}
        if self.time is not None:
            own = {name: getattr(self, name)[rows] for name in ("time", "spread", "weight")}
            return self._replace(measured=measured, **own)
        conditions = {name: values[rows] for name, values in self.conditions.items()}
        return self._replace(measured=measured, conditions=conditions)

    @property
    def thinned(self) -> "Data":
        """The data over velocity, or if they are many, a part of them and a note."""
        step = -(-self.size // MOST_ROWS)
        if step == 1:
            return self
        return self._replace(notes=(*self.notes, f"One row in {step} is used.")).part(step)

    @property
    def averaged(self) -> "Data":
        """The time series, or if it is long, its means over bins, and a note.

        The mean of theory over a bin is that of its values one standard deviation of the times before and
        after their mean: exact up to cubic terms for rows at equal distances. Bins are halved where the
        halves differ by more than the scatter of the rows explains, so that they are short against what
        the data show.
        """
        assert self.time is not None  # for mypy
        rows = np.array([values / np.abs(values).max() for values in self.measured.values()])
        size, scatter = self.size, np.median(np.abs(np.diff(rows)), axis=1)[:, None]
        total = np.pad(np.cumsum(rows, axis=1), ((0, 0), (1, 0)))
        starts = np.arange(size)
        if size > MOST_BINS:
            starts = np.linspace(0, size, FEWEST_BINS, endpoint=False).astype(int)
        while FEWEST_BINS <= starts.size < min(size, MOST_BINS):
            ends = np.append(starts[1:], size)
            middle = (starts + ends) // 2
            left, right = np.maximum(middle - starts, 1), ends - middle
            change = (total[:, ends] - total[:, middle]) / right
            change -= (total[:, middle] - total[:, starts]) / left
            visible = VISIBLE * scatter * np.sqrt(1.0 / left + 1.0 / right)
            excess = np.where(middle > starts, (np.abs(change) - visible).max(axis=0), 0.0)
            split = np.argsort(excess)[-SPLITS:]
            if not excess[split[-1]] > 0.0:
                break
            starts = np.union1d(starts, middle[split[excess[split] > 0.0]])
        count = np.diff(np.append(starts, size))

        def mean(values: Array) -> Array:
            return np.asarray(np.add.reduceat(values, starts) / count)

        time = mean(self.time)
        message = (
            f"{size:,} rows over time were averaged to {starts.size:,}; the misfit is of these."
        )
        return self._replace(
            measured={name: mean(values) for name, values in self.measured.items()},
            notes=self.notes if starts.size == size else (*self.notes, message),
            time=time,
            spread=np.sqrt(mean((self.time - np.repeat(time, count)) ** 2)),
            weight=np.sqrt(count / count.mean()),
        )

    @property
    def nodes(self) -> tuple[Array, Any]:
        """The times at which theory is needed, in order, and the place of two for each row among them."""
        both = np.stack([self.time - self.spread, self.time + self.spread])
        found, at = np.unique(np.maximum(both, 0.0), return_inverse=True)
        return found, at.reshape(both.shape)


def _needed(found: set[str]) -> bool:
    over_time = "time" in found and bool(found & {"load", "depth", "-depth", "support.depth"})
    return over_time or (bool(found & {"time", "drive.velocity"}) and bool(found & set(FRICTION)))


def read(data: Any, scene: Scene) -> Data:
    """Return a table of friction over velocity, or of friction, forces or depth over time."""
    keys = scene.replaceable
    names = {key: key for key in keys}
    for name, spelt in CONDITIONS.items():
        names[name] = ", ".join([name, *(SPELLINGS[each] for each in spelt)])
    names |= {name: SPELLINGS[name] for name in (*FRICTION, "time", "-depth")}
    table = Reader(names, _needed, "a row such as V [mm/s],mu or t [ms],F_x [N]").read(data)
    for head in table.ignored:
        if "." in head and head.partition(".")[0] in SECTIONS:
            raise ValueError(f'{table.source}: column "{head}": {nearest(parts(head)[0], keys)}')
    notes = [*table.notes, *(f"Column {head} is not used." for head in table.ignored)]
    conditions, measured = _columns(table, scene, notes)
    for name, values in measured.items():
        if not np.any(values):
            raise ValueError(f"{table.source}: {name} is zero throughout; there is nothing to fit")
    if len(measured.keys() & {"friction_coefficient", "friction_force"}) > 1:
        notes.append("The friction coefficient is used, and not the friction force.")
        del measured["friction_force"]
    found = Data(table.source, conditions, measured, tuple(notes))
    if "time" in table:
        return _over_time(table, found, scene).averaged
    if not np.any(V := conditions["drive.velocity"]):
        raise table.error("drive.velocity", "is zero throughout; friction needs sliding")
    if against := _against(table, measured, V):
        notes.append(f"In {against} of {V.size} rows friction and velocity have opposite signs.")
    return found._replace(notes=tuple(notes)).thinned


def _against(table: Table, measured: Mapping[str, Array], V: Array) -> int:
    """Return in how many rows friction has not the sign of the velocity; raise if it has in none."""
    against = 0
    for name in measured.keys() & set(FRICTION):
        signs = np.sign(measured[name] * V)
        if signs.min() < 0.0 and signs.max() <= 0.0:
            message = "has the opposite sign of the velocity throughout"
            raise table.error(name, f"{message}; expected friction with the sign of the velocity")
        against = max(against, int(np.count_nonzero(signs < 0.0)))
    return against


def _columns(
    table: Table, scene: Scene, notes: list[str]
) -> tuple[dict[str, Any], dict[str, Array]]:
    """Return the conditions, with one value over time, and what is measured; add notes."""
    keys, over_time = scene.replaceable, "time" in table
    conditions: dict[str, Any] = {}
    measured: dict[str, Array] = {}
    for name in table.columns:
        key = name if over_time else STATIC.get(name, name)
        if name == "time" or (over_time and name == "drive.velocity"):
            continue
        if name == "spring_force" and (scene.drive.rigid or not over_time):
            message = (
                "is measured over time, with drive.stiffness; in steady sliding it is friction"
            )
            raise table.error(name, message)
        if key in keys:
            spec = keys[key]
            values = table.number(name) if spec.unit == "1" else table.si(name, spec.dimension)[0]
            values = _pressing(values, notes) if name == "load" else values
            good = np.array([spec.admits(float(value)) for value in values])
            table.require(name, good, f"is out of range; expected {spec.range}")
            if over_time:
                message = "is not that of the first row; a time series has one value"
                table.require(name, values == values[0], message)
            conditions[key] = float(values[0]) if over_time else values
        elif name == "foundation.temperature" and np.ptp(table.si(name, "K")[0]) <= SAME_CLIMATE:
            notes.append("The temperature does not vary and is unused: the scene has no law of it.")
        elif name == "foundation.temperature":
            message = "needs a scene with foundation.wlf or foundation.activation_energy"
            raise table.error(name, f"{message}, and foundation.reference_temperature")
        elif name in FRICTION or name.removeprefix("-") in STATIC:
            shown = "normal_force" if over_time and name == "load" else name.removeprefix("-")
            values = _measured(table, name, scene)
            measured[shown] = _pressing(values, notes) if shown == "normal_force" else values
        else:
            raise table.error(name, f"is not of this scene; {nearest(name, keys)}")
    return conditions, measured


def _pressing(values: Array, notes: list[str]) -> Array:
    """Return normal forces, which some instruments count upwards."""
    if values.max() >= 0.0:
        return values
    notes.append("The normal force is below 0 throughout, and was read as pressing.")
    return -values


def _measured(table: Table, name: str, scene: Scene) -> Array:
    """Return a measured quantity in SI."""
    if name == "friction_coefficient":
        return plausible(table, name, table.number(name))
    force = "N/m" if scene.indenter.per_width else "N"
    values = plausible(table, name, table.si(name, "m" if name.endswith("depth") else force)[0])
    return -values if name.startswith("-") else values


def plausible(table: Table, name: str, values: Array) -> Array:
    """Return the values of a column in SI, or raise at the first one of a size that nothing measured has."""
    size = np.abs(values)
    good = (size == 0.0) | ((size > 1.0 / LARGEST) & (size < LARGEST))
    message = f"is not plausible; expected a size from {1.0 / LARGEST:g} to {LARGEST:g} in SI units"
    table.require(name, good, message)
    return values


def speeds(scene: Scene, time: Array) -> Array:
    """Return the velocity of the drive at times."""
    drive = scene.drive
    if drive.function is None:
        return np.interp(time, *np.array(drive.points).T)
    return np.array([drive.called(t) for t in time.tolist()])


def largest_speed(scene: Scene, time: Array) -> float:
    """Return the largest speed of the drive during a time series."""
    if scene.drive.function is None:
        return max(abs(V) for _, V in scene.drive.points)
    return float(np.abs(speeds(scene, time)).max())


def _over_time(table: Table, data: Data, scene: Scene) -> Data:
    """Return a time series from t = 0 on; the drive must be that of the scene."""
    time, drive = plausible(table, "time", table.si("time", "s")[0]), scene.drive
    if not (largest_speed(scene, time) > 0.0 or scene.depths):
        message = "`drive` of the scene is at rest throughout; friction needs sliding"
        raise ValueError(f"{table.source}: {message}")
    table.require("time", np.append(True, np.diff(time) > 0.0), "does not follow the time before")
    if "drive.velocity" in table and drive.function is None:
        V = table.si("drive.velocity", "m/s")[0]
        at, given = np.array(drive.points).T
        off = np.median(np.abs(V - np.where(time < 0.0, V, np.interp(time, at, given))))
        if off > SAME_DRIVE * np.abs(V).max():
            message = "is not the drive of the scene; name this file as drive.file, or leave out"
            raise table.error("drive.velocity", f"{message} the time, for steady sliding by rows")
    notes, first = list(data.notes), int(np.searchsorted(time, 0.0))
    if first == time.size:
        raise table.error("time", "is before t = 0, where sliding begins, throughout")
    if first:
        notes.append(f"{first} rows before t = 0, where sliding begins, are not used.")
    if drive.function is None:
        _against(table, data.measured, np.interp(time, *np.array(drive.points).T))
    measured = {name: values[first:] for name, values in data.measured.items()}
    return data._replace(measured=measured, notes=tuple(notes), time=time[first:])
