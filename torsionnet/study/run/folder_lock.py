"""One run at a time in a folder: a file that names the process, which counts for nothing once that has died."""

from __future__ import annotations

import json
import os
import platform
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from torsionnet.core.errors import UsageError

LOCK = "running.json"
NOT_ALLOWED = 5
"""Error of Windows: the process is there, and somebody else's."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder.

    Raises
    ------
    UsageError
        Another run is at it.
    """
    file, own = folder / LOCK, {"host": platform.node(), "process": os.getpid(), "began": _began(os.getpid())}
    _take(file, {**own, "word": uuid.uuid4().hex})
    try:
        yield
    finally:
        with suppress(OSError):
            file.unlink()


def _take(file: Path, own: dict[str, Any]) -> None:
    """Write the file whole under another name and link it into place, which fails where there is one."""
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
        raise UsageError(f"another run is at {file.parent}")
    finally:
        beside.unlink()


def _put(beside: Path, file: Path) -> None:
    """Give a file its second name, or, where file systems have no such names, write it anew if there is none."""
    try:
        os.link(beside, file)
    except FileExistsError:
        raise
    except OSError:
        with file.open("x") as stream:
            stream.write(beside.read_text())


def _remove_if_dead(file: Path) -> None:
    try:
        other = json.loads(file.read_text())
        host, process, began = other["host"], int(other["process"]), other["began"]
    except FileNotFoundError:
        return
    except (ValueError, KeyError, TypeError):
        host, process, began = platform.node(), 0, None
    if host != platform.node():
        raise UsageError(
            f"a run on {host} (process {process}) is at {file.parent}; if it is not running any more, remove {file}"
        )
    if process and _is_alive(process, began):
        raise UsageError(f"process {process} is running this study in {file.parent}; {_remedy(file, began)}")
    aside = file.with_name(f".{uuid.uuid4().hex}")
    with suppress(FileNotFoundError):  # by name first, so that of two who find it dead only one removes it
        file.rename(aside)
        aside.unlink()


def _remedy(file: Path, began: str | None) -> str:
    """Where nothing tells a process from a later one of its number, it may be something else."""
    return "wait for it, or end it" if began else f"wait for it, end it, or, if it is another program, remove {file}"


def _is_alive(process: int, began: str | None) -> bool:
    if os.name == "nt":  # where asking by a signal would end it
        import ctypes

        # By names, as other systems have none of these.
        kernel = getattr(ctypes, "WinDLL")("kernel32", use_last_error=True)  # noqa: B009
        handle = kernel.OpenProcess(0x1000, False, process)
        if not handle:
            return bool(getattr(ctypes, "get_last_error")() == NOT_ALLOWED)  # noqa: B009
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
    """When a process was started, which tells it from a later one of the same number; None where that is not told."""
    try:
        state, started = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0:20:19]
    except (OSError, ValueError):
        return None
    return "dead" if state == "Z" else started
