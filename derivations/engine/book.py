"""The book of a proof: its definitions, recalled and established relations, and its result."""

import re
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache, wraps
from inspect import signature
from typing import Any, NamedTuple, ParamSpec, TypeVar, cast

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from .algebra import difference, is_continuous, is_differentiable, parted
from .conditions import (
    Conditions,
    Interval,
    demands,
    is_square,
    known_sign,
    open_factors,
    proves_nonnegative,
    proves_nonzero,
    proves_positive,
    proves_real,
)
from .forms import expanded, factors
from .identity import letters_of
from .language import foreign, parts
from .letters import letters, printed, told
from .premises import Fact, Premise, contradiction, is_general, merged, violates, weakest
from .printing import doprint
from .record import ARGUED, Claim, Derivation, Step, Table
from .rules import HiddenError, is_name, resolve
from .witness import has_witness

_P = ParamSpec("_P")
_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Finished:
    """A derivation, and the equalities that later proofs may recall from it."""

    derivation: Derivation
    exact: Mapping[tuple[sp.Expr, sp.Expr], Fact]
    result: tuple[sp.Expr, sp.Expr]
    leading: Mapping[tuple[sp.Expr, sp.Expr], Fact]
    """What was proved to leading order, with the leading term, in the way that needs the fewest premises."""


_finished: dict[str, Finished] = {}
"""The finished proofs by label, for `Book.recall`."""


def finished(labels: Iterable[str]) -> dict[str, Finished]:
    """Return finished proofs by their labels."""
    return {label: _finished[label] for label in labels}


def restore(proofs: Mapping[str, Finished]) -> None:
    """Let results be recalled that were proved before, from the same sources: see `store`."""
    _finished.update(proofs)


def forget(prefix: str) -> None:
    """Forget the results whose labels begin so: those of another document, which names its own alike."""
    for label in [each for each in _finished if each.startswith(prefix)]:
        del _finished[label]


_SAID = "What it also rests on is used in words, and recalled by no step."
"""Where a record declares labels to rest on of which no step recalls anything."""


class StepError(ValueError):
    """A step that is wrong, or that the engine cannot prove."""


def shown(expr: sp.Expr | str | int) -> str:
    """Print for a message, with terms in any order: SymPy orders them by their values, and integrates."""
    return str(sp.sstr(expr, order="none"))


class Said(NamedTuple):
    """A claim for a message: written out if the message is."""

    lhs: sp.Expr
    relation: str
    rhs: sp.Expr | int

    def __str__(self) -> str:
        return " ".join(map(shown, self[:]))


class _OverTimeError(BaseException):
    """No `Exception`, so that nothing on the way swallows it."""


SECONDS = 10
"""Processor time after which a step is given up; the slowest of the chapters takes two."""


@contextmanager
def _limited() -> Iterator[None]:
    """Interrupt what takes too long, where the system can: the main thread of Unix."""
    main = threading.current_thread() is threading.main_thread()
    if not (main and hasattr(signal, "SIGVTALRM")):
        yield
        return

    def expire(*_: object) -> None:
        raise _OverTimeError

    before = signal.signal(signal.SIGVTALRM, expire)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def asked(check: Callable[_P, _Value]) -> Callable[_P, _Value]:
    """Let a check store its input with the step that it records, and fail with a `StepError` alone."""
    form = signature(check)

    @wraps(check)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _Value:
        given = form.bind(*args, **kwargs).arguments
        book = cast("Book", given.pop("self"))
        arguments = {name: value for name, value in given.items() if name != "reason"}
        name = check.__name__.strip("_")
        book._asked = name, arguments, dict(book._rules)
        try:
            with _limited():
                for argument in arguments.values():
                    book._meant(argument)
                return check(*args, **kwargs)
        except StepError:
            raise
        except _OverTimeError:
            raise StepError(
                f"{book.label}: not decided within {SECONDS} s of processor time"
            ) from None
        except Exception as error:
            raise StepError(
                f"{book.label}: {name} cannot be decided: {type(error).__name__}: {error}"
            ) from error

    return run


_SHORT = 8
"""The operations of a condition that is printed as it is; of a longer one, which letter is positive is."""

_BINDING = sp.Integral, sp.Sum, sp.Product, sp.Subs
"""What has a variable of its own."""


def tex(expr: sp.Expr | int) -> str:
    r"""Print an expression in the notation of the paper.

    >>> x, y = sp.symbols("x y")
    >>> tex(sp.Subs(x + y, x, 0))
    '\\left. \\left(x + y\\right) \\right|_{x = 0}'
    """
    return _printed(sp.sympify(expr))


@lru_cache(maxsize=8192)
def _printed(expr: sp.Expr) -> str:
    return doprint(expr)


def tex_interval(over: Interval) -> str:
    r"""Print the values of a variable for which a step holds.

    >>> x = sp.Symbol("x", real=True)
    >>> [tex_interval((x, *ends)) for ends in ((0, 1), (0, sp.oo), (-sp.oo, 2), (-sp.oo, sp.oo))]
    ['0 < x < 1', 'x > 0', 'x < 2', '-\\infty < x < \\infty']
    """
    variable, low, high = tex(over[0]), sp.sympify(over[1]), sp.sympify(over[2])
    if low == -sp.oo and high == sp.oo:
        return rf"-\infty < {variable} < \infty"
    if high == sp.oo:
        return f"{variable} > {tex(low)}"
    if low == -sp.oo:
        return f"{variable} < {tex(high)}"
    return f"{tex(low)} < {variable} < {tex(high)}"


def tex_within(over: Interval) -> str:
    r"""Print that a variable lies in an open interval, in one formula without a chain.

    >>> x = sp.Symbol("x", real=True)
    >>> [tex_within((x, *ends)) for ends in ((0, 1), (0, sp.oo))]
    ['x \\in (0, 1)', 'x \\in (0, \\infty)']
    """
    variable, low, high = (tex(sp.sympify(each)) for each in over)
    return rf"{variable} \in ({low}, {high})"


def tex_condition(gap: sp.Expr) -> str:
    r"""Print that an expression is positive; of a square, that its base does not vanish.

    >>> x, y = sp.symbols("x y")
    >>> [tex_condition(gap) for gap in (1 - x, x - y, x * y - 1, (x - y) ** 2)]
    ['x < 1', 'x > y', 'x y - 1 > 0', 'x \\neq y']
    """
    if is_square(gap):
        terms = sp.Add.make_args(gap.base)
        first, *others = sorted(terms, key=lambda each: each.could_extract_minus_sign())
        return rf"{tex(first)} \neq {tex(-sp.Add(*others))}"
    for symbol in sorted(gap.free_symbols, key=str):
        rest = sp.expand(gap - symbol), sp.expand(gap + symbol)
        if not rest[1].has(symbol):
            return f"{tex(symbol)} < {tex(rest[1])}"
        if not rest[0].has(symbol) and rest[0] != 0:
            return f"{tex(symbol)} > {tex(-rest[0])}"
    return f"{tex(gap)} > 0"


def tex_case(case: sp.Basic) -> str:
    """Print a case: an equation, an inequality, or several at once."""
    if isinstance(case, sp.And):
        return ", ".join(map(tex_case, sp.ordered(case.args)))
    return tex(case)


def established(label: str, lhs: sp.Expr) -> sp.Expr:
    """Return the last form of `lhs` that the derivation with this label has established exactly."""
    forms = [right for left, right in _source(label).exact if left == lhs]
    if not forms:
        raise StepError(f"{label} does not establish {lhs}")
    return forms[-1]


def _put(expr: sp.Expr, at: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Put in values, all at once, and carry out what does not need to be believed."""
    return expr.subs(at, simultaneous=True).doit(integrals=False, sums=False)


def _table(table: Table | None, new: Mapping[str, str]) -> Table | None:
    if table is None:
        return None
    heads = tuple(told(head, new) for head in table.heads)
    return Table(heads, tuple(tuple(told(cell, new) for cell in row) for row in table.rows))


def _source(label: str) -> Finished:
    if label not in _finished:
        raise StepError(f"{label} has not been derived yet")
    return _finished[label]


class Book:
    """Definitions, relations of other proofs, and the steps made so far; `step.Proof` checks them.

    What is defined or recalled is a rule: later steps are checked with its left side replaced by
    its right side, until no left side is left. Each fact keeps the premises that its check has used,
    those of recalled facts among them, and the conditions under which it holds.
    """

    def __init__(
        self,
        label: str,
        equation: int | None,
        *,
        section: str,
        title: str,
        text: str = "",
        uses: tuple[str, ...] = (),
    ) -> None:
        for each in uses:
            if each == label:
                raise StepError(f"{label} cannot rest on itself")
            _source(each)
        self.label, self.equation = label, equation
        self._section, self._title, self._text = section, title, text
        self._uses, self._declared = list(uses), uses
        self._rules: dict[sp.Expr, sp.Expr] = {}
        self._origins: dict[sp.Expr, Fact] = {}
        """For each rule, the fact that it comes from."""
        self._conditions = Conditions()
        self._domain: tuple[str, ...] = ()
        self._used: set[sp.Expr] = set()
        """The rules that the step in hand has used."""
        self._needed: set[sp.Expr] = set()
        """The rules that any step has used."""
        self.finished: Derivation | None = None
        """The record, once the proof has ended."""
        self._asked: tuple[str, dict[str, Any], dict[sp.Expr, sp.Expr]] = ("", {}, {})
        self._steps: list[Step] = []
        self._named: dict[str, sp.Symbol] = {}
        """The letters by their names."""
        self._letters: dict[str, Any] = {}
        """The symbols and functions by what is printed for them."""
        self._reach: tuple[object, dict[sp.Expr, frozenset[sp.Expr]]] = None, {}
        """What is hidden, and the rules and facts for which it is."""
        self._point: dict[sp.Expr, Any] = {}
        """Where premises and conditions so far were seen to hold together."""
        self._known: dict[tuple[sp.Expr, sp.Expr], Fact] = {}
        self._last: tuple[sp.Expr, sp.Expr] = sp.nan, sp.nan
        """The sides of the relation that was kept last."""
        self._exact: dict[tuple[sp.Expr, sp.Expr], Fact] = {}
        self._leading: dict[tuple[sp.Expr, sp.Expr], Fact] = {}

    @asked
    def define(self, lhs: sp.Expr, rhs: sp.Expr, reason: str = "") -> None:
        """Define the left side by the right side: a name, or a law of the model.

        What a proof that this one uses has defined alike is recalled from there.
        """
        sides = sp.sympify(lhs), sp.sympify(rhs)
        if source := next((each for each in self._declared if sides in _source(each).exact), ""):
            self._recall(source, *sides, "", at=None)  # the reason stands there
            return
        if not (sp.sympify(lhs).free_symbols or sp.sympify(lhs).atoms(AppliedUndef)):
            raise StepError(f"{self.label}: {lhs} has a value already")
        self._rule(lhs, rhs)
        self._imply(sp.sympify(lhs))
        fact = self._record(lhs, "=", rhs, reason, "definition")
        self._premise(lhs, rhs, fact)

    @asked
    def where(self, condition: Relational, reason: str = "") -> None:
        """Restrict what follows to where an inequality holds: part of the domain of the result."""
        if not isinstance(condition, sp.StrictGreaterThan | sp.StrictLessThan):
            raise StepError(f"{self.label}: {condition} is no strict inequality that can be false")
        raw = condition.gts - condition.lts
        gap = self._resolve(raw)
        if proves_positive(-gap, self._conditions) or gap.is_nonpositive:
            raise StepError(f"{self.label}: {condition} contradicts what is given")
        sign = ">" if isinstance(condition, sp.StrictGreaterThan) else "<"
        self._unambiguous(condition.lhs, condition.rhs)
        left, right = tex(condition.lhs), tex(condition.rhs)
        latex = f"{left} {sign} {right}"
        for form in (gap, raw):
            self._demand(form, latex)
        self._ask_witness(f"{condition} and all else holds")
        claim = self._claim(condition.lhs, condition.rhs)
        self._steps.append(Step(left, sign, right, reason, "definition", claim=claim))

    def recall(
        self,
        *named: str | sp.Expr | tuple[sp.Expr, sp.Expr],
        reason: str = "",
        at: Mapping[sp.Symbol, sp.Expr] | None = None,
    ) -> None:
        """Use what derivations have established: of each label its result, or what is wanted of it after it.

        That is the last form of a left side, or a relation of both sides. Its premises and its domain come
        with it. With `at` it is used at one place: variables on which no premise depends get these values.
        """
        sources: list[tuple[str, list[Any]]] = []
        for each in named:
            if isinstance(each, str):
                sources.append((each, []))
            else:
                sources[-1][1].append(each)
        for label, wanted in sources:
            for each in wanted or (_source(label).result,):
                lhs, rhs = each if isinstance(each, tuple) else (each, established(label, each))
                self._recall(label, lhs, rhs, reason, at=at)

    @asked
    def _recall(
        self,
        label: str,
        lhs: sp.Expr,
        rhs: sp.Expr,
        reason: str,
        *,
        at: Mapping[sp.Symbol, sp.Expr] | None,
    ) -> None:
        fact = _source(label).exact.get((sp.sympify(lhs), sp.sympify(rhs)))
        if fact is None:
            raise StepError(f"{self.label}: {label} does not establish {lhs} = {rhs}")
        step = fact.step
        shown = step.left, step.right
        if at:
            lhs, rhs, fact = self._placed(fact, lhs, rhs, at)
            shown = tex(lhs), tex(rhs)
        self._use(label, lhs, rhs, fact)
        self._write(lhs, rhs, reason, step.status, shown, source=label, fact=fact)

    @asked
    def asymptote(
        self, label: str, of: sp.Expr, name: sp.Symbol, reason: str = "the leading term"
    ) -> sp.Expr:
        """Give a name to the leading term that the derivation with this label has proved; return the term.

        That is an exact fact about the term, and not about what it approaches.
        """
        found = [key for key in _source(label).leading if key[0] == of]
        if len(found) != 1 or not name.is_Symbol:
            raise StepError(f"{self.label}: {label} has no one leading term of {of} for {name}")
        fact, leading = _source(label).leading[found[0]], found[0][1]
        worth = "proved" if fact.step.status == "proved-leading-order" else fact.step.status
        step = replace(fact.step, left=tex(name), right=tex(leading), status=worth)
        fact = replace(fact, step=step)
        self._use(label, name, leading, fact)
        shown = step.left, step.right
        self._write(name, leading, reason, worth, shown, source=label, fact=fact)
        return leading

    def _use(self, label: str, lhs: sp.Expr, rhs: sp.Expr, fact: Fact) -> None:
        """Take over a fact of another proof as a rule."""
        self._rule(lhs, rhs)
        if label not in self._uses:
            self._uses.append(label)
        self._carry(fact)
        self._ask_witness(f"the conditions of {label} and all else hold")
        self._origins[lhs] = fact
        self._consistent(lhs, rhs, label)

    def done(
        self, lhs: sp.Expr = None, rhs: sp.Expr | int = None, *, table: Table | None = None
    ) -> Derivation:
        """End the proof with a relation that one of its steps established: the last one, if none is given."""
        key = self._last if lhs is None else (sp.sympify(lhs), sp.sympify(rhs))
        result = self._known.get(key)
        if result is None:
            raise StepError(f"{self.label}: no step established {key[0]} and {key[1]}")
        steps = self._stated()
        new = letters(self.label, self._section)
        cited = {step.source for step in steps}
        said = [label for label in self._declared if label not in cited]
        heading = "" if ARGUED in self._text else f"{ARGUED} "
        text = f"{self._text} {heading}{_SAID}" if said else self._text
        found = Derivation(
            label=self.label,
            equation=self.equation,
            section=self._section,
            title=told(self._title, new),
            text=told(text.strip(), new),
            latex=printed(result.step.latex, new),
            status=self._status(by_words=bool(said)),
            steps=tuple(self._lettered(step) for step in steps),
            uses=tuple(label for label in self._uses if label in {*cited, *said}),
            table=_table(table, new),
            domain=tuple(printed(each, new) for each in result.domain),
            premises=tuple(dict.fromkeys(printed(each.latex, new) for each in result.premises)),
        )
        before = _finished.get(self.label)
        if before is not None and before.derivation != found:
            raise StepError(f"{self.label} names another result already")
        printed_ones = {id(step) for step in steps}
        exact, leading = (
            {sides: fact for sides, fact in facts.items() if id(fact.step) in printed_ones}
            for facts in (self._exact, self._leading)
        )
        _finished[self.label] = Finished(found, exact, key, leading)
        self.finished = found
        return found

    def _claim(self, lhs: sp.Expr, rhs: sp.Expr) -> Claim:
        check, arguments, rules = self._asked
        known = self._conditions
        sides = sp.sympify(lhs), sp.sympify(rhs)
        return Claim(check, *sides, arguments, rules, known.positive, known.intervals)

    def _stated(self) -> tuple[Step, ...]:
        """Return the steps without the premises that no check has used."""
        needed, before = set(self._needed), -1
        while len(needed) > before:
            before = len(needed)
            forms = [rhs for lhs, rhs in self._rules.items() if lhs in needed]
            needed |= {lhs for lhs in self._rules if any(form.has(lhs) for form in forms)}
        checked = [
            sp.sympify(argument)
            for step in self._steps
            if step.claim and not step.source
            for argument in step.claim.arguments.values()
            if isinstance(argument, sp.Basic)
        ]

        def used(claim: Claim) -> bool:
            return claim.lhs in needed or any(form.has(claim.rhs) for form in checked)

        return tuple(
            step
            for step in self._steps
            if not step.source or step.claim is None or used(step.claim)
        )

    def _lettered(self, step: Step) -> Step:
        """Return the step in the letters that this document prints; a recalled one in its source's."""
        own = letters(self.label, self._section)
        new = own
        if step.source:
            origin = _finished[step.source].derivation
            new = letters(origin.label, origin.section)
        return replace(
            step,
            left=printed(step.left, new),
            right=printed(step.right, new),
            domain=printed(step.domain, new),
            note=told(step.note, new),
            reason=told(step.reason, own),
        )

    def pair(
        self, one: tuple[sp.Expr, sp.Expr], other: tuple[sp.Expr, sp.Expr], reason: str
    ) -> Derivation:
        """End the proof with two established equalities, side by side."""
        self._pair(one, other, reason)
        return self.done()

    @asked
    def _pair(
        self, one: tuple[sp.Expr, sp.Expr], other: tuple[sp.Expr, sp.Expr], reason: str
    ) -> None:
        facts = [self._known.get((sp.sympify(lhs), sp.sympify(rhs))) for lhs, rhs in (one, other)]
        if any(fact is None or fact.step.relation != "=" for fact in facts):
            raise StepError(f"{self.label}: no step established {one} = {other}")
        left, right = (
            r"\left(" + r",\ ".join(getattr(fact.step, side) for fact in facts if fact) + r"\right)"
            for side in ("left", "right")
        )
        status = weakest(fact.step.status for fact in facts if fact)
        premises = merged(fact.premises for fact in facts if fact)
        domain = tuple(dict.fromkeys(each for fact in facts if fact for each in fact.domain))
        key = sp.Tuple(one[0], other[0]), sp.Tuple(one[1], other[1])
        step = Step(left, "=", right, reason, status, claim=self._claim(*key))
        self._needed |= {one[0], other[0]} & self._rules.keys()
        self._keep(*key, Fact(step, premises, self._conditions, domain), exact=False)

    def _status(self, *, by_words: bool) -> str:
        """Return the weakest status of the steps and of what they rest on; argued, if words prove the title.

        They do where the text says so, and where it uses what no step recalls: only that is a premise.
        Words count here alone: what others use of this proof are its lines.
        """
        words = ["argued"] if by_words or ARGUED in self._text else []
        return weakest([*(step.status for step in self._steps), *words])

    def _meant(self, argument: object) -> None:
        """Refuse what is not in the language, letters of one name, and places where a letter cannot be."""
        if isinstance(argument, Mapping):
            argument = [*argument, *argument.values()]
        if isinstance(argument, tuple | list):
            for part in argument:
                self._meant(part)
        if not isinstance(argument, sp.Basic):
            return
        if found := foreign(argument):
            raise StepError(f"{self.label}: {found}")
        for node in parts(argument):
            if isinstance(node, sp.Symbol) and self._named.setdefault(node.name, node) != node:
                raise StepError(f"{self.label}: there are two letters {node.name}")
            if isinstance(node, sp.Integral | sp.Sum | sp.Product):
                places = [(limit[0], end) for limit in node.limits for end in limit[1:]]
            elif isinstance(node, sp.Subs):
                places = list(zip(node.variables, node.point, strict=True))
            else:
                continue
            for variable, place in places:
                if gaps := self._open_admissions(variable, place, closed=True):
                    raise StepError(f"{self.label}: in {node}, {gaps[0]} > 0 is not known")

    def _open_admissions(
        self, symbol: sp.Expr, value: sp.Expr, *, closed: bool = False
    ) -> list[sp.Expr]:
        """Return what must be positive for a symbol to take a value, as far as it is not proved.

        An interval may end, and a value be taken, at the end of what the symbol can be: `closed`.
        """
        value = sp.sympify(value)
        found, known = self._resolve(value), self._conditions
        if closed and found in (sp.oo, -sp.oo):
            found = value = sp.sign(found)
        real = symbol.is_extended_real is not True or any(
            proves_real(form, known) for form in (value, found)
        )
        if not real or (symbol.is_integer and not found.is_integer):
            raise StepError(f"{self.label}: {symbol} cannot be {value}")
        if not (symbol.is_nonnegative or symbol.is_nonpositive):
            if symbol.is_nonzero and not proves_nonzero(found, known):
                raise StepError(f"{self.label}: {symbol} is not zero, but {value} may be")
            return []
        forms = [form if symbol.is_nonnegative else -form for form in (value, found)]
        proves = proves_positive if symbol.is_nonzero and not closed else proves_nonnegative
        return [] if any(proves(form, known) for form in forms) else [forms[0]]

    def _rule(self, lhs: sp.Expr, rhs: sp.Expr) -> None:
        lhs, rhs = sp.sympify(lhs), sp.sympify(rhs)
        if lhs in self._rules:
            raise StepError(f"{self.label}: {lhs} is defined twice")
        value = self._resolve(rhs)
        if value.has(lhs):
            raise StepError(f"{self.label}: the definition {lhs} = {rhs} is circular")
        if isinstance(lhs, AppliedUndef):
            self._smooth(lhs, value)
        was = self._resolve(lhs)
        if violates(was, value):
            raise StepError(f"{self.label}: {lhs} = {rhs} contradicts the assumptions on {lhs}")
        self._rules[lhs] = rhs

    def _smooth(self, call: AppliedUndef, value: sp.Expr) -> None:
        """Refuse a value with a singularity for a function of which something was proved as if smooth."""
        facts = [*self._known.values(), *self._origins.values()]
        claims = [fact.step.claim for fact in facts if fact.step.claim]
        asked = (side for claim in claims for side in (claim.lhs, claim.rhs))
        if not any(side.has(call.func) for side in asked):
            return
        for letter in (arg for arg in call.args if arg.is_Symbol and value.has(arg)):
            over = (
                letter,
                0 if letter.is_nonnegative else -sp.oo,
                0 if letter.is_nonpositive else sp.oo,
            )
            if not is_continuous(value, over, self._conditions, smooth=True):
                raise StepError(
                    f"{self.label}: {call} = {value} may be singular, though it was taken as smooth"
                )

    @contextmanager
    def _case(self, case: Relational | sp.logic.boolalg.BooleanTrue) -> Iterator[None]:
        """Assume an equality for a name, or a strict inequality, within a context."""
        kept = self._rules.copy(), self._origins.copy(), self._conditions
        if isinstance(case, sp.Eq):
            premise = Premise(case.lhs, case.rhs, tex(case))
            self._rule(case.lhs, case.rhs)
            self._origins[case.lhs] = Fact(Step("", "", "", "", "definition"), (premise,))
            self._consistent(case.lhs, case.rhs, "")
        elif isinstance(case, sp.StrictGreaterThan | sp.StrictLessThan):
            gap = case.gts - case.lts
            positive = (*self._conditions.positive, self._resolve(gap), gap)
            self._conditions = Conditions(self._conditions.intervals, positive)
            self._ask_witness(f"{case} and all else holds")
        elif case != sp.true:
            raise StepError(f"{self.label}: {case} is no equality and no strict inequality")
        try:
            yield
        finally:
            self._rules, self._origins, self._conditions = kept
            self._used &= self._rules.keys()

    def _imply(self, name: sp.Expr) -> None:
        """Take over, as part of the domain, what the assumptions on a name say about its value."""
        if not (name.is_Symbol or isinstance(name, AppliedUndef)):
            return
        value = self._resolve(self._rules[name])
        if name.is_integer and not value.is_integer:
            raise StepError(f"{self.label}: {name} is an integer, but {value} may be none")
        signed = name.is_nonnegative or name.is_nonpositive
        both = sp.sympify(self._rules[name]), value
        if (
            name.is_nonzero
            and not signed
            and not any(proves_nonzero(form, self._conditions) for form in both)
        ):
            raise StepError(
                f"{self.label}: {name} is not zero, but {value} may be; say where it is not"
            )
        raw = demands(self._rules[name])[1]
        settled = {
            self._resolve(base) for base in raw if proves_nonnegative(base, self._conditions)
        }
        roots = sorted(demands(value)[1] - settled, key=str) if name.is_real else []
        gaps = [
            gap for base in roots if not proves_nonnegative(base, self._conditions)
            for gap in open_factors(base, self._conditions) or [base]
        ]  # fmt: skip
        if name.is_nonnegative or name.is_nonpositive:
            forms = [
                each if name.is_nonnegative else -each
                for each in (*self._equals(self._rules[name]), value)
            ]
            proves = proves_positive if name.is_nonzero else proves_nonnegative
            if not any(proves(form, self._conditions) for form in forms):
                gaps += open_factors(forms[-1], self._conditions)
        for gap in gaps:
            short = gap.count_ops() <= _SHORT or not name.is_Symbol
            self._demand(gap, tex_condition(gap) if short else f"{tex(name)} > 0")

    def _demand(self, gap: sp.Expr, latex: str) -> None:
        """Let an expression be positive from here on."""
        known = self._conditions
        if gap not in known.positive:
            self._conditions = Conditions(known.intervals, (*known.positive, gap))
            self._domain = tuple(dict.fromkeys((*self._domain, latex)))

    def _exclude(self, base: sp.Expr, claim: "Said | str") -> None:
        """Let an expression not vanish from here on: the condition is printed; refuse where it must.

        Only of letters: what a function or an integral may be is for the author to say.
        """
        parts = [each.as_base_exp()[0] for each in factors(base)]
        for part in map(expanded, parts):
            if proves_nonzero(part, self._conditions):
                continue
            if part == 0 or part.has(AppliedUndef, sp.Integral, sp.Derivative, sp.Abs):
                raise StepError(f"{self.label}: {claim}: {part} may vanish; say where it does not")
            self._demand(part**2, tex_condition(sp.Pow(part, 2, evaluate=False)))
            self._ask_witness(f"{part} does not vanish and all else holds")

    def _premises(self) -> tuple[Premise, ...]:
        """Return the premises of all rules in force."""
        return merged(fact.premises for fact in self._origins.values())

    def _ask_witness(self, what: str) -> None:
        """Refuse what holds together with premises and conditions at no point."""
        pairs = tuple((each.lhs, each.rhs) for each in self._premises())
        if not has_witness(pairs, self._conditions.gaps, self._point):
            raise StepError(f"{self.label}: no point was found where {what}")

    def _premise(self, lhs: sp.Expr, rhs: sp.Expr, fact: Fact) -> None:
        """Keep a definition as a premise of every step that will use it."""
        premise = Premise(sp.sympify(lhs), sp.sympify(rhs), fact.step.latex)
        self._origins[lhs] = Fact(fact.step, (premise,), fact.conditions, fact.domain)
        self._exact[premise.lhs, premise.rhs] = self._origins[lhs]
        self._consistent(lhs, rhs, "")

    def _consistent(self, lhs: sp.Expr, rhs: sp.Expr, label: str) -> None:
        """Refuse premises that cannot hold together."""
        premises = self._premises()
        found = contradiction(premises)
        if not found and not self._possible_with(premises, lhs):
            found = "no point was found at which all premises and conditions hold"
        if found:
            origin = f" of {label}" if label else ""
            raise StepError(f"{self.label}: with {lhs} = {rhs}{origin}: {found}")

    def _possible_with(self, premises: tuple[Premise, ...], new: sp.Expr) -> bool:
        """Tell whether premises and conditions have a witness; a new name alone needs none."""
        others = [side for each in premises if each.lhs != new for side in (each.lhs, each.rhs)]
        mine = [each for each in premises if each.lhs == new]
        others += [*self._conditions.positive, *(each.rhs for each in mine)]
        alone = len(self._origins[new].premises) == 1
        fresh = (
            new.is_Symbol and alone and len(mine) == 1 and not any(each.has(new) for each in others)
        )
        side = 1 if new.is_nonnegative else -1 if new.is_nonpositive else 0
        if (
            fresh
            and not new.is_integer
            and (not side or any(known_sign(form) == side for form in self._equals(mine[0].rhs)))
        ):
            return True
        pairs = tuple((each.lhs, each.rhs) for each in premises)
        return has_witness(pairs, self._conditions.gaps, self._point)

    def _equals(self, expr: sp.Expr) -> list[sp.Expr]:
        """Return an expression and the forms that a step has proved it to be equal to."""
        expr = sp.sympify(expr)
        return [expr, *(right for left, right in self._exact if left == expr)]

    def _placed(
        self, fact: Fact, lhs: sp.Expr, rhs: sp.Expr, at: Mapping[sp.Symbol, sp.Expr]
    ) -> tuple[sp.Expr, sp.Expr, Fact]:
        """Return the fact at one place."""
        for variable in at:
            # A law of functions holds at every place; any other equation fixes what is in it.
            laws = (each.lhs for each in fact.premises if not is_name(each.lhs))
            fixed = [each for each in laws if not each.has(AppliedUndef)]
            laid_down = {variable} & {lhs, *(each.lhs for each in fact.premises)}
            if laid_down or any(each.has(variable) for each in fixed):
                raise StepError(f"{self.label}: {variable} is not free in {lhs} = {rhs}")
        lhs, rhs = (_put(sp.sympify(side), at) for side in (lhs, rhs))
        premises = tuple(
            Premise(one, other, f"{tex(one)} = {tex(other)}")
            if (one, other) != (each.lhs, each.rhs) else each
            for each in fact.premises
            for one, other in [(_put(each.lhs, at), _put(each.rhs, at))]
        )  # fmt: skip
        intervals = fact.conditions.intervals
        ends = [gap for name, low, high in intervals for gap in (name - low, high - name)]
        gaps = [
            gap for variable, value in at.items() for gap in self._open_admissions(variable, value)
        ]
        for gap in (*gaps, *(_put(each, at) for each in (*ends, *fact.conditions.positive))):
            if gap != sp.oo and not proves_positive(gap, self._conditions):
                self._demand(gap, tex_condition(gap))
        return lhs, rhs, Fact(fact.step, premises, self._conditions, self._domain)

    def _carry(self, fact: Fact) -> None:
        """Take over the domain of a recalled fact."""
        known = self._conditions
        for over in fact.conditions.intervals:
            if over not in known.intervals:
                known = known.with_interval(over)
        more = tuple(each for each in fact.conditions.positive if each not in known.positive)
        self._conditions = Conditions(known.intervals, (*known.positive, *more))
        self._domain = tuple(dict.fromkeys((*self._domain, *fact.domain)))

    def _resolve(self, expr: sp.Expr | int) -> sp.Expr:
        """Replace all that was defined or recalled, and carry out the derivatives."""
        rules, places = self._rules, dict[sp.Expr, tuple[sp.Expr, sp.Expr]]()
        try:
            found, used, derived = resolve(expr, rules, self._hidden())
            while new := self._laws(found, rules):
                places |= new
                rules = {**rules, **{call: value for call, (_, value) in new.items()}}
                found, used, derived = resolve(expr, rules, self._hidden())
        except HiddenError as error:
            raise StepError(f"{self.label}: {error}") from error
        used = frozenset(places[each][0] if each in places else each for each in used)
        for each in derived:
            if not is_differentiable(each, self._conditions):
                raise StepError(f"{self.label}: {each} is not known to exist everywhere")
        self._used |= used
        return found

    def _laws(
        self, expr: sp.Expr, rules: Mapping[sp.Expr, sp.Expr]
    ) -> dict[sp.Expr, tuple[sp.Expr, sp.Expr]]:
        """Return, for functions at other places than where their law was written, the law and the value.

        A law is for all values of its letters: none of them has a value or a condition, and each can be
        what stands at its place.
        """
        found = {}
        laws = {
            lhs.func: lhs for lhs, rhs in self._rules.items()
            if isinstance(lhs, AppliedUndef) and is_general(lhs, rhs) and not rhs.has(*_BINDING)
            and not any(self._is_bounded(letter) for letter in lhs.args)
        }  # fmt: skip
        bound = set().union(*(each.variables for each in expr.atoms(*_BINDING))) if laws else set()
        for call in expr.atoms(AppliedUndef) if laws else ():
            law = laws.get(call.func)
            if law is None or call in rules or call.free_symbols & bound:
                continue
            places = dict(zip(law.args, call.args, strict=True))
            if not any(self._open_admissions(*each) for each in places.items()):
                found[call] = law, self._rules[law].subs(places, simultaneous=True)
        return found

    def _is_bounded(self, letter: sp.Symbol) -> bool:
        """Tell whether a letter has a value or a condition here."""
        conditions = (
            *self._conditions.positive,
            *(name for name, *_ in self._conditions.intervals),
        )
        premises = (side for fact in self._origins.values() for each in fact.premises
                    if not isinstance(each.lhs, AppliedUndef) for side in (each.lhs, each.rhs))  # fmt: skip
        return letter in self._rules or any(each.has(letter) for each in (*conditions, *premises))

    def _hidden(self) -> dict[sp.Expr, frozenset[sp.Expr]]:
        """Return on what names depend by the premises of recalled facts, where no rule says it."""
        asked = [*self._rules], [*self._origins.values()]
        if asked != self._reach[0]:
            self._reach = asked, self._found_hidden()
        return self._reach[1]

    def _found_hidden(self) -> dict[sp.Expr, frozenset[sp.Expr]]:
        direct: dict[sp.Expr, set[sp.Expr]] = {}
        opaque = (AppliedUndef, sp.Derivative, sp.Integral)
        found = (each for fact in self._origins.values() for each in fact.premises)
        for premise in {id(each): each for each in found}.values():  # most facts share theirs
            if premise.lhs not in self._rules and premise.lhs.is_Symbol:
                direct.setdefault(premise.lhs, set()).update(letters_of(premise.rhs))
            if not is_name(premise.lhs) and not (premise.lhs - premise.rhs).has(*opaque):
                related = letters_of(premise.lhs) | letters_of(premise.rhs)
                for each in related - self._rules.keys():
                    direct.setdefault(each, set()).update(related - {each})
        for _ in direct:
            for reach in direct.values():
                reach.update(*(direct.get(name, ()) for name in tuple(reach)))
        return {name: frozenset(reach) for name, reach in direct.items()}

    def _unambiguous(self, *expressions: sp.Expr) -> None:
        """Refuse two symbols or two functions of one proof that are printed alike."""
        for expr in expressions:
            for symbol in expr.atoms(sp.Symbol, sp.Indexed) - expr.atoms(sp.Dummy):
                shape = re.sub(r"\\mathrm\{([^{}]*)\}", r"\1", tex(symbol))
                shape = re.sub(r"\{([^{}])\}", r"\1", shape)
                if self._letters.setdefault(shape, symbol) != symbol:
                    raise StepError(f"{self.label}: two letters are printed {tex(symbol)}")
            for call in expr.atoms(AppliedUndef):
                name = f"{call.func.__name__}()"
                if self._letters.setdefault(name, call.func) != call.func:
                    raise StepError(f"{self.label}: two functions are printed {name}")

    def _vanish(self, lhs: sp.Expr, rhs: sp.Expr, claim: "Said | str") -> None:
        rest = difference(self._parted(lhs), self._parted(rhs))
        if rest != 0 and rest.has(sp.Abs):
            rest = difference(rest.replace(sp.Abs, self._signed), sp.S.Zero)
        if rest != 0:
            raise StepError(
                f"{self.label}: {claim} is not an identity: left - right = {shown(rest)}"
            )

    def _parted(self, expr: sp.Expr) -> sp.Expr:
        """Write each integral as the sum of its parts, where these exist."""
        if not expr.has(sp.Integral):
            return expr
        return expr.replace(
            lambda node: isinstance(node, sp.Integral),
            lambda node: parted(node, self._conditions),
        )

    def _signed(self, inner: sp.Expr) -> sp.Expr:
        """Write an absolute value without its bars, where the conditions say the sign."""
        for form in (inner, -inner):
            if proves_nonnegative(form, self._conditions):
                return form
        return sp.Abs(inner)

    def _record(
        self,
        lhs: sp.Expr,
        relation: str,
        rhs: sp.Expr,
        reason: str,
        status: str,
        *,
        exact: bool = True,
        over: Interval | None = None,
        premise: Premise | None = None,
        cases: tuple[Relational, ...] = (),
        right: str = "",
        bound: bool = False,
        note: str = "",
    ) -> Fact:
        """Keep a step; an exact one is an equality that later proofs may use as a rule.

        `right` is printed where the right side says more than its value: an integral, a remainder.
        """
        self._unambiguous(sp.sympify(lhs), sp.sympify(rhs))
        origins = [self._origins[name] for name in self._rules if name in self._used]
        self._needed |= self._used
        self._used = set()
        extra = () if premise is None else (premise,)
        premises = merged([*(fact.premises for fact in origins), extra])
        worth = weakest([status, *(fact.step.status for fact in origins if status != "definition")])
        conditions = self._conditions
        if over is not None and not bound:
            conditions = conditions.with_interval(over)
        own = () if over is None else (tex_interval(over),)
        if cases:
            own = (*own, r"\ \text{or}\ ".join(map(tex_case, cases)))
        domain = tuple(dict.fromkeys((*(() if bound else own), *self._domain)))
        claim = self._claim(lhs, rhs)
        interval = "" if bound else ", ".join(own)
        step = Step(tex(lhs), relation, right or tex(rhs), reason, worth, "", interval, note, claim)
        fact = Fact(step, premises, conditions, domain)
        self._keep(lhs, rhs, fact, exact=exact)
        return fact

    def _keep(self, lhs: sp.Expr, rhs: sp.Expr, fact: Fact, *, exact: bool) -> None:
        """Keep a fact with its step."""
        self._last = key = sp.sympify(lhs), sp.sympify(rhs)
        self._steps.append(fact.step)
        self._known[key] = fact
        if exact:
            self._exact[key] = fact

    def _write(
        self, lhs: sp.Expr, rhs: sp.Expr, reason: str, status: str, shown: tuple[str, str],
        *, source: str, fact: Fact,
    ) -> None:  # fmt: skip
        """Keep a step of another proof."""
        self._needed |= self._used
        self._used = set()
        claim = self._claim(lhs, rhs)
        step = Step(shown[0], "=", shown[1], reason, status, source, fact.step.domain, claim=claim)
        self._origins[lhs] = Fact(step, fact.premises, fact.conditions, fact.domain)
        self._keep(lhs, rhs, self._origins[lhs], exact=True)
