"""Mentions of derivations in text: found, and linked to the page that proves them."""

import re

from kvtheory.derivations.catalogue import CONTENTS

_MENTION = re.compile(r"(?<![\w-])(?:Eqs?\. (\d+)|(F\d+(?:-[A-Za-z0-9]+)*))(?![\w-])")
_QUOTED = re.compile(r'["“]([\w-]+)(?=["”])')


def mentioned(text: str) -> set[str]:
    """Return the labels that a text mentions, as "Eq. 33" or "F17-load".

    >>> sorted(mentioned("Eq. 33 and theorem F17-load; Eqs. 26-29"))
    ['F17-load', 'eq26', 'eq27', 'eq28', 'eq29', 'eq33']
    """
    found = {_label(match) for match in _MENTION.finditer(text)}
    for first, last in re.findall(r"Eqs\. (\d+)-(\d+)", text):
        found |= {f"eq{number}" for number in range(int(first), int(last) + 1)}
    return (found | set(_QUOTED.findall(text))) & set(CONTENTS)


def linked(text: str) -> str:
    """Return Markdown in which mentions of labels are links."""
    return _MENTION.sub(
        lambda match: (
            f"[{match[0]}](#{anchor_of(_label(match))})" if _label(match) in CONTENTS else match[0]
        ),
        text,
    )


def anchor_of(label: str) -> str:
    """Return the anchor of a derivation in links: Sphinx writes targets in lower case."""
    return label.lower()


def page_of(section: str) -> str:
    """Return the name of the page of a section.

    >>> page_of("Transient: theorems")
    'transient-theorems'
    """
    return re.sub(r"[^a-z0-9]+", "-", section.lower()).strip("-")


def _label(match: re.Match[str]) -> str:
    return f"eq{match[1]}" if match[1] else match[2]
