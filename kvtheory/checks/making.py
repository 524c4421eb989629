"""A check, made or not."""

from kvtheory.checks.comparison_case import Case
from kvtheory.results.comparison import Check


def check(
    case: Case, name: str, measured: float, allowed: float, equation: str, unit: str, note: str = ""
) -> Check:
    """Return a check that was made; `allowed` includes the tolerance."""
    return Check(
        name, float(measured), float(allowed), bool(measured <= allowed), equation, unit, note
    )


def not_made(name: str, equation: str, why: str) -> Check:
    """Return a check that could not be made."""
    return Check(name, None, None, None, equation, "", f"not made: {why}")
