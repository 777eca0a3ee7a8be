"""Entry of a mass-elastic sheet in a file beside the model file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from torsionnet.core.entries.named_files import nearby_file
from torsionnet.core.entries.spec import EntryError, Schema, Spec, full_name
from torsionnet.core.errors import Fault, ModelError
from torsionnet.model.sheets.mass_elastic_sheet import MassElasticSheet, read_sheet


class SheetEntry(Spec[MassElasticSheet]):
    """Entry that names the file of a mass-elastic sheet.

    The name of a file in the folder of the model file, or below.
    """

    @property
    def example(self) -> str:
        return "the name of a file beside the model, as engine.csv"

    def coerce(self, raw: object) -> MassElasticSheet:
        if isinstance(raw, MassElasticSheet):
            return raw
        if not isinstance(raw, str | Path):
            raise EntryError(f"expected the name of a sheet, as engine.csv, got {raw!r}")
        try:
            return read_sheet(raw) if isinstance(raw, Path) else read_sheet(nearby_file(raw), raw)
        except ModelError as error:
            count = f"{len(error.faults)} fault{'s' if len(error.faults) > 1 else ''}"
            raise EntryError([Fault(f'the sheet "{raw}" cannot be used; {count} in it'), *error.faults]) from None
        except OSError as error:
            raise EntryError(f'the sheet "{raw}" cannot be read: {error.strerror or error}') from None

    def plain(self, value: Any) -> str:
        return str(value.file)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        return f"str | pathlib.Path | {full_name(MassElasticSheet)}"
