"""How much work a study is, measured before it begins."""

from __future__ import annotations

import time
from dataclasses import dataclass
from math import ceil

from torsionnet.core.errors import UsageError
from torsionnet.study.study import Study

TRIED = {False: 64, True: 2}
"""Variants tried, by whether they are solved one by one."""
POINTS = 4_000_000
"""Points of responses in a chunk of a study that is solved together."""
SINGLY = 20
"""Variants in a chunk of one that is not: each may take a second, and all workers are to have some."""
MOST = 20_000
FILES = 100_000
"""Chunks of a study, about: of very many variants chunks are larger, as folders of more files are slow everywhere."""


@dataclass(frozen=True)
class Workload:
    """Attributes: ``count`` variants, ``seconds`` each on one core, ``chunk_size`` variants, whether ``singly``."""

    count: int
    seconds: float
    chunk_size: int
    singly: bool

    @classmethod
    def of(cls, study: Study) -> Workload:
        """Of some variants that are tried; the size of chunks follows from the study alone, not from what they took."""
        case = study.configurations[0]
        evaluator = study.evaluator(case)
        singly = evaluator.plan is None or any(one.singly for one in study.quantities.values())
        points = sum(len(one.measured(evaluator.model, study.quantities).points) for one in study.quantities.values())
        size = SINGLY if singly else max(AT_LEAST, min(MOST, POINTS // max(points, 1)))
        size = max(size, ceil(study.count / FILES))
        tried = min(TRIED[singly], study.space.count)
        values = study.space.at(evaluator.model).values(0, tried)
        evaluator(values)  # compiled code is compiled and loaded, plans are made
        began = time.perf_counter()
        evaluator(values)
        return cls(study.count, (time.perf_counter() - began) / tried, min(size, study.space.count), singly)

    @property
    def total(self) -> float:
        """Seconds on one core."""
        return self.count * self.seconds

    @property
    def words(self) -> str:
        """A sentence for the beginning."""
        how = "one by one, " if self.singly else ""
        number = f"{self.count:,}".replace(",", " ")
        return f"{number} variants, {how}about {shown_time(self.total)} on one core"

    def bearable(self, longest: float) -> None:
        """Refuse what takes longer than so many seconds."""
        if self.total > longest:
            raise UsageError(
                f"the study has {self.count:.4g} variants, about {shown_time(self.total)} on one core; vary fewer "
                "parameters in ranges and lists, draw samples instead (sampling: {method: sobol, count: 10000}), or "
                "let it take that long (--yes; longest= in Python)"
            )


AT_LEAST = 100


def shown_time(seconds: float) -> str:
    """A time as people say it.

    >>> shown_time(0.4), shown_time(150), shown_time(4e7)
    ('1 s', '2.5 min', '4.6e+02 days')
    """
    for size, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {name}" if seconds < 1e4 * size else f"{seconds / size:.0e} {name}"
    return f"{max(1, ceil(seconds))} s"
