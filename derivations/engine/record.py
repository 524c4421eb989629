r"""The record of a derivation after every step has been checked: LaTeX and words, ready to print.

The engine (`step`) makes these records and the renderers (`render`)
print them; neither knows the other.

Text fields are plain English in which mathematics stands between dollar signs (``$l_r = V\tau$``);
LaTeX fields are mathematics alone, without dollar signs and without alignment marks.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

STATUSES = ("definition", "proved", "proved-leading-order", "argued")
"""The status of an equality, strongest first."""
ARGUED = "Argued, not checked by machine."
"""In the text of a record, before the inferences that no line of it states."""


@dataclass(frozen=True)
class Claim:
    """What was asked of a check, in SymPy: enough to compute with it, and to ask it again elsewhere."""

    check: str
    """Name of the check: define, recall, equal, integral, root and so on."""
    lhs: sp.Expr
    rhs: sp.Expr
    arguments: Mapping[str, Any]
    """The input of the check, by name, except words and LaTeX."""
    rules: Mapping[sp.Expr, sp.Expr]
    """The rules in force when the check was made."""
    positive: tuple[sp.Expr, ...] = ()
    """Expressions that are positive under the conditions then in force."""
    intervals: tuple[tuple[sp.Symbol, sp.Expr, sp.Expr], ...] = ()
    """Intervals of variables under the conditions then in force."""


@dataclass(frozen=True)
class Step:
    """One checked relation ``left relation right`` and the reason why it holds."""

    left: str
    relation: str
    right: str
    reason: str
    status: str
    source: str = ""
    """Label of the derivation that a recalled step comes from."""
    domain: str = ""
    """The values of its variable for which a sign or a root was proved, in LaTeX."""
    note: str = ""
    """What was checked besides the formula, in words: of which equation it is the only root, and where."""
    claim: Claim | None = field(default=None, compare=False, repr=False)

    @property
    def latex(self) -> str:
        """The relation as one line of LaTeX."""
        return f"{self.left} {self.relation} {self.right}"


@dataclass(frozen=True)
class Table:
    """A table of the paper: column heads and rows of cells, both text with ``$...$``."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Calculation:
    """A closed form with the numbers of a scene put in, as one calculates by hand."""

    symbol: str
    formula: str
    substituted: str
    """The formula with a quantity and its unit for each symbol; empty where it has none."""
    shown: str
    """The value in LaTeX, rounded, with its unit."""
    value: float
    """In SI."""
    unit: str
    note: str = ""
    """The accuracy of the number, in words: for an asymptote, the next order."""


@dataclass(frozen=True)
class Derivation:
    """A numbered equation, a named theorem or a table, with the steps that lead to it."""

    label: str
    """Unique name, usable in file names and links: ``eq27``, ``F3``, ``table2``."""
    equation: int | None
    """The paper's equation number, or None if the paper does not have it."""
    section: str
    title: str
    text: str
    """What is asserted and under which assumptions, in words."""
    latex: str
    """The result, one displayed relation."""
    status: str
    """The weakest status among the steps on which the result rests; argued, if the text argues more."""
    steps: tuple[Step, ...] = ()
    uses: tuple[str, ...] = ()
    """Labels of the derivations that this one rests on."""
    table: Table | None = None
    numbers: tuple[Calculation, ...] = ()
    """The closed forms of this derivation with the numbers of a scene."""
    domain: tuple[str, ...] = ()
    """The conditions under which the result holds, besides the assumptions on its symbols, in LaTeX."""
    premises: tuple[str, ...] = ()
    """The definitions and laws that the result rests on, those of recalled results included."""
