"""The whole of a sweep before it is run: what decides every number in it."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.sweep import Axis
from kvtheory.scene.capabilities import lacks_paper_model
from kvtheory.scene.files import to_toml
from kvtheory.scene.model import Scene
from kvtheory.sweeps.axes import size
from kvtheory.sweeps.columns import Column


@dataclass(frozen=True)
class Plan:
    """A scene, what is swept, what is asked, and how it is solved; small and picklable."""

    scene: Scene
    axes: tuple[Axis, ...]
    columns: tuple[Column, ...]
    times: tuple[float, ...] | None
    method: str
    rtol: float

    @cached_property
    def points(self) -> int:
        """How many scenes there are."""
        return size(self.axes)

    @property
    def numeric(self) -> tuple[Column, ...]:
        """The columns of numbers."""
        return tuple(column for column in self.columns if not column.text)

    @property
    def textual(self) -> tuple[Column, ...]:
        """The columns of text."""
        return tuple(column for column in self.columns if column.text)

    @property
    def transient(self) -> bool:
        """Whether any column needs the motion to be followed."""
        return not all(column.steady for column in self.columns)

    @property
    def compared(self) -> set[str]:
        """The steady quantities that columns of the transient are held against."""
        against = ("peak_to_steady_friction", "settling_time")
        return {"friction_force"} if any(c.measure in against for c in self.columns) else set()

    @property
    def by_elements(self) -> bool:
        """Whether elements follow the motion, for the solver does not hold for the scene."""
        return bool(lacks_paper_model(self.scene))

    @property
    def vectorised(self) -> bool:
        """Whether a block is one call on arrays."""
        return not self.transient and self.method != "quadrature"

    @property
    def series(self) -> bool:
        """Whether any column has one value for each time."""
        return any(column.measure == "series" for column in self.columns)

    def shape(self, column: Column) -> tuple[int, ...]:
        """Return the shape of what a column holds for each point: of its times, or of one value."""
        return (len(self.times or ()),) if column.measure == "series" else ()

    def blank(self, points: int) -> dict[str, NDArray[Any]]:
        """Return an array for each column, first over `points`, without values: NaN or no text."""
        return {
            c.name: np.full(
                (points, *self.shape(c)), "" if c.text else np.nan, object if c.text else float
            )
            for c in self.columns
        }

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of each swept key and of each quantity; that of a text is empty."""
        specs = self.scene.replaceable
        swept = {key: specs[key].unit for axis in self.axes for key in axis.values}
        return swept | {column.name: column.unit for column in self.columns}

    def record(self) -> dict[str, Any]:
        """Return what tells this sweep from every other one, ready for JSON.

        Two sweeps with equal records give the same numbers; values are told apart by their digest.
        """
        return {
            "kvtheory": version("kvtheory"),
            "scene": to_toml(self.scene),
            "over": [
                {key: _digest(array) for key, array in axis.values.items()} for axis in self.axes
            ],
            "quantities": [column.name for column in self.columns],
            "at": None if self.times is None else list(self.times),
            "method": self.method,
            "rtol": self.rtol if self.transient else None,
        }


def differences(found: str, plan: Plan) -> list[str]:
    """Name what differs between the record of a file, as JSON text, and that of a plan."""
    ours = plan.record()
    try:
        theirs = json.loads(found)
        return [key for key in ours if theirs[key] != ours[key]]
    except (ValueError, TypeError, KeyError):
        return list(ours)


def _digest(array: Any) -> dict[str, Any]:
    return {
        "count": int(array.size),
        "first": float(array[0]),
        "last": float(array[-1]),
        "sha256": hashlib.sha256(array.astype("<f8").tobytes()).hexdigest(),
    }
