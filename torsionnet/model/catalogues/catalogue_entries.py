"""Entries of an element that name a catalogue and the size in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.spec import EntryError, Schema, Spec
from torsionnet.base.errors import got

if TYPE_CHECKING:
    from torsionnet.model.catalogues.catalogue import CatalogueRow

CATALOGUE, SIZE = "catalogue", "size"
"""Names of the entries of an element for its catalogue and its size."""


class CatalogueEntry(Spec["CatalogueRow"]):
    """Entry of the name of a catalogue: a file beside the model, or one that comes with the package."""

    def coerce(self, raw: object) -> CatalogueRow:
        from torsionnet.model.catalogues.catalogue import CatalogueRow

        if isinstance(raw, CatalogueRow):
            return raw
        raise EntryError(
            f"by its name a catalogue is found beside a model file; in Python give Path({raw!r})", kind="missing-file"
        )

    def plain(self, value: Any) -> str:
        return str(value.file)

    def schema(self) -> Schema:
        return {"type": "string", "description": self.description}

    @property
    def accepted(self) -> str:
        catalogue = "torsionnet.model.catalogues.catalogue"
        return f"pathlib.PurePath | {catalogue}.Catalogue | {catalogue}.CatalogueRow"


class SizeName(Spec[str]):
    """Entry of a size in a catalogue, which may look like a number."""

    def coerce(self, raw: object) -> str:
        if isinstance(raw, bool) or not isinstance(raw, str | int | float):
            raise EntryError(f"expected the size as the catalogue names it, {got(raw)}", kind="wrong-form")
        return str(raw)

    def schema(self) -> Schema:
        return {"type": ["string", "number"], "description": self.description}

    @property
    def accepted(self) -> str:
        return "str | float"
