"""Folder of a study with its record and the chunks of variants that are done."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import platform
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from torsionnet.base.atomic import write_text
from torsionnet.base.errors import SolveError, UsageError, warn_user
from torsionnet.base.version import __version__
from torsionnet.study.run.chunk_values import CHUNKS, Chunks, ChunkValues, counted_limits, read_chunk
from torsionnet.study.study import Study

# Record of what the results in a folder depend on (model, study, versions, method), and its differences.

FILE_FORMAT = 2
"""Version of the format of the files in a study's folder, raised when older files cannot be read any more."""
LIBRARIES = ("numpy", "scipy", "numba")
"""Packages whose version may change a number in the results of a study."""
INSTALLATION = ("version", "libraries", "machine")
"""Entries that say what calculated the results, by which complete results may differ from what reads them."""
AFTERWARDS = ("name", "limits", "answers")
"""Entries of a study on which no value of a variant depends, so that they may change between runs in one folder.

Limits only where the values of all variants are kept; else variants beyond them are counted as they are calculated.
"""
WORDS = {
    "format": "the form of the files",
    "version": "the version of torsionnet",
    "libraries": "the set of libraries",
    "machine": "the kind of machine",
    "method": "the method of the solver",
    "model": "the model",
    "study": "the study",
    "chunks": "the size of chunks",
    "keep": "what is kept",
    "limits": "the limits",
}


def study_record(study: Study, chunks: Chunks, every: int) -> dict[str, Any]:
    """Record of all that the results of a study depend on, as JSON data; every ``every``-th variant keeps values."""
    text = study.model_text
    limits = {name: limit.to_data() for name, limit in counted_limits(study, every).items()}
    return {
        "format": FILE_FORMAT,
        "version": __version__,
        "libraries": {name: _version(name) for name in LIBRARIES},
        "machine": f"{platform.system()} {platform.machine()}",
        "method": study.method,
        "seed": study.seed,
        "model": {"title": study.model.title, "sha256": hashlib.sha256(text.encode()).hexdigest(), "text": text},
        "study": {key: entry for key, entry in study.to_data().items() if key not in AFTERWARDS},
        "chunks": {"cases": chunks.cases, "count": chunks.count, "size": chunks.size},
        "keep": every,
        "limits": limits,
    }


def record_text(record: dict[str, Any]) -> str:
    """JSON text of a study's record, equal for equal records."""
    return json.dumps(record, indent=1, ensure_ascii=False) + "\n"


def record_differences(kept: dict[str, Any], wanted: dict[str, Any]) -> list[str]:
    """Differences in words between the record in a study's folder and the one wanted now."""
    return [_said(key, kept.get(key), wanted.get(key)) for key in WORDS if kept.get(key) != wanted.get(key)]


def differ_by_installation(kept: dict[str, Any], wanted: dict[str, Any]) -> bool:
    """Whether two records of one major version differ in nothing but what calculated them."""
    same_major = str(kept.get("version")).partition(".")[0] == str(wanted["version"]).partition(".")[0]
    return same_major and all(kept.get(key) == wanted.get(key) for key in WORDS if key not in INSTALLATION)


def _said(key: str, kept: Any, wanted: Any) -> str:
    if key in ("version", "machine", "method", "format"):
        return f"{WORDS[key]} was {kept}, now it is {wanted}"
    if key == "limits" and isinstance(kept, dict) and isinstance(wanted, dict):
        names = [name for name in {**kept, **wanted} if kept.get(name) != wanted.get(name)]
        why = "of so many variants those beyond the limits are counted as they are calculated"
        return f"limits were others ({', '.join(names)}), and {why}"
    if isinstance(kept, dict) and isinstance(wanted, dict):
        names = [name for name in {**kept, **wanted} if kept.get(name) != wanted.get(name) and name != "text"]
        plain = [name for name in names if not isinstance(kept.get(name), dict | list)]
        shown = [f"{name} {kept.get(name)} -> {wanted.get(name)}" for name in plain if name != "sha256"]
        parts = shown if len(shown) == len(names) else [name for name in names if name != "sha256"]
        return f"{WORDS[key]} is another: {', '.join(parts)}" if parts else f"{WORDS[key]} is another"
    return f"{WORDS[key]} is another"


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""


ANSWERS = "answers"
"""Name of the folder of logs of stored evaluations in that of the study."""
RECORD = "study.json"
"""Name of the file with the record of the study in its folder."""
TEMPORARY_SECONDS = 3600.0
"""Age in seconds from which a temporary file is removed, as younger ones may still be written by another process."""


@dataclass(frozen=True)
class StudyFolder:
    """Folder of a study with ``study.json``, ``chunks/``, and ``answers/`` with the evaluations of answers.

    The folder can be copied and moved as a whole.
    """

    path: Path

    def open(self, record: dict[str, Any]) -> None:
        """Make the folder of the study, or refuse one that belongs to another study.

        Raises
        ------
        UsageError
            The folder holds results of something else, or cannot be written.
        """
        try:
            (self.path / CHUNKS).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(
                f"{self.path} cannot be a folder of results: {error.strerror}", kind="unusable-place"
            ) from None
        file = self.path / RECORD
        if not file.exists():
            if any(any((self.path / part).glob("*.*")) for part in (CHUNKS, ANSWERS)):
                text = f"{self.path} holds results but no {RECORD}, which says what study they are of"
                raise UsageError(
                    f"{text}; choose another folder, or put a copy of {RECORD} back", kind="unusable-place"
                )
            write_text(file, record_text(record))
            return
        kept, wanted = self.record(), json.loads(record_text(record))
        differing = record_differences(kept, wanted)
        if differing and self._is_complete(wanted) and differ_by_installation(kept, wanted):
            text = f"{self.path} is complete, and is read as it was calculated elsewhere: {'; '.join(differing)}"
            warn_user(text)
            return
        if differing:
            raise UsageError(
                f"{self.path} holds results of something else; " + "; ".join(differing) + ". "
                "Nothing in it was changed: choose another folder, or go back to what it was calculated with",
                kind="unusable-place",
            )

    def _is_complete(self, record: dict[str, Any]) -> bool:
        """Whether there is nothing left to calculate, so that results of two versions cannot be mixed."""
        total = Chunks(**record["chunks"]).total
        return total > 0 and all(self.chunk(number) is not None for number in range(total))

    def record(self) -> dict[str, Any]:
        """Record of the study that the chunks in the folder belong to."""
        try:
            record = json.loads((self.path / RECORD).read_text(encoding="utf-8"))
            if not isinstance(record, dict):
                raise ValueError("it is not the record of a study")
        except (OSError, ValueError) as error:
            raise UsageError(
                f"{self.path / RECORD} cannot be read: {error}. Nothing else says which study the results beside "
                "it are of; choose another folder, or put a copy of it back",
                kind="unreadable-file",
            ) from None
        return record

    def chunk(self, number: int) -> ChunkValues | None:
        """Results of a chunk of variants, None where its file is missing or damaged."""
        return read_chunk(self.path, number)

    def remove_temporary_files(self) -> None:
        """Remove temporary files older than :data:`TEMPORARY_SECONDS`, which writers that were killed have left."""
        for entry in (self.path / CHUNKS).glob(".*"):
            with suppress(OSError):
                if time.time() - entry.stat().st_mtime > TEMPORARY_SECONDS:
                    entry.unlink()

    def chunk_numbers(self, total: int) -> list[int]:
        """Numbers of the chunks that have a file in the folder, complete or not."""
        names = [entry.name for entry in os.scandir(self.path / CHUNKS)]
        numbers = (int(name[:-4]) for name in names if name.endswith(".npz") and name[:-4].isdigit())
        return sorted(number for number in numbers if number < total)


@contextmanager
def telling_write_errors(folder: Path) -> Iterator[None]:
    """Turn an error of writing in the study's folder into one that says that its chunks remain."""
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        why = "the disk is full" if full else f"it cannot be written: {error.strerror or error}"
        raise SolveError(
            f"{folder}: {why}; the chunks in it are whole, and the study goes on from there when it is run again",
            kind="unusable-place",
        ) from error


# Lock of a study folder against a second run: a file with the number of the process, void once that has ended.

LOCK = "running.json"
"""Name of the lock file in the folder of a study."""
ERROR_ACCESS_DENIED = 5
"""Error number of the Windows API for a process that exists but belongs to another user."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Lock the folder of a study against other runs within ``with``.

    Raises
    ------
    UsageError
        Another run uses the folder.
    """
    file, own = folder / LOCK, {"host": platform.node(), "process": os.getpid(), "began": _began(os.getpid())}
    _take(file, {**own, "word": uuid.uuid4().hex})
    try:
        yield
    finally:
        with suppress(OSError):
            file.unlink()


def _take(file: Path, own: dict[str, Any]) -> None:
    """Write the lock file under another name and link it into place, which fails where there is one."""
    beside = file.with_name(f".{own['word']}")
    beside.write_text(json.dumps(own))
    try:
        for _ in range(10):
            try:
                _put(beside, file)
            except FileExistsError:
                _remove_if_dead(file)
            else:
                return
        raise UsageError(f"another run uses {file.parent}; wait for it, or end it", kind="unusable-place")
    finally:
        beside.unlink()


def _put(beside: Path, file: Path) -> None:
    """Link the lock file to its final name, or, on file systems without links, write it there if there is none."""
    try:
        os.link(beside, file)
    except FileExistsError:
        raise
    except OSError:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(beside.read_text(encoding="utf-8"))


def _remove_if_dead(file: Path) -> None:
    try:
        other = json.loads(file.read_text(encoding="utf-8"))
        host, process, began = other["host"], int(other["process"]), other["began"]
    except FileNotFoundError:
        return
    except (ValueError, KeyError, TypeError):
        host, process, began = platform.node(), 0, None
    if host != platform.node():
        raise UsageError(
            f"a run on {host} (process {process}) uses {file.parent}; if it is not running any more, remove {file}",
            kind="unusable-place",
        )
    if process and _is_alive(process, began):
        # Without its start time the number may be that of another program.
        remedy = (
            "wait for it, or end it" if began else f"wait for it, end it, or, if it is another program, remove {file}"
        )
        raise UsageError(f"process {process} is running this study in {file.parent}; {remedy}", kind="unusable-place")
    aside = file.with_name(f".{uuid.uuid4().hex}")
    with suppress(FileNotFoundError):  # by name first, so that of two who find it dead only one removes it
        file.rename(aside)
        aside.unlink()


def _is_alive(process: int, began: str | None) -> bool:
    if os.name == "nt":  # where asking by a signal would end it
        import ctypes

        # By names, as other systems have none of these.
        kernel = getattr(ctypes, "WinDLL")("kernel32", use_last_error=True)  # noqa: B009
        handle = kernel.OpenProcess(0x1000, False, process)
        if not handle:
            return bool(getattr(ctypes, "get_last_error")() == ERROR_ACCESS_DENIED)  # noqa: B009
        kernel.CloseHandle(handle)
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return began is None or _began(process) in (None, began)


def _began(process: int) -> str | None:
    """Start time of a process, by which it differs from a later one of the same number, None where unknown."""
    try:
        state, started = Path(f"/proc/{process}/stat").read_text("utf-8", "replace").rpartition(")")[2].split()[0:20:19]
    except (OSError, ValueError):
        return None
    return "dead" if state == "Z" else started
