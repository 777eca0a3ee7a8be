"""Command ``torsionnet campaign``, which works out all records of a rotating test from one file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.app.cli.command import TABLE, Answer, Command, separated_by_lines
from torsionnet.app.cli.options import ANGLE, OutputFolder, argument, file_option, option
from torsionnet.app.cli.terminal import message

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.figure import Figure

    from torsionnet.base.conventions import Conventions
    from torsionnet.base.table import Table
    from torsionnet.bench.campaign.campaign_result import CampaignResult

ENDINGS = (".html", ".pdf", ".docx", ".tex", ".md", ".htm")


class CampaignCommand(Command):
    """Work out a test with all its records: orders or responses beside the calculation, repeatability, fit, report.

    CAMPAIGN is a YAML file, or one of the library: model, wheels, channels with calibrations, records with
    configuration and condition, the orders or frequency responses wanted, and perhaps a fit. Tracked orders are kept in
    CAMPAIGN.orders, a file for each channel, and responses in a file for each record; a record is worked out again only
    where it or its entries have changed.

    \b
    torsionnet bench marine_run_up -o run_up.npz
    torsionnet campaign marine_campaign -o report.html --plot orders.png
    """

    forms = TABLE
    picture = "measured orders or responses over the calculated ones, for each record"

    file: str = argument("CAMPAIGN")
    report: str | None = file_option("Write the report: .html, .pdf, .docx, .tex or .md.", ENDINGS)
    sections: tuple[str, ...] = option("--section", metavar="NAME", help="Of the report, as of torsionnet report.")
    folder: str | None = option(
        "--orders-folder", type=OutputFolder(), help="Keep the tracked orders there.  [default: CAMPAIGN.orders]"
    )
    angle: str = ANGLE

    def answer(self) -> Answer:
        from torsionnet.base.conventions import Conventions

        result, conventions = self._result(), Conventions(angle=self.angle)
        return Answer(
            screen=lambda: _screen(result, conventions),
            data=lambda: result,
            csv=lambda: _csv(result, conventions),
            files=[(self.report, lambda file: self._write_report(result, file))],
            figures=lambda plot: _figures(plot, result, conventions),
            exit_code=1 if result.fails else 0,
        )

    def _result(self) -> CampaignResult:
        from torsionnet.app.cli.terminal import stages
        from torsionnet.bench.campaign.campaign import load_campaign
        from torsionnet.bench.campaign.running_campaign import run_campaign
        from torsionnet.report.report import writer_for

        if self.report:
            writer_for(self.report)  # tells what is not installed before the records are worked out
        campaign = load_campaign(self.file)
        with stages() as show:
            result = run_campaign(
                campaign, self.folder, progress=lambda words, done, total: show("records", done, total, words)
            )
        for one in result.findings:
            if one.consequence:
                message("error" if one.consequence == "fails" else "warning", one.remark)
        for verdict in () if result.fit is None else result.fit.verdicts:
            message("warning", verdict)
        return result

    def _write_report(self, result: CampaignResult, file: str) -> None:
        from torsionnet.app.cli.terminal import stages
        from torsionnet.report.campaign_report import campaign_report
        from torsionnet.report.report import writer_for

        write = writer_for(Path(file))
        with stages() as show:
            report = campaign_report(
                result,
                sections=self.sections,
                progress=lambda name, done, total: show("sections", done, total, f"section {name.replace('_', ' ')}"),
            )
            show("writing", 0, None, f"writing {Path(file).name}")
            write(report, Path(file))


def _csv(result: CampaignResult, conventions: Conventions) -> list[tuple[str, Table]]:
    """Verdicts on orders, and the lines of the frequency responses, each where the campaign has them."""
    found = [("orders", result.verdict_table())] if result.campaign.of_orders else []
    return found + ([("responses", result.response_lines(conventions))] if result.campaign.of_responses else [])


def _screen(result: CampaignResult, conventions: Conventions) -> Iterator[Table | str]:
    firsts = [result.table()] if result.campaign.of_orders else []
    firsts += [*result.comparisons(conventions), *([result.response_table()] if result.campaign.of_responses else [])]
    yield from separated_by_lines(firsts)
    tables: Iterable[Table | None] = (
        result.repeatability() if result.spreads else None,
        result.response_repeatability() if result.response_spreads else None,
        None if result.fit is None else result.fit.table(),
        None if result.ranking is None else result.ranking.table(),
    )
    for one in tables:
        if one is not None:
            yield ""
            yield one


def _figures(plot: ModuleType, result: CampaignResult, conventions: Conventions) -> Iterator[tuple[str, Figure]]:
    from torsionnet.plot.order_overlay_plot import order_overlay

    for name, found in result.records.items():
        if found.calculated is not None and found.tests:
            title = f"{result.campaign.title}: {name}"
            yield name, order_overlay(found.calculated, found.tests, conventions=conventions, title=title)
    for name, one in result.responses.items():
        for test, model in one.pairs():
            yield (
                f"{name}_{test.outputs[0].name}",
                plot.comparison(test, model, conventions=conventions, title=f"{result.campaign.title}: {name}"),
            )
    if result.fit is not None:
        yield "fit", plot.fit(result.fit, conventions=conventions)
