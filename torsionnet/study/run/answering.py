"""Calculation of a study and its answers, resumed from what is in its folder."""

from __future__ import annotations

import html
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.packages import drawn, thinned
from torsionnet.study.answers.answer import Conclusion, Conclusions, VariantValues
from torsionnet.study.quantities.evaluator import BlockCalculator, Evaluator
from torsionnet.study.run import run_chunks
from torsionnet.study.run.chunk_values import Chunks
from torsionnet.study.run.run_chunks import Executor, SerialExecutor, Workload, no_variants
from torsionnet.study.study import ShownUnits, Study, shown_units
from torsionnet.study.study_result import StudyResult, read_notes

if TYPE_CHECKING:
    from torsionnet.study.run.evaluation_memory import EvaluationMemory, SharedBlocks

# Choice of the processes or the cluster that calculate a study.

MOST_ON_WINDOWS = 61
"""Most worker processes on Windows, where a program can wait for 64 handles, some of which Python needs."""


@dataclass(frozen=True)
class Workers:
    """Number of processes of this machine, or address of a cluster, that calculate a study.

    Attributes
    ----------
    processes : int
        Number of processes of this machine; with 1 this process calculates.
    cluster : str
        Address of a cluster instead: ``tcp://host:port``, a scheduler file, or ``local:N``.
    announce : callable or None
        Called with the address of the dashboard of a cluster.
    waiting : callable
        Called with a sentence when a cluster has no workers yet, or none any more, and for how long.
    """

    processes: int = 1
    cluster: str = ""
    announce: Callable[[str], None] | None = None
    waiting: Callable[[str], None] = lambda _text: None

    def __post_init__(self) -> None:
        if self.processes < 1:
            raise UsageError("a study needs one worker at least", kind="out-of-range")
        if os.name == "nt" and self.processes > MOST_ON_WINDOWS:
            raise UsageError(
                f"Windows lets a program wait for {MOST_ON_WINDOWS} processes at most; give fewer workers",
                kind="too-large",
            )
        if self.processes > 1 and self.cluster:
            raise UsageError(
                "workers are processes or those of a cluster: give one of them", kind="contradicting-entries"
            )

    @contextmanager
    def executor(self, folder: Path | None) -> Iterator[Executor]:
        """Yield an executor on these workers, which ends with the ``with`` block."""
        if self.cluster:
            with self._of_cluster(folder) as executor:
                yield executor
        elif self.processes > 1:
            from torsionnet.study.run.process_pool import ProcessExecutor

            with ProcessExecutor(self.processes) as pool:
                yield pool
        else:
            yield SerialExecutor()

    @contextmanager
    def _of_cluster(self, folder: Path | None) -> Iterator[Executor]:
        from torsionnet.study.run.dask_executor import DaskExecutor, connected

        if folder is None:
            raise UsageError(
                "a study on a cluster needs a folder that all its workers see: -o FOLDER", kind="missing-entry"
            )
        with connected(self.cluster) as client:
            if self.announce is not None:
                self.announce(str(client.dashboard_link))
            yield DaskExecutor(client, folder, self.waiting)


@dataclass(frozen=True, eq=False, repr=False)
class SharedStudy(Study):
    """Study whose evaluators leave the calculation of blocks of variants to a :class:`BlockCalculator`."""

    calculator: BlockCalculator | None = None

    def evaluator(self, configuration: str = "", names: tuple[str, ...] = (), method: str = "") -> Evaluator:
        """Evaluator of the study's quantities in one configuration, which leaves blocks of variants to others."""
        return replace(super().evaluator(configuration, names, method), calculator=self.calculator)


Answering = Callable[[str, int, int | None], None]
"""Callback with the name of an answer, the number of variants calculated, and that of all, None if unknown."""


@dataclass(frozen=True, eq=False, repr=False)
class AnsweredStudy:
    """Result of a study together with the conclusions of its answers.

    Attributes
    ----------
    result : StudyResult or None
        Result of the study's own variants; None where only answers choose variants.
    conclusions : mapping
        Name of an answer -> its conclusion.
    unanswered : mapping
        Name of an answer that failed -> its error.
    units : ShownUnits
        Units in which a notebook draws the answers: those written in the study and in the model.
    notes : mapping
        Name of an answer -> its notes on tables over frequency that end before its own variants do.
    """

    result: StudyResult | None
    conclusions: Conclusions
    unanswered: Mapping[str, SolveError] = field(default_factory=dict)
    units: ShownUnits = field(default_factory=ShownUnits)
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def sentences(self, name: str) -> tuple[str, ...]:
        """Conclusion of an answer in words, with its notes."""
        return (*self.conclusions[name].sentences, *self.notes.get(name, ()))

    def __repr__(self) -> str:
        said = [f"{name}: {' '.join(conclusion.sentences)}" for name, conclusion in self.conclusions.items()]
        return f"<AnsweredStudy {'; '.join(said)}>"

    def _repr_html_(self) -> str:
        tables = [self.result.table()] if self.result is not None else []
        parts = [thinned(table).to_html() for table in tables]
        for name, conclusion in self.conclusions.items():
            said = (f"<p>{html.escape(text)}</p>" for text in self.sentences(name))
            parts += [thinned(conclusion.table()).to_html(), *said]
            parts.append(_picture(conclusion, self.units))
        parts += [f"<p>{html.escape(f'{name}: {error}')}</p>" for name, error in self.unanswered.items()]
        return "\n".join(parts)


def _picture(conclusion: Conclusion, units: ShownUnits) -> str:
    return drawn(lambda _: conclusion.figure(units=units))


def answer_study(
    study: Study,
    folder: str | os.PathLike[str] | None = None,
    *,
    workers: Workers | None = None,
    progress: run_chunks.Progress = lambda _done, _all: None,
    answering: Answering = lambda _name, _done, _all: None,
    announce: Callable[[Workload], None] = lambda _: None,
    longest: float = run_chunks.LONGEST_SECONDS,
) -> AnsweredStudy:
    """Calculate the variants of a study and draw the conclusions of its answers.

    What is in the folder is not calculated again, be it variants of the study or those that answers have chosen. The
    result is the same, to the last bit, whoever calculates and however often it was broken off.

    Parameters
    ----------
    study : Study
    folder : path, optional
        Folder that keeps results as soon as they are done; without one, nothing is kept.
    workers : Workers, optional
        Processes or cluster that calculate; default: this process.
    progress, announce, longest
        As for :func:`torsionnet.study.run_study`.
    answering : callable, optional
        Called with the name of an answer, the variants it has calculated, and how many it will, None if not known.

    Raises
    ------
    MissingExtraError
        An answer needs a package that is not installed.
    UsageError
        No variants, more than can be calculated in that time, or a folder that holds something else.
    SolveError
        A folder that cannot be written any more; what is in it stays valid.

    Examples
    --------
    >>> import torsionnet as tn
    >>> study = tn.study.define(tn.load("dmf_rig"), {"k_2": {"type": "normal", "deviation": "5 %"}},
    ...     {"f_1": {"type": "natural_frequency", "mode": 1}}, answers={"moves": {"type": "tornado"}})
    >>> print(*answer_study(study).conclusions["moves"].sentences)
    f_1, as given: k_2 moves it most, 6.553 to 7.617 Hz
    """
    for answer in study.answers.values():
        answer.require_extras()
    place = None if folder is None else Path(folder)
    unanswered = [name for name, own in study.answers.items() if own.of_variants]
    if not study.count and unanswered:
        raise UsageError(f"{', '.join(unanswered)}: {no_variants(study.space)}", kind="nothing-varies")
    with (workers or Workers()).executor(place) as executor:
        result = None
        if study.count or not study.answers:
            result = run_chunks.run_study(
                study, place, executor=executor, progress=progress, announce=announce, longest=longest
            )
        if not study.answers:
            return AnsweredStudy(result, {}, units=shown_units(study))
        with study_for_answers(study, place, executor) as (asked, calculator):
            return _answered(asked, result, calculator, answering)


@contextmanager
def study_for_answers(
    study: Study, folder: Path | None, executor: Executor | None = None
) -> Iterator[tuple[SharedStudy, SharedBlocks]]:
    """Yield the study with a calculator for its answers that reads back what is in the folder, and that calculator."""
    from torsionnet.study.run.evaluation_memory import SharedBlocks

    with _memory(study, folder) as memory:
        calculator = SharedBlocks(executor or SerialExecutor(), memory)
        entries = {entry.name: getattr(study, entry.name) for entry in fields(study)}
        yield SharedStudy(**entries, calculator=calculator), calculator


@contextmanager
def _memory(study: Study, folder: Path | None) -> Iterator[EvaluationMemory | None]:
    """Yield the stored evaluations of the answers, locked against other runs; None without a folder."""
    if folder is None or all(answer.of_variants for answer in study.answers.values()):
        yield None
        return
    from torsionnet.study.run.evaluation_memory import EvaluationMemory
    from torsionnet.study.run.study_folder import StudyFolder, locked, study_record, telling_write_errors

    place = StudyFolder(folder.resolve())
    with telling_write_errors(place.path):
        if not study.count:
            place.open(study_record(study, Chunks(len(study.configurations), 0, 1), every=1))
        with locked(place.path):
            memory = EvaluationMemory.of(place.path)
            try:
                yield memory
            finally:
                memory.log.close()


def _answered(
    study: SharedStudy, result: StudyResult | None, calculator: SharedBlocks, answering: Answering
) -> AnsweredStudy:
    conclusions: dict[str, Conclusion] = {}
    unanswered: dict[str, SolveError] = {}
    notes: dict[str, tuple[str, ...]] = {}
    for name, answer in study.answers.items():
        if not answer.of_variants:
            calculator.progress = _counted(answering, name, answer.variants(study))
        calculator.read.clear()
        try:
            conclusions[name] = answer.conclude(study, cast("VariantValues", result))  # None: it needs no variants
        except SolveError as error:
            unanswered[name] = error
        notes[name] = read_notes(study, calculator.read)
    return AnsweredStudy(result, conclusions, unanswered, shown_units(study), notes)


def _counted(answering: Answering, name: str, known: int | None) -> Callable[[int], None]:
    """Callback that adds up the variants of each block and reports how many an answer has taken so far."""
    done = 0

    def report(count: int) -> None:
        nonlocal done
        done += count
        answering(name, done, known)

    answering(name, 0, known)
    return report
