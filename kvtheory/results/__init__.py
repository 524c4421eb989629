"""Results of models: values in SI units, and their errors."""

from kvtheory.results.comparison import Check, Comparison, Explanation
from kvtheory.results.errors import (
    AT_REST,
    Certificate,
    DivergenceError,
    QuadratureError,
    ToleranceError,
    TransientError,
)
from kvtheory.results.fits import FewerArms, FoundationFit, FrictionFit
from kvtheory.results.impact import Impact
from kvtheory.results.presented import ClimbStep, Solution, record
from kvtheory.results.steady import (
    AsymptoteLine,
    AsymptoteReport,
    BodyLimits,
    PressureField,
    Stability,
    SteadyState,
)
from kvtheory.results.sweep import Axis, Failure, Sweep
from kvtheory.results.table import (
    QUANTITIES,
    SERIES_UNITS,
    SHOWN_UNITS,
    SPRING_UNITS,
    STABILITY_UNITS,
    STEADY_UNITS,
    TRANSIENT_UNITS,
    units_for,
)
from kvtheory.results.transient import (
    Event,
    Simulation,
    SprungSimulation,
    SprungTransient,
    Transient,
)

__all__ = [
    "AT_REST", "QUANTITIES", "SERIES_UNITS", "SHOWN_UNITS", "SPRING_UNITS", "STABILITY_UNITS",
    "STEADY_UNITS", "TRANSIENT_UNITS", "AsymptoteLine", "AsymptoteReport", "Axis",
    "BodyLimits", "Certificate", "Check", "ClimbStep", "Comparison", "DivergenceError", "Event",
    "Explanation", "Failure", "FewerArms", "FoundationFit", "FrictionFit", "Impact",
    "PressureField", "QuadratureError",
    "Simulation", "Solution", "SprungSimulation", "SprungTransient", "Stability", "SteadyState",
    "Sweep", "ToleranceError", "Transient", "TransientError", "record", "units_for",
]  # fmt: skip
