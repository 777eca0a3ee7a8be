"""Campaign of a test: its records with conditions, the model beside them, and its reading from a file."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

from torsionnet.base.entries.declared import version_faults
from torsionnet.base.errors import Fault, ModelError, TorsionnetError, UsageError, did_you_mean, fault_of, unknown_name
from torsionnet.base.packages import NotebookResult, imported
from torsionnet.base.table import Column, Table
from torsionnet.base.version import __version__
from torsionnet.bench.campaign.campaign_file import CampaignFile, CampaignRecord, response_faults, tracked_entries
from torsionnet.drivetrain import Drivetrain, load
from torsionnet.identification.orders.parametric_orders import parameters_of_drivetrain
from torsionnet.io.wheel_files import read_wheel_pattern
from torsionnet.linear.sensitivity.unknowns import unknowns
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.definition import all_nodes
from torsionnet.model.files.fault_places import located_faults, read_document
from torsionnet.model.files.library import library_campaigns
from torsionnet.model.files.reader import is_file
from torsionnet.model.sections import REPORT_FAULTS
from torsionnet.signals.rotation.turn_pattern import check_pattern
from torsionnet.signals.rotation.wheel import WheelPattern

# Campaign of a rotating test: its records with conditions, and the model that they are compared with.


@dataclass(frozen=True, eq=False, repr=False)
class Campaign(NotebookResult):
    """Campaign of a rotating test, as its file describes it.

    Attributes
    ----------
    file : path
        File that describes it.
    folder : path
        Folder from which the files of the records are named.
    plan : CampaignFile
    model : Drivetrain
    patterns : mapping of str to WheelPattern
        Pitch patterns of the wheels that have one, by wheel.
    """

    file: Path
    folder: Path
    plan: CampaignFile
    model: Drivetrain
    patterns: Mapping[str, WheelPattern]

    @property
    def title(self) -> str:
        """Title of the campaign; without one the name of its file."""
        return self.plan.name or self.file.stem

    @property
    def of_orders(self) -> tuple[str, ...]:
        """Names of the records whose orders are tracked."""
        return tuple(name for name in self.plan.records if self._shows(name, "orders"))

    @property
    def of_responses(self) -> tuple[str, ...]:
        """Names of the records from which frequency responses are estimated."""
        return tuple(name for name in self.plan.records if self._shows(name, "responses"))

    def _shows(self, name: str, what: str) -> bool:
        asked = self.plan.orders if what == "orders" else self.plan.responses
        return asked is not None and self.plan.records[name].shows in (None, what)

    @property
    def reference(self) -> str:
        """Name of the wheel whose revolutions orders count; empty in a campaign without wheels."""
        return self.plan.reference or next(iter(self.plan.wheels), "")

    @property
    def sensors(self) -> Mapping[str, str]:
        """Sensor of the model that each channel, wheel and twist shows, by its name; those with none are left out."""
        named = {name: entry.sensor for name, entry in tracked_entries(self.plan).items()}
        given = {name: sensor or (name if name in self.model.sensors else "") for name, sensor in named.items()}
        return {name: sensor for name, sensor in given.items() if sensor}

    @property
    def model_outputs(self) -> Mapping[str, str]:
        """Sensor or node of the model that each output of the responses shows, by its channel."""
        channels, asked = self.plan.channels or {}, self.plan.responses
        return {
            name: (channels[name].sensor if name in channels else "") or name
            for name in (asked.outputs if asked else ())
        }

    def model_of(self, record: CampaignRecord) -> Drivetrain:
        """Drivetrain in the configuration of a record."""
        return self.model.configured(record.configuration) if record.configuration else self.model

    def file_of(self, record: CampaignRecord) -> Path:
        """Path of the file of a record."""
        return self.folder / record.file

    def table(self) -> Table:
        """Table of the records with their files, configurations and conditions."""
        rows = tuple(
            (name, entry.file, entry.configuration, entry.condition, entry.temperature)
            for name, entry in self.plan.records.items()
        )
        columns = ("record", "file", "configuration", "condition")
        return Table(self.title, (*map(Column, columns), Column("temperature", "K")), rows)


# Results of the records of a campaign in files, kept until the record or an entry that matters to it changes.

HASHED_BYTES = 2**20
"""Bytes of a record that are hashed together, which limits the memory."""
KEY_LENGTH = 16
"""Digits of a key, enough to tell all versions of a record apart."""


def kept_path(folder: Path, name: str, key: str) -> Path:
    """Path of the folder that holds the results of a record under a key; it is there once they are."""
    return folder / f"{name}-{key}"


def write_kept(kept: Path, fill: Callable[[Path], None]) -> None:
    """Fill a folder that has its name only when all its files are there; those of other keys are removed.

    Raises
    ------
    UsageError
        The folder cannot be written.
    """
    folder = kept.parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".writing-") as begun:
            filling = Path(begun) / kept.name
            filling.mkdir()
            fill(filling)
            filling.rename(kept)
    except OSError as error:
        raise UsageError(f"{folder} cannot be a folder of results: {error.strerror}", kind="unusable-place") from None
    for old in folder.glob(f"{kept.name[:-KEY_LENGTH]}{'[0-9a-f]' * KEY_LENGTH}"):
        if old != kept:
            shutil.rmtree(old, ignore_errors=True)


def file_name(name: str) -> str:
    """Name of a record or channel without characters that a name of a file cannot have."""
    return re.sub(r"[^\w.+-]", "_", name)


def record_key(campaign: Campaign, name: str, sections: Iterable[str]) -> str:
    """Key of what the results of a record follow from: the bytes of its file, sections, pitch patterns, version."""
    # A fit changes neither orders nor responses of a record.
    plan = replace(campaign.plan, fit=None).written_entries()
    entry = campaign.plan.records[name]
    asked = {key: plan.get(key) for key in sections}
    asked |= {"start": entry.start, "stop": entry.stop, "version": __version__, "title": campaign.title}
    asked |= {"reading": entry.reading.arguments} if entry.reading else {}
    digest = hashlib.sha256(json.dumps(asked, sort_keys=True, default=str).encode())
    for pattern in campaign.patterns.values():
        digest.update(pattern.positions.tobytes())
    with campaign.file_of(entry).open("rb") as stream:
        while block := stream.read(HASHED_BYTES):
            digest.update(block)
    return digest.hexdigest()[:KEY_LENGTH]


# Campaigns read from their files, every fault at its place.

MOST_NAMED = 6
"""Most configurations of a model that a message names."""


def load_campaign(path: str | os.PathLike[str]) -> Campaign:
    """Load a campaign from its YAML file or the library, with its model and the pitch patterns of its wheels.

    A campaign of the library has its records in the current folder.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file.
    """
    file = _find(path)
    folder = Path() if file in library_campaigns().values() else file.parent
    document = read_document(file)
    data: Mapping[Any, Any] = document.data if isinstance(document.data, dict) else {}
    entries, faults = CampaignFile.read_entries(data)
    faults = [*version_faults(data, "campaign"), *faults]
    model, further = _model(entries.get("model"), folder)
    faults += further
    patterns: dict[str, WheelPattern] = {}
    plan = None
    if not faults and model is not None:
        plan = CampaignFile(**entries)
        faults += [
            *_references(plan),
            *_doubled(plan),
            *_sensors(plan, model),
            *_records(plan, model, folder),
            *response_faults(plan, model),
            *(imported(REPORT_FAULTS)(model.definition, plan.report) if plan.report else ()),
            *_fitted(plan, model),
        ]
        patterns, further = _patterns(plan, folder)
        faults += further
    faults += document.faults
    if faults or plan is None or model is None:
        raise ModelError(located_faults(faults, document), file.name)
    return Campaign(file, folder, plan, model, patterns)


def _find(campaign: str | os.PathLike[str]) -> Path:
    known = library_campaigns()
    if isinstance(campaign, str) and not Path(campaign).suffix and not Path(campaign).exists():
        if campaign in known:
            return known[campaign]
        hint = did_you_mean(campaign, known) or f"; the library has {', '.join(known)}"
        raise UsageError(f'no campaign is named "{campaign}"{hint}', kind="unknown-name")
    return Path(campaign)


def _model(name: Any, folder: Path) -> tuple[Drivetrain | None, list[Fault]]:
    if not name:
        return None, []
    try:
        return load(folder / name if Path(name).suffix else name), []
    except UsageError as error:
        return None, [replace(error.fault, path=("model",))]
    except ModelError as error:
        return None, [Fault(f"{name} has {len(error.faults)} errors", ("model",), kind=error.kind), *error.faults]


def _references(plan: CampaignFile) -> Iterator[Fault]:
    wheels = list(plan.wheels)
    known = f"wheels: {', '.join(wheels) or 'none'}"
    if plan.reference and plan.reference not in wheels:
        text = f'no wheel is named "{plan.reference}"{did_you_mean(plan.reference, wheels)}'
        yield Fault(f"{text}; {known}", ("reference",), kind="unknown-name")
    if not plan.reference and len(wheels) > 1:
        yield Fault(f"say with reference: which wheel turns with the shaft whose revolutions orders count; {known}",
                    on_key=True, kind="missing-entry")  # fmt: skip
    for name, twist in (plan.twists or {}).items():
        for key in ("first", "second"):
            if (given := getattr(twist, key)) not in wheels:
                text = f'no wheel is named "{given}"{did_you_mean(given, wheels)}'
                yield Fault(f"{text}; {known}", ("twists", name, key), kind="unknown-name")


def _doubled(plan: CampaignFile) -> Iterator[Fault]:
    """Faults of names that stand in two of the sections channels, wheels and twists."""
    sections = {"wheels": plan.wheels, "channels": plan.channels or {}, "twists": plan.twists or {}}
    for (first, some), (second, others) in combinations(sections.items(), 2):
        for name in others:
            if name in some:
                yield Fault(
                    f"{first} has {name}, too; give one of them another name",
                    (second, name),
                    on_key=True,
                    kind="repeated-name",
                )


def _sensors(plan: CampaignFile, model: Drivetrain) -> Iterator[Fault]:
    sections = (("wheels", plan.wheels), ("channels", plan.channels or {}), ("twists", plan.twists or {}))
    for section, entries in sections:
        for name, entry in entries.items():
            sensor = named_sensor(entry.sensor, model.definition.sensors) if entry.sensor else None
            if sensor is not None:
                yield from (fault.under(section, name, "sensor") for fault in _unreadable(sensor, model))
            elif entry.sensor:
                hint = did_you_mean(entry.sensor, model.sensors)
                text = f'no sensor is named "{entry.sensor}"{hint}; sensors: {", ".join(model.sensors) or "none"}'
                yield Fault(
                    f"{text}; or write it out, as angle(node)", (section, name, "sensor"), kind="unknown-channel"
                )


def _unreadable(sensor: Sensor, model: Drivetrain) -> Iterator[Fault]:
    """Yield a fault if a sensor is on a node or an element that the model does not have."""
    elements = model.definition.elements
    known = list(elements) if sensor.is_on_element else list(all_nodes(elements.values()))
    for name in (sensor.of,) if sensor.is_on_element else sensor.nodes:
        if name not in known:
            what = "element" if sensor.is_on_element else "node"
            fault = unknown_name(what, name, known)
            yield replace(fault, message=f"{sensor}: {fault.message}")


def _records(plan: CampaignFile, model: Drivetrain, folder: Path) -> Iterator[Fault]:
    for name, record in plan.records.items():
        if not is_file(folder / record.file):
            beside = [path.name for path in folder.iterdir()] if folder.is_dir() else []
            hint = did_you_mean(Path(record.file).name, beside)
            yield Fault(f'there is no file "{record.file}"{hint}', ("records", name, "file"), kind="missing-file")
        if record.shows and not getattr(plan, record.shows):
            yield Fault(f"the campaign has no section {record.shows}", ("records", name, "shows"), kind="missing-entry")
        if not record.configuration and model.configurations:
            known = ", ".join(model.configurations[:MOST_NAMED])
            more = "" if len(model.configurations) <= MOST_NAMED else ", ..."
            text = f"a record is of one configuration of the model: name one of {known}{more}"
            yield Fault(text, ("records", name), on_key=True, kind="missing-entry", about="configuration")
        if record.configuration:
            try:
                model.configured(record.configuration)
            except TorsionnetError as error:
                yield replace(fault_of(error, error.kind), path=("records", name, "configuration"))


def _fitted(plan: CampaignFile, model: Drivetrain) -> Iterator[Fault]:
    if plan.fit is None:
        return
    if not plan.fit.parameters and not plan.fit.rank:
        yield Fault("a fit needs parameters, or rank: true", ("fit",), on_key=True, kind="missing-entry")
    for name in plan.fit.parameters or ():
        try:
            unknowns(model, parameters_of_drivetrain(model, [name]))
        except UsageError as error:
            yield replace(error.fault, path=("fit", "parameters", name))


def _patterns(plan: CampaignFile, folder: Path) -> tuple[dict[str, WheelPattern], list[Fault]]:
    """Pitch patterns of the wheels that have one, and the faults of their files."""
    patterns: dict[str, WheelPattern] = {}
    faults: list[Fault] = []
    for name, wheel in plan.wheels.items():
        place = ("wheels", name, "pattern")
        if not wheel.pattern_file:
            continue
        try:
            patterns[name] = read_wheel_pattern(folder / wheel.pattern)
            check_pattern(name, wheel, patterns[name])
        except ModelError as error:
            faults += [Fault(f"{wheel.pattern}: {fault.message}", place, kind=fault.kind) for fault in error.faults]
        except UsageError as error:
            faults.append(replace(error.fault, path=place))
    return patterns, faults
