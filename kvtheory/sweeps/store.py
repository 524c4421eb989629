"""Where blocks are kept: in memory, or in a work file that outlives a killed process.

The work file is an SQLite database beside the result. A block is one row and one transaction, so that after
`kill -9` at any moment, or with a full disk, every block that was kept is whole. A row holds the SHA-256 of
its content and of the identity of the sweep, so that a damaged block, or one of another sweep, is noticed.
"""

import hashlib
import json
import math
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kvtheory.sweeps.blocks import Account, Block
from kvtheory.sweeps.plan import Plan

APPLICATION = 0x6B765358
"""Marks the SQLite file as a work file of a sweep ("kvSX")."""
PAGE = 16384
"""Bytes; smaller pages make large blocks slow, larger ones small blocks."""
CHECKPOINT = 2**26
"""Bytes of the log after which it is written back to the file: only then the disk is waited for."""

NOT_OURS = "is not a work file of a sweep; it is left as it is: remove it or choose another name"


class Store(Protocol):
    """Keeps blocks and gives them back."""

    def keep(self, block: Block) -> None:
        """Keep a block; it is safe when this returns."""

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points, on request without their values."""


class Memory:
    """Blocks in memory, for a sweep without a file."""

    def __init__(self, *blocks: Block) -> None:
        self._blocks = list(blocks)
        self.keep = self._blocks.append

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points."""
        return iter(sorted(self._blocks, key=lambda block: block.start))


def filled(
    plan: Plan, store: Store, ranges: Iterable[tuple[int, int]]
) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the values of consecutive ranges of points; those not computed are missing values."""
    blocks = store.blocks()
    block = next(blocks, None)
    for start, stop in ranges:
        values = plan.blank(stop - start)
        while block and block.start < stop:
            first, last = max(start, block.start), min(stop, block.stop)
            for name, array in values.items():
                part = block.values[name][first - block.start : last - block.start]
                array[first - start : last - start] = part
            if block.stop > stop:
                break
            block = next(blocks, None)
        yield values


class WorkFile:
    """Blocks in an SQLite file, which one process at a time may have open.

    With `anew`, unfinished work of another sweep in it is dropped.

    Raises
    ------
    ValueError
        If the file belongs to another sweep, or to another program; it is left as it is.
    OSError
        If it is damaged, cannot be opened or written, or is in use.
    """

    def __init__(self, path: Path, plan: Plan, *, anew: bool = False) -> None:
        self.path, self._plan = path, plan
        self._record = json.dumps(plan.record)
        existed = path.exists()
        with self._reported():
            self._base = sqlite3.connect(path, isolation_level=None, timeout=0.0)
        try:
            with self._reported():
                self._open(anew)
        except BaseException:
            self._base.close()
            if not existed:
                self.remove()
            raise

    def _open(self, anew: bool) -> None:
        run = self._base.execute
        run(f"PRAGMA page_size={PAGE}")
        run("PRAGMA locking_mode=EXCLUSIVE")
        (application,) = run("PRAGMA application_id").fetchone()
        (tables,) = run("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and application != APPLICATION:
            raise ValueError(f'"{self.path}" {NOT_OURS}')
        # A log written ahead costs 0.1 ms for each block. With exclusive locking it needs no shared
        # memory, which network file systems lack.
        run("PRAGMA journal_mode=WAL")
        # A power cut may spoil what takes seconds to compute again; nothing else does.
        run(f"PRAGMA synchronous={'OFF' if self._plan.vectorised else 'NORMAL'}")
        run(f"PRAGMA wal_autocheckpoint={CHECKPOINT // PAGE}")
        run("BEGIN EXCLUSIVE")
        if not tables:
            run(f"PRAGMA application_id={APPLICATION}")
            run("CREATE TABLE sweep (record TEXT)")
            run(
                "CREATE TABLE blocks (start INTEGER PRIMARY KEY, stop INTEGER, account TEXT, texts TEXT,"
                " digest TEXT, seal TEXT, numbers BLOB)"
            )
            run("INSERT INTO sweep VALUES (?)", (self._record,))
        (found,) = run("SELECT record FROM sweep").fetchone() or ("",)
        differing = self._plan.differences(found)
        if differing and not anew:
            raise ValueError(
                f'"{self.path}" is the unfinished work of another sweep: it differs in '
                f"{', '.join(differing)}; finish that one, remove the file, or choose another name"
            )
        if differing:
            run("DELETE FROM blocks")
            run("UPDATE sweep SET record = ?", (self._record,))
        run("COMMIT")

    def keep(self, block: Block) -> None:
        """Keep a block; it is safe when this returns."""
        texts = json.dumps([block.values[c.name].tolist() for c in self._plan.textual])
        numbers = b"".join(
            block.values[c.name].astype("<f8").tobytes() for c in self._plan.numeric
        )
        row = block.start, block.stop, block.account.to_json(), texts, _digest(numbers)
        with self._reported():
            self._base.execute(
                "INSERT INTO blocks VALUES (?, ?, ?, ?, ?, ?, ?)", (*row, self._seal(*row), numbers)
            )

    def blocks(self, *, numbers: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points, on request without their values."""
        last = "numbers" if numbers else "NULL"
        select = f"SELECT start, stop, account, texts, digest, seal, {last} FROM blocks ORDER BY start"
        with self._reported():
            for *row, seal, content in self._base.execute(select):
                start, stop, account, texts, digest = row
                if seal != self._seal(*row) or (numbers and digest != _digest(content)):
                    raise sqlite3.DatabaseError(f"points {start} to {stop} are not as computed")
                values = self._values(stop - start, texts, content) if numbers else {}
                yield Block(start, stop, values, Account.from_json(account))

    def _seal(self, *row: Any) -> str:
        """Return the digest of a row, without its numbers, and of the identity of the sweep."""
        return _digest(json.dumps([self._record, *row]).encode())

    def _values(self, points: int, texts: str, numbers: bytes) -> dict[str, NDArray[Any]]:
        """Return the columns of a block."""
        named = zip(self._plan.textual, json.loads(texts), strict=True)
        values = {column.name: np.array(text, dtype=object) for column, text in named}
        shapes = [(points, *self._plan.shape(column)) for column in self._plan.numeric]
        ends = np.cumsum([math.prod(shape) for shape in shapes], dtype=int)
        parts = np.split(np.frombuffer(numbers, "<f8"), ends[:-1])
        for column, part, shape in zip(self._plan.numeric, parts, shapes, strict=False):
            values[column.name] = part.reshape(shape)
        return values

    def close(self) -> None:
        """Release the file; its blocks remain for the next run."""
        self._base.close()

    def remove(self) -> None:
        """Delete the file, once the result is written."""
        self._base.close()
        self.path.unlink(missing_ok=True)
        self.path.with_name(f"{self.path.name}-wal").unlink(missing_ok=True)

    @contextmanager
    def _reported(self) -> Iterator[None]:
        """Report errors of SQLite as errors of the file."""
        try:
            yield
        except sqlite3.DatabaseError as error:
            code = (getattr(error, "sqlite_errorcode", None) or sqlite3.SQLITE_CORRUPT) & 0xFF
            if code == sqlite3.SQLITE_NOTADB:
                raise ValueError(f'"{self.path}" {NOT_OURS}') from None
            if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
                raise OSError(f'"{self.path}" is in use: the same sweep is running') from None
            if code == sqlite3.SQLITE_CORRUPT:
                raise OSError(f'"{self.path}" is damaged, remove it: {error}') from None
            raise OSError(f'"{self.path}" cannot be written or read: {error}') from None


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
