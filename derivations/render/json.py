"""Derivations as JSON."""

import json
from dataclasses import asdict, fields
from typing import Any

from ..engine.record import Derivation
from .claims import Names, claims
from .edition import Edition


def document(edition: Edition) -> str:
    """Return a JSON list with one object per derivation, its steps and claims a line each."""
    names = Names()
    records = (_record(_plain(each, names)) for each in edition.derivations)
    return "[\n" + ",\n".join(records) + "\n]\n"


def _record(record: dict[str, Any]) -> str:
    """Write one object, a line for each key and for each object within a list."""
    lines = []
    for key, value in record.items():
        text = json.dumps(value, ensure_ascii=False)
        if isinstance(value, list | tuple) and value and isinstance(value[0], dict):
            rows = ",\n   ".join(json.dumps(row, ensure_ascii=False) for row in value)
            text = f"[\n   {rows}\n  ]"
        lines.append(f'  "{key}": {text}')
    return " {\n" + ",\n".join(lines) + "\n }"


def _plain(derivation: Derivation, names: Names) -> dict[str, Any]:
    record = {field.name: getattr(derivation, field.name) for field in fields(derivation)}
    table = asdict(derivation.table) if derivation.table else None
    numbers = [asdict(each) for each in derivation.numbers]
    told = ("latex", "reason", "status", "source", "domain")
    steps = [{name: getattr(step, name) for name in told} for step in derivation.steps]
    return {
        **record,
        "table": table,
        "steps": steps,
        "numbers": numbers,
        **claims(derivation, names),
    }
