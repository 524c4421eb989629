"""The result of a drop in closed form."""

from dataclasses import dataclass

from kvtheory.results.presented import Recorded


@dataclass(frozen=True, kw_only=True)
class Impact(Recorded):
    """A drop without gravity and sliding (fact F32), in SI; forces of a line contact are per unit width.

    `restitution` is the speed up over the speed down, `contact_time` the time from the landing to the
    take-off, `peak_force` and `peak_depth` the largest force and depth; `number` is eta = tau v/D, on which
    restitution alone depends.
    """

    number: float
    restitution: float
    contact_time: float
    peak_force: float
    peak_depth: float
