"""Lock of a study folder against a second run: a file with the number of the process, void once that has ended."""

from __future__ import annotations

import json
import os
import platform
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from torsionnet.base.errors import UsageError

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
        raise UsageError(f"another run uses {file.parent}; wait for it, or end it")
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
            f"a run on {host} (process {process}) uses {file.parent}; if it is not running any more, remove {file}"
        )
    if process and _is_alive(process, began):
        raise UsageError(f"process {process} is running this study in {file.parent}; {_remedy(file, began)}")
    aside = file.with_name(f".{uuid.uuid4().hex}")
    with suppress(FileNotFoundError):  # by name first, so that of two who find it dead only one removes it
        file.rename(aside)
        aside.unlink()


def _remedy(file: Path, began: str | None) -> str:
    """Advice for an error message on a running process that locks the folder.

    Without its start time the number may be that of another program.
    """
    return "wait for it, or end it" if began else f"wait for it, end it, or, if it is another program, remove {file}"


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
