"""Results of the records of a campaign in files, kept until the record or an entry that matters to it changes."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from torsionnet.base.errors import UsageError
from torsionnet.base.version import __version__
from torsionnet.bench.campaign.campaign import Campaign

HASHED_BYTES = 2**20
"""Bytes of a record that are hashed together, which limits the memory."""
KEY_LENGTH = 16
"""Digits of a key, enough to tell all versions of a record apart."""


def kept_path(folder: Path, name: str, key: str) -> Path:
    """Path of the folder that holds the results of a record under a key; it is there once they are."""
    return folder / f"{name}-{key}"


def write_kept(kept: Path, fill: Callable[[Path], None]) -> None:
    """Fill a folder that has its name only when all its files are there; those of other keys are removed.

    Raises
    ------
    UsageError
        The folder cannot be written.
    """
    folder = kept.parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".writing-") as begun:
            filling = Path(begun) / kept.name
            filling.mkdir()
            fill(filling)
            filling.rename(kept)
    except OSError as error:
        raise UsageError(f"{folder} cannot be a folder of results: {error.strerror}") from None
    for old in folder.glob(f"{kept.name[:-KEY_LENGTH]}{'[0-9a-f]' * KEY_LENGTH}"):
        if old != kept:
            shutil.rmtree(old, ignore_errors=True)


def file_name(name: str) -> str:
    """Name of a record or channel without characters that a name of a file cannot have."""
    return re.sub(r"[^\w.+-]", "_", name)


def record_key(campaign: Campaign, name: str, sections: Iterable[str]) -> str:
    """Key of what the results of a record follow from: the bytes of its file, sections, pitch patterns, version."""
    plan = replace(campaign.plan, fit=None).written_entries()
    one = campaign.plan.records[name]
    asked = {key: plan.get(key) for key in sections}
    asked |= {"start": one.start, "stop": one.stop, "version": __version__, "title": campaign.title}
    asked |= {"reading": one.reading.arguments} if one.reading else {}
    digest = hashlib.sha256(json.dumps(asked, sort_keys=True, default=str).encode())
    for pattern in campaign.patterns.values():
        digest.update(pattern.positions.tobytes())
    with campaign.file_of(one).open("rb") as stream:
        while block := stream.read(HASHED_BYTES):
            digest.update(block)
    return digest.hexdigest()[:KEY_LENGTH]
