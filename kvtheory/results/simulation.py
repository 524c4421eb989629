"""A discrete simulation as a time series."""

from dataclasses import dataclass, fields
from typing import Any

from kvtheory.results.certificate import Certificate, Value, record


@dataclass(frozen=True)
class Simulation:
    """A run of the elements as a time series: arrays in SI over `time`; in flight the edges are NaN.

    At an instant where the drive jumps, values are those just after the jump. `per_length` is the
    number of elements per length (1/m), `time_step` the longest step (s), `element_updates` how often
    an element was moved or pressed; `warning` says what is doubtful about the step, if anything.
    """

    time: Value
    velocity: Value
    depth: Value
    depth_rate: Value
    normal_force: Value
    friction_force: Value
    leading_edge: Value
    trailing_edge: Value
    peak_pressure: Value
    scheme: str
    per_length: float
    time_step: float
    steps: int
    element_updates: int
    warning: str
    model: str
    certificate: Certificate

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON: `time` first; what does not exist is None."""
        return {f.name: record(getattr(self, f.name)) for f in fields(self)}
