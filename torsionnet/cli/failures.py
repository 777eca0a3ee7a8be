"""Exceptions and warnings as messages on stderr and exit codes; never a traceback unless one asks for it."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any, TextIO

import click

BUG, INPUT_OUTPUT, INTERRUPTED = 70, 74, 130
DEBUG = "TORSIONNET_DEBUG"


@contextlib.contextmanager
def guarded() -> Iterator[None]:
    """Run a command: whatever it raises becomes a message and an exit code."""
    from torsionnet.core.errors import TorsionnetWarning

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
    """Print what went wrong and return the exit code."""
    from torsionnet.cli.terminal import message
    from torsionnet.core.errors import TorsionnetError

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
    """Shows each warning once, without the place in the program that raised it."""

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
        from torsionnet.cli.terminal import message as tell
        from torsionnet.core.errors import TorsionnetWarning

        del filename, lineno, file, line
        shown = str(message) if issubclass(category, TorsionnetWarning) else f"{category.__name__}: {message}"
        if shown not in self.seen:
            self.seen.add(shown)
            tell("warning", shown)


class Printed:
    """A stream of text that ends where its reader stops reading: what is printed after that goes nowhere.

    ``torsionnet frf ... --csv all.csv | head -2`` writes its file like any other. A program started without any
    output (``>&-``) has a reader that never began.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = io.StringIO() if stream is None else stream

    def write(self, text: str) -> int:
        """Write, if anybody reads."""
        with self._until_closed():
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Pass on what was written, if anybody reads."""
        with self._until_closed():
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    @contextlib.contextmanager
    def _until_closed(self) -> Iterator[None]:
        try:
            yield
        except BrokenPipeError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)
