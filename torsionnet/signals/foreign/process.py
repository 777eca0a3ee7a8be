"""Processes that read foreign files, which start when needed, stay for the next file, and end with the program."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.signals.foreign.content import Content, ForeignFileError, StoredArray

if TYPE_CHECKING:
    from numpy.typing import NDArray


PACKAGE = Path(__file__).parents[2]
"""Folder of the package torsionnet, whose parent goes onto the search path of the reading process."""
END_TIMEOUT = 5.0
"""Seconds that a reading process may take to end when its input is closed, before it is killed."""
TIMEOUT_EXIT_CODE = -getattr(signal, "SIGPROF", 0) or None
"""Exit code of a reading process that has used up its processor time; None on systems without such a limit."""
DEBUG = "TORSIONNET_DEBUG"
"""Environment variable that lets messages of the file libraries through to the screen."""
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL")}
"""Environment variables that keep libraries of linear algebra from starting threads, which reading does not need."""


class ReaderCrashError(ForeignFileError):
    """Error of a reading process that crashed in the middle of an answer."""


class _ReaderTimeoutError(ForeignFileError):
    """Error of a file whose reading took longer than its limit of processor time; the file is not tried again."""


class ReaderProcess:
    """Process that reads foreign files, and the folder through which its arrays come."""

    def __init__(self) -> None:
        import subprocess

        if not sys.executable:
            raise ForeignFileError(
                "such files are read in a second Python process, and this Python does not "
                "know its own program (sys.executable); run an ordinary Python"
            )
        self.is_used = False
        self.is_responsive = True
        self.folder = Path(tempfile.mkdtemp(prefix="torsionnet-"))
        self._running = subprocess.Popen(
            # -P and the search path of this process: a file h5py.py in the working folder is not taken for the library.
            [sys.executable, "-P", "-W", "ignore", "-m", "torsionnet.signals.foreign", str(self.folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=None if os.environ.get(DEBUG) else subprocess.DEVNULL,
            env=os.environ | _ONE_THREAD | {"PYTHONPATH": search_path()},
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )

    @property
    def is_alive(self) -> bool:
        return self.is_responsive and self._running.poll() is None

    def ask(self, question: dict[str, Any]) -> dict[str, Any]:
        """Answer of the reading process to a question, both as JSON data.

        Raises
        ------
        ForeignFileError
            The library cannot read the file, or crashed.
        """
        assert self._running.stdin is not None
        assert self._running.stdout is not None
        self.is_responsive = False
        with contextlib.suppress(BrokenPipeError, OSError):
            self._running.stdin.write(json.dumps(question).encode("ascii") + b"\n")
            self._running.stdin.flush()
        line = self._running.stdout.readline()
        if not line.endswith(b"\n"):
            code = self._running.wait()
            raise (_ReaderTimeoutError if code == TIMEOUT_EXIT_CODE else ReaderCrashError)(_ending(code))
        answer: dict[str, Any] = json.loads(line)
        self.is_responsive = True
        if "full" in answer:
            raise OSError(answer["full"], os.strerror(answer["full"]), str(self.folder))
        if "error" in answer:
            self.is_used = True
            raise ForeignFileError(answer["error"])
        return answer

    def end(self) -> None:
        """End the reading process by closing its input, or kill it if that takes too long."""
        import subprocess

        assert self._running.stdin is not None
        assert self._running.stdout is not None
        with contextlib.suppress(OSError):
            self._running.stdin.close()
        try:
            self._running.wait(END_TIMEOUT if self.is_responsive else 0.2)
        except subprocess.TimeoutExpired:
            self._running.kill()
            self._running.wait()
        self._running.stdout.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def search_path() -> str:
    """Search path of Python modules for the reading process, without the working folder, which may change."""
    known = [entry for entry in sys.path if entry]
    root = str(PACKAGE.parent)
    return os.pathsep.join(known if root in known else [root, *known])


def _ending(code: int) -> str:
    if code >= 0:
        return f"the library that reads it ended (exit code {code}); the file is damaged"
    if code == TIMEOUT_EXIT_CODE:
        return "the library that reads it did not come to an end; the file is damaged"
    with contextlib.suppress(ValueError):
        name = signal.Signals(-code).name
        return f"the library that reads it crashed ({name}); the file is damaged"
    return f"the library that reads it crashed (signal {-code}); the file is damaged"


_idle: list[ReaderProcess] = []
_owner = os.getpid()


@contextlib.contextmanager
def borrow_process(*, fresh: bool = False) -> Iterator[ReaderProcess]:
    """Yield a process to read one file with, that of the file before, unless that is still open, or a new one."""
    process = _taken(fresh=fresh)
    try:
        yield process
    finally:
        if process.is_alive and not _idle and _owner == os.getpid():
            with contextlib.suppress(ForeignFileError, OSError):
                process.ask({"close": True})
        if process.is_alive and not _idle and _owner == os.getpid():
            _idle.append(process)
        else:
            process.end()


def _taken(*, fresh: bool) -> ReaderProcess:
    global _owner  # noqa: PLW0603
    if _owner != os.getpid():  # a fork: the processes belong to its parent
        _idle.clear()
        _owner = os.getpid()
    while not fresh and _idle:
        with contextlib.suppress(IndexError):  # another thread was quicker
            process = _idle.pop()
            if process.is_alive:
                return process
            process.end()
    return ReaderProcess()


@atexit.register
def end_all() -> None:
    """End the reading processes that wait for another file."""
    while _idle and _owner == os.getpid():
        _idle.pop().end()


# Content of a foreign file for the program that reads it, while another process has the file open.


@contextlib.contextmanager
def open_content(path: Path, form: str) -> Iterator[Content]:
    """Yield the content of a binary file that another process has open; ``form`` names a module of this package.

    Raises
    ------
    ForeignFileError
        The library cannot read the file, or crashed on it, here or while blocks are read.
    """
    question = {"open": str(path.absolute()), "form": form}
    with contextlib.ExitStack() as stack:
        process = stack.enter_context(borrow_process())
        try:
            answer = process.ask(question)
        except ReaderCrashError:
            if not process.is_used:
                raise
            # The file before this one may have left it damaged.
            process = stack.enter_context(borrow_process(fresh=True))
            answer = process.ask(question)
        process.is_used = True
        yield _content(process, answer)


def _content(process: ReaderProcess, answer: dict[str, Any]) -> Content:
    arrays = tuple(
        StoredArray(item["name"], tuple(item["shape"]), item["attributes"], item["value"]) for item in answer["arrays"]
    )

    def blocks(numbers: Sequence[int], count: int) -> Iterator[list[NDArray[Any]]]:
        question: dict[str, Any] = {"read": list(numbers), "count": count}
        while (file := process.ask(question)["file"]) is not None:
            yield _loaded(process.folder / file)
            question = {"more": True}

    return Content(arrays, blocks, answer["attributes"], tuple(answer["others"]))


def _loaded(path: Path) -> list[NDArray[Any]]:
    """Arrays that stand one behind the other in a file, which is deleted after reading."""
    import numpy as np

    with path.open("rb") as stream:
        arrays = [np.load(stream, allow_pickle=False) for _ in range(int(stream.readline()))]
    path.unlink()
    return arrays
