"""What evaluations of the answers of a study came to, in its folder: a search that was broken off is read back."""

from __future__ import annotations

import errno
import hashlib
import os
import threading
import uuid
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from typing import BinaryIO

import numpy as np

from torsionnet.assembly.rows import FloatArray

HEAD = Struct("<4sI32s")
MARK = b"tnev"
CHECKSUM = hashlib.sha256().digest_size
ENDING = ".log"


@dataclass(frozen=True)
class LogPlace:
    """Where a record stands: the name of the file, its first byte, and how many there are."""

    file: str
    start: int
    length: int


@dataclass(eq=False)
class EvaluationLog:
    """Records of this process in a folder, in a file of its own that is made with the first of them.

    Records are key and data, with their length before and a checksum behind. Nothing is ever changed: a process that is
    killed leaves at most the beginning of a record at the end.
    """

    folder: Path
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _path: Path | None = None
    _file: BinaryIO | None = None

    def append(self, key: bytes, data: bytes, *, shared: bool = False) -> LogPlace:
        """Hand a record to the system, which writes it even if this process is killed.

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
        """The next record opens the file again."""
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
    """Keys of the records of a file, up to the first that is not whole."""
    with file.open("rb") as stream:
        start = 0
        while found := _record(stream):
            key, data = found
            length = HEAD.size + len(data) + CHECKSUM
            yield key, LogPlace(file.name, start, length)
            start += length


def record_at(folder: Path, place: LogPlace) -> tuple[bytes, bytes] | None:
    """Key and data of a record; None if it is not there any more, or was damaged."""
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
    rest = stream.read(length + CHECKSUM)
    data, checksum = rest[:length], rest[length:]
    return (key, data) if hashlib.sha256(head + data).digest() == checksum else None


ANSWERS = "answers"
"""The folder in that of the study."""
LARGEST = 2**30
"""Bytes that are kept; what comes after is calculated again by the next run."""


@dataclass(eq=False)
class EvaluationMemory:
    """Arrays by key, in the logs of all processes that ever wrote into a folder.

    Attributes
    ----------
    folder : Path
        Of the logs.
    log : EvaluationLog
        Of this process.
    size : int
        Bytes of all records.
    """

    folder: Path
    log: EvaluationLog
    size: int = 0
    _places: dict[bytes, LogPlace] = field(default_factory=dict)

    @classmethod
    def of(cls, study_folder: Path) -> EvaluationMemory:
        """All that is there now."""
        folder = study_folder / ANSWERS
        memory = cls(folder, EvaluationLog(folder))
        for file in sorted(folder.glob(f"*{ENDING}")):
            for key, place in records(file):
                memory._know(key, place)
        return memory

    @property
    def is_full(self) -> bool:
        return self.size >= LARGEST

    def get(self, key: bytes) -> FloatArray | None:
        """The numbers (n,) of a key; None where it is not known, or damaged."""
        place = self._places.get(key)
        return None if place is None else self.at(place, key)

    def at(self, place: LogPlace, key: bytes) -> FloatArray | None:
        """Numbers (n,) that another process has just written, or this one before."""
        found = record_at(self.folder, place)
        if found is None or found[0] != key:
            self._places.pop(key, None)
            return None
        self._know(key, place)
        return np.frombuffer(found[1]).copy()

    def put(self, key: bytes, values: FloatArray) -> None:
        """Keep an array, unless there is too much already."""
        if not self.is_full:
            self._know(key, self.log.append(key, array_bytes(values)))

    def _know(self, key: bytes, place: LogPlace) -> None:
        if key not in self._places:
            self.size += place.length
        self._places[key] = place


def array_bytes(values: FloatArray) -> bytes:
    """Of double numbers, row after row."""
    return np.ascontiguousarray(values, dtype=np.float64).tobytes()
