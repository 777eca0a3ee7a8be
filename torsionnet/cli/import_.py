"""``torsionnet import``."""

from __future__ import annotations

from torsionnet.cli.command import Answer, Command, click_command, text_answer
from torsionnet.cli.declarations import argument
from torsionnet.cli.options import file_option


class ImportCommand(Command):
    """Make a model file of a model of another program: a TORS file of openTorsion or its editor.

    \b
    torsionnet import thruster.tors -o thruster.yaml
    """

    source: str = argument("FILE")
    output_file: str | None = file_option("The model file to write; default: stdout.", (".yaml", ".yml"))

    def answer(self) -> Answer:
        from torsionnet.io.tors_reading import read_tors

        return text_answer(read_tors(self.source).to_yaml(), self.output_file)


command = click_command("import", ImportCommand)
