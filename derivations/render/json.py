"""Derivations as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from derivations.record import Derivation


def document(derivations: Sequence[Derivation]) -> str:
    """Return a JSON list with one object per derivation."""
    return json.dumps([_plain(each) for each in derivations], ensure_ascii=False, indent=1) + "\n"


def _plain(derivation: Derivation) -> dict[str, Any]:
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
    return {**asdict(derivation), "steps": steps}
