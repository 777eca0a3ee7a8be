"""One input tried: how it ends, what it costs, and where it went wrong."""

from __future__ import annotations

import contextlib
import os
import re
import resource
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from types import FrameType

import torsionnet as tn
from fuzz.kinds import EXPECTED, Kind
from torsionnet.base.errors import printable_text
from torsionnet.signals.foreign import process

SMALL = 10_000
"""Bytes of a file whose time is limited."""
MOST_MEMORY = 1e9
PACKAGE = str(Path(tn.__file__).parent)
_TRACE = re.compile(r"Traceback \(most recent|\bobject at 0x|<class '")


@dataclass(frozen=True)
class Trial:
    """``outcome`` is result, error or failure; a failure has a signature, the same for all of its kind."""

    number: int
    outcome: str
    signature: str = ""
    seconds: float = 0.0
    memory: float = 0.0
    size: int = 0

    def to_data(self) -> dict[str, object]:
        return asdict(self)


def attempt(kind: Kind, path: Path, number: int = 0) -> Trial:
    """Use a file and say what came of it."""
    slow: list[str] = []
    _forget_peak()
    began, others, before = _seconds(), _peak_of_children(), _peak()
    with _watched(slow, kind.seconds), warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        outcome, signature = _used(kind, path)
    seconds, size = _seconds() - began, path.stat().st_size
    memory = max(_peak() - before, _peak_of_children() if _peak_of_children() > others else 0.0)
    stray = [warning for warning in heard if not issubclass(warning.category, tn.TorsionnetWarning)]
    if outcome != "failure" and stray:
        place = Path(stray[0].filename).name
        outcome, signature = "failure", f"{stray[0].category.__name__} in {place}: {str(stray[0].message)[:60]}"
    if outcome != "failure" and seconds > kind.seconds and size < SMALL:
        outcome, signature = "failure", f"slow in {slow[0] if slow else 'a library'}"
    if outcome != "failure" and memory > MOST_MEMORY:
        outcome, signature = "failure", f"more than {MOST_MEMORY / 1e9:g} GB"
    return Trial(number, outcome, signature, seconds, memory, size)


def _used(kind: Kind, path: Path) -> tuple[str, str]:
    try:
        kind.use(path)
    except EXPECTED as error:
        text = str(error) if isinstance(error, tn.ModelError) else printable_text(str(error))
        if not text or printable_text(text) != text or _TRACE.search(text):
            return "failure", f"raw text of {type(error).__name__} at {_innermost(error)}"
        return "error", ""
    except Exception as error:  # noqa: BLE001  (whatever it is, it is a finding)
        return "failure", f"{type(error).__name__} at {_innermost(error)}"
    return "result", ""


def _innermost(error: BaseException) -> str:
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.startswith(PACKAGE)]
    return (
        f"{Path(frames[-1].filename).relative_to(PACKAGE)}:{frames[-1].name}" if frames else "no frame of the package"
    )


@contextlib.contextmanager
def _watched(slow: list[str], seconds: float) -> Iterator[None]:
    """Note where the package is when its time is over."""

    def note(number: int, frame: FrameType | None) -> None:
        del number
        while frame is not None and not frame.f_code.co_filename.startswith(PACKAGE):
            frame = frame.f_back
        if frame is not None:
            slow.append(f"{Path(frame.f_code.co_filename).relative_to(PACKAGE)}:{frame.f_code.co_name}")

    before = signal.signal(signal.SIGPROF, note)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _seconds() -> float:
    """Processor time of this process, of those it has started and ended, and of the one that reads binary files."""
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(used.ru_utime + used.ru_stime for used in both) + sum(map(_so_far, process._idle))


def _so_far(running: process.ReaderProcess) -> float:
    with contextlib.suppress(OSError):
        words = Path(f"/proc/{running._running.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
    return 0.0


def _peak_of_children() -> float:
    return 1024.0 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss


def _forget_peak() -> None:
    if sys.platform == "linux":
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")


def _peak() -> float:
    """Bytes of memory that were held at most since the last time it was forgotten."""
    with contextlib.suppress(OSError, StopIteration):
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return 1024.0 * int(next(line.split()[1] for line in lines if line.startswith("VmHWM:")))
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
