"""Derivations as JSON."""

import json
from dataclasses import asdict, fields
from typing import Any

from ..record import Derivation
from .edition import Edition


def document(edition: Edition) -> str:
    """Return a JSON list with one object per derivation."""
    return (
        json.dumps([_plain(each) for each in edition.derivations], ensure_ascii=False, indent=1)
        + "\n"
    )


def _plain(derivation: Derivation) -> dict[str, Any]:
    record = {field.name: getattr(derivation, field.name) for field in fields(derivation)}
    table = asdict(derivation.table) if derivation.table else None
    numbers = [asdict(each) for each in derivation.numbers]
    steps = [
        {
            "latex": step.latex,
            "reason": step.reason,
            "status": step.status,
            "source": step.source,
            "domain": step.domain,
        }
        for step in derivation.steps
    ]
    return {**record, "table": table, "steps": steps, "numbers": numbers}
