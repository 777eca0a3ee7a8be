"""Exceptions and warnings as messages on stderr and exit codes; a traceback only with TORSIONNET_DEBUG set."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from collections.abc import Collection, Iterator
from typing import Any, TextIO

import click

BUG, INPUT_OUTPUT, INTERRUPTED = 70, 74, 130  # exit codes: EX_SOFTWARE and EX_IOERR of sysexits.h, 128 + SIGINT
DEBUG = "TORSIONNET_DEBUG"
OPTIONS = {
    "sampling_rate=": ("--rate", "reading: {rate: *}"), "resample=True": ("--resample", "reading: {resample: true}"),
    "resampled()": ("--resample", "reading: {resample: true}"), "units=": ("--unit", "reading: {units: *}"),
    "quantities=": ("--quantity", "reading: {quantities: *}"), "separator=": ("--separator", "reading: {separator: *}"),
    "decimal=": ("--decimal", "reading: {decimal: *}"), "angle_from_pulses()": ("--pulses", "torsionnet angle"),
    "align=True": ("--align", "torsionnet estimate --align"),
}  # fmt: skip
"""Options for arguments and functions of Python in messages, each with what a command that lacks it has instead:
entries of the file that it is given."""
WORDS = {
    "unwrapped()": "counting the angle on",
    "iter_blocks()": "torsionnet estimate",
    "bridge_gaps=True": "a record without them",
}
"""Words for arguments and functions of Python in messages that no option stands for."""


def remedy_words(options: Collection[str]) -> dict[str, str]:
    """Words of a command with these options for arguments and functions of Python in messages.

    >>> remedy_words(["--rate"])["sampling_rate="], remedy_words([])["sampling_rate="]
    ('--rate', 'reading: {rate: *}')
    """
    return WORDS | {name: option if option in options else entry for name, (option, entry) in OPTIONS.items()}


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
    from torsionnet.base.errors import TorsionnetError

    if isinstance(error, TorsionnetError):
        text = str(error)
        if hasattr(error, "faults"):
            click.echo(text, err=True)
        else:
            message("error", text)
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
