"""All derivations, in the order in which the document prints them."""

import gc
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from itertools import pairwise
from types import ModuleType

from .engine.book import StepError, finished, restore
from .engine.nomenclature import BY_LATEX
from .engine.record import Derivation
from .engine.store import digests, keep, load

CHAPTERS: tuple[ModuleType, ...] = tuple(
    import_module(f".chapters.{name}", __package__)
    for name in (
        *("model", "steady", "one_contact", "friction_identity", "asymptotics", "tables", "groups"),
        *("theorems", "master_curve", "energy", "asymptote_errors", "circle"),
        *("power_law", "power_law_limits", "power_law_weight", "power_law_errors", "wedge"),
        *("ball", "ball_slopes"),
        *("viscoelastic", "relaxation", "viscoelastic_limits", "few_arms", "damped_arms"),
        "viscoelastic_ball",
        *("transient_scaling", "transient_memory", "contact_interval", "transient_edges"),
        *("transient_motion", "transient_rates", "transient_balance"),
        *("spring_drive", "spring_stability", "spring_limits"),
        *("rubber_drive", "rubber_transient"),
        *("drop", "layer", "body"),
        *("element_schemes", "element_edges", "element_strips", "element_arms"),
    )
)
"""Each chapter may recall the results of the chapters before it, and import from them."""

SECTIONS = tuple(dict.fromkeys(chapter.result.section for chapter in CHAPTERS))
"""The sections of the document, in order."""
CONTENTS = {entry.label: entry.title for chapter in CHAPTERS for entry in chapter.result.entries}
"""The titles of all derivations by label."""
SYMBOLS = tuple(BY_LATEX.values())
"""The nomenclature: every symbol that is printed, in the order in which the chapters introduce them."""


def wanted_up_to(labels: Collection[str]) -> int:
    """Return how many records come up to the last of the labels, or in all if there are none."""
    return max((i for i, label in enumerate(CONTENTS, 1) if label in labels), default=len(CONTENTS))


@cache
def _digests() -> dict[str, str]:
    return digests([_name(chapter) for chapter in CHAPTERS])


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
    derived: tuple[Derivation, ...] = chapter.result.derive()
    _ask_dimensions(derived)
    keep(name, _digests()[name], finished(each.label for each in derived))
    return derived


def _ask_dimensions(derived: tuple[Derivation, ...]) -> None:
    """Refuse records with a step whose sides have different units."""
    from .dimensions import faults

    labels = {step.source for each in derived for step in each.steps if step.source}
    sources = {label: each.derivation for label, each in finished(labels).items()}
    for each in derived:
        if found := faults(each, sources):
            raise StepError(found[0])


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
    following = {one: other.result.section for one, other in pairwise(CHAPTERS)}
    with _no_collection():
        for chapter in CHAPTERS:
            derived += _chapter(chapter)
            if report is not None:
                report(min(len(derived) / total, 1.0), f"{len(derived)} records")
            ends = following.get(chapter) != chapter.result.section
            if until and ends and set(until) <= {derivation.label for derivation in derived}:
                break  # a section is derived to its end, for its letters follow from all of it
    return tuple(derived)


@contextmanager
def _no_collection() -> Iterator[None]:
    """Look for no cycles among the many objects that SymPy keeps, which would take a third of the time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
