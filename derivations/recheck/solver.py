"""Inequalities of polynomials from conditions of several letters, by z3 where it is installed."""

from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any

from .trees import Rules, Tree, UnsupportedError
from .values import Facts, name_of

MILLISECONDS = 1000
"""The time for one claim."""
_SIGNS = {"positive": ">", "negative": "<", "nonnegative": ">=", "nonpositive": "<="}


def proves(
    gap: Tree,
    relation: str,
    rules: Rules,
    facts: Facts,
    conditions: Iterable[Tree],
    equations: Iterable[Tree],
) -> bool:
    """Tell whether z3 proves gap > 0 and so on, wherever premises and conditions hold."""
    if find_spec("z3") is None:
        return False
    import z3

    solver, letters = z3.Solver(), dict[Tree, Any]()

    def related(sign: str, value: Any) -> Any:
        return {">": value > 0, ">=": value >= 0, "<": value < 0, "<=": value <= 0}[sign]

    def letter(tree: Tree) -> Any:
        if tree not in letters:
            letters[tree] = z3.Real(f"x{len(letters)}")
            for fact in facts.get(name_of(tree), ()):
                if fact in _SIGNS:
                    solver.add(related(_SIGNS[fact], letters[tree]))
        return letters[tree]

    def real(tree: Tree) -> Any:
        law = rules.law(tree)
        if law is not None:
            if tree not in letters:
                solver.add(letter(tree) == real(law))
            return letter(tree)
        if tree.op in {"symbol", "call"}:
            return letter(tree)
        if tree.op == "number":
            return z3.RealVal(str(tree.args[0]))
        if tree.op == "derivative":
            return real(rules.derivative(tree.args[0], tree.args[1:]))
        if tree.op not in {"+", "*", "^"} or (tree.op == "^" and tree.args[1].op != "number"):
            raise UnsupportedError(f"z3 knows no {tree.op}")
        if tree.op != "^":
            parts = [real(arg) for arg in tree.args]
            return z3.Sum(parts) if tree.op == "+" else z3.Product(parts)
        base, order = real(tree.args[0]), tree.args[1].args[0]
        if order.denominator != 1:  # a root is a letter of its own
            root = letter(Tree("root", tree.args[0], order.denominator))
            solver.add(root >= 0, z3.Product([root] * order.denominator) == base)
            base = root
        power = z3.Product([base] * abs(order.numerator))
        return power if order > 0 else 1 / power

    try:
        solver.set("timeout", MILLISECONDS)
        solver.add(z3.Not(related(relation, real(gap))))
        for condition in conditions:
            if condition.op in {"<", "<=", ">", ">="}:
                one, other = condition.args
                solver.add(related(condition.op, real(one) - real(other)))
        for equation in equations:
            solver.add(real(equation) == 0)
    except UnsupportedError:
        return False
    return bool(solver.check() == z3.unsat)
