"""Whether all workers see the folder of the study, from which they read it and where they leave what they calculate."""

from __future__ import annotations

import uuid
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.study.cluster.worker_versions import refuse_faults

if TYPE_CHECKING:
    from distributed import Client


def check_folder(client: Client, folder: Path) -> None:
    """Every worker there is must read in ``folder`` what was just written there, and write there."""
    word = uuid.uuid4().hex
    token = folder.resolve() / f".seen_by_workers_{word}"
    token.write_text(word)
    try:
        said = client.run(trouble_with, str(token), word, on_error="return")
    finally:
        token.unlink()
    refuse_faults(
        [f"worker {address}: {trouble}" for address, trouble in said.items() if trouble],
        f"All workers need {token.parent} under this path, as a folder of a file system that they share",
    )


def trouble_with(token: str, word: str) -> str:
    """What keeps this process from using the folder in which another wrote ``word``; empty if nothing does."""
    file = Path(token)
    try:
        if file.read_text() != word:
            return f"{file.parent} is another folder there"
        beside = file.with_name(f"{file.name}_{uuid.uuid4().hex}")
        beside.touch()
        beside.unlink()
    except FileNotFoundError:
        return f"{file.parent} is not there, or is another folder"
    except OSError as error:
        return f"{file.parent} cannot be used: {error.strerror}"
    return ""
