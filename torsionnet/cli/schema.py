"""``torsionnet schema``."""

from __future__ import annotations

import json

import click

from torsionnet.cli.options import output_file_option
from torsionnet.cli.output_schema import OUTPUTS, output_schema_text
from torsionnet.cli.terminal import wrote
from torsionnet.core.atomic import write_text


@click.command("schema")
@click.option(
    "--file",
    "kind",
    type=click.Choice(["model", "fit"]),
    default="model",
    show_default=True,
    help="Which kind of file; a bench is part of a model, or a file that names one.",
)
@click.option(
    "--json-of",
    "of",
    type=click.Choice(sorted(OUTPUTS)),
    metavar="COMMAND",
    help="Of what a command prints with --json instead.",
)
@output_file_option("Write it to a file instead.")
def command(kind: str, of: str | None, output_file: str | None) -> None:
    """Print the JSON Schema of model, bench or fit files, with which editors complete, explain and check them.

    First line of a model file: # yaml-language-server: $schema=torsionnet.schema.json
    """
    text = output_schema_text(of) if of else _of_file(kind)
    if output_file is None:
        click.echo(text, nl=False)
    else:
        write_text(output_file, text)
        wrote(output_file)


def _of_file(kind: str) -> str:
    from torsionnet.model.files.model_schema import file_schema, schema_text

    if kind == "model":
        return schema_text()
    from torsionnet.model.fit import FitFile

    return json.dumps(file_schema(FitFile), indent=1, ensure_ascii=False) + "\n"
