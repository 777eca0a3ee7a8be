"""Reader of fit files (YAML) with model, measurements, parameters and settings of a fit."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from torsionnet.base.entries.declared import version_faults
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean, fault_of
from torsionnet.drivetrain import Drivetrain, load
from torsionnet.identification.orders.order_lines import OrderData, faults_of_orders, read_order_data, shows_phases
from torsionnet.identification.orders.parametric_orders import numbers_of_excitations
from torsionnet.identification.plan.fit_entries import (
    FileReading,
    FitFile,
    FitMeasurement,
    FitParameter,
    FitSettings,
    Unknown,
)
from torsionnet.identification.residuals.measurement import Measurement, set_points
from torsionnet.identification.residuals.measurement_blocks import record_settings, welch_settings
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.files.fault_places import located_faults, read_document
from torsionnet.model.files.located_yaml import LocatedDocument
from torsionnet.model.files.reader import is_file
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import channel_names, read_even
from torsionnet.signals.stepped_levels import SteppedStiffness
from torsionnet.signals.welch import Welch

SAME_ENTRIES = (
    "output", "input", "model_output", "model_input", "excitation", "band", "excluded", "delay", "gain", "reference",
    "settling", "error", "orders_used", "speeds", "speed_of", "reference_angle", "between",
    "equations", "moving_inertia",
)  # fmt: skip
"""Entries of a measurement in a fit file that a :class:`Measurement` takes under the same name."""
OPTIONS = ("residual", "loss", "starts")
"""Entries of a fit file that are passed on to :func:`identify` as its options of the same name."""
ReadResponse = Callable[[Path], FrequencyResponse]


@dataclass(frozen=True, eq=False)
class FitPlan:
    """Contents of a fit file as arguments of :func:`identify`, with true values of parameters where they are known."""

    model: Drivetrain
    measurements: tuple[Measurement, ...]
    parameters: Mapping[str, Unknown]
    options: Mapping[str, Any] = field(default_factory=dict)
    true: Mapping[str, float] = field(default_factory=dict)


def load_fit_plan(path: str | os.PathLike[str], read_response: ReadResponse, *, ranks_alone: bool = False) -> FitPlan:
    """Contents of a fit file with its records, and with responses read by the function ``read_response``.

    With ``ranks_alone`` it may name no parameters, as :func:`rank_causes` needs none.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file.
    """
    file = Path(path)
    document = read_document(file)
    reader = _Reader(document, file, read_response)
    if not ranks_alone and "parameters" not in reader.data:
        reader.faults.append(
            Fault("a fit needs parameters: entries by name; fit --rank does without", on_key=True, kind="missing-entry")
        )
    plan = reader.plan()
    if reader.faults or plan is None:
        raise ModelError(located_faults([*document.faults, *reader.faults], document), file.name)
    return plan


class _Reader:
    """Reader of one fit file that collects its faults with their places."""

    def __init__(self, document: LocatedDocument, file: Path, read_response: ReadResponse) -> None:
        self.read_response = read_response
        self.data: Mapping[Any, Any] = document.data if isinstance(document.data, dict) else {}
        self.folder = file.parent
        self.faults: list[Fault] = []
        self.entries: dict[str, Any] = {}

    def plan(self) -> FitPlan | None:
        self.faults += version_faults(self.data, "fit")
        self.entries, faults = FitFile.read_entries(self.data)
        self.faults += faults
        model = self._model() if self.entries.get("model") else None
        settings = self._settings()
        parameters = dict(self._parameters())
        measurements = tuple(self._measurements(model, settings))
        if model is not None:
            self._check_excitations(model, parameters, measurements)
        if self.faults or model is None:
            return None
        options: dict[str, Any] = {key: value for key, value in self.entries.items() if key in OPTIONS}
        return FitPlan(model, measurements, parameters, options, self.entries.get("true") or {})

    def _model(self) -> Drivetrain | None:
        name = self.entries["model"]
        try:
            return load(self.folder / name if Path(name).suffix else name)
        except UsageError as error:
            self.faults.append(replace(error.fault, path=("model",)))
        except ModelError as error:
            self.faults += [
                Fault(f"{name} has {len(error.faults)} errors", ("model",), kind=error.kind),
                *error.faults,
            ]
        return None

    def _settings(self) -> Welch | None:
        settings: FitSettings | None = self.entries.get("settings")
        if settings is None:
            return None
        try:
            return welch_settings(settings)
        except UsageError as error:
            self.faults.append(replace(error.fault, path=("settings",)))
            return None

    def _parameters(self) -> Iterator[tuple[str, Unknown]]:
        for name, given in (self.entries.get("parameters") or {}).items():
            entries: FitParameter = given or FitParameter()
            try:
                yield name, Unknown(entries.start, entries.bounds, entries.prior, entries.per_configuration)
            except UsageError as error:
                self.faults.append(replace(error.fault, path=("parameters", name)))

    def _check_excitations(
        self, model: Drivetrain, parameters: Mapping[str, Unknown], measurements: Sequence[Measurement]
    ) -> None:
        """Note faults of numbers of excitations to be found that there are not, or that the orders do not show."""
        of_orders = [measurement for measurement in measurements if measurement.has_orders]
        blind = bool(of_orders) and not any(shows_phases(measurement) for measurement in of_orders)
        listed = isinstance(self.data.get("parameters"), list)
        for place, name in enumerate(parameters):
            path = ("parameters", place if listed else name)
            try:
                number = numbers_of_excitations(model, [name]).get(name)
            except UsageError as error:
                self.faults.append(replace(error.fault, path=path))
                continue
            if number is not None and number.is_phase and blind:
                text = f"{name} is a phase, and no measurement of orders has phases against a reference"
                self.faults.append(
                    Fault(f"{text}; track the orders against a pulse, or fix it", path, kind="missing-data")
                )

    def _measurements(self, model: Drivetrain | None, settings: Welch | None) -> Iterator[Measurement]:
        for name, given in self.entries.get("measurements", {}).items():
            path = ("measurements", name)
            configuration = self._configuration(model, name, given.configuration, path) if model else ""
            data = self._data(given, model, path, configuration)
            if data is None:
                continue
            more = {key: getattr(given, key) for key in SAME_ENTRIES}
            averaged = data if isinstance(data, Recording) and not given.equations else None
            chosen = None if averaged is None else self._chosen(settings, averaged, given.band)
            try:
                measurement = Measurement(data, name=name, settings=chosen, configuration=configuration, **more)
            except UsageError as error:
                self.faults.append(replace(error.fault, path=path))
                continue
            if model is not None and measurement.has_orders:
                self.faults += [fault.under("measurements", name) for fault in faults_of_orders(model, measurement)]
            yield measurement

    def _chosen(self, settings: Welch | None, record: Recording, band: tuple[float, float] | None) -> Welch:
        """Welch settings of one record, by default decimated as far as the band of the measurement allows."""
        asked = self.entries.get("settings")
        return record_settings(record, band, settings, asked.decimation if asked else None)

    def _configuration(self, model: Drivetrain, name: str, given: str, path: tuple[str, ...]) -> str:
        try:
            if not given:
                return model.configured(name).configuration
            model.configured(given)
        except (UsageError, ModelError) as error:
            if not given:
                return ""
            self.faults.append(replace(fault_of(error, error.kind), path=(*path, "configuration")))
        return given

    def _data(
        self, given: FitMeasurement, model: Drivetrain | None, path: tuple[str, ...], configuration: str
    ) -> FrequencyResponse | Recording | SteppedStiffness | OrderData | None:
        key = next(name for name in given.SOURCES if getattr(given, name) is not None)
        file = str(getattr(given, key))
        target = self.folder / file
        if not is_file(target):
            beside = [entry.name for entry in self.folder.iterdir()] if self.folder.is_dir() else []
            hint = did_you_mean(Path(file).name, beside)
            self.faults.append(Fault(f'there is no file "{file}"{hint}', (*path, key), kind="missing-file"))
            return None
        try:
            if key == "response":
                return self.read_response(target)
            if key == "orders":
                return read_order_data(target, given.output, given.model_output, model, configuration)
            reading = given.reading or FileReading()
            there = channel_names(target, **reading.dialect)
            offered = [name for name in set_points(model) if name in there] if model else []
            wanted = [name for name in (given.output, given.input, given.reference) if name]
            names = list(dict.fromkeys([*wanted, *offered]))
            record = read_even(target, names=names, pulses=given.pulses, **reading.arguments)
            return record.stepped_stiffness(given.input, given.output) if key == "stepped" else record
        except ModelError as error:
            self.faults += [Fault(f"{file}: {fault.message}", (*path, key), kind=fault.kind) for fault in error.faults]
        except UsageError as error:
            self.faults.append(replace(error.fault, path=(*path, key)))
        return None
