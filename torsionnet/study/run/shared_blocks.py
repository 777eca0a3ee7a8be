"""Blocks of variants that answers ask for: read back, calculated here, or shared among workers where it is worth it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator, Values
from torsionnet.study.run.block_work import AskedBlock, BlockWork, key_of
from torsionnet.study.run.evaluation_memory import EvaluationMemory
from torsionnet.study.run.executor import Executor

BEGIN = 2.0
"""Seconds of work from which on others are asked: less than it takes them to start is done here."""
WORTH = 0.05
"""Seconds of one call that are worth handing out, which takes milliseconds where workers run already."""
TRIED = 2
"""Blocks of a kind that are calculated here, to see how long they take; the first one prepares what all need."""


@dataclass(eq=False)
class SharedBlocks:
    """A desk for evaluators; who calculates changes no value.

    Attributes
    ----------
    executor : Executor
        Who calculates where there is much to do.
    memory : EvaluationMemory or None
        What is known and kept.
    told : callable
        Called with a number of variants as soon as they are done.
    """

    executor: Executor
    memory: EvaluationMemory | None = None
    told: Callable[[int], None] = lambda _count: None
    _works: dict[tuple[object, ...], BlockWork] = field(default_factory=dict)
    _paces: dict[tuple[str, ...], _Pace] = field(default_factory=dict)
    _seconds: float = 0.0

    def rows(self, evaluator: Evaluator, blocks: Sequence[Values], names: tuple[str, ...]) -> list[FloatArray]:
        """Quantities ``names`` of every block."""
        work = self._work(evaluator, names)
        found: dict[int, FloatArray] = {}
        left: deque[AskedBlock] = deque()
        for place, values in enumerate(blocks):
            block = work.block(place, values)
            known = None if self.memory is None else self.memory.get(block.key)
            if known is None:
                left.append(block)
            else:
                found[place] = known.reshape(len(block), -1)
                self.told(len(block))
        for block, rows in self._calculated(work, left):
            found[block.place] = rows
            self.told(len(block))
        return [found[place] for place in range(len(blocks))]

    def once(
        self, evaluator: Evaluator, what: str, values: Mapping[str, float], work: Callable[[], FloatArray]
    ) -> FloatArray:
        """Numbers (n,) that ``work`` comes to, or came to before."""
        if self.memory is None:
            return work()
        key = key_of(evaluator, (what,), {name: np.array([value]) for name, value in values.items()})
        found = self.memory.get(key)
        if found is None:
            found = work()
            self.memory.put(key, found)
        return found

    def _work(self, evaluator: Evaluator, names: tuple[str, ...]) -> BlockWork:
        """The same for evaluators that are alike, with all that it has prepared."""
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
        for block, told in self.executor.map(work, left) if left else ():
            if isinstance(told, np.ndarray):
                self._keep(block, told)
                yield block, told
            else:
                known = None if self.memory is None else self.memory.at(told, block.key)
                yield block, self._here(work, block) if known is None else known.reshape(len(block), -1)

    def _is_worth_sharing(self, pace: _Pace, left: Sequence[AskedBlock]) -> bool:
        expected = pace.seconds * sum(map(len, left))
        return len(left) > 1 and pace.count >= TRIED and expected > WORTH and self._seconds + expected > BEGIN

    def _here(self, work: BlockWork, block: AskedBlock) -> FloatArray:
        rows = work.evaluator.rows(block.values, work.names)
        self._keep(block, rows)
        return rows

    def _keep(self, block: AskedBlock, rows: FloatArray) -> None:
        if self.memory is not None:
            self.memory.put(block.key, rows)


@dataclass
class _Pace:
    """Blocks calculated here, and the seconds that a variant took in the last of them."""

    count: int = 0
    seconds: float = 0.0

    def learn(self, seconds: float) -> None:
        self.count, self.seconds = self.count + 1, seconds
