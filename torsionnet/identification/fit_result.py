"""Values of a fit with standard errors and intervals, and the curves of test and model.

Half width of a confidence interval for a value with errors by noise and by the steps of sensors. The error of a fitted
value by sensor steps depends on the position within a step that the rig rests at. It is bounded: an error that varies
as a sine with the position reaches 1.4 standard deviations, where noise has 1.96 at 95 %. The interval for both errors
together follows from the distribution of the noise, averaged over the rest positions.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.plain_numbers import PlainNumber, PlainNumbers
from torsionnet.base.entries.spec import Count, Flag, Text, entry
from torsionnet.base.errors import Fault, ModelError, UsageError, unreadable_file
from torsionnet.base.packages import UNSAVED, SavedResult
from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.lack_of_fit import LackOfFit
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.files.fault_places import located_faults
from torsionnet.model.files.library import decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.writer import block_text


@dataclass(frozen=True, eq=False)
class Compared:
    """Frequency responses or orders (n,) of test and fitted model for one measurement, by the same estimator, SI.

    Attributes
    ----------
    name : str
    frequencies : (n,) array
        Hz.
    measured, fitted : (n,) complex array
        SI.
    deviation : (n,) array
        Standard deviation of each line by its noise, SI.
    misfit : float
        RMS of the weighted residuals: 1 where the model explains all but noise.
    unit : str
    has_phase : bool
        Whether the test has a phase; without, its values are magnitudes.
    orders, speeds : (n,) array, optional
        Of a measurement of orders: the order of each line and the speed of the reference shaft, rad/s.
    times : (n,) array, optional
        Of equations of motion along a record: the middle of the time of each, s. Values are torques of the laws then.
    """

    SHOWN: ClassVar = (
        "name", "unit", "frequencies", "misfit", "measured_parts", "fitted_parts", "orders", "speeds_rpm",
        "times",
    )  # fmt: skip

    name: str
    frequencies: Annotated[FloatArray, Out(json="frequencies_Hz")]
    measured: ComplexArray
    fitted: ComplexArray
    deviation: FloatArray
    misfit: float
    unit: str
    has_phase: bool = True
    orders: Annotated[FloatArray | None, Out(optional=True)] = None
    speeds: FloatArray | None = None
    times: Annotated[FloatArray | None, Out(json="times_s", optional=True)] = None

    @property
    def measured_parts(self) -> Annotated[FloatArray, Out(json="measured", schema=NUMBER_ROWS)]:
        """Real and imaginary parts of the test, SI, shape (2, n)."""
        return np.stack([self.measured.real, self.measured.imag])

    @property
    def fitted_parts(self) -> Annotated[FloatArray, Out(json="fitted", schema=NUMBER_ROWS)]:
        """Real and imaginary parts of the fitted model, SI, shape (2, n)."""
        return np.stack([self.fitted.real, self.fitted.imag])

    @property
    def speeds_rpm(self) -> Annotated[FloatArray | None, Out(optional=True)]:
        """Speed of the reference shaft at each line of a measurement of orders, r/min."""
        return None if self.speeds is None else self.speeds * RPM


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(SavedResult):
    """Result of a fit as written to a file, with values and standard errors; fields as in :class:`torsionnet.Fit`."""

    picture: ClassVar[str] = "fit"

    values: Mapping[str, float]
    standard_errors: Mapping[str, float]
    correlation: Annotated[FloatArray, Out(schema=NUMBER_ROWS)]
    chi_squared: float
    degrees_of_freedom: int
    comparisons: Annotated[tuple[Compared, ...], Out(json="measurements")]
    verdicts: tuple[str, ...]
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    title: str = ""
    steps: Mapping[str, tuple[tuple[float, ...], ...]] = field(default_factory=dict)
    lack_of_fit: LackOfFit | None = None
    problem: FitProblem | None = field(default=None, repr=False, metadata=UNSAVED)
    loss: str = "linear"

    def intervals(self, confidence: float = 0.95) -> dict[str, tuple[float, float]]:
        """Confidence interval (lower, upper) of each fitted value in SI by name, sensor steps included."""
        if not 0 < confidence < 1:
            raise UsageError(
                f"the confidence level is a number between 0 and 1, such as 0.95, got {confidence}", kind="out-of-range"
            )
        freedom, intervals = max(self.degrees_of_freedom, 1), {}
        for name, value in self.values.items():
            half = interval_half_width(confidence, self.standard_errors[name], self.steps.get(name, ()), freedom)
            intervals[name] = (value - half, value + half)
        return intervals

    def configured(self, model: Drivetrain) -> Drivetrain:
        """Copy of the model with the fitted values of the parameters that all configurations share.

        Values fitted per configuration are in ``values`` only. Numbers of excitations are entries of the model, which
        it has in every configuration that does not change them.
        """
        from torsionnet.identification.orders.parametric_orders import numbers_of_excitations

        shared = {name: value for name, value in self.values.items() if name in model.parameter_definitions}
        numbers = numbers_of_excitations(model, [name for name in self.values if "." in name and "[" not in name])
        if numbers:
            model = model.with_excitation_numbers({name: self.values[name] for name in numbers})
        return model.configured(**shared)

    @property
    def aicc(self) -> float:
        """Corrected Akaike criterion (AICc) of the fit; lower is better among fits with the same noise."""
        k, n = len(self.values), self.degrees_of_freedom + len(self.values)
        return self.chi_squared + 2 * k + 2 * k * (k + 1) / max(n - k - 1, 1)

    def table(self, confidence: float = 0.95, true: Mapping[str, float] | None = None) -> Table:
        """Table of fitted values with standard errors and intervals, and ``true`` values where they are known."""
        intervals = self.intervals(confidence)
        columns = [Column("parameter"), Column("value"), Column("standard error", "", 2)]
        columns += [Column(f"{100 * confidence:g} % from"), Column("to"), Column("unit")]
        columns += [Column("true"), Column("inside")] if true is not None else []
        rows = []
        for name, value in self.values.items():
            row = [name, value, self.standard_errors[name], *intervals[name], self.units.get(name, "")]
            if true is not None:
                known = true.get(name)
                low, high = intervals[name]
                row += [known, "" if known is None or np.isinf(low) else "yes" if low <= known <= high else "no"]
            rows.append(tuple(row))
        return Table(self.title, tuple(columns), tuple(rows), (*self.verdicts, *self.notes))

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} = {value:.4g}" for name, value in self.values.items())
        return f"<Fit {shown}>"


# Writing and reading of the result of a fit as YAML text.

FIT_FORMAT_VERSION = 1
"""Version of the file format for the result of a fit, as files of any other version are refused."""
VERSION_KEY = "torsionnet_fit"
"""Key of the format version, the first entry of a file with the result of a fit, by which it is recognised."""
FREEDOM_RANGE = (-10_000, 10**9)
"""Smallest and largest degrees of freedom in a file; they are negative where there are more parameters than values."""
BLOCK_LEVELS = {"parameters": 1, "correlation": 1, "verdicts": 1, "notes": 1, "measurements": 2}
"""Levels of block style in each section of a file with the result of a fit, deeper levels being in flow style."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SavedParameter(Declared):
    """Fitted value of a parameter in the file of a fit, with its standard error and unit."""

    kind = article = "parameter"

    value: float = entry(PlainNumber("value in SI"))
    standard_error: float = entry(PlainNumber("standard error in SI"))
    steps: tuple[tuple[float, ...], ...] = entry(Listed("errors by the steps of sensors", PlainNumbers("SI")), ())
    unit: str = entry(Text("unit of the value"), "")


@dataclass(frozen=True, eq=False, kw_only=True)
class SavedCurves(Declared):
    """Frequency responses of test and fitted model for one measurement in the file of a fit."""

    kind = article = "measurement"

    name: str = entry(Text("name"))
    unit: str = entry(Text("unit of the curves"))
    misfit: float = entry(PlainNumber("RMS of the weighted residuals"))
    has_phase: bool = entry(Flag("whether the test has a phase"), True)
    frequencies: tuple[float, ...] = entry(PlainNumbers("frequencies in Hz"))
    measured_real: tuple[float, ...] = entry(PlainNumbers("real part of the test, SI"))
    measured_imag: tuple[float, ...] = entry(PlainNumbers("imaginary part of the test, SI"))
    fitted_real: tuple[float, ...] = entry(PlainNumbers("real part of the model, SI"))
    fitted_imag: tuple[float, ...] = entry(PlainNumbers("imaginary part of the model, SI"))
    deviation: tuple[float, ...] = entry(PlainNumbers("standard deviation of each line, SI"))
    orders: tuple[float, ...] = entry(PlainNumbers("of measured orders: order of each line"), ())
    speeds: tuple[float, ...] = entry(PlainNumbers("of measured orders: speed at each line, rad/s"), ())
    times: tuple[float, ...] = entry(PlainNumbers("of equations of motion: time of each, s"), ())

    COLUMNS = ("measured_real", "measured_imag", "fitted_real", "fitted_imag", "deviation")
    OF_ORDERS = ("orders", "speeds")

    def contradictions(self) -> list[Fault]:
        n = len(self.frequencies)
        columns = (
            *self.COLUMNS,
            *(self.OF_ORDERS if self.orders or self.speeds else ()),
            *(["times"] if self.times else []),
        )
        lengths = {name: len(getattr(self, name)) for name in columns}
        return [
            Fault(f"{name} has {count} numbers for {n} frequencies", (name,), kind="wrong-count")
            for name, count in lengths.items()
            if count != n
        ]


@dataclass(frozen=True, eq=False, kw_only=True)
class SavedFit(Declared):
    """Result of a fit as its file holds it, without the measured data and the model."""

    kind = "result of a fit"
    article = "the result of a fit"
    head = (VERSION_KEY,)

    title: str = entry(Text("title of tables"))
    parameters: Mapping[str, SavedParameter] = entry(
        Named("parameters by name", Nested("parameter", lambda: SavedParameter, "parameter"))
    )
    correlation: tuple[tuple[float, ...], ...] = entry(Listed("correlation of parameters", PlainNumbers("row")))
    chi_squared: float = entry(PlainNumber("sum of the squares of the weighted residuals"))
    degrees_of_freedom: int = entry(Count("values less parameters", *FREEDOM_RANGE))
    verdicts: tuple[str, ...] = entry(Listed("verdicts", Text("verdict")))
    notes: tuple[str, ...] = entry(Listed("notes", Text("note")))
    measurements: tuple[SavedCurves, ...] = entry(
        Listed("curves", Nested("measurement", lambda: SavedCurves, "measurement"))
    )

    def contradictions(self) -> list[Fault]:
        n = len(self.parameters)
        if len(self.correlation) == n and all(len(row) == n for row in self.correlation):
            return []
        return [
            Fault(
                f"the correlation of {n} parameters has {n} rows of {n} numbers", ("correlation",), kind="wrong-count"
            )
        ]


def dump_fit(fit: FitResult, path: str | os.PathLike[str] | None = None) -> str:
    """YAML text of a fit with values, standard errors, correlation, verdicts and responses, for a file."""
    saved = SavedFit(
        title=fit.title,
        parameters={
            name: SavedParameter(
                value=value,
                standard_error=fit.standard_errors[name],
                steps=fit.steps.get(name, ()),
                unit=fit.units.get(name, ""),
            )
            for name, value in fit.values.items()
        },
        correlation=tuple(map(tuple, fit.correlation.tolist())),
        chi_squared=fit.chi_squared,
        degrees_of_freedom=fit.degrees_of_freedom,
        verdicts=fit.verdicts,
        notes=fit.notes,
        measurements=tuple(map(_saved_curves, fit.comparisons)),
    )
    text = block_text({VERSION_KEY: FIT_FORMAT_VERSION, **saved.written_entries()}, BLOCK_LEVELS, lists=True)
    if path is not None:
        write_text(path, text)
    return text


def _saved_curves(compared: Compared) -> SavedCurves:
    columns: dict[str, Any] = {
        "frequencies": compared.frequencies,
        "measured_real": compared.measured.real,
        "measured_imag": compared.measured.imag,
        "fitted_real": compared.fitted.real,
        "fitted_imag": compared.fitted.imag,
        "deviation": compared.deviation,
    }
    if compared.orders is not None and compared.speeds is not None:
        columns |= {"orders": compared.orders, "speeds": compared.speeds}
    if compared.times is not None:
        columns["times"] = compared.times
    return SavedCurves(
        name=compared.name, unit=compared.unit, misfit=compared.misfit, has_phase=compared.has_phase, **columns
    )


def read_fit(path: str | os.PathLike[str]) -> FitResult:
    """Result of a fit read from a file that :func:`dump_fit` has written.

    Raises
    ------
    UsageError
        There is no such file.
    ModelError
        The file is not the result of a fit.
    """
    file = Path(path)
    try:
        text = decode(file.read_bytes(), str(file))
    except OSError as error:
        raise unreadable_file(file, error) from None
    document = compose(text, str(file))
    data = document.data
    if not isinstance(data, dict) or str(data.get(VERSION_KEY)) != str(FIT_FORMAT_VERSION):
        fault = Fault(
            f"this is no result of a fit, which begins with {VERSION_KEY}: {FIT_FORMAT_VERSION}; name the file of one",
            position=document.position(),
            kind="wrong-file",
        )
        raise ModelError([fault], file.name)
    saved, faults = SavedFit.read(data)
    if saved is None or document.faults:
        raise ModelError(located_faults([*document.faults, *faults], document), file.name)
    return _result(saved)


def _result(saved: SavedFit) -> FitResult:
    parameters = saved.parameters.items()
    return FitResult(
        values={name: parameter.value for name, parameter in parameters},
        standard_errors={name: parameter.standard_error for name, parameter in parameters},
        correlation=np.array(saved.correlation, dtype=float),
        chi_squared=saved.chi_squared,
        degrees_of_freedom=saved.degrees_of_freedom,
        comparisons=tuple(map(_compared, saved.measurements)),
        verdicts=saved.verdicts,
        notes=saved.notes,
        units={name: parameter.unit for name, parameter in parameters},
        title=saved.title,
        steps={name: parameter.steps for name, parameter in parameters if parameter.steps},
    )


def _compared(saved: SavedCurves) -> Compared:
    def both(real: tuple[float, ...], imaginary: tuple[float, ...]) -> ComplexArray:
        return np.array(real, dtype=float) + 1j * np.array(imaginary, dtype=float)

    return Compared(
        saved.name,
        np.array(saved.frequencies, dtype=float),
        both(saved.measured_real, saved.measured_imag),
        both(saved.fitted_real, saved.fitted_imag),
        np.array(saved.deviation, dtype=float),
        saved.misfit,
        saved.unit,
        saved.has_phase,
        np.array(saved.orders, dtype=float) if saved.orders else None,
        np.array(saved.speeds, dtype=float) if saved.speeds else None,
        np.array(saved.times, dtype=float) if saved.times else None,
    )


# Half width of a confidence interval for a value with errors by noise and by the steps of sensors.

POSITION_COMBINATIONS = 1024
"""Number of combinations of rest positions of several tests, spread evenly, over which errors by sensor steps are
averaged."""
NEGLIGIBLE_VARIANCE_SHARE = 1e-3
"""Share of a value's variance up to which errors by sensor steps count as noise, and which noise keeps at least."""


def interval_half_width(level: float, error: float, steps: Sequence[Sequence[float]], freedom: float) -> float:
    """Half the width of the confidence interval of a fitted value, in the unit of ``error``.

    Parameters
    ----------
    level : float
    error : float
        Standard error of the value, steps included.
    steps : sequence of sequences of float
        Error of the value at each rest position, all equally likely; several tests are independent.
    freedom : float
        Degrees of freedom of Student's distribution of the noise.

    Examples
    --------
    >>> round(interval_half_width(0.95, 1.0, [], 1e6), 3)
    1.96
    >>> cosine = 2**0.5 * np.cos(2 * np.pi * (np.arange(64) + 0.5) / 64)
    >>> round(interval_half_width(0.95, 1.0, [cosine.tolist()], 1e6), 1)
    1.4
    """
    usual = float(scipy.stats.t.ppf(0.5 + level / 2, freedom)) * error
    known = sum(float(np.mean(np.square(errors))) for errors in steps)
    if not np.isfinite(error) or known <= NEGLIGIBLE_VARIANCE_SHARE * error**2:
        return usual
    # The error of the steps is not normal: noise of Student's law about each error that they may make.
    moved, noise = _errors_of_combinations(steps), np.sqrt(max(error**2 - known, NEGLIGIBLE_VARIANCE_SHARE * error**2))

    def missed(width: float) -> float:
        outside = scipy.stats.t.sf((width - moved) / noise, freedom) + scipy.stats.t.cdf(
            (-width - moved) / noise, freedom
        )
        return float(outside.mean()) - (1 - level)

    return float(scipy.optimize.brentq(missed, 0.0, usual + float(np.abs(moved).max())))


def _errors_of_combinations(steps: Sequence[Sequence[float]]) -> FloatArray:
    """Errors of a value by the sensor steps of all tests, one for each combination of rest positions, shape (1024,).

    The sets fill a cube evenly (generalised golden ratio).
    """
    # Powers of the root of x^(d + 1) = x + 1 fill the cube of rest positions evenly, however many tests there are.
    ratio = float(scipy.optimize.brentq(lambda x: x ** (len(steps) + 1) - x - 1, 1.0, 2.0))
    places = (np.arange(POSITION_COMBINATIONS)[:, None] + 0.5) * ratio ** -np.arange(1.0, len(steps) + 1) % 1.0
    return np.asarray(
        np.sum([np.asarray(errors)[(places[:, i] * len(errors)).astype(int)] for i, errors in enumerate(steps)], axis=0)
    )
