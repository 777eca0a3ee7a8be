"""Entry of a mass-elastic sheet in a file beside the model file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from torsionnet.base.entries.declared import nearby_file
from torsionnet.base.entries.spec import EntryError, Schema, Spec, full_name
from torsionnet.base.errors import Fault, ModelError, got
from torsionnet.model.sheets.factor_readings import READINGS
from torsionnet.model.sheets.mass_elastic_sheet import MassElasticSheet, SheetReading, read_sheet
from torsionnet.model.sheets.sheet_remarks import SIDES

FILE = "file"
"""Key of the name of the file where the entry of a sheet has others, too."""
_CHOICES = {"values": SIDES, "factors": READINGS}


class SheetEntry(Spec[MassElasticSheet]):
    """Entry that names the file of a mass-elastic sheet.

    The name of a file in the folder of the model file, or below; with what its sheet leaves open, as
    ``{file: engine.csv, factors: unit}``.
    """

    @property
    def example(self) -> str:
        return "the name of a file beside the model, as engine.csv"

    def coerce(self, raw: object) -> MassElasticSheet:
        if isinstance(raw, MassElasticSheet):
            return raw
        said: dict[str, str] = {}
        if isinstance(raw, Mapping):
            said = {str(key): value for key, value in raw.items() if key != FILE}
            for key, value in said.items():
                allowed = _CHOICES.get(key, ())
                if value not in allowed:
                    text = f"expected {' or '.join(allowed)}" if allowed else f"a sheet has {FILE}, values and factors"
                    raise EntryError(Fault(f"{text}, {got(value if allowed else key)}", (key,), on_key=not allowed))
            raw = raw.get(FILE)
        if not isinstance(raw, str | Path):
            raise EntryError(f"expected the name of a sheet, as engine.csv, {got(raw)}")
        reading = SheetReading(**said)
        try:
            if isinstance(raw, Path):
                return read_sheet(raw, reading=reading)
            return read_sheet(nearby_file(raw), raw, reading)
        except ModelError as error:
            count = f"{len(error.faults)} fault{'s' if len(error.faults) > 1 else ''}"
            raise EntryError([Fault(f'the sheet "{raw}" cannot be used; {count} in it'), *error.faults]) from None
        except OSError as error:
            raise EntryError(f'the sheet "{raw}" cannot be read: {error.strerror or error}') from None

    def plain(self, value: Any) -> str | dict[str, str]:
        said = {key: text for key, text in asdict(value.reading).items() if text}
        return {FILE: str(value.file), **said} if said else str(value.file)

    def schema(self) -> Schema:
        name: Schema = {"type": "string", "description": self.description}
        choices: dict[str, Schema]
        choices = {key: {"type": "string", "enum": list(allowed)} for key, allowed in _CHOICES.items()}
        mapping: Schema = {"type": "object", "properties": {FILE: {"type": "string"}, **choices}, "required": [FILE],
                   "additionalProperties": False}  # fmt: skip
        return {"anyOf": [name, mapping], "description": self.description}

    @property
    def accepted(self) -> str:
        return f"str | pathlib.Path | collections.abc.Mapping[str, str] | {full_name(MassElasticSheet)}"
