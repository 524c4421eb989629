"""Steps for the engine to judge: false ones, which it must refuse, and true ones, which it must accept.

Each row has a name, the step (functions of a fresh proof, one after the other), and, if the name does not
say so, why it is false or what it is for. A false row holds at least one false claim, a contradiction, or two
letters that print alike. Equality means that both sides are defined at the same places, and equal
there; functions of complex numbers have their principal values.
"""

import itertools
import signal
from dataclasses import replace

import sympy as sp
from kvtheory.derivations.engine.book import StepError
from kvtheory.derivations.engine.step import Proof
from sympy import Abs, Derivative, I, Integral, Subs, Sum, atan, cos, exp, log, oo, pi, sin, sqrt
from sympy.codegen.cfunctions import expm1

x, u, v = sp.symbols("x u v", real=True)
y, z, a, b, h, q, l, R, K, nu = sp.symbols("y z a b h q l R K nu", positive=True)
l_r, delta = sp.symbols("l_r delta", positive=True)
m = sp.Symbol("m", nonnegative=True)
n, k = sp.symbols("n k", integer=True)
w = sp.Symbol("w")
f = sp.Function("f", real=True)
r, s, lam = sp.symbols("r s lambda", positive=True)
G = sp.Function("G", positive=True)
other_x = sp.Symbol("x", positive=True)
half, third = sp.Rational(1, 2), sp.Rational(1, 3)
UNIT = (q, 0, 1)
ROW = sp.IndexedBase("x", real=True)
DUMMY, TURN = sp.Dummy("x", real=True), sp.Symbol("o", commutative=False)
NONZERO, FALLEN = sp.Symbol("c_0", real=True, nonzero=True), sp.Symbol("u_0", nonpositive=True)
_labels = itertools.count()


def _proof(label=None, **more):
    label = label or f"planted-{next(_labels)}"
    return Proof(label, None, section="Trial", title="Trial", **more)


def steps(*several):
    def run(p):
        for each in several:
            each(p)

    return run


def equal(lhs, rhs, **cases):
    return lambda p: p.equal(sp.sympify(lhs), sp.sympify(rhs), "identity", **cases)


def holds(lhs, relation=">", rhs=0, **cases):
    return lambda p: p.holds(sp.sympify(lhs), relation, rhs, "inequality", **cases)


def sign(expr, relation, over, bound=0):
    return lambda p: p.sign(sp.sympify(expr), relation, bound, over, "sign")


def root(expr, variable, value, **more):
    return lambda p: p.root(sp.sympify(expr), variable, sp.sympify(value), "root", **more)


def unique(expr, over):
    return lambda p: p.unique_root(expr, over, "unique")


def integral(integrand, over, primitive, name=v, **more):
    return lambda p: p.integral(
        *(name, sp.sympify(integrand), over, "integral"),
        antiderivative=sp.sympify(primitive),
        **more,
    )


def order(expr, leading, variable=h, point=0, eps=h):
    return lambda p: p.leading_order(expr, sp.sympify(leading), variable, point, "series", eps=eps)


def greatest(value, expr, variable, place, surplus, **given):
    return lambda p: p.greatest(
        sp.sympify(value), expr, (variable, sp.sympify(place)), "greatest", surplus=surplus, **given
    )


def equivalent(nonnegative, lhs, rhs):
    return lambda p: p.equivalent(nonnegative, lhs, rhs, "the same")


def define(lhs, rhs):
    return lambda p: p.define(lhs, sp.sympify(rhs))


def where(*conditions):
    return steps(*((lambda p, each=each: p.where(each)) for each in conditions))


def recalled(lhs, rhs, given=(), by=None, at=None):
    """Recall what an earlier derivation proves from the steps `given` and `by`."""

    def run(p):
        source = _proof()
        steps(*given, by or equal(lhs, rhs))(source)
        source.done(sp.sympify(lhs), sp.sympify(rhs))
        p.recall(source.label, (sp.sympify(lhs), sp.sympify(rhs)), at=at)

    return run


def _finish(proof, lhs=(y + 1) ** 2, rhs=y**2 + 2 * y + 1):
    proof.equal(lhs, rhs, "identity")
    return proof.done(lhs, rhs)


def _uses_itself(p):
    label = f"planted-{next(_labels)}"
    _finish(_proof(label, uses=(label,)))


def _uses_unfinished(p):
    source = _proof()
    source.equal((y + 1) ** 2, y**2 + 2 * y + 1, "identity")
    _finish(_proof(uses=(source.label,)))


def _use_one_another(p):
    first, second = (f"planted-{next(_labels)}" for _ in range(2))
    _finish(_proof(first, uses=(second,)))
    _finish(_proof(second, uses=(first,)))


def _one_label_two_theorems(p):
    label = f"planted-{next(_labels)}"
    _finish(_proof(label))
    _finish(_proof(label), (z + 1) ** 2, z**2 + 2 * z + 1)


def _one_label_two_values(p):
    label = f"planted-{next(_labels)}"
    for value in (1, 2):
        source = _proof(label)
        source.define(a, sp.S(value))
        source.done(a, value)


def _done_twice(p):
    _finish(p)
    p.equal((z + 1) ** 2, z**2 + 2 * z + 1, "identity")
    p.done((z + 1) ** 2, z**2 + 2 * z + 1)


def _through_two(first, lhs, rhs, then):
    """Recall 2 lhs = 2 rhs from a derivation that recalls lhs = rhs from one that begins with `first`."""
    again = recalled(2 * lhs, 2 * rhs, given=[recalled(lhs, rhs, given=[first])])
    return steps(again, then)


def _for_every_function(lhs, rhs, by, value, at):
    """Recall what was proved of an unknown function, which is then given a value."""
    return steps(recalled(lhs, rhs, by=by), define(f(at), value))


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


def _defined(*definitions):
    return steps(*(define(*each) for each in definitions))


parabola = h**2 - 4 * h + 1


def _placed_root(p):
    source = Proof("two", None, section="Trial", title="A root")
    source.root(x**2 - 4, x, sp.Integer(2), "the positive one", over=(x, 0, sp.oo))
    source.done(x, sp.Integer(2))
    p.recall("two", (x, sp.Integer(2)), at={x: u})


CANCELLED = (x**2 - 1) / (x - 1), x + 1
POLE = 1 / (1 + exp(1 / x))
KERNEL = sin(x * y) / y
FUBINI = (x**2 - u**2) / (x**2 + u**2) ** 2
FADING = x**3 / y**2 * exp(-(x**2) / y)
PROFILE = 1 - x**2 - 2 * l * x
SHIFTED = sqrt(y**2 + 2 * y + 1)
HURWITZ = a * b * K - a**2 - b**2 * R
"""Of s^4 + b s^3 + K s^2 + a s + R."""


def _at_its_pole(p):
    """Recall an integral at the place that its condition excludes."""
    source = _proof()
    whole = integral(exp((a - b) * x), (x, 0, 1), exp((a - b) * x) / (a - b))
    whole(source)
    done = source.done()
    p.recall(done.label, at={b: a})


FALSE = {
    "x": {
        # what a referee got past an earlier engine
        "root for another letter": _placed_root,
        "root of what may be zero": order(sp.sqrt(m + h), sp.sqrt(m)),
        "positive where it may be zero": holds(m),
        "inverse of what may be zero": holds(1 / m),
        "square of what may be zero": holds(m**2 + m),
        "integer that is half of one": lambda p: p.define(n, x / 2),
        "integer that is a real number": lambda p: p.define(n, u),
        "decay of unknown sign": integral(sp.exp(-x * h), (h, 0, sp.oo), -sp.exp(-x * h) / x),
        "remainder in another variable": lambda p: p.leading_order(
            h + h**2, h, h, 0, "short", eps=2 * h, short=True
        ),
    },
    "orders": {
        "half power hides in the remainder": order(1 + h + h ** sp.Rational(3, 2), 1),
        "logarithm hides in the remainder": order(1 + h + h**2 * sp.log(h), 1),
        "square root as the next term": order(1 + sp.sqrt(h), 1),
        "logarithm as the next term": order(1 + h * sp.log(h), 1),
        "wrong coefficient": order(2 * h + h**2, h),
        "wrong power": order(h + h**2, h**2),
        "order at infinity turned round": order(h + 1, 1, h, sp.oo, 1 / h),
        "what is not small": order(1 + h, 1, h, 0, 1 + h),
        "small but negative": order(1 + h, 1, h, 0, -h),
        "absolute value taken from one side": order(sp.Abs(x) + x**2, x, x, 0, x),
        "limit at minus infinity": order(1 + 1 / x, 1, x, -sp.oo, 1 / x),
        "exact, so without a next term": order(h, h),
        "oscillates": order(1 + h * sp.sin(1 / h), 1),
    },
    "roots": {
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
    },
    "premises": {
        "a value for every velocity from a premise at one": _sweep_what_is_fixed,
        "premises of two results exclude each other": _two_values,
        "defined as negative": define(a, -sp.S.One),
        "a square that is negative": define(a**2, -sp.S.One),
        "no common solution": _defined((x**2, sp.S.One), (x**3, sp.Integer(5))),
        "the same in another order": _defined((x, sp.Integer(2)), (x**2, sp.S.One)),
        "twice itself": _defined((a, 2 * b), (b, 2 * a)),
        "a real that is not": define(x, sp.sqrt(-2)),
        "an integer that is not": define(n, half),
        "a quantity that is infinite": define(x, sp.oo),
        "vanishing sum of squares": define(a**2 + b**2, sp.S.Zero),
        "derivative against the function": steps(define(f(x), x**2), equal(sp.Derivative(f(x), x), 0)),
        "a condition against the assumptions": lambda p: p.where(sp.Lt(a, -1)),
        "interval in which a name is negative": steps(define(a, 1 - h), sign(2 - a, ">", (h, 0, 2))),
        "sweeping a variable that has a value": steps(define(h, half), sign(h, ">", (h, 0, 1))),
        "hidden two names deep": steps(
            _defined((a, r * s), (r, sp.sqrt(s**2 + lam**2))), equal(sp.Derivative(a, s), r)
        ),
        "hidden in a recalled result": _hidden_in_recalled,
    },
    "branches, signs, zero divisors": {
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
        "removable singularity, hidden by a name": steps(define(u, x - 1), equal((x**2 - 1) / u, x + 1)),
        "tangent times cosine": equal(sp.tan(x) * sp.cos(x), sp.sin(x)),
        "inverse of an inverse": equal(1 / (1 / (x - 1) + 1) * x / (x - 1), 1),
        "nothing over nothing": equal(sp.Mul(x - x, 1 / (x - 1), evaluate=False) / (x - 1) * (x - 1), 1),
        "zero to the power of zero": equal(sp.Pow(x, 0, evaluate=False) + 1 / x - 1 / x, 2),
        "almost the same number": equal(sp.sqrt(2), sp.Rational(141421356237309504880, 10**20)),
        "almost the same by a factor": equal(2 * y, (y + y) * (1 + y / 10**60)),
        "signum squared": equal(sp.sign(x) ** 2, 1),
    },
    "signs": {
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
        "inequality without its condition": holds(1 - y),
        "inequality that fails in a corner": steps(where(y < 1), holds(half - y, ">=")),
        "product of unknown signs": holds(x * u, ">="),
        "square less a square": holds(y**2 - z**2, ">="),
        "greatest value that is not reached": lambda p: p.greatest(
            sp.Integer(2), 1 - x**2, (x, sp.S.Zero), "too large", surplus=1 + x**2
        ),
        "greatest value that is exceeded": lambda p: p.greatest(
            sp.S.Zero, x, (x, sp.S.Zero), "too small", surplus=-x
        ),
        "equivalent turned round": lambda p: p.equivalent(y * (z - x), x, z, "wrong side"),
        "equivalent up to a factor of unknown sign": lambda p: p.equivalent(u * (x - z), x, z, "u < 0"),
    },
    "integrals": {
        "value outside of the reals": integral(-1 / sp.sqrt(1 - x**2), (x, 0, 2), sp.acos(x)),
        "across a pole": integral(1 / x**2, (x, -1, 1), -1 / x),
        "divergent at infinity": integral(1 / y, (y, 1, sp.oo), sp.log(y)),
        "divergent at zero": integral(1 / y**2, (y, 0, 1), -1 / y),
        "wrong branch of the arc tangent": integral(-1 / (1 + x**2), (x, -1, 1), sp.atan(1 / x)),
        "tangent across its pole": integral(1 / sp.cos(x) ** 2, (x, 0, sp.pi), sp.tan(x)),
        "primitive with a jump": integral(sp.S.Zero, (x, -1, 1), sp.sign(x)),
        "root of what turns negative": integral(1 / (2 * sp.sqrt(x)), (x, -1, 1), sp.sqrt(x)),
        "wrong primitive": integral(x, (x, 0, y), x**2),
        "wrong value": integral(x, (x, 0, y), x**2 / 2, value=y**2),
        "positive variable led below zero": integral(sp.Integer(1), (a, -1, 1), sp.Abs(a)),
        "primitive with an undefined end": integral(sp.log(y), (y, 0, sp.oo), y * sp.log(y) - y),
        "variable that has a value": steps(define(x, sp.Integer(3)), integral(x, (x, 0, y), 3 * x)),
    },
    "letters": {
        "member of a row and a letter":
            equal(2 * ROW[1] + sp.Symbol("x_1", real=True), sp.Symbol("x_1", real=True) + ROW[1] + ROW[1]),
    },
    "recall outside its domain": {
        "exchanged one after the other":
            (recalled((a + 2 * b) ** 2, a**2 + 4 * a * b + 4 * b**2, at={a: b, b: a}),
             equal((a + 2 * a) ** 2, b**2 + 4 * b * a + 4 * a**2), "9 a^2"),
        "root at a negative place":
            (where(x < -1), recalled(SHIFTED, y + 1, at={y: x}), equal(sqrt(x**2 + 2 * x + 1), x + 1),
             "x = -3: 2 is not -2"),
        "logarithm at a negative place":
            (where(x < 0), recalled(log(y**2), 2 * log(y), at={y: x}), "x = -1"),
        "difference of lengths":
            (where(l_r < a), recalled(SHIFTED, y + 1, at={y: l_r - 2 * a}),
             "l_r = 1, a = 2: 2 is not -2"),
        "condition against the premise":
            (where(x < 1), recalled(*CANCELLED, given=[where(x > 1)]), "no x is both"),
        "real letter at a complex one":
            (recalled(sqrt(x**4 + 2 * x**2 + 1), x**2 + 1, at={x: w}), define(w, 2 * I), "3 is not -3"),
        "letter at a function that is negative":
            (recalled(SHIFTED, y + 1, at={y: f(x)}), define(f(x), -2 - x**2), "x = 0: 1 is not -1"),
        "at a place below its condition":
            (where(u < 1), recalled(*CANCELLED, given=[where(x > 1)], at={x: u}), "u < 1 and u > 1"),
    },
    "greatest": {
        "peak ahead of the leading edge":
            (greatest(1 + l**2, PROFILE, x, -l, (x + l) ** 2, given=(x > -1, l > 1)),
             "-l < -1 is outside"),
        "negative depth":
            (greatest(0, -K * (delta + a) ** 2, delta, -a, K * (delta + a) ** 2),
             "delta = -a is excluded"),
        "state at rest, which is excluded":
            (where(q < 1), greatest(4, (1 + q) ** 2, q, 1, (1 - q) * (3 + q)), "q < 1"),
        "place that is imaginary": (greatest(1, -(x**2), x, I, 1 + x**2), "for real x it is at most 0"),
        "place between integers":
            (greatest(sp.Rational(1, 4), n * (1 - n), n, half, (n - half) ** 2),
             "n = 1/2 is no integer; the greatest is 0"),
        "value that varies": (greatest(x**2 + 1, x**2 + 1, x, x, sp.S.Zero), "x^2 + 1 is not bounded"),
        "place that varies":
            (greatest(2 * x * u - u**2, 2 * x * u - u**2, u, u, sp.S.Zero), "the greatest is x^2"),
        "surplus of the wrong form":
            (greatest(1, 2 * x - x**2 + u**2 * (x - 1), x, 1, (x - 1) ** 2), "u^2 (x - 1) is without bound"),
        "outside of a condition":
            (where(x > 2), greatest(4, 4 - x**2, x, 0, x**2), "below 0 for x > 2"),
        "arm that has relaxed altogether":
            (greatest(1, 1 - exp(-y), y, oo, exp(-y)), "1 is not reached"),
    },
    "conditions of a bound variable": {
        "pressure behind, where x < 0":
            (where(x < 0), holds(Integral(-K * x, (x, 0, a)), ">="), "-K a^2/2"),
        "integral beyond the condition":
            (where(q < 1), holds(Integral(1 - q, (q, 0, 3)), ">="), "-3/2"),
        "positive letter below zero": (holds(Integral(y, (y, -2, -1)), ">="), "-3/2"),
        "negative retardation length":
            (holds(Integral(l_r * exp(-l_r / a), (l_r, -a, 0)), ">="), "-a^2"),
        "root of a positive letter at a place": (equal(Subs(SHIFTED, y, u), u + 1), "u = -3: 2 is not -2"),
        "load of a longer retardation":
            (where(l_r < a), holds(Integral(a - l_r, (l_r, 0, 3 * a)), ">="), "-3 a^2/2"),
        "named integral": (define(v, Integral(y, (y, -1, 0))), holds(v, ">="), "-1/2"),
    },
    "one-sided leading orders": {
        "moment about an edge":
            (order(sqrt(a**2 * x**2 + x**4), a * x, x, 0, x**2 / a**2), "-a x for x < 0"),
        "distance in q":
            (order(Abs(1 - q) * (1 + (1 - q) ** 2), 1 - q, q, 1, (1 - q) ** 2), "q - 1 for q > 1"),
        "arc tangent of a pole":
            (order(x * atan(1 / x), pi * x / 2, x, 0, Abs(x)), "-pi x/2 for x < 0"),
        "exponential of a pole": (order(1 + x**2 - POLE, 1, x, 0, x**2), "tends to 0 for x < 0"),
        "distance of two lengths":
            (order(Abs(a - l_r) * (1 + (a - l_r) ** 2), a - l_r, l_r, a, (a - l_r) ** 2),
             "l_r - a for l_r > a"),
        "arc cotangent": (order(sp.acot(x), pi / 2, x, 0, Abs(x)), "-pi/2 for x < 0"),
        "cube root of a cube": (order(sp.cbrt(x**3 + x**5), x, x, 0, x**2), "complex for x < 0"),
        "inverse of a root of a square":
            (order(1 / sqrt(x**2 + x**4), 1 / x, x, 0, x**2), "-1/x for x < 0"),
        "next coefficient": (order(1 + x, 1, x, 0, Abs(x)), "1 + |x| for x > 0, 1 - |x| for x < 0"),
        "next coefficient at a place": (order(q + q**2, 2, q, 1, Abs(1 - q)), "another sign for q > 1"),
    },
    "limits that do not exist or have another value": {
        "wrong value": (equal(sp.Limit(sin(2 * x) / x, x, 0), 1), "2"),
        "pole": (equal(sp.Limit(1 / x, x, 0, "+-"), 0), "no limit"),
        "jump": (equal(sp.Limit(Abs(x) / x, x, 0, "+-"), 1), "-1 on the other side"),
        "jump of a root": (equal(sp.Limit(sqrt(x**2) / x, x, 0, "+-"), 1), "-1 on the other side"),
        "oscillation": (equal(sp.Limit(sin(1 / x), x, 0), 0), "no limit"),
        "unlimited oscillation": (equal(sp.Limit(sin(x), x, oo), 0), "no limit"),
        "outside of the domain": (equal(sp.Limit(sqrt(-y) / sqrt(-y), y, 0, "-"), 1), "y > 0"),
        "letters that may be equal": (equal(sp.Limit(x / (a - b + x), x, 0), 0), "1 where a = b"),
        "equal letters that cancel":
            (equal(sp.Limit((a - b + x**2) / (a - b + x), x, 0), 1), "0 where a = b"),
        "undefined for equal letters": (equal(sp.Limit(exp(x / (a - b)), x, 0), 1), "a may be b"),
        "undefined for equal letters, multiplied out":
            (equal(sp.Limit((a * x - b * x + x**2) / (a * x - b * x), x, 0), 1), "a may be b"),
        "variable with a value": (define(x, 2 * a), equal(sp.Limit(x, x, 0), 0), "x is 2 a here"),
        "limit within a limit":
            (equal(sp.Limit(sp.Limit(1 / u, u, 0) * x, x, 0), 0), "the inner one does not exist"),
        "integer": (equal(sp.Limit(n, n, 0), 0), "n does not come near"),
        "letter named like the distance from the point":
            (order(y * h + y**3, y**2, y, 0, y), "h y is larger than y^2"),
    },
    "limits outside of the domain": {
        "slow where fast": (where(l_r > a), order(a / (a + l_r), 1, l_r, 0, l_r / a), "l_r > a"),
        "fast where slow": (where(q > half), order((1 - q) / (1 + q), 1, q, 0, q), "q > 1/2"),
        "infinity below a bound": (where(h < b), order(sqrt(1 + h**2), h, h, oo, 1 / h**2), "h < b"),
        "letter that is not negative at a negative place":
            (order(1 + (m + 1) ** 2, 1, m, -1, (m + 1) ** 2), "m >= 0"),
    },
    "letters that hide a dependence": {
        "exponential that grows":
            (define(exp(z), b * z), order(1 / z + b / z**2, 1 / z, z, oo, 1 / z),
             "b = e^z/z is without bound"),
        "law for a square": (define(b**2, y), equal(Derivative(b * y, y), b), "b = sqrt y: 3/2 sqrt y"),
        "law for an exponential": (define(exp(b), y), equal(Derivative(b, y), 0), "1/y"),
        "trailing edge of the retardation length":
            (define(q, 1 / (l + sqrt(1 + l**2))), equal(Derivative(q * l, l), q), "q depends on l"),
    },
    "differentiation": {
        "under an integral that then diverges":
            (equal(Derivative(Integral(KERNEL, (y, 0, oo)), x), Integral(cos(x * y), (y, 0, oo))),
             "0 is not a divergent integral; at x = 0 there is no derivative"),
        "under an integral at one place":
            (equal(Derivative(Integral(FADING, (y, 0, 1)), x), Integral(sp.diff(FADING, x), (y, 0, 1))),
             "x = 0: 1 is not 0"),
        "term by term":
            (equal(Derivative(Sum(sin(k * x) / k, (k, 1, oo)), x), Sum(cos(k * x), (k, 1, oo))),
             "x = 1: -1/2 is not a divergent sum"),
        "absolute value": (equal(Derivative(Abs(x), x), sp.sign(x)), "none at x = 0"),
        "kink of the pressure":
            (equal(Derivative(sp.Piecewise((a - x, x < a), (0, True)), x),
             sp.Piecewise((-1, x < a), (0, True))),
             "none at x = a"),
        "logarithm under an integral":
            (equal(Derivative(Integral(log(x**2 + y**2), (y, 0, 1)), x),
             Integral(2 * x / (x**2 + y**2), (y, 0, 1))),
             "x = 0: pi on one side, -pi on the other, not 0"),
        "transform with a kink":
            (equal(Derivative(Integral(cos(x * y) / (1 + y**2), (y, 0, oo)), x),
             Integral(-y * sin(x * y) / (1 + y**2), (y, 0, oo))),
             "pi/2 e^(-|x|) has none at x = 0"),
        "twice under a kernel":
            (equal(Derivative(Integral(Abs(x - y), (y, 0, 1)), (x, 2)), 0), "x = 1/2: 2"),
        "step under an integral":
            (equal(Derivative(Integral(sp.Piecewise((1, x < y), (0, True)), (x, 0, 1)), y), 0),
             "y = 1/2: 1"),
    },
    "function given a value with a singularity": {
        "relaxation that is singular inside":
            (_for_every_function(v, f(1) - f(-1), integral(Derivative(f(x), x), (x, -1, 1), f(x)), 1 / x**2,
             x),
             "a divergent integral is not 0"),
        "logarithm between the ends":
            (_for_every_function(v, f(2) - f(-1), integral(Derivative(f(x), x), (x, -1, 2), f(x)),
             log(Abs(x)), x),
             "the integral of 1/x diverges"),
        "jump between the ends":
            (_for_every_function(v, f(1) - f(-1), integral(Derivative(f(x), x), (x, -1, 1), f(x)),
             atan(1 / x), x),
             "-pi/2 is not pi/2"),
        "product rule at a kink":
            (_for_every_function(Derivative(f(x) ** 2, x), 2 * f(x) * Derivative(f(x), x), None, Abs(x), x),
             "x = 0: 0 is not undefined"),
        "pole at an end":
            (_for_every_function(v, f(1) - f(0), integral(Derivative(f(x), x), (x, 0, 1), f(x)), 1 / x, x),
             "1/0"),
        "by parts across a pole":
            (_for_every_function(v, f(1) + f(-1),
             integral(f(x) + x * Derivative(f(x), x), (x, -1, 1), x * f(x)), 1 / x**2, x),
             "x f = 1/x jumps: -1/x^2 is negative, its integral not 2"),
    },
    "roots with a letter that may vanish": {
        "quadratic": (root(m * y**2 - b * y, y, b / m), "m = 0: none"),
        "all coefficients vanish": (root(m * y**2 - m * z**2, y, z), "m = 0: every y"),
        "damper that may be missing": (root(K * m**3 - R * m, m, sqrt(R / K)), "m = 0 as well"),
        "quartic with a root at zero": (root(m**4 - 8 * m, m, 2), "m = 0 as well"),
        "fractional power": (root(m ** sp.Rational(3, 2) - a * m, m, a**2), "m = 0 as well"),
    },
    "contradictory definitions": {
        "cosine beyond 1": (define(cos(x), 2), "cos x <= 1"),
        "part greater than the whole": (define(a + b, 1), define(a, 2), "b = -1"),
        "function against its value": (define(f(x), x**2), define(f(sp.S(2)), 5), "f(2) = 4"),
        "function against its slope": (define(Derivative(f(x), x), 1), define(f(x), x**2), "f' = 2 x"),
        "slope against three values":
            (define(Derivative(f(x), (x, 2)), 2), define(f(sp.S(0)), 0), define(f(sp.S(1)),
             0), define(f(sp.S(2)), 5),
             "f = x^2 - x, f(2) = 2"),
        "value of an integral": (define(Integral(x**2, (x, 0, 1)), 1), "1/3"),
        "value of a sum": (define(Sum(k, (k, 1, 3)), 7), "6"),
        "positive function at one place": (define(G(sp.S(0)), 0), "G > 0"),
        "square of an integer": (define(n**2, 2), "sqrt 2 is irrational"),
        "sum of squares": (define(x**2 + u**2 + 2, 2 * x), "(x - 1)^2 + u^2 = -1"),
        "larger of two": (define(sp.Max(x, u), 1), define(x, 2), "max >= x"),
        "conditions that exclude each other": (where(x > 1, x < 0), "empty"),
        "case that never is": (holds(-1, cases=(sp.Lt(x**2 + x + 1, 0),)), "x^2 + x + 1 > 0"),
        "share beyond 1": (define(l_r / (a + l_r), 2), "l_r = -2 a"),
        "sine and cosine": (define(sin(x), half), define(cos(x), half), "squares add up to 1/2"),
        "negative root": (define(sqrt(x), -1), "its real part is not negative"),
        "arm that never relaxes": (define(exp(-a / l_r), 1), "a = 0"),
        "quadratic without a root": (define(x**2 + x + 1, 0), "at least 3/4"),
        "three sums": (define(x + u, 1), define(u + v, 1), define(x - v, 1), "x = v"),
        "two laws of one function": (define(f(x), x), define(f(u), u**2), "f(2) is 2 and 4"),
        "slope and curvature":
            (define(Derivative(f(x), x), x), define(Derivative(f(x), (x, 2)), 3), "curvature 1"),
        "condition on a cosine": (where(cos(x) > 2), "empty"),
        "conditions on a product": (where(x * u > 1, x < 0, u > 0), "x u < 0"),
        "hypotenuse as long as a leg": (define(sqrt(a**2 + l_r**2), l_r), "a = 0"),
        "trailing edge beyond the contact": (define(sqrt(a**2 + l_r**2) - l_r, 2 * a), "it is below a"),
        "relaxation against its start": (define(G(x), exp(x)), define(G(sp.S(0)), 2), "G(0) = 1"),
    },
    "two letters printed alike": {
        "root with the same letter": (root(x - other_x**2, x, other_x**2), "prints x = x^2"),
        "functions of one letter":
            (define(sp.Function("f", positive=True)(x), f(x) + 1), "prints f(x) = f(x) + 1"),
        "names that print alike":
            (define(sp.Symbol("l_{r}", positive=True), l_r + 1), "prints l_r = l_r + 1"),
    },
    "book-keeping": {
        "uses itself": (_uses_itself, "a circle"),
        "uses what is not finished": (_uses_unfinished, "no such theorem yet"),
        "two that use one another": (_use_one_another, "a circle"),
        "one label, two theorems": (_one_label_two_theorems, "the second replaces the first"),
        "one label, two values": (_one_label_two_values, "a = 1 and a = 2"),
        "finished twice": (_done_twice, "two results of one label"),
        "recalls from itself": (lambda p: p.recall(p.label, (y, y)), "a circle"),
        "another symbol of the same name":
            (recalled(SHIFTED.subs(y, other_x), other_x + 1), equal(sqrt(x**2 + 2 * x + 1), x + 1), "x = -3"),
        "premise two back": (_through_two(define(y, 1), b * y, b, define(y, 2)), "y = 1 and y = 2"),
        "condition two back": (_through_two(where(x > 1), *CANCELLED, where(x < 0)), "x > 1 and x < 0"),
    },
    "branch cuts": {
        "logarithm of an exponential": (equal(log(exp(w)), w), "w = 2 i pi"),
        "product of roots": (equal(sqrt(x - 1) * sqrt(x + 1), sqrt(x**2 - 1)), "x = -2: two signs"),
        "double arc tangent": (equal(2 * atan(x), atan(2 * x / (1 - x**2))), "x = 2"),
    },
    "division by zero": {
        "edges that meet": (equal((a**2 - l_r**2) / (a - l_r), a + l_r), "undefined at l_r = a"),
        "sign as a quotient": (equal(x / Abs(x), sp.sign(x)), "undefined at x = 0"),
        "squares for their roots": (equivalent(x**2 - u**2, x, u), "x = -2, u = 1"),
        "inverses turned round": (equivalent(1 / u - 1 / x, x, u), "x = 1, u = -1"),
        "extraneous root": (root(sqrt(x + 6) - x, x, -2), "2 + 2 is not 0"),
    },
    "series and divergent integrals": {
        "principal value": (equal(Integral(1 / x, (x, -1, 1)), 0), "diverges"),
        "mean of an oscillation": (equal(Integral(sin(x), (x, 0, oo)), 1), "diverges"),
        "order of integration":
            (equal(Integral(FUBINI, (x, 0, 1), (u, 0, 1)), Integral(FUBINI, (u, 0, 1), (x, 0, 1))),
             "-pi/4 is not pi/4"),
        "tail not integrable": (integral(y ** (-b), (y, 1, oo), y ** (1 - b) / (1 - b)), "b < 1"),
        "oscillation with a primitive": (integral(cos(x), (x, 0, oo), sin(x)), "sin has no limit"),
        "faster oscillation":
            (integral(2 * x * cos(x**2), (x, 0, oo), sin(x**2)), "sin x^2 has no limit"),
    },
    "strict, or at one place": {
        "negative in a millionth":
            (sign((1 - q) ** 2 * (2 * q + 1) - sp.Rational(1, 10**12), ">", UNIT), "next to q = 1"),
        "letter inside the interval": (sign((x - y) ** 2, ">", (x, 0, 1)), "x = y = 1/2"),
        "equal letters": (holds(y**2 + z**2 - 2 * y * z), "y = z"),
        "exponential above its tangent": (holds(exp(x) - 1 - x), "x = 0"),
        "logarithm below its tangent": (holds(y - 1 - log(y)), "y = 1"),
        "mean that is strict": (holds((a + b) / 2 - sqrt(a * b)), "a = b"),
        "Hurwitz from positive coefficients": (holds(HURWITZ), "all 1: -1"),
        "no arms": (holds(Sum(G(k), (k, 1, n))), "n = 0"),
        "ends in the wrong order": (root(x - (a + b) / 2, x, (a + b) / 2, over=(x, a, b)), "a > b"),
    },
    "antiderivatives with a jump": {
        "half tangent over a turn":
            (integral(1 / (2 + cos(x)), (x, 0, 2 * pi), 2 / sqrt(3) * atan(sp.tan(x / 2) / sqrt(3))),
             "jumps at pi: 2 pi/sqrt 3, not 0"),
        "exponential of a pole": (integral(sp.diff(POLE, x), (x, -1, 1), POLE), "jumps at 0"),
        "logarithm of an absolute value": (integral(1 / x, (x, -1, 2), log(Abs(x))), "diverges"),
        "pole at a letter": (integral(1 / (x - y) ** 2, (x, 0, 1), -1 / (x - y)), "y = 1/2"),
        "angle of a turn": (integral(1, (x, 0, 2 * pi), sp.atan2(sin(x), cos(x))), "jumps at pi"),
    },
    "sums over arms": {
        "product of sums":
            (equal(Sum(G(k), (k, 1, n)) * Sum(f(k), (k, 1, n)), Sum(G(k) * f(k), (k, 1, n))), "n = 2"),
        "one arm too few": (equal(Sum(G(k), (k, 1, 4)), G(1) + G(2) + G(3)), "G(4) > 0"),
    },
    "floats and objects that are not numbers": {
        "float for a third": (equal(x * sp.Float(0.3333333333333333), x / 3), "16 digits"),
        "float as a root": (root(x**2 - 2, x, sp.Float(1.4142135623730951), over=(x, 0, oo)), "16 digits"),
        "float for pi in an integral":
            (integral(1 / (1 + x**2), (x, -oo, oo), atan(x), value=sp.Float(pi.n(15))), "15 digits"),
        "limit from both sides": (equal(sp.Limit(Abs(x) / x, x, 0, "+-"), 1), "there is none"),
    },
    "series at singular places": {
        "power of itself": (order(h**h, 1), "1 + h ln h"),
        "beyond all orders": (order(2 * sp.cosh(z), exp(z), z, oo, 1 / z), "1 + e^(-2 z)"),
        "springpot of any order": (order(h**nu + h, h**nu, h, 0, h ** (1 - nu)), "nu = 2: h leads"),
        "oscillation at infinity": (order(z + sin(z), z, z, oo, 1 / z), "sin z has no limit"),
        "function that may vanish": (order(f(h) + h, f(h)), "f = h: 2 h"),
    },
    "roots that are others": {
        "root outside of the unit interval": (root(q**2 - 4 * q + 1, q, 2 + sqrt(3), over=UNIT), "q > 1"),
        "one of infinitely many": (root(sin(x), x, 0), "pi"),
        "power against exponential": (root(y**2 - 2**y, y, 2), "4"),
        "square of a logarithm": (root(log(y) ** 2 - 1, y, sp.E), "1/e"),
        "real root of a complex letter": (root(w**3 - 1, w, 1), "two more"),
        "one root that touches": (unique(x**2 * (x - 1), (x, -1, 2)), "0 is a root as well"),
        "exponential with two roots": (root(exp(x) - 2 * x - 1, x, 0), "one more near 1.26"),
        "root against a condition": (where(x < 0), root(x - 2, x, 2), "2 is not below 0"),
    },
    "neighbours of what is true": {
        "logarithm of a square of a ratio": (equal(log(((1 + x) / (1 - x)) ** 2), 4 * sp.atanh(x)), "x = 2"),
        "twice too small": (where(q < 1), equal(log((1 + q) / (1 - q)), sp.atanh(q)), "q = 1/2"),
        "inverse of an even function": (equal(sp.acosh(sp.cosh(x)), x), "x = -1"),
        "other branch": (equal(sp.asinh(x), log(sqrt(x**2 + 1) - x)), "x = 1"),
        "arc tangents below a bound": (where(x < 1), equal(atan(1 / x) + atan(x), pi / 2), "x = -1"),
        "arc tangents below zero": (where(x < 0), equal(atan(1 / x) + atan(x), pi / 2), "x = -1"),
        "arc tangents on two intervals":
            (where(x**2 > 1), equal(atan(1 / x) + atan(x), pi / 2), "x = -2"),
        "another angle of reflection":
            (where(nu < 1), equal(sp.gamma(nu) * sp.gamma(1 - nu), pi / sin(2 * pi * nu)), "nu = 3/4"),
        "gamma at its pole": (equal(sp.gamma(x + 1), x * sp.gamma(x)), "x = 0"),
        "sine of two half turns": (where(nu < 1), holds(sin(2 * pi * nu)), "nu = 3/4"),
        "cosine beyond a right angle": (where(q < 1), holds(cos(2 * q)), "q = 0.9"),
        "sine of any angle": (holds(sin(y)), "y = 4"),
        "the smaller term leads":
            (where(nu < 1), order(h**nu + h, h, h, 0, h ** (1 - nu)), "h^nu leads"),
        "small quantity that is large":
            (where(nu < 1), order(h**nu + h, h**nu, h, 0, h ** (nu - 1)), "it grows"),
        "springpot at infinity":
            (where(nu < 1), order(h**nu + h, h**nu, h, oo, h ** (1 - nu)), "h leads"),
        "exponential that grows": (order(sp.coth(z), 1, z, oo, exp(2 * z)), "not small"),
        "exponential at the wrong end": (order(sp.coth(z), 1, z, 0, exp(-2 * z)), "1/z"),
        "power beside an exponential": (order(sp.coth(z) + 1 / z, 1, z, oo, exp(-2 * z)), "1/z leads"),
        "half tangent beyond a half turn":
            (integral(1 / (2 + cos(x)), (x, 0, 3 * pi / 2), 2 / sqrt(3) * atan(sp.tan(x / 2) / sqrt(3))),
             "jumps at pi"),
        "half tangent up to its pole":
            (integral(1 / (1 + cos(x)), (x, 0, pi), sp.tan(x / 2)), "diverges"),
        "half angle of the other sign": (equal(sin(x) / (1 - cos(x)), sp.tan(x / 2)), "x = 1"),
        "half angle undefined on one side": (equal((1 - cos(x)) / sin(x), sp.tan(x / 2)), "x = 0"),
        "double angle over a zero": (equal(sin(2 * x) / cos(x), 2 * sin(x)), "x = pi/2"),
        "one of three zeros": (root(sin(x), x, pi, over=(x, 0, 4 * pi)), "2 pi"),
        "one of two zeros of a cosine": (root(cos(x), x, pi / 2, over=(x, 0, 2 * pi)), "3 pi/2"),
        "a zero of another factor": (root(sin(x) * (x - 1), x, pi, over=(x, 0, 2 * pi)), "1"),
        "zero at an end that counts not": (root(sin(x), x, pi, over=(x, 0, pi)), "pi is outside"),
        "distance with two roots": (root(Abs(y - 1) - half, y, 3 * half), "1/2"),
        "distance of a real number": (root(Abs(x - 1) - 1, x, 2), "0"),
        "distances with many roots": (root(Abs(y - 1) + Abs(y - 2) - 1, y, 1), "all up to 2"),
        "real part alone": (equal(sp.re(w) ** 2, Abs(w) ** 2), "w = i"),
        "square of a complex number": (equal(sp.re(w) ** 2 + sp.im(w) ** 2, w**2), "w = i"),
        "law for positive numbers": (define(f(y), y**2), equal(f(u), u**2), "nothing is said for u < 0"),
        "law for whole numbers": (define(f(n), n**2), equal(f(x), x**2), "nothing is said for x = 1/2"),
        "law under a condition": (where(x > 2), define(f(x), x**2), equal(f(u), u**2), "u = 0"),
        "law at one place": (define(x, 2), define(f(x), x**2), equal(f(u), u**2), "f(2) = 4 only"),
        "law under an integral":
            (define(f(y), y), where(u > 0), equal(Integral(f(u), (u, -1, 1)), Integral(u, (u, -1, 1))),
             "nothing is said below 0"),
        "letter of a law": (define(f(x), a * x), equal(f(a), a * x), "a^2"),
        "arc tangent below its argument": (holds(atan(1 / l) - 1 / l), "l = 1"),
        "arc tangent and a constant":
            (holds(-3 * l**3 * atan(1 / l) + 3 * l**2 - 3 * l * atan(1 / l) + 2 - third), "tends to -1/3"),
        "arc tangent of a ratio": (holds(atan(a / b) - a / b), "a = b"),
        "smaller of two": (holds(sp.Min(x, 1)), "x = -1"),
        "larger of two": (holds(sp.Max(x, u)), "both -1"),
        "a coefficient that changes its sign":
            (holds(a**2 * (exp(z) - 1 - z) + a * (exp(z) - 2 - z)), "z = 1/10, a small"),
        "share of a power": (where(q < 1), holds(nu - 2 * q * q**nu), "nu small"),
        "power of unknown sign": (where(q < 1), holds(1 - q * q**x), "x = -5"),
        "negative power": (where(q < 1), holds(1 - q ** (-nu)), "q^-nu > 1"),
        "power of a real number": (where(x < 1), holds(1 - x**2), "x = -3"),
    },
    "not in the language": {
        "logarithm of a ratio, which is true":
            (where(q < 1), equal(log((1 + q) / (1 - q)), 2 * sp.atanh(q)), "q < 1"),
        "gamma of the next order, which is true": (equal(sp.gamma(nu + 1), nu * sp.gamma(nu)), "springpot"),
        "reflection of gamma, which is true":
            (where(nu < 1), equal(sp.gamma(nu) * sp.gamma(1 - nu), pi / sin(pi * nu)), "springpot"),
        "hyperbolic cosine from 1, which is true": (holds(sp.cosh(x) - 1, ">="), "not strict"),
        "limit, which is true": (equal(sp.Limit(sin(x) / x, x, 0), 1), "known"),
        "limit from both sides, which is true":
            (equal(sp.Limit((1 - cos(x)) / x**2, x, 0, "+-"), half), "even"),
        "limit at infinity, which is true":
            (equal(sp.Limit(sqrt(y**2 + a**2) / y, y, oo), 1), "the root is a series in 1/y"),
        "limit at a letter, which is true":
            (equal(sp.Limit((u**2 - x**2) / (u - x), u, x, "+-"), 2 * x), "slope of a square"),
        "order at infinity, which is true": (order(sp.coth(z), 1, z, oo, exp(-2 * z)), "exponentially small"),
        "real and imaginary part, which is true":
            (equal(sp.re(w) ** 2 + sp.im(w) ** 2, Abs(w) ** 2), "complex rates"),
        "angle of a point": (equal(Derivative(sp.atan2(sin(x), cos(x)), x), 1), "a cut"),
        "arc cotangent": (equal(Derivative(sp.acot(x), x), -1 / (1 + x**2)), "a cut at 0"),
        "arc secant": (equal(sp.asec(y), sp.acos(1 / y)), "y < 1"),
        "branches of Lambert": (equal(sp.LambertW(x * exp(x)), x), "x < -1"),
        "factorial": (equal(sp.factorial(n), n * sp.factorial(n - 1)), "n = 0"),
        "binomial": (equal(sp.binomial(n, k), sp.binomial(n, n - k)), "n < 0"),
        "sine integral": (equal(Derivative(sp.Si(x), x), sin(x) / x), "x = 0"),
        "Bessel function": (order(h + h * sp.besselk(1, h), 1), "the rest is h^2 log h"),
        "steps": (equal(Derivative(sp.floor(x), x), 0), "x = 1"),
        "remainder": (equal(sp.Mod(n, 2) * (sp.Mod(n, 2) - 1), 0), "true, of integers"),
        "dummy beside a letter": (equal(DUMMY * x, x**2), "two letters x"),
        "name that is a dummy": (define(DUMMY, x), "x = x"),
        "letters that do not commute": (equal(TURN * x, x * TURN), "no number"),
    },
    "beside what fades": {
        "quotient that does not fade": (order(1 + h + exp(-1 / h) / (exp(-1 / h) + exp(-2 / h)), 1), "2 + h"),
        "logarithm beside what grows": (order(1 + h + log(1 + exp(-1 / h)) * exp(1 / h), 1), "2 + h"),
        "power of a sum": (order(1 + h + exp(-1 / h) * (1 + h) ** (1 / h**2), 1), "1 + e^(-1/2)"),
        "power of two at infinity": (order(2 + 1 / z + 2**z * exp(-z / 2), 2, z, oo, 1 / z), "(4/e)^(z/2)"),
        "hyperbolic sine": (order(1 + h + exp(-1 / h) * sp.sinh(1 / h), 1), "3/2 + h"),
        "faster than it fades": (order(1 + h + exp(-1 / h) * sp.sinh(2 / h), 1), "without bound"),
        "power with a pole": (order(1 + h + exp(-1 / h) * h ** (-1 / h), 1), "without bound"),
        "power of three": (order(1 + 1 / z + 3**z * exp(-z), 1, z, oo, 1 / z), "(3/e)^z"),
        "exponential of an exponential": (order(1 + h + exp(-1 / h) * exp(exp(1 / h)), 1), "without bound"),
        "less one": (order(1 + h + exp(-1 / h) * expm1(1 / h), 1), "2 + h"),
        "unknown function": (order(1 + h + exp(-1 / h) * f(1 / h), 1), "f = exp"),
        "poles of a tangent": (order(1 + h + exp(-1 / h) * sp.tan(1 / h), 1), "poles at 1/h = pi/2, 3 pi/2"),
    },
    "not uniform in a parameter": {
        "hypotenuse": (order(sqrt(m**2 + h**2) + h**2, m), "m = 0: h"),
        "angle of a ratio": (order(1 + h + h * atan(m / h), 1), "m = 0: 1 + h, else more"),
        "decay at a rate": (order(1 + h + h * exp(-m / h), 1), "m = 0: 1 + 2 h"),
        "under a root": (order(1 + h + h**2 / sqrt((a - b) ** 2 + h**2), 1), "a = b: 1 + 2 h"),
    },
    "a parameter that may vanish": {
        "rate of a power":
            (define(b, a), integral(y ** (a - b - 1), (y, 1, 2), y ** (a - b) / (a - b)), "log 2"),
        "slope that may vanish": (root(f(a) * x - f(a), x, 1), "f = 0: every x"),
        "both coefficients": (define(b, a), root((a - b) * x + a - b, x, -1), "a = b: every x"),
        "coefficient of all": (root((a - b) * x - (a - b), x, 1), "a = b: every x"),
        "pole by a premise": (define(b, a), root((x - a) / (x - b), x, a), "no root: it is 1"),
        "peak without width": (define(b, a), order(1 + h + h**2 / ((a - b) ** 2 + h**2), 1), "2 + h"),
        "rate by a premise":
            (define(b, a), integral(exp((a - b) * x), (x, 0, 1), exp((a - b) * x) / (a - b)), "1"),
        "a function that may vanish":
            (integral(exp(f(a) * x), (x, 0, 1), exp(f(a) * x) / f(a)), "f = 0: 1"),
        "used where it does not hold": (_at_its_pole, "a = b: 1"),
    },
    "integrals that do not exist": {
        "difference of logarithms":
            (equal(Integral(1 / x - (1 - x) / x, (x, 0, 1)),
             Integral(1 / x, (x, 0, 1)) - Integral((1 - x) / x, (x, 0, 1))),
             "both diverge"),
        "growing exponential": (integral(exp(y), (y, 0, oo), exp(y)), "diverges"),
        "growing power": (integral(x**2, (x, -oo, 0), x**3 / 3), "diverges"),
        "mean over all": (integral(sp.S.One, (x, -oo, oo), x), "diverges"),
        "difference of two that diverge":
            (equal(Integral((cos(y) - 1) / y, (y, 0, 1)), Integral(cos(y) / y, (y, 0, 1)) - Integral(1 / y,
             (y, 0, 1))),
             "both diverge"),
        "to infinity":
            (equal(Integral(1 / y - 1 / (1 + y), (y, 1, oo)),
             Integral(1 / y, (y, 1, oo)) - Integral(1 / (1 + y), (y, 1, oo))), "both diverge"),
        "powers":
            (equal(Integral((1 - y) / y**2, (y, 0, 1)), Integral(1 / y**2, (y, 0, 1)) - Integral(1 / y, (y,
             0, 1))),
             "both diverge"),
        "sign of a pole at the end": (holds(Integral(1 / y, (y, 0, 1)), ">="), "diverges"),
        "sign of a pole inside": (holds(Integral(1 / (x - half) ** 2, (x, 0, 1)), ">="), "diverges"),
        "sign to infinity": (holds(Integral(y, (y, 0, oo)), ">="), "diverges"),
    },
    "tiny differences": {
        "pole beyond an end": (sign(1 / (1 - x), ">", (x, 0, 1 + sp.Rational(1, 10**80))), "by 10^-80"),
        "root beyond an end": (unique(x - 1, (x, 0, 1 - sp.Rational(1, 10**80))), "by 10^-80"),
        "value of a name": (define(a**2, 2), define(a, sqrt(2) - sp.Rational(1, 10**80)), "below 2"),
        "end beyond a root": (sign(2 - x**2, ">", (x, 0, sqrt(2) + sp.Rational(1, 10**70))), "by 10^-70"),
        "end farther beyond": (sign(3 - x**2, ">=", (x, 0, sqrt(3) + sp.Rational(1, 10**100))), "by 10^-100"),
        "logarithm and exponential":
            (define(exp(x), 2), define(x, log(2) + sp.Rational(1, 10**40)), "e^x is more than 2"),
        "square and root":
            (define(x**2, 2), define(x, sqrt(2) + sp.Rational(1, 10**45)), "x^2 is more than 2"),
        "sine and angle": (define(sin(x), half), define(x, pi / 6 + sp.Rational(1, 10**60)), "more than 1/2"),
    },
    "premises and conditions that exclude each other": {
        "slope against a law": (define(f(x), x), define(Derivative(f(u), u), 2), "f' = 1"),
        "two values of a function": (define(f(sp.S(1)), 2), define(f(x), x**2), "f(1) = 1"),
        "square below 1": (where(x**2 < 1, x > 1), "no x is both"),
        "larger of two below one": (define(sp.Max(a, b), 1), where(a > 2), "max >= a"),
        "case below a bound": (where(x > 2), holds(x**2, cases=(sp.Lt(x, half),)), "no x is both"),
        "case above a bound": (where(y < 1), holds(y, cases=(sp.Gt(y, 2),)), "no y is both"),
        "case at a place": (where(x > 2), equal(x * x, 1, cases=(sp.Eq(x, 1),)), "x = 1 is below 2"),
        "root beyond a condition":
            (where(x < 0), recalled(x, 2, by=root(x - 2, x, 2, over=(x, 0, oo))), "x = 2"),
        "condition beyond a root":
            (recalled(x, 2, by=root(x - 2, x, 2, over=(x, 1, oo))), where(x < 0), "x = 2"),
        "integral of a square": (define(Integral(f(x) ** 2, (x, 0, 1)), -1), "f^2 >= 0"),
        "integral of what is positive": (define(Integral(G(x), (x, 0, 1)), 0), "G > 0"),
        "moment of what is positive": (define(Integral(G(x) * x**2, (x, 0, 1)), -2), "G > 0"),
        "integral of an exponential": (define(Integral(exp(f(x)), (x, 0, 1)), 0), "e^f > 0"),
    },
    "a letter declared twice": {
        "bound in an integral": (equal(Integral(other_x, (other_x, 0, 1)) + x, x + half), "two letters x"),
        "place of a recalled result":
            (equal(x + 1, 1 + x), recalled(SHIFTED, y + 1, at={y: other_x}), "two letters x"),
        "variable of a root": (where(x > 1), root(other_x - 2, other_x, 2), "two letters x"),
        "in a condition": (where(other_x > 2), holds(x), "x is another letter"),
        "in a case": (equal(x * (x - 1), 0, cases=(sp.Eq(other_x, 0), sp.Eq(other_x, 1))), "another letter"),
        "after an equation": (equal((x + 1) ** 2, x**2 + 2 * x + 1), where(other_x > 2), "another letter"),
    },
    "definitions that hide an assumption": {
        "not zero": (define(NONZERO, x), equal(x / NONZERO, 1), "x = 0"),
        "not zero, a difference": (define(NONZERO, a - b), holds(NONZERO**2), "a = b"),
        "not zero, but it may be": (define(NONZERO, m), "m = 0"),
        "not positive, a sum": (define(FALLEN, a + 1), "a + 1 > 0"),
        "not positive, a number": (define(FALLEN, 3), "3 > 0"),
        "not positive, an exponential": (define(FALLEN, exp(r)), "e^r > 0"),
    },
}  # fmt: skip

TRUE = {
    "what may be zero": {
        "parameter that cannot vanish": order(sp.sqrt(a**2 + h), a),
        "sum of what may be zero and what not": holds(m**2 + a),
        "order of a sum that may begin later": lambda p: p.leading_order(
            (a - 1) * h + h**2, (a - 1) * h, h, 0, "a remainder of its own", eps=h, short=True
        ),
        "name that may be zero": lambda p: p.define(m, x**2),
        "smooth function by parts": integral(
            x * sp.Derivative(f(x), (x, 2)), (x, 0, y), x * sp.Derivative(f(x), x) - f(x)
        ),
    },
    "orders": {
        "what is smaller than any power": order(1 + h + sp.exp(-1 / h), 1),
        "Taylor of an exponential": order(sp.exp(h) - 1, h),
        "pole": order(1 / (1 - sp.exp(-h)), 1 / h),
        "at infinity": order(sp.sqrt(1 + h**2) - h, 1 / (2 * h), h, sp.oo, 1 / h),
        "at a point": order((1 - h**3) / 3, 1 - h, h, 1, 1 - h),
        "in another small quantity": order(h + h**3, h, h, 0, 4 * h**2),
        "with a parameter": order(h / (a + h), h / a),
    },
    "roots": {
        "friction maximum": root(parabola, h, 2 - sp.sqrt(3), over=(h, 0, 1)),
        "quadratic with a symbol": root(x**2 + 2 * y * x - 1, x, sp.sqrt(1 + y**2) - y, over=(x, 0, sp.oo)),
        "positive root of a positive symbol": root(a**2 - 4, a, 2),
        "cubic with one positive root": root(a**3 - b, a, sp.cbrt(b)),
        "fractional powers with one root": root(h ** sp.Rational(3, 2) - b, h, b ** sp.Rational(2, 3)),
        "named": root(x**2 - b, x, sp.sqrt(b), over=(x, 0, sp.oo), name=a),
        "between symbolic ends": root((x - a) * (x + a), x, a, over=(x, 0, 3 * a)),
        "double root as a root": root((x - 1) ** 2, x, 1),
        "with a condition": steps(where(sp.Gt(u, 0)), root(x**2 - u, x, sp.sqrt(u), over=(x, 0, sp.oo))),
        "in an exponential": root(x * sp.exp(y) - z, x, z * sp.exp(-y)),
        "unique root": unique(x**2 - 2, (x, 0, 2)),
        "unique root without ends": unique(x**3 + x - 1, (x, -sp.oo, sp.oo)),
        "ends do not count": unique(x * (2 * x - 1) * (x - 1), (x, 0, 1)),
        "triple root changes the sign": unique((x - 1) ** 3, (x, 0, 2)),
    },
    "premises": {
        "definitions in a row": _defined((z, y**2), (a, z + 1)),
        "two laws": _defined((x**2, sp.S.One), (x**3, sp.S.One)),
        "square": steps(define(z, y**2), equal(sp.sqrt(z), y)),
        "derivative of what is named": steps(
            define(r, sp.sqrt(s**2 + lam**2)), equal(sp.Derivative(r * s, s), (2 * s**2 + lam**2) / r)),
        "derivative of what is named, two deep": steps(
            _defined((a, r * s), (r, s**2)), equal(sp.Derivative(a, s), 3 * s**2)),
        "value of a function": steps(define(f(x), x**2), equal(sp.Derivative(f(x), x), 2 * x)),
        "domain of a name": steps(define(a, 1 - h), sign(2 - a, ">", (h, 0, 1))),
        "condition": lambda p: p.where(a < b),
        "a value for the variable of an integral and of a derivative": _defined(
            (f(y), sp.Integral(x * sp.Derivative(f(u), u), (x, 0, z))), (x, z**2), (u, z + 1)
        ),
    },
    "identities": {
        "binomial": equal((x + y) ** 2, x**2 + 2 * x * y + y**2),
        "rationalised": equal(1 / (sp.sqrt(1 + y) + sp.sqrt(y)), sp.sqrt(1 + y) - sp.sqrt(y)),
        "root of a square, positive": equal(sp.sqrt(y**2), y),
        "root of a square, real": equal(sp.sqrt(x**2), sp.Abs(x)),
        "root of a quotient": equal(sp.sqrt(1 + (1 - y**2) ** 2 / (4 * y**2)), (1 + y**2) / (2 * y)),
        "root of a product": equal(sp.sqrt(y * z), sp.sqrt(y) * sp.sqrt(z)),
        "Pythagoras": equal(sp.sin(x) ** 2 + sp.cos(x) ** 2, 1),
        "larger and smaller": equal(sp.Max(x, u) + sp.Min(x, u), x + u),
        "logarithm of a product of positives": equal(sp.log(y * z), sp.log(y) + sp.log(z)),
        "cancelled where it may be": steps(where(x > 1), equal((x**2 - 1) / (x - 1), x + 1)),
        "tangent where it may be": steps(where(sp.cos(x) > 0), equal(sp.tan(x) * sp.cos(x), sp.sin(x))),
        "derivative": equal(sp.Derivative(sp.exp(-x / y), x), -sp.exp(-x / y) / y),
        "value at a place": equal(sp.Subs(x**2 + x, x, y), y**2 + y),
        "in each of two cases": lambda p: p.equal(
            x * (x - 1), sp.S.Zero, "at both", cases=(sp.Eq(x, 0), sp.Eq(x, 1))
        ),
    },
    "signs": {
        "parabola": sign(x * (1 - x), ">", (x, 0, 1)),
        "square with a touch": sign((2 * x - 1) ** 2, ">=", (x, 0, 1)),
        "bound": sign(x * (1 - x), "<=", (x, 0, 1), sp.Rational(1, 4)),
        "with a positive factor": sign(y * (x + 1), ">", (x, 0, 1)),
        "derivative of known sign": sign(sp.Derivative(x**3 + x, x), ">", (x, -sp.oo, sp.oo)),
        "inequality": holds(y**2 + y * z),
        "inequality with a condition": steps(where(sp.Lt(y, z)), holds(z**2 - y**2)),
        "inequality of exponentials": steps(where(sp.Lt(x, u)), holds(sp.exp(u) - sp.exp(x))),
        "integral of what is not negative": holds(sp.Integral(x**2, (x, 0, y)), ">="),
        "greatest value": lambda p: p.greatest(
            sp.S.One, 1 - x**2, (x, sp.S.Zero), "reached at 0", surplus=x**2
        ),
        "equivalent": lambda p: p.equivalent(y * (x - z), x, z, "y > 0"),
    },
    "integrals": {
        "power": integral(3 * x**2, (x, 0, y), x**3),
        "to infinity": integral(sp.exp(-x / y), (x, 0, sp.oo), -y * sp.exp(-x / y)),
        "arc tangent": integral(1 / (1 + x**2), (x, -1, 1), sp.atan(x)),
        "arc sine": integral(1 / sp.sqrt(1 - x**2), (x, 0, half), sp.asin(x)),
        "root at its end": integral(1 / (2 * sp.sqrt(x)), (x, 0, 1), sp.sqrt(x)),
        "function that is not known": integral(sp.Derivative(f(x), x), (x, 0, y), f(x)),
    },
    "bounds and angles": {
    },
    "steady sliding": {
        "trailing edge":
            (root(x**2 + 2 * l_r * x - a**2, x, sqrt(a**2 + l_r**2) - l_r, over=(x, -a, oo)),
             "where the pressure vanishes"),
        "hypotenuse in q":
            (define(l, (1 - q**2) / (2 * q)), equal(sqrt(1 + l**2), (1 + q**2) / (2 * q)), "rational"),
        "half length from the trailing edge":
            (define(l_r, a * (1 - q) / q), equal(l_r / (a + l_r), 1 - q), "a share between 0 and 1"),
        "root of a square": (where(q < 1), equal(sqrt(1 - 2 * q + q**2), 1 - q), "q < 1"),
        "quotient of roots":
            (where(q < 1), equal(sqrt((1 - q) / (1 + q)), (1 - q) / sqrt(1 - q**2)), "q < 1"),
        "factor of the friction force": (sign((1 - q) * (q**2 - q + 4), ">", UNIT), "friction is positive"),
        "edge from inside":
            (where(q < 1), order(Abs(1 - q) * (1 + q), 2 * (1 - q), q, 1, 1 - q),
             "one side only, as the condition says"),
        "slow where slow": (where(l_r < a), order(a / (a + l_r), 1, l_r, 0, l_r / a), "l_r may tend to 0"),
        "peak inside the contact":
            (greatest(1 + l**2, PROFILE, x, -l, (x + l) ** 2, given=(x > -1, l < 1)), "-1 < -l"),
        "peak at a letter": (greatest(a**2, 2 * a * x - x**2, x, a, (x - a) ** 2), "a constant place"),
        "larger of two, in order": (where(a < b), equal(sp.Max(a, b), b), "as the condition says"),
        "factor that the condition makes positive":
            (where(x > 0), equivalent(x * (u - v), u, v), "x > 0"),
    },
    "relaxation": {
        "moment of an arm":
            (integral(x * exp(-z * x), (x, 0, 1), -x * exp(-z * x) / z - exp(-z * x) / z**2,
             value=(1 - (1 + z) * exp(-z)) / z**2),
             "by parts"),
        "moment of a springpot":
            (integral(y ** (nu - 1) * (1 - y), (y, 0, 1), y**nu / nu - y ** (nu + 1) / (nu + 1),
             value=1 / (nu * (nu + 1))),
             "singular, but integrable"),
        "positive moment":
            (holds(Integral(exp(-z * y) * (1 - y), (y, 0, 1)), ">="),
             "a weight that is positive in the contact"),
        "three arms": (equal(Sum(G(k), (k, 1, 3)), G(1) + G(2) + G(3)), "a finite sum"),
        "exponential above its tangent": (holds(exp(a) - 1 - a), "a > 0"),
    },
    "calculus and algebra": {
        "root of a sum": (holds(sqrt(a) + sqrt(b) - sqrt(a + b)), "concave"),
        "derivative with respect to an end":
            (equal(Derivative(Integral(exp(-(u**2)), (u, 0, x)), x), exp(-(x**2))), "fundamental theorem"),
        "inverse of the hyperbolic sine": (equal(sp.asinh(x), log(x + sqrt(x**2 + 1))), "one branch"),
        "larger less smaller": (equal(sp.Max(x, u) - sp.Min(x, u), Abs(x - u)), "distance"),
        "order of a hypotenuse": (order(sqrt(a**2 + h**2), a, h, 0, h**2 / a**2), "analytic"),
        "between ends in order":
            (where(a < b), root(x - (a + b) / 2, x, (a + b) / 2, over=(x, a, b)), "midpoint"),
    },
    "what a chapter may need": {
        "rate that a condition keeps from zero":
            (where(a < b), integral(exp((a - b) * x), (x, 0, 1), exp((a - b) * x) / (a - b)), "a < b"),
        "name that is positive in a form that was shown":
            (equal(a**2 - a * b + b**2, (a - b) ** 2 + a * b), define(z, a**2 - a * b + b**2), "no minus"),
        "constant beside an unknown function":
            (equal(Integral(1 + f(x), (x, 0, 1)), 1 + Integral(f(x), (x, 0, 1))), "linear"),
        "sum under an integral":
            (equal(Integral(x + 2 * f(x), (x, 0, y)), y**2 / 2 + 2 * Integral(f(x), (x, 0, y))), "linear"),
        "crossing at a flat point": (lambda p: p.crossing(x**3, (x, -1, 1), "it rises"), "slope 3 x^2"),
        "crossing at a flatter point":
            (lambda p: p.crossing((x - 1) ** 5, (x, 0, 3), "it rises"), "5 (x - 1)^4"),
        "large cube": (define(x**3, 10**15), "x = 10^5"),
        "large square": (define(a**2, 10**18), "a = 10^9"),
        "width that cannot vanish":
            (where(a > b), order(1 + h + h**2 / ((a - b) ** 2 + h**2), 1), "as the condition says"),
        "rate that cannot vanish":
            (where(a > b), integral(exp((a - b) * x), (x, 0, 1), exp((a - b) * x) / (a - b)), "a > b"),
        "cases within a condition": (where(x > 2), holds(x**2, cases=(sp.Gt(x, 3), sp.Lt(x, 4))), "both are"),
        "hyperbolic sine that is small": (order(1 + h + exp(-1 / h) * sp.sinh(h), 1), "it does not grow"),
        "exponentials of one":
            (order(h / (1 - exp(-2 / h)) + h**2 * (1 + exp(-1 / h)), h), "powers of e^(-1/h)"),
        "not zero under a condition": (where(x > 0), define(NONZERO, x), equal(x / NONZERO, 1), "x > 0"),
        "not positive": (define(FALLEN, -exp(r)), "-e^r < 0"),
    },
    "premises and places": {
        "letters exchanged at once":
            (define(z, (b + 2 * a) ** 2),
             recalled((a + 2 * b) ** 2, a**2 + 4 * a * b + 4 * b**2, at={a: b, b: a}),
             equal(z, b**2 + 4 * b * a + 4 * a**2), "simultaneous"),
        "quarter of a turn to infinity":
            (integral(1 / (1 + y**2), (y, 0, oo), atan(y), value=pi / 2), "atan -> pi/2"),
        "moment to infinity":
            (integral(y**2 * exp(-y), (y, 0, oo), -(y**2 + 2 * y + 2) * exp(-y), value=2), "by parts"),
        "from minus infinity": (integral(exp(x), (x, -oo, 0), exp(x), value=1), "e^x -> 0"),
        "power and exponential to infinity":
            (integral(y * exp(-a * y), (y, 0, oo), -(y / a + 1 / a**2) * exp(-a * y), value=1 / a**2),
             "by parts"),
        "tail of a rational function": (integral(1 / y**2, (y, 1, oo), -1 / y, value=1), "1/y -> 0"),
        "three times an angle": (equal(sin(3 * x), 3 * sin(x) - 4 * sin(x) ** 3), "trisection"),
        "power as an exponential": (equal(exp(nu * log(y)), y**nu), "y > 0"),
        "smaller of two, in order": (where(a < b), equal(sp.Min(a, b), a), "as the condition says"),
        "sum of angles, expanded": (equal(sin(x + u), sin(x) * cos(u) + cos(x) * sin(u)), "a rule"),
        "recalled at a place of its domain":
            (recalled(SHIFTED, y + 1, at={y: z**2 + 1}), equal(sqrt(z**4 + 4 * z**2 + 4), z**2 + 2),
             "positive"),
        "recalled under a stronger condition":
            (where(x > 2), recalled(*CANCELLED, given=[where(x > 1)]), equal(CANCELLED[0] + 1, x + 2),
             "x > 2"),
        "function of another letter": (define(f(x), x**2), equal(f(u), u**2), "a law for every x"),
        "function with a value": (define(f(x), exp(x)), equal(f(sp.S(0)), 1), "consistent"),
    },
}  # fmt: skip


BEYOND = {
    "true, but no record needs a rule for it": {
        "unique root from an irrational end": unique(x**2 - 4, (x, sp.sqrt(2), sp.oo)),
        "logarithm of a series": order(sp.log(1 + h), h),
        "unique root to an irrational end": unique(x**2 - 2, (x, 0, sp.sqrt(3))),
        "irrational ends do not count": unique((x**2 - 2) * (x - 2), (x, sp.sqrt(2), 3)),
        "to an irrational end": sign(2 - x**2, ">", (x, 0, sp.sqrt(2))),
        "means": (holds((a + b) / 2 - sqrt(a * b), ">="), "bound of a pair of edges"),
        "logarithm below its argument": (holds(a - log(1 + a)), "relaxed share of an arm"),
        "below a right angle": (holds(pi / 2 - atan(a)), "arctan < pi/2"),
        "half angle": (equal(sin(x) / (1 + cos(x)), sp.tan(x / 2)), "both undefined at pi"),
        "end just before a root":
            (sign(2 - x**2, ">", (x, 0, sqrt(2) - sp.Rational(1, 10**70))), "by 10^-70"),
        "two less a sine": (holds(2 - sin(x)), "a denominator"),
        "springpot and spring":
            (where(nu < 1), order(h**nu + h, h**nu, h, 0, h ** (1 - nu)), "its dashpot is small"),
        "half an arm": (root(exp(-x / y) - half, x, y * log(2)), "half-life"),
        "time of an e-fold": (root(log(y / z) - 1, y, sp.E * z), "by the logarithm"),
        "sine below its argument": (holds(y - sin(y)), "y > 0"),
        "sine to 1": (holds(1 - sin(x), ">="), "not strict"),
        "quadratic form": (holds(x**2 + x * u + u**2, ">="), "definite"),
        "cosine below 2, integrated":
            (integral(1 / (2 + cos(x)), (x, 0, pi / 2), 2 / sqrt(3) * atan(sp.tan(x / 2) / sqrt(3))),
             "no jump up to pi/2"),
        "half turn": (root(sin(x), x, pi, over=(x, 0, 2 * pi)), "open interval"),
        "root of a logarithm": (root(y * log(y), y, 1), "y > 0"),
        "arc tangents of inverses": (equal(atan(1 / q) + atan(q), pi / 2), "angle of a strip"),
        "derivative of x |x|": (equal(Derivative(x * Abs(x), x), 2 * Abs(x)), "smooth enough at 0"),
        "sum of angles": (equal(atan(half) + atan(third), pi / 4), "numbers"),
        "distance with one positive root": (root(Abs(y - 1) - 1, y, 2), "0 is excluded"),
    },
}  # fmt: skip
"""True steps that the kernel refuses: a chapter that needs one must prove more on the way."""


class OverTimeError(BaseException):
    """Not an Exception, so that no library swallows it."""


def _expire(*_):
    raise OverTimeError


def verdict(step, seconds=20):
    """Return what the engine does with a step: accepted, refused, crashed or timeout; and its words.

    Where it has printed what must not vanish, "where" and that.
    """
    proof = _proof()
    before = signal.signal(signal.SIGPROF, _expire)
    signal.setitimer(signal.ITIMER_PROF, seconds)  # of processor time, whatever else is running
    try:
        step(proof)
    except OverTimeError:
        return "timeout", f"longer than {seconds} s of processor time"
    except StepError as error:
        return "refused", str(error)
    except Exception as error:
        return "crashed", f"{type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
    excluded = [each for each in proof._domain if r"\neq" in each]
    return f"where {', '.join(excluded)}" if excluded else "accepted", ""


CONDITIONED = {
    "where a parameter does not vanish": {
        "leading term": (order((a - 1) * h + h**2, (a - 1) * h), r"a \neq 1"),
        "leading term of unknown sign": (order(x * h + h**2, x * h), r"x \neq 0"),
        "crossover": (order(1 / (m + h), 1 / m), r"m \neq 0"),
        "width of a peak": (order(1 + h + h**2 / ((a - b) ** 2 + h**2), 1), r"a \neq b"),
        "letter that may be zero": (order(1 + h + h**2 / (m + h), 1), r"m \neq 0"),
        "numerator that may vanish": (order((1 + h) * (a - b) / (a - b + h**2), 1), r"a \neq b"),
        "difference of lengths": (order(1 + h + h**2 / (a - b + h), 1), r"a \neq b"),
        "rate": (integral(exp((a - b) * x), (x, 0, 1), exp((a - b) * x) / (a - b)), r"a \neq b"),
        "frequency": (integral(sin((a - b) * x), (x, 0, pi), -cos((a - b) * x) / (a - b)), r"a \neq b"),
        "exponent": (integral(y ** (x - 1), (y, 1, 2), y**x / x), r"x \neq 0"),
        "root beside a pole": (root((x - a) / (x - b), x, a), r"a \neq b"),
        "denominator without the variable": (root(x / (a - b) - 1 / (a - b), x, 1), r"a \neq b"),
    },
}  # fmt: skip
"""Steps that are true where a parameter does not vanish: the condition is printed, last in its row."""


def rows():
    """Yield kind, name, expected verdict, step, and why."""
    for kind, group in CONDITIONED.items():
        for name, (step, condition) in group.items():
            yield kind, name, f"where {condition}", step, "the condition is missing"
    for table, expected in ((FALSE, "refused"), (BEYOND, "refused"), (TRUE, "accepted")):
        for kind, group in table.items():
            for name, row in group.items():
                *parts, why = row if isinstance(row, tuple) else (row, name)
                yield kind, name, expected, steps(*parts), why


def derive(module, prove, **given):
    """Derive the record that a function of a chapter proves, with other arguments if some are given."""
    entry = next(each for each in module.result.entries if each.prove.__name__ == prove)
    return replace(entry, given=given or entry.given).derive(module.result.section)
