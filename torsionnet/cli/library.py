"""``torsionnet library``."""

from __future__ import annotations

import click

from torsionnet.cli.options import json_option
from torsionnet.cli.terminal import print_json, print_table
from torsionnet.model.files import library_entry, library_models


@click.command("library")
@json_option
def command(as_json: bool) -> None:
    """List the models that come with the package; use their names in place of a file."""
    entries = {name: (*library_entry(path), path) for name, path in library_models().items()}
    if as_json:
        print_json(
            [
                {"name": name, "what": what, "source": source, "file": str(path)}
                for name, (what, source, path) in entries.items()
            ]
        )
        return
    from torsionnet.response.table import Column, Table

    rows = tuple((name, what, source) for name, (what, source, _) in entries.items())
    print_table(Table("", (Column("name"), Column("what"), Column("source")), rows))
