"""Messages about wrong values and names: the mistakes in what was given, which are reported together."""

import difflib
import reprlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar

LONGEST_SHOWN = 60
"""Most characters of a key or a value in a message."""
SHORT = reprlib.Repr()
SHORT.maxlist = SHORT.maxtuple = SHORT.maxdict = SHORT.maxstring = SHORT.maxother = LONGEST_SHOWN


class SceneError(ValueError):
    """One or more mistakes in a scene: all of them are in `problems`, the first ones in its text."""

    SHOWN: ClassVar[int] = 20

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        more = len(self.problems) - self.SHOWN
        rest = [f"and {more:,} more mistakes"] if more > 0 else []
        super().__init__("\n".join([*self.problems[: self.SHOWN], *rest]))

    def __reduce__(self) -> Any:  # pickled by the workers of a sweep
        return type(self), (self.problems,)


class Bare(str):
    """A number of a scene file as text, without a unit; messages show it without quotes."""

    __repr__ = str.__str__


def problem(key: str, given: Any, what: str) -> str:
    r"""One line about one mistake: the key, what was given, and what is wrong.

    >>> problem("run.\n" + 60 * "a", [[[[[[[[5]]]]]]]], "unknown key")
    'run.\\naaaaaaaaaaaaaaaaaaaaaaaaa...aaaaaaaaaaaaaaaaaaaaaaaaaaa = [[[[[[[...]]]]]]]: unknown key'
    """
    given = given.tolist() if hasattr(given, "tolist") else given  # an array or number of NumPy
    text = isinstance(given, str) and not isinstance(given, Bare)
    value = f'"{given}"' if text else SHORT.repr(given)
    return f"{shown(key)} = {shown(value)}: {what}"


def shown(text: str) -> str:
    """Return a text as a message quotes it: short, and without control characters."""
    if len(text) > LONGEST_SHOWN:
        text = f"{text[: LONGEST_SHOWN // 2]}...{text[3 - LONGEST_SHOWN // 2 :]}"  # paths differ at the end
    return printable(text)


def printable(text: str) -> str:
    r"""Write control characters and line breaks as escapes, such as \n."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def mistake(key: str, given: Any, what: str) -> SceneError:
    """Return the error about one mistake."""
    return SceneError([problem(key, given, what)])


class Problems(list[str]):
    """The mistakes in what was given, which are reported together."""

    def add(self, key: str, given: Any, what: str) -> None:
        """Append a mistake; see `problem`."""
        self.append(problem(key, given, what))

    @contextmanager
    def catching(self, key: str = "", given: Any = None) -> Iterator[None]:
        """Append a mistake in a given value, instead of raising it; without a key it names it itself."""
        try:
            yield
        except SceneError as error:
            self += error.problems
        except ValueError as error:
            self.append(problem(key, given, str(error)) if key else str(error))

    def report(self) -> None:
        """Raise `SceneError` if there are any."""
        if self:
            raise SceneError(self)


MEANT = {
    symbol: name
    for name, symbols in {
        "modulus": "E young youngs_modulus elastic_modulus shear_modulus",
        "temperature": "T temp",
        "reference_temperature": "T_ref T_0 T_r",
        "activation_energy": "E_a Q arrhenius",
        "poisson_ratio": "nu ν poisson",
        "thickness": "h height",
        "stiffness": "K rigidity k_s k_x spring",
        "retardation_time": "tau τ relaxation_time damping viscosity C",
        "radius": "R diameter curvature",
        "velocity": "V v speed sliding_velocity",
        "load": "W weight force",
        "depth": "delta δ indentation penetration",
        "mass": "m M M_x inertia",
        "gravity": "g acceleration",
        "duration": "t_end end length",
        "friction_coefficient": "mu μ µ friction",
        "friction_force": "F F_x friction_load",
        "normal_force": "F_z contact_force",
        "half_length": "a contact_length half_width",
        "peak_pressure": "p p_max pressure max_pressure",
        "leading_edge": "x_LE front",
        "trailing_edge": "x_TE rear",
        "retardation_length": "l_r",
    }.items()
    for symbol in symbols.split()
}
"""Names by their symbols and synonyms, which similarity of spelling would not find."""


ELSE = {"viscosity": "damping", "C": "damping"}
"""What they mean where the first meaning does not exist."""

MOST_LISTED = 20
"""Most names that a message lists."""


def closest(name: str, valid: Iterable[str]) -> str | None:
    """Return the one of the `valid` names that was probably meant, or None.

    Symbols and synonyms are recognised too, with or without the section before a dot.

    >>> closest("tau", ["radius", "retardation_time"]), closest("support.W", ["support.load"])
    ('retardation_time', 'support.load')
    >>> closest("V", ["support.load", "drive.velocity"])
    'drive.velocity'
    """
    valid = list(valid)
    section, dot, last = name.rpartition(".")
    for meaning in (MEANT, ELSE):
        meant = meaning.get(last, last)
        if section + dot + meant in valid:
            return section + dot + meant
        if not dot and (ends := [each for each in valid if each.endswith(f".{meant}")]):
            return ends[0]
    return next(iter(difflib.get_close_matches(name, valid, n=1, cutoff=0.5)), None)


def nearest(name: str, valid: Iterable[str]) -> str:
    """Suggest the closest of the `valid` names, and list them all, or of very many the nearest three."""
    valid = list(valid)
    match = closest(name, valid)
    hint = f'did you mean "{match}"? ' if match else ""
    if len(valid) > MOST_LISTED:
        near = difflib.get_close_matches(name, valid, n=3, cutoff=0.0)
        return hint.strip() or f"expected one of {len(valid)} names, such as {', '.join(near)}"
    return f"{hint}expected one of: {', '.join(valid)}"


def absent(wanted: Iterable[str], given: Iterable[str]) -> list[str]:
    """Return the wanted names that are missing, and not just misspelt."""
    wanted, given = list(wanted), list(given)
    meant = {closest(name, wanted) for name in given if name not in wanted}
    return [name for name in wanted if name not in given and name not in meant]
