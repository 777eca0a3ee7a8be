"""Watching of model files, and of the files that they read, for changes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from pathlib import Path

from torsionnet.base.entries.declared import file_state, files_recorded

BETWEEN_LOOKS = 0.3
"""Time in s between two looks at the files: a glance at the screen takes longer."""
UNTIL_WRITTEN = 0.05
"""Time in s in which a file must not change any more to count as written to its end."""


def watch(models: Iterable[str], check: Callable[[], None]) -> None:
    """Call a function at first and after each change of a model file, or of a file that it reads, until Ctrl-C.

    Changes are seen by time, size and number of a file, on all file systems alike; one that is gone, or replaced by
    another of its name, has changed, too.
    """
    own = [_file(model) for model in models]
    files: set[Path] = set(own)
    try:
        while True:
            seen = {file: file_state(file) for file in files}
            with files_recorded() as read:
                check()
            files = {*own, *read}
            seen = {**read, **seen}  # those of before the check, so that no change during it is missed
            while all(file_state(file) == seen[file] for file in files):
                time.sleep(BETWEEN_LOOKS)
            _until_written(files)
    except KeyboardInterrupt:
        return


def _file(model: str) -> Path:
    """Path of a model, also of one that is not there."""
    from torsionnet.base.errors import UsageError
    from torsionnet.model.files.reader import find_model

    try:
        return find_model(model)
    except UsageError:
        return Path(model)


def _until_written(files: Iterable[Path]) -> None:
    """Wait until an editor that empties a file, or takes it away, has written the new one."""
    known = list(files)
    before = None
    while before != (before := [file_state(file) for file in known]):
        time.sleep(UNTIL_WRITTEN)
