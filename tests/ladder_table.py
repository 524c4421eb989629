"""The ladder on ten thousand random scenes: `python -m tests.ladder_table [COUNT]`.

For each kind of scene and each model: how often the true error was within the tolerance, how often the rung
was the cheapest that would have passed, and the share of the time that went into the choice.
"""

import signal
import sys
import time
from collections import defaultdict
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass

import numpy as np

import kvtheory as kv
from kvtheory.results.errors import ToleranceError
from tests import ladder_scenes as scenes

KINDS = {
    "steady": (scenes.steady_case, 0.70),
    "ball": (lambda rng: scenes.steady_case(rng, ball=True), 0.10),
    "other shape": (scenes.shape_case, 0.04),
    "start": (scenes.start_case, 0.14),
    "memory": (lambda rng: scenes.start_case(rng, memory=True), 0.02),
}
"""How scenes of each kind are drawn, and their share."""


PATIENCE = 5.0
"""Seconds for the truth of one scene."""


@dataclass(frozen=True)
class Outcome:
    """What became of one request."""

    kind: str
    seed: int
    rtol: float
    model: str
    error: float
    cheapest: bool
    choosing: float
    """Seconds on rungs that were not used, and to judge the one that was."""
    vain: float
    """Seconds on rungs that were not used."""
    wall: float

    @property
    def within(self):
        """Whether the answer is as good as it was asked for."""
        return self.error <= self.rtol


@contextmanager
def limited():
    """Give up on an independent truth that takes too long."""

    def too_long(*_):
        raise ArithmeticError("the truth takes too long")

    before = signal.signal(signal.SIGALRM, too_long)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def outcome(kind, seed, patience=nullcontext()):  # noqa: B008 - immutable
    """Solve one random request and hold it against the truth; None where no model would do."""
    case = KINDS[kind][0](np.random.default_rng(seed))
    begun = time.perf_counter()
    try:
        found = kv.solve(case.scene, **case.request)
    except ToleranceError:
        return None
    wall = time.perf_counter() - begun
    *vain, last = found.climb
    lost = sum(step.choosing + step.solving for step in vain)
    with patience:
        error = scenes.true_error(case, found.values, found.model)
        if error > case.request["rtol"]:
            error = scenes.true_error(case, found.values, found.model, scenes.TRUEST)
    cheapest = not scenes.cheaper_would_do(case, found.model)
    return Outcome(
        kind, seed, case.request["rtol"], found.model, error, cheapest,
        lost + last.choosing, lost, wall,
    )  # fmt: skip


def measure(count):
    """Return the outcomes of `count` requests, and those that no model met, by kind and seed."""
    kv.solve(at=[0.1])  # compiles
    found, refused, failed = [], [], []
    for kind, (_, share) in KINDS.items():
        for seed in range(round(count * share)):
            try:
                result = outcome(kind, seed, limited())
            except (ArithmeticError, ValueError) as error:  # of the truth, which then says nothing
                failed.append((kind, seed, str(error)))
                continue
            (refused.append((kind, seed)) if result is None else found.append(result))
        print(f"{kind}: done", file=sys.stderr, flush=True)
    return found, refused, failed


def table(found):
    """Print the outcomes by kind and model."""
    groups = defaultdict(list)
    for one in found:
        for key in ((one.kind, one.model), (one.kind, "all"), ("all", "all")):
            groups[key].append(one)
    heads = "kind", "model", "scenes", "within", "cheapest", "wall [ms]", "choice", "in vain"
    print("".join(f"{head:>15}" for head in heads))
    for key, ones in sorted(groups.items()):
        within, cheapest = (
            np.mean([getattr(one, name) for one in ones]) for name in ("within", "cheapest")
        )
        wall = sum(one.wall for one in ones)
        shares = (sum(getattr(one, name) for one in ones) / wall for name in ("choosing", "vain"))
        cells = (
            *key, len(ones), f"{within:.2%}", f"{cheapest:.1%}", f"{1e3 * wall / len(ones):.3f}",
            *(f"{share:.1%}" for share in shares),
        )  # fmt: skip
        print("".join(f"{cell:>15}" for cell in cells))


def main():
    """Measure, and print the table and the exceptions."""
    found, refused, failed = measure(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
    table(found)
    print("\nnot within the tolerance:")
    for one in found:
        if not one.within:
            print(f"  {one.kind} {one.seed}: {one.model}, error {one.error:.2e} > {one.rtol:.2e}")
    print(f"no model was known to be enough: {len(refused)} {refused[:20]}")
    print(f"truth not known: {len(failed)} {failed[:5]}")


if __name__ == "__main__":
    main()
