"""A chunk of a study, calculated."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from torsionnet.core.atomic import write_bytes
from torsionnet.core.errors import UsageError
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.run.chunk_values import ChunkValues
from torsionnet.study.run.chunks import Chunk, Chunks
from torsionnet.study.run.joined_blocks import JoinedBlocks
from torsionnet.study.run.kept_part import counted_limits
from torsionnet.study.space.space import Space
from torsionnet.study.study import Study

AT_ONCE = 500
"""Variants of a chunk that are solved together; how a chunk is cut changes no value."""


def chunk_file(folder: Path, number: int) -> Path:
    """Where the values of a chunk are kept."""
    return folder / "chunks" / f"{number:08d}.npz"


@dataclass(frozen=True, eq=False)
class ChunkWork:
    """Calculates chunks and keeps them in a folder; it goes to other processes as the study alone.

    Attributes
    ----------
    study : Study
    chunks : Chunks
    every : int
        Of every so many variants the values are kept beside their sums; of all where it is 1.
    folder : Path or None
        None: the values themselves are the result.
    """

    study: Study
    chunks: Chunks
    every: int
    folder: Path | None
    _cases: dict[int, tuple[Evaluator, Space]] = field(default_factory=dict)

    def __reduce__(self) -> tuple[Callable[[bytes], ChunkWork], tuple[bytes]]:
        try:
            return _unpacked, (pickle.dumps((self.study, self.chunks, self.every, self.folder)),)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            text = "define functions of quantities at the top level of a module, or run it in one process"
            raise UsageError(f"the study cannot be handed to other processes ({error}); {text}") from None

    def __call__(self, number: int) -> ChunkValues | None:
        """The values of a chunk; None where they are in the folder."""
        found = self.calculated(self.chunks[number])
        if self.folder is None:
            return found
        write_bytes(chunk_file(self.folder, number), found.to_bytes(number))
        return None

    def calculated(self, chunk: Chunk) -> ChunkValues:
        """All quantities of the variants of a chunk."""
        if chunk.case not in self._cases:
            evaluator = self.study.evaluator(self.study.configurations[chunk.case])
            self._cases[chunk.case] = evaluator, self.study.space.at(evaluator.model)
        evaluator, space = self._cases[chunk.case]
        values = space.values(chunk.start, chunk.stop)
        parts = JoinedBlocks(self.every, counted_limits(self.study, self.every))
        for start in range(0, len(chunk), AT_ONCE):
            block = evaluator.block({name: column[start : start + AT_ONCE] for name, column in values.items()})
            parts.add(chunk.start + start, block, tuple(self.study.quantities))
        return parts.whole()


@lru_cache(maxsize=2)
def _unpacked(packed: bytes) -> ChunkWork:
    """The work in another process, which knows its plans from one chunk to the next."""
    return ChunkWork(*pickle.loads(packed))  # noqa: S301  (packed by the process that asks)
