"""``torsionnet import``."""

from __future__ import annotations

import click

from torsionnet.cli.options import OutputFile
from torsionnet.cli.terminal import wrote


@click.command("import")
@click.argument("source", metavar="FILE")
@click.option(
    "-o", "--output", "file", type=OutputFile((".yaml", ".yml")), help="The model file to write; default: stdout."
)
def command(source: str, file: str | None) -> None:
    """Make a model file of a model of another program: a TORS file of openTorsion or its editor.

    \b
    torsionnet import thruster.tors -o thruster.yaml
    """  # noqa: D301
    from torsionnet.interchange.tors_reading import read_tors

    text = read_tors(source).to_yaml(file)
    if file is None:
        click.echo(text, nl=False)
    else:
        wrote(file)
