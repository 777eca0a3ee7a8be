"""What evaluations of the answers of a study came to, in its folder: a search that was broken off is read back."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.run.evaluation_log import ENDING, EvaluationLog, LogPlace, record_at, records

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
