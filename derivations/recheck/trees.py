"""Expressions as trees, read from JSON, and their derivatives.

Equal trees are the same object, so that they compare and hash by identity. A function f of unknown form is
the operation `call` with its name, the orders of its partial derivatives, and its arguments.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from functools import reduce
from typing import Any


class UnsupportedError(ValueError):
    """An expression that this program does not understand."""


class Tree:
    """An operation with its operands: trees, or for a leaf its name or number."""

    __slots__ = ("args", "op")
    _known: dict[tuple[Any, ...], "Tree"] = {}  # noqa: RUF012

    op: str
    args: tuple[Any, ...]

    def __new__(cls, op: str, *args: Any) -> "Tree":
        """Return the one tree with these operands."""
        found = cls._known.get((op, *args))
        if found is None:
            found = cls._known[op, *args] = object.__new__(cls)
            found.op, found.args = op, args
        return found

    def __repr__(self) -> str:
        return str(self.args[0]) if self.op in {"number", "symbol"} else f"{self.op}{self.args}"

    def __add__(self, other: "Tree") -> "Tree":
        return self if other is ZERO else other if self is ZERO else Tree("+", self, other)

    def __sub__(self, other: "Tree") -> "Tree":
        return self + MINUS * other

    def __mul__(self, other: "Tree") -> "Tree":
        if ZERO in (self, other):
            return ZERO
        return self if other is ONE else other if self is ONE else Tree("*", self, other)

    def __truediv__(self, other: "Tree") -> "Tree":
        return self * other**MINUS

    def __pow__(self, other: "Tree") -> "Tree":
        return ONE if other is ZERO else self if other is ONE else Tree("^", self, other)

    def children(self) -> Iterator["Tree"]:
        """Yield the operands that are trees, those in tuples too."""
        for arg in self.args:
            parts = arg if isinstance(arg, tuple) else (arg,)
            yield from (part for part in parts if isinstance(part, Tree))

    def has(self, *parts: "Tree") -> bool:
        """Tell whether one of the parts occurs in the tree as it is written."""
        return self in parts or any(child.has(*parts) for child in self.children())

    def calls(self) -> bool:
        """Tell whether a function of unknown form occurs in the tree."""
        return self.op == "call" or any(child.calls() for child in self.children())


def number(value: int | str | Fraction) -> Tree:
    """Return a rational number."""
    return Tree("number", Fraction(value))


ZERO, ONE, TWO, MINUS = map(number, (0, 1, 2, -1))
HALF = number("-1/2")
INFINITY = Tree("infinity")


def read(json: Any) -> Tree:  # noqa: PLR0911
    """Read an expression from nested lists."""
    if isinstance(json, str):
        is_number = json.removeprefix("-")[:1].isdigit()
        return number(json) if is_number else Tree("symbol", json)
    if not isinstance(json, list) or not json or not isinstance(json[0], str):
        raise UnsupportedError(f"{json!r} is no expression")
    op, *rest = json
    if op in {"call", "indexed"}:
        return Tree("call", rest[0], (0,) * len(rest[1:]), *map(read, rest[1:]))
    if op == "derivative":
        inner, *orders = map(read, rest)
        pairs = zip(orders[::2], orders[1::2], strict=True)
        by = [name for name, count in pairs for _ in range(int(count.args[0]))]
        return _derived_call(inner, by) or Tree("derivative", inner, *by)
    if op in {"integral", "sum"}:
        return reduce(lambda tree, over: Tree(op, tree, *map(read, over)), rest[1:], read(rest[0]))
    if op == "at":
        return put(read(rest[0]), {read(name): read(place) for name, place in rest[1:]})
    if op in {"cases", "matrix"}:
        return Tree(op, *(tuple(map(read, row)) for row in rest))
    return Tree(op, *map(read, rest))


def put(tree: Tree, places: Mapping[Tree, Tree]) -> Tree:
    """Return a tree with its variables at other places, all at once."""
    return Tree("at", tree, tuple(places), tuple(places.values())) if places else tree


def _derived_call(inner: Tree, by: list[Tree]) -> Tree | None:
    """Write the derivative of f(x, y) by its own arguments as a function."""
    if inner.op != "call" or not all(inner.args[2:].count(each) == 1 for each in by):
        return None
    name, orders, *args = inner.args
    if any(arg.has(*by) for arg in args if arg not in by):
        return None
    return Tree(
        "call", name, tuple(n + by.count(x) for n, x in zip(orders, args, strict=True)), *args
    )


_SLOPES: Mapping[str, Callable[[Tree], Tree]] = {
    "exp": lambda x: Tree("exp", x),
    "expm1": lambda x: Tree("exp", x),
    "log": lambda x: x**MINUS,
    "log1p": lambda x: (ONE + x) ** MINUS,
    "sin": lambda x: Tree("cos", x),
    "cos": lambda x: MINUS * Tree("sin", x),
    "tan": lambda x: Tree("cos", x) ** number(-2),
    "sinh": lambda x: Tree("cosh", x),
    "cosh": lambda x: Tree("sinh", x),
    "tanh": lambda x: Tree("cosh", x) ** number(-2),
    "atan": lambda x: (ONE + x**TWO) ** MINUS,
    "asin": lambda x: (ONE - x**TWO) ** HALF,
    "asinh": lambda x: (ONE + x**TWO) ** HALF,
}

FUNCTIONS = frozenset(_SLOPES)


class Rules:
    """What names stand for: the premises of a claim that give a symbol, function or integral a value."""

    def __init__(self, values: Mapping[Tree, Tree], fixed: Iterable[Tree] = ()) -> None:
        self.values = values
        self.forms: dict[str, tuple[Tree, ...]] = {}
        """The functions that a premise gives for all values of their letters; none of these is `fixed`."""
        self._slopes: dict[tuple[Tree, Tree], Tree] = {}
        self._reach: dict[Tree, frozenset[Tree]] = {}
        restricted = {*values, *frozenset().union(*map(self.reach, fixed))}
        for lhs, rhs in values.items():
            name, orders, *letters = lhs.args if lhs.op == "call" else ("", ())
            free = all(each.op == "symbol" and rhs.has(each) for each in letters)
            if (
                letters
                and free
                and not any(orders)
                and not rhs.calls()
                and restricted.isdisjoint(letters)
            ):
                self.forms[name] = (rhs, *letters)
        self.related = {lhs.args[0] for lhs in values if lhs.op == "call"} - self.forms.keys()
        """The functions of which a premise says something else."""

    def law(self, tree: Tree) -> Tree | None:
        """Return what a tree stands for; for a derivative, that of what its function stands for."""
        found = self.values.get(tree)
        if found is not None or tree.op != "call" or not any(tree.args[1]):
            return found
        name, orders, *args = tree.args
        for lhs, rhs in self.values.items():
            if lhs.op == "call" and lhs.args[0] == name and list(lhs.args[2:]) == args:
                more = [high - low for high, low in zip(orders, lhs.args[1], strict=True)]
                if min(more) >= 0:
                    return self.derivative(rhs, _repeated(args, more))
        return None

    def derivative(self, tree: Tree, variables: Iterable[Tree]) -> Tree:
        """Differentiate with respect to one variable after the other."""
        return reduce(self.slope, variables, tree)

    def slope(self, tree: Tree, by: Tree) -> Tree:
        """Return the partial derivative; a name depends on what is in its value."""
        if (tree, by) not in self._slopes:
            law = self.law(tree)
            known = ONE if tree is by else ZERO if by not in self.reach(tree) else None
            self._slopes[tree, by] = known or (
                self._slope(tree, by) if law is None else self.slope(law, by)
            )
        return self._slopes[tree, by]

    def _slope(self, tree: Tree, by: Tree) -> Tree:  # noqa: PLR0911
        op, args = tree.op, tree.args
        if op == "+":
            return reduce(Tree.__add__, (self.slope(arg, by) for arg in args))
        if op == "*":
            rows = ([*args[:i], self.slope(arg, by), *args[i + 1 :]] for i, arg in enumerate(args))
            return reduce(Tree.__add__, (reduce(Tree.__mul__, row) for row in rows))
        if op == "^":
            base, exponent = args
            less = number(exponent.args[0] - 1) if exponent.op == "number" else exponent - ONE
            by_exponent = self.slope(exponent, by) * tree
            rest = by_exponent * Tree("log", base) if by_exponent is not ZERO else ZERO
            return exponent * base**less * self.slope(base, by) + rest
        if op in _SLOPES:
            return _SLOPES[op](args[0]) * self.slope(args[0], by)
        if op == "call":
            name, orders, *inner = args
            by_each = (
                Tree("call", name, tuple(n + (i == k) for k, n in enumerate(orders)), *inner)
                * self.slope(inner[i], by)
                for i in range(len(inner))
            )
            return reduce(Tree.__add__, by_each)
        if op == "derivative":
            return self.slope(self.derivative(args[0], args[1:]), by)
        if op == "integral":  # Leibniz' rule
            inner, variable, low, high = args
            ends = [put(inner, {variable: end}) * self.slope(end, by) for end in (high, low)]
            under = self.slope(inner, by) if by is not variable else ZERO
            rest = Tree("integral", under, variable, low, high) if under is not ZERO else ZERO
            return ends[0] - ends[1] + rest
        if op == "at":
            inner, at = args[0], dict(zip(*args[1:], strict=True))
            moved = (put(self.slope(inner, x), at) * self.slope(end, by) for x, end in at.items())
            rest = put(self.slope(inner, by), at) if by not in at else ZERO
            return reduce(Tree.__add__, moved, rest)
        raise UnsupportedError(f"the derivative of {op}")

    def integrates(self, tree: Tree) -> bool:
        """Tell whether an integral occurs in a tree, or in what the names in it stand for."""
        seen, open_ones = set[Tree](), [tree]
        while open_ones and open_ones[-1].op != "integral":
            each = open_ones.pop()
            if each not in seen:
                seen.add(each)
                law = self.law(each)
                open_ones += each.children() if law is None else [law]
        return bool(open_ones)

    def reach(self, tree: Tree) -> frozenset[Tree]:
        """Return the symbols and functions on which a tree depends, through the names in it."""
        if tree not in self._reach:
            self._reach[tree] = frozenset()  # of a name that leads back to itself
            law, op, args = self.law(tree), tree.op, tree.args
            found = frozenset({tree} if op in {"symbol", "call"} else ())
            if law is not None:
                found |= self.reach(law)
            if op == "derivative":
                found |= self.reach(self.derivative(args[0], args[1:]))
            elif op in {"integral", "sum", "at"}:
                bound = {args[1]} if op != "at" else {*args[1]}
                ends = args[2:] if op != "at" else args[2]
                found |= (self.reach(args[0]) - bound).union(*map(self.reach, ends))
            elif law is None or op == "call":
                found = found.union(*map(self.reach, tree.children()))
            self._reach[tree] = found
        return self._reach[tree]


def _repeated(variables: Iterable[Tree], counts: Iterable[int]) -> list[Tree]:
    return [name for name, count in zip(variables, counts, strict=True) for _ in range(count)]
