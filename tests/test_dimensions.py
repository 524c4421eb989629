"""Both sides of every relation have the same dimension, and a wrong one is found."""

from dataclasses import replace

import pytest
from kvtheory.derivations.catalogue import _ask_dimensions
from kvtheory.derivations.dimensions import BASE, EXEMPT, DimensionError, faults, of_unit
from kvtheory.derivations.engine.book import StepError
from kvtheory.derivations.symbols import K, W, tau


def test_every_relation_of_the_catalogue_has_one_dimension(by_label):
    assert [each for record in by_label.values() for each in faults(record, by_label)] == []
    assert all(reason and label in by_label for label, reason in EXEMPT.items())


def test_a_wrong_dimension_is_found_in_every_relation(by_label):
    planted = missed = 0
    for record in by_label.values():
        steps = [
            step
            for step in record.steps
            if step.claim and not {0, "pair"} & {step.claim.lhs, step.claim.rhs, step.claim.check}
        ]
        for step in steps if record.label not in EXEMPT else ():
            factor = (K, 1 / tau, W**2)[planted % 3]
            wrong = replace(step, claim=replace(step.claim, rhs=step.claim.rhs * factor))
            planted += 1
            missed += len(faults(replace(record, steps=(wrong,)), by_label)) != 1
    assert planted > 1500
    assert missed == 0


def test_a_chapter_is_refused_with_a_step_of_wrong_dimension(by_label):
    step = by_label["eq29"].steps[0]
    wrong = replace(step, claim=replace(step.claim, rhs=step.claim.rhs * (1 + tau)))
    _ask_dimensions((by_label["eq29"],))
    with pytest.raises(StepError, match=r"eq29: .* has the dimension"):
        _ask_dimensions((replace(by_label["eq29"], steps=(wrong,)),))


def test_units_are_read():
    units = {
        "J/(mol K)": {"N": 1, "m": 1, "mol": -1, "K": -1},
        "kg/m²": {"N": 1, "s": 2, "m": -3},
        "1/s": {"s": -1},
    }
    for unit, powers in units.items():
        assert of_unit(unit) == tuple(powers.get(base, 0) for base in BASE)
    with pytest.raises(DimensionError, match="furlong"):
        of_unit("furlong")
