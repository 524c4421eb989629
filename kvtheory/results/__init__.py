"""What a model answers: values in SI units, and how wrong they may be."""

from kvtheory.results.certificate import Certificate, record
from kvtheory.results.comparison import Check, Comparison, Explanation
from kvtheory.results.simulation import Simulation
from kvtheory.results.solution import ClimbStep, Solution
from kvtheory.results.steady import AsymptoteLine, AsymptoteReport, SteadyState
from kvtheory.results.table import QUANTITIES, SHOWN_UNITS, STEADY_UNITS, TRANSIENT_UNITS
from kvtheory.results.transient import Event, Transient

__all__ = [
    "QUANTITIES",
    "SHOWN_UNITS",
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
