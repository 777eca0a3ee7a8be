"""Stored evaluations of the answers of a study in its folder, from which an interrupted search goes on."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import threading
import uuid
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from struct import Struct
from time import perf_counter
from typing import BinaryIO

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator, Values
from torsionnet.study.quantities.quantity import NOTHING_READ
from torsionnet.study.run.chunk_values import widest_span
from torsionnet.study.run.run_chunks import Executor
from torsionnet.study.run.study_folder import ANSWERS

HEAD = Struct("<4sI32s")
"""Layout of the head of a record of stored evaluations, its mark, the length of the data, and the key."""
MARK = b"tnev"
"""First bytes of every record of stored evaluations, by which a reader recognises it."""
CHECKSUM_BYTES = hashlib.sha256().digest_size
"""Length in bytes of the SHA-256 checksum behind a record of stored evaluations."""
ENDING = ".log"
"""Ending of the names of the log files of stored evaluations, by which all of them are found."""


@dataclass(frozen=True)
class LogPlace:
    """Place of a record of stored evaluations by the name of its file, its first byte and its number of bytes."""

    file: str
    start: int
    length: int


@dataclass(eq=False)
class EvaluationLog:
    """Log of the records that this process writes into a folder, a file of its own made with the first of them.

    Records are key and data, with their length before and a checksum behind. Nothing is ever changed: a process that is
    killed leaves at most the beginning of a record at the end.
    """

    folder: Path
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _path: Path | None = None
    _file: BinaryIO | None = None

    def append(self, key: bytes, data: bytes, *, shared: bool = False) -> LogPlace:
        """Write a record to the log and return its place.

        The system completes the write even if this process is killed.

        A ``shared`` record can be read on other machines as soon as this returns.
        """
        record = HEAD.pack(MARK, len(data), key) + data
        record += hashlib.sha256(record).digest()
        with self._lock:
            stream = self._opened()
            start = stream.seek(0, os.SEEK_END)
            if stream.write(record) != len(record):
                self._path = None  # what follows half a record would never be found
                self.close()
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            if shared:
                self.close()
        return LogPlace(Path(stream.name).name, start, len(record))

    def close(self) -> None:
        """Close the log file of this process, which the next record opens again."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def _opened(self) -> BinaryIO:
        if self._path is None or not self._path.exists():  # not there any more: the folder was removed meanwhile
            self.close()
            self.folder.mkdir(parents=True, exist_ok=True)
            self._path = self.folder / f"{uuid.uuid4().hex}{ENDING}"
        if self._file is None:
            self._file = self._path.open("ab", buffering=0)
        return self._file


def records(file: Path) -> Iterator[tuple[bytes, LogPlace]]:
    """Yield the keys and places of the records of a log file, up to the first incomplete one."""
    with file.open("rb") as stream:
        start = 0
        while record := _record(stream):
            key, data = record
            length = HEAD.size + len(data) + CHECKSUM_BYTES
            yield key, LogPlace(file.name, start, length)
            start += length


def record_at(folder: Path, place: LogPlace) -> tuple[bytes, bytes] | None:
    """Key and data of the record at a place, None if it is missing or damaged."""
    try:
        with (folder / place.file).open("rb") as stream:
            stream.seek(place.start)
            return _record(stream)
    except OSError:
        return None


def _record(stream: BinaryIO) -> tuple[bytes, bytes] | None:
    head = stream.read(HEAD.size)
    if len(head) < HEAD.size:
        return None
    mark, length, key = HEAD.unpack(head)
    if mark != MARK or length > os.fstat(stream.fileno()).st_size:
        return None
    rest = stream.read(length + CHECKSUM_BYTES)
    data, checksum = rest[:length], rest[length:]
    return (key, data) if hashlib.sha256(head + data).digest() == checksum else None


MOST_LOG_BYTES = 2**30
"""Most bytes of all logs, which bounds the disk space, so that the next run calculates evaluations beyond again."""


@dataclass(eq=False)
class EvaluationMemory:
    """Store of number arrays by key, read from the logs of all processes that ever wrote into a folder.

    Attributes
    ----------
    folder : Path
        Folder of the logs.
    log : EvaluationLog
        Log of this process.
    size : int
        Number of bytes of all records.
    """

    folder: Path
    log: EvaluationLog
    size: int = 0
    _places: dict[bytes, LogPlace] = field(default_factory=dict)

    @classmethod
    def of(cls, study_folder: Path) -> EvaluationMemory:
        """Store of evaluations with all records in the folder of a study."""
        folder = study_folder / ANSWERS
        memory = cls(folder, EvaluationLog(folder))
        for file in sorted(folder.glob(f"*{ENDING}")):
            for key, place in records(file):
                memory._know(key, place)
        return memory

    @staticmethod
    def key(evaluator: Evaluator, what: tuple[str, ...], values: Mapping[str, FloatArray]) -> bytes:
        """Key of an evaluation, a digest of all it depends on beside the record of the folder."""
        asked = [evaluator.configuration, evaluator.method, evaluator.names, what, [*values]]
        digest = hashlib.sha256(json.dumps(asked).encode())
        for column in values.values():
            digest.update(array_bytes(np.asarray(column)))
        return digest.digest()

    @property
    def is_full(self) -> bool:
        return self.size >= MOST_LOG_BYTES

    def get(self, key: bytes) -> FloatArray | None:
        """Numbers (n,) stored under a key, None where it is unknown or damaged."""
        place = self._places.get(key)
        return None if place is None else self.at(place, key)

    def at(self, place: LogPlace, key: bytes) -> FloatArray | None:
        """Numbers (n,) of the record of a key at a place, perhaps of another process, None where it is damaged."""
        record = record_at(self.folder, place)
        if record is None or record[0] != key:
            self._places.pop(key, None)
            return None
        self._know(key, place)
        return np.frombuffer(record[1]).copy()

    def put(self, key: bytes, values: FloatArray) -> None:
        """Store an array of numbers under a key, unless the store is full."""
        if not self.is_full:
            self._know(key, self.log.append(key, array_bytes(values)))

    def _know(self, key: bytes, place: LogPlace) -> None:
        if key not in self._places:
            self.size += place.length
        self._places[key] = place


def array_bytes(values: FloatArray) -> bytes:
    """Bytes of an array as double-precision numbers, row after row."""
    return np.ascontiguousarray(values, dtype=np.float64).tobytes()


@lru_cache(maxsize=16)
def own_log(folder: Path) -> EvaluationLog:
    """Log of stored evaluations of this process in a folder, the same one at every call."""
    return EvaluationLog(folder)


# Calculation of the blocks of variants of answers, read back from the folder, done in this process or by workers.


@dataclass(frozen=True, eq=False)
class AskedBlock:
    """Block of variants that an answer asks for, with its place among those asked together, its values and key."""

    place: int
    values: Values
    key: bytes

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def __str__(self) -> str:
        return f"a block of {len(self)} variants of an answer"


@dataclass(frozen=True, eq=False)
class BlockWork:
    """Function that calculates quantities ``names`` of a block of variants; in another process it writes them to a log.

    Attributes
    ----------
    evaluator : Evaluator
    names : tuple of str
    logs : Path or None
        Folder of logs; None: the values themselves are returned.
    elsewhere : bool
        Whether this is another process than that of the study, which keeps what it calculates itself.
    """

    evaluator: Evaluator
    names: tuple[str, ...]
    logs: Path | None
    elsewhere: bool = False

    def __reduce__(self) -> tuple[type[BlockWork], tuple[Evaluator, tuple[str, ...], Path | None, bool]]:
        return BlockWork, (replace(self.evaluator, calculator=None), self.names, self.logs, True)

    def __call__(self, block: AskedBlock) -> FloatArray | LogPlace:
        """Rows of the block (n, n_points of all + 2), or the place of the record where they were written."""
        rows = self.evaluator.rows(block.values, self.names)
        if self.logs is None or not self.elsewhere:
            return rows

        return own_log(self.logs).append(block.key, array_bytes(rows), shared=True)


LEAST_SHARED_SECONDS = 2.0
"""Seconds of an answer's work from which workers are used, as less is done before their processes have started."""
LEAST_CALL_SECONDS = 0.05
"""Seconds of one call from which its blocks of variants go to workers, as handing them out takes milliseconds."""
TIMED_BLOCKS = 2
"""Number of blocks calculated here to measure their time, of which the first one prepares plans for the others."""


@dataclass(eq=False)
class SharedBlocks:
    """Block calculator of evaluators that shares the work among workers, which changes no value.

    Attributes
    ----------
    executor : Executor
        Calculates blocks where there are many.
    memory : EvaluationMemory or None
        Stored evaluations.
    progress : callable
        Called with a number of variants as soon as they are done.
    read : dict
        Configuration -> lowest and highest frequency in Hz at which laws over frequency were read, (2,).
    """

    executor: Executor
    memory: EvaluationMemory | None = None
    progress: Callable[[int], None] = lambda _count: None
    read: dict[str, FloatArray] = field(default_factory=dict)
    _works: dict[tuple[object, ...], BlockWork] = field(default_factory=dict)
    _paces: dict[tuple[str, ...], _Pace] = field(default_factory=dict)
    _seconds: float = 0.0

    def rows(self, evaluator: Evaluator, blocks: Sequence[Values], names: tuple[str, ...]) -> list[FloatArray]:
        """Quantities ``names`` of every block of variants, as :meth:`Evaluator.rows` returns them."""
        work, what = self._work(evaluator, names), ("rows and frequencies read", *names)
        numbers: dict[int, FloatArray] = {}
        left: deque[AskedBlock] = deque()
        for place, values in enumerate(blocks):
            block = AskedBlock(place, values, b"" if self.memory is None else self.memory.key(evaluator, what, values))
            known = None if self.memory is None else self.memory.get(block.key)
            if known is None:
                left.append(block)
            else:
                numbers[place] = known.reshape(len(block), -1)
                self.progress(len(block))
        for block, rows in self._calculated(work, left):
            numbers[block.place] = rows
            self.progress(len(block))
        pairs = [self.read.get(evaluator.configuration, np.array(NOTHING_READ))]
        pairs += [rows[0, -2:] for rows in numbers.values()]
        self.read[evaluator.configuration] = widest_span(pairs)
        return [numbers[place] for place in range(len(blocks))]

    def once(
        self, evaluator: Evaluator, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        """Numbers (n,) that the function ``work`` returns for one variant, or returned before under the same key."""
        if self.memory is None:
            return work()
        key = self.memory.key(evaluator, (what,), {name: np.array([value]) for name, value in values.items()})
        numbers = self.memory.get(key)
        if numbers is None:
            numbers = work()
            self.memory.put(key, numbers)
        return numbers

    def _work(self, evaluator: Evaluator, names: tuple[str, ...]) -> BlockWork:
        """Function that calculates blocks, the same one for evaluators with equal configuration, names and method."""
        logs = None if self.memory is None or self.memory.is_full else self.memory.folder
        key = (evaluator.configuration, evaluator.names, evaluator.method, names, logs)
        return self._works.setdefault(key, BlockWork(evaluator, names, logs))

    def _calculated(self, work: BlockWork, left: deque[AskedBlock]) -> Iterator[tuple[AskedBlock, FloatArray]]:
        pace = self._paces.setdefault(work.names, _Pace())
        while left and not self._is_worth_sharing(pace, left):
            block = left.popleft()
            began = perf_counter()
            rows = self._here(work, block)
            pace.learn((perf_counter() - began) / len(block))
            self._seconds += perf_counter() - began
            yield block, rows
        for block, result in self.executor.map(work, left) if left else ():
            if isinstance(result, np.ndarray):
                self._keep(block, result)
                yield block, result
            else:
                known = None if self.memory is None else self.memory.at(result, block.key)
                yield block, self._here(work, block) if known is None else known.reshape(len(block), -1)

    def _is_worth_sharing(self, pace: _Pace, left: Sequence[AskedBlock]) -> bool:
        expected = pace.seconds * sum(map(len, left))
        return (
            len(left) > 1
            and pace.count >= TIMED_BLOCKS
            and expected > LEAST_CALL_SECONDS
            and self._seconds + expected > LEAST_SHARED_SECONDS
        )

    def _here(self, work: BlockWork, block: AskedBlock) -> FloatArray:
        rows = work.evaluator.rows(block.values, work.names)
        self._keep(block, rows)
        return rows

    def _keep(self, block: AskedBlock, rows: FloatArray) -> None:
        if self.memory is not None:
            self.memory.put(block.key, rows)


@dataclass
class _Pace:
    """Number of blocks of variants timed, and seconds for each variant in the last of them."""

    count: int = 0
    seconds: float = 0.0

    def learn(self, seconds: float) -> None:
        self.count, self.seconds = self.count + 1, seconds
