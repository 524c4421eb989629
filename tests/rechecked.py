"""Derivations whose notebook cell has run without a fault: `python -m tests.rechecked` runs them all again.

A digest of each is kept: of its text, that of the checks and the version of SymPy. The tests run those again
where it differs.
"""

import hashlib
import io
import json
from contextlib import redirect_stdout
from pathlib import Path

import sympy as sp
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.render import edition, notebook

PATH = Path(__file__).parent / "data" / "rechecked.json"


def cells(derivations):
    """Return the code that all derivations share, and that of each by its label."""
    book = json.loads(notebook.document(edition(derivations)))["cells"]
    checks, imports, *own = [cell for cell in book if cell["cell_type"] == "code"]
    return (checks, imports), dict(zip((each.label for each in derivations), own, strict=True))


def digests(derivations):
    """Return the digest of each derivation by its label."""
    shared, own = cells(derivations)
    common = "\n".join([sp.__version__, *(cell["source"] for cell in shared)])
    return {
        label: hashlib.sha256(f"{common}\n{cell['source']}".encode()).hexdigest()[:24]
        for label, cell in own.items()
    }


def executed(derivations):
    """Run all code cells in one namespace, as a kernel does, and return what they print."""
    shared, own = cells(derivations)
    namespace, output = {"__name__": "__main__"}, io.StringIO()
    with redirect_stdout(output):
        for cell in (*shared, *own.values()):
            exec(compile(cell["source"], cell["id"], "exec"), namespace)
    return output.getvalue()


def counted(derivations):
    """Return how many steps of each derivation its cell checks, and how many it says that it has checked."""
    lines = [line.split(":")[0] for line in executed(derivations).splitlines()]
    given = {"define", "recall", "asymptote", "pair", "where"}  # a pair repeats two lines
    asked = {
        each.label: sum(step.claim.check not in given for step in each.steps if step.claim)
        for each in derivations
    }
    return asked, {label: lines.count(label) for label in asked}


def main():
    """Run every cell and keep the digests."""
    derivations = catalogue()
    asked, told = counted(derivations)
    if asked != told:
        raise AssertionError({label: told[label] for label in asked if asked[label] != told[label]})
    PATH.write_text(json.dumps(digests(derivations), indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
