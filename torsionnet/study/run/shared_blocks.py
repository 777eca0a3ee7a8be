"""Calculation of the blocks of variants of answers, read back from the folder, done in this process or by workers."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator, Values
from torsionnet.study.quantities.variant_block import NOTHING_READ
from torsionnet.study.run.chunk_values import widest
from torsionnet.study.run.executor import Executor

if TYPE_CHECKING:
    from torsionnet.study.run.evaluation_memory import EvaluationMemory, LogPlace


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
        from torsionnet.study.run.evaluation_memory import array_bytes, own_log

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
        found: dict[int, FloatArray] = {}
        left: deque[AskedBlock] = deque()
        for place, values in enumerate(blocks):
            block = AskedBlock(place, values, b"" if self.memory is None else self.memory.key(evaluator, what, values))
            known = None if self.memory is None else self.memory.get(block.key)
            if known is None:
                left.append(block)
            else:
                found[place] = known.reshape(len(block), -1)
                self.progress(len(block))
        for block, rows in self._calculated(work, left):
            found[block.place] = rows
            self.progress(len(block))
        pairs = [self.read.get(evaluator.configuration, np.array(NOTHING_READ))]
        pairs += [rows[0, -2:] for rows in found.values()]
        self.read[evaluator.configuration] = widest(pairs)
        return [found[place] for place in range(len(blocks))]

    def once(
        self, evaluator: Evaluator, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        """Numbers (n,) that the function ``work`` returns for one variant, or returned before under the same key."""
        if self.memory is None:
            return work()
        key = self.memory.key(evaluator, (what,), {name: np.array([value]) for name, value in values.items()})
        found = self.memory.get(key)
        if found is None:
            found = work()
            self.memory.put(key, found)
        return found

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
