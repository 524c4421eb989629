"""Guards of a step: no interval for a fixed variable, no value outside its range, no zero divisor."""

import sympy as sp

from .algebra import in_one_angle, normalise
from .book import Book, StepError
from .conditions import (
    Interval,
    demands,
    fails_inside,
    proves_nonnegative,
    proves_nonzero,
)
from .premises import fixed_value, violates


class Guarded(Book):
    """A book that refuses variables, intervals and equalities which cannot be meant."""

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
            if value.free_symbols == {over[0]} and fails_inside(value, over):
                raise StepError(f"{self.label}: inside {over}, {value} is not positive as assumed")

    def _undefined(self, raw: sp.Expr, resolved: sp.Expr) -> set[sp.Expr]:
        """Return what stands under a fraction bar in one form or the other."""
        found = {self._resolve(base) for base in demands(raw)[0]} | demands(resolved)[0]
        return {base for base in found if not base.is_nonzero}

    def _equally_defined(
        self, left: tuple[sp.Expr, sp.Expr], right: tuple[sp.Expr, sp.Expr], claim: str
    ) -> None:
        """Refuse an equality of which one side is not defined or not real where the other is."""
        for kind, proves, why in (
            (0, proves_nonzero, "may vanish"),
            (1, proves_nonnegative, "may be negative"),
        ):
            sides: list[list[sp.Expr]] = []
            for raw, resolved in (left, right):
                named = {base: self._resolve(base) for base in demands(sp.sympify(raw))[kind]}
                settled = {
                    written for base, written in named.items() if proves(base, self._conditions)
                }
                bases = {*named.values(), *demands(resolved)[kind]} - settled
                open_ones = {
                    base for base in map(normalise, bases) if not proves(base, self._conditions)
                }
                sides.append(sorted(open_ones, key=str))
            written = iter(in_one_angle(*sides[0], *sides[1]))
            one, other = ({base for _, base in zip(each, written, strict=False)} for each in sides)
            if kind == 0:
                one, other = (set().union(*map(_parts, each)) for each in (one, other))
            for base in one ^ other:
                if not proves(base, self._conditions):
                    raise StepError(
                        f"{self.label}: {claim}: {base} {why}, on one side only; say where it does not"
                    )


def _parts(base: sp.Expr) -> set[sp.Expr]:
    """Return the factors of an expression that may vanish."""
    found = set()
    for part in map(sp.powsimp, sp.fraction(sp.together(base))):
        if not part.free_symbols:
            continue
        _, factors = sp.factor_list(part)
        found |= {factor for factor, _ in factors if not factor.is_nonzero}
    return found
