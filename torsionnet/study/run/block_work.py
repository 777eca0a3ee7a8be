"""A block of variants that an answer has chosen, calculated by whoever has time."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.study.quantities.evaluator import Evaluator, Values
from torsionnet.study.run.evaluation_log import EvaluationLog, LogPlace
from torsionnet.study.run.evaluation_memory import array_bytes


@dataclass(frozen=True, eq=False)
class AskedBlock:
    """Variants ``values`` that stand at ``place`` of what is asked together; ``key`` tells them from all others."""

    place: int
    values: Values
    key: bytes

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def __str__(self) -> str:
        return f"a block of {len(self)} variants of an answer"


@dataclass(frozen=True, eq=False)
class BlockWork:
    """Calculates quantities ``names`` of blocks; another process writes them to a log, where they are kept.

    Attributes
    ----------
    evaluator : Evaluator
    names : tuple of str
    logs : Path or None
        Folder of logs; None: the values themselves are handed back.
    """

    evaluator: Evaluator
    names: tuple[str, ...]
    logs: Path | None
    _log: EvaluationLog | None = None

    def __reduce__(self) -> tuple[Callable[[bytes], BlockWork], tuple[bytes]]:
        return _unpacked, (self._packed,)

    @cached_property
    def _packed(self) -> bytes:
        try:
            return pickle.dumps((replace(self.evaluator, desk=None), self.names, self.logs))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            text = "define functions of quantities at the top level of a module, or run it in one process"
            raise UsageError(f"the study cannot be handed to other processes ({error}); {text}") from None

    def __call__(self, block: AskedBlock) -> FloatArray | LogPlace:
        """Rows of the block, or where another process has written them."""
        rows = self.evaluator.rows(block.values, self.names)
        return rows if self._log is None else self._log.append(block.key, array_bytes(rows), shared=True)

    def block(self, place: int, values: Values) -> AskedBlock:
        """Variants to be calculated."""
        return AskedBlock(place, values, key_of(self.evaluator, ("rows", *self.names), values))


def key_of(evaluator: Evaluator, what: tuple[str, ...], values: Mapping[str, FloatArray]) -> bytes:
    """Digest of all that an evaluation depends on beside the record of the folder."""
    asked = [evaluator.configuration, evaluator.method, evaluator.names, what, [*values]]
    digest = hashlib.sha256(json.dumps(asked).encode())
    for column in values.values():
        digest.update(array_bytes(np.asarray(column)))
    return digest.digest()


@lru_cache(maxsize=16)
def _unpacked(packed: bytes) -> BlockWork:
    """The work in another process, which knows its plans from one block to the next."""
    evaluator, names, logs = pickle.loads(packed)  # noqa: S301  (packed by the process that asks)
    return BlockWork(evaluator, names, logs, None if logs is None else _own_log(logs))


@lru_cache(maxsize=16)
def _own_log(folder: Path) -> EvaluationLog:
    """One for all that this process does in a folder."""
    return EvaluationLog(folder)
