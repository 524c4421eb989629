"""Steps for the engine to judge: false ones that it must refuse, true ones that it must accept.

Each is a function that takes a fresh proof. They are written as a referee would who wants a false
statement past the engine, and as an author would who has a right one.
"""

from dataclasses import replace

import sympy as sp
from kvtheory.derivations.engine.step import Proof

from tests.planted_fresh import equal, root, sign, unique

x, u = sp.symbols("x u", real=True)
y, z, a, b = sp.symbols("y z a b", positive=True)
n = sp.Symbol("n", integer=True)
w = sp.Symbol("w")
r, s, lam = sp.symbols("r s lambda", positive=True)
h = sp.Symbol("h", positive=True)
f = sp.Function("f", real=True)
half = sp.Rational(1, 2)
E = {"eps": h}


def finished(label, *definitions):
    """Finish a proof whose last definition is its result, and from which a later one may recall."""
    source = Proof(label, None, section="Trial", title="Earlier")
    for name, value, *_ in definitions:
        source.define(name, value)
    name, value, result = definitions[-1]
    source.equal(name, result, "its value")
    source.done(name, result)


def fixed_at_one():
    """Finish a load that holds for y = 1 only."""
    finished("at-one", (y, sp.S.One), (b, 4 * y / 3, sp.Rational(4, 3)))


def _two_values(p):
    for label, name, value in (("one-way", a, 1), ("other-way", b, 2)):
        finished(label, (y, sp.Integer(value)), (name, 3 * y, sp.Integer(3 * value)))
        p.recall(label, (name, sp.Integer(3 * value)))
    p.equal(a / b, half, "from premises that exclude each other")


def _sweep_what_is_fixed(p):
    fixed_at_one()
    p.recall("at-one", (b, sp.Rational(4, 3)))
    p.sign(b - y, ">", 0, (y, 0, 1), "for every y, though the load was that of y = 1")


def _hidden_in_recalled(p):
    finished("radius", (r, sp.sqrt(s**2 + lam**2)), (a, r * s, s * r))
    p.recall("radius", (a, s * r))
    p.equal(sp.Derivative(a, s), r, "r depends on s")


def _hidden_twice(p):
    p.define(a, r * s)
    p.define(r, sp.sqrt(s**2 + lam**2))
    p.equal(sp.Derivative(a, s), r, "r depends on s, two names deep")


def _after(definitions, step=lambda p: None):
    def both(p):
        for lhs, rhs in definitions:
            p.define(lhs, rhs)
        step(p)

    return both


def _defined(*definitions):
    return _after(definitions)


def _order(expr, leading, point=0, eps=h, variable=h):
    return lambda p: p.leading_order(expr, sp.sympify(leading), variable, point, "series", eps=eps)


def _integral(integrand, over, primitive, **more):
    return lambda p: p.integral(u, integrand, over, primitive, "integral", **more)


def _where(conditions, step):
    def both(p):
        for condition in conditions:
            p.where(condition)
        step(p)

    return both


def _holds(expr, relation="≥"):
    return lambda p: p.holds(expr, {"≥": ">=", ">": ">"}[relation], 0, "inequality")


parabola = h**2 - 4 * h + 1

m = sp.Symbol("m", nonnegative=True)
g = sp.Function("g", positive=True)


def _placed_root(p):
    source = Proof("two", None, section="Trial", title="A root")
    source.root(x**2 - 4, x, sp.Integer(2), "the positive one", over=(x, 0, sp.oo))
    source.done(x, sp.Integer(2))
    p.recall("two", (x, sp.Integer(2)), at={x: u})


FALSE = {
    # what a referee got past an earlier engine
    "root for another letter": _placed_root,
    "leading term that may vanish": _order((a - 1) * h + h**2, (a - 1) * h),
    "leading term of unknown sign": _order(x * h + h**2, x * h),
    "crossover of a parameter": _order(1 / (m + h), 1 / m),
    "root of what may be zero": _order(sp.sqrt(m + h), sp.sqrt(m)),
    "positive where it may be zero": _holds(m, ">"),
    "inverse of what may be zero": _holds(1 / m, ">"),
    "square of what may be zero": _holds(m**2 + m, ">"),
    "integer that is half of one": lambda p: p.define(n, x / 2),
    "integer that is a real number": lambda p: p.define(n, u),
    "decay of unknown sign": _integral(sp.exp(-x * h), (h, 0, sp.oo), -sp.exp(-x * h) / x),
    "remainder in another variable": lambda p: p.leading_order(
        h + h**2, h, h, 0, "short", eps=2 * h, short=True
    ),
    # orders
    "half power hides in the remainder": _order(1 + h + h ** sp.Rational(3, 2), 1),
    "logarithm hides in the remainder": _order(1 + h + h**2 * sp.log(h), 1),
    "square root as the next term": _order(1 + sp.sqrt(h), 1),
    "logarithm as the next term": _order(1 + h * sp.log(h), 1),
    "wrong coefficient": _order(2 * h + h**2, h),
    "wrong power": _order(h + h**2, h**2),
    "order at infinity turned round": _order(h + 1, 1, sp.oo, 1 / h),
    "what is not small": _order(1 + h, 1, 0, 1 + h),
    "small but negative": _order(1 + h, 1, 0, -h),
    "absolute value taken from one side": _order(sp.Abs(x) + x**2, x, 0, x, x),
    "limit at minus infinity": _order(1 + 1 / x, 1, -sp.oo, 1 / x, x),
    "exact, so without a next term": _order(h, h),
    "oscillates": _order(1 + h * sp.sin(1 / h), 1),
    # roots
    "one of two roots without an interval": root(parabola, h, 2 - sp.sqrt(3)),
    "negative root of a positive symbol": root(a + 1, a, -1),
    "zero for a positive symbol": root(a**2 - a, a, 0),
    "root of nothing": root(0, x, 17),
    "root of what does not contain it": root(y - y * 1, x, 3),
    "complex root": root(x**2 + 1, x, sp.I),
    "root of the wrong sign": root(x**2 + 2 * y * x - 1, x, sp.sqrt(1 + y**2) + y, over=(x, 0, sp.oo)),
    "outside of the interval": root(x**2 - 4, x, 2, over=(x, 0, 1)),
    "at the open end of the interval": root(x**2 - x, x, 1, over=(x, 0, 1)),
    "root at a pole": root((x - 1) ** 2 / (x - 1) ** 3, x, 1),
    "not known to be real": root(x**2 - u, x, sp.sqrt(u), over=(x, 0, sp.oo)),
    "second root between symbolic ends": root((x - a) * (x - 2 * a), x, a, over=(x, 0, 3 * a)),
    "fractional power with two roots": root(h - 3 * sp.sqrt(h) + 2, h, 1),
    "name that cannot have the value": root(x**2 - a, x, -sp.sqrt(a), over=(x, -sp.oo, 0), name=b),
    "bound whose finiteness is unknown": unique(z - 5, (z, 0, b)),
    "symbolic bound beyond which the root lies": unique(x - 5, (x, 0, a)),
    "double root as a change of sign": unique((x - 1) ** 2, (x, 0, 2)),
    "two roots": unique(x**2 - 2, (x, -2, 2)),
    "no root where one is claimed": unique(x**2 + 2, (x, -2, 2)),
    "irrational end at the root": unique(x**2 - 2, (x, 0, sp.sqrt(2))),
    "empty interval": unique(x - half, (x, 1, 0)),
    "interval beyond the assumptions": unique(y + half, (y, -1, 1)),
    # premises
    "a value for every velocity from a premise at one": _sweep_what_is_fixed,
    "premises of two results exclude each other": _two_values,
    "defined as negative": _defined((a, -sp.S.One)),
    "a square that is negative": _defined((a**2, -sp.S.One)),
    "no common solution": _defined((x**2, sp.S.One), (x**3, sp.Integer(5))),
    "the same in another order": _defined((x, sp.Integer(2)), (x**2, sp.S.One)),
    "twice itself": _defined((a, 2 * b), (b, 2 * a)),
    "a real that is not": _defined((x, sp.sqrt(-2))),
    "an integer that is not": _defined((n, half)),
    "a quantity that is infinite": _defined((x, sp.oo)),
    "vanishing sum of squares": _defined((a**2 + b**2, sp.S.Zero)),
    "derivative against the function": _after(
        [(f(x), x**2)], lambda p: p.equal(sp.Derivative(f(x), x), sp.S.Zero, "though f = x²")
    ),
    "a condition against the assumptions": lambda p: p.where(sp.Lt(a, -1)),
    "interval in which a name is negative": _after([(a, 1 - h)], sign(2 - a, ">", (h, 0, 2))),
    "sweeping a variable that has a value": _after([(h, half)], sign(h, ">", (h, 0, 1))),
    "hidden two names deep": _hidden_twice,
    "hidden in a recalled result": _hidden_in_recalled,
    # branches, signs, zero divisors
    "root of a square": equal(sp.sqrt(x**2), x),
    "root of a product of reals": equal(sp.sqrt(x * u), sp.sqrt(x) * sp.sqrt(u)),
    "cube root of a cube": equal(sp.cbrt(x**3), x),
    "absolute value dropped": equal(sp.Abs(x), x),
    "larger of two is the first": equal(sp.Max(x, u), x),
    "logarithm of a square": equal(sp.log(x**2), 2 * sp.log(x)),
    "arc tangent of the inverse": equal(sp.atan(1 / x), sp.pi / 2 - sp.atan(x)),
    "sum of arc tangents": equal(sp.atan(x) + sp.atan(u), sp.atan((x + u) / (1 - x * u))),
    "arc sine of a sine": equal(sp.asin(sp.sin(x)), x),
    "true for integers only": equal(sp.sin(sp.pi * x), 0),
    "true for even integers only": equal((-1) ** n, 1),
    "true for reals only": equal(sp.Abs(w) ** 2, w**2),
    "removable singularity": equal((x**2 - 1) / (x - 1), x + 1),
    "removable singularity, hidden by a name": _after([(u, x - 1)], equal((x**2 - 1) / u, x + 1)),
    "tangent times cosine": equal(sp.tan(x) * sp.cos(x), sp.sin(x)),
    "inverse of an inverse": equal(1 / (1 / (x - 1) + 1) * x / (x - 1), 1),
    "nothing over nothing": equal(sp.Mul(x - x, 1 / (x - 1), evaluate=False) / (x - 1) * (x - 1), 1),
    "zero to the power of zero": equal(sp.Pow(x, 0, evaluate=False) + 1 / x - 1 / x, 2),
    "almost the same number": equal(sp.sqrt(2), sp.Rational(141421356237309504880, 10**20)),
    "almost the same by a factor": equal(2 * y, (y + y) * (1 + y / 10**60)),
    "signum squared": equal(sp.sign(x) ** 2, 1),
    # signs
    "zero at an end that is inside": sign(x * (1 - x), ">", (x, -1, 1)),
    "changes its sign next to the end": sign((x - sp.Rational(1, 10**9)) * (x + 1), ">=", (x, 0, 1)),
    "bound that is reached": sign(x * (1 - x), "<", (x, 0, 1), sp.Rational(1, 4)),
    "pole inside": sign(1 / (2 * x - 1) ** 2, ">", (x, 0, 1)),
    "undefined inside": sign((x**2 - 1) / (x - 1), ">", (x, 0, 2)),
    "factor of unknown sign": sign(u * (x + 1), ">", (x, 0, 1)),
    "interval of the wrong sign": sign(a + 1, ">", (a, -5, 5)),
    "symbolic end": sign(1 - x, ">", (x, 0, a)),
    "irrational end passed": sign(2 - x**2, ">", (x, 0, sp.Rational(3, 2))),
    "integers do not sweep": sign(n**2 + n, ">", (n, -1, 1)),
    "complex does not sweep": sign(w**2 + 1, ">", (w, -1, 1)),
    "empty interval of a sign": sign(-sp.S.One - x**2, ">", (x, 1, 0)),
    "inequality without its condition": _holds(1 - y, ">"),
    "inequality that fails in a corner": _where([y < 1], _holds(half - y)),
    "product of unknown signs": _holds(x * u),
    "square less a square": _holds(y**2 - z**2),
    "greatest value that is not reached": lambda p: p.greatest(
        sp.Integer(2), 1 - x**2, (x, sp.S.Zero), "too large", surplus=1 + x**2
    ),
    "greatest value that is exceeded": lambda p: p.greatest(
        sp.S.Zero, x, (x, sp.S.Zero), "too small", surplus=-x
    ),
    "equivalent turned round": lambda p: p.equivalent(y * (z - x), x, z, "wrong side"),
    "equivalent up to a factor of unknown sign": lambda p: p.equivalent(u * (x - z), x, z, "u < 0"),
    # integrals
    "value outside of the reals": _integral(-1 / sp.sqrt(1 - x**2), (x, 0, 2), sp.acos(x)),
    "across a pole": _integral(1 / x**2, (x, -1, 1), -1 / x),
    "divergent at infinity": _integral(1 / y, (y, 1, sp.oo), sp.log(y)),
    "divergent at zero": _integral(1 / y**2, (y, 0, 1), -1 / y),
    "wrong branch of the arc tangent": _integral(
        -1 / (1 + x**2), (x, -1, 1), sp.atan(1 / x)
    ),
    "tangent across its pole": _integral(1 / sp.cos(x) ** 2, (x, 0, sp.pi), sp.tan(x)),
    "primitive with a jump": _integral(sp.S.Zero, (x, -1, 1), sp.sign(x)),
    "root of what turns negative": _integral(1 / (2 * sp.sqrt(x)), (x, -1, 1), sp.sqrt(x)),
    "wrong primitive": _integral(x, (x, 0, y), x**2),
    "wrong value": _integral(x, (x, 0, y), x**2 / 2, value=y**2),
    "positive variable led below zero": _integral(sp.Integer(1), (a, -1, 1), sp.Abs(a)),
    "primitive with an undefined end": _integral(sp.log(y), (y, 0, sp.oo), y * sp.log(y) - y),
    "variable that has a value": _after([(x, sp.Integer(3))], _integral(x, (x, 0, y), 3 * x)),
    # displays
    "display of other numbers": equal(x, x, left="0", right="1"),
    "display of another right side": equal((y + 1) ** 2, y**2 + 2 * y + 1, right="y^2 + 1"),
    "display of another left side": equal(2 * y, y + y, left="3 y"),
    "display of another function": equal(f(x) + 0 * y, f(x), left="f(y)"),
    "display with a chain that breaks": equal(2 * y, y + y, right="2 y = 3 y"),
    "display that cannot be read": equal(x, x, left=r"\ldots"),
    "display that hides in words": equal(x, x, left=r"\text{anything}"),
    "display of another definition": lambda p: p.define(z, y**2, right="y^3"),
    "display of another derivative": equal(
        sp.Derivative(x**2, x), 2 * x, left=r"\frac{d}{dx} x^3"
    ),
    "display of another integral": lambda p: p.integral(
        z, 3 * x**2, (x, 0, y), x**3, "power rule", right=r"\int_{0}^{y} x^2 \, dx"
    ),
    "display of another asymptote": lambda p: p.leading_order(
        h + h**2, h, h, 0, "series", eps=h, right="2 h"
    ),
    "display of another root": root(x - 3, x, 3, right="4"),
}  # fmt: skip

TRUE = {
    "parameter that cannot vanish": _order(sp.sqrt(a**2 + h), a),
    "sum of what may be zero and what not": _holds(m**2 + a, ">"),
    "order of a sum that may begin later": lambda p: p.leading_order(
        (a - 1) * h + h**2, (a - 1) * h, h, 0, "a remainder of its own", eps=h, short=True
    ),
    "name that may be zero": lambda p: p.define(m, x**2),
    "smooth function by parts": _integral(
        x * sp.Derivative(f(x), (x, 2)), (x, 0, y), x * sp.Derivative(f(x), x) - f(x)
    ),
    # orders
    "what is smaller than any power": _order(1 + h + sp.exp(-1 / h), 1),
    "Taylor of an exponential": _order(sp.exp(h) - 1, h),
    "pole": _order(1 / (1 - sp.exp(-h)), 1 / h),
    "at infinity": _order(sp.sqrt(1 + h**2) - h, 1 / (2 * h), sp.oo, 1 / h),
    "at a point": _order((1 - h**3) / 3, 1 - h, 1, 1 - h),
    "in another small quantity": _order(h + h**3, h, 0, 4 * h**2),
    "logarithm of a series": _order(sp.log(1 + h), h),
    "with a parameter": _order(h / (a + h), h / a),
    # roots
    "friction maximum": root(parabola, h, 2 - sp.sqrt(3), over=(h, 0, 1)),
    "quadratic with a symbol": root(x**2 + 2 * y * x - 1, x, sp.sqrt(1 + y**2) - y, over=(x, 0, sp.oo)),
    "positive root of a positive symbol": root(a**2 - 4, a, 2),
    "cubic with one positive root": root(a**3 - b, a, sp.cbrt(b)),
    "fractional powers with one root": root(h ** sp.Rational(3, 2) - b, h, b ** sp.Rational(2, 3)),
    "named": root(x**2 - b, x, sp.sqrt(b), over=(x, 0, sp.oo), name=a),
    "between symbolic ends": root((x - a) * (x + a), x, a, over=(x, 0, 3 * a)),
    "double root as a root": root((x - 1) ** 2, x, 1),
    "with a condition": _where([sp.Gt(u, 0)], root(x**2 - u, x, sp.sqrt(u), over=(x, 0, sp.oo))),
    "in an exponential": root(x * sp.exp(y) - z, x, z * sp.exp(-y)),
    "unique root": unique(x**2 - 2, (x, 0, 2)),
    "unique root to an irrational end": unique(x**2 - 2, (x, 0, sp.sqrt(3))),
    "unique root from an irrational end": unique(x**2 - 4, (x, sp.sqrt(2), sp.oo)),
    "unique root without ends": unique(x**3 + x - 1, (x, -sp.oo, sp.oo)),
    "ends do not count": unique(x * (2 * x - 1) * (x - 1), (x, 0, 1)),
    "triple root changes the sign": unique((x - 1) ** 3, (x, 0, 2)),
    # premises
    "definitions in a row": _defined((z, y**2), (a, z + 1)),
    "two laws": _defined((x**2, sp.S.One), (x**3, sp.S.One)),
    "square": _after([(z, y**2)], equal(sp.sqrt(z), y)),
    "derivative of what is named": _after(
        [(r, sp.sqrt(s**2 + lam**2))], equal(sp.Derivative(r * s, s), (2 * s**2 + lam**2) / r)
    ),
    "derivative of what is named, two deep": _after(
        [(a, r * s), (r, s**2)], equal(sp.Derivative(a, s), 3 * s**2)
    ),
    "value of a function": _after([(f(x), x**2)], equal(sp.Derivative(f(x), x), 2 * x)),
    "domain of a name": _after([(a, 1 - h)], sign(2 - a, ">", (h, 0, 1))),
    "condition": lambda p: p.where(a < b),
    "a value for the variable of an integral and of a derivative": _defined(
        (f(y), sp.Integral(x * sp.Derivative(f(u), u), (x, 0, z))), (x, z**2), (u, z + 1)
    ),
    # identities
    "binomial": equal((x + y) ** 2, x**2 + 2 * x * y + y**2),
    "rationalised": equal(1 / (sp.sqrt(1 + y) + sp.sqrt(y)), sp.sqrt(1 + y) - sp.sqrt(y)),
    "root of a square, positive": equal(sp.sqrt(y**2), y),
    "root of a square, real": equal(sp.sqrt(x**2), sp.Abs(x)),
    "root of a quotient": equal(sp.sqrt(1 + (1 - y**2) ** 2 / (4 * y**2)), (1 + y**2) / (2 * y)),
    "root of a product": equal(sp.sqrt(y * z), sp.sqrt(y) * sp.sqrt(z)),
    "Pythagoras": equal(sp.sin(x) ** 2 + sp.cos(x) ** 2, 1),
    "larger and smaller": equal(sp.Max(x, u) + sp.Min(x, u), x + u),
    "logarithm of a product of positives": equal(sp.log(y * z), sp.log(y) + sp.log(z)),
    "cancelled where it may be": _where(
        [x > 1], equal((x**2 - 1) / (x - 1), x + 1)
    ),
    "tangent where it may be": _where([sp.cos(x) > 0], equal(sp.tan(x) * sp.cos(x), sp.sin(x))),
    "derivative": equal(sp.Derivative(sp.exp(-x / y), x), -sp.exp(-x / y) / y),
    "value at a place": equal(sp.Subs(x**2 + x, x, y), y**2 + y),
    "in each of two cases": lambda p: p.equal(
        x * (x - 1), sp.S.Zero, "at both", cases=(sp.Eq(x, 0), sp.Eq(x, 1))
    ),
    # signs
    "parabola": sign(x * (1 - x), ">", (x, 0, 1)),
    "square with a touch": sign((2 * x - 1) ** 2, ">=", (x, 0, 1)),
    "bound": sign(x * (1 - x), "<=", (x, 0, 1), sp.Rational(1, 4)),
    "to an irrational end": sign(2 - x**2, ">", (x, 0, sp.sqrt(2))),
    "with a positive factor": sign(y * (x + 1), ">", (x, 0, 1)),
    "derivative of known sign": sign(sp.Derivative(x**3 + x, x), ">", (x, -sp.oo, sp.oo)),
    "inequality": _holds(y**2 + y * z, ">"),
    "inequality with a condition": _where([sp.Lt(y, z)], _holds(z**2 - y**2, ">")),
    "inequality of exponentials": _where([sp.Lt(x, u)], _holds(sp.exp(u) - sp.exp(x), ">")),
    "integral of what is not negative": _holds(sp.Integral(x**2, (x, 0, y))),
    "greatest value": lambda p: p.greatest(
        sp.S.One, 1 - x**2, (x, sp.S.Zero), "reached at 0", surplus=x**2
    ),
    "equivalent": lambda p: p.equivalent(y * (x - z), x, z, "y > 0"),
    # integrals
    "power": _integral(3 * x**2, (x, 0, y), x**3),
    "to infinity": _integral(sp.exp(-x / y), (x, 0, sp.oo), -y * sp.exp(-x / y)),
    "arc tangent": _integral(1 / (1 + x**2), (x, -1, 1), sp.atan(x)),
    "arc sine": _integral(1 / sp.sqrt(1 - x**2), (x, 0, half), sp.asin(x)),
    "root at its end": _integral(1 / (2 * sp.sqrt(x)), (x, 0, 1), sp.sqrt(x)),
    "function that is not known": _integral(sp.Derivative(f(x), x), (x, 0, y), f(x)),
    # displays
    "rearranged": equal((y + 1) ** 2, y**2 + 2 * y + 1, right="1 + 2 y + y^{2}"),
    "chain": equal(2 * y, y + y, right=r"2 y = \frac{4 y}{2}"),
    "function and its argument": equal(f(x) + y, y + f(x), left="f(x) + y"),
    "derivative shown": equal(sp.Derivative(x**2, x), 2 * x, left=r"\frac{d}{dx} x^2"),
    "integral shown": lambda p: p.integral(
        z, 3 * x**2, (x, 0, y), x**3, "power rule", right=r"\int_{0}^{y} 3 x^2 \, dx"
    ),
}  # fmt: skip


def derive(module, prove, **given):
    """Derive the record that a function of a chapter proves, with other arguments if some are given."""
    entry = next(each for each in module.result.entries if each.prove.__name__ == prove)
    return replace(entry, given=given or entry.given).derive(module.result.section)
