"""The derivations as pages: one for each section, linked with the functions that compute them."""

import re
from functools import cache
from json import loads
from pathlib import Path

from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.emit import FORMS
from kvtheory.derivations.recheck.report import Verdicts, counts, having, recheck
from kvtheory.derivations.render import edition, json, markdown
from kvtheory.derivations.render.text import by_section

from generators import exercises, premises
from generators.equations import place_of, users
from generators.files import put
from generators.labels import anchor_of, page_of
from kvtheory import __version__

MOST = 6
"""Functions that are named below one derivation, those of the interface first."""


def write(directory: Path) -> None:
    """Derive everything and write the pages, and what other pages include."""
    derived = catalogue()
    made = {**pages(), **premises.pages(derived), **exercises.pages(derived)}
    made["theory/second-opinion.txt"] = second_opinion(verdicts())
    for path, text in made.items():
        put(directory / path, text)


@cache
def pages() -> dict[str, str]:
    """Return a page for each section, and their index."""
    derived = catalogue()
    text = markdown.document(edition(derived, command="kvtheory derive", version=__version__))
    head, *sections = re.split(r"^## ", text, flags=re.MULTILINE)
    members = by_section(derived)
    texts, names = {}, []
    for section in sections:
        title, _, body = section.partition("\n")
        name = page_of(title)
        names.append(name)
        labels = [
            each.label for each in next((m for s, m in members.items() if _same(s, title)), ())
        ]
        texts[f"theory/{name}.md"] = f"# {title}\n{_named(body, labels)}"
    tree = "\n".join(names)
    texts["theory/index.md"] = f"{head}\n```{{toctree}}\n:maxdepth: 2\n\n{tree}\n```\n"
    return texts


@cache
def verdicts() -> Verdicts:
    """Return the verdicts on the claims of `derivations.json`: on all of them, in seconds."""
    return recheck(loads(json.document(edition(catalogue()))))


def second_opinion(verdicts: Verdicts) -> str:
    """Return how many claims were confirmed, and how; part of a page."""
    found = [each for record in verdicts.values() for each in record.values()]
    rows = [("kind", "confirmed", "supported", "unconfirmed", "how")]
    kinds = dict.fromkeys(each.kind for each in found if each.kind != "recalled")
    for kind in kinds:
        mine = [each for each in found if each.kind == kind]
        numbers = (str(sum(each.status == status for each in mine)) for status in rows[0][1:-1])
        ways = dict.fromkeys(way for each in mine for way in each.how.split("; "))
        rows.append((kind, *numbers, ", ".join(ways)))
    count = counts(verdicts)
    total = sum(count.values()) - count["recalled"]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    lines.insert(1, "|---" * len(rows[0]) + "|")
    open_ones: dict[str, list[str]] = {}
    for name, each in having(verdicts, "unconfirmed").items():
        open_ones.setdefault(each.how, []).append(f"`{name}`")
    reasons = "; ".join(f"{how}: {', '.join(names)}" for how, names in open_ones.items())
    told = [
        f"Of {total} claims it confirms {count['confirmed']}, supports {count['supported']}, leaves "
        f"{count['unconfirmed']} unconfirmed and refutes {count['refuted']}.",
        f"{count['recalled']} recalled relations stand in their sources under the same conditions.",
    ]
    rest = f"\nUnconfirmed: {reasons}.\n" if reasons else ""
    return " ".join(told) + "\n\n" + "\n".join(lines) + "\n" + rest


def _same(section: str, title: str) -> bool:
    return re.sub(r"\W", "", section) == re.sub(r"\W", "", title)


def _named(body: str, labels: list[str]) -> str:
    """Give each derivation of a section its label, and name the functions that compute it."""
    first, *parts = re.split(r"^### ", body, flags=re.MULTILINE)
    if len(parts) != len(labels):
        return body.replace("### ", "## ")
    return first + "".join(_one(part, label) for part, label in zip(parts, labels, strict=True))


def _one(part: str, label: str) -> str:
    title, _, body = part.partition("\n")
    forms = [f"closed_forms.py::{form.name}" for form in FORMS if form.label == label]
    using = [*map(place_of, dict.fromkeys([*forms, *users("kvtheory")[label]]))]
    using = sorted(using, key=lambda text: not text.startswith("["))[:MOST]
    told = f"\nComputed by {', '.join(using)}.\n" if using else ""
    # A label of Sphinx would let links show a number of its own: the formula carries the label as its tag.
    body = re.sub(r"\n\$\$ \((\S+)\)", r" \\tag{\1}\n$$", body)
    body = re.sub(r"\]\(#([^)]+)\)", lambda found: f"](#{anchor_of(found[1])})", body)
    return f"({anchor_of(label)})=\n## {title}\n{body.rstrip()}\n{told}\n"
