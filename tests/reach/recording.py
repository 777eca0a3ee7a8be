"""Functions of the package that run, and other files of the checkout that are opened, in this process and in those it starts.

From Python 3.12 on `sys.monitoring` tells each function once between two `restart`s, at next to no cost; before, a trace function
makes a run about three times as slow.
"""

from __future__ import annotations

import atexit
import os
import sys
import threading
from functools import cache
from pathlib import Path
from types import CodeType, FrameType
from uuid import uuid4

ROOT = Path(__file__).parents[2]
PACKAGE = f"{ROOT}{os.sep}torsionnet{os.sep}"
WITHOUT_NUMBERS = Path(__file__).with_name("without_numbers.txt")
"""Files and functions of tests that another kernel of BLAS need not try, as `make reach` found."""
CHILDREN = "TORSIONNET_REACH"
"""Variable that names the folder into which processes that a test starts write what they reached."""
PASSED_OVER = (".git", ".venv", ".cache", ".hypothesis", ".pytest_cache", "__pycache__")

reached: set[str] = set()
"""What ran since `restart`: ``torsionnet/base/units.py:Unit.of``, or the path alone of another file that was opened."""


def name_of(code: CodeType) -> str | None:
    """A function of the package with its file; what stands inside a function is the function; None elsewhere."""
    if not code.co_filename.startswith(PACKAGE):
        return None
    return f"{Path(code.co_filename).relative_to(ROOT).as_posix()}:{code.co_qualname.partition('.<locals>')[0]}"


def _opened(event: str, arguments: tuple[object, ...]) -> None:
    """Audit hook: models, pages and data in the checkout, which tests read without a function of the package."""
    if event == "open" and isinstance(arguments[0], str) and arguments[0].startswith(str(ROOT)):
        path = arguments[0][len(str(ROOT)) + 1 :]
        if not path.endswith((".py", ".pyc")) and not path.startswith(PASSED_OVER):
            reached.add(path)


def _started(code: CodeType, _offset: int) -> object:
    if (name := name_of(code)) is not None:
        reached.add(name)
    return sys.monitoring.DISABLE


def _called(frame: FrameType, _event: str, _argument: object) -> None:
    if (name := name_of(frame.f_code)) is not None:
        reached.add(name)


@cache
def start() -> None:
    """Record from now on, in all threads; once, though some environments run their start files twice."""
    sys.addaudithook(_opened)
    if sys.version_info >= (3, 12):
        tool, events = sys.monitoring.PROFILER_ID, sys.monitoring.events
        sys.monitoring.use_tool_id(tool, "torsionnet reach")
        sys.monitoring.register_callback(tool, events.PY_START, _started)
        sys.monitoring.set_events(tool, events.PY_START)
        # What Python calls while it takes its modules apart is no part of a test.
        atexit.register(sys.monitoring.set_events, tool, 0)
    else:
        threading.settrace(_called)  # type: ignore[arg-type]
        sys.settrace(_called)  # type: ignore[arg-type]


def restart() -> set[str]:
    """Take what was reached, and begin again with nothing."""
    global reached
    taken, reached = reached, set()
    if sys.version_info >= (3, 12):
        sys.monitoring.restart_events()
    return taken


def start_in_child() -> None:
    """Record in a process that a test has started, and write it into the folder of the variable at the end."""
    folder = Path(os.environ[CHILDREN])
    start()
    atexit.register(lambda: (folder / f"{uuid4().hex}.txt").write_text("\n".join(sorted(reached)), encoding="utf-8"))
