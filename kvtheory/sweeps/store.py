"""Where blocks are kept: in memory, or in a work file that outlives a killed process.

The work file is an SQLite database beside the result. A block is one row and one transaction, so
that after `kill -9` at any moment, or a full disk, every block that was kept is whole.
"""

import json
import math
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import Plan, differences

APPLICATION = 0x6B765357
"""Marks the SQLite file as a work file of a sweep ("kvSW")."""

PAGE = 16384
"""Bytes; smaller pages make large blocks slow, larger ones small blocks."""
CHECKPOINT = 2**26
"""Bytes of the log after which it is worked into the file: only then the disk is waited for."""

NOT_OURS = "is not a work file of a sweep; it is left as it is: remove it or choose another name"


class Store(Protocol):
    """Keeps blocks and gives them back."""

    def done(self) -> list[tuple[int, int]]:
        """Return the ranges of points that are kept, in order."""

    def keep(self, block: Block) -> None:
        """Keep a block; it is safe when this returns."""

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points, without their numbers on demand."""


class Memory:
    """Blocks put together in arrays, for a sweep without a file."""

    def __init__(self, plan: Plan) -> None:
        self._points, self._values = plan.points, plan.blank(plan.points)
        self._failures: list[tuple[int, str]] = []
        self._statements: set[str] = set()
        self._errors: dict[str, float] = {}
        self._done: list[tuple[int, int]] = []

    def done(self) -> list[tuple[int, int]]:
        """Return the ranges of points that are kept, in order."""
        return sorted(self._done)

    def keep(self, block: Block) -> None:
        """Keep a block."""
        part = slice(block.start, block.stop)
        for name, whole in self._values.items():
            whole[part] = block.values[name]
        self._failures += block.failures
        self._statements |= set(block.errors[0])
        for name, error in block.errors[1].items():
            self._errors[name] = max(self._errors.get(name, 0.0), error)
        self._done.append((block.start, block.stop))

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield one block that holds everything."""
        errors = sorted(self._statements), self._errors
        yield Block(0, self._points, self._values, sorted(self._failures), errors)


class WorkFile:
    """Blocks in an SQLite file, which one process at a time may have open.

    With `anew`, what another sweep left in it is forgotten.

    Raises
    ------
    ValueError
        If the file belongs to another sweep, or to another program; it is left as it is.
    OSError
        If it cannot be opened or written, or is in use.
    """

    def __init__(self, path: Path, plan: Plan, *, anew: bool = False) -> None:
        self.path, self._plan = path, plan
        existed = path.exists()
        with _told(path):
            self._base = sqlite3.connect(path, isolation_level=None, timeout=0.0)
        try:
            self._open(plan, anew)
        except BaseException:
            self._base.close()
            if not existed:
                self.remove()
            raise

    def _open(self, plan: Plan, anew: bool) -> None:
        with _told(self.path):
            self._base.execute(f"PRAGMA page_size={PAGE}")
            self._base.execute("PRAGMA locking_mode=EXCLUSIVE")
            (application,) = self._base.execute("PRAGMA application_id").fetchone()
            (tables,) = self._base.execute("SELECT count(*) FROM sqlite_master").fetchone()
            if tables and application != APPLICATION:
                raise ValueError(f'"{self.path}" {NOT_OURS}')
            # A log written ahead costs 0.1 ms for each block. With exclusive locking it needs no
            # shared memory, which network file systems lack.
            self._base.execute("PRAGMA journal_mode=WAL")
            # A power cut may spoil what takes seconds to compute again; nothing else does.
            self._base.execute(f"PRAGMA synchronous={'OFF' if plan.vectorised else 'NORMAL'}")
            self._base.execute(f"PRAGMA wal_autocheckpoint={CHECKPOINT // PAGE}")
            self._base.execute("BEGIN EXCLUSIVE")
            if not tables:
                self._create(plan)
            (found,) = self._base.execute("SELECT record FROM sweep").fetchone()
            differing = differences(found, plan)
            if differing and anew:
                self._base.execute("DELETE FROM blocks")
                self._base.execute("UPDATE sweep SET record = ?", (json.dumps(plan.record()),))
            self._base.execute("COMMIT")
        if differing and not anew:
            raise ValueError(
                f'"{self.path}" is the unfinished work of another sweep: it differs in '
                f"{', '.join(differing)}; finish that one, remove the file, or choose another name"
            )

    def _create(self, plan: Plan) -> None:
        self._base.execute(f"PRAGMA application_id={APPLICATION}")
        self._base.execute("CREATE TABLE sweep (record TEXT)")
        self._base.execute(
            "CREATE TABLE blocks (start INTEGER PRIMARY KEY, stop INTEGER, told TEXT, numbers BLOB)"
        )
        self._base.execute("INSERT INTO sweep VALUES (?)", (json.dumps(plan.record()),))

    def done(self) -> list[tuple[int, int]]:
        """Return the ranges of points that are kept, in order."""
        with _told(self.path):
            return self._base.execute("SELECT start, stop FROM blocks ORDER BY start").fetchall()

    def keep(self, block: Block) -> None:
        """Keep a block; it is safe when this returns."""
        texts = [block.values[column.name].tolist() for column in self._plan.textual]
        told = json.dumps([texts, block.failures, block.errors])
        numbers = b"".join(
            np.ascontiguousarray(block.values[column.name], dtype="<f8").tobytes()
            for column in self._plan.numeric
        )
        with _told(self.path):
            self._base.execute(
                "INSERT INTO blocks VALUES (?, ?, ?, ?)", (block.start, block.stop, told, numbers)
            )

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points, without their numbers on demand."""
        what = "numbers" if numbers else "x''"
        with _told(self.path):
            for start, stop, told, blob in self._base.execute(
                f"SELECT start, stop, told, {what} FROM blocks ORDER BY start"
            ):
                texts, failures, errors = json.loads(told)
                values = self._values(stop - start, blob, texts) if numbers else {}
                pairs = [(index, reason) for index, reason in failures]
                yield Block(start, stop, values, pairs, (errors[0], errors[1]))

    def _values(self, points: int, blob: bytes, texts: list[list[str]]) -> dict[str, Any]:
        """Cut what was kept of a block into its columns."""
        flat, at = np.frombuffer(blob, dtype="<f8"), 0
        named = zip(self._plan.textual, texts, strict=True)
        found = {column.name: np.array(text, dtype=object) for column, text in named}
        for column in self._plan.numeric:
            shape = (points, *self._plan.shape(column))
            end = at + math.prod(shape)
            found[column.name] = flat[at:end].reshape(shape)
            at = end
        return found

    def close(self) -> None:
        """Let go of the file; what it keeps can be resumed."""
        self._base.close()

    def remove(self) -> None:
        """Delete the file, once the result is written."""
        self._base.close()
        self.path.unlink(missing_ok=True)
        self.path.with_name(self.path.name + "-wal").unlink(missing_ok=True)


@contextmanager
def _told(path: Path) -> Any:
    """Turn what SQLite says into an error about the file."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        code = getattr(error, "sqlite_errorcode", None)
        if code == sqlite3.SQLITE_NOTADB:
            raise ValueError(f'"{path}" {NOT_OURS}') from None
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise OSError(f'"{path}" is in use: the same sweep is running') from None
        raise OSError(f'"{path}" cannot be written or read: {error}') from None
    except json.JSONDecodeError as error:
        raise OSError(f'"{path}" is damaged, remove it: {error}') from None
