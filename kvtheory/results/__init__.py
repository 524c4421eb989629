"""What a model answers: values in SI units, and how wrong they may be."""

from kvtheory.results.certificate import Certificate, record
from kvtheory.results.comparison import Check, Comparison, Explanation
from kvtheory.results.simulation import Simulation
from kvtheory.results.solution import ClimbStep, Solution
from kvtheory.results.steady import STEADY_UNITS, AsymptoteLine, AsymptoteReport, SteadyState
from kvtheory.results.transient import TRANSIENT_UNITS, Event, Transient

__all__ = [
    "STEADY_UNITS",
    "TRANSIENT_UNITS",
    "AsymptoteLine",
    "AsymptoteReport",
    "Certificate",
    "Check",
    "ClimbStep",
    "Comparison",
    "Event",
    "Explanation",
    "Simulation",
    "Solution",
    "SteadyState",
    "Transient",
    "record",
]
