"""Click group of all commands; a command is imported when it is called, so that help and ``check`` start quickly."""

from __future__ import annotations

import contextlib
import importlib
import keyword
import sys
from collections.abc import Sequence
from typing import Any, TextIO, cast

import click

from torsionnet.app.cli.failures import ClosedPipeStream, exit_code_for_errors
from torsionnet.base.version import __version__

COMMANDS = {  # in the order of use; the texts stand here so that the list of commands imports none of them
    "library": "The models, parts and catalogues that come with the package.",
    "new": "A commented model file to start from: ship, genset, rig, train, turbine.",
    "check": "Is a model sound? Every fault with its place in the file.",
    "show": "Elements, parameters, equations of motion, matrices, schematic.",
    "equations": "Equations of motion and transfer functions in symbols.",
    "modes": "Natural frequencies, damping ratios, mode shapes, energy shares.",
    "margins": "How far a controlled drivetrain is from becoming unstable.",
    "explore": "A page to play with a model: sliders, responses, modes.",
    "sensitivity": "Which parameter moves which mode, and by how much.",
    "frf": "Frequency responses between sensors, inputs and nodes.",
    "orders": "What engines, propellers and the like do over speed, order by order.",
    "critical-speeds": "Where orders meet natural frequencies, with margins and excitation.",
    "holzer": "Holzer table of a mode or of a trial frequency.",
    "static": "Mean torque, twist, stress and power of every element under the load.",
    "simulate": "A scenario over time: torques, short circuits, contacts, friction.",
    "limits": "Do shafts, couplings and gears bear it? Which speeds are barred?",
    "damper": "The film or tuning of a damper with which the largest vibration is smallest.",
    "study": "Tolerances, conditions and choices: what varies, what is asked, what follows.",
    "bench": "Run a test on a model instead of a rig, and write the record.",
    "angle": "Angle and speed from pulses of toothed wheels, with their uncertainty.",
    "clocks": "Drift and offset between the clocks of two systems that recorded one test.",
    "estimate": "Frequency responses and coherence from a record of signals.",
    "track": "Complex orders of a turning machine from teeth, torque and gauges.",
    "campaign": "A whole rotating test from one file: orders beside the model, repeats, fit, report.",
    "compare": "A record against a model.",
    "calibrate-wheel": "Pitch errors of a toothed wheel, from its own pulses.",
    "spectrogram": "Level over time and frequency of a record.",
    "fit": "Find parameters of a model from records or responses.",
    "identify-modes": "Natural frequencies and damping ratios from a record, without a model.",
    "damping": "Natural frequencies and damping ratios from a run-up, a free decay or ambient vibration.",
    "report": "The document on a model: HTML, PDF, LaTeX or Markdown.",
    "export": "The model for Matlab, Modelica, openTorsion, as an FMU or a sheet.",
    "import": "A model file out of a maker's sheet or another program.",
    "language-server": "Faults, completion and renaming in the editor that model files are written in.",
    "schema": "JSON Schema of model files, for editors.",
}


class LazyGroup(click.Group):
    """Click group that imports the module of a command when the command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in COMMANDS:
            return None
        module = f"{cmd_name}_" if keyword.iskeyword(cmd_name) else cmd_name.replace("-", "_")
        command = importlib.import_module(f"torsionnet.app.cli.commands.{module}").command
        return command if isinstance(command, click.Command) else None

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args and not args[0].startswith("-") and args[0] not in COMMANDS:
            from torsionnet.base.errors import did_you_mean

            hint = did_you_mean(args[0], COMMANDS) or f"; there are {', '.join(COMMANDS)}"
            raise click.UsageError(f'no command is named "{args[0]}"{hint}', ctx)
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def invoke(self, ctx: click.Context) -> Any:
        with exit_code_for_errors():
            return super().invoke(ctx)


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    epilog="MODEL is a model file (.yaml, .yml, .json), the name of a library model, or - for standard input. "
    "Results go to stdout, messages to stderr. "
    "Exit codes: 1 wrong model, 2 wrong usage, 3 no numerical answer, 4 missing package, 5 a limit does not hold, "
    "6 a limit is not judged in all configurations.",
)
@click.version_option(__version__, prog_name="torsionnet")
def app() -> None:
    """Torsional models of drivetrains: check, equations, modes, frequency responses."""


def run(arguments: Sequence[str] | None) -> int:
    """Run the command line and return its exit code."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a console without some character still shows the rest
    with contextlib.redirect_stdout(cast("TextIO", ClosedPipeStream(sys.stdout))):
        try:
            app.main(None if arguments is None else list(arguments), prog_name="torsionnet")
        except SystemExit as finished:
            return finished.code if isinstance(finished.code, int) else 0
    return 0
