"""``torsionnet schema``."""

from __future__ import annotations

import click

from torsionnet.atomic import write_text
from torsionnet.cli.options import OutputFile
from torsionnet.cli.terminal import wrote


@click.command("schema")
@click.option("-o", "--output", "file", type=OutputFile(), help="Write it to a file instead.")
def command(file: str | None) -> None:
    """Print the JSON Schema of model files, with which editors complete, explain and check them.

    First line of a model file: # yaml-language-server: $schema=torsionnet.schema.json
    """
    from torsionnet.files.schema import schema_text

    if file is None:
        click.echo(schema_text(), nl=False)
    else:
        write_text(file, schema_text())
        wrote(file)
