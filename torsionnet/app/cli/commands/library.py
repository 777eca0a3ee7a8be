"""Command ``torsionnet library``, which lists the models and studies that come with the package."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from torsionnet.app.cli.command import JSON, Answer, Command, click_command
from torsionnet.base.result_rows import Out

if TYPE_CHECKING:
    from torsionnet.base.entries.spec import Schema

LIBRARY_KIND: Schema = {"enum": ["model", "part", "catalogue", "study", "campaign"]}
"""JSON Schema of the kind of a library file, such as a model or a part."""


@dataclass(frozen=True)
class LibraryRow:
    """File of the library, as ``torsionnet library --json`` prints it."""

    name: Annotated[str, Out("name")]
    kind: Annotated[str, Out("kind", schema=LIBRARY_KIND)]
    what: Annotated[str, Out("what")]
    source: Annotated[str, Out("source")]
    file: str


class LibraryCommand(Command):
    """List models, studies and campaigns of the package, to be named in place of a file, parts and catalogues."""

    forms = JSON

    def answer(self) -> Answer:
        from torsionnet.base.table import result_table
        from torsionnet.model.files import library_entry, library_models, library_studies
        from torsionnet.model.files.library import (
            catalogue_entry,
            library_campaigns,
            library_catalogues,
            library_parts,
            study_entry,
        )

        kinds = (
            ("model", library_models(), library_entry),
            ("study", library_studies(), study_entry),
            ("campaign", library_campaigns(), study_entry),
            ("part", library_parts(), library_entry),
            ("catalogue", library_catalogues(), catalogue_entry),
        )
        rows = [
            LibraryRow(name, kind, *read(path), str(path))
            for kind, files, read in kinds
            for name, path in files.items()
        ]
        return Answer(screen=lambda: [result_table("", rows, LibraryRow)], data=lambda: rows)


command = click_command("library", LibraryCommand)
