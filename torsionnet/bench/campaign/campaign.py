"""Campaign of a rotating test: its records with conditions, and the model that they are compared with."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from torsionnet.base.errors import UsageError
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.base.version import __version__
from torsionnet.bench.campaign.campaign_file import CampaignFile, CampaignRecord, tracked_entries
from torsionnet.drivetrain import Drivetrain
from torsionnet.signals.rotation.wheel import WheelPattern


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
        named = {name: one.sensor for name, one in tracked_entries(self.plan).items()}
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
            (name, one.file, one.configuration, one.condition, one.temperature)
            for name, one in self.plan.records.items()
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
        raise UsageError(f"{folder} cannot be a folder of results: {error.strerror}") from None
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
    one = campaign.plan.records[name]
    asked = {key: plan.get(key) for key in sections}
    asked |= {"start": one.start, "stop": one.stop, "version": __version__, "title": campaign.title}
    asked |= {"reading": one.reading.arguments} if one.reading else {}
    digest = hashlib.sha256(json.dumps(asked, sort_keys=True, default=str).encode())
    for pattern in campaign.patterns.values():
        digest.update(pattern.positions.tobytes())
    with campaign.file_of(one).open("rb") as stream:
        while block := stream.read(HASHED_BYTES):
            digest.update(block)
    return digest.hexdigest()[:KEY_LENGTH]
