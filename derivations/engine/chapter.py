r"""A chapter: a section of the document, and a function for each of its records, in reading order.

>>> from .nomenclature import symbol
>>> a, b = symbol("a"), symbol("b")
>>> result = Chapter("Geometry")
>>> @result("square")
... def _square(proof: Proof) -> None:
...     '''Square of a sum.
...
...     The first line is the title, the rest the text; the last step is the result.
...     '''
...     proof.equal((a + b) ** 2, a**2 + 2 * a * b + b**2, "expand")
>>> [record] = result.derive()
>>> record.title, record.latex
('Square of a sum', '\\left(a + b\\right)^{2} = a^{2} + 2 a b + b^{2}')
"""

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .record import ARGUED, Derivation
from .step import Proof

_NUMBERED = re.compile(r"eq(\d+)")


@dataclass(frozen=True)
class Entry:
    """A record that is to be derived: what is said of it, and the function that makes its steps."""

    label: str
    title: str
    text: str
    uses: tuple[str, ...]
    prove: Callable[..., None]
    given: Mapping[str, Any]

    def derive(self, section: str) -> Derivation:
        """Make all steps, and end with the last one unless the function has ended with another."""
        number = _NUMBERED.fullmatch(self.label)
        proof = Proof(self.label, int(number[1]) if number else None, section=section, title=self.title,
                      text=self.text, uses=self.uses)  # fmt: skip
        self.prove(proof, **self.given)
        return proof.finished or proof.done()


class Chapter:
    """The records of a chapter; called, a decorator that adds one."""

    def __init__(self, section: str) -> None:
        self.section = section
        self.entries: list[Entry] = []

    def __call__(
        self, label: str, *, title: str = "", text: str = "", uses: tuple[str, ...] = (),
        **given: Any,
    ) -> Callable[[Callable[..., None]], Callable[..., None]]:  # fmt: skip
        """Return a decorator for the function that proves the record, called with what else is `given`.

        Title and text are those of its docstring, after the `text` that is stated here; with a `title`, as
        for a function that proves several records, they are those stated here alone. A paragraph that begins
        with ``Argued:`` holds what no step states, and the record is "argued". A record ``eq27`` is
        the paper's equation 27. `uses` are labels whose definitions it shares, or on which it rests in words,
        which makes it "argued"; `after` are those of the chapter that are printed later than it, but must be
        proved before.
        """

        def register(prove: Callable[..., None]) -> Callable[..., None]:
            first, _, rest = ("" if title else inspect.getdoc(prove) or "").partition("\n")
            told = " ".join([*text.split(), *rest.split()]).replace(" Argued: ", f" {ARGUED} ")
            entry = Entry(label, title or first.removesuffix("."), told, uses,
                          prove, given)  # fmt: skip
            self.entries.append(entry)
            return prove

        return register

    def derive(self) -> tuple[Derivation, ...]:
        """Prove all records."""
        return tuple(entry.derive(self.section) for entry in self.entries)
