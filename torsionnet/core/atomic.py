"""Files that are written whole or not at all; pipes and devices get the bytes as they are."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write UTF-8 text with Unix line ends beside ``path``, then rename it into place."""
    write_bytes(path, text.encode())


def write_bytes(path: str | os.PathLike[str], data: bytes | memoryview) -> None:
    """Write ``data`` beside ``path``, then rename it into place; a failure leaves nothing behind.

    A file that is replaced keeps its permissions; a link is followed, not replaced.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(data)


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give the path of an empty file to be written; it takes the place of ``path`` at the end.

    For libraries that write files themselves. It lies beside ``path`` and has its ending, and goes if the writing fails
    or the program is told to end. What is there and is no regular file (a pipe, a device) is not replaced: the bytes
    are written to it.
    """
    import tempfile  # loads random and shutil, which a program that only reads can do without

    target = Path(path).resolve()
    special = target.exists() and not target.is_file()
    folder = None if special else target.parent
    handle, name = tempfile.mkstemp(dir=folder, prefix=f".{target.name[:40]}.", suffix=target.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        with _ended_in_order():
            yield temporary
            if special:
                _pour(temporary, target)
            else:
                temporary.chmod(_permissions(target))
                temporary.replace(target)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise


def _pour(source: Path, target: Path) -> None:
    with target.open("wb") as stream:
        stream.write(source.read_bytes())
    source.unlink()


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
