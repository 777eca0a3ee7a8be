"""Program (``python -m torsionnet.signals.foreign FOLDER``) that opens files and answers in JSON, arrays in FOLDER.

What libraries print goes nowhere; what they raise becomes an answer. A crash is for the asking process to notice.
"""

from __future__ import annotations

import contextlib
import errno
import importlib
import json
import os
import re
import shutil
import signal
import sys
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path
from typing import Any, TextIO

import torsionnet.signals.foreign.content as resource_limits
from torsionnet.signals.foreign.content import Content, ForeignFileError, count_samples

LONGEST_MESSAGE = 300
"""Most characters of a library's error message that are passed on to the asking process."""
_CLASS = re.compile(r"<class '(?:\w+\.)*(\w+)'>")
"""Pattern of the class in the text of a library's error, which is shortened to its name."""
Answers = Generator[dict[str, Any], dict[str, Any], None]


class _FullError(Exception):
    """Error of a full disk, or of another failure to write the samples into the folder."""


def main(folder: Path, questions: TextIO, answers: TextIO) -> None:
    """Answer the questions of the process that reads, one line of JSON each, until no more come."""
    conversation: Answers | None = None
    for line in questions:
        try:
            question = json.loads(line)
            if "close" in question:
                if conversation is not None:
                    conversation.close()
                answer: dict[str, Any] = {}
            elif "open" in question:
                conversation = _conversation(Path(question["open"]), question["form"], folder)
                answer = next(conversation)
            else:
                assert conversation is not None
                answer = conversation.send(question)
        except _FullError as error:
            cause = error.__cause__
            answer = {"full": (cause.errno if isinstance(cause, OSError) else None) or errno.EIO}
        except Exception as error:  # noqa: BLE001  (a library says of a damaged file what it likes)
            answer = {"error": error_line(error)}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def error_line(error: BaseException) -> str:
    """Message of an error on one line of printable characters, shortened to :data:`LONGEST_MESSAGE`."""
    if isinstance(error, MemoryError):
        return "it asks for more memory than a file of its size may take; it is damaged"
    words = _CLASS.sub(r"\1", (str(error).splitlines() or [""])[0].strip())
    if not isinstance(error, (ForeignFileError, OSError, ValueError, RuntimeError)) or " " not in words:
        words = f"it is damaged ({type(error).__name__}{': ' if words else ''}{words})"
    shown = "".join(letter if letter.isprintable() else "?" for letter in words)
    return shown if len(shown) <= LONGEST_MESSAGE else f"{shown[: LONGEST_MESSAGE - 3]}..."


def _conversation(path: Path, form: str, folder: Path) -> Answers:
    module = importlib.import_module(f"torsionnet.signals.foreign.{form}_content")
    module.load()
    resource_limits.confine(path)
    with module.open_content(path) as content:
        resource_limits.check(resource_limits.BYTES_PER_SAMPLE * count_samples(content.arrays), path)
        question = yield _described(content)
        while True:
            for number, block in enumerate(content.blocks(question["read"], question["count"])):
                question = yield {"file": _saved(block, folder, f"{number}.arrays")}
                if "more" not in question:
                    break
            else:
                question = yield {"file": None}


def _described(content: Content) -> dict[str, Any]:
    arrays = [
        {"name": item.name, "shape": [*map(int, item.shape)], "attributes": {**item.attributes}, "value": item.value}
        for item in content.arrays
    ]
    return {"arrays": arrays, "attributes": {**content.attributes}, "others": [*content.others]}


def _saved(block: Sequence[Any], folder: Path, name: str) -> str:
    import numpy as np

    with _room(), (folder / name).open("wb") as stream:
        stream.write(f"{len(block)}\n".encode())
        for values in block:
            kind = complex if np.iscomplexobj(values) else float
            np.save(stream, np.ascontiguousarray(values, dtype=kind), allow_pickle=False)
    return name


@contextlib.contextmanager
def _room() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise _FullError from error


def _start() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # who pressed Ctrl-C meant the program that asks
    answers = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    folder = Path(sys.argv[1])
    try:
        main(folder, sys.stdin, answers)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    _start()
