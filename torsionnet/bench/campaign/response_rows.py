"""Measured frequency responses of a campaign beside those of the model, and their repeatability, as rows of tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.bench.campaign.estimating_responses import CampaignResponse
from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
from torsionnet.signals.agreement import at_good_lines, comparable_lines
from torsionnet.signals.comparison import difference, frac
from torsionnet.signals.uncertainty import random_error

_NAN = float("nan")
_UNKNOWN = (_NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN)
"""Numbers of a row where no line of a test is good."""


@dataclass(frozen=True, eq=False)
class ResponseRow:
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


def response_rows(found: Mapping[str, CampaignResponse]) -> Iterator[ResponseRow]:
    """Yield a row for each record and output."""
    for record, one in found.items():
        for measured, calculated in one.pairs():
            yield _row(record, measured, calculated, str(one.file))


def _row(record: str, measured: FrequencyResponse, calculated: FrequencyResponse, file: str) -> ResponseRow:
    good = comparable_lines(measured)
    names = measured.outputs[0].name, measured.inputs[0].name
    if not good.any():
        return ResponseRow(record, *names, 0, *_UNKNOWN, file)
    test, model = at_good_lines(measured, good), at_good_lines(calculated, good)
    apart, f = difference(test, model), test.frequencies
    coherence = np.nan if measured.coherence is None else float(np.median(measured.coherence[good]))
    return ResponseRow(
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
        own = [one.select(output.name) for one in records]
        common = _common_lines(own)
        if not len(common):
            continue
        picked = [one.at_lines(np.isin(one.frequencies, common)) for one in own]
        values = np.array([one.values[:, 0, 0] for one in picked])
        mean = values.mean(axis=0)
        apart = (np.abs(values - mean) ** 2).sum(axis=0) / (len(own) - 1) / 2
        errors = [
            random_error(one.coherence[:, 0, 0], one.estimation.effective_averages).magnitude
            if one.coherence is not None and one.estimation is not None
            else np.full(len(common), np.nan)
            for one in picked
        ]
        yield ResponseSpread(
            f"{output.name}/{own[0].inputs[0].name}", condition, len(own), len(common),
            100 * _rms(np.sqrt(apart) / np.abs(mean)), 100 * _rms(np.array(errors)),
        )  # fmt: skip


def _common_lines(records: Sequence[FrequencyResponse]) -> FloatArray:
    """Frequencies in Hz, (n,), that all records have with good coherence."""
    common = records[0].frequencies
    for one in records:
        common = np.intersect1d(common, one.frequencies[comparable_lines(one)])
    return common


def response_lines(found: Mapping[str, CampaignResponse], conventions: Conventions = SI) -> Table:
    """Table of all lines of all records: magnitude and phase of test and model, coherence, with a row for each."""
    rows: list[tuple[str | float | None, ...]] = []
    for record, one in found.items():
        for test, model in one.pairs():
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
