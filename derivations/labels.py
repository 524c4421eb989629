"""The names of derivations that users may type."""

import difflib
import re
from collections.abc import Collection, Iterable, Mapping

_WORDS = re.compile(r"(?:eqs?|equations?|theorems?)\b[\s.:]*(?=\S)|[()\s]")
_NUMBER = re.compile(r"(?:eqs?|equation)?\.?0*(\d+)")
_END = re.compile(r"(eq|f|table)?0*(\d+)")
"""A label that can end a range: a kind, "eq" if none is given, and its number."""


def find(names: Iterable[str], contents: Collection[str]) -> list[str]:
    """Return the labels that the names stand for, each once, in the order of the contents.

    A name is a label in any case, with or without what stands around its number; the name of a family
    stands for all its members, two names with a hyphen between them for all from one number to the other.

    Examples
    --------
    >>> labels = ["eq4", "eq33", "F3", "F3-values", "table2"]
    >>> find(["33", "eq. 33", "Eq33", "(4)", "Table 2"], labels)
    ['eq4', 'eq33', 'table2']
    >>> find(["f3"], labels)
    ['F3', 'F3-values']
    >>> find(["eq4-eq33", "F3-F3"], labels)
    ['eq4', 'eq33', 'F3', 'F3-values']

    Raises
    ------
    ValueError
        For names that are no labels: one line for each, with the nearest label.
    """
    wanted: set[str] = set()
    mistakes = []
    for name in names:
        members = _members(name, contents)
        ends = [] if members else _ends(name)
        for end in [f"{kind}{number}" for kind, number in ends] or [name]:
            if not (members or _members(end, contents)):
                mistakes.append(unknown(end, contents, "label"))
        wanted |= _between(ends, contents) if ends else members
    if mistakes:
        raise ValueError("\n".join(mistakes))
    return [label for label in contents if label in wanted]


def closure(labels: Iterable[str], uses: Mapping[str, Iterable[str]]) -> list[str]:
    """Return the labels with all that they rest on, however far back; what is used comes first.

    >>> closure(["F1", "eq27"], {"eq27": ["eq28", "eq3"], "eq28": ["eq3"], "eq3": [], "F1": []})
    ['F1', 'eq3', 'eq28', 'eq27']
    """
    found: dict[str, None] = {}

    def add(label: str) -> None:
        if label not in found:
            for premise in uses.get(label, ()):
                add(premise)
            found[label] = None

    for label in labels:
        add(label)
    return list(found)


def unknown(name: str, valid: Collection[str], kind: str) -> str:
    """Return that a name is not known, and which known one is nearest."""
    nearest = difflib.get_close_matches(name, valid, n=1, cutoff=0)
    return f"unknown {kind} {name!r}" + (f"; the nearest is {nearest[0]!r}" if nearest else "")


def _members(name: str, contents: Collection[str]) -> set[str]:
    """Return the labels of a name: itself, or the family that it names."""
    bare = _WORDS.sub("", name.strip().lower())
    number = _NUMBER.fullmatch(bare)
    key = f"eq{number[1]}" if number else bare
    exact = {label for label in contents if label.lower() == key}
    family = {label for label in contents if label.lower().split("-")[0] == key}
    return family or exact


def _ends(name: str) -> list[tuple[str, int]]:
    """Return kind and number of both ends of a range of one kind, as of eq26-eq48; else nothing."""
    found = [_END.fullmatch(_WORDS.sub("", end)) for end in re.split("[-\u2013]", name.lower())]
    ends = [(end[1] or "", int(end[2])) for end in found if end]
    kind = ends[0][0] if ends else ""
    same = len(ends) == len(found) == 2 and ends[1][0] in ("", kind or "eq")
    return [(kind or "eq", number) for _, number in ends] if same else []


def _between(ends: list[tuple[str, int]], contents: Collection[str]) -> set[str]:
    """Return the labels whose numbers lie in a range, with all members of their families."""
    low, high = sorted(ends)
    numbered = {label: _END.fullmatch(label.lower().split("-")[0]) for label in contents}
    return {
        label
        for label, found in numbered.items()
        if found and found[1] == low[0] and low[1] <= int(found[2]) <= high[1]
    }
