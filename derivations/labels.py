"""The names of derivations that users may type."""

import difflib
import re
from collections.abc import Collection, Iterable, Mapping

_WORDS = re.compile(r"(?:eqs?|equations?|theorems?)\b[\s.:]*(?=\S)|[()\s]")
_NUMBER = re.compile(r"(?:eqs?|equation)?\.?0*(\d+)")


def find(names: Iterable[str], contents: Collection[str]) -> list[str]:
    """Return the labels that the names stand for, each once, in the order of the contents.

    A name is a label in any case, with or without what stands around its number; the name of a family
    stands for all its members.

    Examples
    --------
    >>> labels = ["eq4", "eq33", "F3", "F3-values", "table2"]
    >>> find(["33", "eq. 33", "Eq33", "(4)", "Table 2"], labels)
    ['eq4', 'eq33', 'table2']
    >>> find(["f3"], labels)
    ['F3', 'F3-values']

    Raises
    ------
    ValueError
        For names that are no labels: one line for each, with the nearest label.
    """
    wanted: set[str] = set()
    mistakes = []
    for name in names:
        members = _members(name, contents)
        wanted |= members
        if not members:
            mistakes.append(unknown(name, contents, "label"))
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
