"""Report on a campaign of tests: the model, the orders and responses measured beside those calculated, the fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.channels import named_sensor
from torsionnet.report.measured_orders import MeasuredFile
from torsionnet.report.plan.report_plan import ReportPlan
from torsionnet.report.report import make_report
from torsionnet.report.report_request import Measured

if TYPE_CHECKING:
    from torsionnet.bench.campaign.campaign import Campaign
    from torsionnet.bench.campaign.campaign_result import CampaignResult
    from torsionnet.report.document_tree import Report


def campaign_report(
    result: CampaignResult,
    *,
    sections: Iterable[str] = (),
    progress: Callable[[str, int, int], None] = lambda *_: None,
) -> Report:
    """Report on the model of a campaign in the configurations of its records, with their orders, responses and the fit.

    Parameters
    ----------
    result : CampaignResult
    sections : iterable of str, optional
        As of :func:`make_report`; by default those of the model's kind of document.
    progress : callable, optional
        Called before each section with its name, the number of sections done and that of all.

    Raises
    ------
    UsageError
        No channel of the campaign shows a sensor of the model.
    """
    campaign = result.campaign
    places = _places(campaign) if campaign.of_orders else {}
    if not places and not campaign.of_responses:
        raise UsageError(
            "no channel of the campaign shows a sensor of the model: name one by sensor: for the report",
            kind="unknown-channel",
        )
    model = campaign.model
    own = campaign.plan.report or ReportPlan()
    plan = _plan(campaign, own)
    if places:
        plan = replace(plan, measure=tuple(dict.fromkeys([*places.values(), *own.measure])))
    model = Drivetrain.from_definition(replace(model.definition, report=plan))
    names = {name: _configuration(campaign, entry.configuration) for name, entry in campaign.plan.records.items()}
    measured = [
        MeasuredFile(file, names[name], places[orders.name])
        for name, record in result.records.items()
        for file, orders in zip(record.files, record.orders, strict=False)  # the file of its responses comes last
        if orders.name in places
    ]
    return make_report(
        model,
        configurations=dict.fromkeys(filter(None, names.values())),
        sections=sections,
        measured=measured,
        tests=list(_tests(result, names)),
        fits=[] if result.fit is None else [result.fit],
        title=own.title or campaign.title,
        template=campaign.folder / own.template if own.template else None,
        progress=progress,
    )


def _plan(campaign: Campaign, own: ReportPlan) -> ReportPlan:
    """Plan of the report: that of the model, but for the entries that the campaign has of its own."""
    defaults = ReportPlan.defaults()
    given = {key: value for key in defaults if (value := getattr(own, key)) != defaults[key]}
    return replace(campaign.model.definition.report or ReportPlan(), **given)


def _tests(result: CampaignResult, configurations: Mapping[str, str]) -> Iterator[Measured]:
    """Yield the measured response of each record and output, under the names of output and input in the model."""
    campaign, asked = result.campaign, result.campaign.plan.responses
    for name, response in result.responses.items():
        for measured, _ in response.pairs():
            (output,), (into,) = measured.outputs, measured.inputs
            renamed = replace(
                measured,
                outputs=(replace(output, name=campaign.model_outputs[output.name]),),
                inputs=(replace(into, name=(asked.model_input if asked else "") or into.name),),
            )
            yield Measured(renamed, configurations[name], asked.excitation if asked else None)


def _places(campaign: Campaign) -> Mapping[str, str]:
    """Name in the model of the sensor that each channel shows, or the sensor written out, by channel."""
    sensors = campaign.model.definition.sensors
    named = {sensor: name for name, sensor in sensors.items()}
    sensor_of_channel = {name: named_sensor(text, sensors) for name, text in campaign.sensors.items()}
    return {name: named.get(sensor, str(sensor)) for name, sensor in sensor_of_channel.items() if sensor is not None}


def _configuration(campaign: Campaign, name: str) -> str:
    return campaign.model.configured(name).configuration if name else ""
