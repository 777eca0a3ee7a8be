"""``torsionnet library``."""

from __future__ import annotations

from torsionnet.cli.command import JSON, Answer, Command, click_command


class LibraryCommand(Command):
    """List the models that come with the package; use their names in place of a file."""

    forms = JSON

    def answer(self) -> Answer:
        from torsionnet.model.files import library_entry, library_models
        from torsionnet.response.table import Column, Table

        rows = tuple((name, *library_entry(path), str(path)) for name, path in library_models().items())
        names = ("name", "what", "source", "file")
        return Answer(
            screen=lambda: [Table("", tuple(map(Column, names)), rows).chosen(range(3))],
            data=lambda: [dict(zip(names, row, strict=True)) for row in rows],
        )


command = click_command("library", LibraryCommand)
