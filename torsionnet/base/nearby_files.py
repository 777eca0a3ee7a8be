"""Files named in a model file, which lie beside it or in folders below, also while their texts are not saved yet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import TypeAlias

from torsionnet.base.entries.declared import FOLDER
from torsionnet.base.entries.spec import EntryError
from torsionnet.base.errors import Fault, nearest, question

FileState: TypeAlias = tuple[int, int, int]
"""Type of numbers that change when a file is written or replaced: time in ns, size in bytes and number of the file."""

_RECORDED: ContextVar[dict[Path, FileState | None] | None] = ContextVar("files that were looked for", default=None)
_IN_EDITORS: ContextVar[Mapping[Path, str]] = ContextVar("texts that are not saved yet", default={})  # noqa: B039
MOST_FILE_BYTES = 8_000_000
"""Size in bytes of the largest named file that is read, as a larger one would only fill the memory."""


@contextmanager
def files_recorded() -> Iterator[Mapping[Path, FileState | None]]:
    """Context manager that gives the files looked for within it, with what :func:`file_state` said of each before.

    >>> with files_recorded() as files:
    ...     names = [file.name for file in files]
    >>> names
    []
    """
    recorded: dict[Path, FileState | None] = {}
    before = _RECORDED.set(recorded)
    try:
        yield recorded
    finally:
        _RECORDED.reset(before)


def file_state(path: Path) -> FileState | None:
    """State of a file, another one after each change of it; None if it is not there."""
    try:
        stat = path.stat()
    except (OSError, ValueError):
        return None
    return stat.st_mtime_ns, stat.st_size, stat.st_ino


@contextmanager
def texts_in_editors(texts: Mapping[Path, str]) -> Iterator[None]:
    """Context manager within which files that are open in an editor have the text shown there, by resolved path."""
    before = _IN_EDITORS.set(texts)
    try:
        yield
    finally:
        _IN_EDITORS.reset(before)


def nearby_bytes(path: Path) -> bytes:
    """Content of a file that :func:`nearby_file` found, as an editor shows it or as it is saved."""
    texts = _IN_EDITORS.get()
    shown = texts.get(path.resolve()) if texts else None
    return path.read_bytes() if shown is None else shown.encode("utf-8", "replace")


def nearby_file(name: str) -> Path:
    """Path of the file of that name beside the model file that is being read.

    Raises
    ------
    EntryError
        There is none, it lies elsewhere or is too large, or what is being read is no file.
    """
    folder = FOLDER.get()
    if folder is None:
        text = f'the file "{name}" is meant to lie beside the model file, but this model is text without a folder'
        raise EntryError(f"{text}; save it and load the file, or give the numbers in a list", kind="missing-file")
    pure = PurePosixPath(name.replace("\\", "/"))
    if pure.is_absolute() or PureWindowsPath(name).drive or ".." in pure.parts or "\0" in name:
        raise EntryError(
            f'"{name}" leads out of the folder of the model file; put the file beside it or below',
            kind="forbidden-file",
        )
    path = folder / pure
    recorded = _RECORDED.get()
    try:
        if recorded is not None:
            recorded.setdefault(path.resolve(), file_state(path))
        there, inside = path.is_file(), path.resolve().is_relative_to(folder.resolve())
        size = path.stat().st_size if there else 0
    except (OSError, RuntimeError):  # the latter of links that lead in a circle, up to Python 3.12
        there, inside, size = False, True, 0
    if not there:
        meant = _nearest_file(path) if inside else ""  # what lies elsewhere, behind a link, is not told
        text = f'there is no file "{name}" beside the model file{question(meant)}'
        raise EntryError(Fault(text, about=pure.name, meant=meant, kind="missing-file"))
    if not inside:
        raise EntryError(
            f'"{name}" is a link that leads out of the folder of the model file; put the file there',
            kind="forbidden-file",
        )
    if size > MOST_FILE_BYTES:
        raise EntryError(f'"{name}" is too large: more than {MOST_FILE_BYTES // 1_000_000} MB', kind="too-large")
    return path


def _nearest_file(path: Path) -> str:
    try:
        return nearest(path.name, [entry.name for entry in path.parent.iterdir() if entry.is_file()])
    except OSError:
        return ""
