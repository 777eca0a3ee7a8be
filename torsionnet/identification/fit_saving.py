"""Writing and reading of the result of a fit as YAML text."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import write_text
from torsionnet.core.errors import Fault, ModelError, UsageError
from torsionnet.identification.fit_result import Compared, FitResult
from torsionnet.model.files.decoding import decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.quoting import scalar_text

FIT_FORMAT_VERSION = 1
"""Version of the file format."""


def dump_fit(fit: FitResult, path: str | os.PathLike[str] | None = None) -> str:
    """YAML text of a fit with values, errors, correlation, verdicts and the curves of test and model."""
    lines = [f"torsionnet_fit: {FIT_FORMAT_VERSION}", f"title: {scalar_text(fit.title)}", "parameters:"]
    for name, value in fit.values.items():
        unit = f", unit: {scalar_text(fit.units.get(name, ''))}"
        error = fit.standard_errors[name]
        steps = "".join(f", steps: {_rows(found)}" for found in [fit.steps.get(name)] if found)
        lines.append(f"  {scalar_text(name)}: {{value: {value!r}, standard_error: {_number(error)}{steps}{unit}}}")
    lines += ["correlation:", *(f"  - [{', '.join(map(_number, row))}]" for row in fit.correlation.tolist())]
    lines += [f"chi_squared: {_number(fit.chi_squared)}", f"degrees_of_freedom: {fit.degrees_of_freedom}"]
    for key, texts in (("verdicts", fit.verdicts), ("notes", fit.notes)):
        lines += [f"{key}:" if texts else f"{key}: []", *(f"  - {scalar_text(text)}" for text in texts)]
    lines.append("measurements:" if fit.comparisons else "measurements: []")
    for one in fit.comparisons:
        lines += [
            f"  - name: {scalar_text(one.name)}",
            f"    unit: {scalar_text(one.unit)}",
            f"    misfit: {one.misfit!r}",
        ]
        lines += [] if one.has_phase else ["    has_phase: false"]
        columns = {
            "frequencies": one.frequencies,
            "measured_real": one.measured.real,
            "measured_imag": one.measured.imag,
            "fitted_real": one.fitted.real,
            "fitted_imag": one.fitted.imag,
            "deviation": one.deviation,
        }
        lines += [f"    {key}: [{', '.join(map(_number, values.tolist()))}]" for key, values in columns.items()]
    text = "\n".join(lines) + "\n"
    if path is not None:
        write_text(path, text)
    return text


def _rows(tests: tuple[tuple[float, ...], ...]) -> str:
    lists = [", ".join(map(_number, row)) for row in tests]
    return f"[[{'], ['.join(lists)}]]"


def _number(value: float) -> str:
    return repr(float(value)) if math.isfinite(value) else ".inf" if value > 0 else ".nan"


def read_fit(path: str | os.PathLike[str]) -> FitResult:
    """Read the result of a fit that :func:`dump_fit` has written.

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
    if not isinstance(data, dict) or str(data.get("torsionnet_fit")) != str(FIT_FORMAT_VERSION):
        fault = Fault(
            f"this is no result of a fit, which begins with torsionnet_fit: {FIT_FORMAT_VERSION}; name the file of one",
            position=document.position(),
        )
        raise ModelError([fault], file.name)
    try:
        return _fit(data)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        fault = Fault(
            f"the result of a fit is damaged or not complete ({error}); fit again and write it anew",
            position=document.position(),
        )
        raise ModelError([fault], file.name) from None


def _fit(data: dict[str, Any]) -> FitResult:
    parameters = data["parameters"]
    return FitResult(
        values={name: _float(entry["value"]) for name, entry in parameters.items()},
        standard_errors={name: _float(entry["standard_error"]) for name, entry in parameters.items()},
        correlation=_array(data["correlation"]),
        chi_squared=_float(data["chi_squared"]),
        degrees_of_freedom=int(data["degrees_of_freedom"]),
        comparisons=tuple(_compared(entry) for entry in data["measurements"]),
        verdicts=tuple(map(str, data["verdicts"])),
        notes=tuple(map(str, data["notes"])),
        units={name: str(entry.get("unit") or "") for name, entry in parameters.items()},
        title=str(data["title"]),
        steps={
            name: tuple(tuple(map(_float, row)) for row in entry["steps"])
            for name, entry in parameters.items()
            if "steps" in entry
        },
    )


def _compared(entry: dict[str, Any]) -> Compared:
    column = {key: _array(values) for key, values in entry.items() if isinstance(values, list)}
    return Compared(
        str(entry["name"]),
        column["frequencies"],
        column["measured_real"] + 1j * column["measured_imag"],
        column["fitted_real"] + 1j * column["fitted_imag"],
        column["deviation"],
        _float(entry["misfit"]),
        str(entry["unit"]),
        bool(entry.get("has_phase", True)),
    )


def _float(value: Any) -> float:
    return float(value.removeprefix(".")) if isinstance(value, str) else float(value)


def _array(values: Any) -> Any:
    return np.array([_array(value) if isinstance(value, list) else _float(value) for value in values])
