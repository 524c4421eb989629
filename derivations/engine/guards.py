"""Guards of a step: no interval for a fixed variable, no value outside its range, no zero divisor."""

from collections.abc import Callable, Iterable

import sympy as sp
from sympy.core.function import AppliedUndef

from .algebra import KINKS, UndecidedError, is_continuous, leading_term, normalise
from .book import Book, Said, StepError, asked
from .conditions import (
    NONE,
    Conditions,
    Interval,
    demands,
    proves_nonnegative,
    proves_nonzero,
    proves_positive,
)
from .premises import fixed_value, violates


class Guarded(Book):
    """A book that refuses variables, intervals and equalities which cannot be meant."""

    @asked
    def crossing(
        self,
        expr: sp.Expr,
        over: Interval,
        reason: str,
        *,
        slope: sp.Expr | None = None,
    ) -> None:
        """Prove that a smooth expression vanishes exactly once in the interval: it rises or falls through 0.

        `slope` is a form of its derivative with a sign that can be seen. The signs at the ends are those of
        the leading terms there.
        """
        claim = f"{expr} = 0 once inside {over}"
        self._interval(over)
        whole = self._resolve_free(expr, over[0])
        derivative = sp.Derivative(expr, over[0])
        steep = derivative if slope is None else slope
        found = self._resolve(steep)
        if slope is not None:
            self._vanish(self._resolve(derivative), found, f"{derivative} = {slope}")
        inside = self._conditions.with_interval(over)
        forms = (steep, found) if slope is not None else (found,)
        # An analytic function that never falls, and is not constant, takes each value once.
        analytic = not found.has(AppliedUndef, sp.Integral, sp.Derivative, *KINKS)
        proves = proves_nonnegative if analytic else proves_positive
        signs = (sign for form in forms for sign in (1, -1) if proves(sign * form, inside))
        rises = next(signs, 0)
        names = [name for name in sp.sympify(expr).free_symbols if name in self._rules]
        calls = {each: sp.Function(each.name, **each.assumptions0)(over[0]) for each in names}
        parts = (expr.subs(calls), *map(self._resolve, names))
        if not rises or not all(_is_smooth_inside(part, over, self._conditions) for part in parts):
            raise StepError(f"{self.label}: {claim}: slope {found}")
        try:
            ends = [sign * rises * _value_near(whole, over[0], sp.sympify(end), sign)
                    for sign, end in ((-1, over[1]), (1, over[2]))]  # fmt: skip
        except UndecidedError as error:
            raise StepError(f"{self.label}: {claim}: {error}") from error
        if not all(proves_positive(end, self._conditions) for end in ends):
            raise StepError(f"{self.label}: {claim}: the signs at the ends are not those of {ends}")
        self._record(expr, "=", sp.S.Zero, reason, "proved", exact=False, over=over)

    def _free(self, variable: sp.Expr) -> None:
        """Refuse a variable that has been given a value: it cannot sweep over an interval."""
        if variable in self._rules:
            raise StepError(f"{self.label}: {variable} is {self._rules[variable]} here, not free")

    def _resolve_free(self, expr: sp.Expr, variable: sp.Expr) -> sp.Expr:
        """Resolve an expression as a function of a variable that no premise has fixed."""
        if variable.is_Symbol:
            self._free(variable)
        before = set(self._used)
        found = self._resolve(expr)
        for name in self._used - before:
            fixed = fixed_value(variable, self._origins[name].premises)
            if fixed is not None:
                raise StepError(f"{self.label}: {variable} is {fixed} by a premise of {name}")
        hidden = self._hidden()
        for name in found.free_symbols & hidden.keys():
            if variable in hidden[name]:
                raise StepError(f"{self.label}: {name} depends on {variable}, which {found} hides")
        return found

    def _interval(self, over: Interval, *, symbolic: bool = False) -> None:
        """Refuse an interval that is empty, or that leaves what its variable or a name may be."""
        variable, low, high = over[0], *map(sp.sympify, over[1:])
        self._free(variable)
        if not variable.is_extended_real or variable.is_integer:
            raise StepError(f"{self.label}: {variable} does not run through an interval of reals")
        numbers = low.is_number and high.is_number
        if (
            not (low < high)
            if numbers and low.is_extended_real and high.is_extended_real
            else (not symbolic or numbers)
        ):
            raise StepError(f"{self.label}: {over} is not an interval between two known numbers")
        self._reaches(variable, low, high)

    def _reaches(self, variable: sp.Symbol, low: sp.Expr, high: sp.Expr) -> None:
        """Refuse an interval that leaves the values that its variable may have."""
        below = low if variable.is_nonnegative else -high if variable.is_nonpositive else None
        ends = [end for end in (low, high) if end.is_finite is not False]
        beyond = any(violates(sp.Dummy(real=variable.is_real), end) for end in ends)
        if beyond or (below is not None and not proves_nonnegative(below, self._conditions)):
            raise StepError(f"{self.label}: {variable} cannot reach from {low} to {high}")

    def _possible(self, over: Interval) -> None:
        """Refuse an interval in which a name or a condition cannot be what it is said to be."""
        named = [
            (name, self._resolve(name)) for name in tuple(self._used)
            if (name.is_positive or name.is_negative) and name.is_Symbol
        ]  # fmt: skip
        demanded = [value if name.is_positive else -value for name, value in named]
        for value in (*demanded, *self._conditions.positive):
            inside = NONE.with_interval(over)
            if value.free_symbols == {over[0]} and not proves_nonnegative(value, inside):
                raise StepError(f"{self.label}: inside {over}, {value} is not positive as assumed")

    def _undefined(self, raw: sp.Expr, resolved: sp.Expr) -> set[sp.Expr]:
        """Return what stands under a fraction bar in one form or the other."""
        named = {base: self._resolve(base) for base in demands(raw)[0]}
        settled = {form for base, form in named.items() if proves_nonzero(base, self._conditions)}
        return {
            base
            for base in {*named.values(), *demands(resolved)[0]} - settled
            if not base.is_nonzero
        }

    def _equally_defined(
        self, left: tuple[sp.Expr, sp.Expr], right: tuple[sp.Expr, sp.Expr], claim: Said | str
    ) -> None:
        """Refuse an equality of which one side is not defined or not real where the other is.

        What both sides demand alike needs no proof.
        """
        for kind, proves, why in (
            (0, proves_nonzero, "may vanish"),
            (1, proves_nonnegative, "may be negative"),
        ):
            demanded: list[dict[sp.Expr, list[sp.Expr]]] = []
            for raw, resolved in (left, right):
                forms: dict[sp.Expr, list[sp.Expr]] = {}
                for base in demands(sp.sympify(raw))[kind]:
                    forms.setdefault(normalise(self._resolve(base)), []).append(base)
                for base in demands(resolved)[kind]:
                    forms.setdefault(normalise(base), []).append(base)
                demanded.append(forms)
            shared = demanded[0].keys() & demanded[1].keys()
            one, other = (
                shared | self._unproved(forms, forms.keys() - shared, proves) for forms in demanded
            )
            if one == other:
                continue
            if kind == 0:
                one, other = (set().union(*map(_parts, each)) for each in (one, other))
            unproved = {base for base in one ^ other if not proves(base, self._conditions)}
            for base in unproved - self._proved_of_names(kind, proves) if unproved else ():
                raise StepError(
                    f"{self.label}: {claim}: {base} {why}, on one side only; say where it does not"
                )

    def _unproved(
        self,
        forms: dict[sp.Expr, list[sp.Expr]],
        wanted: Iterable[sp.Expr],
        proves: Callable[..., bool],
    ) -> set[sp.Expr]:
        """Return those that are wanted, and proved neither as they are nor in another of their forms."""
        known = self._conditions
        return {
            base for base in wanted if not any(proves(each, known) for each in (*forms[base], base))
        }

    def _proved_of_names(self, kind: int, proves: Callable[..., bool]) -> set[sp.Expr]:
        """Return what names rest on by their definitions, where it is proved in the letters of these."""
        used, found = set(self._used), set()
        for value in self._rules.values():
            for base in demands(value)[kind]:
                if proves(base, self._conditions):
                    written = normalise(self._resolve(base))
                    found |= {written} if kind else _parts(written)
        self._used = used
        return found


def _is_smooth_inside(expr: sp.Expr, over: Interval, known: Conditions) -> bool:
    """Tell whether the expression is smooth in the interval without its ends."""
    low, high, step = sp.sympify(over[1]), sp.sympify(over[2]), sp.Dummy(positive=True)
    if low.is_finite and high.is_finite:
        place = (low + high * step) / (1 + step)
    elif low.is_finite or high.is_finite:
        place = low + step if low.is_finite else high - step
    else:
        step = place = sp.Dummy(real=True)
    return is_continuous(expr.subs(over[0], place), (step, -sp.oo, sp.oo), known, smooth=True)


def _value_near(expr: sp.Expr, variable: sp.Symbol, end: sp.Expr, sign: int) -> sp.Expr:
    """Return what has the sign of the expression close to an end: its value or leading coefficient."""
    value = expr.subs(variable, end) if end.is_finite else sp.nan
    if value.is_finite and sp.factor(value).is_nonzero:
        return value
    return leading_term(expr, variable, end, side=-1 if end == sp.oo else -sign)[0]


def _parts(base: sp.Expr) -> set[sp.Expr]:
    """Return the factors of an expression that may vanish."""
    found = set()
    for part in map(sp.powsimp, sp.fraction(sp.together(base))):
        if not part.free_symbols:
            continue
        _, factors = sp.factor_list(part)
        found |= {factor for factor, _ in factors if not factor.is_nonzero}
    return found
