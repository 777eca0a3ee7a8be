"""``torsionnet schema``."""

from __future__ import annotations

import click

from torsionnet.cli.options import output_file_option
from torsionnet.cli.output_schema import OUTPUTS, output_schema_text
from torsionnet.cli.terminal import wrote
from torsionnet.core.atomic import write_text


@click.command("schema")
@click.option(
    "--json-of",
    "of",
    type=click.Choice(sorted(OUTPUTS)),
    metavar="COMMAND",
    help="Of what a command prints with --json instead.",
)
@output_file_option("Write it to a file instead.")
def command(of: str | None, output_file: str | None) -> None:
    """Print the JSON Schema of model files, with which editors complete, explain and check them.

    First line of a model file: # yaml-language-server: $schema=torsionnet.schema.json
    """
    from torsionnet.model.files.model_schema import schema_text

    text = output_schema_text(of) if of else schema_text()
    if output_file is None:
        click.echo(text, nl=False)
    else:
        write_text(output_file, text)
        wrote(output_file)
