"""Derivations as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import Any

from derivations.record import Derivation


def document(derivations: Sequence[Derivation]) -> str:
    """Return a JSON list with one object per derivation."""
    return json.dumps([_plain(each) for each in derivations], ensure_ascii=False, indent=1) + "\n"


def _plain(derivation: Derivation) -> dict[str, Any]:
    record = {field.name: getattr(derivation, field.name) for field in fields(derivation)}
    table = asdict(derivation.table) if derivation.table else None
    steps = [
        {
            "latex": step.latex,
            "reason": step.reason,
            "status": step.status,
            "source": step.source,
        }
        for step in derivation.steps
    ]
    return {**record, "table": table, "steps": steps}
