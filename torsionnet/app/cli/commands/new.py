"""``torsionnet new``."""

from __future__ import annotations

import os
from importlib.resources import files
from pathlib import Path
from typing import Any

import click

from torsionnet.app.cli.command import Answer, Command, click_command, text_answer
from torsionnet.app.cli.options import OutputFile, argument, option
from torsionnet.base.errors import readable_text

KINDS = ("ship", "genset", "rig", "train", "turbine")
"""Kinds of starting models; each is a file of that name in the folder ``app/cli/starting_models``."""

ENDINGS = (".yaml", ".yml")
STDOUT = "-"
_NAME_LINE = "name: NAME\n"


class NewFile(OutputFile):
    """Type of the path of a model file that does not exist yet, or - for standard output."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == STDOUT:
            return value
        path = super().convert(value, param, ctx)
        if os.path.lexists(path):
            self.fail(f'"{path}" exists already and is not overwritten; name another file by -o FILE', param, ctx)
        return path


MODEL_FILE = NewFile(ENDINGS)


class NewCommand(Command):
    """Write a commented model file to start from; all its figures are examples to be replaced.

    \b
    KIND:
      ship     two-stroke engine coupled directly to a propeller, limits of IACS UR M68, misfire
      genset   four-stroke engine, rubber coupling, generator, in its speed band
      rig      test rig from which parameters are found by frequency responses
      train    motor, reduction gear, reciprocating compressor
      turbine  wind turbine with two planetary stages

    NAME is the name of the model, or the path of the file with or without .yaml: NAME.yaml is written. A file that
    exists is never overwritten.

    \b
    torsionnet new ship sagafjord
    torsionnet new ship "M/S Sagafjord" -o sagafjord.yaml
    """

    kind: str = argument("KIND")
    name: str = argument("NAME")
    output_file: str | None = option(
        "-o", "--output-file", type=MODEL_FILE, help="The model file to write instead of NAME.yaml; - prints it."
    )

    def answer(self) -> Answer:
        if self.kind not in KINDS:
            from torsionnet.base.errors import did_you_mean

            hint = did_you_mean(self.kind, KINDS) or f"; there are {', '.join(KINDS)}"
            raise click.UsageError(f'no kind of starting model is named "{self.kind}"{hint}')
        path, name = _path_and_name(self.name, is_path=self.output_file is None)
        file = self.output_file or MODEL_FILE.convert(path, None, None)
        return text_answer(starting_model(self.kind, name), None if file == STDOUT else file)


def starting_model(kind: str, name: str) -> str:
    """Text of a model file of a kind of plant, with the name given in the place of the placeholder."""
    from torsionnet.model.files.writer import scalar_text

    template = (files("torsionnet.app.cli") / "starting_models" / f"{kind}.yaml").read_text(encoding="utf-8")
    return template.replace(_NAME_LINE, f"name: {scalar_text(readable_text(name))}\n", 1)


def _path_and_name(given: str, *, is_path: bool) -> tuple[str, str]:
    """Path of the file and name of the model; a name that is no path may have slashes in it."""
    path = given if given.lower().endswith(ENDINGS) else f"{given}.yaml"
    name = path[: path.rindex(".")]
    if is_path:
        name = "" if given.endswith(("/", os.sep)) else Path(name).name
    if not name.strip().strip("."):
        raise click.UsageError(f'"{given}" is no name of a model: give one, as in "torsionnet new ship sagafjord"')
    if name == STDOUT:
        raise click.UsageError("- is no name of a model: give one, and -o - prints the file")
    return path, name.strip()


command = click_command("new", NewCommand)
