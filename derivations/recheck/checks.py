"""Confirm, support or refute the claims of `derivations.json`, one record at a time.

`confirmed`: exact arithmetic or balls leave no doubt at the points tried, or a sign is proved everywhere.
`supported`: what was tried agrees, but cannot prove it: limits along sequences, inequalities at points.
`unconfirmed`: nothing was decided. `refuted`: a point contradicts the claim.
"""

import random
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import flint
from flint import arb, fmpq

from .polynomials import proved_sign, real_roots
from .solver import proves
from .trees import INFINITY, MINUS, ONE, ZERO, Rules, Tree, UnsupportedError, put, read
from .values import NEGATIVE, POSITIVE, Facts, Point, UndefinedError, Value, holds, name_of, sign_of

PRECISIONS = (192, 768)
"""Bits of the balls: about 58 digits, and more where these do not decide."""
POINTS, MORE_POINTS, TRIES = 4, 40, 60
"""Points for an equality, and for an inequality that is not proved; draws until one is admissible."""
CLOSE, QUADRATURE = fmpq(1, 10**25), fmpq(1, 10**9)
"""Relative radius of a difference of zero, and of one of integrals."""
STEPS = (16, 32, 64, 128)
"""A limit is approached to 2**-k."""
STATUSES = ("refuted", "unconfirmed", "supported", "confirmed")

Claim = Mapping[str, Any]


@dataclass(frozen=True)
class Verdict:
    """What was found about a claim, and how."""

    status: str
    how: str
    kind: str = ""
    """The kind of the claim."""


EMPTY = Verdict("unconfirmed", "both sides are the same expression")
NO_POINT = Verdict("unconfirmed", "no admissible point was found")


@dataclass
class Question:
    """A claim with its premises: what names stand for, other equations, conditions."""

    values: dict[Tree, Tree]
    equations: dict[Tree, Tree]
    """The sides of premises that give no name its value."""
    conditions: list[Tree]
    facts: Facts
    seed: str
    proved: frozenset[Tree] = frozenset()
    """Integrals whose values were proved: they may be computed instead."""
    linear: bool = False
    """Whether only the linearity of integrals is used: each is a sum over the same places."""
    rules: Rules = field(init=False)

    def __post_init__(self) -> None:
        self.rules = Rules(self.values, (*self.conditions, *self.gaps()))

    def gaps(self) -> list[Tree]:
        """Return differences that vanish by a premise that gives no name its value."""
        return [left - right for left, right in self.equations.items()]

    def where(self, *conditions: Tree) -> "Question":
        """Return the question under more conditions; an equation gives a name its value."""
        named = {each.args[0]: each.args[1] for each in conditions if each.op == "="}
        more = [each for each in conditions if each.op != "="]
        return replace(self, values={**self.values, **named}, conditions=[*self.conditions, *more])

    def without(self, names: Collection[Tree]) -> "Question":
        """Return the question without some premises, which makes a claim the stronger."""
        return replace(
            self, values={lhs: rhs for lhs, rhs in self.values.items() if lhs not in names}
        )

    def named(self) -> "Question":
        """Return the question with each equation as the value of its left side, wherever that is written.

        The letters of the left side are then free: what holds of them all holds where the equations do.
        """
        return replace(self, values={**self.equations, **self.values}, equations={})

    def points(self, *trees: Tree, wanted: int = POINTS) -> Iterator[Point]:
        """Yield points at which those premises and conditions hold that matter to some trees."""
        draw, found, reach, near = random.Random(self.seed), 0, frozenset[Tree](), list[Tree]()
        given, wider = (*self.conditions, *self.gaps()), frozenset(trees)
        while wider != reach:  # what shares a letter with the trees matters, or with what matters
            reach = wider.union(*map(self.rules.reach, trees))
            near = [each for each in given if self.rules.reach(each) & reach]
            wider = reach.union(*map(self.rules.reach, near))
        names, ranges = [lhs for lhs in self.values if lhs in reach], self.ranges()
        conditions = [each for each in self.conditions if each in near]
        equations = [each for each in self.gaps() if each in near]
        for _ in range(TRIES * wanted):
            point = Point(self.rules, self.facts, draw)
            try:
                point.ranges, point.linear = ranges, self.linear
                for equation in equations:
                    self._solve(equation, point)
                named = all(self._admits(each, point) for each in names)
                if named and all(map(point.truth, conditions)):
                    yield point
                    found += 1
            except UndefinedError:
                continue
            if found == wanted:
                return

    def ranges(self) -> dict[Tree, tuple[Value, Value]]:
        """Return the bounds that conditions set to letters by numbers."""
        ranges: dict[Tree, tuple[Value, Value]] = {}
        numbers = Point(self.rules, {}, random.Random(0))
        for relation in (each for each in self.conditions if each.op in {"<", "<=", ">", ">="}):
            less, more = relation.args if "<" in relation.op else relation.args[::-1]
            letters = [each for each in self.rules.reach(more - less) if not self.rules.law(each)]
            if len(letters) != 1 or letters[0].op != "symbol":
                continue
            (letter,), gap = letters, more - less
            try:
                zero, one, two = (numbers.at({letter: fmpq(k)}).value(gap) for k in (0, 1, 2))
            except (UndefinedError, UnsupportedError):
                continue
            low, high = ranges.get(letter, (None, None))
            if not isinstance(one, fmpq | arb) or not _is_zero(two - one - one + zero):
                continue
            end = zero / (zero - one)
            if one > zero and (low is None or end > low):
                low = end
            if one < zero and (high is None or end < high):
                high = end
            ranges[letter] = (low, high)
        return ranges

    def admits(self, point: Point, letter: Tree) -> bool:
        """Tell whether a point with another value of a letter is in the domain."""
        names = [letter, *(lhs for lhs in self.values if letter in self.rules.reach(lhs))]
        try:
            named = all(self._admits(each, point) for each in names)
            return named and all(map(point.truth, self.conditions))
        except UndefinedError:
            return False

    def _admits(self, name: Tree, point: Point) -> bool:
        """Tell whether the value of a name is what is assumed of it."""
        signs = {"positive": ">", "negative": "<", "nonnegative": ">=", "nonpositive": "<="}
        wanted = [signs[fact] for fact in self.facts.get(name_of(name), ()) if fact in signs]
        return not wanted or all(holds(sign, point.value(name)) for sign in wanted)

    def _solve(self, equation: Tree, point: Point) -> None:
        """Give a letter in which an equation is linear the value for which it holds."""

        def rank(letter: Tree) -> tuple[bool, bool, str]:
            signed = (POSITIVE | NEGATIVE) & set(self.facts.get(name_of(letter), ()))
            return letter.op == "call", bool(signed), repr(letter)

        open_ones = (each for each in self.rules.reach(equation) if not self.rules.law(each))
        for letter in sorted(set(open_ones) - point.bound.keys(), key=rank):
            try:
                zero, one, two = (point.at({letter: fmpq(k)}).value(equation) for k in (0, 1, 2))
            except (UndefinedError, UnsupportedError):
                continue
            if _is_zero(two - one - one + zero) and not _is_zero(one - zero):
                point.set(letter, -zero / (one - zero))
                if not self._admits(letter, point):
                    raise UndefinedError("a premise cannot hold here")
                return
        if not _is_zero(point.value(equation)):
            raise UndefinedError("a premise does not hold here")


class Record:
    """The claims of one record, and the records that it may cite."""

    def __init__(self, record: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]]) -> None:
        functions = {f"{name}()": facts for name, facts in record["functions"].items()}
        self.facts: Facts = {**record["symbols"], **functions}
        self.claims = {claim["id"]: claim for claim in record["claims"]}
        self.others = others

    def verdicts(self) -> dict[str, Verdict]:
        """Return what was found about each claim that is no premise."""
        own = (each for each in self.claims.values() if each["kind"] not in _PREMISES)
        return {each["id"]: replace(self.verdict(each), kind=each["kind"]) for each in own}

    def verdict(self, claim: Claim) -> Verdict:
        """Check one claim."""
        if claim["kind"] not in _CHECKS:
            return Verdict("unconfirmed", "a claim of unknown kind")
        try:
            question = self._question(claim)
        except UnsupportedError as error:
            return Verdict("unconfirmed", str(error))
        if question.equations:
            wider = self._found(claim, question.named())
            sides = (read(claim[key]) for key in ("left", "right", "expression") if key in claim)
            # An equation whose slope is asked for is one for all values of its letters.
            law = any(
                each.op == "derivative" and each.args[0] in question.equations for each in sides
            )
            if wider.status in {"supported", "confirmed", *(["refuted"] if law else [])}:
                return wider
        return self._found(claim, question)

    def _found(self, claim: Claim, question: Question) -> Verdict:
        """Ask a question, with wider precision where the balls do not decide."""
        found, before = NO_POINT, flint.ctx.prec
        try:
            for flint.ctx.prec in PRECISIONS:
                found = _CHECKS[claim["kind"]](self, claim, question)
                if found.status != "unconfirmed":
                    break
        except (UnsupportedError, UndefinedError, RecursionError) as error:
            return Verdict("unconfirmed", str(error))
        finally:
            flint.ctx.prec = before
        return found

    def _question(self, claim: Claim) -> Question:
        values, equations, proved = {}, {}, set()
        for premise in map(self.claims.__getitem__, claim["premises"]):
            left, right = _sides(premise)
            if premise["kind"] == left.op == "integral":
                proved.add(left)
            if left.op in {"symbol", "call", "integral", "sum"}:
                values[left] = right
            else:
                equations[left] = right
        conditions = [read(each) for each in claim["domain"]]
        return Question(values, equations, conditions, self.facts, claim["id"], frozenset(proved))

    def recalled(self, claim: Claim, question: Question) -> Verdict:
        """Check that the source has established the relation, and under no other conditions."""
        source = self.others.get(claim["source"])
        if source is None:
            return Verdict("unconfirmed", "its source is not in the file")
        places = {read(name): read(place) for name, place in claim.get("at", ())}
        plain = Question({}, {}, [], self.facts, claim["id"])
        known = [each for each in source["claims"] if each["kind"] in _ESTABLISHING]
        left, _ = _sides(claim)
        for other in sorted(known, key=lambda each: _sides(each)[0] is not left):
            pairs = [
                (put(side, places) if side.has(*places) else side, mine)
                for side, mine in zip(_sides(other), _sides(claim), strict=True)
            ]
            if all(
                a is b or (places and _equal(plain, a, b).status == "confirmed") for a, b in pairs
            ):
                for condition in (_placed(read(each), places) for each in other["domain"]):
                    stated = condition in question.conditions
                    for point in () if stated else question.points(condition):
                        if not point.truth(condition):
                            return Verdict("refuted", f"without the condition {condition}")
                return Verdict(
                    "confirmed", "as in its source" + (", at one place" if places else "")
                )
        return Verdict("refuted", "its source does not establish it")

    def leading_term(self, claim: Claim, _: Question) -> Verdict:
        """Check that the source has proved this leading term."""
        source = self.others.get(claim["source"], {"claims": ()})
        found = any(
            each["kind"] == "limit"
            and (each["expression"], each["leading"]) == (claim["of"], claim["right"])
            for each in source["claims"]
        )
        return (
            Verdict("confirmed", "as in its source")
            if found
            else Verdict("refuted", "its source does not establish it")
        )

    def pair(self, claim: Claim, _: Question) -> Verdict:
        """Return what is found about both relations, which stand in this record."""
        found = []
        for relation in (claim["one"], claim["other"]):
            each = next(
                (each for each in self.claims.values() if _relation(each) == relation), None
            )
            if each is None:
                return Verdict("refuted", "no claim of this record")
            found.append(self.verdict(each))
        return _worst(found)

    def equality(self, claim: Claim, question: Question) -> Verdict:
        """Compare both sides, in each case; sides that are the same tree claim nothing."""
        if claim["left"] == claim["right"]:
            return EMPTY
        cases = [question.where(read(case)) for case in claim.get("cases", ())] or [question]
        return _worst(_equal(each, *_sides(claim)) for each in cases)

    def inequality(self, claim: Claim, question: Question) -> Verdict:
        """Prove the sign of the difference, or look at points; in each case."""
        cases = [question.where(read(case)) for case in claim.get("cases", ())] or [question]
        left, right = _sides(claim)
        over = _inside(*map(read, claim["over"])) if "over" in claim else ()
        return _worst(_signed(each.where(*over), left - right, claim["relation"]) for each in cases)

    def integral(self, claim: Claim, question: Question) -> Verdict:
        """Differentiate the antiderivative, compare its ends with the value, and integrate by quadrature."""
        over = variable, low, high = tuple(map(read, claim["over"]))
        (left, value), inner = _sides(claim), read(claim["integrand"])
        primitive = read(claim["antiderivative"])
        defined, question = question.values.get(left), question.without({left})
        within = question.where(*_inside(*over))
        found = [_equal(within, Tree("derivative", primitive, variable), inner)]
        if defined is not None:
            found.append(_equal(question, defined, Tree("integral", inner, *over)))
        if left.op == "integral":
            found.append(_equal(within, left.args[0], inner))
            found += [
                _equal(question, *ends) for ends in zip(left.args[2:], (low, high), strict=True)
            ]
        if INFINITY in (low, high):
            return _worst([*found, _far(question, primitive, over, value)])
        at_ends = put(primitive, {variable: high}) - put(primitive, {variable: low})
        found.append(_equal(question, value, at_ends))
        if found[-1].status == "confirmed" and not any(
            each.op == "call" for each in question.rules.reach(inner)
        ):
            found.append(_quadrature(question, Tree("integral", inner, *over), value))
        return _worst(found)

    def root(self, claim: Claim, question: Question) -> Verdict:
        """Insert the root, and count the roots in the interval."""
        expression, variable, value = (
            read(claim[key]) for key in ("expression", "variable", "value")
        )
        facts = set(self.facts.get(name_of(variable), ()))
        ends = [
            ZERO if facts & POSITIVE else MINUS * INFINITY,
            ZERO if facts & NEGATIVE else INFINITY,
        ]
        if "over" in claim:
            ends = [read(end) for end in claim["over"][1:]]
        placed = replace(question, values={**question.values, variable: value})
        inserted = _equal(placed, expression, ZERO)
        if inserted.status == "refuted":
            return inserted
        return _worst([inserted, _only(question, expression, variable, ends, value)])

    def unique_root(self, claim: Claim, question: Question) -> Verdict:
        """Count the roots in the interval."""
        variable, *ends = map(read, claim["over"])
        return _only(question, read(claim["expression"]), variable, ends)

    def crossing(self, claim: Claim, question: Question) -> Verdict:
        """Look for opposite signs at the ends, and for one sign of the slope between them."""
        expression, (variable, low, high) = read(claim["expression"]), map(read, claim["over"])
        slope = Tree("derivative", expression, variable)
        within, rises = question.where(*_inside(variable, low, high)), set()
        for point in question.points(expression):
            places = []
            for end, sign in ((low, 1), (high, -1)):
                large = fmpq(-sign) * 2 ** STEPS[0]
                places.append(
                    large if end.has(INFINITY) else point.value(end) + fmpq(sign, 2 ** STEPS[1])
                )
            below, above = (
                sign_of(point.at({variable: place}).value(expression)) for place in places
            )
            if below * above >= 0:
                return Verdict("refuted", "the ends have the same sign at a point")
            rises.add(above)
        if len(rises) != 1:
            return Verdict("unconfirmed", "it rises at some points and falls at others")
        found = [_signed(within, slope, ">" if rises == {1} else "<")]
        if "slope" in claim:
            found.append(_equal(within, slope, read(claim["slope"])))
        return _worst([*found, Verdict("supported", "by signs at the ends")])

    def limit(self, claim: Claim, question: Question) -> Verdict:
        """Approach the place, and compare with the next term and with the order of what is left."""
        flint.ctx.prec = 16 * max(STEPS)
        variable, place = read(claim["variable"]), read(claim["point"])
        ratio = read(claim["expression"]) / read(claim["leading"]) - ONE
        scaled = (ratio - read(claim["next_term"])) / read(claim["remainder"])
        count = 0
        for point in question.points(scaled):
            for side in (1, -1) if place is not INFINITY else (1,):
                small = [fmpq(side, 2**step) for step in STEPS]
                near = [1 / h if place is INFINITY else point.value(place) + h for h in small]
                moved = [point.at({variable: value}) for value in near]
                if not all(question.admits(each, variable) for each in moved):
                    continue
                first, last = (abs(arb(each.value(ratio))) for each in (moved[0], moved[-1]))
                if not (last < first / 2**8 or last == 0):
                    return Verdict("refuted", f"the ratio is off by {last.str(6)}")
                first, last = (abs(arb(each.value(scaled))) for each in (moved[0], moved[-1]))
                if not last < 4 * first + arb(2) ** -16:
                    return Verdict("refuted", "the remainder is larger than said")
                count += 1
        return Verdict("supported", "along sequences") if count else NO_POINT

    def maximum(self, claim: Claim, question: Question) -> Verdict:
        """Check the identity, the sign of the surplus, and that it vanishes at the place."""
        value, expression, surplus = (
            read(claim[key]) for key in ("value", "expression", "surplus")
        )
        variable, place = map(read, claim["place"])
        within = question.where(*map(read, claim.get("given", ())))
        attained = _equal(question, put(surplus, {variable: place}), ZERO)
        return _worst(
            [_equal(within, value - expression, surplus), _signed(within, surplus, ">="), attained]
        )

    def equivalence(self, claim: Claim, question: Question) -> Verdict:
        """Check that the ratio is positive."""
        left, right = _sides(claim)
        return _signed(question, read(claim["nonnegative"]) / (left - right), ">")


def _placed(relation: Tree, places: Mapping[Tree, Tree]) -> Tree:
    """Return a relation at other places."""
    return Tree(relation.op, *(put(side, places) for side in relation.args))


def _sides(claim: Claim) -> tuple[Tree, Tree]:
    if claim["kind"] == "root":
        return read(claim.get("name", claim["variable"])), read(claim["value"])
    return read(claim["left"]), read(claim["right"])


def _relation(claim: Claim) -> list[Any] | None:
    """Return the sides of an equality, or of what holds to leading order."""
    if claim["kind"] == "limit":
        return [claim["expression"], claim["leading"]]
    if claim["kind"] == "root":
        return [claim.get("name", claim["variable"]), claim["value"]]
    return [claim["left"], claim["right"]] if claim["kind"] in _ESTABLISHING else None


_PREMISES = {"definition", "condition"}
_ESTABLISHING = {"definition", "recalled", "equality", "integral", "root"}
_CHECKS: dict[str, Callable[[Record, Claim, Question], Verdict]] = {
    "recalled": Record.recalled,
    "leading term": Record.leading_term,
    "pair": Record.pair,
    "equality": Record.equality,
    "inequality": Record.inequality,
    "integral": Record.integral,
    "root": Record.root,
    "unique root": Record.unique_root,
    "crossing": Record.crossing,
    "limit": Record.limit,
    "maximum": Record.maximum,
    "equivalence": Record.equivalence,
}


def _worst(verdicts: Iterable[Verdict]) -> Verdict:
    """Join the parts of one claim: it is as certain as the least certain of them."""
    found = list(verdicts)
    least = min((each.status for each in found), key=STATUSES.index)
    ways = dict.fromkeys(each.how for each in found if each.how and each.status == least)
    return Verdict(least, "; ".join(ways))


def _is_zero(gap: Value, size: Value = fmpq(1), close: Value = CLOSE) -> bool:  # noqa: B008
    return (
        bool(gap == 0)
        if isinstance(gap, fmpq)
        else bool(gap.contains(0) and gap.rad() < close * size)
    )


def _value(point: Point, tree: Tree) -> Value:
    try:
        return point.value(tree)
    except UndefinedError:
        return None


def _equal(question: Question, left: Tree, right: Tree) -> Verdict:
    """Compare two trees at points."""
    if left is right:
        return Verdict("confirmed", "")
    exact, count = True, 0
    close = QUADRATURE if question.rules.integrates(left - right) else CLOSE
    for point in question.points(left, right, wanted=8 * POINTS):
        one, other = sides = [_value(point, side) for side in (left, right)]
        if None in sides:
            if sides != [None, None]:
                return Verdict("unconfirmed", "at a point only one side has a value")
            continue
        size = max(abs(arb(one)).mid(), abs(arb(other)).mid(), arb(2) ** -40)
        exact = exact and isinstance(one - other, fmpq)
        if not _is_zero(one - other, size, close):
            found = _differ(point, one - other)
            others = _alternatives(question, point) if found.status == "unconfirmed" else []
            tried = (_equal(each, left, right) for each in others)
            return next((each for each in tried if each.status != "unconfirmed"), found)
        count += 1
        if count == POINTS:
            break
    return Verdict("confirmed", "exactly" if exact else "by balls") if count else NO_POINT


def _alternatives(question: Question, point: Point) -> list[Question]:
    """Return the question with its proved integrals to be computed, and by their linearity alone."""
    found = (
        [replace(question.without(question.proved), proved=frozenset())] if question.proved else []
    )
    return (
        [*found, replace(question, linear=True)] if point.linear and not question.linear else found
    )


def _differ(point: Point, gap: Value) -> Verdict:
    """Refute, unless what is unknown of functions under integrals may be the reason."""
    if arb(gap).contains(0):
        return Verdict("unconfirmed", "the balls are too wide")
    if point.linear or any(lhs.op == "integral" for lhs in point.rules.values):
        return Verdict("unconfirmed", "not from what the premises say of integrals")
    return Verdict("refuted", f"left - right = {arb(gap).str(6)} at a point")


def _signed(question: Question, gap: Tree, relation: str) -> Verdict:
    """Prove a sign, or look at points."""
    proofs = {">": {"+"}, ">=": {"+", "+0", "0"}, "<": {"-"}, "<=": {"-", "-0", "0"}}
    proved, count = False, 0
    for rules in (Rules({}), question.rules):  # names may be letters of their own
        try:
            found = proved_sign(gap, rules, question.facts, question.ranges())
        except (UnsupportedError, UndefinedError):
            continue
        proved = proved or found in proofs[relation]
    points = question.points(gap, wanted=POINTS if proved else MORE_POINTS)
    for point in points:
        if not holds(relation, point.value(gap)):
            verdict = _differ(point, point.value(gap))
            doubt = _alternatives(question, point) if verdict.status == "unconfirmed" else []
            return _signed(doubt[0], gap, relation) if doubt else verdict
        count += 1
    if not count:
        return NO_POINT
    if proved:
        return Verdict("confirmed", "by the signs of polynomials")
    given = question.rules, question.facts, question.conditions, question.gaps()
    return (
        Verdict("confirmed", "by z3")
        if proves(gap, relation, *given)
        else Verdict("supported", "at points")
    )


def _inside(variable: Tree, low: Tree, high: Tree) -> list[Tree]:
    """Return the conditions of an interval."""
    pairs = [(low, variable), (variable, high)] if low is not high else []
    return [Tree("<", *pair) for pair in pairs if not any(each.has(INFINITY) for each in pair)]


def _quadrature(question: Question, integral: Tree, value: Tree) -> Verdict:
    """Integrate numerically at a point where that converges."""
    for point in question.points(integral, value):
        sides = [_value(point, side) for side in (integral, value)]
        if None not in sides:
            gap, size = arb(sides[0] - sides[1]), max(abs(arb(sides[1])).mid(), arb(2) ** -10)
            if not gap.contains(0):
                return _differ(point, gap)
            if _is_zero(gap, size, QUADRATURE):
                return Verdict("confirmed", "by quadrature")
    return Verdict("confirmed", "by derivative and ends")


def _far(question: Question, primitive: Tree, over: tuple[Tree, ...], value: Tree) -> Verdict:
    """Let the ends of an integral go to infinity."""
    for point in question.points(primitive, value, wanted=1):
        far = [fmpq(2) ** STEPS[-1] if end is INFINITY else point.value(end) for end in over[1:]]
        ends = [point.at({over[0]: end}).value(primitive) for end in far]
        gap = abs(arb(ends[1] - ends[0] - point.value(value)))
        return Verdict("supported" if gap < arb(2) ** -40 else "refuted", "at ends far away")
    return NO_POINT


def _only(
    question: Question,
    expression: Tree,
    variable: Tree,
    ends: list[Tree],
    value: Tree | None = None,
) -> Verdict:
    """Count the roots between the ends at points; a given one must be there."""
    count = 0
    for point in question.points(expression, *ends, *([value] if value else []), wanted=2):
        low, high = (None if end.has(INFINITY) else point.value(end) for end in ends)

        def inside(root: Value, low: Value = low, high: Value = high) -> bool:
            return (low is None or holds(">", root - low)) and (
                high is None or holds("<", root - high)
            )

        if value is not None and not inside(point.value(value)):
            return Verdict("refuted", "at a point it is outside of the interval")
        found = sum(map(inside, real_roots(expression, variable, point)))
        if found != 1:
            return Verdict("refuted", f"{found} roots at a point")
        count += 1
    return Verdict("confirmed", "by isolation of roots") if count else NO_POINT
