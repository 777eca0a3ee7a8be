"""What can go wrong, said so that an engineer can act on it.

Every error the package raises on purpose derives from :class:`TorsionnetError` and carries the exit code of the
command line. A wrong model gives one :class:`ModelError` that holds *all* its faults, each with the path of the entry
(``("elements", "gearbox", "ratio")``) and, for a file, the position of that entry.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeAlias

Path: TypeAlias = tuple[str | int, ...]


@dataclass(frozen=True)
class Position:
    """A stretch of one line in a file; line and columns count from 1, ``end_column`` is exclusive."""

    file: str
    line: int
    column: int
    end_column: int
    source: str = ""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong (``severity="error"``) or worth knowing (``"warning"``, ``"note"``) in a model.

    ``path`` names the entry in the model's own structure; a reader of files adds ``position``.
    ``on_key`` marks the entry's name instead of its value.
    """

    message: str
    path: Path = ()
    severity: str = "error"
    position: Position | None = None
    on_key: bool = False

    def at(self, position: Position | None) -> Fault:
        return replace(self, position=position)

    def __str__(self) -> str:
        if self.position is None:
            where = ".".join(str(part) for part in self.path)
            return f"{where}: {self.severity}: {self.message}" if where else f"{self.severity}: {self.message}"
        return f"{_located(self.position)}: {self.severity}: {self.message}{_excerpt(self.position)}"


def _located(position: Position) -> str:
    return f"{position.file}:{position.line}:{position.column}"


def _excerpt(position: Position) -> str:
    if not position.source:
        return ""
    width = max(1, min(position.end_column, len(position.source) + 1) - position.column)
    return f"\n{position.line:5d} | {position.source}\n      | {' ' * (position.column - 1)}{'^' * width}"


class TorsionnetError(Exception):
    """Base of all errors raised on purpose; ``exit_code`` is what the command line returns."""

    exit_code = 1


class ModelError(TorsionnetError, ValueError):
    """The model (or the question asked of it) is wrong; ``faults`` lists everything found, not only the first."""

    def __init__(self, faults: Iterable[Fault] | str, title: str = "the model") -> None:
        self.faults: tuple[Fault, ...] = (Fault(faults),) if isinstance(faults, str) else tuple(faults)
        self.title = title
        super().__init__(self._text())

    def _text(self) -> str:
        count = len(self.faults)
        total = f"{count} error{'s' if count != 1 else ''} in {self.title}. Nothing was calculated."
        return "\n".join([*(str(fault) for fault in self.faults), total])


class UsageError(TorsionnetError, ValueError):
    """A name or option in the question does not exist or does not fit (exit code 2 on the command line)."""

    exit_code = 2


class SolveError(TorsionnetError, ArithmeticError):
    """The numbers have no answer, or none that can be trusted."""

    exit_code = 3


class MissingExtraError(TorsionnetError, ImportError):
    """An optional package is needed; the message names the pip command."""

    exit_code = 4


class TorsionnetWarning(UserWarning):
    """Something worth knowing about a result that was calculated all the same."""


def did_you_mean(name: str, candidates: Iterable[str]) -> str:
    """Text ``; did you mean "x"?`` for the nearest candidate, or the empty string.

    >>> did_you_mean("gerbox", ["gearbox", "motor"])
    '; did you mean "gearbox"?'
    """
    import difflib

    known = {candidate.casefold(): candidate for candidate in candidates}
    close = difflib.get_close_matches(name.casefold(), known, n=1, cutoff=0.6)
    return f'; did you mean "{known[close[0]]}"?' if close else ""
