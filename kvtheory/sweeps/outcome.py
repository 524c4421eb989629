"""What a sweep found, summed up from its blocks: what every kind of file says about itself."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from kvtheory.results import Certificate
from kvtheory.results.sweep import Failure
from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import Plan

FAILURES_LISTED = 100
"""Failures that a result lists when it stays in a file; the file itself has them all."""


@dataclass(frozen=True)
class Outcome:
    """What was computed, ready to be written: `blocks` gives it anew each time (see `Store.blocks`)."""

    plan: Plan
    done: int
    failed: int
    failures: tuple[Failure, ...]
    certificate: Certificate
    blocks: Callable[..., Iterator[Block]]

    def header(self) -> dict[str, str]:
        """Return what a file says about itself, as JSON texts."""
        summary = {
            "points": self.plan.points,
            "done": self.done,
            "failed": self.failed,
            "failures": [asdict(failure) for failure in self.failures[:FAILURES_LISTED]],
            "certificate": self.certificate.statement,
            "relative_error": self.certificate.relative_error,
        }
        return {"record": json.dumps(self.plan.record()), "summary": json.dumps(summary)}


def outcome(plan: Plan, blocks: Callable[..., Iterator[Block]], most: int | None = None) -> Outcome:
    """Sum up blocks; at most `most` failures are listed."""
    done = failed = 0
    failures: list[Failure] = []
    statements: set[str] = set()
    errors: dict[str, float] = {}
    for block in blocks(numbers=False):
        done += block.stop - block.start
        failed += len(block.failures)
        listed = block.failures[: None if most is None else most - len(failures)]
        failures += [failure(plan, index, reason) for index, reason in listed]
        statements |= set(block.errors[0])
        for name, error in block.errors[1].items():
            errors[name] = max(errors.get(name, 0.0), error)
    certificate = Certificate("estimated", "; ".join(sorted(statements)), errors)
    return Outcome(plan, done, failed, tuple(failures), certificate, blocks)


def failure(plan: Plan, index: int, reason: str) -> Failure:
    """Return a failure with the values that were swept at its point."""
    point = {key: float(a[0]) for key, a in values_at(plan.axes, index, index + 1).items()}
    return Failure(index, point, reason)
