"""Frequency responses of a record of a campaign, estimated from the signals of a rig that is shaken or hammered."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.bench.campaign.campaign import Campaign
from torsionnet.bench.campaign.kept_files import file_name, kept_path, record_key, write_kept
from torsionnet.identification import Measurement
from torsionnet.identification.residuals.welch_choice import record_settings, welch_settings
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.channel_corrections import with_gain, without_delay
from torsionnet.signals.estimators import estimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import read_even
from torsionnet.signals.responses.response_files import read_frequency_response, write_frequency_response
from torsionnet.signals.welch import Welch

ESTIMATED = ("channels", "responses")
"""Sections of a campaign's file from which the responses of a record follow."""
FILE = "responses.npz"
"""Name of the file that keeps the responses of a record, without loss."""


@dataclass(frozen=True, eq=False)
class CampaignResponse:
    """Frequency responses of one record, coherence along, and those of the model at the same frequencies.

    Attributes
    ----------
    file : path
        File that keeps the measured ones.
    measured, calculated : FrequencyResponse
        From the input to all outputs, SI, under the names of the channels.
    """

    file: Path
    measured: FrequencyResponse
    calculated: FrequencyResponse

    def pairs(self) -> Iterator[tuple[FrequencyResponse, FrequencyResponse]]:
        """Measured and calculated response of each output."""
        for output in self.measured.outputs:
            yield self.measured.select(output.name), self.calculated.select(output.name)


def campaign_response(campaign: Campaign, name: str, folder: Path) -> CampaignResponse:
    """Frequency responses of a record beside those of the model; from the file where record and entries are the same.

    Raises
    ------
    ModelError
        The record lacks a channel or is too short, or a channel has another unit than the model's sensor.
    """
    kept = kept_path(folder, f"{file_name(name)}~responses", record_key(campaign, name, ESTIMATED))
    if not kept.is_dir():
        found = estimated_response(campaign, name)
        write_kept(kept, lambda filling: write_frequency_response(found, filling / FILE))
    measured = read_frequency_response(kept / FILE)
    return CampaignResponse(kept / FILE, measured, _calculated(campaign, name, measured))


def estimated_response(campaign: Campaign, name: str) -> FrequencyResponse:
    """Frequency responses of all outputs over the input of a record, in SI, with coherence."""
    asked = not_none(campaign.plan.responses)
    record = response_record(campaign, name)
    try:
        found = estimate(
            record, asked.outputs, asked.input, settings=_settings(campaign, record), band=asked.band,
            reference=[asked.reference] if asked.reference else (),
        )  # fmt: skip
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    return replace(found, title=f"{campaign.title}: {name}")


def response_record(campaign: Campaign, name: str) -> Recording:
    """Record of the input, the outputs and the set-point of the responses, calibrated, in SI."""
    asked, one, channels = not_none(campaign.plan.responses), campaign.plan.records[name], campaign.plan.channels or {}
    names = list(dict.fromkeys(filter(None, [*asked.outputs, asked.input, asked.reference])))
    try:
        record = read_even(
            campaign.file_of(one),
            names=names,
            **one.arguments({key: channels[key] for key in names if key in channels}),
        )
        signals = [
            without_delay(with_gain(signal, channel.gain), channel.delay, record.time)
            if (channel := channels.get(signal.name))
            else signal
            for signal in record
        ]
        return replace(record, signals=tuple(signals)).between(one.start, one.stop)
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, one.file) from None


def response_measurements(campaign: Campaign, name: str) -> Iterator[Measurement]:
    """Yield the record of each output as the fit takes it, with the settings of the responses."""
    asked, record = not_none(campaign.plan.responses), response_record(campaign, name)
    for output, sensor in campaign.model_outputs.items():
        yield Measurement(
            record, output, asked.input, campaign.plan.records[name].configuration, asked.band, asked.excluded,
            _settings(campaign, record), sensor, asked.model_input, asked.excitation, reference=asked.reference,
            settling=asked.settling, name=f"{name}: {output}",
        )  # fmt: skip


def _settings(campaign: Campaign, record: Recording) -> Welch:
    asked = not_none(campaign.plan.responses)
    given = welch_settings(asked.settings) if asked.settings else None
    return record_settings(record, asked.band, given, asked.settings.decimation if asked.settings else None)


def _calculated(campaign: Campaign, name: str, measured: FrequencyResponse) -> FrequencyResponse:
    asked, model = not_none(campaign.plan.responses), campaign.model_of(campaign.plan.records[name])
    try:
        found = model.frequency_response(
            list(campaign.model_outputs.values()), asked.model_input or asked.input, measured.frequencies,
            excitation=asked.excitation,
        )  # fmt: skip
        for mine, theirs in zip([*found.outputs, *found.inputs], [*measured.outputs, *measured.inputs], strict=True):
            if mine.unit != theirs.unit:
                text = f"{theirs.name} is in {theirs.unit or 'no unit'}, {mine.name} of the model in {mine.unit}"
                raise UsageError(f"{text}; give its quantity and unit under channels, or another sensor")
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    return replace(found, outputs=measured.outputs, inputs=measured.inputs)


def _of_record(campaign: Campaign, name: str, error: UsageError) -> ModelError:
    return ModelError([Fault(f"record {name}: {error}", ("records", name))], campaign.file.name)
