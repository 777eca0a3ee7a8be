"""Amount of work of a study, measured on a few variants before it begins."""

from __future__ import annotations

import time
from dataclasses import dataclass
from math import ceil

from torsionnet.base.errors import UsageError
from torsionnet.study.study import Study

TIMED_VARIANTS = {False: 64, True: 2}
"""Number of variants that are timed, by whether they are solved one by one, which takes longer."""
CHUNK_POINTS = 4_000_000
"""Points of responses in a chunk of variants solved together, as more take longer between two saved chunks."""
SINGLE_CHUNK_SIZE = 20
"""Variants in a chunk solved one by one, as each may take a second, and all workers are to have some."""
MOST_CHUNK_SIZE = 20_000
"""Most variants in a chunk, so that little is lost when a run is stopped."""
MOST_FILES = 100_000
"""Number of chunks of a study, about, beyond which chunks become larger, as folders of more files are slow."""


@dataclass(frozen=True)
class Workload:
    """Amount of work of a study, its number of variants, seconds for each on one core, and size of chunks."""

    count: int
    seconds: float
    chunk_size: int
    singly: bool

    @classmethod
    def of(cls, study: Study) -> Workload:
        """Measure the amount of work of a study on some of its variants.

        The size of chunks follows from the study alone, not from the time.
        """
        case = study.configurations[0]
        evaluator = study.evaluator(case)
        singly = evaluator.plan is None or any(one.singly for one in study.quantities.values())
        points = sum(len(one.measured(evaluator.model, study.quantities).points) for one in study.quantities.values())
        size = (
            SINGLE_CHUNK_SIZE if singly else max(LEAST_CHUNK_SIZE, min(MOST_CHUNK_SIZE, CHUNK_POINTS // max(points, 1)))
        )
        size = max(size, ceil(study.count / MOST_FILES))
        tried = min(TIMED_VARIANTS[singly], study.space.count)
        values = study.space.at(evaluator.model).values(0, tried)
        evaluator(values)  # compiled code is compiled and loaded, plans are made
        began = time.perf_counter()
        evaluator(values)
        return cls(study.count, (time.perf_counter() - began) / tried, min(size, study.space.count), singly)

    @property
    def total(self) -> float:
        """Time of the whole study in seconds on one core."""
        return self.count * self.seconds

    @property
    def words(self) -> str:
        """Words for the number of variants and the time they take on one core."""
        how = "one by one, " if self.singly else ""
        number = f"{self.count:,}".replace(",", " ")
        return f"{number} variants, {how}about {shown_time(self.total)} on one core"

    def require_shorter_than(self, longest: float) -> None:
        """Refuse a study that takes longer than ``longest`` seconds on one core."""
        if self.total > longest:
            raise UsageError(
                f"the study has {self.count:.4g} variants, about {shown_time(self.total)} on one core; vary fewer "
                "parameters in ranges and lists, draw samples instead (sampling: {method: sobol, count: 10000}), or "
                "let it take that long (--yes; longest= in Python)"
            )


LEAST_CHUNK_SIZE = 100
"""Fewest variants in a chunk solved together, as with fewer the file of a chunk takes longer than its work."""


def shown_time(seconds: float) -> str:
    """Text of a time in seconds, in a suitable unit.

    >>> shown_time(0.4), shown_time(150), shown_time(4e7)
    ('1 s', '2.5 min', '4.6e+02 days')
    """
    for size, name in ((31557600.0, "years"), (86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {name}" if seconds < 1e4 * size else f"{seconds / size:.0e} {name}"
    return f"{max(1, ceil(seconds))} s"
