"""Content of a foreign file for the program that reads it, while another process has the file open."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.signals.foreign.content import Content, StoredArray
from torsionnet.signals.foreign.process import ReaderCrashError, borrow_process

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from torsionnet.signals.foreign.process import ReaderProcess


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
        found = [np.load(stream, allow_pickle=False) for _ in range(int(stream.readline()))]
    path.unlink()
    return found
