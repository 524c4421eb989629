"""What is reported of a run at one instant."""

from kvtheory.models.elements.contact import (
    ContactSums,
    parts_of_elements,
    pressure,
    whole_elements,
)
from kvtheory.models.elements.row import ElementRow, IndenterState


def report(row: ElementRow, at: IndenterState, time: float) -> tuple[float, ...]:
    """Return the columns at a time, for which the state `at` stands; where V jumps, just after it.

    They are in the order of `error_estimate.COLUMNS`.
    """
    model, V = row.model, row.path.velocity(time)
    under = row.under(at.time, 0.0, max(at.depth, model.depth))
    p = pressure(model, under, at.depth, at.rate, V)
    pressed = under.touched & (model.rule.pulls | (p >= 0.0))
    V_before = row.path.velocity(at.time, before=True)
    p_before = p if V_before == V else pressure(model, under, at.depth, at.rate, V_before)
    found: ContactSums = (
        parts_of_elements(model, under, p, p_before, pressed, at.depth)
        if model.parts
        else whole_elements(model, under, p, pressed)
    )
    edges = found[2:4] if row.path.forward(time) else found[3:1:-1]
    return time, V, at.depth, at.rate, *found[:2], *edges, *found[4:]
