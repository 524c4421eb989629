"""A discrete simulation as a time series."""

from dataclasses import dataclass

from kvtheory.results.certificate import Certificate
from kvtheory.results.transient import TimeSeries


@dataclass(frozen=True, repr=False)
class Simulation(TimeSeries):
    """A run of the elements as a time series: arrays in SI over `time`; in flight the edges are NaN.

    At an instant where the drive jumps, values are those just after the jump. `per_length` is the
    number of elements per length (1/m), `time_step` the longest step (s), `element_updates` how often
    an element was moved or pressed; `warning` says what is doubtful about the step, if anything.
    """

    scheme: str
    per_length: float
    time_step: float
    steps: int
    element_updates: int
    warning: str
    model: str
    certificate: Certificate
