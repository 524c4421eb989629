"""Wrong claims: one change each of a claim that holds, so that it holds no more.

Each operator says why. That a side is not zero everywhere is known where the left side is a letter that
cannot vanish. A letter is free if no premise of the claim gives it a value.
"""

import copy
import random

SIGNED = {"positive", "negative"}
FLIPPED = {">": "<", ">=": "<", "<": ">", "<=": ">"}


def _signed(record, tree):
    return isinstance(tree, str) and bool(SIGNED & set(record["symbols"].get(tree, ())))


def _is_number(tree):
    return isinstance(tree, str) and tree.lstrip("-")[:1].isdigit()


def _letters(tree):
    """Yield the symbols in a tree."""
    if isinstance(tree, list):
        for part in tree[1:] if tree[:1] in (["call"], ["indexed"]) else tree:
            yield from _letters(part)
    elif not _is_number(tree):
        yield tree


def _free(record, claim):
    """Return the letters of the claim that are positive and that no premise or condition mentions."""
    others = [each for each in record["claims"] if each["id"] in claim["premises"]]
    tied = {
        letter
        for each in others
        for key in ("left", "name", "variable")
        for letter in _letters(each.get(key, []))
    }
    tied |= {letter for condition in claim["domain"] for letter in _letters(condition)}
    inside = set(_letters([claim["left"], claim["right"]])) & record["symbols"].keys()
    return sorted(each for each in inside - tied if record["symbols"][each] == ["positive"])


def _monomial(term, free):
    """Tell whether a term is a product of a number and powers of free letters: it never vanishes."""
    factors = term[1:] if isinstance(term, list) and term[0] == "*" else [term]
    return all(
        (_is_number(each) and each != "0") or each in free
        or (isinstance(each, list) and each[0] == "^" and each[1] in free and _is_number(each[2]))
        for each in factors
    )  # fmt: skip


def shifted(record, claim, draw):
    """A side is one larger."""
    if claim["kind"] in {"equality", "recalled"}:
        yield {**claim, "right": ["+", claim["right"], "1"]}


def scaled(record, claim, draw):
    """A side that cannot vanish is twice as large."""
    if claim["kind"] == "equality" and _signed(record, claim["left"]):
        yield {**claim, "right": ["*", "2", claim["right"]]}


def negated(record, claim, draw):
    """A side that cannot vanish has the other sign."""
    if claim["kind"] == "equality" and _signed(record, claim["left"]):
        yield {**claim, "right": ["*", "-1", claim["right"]]}


def raised(record, claim, draw):
    """A side that cannot vanish has a free letter, which varies, with a higher power."""
    if claim["kind"] == "equality" and _signed(record, claim["left"]) and claim["right"][0] == "*":
        for letter in _free(record, claim):
            if letter in claim["right"]:
                yield {
                    **claim,
                    "right": [
                        ["^", letter, "2"] if each == letter else each for each in claim["right"]
                    ],
                }


def exchanged(record, claim, draw):
    """A side that cannot vanish has one free letter as a factor in place of another."""
    if claim["kind"] == "equality" and _signed(record, claim["left"]) and claim["right"][0] == "*":
        free = _free(record, claim)
        for one in free:
            others = [each for each in free if each != one]
            if one in claim["right"] and others:
                other = draw.choice(others)
                yield {
                    **claim,
                    "right": [other if each == one else each for each in claim["right"]],
                }


def reweighted(record, claim, draw):
    """A term that never vanishes is counted three times, has the other sign, or is left out of a sum."""
    if (
        claim["kind"] == "equality"
        and isinstance(claim["right"], list)
        and claim["right"][0] == "+"
    ):
        free = _free(record, claim)
        terms = [i for i, term in enumerate(claim["right"]) if i and _monomial(term, free)]
        if terms:
            i, weight = draw.choice(terms), draw.choice(["3", "-1", "0"])
            new = list(claim["right"])
            new[i] = ["*", weight, new[i]]
            yield {**claim, "right": new}


def turned(record, claim, draw):
    """The contrary of an inequality."""
    if claim["kind"] == "inequality":
        yield {**claim, "relation": FLIPPED[claim["relation"]]}


def crossed(record, claim, draw):
    """Two expressions with the sign of a difference, its sides exchanged."""
    if claim["kind"] == "equivalence":
        yield {**claim, "left": claim["right"], "right": claim["left"]}


def another_integrand(record, claim, draw):
    """The integral grows by the length of the interval, as does the antiderivative."""
    if (
        claim["kind"] == "integral"
        and claim["over"][1] != claim["over"][2]
        and "infinity" not in str(claim["over"])
    ):
        new = {**claim, "integrand": ["+", claim["integrand"], "1"],
               "antiderivative": ["+", claim["antiderivative"], claim["over"][0]]}  # fmt: skip
        yield new
        yield {**claim, "integrand": new["integrand"]}
        yield {**claim, "antiderivative": new["antiderivative"]}


def another_value(record, claim, draw):
    """An integral has one value only."""
    if claim["kind"] == "integral":
        yield {**claim, "right": ["+", claim["right"], ["^", "7", "-1"]]}
        if _signed(record, claim["left"]):
            yield {**claim, "over": [claim["over"][0], claim["over"][2], claim["over"][1]]}


def another_limit(record, claim, draw):
    """The ratio to another leading term does not tend to one."""
    if claim["kind"] == "limit":
        weight = draw.choice(["2", "-1", "99/100"])
        yield {**claim, "leading": ["*", weight, claim["leading"]]}


def another_next_term(record, claim, draw):
    """The next term, which is none of higher order, is wrong by a factor."""
    if claim["kind"] == "limit":
        yield {**claim, "next_term": ["*", draw.choice(["2", "-1"]), claim["next_term"]]}


def another_place(record, claim, draw):
    """The only root is elsewhere."""
    if claim["kind"] == "root":
        yield {**claim, "value": ["+", claim["value"], ["^", "3", "-1"]]}
        if isinstance(claim["variable"], str):
            ends = (["+", claim["value"], shift] for shift in ("1", "2"))
            yield {**claim, "over": [claim["variable"], *ends]}


def second_root(record, claim, draw):
    """A factor with another root inside: at k/9973 the polynomial, of small integers, has none itself."""
    if claim["kind"] == "crossing":  # or one with none
        yield {**claim, "expression": ["+", "1", ["^", claim["expression"], "2"]]}
    if claim["kind"] == "unique root":
        variable, low, high = claim["over"]
        place = ["*", f"{draw.randrange(1, 100)}/9973", "1"]
        shift = ["*", "-1", place] if high == ["infinity"] or high == "1" else None
        if low == "0" and shift:
            yield {**claim, "expression": ["*", claim["expression"], ["+", variable, shift]]}


def too_great(record, claim, draw):
    """A greatest value is attained: a larger one is not, and the surplus is not that of a smaller one."""
    if claim["kind"] == "maximum":
        yield {**claim, "value": ["+", claim["value"], "1"]}
        yield {**claim, "surplus": ["+", claim["surplus"], "1"]}


def wider(record, claim, draw):
    """The domain is too large: the sign changes, or another root comes in, within what is added."""
    new = WIDER.get(claim["id"])
    if new:
        yield {**claim, **new}


WIDER = {
    "F15-euler/3": {"over": ["z", "0", "3"]},  # z (2 - z) is negative from 2 on
    "F15-euler/4": {"over": ["z", "1", ["infinity"]]},
    "F15-runge-kutta/12": {"over": ["z", "0", "3"]},  # zero at 2.785
    "F15-runge-kutta/13": {"over": ["z", "2", ["infinity"]]},
    "wedge-low/4": {"over": ["l", "0", "2"], "domain": []},  # (1 - l)(2 + l)
    "F9/0": {"over": ["eta", "0", ["infinity"]]},  # 2 - 2 eta
    "F3/3": {"over": ["q", "0", "4"]},  # 2 - sqrt 3 and 2 + sqrt 3
    "F18-glassy/10": {"over": ["omega_v", "0", "2"], "domain": []},  # w/6 - w^2/9 is zero at 3/2
    "F9-circle/4": {"domain": []},  # R^2 - 3 y^2 changes its sign
    "F9/12": {"domain": []},  # e^s - e^s_1
    "F10-signs/5": {"domain": []},
}  # fmt: skip

OPERATORS = (
    shifted, scaled, negated, raised, exchanged, reweighted, turned, crossed, another_integrand,
    another_value, another_limit, another_next_term, another_place, second_root, too_great, wider,
)  # fmt: skip


def _is_decided(record, claim):
    """Tell whether no integral of an unknown function is in the claim or its premises.

    Of these the checker knows only that integrals are linear, so that it cannot refute.
    """
    text = str([each for each in record["claims"] if each["id"] in claim["premises"]]) + str(claim)
    return "'integral', " not in text or "'call', " not in text


def planted(records, count=None, seed=2026):
    """Yield wrong claims with their operator and record: all, or as many, from each operator in turn."""
    draw = random.Random(seed)
    groups = []
    for operator in OPERATORS:
        found = [
            (operator.__name__, record, new)
            for record in records
            for claim in record["claims"]
            if _is_decided(record, claim)
            for new in operator(record, claim, draw)
        ]
        draw.shuffle(found)
        groups.append(found)
    while any(groups) and (count is None or count > 0):
        for group in groups:
            if group and (count is None or count > 0):
                name, record, claim = group.pop()
                altered = copy.copy(record)
                altered["claims"] = [
                    claim if each["id"] == claim["id"] else each for each in record["claims"]
                ]
                yield name, altered, claim
                count = None if count is None else count - 1
