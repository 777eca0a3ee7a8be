"""Reading of model files to definitions; every fault gets its position in the file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeAlias

from torsionnet.core.entries.format_version import version_faults
from torsionnet.core.entries.named_files import files_beside
from torsionnet.core.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.core.garbage_collection import gc_paused
from torsionnet.model.checks import has_errors
from torsionnet.model.defining import define
from torsionnet.model.definition import Definition
from torsionnet.model.files.decoding import decode
from torsionnet.model.files.fault_positions import located_faults, presentable_faults
from torsionnet.model.files.library import library_models
from torsionnet.model.files.library_uses import other_use
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.part_includes import include_parts
from torsionnet.model.files.partial_checks import check_partial_model

SUFFIXES = (".yaml", ".yml", ".json")
"""Endings of the names of model files."""


Further: TypeAlias = Callable[[Definition], Iterable[Fault]]
"""Type of a function that returns further faults of a sound definition, beside those of the model alone."""


def read_file(path: str | os.PathLike[str], further: Further | None = None) -> tuple[Definition | None, list[Fault]]:
    """Definition of a model from its file, None if it has errors, and all faults in the order of the file."""
    found = find_model(path)
    try:
        raw = found.read_bytes()
    except OSError as error:
        raise UsageError(f"{found} cannot be read: {error.strerror or error}") from None
    try:
        text = decode(raw, str(found))
    except ModelError as error:
        return None, list(error.faults)
    return read_text(text, str(found), found.parent, further)


@gc_paused()
def read_text(
    text: str, file: str, folder: Path | None = None, further: Further | None = None
) -> tuple[Definition | None, list[Fault]]:
    """Definition of a model from the text of its file, and faults, as :func:`read_file` returns them.

    Files that it names lie in ``folder``.
    """
    try:
        document = compose(text.removeprefix("\ufeff"), file)
    except ModelError as error:
        return None, presentable_faults(error.faults)
    return read_document(document, folder, further)


@gc_paused()
def read_document(
    document: LocatedDocument, folder: Path | None = None, further: Further | None = None
) -> tuple[Definition | None, list[Fault]]:
    """Definition of a model from the entries of its file, and faults, as :func:`read_file` returns them.

    The faults of the document are among them, and the parts that it includes are put into its data.
    """
    if not isinstance(document.data, dict):
        return None, [_no_model(document)]
    if "vary" in document.data and "elements" not in document.data:
        text = f"this is a study, no model; torsionnet study {Path(document.file).name} calculates it"
        return None, located_faults([*document.faults, Fault(text, ("vary",), on_key=True)], document)
    with files_beside(folder):
        include_parts(document)
        definition, faults = define(document.data)
        faults = check_partial_model(definition, document, [*version_faults(document.data, "model"), *faults])
        if further is not None and definition is not None and not has_errors([*document.faults, *faults]):
            faults = [*faults, *further(definition)]
        if definition.authored is not None:
            from torsionnet.model.parts.written_places import at_written_places

            faults = at_written_places(definition.authored.authored, faults)
    found = located_faults([*document.faults, *faults], document)
    return (None if has_errors(found) else definition), found


def _no_model(document: LocatedDocument) -> Fault:
    if document.data is None:
        return Fault("the file is empty; a model begins with torsionnet: 1", position=document.position())
    what = "a list" if isinstance(document.data, list) else "a single value"
    text = f"this is {what}; a model is made of entries: torsionnet: 1, name: ..., elements: ..."
    return Fault(text, position=document.position())


def find_model(model: str | os.PathLike[str]) -> Path:
    """Path of the file meant by a path or by the name of a library model; UsageError lists what there is instead."""
    path = Path(model)
    if "\0" in str(path):
        raise UsageError("a file name cannot hold the character U+0000")
    library = library_models()
    if isinstance(model, str) and model in library:
        return library[model]
    if _holds(Path.is_dir, path):
        raise UsageError(f"{path} is a folder; name a model file in it{_files_in(path)}")
    if not _holds(Path.exists, path):
        raise UsageError(_missing(path, library))
    if path.suffix.lower() not in SUFFIXES:
        sheet = f"; torsionnet import {path} makes one of a maker's sheet" if path.suffix.lower() == ".csv" else ""
        raise UsageError(f"{path} is no model file; its name would end in {', '.join(SUFFIXES)}{sheet}")
    return path


def is_file(path: Path) -> bool:
    """Whether a file exists; False for a name that no file can have."""
    return _holds(Path.is_file, path)


def _holds(question: Callable[[Path], bool], path: Path) -> bool:
    try:
        return question(path)
    except OSError:  # a name too long, a folder that may not be searched
        return False


def _files_in(folder: Path) -> str:
    try:
        names = sorted(entry.name for entry in folder.iterdir() if entry.suffix.lower() in SUFFIXES)
    except OSError:
        return ""
    return f": {', '.join(names[:6])}" if names else ""


def _missing(path: Path, library: Iterable[str]) -> str:
    names = sorted(library)
    if path.suffix.lower() not in SUFFIXES and len(path.parts) <= 1:
        other = other_use(path.name)
        if other:
            return other
        hint = did_you_mean(path.name, [*names, *_beside(path)])
        hint = hint or f"; there are {', '.join(names)}"
        return f'no library model is named "{path}"{hint} (a file name ends in .yaml)'
    return f"there is no file {path}{did_you_mean(path.name, _beside(path)) or did_you_mean(path.stem, names)}"


def _beside(path: Path) -> list[str]:
    try:
        return [entry.name for entry in path.parent.iterdir() if entry.suffix.lower() in SUFFIXES]
    except OSError:
        return []
