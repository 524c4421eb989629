"""How far rounding can move what a formula computes: the worst case, to first order.

A `Rounded` is a float with its derivative to the relative error of every operation that led to it. Each error
is at most half a unit in the last place for + - * / and roots, as IEEE 754 says, and as in `ERRORS` for
functions of the C library or of NumPy's vector loops. The worst case is that all of them add up.
"""

import math

import numpy as np

UNIT = 2.0**-53
ERRORS = {np.hypot: 2 * UNIT, np.cbrt: 8 * UNIT}
"""One unit in the last place; for cube roots four, as with the C library of GNU up to 2.40."""
DERIVATIVES = {
    np.add: lambda x, y: (1.0, 1.0),
    np.subtract: lambda x, y: (1.0, -1.0),
    np.multiply: lambda x, y: (y, x),
    np.divide: lambda x, y: (1.0 / y, -x / (y * y)),
    np.sqrt: lambda x: (0.5 / math.sqrt(x),),
    np.cbrt: lambda x: (np.cbrt(x) / (3.0 * x),),
    np.hypot: lambda x, y: (x / math.hypot(x, y), y / math.hypot(x, y)),
    np.negative: lambda x: (-1.0,),
    np.absolute: lambda x: (math.copysign(1.0, x),),
}
EXACT = np.negative, np.absolute
CHOICES = np.minimum, np.maximum


class Rounded(np.lib.mixins.NDArrayOperatorsMixin):
    """A computed number, with its derivatives to the errors of operations and what these can be at most."""

    def __init__(self, value, terms=()):
        self.value, self.terms = float(value), dict(terms)

    @property
    def worst(self):
        """The largest relative error."""
        total = sum(abs(slope) * most for slope, most in self.terms.values())
        return total / abs(self.value) if total else 0.0

    def __array_ufunc__(self, ufunc, method, *inputs, **_):
        values = [float(getattr(each, "value", each)) for each in inputs]
        found = ufunc(*values)
        if found.dtype == bool:
            return found
        if ufunc in CHOICES:
            chosen = inputs[values.index(found)]
            return chosen if isinstance(chosen, Rounded) else Rounded(found)
        terms = {}
        for each, slope in zip(inputs, DERIVATIVES[ufunc](*values), strict=True):
            for key, (own, most) in getattr(each, "terms", {}).items():
                terms[key] = terms.get(key, (0.0, most))[0] + slope * own, most
        doubled = ufunc is np.multiply and any(abs(math.frexp(x)[0]) == 0.5 for x in values)
        if ufunc not in EXACT and not doubled:
            terms[object()] = float(found), ERRORS.get(ufunc, UNIT)
        return Rounded(found, terms)
