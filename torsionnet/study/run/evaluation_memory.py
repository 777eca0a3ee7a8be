"""Stored evaluations of the answers of a study in its folder, from which an interrupted search goes on."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import threading
import uuid
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from struct import Struct
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.run.study_folder import ANSWERS

if TYPE_CHECKING:
    from torsionnet.study.quantities.evaluator import Evaluator

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
        while found := _record(stream):
            key, data = found
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
        found = record_at(self.folder, place)
        if found is None or found[0] != key:
            self._places.pop(key, None)
            return None
        self._know(key, place)
        return np.frombuffer(found[1]).copy()

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
