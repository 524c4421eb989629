r"""The engine: a proof is a list of steps, and each step is checked when it is made.

>>> from ..symbols import V, l_r, tau
>>> proof = Proof("eq29", 29, section="Steady sliding", title="Retardation length")
>>> proof.define(l_r, V * tau, "how far an element travels while it relaxes")
>>> proof.done(l_r, V * tau).latex
'l_{\\mathrm{r}} = V \\tau'
>>> proof.equal(l_r / tau, 2 * V, "wrong")
Traceback (most recent call last):
...
derivations.engine.book.StepError: eq29: l_r/tau = 2*V is not an identity: left - right = -V
"""

from contextlib import ExitStack

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational
from sympy.printing.latex import LatexPrinter

from .algebra import (
    UndecidedError,
    difference,
    first_coefficients,
    is_continuous,
    leading_term,
    next_order,
    normalise,
    roots_between,
    sign_between,
    value_at,
)
from .algebra import antiderivative as integrated
from .book import Said, StepError, asked, tex, tex_interval, tex_within
from .conditions import (
    Interval,
    demands,
    proves_nonnegative,
    proves_nonzero,
    proves_positive,
)
from .guards import Guarded
from .identity import is_rational, letters_of
from .points import signs
from .premises import Premise, violates
from .roots import domain_of, only_root

_SIGNS = {">": {"+"}, ">=": {"+", "+0"}, "<": {"-"}, "<=": {"-", "-0"}}
_STRICT = (sp.StrictGreaterThan, sp.StrictLessThan)
_STRICTLY = {sp.GreaterThan: sp.StrictGreaterThan, sp.LessThan: sp.StrictLessThan}
_RELATIONS = {">": ">", ">=": r"\ge", "<": "<", "<=": r"\le"}


class Greatest(sp.Expr):
    """The greatest value of an expression over a variable, in print."""

    def _latex(self, printer: LatexPrinter) -> str:
        expr, variable = self.args
        return rf"\max_{{{printer._print(variable)}}} \left[{printer._print(expr)}\right]"


class Proof(Guarded):
    """Collect checked steps and end in a `record.Derivation`.

    A step is printed as `printing` has it.
    """

    @asked
    def equal(
        self,
        lhs: sp.Expr,
        rhs: sp.Expr,
        reason: str,
        *,
        cases: tuple[Relational, ...] = (),
    ) -> None:
        """Prove an identity: wherever one side is defined, so is the other, and they are equal.

        With `cases` it is proved in each of them, and they are its domain: one of them must hold.
        """
        for case in cases or (sp.true,):
            with self._case(case):
                self._identical(lhs, rhs)
        self._record(lhs, "=", rhs, reason, "proved", exact=not cases, cases=cases)

    def _identical(self, lhs: sp.Expr, rhs: sp.Expr) -> None:
        claim = Said(lhs, "=", rhs)
        left, right = self._resolve(lhs), self._resolve(rhs)
        self._vanish(left, right, claim)
        self._equally_defined((lhs, left), (rhs, right), claim)

    @asked
    def proportional(
        self,
        lhs: sp.Expr,
        rhs: sp.Expr,
        factor: sp.Expr,
        reason: str,
    ) -> None:
        """Prove that `lhs` is a number times `rhs`, and print that it goes as that: lhs ~ rhs."""
        if not (factor.is_number and factor.is_positive):
            raise StepError(f"{self.label}: {factor} is no positive number")
        self._identical(lhs, factor * rhs)
        self._asked = "equal", {"lhs": lhs, "rhs": factor * rhs}, self._asked[2]
        self._record(lhs, r"\sim", factor * rhs, reason, "proved", exact=False, right=tex(rhs),
                     note=f"up to the factor ${tex(factor)}$")  # fmt: skip

    @asked
    def integral(
        self,
        lhs: sp.Expr,
        integrand: sp.Expr,
        over: Interval,
        reason: str,
        *,
        antiderivative: sp.Expr | None = None,
        value: sp.Expr | None = None,
    ) -> sp.Expr:
        """Prove that `lhs`, the integral of `integrand`, has the value that is returned.

        The antiderivative, found by the rules of `algebra` unless it is stated, is differentiated; it must be
        real and continuous from end to end, so that its end values count. `lhs` either was defined as this
        integral or is named by this step. `value` is the form in which the value is wanted; it is proved to
        be the difference of the end values.
        """
        whole = sp.Integral(integrand, over)
        variable, low, high = over[0], *(self._resolve(end) for end in over[1:])
        self._free(variable)
        written = self._resolve(whole)
        inner = written.function if isinstance(written, sp.Integral) else self._resolve(integrand)
        others = integrand.free_symbols - {variable}
        hides = integrand.has(AppliedUndef) or any(
            self._resolve(each).has(variable) for each in others
        )
        density = inner.doit() if hides else integrand
        try:
            stated = integrated(density, variable) if antiderivative is None else antiderivative
        except UndecidedError as error:
            raise StepError(f"{self.label}: {whole}: {error}") from error
        primitive = self._resolve(stated)
        self._asked[1]["antiderivative"] = stated
        self._reaches(variable, low, high)
        if not is_continuous(primitive, (variable, low, high), self._conditions):
            raise StepError(f"{self.label}: {primitive} may not be continuous in {variable}")
        slope = self._resolve(sp.Derivative(stated, variable))
        self._vanish(slope, inner, Said(sp.Derivative(stated, variable), "=", integrand))
        try:
            found = value_at(primitive, variable, high) - value_at(primitive, variable, low)
        except UndecidedError as error:
            raise StepError(f"{self.label}: {whole}: {error}") from error
        found = self._resolve(found)  # a rule may be about a function at the very end
        plain = is_rational(found) and all(each.is_real for each in letters_of(found))
        if found.has(sp.oo, sp.zoo, sp.nan, sp.AccumBounds) or (
            not (plain or signs(found)) and found.is_real is False
        ):
            raise StepError(f"{self.label}: {whole} has no finite real value but {found}")
        defined = lhs in self._rules
        if defined:
            self._same_integral(self._unnamed(lhs), whole)
            del self._rules[lhs]
        wanted = sp.factor(found) if value is None else value
        self._vanish(self._resolve(wanted), found, Said(whole, "=", wanted))
        self._defined_alike(written, (stated, primitive), (wanted, self._resolve(wanted)))
        known = defined or lhs == whole
        premise = None if known else Premise(lhs, wanted, f"{tex(lhs)} = {tex(whole)}")
        self._rule(lhs, wanted)
        inside = self._conditions.with_interval((variable, low, high))
        sure = lhs.is_nonnegative and not lhs.is_integer
        if not sure or not (
            proves_positive(wanted)
            or (proves_positive(high - low, self._conditions) and proves_positive(inner, inside))
        ):
            self._imply(lhs)
        right = tex(wanted) if lhs == whole else f"{tex(whole)} = {tex(wanted)}"
        self._origins[lhs] = self._record(
            *(lhs, "=", wanted, reason, "proved"), premise=premise, right=right
        )
        return wanted

    @asked
    def root(
        self,
        expr: sp.Expr,
        variable: sp.Expr,
        value: sp.Expr,
        reason: str,
        *,
        over: Interval | None = None,
        name: sp.Symbol | None = None,
    ) -> None:
        """Prove that the expression vanishes at this value of the variable, and nowhere else.

        Nowhere else in the interval or, without one, among the values that the assumptions on the
        variable allow. `name` is what the root is called, if not by the variable itself.
        """
        found = self._resolve(value)
        if found.has(variable):
            raise StepError(f"{self.label}: {value} depends on {variable} itself")
        whole = self._resolve_free(expr, variable)
        claim = f"root {variable} = {value} of {expr}"
        where = tex_interval(over) if over else _reach(variable)
        if over is not None:
            self._interval(over, symbolic=True)
            over = (over[0], *(self._resolve(end) for end in over[1:]))
        called = variable if name is None else name
        if violates(called, found):
            raise StepError(f"{self.label}: {claim}: {called} cannot have this value")
        if called != variable and not domain_of(called, None).holds(found, self._conditions):
            raise StepError(f"{self.label}: {claim}: {called} is not known to reach this value")
        for base in (each.subs(variable, found) for each in demands(whole)[0]):
            if not base.is_nonzero and not proves_nonzero(base, self._conditions):
                self._exclude(base, claim)
        try:
            only_root(whole, variable, found, domain_of(variable, over), self._conditions)
        except (UndecidedError, sp.PolynomialError) as error:
            raise StepError(f"{self.label}: {claim}: {error}") from error
        for gap in (
            each.subs(variable, found) for each in self._conditions.positive if each.has(variable)
        ):
            if not proves_positive(self._resolve(gap), self._conditions):
                raise StepError(
                    f"{self.label}: {claim}: {gap} > 0 is a condition, but is not known"
                )
        condition = sp.sympify(expr).subs(variable, called)
        premise = Premise(condition, sp.S.Zero, f"{tex(condition)} = 0")
        # The variable of a root with a name of its own is bound: its interval restricts nothing else.
        whole_line = where.startswith(r"-\infty <") and where.endswith(r"< \infty")
        among = "real root" if whole_line else "root"
        note = f"the only {among} of ${tex(sp.sympify(expr))} = 0$" + (
            "" if whole_line else f" for ${where}$"
        )
        fact = self._record(called, "=", value, reason, "proved", over=over, premise=premise,
                            bound=called != variable, note=note)  # fmt: skip
        if called != variable:
            self._rule(called, value)
            self._origins[called] = fact

    @asked
    def unique_root(self, expr: sp.Expr, over: Interval, reason: str) -> None:
        """Prove by Sturm's theorem that a polynomial changes its sign exactly once in the interval.

        That it has one root there, and that it is a simple one (or of odd order).
        """
        self._interval(over)
        whole = self._resolve_free(expr, over[0])
        self._possible(over)
        try:
            count, odd = roots_between(whole, over)
            poles, _ = roots_between(sp.fraction(sp.together(whole))[1], over)
        except UndecidedError as error:
            raise StepError(f"{self.label}: roots of {expr}: {error}") from error
        if count != 1:
            raise StepError(f"{self.label}: {expr} has {count} roots inside {over}, not one")
        if odd != 1 or poles:
            raise StepError(f"{self.label}: {expr} does not change its sign at its root in {over}")
        right = rf"0 \quad\text{{for exactly one }} {tex_within(over)}"
        self._record(expr, "=", sp.S.Zero, reason, "proved", exact=False, over=over, right=right,
                     note="where it changes its sign")  # fmt: skip

    @asked
    def sign(
        self,
        expr: sp.Expr,
        relation: str,
        bound: sp.Expr | int,
        over: Interval,
        reason: str,
    ) -> None:
        """Prove that a rational expression stays on one side of `bound` inside the interval."""
        claim = f"{expr} {relation} {bound} inside {over}"
        self._interval(over)
        gap = self._resolve_free(expr - bound, over[0])
        self._possible(over)
        try:
            found = sign_between(gap, over)
        except UndecidedError as error:
            raise StepError(f"{self.label}: {claim}: {error}; left - right = {gap}") from error
        if found not in _SIGNS[relation]:
            raise StepError(f"{self.label}: {claim} is wrong: left - right = {gap} is {found}")
        for base in self._undefined(sp.sympify(expr - bound), gap):
            if not proves_nonzero(base, self._conditions.with_interval(over)):
                raise StepError(f"{self.label}: {claim}: {base} may vanish")
        shown_bound = sp.sympify(bound)
        self._record(
            *(expr, _RELATIONS[relation], shown_bound, reason, "proved"),
            exact=False,
            over=over,
        )

    @asked
    def holds(
        self,
        lhs: sp.Expr,
        relation: str,
        rhs: sp.Expr | int,
        reason: str,
        *,
        cases: tuple[Relational, ...] = (),
    ) -> None:
        """Prove an inequality from the assumptions on its symbols and from `where` alone.

        With `cases` it is proved in each of them, and they are its domain: one of them must hold.
        """
        for case in cases or (sp.true,):
            with self._case(case):
                self._holds(sp.sympify(lhs - rhs), relation, Said(lhs, relation, rhs))
        shown_rhs = sp.sympify(rhs)
        self._record(
            *(lhs, _RELATIONS[relation], shown_rhs, reason, "proved"),
            exact=False,
            cases=cases,
        )

    def _holds(self, raw: sp.Expr, relation: str, claim: Said | str) -> None:
        gap = self._resolve(raw)
        proves = proves_positive if relation in "<>" else proves_nonnegative
        for base in self._undefined(raw, gap):
            if not proves_nonzero(base, self._conditions):
                raise StepError(f"{self.label}: {claim}: {base} may vanish")
        sign = 1 if ">" in relation else -1
        if not any(proves(sign * form, self._conditions) for form in (raw, gap)):
            raise StepError(f"{self.label}: {claim} is not proved: left - right = {gap}")

    @asked
    def greatest(
        self,
        value: sp.Expr,
        expr: sp.Expr,
        place: tuple[sp.Symbol, sp.Expr],
        reason: str,
        *,
        surplus: sp.Expr,
        given: tuple[Relational, ...] = (),
    ) -> None:
        """Prove that `value` is the greatest value of `expr`, and where it is reached.

        `place` is the variable with its value there; `surplus` a form of the difference that is never
        negative, under the inequalities that are given; the place must obey them, and all conditions.
        """
        variable, at = place
        claim = f"{value} is the greatest {expr}"
        if not variable.is_Symbol or any(
            side.has(variable)
            for each in (value, at)
            for side in (sp.sympify(each), self._resolve(each))
        ):
            raise StepError(
                f"{self.label}: {claim}: the value and its place must not vary with {variable}"
            )
        self._free(variable)
        strict = [each if each.is_Relational and each.func in _STRICT else _STRICTLY[each.func](*each.args)
                  for each in given]  # fmt: skip
        with ExitStack() as stack:
            for condition in strict:
                stack.enter_context(self._case(condition))
            self._identical(value - expr, surplus)
            self._holds(sp.sympify(surplus), ">=", claim)
        self._reaches_place(variable, sp.sympify(at), given, claim)
        if strict != list(given):  # the inequality extends to the ends by continuity
            over = (variable, -sp.oo, sp.oo)
            if not is_continuous(self._resolve(surplus), over, self._conditions):
                raise StepError(f"{self.label}: {claim}: {surplus} may not be continuous")
        reached = sp.sympify(surplus).subs(variable, at)
        self._vanish(self._resolve(reached), sp.S.Zero, f"{claim}, reached at {variable} = {at}")
        conditions = (sp.And(*given, evaluate=False),) if given else ()
        self._record(
            *(value, "=", Greatest(expr, variable), reason, "proved"),
            exact=False,
            cases=conditions,
        )

    def _reaches_place(
        self, variable: sp.Symbol, at: sp.Expr, given: tuple[Relational, ...], claim: str
    ) -> None:
        """Refuse a place where the variable cannot be, by its assumptions or by any condition."""
        mine = [each for each in given if each.has(variable)]
        with ExitStack() as stack:
            for condition in given:
                if condition not in mine:
                    stack.enter_context(self._case(condition))
            asked = [(gap, proves_positive) for gap in self._open_admissions(variable, at)]
            asked += [
                (gap.subs(variable, at), proves_positive)
                for gap in self._conditions.positive
                if gap.has(variable)
            ]
            asked += [
                (
                    (each.gts - each.lts).subs(variable, at),
                    proves_positive if each.func in _STRICT else proves_nonnegative,
                )
                for each in mine
            ]
            if not all(proves(self._resolve(gap), self._conditions) for gap, proves in asked):
                raise StepError(f"{self.label}: {claim}: {variable} is not known to reach {at}")

    @asked
    def equivalent(self, nonnegative: sp.Expr, lhs: sp.Expr, rhs: sp.Expr, reason: str) -> None:
        """Prove that `nonnegative` >= 0 says the same as lhs >= rhs: their ratio is positive."""
        top, gap = self._resolve(nonnegative), self._resolve(lhs - rhs)
        ratio = sp.cancel(top / gap)
        if not proves_positive(ratio, self._conditions) or difference(top, ratio * gap) != 0:
            raise StepError(
                f"{self.label}: {lhs} >= {rhs} is not the same as {nonnegative} >= 0: ratio {ratio}"
            )
        self._equally_defined((nonnegative, top), (lhs - rhs, gap), f"{lhs} >= {rhs}")
        self._record(lhs, r"\ge", rhs, reason, "proved", exact=False)

    @asked
    def leading_order(
        self,
        expr: sp.Expr,
        leading: sp.Expr,
        variable: sp.Symbol,
        point: sp.Expr | int,
        reason: str,
        *,
        eps: sp.Expr | None = None,
        short: bool = False,
    ) -> tuple[sp.Expr, sp.Expr]:
        """Prove expr = leading (1 + c eps**k + higher order) as variable -> point; return (c, k).

        The small quantity `eps` is any positive expression that vanishes there: the distance from the point,
        or one over the variable, unless another is stated. In `short`, where it is
        the variable itself and the point 0, the remainder is printed as a term of its own, which holds
        where the leading term vanishes too.
        """
        claim = f"{expr} ~ {leading} as {variable} -> {point}"
        if eps is None:
            eps = 1 / variable if point == sp.oo else variable if point == 0 else point - variable
        parts = [self._resolve_free(part, variable) for part in (expr, leading, eps)]
        if short and not (eps == variable and point == 0):
            raise StepError(
                f"{self.label}: {claim}: a remainder of its own needs eps = {variable} -> 0"
            )
        try:
            for first in first_coefficients(parts[0] / parts[1], variable, point, self._conditions):
                self._exclude(first, claim)  # for some parameters it would begin with another power
            c, k, rest = next_order(
                parts[0] / parts[1], parts[2], variable, point, self._conditions
            )
        except (UndecidedError, sp.PolynomialError) as error:
            raise StepError(f"{self.label}: {claim}: {error}") from error
        # Of a sum the next term must be finite; of a product, its share of the leading one.
        for base in demands(sp.cancel(c * parts[1]) if short else c)[0] - {parts[2], variable}:
            if not proves_nonzero(base, self._conditions):
                self._exclude(base, claim)
        self._asked[1].update(eps=eps, next_term=c * eps**k, remainder=eps**rest)
        factor = rf"\left({tex(leading)}\right)" if leading.is_Add else tex(leading)
        if short:
            _, order = leading_term(parts[1], variable, point, side=1)
            right = rf"{factor} + O\left({tex(variable ** (order + k))}\right)"
        else:
            series = _series(c, eps, k)
            whole = rf"{series} + O\left({tex(eps**rest)}\right)"
            right = whole if leading == 1 else rf"{factor} \left({whole}\right)"
        note = rf"as ${tex(variable)} \to {tex(sp.sympify(point))}$"
        fact = self._record(
            *(expr, "=", leading, reason, "proved-leading-order"),
            exact=False,
            right=right,
            note=note,
        )
        self._leading.setdefault((sp.sympify(expr), sp.sympify(leading)), fact)
        return c, k

    def _defined_alike(self, integral: sp.Expr, *forms: tuple[sp.Expr, sp.Expr]) -> None:
        """Exclude where an antiderivative or a value has a pole in a parameter that the integral has not."""
        shared = {normalise(base) for base in demands(integral)[0]}
        bases = {base for raw, form in forms for base in self._undefined(sp.sympify(raw), form)}
        for base in bases:
            varies = isinstance(integral, sp.Integral) and base.has(*integral.variables)
            if not (varies or normalise(base) in shared or proves_nonzero(base, self._conditions)):
                self._exclude(base, Said(integral, "=", forms[-1][0]))

    def _unnamed(self, name: sp.Expr) -> sp.Expr:
        """Return what a name stands for that was given to another name, and use its definitions."""
        while name in self._rules:
            self._used.add(name)
            name = self._rules[name]
        return name

    def _same_integral(self, defined: sp.Expr, evaluated: sp.Integral) -> None:
        """Prove that the integral by which a symbol was defined is the one that was evaluated."""
        if not isinstance(defined, sp.Integral) or defined.variables != evaluated.variables:
            raise StepError(f"{self.label}: {defined} is not the integral {evaluated}")
        pairs = zip(
            (defined.function, *defined.limits[0][1:]),
            (evaluated.function, *evaluated.limits[0][1:]),
            strict=True,
        )
        for one, other in pairs:
            self._vanish(self._resolve(one), self._resolve(other), f"{defined} = {evaluated}")


def _reach(variable: sp.Expr) -> str:
    """Print the values that a variable can have by its assumptions."""
    domain = domain_of(variable, None)
    if domain.low_included or domain.high_included:
        return f"{tex(variable)} {_RELATIONS['>=' if domain.low_included else '<=']} 0"
    return tex_interval((variable, domain.low, domain.high))


def _series(c: sp.Expr, eps: sp.Expr, k: sp.Expr) -> str:
    r"""Print 1 + c eps**k.

    >>> q = sp.Symbol("q")
    >>> _series(sp.Rational(3, 2), 1 - q, sp.S.One), _series(-sp.S.One, 1 - q, sp.S.One)
    ('1 + \\frac{3}{2} \\left(1 - q\\right)', '1 - \\left(1 - q\\right)')
    """
    size = sp.factor(c) if c.free_symbols else c
    negative = size.could_extract_minus_sign()
    size = -size if negative else size
    power = eps**k
    # SymPy would multiply a number into a sum.
    spread = size.is_Number and power.is_Add and size != 1
    term = sp.Mul(size, power, evaluate=not spread)
    shown = rf"\left({tex(term)}\right)" if term.is_Add else tex(term)
    return f"1 {'-' if negative else '+'} {shown}"
