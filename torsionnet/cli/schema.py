"""``torsionnet schema``."""

from __future__ import annotations

import click

from torsionnet.atomic import write_text
from torsionnet.cli.options import output_file_option
from torsionnet.cli.terminal import wrote


@click.command("schema")
@output_file_option("Write it to a file instead.")
def command(output_file: str | None) -> None:
    """Print the JSON Schema of model files, with which editors complete, explain and check them.

    First line of a model file: # yaml-language-server: $schema=torsionnet.schema.json
    """
    from torsionnet.files.schema import schema_text

    if output_file is None:
        click.echo(schema_text(), nl=False)
    else:
        write_text(output_file, schema_text())
        wrote(output_file)
