"""Reading of model files to definitions; every fault gets its position in the file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeAlias

from torsionnet.base.entries.declared import files_beside, version_faults
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean, unreadable_file
from torsionnet.base.packages import gc_paused
from torsionnet.model.defining import check_definition, define, has_errors
from torsionnet.model.definition import Definition
from torsionnet.model.files.library import decode, library_models, other_use
from torsionnet.model.files.located_yaml import LocatedDocument, compose

SUFFIXES = (".yaml", ".yml", ".json")
"""Endings of the names of model files."""


Further: TypeAlias = Callable[[Definition], Iterable[Fault]]
"""Type of a function that returns further faults of a sound definition, beside those of the model alone."""


def read_file(path: str | os.PathLike[str], further: Further | None = None) -> tuple[Definition | None, list[Fault]]:
    """Definition of a model from its file, None if it has errors, and all faults in the order of the file."""
    file = find_model(path)
    try:
        raw = file.read_bytes()
    except OSError as error:
        raise unreadable_file(file, error) from None
    try:
        text = decode(raw, str(file))
    except ModelError as error:
        return None, list(error.faults)
    return read_text(text, str(file), file.parent, further)


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
        from torsionnet.model.files.fault_places import presentable_faults

        return None, presentable_faults(error.faults)
    if not isinstance(document.data, dict):
        return None, [_no_model(document)]
    if "vary" in document.data and "elements" not in document.data:
        from torsionnet.model.files.fault_places import located_faults

        text = f"this is a study, no model; torsionnet study {Path(document.file).name} calculates it"
        return None, located_faults(
            [*document.faults, Fault(text, ("vary",), on_key=True, kind="wrong-file")], document
        )
    with files_beside(folder):
        if {"include", "use", "parts"} & document.data.keys():
            from torsionnet.model.files.part_includes import include_parts

            include_parts(document)
        definition, faults = define(document.data)
        faults = [*version_faults(document.data, "model"), *faults]
        if has_errors(faults) or document.dropped:
            from torsionnet.model.files.fault_places import check_partial_model

            faults = check_partial_model(definition, document, faults)
        else:
            faults += check_definition(definition)
        if further is not None and definition is not None and not has_errors([*document.faults, *faults]):
            faults = [*faults, *further(definition)]
        if definition.authored is not None:
            from torsionnet.model.parts.authored_model import at_written_places

            faults = at_written_places(definition, faults)
    if not (document.faults or faults):
        return definition, []
    from torsionnet.model.files.fault_places import located_faults

    located = located_faults([*document.faults, *faults], document)
    return (None if has_errors(located) else definition), located


def _no_model(document: LocatedDocument) -> Fault:
    if document.data is None:
        return Fault(
            "the file is empty; a model begins with torsionnet: 1", position=document.position(), kind="wrong-file"
        )
    what = "a list" if isinstance(document.data, list) else "a single value"
    text = f"this is {what}; a model is made of entries: torsionnet: 1, name: ..., elements: ..."
    return Fault(text, position=document.position(), kind="wrong-file")


def find_model(model: str | os.PathLike[str]) -> Path:
    """Path of the file meant by a path or by the name of a library model; UsageError lists what there is instead."""
    path = Path(model)
    if "\0" in str(path):
        raise UsageError("a file name cannot hold the character U+0000", kind="invalid-name")
    library = library_models()
    if isinstance(model, str) and model in library:
        return library[model]
    try:
        is_folder, is_there = path.is_dir(), path.exists()
    except OSError:  # a name too long, a folder that may not be searched
        is_folder = is_there = False
    if is_folder:
        raise UsageError(f"{path} is a folder; name a model file in it{_files_in(path)}", kind="wrong-file")
    if not is_there:
        raise UsageError(_missing(path, library), kind="missing-file")
    if path.suffix.lower() not in SUFFIXES:
        sheet = f"; torsionnet import {path} makes one of a maker's sheet" if path.suffix.lower() == ".csv" else ""
        raise UsageError(
            f"{path} is no model file; its name would end in {', '.join(SUFFIXES)}{sheet}", kind="wrong-file"
        )
    return path


def is_file(path: Path) -> bool:
    """Whether a file exists; False for a name that no file can have."""
    try:
        return path.is_file()
    except OSError:
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
