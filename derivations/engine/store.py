"""Chapters that were proved before, kept on disk: what has not changed is not proved again.

A chapter is found again only under a digest of all that its proofs rest on: its own text, that of each
chapter before it, of the engine, and the versions of Python, SymPy and their arithmetic.
"""

import hashlib
import os
import pickle
import platform
import sys
import tempfile
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef, UndefinedFunction
from sympy.external.gmpy import GROUND_TYPES

from .book import Finished
from .nomenclature import shared_letters

SOURCES = Path(__file__).parents[1]
_SUFFIX = f".{__package__}.{sys.implementation.cache_tag}.proofs"
"""With the name under which this package was imported, by which the classes in a file are found again."""
_DIGITS = 64
"""Length of a digest in print."""

Proofs = dict[str, Finished]


def digests(chapters: Sequence[str]) -> dict[str, str]:
    """Return, for each chapter, the digest of what its proofs rest on.

    A chapter rests on those before it, and on the engine; how it is printed also on letters of later ones.
    """
    arithmetic = sp.__version__, mpmath.__version__, GROUND_TYPES
    versions = sys.version, platform.machine(), *arithmetic, shared_letters()
    shared = sorted((SOURCES / "engine").glob("*.py"))
    state, found = hashlib.sha256(repr(versions).encode()), {}
    for path in (*shared, *(SOURCES / "chapters" / f"{name}.py" for name in chapters)):
        text = path.read_bytes()
        state.update(f"{path.name} {len(text)}\n".encode() + text)
        found[path.stem] = state.hexdigest()
    return {name: found[name] for name in chapters}


def _folders() -> list[Path]:
    """Return where proofs may be kept: beside the compiled sources, or else in the user's cache."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return [SOURCES / "__pycache__", Path(home) / "kvtheory" / "proofs"]


def load(chapter: str, digest: str) -> Proofs | None:
    """Return the proofs of a chapter, None unless they were kept whole and under this very digest."""
    for folder in _folders():
        try:
            text = (folder / f"{chapter}{_SUFFIX}").read_bytes()
        except OSError:
            continue
        head, body = text[: 2 * _DIGITS], text[2 * _DIGITS :]
        if head == _head(digest, body):
            try:
                return dict(pickle.loads(body))
            except Exception:  # whatever it is, the chapter is proved instead
                continue
    return None


def keep(chapter: str, digest: str, proofs: Proofs) -> None:
    """Keep the proofs of a chapter, if they can be read back as they are and there is a place for them."""
    file = BytesIO()
    try:
        _Pickler(file, pickle.HIGHEST_PROTOCOL).dump(proofs)
        body = file.getvalue()
        if _content(pickle.loads(body)) != _content(proofs):
            return
    except (pickle.PicklingError, TypeError, AttributeError):
        return
    for folder in _folders():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=folder, delete=False) as part:
                part.write(_head(digest, body) + body)
            os.replace(part.name, folder / f"{chapter}{_SUFFIX}")
        except OSError:
            continue
        return


def _head(digest: str, body: bytes) -> bytes:
    return f"{digest}{hashlib.sha256(body).hexdigest()}".encode()


def _content(proofs: Mapping[str, Finished]) -> list[Any]:
    """Return all of some proofs for comparison, with the claims, which equality of steps leaves out."""
    claims = [[step.claim for step in each.derivation.steps] for each in proofs.values()]
    return [proofs, claims]


def _function(name: str, assumptions: Mapping[str, bool]) -> UndefinedFunction:
    return sp.Function(name, **assumptions)


def _call(function: UndefinedFunction, arguments: tuple[sp.Expr, ...]) -> sp.Expr:
    return function(*arguments)


class _Pickler(pickle.Pickler):
    """Writes sums, products and powers as they stand, which SymPy would evaluate, and unknown functions."""

    def reducer_override(self, node: Any) -> Any:
        """Say how to build a node again."""
        if type(node) in (sp.Add, sp.Mul):
            return type(node)._from_args, (node.args,)
        if type(node) is sp.Pow:
            return sp.Pow, (*node.args, False)
        if isinstance(node, AppliedUndef):
            return _call, (node.func, node.args)
        if isinstance(node, UndefinedFunction):
            return _function, (node.__name__, node._kwargs)
        return NotImplemented
