"""Folder of a study with its record and the chunks of variants that are done."""

from __future__ import annotations

import errno
import json
import os
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import SolveError, TorsionnetWarning, UsageError
from torsionnet.study.run.calculating import chunk_file
from torsionnet.study.run.chunk_values import ChunkValues, DamagedChunk
from torsionnet.study.run.chunks import Chunks
from torsionnet.study.run.evaluation_memory import ANSWERS
from torsionnet.study.run.study_record import differ_by_installation, record_differences, record_text

RECORD = "study.json"
"""Name of the file with the record of the study in its folder."""
TEMPORARY_SECONDS = 3600.0
"""Age in seconds from which a temporary file is removed, as younger ones may still be written by another process."""


@dataclass(frozen=True)
class StudyFolder:
    """Folder of a study with ``study.json``, ``chunks/``, and ``answers/`` with the evaluations of answers.

    The folder can be copied and moved as a whole.
    """

    path: Path

    def open(self, record: dict[str, Any]) -> None:
        """Make the folder of the study, or refuse one that belongs to another study.

        Raises
        ------
        UsageError
            The folder holds results of something else, or cannot be written.
        """
        try:
            (self.path / "chunks").mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(f"{self.path} cannot be a folder of results: {error.strerror}") from None
        file = self.path / RECORD
        if not file.exists():
            if any(any((self.path / part).glob("*.*")) for part in ("chunks", ANSWERS)):
                text = f"{self.path} holds results but no {RECORD}, which says what study they are of"
                raise UsageError(f"{text}; choose another folder, or put a copy of {RECORD} back")
            write_text(file, record_text(record))
            return
        kept, wanted = self.record(), json.loads(record_text(record))
        differing = record_differences(kept, wanted)
        if differing and self._is_complete(wanted) and differ_by_installation(kept, wanted):
            text = f"{self.path} is complete, and is read as it was calculated elsewhere: {'; '.join(differing)}"
            warnings.warn(text, TorsionnetWarning, stacklevel=2)
            return
        if differing:
            raise UsageError(
                f"{self.path} holds results of something else; " + "; ".join(differing) + ". "
                "Nothing in it was changed: choose another folder, or go back to what it was calculated with"
            )

    def _is_complete(self, record: dict[str, Any]) -> bool:
        """Whether there is nothing left to calculate, so that results of two versions cannot be mixed."""
        total = Chunks(**record["chunks"]).total
        return total > 0 and all(self.chunk(number) is not None for number in range(total))

    def record(self) -> dict[str, Any]:
        """Record of the study that the chunks in the folder belong to."""
        try:
            found = json.loads((self.path / RECORD).read_text(encoding="utf-8"))
            if not isinstance(found, dict):
                raise ValueError("it is not the record of a study")
        except (OSError, ValueError) as error:
            raise UsageError(
                f"{self.path / RECORD} cannot be read: {error}. Nothing else says which study the results beside "
                "it are of; choose another folder, or put a copy of it back"
            ) from None
        return found

    def chunk(self, number: int) -> ChunkValues | None:
        """Results of a chunk of variants, None where its file is missing or damaged."""
        try:
            return ChunkValues.from_bytes(chunk_file(self.path, number).read_bytes(), number)
        except (OSError, DamagedChunk):
            return None

    def remove_temporary_files(self) -> None:
        """Remove temporary files older than :data:`TEMPORARY_SECONDS`, which writers that were killed have left."""
        for entry in (self.path / "chunks").glob(".*"):
            with suppress(OSError):
                if time.time() - entry.stat().st_mtime > TEMPORARY_SECONDS:
                    entry.unlink()

    def chunk_numbers(self, total: int) -> list[int]:
        """Numbers of the chunks that have a file in the folder, complete or not."""
        names = [entry.name for entry in os.scandir(self.path / "chunks")]
        numbers = (int(name[:-4]) for name in names if name.endswith(".npz") and name[:-4].isdigit())
        return sorted(number for number in numbers if number < total)


@contextmanager
def writing(folder: Path) -> Iterator[None]:
    """Turn an error of writing in the study's folder into one that says that its chunks remain."""
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        why = "the disk is full" if full else f"it cannot be written: {error.strerror or error}"
        raise SolveError(
            f"{folder}: {why}; the chunks in it are whole, and the study goes on from there when it is run again"
        ) from error
