"""The work file of a sweep: blocks that survive a killed process.

It is an SQLite database beside the result. A block is one row and one transaction, so that after
`kill -9` at any moment, or with a full disk, every block that was kept is whole. A row holds a checksum; a
block that was damaged is dropped when the file is opened, and computed again.
"""

import json
import math
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from zlib import crc32

import numpy as np

from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import EVENTS, Plan, Table

APPLICATION = 0x6B765333
"""Marks the SQLite file as a work file of a sweep in this layout ("kvS3")."""
PAGE = 16384
"""Bytes; smaller pages make large blocks slow, larger ones small blocks."""
CHECKPOINT = 2**26
"""Size of the log in bytes at which it is written back to the file: only this waits for the disk."""
NOT_OURS = "is not a work file of a sweep; it is left as it is: remove it or choose another name"


class WorkFile:
    """Blocks in an SQLite file, which one process at a time may have open.

    A file of another sweep or program raises `ValueError` and is left as it is; with `anew`, unfinished work
    of another sweep is dropped. A file that is damaged, unusable or in use raises `OSError`.
    """

    def __init__(self, path: Path, plan: Plan, *, anew: bool = False) -> None:
        self.path, self._plan, existed = path, plan, path.exists()
        self._record = json.dumps(plan.record)
        with _reported(path):
            self._base = sqlite3.connect(path, isolation_level=None, timeout=0.0)
            try:
                self._open(anew)
            except BaseException:
                self.close(remove=not existed)
                raise

    def _open(self, anew: bool) -> None:
        run = self._base.execute
        run(f"PRAGMA page_size={PAGE}")
        run("PRAGMA locking_mode=EXCLUSIVE")
        (application,) = run("PRAGMA application_id").fetchone()
        (tables,) = run("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and application != APPLICATION:
            raise ValueError(f'"{self.path}" {NOT_OURS}')
        # Steady states take seconds to compute again: only a power cut can spoil their file, which is
        # written once, without waiting for the disk. For transients a log is written ahead, in 0.1 ms for
        # each block. With exclusive locking it needs no shared memory, which network file systems lack.
        run(f"PRAGMA journal_mode={'DELETE' if self._plan.vectorised else 'WAL'}")
        run(f"PRAGMA synchronous={'OFF' if self._plan.vectorised else 'NORMAL'}")
        run(f"PRAGMA wal_autocheckpoint={CHECKPOINT // PAGE}")
        run("BEGIN EXCLUSIVE")
        if not tables:
            run(f"PRAGMA application_id={APPLICATION}")
            run("CREATE TABLE sweep (record TEXT)")
            columns = "stop INTEGER, message TEXT, content BLOB, checksum INTEGER"
            run(f"CREATE TABLE blocks (start INTEGER PRIMARY KEY, {columns})")
            run("INSERT INTO sweep VALUES (?)", (self._record,))
        (found,) = run("SELECT record FROM sweep").fetchone() or ("",)
        if differing := self._plan.differences(found):
            if not anew:
                why = f"it differs in {', '.join(differing)}"
                what = "finish that one, remove the file, or choose another name"
                message = f'"{self.path}" is the unfinished work of another sweep: {why}; {what}'
                raise ValueError(message)
            run("DELETE FROM blocks")
            run("UPDATE sweep SET record = ?", (self._record,))
        damaged = [
            (row[0],) for row in run("SELECT * FROM blocks") if _checksum(*row[:-1]) != row[-1]
        ]
        self._base.executemany("DELETE FROM blocks WHERE start = ?", damaged)
        run("COMMIT")

    def keep(self, block: Block) -> None:
        """Keep a block; it is safe when this returns."""
        names = [column.name for column in self._plan.numeric]
        content = b"".join(np.ascontiguousarray(block.table[name]).data for name in names)
        texts = block.table[EVENTS].tolist() if self._plan.texts else []
        message = json.dumps([block.failures, block.statements, block.errors, texts])
        row = block.start, block.stop, message, content
        with _reported(self.path):
            self._base.execute("INSERT INTO blocks VALUES (?, ?, ?, ?, ?)", (*row, _checksum(*row)))

    def blocks(self, *, tables: bool = True) -> Iterator[Block]:
        """Yield the kept blocks in the order of their points, on request without their tables."""
        last = "content" if tables else "NULL"
        select = f"SELECT start, stop, message, {last} FROM blocks ORDER BY start"
        with _reported(self.path):
            for start, stop, message, content in self._base.execute(select):
                *about, texts = json.loads(message)
                table: Table = {EVENTS: np.array(texts, object)} if texts else {}
                at = 0
                for column in self._plan.numeric if tables else ():
                    shape = self._plan.shape(column, stop - start)
                    numbers = np.frombuffer(content, count=math.prod(shape), offset=at)
                    table[column.name] = numbers.reshape(shape)
                    at += numbers.nbytes
                yield Block(start, stop, table, *about)

    def close(self, *, remove: bool = False) -> None:
        """Release the file, whose blocks remain for the next run; or remove it."""
        self._base.close()
        if remove:
            for suffix in ("", "-wal", "-journal"):
                self.path.with_name(f"{self.path.name}{suffix}").unlink(missing_ok=True)


@contextmanager
def _reported(path: Path) -> Iterator[None]:
    """Report errors of SQLite as errors of the file."""
    try:
        yield
    except sqlite3.DatabaseError as error:
        code = (getattr(error, "sqlite_errorcode", None) or sqlite3.SQLITE_CORRUPT) & 0xFF
        if code == sqlite3.SQLITE_NOTADB:
            raise ValueError(f'"{path}" {NOT_OURS}') from None
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise OSError(f'"{path}" is in use: the same sweep is running') from None
        damaged = "is damaged, remove it" if code == sqlite3.SQLITE_CORRUPT else "cannot be used"
        raise OSError(f'"{path}" {damaged}: {error}') from None


def _checksum(start: int, stop: int, message: str, content: bytes) -> int:
    """Return the CRC of a row."""
    return crc32(content, crc32(f"{start} {stop} {message}".encode()))
