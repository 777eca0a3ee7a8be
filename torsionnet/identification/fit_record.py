"""Results of fits as plain data, for JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.base.units import RPM
from torsionnet.identification.fit_result import FitResult
from torsionnet.identification.lack_of_fit import LackOfFit
from torsionnet.identification.ranking import RankedCause, Ranking
from torsionnet.linear.assembly.rows import FloatArray

Intervals = Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class FittedRow:
    """Fitted value of a parameter with its standard error and 95 % intervals in SI, and the true value if known."""

    name: str
    value: float
    standard_error: float
    interval: Annotated[tuple[float, float], Out(json="interval_95")]
    profile: Annotated[tuple[float, float] | None, Out(json="profile_95")]
    unit: str
    true: float | None


@dataclass(frozen=True, eq=False)
class ComparedRow:
    """Real and imaginary parts (2, n_f) of the responses of test and fitted model for one measurement, SI."""

    name: str
    unit: str
    frequencies: Annotated[FloatArray, Out(json="frequencies_Hz")]
    misfit: float
    measured: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    fitted: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    orders: Annotated[FloatArray | None, Out(optional=True)]
    speeds: Annotated[FloatArray | None, Out(json="speeds_rpm", optional=True)]


@dataclass(frozen=True)
class RankingRecord:
    """Ranked causes of a misfit alone, as ``torsionnet fit --rank --json`` prints them where no parameter is fitted."""

    ranking: tuple[RankedCause, ...]


@dataclass(frozen=True, eq=False)
class FitRecord:
    """Result of a fit as plain data, as ``torsionnet fit --json`` prints it."""

    title: str
    parameters: tuple[FittedRow, ...]
    correlation: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    chi_squared: float
    degrees_of_freedom: int
    aicc: float
    verdicts: tuple[str, ...]
    lack_of_fit: LackOfFit | None
    notes: tuple[str, ...]
    measurements: tuple[ComparedRow, ...]
    ranking: Annotated[tuple[RankedCause, ...] | None, Out(optional=True)]


def fit_record(found: FitResult, profiles: Intervals, true: Mapping[str, float], ranking: Ranking | None) -> FitRecord:
    """Result of a fit as plain data for JSON, with the given profile intervals, true values and ranking of causes."""
    intervals = found.intervals()
    parameters = tuple(
        FittedRow(
            name, value, found.standard_errors[name], intervals[name], profiles.get(name), found.units.get(name, ""),
            true.get(name),
        )
        for name, value in found.values.items()
    )  # fmt: skip
    measurements = tuple(
        ComparedRow(
            one.name, one.unit, one.frequencies, one.misfit, _parts(one.measured), _parts(one.fitted), one.orders,
            None if one.speeds is None else one.speeds * RPM,
        )
        for one in found.comparisons
    )  # fmt: skip
    return FitRecord(
        found.title, parameters, found.correlation, found.chi_squared, found.degrees_of_freedom, found.aicc,
        found.verdicts, found.lack_of_fit, found.notes, measurements, None if ranking is None else ranking.causes,
    )  # fmt: skip


def _parts(values: np.ndarray) -> FloatArray:
    return np.stack([values.real, values.imag])
