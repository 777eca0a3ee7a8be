"""``torsionnet import``."""

from __future__ import annotations

import click

from torsionnet.cli.options import output_file_option
from torsionnet.cli.terminal import wrote


@click.command("import")
@click.argument("source", metavar="FILE")
@output_file_option("The model file to write; default: stdout.", (".yaml", ".yml"))
def command(source: str, output_file: str | None) -> None:
    """Make a model file of a model of another program: a TORS file of openTorsion or its editor.

    \b
    torsionnet import thruster.tors -o thruster.yaml
    """
    from torsionnet.io.tors_reading import read_tors

    text = read_tors(source).to_yaml(output_file)
    if output_file is None:
        click.echo(text, nl=False)
    else:
        wrote(output_file)
