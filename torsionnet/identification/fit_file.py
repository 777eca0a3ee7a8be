"""What a fit is about, from a YAML file: model, measurements, parameters, settings."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from torsionnet.core.errors import Fault, ModelError, UsageError, did_you_mean, unknown_key
from torsionnet.core.expressions import ExpressionError, Number, scalar
from torsionnet.core.units import UnitError
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.instrument import set_points
from torsionnet.identification.measurement import Measurement
from torsionnet.identification.measurement_blocks import default_settings
from torsionnet.identification.unknown import Unknown
from torsionnet.io.records import channel_names, read_recording
from torsionnet.loading import load
from torsionnet.model.bench.fields import Value
from torsionnet.model.elements.fields import Count, FieldError, Flag, Spec, Text
from torsionnet.model.files.decoding import decode
from torsionnet.model.files.located import LocatedDocument, compose
from torsionnet.model.files.placing import placed, presentable
from torsionnet.response import FrequencyResponse
from torsionnet.response.recording import Recording
from torsionnet.signals.decimation import factor_for
from torsionnet.signals.welch import PAPER, Welch

KEYS = ("torsionnet", "name", "model", "parameters", "measurements", "settings", "residual", "loss", "starts", "true")
REQUIRED = ("model", "parameters", "measurements")
SETTINGS: dict[str, Spec] = {
    "preset": Text("paper: the settings of Galvagno et al. (2015)"),
    "window": Text("name of a window"),
    "seconds": Value("length of a segment", "time", exclusive=True),
    "overlap": Value("share of a segment that the next one repeats", "1"),
    "detrend": Text("mean, linear or none"),
    "estimator": Text("H1, H2 or Hr; by default Hr where there is a set-point, else H1"),
    "decimation": Count("keep every n-th sample; by default as many as the band needs", upper=100_000),
}
COUNTS: dict[str, Spec] = {"starts": Count("how many searches begin, at different values", upper=1000)}
MEASUREMENT: dict[str, Spec] = {
    "record": Text("file of signals, from the folder of this file"),
    "response": Text("instead of a record: file of a response already estimated"),
    "output": Text("channel"),
    "input": Text("channel"),
    "configuration": Text("of the model; by default the name of the measurement if that is one"),
    "model_output": Text("sensor of the model, if it has another name there"),
    "model_input": Text("input or sensor of the model, if it has another name there"),
    "excitation": Text("what drives the model, if it has several inputs"),
    "delay": Flag("find a delay of the output's channel along"),
    "gain": Flag("find a gain of the output's channel along"),
    "reference": Text("channel of the set-point; by default the model's input with _set"),
    "settling": Value("time at the start that is left out", "time"),
    "error": Value("relative standard error of a response, instead of its coherence", "1", exclusive=True),
}
NEEDS = {"record": "either record or response"}
BANDS = ("band", "excluded")
LISTED = (*BANDS, "pulses")
"""Entries of a measurement that are more than one value."""
RANGES = ("band", "from", "to", "start", "stop", "low", "high", "frequencies")
"""What a range of frequencies may be looked for as; it belongs to a measurement."""
PARAMETER = ("start", "bounds", "prior", "per_configuration")
ReadResponse = Callable[[Path], FrequencyResponse]
_HERTZ = Value("frequency", "frequency")


@dataclass(frozen=True, eq=False)
class FitPlan:
    """Everything :func:`identify` needs, and the true values where they are known."""

    model: Drivetrain
    measurements: tuple[Measurement, ...]
    parameters: Mapping[str, Unknown]
    options: Mapping[str, Any] = field(default_factory=dict)
    true: Mapping[str, float] = field(default_factory=dict)


def load_fit_plan(path: str | os.PathLike[str], read_response: ReadResponse) -> FitPlan:
    """Read a fit file; records are read too, and with the function given responses.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file.
    """
    file = Path(path)
    try:
        document = compose(decode(file.read_bytes(), str(file)).removeprefix("\ufeff"), str(file))
    except OSError as error:
        msg = f"{file} cannot be read: {error.strerror or error}"
        raise UsageError(msg) from None
    except ModelError as error:
        raise ModelError(presentable(error.faults), file.name) from None
    reader = _Reader(document, file, read_response)
    plan = reader.plan()
    if reader.faults or plan is None:
        raise ModelError(placed([*document.faults, *reader.faults], document), file.name)
    return plan


class _Reader:
    """Collects faults while it reads."""

    def __init__(self, document: LocatedDocument, file: Path, read_response: ReadResponse) -> None:
        self.read_response = read_response
        self.data: Mapping[Any, Any] = document.data if isinstance(document.data, dict) else {}
        self.folder = file.parent
        self.faults: list[Fault] = []

    def plan(self) -> FitPlan | None:
        rest = f"a fit file has {', '.join(KEYS)}"
        self.faults += [unknown_key(key, KEYS, (key,), rest) for key in self.data if key not in KEYS]
        if self.data.get("torsionnet") != 1:
            self.faults.append(Fault("the first entry of the file is torsionnet: 1", ("torsionnet",)))
        missing = [key for key in REQUIRED if key not in self.data]
        self.faults += [Fault(f"a fit needs {key}:", kind="missing key", about=key) for key in missing]
        model = self._model() if "model" in self.data else None
        settings = self._settings()
        parameters = dict(self._parameters())
        measurements = tuple(self._measurements(model, settings))
        if self.faults or model is None:
            return None
        options = {key: self.data[key] for key in ("residual", "loss") if key in self.data}
        options |= self._values({key: self.data[key] for key in COUNTS if key in self.data}, COUNTS, ())
        true = dict(self._numbers(self._table("true"), ("true",)))
        return FitPlan(model, measurements, parameters, options, true)

    def _model(self) -> Drivetrain | None:
        name = self.data["model"]
        try:
            return load(self.folder / name if Path(str(name)).suffix else str(name))
        except UsageError as error:
            self.faults.append(Fault(str(error), ("model",)))
        except ModelError as error:
            self.faults += [Fault(f"{name} has {len(error.faults)} errors", ("model",)), *error.faults]
        return None

    def _table(self, key: str) -> Mapping[Any, Any]:
        raw = self.data.get(key)
        if raw is None:
            return {}
        if isinstance(raw, list) and key == "parameters":
            return dict.fromkeys(raw)
        if not isinstance(raw, Mapping) or not raw:
            self.faults.append(Fault(f"expected entries by name, got {raw!r}", (key,)))
            return {}
        return raw

    def _settings(self) -> Welch | None:
        raw = self._table("settings")
        values = self._values(raw, SETTINGS, ("settings",))
        if not raw:
            return None
        preset = values.pop("preset", "")
        if preset not in ("", "paper"):
            self.faults.append(Fault(f'no preset is named "{preset}"; there is paper', ("settings", "preset")))
        try:
            return replace(PAPER if preset else Welch(), **values)
        except UsageError as error:
            self.faults.append(Fault(str(error), ("settings",)))
            return None

    def _parameters(self) -> Iterator[tuple[str, Unknown]]:
        for name, raw in self._table("parameters").items():
            path = ("parameters", name)
            entry = {"start": raw} if not isinstance(raw, Mapping) else raw
            rest = f"a parameter has {', '.join(PARAMETER)}"
            self.faults += [unknown_key(key, PARAMETER, (*path, key), rest) for key in entry if key not in PARAMETER]
            start = entry.get("start")
            pairs = {key: self._pair(entry[key], (*path, key)) for key in ("bounds", "prior") if key in entry}
            free = entry.get("per_configuration", False)
            if not isinstance(free, bool):
                self.faults.append(Fault(f"expected true or false, got {free!r}", (*path, "per_configuration")))
            try:
                value = None if start is None else self._number(start, (*path, "start") if raw is entry else path)
                yield str(name), Unknown(value, per_configuration=bool(free), **pairs)
            except UsageError as error:
                self.faults.append(Fault(str(error), path))

    def _pair(self, raw: Any, path: tuple[str, ...]) -> tuple[float, float] | None:
        if not isinstance(raw, list) or len(raw) != 2:  # noqa: PLR2004
            self.faults.append(Fault(f"expected two values [a, b], got {raw!r}", path))
            return None
        first, second = (self._number(value, path) for value in raw)
        return (first, second) if first is not None and second is not None else None

    def _number(self, raw: Any, path: tuple[str, ...]) -> float | None:
        try:
            number = scalar(raw)
        except (ExpressionError, UnitError, TypeError, ValueError) as error:
            self.faults.append(Fault(str(error), path))
            return None
        if not isinstance(number, Number):
            self.faults.append(Fault(f"expected a number with unit, got {raw!r}", path))
            return None
        return float(number.value)

    def _numbers(self, raw: Mapping[Any, Any], path: tuple[str, ...]) -> Iterator[tuple[str, float]]:
        for name, value in raw.items():
            number = self._number(value, (*path, str(name)))
            if number is not None:
                yield str(name), number

    def _values(self, raw: Mapping[Any, Any], specs: Mapping[str, Spec], path: tuple[str, ...]) -> dict[str, Any]:
        values = {}
        for key, entry in raw.items():
            if key in specs:
                try:
                    values[key] = specs[key].coerce(entry)
                except FieldError as error:
                    self.faults.append(error.fault.under(*path, key))
            elif key not in LISTED or path[0] != "measurements":
                self.faults.append(self._unknown(key, specs, path))
        return values

    def _unknown(self, key: Any, specs: Mapping[str, Spec], path: tuple[str, ...]) -> Fault:
        known = [*specs, *(LISTED if path[0] == "measurements" else ())]
        found = unknown_key(key, known, (*path, key), f"known: {', '.join(known)}")
        if path[0] != "settings" or key not in RANGES:
            return found
        where = "frequencies are chosen in each measurement, as band: [0.5 Hz, 20 Hz]"
        return replace(found, message=f'unknown key "{key}"; {where}')

    def _measurements(self, model: Drivetrain | None, settings: Welch | None) -> Iterator[Measurement]:
        for name, raw in self._table("measurements").items():
            path = ("measurements", str(name))
            if not isinstance(raw, Mapping):
                self.faults.append(Fault(f"expected {{record: FILE, output: ..., input: ...}}, got {raw!r}", path))
                continue
            values = self._values(raw, MEASUREMENT, path)
            lacking = [key for key in ("output", "input") if key not in raw]
            lacking += ["record"] if ("record" in raw) == ("response" in raw) else []
            for key in lacking:
                text = f"a measurement needs {NEEDS.get(key, key)}: {MEASUREMENT[key].description}"
                self.faults.append(Fault(text, path, on_key=True, kind="missing key", about=key))
            bands = self._bands(raw, path)
            configuration = values.get("configuration", "")
            if model is not None:
                configuration = self._configuration(model, str(name), configuration, path)
            if lacking or len(values) < len([key for key in raw if key in MEASUREMENT]):
                continue
            key = "record" if "record" in raw else "response"
            pulses = self._pulses(raw.get("pulses"), (*path, "pulses"))
            names = [values[name] for name in ("output", "input", "reference") if name in values]
            data = self._data(key, values.pop(key), names, pulses, model, path)
            if data is not None:
                more = {**values, "configuration": configuration, **bands}
                chosen = self._chosen(settings, data, bands.get("band")) if isinstance(data, Recording) else None
                yield Measurement(data, name=str(name), settings=chosen, **more)

    def _chosen(self, settings: Welch | None, record: Recording, band: tuple[float, float] | None) -> Welch:
        """Settings for one record, decimated as far as its band allows where the file does not say how."""
        if settings is None:
            return default_settings(record, band)
        if "decimation" in self._table("settings"):
            return settings
        return replace(settings, decimation=factor_for(record.sampling_rate, band[1] if band else 0.0))

    def _configuration(self, model: Drivetrain, name: str, given: str, path: tuple[str, ...]) -> str:
        if not given:
            return name if name in model.configurations else ""
        try:
            model.configured(given)
        except (UsageError, ModelError) as error:
            self.faults.append(Fault(str(error), (*path, "configuration")))
        return given

    def _bands(self, raw: Mapping[Any, Any], path: tuple[str, ...]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        if "band" in raw:
            found["band"] = self._band(raw["band"], (*path, "band"))
        if "excluded" in raw:
            listed = raw["excluded"] if isinstance(raw["excluded"], list) else []
            several = listed if listed and isinstance(listed[0], list) else [listed]
            bands = [self._band(entry, (*path, "excluded")) for entry in several]
            found["excluded"] = tuple(band for band in bands if band)
        return found

    def _band(self, raw: Any, path: tuple[str, ...]) -> tuple[float, float] | None:
        if not isinstance(raw, list) or len(raw) != 2:  # noqa: PLR2004
            self.faults.append(Fault(f"expected a band [0.5 Hz, 20 Hz], got {raw!r}", path))
            return None
        try:
            low, high = (_HERTZ.coerce(value) for value in raw)
        except FieldError as error:
            self.faults.append(error.fault.under(*path))
            return None
        if not low < high:
            self.faults.append(Fault(f"a band goes from a lower to a higher frequency, got {raw!r}", path))
            return None
        return low, high

    def _pulses(self, raw: Any, path: tuple[str, ...]) -> Mapping[str, float]:
        if raw is None:
            return {}
        if not isinstance(raw, Mapping) or not all(isinstance(one, (int, float)) and one > 0 for one in raw.values()):
            self.faults.append(Fault(f"expected the steps per revolution of channels, {{n1: 60}}, got {raw!r}", path))
            return {}
        return {str(name): float(steps) for name, steps in raw.items()}

    def _data(
        self,
        key: str,
        file: str,
        names: list[str],
        pulses: Mapping[str, float],
        model: Drivetrain | None,
        path: tuple[str, ...],
    ) -> FrequencyResponse | Recording | None:
        target = self.folder / file
        if not target.is_file():
            beside = [entry.name for entry in self.folder.iterdir()] if self.folder.is_dir() else []
            hint = did_you_mean(Path(file).name, beside)
            self.faults.append(Fault(f'there is no file "{file}"{hint}', (*path, key)))
            return None
        try:
            if key == "response":
                return self.read_response(target)
            there = channel_names(target)
            offered = [name for name in set_points(model) if name in there] if model else []
            return read_recording(target, names=list(dict.fromkeys([*names, *offered])), pulses=pulses)
        except ModelError as error:
            self.faults += [Fault(f"{file}: {fault.message}", (*path, key)) for fault in error.faults]
        except UsageError as error:
            self.faults.append(Fault(str(error), (*path, key)))
        return None
