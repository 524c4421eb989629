"""Many scenes at once: labelled arrays over the values that were swept."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.export import above, xarray
from kvtheory.results.errors import Certificate
from kvtheory.results.presented import Recorded, record
from kvtheory.results.table import STEADY_UNITS
from kvtheory.scene.files import to_toml
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Axis:
    """One dimension of a sweep: the keys that vary along it together, and their values in SI."""

    name: str
    values: Mapping[str, Array]

    @property
    def size(self) -> int:
        """The number of points along it."""
        return int(next(iter(self.values.values())).size)


@dataclass(frozen=True)
class Failure:
    """A scene that failed: its index in C order, its swept values, and the reason."""

    index: int
    point: Mapping[str, float]
    reason: str


@dataclass(frozen=True)
class Sweep(Recorded):
    """Results of many scenes, as arrays over `axes` in SI; a missing value is NaN.

    `values` maps each quantity to an array with one dimension for each axis, and `time` as the last one for a
    series; `events` is an array of JSON texts. The arrays of a sweep in a file (`path`) are read on access.
    `units` covers swept keys and quantities. `computed` counts the points that this call solved; the others
    were in the file already. `failed` counts the scenes that failed; `failures` lists them, for a file the
    first hundred. The errors in the certificate are the largest over the sweep. `model_error` holds the
    largest errors of independent elements against the layer that gives them. `layer` has them and other
    numbers of the layers, from which `notes` follow.
    `plan` (the request) and `read` (reads the arrays) are internal.
    """

    scene: Scene
    axes: tuple[Axis, ...]
    time: Array | None
    units: Mapping[str, str]
    points: int
    computed: int
    failed: int
    failures: tuple[Failure, ...]
    certificate: Certificate
    version: str
    path: Path | None
    plan: Any = field(repr=False, compare=False)
    read: Callable[[], Mapping[str, Any]] = field(repr=False, compare=False)
    layer: Mapping[str, float] = field(default_factory=dict, repr=False, compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def model_error(self) -> Mapping[str, float]:
        """The largest error of each quantity that independent elements have against their layer."""
        return {name: error for name, error in self.layer.items() if name in STEADY_UNITS}

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """The array of each quantity."""
        return self.read()

    @property
    def swept(self) -> Mapping[str, Array]:
        """The values of each swept key."""
        return {key: array for axis in self.axes for key, array in axis.values.items()}

    def __getitem__(self, name: str) -> Any:
        """Return the array of a swept key or a quantity."""
        return self.swept[name] if name in self.swept else self.values[name]

    @property
    def shape(self) -> tuple[int, ...]:
        """The lengths of the axes."""
        return tuple(axis.size for axis in self.axes)

    def to_xarray(self) -> Any:
        """Return an `xarray.Dataset` with labels, units, and the scene in its attributes. Needs xarray.

        Examples
        --------
        >>> import kvtheory as kv
        >>> data = kv.sweep(over={"drive.velocity": ["1 mm/s", "1 m/s"]}).to_xarray()
        >>> data["friction_coefficient"].sel({"drive.velocity": 1.0}).round(4).item()
        0.0294
        """
        dims = [*(axis.name for axis in self.axes), "time"]
        units = {**self.units, "time": "s"}
        held = {name: (dims[: array.ndim], array) for name, array in self.values.items()}
        labels = {
            key: (axis.name, array) for axis in self.axes for key, array in axis.values.items()
        }
        labels |= {} if self.time is None else {"time": ("time", self.time)}
        attributes = {"scene": to_toml(self.scene), "kvtheory_version": self.version}
        attributes["certificate"] = self.certificate.statement
        data = xarray().Dataset(held, labels, attributes)
        for name in data.variables:
            if units[name]:
                data[name].attrs["units"] = units[name]
        return data

    def plot(self, quantity: str | None = None, *, ax: Any = None) -> Any:
        """Draw a quantity as a curve, a family of curves, or a map, and return the matplotlib axes.

        Without a name it is the friction coefficient, or else the first quantity; without `ax` it is drawn on
        a new figure. `ValueError` if it does not exist, is text, or has more than two dimensions.

        Examples
        --------
        >>> import kvtheory as kv
        >>> ax = kv.sweep(over={"drive.velocity": "1 mm/s:10 m/s:9:log"}).plot("friction_coefficient")
        >>> ax.get_xlabel(), ax.get_xscale()
        ('drive velocity $V$ [mm/s]', 'log')
        """
        return above("plots").plot_sweep(ax, self, quantity)

    def save(self, path: str | Path) -> None:
        """Write to ``.csv`` (one row for each point), or to ``.nc`` with netCDF4; see `kvtheory.sweep`."""
        above("sweeps.files").save_sweep(self, Path(path))

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        time = {} if self.time is None else {"time": self.time}
        names = "points", "failed", "failures", "certificate", "model_error", "notes"
        rest = {name: getattr(self, name) for name in names}
        return dict(record({**self.swept, **time, **self.values, **rest}))
