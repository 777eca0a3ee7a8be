"""Click group of all commands; a command is imported when it is called, so that help and ``check`` start quickly."""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import Any, TextIO, cast

import click

from torsionnet.base.version import __version__

# Exceptions and warnings as messages on stderr and exit codes; a traceback only with TORSIONNET_DEBUG set.

BUG, INPUT_OUTPUT, INTERRUPTED = 70, 74, 130  # exit codes: EX_SOFTWARE and EX_IOERR of sysexits.h, 128 + SIGINT
DEBUG = "TORSIONNET_DEBUG"


@contextlib.contextmanager
def exit_code_for_errors() -> Iterator[None]:
    """Context in which an exception becomes a message on stderr and the exit code of the command."""
    from torsionnet.base.errors import TorsionnetWarning

    with warnings.catch_warnings():
        warnings.simplefilter("always", TorsionnetWarning)
        warnings.showwarning = _Warnings()
        try:
            yield
            sys.stdout.flush()
        except (click.exceptions.Exit, click.ClickException):
            raise
        except (KeyboardInterrupt, click.Abort):
            raise click.exceptions.Exit(INTERRUPTED) from None
        except Exception as error:  # noqa: BLE001
            if os.environ.get(DEBUG):
                import traceback

                traceback.print_exc()
            raise click.exceptions.Exit(_explain(error)) from None


def _explain(error: Exception) -> int:
    """Print what went wrong on stderr and return the exit code of the command."""
    from torsionnet.app.cli.terminal import message
    from torsionnet.base.errors import TorsionnetError, in_brackets

    if isinstance(error, TorsionnetError):
        text = str(error)
        if hasattr(error, "faults"):
            click.echo(text, err=True)
        else:
            message("error", f"{text}{in_brackets(error.kind)}")
        return error.exit_code
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        message("error", f"{where}{error.strerror or error}")
        return INPUT_OUTPUT
    first = (str(error).splitlines() or [""])[0]
    message("error", f"unexpected {type(error).__name__}: {first} (a bug; set {DEBUG}=1 to see where)")
    return BUG


class _Warnings:
    """Handler that shows each warning once, without the place in the program that raised it."""

    def __init__(self) -> None:
        self.seen: set[str] = set()

    def __call__(  # names and defaults are those of warnings.showwarning
        self,
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        from torsionnet.app.cli.terminal import message as tell
        from torsionnet.base.errors import TorsionnetWarning

        del filename, lineno, file, line
        shown = str(message) if issubclass(category, TorsionnetWarning) else f"{category.__name__}: {message}"
        if shown not in self.seen:
            self.seen.add(shown)
            tell("warning", shown)


class ClosedPipeStream:
    """Text stream that drops what is printed after its reader has closed the pipe, instead of raising.

    ``torsionnet frf ... --csv all.csv | head -2`` still writes its file. Without any output (``>&-``) everything is
    dropped.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = io.StringIO() if stream is None else stream

    def write(self, text: str) -> int:
        """Write a text, unless the reader has closed the pipe."""
        with self._until_closed():
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream, unless the reader has closed the pipe."""
        with self._until_closed():
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        if name == "buffer":  # to which click would write past this stream, as ASCII has too few characters for it
            raise AttributeError(name)
        return getattr(self._stream, name)

    @contextlib.contextmanager
    def _until_closed(self) -> Iterator[None]:
        try:
            yield
        except BrokenPipeError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)


GROUPS = {  # by what a user does; the texts stand here so that the list of commands imports none of them
    "Model": {
        "library": "The models, parts and catalogues that come with the package.",
        "new": "A commented model file to start from: ship, genset, rig, train, turbine.",
        "check": "Is a model sound? Every fault with its place in the file.",
        "show": "Elements, parameters, equations of motion, matrices, schematic.",
        "equations": "Equations of motion and transfer functions in symbols.",
        "import": "A model file out of a maker's sheet or another program.",
        "export": "The model for Matlab, Modelica, openTorsion, as an FMU or a sheet.",
    },
    "Calculate": {
        "modes": "Natural frequencies, damping ratios, mode shapes, energy shares.",
        "sensitivity": "Which parameter moves which mode, and by how much.",
        "frf": "Frequency responses between sensors, inputs and nodes.",
        "margins": "How far a controlled drivetrain is from becoming unstable.",
        "simulate": "A scenario over time: torques, short circuits, contacts, friction.",
        "periodic": "Every steady motion of laws that are not linear, and where a sweep jumps.",
        "static": "Mean torque, twist, stress and power of every element under the load.",
        "study": "Tolerances, conditions and choices: what varies, what is asked, what follows.",
    },
    "Running machinery": {
        "orders": "What engines, propellers and the like do over speed, order by order.",
        "critical-speeds": "Where orders meet natural frequencies, with margins and excitation.",
        "holzer": "Holzer table of a mode or of a trial frequency.",
        "limits": "Do shafts, couplings and gears bear it? Which speeds are barred?",
        "damper": "The film or tuning of a damper with which the largest vibration is smallest.",
    },
    "Tests and records": {
        "bench": "Run a test on a model instead of a rig, and write the record.",
        "estimate": "Frequency responses and coherence from a record of signals.",
        "compare": "A record against a model.",
        "fit": "Find parameters of a model from records or responses.",
        "identify-modes": "Natural frequencies and damping ratios from a record, without a model.",
        "damping": "Natural frequencies and damping ratios from a run-up, a free decay or ambient vibration.",
        "spectrogram": "Level over time and frequency of a record.",
        "loops": "Stages, friction, free play and loss from loops of torque over twist.",
        "angle": "Angle and speed from pulses of toothed wheels, with their uncertainty.",
        "calibrate-wheel": "Pitch errors of a toothed wheel, from its own pulses.",
        "clocks": "Drift and offset between the clocks of two systems that recorded one test.",
        "track": "Complex orders of a turning machine from teeth, torque and gauges.",
        "campaign": "A whole rotating test from one file: orders beside the model, repeats, fit, report.",
    },
    "Documents": {
        "report": "The document on a model: HTML, PDF, Word, LaTeX or Markdown.",
    },
    "Tools": {
        "explore": "A page to play with a model: sliders, responses, modes.",
        "explain": "What the word in brackets behind a message means, and what mends it.",
        "language-server": "Faults, completion and renaming in the editor that model files are written in.",
        "schema": "JSON Schema of model files, for editors.",
    },
}
"""Commands by group, each with a sentence on what it does."""
COMMANDS = {name: text for group in GROUPS.values() for name, text in group.items()}


FILES = {
    **dict.fromkeys(("library", "new", "check", "show"), "model_files"),
    **dict.fromkeys(("modes", "margins", "sensitivity", "frf"), "responses_and_modes"),
    **dict.fromkeys(("orders", "critical-speeds", "holzer"), "orders"),
    **dict.fromkeys(("static", "simulate", "periodic"), "under_load"),
    **dict.fromkeys(("limits", "damper"), "limits_and_damper"),
    **dict.fromkeys(("export", "import"), "exchange"),
    **dict.fromkeys(("explore", "explain", "language-server"), "tools"),
    **dict.fromkeys(("estimate", "compare", "identify-modes"), "estimate"),
    **dict.fromkeys(("angle", "calibrate-wheel", "clocks"), "wheels"),
    **dict.fromkeys(("damping", "loops", "spectrogram"), "findings"),
    **dict.fromkeys(("fit", "study"), "fit_and_study"),
    **dict.fromkeys(("bench", "campaign"), "bench_and_campaign"),
}
"""File in ``commands`` of each command that shares one with others; the rest stand in ``<command>_command``."""


class LazyGroup(click.Group):
    """Click group that imports the file of a command when the command is called, and makes it of its class there."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in COMMANDS:
            return None
        from torsionnet.app.cli.command import click_command

        file = FILES.get(cmd_name, f"{cmd_name}_command")
        module = importlib.import_module(f"torsionnet.app.cli.commands.{file}")
        return click_command(cmd_name, getattr(module, f"{cmd_name.title().replace('-', '')}Command"))

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args and not args[0].startswith("-") and args[0] not in COMMANDS:
            from torsionnet.app.cli.options import WrongUsage
            from torsionnet.base.errors import did_you_mean
            from torsionnet.base.familiar_words import ANYWHERE

            same, code = same_command(args[0]), ANYWHERE.get(args[0].lower().replace("-", "_"))
            hint = f"; say {same}" if same else f"; in Python, write {code}" if code else ""
            hint = hint or did_you_mean(args[0], COMMANDS) or f"; there are {', '.join(COMMANDS)}"
            raise WrongUsage(f'no command is named "{args[0]}"{hint}', kind="unknown-word")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        widest = max(map(len, COMMANDS))
        for group, commands in GROUPS.items():
            with formatter.section(group):
                formatter.write_dl([(f"{name:{widest}}", what) for name, what in commands.items()])

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        with _kinds_of_usage():
            return super().make_context(*arguments, **more)

    def invoke(self, ctx: click.Context) -> Any:
        with exit_code_for_errors(), _kinds_of_usage():
            return super().invoke(ctx)


@contextlib.contextmanager
def _kinds_of_usage() -> Iterator[None]:
    """Context in which errors of options and arguments say their kind of fault in brackets, as other messages do."""
    try:
        yield
    except click.UsageError as error:
        from torsionnet.app.cli.options import kind_of_usage
        from torsionnet.base.errors import in_brackets

        told = click.UsageError(f"{error.format_message()}{in_brackets(kind_of_usage(error))}", error.ctx)
        raise told from None


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


# Words from other programs and textbooks that name no command here, and what does the same; read on a miss alone.

SAME = {
    "frf --plot bode.png": "bode bodeplot bodemag freqresp freq response responses receptance mobility tf transfer",
    "margins --plot nyquist.png": "nyquist margin stability allmargin",
    "modes": "eig eigen eigs eigh eigenvalues eigenfrequencies poles pole damp frequencies modal pzmap "
    "natural-frequencies",
    "modes --shapes --plot shapes.png": "shape shapes mode-shapes eigenvectors modeshapes",
    "equations": "symbolic latex formula formulas eom motion",
    "equations --tf OUTPUT/INPUT": "transfer-function transfer-functions",
    "show --plot schematic.svg": "draw picture schematic scheme diagram graph view",
    "show --matrices": "matrix matrices mck",
    "frf --plot, orders --plot, modes --plot, show --plot": "plot plots figure",
    "simulate, with a scenario of the model": "step impulse initial lsim sim solve-ivp "
    "transient time scenario run integrate ode45",
    "critical-speeds --plot campbell.png": "campbell interference resonance resonances criticals lateral",
    "orders --plot orders.png --picture waterfall": "waterfall cascade",
    "orders": "forced harmonic harmonics excitation tvc tva torsional",
    "static": "mean balance power torque equilibrium",
    "limits": "fatigue stress barred allowable strength rules rainflow miner goodman",
    "damper": "tune absorber optimize-damper optimise-damper",
    "study": "monte-carlo montecarlo tolerance tolerances sweep sobol optimize optimise optimization variants doe "
    "fmincon",
    "sensitivity": "tornado gradient derivatives influence",
    "explore": "gui app ui browser slider sliders open edit",
    "check": "lint validate verify test-model",
    "new": "init create template start",
    "library": "examples list models parts catalogue",
    "bench": "test measure virtual record",
    "estimate": "h1 h2 coherence tfestimate welch csd cpsd mscohere",
    "spectrogram": "fft psd pwelch spectrum stft signal",
    "track": "order-tracking rpmtrack ordertrack ordertracking orderspectrum rpmfreqmap tsa vold-kalman",
    "angle": "teeth encoder pulses tacho tachometer tachorpm unwrap speed",
    "fit": "identify identification calibrate update correlate updating lsqcurvefit tfest ssest",
    "identify-modes": "ema modalfit modalfrf modalsd mac stabilisation stabilization lscf n4sid",
    "damping": "decay logdec decrement oma ambient run-up",
    "report": "document doc word docx pdf html approval",
    "export MODEL -o model.mat": "ss state-space statespace",
    "export": "convert matlab modelica fmu fmi simulink tors opentorsion write save",
    "import": "load read sheet",
    "language-server": "lsp editor",
    "--help": "help commands usage man",
    "--version": "version about",
}
"""Commands as they are typed behind ``torsionnet``, each with the words that people try for it."""


def same_command(word: str) -> str:
    """Command for what a word from elsewhere asks for, as it is typed; the empty string where nothing is known.

    >>> same_command("bode"), same_command("brake")
    ('torsionnet frf --plot bode.png', '')
    """
    return next((f"torsionnet {said}" for said, words in SAME.items() if word.lower() in words.split()), "")
