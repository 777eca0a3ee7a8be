"""Errors, faults and warnings of the package, worded so that an engineer can act on them.

Every error the package raises on purpose derives from :class:`TorsionnetError` and carries the exit code of the
command line. A wrong model gives one :class:`ModelError` that holds *all* its faults, each with the path of the entry
(``("elements", "gearbox", "ratio")``) and, for a file, the position of that entry.

Here as well: text of lists of names in a sentence.
"""

from __future__ import annotations

import contextlib
import copyreg
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import lru_cache
from inspect import currentframe
from typing import TypeAlias

from torsionnet.base.phrases import ModelName, phrase

EntryPath: TypeAlias = tuple[str | int, ...]
"""Path to an entry of a model: keys and indices from the outside in."""

LEAST_SIMILARITY = 0.6
"""Smallest ``difflib`` ratio (0 to 1) at which a known name is suggested for a misspelled one; lower values suggest
names that have nothing in common."""


def named_list(names: Iterable[str], most: int | None = None, between: str = ", ") -> str:
    """Text of names of the model with commas or other words between them, shortened where there are many."""
    names = tuple(map(ModelName, names))
    places = ["{}"] * len(names)
    return phrase(between.join(places) if most is None else comma_list(places, most), *names[:most])


@dataclass(frozen=True)
class Position:
    """Position of a fault in a file, a stretch of one line.

    Line and columns count from 1, ``end_column`` is exclusive.
    """

    file: str
    line: int
    column: int
    end_column: int
    source: str = ""


NAMED = ("node", "element", "parameter", "configuration", "part", "port", "channel")
"""Things of a model that have a name; that of none of them has the kind of fault "unknown-node" and so on."""
_KINDS_OF_NAMES = {"sensor": "channel", "input": "channel", "axis": "configuration"}
"""Words for things in messages, by the thing of which their kind of fault is."""
UNKNOWN_NAMES = frozenset(("unknown-name", *(f"unknown-{named}" for named in NAMED)))
"""Kinds of faults of a name that nothing defines."""


@dataclass(frozen=True)
class Remedy:
    """Remedy of a fault as data, which its message tells in words and quick fixes turn into edits.

    ``how`` says what is done with the entry of the fault, by one of the constants below. ``new`` is what is written and
    ``old`` the text that it replaces, empty for the whole value with its quotes. ``keys`` are entries that are inserted
    or left out instead of the fault's own; ``place`` is line and column, from 0, of what is to be closed.
    """

    how: str
    new: str = ""
    old: str = ""
    keys: tuple[str, ...] = ()
    place: tuple[int, int] | None = None


WRITE, IN_UNIT, QUOTE, BRACKET = "write", "in unit", "quote", "bracket"
"""Remedies of a value: write another, give its number that unit, put it in quotes or in brackets."""
INSERT, LEAVE_OUT, SEPARATE, CLOSE = "insert", "leave out", "separate", "close"
"""Remedies of entries: insert one, leave one out, set a key apart from its value, close a bracket."""


@dataclass(frozen=True)
class Fault:
    """Fault in a model (``severity="error"``), or remark on it (``"warning"``, ``"note"``), with the path of its entry.

    ``path`` names the entry in the model's own structure; a reader of files adds ``position``.
    ``on_key`` marks the entry's name instead of its value. ``kind`` is a word of the table of faults, as
    ``unknown-node``, ``about`` the key, name or text in question, ``meant`` the one probably intended, and ``remedy``
    what else mends the fault; ``configuration`` is set where only that configuration has the
    fault. Of an entry of a part, ``uses`` are the paths, outermost first, where the part is used that has the fault; a
    reader of files adds ``used_at``. ``causes`` are the keys of an alternative that may bring the fault about.
    ``defined`` is the path of what is used wrongly, where that says what would be right; a reader adds ``defined_at``.
    """

    message: str
    path: EntryPath = ()
    severity: str = "error"
    position: Position | None = None
    on_key: bool = False
    kind: str = ""
    about: str = ""
    meant: str = ""
    configuration: str = ""
    uses: tuple[EntryPath, ...] = ()
    used_at: tuple[Position, ...] = ()
    defined: EntryPath = ()
    defined_at: Position | None = None
    remedy: Remedy | None = None
    causes: tuple[str, ...] = ()

    def under(self, *prefix: str | int) -> Fault:
        """Copy of the fault with its path below the path ``prefix``."""
        return replace(self, path=(*prefix, *self.path))

    def at(self, position: Position | None) -> Fault:
        """Copy of the fault with its position in a file."""
        return replace(self, position=position)

    @property
    def text(self) -> str:
        """Message of the fault, with the configuration in which it holds."""
        where = "in configuration {name}: {message}"
        return phrase(where, name=self.configuration, message=self.message) if self.configuration else self.message

    def __str__(self) -> str:
        said = f"{self.severity}: {printable_text(self.text)}{in_brackets(self.kind)}"
        if self.position is None:
            where = printable_text(".".join(str(part) for part in self.path))
            return f"{where}: {said}" if where else said
        others = [(position, "used here") for position in self.used_at]
        others += [(self.defined_at, "defined here")] if self.defined_at else []
        shown = "".join(f"\n{_located(position)}: {what}{_excerpt(position)}" for position, what in others)
        return f"{_located(self.position)}: {said}{_excerpt(self.position)}{shown}"


def in_brackets(kind: str) -> str:
    """Kind of a fault as it stands behind its message.

    >>> in_brackets("unknown-node"), in_brackets("")
    (' [unknown-node]', '')
    """
    return f" [{kind}]" if kind else ""


def _located(position: Position) -> str:
    return f"{printable_text(position.file)}:{position.line}:{position.column}"


def _excerpt(position: Position) -> str:
    if not position.source:
        return ""
    start, end = position.column - 1, min(position.end_column - 1, len(position.source))
    before, marked, after = (printable_text(part) for part in _cut(position.source, start, end))
    line = f"{before}{marked}{after}"
    return f"\n{position.line:5d} | {line}\n      | {' ' * len(before)}{'^' * max(1, len(marked))}"


def _cut(text: str, start: int, end: int) -> tuple[str, str, str]:
    return text[:start], text[start:end], text[max(start, end) :]


def printable_text(text: str) -> str:
    r"""Text of a file made safe to show: characters that steer a terminal or turn the reading direction are escaped.

    >>> print(printable_text("a\x1b[31mb\u202ec"))
    a\x1b[31mb\u202ec
    """
    return text if text.isprintable() else _STEERING.sub(_written_out, text)


def got(value: object) -> str:
    """Words for what an entry was given, as a file writes it where it is empty, true or false.

    >>> got(None), got(True), got("hub")
    ('got nothing', 'got true', "got 'hub'")
    """
    return f"got {'nothing' if value is None else str(value).lower() if isinstance(value, bool) else repr(value)}"


def readable_text(text: str) -> str:
    r"""Text with the name of a file in which bytes that are no text here are read as UTF-8, or else marked.

    >>> readable_text("L\udcc3\udca4ufer"), readable_text("L\udce4ufer")
    ('Läufer', 'L\ufffdufer')
    """
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


_STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff\ud800-\udfff]")


def _written_out(match: re.Match[str]) -> str:
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


class TorsionnetError(Exception):
    """Base of all errors raised on purpose; ``exit_code`` is what the command line returns.

    ``kind`` is the word for what is wrong, as ``unknown-node``, which ``torsionnet explain`` explains.
    """

    exit_code = 1
    kind: str = ""

    def __init__(self, message: str, *, kind: str = "") -> None:
        super().__init__(message)
        self.kind = kind or self.kind
        if self.kind:
            self.add_note(f"[{self.kind}]")  # a traceback prints it; in other messages the message alone is cited

    def __reduce__(self) -> tuple[object, ...]:
        # Made without its constructor, of which each class has its own.
        return copyreg.__newobj__, (type(self), *self.args), self.__dict__  # type: ignore[attr-defined]


class ModelError(TorsionnetError, ValueError):
    """Error that a model, or a question asked of it, is wrong, with all its faults.

    ``faults`` lists all faults, not only the first.
    """

    outcome = "Nothing was calculated."

    def __init__(self, faults: Iterable[Fault] | str, title: str = "the model", *, kind: str = "") -> None:
        self.faults: tuple[Fault, ...] = (Fault(faults, kind=kind),) if isinstance(faults, str) else tuple(faults)
        self.title = title
        super().__init__(self._text())
        self.kind: str = self.faults[0].kind if self.faults else ""

    def _text(self) -> str:
        count = sum(fault.severity != "note" for fault in self.faults)
        total = f"{count} error{'s' if count != 1 else ''} in {self.title}. {self.outcome}"
        return "\n".join([*(str(fault) for fault in self.faults), total])


def fault_of(what: str | Fault | Exception, kind: str = "") -> Fault:
    """Fault of a message, or of an error of Python, and its kind; or the fault itself, or that of an error."""
    fault = getattr(what, "fault", what)
    return fault if isinstance(fault, Fault) else Fault(str(what), kind=kind)


def message_of(error: Exception) -> str:
    """Message of an error, with the names in it where the error has a fault."""
    return error.fault.message if isinstance(error, FaultyValueError) else str(error)


class FaultyValueError(TorsionnetError, ValueError):
    """Error of a text or number that cannot be read, with the fault that it will be in a file."""

    def __init__(self, fault: str | Fault, *, kind: str = "") -> None:
        self.fault: Fault = fault_of(fault, kind)
        super().__init__(self.fault.message, kind=self.fault.kind)


class UsageError(FaultyValueError):
    """Error of a name or option that does not exist or does not fit (exit code 2 on the command line)."""

    exit_code = 2


def unreadable_file(file: object, error: OSError) -> UsageError:
    """Error of a file that is not there, or cannot be read.

    >>> unreadable_file("rig.yaml", FileNotFoundError(2, "No such file or directory")).kind
    'missing-file'
    """
    kind = "missing-file" if isinstance(error, FileNotFoundError) else "unreadable-file"
    return UsageError(f"{file} cannot be read: {error.strerror or error}", kind=kind)


class SolveError(TorsionnetError, ArithmeticError):
    """Error of a calculation that has no solution, or none that can be trusted."""

    exit_code = 3


class MissingExtraError(TorsionnetError, ImportError):
    """Error that an optional package is missing; the message names the pip command."""

    exit_code = 4
    kind: str = "missing-package"


class TorsionnetWarning(UserWarning):
    """Warning about a result that was calculated all the same."""


def warn_user(text: str, category: type[TorsionnetWarning] = TorsionnetWarning) -> None:
    """Warn at the line of the user, the innermost outside of the package, however deep the caller is."""
    level, frame = 1, currentframe()
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == "torsionnet":
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)


class FreeTurningWarning(TorsionnetWarning):
    """Warning that a response is infinite at 0 Hz, as the drivetrain turns freely."""


def nearest(name: str, candidates: Iterable[str]) -> str:
    """Candidate that ``name`` was probably meant to be, or the empty string.

    The likeness is that of :mod:`difflib`. It is at most that of the letters without their order, which are quickly
    compared: the most promising candidates come first, and most of many need no closer look.
    """
    from difflib import SequenceMatcher

    known = {candidate.casefold(): candidate for candidate in candidates}
    wanted = str(name).casefold()
    letters = _letters(wanted)
    promising = [
        (promise, other)
        for other in known
        if other
        and (promise := 2 * (letters & _letters(other)).bit_count() / (len(wanted) + len(other))) >= LEAST_SIMILARITY
    ]
    best = (LEAST_SIMILARITY, "")
    matcher = SequenceMatcher(b=wanted)
    for promise, other in sorted(promising, reverse=True):
        if promise < best[0]:
            break
        matcher.set_seq1(other)
        best = max(best, (matcher.ratio(), other))
    return known[best[1]] if best[1] else ""


@lru_cache(maxsize=2**15)
def _letters(text: str) -> int:
    """Bit mask of the letters in a text and of how often each occurs, for quick comparison of names.

    Letters that share a bit only make texts look more alike.
    """
    seen: dict[int, int] = {}
    bits = 0
    for letter in text:
        kind = ord(letter) % 64
        seen[kind] = seen.get(kind, -1) + 1
        bits |= 1 << (kind + 64 * seen[kind])
    return bits


def did_you_mean(name: str, candidates: Iterable[str]) -> str:
    """Question whether the nearest candidate was meant, or the empty string where none is near.

    >>> did_you_mean("gerbox", ["gearbox", "motor"])
    '; did you mean "gearbox"?'
    """
    return question(nearest(name, candidates))


def suggestion_or(name: str, candidates: Iterable[str], rest: str) -> str:
    """Question whether the nearest candidate was meant, if there is any, followed by ``rest``.

    >>> suggestion_or("gerbox", ["gearbox"], "known: gearbox"), suggestion_or("x", ["gearbox"], "known: gearbox")
    ('; did you mean "gearbox"? known: gearbox', '; known: gearbox')
    """
    return f"{did_you_mean(name, candidates)}; {rest}".replace("?; ", "? ")


def question(meant: str) -> str:
    """Question whether ``meant`` was meant, or the empty string where nothing is likely.

    >>> question("gearbox")
    '; did you mean "gearbox"?'
    """
    return phrase('; did you mean "{}"?', ModelName(meant)) if meant else phrase("")


def unknown_key(key: object, known: Iterable[str], path: EntryPath, rest: str) -> Fault:
    """Fault of a key that an entry of the model does not have; ``rest`` says which keys do."""
    name, known = str(key), list(known)
    from torsionnet.base.familiar_words import familiar_key

    meant, advice = familiar_key(name, known)
    meant = meant or ("" if advice else nearest(name, known))
    text = f'unknown key "{name}"{f"; {advice}" if advice else question(meant)}; {rest}'.replace("?; ", "? ")
    return Fault(text, path, on_key=True, kind="unknown-entry", about=name, meant=meant)


def unknown_name(
    what: str, name: str, known: Iterable[str], path: EntryPath = (), *, on_key: bool = False, rest: str = ""
) -> Fault:
    """Fault of a name in the model that nothing defines.

    ``no node is named "x"; did you mean "y"?``; ``rest`` says which there are.
    """
    text = phrase('no {} is named "{}"', what, ModelName(name))
    thing = what.split(" ", 1)[0].rstrip(",")
    kind = f"unknown-{_KINDS_OF_NAMES.get(thing, thing)}"
    kind = kind if kind in UNKNOWN_NAMES else "unknown-name"
    return unfit_word(text, name, known, path, rest, on_key=on_key, kind=kind)


def unfit_word(
    text: str,
    word: str,
    known: Iterable[str],
    path: EntryPath = (),
    rest: str = "",
    *,
    meant: str = "",
    on_key: bool = False,
    kind: str = "unknown-word",
) -> Fault:
    """Fault of a word that is none of those that fit, with the question whether ``meant`` or the nearest was meant.

    ``rest`` follows the question, as which there are.
    """
    meant = meant or nearest(word, known)
    rest = rest and phrase(" {}" if meant else "; {}", rest)
    return Fault(phrase("{}{}{}", text, question(meant), rest), path, on_key=on_key, kind=kind, about=word, meant=meant)


def comma_list(names: Iterable[object], most: int | None = None, more: str = " and {} more", none: str = "") -> str:
    """Text of names with commas between them, shortened to the first of them where there are many.

    Parameters
    ----------
    names : iterable
        What is named.
    most : int, optional
        How many are named; by default all.
    more : str, optional
        What follows them where there are more, and how many more where it has braces.
    none : str, optional
        What is said where there is nothing to name.

    Examples
    --------
    >>> comma_list("abcd"), comma_list("abcd", 2), comma_list("abcd", 2, ", ..."), comma_list("", none="none")
    ('a, b, c, d', 'a, b and 2 more', 'a, b, ...', 'none')
    """
    words = [str(name) for name in names]
    rest = 0 if most is None else len(words) - most
    return (", ".join(words[:most]) or none) + (more.format(rest) if rest > 0 else "")


# Names of arguments and functions in messages, as callers in Python write them, or as the command line does.

VALUE = "*"
"""Mark in a name at which the value stands, instead of behind it."""
_NAMES: ContextVar[Mapping[str, str]] = ContextVar("names of arguments in messages", default={})  # noqa: B039


def remedy(argument: str, value: str | Mapping[str, str] = "") -> str:
    """Argument or function that mends something, with its value, as the caller names it.

    >>> remedy("sampling_rate=", "1000"), remedy("quantities=", {"M1": "torque"})
    ('sampling_rate=1000', 'quantities={"M1": "torque"}')
    >>> with remedies({"sampling_rate=": "--sampling-rate", "quantities=": "--quantity"}):
    ...     remedy("sampling_rate="), remedy("sampling_rate=", "1000"), remedy("quantities=", {"M1": "torque"})
    ('--sampling-rate', '--sampling-rate 1000', '--quantity M1=torque')

    Of a file of entries ``*`` stands for the value.

    >>> with remedies({"sampling_rate=": "reading: {rate: *}", "units=": "reading: {units: *}"}):
    ...     remedy("sampling_rate="), remedy("units=", {"M1": "kNm"})
    ('reading: {rate: ...}', 'reading: {units: {M1: kNm}}')
    """
    name = _NAMES.get().get(argument)
    if name is None:
        import json  # for the few remedies with a table

        return f"{argument}{value if isinstance(value, str) else json.dumps(dict(value), ensure_ascii=False)}"
    if VALUE in name:
        entries = (
            value if isinstance(value, str) else f"{{{', '.join(f'{key}: {word}' for key, word in value.items())}}}"
        )
        return name.replace(VALUE, entries or "...")
    values = [value] if isinstance(value, str) else [f"{key}={word}" for key, word in value.items()]
    return " ".join(f"{name} {word}".strip() for word in values)


@contextlib.contextmanager
def remedies(names: Mapping[str, str]) -> Iterator[None]:
    """Context in which messages name arguments and functions by other names, such as options."""
    before = _NAMES.set(names)
    try:
        yield
    finally:
        _NAMES.reset(before)
