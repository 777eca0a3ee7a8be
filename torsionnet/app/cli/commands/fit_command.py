"""Command ``torsionnet fit``, which finds parameters of a model from records of tests."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import OutputFile, argument, file_option, option
from torsionnet.app.cli.terminal import message
from torsionnet.base.errors import UsageError

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
    from torsionnet.signals.decimation import usable_up_to
    from torsionnet.signals.recording import Recording

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
