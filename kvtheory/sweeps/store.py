"""Where blocks are kept: in memory, or in a work file that outlives a killed process.

The work file is an SQLite database beside the result. A block is one row and one transaction, so
that after `kill -9` at any moment, or a full disk, every block that was kept is whole.
"""

import json
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
        rows = sum(plan.rows(column) for column in plan.numeric)
        self._numbers = np.full((rows, plan.points), np.nan)
        self._texts = [[""] * plan.points for _ in plan.textual]
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
        self._numbers[:, part] = block.numbers
        for whole, texts in zip(self._texts, block.texts, strict=True):
            whole[part] = texts
        self._failures += block.failures
        self._statements |= set(block.errors[0])
        for name, error in block.errors[1].items():
            self._errors[name] = max(self._errors.get(name, 0.0), error)
        self._done.append((block.start, block.stop))

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield one block that holds everything."""
        errors = sorted(self._statements), self._errors
        count = self._numbers.shape[1]
        yield Block(0, count, self._numbers, self._texts, sorted(self._failures), errors)


class WorkFile:
    """Blocks in an SQLite file, which one process at a time may have open.

    Raises
    ------
    ValueError
        If the file belongs to another sweep, or to another program; it is left as it is.
    OSError
        If it cannot be opened or written, or is in use.
    """

    def __init__(self, path: Path, plan: Plan) -> None:
        self.path = path
        self._rows = sum(plan.rows(column) for column in plan.numeric)
        existed = path.exists()
        with _told(path):
            self._base = sqlite3.connect(path, isolation_level=None, timeout=0.0)
        try:
            self._open(plan)
        except BaseException:
            self._base.close()
            if not existed:
                self.remove()
            raise

    def _open(self, plan: Plan) -> None:
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
            self._base.execute("COMMIT")
        if differing := differences(found, plan):
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
        told = json.dumps([block.texts, block.failures, block.errors])
        numbers = np.ascontiguousarray(block.numbers, dtype="<f8").data
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
                array = np.frombuffer(blob, dtype="<f8")
                array = array.reshape(self._rows, -1) if numbers else array
                pairs = [(index, reason) for index, reason in failures]
                yield Block(start, stop, array, texts, pairs, (errors[0], errors[1]))

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
