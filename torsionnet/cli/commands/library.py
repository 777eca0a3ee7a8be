"""``torsionnet library``."""

from __future__ import annotations

from torsionnet.cli.command import JSON, Answer, Command, click_command


class LibraryCommand(Command):
    """List the models and studies that come with the package, to be named in place of a file, parts and catalogues."""

    forms = JSON

    def answer(self) -> Answer:
        from torsionnet.model.files import library_entry, library_models, library_studies
        from torsionnet.model.files.library import catalogue_entry, library_catalogues, library_parts, study_entry
        from torsionnet.response.table import Column, Table

        kinds = (
            ("model", library_models(), library_entry),
            ("study", library_studies(), study_entry),
            ("part", library_parts(), library_entry),
            ("catalogue", library_catalogues(), catalogue_entry),
        )
        rows = tuple(
            (name, kind, *read(path), str(path)) for kind, files, read in kinds for name, path in files.items()
        )
        names = ("name", "kind", "what", "source", "file")
        return Answer(
            screen=lambda: [Table("", tuple(map(Column, names)), rows).chosen(range(4))],
            data=lambda: [dict(zip(names, row, strict=True)) for row in rows],
        )


command = click_command("library", LibraryCommand)
