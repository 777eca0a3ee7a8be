"""Commands that change parameters of a model: ``fit`` finds them in tests, ``study`` varies them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import OutputFile, OutputFolder, argument, file_option, option
from torsionnet.app.cli.terminal import message, print_faults
from torsionnet.base.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.base.table import Table
    from torsionnet.study.answers.answer import Conclusion, Conclusions
    from torsionnet.study.run.answering import AnsweredStudy
    from torsionnet.study.run.run_chunks import Workload
    from torsionnet.study.study import Study
    from torsionnet.study.study_result import StudyResult


# Command ``torsionnet fit``, which finds parameters of a model from records of tests.

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.identification.fit_file import FitPlan
    from torsionnet.identification.ranking import Ranking

    Intervals = dict[str, tuple[float, float]]

ENDINGS = (".yaml", ".yml")


class FitCommand(Command):
    """Find parameters of a model from records of tests, over several configurations at once.

    FIT is a YAML file: model, measurements (record or response, output, input, configuration, band; or orders, output,
    orders_used, speeds), parameters (start, bounds, prior, per_configuration), settings of the estimate.

    \b
    torsionnet fit gears.yaml --plot fit.png -o result.yaml
    """

    forms = TABLE
    picture = "test, model and residuals"

    file: str = argument("FIT")
    profile: bool = option(
        "--profile", help="Intervals by profile likelihood too: slower, and right where they are lopsided."
    )
    rank: bool = option(
        "--rank", help="Rank which value, freed alone, would explain a misfit; FIT may name no parameters then."
    )
    output_file: str | None = file_option("Write the result as YAML.", ENDINGS)
    model_file: str | None = option(
        "--write-model", type=OutputFile(ENDINGS), help="Write the model with the values found."
    )

    def answer(self) -> Answer:
        from torsionnet.app.cli.terminal import progress
        from torsionnet.base.conventions import Conventions
        from torsionnet.identification import identify, rank_causes
        from torsionnet.identification.fit_file import load_fit_plan
        from torsionnet.identification.ranking import FitAnswer
        from torsionnet.io import read_frequency_response

        with progress("fitting", None):
            plan = load_fit_plan(self.file, read_frequency_response, ranks_alone=self.rank)
            _announce(plan)
            # Without parameters nothing is fitted: causes are tried on the model as it is.
            if not plan.parameters:
                return self._ranked(rank_causes(plan.model, plan.measurements, residual=_residual(plan)))
            fit = identify(plan.model, plan.measurements, plan.parameters, **plan.options)
            profiles = {name: fit.profile(name) for name in fit.values} if self.profile else {}
            ranking = rank_causes(fit) if self.rank else None
        for verdict in fit.verdicts:
            message("warning", verdict)
        table = fit.table(true=plan.true or None)
        return Answer(
            screen=lambda: _screen(table, profiles, ranking),
            data=lambda: FitAnswer(fit, ranking, profiles, plan.true),
            csv=lambda: [("", table)],
            files=[
                (self.output_file, fit.to_yaml),
                (self.model_file, lambda file: fit.configured(plan.model).to_yaml(file)),
            ],
            figures=lambda plot: [("", plot.fit(fit, conventions=Conventions(angle="deg")))],
        )

    def _ranked(self, ranking: Ranking) -> Answer:
        """Answer of the command with the ranking of causes alone, for a fit file without parameters."""
        asked = {
            "--profile": self.profile,
            "-o": self.output_file,
            "--write-model": self.model_file,
            "--plot": self.output.plot_file,
        }
        if named := [option for option, given in asked.items() if given]:
            raise UsageError(
                f"{' and '.join(named)}: the fit file names no parameters, so that parameters are only "
                "ranked; name those to be fitted under parameters: in it, or leave these options out",
                kind="needless-entry",
            )
        table = ranking.table()
        return Answer(screen=lambda: [table], data=lambda: ranking, csv=lambda: [("", table)])


def _residual(plan: FitPlan) -> str:
    return str(plan.options.get("residual") or "complex")


def _screen(table: Table, profiles: Intervals, ranking: Ranking | None) -> Iterator[Table | tuple[Any, ...]]:
    yield table
    for name, (low, high) in profiles.items():
        yield (f"{name}: 95 % by profile likelihood from ", float(low), " to ", float(high))
    if ranking is not None:
        yield ranking.table()


def _announce(plan: FitPlan) -> None:
    """Print notes on the decimation of records, and on the memory of the fit if that is large."""
    from torsionnet.app.cli.terminal import note_memory
    from torsionnet.identification.residuals.measurement_blocks import memory_demand, total_memory
    from torsionnet.signals.recording import Recording
    from torsionnet.signals.resampling import usable_up_to

    demands = []
    for measurement in plan.measurements:
        record, settings = measurement.data, measurement.settings
        if isinstance(record, Recording) and settings is not None:
            limit = usable_up_to(record.sampling_rate, settings.decimation)
            if settings.decimation > 1:
                rate = record.sampling_rate / settings.decimation
                message("note", f"{measurement.label}: decimated by {settings.decimation} to {rate:g} Hz")
            demands.append(memory_demand(record, settings, measurement.band or (0.0, limit)))
    note_memory(total_memory(demands), "narrower bands, or shorter windows (seconds), take less")


# Command ``torsionnet study``, which calculates a drivetrain over tolerances, conditions and choices.

LONG_STUDY = 10.0
"""Seconds of calculation from which a study's duration is announced before it starts."""


LONGEST_TABLE, LINES_OF_LONG_TABLE = 100, 10
"""Rows up to which a table is printed whole, and rows printed of a longer one."""


class StudyCommand(Command):
    """Calculate a drivetrain over tolerances, conditions and choices of its parameters.

    STUDY is a YAML file, or one of the library: model, what varies, what is asked of every variant, limits, what is to
    be concluded. What is in the folder of -o already is not calculated again, so that a study that was broken off goes
    on.

    \b
    torsionnet study amt_tolerances --plot tolerances.png
    torsionnet study tolerances.yaml -o results --workers 2
    torsionnet study tolerances.yaml -o /shared/results --cluster tcp://node7:8786
    """

    forms = TABLE
    picture = "the answers, or else the quantities over all variants"

    file: str = argument("STUDY")
    folder: str | None = option(
        "-o", "--write", type=OutputFolder(), help="Keep every part of the result as soon as it is done."
    )
    processes: int = option("--workers", type=click.IntRange(1), default=1, help="Processes; default: 1.")
    cluster: str = option(
        "--cluster",
        metavar="WHERE",
        default="",
        help="Workers of dask.distributed: tcp://host:port, a scheduler file, or local:N.",
    )
    anyway: bool = option("--yes", help="Begin even if it takes weeks.")
    variants_file: str | None = option(
        "--variants",
        type=OutputFile((".csv", ".parquet")),
        help="Write parameters and values of every variant; of very many, of an even part.",
    )

    def answer(self) -> Answer:
        from torsionnet.study.study import load_study

        if (self.variants_file or "").endswith(".parquet"):
            from torsionnet.signals.formats.extras import require_extra

            require_extra("parquet")
        study = load_study(self.file)
        print_faults(study.findings)
        answered = self._answered(study)
        result, conclusions = answered.result, answered.conclusions
        for name, error in answered.unanswered.items():
            message("error", f"{name}: {error}")
        return Answer(
            screen=lambda: _study_screen(answered),
            data=lambda: _data(study, answered),
            csv=lambda: _tables(result, conclusions),
            files=[(self.variants_file, lambda file: _write_variants(study, result, file))],
            figures=lambda _: _figures(study, conclusions or _usual(study, result)),
            exit_code=max((error.exit_code for error in answered.unanswered.values()), default=0),
        )

    def _answered(self, study: Study) -> AnsweredStudy:
        from torsionnet.app.cli.terminal import stages
        from torsionnet.study.run.answering import Workers, answer_study
        from torsionnet.study.run.run_chunks import LONGEST_SECONDS

        workers = Workers(
            self.processes,
            self.cluster,
            announce=lambda link: message("dashboard", link),
            waiting=lambda text: message("note", text),
        )
        with stages() as show:
            try:
                return answer_study(
                    study,
                    self._place,
                    workers=workers,
                    progress=lambda done, total: show("calculating", done, total),
                    answering=lambda name, done, total: show(name, done, total, _counted(name, done)),
                    announce=_announce_study,
                    longest=float("inf") if self.anyway else LONGEST_SECONDS * workers.processes,
                )
            except KeyboardInterrupt:
                # Chunks of a study are stored as they are done, so that a stop loses at most one.
                folder = self._place
                kept = f"what is done is in {folder}, and the same command goes on from there"
                if folder is None:
                    kept = (
                        "nothing is kept without a folder, and with -o FOLDER a study goes on from where it was stopped"
                    )
                message("note", f"stopped; {kept}")
                raise

    @property
    def _place(self) -> Path | None:
        return Path(self.folder) if self.folder else None


def _counted(answer: str, done: int) -> str:
    return f"{answer}: {done:,} variants".replace(",", " ") if done else answer


def _announce_study(workload: Workload) -> None:
    if workload.total > LONG_STUDY:
        message("note", workload.words)


def _data(study: Study, answered: AnsweredStudy) -> object:
    from torsionnet.app.cli.output import study_json

    return study_json(study, answered)


def _study_screen(answered: AnsweredStudy) -> Iterator[Table | str]:
    if answered.result is not None:
        yield answered.result.table()
    for name, conclusion in answered.conclusions.items():
        yield ""
        table = conclusion.table()
        yield _beginning(table)
        yield from (sentence for sentence in answered.sentences(name) if sentence not in table.notes)


def _beginning(table: Table) -> Table:
    """Copy of a table cut to its first rows if it is long, with a note on where the rest is."""
    from dataclasses import replace

    total = len(table.rows)
    if total <= LONGEST_TABLE:
        return table
    left_out = f"{LINES_OF_LONG_TABLE} of {total} lines; --csv FILE and --json have all"
    return replace(table, rows=table.rows[:LINES_OF_LONG_TABLE], notes=(left_out, *table.notes))


def _tables(result: StudyResult | None, conclusions: Conclusions) -> list[tuple[str, Table]]:
    tables = [("summary", result.table())] if result is not None else []
    return [*tables, *((name, conclusion.table()) for name, conclusion in conclusions.items())]


def _usual(study: Study, result: StudyResult | None) -> Conclusions:
    """Pictures that a study without answers gets as its conclusions.

    Percentile bands of curves, scatter of numbers over parameters.
    """
    from contextlib import suppress

    from torsionnet.base.errors import SolveError, UsageError
    from torsionnet.study.answers.map_and_scatter import Scatter
    from torsionnet.study.answers.yield_answer import PercentileBands

    if result is None:
        return {}
    curves = [name for (_, name), summary in result.summaries.items() if summary.measure.is_curve]
    conclusions: dict[str, Conclusion] = {}
    for name in dict.fromkeys(curves):
        conclusions[name] = PercentileBands(quantity=name).conclude(study, result)
    if len(conclusions) < len(study.quantities):
        with suppress(SolveError):  # too few variants for a correlation
            conclusions["scatter"] = Scatter().conclude(study, result)
    if not conclusions:
        raise UsageError(
            "there is nothing to draw: the study has no curve, no answer, "
            "and too few variants for its numbers; add one of them",
            kind="missing-entry",
        )
    return conclusions


def _figures(study: Study, conclusions: Conclusions) -> list[tuple[str, Figure]]:
    from torsionnet.study.study import shown_units

    units = shown_units(study)
    return [(name, conclusion.figure(units=units)) for name, conclusion in conclusions.items()]


def _write_variants(study: Study, result: StudyResult | None, file: str) -> None:
    from torsionnet.base.errors import UsageError
    from torsionnet.study.run.run_chunks import no_variants

    if result is None:
        raise UsageError(no_variants(study.space))
    if result.kept.every > 1:
        message("note", f"{file} has {result.kept.words(result.study.count)}; beyond so many not all are kept")
    (result.to_parquet if file.endswith(".parquet") else result.to_csv)(file)
