"""What a recheck has found about each record, and in all."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from .checks import STATUSES, Record, Verdict

HEADS = ("record", "claims", *reversed(STATUSES), "how")

Verdicts = Mapping[str, Mapping[str, Verdict]]
"""The verdict on each claim, by record and by the name of the claim."""


def recheck(records: Iterable[Mapping[str, Any]], only: Collection[str] = ()) -> Verdicts:
    """Check the claims of `derivations.json`: those of all records, or of some that may cite the others."""
    by_label = {record["label"]: record for record in records}
    wanted = only or by_label
    return {label: Record(by_label[label], by_label).verdicts() for label in wanted}


def counts(verdicts: Verdicts) -> dict[str, int]:
    """Return how many claims have which status, the recalled ones apart."""
    found = Counter(
        "recalled" if each.kind == "recalled" and each.status == "confirmed" else each.status
        for record in verdicts.values()
        for each in record.values()
    )
    return {status: found[status] for status in (*reversed(STATUSES), "recalled")}


def having(verdicts: Verdicts, *statuses: str) -> dict[str, Verdict]:
    """Return the claims of these statuses."""
    claims = (claim for record in verdicts.values() for claim in record.items())
    return {name: verdict for name, verdict in claims if verdict.status in statuses}


def rows(verdicts: Verdicts) -> Iterable[tuple[str, ...]]:
    """Yield a row for each record that claims something."""
    for label, found in verdicts.items():
        count = Counter(each.status for each in found.values())
        own = (each.how.split("; ") for each in found.values() if each.kind != "recalled")
        ways = dict.fromkeys(way for ways in own for way in ways)
        numbers = (str(count[status]) for status in reversed(STATUSES))
        if found:
            yield label, str(len(found)), *numbers, ", ".join(ways) or "as in their sources"
