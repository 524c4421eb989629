"""All derivations, in the order in which the document prints them."""

from collections.abc import Callable, Collection
from functools import cache
from types import ModuleType

from . import (
    asymptote_errors,
    asymptotics,
    ball,
    ball_slopes,
    circle,
    contact_interval,
    element_arms,
    element_edges,
    element_schemes,
    element_strips,
    energy,
    few_arms,
    friction_identity,
    groups,
    master_curve,
    model,
    one_contact,
    power_law,
    power_law_errors,
    power_law_limits,
    power_law_weight,
    relaxation,
    rubber_drive,
    rubber_transient,
    spring_drive,
    spring_limits,
    spring_ringing,
    spring_stability,
    steady,
    tables,
    theorems,
    transient_balance,
    transient_edges,
    transient_memory,
    transient_motion,
    transient_rates,
    transient_scaling,
    viscoelastic,
    viscoelastic_limits,
    wedge,
)
from .book import finished, restore
from .contents import CONTENTS
from .record import Derivation
from .store import digests, keep, load

_CHAPTERS = (
    *(model, steady, one_contact, friction_identity, asymptotics, tables, groups),
    *(theorems, master_curve, energy, asymptote_errors, circle),
    *(power_law, power_law_limits, power_law_weight, power_law_errors, wedge),
    *(ball, ball_slopes, viscoelastic, relaxation, viscoelastic_limits, few_arms),
    *(transient_scaling, transient_memory, contact_interval, transient_edges),
    *(transient_motion, transient_rates, transient_balance),
    *(spring_drive, spring_stability, spring_limits, spring_ringing),
    *(rubber_drive, rubber_transient),
    *(element_schemes, element_edges, element_strips, element_arms),
)
"""Each chapter may recall the results of the chapters before it."""

SECTIONS = tuple(dict.fromkeys(chapter.SECTION for chapter in _CHAPTERS))
"""The sections of the document, in order."""


def wanted_up_to(labels: Collection[str]) -> int:
    """Return how many records come up to the last of the labels, or in all if there are none."""
    return max((i for i, label in enumerate(CONTENTS, 1) if label in labels), default=len(CONTENTS))


@cache
def _digests() -> dict[str, str]:
    return digests([_name(chapter) for chapter in _CHAPTERS])


def _name(chapter: ModuleType) -> str:
    return chapter.__name__.rpartition(".")[2]


@cache
def _chapter(chapter: ModuleType) -> tuple[Derivation, ...]:
    """Prove a chapter, or read what was proved from the same sources before."""
    name = _name(chapter)
    known = load(name, _digests()[name])
    if known is not None:
        restore(known)
        return tuple(each.derivation for each in known.values())
    derived: tuple[Derivation, ...] = chapter.derive()
    keep(name, _digests()[name], finished(each.label for each in derived))
    return derived


def catalogue(
    until: Collection[str] = (), report: Callable[[float, str], None] | None = None
) -> tuple[Derivation, ...]:
    """Derive everything, or the chapters up to the last of the labels `until`.

    Every step is checked, unless it was before and nothing has changed since (`store`). `report` is told the
    share done, and how many records that is.

    >>> [derivation.label for derivation in catalogue(until=["eq3"])][:3]
    ['eq1', 'eq2', 'eq3']
    """
    derived: list[Derivation] = []
    total = wanted_up_to(until)
    for chapter in _CHAPTERS:
        derived += _chapter(chapter)
        if report is not None:
            report(min(len(derived) / total, 1.0), f"{len(derived)} records")
        if until and set(until) <= {derivation.label for derivation in derived}:
            break
    return tuple(derived)
