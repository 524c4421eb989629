"""The work file of a sweep: finished blocks, one behind the other, that survive a killed process.

A record is its length, its CRC and its content; the first one tells which sweep it is, each other one is a
block. What a kill or a full disk has cut, or what was damaged, is left out when the file is opened, and
computed again.
"""

import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from struct import Struct
from typing import Any
from zlib import crc32

import numpy as np

from kvtheory.export import named
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import EVENTS, Plan, Table

MARK = b"kvtheory sweep 4\n"
"""The first line of a work file in this layout."""
HEAD = Struct("<QI")
"""Length and CRC of a record."""
NOT_OURS = "is not a work file of a sweep; it is left as it is: remove it or choose another name"


class WorkFile:
    """The blocks of an open work file."""

    def __init__(self, plan: Plan, file: Any) -> None:
        self._plan, self._file = plan, file
        self._kept: dict[int, tuple[Block, int, int]] = {}

    @property
    def done(self) -> list[Block]:
        """The blocks in the order of their points, without their tables."""
        return [self._kept[start][0] for start in sorted(self._kept)]

    def __iter__(self) -> Iterator[Block]:
        """Read the blocks in the order of their points."""
        for _, (_, end, length) in sorted(self._kept.items()):
            self._file.seek(end - length)
            yield _unpacked(self._plan, self._file.read(length))

    def keep(self, block: Block) -> None:
        """Keep a block, which a killed process does not lose when this returns."""
        content = _packed(self._plan, block)
        self.append(content)
        self.note(self._file.tell(), content)

    def note(self, end: int, content: bytes) -> None:
        """Remember a block that the file holds."""
        block = replace(_unpacked(self._plan, content), table={})
        self._kept[block.start] = block, end, len(content)

    def append(self, content: bytes, mark: bytes = b"") -> None:
        """Write a record, without waiting for the disk: after a power cut its CRC tells."""
        left = memoryview(mark + HEAD.pack(len(content), crc32(content)) + content)
        with named(Path(self._file.name)):
            while left:
                left = left[self._file.write(left) :]


@contextmanager
def opened(path: Path, plan: Plan, *, anew: bool = False) -> Iterator[WorkFile]:
    """Open the work file of a sweep, which one process at a time may do.

    A file of another sweep or program raises `ValueError` and is left as it is; with `anew`, unfinished work
    of another sweep is dropped. A file that cannot be used, or is in use, raises `OSError`.
    """
    with named(path):
        file = path.open("a+b", buffering=0)
    with file:
        try:
            from fcntl import LOCK_EX, LOCK_NB, flock

            flock(file, LOCK_EX | LOCK_NB)
        except BlockingIOError:
            raise OSError(f'"{path}" is in use: the same sweep is running') from None
        except (ImportError, OSError):
            pass  # not every system, nor every file system, has such locks
        file.seek(0)
        if not MARK.startswith(file.read(len(MARK))):
            raise ValueError(f'"{path}" {NOT_OURS}')
        found, work = records(file), WorkFile(plan, file)
        end, record = next(found, (0, b""))
        differing = plan.differences(record) if record else []
        if differing and not anew:
            why = f"it differs in {', '.join(differing)}"
            what = "finish that one, remove the file, or choose another name"
            raise ValueError(f'"{path}" is the unfinished work of another sweep: {why}; {what}')
        if differing or not record:
            file.truncate(0)
            work.append(json.dumps(plan.record).encode(), MARK)
        else:
            for end, content in found:
                work.note(end, content)
            file.truncate(end)
        yield work


def records(file: Any) -> Iterator[tuple[int, bytes]]:
    """Yield the end and the content of each whole record of a work file."""
    at, size = len(MARK) + HEAD.size, file.seek(0, os.SEEK_END)
    while at <= size:
        file.seek(at - HEAD.size)
        length, crc = HEAD.unpack(file.read(HEAD.size))
        content = file.read(min(length, size - at))
        if content and crc32(content) == crc:
            yield at + length, content
        at += length + HEAD.size


def _packed(plan: Plan, block: Block) -> bytes:
    """Return a block as a line of JSON, and the numbers of its columns."""
    texts = block.table[EVENTS].tolist() if plan.texts else []
    about = block.start, block.stop, block.failures, block.statements, block.errors, texts
    numbers = (np.ascontiguousarray(block.table[column.name]).data for column in plan.numeric)
    return b"".join([json.dumps(about).encode(), b"\n", *numbers])


def _unpacked(plan: Plan, content: bytes) -> Block:
    line, _, numbers = content.partition(b"\n")
    start, stop, *about, texts = json.loads(line)
    table: Table = {EVENTS: np.array(texts, object)} if texts else {}
    left = np.frombuffer(numbers)
    for column in plan.numeric:
        shape = plan.shape(column, stop - start)
        part, left = np.split(left, [math.prod(shape)])
        table[column.name] = part.reshape(shape)
    return Block(start, stop, table, *about)
