"""Writing of files as a whole or not at all; pipes and devices get the bytes as they are."""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import stat
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from torsionnet.base.errors import readable_text

PIPE_TIMEOUT = 10.0
"""Seconds that writing to a pipe waits for a reader, enough for a program that is still starting."""


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write UTF-8 text with Unix line ends to ``path``, atomically: beside it, then renamed into place."""
    try:
        data = text.encode()
    except UnicodeEncodeError:
        data = readable_text(text).encode()
    write_bytes(path, data)


def write_bytes(path: str | os.PathLike[str], data: bytes | memoryview) -> None:
    """Write bytes to ``path`` atomically: beside it, then renamed into place; a failure leaves nothing behind.

    A file that is replaced keeps its permissions; a link is followed, not replaced.
    """
    with atomic_replacement(path) as temporary:
        temporary.write_bytes(data)


@contextlib.contextmanager
def atomic_replacement(path: str | os.PathLike[str], *, follow_links: bool = True) -> Iterator[Path]:
    """Context manager that gives the path of an empty temporary file, which replaces ``path`` at the end.

    For libraries that write files themselves. It lies beside ``path`` and has its ending, and goes if the writing fails
    or the program is told to end. What is there and is no regular file (a pipe, a device) is not replaced: the bytes
    are written to it. Without ``follow_links`` whatever is at ``path`` is replaced, also a link.

    Raises
    ------
    OSError
        The file cannot be written; it names ``path``, whatever file the system spoke of.
    """
    import tempfile  # loads random and shutil, which a program that only reads can do without

    target = _behind_links(path) if follow_links else Path(path)
    special = follow_links and target.exists() and not target.is_file()
    folder = None if special else target.parent
    shown = str(path) if target.name == Path(path).name else f"{path} (a link to {target})"
    temporary = None
    try:
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{target.name[:40]}.", suffix=target.suffix)
        os.close(handle)
        temporary = Path(name)
        with _ended_in_order():
            yield temporary
            if special:
                _pour(temporary, target)
            else:
                temporary.chmod(_permissions(target))
                temporary.replace(target)
    except BaseException as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
        ours = isinstance(error, OSError) and (temporary is None or error.filename in (None, str(temporary)))
        if isinstance(error, OSError) and ours and error.errno is not None:
            raise OSError(error.errno, error.strerror, shown) from error
        raise


def _behind_links(path: str | os.PathLike[str]) -> Path:
    """Path of the file that a chain of symbolic links leads to, which need not exist yet."""
    try:
        target = Path(path).resolve()
        loops = target.is_symlink()
    except RuntimeError:  # what Python before 3.13 makes of a loop
        loops = True
    if loops:
        raise OSError(errno.ELOOP, "a link that leads back to itself", str(path))
    return target


def _pour(source: Path, target: Path) -> None:
    with _opened(target) as stream:
        stream.write(source.read_bytes())
    source.unlink()


def _opened(target: Path) -> BinaryIO:
    """Binary stream to a pipe or device, open for writing; waits a limited time for a reader of a pipe."""
    if not stat.S_ISFIFO(target.stat().st_mode):
        return target.open("wb")
    until = time.monotonic() + PIPE_TIMEOUT
    while True:
        try:
            handle = os.open(target, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
            if time.monotonic() > until:
                text = f"nobody has opened this pipe for reading within {PIPE_TIMEOUT:g} s"
                raise OSError(errno.ENXIO, text, str(target)) from None
            time.sleep(0.02)
            continue
        os.set_blocking(handle, True)
        return os.fdopen(handle, "wb")


@contextlib.contextmanager
def _ended_in_order() -> Iterator[None]:
    """Turn SIGTERM into an exception, so that a program told to end leaves no temporary file."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGTERM) != signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, _end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _end(number: int, frame: object) -> None:
    del frame
    raise SystemExit(128 + number)


def _permissions(target: Path) -> int:
    with contextlib.suppress(OSError):
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
