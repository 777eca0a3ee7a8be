"""Writing and reading of the result of a fit as YAML text."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.composite import Listed, Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.plain_numbers import PlainNumber, PlainNumbers
from torsionnet.base.entries.spec import Count, Flag, Text, entry
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.identification.fit_result import Compared, FitResult
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.model.files.library import decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.reader import located_faults
from torsionnet.model.files.writer import block_text

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

    COLUMNS = ("measured_real", "measured_imag", "fitted_real", "fitted_imag", "deviation")
    OF_ORDERS = ("orders", "speeds")

    def contradictions(self) -> list[Fault]:
        n = len(self.frequencies)
        columns = (*self.COLUMNS, *(self.OF_ORDERS if self.orders or self.speeds else ()))
        lengths = {name: len(getattr(self, name)) for name in columns}
        return [
            Fault(f"{name} has {count} numbers for {n} frequencies", (name,))
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
        return [Fault(f"the correlation of {n} parameters has {n} rows of {n} numbers", ("correlation",))]


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


def _saved_curves(one: Compared) -> SavedCurves:
    columns: dict[str, Any] = {
        "frequencies": one.frequencies,
        "measured_real": one.measured.real,
        "measured_imag": one.measured.imag,
        "fitted_real": one.fitted.real,
        "fitted_imag": one.fitted.imag,
        "deviation": one.deviation,
    }
    if one.orders is not None and one.speeds is not None:
        columns |= {"orders": one.orders, "speeds": one.speeds}
    return SavedCurves(name=one.name, unit=one.unit, misfit=one.misfit, has_phase=one.has_phase, **columns)


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
        raise UsageError(f"{file} cannot be read: {error.strerror or error}") from None
    document = compose(text, str(file))
    data = document.data
    if not isinstance(data, dict) or str(data.get(VERSION_KEY)) != str(FIT_FORMAT_VERSION):
        fault = Fault(
            f"this is no result of a fit, which begins with {VERSION_KEY}: {FIT_FORMAT_VERSION}; name the file of one",
            position=document.position(),
        )
        raise ModelError([fault], file.name)
    saved, faults = SavedFit.read(data)
    if saved is None or document.faults:
        raise ModelError(located_faults([*document.faults, *faults], document), file.name)
    return _result(saved)


def _result(saved: SavedFit) -> FitResult:
    parameters = saved.parameters.items()
    return FitResult(
        values={name: one.value for name, one in parameters},
        standard_errors={name: one.standard_error for name, one in parameters},
        correlation=np.array(saved.correlation, dtype=float),
        chi_squared=saved.chi_squared,
        degrees_of_freedom=saved.degrees_of_freedom,
        comparisons=tuple(map(_compared, saved.measurements)),
        verdicts=saved.verdicts,
        notes=saved.notes,
        units={name: one.unit for name, one in parameters},
        title=saved.title,
        steps={name: one.steps for name, one in parameters if one.steps},
    )


def _compared(one: SavedCurves) -> Compared:
    def both(real: tuple[float, ...], imaginary: tuple[float, ...]) -> ComplexArray:
        return np.array(real, dtype=float) + 1j * np.array(imaginary, dtype=float)

    return Compared(
        one.name,
        np.array(one.frequencies, dtype=float),
        both(one.measured_real, one.measured_imag),
        both(one.fitted_real, one.fitted_imag),
        np.array(one.deviation, dtype=float),
        one.misfit,
        one.unit,
        one.has_phase,
        np.array(one.orders, dtype=float) if one.orders else None,
        np.array(one.speeds, dtype=float) if one.speeds else None,
    )
