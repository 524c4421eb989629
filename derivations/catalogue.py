"""All derivations, in the order in which the document prints them."""

from functools import cache

from derivations import (
    asymptote_errors,
    asymptotics,
    circle,
    contact_interval,
    element_schemes,
    energy,
    friction_identity,
    groups,
    master_curve,
    model,
    power_law,
    power_law_errors,
    power_law_limits,
    power_law_weight,
    steady,
    tables,
    theorems,
    transient_balance,
    transient_edges,
    transient_memory,
    transient_motion,
    transient_rates,
    transient_scaling,
    wedge,
)
from derivations.record import Derivation

_CHAPTERS = (
    *(model, steady, friction_identity, asymptotics, tables, groups),
    *(theorems, master_curve, energy, asymptote_errors, circle),
    *(power_law, power_law_limits, power_law_weight, power_law_errors, wedge),
    *(transient_scaling, transient_memory, contact_interval, transient_edges),
    *(transient_motion, transient_rates, transient_balance),
    element_schemes,
)
"""Each chapter may recall what the chapters before it have established."""

SECTIONS = tuple(dict.fromkeys(chapter.SECTION for chapter in _CHAPTERS))
"""The sections of the document, in order."""


@cache
def catalogue() -> tuple[Derivation, ...]:
    """Derive everything: every step is checked anew, once in the life of the process.

    >>> [derivation.label for derivation in catalogue()][:3]
    ['eq1', 'eq2', 'eq3']
    """
    return tuple(derivation for chapter in _CHAPTERS for derivation in chapter.derive())
