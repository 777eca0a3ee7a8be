"""Frequency responses of a record of a campaign, estimated from the signals of a rig that is shaken or hammered."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.bench.campaign.campaign import Campaign, file_name, kept_path, record_key, write_kept
from torsionnet.identification import Measurement
from torsionnet.identification.residuals.measurement_blocks import record_settings, welch_settings
from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
from torsionnet.signals.calculus import with_gain, without_delay
from torsionnet.signals.comparison import at_good_lines, comparable_lines, difference, frac
from torsionnet.signals.estimators import estimate
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import read_even
from torsionnet.signals.response_files import read_frequency_response, write_frequency_response
from torsionnet.signals.uncertainty import random_error
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
        response = estimated_response(campaign, name)
        write_kept(kept, lambda filling: write_frequency_response(response, filling / FILE))
    measured = read_frequency_response(kept / FILE)
    return CampaignResponse(kept / FILE, measured, _calculated(campaign, name, measured))


def estimated_response(campaign: Campaign, name: str) -> FrequencyResponse:
    """Frequency responses of all outputs over the input of a record, in SI, with coherence."""
    asked = not_none(campaign.plan.responses)
    record = response_record(campaign, name)
    try:
        response = estimate(
            record, asked.outputs, asked.input, settings=_settings(campaign, record), band=asked.band,
            reference=[asked.reference] if asked.reference else (),
        )  # fmt: skip
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    return replace(response, title=f"{campaign.title}: {name}")


def response_record(campaign: Campaign, name: str) -> Recording:
    """Record of the input, the outputs and the set-point of the responses, calibrated, in SI."""
    asked, entry = not_none(campaign.plan.responses), campaign.plan.records[name]
    channels = campaign.plan.channels or {}
    names = list(dict.fromkeys(filter(None, [*asked.outputs, asked.input, asked.reference])))
    try:
        record = read_even(
            campaign.file_of(entry),
            names=names,
            **entry.arguments({key: channels[key] for key in names if key in channels}),
        )
        signals = [
            without_delay(with_gain(signal, channel.gain), channel.delay, record.time)
            if (channel := channels.get(signal.name))
            else signal
            for signal in record
        ]
        return replace(record, signals=tuple(signals)).between(entry.start, entry.stop)
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    except ModelError as error:
        faults = [replace(fault, message=f"record {name}: {fault.message}") for fault in error.faults]
        raise ModelError(faults, entry.file) from None


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
        response = model.frequency_response(
            list(campaign.model_outputs.values()), asked.model_input or asked.input, measured.frequencies,
            driven_by=asked.excitation,
        )  # fmt: skip
        for mine, theirs in zip(
            [*response.outputs, *response.inputs], [*measured.outputs, *measured.inputs], strict=True
        ):
            if mine.unit != theirs.unit:
                text = f"{theirs.name} is in {theirs.unit or 'no unit'}, {mine.name} of the model in {mine.unit}"
                raise UsageError(
                    f"{text}; give its quantity and unit under channels, or another sensor", kind="wrong-unit"
                )
    except UsageError as error:
        raise _of_record(campaign, name, error) from None
    return replace(response, outputs=measured.outputs, inputs=measured.inputs)


def _of_record(campaign: Campaign, name: str, error: UsageError) -> ModelError:
    return ModelError([Fault(f"record {name}: {error}", ("records", name), kind=error.kind)], campaign.file.name)


# Measured frequency responses of a campaign beside those of the model, and their repeatability, as rows of tables.

_NAN = float("nan")
_UNKNOWN = (_NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN)
"""Numbers of a row where no line of a test is good."""


@dataclass(frozen=True, eq=False)
class ComparedResponse:
    """Measured response of one output of a record beside the calculated one, over the lines of good coherence."""

    record: Annotated[str, Out("record")]
    output: Annotated[str, Out("output")]
    input: Annotated[str, Out("input")]
    lines: Annotated[int, Out("lines compared", json="lines_compared")]
    low: Annotated[float, Out("from", "Hz", digits=4, json="from_Hz")]
    high: Annotated[float, Out("to", "Hz", digits=4, json="to_Hz")]
    coherence: Annotated[float, Out("median coherence", digits=3, json="median_coherence")]
    peak: Annotated[float, Out("peak of the test", "Hz", digits=4, json="peak_of_the_test_Hz")]
    calculated_peak: Annotated[float, Out("of the model", "Hz", digits=4, json="peak_of_the_model_Hz")]
    decibels: Annotated[float, Out("RMS difference", "dB", digits=3, json="rms_difference_dB")]
    degrees: Annotated[float, Out("of phase", "deg", digits=3, json="rms_difference_of_phase_deg")]
    frac: Annotated[float, Out("FRAC", digits=4, json="frac")]
    file: Annotated[str, Out(json="file")]


@dataclass(frozen=True, eq=False)
class ResponseSpread:
    """Repeatability of a response over the records of one condition, relative, over the lines that all of them have."""

    response: Annotated[str, Out("response")]
    condition: Annotated[str, Out("condition")]
    records: Annotated[int, Out("records")]
    lines: Annotated[int, Out("lines")]
    spread: Annotated[float, Out("standard deviation between records", "%", digits=3, json="spread_percent")]
    stated: Annotated[float, Out("by the coherence", "%", digits=3, json="stated_percent")]

    @property
    def ratio(self) -> Annotated[float, Out("ratio", digits=3)]:
        """Standard deviation between records over that which the coherence states; about 1 where this tells all."""
        return self.spread / self.stated if self.stated else float("nan")


def response_rows(responses: Mapping[str, CampaignResponse]) -> Iterator[ComparedResponse]:
    """Yield a row for each record and output."""
    for record, response in responses.items():
        for measured, calculated in response.pairs():
            yield _row(record, measured, calculated, str(response.file))


def _row(record: str, measured: FrequencyResponse, calculated: FrequencyResponse, file: str) -> ComparedResponse:
    good = comparable_lines(measured)
    names = measured.outputs[0].name, measured.inputs[0].name
    if not good.any():
        return ComparedResponse(record, *names, 0, *_UNKNOWN, file)
    test, model = at_good_lines(measured, good), at_good_lines(calculated, good)
    apart, f = difference(test, model), test.frequencies
    coherence = np.nan if measured.coherence is None else float(np.median(measured.coherence[good]))
    return ComparedResponse(
        record, *names, len(f), float(f[0]), float(f[-1]), coherence,
        float(f[np.argmax(test.magnitude)]), float(f[np.argmax(model.magnitude)]),
        _rms(apart.decibels), _rms(apart.degrees), float(frac(test, model)[0, 0]), file,
    )  # fmt: skip


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def response_spread(condition: str, records: Sequence[FrequencyResponse]) -> Iterator[ResponseSpread]:
    """Yield the repeatability of each output over two records or more of one condition.

    Lines count that all records have, each with good coherence. The coherence of each record states the standard
    deviation of the real and of the imaginary part over the magnitude.
    """
    for output in records[0].outputs:
        own = [response.select(output.name) for response in records]
        common = _common_lines(own)
        if not len(common):
            continue
        picked = [response.at_lines(np.isin(response.frequencies, common)) for response in own]
        values = np.array([response.values[:, 0, 0] for response in picked])
        mean = values.mean(axis=0)
        # Of complex values half of the variance belongs to each of the two parts.
        apart = (np.abs(values - mean) ** 2).sum(axis=0) / (len(own) - 1) / 2
        errors = [
            random_error(response.coherence[:, 0, 0], response.estimation.effective_averages).magnitude
            if response.coherence is not None and response.estimation is not None
            else np.full(len(common), np.nan)
            for response in picked
        ]
        yield ResponseSpread(
            f"{output.name}/{own[0].inputs[0].name}", condition, len(own), len(common),
            100 * _rms(np.sqrt(apart) / np.abs(mean)), 100 * _rms(np.array(errors)),
        )  # fmt: skip


def _common_lines(records: Sequence[FrequencyResponse]) -> FloatArray:
    """Frequencies in Hz, (n,), that all records have with good coherence."""
    common = records[0].frequencies
    for record_response in records:
        common = np.intersect1d(common, record_response.frequencies[comparable_lines(record_response)])
    return common


def response_lines(responses: Mapping[str, CampaignResponse], conventions: Conventions = SI) -> Table:
    """Table of all lines of all records: magnitude and phase of test and model, coherence, with a row for each."""
    rows: list[tuple[str | float | None, ...]] = []
    for record, response in responses.items():
        for test, model in response.pairs():
            scale, unit = test.scale(conventions), test.unit(conventions=conventions)
            names = record, f"{test.outputs[0].name}/{test.inputs[0].name}", unit
            data = [
                test.frequencies, test.magnitude[:, 0, 0] * scale, test.phase[:, 0, 0],
                model.magnitude[:, 0, 0] * scale, model.phase[:, 0, 0],
                np.full(len(test.frequencies), np.nan) if test.coherence is None else test.coherence[:, 0, 0],
            ]  # fmt: skip
            rows += [(*names, *map(float, row)) for row in zip(*data, strict=True)]
    columns = (
        Column("record"), Column("response"), Column("unit"), Column("frequency", "Hz"), Column("|test|"),
        Column("phase test", "deg"), Column("|model|"), Column("phase model", "deg"), Column("coherence", "1"),
    )  # fmt: skip
    return Table("frequency responses of test and model", columns, tuple(rows))
