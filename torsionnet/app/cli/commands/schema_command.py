"""Command ``torsionnet schema``, which prints the JSON Schema of model, bench, fit, study or campaign files."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.command import Answer, Command, text_answer
from torsionnet.app.cli.options import file_option, option
from torsionnet.app.cli.output import OUTPUTS, output_schema_text

if TYPE_CHECKING:
    from torsionnet.base.entries.declared import Declared


class SchemaCommand(Command):
    """Print the JSON Schema of model, bench, fit, study or campaign files, by which editors check and explain them.

    First line of a model file: # yaml-language-server: $schema=torsionnet.schema.json

    \b
    torsionnet schema -o torsionnet.schema.json
    torsionnet schema --kind study
    torsionnet schema --json-of modes
    """

    kind: str = option(
        "--kind",
        type=click.Choice(["model", "fit", "study", "campaign"]),
        default="model",
        show_default=True,
        help="Which kind of file; a bench is part of a model, or a file that names one.",
    )
    of: str | None = option(
        "--json-of",
        type=click.Choice(sorted(OUTPUTS)),
        metavar="COMMAND",
        help="Of what a command prints with --json instead.",
    )
    output_file: str | None = file_option("Write it to a file instead.")

    def answer(self) -> Answer:
        text = output_schema_text(self.of) if self.of else _of_file(self.kind)
        return text_answer(text, self.output_file)


def _of_file(kind: str) -> str:
    from torsionnet.model.files.model_schema import file_schema, schema_text

    if kind == "model":
        return schema_text()
    return json.dumps(file_schema(_entries(kind)), indent=1, ensure_ascii=False) + "\n"


def _entries(kind: str) -> type[Declared]:
    if kind == "fit":
        from torsionnet.identification.plan.fit_entries import FitFile

        return FitFile
    if kind == "campaign":
        from torsionnet.bench.campaign.campaign_file import CampaignFile

        return CampaignFile
    from torsionnet.study.study_file import StudyEntries

    return StudyEntries
