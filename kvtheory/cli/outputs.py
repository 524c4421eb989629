"""Files that a command is to write, checked before it computes anything."""

from collections.abc import Sequence
from pathlib import Path


def check_output(option: str, path: Path | None, suffixes: Sequence[str]) -> None:
    """Raise `ValueError` unless a file of this name can be written, as far as names and places tell.

    Examples
    --------
    >>> check_output("--plot", Path("a.pdf"), [".png", ".pdf"])
    >>> check_output("--plot", Path("a.txt"), [".png", ".pdf"])
    Traceback (most recent call last):
    ValueError: --plot "a.txt": expected a name that ends in .png or .pdf
    """
    if path is None:
        return
    if path.suffix not in suffixes:
        expected = " or ".join(filter(None, (", ".join(suffixes[:-1]), suffixes[-1])))
        raise ValueError(f'{option} "{path}": expected a name that ends in {expected}')
    if not path.parent.is_dir():
        raise ValueError(f'{option} "{path}": there is no directory "{path.parent}"')
    if path.is_dir():
        raise ValueError(f'{option} "{path}": is a directory; expected the name of a file')
